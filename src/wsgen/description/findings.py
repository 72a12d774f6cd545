"""What the readers of a description find wrong on their way, in one list."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from wsgen.diagnostics import Diagnostic, Severity, has_errors

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.xmltree import Element


def line_of(element: Element) -> int | None:
    """The line of an element in its file, 1-based."""
    return cast("int | None", element.sourceline)


class Findings:
    """A growing list of diagnostics about one file; `at` is the element meant, or its line."""

    def __init__(self, file: Path | None) -> None:
        self.file = file
        self.diagnostics: list[Diagnostic] = []

    def error(
        self, code: str, message: str, *, hint: str, at: Element | int | None, path: str = ""
    ) -> None:
        """Gazebo, its parser or every engine refuses this, or makes another robot of it."""
        self._add(code, Severity.ERROR, message, hint, at, path)

    def warning(
        self, code: str, message: str, *, hint: str, at: Element | int | None, path: str = ""
    ) -> None:
        """It works, and surely is not what was meant."""
        self._add(code, Severity.WARNING, message, hint, at, path)

    @property
    def has_errors(self) -> bool:
        """Whether any of them is an error."""
        return has_errors(self.diagnostics)

    def _add(  # noqa: PLR0913, PLR0917  the fields of a diagnostic, once
        self,
        code: str,
        severity: Severity,
        message: str,
        hint: str,
        at: Element | int | None,
        path: str,
    ) -> None:
        self.diagnostics.append(
            Diagnostic(
                code=code,
                severity=severity,
                message=message,
                file=self.file,
                line=at if at is None or isinstance(at, int) else line_of(at),
                element=path or None,
                hint=hint,
            )
        )
