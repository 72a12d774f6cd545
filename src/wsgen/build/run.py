"""`colcon build` with the right toolchain, its progress as events, its failures explained."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.build.colcon import STEP, Finished, PackageResult, Progress, run_colcon
from wsgen.build.installed import check_installed, find_moved
from wsgen.build.request import (
    block_extensions,
    blocked_extensions,
    build_arguments,
    choose_packages,
    selects_packages,
)
from wsgen.build.sources import (
    missing_build_types,
    missing_test_dependencies,
    passed_over,
    unknown_build_types,
)
from wsgen.build.toolchain import find_toolchain, package_prefixes
from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.errors import NotFoundError
from wsgen.events import Listener, OutputLine, StepEnded, StepStarted, post
from wsgen.workspace.layout import take_inventory
from wsgen.workspace.package_xml import check_package_xml
from wsgen.workspace.paths import check_workspace_path

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.build.toolchain import Toolchain
    from wsgen.workspace.layout import Inventory, PackageFolder, Workspace


UNEXPLAINED = frozenset({"BLD015", "BLD016", "BLD020"})  # these say no more than the output
DEPRECATED_MINIMUM = "BLD030"
MINIMUM_THAT_LASTS = "cmake_minimum_required(VERSION 3.8...3.31)"


@dataclass(frozen=True, kw_only=True)
class BuildResult:
    """What became of the build."""

    succeeded: bool  # every package was built, and nothing is wrong with the user's files
    packages: tuple[PackageResult, ...]  # in the order in which they ended
    seconds: float  # wall-clock
    diagnostics: tuple[Diagnostic, ...] = ()
    log_folder: Path | None = None  # None where logging is off, or colcon did not get so far
    colcon_output: tuple[str, ...] = ()  # the lines that colcon itself wrote to standard error

    @property
    def not_built(self) -> tuple[str, ...]:
        """Names of the packages that were skipped or stopped because another one failed."""
        return tuple(
            package.name
            for package in self.packages
            if package.outcome in {"skipped", "interrupted"}
        )

    @property
    def unexplained_output(self) -> tuple[str, ...]:
        """What was written to standard error and is not in other words in the diagnostics.

        Those are the warnings of what was built, and the output of failures that nobody knows.
        """
        errors = [found for found in self.diagnostics if found.severity is Severity.ERROR]
        puzzling = {found.element for found in errors if found.code in UNEXPLAINED}
        explained = {found.element for found in errors} - puzzling
        lines = [] if errors and not puzzling else [*self.colcon_output]
        for package in self.packages:
            if package.name in puzzling or (
                package.outcome == "built" and package.name not in explained
            ):
                lines += package.error_output
        if any(found.code == DEPRECATED_MINIMUM for found in self.diagnostics):
            from wsgen.build.failure import split_deprecations  # noqa: PLC0415  as above

            return split_deprecations(lines)[0]
        return tuple(lines)


@dataclass(frozen=True, kw_only=True)
class _Job:
    """The request, looked at."""

    workspace: Workspace
    inventory: Inventory
    selected: tuple[PackageFolder, ...]
    names: tuple[str, ...]
    colcon_arguments: tuple[str, ...]


def build(
    workspace: Workspace,
    *,
    packages: Sequence[str] = (),
    colcon_arguments: Sequence[str] = (),
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> BuildResult:
    """Build the workspace with colcon, or some packages with those they depend on.

    What the programs of a package print arrives at the listener as OutputLine while it is built;
    what they wrote to standard error is in the result as well, for those who show it at the end.

    Args:
        workspace: where to build.
        packages: names of packages; empty for all.
        colcon_arguments: further arguments for `colcon build`.
        environment: the user's variables; the toolchain's are added to them.
        listener: told what happens, in steps `("build",)` and `("build", PACKAGE)`.

    Raises:
        RequestError: a package is unknown or ignored, colcon refuses the arguments, or nothing
            can be built in a folder of this name.
        NotFoundError: there is nothing to build, or nothing to build it with.
        NotReadableError: build, install or log cannot be written.
        KeyboardInterrupt: the build was interrupted; nothing that it started is left running.
    """
    started = time.monotonic()
    check_workspace_path(workspace.root)
    inventory = take_inventory(workspace)
    job = _Job(
        workspace=workspace,
        inventory=inventory,
        selected=choose_packages(workspace, inventory, packages, colcon_arguments),
        names=tuple(packages),
        colcon_arguments=tuple(colcon_arguments),
    )
    progress = Progress(listener)
    succeeded, diagnostics = _build(job, environment, progress)
    diagnostics = (*diagnostics, *_deprecated_minimum(job, progress))
    result = BuildResult(
        succeeded=succeeded and not has_errors(diagnostics),
        packages=tuple(progress.results),
        seconds=time.monotonic() - started,
        diagnostics=diagnostics,
        log_folder=progress.log_folder,
        colcon_output=tuple(progress.colcon_output),
    )
    post(
        listener,
        StepEnded(
            step=STEP,
            succeeded=result.succeeded,
            seconds=result.seconds,
            detail=_count(result),
        ),
    )
    return result


def _count(result: BuildResult) -> str:
    built = sum(package.outcome == "built" for package in result.packages)
    if built == len(result.packages):
        return f"{built} of {built} packages"
    failed = sum(package.outcome == "failed" for package in result.packages)
    left = f", {len(result.not_built)} not built ({', '.join(result.not_built)})"
    return f"{built} built, {failed} failed{left if result.not_built else ''}"


def _build(
    job: _Job, environment: Mapping[str, str], progress: Progress
) -> tuple[bool, tuple[Diagnostic, ...]]:
    """Build, and say whether colcon succeeded and what there is to tell."""
    post(progress.listener, StepStarted(step=STEP, detail=str(job.workspace.root)))
    broken = tuple(finding for package in job.selected for finding in package.diagnostics)
    if job.names and has_errors(broken):
        return False, broken  # colcon would say that there is no such package
    moved = find_moved(job.workspace, job.inventory.packages, job.colcon_arguments)
    if moved:
        return False, (*broken, *moved)  # it might build, and elsewhere
    finished, notes = _run(job, environment, progress)
    overlooked = tuple(_overlooked(job, finished, progress))
    if finished.returncode == 0 and not finished.output:
        return True, (*broken, *notes, *overlooked)
    from wsgen.build.explain import explain_failure, refuse_full_disk  # noqa: PLC0415  who succeeds saves 5 ms

    if finished.returncode == 0:
        refuse_full_disk(finished.output, job.workspace)  # colcon's log has not found room
        return True, (*broken, *notes, *overlooked)
    distro = environment.get("ROS_DISTRO", "")
    causes = explain_failure(job.workspace, job.inventory, progress, finished, distro=distro)
    # What makes colcon build a package as another one is the cause of whatever fails in it.
    mistaken = {finding.element for finding in overlooked}
    causes = tuple(finding for finding in causes if finding.element not in mistaken)
    return False, (*broken, *causes, *overlooked, *notes)


def _run(
    job: _Job, environment: Mapping[str, str], progress: Progress
) -> tuple[Finished, tuple[Diagnostic, ...]]:
    """Run colcon; also say what was changed about the request."""
    toolchain = _find_toolchain(job, environment)
    variables = toolchain.environment(environment) if toolchain else dict(environment)
    block_extensions(
        variables,
        workspace=job.workspace,
        inventory=job.inventory,
        colcon_arguments=job.colcon_arguments,
    )
    notes: tuple[Diagnostic, ...] = ()
    if toolchain and not any("BUILD_TESTING" in word for word in job.colcon_arguments):
        notes = missing_test_dependencies(
            job.inventory.packages,
            prefixes=package_prefixes(toolchain, environment),
            built_here={package.name for package in job.inventory.packages},
        )
    finished = run_colcon(
        build_arguments(
            job.names,
            job.colcon_arguments,
            without_tests=bool(notes),
            blocked=blocked_extensions(environment),
        ),
        folder=job.workspace.root,
        environment=variables,
        on_event=progress,
    )
    outcomes = {package.outcome for package in progress.results}
    if "interrupted" in outcomes and "failed" not in outcomes:
        raise KeyboardInterrupt  # somebody interrupted colcon and not us
    if progress.results:  # otherwise it is in the diagnostics or in the error
        progress.colcon_output += finished.output.splitlines()
        for line in progress.colcon_output:
            post(progress.listener, OutputLine(step=STEP, text=line, is_error_stream=True))
    built = {package.name for package in progress.results if package.outcome == "built"}
    return finished, tuple(note for note in notes if note.element in built)


def _find_toolchain(job: _Job, environment: Mapping[str, str]) -> Toolchain | None:
    """Find it; None if there is none and no package needs ament_cmake."""
    try:
        return find_toolchain(environment)
    except NotFoundError:
        if any(package.build_type == "ament_cmake" for package in job.selected):
            raise
        return None


def _deprecated_minimum(job: _Job, progress: Progress) -> Iterator[Diagnostic]:
    """Say once which packages name an old version of CMake; CMake has nine lines for each."""
    places: list[tuple[str, Path, int]] = []
    for result in progress.results:
        if any("cmake_minimum_required" in line for line in result.error_output):
            from wsgen.build.failure import split_deprecations  # noqa: PLC0415  rare

            package = next((one for one in job.inventory.packages if one.name == result.name), None)
            for name, line in split_deprecations(result.error_output)[1]:
                places.append((result.name, (package.path if package else Path()) / name, line))
    if places:
        names = ", ".join(dict.fromkeys(name for name, _, _ in places))
        _, file, line = places[0]
        yield Diagnostic(
            code=DEPRECATED_MINIMUM,
            severity=Severity.INFO,
            message=f"CMake deprecates the version in cmake_minimum_required() of {names}.",
            file=file,
            line=line,
            hint=f"Write {MINIMUM_THAT_LASTS}: the oldest CMake as before, up to the newest known.",
        )


def _overlooked(job: _Job, finished: Finished, progress: Progress) -> Iterator[Diagnostic]:
    """Say what colcon passed over in silence."""
    unknown = tuple(unknown_build_types(job.inventory.packages, finished.output))
    yield from unknown
    yield from missing_build_types(job.selected)
    if finished.returncode != 0:
        return
    results = {result.name for result in progress.results}
    if not (job.names or selects_packages(job.colcon_arguments)):
        for package in job.selected:
            if not package.diagnostics and package.name not in results:
                yield from check_package_xml(package.path / "package.xml")
    explained = {finding.element for finding in unknown}
    yield from passed_over(job.selected, wanted={*job.names} - explained, built=results)
    built = (package for package in job.inventory.packages if package.name in results)
    yield from check_installed(built, job.workspace)
