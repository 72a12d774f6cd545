"""What engines do not follow of robots and worlds for Gazebo Classic."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from urdf_texts import MASS, joint, link, robot, shape
from wsgen.checks.rules.settings import (
    SETTINGS,
    settings_not_simulated,
    solver_not_simulated,
)
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.behavior import DiffDrive, WheelPair
from wsgen.model.engines import ENGINES
from wsgen.model.world import World

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.diagnostics import Diagnostic

FILE = Path("robot.urdf")
ALL = tuple(ENGINES)
TOUCH = MASS + shape("collision", "<sphere radius='0.1'/>")
LIMIT = "<limit lower='0' upper='1' effort='1' velocity='1'/>"


def found_in(about: str, engines: Sequence[str] = ALL, *, static: bool = False) -> list[Diagnostic]:
    """What is reported of a robot of two links and the hinge `j`."""
    body = link("a", TOUCH) + link("b", TOUCH) + joint("j", "a", "b", LIMIT, kind="revolute")
    text = robot(body + about + ("<gazebo><static>true</static></gazebo>" if static else ""))
    written, _ = read_urdf(text, file=FILE)
    assert written is not None
    return list(settings_not_simulated(written, lump(written)[0], FILE, engines))


def of(name: str, key: str, value: object) -> str:
    return f"\n<gazebo reference='{name}'><{key}>{value}</{key}></gazebo>"


@pytest.mark.parametrize(
    ("about", "lacking"),
    [
        (of("a", "kp", 1000), ALL),
        (of("a", "minDepth", 0.002), ("bullet", "dart")),
        (of("j", "stopErp", 0.8), ("bullet", "dart")),
        (of("b", "kinematic", "true"), ALL),
    ],
)
def test_what_matters_is_named_once_where_it_is_written(about: str, lacking: Sequence[str]) -> None:
    (found,) = found_in(of("b", "mu1", 1) + about)
    assert found.line is not None
    assert found.line > 1
    assert (found.element or "").startswith("gazebo[@reference=")
    for engine, spec in ENGINES.items():
        assert (spec.title in found.message) == (engine in lacking)
        assert len(found_in(about, [engine])) == (engine in lacking)


@pytest.mark.parametrize(
    "about",
    [
        of("a", "kp", 1e6),
        of("a", "minDepth", 0.001),
        of("j", "stopErp", 0.2),
        of("b", "kinematic", "false"),
        of("a", "kinematic", "true"),
        of("a", "kinematic", "true") + of("b", "kinematic", "true"),
        of("a", "dampingFactor", 0.1),
    ],
)
def test_what_makes_no_difference_is_not_named(about: str) -> None:
    assert found_in(about) == []


def test_what_is_static_stays_where_it_is_in_any_engine() -> None:
    assert found_in(of("a", "kp", 1000), static=True) == []


def test_each_setting_of_a_robot_is_tried_above() -> None:
    assert {one.elements for one in SETTINGS if one.find} == {
        *("`<kp>` and `<kd>`", "`<min_depth>`", "`<stopErp>` and `<stopCfm>`", "`<kinematic>`")
    }


PAIR = WheelPair(left="l", right="r", separation=0.3, radius=0.1)
WORLD = World(name="w", simulator="classic", iterations=(50, 7))


@pytest.mark.parametrize(
    ("pairs", "iterations", "count"), [(2, 50, 1), (1, 50, 0), (2, 1000, 0), (2, None, 0)]
)
def test_iterations_matter_for_wheels_that_skid(
    pairs: int, iterations: int | None, count: int
) -> None:
    drive = DiffDrive(simulator="classic", pairs=(PAIR,) * pairs)
    world = replace(WORLD, iterations=(iterations, 7))
    found = list(solver_not_simulated(world, [None, drive], ALL))
    assert [one.line for one in found] == [7] * count


@pytest.mark.parametrize(("pairs", "speed", "count"), [(1, 0.1, 1), (0, 0.1, 0), (1, 100.0, 0)])
def test_wheels_turn_no_faster_than_contacts_are_corrected(
    pairs: int, speed: float, count: int
) -> None:
    drive = DiffDrive(simulator="classic", pairs=(PAIR,)) if pairs else None
    world = World(name="w", simulator="classic", correcting_speed=(speed, 9))
    found = list(solver_not_simulated(world, [drive], ALL))
    assert [(one.line, "(0.1)" in one.message) for one in found] == [(9, True)] * count


def test_the_element_is_that_of_the_link_that_is_named() -> None:
    (found,) = found_in(of("a", "minDepth", 0.001) + of("b", "minDepth", 0.002), ["bullet"])
    assert "`b` of" in found.message
    assert found.element == "gazebo[@reference='b']"
