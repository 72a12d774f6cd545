"""Gazebo's side of ROS: one process that simulates robots and speaks for their plugins."""
