"""Start a launch file for real: its processes on ROS 2, its robots simulated."""
