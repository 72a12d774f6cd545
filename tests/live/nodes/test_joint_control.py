"""Plugins that move single joints: a bar of 1 kg that turns about one of its ends, in PyBullet."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.fake_ros import live_scene, plugin, simulation_of
from live.nodes.gz_bridge import bridged
from simulation.robots import BAR_MOMENT, SPACE, pendulum
from wsgen.model.robot import JointLimit
from wsgen.simulation.bullet import BulletEngine

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from live.nodes.fake_ros import FakeRos

pytestmark = pytest.mark.usefixtures("messages")

BAR = "<joint_name>bar</joint_name>"
STRONG = JointLimit(lower=-3.0, upper=3.0, effort=1e4, velocity=100.0)
STEP = 0.001  # s


@contextmanager
def moving(filename: str, content: str, *rules: Any, **more: Any) -> Iterator[tuple[Any, FakeRos]]:
    """The bar with a plugin, where nothing pulls at it."""
    simulator = "classic" if filename.startswith("lib") else "gz"
    bar = pendulum(limit=STRONG, **more)
    scene = live_scene(plugin(filename, content), simulator=simulator, robot=bar, height=0.0)
    simulation, ros = simulation_of(scene, BulletEngine(SPACE))
    try:
        simulation.spawn("rover")
        bridged(ros, simulation, *rules)
        yield simulation, ros
    finally:
        simulation.close()


def position(simulation: Any) -> float:
    found: float = simulation.host.robots["rover"].joint_positions()["bar"]
    return found


def speed(simulation: Any) -> float:
    found: float = simulation.host.robots["rover"].joint_velocities()["bar"]
    return found


def pushed(effort: Callable[[float, float], float], *times: float) -> list[float]:
    """Where the bar is at some times, where such an effort acts in each step."""
    where = how_fast = 0.0
    found = []
    for count in range(1, round(max(times) / STEP) + 1):
        how_fast += effort(where, how_fast) / BAR_MOMENT * STEP
        where += how_fast * STEP
        if any(abs(count * STEP - time) < STEP / 2 for time in times):
            found.append(where)
    return found


def of_pid(
    target: float, p: float, i: float, d: float, most: float = 1000.0
) -> Callable[[float, float], float]:
    """The effort of `gz::math::PID` (gz-math, src/PID.cc), which the plugin bounds by 1000."""
    integral, last = 0.0, 0.0

    def effort(where: float, _: float) -> float:
        nonlocal integral, last
        error = where - target
        integral += i * STEP * error
        rate, last = (error - last) / STEP, error
        return min(most, max(-most, -p * error - integral - d * rate))

    return effort


POSITION = ("/go", "/model/rover/joint/bar/0/cmd_pos", "std_msgs/msg/Float64", "Double")
SPEED = ("/go", "/model/rover/joint/bar/cmd_vel", "std_msgs/msg/Float64", "Double")
TRAJECTORY = (
    "/go",
    "/model/rover/joint_trajectory",
    "trajectory_msgs/msg/JointTrajectory",
    "JointTrajectory",
)
PROGRESS = ("/progress", "/model/rover/joint_trajectory_progress", "std_msgs/msg/Float32", "Float")


def test_a_position_by_the_efforts_of_a_pid_controller() -> None:
    """As gz-sim, src/systems/joint_position_controller/JointPositionController.cc has it."""
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    gains = "<p_gain>8</p_gain><i_gain>3</i_gain><d_gain>1.5</d_gain><i_max>9</i_max>"
    content = f"{BAR}{gains}<i_min>-9</i_min>"
    with moving("gz-sim-joint-position-controller-system", content, POSITION) as (simulation, ros):
        ros.send("/go", Float64(data=0.8))
        times = (0.1, 0.3, 0.6, 1.0)
        found = []
        for time in times:
            simulation.advance(time)
            found.append(position(simulation))
        assert found == pytest.approx(pushed(of_pid(0.8, 8.0, 3.0, 1.5), *times), abs=3e-3)
        ros.send("/go", Float64(data=math.nan))
        assert "is nan, which no joint can have" in ros.warnings[-1]
        simulation.reset(with_time=True)
        assert position(simulation) == 0.0


def test_the_bounds_of_a_pid_controller() -> None:
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    content = f"{BAR}<p_gain>8</p_gain><i_gain>0</i_gain><d_gain>0</d_gain>"
    bounds = "<cmd_max>0.5</cmd_max><cmd_min>-0.5</cmd_min><initial_position>-1</initial_position>"
    name = "gz-sim-joint-position-controller-system"
    with moving(name, content + bounds, POSITION) as (simulation, ros):
        simulation.advance(0.2)
        assert position(simulation) == pytest.approx(-0.5 * 0.2**2 / BAR_MOMENT / 2, rel=0.02)
        ros.send("/go", Float64(data=1.0))
        before = speed(simulation)
        simulation.advance(0.3)
        assert speed(simulation) - before == pytest.approx(0.5 * 0.1 / BAR_MOMENT, rel=0.02)


def test_a_position_by_speeds() -> None:
    """Its error is gone in one step of Gazebo, if it is within `cmd_max`."""
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    content = f"{BAR}<use_velocity_commands>true</use_velocity_commands><cmd_max>2</cmd_max>"
    name = "gz-sim-joint-position-controller-system"
    with moving(name, f"{content}<topic>/mine</topic>") as (simulation, ros):
        bridged(ros, simulation, ("/mine", "/mine", "std_msgs/msg/Float64", "Double"))
        ros.send("/mine", Float64(data=0.5))
        simulation.advance(0.2)
        assert speed(simulation) == pytest.approx(2.0, rel=1e-3)
        simulation.advance(0.4)
        assert position(simulation) == pytest.approx(0.5, abs=1e-3)


def test_a_speed() -> None:
    """As gz-sim, src/systems/joint_controller/JointController.cc has it."""
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    content = f"{BAR}<initial_velocity>0.5</initial_velocity>"
    with moving("gz-sim-joint-controller-system", content, SPEED) as (simulation, ros):
        simulation.advance(0.1)
        assert speed(simulation) == pytest.approx(0.5, rel=1e-3)
        ros.send("/go", Float64(data=-1.5))
        simulation.advance(0.2)
        assert speed(simulation) == pytest.approx(-1.5, rel=1e-3)


def test_a_speed_by_efforts() -> None:
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    content = f"{BAR}<use_force_commands>true</use_force_commands><p_gain>2</p_gain>"
    with moving("gz-sim-joint-controller-system", content, SPEED) as (simulation, ros):
        ros.send("/go", Float64(data=1.0))
        simulation.advance(0.25)
        # A P controller of speed: what is off shrinks by 1/e in the moment divided by the gain.
        assert speed(simulation) == pytest.approx(1 - math.exp(-2.0 * 0.25 / BAR_MOMENT), rel=0.02)


def test_an_effort() -> None:
    """As gz-sim, src/systems/apply_joint_force/ApplyJointForce.cc has it."""
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    topic = "/model/rover/joint/bar/cmd_force"
    rule = ("/go", topic, "std_msgs/msg/Float64", "Double")
    with moving("gz-sim-apply-joint-force-system", BAR, rule) as (simulation, ros):
        ros.send("/go", Float64(data=0.5))
        simulation.advance(0.2)
        assert speed(simulation) == pytest.approx(0.5 * 0.2 / BAR_MOMENT, rel=0.01)
        ros.send("/go", Float64(data=0.0))
        simulation.advance(0.21)
        before = speed(simulation)
        simulation.advance(0.4)
        assert speed(simulation) == pytest.approx(before, rel=1e-3)
        simulation.reset(with_time=True)
        simulation.advance(0.1)
        assert speed(simulation) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("kind", ["position", "velocity"])
def test_actuator_messages(kind: str) -> None:
    """`OnActuatorPos` and `OnActuatorVel` of gz-sim."""
    from actuator_msgs.msg import Actuators  # noqa: PLC0415  a fake

    rule = ("/a", "/actuators", "actuator_msgs/msg/Actuators", "Actuators")
    name = f"gz-sim-joint-{'position-' if kind == 'position' else ''}controller-system"
    content = (
        f"{BAR}<use_actuator_msg>true</use_actuator_msg><actuator_number>2</actuator_number>"
        "<use_velocity_commands>true</use_velocity_commands>"
    )
    with moving(name, content, rule) as (simulation, ros):
        ros.send("/a", Actuators(**{kind: [9.0, 9.0, 0.4]}))
        simulation.advance(0.5)
        assert (position if kind == "position" else speed)(simulation) == pytest.approx(
            0.4, rel=0.01
        )
        ros.send("/a", Actuators(**{kind: [1.0]}))
        assert f"has 1 values of `{kind}`; the actuator 2 is not" in ros.warnings[-1]


def test_actuator_messages_without_a_number_are_none() -> None:
    from std_msgs.msg import Float64  # noqa: PLC0415  a fake

    content = f"{BAR}<use_actuator_msg>true</use_actuator_msg>"
    with moving("gz-sim-joint-controller-system", content, SPEED) as (simulation, ros):
        assert "<actuator_number>" in ros.warnings[0]
        ros.send("/go", Float64(data=0.7))
        simulation.advance(0.1)
        assert speed(simulation) == pytest.approx(0.7, rel=1e-3)


def trajectory(*points: tuple[float, float], frame: str = "world", joint: str = "bar") -> Any:
    """Positions (rad) at times (s)."""
    from builtin_interfaces.msg import Duration  # noqa: PLC0415  a fake
    from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint  # noqa: PLC0415

    made = JointTrajectory(joint_names=[joint])
    made.header.frame_id = frame
    for time, value in points:
        duration = Duration(sec=int(time), nanosec=round(time % 1 * 1e9))
        made.points.append(JointTrajectoryPoint(positions=[value], time_from_start=duration))
    return made


def test_a_trajectory_of_gazebo_sim() -> None:
    """As gz-sim, src/systems/joint_traj_control/JointTrajectoryController.cc has it.

    It aims at a point until its time has passed, then at the next one.
    """
    gains = "<position_p_gain>20</position_p_gain><position_d_gain>4</position_d_gain>"
    name = "gz-sim-joint-trajectory-controller-system"
    with moving(name, BAR + gains, TRAJECTORY, PROGRESS) as (simulation, ros):
        ros.send("/go", trajectory((0.3, 0.4), (0.6, -0.2)))
        simulation.advance(0.29)
        first = pushed(of_pid(0.4, 20.0, 0.0, 4.0, most=1e9), 0.29)
        assert position(simulation) == pytest.approx(first[0], abs=3e-3)
        assert [message.data for message in ros.published("/progress")] == [0.5]
        simulation.advance(1.6)
        assert position(simulation) == pytest.approx(-0.2, abs=0.01)
        assert [message.data for message in ros.published("/progress")] == [0.5, 1.0]
        ros.send("/go", trajectory((0.3, math.inf)))
        assert "values that are not numbers" in ros.warnings[-1]
        ros.send("/go", trajectory((0.3, 0.1), joint="leg"))  # which it does not control
        simulation.advance(1.7)
        assert position(simulation) == pytest.approx(-0.2, abs=0.01)


def test_a_trajectory_of_classic() -> None:
    """As gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_joint_pose_trajectory.cpp has it.

    The time of a point is how long after it the next one comes.
    """
    with moving("libgazebo_ros_joint_pose_trajectory.so", "") as (simulation, ros):
        simulation.advance(0.1)
        ros.send("/set_joint_trajectory", trajectory((0.2, 0.4), (0.3, -0.2), (0.1, 0.9)))
        found = []
        for time in (0.12, 0.29, 0.32, 0.59, 0.62, 1.0):
            simulation.advance(time)
            found.append(position(simulation))
        assert found == pytest.approx([0.4, 0.4, -0.2, -0.2, 0.9, 0.9], abs=1e-6)
        (node,) = [one for one in ros.nodes if one.name == "p"]
        assert speed(simulation) == pytest.approx(0.0, abs=1e-6)
        errors: list[str] = []
        node.get_logger = lambda: type("Log", (), {"error": staticmethod(errors.append)})  # type: ignore[attr-defined]
        for wrong, problem in (
            (trajectory((0.1, 1.0), frame="tower"), "needs a reference link [tower]"),
            (trajectory((0.1, 1.0), joint="leg"), "Joint [leg] not found"),
            (trajectory((0.1, math.nan)), "a position that is not a number"),
        ):
            ros.send("/set_joint_trajectory", wrong)
            assert problem in errors[-1]
        simulation.advance(1.2)
        assert position(simulation) == pytest.approx(0.9, abs=1e-6)


@pytest.mark.parametrize("name", ["joint-position-controller", "joint-controller"])
def test_plugins_that_name_no_joint(name: str) -> None:
    with moving(f"gz-sim-{name}-system", "<joint_name>leg</joint_name>") as (_, ros):
        assert "names the joint `leg`" in ros.warnings[0]
        assert "it does not name a joint of the robot" in ros.warnings[1]
