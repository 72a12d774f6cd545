"""What colcon left of builds that failed, as `wsgen validate` reads it."""

import os
from pathlib import Path

import pytest

from building.building import PACKAGE_XML, write_package
from wsgen.building.last_build import explain_builds, failed_builds, needed_by
from wsgen.diagnostics import Diagnostic
from wsgen.packages.workspace.layout import Workspace, find_packages

MISSING = """\
CMake Error at cmake_install.cmake:46 (file):
  file INSTALL cannot find "{root}/src/demo/maps": No such file or
  directory.
"""
UNKNOWN = """\
CMake Error at CMakeLists.txt:3 (find_pakage):
  Unknown CMake command "find_pakage".
"""
LACKS = """\
CMake Error at CMakeLists.txt:4 (find_package):
  By not providing "Finddemo_msgs.cmake" in CMAKE_MODULE_PATH this project has
  asked CMake to find a package configuration file provided by "demo_msgs",
  but CMake did not find one.
"""


def left_by_colcon(
    root: Path, package: str, result: str, stderr: str = "", *, date: str = "2026-01-01_10-00-00"
) -> None:
    """The result and log of a build, as colcon writes them."""
    build, log = root / "build" / package, root / "log" / f"build_{date}"
    build.mkdir(parents=True, exist_ok=True)
    (build / "colcon_build.rc").write_text(f"{result}\n")
    (log / package).mkdir(parents=True)
    (log / package / "stderr.log").write_text(stderr.replace("{root}", str(root)))
    with (log / "events.log").open("a") as events:
        events.write(f"[0.1] ({package}) JobStarted: {{'identifier': '{package}'}}\n")
        events.write(
            f"[0.2] ({package}) JobEnded: {{'identifier': '{package}', 'rc': {result!r}}}\n"
        )


def reported(root: Path) -> list[Diagnostic]:
    workspace = Workspace(root=root)
    packages = find_packages(workspace)
    failed = failed_builds([workspace], packages)
    return list(explain_builds(list(failed.values()), packages, ""))


def test_a_good_build(tmp_path: Path) -> None:
    write_package(tmp_path)
    assert reported(tmp_path) == []  # never built
    left_by_colcon(tmp_path, "demo", "0")
    assert reported(tmp_path) == []


def test_the_first_error_is_named_with_its_place_and_fix(tmp_path: Path) -> None:
    folder = write_package(tmp_path)
    cmake = folder / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("launch model", "launch maps"))
    left_by_colcon(tmp_path, "demo", "1", MISSING)
    (found,) = reported(tmp_path)
    assert found.name == "failed-build"
    assert found.message == (
        "The last build of demo failed: install() names the folder maps, which does not exist."
    )
    assert (found.file, found.line, found.element) == (cmake, 5, "demo")
    assert found.hint is not None
    assert found.hint.startswith("Create it, or remove it from install().")
    assert found.hint.endswith("Then run `wsgen build`.")


def test_sources_that_were_changed_after_the_failure(tmp_path: Path) -> None:
    folder = write_package(tmp_path)
    left_by_colcon(tmp_path, "demo", "1", UNKNOWN)
    (found,) = reported(tmp_path)
    assert "find_pakage" in found.message
    later = (tmp_path / "build" / "demo" / "colcon_build.rc").stat().st_mtime + 9
    os.utime(folder / "CMakeLists.txt", (later, later))
    (found,) = reported(tmp_path)
    assert found.hint == "CMakeLists.txt was changed after that. Run `wsgen build`."


def test_a_failure_that_a_later_build_has_ended(tmp_path: Path) -> None:
    write_package(tmp_path)
    left_by_colcon(tmp_path, "demo", "1", UNKNOWN)
    left_by_colcon(tmp_path, "demo", "0", date="2026-01-02_10-00-00")
    assert reported(tmp_path) == []


def test_a_later_build_in_another_build_folder(tmp_path: Path) -> None:
    """`colcon build --build-base other`: build/demo keeps the result of the first one."""
    write_package(tmp_path)
    left_by_colcon(tmp_path, "demo", "1", UNKNOWN)
    result = tmp_path / "build" / "demo" / "colcon_build.rc"
    left_by_colcon(tmp_path, "demo", "0", date="2026-01-02_10-00-00")
    result.write_text("1\n")
    assert reported(tmp_path) == []


def test_a_later_build_of_other_packages(tmp_path: Path) -> None:
    write_package(tmp_path)
    write_package(tmp_path, "other")
    left_by_colcon(tmp_path, "demo", "1", UNKNOWN)
    left_by_colcon(tmp_path, "other", "0", date="2026-01-02_10-00-00")
    (found,) = reported(tmp_path)
    assert "find_pakage" in found.message


@pytest.mark.parametrize("removed", ["log", "log/build_2026-01-01_10-00-00/demo/stderr.log"])
def test_without_a_log(tmp_path: Path, removed: str) -> None:
    write_package(tmp_path)
    left_by_colcon(tmp_path, "demo", "2", UNKNOWN)
    (tmp_path / removed).rename(tmp_path / "gone")
    (found,) = reported(tmp_path)
    assert found.message == "The last build of demo failed."
    assert found.hint == "Run `wsgen build`."


def test_an_interrupted_build(tmp_path: Path) -> None:
    write_package(tmp_path)
    left_by_colcon(tmp_path, "demo", "SIGINT")
    (found,) = reported(tmp_path)
    assert found.message == "The last build of demo was interrupted."


def test_a_build_that_was_killed(tmp_path: Path) -> None:
    """It leaves the result of the one before, and no end in its log."""
    write_package(tmp_path)
    left_by_colcon(tmp_path, "demo", "0")
    build = tmp_path / "build" / "demo"
    started = build / "colcon_command_prefix_build.sh"
    started.touch()
    os.utime(started, (0, 0))
    assert reported(tmp_path) == []
    later = (build / "colcon_build.rc").stat().st_mtime + 9
    os.utime(started, (later, later))
    assert reported(tmp_path) == []  # as a copy of the workspace may have them
    left_by_colcon(tmp_path, "demo", "0", date="2026-01-02_10-00-00")
    events = tmp_path / "log" / "build_2026-01-02_10-00-00" / "events.log"
    events.write_text(events.read_text().partition("\n")[0])
    os.utime(started, (later, later))
    (found,) = reported(tmp_path)
    assert found.message == "The last build of demo was interrupted."


def test_what_failed_for_lack_of_another_package_is_left_out(tmp_path: Path) -> None:
    write_package(tmp_path, "demo_msgs")
    write_package(tmp_path)
    left_by_colcon(tmp_path, "demo_msgs", "1", UNKNOWN)
    left_by_colcon(tmp_path, "demo", "1", LACKS, date="2026-01-02_10-00-00")
    (found,) = reported(tmp_path)
    assert found.element == "demo_msgs"


def test_what_a_package_needs(tmp_path: Path) -> None:
    def depending(element: str) -> str:
        return PACKAGE_XML.replace("<export>", f"{element}<export>")

    write_package(tmp_path, "a", package_xml=depending("<build_depend>b</build_depend>"))
    write_package(tmp_path, "b", package_xml=depending("<exec_depend>c</exec_depend>"))
    for name in ("c", "d"):
        write_package(tmp_path, name)
    packages = {one.name: one for one in find_packages(Workspace(root=tmp_path))}
    assert needed_by(["a", "unknown"], packages) == {"a", "b", "c"}
