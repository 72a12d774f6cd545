"""Rules about the plugin that drives a robot on wheels, about these wheels, and their friction.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING

from wsgen.checks.rules.robots import OVERSIZED, OVERSIZED_PART, poses_of
from wsgen.checks.rules.settings import FRICTION_DIRECTION, without
from wsgen.descriptions.urdf.diff_drive import SIMULATOR_OF_STEM, find_diff_drive
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.plugins import PLUGINS, stem
from wsgen.model.behavior import DiffDrive
from wsgen.model.engines import name_engines
from wsgen.model.robot import Cylinder, JointType, Sphere
from wsgen.model.target import CLASSIC
from wsgen.model.transform import IDENTITY, compose, rotate, rotation_of_rpy, transpose
from wsgen.text.suggestions import some_named

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import WheelPair
    from wsgen.model.robot import Collision, Joint, Link, Plugin, Robot, Surface, Visual
    from wsgen.model.transform import Pose, Vector
    from wsgen.text import yamlfile

    XYZ = tuple[float, float, float]


FAR_OFF = 1.33  # times, up or down; odometry is calibrated by less
# Robots with more than two wheels slide sideways as they turn: what they turn by is set to more
# than the distance of their wheels.
SLIDING = 3.0
OTHER_UNITS = 30.0  # times; a shape in centimeters is 100 times as large

DRIVE_UNLIKE_WHEELS = Rule(
    code="ROB134",
    name="drive-unlike-wheels",
    severity=Severity.WARNING,
    summary="The wheel sizes in a diff drive plugin or controller do not match the wheels.",
    what="Compares `<wheel_radius>` or `<wheel_diameter>` with the cylinders and spheres of the "
    "wheels, and `<wheel_separation>` with the distance between them. Reports differences above a "
    "third; robots with more than two wheels may have a larger separation.",
    why="The plugin computes wheel speeds and odometry from these numbers: the robot drives and "
    "turns by other amounts than commanded, and its odometry does not show it.",
    example="<wheel_radius>0.2</wheel_radius>  <!-- of wheels with a radius of 0.1 m -->",
    instead="<wheel_radius>0.1</wheel_radius>",
)


WHEEL_ROLLS_SIDEWAYS = Rule(
    code="ROB144",
    name="wheel-rolls-sideways",
    severity=Severity.ERROR,
    summary="A driven wheel does not roll: its joint, or its shape, has the wrong axis.",
    what="Compares the axes of the two wheels that a drive plugin or a diff_drive_controller turns "
    "with the line between their joints, and with the cylinders of their collisions. Without "
    "`<axis>` the axis is x of the joint; the axis of a cylinder is z of its `<origin>`.",
    why="A wheel rolls about the line to the opposite wheel. About another axis it rolls sideways "
    "or spins in place, and the robot does not drive.",
    example="""
<joint name="left_wheel_joint" type="continuous">
  <parent link="base_link"/>
  <child link="left_wheel"/>
  <origin xyz="0 0.2 0"/>
</joint>
""",
    instead="""
<joint name="left_wheel_joint" type="continuous">
  <parent link="base_link"/>
  <child link="left_wheel"/>
  <origin xyz="0 0.2 0"/>
  <axis xyz="0 1 0"/>
</joint>
""",
)
ACROSS = 0.5  # cosine of the angle between an axis and the line between the wheels
# Parameters of drive plugins that name the wheels of both sides.
_SIDES = (
    ("left_joint", "right_joint"),
    ("front_left_joint", "front_right_joint"),
    ("rear_left_joint", "rear_right_joint"),
    ("back_left_joint", "back_right_joint"),
)


def wheels_across(
    robot: Robot, pairs: Iterable[tuple[str, ...]], file: Path | None, line: int | None = None
) -> Iterator[Diagnostic]:
    """Report driven wheels that roll sideways; pairs are of joints, left and right.

    `line` is the place in the file where that is not of the robot.
    """
    joints = {joint.name: joint for joint in robot.joints if joint.is_movable}
    links = {link.name: link for link in robot.links}
    poses = poses_of(robot.joints)
    for names in dict.fromkeys(pairs):
        pair = [joints.get(name) for name in names]
        if None in pair or names[0] == names[1]:
            continue
        places = [poses[one.child] for one in pair if one is not None]
        (x, y, z), (other_x, other_y, other_z) = (place.xyz for place in places)
        across = (x - other_x, y - other_y, z - other_z)
        length = math.hypot(*across)
        for one, pose in zip(pair, places, strict=True):
            if one is None or not length:
                continue
            axis = rotate(rotation_of_rpy(pose.rpy), one.axis_in_joint)
            along = sum(a * b for a, b in zip(axis, across, strict=True)) / length
            if abs(along) >= ACROSS * math.hypot(*axis):
                yield from _lying_across(one, links.get(one.child), file, line)
                continue
            yield WHEEL_ROLLS_SIDEWAYS.at(
                file,
                one.line if line is None else line,
                f"joint[@name='{one.name}']",
                message=f"The driven wheel `{one.child}` turns about "
                f"{' '.join(f'{part:g}' for part in one.axis_in_joint)}"
                + (" (x, as without <axis>)" if one.axis_in_joint == (1, 0, 0) else "")
                + ", perpendicular to the line to the opposite wheel: it does not roll.",
                hint=f'Write <axis xyz="{_axis(pose, across)}"/> in the joint `{one.name}`.',
            )


def _lying_across(
    joint: Joint, wheel: Link | None, file: Path | None, line: int | None
) -> Iterator[Diagnostic]:
    """Report a wheel whose cylinder is not turned to the axis of its joint."""
    if wheel is None or len(wheel.collisions) != 1:
        return
    (tire,) = wheel.collisions
    axis = joint.axis_in_joint
    if not _is_across(tire, axis):
        return
    seen = ", and of its <visual>" if any(_is_across(one, axis) for one in wheel.visuals) else ""
    turned = TURNED.get(max(range(3), key=lambda index: abs(axis[index])))
    yield WHEEL_ROLLS_SIDEWAYS.at(
        file,
        wheel.line if line is None else line,
        f"link[@name='{wheel.name}']/collision",
        message=f"The cylinder of the driven wheel `{wheel.name}` lies across the axis "
        f"{' '.join(f'{part:g}' for part in axis)} of its joint `{joint.name}`: it does not roll.",
        hint=f'Write rpy="{turned}" in the <origin> of its <collision>{seen}.'
        if turned
        else "Turn its <collision> until z of it is along the axis.",
    )


def _is_across(part: Collision | Visual, axis: XYZ) -> bool:
    """Whether a cylinder is not turned to an axis of its link."""
    along = rotate(rotation_of_rpy(part.pose_in_link.rpy), (0.0, 0.0, 1.0))
    cosine = sum(a * b for a, b in zip(along, axis, strict=True)) / math.hypot(*axis)
    return isinstance(part.geometry, Cylinder) and abs(cosine) < ACROSS


TURNED = {0: "0 1.5708 0", 1: "1.5708 0 0"}  # to x and to y; a cylinder is along z


def _axis(pose: Pose, across: XYZ) -> str:
    """A direction of the robot in the frame of a joint, as an axis of it where it nearly is one."""
    parts = rotate(transpose(rotation_of_rpy(pose.rpy)), across)
    largest = max(parts, key=abs)
    is_axis = abs(largest) > ALONG * math.hypot(*parts)
    unit = [math.copysign(1, one) * (one == largest) for one in parts] if is_axis else parts
    length = math.hypot(*unit)
    return " ".join(f"{round(one / length, 3) + 0:g}" for one in unit)


ALONG = 0.9  # cosine; what is so near to an axis is meant to be it


def driven_pairs(robot: Robot) -> Iterator[tuple[str, str]]:
    """The joints that drive plugins turn, left and right."""
    for tag in robot.gazebo:
        for plugin in tag.plugins:
            if stem(plugin.filename) not in PLUGINS or "driv" not in plugin.filename:
                continue
            for left, right in _SIDES:
                yield from zip(
                    plugin.values.get(left, ()), plugin.values.get(right, ()), strict=False
                )


def check_drive(robot: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report a plugin whose wheels are others; the robot is the one that is written."""
    yield from wheels_across(robot, driven_pairs(robot), file)
    for plugin, simulator in _plugins(robot):
        drive = find_diff_drive(robot, simulator=simulator)
        if not isinstance(drive, DiffDrive):
            continue  # it does not work at all
        links = {link.name: link for link in robot.links}
        wheels = {joint.name: links.get(joint.child) for joint in robot.joints}
        poses = poses_of(robot.joints)
        pair = drive.pairs[0]
        left, right = wheels.get(pair.left), wheels.get(pair.right)
        if left is None or right is None:
            continue
        yield from _radius(pair, (left, right), plugin, simulator, file)
        middles = [_middle(wheel, poses) for wheel in (left, right)]
        yield from _oversized(left, middles, file)
        if None not in middles and "wheel_separation" in plugin.values:
            most = SLIDING if len(drive.pairs) > 1 else FAR_OFF
            apart = math.dist(*middles)  # type: ignore[arg-type]  # neither is None
            yield from _separation(pair, (left, right), apart, most, plugin, file)


def _oversized(
    wheel: Link, middles: Sequence[XYZ | None], file: Path | None
) -> Iterator[Diagnostic]:
    """Report wheels much larger than their distance, of a robot that is as high as they are."""
    tire, (one, other) = _tire(wheel), middles
    if tire is None or one is None or other is None:
        return
    apart = math.dist(one, other)
    if 2 * tire[0] > OVERSIZED * apart > 0:
        yield OVERSIZED_PART.at(
            file,
            wheel.line,
            f"link[@name='{wheel.name}']",
            message=f"The wheel `{wheel.name}` has a radius of {tire[0]:g} m, but the wheels are "
            f"only {apart:.3g} m apart.",
            hint=f"Use meters: for {tire[0]:g} cm, write {tire[0] / 100:g}.",
        )


def check_drive_controller(
    robot: Robot, name: str, values: yamlfile.Value, file: Path, robot_file: Path | None = None
) -> Iterator[Diagnostic]:
    """Report parameters of a diff_drive_controller that are not those of the wheels.

    What is wrong with the robot itself is reported in `robot_file`, where that is known.
    """
    links = {link.name: link for link in robot.links}
    wheels = {joint.name: links.get(joint.child) for joint in robot.joints}
    sides = [values.get(f"{side}_wheel_names") for side in ("left", "right")]
    names = [[one.text or "" for one in side.elements()] if side else [] for side in sides]
    if not all(names):
        return
    pairs = zip(*names, strict=False)
    if robot_file is not None:
        yield from wheels_across(robot, pairs, robot_file)
    else:
        yield from wheels_across(robot, pairs, file, sides[0] and sides[0].line)
    left, right = (wheels.get(each[0]) for each in names)
    if left is None or right is None:
        return
    poses = poses_of(robot.joints)
    shapes, middles = (
        [_tire(one) for one in (left, right)],
        [_middle(left, poses), _middle(right, poses)],
    )
    measured: dict[str, tuple[float, float]] = {}  # and how much more may be written
    radii = {shape[0] for shape in shapes if shape is not None}
    if len(radii) == 1 and None not in shapes:
        measured["wheel_radius"] = radii.pop(), FAR_OFF
    if None not in middles:
        most = SLIDING if len(names[0]) > 1 else FAR_OFF
        measured["wheel_separation"] = math.dist(*middles), most  # type: ignore[arg-type]
    for key, (size, most) in measured.items():
        value = values.get(key)
        multiplier = values.get(f"{key}_multiplier")
        if value is None or multiplier is not None or type(value.content) not in {int, float}:
            continue
        if size > 0 and not 1 / FAR_OFF <= value.content / size <= most:
            what = (
                "the radius of its shape is"
                if key == "wheel_radius"
                else "the distance of the wheels is"
            )
            yield DRIVE_UNLIKE_WHEELS.at(
                file,
                value.line,
                f"{name}.{key}",
                message=f"The controller `{name}` has a {key} of {value.content:.4g} m for the "
                f"wheel `{left.name}`, but {what} {size:.4g} m.",
                hint=f"Write sizes of the robot in meters: {value.content:.4g} for {size:.4g}."
                if size > OTHER_UNITS * value.content > 0
                else f"Write {key}: {size:.4g}",
            )


def _plugins(robot: Robot) -> Iterator[tuple[Plugin, str]]:
    """The first plugin for each simulator."""
    seen = set()
    for tag in robot.gazebo:
        for plugin in tag.plugins:
            simulator = SIMULATOR_OF_STEM.get(stem(plugin.filename))
            if simulator is not None and simulator not in seen:
                seen.add(simulator)
                yield plugin, simulator


def _radius(
    pair: WheelPair,
    wheels: tuple[Link, Link],
    plugin: Plugin,
    simulator: str,
    file: Path | None,
) -> Iterator[Diagnostic]:
    key, factor = ("wheel_diameter", 2.0) if simulator == CLASSIC else ("wheel_radius", 1.0)
    shapes = [_tire(wheel) for wheel in wheels]
    radii = {shape[0] for shape in shapes if shape is not None}
    if key not in plugin.values or len(radii) != 1:
        return
    radius = radii.pop()
    if radius > OTHER_UNITS * pair.radius:
        return  # the shape is in other units, which is reported
    if not 1 / FAR_OFF <= pair.radius / radius <= FAR_OFF:
        yield DRIVE_UNLIKE_WHEELS.at(
            file,
            plugin.line,
            f"plugin[@name='{plugin.name}']/{key}",
            message=f"The diff drive plugin has a radius of {pair.radius:.4g} m for the wheel "
            f"`{wheels[0].name}`, but the radius of its shape is {radius:.4g} m.",
            hint=f"Write <{key}>{factor * radius:.4g}</{key}>.",
        )


def _separation(  # noqa: PLR0913, PLR0917  facts
    pair: WheelPair,
    wheels: tuple[Link, Link],
    apart: float,
    most: float,
    plugin: Plugin,
    file: Path | None,
) -> Iterator[Diagnostic]:
    if apart > 0 and not 1 / FAR_OFF <= pair.separation / apart <= most:
        yield DRIVE_UNLIKE_WHEELS.at(
            file,
            plugin.line,
            f"plugin[@name='{plugin.name}']/wheel_separation",
            message=f"The diff drive plugin has a separation of {pair.separation:.4g} m for the "
            f"wheels `{wheels[0].name}` and `{wheels[1].name}`, but they are {apart:.4g} m apart.",
            hint=f"Write <wheel_separation>{apart:.4g}</wheel_separation>.",
        )


def _tire(wheel: Link) -> tuple[float, Pose] | None:
    """Radius in m, and place in the link, of the only shape that rolls; of what touches first."""
    for parts in (wheel.collisions, wheel.visuals):
        round_ones = [
            (part.geometry.radius, part.pose_in_link)
            for part in parts
            if isinstance(part.geometry, (Cylinder, Sphere))
        ]
        if parts:
            return round_ones[0] if len(round_ones) == len(parts) == 1 else None
    return None


def _middle(wheel: Link, poses: Mapping[str, Pose]) -> XYZ | None:
    """The middle of a wheel in the robot's frame, m; None where its shape does not say."""
    tire = _tire(wheel)
    return None if tire is None else compose(poses.get(wheel.name, IDENTITY), tire[1]).xyz


ROLLERS = 0.5  # times the larger coefficient
PARALLEL = 0.999  # the cosine between two directions that are one
RIGHT_ANGLED = math.sqrt(1 - PARALLEL**2)  # the cosine between two that are at right angles

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
        wheels_have = "have" if wheels[1:] else "has"
        has = "has" if len(lacking) == 1 else "have"
        yield NO_FRICTION_DIRECTION.at(
            None,
            message=f"{name_engines(lacking)} {has} no friction directions (<fdir1>), which "
            f"{some_named(wheels, 1)} of `{robot.name}` {wheels_have}: the robot does not drive "
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
    return _cosine(axis, rotate(rotation, collision.surface.fdir1 or axis)) > PARALLEL


def is_oblique(axis: Vector, direction: Vector) -> bool:
    """Whether friction in that direction is that of rollers: neither along the axis nor ahead."""
    return RIGHT_ANGLED < _cosine(axis, direction) < PARALLEL


def _cosine(one: Vector, other: Vector) -> float:
    """Of the angle between two lines; 0 where one has no direction."""
    lengths = math.hypot(*one) * math.hypot(*other)
    return abs(sum(map(operator.mul, one, other))) / lengths if lengths else 0.0
