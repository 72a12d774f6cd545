"""Linux on arm64, made up: pip brings no ament_cmake there, until it is told how."""

import json
import os
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from resolved_packages import MADE_UP, RUNNING, install_arguments
from wsgen.errors import EXIT_MISSING

pytestmark = pytest.mark.slow

# Each interpreter of the environment starts with it, that of pip among them. Wheels are still those
# for this machine.
SITE = """
import platform
platform.machine = lambda: "aarch64"
"""
Call = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def call(tmp_path_factory: pytest.TempPathFactory) -> Call:
    """Runs a command in an environment with wsgen that takes itself for one on arm64."""
    folder = tmp_path_factory.mktemp("arm64")
    scripts = folder / "environment" / "bin"
    variables = {
        name: value
        for name, value in os.environ.items()
        if name not in {"VIRTUAL_ENV", "PYTHONPATH", "AMENT_PREFIX_PATH"}
    }

    def call(*command: str | Path, code: int | None = 0) -> subprocess.CompletedProcess[str]:
        program = scripts / command[0] if (scripts / command[0]).exists() else command[0]
        run = subprocess.run(
            [program, *command[1:]],
            cwd=folder,
            env=variables,
            capture_output=True,
            text=True,
            check=False,
        )
        assert code in {run.returncode, None}, f"{command}\n{run.stdout}\n{run.stderr}"
        return run

    call(sys.executable, "-m", "venv", folder / "environment")
    (packages,) = folder.glob("environment/lib/python3.*/site-packages")
    (packages / "another_machine.py").write_text(SITE)
    (packages / "another_machine.pth").write_text("import another_machine\n")
    arguments = install_arguments(tmp_path_factory, MADE_UP, RUNNING)
    call("python", "-m", "pip", *arguments, "--quiet", "--no-compile")
    call("python", "-m", "pip", "check")
    return call


def test_all_but_the_build_works_without_ament_cmake(call: Call) -> None:
    call("wsgen", "new", "gazebo_test", "-w", "ws")
    call("wsgen", "templates")
    call("wsgen", "rule", "missing-ament-package")
    planned = call("wsgen", "launch", "gazebo_test", "gazebo_model.launch.py", "-w", "ws")
    assert "spawn" in planned.stdout


def ament_cmake(call: Call) -> dict[str, str]:
    """What `wsgen doctor` says about it; the exit code is about the engines, too."""
    said = json.loads(call("wsgen", "doctor", "--format", "json", code=None).stdout)
    (found,) = (one for one in said["wsgen"] if one["name"] == "ament_cmake")
    return dict(found)


def test_one_command_of_pip_brings_ament_cmake(call: Call) -> None:
    call("wsgen", "new", "gazebo_test", "-w", "ws_built")
    refused = call("wsgen", "build", "-w", "ws_built", code=EXIT_MISSING)
    (line,) = (line for line in refused.stderr.splitlines() if "try:" in line)
    found = ament_cmake(call)
    assert not found["met"]
    assert line.partition("try:")[2].strip() == found["fix"]
    call(*shlex.split(found["fix"]))
    assert ament_cmake(call)["met"]
    call("wsgen", "build", "-w", "ws_built")
    planned = call("wsgen", "launch", "gazebo_test", "gazebo_model.launch.py", "-w", "ws_built")
    assert "install/gazebo_test/share" in planned.stdout
    # Plain colcon finds it, too.
    call("wsgen", "new", "robot", "-w", "ws_plain")
    call("colcon", "build", "--base-paths", "ws_plain/src")


def test_mujoco_simulates_there(call: Call) -> None:
    pytest.importorskip("wsgen.simulation.mujoco")
    call("wsgen", "new", "standing", "-w", "ws_simulated")
    said = call("wsgen", "validate", "-w", "ws_simulated", "--format", "json")
    (package,) = json.loads(said.stdout)["packages"]
    assert package["robots"][0]["simulated"]["engine"] == "mujoco"
