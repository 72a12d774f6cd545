"""Rules about friction that has a direction, as that of mecanum wheels.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING

from wsgen.checks.rules.settings import FRICTION_DIRECTION, without
from wsgen.diagnostics import Rule, Severity
from wsgen.model.engines import name_engines
from wsgen.model.robot import JointType
from wsgen.model.transform import rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Collision, Link, Robot, Surface
    from wsgen.model.transform import Vector

ROLLERS = 0.5  # times the larger coefficient
ALONG = 0.999  # the cosine between two directions that are one
ACROSS = math.sqrt(1 - ALONG**2)  # the cosine between two that are at right angles

TURNING_FRICTION = Rule(
    code="ROB141",
    name="turning-friction-direction",
    severity=Severity.WARNING,
    summary="The friction direction of a wheel turns with the wheel.",
    what="Looks at links of `continuous` joints with a `<fdir1>` other than the axis, where one of "
    "the coefficients `<mu1>` (`<mu>`) and `<mu2>` is less than half of the other. Reports those "
    "whose `gz:expressed_in` does not name a link that Gazebo has after it lumps fixed joints.",
    why="Gazebo simulates mecanum wheels by a friction direction that is fixed to the robot. Where "
    "`gz:expressed_in` is missing, or names a link that is lumped into another one, Gazebo uses "
    "the frame of the wheel: the robot drives forward, but only moves back and forth when "
    "commanded sideways. sdformat drops the attribute of a `<fdir1>` beside `<mu1>`.",
    example='<gazebo reference="front_left_wheel">\n'
    "  <mu1>1.0</mu1>\n  <mu2>0.0</mu2>\n  <fdir1>1 -1 0</fdir1>\n</gazebo>",
    instead='<gazebo reference="front_left_wheel">\n'
    "  <collision><surface><friction><ode>\n"
    "    <mu>1.0</mu>\n    <mu2>0.0</mu2>\n"
    '    <fdir1 gz:expressed_in="base_footprint">1 -1 0</fdir1>\n'
    "  </ode></friction></surface></collision>\n</gazebo>",
)


def turning_friction(written: Robot, lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report wheels whose friction cannot be that of rollers, in one diagnostic.

    `written` is the robot before it is lumped.
    """
    left = {link.name for link in lumped.links}
    found = [
        (link.name, collision.surface)
        for link, axis in _wheels(lumped)
        for collision in link.collisions
        if _is_directed(collision.surface)
        and collision.surface.fdir1_in not in left
        and not _is_along(axis, collision)
    ]
    if not found:
        return
    name, surface = found[0]
    others = len({wheel for wheel, _ in found}) - 1
    more = f", like those of {others} more links" if others else ""
    named = surface.fdir1_in
    if named is None:
        why = "it lacks a gz:expressed_in that Gazebo reads"
    elif any(link.name == named for link in written.links):
        why = f"gz:expressed_in names `{named}`, which is lumped into another link"
    else:
        why = f"gz:expressed_in names `{named}`, which is not a link of the robot"
    place = next(
        (
            tag.line
            for tag in written.gazebo
            if tag.reference == name and any("fdir1" in key for key in tag.values)
        ),
        None,
    )
    yield TURNING_FRICTION.at(
        file,
        place or next(link.line for link in lumped.links if link.name == name),
        f"gazebo[@reference='{name}']" if place else f"link[@name='{name}']",
        message=f"The friction direction of `{name}` turns with the wheel{more}: {why}.",
        hint="In <collision><surface><friction><ode>, write "
        f'<fdir1 gz:expressed_in="{lumped.root}">.',
    )


NO_FRICTION_DIRECTION = Rule(
    code="ROB142",
    name="friction-direction-not-simulated",
    severity=Severity.WARNING,
    summary="The physics engine does not support the friction direction of the wheels.",
    what="In simulations with PyBullet or DART, looks for `<fdir1>` on wheels where one of the "
    "coefficients `<mu1>` (`<mu>`) and `<mu2>` is less than half of the other. MuJoCo supports "
    "friction directions, as Gazebo does.",
    why="Mecanum wheels then behave like ordinary tires: the robot drives forward, but not "
    "sideways.",
    example="wsgen launch my_robot robot.launch.py --run  # a robot with mecanum wheels",
    instead="pip install 'wsgen[mujoco]'\n"
    "wsgen launch my_robot robot.launch.py --run --engine mujoco",
)


def friction_without_direction(robot: Robot, engines: Sequence[str]) -> Iterator[Diagnostic]:
    """Report a robot as Gazebo has it, whose wheels grip in one direction, for such engines."""
    lacking = without(FRICTION_DIRECTION, engines)
    wheels = [
        link.name
        for link, _ in _wheels(robot)
        if any(_is_directed(collision.surface) for collision in link.collisions)
    ]
    if lacking and wheels:
        more = f" and {len(wheels) - 1} more" if len(wheels) > 1 else ""
        wheels_have = "have" if more else "has"
        has = "has" if len(lacking) == 1 else "have"
        yield NO_FRICTION_DIRECTION.at(
            None,
            message=f"{name_engines(lacking)} {has} no friction directions (<fdir1>), which "
            f"`{wheels[0]}`{more} of `{robot.name}` {wheels_have}: the robot does not drive "
            "sideways.",
            hint="Simulate it with --engine mujoco (pip install 'wsgen[mujoco]').",
        )


def _wheels(robot: Robot) -> Iterator[tuple[Link, Vector]]:
    """The links that turn without end, with the axes that they turn about, in their frames."""
    axes = {
        one.child: one.axis_in_joint for one in robot.joints if one.type is JointType.CONTINUOUS
    }
    return ((link, axes[link.name]) for link in robot.links if link.name in axes)


def _is_directed(surface: Surface) -> bool:
    """Whether it grips in one direction: of tires, too, the coefficients may differ somewhat."""
    least, most = sorted((surface.mu1, surface.mu2))
    return surface.fdir1 is not None and least < ROLLERS * most


def _is_along(axis: Vector, collision: Collision) -> bool:
    """Whether a direction in the frame of a collision is that of the axis: it does not turn."""
    rotation = rotation_of_rpy(collision.pose_in_link.rpy)
    return _cosine(axis, rotate(rotation, collision.surface.fdir1 or axis)) > ALONG


def is_oblique(axis: Vector, direction: Vector) -> bool:
    """Whether friction in that direction is that of rollers: neither along the axis nor ahead."""
    return ACROSS < _cosine(axis, direction) < ALONG


def _cosine(one: Vector, other: Vector) -> float:
    """Of the angle between two lines; 0 where one has no direction."""
    lengths = math.hypot(*one) * math.hypot(*other)
    return abs(sum(map(operator.mul, one, other))) / lengths if lengths else 0.0
