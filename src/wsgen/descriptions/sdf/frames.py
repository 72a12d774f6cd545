"""Worlds and models as namespaces of links, joints, frames and models, and where these are.

Poses are relative to frames, which are relative to other frames. Chains may be long and circular,
so nothing here is recursive.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from wsgen.descriptions.rules import ONE_NAME_FOR_LINK_AND_JOINT, RESERVED_NAME, UNNAMED_ELEMENT
from wsgen.descriptions.sdf.source import POSE_FRAMES
from wsgen.descriptions.sdf.values import word
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.transform import IDENTITY, Pose, compose, invert, rotate, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.descriptions.sdf.source import Source, Version
    from wsgen.text.xmltree import Element


Kind = Literal["link", "joint", "frame", "model"]

DUPLICATE_SDF_NAME = Rule(
    code="WLD015",
    name="duplicate-sdf-name",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another model", sim="refuses it"),
    summary="Two elements of a world, model or link have the same name.",
    what="Links, joints, frames and nested models share one namespace; the visuals of a link have "
    "one, and so have its collisions.",
    why="Gazebo Sim refuses the file: joints and plugins cannot distinguish the two.",
    example='<link name="wheel"/>\n<link name="wheel"/>',
    instead='<link name="left_wheel"/>\n<link name="right_wheel"/>',
)

UNKNOWN_FRAME = Rule(
    code="WLD016",
    name="unknown-frame",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another model", sim="refuses it"),
    summary="A pose, frame, axis or model names a frame that does not exist.",
    what="Looks at `relative_to`, `attached_to`, `expressed_in`, `placement_frame` and "
    "`canonical_link`.",
    why="Gazebo refuses the model: it cannot compute the pose of the element.",
    example='<link name="arm">\n  <pose relative_to="sholder">0 0 0.1 0 0 0</pose>',
    instead='<link name="arm">\n  <pose relative_to="shoulder">0 0 0.1 0 0 0</pose>',
)

FRAME_CYCLE = Rule(
    code="WLD017",
    name="frame-cycle",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another model", sim="refuses it"),
    summary="A frame is placed relative to itself, directly or through other frames.",
    why="Gazebo refuses the model: it cannot compute these poses.",
    example="""<frame name="a">
  <pose relative_to="b"/>
</frame>
<frame name="b">
  <pose relative_to="a"/>
</frame>""",
    instead="""<frame name="a">
  <pose relative_to="b"/>
</frame>
<frame name="b">
  <pose relative_to="__model__"/>
</frame>""",
)

MODEL_FRAME = "__model__"  # SDF's name of the frame of the model around an element
WORLD = "world"
UNNAMED = "::"  # in `Scope.left_out`; no model has this name
PARTS: tuple[Kind, ...] = ("link", "joint", "frame", "model")
NESTED_NAMES: Version = (1, 8)  # from here on `::` in a name leads into a model


# Plain classes: as dataclasses these two would take a fifth of the time to load this package.
class Node:
    """Something with a frame: it is in a scope, under a name."""

    __slots__ = (
        "element",
        "include",
        "inside",
        "is_static",
        "kind",
        "name",
        "pose",
        "relative_to",
        "scope",
        "source",
        "uri",
    )

    def __init__(
        self, kind: Kind, name: str, scope: Scope, *, source: Source, element: Element
    ) -> None:
        self.kind = kind
        self.name = name
        self.scope = scope  # in which its pose is written
        self.source = source
        self.element = element
        self.pose: Pose = IDENTITY  # as written, in the frame called `relative_to`
        self.relative_to = ""  # empty: the default of its kind
        self.uri: str | None = None  # of a model: what it was included by
        self.include: Element | None = None  # of a model, likewise
        # Of a model: what is in it; None: its element is the <robot> of a URDF.
        self.inside: Scope | None = None
        self.is_static = False  # of a model


class Scope:
    """A world or a model: a namespace."""

    __slots__ = (
        "depth",
        "element",
        "is_static",
        "left_out",
        "merged",
        "name",
        "node",
        "nodes",
        "placement_frame",
        "prefix",
        "self_collide",
        "source",
    )

    def __init__(
        self, name: str, *, source: Source, element: Element, node: Node | None = None
    ) -> None:
        self.name = name
        self.source = source
        self.element = element
        self.node = node  # of a model: its own frame, in the scope around it
        self.prefix = ""  # of the names of its links in the outermost model: `inner::`
        self.is_static = False
        self.self_collide = False  # of links that do not say themselves
        self.depth = 0  # so many models are around it, itself among them
        self.placement_frame = ""  # the frame in it whose pose is that of the model
        self.nodes: dict[str, Node] = {}
        self.merged: list[Scope] = []  # their names count as names of this one
        # The names of included models that were not found; "" for one that is merged, and
        # UNNAMED beside the name of its folder where only its own file says how it is called.
        self.left_out: set[str] = set()

    @property
    def is_world(self) -> bool:
        """Whether it is a world, or the place of a single model."""
        return self.node is None

    def lookup(self, name: str) -> Node | None:
        """The node of a name here; `inner::name` is in the model `inner`."""
        scope, rest = self, name
        while True:
            node = scope.named(rest)
            if node is not None:
                return node
            head, _, rest = rest.partition("::")
            node = scope.named(head)
            if node is None or node.inside is None or not rest:
                return None
            if rest == MODEL_FRAME:
                return node
            scope = node.inside

    def named(self, name: str) -> Node | None:
        """The node with exactly this name, here or in a merged scope."""
        for scope in self.with_merged():
            if name in scope.nodes:
                return scope.nodes[name]
        return None

    def may_have(self, name: str) -> bool:
        """Whether a model that was not found may have what is not found in its scope."""
        head, is_inside, _ = name.partition("::")
        having = {"", head, UNNAMED} if is_inside else {"", head}
        return any(not scope.left_out.isdisjoint(having) for scope in self.with_merged())

    def with_merged(self) -> Iterator[Scope]:
        """This scope, and those merged into it."""
        queue = [self]
        for scope in queue:
            yield scope
            queue += scope.merged

    def below(self) -> Iterator[Scope]:
        """This scope, and those of all models in it, in the order of the document."""
        stack = [self]
        while stack:
            scope = stack.pop()
            yield scope
            inner = [node.inside for node in scope.nodes.values() if node.inside is not None]
            stack += reversed([*scope.merged, *inner])

    def own(self, kind: Kind) -> Iterator[Node]:
        """The nodes of a kind directly in it, in the order of the document."""
        return (node for node in self.nodes.values() if node.kind == kind)


def kind_of(element: Element) -> Kind:
    """The kind of an element that is one of `PARTS`."""
    return next(kind for kind in PARTS if kind == element.tag)


def checked_name(scope: Scope, kind: Kind, name: str, element: Element) -> str | None:
    """The name that an element gets in the scope; None, with a diagnostic, if it cannot have it."""
    source = scope.source
    if not name.strip():
        source.report(
            UNNAMED_ELEMENT,
            f"A {kind} has no name.",
            at=element,
            hint=f'Write <{kind} name="NAME">.',
        )
        return None
    if name == WORLD or (name.startswith("__") and name.endswith("__")):
        source.report(
            RESERVED_NAME,
            f"The name `{name}` of the {kind} is reserved by SDF.",
            at=element,
            hint="Choose another name. To fix a link to the world, add a joint with the parent "
            "`world`.",
        )
        return None
    if "::" in name and source.version >= NESTED_NAMES:
        source.report(
            RESERVED_NAME,
            f"The name `{name}` contains `::`, which separates the names of models since SDF 1.8.",
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
        # Gazebo Classic has a namespace for each kind; the parser of today renames joints.
        scope.source.report(
            ONE_NAME_FOR_LINK_AND_JOINT,
            f"A joint and a {other.kind} have the same name `{name}`.",
            at=element,
            hint=f"Rename the joint, for example to `{renamed}`: since SDF 1.7 they share one "
            "namespace.",
        )
        return renamed
    scope.source.report(
        DUPLICATE_SDF_NAME,
        f"A {kind} and a {other.kind} have the same name `{name}`."
        if kind != other.kind
        else f"Two {kind}s have the name `{name}`.",
        at=element,
        hint="Give each a different name; an <include> can have a <name>.",
    )
    return None


if TYPE_CHECKING:
    Poses = Mapping[Node, Pose]

LEVEL = 1e-6  # m or rad: what rounding leaves


def is_level_at_zero(pose: Pose) -> bool:
    """Whether the plane of x and y, with z as its upper side, is where engines have the ground."""
    x, y, z = rotate(rotation_of_rpy(pose.rpy), (0.0, 0.0, 1.0))
    return z > 0 and math.hypot(x, y) <= LEVEL and abs(pose.xyz[2]) <= LEVEL


def resolve_poses(top: Scope) -> Poses:
    """The pose of everything in a world or a model, each in its own scope.

    From the outside in, each node after the nodes that its pose depends on. Unknown frames and
    circles are reported.
    """
    poses: dict[Node, Pose] = {}
    bases: dict[Node, Node | None] = {}  # of all nodes that were looked at
    for start in _nodes_below(top):
        stack = [start]
        while stack:
            node = stack[-1]
            if node in poses:
                stack.pop()
                continue
            if node not in bases:
                bases[node] = _base(node)
            waiting = [other for other in _needs(node, bases[node]) if other not in poses]
            if any(other in bases for other in waiting):
                _report_circle(node)
                poses[node] = node.pose
            elif waiting:
                stack += waiting
            else:
                poses[node] = _calculate(node, bases[node], poses)
    return poses


def poses_in_model(model: Scope, poses: Poses) -> Poses:
    """The pose of everything below a model in the frame of this model, itself included.

    `poses` are those of `resolve_poses`.
    """
    in_model: dict[Node, Pose] = {}

    def place(node: Node) -> Pose:
        around = node.scope.node
        if node.scope is model or around is None:
            return poses[node]
        return compose(in_model[around], poses[node])

    for scope in model.below():
        if scope.node is not None and scope.node not in in_model:  # of this model, or a merged one
            in_model[scope.node] = IDENTITY if scope is model else place(scope.node)
        in_model |= {node: place(node) for node in scope.nodes.values()}
    return in_model


def _nodes_below(top: Scope) -> Iterator[Node]:
    for scope in top.below():
        if scope.node is not None and scope is not top:
            yield scope.node  # of a merged model, which is not in the scope around it
        yield from scope.nodes.values()


def _pose_in(scope: Scope, node: Node, poses: Poses) -> Pose:
    """The pose of a node in a scope around it."""
    pose = poses[node]
    place = node.scope
    while place is not scope and place.node is not None:
        pose = compose(poses[place.node], pose)
        place = place.node.scope
    return pose


def frame_called(node: Node, name: str, what: str) -> Node | None:
    """The frame of a name in the scope of `node`; None: the frame of the scope.

    An unknown name is reported; `what` is the place where it is written.
    """
    if name in {"", MODEL_FRAME} or (name == WORLD and node.scope.is_world):
        return None
    found = node.scope.lookup(name)
    if found is None and not node.scope.may_have(name):
        node.source.report(
            UNKNOWN_FRAME,
            f"{what} of the {node.kind} `{node.name}` names `{name}`, "
            "which is not a link, joint, frame or model here.",
            at=node.element,
            hint="Write the name of one in the same model, or `MODEL::NAME` for one in a nested "
            "model.",
        )
    return found


def link_of(node: Node) -> Node | None:
    """The link that a frame moves with; None if no link moves with it."""
    seen = set()
    place: Node | None = node
    while place is not None and place.kind != "link":
        if id(place) in seen:
            _report_circle(place)
            return None
        seen.add(id(place))
        if place.kind == "model":
            place = None if place.inside is None else canonical_link(place.inside)
        else:
            attribute = place.element.get("attached_to") or ""
            name = word(place.element, "child") if place.kind == "joint" else attribute
            if name in {"", MODEL_FRAME}:
                place = canonical_link(place.scope)
            else:
                place = place.scope.lookup(name)
    return place


def canonical_link(scope: Scope) -> Node | None:
    """The link that the frame of a model moves with: the named one, or the first."""
    name = scope.element.get("canonical_link") or ""
    if name and not scope.is_world:
        named = scope.lookup(name)
        if named is not None and named.kind == "link":
            return named
    return next((link for inner in scope.below() for link in inner.own("link")), None)


def _base(node: Node) -> Node | None:
    """The frame that the pose of a node is relative to; None: that of its scope."""
    if node.relative_to:
        return frame_called(node, node.relative_to, "The pose")
    if node.kind == "joint":
        return node.scope.lookup(word(node.element, "child"))  # reported where links are joined
    if node.kind == "frame":
        return frame_called(node, node.element.get("attached_to") or "", "`attached_to`")
    return None


def _placed(node: Node) -> Node | None:
    """The frame inside a model that its pose is about; None: the model's own."""
    if node.inside is None or node.inside.placement_frame in {"", MODEL_FRAME}:
        return None
    return node.inside.lookup(node.inside.placement_frame)  # reported when it was read


def _needs(node: Node, base: Node | None) -> Iterator[Node]:
    """The nodes whose poses must be known for that of this one."""
    for other, scope in ((base, node.scope), (_placed(node), node.inside)):
        if other is not None:
            yield other
            place = other.scope
            while place is not scope and place.node is not None:
                yield place.node
                place = place.node.scope


def _calculate(node: Node, base: Node | None, poses: Poses) -> Pose:
    placed = _placed(node)
    pose = node.pose if base is None else compose(_pose_in(node.scope, base, poses), node.pose)
    if placed is not None and node.inside is not None:
        pose = compose(pose, invert(_pose_in(node.inside, placed, poses)))
    return pose


def _report_circle(node: Node) -> None:
    node.source.report(
        FRAME_CYCLE,
        f"The {node.kind} `{node.name}` is placed relative to itself, through other frames.",
        at=node.element,
        hint="Break the cycle: place one of the frames relative to the model.",
    )
