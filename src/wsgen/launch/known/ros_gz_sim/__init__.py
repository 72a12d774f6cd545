"""Stand-in for the Python module of ros_gz_sim, where it is not installed."""
