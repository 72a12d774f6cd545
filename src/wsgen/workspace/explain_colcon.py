"""Why colcon itself gave up, from what it said."""

from __future__ import annotations

import errno
import os
import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.errors import NotReadableError, RequestError
from wsgen.files import explain_write_error
from wsgen.workspace.failure import last_words

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.workspace.layout import Workspace

DUPLICATE_NAME = "PKG007"
OTHER_INSTALL_LAYOUT = "BLD017"
OTHER_BUILD_TOOL = "BLD018"
UNBUILT_DEPENDENCY = "BLD019"
COLCON_FAILURE = "BLD020"


def recognize(output: str, workspace: Workspace) -> tuple[Diagnostic, ...]:
    """Say what is known about colcon's words; nothing if nothing is."""
    for cause in CAUSES:
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


CAUSES = (
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
