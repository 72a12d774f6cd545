"""The plugins of Gazebo that the simulator has.

A name is that of `wsgen.gazebo.plugins.stem`: the file name of the library without what
systems put around it. The class follows its module, which is imported when a robot has the plugin.
"""

from __future__ import annotations

from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.gazebo.systems import systems
from wsgen.live.nodes.simulator.sensors import SENSORS

_HERE = "wsgen.live.nodes.simulator.plugins"
PLUGINS: dict[str, str] = {
    "gazebo_ros_ackermann_drive": f"{_HERE}.ackermann:ClassicAckermann",
    "gazebo_ros_diff_drive": f"{_HERE}.diff_drive:ClassicDiffDrive",
    "gazebo_ros_ft_sensor": f"{_HERE}.joint_measurements:ClassicForceTorque",
    "gazebo_ros_joint_pose_trajectory": f"{_HERE}.joint_control:ClassicPoseTrajectory",
    "gazebo_ros_joint_state_publisher": f"{_HERE}.joint_measurements:ClassicJointStates",
    "gazebo_ros_p3d": f"{_HERE}.odometry:GroundTruth",
    "gazebo_ros_planar_move": f"{_HERE}.sideways:PlanarMove",
    "ackermann-steering": f"{_HERE}.ackermann:GzAckermann",
    "apply-joint-force": f"{_HERE}.joint_control:GzJointForce",
    "diff-drive": f"{_HERE}.diff_drive:GzDiffDrive",
    "joint-controller": f"{_HERE}.joint_control:GzJointVelocity",
    "joint-position-controller": f"{_HERE}.joint_control:GzJointPosition",
    "joint-state-publisher": f"{_HERE}.joint_measurements:GzJointStates",
    "joint-trajectory-controller": f"{_HERE}.joint_control:GzJointTrajectory",
    "linearbatteryplugin": f"{_HERE}.battery:LinearBattery",
    "mecanum-drive": f"{_HERE}.sideways:GzMecanum",
    "odometry-publisher": f"{_HERE}.odometry:OdometryPublisher",
    "pose-publisher": f"{_HERE}.odometry:PosePublisher",
    "velocity-control": f"{_HERE}.sideways:VelocityControl",
    **dict.fromkeys(
        ("gazebo_ros2_control", "gz_ros2_control-system", "ign_ros2_control-system"),
        f"{_HERE}.ros2_control:Ros2Control",
    ),
}

# Likewise, of worlds.
WORLD_PLUGINS: dict[str, str] = {
    "gazebo_ros_state": "wsgen.live.nodes.simulator.world_state:WorldState"
}

_OF_SENSORS = {SYSTEM_OF_SENSOR[kind] for kind in SENSORS}
# What the simulator does by itself, or what needs nothing done, by the same names. A system for
# sensors is only looked for.
DONE_BY_SIMULATOR = frozenset(
    (
        *("gazebo_ros_init", "gazebo_ros_factory", "gazebo_ros_state", "gazebo_ros_properties"),
        *("gazebo_ros_force_system", "physics", "user-commands", "scene-broadcaster"),
        *("label", "environment-preload", "shader-param"),
        *(name for name, classes in systems().items() if _OF_SENSORS.intersection(classes)),
    )
)
