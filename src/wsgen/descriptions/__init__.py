"""Robots and worlds: URDF, xacro and SDF as Gazebo reads them, and the meshes they name.

In: texts and files. Out: `model.robot.Robot`, `model.world.World`, diagnostics with lines.
It imports `launching`, `packages` and what is below them; no engine.
"""
