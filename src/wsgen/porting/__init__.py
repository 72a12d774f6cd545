"""From Gazebo Classic to Gazebo Sim: what packages become on a later distribution of ROS 2.

In: the folders of packages and a target. Out: edits of their files, new files, and a list of what
nobody but the author can port. It imports what is below it, and no command.
"""
