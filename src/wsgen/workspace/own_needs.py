"""What wsgen's own commands need of a machine, without any ROS."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from wsgen.workspace.machine import Finding
from wsgen.workspace.toolchain import MAKE_PROGRAMS, SourcedRos

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.workspace.machine import Machine

PYTHONS = ((3, 10), (3, 14))  # from, to; as requires-python in pyproject.toml
# Module -> what pip calls it, of what wsgen depends on.
COLCON = {
    "colcon_core": "colcon-core",
    "colcon_bash": "colcon-bash",
    "colcon_cmake": "colcon-cmake",
    "colcon_defaults": "colcon-defaults",
    "colcon_library_path": "colcon-library-path",
    "colcon_metadata": "colcon-metadata",
    "colcon_output": "colcon-output",
    "colcon_package_selection": "colcon-package-selection",
    "colcon_recursive_crawl": "colcon-recursive-crawl",
    "colcon_ros": "colcon-ros",
    "colcon_zsh": "colcon-zsh",
    "catkin_pkg": "catkin_pkg",
    "em": "empy>=3.3.4,<4",
}
LIBRARIES = {
    "click": "click",
    "rich": "rich",
    "jinja2": "jinja2",
    "lxml": "lxml",
    "yaml": "pyyaml",
    "numpy": "numpy",
    "PIL": "pillow",
    "trimesh": "trimesh",
    "shapely": "shapely",
}
LAST_PYTHON_WITH_PYBULLET = (3, 13)
FIRST_PYTHON_WITH_ITS_FORK = (3, 12)
WHEELS = (
    "ros-ament-cmake",
    "ros-ament-package",
    "ros-ament-cmake-include-directories",
    "ros-ament-cmake-pytest",
    "ros-ament-cmake-gtest",
    "ros-ament-cmake-gmock",
    "ros-ament-index-python",
)


def find_own_needs(machine: Machine) -> Iterator[Finding]:
    """Say of each thing that `wsgen new`, `build` and `validate` use whether it is there."""
    yield _python(machine)
    yield _modules(machine, "colcon", COLCON)
    yield _ament_cmake(machine)
    yield _cmake(machine)
    yield _build_program(machine)
    yield _modules(machine, "xacro", {"xacro": "xacro"})
    yield _modules(machine, "Python libraries", LIBRARIES)
    yield _engine(machine)
    yield _pictures(machine)
    yield from _extras(machine)


def _python(machine: Machine) -> Finding:
    first, last = (".".join(map(str, version)) for version in PYTHONS)
    return Finding(
        name="Python",
        is_met=PYTHONS[0] <= machine.python <= PYTHONS[1],
        text=f"{machine.python[0]}.{machine.python[1]}; wsgen is for {first} to {last}",
        is_needed=True,
    )


def _modules(machine: Machine, name: str, modules: Mapping[str, str]) -> Finding:
    missing = [pip for module, pip in modules.items() if not machine.has_module(module)]
    return Finding(
        name=name,
        is_met=not missing,
        text=f"missing: {', '.join(missing)}" if missing else "installed beside wsgen",
        is_needed=True,
        mend=_pip(machine, *missing),
    )


def _ament_cmake(machine: Machine) -> Finding:
    found = machine.toolchain
    if found is not None:
        whose = "of the sourced ROS" if isinstance(found, SourcedRos) else "of the wheels"
        text = f"{whose}, in {found.prefix}"
        return Finding("ament_cmake", is_met=True, text=text, is_needed=True)
    has_wheels = (machine.system, machine.architecture) == ("linux", "x86_64")
    setup = _any_ros(machine)
    mend = f"source {setup}" if setup else ""
    if has_wheels:
        mend = _pip(machine, *WHEELS)
    where = "" if has_wheels else "; its wheels are for Linux x86_64, elsewhere a ROS is needed"
    return Finding("ament_cmake", is_met=False, text=f"missing{where}", is_needed=True, mend=mend)


def _any_ros(machine: Machine) -> str | None:
    """The setup file of a ROS on this machine."""
    found = sorted(machine.root.glob("opt/ros/*/setup.bash"))
    return str(found[-1]) if found else None


def _cmake(machine: Machine) -> Finding:
    chosen = machine.build_environment.get("CMAKE_COMMAND")
    if chosen:
        found = machine.find(chosen, for_build=True)
        text = found or f"missing: CMAKE_COMMAND={chosen} is no program"
        mend = "" if found else "unset CMAKE_COMMAND"
    else:
        found = machine.find("cmake", for_build=True)
        text, mend = found or "missing", "" if found else _pip(machine, "cmake")
    return Finding("CMake", is_met=bool(found), text=text, is_needed=True, mend=mend)


def _build_program(machine: Machine) -> Finding:
    found = machine.find("ninja", *MAKE_PROGRAMS, for_build=True)
    return Finding(
        "ninja or make",
        is_met=found is not None,
        text=found or "missing",
        is_needed=True,
        mend="" if found else _pip(machine, "ninja"),
    )


def _engine(machine: Machine) -> Finding:
    for module, name in (("pybullet", "PyBullet"), ("dartpy", "DART")):
        if machine.has_module(module):
            return Finding("physics engine", is_met=True, text=name, is_needed=True)
    wanted = "dartpy" if machine.python > LAST_PYTHON_WITH_PYBULLET else _pybullet(machine)
    return Finding(
        "physics engine",
        is_met=False,
        text="missing: neither PyBullet nor DART",
        is_needed=True,
        mend=_pip(machine, wanted),
    )


def _pictures(machine: Machine) -> Finding:
    """What `--picture` and `--record` need."""
    if not machine.has_module("pybullet"):
        why, mend = "PyBullet draws them, and is not installed", _pip(machine, _pybullet(machine))
        if machine.python > LAST_PYTHON_WITH_PYBULLET:
            why, mend = "PyBullet draws them, and has no wheel for this Python", ""
        return Finding("pictures", is_met=False, text=f"cannot be drawn: {why}", mend=mend)
    problem = machine.why_no_picture()
    return Finding(
        "pictures",
        is_met=problem is None,
        text="drawn by PyBullet" if problem is None else f"cannot be drawn: PyBullet {problem}",
        mend="" if problem is None else _pip(machine, "--force-reinstall", _pybullet(machine)),
    )


def _pybullet(machine: Machine) -> str:
    """What pip calls PyBullet: the original has no wheels for newer Pythons."""
    is_old = machine.python < FIRST_PYTHON_WITH_ITS_FORK
    return "pybullet" if is_old else "pybullet-arm64"  # the same module, on every architecture


def _extras(machine: Machine) -> Iterator[Finding]:
    """What wsgen can do without."""
    for name, module, purpose, requirement in (
        ("DART", "dartpy", "a second engine", "wsgen[dart]"),
        ("PyAV", "av", "films as MP4", "wsgen[video]"),
    ):
        is_there = machine.has_module(module)
        yield Finding(
            name,
            is_met=is_there,
            text="installed" if is_there else f"missing; only for {purpose}",
            mend="" if is_there else _pip(machine, requirement),
        )
    for name, programs, purpose, package in (
        ("C++ compiler", ("c++", "g++", "clang++"), "packages with C++", "build-essential"),
        ("git", ("git",), "the maintainer's name and address", "git"),
    ):
        found = machine.find(*programs, for_build=True)
        install = f"sudo apt install {package}" if machine.find("apt") else ""
        yield Finding(
            name,
            is_met=found is not None,
            text=found or f"missing; only for {purpose}",
            mend="" if found else install,
        )


def _pip(machine: Machine, *requirements: str) -> str:
    if not requirements:
        return ""
    return shlex.join([machine.interpreter, "-m", "pip", "install", *requirements])
