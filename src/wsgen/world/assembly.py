"""A model of SDF to a `Robot`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.robot import GazeboTag, Plugin
from wsgen.world.bodies import read_body
from wsgen.world.frames import resolve
from wsgen.world.joints import read_edge
from wsgen.world.mimics import with_leaders
from wsgen.world.names import report_shared_names
from wsgen.world.planes import read_planes
from wsgen.world.source import line_of
from wsgen.world.tree import Tree
from wsgen.xmltree import child_texts, children

if TYPE_CHECKING:
    from wsgen.model.robot import Link, Robot
    from wsgen.world.included import Includes
    from wsgen.world.joints import Edge
    from wsgen.world.planes import Planes
    from wsgen.world.scopes import Node, Scope


class Assembled(NamedTuple):
    """What a model is made of."""

    robot: Robot | None  # None: it has no link
    root_in_model: Pose = IDENTITY
    is_ground: bool = False  # a plane of it is the ground of the world; the robot is without it


def assemble(includes: Includes, model: Scope, model_in_world: Pose) -> Assembled:
    """The robot that a model is; what is wrong in it is reported, and left out."""
    for scope in model.below():
        for node in scope.nodes.values():
            resolve(node)
    nodes = _named(model, "link")
    if not nodes:
        _report_no_link(model)
        return Assembled(robot=None)
    report_shared_names(nodes)
    name_of = {id(node): name for name, node in nodes.items()}
    bodies = {name: read_body(includes, node, name) for name, node in nodes.items()}
    planes = {name: read_planes(node, model, model_in_world) for name, node in nodes.items()}
    links = {name: _with_planes(body.link, planes[name]) for name, body in bodies.items()}
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
    robot = tree.robot(links, edges)
    return Assembled(
        robot=replace(
            robot,
            joints=with_leaders(robot.joints, joints),
            gazebo=(*_plugins(model), *(body.tag for body in bodies.values() if body.tag)),
        ),
        root_in_model=tree.frame(robot.root),
        is_ground=any(found.is_ground for found in planes.values()),
    )


def _with_planes(link: Link, planes: Planes) -> Link:
    if not planes.collisions and not planes.visuals:
        return link
    return replace(
        link,
        collisions=(*link.collisions, *planes.collisions),
        visuals=(*link.visuals, *planes.visuals),
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
        plugins = tuple(
            Plugin(plugin.get("filename") or "", child_texts(plugin))
            for plugin in children(scope.element, "plugin")
        )
        if plugins:
            tags.append(GazeboTag(reference=None, plugins=plugins, line=line_of(scope.element)))
    return tags


def _report_no_link(model: Scope) -> None:
    if not model.is_static:
        model.source.error(
            "WLD029",
            f"The model `{model.name}` has no link.",
            at=model.element,
            hint='Add <link name="base_link">, or make the model static.',
        )
