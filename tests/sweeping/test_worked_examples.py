"""The examples of docs/sweeps.md against mechanics."""

import csv
from pathlib import Path

import pytest

import wsgen.cli

G = 9.8  # m/s², of the worlds

pytestmark = pytest.mark.slow


def rows(tmp_path: Path, *words: str) -> list[dict[str, str]]:
    file = tmp_path / "t.csv"
    assert wsgen.cli.run(["sweep", *words, "--out", str(file), "-q"]) == 0
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_rover_tips_where_its_center_of_mass_leaves_the_axle(tmp_path: Path) -> None:
    words = ["-t", "diff_drive", "--set", "body_height=0.3", "--arg", "z:=0.0", "--no-behaviors"]
    found = rows(tmp_path, *words, "--over", "world.slope=26.5deg,27.5deg")
    assert [row["passed"] for row in found] == ["true", "false"]  # by statics at 27.02 degrees
    assert "SPN059" in found[1]["codes"]


def test_friction_bounds_how_fast_the_rover_gets(tmp_path: Path) -> None:
    found = rows(
        tmp_path, "-t", "diff_drive", "--seconds", "1", "--over", "world.friction=0.05,0.1"
    )
    one, other = (float(row["behavior.drives straight.x"]) for row in found)
    speed, carried = 0.5, 1 - 0.0907 / 0.25  # m/s; the wheels' share of the weight
    behind = speed**2 / (2 * carried * G)  # m, divided by the friction
    assert other - one == pytest.approx(behind / 0.05 - behind / 0.1, rel=0.02)


def test_what_counts_for_the_arm_is_mass_times_gravity(tmp_path: Path) -> None:
    words = [
        "-t",
        "arm",
        "--seconds",
        "0.5",
        "--over",
        "robot.mass_scale=4,5",
        "--over",
        "world.gravity=7,9.8",
    ]
    found = rows(tmp_path, *words)
    assert [row["passed"] for row in found] == ["true", "true", "true", "false"]
