"""What is wrong with the user's files, as values, and the rules that report it."""

from __future__ import annotations

from enum import Enum
from pathlib import Path  # noqa: TC003  a child's diagnostics are decoded by their type hints
from typing import TYPE_CHECKING, NamedTuple

from wsgen.text.printable import clean_line
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable


SHOWN = ("message", "element", "hint")
LONGEST = 4000  # characters of one of them


class Severity(str, Enum):
    """How bad it is: an error makes the exit code 1, the others do not."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


@dataclass(frozen=True, kw_only=True)
class Diagnostic:
    """One place in the user's files, or one thing that the robot does, that a rule is about."""

    code: str  # of the rule; stable and never reused
    name: str  # of the rule
    severity: Severity
    message: str
    file: Path | None = None
    line: int | None = None  # 1-based
    element: str | None = None  # XML path or name of the link, joint, argument meant
    hint: str | None = None  # what to do about it
    reason: str | None = None  # which of the rule's mistakes it is, for code that weighs it

    def __post_init__(self) -> None:
        """Keep what users' files hold from steering a terminal or a log, or from filling it."""
        for name in SHOWN:
            text = self.__dict__[name]
            if text is None or (text.isprintable() and len(text) <= LONGEST):
                continue
            if len(text) > LONGEST:
                text = f"{text[:LONGEST]}... ({len(text):,} characters)"
            self.__dict__[name] = clean_line(text)


class Measured(NamedTuple):
    """What simulators do with a robot or world with the mistake of a rule alone: predicates."""

    classic: str  # Gazebo Classic 11
    sim: str  # the parser of Gazebo Sim, sdformat 12


@dataclass(frozen=True, kw_only=True)
class Rule:
    """A kind of diagnostic; a constant of the module that checks it.

    `wsgen rule` and docs/rules.md show what it says of itself, as Markdown; `example` and `instead`
    are code of a user, or what a user does. `wsgen.checks.rules.catalogue` collects all rules.
    """

    code: str  # a family (PKG, BLD, ROB, WLD, LCH, SPN, TPL) and a number
    name: str  # reads after "allow"
    severity: Severity
    severity_varies: str = ""  # when it is another one: "an error in Gazebo Sim, which refuses it"
    measured: Measured | None = None  # None: it was not asked of them
    summary: str  # one sentence
    what: str = ""  # what is checked, where the summary does not say all
    why: str  # why it is bad
    example: str
    instead: str

    def at(  # noqa: PLR0913  the fields of a diagnostic
        self,
        file: Path | None,
        line: int | None = None,
        element: str | None = None,
        *,
        message: str,
        hint: str | None = None,
        severity: Severity | None = None,
        reason: str | None = None,
    ) -> Diagnostic:
        """Report it at a place.

        Raises:
            ValueError: The severity is not the rule's, and the rule does not say that it varies.
        """
        if severity not in {None, self.severity} and not self.severity_varies:
            raise ValueError(f"{self.code} is always reported as {self.severity.value}.")
        return Diagnostic(
            code=self.code,
            name=self.name,
            severity=severity or self.severity,
            message=message,
            file=file,
            line=line,
            element=element,
            hint=hint,
            reason=reason,
        )


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether any of them is an error."""
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)


def worst_of_each(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """The diagnostics without those that say the same at the same place, and are no worse."""
    order = list(Severity)
    worst: dict[tuple[object, ...], Diagnostic] = {}
    for found in diagnostics:
        key = (found.code, found.file, found.line, found.element, found.message)
        if key not in worst or order.index(found.severity) < order.index(worst[key].severity):
            worst[key] = found
    return list(worst.values())
