"""The checks between a launch file and what it starts: simulator, world, robots, nodes, topics."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules import (
    bridges,
    controllers,
    frames,
    launch_files,
    node_topics,
    robot_files,
    simulators,
    worlds,
)
from wsgen.checks.rules.entities import check_spawn_height
from wsgen.checks.rules.node_topics import topics_of
from wsgen.checks.rules.robots import OVERSIZED_PART
from wsgen.descriptions.sdf.includes import DATABASE_MODELS, MODEL_LEFT_OUT
from wsgen.descriptions.sdf.lookup import find_world, model_finder
from wsgen.descriptions.sdf.source import SIZE_LIMIT, load, read_document
from wsgen.descriptions.xacro.reader import written_elements
from wsgen.gazebo.plugins import carried_by
from wsgen.launching.commands import started_programs
from wsgen.launching.descriptions import Description, published_descriptions, read_published
from wsgen.launching.simulators import WORLD_SUFFIXES, simulator_kinds
from wsgen.packages.source_shares import may_have_sources
from wsgen.packages.workspace.layout import LAUNCH_FILES
from wsgen.text import yamlfile
from wsgen.text.files import bytes_or_empty, real_path
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.checks.rules.node_topics import GazeboTopic
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.package import ShareOf
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.started import Started
    from wsgen.text.xmltree import Element


class LoadedWorld(NamedTuple):
    """The world that a simulator loads."""

    name: str
    element: Element
    plugins: tuple[str, ...]  # file names
    models: tuple[str, ...] | None  # names; None where not all are known


def check_launched(  # noqa: PLR0913  most have defaults
    started: Started,
    environment: Mapping[str, str],
    beside: Sequence[LaunchPlan] = (),
    *,
    is_included: bool = False,
    is_known: Callable[[str], bool] = lambda _package: False,
    distro: str | None = None,
    is_installed: Callable[[str], bool] = lambda _package: True,
    may_publish: Callable[[str], bool] = lambda _package: True,
) -> Iterator[Diagnostic]:
    """Check what a launch file starts together.

    Args:
        started: What it starts.
        environment: That of the launch.
        beside: The plans of the other launch files of the package, which may be started from
            another terminal.
        is_included: One of these includes it: what it lacks may be there.
        is_known: Whether all that a package installs is known.
        distro: The target, if it is known.
        is_installed: Whether a package is on this machine or in the workspace.
        may_publish: Whether a node of a package may publish joint states.
    """
    plan = started.plan
    kinds = simulator_kinds(plan)
    world = _loaded_world(started, environment)
    name = world.name if world and kinds == {"gz"} else None
    lacks_classic = tuple(simulators.no_classic(plan, distro, is_installed))
    yield from lacks_classic or simulators.spawners_of_other_simulator(plan, kinds)
    yield from simulators.no_factory(
        plan, kinds, world.plugins if world else None if _names_world(started) else ()
    )
    yield from simulators.wall_clocks(plan, kinds)
    yield from simulators.other_worlds(plan, name)
    yield from simulators.glued_arguments(plan)
    yield from launch_files.missing_argument_files(plan, is_known)
    yield from launch_files.unused_declared_arguments(plan)
    yield from launch_files.ros_1_commands(plan)
    yield from simulators.starts_paused(plan, kinds, world.element if world else None)
    found = bridges.find_bridges(plan)
    yield from found.diagnostics
    lacks_clock = tuple(simulators.no_clock(plan, kinds, found.published))
    if lacks_clock and not (
        is_included or any(bridges.may_bring_clock(bridges.find_bridges(other)) for other in beside)
    ):
        yield from lacks_clock
    files = {
        file: _parameters(file) for file in controllers.parameter_files(_descriptions(started))
    }
    yield from controllers.former_spawners(plan, distro)
    yield from controllers.unknown_controllers(plan, controllers.find_configured(plan, files))
    started_here = frozenset(controllers.started_controllers(plan))
    for file, content in files.items():
        if content is None:
            yield from launch_files.malformed_parameter_files(file)
        else:
            yield from controllers.unknown_types(file, content, started_here)
    if not is_included:
        broadcasters = {
            name
            for content in files.values()
            if content is not None
            for name, value in controllers.managed_types(content)
            if (value.text or "").endswith("JointStateBroadcaster")
        }
        yield from _check_joint_states(started, beside, may_publish, broadcasters)
    if found.topics:
        yield from bridges.check_bridges(
            found.topics,
            tuple(_topics(started, world)),
            world=name,
            models=_models(started, world),
        )


def topics_of_launch(
    started: Started, nodes: Collection[tuple[str | None, str | None]]
) -> node_topics.Graph:
    """The topics of what a launch file starts, but for its Python nodes, which `nodes` names."""
    robots = tuple(_descriptions(started))
    files = {file: _parameters(file) for file in controllers.parameter_files(robots)}
    found = bridges.find_bridges(started.plan)
    graph = node_topics.graph_of(started.plan, found.topics, robots, files, nodes)
    return graph._replace(is_whole=graph.is_whole and found.are_all)


def _check_joint_states(
    started: Started,
    beside: Iterable[LaunchPlan],
    may_publish: Callable[[str], bool],
    broadcasters: Collection[str],
) -> Iterator[Diagnostic]:
    """Check who publishes joint states; what has no publisher of transforms may be started, too."""
    for other in beside:
        providers = frames.find_providers(other, may_publish, broadcasters)
        has_some = providers.publish_all or providers.bridged or simulator_kinds(other)
        if not providers.starts_publisher and (has_some or not providers.is_known):
            return
    plan = started.plan
    robots = []
    for publisher in published_descriptions(plan).values():
        robot = read_published(plan, publisher)
        root = read_document(robot.text)[0] if isinstance(robot, Description) else None
        if root is not None:
            robots.append((publisher, root))
    if any(next(frames.movable_joints(root), None) for _, root in robots):
        yield from frames.no_joint_states(
            plan,
            robots,
            [*_descriptions(started)]
            if started.spawns and all(spawn.description for spawn in started.spawns)
            else [],
            frames.find_providers(plan, may_publish, broadcasters),
        )


def may_publish_joint_states(packages: Iterable[PackageFolder]) -> Callable[[str], bool]:
    """Whether a node of a package may publish joint states, by the sources of the workspace."""
    known: dict[str, bool] = {}
    folders = {one.name: one.path for one in packages}

    def may_publish(package: str) -> bool:
        if package not in folders:
            return True
        if package not in known:
            files = _files(folders[package], (".py", ".cpp", ".cc", ".hpp", ".h", ".rs"))
            known[package] = any(
                b"JointState" in bytes_or_empty(file, SIZE_LIMIT) for file in files
            )
        return known[package]

    return may_publish


def check_addresses(started: Started, share_of: ShareOf) -> Iterator[Diagnostic]:
    """Check the addresses of meshes in what a launch file publishes for RViz and Gazebo."""
    plan = started.plan
    shows = any(one.executable == robot_files.RVIZ for one in started_programs(plan))
    for publisher in published_descriptions(plan).values():
        robot = read_published(plan, publisher)
        if not isinstance(robot, Description) or robot.file is None:
            continue
        addresses = robot_files.mesh_addresses(robot.text)
        if all(one.startswith(("package://", "file://")) for one in addresses):
            continue
        written = written_elements(robot.file, share_of)
        yield from robot_files.relative_addresses(addresses, robot.file, written)
        if shows:
            yield from robot_files.model_addresses(addresses, robot.file, written)


def check_heights(
    started: Started,
    world: World | None,
    scene: Sequence[PreparedRobot],
    found: Iterable[Diagnostic],
) -> Iterator[Diagnostic]:
    """Check how high robots are spawned, where all that is in the world is known.

    `found` is what is reported of the world and the robots.
    """
    simulator = started.simulator
    if world is None or simulator is None or not world.has_ground_plane:
        return
    is_here = world.file is not None or not simulator.world
    if not is_here or any(one.code in _OTHER_HEIGHT for one in found):
        return
    is_bare = not any(one.is_static_model or one.may_move for one in scene)
    for one in scene:
        is_model = one.is_static_model or one.may_move or one.on_the_ground
        if one.can_run and not is_model and carried_by(one.lumped, world) is None:
            yield from check_spawn_height(
                one.lumped, one.spawn_pose, one.height, entity=one.entity, is_bare=is_bare
            )


# The world lacks a model, or a size of the robot is in other units.
_OTHER_HEIGHT = frozenset((MODEL_LEFT_OUT.code, DATABASE_MODELS.code, OVERSIZED_PART.code))


def check_worlds(  # noqa: PLR0913  one of them has a default
    files: Iterable[Path],
    loaded: Mapping[Path, Loaded],
    environment: Mapping[str, str],
    *,
    simulator: str | None,
    distro: str | None,
    spawned_into: Collection[str] = (),
) -> Iterator[Diagnostic]:
    """Check the worlds of a package for the simulators that load them.

    Args:
        files: Robots, models and worlds.
        loaded: How launch files load a world, by its real path.
        environment: That of a world which no launch file loads.
        simulator: That of the other launch files.
        distro: The target.
        spawned_into: The real paths of worlds that launch files spawn robots into.
    """
    for file in files:
        if file.suffix not in WORLD_SUFFIXES or b"<world" not in bytes_or_empty(file, SIZE_LIMIT):
            continue
        source = load(file, [])
        if source is None:
            continue
        real = real_path(file)
        here = loaded.get(Path(real))
        has_model = _has_model(file, here.environment if here else environment)
        yield from worlds.check_world(
            source.root,
            file,
            simulator=here.kind if here else simulator,
            distro=distro,
            is_spawned_into=real in spawned_into,
            has_model=has_model,
        )


def _has_model(file: Path, environment: Mapping[str, str]) -> Callable[[str], bool]:
    find = model_finder(file, environment)
    return lambda uri: find(uri) is not None


class Loaded(NamedTuple):
    """How a launch file loads a world."""

    kind: str | None  # of the simulator; None: of both
    environment: Mapping[str, str]


def loaded_worlds(
    all_started: Iterable[Started], environment: Mapping[str, str]
) -> dict[Path, Loaded]:
    """How launch files load worlds, by real path."""
    loaded: dict[Path, Loaded] = {}
    for started in all_started:
        simulator = started.simulator
        variables = {**environment, **started.plan.environment}
        file = find_world(simulator.world, variables) if simulator and simulator.world else None
        if file is not None and simulator is not None:
            real = Path(real_path(file))
            other = loaded.get(real)
            is_same = other is None or other.kind == simulator.kind
            loaded[real] = Loaded(simulator.kind if is_same else None, variables)
    return loaded


def check_texts(
    package: PackageFolder, robots: Collection[Robot], plans: Collection[LaunchPlan]
) -> Iterator[Diagnostic]:
    """Check what the launch files and parameter files of a package write.

    `robots` and `plans` are those of the package, for the frames that exist.
    """
    links, known = frames.links_of(robots), frames.known_frames(robots, plans)
    of_ros_1: list[Path] = []
    started = {name for plan in plans for name in controllers.started_controllers(plan)}
    for file in _files(package.path, (".launch", *LAUNCH_FILES, ".rviz", ".yaml", ".yml")):
        if file.suffix == ".launch":
            of_ros_1.append(file)
        elif file.name.endswith(LAUNCH_FILES):
            yield from _check_paths(file, bytes_or_empty(file, SIZE_LIMIT))
        elif file.suffix in {".rviz", ".yaml", ".yml"}:
            content = bytes_or_empty(file, SIZE_LIMIT)
            yield from _check_frames(file, content, links, known)
            if file.suffix != ".rviz":
                yield from _check_paths(file, content)
                yield from _check_controllers(file, content, started)
                yield from launch_files.malformed_parameter_files(file, content)
    if package.build_type != "catkin":
        yield from launch_files.ros_1_launch_files(of_ros_1)


def _files(package: Path, endings: tuple[str, ...]) -> Iterator[Path]:
    """The files of a package whose names end like this."""
    for folder, names, files in os.walk(package):
        names[:] = filter(may_have_sources, names)
        yield from (Path(folder, name) for name in sorted(files) if name.endswith(endings))


def _check_paths(file: Path, content: bytes) -> Iterator[Diagnostic]:
    if b"/home/" in content or b"/Users/" in content:
        yield from launch_files.home_paths(file)


def _check_controllers(
    file: Path, content: bytes, started: Collection[str]
) -> Iterator[Diagnostic]:
    parameters = _parameters(file) if b"controller_manager" in content else None
    if parameters is not None:
        yield from controllers.unknown_types(file, parameters, started)


def _check_frames(
    file: Path, content: bytes, links: Collection[str], known: Collection[str] | None
) -> Iterator[Diagnostic]:
    if known is not None:
        text = content.decode(errors="replace")
        yield from frames.frames_without_links(file, text, links, known)


def _names_world(started: Started) -> bool:
    return started.simulator is not None and bool(started.simulator.world)


def _loaded_world(started: Started, environment: Mapping[str, str]) -> LoadedWorld | None:
    """The world of the simulator that the plan starts, if its file is here."""
    simulator = started.simulator
    if simulator is None or not simulator.world:
        return None
    file = find_world(simulator.world, {**environment, **started.plan.environment})
    source = load(file, []) if file is not None and file.is_file() else None
    world = None if source is None else next(children(source.root, "world"), None)
    if world is None or not world.get("name"):
        return None
    includes = [child_text(one, "name") for one in children(world, "include")]
    models = [one.get("name") for one in children(world, "model")]
    return LoadedWorld(
        name=world.get("name") or "",
        element=world,
        plugins=tuple(one.get("filename") or "" for one in world.iter("plugin")),
        models=None if None in includes else tuple(filter(None, (*includes, *models))),
    )


def _descriptions(started: Started) -> Iterator[Element]:
    """The robots that a plan spawns or publishes."""
    plan = started.plan
    published = (
        one.text
        for publisher in published_descriptions(plan).values()
        if isinstance(one := read_published(plan, publisher), Description)
    )
    texts = (*(spawn.description for spawn in started.spawns), *published)
    for text in dict.fromkeys(filter(None, texts)):
        root, _ = read_document(text)
        if root is not None:
            yield root


def _parameters(file: Path) -> yamlfile.Value | None:
    content = yamlfile.load_parameters(file)
    return content if isinstance(content, yamlfile.Value) else None


def _topics(started: Started, world: LoadedWorld | None) -> Iterator[GazeboTopic]:
    name = world.name if world else None
    for spawn in started.spawns:
        root, _ = read_document(spawn.description) if spawn.description else (None, ())
        if root is not None:
            yield from topics_of(root, spawn.entity, name)
    for model in children(world.element, "model") if world else ():
        yield from topics_of(model, model.get("name"), name)


def _models(started: Started, world: LoadedWorld | None) -> tuple[str, ...] | None:
    """The names of all models; None where not all are known."""
    plan = started.plan
    is_known = plan.is_complete and not plan.unresolved and started.spawns
    if world is None or world.models is None or not is_known:
        return None
    return (*world.models, *(spawn.entity for spawn in started.spawns))
