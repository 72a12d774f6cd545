"""Packages and workspaces as colcon sees them, without building anything.

In: folders with package.xml, CMakeLists.txt, setup.py and wsgen.toml. Out: values, diagnostics.
It imports `model`, `ros`, `gazebo` and what is below them.
"""
