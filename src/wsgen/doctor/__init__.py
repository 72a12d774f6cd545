"""What this machine has of what wsgen and ROS 2 require.

In: the machine. Out: a report with what to install.
It imports `simulation`, `rendering` and what is below them.
"""
