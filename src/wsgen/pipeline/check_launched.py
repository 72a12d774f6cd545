"""The checks between a launch file and what it starts: simulator, world, robots, nodes, topics."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen import yamlfile
from wsgen.launch.descriptions import Description, published_descriptions, read_published
from wsgen.launch.simulators import simulator_kinds
from wsgen.rules import bridges, controllers, simulators
from wsgen.rules.gazebo_topics import topics_of
from wsgen.sdf.lookup import find_world
from wsgen.sdf.source import load, read_document
from wsgen.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.started import Started
    from wsgen.rules.gazebo_topics import GazeboTopic
    from wsgen.xmltree import Element


class LoadedWorld(NamedTuple):
    """The world that a simulator loads."""

    name: str
    element: Element
    plugins: tuple[str, ...]  # file names
    models: tuple[str, ...] | None  # names; None where not all are known


def check_launched(started: Started, environment: Mapping[str, str]) -> Iterator[Diagnostic]:
    """Check what a launch file starts together; `environment` is that of the launch."""
    plan = started.plan
    kinds = simulator_kinds(plan)
    world = _loaded_world(started, environment)
    yield from simulators.spawners_of_other_simulator(plan, kinds)
    yield from simulators.no_factory(
        plan, kinds, world.plugins if world else None if _names_world(started) else ()
    )
    yield from simulators.wall_clocks(plan, kinds)
    yield from simulators.other_worlds(plan, world.name if world and kinds == {"gz"} else None)
    yield from simulators.glued_arguments(plan)
    yield from simulators.starts_paused(plan, kinds, world.element if world else None)
    found = bridges.find_bridges(plan)
    yield from found.diagnostics
    yield from simulators.no_clock(plan, kinds, found.published)
    files = {file: _yaml(file) for file in controllers.parameter_files(_descriptions(started))}
    yield from controllers.unknown_controllers(plan, controllers.find_configured(plan, files))
    if found.topics:
        yield from bridges.check_bridges(
            found.topics,
            tuple(_topics(started, world)),
            world=world.name if world and kinds == {"gz"} else None,
            models=_models(started, world),
        )


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


def _yaml(file: Path) -> yamlfile.Value | None:
    content = yamlfile.load(file)
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
