"""Test the robot of this package, simulated by wsgen without ROS and Gazebo."""

import pytest

try:
    from wsgen.testing import assert_drives, assert_stands, needs_ros
except ImportError:
    pytestmark = pytest.mark.skip(reason='needs wsgen: pip install wsgen')
    needs_ros = pytest.mark.skip


def test_stands(robot):
    """Stay upright and out of the ground, and come to rest."""
    assert_stands(robot)


def test_drives_straight(robot, simulation):
    """Get 1 m ahead in 2 s at 0.5 m/s, as /cmd_vel commands it."""
    simulation.settle()
    assert_drives(robot, linear=0.5, seconds=2.0, x=1.0, y=0.0, yaw=0.0)


@needs_ros
def test_wanders(live):
    """Drive ahead in simulated time: with the node, and with ROS 2, sourced or from PyPI."""
    with live(launch_file='gazebo_model.launch.py') as ros:
        ros.wait_until(lambda: ros.robot.pose.x > 0.5, seconds=20.0)
