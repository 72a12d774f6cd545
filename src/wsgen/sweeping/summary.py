"""What a table shows at a glance: how many runs pass, what fails, and where the borders lie."""

from __future__ import annotations

import math
import re
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.checks.rules.catalogue import find_rule
from wsgen.diagnostics import Severity
from wsgen.sweeping.borders import Dependence, find_borders
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from wsgen.model.sweep import Column
    from wsgen.sweeping.borders import Border
    from wsgen.sweeping.table import Series, TableData


FEW_VALUES = 2  # of a parameter that is a number, of which shares are shown as of a text
MOST_SHARES = 8  # values of a parameter that are shown
MOST_CODES = 10  # that are shown
MOST_EXAMPLES = 3  # codes of which a message is shown
LONGEST_VALUE = 40  # characters of a text
LONGEST_EXAMPLE = 160  # characters
ASYMMETRIC = 1.6  # of the longer to the shorter part of an interval, which is then written whole
# What a meaning may begin with, as "m/s, of the root link".
_UNIT = re.compile(r"((?:rad|deg|kg|m|s|N|Nm|Hz|W|J)(?:[/*·]?(?:m|s|kg|rad)[²³]?)*)(?=,|;| or |$)")


@dataclass(frozen=True, kw_only=True)
class CodeCount:
    """A rule, and how many of the runs that fail report it."""

    code: str
    name: str  # of the rule; empty for one that this wsgen does not know
    runs: int
    first_run: int  # number
    example: str  # the first error of a run that reports nothing worse; empty: none


@dataclass(frozen=True, kw_only=True)
class ValueShare:
    """How many of the runs with a value of a parameter pass."""

    value: str
    runs: int
    passed: int


@dataclass(frozen=True, kw_only=True)
class RuleDependence:
    """How it depends on a parameter whether a rule reports an error."""

    code: str
    name: str
    dependence: Dependence  # a run passes where the rule reports nothing


@dataclass(frozen=True, kw_only=True)
class ParameterSummary:
    """What a parameter does to the result."""

    column: Column
    unit: str  # empty where it has none
    lowest: float | None  # of a number
    highest: float | None
    dependence: Dependence | None  # of a number
    shares: tuple[ValueShare, ...]  # of a text, a boolean or a number with two values
    # Of rules that have a clear border, where several fail, and not in the same runs.
    rules: tuple[RuleDependence, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Summary:
    """What a table shows."""

    runs: int  # of the whole sweep
    done: int
    passed: int
    codes: tuple[CodeCount, ...]  # the most frequent one first
    parameters: tuple[ParameterSummary, ...]


def summarize(data: TableData) -> Summary:
    """Summarize a table.

    A parameter with one value shows nothing, and is left out of what the borders depend on.
    """
    varying = [one for one in data.parameters if _varies(one)]
    codes = tuple(_codes(data))
    absent = _absent(data, codes)
    return Summary(
        runs=data.runs,
        done=data.count,
        passed=int(data.passed.sum()),
        codes=codes,
        parameters=tuple(
            _parameter(one, data.passed, absent, is_alone=len(varying) == 1) for one in varying
        ),
    )


def _absent(
    data: TableData, codes: Sequence[CodeCount]
) -> list[tuple[CodeCount, NDArray[np.bool_]]]:
    """The rules that fail runs, and the runs in which each reports nothing.

    Of rules that fail the same runs, the first one counts for all. None where all do.
    """
    kept: dict[bytes, tuple[CodeCount, NDArray[np.bool_]]] = {}
    for one in codes[:MOST_CODES]:
        sets = [index for index, found in enumerate(data.code_sets) if one.code in found]
        absent = ~np.isin(data.code_set, sets) | data.passed
        kept.setdefault(absent.tobytes(), (one, absent))
    return [*kept.values()] if len(kept) > 1 else []


def unit_of(column: Column) -> str:
    """Return the unit that the meaning of a column begins with; empty for none."""
    found = _UNIT.match(column.meaning)
    return found[1] if found else ""


def _varies(series: Series) -> bool:
    return len(np.unique(series.numbers[np.isfinite(series.numbers)])) > 1


def _parameter(
    series: Series,
    passed: NDArray[np.bool_],
    absent: Sequence[tuple[CodeCount, NDArray[np.bool_]]],
    *,
    is_alone: bool,
) -> ParameterSummary:
    column, numbers = series.column, series.numbers
    is_number = column.kind in {"number", "integer"}
    values = np.unique(numbers[np.isfinite(numbers)])
    dependence = find_borders(numbers, passed, is_alone=is_alone) if is_number else None
    has_shares = not is_number or (
        len(values) <= FEW_VALUES and dependence is not None and not dependence.is_certain
    )
    return ParameterSummary(
        column=column,
        unit=unit_of(column),
        lowest=float(values[0]) if is_number else None,
        highest=float(values[-1]) if is_number else None,
        dependence=None if has_shares else dependence,
        shares=tuple(_shares(series, values, passed)) if has_shares else (),
        rules=() if has_shares else tuple(_of_rules(numbers, absent, is_alone=is_alone)),
    )


def _of_rules(
    numbers: NDArray[np.float64],
    absent: Sequence[tuple[CodeCount, NDArray[np.bool_]]],
    *,
    is_alone: bool,
) -> Iterator[RuleDependence]:
    for one, runs in absent:
        dependence = find_borders(numbers, runs, is_alone=is_alone)
        if dependence.borders and (dependence.is_certain or dependence.is_clear):
            yield RuleDependence(code=one.code, name=one.name, dependence=dependence)


def _shares(
    series: Series,
    values: np.ndarray[Any, np.dtype[np.float64]],
    passed: np.ndarray[Any, np.dtype[np.bool_]],
) -> Iterator[ValueShare]:
    """Of each value, those of texts in their alphabetical order."""
    shown = {float(value): _value(series, float(value)) for value in values}
    order = sorted(shown, key=lambda value: shown[value] if series.texts else value)
    for value in order:
        chosen = series.numbers == value
        yield ValueShare(
            value=shown[value], runs=int(chosen.sum()), passed=int((chosen & passed).sum())
        )


def _value(series: Series, value: float) -> str:
    if series.texts:
        return series.texts[int(value)]
    if series.column.kind == "boolean":
        return "true" if value else "false"
    return f"{value:.6g}"


def _codes(data: TableData) -> Iterator[CodeCount]:
    """Of the runs that fail: errors, and of a run without any, all that it reports."""
    failing = np.bincount(data.code_set[~data.passed], minlength=len(data.code_sets))
    counts: Counter[str] = Counter()
    sets: dict[str, list[int]] = {}
    rules = {code: find_rule(code) for codes in data.code_sets for code in codes}
    for index, (codes, runs) in enumerate(zip(data.code_sets, failing.tolist(), strict=True)):
        errors = [
            code
            for code in codes
            if (rule := rules[code]) is None or rule.severity is Severity.ERROR
        ]
        for code in (errors or codes) if runs else ():
            counts[code] += runs
            sets.setdefault(code, []).append(index)
    for code, runs in sorted(counts.items(), key=lambda one: (-one[1], one[0])):
        rule = rules[code]
        chosen = np.isin(data.code_set, sets[code]) & ~data.passed
        examples = [data.diagnostics[index] for index in sets[code]]
        yield CodeCount(
            code=code,
            name=rule.name if rule else "",
            runs=runs,
            first_run=int(data.numbers[int(chosen.argmax())]),
            example=next((text for text in examples if code in text), ""),
        )


# ---- In words.


def render_summary(summary: Summary) -> Iterator[str]:
    """The lines that a person reads."""
    of = "" if summary.done == summary.runs else f" of {summary.runs:,}"
    runs = "run" if summary.done == 1 and not of else "runs"
    share = f" ({write_share(summary.passed, summary.done)})" if summary.done else ""
    yield f"{summary.done:,}{of} {runs}: {summary.passed:,} passed{share}"
    if summary.codes:
        yield ""
        yield "what fails"
        yield from _render_codes(summary)
    if summary.parameters:
        yield ""
        yield "what it depends on"
        width = max(len(one.column.name) for one in summary.parameters)
        for one in summary.parameters:
            first, *others = describe_parameter(one)
            yield f"  {one.column.name:<{width}}  {first}"
            yield from (f"  {'':<{width}}  {other}" for other in others)


def _render_codes(summary: Summary) -> Iterator[str]:
    shown = summary.codes[:MOST_CODES]
    failed = summary.done - summary.passed
    rows = [
        (f"{one.code} {one.name}".rstrip(), f"{one.runs:,}", write_share(one.runs, failed))
        for one in shown
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    for number, (one, (code, runs, share)) in enumerate(zip(shown, rows, strict=True)):
        yield (
            f"  {code:<{widths[0]}}  {runs:>{widths[1]}}  {share:>{widths[2]}} of those that fail, "
            f"first in run {one.first_run}"
        )
        if one.example and number < MOST_EXAMPLES:
            message = re.sub(rf"^{one.code}( {re.escape(one.name)})?: ", "", one.example)
            yield f"    {_clip(message, LONGEST_EXAMPLE)}"
    if len(summary.codes) > len(shown):
        yield f"  and {len(summary.codes) - len(shown)} more"


def describe_parameter(one: ParameterSummary) -> list[str]:
    """Say what a parameter does to the result: a line, or one for each value; then each rule."""
    of_rules = (
        f"{f'{rule.code} {rule.name}'.rstrip()} {describe_dependence(rule.dependence, one)}"
        for rule in one.rules
    )
    return [*_describe_result(one), *of_rules]


def _describe_result(one: ParameterSummary) -> list[str]:
    if one.dependence is None:
        return _describe_shares(one.shares)
    return [describe_dependence(one.dependence, one)]


def _describe_shares(shares: Sequence[ValueShare]) -> list[str]:
    # Most values are interesting where they differ most.
    chosen = shares
    if len(shares) > MOST_SHARES:
        ordered = sorted(shares, key=lambda share: (share.passed / share.runs, share.value))
        chosen = [*ordered[: MOST_SHARES // 2], *ordered[-MOST_SHARES // 2 :]]
    width = max(len(_shown(share.value)) for share in chosen)
    lines = [
        f"{_shown(share.value):<{width}}  {write_share(share.passed, share.runs)} passed "
        f"({share.passed:,} of {share.runs:,})"
        for share in chosen
    ]
    if len(chosen) < len(shares):
        lines.insert(MOST_SHARES // 2, f"… {len(shares) - len(chosen)} more values lie in between")
    return lines


def _shown(text: str) -> str:
    """A value of a text on one line."""
    return _clip(text, LONGEST_VALUE) or '""'


def _clip(text: str, most: int) -> str:
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most - 1]}…"


def describe_dependence(dependence: Dependence, one: ParameterSummary) -> str:
    """Say where the borders are, or why none is visible."""
    if not dependence.borders:
        between = f"from {_number(one.lowest)} to {_number(one.highest)}{_space(one.unit)}"
        return f"no border {between}: {dependence.reason}"
    mostly = "" if dependence.is_certain or dependence.is_clear else "mostly "
    places = [write_border(border, one.unit) for border in dependence.borders]
    if len(places) == 1:
        (border,) = dependence.borders
        text = f"passes {mostly}{'below' if border.passes_below else 'above'} {places[0]}"
    elif dependence.borders[0].passes_below:
        text = f"fails {mostly}from {places[0]} to {places[1]}"
    else:
        text = f"passes {mostly}from {places[0]} to {places[1]}"
    if not mostly:
        return text
    zones = ("below", "above") if len(places) == 1 else ("below", "in between", "above")
    shares = ", ".join(
        f"{_percent(share)} {zone}" for share, zone in zip(dependence.shares, zones, strict=True)
    )
    return f"{text}: {shares}"


def write_share(part: int, whole: int) -> str:
    """A share in percent; 100 % and 0 % are exact."""
    return _percent(part / whole)


def _percent(share: float) -> str:
    if share in {0.0, 1.0}:
        return f"{100 * share:.0f} %"
    return f"{min(max(100 * share, 0.1), 99.9):.1f} %"


def write_border(border: Border, unit: str) -> str:
    """A border with its uncertainty and its unit; angles in degrees, too."""
    text = write_uncertain(border.at, border.low, border.high, unit)
    if unit != "rad":
        return text
    at, low, high = (math.degrees(angle) for angle in (border.at, border.low, border.high))
    other = write_uncertain(at, low, high, "degrees")
    return f"{text}, {other}" if "(" in text else f"{text} ({other})"


def write_uncertain(at: float, low: float, high: float, unit: str = "") -> str:
    """A number with two digits of its uncertainty, as `0.435 ± 0.011 kg`."""
    parts = sorted((at - low, high - at))
    digits = _digits(parts[1])
    if parts[1] > ASYMMETRIC * parts[0]:
        interval = f"from {_round(low, digits)} to {_round(high, digits)}"
        return f"{_round(at, digits)}{_space(unit)} ({interval})"
    return f"{_round(at, digits)} ± {_round(parts[1], digits)}{_space(unit)}"


def _digits(uncertainty: float) -> int:
    """How many decimals show two digits of it."""
    if uncertainty <= 0 or not math.isfinite(uncertainty):
        return 6
    return 1 - math.floor(math.log10(uncertainty) + 1e-9)


def _round(number: float, digits: int) -> str:
    rounded = round(number, digits) + 0.0
    return f"{rounded:.{digits}f}" if 0 <= digits <= 9 else f"{rounded:.10g}"  # noqa: PLR2004


def _number(number: float | None) -> str:
    return "?" if number is None else f"{number + 0.0:.4g}"


def _space(unit: str) -> str:
    return f" {unit}" if unit else ""


# ---- As JSON.


def summary_as_json(summary: Summary) -> dict[str, Any]:
    """The summary for `--format json`."""
    return {
        "runs": summary.runs,
        "done": summary.done,
        "passed": summary.passed,
        "failures": [
            {
                "code": one.code,
                "name": one.name or None,
                "runs": one.runs,
                "first_run": one.first_run,
                "example": one.example or None,
            }
            for one in summary.codes
        ],
        "parameters": [_parameter_as_json(one) for one in summary.parameters],
    }


def _parameter_as_json(one: ParameterSummary) -> dict[str, Any]:
    dependence = one.dependence
    return {
        "name": one.column.name,
        "unit": one.unit or None,
        "lowest": one.lowest,
        "highest": one.highest,
        "summary": "; ".join(_describe_result(one)),
        "is_certain": dependence.is_certain if dependence else None,
        "borders": [
            _border_as_json(border) for border in (dependence.borders if dependence else ())
        ],
        "rules": [
            {
                "code": rule.code,
                "name": rule.name or None,
                "summary": describe_dependence(rule.dependence, one),
                "borders": [_border_as_json(border) for border in rule.dependence.borders],
            }
            for rule in one.rules
        ],
        "shares": [
            {"value": share.value, "runs": share.runs, "passed": share.passed}
            for share in one.shares
        ],
    }


def _border_as_json(border: Border) -> dict[str, Any]:
    return {
        "at": border.at,
        "low": border.low,
        "high": border.high,
        "passes": "below" if border.passes_below else "above",
    }
