"""ROS 2 as wsgen knows and brings it: names, the environment from PyPI, what PyPI lacks.

In: a distribution. Out: names of packages, keys and messages; variables to start nodes with.
It imports `isolation`, `text` and the values below them.
"""
