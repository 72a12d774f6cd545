"""Robots and packages from elsewhere become packages of a target of ROS 2.

In: the folders of packages for Gazebo Classic, or a robot that already exists (`existing`), and a
target. Out: edits of their files, new files, and a list of what nobody but the author can port. It
imports what is below it, and no command.
"""
