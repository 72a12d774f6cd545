"""URDF: read it, and make of it the SDF model that Gazebo makes."""
