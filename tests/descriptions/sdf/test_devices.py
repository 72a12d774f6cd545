"""Sensors and plugins of SDF models and worlds, in the frames that a `Robot` has."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.models import read_model, read_sdf
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.devices import Devices

QUARTER = math.pi / 2
MASS = "<inertial><mass>2</mass></inertial>"


def devices_of(content: str) -> Devices:
    text = f'<sdf version="1.9"><model name="m">{content}</model></sdf>'
    read = read_model(text, file=None, find_model=lambda _: None, with_devices=True)
    assert read.diagnostics == ()
    (model,) = read.models
    assert model.devices is not None
    return model.devices


def near(pose: Pose) -> object:
    return pytest.approx((*pose.xyz, *pose.rpy), abs=1e-9)


def numbers(pose: Pose) -> tuple[float, ...]:
    return (*pose.xyz, *pose.rpy)


TWO_LINKS = (
    f'<link name="base">{MASS}</link>'
    f'<link name="arm"><pose>0 0 1 0 0 {QUARTER}</pose>{MASS}'
    '<sensor name="eye" type="camera"><pose>0.5 0 0 0 0 0</pose>'
    '<plugin name="p" filename="libp.so"><a>1</a></plugin></sensor></link>'
    '<joint name="elbow" type="revolute"><parent>base</parent><child>arm</child>'
    "<pose>0 0 0.2 0 0 0</pose><axis><xyz>0 0 1</xyz></axis>"
    '<sensor name="torque" type="force_torque"/></joint>'
    '<frame name="tip" attached_to="arm"><pose>1 0 0 0 0 0</pose></frame>'
    '<plugin name="whole" filename="libwhole.so"/>'
)


def test_sensors_are_seen_from_the_frame_of_the_joint() -> None:
    found = devices_of(TWO_LINKS)
    eye, torque = found.sensors
    assert (eye.name, eye.kind, eye.link, eye.frame) == ("eye", "camera", "arm", "arm")
    # The joint is 0.2 m above the link's own frame, so the sensor is as far below it.
    assert numbers(eye.pose_in_link) == near(Pose((0.5, 0, -0.2)))
    assert eye.plugins[0].get("a") == "1"
    assert (torque.kind, torque.link, torque.frame) == ("force_torque", "arm", "elbow")
    assert numbers(torque.pose_in_link) == near(Pose())
    assert [plugin.attributes["name"] for plugin in found.plugins] == ["whole"]


def test_frames_of_links_and_of_sdf_are_known() -> None:
    frames = devices_of(TWO_LINKS).frames
    assert set(frames) == {"base", "arm", "tip"}
    assert numbers(frames["arm"].pose_in_link) == near(Pose((0, 0, -0.2)))
    assert frames["tip"].link == "arm"
    assert numbers(frames["tip"].pose_in_link) == near(Pose((1, 0, -0.2)))


def test_a_pose_relative_to_a_frame() -> None:
    content = TWO_LINKS.replace("<pose>0.5 0 0", '<pose relative_to="tip">0.5 0 0')
    eye = devices_of(content).sensors[0]
    assert numbers(eye.pose_in_link) == near(Pose((1.5, 0, -0.2)))


def test_a_pose_may_have_a_quaternion() -> None:
    pose = '<pose rotation_format="quat_xyzw">1 2 3 0 0 1 1</pose>'
    content = f'<link name="base">{MASS}<sensor name="s" type="imu">{pose}</sensor></link>'
    (sensor,) = devices_of(content).sensors
    assert numbers(sensor.pose_in_link) == near(Pose((1, 2, 3), (0, 0, QUARTER)))


def test_models_in_models_bring_their_own() -> None:
    inner = (
        f'<link name="base">{MASS}</link><joint name="j" type="fixed"><parent>base</parent>'
        '<child>inner::head</child></joint><model name="inner"><pose>0 0 2 0 0 0</pose>'
        f'<link name="head">{MASS}<sensor name="s" type="imu"/></link>'
        '<plugin name="of_inner" filename="libi.so"/></model>'
    )
    found = devices_of(inner)
    assert [(one.link, one.kind) for one in found.sensors] == [("inner::head", "imu")]
    assert [one.attributes["name"] for one in found.plugins] == ["of_inner"]


def test_worlds_and_includes_bring_plugins(tmp_path: Path) -> None:
    model = tmp_path / "bot"
    model.mkdir()
    (model / "model.config").write_text(
        '<model><name>bot</name><sdf version="1.9">model.sdf</sdf></model>'
    )
    (model / "model.sdf").write_text(
        f'<sdf version="1.9"><model name="bot"><link name="base">{MASS}</link></model></sdf>'
    )
    world = tmp_path / "w.sdf"
    world.write_text(
        '<sdf version="1.9"><world name="w"><plugin name="physics" filename="gz-sim-physics"/>'
        "<magnetic_field>1e-5 2e-5 0</magnetic_field><include><uri>model://bot</uri>"
        '<plugin name="of_include" filename="libi.so"/></include></world></sdf>'
    )

    read = read_sdf(world, find_model=lambda _: model, with_devices=True)

    assert read.devices is not None
    assert [one.attributes["name"] for one in read.devices.plugins] == ["physics"]
    assert [(one.tag, one.text) for one in read.devices.surroundings] == [
        ("magnetic_field", "1e-5 2e-5 0")
    ]
    (bot,) = read.models
    assert bot.devices is not None
    assert [one.attributes["name"] for one in bot.devices.plugins] == ["of_include"]


def test_nothing_is_read_unless_it_is_wanted() -> None:
    text = f'<sdf version="1.9"><model name="m">{TWO_LINKS}</model></sdf>'
    (model,) = read_model(text, file=None, find_model=lambda _: None).models
    assert model.devices is None
