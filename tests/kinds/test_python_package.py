"""A package built by setuptools: launch files, models and a node."""

import os
import subprocess
from pathlib import Path

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("link", [False, True])
def test_build_and_validate(link: bool, tmp_path: Path) -> None:
    workspace = copy_workspace("python_package", tmp_path)
    built = workspace.wsgen("build", *(("--", "--symlink-install") if link else ()))
    assert built.code == 0, built.errors
    assert "warning" not in built.errors.lower()  # setuptools has several

    prefix = workspace.root / "install" / "beetle_bringup"
    launch_file = prefix / "share" / "beetle_bringup" / "launch" / "beetle.launch.py"
    assert launch_file.is_symlink() == link
    assert os.access(prefix / "lib" / "beetle_bringup" / "drive_in_circles", os.X_OK)

    outcome = workspace.wsgen("validate", "--format", "json")
    (package,) = outcome.document["packages"]
    assert (outcome.code, package["passed"]) == (0, True), outcome.errors
    (robot,) = package["robots"]
    assert robot["entity"] == "beetle"


def test_the_node_is_found_by_its_modules(tmp_path: Path) -> None:
    workspace = copy_workspace("python_package", tmp_path)
    assert workspace.wsgen("build").code == 0
    script = workspace.root / "install" / "beetle_bringup" / "lib" / "beetle_bringup"
    run = subprocess.run(
        ["bash", "-c", ". install/setup.bash && exec $0", str(script / "drive_in_circles")],
        cwd=workspace.root,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "No module named 'rclpy'" in run.stderr  # its own were found
