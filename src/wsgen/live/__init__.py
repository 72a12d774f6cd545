"""Start a launch file for real: its processes on ROS 2, its robots simulated.

In: a plan. Out: processes that are kept in order and ended; `nodes` has what runs as a process of
ROS, and alone imports rclpy. It imports `pipeline` and what is below; nothing below imports it.
"""
