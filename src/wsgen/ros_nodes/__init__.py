"""What runs as a process of ROS; the only place that imports rclpy.

Each program is a module that is started with `python -m`, in the environment that
`wsgen.ros_environment` describes.
"""
