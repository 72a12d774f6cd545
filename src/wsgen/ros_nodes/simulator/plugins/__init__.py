"""The plugins of Gazebo that the simulator has, one module each.

A name is that of `wsgen.model.gazebo_plugins.stem`: the file name of the library without what
systems put around it. The class follows its module, which is imported when a robot has the plugin.
"""

from __future__ import annotations

PLUGINS: dict[str, str] = {}

# What the simulator does by itself, or what needs nothing done, by the same names.
DONE_BY_SIMULATOR = frozenset(
    (
        *("gazebo_ros_init", "gazebo_ros_factory", "gazebo_ros_state", "gazebo_ros_properties"),
        *("gazebo_ros_force_system", "physics", "user-commands", "scene-broadcaster", "sensors"),
        *("imu", "contact", "label", "cpu-lidar", "environment-preload", "shader-param"),
    )
)
