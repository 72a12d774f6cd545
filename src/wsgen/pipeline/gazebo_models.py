"""Robots that Gazebo looks up: models of a world file, and models that are spawned by address.

The worlds that several launch files start are read once, with the meshes of their models.
"""

from __future__ import annotations

import threading
from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.sdf.includes import DOWNLOADED, MODEL_LEFT_OUT
from wsgen.descriptions.sdf.lookup import (
    file_of_model,
    find_world,
    is_brought_along,
    is_file,
    is_folder,
    is_of_gazebo,
    is_there,
)
from wsgen.diagnostics import Rule, Severity
from wsgen.isolation import parent
from wsgen.launching.simulators import find_simulator
from wsgen.launching.spawning import assume_spawn, find_spawns
from wsgen.pipeline.prepare import PrepareContext, find_model, keeps_out, read_file
from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence

    from wsgen.descriptions.sdf.models import SdfFile
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.package import ShareOf
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.model.world import Spawn
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.started import Started


DATABASE_MODEL = Rule(
    code="SPN006",
    name="database-model",
    severity=Severity.WARNING,
    severity_varies="an error where no other robot is simulated",
    summary="A spawner uses a model that only Gazebo has or downloads.",
    what="Looks for the model in the folders that Gazebo searches on this machine, and around the "
    "launch file.",
    why="The model is not part of the workspace, so wsgen cannot simulate it.",
    example="arguments=['-database', 'coke_can', '-entity', 'can']",
    instead="arguments=['-file', os.path.join(share, 'models', 'can', 'model.sdf'), "
    "'-entity', 'can']",
)
MODEL_LIMIT = 2**24  # bytes


class FoundRobots(NamedTuple):
    """What a plan spawns, and why other robots do not appear."""

    spawns: tuple[Spawn, ...]
    diagnostics: tuple[Diagnostic, ...]
    are_meant: bool  # it puts a robot into a simulator, or would without its mistakes
    lack_world: bool = False  # nothing does; the world that may have one is not found
    lack_model: str | None = None  # nothing does; what is said of a model that the world includes


def find_robots(plan: LaunchPlan, overlay: Overlay) -> FoundRobots:
    """Find what spawners spawn; where nothing does and the world has no robot, what may be spawned.

    The environment of the overlay is that of the launch, without what the launch file sets.
    """
    spawns, not_spawned = find_spawns(plan)
    simulator, _ = find_simulator(plan)
    world = simulator.world if simulator else None
    variables = {**overlay.environment, **plan.environment}
    file = find_world(world, variables) if world else None
    if spawns or not_spawned:
        return FoundRobots(spawns, not_spawned, are_meant=True)
    read = _read_models(file, variables, overlay.look_up) if file else None
    if read is not None and robots_of_world(read, variables):
        return FoundRobots((), (), are_meant=True)
    assumed, found = assume_spawn(plan, partial(_calls_spawn_service, overlay=overlay))
    if assumed is not None:
        return FoundRobots((assumed,), (found,), are_meant=True)
    is_written = world is not None and str(Path(world).absolute()) in plan.written
    is_here = is_written or (file is not None and is_there(file))
    if world and not (is_here or "://" in world or is_brought_along(world)):
        return FoundRobots((), (), are_meant=False, lack_world=True)
    # An action that was created and not added is named as the element.
    return FoundRobots(
        (), (found,), are_meant=found.element is not None, lack_model=_left_out(read)
    )


def _calls_spawn_service(program: Process, overlay: Overlay) -> bool:
    """Whether a program of the workspace is a Python file that uses the service `SpawnEntity`."""
    package = next((one for one in overlay.written if one.name == program.package), None)
    if package is None or package.manifest is None:
        return False
    # Few launch files come here, and these read all of CMake.
    from wsgen.packages.build_files.facts import read_build_facts  # noqa: PLC0415
    from wsgen.packages.build_files.python_sources import program_files  # noqa: PLC0415
    from wsgen.packages.workspace.python_nodes import read_node_file  # noqa: PLC0415

    facts, _ = read_build_facts(package.path, package.name, package.build_type)
    file = program_files(facts).get(program.executable or "")
    node = None if file is None else read_node_file(file)
    return node is not None and "SpawnEntity" in node.imported


def _read_models(file: Path, environment: Mapping[str, str], share_of: ShareOf) -> SdfFile | None:
    """What is in a world; None where that cannot be robots."""
    if not _may_hold_robots(file):
        return None
    context = PrepareContext(share_of=share_of, folder=Path(), run=parent.run)
    return read_file(file, context, environment)


def _left_out(world: SdfFile | None) -> str | None:
    """What is said of an included model that is neither here nor one that Gazebo brings along."""
    return next(
        (
            f"{Path(found.file or '').name}: {found.message}"
            for found in (world.diagnostics if world else ())
            if found.code == MODEL_LEFT_OUT.code and found.reason != DOWNLOADED
        ),
        None,
    )


def _may_hold_robots(file: Path) -> bool:
    """Whether it is worth reading a world for robots."""
    try:
        text = read_regular(file, MODEL_LIMIT)
    except OSError:
        return False
    return b"<joint" in text or b"<include" in text


def robots_of_world(found: SdfFile, environment: Mapping[str, str]) -> set[str]:
    """The names of the models of a world that are robots: they can move, and so can their joints.

    Those that Gazebo brings along or downloads are none.
    """
    return {
        model.name
        for model in found.models
        if model.robot is not None
        and not model.is_static
        and model.robot.movable_joints
        and not (model.file and is_of_gazebo(model.file, environment))
    }


def as_robots(models: Sequence[PreparedRobot], names: set[str]) -> list[PreparedRobot]:
    """The models of a world, of which those with these names are robots to simulate and check."""
    return [
        replace(model, is_static_model=False, can_run=not keeps_out(model.diagnostics))
        if model.entity in names
        else model
        for model in models
    ]


def look_up_model(
    spawn: Spawn, context: PrepareContext, environment: Mapping[str, str]
) -> Spawn | Diagnostic:
    """A spawn of a model by its address, with the text of the model."""
    process = spawn.process
    around = process.file if process else None
    uri = spawn.model_uri or ""
    is_path = is_folder(Path(uri))
    # Gazebo Sim looks up a name without a scheme, too.
    address = uri if "://" in uri else f"model://{uri}"
    folder = Path(uri) if is_path else find_model(address, around, context, environment)
    file = folder if folder is None or is_file(folder) else file_of_model(folder)
    try:
        text = None if file is None else read_regular(file, MODEL_LIMIT).decode()
    except (OSError, UnicodeDecodeError):
        text = None
    if text is not None:
        return replace(spawn, description=text, description_file=file)
    return DATABASE_MODEL.at(
        around,
        process.line if process else None,
        uri,
        message=f"'{uri}' is not in the workspace: Gazebo has it or downloads it, but wsgen does "
        "not simulate it.",
        hint="To simulate it, install the model with the package, and spawn its file.",
    )


class ReadWorld(NamedTuple):
    """What is in a world file, and what is reported of the meshes of its models."""

    file: SdfFile
    models: list[PreparedRobot]
    diagnostics: tuple[Diagnostic, ...]


class KnownWorlds:
    """Reads worlds, those that are known only once. Threads may share it.

    Files must not change meanwhile.
    """

    def __init__(self, folder: Path, all_started: Iterable[Started | None]) -> None:
        """`folder` is for files that engines read; it must be there until they have read them.

        Of the worlds, only those are kept that several of the launch files start.
        """
        counts = Counter(one.simulator.world for one in all_started if one and one.simulator)
        self._shared = {name for name, count in counts.items() if count > 1}
        self._folder = folder
        self._lock = threading.Lock()
        self._locks: dict[Hashable, threading.Lock] = {}
        self._read: dict[Hashable, ReadWorld] = {}

    def read(  # noqa: PLR0913, PLR0917  what a world depends on
        self,
        name: str,
        file: Path,
        kind: str | None,
        context: PrepareContext,
        environment: Mapping[str, str],
        read: Callable[[PrepareContext], ReadWorld],
    ) -> ReadWorld:
        """What `read` returns for the world that a launch file calls so."""
        if name not in self._shared:
            return read(context)
        paths = (one for one in environment.items() if one[0].endswith("_PATH") or one[0] == "HOME")
        key = file, kind, context.with_colors, context.with_devices, frozenset(paths)
        with self._lock:
            lock = self._locks.setdefault(key, threading.Lock())
        with lock:  # others wait for the first one
            if key not in self._read:
                self._read[key] = read(replace(context, folder=self._folder))
            return self._read[key]
