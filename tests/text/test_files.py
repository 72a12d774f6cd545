"""A file is there whole, or what was there before is."""

import errno
import os
import resource
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from wsgen.errors import NotReadableError
from wsgen.text import files
from wsgen.text.files import (
    explain_write_error,
    mount_point,
    read_regular,
    read_regular_text,
    remembering,
    write_file,
)


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Let the system refuse larger files, as a full disk would."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_text_and_bytes(tmp_path: Path) -> None:
    write_file(tmp_path / "text", "Grüße\n")
    write_file(tmp_path / "bytes", b"\x00\xff")
    assert (tmp_path / "text").read_bytes() == "Grüße\n".encode()
    assert (tmp_path / "bytes").read_bytes() == b"\x00\xff"
    usual = tmp_path / "usual"
    usual.touch()
    assert (tmp_path / "text").stat().st_mode == usual.stat().st_mode


@pytest.mark.parametrize("before", [None, "old"])
def test_what_does_not_fit_leaves_nothing(tmp_path: Path, before: str | None) -> None:
    file = tmp_path / "report.json"
    if before is not None:
        file.write_text(before)
    with (
        files_of_at_most(1000),
        pytest.raises(NotReadableError, match=r"report\.json: the file is larger than"),
    ):
        write_file(file, "x" * 2000)
    assert [path.name for path in tmp_path.iterdir()] == ([] if before is None else [file.name])
    assert before is None or file.read_text() == before


def test_a_link_stays_a_link_and_a_file_keeps_its_mode(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("old")
    file.chmod(0o640)
    link = tmp_path / "link"
    link.symlink_to("file")
    write_file(link, "new")
    assert link.is_symlink()
    assert file.read_text() == "new"
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


KILLED = """
import os, signal, sys
from pathlib import Path
from wsgen.text.files import replace_file

with replace_file(Path(sys.argv[1])) as stream:
    stream.write(b"new")
    stream.flush()
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="files have a name from the beginning")
def test_who_is_killed_leaves_nothing(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text("old")
    try:
        os.close(os.open(tmp_path, os.O_WRONLY | os.O_TMPFILE))
    except OSError:
        pytest.skip("this file system has no files without a name")
    ended = subprocess.run([sys.executable, "-c", KILLED, file], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [("a.txt", "old")]


def test_a_file_system_where_files_have_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.text.files.OPEN_FILES", str(tmp_path / "no such folder"))
    write_file(tmp_path / "a.txt", "new")
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [("a.txt", "new")]


def test_a_stream_is_written_to(tmp_path: Path) -> None:
    with (tmp_path / "output").open("wb") as stream:
        write_file(Path(f"/dev/fd/{stream.fileno()}"), "text")
        assert os.path.samestat(os.fstat(stream.fileno()), (tmp_path / "output").stat())
    assert (tmp_path / "output").read_text() == "text"
    write_file(Path("/dev/null"), "gone")
    assert Path("/dev/null").is_char_device()


def test_a_full_device() -> None:
    with pytest.raises(NotReadableError, match=r"/dev/full: the disk is full \(/") as caught:
        write_file(Path("/dev/full"), "x")
    assert "Free some space on /" in caught.value.hint


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(NotReadableError, match="is a directory"):
        write_file(tmp_path, "x")
    with pytest.raises(NotReadableError, match="the folder does not exist"):
        write_file(tmp_path / "missing" / "file", "x")


@pytest.mark.parametrize(
    ("number", "reason"),
    [
        (errno.ENOSPC, "the disk is full"),
        (errno.EDQUOT, "the disk quota is used up"),
        (errno.EROFS, "the file system is read-only"),
        (errno.EACCES, "permission denied"),
    ],
)
def test_reasons(tmp_path: Path, number: int, reason: str) -> None:
    error = explain_write_error(
        OSError(number, os.strerror(number)), tmp_path / "x", what="the log"
    )
    assert error.message.startswith(f"Cannot write the log: {reason}")
    assert error.exit_code == 4


def test_the_file_system_of_a_path_that_does_not_exist() -> None:
    assert mount_point(Path("/proc/missing/file")) == Path("/proc")
    assert os.path.ismount(mount_point(Path()))


def test_what_is_remembered_does_not_grow_with_the_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "MOST_REMEMBERED", 1000)
    monkeypatch.setattr(files, "MOST_CONTENTS", 8)
    with remembering():
        memory = files._memory
        assert memory is not None
        for number in range(30):
            file = tmp_path / f"{number}"
            file.write_bytes(b"x" * (5 * number))
            for _ in range(2):
                assert read_regular(file, 10_000) == b"x" * (5 * number)
            assert memory.size == sum(len(content) for _, content in memory.contents.values())
            assert memory.size <= 1000
            assert len(memory.contents) <= 8
            assert str(file) in memory.contents
        file.write_bytes(b"changed")
        assert read_regular(file, 10_000) == b"changed"
        assert memory.size == sum(len(content) for _, content in memory.contents.values())


def test_a_file_is_read_once_while_it_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "file"
    file.write_bytes(b"abc")
    with remembering():
        first = read_regular(file, 100)
        monkeypatch.setattr(files, "open", None, raising=False)  # nothing can be opened
        assert read_regular(file, 100) == first


@pytest.mark.skipif(sys.platform == "win32", reason="has no named pipes")
def test_a_text_is_read_from_a_regular_file_of_some_size(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="named pipe"):
        read_regular_text(tmp_path / "pipe")
    (tmp_path / "a").write_bytes(b"\xc3\xa4\r\n\xff")
    assert read_regular_text(tmp_path / "a", errors="replace") == "ä\n\ufffd"
    with pytest.raises(UnicodeDecodeError):
        read_regular_text(tmp_path / "a")
    with pytest.raises(OSError, match="too large"):
        read_regular_text(tmp_path / "a", 4)
