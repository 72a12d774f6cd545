import os
from pathlib import Path

import pytest

from wsgen.templating.environment import CodeFile, Entry

CODE = compile("1 + 1", "<test>", "eval")
ENTRIES: dict[str, Entry] = {"key": ("checksum", CODE)}


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "wsgen"


def only_file(folder: Path) -> Path:
    (file,) = folder.iterdir()
    return file


def test_what_is_written_is_read(cache: Path) -> None:
    assert CodeFile("3").read() == {}
    CodeFile("3").write(ENTRIES)
    assert CodeFile("3").read() == ENTRIES
    assert CodeFile("4").read() == {}


def test_nobody_else_may_read_or_write(cache: Path) -> None:
    CodeFile("3").write(ENTRIES)
    assert cache.stat().st_mode & 0o777 == 0o700
    assert only_file(cache).stat().st_mode & 0o777 == 0o600


@pytest.mark.slow
@pytest.mark.parametrize("content", [b"", b"x", b"\0" * 100, b"i\1\0\0\0", b"[\xff\xff\xff\x03"])
def test_broken_file_is_no_file(cache: Path, content: bytes) -> None:
    CodeFile("3").write(ENTRIES)
    only_file(cache).write_bytes(content)
    assert CodeFile("3").read() == {}


def test_a_fifo_in_the_place_of_the_file(cache: Path) -> None:
    CodeFile("3").write(ENTRIES)
    file = only_file(cache)
    file.unlink()
    os.mkfifo(file)
    assert CodeFile("3").read() == {}  # and nothing waits for who writes into it
    CodeFile("3").write(ENTRIES)
    assert CodeFile("3").read() == ENTRIES


def test_cut_file_is_no_file(cache: Path) -> None:
    CodeFile("3").write(ENTRIES)
    file = only_file(cache)
    file.write_bytes(file.read_bytes()[:-5])
    assert CodeFile("3").read() == {}


def test_file_that_others_may_write_is_not_trusted(cache: Path) -> None:
    CodeFile("3").write(ENTRIES)
    only_file(cache).chmod(0o620)
    assert CodeFile("3").read() == {}


def test_folder_that_others_may_write_is_not_trusted(cache: Path) -> None:
    CodeFile("3").write(ENTRIES)
    cache.chmod(0o777)
    assert CodeFile("3").read() == {}


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
def test_file_of_somebody_else_is_not_trusted(cache: Path) -> None:
    CodeFile("3").write(ENTRIES)
    os.chown(only_file(cache), 65534, 65534)
    assert CodeFile("3").read() == {}
    os.chown(only_file(cache), 0, 0)
    os.chown(cache, 65534, 65534)
    assert CodeFile("3").read() == {}


def test_link_is_not_followed(cache: Path, tmp_path: Path) -> None:
    CodeFile("3").write(ENTRIES)
    file = only_file(cache)
    file.rename(tmp_path / "elsewhere")
    file.symlink_to(tmp_path / "elsewhere")
    assert CodeFile("3").read() == {}


def test_nothing_fails_where_there_is_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    CodeFile("3").write(ENTRIES)
    assert CodeFile("3").read() == {}


def test_relative_cache_home_is_ignored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "cache")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    CodeFile("3").write(ENTRIES)
    assert not (tmp_path / "cache").exists()
    assert (tmp_path / "home" / ".cache" / "wsgen").is_dir()


def test_full_disk_leaves_the_old_file(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    CodeFile("3").write(ENTRIES)

    def fail(*_arguments: object, **_options: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", fail)
    CodeFile("3").write({})
    assert CodeFile("3").read() == ENTRIES
    assert only_file(cache)
