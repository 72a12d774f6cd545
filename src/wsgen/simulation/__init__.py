"""Lets robots stand in a physics engine, and measures what happens.

`run` is what callers use: it simulates a `scene` in a child process (`wsgen.pipeline.tasks`), where
`simulate` measures with an `engine`. `bullet` and `dart` are engines, `fake` is one for tests.
"""
