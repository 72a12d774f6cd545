"""What tests assert of robots, checked and explained as `wsgen validate` does."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.behaviors import (
    check_behavior,
    command_beyond_limit,
    unknown_behavior_joint,
)
from wsgen.diagnostics import Severity
from wsgen.errors import RequestError
from wsgen.model.behavior import Behavior, BehaviorRun, Drive, Reach
from wsgen.pipeline.run_robots import check_robot
from wsgen.reporting.words import render_text
from wsgen.simulation.scene import BehaviorMeasurement
from wsgen.testing.robot import assert_simulated

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.testing.robot import Moved, Robot

__tracebackhide__ = True  # the tracebacks of tests end where these are called


def assert_stands(robot: Robot, seconds: float = 3.0) -> None:
    """Let time pass, and check what `wsgen validate` checks of a robot that stands.

    It must stay upright and where it is, out of the ground and out of other robots, and come to
    rest. What commands it goes on doing so.

    Args:
        robot: The robot.
        seconds: How much simulated time passes.

    Raises:
        AssertionError: It does not; the message says why and what to do.
    """
    assert_simulated(robot)
    loaded = robot.simulation.loaded
    robot_run = robot.simulation.watch(seconds)[robot.name]
    runnable = [one for one in loaded.prepared if one.can_run]
    found = check_robot(loaded.world, runnable, robot.prepared, robot_run)
    _fail(f"The robot `{robot.name}` does not stand.", found)


def assert_reaches(
    robot: Robot, positions: Mapping[str, float], *, within: float = 0.05, seconds: float = 3.0
) -> None:
    """Have joints go to positions, and check that they get there.

    Args:
        robot: The robot; its joints go on holding the positions.
        positions: rad or m, by joint.
        within: How far from these they may be at the end, rad or m.
        seconds: How much simulated time passes.

    Raises:
        AssertionError: They do not get there.
        RequestError: A joint does not exist, or a position is beyond its limits.
    """
    task = Reach(positions=positions, within=within)
    behavior = Behavior(name="assert_reaches", task=task, seconds=seconds)
    model = robot.description
    for impossible in (
        *unknown_behavior_joint(behavior, positions, model, NO_FILE),
        *command_beyond_limit(behavior, positions, model.joints, NO_FILE),
    ):
        message = _without_name(impossible)
        raise RequestError(message[:1].upper() + message[1:], hint=impossible.hint or "")
    robot.hold(positions, seconds)
    _check(robot, behavior, BehaviorMeasurement(behavior.name, STILL, robot.positions))


def assert_drives(  # noqa: PLR0913  as a behavior
    robot: Robot,
    *,
    linear: float = 0.0,
    angular: float = 0.0,
    seconds: float = 2.0,
    x: float | None = None,
    y: float | None = None,
    yaw: float | None = None,
    tolerance: float = 0.1,
) -> Moved:
    """Drive as a Twist on /cmd_vel says, and check where the robot gets.

    Args:
        robot: The robot.
        linear: m/s, ahead.
        angular: rad/s, to the left.
        seconds: How much simulated time passes.
        x: Where it should be at the end, seen from where it began: m, ahead; None: not checked.
        y: Likewise, to the left.
        yaw: How far it should have turned, rad; whole turns included.
        tolerance: By what share of the way it may miss that.

    Returns:
        How far it came.

    Raises:
        AssertionError: It gets elsewhere.
        RequestError: It has no diff drive plugin that works.
    """
    task = Drive(linear=linear, angular=angular, x=x, y=y, yaw=yaw, tolerance=tolerance)
    behavior = Behavior(name="assert_drives", task=task, seconds=seconds)
    moved = robot.drive(linear=linear, angular=angular, seconds=seconds)
    _check(robot, behavior, BehaviorMeasurement(behavior.name, moved, robot.positions))
    return moved


NO_FILE = Path()  # a test is not written in wsgen.toml
STILL = (0.0, 0.0, 0.0)


def _check(robot: Robot, behavior: Behavior, behaved: BehaviorMeasurement) -> None:
    is_drive = isinstance(behavior.task, Drive)
    behavior_run = BehaviorRun(
        entity=robot.name, behavior=behavior, drive=robot.diff_drive if is_drive else None
    )
    if not robot.state.is_finite:
        raise AssertionError(f"The state of the robot `{robot.name}` is not finite any more.")
    problems = [
        f"{_without_name(found)}\n{found.hint}"
        for found in check_behavior(behavior_run, behaved, NO_FILE)
    ]
    if problems:
        raise AssertionError(f"The robot `{robot.name}`: " + "\n".join(problems))


def _without_name(found: Diagnostic) -> str:
    """The message of a diagnostic about a behavior, without the behavior's name."""
    return found.message.partition(": ")[2]


def _fail(summary: str, found: Sequence[Diagnostic]) -> None:
    errors = [one for one in found if one.severity is Severity.ERROR]
    if errors:
        raise AssertionError(f"{summary}\n{render_text(errors)}")
