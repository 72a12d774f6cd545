"""colcon's world: the folders of a workspace, its packages, its settings and its overlay."""
