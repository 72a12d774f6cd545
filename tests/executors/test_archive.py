"""Archives of files and folders: everything is there after a way through one, below a folder."""

from __future__ import annotations

import os
import stat
import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.errors import RequestError
from wsgen.executors import archive
from wsgen.executors.archive import Archive, at, named_as_there, read_header, unpack

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="paths have drives there")


def sent(made: Archive, folder: Path) -> Path:
    """Where it is unpacked."""
    parts = folder / "parts"
    parts.mkdir()
    written = made.write(parts, b"header")
    assert read_header(written[0]) == b"header"
    unpack(written, folder / "there")
    return folder / "there"


def test_files_and_folders_are_at_their_paths(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archive, "PART_BYTES", 10)
    source = tmp_path / "ws"
    (source / "src" / "empty").mkdir(parents=True)
    (source / "src" / "program").write_bytes(b"0123456789" * 5)
    (source / "src" / "program").chmod(0o555)
    (source / "src" / "nothing").touch()
    (source / "skipped").mkdir()
    (source / "skipped" / "file").touch()
    made = Archive()
    made.add(source, skipped=["skipped"])
    made.add(source / "missing")
    made.add_folder(source / "skipped")
    there = at(sent(made, tmp_path), source)
    assert (there / "src" / "program").read_bytes() == b"0123456789" * 5
    assert os.access(there / "src" / "program", os.X_OK)
    assert (there / "src" / "nothing").read_bytes() == b""
    assert (there / "src" / "empty").is_dir()
    assert [*(there / "skipped").iterdir()] == []
    assert source / "src" / "empty" in made
    assert source / "missing" not in made


def test_links_lead_to_the_same(tmp_path: Path) -> None:
    here = tmp_path / "here"
    (here / "ws").mkdir(parents=True)
    (here / "outside").mkdir()
    (here / "outside" / "mesh.stl").write_text("solid")
    (here / "way").symlink_to(here / "outside")
    links: dict[str, str | Path] = {
        "absolute.stl": here / "outside" / "mesh.stl",
        "relative.stl": "../outside/mesh.stl",
        "through.stl": "../way/mesh.stl",
        "chained.stl": "absolute.stl",
        "above.stl": "../" * 40 + str(here / "outside" / "mesh.stl")[1:],
        "folder": "../outside",
    }
    for name, target in links.items():
        (here / "ws" / name).symlink_to(target)
    (here / "ws" / "dead.stl").symlink_to("/nowhere/mesh.stl")
    (here / "ws" / "loop.stl").symlink_to("loop.stl")
    (here / "ws" / "null.stl").symlink_to("/dev/null")
    os.mkfifo(here / "ws" / "pipe.stl")
    made = Archive()
    made.add(here / "ws")
    root = sent(made, tmp_path)
    here.rename(tmp_path / "gone")
    there = at(root, here / "ws")
    for name in links:
        assert (there / name).is_symlink()
        file = there / name / "mesh.stl" if name == "folder" else there / name
        assert file.read_text() == "solid", name
        assert file.resolve() == at(root.resolve(), here) / "outside" / "mesh.stl"
    assert not (there / "dead.stl").exists()
    assert named_as_there(str((there / "dead.stl").readlink()), root) == "/nowhere/mesh.stl"
    assert (there / "loop.stl").is_symlink()
    assert (there / "null.stl").is_char_device()
    assert stat.S_ISFIFO((there / "pipe.stl").stat().st_mode)


def test_a_way_through_a_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "disk" / "ws").mkdir(parents=True)
    (tmp_path / "disk" / "ws" / "file").write_text("text")
    (tmp_path / "disk" / "secret").write_text("not asked for")
    (tmp_path / "home").symlink_to("disk")
    made = Archive()
    made.add_folder(tmp_path / "home")
    made.add(tmp_path / "home" / "ws")
    root = sent(made, tmp_path)
    there = at(root, tmp_path / "home")
    assert there.is_symlink()
    assert (there / "ws" / "file").read_text() == "text"
    assert not (there / "secret").exists()


def test_what_is_too_much(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "LARGEST_FILE", 10)
    monkeypatch.setattr(archive, "MOST_BYTES", 19)
    (tmp_path / "large").mkdir()
    (tmp_path / "large" / "bag").write_bytes(b"x" * 11)
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "one").write_bytes(b"x" * 10)
    (tmp_path / "link").symlink_to("data")
    made = Archive()
    made.add(tmp_path / "large")
    assert made.left_out == [str(tmp_path / "large" / "bag")]
    made.add(tmp_path / "link")
    (tmp_path / "data" / "two").write_bytes(b"x" * 10)
    with pytest.raises(RequestError, match=rf"most is in {tmp_path}/data\.") as caught:
        made.add(tmp_path / "data")
    assert "--scheduler" in (caught.value.hint or "")
