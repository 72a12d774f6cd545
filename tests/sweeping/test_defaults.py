"""What `[sweep]` and the command line make together."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from wsgen.errors import RequestError
from wsgen.model.sweep import Axis, Design, Distribution
from wsgen.packages.workspace.settings import read_settings
from wsgen.packages.workspace.sweep_settings import SweepSettings
from wsgen.sweeping.words import make_design_with, read_axes, read_distributions


def read(folder: Path) -> SweepSettings:
    settings, found = read_settings(folder)
    assert not found
    return settings.sweep or SweepSettings()


def merge(
    settings: SweepSettings,
    over: Sequence[str] = (),
    random: Sequence[str] = (),
    samples: int | None = None,
    seed: int | None = None,
) -> Design:
    return make_design_with(
        settings,
        over=read_axes(over),
        random=read_distributions(random),
        samples=samples,
        sampler=None,
        seed=seed,
    )


TABLE = """\
[sweep]
over = { "world.slope" = "0:1:3", wheel_radius = [0.03, 0.04] }
random = { "robot.mass_scale" = "normal(1, 0.1)", "push.force" = "uniform(1, 2)" }
samples = 16
sampler = "sobol"
seed = 5
"""


@pytest.fixture
def settings(tmp_path: Path) -> SweepSettings:
    (tmp_path / "wsgen.toml").write_text(TABLE)
    return read(tmp_path)


SLOPE = Axis(name="world.slope", values=(0.0, 0.5, 1.0))
RADIUS = Axis(name="wheel_radius", values=(0.03, 0.04))
MASS = Distribution(name="robot.mass_scale", kind="normal", numbers=(1.0, 0.1))
FORCE = Distribution(name="push.force", kind="uniform", numbers=(1.0, 2.0))


def test_the_table_alone(settings: SweepSettings) -> None:
    assert merge(settings, (), ()) == Design(
        axes=(SLOPE, RADIUS), distributions=(MASS, FORCE), samples=16, sampler="sobol", seed=5
    )


def test_the_command_line_comes_first_name_by_name(settings: SweepSettings) -> None:
    design = merge(
        settings, ["x=1,2", "world.slope=0,2"], ["robot.mass_scale=uniform(1,3)"], seed=6
    )
    assert [axis.name for axis in design.axes] == ["wheel_radius", "x", "world.slope"]
    assert design.axes[2].values == (0, 2)
    assert [one.kind for one in design.distributions] == ["uniform", "uniform"]
    assert design.names[3:] == ("push.force", "robot.mass_scale")
    assert (design.samples, design.sampler, design.seed) == (16, "sobol", 6)


def test_a_name_moves_from_grid_to_random_and_back(settings: SweepSettings) -> None:
    drawn = merge(settings, (), ["world.slope=uniform(0,1)"])
    assert drawn.names == ("wheel_radius", "robot.mass_scale", "push.force", "world.slope")
    fixed = merge(settings, ["robot.mass_scale=1,2", "push.force=1,2"], ())
    assert not fixed.distributions
    assert fixed.samples == 1  # those of the table have no effect now, and that is no mistake


def test_without_a_table(tmp_path: Path) -> None:
    assert read(tmp_path) == SweepSettings()
    assert merge(SweepSettings(), ["a=1,2"], ()).samples == 1
    with pytest.raises(RequestError, match="--samples has no effect"):
        merge(SweepSettings(), ["a=1,2"], (), samples=3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('over = { a = "0:1:0" }', r":2 over: a=0:1:0: COUNT is 0"),
        ("over = { a = [1, 1] }", r":2 over: a: 1 is given twice"),
        ('random = { a = "unifrom(1,2)" }', r":2 random: a=unifrom\(1,2\): wsgen does not have"),
    ],
)
def test_mistakes_name_the_file_and_the_line(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text(f"[sweep]\n{text}\n")
    with pytest.raises(RequestError, match=rf"wsgen\.toml{message}") as caught:
        merge(read(tmp_path), (), ())
    assert caught.value.hint
