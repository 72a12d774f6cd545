"""Let a robot stand in a physics engine, and measure what happens.

`run` is what callers use: it plays a `scene` in a child process (`worker`), where `simulation`
does the measuring over an `engine`. `bullet` is the real engine, `fake` the one for tests.
"""
