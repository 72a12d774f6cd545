"""The stages of `wsgen validate`: overlay, launch plan, robot and world, simulation, checks.

`play` runs them for one launch file, as `wsgen launch --play` does.
"""

from __future__ import annotations

import os
from contextlib import ExitStack, suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.building.last_build import FAILED_BUILD, failed_builds
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.events import OneAtATime
from wsgen.isolation import parent
from wsgen.launching.launch_warnings import UNUSED_ARGUMENT, UNUSED_XACRO_ARGUMENT
from wsgen.model.outcome import Outcome, PackageOutcome, summed_up
from wsgen.packages.build_files.cmake_checks import MISSING_AMENT_PACKAGE
from wsgen.packages.workspace.layout import Workspace, find_packages, workspace_around
from wsgen.packages.workspace.overlay import Overlay, open_overlay, overlay_of
from wsgen.pipeline.changed_since_build import shares_of
from wsgen.pipeline.failed_builds import with_submodules
from wsgen.pipeline.gazebo_models import KnownWorlds
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.parallel import run_parallel
from wsgen.pipeline.requests import SelectedPackage
from wsgen.pipeline.selection import Selection, select_packages
from wsgen.rendering.drawing import require_encoder, why_no_video
from wsgen.simulation.run import check_engines, engine_left_out
from wsgen.text.files import irregular_kind

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.outcome import NotValidated
    from wsgen.model.plan import LaunchPlan
    from wsgen.pipeline.file_validation import FileValidation
    from wsgen.pipeline.requests import ValidateRequest


UNUSED_ARGUMENTS = (UNUSED_ARGUMENT.code, UNUSED_XACRO_ARGUMENT.code)


def validate(
    workspace: Workspace | None,
    request: ValidateRequest,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
    ended: list[PackageOutcome] | None = None,
) -> Outcome:
    """Validate packages of a workspace, and files; `request.jobs` of them at a time.

    Outcomes are added to `ended` one by one, so that a caller keeps them when it is interrupted (by
    KeyboardInterrupt, or by what a handler of signals raises).

    Files need no workspace, but that around each of them may have the packages that they name.

    Raises:
        RequestError: a package or launch file of that name does not exist, or an option is given
            that nothing named here takes.
        NotFoundError: the workspace has no package, a file does not exist, or an engine is not
            installed.
        NotReadableError: a FILE is no regular file, or the folder for the pictures cannot be made.
    """
    check_request(request)
    serial = OneAtATime(listener)
    with ExitStack() as stack:
        overlay = overlay_of(environment)
        selection = Selection()
        if workspace is not None and (request.packages or not request.files):
            overlay = stack.enter_context(open_overlay([workspace], environment))
            selection = select_packages(workspace, overlay, request, listener)
        packages, not_validated = selection
        overlays = overlays_of_files(request.files, workspace, environment, stack)
        is_alone = len(packages) + len(request.files) == 1
        each = request if is_alone else replace(request, jobs=1)  # engines one after the other
        each = each.shared_by(len(packages) + len(request.files))
        started = [package.started for package in packages]
        worlds = KnownWorlds(stack.enter_context(parent.make_scratch()), started)

        def subjects(run: Run) -> list[Validation | FileValidation]:
            return [
                *(
                    Validation(package, overlay, each, serial, run, worlds=worlds)
                    for package in packages
                ),
                *_files(each, [package.label for package in packages], overlays, serial, run),
            ]

        ended = [] if ended is None else ended
        if is_alone:  # a server would serve one child
            (subject,) = subjects(parent.run)
            ended.append(subject.run())
        elif packages or request.files:
            run_parallel(
                lambda run: [one.run for one in subjects(run)], request.jobs, serial, ended
            )
        outcomes = _without_used_elsewhere(ended, request)
        outcomes, not_validated = _with_failed_builds(
            outcomes, not_validated, overlay, request.packages
        )
        outcomes = tuple(
            replace(
                outcome,
                diagnostics=with_submodules(
                    summed_up(outcome.diagnostics), (one.path for one in overlay.written)
                ),
            )
            for outcome in _with_general(outcomes, overlay, request)
        )
        return Outcome(packages=outcomes, not_validated=not_validated)


def _with_failed_builds(
    outcomes: tuple[PackageOutcome, ...],
    not_validated: tuple[NotValidated, ...],
    overlay: Overlay,
    named: Collection[str] = (),
) -> tuple[tuple[PackageOutcome, ...], tuple[NotValidated, ...]]:
    """Report the failed builds of packages; most workspaces have none, and load nothing for it."""
    failed = failed_builds(overlay.workspaces, overlay.written)
    if not failed:
        return outcomes, not_validated
    from wsgen.pipeline.failed_builds import with_failed_builds  # noqa: PLC0415  see above

    return with_failed_builds(outcomes, not_validated, failed, overlay, named)


def _with_general(
    outcomes: tuple[PackageOutcome, ...], overlay: Overlay, request: ValidateRequest
) -> tuple[PackageOutcome, ...]:
    """Say once, with the first outcome, what holds for all.

    It is which packages are used without having been built, and which engine is not compared.
    """
    if not outcomes:
        return ()
    first, *others = outcomes
    found = [one for outcome in outcomes for one in outcome.diagnostics]
    not_built: tuple[Diagnostic, ...] = ()
    if not any(one.code == FAILED_BUILD.code for one in found):  # from which it follows
        not_built = overlay.not_built(
            {one.element for one in found if one.code == MISSING_AMENT_PACKAGE.code and one.element}
        )
    general = (*not_built, *engine_left_out(request.engines))
    return (replace(first, diagnostics=(*first.diagnostics, *general)), *others)


def _without_used_elsewhere(
    outcomes: Sequence[PackageOutcome], request: ValidateRequest
) -> tuple[PackageOutcome, ...]:
    """Report a launch argument as unused only if no package or file uses it."""
    if not request.launch_arguments:
        return tuple(outcomes)
    unused = [
        {found.element for found in outcome.diagnostics if _is_unused_argument(found)}
        for outcome in outcomes
        if outcome.file is None or _is_xacro(outcome.file)
    ]
    by_nobody = set(request.launch_arguments).intersection(*unused)
    return tuple(
        replace(
            outcome,
            diagnostics=tuple(
                found
                for found in outcome.diagnostics
                if not _is_unused_argument(found) or found.element in by_nobody
            ),
        )
        for outcome in outcomes
    )


def _is_unused_argument(found: Diagnostic) -> bool:
    """Whether it is about an argument of the request; those that a file gives have a line."""
    return found.code in UNUSED_ARGUMENTS and found.line is None


def _files(
    request: ValidateRequest,
    packages: Sequence[str],
    overlays: Sequence[Overlay],
    listener: Listener | None,
    run: Run,
) -> list[FileValidation]:
    if not request.files:
        return []
    # A package needs nothing of what reads files.
    from wsgen.pipeline.file_validation import FileValidation  # noqa: PLC0415

    names = unique_names(request.files, packages)
    return [
        FileValidation(file, overlay, request, listener, run, name=name)
        for file, name, overlay in zip(request.files, names, overlays, strict=True)
    ]


def check_request(request: ValidateRequest) -> None:
    """Check that all that the request needs is there, before anything is started.

    Raises:
        RequestError: an option is given that nothing named here takes.
        NotFoundError: a file does not exist, or an engine is not installed.
        NotReadableError: a FILE is no regular file, or the folder for the pictures cannot be made.
    """
    check_engines(request.engines)
    if request.gazebo == "required":
        from wsgen.pipeline.real_gazebo import require_gazebo  # noqa: PLC0415  it is seldom wanted

        require_gazebo(os.environ)
    if len(request.files) == 1 and not request.packages:
        _refuse_only_file(request.files[0])
    if request.files and not request.packages:
        _refuse_idle_options(request)
    if request.picture_folder is not None:
        _make_folder(request.picture_folder)


def _refuse_only_file(file: Path) -> None:
    """Stop where there is no other file to validate; one of several is reported as its result."""
    from wsgen.pipeline.file_validation import kind_of  # noqa: PLC0415  packages need nothing of it

    kind = irregular_kind(file)
    if kind is not None:
        raise NotReadableError(f"{file} is {kind}.", hint="Give a regular file.")
    if not file.is_file():
        raise NotFoundError(f"The file {file} does not exist.", hint="Check its path.")
    if kind_of(file) is None:
        raise RequestError(
            f"wsgen cannot simulate {file}: it is neither a URDF nor xacro nor SDF.",
            hint="Give a .urdf, .xacro, .sdf or .world file, or one with <robot> or <sdf>.",
        )


def _refuse_idle_options(request: ValidateRequest) -> None:
    """Refuse options that would have no effect."""
    if request.launch_file is not None:
        raise RequestError("`--launch` cannot be used with a robot file.", hint="Remove --launch.")
    if request.launch_arguments and not any(map(_is_xacro, request.files)):
        raise RequestError(
            "Only xacro files have arguments.", hint="Remove --arg, or give a xacro file."
        )


def _is_xacro(file: Path) -> bool:
    from wsgen.pipeline.file_validation import kind_of  # noqa: PLC0415  packages need nothing of it

    return kind_of(file) == "xacro"


def overlays_of_files(
    files: Sequence[Path],
    workspace: Workspace | None,
    environment: Mapping[str, str],
    stack: ExitStack,
) -> list[Overlay]:
    """For each file the overlay of the workspace and of the packages around the file."""
    folders = [file.resolve().parent for file in files]
    places = {
        folder: tuple(dict.fromkeys(filter(None, (workspace, workspace_around(folder)))))
        for folder in dict.fromkeys(folders)
    }
    overlays: dict[tuple[Workspace, ...], Overlay] = {}
    for folder, found in places.items():
        if found not in overlays:
            overlays[found] = overlay_of(environment)
            with suppress(NotFoundError, NotReadableError):  # it may need nothing of what is broken
                overlays[found] = stack.enter_context(open_overlay(found, environment, near=folder))
    return [overlays[places[folder]] for folder in folders]


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise NotReadableError(
            f"Cannot create the folder {folder} for pictures: {error.strerror}.",
            hint="Give a folder that you can write to.",
        ) from error


def play(  # noqa: PLR0913  what to play, where, how
    launch_file: Path,
    package: str | None,
    overlay: Overlay,
    request: ValidateRequest,
    *,
    workspace: Workspace | None = None,
    listener: Listener | None = None,
) -> Outcome:
    """Evaluate a launch file, spawn what it spawns, simulate and check it.

    `package` is the one that the file belongs to, if any; `workspace` may have its source. The
    packages, files and launch file of the request are ignored.

    Raises:
        RequestError: the video cannot be recorded.
        NotFoundError: an engine or the encoder of the video is not installed.
        NotReadableError: the folder for the pictures cannot be made.
    """
    check_request(request)
    if request.video is not None:
        require_encoder(request.video)
    problem = None if request.video is None else why_no_video(request.video)
    if problem is not None:
        raise RequestError(f"Cannot record a video: {problem}.", hint="Record a .gif instead.")
    selected = selected_package(launch_file, package, overlay, workspace)
    outcome = Validation(selected, overlay, request.shared_by(1), listener).run()
    own = replace(outcome, package=package)
    outcomes, _ = _with_failed_builds((own,), (), overlay)
    return Outcome(packages=_with_general(outcomes, overlay, request))


def with_failures_before(
    found: Iterable[Diagnostic], plan: LaunchPlan, package: str | None, overlay: Overlay
) -> tuple[Diagnostic, ...]:
    """What is reported of a launch file, and that builds failed of what it starts from.

    Args:
        found: What is reported.
        plan: Of the launch file.
        package: That it belongs to, if any.
        overlay: Where packages are.
    """
    own = PackageOutcome(
        package=package,
        share=None,
        launch_file=plan.launch_file,
        diagnostics=tuple(found),
        plan=plan,
    )
    (outcome,), _ = _with_failed_builds((own,), (), overlay)
    if any(one.code == FAILED_BUILD.code for one in outcome.diagnostics):
        return outcome.diagnostics
    return (*outcome.diagnostics, *overlay.not_built())


def selected_package(
    launch_file: Path, package: str | None, overlay: Overlay, workspace: Workspace | None
) -> SelectedPackage:
    """The package of a launch file, or what stands for one where it belongs to none."""
    written = [] if workspace is None else find_packages(workspace)
    return SelectedPackage(
        name=package or launch_file.stem,
        source=next((found.path for found in written if found.name == package), None),
        share=overlay.share(package) if package else None,
        launch_file=launch_file,
        workspace=shares_of(written, overlay),
    )


def unique_names(files: Sequence[Path], taken: Iterable[str]) -> list[str]:
    """A name for each file that no other one has, nor any in `taken`.

    It is the file's own without its ending, with as many of the folders around it as it takes: many
    robots are called model.urdf.
    """
    ways = [list(file.absolute().with_suffix("").parts[1:]) for file in files]
    used = set(taken)
    names = []
    for file, way in zip(files, ways, strict=True):
        others = [other for other in ways if other is not way]
        length = next(
            (
                length
                for length in range(1, len(way) + 1)
                if all(other[-length:] != way[-length:] for other in others)
            ),
            1,
        )
        name = wanted = "-".join(way[-length:])
        number = 2
        if name in used:
            name = wanted = f"{wanted}-{file.suffix[1:]}"
        while name in used:
            name, number = f"{wanted}-{number}", number + 1
        used.add(name)
        names.append(name)
    return names
