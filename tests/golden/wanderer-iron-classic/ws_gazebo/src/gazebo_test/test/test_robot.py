"""Test the robot of this package, simulated by wsgen without ROS and Gazebo."""

import pytest

try:
    from wsgen.testing import assert_drives, assert_stands
except ImportError:
    pytestmark = pytest.mark.skip(reason='needs wsgen: pip install wsgen')


def test_stands(robot):
    """Stay upright and out of the ground, and come to rest."""
    assert_stands(robot)


def test_drives_straight(robot, simulation):
    """Get 1 m ahead in 2 s at 0.5 m/s, as /cmd_vel commands it."""
    simulation.settle()
    assert_drives(robot, linear=0.5, seconds=2.0, x=1.0, y=0.0, yaw=0.0)
