"""Launch files in YAML."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args, get_origin

import yaml

from launch.frontend.entity import Entity
from launch.utilities.type_utils import SCALAR_TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.launch.record import Location


class _Mapping(dict[Any, Any]):
    """A mapping that remembers its line."""

    line = 1


class _Loader(yaml.SafeLoader):
    """The safe loader, with lines."""


def _construct_mapping(loader: _Loader, node: yaml.MappingNode) -> _Mapping:
    mapping = _Mapping(loader.construct_mapping(node, deep=True))
    mapping.line = node.start_mark.line + 1
    return mapping


_Loader.add_constructor("tag:yaml.org,2002:map", _construct_mapping)


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

    def require_all_read(self) -> None:
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


def read(text: bytes, file: str) -> YamlEntity:
    """The root of a launch file; ValueError with the line where it is not YAML."""
    loader = _Loader(text)
    try:
        content = loader.get_single_data()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = 1 if mark is None else mark.line + 1
        raise ValueError(f"not YAML: {error.problem}", line) from None
    except yaml.YAMLError as error:
        raise ValueError(f"not YAML: {error}", 1) from None
    finally:
        loader.dispose()
    if not isinstance(content, dict) or len(content) != 1:
        raise ValueError("not a launch file: it must have the one key 'launch'", 1)
    ((name, inside),) = content.items()
    return YamlEntity(str(name), (file, getattr(content, "line", 1)), inside)
