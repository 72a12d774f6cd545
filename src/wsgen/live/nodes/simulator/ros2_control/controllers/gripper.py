"""Grippers with one joint, by an action.

Source: ros-controls/ros2_controllers: gripper_controllers (position_controllers and
effort_controllers' GripperActionController, Humble to Kilted) and parallel_gripper_controller.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from control_msgs import action
from rclpy.action import CancelResponse, GoalResponse

from wsgen.live.nodes.simulator.ros2_control.controllers.actions import GoalServer
from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import EFFORT, POSITION, VELOCITY, Gains, Pid

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.controllers.actions import End


class PositionGripperController(Controller):
    """Moves one joint to a position; ends when it is there, or does not get any further."""

    kind = POSITION  # of its command interface
    action: Any = action.GripperCommand
    _goal: Any = None
    _server: GoalServer | None = None

    def configure(self) -> None:
        """Read the parameters."""
        parameters = self.parameters
        self._joint = parameters.text("joint")
        if not self._joint:
            message = "Joint name cannot be empty"
            raise ControllerError(message)
        self.info(f"Joint name is : {self._joint}")
        self.commands = (f"{self._joint}/{self.kind}",)
        self.states = (f"{self._joint}/{POSITION}", f"{self._joint}/{VELOCITY}")
        self._server = GoalServer(
            self.node,
            self.action,
            f"{self.name}/gripper_cmd",
            execute_callback=lambda goal: self.action.Result(),  # noqa: ARG005  never called
            goal_callback=self._answer,
            handle_accepted_callback=self._begin,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self.keep(self._server)
        self.on_parameters()

    def on_parameters(self) -> None:
        """Read those that may change at any time."""
        parameters = self.parameters
        self._tolerance = parameters.number("goal_tolerance", 0.01)
        self._stalled_speed = parameters.number("stall_velocity_threshold", 0.001)
        self._stall_seconds = parameters.number("stall_timeout", 1.0)
        self._may_stall = parameters.flag("allow_stalling")
        self._max_effort = parameters.number("max_effort", 0.0)

    def activate(self) -> None:
        """Stay where it is."""
        self._target = self.interfaces.states[self.states[0]]  # type: ignore[index]  # set above
        self._moved = self.clock()

    def reset(self, now: float) -> None:  # noqa: ARG002  it is the clock's
        """End a goal, stay where it is."""
        self.deactivate()
        self.activate()

    def deactivate(self) -> None:
        """End a goal."""
        self._end("abort", stalled=False, reached=False)

    def _position_of(self, goal: Any) -> float | None:
        return float(goal.command.position)

    def _answer(self, goal: Any) -> GoalResponse:
        if not self.is_active or self._position_of(goal) is None:
            self.error("The goal is refused: the controller is not active, or has no position.")
            return GoalResponse.REJECT
        self.info("Received & accepted new action goal")
        return GoalResponse.ACCEPT

    def _begin(self, goal: Any) -> None:
        self._end("abort", stalled=False, reached=False)
        self._goal = goal
        goal.execute()
        self._target = self._position_of(goal.request) or 0.0
        self._moved = self.clock()

    def update(self, now: float, elapsed: float) -> None:
        """Command the joint, and see whether it is there."""
        states = self.interfaces.states
        position, speed = (states[f"{self._joint}/{kind}"] for kind in (POSITION, VELOCITY))
        error = self._target - position
        if self._goal is not None:
            if self._goal.is_cancel_requested:
                self.info("Canceling active action goal because cancel callback received.")
                self._target = position
                self._end("canceled", stalled=False, reached=False)
            elif abs(error) < self._tolerance:
                self._end("succeed", stalled=False, reached=True)
            elif abs(speed) > self._stalled_speed:
                self._moved = now
            elif now - self._moved > self._stall_seconds:
                end: End = "succeed" if self._may_stall else "abort"
                self._end(end, stalled=True, reached=False)
        self.interfaces.commands[self.commands[0]] = self._command(error, speed, elapsed)

    def _command(self, error: float, speed: float, elapsed: float) -> float:  # noqa: ARG002  see below
        """The command of the joint."""
        return self._target

    def _end(self, end: End, *, stalled: bool, reached: bool) -> None:
        goal, self._goal = self._goal, None
        if goal is not None and self._server is not None:
            self._server.finish(goal, end, self._result(stalled=stalled, reached=reached))

    def _result(self, *, stalled: bool, reached: bool) -> Any:
        states = self.interfaces.states
        return action.GripperCommand.Result(
            position=states[f"{self._joint}/{POSITION}"],
            effort=states.get(f"{self._joint}/{EFFORT}", 0.0),
            stalled=stalled,
            reached_goal=reached,
        )


class EffortGripperController(PositionGripperController):
    """The same by efforts, of a PID controller with the `gains` of its joint."""

    kind = EFFORT

    def on_parameters(self) -> None:
        """The gains as well."""
        super().on_parameters()
        number, prefix = self.parameters.number, f"gains.{self._joint}"
        clamp = abs(number(f"{prefix}.i_clamp"))
        self._pid = Pid(
            Gains(
                p=number(f"{prefix}.p"),
                i=number(f"{prefix}.i"),
                d=number(f"{prefix}.d"),
                most=clamp,
                least=-clamp,
            )
        )

    def _command(self, error: float, speed: float, elapsed: float) -> float:
        effort = self._pid.command(error, elapsed, -speed)
        if self._max_effort > 0.0:
            effort = min(self._max_effort, max(-self._max_effort, effort))
        return effort


class ParallelGripperController(PositionGripperController):
    """That of newer releases: its goal is a `sensor_msgs/JointState` with one position."""

    action: Any = getattr(action, "ParallelGripperCommand", None)

    def configure(self) -> None:
        """Only where the messages are new enough."""
        if self.action is None:
            message = "control_msgs of this release has no action ParallelGripperCommand"
            raise ControllerError(message)
        super().configure()

    def _position_of(self, goal: Any) -> float | None:
        positions = goal.command.position
        return float(positions[0]) if len(positions) == 1 else None

    def _result(self, *, stalled: bool, reached: bool) -> Any:
        states = self.interfaces.states
        result = self.action.Result(stalled=stalled, reached_goal=reached)
        result.state.name = [self._joint]
        result.state.position = [states[f"{self._joint}/{POSITION}"]]
        result.state.effort = [states.get(f"{self._joint}/{EFFORT}", 0.0)]
        return result
