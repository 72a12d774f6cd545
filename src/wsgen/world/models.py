"""An SDF file to robots: the models in it, and the world around them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.transform import compose, rotate, rotation_of_rpy
from wsgen.model.world import PlacedModel
from wsgen.world.assembly import assemble
from wsgen.world.contents import Contents
from wsgen.world.frames import resolve
from wsgen.world.included import GROUND_PLANE, Includes
from wsgen.world.reader import check_ground, check_is_carried, describe_world
from wsgen.world.shapes import is_only_ground
from wsgen.world.source import line_of, load, with_version
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.world.assembly import Assembled
    from wsgen.world.scopes import Node, Scope
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

UPRIGHT = math.cos(math.radians(45))  # a plane that is steeper is a wall
LEVEL = 1e-6  # m or rad: what rounding leaves


@dataclass(frozen=True, kw_only=True)
class SdfModel:
    """A model of an SDF file."""

    name: str
    robot: Robot | None  # None: it has no link
    pose_in_world: Pose = IDENTITY  # of the root link's frame; without a world, where it stands
    is_static: bool = False
    file: Path  # that the model is written in
    line: int | None = None  # of its element in that file, 1-based


@dataclass(frozen=True, kw_only=True)
class SdfFile:
    """What an SDF file holds."""

    world: World | None = None  # None: a single model, or nothing that can be used
    models: tuple[SdfModel, ...] = ()  # but for sun and ground, which are in `world`
    diagnostics: tuple[Diagnostic, ...] = ()


def read_sdf(file: Path, *, find_model: Callable[[str], Path | None]) -> SdfFile:
    """Read a world or a model file, with the models that it includes.

    `find_model` gives the folder of the model (or package) that `model://NAME` stands for, and None
    where there is none; see `wsgen.world.lookup.model_finder`. All numbers of the robots are
    finite, also where the diagnostics have errors: what could not be read is left out.
    """
    diagnostics: list[Diagnostic] = []
    world, models = _read(file, diagnostics, Includes(find_model, diagnostics))
    # A model that is included twice is wrong once.
    return SdfFile(world=world, models=models, diagnostics=tuple(dict.fromkeys(diagnostics)))


def _read(
    file: Path, diagnostics: list[Diagnostic], includes: Includes
) -> tuple[World | None, tuple[SdfModel, ...]]:
    source = load(file, diagnostics)
    if source is None:
        return None, ()
    found = list(children(source.root, "world", "model")) if source.root.tag == "sdf" else []
    if not found:
        source.error(
            "WLD003",
            "There is neither a <world> nor a <model> in an <sdf> here; "
            f"the root element is <{source.root.tag}>.",
            at=source.root,
            hint='A world file is <sdf version="1.5"><world name="..."> ... </world></sdf>.',
        )
        return None, ()
    source = with_version(source)
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
    contents = Contents(includes)
    if first.tag == "world":
        if not first.get("name"):
            source.error(
                "WLD013",
                "The world has no name.",
                at=first,
                hint='Write <world name="NAME">; Gazebo Sim refuses the file without.',
            )
        return _read_world(source, first, contents)
    place = contents.alone(source, first)
    return None, tuple(
        _model(node, assemble(includes, node.inside))
        for node in place.own("model")
        if node.inside is not None
    )


def _read_world(
    source: Source, element: Element, contents: Contents
) -> tuple[World, tuple[SdfModel, ...]]:
    scope = contents.world(source, element)
    for node in scope.nodes.values():
        resolve(node)
    models, placed, has_ground = [], [], False
    for node in scope.own("model"):
        if node.inside is None:  # the ground plane, by its address
            has_ground = True
            pose = resolve(node)
            check_ground(source, node.element, pose.xyz[2], pose.rpy[:2])
            name = GROUND_PLANE
            placed.append(PlacedModel(name=name, uri=node.uri, pose_in_world=pose, is_static=True))
            continue
        assembled = assemble(contents.includes, node.inside)
        has_ground |= _has_ground(node, assembled)
        placed.append(
            PlacedModel(
                name=node.name,
                uri=node.uri,
                pose_in_world=resolve(node),
                is_static=node.inside.is_static,
            )
        )
        if not is_only_ground(node.source, node.element):
            models.append(_model(node, assembled))
    _report_left_out(source, scope)
    world = describe_world(source, element, placed, has_ground=has_ground)
    carries = any(
        model.is_static and model.robot and any(link.collisions for link in model.robot.links)
        for model in models
    )
    if not carries:
        check_is_carried(source, element, world)
    return world, tuple(models)


def _model(node: Node, assembled: Assembled) -> SdfModel:
    return SdfModel(
        name=node.name,
        robot=assembled.robot,
        pose_in_world=compose(resolve(node), assembled.root_in_model),
        is_static=node.inside is not None and node.inside.is_static,
        file=node.source.file,
        line=line_of(node.element),
    )


def _has_ground(node: Node, assembled: Assembled) -> bool:
    """Whether a plane of a model is the ground; what is wrong with its planes is reported."""
    has_ground = False
    for plane, link_in_model in assembled.planes:
        pose = compose(resolve(node), compose(link_in_model, plane.pose_in_link))
        link_in_world = compose(resolve(node), link_in_model)
        normal = rotate(rotation_of_rpy(link_in_world.rpy), plane.normal)
        length = math.hypot(*normal)
        if (
            length == 0
            or normal[2] < UPRIGHT * length
            or not (node.inside and node.inside.is_static)
        ):
            node.source.warning(
                "WLD031",
                f"The plane of the model `{node.name}` is left out of the trial: "
                "only one that is static and level can be the ground.",
                at=plane.element,
                hint="Make a wall of a thin box.",
            )
            continue
        has_ground = True
        x, y, z = (part / length for part in normal)
        if math.hypot(x, y) > LEVEL or abs(pose.xyz[2]) > LEVEL:
            tilt = (math.atan2(0.0 - y, z), math.atan2(x, z))
            check_ground(node.source, plane.element, pose.xyz[2], tilt)
    return has_ground


def _report_left_out(source: Source, scope: Scope) -> None:
    for element in children(scope.element, "joint", "population", "actor"):
        source.warning(
            "WLD004",
            f"The {element.tag} {element.get('name') or ''} of the world is not part of the trial.",
            at=element,
            hint="The robots are tried without it.",
        )
