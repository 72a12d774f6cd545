"""ROS 2 for processes that speak it: where its libraries and messages are, sourced or from PyPI."""

from wsgen.ros_environment.environment import RosEnvironment, open_ros

__all__ = ["RosEnvironment", "open_ros"]
