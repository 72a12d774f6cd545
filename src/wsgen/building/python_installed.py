"""Check what setuptools installed of ament_python packages, and read its warnings."""

from __future__ import annotations

import re
from configparser import ConfigParser, Error
from typing import TYPE_CHECKING

from wsgen.building.python_causes import find_keyword, find_string
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.packages.build_files.python_checks import (
    FORMER_KEYWORDS,
    SETUP_KEYWORDS,
    UNKNOWN_SETUP_OPTION,
    word_keyword,
    word_script,
    word_script_folder,
)
from wsgen.packages.build_files.python_setup import Configuration
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import ask_for_nearest, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.packages.workspace.layout import PackageFolder, Workspace


_WARNING = re.compile(r"^\S*/(?:setuptools|pkg_resources|distutils)/\S*:\d+: \w+Warning: ")
_NO_BYTECODE = re.compile(r"^warning: \w+: byte-compiling is disabled")
_UNKNOWN = re.compile(r"Unknown distribution option: '(\w+)'")
_DASHES = re.compile(r"dash-separated '([\w-]+)'")


def check_python_packages(
    packages: Iterable[PackageFolder],
    workspace: Workspace,
    error_output: Mapping[str, Sequence[str]],
) -> Iterator[Diagnostic]:
    """Check the scripts of packages where colcon installs by default, and report misspelt options.

    `error_output` has the lines that the build of each package wrote to standard error.
    """
    python = [package for package in packages if package.build_type == "ament_python"]
    for package in python:
        if (workspace.install / package.name / "share" / package.name / "package.sh").is_file():
            yield from _check_scripts(package, workspace)
        for name in _find_all(_UNKNOWN, error_output[package.name]):
            meant = nearest(name, SETUP_KEYWORDS)
            if meant and name not in FORMER_KEYWORDS:
                setup = package.path / "setup.py"
                line = find_keyword(setup, name)
                yield word_keyword(name, meant, setup, line, package.name)
    yield from _dashes(python, error_output)


def _dashes(
    packages: Iterable[PackageFolder], error_output: Mapping[str, Sequence[str]]
) -> Iterator[Diagnostic]:
    """Report once which packages spell options as setuptools will not know them any more."""
    found = {package: _find_all(_DASHES, error_output[package.name]) for package in packages}
    found = {package: names for package, names in found.items() if names}
    if found:
        first = next(iter(found))
        names = dict.fromkeys(name for names in found.values() for name in names)
        yield UNKNOWN_SETUP_OPTION.at(
            first.path / "setup.cfg",
            _line_with(first.path / "setup.cfg", next(iter(names))),
            first.name if len(found) == 1 else None,
            message=f"A later setuptools will not know {', '.join(names)} in setup.cfg of "
            f"{', '.join(package.name for package in found)}.",
            hint=f"Write {', '.join(name.replace('-', '_') for name in names)}.",
            severity=Severity.INFO,
        )


def _find_all(pattern: re.Pattern[str], lines: Iterable[str]) -> list[str]:
    return [*dict.fromkeys(match[1] for line in lines for match in pattern.finditer(line))]


def _line_with(file: Path, text: str) -> int | None:
    try:
        lines = read_regular_text(file).splitlines()
    except (OSError, ValueError):
        return None
    return next((number for number, line in enumerate(lines, 1) if text in line), None)


def _check_scripts(package: PackageFolder, workspace: Workspace) -> Iterator[Diagnostic]:
    prefix = workspace.install / package.name
    scripts = _read_scripts(workspace.build / package.name)
    elsewhere = [
        name
        for name in scripts
        if not (prefix / "lib" / package.name / name).exists() and (prefix / "bin" / name).exists()
    ]
    if elsewhere:
        cfg = package.path / "setup.cfg"
        yield word_script_folder(
            elsewhere, Configuration(cfg), package.path / "setup.py", package.name
        )
    roots = [*prefix.glob("lib/python3*/site-packages"), workspace.build / package.name]
    for name, target in scripts.items():
        problem = _find_problem(package, roots, target)
        if problem:
            setup = package.path / "setup.py"
            line = _line_of_script(setup, name)
            yield word_script(name, problem, setup, line, package.name)


def _line_of_script(setup: Path, name: str) -> int | None:
    return find_string(setup, lambda text: text.partition("=")[0].strip() == name)


def _read_scripts(build_folder: Path) -> dict[str, str]:
    """Read the console scripts, as `module:function` by name, from what setuptools wrote."""
    scripts: dict[str, str] = {}
    for file in build_folder.glob("*.egg-info/entry_points.txt"):
        parser = ConfigParser(delimiters=("=",), interpolation=None)
        parser.optionxform = str  # type: ignore[method-assign,assignment]
        try:
            parser.read(file, encoding="utf-8")
            scripts.update(parser["console_scripts"])
        except (Error, KeyError, OSError, ValueError):
            continue
    return scripts


def _find_problem(
    package: PackageFolder, roots: Sequence[Path], target: str
) -> tuple[str, str] | None:
    """Say why `module:function` cannot be called, and what to do; None if it can, or is foreign."""
    module, _, function = (part.strip() for part in target.partition(":"))
    if not function:
        return (
            f"it does not name a function of {module}",
            f"Write {module}:main, if that is the function.",
        )
    path, top = module.replace(".", "/"), module.partition(".")[0]
    files = [root / name for root in roots for name in (f"{path}.py", f"{path}/__init__.py")]
    installed = next((file for file in files if file.is_file()), None)
    if installed is not None:
        text = installed.read_text(encoding="utf-8", errors="replace")
        name = function.partition(".")[0]
        defined = (
            rf"(?m)^\s*(?:async\s+)?(?:def|class)\s+{name}\b|^\s*{name}\s*[:=]|import .*\b{name}\b"
        )
        if re.search(defined, text) or re.search(r"import\s+(?:\*|\()", text):
            return None
        known = re.findall(r"(?m)^def\s+(\w+)", text)
        return (
            f"{module} has no function {name}",
            f"{ask_for_nearest(name, known)}Define it, or name another one.",
        )
    if (package.path / f"{path}.py").is_file():
        return (
            f"the module {module} is not installed",
            f"Create {(package.path / path).parent.name}/__init__.py, and list it in packages.",
        )
    if top == package.name or nearest(top, [package.name]) or (package.path / top).is_dir():
        known = [
            ".".join(file.relative_to(package.path).with_suffix("").parts)
            for file in package.path.glob("*/*.py")
        ]
        return (
            f"the module {module} does not exist",
            f"{ask_for_nearest(module, known)}Define it, or name another one.",
        )
    return None  # of another package


def without_warnings(lines: Sequence[str]) -> list[str]:
    """Leave out the warnings of setuptools, each with the line of code that Python adds to it."""
    kept: list[str] = []
    remaining = iter(lines)
    follows_warning = False
    for line in remaining:
        if _WARNING.match(line) or _NO_BYTECODE.match(line):
            follows_warning = True
        elif follows_warning and line == "!!":  # the frame around a long text
            for inner in remaining:
                if inner == "!!":
                    break
        elif not (follows_warning and (not line or line.startswith("  "))):
            follows_warning = False
            kept.append(line)
    return kept
