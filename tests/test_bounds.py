"""Robots stand and do what they must with their variables at the bounds, not only at the defaults.

The settings are a design of Plackett and Burman (Biometrika 33, 1946) with its mirror image: of any
three variables, every combination of lowest and highest values is among 24 robots; among 16, where
a template has no more than seven variables.
"""

from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING

import pytest

from install_space import InstallSpace
from templating.broken_templates import spec_for
from wsgen.checks.rules.bodies import IMPLAUSIBLE_DENSITY
from wsgen.isolation.fork_server import ForkServer
from wsgen.model.target import TARGETS
from wsgen.packages.workspace.overlay import Overlay
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.requests import SelectedPackage, ValidateRequest
from wsgen.simulation.run import default_engine
from wsgen.templating.render import render_package
from wsgen.templating.template import load_template

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.package import PackageSpec
    from wsgen.templating.spec import Variable
    from wsgen.templating.template import Template


pytestmark = pytest.mark.slow

PACKAGE = "some_robot"
# The first run of a design for as many variables; each of the next ones is turned by one place.
GENERATORS = (
    (True, True, True, False, True, False, False),
    (True, True, False, True, True, True, False, False, False, True, False),
)


def design(variables: int) -> list[tuple[bool, ...]]:
    """For each robot, whether each variable has its highest value, not its lowest."""
    first = next(one for one in GENERATORS if variables <= len(one))
    runs = [first[-shift:] + first[:-shift] for shift in range(len(first))]
    runs.append((False,) * len(first))
    whole = [*runs, *(tuple(not high for high in run) for run in runs)]
    return [run[:variables] for run in whole]


def numbers_of(template: Template) -> list[Variable]:
    return [one for one in template.variables.values() if one.type in {"integer", "number"}]


ROBOTS = [
    (name, number, highest)
    for name in ("arm", "diff_drive")
    for number, highest in enumerate(design(len(numbers_of(load_template(name)))))
]
SECOND_HALVES = {name: sum(one[0] == name for one in ROBOTS) // 2 for name in ("arm", "diff_drive")}


@pytest.fixture(scope="module")
def run() -> Iterator[Run]:
    """One fork server of child processes for all."""
    with ForkServer() as fork_server:
        yield fork_server.run


@pytest.mark.parametrize("template_name", ["arm", "diff_drive"])
def test_three_variables_have_all_combinations(template_name: str) -> None:
    runs = [highest for name, _, highest in ROBOTS if name == template_name]
    for three in itertools.combinations(range(len(runs[0])), 3):
        assert len({tuple(run[variable] for variable in three) for run in runs}) == 8


@pytest.mark.parametrize(
    ("template_name", "number", "highest"),
    [
        pytest.param(
            *robot,
            id=f"{robot[0]}-{robot[1]}",
            # The second half of a design is the first one with lowest and highest exchanged.
            marks=pytest.mark.thorough if robot[1] >= SECOND_HALVES[robot[0]] else [],
        )
        for robot in ROBOTS
    ],
)
def test_nothing_is_found_at_the_bounds(
    template_name: str, number: int, highest: tuple[bool, ...], tmp_path: Path, run: Run
) -> None:
    template = load_template(template_name)
    settings = [
        f"{one.name}={one.maximum if high else one.minimum}"
        for one, high in zip(numbers_of(template), highest, strict=True)
    ]
    target = TARGETS[number % len(TARGETS)]
    spec = spec_for(template, *settings, target=target, name=PACKAGE)
    assert validate(spec, tmp_path, run) == [], settings


def validate(spec: PackageSpec, folder: Path, run: Run) -> list[Diagnostic]:
    """What `wsgen validate` finds in a package whose files are where CMake would install them."""
    tree = render_package(spec, load_template(spec.template))
    source = folder / "src" / PACKAGE
    source.mkdir(parents=True)
    (source / "wsgen.toml").write_text(tree["wsgen.toml"], encoding="utf-8")
    prefix = folder / "install"
    share = InstallSpace(prefix).add(PACKAGE, tree)
    environment = {**os.environ, "AMENT_PREFIX_PATH": str(prefix)}
    overlay = Overlay(install=prefix, environment=environment, prefixes=(prefix,))
    selected = SelectedPackage(
        name=PACKAGE,
        source=source,
        share=share,
        launch_file=share / "launch" / "gazebo_model.launch.py",
    )
    request = ValidateRequest(engines=(default_engine(),))
    outcome = Validation(selected, overlay, request, None, run).run()
    assert len(outcome.robots) == 1
    # The bounds of masses and sizes meet where no material is so dense.
    return [one for one in outcome.diagnostics if one.code != IMPLAUSIBLE_DENSITY.code]
