"""Plain `colcon build` finds the toolchain by itself, and a sourced ROS is left in peace."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from building.building import (
    CMAKE,
    COLCON,
    LINTED,
    PACKAGE_XML,
    SHELL_PROGRAMS,
    build_here,
    cache_entry,
    link_programs,
    outside,
    plain_colcon,
    write_package,
)

pytestmark = pytest.mark.slow

SCRIPTS = Path(sys.executable).parent
# What CMake's Python has to import for ament_cmake, with the needs of those.
ROS_PYTHON_NEEDS = (
    "catkin_pkg",
    "pyparsing",
    "dateutil",
    "docutils",
    "six.py",
    "em.py",
    "packaging",
)


def check_wheels_were_used(root: Path) -> None:
    assert Path(cache_entry(root, "_Python3_EXECUTABLE") or "").parent == SCRIPTS
    assert cache_entry(root, "ament_cmake_DIR") == f"{sys.prefix}/share/ament_cmake/cmake"
    # The binary itself, not the wheel's Python script around it.
    assert "/cmake/data/bin/" in (cache_entry(root, "CMAKE_COMMAND") or "")


def test_not_activated(tmp_path: Path) -> None:
    write_package(tmp_path)
    plain_colcon(tmp_path, outside())
    check_wheels_were_used(tmp_path)


def test_without_linters(tmp_path: Path) -> None:
    """As `ros2 pkg create` leaves a package; `wsgen build` does the same."""
    write_package(tmp_path, cmake=LINTED)
    plain_colcon(tmp_path, outside(), warning="what is not installed: ament_lint_auto")
    assert cache_entry(tmp_path, "BUILD_TESTING") == "OFF"


@pytest.mark.parametrize("is_plain", [True, False])
def test_environments_of_python_are_ignored(tmp_path: Path, *, is_plain: bool) -> None:
    write_package(tmp_path)
    for name, marker in (("venv", "pyvenv.cfg"), ("env", "conda-meta/history")):
        write_package(tmp_path / name, f"of_{name}").parent.rename(tmp_path / name / "share")
        (tmp_path / name / marker).parent.mkdir(exist_ok=True)
        (tmp_path / name / marker).touch()
    if is_plain:
        plain_colcon(tmp_path, outside())
    else:
        assert build_here(tmp_path).succeeded
    assert [folder.name for folder in (tmp_path / "install").iterdir() if folder.is_dir()] == [
        "demo"
    ]


@pytest.mark.parametrize("arguments", [("--paths", "../src/*"), ("--base-paths", "../src")])
def test_without_linters_from_elsewhere(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    write_package(tmp_path, cmake=LINTED)
    root = tmp_path / "elsewhere"
    root.mkdir()
    plain_colcon(root, outside(), *arguments, warning="demo is built without tests")
    assert cache_entry(root, "BUILD_TESTING") == "OFF"


@pytest.mark.parametrize("option", ["--cmake-args", "--ament-cmake-args"])
def test_tests_that_are_asked_for(tmp_path: Path, option: str) -> None:
    write_package(tmp_path, cmake=LINTED)
    run = subprocess.run(
        [COLCON, "build", option, "-DBUILD_TESTING=ON"],
        cwd=tmp_path,
        env=outside(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode != 0
    assert "ament_lint_auto" in run.stderr


def test_linters_that_are_built_here(tmp_path: Path) -> None:
    write_package(tmp_path, cmake=LINTED)
    linter = CMAKE.replace("project(demo", "project(ament_lint_auto").replace(
        "ament_package()",
        "ament_package(CONFIG_EXTRAS extras.cmake)",
    )
    extras = write_package(tmp_path, "ament_lint_auto", cmake=linter) / "extras.cmake"
    extras.write_text("macro(ament_lint_auto_find_test_dependencies)\nendmacro()\n")
    needs = PACKAGE_XML.replace("<export>", "<test_depend>ament_lint_auto</test_depend><export>")
    (tmp_path / "src" / "demo" / "package.xml").write_text(needs)
    plain_colcon(tmp_path, outside())
    assert cache_entry(tmp_path, "BUILD_TESTING") == "ON"


def test_not_activated_and_no_cmake_on_the_machine(tmp_path: Path) -> None:
    write_package(tmp_path)
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    plain_colcon(tmp_path, {**outside(), "PATH": str(path)})
    check_wheels_were_used(tmp_path)


def test_activated(tmp_path: Path) -> None:
    write_package(tmp_path)
    path = f"{SCRIPTS}{os.pathsep}{outside()['PATH']}"
    plain_colcon(tmp_path, {**outside(), "PATH": path, "VIRTUAL_ENV": sys.prefix})
    check_wheels_were_used(tmp_path)


def test_another_environment_is_active(tmp_path: Path) -> None:
    write_package(tmp_path)
    other = tmp_path / "other"
    (other / "bin").mkdir(parents=True)
    (other / "bin" / "python3").symlink_to("/usr/bin/python3")
    path = f"{other / 'bin'}{os.pathsep}{outside()['PATH']}"
    plain_colcon(tmp_path, {**outside(), "PATH": path, "VIRTUAL_ENV": str(other)})
    check_wheels_were_used(tmp_path)


def test_the_user_s_own_cmake(tmp_path: Path) -> None:
    write_package(tmp_path)
    own = tmp_path / "own-cmake"
    own.write_text(f'#!/bin/sh\ntouch {tmp_path}/called\nexec {SCRIPTS}/cmake "$@"\n')
    own.chmod(0o755)
    plain_colcon(tmp_path, {**outside(), "CMAKE_COMMAND": str(own)})
    assert (tmp_path / "called").exists()


def test_colcon_test_finds_ctest(tmp_path: Path) -> None:
    write_package(tmp_path)
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    environment = {**outside(), "PATH": str(path)}
    plain_colcon(tmp_path, environment)
    run = subprocess.run(
        [COLCON, "test"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stderr) == (0, ""), run.stdout


@pytest.fixture(scope="module")
def ros(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment after sourcing a ROS that has a Python of its own.

    Its prefix holds the files of ament_cmake as /opt/ros/<distro> does, its Python the modules
    that a system's Python gets from Debian packages.
    """
    root = tmp_path_factory.mktemp("ros")
    prefix = root / "opt"
    (prefix / "share").mkdir(parents=True)
    for folder in Path(sys.prefix, "share").glob("ament_*"):
        (prefix / "share" / folder.name).symlink_to(folder)
    for setup in ("setup.sh", "local_setup.sh"):
        (prefix / setup).write_text("")

    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    python = root / "usr"
    home = Path(sys.base_prefix, "bin")
    modules = python / "lib" / version / "site-packages"
    modules.mkdir(parents=True)
    (python / "bin").mkdir()
    (python / "bin" / "python3").symlink_to(home / version)
    (python / "pyvenv.cfg").write_text(f"home = {home}\n")
    ours = Path(sys.prefix, "lib", version, "site-packages")
    for name in ROS_PYTHON_NEEDS:
        if (ours / name).exists():
            (modules / name).symlink_to(ours / name)
    ros_modules = prefix / "lib" / version / "site-packages"
    ros_modules.mkdir(parents=True)
    (ros_modules / "ament_package").symlink_to(ours / "ament_package")
    return {
        **outside(),
        "PATH": f"{python / 'bin'}{os.pathsep}{outside()['PATH']}",
        "AMENT_PREFIX_PATH": str(prefix),
        "PYTHONPATH": str(ros_modules),
        "ROS_DISTRO": "iron",
        "ROS_VERSION": "2",
    }


def check_ros_was_used(root: Path, ros: dict[str, str]) -> None:
    python = ros["PATH"].split(os.pathsep)[0]
    assert cache_entry(root, "_Python3_EXECUTABLE") == f"{python}/python3"
    prefix = ros["AMENT_PREFIX_PATH"]
    assert cache_entry(root, "ament_cmake_DIR") == f"{prefix}/share/ament_cmake/cmake"


def test_sourced_ros(ros: dict[str, str], tmp_path: Path) -> None:
    write_package(tmp_path)
    plain_colcon(tmp_path, ros)
    check_ros_was_used(tmp_path, ros)


def test_sourced_ros_with_the_environment_activated(ros: dict[str, str], tmp_path: Path) -> None:
    write_package(tmp_path)
    active = {**ros, "PATH": f"{SCRIPTS}{os.pathsep}{ros['PATH']}", "VIRTUAL_ENV": sys.prefix}
    plain_colcon(tmp_path, active)
    check_ros_was_used(tmp_path, ros)


def test_sourced_ros_with_wsgen(ros: dict[str, str], tmp_path: Path) -> None:
    write_package(tmp_path)
    active = {**ros, "PATH": f"{SCRIPTS}{os.pathsep}{ros['PATH']}", "VIRTUAL_ENV": sys.prefix}
    assert build_here(tmp_path, environment=active).succeeded
    check_ros_was_used(tmp_path, ros)
