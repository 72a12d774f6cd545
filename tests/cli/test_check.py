"""`wsgen check` on the command line."""

from __future__ import annotations

import json
import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import wsgen.cli
from wsgen.cli.check_output import render_summary
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.pipeline.check import CheckOutcome
from wsgen.pipeline.reported import Reported

GOLDEN = Path(__file__).parents[1] / "golden" / "simple-jazzy-gz" / "ws_gazebo"
BAD = """<robot name="r" version="2.0">\r
  <!-- axis -->\r
  <link name="base"/><link name="arm"/>\r
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/>\r
    <axis xyz="0 0 2"/>\r
  </joint>\r
</robot>\r
"""
FIXED = BAD.replace("2.0", "1.0").replace("0 0 2", "0 0 1")


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A URDF with an error and a warning that can be fixed, and other diagnostics."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "r.urdf"
    file.write_bytes(BAD.encode())
    return file


def run(*words: str) -> int:
    return wsgen.cli.run(["check", *words, "--color", "never"])


def test_the_result_of_a_file(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("r.urdf") == 1
    out, err = capsys.readouterr()
    assert "r.urdf:1:1: error[ROB047] unknown-urdf-version: " in out
    assert "r.urdf:5:5: warning[ROB019] unnormalized-axis: " in out
    assert out.splitlines()[-1] == "2 diagnostics can be fixed: add --fix, or --diff first."
    assert err == ""
    assert robot.read_bytes() == BAD.encode()


def test_quiet(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("r.urdf", "-q", "--select", "ROB019,ROB047") == 1
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(": ")[1].split()[0] for line in lines] == [
        "error[ROB047]",
        "warning[ROB019]",
    ]
    assert lines[0].startswith(robot.name)


def test_select_ignore_and_strict(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("r.urdf", "--select", "unnormalized-axis") == 0
    assert run("r.urdf", "--select", "unnormalized-axis", "--strict") == 1
    assert run("r.urdf", "--ignore", "ROB") == 0
    capsys.readouterr()
    assert run("r.urdf", "--ignore", "ROB999") == 2
    assert "rule or family 'ROB999' does not exist" in capsys.readouterr().err
    assert robot.exists()


def test_diff_writes_nothing(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("r.urdf", "--diff") == 1
    out = capsys.readouterr().out
    assert out.startswith("--- a/r.urdf\n+++ b/r.urdf\n")
    assert '-    <axis xyz="0 0 2"/>\r\n+    <axis xyz="0 0 1"/>\r\n' in out
    assert robot.read_bytes() == BAD.encode()


def test_fix_changes_only_what_it_must(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot.chmod(0o640)
    assert run("r.urdf", "--fix", "--select", "ROB019,ROB047") == 0
    out, err = capsys.readouterr()
    assert out == "Fixed 2 diagnostics.\n1 file checked: no errors.\n"
    assert err == "Fixed r.urdf\n"
    assert robot.read_bytes() == FIXED.encode()
    assert stat.S_IMODE(robot.stat().st_mode) == 0o640
    assert run("r.urdf", "--fix", "--select", "ROB019,ROB047") == 0
    assert robot.read_bytes() == FIXED.encode()
    assert [file.name for file in robot.parent.iterdir()] == ["r.urdf"]


def test_what_is_ignored_is_not_fixed(robot: Path) -> None:
    run("r.urdf", "--fix", "--ignore", "unnormalized-axis")
    assert robot.read_bytes() == BAD.replace("2.0", "1.0").encode()


def test_a_link_stays_a_link(robot: Path) -> None:
    target = robot.parent / "real" / "r.urdf"
    target.parent.mkdir()
    robot.rename(target)
    robot.symlink_to(target)
    run("r.urdf", "--fix")
    assert robot.is_symlink()


def test_a_read_only_file_is_left_alone(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.access", lambda _, mode: mode != os.W_OK)
    assert run("r.urdf", "--fix") == 1
    assert robot.read_bytes() == BAD.encode()


def test_formats(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("r.urdf", "--format", "json") == 1
    document = json.loads(capsys.readouterr().out)
    assert document["files"] == [str(robot)]
    assert "ROB047" in {one["code"] for one in document["diagnostics"]}
    assert run("r.urdf", "--format", "sarif") == 1
    assert json.loads(capsys.readouterr().out)["version"] == "2.1.0"
    assert run("r.urdf", "--format", "junit") == 1
    assert ET.fromstring(capsys.readouterr().out).tag == "testsuites"
    assert run("r.urdf", "--format", "github") == 1
    assert capsys.readouterr().out.startswith("::error title=")
    assert run("r.urdf", "--format", "json", "--diff") == 2


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="others have no such names")
@pytest.mark.parametrize("output_format", ["text", "json", "sarif", "junit", "github"])
def test_a_file_name_that_is_not_utf_8(robot: Path, output_format: str) -> None:
    robot.rename(os.fsdecode(b"\xff.urdf"))
    words = ("check", ".", "--format", output_format)
    for environment in ({"LC_ALL": "C.UTF-8"}, {"LC_ALL": "C", "PYTHONUTF8": "0"}):
        for options in (
            words,
            *[(*words, "--write-baseline", "b.json")] * (output_format == "text"),
        ):
            ended = subprocess.run(
                [sys.executable, "-m", "wsgen", *options],
                capture_output=True,
                env={**os.environ, **environment},
                check=False,
            )
            assert ended.returncode == (1 if options == words else 0), ended.stderr
            ended.stdout.decode()
    if output_format == "text":
        assert run(".", "--baseline", "b.json") == 0


def test_statistics(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(robot.name, "-q", "--statistics", "--select", "ROB019") == 0
    assert capsys.readouterr().out.splitlines()[-1].split() == [
        *("1", "warning", "ROB019", "unnormalized-axis")
    ]


def test_a_baseline(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("r.urdf", "--write-baseline", "b.json") == 0
    assert run("r.urdf", "--baseline", "b.json") == 0
    robot.write_text(BAD.replace('xyz="0 0 2"', 'xyz="0 0 0"'), newline="")
    capsys.readouterr()
    assert run("r.urdf", "--baseline", "b.json") == 1
    out = capsys.readouterr().out
    assert "zero-axis" in out
    assert "unknown-urdf-version" not in out
    assert run("r.urdf", "--baseline", "none.json") == 4


def test_a_comment_with_a_reason(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    comment = "<!-- wsgen: allow unknown-urdf-version, unnormalized-axis: they are old -->"
    robot.write_text(comment + BAD.replace("\r\n  ", "").replace("\r\n", ""))
    assert run("r.urdf", "--select", "ROB047,ROB019,PKG") == 0
    assert "2 allowed" in capsys.readouterr().out


@pytest.mark.slow
def test_our_own_package_has_no_diagnostics(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    workspace = tmp_path / "ws"
    shutil.copytree(GOLDEN, workspace)
    monkeypatch.chdir(workspace)
    assert run("--strict") == 0
    summary = "1 package checked: no errors. Not counted: 1 allowed.\n"
    assert capsys.readouterr().out == summary
    assert run("-v") == 0
    out = capsys.readouterr().out
    assert "robot.xacro:" in out
    assert "allowed[ROB051] massless-root: " in out
    assert out.endswith(summary)
    (workspace / "src" / "gazebo_test" / "wsgen.toml").unlink()
    assert run() == 0


def test_a_path_that_does_not_exist(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(str(tmp_path / "none")) == 4
    assert "does not exist" in capsys.readouterr().err


def test_who_sees_notes_is_not_told_how() -> None:
    found = Diagnostic(code="ROB051", name="n", severity=Severity.INFO, message="m")
    outcome, reported = CheckOutcome(packages=("a",)), Reported(diagnostics=(found,))
    assert render_summary(outcome, reported)[-1] == "-v shows notes."
    assert len(render_summary(outcome, reported, verbose=True)) == 1
