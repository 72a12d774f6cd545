"""Diagnostics as plain text, for reports of other programs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from wsgen.diagnostics import Diagnostic


def render_text(diagnostics: Iterable[Diagnostic]) -> str:
    """Each diagnostic with its place and what to do, as the command line shows it."""
    return "\n".join(line for one in diagnostics for line in _lines(one))


def _lines(diagnostic: Diagnostic) -> Iterator[str]:
    kind = f"{diagnostic.severity.value}[{diagnostic.code}]"
    yield f"{kind} {diagnostic.name}: {diagnostic.message}"
    place = "  ".join(filter(None, (_place(diagnostic), diagnostic.element)))
    if place:
        yield f"    at: {place}"
    if diagnostic.hint:
        yield f"   try: {diagnostic.hint}"


def _place(diagnostic: Diagnostic) -> str:
    if diagnostic.file is None:
        return ""
    file = os.fspath(diagnostic.file)
    return file if diagnostic.line is None else f"{file}:{diagnostic.line}"
