"""The files and the formats in which services show what `wsgen` finds."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest

from cli.packages import wsgen
from cli.test_validate_files import link, urdf
from reporting.test_cases import violations

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "crate.urdf").write_text(urdf(link()))
    (tmp_path / "ghost.urdf").write_text(urdf(link().replace("collision", "collison")))
    return tmp_path


def test_reports_of_validate(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("JENKINS_URL", raising=False)
    words = ("validate", "crate.urdf", "ghost.urdf", "--seconds", "1")
    files = ("--junit", "j.xml", "--summary", "s.md", "--picture", "pictures")
    done = wsgen(folder, *words, *files, "--format", "github", "-q")
    assert done.returncode == 1
    (annotation,) = [line for line in done.stdout.splitlines() if line.startswith("::error ")]
    assert "file=ghost.urdf,line=" in annotation
    root = ET.parse(folder / "j.xml").getroot()
    assert violations(root, extra={"file", "line"}) == []
    crate, ghost = root
    assert (crate.get("name"), crate.get("failures")) == ("files.crate_urdf", "0")
    assert float(crate.get("time", "0")) > 0
    failed = [case for case in ghost if case.find("failure") is not None]
    assert [case.get("name") for case in failed] == [
        "robot descriptions",
        "crate does not sink or fall",
    ]
    assert failed[0].get("file") == "ghost.urdf"
    assert "[[ATTACHMENT|pictures/" in (crate.findtext(".//system-out") or "")
    first = (folder / "s.md").read_text()
    assert first.startswith("## wsgen validate: 1 passed, 1 failed\n")
    # Jenkins' schema has no such attributes, and the summary of another step comes after.
    monkeypatch.setenv("JENKINS_URL", "http://jenkins")
    wsgen(folder, *words, *files, "-q")
    assert violations(ET.parse(folder / "j.xml").getroot()) == []
    assert (folder / "s.md").read_text() == first * 2


def test_reports_of_check(folder: Path) -> None:
    done = wsgen(folder, "check", "ghost.urdf", "--summary", "s.md")
    assert done.returncode == 0
    assert "| `ghost.urdf` | passed | 0 | 1 |" in (folder / "s.md").read_text()


@pytest.mark.parametrize("words", [("validate", "--junit"), ("check", "--summary")])
def test_a_folder_that_does_not_exist(folder: Path, words: tuple[str, str]) -> None:
    command, option = words
    done = wsgen(folder, command, "crate.urdf", option, "nowhere/f")
    assert done.returncode == 4
    assert "The folder of nowhere/f does not exist." in done.stderr


@pytest.mark.parametrize("option", ["--junit", "--html", "--summary"])
def test_a_folder_in_place_of_a_file(folder: Path, option: str) -> None:
    done = wsgen(folder, "validate", "crate.urdf", option, ".")
    assert (done.returncode, done.stdout) == (4, "")
    assert "error: . is a folder.\n  try: Give the path of a file." in done.stderr


def test_two_reports_in_one_file(folder: Path) -> None:
    done = wsgen(folder, "validate", "crate.urdf", "--junit", "x", "--summary", "./x")
    assert (done.returncode, done.stdout) == (2, "")
    assert "error: x is named for two reports." in done.stderr
    assert not (folder / "x").exists()
