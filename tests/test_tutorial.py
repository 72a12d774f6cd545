"""Somebody follows the tutorial by hand, then uses wsgen on the result."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tutorial import TEXT, write_tutorial

pytestmark = pytest.mark.skipif(not TEXT.exists(), reason="the tutorial's text is not here")


def wsgen(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "wsgen", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    workspace = write_tutorial(tmp_path_factory.mktemp("tutorial"))
    build = wsgen(workspace, "build")
    assert build.returncode == 0, build.stderr
    assert "BUILD_TESTING" in build.stderr
    return workspace


def test_the_typed_robot_passes_with_its_faults_named(workspace: Path) -> None:
    run = wsgen(workspace, "validate", "--format", "json")
    assert run.returncode == 0, run.stdout + run.stderr
    (package,) = json.loads(run.stdout)["packages"]
    assert package["passed"]
    assert package["world"]["name"] == "Empty world"
    (robot,) = package["robots"]
    assert robot["entity"] == "simple_robot"
    assert (robot["links"], robot["joints"], robot["movable_joints"]) == (2, 1, 0)
    assert robot["simulated"] == {
        "engine": "bullet",
        "links": 1,
        "movable_joints": 0,
        "mass": 1.0,
    }
    # Half inside the ground it is pushed out, and stands.
    assert robot["spawn_pose"]["xyz"] == [0.0, 0.0, 0.0]
    assert robot["rest"]["xyz"][2] == pytest.approx(0.25, abs=0.002)
    assert robot["rest"]["rpy"][:2] == pytest.approx([0.0, 0.0], abs=0.01)
    warnings = {
        found["code"]: found for found in package["diagnostics"] if found["severity"] == "warning"
    }
    text = "\n".join(found["message"] for found in warnings.values())
    assert "inertia" in text
    assert "libgazebo_ros_control.so" in text
    assert "dummy" in text
    assert "0.250 m deep" in text
    assert not [found for found in package["diagnostics"] if found["severity"] == "error"]


def test_a_person_reads_the_same(workspace: Path) -> None:
    run = wsgen(workspace, "validate")
    assert run.returncode == 0
    for words in ("gazebo_test: passed", "simple_robot", "1.000 ", "warning["):
        assert words in run.stdout
