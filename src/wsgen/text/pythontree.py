"""The syntax trees of Python files; several checks read that of the same file."""

from __future__ import annotations

import ast
import functools
import threading
from typing import Any

# Before Python 3.12, two threads that make trees at a time disturb each other ("AST constructor
# recursion depth mismatch").
_ALONE = threading.Lock()


@functools.lru_cache(maxsize=16)  # the files of a package are read one after the other
def parse(source: bytes) -> ast.Module:
    """The tree of a file, which nobody changes.

    Raises:
        SyntaxError, ValueError, RecursionError, MemoryError: It is no Python, or too deep.
    """
    with _ALONE:
        return ast.parse(source)


def parse_anew(source: str | bytes, **options: Any) -> Any:
    """A tree of its own, with the options of `ast.parse`; raises as `parse`."""
    with _ALONE:
        return ast.parse(source, **options)


def name_of(call: ast.Call) -> str:
    """The name of what a call calls, without the module before it."""
    function = call.func
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def is_text(node: ast.stmt) -> bool:
    """Whether a statement is a text alone, as docstrings are."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
