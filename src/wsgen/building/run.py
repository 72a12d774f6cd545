"""Run `colcon build` with the right toolchain, post its progress, and explain its failures."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.building.colcon import (
    STEP,
    Finished,
    PackageResult,
    Progress,
    block_extensions,
    blocked_extensions,
    build_arguments,
    choose_packages,
    run_colcon,
    selects_packages,
)
from wsgen.building.installed import NEW_CACHE, check_installed, find_relocated
from wsgen.building.left_out import (
    OLD_PACKAGES,
    SOURCED_VARIABLES,
    WITHOUT_TESTS,
    add_left_out,
    configure_again,
    missing_build_types,
    missing_test_dependencies,
    report_left_out,
    skipped_packages,
    tests_left_out,
    unknown_build_types,
    without_ros_arguments,
    without_ros_variables,
)
from wsgen.building.toolchain import SourcedRos, find_toolchain, package_prefixes
from wsgen.diagnostics import Diagnostic, Rule, Severity, has_errors
from wsgen.errors import NotFoundError, WsgenError
from wsgen.events import Listener, OutputLine, StepEnded, StepStarted, post
from wsgen.packages.build_files.cmake_text import read_calls
from wsgen.packages.workspace.layout import check_workspace_path, take_inventory
from wsgen.packages.workspace.package_xml import check_package_xml, refusals_of
from wsgen.text.suggestions import some_of
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.building.toolchain import Toolchain
    from wsgen.events import Listener
    from wsgen.packages.workspace.layout import Inventory, PackageFolder, Workspace


GENERATE = "rosidl_generate_interfaces"
VARIABLE = "WSGEN_ROS"  # which cmake/interfaces.cmake reads


@dataclass(frozen=True, kw_only=True)
class MessageSupport:
    """What generates messages, or why nothing does."""

    variables: Mapping[str, str]  # for CMake
    arguments: tuple[str, ...] = ()  # of CMake: other ones make colcon configure again
    why_not: str = ""  # what to do to have messages


def message_support(
    packages: Iterable[PackageFolder], environment: Mapping[str, str], listener: Listener | None
) -> MessageSupport:
    """Bring what generates messages, if a package has some and wsgen[ros] is installed.

    Args:
        packages: of the workspace.
        environment: the user's variables.
        listener: receives progress.
    """
    called: set[str] = set()
    has_messages = False
    for package in packages:
        if package.build_type == "ament_cmake":
            calls = read_calls(package.path / "CMakeLists.txt")
            if any(call.command == GENERATE for call in calls):
                has_messages = True
                called.update(word for call in calls for word in call.arguments)
    if not has_messages:
        return MessageSupport(variables={VARIABLE: ""})
    from wsgen.ros.environment.environment import find_compiler, open_private  # noqa: PLC0415  rare

    def listen(event: object) -> None:
        if listener is not None:
            listener(event)  # type: ignore[arg-type]  # whatever events are

    try:
        ros = open_private(environment, messages=called, listener=listen)
        find_compiler(environment, listen)
    except WsgenError as error:
        return MessageSupport(
            variables={VARIABLE: ""}, why_not=f"{error.message} {error.hint}".replace("\n", " ")
        )
    *messages, prefix = map(str, ros.prefixes)
    value = os.pathsep.join([prefix, *messages])
    return MessageSupport(variables={VARIABLE: value}, arguments=(f"-D{VARIABLE}={prefix}",))


DEPRECATED_MINIMUM = Rule(
    code="BLD030",
    name="deprecated-cmake-minimum",
    severity=Severity.INFO,
    summary="`cmake_minimum_required()` names a version that CMake deprecates.",
    what="Collects the deprecation warnings of CMake, and reports them once for all packages.",
    why="A later CMake will refuse the package. Until then it prints a warning of nine lines for "
    "each package.",
    example="cmake_minimum_required(VERSION 3.8)",
    instead="cmake_minimum_required(VERSION 3.8...3.31)",
)


CONTINUE = "--continue-on-error"


@dataclass(frozen=True, kw_only=True)
class BuildResult:
    """The outcome of a build."""

    succeeded: bool  # every package was built, and no diagnostic is an error
    packages: tuple[PackageResult, ...]  # in the order in which they ended
    seconds: float  # wall-clock
    diagnostics: tuple[Diagnostic, ...] = ()
    log_folder: Path | None = None  # None if logging is off, or colcon failed before
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
        """The lines on standard error that the diagnostics do not explain.

        These are warnings of built packages, and the output of failures without a known cause.
        """
        errors = [found for found in self.diagnostics if found.severity is Severity.ERROR]
        unexplained = set()
        if errors:
            from wsgen.building.explain import UNEXPLAINED  # noqa: PLC0415  who succeeds saves 5 ms

            unexplained = {found.element for found in errors if found.code in UNEXPLAINED}
        explained = {found.element for found in errors} - unexplained
        lines = [] if errors and not unexplained else [*self.colcon_output]
        for package in self.packages:
            if package.name in unexplained or (
                package.outcome == "built" and package.name not in explained
            ):
                lines += package.error_output
        if any(found.code == DEPRECATED_MINIMUM.code for found in self.diagnostics):
            from wsgen.building.failure import split_deprecations  # noqa: PLC0415  as above

            lines = [*split_deprecations(lines)[0]]
        if any("setuptools" in line or "byte-compiling" in line for line in lines):
            from wsgen.building.installed import without_warnings  # noqa: PLC0415  as above

            lines = without_warnings(lines)
        return tuple(lines)


@dataclass(frozen=True, kw_only=True)
class _Job:
    """The request, with the packages that it selects."""

    workspace: Workspace
    inventory: Inventory
    selected: tuple[PackageFolder, ...]
    names: tuple[str, ...]
    colcon_arguments: tuple[str, ...]
    strict: bool


def build(  # noqa: PLR0913  a request
    workspace: Workspace,
    *,
    packages: Sequence[str] = (),
    colcon_arguments: Sequence[str] = (),
    strict: bool = False,
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> BuildResult:
    """Build the workspace with colcon, or some packages with those they depend on.

    The output of a package arrives at the listener as OutputLine events during the build. The
    result also holds its standard error, for callers that show it at the end.

    Args:
        workspace: where to build.
        packages: names of packages; empty for all.
        colcon_arguments: further arguments for `colcon build`.
        strict: whether it is an error that a package cannot be compiled, because no ROS is sourced.
        environment: the user's variables; the toolchain's are added to them.
        listener: gets the events, in steps `("build",)` and `("build", PACKAGE)`.

    Raises:
        RequestError: a package is unknown or ignored, colcon refuses the arguments, or nothing
            can be built in a folder with this name.
        NotFoundError: the workspace has no package, or the toolchain is missing.
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
        strict=strict,
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
    """Build; return whether colcon succeeded, and the diagnostics."""
    post(progress.listener, StepStarted(step=STEP, detail=str(job.workspace.root)))
    broken = tuple(found for package in job.selected for found in package.diagnostics)
    if job.names and has_errors(broken):
        return False, broken  # colcon would not find the package
    relocated = find_relocated(job.workspace, job.inventory.packages, job.colcon_arguments)
    if relocated:  # CMake would build in the other place
        job = replace(job, colcon_arguments=(NEW_CACHE, *job.colcon_arguments))
    finished, notes = _run(job, environment, progress)
    notes = (*relocated, *notes)
    unreported = tuple(_unreported(job, finished, progress))
    if finished.returncode == 0 and not finished.output:
        return True, (*broken, *notes, *unreported)
    from wsgen.building.explain import explain_failure, refuse_full_disk  # noqa: PLC0415  who succeeds saves 5 ms

    if finished.returncode == 0:
        refuse_full_disk(finished.output, job.workspace)  # colcon could not write its log
        return True, (*broken, *notes, *unreported)
    distro = environment.get("ROS_DISTRO", "")
    causes = explain_failure(job.workspace, job.inventory, progress, finished, distro=distro)
    # Where colcon mistakes the kind of a package, that is the cause of all that fails in it.
    mistaken = {found.element for found in unreported}
    causes = tuple(
        found
        for found in causes
        if found not in unreported and (found.element is None or found.element not in mistaken)
    )
    return False, (*broken, *causes, *unreported, *notes)


def _run(
    job: _Job, environment: Mapping[str, str], progress: Progress
) -> tuple[Finished, tuple[Diagnostic, ...]]:
    """Run colcon; also report how the request was changed."""
    toolchain = _find_toolchain(job, environment)
    variables = toolchain.environment(environment) if toolchain else dict(environment)
    block_extensions(
        variables,
        workspace=job.workspace,
        inventory=job.inventory,
        colcon_arguments=job.colcon_arguments,
    )
    prefixes = package_prefixes(toolchain, environment) if toolchain else ()
    siblings = {package.name for package in job.inventory.packages}
    missing = {}
    if toolchain and not any("BUILD_TESTING" in word for word in job.colcon_arguments):
        missing = missing_test_dependencies(
            job.inventory.packages, prefixes=prefixes, built_here=siblings
        )
    cmake_arguments: tuple[str, ...] = (WITHOUT_TESTS,) if missing else ()
    support = MessageSupport(variables={})
    is_without_ros = not isinstance(toolchain, SourcedRos)
    if is_without_ros and any(one.build_type == "ament_cmake" for one in job.inventory.packages):
        support = message_support(job.inventory.packages, environment, progress.listener)
        variables = {**OLD_PACKAGES, **SOURCED_VARIABLES, **variables, **without_ros_variables()}
        variables.update(support.variables)
        cmake_arguments += without_ros_arguments(variables, job.colcon_arguments)
        cmake_arguments += support.arguments
        configure_again((job.workspace.build / name for name in siblings), prefixes, siblings)

    def run(
        names: Sequence[str], further: Sequence[str] = (), known: Mapping[str, str] | None = None
    ) -> Finished:
        arguments = build_arguments(
            names,
            (*job.colcon_arguments, *further),
            cmake_arguments=cmake_arguments,
            blocked=blocked_extensions(environment),
        )
        return run_colcon(
            arguments,
            folder=job.workspace.root,
            environment={**variables, **(known or {})},
            on_event=progress,
        )

    finished = _run_to_the_end(job, run, progress) if is_without_ros else run(job.names)
    outcomes = {package.outcome for package in progress.results}
    if "interrupted" in outcomes and "failed" not in outcomes:
        raise KeyboardInterrupt  # the signal reached colcon alone
    if progress.results:  # otherwise the diagnostics or the error show it
        progress.colcon_output += finished.output.splitlines()
        for line in progress.colcon_output:
            post(progress.listener, OutputLine(step=STEP, text=line, is_error_stream=True))
    if is_without_ros:
        progress.results = [add_left_out(one, job.workspace.build) for one in progress.results]
    built = [package.name for package in progress.results if package.outcome == "built"]
    without_tests = {name: missing[name] for name in built if name in missing}
    folders = {package.name: package.path for package in job.inventory.packages}
    left_out = report_left_out(
        progress.results, folders=folders, strict=job.strict, no_messages=support.why_not
    )
    return finished, (*tests_left_out(without_tests), *left_out)


def _run_to_the_end(job: _Job, run: Callable[..., Finished], progress: Progress) -> Finished:
    """Run colcon until each package is built or has failed.

    colcon skips what depends on a failed package, but files are installed without it: those
    packages are built in a further run, in which colcon does not know the failed ones.
    """
    go_on = () if CONTINUE in job.colcon_arguments else (CONTINUE,)
    finished = run(job.names, go_on)
    while not selects_packages(job.colcon_arguments):
        skipped = [one.name for one in progress.results if one.outcome == "skipped"]
        failed = [one.name for one in progress.results if one.outcome == "failed"]
        if not (skipped and failed):
            break
        progress.results = [one for one in progress.results if one.outcome != "skipped"]
        selected = ("--packages-ignore", *failed, "--packages-select", *skipped)
        again = run((), (*go_on, *selected), without_ros_variables(failed))
        output = "\n".join(filter(None, (finished.output, again.output)))
        finished = Finished(returncode=finished.returncode, output=output)
    return finished


def _find_toolchain(job: _Job, environment: Mapping[str, str]) -> Toolchain | None:
    """Find it; None if it is missing and no package needs ament_cmake."""
    try:
        return find_toolchain(environment)
    except NotFoundError:
        if any(package.build_type == "ament_cmake" for package in job.selected):
            raise
        return None


def _deprecated_minimum(job: _Job, progress: Progress) -> Iterator[Diagnostic]:
    """Report once which packages name an old version; CMake prints nine lines for each."""
    places: list[tuple[str, Path, int]] = []
    for result in progress.results:
        if any("cmake_minimum_required" in line for line in result.error_output):
            from wsgen.building.failure import split_deprecations  # noqa: PLC0415  rare

            package = next((one for one in job.inventory.packages if one.name == result.name), None)
            for name, line in split_deprecations(result.error_output)[1]:
                places.append((result.name, (package.path if package else Path()) / name, line))
    if places:
        names = some_of([*dict.fromkeys(name for name, _, _ in places)])
        _, file, line = places[0]
        yield DEPRECATED_MINIMUM.at(
            file,
            line,
            message=f"CMake deprecates the version in cmake_minimum_required() of {names}.",
            hint=f"Write {DEPRECATED_MINIMUM.instead}: the oldest version up to the newest tested.",
        )


def _unreported(job: _Job, finished: Finished, progress: Progress) -> Iterator[Diagnostic]:
    """Report mistakes that colcon does not report, or not for the package."""
    unknown = tuple(unknown_build_types(job.inventory.packages, finished.output))
    yield from unknown
    yield from missing_build_types(job.selected)
    results = {result.name for result in progress.results}
    for package in job.selected:  # colcon takes those for plain CMake or Python, without a word
        if not package.diagnostics and package.name in results:
            yield from refusals_of(package.path / "package.xml", package.manifest)
    if finished.returncode != 0:
        return
    if not (job.names or selects_packages(job.colcon_arguments)):
        for package in job.selected:
            if not package.diagnostics and package.name not in results:
                yield from check_package_xml(package.path / "package.xml")
    explained = {found.element for found in unknown}
    yield from skipped_packages(job.selected, wanted={*job.names} - explained, built=results)
    built = [package for package in job.inventory.packages if package.name in results]
    yield from check_installed(built, job.workspace)
    if any(package.build_type == "ament_python" for package in built):
        from wsgen.building.installed import check_python_packages  # noqa: PLC0415  as above

        error_output = {result.name: result.error_output for result in progress.results}
        yield from check_python_packages(built, job.workspace, error_output)
