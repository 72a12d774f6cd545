"""How bad it is what a launch file, a robot or a world shows that nobody starts.

Read by itself, a file lacks what it is given where it is used; and that an engine of wsgen leaves
something out does not matter where nothing is simulated. What a package that is not on this machine
has is unknown.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules.drives import NO_FRICTION_DIRECTION
from wsgen.checks.rules.ros2_control import INCOMPLETE_CONTROL
from wsgen.checks.rules.settings import SETTING_NOT_SIMULATED
from wsgen.descriptions.rules import (
    MISSING_COLLISION_MESH,
    MISSING_VISUAL_MESH,
    NO_LINK,
    UNKNOWN_LINK,
)
from wsgen.descriptions.sdf.assembly import CLOSED_CHAIN, JOINT_LEFT_OUT
from wsgen.descriptions.sdf.includes import DOWNLOADED, ELSEWHERE
from wsgen.descriptions.sdf.models import NO_WORLD, NOT_SIMULATED
from wsgen.descriptions.sdf.shapes import SHAPE_LEFT_OUT
from wsgen.descriptions.sdf.worlds import NO_GROUND
from wsgen.descriptions.urdf.gazebo import SDF_NOT_SIMULATED
from wsgen.descriptions.urdf.lumping import DROPPED_LINK, IMPOSSIBLE_SUM, TWO_ZERO_MASSES
from wsgen.descriptions.urdf.reader import UNNAMED_ROBOT
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.diagnostics import Severity
from wsgen.launching.commands import has_gaps
from wsgen.launching.descriptions import UNPUBLISHED_DESCRIPTION
from wsgen.launching.explain import (
    ARGUMENT_WITHOUT_VALUE,
    DECLARED_LATER,
    INTERACTIVE_INPUT,
    NEEDS_UNKNOWN,
    UNDEFINED_CONFIGURATION,
    VARIABLE_NOT_SET,
)
from wsgen.launching.explain_missing import (
    FILE_NOT_INSTALLED,
    OF_NO_PACKAGE,
    PACKAGE_NOT_FOUND,
    XACRO_FAILS,
)
from wsgen.launching.explain_names import (
    API_PACKAGES,
    IMPORT_ERROR,
    RAISES,
    REFUSED_BY_LAUNCH,
    UNSUPPORTED_API,
)
from wsgen.launching.package_lookup import UNDECLARED_PACKAGE
from wsgen.launching.simulators import NO_SIMULATOR
from wsgen.launching.spawner_options import INVALID_SPAWNER_OPTION
from wsgen.packages.source_shares import may_have_sources
from wsgen.pipeline.candidates import commands
from wsgen.pipeline.file_validation import NO_MODEL, PART_OF_ROBOT, read
from wsgen.ros.names import released_packages
from wsgen.text.files import real_path
from wsgen.text.suggestions import advice, misspelled_as, suggested
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.candidates import Candidate


# What Gazebo simulates, and no engine of wsgen.
OF_SIMULATION = frozenset(
    rule.code
    for rule in (
        *(CLOSED_CHAIN, JOINT_LEFT_OUT, NO_FRICTION_DIRECTION),
        *(SDF_NOT_SIMULATED, SHAPE_LEFT_OUT),
    )
)


def without_simulation(diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """What is left out of a simulation, or is there with other arguments of xacro, is a note."""
    for found in diagnostics:
        if found.code == SETTING_NOT_SIMULATED.code:
            continue  # nothing is simulated
        if found.code in OF_SIMULATION or _has_other_hardware(found):
            yield replace(found, severity=Severity.INFO)
        else:
            yield found


_CONDITION = lazy_pattern(rb"<xacro:(?:if|unless)\b")


def _has_other_hardware(found: Diagnostic) -> bool:
    """Whether a part of ros2_control has no hardware because no condition of its file holds."""
    if found.code != INCOMPLETE_CONTROL.code or found.file is None:
        return False
    text = read(found.file) if found.file.suffix == ".xacro" else b""
    return b"<plugin>" in text and _CONDITION.search(text) is not None


# What a launch file lacks here is given to it where it is started, or where it is included.
GIVEN_FROM_OUTSIDE = frozenset(
    rule.code
    for rule in (
        ARGUMENT_WITHOUT_VALUE,
        INTERACTIVE_INPUT,
        NEEDS_UNKNOWN,
        UNSUPPORTED_API,
        VARIABLE_NOT_SET,
    )
)


def _is_of_arguments(found: Diagnostic, one: Candidate, beside: Iterable[Candidate]) -> bool:
    """Whether what the launch file raises, it does not raise where others include it."""
    if found.code not in {RAISES.code, REFUSED_BY_LAUNCH.code}:
        return False
    file, place = real_path(one.file), (found.code, found.file, found.line)
    return any(
        file in other.included
        and other.started.plan.is_complete
        and place not in {(code, file, line) for code, _, file, line in other.errors}
        for other in beside
        if other is not one
    )


def _is_given_from_outside(found: Diagnostic) -> bool:
    return found.code in GIVEN_FROM_OUTSIDE and found.severity is Severity.ERROR


def of_launch(
    one: Candidate,
    beside: Sequence[Candidate],
    package: Path | None = None,
    is_included_elsewhere: Callable[..., bool] = lambda *_: False,
) -> Iterator[Diagnostic]:
    """What is wrong with a launch file, whatever it is started with.

    Args:
        one: The launch file.
        beside: Those of its package.
        package: The source folder of its package.
        is_included_elsewhere: Whether a launch file of another package names it, and the names of
            arguments that it is asked for.
    """
    started = one.started
    is_inner = is_included(one, beside)
    is_open = has_gaps(started.plan)
    lacks_package = any(
        found.code == PACKAGE_NOT_FOUND.code and not _is_misspelled(found)
        for found in started.plan.diagnostics
    )
    for found in started.diagnostics if started.has_spawner else started.plan.diagnostics:
        if found.code == UNDECLARED_PACKAGE.code and one.launch_file.package:
            continue  # reported once for all files of the package
        if (
            (_is_given_from_outside(found) and not _is_wrong_import(found))
            or _lacks_device(found)
            or _lacks_module(found, package)
            or (is_open and _is_for_nothing(found))
            or (lacks_package and found.code == RAISES.code)  # without what that package has
            or _is_of_arguments(found, one, beside)
        ):
            if not is_inner:
                yield replace(found, severity=Severity.INFO)
        elif (found.code == NO_SIMULATOR.code and found.element is None) or (
            found.code == UNPUBLISHED_DESCRIPTION.code
            and (found.severity is Severity.WARNING or is_included_elsewhere())
        ):  # somebody may start it in another terminal, or a file that is not here does
            yield replace(found, severity=Severity.INFO)
        elif found.code == PACKAGE_NOT_FOUND.code and (is_open or not _is_misspelled(found)):
            yield replace(found, severity=Severity.WARNING)  # it may be in another workspace
        elif found.code == UNDEFINED_CONFIGURATION.code:
            yield from _of_configuration(found, one, beside, is_included_elsewhere)
        elif found.code == INVALID_SPAWNER_OPTION.code and is_open:
            yield replace(found, severity=Severity.INFO)
        elif found.code == FILE_NOT_INSTALLED.code and found.reason == OF_NO_PACKAGE:
            yield replace(found, severity=Severity.WARNING)  # some program may write it before
        else:
            yield found


def _of_configuration(
    found: Diagnostic,
    one: Candidate,
    beside: Sequence[Candidate],
    is_included_elsewhere: Callable[..., bool],
) -> Iterator[Diagnostic]:
    """A configuration that does not exist: where others start the launch file, they may set it."""
    if _is_evaluated_inside(one, beside) or found.element in _given_by_command(one, beside):
        return  # the evaluation of who includes it says whether it is set there
    if is_included_elsewhere(found.element):
        yield replace(found, severity=Severity.INFO)
    elif found.reason == DECLARED_LATER or suggested(found.hint):
        yield found
    else:
        yield replace(found, severity=Severity.WARNING)


_BACKTICKED = lazy_pattern(r"`([^`]+)`")
_IMPORT_TO_WRITE = lazy_pattern(r"^Write `from ([\w.]+) import")
# They have the names alone that they are for, in every distribution.
_PUBLIC_MODULES = frozenset(
    (
        *("launch.actions", "launch.event_handlers", "launch.substitutions"),
        *("launch_ros.actions", "launch_ros.substitutions"),
    )
)


def _is_wrong_import(found: Diagnostic) -> bool:
    """Whether what is imported from the launch API surely has another name, or is elsewhere."""
    if found.code != UNSUPPORTED_API.code or found.element is None:
        return False
    meant = suggested(found.hint)
    if meant is not None:
        is_same = found.element.casefold() == meant.casefold()
        return is_same or misspelled_as(found.element, [meant]) is not None
    used, to_write = _BACKTICKED.search(found.message), _IMPORT_TO_WRITE.search(found.hint or "")
    if used is None or to_write is None:
        return False
    return used[1] in _PUBLIC_MODULES or misspelled_as(used[1], [to_write[1]]) is not None


DEVICE = lazy_pattern(r"/dev/(?!shm\b|null\b)\w")


def _lacks_device(found: Diagnostic) -> bool:
    """Whether a launch file raises for something that is attached to the robot."""
    return found.code == RAISES.code and DEVICE.search(found.message) is not None


NO_MODULE = lazy_pattern(r"No module named '([^'.]+)")


def _lacks_module(found: Diagnostic, package: Path | None) -> bool:
    """Whether a launch file imports what others install, and this machine does not have."""
    missing = NO_MODULE.search(found.message) if found.code == IMPORT_ERROR.code else None
    if missing is None:
        return False
    meant = suggested(found.hint)
    if meant and (missing[1].lower() == meant or misspelled_as(missing[1], [meant])):
        # Of these, the API of launch alone has modules in packages.
        has_part = re.search(rf"\b{re.escape(missing[1])}\.\w", _line(found))
        if not has_part or meant.partition(".")[0] in API_PACKAGES:
            return False
    return package is None or not _has_module(package, missing[1])


def _line(found: Diagnostic) -> str:
    """The line that a diagnostic is about; empty where that is not known."""
    lines = read(found.file).decode(errors="replace").splitlines() if found.file else []
    return lines[found.line - 1] if found.line and found.line <= len(lines) else ""


def _has_module(package: Path, name: str) -> bool:
    """Whether a package has a Python module of that name, which its launch files do not find."""
    if package.name == name:
        return True
    for folder, names, files in os.walk(package):
        names[:] = filter(may_have_sources, names)
        if f"{name}.py" in files:
            return True
        if name in names and os.path.isfile(os.path.join(folder, name, "__init__.py")):  # noqa: PTH113, PTH118  see os.walk
            return True
    return False


FOR_NOTHING = lazy_pattern(r"'' is not a valid package name|Command: \S+\s+Captured\b")


def _is_for_nothing(found: Diagnostic) -> bool:
    """Whether launch refuses an empty text: a package without a name, or a program for no file."""
    return found.code == REFUSED_BY_LAUNCH.code and FOR_NOTHING.search(found.message) is not None


def _is_misspelled(found: Diagnostic) -> bool:
    """Whether a package that is not found is surely one whose name is nearly the same."""
    meant = suggested(found.hint)
    name = QUOTED.search(found.message)
    return bool(meant and name and misspelled_as(name[1], [meant]))


def is_included(one: Candidate, beside: Sequence[Candidate]) -> bool:
    """Whether one of the other launch files includes this one, or runs it with `ros2 launch`."""
    return _is_evaluated_inside(one, beside) or any(commands(one, beside))


def _is_evaluated_inside(one: Candidate, beside: Iterable[Candidate]) -> bool:
    """Whether one of the other launch files includes this one."""
    file = real_path(one.file)
    return any(file in other.included for other in beside if other is not one)


def _given_by_command(one: Candidate, beside: Iterable[Candidate]) -> set[str]:
    """The names of the launch arguments that other launch files run this one with."""
    return {name for command in commands(one, beside) for name in command.arguments}


QUOTED = lazy_pattern(r"'([^']+)'")
# Of xacro, where a launch file or another xacro file gives what the file needs.
UNDEFINED_ARGUMENT = "Undefined substitution argument"
NOT_FOUND = lazy_pattern(r"the package '[^']+' is not found")


# What Gazebo alone refuses in a robot; RViz, MoveIt and drivers take it.
REFUSED_BY_GAZEBO = frozenset(rule.code for rule in (DROPPED_LINK, TWO_ZERO_MASSES, IMPOSSIBLE_SUM))


def of_file_alone(
    diagnostics: Iterable[Diagnostic],
    is_for_gazebo: Callable[[], bool] = lambda: True,
    expanded: str | bytes | None = None,
) -> Iterator[Diagnostic]:
    """What is wrong with a file; that it holds only a part of a robot or world is not.

    Args:
        diagnostics: Of the file.
        is_for_gazebo: Whether anything in the workspace has to do with Gazebo.
        expanded: What a xacro file of a package expands to, which nothing there includes or starts.
    """
    for found in diagnostics:
        if found.code == NO_MODEL.code:
            continue
        if found.code in REFUSED_BY_GAZEBO and not is_for_gazebo():
            yield replace(found, severity=Severity.WARNING)
            continue
        # What a world stands on may be spawned into it.
        if (
            found.code in {PART_OF_ROBOT.code, NO_GROUND.code}
            or UNDEFINED_ARGUMENT in found.message
            or (found.code == XACRO_FILE_FAILS.code and _lacks_includer(found))
            or (found.code == UNKNOWN_LINK.code and _is_attached(found, expanded))
            or _is_of_others(found)
            or _is_of_empty(found)
        ):
            yield replace(found, severity=Severity.INFO)
        elif found.code == XACRO_FILE_FAILS.code and NOT_FOUND.search(found.message):
            is_known = not _is_misspelled(found)  # see `_of_launch`
            yield replace(found, severity=Severity.WARNING) if is_known else found
        else:
            yield found


# A comment ends where XML ends it: `.*?` would also match what is between two of them.
_COMMENT = rb"<!--(?:[^-]|-(?!->))*-->"
_EMPTY = lazy_pattern(
    rb"(?:\s|%s|<\?[^>]*\?>)*<robot\b(?:(?!\sname)[^>])*(?:/>|>(?:\s|%s)*</robot\s*>)\s*"
    % (_COMMENT, _COMMENT)
)


def _is_of_empty(found: Diagnostic) -> bool:
    """Whether a file has no robot on purpose: another one includes it where nothing is to be added.

    That is `<robot/>`, without a name, and with nothing but comments in it.
    """
    return (
        found.code in {NO_LINK.code, UNNAMED_ROBOT.code}
        and found.file is not None
        and _EMPTY.fullmatch(read(found.file)) is not None
    )


_UNKNOWN_LINK = lazy_pattern(r"is `([^`]+)`, but no link has that name")
_FOR_OTHERS = lazy_pattern("its root element is <gazebo>|, but one <(?:light|actor)>")


def _is_of_others(found: Diagnostic) -> bool:
    """Whether a file is no robot or world by itself, but something for other files or programs.

    These are models for old versions of Gazebo, in the formats of those; lights and actors, which
    worlds include; and what Webots reads of a robot.
    """
    if found.file is None:
        return False
    if found.code == NO_WORLD.code:
        return _FOR_OTHERS.search(found.message) is not None
    return found.code == NO_LINK.code and b"<webots" in read(found.file)


_LINK = lazy_pattern(r"<link\b[^>]*?\sname\s*=\s*[\"']([^\"']+)")
_CHILD = lazy_pattern(r"<child\b[^>]*?\slink\s*=\s*[\"']([^\"']+)")


def _is_attached(found: Diagnostic, expanded: str | bytes | None) -> bool:
    """Whether a xacro file has a part of a robot, which is attached to a link of another file.

    Each link of it is then the child of a joint. A name that surely misspells that of a link is a
    mistake.
    """
    unknown = _UNKNOWN_LINK.search(found.message)
    if unknown is None or not isinstance(expanded, str) or found.file is None:
        return False
    meant = suggested(found.hint)
    if meant and misspelled_as(unknown[1], [meant]):
        return False
    return found.file.suffix == ".xacro" and {*_LINK.findall(expanded)} <= {
        *_CHILD.findall(expanded)
    }


_UNDEFINED = lazy_pattern(r"unknown macro name: xacro:(\w+)|name '(\w+)' is not defined")


def _lacks_includer(found: Diagnostic) -> bool:
    """Whether a xacro file lacks what the file that includes it defines, or an argument."""
    undefined = _UNDEFINED.search(found.message)
    if undefined is None or found.file is None or b"<xacro:include" in read(found.file):
        return _has_empty_part(found)
    meant = suggested(found.hint)
    return not meant or misspelled_as(undefined[1] or undefined[2], [meant]) is None


NO_FILE = lazy_pattern(r"no such file or directory: '([^']*)'")
EXPRESSION = lazy_pattern(r"\$\(find [^)]*\)|\$\([^)]*\)|\$\{[^}]*\}")


def _has_empty_part(found: Diagnostic) -> bool:
    """Whether xacro looks for a file in whose name an argument is empty, which somebody gives.

    The element of the diagnostic is the name as it is written, with `$(arg model)` or `${model}`.
    """
    missing, written = NO_FILE.search(found.message), found.element or ""
    if missing is None:
        return False
    pattern, start = "", 0
    for expression in EXPRESSION.finditer(written):
        is_folder = expression[0].startswith("$(find")
        pattern += re.escape(written[start : expression.start()]) + (".*" if is_folder else "(.*?)")
        start = expression.end()
    values = re.fullmatch(pattern + re.escape(written[start:]), missing[1])
    return values is not None and "" in values.groups()


_OF_MESHES = frozenset(rule.code for rule in (MISSING_COLLISION_MESH, MISSING_VISUAL_MESH))
_OF_PACKAGES = _OF_MESHES | {PACKAGE_NOT_FOUND.code, XACRO_FILE_FAILS.code}
_ABSENT = lazy_pattern(
    r"package ['`]([^'`]+)['`](?: is not found|, which was not found| is needed, and the package)"
)


def without_absent_packages(
    diagnostics: Iterable[Diagnostic], declared: Collection[str], here: Collection[str] = ()
) -> Iterator[Diagnostic]:
    """Take what a package that is not on this machine would have for what it is: unknown.

    Packages of the workspace, which are `here`, declare those of `declared`: the user has them
    where they run. One that is misspelled is an error.
    Neither is a package that is released an error of the user. Where a launch
    file fails at a place of a xacro file, that is not reported of the file, too.
    """
    found = list(diagnostics)
    of_launch_files = {PACKAGE_NOT_FOUND.code, XACRO_FAILS.code}
    reported = {(one.file, one.line) for one in found if one.code in of_launch_files}
    for one in found:
        absent = _ABSENT.search(one.message) if one.code in _OF_PACKAGES else None
        if one.code == XACRO_FILE_FAILS.code and (one.file, one.line) in reported:
            continue
        if absent is None:
            yield _without_elsewhere(one)
        elif absent[1] in declared or absent[1] in released_packages():
            yield replace(one, severity=Severity.INFO)
        elif one.code in _OF_MESHES and not _is_in_own_package(one):
            meant = misspelled_as(absent[1], here)
            if meant is None:  # it may be in another workspace
                yield replace(one, severity=Severity.WARNING)
            else:
                yield replace(one, hint=advice(absent[1], [meant], one.hint or ""))
        else:
            yield one


def _without_elsewhere(found: Diagnostic) -> Diagnostic:
    """Say how bad it is that a world lacks something here which Gazebo has or downloads."""
    if found.severity is Severity.ERROR and found.reason == ELSEWHERE:
        return replace(found, severity=Severity.WARNING)
    if found.reason in {DOWNLOADED, NOT_SIMULATED}:
        return replace(found, severity=Severity.INFO)
    return found


def _is_in_own_package(missing: Diagnostic) -> bool:
    """Whether the mesh is in the robot's package: the address leaves out the name of that."""
    return (missing.hint or "").startswith("Write package://")
