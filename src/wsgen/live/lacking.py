"""What will end a Python program at once, read from its file without running it.

These are modules that are nowhere, and a file that is no Python.
"""

from __future__ import annotations

import ast
import importlib.util
import os
import re
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.text.files import read_whole
from wsgen.text.markup import read_text
from wsgen.text.pythontree import parse_anew

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

_ENTRY_POINTS = "lib/python*/site-packages/*/entry_points.txt"  # below a prefix


def lacking_modules(words: Sequence[str], variables: Mapping[str, str]) -> Iterator[str]:
    """The modules that a program imports at once, in its own file, and that are nowhere.

    The interpreter must be the one that asks. The imports at the top of the file count, up to the
    first statement of another kind: that may change where modules are looked for, or catch what
    they raise.

    Args:
        words: The command line of a Python program: the interpreter, the file, its arguments.
        variables: Its environment.
    """
    found = _first_file(words, variables)
    if found is None:
        return
    file, places = found
    for name in dict.fromkeys(_imported(file)):
        if name not in sys.stdlib_module_names and not _is_there(name, places):
            yield name


def syntax_error(words: Sequence[str], variables: Mapping[str, str]) -> tuple[Path, int] | None:
    """The file of a program that is no Python, and the line; None where it is.

    Args:
        words: As for `lacking_modules`.
        variables: Its environment.
    """
    found = _first_file(words, variables)
    if found is None:
        return None
    try:
        parse_anew(read_whole(found[0]))
    except SyntaxError as error:
        return found[0], error.lineno or 1
    except (OSError, ValueError, RecursionError, MemoryError):
        pass  # the program itself says it
    return None


def _first_file(
    words: Sequence[str], variables: Mapping[str, str]
) -> tuple[Path, list[str]] | None:
    """The file whose code a program executes first, and where it finds modules."""
    if len(words) < 2:  # noqa: PLR2004  the interpreter and the file
        return None
    script = Path(words[1])
    added = [one for one in variables.get("PYTHONPATH", "").split(os.pathsep) if one]
    places = [str(script.parent), *added, *sys.path]
    return _module_of(script, places) or script, places


def _is_there(name: str, places: Sequence[str]) -> bool:
    if PathFinder.find_spec(name, places) is not None:
        return True
    try:  # packages that are installed for editing have finders of their own
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return True  # nobody knows


def _module_of(script: Path, places: Sequence[str]) -> Path | None:
    """The file of the module that a console script of `lib/PACKAGE` starts."""
    line = re.compile(rf"^{re.escape(script.name)}\s*=\s*([\w.]+)\s*:", re.MULTILINE)
    for file in sorted(script.parents[2].glob(_ENTRY_POINTS)) if len(script.parents) > 2 else ():  # noqa: PLR2004  lib/PACKAGE
        found = line.search(read_text(file) or "")
        if found is not None:
            inside = Path(*found[1].split(".")).with_suffix(".py")
            return next((Path(one, inside) for one in places if Path(one, inside).is_file()), None)
    return None


def _imported(file: Path) -> Iterator[str]:
    """The outermost packages that a file imports before it does anything else."""
    try:
        tree = parse_anew(read_whole(file))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in tree.body:
        if isinstance(node, ast.Import):
            yield from (one.name.partition(".")[0] for one in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            yield node.module.partition(".")[0]
        elif not isinstance(node, ast.ImportFrom) and not _is_text(node):
            return


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
