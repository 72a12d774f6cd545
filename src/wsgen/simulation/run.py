"""Play a scene in a child process, whatever the engine does to it."""

from __future__ import annotations

import re
import time
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.outcome import DEFAULT_LIMITS, Died
from wsgen.simulation.scene import (
    DRAWING,
    LOADING,
    RECORDING,
    TRYING,
    SimulationOutcome,
    Video,
    robot_run_from_json,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.isolation.outcome import Limits
    from wsgen.isolation.parent import Run
    from wsgen.simulation.scene import Scene


TASK = "wsgen.tasks.{engine}:simulate"
MODULES = {"bullet": "pybullet", "dart": "dartpy"}
MANY_TRIANGLES = 20_000  # with fewer, a frame's time goes into its pixels
LAST_WORDS = 600  # characters of a dead engine's output that are told
COLORS = re.compile(r"\x1b\[[0-9;]*m")  # DART's warnings are yellow
GREETINGS = ("pybullet build time",)  # what PyBullet prints when all is well


def missing_engines(engines: Iterable[str]) -> list[str]:
    """Which of these engines are not installed."""
    return [name for name in engines if find_spec(MODULES[name]) is None]


def default_engine() -> str:
    """PyBullet, or DART where Python has no wheels of PyBullet."""
    return "dart" if missing_engines(["bullet"]) else "bullet"


def run_simulation(
    scene: Scene, *, limits: Limits = DEFAULT_LIMITS, run: Run = parent.run
) -> SimulationOutcome:
    """Simulate the scene; the engine's crash, hang or complaint becomes a diagnostic.

    `run` starts the child process.
    """
    started = time.perf_counter()
    outcome = run(TASK.format(engine=scene.engine), scene, limits=limits)
    seconds = time.perf_counter() - started
    if isinstance(outcome, Died):
        found, rest = _blame(scene, outcome)
        if rest is None:
            return SimulationOutcome(diagnostics=(found,), seconds={"simulate": seconds})
        again = run_simulation(rest, limits=limits, run=run)
        return replace(again, diagnostics=(found, *again.diagnostics))
    answer = outcome.value
    measured = answer["seconds"]
    video = _video(scene, answer)
    return SimulationOutcome(
        robot_runs=tuple(robot_run_from_json(robot_run) for robot_run in answer["robot_runs"]),
        diagnostics=(
            *_refusals(answer),
            *_complaints(scene, outcome.output),
            *_undrawn(answer),
            *_coarse(video),
        ),
        picture=scene.picture if "picture_tile" in answer else None,
        picture_tile=answer.get("picture_tile"),
        world_picture=scene.world_picture if "world_picture_tile" in answer else None,
        video=video,
        # Starting the child and the engine is what is left of the whole.
        seconds={**measured, "load": seconds - sum(measured.values())},
    )


def _blame(scene: Scene, death: Died) -> tuple[Diagnostic, Scene | None]:
    """What the engine died of, and the scene without it; None where that is not known."""
    if death.step == DRAWING:
        found = _no_picture("picture", f"the engine {death.reason} while it drew it")
        return found, replace(scene, picture=None, world_picture=None)
    if death.step.startswith(RECORDING):
        found = _no_video(f"the engine {death.reason} while it was {death.step}")
        return found, replace(scene, record=None)
    for behavior_run in scene.behavior_runs:
        if death.step == TRYING.format(entity=behavior_run.entity, name=behavior_run.behavior.name):
            others = tuple(other for other in scene.behavior_runs if other is not behavior_run)
            (robot,) = (one for one in scene.robots if one.entity == behavior_run.entity)
            return _death(replace(scene, robots=(robot,)), death), replace(
                scene, behavior_runs=others
            )
    for robot in scene.robots:
        if death.step == LOADING.format(entity=robot.entity):
            found = _death(replace(scene, robots=(robot,)), death)
            return found, _without(scene, robot.entity)
    return _death(scene, death), None


def _without(scene: Scene, entity: str) -> Scene | None:
    robots = tuple(robot for robot in scene.robots if robot.entity != entity)
    behavior_runs = tuple(
        behavior_run for behavior_run in scene.behavior_runs if behavior_run.entity != entity
    )
    return replace(scene, robots=robots, behavior_runs=behavior_runs) if robots else None


def _death(scene: Scene, death: Died) -> Diagnostic:
    words = _without_greetings(death.output)[-LAST_WORDS:]
    said = f" Its last words: {words}" if words else ""
    return Diagnostic(
        code="SPN031",
        severity=Severity.ERROR,
        message=f"The physics engine {death.reason} while {death.step or 'it was starting'}.{said}",
        element=_entities(scene),
        hint=death.hint(
            "Something in the description is too much for the engine: look at collision meshes, "
            "sizes and masses first, and leave links out until it runs."
        ),
    )


def _refusals(answer: dict[str, Any]) -> Iterator[Diagnostic]:
    for entity, (reason, hint) in answer["refused"].items():
        yield Diagnostic(
            code="SPN032",
            severity=Severity.ERROR,
            message=f"The physics engine does not simulate `{entity}`: {reason}.",
            element=entity,
            hint=hint,
        )


def _undrawn(answer: dict[str, Any]) -> Iterator[Diagnostic]:
    """What was asked for and is not there: as much an error as a robot that fails."""
    for kind, what in (("picture", "picture"), ("world_picture", "picture of the world")):
        problem = answer.get(f"{kind}_problem")
        if problem is not None:
            yield _no_picture(what, problem)
    if answer.get("film_problem") is not None:
        yield _no_video(answer["film_problem"])


def _no_picture(what: str, problem: str) -> Diagnostic:
    return Diagnostic(
        code="SPN034",
        severity=Severity.ERROR,
        message=f"Cannot draw the {what}: {problem}.",
        hint="Check the visual meshes and that the directory is writable, or leave --picture out: "
        "the simulation itself is not affected.",
    )


def _no_video(problem: str) -> Diagnostic:
    return Diagnostic(
        code="SPN070",
        severity=Severity.ERROR,
        message=f"Cannot record a video: {problem}.",
        hint="Name a .gif in a writable directory, or leave --record out: the simulation itself is "
        "not affected.",
    )


def _video(scene: Scene, answer: dict[str, Any]) -> Video | None:
    return (
        Video(file=scene.record, **answer["video"]) if scene.record and "video" in answer else None
    )


def _coarse(video: Video | None) -> Iterator[Diagnostic]:
    """Say so if there is so much to draw that the video has less than others."""
    if video is not None and video.is_coarse:
        yield Diagnostic(
            code="SPN071",
            severity=Severity.INFO,
            message=f"The video has {video.frames_per_second:.3g} frames/s of {video.width} "
            f"by {video.height} pixels, to be drawn in time: {video.frames} frames of "
            f"{video.triangles:,} triangles.",
            hint="Reduce the visual meshes."
            if video.triangles > MANY_TRIANGLES
            else "Record fewer simulated seconds, in --seconds or in the behaviors.",
        )


def _complaints(scene: Scene, output: str) -> Iterator[Diagnostic]:
    words = _without_greetings(output)
    if words:
        yield Diagnostic(
            code="SPN033",
            severity=Severity.WARNING,
            message=f"The physics engine complained: {words[:LAST_WORDS]}",
            element=_entities(scene),
            hint="The simulation went on; what the engine names may be missing from it.",
        )


def _without_greetings(output: str) -> str:
    lines = (line.strip() for line in COLORS.sub("", output).splitlines())
    return "\n".join(line for line in lines if line and not line.startswith(GREETINGS))


def _entities(scene: Scene) -> str:
    return ", ".join(robot.entity for robot in scene.robots)
