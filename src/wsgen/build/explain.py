"""Why a package failed to build, from what its programs wrote to standard error.

One function for each known cause, tried in order; it yields what it recognizes. The first that
recognizes something has the word, for one cause often makes several messages.

Why colcon itself gave up, from what it said.

Why a build failed: what colcon said of itself, or else what its packages said.
"""

from __future__ import annotations

import errno
import os
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.build import causes
from wsgen.build.failure import Failure, last_words
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.errors import NotReadableError, RequestError
from wsgen.files import explain_write_error, find_full_disk, full_folder

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.build.colcon import Finished, PackageResult, Progress
    from wsgen.workspace.layout import Inventory, Workspace


CMAKE_ERROR = "BLD015"
UNEXPLAINED_FAILURE = "BLD016"


def explain(failure: Failure) -> tuple[Diagnostic, ...]:
    """Say why the package failed, and what to do."""
    for cause in CAUSES:
        found = tuple(cause(failure))
        if found:
            return found
    return (_unexplained(failure),)


def _any_cmake_error(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        is_named = error.command and error.command not in {"message", error.message.split("(")[0]}
        what = f"{error.command}(): {error.message}" if is_named else error.message
        yield failure.diagnose(
            CMAKE_ERROR, f"CMake: {what}", error=error, hint=failure.where_to_look
        )


def _unexplained(failure: Failure) -> Diagnostic:
    words = last_words(failure.output)
    return failure.diagnose(
        UNEXPLAINED_FAILURE,
        f"the build failed{': ' if words else ' without a word.'}{words}",
        hint=failure.where_to_look,
    )


CAUSES = (
    causes.refused_manifest,
    *causes.MACHINE_CAUSES,
    *causes.CMAKE_CAUSES,
    *causes.PACKAGE_CAUSES,
    _any_cmake_error,
)


DUPLICATE_NAME = "PKG007"
OTHER_INSTALL_LAYOUT = "BLD017"
OTHER_BUILD_TOOL = "BLD018"
UNBUILT_DEPENDENCY = "BLD019"
COLCON_FAILURE = "BLD020"


def recognize(output: str, workspace: Workspace) -> tuple[Diagnostic, ...]:
    """Say what is known about colcon's words; nothing if nothing is."""
    for cause in COLCON_CAUSES:
        found = tuple(cause(output, workspace))
        if found:
            return found
    return ()


def explain_colcon(output: str, returncode: int, workspace: Workspace) -> tuple[Diagnostic, ...]:
    """Say why colcon failed without a package having failed and for no known cause.

    Raises:
        RequestError: it refused its arguments.
        NotReadableError: it cannot write where it has to.
    """
    _refuse_request(output)
    if returncode < 0:
        return (_ended_by_signal(-returncode, workspace),)
    _refuse_unwritable(output, workspace)
    words = last_words(output)
    return (
        _diagnose(
            COLCON_FAILURE,
            f"colcon failed{': ' if words else ' without a word.'}{words}",
            file=workspace.root,
            hint=f"Its log: {workspace.log / 'latest_build' / 'logger_all.log'}",
        ),
    )


def _ended_by_signal(number: int, workspace: Workspace) -> Diagnostic:
    return _diagnose(
        COLCON_FAILURE,
        f"colcon was ended by signal {number}.",
        file=workspace.root,
        hint="Something outside ended it; if it was signal 9, memory may have run out.",
    )


def _refuse_request(output: str) -> None:
    usage = re.search(r"^colcon(?: build)?: error: (.+)$", output, re.MULTILINE)
    if usage:
        raise RequestError(
            f"colcon does not take these arguments: {usage[1]}.",
            hint="What follows -- goes to colcon build; its options: colcon build --help",
        )
    unknown = re.search(
        r"^(?:Package '\S+' specified with|the --packages-).*$", output, re.MULTILINE
    )
    if unknown:
        raise RequestError(
            f"colcon: {unknown[0].rstrip('.')}.",
            hint="Names are those in package.xml; ignored packages (COLCON_IGNORE) do not count.",
        )


def _duplicate_names(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    _, found, listing = output.partition("Duplicate package names not supported:")
    if not found:
        return
    for name, folders in re.findall(r"^- (\S+):\n((?:  - .+\n?)+)", listing, re.MULTILINE):
        paths = [line.removeprefix("  - ").strip() for line in folders.splitlines()]
        yield _diagnose(
            DUPLICATE_NAME,
            f"{len(paths)} packages are called {name}: {', '.join(paths)}.",
            file=workspace.root / paths[-1] / "package.xml",
            element=name,
            hint="Rename one (package.xml and project()), or put an empty file COLCON_IGNORE into "
            "the folder of the one that is not to be built.",
        )


def _other_install_layout(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    match = re.search(r"was created with the layout '(\w+)'", output)
    if match:
        option = "Add --merge-install to" if match[1] == "merged" else "Take --merge-install from"
        yield _diagnose(
            OTHER_INSTALL_LAYOUT,
            f"The install space was made with the layout '{match[1]}', and this build wants the "
            "other one.",
            file=workspace.install,
            hint=f"{option} colcon's arguments, or remove {workspace.install}.",
        )


def _other_build_tool(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    match = re.search(r"The build directory '.+?' was created by '(.+?)'", output)
    if match:
        yield _diagnose(
            OTHER_BUILD_TOOL,
            f"The build folder was made by {match[1]}.",
            file=workspace.build,
            hint=f"Remove {workspace.build}, or build elsewhere: wsgen build -- --build-base DIR",
        )


def _unbuilt_dependency(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    match = re.search(r"following packages have been built:\n((?:\s*- \S+\n?)+)", output)
    if match:
        names = re.findall(r"- (\S+)", match[1])
        yield _diagnose(
            UNBUILT_DEPENDENCY,
            f"Not built yet, and needed by what is to be built: {', '.join(names)}.",
            file=workspace.root,
            hint=f"Build them first: wsgen build {' '.join(names)}",
        )


def _refuse_unwritable(output: str, workspace: Workspace) -> None:
    match = re.search(
        r"(?m)^\w*Error: \[Errno (\d+)\] .+?: '(.+?)'|The install base '(.+?)' is not a", output
    )
    if match:
        number = int(match[1]) if match[1] else errno.ENOTDIR
        file = workspace.root / (match[2] or match[3])
        cannot_write = explain_write_error(OSError(number, os.strerror(number)), file).message
        raise NotReadableError(
            f"colcon {cannot_write[0].lower()}{cannot_write[1:]}",
            hint="Check that build, install and log of the workspace are folders, and that you may "
            "write there.",
        )


COLCON_CAUSES = (
    _duplicate_names,
    _other_install_layout,
    _other_build_tool,
    _unbuilt_dependency,
)


def _diagnose(
    code: str, message: str, *, file: Path, hint: str, element: str | None = None
) -> Diagnostic:
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=message,
        file=file,
        element=element,
        hint=hint,
    )


def explain_failure(
    workspace: Workspace,
    inventory: Inventory,
    progress: Progress,
    finished: Finished,
    *,
    distro: str,
) -> tuple[Diagnostic, ...]:
    """Say what went wrong and where, for each package that failed.

    `distro` is that of the ROS that is sourced, or empty.

    Raises:
        RequestError: colcon refused its arguments.
        NotReadableError: colcon or a package cannot write where it has to.
    """
    failed = [result for result in progress.results if result.outcome == "failed"]
    refuse_full_disk(
        "\n".join([finished.output, *(line for one in failed for line in one.error_output)]),
        workspace,
    )
    _refuse(full_folder(*_written_folders(workspace)), workspace)  # too full to say so
    known = recognize(finished.output, workspace)
    if known:
        return known
    if failed:
        return tuple(_explain_packages(workspace, inventory, progress, failed, distro))
    return explain_colcon(finished.output, finished.returncode, workspace)


def refuse_full_disk(output: str, workspace: Workspace) -> None:
    """Stop where a program has printed that the disk is full, often once for each file.

    Raises:
        NotReadableError: it has.
    """
    _refuse(find_full_disk(output, *_written_folders(workspace)), workspace)


def _written_folders(workspace: Workspace) -> tuple[Path, ...]:
    return (workspace.root, Path(tempfile.gettempdir()))


def _refuse(error: OSError | None, workspace: Workspace) -> None:
    if error is not None:
        raise explain_write_error(
            error, Path(error.filename), what=f"the build of {workspace.root}"
        )


def _explain_packages(
    workspace: Workspace,
    inventory: Inventory,
    progress: Progress,
    failed: Sequence[PackageResult],
    distro: str,
) -> Iterator[Diagnostic]:
    readable = [package for package in inventory.packages if not package.diagnostics]
    folders = {package.name: package.path for package in readable}
    # colcon takes a package whose manifest cannot be read for one of plain CMake, and goes on;
    # the failure that follows has its cause in the manifest, which is in the result already.
    has_unreadable = len(readable) < len(inventory.packages)
    for result in failed:
        folder = folders.get(result.name)
        if folder is None and has_unreadable:
            continue
        yield from explain(
            Failure(
                package=result.name,
                folder=folder or _folder_of(inventory, result.name) or workspace.root,
                build_folder=workspace.build / result.name,
                output="\n".join(result.error_output),
                siblings=folders.keys(),
                distro=distro,
                log=progress.log_folder,
            )
        )


def _folder_of(inventory: Inventory, name: str) -> Path | None:
    """Find the folder of a package without package.xml, by the usual name."""
    return next((folder for folder in inventory.others if folder.name == name), None)
