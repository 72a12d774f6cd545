"""colcon's world: the workspace's folders, its packages, the toolchain, the build, the overlay."""
