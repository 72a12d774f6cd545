"""Steering, tricycle and mecanum controllers, of a car on the ground in PyBullet."""

from __future__ import annotations

import importlib
import math
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.cars import BASE, CAR, RADIUS, TRACK
from live.nodes.ros2_control.controlled import controlled
from live.nodes.sensor_messages import install_sensor_messages
from simulation.robots import body, joint, tree
from wsgen.model.robot import Box, Cylinder, JointType, Sphere
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from live.nodes.ros2_control.controlled import Controlled

ACKERMANN = "ackermann_steering_controller/AckermannSteeringController"
TRICYCLE = "tricycle_controller/TricycleController"
DIFF_DRIVE = "diff_drive_controller/DiffDriveController"
MECANUM = "mecanum_drive_controller/MecanumDriveController"
OF_CAR = {
    "rear_left": ["velocity"],
    "rear_right": ["velocity"],
    "left_steer": ["position"],
    "right_steer": ["position"],
}
MEASURES: dict[str, Any] = {
    "traction_joints_names": ["rear_right", "rear_left"],
    "steering_joints_names": ["right_steer", "left_steer"],
    "wheelbase": BASE,
    "traction_track_width": TRACK,
    "traction_wheels_radius": RADIUS,
}
OF_DIFF_DRIVE: dict[str, Any] = {
    "left_wheel_names": ["rear_left"],
    "right_wheel_names": ["rear_right"],
    "wheel_separation": TRACK,
    "wheel_radius": RADIUS,
}
FORMER: dict[str, Any] = {
    "rear_wheels_names": ["rear_right", "rear_left"],
    "front_wheels_names": ["right_steer", "left_steer"],
    "wheelbase": BASE,
    "front_wheel_track": TRACK,
    "rear_wheel_track": TRACK,
    "front_wheels_radius": 9.0,
    "rear_wheels_radius": RADIUS,
    "use_stamped_vel": False,
}


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)  # count subscriptions whenever they are asked


def twist(made: Controlled, x: float = 0.0, y: float = 0.0, turn: float = 0.0) -> Any:
    """A stamped command."""
    from geometry_msgs.msg import TwistStamped  # noqa: PLC0415  a fake

    message = TwistStamped()
    message.header.stamp = made.stamp()
    message.twist.linear.x, message.twist.linear.y, message.twist.angular.z = x, y, turn
    return message


def heading(made: Controlled) -> float:
    from wsgen.live.nodes.simulator.messages import yaw_of  # noqa: PLC0415  with fakes

    return yaw_of(made.robot.state().xyzw)


@pytest.mark.slow
@pytest.mark.parametrize("is_former", [False, True])
def test_a_car_drives_a_curve(is_former: bool) -> None:
    """As steering_controllers_library/src/steering_kinematics.cpp has it, 0.5 m/s on 2 m."""
    parameters = FORMER if is_former else MEASURES
    with controlled(CAR, ACKERMANN, parameters, OF_CAR, is_former=is_former) as made:
        send = twist(made, 0.5, turn=0.25)
        if is_former:
            made.ros.send("/~/reference_unstamped", send.twist)
        else:
            made.ros.send("/~/reference", send)
        made.run(0.95)
        angle = math.atan(0.25 * BASE / 0.5)
        left, right = (made.robot.joint_positions()[f"{side}_steer"] for side in ("left", "right"))
        for found, sign in ((left, -1), (right, 1)):
            wanted = math.atan2(
                2 * BASE * math.sin(angle),
                2 * BASE * math.cos(angle) + sign * TRACK * math.sin(angle),
            )
            assert found == pytest.approx(wanted, abs=2e-3)
        speeds = made.robot.joint_velocities()
        assert speeds["rear_right"] == pytest.approx(5.0 * (2 + TRACK / 2) / 2, rel=0.01)
        assert speeds["rear_left"] == pytest.approx(5.0 * (2 - TRACK / 2) / 2, rel=0.01)
        odometry = made.published("~/odometry")[-1]
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
        assert odometry.twist.twist.linear.x == pytest.approx(0.5, rel=0.02)
        assert odometry.twist.twist.angular.z == pytest.approx(0.25, rel=0.02)
        turn = odometry.pose.pose.orientation
        assert 2 * math.atan2(turn.z, turn.w) == pytest.approx(heading(made), abs=0.02)
        assert [odometry.pose.covariance[7 * one] for one in range(6)] == [0, 7, 14, 21, 28, 35]
        (transform,) = made.published("~/tf_odometry")[-1].transforms
        assert transform.transform.translation.x == pytest.approx(odometry.pose.pose.position.x)
        status = made.published("~/controller_state")[-1]
        assert status.traction_command == pytest.approx([5.5, 4.5], abs=1e-3)
        assert status.steer_positions == pytest.approx([right, left], abs=1e-3)
        made.run(0.5)  # the command is older than a second now
        assert abs(made.robot.joint_velocities()["rear_left"]) < 0.1
        assert made.robot.joint_positions()["left_steer"] == pytest.approx(left, abs=0.02)


def test_commands_for_the_steering_and_back() -> None:
    from wsgen.live.nodes.simulator.ros2_control.wheels import SteeringBase  # noqa: PLC0415

    base = SteeringBase(
        wheelbase=2.0, radius=0.5, traction_track=1.0, steering_track=1.2, driven=2, steered=2
    )
    speeds, angles = base.commands(1.0, 0.2, steered=None, waits=False)
    assert speeds == pytest.approx([2.0 * 5.5 / 5, 2.0 * 4.5 / 5])  # a curve of 5 m
    assert angles == pytest.approx([math.atan(2 / 5.6), math.atan(2 / 4.4)])
    middle = base.steered_by(angles)
    assert middle == pytest.approx(math.atan(0.4))
    assert base.motion(speeds, middle) == pytest.approx((1.0, 0.2))
    speeds, angles = base.commands(0.0, 1.0, steered=0.0, waits=False)
    assert speeds == [0.0, 0.0]
    assert angles == pytest.approx([math.pi / 2] * 2)
    slow, _ = base.commands(1.0, 1.0, steered=0.0, waits=True)
    assert slow == pytest.approx([2.0 * math.cos(math.atan(2.0)) / math.cos(math.pi / 6)] * 2)
    bicycle = SteeringBase(wheelbase=2.0, radius=0.5)
    assert bicycle.commands(1.0, 0.2, steered=0.1, waits=True) == ([2.0], [math.atan(0.4)])


@pytest.mark.slow
def test_old_commands_and_wrong_parameters_are_refused() -> None:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import (  # noqa: PLC0415
        ControllerError,
    )

    with controlled(CAR, ACKERMANN, MEASURES, OF_CAR) as made:
        made.run(1.2)
        old = twist(made, 0.5)
        old.header.stamp = made.ros.time(0.1)
        made.ros.send("/~/reference", old)
        assert "more then allowed timeout (1.0000)" in made.node.said[-1]
        made.run(0.05)
        assert abs(made.robot.joint_velocities()["rear_left"]) < 0.01
    for change, problem in (
        ({"traction_joints_names": ["rear_left"]}, "requires exactly 2 traction joints, but 1"),
        ({"steering_joints_names": []}, "exactly 2 steering joints, but 0 were provided"),
        ({"wheelbase": 0.0}, "of the parameter 'wheelbase'"),
        ({"traction_wheels_radius": -1.0}, "of the parameter 'traction_wheels_radius'"),
    ):
        with (
            pytest.raises(ControllerError, match=problem),
            controlled(CAR, ACKERMANN, {**MEASURES, **change}, OF_CAR),
        ):
            pass


@pytest.mark.slow
def test_a_mecanum_controller_turns_its_wheels() -> None:
    """As mecanum_drive_controller has it, with the base beside the middle of the wheels."""
    wheels = ("front_left", "front_right", "rear_right", "rear_left")
    offset = {f"kinematics.base_frame_offset.{one}": 0.1 for one in ("x", "y")}
    parameters = {
        **{f"{wheel}_wheel_command_joint_name": wheel for wheel in wheels},
        **offset,
        "kinematics.base_frame_offset.theta": 0.2,
        "kinematics.wheels_radius": RADIUS,
        "kinematics.sum_of_robot_center_projection_on_X_Y_axis": 0.45,
        "reference_timeout": 0.5,
        "tf_frame_prefix": "bot",
        "linear.x.max_velocity": 0.25,
    }
    with controlled(CAR, MECANUM, parameters, {wheel: ["velocity"] for wheel in wheels}) as made:
        made.ros.send("/~/reference", twist(made, 0.9, 0.1, turn=0.3))  # 0.25 m/s at most
        made.run(0.45)
        forward = 0.25 * math.cos(0.2) - 0.1 * math.sin(0.2) + 0.1 * 0.3
        aside = 0.25 * math.sin(0.2) + 0.1 * math.cos(0.2) - 0.1 * 0.3
        around = 0.45 * 0.3
        found = made.robot.joint_velocities()
        for name, rim in zip(
            wheels,
            (
                forward - aside - around,
                forward + aside + around,
                forward - aside + around,
                forward + aside - around,
            ),
            strict=True,
        ):
            assert found[name] == pytest.approx(rim / RADIUS, abs=0.02), name
        odometry = made.published("~/odometry")[-1]
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("bot/odom", "bot/base_link")
        speed = odometry.twist.twist
        assert (speed.linear.x, speed.linear.y, speed.angular.z) == pytest.approx(
            (0.25, 0.1, 0.3), abs=5e-3
        )
        assert odometry.pose.covariance[35] == 0.1
        state = made.published("~/controller_state")[-1]
        assert state.back_left_wheel_velocity == pytest.approx(found["rear_left"], abs=0.02)
        assert state.reference_velocity.linear.x == 0.9
        made.run(0.5)
        assert abs(made.robot.joint_velocities()["rear_left"]) < 0.05


@pytest.mark.slow
def test_a_mecanum_controller_begins_from_a_standstill_after_a_timeout() -> None:
    wheels = ("front_left", "front_right", "rear_right", "rear_left")
    parameters = {
        **{f"{wheel}_wheel_command_joint_name": wheel for wheel in wheels},
        "kinematics.wheels_radius": RADIUS,
        "kinematics.sum_of_robot_center_projection_on_X_Y_axis": 0.45,
        "reference_timeout": 0.3,
        "linear.x.max_acceleration": 2.0,
    }
    with controlled(CAR, MECANUM, parameters, {wheel: ["velocity"] for wheel in wheels}) as made:
        commands = made.controller.interfaces.commands
        made.ros.send("/~/reference", twist(made, 0.4))
        made.run(0.25)
        assert commands["rear_left/velocity"] == pytest.approx(0.4 / RADIUS)
        made.run(0.1)
        assert commands["rear_left/velocity"] == 0.0
        made.ros.send("/~/reference", twist(made, 0.4))
        made.run(0.01)
        assert commands["rear_left/velocity"] == pytest.approx(2.0 * 0.01 / RADIUS)


FORK = Pose((0.5, 0.0, 0.0))
# Its front wheel is steered and driven; behind it two balls slide.
TRIKE = tree(
    body(Box(size=(0.5, 0.3, 0.05)), mass=5.0),
    (
        joint("base", "fork", JointType.CONTINUOUS, FORK, axis_in_joint=(0.0, 0.0, 1.0)),
        body(None, name="fork", mass=0.5, moment=0.003),
    ),
    (
        joint("fork", "wheel", JointType.CONTINUOUS, axis_in_joint=(0.0, 1.0, 0.0)),
        body(
            Cylinder(radius=0.1, length=0.04),
            name="wheel",
            at=Pose(rpy=(math.pi / 2, 0.0, 0.0)),
        ),
    ),
    *(
        (
            joint(
                "base",
                f"{side}_rear",
                JointType.CONTINUOUS,
                Pose((0.0, y, 0.0)),
                axis_in_joint=(0.0, 1.0, 0.0),
            ),
            body(Sphere(radius=0.1), name=f"{side}_rear"),
        )
        for side, y in (("left", 0.2), ("right", -0.2))
    ),
)
OF_TRIKE = {"wheel": ["velocity"], "fork": ["position"]}
TRIKE_MEASURES: dict[str, Any] = {
    "traction_joint_name": "wheel",
    "steering_joint_name": "fork",
    "wheelbase": 0.5,
    "wheel_radius": 0.1,
    "enable_odom_tf": True,
    "publish_ackermann_command": True,
}


@pytest.mark.slow
def test_a_tricycle_drives_a_curve() -> None:
    """As tricycle_controller/src/tricycle_controller.cpp has it."""
    with controlled(TRIKE, TRICYCLE, TRIKE_MEASURES, OF_TRIKE) as made:
        for _ in range(4):
            made.ros.send("/~/cmd_vel", twist(made, 0.4, turn=0.4))
            made.run(0.4)
        angle = math.atan(0.5)
        assert made.robot.joint_positions()["fork"] == pytest.approx(angle, abs=5e-3)
        speed = 0.4 / (0.1 * math.cos(angle))
        assert made.robot.joint_velocities()["wheel"] == pytest.approx(speed, rel=0.02)
        odometry = made.published("~/odom")[-1]
        assert odometry.twist.twist.linear.x == pytest.approx(0.4, rel=0.02)
        assert odometry.twist.twist.angular.z == pytest.approx(0.4, rel=0.02)
        turn = odometry.pose.pose.orientation
        assert 2 * math.atan2(turn.z, turn.w) == pytest.approx(heading(made), rel=0.05)
        assert made.ros.published("/tf")[-1].transforms[0].child_frame_id == "base_link"
        sent = made.published("~/cmd_ackermann")[-1]
        assert (sent.speed, sent.steering_angle) == pytest.approx((speed, angle))
        made.ros.services["/~/reset_odometry"](None, None)
        made.run(0.7)  # commands are forgotten after half a second
        assert abs(made.robot.joint_velocities()["wheel"]) < 0.1
        assert made.published("~/odom")[-1].pose.pose.position.x < 0.3


def test_odometry_without_poses_has_transforms_all_the_same() -> None:
    parameters = {**TRIKE_MEASURES, "odom_only_twist": True}
    with controlled(TRIKE, TRICYCLE, parameters, OF_TRIKE) as made:
        made.ros.send("/~/cmd_vel", twist(made, 0.4))
        made.run(0.4)
        odometry = made.published("~/odom")[-1]
        assert odometry.twist.twist.linear.x > 0.3
        assert odometry.pose.pose.position.x == 0.0
        (transform,) = made.ros.published("/tf")[-1].transforms
        assert transform.transform.translation.x > 0.1


def test_a_tricycle_ignores_commands_that_are_no_numbers() -> None:
    with controlled(TRIKE, TRICYCLE, TRIKE_MEASURES, OF_TRIKE) as made:
        made.ros.send("/~/cmd_vel", twist(made, math.nan))
        assert "speeds that are not numbers" in made.node.said[-1]
        unstamped = twist(made, 0.4)
        unstamped.header.stamp = made.ros.time(0.0)
        made.ros.send("/~/cmd_vel", unstamped)
        made.controller.is_active = False
        made.ros.send("/~/cmd_vel", twist(made, 0.9))
        assert "subscriber is inactive" in made.node.said[-1]
        made.run(0.1)
        assert made.controller.interfaces.commands["wheel/velocity"] == pytest.approx(4.0)


@pytest.mark.slow
def test_limits_of_a_tricycle() -> None:
    limits = {
        "traction.max_velocity": 3.0,
        "traction.max_acceleration": 2.0,
        "traction.max_deceleration": 8.0,
        "steering.max_position": 0.3,
        "steering.max_velocity": 1.0,
    }
    with controlled(TRIKE, TRICYCLE, {**TRIKE_MEASURES, **limits}, OF_TRIKE) as made:
        commands = made.controller.interfaces.commands
        made.ros.send("/~/cmd_vel", twist(made, 1.0, turn=2.0))
        made.run(0.1)
        assert commands["wheel/velocity"] == pytest.approx(0.2)
        assert commands["fork/position"] == pytest.approx(0.1)
        for _ in range(5):
            made.ros.send("/~/cmd_vel", twist(made, 1.0, turn=2.0))
            made.run(0.4)
        assert commands["wheel/velocity"] == pytest.approx(3.0)
        assert commands["fork/position"] == pytest.approx(0.3)
        made.ros.send("/~/cmd_vel", twist(made, 0.0))
        made.run(0.1)
        assert commands["wheel/velocity"] == pytest.approx(3.0 - 0.8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "parameters", "problem"),
    [
        (DIFF_DRIVE, {"wheel_radius": 0.0}, "'0.000000' of the parameter 'wheel_radius'"),
        (DIFF_DRIVE, {"right_wheel_radius_multiplier": 0.0}, "'right_wheel_radius_multiplier': "),
        (TRICYCLE, {}, "'traction_joint_name' parameter was empty"),
        (MECANUM, {}, "'front_left_wheel_command_joint_name' parameter was empty"),
        (ACKERMANN, {**MEASURES, "wheelbase": -0.1}, "'-0.100000' of the parameter 'wheelbase'"),
    ],
)
def test_measures_that_no_robot_has_are_refused(
    kind: str, parameters: dict[str, Any], problem: str
) -> None:
    """Instead of a division by 0 when the wheels turn."""
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import (  # noqa: PLC0415
        ControllerError,
    )

    given = {**OF_DIFF_DRIVE, **parameters} if kind == DIFF_DRIVE else parameters
    with (
        pytest.raises(ControllerError, match=problem),
        controlled(CAR, kind, given, OF_CAR),
    ):
        pass
