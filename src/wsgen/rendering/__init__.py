"""Pictures and videos of what is simulated, drawn with NumPy: the same for every engine.

In: a scene with poses. Out: images and files.
It imports `simulation` and what is below it.
"""
