"""What of everything that is found is reported: selected, allowed, new, changed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from wsgen.checks.rules.robots import MASSLESS_ROOT, NO_VISUAL
from wsgen.descriptions.urdf.reader import UNKNOWN_URDF_VERSION
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.pipeline.check import CheckOutcome
from wsgen.pipeline.reported import (
    Filters,
    about_changes,
    changed_since,
    choose,
    divide_known,
    filter_outcome,
    load_baseline,
    render_baseline,
)

ROBOT = Path("/p/r.urdf")
INVISIBLE = NO_VISUAL.at(ROBOT, 3, message="invisible")
MASSLESS = MASSLESS_ROOT.at(ROBOT, 4, message="massless")
REFUSED = UNKNOWN_URDF_VERSION.at(ROBOT, 1, message="refused")
ALL = (INVISIBLE, MASSLESS, REFUSED)


@pytest.mark.parametrize(
    ("select", "ignore", "left"),
    [
        ([], [], ALL),
        (["no-visual"], [], (INVISIBLE,)),
        (["ROB054,rob051"], [], (INVISIBLE, MASSLESS)),
        (["ROB"], ["no-visual"], (MASSLESS, REFUSED)),
        (["WLD"], [], ()),
        ([], ["all"], ()),
    ],
)
def test_select_and_ignore(select: list[str], ignore: list[str], left: object) -> None:
    assert choose(ALL, select=select, ignore=ignore) == left


def test_an_unknown_rule_is_refused() -> None:
    with pytest.raises(RequestError, match="no-visul") as error:
        Filters(select=["no-visul"]).check()
    assert "`no-visual`" in error.value.hint


def test_what_is_in_the_baseline_is_known(tmp_path: Path) -> None:
    file = tmp_path / "robot.urdf"
    here = [
        NO_VISUAL.at(file, 3, "link", message=f"{file} is invisible"),
        NO_VISUAL.at(file, 5, "link", message=f"{file} is invisible"),
        MASSLESS_ROOT.at(None, message="massless, as line 3 says"),
    ]
    baseline = tmp_path / "baseline.json"
    baseline.write_text(render_baseline(here, tmp_path))
    assert str(tmp_path) not in baseline.read_text()
    assert divide_known(here, load_baseline(baseline), tmp_path) == ((), tuple(here))
    later = [*here[:2], MASSLESS_ROOT.at(None, message="massless, as line 4 says")]
    assert divide_known(later, load_baseline(baseline), tmp_path) == ((), tuple(later))
    moved = NO_VISUAL.at(file, 30, "link", message=f"{file} is invisible")
    new, known = divide_known([*here, moved], load_baseline(baseline), tmp_path)
    assert (new, len(known)) == ((moved,), 3)
    elsewhere = tmp_path / "clone"
    there = NO_VISUAL.at(elsewhere / "robot.urdf", 1, "link", message="robot.urdf is invisible")
    assert divide_known([there], load_baseline(baseline), elsewhere) == ((), (there,))


@pytest.mark.parametrize("text", ["", "[]", '{"version": 2, "diagnostics": []}', '{"version": 1}'])
def test_what_is_no_baseline(tmp_path: Path, text: str) -> None:
    (tmp_path / "b.json").write_text(text)
    with pytest.raises(RequestError, match="is not a baseline"):
        Filters(baseline=tmp_path / "b.json").check()
    with pytest.raises(NotFoundError, match="does not exist"):
        Filters(baseline=tmp_path / "c.json").check()


def git(folder: Path, *words: str) -> None:
    settings = ("-c", "user.name=a", "-c", "user.email=a@b.cd", "-c", "commit.gpgsign=false")
    subprocess.run(["git", "-C", folder, *settings, *words], check=True, capture_output=True)


@pytest.mark.skipif(shutil.which("git") is None, reason="needs git")
def test_changes_since_a_commit(tmp_path: Path) -> None:
    package = tmp_path / "src" / "p"
    package.mkdir(parents=True)
    for name in ("package.xml", "a.urdf", "b ü.urdf", "c.urdf"):
        (package / name).write_text("<robot/>")
    git(tmp_path, "init")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-m", "first")
    assert changed_since("HEAD", package) == frozenset()
    (package / "b ü.urdf").write_text("<robot name='r'/>")
    (package / "c.urdf").rename(package / "d.urdf")
    changed = changed_since("HEAD", package)
    assert {file.name for file in changed} == {"b ü.urdf", "c.urdf", "d.urdf"}

    def at(name: str) -> tuple[object, object]:
        return (
            NO_VISUAL.at(package / name, 1, message="m"),
            UNKNOWN_URDF_VERSION.at(package / name, 1, message="m"),
        )

    untouched, touched = at("a.urdf"), at("d.urdf")
    found = about_changes([*untouched, *touched], changed, [package])  # type: ignore[list-item]
    assert found == (untouched[1], *touched)
    outcome = CheckOutcome(
        diagnostics=(*untouched, *touched),  # type: ignore[arg-type]
        packages=("p",),
        folders={"p": package},
    )
    assert filter_outcome(outcome, Filters(changed_since="HEAD")).diagnostics == found
    with pytest.raises(RequestError, match="not have the commit"):
        changed_since("nowhere", package)
    with pytest.raises(RequestError, match="not have the commit"):
        changed_since("--output=x", package)


@pytest.mark.skipif(shutil.which("git") is None, reason="needs git")
def test_a_folder_without_a_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    (tmp_path / "p").mkdir()
    with pytest.raises(RequestError, match="not in a git repository"):
        changed_since("HEAD", tmp_path / "p")


def test_allowed_in_a_package(tmp_path: Path) -> None:
    robot = tmp_path / "r.urdf"
    robot.write_text("<robot>\n<!-- wsgen: allow no-visual: why -->\n<link/>\n</robot>\n")
    (tmp_path / "wsgen.toml").write_text('[validate]\nallow = ["massless-root"]\n')
    found = (
        NO_VISUAL.at(robot, 3, message="m"),
        MASSLESS_ROOT.at(robot, 3, message="m"),
        UNKNOWN_URDF_VERSION.at(robot, 1, message="m"),
    )
    outcome = CheckOutcome(diagnostics=found, packages=("p",), folders={"p": tmp_path})
    reported = filter_outcome(outcome, Filters())
    assert reported.diagnostics == found[2:]
    assert set(reported.allowed) == set(found[:2])
    assert not reported.passed
    assert json.loads(render_baseline(found, tmp_path))["diagnostics"]


@pytest.mark.skipif(sys.platform == "win32", reason="has no named pipes")
def test_a_baseline_that_is_a_named_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "baseline.json")
    with pytest.raises(NotReadableError, match="named pipe"):
        load_baseline(tmp_path / "baseline.json")
