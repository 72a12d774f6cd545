"""Nodes that follow a line: by the images of a camera, by what reflects the rays of a lidar."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from kind_workspaces import KindOfWorkspace, copy_workspace
from ros_for_tests import plain_environment, ros_with

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow
SECONDS = 400.0  # wall-clock, on a busy machine

# Without the line in sight the node stops; with images that are seldom it leaves the ring.
FOLLOWS = """
import math
import pytest

def test_follows(live):
    with live("liner", "follow.launch.py", arguments={{"by": "{by}"}}) as ros:
        robot = ros.robot
        ros.wait_until(lambda: robot.pose.y > -math.cos(1.0), seconds=8)
        assert robot.pose.x > 0
        assert math.hypot(robot.pose.x, robot.pose.y) == pytest.approx(1, abs=0.03)
"""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> KindOfWorkspace:
    ros_with()
    workspace = copy_workspace("line_follower", tmp_path_factory.mktemp("liner"))
    built = workspace.wsgen("build")
    assert built.code == 0, built.errors
    return workspace


def test_validate(workspace: KindOfWorkspace) -> None:
    outcome = workspace.wsgen("validate", "--format", "json")
    (package,) = outcome.document["packages"]
    assert (outcome.code, package["passed"]) == (0, True), outcome.errors


@pytest.mark.parametrize("by", ["camera", "lidar"])
def test_the_line_is_followed(workspace: KindOfWorkspace, tmp_path: Path, by: str) -> None:
    file = workspace.root / "src" / "liner" / "test" / f"test_{by}.py"
    file.parent.mkdir(exist_ok=True)
    file.write_text(FOLLOWS.format(by=by), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", str(file)],
        cwd=workspace.root,
        env={**plain_environment(), "TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert done.returncode == 0, done.stdout
