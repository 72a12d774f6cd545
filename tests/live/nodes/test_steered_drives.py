"""Ackermann and mecanum drives, of a car on the ground."""

from __future__ import annotations

import math
from contextlib import contextmanager
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.cars import BASE, CAR, RADIUS, TRACK
from live.nodes.fake_ros import live_scene, plugin, simulation_of
from live.nodes.gz_bridge import bridged
from simulation.robots import GROUND
from wsgen.simulation.bullet import BulletEngine

if TYPE_CHECKING:
    from collections.abc import Iterator

    from live.nodes.fake_ros import FakeRos
    from wsgen.live.nodes.simulator.plugins.ackermann import Car

pytestmark = pytest.mark.usefixtures("messages")

STEERED = (
    "<left_steering_joint>left_steer</left_steering_joint>"
    "<right_steering_joint>right_steer</right_steering_joint>"
)
MEASURES = (
    f"<wheel_base>{BASE}</wheel_base><wheel_separation>{TRACK}</wheel_separation>"
    f"<kingpin_width>{TRACK}</kingpin_width><wheel_radius>{RADIUS}</wheel_radius>"
    "<steering_limit>0.6</steering_limit><steer_p_gain>10</steer_p_gain>"
)
GZ = f"<left_joint>rear_left</left_joint><right_joint>rear_right</right_joint>{STEERED}{MEASURES}"
CLASSIC = (
    "<front_right_joint>front_right</front_right_joint>"
    "<front_left_joint>front_left</front_left_joint>"
    "<rear_right_joint>rear_right</rear_right_joint>"
    f"<rear_left_joint>rear_left</rear_left_joint>{STEERED}"
    "<left_steering_pid_gain>30 0 1</left_steering_pid_gain>"
    "<right_steering_pid_gain>30 0 1</right_steering_pid_gain>"
    "<linear_velocity_pid_gain>10 0 0</linear_velocity_pid_gain>"
)


@contextmanager
def driving(filename: str, content: str, *rules: Any) -> Iterator[tuple[Any, FakeRos]]:
    """A car with a plugin, a tenth of a second after it was put on the ground."""
    simulator = "classic" if filename.startswith("lib") else "gz"
    scene = live_scene(plugin(filename, content), simulator=simulator, robot=CAR, height=RADIUS)
    simulation, ros = simulation_of(scene, BulletEngine(GROUND))
    try:
        simulation.spawn("rover")
        bridged(ros, simulation, *rules)
        simulation.advance(0.1)
        yield simulation, ros
    finally:
        simulation.close()


TWIST = ("/cmd_vel", "/model/rover/cmd_vel", "geometry_msgs/msg/Twist", "Twist")
ODOMETRY = ("/odom", "/model/rover/odometry", "nav_msgs/msg/Odometry", "Odometry")
TF = ("/tf", "/model/rover/tf", "tf2_msgs/msg/TFMessage", "Pose_V")


def twist(x: float = 0.0, y: float = 0.0, turn: float = 0.0) -> Any:
    from geometry_msgs.msg import Twist  # noqa: PLC0415

    made = Twist()
    made.linear.x, made.linear.y, made.angular.z = x, y, turn
    return made


def positions(simulation: Any) -> Any:
    return simulation.host.robots["rover"].joint_positions()


def heading(simulation: Any) -> float:
    from wsgen.live.nodes.simulator.messages import yaw_of  # noqa: PLC0415  with fakes

    return yaw_of(simulation.host.robots["rover"].state().xyzw)


@pytest.mark.slow
def test_a_car_of_gazebo_sim_drives_a_curve() -> None:
    """By the formulas of gz-sim, src/systems/ackermann_steering/AckermannSteering.cc."""
    with driving("gz-sim-ackermann-steering-system", GZ, TWIST, ODOMETRY, TF) as (simulation, ros):
        ros.send("/cmd_vel", twist(0.5, turn=0.25))
        simulation.advance(1.1)  # the wheels are steered by then
        left, right = (positions(simulation)[f"{side}_steer"] for side in ("left", "right"))
        radius = 2.0
        assert left == pytest.approx(math.atan(BASE / (radius - TRACK / 2)), abs=2e-3)
        assert right == pytest.approx(math.atan(BASE / (radius + TRACK / 2)), abs=2e-3)
        begin, before = heading(simulation), ros.published("/odom")[-1]
        simulation.advance(2.1)
        turned = heading(simulation) - begin
        assert turned == pytest.approx(0.25, rel=0.05)
        message = ros.published("/odom")[-1]
        assert (message.header.frame_id, message.child_frame_id) == ("rover/odom", "rover/base")
        assert message.twist.twist.linear.x == pytest.approx(0.5, rel=0.02)
        assert message.twist.twist.angular.z == pytest.approx(0.25, rel=0.02)
        here, there = before.pose.pose.position, message.pose.pose.position
        # Odometry is that of the rear axle, the state that of the middle of the car.
        assert math.dist((here.x, here.y), (there.x, there.y)) == pytest.approx(
            2 * radius * math.sin(turned / 2), rel=0.05
        )
        (transform,) = ros.published("/tf")[-1].transforms
        assert transform.transform.translation.x == pytest.approx(there.x)
        assert len(ros.published("/odom")) == 50 * 2.1


def simple_car() -> Car:
    from wsgen.live.nodes.simulator.plugins.ackermann import Car  # noqa: PLC0415

    return Car(wheel_base=1.0, separation=1.0, kingpins=0.8, radius=0.2, limit=0.5)


@pytest.mark.parametrize(
    ("linear", "angular", "radius"),
    [
        (1.0, 0.0, 1e9),
        (1.0, 5.0, 1.0 / math.sin(0.5)),  # the steering's limit
        (-1.0, 0.2, -5.0),
        (0.0, -0.5, -1.0 / math.sin(0.5)),
        (0.0, 0.0, 1e9),
    ],
)
def test_steering_of_gazebo_sim(linear: float, angular: float, radius: float) -> None:
    found = simple_car().steering(linear, angular)
    assert found.left == pytest.approx(math.atan(1.0 / (radius - 0.4)))
    assert found.right == pytest.approx(math.atan(1.0 / (radius + 0.4)))
    middle = math.atan(1.0 / radius)
    assert found.right_speed == pytest.approx(linear * (1 + math.tan(middle) / 2) / 0.2)
    assert found.left_speed == pytest.approx(linear * (1 - math.tan(middle) / 2) / 0.2)


def test_a_wheel_that_is_in_the_middle_of_the_turn_is_steered_by_a_quarter() -> None:
    nearest = 1.0 / math.sin(0.5)
    car = simple_car()._replace(kingpins=2 * nearest)
    assert car.steering(0.0, 1.0).left == pytest.approx(math.pi / 2)
    assert car.steering(0.0, -1.0).right == pytest.approx(math.pi / 2)
    wide = car._replace(separation=2.0 / math.tan(0.5))
    assert wide.steered(0.5)[0] == pytest.approx(math.pi / 2)


def test_the_odometry_of_gazebo_sim_counts_in_steps() -> None:
    """One update of 10 ms is ten of 1 ms, in which it turns before it goes on."""
    from wsgen.live.nodes.simulator.plugins.ackermann import CarOdometry  # noqa: PLC0415

    once, often = (CarOdometry(0.5, 0.1, 0.001) for _ in range(2))
    for odometry in (once, often):
        odometry.update(0.0, 0.4, 0.0)
    once.update(1.0, 0.4, 0.01)
    for count in range(1, 11):
        often.update(count / 10, 0.4, count / 1000)
    assert (once.x, once.y, once.heading) == pytest.approx((often.x, often.y, often.heading))
    assert once.linear == pytest.approx(10.0)
    x = y = yaw = 0.0
    for _ in range(10):
        yaw += 0.01 * math.tan(0.4) / 0.5
        x += 0.01 * math.cos(yaw)
        y += 0.01 * math.sin(yaw)
    assert (once.x, once.y, once.heading) == pytest.approx((x, y, yaw))


@pytest.mark.slow
@pytest.mark.parametrize("by_actuator", [False, True])
def test_a_car_that_is_steered_alone(by_actuator: bool) -> None:
    from actuator_msgs.msg import Actuators  # noqa: PLC0415  a fake
    from std_msgs.msg import Float64  # noqa: PLC0415  likewise

    rules = (
        ("/steer", "/model/rover/steer_angle", "std_msgs/msg/Float64", "Double"),
        ("/a", "/actuators", "actuator_msgs/msg/Actuators", "Actuators"),
    )
    how = (
        "<use_actuator_msg>true</use_actuator_msg><actuator_number>1</actuator_number>"
        if by_actuator
        else "<steering_only>true</steering_only>"
    )
    filename = "gz-sim-ackermann-steering-system"
    with driving(filename, f"{how}{STEERED}{MEASURES}", *rules) as (simulation, ros):
        if by_actuator:
            ros.send("/a", Actuators(position=[9.0]))
            assert "the actuator 1 is not one of them" in ros.warnings[-1]
            ros.send("/a", Actuators(position=[9.0, 0.3]))
        else:
            ros.send("/steer", Float64(data=math.nan))
            ros.send("/steer", Float64(data=0.3))
        simulation.advance(1.0)
        way, ahead, side = (
            2 * BASE * math.sin(0.3),
            2 * BASE * math.cos(0.3),
            TRACK * math.sin(0.3),
        )
        found = positions(simulation)
        assert found["left_steer"] == pytest.approx(math.atan(way / (ahead - side)), abs=2e-3)
        assert found["right_steer"] == pytest.approx(math.atan(way / (ahead + side)), abs=2e-3)


@pytest.mark.slow
def test_a_car_of_classic_drives_a_curve() -> None:
    """By gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_ackermann_drive.cpp.

    What it takes for the angular velocity is the angle of the steering.
    """
    content = (
        f"{CLASSIC}<publish_odom>true</publish_odom><publish_odom_tf>true</publish_odom_tf>"
        "<publish_distance>true</publish_distance><publish_wheel_tf>true</publish_wheel_tf>"
    )
    with driving("libgazebo_ros_ackermann_drive.so", content) as (simulation, ros):
        ros.send("/cmd_vel", twist(0.5, turn=0.3))
        simulation.advance(1.0)
        tangent = math.tan(0.3)
        share = TRACK / 2 / BASE * tangent
        found = positions(simulation)
        assert found["left_steer"] == pytest.approx(math.atan2(tangent, 1 - share), abs=0.02)
        assert found["right_steer"] == pytest.approx(math.atan2(tangent, 1 + share), abs=0.02)
        begin = heading(simulation)
        simulation.advance(2.0)
        speed = ros.published("/odom")[-1].twist.twist
        assert speed.linear.x == pytest.approx(0.5, rel=0.15)  # a P controller
        assert heading(simulation) - begin == pytest.approx(
            speed.linear.x * tangent / BASE, rel=0.1
        )
        message = ros.published("/odom")[-1]
        assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_footprint")
        assert [message.pose.covariance[place] for place in range(0, 36, 7)] == [
            *(1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)
        ]
        ways = ros.published("/odom")
        distance = sum(
            math.dist(
                (one.pose.pose.position.x, one.pose.pose.position.y),
                (two.pose.pose.position.x, two.pose.pose.position.y),
            )
            for one, two in pairwise(ways)
        )
        assert ros.published("/distance")[-1].data == pytest.approx(distance, abs=1e-3)
        transforms = ros.published("/tf")
        assert {one.child_frame_id for one in transforms[-2].transforms} == {
            *("front_left", "front_right", "rear_left", "rear_right", "left_steer", "right_steer")
        }
        (x, y, _) = simulation.host.robots["rover"].state().xyz
        simulation.reset(with_time=True)
        simulation.advance(0.05)
        # The plugin begins at 0, and counts the way back of the reset.
        assert ros.published("/distance")[-1].data == pytest.approx(math.hypot(x, y), abs=0.01)


def test_a_push_of_classic_lasts_one_step() -> None:
    with driving("libgazebo_ros_ackermann_drive.so", CLASSIC) as (simulation, ros):
        ros.send("/cmd_vel", twist(0.5))
        efforts = []
        for count in range(1, 31):
            simulation.advance(0.1 + count / 1000)
            efforts.append(simulation.engine.joint_efforts("rover")["rear_left"])
        assert sum(abs(effort) > 1e-6 for effort in efforts) == 3
        assert max(efforts) == pytest.approx(50.0, rel=0.1)  # 10 times 5 rad/s


@pytest.mark.parametrize(
    ("filename", "content", "problem"),
    [
        ("libgazebo_ros_ackermann_drive.so", "", "no joint `front_right_joint`"),
        (
            "libgazebo_ros_ackermann_drive.so",
            CLASSIC.replace(">rear_right<", ">left_steer<"),
            "has no <collision>",
        ),
        (
            "gz-sim-ackermann-steering-system",
            STEERED,
            "not have its <left_joint> and <right_joint>",
        ),
        (
            "gz-sim-ackermann-steering-system",
            GZ.replace("0.6<", "x<"),
            "its <steering_limit> is `x`",
        ),
        (
            "gz-sim-ackermann-steering-system",
            GZ.replace("0.6</steering_limit>", "0</steering_limit>"),
            "its <steering_limit> is 0",
        ),
        (
            "gz-sim-ackermann-steering-system",
            f"<use_actuator_msg>1</use_actuator_msg><actuator_number>-1</actuator_number>{GZ}",
            "its <actuator_number> is -1",
        ),
        ("gz-sim-mecanum-drive-system", "", "its <front_left_joint> and "),
        *(
            (
                "libgazebo_ros_ackermann_drive.so",
                f"{CLASSIC}<{name}>{value}</{name}>",
                f"its <{name}> is {value}. Write an angle in radians, above 0",
            )
            for name, value in (("max_steering_angle", 0), ("max_steer", 0), ("max_steer", -0.1))
        ),
    ],
)
def test_cars_that_cannot_drive(filename: str, content: str, problem: str) -> None:
    with driving(filename, content) as (_, ros):
        assert problem in ros.warnings[0]


MECANUM = "".join(
    f"<{tag}_joint>{name}</{tag}_joint>"
    for tag, name in (
        *(("front_left", "front_left"), ("front_right", "front_right")),
        *(("back_left", "rear_left"), ("back_right", "rear_right")),
    )
)


def test_a_mecanum_drive_without_a_wheelbase_does_not_work() -> None:
    content = f"{MECANUM}<wheelbase>-0.4</wheelbase><wheel_separation>0.4</wheel_separation>"
    with driving("gz-sim-mecanum-drive-system", content) as (_, ros):
        assert "its <wheelbase> is -0.4. Write a length in meters" in ros.warnings[0]


@pytest.mark.slow
def test_a_mecanum_drive_turns_its_wheels() -> None:
    """By gz-sim, src/systems/mecanum_drive/MecanumDrive.cc, and its odometry by gz-math."""
    content = (
        f"{MECANUM}<wheelbase>{BASE}</wheelbase><wheel_separation>{TRACK}</wheel_separation>"
        f"<wheel_radius>{RADIUS}</wheel_radius><max_acceleration>100</max_acceleration>"
    )
    with driving("gz-sim-mecanum-drive-system", content, TWIST, ODOMETRY) as (simulation, ros):
        ros.send("/cmd_vel", twist(0.2, 0.1, turn=0.3))
        simulation.advance(1.1)
        speeds = simulation.host.robots["rover"].joint_velocities()
        around = 0.3 * (BASE + TRACK) / 2
        for name, rim in (
            ("front_left", 0.2 - 0.1 - around),
            ("front_right", 0.2 + 0.1 + around),
            ("rear_left", 0.2 + 0.1 - around),
            ("rear_right", 0.2 - 0.1 + around),
        ):
            assert speeds[name] == pytest.approx(rim / RADIUS, abs=0.02), name
        message = ros.published("/odom")[-1]
        speed = message.twist.twist
        found = (speed.linear.x, speed.linear.y, speed.angular.z)
        assert found == pytest.approx((0.2, 0.1, 0.3), abs=5e-3)
        # An arc from the origin: speeds of the body, turning about its center.
        (x, y), yaw = ((message.pose.pose.position.x, message.pose.pose.position.y), 0.3)
        assert x == pytest.approx((0.2 * math.sin(yaw) - 0.1 * (1 - math.cos(yaw))) / 0.3, abs=0.01)
        assert y == pytest.approx((0.2 * (1 - math.cos(yaw)) + 0.1 * math.sin(yaw)) / 0.3, abs=0.01)
        simulation.reset(with_time=True)
        simulation.advance(0.05)
        assert ros.published("/odom")[-1].pose.pose.position.x == pytest.approx(0.0, abs=1e-4)
