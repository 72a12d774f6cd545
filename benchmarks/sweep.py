"""Measure `wsgen sweep` against PyBullet by hand, with one job, with two, and with Dask.

    python -m benchmarks.sweep [RUNS]

The rover of `wsgen new -t diff_drive`, 3 s in steps of 1 ms, its friction varied. By hand is one
process (`sweep_by_hand.py`): with the settings that make PyBullet move the robot as Gazebo does,
and as PyBullet has it. CPU time is that of all processes. What a sweep of two runs takes, mostly to
start and to read the robot, is subtracted; the rest is that of the runs.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.packages.workspace.layout import workspace_around
from wsgen.pipeline.run_robots import spawned_robots
from wsgen.simulation.bullet import BulletEngine
from wsgen.simulation.bullet_body import HIGHEST_JOINT_SPEED
from wsgen.simulation.scene import Scene
from wsgen.simulation.simulate import spawn_robots
from wsgen.simulation.urdf_writer import write_urdf
from wsgen.sweeping.robot_subjects import open_subject
from wsgen.sweeping.subject import SubjectRequest

if TYPE_CHECKING:
    from collections.abc import Sequence


WSGEN = str(Path(sys.executable).with_name("wsgen"))
BY_HAND = str(Path(__file__).with_name("sweep_by_hand.py"))
BRAKE = 10.0  # N m, of the plugin that keeps the wheels still
FEW = 2  # runs, to measure what is no run
RUNS = 200
MOST_CPU = 1.2  # of by hand
LEAST_SPEED_UP = 1.8  # of two jobs
MOST_WITH_DASK = 1.1  # of the wall-clock time with jobs


class Cost(NamedTuple):
    """Of one run, s."""

    cpu: float
    wall: float


def measure(command: Sequence[str], folder: Path) -> Cost:
    """What a command takes, with all that it starts."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(
        command, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    after, ended = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Cost(cpu, ended - began)


def by_hand(file: Path, settings: Path | None, runs: int) -> list[str]:
    """The command that steps PyBullet by hand."""
    return [sys.executable, BY_HAND, str(file), str(runs), *([str(settings)] if settings else [])]


def sweep(*arguments: str | int) -> list[str]:
    """The command that sweeps the rover: its options, then how many runs."""
    *given, runs = arguments
    options = list(map(str, given))
    over = f"world.friction=0.5:0.9:{runs}"
    out = f"{''.join(options)}-{runs}.csv"
    return [WSGEN, "sweep", "src/rover/model/robot.xacro", "--over", over, "--out", out, *options]


def write_settings(folder: Path) -> tuple[Path, Path]:
    """The rover as wsgen gives it to PyBullet: its URDF, and what it tells PyBullet beyond that."""
    request = SubjectRequest(
        file=folder / "src/rover/model/robot.xacro", workspace=workspace_around(folder / "src")
    )
    with open_subject(request, environment=os.environ) as subject:
        blueprint = subject.prepare({})
    assert blueprint.world is not None  # noqa: S101  the rover can be simulated
    scene = Scene(world=blueprint.world, robots=spawned_robots(blueprint.prepared))
    engine = BulletEngine(scene.world)
    ((robot, _, pose),), _ = spawn_robots(engine, scene, lambda _: None)
    ((body, _),) = engine._bodies[robot.entity]  # noqa: SLF001  what is told to PyBullet
    client = engine.client
    links = {}
    for link in body._index_of.values():  # noqa: SLF001
        info = client.getDynamicsInfo(body.number, link)
        links[link] = {"lateralFriction": info[1], "rollingFriction": info[6]}
    links[-1] |= {
        "linearDamping": 0.0,
        "angularDamping": 0.0,
        "maxJointVelocity": HIGHEST_JOINT_SPEED,
    }
    pairs = () if robot.drive is None else robot.drive.pairs
    settings = {
        "engine": {"deterministicOverlappingPairs": 1},
        "flags": client.URDF_USE_INERTIA_FROM_FILE
        | client.URDF_USE_IMPLICIT_CYLINDER
        | client.URDF_INITIALIZE_SAT_FEATURES,
        "position": list(pose.xyz),
        "links": links,
        "forces": {body.movable[name]: BRAKE for pair in pairs for name in (pair.left, pair.right)},
    }
    file, written = folder / "lumped.urdf", folder / "settings.json"
    file.write_text(write_urdf(body._parts))  # noqa: SLF001  with one friction in each link
    written.write_text(json.dumps(settings))
    return file, written


def measure_run(few: Sequence[str], many: Sequence[str], runs: int, folder: Path) -> Cost:
    """What one run takes, of a command with few runs and of the same with many."""
    start, whole = measure(few, folder), measure(many, folder)
    count = runs - FEW
    return Cost((whole.cpu - start.cpu) / count, (whole.wall - start.wall) / count)


def main() -> None:
    """Measure, and print a table."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else RUNS
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = [WSGEN, "new", "rover", "-t", "diff_drive", "-w", name, "--maintainer-name", "A"]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        file, settings = write_settings(folder)
        costs = {
            what: measure_run(command_of(FEW), command_of(runs), runs, folder)
            for what, command_of in (
                ("PyBullet by hand, moving as in Gazebo", partial(by_hand, file, settings)),
                ("PyBullet by hand, as it is", partial(by_hand, file, None)),
                ("wsgen sweep -j 1", partial(sweep, "-j1")),
                ("wsgen sweep -j 2", partial(sweep, "-j2")),
                ("the same with --scheduler local", partial(sweep, "-j2", "--scheduler=local")),
            )
        }
    print("| one run | CPU ms | wall-clock ms |\n|---|---|---|")
    for what, cost in costs.items():
        print(f"| {what} | {1000 * cost.cpu:.0f} | {1000 * cost.wall:.0f} |")
    hand, _, one, two, dask = costs.values()
    print(f"CPU of -j 1 against by hand: {one.cpu / hand.cpu:.2f} (at most {MOST_CPU})")
    print(f"-j 2 is {one.wall / two.wall:.2f} times as fast as -j 1 (at least {LEAST_SPEED_UP})")
    print(f"Dask against -j 2: {dask.wall / two.wall:.2f} (at most {MOST_WITH_DASK})")


if __name__ == "__main__":
    main()
