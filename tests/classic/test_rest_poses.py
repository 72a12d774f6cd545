"""How things come to rest, in wsgen's engines and in the real Gazebo Classic.

`recorded/still_lifes.json` has the centers of mass of the links of `still_lifes.py` after 3 s in
Debian 11's Gazebo 11.1, m, and what is up in the first link of each model.
`recorded/rest_poses.json` has the same of robots of PyPI that begin as low as they can stand, if
five starts (0.2 mm higher, 0.002 rad tilted) end with all links equally high (1 mm) and the first
one equally tilted (0.1 degrees); of the others it has how far they are apart. `--regenerate`
records both anew.
"""

from __future__ import annotations

import functools
import importlib
import math
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from lxml import etree

from classic.gazebo_classic import NEEDS_CLASSIC, EndedError, GazeboClassic, inside, recorded_in
from classic.still_lifes import STILL_LIFES, world_of
from classic.test_classic_robots import read
from public_robots import ROBOTS
from simulation.conftest import CLASSES
from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.engines import ENGINES as SPECS
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Mesh
from wsgen.model.transform import (
    IDENTITY,
    Pose,
    compose,
    rotate,
    rotation_of_quaternion,
    rotation_of_rpy,
)
from wsgen.model.world import World
from wsgen.pipeline.prepare import can_simulate, for_simulator
from wsgen.simulation.run import missing_engines
from wsgen.simulation.scene import SpawnedRobot
from wsgen.simulation.surfaces import lowest_point

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from wsgen.model.robot import Robot
    from wsgen.model.transform import Vector
    from wsgen.simulation.engine import Engine

RECORDED = Path(__file__).with_name("recorded")
ENGINES = [name for name in SPECS if not missing_engines([name])]
SECONDS = 3.0
LATER = 0.2
WORLD = World(name="w", has_ground_plane=True, ground_friction=100.0)
STARTS = (  # how much higher than it can stand, m, and how tilted, rad
    (0.0, 0.0, 0.0),
    (0.0001, 0.002, 0.0),
    (0.0001, -0.002, 0.0),
    (0.0002, 0.0, 0.002),
    (0.0002, 0.0, -0.002),
)
SAME_HEIGHT = 0.001  # m
SAME_TILT = 0.1  # degrees
SAME_PLACE = 0.04  # m; the real one creeps, and what falls lands somewhere else
LIVE = ("cart, two wheels and a caster", "leans against a wall")

# What does not rest as there, in these engines, and why.
EXPLICIT = "its joints have more damping than explicit steps take: there they become NaN"
FALLEN = "it falls over its own legs"
DIFFERENT = {
    "allegro_left_hand": (ENGINES, EXPLICIT),
    "icub": (ENGINES, EXPLICIT),
    "tiago_pro": (ENGINES, "its arms are still falling"),
    "anymal_b": (ENGINES, FALLEN),
    "borinot_flying_arm_2": (["bullet", "dart"], FALLEN),
    "upkie": (["dart"], FALLEN),
    "cart, two wheels and a low caster": (["dart"], "it rocks onto its other edge"),
}

pytestmark = [
    pytest.mark.oracle,
    pytest.mark.slow,
    pytest.mark.timeout(3600),  # to record them takes a quarter of an hour
]


def seen(gazebo: GazeboClassic, model: str) -> dict[str, Any]:
    """The centers of mass of a model's links, m, and what is up in its first link."""
    links = gazebo.state()[model]["links"]
    centers: dict[str, list[float]] = {}
    up: list[float] = []
    for name, link in links.items():
        if None in link["pose"]:
            return {"is_finite": False}
        x, y, z, *turn = link["pose"]
        rotation = rotation_of_quaternion((*turn[1:], turn[0]))
        center = rotate(rotation, tuple(link["cog"]))
        centers[name.removeprefix(f"{model}::")] = [
            round(sum(parts), 5) for parts in zip((x, y, z), center, strict=True)
        ]
        up = up or [round(part, 6) for part in rotation[2]]
    return {"centers": centers, "up": up}


def ask_still_life(name: str, folder: Path) -> dict[str, Any]:
    file = folder / "w.world"
    file.write_text(world_of(STILL_LIFES[name]), encoding="utf-8")
    with GazeboClassic(file) as gazebo:
        gazebo.run(SECONDS)
        models = [model for model in gazebo.state() if model != "ground_plane"]
        return {model: seen(gazebo, model) for model in models}


def ask_robot(name: str, folder: Path) -> dict[str, Any] | None:
    robot, text = robot_of(name)
    if robot is None:
        return None
    world, file = folder / "w.world", folder / "r.urdf"
    world.write_text(world_of(""), encoding="utf-8")
    file.write_text(text, encoding="utf-8")
    z = as_low_as_it_can_stand(robot)
    runs = []

    def run(z: float, roll: float, pitch: float) -> None:
        with GazeboClassic(world) as gazebo:
            gazebo.spawn(file, "r", z=z, rpy=(roll, pitch, 0))
            gazebo.run(SECONDS)
            runs.append(seen(gazebo, "r"))
            gazebo.run(LATER)  # what swings is not at rest
            runs.append(seen(gazebo, "r"))

    try:
        for higher, roll, pitch in STARTS:
            run(z + higher, roll, pitch)
    except (EndedError, ValueError):
        return {"crashed": True}
    if not all("up" in run for run in runs):
        return {"is_finite": False}
    apart = max(
        abs(run["centers"][link][2] - center[2])
        for run in runs
        for link, center in runs[0]["centers"].items()
    )
    turned = max(angle(run["up"], runs[0]["up"]) for run in runs)
    if max(z for _, _, z in runs[0]["centers"].values()) < 0:
        return {"falls": True}
    if apart > SAME_HEIGHT or turned > SAME_TILT:
        return {"apart": round(apart, 4), "turned": round(turned, 2)}
    return runs[0]


def angle(one: Iterable[float], other: Iterable[float]) -> float:
    """Between two directions, degrees."""
    cosine = sum(a * b for a, b in zip(one, other, strict=True))
    return math.degrees(math.acos(max(-1.0, min(1.0, cosine))))


@functools.cache
def robot_of(name: str) -> tuple[Robot | None, str]:
    """A robot with its collision meshes, and its URDF for the server.

    None of one that wsgen does not simulate for Gazebo Classic, or that is fixed to the world.
    """
    text, file = read(name)

    def share_of(package: str) -> Path | None:
        folders = (folder / package for folder in file.parents)
        return next((folder for folder in folders if folder.is_dir()), None)

    robot, found = read_urdf(text, file=file)
    if robot is None:
        return None, ""
    robot, _ = find_meshes(robot, share_of=share_of, folder=file.parent)
    shapes = [shape.geometry for link in robot.links for shape in link.collisions]
    paths = {shape.uri: shape.path for shape in shapes if isinstance(shape, Mesh)}
    lumped, more = lump(robot, file=file, for_classic=True)
    found = tuple(for_simulator((*found, *more), "classic"))
    if not can_simulate(lumped, found, "classic") or lumped.fixed_to_world:
        return None, ""
    return lumped, _for_server(text, paths)


def _for_server(text: str, paths: dict[str, str | None]) -> str:
    """Without what only shows, measures or drives, and with meshes where the server sees them."""
    tree = etree.fromstring(text.encode(), etree.XMLParser(recover=True))
    for element in list(tree.iter("visual", "plugin", "ros2_control", "sensor")):
        element.getparent().remove(element)
    for mesh in tree.iter("mesh"):
        path = paths.get(mesh.get("filename", ""))
        if path is not None:
            mesh.set("filename", f"file://{inside(Path(path))}")
    return etree.tostring(tree, encoding="unicode")


def as_low_as_it_can_stand(robot: Robot) -> float:
    """The height of its root, m."""
    return -lowest_point(robot, link_poses(robot, IDENTITY))


def engine_of(name: str) -> Callable[[World], Engine]:
    engine: Callable[[World], Engine] = getattr(
        importlib.import_module(f"wsgen.simulation.{name}"), CLASSES[name]
    )
    return engine


def simulated(name: str, world: World, robots: list[SpawnedRobot]) -> dict[str, dict[str, Any]]:
    """The same of wsgen, by entity."""
    with closing(engine_of(name)(world)) as engine:
        for one in robots:
            engine.spawn(one)
        engine.advance(round(SECONDS / engine.step_seconds))
        return {one.entity: _seen(one.robot, engine.link_poses(one.entity)) for one in robots}


def _seen(robot: Robot, poses: dict[str, Pose]) -> dict[str, Any]:
    centers: dict[str, Vector] = {
        link.name: compose(
            poses[link.name], link.inertial.pose_in_link if link.inertial else IDENTITY
        ).xyz
        for link in robot.links
        if link.name in poses
    }
    return {"centers": centers, "up": rotation_of_rpy(poses[robot.root].rpy)[2]}


def assert_same_rest(mine: dict[str, Any], real: dict[str, Any]) -> None:
    assert mine["centers"].keys() == real["centers"].keys()
    for link, (x, y, z) in real["centers"].items():
        a, b, c = mine["centers"][link]
        assert c == pytest.approx(z, abs=SAME_HEIGHT), link
        assert math.hypot(a - x, b - y) < SAME_PLACE, link
    assert angle(mine["up"], real["up"]) < SAME_TILT


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("rest")
    files = RECORDED / "still_lifes.json", RECORDED / "rest_poses.json"
    robots = [name for *_, name in ROBOTS]
    return (
        recorded_in(files[0], request, STILL_LIFES, lambda name: ask_still_life(name, folder)),
        recorded_in(files[1], request, robots, lambda name: ask_robot(name, folder)),
    )


@NEEDS_CLASSIC
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    assert ask_still_life(name, tmp_path) == recorded[0][name]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", STILL_LIFES)
def test_rests_as_in_gazebo_classic(name: str, engine: str, recorded: Any, tmp_path: Path) -> None:
    file = tmp_path / "w.world"
    file.write_text(world_of(STILL_LIFES[name]), encoding="utf-8")
    found = read_sdf(file, find_model=lambda _: None)
    assert found.world is not None
    robots = [
        SpawnedRobot(entity=one.name, robot=one.robot, pose_in_world=one.pose_in_world)
        for one in found.models
        if one.robot is not None
    ]
    mine, real = simulated(engine, found.world, robots), recorded[0][name]
    assert mine.keys() == real.keys()
    for model in real:
        expect(name, engine, mine[model], real[model])


def test_most_robots_are_recorded(recorded: Any) -> None:
    assert len(recorded[1]) >= 50
    assert sum("up" in one for one in recorded[1].values()) >= 15


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", [name for *_, name in ROBOTS])
def test_a_robot_rests_as_in_gazebo_classic(
    name: str, engine: str, recorded: Any, *, thorough: bool
) -> None:
    is_other = DIFFERENT.get(name, ([], ""))[0] == ENGINES
    if (engine == "dart" or is_other) and not thorough:
        pytest.skip("with --thorough alone")
    real = recorded[1].get(name, {})
    if "up" not in real:
        pytest.skip("fixed, refused, or it ends up somewhere else with each start")
    robot, _ = robot_of(name)
    assert robot is not None
    pose = Pose((0.0, 0.0, as_low_as_it_can_stand(robot)))
    spawned = SpawnedRobot(entity="r", robot=robot, pose_in_world=pose)
    expect(name, engine, simulated(engine, WORLD, [spawned])["r"], real)


def expect(name: str, engine: str, mine: dict[str, Any], real: dict[str, Any]) -> None:
    if engine in DIFFERENT.get(name, ([], ""))[0]:
        with pytest.raises(AssertionError):
            assert_same_rest(mine, real)
    else:
        assert_same_rest(mine, real)
