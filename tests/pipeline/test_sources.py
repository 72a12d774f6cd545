"""The source of an installed package."""

import os
import shutil
import time
from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.rules.worlds import is_folder_reported, missing_world
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.plan import LaunchPlan, Process
from wsgen.packages.workspace.layout import PackageFolder, Workspace, read_package
from wsgen.packages.workspace.overlay import open_overlay
from wsgen.pipeline.changed_since_build import (
    InstalledSource,
    changed_since_build,
    name_sources,
    source_of,
    used_packages,
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


def test_a_file_that_is_installed_to_another_folder(share: Path, source: Path) -> None:
    (source / "launch").mkdir()
    (source / "launch" / "robot.launch.py").write_text("pass")
    installed = share / "robot.launch.py"
    installed.write_text("pass")
    (named,) = name_sources([diagnostic(installed)], {share: source})
    assert named.file == source / "launch" / "robot.launch.py"
    (source / "old").mkdir()
    shutil.copy(installed, source / "old")
    (named,) = name_sources([diagnostic(installed)], {share: source})
    assert named.file == installed  # nobody knows which


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
    os.utime(share / "model" / "robot.xacro", (5.0, 5.0))
    (found,) = changed_since_build(share, source)
    assert found.code == "PKG052"
    assert "model/robot.xacro" in found.message
    assert "wsgen build" in (found.hint or "")
    assert "Remove" not in (found.hint or "")


def test_a_change_that_no_build_of_setuptools_would_install(share: Path, source: Path) -> None:
    (source / "model" / "robot.xacro").write_text("<robo2/>")
    os.utime(source / "model" / "robot.xacro", (5.75, 5.75))
    os.utime(share / "model" / "robot.xacro", (5.25, 5.25))
    (found,) = changed_since_build(share, source)
    assert "Remove the folders build and install" in (found.hint or "")


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


MANIFEST = """<package format="3"><name>some_robot</name><version>0.0.0</version>
<description>d</description><maintainer email="a@b.c">m</maintainer><license>MIT</license>
{}<export><build_type>{}</build_type></export></package>"""
SETUP = """
from setuptools import find_packages, setup
setup(
    name="some_robot",
    packages=find_packages(),
    data_files=[("share/some_robot/launch", ["bringup/run.launch.py"])],
    scripts=["scripts/helper"],
    entry_points={"console_scripts": ["driver = some_robot.driver:main"]},
)
"""
CMAKE = """
cmake_minimum_required(VERSION 3.20)
project(some_robot LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
find_package(ament_cmake_python REQUIRED)
configure_file(model/robot.xacro generated/robot.xacro)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/generated/robot.xacro DESTINATION share/some_robot/model)
install(PROGRAMS scripts/driver.py DESTINATION lib/some_robot RENAME driver)
ament_python_install_package(some_robot)
ament_package()
"""


def write(file: Path, text: str, *, age: float = 0.0) -> None:
    """Write a file that is so many seconds old."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    os.utime(file, (file.stat().st_mtime - age,) * 2)


class Built:
    """A package in an install space; its files are an hour old."""

    def __init__(self, folder: Path) -> None:
        self.source = folder / "src" / "some_robot"
        self.prefix = folder / "install" / "some_robot"
        self.share = self.prefix / "share" / "some_robot"
        write(self.share / "package.sh", "", age=60)

    def copy(self, source: str, installed: str, text: str) -> None:
        write(self.source / source, text, age=3600)
        target = self.prefix / installed
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(self.source / source, target)

    def changed(self) -> str | None:
        found = [*changed_since_build(self.share, self.source)]
        assert len(found) < 2
        return found[0].message if found else None


@pytest.fixture
def python(tmp_path: Path) -> Built:
    """An ament_python package."""
    built = Built(tmp_path)
    built.copy("package.xml", "share/some_robot/package.xml", MANIFEST.format("", "ament_python"))
    write(built.source / "setup.py", SETUP, age=3600)
    config = "[install]\ninstall_scripts=$base/lib/some_robot\n"
    write(built.source / "setup.cfg", config, age=3600)
    modules = "lib/python3.12/site-packages/some_robot"
    for module in ("__init__.py", "driver.py", "control/__init__.py", "control/pid.py"):
        built.copy(f"some_robot/{module}", f"{modules}/{module}", "KNOWN = 1\n")
    built.copy("bringup/run.launch.py", "share/some_robot/launch/run.launch.py", "")
    write(built.source / "scripts/helper", "#!/usr/bin/env python3\nprint(1)\n", age=3600)
    write(built.prefix / "lib/some_robot/helper", "#!/usr/bin/python3\nprint(1)\n", age=3600)
    write(built.prefix / "lib/some_robot/driver", "#!/usr/bin/python3\nimport sys", age=3600)
    return built


def test_a_package_that_is_as_it_was_built(python: Built) -> None:
    assert python.changed() is None
    write(python.source / "README.md", "new")  # it is not installed
    (python.source / "some_robot/driver.py").touch()
    (python.source / "scripts/helper").touch()
    assert python.changed() is None


@pytest.mark.parametrize(
    "file",
    [
        "some_robot/driver.py",
        "some_robot/control/pid.py",
        "bringup/run.launch.py",
        "scripts/helper",
    ],
)
def test_what_is_edited_in_a_python_package(python: Built, file: str) -> None:
    write(python.source / file, "#!/usr/bin/env python3\nprint(2)\n")
    message = python.changed() or ""
    assert message.startswith(f"Changed since the last build: {file}. The older installed copy is")


@pytest.fixture
def compared(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The packages whose files are compared, as their times do not say that they are the same."""
    those: list[Path] = []

    def noted(source: Path) -> PackageFolder | None:
        those.append(source)
        return read_package(source)

    monkeypatch.setattr("wsgen.pipeline.changed_since_build.read_package", noted)
    return those


DRIVER = "some_robot/driver.py"
START = "build/some_robot/colcon_command_prefix_setup_py.sh"


@pytest.mark.parametrize("base", [".", "install"], ids=["isolated", "merged"])
def test_files_are_compared_where_one_changed(
    python: Built, tmp_path: Path, base: str, compared: list[Path]
) -> None:
    time.sleep(0.02)  # times of files have steps of some milliseconds
    write((python.prefix.parent if base == "install" else tmp_path) / START, "")
    write(python.share / "package.sh", "")
    assert python.changed() is None
    assert compared == []
    write(python.source / "README.md", "new")
    assert python.changed() is None
    assert compared == [python.source]


def test_a_file_that_is_saved_while_the_build_runs(python: Built, tmp_path: Path) -> None:
    write(tmp_path / START, "", age=300)
    write(python.source / DRIVER, "KNOWN = 2\n", age=100)  # the build has copied it before
    write(python.share / "package.sh", "", age=60)
    assert DRIVER in (python.changed() or "")


def test_a_file_that_brings_an_older_time_along(python: Built, tmp_path: Path) -> None:
    """From another place, by `rsync -a`, `cp -p` or `unzip`."""
    write(tmp_path / START, "")
    write(python.share / "package.sh", "")
    write(python.source / DRIVER, "KNOWN = 2\n", age=1800)
    assert DRIVER in (python.changed() or "")


def test_links_are_never_old(python: Built) -> None:
    """`colcon build --symlink-install` makes them."""
    installed = python.prefix / "lib/python3.12/site-packages/some_robot/driver.py"
    installed.unlink()
    installed.symlink_to(python.source / "some_robot/driver.py")
    write(python.source / "some_robot/driver.py", "KNOWN = 2\n")
    assert python.changed() is None


@pytest.mark.parametrize(
    ("installed", "origin"),
    [
        ("lib/python3.12/site-packages/some_robot/control/pid.py", "some_robot/control/pid.py"),
        ("share/some_robot/launch/run.launch.py", "bringup/run.launch.py"),
        ("lib/some_robot/helper", "scripts/helper"),  # setuptools has changed its first line
    ],
)
def test_the_source_of_what_a_traceback_names(python: Built, installed: str, origin: str) -> None:
    source, shares = python.source / origin, {python.share: python.source}
    assert source_of(python.prefix / installed, shares) == InstalledSource(source)
    write(source, "#!/usr/bin/env python3\nprint(2)\n")
    assert source_of(python.prefix / installed, shares) == InstalledSource(source, is_same=False)
    (python.prefix / installed).unlink()
    (python.prefix / installed).symlink_to(source)
    assert source_of(python.prefix / installed, shares) == InstalledSource(source, is_link=True)


def test_what_has_no_source_in_the_workspace(python: Built, tmp_path: Path) -> None:
    shares = {python.share: python.source}
    for file in (python.prefix / "lib/some_robot/driver", tmp_path / "driver.py", Path("<string>")):
        assert source_of(file, shares) is None


def test_what_is_edited_in_a_package_of_cmake(tmp_path: Path) -> None:
    built = Built(tmp_path)
    built.copy("package.xml", "share/some_robot/package.xml", MANIFEST.format("", "ament_cmake"))
    write(built.source / "CMakeLists.txt", CMAKE, age=3600)
    built.copy("scripts/driver.py", "lib/some_robot/driver", "#!/usr/bin/env python3\n")
    modules = "local/lib/python3.10/dist-packages/some_robot"
    built.copy("some_robot/pid.py", f"{modules}/pid.py", "")
    write(built.source / "model/robot.xacro", "<robot name='@NAME@'/>", age=3600)
    write(built.share / "model/robot.xacro", "<robot name='some_robot'/>", age=60)
    assert built.changed() is None
    write(built.source / "model/robot.xacro", "<robot name='@NAME@'></robot>")
    assert built.changed() is None  # nobody knows what the build would make of it
    write(built.source / "scripts/driver.py", "#!/usr/bin/env python3\nimport sys\n")
    write(built.source / "some_robot/pid.py", "KNOWN = 2\n")
    message = built.changed() or ""
    assert message.startswith(
        "Changed since the last build: scripts/driver.py, some_robot/pid.py. "
    )


def test_a_launch_uses_packages_and_what_they_need(tmp_path: Path) -> None:
    shares = {}
    needs = {
        "bringup": "",
        "driver": "<exec_depend>library</exec_depend>",
        "library": "",
        "arm": "",
    }
    for name, needed in needs.items():
        source = tmp_path / "src" / name
        manifest = MANIFEST.format(needed, "ament_python").replace("some_robot", name)
        write(source / "package.xml", manifest)
        shares[tmp_path / "install" / name / "share" / name] = source
    plan = LaunchPlan(
        package="bringup",
        launch_file=tmp_path / "run.launch.py",
        processes=(Process(package="driver", executable="drive"),),
    )
    used = used_packages(plan, shares)
    assert sorted(share.name for share in used) == ["bringup", "driver", "library"]


def test_the_hint_of_a_missing_world_uses_no_package(source: Path, tmp_path: Path) -> None:
    write(source / "package.xml", MANIFEST.format("", "ament_cmake"))
    write(source / "worlds" / "w.world", "<sdf/>")
    plan = LaunchPlan(package="other", launch_file=tmp_path / "a.launch.py")
    with open_overlay([Workspace(root=tmp_path)], os.environ) as overlay:
        found = missing_world(plan, Path("/nowhere/src/some_robot/worlds/w.world"), overlay)
        assert "get_package_share_directory('some_robot'), 'worlds/w.world'" in (found.hint or "")
        assert overlay.not_built() == ()
