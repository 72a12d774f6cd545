"""`colcon test` of a new package: green, red with reason and picture, skipped without wsgen."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from building.building import COLCON, outside
from golden_support import golden_package
from wsgen.building.toolchain import Wheels, find_toolchain
from wsgen.cli import run as wsgen

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new workspace with a robot on wheels, built."""
    if not isinstance(find_toolchain(os.environ), Wheels):
        pytest.skip("a sourced ROS has its own Python")
    root = tmp_path_factory.mktemp("colcon") / "ws"
    assert wsgen(["new", "rover", "-t", "diff_drive", "-w", str(root), "-q"]) == 0
    colcon(root, "build")
    return root


def colcon(root: Path, *arguments: str, expect: int = 0) -> str:
    run = subprocess.run(
        [COLCON, *arguments],
        cwd=root,
        env=outside(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == expect, run.stdout + run.stderr
    return run.stdout


def test_a_user_tips_the_robot_over_and_fixes_it(workspace: Path) -> None:
    robot = workspace / "src" / "rover" / "model" / "robot.xacro"
    right = robot.read_text(encoding="utf-8")
    # Larger wheels, and the body in front of them.
    wrong = right.replace('"wheel_radius" default="0.08"', '"wheel_radius" default="0.2"').replace(
        'name="body_x" value="${-0.25 * body_length}"', 'name="body_x" value="0.15"'
    )
    assert wrong != right
    robot.write_text(wrong, encoding="utf-8")
    colcon(workspace, "test")
    assert "0 errors, 0 failures" in colcon(workspace, "test-result")  # it is not built
    colcon(workspace, "build")
    colcon(workspace, "test")
    reported = colcon(workspace, "test-result", "--verbose", expect=1)
    picture = "build/rover/test_results/rover/test_robot/test_robot-test_stands.png"
    _, _, junit = reported.partition(
        "test_robot.xunit.xml: 2 tests, 0 errors, 1 failure, 0 skipped"
    )
    assert "error[SPN059] tips-over: The robot tips over by " in junit, reported
    assert f"picture: {workspace / picture}" in junit
    assert (workspace / picture).is_file()
    robot.write_text(right, encoding="utf-8")
    colcon(workspace, "build")
    colcon(workspace, "test")
    assert "3 tests, 0 errors, 0 failures, 0 skipped" in colcon(workspace, "test-result")
    assert not (workspace / picture).exists()


@pytest.mark.parametrize("golden", ["simple-jazzy-gz", "diff_drive-jazzy-gz", "arm-jazzy-gz"])
def test_without_wsgen_the_tests_are_skipped_with_a_reason(golden: str, tmp_path: Path) -> None:
    (tmp_path / "wsgen.py").write_text("")  # in its place: nothing that has `testing`
    # Away from the settings of this repository.
    file = shutil.copy(golden_package(golden) / "test" / "test_robot.py", tmp_path)
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:wsgen", "-p", "no:cacheprovider", "-rs", file],
        env={**os.environ, "PYTHONPATH": str(tmp_path), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert " skipped in" in run.stdout, run.stdout + run.stderr
    assert "needs wsgen: pip install wsgen" in run.stdout
    assert run.returncode == 0  # or `colcon test` fails: it would be 5 with nothing collected
