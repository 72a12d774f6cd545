"""Where simulators find meshes, from robots and search paths alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.launch_files import SearchPath, mesh_packages, no_resource_path
from wsgen.model.plan import Process
from wsgen.model.world import Spawn

SPAWNER = Process(package="ros_gz_sim", executable="create", file=Path("a.launch.py"), line=3)
OF_PACKAGE = '<robot name="r"><mesh filename="package://my_robot/meshes/a.stl"/></robot>'
EMPTY = SearchPath(folders=(), reads_exports=True)


@pytest.mark.parametrize(
    ("kind", "path", "cause", "hint"),
    [
        ("gz", EMPTY, "nothing adds the folder of the package to GZ_SIM_RESOURCE_PATH", "export"),
        ("classic", EMPTY, "nothing adds the folder of the package to GAZEBO_MODEL_PATH", "export"),
        (
            "gz",
            EMPTY._replace(reads_exports=False, has_exports=True),
            "only the launch file of ros_gz_sim",
            "AppendEnvironmentVariable('GZ_SIM_RESOURCE_PATH', os.path.join(get_package_prefix(",
        ),
        (
            "gz",
            EMPTY._replace(set_in_vain="GAZEBO_MODEL_PATH"),
            "it reads GZ_SIM_RESOURCE_PATH, not GAZEBO_MODEL_PATH",
            "export",
        ),
        ("gz", EMPTY._replace(folders=("/a",)), "no folder of GZ_SIM_RESOURCE_PATH has", "export"),
    ],
)
def test_why_meshes_are_not_found(kind: str, path: SearchPath, cause: str, hint: str) -> None:
    spawn = Spawn(entity="r", description=OF_PACKAGE, process=SPAWNER)
    (found,) = no_resource_path([spawn], kind, path, lambda package: package == "my_robot")
    assert (found.file, found.line, found.element) == (SPAWNER.file, 3, "r")
    assert "does not find the meshes of package://my_robot, so that `r` is invisible" in (
        found.message
    )
    assert cause in found.message
    assert hint in (found.hint or "")
    assert not list(no_resource_path([spawn], kind, path, lambda _: False))


@pytest.mark.parametrize(
    ("text", "packages"),
    [
        (OF_PACKAGE, ["my_robot"]),
        (OF_PACKAGE.replace("package:", "model:"), ["my_robot"]),
        (OF_PACKAGE.replace("package:", "file:"), []),
        ("<mesh><uri>model://my_robot/meshes/a.dae</uri></mesh>", ["my_robot"]),
        ("<include><uri>model://table</uri></include>", []),
    ],
)
def test_what_meshes_are_looked_up_in(text: str, packages: list[str]) -> None:
    assert mesh_packages(text) == packages
