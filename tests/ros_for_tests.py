"""The ROS 2 of PyPI for slow tests: made once on a machine, in the cache of the user.

On a fresh machine that takes 46 MB of download, 110 MB of disk and 20 s, and messages that PyPI
lacks some more, once. What is there is found in a moment.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.errors import NotFoundError
from wsgen.ros_environment import RosEnvironment, open_ros
from wsgen.ros_environment.machines import why_not
from wsgen.ros_environment.sourced import sourced_prefix

if TYPE_CHECKING:
    from collections.abc import Mapping

OF_ROS = ("AMENT_", "CMAKE_PREFIX_PATH", "COLCON_", "CYCLONEDDS_", "FASTRTPS_", "RMW_", "ROS_")
DOMAINS = range(10, 100)  # ports of higher ones are also given to programs that ask for any


def plain_environment() -> dict[str, str]:
    """The variables of a shell in which no ROS is sourced."""
    variables = {name: value for name, value in os.environ.items() if not name.startswith(OF_ROS)}
    for name in ("LD_LIBRARY_PATH", "PYTHONPATH"):
        variables.pop(name, None)
    return variables


def ros_domain() -> str:
    """A ROS_DOMAIN_ID that another process of the tests does not have."""
    worker = os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")
    # Runs of tests beside each other have other parents, workers of a run have the same one.
    first = os.getppid() * 16
    return str(DOMAINS[(first + int(worker)) % len(DOMAINS)])


def ros_with(*messages: str) -> RosEnvironment:
    """The ROS of PyPI with these packages of messages; skips where there is none."""
    if (reason := why_not()) is not None:
        pytest.skip(reason.message)
    environment = plain_environment()
    assert sourced_prefix(environment) is None
    try:
        return open_ros(environment, messages=messages, listener=lambda _: None)
    except NotFoundError as error:
        if "no connection" in error.message:
            pytest.skip(error.message)
        raise


def variables_for(ros: RosEnvironment, more: Mapping[str, str] | None = None) -> dict[str, str]:
    """The variables of a process of this run of tests that speaks ROS."""
    return {**plain_environment(), **ros.variables, "ROS_DOMAIN_ID": ros_domain(), **(more or {})}


@pytest.fixture(scope="session")
def ros() -> RosEnvironment:
    """The ROS of PyPI with tf2_msgs; others: `ros_with("control_msgs")`."""
    return ros_with()
