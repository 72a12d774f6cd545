"""Test the robot of this package, simulated by wsgen without ROS and Gazebo."""

import pytest

wsgen = pytest.importorskip('wsgen.testing', reason='needs wsgen: pip install wsgen')


def test_stands(robot):
    """Stay upright and out of the ground, and come to rest."""
    wsgen.assert_stands(robot)


def test_drives_straight(robot, simulation):
    """Get 1 m ahead in 2 s at 0.5 m/s, as /cmd_vel commands it."""
    simulation.settle()
    wsgen.assert_drives(robot, linear=0.5, seconds=2.0, x=1.0, y=0.0, yaw=0.0)
