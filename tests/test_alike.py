"""Diagnostics that differ only in what they name."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.model.outcome import summed_up

RULE = Rule(
    code="ROB999",
    name="rule",
    severity=Severity.WARNING,
    severity_varies="yes",
    summary="",
    why="",
    example="",
    instead="",
)


def of_link(name: str, line: int, *, problem: str = "is cut short", hint: str = "") -> Diagnostic:
    return RULE.at(
        Path("r.urdf"),
        line,
        f"link[@name='{name}']",
        message=f"The mesh `{name}.stl` {problem} (/meshes/{name}.stl).",
        hint=hint or f"Export `{name}.stl` again.",
    )


def test_many_are_one_that_names_the_others() -> None:
    other = of_link("a", 1, problem="is empty")
    (first, second) = summed_up([*(of_link(name, ord(name)) for name in "abcdef"), other])
    assert first.message == (
        "The mesh `a.stl` is cut short (/meshes/a.stl). The same holds for `b.stl` (line 98), "
        "`c.stl` (line 99), `d.stl` (line 100) and 2 more."
    )
    assert (first.line, first.element) == (97, "link[@name='a']")
    assert second == other


def test_two_of_one_line_are_one() -> None:
    """A macro of xacro that is called twice."""
    (only,) = summed_up([of_link("left", 7), of_link("right", 7)])
    assert only.message.endswith("The same holds for `right.stl`.")


@pytest.mark.parametrize(
    "found",
    [
        [of_link("a", 1), of_link("b", 2)],
        [
            of_link(name, 1, hint=f"Write {inertia}.")
            for name, inertia in zip("abc", "123", strict=True)
        ],
        [
            RULE.at(None, message="It fails.", severity=severity)
            for severity in (Severity.ERROR, Severity.WARNING, Severity.INFO)
        ],
    ],
)
def test_two_and_those_that_need_something_else_stay(found: list[Diagnostic]) -> None:
    assert summed_up(found) == tuple(found)


def test_the_same_words_are_said_once() -> None:
    assert summed_up([of_link("a", 1)] * 5) == (of_link("a", 1),)


@pytest.mark.parametrize(
    ("elements", "lines", "reported"),
    [
        (["m", "n", "o"], [None] * 3, "`n`, `o`"),
        (["/w[@name='w']/m[@name='m']", "/w[@name='w']/m[@name='n']/l"] * 2, [None] * 4, "`n`"),
        (["m"] * 3, [1, 2, 3], "line 2, line 3"),
    ],
)
def test_what_tells_them_apart(elements: list[str], lines: list[int | None], reported: str) -> None:
    found = [
        RULE.at(None, line, element, message=f"It sinks by {number} m.")
        for number, (element, line) in enumerate(zip(elements, lines, strict=True))
    ]
    (one,) = summed_up(found)
    assert one.message == f"It sinks by 0 m. The same holds for {reported}."
