"""Rules about the plugin that drives a robot on wheels, and about these wheels.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.checks.rules.robots import OVERSIZED, OVERSIZED_PART, poses_of
from wsgen.descriptions.urdf.diff_drive import SIMULATOR_OF_STEM, find_diff_drive
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.plugins import PLUGINS, stem
from wsgen.model.behavior import DiffDrive
from wsgen.model.robot import Cylinder, Sphere
from wsgen.model.target import CLASSIC
from wsgen.model.transform import IDENTITY, compose, rotate, rotation_of_rpy, transpose

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import WheelPair
    from wsgen.model.robot import Collision, Joint, Link, Plugin, Robot, Visual
    from wsgen.model.transform import Pose
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
