import errno
import os
from pathlib import Path

import pytest

from wsgen.errors import NotReadableError, WouldOverwriteError
from wsgen.templating.write import adding_files

TREE = {".ci.yml": "a: b\n", ".x/y/z.yml": "ä\n"}
SPARE = {".gitignore": "/build/\n"}


def read(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in folder.rglob("*")
        if path.is_file()
    }


def no_links(*_: object) -> None:
    raise OSError(errno.EPERM, "Operation not permitted")


def test_files_are_added(tmp_path: Path) -> None:
    root = tmp_path / "a" / "ws"
    with adding_files(TREE, root, where_missing=SPARE):
        assert read(root) == {**TREE, **SPARE}
    assert read(root) == {**TREE, **SPARE}
    assert not list(root.glob(".wsgen-*"))


def test_a_disk_without_hard_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "link", no_links)
    (tmp_path / ".gitignore").write_text("mine")
    with adding_files(TREE, tmp_path, where_missing=SPARE):
        pass
    assert read(tmp_path) == {**TREE, ".gitignore": "mine"}


def test_nothing_to_add_touches_nothing(tmp_path: Path) -> None:
    with adding_files({}, tmp_path / "ws", where_missing={}):
        pass
    assert not (tmp_path / "ws").exists()


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit(143), RuntimeError])
def test_what_fails_inside_takes_them_away(
    tmp_path: Path, error: BaseException | type[BaseException]
) -> None:
    (tmp_path / ".x").mkdir()
    expected = error if isinstance(error, type) else type(error)
    with pytest.raises(expected), adding_files(TREE, tmp_path, where_missing=SPARE):
        raise error
    assert read(tmp_path) == {}
    assert [path.name for path in tmp_path.rglob("*")] == [".x"]


@pytest.mark.parametrize("name", TREE)
def test_what_exists_is_not_touched(tmp_path: Path, name: str) -> None:
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / name).write_text("mine")
    with pytest.raises(WouldOverwriteError), adding_files(TREE, tmp_path, where_missing=SPARE):
        pytest.fail("it went on")
    assert read(tmp_path) == {name: "mine"}


@pytest.mark.parametrize("has_links", [True, False])
def test_somebody_is_faster(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, has_links: bool
) -> None:
    """Another command writes the same file after this one has looked."""
    link = os.link if has_links else no_links

    def late(source: Path, place: Path) -> None:
        if place.name == "z.yml":
            place.write_text("theirs")
        link(source, place)

    monkeypatch.setattr(os, "link", late)
    with pytest.raises(WouldOverwriteError), adding_files(TREE, tmp_path, where_missing=SPARE):
        pytest.fail("it went on")
    assert read(tmp_path) == {".x/y/z.yml": "theirs"}


def test_the_disk_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(NotReadableError, match="Free space"):
        adding_files(TREE, tmp_path / "ws", where_missing=SPARE).__enter__()
    assert not list(tmp_path.iterdir())
