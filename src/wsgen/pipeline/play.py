"""Play one launch file, of whatever package or of none."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, RequestError
from wsgen.model.outcome import Outcome
from wsgen.pipeline import prepare
from wsgen.pipeline.selection import Chosen
from wsgen.pipeline.validation import Validation
from wsgen.simulation.recording import lacks_encoder, why_no_film
from wsgen.workspace.layout import find_packages

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.events import Listener
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.workspace.layout import Workspace
    from wsgen.workspace.overlay import Overlay


def play(  # noqa: PLR0913  what to play, where, how
    launch_file: Path,
    package: str | None,
    overlay: Overlay,
    request: ValidateRequest,
    *,
    workspace: Workspace | None = None,
    listener: Listener | None = None,
) -> Outcome:
    """Evaluate a launch file, spawn what it spawns, simulate and judge it.

    `package` is the one that the file belongs to, if any; `workspace` may have its source. Of the
    request everything counts that says how to try, and nothing that says what.

    Raises:
        RequestError: there can be no such film.
        NotFoundError: an engine or the encoder of the film is not installed.
        NotReadableError: the folder for the pictures cannot be made.
    """
    prepare(request)
    if request.film is not None and lacks_encoder(request.film):
        raise NotFoundError(
            "PyAV, which writes .mp4, is not installed.",
            hint="Install it: pip install 'wsgen[video]'; or name a .gif.",
        )
    problem = None if request.film is None else why_no_film(request.film)
    if problem is not None:
        raise RequestError(f"Cannot record a video: {problem}.", hint="Name a .gif, for example.")
    written = [] if workspace is None else find_packages(workspace)
    chosen = Chosen(
        name=package or launch_file.stem,
        source=next((found.path for found in written if found.name == package), None),
        share=overlay.share(package) if package else None,
        launch_file=launch_file,
    )
    outcome = Validation(chosen, overlay, request, listener).run()
    return Outcome(packages=(replace(outcome, package=package),))
