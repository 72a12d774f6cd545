"""Ball joints of SDF in `<gazebo>` elements, which hold what URDF can only call floating."""

from __future__ import annotations

import pytest

from urdf_texts import joint, link, robot
from wsgen.checks.rules.check import check_robot
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.robot import JointType, Robot
from wsgen.model.transform import Pose

FLOATING = joint(
    "slot", "frame", "ball", '<origin xyz="-0.1 0 -0.04"/><dynamics damping="1"/>', kind="floating"
)
TREE = link("base") + link("frame") + link("ball") + joint("mount", "base", "frame", kind="fixed")


def on_ball(parent: str, child: str, more: str = "") -> tuple[Robot, list[str]]:
    """The lumped robot, and the rules that are broken."""
    ball = f"<parent>{parent}</parent><child>{child}</child>{more}"
    block = f'<gazebo><joint name="socket" type="ball">{ball}</joint></gazebo>'
    written, found = read_urdf(robot(TREE + FLOATING + block), file=None)
    assert written is not None
    lumped, more_found = lump(written)
    assert lumped is not None
    checked = check_robot(written, None, simulator="classic")
    codes = [one.code for one in (*found, *more_found, *checked) if one.code not in LOOKS]
    return lumped, codes


LOOKS = {"ROB053", "ROB054", "ROB079"}


@pytest.mark.parametrize("parent", ["base", "frame"])
def test_it_holds_what_would_be_loose(parent: str) -> None:
    lumped, codes = on_ball(parent, "ball")
    (ball,) = lumped.joints
    assert (ball.name, ball.type, ball.parent, ball.child) == (
        "socket",
        JointType.BALL,
        "base",
        "ball",
    )
    assert ball.pose_in_parent == Pose((-0.1, 0.0, -0.04))
    assert (ball.damping, ball.limit) == (0.0, None)
    assert lumped.loose == ()
    assert codes == []


@pytest.mark.parametrize(
    ("parent", "child", "more", "codes"),
    [
        ("ball", "base", "", ["ROB058", "ROB055"]),
        ("base", "ball", "<pose>0 0 0.1 0 0 0</pose>", ["ROB058", "ROB055"]),
    ],
)
def test_one_that_holds_nothing_is_not_simulated(
    parent: str, child: str, more: str, codes: list[str]
) -> None:
    lumped, found = on_ball(parent, child, more)
    assert lumped.joints == ()
    assert [loose.child for loose in lumped.loose] == ["ball"]
    assert found == codes


def test_gazebo_sim_refuses_the_floating_joint_all_the_same() -> None:
    block = "<parent>base</parent><child>ball</child>"
    text = TREE + FLOATING + f'<gazebo><joint name="s" type="ball">{block}</joint></gazebo>'
    written, _ = read_urdf(robot(text), file=None)
    assert written is not None
    assert "ROB055" in {one.code for one in check_robot(written, None, simulator="gz")}
