"""Tests of robots with pytest: the fixtures of `wsgen.testing.plugin`, and what they give.

Nothing is loaded before it is used: pytest imports this package in every run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pytest

    from wsgen.model.plan import LaunchPlan
    from wsgen.model.transform import Pose
    from wsgen.model.world import World
    from wsgen.simulation.engine import Contact
    from wsgen.testing.live import Live, LiveRobot, Message
    from wsgen.testing.robot import (
        Joint,
        Limits,
        Link,
        Moved,
        Robot,
        assert_drives,
        assert_reaches,
        assert_stands,
    )
    from wsgen.testing.simulation import Simulation

    needs_ros: pytest.MarkDecorator

__all__ = [
    "Contact",
    "Joint",
    "LaunchPlan",
    "Limits",
    "Link",
    "Live",
    "LiveRobot",
    "Message",
    "Moved",
    "Pose",
    "Robot",
    "Simulation",
    "World",
    "assert_drives",
    "assert_reaches",
    "assert_stands",
    "needs_ros",
]

_MODULES = {
    "Contact": "wsgen.simulation.engine",
    "LaunchPlan": "wsgen.model.plan",
    "Pose": "wsgen.model.transform",
    "World": "wsgen.model.world",
    "Live": "wsgen.testing.live",
    "LiveRobot": "wsgen.testing.live",
    "Message": "wsgen.testing.live",
    "Simulation": "wsgen.testing.simulation",
    "assert_drives": "wsgen.testing.robot",
    "assert_reaches": "wsgen.testing.robot",
    "assert_stands": "wsgen.testing.robot",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module  # noqa: PLC0415  only who uses one pays for its module

    if name == "needs_ros":
        value = _needs_ros()
    else:
        value = getattr(import_module(_MODULES.get(name, "wsgen.testing.robot")), name)
    globals()[name] = value
    return value


def _needs_ros() -> pytest.MarkDecorator:
    """The mark that skips tests where there is no ROS, with what to install as the reason."""
    import os  # noqa: PLC0415  as above

    import pytest  # noqa: PLC0415

    from wsgen.ros.environment.environment import why_no_ros  # noqa: PLC0415

    why = why_no_ros(os.environ)
    reason = "" if why is None else f"needs ROS: {why.message} {why.hint}"
    return pytest.mark.skipif(why is not None, reason=reason)
