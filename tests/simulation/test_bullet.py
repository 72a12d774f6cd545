"""The PyBullet engine: the same robot as the description, at rest where Gazebo's would be."""

from __future__ import annotations

import math
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from wsgen.model.pose import Pose
from wsgen.model.robot import (
    Box,
    Collision,
    Cylinder,
    Geometry,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Robot,
    Sphere,
    Surface,
    Visual,
)
from wsgen.model.world import World
from wsgen.simulation.bullet import MOST_LINKS, SEPARATION_SPEED, BulletEngine
from wsgen.simulation.engine import Loaded, Refused
from wsgen.simulation.scene import RobotTrial, Scene, SpawnedRobot
from wsgen.simulation.trial import play

if TYPE_CHECKING:
    from pathlib import Path

GROUND = World(name="ground", has_ground_plane=True)
CYLINDER = Cylinder(radius=0.4, length=0.5)


def body(
    geometry: Geometry | None,
    *,
    name: str = "base",
    moment: float = 0.06,
    at: Pose = Pose(),  # noqa: B008  frozen
    mu: float = 1.0,
) -> Link:
    return Link(
        name=name,
        inertial=Inertial(
            mass=1.0, pose_in_link=at, inertia=(moment, 0.0, 0.0, moment, 0.0, moment)
        ),
        collisions=()
        if geometry is None
        else (Collision(geometry=geometry, pose_in_link=at, surface=Surface(mu1=mu)),),
        visuals=()
        if geometry is None
        else (Visual(geometry=geometry, pose_in_link=at, rgba=(0.0, 1.0, 0.0, 1.0)),),
    )


def single(link: Link) -> Robot:
    return Robot(name="r", root=link.name, links=(link,))


def pendulum(kind: JointType = JointType.CONTINUOUS, **more: object) -> Robot:
    """A bar that hangs on the world, held out sideways."""
    swing = Joint(
        name="swing",
        type=kind,
        parent="world",
        child="bar",
        pose_in_parent=Pose((0.0, 0.0, 2.0)),
        axis_in_joint=(0.0, 1.0, 0.0),
        limit=JointLimit(lower=-3.0, upper=3.0, effort=100.0, velocity=100.0),
    )
    bar = body(Box(size=(1.0, 0.1, 0.1)), name="bar", at=Pose((0.5, 0.0, 0.0)))
    return Robot(
        name="r",
        root="world",
        links=(Link(name="world"), bar),
        joints=(replace(swing, **more),),  # type: ignore[arg-type]
        fixed_to_world=True,
    )


def trial_of(robot: Robot, z: float, *, world: World = GROUND, seconds: float = 3.0) -> RobotTrial:
    scene = Scene(
        world=world,
        robots=(SpawnedRobot(entity="e", robot=robot, pose_in_world=Pose((0.0, 0.0, z))),),
        seconds=seconds,
    )
    with closing(BulletEngine(world)) as engine:
        (trial,), _ = play(engine, scene, lambda _: None)
    return trial


@pytest.mark.parametrize("moment", [0.06, 100.0])
@pytest.mark.parametrize("z", [0.0, 0.25, 0.255, 0.5])
def test_the_cylinder_of_the_tutorial_comes_to_rest(z: float, moment: float) -> None:
    trial = trial_of(single(body(CYLINDER, moment=moment, mu=0.2)), z)
    assert (trial.links, trial.movable_joints, trial.mass) == (1, 0, 1.0)
    assert trial.rest_pose.xyz[2] == pytest.approx(0.25, abs=0.0005)
    assert trial.tilt < math.radians(0.1)
    assert trial.settled_after is not None


@pytest.mark.parametrize("z", [0.0, -0.1, 0.2])
def test_half_sunk_is_pushed_out_without_a_jump(z: float) -> None:
    trial = trial_of(single(body(CYLINDER, moment=100.0)), z)
    assert trial.penetration == pytest.approx(0.25 - z, abs=1e-6)
    assert trial.highest_speed < 1.2 * SEPARATION_SPEED
    assert trial.highest_point < 0.26
    assert trial.lowest_point_at_end == pytest.approx(0.0, abs=0.001)


def test_deep_sunk_does_not_get_out_and_is_seen() -> None:
    trial = trial_of(single(body(CYLINDER)), -1.5)
    assert trial.penetration == pytest.approx(1.75, abs=1e-6)
    assert trial.lowest_point_at_end < -0.5
    assert trial.settled_after is None
    assert trial.is_finite


@pytest.mark.parametrize(
    ("geometry", "height"),
    [(Sphere(radius=0.2), 0.2), (Box(size=(0.2, 0.3, 0.4)), 0.2), (CYLINDER, 0.25)],
)
def test_shapes_rest_on_their_surface(geometry: Geometry, height: float) -> None:
    assert trial_of(single(body(geometry)), 0.5).rest_pose.xyz[2] == pytest.approx(
        height, abs=0.001
    )


def test_the_pose_is_that_of_the_link_not_of_its_centre_of_mass() -> None:
    """A box whose link frame lies in its bottom, with turned principal axes."""
    link = body(Box(size=(1.0, 1.0, 0.2)), at=Pose((0.2, 0.1, 0.1), (0.0, 0.0, 0.5)))
    trial = trial_of(single(link), 0.1)
    assert trial.rest_pose.xyz == pytest.approx((0.0, 0.0, 0.0), abs=0.001)
    assert trial.rest_pose.rpy == pytest.approx((0.0, 0.0, 0.0), abs=0.001)


def test_falls_without_ground() -> None:
    trial = trial_of(single(body(CYLINDER)), 1.0, world=World(name="void"), seconds=1.0)
    assert trial.rest_pose.xyz[2] == pytest.approx(1.0 - 4.9, abs=0.01)
    assert trial.settled_after is None
    assert trial.penetration == 0.0


def test_falls_without_collision() -> None:
    trial = trial_of(single(body(None)), 1.0, seconds=1.0)
    assert trial.rest_pose.xyz[2] < -3.0
    assert trial.lowest_point == 1.0


def test_gravity_and_step_of_the_world() -> None:
    moon = World(name="moon", gravity=(0.0, 0.0, -1.6), step=0.004)
    trial = trial_of(single(body(CYLINDER)), 10.0, world=moon, seconds=1.0)
    assert trial.speed == pytest.approx(1.6, abs=0.01)


def test_friction_is_that_of_the_link() -> None:
    """On ground tilted by 20 degrees (gravity is), 0.2 slides and 0.9 holds."""
    slope = math.radians(20)
    world = World(
        name="slope",
        gravity=(9.8 * math.sin(slope), 0.0, -9.8 * math.cos(slope)),
        has_ground_plane=True,
    )
    flat = Box(size=(0.4, 0.4, 0.1))
    slides = trial_of(single(body(flat, mu=0.2)), 0.05, world=world, seconds=1.0)
    holds = trial_of(single(body(flat, mu=0.9)), 0.05, world=world, seconds=1.0)
    acceleration = 9.8 * (math.sin(slope) - 0.2 * math.cos(slope))
    assert slides.speed == pytest.approx(acceleration, rel=0.05)
    assert holds.speed < 0.01


def test_joints_are_passive_and_the_world_holds() -> None:
    trial = trial_of(pendulum(), 0.0, world=World(name="void"), seconds=0.5)
    assert (trial.links, trial.movable_joints, trial.mass) == (1, 1, 1.0)
    assert trial.rest_pose.xyz == (0.0, 0.0, 0.0)
    assert trial.joint_speed > 3.0


def test_friction_and_limits_of_joints_hold() -> None:
    stuck = trial_of(pendulum(friction=50.0), 0.0, world=World(name="void"))
    assert stuck.joint_speed < 0.01
    held = pendulum(JointType.REVOLUTE, limit=JointLimit(lower=0.0, upper=0.0, effort=1.0))
    assert trial_of(held, 0.0, world=World(name="void")).joint_speed < 0.05


def test_same_scene_same_trial() -> None:
    robot = single(body(CYLINDER))
    assert trial_of(robot, 0.1) == trial_of(robot, 0.1)


def test_two_robots_at_once() -> None:
    scene = Scene(
        world=GROUND,
        robots=tuple(
            SpawnedRobot(
                entity=name, robot=single(body(geometry)), pose_in_world=Pose((x, 0.0, 0.3))
            )
            for name, x, geometry in (("a", 0.0, CYLINDER), ("b", 3.0, Sphere(radius=0.1)))
        ),
    )
    with closing(BulletEngine(GROUND)) as engine:
        trials, _ = play(engine, scene, lambda _: None)
    assert [trial.entity for trial in trials] == ["a", "b"]
    assert [trial.rest_pose.xyz[2] for trial in trials] == pytest.approx([0.25, 0.1], abs=0.001)


def spawn(robot: Robot) -> Loaded | Refused:
    with closing(BulletEngine(GROUND)) as engine:
        return engine.spawn(SpawnedRobot(entity="e", robot=robot))


def test_more_links_than_the_engine_can_do() -> None:
    links = tuple(body(None, name=f"l{index}") for index in range(MOST_LINKS + 1))
    refused = spawn(Robot(name="r", root="l0", links=links))
    assert isinstance(refused, Refused)
    assert "129 links" in refused.reason


def test_nothing_is_left_of_the_robot() -> None:
    assert isinstance(spawn(Robot(name="r", root="a", links=())), Refused)


def test_mesh_that_the_engine_cannot_read(tmp_path: Path) -> None:
    mesh = tmp_path / "part.glb"
    mesh.write_bytes(b"glTF")
    refused = spawn(single(body(Mesh(uri="part.glb", path=str(mesh)))))
    assert isinstance(refused, Refused)


def test_mesh_that_was_not_found_does_not_stop_the_rest() -> None:
    assert spawn(single(body(Mesh(uri="package://p/m.stl")))) == Loaded(1, 0, 1.0)


def test_mesh_is_stood_on(tmp_path: Path) -> None:
    mesh = tmp_path / "cube.obj"
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    mesh.write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"f {face}\n" for face in faces)
    )
    geometry = Mesh(uri="cube.obj", path=str(mesh), scale=(0.1, 0.1, 0.2))
    assert trial_of(single(body(geometry)), 0.3).rest_pose.xyz[2] == pytest.approx(0.2, abs=0.002)


def test_names_with_markup() -> None:
    assert spawn(single(body(CYLINDER, name='a<b>&"c'))) == Loaded(1, 0, 1.0)
