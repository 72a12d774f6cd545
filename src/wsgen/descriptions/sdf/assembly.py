"""Make a `Robot` from a model of SDF: links and joints as a tree, with the frames of URDF.

In SDF, links and joints have frames of their own, anywhere. In a `Robot`, the frame of a link is
that of the joint above it; only the root keeps its own.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.rules import NO_LINK, UNKNOWN_MIMICKED_JOINT
from wsgen.descriptions.sdf.bodies import read_body
from wsgen.descriptions.sdf.frames import DUPLICATE_SDF_NAME, WORLD, canonical_link, poses_in_model
from wsgen.descriptions.sdf.joints import read_edge, read_joint
from wsgen.descriptions.sdf.shapes import read_planes
from wsgen.descriptions.sdf.source import line_of
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.robot import GazeboTag, Inertial, Joint, JointType, Link, Plugin, Robot
from wsgen.model.transform import IDENTITY, Pose, compose, invert
from wsgen.text.xmltree import child_texts, children

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.descriptions.sdf.frames import Node, Poses, Scope
    from wsgen.descriptions.sdf.includes import Includes
    from wsgen.descriptions.sdf.joints import Edge
    from wsgen.descriptions.sdf.shapes import Planes
    from wsgen.model.devices import Devices


CLOSED_CHAIN = Rule(
    code="WLD025",
    name="closed-chain",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A joint that closes a kinematic chain is not simulated.",
    why="Like Gazebo Sim, wsgen simulates only trees of links: the linkage stays open. Gazebo "
    "Classic closes it.",
    example="""<joint name="left" type="revolute">
  <parent>base_link</parent>
  <child>bar</child>
</joint>
<joint name="right" type="revolute">
  <parent>lever</parent>
  <child>bar</child>
</joint>""",
    instead="""<joint name="left" type="revolute">
  <parent>base_link</parent>
  <child>bar</child>
</joint>""",
)

JOINT_LEFT_OUT = Rule(
    code="WLD024",
    name="joint-left-out",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A joint of an unsupported type is not simulated.",
    what="Looks for joints of the types screw and gearbox.",
    why="Gazebo has these joints, so the simulation differs from Gazebo: a link without another "
    "joint falls off.",
    example='<joint name="spindle" type="screw">',
    instead="Use two revolute joints with a small link between them.",
)

CIRCULAR_MIMIC = Rule(
    code="WLD028",
    name="circular-mimic",
    severity=Severity.ERROR,
    summary="A joint of an SDF model mimics itself, directly or through other joints.",
    why="The positions of these joints are not determined.",
    example="""<joint name="left" type="revolute">
  <axis><mimic joint="right">...</mimic></axis>
</joint>
<joint name="right" type="revolute">
  <axis><mimic joint="left">...</mimic></axis>
</joint>""",
    instead="""<joint name="left" type="revolute">
  <axis>...</axis>
</joint>
<joint name="right" type="revolute">
  <axis><mimic joint="left">...</mimic></axis>
</joint>""",
)

SHARED_PART_NAME = Rule(
    code="WLD044",
    name="shared-part-name",
    severity=Severity.INFO,
    summary="Two parts of a link, of different kinds, have the same name.",
    why="Gazebo loads the model, but its checker (`gz sdf --check`) reports an error.",
    example='<visual name="box">...</visual>\n<collision name="box">...</collision>',
    instead='<visual name="box_visual">...</visual>\n<collision name="box">...</collision>',
)


# Between the axes of a joint; engines need some mass, and feel nothing of this one.
CROSS = Inertial(mass=1e-6, inertia=(1e-8, 0.0, 0.0, 1e-8, 0.0, 1e-8))  # kg, kg m²


_CROSS = " (cross)"


def is_cross(link: str) -> bool:
    """Whether a link is none of the file, but what is between the two axes of a joint."""
    return link.endswith(_CROSS)


class Tree:
    """Links, connected joint by joint as long as no link has two parents."""

    def __init__(self, model: Scope, nodes: dict[str, Node], poses: Poses) -> None:
        self.model = model
        self.nodes = nodes
        self.poses = poses  # in the model
        self.name_of = {node: name for name, node in nodes.items()}
        self.edge_of: dict[str, tuple[str, Edge]] = {}  # child -> its joint
        self._above = {name: name for name in (*nodes, WORLD)}  # some link nearer to the root

    def has_ends(self, edge: Edge) -> bool:
        """Whether both links exist: one with a duplicate name was reported and left out."""
        return edge.child in self.name_of and (edge.parent is None or edge.parent in self.name_of)

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
        parent, child = self._parent(edge), self.name_of[edge.child]
        if child in self.edge_of or self.root_of(parent) == self.root_of(child):
            other = self.edge_of.get(child)
            edge.node.source.report(
                CLOSED_CHAIN,
                f"The joint `{name}` is not simulated: it closes a kinematic chain"
                + (
                    f" (`{child}` is already the child of the joint `{other[0]}`)."
                    if other
                    else "."
                ),
                at=edge.node.element,
                hint="Remove the joint to get the same in all simulators: Gazebo Sim ignores it, "
                "too; Gazebo Classic does not.",
            )
            return
        self.edge_of[child] = (name, edge)
        self._above[child] = self.root_of(parent)

    def report_left_out(self, name: str, edge: Edge) -> None:
        """Report a joint of a type that is left out, and the link that is loose without it."""
        child = self.name_of[edge.child]
        edge.node.source.report(
            JOINT_LEFT_OUT,
            f"The joint `{name}` is not simulated: the engines of wsgen do not support "
            f"{edge.node.element.get('type')} joints."
            + ("" if child in self.edge_of else f" The link `{child}` is loose without it."),
            at=edge.node.element,
            hint="Check this joint in Gazebo, which supports it.",
        )

    def frame(self, link: str) -> Pose:
        """The pose in the model of the frame that a link has in URDF."""
        if link == WORLD:
            return IDENTITY
        node = self.edge_of[link][1].node if link in self.edge_of else self.nodes[link]
        return self.poses[node]

    def robot(self, links: dict[str, Link], edges: dict[str, Edge]) -> Robot:
        """All links and joints; the world, if it has a joint, is the first link and the root."""
        is_fixed = any(edge.parent is None for _, edge in self.edge_of.values())
        root = self._root(is_fixed=is_fixed)
        frames = {name: self.frame(name) for name in links}
        frames[WORLD] = IDENTITY
        joint_of = dict(self.edge_of.values())
        loose = [name for name in links if name not in self.edge_of and name != root]
        joints = [
            joint
            for name in edges
            if name in joint_of
            for joint in self._joints(name, joint_of[name], frames)
        ]
        return Robot(
            name=self.model.name,
            root=root,
            links=(
                *([Link(name=WORLD)] if is_fixed else []),
                *(self._seen_from(frames[name], link) for name, link in links.items()),
                *(
                    Link(name=joint.child, inertial=CROSS, line=joint.line)
                    for joint in joints
                    if joint.child not in links
                ),
            ),
            joints=tuple(joints),
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
        canonical = canonical_link(self.model)
        named = None if canonical is None else self.name_of.get(canonical)
        return self.root_of(named or next(iter(self.nodes)))

    def _parent(self, edge: Edge) -> str:
        return WORLD if edge.parent is None else self.name_of[edge.parent]

    def _joints(self, name: str, edge: Edge, frames: dict[str, Pose]) -> tuple[Joint, ...]:
        """The joint; of one with two axes, that of each, and between them a cross."""
        parent, child = self._parent(edge), self.name_of[edge.child]
        pose_in_parent = _from(frames[parent], frames[child])
        if not edge.has_two_axes:
            return (read_joint(edge, (name, parent, child), pose_in_parent, self.poses),)
        cross = f"{name}{_CROSS}"
        second = read_joint(edge, (f"{name} (axis2)", cross, child), IDENTITY, self.poses, "axis2")
        return (
            read_joint(edge, (name, parent, cross), pose_in_parent, self.poses),
            replace(second, mimic=None),
        )

    def _seen_from(self, frame: Pose, link: Link) -> Link:
        """The link with all of its parts in this frame instead of its own."""
        own = self.poses[self.nodes[link.name]]
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
    """The pose in a frame, when both are given in the same one."""
    return IDENTITY if frame == pose else compose(invert(frame), pose)


def with_leaders(joints: tuple[Joint, ...], nodes: dict[str, Node]) -> tuple[Joint, ...]:
    """The joints with the full names of those that they mimic.

    One that mimics an unknown joint, or itself through others, is reported and mimics nothing.
    `nodes` has the elements of the joints by their full names.
    """
    followers = {joint.name: joint.mimic for joint in joints if joint.mimic is not None}
    if not followers:
        return joints
    names = {nodes[joint.name]: joint.name for joint in joints if joint.name in nodes}
    leader_of: dict[str, str] = {}
    for name, mimic in followers.items():
        leader = nodes[name].scope.lookup(mimic.joint)
        found = None if leader is None else names.get(leader)
        if found is None:
            _report_unknown_leader(nodes[name], name, mimic.joint)
        elif _leads_to(found, name, leader_of):
            _report_circle(nodes[name], name, mimic.joint)
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


def _report_unknown_leader(node: Node, name: str, leader: str) -> None:
    node.source.report(
        UNKNOWN_MIMICKED_JOINT,
        f"The joint `{name}` mimics `{leader}`, which is not a joint of the simulation.",
        at=node.element,
        hint="Name another joint of this model: revolute, continuous or prismatic.",
        severity=Severity.ERROR,
    )


def _report_circle(node: Node, name: str, leader: str) -> None:
    node.source.report(
        CIRCULAR_MIMIC,
        f"The joint `{name}` mimics `{leader}`, which is itself or mimics it.",
        at=node.element,
        hint="Name a joint that moves by itself.",
    )


def report_shared_names(links: Mapping[str, Node]) -> None:
    """Report links in which parts of different kinds have one name; `links` has full names."""
    sharing = [(name, node, shared) for name, node in links.items() if (shared := _shared(node))]
    if not sharing:
        return
    name, node, shared = sharing[0]
    more = f" (and in {len(sharing) - 1} more links)" if len(sharing) > 1 else ""
    node.source.report(
        SHARED_PART_NAME,
        f"Two parts of the link `{name}` have the name `{shared}`{more}.",
        at=node.element,
        hint="Give each visual, collision, sensor and light of a link a different name. Gazebo "
        "loads the model, but `gz sdf --check` reports an error.",
    )


def _shared(node: Node) -> str:
    """A name that parts of different kinds of a link have; empty if they have none."""
    kind_called: dict[str, str] = {}
    for part in node.element:
        name = part.get("name")
        kind = str(part.tag)
        if name and kind != "plugin" and kind_called.setdefault(name, kind) != kind:
            return name
    return ""


class Assembled(NamedTuple):
    """A model as a robot, and its ground."""

    robot: Robot | None  # None: it has no link
    root_in_model: Pose = IDENTITY
    ground_friction: float | None = None  # of a plane that is the world's ground, which is left out
    devices: Devices | None = None  # if they are wanted


def assemble(includes: Includes, model: Scope, model_in_world: Pose, resolved: Poses) -> Assembled:
    """The robot of a model; parts that are wrong are reported and left out.

    `resolved` are the poses of all nodes, each in its scope.
    """
    nodes = _named(model, "link")
    if not nodes:
        if not _has_include_left_out(includes, model):
            _report_no_link(model)
        return Assembled(robot=None)
    report_shared_names(nodes)
    poses = poses_in_model(model, resolved)
    tree = Tree(model, nodes, poses)
    bodies = {name: read_body(includes, node, name) for name, node in nodes.items()}
    planes = {
        name: read_planes(node, compose(model_in_world, poses[node]), includes)
        for name, node in nodes.items()
    }
    links = {name: _with_planes(body.link, planes[name]) for name, body in bodies.items()}
    joints = _named(model, "joint")
    edges = {
        name: edge
        for name, node in joints.items()
        if (edge := read_edge(node)) is not None and tree.has_ends(edge)
    }
    for name, edge in edges.items():
        if edge.type is not None:
            tree.join(name, edge)
    for name, edge in edges.items():
        if edge.type is None:
            tree.report_left_out(name, edge)
    robot = tree.robot(links, edges)
    devices = None
    if includes.with_devices:
        from wsgen.descriptions.sdf.devices import read_devices  # noqa: PLC0415  live runs alone

        parts = {"link": nodes, "joint": joints, "frame": _named(model, "frame")}
        devices = read_devices(model, parts, poses, {name: tree.frame(name) for name in links})
    grounds = (one.ground_friction for one in planes.values())
    return Assembled(
        robot=replace(
            robot,
            joints=with_leaders(robot.joints, joints),
            gazebo=(*_plugins(model), *(body.tag for body in bodies.values() if body.tag)),
        ),
        root_in_model=tree.frame(robot.root),
        ground_friction=max((mu for mu in grounds if mu is not None), default=None),
        devices=devices,
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
                node.source.report(
                    DUPLICATE_SDF_NAME,
                    f"Two {kind}s have the name `{name}`.",
                    at=node.element,
                    hint="Give each a different name, or include the model without merging it.",
                )
            else:
                named[name] = node
    return named


def _plugins(model: Scope) -> list[GazeboTag]:
    tags = []
    for scope in model.below():
        plugins = tuple(
            Plugin(
                filename=plugin.get("filename") or "",
                values=child_texts(plugin),
                name=plugin.get("name") or "",
                line=line_of(plugin),
            )
            for plugin in children(scope.element, "plugin")
        )
        if plugins:
            tags.append(GazeboTag(reference=None, plugins=plugins, line=line_of(scope.element)))
    return tags


def _has_include_left_out(includes: Includes, model: Scope) -> bool:
    """Whether the links are in a model that is not found, which has been reported."""
    return any(
        include in includes.left_out
        for scope in model.below()
        for include in children(scope.element, "include")
    )


def _report_no_link(model: Scope) -> None:
    if not model.is_static:
        model.source.report(
            NO_LINK,
            f"The model `{model.name}` does not have a link.",
            at=model.element,
            hint='Add <link name="base_link">, or make the model static.',
        )
