"""One diagnostic for one cause: those that differ only in what they name become one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.diagnostics import Diagnostic

MANY = 3  # so many are one
NAMED = 3  # of the others in the message
# What is quoted, addresses, paths.
NAMES = lazy_pattern(r"`[^`]*`|\b\w+://[^\s`']+|(?<!\w)'[^']*'(?!\w)|(?<=[\s(])/[^\s)]+")
NAMED_IN = lazy_pattern(r"@name='([^']*)'")
QUOTES = "`'"
NUMBERS = lazy_pattern(r"\d+(\.\d+)?(e[+-]?\d+)?")


class _Cause(NamedTuple):
    """What diagnostics of one cause have in common."""

    code: str
    severity: str
    file: str
    message: str
    hint: str


def summed_up(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The diagnostics, of several that differ only in names and numbers the first, with the names.

    They have one rule, severity and file, and the same hint except for what the message names.
    What is reported twice in the same words stays once.
    """
    different = dict.fromkeys(diagnostics)
    groups: dict[_Cause, list[Diagnostic]] = {}
    for found in different:
        groups.setdefault(_cause_of(found), []).append(found)
    reported: dict[Diagnostic, Diagnostic | None] = {}  # None: a part of another one
    for group in groups.values():
        if len(group) >= MANY:
            reported |= {**dict.fromkeys(group), group[0]: _with_names(group)}
    kept = (reported.get(found, found) for found in different)
    return tuple(found for found in kept if found is not None)


def _cause_of(found: Diagnostic) -> _Cause:
    hint = found.hint or ""
    for name in _names(found.message):
        hint = hint.replace(name.strip(QUOTES), "…")
    message = NUMBERS.sub("0", NAMES.sub("…", found.message))
    return _Cause(found.code, found.severity.value, str(found.file), message, hint)


def _names(message: str) -> list[str]:
    return [match.group() for match in NAMES.finditer(message)]


def _with_names(group: Sequence[Diagnostic]) -> Diagnostic:
    """The first, with what distinguishes the others from it."""
    labels: dict[str, str] = {}
    for name, found in zip(_distinguishing(group), group, strict=True):
        line = f"line {found.line}" if found.line else ""
        labels.setdefault(name or line, f"{name} ({line})" if name and line else name or line)
    others = list(labels.values())[1:]
    if not others:
        return group[0]
    more = f" and {len(others) - NAMED} more" if len(others) > NAMED else ""
    same = f"The same holds for {', '.join(others[:NAMED])}{more}."
    return replace(group[0], message=f"{group[0].message} {same}")


def _distinguishing(group: Sequence[Diagnostic]) -> Sequence[str]:
    """The first name in the message or the element that distinguishes them; or the element."""
    of_each = ((*_names(found.message), *NAMED_IN.findall(found.element or "")) for found in group)
    columns = zip(*of_each)  # noqa: B905  elements may be nested differently
    important = next((column for column in columns if len(set(column)) > 1), None)
    if important is not None:
        return [f"`{name.strip(QUOTES)}`" for name in important]
    is_element = len({found.element for found in group}) > 1
    return [f"`{found.element}`" if is_element else "" for found in group]
