"""The models that stand in a world."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.transform import compose
from wsgen.model.world import PlacedModel
from wsgen.world.frames import is_level_at_zero, resolve
from wsgen.world.included import is_ground_plane
from wsgen.world.source import line_of
from wsgen.xmltree import children

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Robot
    from wsgen.world.included import Includes
    from wsgen.world.scopes import Node, Scope


class SdfModel(NamedTuple):
    """A model of an SDF file."""

    name: str
    robot: Robot | None  # None: it has no link
    pose_in_world: Pose = IDENTITY  # of the root link's frame; without a world, where it stands
    is_static: bool = False
    file: Path | None = None  # that the model is written in; None: a text from nowhere
    line: int | None = None  # of its element in that file, 1-based
    # A static plane of it is level at z = 0. That is the ground, which an engine has by itself
    # (`World.has_ground_plane`): the robot is without it.
    is_ground: bool = False


class Inhabitants(NamedTuple):
    """What stands in a world."""

    placed: tuple[PlacedModel, ...]  # all of them
    models: tuple[SdfModel, ...]  # but for what is nothing but ground
    has_ground: bool  # a plane, level at z = 0
    carry: bool  # something is there that others can stand on


def read_inhabitants(world: Scope, includes: Includes) -> Inhabitants:
    """The models of a world; what else is in it and not part of a trial is reported."""
    for node in world.nodes.values():
        resolve(node)
    models = []
    has_ground = carry = False
    for node in world.own("model"):
        if _is_own_ground(node):
            has_ground = True
            continue
        model = read_standing(includes, node)
        has_ground |= model.is_ground
        carry |= _carries(node, model)
        if not _is_nothing_but_ground(model):
            models.append(model)
    _report_left_out(world)
    placed = tuple(
        PlacedModel(
            name=node.name, uri=node.uri, pose_in_world=resolve(node), is_static=node.is_static
        )
        for node in world.own("model")
    )
    return Inhabitants(placed, tuple(models), has_ground, has_ground or carry)


def read_standing(includes: Includes, node: Node) -> SdfModel:
    """A model of the world, or one that stands alone."""
    if node.inside is None:
        return _read_urdf(includes, node)
    # Most worlds that robots are spawned into hold sun and ground alone, and need none of this.
    from wsgen.world.assembly import assemble  # noqa: PLC0415

    pose = resolve(node)
    assembled = assemble(includes, node.inside, pose)
    for scope in node.inside.below():
        if scope.is_static and not node.is_static and scope.element is not None:
            scope.source.warning(
                "WLD048",
                f"The model `{scope.name}` is static, and part of one that is not: Gazebo holds it "
                "still, the trial lets it move.",
                at=scope.element,
                hint="Make the outer model static, or let the inner one stand beside it.",
            )
    return SdfModel(
        name=node.name,
        robot=assembled.robot,
        pose_in_world=compose(pose, assembled.root_in_model),
        is_static=node.is_static,
        file=node.source.file,
        line=line_of(node.element),
        is_ground=assembled.is_ground,
    )


def _read_urdf(includes: Includes, node: Node) -> SdfModel:
    file = node.source.file
    robot = None if file is None else includes.robot(file)
    is_static = node.is_static or (robot is not None and robot.is_static)
    return SdfModel(
        name=node.name,
        robot=robot and replace(robot, name=node.name, is_static=is_static),
        pose_in_world=resolve(node),
        is_static=is_static,
        file=file,
        line=line_of(node.element),
    )


def _is_own_ground(node: Node) -> bool:
    """Whether it is Gazebo's own ground, where engines have theirs."""
    return is_ground_plane(node.uri or "") and node.is_static and is_level_at_zero(resolve(node))


def _is_nothing_but_ground(model: SdfModel) -> bool:
    return (
        model.is_ground
        and model.robot is not None
        and not any(link.collisions or link.visuals for link in model.robot.links)
    )


def _carries(node: Node, model: SdfModel) -> bool:
    """Whether others can stand on it; a terrain carries even where wsgen cannot read it."""
    if not model.is_static:
        return False
    return next(node.element.iter("heightmap"), None) is not None or (
        model.robot is not None and any(link.collisions for link in model.robot.links)
    )


def _report_left_out(world: Scope) -> None:
    for element in children(world.element, "joint", "population", "actor"):
        world.source.warning(
            "WLD004",
            f"The {element.tag} {element.get('name') or ''} of the world is not part of the trial.",
            at=element,
            hint="The robots are tried without it.",
        )
