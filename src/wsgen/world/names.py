"""Under which names things can stand in a world or model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.world.scopes import WORLD
from wsgen.world.source import POSE_FRAMES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.world.scopes import Kind, Node, Scope
    from wsgen.world.source import Version
    from wsgen.xmltree import Element

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
