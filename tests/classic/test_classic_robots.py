"""Public robots from PyPI, against what the real Gazebo Classic makes of them.

`robots.json` was recorded with Debian 11's Gazebo 11.1 (sdformat 9): the links of each robot with
their masses in kg, and its joints; or that Gazebo refuses it. `--regenerate` records it anew.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import xacro

from classic.gazebo_classic import EndedError, GazeboClassic, recorded_in, why_missing
from public_robots import ROBOTS, find_robot
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Severity
from wsgen.pipeline.prepare import for_simulator

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot

RECORDED = Path(__file__).with_name("robots.json")
LIVE = ("racecar", "husky")  # asked in each run of the tests
OLD_SDFORMAT = "ROB080: sdformat 9.7 drops what is on a lumped link without mass; 9.10.1 does not"
# Robots whose links differ, and why.
DIFFERENT = {"icub": OLD_SDFORMAT}
# What wsgen refuses of a robot that Gazebo Classic simulates, and why.
WHY = {
    "ROB016": "Gazebo's parser drops the element",
    "ROB040": "Gazebo drops a link, and what is below it: the robot is another one",
    "ROB041": "Gazebo computes a center of mass as 0/0 and puts the link to the origin",
}
_LOSING_LINKS = (
    *("cartpole", "kuka_iiwa", "plane", "samurai", "table", "human", "romeo"),
    *("icubgenova03", "icubnancy01", "irb140", "lbr_iiwa_14_r820", "puma560_robot"),
)
STRICTER = {
    **{name: {"ROB040"} for name in _LOSING_LINKS},
    "anymal_c": {"ROB041"},
    "racecar_differential": {"ROB016"},
    "talos_full_v2": {"ROB041"},
}

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


def read(name: str) -> tuple[str, Path]:
    """The URDF of a robot, and its file."""
    distribution, path = next((one[0], one[1]) for one in ROBOTS if one[2] == name)
    file = find_robot(distribution, path)
    if file is None:
        pytest.skip(f"{distribution} is not installed")
    text = file.read_text(encoding="utf-8")
    if "xmlns:xacro" in text and "$(" in text:
        text = xacro.process_file(str(file)).toxml()
    return text, file


def ask(name: str, folder: Path) -> dict[str, Any]:
    """What Gazebo Classic makes of it; meshes change no mass, and are not found."""
    world, file = folder / "w.world", folder / "r.urdf"
    world.write_text("<sdf version='1.6'><world name='w'/></sdf>")
    file.write_text(read(name)[0], encoding="utf-8")
    try:
        with GazeboClassic(world) as gazebo:
            gazebo.spawn(file, "r", z=1.0)
            robot = gazebo.state()["r"]
    except ValueError:
        return {"refused": True}
    except EndedError:
        return {"crashed": True}
    return {
        "links": {
            one.removeprefix("r::"): float(f"{link['mass'][0]:.5g}")
            for one, link in sorted(robot["links"].items())
        },
        "joints": sorted(one.removeprefix("r::") for one in robot["joints"]),
    }


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("robots")
    return recorded_in(
        RECORDED, request, [name for *_, name in ROBOTS], lambda name: ask(name, folder)
    )


@pytest.mark.skipif(why_missing() != "", reason=why_missing())
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    assert ask(name, tmp_path) == recorded[name]


def for_classic(name: str) -> tuple[Robot | None, set[str]]:
    """The robot as wsgen has it for Gazebo Classic, and the codes of its errors."""
    text, file = read(name)
    robot, found = read_urdf(text, file=file)
    more: tuple[Diagnostic, ...] = ()
    if robot is not None:
        robot, more = lump(robot, file=file)
    found = tuple(for_simulator((*found, *more), "classic"))
    return robot, {one.code for one in found if one.severity is Severity.ERROR}


def test_each_error_has_its_reason() -> None:
    assert set().union(*STRICTER.values()) == WHY.keys()


@pytest.mark.parametrize("name", [name for *_, name in ROBOTS])
def test_same_as_in_gazebo_classic(name: str, recorded: Any) -> None:
    robot, errors = for_classic(name)
    real = recorded[name]
    if "links" not in real:
        assert errors
        return
    assert errors == STRICTER.get(name, set())
    if errors or robot is None:
        return
    masses = {one.name: one.inertial.mass if one.inertial else 0.0 for one in robot.links}
    if robot.fixed_to_world:
        masses.pop("world")
    is_same = masses.keys() == real["links"].keys() and {one.name for one in robot.joints} == set(
        real["joints"]
    )
    assert is_same == (name not in DIFFERENT)
    for link in masses.keys() & real["links"].keys():
        assert masses[link] == pytest.approx(real["links"][link], rel=1e-4, abs=1e-9), link
