"""What colcon is told."""

import os
from pathlib import Path

import pytest

from wsgen.building.colcon import (
    PYTHON_EXTENSIONS,
    TOOLCHAIN_EXTENSION,
    block_extensions,
    blocked_extensions,
    build_arguments,
)
from wsgen.building.left_out import (
    WITHOUT_TESTS,
)
from wsgen.packages.workspace.layout import Inventory, Workspace


def test_the_user_s_arguments_stay_together() -> None:
    arguments = build_arguments(
        ["demo"], ["--merge-install", "--cmake-args", "-DA=1"], cmake_arguments=(WITHOUT_TESTS,)
    )
    assert arguments[:4] == ["build", "--merge-install", "--cmake-args", "-DA=1"]
    assert arguments[4:8] == [
        "--ament-cmake-args",
        "-DBUILD_TESTING=OFF",
        "--packages-up-to",
        "demo",
    ]


def test_an_option_is_not_given_twice() -> None:
    """colcon takes the last one and forgets the first."""
    arguments = build_arguments(
        [],
        ["--ament-cmake-args", "-DA=1", "--event-handlers", "summary+"],
        cmake_arguments=(WITHOUT_TESTS,),
    )
    assert arguments == [
        "build",
        "--ament-cmake-args",
        "-DBUILD_TESTING=OFF",
        "-DA=1",
        "--event-handlers",
        "summary+",
    ]


@pytest.mark.parametrize(
    ("blocked", "silenced"),
    [
        ((), ["console_start_end-", "console_stderr-", "summary-"]),
        (("colcon_core.event_handler.summary",), ["console_start_end-", "console_stderr-"]),
    ],
)
def test_colcon_is_silent(blocked: tuple[str, ...], silenced: list[str]) -> None:
    arguments = build_arguments([], [], blocked=blocked)
    assert arguments == ["build", "--event-handlers", *silenced]


def test_colcon_gets_no_option_for_what_is_blocked() -> None:
    arguments = build_arguments([], [], blocked=("colcon_core.event_handler",))
    assert arguments == ["build"]


def blocked(
    root: Path, *arguments: str, inventory: Inventory | None = None, **variables: str
) -> list[str]:
    environment = {"COLCON_HOME": str(root / "home"), **variables}
    block_extensions(
        environment,
        workspace=Workspace(root=root),
        inventory=inventory or Inventory(),
        colcon_arguments=arguments,
    )
    entries = blocked_extensions(environment)
    assert TOOLCHAIN_EXTENSION in entries  # its work is done
    return [entry for entry in entries if entry != TOOLCHAIN_EXTENSION]


def test_what_python_packages_need_is_left_out(tmp_path: Path) -> None:
    assert blocked(tmp_path) == list(PYTHON_EXTENSIONS)


def test_what_the_user_blocks_stays_blocked(tmp_path: Path) -> None:
    mine = f"colcon_core.shell.zsh{os.pathsep}{PYTHON_EXTENSIONS[0]}"
    assert blocked(tmp_path, COLCON_EXTENSION_BLOCKLIST=mine) == [
        "colcon_core.shell.zsh",
        PYTHON_EXTENSIONS[0],
        *PYTHON_EXTENSIONS[1:],
    ]


def test_not_with_a_python_package(tmp_path: Path) -> None:
    assert blocked(tmp_path, inventory=Inventory(has_python=True)) == []


@pytest.mark.parametrize("option", ["--base-paths", "--paths", "--metas", "--base-paths=src"])
def test_not_where_colcon_looks_elsewhere(option: str, tmp_path: Path) -> None:
    assert blocked(tmp_path, option, "src") == []


@pytest.mark.parametrize("file", ["colcon_defaults.yaml", "home/defaults.yaml"])
def test_not_with_default_arguments(file: str, tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / file).touch()
    assert blocked(tmp_path) == []
