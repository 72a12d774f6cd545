"""A model of SDF to a `Robot`.

Links and joints of a model to one tree, with the frames where URDF has them.

In SDF, links and joints have frames of their own, placed as the author likes. In a `Robot`, the
frame of a link is that of the joint above it; only the root keeps its own.

Joints that mimic others: the others have to exist, and may not mimic back.

Under which names things can stand in a world or model.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.robot import GazeboTag, Joint, JointType, Link, Plugin, Robot
from wsgen.model.transform import IDENTITY, Pose, compose, invert
from wsgen.sdf.bodies import read_body
from wsgen.sdf.frames import WORLD, canonical_link, pose_in, resolve
from wsgen.sdf.joints import read_edge, read_joint
from wsgen.sdf.shapes import read_planes
from wsgen.sdf.source import POSE_FRAMES, line_of
from wsgen.xmltree import child_texts, children

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.sdf.frames import Kind, Node, Scope
    from wsgen.sdf.includes import Includes
    from wsgen.sdf.joints import Edge
    from wsgen.sdf.shapes import Planes
    from wsgen.sdf.source import Version
    from wsgen.xmltree import Element


class Tree:
    """Links joined one after the other, as long as no link has two parents."""

    def __init__(self, model: Scope, nodes: dict[str, Node], name_of: dict[int, str]) -> None:
        self.model = model
        self.nodes = nodes
        self.name_of = name_of
        self.edge_of: dict[str, tuple[str, Edge]] = {}  # child -> its joint
        self._above = {name: name for name in (*nodes, WORLD)}  # some link nearer to the root

    def root_of(self, link: str) -> str:
        """The root of the tree that a link is in."""
        way = [link]
        while self._above[way[-1]] != way[-1]:
            way.append(self._above[way[-1]])
        for passed in way:
            self._above[passed] = way[-1]
        return way[-1]

    def join(self, name: str, edge: Edge) -> None:
        """Add a joint, unless it closes a chain, which is reported."""
        parent, child = self._parent(edge), self.name_of[id(edge.child)]
        if child in self.edge_of or self.root_of(parent) == self.root_of(child):
            other = self.edge_of.get(child)
            edge.node.source.warning(
                "WLD025",
                f"The joint `{name}` is left out of the simulation: it closes a chain"
                + (f" (`{child}` hangs on the joint `{other[0]}` already)." if other else "."),
                at=edge.node.element,
                hint="Gazebo Sim leaves such a joint out as well; Gazebo Classic has it.",
            )
            return
        self.edge_of[child] = (name, edge)
        self._above[child] = self.root_of(parent)

    def report_left_out(self, name: str, edge: Edge) -> None:
        """Report a joint of a type that is left out, and what that sets free."""
        child = self.name_of[id(edge.child)]
        edge.node.source.warning(
            "WLD024",
            f"The joint `{name}` is left out of the simulation: no engine of wsgen has "
            f"{edge.node.element.get('type')} joints."
            + ("" if child in self.edge_of else f" The link `{child}` is loose without it."),
            at=edge.node.element,
            hint="Gazebo has them; the simulation says nothing about this joint.",
        )

    def frame(self, link: str) -> Pose:
        """The pose in the model of a link's frame, where URDF has it."""
        if link == WORLD:
            return IDENTITY
        node = self.edge_of[link][1].node if link in self.edge_of else self.nodes[link]
        return pose_in(self.model, node)

    def robot(self, links: dict[str, Link], edges: dict[str, Edge]) -> Robot:
        """All links and joints; a world, if there is one, is the first link and the root."""
        is_fixed = any(edge.parent is None for _, edge in self.edge_of.values())
        root = self._root(is_fixed=is_fixed)
        frames = {name: self.frame(name) for name in links}
        frames[WORLD] = IDENTITY
        joint_of = dict(self.edge_of.values())
        loose = [name for name in links if name not in self.edge_of and name != root]
        return Robot(
            name=self.model.name,
            root=root,
            links=(
                *([Link(name=WORLD)] if is_fixed else []),
                *(self._seen_from(frames[name], link) for name, link in links.items()),
            ),
            joints=tuple(
                self._joint(name, joint_of[name], frames) for name in edges if name in joint_of
            ),
            loose=tuple(
                Joint(
                    name=f"{name} (loose)",
                    type=JointType.FLOATING,
                    parent=root,
                    child=name,
                    pose_in_parent=_from(frames[root], frames[name]),
                    line=links[name].line,
                )
                for name in loose
            ),
            fixed_to_world=is_fixed,
            is_static=self.model.is_static,
        )

    def _root(self, *, is_fixed: bool) -> str:
        if is_fixed:
            return WORLD
        canonical = self.name_of.get(id(canonical_link(self.model)))
        return self.root_of(canonical or next(iter(self.nodes)))

    def _parent(self, edge: Edge) -> str:
        return WORLD if edge.parent is None else self.name_of[id(edge.parent)]

    def _joint(self, name: str, edge: Edge, frames: dict[str, Pose]) -> Joint:
        parent, child = self._parent(edge), self.name_of[id(edge.child)]
        return read_joint(
            edge, self.model, (name, parent, child), _from(frames[parent], frames[child])
        )

    def _seen_from(self, frame: Pose, link: Link) -> Link:
        """The link with all that is in it seen from the frame instead of its own."""
        own = pose_in(self.model, self.nodes[link.name])
        if own == frame:
            return link
        offset = _from(frame, own)
        return replace(
            link,
            inertial=link.inertial
            and replace(link.inertial, pose_in_link=compose(offset, link.inertial.pose_in_link)),
            visuals=tuple(
                replace(visual, pose_in_link=compose(offset, visual.pose_in_link))
                for visual in link.visuals
            ),
            collisions=tuple(
                replace(collision, pose_in_link=compose(offset, collision.pose_in_link))
                for collision in link.collisions
            ),
        )


def _from(frame: Pose, pose: Pose) -> Pose:
    """The pose seen from a frame, when both are seen from the same one."""
    return IDENTITY if frame == pose else compose(invert(frame), pose)


def with_leaders(joints: tuple[Joint, ...], nodes: dict[str, Node]) -> tuple[Joint, ...]:
    """The joints with the full names of those that they mimic.

    One that mimics no other joint, or itself by way of others, is reported and mimics nothing.
    `nodes` has the elements of the joints by their full names.
    """
    followers = {joint.name: joint.mimic for joint in joints if joint.mimic is not None}
    if not followers:
        return joints
    names = {id(nodes[joint.name]): joint.name for joint in joints}
    leader_of: dict[str, str] = {}
    for name, mimic in followers.items():
        leader = nodes[name].scope.lookup(mimic.joint)
        found = None if leader is None else names.get(id(leader))
        if found is None or _leads_to(found, name, leader_of):
            _report(nodes[name], name, mimic.joint)
        else:
            leader_of[name] = found
    return tuple(
        replace(
            joint,
            mimic=replace(joint.mimic, joint=leader_of[joint.name])
            if joint.mimic is not None and joint.name in leader_of
            else None,
        )
        for joint in joints
    )


def _leads_to(start: str, end: str, leader_of: dict[str, str]) -> bool:
    place: str | None = start
    while place is not None and place != end:
        place = leader_of.get(place)
    return place == end


def _report(node: Node, name: str, leader: str) -> None:
    node.source.error(
        "WLD028",
        f"The joint `{name}` mimics `{leader}`, which is no joint of the simulation that moves by "
        "itself.",
        at=node.element,
        hint="Name another joint of this model: revolute, continuous or prismatic.",
    )


PARTS: tuple[Kind, ...] = ("link", "joint", "frame", "model")
NESTED_NAMES: Version = (1, 8)  # from here on `::` in a name leads into a model


def kind_of(element: Element) -> Kind:
    """The kind of an element that is one of `PARTS`."""
    return next(kind for kind in PARTS if kind == element.tag)


def checked_name(scope: Scope, kind: Kind, name: str, element: Element) -> str | None:
    """The name under which something stands in the scope; None, with a diagnostic, if it cannot."""
    source = scope.source
    if not name.strip():
        source.error(
            "WLD013",
            f"A {kind} has no name.",
            at=element,
            hint=f'Write <{kind} name="NAME">.',
        )
        return None
    if name == WORLD or (name.startswith("__") and name.endswith("__")):
        source.error(
            "WLD018",
            f"The name `{name}` is reserved: no {kind} can be called so.",
            at=element,
            hint="Choose another one. What is to be fixed to the world gets a joint whose parent "
            "is `world`.",
        )
        return None
    if "::" in name and source.version >= NESTED_NAMES:
        source.error(
            "WLD018",
            f"The name `{name}` has `::` in it, which leads into a model since SDF 1.8.",
            at=element,
            hint="Write _ instead.",
        )
        return None
    return _unused_name(scope, kind, name, element)


def _unused_name(scope: Scope, kind: Kind, name: str, element: Element) -> str | None:
    other = scope.named(name)
    if other is None:
        return name
    renamed = f"{name}_joint"
    is_allowed = kind == "joint" and other.kind != "joint" and scope.source.version < POSE_FRAMES
    if is_allowed and scope.named(renamed) is None:
        # Gazebo Classic has a space of names for each kind; the parser of today renames joints.
        scope.source.warning(
            "WLD039",
            f"A joint and a {other.kind} are both called `{name}`.",
            at=element,
            hint=f"Rename the joint, to `{renamed}` for example: since SDF 1.7 there is one space "
            "of names.",
        )
        return renamed
    scope.source.error(
        "WLD015",
        f"A {kind} and a {other.kind} are both called `{name}`."
        if kind != other.kind
        else f"Two {kind}s are called `{name}`.",
        at=element,
        hint="Give each its own name; an include may say <name>.",
    )
    return None


def report_shared_names(links: Mapping[str, Node]) -> None:
    """Report the links in which parts of different kinds have one name; `links` has full names."""
    sharing = [(name, node, shared) for name, node in links.items() if (shared := _shared(node))]
    if not sharing:
        return
    name, node, shared = sharing[0]
    more = f" (and so in {len(sharing) - 1} more links)" if len(sharing) > 1 else ""
    node.source.info(
        "WLD044",
        f"Two parts of the link `{name}` are called `{shared}`{more}.",
        at=node.element,
        hint="Gazebo loads it; its checker (`gz sdf --check`) wants a name for each visual, "
        "collision, sensor and light of a link.",
    )


def _shared(node: Node) -> str:
    """A name that parts of different kinds of a link have; empty: there is none."""
    kind_called: dict[str, str] = {}
    for part in node.element:
        name = part.get("name")
        kind = str(part.tag)
        if name and kind != "plugin" and kind_called.setdefault(name, kind) != kind:
            return name
    return ""


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
