"""wsgen: from a name to a robot standing in a simulator, on a machine that has never seen ROS."""

__version__ = "0.1.0"
