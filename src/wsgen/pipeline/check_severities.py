"""How bad it is what a launch file, a robot or a world shows that nobody starts.

Read by itself, a file lacks what it is given where it is used; and that an engine of wsgen leaves
something out does not matter where nothing is simulated. What a package that is not on this machine
has is unknown.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description_rules import MISSING_COLLISION_MESH, MISSING_VISUAL_MESH
from wsgen.diagnostics import Severity
from wsgen.files import real_path
from wsgen.launch.descriptions import UNPUBLISHED_DESCRIPTION
from wsgen.launch.explain import (
    ARGUMENT_WITHOUT_VALUE,
    INTERACTIVE_INPUT,
    NEEDS_UNKNOWN,
    UNDEFINED_CONFIGURATION,
    VARIABLE_NOT_SET,
)
from wsgen.launch.explain_missing import FILE_NOT_INSTALLED, PACKAGE_NOT_FOUND, XACRO_FAILS
from wsgen.launch.explain_names import RAISES, UNSUPPORTED_API
from wsgen.launch.simulators import NO_SIMULATOR
from wsgen.launch.spawner_options import INVALID_SPAWNER_OPTION
from wsgen.launch.undeclared import UNDECLARED_PACKAGE
from wsgen.pipeline.file_validation import NO_MODEL, PART_OF_ROBOT
from wsgen.ros_names import released_packages
from wsgen.rules.simulators import SPAWNER_OF_OTHER_SIMULATOR
from wsgen.sdf.assembly import CLOSED_CHAIN, JOINT_LEFT_OUT
from wsgen.sdf.shapes import SHAPE_LEFT_OUT
from wsgen.sdf.worlds import NO_GROUND
from wsgen.suggestions import misspelled_as, suggested
from wsgen.urdf.gazebo import SDF_NOT_SIMULATED
from wsgen.values import lazy_pattern
from wsgen.xacro.reader import XACRO_FILE_FAILS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.candidates import Candidate


# What Gazebo simulates, and no engine of wsgen.
OF_SIMULATION = frozenset(
    rule.code for rule in (CLOSED_CHAIN, JOINT_LEFT_OUT, SDF_NOT_SIMULATED, SHAPE_LEFT_OUT)
)


def without_simulation(diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """What is left out of a simulation is an information."""
    for found in diagnostics:
        if found.code in OF_SIMULATION:
            yield replace(found, severity=Severity.INFO)
        else:
            yield found


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


def of_launch(one: Candidate, beside: Iterable[Candidate]) -> Iterator[Diagnostic]:
    """What is wrong with a launch file, whatever it is started with."""
    started = one.started
    is_inner = is_included(one, beside)
    # With an empty default, somebody is meant to give it, too.
    has_gaps = any(argument.default == "" for argument in started.plan.arguments)
    for found in started.diagnostics if started.has_spawner else started.plan.diagnostics:
        if found.code == UNDECLARED_PACKAGE.code and one.launch_file.package:
            continue  # reported once for all files of the package
        if found.code in GIVEN_FROM_OUTSIDE or _lacks_device(found):
            if not is_inner:
                yield replace(found, severity=Severity.INFO)
        elif found.code == NO_SIMULATOR.code or (
            found.code == UNPUBLISHED_DESCRIPTION.code and found.severity is Severity.WARNING
        ):  # somebody may start it in another terminal, or a file that is not here does
            yield replace(found, severity=Severity.INFO)
        elif found.code == PACKAGE_NOT_FOUND.code and (has_gaps or not _is_misspelled(found)):
            yield replace(found, severity=Severity.WARNING)  # it may be in another workspace
        elif found.code == UNDEFINED_CONFIGURATION.code and not suggested(found.hint):
            yield replace(found, severity=Severity.WARNING)  # who includes it may set it
        elif found.code == INVALID_SPAWNER_OPTION.code and has_gaps:
            yield replace(found, severity=Severity.INFO)
        elif found.code == FILE_NOT_INSTALLED.code and OF_NO_PACKAGE in (found.hint or ""):
            yield replace(found, severity=Severity.WARNING)  # some program may write it before
        else:
            yield found


DEVICE = lazy_pattern(r"/dev/(?!shm\b|null\b)\w")
OF_NO_PACKAGE = "Look it up in the share folder of a package"  # the hint for other paths


def _lacks_device(found: Diagnostic) -> bool:
    """Whether a launch file raises for something that is attached to the robot."""
    return found.code == RAISES.code and DEVICE.search(found.message) is not None


def _is_misspelled(found: Diagnostic) -> bool:
    """Whether a package that is not found is surely one whose name is nearly the same."""
    meant = suggested(found.hint)
    name = QUOTED.search(found.message)
    return bool(meant and name and misspelled_as(name[1], [meant]))


def is_included(one: Candidate, beside: Iterable[Candidate]) -> bool:
    """Whether one of the other launch files includes this one."""
    file = real_path(one.file)
    return any(file in other.included for other in beside if other is not one)


QUOTED = lazy_pattern(r"'([^']+)'")
# Of xacro, where a launch file or another xacro file gives what the file needs.
UNDEFINED_ARGUMENT = "Undefined substitution argument"
NOT_FOUND = lazy_pattern(r"the package '[^']+' is not found")


def of_file_alone(diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """What is wrong with a file; that it holds only a part of a robot or world is not."""
    for found in diagnostics:
        if found.code == NO_MODEL.code:
            continue
        # What a world stands on may be spawned into it.
        if (
            found.code in {PART_OF_ROBOT.code, NO_GROUND.code}
            or UNDEFINED_ARGUMENT in found.message
        ):
            yield replace(found, severity=Severity.INFO)
        elif found.code == XACRO_FILE_FAILS.code and NOT_FOUND.search(found.message):
            is_known = not _is_misspelled(found)  # see `_of_launch`
            yield replace(found, severity=Severity.WARNING) if is_known else found
        else:
            yield found


_OF_PACKAGES = frozenset(
    rule.code
    for rule in (MISSING_COLLISION_MESH, MISSING_VISUAL_MESH, PACKAGE_NOT_FOUND, XACRO_FILE_FAILS)
)
_ABSENT = lazy_pattern(
    r"package ['`]([^'`]+)['`](?: is not found|, which was not found| is needed, and the package)"
)


def without_absent_packages(
    diagnostics: Iterable[Diagnostic], declared: Collection[str]
) -> Iterator[Diagnostic]:
    """Take what a package that is not on this machine would have for what it is: unknown.

    `package.xml` declares the packages of `declared`: the user has them where the package runs.
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
            yield one
        elif absent[1] in declared or absent[1] in released_packages():
            yield replace(one, severity=Severity.INFO)
        elif one.code == MISSING_COLLISION_MESH.code and not _is_in_own_package(one):
            yield replace(one, severity=Severity.WARNING)  # it may be in another workspace
        else:
            yield one


def without_replaced_options(diagnostics: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Leave out options of a spawner that is to be replaced by the one of another simulator."""
    found = list(diagnostics)
    replaced = {
        (one.file, one.line) for one in found if one.code == SPAWNER_OF_OTHER_SIMULATOR.code
    }
    for one in found:
        if one.code != INVALID_SPAWNER_OPTION.code or (one.file, one.line) not in replaced:
            yield one


def _is_in_own_package(missing: Diagnostic) -> bool:
    """Whether the mesh is in the robot's package: the address leaves out the name of that."""
    return (missing.hint or "").startswith("Write package://")
