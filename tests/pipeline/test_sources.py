"""The source of an installed package."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.pipeline.package_validation import (
    changed_since_build,
    is_folder_reported,
    name_sources,
)


@pytest.fixture
def source(tmp_path: Path) -> Path:
    folder = tmp_path / "src" / "some_robot"
    (folder / "model").mkdir(parents=True)
    (folder / "model" / "robot.xacro").write_text("<robot/>")
    (folder / "CMakeLists.txt").write_text("")
    return folder


@pytest.fixture
def share(source: Path, tmp_path: Path) -> Path:
    folder = tmp_path / "install" / "share" / "some_robot"
    shutil.copytree(source / "model", folder / "model")
    (folder / "local_setup.sh").write_text("")
    return folder


def diagnostic(file: Path | None) -> Diagnostic:
    return Diagnostic(
        name="some-rule", code="ROB050", severity=Severity.WARNING, message="m", file=file, line=3
    )


def test_the_file_that_a_person_edits_is_named(share: Path, source: Path) -> None:
    (named,) = name_sources([diagnostic(share / "model" / "robot.xacro")], {share: source})
    assert (named.file, named.line) == (source / "model" / "robot.xacro", 3)


def test_a_copy_that_differs_is_named_itself(share: Path, source: Path) -> None:
    installed = share / "model" / "robot.xacro"
    installed.write_text("<robot>")
    assert [found.file for found in name_sources([diagnostic(installed)], {share: source})] == [
        installed
    ]


@pytest.mark.parametrize("place", [None, "elsewhere", "install/share/some_robot/local_setup.sh"])
def test_files_without_a_source_stay(
    share: Path, source: Path, tmp_path: Path, place: str | None
) -> None:
    file = None if place is None else tmp_path / place
    assert [found.file for found in name_sources([diagnostic(file)], {share: source})] == [file]


def test_nothing_changed(share: Path, source: Path) -> None:
    (source / "model" / "robot.xacro").touch()
    assert list(changed_since_build(share, source)) == []


def test_a_change_without_a_build(share: Path, source: Path) -> None:
    (source / "model" / "robot.xacro").write_text("<robo2/>")
    (found,) = changed_since_build(share, source)
    assert found.code == "PKG052"
    assert "model/robot.xacro" in found.message
    assert "wsgen build" in (found.hint or "")


def test_what_a_build_has_generated_is_no_change(share: Path, source: Path) -> None:
    (share / "model" / "robot.xacro").write_text("<generated/>")
    assert list(changed_since_build(share, source)) == []


def test_files_that_are_new_or_gone_are_no_change(share: Path, source: Path) -> None:
    (source / "model" / "robot.xacro").unlink()
    (source / "model" / "new.xacro").write_text("")
    assert list(changed_since_build(share, source)) == []


def test_a_folder_that_is_missing_is_one_mistake(share: Path) -> None:
    """Its other files need no error of their own."""
    robot = replace(
        diagnostic(None), severity=Severity.ERROR, element=str(share / "worlds" / "r.urdf")
    )
    assert is_folder_reported(share / "worlds" / "w.sdf", [robot])
    assert not is_folder_reported(share / "worlds" / "w.sdf", [diagnostic(None)])
    assert not is_folder_reported(share / "other" / "w.sdf", [robot])
    (share / "worlds").mkdir()
    assert not is_folder_reported(share / "worlds" / "w.sdf", [robot])
