"""Read a robot description that somebody named."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from pathlib import Path


def read_bytes(file: Path) -> tuple[bytes | None, tuple[Diagnostic, ...]]:
    """The bytes of a file; None where it cannot be read."""
    try:
        return file.read_bytes(), ()
    except OSError as error:
        return None, (
            Diagnostic(
                code="ROB072",
                severity=Severity.ERROR,
                message=f"The robot description cannot be read: {error.strerror}.",
                file=file,
                hint="Name a file that you may read.",
            ),
        )
