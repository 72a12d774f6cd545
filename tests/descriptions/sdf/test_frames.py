"""Where frames are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.descriptions.sdf.models import SdfFile

    Read = Callable[..., SdfFile]

MASS = "<inertial><mass>2</mass></inertial>"
QUARTER = math.pi / 2


def root_pose(file: SdfFile) -> tuple[float, ...]:
    assert file.diagnostics == ()
    pose = file.models[-1].pose_in_world
    return (*pose.xyz, *pose.rpy)


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("<pose>1 2 3 0.1 0.2 0.3</pose>", (1, 2, 3, 0.1, 0.2, 0.3)),
        ('<pose degrees="true">0 0 0 0 0 90</pose>', (0, 0, 0, 0, 0, QUARTER)),
        ('<pose rotation_format="quat_xyzw">1 0 0 0 0 2 2</pose>', (1, 0, 0, 0, 0, QUARTER)),
        ("<pose/>", (0, 0, 0, 0, 0, 0)),
        ('<pose relative_to="__model__">0 1 0 0 0 0</pose>', (0, 1, 0, 0, 0, 0)),
        ('<pose relative_to="up">0 1 0 0 0 0</pose>', (0, 1, 1, 0, 0, 0)),
        ('<pose relative_to="turned">1 0 0 0 0 0</pose>', (0, 1, 2, 0, 0, QUARTER)),
        ('<pose relative_to="other">0 0 1 0 0 0</pose>', (7, 0, 1, 0, 0, 0)),
        ('<pose relative_to="j">0 0 1 0 0 0</pose>', (7, 0, 1.5, 0, 0, 0)),
        ('<pose relative_to="in::deep">1 0 0 0 0 0</pose>', (1, 0, 30, 0, 0, 0)),
        ('<pose relative_to="in">0 1 0 0 0 0</pose>', (0, 1, 10, 0, 0, 0)),
        ('<pose relative_to="in::__model__">0 1 0 0 0 0</pose>', (0, 1, 10, 0, 0, 0)),
    ],
)
def test_pose_of_a_link(read: Read, written: str, expected: tuple[float, ...]) -> None:
    model = (
        f'<model name="m" canonical_link="l"><link name="l">{MASS}{written}</link>'
        '<frame name="up"><pose>0 0 1 0 0 0</pose></frame>'
        '<frame name="turned" attached_to="up"><pose>0 0 1 0 0 1.5707963267948966</pose></frame>'
        f'<link name="other">{MASS}<pose>7 0 0 0 0 0</pose></link>'
        f'<link name="third">{MASS}</link>'
        '<joint name="j" type="fixed"><pose>0 0 0.5 0 0 0</pose><parent>third</parent>'
        "<child>other</child></joint>"
        '<model name="in"><pose>0 0 10 0 0 0</pose>'
        f'<link name="deep">{MASS}<pose>0 0 20 0 0 0</pose></link></model></model>'
    )
    assert root_pose(read(model)) == pytest.approx(expected, abs=1e-12)


def test_poses_of_nested_models(read: Read) -> None:
    text = f'<link name="l">{MASS}<pose>1 0 0 0 0 0</pose></link>'
    for name in "cba":
        text = f'<model name="{name}"><pose>1 0 0 0 0 {QUARTER}</pose>{text}</model>'
    assert root_pose(read(text)) == pytest.approx((0, 0, 0, 0, 0, -QUARTER), abs=1e-12)


def test_frame_of_a_pose_before_sdf_1_7(read: Read) -> None:
    model = (
        f'<model name="m" canonical_link="b"><link name="a">{MASS}<pose>1 0 0 0 0 0</pose></link>'
        f'<link name="b">{MASS}<pose frame="a">0 1 0 0 0 0</pose></link></model>'
    )
    assert root_pose(read(model, "1.6"))[:3] == (1, 1, 0)
    assert root_pose(read(model, "1.7"))[:3] == (0, 1, 0)  # there is no such attribute any more


def test_placement_frame(read: Read) -> None:
    model = (
        '<model name="m" placement_frame="foot"><pose>0 0 1 0 0 0</pose>'
        f'<link name="body">{MASS}<pose>0 0 2 0 0 0</pose></link>'
        '<frame name="foot"><pose>0.5 0 -1 0 0 0</pose></frame></model>'
    )
    assert root_pose(read(model))[:3] == (-0.5, 0, 4)


def test_frames_of_a_world(read: Read) -> None:
    world = (
        '<world name="w"><include><uri>model://ground_plane</uri></include>'
        '<frame name="corner"><pose>5 5 0 0 0 0</pose></frame>'
        f'<model name="a"><pose relative_to="corner">1 0 0 0 0 0</pose><link name="l">{MASS}'
        "<pose>0 0 1 0 0 0</pose></link></model>"
        f'<model name="b"><pose relative_to="a::l">0 1 0 0 0 0</pose><link name="l">{MASS}</link>'
        "</model></world>"
    )
    assert root_pose(read(world))[:3] == (6, 6, 1)


def test_a_joint_may_name_frames_and_models(read: Read) -> None:
    file = read(
        f'<model name="m"><link name="base">{MASS}</link>'
        '<frame name="socket" attached_to="base"/><frame name="alias" attached_to="socket"/>'
        f'<model name="hand"><link name="palm">{MASS}</link></model>'
        '<joint name="wrist" type="fixed"><parent>alias</parent><child>hand</child></joint></model>'
    )
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    assert [(joint.parent, joint.child) for joint in robot.joints] == [("base", "hand::palm")]


@pytest.mark.slow
def test_long_chains(read: Read) -> None:
    count = 3000
    links = "".join(
        f'<link name="l{i}">{MASS}<pose relative_to="l{i + 1}">0.5 0 0 0 0 0</pose></link>'
        for i in range(count)
    )
    file = read(f'<model name="m">{links}<link name="l{count}">{MASS}</link></model>')
    assert root_pose(file)[0] == count / 2


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ('<link name="l"><pose relative_to="nobody">0 0 0 0 0 0</pose></link>', "WLD016"),
        ('<link name="l"/><frame name="f" attached_to="nobody"/>', "WLD016"),
        ('<link name="l"><pose relative_to="world">0 0 0 0 0 0</pose></link>', "WLD016"),
        ('<link name="l"><pose relative_to="l">0 0 0 0 0 0</pose></link>', "WLD017"),
        (
            (
                '<link name="l"><pose relative_to="f"/></link>'
                '<frame name="f" attached_to="g"/><frame name="g" attached_to="l"/>'
            ),
            "WLD017",
        ),
        (
            (
                '<link name="l"/><link name="k"/><frame name="f" attached_to="g"><pose '
                'relative_to="l"/></frame><frame name="g" attached_to="f"><pose relative_to="l"/>'
                '</frame><joint name="j" type="fixed"><parent>l</parent><child>f</child></joint>'
            ),
            "WLD017",
        ),
        (
            '<link name="l"/><model name="n" placement_frame="gone"><link name="k"/></model>',
            "WLD016",
        ),
        (
            '<link name="l"/><model name="n" canonical_link="gone"><link name="k"/></model>',
            "WLD016",
        ),
    ],
)
def test_what_is_wrong_with_frames(read: Read, content: str, code: str) -> None:
    content = content.replace('<link name="l"/>', f'<link name="l">{MASS}</link>')
    content = content.replace('<link name="k"/>', f'<link name="k">{MASS}</link>')
    file = read(f'<model name="m"><static>1</static>\n{content}</model>')
    assert code in {found.code for found in file.diagnostics}
    assert all(found.line == 3 and found.hint for found in file.diagnostics)
    assert file.models[0].robot is not None
