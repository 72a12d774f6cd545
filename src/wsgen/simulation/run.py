"""Simulates a scene in a child process, whatever the engine does to it; which engines there are."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.errors import NotFoundError
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import DEFAULT_LIMITS, Died, find_missing_library
from wsgen.model.engines import ENGINES, name_engines
from wsgen.model.robot import Mesh
from wsgen.simulation.scene import (
    DRAWING,
    LOADING,
    RECORDING,
    RUNNING,
    NotDrawn,
    Picture,
    SceneResult,
    SimulationOutcome,
    Video,
)
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.isolation.result import Limits
    from wsgen.simulation.scene import Scene


ENGINE_DIED = Rule(
    code="SPN031",
    name="engine-died",
    severity=Severity.ERROR,
    summary="The physics engine, or Gazebo itself, crashed, hung or ran out of memory.",
    what="Simulates in a separate process with limited CPU time and memory. The other robots are "
    "simulated again without the one that crashed the engine; not in `--engine gazebo`.",
    why=("The robot has no result, and it may crash Gazebo, too."),
    example="A mesh file with faces that refer to missing vertices.",
    instead="The same mesh, exported again; or a <box> in its place until it loads.",
)

TOO_MANY_TRIANGLES = Rule(
    code="SPN110",
    name="too-many-triangles",
    severity=Severity.ERROR,
    summary="The collision meshes of all models together are too large to simulate.",
    what="Adds up the triangles of the collision meshes of all models, and does not simulate more "
    "than 6,000,000. MuJoCo does not have this limit: it loads only triangles near the robots.",
    why="PyBullet and DART load a mesh for each model that uses it, and need 400 bytes per "
    "triangle: gigabytes for a forest of a hundred detailed trees.",
    example="A world with 100 models of a tree whose <collision> has 120,000 triangles.",
    instead="The same world, with a <cylinder> as the <collision> of each tree.",
)

ENGINE_REFUSED = Rule(
    code="SPN032",
    name="engine-refused",
    severity=Severity.ERROR,
    summary="The physics engine, or Gazebo itself, does not load the robot.",
    why="The robot is not simulated; the message names the reason.",
    example="A robot of more than 128 links, where PyBullet is the only engine.",
    instead="pip install 'wsgen[mujoco]'",
)

ENGINE_WARNING = Rule(
    code="SPN033",
    name="engine-warning",
    severity=Severity.WARNING,
    severity_varies="information for a plugin that is not installed, with `--engine gazebo`",
    summary="The physics engine, or Gazebo itself, printed a warning.",
    why="Engines continue without a part that they cannot use, and only print a warning: a mesh "
    "without points, for example, has no contacts.",
    example="A collision mesh without faces.",
    instead="A mesh with the parts that the engine reports as missing.",
)

NO_PICTURE = Rule(
    code="SPN034",
    name="no-picture",
    severity=Severity.ERROR,
    summary="A picture cannot be drawn or written.",
    what="The simulation itself is not affected.",
    why="The requested file is missing.",
    example="A visual mesh on which the renderer crashes.",
    instead="The same mesh, exported again.",
)

NO_VIDEO = Rule(
    code="SPN070",
    name="no-video",
    severity=Severity.ERROR,
    summary="A video cannot be recorded or written.",
    what="The simulation itself is not affected.",
    why="The requested file is missing.",
    example="A visual mesh on which the renderer crashes.",
    instead="The same mesh, exported again.",
)

COARSE_VIDEO = Rule(
    code="SPN071",
    name="coarse-video",
    severity=Severity.INFO,
    summary="A video has a lower resolution or frame rate than usual.",
    what="Reports a video for which drawing all frames would take more than about 16 s of CPU "
    "time.",
    why="Fast motion and small parts are hard to see in such a video.",
    example="wsgen validate my_robot --record robot.gif --seconds 60",
    instead="wsgen validate my_robot --record robot.gif --seconds 5",
)

MOST_TRIANGLES = 6_000_000  # of all collisions; they take 3 GB in PyBullet, with a picture
LARGEST_MESHES = 3  # are named
MANY_TRIANGLES = 20_000  # with fewer, a frame's time goes into its pixels
LAST_OUTPUT = 600  # characters of an engine's output that are reported
COLORS = lazy_pattern(r"\x1b\[[0-9;]*m")  # DART's warnings are yellow
GREETINGS = ("pybullet build time",)  # what PyBullet prints when all is well


def missing_engines(engines: Iterable[str]) -> list[str]:
    """Which of these engines are not installed."""
    return [name for name in engines if find_spec(ENGINES[name].library) is None]


def installed_engines() -> list[str]:
    """Which engines are installed, in the order of preference."""
    return [name for name in ENGINES if not missing_engines([name])]


def default_engine() -> str:
    """PyBullet, or MuJoCo where Python has no wheels of PyBullet, or else DART."""
    return next(iter(installed_engines()), "mujoco")


def run_simulation(
    scene: Scene, *, limits: Limits = DEFAULT_LIMITS, run: Run = parent.run
) -> SimulationOutcome:
    """Simulate the scene; the engine's crash, hang or warning becomes a diagnostic.

    `run` starts the child process.
    """
    too_large = _too_many_triangles(scene)
    if too_large is not None:
        return SimulationOutcome(diagnostics=(too_large,))
    started = time.perf_counter()
    outcome = run(f"{ENGINES[scene.engine].tasks}:simulate", scene, limits=limits)
    seconds = time.perf_counter() - started
    if isinstance(outcome, Died):
        found, rest = _blame(scene, outcome)
        if rest is None:
            return SimulationOutcome(diagnostics=(found,), seconds={"simulate": seconds})
        again = run_simulation(rest, limits=limits, run=run)
        return replace(again, diagnostics=(found, *again.diagnostics))
    result = decode(outcome.value, SceneResult)
    picture, world_picture, video = result.picture, result.world_picture, result.video
    return SimulationOutcome(
        robot_runs=result.robot_runs,
        diagnostics=(
            *_refusals(result),
            *_warnings(scene, outcome.output),
            *_undrawn(result),
            *_coarse(result),
        ),
        picture=scene.picture if isinstance(picture, Picture) else None,
        picture_tile=picture.tile if isinstance(picture, Picture) else None,
        world_picture=scene.world_picture if isinstance(world_picture, Picture) else None,
        video=video if isinstance(video, Video) else None,
        view=result.view,
        # Starting the child and the engine is what is left of the whole.
        seconds={**result.seconds, "load": seconds - sum(result.seconds.values())},
    )


def _too_many_triangles(scene: Scene) -> Diagnostic | None:
    """Name the meshes of a scene that has more of them than an engine can load."""
    uses = Counter(
        (collision.geometry.uri, collision.geometry.triangles or 0)
        for robot in scene.robots
        for link in robot.robot.links
        for collision in link.collisions
        if isinstance(collision.geometry, Mesh) and collision.geometry.path is not None
    )
    total = sum(times * triangles for (_, triangles), times in uses.items())
    if total <= MOST_TRIANGLES or scene.engine == "mujoco":
        return None
    largest = sorted(uses, key=lambda mesh: -uses[mesh] * mesh[1])[:LARGEST_MESHES]
    named = "; ".join(
        f"`{uri}` has {triangles:,}"
        + (f" and is used {uses[uri, triangles]} times" if uses[uri, triangles] > 1 else "")
        for uri, triangles in largest
    )
    return TOO_MANY_TRIANGLES.at(
        None,
        message=f"The collision meshes of all models have {total:,} triangles, more than the limit "
        f"of {MOST_TRIANGLES:,} for {ENGINES[scene.engine].title}: {named}.",
        hint="Use boxes or cylinders for these collisions, or meshes of some hundred triangles.",
    )


def _blame(scene: Scene, death: Died) -> tuple[Diagnostic, Scene | None]:
    """What the engine died of, and the scene without it; None where that is not known."""
    if death.step == DRAWING:
        found = _no_picture("picture", f"the engine {death.reason} while it drew it")
        return found, replace(scene, picture=None, world_picture=None, view_triangles=0)
    if death.step.startswith(RECORDING):
        found = no_video(f"the engine {death.reason} while it was {death.step}")
        return found, replace(scene, record=None)
    for behavior_run in scene.behavior_runs:
        name = behavior_run.behavior.name
        if death.step == RUNNING.format(entity=behavior_run.entity, name=name):
            others = tuple(other for other in scene.behavior_runs if other is not behavior_run)
            (robot,) = (one for one in scene.robots if one.entity == behavior_run.entity)
            return explain_death(replace(scene, robots=(robot,)), death), replace(
                scene, behavior_runs=others
            )
    for robot in scene.robots:
        if death.step == LOADING.format(entity=robot.entity):
            found = explain_death(replace(scene, robots=(robot,)), death)
            return found, _without(scene, robot.entity)
    return explain_death(scene, death), None


def _without(scene: Scene, entity: str) -> Scene | None:
    robots = tuple(robot for robot in scene.robots if robot.entity != entity)
    behavior_runs = tuple(
        behavior_run for behavior_run in scene.behavior_runs if behavior_run.entity != entity
    )
    return replace(scene, robots=robots, behavior_runs=behavior_runs) if robots else None


def explain_death(scene: Scene, death: Died) -> Diagnostic:
    """Report that the engine died in the step that `death` names."""
    others = (name for name in ENGINES if name != scene.engine and not missing_engines([name]))
    not_loaded = explain_not_loaded(scene.engine, death, others)
    if not_loaded is not None:
        return not_loaded
    words = _without_greetings(death.output)[-LAST_OUTPUT:]
    said = f" Its last output: {words}" if words else ""
    hint = (
        "Check collision meshes, sizes and masses first, and remove links until the simulation "
        "runs: the engine cannot handle a part of the description."
    )
    if death.cause == "cpu time" and death.step.startswith("simulating"):
        hint = (
            "Use boxes or meshes with fewer triangles for collisions, spawn the robot above the "
            "ground, or use another engine (--engine): contacts take most of the time."
        )
    return ENGINE_DIED.at(
        None,
        element=_entities(scene),
        message=f"The physics engine ({ENGINES[scene.engine].title}) "
        f"{death.reason} while {death.step or 'it was starting'}.{said}",
        hint=death.hint(hint),
    )


def _refusals(result: SceneResult) -> Iterator[Diagnostic]:
    for entity, refused in result.refused.items():
        yield ENGINE_REFUSED.at(
            None,
            element=entity,
            message=f"The physics engine does not simulate `{entity}`: {refused.reason}.",
            hint=refused.hint,
        )


def _undrawn(result: SceneResult) -> Iterator[Diagnostic]:
    """What was asked for and was not drawn: as much an error as a robot that fails."""
    if isinstance(result.picture, NotDrawn):
        yield _no_picture("picture", result.picture.problem)
    if isinstance(result.world_picture, NotDrawn):
        yield _no_picture("picture of the world", result.world_picture.problem)
    if isinstance(result.video, NotDrawn):
        yield no_video(result.video.problem)


def _no_picture(what: str, problem: str) -> Diagnostic:
    return NO_PICTURE.at(
        None,
        message=f"Cannot draw the {what}: {problem}.",
        hint="Check the visual meshes and that the directory is writable, or omit --picture and "
        "--html: the simulation itself is not affected.",
    )


def no_video(problem: str, hint: str | None = None) -> Diagnostic:
    """Say that there is no video; `problem` goes on after "Cannot record a video:".

    `hint` says what to do where that is not the file or the drawing.
    """
    missing = find_missing_library(problem)
    if missing is not None:
        return NO_VIDEO.at(
            None,
            message=f"Cannot record a video: {missing.name} is not installed on this system.",
            hint=f"{missing.advice}; or record a .gif.",
        )
    return NO_VIDEO.at(
        None,
        message=f"Cannot record a video: {problem}.",
        hint=hint or "Record a .gif to a writable directory, or omit --record.",
    )


def _coarse(result: SceneResult) -> Iterator[Diagnostic]:
    """Say so if there is so much to draw that the video has less than others."""
    video = result.video
    if isinstance(video, Video) and video.is_coarse:
        yield COARSE_VIDEO.at(
            None,
            message=f"The video has {video.frames_per_second:.3g} frames/s of {video.width} "
            f"by {video.height} pixels, to be drawn in time: {video.frames} frames of "
            f"{video.triangles:,} triangles.",
            hint="Reduce the visual meshes."
            if video.triangles > MANY_TRIANGLES
            else "Record fewer simulated seconds, in --seconds or in the behaviors.",
        )


def _warnings(scene: Scene, output: str) -> Iterator[Diagnostic]:
    words = _without_greetings(output)
    if words:
        yield ENGINE_WARNING.at(
            None,
            element=_entities(scene),
            message=f"The physics engine warned: {words[:LAST_OUTPUT]}",
            hint="Check the part that the engine names: the simulation continued, perhaps without "
            "it.",
        )


def _without_greetings(output: str) -> str:
    lines = (line.strip() for line in COLORS.sub("", output).splitlines())
    return "\n".join(line for line in lines if line and not line.startswith(GREETINGS))


def _entities(scene: Scene) -> str:
    return ", ".join(robot.entity for robot in scene.robots)


ENGINE_NOT_LOADED = Rule(
    code="SPN097",
    name="engine-not-loaded",
    severity=Severity.ERROR,
    summary="The library of the physics engine is installed but cannot be loaded.",
    what="Imports the engine in the simulation process, as `wsgen doctor` does.",
    why="An engine may need a system library that is missing on a machine without a desktop. The "
    "robot is not the cause.",
    example="wsgen validate robot.urdf --engine dart  # in a container without libGL.so.1",
    instead="sudo apt install libgl1",
)


def explain_not_loaded(engine: str, death: Died, others: Iterable[str]) -> Diagnostic | None:
    """Explain a death while the engine was imported; None if it died of something else.

    Args:
        engine: its name on the command line.
        death: of the child.
        others: names of the other engines that are installed.
    """
    missing = find_missing_library(death.reason)  # MuJoCo's module has Python load one by ctypes
    is_import = any(name in death.reason for name in ("(ImportError", "(ModuleNotFoundError"))
    if death.step or (missing is None and not is_import):
        return None
    why = death.reason if missing is None else f"needs {missing.name}, which the system lacks"
    fix = "Install it again with pip" if missing is None else missing.advice
    other = next(iter(others), None)
    instead = "" if other is None else f"--engine {other}, which works without it"
    return ENGINE_NOT_LOADED.at(
        None,
        message=f"The physics engine ({engine}) {why}.",
        hint=f"{'; or '.join(filter(None, (fix, instead)))}.",
    )


def all_engines() -> tuple[str, ...]:
    """Those that `--engine all` compares: what is installed; all, if there is nothing to compare.

    `check_engines` then says which are missing.
    """
    installed = installed_engines()
    return tuple(installed if len(installed) > 1 else ENGINES)


def check_engines(engines: Sequence[str]) -> None:
    """Check that engines are installed.

    Raises:
        NotFoundError: one is not.
    """
    missing = missing_engines(engines)
    if missing:
        raise NotFoundError(
            f"{name_engines(missing)} {'is' if len(missing) == 1 else 'are'} not installed."
            if installed_engines()
            else "No physics engine is installed.",
            hint=_how_to_install(missing),
        )


def _how_to_install(engines: Sequence[str]) -> str:
    """The hint for engines that are missing; PyBullet's wheels have two names, where it has any."""
    extras = [ENGINES[name].extra for name in engines if ENGINES[name].extra]
    if not extras and not installed_engines():
        extras = ["mujoco"]
    if extras:
        what = "it" if len(engines) == 1 else "them"
        if len(extras) < len(engines):
            what = name_engines(name for name in engines if ENGINES[name].extra)
        return f"Install {what}: pip install 'wsgen[{','.join(extras)}]'"
    return (
        "PyBullet is installed with wsgen if it has a wheel for this machine and Python version; "
        f"otherwise use --engine {default_engine()}."
    )


ENGINE_LEFT_OUT = Rule(
    code="SPN098",
    name="engine-left-out",
    severity=Severity.INFO,
    severity_varies="an error with `--engine gazebo`",
    summary="An engine is not installed; `--engine all` compares the others.",
    what="Also looks for the Gazebo that the launch file starts: with `--engine gazebo`, and with "
    "`--engine all` where the other Gazebo is installed.",
    why="If two engines disagree, it is not known which one is right.",
    example="wsgen validate my_robot --engine all",
    instead="pip install 'wsgen[mujoco,dart]'\nwsgen validate my_robot --engine all",
)


def engine_left_out(engines: Sequence[str]) -> Iterator[Diagnostic]:
    """Report which engine a comparison is without; `engines` are those that are compared."""
    left_out = [name for name in ENGINES if name not in engines]
    if len(engines) > 1 and left_out:
        yield ENGINE_LEFT_OUT.at(
            None,
            message=f"{name_engines(left_out)} is not installed: only {name_engines(engines)} are "
            "compared.",
            hint=_how_to_install(left_out),
        )
