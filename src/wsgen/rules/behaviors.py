"""Rules over what a robot must do beyond standing: does it do it?

The parameters are facts in SI units; a rule yields what it finds. All findings name the behavior
and its place in `wsgen.toml`.

Rules over what a robot must do beyond standing: can it be tried?

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.behavior import Drive
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.behavior import Behavior, BehaviorRun, DiffDrive, Reach
    from wsgen.model.robot import Joint, Robot
    from wsgen.simulation.scene import BehaviorMeasurement


NAMED = 5  # so many joints are told in a message
SEEN = 0.01  # m or rad; of less there is no telling what is wrong
ALIKE = 1.05  # sizes that differ by less are the same


def check_behavior(
    behavior_run: BehaviorRun, behaved: BehaviorMeasurement, file: Path
) -> tuple[Diagnostic, ...]:
    """All rules over one behavior that was tried."""
    behavior = behavior_run.behavior
    if not behaved.is_finite:
        return tuple(behavior_explodes(behavior, file))
    if isinstance(behavior.task, Drive):
        return (
            *moves_otherwise(behavior, behavior.task, behaved.moved, behavior_run.drive, file),
            *turns_otherwise(behavior, behavior.task, behaved.moved[2], behavior_run.drive, file),
        )
    return tuple(joints_not_reached(behavior, behavior.task, behaved.positions, file))


def moves_otherwise(
    behavior: Behavior,
    task: Drive,
    moved: tuple[float, float, float],
    drive: DiffDrive | None,
    file: Path,
) -> Iterator[Diagnostic]:
    """The robot does not get where it should.

    ## What it does
    Drives the robot through its plugin, and compares where it gets with `moved`, with a slack of
    `tolerance` times the way.

    ## Why is this bad?
    Odometry and navigation go by what the plugin is told: they would be wrong by as much.

    ## Use instead
    The wheels' own size in the plugin; axes that all point to the left; wheels that carry the
    weight, and casters that slide.
    """
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
            "SPN085",
            behavior,
            file,
            f"after {behavior.seconds:g} s the robot is at x = {_told(x)} m, y = {_told(y)} m "
            f"from where it began; {wanted} is wanted, give or take {slack:.2g} m.",
            _why_it_moves_otherwise(task, x, drive),
        )


def turns_otherwise(
    behavior: Behavior, task: Drive, turned: float, drive: DiffDrive | None, file: Path
) -> Iterator[Diagnostic]:
    """The robot does not turn as it should.

    ## What it does
    Drives the robot through its plugin, and compares how far it turns with the `yaw` of `moved`,
    with a slack of `tolerance` times the angle.

    ## Why is this bad?
    Odometry and navigation go by what the plugin is told: they would be wrong by as much.

    ## Use instead
    The wheels' own distance in <wheel_separation>, measured between where they touch the ground.
    """
    if task.yaw is None:
        return
    slack = task.slack(task.yaw)
    if abs(turned - task.yaw) > slack:
        yield error_about(
            "SPN086",
            behavior,
            file,
            f"in {behavior.seconds:g} s the robot turns by {_told(turned)} rad; "
            f"{task.yaw:g} rad is wanted, give or take {slack:.2g} rad.",
            _why_it_turns_otherwise(task, turned, drive),
        )


def joints_not_reached(
    behavior: Behavior, task: Reach, positions: Mapping[str, float], file: Path
) -> Iterator[Diagnostic]:
    """Joints are not where they were sent.

    ## What it does
    Gives joints positions, and compares where they are at the end; they are as strong and as fast
    as their limits say.

    ## Why is this bad?
    The arm hangs, or moves more slowly than who plans its motions believes.

    ## Use instead
    An `effort` that carries what hangs on the joint, a `velocity` that gets there in time.
    """
    missed = {
        name: positions[name]
        for name, wanted in task.positions.items()
        if abs(positions[name] - wanted) > task.within
    }
    if missed:
        told = some_of(
            [
                f"{name} is at {_told(position)} (not {task.positions[name]:g})"
                for name, position in missed.items()
            ],
            quote="",
        )
        yield error_about(
            "SPN087",
            behavior,
            file,
            f"after {behavior.seconds:g} s {told}.",
            "Raise `effort` in the <limit> of joints that carry much, or `velocity` of those that "
            "are late; give it more `seconds`; look for what the robot runs into.",
        )


def behavior_explodes(behavior: Behavior, file: Path) -> Iterator[Diagnostic]:
    """A position became infinite or not-a-number while a behavior was tried.

    ## What it does
    Looks at every pose and joint.

    ## Why is this bad?
    The simulation has exploded; Gazebo ends with an assertion or shows nothing.

    ## Use instead
    Masses, inertias, sizes and efforts in SI units, none beyond reason.
    """
    yield error_about(
        "SPN088",
        behavior,
        file,
        "the robot's pose became infinite or not-a-number.",
        "Check masses, inertias and the limits of effort: SI units, none zero, none huge.",
    )


def _why_it_moves_otherwise(task: Drive, x: float, drive: DiffDrive | None) -> str:
    """What would explain it; a guess where more than the wheels' size can be wrong."""
    usual = "Look at the sizes in the plugin, the axes and the friction of wheels and casters."
    if abs(x) < SEEN or not task.x or drive is None:
        return f"Do the wheels reach the ground, and are they strong enough? {usual}"
    if x * task.x < 0:
        return "It went the other way: turn the <axis> of the wheels' joints around."
    if task.angular:
        return usual
    radius = drive.pairs[0].radius
    if not drive.linear.slowest <= task.linear <= drive.linear.fastest:
        return f"The plugin does not let {task.linear:g} m/s through."
    return (
        f"{_size_in_plugin(drive, radius)}: {_size(drive, radius * x / task.x)} would explain it, "
        "if the wheels are as strong as they must be."
        if not 1 / ALIKE < x / task.x < ALIKE
        else usual
    )


def _why_it_turns_otherwise(task: Drive, turned: float, drive: DiffDrive | None) -> str:
    if drive is None or not task.yaw or abs(turned) < SEEN:
        return (
            "Something brakes one side: look at friction of casters, and whether both wheels touch "
            "the ground."
        )
    if turned * task.yaw < 0:
        return "It turned the other way: exchange <left_joint> and <right_joint>."
    separation = drive.pairs[0].separation
    return (
        f"The plugin takes wheel_separation = {separation:g} m: "
        f"{separation * task.yaw / turned:.3g} m would fit, if the size of the wheels is right."
    )


def _size_in_plugin(drive: DiffDrive, radius: float) -> str:
    return f"The plugin takes {_size(drive, radius)}"


def _size(drive: DiffDrive, radius: float) -> str:
    if drive.generation == "classic":
        return f"wheel_diameter = {2 * radius:.3g} m"
    return f"wheel_radius = {radius:.3g} m"


def some_of(names: Sequence[str], quote: str = "`") -> str:
    """The first few, in words."""
    told = ", ".join(f"{quote}{name}{quote}" for name in names[:NAMED])
    return told + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def _told(number: float) -> str:
    """Millimetres; adding zero makes -0.00 plain."""
    return f"{round(number, 3) + 0.0:g}"


def error_about(code: str, behavior: Behavior, file: Path, message: str, hint: str) -> Diagnostic:
    """An error that names the behavior and its place."""
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=f"`{behavior.name}`: {message}",
        file=file,
        line=behavior.line,
        element=f"behavior `{behavior.name}`",
        hint=hint,
    )


COMMANDED = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
LIMITED = (JointType.REVOLUTE, JointType.PRISMATIC)
AT_LIMIT = 1e-6  # rad or m; limits are rounded when they are written


def robot_not_found(
    behavior: Behavior, entities: Sequence[str], file: Path
) -> Iterator[Diagnostic]:
    """It is not clear which robot a behavior is for.

    ## What it does
    Compares `robot` with the names that the launch file spawns robots under.

    ## Why is this bad?
    The behavior is not tried.

    ## Use instead
    `robot` with one of these names; without it there must be one robot alone.
    """
    if behavior.robot in entities or (behavior.robot is None and len(entities) == 1):
        return
    there = ", ".join(f"`{entity}`" for entity in entities)
    yield error_about(
        "SPN080",
        behavior,
        file,
        f"no robot is spawned as `{behavior.robot}`."
        if behavior.robot is not None
        else f"{len(entities)} robots are spawned, and it does not say which one is meant.",
        f'Write robot = "NAME" into it; there are {there}.',
    )


def nothing_to_drive_with(
    behavior: Behavior, reason: str, hint: str, file: Path, *, has_plugin: bool
) -> Iterator[Diagnostic]:
    """A behavior drives a robot that nothing drives in Gazebo.

    ## What it does
    Looks in the description for the plugin of a differential drive, for its joints and its sizes.

    ## Why is this bad?
    In Gazebo the robot would not listen to /cmd_vel either.

    ## Use instead
    `gz-sim-diff-drive-system` or `libgazebo_ros_diff_drive.so` with the joints of the wheels.
    """
    code = "SPN082" if has_plugin else "SPN081"
    yield error_about(code, behavior, file, f"the robot cannot be driven: {reason}.", hint)


def joint_cannot_be_commanded(
    behavior: Behavior, positions: Mapping[str, float], robot: Robot, file: Path
) -> Iterator[Diagnostic]:
    """A behavior moves a joint that does not exist, or that moves by itself.

    ## What it does
    Compares `joints` with the joints of the robot that Gazebo builds.

    ## Why is this bad?
    The behavior is not tried.

    ## Use instead
    The name of a revolute, continuous or prismatic joint that mimics no other.
    """
    joints = {} if robot.is_static else {joint.name: joint for joint in robot.movable_joints}
    names = [joint.name for joint in joints.values() if _is_commanded(joint)]
    for name in positions:
        if name in names:
            continue
        joint = joints.get(name)
        mimics = joint.mimic.joint if joint is not None and joint.mimic is not None else None
        yield error_about(
            "SPN083",
            behavior,
            file,
            f"the robot has no joint `{name}` that can move."
            if mimics is None
            else f"the joint `{name}` follows `{mimics}` and takes no commands.",
            f"There are {some_of(names)}."
            if names
            else "Give it revolute, continuous or prismatic joints.",
        )


def commanded_beyond_limit(
    behavior: Behavior, positions: Mapping[str, float], joints: Sequence[Joint], file: Path
) -> Iterator[Diagnostic]:
    """A behavior sends a joint beyond its limits.

    ## What it does
    Compares the positions of `joints` with the limits in the description.

    ## Why is this bad?
    The joint cannot get there; ros2_control refuses or cuts such a command.

    ## Use instead
    A position within the limits, or other limits.
    """
    for joint in joints:
        limit = joint.limit
        position = positions.get(joint.name)
        if position is None or limit is None or joint.type not in LIMITED:
            continue
        if not limit.lower - AT_LIMIT <= position <= limit.upper + AT_LIMIT:
            yield error_about(
                "SPN084",
                behavior,
                file,
                f"the joint `{joint.name}` is sent to {position:g}, beyond its limits "
                f"{limit.lower:g} and {limit.upper:g}.",
                "Send it to a position between them, or change the <limit> of the joint.",
            )


def _is_commanded(joint: Joint) -> bool:
    return joint.type in COMMANDED and joint.mimic is None
