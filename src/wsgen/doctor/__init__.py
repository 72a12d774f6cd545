"""What this machine has of what wsgen and ROS 2 require."""
