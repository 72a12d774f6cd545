"""The ROS 2 of PyPI for slow tests: made once on a machine, in the cache of the user.

On a fresh machine that takes 46 MB of download, 110 MB of disk and 20 s, and messages that PyPI
lacks some more, once. What is there is found in a moment.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from own_network import outside, own_network, ros_domain
from wsgen.errors import NotFoundError
from wsgen.ros.environment import RosEnvironment, open_ros
from wsgen.ros.environment.available import sourced_prefix, why_not

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

OF_ROS = ("AMENT_", "CMAKE_PREFIX_PATH", "COLCON_", "CYCLONEDDS_", "FASTRTPS_", "RMW_", "ROS_")


def plain_environment() -> dict[str, str]:
    """The variables of a shell in which no ROS is sourced."""
    variables = {name: value for name, value in os.environ.items() if not name.startswith(OF_ROS)}
    for name in ("LD_LIBRARY_PATH", "PYTHONPATH"):
        variables.pop(name, None)
    return variables


def ros_with(*messages: str) -> RosEnvironment:
    """The ROS of PyPI with these packages of messages; skips where there is none."""
    if (reason := why_not()) is not None:
        pytest.skip(reason.message)
    environment = plain_environment()
    assert sourced_prefix(environment) is None
    try:
        with outside():  # pip needs the network
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


@pytest.fixture(scope="module", autouse=True)
def network_of_ros(request: pytest.FixtureRequest) -> Iterator[None]:
    """Start the programs of files that import something from here in a network of their own."""
    if any(getattr(one, "__module__", None) == __name__ for one in vars(request.module).values()):
        with own_network():
            yield
    else:
        yield
