"""What a live run is given of a robot, and what a validation is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.isolation import parent
from wsgen.model.world import Spawn
from wsgen.pipeline.prepare import (
    PrepareContext,
    prepare_models,
    prepare_robot,
    read_file,
    read_spawned,
)

if TYPE_CHECKING:
    from pathlib import Path

URDF = (
    '<robot name="r"><link name="base"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    '<gazebo reference="base"><sensor name="imu" type="imu"/></gazebo></robot>'
)
SDF = (
    '<sdf version="1.9"><model name="m"><link name="base"><inertial><mass>1</mass></inertial>'
    '<sensor name="imu" type="imu"/></link></model></sdf>'
)


def context(folder: Path, *, with_devices: bool) -> PrepareContext:
    return PrepareContext(
        share_of=lambda _: None, folder=folder, run=parent.run, with_devices=with_devices
    )


@pytest.mark.parametrize("text", [URDF, URDF.encode()])
def test_a_urdf_is_kept_with_its_sensors(tmp_path: Path, text: str | bytes) -> None:
    robot, _ = prepare_robot(text, file=None, context=context(tmp_path, with_devices=True))
    assert robot is not None
    assert robot.devices is not None
    assert [sensor.name for sensor in robot.devices.sensors] == ["imu"]
    assert robot.description == URDF


def test_a_model_of_sdf_has_no_urdf(tmp_path: Path) -> None:
    live = context(tmp_path, with_devices=True)
    found = read_spawned(Spawn(entity="m", description=SDF), live, {})
    (robot,), _ = prepare_models(found, live)
    assert robot.devices is not None
    assert [sensor.link for sensor in robot.devices.sensors] == ["base"]
    assert robot.description is None


def test_a_world_may_include_a_urdf(tmp_path: Path) -> None:
    bot = tmp_path / "models" / "bot"
    bot.mkdir(parents=True)
    (bot / "model.config").write_text("<model><name>bot</name><sdf>bot.urdf</sdf></model>")
    (bot / "bot.urdf").write_text(URDF)
    world = tmp_path / "w.sdf"
    world.write_text(
        '<sdf version="1.9"><world name="w"><include><uri>model://bot</uri></include></world></sdf>'
    )
    live = context(tmp_path, with_devices=True)
    found = read_file(world, live, {"GZ_SIM_RESOURCE_PATH": str(tmp_path / "models")})
    (robot,), _ = prepare_models(found, live)
    assert robot.devices is not None
    assert [sensor.name for sensor in robot.devices.sensors] == ["imu"]


def test_a_validation_reads_none(tmp_path: Path) -> None:
    robot, _ = prepare_robot(URDF, file=None, context=context(tmp_path, with_devices=False))
    assert robot is not None
    assert robot.devices is None
    assert robot.description is None
