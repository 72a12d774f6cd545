"""Turn descriptions into the robots and models that Gazebo would simulate.

URDF texts become robots, models of SDF robots or static models; packages and models that their
addresses name are looked up in folders.
"""

from __future__ import annotations

import itertools
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.check import check_robot
from wsgen.checks.rules.drives import turning_friction
from wsgen.checks.rules.plugins import DUPLICATE_SENSOR
from wsgen.checks.rules.robot_files import (
    UNPREFIXED_XACRO,
    path_of_one_machine,
    uncalled_macros,
    unprefixed_xacro,
)
from wsgen.checks.rules.settings import settings_not_simulated
from wsgen.descriptions.meshes.inspection import inspect_meshes
from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.descriptions.meshes.shape_meshes import build_shapes
from wsgen.descriptions.rules import (
    IMPOSSIBLE_INERTIA,
    MIRRORED_MESH,
    MISSING_COLLISION_MESH,
    MISSING_VISUAL_MESH,
    NO_SHAPE,
    NOT_A_NUMBER,
    ONE_NAME_FOR_LINK_AND_JOINT,
    RESERVED_NAME,
    UNNAMED_ELEMENT,
    ZERO_SIZE,
)
from wsgen.descriptions.sdf.bodies import MASSLESS_MODEL_LINK
from wsgen.descriptions.sdf.includes import DATABASE_MODELS
from wsgen.descriptions.sdf.lookup import is_folder, model_finder, model_folders, resource_folders
from wsgen.descriptions.sdf.models import read_model, read_sdf
from wsgen.descriptions.urdf.links import INCOMPLETE_INERTIAL, UNNAMED_MESH
from wsgen.descriptions.urdf.lumping import (
    DROPPED_BY_OLD_SDFORMAT,
    DROPPED_LINK,
    IMPOSSIBLE_SUM,
    LUMPED_END_OF_SDF_JOINT,
    UNKNOWN_END_OF_SDF_JOINT,
    hold_kinematic,
    lump,
)
from wsgen.descriptions.urdf.reader import IGNORED_XACRO, MISSPELLED, read_urdf
from wsgen.descriptions.urdf.structure import MIMIC_CYCLE
from wsgen.descriptions.urdf.unknown_elements import meant_element
from wsgen.descriptions.xacro.reader import place_in_source, written_elements
from wsgen.diagnostics import Rule, Severity
from wsgen.model.engines import name_engines
from wsgen.model.robot import Mesh, Robot
from wsgen.model.transform import IDENTITY, Pose
from wsgen.text.files import LARGEST_TEXT, read_regular
from wsgen.text.suggestions import some_of
from wsgen.text.values import dataclass
from wsgen.text.xmltree import Malformed, child_text, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence

    from wsgen.descriptions.sdf.models import SdfFile, SdfModel
    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.behavior import DiffDrive
    from wsgen.model.devices import Devices
    from wsgen.model.package import ShareOf
    from wsgen.model.world import Spawn, SpawnHeight
    from wsgen.text.markup import Written


# How severe a diagnostic is where the simulator is known: Gazebo Classic simulates what Gazebo Sim
# refuses, and downloads models.
SEVERITIES: Mapping[str, Mapping[str, Severity]] = {
    "gz": {
        ONE_NAME_FOR_LINK_AND_JOINT.code: Severity.ERROR,
        DATABASE_MODELS.code: Severity.WARNING,
    },
    "classic": {
        IMPOSSIBLE_INERTIA.code: Severity.WARNING,
        IMPOSSIBLE_SUM.code: Severity.WARNING,
        DUPLICATE_SENSOR.code: Severity.WARNING,
        MIRRORED_MESH.code: Severity.WARNING,
        ZERO_SIZE.code: Severity.WARNING,
        DROPPED_BY_OLD_SDFORMAT.code: Severity.ERROR,
        MASSLESS_MODEL_LINK.code: Severity.ERROR,
        MIMIC_CYCLE.code: Severity.WARNING,
        RESERVED_NAME.code: Severity.WARNING,
    },
}
# With these, Gazebo drops a link, a part of one or a joint of SDF, and goes on.
DROPS_PARTS = MISSPELLED.union(
    rule.code
    for rule in (
        *(DROPPED_LINK, DROPPED_BY_OLD_SDFORMAT, INCOMPLETE_INERTIAL, MISSING_COLLISION_MESH),
        *(NO_SHAPE, NOT_A_NUMBER, UNKNOWN_END_OF_SDF_JOINT, UNNAMED_ELEMENT, UNNAMED_MESH),
    )
)
# What only older versions of sdformat do, and what that of Gazebo Classic does not.
OLD_SDFORMAT = frozenset((LUMPED_END_OF_SDF_JOINT.code, DROPPED_BY_OLD_SDFORMAT.code))
NOT_IN_CLASSIC = frozenset((LUMPED_END_OF_SDF_JOINT.code,))
FORTRESS = frozenset(("humble", "iron"))  # distributions with a Gazebo Sim that may have such
NAMED = 3  # at most so many robots are named in a line


MOST_KNOWN = 16


class KnownRobots:
    """The robots that were prepared last, by what they are read from. Threads may share it.

    Files that the descriptions name must not change.
    """

    def __init__(self) -> None:
        self._found: dict[Hashable, tuple[PreparedRobot | None, tuple[Diagnostic, ...]]] = {}

    def get(self, key: Hashable) -> tuple[PreparedRobot | None, tuple[Diagnostic, ...]] | None:
        """What was prepared, and what was reported; None where it is not known."""
        return self._found.get(key)

    def keep(
        self, key: Hashable, found: tuple[PreparedRobot | None, tuple[Diagnostic, ...]]
    ) -> None:
        """Keep what was prepared, and forget what was kept first."""
        known = {**self._found, key: found}  # another thread may look one up
        while len(known) > MOST_KNOWN:
            del known[next(iter(known))]
        self._found = known


@dataclass(frozen=True, kw_only=True)
class PrepareContext:
    """What it takes to complete a description."""

    share_of: ShareOf
    folder: Path  # for mesh files that are written anew; there until the simulation is over
    run: Run  # starts the child process that reads meshes
    with_colors: bool = False  # also read what meshes look like, for a picture
    with_devices: bool = False  # also read their sensors and plugins, for a live run
    engines: Sequence[str] = ()  # that simulate it as Gazebo Classic; what they lack is reported
    known: KnownRobots | None = None  # that were prepared before; None: each is prepared


@dataclass(frozen=True, kw_only=True)
class PreparedRobot:
    """A robot to be spawned, as written and as Gazebo has it."""

    entity: str
    written: Robot
    lumped: Robot
    readable: Robot | None = None  # as written, with mesh files that can be read
    can_run: bool = True  # if not, an engine would simulate another robot than the described one
    spawn_pose: Pose = IDENTITY
    model_pose: Pose | None = None  # of the frame of the model, where that is not the root link's
    height: SpawnHeight | None = None  # where a launch file gives that of the spawn pose
    on_the_ground: bool = False  # as low as it can stand, instead of at the height of that pose
    is_static_model: bool = False  # a model of the world around the robots
    may_move: bool = False  # a model of a world file: it may roll or tip over
    drive: DiffDrive | None = None  # by the plugin of its description, if that works
    diagnostics: tuple[Diagnostic, ...] = ()  # about its description, as they have been reported
    devices: Devices | None = None  # sensors and plugins, if they are wanted
    description: str | None = None  # its URDF, likewise; None: it is of SDF
    text: str | bytes | None = None  # of URDF or SDF, as it is spawned; None: a world file has it


def prepare_robot(  # noqa: PLR0913  most have defaults
    text: str | bytes,
    *,
    file: Path | None,
    context: PrepareContext,
    entity: str | None = None,
    spawn_pose: Pose = IDENTITY,
    on_the_ground: bool = False,
    simulator: str | None = None,
    distro: str | None = None,
) -> tuple[PreparedRobot | None, tuple[Diagnostic, ...]]:
    """Read, complete and lump the robot of a URDF text; None where there is no robot.

    `file` is what the text comes from or was expanded from, and what the diagnostics name, with
    places in what a person edits; bytes are those of the file itself. The robot is called
    `entity`, or as its description calls it, and is for the simulator of that `simulator` in that
    ROS 2 distribution, where they are known.
    """
    key = (text, file, simulator, distro)
    known = None if context.known is None else context.known.get(key)
    if known is None:
        known = _prepare(text, file, context, simulator, distro)
        if context.known is not None:
            context.known.keep(key, known)
    prepared, found = known
    if prepared is None:
        return None, found
    return replace(
        prepared,
        entity=entity or prepared.entity,
        spawn_pose=spawn_pose,
        on_the_ground=on_the_ground,
    ), found


def _prepare(
    text: str | bytes,
    file: Path | None,
    context: PrepareContext,
    simulator: str | None,
    distro: str | None,
) -> tuple[PreparedRobot | None, tuple[Diagnostic, ...]]:
    """Prepare a robot, wherever it is spawned."""
    written, found = read_urdf(text, file=file)
    prepared = None
    if written is not None:
        readable, lumped, more = _as_in_gazebo(written, file, context, simulator)
        found, more = _at_the_misspelling(found, more)
        checked = check_robot(readable, file, in_gazebo=lumped, simulator=simulator, distro=distro)
        lacking = settings_not_simulated(written, lumped, file, context.engines)
        found = _first_of_each_inertial((*found, *more, *checked, *lacking))
        found = tuple(for_simulator(found, simulator, distro))
        prepared = PreparedRobot(
            entity=written.name,
            written=written,
            lumped=lumped,
            readable=readable,
            # What Gazebo goes on without is reported, and the robot does not pass.
            can_run=can_simulate(lumped, found, simulator),
            drive=_drive(lumped, simulator),
            text=text,
        )
        if context.with_devices:
            prepared = _with_devices(prepared, text)
    sources = [] if file is None else written_elements(file, context.share_of)
    if not isinstance(text, bytes):  # those are of the file itself, where every line is its own
        found = place_in_source(
            found, text=text, file=file, share_of=context.share_of, written=sources
        )
    if written is not None and file is not None:
        found = _at_the_call((*found, *_of_files(sources, written, file, found)))
    return prepared and replace(prepared, diagnostics=found), found


def can_simulate(lumped: Robot, found: Iterable[Diagnostic], simulator: str | None) -> bool:
    """Whether what a simulator makes of a robot is known well enough, and is anything.

    What Gazebo Classic makes of one that it drops parts of was compared with it.
    """
    is_known = not keeps_out(
        one
        for one in found
        if simulator != "classic"
        or one.code not in DROPS_PARTS
        or not (one.element or "").startswith(("link[", "gazebo/joint["))
    )
    return is_known and len(lumped.links) > lumped.fixed_to_world


def keeps_out(found: Iterable[Diagnostic]) -> bool:
    """Whether an error is one for which Gazebo does not load a model, or loads another one.

    It goes on without a plugin that it does not find or that refuses its parameters, and without
    hardware or controllers: the body is the same.
    """
    errors = [one for one in found if one.severity is Severity.ERROR]
    if not errors:
        return False
    from wsgen.checks.rules import plugins, ros2_control  # noqa: PLC0415  most robots have no error

    of_plugins = (
        *(plugins.UNKNOWN_PLUGIN, plugins.PLUGIN_OF_OTHER_SIMULATOR, plugins.UNKNOWN_PLUGIN_PART),
        *(plugins.UNREAD_PLUGIN_PARAMETER, IGNORED_XACRO),
    )
    of_control = (rule for rule in vars(ros2_control).values() if isinstance(rule, Rule))
    codes = {rule.code for rule in (*of_plugins, *of_control)}
    return any(one.code not in codes for one in errors)


def _with_devices(prepared: PreparedRobot, text: str | bytes) -> PreparedRobot:
    """The robot with what its URDF says for a live run."""
    from wsgen.descriptions.urdf.devices import read_devices  # noqa: PLC0415  live runs alone

    return replace(
        prepared,
        devices=read_devices(text, prepared.written, prepared.lumped),
        description=text.decode("utf-8", "replace") if isinstance(text, bytes) else text,
    )


def _drive(robot: Robot, simulator: str | None) -> DiffDrive | None:
    """The drive by the plugin of a robot, if it has one that works."""
    if not any(tag.plugins for tag in robot.gazebo):
        return None
    from wsgen.descriptions.urdf.diff_drive import NoDrive, find_diff_drive  # noqa: PLC0415  most have none

    found = find_diff_drive(robot, simulator=simulator)
    return None if isinstance(found, NoDrive) else found


def _of_files(
    sources: Sequence[Written], robot: Robot, file: Path, found: Iterable[Diagnostic]
) -> tuple[Diagnostic, ...]:
    """What is wrong with the files that a robot is written in."""
    missing = {MISSING_COLLISION_MESH.code, MISSING_VISUAL_MESH.code}
    messages = "".join(one.message for one in found if one.code in missing)
    addresses = {
        shape.uri
        for link in robot.links
        for shape in (
            *(visual.geometry for visual in link.visuals),
            *(collision.geometry for collision in link.collisions),
        )
        if isinstance(shape, Mesh)
    }
    return (
        *path_of_one_machine(sources, (one for one in addresses if f"`{one}`" in messages)),
        *unprefixed_xacro(sources),
        *uncalled_macros(sources, file),
    )


def _at_the_misspelling(
    found: Sequence[Diagnostic], more: Iterable[Diagnostic]
) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """Both, with what Gazebo refuses for a misspelled <inertial> as an error about that."""
    reported, left = list(found), []
    for error in more:
        places = (
            place
            for place, cause in enumerate(reported)
            if error.severity is Severity.ERROR
            and cause.code in MISSPELLED
            and _is_in_inertial(cause.element or "", error.element or "")
        )
        place = next(places, None)
        if place is None:
            left.append(error)
        else:
            cause = reported[place]
            what = cause.message.partition(": ")[0]
            message = f"{what}: {error.message}"
            reported[place] = replace(cause, severity=Severity.ERROR, message=message)
    return tuple(reported), tuple(left)


def _at_the_call(found: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Say at a macro that is called without `xacro:` that Gazebo refuses its link for that."""
    calls = {
        (one.element or "").partition("/")[0]: one
        for one in found
        if one.code == UNPREFIXED_XACRO.code and "/" in (one.element or "")
    }
    refused = {
        one.element: one
        for one in found
        if one.code == DROPPED_LINK.code and one.element is not None and one.element in calls
    }
    errors = {
        calls[name]: replace(
            calls[name], severity=one.severity, message=f"{calls[name].message} {one.message}"
        )
        for name, one in refused.items()
    }
    return tuple(errors.get(one, one) for one in found if one not in refused.values())


def _is_in_inertial(element: str, link: str) -> bool:
    """Whether the path of an element is one in what is, or must be, the <inertial> of a link."""
    tag = element.removeprefix(f"{link}/").partition("/")[0] if link else element
    return tag != element and meant_element(tag, ("inertial",)) is not None


def for_simulator(
    diagnostics: Iterable[Diagnostic], simulator: str | None, distro: str | None = None
) -> Iterator[Diagnostic]:
    """The diagnostics as they hold for a simulator: what it refuses is an error."""
    severities = SEVERITIES.get(simulator or "", {})
    is_new = simulator == "gz" and distro not in {None, *FORTRESS}
    left_out = OLD_SDFORMAT if is_new else NOT_IN_CLASSIC if simulator == "classic" else ()
    for found in diagnostics:
        if found.code in severities:
            yield replace(found, severity=severities[found.code])
        elif found.code not in left_out:
            yield found


def _first_of_each_inertial(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The first diagnostic about each <inertial>: the others come from the same numbers."""
    kept: list[Diagnostic] = []
    reported: set[str] = set()
    for found in diagnostics:
        link, inertial, _ = (found.element or "").partition("/inertial")
        if not inertial or link not in reported:
            kept.append(found)
        reported |= {link} if inertial else set()
    return tuple(kept)


def _as_in_gazebo(
    written: Robot, file: Path | None, context: PrepareContext, simulator: str | None
) -> tuple[Robot, Robot, tuple[Diagnostic, ...]]:
    """The robot with its meshes, as it is written and as Gazebo has it."""
    located, missing = find_meshes(
        written, share_of=context.share_of, folder=file.parent if file else None, file=file
    )
    readable, broken = complete_meshes(located, file, context)
    lumped, dropped = lump(readable, file=file, for_classic=simulator == "classic")
    return readable, lumped, (*missing, *broken, *dropped)


def name_some(prepared: Sequence[PreparedRobot], engines: Sequence[str]) -> str:
    """The names of the robots that are simulated, of many the first few, and in which engines.

    PyBullet alone goes without saying.
    """
    names = [robot.entity for robot in prepared if robot.can_run and not robot.is_static_model]
    where = f" in {name_engines(engines)}" if tuple(engines) != ("bullet",) else ""
    return some_of(names, NAMED) + where


def complete_meshes(
    robot: Robot, file: Path | None, context: PrepareContext
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """The robot with shapes and mesh files that every engine reads as Gazebo does."""
    readable, broken = inspect_meshes(
        robot,
        file=file,
        folder=context.folder,
        run=context.run,
        with_colors=context.with_colors,
    )
    # Afterwards: meshes that wsgen writes need no inspection.
    built, more = build_shapes(readable, file=file, folder=context.folder, run=context.run)
    return built, (*broken, *more)


def share_on_model_path(environment: Mapping[str, str]) -> Callable[[str], Path | None]:
    """Look a package, model or other folder up where the environment has Gazebo look."""
    folders = model_folders(environment)

    def share_of(package: str) -> Path | None:
        places = itertools.chain(folders, resource_folders(environment))
        found = (folder / package for folder in places if package)
        return next((folder for folder in found if is_folder(folder)), None)

    return share_of


def share_around(file: Path) -> Callable[[str], Path | None]:
    """Look a package up among the folders that a file lies in, and those beside them.

    A folder is taken for the package if it is called so, or if its package.xml says so. Gazebo's
    `model://` addresses are looked up in the same way.
    """
    folders = file.absolute().parents

    def share_of(package: str) -> Path | None:
        for folder in folders:
            if folder.name == package or _manifest_name(folder) == package:
                return folder
            for beside in (folder / package, folder / "share" / package):
                if package and is_folder(beside):
                    return beside
        return None

    return share_of


def _manifest_name(folder: Path) -> str | None:
    try:
        root = parse(read_regular(folder / "package.xml", LARGEST_TEXT))
    except (OSError, ValueError):
        return None
    return None if isinstance(root, Malformed) else child_text(root, "name")


MOST_MODELS = 1000  # a minute of simulation for 3 s; public worlds have some dozens


def read_file(
    file: Path,
    context: PrepareContext,
    environment: Mapping[str, str],
    *,
    content: str | None = None,
) -> SdfFile:
    """An SDF file, with what it includes from where Gazebo looks and from around the file.

    `content` is the SDF that xacro makes of the file, where it is one of xacro.
    """
    return read_sdf(
        file,
        find_model=_finder(file, context, environment),
        read_robot=lambda urdf: _read_included(urdf, context),
        content=content,
        with_devices=context.with_devices,
    )


def read_spawned(spawn: Spawn, context: PrepareContext, environment: Mapping[str, str]) -> SdfFile:
    """The model of a spawner that is given SDF."""
    file = spawn.description_file
    return read_model(
        spawn.description,
        file=file,
        find_model=_finder(file, context, environment),
        pose_in_world=spawn.pose_in_world,
        with_devices=context.with_devices,
    )


_NOWHERE = Path(os.sep)  # a file around which no model is


def _finder(
    file: Path | None, context: PrepareContext, environment: Mapping[str, str]
) -> Callable[[str], Path | None]:
    """A function from the address of a model to its folder."""
    find = model_finder(file or _NOWHERE, environment)

    def look_up(uri: str) -> Path | None:
        found = find(uri)
        scheme, _, rest = uri.partition("://")
        name = rest.partition("/")[0]
        is_local = scheme in {"model", "package"} and name not in {"", ".", ".."}
        return found or (context.share_of(name) if is_local else None)

    return look_up


def find_model(
    uri: str, file: Path | None, context: PrepareContext, environment: Mapping[str, str]
) -> Path | None:
    """The folder of a model by its address, looked up as from a file."""
    return _finder(file, context, environment)(uri)


def _read_included(
    file: Path, context: PrepareContext
) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
    """A URDF file that a world includes, as Gazebo has it."""
    written, found = read_urdf(read_regular(file, LARGEST_TEXT), file=file)
    if written is None:
        return None, found
    located, missing = find_meshes(
        written, share_of=context.share_of, folder=file.parent, file=file
    )
    lumped, dropped = lump(located, file=file)
    return lumped, (*found, *missing, *dropped)


OVERSIZED_SCENE = Rule(
    code="SPN035",
    name="oversized-scene",
    severity=Severity.ERROR,
    summary="The scene has more than 1000 models.",
    why="The simulation would take hours. Public worlds have a few dozen models.",
    example="A world file with 5000 <model> elements, one for each brick.",
    instead="Combine the bricks that never move into one static model.",
)


def prepare_models(
    found: SdfFile, context: PrepareContext, *, is_static_model: bool = False
) -> tuple[list[PreparedRobot], tuple[Diagnostic, ...]]:
    """The models that have links, ready for an engine, and the diagnostics about their meshes.

    Static models are there as far as they can be read. Of a file that is simulated by itself, no
    model can run where there are errors: the scene would not be the described one.
    """
    models = [model for model in found.models if model.robot is not None]
    if len(models) > MOST_MODELS:
        return [], (_too_many(len(models), found),)
    robots, more = _completed(models, context)
    if context.engines:  # of Gazebo Classic
        robots = [hold_kinematic(robot) for robot in robots]
    turning = (
        one
        for model, robot in zip(models, robots, strict=True)
        for one in (
            *turning_friction(robot, robot, model.file),
            *settings_not_simulated(robot, robot, model.file, context.engines),
        )
    )
    more += tuple(dict.fromkeys(turning))  # a file may be included several times
    can_run = is_static_model or not keeps_out((*found.diagnostics, *more))
    if context.with_devices:
        models = [_with_included_devices(model) for model in models]
    return [
        PreparedRobot(
            entity=model.name,
            written=written,
            lumped=robot,
            readable=robot,
            can_run=can_run,
            spawn_pose=model.pose_in_world,
            model_pose=model.model_pose,
            on_the_ground=found.world is None and not model.is_static,
            is_static_model=is_static_model,
            may_move=found.world is not None,
            drive=_drive(robot, None),
            devices=model.devices,
            diagnostics=_about(model, models, (*found.diagnostics, *more)),
        )
        for model, robot in zip(models, robots, strict=True)
        if (written := model.robot) is not None
    ], more


def _with_included_devices(model: SdfModel) -> SdfModel:
    """The model with its devices, also where it is a URDF that a world includes."""
    if model.devices is not None or model.file is None:
        return model
    from wsgen.descriptions.urdf.devices import read_devices  # noqa: PLC0415  live runs alone

    text = read_regular(model.file, LARGEST_TEXT)
    written, _ = read_urdf(text, file=model.file)
    if written is None:
        return model
    lumped, _ = lump(written, file=model.file)
    return model._replace(devices=read_devices(text, written, lumped))


def _about(
    model: SdfModel, models: Iterable[SdfModel], diagnostics: Iterable[Diagnostic]
) -> tuple[Diagnostic, ...]:
    """What has been reported of a model: where its file holds others, by its name."""
    is_alone = sum(other.file == model.file for other in models) == 1
    place = f"/model[@name='{model.name}']"
    return tuple(
        found
        for found in diagnostics
        if found.file == model.file and (is_alone or place in (found.element or ""))
    )


def _completed(
    models: Sequence[SdfModel], context: PrepareContext
) -> tuple[list[Robot], tuple[Diagnostic, ...]]:
    """The robots of the models, with files that engines read.

    The links of all models of one file are completed together: a child process for each of some
    hundred models would take longer than their simulation.
    """
    completed: dict[int, Robot] = {}
    diagnostics: list[Diagnostic] = []
    groups: dict[tuple[Path | None, bool], list[int]] = {}
    for number, model in enumerate(models):
        groups.setdefault((model.file, model.is_static), []).append(number)
    for (file, is_static), numbers in groups.items():
        robots = [robot for number in numbers if (robot := models[number].robot) is not None]
        names = [models[number].name for number in numbers] if len(numbers) > 1 else [None]
        together = Robot(
            name="",
            root="",
            links=tuple(
                link if name is None else replace(link, name=f"{name}::{link.name}")
                for robot, name in zip(robots, names, strict=True)
                for link in robot.links
            ),
            is_static=is_static,
        )
        whole, more = complete_meshes(together, file, context)
        diagnostics += more
        links = iter(whole.links)
        for number, robot in zip(numbers, robots, strict=True):
            own = (replace(next(links), name=link.name) for link in robot.links)
            completed[number] = replace(robot, links=tuple(own))
    return [completed[number] for number in range(len(models))], tuple(diagnostics)


def _too_many(models: int, found: SdfFile) -> Diagnostic:
    return OVERSIZED_SCENE.at(
        found.world.file if found.world else None,
        message=f"The world has {models:,} models: a simulation supports at most {MOST_MODELS:,}.",
        hint="Combine parts that never move into one static model, or split the world.",
    )


def without_taken(
    static_models: Iterable[PreparedRobot], taken: Iterable[str]
) -> list[PreparedRobot]:
    """The static models without those whose names are taken by what is spawned."""
    names = set(taken)
    return [model for model in static_models if model.entity not in names]
