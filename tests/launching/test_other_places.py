"""Paths of another workspace, which a package of this one has a file for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import InstallSpace, only_message
from wsgen.launching.known_packages import find_in_package

if TYPE_CHECKING:
    from pathlib import Path

LOST = "/nowhere/other_ws"


@pytest.fixture
def share(tmp_path: Path) -> Path:
    """The share folder of a package, with a file of parameters."""
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "a.yaml").touch()
    return tmp_path


@pytest.mark.parametrize(
    "path",
    [
        f"{LOST}/src/my_robot/config/a.yaml",
        f"{LOST}/install/my_robot/share/my_robot/config/a.yaml",
        r"C:\ws\src\my_robot\config\a.yaml",
        f"{LOST}/my_robot/launch/../config/a.yaml",
        f"{LOST}/my_robot/./config//a.yaml",
        f"{LOST}/arm/../my_robot/config/a.yaml",
    ],
)
def test_the_end_of_a_path_is_in_a_package(share: Path, path: str) -> None:
    place = find_in_package(path, {"my_robot": share}.get)
    assert place == ("my_robot", "config/a.yaml")


@pytest.mark.parametrize("path", [f"{LOST}/config/a.yaml", f"{LOST}/my_robot/b.yaml", "my_robot"])
def test_a_path_of_no_package(share: Path, path: str) -> None:
    assert find_in_package(path, {"my_robot": share}.get) is None


@pytest.mark.parametrize(
    "path", ["/x/../config/a.yaml", "../config/a.yaml", "x/../../config/a.yaml"]
)
def test_the_folder_above_is_no_package(share: Path, path: str) -> None:
    (share / "above").mkdir()
    folders = {"..": share / "above" / ".."}
    assert find_in_package(path, folders.get) is None


def test_a_place_below_a_package_is_not_above_it(share: Path) -> None:
    (share / "x").mkdir()
    assert find_in_package("/x/my_robot/x/../../config/a.yaml", {"my_robot": share}.get) is None


@pytest.mark.slow
def test_the_hint_of_a_launch_file_names_the_package(space: InstallSpace) -> None:
    space.add("arm_bringup", {"launch/rsp.launch.py": "", "config/a.yaml": "{}"})
    there = "os.path.join(get_package_share_directory('arm_bringup'), '{}')"
    plan = space.play(f"IncludeLaunchDescription('{LOST}/src/arm_bringup/launch/rsp.launch.py')")
    assert there.format("launch/rsp.launch.py") in only_message(plan, "LCH005")
    plan = space.play(
        "Node(package='my_robot', executable='talker', "
        f"parameters=['{LOST}/src/arm_bringup/config/a.yaml'])"
    )
    (hint,) = [one.hint for one in plan.diagnostics if one.code == "LCH019"]
    assert there.format("config/a.yaml") in (hint or "")
