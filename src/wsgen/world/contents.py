"""`<world>` and `<model>` elements, and what they include, to scopes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.world.included import is_sun
from wsgen.world.names import PARTS, checked_name, kind_of
from wsgen.world.scopes import MODEL_FRAME, Node, Scope
from wsgen.world.values import first, read_pose, truth, word
from wsgen.xmltree import children

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.world.included import Includes
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

DEEPEST = 50  # models in models; public ones have three
MOST_PARTS = 60_000  # links, joints, frames and models of a file with all that it includes

Trail = tuple["Path", ...]  # the files that lead to an element


class Contents:
    """Reads models into scopes, and keeps count of them."""

    def __init__(self, includes: Includes) -> None:
        self.includes = includes
        self.parts = 0

    def world(self, source: Source, element: Element) -> Scope:
        """A world, with the models that stand in it."""
        scope = Scope(element.get("name") or "default", source=source, element=element)
        self._fill(scope, _start(source))
        return scope

    def alone(self, source: Source, element: Element) -> Scope:
        """The place where a single model stands, with the model in it."""
        scope = Scope("", source=source, element=source.root)
        self._add(scope, element, _start(source))
        return scope

    def _fill(self, scope: Scope, trail: Trail) -> None:
        """Put everything that has a frame into the scope."""
        for child in children(scope.element, *PARTS, "include"):
            if not self._is_within_bounds(scope.source, child):
                return
            if child.tag == "include":
                self._include(scope, child, trail)
            elif not (scope.is_world and child.tag in {"link", "joint"}):
                self._add(scope, child, trail)

    def _add(self, scope: Scope, element: Element, trail: Trail) -> None:
        """A link, joint, frame or model that is written in the scope."""
        source, kind = scope.source, kind_of(element)
        name = checked_name(scope, kind, element.get("name") or "", element)
        if name is None:
            return
        node = Node(kind, name, scope, source=source, element=element)
        node.pose, node.relative_to = read_pose(source, element)
        scope.nodes[name] = node
        if kind == "model":
            node.is_static = truth(source, element, "static", default=False)
            self._open(node, element.get("placement_frame") or "", trail)

    def _include(self, scope: Scope, include: Element, trail: Trail) -> None:
        """A model of another file, with the name, the pose and the rest that the include gives."""
        uri = word(include, "uri")
        if is_sun(uri):
            return
        found = self.includes.find(scope.source, include, uri, trail, is_part=not scope.is_world)
        if found is None:
            return
        source, element = found
        node = self._stand(scope, include, uri, source, element)
        if node is None:
            return
        static = first(include, "static")
        node.is_static = (
            truth(source, element, "static", default=False)
            if static is None
            else truth(scope.source, include, "static", default=False)
        )
        if element.tag != "model":
            return
        is_merged = not scope.is_world and include.get("merge") in {"true", "1"}
        inside_trail = trail if source.file is None else (*trail, source.file)
        placement = word(include, "placement_frame") or element.get("placement_frame") or ""
        self._open(node, placement, inside_trail, is_merged=is_merged)
        if is_merged and node.inside is not None:
            del scope.nodes[node.name]
            scope.merged.append(node.inside)

    def _stand(
        self, scope: Scope, include: Element, uri: str, source: Source, element: Element
    ) -> Node | None:
        """An included model in the scope; None, with a diagnostic, if its name does not do."""
        last = uri.rstrip("/").rpartition("/")[2]
        given = word(include, "name") or element.get("name") or last
        name = checked_name(scope, "model", given, include)
        if name is None:
            return None
        node = Node("model", name, scope, source=source, element=element)
        node.uri = uri
        is_placed = first(include, "pose") is not None
        node.pose, node.relative_to = (
            read_pose(scope.source, include) if is_placed else read_pose(source, element)
        )
        scope.nodes[name] = node
        return node

    def _open(
        self, node: Node, placement_frame: str, trail: Trail, *, is_merged: bool = False
    ) -> None:
        """Read what is in a model."""
        around, element = node.scope, node.element
        prefix = "" if around.is_world else f"{around.prefix}{node.name}::"
        inside = Scope(node.name, source=node.source, element=element, node=node)
        inside.prefix = around.prefix if is_merged else prefix
        inside.is_static = around.is_static or node.is_static
        inside.self_collide = truth(node.source, element, "self_collide", default=False)
        inside.placement_frame = placement_frame
        inside.depth = around.depth + 1
        node.inside = inside
        if inside.depth > DEEPEST:
            node.source.error(
                "WLD014",
                f"The model `{node.name}` is in {around.depth} others; wsgen reads {DEEPEST}.",
                at=element,
                hint="Put the models side by side, and place them by relative_to.",
            )
            return
        self._fill(inside, trail)
        canonical = element.get("canonical_link") or ""
        for attribute, name in (
            ("placement_frame", placement_frame),
            ("canonical_link", canonical),
        ):
            if name not in {"", MODEL_FRAME} and inside.lookup(name) is None:
                node.source.error(
                    "WLD016",
                    f"`{attribute}` of the model `{node.name}` names `{name}`, which is not in it.",
                    at=element,
                    hint="Name a frame of this model.",
                )

    def _is_within_bounds(self, source: Source, element: Element) -> bool:
        self.parts += 1
        if self.parts == MOST_PARTS + 1:
            source.error(
                "WLD014",
                f"There are more than {MOST_PARTS} links, joints, frames and models; "
                "wsgen reads no more.",
                at=element,
                hint="Do models include each other, each several times?",
            )
        return self.parts <= MOST_PARTS


def _start(source: Source) -> Trail:
    return () if source.file is None else (source.file.resolve(),)
