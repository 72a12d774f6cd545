"""An SDF file to robots: the models in it, and the world around them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.world.contents import Contents
from wsgen.world.included import Includes
from wsgen.world.inhabitants import SdfModel, read_inhabitants, read_standing
from wsgen.world.reader import check_is_carried, describe_world
from wsgen.world.source import load, parse, with_version
from wsgen.xmltree import children

__all__ = ["SdfFile", "SdfModel", "read_model", "read_sdf"]

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.pose import Pose
    from wsgen.model.world import World
    from wsgen.world.included import ReadRobot
    from wsgen.world.source import Source
    from wsgen.xmltree import Element


class SdfFile(NamedTuple):
    """What an SDF file holds."""

    world: World | None = None  # None: a single model, or nothing that can be used
    models: tuple[SdfModel, ...] = ()  # but for sun and ground, which are in `world`
    diagnostics: tuple[Diagnostic, ...] = ()


def read_sdf(
    file: Path,
    *,
    find_model: Callable[[str], Path | None],
    read_robot: ReadRobot | None = None,
) -> SdfFile:
    """Read a world or a model file, with the models that it includes.

    All numbers of the robots are finite, also where the diagnostics have errors: what could not be
    read is left out.

    Args:
        file: The file, whatever it is.
        find_model: Gives the folder of the model (or package) that `model://NAME` or an address of
            Fuel stands for, and None where there is none; see `wsgen.world.lookup.model_finder`.
        read_robot: Reads a URDF file that is included in a world, as Gazebo has it. Without it such
            a model is left out, with a diagnostic.
    """
    diagnostics: list[Diagnostic] = []
    source = load(file, diagnostics)
    includes = Includes(find_model, diagnostics, read_robot)
    return _finished(diagnostics, None if source is None else _read(source, includes))


def read_model(
    content: str | bytes,
    *,
    file: Path | None,
    find_model: Callable[[str], Path | None],
    pose_in_world: Pose | None = None,
) -> SdfFile:
    """Read the text of a model that is spawned; only one that has no world is taken.

    Args:
        content: SDF; bytes where it is the file itself, for its own encoding to count.
        file: Where the text comes from, for diagnostics and relative paths.
        find_model: As for `read_sdf`.
        pose_in_world: Where it is spawned; None: at the pose that the model gives itself.
    """
    diagnostics: list[Diagnostic] = []
    source = parse(content, file, diagnostics)
    includes = Includes(find_model, diagnostics)
    return _finished(
        diagnostics, None if source is None else _read_spawned(source, includes, pose_in_world)
    )


def _finished(diagnostics: list[Diagnostic], found: SdfFile | None) -> SdfFile:
    # A model that is included twice is wrong once.
    return (found or SdfFile())._replace(diagnostics=tuple(dict.fromkeys(diagnostics)))


def _read(source: Source, includes: Includes) -> SdfFile | None:
    element = _chosen(source)
    if element is None:
        return None
    source = with_version(source)
    if element.tag == "world":
        return _read_world(source, element, includes)
    return SdfFile(models=_alone(source, element, includes, None))


def _read_spawned(source: Source, includes: Includes, pose: Pose | None) -> SdfFile | None:
    light = next(children(source.root, "light", "actor"), None)
    if light is not None and next(children(source.root, "world", "model"), None) is None:
        source.info(
            "WLD042",
            f"It is a {light.tag} that is spawned: there is nothing to try.",
            at=light,
            hint="Nothing needs to be done.",
        )
        return None
    element = _chosen(source)
    if element is None:
        return None
    if element.tag == "world":
        source.error(
            "WLD043",
            f"The world `{element.get('name') or ''}` is spawned, and spawners take models.",
            at=element,
            hint="Start the simulator with the world, and spawn a file of <sdf><model>.",
        )
        return None
    return SdfFile(models=_alone(with_version(source), element, includes, pose))


def _chosen(source: Source) -> Element | None:
    """The world or model that is read; that there is none, or more, is reported."""
    found = list(children(source.root, "world", "model")) if source.root.tag == "sdf" else []
    if not found:
        source.missing(
            "WLD003",
            "There is neither a <world> nor a <model> here."
            if source.root.tag == "sdf"
            else "There is neither a <world> nor a <model> in an <sdf> here; "
            f"the root element is <{source.root.tag}>.",
            at=source.root,
            name="model" if (source.root, "model") in source.misspelt else "world",
            hint='A world file is <sdf version="1.5"><world name="..."> ... </world></sdf>.',
        )
        return None
    first = next((element for element in found if element.tag == "world"), found[0])
    if len(found) > 1:
        # Gazebo's parser takes the first model and fails; of worlds it reads all.
        report = source.error if first.tag == "model" else source.warning
        report(
            "WLD038",
            f"The file holds {len(found)} worlds and models; "
            f"only the {first.tag} `{first.get('name')}` is read.",
            at=next(element for element in found if element is not first),
            hint="Put several models into one world, or into a file each.",
        )
    return first


def _alone(
    source: Source, element: Element, includes: Includes, pose: Pose | None
) -> tuple[SdfModel, ...]:
    place = Contents(includes).alone(source, element)
    for node in place.own("model"):
        if pose is not None:
            node.pose, node.relative_to = pose, ""
    return tuple(read_standing(includes, node) for node in place.own("model"))


def _read_world(source: Source, element: Element, includes: Includes) -> SdfFile:
    if not element.get("name"):
        source.error(
            "WLD013",
            "The world has no name.",
            at=element,
            hint='Write <world name="NAME">; Gazebo Sim refuses the file without.',
        )
    inhabitants = read_inhabitants(Contents(includes).world(source, element), includes)
    world = describe_world(source, element, inhabitants.placed, has_ground=inhabitants.has_ground)
    if not inhabitants.carry:
        if includes.blame_misspelt_ground():
            world = replace(world, has_ground_plane=True)  # what was meant, for the trial
        check_is_carried(source, element, world)
    return SdfFile(world=world, models=inhabitants.models)
