"""Sliders for joints, and where positions of joints put links, compared with MuJoCo."""

from __future__ import annotations

import math

import pytest

from wsgen.model.robot import Joint, JointLimit, JointType, Link, Mimic, Robot
from wsgen.model.transform import IDENTITY, Pose
from wsgen.reporting.viewing.drawing import (
    DrawnLink,
    all_positions,
    link_places,
    place_in_parent,
    sliders,
)


def joint(name: str, kind: JointType = JointType.REVOLUTE, **values: object) -> Joint:
    given = {"parent": "a", "child": "b", "limit": JointLimit(lower=-1.0, upper=2.0), **values}
    return Joint(name=name, type=kind, **given)  # type: ignore[arg-type]


def robot(*joints: Joint) -> Robot:
    return Robot(name="r", root="a", links=(Link(name="a"), Link(name="b")), joints=joints)


def test_a_revolute_joint_has_a_slider_in_degrees_within_its_limits() -> None:
    (slider,) = sliders(robot(joint("j")))
    assert (slider.lower, slider.upper, slider.start, slider.unit) == (-1.0, 2.0, 0.0, "°")
    assert slider.range_shown == (-57.3, 114.6)  # rounded outwards
    assert slider.position(114.6) == 2.0  # and back to the limit
    assert slider.position(90.0) == pytest.approx(math.pi / 2)


def test_a_sliding_joint_has_a_slider_in_meters() -> None:
    limit = JointLimit(lower=0.0, upper=0.04)
    (slider,) = sliders(robot(joint("j", JointType.PRISMATIC, limit=limit)))
    assert (slider.unit, slider.range_shown, slider.step) == ("m", (0.0, 0.04), 1e-4)


def test_a_continuous_joint_turns_once_and_so_does_one_with_endless_limits() -> None:
    endless = JointLimit(lower=-1e16, upper=1e16)
    found = sliders(robot(joint("c", JointType.CONTINUOUS), joint("e", limit=endless)))
    for slider in found:
        assert (slider.lower, slider.upper) == (-math.pi, math.pi)
        assert slider.is_endless


@pytest.mark.parametrize(
    ("lower", "upper", "shown", "start"),
    [
        (0.5, 1.5, (0.5, 1.5), 1.0),  # as joint_state_publisher_gui: the middle
        (0.0, 0.0, (0.0, 0.0), 0.0),
        (1.0, -1.0, (-1.0, 1.0), 0.0),
        (math.nan, 1.0, (-10.0, 1.0), 0.0),
        (-math.inf, math.inf, (-10.0, 10.0), 0.0),
        (1e9, 2e9, (10.0, 1e9), None),
    ],
)
def test_limits_that_are_none_give_a_slider_all_the_same(
    lower: float, upper: float, shown: tuple[float, float], start: float | None
) -> None:
    limit = JointLimit(lower=lower, upper=upper)
    (slider,) = sliders(robot(joint("j", JointType.PRISMATIC, limit=limit)))
    assert (slider.lower, slider.upper) == shown
    low, high = slider.range_shown
    assert low <= slider.lower <= slider.start <= slider.upper <= high
    assert start is None or slider.start == start


def test_joints_that_mimic_follow_through_a_chain() -> None:
    found = robot(
        joint("leader"),
        joint("half", mimic=Mimic(joint="leader", multiplier=0.5, offset=0.1)),
        joint("back", mimic=Mimic(joint="half", multiplier=-2.0, offset=1.0)),
    )
    assert [slider.joint for slider in sliders(found)] == ["leader"]
    assert sliders(found)[0].followers == ("half",)
    positions = all_positions(found, {"leader": 0.8})
    assert positions["half"] == pytest.approx(0.5)
    assert positions["back"] == pytest.approx(0.0)


def test_a_circle_of_mimics_and_a_missing_leader_do_no_harm() -> None:
    found = robot(
        joint("a", mimic=Mimic(joint="b")),
        joint("b", mimic=Mimic(joint="a")),
        joint("c", mimic=Mimic(joint="nobody")),
    )
    assert [slider.joint for slider in sliders(found)] == ["c"]
    assert all_positions(found, {"c": 0.3}) == {"a": 0.0, "b": 0.0, "c": 0.3}


def test_a_joint_turns_about_its_axis_seen_from_its_child() -> None:
    turned = joint(
        "j", pose_in_parent=Pose((1.0, 2.0, 3.0), (0.0, 0.0, math.pi / 2)), axis_in_joint=(0, 2, 0)
    )
    origin, (w, x, y, z) = place_in_parent(turned, math.pi / 2)
    assert origin == (1.0, 2.0, 3.0)
    half = math.sqrt(0.5)
    # About z by 90 degrees, then about its own y by 90 degrees.
    assert (w, x, y, z) == pytest.approx((half * half, -half * half, half * half, half * half))


def test_a_sliding_joint_moves_along_its_axis() -> None:
    along = joint(
        "j",
        JointType.PRISMATIC,
        pose_in_parent=Pose((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2)),
        axis_in_joint=(1, 0, 0),
    )
    origin, _ = place_in_parent(along, 0.25)
    assert origin == pytest.approx((1.0, 0.25, 0.0))


@pytest.mark.parametrize("axis", [(0.0, 0.0, 0.0), (math.nan, 0.0, 1.0)])
def test_a_joint_without_an_axis_stays(axis: tuple[float, float, float]) -> None:
    origin, orientation = place_in_parent(joint("j", axis_in_joint=axis), 1.0)
    assert (origin, orientation) == ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


def test_links_are_where_an_engine_has_them() -> None:
    mujoco = pytest.importorskip("mujoco")
    joints = (
        joint(
            "one", pose_in_parent=Pose((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)), axis_in_joint=(1, 2, 3)
        ),
        joint(
            "two",
            JointType.PRISMATIC,
            parent="b",
            child="c",
            pose_in_parent=Pose((0.3, -0.1, 0.2), (-0.7, 0.2, 1.1)),
            axis_in_joint=(0, 1, -1),
        ),
    )
    links = tuple(Link(name=name) for name in "abc")
    found = Robot(name="r", root="a", links=links, joints=joints)
    drawn = (
        DrawnLink(name="a", parent=None),
        DrawnLink(name="b", parent=0, joint=joints[0]),
        DrawnLink(name="c", parent=1, joint=joints[1]),
    )
    places = link_places(drawn, found, {"one": 0.7, "two": 0.4}, IDENTITY)
    inertial = (
        '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        "</inertial>"
    )
    model = mujoco.MjModel.from_xml_string(f"""
        <robot name="r"><mujoco><compiler discardvisual="false" fusestatic="false"/></mujoco>
        <link name="a">{inertial}</link><link name="b">{inertial}</link>
        <link name="c">{inertial}</link>
        <joint name="one" type="revolute"><parent link="a"/><child link="b"/>
          <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><axis xyz="1 2 3"/>
          <limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
        <joint name="two" type="prismatic"><parent link="b"/><child link="c"/>
          <origin xyz="0.3 -0.1 0.2" rpy="-0.7 0.2 1.1"/><axis xyz="0 1 -1"/>
          <limit lower="-1" upper="2" effort="1" velocity="1"/></joint></robot>""")
    data = mujoco.MjData(model)
    data.qpos[:] = (0.7, 0.4)
    mujoco.mj_kinematics(model, data)
    for number, name in ((1, "b"), (2, "c")):
        body = data.body(name)
        assert places[number][:, 3] == pytest.approx(body.xpos, abs=1e-9)
        assert places[number][:, :3].ravel() == pytest.approx(body.xmat, abs=1e-9)
