"""Messages, a controller and nodes in C++ beside the robot: they are left out, the robot is not."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING, NamedTuple

import pytest

from kind_workspaces import Answer, KindOfWorkspace, copy_workspace
from wsgen.ros.environment.available import why_not

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow


class Built(NamedTuple):
    """A workspace, and what `wsgen build` with these arguments has said of it."""

    workspace: KindOfWorkspace
    arguments: tuple[str, ...]
    answer: Answer

    @property
    def install(self) -> Path:
        return self.workspace.root / "install"


LINKS = pytest.param(("--", "--symlink-install"), id="links", marks=pytest.mark.thorough)


@pytest.fixture(scope="module", params=[pytest.param((), id="copies"), LINKS])
def built(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Built once for both tests: the compiler is what takes the time."""
    workspace = copy_workspace("messages_and_nodes", tmp_path_factory.mktemp("moles"))
    answer = workspace.wsgen("build", "--format", "json", *request.param)
    return Built(workspace, request.param, answer)


def test_messages_and_nodes(built: Built) -> None:
    assert built.answer.code == 0, built.answer.output
    packages = {one["package"]: one for one in built.answer.document["packages"]}
    # Messages are generated for Python where PyPI has ROS.
    missing = [] if why_not() is None else ["messages"]
    assert packages["mole_msgs"]["left_out"] == missing
    assert {"mole_controller", "digger", "listener"} <= {*packages["mole_control"]["left_out"]}
    assert {"rclcpp", "pluginlib"} <= {*packages["mole_control"]["needs"]}
    assert ("mole_msgs" in packages["mole_control"]["needs"]) == bool(missing)
    assert packages["mole_bringup"]["left_out"] == ["commander"]  # it needs what was left out

    install = built.install
    assert (install / "mole_bringup" / "share" / "mole_bringup" / "urdf" / "mole.urdf").is_file()
    assert (install / "mole_control" / "share" / "mole_control" / "config").is_dir()
    # What needs nothing of ROS is compiled.
    assert [entry.name for entry in (install / "mole_control/lib/mole_control").iterdir()] == [
        "depth"
    ]
    answer = built.workspace.wsgen("validate", "--format", "json")
    assert answer.code == 0, answer.output
    (robot,) = (one for each in answer.document["packages"] for one in each["robots"])
    assert robot["entity"] == "mole"


def test_strict(built: Built) -> None:
    shutil.rmtree(built.install)
    strict = built.workspace.wsgen("build", "--strict", *built.arguments)
    assert strict.code == 1
    assert "mole_control is built without mole_controller" in strict.output
    assert (built.install / "mole_msgs" / "share" / "mole_msgs" / "package.xml").is_file()
