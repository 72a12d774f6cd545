"""What follows from a folder or a program that is not installed is no diagnostic of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.checks.rules.consequences import fold_not_installed
from wsgen.checks.rules.launch_files import MISSING_ARGUMENT_FILE
from wsgen.checks.rules.plugins import PLUGIN_OF_OTHER_SIMULATOR
from wsgen.checks.rules.ros2_control import UNSUITED_HARDWARE
from wsgen.descriptions.rules import MISSING_COLLISION_MESH
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launching.explain_missing import (
    EXECUTABLE_NOT_FOUND,
    FILE_NOT_INSTALLED,
    PACKAGE_NOT_FOUND,
    XACRO_FAILS,
)
from wsgen.packages.build_files.cmake_checks import DIFFERENT_NAMES, MISSING_INSTALLED_PATH
from wsgen.packages.build_files.install_checks import FOLDER_NOT_INSTALLED, PROGRAM_NOT_INSTALLED
from wsgen.packages.build_files.python_checks import BROKEN_SCRIPT

SRC = Path("/ws/src/crab")
FOLDERS = {"crab": SRC, "shell": Path("/ws/src/shell")}
MESHES = FOLDER_NOT_INSTALLED.at(
    SRC / "CMakeLists.txt",
    4,
    "meshes",
    message="crab does not install its folder meshes.",
    hint="?",
)
SCRIPT = BROKEN_SCRIPT.at(
    SRC / "setup.cfg",
    1,
    "crab",
    message="crab: ROS does not find walk and run.py, which setuptools installs into bin.",
)
PROGRAM = PROGRAM_NOT_INSTALLED.at(
    SRC / "CMakeLists.txt", 7, "walk", message="... `ros2 run crab walk` does not find it."
)


def mesh(place: str = "crab/meshes/a.stl") -> Diagnostic:
    path = f"/ws/install/{place.partition('/')[0]}/share/{place}"
    return MISSING_COLLISION_MESH.at(
        Path("/ws/src/shell/urdf/a.urdf"), 9, message=f"The mesh does not exist ({path})."
    )


def node(name: str, package: str = "crab") -> Diagnostic:
    return EXECUTABLE_NOT_FOUND.at(
        SRC / "launch/a.launch.py",
        12,
        name,
        message=f"The package '{package}' has no executable '{name}'.",
    )


def test_meshes_of_a_folder_that_is_not_installed() -> None:
    (found,) = fold_not_installed([mesh(), MESHES, mesh("crab/meshes/b.stl")], FOLDERS)
    assert (found.code, found.file, found.line, found.hint) == (MESHES.code, MESHES.file, 4, "?")
    assert found.severity is Severity.ERROR
    assert found.message == (
        f"{MESHES.message} In a.urdf (line 9): {mesh().message} 1 more diagnostic would follow."
    )


def test_a_file_that_a_launch_file_looks_up() -> None:
    looked_up = FILE_NOT_INSTALLED.at(
        SRC / "launch/a.launch.py",
        3,
        message="The package 'crab' has no file '/ws/install/crab/share/crab/meshes'.",
    )
    (found,) = fold_not_installed([looked_up, MESHES], FOLDERS)
    assert found.code == MESHES.code


@pytest.mark.parametrize("other", ["crab/urdf/a.stl", "shell/meshes/a.stl", "crab/meshes_2/a.stl"])
def test_meshes_elsewhere_have_another_cause(other: str) -> None:
    assert fold_not_installed([mesh(other), MESHES], FOLDERS) == (mesh(other), MESHES)


def test_without_a_cause_nothing_changes() -> None:
    assert fold_not_installed([mesh(), node("walk")], FOLDERS) == (mesh(), node("walk"))


@pytest.mark.parametrize(
    ("cause", "name"), [(SCRIPT, "walk"), (SCRIPT, "run.py"), (PROGRAM, "walk")]
)
def test_a_program_that_launch_files_start(cause: Diagnostic, name: str) -> None:
    (found,) = fold_not_installed([cause, node(name), node(name)], FOLDERS)
    assert (found.code, found.severity) == (cause.code, Severity.ERROR)
    assert "In a.launch.py (line 12): The package 'crab' has no executable" in found.message


@pytest.mark.parametrize("cause", [SCRIPT, PROGRAM])
@pytest.mark.parametrize(
    "other", [node("run"), node("walk.py"), node("crab"), node("walk", "shell"), node("wal")]
)
def test_other_programs_have_another_cause(cause: Diagnostic, other: Diagnostic) -> None:
    assert fold_not_installed([cause, other], FOLDERS) == (cause, other)


def test_a_misspelled_folder_of_install_is_one_mistake() -> None:
    build = SRC / "CMakeLists.txt"
    hint = "Did you mean `meshes`? Create it, or remove it from install()."
    misspelled = MISSING_INSTALLED_PATH.at(build, 4, "crab", message="...", hint=hint)
    assert fold_not_installed([MESHES, misspelled], FOLDERS) == (misspelled,)
    other = replace(misspelled, hint="Did you mean `models`?")
    assert len(fold_not_installed([MESHES, other], FOLDERS)) == 2


def test_packages_that_a_wrong_name_hides() -> None:
    named = DIFFERENT_NAMES.at(SRC / "CMakeLists.txt", 1, "my-crab", message="...")
    launch = SRC / "launch" / "a.launch.py"
    hidden = PACKAGE_NOT_FOUND.at(launch, 3, message="...", hint="Did you mean `my-crab`? If not,")
    other = replace(hidden, hint="Did you mean `shell`?")
    assert fold_not_installed([named, hidden, other], FOLDERS) == (named, other)
    assert fold_not_installed([hidden], FOLDERS) == (hidden,)


def test_packages_that_project_calls_otherwise() -> None:
    named = DIFFERENT_NAMES.at(SRC / "CMakeLists.txt", 1, "crab", message="...", reason="crabs")
    launch = SRC / "launch" / "a.launch.py"
    hidden = PACKAGE_NOT_FOUND.at(launch, 3, message="The package 'crabs' is not found.")
    other = PACKAGE_NOT_FOUND.at(launch, 3, message="The package 'crabs_arm' is not found.")
    assert fold_not_installed([named, hidden, other], FOLDERS) == (named, other)


def test_a_program_that_install_looks_for_elsewhere() -> None:
    hint = "Did you mean `scripts/walk`?"
    build = SRC / "CMakeLists.txt"
    misspelled = MISSING_INSTALLED_PATH.at(build, 4, "crab", message="...", hint=hint)
    assert fold_not_installed([misspelled, node("walk"), node("run")], FOLDERS) == (
        misspelled,
        node("run"),
    )


def test_a_file_of_a_folder_that_is_not_installed() -> None:
    message = "`bridge` is given 'meshes/b.yaml' of crab, which is not installed."
    given = MISSING_ARGUMENT_FILE.at(SRC / "launch/a.launch.py", 3, message=message)
    (found,) = fold_not_installed([MESHES, given], FOLDERS)
    assert found.code == MESHES.code


def test_what_a_launch_file_expands_is_reported_once() -> None:
    place = (SRC / "urdf/a.xacro", 3)
    of_launch, of_file = (
        rule.at(*place, message="...") for rule in (XACRO_FAILS, XACRO_FILE_FAILS)
    )
    other = replace(of_file, line=4)
    assert fold_not_installed([of_file, of_launch, other], FOLDERS) == (of_launch, other)


def test_hardware_beside_the_plugin_of_another_simulator() -> None:
    file = SRC / "urdf/a.xacro"
    plugin = PLUGIN_OF_OTHER_SIMULATOR.at(file, 9, message="...")
    hardware = UNSUITED_HARDWARE.at(file, 3, message="...")
    assert fold_not_installed([hardware, plugin], FOLDERS) == (plugin,)
    assert fold_not_installed([hardware], FOLDERS) == (hardware,)
