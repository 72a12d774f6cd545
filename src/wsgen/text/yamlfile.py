"""YAML with the lines of its values, read without trusting it."""

from __future__ import annotations

import re
from copy import copy
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


SIZE_LIMIT = 2**20  # bytes; parameters are written by hand
MOST_VALUES = 100_000  # aliases count each time


class Value(NamedTuple):
    """A value of a YAML document, and the line where it is written."""

    content: Any  # a dict of texts to values, a list of values, or a plain scalar
    line: int  # 1-based

    def get(self, *keys: str) -> Value | None:
        """The value under these keys, one inside of the other; None where it is not there."""
        found: Value | None = self
        for key in keys:
            content = found.content if found is not None else None
            found = content.get(key) if isinstance(content, dict) else None
        return found

    def items(self) -> Iterator[tuple[str, Value]]:
        """The keys of a mapping with their values; nothing of what is none."""
        if isinstance(self.content, dict):
            yield from self.content.items()

    def elements(self) -> tuple[Value, ...]:
        """The elements of a list; nothing of what is none."""
        return tuple(self.content) if isinstance(self.content, list) else ()

    @property
    def plain(self) -> Any:
        """The content, without lines."""
        if isinstance(self.content, dict):
            return {key: value.plain for key, value in self.content.items()}
        elements = isinstance(self.content, list)
        return [value.plain for value in self.content] if elements else self.content

    @property
    def text(self) -> str | None:
        """The content if it is a text."""
        return self.content if isinstance(self.content, str) else None


class NotYaml(NamedTuple):
    """Why a text is not YAML."""

    message: str
    line: int  # 1-based


def load(file: Path) -> Value | NotYaml | None:
    """The first document of a file; None where it cannot be read or is empty."""
    text = _read(file)
    return None if text is None else parse(text)


def load_parameters(file: Path) -> Value | NotYaml | None:
    """The same of a file of parameters, as a node of ROS reads it: see `merge_repeated`."""
    text = _read(file)
    return None if text is None else parse(text, are_parameters=True)


def _read(file: Path) -> str | None:
    try:
        return read_regular(file, SIZE_LIMIT).decode()
    except (OSError, ValueError):
        return None


def parse(text: str, *, are_parameters: bool = False) -> Value | NotYaml | None:
    """The first document of a text; None where it has none, or more than anybody writes.

    Of keys that a mapping has twice the last one counts, as YAML is loaded; where a node reads its
    parameters, see `merge_repeated`.
    """
    import yaml  # noqa: PLC0415  20 ms that only a package with such files pays

    try:
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)
        node = loader.get_node() if loader.check_node() else None
        if are_parameters:
            merge_repeated(node)
        return None if node is None else _value(loader, node, [0])
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        return NotYaml(error.problem or "it is not YAML", mark.line + 1 if mark else 1)
    except (yaml.YAMLError, ValueError) as error:  # a character, a date that does not exist
        return NotYaml(str(error).partition("\n")[0], 1)
    except (RecursionError, OverflowError):
        return None


def parameters_of(content: Any, node: str) -> dict[str, Any]:
    """What a file of parameters, in plain values, says of a node: `/robot/manager`."""
    found: dict[str, Any] = {}
    for name, values in parameter_sections(content):
        if is_meant(name, node):
            found.update(flat_parameters(values))
    return found


def parameter_sections(content: Any, name: str = "") -> Iterator[tuple[str, dict[Any, Any]]]:
    """Full names of nodes, or patterns of them, with parameters; sections may be nested."""
    for key, section in content.items() if isinstance(content, dict) else ():
        if key == "ros__parameters":
            if isinstance(section, dict):
                yield name, section
        else:
            yield from parameter_sections(section, f"{name}/{str(key).strip('/')}".rstrip("/"))


def is_meant(pattern: str, node: str) -> bool:
    """Whether a section is for the node; `*` stands for one part of a name, `**` for several.

    As in rclcpp's `parameter_map_from` (rclcpp/src/rclcpp/parameter_map.cpp).
    """
    if "*" not in pattern:
        return pattern == node
    parts = {"**": r"(/[^/]+)*", "*": r"/[^/]+"}
    names = pattern.strip("/").split("/")
    return bool(re.fullmatch("".join(parts.get(n, "/" + re.escape(n)) for n in names), node))


def flat_parameters(values: dict[Any, Any], prefix: str = "") -> dict[str, Any]:
    """Parameters by their full names, `gains.joint_1.p`."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, dict):
            flat.update(flat_parameters(value, f"{prefix}{name}."))
        else:
            flat[f"{prefix}{name}"] = _plain(value)
    return flat


def _plain(value: Any) -> Any:
    """The value as the node sees it: what is a date to Python is a text to it."""
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)


def merge_repeated(node: Any) -> None:
    """Merge mappings of one key in a composed document, as nodes of ROS read their parameters.

    `/**:` may be written several times, each for the parameters of another node; the loader of YAML
    takes the last one, and so it does where aliases make more of them than anybody writes.
    """
    todo, seen = [node], set()
    count = 0  # of what was merged
    while todo:
        mapping = todo.pop()
        if getattr(mapping, "id", None) != "mapping" or id(mapping) in seen:
            continue
        seen.add(id(mapping))  # an alias may lead back to it
        places: dict[str, int] = {}
        copied: set[int] = set()  # places
        merged: list[tuple[Any, Any]] = []
        for key, value in mapping.value:
            place = places.get(key.value) if key.id == "scalar" else None
            if place is not None and merged[place][1].id == value.id == "mapping":
                first, both = merged[place]
                if place not in copied:
                    copied.add(place)
                    both = copy(both)  # an anchor may use the one that is written
                    both.value = list(both.value)
                    merged[place] = first, both
                    count += len(both.value)
                count += len(value.value)
                if count > MOST_VALUES:
                    return
                both.value += value.value
                continue
            if key.id == "scalar":
                places[key.value] = len(merged)
            merged.append((key, value))
        mapping.value = merged
        todo += (value for _, value in merged)


def _value(loader: Any, node: Any, count: list[int]) -> Value:
    count[0] += 1
    if count[0] > MOST_VALUES:
        raise OverflowError
    line = node.start_mark.line + 1
    if node.id == "mapping":
        loader.flatten_mapping(node)
        return Value({_key(key): _value(loader, value, count) for key, value in node.value}, line)
    if node.id == "sequence":
        return Value([_value(loader, value, count) for value in node.value], line)
    content = loader.construct_object(node)
    is_plain = isinstance(content, (str, int, float, bool, type(None)))
    return Value(content if is_plain else str(content), line)


def _key(node: Any) -> str:
    return str(node.value) if node.id == "scalar" else ""
