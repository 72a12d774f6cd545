"""An exception from within a template -> where it is wrong, and what to do about it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.templating.environment import syntax_place, words_for
from wsgen.templating.sources import ENDING, SourceError, find_source

if TYPE_CHECKING:
    from types import TracebackType


def explain(error: Exception, *, path: str, source: str, folder: Path) -> Diagnostic:
    """What went wrong while the file at `path` in the package was rendered from `source`."""
    file, line = _find_place(error)
    if file is None:
        try:
            file = find_source(source, folder)
        except SourceError:  # it is what is missing
            file = folder
    message, hint = words_for(error)
    return Diagnostic(
        code="TPL004",
        severity=Severity.ERROR,
        message=message,
        file=file,
        line=line,
        element=path,
        hint=hint,
    )


def _find_place(error: Exception) -> tuple[Path | None, int | None]:
    """File and line of the innermost template that the exception passed through."""
    place: tuple[Path | None, int | None] = syntax_place(error)
    step: TracebackType | None = error.__traceback__
    while step is not None:
        name = step.tb_frame.f_code.co_filename
        # Jinja2 puts the lines of the sources in the place of those of its own code.
        if name.endswith(ENDING):
            place = (Path(name), step.tb_lineno)
        step = step.tb_next
    return place
