"""Launch files: evaluate them without ROS, and read from the plan what they spawn."""
