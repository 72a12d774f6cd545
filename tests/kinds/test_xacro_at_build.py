"""A package whose URDF and world are expanded by xacro while it is built."""

import os
import time
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from kind_workspaces import copy_workspace

pytestmark = pytest.mark.slow


def test_build_and_validate(tmp_path: Path) -> None:
    workspace = copy_workspace("xacro_at_build", tmp_path)
    built = workspace.wsgen("build")
    assert built.code == 0, built.errors

    share = workspace.root / "install" / "crane_description" / "share" / "crane_description"
    for name, length in (("crane", "1.0"), ("long_crane", "1.5"), ("short_crane", "0.5")):
        robot = ET.parse(share / "urdf" / f"{name}.urdf").getroot()
        box = robot.find("link[@name='boom']/visual/geometry/box")
        mesh = robot.find("link[@name='base_link']/visual/geometry/mesh")
        assert box is not None
        assert mesh is not None
        assert box.get("size") == f"{length} 0.1 0.1"
        # Where the package is installed to, though it was not when this was written.
        assert mesh.get("filename") == f"file://{share}/meshes/foot.stl"

    outcome = workspace.wsgen("validate", "--format", "json")
    package = outcome.document["packages"][0]
    assert (outcome.code, package["passed"]) == (0, True), outcome.errors
    assert package["world"]["name"] == "yard"
    (robot,) = package["robots"]
    assert robot["entity"] == "crane"


def test_an_included_file_is_a_dependency(tmp_path: Path) -> None:
    workspace = copy_workspace("xacro_at_build", tmp_path)
    assert workspace.wsgen("build").code == 0
    included = workspace.root / "src" / "hook_description" / "urdf" / "hook.xacro"
    included.write_text(included.read_text().replace('radius="0.05"', 'radius="0.06"'))
    # CMake does not install a file anew that is younger by less than a second.
    before = time.time() - 10.0
    for generated in workspace.root.glob("*/crane_description/**/*crane.urdf"):
        os.utime(generated, (before, before))
    assert workspace.wsgen("build").code == 0
    share = workspace.root / "install" / "crane_description" / "share" / "crane_description"
    for name in ("crane", "long_crane"):
        assert 'radius="0.06"' in (share / "urdf" / f"{name}.urdf").read_text()
