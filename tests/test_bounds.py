"""Robots stand and do what they must with their variables at the bounds, not only at the defaults.

The settings are a design of Plackett and Burman (Biometrika 33, 1946) with its mirror image: of any
three variables, every combination of lowest and highest values is among 24 robots.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from install_space import InstallSpace
from templating.broken_templates import spec_for
from wsgen.isolation.fork_server import ForkServer
from wsgen.model.target import TARGETS
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.selection import SelectedPackage, ValidateRequest
from wsgen.rules.bodies import IMPLAUSIBLE_DENSITY
from wsgen.simulation.run import default_engine
from wsgen.templating.render import render_package
from wsgen.templating.template import load_template
from wsgen.workspace.overlay import Overlay

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.package import PackageSpec


pytestmark = pytest.mark.slow

PACKAGE = "some_robot"
GENERATOR = (True, True, False, True, True, True, False, False, False, True, False)
RUNS = [
    *(GENERATOR[-shift:] + GENERATOR[:-shift] for shift in range(len(GENERATOR))),
    (False,) * len(GENERATOR),
]
DESIGN = [*RUNS, *(tuple(not high for high in run) for run in RUNS)]


@pytest.fixture(scope="module")
def run() -> Iterator[Run]:
    """One fork server of child processes for all."""
    with ForkServer() as fork_server:
        yield fork_server.run


@pytest.mark.parametrize("number", range(len(DESIGN)))
@pytest.mark.parametrize("template_name", ["arm", "diff_drive"])
def test_nothing_is_found_at_the_bounds(
    template_name: str, number: int, tmp_path: Path, run: Run
) -> None:
    template = load_template(template_name)
    variables = [one for one in template.variables.values() if one.type in {"integer", "number"}]
    assert len(variables) <= len(GENERATOR)
    settings = [
        f"{one.name}={one.maximum if high else one.minimum}"
        for one, high in zip(variables, DESIGN[number], strict=False)
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
