"""Where in the xacro files what xacro was at is written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.description.markup import elements, label, line_with, read_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.description.markup import Written
    from wsgen.description.xacro_trace import Trace


class Place(NamedTuple):
    """A line of a file."""

    file: str | None
    line: int | None = None  # 1-based


class Sources:
    """The files that xacro read, and the elements that are written in them."""

    def __init__(self, files: tuple[str, ...]) -> None:
        self.files = files
        self.texts = {file: text for file in files if (text := read_text(Path(file))) is not None}
        self.elements = [
            element for file, text in self.texts.items() for element in elements(Path(file), text)
        ]

    def defining(self, tag: str, name: str, prefix: str = "xacro:") -> Iterator[Written]:
        """The elements `<xacro:tag name="…">` that define a name."""
        for element in self.elements:
            if element.tag == f"{prefix}{tag}" and element.attributes.get("name") == name:
                yield element

    def names(self, tag: str) -> list[str]:
        """What is defined by elements `<xacro:tag name="…">`."""
        return [
            element.attributes.get("name", "")
            for element in self.elements
            if element.tag == f"xacro:{tag}"
        ]


def find(found: Trace, sources: Sources) -> Place | None:
    """The line of what xacro was at; None where it is not known, rather than a wrong one.

    Elements that are written alike are taken for the first of them.
    """
    if found.name is not None:
        return _property(found, sources)
    if getattr(found.node, "data", None) is not None:
        wanted = found.node.data.strip()
        for file, text in sources.texts.items():
            line = line_with(text, wanted)
            if line is not None:
                into = wanted[: max(0, wanted.find("$"))].count("\n")
                return Place(file, line + into)
        return None
    if getattr(found.node, "tagName", None) is None:
        return None
    for element in sources.elements:
        if _is_written_as(found, element):
            attribute = found.attribute
            line = element.line if attribute is None else element.line_of(attribute)
            return Place(str(element.file), line)
    return None


def _property(found: Trace, sources: Sources) -> Place | None:
    for element in sources.defining("property", str(found.name)):
        for attribute in ("value", "default"):
            if element.attributes.get(attribute) == found.raw:
                return Place(str(element.file), element.line_of(attribute))
    return None


def _is_written_as(found: Trace, element: Written) -> bool:
    """Whether a DOM element, some of whose attributes are values already, is this one."""
    node = found.node
    path = _path(node)
    if element.path[-len(path) :] != path:
        return False
    if found.raw is not None and element.attributes.get(str(found.attribute)) != found.raw:
        return False
    now = _without_own(dict(node.attributes.items()))
    written = _without_own(element.attributes)
    return now.keys() == written.keys() and all(
        "$" in text or now[name] in {text, ""}  # xacro empties what it has given to a macro
        for name, text in written.items()
    )


def _without_own(attributes: Mapping[str, str]) -> dict[str, str]:
    """The attributes without those that xacro itself takes away or moves."""
    own = ("xacro:", "xmlns")
    return {name: text for name, text in attributes.items() if not name.startswith(own)}


def _path(node: Any) -> tuple[str, ...]:
    path = []
    while getattr(node, "tagName", None) is not None:
        path.append(label(node.tagName, node.getAttribute("name")))
        node = node.parentNode
    return tuple(reversed(path))
