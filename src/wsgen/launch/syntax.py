"""What is written where in launch files of Python, read without running them; paths in them."""

from __future__ import annotations

import ast
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


def nodes_of(file: str | Path) -> Iterator[Any]:
    """The nodes of the syntax tree of a launch file; none of one that is not Python."""
    try:
        tree = ast.parse(Path(file).read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    yield from ast.walk(tree)


def where_written(text: str, files: Iterable[str | Path]) -> tuple[str, int] | None:
    """The file and line of the one text that is this one, or a path with this part."""
    places = {
        (str(file), node.lineno)
        for file in files
        for node in nodes_of(file)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and text in node.value.split("/")
    }
    return places.pop() if len(places) == 1 else None


def keyword_of(value: object, file: str, line: int) -> tuple[str, int] | None:
    """The keyword argument of a call at the line in which a literal is written, and its line."""
    for call in nodes_of(file):
        if not isinstance(call, ast.Call) or not call.lineno <= line <= (call.end_lineno or line):
            continue
        for keyword in call.keywords:
            for node in ast.walk(keyword.value):
                if keyword.arg is not None and isinstance(node, ast.expr) and _is(node, value):
                    return keyword.arg, node.lineno
    return None


def _is(node: ast.expr, value: object) -> bool:
    try:
        written = ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return False
    return type(written) is type(value) and bool(written == value)


def first_missing(path: str) -> tuple[str, list[str]]:
    """The first part of a path that is not there, and what is in its place."""
    missing = Path(path)
    # Unlike the method, this does not raise where a name is too long or a folder is closed.
    while not os.path.isdir(missing.parent) and missing.parent != missing:
        missing = missing.parent
    try:
        return missing.name, os.listdir(missing.parent)
    except OSError:
        return missing.name, []


class UnusedAction(NamedTuple):
    """An action that a launch file creates and does not add to its description."""

    kind: str  # its class
    name: str  # of the variable
    words: frozenset[str]  # the texts in it, and the parts of paths and command lines
    file: Path
    line: int


def unused_actions(files: Iterable[Path], kinds: Iterable[str]) -> Iterator[UnusedAction]:
    """The actions of these classes that are assigned to a variable which nothing reads."""
    for file in files:
        nodes = list(nodes_of(file))
        names = [node for node in nodes if isinstance(node, ast.Name)]
        read = {node.id for node in names if isinstance(node.ctx, ast.Load)}
        for node in nodes:
            if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Call):
                continue
            target, kind = node.targets[0], ast.unparse(node.value.func).rpartition(".")[2]
            if kind in kinds and isinstance(target, ast.Name) and target.id not in read:
                words = frozenset(
                    word
                    for part in ast.walk(node.value)
                    if isinstance(part, ast.Constant) and isinstance(part.value, str)
                    for word in part.value.replace("/", " ").split()
                )
                yield UnusedAction(kind, target.id, words, file, node.lineno)
