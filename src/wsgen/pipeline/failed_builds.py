"""What is missing because the last build failed, or because git has not fetched a submodule.

The failure is reported once, with its first error, and nothing that follows from it.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.building.last_build import explain_builds, needed_by
from wsgen.checks.rules.controller_joints import MISSING_CONTROLLER_FILE
from wsgen.checks.rules.worlds import MISSING_WORLD
from wsgen.descriptions.rules import MISSING_COLLISION_MESH, MISSING_VISUAL_MESH
from wsgen.descriptions.sdf.includes import MODEL_LEFT_OUT
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.launching.explain_missing import (
    EXECUTABLE_NOT_FOUND,
    FILE_NOT_INSTALLED,
    PACKAGE_NOT_FOUND,
    XACRO_FAILS,
)
from wsgen.model.outcome import NotValidated, PackageOutcome
from wsgen.text.files import read_regular_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.building.last_build import FailedBuild
    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.overlay import Overlay


class Validated(NamedTuple):
    """What is validated, and what is not."""

    packages: tuple[PackageOutcome, ...]
    not_validated: tuple[NotValidated, ...]


def with_failed_builds(
    packages: Sequence[PackageOutcome],
    not_validated: Sequence[NotValidated],
    failed: Mapping[str, FailedBuild],
    overlay: Overlay,
    named: Collection[str] = (),
) -> Validated:
    """Report the failed builds of the packages that outcomes are about, or need.

    A package of which nothing else is validated gets an outcome of its own if it is `named`, or if
    there is no other outcome; else the list of what is not validated says it.

    Args:
        packages: The outcomes.
        not_validated: What else there is.
        failed: The failed builds, by the name of the package.
        overlay: Of the workspace.
        named: The packages that the user asked for.
    """
    by_name = {package.name: package for package in overlay.written}
    reported: set[str] = set()
    outcomes = []
    # What project() calls a package that package.xml calls otherwise.
    other_names = {one.reason: one.element for one in _explained([*failed.values()], overlay)}
    for outcome in packages:
        used = (other_names.get(name) or name for name in _used(outcome, overlay))
        needed = needed_by(used, by_name)
        of_outcome = [one for name, one in failed.items() if name in needed]
        reported.update(one.package.name for one in of_outcome)
        outcomes.append(_with_failures(outcome, of_outcome, overlay))
    is_empty = not outcomes
    others = []
    for left in not_validated:
        one = failed.get(left.package)
        if one is None or left.package in reported:
            others.append(left)
            continue
        found = tuple(_explained([one], overlay))
        if is_empty or left.package in named:
            reported.add(left.package)
            share = overlay.share(left.package)
            outcomes.append(
                PackageOutcome(
                    package=left.package, share=share, launch_file=None, diagnostics=found
                )
            )
        else:
            why = "".join(
                each.message.replace(f"The last build of {left.package}", "; its last build")
                for each in found
            )
            others.append(replace(left, reason=f"{left.reason}{why}".removesuffix(".")))
    return Validated(tuple(outcomes), tuple(others))


def _used(outcome: PackageOutcome, overlay: Overlay) -> Iterator[str]:
    """The packages of the workspace that an outcome is about, or looks up."""
    if outcome.package is not None:
        yield outcome.package
    plan = outcome.plan
    if plan is None:
        return
    yield from (one.package for one in plan.processes if one.package)
    yield from (one.package for one in plan.includes if one.package)
    yield from (one.package for one in plan.lookups)
    for package in overlay.written:
        share = overlay.share(package.name)
        if share is not None and any(one.is_relative_to(share) for one in plan.evaluated_files):
            yield package.name


def _with_failures(
    outcome: PackageOutcome, failed: Sequence[FailedBuild], overlay: Overlay
) -> PackageOutcome:
    if not failed:
        return outcome
    packages = [one.package for one in failed]
    explained = tuple(_explained(failed, overlay))
    # The names that project() gives them, where package.xml has others.
    renamed = {one.reason for one in explained}
    kept = (
        found
        for found in outcome.diagnostics
        if not _follows(found, packages)
        and not (found.code == PACKAGE_NOT_FOUND.code and found.element in renamed)
    )
    return replace(outcome, diagnostics=(*explained, *kept))


def _explained(failed: Sequence[FailedBuild], overlay: Overlay) -> Iterator[Diagnostic]:
    distro = overlay.environment.get("ROS_DISTRO", "")
    return explain_builds(failed, overlay.written, distro)


_OF_BUILDS = ("BLD", "PKG")  # families
_OF_LOOKUPS = frozenset(
    rule.code
    for rule in (
        *(EXECUTABLE_NOT_FOUND, FILE_NOT_INSTALLED, PACKAGE_NOT_FOUND, XACRO_FAILS),
        *(MISSING_COLLISION_MESH, MISSING_VISUAL_MESH, MISSING_CONTROLLER_FILE, MISSING_WORLD),
    )
)


def _follows(found: Diagnostic, failed: Sequence[PackageFolder]) -> bool:
    """Whether a diagnostic is about what a failed build has not installed, or about its cause."""
    if found.code.startswith(_OF_BUILDS):
        return found.file is not None and any(
            found.file.is_relative_to(package.path) for package in failed
        )
    return found.code in _OF_LOOKUPS and any(
        re.search(rf"(?<![\w-]){package.name}(?![\w-])", found.message) for package in failed
    )


OF_LOOKUPS = frozenset(
    rule.code
    for rule in (
        *(FILE_NOT_INSTALLED, PACKAGE_NOT_FOUND, XACRO_FAILS, XACRO_FILE_FAILS),
        *(MISSING_COLLISION_MESH, MISSING_VISUAL_MESH, MODEL_LEFT_OUT),
    )
)
PATH = lazy_pattern(r"(?m)^[ \t]*path[ \t]*=[ \t]*(\S.*?)[ \t]*$")
MOST_LEVELS = 4  # from a package up to the top of its repository


class Submodule(NamedTuple):
    """One whose folder is empty or not there."""

    top: Path  # of the repository that names it
    path: str  # in that


def with_submodules(found: Iterable[Diagnostic], folders: Iterable[Path]) -> tuple[Diagnostic, ...]:
    """Say of what is missing which submodule brings it; `folders` are those of the packages."""
    reported = tuple(found)
    if not any(one.code in OF_LOOKUPS for one in reported):
        return reported
    absent = _absent(folders)
    return tuple(_with_submodule(one, absent) for one in reported) if absent else reported


def _absent(folders: Iterable[Path]) -> list[Submodule]:
    tops = {top for folder in folders for top in (folder, *[*folder.parents][:MOST_LEVELS])}
    absent = []
    for top in sorted(tops):
        try:
            text = read_regular_text(top / ".gitmodules", errors="replace")
        except OSError:
            continue
        for path in PATH.findall(text):
            try:
                is_empty = not any((top / path).iterdir())
            except OSError:
                is_empty = not (top / path).exists()
            if is_empty:
                absent.append(Submodule(top, path))
    return absent


def _with_submodule(one: Diagnostic, absent: Iterable[Submodule]) -> Diagnostic:
    if one.code not in OF_LOOKUPS:
        return one
    for submodule in absent:
        parts = submodule.path.split("/")
        # The install space has what is below a package; two folders of it tell it from others.
        words = ["/".join(parts[start:]) for start in range(max(len(parts) - 1, 1))]
        if one.code == PACKAGE_NOT_FOUND.code:
            words.append(parts[-1])  # most often it is the name of the repository
        pattern = "|".join(map(re.escape, words))
        if re.search(rf"(?<![\w.-])(?:{pattern})(?![\w.-])", one.message):
            return replace(
                one,
                hint=f"git has not fetched the submodule {submodule.path}: run "
                f"`git submodule update --init --recursive` in {submodule.top}.",
            )
    return one
