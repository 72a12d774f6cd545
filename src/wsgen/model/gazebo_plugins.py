"""What is known about the plugins of Gazebo Classic and of Gazebo Sim: data.

Names and parameters are those that the sources of gazebo_plugins and of gz-sim's `src/systems`
(Fortress to Jetty) have; `wsgen.model.gazebo_systems` has the names of all systems.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.values import lazy_pattern

if TYPE_CHECKING:
    from wsgen.model.robot import Robot
    from wsgen.model.world import World

CLASSIC, SIM = "classic", "gz"
SIMULATOR_NAMES = {CLASSIC: "Gazebo Classic", SIM: "Gazebo Sim"}

# Libraries of ROS 2 for Gazebo Classic, without `lib` and `.so`.
OF_CLASSIC = tuple(
    f"gazebo_ros_{name}"
    for name in (
        *("ackermann_drive", "bumper", "camera", "diff_drive", "elevator", "factory", "force"),
        *("force_system", "ft_sensor", "gps_sensor", "hand_of_god", "harness", "imu_sensor"),
        *("init", "joint_pose_trajectory", "joint_state_publisher", "p3d", "planar_move"),
        *("projector", "properties", "ray_sensor", "state", "template", "tricycle_drive"),
        *("vacuum_gripper", "video", "wheel_slip"),
    )
)
FOUR_WHEELS = (
    *("front_left_joint", "front_right_joint", "rear_left_joint", "rear_right_joint"),
    *("left_steering_joint", "right_steering_joint", "steering_wheel_joint"),
)
TWO_WHEELS = ("left_joint", "right_joint")
TRICYCLE = (
    *("steering_joint", "actuated_wheel_joint"),
    *("encoder_wheel_left_joint", "encoder_wheel_right_joint"),
)


class Parts(NamedTuple):
    """The parameters of a plugin that name parts of the robot."""

    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    required: tuple[str, ...] = ()  # without which it does nothing


# Plugin, as `stem` gives it -> what its parameters name.
PARTS: dict[str, Parts] = {
    "gazebo_ros_diff_drive": Parts(joints=TWO_WHEELS, required=TWO_WHEELS),
    "gazebo_ros_joint_state_publisher": Parts(joints=("joint_name",), required=("joint_name",)),
    "gazebo_ros_ackermann_drive": Parts(joints=FOUR_WHEELS),
    "gazebo_ros_tricycle_drive": Parts(joints=TRICYCLE),
    "gazebo_ros_p3d": Parts(links=("body_name",)),
    "gazebo_ros_force": Parts(links=("link_name",)),
    "diff-drive": Parts(joints=TWO_WHEELS, required=TWO_WHEELS),
    "ackermann-steering": Parts(
        joints=(*TWO_WHEELS, "left_steering_joint", "right_steering_joint")
    ),
    "mecanum-drive": Parts(
        joints=("front_left_joint", "front_right_joint", "back_left_joint", "back_right_joint")
    ),
    "joint-state-publisher": Parts(joints=("joint_name",)),
    "joint-position-controller": Parts(joints=("joint_name",), required=("joint_name",)),
    "joint-controller": Parts(joints=("joint_name",), required=("joint_name",)),
    "joint-trajectory-controller": Parts(joints=("joint_name",)),
    "apply-joint-force": Parts(joints=("joint_name",), required=("joint_name",)),
    "multicopter-motor-model": Parts(joints=("jointName",), links=("linkName",)),
    "thruster": Parts(joints=("joint_name",), required=("joint_name",)),
}
_SPEEDS = tuple(
    f"{bound}_{kind}"
    for bound in ("min", "max")
    for kind in (
        *("velocity", "acceleration", "jerk", "linear_velocity", "linear_acceleration"),
        *("linear_jerk", "angular_velocity", "angular_acceleration", "angular_jerk"),
    )
)
# Plugin -> all its parameters.
PARAMETERS: dict[str, tuple[str, ...]] = {
    "gazebo_ros_diff_drive": (
        *(*TWO_WHEELS, "ros", "update_rate", "wheel_separation", "wheel_diameter"),
        *("max_wheel_torque", "max_wheel_acceleration", "command_topic", "publish_odom"),
        *("publish_odom_tf", "publish_wheel_tf", "odometry_topic", "odometry_frame"),
        *("robot_base_frame", "num_wheel_pairs", "odometry_source"),
        *("covariance_x", "covariance_y", "covariance_yaw"),
    ),
    "gazebo_ros_joint_state_publisher": ("ros", "update_rate", "joint_name"),
    "diff-drive": (
        *(*TWO_WHEELS, "wheel_separation", "wheel_radius", "odom_publish_frequency", "topic"),
        *("odom_topic", "tf_topic", "frame_id", "child_frame_id", *_SPEEDS),
    ),
    "joint-state-publisher": ("joint_name", "topic", "update_rate"),
    "odometry-publisher": (
        *("odom_frame", "robot_base_frame", "odom_topic", "odom_covariance_topic", "tf_topic"),
        *("odom_publish_frequency", "dimensions", "gaussian_noise", "xyz_offset", "rpy_offset"),
    ),
}
# What somebody writes for one simulator who knows the other -> what it is called there.
OF_THE_OTHER: dict[str, dict[str, str]] = {
    "gazebo_ros_diff_drive": {
        "wheel_radius": "wheel_diameter",
        "odom_topic": "odometry_topic",
        "topic": "command_topic",
        "child_frame_id": "robot_base_frame",
        "frame_id": "odometry_frame",
        "odom_publish_frequency": "update_rate",
    },
    "diff-drive": {
        "wheel_diameter": "wheel_radius",
        "odometry_topic": "odom_topic",
        "command_topic": "topic",
        "robot_base_frame": "child_frame_id",
        "odometry_frame": "frame_id",
        "update_rate": "odom_publish_frequency",
    },
}
# Parameters of the plugins of ROS 1 -> what those of ROS 2 have, where snake case is not it.
FROM_ROS_1 = {
    "robotNamespace": "<ros><namespace>",
    "topicName": "<ros><remapping>",
    "imageTopicName": "<ros><remapping>",
    "cameraInfoTopicName": "<ros><remapping>",
    "bodyName": "<body_name>",
    "torque": "<max_wheel_torque>",
}


def stem(filename: str) -> str:
    """A plugin's file name without what the systems and generations put around it.

    `libgazebo_ros_camera.so` is `gazebo_ros_camera`, `ignition-gazebo-imu-system` is `imu`.
    """
    name = filename.rpartition("/")[2].removesuffix(".so").removesuffix(".dll")
    if name.startswith("lib") and name != "lib":
        name = name[3:]
    for prefix in ("gz-sim-", "ignition-gazebo-"):
        if name.startswith(prefix) and name.endswith("-system"):
            return name[len(prefix) : -len("-system")]
    return name


# Libraries that carry a model in water or air: those of gz-sim, Gazebo Classic, uuv_simulator, vrx
# and asv_wave_sim.
_CARRIES = lazy_pattern(
    r"(?i)buoyan|uuv_underwater_object|usv_gazebo_dynamics|lighter_than_air|^surface$"
    r"|^hydrodynamicsplugin$|^gz-waves\d*-hydrodynamics"
)


def carries(filename: str) -> bool:
    """Whether a plugin of a model carries it in water or air."""
    return _CARRIES.search(stem(filename)) is not None


def carried_by(robot: Robot, world: World | None) -> str | None:
    """The file name of the plugin that carries a robot in water or air, if one does.

    Gazebo Sim's system for buoyancy carries all models of its world.
    """
    own = (one.filename for tag in robot.gazebo for one in tag.plugins if carries(one.filename))
    of_world = () if world is None else world.plugins
    return next(iter((*own, *(one for one in of_world if stem(one) == "buoyancy"))), None)


def simulator_of(filename: str) -> str | None:
    """The simulator whose plugin it is, by its name; None where that does not show it."""
    name = filename.rpartition("/")[2].removeprefix("lib")
    if name.startswith(("gz-sim", "ignition-gazebo", "gz_ros2_control", "ign_ros2_control")):
        return SIM
    return CLASSIC if name.startswith(("gazebo_ros_", "gazebo_ros2_control")) else None
