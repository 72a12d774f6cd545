"""Which systems the world of a launch has in Gazebo Sim, and what lacks one there."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.systems import (
    Need,
    Place,
    WorldSystems,
    missing_default_systems,
    missing_sensor_systems,
    needs_of,
    place_of,
    systems_of_shipped,
    systems_of_world,
    systems_within,
)
from wsgen.descriptions.sdf.lookup import is_brought_along
from wsgen.descriptions.sdf.source import load, read_document
from wsgen.gazebo.systems import DEFAULT_SYSTEMS, loaded_class
from wsgen.launching.explain_missing import where_written
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan
    from wsgen.pipeline.started import Started
    from wsgen.text.xmltree import Element


class StartedWorld(NamedTuple):
    """The world that a launch starts in Gazebo Sim, as its systems are concerned."""

    element: Element | None  # None: one that Gazebo brings along
    file: Path | None
    distro: str | None
    defaults: tuple[str, ...]  # the classes in server.config

    def systems(self, *, is_lenient: bool = False) -> WorldSystems | None:
        """Those that it loads; None where that is not known."""
        if self.element is None and self.file is not None:
            return systems_of_shipped(self.file.name)
        return systems_of_world(self.element, self.distro, self.defaults, is_lenient=is_lenient)


def find_started_world(
    started: Started,
    file: Path | None,
    *,
    environment: Mapping[str, str],
    distro: str | None,
) -> StartedWorld | None:
    """The world of a launch; None of Gazebo Classic, and where it is not known.

    Args:
        started: What the launch file starts.
        file: The file of its world, where it has been found.
        environment: That of the launch, with what the launch file sets.
        distro: The distribution, if it is known.
    """
    simulator, defaults = started.simulator, _defaults(environment)
    if simulator is None or simulator.kind != "gz" or defaults is None:
        return None
    if not simulator.world:
        return StartedWorld(None, None, distro, defaults) if simulator.is_world_known else None
    if file is None:
        is_shipped = is_brought_along(simulator.world)
        return StartedWorld(None, Path(simulator.world), distro, defaults) if is_shipped else None
    source = load(file, [])
    world = None if source is None else next(children(source.root, "world"), None)
    return None if world is None else StartedWorld(world, file, distro, defaults)


# Where Gazebo finds its server.config if not in the home directory.
_CONFIG_VARIABLES = ("GZ_SIM_SERVER_CONFIG_PATH", "IGN_GAZEBO_SERVER_CONFIG_PATH")


def _defaults(environment: Mapping[str, str]) -> tuple[str, ...] | None:
    """The classes in server.config; None where that cannot be read."""
    named = next((environment[one] for one in _CONFIG_VARIABLES if environment.get(one)), None)
    if named is None:
        return DEFAULT_SYSTEMS
    source = load(Path(named), [])
    if source is None:
        return None
    plugins = source.root.iter("plugin")
    names = (loaded_class(one.get("filename") or "", one.get("name") or "") for one in plugins)
    return tuple(name for name in names if name)


def check_systems(
    started: Started, world: StartedWorld, files: Collection[Path]
) -> Iterator[Diagnostic]:
    """Report what of the robots and of the world has no system that simulates it.

    `files` are those that the world and what is spawned were read from.
    """
    systems = world.systems(is_lenient=True)
    if systems is None:
        return
    roots = [root for root in _roots(started, files) if root is not world.element]
    needs: list[Need] = []
    within: set[str] = set()
    for root in roots:
        within |= systems_within(root)
        needs += needs_of(root, world.distro)
    if world.element is not None and world.file is not None:
        yield from missing_default_systems(world.element, world.file, systems, is_spawned_into=True)
        place = place_of(world.element, world.file)
    else:
        place = _place_of_start(started.plan, world.file)
    yield from missing_sensor_systems(place, systems, within, needs, is_spawned_into=True)


def _roots(started: Started, files: Collection[Path]) -> Iterator[Element]:
    """The robots that are spawned, and the documents of the world and its models."""
    for text in dict.fromkeys(spawn.description for spawn in started.spawns):
        if "<sensor" in text or "<plugin" in text:
            root, _ = read_document(text)
            if root is not None:
                yield root
    for file in sorted(files):
        source = load(file, [])
        if source is not None:
            yield source.root


def _place_of_start(plan: LaunchPlan, world: Path | None) -> Place:
    """The launch file, at the line that starts Gazebo without a world of the workspace."""
    texts = (*((world.name,) if world else ()), "gz_args", "gz_sim.launch.py", "ros_gz_sim")
    found = (where_written(text, plan.evaluated_files) for text in texts)
    file, line = next((one for one in found if one), (plan.launch_file, None))
    subject = f"The world `{world.name}` of Gazebo" if world else "The empty world of Gazebo"
    return Place(Path(file), line, world.name if world else None, subject, is_file=False)
