"""Where simulators find meshes, from robots and environments alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.model.plan import Process
from wsgen.model.world import Spawn
from wsgen.rules.resource_paths import SETTING, no_resource_path

SPAWNER = Process(package="ros_gz_sim", executable="create", file=Path("a.launch.py"), line=3)
MESH = '<robot name="r"><mesh filename="{}"/></robot>'
OF_PACKAGE = MESH.format("package://my_robot/meshes/a.stl")


def check(
    text: str,
    kinds: tuple[str, ...] = ("gz",),
    *,
    sets_path: bool = False,
    **environment: str,
) -> list[str]:
    spawn = Spawn(entity="r", description=text, process=SPAWNER)
    found = list(no_resource_path([spawn], kinds, environment, lambda: sets_path))
    assert all((one.file, one.line, one.element) == (SPAWNER.file, 3, "r") for one in found)
    return [one.name for one in found]


@pytest.mark.parametrize("kind", ["gz", "classic"])
def test_meshes_that_the_simulator_does_not_find(kind: str) -> None:
    assert check(OF_PACKAGE, (kind,)) == ["no-resource-path"]


def test_meshes_that_the_simulator_finds() -> None:
    assert check(OF_PACKAGE, sets_path=True) == []
    assert check(OF_PACKAGE, GZ_SIM_RESOURCE_PATH="/share") == []
    assert check(OF_PACKAGE, ("classic",), GAZEBO_MODEL_PATH="/share") == []
    assert check(OF_PACKAGE, ("classic", "gz")) == []
    assert check(OF_PACKAGE, ()) == []
    assert check(MESH.format("file:///share/my_robot/a.stl")) == []


@pytest.mark.parametrize(
    "text",
    [
        b'<gazebo_ros gazebo_model_path="${prefix}/.."/>',
        b"prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;share",
        b"SetEnvironmentVariable('GAZEBO_MODEL_PATH', path)",
    ],
)
def test_what_sets_a_search_path(text: bytes) -> None:
    assert SETTING.search(text)
