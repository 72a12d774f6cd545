"""`sensor_msgs_py` for nodes where it is not installed: the numbers of point clouds."""
