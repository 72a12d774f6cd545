"""Test the robot of this package, simulated by wsgen without ROS and Gazebo."""

import pytest

try:
    from wsgen.testing import assert_stands
except ImportError:
    pytestmark = pytest.mark.skip(reason='needs wsgen: pip install wsgen')


def test_stands(robot):
    """Stay upright and out of the ground, and come to rest."""
    assert_stands(robot)
