import errno
import os
import resource
import shutil
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from wsgen.errors import NotReadableError, WouldOverwriteError
from wsgen.templating.write import UNFINISHED_PREFIX, write_package

TREE = {"package.xml": "<package/>\n", "launch/a.launch.py": "ä = 1\n", "model/x/y.txt": "y\n" * 99}

# Writes TREE in a process of its own, in which something happens.
SCRIPT = """
import os, signal, sys, time
from pathlib import Path
from wsgen.errors import WsgenError
from wsgen.templating import write

tree = {tree!r}
folder = Path({folder!r})
{preparation}
try:
    write.write_package(tree, folder)
except WsgenError as error:
    sys.exit(error.exit_code)
"""


def start(folder: Path, preparation: str = "") -> subprocess.Popen[str]:
    script = SCRIPT.format(tree=TREE, folder=str(folder), preparation=textwrap.dedent(preparation))
    return subprocess.Popen([sys.executable, "-c", script], text=True, stdout=subprocess.PIPE)


def finish(process: subprocess.Popen[str]) -> int:
    process.communicate(timeout=300)
    return process.returncode


def identity(file: Path) -> tuple[int, ...]:
    """What changes when it is written or replaced; the time of access does with each reading."""
    status = file.lstat()
    return (status.st_mode, status.st_ino, status.st_size, status.st_mtime_ns)


def read(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in folder.rglob("*")
        if path.is_file()
    }


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Where the package is to be; its workspace does not exist yet."""
    return tmp_path / "ws" / "src" / "robot"


def test_package_is_written_with_its_parents(folder: Path) -> None:
    write_package(TREE, folder)
    assert read(folder) == TREE
    assert names(folder.parent) == ["robot"]


def test_modes_follow_the_umask(folder: Path) -> None:
    umask = os.umask(0o027)
    try:
        write_package(TREE, folder)
    finally:
        os.umask(umask)
    assert folder.stat().st_mode & 0o777 == 0o750
    assert (folder / "package.xml").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("kind", ["full", "empty", "file", "link", "broken link"])
def test_nothing_is_overwritten(folder: Path, tmp_path: Path, kind: str) -> None:
    folder.parent.mkdir(parents=True)
    if kind in {"full", "empty"}:
        folder.mkdir()
        if kind == "full":
            (folder / "mine").write_text("mine")
    elif kind == "file":
        folder.write_text("mine")
    else:
        folder.symlink_to(tmp_path if kind == "link" else tmp_path / "nowhere")
    before = (identity(folder), read(tmp_path))
    with pytest.raises(WouldOverwriteError, match="already exists"):
        write_package(TREE, folder)
    assert (identity(folder), read(tmp_path)) == before
    assert names(folder.parent) == ["robot"]


def test_package_that_appears_at_the_last_moment_is_kept(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename = Path.rename

    def somebody_is_faster(source: Path, target: Path) -> None:
        target.mkdir()
        (target / "mine").write_text("mine")
        rename(source, target)

    monkeypatch.setattr(Path, "rename", somebody_is_faster)
    with pytest.raises(WouldOverwriteError):
        write_package(TREE, folder)
    assert read(folder) == {"mine": "mine"}
    assert names(folder.parent) == ["robot"]


@pytest.mark.parametrize("moment", range(len(TREE)))
def test_killed_at_any_file(folder: Path, moment: int) -> None:
    process = start(
        folder,
        f"""
        moments = iter(range(99))
        os.fsync = lambda _file: (
            os.kill(os.getpid(), signal.SIGKILL) if next(moments) == {moment} else None
        )
        """,
    )
    assert finish(process) == -signal.SIGKILL
    (leftover,) = names(folder.parent)
    assert leftover.startswith(UNFINISHED_PREFIX)
    # The next command writes the package and takes the leftover away.
    write_package(TREE, folder)
    assert read(folder) == TREE
    assert names(folder.parent) == ["robot"]


KILL = "lambda *_, **__: os.kill(os.getpid(), signal.SIGKILL)"


def test_killed_before_the_rename(folder: Path) -> None:
    assert finish(start(folder, f"Path.rename = {KILL}")) == -signal.SIGKILL
    assert not folder.exists()


def test_killed_after_the_rename(folder: Path) -> None:
    assert finish(start(folder, f"write.shutil.rmtree = {KILL}")) == -signal.SIGKILL
    assert read(folder) == TREE
    write_package(TREE, folder.with_name("other"))
    assert names(folder.parent) == ["other", "robot"]


def test_work_of_others_is_no_leftover(folder: Path) -> None:
    process = start(
        folder.with_name("slow"),
        """
        os.fsync = lambda _file: (print("here", flush=True), time.sleep(600))
        """,
    )
    assert process.stdout is not None
    process.stdout.readline()
    write_package(TREE, folder)
    unfinished, finished = names(folder.parent)
    process.kill()
    finish(process)
    assert unfinished.startswith(UNFINISHED_PREFIX)
    assert finished == "robot"


@pytest.mark.slow
def test_of_two_at_once_one_wins(folder: Path) -> None:
    for _ in range(5):
        codes = [finish(process) for process in [start(folder) for _ in range(4)]]
        assert sorted(codes) == [0, 3, 3, 3]
        assert read(folder) == TREE
        assert names(folder.parent) == ["robot"]
        shutil.rmtree(folder.parents[1])


@pytest.mark.parametrize("moment", range(len(TREE)))
def test_full_disk(folder: Path, moment: int, monkeypatch: pytest.MonkeyPatch) -> None:
    moments = iter(range(99))

    def fsync(_file: int) -> None:
        if next(moments) == moment:
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(NotReadableError, match="No space left") as caught:
        write_package(TREE, folder)
    assert "Free space" in caught.value.hint
    assert not folder.parents[1].exists()


def test_limit_of_file_size(folder: Path) -> None:
    """A disk that really refuses to write on."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    process = start(
        folder,
        f"""
        import resource
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, {hard}))
        """,
    )
    assert finish(process) == 4
    assert not folder.parents[1].exists()
    assert resource.getrlimit(resource.RLIMIT_FSIZE) == (soft, hard)


def test_folder_where_nobody_may_write(tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    process = start(
        Path("ws/src/robot"),
        f"""
        os.chdir({str(tmp_path)!r})
        if os.geteuid() == 0:
            os.setuid(65534)
        """,
    )
    assert finish(process) == 4
    assert names(tmp_path) == []


def test_file_in_the_way(tmp_path: Path) -> None:
    (tmp_path / "ws").write_text("mine")
    with pytest.raises(NotReadableError, match="Not a directory") as caught:
        write_package(TREE, tmp_path / "ws" / "src" / "robot")
    assert "A file is where a folder should be" in caught.value.hint
    assert read(tmp_path) == {"ws": "mine"}


def test_path_that_is_too_long(tmp_path: Path) -> None:
    with pytest.raises(NotReadableError, match="too long"):
        write_package(TREE, tmp_path / ("w" * 300) / "src" / "robot")


def test_interrupted(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(_file: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_package(TREE, folder)
    assert not folder.parents[1].exists()


def test_disk_without_locks(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.parent.mkdir(parents=True)
    (folder.parent / f"{UNFINISHED_PREFIX}1-00").mkdir()

    def flock(_file: int, _operation: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("wsgen.templating.write.fcntl.flock", flock)
    write_package(TREE, folder)
    assert read(folder) == TREE
    # Whether somebody is at work there cannot be known.
    assert len(names(folder.parent)) == 2


def test_a_program_may_be_executed_by_who_may_read_it(tmp_path: Path) -> None:
    write_package({"scripts/node.py": "#!/usr/bin/env python3\n", "a.py": "a\n"}, tmp_path / "new")
    modes = {name: (tmp_path / "new" / name).stat().st_mode for name in ("scripts/node.py", "a.py")}
    assert (modes["scripts/node.py"] ^ modes["a.py"]) & 0o777 == (modes["a.py"] & 0o444) >> 2
