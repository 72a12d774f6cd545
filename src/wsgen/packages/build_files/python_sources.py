"""Mistakes in the syntax of Python programs and modules that a package installs."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.model.facts import DISTROS, OF_DISTROS
from wsgen.text.files import read_regular, save_as_utf8, wide_encoding
from wsgen.text.pythontree import parse_anew
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts, PythonPackage


PYTHON_SYNTAX = Rule(
    code="BLD066",
    name="python-syntax-error",
    severity=Severity.ERROR,
    severity_varies="a warning in a module that no program of the package starts",
    summary="A Python program or module that the package installs has a syntax error.",
    what="Looks at the scripts and Python modules that are installed, with the syntax of the "
    "Python that the target has.",
    why="The build copies the file as it is. The node ends with a `SyntaxError` when it is started "
    "or imported.",
    example="def talk(self)  # in my_robot/talker.py\n    self.publisher.publish(String())",
    instead="def talk(self):\n    self.publisher.publish(String())",
)

MOST_FILES = 500  # that are looked at in a package
MOST_BYTES = 500_000  # of each; what is larger is generated
OWN = sys.version_info[:2]
_PYTHON = lazy_pattern(rb"#![^\n]*\bpython(?:3(?:\.\d+)?)?\s*(?:\n|$)")
_OTHER_PYTHON = lazy_pattern(rb"#![^\n]*\bpython2")
# What Python 3.11 to 3.14 brought: except*, *args in an index, type aliases, type parameters,
# quotes and lines in f-strings, template strings, several exceptions without parentheses.
_NEWER = lazy_pattern(
    r"\bexcept\s*\*|\[\s*\*|,\s*\*[^,\]]*\]|^\s*type\s+\w|^\s*(?:async\s+)?(?:def|class)\s+\w+\s*\["
    r"|\b[rRbB]?[fFtT][rR]?[\"']|^\s*except\s+[^(:]+,"
)
_NEWER_AROUND = 3  # lines before the error in which a newer syntax may begin
_LONG_TEXT = lazy_pattern(r"\b[rR]?[fFtT][rR]?(?:\"\"\"|''')")
_TEMPLATE = lazy_pattern(r"\{\{|\{%|@\(|@\[")  # Jinja, empy
_FEATURE = lazy_pattern(r"(.+) (?:is|are) only supported in Python (\d+\.\d+) and greater")


def check_python_syntax(facts: BuildFacts, distro: str | None) -> Iterator[Diagnostic]:
    """Report syntax errors in the Python files that a package installs."""
    wanted = _python_of(distro)
    for file, is_started in python_files(facts).items():
        found = _syntax_error(file, wanted)
        if found is None:
            continue
        line, message, hint = found
        yield PYTHON_SYNTAX.at(
            file,
            line,
            file.name,
            message=f"{os.path.relpath(file, facts.build_file.parent)} is not valid Python"
            f"{_named(wanted) if _FEATURE.search(message) else ''}: {message}.",
            hint=hint,
            severity=Severity.ERROR if is_started else Severity.WARNING,
        )


def _python_of(distro: str | None) -> tuple[int, int] | None:
    if distro not in DISTROS:
        return None
    major, minor = (OF_DISTROS["python"][1 + DISTROS.index(distro)] or "3.10").split(".")
    return int(major), int(minor)


def _named(version: tuple[int, int] | None) -> str:
    return "" if version is None else f" {version[0]}.{version[1]}"


def python_files(facts: BuildFacts) -> dict[Path, bool]:
    """The files, and whether a program of the package surely runs them."""
    started = {one.entry_point.partition(":")[0] for one in facts.executables if one.entry_point}
    found: dict[Path, bool] = {}
    for program in facts.executables:
        if program.source is not None and _is_python(program.source):
            found[program.source] = True
    for package in facts.python_packages:
        for file, module in _modules(package):
            if len(found) < MOST_FILES and not file.name.endswith("launch.py"):
                found[file] = found.get(file, False) or module in started
    return found


def program_files(facts: BuildFacts) -> dict[str, Path]:
    """The Python files that programs of a package start with, by the names of the programs."""
    modules = {
        module: file for package in facts.python_packages for file, module in _modules(package)
    }
    found = {
        one.name: one.source or modules.get((one.entry_point or "").partition(":")[0])
        for one in facts.executables
    }
    return {name: file for name, file in found.items() if file is not None}


def _modules(package: PythonPackage) -> Iterator[tuple[Path, str]]:
    """The files of a Python package or module, and their names when they are imported."""
    if package.source.suffix == ".py":
        yield package.source, package.name
        return
    for place, folders, files in os.walk(package.source):
        folders[:] = sorted(
            one for one in folders if os.path.isfile(os.path.join(place, one, "__init__.py"))
        )
        below = os.path.relpath(place, package.source)
        parts = [package.name, *(below.split(os.sep) if below != "." else ())]
        for name in sorted(files):
            if name.endswith(".py"):
                module = parts if name == "__init__.py" else [*parts, name[: -len(".py")]]
                yield Path(place, name), ".".join(module)


def _is_python(file: Path) -> bool:
    if file.suffix not in {".py", ""}:
        return False
    try:
        head = read_regular(file, MOST_BYTES)[:200]
    except (OSError, ValueError):
        return False
    if _OTHER_PYTHON.match(head):
        return False
    return file.suffix == ".py" or _PYTHON.match(head) is not None


def _syntax_error(file: Path, wanted: tuple[int, int] | None) -> tuple[int | None, str, str] | None:
    """The line of the first mistake, what is wrong and what to do; None if nothing surely is."""
    try:
        data = read_regular(file, MOST_BYTES + 1)
    except (OSError, ValueError):
        return None
    if len(data) > MOST_BYTES:
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about escapes in strings of the user
            parse_anew(data, feature_version=min(OWN, wanted or OWN))
    except SyntaxError as error:
        return _explained(error, data, wanted)
    except ValueError:  # Python says it by a SyntaxError from 3.12 on
        return _with_zeros(data)
    except (RecursionError, MemoryError):
        return None
    return None


def _explained(
    error: SyntaxError, data: bytes, wanted: tuple[int, int] | None
) -> tuple[int | None, str, str] | None:
    if b"\0" in data:
        return _with_zeros(data)
    lines = data.decode("utf-8", "replace").splitlines()
    line = min(error.lineno, len(lines)) if error.lineno else None
    here = lines[line - 1] if line else ""
    message = (error.msg or "invalid syntax").rstrip(".")
    if _FEATURE.match(message):
        return line, message, _hint(error, message)
    if _TEMPLATE.search(here) or "too many nested" in message:
        return None
    if (wanted is None or wanted > OWN) and _may_be_newer(lines, line):
        return None
    return line, message, _hint(error, message)


def _hint(error: SyntaxError, message: str) -> str:
    newer = _FEATURE.match(message)
    if newer is not None:
        return f"Write it without the syntax that is new in Python {newer[2]}."
    if "codec" in message or "encoding" in message:
        return "Save the file as UTF-8."
    if "Missing parentheses in call to" in message:
        return "Convert the file from Python 2: 2to3 -w, or by hand."
    if isinstance(error, IndentationError):
        return "Indent the lines of a block equally, with spaces."
    return (
        "Look there and in the line before for a missing colon, comma, bracket or quotation mark."
    )


def _with_zeros(data: bytes) -> tuple[int | None, str, str]:
    encoding = wide_encoding(data) or "UTF-16"
    return 1, "it contains null bytes, as text in UTF-16 does", save_as_utf8(encoding)


def _may_be_newer(lines: list[str], line: int | None) -> bool:
    """Whether a newer Python than this one may read what this one does not."""
    if line is None:
        return False
    around: Iterable[str] = lines[max(0, line - 1 - _NEWER_AROUND) : line + 1]
    return any(map(_NEWER.search, around)) or any(map(_LONG_TEXT.search, lines[:line]))
