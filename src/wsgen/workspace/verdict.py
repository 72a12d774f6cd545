"""Why a build failed: what colcon said of itself, or else what its packages said."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.files import explain_write_error, find_full_disk, full_folder
from wsgen.workspace.explain import explain
from wsgen.workspace.explain_colcon import explain_colcon, recognize
from wsgen.workspace.failure import Failure

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.workspace.colcon_process import Finished
    from wsgen.workspace.layout import Inventory, Workspace
    from wsgen.workspace.progress import PackageResult, Progress


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
