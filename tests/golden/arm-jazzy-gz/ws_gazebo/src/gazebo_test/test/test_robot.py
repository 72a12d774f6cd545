"""Test the robot of this package, simulated by wsgen without ROS and Gazebo."""

import pytest

wsgen = pytest.importorskip('wsgen.testing', reason='needs wsgen: pip install wsgen')


def test_stands(robot):
    """Stay upright and out of the ground, and come to rest."""
    wsgen.assert_stands(robot)


def test_holds_its_pose(robot):
    """Keep all joints at 0 against gravity."""
    wsgen.assert_reaches(robot, dict.fromkeys(robot.joints, 0.0))
