"""Check what a build left: the files in the install space, and build folders made elsewhere.

CMake keeps absolute paths. In a copy of a workspace it only warns on standard error, and then
builds the original.
"""

from __future__ import annotations

import os
import re
import shlex
from collections import Counter
from configparser import ConfigParser, Error
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.building.python_causes import find_keyword, find_string
from wsgen.building.toolchain import INDEX
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.packages.build_files.cmake_checks import missing_ament_package
from wsgen.packages.build_files.cmake_text import read_calls
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
from wsgen.text.suggestions import ask_for_nearest, nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.packages.workspace.layout import PackageFolder, Workspace


STALE_FILES = Rule(
    code="BLD024",
    name="stale-files",
    severity=Severity.WARNING,
    summary="The install space has files that the package no longer installs.",
    what="Compares the share folder of the package with the list of files that CMake or setuptools "
    "installed, unless install() runs a script.",
    why="Neither removes files that an earlier build installed. A launch file still finds "
    "them here, but not after a build in a clone of the workspace.",
    example="git mv model/robot.xacro model/arm.xacro; wsgen build",
    instead="rm -r install/my_robot build/my_robot; wsgen build",
)
RELOCATED_WORKSPACE = Rule(
    code="BLD025",
    name="relocated-workspace",
    severity=Severity.WARNING,
    summary="The workspace was moved, copied or cloned after it was built.",
    what="Compares the folder in CMakeCache.txt with the build folder. `wsgen build` has CMake "
    "make its caches anew.",
    why="CMake keeps absolute paths: `colcon build` fails, or goes on building in the first place. "
    "The install space may hold files of the first build.",
    example="cp -r ws ws_2; cd ws_2; wsgen build",
    instead="cp -r ws ws_2; cd ws_2; rm -r build install log; wsgen build",
)
RELOCATED_PACKAGE = Rule(
    code="BLD026",
    name="relocated-package",
    severity=Severity.WARNING,
    summary="A package was moved to another folder after it was built.",
    what="Compares the source folder in CMakeCache.txt with the folder of the package. `wsgen "
    "build` has CMake make its caches anew.",
    why="CMake keeps absolute paths: `colcon build` looks for the sources in the first folder.",
    example="mv src/my_robot src/robots/my_robot; wsgen build",
    instead="mv src/my_robot src/robots/my_robot; rm -r build/my_robot; wsgen build",
)

# What lists the installed files, in the build folder.
MANIFESTS = {
    "ament_cmake": "install_manifest.txt",
    "ament_python": "install.log",
    "cmake": "install_manifest.txt",
}
COLCON_FILES = (
    *("package.sh", "package.bash", "package.zsh", "package.ps1", "package.dsv"),
    "package.xml",  # of a Python package that does not install it
)
COLCON_FOLDERS = frozenset({"hook"})
NAMED = 5  # files in a message


def check_installed(
    packages: Iterable[PackageFolder], workspace: Workspace
) -> Iterator[Diagnostic]:
    """Check the files that packages installed, where colcon puts them by default.

    With --install-base, --merge-install or --symlink-install nothing is checked.
    """
    for package in packages:
        prefix = workspace.install / package.name
        # colcon writes it in every build.
        if package.diagnostics or not (prefix / "share" / package.name / "package.sh").is_file():
            continue
        if package.build_type in MANIFESTS:
            if (prefix / INDEX / package.name).is_symlink():
                continue  # colcon build --symlink-install: CMake does not list links
            manifest = workspace.build / package.name / MANIFESTS[package.build_type]
            written = _read_install_manifest(manifest, prefix)
            if package.build_type == "ament_cmake" and not _is_registered(package, prefix, written):
                file = package.path / "CMakeLists.txt"
                line = max((call.line for call in read_calls(file)), default=None)
                yield missing_ament_package(package.name, file, line)
            elif written:
                yield from _stale_files(package, workspace, prefix, written)


def _read_install_manifest(manifest: Path, prefix: Path) -> frozenset[str]:
    """List what was installed into the prefix, as paths relative to it; empty if unknown.

    A DESTINATION that ends in a slash gives two slashes in a row.
    """
    try:
        text = read_regular_text(manifest)
    except (OSError, ValueError):
        return frozenset()
    roots = {f"{prefix}/", f"{prefix.resolve()}/"}
    paths = [os.path.normpath(line) for line in text.splitlines()]
    return frozenset(
        path.removeprefix(root) for path in paths for root in roots if path.startswith(root)
    )


def _is_registered(package: PackageFolder, prefix: Path, written: frozenset[str]) -> bool:
    """Whether ROS finds the package, and not only by a marker of an earlier build."""
    marker = f"{INDEX}/{package.name}"
    return marker in written if written else (prefix / marker).exists()


def _stale_files(
    package: PackageFolder, workspace: Workspace, prefix: Path, written: frozenset[str]
) -> Iterator[Diagnostic]:
    calls = read_calls(package.path / "CMakeLists.txt")
    if any(call.command == "install" and {"CODE", "SCRIPT"} & {*call.arguments} for call in calls):
        return  # CMake does not list what a script installs
    share = prefix / "share" / package.name
    stale = [
        name
        for name in _list_files(share)
        if f"share/{package.name}/{name}" not in written and name not in COLCON_FILES
    ]
    if stale:
        is_python = package.build_type == "ament_python"
        where = "data_files in setup.py" if is_python else "install() in CMakeLists.txt"
        folders = shlex.join(
            str(space / package.name) for space in (workspace.install, workspace.build)
        )
        yield STALE_FILES.at(
            share,
            element=package.name,
            message=f"The install space of {package.name} has files that the package no longer "
            f"installs: {some_of(stale, NAMED)}. A fresh build will not have them.",
            hint=f"If that is intended, remove them (rm -rf {folders}) and build again. Otherwise "
            f"add them to {where}.",
        )


def _list_files(share: Path) -> Iterator[str]:
    for folder, folders, files in os.walk(share):
        below = Path(folder).relative_to(share)
        folders[:] = sorted(
            name
            for name in folders
            if name != "__pycache__" and (below.parts or name not in COLCON_FOLDERS)
        )
        yield from ((below / name).as_posix() for name in sorted(files))


ENTRY = re.compile(r"^CMAKE_(CACHEFILE_DIR|HOME_DIRECTORY):INTERNAL=(.*)$", re.MULTILINE)
# With these options CMake uses other build folders, or a new cache.
NEW_CACHE = "--cmake-clean-cache"
OTHER_CACHE = ("--build-base", NEW_CACHE)


def find_relocated(
    workspace: Workspace, packages: Iterable[PackageFolder], colcon_arguments: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """Report packages whose CMake cache is of another place; once for a whole workspace."""
    if any(argument.startswith(OTHER_CACHE) for argument in colcon_arguments):
        return ()
    found: list[Diagnostic] = []
    packages = tuple(packages)
    counts = Counter(package.name for package in packages)
    for package in packages:
        if counts[package.name] > 1:
            continue  # that is the error: the cache is of one of them
        folder = workspace.build / package.name
        try:
            text = read_regular_text(folder / "CMakeCache.txt")
        except (OSError, ValueError):
            continue
        remembered = dict(ENTRY.findall(text))
        built_in = remembered.get("CACHEFILE_DIR", str(folder))
        source = remembered.get("HOME_DIRECTORY", str(package.path))
        if os.path.realpath(built_in) != os.path.realpath(folder):
            return (_relocated_workspace(workspace, built_in),)
        if os.path.realpath(source) != os.path.realpath(package.path):
            found.append(_relocated_package(workspace, package, source))
    return tuple(found)


def _relocated_workspace(workspace: Workspace, built_in: str) -> Diagnostic:
    spaces = (workspace.build, workspace.install, workspace.log)
    return RELOCATED_WORKSPACE.at(
        workspace.build,
        message=f"The workspace was moved, copied or cloned after a build in {built_in}: CMake's "
        "caches are made anew.",
        hint="To be rid of all files of that build, build again after: rm -rf "
        f"{shlex.join(map(str, spaces))}",
    )


def _relocated_package(workspace: Workspace, package: PackageFolder, source: str) -> Diagnostic:
    spaces = (workspace.build / package.name, workspace.install / package.name)
    return RELOCATED_PACKAGE.at(
        package.path,
        element=package.name,
        message=f"{package.name} was moved: it was built from {source} before. CMake's caches are "
        "made anew.",
        hint="To be rid of all files of that build, build again after: rm -rf "
        f"{shlex.join(map(str, spaces))}",
    )


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
