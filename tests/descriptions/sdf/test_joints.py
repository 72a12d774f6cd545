"""Joints of SDF: types, axes, limits, and what holds in no tree."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.diagnostics import Severity
from wsgen.model.robot import Joint, JointLimit, JointType, Mimic

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.descriptions.sdf.models import SdfFile

    Read = Callable[..., SdfFile]

MASS = "<inertial><mass>2</mass></inertial>"
HALF = math.sqrt(0.5)
LINKS = (
    f'<link name="a">{MASS}</link>'
    f'<link name="b">{MASS}<pose>1 0 0 0 0 1.5707963267948966</pose></link>'
)


def joint(content: str = "", kind: str = "revolute", *, name: str = "j", ends: str = "ab") -> str:
    parent, child = ends[0], ends[1]
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        f"{content}</joint>"
    )


def first_joint(file: SdfFile) -> Joint:
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    return robot.joints[0]


@pytest.mark.parametrize(
    ("kind", "axis", "expected"),
    [
        ("fixed", "", JointType.FIXED),
        ("continuous", "<axis/>", JointType.CONTINUOUS),
        ("prismatic", "<axis/>", JointType.PRISMATIC),
        ("revolute", "", JointType.CONTINUOUS),
        ("revolute", "<axis/>", JointType.CONTINUOUS),
        (
            "revolute",
            "<axis><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis>",
            JointType.CONTINUOUS,
        ),
        (
            "revolute",
            "<axis><limit><lower>-inf</lower><upper>inf</upper></limit></axis>",
            JointType.CONTINUOUS,
        ),
        (
            "revolute",
            "<axis><limit><lower>-1</lower><upper>1</upper></limit></axis>",
            JointType.REVOLUTE,
        ),
        ("revolute", "<axis><limit><upper>1</upper></limit></axis>", JointType.REVOLUTE),
    ],
)
def test_types(read: Read, kind: str, axis: str, expected: JointType) -> None:
    found = first_joint(read(f'<model name="m">{LINKS}{joint(axis, kind)}</model>'))
    assert found.type is expected
    assert (found.limit is not None) is (expected is JointType.REVOLUTE)


@pytest.mark.parametrize("kind", ["universal", "revolute2"])
def test_two_axes_are_two_joints_with_a_cross_between(read: Read, kind: str) -> None:
    axes = (
        "<axis><limit><lower>-0.5</lower><upper>0.5</upper></limit></axis>"
        "<axis2><xyz>0 1 0</xyz><dynamics><damping>2</damping></dynamics></axis2>"
    )
    file = read(f'<model name="m">{LINKS}{joint(axes, kind)}</model>')
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    first, second = robot.joints
    assert (first.name, first.parent, first.child) == ("j", "a", "j (cross)")
    assert (second.name, second.parent, second.child) == ("j (axis2)", "j (cross)", "b")
    assert (first.type, second.type) == (JointType.REVOLUTE, JointType.CONTINUOUS)
    assert (first.axis_in_joint, second.axis_in_joint) == ((0, 0, 1), (0, 1, 0))
    assert (first.damping, second.damping) == (0, 2)
    whole = read(f'<model name="m">{LINKS}{joint(axes, "ball")}</model>').models[0].robot
    assert whole is not None
    assert robot.mass == pytest.approx(whole.mass, abs=1e-5)
    assert not robot.loose


@pytest.mark.parametrize("kind", ["screw", "gearbox"])
def test_types_that_no_engine_has(read: Read, kind: str) -> None:
    file = read(f'<model name="m">{LINKS}{joint("", kind)}</model>')
    (found,) = file.diagnostics
    assert (found.code, found.severity) == ("WLD024", Severity.WARNING)
    assert kind in found.message
    assert "`b` is loose" in found.message
    robot = file.models[0].robot
    assert robot is not None
    assert (robot.joints, robot.loose[0].child) == ((), "b")


def test_a_ball_has_neither_axis_nor_limits(read: Read) -> None:
    axis = "<axis><xyz>0 0 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>"
    found = first_joint(read(f'<model name="m">{LINKS}{joint(axis, "ball")}</model>'))
    assert (found.type, found.limit, found.damping) == (JointType.BALL, None, 0.0)


def test_axis_limits_and_dynamics(read: Read) -> None:
    found = first_joint(
        read(
            f'<model name="m">{LINKS}'
            + joint(
                "<axis><xyz>0 3 4</xyz><limit><lower>-1</lower><upper>2</upper><effort>5</effort>"
                "<velocity>-1</velocity></limit><dynamics><damping>0.1</damping>"
                "<friction>0.2</friction><spring_stiffness>3</spring_stiffness>"
                "<spring_reference>0.4</spring_reference></dynamics></axis>"
            )
            + "</model>"
        )
    )
    assert found.axis_in_joint == pytest.approx((0, 0.6, 0.8))
    assert found.limit == JointLimit(lower=-1, upper=2, effort=5, velocity=1e16)
    assert (found.damping, found.friction) == (0.1, 0.2)
    assert (found.spring_stiffness, found.spring_reference) == (3, 0.4)


# The link b is turned a quarter about z: what is x to the model is -y to it.
@pytest.mark.parametrize(
    ("version", "axis", "expected"),
    [
        ("1.9", "<xyz>1 0 0</xyz>", (1, 0, 0)),
        ("1.9", '<xyz expressed_in="__model__">1 0 0</xyz>', (0, -1, 0)),
        ("1.9", '<xyz expressed_in="a">1 0 0</xyz>', (0, -1, 0)),
        ("1.9", '<xyz expressed_in="tilted">1 0 0</xyz>', (HALF, -HALF, 0)),
        ("1.9", "<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>", (1, 0, 0)),
        ("1.6", "<xyz>1 0 0</xyz>", (1, 0, 0)),
        ("1.6", "<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>", (0, -1, 0)),
        ("1.5", "<xyz>1 0 0</xyz><use_parent_model_frame>0</use_parent_model_frame>", (1, 0, 0)),
        ("1.4", "<xyz>1 0 0</xyz>", (0, -1, 0)),
        ("1.9", "", (0, 0, 1)),
    ],
)
def test_axis_frames(
    read: Read, version: str, axis: str, expected: tuple[float, float, float]
) -> None:
    tilted = '<frame name="tilted"><pose>0 0 0 0 0 0.7853981633974483</pose></frame>'
    content = f"{LINKS}{tilted}{joint(f'<axis>{axis}</axis>')}"
    found = first_joint(read(f'<model name="m">{content}</model>', version))
    assert found.axis_in_joint == pytest.approx(expected, abs=1e-12)


def test_mimic(read: Read) -> None:
    file = read(
        f'<model name="m"><model name="n">{LINKS}<link name="c">{MASS}</link>'
        + joint("<axis/>", name="leader")
        + joint(
            '<axis><mimic joint="leader" axis="axis"><multiplier>2</multiplier><offset>1</offset>'
            "<reference>3</reference></mimic></axis>",
            name="follower",
            ends="ac",
        )
        + "</model></model>",
        "1.11",
    )
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    assert robot.joints[1].mimic == Mimic(joint="n::leader", multiplier=2, offset=-5)


def test_joints_that_mimic_each_other(read: Read) -> None:
    mimic = '<axis><mimic joint="{}"/></axis>'
    file = read(
        f'<model name="m">{LINKS}<link name="c">{MASS}</link>\n'
        + joint(mimic.format("k"))
        + "\n"
        + joint(mimic.format("j"), name="k", ends="ac")
        + "</model>",
        "1.11",
    )
    assert [(found.code, found.line) for found in file.diagnostics] == [("WLD028", 4)]
    robot = file.models[0].robot
    assert robot is not None
    assert [one.mimic is None for one in robot.joints] == [False, True]


def test_lower_limit_above_the_upper_one(read: Read) -> None:
    content = joint("<axis><limit><lower>2</lower><upper>-1</upper></limit></axis>")
    file = read(f'<model name="m">{LINKS}{content}</model>')
    assert [found.code for found in file.diagnostics] == ["ROB023"]
    robot = file.models[0].robot
    assert robot is not None
    limit = robot.joints[0].limit
    assert limit is not None
    assert (limit.lower, limit.upper) == (-1, 2)


@pytest.mark.parametrize(
    "second", [joint(kind="fixed", name="k"), joint(kind="fixed", name="k", ends="ba")]
)
def test_a_chain_that_is_closed(read: Read, second: str) -> None:
    file = read(f'<model name="m">{LINKS}{joint(kind="fixed")}{second}</model>')
    (found,) = file.diagnostics
    assert (found.code, found.severity) == ("WLD025", Severity.WARNING)
    assert "`k`" in found.message
    robot = file.models[0].robot
    assert robot is not None
    assert [one.name for one in robot.joints] == ["j"]
    assert (robot.root, robot.loose) == ("a", ())


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (joint("", "hinge"), "ROB015"),
        (joint("").replace(' type="revolute"', ""), "ROB015"),
        (joint(ends="ax"), "ROB013"),
        (joint(ends="xb"), "ROB013"),
        (joint().replace("<child>b</child>", ""), "WLD021"),
        (joint().replace("<child>b</child>", "<child>world</child>"), "ROB013"),
        (joint(ends="aa"), "ROB012"),
        (joint("<axis><xyz>0 0 0</xyz></axis>"), "ROB018"),
        (joint("<axis><xyz>1.7e308 1.7e308 1</xyz></axis>"), "ROB018"),
        (joint("<axis><xyz>0 0</xyz></axis>"), "ROB016"),
        (joint("<axis><limit><lower>low</lower></limit></axis>"), "ROB016"),
        (joint('<axis><xyz expressed_in="x">0 0 1</xyz></axis>'), "WLD016"),
        (joint('<axis><mimic joint="gone"/></axis>'), "ROB035"),
        (joint('<axis><mimic joint="j"/></axis>'), "WLD028"),
        (joint('<axis><mimic joint="a"/></axis>'), "ROB035"),
    ],
)
def test_what_is_wrong_with_a_joint(read: Read, content: str, code: str) -> None:
    file = read(f'<model name="m">{LINKS}\n{content}</model>')
    assert [(found.code, found.line) for found in file.diagnostics] == [(code, 3)]
    (found,) = file.diagnostics
    assert found.severity is Severity.ERROR
    assert found.hint
    assert found.element is not None
    assert found.element.startswith("/sdf/model[@name='m']/joint[@name='j']")


def test_the_nearest_name_is_proposed(read: Read) -> None:
    content = f'<link name="wheel">{MASS}</link>' + joint().replace(">b<", ">whel<")
    (found,) = read(f'<model name="m">{LINKS}{content}</model>').diagnostics
    assert found.hint == "Did you mean `wheel`?"
