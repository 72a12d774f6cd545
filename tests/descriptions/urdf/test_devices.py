"""Sensors and plugins of a URDF: on the links that Gazebo has, where it has them."""

from __future__ import annotations

import json
import math

import pytest

from wsgen.descriptions.urdf.devices import read_devices
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.isolation.codec import decode, encode
from wsgen.model.devices import Carried, Devices
from wsgen.model.transform import Pose, rotation_of_rpy, transpose
from wsgen.model.world import World
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.scene import Scene, SpawnedRobot

QUARTER = math.pi / 2
INERTIAL = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)
SENSOR = '<gazebo reference="{0}"><sensor name="eye" type="camera">{1}</sensor></gazebo>'


def joint(  # noqa: PLR0917
    name: str, parent: str, child: str, xyz: str, rpy: str = "0 0 0", kind: str = "fixed"
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/></joint>'
    )


BODY = (
    f'<link name="base_link">{INERTIAL}</link>'
    f'<link name="mast">{INERTIAL}</link>'
    '<link name="eye_link"/>'
    + joint("mast_joint", "base_link", "mast", "0 0 1", f"0 0 {QUARTER}")
    + joint("eye_joint", "mast", "eye_link", "0.2 0 0", f"0 {QUARTER} 0")
)


def devices_of(content: str, body: str = BODY) -> Devices:
    text = f'<robot name="r">{body}{content}</robot>'
    written, diagnostics = read_urdf(text, file=None)
    assert written is not None
    assert not [found for found in diagnostics if found.severity.value == "error"]
    lumped, _ = lump(written)
    return read_devices(text, written, lumped)


def near(pose: Pose) -> object:
    return pytest.approx((*pose.xyz, *pose.rpy), abs=1e-9)


def numbers(pose: Pose) -> tuple[float, ...]:
    return (*pose.xyz, *pose.rpy)


def test_a_sensor_of_a_lumped_link_is_on_the_link_it_became_a_part_of() -> None:
    (sensor,) = devices_of(SENSOR.format("eye_link", "<pose>0 0 0.1 0 0 0</pose>")).sensors
    assert (sensor.name, sensor.kind, sensor.link) == ("eye", "camera", "base_link")
    assert sensor.frame == "eye_link"
    # 0.2 m ahead of a mast that is turned by 90 degrees, then 0.1 m along z, which is x there.
    assert sensor.pose_in_link.xyz == pytest.approx((0.0, 0.3, 1.0))
    ahead, _, up = transpose(rotation_of_rpy(sensor.pose_in_link.rpy))
    assert ahead == pytest.approx((0.0, 0.0, -1.0))
    assert up == pytest.approx((0.0, 1.0, 0.0))


@pytest.mark.parametrize("key", ["preserveFixedJoint", "disableFixedJointLumping"])
def test_a_link_that_is_not_lumped_carries_its_own_sensors(key: str) -> None:
    keep = f'<gazebo reference="mast_joint"><{key}>true</{key}></gazebo>'
    found = devices_of(keep + SENSOR.format("eye_link", ""))
    (sensor,) = found.sensors
    assert sensor.link == "mast"
    assert numbers(sensor.pose_in_link) == near(Pose((0.2, 0, 0), (0, QUARTER, 0)))
    assert found.frames["mast"] == Carried(link="mast")
    assert found.frames["eye_link"].link == "mast"


def test_a_sensor_on_its_own_link_is_where_its_pose_says() -> None:
    (sensor,) = devices_of(SENSOR.format("base_link", "<pose>1 2 3 0 0 1</pose>")).sensors
    assert numbers(sensor.pose_in_link) == near(Pose((1, 2, 3), (0, 0, 1)))
    (sensor,) = devices_of(
        SENSOR.format("base_link", '<pose degrees="true">0 0 0 0 0 90</pose>')
    ).sensors
    assert numbers(sensor.pose_in_link) == near(Pose(rpy=(0, 0, QUARTER)))


def test_sdformat_forgets_the_attributes_of_a_pose_that_it_moves() -> None:
    """As `ign sdf -p` of sdformat 12 prints such sensors."""
    quaternion = '<pose rotation_format="quat_xyzw">0.1 0 0 0 0 0.6 0.8</pose>'
    (kept,) = devices_of(SENSOR.format("base_link", quaternion)).sensors
    assert numbers(kept.pose_in_link) == near(Pose((0.1, 0, 0), (0, 0, 2 * math.atan2(0.6, 0.8))))
    (moved,) = devices_of(SENSOR.format("mast", quaternion)).sensors
    assert moved.link == "base_link"
    assert numbers(moved.pose_in_link) == near(Pose((0, 0.1, 1), (0, 0, QUARTER + 0.6)))
    degrees = '<pose degrees="true">0 0 0 0 0 1</pose>'
    (moved,) = devices_of(SENSOR.format("mast", degrees)).sensors
    assert numbers(moved.pose_in_link) == near(Pose((0, 0, 1), (0, 0, QUARTER + 1)))


def test_a_pose_may_be_relative_to_another_link() -> None:
    pose = '<pose relative_to="mast">0.5 0 0 0 0 0</pose>'
    (sensor,) = devices_of(SENSOR.format("base_link", pose)).sensors
    assert numbers(sensor.pose_in_link) == near(Pose((0, 0.5, 1), (0, 0, QUARTER)))


def test_a_sensor_of_a_joint_is_in_the_frame_of_its_child() -> None:
    wheel = f'<link name="wheel">{INERTIAL}</link>' + joint(
        "axle", "mast", "wheel", "0 0 0.5", kind="continuous"
    )
    text = '<gazebo reference="axle"><sensor name="torque" type="force_torque"/></gazebo>'
    found = devices_of(text, BODY + wheel)
    (sensor,) = found.sensors
    assert (sensor.kind, sensor.link) == ("force_torque", "wheel")
    assert numbers(sensor.pose_in_link) == near(Pose())


def test_what_gazebo_drops_carries_nothing() -> None:
    arm = '<link name="arm"/>' + joint("elbow", "base_link", "arm", "0 0 0", kind="continuous")
    text = f'<robot name="r">{BODY}{arm}{SENSOR.format("arm", "")}</robot>'
    written, _ = read_urdf(text, file=None)
    assert written is not None
    found = read_devices(text, written, lump(written)[0])
    assert found.sensors == ()
    assert "arm" not in found.frames


def test_plugins_keep_everything_that_is_written_in_them() -> None:
    found = devices_of(
        '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">'
        "<!-- not this --><ros><namespace>/rover</namespace><remapping>a:=b</remapping>"
        "<remapping>c:=d</remapping></ros><wheel_radius unit='m'> 0.1 </wheel_radius>"
        "</plugin></gazebo>"
        + SENSOR.format("eye_link", '<plugin name="driver" filename="libcamera.so"/>')
        + '<ros2_control name="hardware" type="system"><joint name="axle"/></ros2_control>'
    )
    (plugin,) = found.plugins
    assert plugin.attributes == {"name": "drive", "filename": "libgazebo_ros_diff_drive.so"}
    assert plugin.get("ros/namespace") == "/rover"
    assert [one.text for one in plugin.find_all("ros/remapping")] == ["a:=b", "c:=d"]
    radius = plugin.find("wheel_radius")
    assert radius is not None
    assert (radius.text, radius.attributes) == ("0.1", {"unit": "m"})
    assert plugin.get("none", "default") == "default"
    assert [one.attributes["name"] for one in found.sensors[0].plugins] == ["driver"]
    (control,) = found.ros2_control
    assert control.attributes["name"] == "hardware"
    assert plugin.line == 1


def test_all_links_have_a_frame() -> None:
    frames = devices_of("").frames
    assert set(frames) == {"base_link", "mast", "eye_link"}
    assert {frame.link for frame in frames.values()} == {"base_link"}
    assert numbers(frames["mast"].pose_in_link) == near(Pose((0, 0, 1), (0, 0, QUARTER)))


def test_a_live_scene_goes_through_json() -> None:
    text = f'<robot name="r">{BODY}{SENSOR.format("eye_link", "<camera><image/></camera>")}</robot>'
    written, _ = read_urdf(text, file=None)
    assert written is not None
    lumped, _ = lump(written)
    scene = LiveScene(
        scene=Scene(world=World(name="w"), robots=(SpawnedRobot(entity="r", robot=lumped),)),
        simulator="gz",
        devices={"r": read_devices(text, written, lumped)},
        world_devices=Devices(),
        descriptions={"r": text},
    )
    assert decode(json.loads(encode(scene)), LiveScene) == scene
