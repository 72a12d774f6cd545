"""The pictures of docs/pictures.md are what wsgen draws; `--regenerate` draws them anew."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pytest
from PIL import Image

from public_robots import find_robot

if TYPE_CHECKING:
    from numpy.typing import NDArray


PAGE = Path(__file__).parents[2] / "docs" / "pictures.md"
FOLDER = PAGE.with_suffix("")


class Drawn(NamedTuple):
    """A robot of the page; its model is under the license that its package names."""

    title: str
    package: str
    path: str
    license: str


ROBOTS = {
    "baxter": Drawn(
        "Baxter", "example-robot-data", "baxter_description/urdf/baxter.urdf", "BSD-3-Clause"
    ),
    "g1": Drawn(
        "Unitree G1",
        "example-robot-data",
        "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
        "BSD-3-Clause",
    ),
    "hector": Drawn(
        "Hector quadrotor",
        "example-robot-data",
        "hector_description/robots/quadrotor_base.urdf",
        "BSD",
    ),
    "panda": Drawn(
        "Franka Panda", "example-robot-data", "panda_description/urdf/panda.urdf", "Apache-2.0"
    ),
    "pr2": Drawn("PR2", "example-robot-data", "pr2_description/urdf/pr2.urdf", "BSD"),
    "r2d2": Drawn("R2-D2 of the URDF tutorial", "pybullet", "r2d2.urdf", "BSD"),
    "racecar": Drawn("MIT Racecar", "pybullet", "racecar/racecar.urdf", "BSD"),
    "so100": Drawn(
        "SO-100", "example-robot-data", "so_arm_description/urdf/so100.urdf", "Apache-2.0"
    ),
    "upkie": Drawn("Upkie", "upkie_description", "urdf/upkie.urdf", "Apache-2.0"),
    "ur5": Drawn("UR5", "example-robot-data", "ur_description/urdf/ur5_robot.urdf", "BSD"),
}

HEAD = """\
# Ten robots

These pictures are what `wsgen validate --picture DIR --seconds 0.1` draws of ten published robots
from PyPI. wsgen draws them itself, with NumPy, without a display or a graphics card: the same
picture with every engine and on every platform. All triangles of a mesh are drawn, millions of
them if need be, in the colors and textures of its file; things throw shadows on the ground, on each
other and on themselves, and nooks between them are darker. What is transparent is drawn over the
rest, and what is under the ground faintly. A square of the ground has the size that is written into
the picture.

The models belong to their authors; each has the license of its package.
`pytest tests/rendering/test_pictures.py --regenerate` draws them again; a test compares them.
"""

TAIL = """
## Before and after

Until wsgen had a renderer of its own, PyBullet's drew the pictures (left): without shadows on the
robots, and of dense meshes only a part of the triangles.
"""

SHEETS = ("before-after-arms", "before-after-humanoids", "before-after-vehicles")

SMALL = (48, 36)  # pixels in which pictures are compared: what the renderer does at edges is lost
ALIKE = 6.0  # levels of 256, mean over a small picture

pytestmark = pytest.mark.oracle


def draw(files: dict[str, Path], folder: Path) -> None:
    """The robots' pictures, under their short names."""
    done = subprocess.run(
        [
            *(sys.executable, "-m", "wsgen", "validate", "-q", "--format", "json"),
            *("--seconds", "0.1", "--picture", str(folder), *map(str, files.values())),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    packages = json.loads(done.stdout)["packages"]
    for name, package in zip(files, packages, strict=True):
        assert package["passed"], (name, package["diagnostics"])
        Path(package["picture"]).rename(folder / f"{name}.png")


def pixels(file: Path) -> NDArray[np.float64]:
    with Image.open(file) as picture:
        small = picture.convert("RGB").resize(SMALL, Image.Resampling.BOX)
    return np.asarray(small, dtype=float)


@pytest.mark.slow
def test_the_pictures_are_what_is_drawn(*, tmp_path: Path, regenerate: bool) -> None:
    files = {
        name: file
        for name, robot in ROBOTS.items()
        if (file := find_robot(robot.package, robot.path))
    }
    if len(files) < len(ROBOTS):
        pytest.skip("the packages with robots are not installed")
    folder = FOLDER if regenerate else tmp_path
    draw(files, folder)
    for name in ROBOTS:
        apart = float(
            np.abs(pixels(folder / f"{name}.png") - pixels(FOLDER / f"{name}.png")).mean()
        )
        assert apart < ALIKE, name


def test_the_page_shows_all_pictures(*, regenerate: bool) -> None:
    text = HEAD + "".join(
        f"\n## {robot.title}\n\n`{robot.path}` of {robot.package} ({robot.license})\n\n"
        f"![{robot.title}](pictures/{name}.png)\n"
        for name, robot in ROBOTS.items()
    )
    text += TAIL + "".join(f"\n![Before and after](pictures/{name}.png)\n" for name in SHEETS)
    if regenerate:
        PAGE.write_text(text, encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8") == text
    pages = "".join(page.read_text(encoding="utf-8") for page in PAGE.parent.glob("*.md"))
    shown = set(re.findall(r"\(pictures/([\w-]+)\.png\)", pages))
    assert {file.stem for file in FOLDER.glob("*.png")} == shown
