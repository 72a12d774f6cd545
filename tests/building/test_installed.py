"""What is left in the install space, made by real builds."""

from pathlib import Path

import pytest

from building.building import CMAKE, build_here, write_package
from wsgen.building.run import BuildResult
from wsgen.diagnostics import Diagnostic, Severity

pytestmark = pytest.mark.slow


def only_warning(result: BuildResult) -> Diagnostic:
    assert result.succeeded
    (diagnostic,) = result.diagnostics
    assert (diagnostic.code, diagnostic.severity) == ("BLD024", Severity.WARNING)
    return diagnostic


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package in a folder with a space in its name, built once."""
    folder = write_package(tmp_path / "my ws")
    assert build_here(tmp_path / "my ws").diagnostics == ()
    return folder


def rebuild(package: Path, *arguments: str) -> BuildResult:
    return build_here(package.parents[1], colcon_arguments=arguments)


def test_a_folder_that_is_not_installed_any_more(package: Path) -> None:
    (package / "CMakeLists.txt").write_text(CMAKE.replace("launch model", "launch"))
    diagnostic = only_warning(rebuild(package))
    assert "no longer installs: model/robot.xacro." in diagnostic.message
    root = package.parents[1]
    assert f"rm -rf '{root}/install/demo' '{root}/build/demo'" in (diagnostic.hint or "")
    assert only_warning(rebuild(package)) == diagnostic  # as long as it is there


def test_a_file_that_was_renamed(package: Path) -> None:
    (package / "model" / "robot.xacro").rename(package / "model" / "arm.xacro")
    assert "no longer installs: model/robot.xacro." in only_warning(rebuild(package)).message
    share = package.parents[1] / "install" / "demo" / "share" / "demo"
    (share / "model" / "robot.xacro").unlink()
    assert rebuild(package).diagnostics == ()


def test_slashes(tmp_path: Path) -> None:
    cmake = CMAKE.replace("share/${PROJECT_NAME}", "share/${PROJECT_NAME}//./")
    write_package(tmp_path, cmake=cmake.replace("launch model", "./launch model/"))
    assert build_here(tmp_path).diagnostics == ()


def test_many_files(package: Path) -> None:
    for number in range(7):
        (package / "model" / f"{number}.dae").touch()
    assert rebuild(package).diagnostics == ()
    for file in (package / "model").glob("*.dae"):
        file.unlink()
    assert "model/4.dae and 2 more" in only_warning(rebuild(package)).message


def test_what_others_write_there(package: Path) -> None:
    """Python writes bytecode beside a launch file, and a script what it likes."""
    share = package.parents[1] / "install" / "demo" / "share" / "demo"
    (share / "launch" / "__pycache__").mkdir()
    (share / "launch" / "__pycache__" / "demo.launch.cpython-310.pyc").touch()
    assert rebuild(package).diagnostics == ()
    script = 'install(CODE "file(TOUCH [[${CMAKE_INSTALL_PREFIX}/share/demo/made]])")\n'
    (package / "CMakeLists.txt").write_text(CMAKE.replace("install(", f"{script}install("))
    assert rebuild(package).diagnostics == ()
    assert (share / "made").exists()


@pytest.mark.parametrize("arguments", [("--symlink-install",), ("--merge-install",)])
def test_other_ways_to_install_are_not_judged(arguments: tuple[str, ...], tmp_path: Path) -> None:
    file = write_package(tmp_path) / "CMakeLists.txt"
    assert build_here(tmp_path, colcon_arguments=arguments).diagnostics == ()
    file.write_text(CMAKE.replace("launch model", "launch"))
    assert build_here(tmp_path, colcon_arguments=arguments).diagnostics == ()
