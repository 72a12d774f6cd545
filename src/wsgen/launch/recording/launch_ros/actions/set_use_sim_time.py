"""Simulated time for what comes next."""

from __future__ import annotations

from typing import Any

from launch_ros.actions.set_parameter import SetParameter


class SetUseSimTime(SetParameter):
    """The parameter `use_sim_time` of all nodes that come next."""

    def __init__(self, value: Any, **kwargs: Any) -> None:
        super().__init__(name="use_sim_time", value=value, **kwargs)
