"""The rules over materials, each with its facts and no files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.robot_files import ogre_materials
from wsgen.diagnostics import Severity
from wsgen.model.robot import Box, GazeboTag, Link, Visual

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

FILE = Path("robot.urdf")
VISUAL = Visual(geometry=Box(size=(1.0, 1.0, 1.0)))
BASE = Link(name="base", visuals=(VISUAL,), line=2)
ARM = replace(BASE, name="arm")


def tag(name: str, reference: str = "base", key: str = "material") -> GazeboTag:
    return GazeboTag(reference=reference, values={key: name}, line=7)


def check(
    *tags: GazeboTag, simulator: str | None = "gz", distro: str | None = "humble", base: Link = BASE
) -> list[Diagnostic]:
    return list(ogre_materials([base, ARM], tags, FILE, simulator=simulator, distro=distro))


def test_a_color_of_gazebo_classic() -> None:
    (found,) = check(tag("Gazebo/Orange"), tag("Gazebo/Orange", "arm"))
    assert (found.code, found.severity, found.line) == ("ROB125", Severity.INFO, 7)
    assert found.element == "gazebo[@reference='base']/material"
    assert "it draws `base`, `arm` in white" in found.message
    assert '<material name="orange"><color rgba="1 0.5088 0.0468 1"/></material>' in (
        found.hint or ""
    )
    assert len(check(tag("Gazebo/Orange"), tag("Gazebo/Red", "arm"))) == 2


@pytest.mark.parametrize(
    ("name", "color"), [("My/Red", "1 0 0 1"), ("My/Own", "R G B 1"), ("Black", "0 0 0 1")]
)
@pytest.mark.parametrize("distro", ["humble", "jazzy", None])
def test_scripts_that_no_release_reads(name: str, color: str, distro: str | None) -> None:
    for key in ("material", "visual/material/script/name"):
        (found,) = check(tag(name, key=key), distro=distro)
        assert f'rgba="{color}"' in (found.hint or "")


def test_materials_that_are_drawn() -> None:
    red = tag("Gazebo/Red")
    assert not check(red, distro="jazzy")
    assert not check(red, distro=None)
    assert not check(red, simulator="classic")
    assert not check(red, simulator=None)
    assert not check(red, base=replace(BASE, visuals=()))
    assert not check(red, base=replace(BASE, visuals=(replace(VISUAL, rgba=(1.0, 0, 0, 1.0)),)))
    assert not check(red, tag("1 0 0 1", key="visual/material/diffuse"))


def test_materials_that_are_not_known() -> None:
    assert not check(tag("Gazebo/Pink"))  # reported as one that Gazebo does not have
    assert not check(tag("${color}"))
    assert not check(tag("Gazebo/Red", "nothing"))
    assert not check(tag("Gazebo/Red"), base=replace(BASE, is_as_meant=False))
