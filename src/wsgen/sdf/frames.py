"""Where frames are, and which links they move with.

Poses are relative to frames, which are relative to frames; chains may be long and may close to a
circle, so nothing here is recursive.

Worlds and models as spaces of names: the links, joints, frames and models in each.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from wsgen.model.transform import IDENTITY, Pose, compose, invert, rotate, rotation_of_rpy
from wsgen.sdf.values import word

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.sdf.source import Source
    from wsgen.xmltree import Element


Kind = Literal["link", "joint", "frame", "model"]

MODEL_FRAME = "__model__"  # how the frame of the model around it is called in SDF
WORLD = "world"


# Plain classes: as dataclasses these two would take a fifth of the time to load this package.
class Node:
    """Something with a frame: it stands in a scope, under a name."""

    __slots__ = (
        "base",
        "element",
        "inside",
        "is_in_progress",
        "is_static",
        "kind",
        "name",
        "pose",
        "pose_in_scope",
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
        # Of a model: what is in it; None: its element is the <robot> of a URDF.
        self.inside: Scope | None = None
        self.is_static = False  # of a model
        # That frame, once it is looked up; None: that of the scope.
        self.base: Node | None = None
        # Once it is worked out, in the frame of `scope`.
        self.pose_in_scope: Pose | None = None
        self.is_in_progress = False  # it is being worked out


class Scope:
    """A world or a model: a space of names."""

    __slots__ = (
        "depth",
        "element",
        "is_static",
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

    @property
    def is_world(self) -> bool:
        """Whether it is a world, or the place where a single model stands."""
        return self.node is None

    def lookup(self, name: str) -> Node | None:
        """What a name means here; `inner::name` is in the model `inner`."""
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
        """What has exactly this name, here or in what was merged into this."""
        for scope in self.with_merged():
            if name in scope.nodes:
                return scope.nodes[name]
        return None

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
        """What there is of a kind directly in it, in the order of the document."""
        return (node for node in self.nodes.values() if node.kind == kind)


LEVEL = 1e-6  # m or rad: what rounding leaves


def is_level_at_zero(pose: Pose) -> bool:
    """Whether the plane of x and y, with z as its upper side, is where engines have the ground."""
    x, y, z = rotate(rotation_of_rpy(pose.rpy), (0.0, 0.0, 1.0))
    return z > 0 and math.hypot(x, y) <= LEVEL and abs(pose.xyz[2]) <= LEVEL


def resolve(node: Node) -> Pose:
    """The pose of a node in the frame of its scope; circles and unknown names are reported."""
    stack = [node]
    while stack:
        top = stack[-1]
        if top.pose_in_scope is not None:
            stack.pop()
            continue
        if not top.is_in_progress:
            top.is_in_progress, top.base = True, _base(top)
        waiting = [other for other in _needs(top) if other.pose_in_scope is None]
        if any(other.is_in_progress for other in waiting):
            _report_circle(top)
            top.pose_in_scope = top.pose
        elif waiting:
            stack += waiting
        else:
            top.pose_in_scope = _calculate(top)
    assert node.pose_in_scope is not None  # noqa: S101  the loop ends when it is known
    return node.pose_in_scope


def pose_in(scope: Scope, node: Node) -> Pose:
    """The pose of a node in a scope around it."""
    pose = resolve(node)
    place = node.scope
    while place is not scope and place.node is not None:
        pose = compose(resolve(place.node), pose)
        place = place.node.scope
    return pose


def frame_called(node: Node, name: str, what: str) -> Node | None:
    """The frame that a name means where `node` is; None: the frame of its scope.

    An unknown name is reported, `what` being the place where it was written.
    """
    if name in {"", MODEL_FRAME} or (name == WORLD and node.scope.is_world):
        return None
    found = node.scope.lookup(name)
    if found is None:
        node.source.error(
            "WLD016",
            f"{what} of the {node.kind} `{node.name}` names `{name}`, "
            "and no link, joint, frame or model is called so here.",
            at=node.element,
            hint="Name one of the same model; one of a model in it is written `MODEL::NAME`.",
        )
    return found


def link_of(node: Node) -> Node | None:
    """The link that a frame moves with; None where there is none."""
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


def _needs(node: Node) -> Iterator[Node]:
    """The nodes whose poses must be known for that of this one."""
    for other, scope in ((node.base, node.scope), (_placed(node), node.inside)):
        if other is not None:
            yield other
            place = other.scope
            while place is not scope and place.node is not None:
                yield place.node
                place = place.node.scope


def _calculate(node: Node) -> Pose:
    placed = _placed(node)
    pose = node.pose if node.base is None else compose(pose_in(node.scope, node.base), node.pose)
    if placed is not None and node.inside is not None:
        pose = compose(pose, invert(pose_in(node.inside, placed)))
    return pose


def _report_circle(node: Node) -> None:
    node.source.error(
        "WLD017",
        f"The {node.kind} `{node.name}` is placed relative to itself, by way of other frames.",
        at=node.element,
        hint="Break the circle: let one of the frames be relative to the model.",
    )
