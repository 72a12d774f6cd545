"""Numbers of a URDF: finite, in the C locale, and as many as there should be."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

# Python's float() takes more than C's strtod in the C locale: `1_000`, digits of other scripts.
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
LEFT_OVER = re.compile(r"\$\{|\$\(")  # of xacro
NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)


def parse_number(text: str) -> float | str:
    """The number, or what is wrong with it."""
    if NUMBER.fullmatch(text):
        number = float(text)
        return number if math.isfinite(number) else "is too large"
    if NOT_FINITE.fullmatch(text):
        return "is not finite"
    if "," in text:
        return "has a comma"
    return "is not a number"


def read_numbers(  # noqa: PLR0913  what, where, and how it is called
    findings: Findings, element: Element, attribute: str, count: int, path: str, *, required: bool
) -> tuple[float, ...] | None:
    """The numbers of an attribute; None where it is missing or wrong, which is then reported."""
    text = element.get(attribute)
    if text is None:
        if required:
            findings.error(
                "ROB016",
                f"`{attribute}` is missing.",
                hint=f'Write {attribute}="{" ".join(["0.1"] * count)}" in it.',
                at=element,
                path=path,
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
        problem = f"{len(words)} numbers instead of {count}"
    if problem is None:
        return tuple(number for number in numbers if isinstance(number, float))
    findings.error(
        "ROB016",
        f'{attribute}="{text[:60]}": {problem}.',
        hint=f"{_times(count)}, a point before the decimals and blanks between them. "
        "Gazebo refuses anything else; other programs silently read 0.",
        at=element,
        path=path,
    )
    return None


def read_number(
    findings: Findings, element: Element, attribute: str, path: str, *, required: bool
) -> float | None:
    """The number of an attribute; None where it is missing or wrong, which is then reported."""
    numbers = read_numbers(findings, element, attribute, 1, path, required=required)
    return None if numbers is None else numbers[0]


def read_triple(
    findings: Findings, element: Element, attribute: str, path: str
) -> tuple[float, float, float] | None:
    """The three numbers of an optional attribute; None where it is missing or wrong."""
    numbers = read_numbers(findings, element, attribute, 3, path, required=False)
    return None if numbers is None else (numbers[0], numbers[1], numbers[2])


def _times(count: int) -> str:
    return "One finite number" if count == 1 else f"{count} finite numbers"
