"""`wsgen launch --run`: what is refused before anything is started."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
import pytest

from wsgen.cli import run
from wsgen.cli.launch import RateType

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--for", "3"], "Without --run nothing is started, and --for has no effect."),
        (["--rate", "max"], "Without --run nothing is started, and --rate has no effect."),
        (["--strict"], "Without --run nothing is started, and --strict has no effect."),
        (["--until-exit", "goal"], "Without --run nothing is started, and --until-exit has no"),
        (["--run", "--play"], "--run and --play cannot be combined."),
        (["--run", "--show-args"], "--run and --show-arguments cannot be combined."),
        (["--run", "--seconds", "3"], "--run and --seconds cannot be combined."),
        (["--run", "--format", "json"], "--run and --format cannot be combined."),
        (["--run", "--engine", "all"], "--run simulates in one engine."),
        (["--run", "--rate", "fast"], "'fast' is no rate: a number above 0, or `max`."),
        (["--run", "--rate", "0"], "'0' is no rate: a number above 0, or `max`."),
        (["--run", "--for", "-1"], "-1"),
        (["--run", "--record", "a.png"], "`a.png` is neither an .mcap, nor a .gif, nor an .mp4"),
        (["--run", "--record", "a.gif", "--record", "b.mp4"], "the same recording twice"),
        (["--run", "--record", "/no/such/folder/a.mcap"], "its folder does not exist"),
        (["--play", "--record", "a.gif", "--record", "b.gif"], "--play makes one video."),
    ],
)
def test_what_makes_no_sense_is_refused(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text(
        "from launch import LaunchDescription\n"
        "def generate_launch_description():\n    return LaunchDescription()\n"
    )
    assert run(["launch", str(file), *words]) == 2
    assert message in capsys.readouterr().err


def test_rates() -> None:
    rate = RateType()
    assert rate.convert("max", None, None) is None
    assert rate.convert("0.5", None, None) == 0.5
    with pytest.raises(click.BadParameter):
        rate.convert("inf", None, None)
