"""What varies, as a user writes it: `NAME=START:STOP:COUNT`, `NAME=a,b`, `NAME=uniform(a, b)`.

A number may end in `deg`; it is then in radians. A text with a comma, a colon or a parenthesis, or
one that looks like a number and is none, stands in quotes. `[sweep]` in wsgen.toml says the same.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.model.sweep import (
    LEAST_INTEGER,
    MOST_INTEGER,
    MOST_SEED,
    MOST_VARIANTS,
    SAMPLERS,
    Axis,
    Design,
    Distribution,
)
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.model.sweep import Value
    from wsgen.packages.workspace.sweep_settings import SweepSettings


OVER, RANDOM = "--over", "--random"
DEFAULT_SAMPLES = 100
# The numbers that each distribution takes.
NUMBERS = {
    "uniform": ("LOW", "HIGH"),
    "normal": ("MEAN", "DEVIATION"),
    "loguniform": ("LOW", "HIGH"),
}
KINDS = (*NUMBERS, "choice")
EXAMPLES = {
    "uniform": "uniform(0.5, 2)",
    "normal": "normal(1, 0.1)",
    "loguniform": "loguniform(0.01, 10)",
    "choice": "choice(1, 2, 5)",
}
LONGEST_SHOWN = 100  # characters of what a user wrote
GRID_EXAMPLE = "world.slope=0:30deg:31 or wheel_radius=0.03,0.04,0.05"

_ITEM = re.compile(r"""\s*(?:"([^"]*)"|'([^']*)'|([^,"']*?))\s*(,|\Z)""")
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(deg)?")
_INTEGER = re.compile(r"[+-]?\d+")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
_CALL = re.compile(r"\s*([A-Za-z_]\w*)\s*\((.*)\)\s*", re.DOTALL)


def read_axes(words: Iterable[str], *, option: str = OVER) -> tuple[Axis, ...]:
    """The axes of a grid, in the order of the words; see `read_axis`.

    Raises:
        RequestError: A word cannot be read, or two have one name.
    """
    axes = [read_axis(*split_name(word, option), option=option) for word in words]
    _refuse_twice([axis.name for axis in axes])
    return tuple(axes)


def read_distributions(words: Iterable[str], *, option: str = RANDOM) -> tuple[Distribution, ...]:
    """The distributions, in the order of the words; see `read_distribution`.

    Raises:
        RequestError: A word cannot be read, or two have one name.
    """
    found = [read_distribution(*split_name(word, option), option=option) for word in words]
    _refuse_twice([one.name for one in found])
    return tuple(found)


def make_design(
    axes: Sequence[Axis],
    distributions: Sequence[Distribution],
    *,
    samples: int | None = None,
    sampler: str | None = None,
    seed: int | None = None,
) -> Design:
    """Put a design together; None stands for a default.

    Raises:
        RequestError: Two parameters have one name, or samples are asked for and nothing is random.
    """
    _refuse_twice([*(one.name for one in axes), *(one.name for one in distributions)])
    given = {"--samples": samples, "--sampler": sampler, "--seed": seed}
    idle = [option for option, value in given.items() if value is not None]
    if idle and not distributions:
        raise RequestError(
            f"{' and '.join(idle)} {'have' if len(idle) > 1 else 'has'} no effect: nothing is "
            "random.",
            hint=f"Add for example --random 'robot.mass_scale=uniform(0.8, 1.2)', or remove "
            f"{' and '.join(idle)}.",
        )
    if samples is not None and not 1 <= samples <= MOST_VARIANTS:
        raise RequestError(
            f"--samples {samples}: it must be from 1 to {MOST_VARIANTS:,}.",
            hint="Write for example --samples 100.",
        )
    if sampler is not None and sampler not in SAMPLERS:
        raise RequestError(
            f"--sampler {sampler}: wsgen has no such sampler.",
            hint=f"{ask_for_nearest(sampler, SAMPLERS)}Give one of {', '.join(SAMPLERS)}.",
        )
    if seed is not None and not 0 <= seed <= MOST_SEED:
        raise RequestError(
            f"--seed {seed}: it must be from 0 to {MOST_SEED}.",
            hint="Write for example --seed 1.",
        )
    return Design(
        axes=tuple(axes),
        distributions=tuple(distributions),
        samples=1 if not distributions else DEFAULT_SAMPLES if samples is None else samples,
        sampler=sampler or "random",
        seed=seed or 0,
    )


def split_name(word: str, option: str) -> tuple[str, str]:
    """The name and the text of `NAME=TEXT`.

    Raises:
        RequestError: The word has no `=`, or nothing before it.
    """
    name, separator, text = word.partition("=")
    if not separator or not name.strip():
        example = "'robot.mass_scale=uniform(0.8, 1.2)'" if option == RANDOM else GRID_EXAMPLE
        raise RequestError(
            f"{option} {word}: {'the name' if separator else '`=`'} is missing.",
            hint=f"Write {option} NAME=VALUES, for example {example}",
        )
    return name.strip(), text


def read_axis(name: str, text: str, *, option: str = OVER) -> Axis:
    """One axis: `START:STOP:COUNT` with both ends, or values with commas between.

    Values are numbers if all of them are, and else texts.

    Raises:
        RequestError: The text is neither; a value is no number, or is there twice.
    """
    shown = f"{option} {name}={_clip(text)}"
    call = _CALL.fullmatch(text)
    if call is not None and call[1].lower() in KINDS:
        raise RequestError(
            f"{shown}: a distribution has no place in a grid.",
            hint=f"Write {RANDOM} '{name}={text.strip()}'",
        )
    items = _split(text, shown)
    if len(items) == 1 and not items[0][1] and ":" in items[0][0]:
        return Axis(name=name, values=_range(items[0][0], shown, name))
    return make_axis(name, _read_values(items, shown), shown)


def make_axis(name: str, values: Sequence[Value], shown: str) -> Axis:
    """An axis of these values; `shown` names them in messages.

    Raises:
        RequestError: There is no value, one is not finite, or one is there twice.
    """
    if not values:
        raise RequestError(f"{shown}: no value is given.", hint=f"Write for example {GRID_EXAMPLE}")
    before: set[Value] = set()
    for value in values:
        if isinstance(value, float) and not math.isfinite(value):
            raise RequestError(
                f"{shown}: {value} is not a finite number.", hint="Give finite numbers."
            )
        if isinstance(value, int) and not LEAST_INTEGER <= value <= MOST_INTEGER:
            raise RequestError(
                f"{shown}: an integer does not fit into 64 bits.",
                hint="Write it with a point, or in quotes if it is a text.",
            )
        if value in before:
            raise RequestError(f"{shown}: {value} is given twice.", hint="Remove one of the two.")
        before.add(value)
    return Axis(name=name, values=tuple(values))


def read_distribution(name: str, text: str, *, option: str = RANDOM) -> Distribution:
    """One distribution: `KIND(NUMBER, NUMBER)`, or `choice(VALUE, ...)`.

    Raises:
        RequestError: The distribution is unknown, or its numbers make none.
    """
    shown = f"{option} {name}={_clip(text)}"
    call = _CALL.fullmatch(text)
    if call is None:
        raise RequestError(
            f"{shown}: a distribution is a name with numbers in parentheses.",
            hint=f"Write for example {option} '{name}={EXAMPLES['uniform']}'; for values that are "
            f"all tried, {OVER} {name}={text.strip() or '1,2'}",
        )
    kind = call[1].lower()
    if kind not in KINDS:
        raise RequestError(
            f"{shown}: wsgen does not have the distribution `{call[1]}`.",
            hint=f"{ask_for_nearest(kind, KINDS)}Write one of {', '.join(EXAMPLES.values())}.",
        )
    items = _split(call[2], shown)
    if kind == "choice":
        choices = _read_values(items, shown)
        axis = make_axis(name, choices, shown)
        return Distribution(name=name, kind=kind, choices=axis.values)
    if len(items) != len(NUMBERS[kind]):
        raise RequestError(
            f"{shown}: {kind} takes {' and '.join(NUMBERS[kind])}, not {_count(len(items))}.",
            hint=f"Write for example '{name}={EXAMPLES[kind]}'",
        )
    first, second = (float(_require_number(item, is_quoted, shown)) for item, is_quoted in items)
    _check_numbers(kind, first, second, shown)
    return Distribution(name=name, kind=kind, numbers=(first, second))


def _count(items: int) -> str:
    return f"{items} number" if items == 1 else f"{items} numbers"


def _check_numbers(kind: str, first: float, second: float, shown: str) -> None:
    problem, hint = "", ""
    if kind == "normal" and second <= 0.0:
        problem = f"the deviation {second:g} of a normal distribution is not greater than 0"
        hint = "Give the standard deviation, for example normal(1, 0.1)."
    elif kind != "normal" and first >= second:
        problem = f"LOW, {first:g}, is not less than HIGH, {second:g}"
        hint = f"Write the lesser number first, for example {EXAMPLES[kind]}."
    elif kind == "loguniform" and first <= 0.0:
        problem = f"LOW, {first:g}, is not greater than 0, and has no logarithm"
        hint = "Give a small positive number, or use uniform."
    elif kind == "uniform" and not math.isfinite(second - first):
        problem = f"the difference of LOW, {first:g}, and HIGH, {second:g}, is too large"
        hint = "Give numbers that are nearer to each other."
    if problem:
        raise RequestError(f"{shown}: {problem}.", hint=hint)


def _split(text: str, shown: str) -> list[tuple[str, bool]]:
    """The items between commas, each with whether it is in quotes."""
    if not text.strip():
        raise RequestError(f"{shown}: no value is given.", hint=f"Write for example {GRID_EXAMPLE}")
    items, place = [], 0
    while True:
        found = _ITEM.match(text, place)
        if found is None:
            raise RequestError(
                f"{shown}: a quote is missing, or stands within a text.",
                hint="""Put the whole text into quotes of one kind: 'name="a,b","c"'""",
            )
        quoted = found[1] if found[1] is not None else found[2]
        item = found[3] if quoted is None else quoted
        if quoted is None and not item:
            raise RequestError(
                f"{shown}: a value between two commas, or at the end, is empty.",
                hint='Remove the comma; write an empty text as "".',
            )
        items.append((item, quoted is not None))
        place = found.end()
        if not found[4]:
            return items


def _read_values(items: Sequence[tuple[str, bool]], shown: str) -> list[Value]:
    """Numbers if all items are, integers if all are; else texts."""
    numbers = [None if is_quoted else _read_number(item, shown) for item, is_quoted in items]
    if all(isinstance(one, int) for one in numbers):
        return [one for one in numbers if one is not None]
    if all(one is not None for one in numbers):
        return [float(one) for one in numbers if one is not None]
    return [item for item, _ in items]


def _read_number(text: str, shown: str) -> int | float | None:
    """A number; None where the text is none. Of a number in degrees, the radians."""
    if _NOT_FINITE.fullmatch(text):
        raise RequestError(
            f"{shown}: {text} cannot be simulated.",
            hint=f'Give finite numbers; write the text "{text}" in quotes.',
        )
    found = _NUMBER.fullmatch(text)
    if found is None:
        return None
    value = float(found[1])
    if not math.isfinite(value):
        raise RequestError(
            f"{shown}: {_clip(text)} is too large.",
            hint="Give finite numbers, or write it in quotes if it is a text.",
        )
    if found[2] is None and _INTEGER.fullmatch(text):
        integer = _integer(text)
        if not LEAST_INTEGER <= integer <= MOST_INTEGER:
            raise RequestError(
                f"{shown}: the integer {_clip(text)} does not fit into 64 bits.",
                hint="Write it with a point, or in quotes if it is a text.",
            )
        return integer
    return math.radians(value) if found[2] else value


def _integer(text: str) -> int:
    """An integer of any length: `int` refuses texts of more than some thousand digits."""
    return int(Decimal(text))


def _clip(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


def _require_number(item: str, is_quoted: bool, shown: str) -> int | float:  # noqa: FBT001
    number = None if is_quoted else _read_number(item, shown)
    if number is None:
        raise RequestError(
            f"{shown}: {_clip(item)!r} is not a number.",
            hint="Write numbers as 0.5, 5e-3 or 30deg.",
        )
    return number


_PARTS = 3  # of START:STOP:COUNT
_LEAST_COUNT = 2


def _range(text: str, shown: str, name: str) -> tuple[Value, ...]:
    """The values of `START:STOP:COUNT`; integers if all are, and START and STOP are written so."""
    parts = [part.strip() for part in text.split(":")]
    example = f"Write START:STOP:COUNT with both ends, for example {name}=0:1:11"
    if len(parts) != _PARTS or not all(parts):
        raise RequestError(
            f"{shown}: a range has three parts, START:STOP:COUNT.",
            hint=f'{example}; put a text with a colon into quotes: {name}="{text}"',
        )
    start, stop = (_require_number(part, False, shown) for part in parts[:2])
    if parts[0].endswith("deg") != parts[1].endswith("deg") and start and stop:
        raise RequestError(
            f"{shown}: one end is in degrees, the other is not.", hint="Write `deg` at both ends."
        )
    if not _INTEGER.fullmatch(parts[2]):
        raise RequestError(
            f"{shown}: the COUNT {_clip(parts[2])!r} is not an integer.", hint=example
        )
    count = _integer(parts[2])
    if not _LEAST_COUNT <= count <= MOST_VARIANTS:
        raise RequestError(
            f"{shown}: COUNT is {_clip(parts[2])}; it must be from {_LEAST_COUNT} to "
            f"{MOST_VARIANTS:,}.",
            hint=f"{example}; for a single value, write {name}={parts[0]}",
        )
    if start == stop:
        raise RequestError(
            f"{shown}: START and STOP are equal.",
            hint=f"For a single value, write {name}={parts[0]}",
        )
    unit = math.radians(1.0) if "deg" in (parts[0] + parts[1]) else None
    first, last = (_exact(part) for part in parts[:2])
    exact = [first + (last - first) * place / (count - 1) for place in range(count)]
    if unit is not None:
        return tuple(math.radians(float(one)) for one in exact)
    if all(map(_INTEGER.fullmatch, parts[:2])) and all(one.denominator == 1 for one in exact):
        return tuple(int(one) for one in exact)
    values = tuple(float(one) for one in exact)
    if len(set(values)) < count:
        raise RequestError(
            f"{shown}: the values are too near to each other to be distinguished.",
            hint="Give a smaller COUNT.",
        )
    return values


def _exact(text: str) -> Fraction:
    """The number as it is written: a tenth of it is then a tenth, and not nearly one."""
    number = text.removesuffix("deg").strip()
    # What is nearer to 0 than any float may have a denominator that no memory holds.
    return Fraction(Decimal(number)) if float(number) else Fraction(0)


def _refuse_twice(names: Sequence[str]) -> None:
    for place, name in enumerate(names):
        if name in names[:place]:
            raise RequestError(
                f"{name} varies twice.",
                hint=f"Give all its values at once, for example {OVER} {name}=1,2,3",
            )


def make_design_with(  # noqa: PLR0913  the options
    settings: SweepSettings,
    *,
    over: Sequence[Axis],
    random: Sequence[Distribution],
    samples: int | None,
    sampler: str | None,
    seed: int | None,
) -> Design:
    """The design of the options, and of the settings where no option takes their place.

    A parameter of the command line takes the place of one with its name, in whichever table.

    Raises:
        RequestError: A text of the settings cannot be read, or the options do not go together.
    """
    given = {axis.name: axis for axis in over}
    drawn = {one.name: one for one in random}
    named = {*given, *drawn}
    axes = [*_axes(settings, named), *given.values()]
    distributions = [*_distributions(settings, named), *drawn.values()]
    has_random = bool(distributions)
    return make_design(
        axes,
        distributions,
        # Settings about samples are idle where an option takes the place of what is random.
        samples=samples if samples is not None or not has_random else settings.samples,
        sampler=sampler if sampler is not None or not has_random else settings.sampler,
        seed=seed if seed is not None or not has_random else settings.seed,
    )


def _axes(settings: SweepSettings, named: set[str]) -> Iterable[Axis]:
    for name, values in settings.over.items():
        if name in named:
            continue
        place = _place(settings, name)
        if isinstance(values, str):
            yield read_axis(name, values, option=f"{place} over:")
        else:
            yield make_axis(name, values, f"{place} over: {name}")


def _distributions(settings: SweepSettings, named: set[str]) -> Iterable[Distribution]:
    for name, text in settings.random.items():
        if name not in named:
            yield read_distribution(name, text, option=f"{_place(settings, name)} random:")


def _place(settings: SweepSettings, name: str) -> str:
    """Where a parameter is written."""
    line = settings.lines.get(name)
    return f"{settings.file or 'wsgen.toml'}{f':{line}' if line else ''}"
