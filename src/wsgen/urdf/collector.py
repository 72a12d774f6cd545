"""The diagnostics about one description, in the order in which its readers report them.

One cause is one diagnostic: where a part is missing because its name is misspelled, the diagnostic
about the misspelling becomes the error; what a parser loses after an error is added to the error.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

from wsgen.diagnostics import Severity, has_errors

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic, Rule
    from wsgen.xmltree import Element


def line_of(element: Element) -> int | None:
    """The line of an element in its file, 1-based."""
    return cast("int | None", element.sourceline)


class Collector:
    """A growing list of diagnostics about one file; `at` is the element meant, or its line."""

    def __init__(self, file: Path | None) -> None:
        self.file = file
        self.diagnostics: list[Diagnostic] = []
        self.errors: list[int] = []  # where these stand in the list, as they were reported
        self._misspelled: dict[tuple[Element, str], int] = {}  # element, name that is meant

    def report(  # noqa: PLR0913  the fields of a diagnostic
        self,
        rule: Rule,
        message: str,
        *,
        hint: str,
        at: Element | int | None,
        path: str = "",
        severity: Severity | None = None,
    ) -> None:
        """Add a diagnostic; the severity is the rule's unless it is given.

        An error is what Gazebo, its parser or every engine refuses, or makes another robot of; a
        warning is what works, and surely is not what was meant.
        """
        line = at if at is None or isinstance(at, int) else line_of(at)
        diagnostic = rule.at(
            self.file, line, path or None, message=message, hint=hint, severity=severity
        )
        if diagnostic.severity is Severity.ERROR:
            self.errors.append(len(self.diagnostics))
        self.diagnostics.append(diagnostic)

    def report_misspelled(  # noqa: PLR0913  as `report`, and what is meant where
        self,
        rule: Rule,
        message: str,
        *,
        hint: str,
        at: Element,
        path: str,
        owner: Element,
        name: str,
    ) -> None:
        """Report what must be the child or attribute `name` of the owner."""
        place = len(self.diagnostics)
        self._misspelled.setdefault((owner, name), place)
        if at is not owner:
            self._misspelled.setdefault((owner, f"{name} {at.get('name')}"), place)
        self.report(rule, message, hint=hint, at=at, path=path)

    def report_missing(  # noqa: PLR0913  as `report`, and what is missing
        self, rule: Rule, message: str, *, hint: str, at: Element, path: str, name: str
    ) -> None:
        """Report that the element has no child or attribute of that name.

        Where a misspelled one has been reported, that diagnostic becomes the error instead.
        """
        if not self.blame_misspelled(at, name, message):
            self.report(rule, message, hint=hint, at=at, path=path)

    def blame_misspelled(self, owner: Element, name: str, message: str) -> bool:
        """Make the diagnostic about a misspelling the error that it causes; False: there is none.

        `name` is that of an attribute or child of the owner, or of a child with the child's own
        name after a blank.
        """
        place = self._misspelled.get((owner, name))
        if place is None:
            return False
        self.errors.append(place)
        cause = self.diagnostics[place]
        message = f"{cause.message.partition(': ')[0]}: {message[0].lower()}{message[1:]}"
        self.diagnostics[place] = replace(cause, severity=Severity.ERROR, message=message)
        return True

    def has_misspelled(self, owner: Element, *names: str) -> bool:
        """Whether a child or attribute of one of these names is misspelled."""
        return any((owner, name) in self._misspelled for name in names)

    def add_consequence(self, error: int, sentence: str) -> None:
        """Add to an error, given by its place in `errors`, what follows from it."""
        place = self.errors[error]
        cause = self.diagnostics[place]
        self.diagnostics[place] = replace(cause, message=f"{cause.message} {sentence}")

    @property
    def has_errors(self) -> bool:
        """Whether any of them is an error."""
        return has_errors(self.diagnostics)
