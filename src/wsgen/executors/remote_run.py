"""Simulations of `wsgen validate` by workers of Dask; all else runs on this machine."""

from __future__ import annotations

import base64
import threading
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.executors.child import ChildDiedError
from wsgen.executors.shared import share
from wsgen.files import write_file
from wsgen.isolation.child import scratch_folder
from wsgen.isolation.in_process import run_here
from wsgen.isolation.parent import Answered, Died, Limits
from wsgen.isolation.result import DEFAULT_LIMITS
from wsgen.model.robot import Mesh
from wsgen.simulation.run import TASKS
from wsgen.simulation.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.executors.dask_cluster import DaskExecutor
    from wsgen.isolation.parent import Run


DRAWN = ("picture", "world_picture", "record")  # fields of a scene: files that are drawn


class RemoteRun:
    """What `wsgen.isolation.parent.run` is, with the simulations on a cluster.

    Threads may share it; so many as `jobs` run something on this machine at a time.
    """

    def __init__(self, executor: DaskExecutor, run: Run, jobs: int) -> None:
        self._executor = executor
        self._run = run
        self._slots = threading.BoundedSemaphore(jobs)

    def __call__(
        self,
        task: str,
        *arguments: object,
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call `module:function` with the arguments in a child process, here or there.

        Raises:
            NotReadableError: The connection to the cluster is lost, or a file cannot be read.
        """
        if task not in TASKS.values():
            with self._slots:
                return self._run(
                    task, *arguments, limits=limits, environment=environment, folder=folder
                )
        (scene,) = arguments
        assert isinstance(scene, Scene)  # noqa: S101  simulations have nothing else
        shared = share(scene, _files(scene))
        try:
            answer = self._executor.submit(
                simulate, task, shared, limits=limits, attempts=1
            ).result()
        except ChildDiedError as error:
            return error.death
        for name, content in answer["drawn"].items():
            write_file(getattr(scene, name), base64.b64decode(content))
        death = answer["died"]
        if death is not None:
            return Died(**death)
        return Answered(value=answer["value"], output=answer["output"])


def simulate(task: str, scene: Scene) -> dict[str, Any]:
    """On a worker, in a child: simulate, and answer with the files that are drawn."""
    folder = scratch_folder() or Path()
    wanted = {name: path for name in DRAWN if (path := getattr(scene, name)) is not None}
    places = {name: folder / f"{name}{path.suffix}" for name, path in wanted.items()}
    outcome = run_here(
        task,
        replace(
            scene,
            picture=places.get("picture"),
            world_picture=places.get("world_picture"),
            record=places.get("record"),
            progress=None,
        ),
    )
    drawn = {}
    for name, place in places.items():
        if place.is_file():
            drawn[name] = base64.b64encode(place.read_bytes()).decode()
            place.unlink()
    if isinstance(outcome, Died):
        death = {name: getattr(outcome, name) for name in ("reason", "step", "output", "cause")}
        return {"died": death, "drawn": drawn}
    result = outcome.value
    if getattr(result.video, "file", None) is not None:
        result = replace(result, video=replace(result.video, file=scene.record))
    return {"died": None, "drawn": drawn, "value": result, "output": outcome.output}


def _files(scene: Scene) -> Iterator[str]:
    """The files that engines and, where something is drawn, renderers read."""
    is_drawn = scene.view_triangles or any(getattr(scene, name) for name in DRAWN)
    for robot in scene.robots:
        for link in robot.robot.links:
            shapes = [shape.geometry for shape in link.collisions]
            if is_drawn:
                shapes += [visual.geometry for visual in link.visuals]
                yield from (one.texture for one in link.visuals if one.texture is not None)
            for shape in shapes:
                if isinstance(shape, Mesh) and shape.path is not None:
                    yield shape.path
