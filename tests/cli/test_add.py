"""`wsgen add`: what it prints, what it refuses, and that nothing is half-written."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest

from porting.adding.added import workspace
from wsgen.cli import run

if TYPE_CHECKING:
    from pathlib import Path

WORDS = ["add", "node", "talker", "--publishes", "chatter:std_msgs/String"]


def state(root: Path) -> dict[str, bytes]:
    return {
        file.as_posix(): file.read_bytes()
        for file in root.rglob("*")
        if file.is_file() and ".git" not in file.parts
    }


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The workspace `python_package`, committed; it is the current folder."""
    root = workspace(tmp_path, "python_package")
    for words in ("init -q", "add -A", "-c user.name=a -c user.email=a@b.c commit -qm a"):
        subprocess.run(["git", *words.split()], cwd=root, check=True)
    monkeypatch.chdir(root)
    return root


def test_it_is_added_once(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*WORDS, "--diff"]) == 0
    shown = capsys.readouterr().out
    assert "+            'talker = beetle_bringup.talker:main'," in shown.splitlines()
    assert "\n-" not in shown.replace("\n---", "")
    before = state(root)
    assert run(WORDS) == 0
    assert "Created src/beetle_bringup/beetle_bringup/talker.py" in capsys.readouterr().err
    after = state(root)
    assert before != after
    assert run(WORDS) == 0  # what it would change is not committed, and it changes nothing
    assert "Nothing to add: beetle_bringup has all of it." in capsys.readouterr().err
    assert state(root) == after


def test_what_git_cannot_take_back(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = root / "src/beetle_bringup/setup.py"
    file.write_text(file.read_text() + "\n# mine\n")
    before = state(root)
    assert run(WORDS) == 2
    assert "has changes that are not committed (1 file)" in capsys.readouterr().err
    assert state(root) == before
    assert run([*WORDS, "--force"]) == 0


def test_nothing_is_half_written(
    root: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file in the place of a folder: what was written before it is taken back."""
    (root / "src/beetle_bringup/test").write_text("")
    before = state(root)
    assert run(WORDS) == 4
    assert "nothing has changed" in capsys.readouterr().err
    assert state(root) == before


@pytest.mark.slow
def test_what_is_reported_then_is_taken_back(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A world for the simulator that the package does not start, and one for that."""
    before = state(root)
    assert run(["add", "world", "field", "--sim", "gz", "--check"]) == 1
    out = capsys.readouterr().out
    assert out.startswith("Nothing is added: wsgen check would then report this, too.")
    assert "but Gazebo Classic loads this world" in out
    assert state(root) == before
    assert run(["add", "world", "field", "--check"]) == 0
    assert state(root) != before


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["add", "nod", "a"], 2, "wsgen add node"),
        (["add", "node", "a", "--to", "beetle"], 4, "Did you mean `beetle_bringup`?"),
        (["add", "node", "a", "--to", "./nowhere"], 4, "is not a package: it has no package.xml"),
        (["add", "node", "a", "--language", "c++"], 2, "Did you mean `cpp`?"),
        (["add", "message", "Hoot"], 2, "ros2 pkg create beetle_bringup_interfaces"),
    ],
)
def test_refusals(
    root: Path, capsys: pytest.CaptureFixture[str], words: list[str], code: int, says: str
) -> None:
    before = state(root)
    assert run(words) == code
    assert says in capsys.readouterr().err
    assert state(root) == before


def test_what_is_left_to_paste(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = root / "src/beetle_bringup/setup.py"
    text = file.read_text()
    file.write_text(text.replace("entry_points={", "entry_points=dict() or {"))
    assert run([*WORDS, "--force"]) == 0
    out = capsys.readouterr().out
    assert "src/beetle_bringup/setup.py: Add it to `console_scripts`" in out
    assert "    'talker = beetle_bringup.talker:main'," in out


def test_the_kinds_of_a_sensor_are_named_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["add", "sensor", "front"]) == 2
    assert "Choose from: lidar, camera, depth, imu, gps, contact." in capsys.readouterr().err
