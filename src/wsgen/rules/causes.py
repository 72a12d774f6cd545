"""What follows from what: one cause is one diagnostic.

A robot that has no <collision> falls through the ground. Once the description has been reported
for the one, the run tells nothing new with the other: it says how bad the cause is. The diagnostic
of the run is then folded into that of the description, which takes over its severity and its
message. The numbers stay visible, and whoever fixes the description runs it again.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.urdf.unknown_elements import meant_element

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


# Codes of the run.
EXPLODES = ("SPN052", "SPN057", "SPN061")
MOVES = ("SPN055", "SPN056", "SPN058", "SPN059", "SPN062", *EXPLODES)
SPAWNED = ("SPN053", "SPN054")
DISAGREE = ("SPN065",)  # of what explodes or falls, no two engines make the same


class Consequence(NamedTuple):
    """What a diagnostic about a description explains of a run of the same robot."""

    cause: str  # its code
    follows: tuple[str, ...]  # codes of the run
    errors: tuple[str, ...] = ()  # codes that follow only as errors: as warnings they have
    # another cause, such as joints that are not actuated


# Where several explain the same, the first does.
CONSEQUENCES = (
    # In other units nothing about the run can be believed.
    Consequence("ROB048", (*MOVES, *SPAWNED, *DISAGREE)),  # absurd size
    Consequence("ROB066", (*MOVES, *SPAWNED, *DISAGREE)),  # absurd mesh
    Consequence("ROB049", (*MOVES, *DISAGREE)),  # absurd mass
    # Nothing touches the ground.
    Consequence("ROB053", ("SPN056",)),  # no <collision>
    Consequence("WLD031", ("SPN056", "SPN059")),  # a shape is left out
    # What was written is not what was simulated.
    Consequence("ROB038", (*MOVES, *SPAWNED, *DISAGREE)),  # misspelt element
    Consequence("ROB077", (*MOVES, *SPAWNED, *DISAGREE)),  # misspelt attribute
    Consequence("WLD058", (*MOVES, *SPAWNED, *DISAGREE)),
    Consequence("WLD059", (*MOVES, *SPAWNED, *DISAGREE)),
    # A part falls off.
    Consequence("ROB055", (), errors=("SPN056", "SPN058", "SPN059")),  # floating or planar joint
    Consequence("WLD024", (), errors=("SPN056", "SPN058", "SPN059")),  # joint left out
    # Links that are far too easy to turn shake.
    Consequence("ROB037", EXPLODES, errors=("SPN058",)),  # no inertia
    Consequence("ROB050", EXPLODES, errors=("SPN058",)),  # inertia of another body
    Consequence("WLD035", EXPLODES, errors=("SPN058",)),  # the inertia that Gazebo gives
    Consequence("WLD041", EXPLODES, errors=("SPN058",)),  # no mass
    # The limit pushes the joint to where it may be.
    Consequence("ROB070", EXPLODES, errors=("SPN058",)),
)
MISSPELT = ("ROB038", "ROB077", "WLD058", "WLD059")
MOVING_PART = re.compile(r"(?:^|/)(?:link|joint|gazebo)\b")
WITHOUT_EFFECT = ("visual", "material", "sensor", "plugin", "light", "transmission", "ros2_control")
NAME = re.compile(r"\[@\w+='[^']*'\]")
JOINT = re.compile(r"\bjoint\[@name='([^']*)'\]")


class Folded(NamedTuple):
    """The diagnostics of one robot, each cause once."""

    prepared: tuple[Diagnostic, ...]  # as many as before, with what follows from them
    run: tuple[Diagnostic, ...]  # what nothing in the description explains


def fold_consequences(prepared: Iterable[Diagnostic], run: Iterable[Diagnostic]) -> Folded:
    """Fold what follows from the description of a robot into the diagnostics about that.

    `run` is what has been found in the run of this robot, in any engine.
    """
    causes = list(prepared)
    followed: dict[int, list[Diagnostic]] = {}
    left = []
    for found in run:
        place = _cause_of(found, causes)
        if place is None:
            left.append(found)
        else:
            followed.setdefault(place, []).append(found)
    for place, consequences in followed.items():
        causes[place] = _with_worst(causes[place], consequences)
    return Folded(tuple(causes), tuple(left))


def joints_beyond_limits(prepared: Iterable[Diagnostic]) -> frozenset[str]:
    """The joints that are reported to start outside of their limits, which move them."""
    return frozenset(
        name
        for found in prepared
        if found.code == "ROB070"
        for name in JOINT.findall(found.element or "")
    )


def _cause_of(found: Diagnostic, causes: Sequence[Diagnostic]) -> int | None:
    for row in CONSEQUENCES:
        is_error = found.severity is Severity.ERROR
        if found.code in row.follows or (is_error and found.code in row.errors):
            for place, cause in enumerate(causes):
                if cause.code == row.cause and _has_effect(cause):
                    return place
    return None


def _has_effect(cause: Diagnostic) -> bool:
    """Whether it can change how a robot moves; what is only seen or read cannot."""
    element = cause.element or ""
    tags = NAME.sub("", element).split("/")
    if any(meant_element(tag, WITHOUT_EFFECT) for tag in tags if tag):
        return False
    return cause.code not in MISSPELT or MOVING_PART.search(element) is not None


def _with_worst(cause: Diagnostic, consequences: Sequence[Diagnostic]) -> Diagnostic:
    """The cause, as severe as the worst that follows from it, with the message of that."""
    order = list(Severity)
    worst = min(consequences, key=lambda found: order.index(found.severity))
    message = worst.message
    if not message.startswith("In "):  # else it names its engine
        message = f"In the simulation, {message[0].lower()}{message[1:]}"
    return replace(
        cause,
        severity=min(cause.severity, worst.severity, key=order.index),
        message=f"{cause.message} {message}",
    )
