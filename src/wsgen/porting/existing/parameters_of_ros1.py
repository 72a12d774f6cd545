"""Files of parameters of ROS 1, as nodes of ROS 2 read them; and the files of a package."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.porting.existing.launch_values import UnsaidError, unfit
from wsgen.text.markup import read_text
from wsgen.text.yamlfile import NotYaml, Value, parse

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence
    from pathlib import Path


MOST_FILES = 5_000  # of a package that are looked at
_CONTROLLER = re.compile(r"\w+_controllers?/\w+")
_TOP_KEY = re.compile(r"([\w./~-]+|\"[^\"\n]*\"|'[^'\n]*')[ \t]*:(?=\s|\Z)")
_INDENT = "    "  # of what is in `ros__parameters`


def files_in(folder: Path) -> list[str]:
    """The files of a package, by their paths in it; hidden ones are left out."""
    found = list[str]()
    for file in sorted(folder.rglob("*")):
        path = file.relative_to(folder)
        if not any(part.startswith(".") for part in path.parts) and file.is_file():
            found.append(path.as_posix())
        if len(found) >= MOST_FILES:
            break
    return found


def refuse_controllers(value: Value, what: str) -> None:
    """Raise UnsaidError for parameters of controllers of ros_control."""
    if _of_controllers(value):
        raise UnsaidError(
            f"{what} has controllers of ros_control.",
            "Describe the joints in <ros2_control>, and the controllers in a file for "
            "controller_manager; --control writes both.",
        )


def _of_controllers(value: Value) -> bool:
    return any(
        key == "pid_gains"
        or (key == "type" and one.text is not None and _CONTROLLER.fullmatch(one.text) is not None)
        or _of_controllers(one)
        for key, one in value.items()
    )


def port_parameters(file: Path, keys: Sequence[str], nodes: Collection[str]) -> str:
    """The text of a file of parameters of ROS 1, as one of ROS 2.

    Args:
        file: the file.
        keys: the names above its parameters: namespaces, and the last may be a node's.
        nodes: the nodes whose parameters stand below their names.

    Raises:
        UnsaidError: It has what parameters of ROS 2 cannot be.
    """
    text = read_text(file)
    value = None if text is None else parse(text)
    if text is None or value is None or isinstance(value, NotYaml):
        reason = value.message if isinstance(value, NotYaml) else "it is empty, or unreadable"
        raise UnsaidError(
            f"{file.name} is not a file of parameters: {reason}.", "Correct the file."
        )
    if "ros__parameters" in text:
        return text
    if not isinstance(value.content, dict):
        raise UnsaidError(
            f"{file.name} has no names for its values.", "Write each value behind a name."
        )
    refuse_controllers(value, file.name)
    for line, what, advice in unfit(value):
        raise UnsaidError(f"{file.name}:{line}: {what}", advice)
    is_of_node = bool(keys) and keys[-1] in nodes
    namespaces = keys[:-1] if is_of_node else keys
    lines = [line for line in text.splitlines() if not line.startswith(("---", "%YAML"))]
    if keys or text.lstrip().startswith("{") or not nodes & value.content.keys():
        name = f"/**/{keys[-1]}" if is_of_node else "/**"
        return "\n".join(_section(name, lines, namespaces)) + "\n"
    ported, others = list[str](), list[str]()
    for key, block in _blocks(lines):
        if key in nodes:
            first = block[0].partition(":")[2].rstrip()
            ported += [f"/**/{key}:", f"  ros__parameters:{first}", *_indented(block[1:], _INDENT)]
        else:
            others += block
    has_others = any(line.strip() and not line.lstrip().startswith("#") for line in others)
    before = _section("/**", others, ()) if has_others else others
    return "\n".join((*before, *ported)).strip("\n") + "\n"


def _section(name: str, lines: Sequence[str], namespaces: Sequence[str]) -> list[str]:
    """The parameters of nodes with a name, below the namespaces of the parameters."""
    heads = [f"{_INDENT}{'  ' * depth}{key}:" for depth, key in enumerate(namespaces)]
    indent = _INDENT + "  " * len(namespaces)
    return [f"{name}:", "  ros__parameters:", *heads, *_indented(lines, indent)]


def _indented(lines: Sequence[str], indent: str) -> list[str]:
    return [indent + line if line.strip() else "" for line in lines]


def _blocks(lines: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    """The keys of a mapping with their lines; first, without a key, the lines before them."""
    key, block = "", list[str]()
    for line in lines:
        found = _TOP_KEY.match(line)
        if found is not None:
            yield key, block
            key, block = found[1].strip("\"'"), []
        block.append(line)
    yield key, block
