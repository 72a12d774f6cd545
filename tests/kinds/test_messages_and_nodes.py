"""Messages, a controller and nodes in C++ beside the robot: they are left out, the robot is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace
from wsgen.ros_environment.machines import why_not

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [(), ("--", "--symlink-install")])
def test_messages_and_nodes(arguments: tuple[str, ...], tmp_path: Path) -> None:
    workspace = copy_workspace("messages_and_nodes", tmp_path)
    built = workspace.wsgen("build", "--format", "json", *arguments)
    assert built.code == 0, built.output
    packages = {one["package"]: one for one in built.document["packages"]}
    # Messages are generated for Python where PyPI has ROS.
    missing = [] if why_not() is None else ["messages"]
    assert packages["mole_msgs"]["left_out"] == missing
    assert {"mole_controller", "digger", "listener"} <= {*packages["mole_control"]["left_out"]}
    assert {"rclcpp", "pluginlib"} <= {*packages["mole_control"]["needs"]}
    assert ("mole_msgs" in packages["mole_control"]["needs"]) == bool(missing)
    assert packages["mole_bringup"]["left_out"] == ["commander"]  # it needs what was left out

    install = workspace.root / "install"
    assert (install / "mole_bringup" / "share" / "mole_bringup" / "urdf" / "mole.urdf").is_file()
    assert (install / "mole_control" / "share" / "mole_control" / "config").is_dir()
    # What needs nothing of ROS is compiled.
    assert [entry.name for entry in (install / "mole_control/lib/mole_control").iterdir()] == [
        "depth"
    ]
    answer = workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.output
    (robot,) = (one for each in answer.document["packages"] for one in each["robots"])
    assert robot["entity"] == "mole"


@pytest.mark.slow
def test_strict(tmp_path: Path) -> None:
    workspace = copy_workspace("messages_and_nodes", tmp_path)
    built = workspace.wsgen("build", "--strict")
    assert built.code == 1
    assert "mole_control is built without mole_controller" in built.output
    install = workspace.root / "install" / "mole_msgs" / "share" / "mole_msgs"
    assert (install / "package.xml").is_file()
