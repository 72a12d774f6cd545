"""Contact sensors and altimeters, with each engine that live runs have."""

from __future__ import annotations

import importlib
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.fake_ros import simulation_of
from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.sensor_texts import element
from simulation.robots import GROUND, body, single
from wsgen.model.devices import Devices, MountedSensor
from wsgen.model.engines import ENGINES
from wsgen.model.robot import Box
from wsgen.model.transform import Pose
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.run import missing_engines
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from live.nodes.fake_ros import FakeRos

CLASSES = {"bullet": "BulletEngine", "dart": "DartEngine", "mujoco": "MujocoEngine"}
LOW = SpawnedRobot(
    entity="low",
    robot=single(body(Box(size=(0.4, 0.4, 0.2)), mass=3.0)),
    pose_in_world=Pose((0.0, 0.0, 0.1)),
)
HIGH = SpawnedRobot(
    entity="high",
    robot=single(body(Box(size=(0.2, 0.2, 0.2)), mass=2.0)),
    pose_in_world=Pose((0.05, 0.0, 0.3)),
)


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> Any:
    """A new one."""
    name: str = request.param
    if missing_engines([name]):
        pytest.skip(f"{ENGINES[name].title} is not installed")
    return getattr(importlib.import_module(f"wsgen.simulation.{name}"), CLASSES[name])(GROUND)


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)


def mounted(text: str, pose: Pose) -> MountedSensor:
    read = element(text)
    return MountedSensor(
        name=read.attributes["name"],
        kind=read.attributes["type"],
        link="base",
        pose_in_link=pose,
        frame="base",
        element=read,
        plugins=tuple(read.find_all("plugin")),
    )


@contextmanager
def carried(
    engine: Any, sensor: MountedSensor, *robots: SpawnedRobot, simulator: str
) -> Iterator[tuple[Any, FakeRos]]:
    """Robots in the world, of which the first one has a sensor."""
    scene = LiveScene(
        scene=Scene(world=GROUND, robots=robots),
        simulator=simulator,
        world="field",
        devices={robots[0].entity: Devices(sensors=(sensor,))},
        descriptions={robot.entity: "<robot/>" for robot in robots},
    )
    simulation, ros = simulation_of(scene, engine)
    try:
        for robot in robots:
            simulation.spawn(robot.entity)
        yield simulation, ros
    finally:
        simulation.close()


@pytest.mark.slow
def test_a_bumper_feels_what_it_stands_on_and_what_stands_on_it(engine: Any) -> None:
    """As gazebo_ros_pkgs, gazebo_plugins/src/gazebo_ros_bumper.cpp, says it."""
    bumper = (
        '<sensor name="bumper" type="contact"><update_rate>50</update_rate><contact>'
        "<collision>base_collision</collision></contact>"
        '<plugin name="p" filename="libgazebo_ros_bumper.so"/></sensor>'
    )
    with carried(engine, mounted(bumper, Pose()), LOW, HIGH, simulator="classic") as (
        simulation,
        ros,
    ):
        simulation.advance(1.001)
        found = ros.published("/bumper_states")
        assert len(found) == 51  # also where nothing touches
        states = {state.collision2_name: state for state in found[-1].states}
        assert sorted(states) == ["ground_plane::link::collision", "high::base::base_collision"]
        ground, load = states["ground_plane::link::collision"], states["high::base::base_collision"]
        assert ground.total_wrench.force.z == pytest.approx(5 * 9.8, rel=0.03)
        assert load.total_wrench.force.z == pytest.approx(-2 * 9.8, rel=0.03)
        for state, up, height in ((ground, 1.0, 0.0), (load, -1.0, 0.2)):
            assert [one.z for one in state.contact_normals] == pytest.approx(
                [up] * len(state.contact_normals), abs=0.01
            )
            assert [one.z for one in state.contact_positions] == pytest.approx(
                [height] * len(state.contact_positions), abs=5e-3
            )
            assert all(0.0 <= depth < 5e-3 for depth in state.depths)
        # The load is off the center by 5 cm.
        turn = sum(
            wrench.force.z * place.x
            for wrench, place in zip(load.wrenches, load.contact_positions, strict=True)
        )
        assert turn == pytest.approx(-2 * 9.8 * 0.05, rel=0.1)


def test_contacts_of_gazebo_sim_are_reported_while_something_touches(engine: Any) -> None:
    """As gz-sim, src/systems/contact/Contact.cc, says it."""
    bumper = (
        '<sensor name="bumper" type="contact"><update_rate>100</update_rate><contact>'
        "<collision>base_collision</collision><topic>/bumper</topic></contact></sensor>"
    )
    falling = SpawnedRobot(entity="f", robot=LOW.robot, pose_in_world=Pose((0.0, 0.0, 0.3)))
    with carried(engine, mounted(bumper, Pose()), falling, simulator="gz") as (simulation, ros):
        from wsgen.live.nodes.simulator.topics import Rule  # noqa: PLC0415  with fakes

        kind = "ros_gz_interfaces/msg/Contacts"
        simulation.host.gz.open(
            ros.node("bridge"), [Rule("/b", "/bumper", kind, "gz.msgs.Contacts")]
        )
        simulation.advance(0.19)  # it falls for 0.2 s
        assert not ros.published("/b")
        simulation.advance(1.0)
        (contact,) = ros.published("/b")[-1].contacts
        assert contact.collision1.name == "f::base::base_collision"
        assert contact.collision2.name == "ground_plane::link::collision"
        force = sum(wrench.body_1_wrench.force.z for wrench in contact.wrenches)
        assert force == pytest.approx(3 * 9.8, rel=0.05)


def test_an_altimeter_falls(engine: Any) -> None:
    """As gz-sensors, src/AltimeterSensor.cc: height and climb since it began, at the sensor."""
    text = '<sensor name="a" type="altimeter"><update_rate>100</update_rate><altimeter/></sensor>'
    high = SpawnedRobot(entity="f", robot=LOW.robot, pose_in_world=Pose((0.0, 0.0, 3.0)))
    sensor = mounted(text, Pose((0.1, 0.0, 0.5)))
    with carried(engine, sensor, high, simulator="gz") as (simulation, ros):
        from wsgen.live.nodes.simulator.topics import Rule  # noqa: PLC0415  with fakes

        topic = "/world/field/model/f/link/base/sensor/a/altimeter"
        kind = "ros_gz_interfaces/msg/Altimeter"
        simulation.host.gz.open(
            ros.node("bridge"), [Rule("/alt", topic, kind, "gz.msgs.Altimeter")]
        )
        simulation.advance(0.401)
        message = ros.published("/alt")[-1]
        assert message.header.stamp.nanosec == 400_000_000
        assert message.vertical_position == pytest.approx(-0.5 * 9.8 * 0.16, rel=0.01)
        assert message.vertical_velocity == pytest.approx(-9.8 * 0.4, rel=0.01)
        assert message.vertical_reference == pytest.approx(3.5)
        assert message.header.frame_id == "f/base/a"
