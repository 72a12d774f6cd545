"""Conditions of package.xml: REP 149."""

import pytest

from wsgen.packages.workspace.manifest import holds


@pytest.mark.parametrize(
    ("condition", "distro", "value"),
    [
        ("$ROS_VERSION == 2", None, True),
        ("$ROS_VERSION != 2", None, False),
        ("$ROS_VERSION==1", None, False),
        ("$ROS_PYTHON_VERSION == 3", None, True),
        ("$ROS_DISTRO == humble", None, None),
        ("$ROS_DISTRO == humble", "humble", True),
        ("'$ROS_DISTRO' == humble", "humble", False),
        ('$ROS_DISTRO == "jazzy"', "humble", False),
        ("$ROS_DISTRO >= iron", "jazzy", True),
        ("$ROS_VERSION == 1 and $ROS_DISTRO == humble", None, False),
        ("$ROS_VERSION == 2 or $ROS_DISTRO == humble", None, True),
        ("$ROS_VERSION == 1 or ($ROS_VERSION == 2 and $ROS_DISTRO < iron)", "humble", True),
        ("$BUILD_WITH_GPU == 1", "humble", None),
        ("$ROS_VERSION", None, None),
        ("($ROS_VERSION == 2", None, None),
        ("$ROS_VERSION == 2 2", None, None),
        ("", None, None),
        ("&", None, None),
    ],
)
def test_what_holds(condition: str, distro: str | None, value: bool | None) -> None:
    assert holds(condition, distro) is value
