"""Trajectories by a topic and by an action.

Source: ros-controls/ros2_controllers, joint_trajectory_controller, of Humble to Kilted:
src/joint_trajectory_controller.cpp and its parameters.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTrajectoryControllerState
from rclpy.action import CancelResponse, GoalResponse
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from wsgen.live.nodes.simulator.ros2_control.controllers.actions import GoalServer
from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller, ControllerError
from wsgen.live.nodes.simulator.ros2_control.hardware import EFFORT, POSITION, VELOCITY, Gains, Pid
from wsgen.live.nodes.simulator.ros2_control.trajectory import (
    FIELDS,
    Accepted,
    Follower,
    Message,
    Outcome,
    Point,
    Step,
    Tolerance,
    Tolerances,
    Trajectory,
    effective,
)
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.live.nodes.simulator.ros2_control.controllers.actions import End

ACCELERATION = "acceleration"
KINDS = (POSITION, VELOCITY, ACCELERATION, EFFORT)
FIELD_OF = dict(zip(KINDS, FIELDS, strict=True))
Result = FollowJointTrajectory.Result
FEEDBACK_PERIOD = 0.05  # s; `action_monitor_rate` is 20 Hz


class JointTrajectoryController(Controller):
    """Moves joints along trajectories."""

    _goal: Any = None  # its handle
    _server: GoalServer | None = None
    _follower: Follower | None = None

    def configure(self) -> None:
        """Read the parameters, open topics and action."""
        parameters = self.parameters
        self._joints = tuple(self.require("joints"))
        self._command_joints = tuple(parameters.texts("command_joints")) or self._joints
        self._kinds = tuple(self.require("command_interfaces"))
        state_kinds = tuple(self.require("state_interfaces"))
        self._check_kinds(state_kinds)
        self.commands = tuple(
            f"{joint}/{kind}" for joint in self._command_joints for kind in self._kinds
        )
        self.states = tuple(f"{joint}/{kind}" for joint in self._joints for kind in state_kinds)
        self._read = {kind: [f"{joint}/{kind}" for joint in self._joints] for kind in state_kinds}
        commanded = set(self._command_joints)
        self._write = {
            kind: [
                (index, f"{joint}/{kind}")
                for index, joint in enumerate(self._joints)
                if joint in commanded
            ]
            for kind in self._kinds
        }
        self._has_pids = self._kinds in ((VELOCITY,), (EFFORT,))
        self._wraps = [
            name in self.joints and self.joints[name].type is JointType.CONTINUOUS
            for name in self._joints
        ]
        self._interpolates = parameters.text("interpolation_method", "splines") != "none"
        rate = parameters.number("action_monitor_rate", 20.0)
        self._feedback_period = 1.0 / rate if rate > 0 else FEEDBACK_PERIOD
        self._next_feedback = 0.0
        self.on_parameters()
        self.subscription(JointTrajectory, "~/joint_trajectory", self._take)
        self._state_publisher = self.publisher(JointTrajectoryControllerState, "~/controller_state")
        self._old_publisher = (
            self.publisher(JointTrajectoryControllerState, "~/state") if self.is_former else None
        )
        self._query()
        self._server = GoalServer(
            self.node,
            FollowJointTrajectory,
            f"{self.name}/follow_joint_trajectory",
            execute_callback=lambda goal: Result(),  # noqa: ARG005  never called
            goal_callback=self._answer_goal,
            handle_accepted_callback=self._begin_goal,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self.keep(self._server)
        self.info(
            f"Command interfaces are [{' '.join(self._kinds)}] and state interfaces are "
            f"[{' '.join(state_kinds)}]."
        )
        self.info(f"Action status changes will be monitored at {rate:.2f} Hz.")

    def _check_kinds(self, state_kinds: Sequence[str]) -> None:
        for name, kinds in (("command", self._kinds), ("state", state_kinds)):
            for kind in kinds:
                if kind not in KINDS:
                    message = f"Invalid value for the parameter '{name}_interfaces': '{kind}'"
                    raise ControllerError(message)
        if POSITION not in state_kinds:
            message = "'position' is not among the 'state_interfaces'"
            raise ControllerError(message)
        if self._kinds in ((VELOCITY,), (EFFORT,)) and VELOCITY not in state_kinds:
            message = (
                f"'{self._kinds[0]}' command interface can only be used alone if 'velocity' and "
                "'position' state interfaces are present"
            )
            raise ControllerError(message)
        if not set(self._command_joints) <= set(self._joints):
            message = "'command_joints' parameter must be a subset of 'joints' parameter."
            raise ControllerError(message)

    def on_parameters(self) -> None:
        """Read those that may change at any time."""
        parameters = self.parameters
        stopped = parameters.number("constraints.stopped_velocity_tolerance", 0.01)
        self._tolerances = Tolerances(
            path=[
                Tolerance(parameters.number(f"constraints.{joint}.trajectory"))
                for joint in self._joints
            ],
            goal=[
                Tolerance(parameters.number(f"constraints.{joint}.goal"), stopped)
                for joint in self._joints
            ],
            goal_seconds=parameters.number("constraints.goal_time"),
        )
        self._accepted = Accepted(
            joints=self._joints,
            allows_partial=parameters.flag("allow_partial_joints_goal"),
            allows_integration=parameters.flag("allow_integration_in_goal_trajectories"),
            allows_moving_end=parameters.flag(
                "allow_nonzero_velocity_at_trajectory_end", default=self.is_former
            ),
            has_effort=EFFORT in self._kinds,
        )
        self._open_loop = parameters.flag("interpolate_from_desired_state") or parameters.flag(
            "open_loop_control"
        )
        if self._has_pids:
            self._pids = [
                Pid(
                    Gains(
                        p=parameters.number(f"gains.{joint}.p"),
                        i=parameters.number(f"gains.{joint}.i"),
                        d=parameters.number(f"gains.{joint}.d"),
                        most=self._clamp(joint, "max"),
                        least=self._clamp(joint, "min"),
                    )
                )
                for joint in self._joints
            ]
            self._feed_forward = [
                parameters.number(f"gains.{joint}.ff_velocity_scale") for joint in self._joints
            ]
        if self._follower is not None and self._goal is None:
            self._follower.tolerances = self._tolerances

    def _clamp(self, joint: str, end: str) -> float:
        """The bound of an integral's part; Humble's releases have one name for both."""
        sign = 1.0 if end == "max" else -1.0
        named = self.parameters.values.get(f"gains.{joint}.i_clamp_{end}")
        if isinstance(named, (int, float)):
            return float(named)
        both = self.parameters.values.get(f"gains.{joint}.i_clamp")
        if isinstance(both, (int, float)):
            return sign * abs(float(both))
        return sign * (0.0 if self.is_former else math.inf)

    def activate(self) -> None:
        """Hold where the joints are, or where the last command was."""
        timeout = self.parameters.number("cmd_timeout")
        if timeout and timeout <= self._tolerances.goal_seconds:
            self.warn(
                f"Command timeout must be higher than goal_time tolerance ({timeout:f} vs. "
                f"{self._tolerances.goal_seconds:f})"
            )
            timeout = 0.0
        self._follower = Follower(
            self._wraps,
            self.period,
            self._tolerances,
            timeout=timeout,
            compares_velocities=VELOCITY in self._read
            and (VELOCITY in self._kinds or EFFORT in self._kinds),
        )
        if self._has_pids:
            for pid in self._pids:
                pid.reset()
        at = self._actual()
        keeps = self.parameters.flag(
            "set_last_command_interface_value_as_state_on_activation", default=True
        )
        if keeps and len(self._command_joints) == len(self._joints) and POSITION in self._write:
            last = [self.interfaces.commands[name] for _, name in self._write[POSITION]]
            if all(map(math.isfinite, last)):
                at.positions = last
        self._last: Point = at
        self._follower.hold(at.positions)

    def deactivate(self) -> None:
        """End a goal, stop."""
        self._end(
            "abort", Result.INVALID_GOAL, "Current goal cancelled during deactivate transition."
        )
        for kind in (VELOCITY, ACCELERATION, EFFORT):
            for _, name in self._write.get(kind, ()):
                self.interfaces.commands[name] = 0.0
        self._follower = None

    def reset(self, now: float) -> None:
        """End a goal and a trajectory, hold where the joints are."""
        self._end("abort", Result.INVALID_GOAL, "The world was reset.")
        self._next_feedback = now
        self._last = self._actual()
        if self._follower is not None:
            self._follower.hold(self._last.positions)
        if self._has_pids:
            for pid in self._pids:
                pid.reset()

    def update(self, now: float, elapsed: float) -> None:
        """Go on."""
        follower = self._follower
        assert follower is not None  # noqa: S101  it is active
        if self._goal is not None and self._goal.is_cancel_requested:
            self.info("Canceling active action goal because cancel callback received.")
            self._end("canceled", Result.SUCCESSFUL, "")
            follower.hold(self._actual().positions)
        if self._open_loop and follower.trajectory and not follower.trajectory.is_begun:
            follower.trajectory.begin(now, self._last)
        actual = self._actual()
        step = follower.update(now, elapsed, actual)
        if step.outcome in {None, Outcome.REACHED, Outcome.TIMED_OUT}:
            self._command(step, elapsed)
        if self._goal is not None and now >= self._next_feedback:
            self._next_feedback = now + self._feedback_period
            self._publish_feedback(now, step, actual)
        if step.outcome is not None:
            self._conclude(step, actual)
        for publisher in (self._state_publisher, self._old_publisher):
            if publisher is not None and publisher.is_wanted:
                publisher.publish(self._state(now, step, actual))

    def _conclude(self, step: Step, actual: Point) -> None:
        follower, outcome = self._follower, step.outcome
        assert follower is not None  # noqa: S101  it is active
        assert outcome is not None  # noqa: S101  asked only then
        text = outcome.value.format(step.overdue)
        if outcome is Outcome.REACHED:
            self._end("succeed", Result.SUCCESSFUL, text)
            self.info("Goal reached, success!")
            follower.hold(step.command.positions)
            return
        if outcome is Outcome.OFF_PATH:
            self._report_errors(step, self._tolerances_now().path)
            if self._goal is not None:
                self.warn("Aborted due to state tolerance violation")
            else:
                self.error("Holding position due to state tolerance violation")
            self._end("abort", Result.PATH_TOLERANCE_VIOLATED, text)
        elif outcome is Outcome.OFF_GOAL:
            self._report_errors(step, self._tolerances_now().goal)
            if self._goal is not None:
                self.warn(text)
            else:
                self.error("Exceeded goal_time_tolerance: holding position...")
            self._end("abort", Result.GOAL_TOLERANCE_VIOLATED, text)
        else:
            self.warn(text)
        follower.hold(actual.positions)

    def _tolerances_now(self) -> Tolerances:
        return self._follower.tolerances if self._follower is not None else self._tolerances

    def _report_errors(self, step: Step, tolerances: Sequence[Tolerance]) -> None:
        for index, tolerance in enumerate(tolerances):
            error = step.errors.positions[index]
            if 0.0 < tolerance.position < abs(error):
                self.error(
                    f"State tolerances failed for joint {index}: Position Error: {error:f}, "
                    f"Position Tolerance: {tolerance.position:f}"
                )

    def _actual(self) -> Point:
        """Where the joints are."""
        states = self.interfaces.states
        point = Point([states[name] for name in self._read[POSITION]])
        if VELOCITY in self._read:
            point.velocities = [states[name] for name in self._read[VELOCITY]]
            if ACCELERATION in self._read:
                point.accelerations = [states[name] for name in self._read[ACCELERATION]]
        return point

    def _command(self, step: Step, elapsed: float) -> None:
        commands = self.interfaces.commands
        command = step.command
        if self._has_pids:
            kind = self._kinds[0]
            speeds = command.velocities or [0.0] * len(self._joints)
            effort = command.effort or [0.0] * len(self._joints)
            aims = step.desired.velocities or [0.0] * len(self._joints)
            states = self.interfaces.states
            for index, name in self._write[kind]:
                rate = aims[index] - states[self._read[VELOCITY][index]]
                value = self._pids[index].command(step.errors.positions[index], elapsed, rate)
                value += self._feed_forward[index] * speeds[index]
                commands[name] = value + (effort[index] if kind == EFFORT else 0.0)
        else:
            for kind, names in self._write.items():
                values = getattr(command, FIELD_OF[kind])
                for index, name in names:
                    commands[name] = values[index] if values else 0.0
        self._last = command

    def _take(self, message: Any) -> None:
        """A trajectory has come by the topic."""
        follower = self._follower
        if not self.is_active or follower is None:
            return
        sent = message_of(message)
        refusal = self._accepted.refusal(sent, self.clock())
        if refusal is not None:
            self.error(refusal)
            return
        self._follow(sent)

    def _follow(self, sent: Message) -> None:
        follower = self._follower
        assert follower is not None  # noqa: S101  it is active
        resting = dict(zip(self._joints, self._last.positions, strict=True))
        follower.follow(
            Trajectory(
                self._accepted.in_order(sent, resting),
                start=sent.start,
                wraps=self._wraps,
                interpolates=self._interpolates,
            )
        )

    def _answer_goal(self, goal: Any) -> GoalResponse:
        self.info("Received new action goal")
        if not self.is_active:
            self.error("Can't accept new action goals. Controller is not running.")
            return GoalResponse.REJECT
        refusal = self._accepted.refusal(message_of(goal.trajectory), self.clock())
        if refusal is not None:
            self.error(refusal)
            return GoalResponse.REJECT
        self.info("Accepted new action goal")
        return GoalResponse.ACCEPT

    def _begin_goal(self, goal: Any) -> None:
        self._end("abort", Result.INVALID_GOAL, "Current goal preempted by new incoming action.")
        follower = self._follower
        if follower is None:  # it was deactivated meanwhile
            goal.execute()
            goal.abort()
            return
        self._goal = goal
        goal.execute()
        follower.tolerances = self._tolerances_of(goal.request)
        self._follow(message_of(goal.request.trajectory))
        follower.has_goal = True

    def _tolerances_of(self, goal: Any) -> Tolerances:
        """Those of a goal; what it does not say, the parameters do."""
        default = self._tolerances
        path, aim = list(default.path), list(default.goal)
        try:
            seconds = effective(default.goal_seconds, seconds_of(goal.goal_time_tolerance))
            for kind, asked, changed in (
                ("path", goal.path_tolerance, path),
                ("goal", goal.goal_tolerance, aim),
            ):
                for one in asked:
                    if one.name not in self._joints:
                        self.error(
                            f"joint '{one.name}' specified in goal.{kind}_tolerance does not "
                            "exist. Using default tolerances."
                        )
                        return default
                    index = self._joints.index(one.name)
                    before = changed[index]
                    changed[index] = Tolerance(
                        effective(before.position, one.position),
                        effective(before.velocity, one.velocity),
                        effective(before.acceleration, one.acceleration),
                    )
        except ValueError as error:
            self.error(f"Specified illegal tolerance: {error}. Using default tolerances.")
            return default
        return Tolerances(path, aim, seconds)

    def _end(self, end: End, code: int, text: str) -> None:
        """End the goal, if there is one."""
        goal, self._goal = self._goal, None
        if self._follower is not None:
            self._follower.has_goal = False
            self._follower.tolerances = self._tolerances
        if goal is not None and self._server is not None:
            self._server.finish(goal, end, Result(error_code=code, error_string=text))

    def _publish_feedback(self, now: float, step: Step, actual: Point) -> None:
        feedback = FollowJointTrajectory.Feedback()
        feedback.header.stamp = self.ros.time(now)
        feedback.joint_names = list(self._joints)
        feedback.actual = point_message(actual)
        feedback.desired = point_message(step.desired)
        feedback.error = point_message(step.errors)
        if hasattr(feedback, "index"):  # newer than Humble's
            feedback.index = step.next
        self._goal.publish_feedback(feedback)

    def _state(self, now: float, step: Step, actual: Point) -> Any:
        message = JointTrajectoryControllerState()
        message.header.stamp = self.ros.time(now)
        message.joint_names = list(self._joints)
        message.reference = point_message(step.desired)
        message.feedback = point_message(actual)
        message.error = point_message(step.errors)
        commands = self.interfaces.commands
        output = Point()
        for kind, names in self._write.items():
            setattr(output, FIELD_OF[kind], [commands[name] for _, name in names])
        message.output = point_message(output)
        if hasattr(message, "speed_scaling_factor"):
            message.speed_scaling_factor = 1.0
        return message

    def _query(self) -> None:
        try:
            from control_msgs.srv import QueryTrajectoryState  # noqa: PLC0415  may be left out
        except ImportError:
            return
        self.service(QueryTrajectoryState, "~/query_state", self._answer_query)

    def _answer_query(self, request: Any, response: Any) -> Any:
        trajectory = self._follower.trajectory if self._follower is not None else None
        if not self.is_active or trajectory is None:
            self.error("Can't sample trajectory. Controller is not active.")
            return response
        response.name = list(self._joints)
        when = request.time.sec + request.time.nanosec * 1e-9
        if trajectory.is_begun:
            point, index = trajectory.sample(when)
            response.success = index < len(trajectory.points)
        else:
            point = self._actual()
        response.position = point.positions
        response.velocity = point.velocities
        response.acceleration = point.accelerations
        return response


def seconds_of(duration: Any) -> float:
    """A duration of ROS in seconds."""
    return float(duration.sec + duration.nanosec * 1e-9)


def message_of(message: Any) -> Message:
    """A `trajectory_msgs/JointTrajectory`, without ROS."""
    start = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    return Message(
        joints=tuple(message.joint_names),
        points=tuple(
            Point(
                list(point.positions),
                list(point.velocities),
                list(point.accelerations),
                list(point.effort),
                seconds_of(point.time_from_start),
            )
            for point in message.points
        ),
        start=start or None,
    )


def point_message(point: Point) -> Any:
    """A point as a message of ROS."""
    seconds = max(0.0, point.seconds)
    whole = int(seconds)
    return JointTrajectoryPoint(
        positions=point.positions,
        velocities=point.velocities,
        accelerations=point.accelerations,
        effort=point.effort,
        time_from_start=Duration(sec=whole, nanosec=int((seconds - whole) * 1e9)),
    )
