"""All actions of ROS."""

from launch._lazy import finder

_HOMES = {
    "ComposableNodeContainer": "composable_node_container",
    "LifecycleNode": "lifecycle_node",
    "LifecycleTransition": "lifecycle_transition",
    "LoadComposableNodes": "load_composable_nodes",
    "Node": "node",
    "PushROSNamespace": "push_ros_namespace",
    "PushRosNamespace": "push_ros_namespace",
    "ROSTimer": "ros_timer",
    "RosTimer": "ros_timer",
    "SetParameter": "set_parameter",
    "SetParametersFromFile": "set_parameters_from_file",
    "SetROSLogDir": "set_ros_log_dir",
    "SetRemap": "set_remap",
    "SetUseSimTime": "set_use_sim_time",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
