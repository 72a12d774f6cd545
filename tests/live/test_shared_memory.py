from __future__ import annotations

import fcntl
import mmap
import time
from typing import TYPE_CHECKING

import pytest

from wsgen.live.resources import remove_left_behind

if TYPE_CHECKING:
    from pathlib import Path

NAMES = (
    *("fastdds_12ab", "fastdds_12ab_el", "fastrtps_port7411", "fastrtps_port7411_sl"),
    "sem.fastrtps_port7411_mutex",
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in (*NAMES, "other"):
        (tmp_path / name).write_bytes(b"\0" * 4096)
    return tmp_path


def _names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_what_nobody_uses_is_removed(folder: Path) -> None:
    remove_left_behind(0.0, folder)
    assert _names(folder) == {"other"}


def test_what_was_there_before_stays(folder: Path) -> None:
    remove_left_behind(time.time() + 60.0, folder)
    assert len(_names(folder)) == len(NAMES) + 1


def test_what_is_in_the_memory_of_a_process_stays(folder: Path) -> None:
    with (
        (folder / "fastdds_12ab").open("r+b") as stream,
        mmap.mmap(stream.fileno(), 0) as memory,
    ):
        stream.close()
        remove_left_behind(0.0, folder)
        assert _names(folder) == {"other", "fastdds_12ab", "fastdds_12ab_el"}
        assert memory[0] == 0


def test_what_another_container_has_locked_stays(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.live.resources._used_segments", lambda _folder: set())
    with (folder / "fastdds_12ab_el").open("r+b") as stream:
        fcntl.flock(stream, fcntl.LOCK_SH)
        remove_left_behind(0.0, folder)
    assert _names(folder) == {"other", "fastdds_12ab", "fastdds_12ab_el"}


def test_a_lock_that_may_not_be_opened_keeps_its_segment(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: Path, flags: int) -> int:
        raise PermissionError(path, flags)

    monkeypatch.setattr("wsgen.live.resources.os.open", refuse)
    monkeypatch.setattr("wsgen.live.resources._used_segments", lambda _folder: set())
    remove_left_behind(0.0, folder)
    assert len(_names(folder)) == len(NAMES) + 1


def test_no_shared_memory_at_all(tmp_path: Path) -> None:
    remove_left_behind(0.0, tmp_path / "missing")
