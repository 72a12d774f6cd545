"""Launch files in XML.

Read by expat itself: it knows the lines, fetches nothing, and costs a twentieth of lxml.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from xml.parsers import expat

from launch.frontend.entity import Entity
from launch.utilities.type_utils import read_as

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.launch.record import Location


class XmlEntity(Entity):
    """An element; its attributes are texts, which are read as the type that is asked for."""

    def __init__(self, type_name: str, location: Location, attributes: Mapping[str, str]) -> None:
        super().__init__(type_name, location)
        self.attributes = attributes
        self.elements: list[XmlEntity] = []
        self._known_elements: set[str] = set()

    def get(self, name: str, kind: Any = str, *, optional: bool = False) -> Any:
        """See `Entity`; `name-sep` beside `name` makes a list of it."""
        if name not in self.attributes:
            if optional:
                return None
            raise self.missing(name, kind)
        self._read.add(name)
        text = self.attributes[name]
        separator = self.attributes.get(f"{name}-sep")
        if separator is None:
            return _read(text, kind)
        self._read.add(f"{name}-sep")
        return [_read(item, None if kind is None else kind) for item in text.split(separator)]

    def nested(self, name: str) -> list[Entity]:
        """See `Entity`."""
        self._known_elements.add(name)
        return [element for element in self.elements if element.type_name == name]

    def children(self) -> list[Entity]:
        """See `Entity`."""
        self._known_elements.update(element.type_name for element in self.elements)
        return list(self.elements)

    def require_all_read(self) -> None:
        """See `Entity`."""
        tags = {element.type_name for element in self.elements} - self._known_elements
        if tags:
            raise ValueError(f"Unexpected nested tag(s) found in `{self.type_name}`: {tags}")
        names = set(self.attributes) - self._read
        if names:
            raise ValueError(f"Unexpected attribute(s) found in `{self.type_name}`: {names}")


def _read(text: str, kind: Any) -> Any:
    """The value that a text stands for; the text itself, which may hold substitutions, if none."""
    try:
        return read_as(text, kind)
    except ValueError:
        return text


def read(text: bytes, file: str) -> XmlEntity:
    """The root element of a launch file; ValueError with the line where it is not XML."""
    parser = expat.ParserCreate()
    root: list[XmlEntity] = []
    ancestors: list[XmlEntity] = []

    def begin(tag: str, attributes: dict[str, str]) -> None:
        entity = XmlEntity(tag, (file, parser.CurrentLineNumber), attributes)
        (ancestors[-1].elements if ancestors else root).append(entity)
        ancestors.append(entity)

    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda _tag: ancestors.pop()
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise ValueError(f"not well-formed XML: {error}", error.lineno) from None
    except ValueError as error:  # an encoding that is not known, entities that multiply
        raise ValueError(f"not well-formed XML: {error}", parser.CurrentLineNumber) from None
    return root[0]
