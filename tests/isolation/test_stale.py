"""Scratch folders of processes that were killed; those of others are left alone."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import pytest

from wsgen.isolation.parent import PREFIX, SECONDS_TO_HOLD, held, remove_stale

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="folders have no locks there")

HOLD = """
import sys, time
from wsgen.isolation.parent import make_scratch
with make_scratch() as folder:
    (folder / "file").write_text("x")
    print(folder, flush=True)
    time.sleep(60)
"""


def aged(folder: Path) -> Path:
    long_ago = time.time() - 2 * SECONDS_TO_HOLD
    os.utime(folder, (long_ago, long_ago), follow_symlinks=False)
    return folder


def test_the_folder_of_a_killed_process_is_removed(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )
    with process:
        assert process.stdout is not None
        folder = aged(tmp_path / Path(process.stdout.readline().strip()).name)
        remove_stale(str(tmp_path))
        assert (folder / "file").is_file()  # its process is alive
        process.send_signal(signal.SIGKILL)
    aged(folder)
    remove_stale(str(tmp_path))
    assert not folder.exists()


def test_folders_that_are_held_hide_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.isolation.parent.MOST_REMOVED", 2)
    folders = [tmp_path / f"{PREFIX}{number}" for number in range(8)]
    for folder in folders:
        folder.mkdir()
        aged(folder)
    found = [Path(entry.path) for entry in os.scandir(tmp_path)]  # as remove_stale finds them
    with ExitStack() as stack:
        for folder in found[:4]:
            stack.enter_context(held(str(folder)))
        remove_stale(str(tmp_path))
        assert {*tmp_path.iterdir()} == {*found[:4], *found[6:]}


def test_other_folders_are_left_alone(tmp_path: Path) -> None:
    young = tmp_path / f"{PREFIX}young"
    young.mkdir()
    of_others = tmp_path / "wsgen-older"
    of_others.mkdir()
    aged(of_others)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    link = tmp_path / f"{PREFIX}link"
    link.symlink_to(elsewhere)
    file = tmp_path / f"{PREFIX}file"
    file.touch()
    for one in (elsewhere, link, file):
        aged(one)
    mine = tmp_path / f"{PREFIX}mine"
    mine.mkdir()
    aged(mine)
    before = {*tmp_path.iterdir()}
    with held(str(mine)):
        remove_stale(str(tmp_path))
        assert {*tmp_path.iterdir()} == before
    remove_stale(str(tmp_path))
    assert {*tmp_path.iterdir()} == before - {mine}
    remove_stale(str(tmp_path / "missing"))
