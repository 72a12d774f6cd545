"""URDF: read and check a robot, and convert it to what Gazebo makes of it."""
