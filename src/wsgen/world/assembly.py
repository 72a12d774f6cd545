"""A model of SDF to a `Robot`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.robot import GazeboTag, Robot
from wsgen.world.bodies import read_body
from wsgen.world.frames import pose_in, resolve
from wsgen.world.joints import read_edge
from wsgen.world.mimics import with_leaders
from wsgen.world.source import line_of
from wsgen.world.tree import Tree
from wsgen.xmltree import children

if TYPE_CHECKING:
    from wsgen.world.included import Includes
    from wsgen.world.joints import Edge
    from wsgen.world.scopes import Node, Scope
    from wsgen.world.shapes import Plane


@dataclass(frozen=True, kw_only=True)
class Assembled:
    """What a model is made of."""

    robot: Robot | None  # None: it has no link
    root_in_model: Pose = IDENTITY
    planes: tuple[tuple[Plane, Pose], ...] = ()  # with the pose of their link in the model


def assemble(includes: Includes, model: Scope) -> Assembled:
    """The robot that a model is; what is wrong in it is reported, and left out."""
    for scope in model.below():
        for node in scope.nodes.values():
            resolve(node)
    nodes = _named(model, "link")
    if not nodes:
        _report_no_link(model)
        return Assembled(robot=None)
    name_of = {id(node): name for name, node in nodes.items()}
    bodies = {name: read_body(includes, node, name) for name, node in nodes.items()}
    joints = _named(model, "joint")
    edges = {
        name: edge
        for name, node in joints.items()
        if (edge := read_edge(node)) is not None and _is_of(edge, name_of)
    }
    tree = Tree(model, nodes, name_of)
    for name, edge in edges.items():
        if edge.type is not None:
            tree.join(name, edge)
    for name, edge in edges.items():
        if edge.type is None:
            tree.report_left_out(name, edge)
    robot = tree.robot({name: body.link for name, body in bodies.items()}, edges)
    return Assembled(
        robot=replace(
            robot,
            joints=with_leaders(robot.joints, joints),
            gazebo=(*_plugins(model), *(body.tag for body in bodies.values() if body.tag)),
        ),
        root_in_model=tree.frame(robot.root),
        planes=tuple(
            (plane, pose_in(model, nodes[name]))
            for name, body in bodies.items()
            for plane in body.planes
        ),
    )


def _named(model: Scope, kind: str) -> dict[str, Node]:
    """The links or joints of a model and of those in it, by their full names."""
    named: dict[str, Node] = {}
    for scope in model.below():
        for node in scope.nodes.values():
            if node.kind != kind:
                continue
            name = scope.prefix + node.name
            if name in named:  # only what was merged, or an old file that has flattened names
                node.source.error(
                    "WLD015",
                    f"Two {kind}s are called `{name}`.",
                    at=node.element,
                    hint="Give each its own name, or include the model without merging it.",
                )
            else:
                named[name] = node
    return named


def _is_of(edge: Edge, name_of: dict[int, str]) -> bool:
    """Whether both links are there: one that has no name of its own was reported, and left out."""
    return id(edge.child) in name_of and (edge.parent is None or id(edge.parent) in name_of)


def _plugins(model: Scope) -> list[GazeboTag]:
    tags = []
    for scope in model.below():
        names = tuple(plugin.get("filename") or "" for plugin in children(scope.element, "plugin"))
        if names:
            tags.append(GazeboTag(reference=None, plugins=names, line=line_of(scope.element)))
    return tags


def _report_no_link(model: Scope) -> None:
    if not model.is_static:
        model.source.error(
            "WLD029",
            f"The model `{model.name}` has no link.",
            at=model.element,
            hint='Add <link name="base_link">, or make the model static.',
        )
