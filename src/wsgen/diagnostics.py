"""What is wrong with the user's files, as values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


class Severity(str, Enum):
    """How bad it is: an error makes the exit code 1, the others do not."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


@dataclass(frozen=True, kw_only=True)
class Diagnostic:
    """One finding.

    `code` is stable and never reused (families PKG, BLD, ROB, WLD, LCH, SPN, TPL; the list is in
    `wsgen.rules.catalogue`); `hint` is what to do about it.
    """

    code: str
    severity: Severity
    message: str
    file: Path | None = None
    line: int | None = None  # 1-based
    element: str | None = None  # XML path or name of the link, joint, argument meant
    hint: str | None = None


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether any of them is an error."""
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)
