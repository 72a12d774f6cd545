"""How the last build of each package ended, from what colcon left: a result and a log.

What is installed by a build that failed is a part of the package, or the one of an earlier build.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.workspace.layout import BUILD_RESULT
from wsgen.packages.workspace.manifest import BUILD_TAGS, RUN_TAGS
from wsgen.text.files import read_or_empty

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.layout import PackageFolder, Workspace


FAILED_BUILD = Rule(
    code="BLD069",
    name="failed-build",
    severity=Severity.ERROR,
    summary="The last build of a package failed.",
    what="Reads, for the packages that a launch file uses and those that they depend on, the "
    "result and the log of the last `colcon build` or `wsgen build`.",
    why="The install space holds a part of the package, what an earlier build left, or nothing of "
    "it. What is simulated is not what the sources say.",
    example="wsgen build  # fails\nwsgen validate",
    instead="wsgen build  # until it succeeds\nwsgen validate",
)

STARTED = "colcon_command_prefix_*"  # also there; colcon writes it before it runs anything
INTERRUPTED = "SIGINT"  # as result
_EVENT = r"^\[[\d.]+\] \({}\) (?:JobStarted|JobEnded: .*'rc': '?(\w+))"  # in events.log


class FailedBuild(NamedTuple):
    """A package whose last build failed."""

    package: PackageFolder
    build_folder: Path
    log: Path | None  # the folder of the whole build; None where it is gone
    was_interrupted: bool


def failed_builds(
    workspaces: Iterable[Workspace], packages: Sequence[PackageFolder]
) -> dict[str, FailedBuild]:
    """The packages of the workspaces whose last build failed or was interrupted, by name."""
    return {
        package.name: found
        for workspace in workspaces
        for package in packages
        if workspace.package_folders or package.path.is_relative_to(workspace.root)
        if (found := _failed_build(workspace, package))
    }


def _failed_build(workspace: Workspace, package: PackageFolder) -> FailedBuild | None:
    folder = workspace.build / package.name
    result = read_or_empty(folder / BUILD_RESULT).strip()
    is_good = result in {"", "0"}
    if is_good and not _was_started_after(folder):
        return None
    log = _last_log(workspace, package.name)
    in_log = None if log is None else _result_in(log, package.name)
    # A later build may have had another build folder; one that was killed has left no result.
    if in_log == "0" or (is_good and in_log is None):
        return None
    return FailedBuild(package, folder, log, INTERRUPTED in {result, in_log} or in_log == "")


def _was_started_after(folder: Path) -> bool:
    """Whether a build began in a build folder after the last one that ended there."""
    try:
        ended = (folder / BUILD_RESULT).stat().st_mtime_ns
    except OSError:
        ended = 0
    try:
        return any(one.stat().st_mtime_ns > ended for one in folder.glob(STARTED))
    except OSError:
        return False


def _last_log(workspace: Workspace, package: str) -> Path | None:
    """The log of the last build with the package."""
    try:
        folders = sorted(workspace.log.glob("build_*"), reverse=True)  # named by date and time
    except OSError:
        return None
    return next((one for one in folders if (one / package).is_dir()), None)


def _result_in(log: Path, package: str) -> str | None:
    """The result of a package; empty where its build did not end, None where nothing says it."""
    text = read_or_empty(log / "events.log")
    events = re.findall(_EVENT.format(re.escape(package)), text, re.MULTILINE)
    return events[-1] if events else None


def explain_builds(
    failed: Sequence[FailedBuild], packages: Collection[PackageFolder], distro: str
) -> Iterator[Diagnostic]:
    """Report failed builds, each with its first error.

    One that failed for lack of another one is left out.

    Args:
        failed: Some of the packages.
        packages: All packages of the workspace.
        distro: Of the ROS that is sourced; empty without one.
    """
    siblings = {package.name for package in packages}
    for one in failed:
        name = one.package.name
        others = [other.package.name for other in failed if other is not one]
        first = None if one.was_interrupted else _first_error(one, siblings, others, distro)
        if first is not None and any(re.search(rf"\b{other}\b", first.message) for other in others):
            continue
        if first is None:
            what = "was interrupted" if one.was_interrupted else "failed"
            yield FAILED_BUILD.at(
                one.package.path,
                element=name,
                message=f"The last build of {name} {what}.",
                hint="Run `wsgen build`.",
            )
            continue
        edited = _edited(one, first.file)
        yield FAILED_BUILD.at(
            first.file,
            first.line,
            name,
            reason=first.reason,
            message=f"The last build of {name} failed: {first.message.removeprefix(f'{name}: ')}",
            hint=f"{edited.name} was changed after that. Run `wsgen build`."
            if edited is not None
            else _and_build(first.hint or ""),
        )


def _and_build(hint: str) -> str:
    if hint.endswith((".", "?")):
        return f"{hint} Then run `wsgen build`."
    return f"{hint}; then run `wsgen build`."  # it ends with a command


def _edited(one: FailedBuild, file: Path | None) -> Path | None:
    """The file of an error, or a build file, that was changed after the build."""
    folder = one.package.path
    files = [folder / name for name in ("CMakeLists.txt", "setup.py", "setup.cfg", "package.xml")]
    try:
        ended = (one.build_folder / BUILD_RESULT).stat().st_mtime
        there = [each for each in (file, *files) if each is not None and each.is_file()]
        return next((each for each in there if each.stat().st_mtime > ended), None)
    except OSError:
        return None


def _first_error(
    one: FailedBuild, siblings: Collection[str], others: Sequence[str], distro: str
) -> Diagnostic | None:
    from wsgen.building.explain import explain  # noqa: PLC0415  most builds succeed
    from wsgen.building.failure import Failure  # noqa: PLC0415  as above

    package, log = one.package, one.log
    output = "" if log is None else _error_output(log / package.name)
    if not output:
        return None
    manifest = package.manifest
    depended = frozenset() if manifest is None else manifest.names(BUILD_TAGS)
    failure = Failure(
        package=package.name,
        folder=package.path,
        is_python=package.build_type == "ament_python",
        build_folder=one.build_folder,
        output=output,
        siblings=siblings,
        distro=distro,
        log=log,
        failed=depended.intersection(others),
    )
    return explain(failure)[0]


def _error_output(log: Path) -> str:
    """What the programs of a package wrote about errors, as `wsgen.building.colcon` collects it."""
    of_errors = read_or_empty(log / "stderr.log")
    _, failed, rest = read_or_empty(log / "stdout.log").partition("\nFAILED: ")
    return of_errors + failed + rest


def needed_by(names: Iterable[str], packages: Mapping[str, PackageFolder]) -> frozenset[str]:
    """The packages with these names, and those of the workspace that they depend on."""
    found: set[str] = set()
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        package = packages.get(name)
        if name not in found and package is not None:
            found.add(name)
            if package.manifest is not None:
                waiting += package.manifest.names(BUILD_TAGS | RUN_TAGS)
    return frozenset(found)
