"""Worlds and models as spaces of names: the links, joints, frames and models in each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from wsgen.model.pose import IDENTITY, Pose

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.world.source import Source
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
