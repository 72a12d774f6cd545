"""Wait before something is done, in the time of ROS."""

from launch.actions.timer_action import TimerAction


class RosTimer(TimerAction):
    """Its actions, after a period; the time of ROS passes as virtual time does."""


ROSTimer = RosTimer
