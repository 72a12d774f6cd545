"""What is allowed on purpose is not reported; what allows nothing is."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.catalogue import UNKNOWN_RULE_ALLOWED, all_rules, find_rule
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.text.files import real_path
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.packages.workspace.settings import Allowance


ALLOWED_WITHOUT_REASON = Rule(
    code="PKG100",
    name="allowed-without-reason",
    severity=Severity.WARNING,
    summary="A rule is allowed without a reason.",
    what="Looks at `[check.allow]` of `wsgen.toml` and at comments `wsgen: allow RULE: REASON`. "
    "Without a reason the diagnostic is still reported.",
    why="Readers of the file cannot distinguish intended exceptions from silenced errors.",
    example="<!-- wsgen: allow no-visual -->",
    instead="<!-- wsgen: allow no-visual: the gripper is drawn by its driver -->",
)
UNUSED_ALLOWANCE = Rule(
    code="PKG101",
    name="unused-allowance",
    severity=Severity.WARNING,
    summary="A rule is allowed where it reports nothing.",
    what="Looks at `[check.allow]` of `wsgen.toml` and at comments `wsgen: allow RULE: REASON`. "
    "Rules about simulations and builds are left out: `wsgen check` does neither.",
    why="It would hide the next error of this kind, and its reason is out of date.",
    example='[check.allow]\nno-visual = "the base is drawn by its driver"  # it has a <visual>',
    instead="[check.allow]",
)

# What `wsgen check` does not look for: simulations, and the run of a build.
ELSEWHERE = ("SPN", "TPL", "RUN")
# What depends on the machine: elsewhere the allowance may be needed.
OF_MACHINE = frozenset(
    (
        *("launch-import", "not-installed-here", "package-not-found", "source-used"),
        *("variable-not-set", "world-not-here", "models-of-gazebo"),
    )
)


class Suppressed(NamedTuple):
    """What is left of diagnostics, and what is wrong with what allows the others."""

    reported: tuple[Diagnostic, ...]
    allowed: tuple[Diagnostic, ...]


def suppress(
    diagnostics: Iterable[Diagnostic],
    allowances: Sequence[Allowance],
    *,
    read: Collection[Path] | None = None,
) -> Suppressed:
    """Leave out what is allowed, and report what is wrong with the allowances.

    Args:
        diagnostics: what is reported, with the places in the sources
        allowances: of `wsgen.toml` and of comments
        read: the files and folders that were checked; None: all of them, so that each allowance
            must have been used
    """
    used: set[Allowance] = set()
    reported, allowed = [], []
    by_rule = _by_rule(allowances)
    for found in diagnostics:
        those = [
            one
            for one in (*by_rule.get(found.name, ()), *by_rule.get(found.code, ()))
            if _covers(one, found)
        ]
        used.update(those)
        if any(one.reason for one in those):
            allowed.append(found)
        else:
            reported.append(found)
    places = None if read is None else [real_path(place) for place in read]
    for one in allowances:
        file = PurePath(real_path(one.file))
        is_read = places is None or any(file.is_relative_to(place) for place in places)
        reported += _check(one, is_used=one in used or not is_read)
    return Suppressed(tuple(reported), tuple(allowed))


def _by_rule(allowances: Iterable[Allowance]) -> dict[str, list[Allowance]]:
    found: dict[str, list[Allowance]] = {}
    for one in allowances:
        found.setdefault(one.rule, []).append(one)
    return found


def _covers(one: Allowance, found: Diagnostic) -> bool:
    """Whether an allowance is about the place of a diagnostic of its rule."""
    if found.file is None:
        return False
    # A package may be given by a link, and what includes a file says where it really is.
    file, place = PurePath(real_path(found.file)), PurePath(real_path(one.file))
    if one.lines is not None:
        first, last = one.lines
        return file == place and first <= (found.line or 0) <= last
    if not file.is_relative_to(place.parent):
        return False
    inside = file.relative_to(place.parent)
    return not one.patterns or any(inside.match(pattern) for pattern in one.patterns)


def _check(one: Allowance, *, is_used: bool) -> Iterator[Diagnostic]:
    """What is wrong with an allowance."""
    rule = find_rule(one.rule)
    if rule is None or one.rule not in {rule.name, rule.code}:
        near = nearest(one.rule, [rule.name for rule in all_rules()])
        yield UNKNOWN_RULE_ALLOWED.at(
            one.file,
            one.line,
            None if one.lines else "check.allow",
            message=f"The allowed rule {one.rule!r} does not exist.",
            hint=did_you_mean(near) if near else "Run `wsgen rule` to list the names.",
        )
    elif not one.reason:
        yield ALLOWED_WITHOUT_REASON.at(
            one.file,
            one.line,
            None if one.lines else "check.allow",
            message=f"`{one.rule}` is allowed without a reason, and is still reported.",
            hint=f"Write why: `wsgen: allow {one.rule}: REASON`."
            if one.lines
            else f'Write why: {one.rule} = "REASON".',
        )
    elif not is_used and not rule.code.startswith(ELSEWHERE) and rule.name not in OF_MACHINE:
        yield UNUSED_ALLOWANCE.at(
            one.file,
            one.line,
            None if one.lines else "check.allow",
            message=f"`{one.rule}` is allowed, but the rule reports nothing here.",
            hint="Remove the comment." if one.lines else "Remove the line.",
        )
