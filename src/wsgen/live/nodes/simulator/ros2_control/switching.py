"""Which controllers may be active together: the rules of the controller manager.

Source: ros-controls/ros2_control, controller_manager/src/controller_manager.cpp
(`switch_controller`), and hardware_interface/src/resource_manager.cpp.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

UNCONFIGURED, INACTIVE, ACTIVE = "unconfigured", "inactive", "active"
BEST_EFFORT, STRICT, AUTO, FORCE_AUTO = 1, 2, 3, 4


class Candidate(NamedTuple):
    """A controller that is loaded."""

    name: str
    state: str
    commands: tuple[str, ...] = ()  # interfaces that it claims
    states: tuple[str, ...] | None = ()  # that it reads; None: all


class Available(NamedTuple):
    """What the hardware has, and who has it."""

    commands: Collection[str]
    states: Collection[str]
    claims: Mapping[str, str]  # command interface -> controller


class Switch(NamedTuple):
    """What is done."""

    activate: tuple[str, ...]
    deactivate: tuple[str, ...]
    problems: tuple[str, ...]  # with STRICT, nothing is done if one exists
    is_refused: bool


def plan_switch(
    loaded: Mapping[str, Candidate],
    available: Available,
    activate: Sequence[str],
    deactivate: Sequence[str],
    strictness: int,
) -> Switch:
    """What a request to switch controllers comes to."""
    is_strict = strictness in {STRICT, 0}
    problems: list[str] = []
    stops: list[str] = []
    for name in dict.fromkeys(deactivate):
        one = loaded.get(name)
        if one is None:
            problems.append(_unknown(name, "deactivate"))
        elif one.state != ACTIVE:
            problems.append(
                f"Could not deactivate controller with name '{name}' because it is not active"
            )
        else:
            stops.append(name)
    starts: list[str] = []
    held = {interface: owner for interface, owner in available.claims.items() if owner not in stops}
    for name in dict.fromkeys(activate):
        problem = _obstacle(name, loaded, available, held, stops)
        if problem is None:
            starts.append(name)
            held.update(dict.fromkeys(loaded[name].commands, name))
        else:
            problems.append(problem)
    refused = is_strict and bool(problems)
    return Switch(
        () if refused else tuple(starts), () if refused else tuple(stops), tuple(problems), refused
    )


def _unknown(name: str, what: str) -> str:
    return (
        f"Could not {what} controller with name '{name}' because no controller with this name "
        "exists"
    )


def _obstacle(
    name: str,
    loaded: Mapping[str, Candidate],
    available: Available,
    held: Mapping[str, str],
    stops: Collection[str],
) -> str | None:
    one = loaded.get(name)
    if one is None:
        return _unknown(name, "activate")
    if one.state == ACTIVE and name not in stops:
        return f"Controller with name '{name}' is already active"
    if one.state not in {INACTIVE, ACTIVE}:
        return f"Controller with name '{name}' is in state '{one.state}': it is not configured"
    for kind, names, there in (
        ("command", one.commands, available.commands),
        ("state", one.states or (), available.states),
    ):
        missing = [interface for interface in names if interface not in there]
        if missing:
            return (
                f"Could not activate controller '{name}': the hardware has no {kind} interface "
                f"{', '.join(f'`{interface}`' for interface in missing)}. Available: "
                f"{', '.join(there) or 'none'}."
            )
    for interface in one.commands:
        if interface in held:
            return (
                f"Resource conflict for controller '{name}': command interface '{interface}' is "
                f"already claimed by '{held[interface]}'"
            )
    return None
