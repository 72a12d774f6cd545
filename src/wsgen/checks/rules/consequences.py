"""What follows from what: one cause is one diagnostic.

A robot without <collision> falls through the ground. When the description is reported, the fall
is no second problem; it shows how severe the first one is. The diagnostic of the run is then folded
into that of the description, which takes over its severity and its message. So it is with a folder
that no rule installs: it lacks all that launch files and robots look up in it.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.bodies import (
    CENTER_OF_MASS_OUTSIDE,
    IMPLAUSIBLE_DENSITY,
    UNLIKE_SHAPES,
    WHEEL_WITHOUT_COLLISION,
)
from wsgen.checks.rules.dependencies import UNRELEASED_DEPENDENCY
from wsgen.checks.rules.drives import DRIVE_UNLIKE_WHEELS, WHEEL_ROLLS_SIDEWAYS
from wsgen.checks.rules.package_uses import UNDECLARED_DEPENDENCY
from wsgen.checks.rules.plugins import (
    PLUGIN_OF_OTHER_SIMULATOR,
    UNKNOWN_PLUGIN,
    UNKNOWN_PLUGIN_PART,
    UNREAD_PLUGIN_PARAMETER,
)
from wsgen.checks.rules.robots import (
    IMPLAUSIBLE_INERTIA,
    IMPLAUSIBLE_MASS,
    IMPLAUSIBLE_SIZE,
    LOOSE_JOINT,
    NO_COLLISION,
    OVERSIZED_PART,
    STARTS_OUTSIDE_LIMITS,
)
from wsgen.checks.rules.ros2_control import UNSUITED_HARDWARE
from wsgen.checks.rules.runs import (
    BEHAVIOR_EXPLODES,
    ENGINE_UNSTABLE,
    ENGINES_DISAGREE,
    FALLS_WITHOUT_END,
    GAINS_ENERGY,
    HEADING_NOT_REACHED,
    JOINT_BEYOND_LIMIT,
    KEEPS_MOVING,
    LEANS,
    POSITION_NOT_REACHED,
    SPAWNED_HIGH,
    SPAWNED_IN_GROUND,
    STATE_NOT_FINITE,
    STUCK_IN_GROUND,
    THROWN_INTO_THE_AIR,
    TIPS_OVER,
)
from wsgen.checks.rules.simulators import GLUED_ARGUMENTS, SPAWNER_OF_OTHER_SIMULATOR
from wsgen.checks.rules.systems import MISSING_SENSOR_SYSTEM
from wsgen.descriptions.meshes.inspection import IMPLAUSIBLE_MESH_SIZE
from wsgen.descriptions.rules import (
    IMPOSSIBLE_INERTIA,
    MISSING_COLLISION_MESH,
    MISSPELLED_ATTRIBUTE,
    MISSPELLED_ELEMENT,
    NO_SHAPE,
    NOT_A_NUMBER,
    UNNAMED_ELEMENT,
    ZERO_SIZE,
)
from wsgen.descriptions.sdf.assembly import JOINT_LEFT_OUT
from wsgen.descriptions.sdf.bodies import DEFAULT_INERTIA, MASSLESS_MODEL_LINK
from wsgen.descriptions.sdf.shapes import SHAPE_LEFT_OUT
from wsgen.descriptions.urdf.links import INCOMPLETE_INERTIAL, UNNAMED_MESH
from wsgen.descriptions.urdf.lumping import (
    DROPPED_BY_OLD_SDFORMAT,
    DROPPED_LINK,
    IMPOSSIBLE_SUM,
    TWO_ZERO_MASSES,
)
from wsgen.descriptions.urdf.unknown_elements import meant_element
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launching.explain_missing import EXECUTABLE_NOT_FOUND, PACKAGE_NOT_FOUND, XACRO_FAILS
from wsgen.launching.launch_warnings import UNUSED_INCLUDE_ARGUMENT
from wsgen.launching.package_lookup import UNDECLARED_PACKAGE
from wsgen.launching.spawner_options import INVALID_SPAWNER_OPTION
from wsgen.packages.build_files.cmake_checks import DIFFERENT_NAMES, MISSING_INSTALLED_PATH
from wsgen.packages.build_files.install_checks import (
    CONTENTS_INSTALLED,
    FOLDER_NOT_INSTALLED,
    PROGRAM_NOT_EXECUTABLE,
    PROGRAM_NOT_INSTALLED,
    REPEATED_FOLDER,
    WRONG_DESTINATION,
)
from wsgen.packages.build_files.python_checks import BROKEN_SCRIPT
from wsgen.text.suggestions import suggested
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Rule


def _codes(*rules: Rule) -> tuple[str, ...]:
    return tuple(rule.code for rule in rules)


# At these Gazebo's parser stops reading a link: what comes behind is lost, too.
UNREAD = (INCOMPLETE_INERTIAL, NO_SHAPE, NOT_A_NUMBER, UNNAMED_ELEMENT, UNNAMED_MESH)
# What a run shows.
EXPLODES = _codes(STATE_NOT_FINITE, THROWN_INTO_THE_AIR, GAINS_ENERGY, ENGINE_UNSTABLE)
FALLS = _codes(FALLS_WITHOUT_END, KEEPS_MOVING, TIPS_OVER, LEANS)
MOVES = (*_codes(STUCK_IN_GROUND, JOINT_BEYOND_LIMIT), *FALLS, *EXPLODES)
# What the behaviors of a package show.
DRIVES = _codes(POSITION_NOT_REACHED, HEADING_NOT_REACHED)
BEHAVES = (*DRIVES, BEHAVIOR_EXPLODES.code)
# The start, and that two engines never agree on what explodes or falls.
ANY = (*MOVES, *BEHAVES, *_codes(SPAWNED_IN_GROUND, SPAWNED_HIGH, ENGINES_DISAGREE))


class Consequence(NamedTuple):
    """What a diagnostic about a description explains of a run of the same robot."""

    cause: str  # the code of its rule
    follows: tuple[str, ...]  # codes of rules about the run
    errors: tuple[str, ...] = ()  # codes that follow only as errors: as warnings they have
    # another cause, such as joints that are not actuated


# Where several explain the same, the first does.
CONSEQUENCES = (
    # In other units nothing about the run is right.
    Consequence(IMPLAUSIBLE_SIZE.code, ANY),
    Consequence(IMPLAUSIBLE_MESH_SIZE.code, ANY),
    Consequence(OVERSIZED_PART.code, ANY),
    Consequence(IMPLAUSIBLE_MASS.code, (*MOVES, *BEHAVES, ENGINES_DISAGREE.code)),
    # Nothing touches the ground.
    Consequence(NO_COLLISION.code, _codes(FALLS_WITHOUT_END)),
    *(
        Consequence(cause.code, _codes(FALLS_WITHOUT_END, TIPS_OVER, LEANS))
        for cause in (SHAPE_LEFT_OUT, ZERO_SIZE, MISSING_COLLISION_MESH)
    ),
    # The simulated robot is not the one that was meant.
    Consequence(MISSPELLED_ELEMENT.code, ANY),
    Consequence(MISSPELLED_ATTRIBUTE.code, ANY),
    *(Consequence(rule.code, ANY) for rule in (DROPPED_LINK, DROPPED_BY_OLD_SDFORMAT, *UNREAD)),
    # The weight is elsewhere, or what should carry it touches nothing.
    Consequence(CENTER_OF_MASS_OUTSIDE.code, MOVES),
    Consequence(UNLIKE_SHAPES.code, ANY),
    *(
        Consequence(cause.code, (*_codes(TIPS_OVER, LEANS, SPAWNED_IN_GROUND), *DRIVES))
        for cause in (WHEEL_WITHOUT_COLLISION, WHEEL_ROLLS_SIDEWAYS)
    ),
    # The wheels turn as the plugin computes it from other sizes.
    *(Consequence(cause.code, DRIVES) for cause in (DRIVE_UNLIKE_WHEELS, UNREAD_PLUGIN_PARAMETER)),
    # A part falls off.
    Consequence(LOOSE_JOINT.code, (), errors=FALLS),
    Consequence(JOINT_LEFT_OUT.code, (), errors=FALLS),
    # Links with too little inertia shake.
    Consequence(IMPOSSIBLE_INERTIA.code, EXPLODES, errors=_codes(KEEPS_MOVING)),
    Consequence(IMPLAUSIBLE_INERTIA.code, EXPLODES, errors=_codes(KEEPS_MOVING)),
    # So does one that is too heavy for what carries it, or sinks in.
    Consequence(
        IMPLAUSIBLE_DENSITY.code,
        (*EXPLODES, *BEHAVES, STUCK_IN_GROUND.code),
        errors=_codes(KEEPS_MOVING),
    ),
    Consequence(DEFAULT_INERTIA.code, EXPLODES, errors=_codes(KEEPS_MOVING)),
    Consequence(MASSLESS_MODEL_LINK.code, EXPLODES, errors=_codes(KEEPS_MOVING)),
    # The limit pushes the joint.
    Consequence(STARTS_OUTSIDE_LIMITS.code, EXPLODES, errors=_codes(KEEPS_MOVING)),
)
# Gazebo drops the wheels, or the plugin that drives them finds nothing to turn.
WITHOUT_WHEELS = _codes(DROPPED_LINK, DROPPED_BY_OLD_SDFORMAT, TWO_ZERO_MASSES, IMPOSSIBLE_SUM)
OF_PLUGINS = _codes(UNKNOWN_PLUGIN, PLUGIN_OF_OTHER_SIMULATOR, UNKNOWN_PLUGIN_PART)
DIFF_DRIVE = re.compile(r"diff[-_]drive")
MISSPELLED = _codes(MISSPELLED_ELEMENT, MISSPELLED_ATTRIBUTE)
MOVING_PART = re.compile(r"(?:^|/)(?:link|joint|gazebo)\b")
WITHOUT_EFFECT = ("visual", "material", "sensor", "plugin", "light", "transmission", "ros2_control")
NAME = re.compile(r"\[@\w+='[^']*'\]")
JOINT = re.compile(r"\bjoint\[@name='([^']*)'\]")


class Folded(NamedTuple):
    """The diagnostics of one robot, each cause once."""

    prepared: tuple[Diagnostic, ...]  # as many as before, with what follows from them
    run: tuple[Diagnostic, ...]  # what nothing in the description explains


def fold_consequences(prepared: Iterable[Diagnostic], run: Iterable[Diagnostic]) -> Folded:
    """Fold what follows from the description of a robot into the diagnostics about that.

    `run` is what is reported about the run of this robot, in any engine.
    """
    causes = list(prepared)
    followed: dict[int, list[Diagnostic]] = {}
    left = []
    for found in run:
        place = _cause_of(found, causes)
        if place is None:
            left.append(found)
        else:
            followed.setdefault(place, []).append(found)
    for place, consequences in followed.items():
        causes[place] = _with_worst(causes[place], consequences)
    return Folded(tuple(causes), tuple(left))


def explains_no_drive(found: Diagnostic) -> bool:
    """Whether what is wrong with a description keeps its diff drive plugin from working."""
    if found.severity is not Severity.ERROR:
        return False
    said = f"{found.element} {found.message} {found.hint}"
    return found.code in WITHOUT_WHEELS or (
        found.code in OF_PLUGINS and DIFF_DRIVE.search(said) is not None
    )


def joints_beyond_limits(prepared: Iterable[Diagnostic]) -> frozenset[str]:
    """The joints that are reported to start outside of their limits, which move them."""
    return frozenset(
        name
        for found in prepared
        if found.code == STARTS_OUTSIDE_LIMITS.code
        for name in JOINT.findall(found.element or "")
    )


def _cause_of(found: Diagnostic, causes: Sequence[Diagnostic]) -> int | None:
    for row in CONSEQUENCES:
        is_error = found.severity is Severity.ERROR
        if found.code in row.follows or (is_error and found.code in row.errors):
            for place, cause in enumerate(causes):
                if cause.code == row.cause and _has_effect(cause):
                    return place
    return None


def _has_effect(cause: Diagnostic) -> bool:
    """Whether it can change how a robot moves; what is only seen or read cannot."""
    element = cause.element or ""
    if cause.code == DRIVE_UNLIKE_WHEELS.code:
        return True
    if cause.code == UNREAD_PLUGIN_PARAMETER.code:
        return DIFF_DRIVE.search(element) is not None
    if cause.code in _codes(*UNREAD):
        return element.startswith("link[")
    tags = NAME.sub("", element).split("/")
    if any(meant_element(tag, WITHOUT_EFFECT) for tag in tags if tag):
        return False
    return cause.code not in MISSPELLED or MOVING_PART.search(element) is not None


def _with_worst(cause: Diagnostic, consequences: Sequence[Diagnostic]) -> Diagnostic:
    """The cause, as severe as the worst that follows from it, with the message of that."""
    order = list(Severity)
    worst = min(consequences, key=lambda found: order.index(found.severity))
    message = worst.message
    if worst.code == ENGINE_UNSTABLE.code:
        message = f"In the simulation, {message}"
    elif not message.startswith("In "):  # else it names its engine
        message = f"In the simulation, {message[0].lower()}{message[1:]}"
    return replace(
        cause,
        severity=min(cause.severity, worst.severity, key=order.index),
        message=f"{cause.message} {message}",
    )


_ARGUMENTS_OF_WORLD = frozenset(("gz_args", "ign_args", "world"))


def without_explained(diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Leave out what another diagnostic of the same launch file explains.

    These are options of a spawner that is to be replaced by the one of another simulator, and what
    the empty world lacks where Gazebo is not given the world for a mistake in its arguments.
    """
    found = list(diagnostics)
    replaced = {
        (one.file, one.line) for one in found if one.code == SPAWNER_OF_OTHER_SIMULATOR.code
    }
    without_world = {
        one.file
        for one in found
        if one.code == GLUED_ARGUMENTS.code
        or (one.code == UNUSED_INCLUDE_ARGUMENT.code and suggested(one.hint) in _ARGUMENTS_OF_WORLD)
    }
    lacking = {one.file for one in found if one.code == MISSING_SENSOR_SYSTEM.code}
    # Of `ros_ign_gazebo`, which later distributions do not have, nor this name of the argument.
    is_of_ignition = any(one.code == UNRELEASED_DEPENDENCY.code for one in found)
    for one in found:
        is_argument = one.code == UNUSED_INCLUDE_ARGUMENT.code
        if is_of_ignition and is_argument and suggested(one.hint) == "ign_args":
            continue
        is_option = one.code == INVALID_SPAWNER_OPTION.code
        is_of_world = one.code == MISSING_SENSOR_SYSTEM.code
        if one.code == UNUSED_INCLUDE_ARGUMENT.code and one.file in lacking & without_world:
            yield replace(one, severity=Severity.ERROR)  # what follows from it is one
            continue
        if not (is_option and (one.file, one.line) in replaced) and not (
            is_of_world and one.file in without_world
        ):
            yield one


OF_FOLDERS = frozenset(
    rule.code
    for rule in (CONTENTS_INSTALLED, FOLDER_NOT_INSTALLED, REPEATED_FOLDER, WRONG_DESTINATION)
)
_OF_PROGRAMS = frozenset(
    rule.code for rule in (BROKEN_SCRIPT, PROGRAM_NOT_EXECUTABLE, PROGRAM_NOT_INSTALLED)
)
_NOT_FOUND = frozenset(rule.code for rule in (PACKAGE_NOT_FOUND, XACRO_FILE_FAILS))
_FOLLOWING = ("LCH", "ROB", "SPN", "WLD")  # families
_PLACE = lazy_pattern(r"(?<![\w.-])share/([\w-]+)/([\w.-]+)")
_GIVEN = lazy_pattern(r"'([\w.-]+)/[^']*' of ([\w-]+), which is not installed")
_PACKAGE = lazy_pattern(r"package '([\w-]+)'")
_ORDER = list(Severity)


def fold_not_installed(
    diagnostics: Iterable[Diagnostic], folders: Mapping[str, Path]
) -> tuple[Diagnostic, ...]:
    """Fold what follows from build files into the diagnostics about them.

    Args:
        diagnostics: Of all packages that are checked.
        folders: Of these packages, by name.
    """
    found = tuple(diagnostics)
    causes = [one for one in found if one.code in OF_FOLDERS | _OF_PROGRAMS]
    if not causes:
        return tuple(_without_echoes(found))
    followed: dict[Diagnostic, list[Diagnostic]] = {}
    left: list[Diagnostic] = []
    for one in found:
        cause = next(_causes_of(one, causes, folders), None)
        if cause is None:
            left.append(one)
        else:
            followed.setdefault(cause, []).append(one)
    kept = [_as_severe_as(one, followed[one]) if one in followed else one for one in left]
    return tuple(_without_echoes(kept))


def _without_echoes(diagnostics: Sequence[Diagnostic]) -> Iterator[Diagnostic]:
    """Without what a misspelled folder of install(), or a misspelled package, causes elsewhere."""
    meant = {
        (one.file, suggested(one.hint))
        for one in diagnostics
        if one.code == MISSING_INSTALLED_PATH.code
    }
    programs = {Path(name).name for _, name in meant if name is not None}
    renamed = {
        one.element for one in diagnostics if one.code == DIFFERENT_NAMES.code and one.element
    }
    unnamed = {one.reason for one in diagnostics if one.code == DIFFERENT_NAMES.code and one.reason}
    of_launch = {(one.file, one.line) for one in diagnostics if one.code in _OF_LAUNCH}
    of_others = {one.file for one in diagnostics if one.code == PLUGIN_OF_OTHER_SIMULATOR.code}
    for one in diagnostics:
        if (
            (one.code == FOLDER_NOT_INSTALLED.code and (one.file, one.element) in meant)
            or (one.code == EXECUTABLE_NOT_FOUND.code and one.element in programs)
            or (one.code in _NOT_FOUND and suggested(one.hint) in renamed)
            or (one.code in _OF_NAMES and not unnamed.isdisjoint(_WORD.findall(one.message)))
            # Of what a launch file expands, both say the same.
            or (one.code == XACRO_FILE_FAILS.code and (one.file, one.line) in of_launch)
            # It is compared with a plugin that is wrong itself.
            or (one.code == UNSUITED_HARDWARE.code and one.file in of_others)
        ):
            continue
        yield one


_WORD = lazy_pattern(r"[\w-]+")
_OF_NAMES = frozenset(
    rule.code for rule in (PACKAGE_NOT_FOUND, UNDECLARED_DEPENDENCY, UNDECLARED_PACKAGE)
)
_OF_LAUNCH = frozenset(rule.code for rule in (PACKAGE_NOT_FOUND, XACRO_FAILS))


def _causes_of(
    found: Diagnostic, causes: Sequence[Diagnostic], folders: Mapping[str, Path]
) -> Iterator[Diagnostic]:
    if not found.code.startswith(_FOLLOWING):
        return
    if found.code == EXECUTABLE_NOT_FOUND.code:
        package = _PACKAGE.search(found.message)
        names = [(package[1], found.element or "", _OF_PROGRAMS)] if package else []
    else:
        names = [(one[1], one[2], OF_FOLDERS) for one in _PLACE.finditer(found.message)]
        names += [(one[2], one[1], OF_FOLDERS) for one in _GIVEN.finditer(found.message)]
    for package_name, name, codes in names:
        folder = folders.get(package_name)
        for cause in causes:
            is_of_package = (
                folder is not None and cause.file is not None and cause.file.is_relative_to(folder)
            )
            if cause.code in codes and is_of_package and _names(cause, name):
                yield cause


def _names(cause: Diagnostic, name: str) -> bool:
    """Whether a diagnostic is about a folder or program of that name."""
    if not name:
        return False
    texts = [cause.element or "", cause.message]
    if cause.code == BROKEN_SCRIPT.code:  # which is about a package, and names it first
        texts = [cause.message.partition(": ")[2]]
    elif cause.code in _OF_PROGRAMS:  # messages name the package, too
        texts = [cause.element or ""]
    word = re.compile(rf"(?<![\w.-]){re.escape(name)}(?![\w-]|\.\w)")
    return any(word.search(text) for text in texts)


def _as_severe_as(cause: Diagnostic, consequences: Sequence[Diagnostic]) -> Diagnostic:
    """The cause, as severe as the worst that follows from it, with the message of that."""
    worst = min(consequences, key=lambda one: _ORDER.index(one.severity))
    others = len(consequences) - 1
    more = f" {others} more diagnostic{'s' if others > 1 else ''} would follow." if others else ""
    return replace(
        cause,
        severity=min(cause.severity, worst.severity, key=_ORDER.index),
        message=f"{cause.message} {_place(worst)}{worst.message}{more}",
    )


def _place(found: Diagnostic) -> str:
    if found.file is None:
        return ""
    line = f" (line {found.line})" if found.line else ""
    return f"In {found.file.name}{line}: "
