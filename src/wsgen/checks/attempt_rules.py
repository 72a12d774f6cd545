"""Rules over what a robot must do beyond standing: can it be tried?

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.behaviour_rules import error_about, some_of
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behaviour import Behaviour
    from wsgen.model.robot import Joint, Robot

COMMANDED = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
LIMITED = (JointType.REVOLUTE, JointType.PRISMATIC)
AT_LIMIT = 1e-6  # rad or m; limits are rounded when they are written


def robot_not_found(
    behaviour: Behaviour, entities: Sequence[str], file: Path
) -> Iterator[Diagnostic]:
    """It is not clear which robot a behaviour is for.

    ## What it does
    Compares `robot` with the names that the launch file spawns robots under.

    ## Why is this bad?
    The behaviour is not tried.

    ## Use instead
    `robot` with one of these names; without it there must be one robot alone.
    """
    if behaviour.robot in entities or (behaviour.robot is None and len(entities) == 1):
        return
    there = ", ".join(f"`{entity}`" for entity in entities)
    yield error_about(
        "SPN080",
        behaviour,
        file,
        f"no robot is spawned as `{behaviour.robot}`."
        if behaviour.robot is not None
        else f"{len(entities)} robots are spawned, and it does not say which one is meant.",
        f'Write robot = "NAME" into it; there are {there}.',
    )


def nothing_to_drive_with(
    behaviour: Behaviour, reason: str, hint: str, file: Path, *, has_plugin: bool
) -> Iterator[Diagnostic]:
    """A behaviour drives a robot that nothing drives in Gazebo.

    ## What it does
    Looks in the description for the plugin of a differential drive, for its joints and its sizes.

    ## Why is this bad?
    In Gazebo the robot would not listen to /cmd_vel either.

    ## Use instead
    `gz-sim-diff-drive-system` or `libgazebo_ros_diff_drive.so` with the joints of the wheels.
    """
    code = "SPN082" if has_plugin else "SPN081"
    yield error_about(code, behaviour, file, f"the robot cannot be driven: {reason}.", hint)


def joint_cannot_be_commanded(
    behaviour: Behaviour, positions: Mapping[str, float], robot: Robot, file: Path
) -> Iterator[Diagnostic]:
    """A behaviour moves a joint that does not exist, or that moves by itself.

    ## What it does
    Compares `joints` with the joints of the robot that Gazebo builds.

    ## Why is this bad?
    The behaviour is not tried.

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
            behaviour,
            file,
            f"the robot has no joint `{name}` that can move."
            if mimics is None
            else f"the joint `{name}` follows `{mimics}` and takes no commands.",
            f"There are {some_of(names)}."
            if names
            else "Give it revolute, continuous or prismatic joints.",
        )


def commanded_beyond_limit(
    behaviour: Behaviour, positions: Mapping[str, float], joints: Sequence[Joint], file: Path
) -> Iterator[Diagnostic]:
    """A behaviour sends a joint beyond its limits.

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
                behaviour,
                file,
                f"the joint `{joint.name}` is sent to {position:g}, beyond its limits "
                f"{limit.lower:g} and {limit.upper:g}.",
                "Send it to a position between them, or change the <limit> of the joint.",
            )


def _is_commanded(joint: Joint) -> bool:
    return joint.type in COMMANDED and joint.mimic is None
