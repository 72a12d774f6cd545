"""ROS 2 for processes that speak it: where its libraries and messages are, sourced or from PyPI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wsgen.ros.environment.environment import (
        RosEnvironment,
        open_ros,
        paths_with_all_messages,
        variables_of_nodes,
    )

__all__ = ["RosEnvironment", "open_ros", "paths_with_all_messages", "variables_of_nodes"]


def __getattr__(name: str) -> Any:
    """Import what opens a ROS when it is asked for: `wsgen doctor` only asks what is sourced."""
    if name not in __all__:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    from wsgen.ros.environment import environment  # noqa: PLC0415  see above

    return getattr(environment, name)
