"""Read `[sweep]` of a package's `wsgen.toml`, and report every mistake in its form.

The table says what `wsgen sweep PACKAGE` varies, in the words of its options:

    [sweep]
    over = { "world.slope" = "0:30deg:31", wheel_radius = [0.03, 0.04] }
    random = { "robot.mass_scale" = "normal(1, 0.1)" }
    samples = 200
    sampler = "sobol"
    seed = 7
    seconds = 5.0
    engine = "mujoco"
    behaviors = false
    out = "rover.parquet"

A name with a dot stands in quotes. A value of `over` is a text as after `--over NAME=`, a value, or
a list of values, in the units of the parameter. Each key is a default: an option of the command
line takes its place, `--over` and `--random` name by name. `out` is relative to the current folder.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import TYPE_CHECKING, Any

from wsgen.model.engines import ENGINES
from wsgen.model.sweep import LONGEST_RUN, MOST_SEED, MOST_VARIANTS, SAMPLERS, SHORTEST_RUN
from wsgen.text.suggestions import advice
from wsgen.text.tomlfile import find_line
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic, Rule
    from wsgen.model.sweep import Value


TABLE = "sweep"
EXAMPLE = 'Write for example: [sweep], over = { "world.slope" = "0:30deg:31" }'
KEYS = ("over", "random", "samples", "sampler", "seed", "seconds", "engine", "behaviors", "out")


@dataclass(frozen=True, kw_only=True)
class SweepSettings:
    """The defaults of a sweep; None where the file has none."""

    file: Path | None = None  # that they are written in
    # By name: a text as after `--over NAME=`, or the values.
    over: Mapping[str, str | tuple[Value, ...]] = field(default_factory=dict)
    random: Mapping[str, str] = field(default_factory=dict)  # by name, as after `--random NAME=`
    lines: Mapping[str, int | None] = field(default_factory=dict)  # of these names, 1-based
    samples: int | None = None
    sampler: str | None = None
    seed: int | None = None
    seconds: float | None = None
    engine: str | None = None
    behaviors: bool | None = None
    out: str | None = None


def read_sweep(
    document: Mapping[str, Any], file: Path, text: str, rule: Rule
) -> tuple[SweepSettings, tuple[Diagnostic, ...]]:
    """Return the valid settings, and the mistakes in the others.

    `document` is the parsed `text` of the file; `rule` is the one that reports mistakes in it.
    """
    reader = _Reader(file, text, rule)
    table = document.get(TABLE, {})
    if not isinstance(table, dict):
        reader.report("`sweep` is not a table.", EXAMPLE)
        return SweepSettings(file=file), tuple(reader.found)
    for key in table:
        if key not in KEYS:
            keys = ", ".join(f"`{one}`" for one in KEYS)
            hint = advice(
                key, KEYS, f"Use its keys: {keys}. Write the parameters that vary below `over`."
            )
            reader.report(f"[sweep] has no key `{key}`.", hint, key)
    over = reader.over(table)
    random = reader.random(table, over)
    settings = SweepSettings(
        file=file,
        over=over,
        random=random,
        lines={
            **{name: reader.line("over", name) for name in over},
            **{name: reader.line("random", name) for name in random},
        },
        samples=reader.integer(table, "samples", least=1, most=MOST_VARIANTS),
        sampler=reader.word(table, "sampler", SAMPLERS),
        seed=reader.integer(table, "seed", least=0, most=MOST_SEED),
        seconds=reader.seconds(table),
        engine=reader.word(table, "engine", tuple(ENGINES)),
        behaviors=reader.boolean(table, "behaviors"),
        out=reader.out(table),
    )
    return settings, tuple(reader.found)


class _Reader:
    """Reads the values of the table, and collects the mistakes."""

    def __init__(self, file: Path, text: str, rule: Rule) -> None:
        self.file = file
        self.text = text
        self.rule = rule
        self.found: list[Diagnostic] = []

    def line(self, *where: str) -> int | None:
        """The line of a key below [sweep], or of the nearest around it."""
        return find_line(self.text, (TABLE, *where))

    def report(self, message: str, hint: str, *where: str) -> None:
        """Report a mistake at a path of keys below [sweep]."""
        element = ".".join((TABLE, *where))
        self.found.append(
            self.rule.at(self.file, self.line(*where), element, message=message, hint=hint)
        )

    def over(self, table: Mapping[str, Any]) -> dict[str, str | tuple[Value, ...]]:
        """Read what varies over values."""
        read: dict[str, str | tuple[Value, ...]] = {}
        for name, value in self._names(table, "over").items():
            values = value if isinstance(value, list) else [value]
            if isinstance(value, str):
                read[name] = value
            elif self._are_values(values):
                read[name] = tuple(values)
            else:
                self.report(
                    f"The values of `{name}` are not all numbers or all texts.",
                    f'Write for example: "{name}" = "0:1:11" or "{name}" = [0.1, 0.2]',
                    "over",
                    name,
                )
        return read

    def _are_values(self, values: list[Any]) -> bool:
        """Whether they are one or more numbers, or texts, or booleans."""
        kinds = {type(value) for value in values}
        is_finite = all(math.isfinite(one) for one in values if isinstance(one, float))
        return is_finite and (kinds in ({str}, {bool}) or (bool(kinds) and kinds <= {int, float}))

    def random(self, table: Mapping[str, Any], over: Mapping[str, object]) -> dict[str, str]:
        """Read what is drawn."""
        read: dict[str, str] = {}
        for name, value in self._names(table, "random").items():
            if not isinstance(value, str):
                self.report(
                    f"The distribution of `{name}` is not a text.",
                    f'Write for example: "{name}" = "uniform(0.5, 2)"',
                    "random",
                    name,
                )
            elif name in over:
                self.report(
                    f"`{name}` is in `over` and in `random`.",
                    "Remove one of the two.",
                    "random",
                    name,
                )
            else:
                read[name] = value
        return read

    def _names(self, table: Mapping[str, Any], key: str) -> dict[str, Any]:
        """The values of a table by the names of parameters, also of those with a bare dot."""
        inside = table.get(key, {})
        if not isinstance(inside, dict):
            example = '"uniform(0.5, 2)"' if key == "random" else '"0:30deg:31"'
            self.report(
                f"`{key}` is not a table of names.",
                f'Write for example: {key} = {{ "world.slope" = {example} }}',
                key,
            )
            return {}
        return dict(_flat(inside))

    def integer(self, table: Mapping[str, Any], key: str, *, least: int, most: int) -> int | None:
        """Read an integer."""
        value = table.get(key)
        if value is None:
            return None
        if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
            self.report(
                f"`{key}` is not an integer from {least} to {most}.",
                f"Write for example: {key} = {100 if key == 'samples' else 1}",
                key,
            )
            return None
        return value

    def seconds(self, table: Mapping[str, Any]) -> float | None:
        """Read the simulated time."""
        value = table.get("seconds")
        if value is None:
            return None
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not SHORTEST_RUN <= value <= LONGEST_RUN:
            self.report(
                f"`seconds` is not a number from {SHORTEST_RUN:g} to {LONGEST_RUN:g}.",
                "Write for example: seconds = 5.0",
                "seconds",
            )
            return None
        return float(value)

    def boolean(self, table: Mapping[str, Any], key: str) -> bool | None:
        """Read true or false."""
        value = table.get(key)
        if value is None or isinstance(value, bool):
            return value
        self.report(f"`{key}` must be true or false.", f"Write for example: {key} = false", key)
        return None

    def word(self, table: Mapping[str, Any], key: str, known: tuple[str, ...]) -> str | None:
        """Read one of some words."""
        value = table.get(key)
        if value is None or value in known:
            return value
        words = ", ".join(f'"{one}"' for one in known)
        self.report(
            f"`{key}` must be one of {words}.",
            advice(str(value), known, f'Write for example: {key} = "{known[0]}"'),
            key,
        )
        return None

    def out(self, table: Mapping[str, Any]) -> str | None:
        """Read the path of the table that is written."""
        value = table.get("out")
        if value is None or (isinstance(value, str) and value.strip()):
            return value
        self.report("`out` is not a path.", 'Write for example: out = "rover.csv"', "out")
        return None


def _flat(table: Mapping[str, Any], before: str = "") -> list[tuple[str, Any]]:
    """The values by their dotted names: TOML reads `world.slope` without quotes as two tables."""
    found: list[tuple[str, Any]] = []
    for name, value in table.items():
        if isinstance(value, dict):
            found += _flat(value, f"{before}{name}.")
        else:
            found.append((f"{before}{name}", value))
    return found
