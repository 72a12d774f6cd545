"""Gripper controllers, of a finger that slides, in PyBullet; their action without ROS."""

from __future__ import annotations

import importlib
import sys
import types
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.ros2_control.controlled import controlled
from simulation.robots import body, joint, tree
from wsgen.model.robot import Box, JointLimit, JointType, Link
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from collections.abc import Mapping

pytestmark = pytest.mark.usefixtures("messages")

POSITION = "position_controllers/GripperActionController"
EFFORT = "effort_controllers/GripperActionController"
PARALLEL = "parallel_gripper_action_controller/GripperActionController"
FINGER = tree(
    Link(name="world"),
    (
        joint(
            "world",
            "finger",
            JointType.PRISMATIC,
            Pose((0.0, 0.0, 1.0)),
            axis_in_joint=(1.0, 0.0, 0.0),
            limit=JointLimit(lower=0.0, upper=0.08, effort=20.0, velocity=0.2),
        ),
        body(Box(size=(0.02, 0.02, 0.1)), name="finger", mass=0.2),
    ),
    fixed_to_world=True,
)


class Goal:
    """The handle of a goal."""

    def __init__(self, request: Any) -> None:
        self.request = request
        self.is_active, self.is_cancel_requested = True, False
        self.end: str | None = None
        self.result: Any = None

    def execute(self) -> None:
        pass

    def succeed(self) -> None:
        self.end, self.is_active = "succeeded", False

    def abort(self) -> None:
        self.end, self.is_active = "aborted", False

    def canceled(self) -> None:
        self.end, self.is_active = "canceled", False


class Server:
    """rclpy's action server, as far as it is used."""

    def __init__(self, node: Any, kind: Any, name: str, **callbacks: Any) -> None:
        self.kind, self.name, self.callbacks = kind, name, callbacks
        node.server = self

    def notify_execute(self, goal: Goal, execute: Any) -> None:
        goal.result = execute(goal)

    def destroy(self) -> None:
        pass

    def send(self, **command: Any) -> Goal | None:
        """Ask for a position, as a client does; None where it is refused."""
        request = types.SimpleNamespace(command=types.SimpleNamespace(**command))
        if self.callbacks["goal_callback"](request) != "accept":
            return None
        goal = Goal(request)
        self.callbacks["handle_accepted_callback"](goal)
        return goal


@pytest.fixture(autouse=True)
def _actions(monkeypatch: pytest.MonkeyPatch, messages: None) -> None:
    """Actions of control_msgs and the server of rclpy."""
    rclpy_action: Any = types.ModuleType("rclpy.action")
    rclpy_action.ActionServer = Server
    rclpy_action.GoalResponse = types.SimpleNamespace(ACCEPT="accept", REJECT="reject")
    rclpy_action.CancelResponse = types.SimpleNamespace(ACCEPT="accept")
    actions: Any = types.ModuleType("control_msgs.action")

    def parallel(**values: Any) -> Any:
        return types.SimpleNamespace(state=types.SimpleNamespace(), **values)

    actions.GripperCommand = types.SimpleNamespace(Result=types.SimpleNamespace)
    actions.ParallelGripperCommand = types.SimpleNamespace(Result=parallel)
    package: Any = types.ModuleType("control_msgs")
    package.action = actions
    for module in (types.ModuleType("rclpy"), rclpy_action, package, actions):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)


def gripping(kind: str, interface: str, **parameters: Any) -> Any:
    values: Mapping[str, Any] = {"joint": "finger", "goal_tolerance": 0.002, **parameters}
    return controlled(FINGER, kind, values, {"finger": [interface]}, height=0.0)


def where(made: Any) -> float:
    found: float = made.robot.joint_positions()["finger"]
    return found


def test_a_gripper_closes() -> None:
    """As gripper_controllers has it: a goal ends when the joint is within the tolerance."""
    with gripping(POSITION, "position") as made:
        server = made.node.server
        assert server.name == "controller/gripper_cmd"
        goal = server.send(position=0.05, max_effort=5.0)
        made.run(0.1)
        assert goal.end is None
        made.run(0.9)
        assert where(made) == pytest.approx(0.05, abs=0.002)
        assert goal.end == "succeeded"
        assert (goal.result.reached_goal, goal.result.stalled) == (True, False)
        assert goal.result.position == pytest.approx(0.05, abs=0.002)


@pytest.mark.parametrize(("may_stall", "end"), [(False, "aborted"), (True, "succeeded")])
def test_a_gripper_that_gets_no_further(may_stall: bool, end: str) -> None:
    with gripping(POSITION, "position", stall_timeout=0.3, allow_stalling=may_stall) as made:
        goal = made.node.server.send(position=0.2, max_effort=0.0)  # the joint ends at 0.08
        made.run(0.6)  # 0.4 s at 0.2 m/s, and a little
        assert goal.end is None
        made.run(0.8)
        assert goal.end == end
        assert (goal.result.reached_goal, goal.result.stalled) == (False, True)
        assert goal.result.position == pytest.approx(0.08, abs=1e-3)


def test_goals_that_are_replaced_canceled_and_refused() -> None:
    with gripping(POSITION, "position") as made:
        server = made.node.server
        first, second = (server.send(position=value, max_effort=0.0) for value in (0.05, 0.07))
        assert first.end == "aborted"
        made.run(0.2)
        second.is_cancel_requested = True
        made.run(0.1)
        assert second.end == "canceled"
        stopped = where(made)
        made.run(0.3)
        assert where(made) == pytest.approx(stopped, abs=5e-3)
        made.controller.is_active = False
        assert server.send(position=0.01, max_effort=0.0) is None
        assert "not active" in made.node.said[-1]


def test_a_gripper_by_efforts_does_not_push_harder_than_it_may() -> None:
    gains = {"gains.finger.p": 400.0, "gains.finger.d": 15.0}
    with gripping(EFFORT, "effort", max_effort=1.5, **gains) as made:
        goal = made.node.server.send(position=0.06, max_effort=0.0)
        commands = made.controller.interfaces.commands
        made.run(0.01)
        assert commands["finger/effort"] == 1.5  # not 400 N/m * 0.06 m
        made.run(0.05)
        # 1.5 N at 0.2 kg, until the error is small.
        assert where(made) == pytest.approx(0.5 * 1.5 / 0.2 * 0.06**2, rel=0.05)
        made.run(1.0)
        assert goal.end == "succeeded"
        assert where(made) == pytest.approx(0.06, abs=0.003)


def test_a_parallel_gripper() -> None:
    """As parallel_gripper_controller has it, whose goal is a JointState."""
    with gripping(PARALLEL, "position") as made:
        server = made.node.server
        assert server.send(position=[0.01, 0.02]) is None
        goal = server.send(position=[0.04])
        made.run(1.0)
        assert goal.end == "succeeded"
        assert goal.result.state.name == ["finger"]
        assert goal.result.state.position == [pytest.approx(0.04, abs=0.002)]


def test_a_gripper_without_a_joint() -> None:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import (  # noqa: PLC0415
        ControllerError,
    )

    with (
        pytest.raises(ControllerError, match="Joint name cannot be empty"),
        gripping(POSITION, "position", joint=""),
    ):
        pass
