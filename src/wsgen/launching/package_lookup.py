"""The packages that a launch file looks up: where they are, and what is reported about them.

A package that is released for ROS 2, or that package.xml declares, need not be installed: its share
folder is one that does not exist, `known_packages.prefix()`, and what would be in it is unknown. A
package that nobody knows is reported, and is then treated in the same way, so that one evaluation
reports what is wrong with the rest and finds the robots.
"""

from __future__ import annotations

import ast
import os
import re
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.launching import known_packages
from wsgen.launching.record import RECORD, caller, callers
from wsgen.model.plan import Lookup
from wsgen.packages.source_shares import is_source, note_use
from wsgen.text.markup import read_text, without_comments
from wsgen.text.tables import read_table
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Collection, Iterable, Sequence

    from wsgen.launching.record import Location


NOT_HERE = Rule(
    code="LCH046",
    name="not-installed-here",
    severity=Severity.INFO,
    summary="The launch file includes launch files, or starts nodes, that this machine lacks.",
    what="Looks for included launch files of packages that are not installed, unless "
    "docs/launch.md lists their arguments, and for nodes that this machine could not compile.",
    why="`ros2 launch` starts them where they are installed; here they are left out of the plan "
    "and of the simulation.",
    example="IncludeLaunchDescription([FindPackageShare('nav2_bringup'), "
    "'/launch/navigation_launch.py'])",
    instead="source /opt/ros/iron/setup.bash",
)
_DEPENDENCY = lazy_pattern(r"<(\w*depend)\b[^>]*>\s*([\w.-]+)\s*</")
LEFT_OUT = "wsgen_left_out.txt"  # left_out.cmake of wsgen.building writes it
_FOR_BUILD = ("depend", "build_depend")


# Why a program of the workspace is left out, in the words of a live run.
NOT_COMPILED = "it is not compiled; with ROS 2 installed and sourced, `wsgen build` compiles it"


def find_prefix(package: str, prefix: str | None) -> str | None:
    """The prefix of a package that is looked up, or where ROS would have it.

    `prefix` is the one that has the package, None where it is not installed. None comes back for a
    package that nobody knows if the launch file, or a library, handles that itself.
    """
    location = caller() or RECORD.visited
    is_of_user = not is_of_library(location)
    if is_of_user:
        RECORD.lookups.setdefault(package, location)
    else:
        location = RECORD.visited
    if prefix is not None:
        note_use(package, os.environ)
        return prefix
    if not known_packages.is_known(package):
        if known_packages.is_released(package) or declares(RECORD.launch_files[:1], package):
            RECORD.note_unresolved(package, "the package is not installed", location)
        elif not is_of_user or any(_is_handled(*place) for place in callers()):
            return None
        else:
            _report_unknown(package, location)
        known_packages.declare(package)
    return known_packages.prefix()


def source_of(package: str) -> str | None:
    """The source folder of a package that is not built, which also has its Python modules."""
    from ament_index_python.packages import get_packages_with_prefixes

    share = f"{get_packages_with_prefixes().get(package)}/share/{package}"
    return share if is_source(share) else None


def is_of_library(location: Location | None) -> bool:
    """Whether a library looks for something that it can do without."""
    return location is not None and location[0].startswith((sys.prefix, sys.base_prefix))


def _is_handled(file: str, line: int) -> bool:
    """Whether the line of a launch file is in a `try` with handlers."""
    from wsgen.launching.explain_missing import nodes_of

    return any(
        isinstance(node, ast.Try)
        and node.handlers
        and node.lineno <= line <= (node.body[-1].end_lineno or line)
        for node in nodes_of(file)
    )


def _report_unknown(package: str, location: Location | None) -> None:
    from wsgen.launching.explain import diagnose
    from wsgen.launching.explain_missing import missing_package

    RECORD.report(diagnose(missing_package(package), location))


def manifest_of(file: str | Path) -> Path | None:
    """The nearest package.xml above a file, installed or in the source."""
    return next(
        (
            folder / "package.xml"
            for folder in Path(file).absolute().parents
            if (folder / "package.xml").is_file()
        ),
        None,
    )


def _dependencies(manifest: Path) -> list[tuple[str, str]]:
    """The dependencies in a package.xml: element and package."""
    return _DEPENDENCY.findall(without_comments(read_text(manifest) or ""))


def declares(files: Iterable[str], package: str) -> bool:
    """Whether the package that one of the files lies in says that it needs another one."""
    manifests = filter(None, map(manifest_of, files))
    return any(package == name for one in manifests for _, name in _dependencies(one))


def targets_left_out(folder: str, package: str) -> tuple[str, ...] | None:
    """The targets of an installed package that `wsgen build` left out; None where it left out none.

    `folder` is where its programs would be. The build writes them into its own folder.
    """
    for workspace in Path(folder).parents[2:4]:  # of a merged install space, of one a package
        text = read_text(workspace / "build" / package / LEFT_OUT)
        if text is not None:
            return tuple(re.findall(r"^target (.+)$", text, re.MULTILINE))
    return None


def needs_missing_library(folder: str, package: str) -> bool:
    """Whether an installed package depends on a library of ROS that is not installed.

    `folder` is where its programs would be: such a package is built without what needs the library.
    """
    from ament_index_python.packages import get_packages_with_prefixes

    installed = get_packages_with_prefixes()
    manifest = Path(folder).parents[1] / "share" / package / "package.xml"
    return any(
        element in _FOR_BUILD and name not in installed and known_packages.is_released(name)
        for element, name in _dependencies(manifest)
    )


def report(launch_file: str) -> None:
    """Report the packages that are not declared, and what is left out of the plan."""
    from ament_index_python.resources import has_resource

    manifest = manifest_of(launch_file)
    if manifest is not None:
        _report_undeclared(manifest)
    reported = {one.element for one in RECORD.diagnostics}
    left_out = [entry for entry in RECORD.left_out if entry[1] not in reported]
    # Not a list of all packages: each launch file of a large workspace would read it.
    installed = {package for _, package, _ in left_out if has_resource("packages", package)}
    _report_left_out(
        [one for one in left_out if one[1] not in installed],
        launch_file,
        "Not installed on this machine, and left out",
        "Build them in this workspace, or source an installation of ROS that has them, if the "
        "robot needs them.",
    )
    _report_left_out(
        [one for one in left_out if one[1] in installed],
        launch_file,
        "Not compiled, and left out",
        "`wsgen build` compiles them where a ROS with their dependencies is sourced (source "
        "/opt/ros/<distro>/setup.bash).",
    )


def _report_left_out(
    left_out: Sequence[tuple[str, str, Location | None]], launch_file: str, why: str, hint: str
) -> None:
    if left_out:
        names = [
            f"{name} of {package}" + (f" (line {location[1]})" if location else "")
            for name, package, location in left_out
        ]
        file, line = left_out[0][2] or (launch_file, None)
        message = f"{why}: {listed(list(dict.fromkeys(names)))}."
        RECORD.report(NOT_HERE.at(Path(file), line, message=message, hint=hint))


def lookups() -> tuple[Lookup, ...]:
    """The packages that launch files of the user look up."""
    return tuple(
        Lookup(package=package, file=Path(location[0]), line=location[1])
        for package, location in RECORD.lookups.items()
        if location is not None
    )


def _note_imports(manifest: Path) -> None:
    """Note the packages whose modules the launch files of a package import, as lookups."""
    from ament_index_python.packages import get_packages_with_prefixes
    from wsgen.launching.explain_missing import parsed
    from wsgen.packages.imported_packages import certain_nodes, packages_of_launch_file

    installed = get_packages_with_prefixes()
    for file in RECORD.launch_files:
        where = manifest_of(file)
        tree = parsed(file) if where is not None and where.samefile(manifest) else None
        if tree is not None:
            nodes = certain_nodes(tree, [])
            for package, line in packages_of_launch_file(Path(file), nodes, installed):
                RECORD.lookups.setdefault(package, (file, line))


def _report_undeclared(manifest: Path) -> None:
    _note_imports(manifest)
    declared = {name for _, name in _dependencies(manifest)}
    found = {
        package: location
        for package, location in sorted(RECORD.lookups.items())
        if package not in declared | {RECORD.package, manifest.parent.name}
        and not is_brought(package, declared)
        and location is not None
        and (where := manifest_of(location[0]))
        and where.samefile(manifest)
        and not any(one.element == package for one in RECORD.diagnostics)
    }
    if not found:
        return
    file, line = min(found.values())
    message, hint = undeclared(
        list(found),
        f"the launch file{'s use' if len(RECORD.launch_files) > 1 else ' uses'}",
    )
    RECORD.report(UNDECLARED_PACKAGE.at(Path(file), line, message=message, hint=hint))


ROS2_PKG_PREFIX = ["ros2", "pkg", "prefix"]


def runs_ros2_pkg(source: object) -> bool:
    """Whether the text of a Python module may run it, which few do."""
    text = source.encode() if isinstance(source, str) else source
    return isinstance(text, bytes) and b"prefix" in text and b"ros2" in text


def answer_ros2_pkg() -> None:
    """Let `subprocess`, and with it `os.popen`, print what `ros2 pkg prefix` would.

    The package is looked up as `get_package_prefix()` looks it up, and reported as there.
    """
    import subprocess  # which takes milliseconds

    start = subprocess.Popen.__init__

    def run(process: subprocess.Popen[Any], args: Any, *more: Any, **options: Any) -> None:
        start(process, _answered_ros2_pkg(args), *more, **options)

    if not getattr(start, "is_answered", False):
        run.is_answered = True  # type: ignore[attr-defined]
        subprocess.Popen.__init__ = run  # type: ignore[assignment,method-assign]


def _answered_ros2_pkg(args: Any) -> Any:
    """The command to run instead; another one is left as it is."""
    import shlex
    import shutil

    try:
        words = shlex.split(args) if isinstance(args, str) else [os.fspath(one) for one in args]
    except (TypeError, ValueError):
        return args
    options = [word for word in words[len(ROS2_PKG_PREFIX) :] if word.startswith("-")]
    names = [word for word in words[len(ROS2_PKG_PREFIX) :] if not word.startswith("-")]
    if (
        words[: len(ROS2_PKG_PREFIX)] != ROS2_PKG_PREFIX
        or len(names) != 1
        or shutil.which(ROS2_PKG_PREFIX[0])
    ):
        return args
    from ament_index_python import packages

    before = RECORD.reading
    # Not the line of `os` or `subprocess`, which is none of the user's.
    RECORD.reading = next((one for one in callers() if one[0] in RECORD.launch_files), before)
    try:
        found = packages.get_package_prefix(names[0])
    except (KeyError, ValueError):
        said = ["sh", "-c", "echo 'Package not found' >&2; exit 1"]
    else:
        said = ["echo", os.path.join(found, "share", names[0]) if options else found]
    finally:
        RECORD.reading = before
    return shlex.join(said) if isinstance(args, str) else said


UNDECLARED_PACKAGE = Rule(
    code="LCH045",
    name="undeclared-package",
    severity=Severity.WARNING,
    summary="The launch file uses packages that `package.xml` does not declare.",
    what="Compares the packages of which the launch files of a package look up a folder or a "
    "program with the dependencies in `package.xml`.",
    why="`rosdep install` does not install them, so that the launch fails on another machine.",
    example="Node(package='slam_toolbox', executable='sync_slam_toolbox_node')",
    instead="<!-- package.xml -->\n<exec_depend>slam_toolbox</exec_depend>",
)
MOST_NAMED = 12  # packages in a message


def is_brought(package: str, declared: Collection[str]) -> bool:
    """Whether one of the declared packages needs a package, so that it is installed with it."""
    brought = _brought()
    return any(
        re.fullmatch(pattern, package) is not None
        for one in declared
        for pattern in brought.get(one, ())
    )


@cache
def _brought() -> dict[str, tuple[str, ...]]:
    """A package -> patterns of the packages that come with it."""
    return read_table(__file__, "brought.txt")


def undeclared(packages: Sequence[str], users: str) -> tuple[str, str]:
    """Message and hint.

    Args:
        packages: their names, at least one.
        users: what uses them, with its verb: "the launch file uses".
    """
    lines = " ".join(f"<exec_depend>{package}</exec_depend>" for package in packages)
    return (
        f"package.xml does not declare {listed(packages)}, which {users}.",
        f"Add to package.xml: {lines}",
    )


def listed(names: Sequence[str]) -> str:
    """The first names, and how many follow."""
    more = len(names) - MOST_NAMED
    return ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
