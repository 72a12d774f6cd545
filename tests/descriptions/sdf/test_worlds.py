"""World files: what is read from them, and what is said about bad ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.models import read_sdf
from wsgen.descriptions.sdf.worlds import DEFAULT_WORLD
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.world import World


TUTORIAL = """<?xml version="1.0" ?>
<sdf version="1.5">
  <world name="Empty world">
    <include><uri>model://sun</uri></include>
    <include><uri>model://ground_plane</uri></include>
  </world>
</sdf>
"""


def read_world(file: Path) -> tuple[World | None, tuple[Diagnostic, ...]]:
    found = read_sdf(file, find_model=lambda _: None)
    return found.world, found.diagnostics


def write(folder: Path, text: str) -> Path:
    file = folder / "some.world"
    file.write_text(text, encoding="utf-8")
    return file


def world(content: str) -> str:
    return f'<sdf version="1.6"><world name="w">\n{content}\n</world></sdf>'


def codes(folder: Path, text: str) -> list[tuple[str, int | None]]:
    _, diagnostics = read_world(write(folder, text))
    return [(found.code, found.line) for found in diagnostics]


def test_the_tutorials_world(tmp_path: Path) -> None:
    read, diagnostics = read_world(write(tmp_path, TUTORIAL))
    assert diagnostics == ()
    assert read is not None
    assert read.name == "Empty world"
    assert read.gravity == (0.0, 0.0, -9.8)
    assert read.step == 0.001
    assert read.has_ground_plane
    assert [model.name for model in read.models] == ["ground_plane"]


def test_settings_of_ode(tmp_path: Path) -> None:
    text = world(
        "<physics><ode>\n<solver><iters>20</iters></solver>\n<constraints>\n"
        "<contact_max_correcting_vel>0.1</contact_max_correcting_vel></constraints></ode></physics>"
    )
    found, _ = read_world(write(tmp_path, text))
    assert found is not None
    (iterations, first), (speed, second) = found.iterations, found.correcting_speed
    assert (iterations, speed, (second or 0) - (first or 0)) == (20, 0.1, 2)


def test_gravity_and_step_of_the_world(tmp_path: Path) -> None:
    text = world(
        "<gravity>0 0 -1.62</gravity><physics><max_step_size>0.002</max_step_size></physics>"
    )
    read, _ = read_world(write(tmp_path, text))
    assert read is not None
    assert (read.gravity, read.step) == ((0.0, 0.0, -1.62), 0.002)


def test_gravity_was_part_of_physics_until_sdf_1_5(tmp_path: Path) -> None:
    read, _ = read_world(write(tmp_path, world("<physics><gravity>0 0 -3</gravity></physics>")))
    assert read is not None
    assert read.gravity == (0.0, 0.0, -3.0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", [("ROB001", 1)]),
        ("<sdf>\n<world>\n</sdf>", [("ROB001", 2)]),
        ("<robot name='r'/>", [("WLD003", 1)]),
        (world(""), [("WLD006", 1)]),
        (world("<gravity>0 0</gravity>"), [("ROB016", 2), ("WLD006", 1)]),
        (world("<gravity>0 0 nan</gravity>"), [("ROB016", 2), ("WLD006", 1)]),
        (world("<gravity>0, 0, -9.8</gravity>"), [("ROB016", 2), ("WLD006", 1)]),
        (
            world("<physics><max_step_size>-1</max_step_size></physics>"),
            [("WLD007", 2), ("WLD006", 1)],
        ),
        (
            world("<physics><max_step_size>10</max_step_size></physics>"),
            [("WLD007", 2), ("WLD006", 1)],
        ),
    ],
)
def test_what_is_wrong_with_a_world(
    tmp_path: Path, text: str, expected: list[tuple[str, int]]
) -> None:
    assert codes(tmp_path, text) == expected


@pytest.mark.parametrize(
    ("step", "taken", "severity"),
    [
        ("1e-12", 0.001, Severity.ERROR),  # no time for Gazebo Sim
        ("0", 0.001, Severity.ERROR),
        ("1e-6", 0.001, Severity.WARNING),  # a million steps a second
        ("1e3", 0.001, Severity.WARNING),
        ("1e-4", 1e-4, None),
        ("nan", 0.001, Severity.ERROR),
    ],
)
def test_the_step_has_bounds(
    tmp_path: Path, step: str, taken: float, severity: Severity | None
) -> None:
    text = world(f"<physics><max_step_size>{step}</max_step_size></physics>")
    read, diagnostics = read_world(write(tmp_path, text))
    assert read is not None
    assert read.step == taken
    found = [one.severity for one in diagnostics if one.code != "WLD006"]
    assert found == ([] if severity is None else [severity])


def test_a_world_that_is_not_there(tmp_path: Path) -> None:
    read, diagnostics = read_world(tmp_path / "no.world")
    assert read is None
    assert [found.code for found in diagnostics] == ["ROB072"]
    assert "install(DIRECTORY" in (diagnostics[0].hint or "")


def test_an_entity_cannot_reach_another_file(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("0 0 -1")
    text = f'<!DOCTYPE sdf [<!ENTITY s SYSTEM "{tmp_path}/secret">]>' + world(
        "<gravity>&s;</gravity>"
    )
    read, diagnostics = read_world(write(tmp_path, text))
    assert read is None or read.gravity == DEFAULT_WORLD.gravity
    assert diagnostics


def test_the_world_without_a_file_has_a_ground() -> None:
    assert DEFAULT_WORLD.has_ground_plane
    assert DEFAULT_WORLD.file is None


@pytest.mark.parametrize("gravity", ["0 0 0", "0 0 9.8", "9.8 0 0"])
def test_gravity_that_pulls_nothing_down(tmp_path: Path, gravity: str) -> None:
    ground = "<include><uri>model://ground_plane</uri></include>"
    text = world(f"{ground}\n<gravity>{gravity}</gravity>")
    read, diagnostics = read_world(write(tmp_path, text))
    assert read is not None
    assert read.gravity == tuple(map(float, gravity.split()))
    assert [(found.code, found.line) for found in diagnostics] == [("WLD045", 3)]
    assert codes(tmp_path, world(f"{ground}\n<gravity>0 0 -1e9</gravity>")) == [("ROB016", 3)]


SAVED = """
<model name="box"><static>true</static><pose>1 0 0 0 0 0</pose><link name="l"><collision name="c">
<geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model>
<state world_name="w"><model name="box"><pose frame="">0 5 0 0 0 0</pose></model>
<model name="gone"><pose>0 0 0 0 0 0</pose></model></state>
"""


@pytest.mark.parametrize(
    ("plugin", "place"),
    [
        ("", (0.0, 5.0, 0.0)),
        ('<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>', (1, 0, 0)),
    ],
)
def test_a_saved_state_places_models_in_gazebo_classic(
    tmp_path: Path, plugin: str, place: tuple[float, float, float]
) -> None:
    read, _ = read_world(write(tmp_path, world(plugin + SAVED)))
    assert read is not None
    assert [model.pose_in_world.xyz for model in read.models] == [place]
