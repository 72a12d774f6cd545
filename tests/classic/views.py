"""What cameras look at: a world of stations side by side, 10 m apart, and a camera before each.

All is drawn in one world, because a server with a display takes half a minute to start.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, NamedTuple

from classic.test_drives import Subject, subject
from mesh_samples import binary_stl
from wsgen.model.robot import GAZEBO_COLORS
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

APART = 10.0  # m
TILE, COLUMNS = 0.4, 8  # m, the distance of what is painted; how many are in a row

TEXTURES = {
    f"Gazebo/{name}"
    for name in (
        *("Wood", "WoodFloor", "WoodPallet", "CeilingTiled", "PaintedWall", "Bricks", "Road"),
        *("Residential", "Grass", "Pedestrian"),
    )
}

# What is painted in another way than by a name of Gazebo.
PAINTS = {
    "nothing": "",
    "ambient and diffuse": "<ambient>0.8 0.2 0.1 1</ambient><diffuse>0.8 0.2 0.1 1</diffuse>",
    "diffuse alone": "<diffuse>0.1 0.6 0.3 1</diffuse>",
    "ambient alone": "<ambient>0.1 0.6 0.3 1</ambient>",
    "darker ambient": "<ambient>0.1 0.1 0.1 1</ambient><diffuse>0.2 0.4 0.8 1</diffuse>",
    "emissive": "<ambient>0 0 0 1</ambient><diffuse>0 0 0 1</diffuse>"
    "<emissive>0.9 0.5 0 1</emissive>",
    "name and diffuse": "{Gazebo/Red}<ambient>0 0.7 0 1</ambient><diffuse>0 0.7 0 1</diffuse>",
    "name and ambient": "{Gazebo/Red}<ambient>0 0.5 0.5 1</ambient>",
    "name and emissive": "{Gazebo/Red}<emissive>0 0 0.5 1</emissive>",
    "black": "<ambient>0 0 0 1</ambient><diffuse>0 0 0 1</diffuse>",
}


class View(NamedTuple):
    """A camera, and what it looks at; poses are seen from the station."""

    things: str  # visuals of SDF
    camera: Pose = Pose((0.0, 0.0, 1.0), (0.0, 0.2, 0.0))
    size: tuple[int, int] = (320, 240)  # pixels
    field_of_view: float = 1.047  # rad
    clip: tuple[float, float] = (0.1, 100.0)  # m
    is_deep: bool = True  # its depths are compared, too

    @property
    def kinds(self) -> tuple[str, ...]:
        """Of the sensors that are there."""
        return ("camera", "depth") if self.is_deep else ("camera",)

    def lens(self) -> str:
        """Its <camera>."""
        (width, height), (near, far) = self.size, self.clip
        return (
            f"<camera><horizontal_fov>{self.field_of_view}</horizontal_fov>"
            f"<image><width>{width}</width><height>{height}</height></image>"
            f"<clip><near>{near}</near><far>{far}</far></clip></camera>"
        )


def numbers(pose: Pose) -> str:
    return " ".join(map(str, (*pose.xyz, *pose.rpy)))


def named(name: str) -> str:
    return (
        "<script><uri>file://media/materials/scripts/gazebo.material</uri>"
        f"<name>{name}</name></script>"
    )


def visual(name: str, shape: str, material: str, *xyzrpy: float) -> str:
    pose = " ".join(map(str, xyzrpy))
    own = f"<material>{material}</material>" if material else ""
    return f"<visual name='{name}'><pose>{pose}</pose><geometry>{shape}</geometry>{own}</visual>"


BOX = "<box><size>1 0.6 0.8</size></box>"
SPHERE = "<sphere><radius>0.4</radius></sphere>"
CYLINDER = "<cylinder><radius>0.3</radius><length>1.2</length></cylinder>"
RED, GREEN, BLUE = (named(f"Gazebo/{name}") for name in ("Red", "Green", "Blue"))
MESH = "<mesh><uri>file://{folder}/box.stl</uri><scale>0.4 0.3 0.2</scale></mesh>"


def tiles(paints: Mapping[str, str]) -> str:
    """One beside the other on the ground, seen from above."""
    plate = f"<box><size>{0.8 * TILE} {0.8 * TILE} 0.1</size></box>"
    return "".join(
        visual(f"t{number}", plate, paint, *place(number), 0.05, 0, 0, 0)
        for number, paint in enumerate(paints.values())
    )


def place(number: int) -> tuple[float, float]:
    """Where the middle of a tile is, m."""
    row, column = divmod(number, COLUMNS)
    return (row - 3) * TILE, (column - (COLUMNS - 1) / 2) * TILE


def below(height: float) -> Pose:
    """A camera that looks straight down; up in its picture is x."""
    return Pose((0.0, 0.0, height), (0.0, math.pi / 2, 0.0))


# Textures are one color here.
NAMED = {name: named(name) for name in GAZEBO_COLORS if name not in TEXTURES}
PAINTED = {name: paint.replace("{Gazebo/Red}", RED) for name, paint in PAINTS.items()}

VIEWS = {
    "shapes": View(
        visual("box", BOX, RED, 3, 1, 0.4, 0, 0, 0.4)
        + visual("sphere", SPHERE, GREEN, 3, 0, 0.4, 0, 0, 0)
        + visual("cylinder", CYLINDER, BLUE, 3, -1, 0.6, 0.2, 0, 0)
    ),
    "wide": View(
        visual("box", BOX, RED, 2, 2.2, 0.4, 0, 0, 0.4)
        + visual("sphere", SPHERE, GREEN, 2, 0.3, 0.9, 0, 0, 0)
        + visual("cylinder", CYLINDER, BLUE, 2, -2, 0.6, 0, 0.3, 0),
        camera=Pose((0.0, 0.0, 1.0), (0.3, 0.1, 0.05)),
        size=(480, 200),
        field_of_view=2.0,
    ),
    "near and far": View(
        visual("box", BOX, RED, 2, 0.5, 1, 0, 0, 0)
        + visual("sphere", SPHERE, GREEN, 3.2, -0.3, 0.8, 0, 0, 0)
        + visual("cylinder", CYLINDER, BLUE, 4.4, -1.3, 0.6, 0, 0, 0),
        clip=(2.0, 4.4),
    ),
    "mesh": View(
        visual("mesh", MESH, GREEN, 2.5, 0, 0.6, 0.4, 0.3, 0.5),
    ),
    "sunny": View(
        visual("box", BOX, RED, 0, 0.9, 0.4, 0, 0, 0.4)
        + visual("sphere", SPHERE, GREEN, 0, 0, 0.4, 0, 0, 0)
        + visual("cylinder", CYLINDER, BLUE, 0, -0.9, 0.6, 0, 0, 0),
        camera=Pose((3.0, 0.0, 1.2), (0.0, 0.2, math.pi)),
        is_deep=False,
    ),
    "names": View(tiles(NAMED), camera=below(3.4), is_deep=False),
    "paints": View(tiles(PAINTED), camera=below(3.4), is_deep=False),
    "robot": View(
        "",
        camera=Pose((1.1, -0.95, 0.6), (0.0, 0.38, math.pi - math.atan2(0.95, 1.1))),
        size=(480, 360),
        field_of_view=0.7,
        is_deep=False,
    ),
}


def station(name: str) -> float:
    """Its y, m."""
    return (list(VIEWS).index(name) - (len(VIEWS) - 1) / 2) * APART


def placed(name: str) -> Pose:
    """The camera in the world."""
    x, y, z = VIEWS[name].camera.xyz
    return Pose((x, y + station(name), z), VIEWS[name].camera.rpy)


def robot_of(folder: Path) -> Subject:
    """The template `diff_drive`, but for its sensors."""
    one = subject("diff_drive", folder)
    return one._replace(urdf=re.sub(r"<sensor.*?</sensor>", "", one.urdf, flags=re.DOTALL))


def write_world(folder: Path, seen_from: str = "") -> Path:
    """The file of the world; its reader sees the folder below `seen_from`."""
    (folder / "box.stl").write_bytes(binary_stl())
    parts = []
    for number, (name, view) in enumerate(VIEWS.items()):
        things = view.things.replace("{folder}", f"{seen_from}{folder}")
        if things:
            parts.append(
                f"<model name='things{number}'><static>true</static>"
                f"<pose>0 {station(name)} 0 0 0 0</pose><link name='l'>{things}</link></model>"
            )
        sensors = "".join(
            f"<sensor name='{kind}{number}' type='{kind}'><update_rate>0</update_rate>"
            f"{view.lens()}</sensor>"
            for kind in view.kinds
        )
        parts.append(
            f"<model name='camera{number}'><static>true</static><pose>{numbers(placed(name))}"
            f"</pose><link name='l'>{sensors}</link></model>"
        )
    file = folder / f"views{'_there' if seen_from else ''}.world"
    file.write_text(
        "<sdf version='1.6'><world name='w'><include><uri>model://ground_plane</uri></include>"
        f"<include><uri>model://sun</uri></include>{''.join(parts)}</world></sdf>"
    )
    return file
