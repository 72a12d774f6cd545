"""Rules about what a robot must do beyond standing: can it be simulated, and does it do it?

The parameters of a check are facts in SI units; a check yields what it reports. All diagnostics
name the behavior and its place in `wsgen.toml`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.model.behavior import Drive
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behavior, BehaviorRun, DiffDrive, Reach
    from wsgen.model.robot import Joint, Robot
    from wsgen.simulation.scene import BehaviorMeasurement


NAMED = 5  # at most so many joints are named in a message
SEEN = 0.01  # m or rad; less does not show what is wrong
ALIKE = 1.05  # sizes that differ by less are the same
COMMANDED = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
LIMITED = (JointType.REVOLUTE, JointType.PRISMATIC)
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
    return tuple(joints_not_reached(behavior, behavior.task, behaved.positions, file))


POSITION_NOT_REACHED = Rule(
    code="SPN085",
    name="position-not-reached",
    severity=Severity.ERROR,
    summary="A robot that is driven does not get where its behavior says.",
    what="Drives the robot through its plugin, and compares where it gets with `moved`. The "
    "difference may be `tolerance` times the way.",
    why="Odometry and navigation rely on the sizes in the plugin: they would be wrong by as much.",
    example="<wheel_radius>0.2</wheel_radius>  <!-- of a wheel with a radius of 0.1 m -->",
    instead="<wheel_radius>0.1</wheel_radius>",
)


def position_not_reached(
    behavior: Behavior,
    task: Drive,
    moved: tuple[float, float, float],
    drive: DiffDrive | None,
    file: Path,
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
            f"from where it began; expected: {wanted}, within {slack:.2g} m.",
            _why_position_not_reached(task, x, drive),
        )


HEADING_NOT_REACHED = Rule(
    code="SPN086",
    name="heading-not-reached",
    severity=Severity.ERROR,
    summary="A robot that is driven does not turn as its behavior says.",
    what="Drives the robot through its plugin, and compares how far it turns with the `yaw` of "
    "`moved`. The difference may be `tolerance` times the angle.",
    why="Odometry and navigation rely on the sizes in the plugin: they would be wrong by as much.",
    example="<wheel_separation>0.8</wheel_separation>  <!-- between the outer sides -->",
    instead="<wheel_separation>0.6</wheel_separation>  <!-- between the contacts -->",
)


def heading_not_reached(
    behavior: Behavior, task: Drive, turned: float, drive: DiffDrive | None, file: Path
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
            _why_heading_not_reached(task, turned, drive),
        )


JOINT_NOT_REACHED = Rule(
    code="SPN087",
    name="joint-not-reached",
    severity=Severity.ERROR,
    summary="A joint is not where its behavior sends it.",
    what="Sends joints to positions, and compares where they are at the end. They are as strong "
    "and as fast as their limits say.",
    why="The arm hangs, or moves more slowly than a motion planner assumes.",
    example='<limit lower="-1.57" upper="1.57" effort="0.1" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="20" velocity="1"/>',
)


def joints_not_reached(
    behavior: Behavior, task: Reach, positions: Mapping[str, float], file: Path
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
            quote="",
        )
        yield error_about(
            JOINT_NOT_REACHED,
            behavior,
            file,
            f"after {behavior.seconds:g} s {joints}.",
            "Raise `effort` in the <limit> of joints that carry much, or `velocity` of joints that "
            "are late, or `seconds`; check whether the robot runs into something.",
        )


BEHAVIOR_EXPLODES = Rule(
    code="SPN088",
    name="behavior-explodes",
    severity=Severity.ERROR,
    summary="A position became infinite or not-a-number while a behavior was simulated.",
    what="Looks at every pose and joint position.",
    why="The simulation exploded. Gazebo stops with an assertion or shows nothing.",
    example='<limit lower="-1.57" upper="1.57" effort="1e12" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="20" velocity="1"/>',
)


def behavior_explodes(behavior: Behavior, file: Path) -> Iterator[Diagnostic]:
    """Report a position that became infinite or not-a-number during a behavior."""
    yield error_about(
        BEHAVIOR_EXPLODES,
        behavior,
        file,
        "the robot's pose became infinite or not-a-number.",
        "Check masses, inertias and the limits of effort: use SI units, none zero or huge.",
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
        f'Add robot = "NAME" to the behavior; the robots are {there}.',
    )


NO_DIFF_DRIVE = Rule(
    code="SPN081",
    name="no-diff-drive",
    severity=Severity.ERROR,
    summary="A behavior drives a robot that has no diff drive plugin.",
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
    what="Compares the joints that the plugin names with those of the robot, and looks for its "
    "sizes.",
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
    summary="A behavior moves a joint that does not exist or takes no commands.",
    what="Compares `joints` with the joints of the robot that Gazebo builds: revolute, continuous "
    "and prismatic joints that mimic no other joint take commands.",
    why="The behavior is not simulated.",
    example="joints = { shouder = 0.5 }",
    instead="joints = { shoulder = 0.5 }",
)


def unknown_behavior_joint(
    behavior: Behavior, positions: Mapping[str, float], robot: Robot, file: Path
) -> Iterator[Diagnostic]:
    """Report joints that a behavior moves and that take no commands."""
    joints = {} if robot.is_static else {joint.name: joint for joint in robot.movable_joints}
    names = [joint.name for joint in joints.values() if _is_commanded(joint)]
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
            f"Joints that take commands: {some_of(names)}."
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
    """Report joints that a behavior sends beyond their limits."""
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
                f"the joint `{joint.name}` is sent to {position:g}, beyond its limits "
                f"{limit.lower:g} and {limit.upper:g}.",
                "Choose a position between them, or change the <limit> of the joint.",
            )


def _is_commanded(joint: Joint) -> bool:
    return joint.type in COMMANDED and joint.mimic is None


def _why_position_not_reached(task: Drive, x: float, drive: DiffDrive | None) -> str:
    """A guess where more than the size of the wheels can be the reason."""
    usual = "Check the sizes in the plugin, the axes, and the friction of wheels and casters."
    if abs(x) < SEEN or not task.x or drive is None:
        return f"Do the wheels reach the ground, and are they strong enough? {usual}"
    if x * task.x < 0:
        return "It moved the other way: reverse the <axis> of the wheels' joints."
    if task.angular:
        return usual
    radius = drive.pairs[0].radius
    if not drive.linear.slowest <= task.linear <= drive.linear.fastest:
        return f"The plugin limits {task.linear:g} m/s."
    return (
        f"{_size_in_plugin(drive, radius)}: {_size(drive, radius * x / task.x)} would explain it, "
        "if the wheels are strong enough."
        if not 1 / ALIKE < x / task.x < ALIKE
        else usual
    )


def _why_heading_not_reached(task: Drive, turned: float, drive: DiffDrive | None) -> str:
    if drive is None or not task.yaw or abs(turned) < SEEN:
        return (
            "Something brakes one side: check the friction of casters, and whether both wheels "
            "touch the ground."
        )
    if turned * task.yaw < 0:
        return "It turned the other way: swap <left_joint> and <right_joint>."
    separation = drive.pairs[0].separation
    return (
        f"The plugin has wheel_separation = {separation:g} m: "
        f"{separation * task.yaw / turned:.3g} m would fit, if the size of the wheels is right."
    )


def _size_in_plugin(drive: DiffDrive, radius: float) -> str:
    return f"The plugin has {_size(drive, radius)}"


def _size(drive: DiffDrive, radius: float) -> str:
    if drive.simulator == "classic":
        return f"wheel_diameter = {2 * radius:.3g} m"
    return f"wheel_radius = {radius:.3g} m"


def some_of(names: Sequence[str], quote: str = "`") -> str:
    """The first few, in words."""
    first = ", ".join(f"{quote}{name}{quote}" for name in names[:NAMED])
    return first + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def _short(number: float) -> str:
    """Three decimals; adding zero turns -0.0 into 0."""
    return f"{round(number, 3) + 0.0:g}"


def error_about(rule: Rule, behavior: Behavior, file: Path, message: str, hint: str) -> Diagnostic:
    """An error that names the behavior and its place."""
    return rule.at(
        file,
        behavior.line,
        f"behavior `{behavior.name}`",
        message=f"`{behavior.name}`: {message}",
        hint=hint,
    )
