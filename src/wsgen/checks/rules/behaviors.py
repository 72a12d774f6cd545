"""Rules about what a robot must do beyond standing: can it be simulated, and does it do it?

The parameters of a check are facts in SI units; a check yields what it reports. All diagnostics
name the behavior and its place in `wsgen.toml`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules.runs import BEHAVIOR_EXPLODES, HEADING_NOT_REACHED, POSITION_NOT_REACHED
from wsgen.diagnostics import Rule, Severity
from wsgen.model.behavior import ELEMENT, Drive, LaunchTask, Reach
from wsgen.model.robot import LITTLE_GRIP, JointType
from wsgen.text.suggestions import ask_for_nearest, some_named, some_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behavior, BehaviorRun, DiffDrive, LiveMeasurement
    from wsgen.model.robot import Joint, Robot
    from wsgen.simulation.scene import BehaviorMeasurement


NAMED = 5  # at most so many joints are named in a message
SEEN = 0.01  # m or rad; less does not show what is wrong
ALIKE = 1.05  # sizes that differ by less are the same
MISREAD = 2.5  # times: by more nobody errs in a size, not even who takes a diameter for a radius
COMMANDED = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
LIMITED = (JointType.REVOLUTE, JointType.PRISMATIC)
FALLEN = math.radians(45)  # no ramp is as steep
AT_LIMIT = 1e-6  # rad or m; limits are rounded when they are written


def check_behavior(
    behavior_run: BehaviorRun, behaved: BehaviorMeasurement, file: Path
) -> tuple[Diagnostic, ...]:
    """Check one behavior that was simulated."""
    behavior = behavior_run.behavior
    if not behaved.is_finite:
        return tuple(behavior_explodes(behavior, file))
    if isinstance(behavior.task, Drive):
        return (
            *position_not_reached(behavior, behavior.task, behaved.moved, behavior_run.drive, file),
            *heading_not_reached(
                behavior, behavior.task, behaved.moved[2], behavior_run.drive, file
            ),
        )
    if not isinstance(behavior.task, Reach):
        return ()  # its launch file runs, which `check_live` checks
    return tuple(joints_not_reached(behavior, behavior.task, behaved.positions, file))


def check_live(
    behavior: Behavior, task: LaunchTask, measured: LiveMeasurement, file: Path
) -> tuple[Diagnostic, ...]:
    """Check one behavior for which the launch file has run.

    What did not run is named with each error: it may be why.
    """
    left_out = [f"{what} ({why})" for what, why in measured.left_out.items()]
    found = _check_measured(behavior, task, measured, file)
    if not left_out:
        return found
    named = f"Skipped in the run: {some_of(left_out, NAMED)}."
    return tuple(replace(one, hint=f"{one.hint} {named}" if one.hint else named) for one in found)


def _check_measured(
    behavior: Behavior, task: LaunchTask, measured: LiveMeasurement, file: Path
) -> tuple[Diagnostic, ...]:
    if measured.problem is not None:
        return tuple(launch_fails(behavior, measured, file))
    if not measured.is_finite:
        return tuple(behavior_explodes(behavior, file))
    if not measured.is_there:
        return tuple(launch_fails(behavior, replace(measured, problem=GONE), file))
    missing = [f"`{name}`" for name in task.positions if name not in measured.positions]
    if missing:  # a node may spawn another robot than the launch file has
        problem = f"the robot `{measured.entity}` has no joint {', '.join(missing[:NAMED])}"
        return tuple(launch_fails(behavior, replace(measured, problem=problem), file))
    hint = why_not_driven(measured)
    return (
        *tips_over_in_run(behavior, measured.tilt, file),
        *position_not_reached(behavior, task.as_drive, measured.moved, None, file, hint=hint),
        *heading_not_reached(behavior, task.as_drive, measured.moved[2], None, file, hint=hint),
        *way_too_short(behavior, task, measured, file),
        *joints_not_reached(behavior, task.as_reach, measured.positions, file, hint=hint),
    )


def why_not_driven(measured: LiveMeasurement) -> str:
    """Where to look for what has not moved the robot."""
    return (
        "Run the launch file, and check what its nodes print and publish: wsgen launch "
        f"{measured.launched} --run, wsgen topic echo /cmd_vel."
    )


# The simulator takes a robot out that has exploded, and says so; nodes delete robots by services.
GONE = "the robot is no longer in the world: a node deleted it, or the simulation exploded"


LAUNCH_FAILS = Rule(
    code="SPN099",
    name="launch-fails",
    severity=Severity.ERROR,
    summary="The launch file or its robots fail before the end of a behavior.",
    what="For behaviors with `run = true`, runs the launch file with its nodes; reports processes "
    "that fail, and robots that are not spawned or disappear.",
    why="The node would also fail on the real robot.",
    example="speed = 1.0 / clearance  # that is 0",
    instead="speed = 1.0 / max(clearance, 0.1)",
)


def launch_fails(behavior: Behavior, measured: LiveMeasurement, file: Path) -> Iterator[Diagnostic]:
    """Report a launch file that does not run to the end of a behavior."""
    problem = (measured.problem or "").rstrip(".")
    yield error_about(
        LAUNCH_FAILS,
        behavior,
        file,
        f"after {measured.seconds:.2f} simulated s: {problem[:1].lower()}{problem[1:]}.",
        "Correct the node or the launch file, then run `wsgen build`. To see the whole output, "
        f"run: wsgen launch {measured.launched} --run",
    )


TIPS_OVER_IN_RUN = Rule(
    code="SPN100",
    name="tips-over-in-run",
    severity=Severity.ERROR,
    summary="A robot tips over while its launch file runs.",
    what="Compares the up axis of the robot at the end of a behavior with `run = true` with that "
    "at its spawn.",
    why="The nodes drive the robot over an obstacle, or brake it too hard.",
    example="velocity.linear.x = 5.0",
    instead="velocity.linear.x = 0.5",
)


def tips_over_in_run(behavior: Behavior, tilt: float, file: Path) -> Iterator[Diagnostic]:
    """Report a robot that lies at the end of a behavior."""
    if tilt > FALLEN:
        yield error_about(
            TIPS_OVER_IN_RUN,
            behavior,
            file,
            f"after {behavior.seconds:g} s the robot leans by {math.degrees(tilt):.0f} degrees.",
            "Reduce its speed and acceleration, or lower its center of mass.",
        )


WAY_TOO_SHORT = Rule(
    code="SPN101",
    name="way-too-short",
    severity=Severity.ERROR,
    summary="A robot travels less far than its behavior says while its launch file runs.",
    what="Adds up the distance that the root link travels, and compares it with `travels`.",
    why="No node drives the robot, or it is stuck.",
    example="self.create_publisher(Twist, 'cmd_vell', 10)",
    instead="self.create_publisher(Twist, 'cmd_vel', 10)",
)


def way_too_short(
    behavior: Behavior, task: LaunchTask, measured: LiveMeasurement, file: Path
) -> Iterator[Diagnostic]:
    """Report a robot that does not travel as far as the behavior says."""
    if task.travels is not None and measured.traveled < task.travels:
        yield error_about(
            WAY_TOO_SHORT,
            behavior,
            file,
            f"in {behavior.seconds:g} s the robot travels {_short(measured.traveled)} m; expected: "
            f"at least {task.travels:g} m.",
            why_not_driven(measured),
        )


LAUNCH_NOT_RUN = Rule(
    code="SPN102",
    name="launch-not-run",
    severity=Severity.WARNING,
    severity_varies="information from commands that do not run nodes",
    summary="A behavior with `run = true` is skipped: its launch file cannot be run here.",
    what="Looks for ROS (sourced, or from `wsgen[ros]`), and whether the command runs nodes.",
    why="The behavior of the nodes is not checked.",
    example="pip install wsgen",
    instead="pip install 'wsgen[ros]'",
)


def launch_not_run(
    behavior: Behavior, reason: str, hint: str, file: Path, severity: Severity
) -> Iterator[Diagnostic]:
    """Report a behavior that is left out."""
    yield LAUNCH_NOT_RUN.at(
        file,
        behavior.line,
        ELEMENT.format(behavior.name),
        message=f"`{behavior.name}` is skipped: {reason[:1].lower()}{reason[1:].rstrip('.')}.",
        hint=hint,
        severity=severity,
    )


def position_not_reached(  # noqa: PLR0913  what is compared, and what is said
    behavior: Behavior,
    task: Drive,
    moved: tuple[float, float, float],
    drive: DiffDrive | None,
    file: Path,
    *,
    hint: str | None = None,
) -> Iterator[Diagnostic]:
    """Report a robot that does not get where the behavior says."""
    x, y, _ = moved
    slack = task.slack(task.x, task.y)
    missed = [
        axis
        for axis, is_at, wanted in (("x", x, task.x), ("y", y, task.y))
        if wanted is not None and abs(is_at - wanted) > slack
    ]
    if missed:
        wanted = ", ".join(
            f"{axis} = {place:g} m"
            for axis, place in (("x", task.x), ("y", task.y))
            if place is not None
        )
        yield error_about(
            POSITION_NOT_REACHED,
            behavior,
            file,
            f"after {behavior.seconds:g} s the robot is at x = {_short(x)} m, y = {_short(y)} m "
            f"from its start; expected: {wanted}, within {slack:.2g} m.",
            hint or _why_slipping(drive, x, task.x) or _why_position_not_reached(task, x, drive),
        )


def heading_not_reached(  # noqa: PLR0913  as above
    behavior: Behavior,
    task: Drive,
    turned: float,
    drive: DiffDrive | None,
    file: Path,
    *,
    hint: str | None = None,
) -> Iterator[Diagnostic]:
    """Report a robot that does not turn as the behavior says."""
    if task.yaw is None:
        return
    slack = task.slack(task.yaw)
    if abs(turned - task.yaw) > slack:
        yield error_about(
            HEADING_NOT_REACHED,
            behavior,
            file,
            f"in {behavior.seconds:g} s the robot turns by {_short(turned)} rad; "
            f"expected: {task.yaw:g} rad, within {slack:.2g} rad.",
            hint
            or _why_slipping(drive, turned, task.yaw)
            or _why_heading_not_reached(task, turned, drive),
        )


JOINT_NOT_REACHED = Rule(
    code="SPN087",
    name="joint-not-reached",
    severity=Severity.ERROR,
    summary="A joint does not reach the position in its behavior.",
    what="Sends joints to positions, or runs the launch file (`run = true`), and compares their "
    "final positions. Their strength and speed are those of their limits.",
    why="The arm hangs, or moves more slowly than a motion planner assumes.",
    example='<limit lower="-1.57" upper="1.57" effort="0.1" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="20" velocity="1"/>',
)


WHY_JOINTS_NOT_REACHED = (
    "In the <limit> of these joints raise `effort` (too weak) or `velocity` (too slow), or raise "
    "`seconds` of the behavior; check whether the robot collides with something."
)


def joints_not_reached(
    behavior: Behavior,
    task: Reach,
    positions: Mapping[str, float],
    file: Path,
    *,
    hint: str | None = None,
) -> Iterator[Diagnostic]:
    """Report joints that are not where the behavior sends them."""
    missed = {
        name: positions[name]
        for name, wanted in task.positions.items()
        if abs(positions[name] - wanted) > task.within
    }
    if missed:
        joints = some_of(
            [
                f"{name} is at {_short(position)} (not {task.positions[name]:g})"
                for name, position in missed.items()
            ],
            NAMED,
        )
        yield error_about(
            JOINT_NOT_REACHED,
            behavior,
            file,
            f"after {behavior.seconds:g} s {joints}.",
            hint or WHY_JOINTS_NOT_REACHED,
        )


def behavior_explodes(behavior: Behavior, file: Path) -> Iterator[Diagnostic]:
    """Report a position that became infinite or not-a-number during a behavior."""
    yield error_about(
        BEHAVIOR_EXPLODES,
        behavior,
        file,
        "the robot's pose became infinite or not-a-number.",
        "Check masses, inertias and effort limits: use SI units, and no zero or huge values.",
    )


UNCLEAR_BEHAVIOR_ROBOT = Rule(
    code="SPN080",
    name="unclear-behavior-robot",
    severity=Severity.ERROR,
    summary="It is not clear which robot a behavior is for.",
    what="Compares `robot` with the names under which the launch file spawns robots.",
    why="The behavior is not simulated.",
    example="""
[[behavior]]
name = "wave"
joints = { shoulder = 0.5 }  # two robots are spawned
""",
    instead="""
[[behavior]]
name = "wave"
robot = "left_arm"
joints = { shoulder = 0.5 }
""",
)


def unclear_behavior_robot(
    behavior: Behavior, entities: Sequence[str], file: Path
) -> Iterator[Diagnostic]:
    """Report a behavior for which it is not clear which robot is meant."""
    if behavior.robot in entities or (behavior.robot is None and len(entities) == 1):
        return
    there = ", ".join(f"`{entity}`" for entity in entities)
    yield error_about(
        UNCLEAR_BEHAVIOR_ROBOT,
        behavior,
        file,
        f"no robot is spawned as `{behavior.robot}`."
        if behavior.robot is not None
        else f"{len(entities)} robots are spawned, and `robot` does not say which one is meant.",
        f"{ask_for_nearest(behavior.robot or '', entities)}"
        f'Write robot = "NAME" in the behavior; the robots are {there}.',
    )


NO_DIFF_DRIVE = Rule(
    code="SPN081",
    name="no-diff-drive",
    severity=Severity.ERROR,
    summary="A behavior drives a robot without a diff drive plugin.",
    why="In Gazebo the robot would not follow `/cmd_vel` either.",
    example="<gazebo/>",
    instead="""
<gazebo>
  <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
    <left_joint>wheel_left</left_joint>
    <right_joint>wheel_right</right_joint>
    <wheel_separation>0.4</wheel_separation>
    <wheel_radius>0.1</wheel_radius>
  </plugin>
</gazebo>
""",
)
UNUSABLE_DIFF_DRIVE = Rule(
    code="SPN082",
    name="unusable-diff-drive",
    severity=Severity.ERROR,
    summary="A behavior drives a robot whose diff drive plugin does not work.",
    what="Compares the joints in the plugin with those of the robot, and checks that its sizes are "
    "given.",
    why="In Gazebo the robot would not follow `/cmd_vel` either.",
    example="<left_joint>wheel_letf</left_joint>",
    instead="<left_joint>wheel_left</left_joint>",
)


def no_diff_drive(
    behavior: Behavior, reason: str, hint: str, file: Path, *, has_plugin: bool
) -> Iterator[Diagnostic]:
    """Report a behavior that drives a robot without a usable diff drive plugin."""
    rule = UNUSABLE_DIFF_DRIVE if has_plugin else NO_DIFF_DRIVE
    yield error_about(rule, behavior, file, f"the robot cannot be driven: {reason}.", hint)


UNKNOWN_BEHAVIOR_JOINT = Rule(
    code="SPN083",
    name="unknown-behavior-joint",
    severity=Severity.ERROR,
    summary="A behavior names a joint that does not exist or takes no commands.",
    what="Compares `joints` with the joints of the robot that Gazebo builds: revolute, continuous "
    "and prismatic joints take commands unless they mimic another joint. With `run = true` no "
    "commands are sent, and joints that mimic others are measured, too.",
    why="The behavior is not simulated.",
    example="joints = { shouder = 0.5 }",
    instead="joints = { shoulder = 0.5 }",
)


def unknown_behavior_joint(
    behavior: Behavior, positions: Mapping[str, float], robot: Robot, file: Path
) -> Iterator[Diagnostic]:
    """Report joints that a behavior moves and that take no commands, or that it cannot measure."""
    joints = {} if robot.is_static else {joint.name: joint for joint in robot.movable_joints}
    is_measured = isinstance(behavior.task, LaunchTask)  # nothing is sent
    names = [
        joint.name
        for joint in joints.values()
        if joint.type in COMMANDED and (is_measured or joint.mimic is None)
    ]
    for name in positions:
        if name in names:
            continue
        joint = joints.get(name)
        mimics = joint.mimic.joint if joint is not None and joint.mimic is not None else None
        yield error_about(
            UNKNOWN_BEHAVIOR_JOINT,
            behavior,
            file,
            f"the robot has no joint `{name}` that can move."
            if mimics is None
            else f"the joint `{name}` follows `{mimics}` and takes no commands.",
            f"{ask_for_nearest(name, names)}"
            f"Joints that {'are measured' if is_measured else 'take commands'}: "
            f"{some_named(names, NAMED)}."
            if names
            else "Give the robot revolute, continuous or prismatic joints.",
        )


COMMAND_BEYOND_LIMIT = Rule(
    code="SPN084",
    name="command-beyond-limit",
    severity=Severity.ERROR,
    summary="A behavior sends a joint beyond its limits.",
    what="Compares the positions of `joints` with the limits in the description.",
    why="The joint cannot get there; ros2_control refuses or clamps such a command.",
    example="joints = { shoulder = 3.0 }  # upper limit: 1.57",
    instead="joints = { shoulder = 1.5 }",
)


def command_beyond_limit(
    behavior: Behavior, positions: Mapping[str, float], joints: Sequence[Joint], file: Path
) -> Iterator[Diagnostic]:
    """Report joints that a behavior sends, or wants to see, beyond their limits."""
    is_measured = isinstance(behavior.task, LaunchTask)
    for joint in joints:
        limit = joint.limit
        position = positions.get(joint.name)
        if position is None or limit is None or joint.type not in LIMITED:
            continue
        if not limit.lower - AT_LIMIT <= position <= limit.upper + AT_LIMIT:
            yield error_about(
                COMMAND_BEYOND_LIMIT,
                behavior,
                file,
                f"the joint `{joint.name}` cannot reach {position:g}, which is beyond its limits "
                f"{limit.lower:g} and {limit.upper:g}."
                if is_measured
                else f"the joint `{joint.name}` is sent to {position:g}, beyond its limits "
                f"{limit.lower:g} and {limit.upper:g}.",
                "Choose a position between the limits, or change the <limit> of the joint.",
            )


def _why_position_not_reached(task: Drive, x: float, drive: DiffDrive | None) -> str:
    """A guess where more than the size of the wheels can be the reason."""
    usual = "Check the sizes in the plugin, the axes, and the friction of wheels and casters."
    if abs(x) < SEEN or not task.x or drive is None:
        return f"Check whether the wheels reach the ground and are strong enough. {usual}"
    if x * task.x < 0:
        return "It moved the other way: reverse the <axis> of the wheels' joints."
    if task.angular:
        return usual
    radius = drive.pairs[0].radius
    if not drive.linear.slowest <= task.linear <= drive.linear.fastest:
        return f"The plugin limits {task.linear:g} m/s."
    return _why_by_size(
        x / task.x,
        f"{_size_in_plugin(drive, radius)}: {_size(drive, radius * x / task.x)} would explain "
        f"this, if the wheels {_unless_slipping(drive) or 'are strong enough'}."
        if not 1 / ALIKE < x / task.x < ALIKE
        else usual,
        usual,
    )


def _why_heading_not_reached(task: Drive, turned: float, drive: DiffDrive | None) -> str:
    if drive is None or not task.yaw or abs(turned) < SEEN:
        return (
            "One side is braked: check the friction of casters, and whether both wheels touch the "
            "ground."
        )
    if turned * task.yaw < 0:
        return "It turned the other way: swap <left_joint> and <right_joint>."
    separation = drive.pairs[0].separation
    return _why_by_size(
        turned / task.yaw,
        f"The plugin has wheel_separation = {separation:g} m: "
        f"{separation * task.yaw / turned:.3g} m would fit, "
        f"if the wheels {_unless_slipping(drive) or 'have the right size'}.",
        "Check the sizes in the plugin, and the friction of wheels and casters.",
    )


def _why_by_size(share: float, size: str, usual: str) -> str:
    """Name another size in the plugin, where the robot gets about as far as it is to get."""
    if share < 1 / MISREAD:
        return (
            "The wheels slip, or are too weak: check the friction of casters, efforts and limits."
        )
    return usual if share > MISREAD else size


def _unless_slipping(drive: DiffDrive) -> str:
    """The condition of a size where the wheels may slip; empty where they grip."""
    return f"do not slip: their friction is {drive.grip:g}" if drive.grip < LITTLE_GRIP else ""


def _why_slipping(drive: DiffDrive | None, way: float, wanted: float | None) -> str | None:
    """Name the friction of the wheels, where it is low and the robot gets much less far."""
    if drive is None or drive.grip >= LITTLE_GRIP or not wanted:
        return None
    if not -SEEN / abs(wanted) < way / wanted < 1 / MISREAD:
        return None
    return f"The wheels slip: their friction is {drive.grip:g}. Give wheels <mu1> and <mu2> of 1."


def _size_in_plugin(drive: DiffDrive, radius: float) -> str:
    return f"The plugin has {_size(drive, radius)}"


def _size(drive: DiffDrive, radius: float) -> str:
    if drive.simulator == "classic":
        return f"wheel_diameter = {2 * radius:.3g} m"
    return f"wheel_radius = {radius:.3g} m"


def _short(number: float) -> str:
    """Three decimals; adding zero turns -0.0 into 0."""
    return f"{round(number, 3) + 0.0:g}"


def error_about(rule: Rule, behavior: Behavior, file: Path, message: str, hint: str) -> Diagnostic:
    """An error that names the behavior and its place."""
    return rule.at(
        file,
        behavior.line,
        ELEMENT.format(behavior.name),
        message=f"`{behavior.name}`: {message}",
        hint=hint,
    )
