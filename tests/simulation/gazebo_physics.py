"""Gazebo's own physics as an oracle: the Debian libraries of Gazebo Fortress."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from gazebo_oracle import ign_sdf
from made_once import made_once
from wsgen.model.robot import Mesh
from wsgen.model.transform import Pose, rotation_of_quaternion, rpy_of_rotation

if TYPE_CHECKING:
    import pytest

    from wsgen.model.robot import Collision, Robot, Visual


SOURCE = Path(__file__).with_name("gazebo_links.cc")
PACKAGES = (
    "ignition-physics5-dartsim-plugin",
    "ignition-physics5-sdf",
    "ignition-physics5-mesh",
    "ignition-physics5-heightmap",
    "ignition-plugin1-loader",
    "ignition-common4-graphics",
    "ignition-math6-eigen3",
    "sdformat12",
)
DEBIAN = "libignition-physics-dev libignition-physics-heightmap-dev ignition-tools g++ pkg-config"
PLUGIN = "libignition-physics5-dartsim-plugin.so"
SECONDS = 1200.0

WORLD = """\
<sdf version="1.9"><world name="drop">
<gravity>0 0 -9.8</gravity>
<physics name="fast" type="dart"><max_step_size>0.001</max_step_size></physics>
<model name="ground"><static>true</static><link name="link"><collision name="plane"><geometry>
<plane><normal>0 0 1</normal><size>100 100</size></plane>
</geometry></collision></link></model>
{model}
</world></sdf>
"""


def is_installed() -> bool:
    """Whether there are Gazebo's libraries, and what compiles against them."""
    if not all(map(shutil.which, ("g++", "pkg-config", "ign"))):
        return False
    return subprocess.run(["pkg-config", "--exists", *PACKAGES], check=False).returncode == 0


class GazeboPhysics:
    """The program that lets a world run, compiled once in a run of tests: that takes 12 s."""

    def __init__(self, factory: pytest.TempPathFactory) -> None:
        def compile_it(folder: Path) -> None:
            flags = _answer("pkg-config", "--cflags", "--libs", *PACKAGES).split()
            _answer("g++", "-std=c++17", str(SOURCE), "-o", str(folder / "gazebo_links"), *flags)

        self.folder = factory.mktemp("gazebo")
        self.program = made_once(factory, "gazebo", compile_it) / "gazebo_links"
        libraries = _answer("pkg-config", "--variable=libdir", "ignition-physics5").strip()
        self.plugin = Path(libraries, PLUGIN)

    def run(self, world: str, *, steps: int) -> dict[str, Pose]:
        """Where each link of a world is after so many steps, as MODEL::LINK, seen from the world.

        `world` is its SDF.
        """
        file = self.folder / "world.sdf"
        file.write_text(world, encoding="utf-8")
        answer = _answer(str(self.program), str(self.plugin), str(file), str(steps))
        poses = {}
        for line in answer.splitlines():
            *numbers, link = line.split(maxsplit=7)
            if "::" not in link:  # what the engine says
                continue
            x, y, z, *xyzw = map(float, numbers)
            rotation = rotation_of_quaternion((xyzw[0], xyzw[1], xyzw[2], xyzw[3]))
            poses[link] = Pose((x, y, z), rpy_of_rotation(rotation))
        return poses

    def rest_pose(self, text: str, robot: Robot, z: float, *, steps: int) -> Pose:
        """Where the root link is after so many steps, spawned at that height.

        `text` is the URDF; `robot` is what it describes, with the files of its meshes.
        """
        (self.folder / "robot.urdf").write_text(_with_mesh_files(text, robot), encoding="utf-8")
        printed = _answer(*ign_sdf("-p", self.folder / "robot.urdf"))
        found = re.search(r"<model name='([^']*)'>(.*)</model>", printed, re.DOTALL)
        assert found is not None, printed
        name, inside = found.groups()
        return self.rest_pose_of_model(name, inside, robot.root, z, steps=steps)

    def rest_pose_of_model(
        self, name: str, inside: str, link: str, z: float, *, steps: int
    ) -> Pose:
        """Where a link of an SDF model is, likewise; `inside` is what the model holds."""
        model = f"<model name='{name}'><pose>0 0 {z!r} 0 0 0</pose>{inside}</model>"
        return self.run(WORLD.format(model=model), steps=steps)[f"{name}::{link}"]


def _with_mesh_files(text: str, robot: Robot) -> str:
    shapes: list[Visual | Collision] = []
    for link in robot.links:
        shapes += link.visuals
        shapes += link.collisions
    meshes = {shape.geometry for shape in shapes if isinstance(shape.geometry, Mesh)}
    for mesh in meshes:
        text = text.replace(f'"{mesh.uri}"', f'"file://{mesh.path}"')
    return text


def _answer(*command: str) -> str:
    run = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert run.returncode == 0, run.stderr[-2000:]
    return run.stdout
