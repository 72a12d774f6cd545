"""Public robots come to rest in all engines where they do in Gazebo's own physics.

These robots stand; what balances at first or falls over its own legs ends up somewhere else in
every engine.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from kind_workspaces import WORKSPACES
from simulation.conftest import CLASSES
from simulation.gazebo_physics import DEBIAN, GazeboPhysics, is_installed
from simulation.robots import run_of
from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.descriptions.sdf.models import read_model, read_sdf
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.engines import ENGINES as SPECS
from wsgen.model.transform import multiply, rotation_of_rpy, transpose
from wsgen.simulation.run import missing_engines

if TYPE_CHECKING:
    from wsgen.model.robot import Robot
    from wsgen.model.transform import Pose
    from wsgen.simulation.scene import RobotRun


ENGINES = {
    name: getattr(importlib.import_module(f"wsgen.simulation.{name}"), CLASSES[name])
    for name in SPECS
    if not missing_engines([name])
}
pytestmark = [
    pytest.mark.slow,
    pytest.mark.oracle,
    pytest.mark.skipif("dart" not in ENGINES, reason="dartpy is not installed"),
]

SCOUT = WORKSPACES / "ball_caster/src/scout_gazebo/models/scout/model.sdf"

# By how much engines may differ. What rests on round shapes rolls a little while it lands.
SAME_HEIGHT = 0.0001  # m
SAME_PLACE = 0.002  # m
SAME_HEADING = math.radians(0.5)
SAME_TILT = {name: math.radians(0.15 if name == "bullet" else 0.1) for name in ENGINES}
SAME_ENGINE = 0.0005  # m; Gazebo's is DART, of another version

BULLET_DATA = ("pybullet", "pybullet-arm64")
DATA = ("example-robot-data",)
ROBOTS = {  # the end of each path, with what may have installed it
    "pybullet_data/r2d2.urdf": BULLET_DATA,
    "pybullet_data/racecar/racecar.urdf": BULLET_DATA,
    "pybullet_data/duck_vhacd.urdf": BULLET_DATA,
    "pybullet_data/quadruped/minitaur_v1.urdf": BULLET_DATA,
    "pybullet_data/quadruped/quadruped.urdf": BULLET_DATA,
    "pybullet_data/quadruped/spirit40.urdf": BULLET_DATA,
    "pybullet_data/quadruped/vision60.urdf": BULLET_DATA,
    "iris_description/robots/iris.urdf": DATA,
    "hector_description/robots/quadrotor_base.urdf": DATA,
    "talos_data/robots/talos_left_arm.urdf": DATA,
    "iCub/robots/left_wrist_mk2/model.urdf": ("icub-models",),
}

# Spirit40, of the maker of Vision60, and Minitaur have their joints and kinds of shapes: with
# --thorough alone.
ALIKE = ("pybullet_data/quadruped/vision60.urdf", "pybullet_data/quadruped/quadruped.urdf")

# What rests in a joint that only its friction holds rests at any height within what that holds: the
# wrist of the arm that stands on its hand, the legs that give way to the side.
HELD_BY_FRICTION = (
    "pybullet_data/quadruped/vision60.urdf",
    "talos_data/robots/talos_left_arm.urdf",
)

# Its OBJ has no normals: Gazebo's reader then leaves the mesh out, and the duck falls for ever.
NOT_IN_GAZEBO = ("pybullet_data/duck_vhacd.urdf",)


def installed(ending: str, distributions: tuple[str, ...]) -> Path:
    for distribution in distributions:
        try:
            files = importlib.metadata.files(distribution) or []
        except importlib.metadata.PackageNotFoundError:
            continue
        for file in files:
            if file.as_posix().endswith(ending):
                return Path(str(file.locate())).resolve()
    pytest.skip(f"{' or '.join(distributions)} is not installed")


def prepared(file: Path) -> Robot:
    """The robot as written, with the files of its meshes."""

    def share_of(package: str) -> Path | None:
        folders = (folder / package for folder in file.parents)
        return next((folder for folder in folders if folder.is_dir()), None)

    written, _ = read_urdf(file.read_text(encoding="utf-8"), file=file)
    assert written is not None
    located, missing = find_meshes(written, share_of=share_of, folder=file.parent)
    assert missing == ()
    return located


def apart(one: Pose, other: Pose) -> tuple[float, float]:
    """How far two poses are from each other, m and rad."""
    turned = multiply(rotation_of_rpy(one.rpy), transpose(rotation_of_rpy(other.rpy)))
    cosine = (turned[0][0] + turned[1][1] + turned[2][2] - 1) / 2
    return math.dist(one.xyz, other.xyz), math.acos(max(-1.0, min(1.0, cosine)))


def assert_same_rest(ending: str, one: Pose, other: Pose, *, same_place: float) -> None:
    place, angle = apart(one, other)
    assert place < same_place
    assert angle < SAME_HEADING
    if ending not in HELD_BY_FRICTION:
        assert one.xyz[2] == pytest.approx(other.xyz[2], abs=SAME_HEIGHT)


@pytest.fixture(scope="module")
def gazebo(tmp_path_factory: pytest.TempPathFactory) -> GazeboPhysics:
    if not is_installed():
        pytest.skip(f"Gazebo's physics (Debian: {DEBIAN}) are missing")
    return GazeboPhysics(tmp_path_factory)


@functools.cache
def runs_of(ending: str) -> tuple[Robot, dict[str, RobotRun]]:
    """The robot as written, and its simulations by engine."""
    written = prepared(installed(ending, ROBOTS[ending]))
    lumped, _ = lump(written)
    assert lumped is not None
    return written, {
        name: run_of(engine, lumped, on_the_ground=True) for name, engine in ENGINES.items()
    }


def leave_out(ending: str, *, thorough: bool) -> None:
    if ending in ALIKE and not thorough:
        pytest.skip("another robot is alike")


@pytest.mark.parametrize("ending", ROBOTS)
def test_the_engines_agree_on_how_it_rests(ending: str, *, thorough: bool) -> None:
    leave_out(ending, thorough=thorough)
    written, runs = runs_of(ending)
    for one in runs.values():
        assert one.settled_after is not None
        assert one.mass == pytest.approx(written.mass, rel=1e-6)
        assert one.movable_joints == len(written.movable_joints)
    dart = runs["dart"]  # Gazebo's
    for one in runs.values():
        assert one.links == dart.links
        assert_same_rest(ending, one.rest_pose, dart.rest_pose, same_place=SAME_PLACE)


def test_a_robot_on_a_ball_rests_as_in_gazebo(gazebo: GazeboPhysics) -> None:
    """On two wheels and a ball; without the ball it would lean on its chassis."""
    inside = re.search('<model name="scout">(.*)</model>', SCOUT.read_text(), re.DOTALL)
    assert inside is not None
    rest = gazebo.rest_pose_of_model("scout", inside[1], "chassis", 0.05, steps=3000)
    (model,) = read_sdf(SCOUT, find_model=lambda _: None).models
    assert model.robot is not None
    for engine in ENGINES.values():
        robot_run = run_of(engine, model.robot, 0.05 + model.pose_in_world.xyz[2])
        assert (robot_run.movable_joints, robot_run.links) == (3, 4)
        place, angle = apart(robot_run.rest_pose, rest)
        assert place < SAME_PLACE
        assert angle < SAME_HEADING


def cart() -> str:
    """What the model holds of a cart whose front wheels steer and turn by universal joints."""
    inertial = (
        "<inertial><mass>{0}</mass>"
        "<inertia><ixx>{1}</ixx><iyy>{1}</iyy><izz>{1}</izz></inertia></inertial>"
    )
    box = "<collision name='c'><geometry><box><size>1 0.5 0.1</size></box></geometry></collision>"
    ball = (
        "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>"
    )
    parts = [f"<link name='chassis'>{inertial.format(20, 1)}{box}</link>"]
    for name, x, y in (("fl", 0.4, 0.3), ("fr", 0.4, -0.3), ("bl", -0.4, 0.3), ("br", -0.4, -0.3)):
        steer = "<axis><xyz>0 0 1</xyz><limit><lower>-0.5</lower><upper>0.5</upper></limit></axis>"
        roll = "<xyz>0 1 0</xyz><dynamics><damping>0.1</damping></dynamics>"
        kind, axes = ("universal", f"{steer}<axis2>{roll}</axis2>")
        if name.startswith("b"):
            kind, axes = "revolute", f"<axis>{roll}</axis>"
        parts += [
            f"<link name='{name}'><pose>{x} {y} -0.05 0 0 0</pose>",
            f"{inertial.format(1, 0.01)}{ball}</link>",
            f"<joint name='{name}_joint' type='{kind}'><parent>chassis</parent>",
            f"<child>{name}</child>{axes}</joint>",
        ]
    return "".join(parts)


def test_a_cart_on_universal_joints_rests_as_in_gazebo(gazebo: GazeboPhysics) -> None:
    text = f"<sdf version='1.8'><model name='cart'>{cart()}</model></sdf>"
    (model,) = read_model(text, file=None, find_model=lambda _: None).models
    assert model.robot is not None
    rest = gazebo.rest_pose_of_model("cart", cart(), "chassis", 0.2, steps=3000)
    for engine in ENGINES.values():
        robot_run = run_of(engine, model.robot, 0.2)
        assert robot_run.movable_joints == 6
        place, angle = apart(robot_run.rest_pose, rest)
        assert place < SAME_PLACE
        assert angle < SAME_HEADING


@pytest.mark.parametrize("ending", [ending for ending in ROBOTS if ending not in NOT_IN_GAZEBO])
def test_the_engines_agree_with_gazebo(
    gazebo: GazeboPhysics, ending: str, *, thorough: bool
) -> None:
    leave_out(ending, thorough=thorough)
    written, runs = runs_of(ending)
    text = installed(ending, ROBOTS[ending]).read_text(encoding="utf-8")
    z = next(iter(runs.values())).spawn_pose.xyz[2]
    rest = gazebo.rest_pose(text, written, z, steps=3000)
    for name, one in runs.items():
        same_place = SAME_ENGINE if name == "dart" else SAME_PLACE
        assert_same_rest(ending, one.rest_pose, rest, same_place=same_place)
        tilts = [math.acos(rotation_of_rpy(pose.rpy)[2][2]) for pose in (one.rest_pose, rest)]
        assert tilts[0] == pytest.approx(tilts[1], abs=SAME_TILT[name])
