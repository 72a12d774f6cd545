"""What gazebo_msgs offers of Gazebo Classic's world."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from typing import Any

import pytest

from live.nodes.fake_ros import ROVER, live_scene, plugin, rover_engine, simulation_of, still_at
from wsgen.model.devices import Devices, MountedSensor
from wsgen.simulation.live_runs import NewEntity, PreparedEntity
from wsgen.simulation.scene import SpawnedRobot

pytestmark = pytest.mark.usefixtures("messages")
STATE = plugin("libgazebo_ros_state.so", "<ros><namespace>/gazebo</namespace></ros>", name="state")


def message(kind: str, **values: Any) -> Any:
    return getattr(sys.modules["gazebo_msgs.msg"], kind)(**values)  # a fake


def test_robots_are_spawned_listed_and_deleted_by_services() -> None:
    from wsgen.live.nodes.simulator.world_state import offer_factory  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene())
    simulation.prepare = prepared_box
    offer_factory(simulation)
    request = message("SpawnRequest", name="rover", xml="<sdf/>")
    request.initial_pose.position.z = math.nan
    assert not ros.services["/spawn_entity"](request, message("Done")).success
    assert not simulation.host.robots
    request.initial_pose.position.z = 0.3
    answer = ros.services["/spawn_entity"](request, message("Done"))
    assert answer.success
    assert simulation.host.robots["rover"].spawned.pose_in_world.xyz[2] == pytest.approx(0.3)
    answer = ros.services["/spawn_entity"](request, message("Done"))
    assert not answer.success
    assert answer.status_message == "Entity [rover] already exists."
    listed = ros.services["/get_model_list"](None, message("ListAnswer"))
    assert listed.model_names == ["rover"]
    deleted = ros.services["/delete_entity"](request, message("Done"))
    assert deleted.success
    assert not simulation.host.robots
    deleted = ros.services["/delete_entity"](request, message("Done"))
    assert deleted.status_message == "Entity [rover] does not exist"


def test_what_the_launch_file_does_not_name_is_spawned() -> None:
    from wsgen.live.nodes.simulator.world_state import offer_factory  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene())
    simulation.prepare = prepared_box
    offer_factory(simulation)
    simulation.spawn("rover")

    def spawn(**values: Any) -> str:
        answer = ros.services["/spawn_entity"](message("SpawnRequest", **values), message("Done"))
        return f"{answer.success}: {answer.status_message}"

    assert spawn(name="box", xml="<sdf/>") == "True: SpawnEntity: Successfully spawned entity [box]"
    assert spawn(xml="<sdf/>") == "True: Successfully sent factory message to Gazebo."
    assert list(simulation.host.robots) == ["rover", "box", "box_0"]
    assert spawn(name="bad", xml="") == "False: No text. Write one."
    assert spawn(name="lost", xml="<sdf/>", reference_frame="moon").startswith(
        "False: Reference frame [moon] not found"
    )
    assert "True" in spawn(name="beside", xml="<sdf/>", reference_frame="rover::base")
    assert simulation.host.robots["beside"].spawned.pose_in_world.xyz[2] == pytest.approx(0.1)
    simulation.delete("box")
    assert "True" in spawn(name="box", xml="<sdf/>")


def test_the_namespace_of_a_request_is_that_of_all_plugins() -> None:
    from wsgen.live.nodes.simulator.world_state import offer_factory  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene())
    drive = plugin("libgazebo_ros_planar_move.so", "<ros><namespace>/old</namespace></ros>")
    sensor = MountedSensor(name="s", kind="unknown", link="base", frame="base", element=drive)
    devices = Devices(plugins=(drive,), sensors=(replace(sensor, plugins=(drive,)),))
    simulation.prepare = lambda new: replace(prepared_box(new), devices=devices)
    offer_factory(simulation)
    request = message("SpawnRequest", name="box", xml="<sdf/>", robot_namespace="second")
    assert ros.services["/spawn_entity"](request, message("Done")).success
    given = simulation.host.robots["box"].devices
    for one in (*given.plugins, *given.sensors[0].plugins):
        assert [ns.text for ns in one.find_all("ros/namespace")] == ["second"]
    assert ros.readers["/second/cmd_vel"]
    assert "/old/cmd_vel" not in ros.readers


def prepared_box(new: NewEntity) -> PreparedEntity:
    """What the parent makes of a text; it refuses an empty one."""
    from wsgen.live.nodes.simulator.simulation import RefusedError  # noqa: PLC0415

    if not new.text:
        raise RefusedError("No text.", "Write one.")
    robot = SpawnedRobot(entity=new.entity or "box", robot=ROVER, pose_in_world=new.pose_in_world)
    return PreparedEntity(robot=robot)


def test_states_are_read_set_and_published() -> None:
    engine = rover_engine(still_at(1.0, 2.0))
    engine.velocity = ((0.5, 0.0, 0.0), (0.0, 0.0, 0.2))
    scene = live_scene(world_devices=Devices(plugins=(STATE,)))
    simulation, ros = simulation_of(scene, engine)
    simulation.spawn("rover")
    request = message("EntityRequest", name="rover::base")
    found = ros.services["/gazebo/get_entity_state"](request, message("StateAnswer"))
    assert found.success
    assert (found.state.pose.position.x, found.state.twist.angular.z) == pytest.approx((1.0, 0.2))
    request = message("EntityRequest", name="rover", reference_frame="rover")
    found = ros.services["/gazebo/get_entity_state"](request, message("StateAnswer"))
    assert (found.state.pose.position.x, found.state.twist.linear.x) == pytest.approx((0.0, 0.0))
    request = message("EntityRequest", name="rower")
    assert not ros.services["/gazebo/get_entity_state"](request, message("StateAnswer")).success
    state = message("EntityState", name="rover")
    state.pose.position.z, state.twist.linear.y = 0.7, 0.4
    request = message("StateRequest", state=state)
    assert ros.services["/gazebo/set_entity_state"](request, message("Done")).success
    assert engine.velocities["rover"][0] == pytest.approx((0.0, 0.4, 0.0))
    assert simulation.host.robots["rover"].state().xyz[2] == pytest.approx(0.7)
    for number, named in ((math.nan, "not finite"), (1e9, "more than 10000 m/s")):
        state.twist.linear.y = number
        assert not ros.services["/gazebo/set_entity_state"](request, message("Done")).success
        assert named in ros.warnings[-1]
    simulation.advance(0.1)
    assert ros.published("/gazebo/model_states")[-1].name == ["rover"]
    assert "rover::left_wheel" in ros.published("/gazebo/link_states")[-1].name
