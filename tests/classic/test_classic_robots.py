"""Public robots from PyPI, against what the real Gazebo Classic makes of them.

`robots.json` was recorded with Debian 11's Gazebo 11.1 (sdformat 9): the links of each robot with
their masses in kg, and its joints; or that Gazebo refuses it. `--regenerate` records it anew.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import xacro

from classic.gazebo_classic import NEEDS_CLASSIC, EndedError, GazeboClassic, recorded_in
from public_robots import ROBOTS, find_robot
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Severity
from wsgen.pipeline.prepare import can_simulate, for_simulator

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot

RECORDED = Path(__file__).with_name("robots.json")
LIVE = ("racecar", "husky", "human")  # asked in each run of the tests
SECONDS = 0.2  # in which what has become NaN shows
# What Gazebo Classic loses of a robot that it simulates, which wsgen reports as an error.
LOST = {
    "ROB016": "a visual and a collision, at which its parser stops reading the link",
    "ROB040": "links without mass, with what is below them",
    "ROB080": "what is on a lumped link without mass, which sdformat before 9.10.1 drops",
}
LOSING = {
    "racecar_differential": {"ROB016"},
    "human": {"ROB040"},
    "romeo": {"ROB040"},
    "icub": {"ROB080"},
    "icubgenova03": {"ROB040", "ROB080"},
    "icubnancy01": {"ROB040", "ROB080"},
}
# Their joints have more damping than explicit steps take: they are read, and become NaN (ROB152).
EXPLODING = ("allegro_left_hand", "icub")
# Why nothing of a robot is simulated, there and here.
ROOTLESS = ("cartpole", "kuka_iiwa", "plane", "samurai", "table", "irb140", "lbr_iiwa_14_r820")
NOTHING = {
    "ROB040": ("the root has no mass, and no link is left", (*ROOTLESS, "puma560_robot")),
    "ROB041": (
        "a center of mass is 0/0: links end up at the origin",
        ("anymal_c", "talos_full_v2"),
    ),
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
            gazebo.run(SECONDS)
            links = gazebo.state()["r"]["links"].values()
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
        "is_simulated": any(any(link["pose"][:3]) for link in links),
    }


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("robots")
    return recorded_in(
        RECORDED, request, [name for *_, name in ROBOTS], lambda name: ask(name, folder)
    )


@NEEDS_CLASSIC
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    assert ask(name, tmp_path) == recorded[name]


def for_classic(name: str) -> tuple[Robot | None, set[str]]:
    """The robot as wsgen simulates it for Gazebo Classic, if it does; the codes of its errors."""
    text, file = read(name)
    robot, found = read_urdf(text, file=file)
    more: tuple[Diagnostic, ...] = ()
    if robot is not None:
        robot, more = lump(robot, file=file, for_classic=True)
    found = tuple(for_simulator((*found, *more), "classic"))
    can_run = robot is not None and can_simulate(robot, found, "classic")
    return robot if can_run else None, {one.code for one in found if one.severity is Severity.ERROR}


def test_each_error_has_its_reason() -> None:
    assert set().union(*LOSING.values()) == LOST.keys()


@pytest.mark.parametrize("name", [name for *_, name in ROBOTS])
def test_same_as_in_gazebo_classic(name: str, recorded: Any) -> None:
    robot, errors = for_classic(name)
    real = recorded[name]
    if "links" not in real or not (real["is_simulated"] or name in EXPLODING):
        assert robot is None
        assert errors
        assert "links" not in real or [name in NOTHING[code][1] for code in errors] == [True]
        return
    assert robot is not None
    assert errors == LOSING.get(name, set())
    masses = {one.name: one.inertial.mass if one.inertial else 0.0 for one in robot.links}
    if robot.fixed_to_world:
        masses.pop("world")
    assert masses.keys() == real["links"].keys()
    assert {one.name for one in robot.joints} == set(real["joints"])
    for link, mass in real["links"].items():
        assert masses[link] == pytest.approx(mass, rel=1e-4, abs=1e-9), link
