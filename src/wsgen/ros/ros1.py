"""What packages, programs and messages of ROS 1 are called in ROS 2.

Sources: the packages of both; ros2/rviz, rviz_default_plugins/plugins_description.xml and
rviz_common; ros/ros_comm.
"""

from __future__ import annotations

# Package and program -> those of ROS 2 that take the same arguments, parameters and topics.
PROGRAMS = {
    ("amcl", "amcl"): ("nav2_amcl", "amcl"),
    ("depthimage_to_laserscan", "depthimage_to_laserscan"): (
        "depthimage_to_laserscan",
        "depthimage_to_laserscan_node",
    ),
    ("joint_state_publisher", "joint_state_publisher_gui"): (
        "joint_state_publisher_gui",
        "joint_state_publisher_gui",
    ),
    ("map_server", "map_saver"): ("nav2_map_server", "map_saver_cli"),
    ("map_server", "map_server"): ("nav2_map_server", "map_server"),
    ("robot_localization", "ekf_localization_node"): ("robot_localization", "ekf_node"),
    ("robot_localization", "ukf_localization_node"): ("robot_localization", "ukf_node"),
    ("robot_state_publisher", "state_publisher"): (
        "robot_state_publisher",
        "robot_state_publisher",
    ),
    ("rviz", "rviz"): ("rviz2", "rviz2"),
    ("teleop_twist_keyboard", "teleop_twist_keyboard.py"): (
        "teleop_twist_keyboard",
        "teleop_twist_keyboard",
    ),
    ("tf", "static_transform_publisher"): ("tf2_ros", "static_transform_publisher"),
    ("tf", "tf_echo"): ("tf2_ros", "tf2_echo"),
    ("tf", "tf_monitor"): ("tf2_ros", "tf2_monitor"),
    ("usb_cam", "usb_cam_node"): ("usb_cam", "usb_cam_node_exe"),
    ("urg_node", "urg_node"): ("urg_node", "urg_node_driver"),
}
# Packages whose programs have their names in ROS 2, too, and take the same arguments.
SAME_PROGRAMS = frozenset(
    (
        *("cartographer_ros", "diagnostic_aggregator", "image_view", "joint_state_publisher"),
        *("joint_state_publisher_gui", "joy", "laser_filters", "moveit_ros_move_group"),
        *("pointcloud_to_laserscan", "robot_localization", "robot_state_publisher"),
        *("teleop_twist_joy", "tf2_ros", "topic_tools", "twist_mux"),
    )
)
LIFECYCLE = frozenset((("nav2_amcl", "amcl"), ("nav2_map_server", "map_server")))
# Programs without a counterpart that takes the same parameters -> what to do.
INSTEAD = {
    "dynamic_reconfigure": "Set parameters by `ros2 param set`.",
    "gmapping": "Use slam_toolbox, whose parameters are others.",
    "hector_mapping": "Use slam_toolbox, whose parameters are others.",
    "move_base": "Use nav2_bringup's navigation_launch.py, whose file of parameters is another.",
    "nodelet": "Load the component of the same package, if it has one, into a container of "
    "rclcpp_components.",
    "robot_pose_ekf": "Use ekf_node of robot_localization, whose parameters are others.",
    "rosbag": "Convert the bag, and use `ros2 bag`.",
    "rosparam": "Give the parameters to the node.",
    "rosserial_arduino": "Use micro-ROS.",
    "rosserial_python": "Use micro-ROS.",
    "rosservice": "Call the service by `ros2 service call`, which needs its type.",
    "rostopic": "Use `ros2 topic`.",
    "slam_gmapping": "Use slam_toolbox, whose parameters are others.",
}
# Launch file of another package -> package and launch file of ROS 2.
LAUNCH_FILES = {
    ("realsense2_camera", "rs_camera.launch"): ("realsense2_camera", "rs_launch.py"),
    ("teleop_twist_joy", "teleop.launch"): ("teleop_twist_joy", "teleop-launch.py"),
    ("velodyne_pointcloud", "VLP16_points.launch"): (
        "velodyne",
        "velodyne-all-nodes-VLP16-launch.py",
    ),
}
# The launch files of gazebo_ros that start Gazebo -> the world of Gazebo Classic, if not the empty.
GAZEBO_LAUNCH_FILES = {
    "empty_world.launch": "",
    **{
        f"{name}_world.launch": f"worlds/{name}.world"
        for name in ("elevator", "mud", "range", "rubble", "shapes", "willowgarage")
    },
}
# Launch argument of empty_world.launch -> that of ROS 2's gazebo.launch.py.
GAZEBO_ARGUMENTS = {"world_name": "world", "paused": "pause", "gui": "gui", "verbose": "verbose"}
# Programs of gazebo_ros that spawn a model.
SPAWNERS = frozenset(("spawn_model", "spawn_model.py", "spawn_urdf", "urdf_spawner"))
GAZEBO_PROGRAMS = ("gazebo", "gzserver", "debug", "perf")  # of gazebo_ros, which start a server

# Classes of std_msgs whose only field is `data`.
DATA_MESSAGES = frozenset(
    (
        *("Bool", "Byte", "Char", "String", "Float32", "Float64", "Int8", "Int16", "Int32"),
        *("Int64", "UInt8", "UInt16", "UInt32", "UInt64"),
    )
)
# Types of fields of messages -> those of ROS 2.
FIELD_TYPES = {
    "Header": "std_msgs/Header",
    "time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
}

# Classes of rviz's own plugins -> the package of ROS 2 that has them.
RVIZ_CLASSES = {
    **dict.fromkeys(
        (
            *("AccelStamped", "Axes", "Camera", "DepthCloud", "Effort", "FluidPressure", "Grid"),
            *("GridCells", "Illuminance", "Image", "InteractiveMarkers", "LaserScan", "Map"),
            *("Marker", "MarkerArray", "Odometry", "Path", "PointCloud", "PointCloud2"),
            *("PointStamped", "Polygon", "Pose", "PoseArray", "PoseWithCovariance", "Range"),
            *("RelativeHumidity", "RobotModel", "TF", "Temperature", "TwistStamped", "Wrench"),
            *("FocusCamera", "Interact", "Measure", "MoveCamera", "PublishPoint", "Select"),
            *("SetGoal", "SetInitialPose", "FPS", "FrameAligned", "Orbit"),
            *("ThirdPersonFollower", "TopDownOrtho", "XYOrbit"),
        ),
        "rviz_default_plugins",
    ),
    **dict.fromkeys(
        ("Displays", "Group", "Help", "Selection", "Time", "Tool Properties", "Views"),
        "rviz_common",
    ),
}
RVIZ_PLUGINS = {"moveit_rviz_plugin": "moveit_ros_visualization"}  # prefix of classes -> package
RVIZ_RENAMED = {"WrenchStamped": "Wrench"}  # classes
# Properties of displays -> what rviz2 calls them.
RVIZ_PROPERTIES = {
    "Image Topic": "Topic",
    "Marker Topic": "Topic",
    "Robot Description": "Description Topic",
}
