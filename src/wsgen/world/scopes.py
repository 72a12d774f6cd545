"""Worlds and models as spaces of names: the links, joints, frames and models in each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from wsgen.model.pose import IDENTITY, Pose

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.world.source import Source
    from wsgen.xmltree import Element

Kind = Literal["link", "joint", "frame", "model"]

MODEL_FRAME = "__model__"  # how the frame of the model around it is called in SDF
WORLD = "world"


@dataclass(slots=True, eq=False, kw_only=True)
class Node:
    """Something with a frame: it stands in a scope, under a name."""

    kind: Kind
    name: str
    scope: Scope  # in which its pose is written
    source: Source
    element: Element
    pose: Pose = IDENTITY  # as written, in the frame called `relative_to`
    relative_to: str = ""  # empty: the default of its kind
    uri: str | None = None  # of a model: what it was included by
    inside: Scope | None = None  # of a model: what is in it
    base: Node | None = None  # that frame, once it is looked up; None: that of the scope
    pose_in_scope: Pose | None = None  # once it is worked out, in the frame of `scope`
    is_in_progress: bool = False  # it is being worked out


@dataclass(slots=True, eq=False, kw_only=True)
class Scope:
    """A world or a model: a space of names."""

    name: str
    source: Source
    element: Element
    node: Node | None = None  # of a model: its own frame, in the scope around it
    prefix: str = ""  # of the names of its links in the outermost model: `inner::`
    is_static: bool = False
    self_collide: bool = False  # of links that do not say themselves
    depth: int = 0  # so many models are around it, itself among them
    placement_frame: str = ""  # the frame in it whose pose is that of the model
    nodes: dict[str, Node] = field(default_factory=dict)
    merged: list[Scope] = field(default_factory=list)  # their names count as names of this one

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
