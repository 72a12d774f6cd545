"""What a plugin of one simulator is in the other, and what one of ROS 1 is in ROS 2.

Source: the repositories that `plugins` names; the migration guide of ros_gz.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.gazebo.plugins import stem
from wsgen.gazebo.systems import library_of
from wsgen.text.tables import read_table

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

# What moves the joints of a robot in Gazebo Sim.
_DRIVES = (
    *("diff-drive", "ackermann-steering", "mecanum-drive", "tracked-vehicle", "velocity-control"),
    *("gz_ros2_control-system", "ign_ros2_control-system"),
)
_STATES = ("joint-state-publisher", "gz_ros2_control-system", "ign_ros2_control-system")
# What publishes the states of joints in either simulator.
STATES = frozenset((*_STATES, "gazebo_ros_joint_state_publisher", "gazebo_ros2_control"))
# Plugin of Gazebo Classic -> those of Gazebo Sim that do the same in a robot for both.
COUNTERPARTS = {
    **dict.fromkeys(
        (
            *("gazebo_ros_diff_drive", "gazebo_ros_ackermann_drive", "gazebo_ros_planar_move"),
            *("gazebo_ros_tricycle_drive", "gazebo_ros2_control"),
        ),
        _DRIVES,
    ),
    "gazebo_ros_joint_state_publisher": _STATES,
    "gazebo_ros_joint_pose_trajectory": (*_STATES, "joint-trajectory-controller"),
    "gazebo_ros_p3d": ("odometry-publisher", "pose-publisher"),
    "gazebo_ros_ft_sensor": ("forcetorque",),
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


class Conversion(NamedTuple):
    """What a plugin of Gazebo Classic becomes in Gazebo Sim."""

    system: str  # the class of the system
    renamed: Mapping[str, str]  # parameters that it has, too: what they are called there
    topics: Mapping[str, str]  # what topics are for -> the parameter with their name
    # Parameters that it lacks, with what the author may do; what they did where it is not plain.
    lost: Mapping[str, str] = MappingProxyType({})
    written: tuple[str, ...] = ()  # those whose default differs: Classic's is written out


_ODOMETRY_LOST = {
    f"covariance_{axis}": "Set the covariance in the node that reads the odometry."
    for axis in ("x", "y", "yaw")
}
_SAME_WHEELS = {name: name for name in ("left_joint", "right_joint", "wheel_separation")}
CONVERSIONS = {
    "gazebo_ros_diff_drive": Conversion(
        "DiffDrive",
        {**_SAME_WHEELS, "wheel_diameter": "wheel_radius"},
        {"command": "topic"},
        _ODOMETRY_LOST,
        ("wheel_separation", "wheel_diameter"),
    ),
    "gazebo_ros_ackermann_drive": Conversion(
        "AckermannSteering",
        {
            "rear_left_joint": "left_joint",
            "rear_right_joint": "right_joint",
            "left_steering_joint": "left_steering_joint",
            "right_steering_joint": "right_steering_joint",
            "max_steer": "steering_limit",
            "max_speed": "max_velocity",
        },
        {"command": "topic"},
        {
            **_ODOMETRY_LOST,
            "publish_distance": "Add up the distance in a node that reads the odometry.",
            "publish_steerangle": "Read the angle from the joint states.",
        },
        ("max_steer", "max_speed"),
    ),
    "gazebo_ros_planar_move": Conversion(
        "VelocityControl", {}, {"command": "topic"}, _ODOMETRY_LOST
    ),
    "gazebo_ros_joint_state_publisher": Conversion(
        "JointStatePublisher",
        {"joint_name": "joint_name", "update_rate": "update_rate"},
        {"states": "topic"},
        written=("update_rate",),
    ),
    "gazebo_ros_joint_pose_trajectory": Conversion(
        "JointTrajectoryController", {}, {"command": "topic"}
    ),
    "gazebo_ros_p3d": Conversion(
        "OdometryPublisher",
        {
            "frame_name": "odom_frame",
            "body_name": "robot_base_frame",
            "update_rate": "odom_publish_frequency",
            "gaussian_noise": "gaussian_noise",
            "xyz_offset": "xyz_offset",
            "rpy_offset": "rpy_offset",
            "xyz_offsets": "xyz_offset",
            "rpy_offsets": "rpy_offset",
        },
        {"odometry": "odom_topic"},
        written=("frame_name", "update_rate"),
    ),
    **dict.fromkeys(
        ("gazebo_ros_wheel_slip", "WheelSlipPlugin"),
        Conversion("WheelSlip", {"wheel": "wheel"}, {}),
    ),
    "LiftDragPlugin": Conversion(
        "LiftDrag",
        {
            name: name
            for name in (
                *("air_density", "cla", "cla_stall", "cda", "cda_stall", "cma", "cma_stall"),
                *("alpha_stall", "a0", "area", "upward", "forward", "link_name", "cp"),
                *("radial_symmetry", "control_joint_name", "control_joint_rad_to_cl"),
            )
        },
        {},
    ),
}
# Plugin of Gazebo Classic -> what a robot has instead for Gazebo Sim.
SUCCESSORS = {
    **{
        f"gazebo_ros_{name}": library_of(CONVERSIONS[f"gazebo_ros_{name}"].system)
        for name in ("diff_drive", "joint_state_publisher", "ackermann_drive", "p3d", "planar_move")
    },
    "gazebo_ros_ft_sensor": library_of("ForceTorque"),
    "gazebo_ros2_control": "gz_ros2_control-system",
}
# Parameters of the odometry of Classic's drives -> those of the publisher of Gazebo Sim, where the
# odometry is the pose in the world.
ODOMETRY = {"odometry_frame": "odom_frame", "robot_base_frame": "robot_base_frame"}
# Likewise, those of Gazebo Sim's drives, which know it by their wheels.
ODOMETRY_OF_WHEELS = {"odometry_frame": "frame_id", "robot_base_frame": "child_frame_id"}
# What Ackermann drives of Gazebo Sim are told, and find out in Gazebo Classic.
MEASURED = ("wheel_separation", "kingpin_width", "wheel_base", "wheel_radius")

ONLY_IN_ROS_1 = ("gazebo_ros_control",)  # with ROS 2, Gazebo Classic had not found it either
# Plugins of Gazebo Classic without a counterpart: what they do, and what to do.
WITHOUT_COUNTERPART = {
    "gazebo_ros_tricycle_drive": (
        "drives a tricycle",
        "Use gz_ros2_control with the tricycle_controller of ros2_controllers.",
    ),
    "gazebo_ros_control": (
        "is the ros_control of ROS 1",
        "Describe the joints in <ros2_control>, and load gz_ros2_control-system.",
    ),
    **dict.fromkeys(
        ("gazebo_mimic_joint_plugin", "roboticsgroup_gazebo_mimic_joint_plugin"),
        (
            "has a joint follow another one",
            "Write <mimic> into the <joint>: gz_ros2_control follows it.",
        ),
    ),
    "gazebo_grasp_fix": (
        "holds what a gripper has grasped",
        "Use gz-sim-detachable-joint-system, or friction alone.",
    ),
    "gazebo_ros_force": (
        "pushes a link as messages say",
        "Use gz-sim-apply-link-wrench-system, and bridge its topic.",
    ),
    "gazebo_ros_vacuum_gripper": (
        "attaches what a suction cup touches",
        "Use gz-sim-detachable-joint-system.",
    ),
    "gazebo_ros_elevator": ("moves an elevator", "Use gz-sim-elevator-system."),
    "gazebo_ros_harness": ("lets a model down on a rope", "Use a joint with a controller."),
    "gazebo_ros_hand_of_god": (
        "moves a model to a frame of tf",
        "Use gz-sim-velocity-control-system.",
    ),
    "gazebo_ros_projector": ("projects a texture", "Use the <projector> of SDF."),
    "gazebo_ros_video": ("shows images on a visual", "Show the images in RViz."),
    "realsense_gazebo_plugin": (
        "publishes what the cameras of a RealSense see",
        "Write a sensor of the type rgbd_camera, with a <topic>, and bridge its topics.",
    ),
    "BuoyancyPlugin": ("has a model float", "Use gz-sim-buoyancy-system in the world."),
    "DiffDrivePlugin": ("drives two wheels", "Use gz-sim-diff-drive-system."),
    "LedPlugin": ("has lights blink", "Use gz-sim-led-plugin-system."),
    "KeysToCmdVelPlugin": ("drives by the keyboard", "Use teleop_twist_keyboard."),
    "RayPlugin": ("does nothing but to have a sensor measure", "Leave it out."),
    "ContactPlugin": ("prints what a sensor touches", "Read the topic of the sensor."),
}
# Those of them that only people notice: they show or print something.
TO_LOOK_AT = ("gazebo_ros_video", "LedPlugin", "RayPlugin", "ContactPlugin")
# Those of ROS 1, and of others -> those of gazebo_plugins that do the same in ROS 2.
AS_IN_ROS_2 = {
    "gazebo_ros_skid_steer_drive": "gazebo_ros_diff_drive",
    **dict.fromkeys(
        (
            *("gazebo_ros_laser", "gazebo_ros_gpu_laser", "gazebo_ros_block_laser"),
            *("gazebo_ros_range", "gazebo_ros_velodyne_laser", "gazebo_ros_velodyne_gpu_laser"),
        ),
        "gazebo_ros_ray_sensor",
    ),
    **dict.fromkeys(("gazebo_ros_imu", "hector_gazebo_ros_imu"), "gazebo_ros_imu_sensor"),
    **dict.fromkeys(
        ("gazebo_ros_depth_camera", "gazebo_ros_openni_kinect", "gazebo_ros_multicamera"),
        "gazebo_ros_camera",
    ),
    "gazebo_ros_f3d": "gazebo_ros_ft_sensor",
    "hector_gazebo_ros_gps": "gazebo_ros_gps_sensor",
    **dict.fromkeys(
        ("gazebo_ros_joint_pose_trajectory_plugin", "gazebo_ros_joint_trajectory"),
        "gazebo_ros_joint_pose_trajectory",
    ),
}
# Plugin libraries that no ROS 2 release has, with what took their place; Velodyne's are in both.
ROS_1_PLUGINS = {
    "gazebo_ros_control": "libgazebo_ros2_control.so with <ros2_control> tags",
    **{old: f"lib{new}.so" for old, new in AS_IN_ROS_2.items() if "velodyne" not in old},
    "gazebo_ros_skid_steer_drive": "libgazebo_ros_diff_drive.so with two wheel pairs",
    "gazebo_mimic_joint_plugin": "<mimic> with gazebo_ros2_control",
    "roboticsgroup_gazebo_mimic_joint_plugin": "<mimic> with gazebo_ros2_control",
}
# Their parameters -> those of ROS 2, where snake case is not it.
PARAMETERS_OF_ROS_1 = {
    **dict.fromkeys(("torque", "wheelTorque"), "max_wheel_torque"),
    "wheelAcceleration": "max_wheel_acceleration",
    **dict.fromkeys(("leftFrontJoint", "leftRearJoint"), "left_joint"),
    **dict.fromkeys(("rightFrontJoint", "rightRearJoint"), "right_joint"),
    **dict.fromkeys(("publishTf", "publishOdomTF", "broadcastTF"), "publish_odom_tf"),
    "publishWheelTF": "publish_wheel_tf",
}
# What messages a laser of ROS 1 sends; another one sends scans.
TYPES_OF_ROS_1 = {
    **dict.fromkeys(
        (
            *("gazebo_ros_block_laser", "gazebo_ros_velodyne_laser"),
            "gazebo_ros_velodyne_gpu_laser",
        ),
        "sensor_msgs/PointCloud2",
    ),
    "gazebo_ros_range": "sensor_msgs/Range",
}

# Types of sensors of Gazebo Classic -> those of Gazebo Sim; the element that describes them.
SENSOR_TYPES = {
    **dict.fromkeys(("ray", "gpu_ray"), "gpu_lidar"),
    "gps": "navsat",
    "depth": "rgbd_camera",
}
SENSOR_ELEMENTS = {"ray": "lidar", "gps": "navsat"}
NO_TOPIC = "__default_topic__"  # that of sensors of Gazebo Classic which name none

# Materials of Gazebo Classic that are textures.
TEXTURED = frozenset(
    f"Gazebo/{name}"
    for name in (
        *("Wood", "WoodFloor", "WoodPallet", "CeilingTiled", "PaintedWall", "Bricks", "Road"),
        *("Residential", "Grass", "Pedestrian"),
    )
)
# The specular colors of the materials of Gazebo Classic, where they are not 0.1 (gazebo.material).
SPECULARS = {
    **dict.fromkeys(("Gazebo/Grey", "Gazebo/Gray", "Gazebo/FlatBlack", "Gazebo/Road"), 0.01),
    **dict.fromkeys(("Gazebo/Residential", "Gazebo/Pedestrian"), 0.01),
    **dict.fromkeys(("Gazebo/DarkGrey", "Gazebo/DarkGray"), 0.175),
    **dict.fromkeys(("Gazebo/Yellow", "Gazebo/DarkYellow", "Gazebo/YellowGlow"), 0.0),
    **dict.fromkeys(("Gazebo/RedGlow", "Gazebo/WoodPallet"), 0.0),
    **dict.fromkeys(("Gazebo/Wood", "Gazebo/Bricks"), 0.2),
    "Gazebo/Gold": 0.4,
    "Gazebo/Orange": 0.5,
}


# Messages and services of gazebo_msgs: what programs do instead in Gazebo Sim.
_POSES = "Read poses from /world/NAME/dynamic_pose/info, bridged as tf2_msgs/msg/TFMessage."
_SERVICES = "Call SpawnEntity, DeleteEntity and SetEntityPose of ros_gz_interfaces, bridged."
INSTEAD_OF_MESSAGES = {
    **dict.fromkeys(("GetEntityState", "GetModelList", "ModelStates", "LinkStates"), _POSES),
    **dict.fromkeys(("SpawnEntity", "DeleteEntity", "SetEntityState"), _SERVICES),
    "ApplyLinkWrench": "Publish ros_gz_interfaces/msg/EntityWrench, bridged to /world/NAME/wrench "
    "of the system ApplyLinkWrench.",
    "ApplyJointEffort": "Publish to the topic of the system ApplyJointForce of the joint.",
    "ContactsState": "Read ros_gz_interfaces/msg/Contacts, bridged from the sensor.",
}


# Environment variable of Gazebo Classic, or of Fortress -> that of Gazebo Sim.
VARIABLES = {
    "GAZEBO_MODEL_PATH": "GZ_SIM_RESOURCE_PATH",
    "GAZEBO_RESOURCE_PATH": "GZ_SIM_RESOURCE_PATH",
    "GAZEBO_MEDIA_PATH": "GZ_SIM_RESOURCE_PATH",
    "GAZEBO_PLUGIN_PATH": "GZ_SIM_SYSTEM_PLUGIN_PATH",
    "IGN_GAZEBO_RESOURCE_PATH": "GZ_SIM_RESOURCE_PATH",
    "IGN_GAZEBO_SYSTEM_PLUGIN_PATH": "GZ_SIM_SYSTEM_PLUGIN_PATH",
}
# Plugins of worlds of Gazebo Classic that are gone without a loss, and the others: what they did,
# and what there is instead.
OF_ANY_WORLD = ("gazebo_ros_init", "gazebo_ros_factory")
OF_SERVICES = ("gazebo_ros_state", "gazebo_ros_properties", "gazebo_ros_force_system")
OF_WORLDS = {
    "gazebo_ros_state": (
        "published the poses of all models and links, and set them by services",
        "Bridge /world/NAME/dynamic_pose/info and the service /world/NAME/set_pose.",
    ),
    "gazebo_ros_properties": (
        "changed properties of models and of the physics by services",
        "Write them into the world or the robot; /world/NAME/set_physics is a service of Gazebo.",
    ),
    "gazebo_ros_force_system": (
        "pushed links and joints by services",
        "Publish to /world/NAME/wrench of the system ApplyLinkWrench, which takes its place.",
    ),
    "gazebo_ros_elevator": ("moved an elevator", "Use gz-sim-elevator-system."),
    "WindPlugin": ("had the wind blow", "Use gz-sim-wind-effects-system."),
    "StaticMapPlugin": ("drew a map of the earth", "Use a heightmap or a textured plane."),
}
IN_PLACE_OF_WORLDS = {"gazebo_ros_force_system": "ApplyLinkWrench"}

# Models of the database of Gazebo Classic -> those of Open Robotics on Fuel, which are the same.
FUEL = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/"
ON_FUEL = {name: " ".join(words) for name, words in read_table(__file__, "on-fuel.txt").items()}
# Meshes of actors that Gazebo Classic ships and this model on Fuel has.
ACTOR = "https://fuel.gazebosim.org/1.0/Mingfei/models/actor/tip/files/meshes/"
MESHES_OF_ACTORS = ("talk_b.dae", "walk.dae")


def is_served(name: str, right: Collection[str]) -> bool:
    """Whether plugins for the right simulator do what one for the other does."""
    same = COUNTERPARTS.get(name) or [
        classic for classic, systems in COUNTERPARTS.items() if name in systems
    ]
    # Of sensors and of what only one simulator has, any plugin shows that both are meant.
    return any(one in right for one in same) if same else bool(right)


def predecessor(name: str) -> str | None:
    """The plugin of Gazebo Classic that a system of Gazebo Sim follows, by its stem."""
    for classic, system in SUCCESSORS.items():
        if stem(system) == name:
            return f"lib{classic}.so"
    return None
