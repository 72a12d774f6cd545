"""Launch files in XML and YAML: their entities."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args, get_origin
from xml.parsers import expat

import yaml

from launch._utilities import SCALAR_TYPES, read_as
from launch.base import InvalidLaunchFileError
from launch.frontend.actions import build, build_all
from launch.frontend.expose import load_extensions
from launch.frontend.template import parse_if_substitutions, parse_substitution, unescape
from launch.launch_description import LaunchDescription
from wsgen.launching.record import RECORD, locate
from wsgen.text.files import read_regular
from wsgen.text.xmlsyntax import DEEPEST, MOST_ATTRIBUTES, find_mistake, read_with

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from launch.base import Action, Substitution
    from wsgen.launching.record import Location


SIZE_LIMIT = 2**23  # bytes; what people write by hand is far smaller
LOOK_AT_XML = "Look at this line and the one before it: tags, quotes, `&` and `<`."
LOOK_AT_YAML = "Look at this line and the one before it: indentation, colons, quotes, brackets."


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """A launch file that cannot be read as what its name says."""

    wsgen_hint: str | None = None


class NotMarkupError(ValueError):
    """Why a text is not what its name says, and what to do about it."""

    def __init__(self, reason: str, line: int = 1, hint: str | None = None) -> None:
        super().__init__(reason)
        self.line = line
        self.hint = hint


def get_launch_description_from_frontend_launch_file(launch_file_path: str) -> LaunchDescription:
    """The actions of its elements."""
    path = os.fspath(launch_file_path)
    text = read_regular(Path(path), SIZE_LIMIT)
    RECORD.launch_files.append(path)
    try:
        if len(text) > SIZE_LIMIT:
            raise NotMarkupError(f"larger than {SIZE_LIMIT >> 20} MB")
        root = _read(text, path)
    except ValueError as refusal:
        found = refusal if isinstance(refusal, NotMarkupError) else NotMarkupError(str(refusal))
        error = InvalidFrontendLaunchFileError(str(found))
        error.wsgen_hint = found.hint
        locate(error, (path, found.line))
        raise error from None
    return Parser.parse_description(root)


class Parser:
    """What packages that add tags and substitutions read these with."""

    @staticmethod
    def load_launch_extensions() -> None:
        """Import the packages that add some."""
        load_extensions()

    @staticmethod
    def parse_action(entity: Entity) -> Action:
        """The action of an entity."""
        return build(entity)

    @staticmethod
    def parse_substitution(value: str) -> list[Substitution]:
        """The substitutions of a text."""
        return parse_substitution(value)

    @staticmethod
    def parse_if_substitutions(value: Any) -> Any:
        """A value; texts in it as what they say, or as substitutions where they hold some."""
        return parse_if_substitutions(value)

    @staticmethod
    def escape_characters(value: str) -> str:
        """The text without the backslashes that protect something."""
        return unescape(value)

    @staticmethod
    def parse_description(entity: Entity) -> LaunchDescription:
        """The actions of all nested entities."""
        if entity.type_name != "launch":
            error = RuntimeError("Expected 'launch' as root tag")
            locate(error, entity.location)
            raise error
        reason = entity.get("deprecated", optional=True)
        return LaunchDescription(build_all(entity), deprecated_reason=reason)


def _read(text: bytes, path: str) -> Entity:
    if path.lower().endswith(".xml"):
        return read_xml(text, path)

    return read_yaml(text, path)


class Entity:
    """A tag with attributes and nested entities; knows which of them were not asked for."""

    parent = None  # as in the original, whose entities do not know it either

    def __init__(self, type_name: str, location: Location) -> None:
        self.type_name = type_name
        self.location = location
        self._read: set[str] = set()

    def get(self, name: str, kind: Any = str, *, optional: bool = False) -> Any:
        """An attribute as that type; the text itself where it may hold substitutions.

        Raises:
            AttributeError: it is not there, and not optional.
            TypeError: it is of another type.
        """
        raise NotImplementedError

    def get_attr(
        self, name: str, *, data_type: Any = str, optional: bool = False, can_be_str: bool = True
    ) -> Any:
        """An attribute, or the nested entities of a name, as packages ask for it; see `get`."""
        kinds = get_args(data_type)
        if kinds and isinstance(kinds[0], type) and issubclass(kinds[0], Entity):
            found = self.nested(name)
            if not (found or optional):
                raise self.missing(name, data_type)
            return found or None
        value = self.get(name, data_type, optional=optional)
        if isinstance(value, str) and data_type not in {str, None} and not can_be_str:
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.type_name}' expected to be of type "
                f"'{data_type}', got '{value}'"
            )
        return value

    def nested(self, name: str) -> list[Entity]:
        """The entities of that name which describe this one."""
        raise NotImplementedError

    @property
    def children(self) -> list[Entity]:
        """All nested entities, which are actions of their own."""
        raise NotImplementedError

    def assert_entity_completely_parsed(self) -> None:
        """Refuse what was not asked for, because no action knows it; ValueError."""
        raise NotImplementedError

    def missing(self, name: str, kind: Any) -> AttributeError:
        """The error of a missing attribute, in the words of the original."""
        return AttributeError(
            f"Attribute '{name}' of type '{kind}' not found in Entity '{self.type_name}'"
        )


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
            return _typed(text, kind)
        self._read.add(f"{name}-sep")
        return [_typed(item, None if kind is None else kind) for item in text.split(separator)]

    def nested(self, name: str) -> list[Entity]:
        """See `Entity`."""
        self._known_elements.add(name)
        return [element for element in self.elements if element.type_name == name]

    @property
    def children(self) -> list[Entity]:
        """See `Entity`."""
        self._known_elements.update(element.type_name for element in self.elements)
        return list(self.elements)

    def assert_entity_completely_parsed(self) -> None:
        """See `Entity`."""
        tags = {element.type_name for element in self.elements} - self._known_elements
        if tags:
            raise ValueError(f"Unexpected nested tag(s) found in `{self.type_name}`: {tags}")
        names = set(self.attributes) - self._read
        if names:
            raise ValueError(f"Unexpected attribute(s) found in `{self.type_name}`: {names}")


def _typed(text: str, kind: Any) -> Any:
    """The value that a text stands for; the text itself, which may hold substitutions, if none."""
    try:
        return read_as(text, kind)
    except ValueError:
        return text


def read_xml(text: bytes, file: str) -> XmlEntity:
    """The root element of a launch file; NotMarkupError where it is not XML."""
    parser = expat.ParserCreate()
    root: list[XmlEntity] = []
    ancestors: list[XmlEntity] = []

    def begin(tag: str, attributes: dict[str, str]) -> None:
        if len(ancestors) >= DEEPEST or len(attributes) > MOST_ATTRIBUTES:
            raise expat.ExpatError  # `find_mistake` says the same
        entity = XmlEntity(tag, (file, parser.CurrentLineNumber), attributes)
        (ancestors[-1].elements if ancestors else root).append(entity)
        ancestors.append(entity)

    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda _tag: ancestors.pop()
    try:
        read_with(parser, text)
    except expat.ExpatError as error:
        mistake = find_mistake(text)
        what, line, hint = mistake or (error, parser.CurrentLineNumber, LOOK_AT_XML)
        raise NotMarkupError(f"not well-formed XML: {what}", line, hint) from None
    return root[0]


class _Mapping(dict[Any, Any]):
    """A mapping that remembers its line."""

    line = 1


class _Loader(yaml.SafeLoader):
    """The safe loader, with lines."""


def _construct_mapping(loader: _Loader, node: yaml.MappingNode) -> _Mapping:
    mapping = _Mapping(loader.construct_mapping(node, deep=True))
    mapping.line = node.start_mark.line + 1
    return mapping


def _construct_date(loader: _Loader, node: yaml.ScalarNode) -> Any:
    try:
        return loader.construct_yaml_timestamp(node)
    except ValueError as error:
        raise NotMarkupError(
            f"not YAML: `{node.value}` has the form of a date, and is none ({error})",
            node.start_mark.line + 1,
            f"Write it in quotes if it is a text: '{node.value}'",
        ) from None


_Loader.add_constructor("tag:yaml.org,2002:map", _construct_mapping)
_Loader.add_constructor("tag:yaml.org,2002:timestamp", _construct_date)


class YamlEntity(Entity):
    """A name with a mapping or a list; its values have types of their own."""

    def __init__(self, type_name: str, location: Location, content: Any) -> None:
        super().__init__(type_name, location)
        self.content = content

    def get(self, name: str, kind: Any = str, *, optional: bool = False) -> Any:
        """See `Entity`."""
        if not isinstance(self.content, dict) or name not in self.content:
            if optional:
                return None
            raise self.missing(name, kind)
        self._read.add(name)
        value = self.content[name]
        if not (isinstance(value, str) or _is_a(value, kind)):
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.type_name}' expected to be of type "
                f"'{kind}', got '{type(value)}'"
            )
        return value

    def nested(self, name: str) -> list[Entity]:
        """See `Entity`."""
        if not isinstance(self.content, dict) or name not in self.content:
            return []
        self._read.add(name)
        content = self.content[name]
        if not isinstance(content, list) or not all(isinstance(one, dict) for one in content):
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.type_name}' expected to be a list of mappings"
            )
        return [self._entity(name, one, one) for one in content]

    @property
    def children(self) -> list[Entity]:
        """See `Entity`; either the entity is the list, or it has it as `children`."""
        content = self.content
        if isinstance(content, dict):
            if "children" not in content:
                raise ValueError(f"Expected entity `{self.type_name}` to have children entities.")
            self._read.add("children")
            content = content["children"]
        if not isinstance(content, list):
            raise TypeError(f"Expected the children of `{self.type_name}` to be a list")
        return list(self._only(content))

    def _only(self, content: Iterable[Any]) -> Iterable[Entity]:
        for child in content:
            if not isinstance(child, dict) or len(child) != 1:
                raise RuntimeError("Subentities should only have one root")
            ((name, inside),) = child.items()
            yield self._entity(str(name), inside, child)

    def _entity(self, name: str, content: Any, mapping: Any) -> YamlEntity:
        return YamlEntity(name, (self.location[0], getattr(mapping, "line", 1)), content)

    def assert_entity_completely_parsed(self) -> None:
        """See `Entity`."""
        names = set(self.content) - self._read if isinstance(self.content, dict) else set()
        if names:
            raise ValueError(f"Unexpected key(s) found in `{self.type_name}`: {names}")


def _is_a(value: Any, kind: Any) -> bool:
    """Whether a value has the type; with None, any that a parameter may have."""
    if get_origin(kind) is list:
        (item_kind,) = get_args(kind)
        return isinstance(value, list) and all(isinstance(item, item_kind) for item in value)
    if kind is None:
        return isinstance(value, (*SCALAR_TYPES, list))
    if kind is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, kind) and not (kind is int and isinstance(value, bool))


def read_yaml(text: bytes, file: str) -> YamlEntity:
    """The root of a launch file; NotMarkupError where it is not YAML."""
    loader = _Loader(text)
    try:
        content = loader.get_single_data()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = 1 if mark is None else mark.line + 1
        raise NotMarkupError(f"not YAML: {error.problem}", line, LOOK_AT_YAML) from None
    except yaml.YAMLError as error:
        raise NotMarkupError(f"not YAML: {error}", 1, LOOK_AT_YAML) from None
    finally:
        loader.dispose()
    if not isinstance(content, dict) or len(content) != 1:
        reason = "not a launch file: it must have the one key 'launch'"
        raise NotMarkupError(reason, 1, "Write `launch:` at the top, the actions in a list below.")
    ((name, inside),) = content.items()
    return YamlEntity(str(name), (file, getattr(content, "line", 1)), inside)
