"""What older versions of sdformat make of a robot, which Debian 12 and Ubuntu 22.04 may have."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from gazebo_oracle import IGN, is_taken, model_of
from urdf_texts import MASS, joint, link, robot
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.pipeline.prepare import PrepareContext, prepare_robot

if TYPE_CHECKING:
    from pathlib import Path


PLATE = link("base") + link("arm") + joint("plate_joint", "base", "plate")
ARM = joint("arm_joint", "plate", "arm", kind="continuous")
SCREW = (
    '<gazebo><joint name="screw" type="revolute"><parent>{}</parent><child>{}</child>'
    "<axis><xyz>0 0 1</xyz></axis></joint></gazebo>"
)
KEPT = '<gazebo reference="tip_joint"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
TIP = (
    link("base")
    + link("tip")
    + link("arm")
    + joint("tip_joint", "base", "tip")
    + joint("arm_joint", "base", "arm", kind="continuous")
)
CARRIED = {
    "no inertial": (PLATE + ARM + link("plate", ""), 1),
    "fixed to another without": (
        PLATE
        + ARM.replace('"plate"', '"top"')
        + link("plate", "")
        + link("top", "")
        + joint("top_joint", "plate", "top"),
        1,
    ),
    "more hangs on it": (
        PLATE
        + ARM
        + link("plate", "")
        + link("hand")
        + joint("hand_joint", "arm", "hand", kind="continuous"),
        2,
    ),
    "a mass": (PLATE + ARM + link("plate"), 0),
    "a mass fixed to it": (
        PLATE + ARM + link("plate", "") + link("top") + joint("top_joint", "plate", "top"),
        0,
    ),
    "nothing moves on it": (PLATE + ARM.replace('"plate"', '"base"') + link("plate", ""), 0),
}


def lumped(text: str) -> list[Diagnostic]:
    read, found = read_urdf(text, file=None)
    assert read is not None
    return [*found, *lump(read)[1]]


@pytest.mark.parametrize(("body", "lost"), CARRIED.values(), ids=CARRIED.keys())
def test_what_a_massless_fixed_link_carries(body: str, lost: int) -> None:
    found = lumped(robot(body))
    assert [(one.code, one.severity) for one in found] == [("ROB080", Severity.WARNING)] * (
        lost > 0
    )
    for one in found:
        assert f", {lost} kg." in one.message
        assert "`arm`" in one.message
        assert one.line


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.skipif(IGN is None, reason="ign is missing")
@pytest.mark.parametrize(("body", "lost"), CARRIED.values(), ids=CARRIED.keys())
def test_that_is_what_it_drops(body: str, lost: int, tmp_path: Path) -> None:
    """The oracle is such an older version."""
    file = tmp_path / "robot.urdf"
    file.write_text(robot(body))
    read, _ = read_urdf(robot(body), file=None)
    model = model_of(file, tmp_path)
    assert read is not None
    assert model is not None
    left = {one.get("name") for one in model.findall("link")}
    assert len(lump(read)[0].links) - len(left) == lost
    assert {one.name for one in lump(read, for_classic=True)[0].links} == left


ENDS = [
    ("arm", "tip", "", "ROB079"),
    ("tip", "arm", "", "ROB079"),
    ("arm", "tip", KEPT, None),
    ("base", "arm", "", None),
    ("world", "arm", "", None),
    ("arm", "nothing", "", "ROB078"),
    ("nothing", "arm", "", "ROB078"),
]


@pytest.mark.parametrize(("first", "second", "more", "code"), ENDS)
def test_ends_of_sdf_joints(first: str, second: str, more: str, code: str | None) -> None:
    found = lumped(robot(TIP + more + SCREW.format(first, second)))
    found = [one for one in found if one.code != "ROB058"]  # that it is not simulated
    assert [one.code for one in found] == ([code] if code else [])
    for one in found:
        assert "`screw`" in one.message
        assert (one.severity is Severity.ERROR) == (code == "ROB078")
        if code == "ROB079":
            assert "`tip`" in one.message
            assert 'reference="tip_joint"><preserveFixedJoint>' in (one.hint or "")
            assert "or name `base`" in (one.hint or "")


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.skipif(IGN is None, reason="ign is missing")
@pytest.mark.parametrize(("first", "second", "more", "code"), ENDS)
def test_that_is_what_it_refuses(
    first: str, second: str, more: str, code: str | None, tmp_path: Path
) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(robot(TIP + more + SCREW.format(first, second)))
    assert is_taken(file, tmp_path) == (code is None)


@pytest.mark.parametrize(
    ("simulator", "distro", "is_reported"),
    [
        (None, None, True),
        ("classic", "humble", True),
        ("gz", "humble", True),
        ("gz", None, True),
        ("gz", "jazzy", False),
    ],
)
def test_only_where_such_a_version_may_be(
    simulator: str | None, distro: str | None, *, is_reported: bool, tmp_path: Path
) -> None:
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    _, found = prepare_robot(
        robot(CARRIED["no inertial"][0]).encode(),
        file=tmp_path / "robot.urdf",
        context=context,
        simulator=simulator,
        distro=distro,
    )
    assert ("ROB080" in {one.code for one in found}) == is_reported


@pytest.mark.parametrize(
    ("simulator", "severity"),
    [(None, Severity.WARNING), ("classic", Severity.WARNING), ("gz", Severity.ERROR)],
)
@pytest.mark.parametrize(
    ("kind", "name", "code"),
    [("continuous", "arm", "ROB034"), ("floating", "j", "ROB055"), ("planar", "j", "ROB055")],
)
def test_what_the_simulator_of_the_target_refuses(  # noqa: PLR0917  cases
    tmp_path: Path, kind: str, name: str, code: str, simulator: str | None, severity: Severity
) -> None:
    """For a bare file it is a warning that names the simulator."""
    text = robot(link("base", MASS) + link("arm", MASS) + joint(name, "base", "arm", kind=kind))
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    _, found = prepare_robot(
        text.encode(), file=tmp_path / "robot.urdf", context=context, simulator=simulator
    )
    (one,) = (one for one in found if one.code == code)
    assert one.severity is severity
    assert ("Gazebo Sim refuses" in one.message) == (simulator != "classic" or code == "ROB034")
