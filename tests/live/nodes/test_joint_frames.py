"""Where joints put links, as PyBullet computes it from the same text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from wsgen.live.nodes.joint_frames import RefusedDescriptionError, read_joint_frames

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

LINKS = "".join(f'<link name="{name}"/>' for name in ("base", "arm", "hand", "slide", "eye", "pad"))
LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'


def joint(name: str, kind: str, parent: str, child: str, rest: str) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{rest}</joint>"
    )


ROBOT = (
    f'<robot name="r">{LINKS}'
    + joint(
        "shoulder",
        "revolute",
        "base",
        "arm",
        f'<origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/><axis xyz="0 0.6 0.8"/>{LIMIT}',
    )
    + joint(
        "wrist",
        "continuous",
        "arm",
        "hand",
        '<origin xyz="0 0.5 0" rpy="1.5707963 0 -3"/><axis xyz="3 0 4"/>',
    )
    + joint(
        "finger",
        "prismatic",
        "hand",
        "slide",
        f'<origin xyz="0 0 0.1" rpy="0 1.2 0"/><axis xyz="0.6 0.8 0"/>{LIMIT}'
        '<mimic joint="shoulder" multiplier="-0.5" offset="0.25"/>',
    )
    + joint("mount", "fixed", "arm", "eye", '<origin xyz="0 0 1" rpy="0 0 1"/>')
    + joint("skate", "planar", "base", "pad", '<origin xyz="7 0 0"/>')
    + "</robot>"
)


def placed(positions: dict[str, float]) -> dict[str, NDArray[np.float64]]:
    """Each link in the base: a product of the transforms that are sent."""
    _, frames = read_joint_frames(ROBOT)
    everything = frames.positions(positions, positions.values())
    sent = {joint.child: (joint.parent, joint.at(0.0)) for joint in frames.fixed}
    for name, frame in frames.moving.items():
        sent[frame.child] = (frame.parent, frame.at(everything[name]))
    found = {"base": np.eye(4)}
    while len(found) < len(sent) + 1:
        for child, (parent, (xyz, xyzw)) in sent.items():
            if parent in found and child not in found:
                step = np.eye(4)
                step[:3, :3], step[:3, 3] = Rotation.from_quat(xyzw).as_matrix(), xyz
                found[child] = found[parent] @ step
    return found


@pytest.mark.parametrize(("shoulder", "wrist"), [(0.0, 0.0), (0.7, -2.5), (-1.9, 40.0)])
def test_frames_are_the_link_poses_of_pybullet(
    shoulder: float, wrist: float, tmp_path: Path
) -> None:
    pybullet = pytest.importorskip("pybullet")
    file = tmp_path / "robot.urdf"
    file.write_text(ROBOT.replace('type="planar"', 'type="fixed"'))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(file), useFixedBase=True, physicsClientId=client)
        wanted = {"shoulder": shoulder, "wrist": wrist, "finger": -0.5 * shoulder + 0.25}
        links = {}
        for index in range(pybullet.getNumJoints(body, physicsClientId=client)):
            info = pybullet.getJointInfo(body, index, physicsClientId=client)
            links[info[12].decode()] = index
            pybullet.resetJointState(
                body, index, wanted.get(info[1].decode(), 0.0), physicsClientId=client
            )
        found = placed({"shoulder": shoulder, "wrist": wrist})
        for name, index in links.items():
            state = pybullet.getLinkState(
                body, index, computeForwardKinematics=True, physicsClientId=client
            )
            np.testing.assert_allclose(found[name][:3, 3], state[4], atol=1e-6)
            turn = Rotation.from_matrix(found[name][:3, :3]).inv() * Rotation.from_quat(state[5])
            assert turn.magnitude() < 1e-5
    finally:
        pybullet.disconnect(client)


@pytest.mark.slow
@settings(max_examples=30)
@given(st.floats(-50, 50))
def test_rotations_are_of_unit_length(position: float) -> None:
    _, frames = read_joint_frames(ROBOT)
    for frame in frames.moving.values():
        assert math.isclose(math.hypot(*frame.at(position)[1]), 1.0, rel_tol=1e-12)


def test_an_axis_has_no_length() -> None:
    """KDL divides by it, PyBullet does not."""
    _, frames = read_joint_frames(ROBOT)
    _, scaled = read_joint_frames(ROBOT.replace("0.6 0.8 0", "3 4 0"))
    assert scaled.moving["finger"].at(0.5)[0] == pytest.approx(frames.moving["finger"].at(0.5)[0])


def test_what_is_sent_wins_over_what_is_mimicked() -> None:
    _, frames = read_joint_frames(ROBOT)
    assert frames.positions(["shoulder"], [1.0]) == {"shoulder": 1.0, "finger": -0.25}
    assert frames.positions(["finger", "shoulder"], [9.0, 1.0]) == {"finger": 9.0, "shoulder": 1.0}
    assert frames.positions(["wrist"], [1.0]) == {"wrist": 1.0}


def test_a_planar_joint_is_fixed_and_a_floating_one_is_left_out() -> None:
    _, frames = read_joint_frames(ROBOT)
    assert {frame.child for frame in frames.fixed} == {"eye", "pad"}
    _, frames = read_joint_frames(ROBOT.replace('type="planar"', 'type="floating"'))
    assert {frame.child for frame in frames.fixed} == {"eye"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "well-formed"),
        ("<robot", "well-formed"),
        ("<model/>", "<robot>"),
        ('<robot name="r"/>', "not have a link"),
        ('<robot><link name="a"/></robot>', "no name"),
        ('<robot name="r"><link name="a"/><link name="b"/></robot>', "line 1"),
        ('<robot name="r"><link name="a"/><link name="a"/></robot>', "Two links"),
        (ROBOT.replace(LIMIT, ""), "must have a <limit>"),
        (ROBOT.replace("0.1 -0.2 0.3", "0.1 -0.2 three"), "three"),
    ],
)
def test_what_urdfdom_refuses(text: str, words: str) -> None:
    with pytest.raises(RefusedDescriptionError, match=words):
        read_joint_frames(text)


SDF = """<sdf version="1.9"><model name="r">{model}
<link name="base"><pose>0 0 0.1 0 0 0</pose></link>
<link name="wheel"><pose>0.2 0 0.1 0 0 1.5707963267948966</pose></link>
<link name="eye"><pose relative_to="wheel">0 0 0.3 0 0 0</pose></link>{links}
<joint name="axle" type="revolute"><pose>0 0.05 0 0 0 0</pose><parent>{parent}</parent>
<child>wheel</child><axis><xyz>0 1 0</xyz></axis></joint>
<joint name="mount" type="fixed"><parent>wheel</parent><child>eye</child></joint>{joints}
</model></sdf>"""


def sdf(**parts: str) -> str:
    return SDF.format(**{"model": "", "links": "", "joints": "", "parent": "base", **parts})


def test_a_link_of_sdf_is_where_the_joint_above_it_is() -> None:
    robot, frames = read_joint_frames(sdf())
    assert robot.name == "r"
    axle = frames.moving["axle"]
    assert (axle.parent, axle.child) == ("base", "wheel")
    xyz, xyzw = axle.at(0.0)
    # The pose of a joint is in its child, which is turned by a quarter.
    assert xyz == pytest.approx((0.15, 0.0, 0.0))
    assert Rotation.from_quat(xyzw).as_euler("xyz") == pytest.approx((0, 0, math.pi / 2))
    (mount,) = frames.fixed
    assert (mount.parent, mount.child) == ("wheel", "eye")
    # From the frame of the wheel, which is that of its joint.
    assert mount.at(0.0)[0] == pytest.approx((0.0, -0.05, 0.3))


def test_a_joint_of_sdf_with_two_axes_is_not_sent() -> None:
    joint = (
        '<joint name="cardan" type="universal"><parent>base</parent><child>tip</child>'
        "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>"
    )
    _, frames = read_joint_frames(sdf(links='<link name="tip"/>', joints=joint))
    assert set(frames.moving) == {"axle"}
    assert [joint.child for joint in frames.fixed] == ["eye"]


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"model": "<pose>0 0 1 0 0 0</pose>"}, "<model> has a <pose>"),
        ({"parent": "world"}, "parent `world`"),
        ({"links": '<link name="lost"/>'}, "Join `lost` to it"),
        ({"parent": "bse"}, "bse"),
    ],
)
def test_what_sdformat_urdf_refuses(parts: dict[str, str], words: str) -> None:
    assert read_joint_frames(sdf(model="<pose>0 0 0 0 -0.0 0</pose>"))
    with pytest.raises(RefusedDescriptionError, match=words):
        read_joint_frames(sdf(**parts))
