"""Models of SDF as robots: the frames are where URDF has them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.model.kinematics import split_trees
from wsgen.model.robot import Box, Inertial, JointType, Plugin, Sensor
from wsgen.model.transform import IDENTITY, Pose

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.descriptions.sdf.models import SdfFile, SdfModel
    from wsgen.model.robot import Robot

    Read = Callable[..., SdfFile]

BOX = "<geometry><box><size>1 2 3</size></box></geometry>"
MASS = "<inertial><mass>2</mass></inertial>"
QUARTER = math.pi / 2


def only(file: SdfFile) -> SdfModel:
    assert file.diagnostics == ()
    (model,) = file.models
    return model


def robot_of(file: SdfFile) -> Robot:
    robot = only(file).robot
    assert robot is not None
    return robot


def link(name: str, content: str = "") -> str:
    return f'<link name="{name}">{MASS}{content}</link>'


def joint(name: str, parent: str, child: str, content: str = "", kind: str = "fixed") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        f"{content}</joint>"
    )


def near(pose: Pose) -> object:
    return pytest.approx((*pose.xyz, *pose.rpy), abs=1e-12)


def numbers(pose: Pose) -> tuple[float, ...]:
    return (*pose.xyz, *pose.rpy)


def test_one_link(read: Read) -> None:
    model = only(
        read(
            '<model name="crate"><pose>1 2 3 0 0 0.5</pose>\n'
            f'<link name="body"><pose>0 0 1 0 0 0</pose>{MASS}'
            f'<collision name="c">{BOX}</collision></link></model>'
        )
    )
    assert (model.name, model.is_static, model.line) == ("crate", False, 2)
    assert numbers(model.pose_in_world) == near(Pose((1, 2, 4), (0, 0, 0.5)))
    assert model.robot is not None
    assert model.robot.root == "body"
    body = model.robot.link("body")
    assert body.collisions[0].geometry == Box(size=(1, 2, 3))
    assert body.collisions[0].pose_in_link == IDENTITY
    assert body.inertial == Inertial(mass=2, inertia=(1, 0, 0, 1, 0, 1))


def test_a_link_is_seen_from_the_joint_above_it(read: Read) -> None:
    robot = robot_of(
        read(
            '<model name="m">'
            + link("base", "<pose>0 0 1 0 0 0</pose>")
            + '<link name="arm"><pose>1 0 1 0 0 0</pose><inertial><pose>0.1 0 0 0 0 0</pose>'
            f'<mass>1</mass></inertial><collision name="c"><pose>0 0 0.2 0 0 0</pose>{BOX}'
            f'</collision><visual name="v">{BOX}</visual></link>'
            + joint("j", "base", "arm", "<pose>-0.5 0 0 0 0 1.5707963267948966</pose>")
            + "</model>"
        )
    )
    (hinge,) = robot.joints
    assert numbers(hinge.pose_in_parent) == near(Pose((0.5, 0, 0), (0, 0, QUARTER)))
    arm = robot.link("arm")
    assert arm.inertial is not None
    turned = (0, 0, -QUARTER)
    assert numbers(arm.inertial.pose_in_link) == near(Pose((0, -0.6, 0), turned))
    assert numbers(arm.collisions[0].pose_in_link) == near(Pose((0, -0.5, 0.2), turned))
    assert numbers(arm.visuals[0].pose_in_link) == near(Pose((0, -0.5, 0), turned))
    assert robot.link("base").inertial == Inertial(mass=2, inertia=(1, 0, 0, 1, 0, 1))


def test_a_joint_without_pose_is_at_its_child(read: Read) -> None:
    robot = robot_of(
        read(
            f'<model name="m">{link("a")}{link("b", "<pose>0 0 2 0.1 0 0</pose>")}'
            f"{joint('j', 'a', 'b')}</model>"
        )
    )
    assert robot.joints[0].pose_in_parent == Pose((0, 0, 2), (0.1, 0, 0))


def test_a_joint_to_the_world(read: Read) -> None:
    model = only(
        read(
            '<model name="m"><pose>5 0 0 0 0 0</pose>'
            + link("arm", "<pose>0 0 1 0 0 0</pose>")
            + link("stray", "<pose>0 3 0 0 0 0</pose>")
            + joint("pin", "world", "arm")
            + "</model>"
        )
    )
    robot = model.robot
    assert robot is not None
    assert (robot.root, robot.fixed_to_world) == ("world", True)
    assert robot.link("world").inertial is None
    assert [(one.parent, one.child) for one in robot.joints] == [("world", "arm")]
    assert model.pose_in_world == Pose((5, 0, 0))  # so that it can be spawned elsewhere
    assert robot.joints[0].pose_in_parent == Pose((0, 0, 1))
    (stray,) = robot.loose
    assert (stray.type, stray.parent, stray.child) == (JointType.FLOATING, "world", "stray")
    assert stray.pose_in_parent == Pose((0, 3, 0))


def test_several_trees(read: Read) -> None:
    robot = robot_of(
        read(
            '<model name="m" canonical_link="c">'
            + link("a")
            + link("b", "<pose>1 0 0 0 0 0</pose>")
            + link("c", "<pose>1 1 0 0 0 0</pose>")
            + joint("j", "b", "c")
            + "</model>"
        )
    )
    assert robot.root == "b"  # of the tree that the model moves with
    trees = split_trees(robot)
    assert [(tree.root, len(tree.links), pose.xyz) for tree, pose in trees] == [
        ("b", 2, (0, 0, 0)),
        ("a", 1, (-1, 0, 0)),
    ]


def test_models_in_models(read: Read) -> None:
    robot = robot_of(
        read(
            '<model name="m">'
            + link("base")
            + '<model name="hand"><pose relative_to="base">0 0 1 0 0 0</pose>'
            + link("palm", "<pose>0 0 0.5 0 0 0</pose>")
            + link("finger", '<pose relative_to="palm">0.1 0 0 0 0 0</pose>')
            + joint("knuckle", "palm", "finger")
            + "</model>"
            + joint("wrist", "base", "hand::palm")
            + "</model>"
        )
    )
    assert [one.name for one in robot.links] == ["base", "hand::palm", "hand::finger"]
    assert {one.name: one.pose_in_parent.xyz for one in robot.joints} == {
        "wrist": (0, 0, 1.5),
        "hand::knuckle": (0.1, 0, 0),
    }
    assert robot.loose == ()


def test_static_counts_for_models_inside(read: Read) -> None:
    model = only(
        read(
            f'<model name="m"><static>true</static>{link("a")}'
            '<model name="n"><link name="weightless"/></model></model>'
        )
    )
    assert model.is_static
    assert model.robot is not None
    assert model.robot.is_static


def test_flags_and_tags(read: Read) -> None:
    robot = robot_of(
        read(
            '<model name="m"><self_collide>true</self_collide>'
            '<plugin filename="libdrive.so" name="p"><left> l </left></plugin>'
            '<link name="a"><gravity>0</gravity><self_collide>0</self_collide>'
            f"{MASS}<velocity_decay><linear>0.1</linear></velocity_decay>"
            '<sensor name="eye" type="camera"/></link>' + link("b") + "</model>"
        )
    )
    a, b = robot.links
    assert (a.gravity, a.self_collide, a.velocity_decay) == (False, False, (0.1, 0.0))
    assert (b.gravity, b.self_collide, b.velocity_decay) == (True, True, (0.0, 0.0))
    assert [tag.plugins[:1] for tag in robot.gazebo] == [
        (Plugin("libdrive.so", {"left": ("l",)}, "p", 2),),
        (),
    ]
    assert [(tag.reference, tag.sensors) for tag in robot.gazebo[1:]] == [
        ("a", (Sensor("eye", "camera", line=2),))
    ]


def test_a_world_with_models(read: Read) -> None:
    file = read(
        '<world name="yard"><gravity>0 0 -1.6</gravity>'
        "<include><uri>model://sun</uri></include>"
        "<include><uri>model://ground_plane</uri></include>"
        f'<model name="a"><pose>1 0 0 0 0 0</pose>{link("l")}</model>'
        '<model name="b"><pose relative_to="a">0 1 0 0 0 0</pose><static>1</static>'
        f"{link('l')}</model></world>"
    )
    assert file.diagnostics == ()
    assert file.world is not None
    assert (file.world.name, file.world.gravity) == ("yard", (0, 0, -1.6))
    assert file.world.has_ground_plane
    assert [(one.name, one.pose_in_world.xyz) for one in file.world.models] == [
        ("ground_plane", (0, 0, 0)),
        ("a", (1, 0, 0)),
        ("b", (1, 1, 0)),
    ]
    assert [(one.name, one.is_static, one.pose_in_world.xyz) for one in file.models] == [
        ("a", False, (1, 0, 0)),
        ("b", True, (1, 1, 0)),
    ]


def test_something_static_carries_as_well_as_a_ground(read: Read) -> None:
    floor = f'<static>1</static><link name="l"><collision name="c">{BOX}</collision></link>'
    file = read(f'<world name="w"><model name="floor">{floor}</model></world>')
    assert file.diagnostics == ()
    assert file.world is not None
    assert not file.world.has_ground_plane
