"""ROS 2 for processes that speak it: where its libraries and messages are, sourced or from PyPI."""
