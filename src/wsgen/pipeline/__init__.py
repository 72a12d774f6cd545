"""The stages of `wsgen validate`: overlay, launch plan, robot and world, trial, verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import NotReadableError
from wsgen.model.outcome import Outcome
from wsgen.pipeline.request import ValidateRequest
from wsgen.pipeline.selection import choose
from wsgen.pipeline.validation import Validation
from wsgen.workspace.overlay import source_overlay

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.events import Listener
    from wsgen.workspace.layout import Workspace

__all__ = ["ValidateRequest", "validate"]


def validate(
    workspace: Workspace,
    request: ValidateRequest,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> Outcome:
    """Validate the packages one after the other.

    Raises:
        RequestError: a package or launch file of that name does not exist.
        NotFoundError: the workspace is not built, or no package has a launch file.
        NotReadableError: the folder for the pictures cannot be made.
    """
    if request.picture_folder is not None:
        _make_folder(request.picture_folder)
    overlay = source_overlay(workspace, environment)
    packages, left_out = choose(workspace, overlay, request)
    return Outcome(
        packages=tuple(
            Validation(package, overlay, request, listener).run() for package in packages
        ),
        left_out=left_out,
    )


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise NotReadableError(
            f"The folder {folder} for pictures cannot be made: {error.strerror}.",
            hint="Name a folder that you may write to.",
        ) from error
