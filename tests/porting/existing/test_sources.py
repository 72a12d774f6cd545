"""What `wsgen new --from` opens, and what it refuses, with the next step."""

# ruff: noqa: E501  elements as people write them

import io
import random
import stat
import zipfile
from pathlib import Path

import pytest

from existing_robots import ARM, write_arm
from wsgen.errors import NotFoundError, NotReadableError, RequestError, WsgenError
from wsgen.porting.existing import sources
from wsgen.porting.existing.sources import Source, open_source

MACROS = '<robot xmlns:xacro="x"><xacro:macro name="leg" params="n"><link name="${n}"/></xacro:macro></robot>'
CALLS = '<robot xmlns:xacro="x" name="r"><xacro:include filename="leg.xacro"/><xacro:leg n="a"/></robot>'


def opened(given: Path | str, scratch: Path) -> Source:
    scratch.mkdir(exist_ok=True)
    return open_source(str(given), scratch, {})


def test_a_file_is_of_its_package(tmp_path: Path) -> None:
    urdf = write_arm(tmp_path)
    source = opened(urdf, tmp_path / "scratch")
    assert (source.file, source.kind) == (urdf, "urdf")
    assert source.owns(urdf.parents[1] / "meshes" / "cube.obj")
    assert not source.owns(tmp_path / "other.stl")
    assert source.share_of("arm_description") == urdf.parents[1]


def test_comments_ahead_take_no_time(tmp_path: Path) -> None:
    """Sixty lines of a license, each a comment of its own, before what is no robot."""
    ahead = '<?xml version="1.0"?>\n' + "<!-- All rights reserved. -->\n" * 60
    (tmp_path / "a.launch.xml").write_text(f"{ahead}<launch/>")
    (tmp_path / "b.sdf").write_text(f"<sdf version='1.9'>{ahead[22:]}<world name='w'/></sdf>")
    (tmp_path / "c.xml").write_text(f"{ahead}<!DOCTYPE a-b>{ahead[22:]}<mujoco><body/></mujoco>")
    assert opened(tmp_path, tmp_path / "scratch").file.name == "c.xml"


def test_a_link_is_where_it_leads(tmp_path: Path) -> None:
    urdf = write_arm(tmp_path)
    (tmp_path / "secret").write_text("")
    link = urdf.parents[1] / "meshes" / "link.stl"
    link.symlink_to(tmp_path / "secret")
    assert not opened(urdf, tmp_path / "scratch").owns(link)


def test_a_folder_has_one_robot(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "leg.xacro").write_text(MACROS)
    (folder / "r.urdf.xacro").write_text(CALLS)
    (folder / "r.urdf").write_text(ARM)  # what xacro has made of it
    assert opened(folder, tmp_path / "scratch").file == folder / "r.urdf.xacro"
    (folder / "other.urdf").write_text(ARM)
    with pytest.raises(RequestError, match=r"has 2 robots: other\.urdf, r\.urdf\.xacro") as error:
        opened(folder, tmp_path / "scratch")
    assert "other.urdf" in error.value.hint


def packed(folder: Path, *entries: tuple[zipfile.ZipInfo | str, bytes]) -> Path:
    file = folder / "robot.zip"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return file


def test_a_zip_is_unpacked(tmp_path: Path) -> None:
    file = packed(tmp_path, ("a\\urdf\\arm.urdf", ARM.encode()), ("__MACOSX/x.urdf", b"<robot"))
    source = opened(file, tmp_path / "scratch")
    assert source.file.read_text() == ARM
    assert source.shown.endswith("robot.zip/a/urdf/arm.urdf")


def linked() -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo("meshes/link.stl")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    return entry


@pytest.mark.parametrize(
    ("entry", "data", "why"),
    [
        ("../outside.urdf", b"", "leads out of it"),
        ("/etc/outside.urdf", b"", "leads out of it"),
        ("a/../../b.urdf", b"", "leads out of it"),
        ("C:\\b.urdf", b"", "leads out of it"),
        (linked(), b"/etc/passwd", "is a link"),
        ("bomb.stl", b"\0" * 2**25, "unpacks to too much"),
    ],
)
def test_a_zip_stays_in_its_folder(
    entry: zipfile.ZipInfo | str, data: bytes, why: str, tmp_path: Path
) -> None:
    file = packed(tmp_path, ("arm.urdf", ARM.encode()), (entry, data))
    with pytest.raises(NotReadableError, match=why):
        opened(file, tmp_path / "scratch")
    assert not list(tmp_path.rglob("outside*"))


def test_a_zip_has_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = packed(tmp_path, ("a.urdf", ARM.encode()), ("b.stl", b"1234"))
    monkeypatch.setattr(sources, "MOST_ENTRIES", 1)
    with pytest.raises(NotReadableError, match="it has 2 files; the limit is 1"):
        opened(file, tmp_path / "scratch")
    monkeypatch.setattr(sources, "MOST_ENTRIES", 5)
    monkeypatch.setattr(sources, "MOST_BYTES", 100)
    with pytest.raises(NotReadableError, match="unpacks to more than"):
        opened(file, tmp_path / "other")


def test_a_zip_that_is_damaged(tmp_path: Path) -> None:
    file = packed(tmp_path, ("arm.urdf", ARM.encode() * 50))
    data = bytearray(file.read_bytes())
    data[60:90] = b"\xff" * 30
    file.write_bytes(data)
    with pytest.raises(NotReadableError, match="cannot be unpacked"):
        opened(file, tmp_path / "scratch")


@pytest.mark.parametrize("seed", range(4))
def test_a_zip_with_bytes_that_are_wrong(seed: int, tmp_path: Path) -> None:
    """It is opened, or refused with a message; nothing else is raised."""
    whole = packed(tmp_path, ("a/arm.urdf", ARM.encode() * 20), ("a/b.stl", b"1234")).read_bytes()
    chance = random.Random(seed)  # noqa: S311  no secret
    refused = 0
    for number in range(60):
        data = bytearray(whole)
        for _ in range(chance.randrange(1, 6)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        file = tmp_path / f"{number}.zip"
        file.write_bytes(data)
        try:
            opened(file, tmp_path / f"scratch-{number}")
        except WsgenError as error:
            refused += bool(error.hint)
    assert refused > 10


def test_a_zip_with_another_compression(tmp_path: Path) -> None:
    file = tmp_path / "robot.zip"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("arm.urdf", ARM)
    with pytest.raises(NotReadableError, match="is not compressed as zips are"):
        opened(file, tmp_path / "scratch")


def test_a_zip_says_less_than_it_holds(tmp_path: Path) -> None:
    """The sizes of its table are those that it claims."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("arm.urdf", b"<robot/>" + b" " * 2**24)
    claimed = buffer.getvalue().replace(
        (2**24 + 8).to_bytes(4, "little"), (8).to_bytes(4, "little")
    )
    file = tmp_path / "robot.zip"
    file.write_bytes(claimed)
    with pytest.raises(WsgenError):
        opened(file, tmp_path / "scratch")


@pytest.mark.parametrize(
    ("given", "error", "why", "next_step"),
    [
        ("-", RequestError, "not read standard input", "Save it to a file"),
        ("https://example.com/a.urdf", RequestError, "not download anything", "Clone or download"),
        ("git@example.com:a/b.git", RequestError, "not download anything", "Clone or download"),
        ("/dev/null", RequestError, "a device", "Give a URDF"),
        ("missing.urdf", NotFoundError, "does not exist", "Give a file"),
        ("part.stl", RequestError, "not describe a robot", "Give the URDF"),
        ("robot.tar.gz", RequestError, "not describe a robot", "Unpack it"),
        ("notes.txt", RequestError, "not describe a robot", "root element"),
        ("empty", NotFoundError, "has no robot", "Give the folder that has it"),
    ],
)
def test_refused(  # noqa: PLR0917  a table
    given: str,
    error: type[WsgenError],
    why: str,
    next_step: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    for name in ("part.stl", "robot.tar.gz", "notes.txt"):
        (tmp_path / name).write_text("something")
    with pytest.raises(error, match=why) as found:
        opened(given, tmp_path / "scratch")
    assert next_step in found.value.hint


def test_too_many_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_arm(tmp_path / "robot")
    monkeypatch.setattr(sources, "MOST_ENTRIES", 3)
    with pytest.raises(RequestError, match="more than 3 files"):
        opened(tmp_path / "robot", tmp_path / "scratch")
