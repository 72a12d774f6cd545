"""The errors of `wsgen check` that concern what `wsgen validate` has evaluated and read.

Nothing is evaluated, expanded or read again. What is a warning of `wsgen check` stays one of it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules.consequences import OF_FOLDERS
from wsgen.checks.rules.frames import NO_JOINT_STATES
from wsgen.checks.rules.manifests import target_of
from wsgen.diagnostics import Severity
from wsgen.launching.package_lookup import UNDECLARED_PACKAGE
from wsgen.packages.build_files.facts import read_build_facts
from wsgen.pipeline.changed_since_build import equal_source_of
from wsgen.pipeline.check_launched import (
    check_addresses,
    check_heights,
    check_launched,
    check_worlds,
    loaded_worlds,
    may_publish_joint_states,
)
from wsgen.pipeline.check_sources import check_controlled, check_sources
from wsgen.text.files import real_path

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import World
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.pipeline.package_validation import Validation
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.started import Started


def without_undeclared(validation: Validation) -> list[Diagnostic]:
    """What a validation has reported without what package.xml does not declare.

    `errors_of_check` reports that once for all files of the package, knowing what it is for.
    """
    names = {one.name for one in validation.overlay.written}
    if validation.selected.problem is not None or validation.package not in names:
        return validation.diagnostics
    return [one for one in validation.diagnostics if one.code != UNDECLARED_PACKAGE.code]


def errors_of_check(
    validation: Validation, world: World | None, scene: Sequence[PreparedRobot]
) -> list[Diagnostic]:
    """The errors that `wsgen check` reports, but for those that the validation has reported.

    They are those of the launch file with its world and robots, of the package, and of the packages
    whose programs and launch files it starts.
    """
    if validation.selected.problem is not None:
        return []  # the problem is in these files
    packages = {one.name: one for one in validation.overlay.written}
    found = [*_of_packages(validation, packages, _used_files(validation, world))]
    if validation.started is not None:
        package = packages.get(validation.package)
        distro = _distro_of(package, validation, packages)
        found += _of_launched(validation, validation.started, world, scene, distro)
    reported = {
        (one.code, one.file, one.line)
        for one in validation.diagnostics
        if one.severity is Severity.ERROR
    }
    return [
        one
        for one in dict.fromkeys(found)
        if (one.severity is Severity.ERROR or one.code in _REPORTED_TOO)
        and (one.code, one.file, one.line) not in reported
    ]


# Warnings without which what is validated seems to work.
_REPORTED_TOO = frozenset({NO_JOINT_STATES.code, UNDECLARED_PACKAGE.code})


def _of_launched(
    validation: Validation,
    started: Started,
    world: World | None,
    scene: Sequence[PreparedRobot],
    distro: str | None,
) -> Iterator[Diagnostic]:
    overlay = validation.overlay
    yield from check_launched(
        started,
        overlay.environment,
        validation.selected.beside,
        is_known=lambda name: name not in overlay.sources and overlay.share(name) is not None,
        distro=distro,
        is_installed=lambda name: overlay.share(name) is not None,
        may_publish=may_publish_joint_states(overlay.written),
    )
    yield from check_addresses(started, overlay.share)
    if not started.is_evaluated:
        return
    yield from check_heights(started, world, scene, validation.diagnostics)
    worlds = [world.file] if world is not None and world.file is not None else []
    yield from check_worlds(
        worlds,
        loaded_worlds([started], overlay.environment),
        overlay.environment,
        simulator=validation.simulator_kind,
        distro=distro,
        spawned_into={real_path(file) for file in worlds},
    )
    files = {spawn.entity: spawn.description_file for spawn in started.spawns}
    yield from check_controlled(
        ((one.written, files.get(one.entity)) for one in scene if not one.is_static_model),
        [started.plan],
        overlay.share,
    )


def _used_files(validation: Validation, world: World | None) -> list[Path]:
    """The launch files, robots and the world that a launch file uses."""
    started = validation.started
    if started is None:
        return []
    robots = (spawn.description_file for spawn in started.spawns)
    files = (*started.plan.evaluated_files, *robots, world.file if world else None)
    return [file for file in files if file is not None]


def _of_packages(
    validation: Validation, packages: Mapping[str, PackageFolder], used: Sequence[Path]
) -> Iterator[Diagnostic]:
    plan = _with_sources(validation)
    names = [validation.package] if validation.selected.is_first else []
    if plan is not None:
        names += [one.package for one in plan.processes if one.package]
        names += [one.package for one in plan.includes if one.package]
    for name in dict.fromkeys(names):
        package = packages.get(name)
        if package is None:
            continue
        build, problems = read_build_facts(package.path, name, package.build_type)
        yield from check_sources(
            package,
            build=build,
            problems=_with_needed_folders(problems, package.path, used),
            plans=[plan] if plan is not None and name == validation.package else [],
            packages=packages,
            distro=_distro_of(package, validation, packages),
        )


def _with_sources(validation: Validation) -> LaunchPlan | None:
    """The plan, with the sources of the launch files that look packages up."""
    started, selected = validation.started, validation.selected
    if started is None or selected.share is None or selected.source is None:
        return started and started.plan
    sources = {selected.share: selected.source}
    lookups = (
        replace(one, file=equal_source_of(one.file, sources)) for one in started.plan.lookups
    )
    return replace(started.plan, lookups=tuple(lookups))


def _with_needed_folders(
    problems: Iterable[Diagnostic], source: Path, used: Sequence[Path]
) -> Iterator[Diagnostic]:
    """What is wrong in build files: a folder that is not installed is an error where it is used.

    It is used from the source where the package is not built.
    """
    for one in problems:
        folder = source / one.element if one.code in OF_FOLDERS and one.element else None
        if folder is not None and any(file.is_relative_to(folder) for file in used):
            yield replace(one, severity=Severity.ERROR)
        else:
            yield one


def _distro_of(
    package: PackageFolder | None, validation: Validation, packages: Mapping[str, PackageFolder]
) -> str | None:
    return target_of(
        package.manifest if package else None,
        recorded=validation.settings.distro if validation.settings else None,
        sourced=validation.overlay.environment.get("ROS_DISTRO"),
        workspace=packages.keys(),
    ).distro
