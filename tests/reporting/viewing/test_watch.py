"""Files that change: their content, their packages, and what editors leave beside them."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.reporting.viewing.view import Watcher

if TYPE_CHECKING:
    from pathlib import Path


def touch(file: Path, text: str = "new") -> None:
    """Write a file as if it had been some time later."""
    before = file.stat().st_mtime_ns if file.exists() else 0
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    os.utime(file, ns=(before + 10**9, before + 10**9))


def package(folder: Path) -> Path:
    for name in ("package.xml", "urdf/robot.urdf", "urdf/parts.xacro", "README.md"):
        touch(folder / name)
    return folder


def test_nothing_is_reported_of_what_does_not_change(tmp_path: Path) -> None:
    root = package(tmp_path / "p")
    watcher = Watcher([root / "urdf" / "robot.urdf"])
    assert watcher.changed() == []


def test_a_change_is_reported_once(tmp_path: Path) -> None:
    root = package(tmp_path / "p")
    watcher = Watcher([root / "urdf" / "robot.urdf"])
    touch(root / "urdf" / "robot.urdf", "other")
    assert watcher.changed() == [str(root / "urdf" / "robot.urdf")]
    assert watcher.changed() == []


def test_all_files_of_the_package_count(tmp_path: Path) -> None:
    root = package(tmp_path / "p")
    watcher = Watcher([root / "urdf" / "robot.urdf"])
    touch(root / "urdf" / "parts.xacro", "other")
    assert watcher.changed() == [str(root / "urdf" / "parts.xacro")]
    touch(root / "meshes" / "new.stl")  # in a new folder
    assert watcher.changed() == [str(root / "meshes")]


def test_a_file_that_was_missing_and_one_that_goes_count(tmp_path: Path) -> None:
    root = package(tmp_path / "p")
    watcher = Watcher([root / "urdf" / "robot.urdf", tmp_path / "elsewhere" / "arm.stl"])
    touch(tmp_path / "elsewhere" / "arm.stl")
    assert watcher.changed() == [str(tmp_path / "elsewhere" / "arm.stl")]
    (root / "urdf" / "robot.urdf").unlink()
    assert watcher.changed() == [str(root / "urdf" / "robot.urdf")]


def test_what_editors_and_builds_leave_does_not_count(tmp_path: Path) -> None:
    root = package(tmp_path / "p")
    watcher = Watcher([root / "urdf" / "robot.urdf"])
    for name in (".robot.urdf.swp", "robot.urdf~", "4913"):
        touch(root / "urdf" / name)
    touch(root / "build" / "Makefile")
    touch(root / "launch_py" / "__pycache__" / "x.pyc")
    assert watcher.changed() == [str(root / "launch_py")]


def test_beside_a_file_of_no_package_only_robots_and_meshes_count(tmp_path: Path) -> None:
    touch(tmp_path / "robot.urdf")
    touch(tmp_path / "part.stl")
    touch(tmp_path / "diary.txt")
    watcher = Watcher([tmp_path / "robot.urdf"])
    touch(tmp_path / "diary.txt", "other")
    touch(tmp_path / "deeper" / "robot.urdf")
    assert watcher.changed() == []
    touch(tmp_path / "part.stl", "other")
    assert watcher.changed() == [str(tmp_path / "part.stl")]


def test_a_link_to_a_folder_above_ends(tmp_path: Path) -> None:
    root = package(tmp_path / "p")
    (root / "urdf" / "again").symlink_to(root)
    watcher = Watcher([root / "urdf" / "robot.urdf"])
    assert watcher.changed() == []
