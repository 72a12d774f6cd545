"""What the readers of a description find wrong on their way, in one list.

One cause is one diagnostic: that something is missing because its name is misspelt is told of the
misspelt name, and what a parser loses after an error is told with the error.
"""

from __future__ import annotations

from dataclasses import replace
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
        self.errors: list[int] = []  # where these stand in the list, as they were reported
        self._misspelt: dict[tuple[Element, str], int] = {}  # element, name that is meant

    def error(
        self, code: str, message: str, *, hint: str, at: Element | int | None, path: str = ""
    ) -> None:
        """Gazebo, its parser or every engine refuses this, or makes another robot of it."""
        self.errors.append(len(self.diagnostics))
        self._add(code, Severity.ERROR, message, hint, at, path)

    def warning(
        self, code: str, message: str, *, hint: str, at: Element | int | None, path: str = ""
    ) -> None:
        """It works, and surely is not what was meant."""
        self._add(code, Severity.WARNING, message, hint, at, path)

    def misspelt(  # noqa: PLR0913  as the others, and what is meant where
        self,
        code: str,
        message: str,
        *,
        hint: str,
        at: Element,
        path: str,
        owner: Element,
        name: str,
    ) -> None:
        """A warning about what must be the child or attribute `name` of the owner."""
        place = len(self.diagnostics)
        self._misspelt.setdefault((owner, name), place)
        if at is not owner:
            self._misspelt.setdefault((owner, f"{name} {at.get('name')}"), place)
        self.warning(code, message, hint=hint, at=at, path=path)

    def missing(  # noqa: PLR0913  as the others, and what is missing
        self, code: str, message: str, *, hint: str, at: Element, path: str, name: str
    ) -> None:
        """An error: the element has no child or attribute of that name.

        Where one is misspelt, that has been reported, and becomes the error.
        """
        if not self.blame_misspelt(at, name, message):
            self.error(code, message, hint=hint, at=at, path=path)

    def blame_misspelt(self, owner: Element, name: str, message: str) -> bool:
        """Make what is misspelt the error that its absence causes; False where nothing is.

        `name` is that of an attribute or child of the owner, or of a child with the child's own
        name after a blank.
        """
        place = self._misspelt.get((owner, name))
        if place is None:
            return False
        self.errors.append(place)
        cause = self.diagnostics[place]
        told = f"{cause.message.partition(': ')[0]}: {message[0].lower()}{message[1:]}"
        self.diagnostics[place] = replace(cause, severity=Severity.ERROR, message=told)
        return True

    def has_misspelt(self, owner: Element, *names: str) -> bool:
        """Whether a child or attribute of one of these names is misspelt."""
        return any((owner, name) in self._misspelt for name in names)

    def add_consequence(self, error: int, sentence: str) -> None:
        """Tell with an error, given by its place in `errors`, what follows from it."""
        place = self.errors[error]
        cause = self.diagnostics[place]
        self.diagnostics[place] = replace(cause, message=f"{cause.message} {sentence}")

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
