"""What Gazebo's own parser says is not mixed up with what happens to it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

import gazebo_oracle
from gazebo_oracle import IGN, is_taken
from urdf_texts import ERRORS, link, robot

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(IGN is None, reason="needs Gazebo's `ign sdf`")


@pytest.mark.slow
def test_a_hang_is_no_refusal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gazebo_oracle, "SECONDS", 1)
    os.mkfifo(tmp_path / "r.urdf")  # nobody writes to it
    with pytest.raises(ChildProcessError, match="ended by SIGALRM"):
        is_taken(tmp_path / "r.urdf", tmp_path)


def test_an_exception_is_a_refusal(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ERRORS["friction in words"][1], encoding="utf-8")
    assert not is_taken(tmp_path / "r.urdf", tmp_path)


@pytest.mark.slow
def test_the_end_of_the_process_is_no_refusal(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(robot(link("a")), encoding="utf-8")
    assert is_taken(file, tmp_path)
    calls = gazebo_oracle._calls()
    calls.kill()
    calls.wait()
    with pytest.raises(ChildProcessError, match="ended before"):
        is_taken(file, tmp_path)
    assert is_taken(file, tmp_path)
