"""The action of ros_gz_bridge."""

from launch.frontend.expose import expose_action
from wsgen.launching.ros_packages.including import CONTAINER, IncludingAction


@expose_action("ros_gz_bridge")
class RosGzBridge(IncludingAction):
    """Starts the bridge between ROS and Gazebo, as a process or in a container."""

    launch_file = ("ros_gz_bridge", "ros_gz_bridge.launch.py")
    required = ("bridge_name", "config_file")
    defaults = {**CONTAINER, "namespace": "", "use_respawn": "False", "log_level": "info"}  # noqa: RUF012
    ignored = frozenset(("bridge_params", "extra_bridge_params"))
