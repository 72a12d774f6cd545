"""The rules about the systems of Gazebo Sim that a world loads, and what works only with them.

Source: gazebosim/gz-sim, src/SimulationRunner.cc (which systems a world has), src/systems (what
they do). The names are in `wsgen.gazebo`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.sdf.source import line_of, path_of
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.plugins import PLUGINS, GazeboPlugin, stem
from wsgen.gazebo.sensors import RAYS, SYSTEM_OF_SENSOR, WITH_RAYS
from wsgen.gazebo.systems import (
    DEFAULT_SYSTEMS,
    OF_SHIPPED_WORLDS,
    WITH_MERGED_DEFAULTS,
    is_of_classic,
    loaded_class,
    plugin_of,
    remark_on,
)
from wsgen.model.target import SIMULATORS
from wsgen.text.suggestions import some_of
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.text.xmltree import Element


MISSING_SYSTEM = Rule(
    code="WLD063",
    name="missing-system-plugin",
    severity=Severity.ERROR,
    severity_varies="a warning where only `SceneBroadcaster` is missing or the distribution is not "
    "known; information where no launch file of the package spawns a robot into the world",
    summary="A world loads some systems of Gazebo Sim but lacks one that every simulation needs.",
    what="Looks for `Physics`, `UserCommands` and `SceneBroadcaster` in a world with a `<plugin>`. "
    "Not checked from Kilted on, whose Gazebo adds them, unless "
    "`<include_server_config_plugins>` is false.",
    why="Up to Gazebo Harmonic, a world with any system does not load the default systems. Without "
    "`Physics` nothing moves, without `UserCommands` nothing can be spawned, and without "
    "`SceneBroadcaster` the window stays empty.",
    example='<world name="w">\n'
    '  <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>\n'
    "</world>",
    instead='<world name="w">\n'
    '  <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>\n'
    '  <plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>\n'
    '  <plugin filename="gz-sim-scene-broadcaster-system"\n'
    '    name="gz::sim::systems::SceneBroadcaster"/>\n'
    "</world>",
)
MISSING_SENSOR_SYSTEM = Rule(
    code="WLD072",
    name="missing-sensor-system",
    severity=Severity.ERROR,
    severity_varies="a warning where no launch file of the package spawns a robot into the world",
    summary="A sensor publishes nothing: neither the world nor a robot loads its system.",
    what="Looks for the systems of the sensors of spawned robots and of the models of a world, and "
    "of some plugins, in the world that a launch file starts in Gazebo Sim, in its models, in the "
    "robots, and in the file of GZ_SIM_SERVER_CONFIG_PATH.",
    why="The robot only describes a sensor; a system of Gazebo Sim simulates it. Gazebo does not "
    "load these systems by default and prints no error: the topic stays empty.",
    example='<!-- loaded with a robot that has <sensor name="lidar" type="gpu_lidar"> -->\n'
    '<world name="w">\n'
    '  <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>\n'
    "</world>",
    instead='<world name="w">\n'
    '  <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>\n'
    '  <plugin filename="gz-sim-sensors-system" name="gz::sim::systems::Sensors"/>\n'
    "</world>",
)

_WITHOUT = {
    "Physics": "nothing in it moves",
    "UserCommands": "robots cannot be spawned into it",
    "SceneBroadcaster": "the window shows nothing",
}


class Need(NamedTuple):
    """What works only with a system."""

    system: str  # its class
    owner: str  # "the sensor `lidar`"


class WorldSystems(NamedTuple):
    """The systems that a world has from the beginning."""

    loaded: frozenset[str]  # their classes; those of somebody's own are not among them
    has_own: bool = False  # it loads some itself, and no default ones beside them
    are_replaced: bool = False  # they are the default ones, which any <plugin> would replace
    # Whether the default ones are there is not known: it depends on the distribution.
    may_merge: bool = False


def systems_of_world(
    world: Element | None,
    distro: str | None,
    defaults: Collection[str] = DEFAULT_SYSTEMS,
    *,
    is_lenient: bool = False,
) -> WorldSystems:
    """The systems that Gazebo Sim loads for a world.

    Args:
        world: A `<world>`; None for the one that Gazebo has without a file.
        distro: The distribution, if it is known.
        defaults: The classes in server.config.
        is_lenient: A misspelled name counts as what is meant, which is reported as such.
    """
    plugins = () if world is None else tuple(children(world, "plugin"))
    classes = [one for plugin in plugins if (one := _class_of(plugin, is_lenient=is_lenient))]
    is_merging = distro in WITH_MERGED_DEFAULTS and world is not None and _merges(world)
    if not classes or is_merging:
        return WorldSystems(frozenset((*classes, *defaults)), are_replaced=not is_merging)
    return WorldSystems(frozenset(classes), has_own=True, may_merge=distro is None)


def systems_of_shipped(name: str) -> WorldSystems | None:
    """The systems of a world that Gazebo ships, by its file name; None where it is not known."""
    systems = OF_SHIPPED_WORLDS.get(name)
    return None if systems is None else WorldSystems(frozenset(systems))


def _class_of(plugin: Element, *, is_lenient: bool) -> str:
    """The class that a plugin loads, or its file; empty where Gazebo Sim loads nothing."""
    filename, name = plugin.get("filename") or "", plugin.get("name") or ""
    remark = remark_on(filename, name)
    if remark is not None and not is_lenient:
        return ""
    if remark is not None:
        filename, name = (remark.meant, "") if remark.is_filename else (filename, remark.meant)
    return "" if is_of_classic(filename) else loaded_class(filename, name) or filename


def _merges(world: Element) -> bool:
    policies = next((one for one in world if str(one.tag).endswith("policies")), None)
    text = None if policies is None else child_text(policies, "include_server_config_plugins")
    return (text or "true").lower() not in {"false", "0"}


def systems_within(root: Element) -> set[str]:
    """The classes of the systems that robots and models load, as far as they work there."""
    plugins = (one for one in root.iter("plugin") if _tag_above(one) != "world")
    return {_class_of(one, is_lenient=True) for one in plugins}.difference(DEFAULT_SYSTEMS)


def _tag_above(element: Element) -> str:
    above = element.getparent()
    return "" if above is None else str(above.tag)


def needs_of(root: Element, distro: str | None) -> Iterator[Need]:
    """What in a robot, a model or the models of a world needs which systems."""
    for sensor in root.iter("sensor"):
        above, kind = sensor.getparent(), sensor.get("type") or ""
        # What Gazebo never simulates is reported by itself.
        is_ignored = above is not None and above.tag == "gazebo" and not above.get("reference")
        if (
            kind in SYSTEM_OF_SENSOR
            and not is_ignored
            and (kind not in RAYS or distro in WITH_RAYS)
        ):
            yield Need(SYSTEM_OF_SENSOR[kind], f"the sensor `{sensor.get('name')}`")
    for plugin in root.iter("plugin"):
        filename = plugin.get("filename") or ""
        for system in PLUGINS.get(stem(filename), GazeboPlugin()).needs:
            yield Need(system, f"the plugin `{filename}`")


def missing_default_systems(
    world: Element,
    file: Path,
    systems: WorldSystems,
    *,
    is_spawned_into: bool,
) -> Iterator[Diagnostic]:
    """Report a world that loads systems and lacks one that every simulation needs."""
    lacking = [name for name in DEFAULT_SYSTEMS if name not in systems.loaded]
    own = [one.get("filename") or "" for one in children(world, "plugin")]
    if not systems.has_own or not lacking:
        return
    if len(lacking) == len(DEFAULT_SYSTEMS) and not any(_is_of_gz(name) for name in own):
        return  # plugins of somebody's own, for a simulator that is not known
    names = " and ".join(lacking) if len(lacking) < len(DEFAULT_SYSTEMS) else ", ".join(lacking)
    causes = "; ".join(f"without {name} {_WITHOUT[name]}" for name in lacking)
    until = " up to Gazebo Harmonic" if systems.may_merge else ""
    is_harmless = systems.may_merge or lacking == ["SceneBroadcaster"]
    yield MISSING_SYSTEM.at(
        file,
        line_of(next(children(world, "plugin"))),
        path_of(world),
        message=f"The world loads some systems but not {names}{until}: {causes}.",
        hint=f"Add {' '.join(map(plugin_of, lacking))}",
        severity=Severity.INFO
        if not is_spawned_into
        else Severity.WARNING
        if is_harmless
        else None,
    )


def _is_of_gz(filename: str) -> bool:
    return loaded_class(filename, "") is not None


class Place(NamedTuple):
    """Where a world is written, or the launch file that starts Gazebo without one."""

    file: Path | None
    line: int | None
    element: str | None
    subject: str  # "The world `office`"
    is_file: bool = True  # of a world, that somebody may add a plugin to


def place_of(world: Element, file: Path) -> Place:
    """Where a plugin of a world is to be added."""
    first = next(children(world, "plugin"), world)
    return Place(file, line_of(first), path_of(world), f"The world `{world.get('name')}`")


def missing_sensor_systems(
    place: Place,
    systems: WorldSystems,
    within: Collection[str],
    needs: Iterable[Need],
    *,
    is_spawned_into: bool,
) -> Iterator[Diagnostic]:
    """Report, once for each system that is missing, what sends nothing without it.

    `within` are the systems that robots and models load.
    """
    owners: dict[str, list[str]] = {}
    for need in needs:
        is_there = need.system in systems.loaded or need.system in within
        if not is_there and need.system not in DEFAULT_SYSTEMS:
            owners.setdefault(need.system, []).append(need.owner)
    for system, found in owners.items():
        names = list(dict.fromkeys(found))
        plugin = plugin_of(system)
        others = DEFAULT_SYSTEMS if systems.are_replaced else ()
        yield MISSING_SENSOR_SYSTEM.at(
            place.file,
            place.line,
            place.element,
            message=f"{place.subject} does not load the system {system}: {some_of(names)} "
            f"{'publishes' if len(names) == 1 else 'publish'} nothing.",
            hint=f"Add {' '.join((*map(plugin_of, others), plugin))} to the <world>."
            if place.is_file
            else f"Add <gazebo>{plugin}</gazebo> to the robot, or start {SIMULATORS['gz']} "
            "with a world file that loads it.",
            severity=None if is_spawned_into else Severity.WARNING,
        )
