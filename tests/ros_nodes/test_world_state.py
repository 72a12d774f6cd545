"""What gazebo_msgs offers of Gazebo Classic's world."""

from __future__ import annotations

import math
import sys
from typing import Any

import pytest

from ros_nodes.fake_ros import live_scene, plugin, rover_engine, simulation_of, still_at
from wsgen.model.devices import Devices

pytestmark = pytest.mark.usefixtures("messages")
STATE = plugin("libgazebo_ros_state.so", "<ros><namespace>/gazebo</namespace></ros>", name="state")


def message(kind: str, **values: Any) -> Any:
    return getattr(sys.modules["gazebo_msgs.msg"], kind)(**values)  # a fake


def test_robots_are_spawned_listed_and_deleted_by_services() -> None:
    from wsgen.ros_nodes.simulator.world_state import offer_factory  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene())
    offer_factory(simulation)
    request = message("SpawnRequest", name="rover")
    request.initial_pose.position.z = math.nan
    assert not ros.services["/spawn_entity"](request, message("Done")).success
    assert not simulation.host.robots
    request.initial_pose.position.z = 0.3
    answer = ros.services["/spawn_entity"](request, message("Done"))
    assert answer.success
    assert simulation.host.robots["rover"].state().xyz[2] == pytest.approx(0.3)
    answer = ros.services["/spawn_entity"](request, message("Done"))
    assert not answer.success
    assert "exists already" in answer.status_message
    listed = ros.services["/get_model_list"](None, message("ListAnswer"))
    assert listed.model_names == ["rover"]
    deleted = ros.services["/delete_entity"](request, message("Done"))
    assert deleted.success
    assert not simulation.host.robots


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
    state.twist.linear.y = math.nan
    assert not ros.services["/gazebo/set_entity_state"](request, message("Done")).success
    simulation.advance(0.1)
    assert ros.published("/gazebo/model_states")[-1].name == ["rover"]
    assert "rover::left_wheel" in ros.published("/gazebo/link_states")[-1].name
