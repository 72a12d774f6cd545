"""The joint states that nobody measured."""

from __future__ import annotations

import math

import pytest

from wsgen.live.nodes.joint_frames import (
    Dependence,
    DependenceError,
    PublishedJoints,
    Settings,
    numbers,
    read_dependences,
    soft_limits,
)


def joint(name: str, kind: str, child: str, rest: str = "") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="base"/><child link="{child}"/>{rest}'
        "</joint>"
    )


def limit(lower: float, upper: float) -> str:
    return f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'


def robot(*joints: str) -> str:
    links = "".join(f'<link name="{name}"/>' for name in ("base", *"abcd"[: len(joints)]))
    return f'<robot name="r">{links}{"".join(joints)}</robot>'


ARM = robot(
    joint("wheel", "continuous", "a"),
    joint("arm", "revolute", "b", limit(0.5, 1.5)),
    joint("copy", "revolute", "c", limit(-9, 9) + '<mimic joint="arm" multiplier="2" offset="1"/>'),
    joint("weld", "fixed", "d"),
)


def published(text: str, settings: Settings | None = None) -> PublishedJoints:
    said: list[str] = []
    found = PublishedJoints(settings or Settings(), said.append)
    found.configure(text)
    assert said == []
    return found


def test_zero_or_the_middle_of_the_limits() -> None:
    states = published(ARM).states()
    assert states.names == ["wheel", "arm", "copy"]
    assert states.positions == [0.0, 1.0, 3.0]
    assert (states.velocities, states.efforts) == ([], [])


def test_zeros_and_velocities_and_efforts_may_be_asked_for() -> None:
    settings = Settings(zeros={"arm": 0.75}, publish_velocities=True, publish_efforts=True)
    states = published(ARM, settings).states()
    assert states.positions == [0.0, 0.75, 2.5]
    assert (states.velocities, states.efforts) == ([0.0] * 3, [0.0] * 3)


def test_a_source_moves_joints_and_those_that_depend_on_them() -> None:
    joints = published(ARM)
    joints.take(["arm", "nobody", "copy"], [1.25, 7.0, 9.0], [0.5], [])
    states = joints.states()
    assert states.positions == [0.0, 1.25, 3.5]
    assert states.velocities == [0.0, 0.5, 1.0]
    assert states.efforts == []


def test_dependent_joints_of_parameters() -> None:
    dependences = read_dependences({"wheel.parent": "arm", "wheel.factor": -1, "wheel.offset": 4.0})
    assert dependences == {"wheel": Dependence("arm", -1.0, 4.0)}
    assert published(ARM, Settings(dependences=dependences)).states().positions == [3.0, 1.0, 3.0]


@pytest.mark.parametrize(
    "parameters",
    [{"a.b.c": 1}, {"a": 1}, {"a.slope": 1}, {"a.factor": 1}, {"a.parent": "b", "a.factor": "x"}],
)
def test_other_parameters_are_refused(parameters: dict[str, object]) -> None:
    with pytest.raises(DependenceError):
        read_dependences(parameters)


def test_zeros_are_numbers() -> None:
    assert numbers({"a": 1, "b": 0.5}, "zeros") == {"a": 1.0, "b": 0.5}
    with pytest.raises(DependenceError, match=r"zeros\.a"):
        numbers({"a": "up"}, "zeros")


def test_a_chain_is_followed_and_a_circle_is_refused() -> None:
    chain = robot(
        joint("a", "revolute", "a", limit(-1, 1)),
        joint("b", "revolute", "b", limit(-1, 1) + '<mimic joint="a" multiplier="2" offset="1"/>'),
        joint("c", "revolute", "c", limit(-1, 1) + '<mimic joint="b" multiplier="3" offset="1"/>'),
    )
    joints = published(chain)
    joints.take(["a"], [0.5], [], [])
    assert joints.states().positions == [0.5, 2.0, 7.0]
    dependences = {"a": Dependence("c")}
    with pytest.raises(DependenceError, match="infinite recursive mimic chain"):
        published(chain, Settings(dependences=dependences))
    with pytest.raises(DependenceError, match="`nobody`"):
        published(chain, Settings(dependences={"a": Dependence("nobody")}))


def test_delta_moves_joints_back_and_forth() -> None:
    joints = published(ARM)
    positions = []
    for _ in range(6):
        joints.move(0.25)
        positions.append(joints.states().positions[1])
    assert positions == [1.25, 1.5, 1.5, 1.25, 1.0, 0.75]
    for _ in range(20):
        joints.move(0.25)
    assert -math.pi <= joints.states().positions[0] <= math.pi


def test_soft_limits_are_narrower() -> None:
    text = robot(
        joint(
            "arm",
            "revolute",
            "a",
            limit(-1, 1)
            + '<safety_controller k_velocity="1" soft_lower_limit="0.2" soft_upper_limit="0.6"/>',
        )
    )
    assert soft_limits(text) == {"arm": (0.2, 0.6)}
    assert published(text).states().positions == pytest.approx([0.4])
    wide = Settings(use_smallest_limits=False)
    assert published(text, wide).states().positions == [0.0]


def test_what_is_no_robot_is_ignored() -> None:
    said: list[str] = []
    joints = PublishedJoints(Settings(), said.append)
    joints.configure("<robot")
    assert said == ["Invalid robot_description given, ignoring"]
    assert joints.states().names == []


def test_joints_of_sdf() -> None:
    warnings: list[str] = []
    joints = PublishedJoints(Settings(), warnings.append)
    joints.configure(
        '<sdf version="1.9"><model name="r"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="turn" type="revolute"><parent>a</parent><child>b</child><axis>'
        "<xyz>0 0 1</xyz><limit><lower>0.5</lower><upper>1.5</upper></limit></axis></joint>"
        '<joint name="hold" type="fixed"><parent>a</parent><child>c</child></joint></model></sdf>'
    )
    assert not warnings
    assert joints.states().names == ["turn"]
    assert joints.states().positions == [1.0]
