"""Which engines are chosen, and what is said of those that are missing."""

from __future__ import annotations

import click
import pytest

from wsgen.cli.validate import command as validate
from wsgen.model.engines import ENGINES
from wsgen.simulation.run import all_engines, default_engine, engine_left_out, missing_engines


@pytest.mark.parametrize(
    ("installed", "default", "compared"),
    [
        ("bullet mujoco dart", "bullet", "bullet mujoco dart"),
        ("bullet dart", "bullet", "bullet dart"),
        ("mujoco dart", "mujoco", "mujoco dart"),
        ("dart", "dart", "bullet mujoco dart"),  # which reports those that are missing
        ("", "mujoco", "bullet mujoco dart"),
    ],
)
def test_engines_that_are_installed(
    monkeypatch: pytest.MonkeyPatch, installed: str, default: str, compared: str
) -> None:
    for name, spec in ENGINES.items():
        library = "sys" if name in installed else "no_such_module"
        monkeypatch.setitem(ENGINES, name, spec._replace(library=library))
    assert set(missing_engines(ENGINES)) == set(ENGINES) - set(installed.split())
    assert default_engine() == default
    assert all_engines() == tuple(compared.split())


def test_every_engine_has_an_option() -> None:
    (option,) = (one for one in validate.params if one.name == "engine")
    assert isinstance(option.type, click.Choice)
    assert set(option.type.choices) == {*ENGINES, "gazebo", "all"}


@pytest.mark.parametrize(
    ("engines", "message", "hint"),
    [
        ("bullet mujoco", "DART is not installed: only PyBullet and MuJoCo are", "'wsgen[dart]'"),
        ("bullet dart", "MuJoCo is not installed: only PyBullet and DART are", "'wsgen[mujoco]'"),
        ("mujoco dart", "PyBullet is not installed: only MuJoCo and DART are", "has a wheel"),
    ],
)
def test_an_engine_that_is_not_compared_is_named(engines: str, message: str, hint: str) -> None:
    (found,) = engine_left_out(engines.split())
    assert found.message == f"{message} compared."
    assert hint in str(found.hint)


@pytest.mark.parametrize("engines", [["bullet"], ["bullet", "mujoco", "dart"]])
def test_no_engine_is_left_out_where_all_or_one_are_asked_for(engines: list[str]) -> None:
    assert list(engine_left_out(engines)) == []
