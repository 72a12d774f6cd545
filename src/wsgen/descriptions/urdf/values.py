"""Numbers of a URDF: finite, in the C locale, and as many as there should be.

The diagnostics about one description, in the order in which its readers report them.

One cause is one diagnostic: where a part is missing because its name is misspelled, the diagnostic
about the misspelling becomes the error; what a parser loses after an error is added to the error.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from wsgen.descriptions.rules import NOT_A_NUMBER
from wsgen.diagnostics import Severity, has_errors
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic, Rule
    from wsgen.text.xmltree import Element


# Python's float() takes more than C's strtod in the C locale: `1_000`, digits of other scripts.
NUMBER = lazy_pattern(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
LEFT_OVER = lazy_pattern(r"\$\{|\$\(")  # of xacro
# What C++'s std::stod and std::stoi take from the beginning of a text; what follows is ignored.
LEADING = lazy_pattern(
    r"\s*([+-]?)(?:(0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[+-]?\d+)?)"
    r"|((?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)|(inf(?:inity)?)|(nan(?:\(\w*\))?))",
    re.ASCII | re.IGNORECASE,
)
LEADING_INTEGER = lazy_pattern(r"\s*[+-]?\d+", re.ASCII)
SMALLEST = 2.2250738585072014e-308  # std::stod throws below it, as it does above the largest
INT_LOWEST, INT_HIGHEST = -(2**31), 2**31 - 1
NOT_FINITE = lazy_pattern(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)


def parse_number(text: str) -> float | str:
    """The number, or why it is none."""
    if NUMBER.fullmatch(text):
        number = float(text)
        return number if math.isfinite(number) else "is too large"
    if NOT_FINITE.fullmatch(text):
        return "is not finite"
    if "," in text:
        return "has a comma"
    return "is not a number"


def leading_float(text: str) -> float | None:
    """What std::stod makes of a text; None where it throws. May be infinite or not-a-number."""
    found = LEADING.match(text)
    if found is None:
        return None
    sign, hexadecimal, decimal, infinite, _ = found.groups()
    if hexadecimal or decimal:
        try:
            number = float.fromhex(hexadecimal) if hexadecimal else float(decimal)
        except OverflowError:
            return None
        # It also throws on a number that rounds to zero, unless all its digits are zeros.
        mantissa = re.split("[eE]", decimal)[0] if decimal else re.split("[pP]", hexadecimal)[0]
        is_zero = not re.search(r"[1-9a-fA-F]", mantissa)
        if not (is_zero or SMALLEST <= number < math.inf):
            return None
    else:
        number = math.inf if infinite else math.nan
    return -number if sign == "-" else number


def leading_integer(text: str) -> int | None:
    """What std::stoi makes of a text; None where it throws."""
    found = LEADING_INTEGER.match(text)
    if found is None or not INT_LOWEST <= float(found[0]) <= INT_HIGHEST:
        return None
    return int(float(found[0]))


def read_numbers(  # noqa: PLR0913  what, where, and how it is called
    collector: Collector,
    element: Element,
    attribute: str,
    count: int,
    path: str,
    *,
    required: bool,
    is_fatal: bool = True,
) -> tuple[float, ...] | None:
    """The numbers of an attribute; None where it is missing or invalid, which is then reported.

    `is_fatal`: Gazebo refuses the robot for them, or leaves something out; it is an error then.
    """
    text = element.get(attribute)
    if text is None:
        hint = f'Write {attribute}="{" ".join(["0.1"] * count)}" in it.'
        message = f"`{attribute}` is missing."
        if required and is_fatal:
            collector.report_missing(
                NOT_A_NUMBER, message, hint=hint, at=element, path=path, name=attribute
            )
        elif required:
            collector.report(
                NOT_A_NUMBER, message, hint=hint, at=element, path=path, severity=Severity.WARNING
            )
        return None
    if LEFT_OVER.search(text):  # reported once, for every element
        return None
    words = text.split()
    numbers = [parse_number(word) for word in words]
    problem = next(
        (
            f"`{word}` {found}"
            for word, found in zip(words, numbers, strict=True)
            if found.__class__ is str
        ),
        None,
    )
    if problem is None and len(words) != count:
        problem = f"it has {len(words)} instead of {count} numbers"
    if problem is None and count == 1 and text[-1].isspace():
        problem = "the number is followed by a blank"
    if problem is None:
        return tuple(number for number in numbers if isinstance(number, float))
    meant = without_commas(text, count)
    what = _numbers(count) if meant is None else f'{attribute}="{meant}"'
    collector.report(
        NOT_A_NUMBER,
        f'{attribute}="{text[:60]}": {problem}.',
        hint=f"Write {what}. "
        f"Gazebo {'refuses' if is_fatal else 'ignores'} anything else; other programs silently "
        "read 0.",
        at=element,
        path=f"{path}/@{attribute}",
        severity=Severity.ERROR if is_fatal else Severity.WARNING,
    )
    return None


def read_number(
    collector: Collector, element: Element, attribute: str, path: str, *, required: bool
) -> float | None:
    """The number of an attribute; None where it is missing or invalid, which is then reported."""
    numbers = read_numbers(collector, element, attribute, 1, path, required=required)
    return None if numbers is None else numbers[0]


def read_triple(
    collector: Collector, element: Element, attribute: str, path: str
) -> tuple[float, float, float] | None:
    """The three numbers of an optional attribute; None where it is missing or invalid."""
    numbers = read_numbers(collector, element, attribute, 3, path, required=False)
    return None if numbers is None else (numbers[0], numbers[1], numbers[2])


def without_commas(text: str, count: int) -> str | None:
    """The numbers that a text with commas stands for: between numbers, or in them."""
    for other in (" ", "."):
        words = text.replace(",", other).split()
        if len(words) == count and not any(isinstance(parse_number(one), str) for one in words):
            return " ".join(words) if "," in text else None
    return None


def _numbers(count: int) -> str:
    if count == 1:
        return "one finite number, with a decimal point"
    return f"{count} finite numbers, with a decimal point, separated by blanks"


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
