"""A scene in a child process: pictures, warnings, crashes."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from simulation.movers import AT, drive, two_wheeled
from wsgen.diagnostics import Severity
from wsgen.isolation import parent
from wsgen.isolation.parent import Limits
from wsgen.isolation.result import Answered, Died
from wsgen.model.engines import ENGINES
from wsgen.model.robot import Collision, Cylinder, Inertial, Link, Mesh, Robot, Visual
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.simulation import run
from wsgen.simulation.run import run_simulation
from wsgen.simulation.scene import RUNNING, Scene, SpawnedRobot

pytestmark = pytest.mark.skipif(
    bool(run.missing_engines(["bullet"])), reason="PyBullet is not installed"
)

CYLINDER = Cylinder(radius=0.4, length=0.5)
HERE = Path(__file__).parent


def scene(robot: Robot, z: float = 0.25, picture: Path | None = None) -> Scene:
    return Scene(
        world=World(name="ground", has_ground_plane=True),
        robots=(SpawnedRobot(entity="e", robot=robot, pose_in_world=Pose((0.0, 0.0, z))),),
        picture=picture,
    )


def robot(geometry: Cylinder | Mesh = CYLINDER) -> Robot:
    link = Link(
        name="base",
        inertial=Inertial(mass=1.0, inertia=(0.06, 0.0, 0.0, 0.06, 0.0, 0.08)),
        collisions=(Collision(geometry=geometry),),
        visuals=(Visual(geometry=geometry, rgba=(0.0, 1.0, 0.0, 1.0)),),
    )
    return Robot(name="r", root="base", links=(link,))


@pytest.mark.slow
def test_a_simulation() -> None:
    outcome = run_simulation(scene(robot()))
    (robot_run,) = outcome.robot_runs
    assert outcome.diagnostics == ()
    assert robot_run.mass == 1.0
    assert robot_run.penetration == pytest.approx(0.0, abs=1e-9)
    assert outcome.picture is None
    assert outcome.seconds["simulate"] > 0


@pytest.mark.slow
def test_a_simulation_in_dart_gives_the_same() -> None:
    pytest.importorskip("dartpy")
    outcome = run_simulation(replace(scene(robot()), engine="dart"))
    (bullet,) = run_simulation(scene(robot())).robot_runs
    (robot_run,) = outcome.robot_runs
    assert outcome.diagnostics == ()
    assert (robot_run.mass, robot_run.links) == (bullet.mass, bullet.links)
    assert robot_run.rest_pose.xyz == pytest.approx(bullet.rest_pose.xyz, abs=0.002)


@pytest.mark.slow
def test_the_picture_shows_the_robot_on_the_ground(tmp_path: Path) -> None:
    file = tmp_path / "robot.png"
    outcome = run_simulation(scene(robot(), picture=file))
    assert outcome.picture == file
    assert outcome.picture_tile == 0.2
    with Image.open(file) as picture:
        assert picture.size == (960, 720)
        data = picture.convert("RGB").resize((96, 72)).tobytes()
    pixels = list(zip(data[::3], data[1::3], data[2::3], strict=True))
    green = [tint > 120 and max(red, blue) < 60 for red, tint, blue in pixels]
    light = [min(pixel) > 150 for pixel in pixels]
    assert 0.3 < sum(green) / len(green) < 0.6
    assert sum(light) / len(light) > 0.3
    assert green[36 * 96 + 48]  # in the middle
    assert not any(green[:96] + green[-96:])  # and not cut off


@pytest.mark.slow
def test_a_picture_that_cannot_be_written_is_no_reason_to_lose_the_simulation(
    tmp_path: Path,
) -> None:
    outcome = run_simulation(scene(robot(), picture=tmp_path / "none" / "robot.png"))
    assert len(outcome.robot_runs) == 1
    assert (outcome.picture, outcome.picture_tile) == (None, None)
    assert [(one.code, one.severity) for one in outcome.diagnostics] == [("SPN034", Severity.ERROR)]


@pytest.mark.slow
def test_the_world_has_a_picture_if_it_holds_more_than_the_robots(tmp_path: Path) -> None:
    pictures = {"picture": tmp_path / "robot.png", "world_picture": tmp_path / "world.png"}
    alone = replace(scene(robot()), **pictures)  # type: ignore[arg-type]
    outcome = run_simulation(alone)
    assert (outcome.picture, outcome.world_picture) == (alone.picture, None)
    wall = SpawnedRobot(
        entity="wall",
        robot=replace(robot(), is_static=True),
        pose_in_world=Pose((3.0, 0.0, 0.25)),
        is_static_model=True,
    )
    outcome = run_simulation(replace(alone, robots=(*alone.robots, wall)))
    assert outcome.diagnostics == ()
    assert (outcome.picture, outcome.world_picture) == (alone.picture, alone.world_picture)
    with Image.open(tmp_path / "world.png") as picture:
        assert picture.size == (480, 360)
    lost = replace(
        alone, world_picture=tmp_path / "none" / "world.png", robots=(*alone.robots, wall)
    )
    outcome = run_simulation(lost)
    assert (outcome.picture, outcome.world_picture) == (alone.picture, None)
    (found,) = outcome.diagnostics
    assert (found.code, found.severity) == ("SPN034", Severity.ERROR)
    assert "picture of the world" in found.message


@pytest.mark.slow
def test_a_robot_that_the_engine_refuses(tmp_path: Path) -> None:
    mesh = tmp_path / "part.glb"
    mesh.write_bytes(b"glTF")
    outcome = run_simulation(scene(robot(Mesh(uri="part.glb", path=str(mesh)))))
    assert outcome.robot_runs == ()
    assert outcome.diagnostics[0].code == "SPN032"
    assert outcome.diagnostics[0].severity is Severity.ERROR


@pytest.mark.slow
def test_a_mesh_that_crashes_the_engine(tmp_path: Path) -> None:
    """Face indices out of range end PyBullet with SIGSEGV."""
    mesh = tmp_path / "part.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\n")
    outcome = run_simulation(scene(robot(Mesh(uri="part.obj", path=str(mesh)))))
    assert outcome.robot_runs == ()
    (death,) = outcome.diagnostics
    assert death.code == "SPN031"
    assert death.element == "e"
    assert "SIGSEGV" in death.message
    assert "loading the robot `e`" in death.message


@pytest.mark.slow
def test_a_mesh_that_is_nothing_is_warned_about(tmp_path: Path) -> None:
    """PyBullet takes it for a shape without points, and says so."""
    mesh = tmp_path / "part.obj"
    mesh.write_text("no mesh\n")
    outcome = run_simulation(scene(robot(Mesh(uri="part.obj", path=str(mesh)))))
    assert [one.code for one in outcome.diagnostics] == ["SPN033"]
    assert "part.obj" in outcome.diagnostics[0].message


@pytest.mark.slow
def test_out_of_time() -> None:
    outcome = run_simulation(scene(robot()), limits=Limits(seconds=0.01, wall_clock=600))
    assert "(PyBullet) used more than 0.01 s of CPU time" in outcome.diagnostics[0].message


def test_a_slow_simulation_names_engine_robot_and_step() -> None:
    slow = Died(reason="used more than 1 s of CPU time", step="simulating 3 s", output="")
    found = run.explain_death(scene(robot()), replace(slow, cause="cpu time"))
    assert found.element == "e"
    assert "(PyBullet) used more than 1 s of CPU time while simulating 3 s." in found.message
    assert "fewer triangles" in (found.hint or "")
    found = run.explain_death(scene(robot()), replace(slow, cause="cpu time", step="loading"))
    assert "engine cannot handle" in (found.hint or "")


def test_more_triangles_than_an_engine_can_load_are_not_given_to_it() -> None:
    tree = robot(Mesh(uri="tree.stl", path="/tree.stl", triangles=124_002))
    one = scene(tree)
    (small,) = one.robots
    trees = tuple(replace(small, entity=f"tree{number}") for number in range(50))
    outcome = run_simulation(replace(one, robots=trees), run=_not_called)
    (found,) = outcome.diagnostics
    assert (found.code, outcome.robot_runs) == ("SPN110", ())
    assert "6,200,100 triangles" in found.message
    assert "`tree.stl` has 124,002 and is used 50 times" in found.message


def _not_called(*_: Any, **__: Any) -> Answered | Died:
    raise AssertionError("a child process was started")


def test_a_busy_machine_is_not_the_robots_fault() -> None:
    outcome = run_simulation(scene(robot()), limits=Limits(wall_clock=0.01))
    assert "did not end within 0.01 s" in outcome.diagnostics[0].message
    assert "less busy" in (outcome.diagnostics[0].hint or "")


def test_last_words_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ENGINES, "bullet", ENGINES["bullet"]._replace(tasks="abort_with_words"))
    monkeypatch.setattr(sys, "path", [*sys.path, str(HERE)])
    (death,) = run_simulation(scene(robot())).diagnostics
    assert "SIGABRT" in death.message
    assert "while going down" in death.message
    assert "farewell" in death.message


def test_warnings_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ENGINES, "bullet", ENGINES["bullet"]._replace(tasks="warn_with_words"))
    monkeypatch.setattr(sys, "path", [*sys.path, str(HERE)])
    (warning,) = run_simulation(scene(robot())).diagnostics
    assert (warning.code, warning.severity) == ("SPN033", Severity.WARNING)
    assert warning.message.endswith("warned: b3Warning: no")


@pytest.mark.slow
def test_warnings_are_reported_without_their_colors(tmp_path: Path) -> None:
    pytest.importorskip("dartpy")
    mesh = tmp_path / "part.obj"
    mesh.write_text("no mesh\n")
    broken = scene(robot(Mesh(uri="part.obj", path=str(mesh))))
    refused, warning = run_simulation(replace(broken, engine="dart")).diagnostics
    assert (refused.code, warning.code) == ("SPN032", "SPN033")
    assert "warned: Warning [" in warning.message
    assert "\x1b" not in warning.message


@pytest.mark.slow
def test_nothing_is_left_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    run_simulation(scene(robot()))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_behaviors_run_in_the_same_child() -> None:
    spawned = SpawnedRobot(entity="e", robot=two_wheeled(), pose_in_world=AT)
    played = replace(scene(robot()), robots=(spawned,), behavior_runs=(drive(linear=0.5),))
    outcome = run_simulation(played)
    (robot_run,) = outcome.robot_runs
    (behaved,) = robot_run.behaviors
    assert behaved.moved[0] == pytest.approx(1.0, abs=0.05)
    assert math.dist(robot_run.rest_pose.xyz[:2], AT.xyz[:2]) < 0.1  # of the standing


@pytest.mark.slow
def test_a_video_shows_behaviors(tmp_path: Path) -> None:
    spawned = SpawnedRobot(entity="e", robot=two_wheeled(), pose_in_world=AT)
    played = replace(
        scene(robot()), robots=(spawned,), behavior_runs=(drive(linear=0.5),), seconds=0.5
    )
    video = run_simulation(replace(played, record=tmp_path / "f.gif")).video
    assert video is not None
    assert video.frames > video.frames_per_second * 2.5


@pytest.mark.slow
def test_an_engine_that_dies_of_a_behavior_runs_the_others() -> None:
    behavior_runs = (drive(linear=0.5), drive(linear=0.7))
    played = replace(scene(robot()), behavior_runs=behavior_runs)
    seen: list[Scene] = []

    def dies(task: str, *arguments: Any, **more: Any) -> Answered | Died:
        (now,) = arguments
        seen.append(now)
        if behavior_runs[0] in now.behavior_runs:
            step = RUNNING.format(entity="e", name=behavior_runs[0].behavior.name)
            return Died(reason="crashed (SIGSEGV)", step=step, output="")
        return parent.run(task, replace(now, behavior_runs=()), **more)

    outcome = run_simulation(played, run=dies)
    assert [one.behavior_runs for one in seen] == [behavior_runs, behavior_runs[1:]]
    assert len(outcome.robot_runs) == 1
    (found,) = outcome.diagnostics
    assert (found.code, found.element) == ("SPN031", "e")
    assert "while running the behavior `d{'linear': 0.5}` of `e`" in found.message
