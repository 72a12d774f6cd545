"""Stand-in for the Python module of ros_gz_bridge, where it is not installed."""
