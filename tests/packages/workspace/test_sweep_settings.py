"""`[sweep]` of `wsgen.toml`."""

from pathlib import Path

import pytest

from wsgen.packages.workspace.settings import read_settings
from wsgen.packages.workspace.sweep_settings import SweepSettings

WHOLE = """\
[validate]
allow = []

[sweep]
over = { "world.slope" = "0:30deg:31", wheel_radius = [0.03, 0.04], mode = "fast" }
random = { "robot.mass_scale" = "normal(1, 0.1)" }
samples = 200
sampler = "sobol"
seed = 7
seconds = 5
engine = "mujoco"
behaviors = false
out = "rover.parquet"
"""


def test_a_whole_table(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text(WHOLE)
    settings, found = read_settings(tmp_path)
    assert not found
    assert settings.sweep == SweepSettings(
        file=tmp_path / "wsgen.toml",
        over={"world.slope": "0:30deg:31", "wheel_radius": (0.03, 0.04), "mode": "fast"},
        random={"robot.mass_scale": "normal(1, 0.1)"},
        lines={"world.slope": 5, "wheel_radius": 5, "mode": 5, "robot.mass_scale": 6},
        samples=200,
        sampler="sobol",
        seed=7,
        seconds=5.0,
        engine="mujoco",
        behaviors=False,
        out="rover.parquet",
    )


def test_a_package_without_the_table(tmp_path: Path) -> None:
    assert read_settings(tmp_path)[0].sweep is None
    (tmp_path / "wsgen.toml").write_text("[validate]\nallow = []\n")
    assert read_settings(tmp_path) == (read_settings(tmp_path)[0], ())
    assert read_settings(tmp_path)[0].sweep is None


def test_tables_in_other_forms(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text(
        "[sweep.over]\nworld.slope = '0:1:3'\nradius = 0.5\nname = ['a', 'b']\n"
        "has_arm = [true, false]\n[sweep.random.robot]\nmass_scale = 'uniform(1,2)'\n"
    )
    settings, found = read_settings(tmp_path)
    assert not found
    assert settings.sweep is not None
    assert settings.sweep.over == {
        "world.slope": "0:1:3",
        "radius": (0.5,),
        "name": ("a", "b"),
        "has_arm": (True, False),
    }
    assert settings.sweep.random == {"robot.mass_scale": "uniform(1,2)"}
    assert settings.sweep.lines["radius"] == 3


@pytest.mark.parametrize(
    ("text", "line", "element", "message", "hint"),
    [
        ("sweep = 1", 1, "sweep", "is not a table", "[sweep]"),
        ("[sweep]\novr = {}", 2, "sweep.ovr", "no key `ovr`", "Did you mean `over`?"),
        ("[sweep]\nover = 3", 2, "sweep.over", "not a table of names", "world.slope"),
        ("[sweep]\nrandom = ['a']", 2, "sweep.random", "not a table of names", "uniform"),
        ("[sweep]\n\nover = { a = [1, 'x'] }", 3, "sweep.over.a", "values of `a`", "0:1:11"),
        ("[sweep]\nover = { a = [] }", 2, "sweep.over.a", "values of `a`", "[0.1, 0.2]"),
        ("[sweep]\nover = { a = [nan] }", 2, "sweep.over.a", "values of `a`", "[0.1, 0.2]"),
        ("[sweep]\nover = { a = [[1]] }", 2, "sweep.over.a", "values of `a`", "[0.1, 0.2]"),
        ("[sweep]\nover = { a = 1979-05-27 }", 2, "sweep.over.a", "values of `a`", "[0.1"),
        ("[sweep]\nrandom = { a = 1 }", 2, "sweep.random.a", "is not a text", "uniform(0.5"),
        (
            "[sweep]\nover = { a = 1 }\nrandom = { a = 'uniform(1,2)' }",
            3,
            "sweep.random.a",
            "`a` is in `over` and in `random`",
            "Remove one",
        ),
        ("[sweep]\nsamples = 0", 2, "sweep.samples", "not an integer from 1", "samples = 100"),
        ("[sweep]\nsamples = true", 2, "sweep.samples", "not an integer from 1", "samples = 100"),
        ("[sweep]\nseed = -1", 2, "sweep.seed", "not an integer from 0", "seed = 1"),
        ("[sweep]\nseed = 1.5", 2, "sweep.seed", "not an integer from 0", "seed = 1"),
        ("[sweep]\nsampler = 'lsh'", 2, "sweep.sampler", "must be one of", "Did you mean `lhs`?"),
        ("[sweep]\nengine = 'ode'", 2, "sweep.engine", "must be one of", 'engine = "bullet"'),
        ("[sweep]\nengine = ['bullet']", 2, "sweep.engine", "must be one of", 'engine = "bullet"'),
        ("[sweep]\nseconds = 0", 2, "sweep.seconds", "not a number from 0.1 to 600", "5.0"),
        ("[sweep]\nseconds = inf", 2, "sweep.seconds", "not a number from 0.1 to 600", "5.0"),
        ("[sweep]\nseconds = '3'", 2, "sweep.seconds", "not a number from 0.1 to 600", "5.0"),
        ("[sweep]\nout = ' '", 2, "sweep.out", "is not a path", "rover.csv"),
        ("[sweep]\nout = 3", 2, "sweep.out", "is not a path", "rover.csv"),
    ],
)
def test_mistakes_have_a_line_and_a_hint(  # noqa: PLR0917  a table
    text: str, line: int, element: str, message: str, hint: str, tmp_path: Path
) -> None:
    (tmp_path / "wsgen.toml").write_text(f"{text}\n")
    settings, (found,) = read_settings(tmp_path)
    assert settings.sweep is not None
    assert (found.code, found.line, found.element) == ("PKG060", line, element)
    assert message in found.message
    assert hint in (found.hint or "")
