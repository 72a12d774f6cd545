"""Force-torque sensors: a load of 2 kg on an arm, whose center is 0.3 m along the arm."""

from __future__ import annotations

import importlib
import math
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.fake_ros import plugin, simulation_of
from live.nodes.gz_bridge import bridged
from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.sensor_texts import element
from simulation.robots import VOID, G, body, joint, tree
from wsgen.model.devices import Devices, MountedSensor
from wsgen.model.robot import Box, JointType, Link
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.bullet import BulletEngine
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from live.nodes.fake_ros import FakeRos

# The arm points down by 30 degrees: what is seen from it is turned.
DOWN = math.radians(30)
ARM = tree(
    Link(name="world"),
    (
        joint("world", "tool", JointType.FIXED, Pose((0.0, 0.0, 1.0), (0.0, DOWN, 0.0))),
        body(Box(size=(0.1, 0.1, 0.1)), name="tool", mass=2.0, at=Pose((0.3, 0.0, 0.0))),
    ),
    fixed_to_world=True,
)
WEIGHT = 2 * G
# That of the load, seen from the arm: what the tool exerts on the world.
FORCE = (WEIGHT * math.sin(DOWN), 0.0, -WEIGHT * math.cos(DOWN))
TORQUE = (0.0, 0.3 * WEIGHT * math.cos(DOWN), 0.0)
TOPIC = "/world/w/model/rover/joint/tool/sensor/wrist/forcetorque"


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)


def sensor(content: str = "", pose: Pose = IDENTITY, frame: str = "tool") -> MountedSensor:
    text = (
        f'<sensor name="wrist" type="force_torque"><update_rate>100</update_rate>{content}</sensor>'
    )
    return MountedSensor(
        name="wrist",
        kind="force_torque",
        link="tool",
        pose_in_link=pose,
        frame=frame,
        element=element(text),
    )


@contextmanager
def carrying(devices: Devices, simulator: str) -> Iterator[tuple[Any, FakeRos]]:
    """The arm with its devices; its root is the world."""
    arm = SpawnedRobot(entity="rover", robot=ARM)
    scene = LiveScene(
        scene=Scene(world=VOID, robots=(arm,)),
        simulator=simulator,
        world="w",
        devices={"rover": devices},
    )
    simulation, ros = simulation_of(scene, BulletEngine(VOID))
    try:
        simulation.spawn("rover")
        bridged(ros, simulation, ("/w", TOPIC, "geometry_msgs/msg/WrenchStamped", "Wrench"))
        yield simulation, ros
    finally:
        simulation.close()


def parts(message: Any) -> list[Any]:
    """Force and torque, about."""
    wrench = message.wrench
    return [
        pytest.approx((part.x, part.y, part.z), abs=0.01) for part in (wrench.force, wrench.torque)
    ]


def test_a_sensor_of_gazebo_sim() -> None:
    """In the frame of the child, what it exerts on its parent, as sdformat's defaults say."""
    with carrying(Devices(sensors=(sensor(),)), "gz") as (simulation, ros):
        simulation.advance(0.101)
        found = ros.published("/w")
        assert len(found) == 11
        assert parts(found[-1]) == [FORCE, TORQUE]
        assert found[-1].header.frame_id == "rover/tool/wrist"
        assert found[-1].header.stamp.nanosec == 100_000_000


@pytest.mark.parametrize(
    ("content", "force", "torque"),
    [
        (
            "<frame>parent</frame>",
            (0.0, 0.0, -WEIGHT),
            (0.0, 0.3 * WEIGHT * math.cos(DOWN), 0.0),
        ),
        (
            "<measure_direction>parent_to_child</measure_direction>",
            tuple(-part for part in FORCE),
            tuple(-part for part in TORQUE),
        ),
    ],
)
def test_frames_and_directions(content: str, force: Any, torque: Any) -> None:
    written = sensor(f"<force_torque>{content}</force_torque>")
    with carrying(Devices(sensors=(written,)), "gz") as (simulation, ros):
        simulation.advance(0.05)
        assert parts(ros.published("/w")[-1]) == [force, torque]


def test_a_sensor_beside_its_joint() -> None:
    """It is 0.1 m along the arm and turned about it by 90 degrees."""
    beside = Pose((0.1, 0.0, 0.0), (math.pi / 2, 0.0, 0.0))
    written = sensor("<force_torque><frame>sensor</frame></force_torque>", beside)
    with carrying(Devices(sensors=(written,)), "gz") as (simulation, ros):
        simulation.advance(0.05)
        along, _, across = FORCE
        wanted = [(along, across, 0.0), (0.0, 0.0, -TORQUE[1] * 2 / 3)]
        assert parts(ros.published("/w")[-1]) == wanted


@pytest.mark.parametrize(
    ("written", "problem"),
    [
        (sensor(frame="base"), "it is on the link `base`"),
        (sensor("<force_torque><frame>child_link</frame></force_torque>"), "child or parent"),
    ],
)
def test_sensors_that_cannot_work(written: MountedSensor, problem: str) -> None:
    with carrying(Devices(sensors=(written,)), "gz") as (_, ros):
        assert problem in ros.warnings[0]


FT = "libgazebo_ros_ft_sensor.so"


def test_the_plugin_of_classic() -> None:
    """As gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_ft_sensor.cpp, publishes it."""
    content = (
        "<ros><namespace>/arm</namespace></ros><joint_name>tool</joint_name>"
        "<update_rate>20</update_rate>"
    )
    with carrying(Devices(plugins=(plugin(FT, content),)), "classic") as (simulation, ros):
        simulation.advance(0.5)
        found = ros.published("/arm/wrench")
        assert len(found) == 10
        assert parts(found[-1]) == [FORCE, TORQUE]
        assert found[-1].header.frame_id == "tool"


def test_the_noise_of_the_plugin() -> None:
    content = "<joint_name>tool</joint_name><gaussian_noise>0.5</gaussian_noise>"
    with carrying(Devices(plugins=(plugin(FT, content),)), "classic") as (simulation, ros):
        simulation.advance(2.0)
        values = [message.wrench.force.y for message in ros.published("/wrench")[1:]]
        assert len(values) == 199
        assert math.sqrt(sum(value**2 for value in values) / len(values)) == pytest.approx(
            0.5, rel=0.15
        )


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("<joint_name>wrist</joint_name>", "no joint `wrist`, or sdformat lumps it"),
        ("<body_name>tool</body_name>", "does not measure a <body_name>"),
    ],
)
def test_plugins_that_cannot_work(content: str, problem: str) -> None:
    with carrying(Devices(plugins=(plugin(FT, content),)), "classic") as (_, ros):
        assert problem in ros.warnings[0]


def test_hardware_and_broadcaster() -> None:
    from live.nodes.ros2_control.controlled import Node  # noqa: PLC0415
    from wsgen.live.nodes.simulator.ros2_control.controllers import (  # noqa: PLC0415
        controller_class,
    )
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import (  # noqa: PLC0415
        ControllerError,
        Surroundings,
    )
    from wsgen.live.nodes.simulator.ros2_control.hardware import (  # noqa: PLC0415
        FORCE_TORQUE,
        Component,
        Interfaces,
        SensorPart,
    )
    from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters  # noqa: PLC0415
    from wsgen.live.nodes.simulator.ros2_control.sensor_hardware import sensors_of  # noqa: PLC0415

    with carrying(Devices(sensors=(sensor(),)), "classic") as (simulation, ros):
        known, unknown = (SensorPart(name, FORCE_TORQUE) for name in ("wrist", "ankle"))
        component = Component(
            name="c",
            kind="system",
            plugin="gazebo_ros2_control/GazeboSystem",
            sensors=(known, unknown),
        )
        interfaces = Interfaces((component,))
        robot = simulation.host.robots["rover"]
        (hardware,) = sensors_of(simulation.host, robot, (component,), interfaces)
        assert "Skipping sensor in the URDF named 'ankle'" in ros.warnings[-1]
        assert sorted(interfaces.states) == sorted(f"wrist/{kind}" for kind in FORCE_TORQUE)
        simulation.advance(0.05)
        hardware.update()
        assert interfaces.states["wrist/torque.y"] == pytest.approx(TORQUE[1], abs=0.01)
        kind = controller_class("force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster")
        assert kind is not None

        def made(**parameters: Any) -> Any:
            node = Node("ft")
            ros.nodes.append(node)
            surroundings = Surroundings(
                node,
                ros,  # type: ignore[arg-type]
                Parameters(parameters),
                interfaces,
                (),
                clock=lambda: simulation.host.now,
                is_former=False,
            )
            controller = kind(surroundings)
            controller.configure()
            return controller

        offset = {"offset.force.x": 1.0, "multiplier.force.x": 2.0}
        broadcaster = made(sensor_name="wrist", frame_id="tool", **offset)
        assert broadcaster.states == tuple(f"wrist/{kind}" for kind in FORCE_TORQUE)
        broadcaster.update(simulation.host.now, 0.01)
        message = ros.published("/~/wrench")[-1]
        assert message.header.frame_id == "tool"
        assert message.wrench.force.x == pytest.approx((FORCE[0] + 1.0) * 2.0, abs=0.02)
        assert message.wrench.torque.y == pytest.approx(TORQUE[1], abs=0.01)
        alone = made(**{"interface_names.force.z": "wrist/force.z"})
        assert alone.states == ("wrist/force.z",)
        alone.update(simulation.host.now, 0.01)
        message = ros.published("/~/wrench")[-1]
        assert message.wrench.force.z == pytest.approx(FORCE[2], abs=0.01)
        assert math.isnan(message.wrench.force.x)
        with pytest.raises(ControllerError, match="'sensor_name' or at least one"):
            made()
        with pytest.raises(ControllerError, match="can not be specified together"):
            made(sensor_name="wrist", **{"interface_names.force.z": "wrist/force.z"})
