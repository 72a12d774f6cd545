"""The syntax trees of Python files; several checks read that of the same file."""

from __future__ import annotations

import ast
import functools


@functools.lru_cache(maxsize=16)  # the files of a package are read one after the other
def parse(source: bytes) -> ast.Module:
    """The tree of a file, which nobody changes.

    Raises:
        SyntaxError, ValueError, RecursionError, MemoryError: It is no Python, or too deep.
    """
    return ast.parse(source)
