"""Finding one's way in a COLLADA document."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.mesh_content import BrokenMeshError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.xmltree import Element

LONGEST_NUMBER = 18  # digits


class Ids:
    """The elements of a document by their id; of two with one id the first, as in Gazebo."""

    def __init__(self, root: Element) -> None:
        self._elements: dict[str, Element] = {}
        for element in root.iter("{*}*"):
            name = element.get("id")
            if name is not None:
                self._elements.setdefault(name, element)

    def __len__(self) -> int:
        return len(self._elements)

    def get(self, name: str, kind: str) -> Element | None:
        """The element with that id, if it is of that kind."""
        found = self._elements.get(name)
        return found if found is not None and found.tag.rpartition("}")[2] == kind else None

    def find(self, url: str | None, what: str) -> Element:
        """The element with the id behind the # of an address, which is to be `what`."""
        found = self._elements.get((url or "").removeprefix("#"))
        if found is None:
            raise BrokenMeshError(
                f"refers to {what} `{url or ''}` that it does not have: "
                "Gazebo crashes on it or leaves it out"
            )
        return found


def children(element: Element, *names: str) -> Iterator[Element]:
    """The child elements with one of these names, in whatever namespace."""
    for inner in element.iterchildren("{*}*"):
        if inner.tag.rpartition("}")[2] in names:
            yield inner


def child(element: Element, name: str) -> Element | None:
    """The first child element of that name."""
    return next(children(element, name), None)


def whole_number(element: Element, name: str, default: int) -> int:
    """An attribute that is a whole number of 0 or more."""
    text = element.get(name, str(default)).strip()
    if not text.isdecimal() or len(text) > LONGEST_NUMBER:
        raise BrokenMeshError(f'has {name}="{text}" in a <{element.tag.rpartition("}")[2]}>')
    return int(text)
