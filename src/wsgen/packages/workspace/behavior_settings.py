"""Read `[[behavior]]` of a package's `wsgen.toml`, and report every mistake in its form."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from wsgen.model.behavior import Behavior, Drive, LaunchTask, Reach, Task
from wsgen.text.suggestions import advice
from wsgen.text.tomlfile import find_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic, Rule


TABLE = "behavior"
EXAMPLE = (
    'Write for example: [[behavior]], name = "drives straight", drive = { linear = 0.5 }, '
    "seconds = 2.0, moved = { x = 1.0 }; docs/behaviors.md lists the keys."
)
COMMON = ("name", "robot", "seconds")
OF_DRIVE = ("drive", "moved", "tolerance")
OF_REACH = ("joints", "within")
OF_RUN = ("run", "moved", "tolerance", "travels", "joints", "within")
KEYS = (*COMMON, *dict.fromkeys((*OF_DRIVE, *OF_REACH, *OF_RUN)))
TWIST = ("linear", "angular")
PLACE = ("x", "y", "yaw")

MOST = 50  # behaviors; each takes seconds of simulated time
LONGEST_NAME = 80  # characters; it is shown on one line
LONGEST = 60.0  # s
FASTEST = 100.0  # m/s or rad/s
FARTHEST = FASTEST * LONGEST  # m or rad


def read_behaviors(
    document: Mapping[str, Any], file: Path, text: str, rule: Rule
) -> tuple[tuple[Behavior, ...], tuple[Diagnostic, ...]]:
    """Return the valid behaviors, and the mistakes in the others.

    `document` is the parsed `text` of the file; `rule` is the one that reports mistakes in it.
    """
    reader = _Reader(file, text, rule)
    tables = document.get(TABLE, [])
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        is_one = isinstance(tables, dict)
        reader.report(
            "`behavior` is not a list of tables.",
            "Write [[behavior]], with two brackets on each side." if is_one else EXAMPLE,
            TABLE,
        )
        return (), tuple(reader.found)
    if len(tables) > MOST:
        reader.report(
            f"wsgen.toml defines {len(tables)} behaviors; the limit is {MOST}.",
            "Split the robots into several packages.",
            TABLE,
        )
        return (), tuple(reader.found)
    read: dict[str, Behavior] = {}
    for index, table in enumerate(tables):
        behavior = reader.behavior(table, index, read)
        if behavior is not None:
            read[behavior.name] = behavior
    return tuple(read.values()), tuple(reader.found)


class _Reader:
    """Reads the values of a file, and collects the mistakes."""

    def __init__(self, file: Path, text: str, rule: Rule) -> None:
        self.file = file
        self.text = text
        self.rule = rule
        self.found: list[Diagnostic] = []

    def report(self, message: str, hint: str, *where: str) -> None:
        """Report a mistake at a path of keys."""
        line = find_line(self.text, where)
        self.found.append(
            self.rule.at(self.file, line, ".".join(where), message=message, hint=hint)
        )

    def behavior(self, table: dict[str, Any], index: int, before: Iterable[str]) -> Behavior | None:
        """Read one table; None where it has a mistake."""
        count = len(self.found)
        where = (TABLE, str(index))
        kinds = self._kinds(table, *where)
        allowed = {
            "drive": (*COMMON, *OF_DRIVE, "run"),
            "joints": (*COMMON, *OF_REACH, "run"),
            "run": (*COMMON, *OF_RUN),
        }
        self._no_others(table, allowed[kinds[0]] if kinds else KEYS, *where)
        name = self._name(table, before, *where)
        seconds = self._number(table, *where, "seconds", default=None, most=LONGEST, positive=True)
        robot = self._robot(table, *where)
        task = self._task(table, kinds, *where)
        if len(self.found) > count or name is None or seconds is None or task is None:
            return None
        line = find_line(self.text, where)
        return Behavior(name=name, task=task, seconds=seconds, robot=robot, line=line)

    def _kinds(self, table: dict[str, Any], *where: str) -> Sequence[str]:
        """What decides what the behavior is: one key; none where that is not clear."""
        run = table.get("run", False)
        if not isinstance(run, bool):
            meant = "without quotes " if isinstance(run, str) else ""
            self.report(
                "The `run` of a behavior must be true or false.",
                f"Write run = true {meant}to run the launch file, or remove the key.",
                *where,
                "run",
            )
            return ()
        kinds = [key for key in ("drive", "joints") if key in table]
        if run and "drive" in kinds:
            self.report(
                "A behavior has both `drive` and `run`.",
                "Remove `drive`: with `run`, the nodes of the launch file drive the robot.",
                *where,
            )
            return ()
        if run:
            return ("run",)
        if len(kinds) != 1:
            self.report(
                "A behavior has both `drive` and `joints`."
                if kinds
                else "A behavior has neither `drive` nor `joints`.",
                "Add one of them: `drive` for a mobile robot, `joints` for a target position; "
                "or run = true, to have the nodes of the launch file move the robot.",
                *where,
            )
            return ()
        return kinds

    def _task(self, table: dict[str, Any], kinds: Sequence[str], *where: str) -> Task | None:
        if "run" in kinds:
            return self._run(table, *where)
        if "drive" in kinds:
            return self._drive(table, *where)
        return self._reach(table, *where) if kinds else None

    def _name(self, table: dict[str, Any], before: Iterable[str], *where: str) -> str | None:
        name = table.get("name")
        if not isinstance(name, str) or not name.strip() or not name.isprintable():
            self.report(
                "A behavior has no name."
                if name is None
                else "The `name` of a behavior is not a text on one line.",
                'Write for example: name = "drives straight"',
                *where,
                "name",
            )
            return None
        if len(name) > LONGEST_NAME:
            self.report(
                f"The `name` of a behavior has more than {LONGEST_NAME} characters.",
                "Describe in a few words what the robot does.",
                *where,
                "name",
            )
        if name in before:
            self.report(f"Two behaviors are named `{name}`.", "Rename one of them.", *where, "name")
        return name

    def _robot(self, table: dict[str, Any], *where: str) -> str | None:
        robot = table.get("robot")
        if robot is None or (isinstance(robot, str) and robot):
            return robot
        self.report(
            "The `robot` of a behavior is not a name.",
            "Write the name that the robot is spawned under; with a single robot, remove the key.",
            *where,
            "robot",
        )
        return None

    def _drive(self, table: dict[str, Any], *where: str) -> Drive | None:
        twist = self._numbers(table, *where, "drive", keys=TWIST, most=FASTEST)
        moved = self._numbers(table, *where, "moved", keys=PLACE, most=FARTHEST)
        tolerance = self._number(table, *where, "tolerance", default=0.1, most=1.0, positive=True)
        if twist is None or moved is None or tolerance is None:
            return None
        return Drive(**twist, **moved, tolerance=tolerance)

    def _reach(self, table: dict[str, Any], *where: str) -> Reach | None:
        positions = self._numbers(table, *where, "joints", keys=None, most=FARTHEST)
        within = self._number(table, *where, "within", default=0.05, most=10.0, positive=True)
        if positions is None or within is None:
            return None
        return Reach(positions=positions, within=within)

    def _run(self, table: dict[str, Any], *where: str) -> LaunchTask | None:
        moved: dict[str, float] | None = {}
        positions: dict[str, float] | None = {}
        if "moved" in table:
            moved = self._numbers(table, *where, "moved", keys=PLACE, most=FARTHEST)
        if "joints" in table:
            positions = self._numbers(table, *where, "joints", keys=None, most=FARTHEST)
        tolerance = self._number(table, *where, "tolerance", default=0.1, most=1.0, positive=True)
        within = self._number(table, *where, "within", default=0.05, most=10.0, positive=True)
        travels = None
        if "travels" in table:
            travels = self._number(
                table, *where, "travels", default=None, most=FARTHEST, positive=True
            )
        if moved is None or positions is None or tolerance is None or within is None:
            return None
        return LaunchTask(
            **moved, tolerance=tolerance, travels=travels, positions=positions, within=within
        )

    def _numbers(
        self, table: dict[str, Any], *where: str, keys: tuple[str, ...] | None, most: float
    ) -> dict[str, float] | None:
        """Read a table of one or more numbers; without `keys` it may have any."""
        inside = table.get(where[-1])
        if not isinstance(inside, dict) or not inside:
            some = " = 0.5, ".join(keys or ("joint_1", "joint_2")) + " = 0.5"
            self.report(
                f"A behavior has no `{where[-1]}`."
                if inside is None
                else f"`{where[-1]}` is not a table of numbers.",
                f"Write for example: {where[-1]} = {{ {some} }}",
                *where,
            )
            return None
        if keys is not None and not self._no_others(inside, keys, *where):
            return None
        numbers = {
            key: self._number(inside, *where, key, default=None, most=most) for key in inside
        }
        return {key: number for key, number in numbers.items() if number is not None}

    def _number(
        self,
        table: dict[str, Any],
        *where: str,
        default: float | None,
        most: float,
        positive: bool = False,
    ) -> float | None:
        """Read the number at the last key of the path; None if it is invalid, which is reported."""
        value = table.get(where[-1], default)
        span = f"greater than 0 and at most {most:g}" if positive else f"from {-most:g} to {most:g}"
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.report(
                f"A behavior has no `{where[-1]}`."
                if value is None
                else f"`{where[-1]}` is not a number.",
                f"Write a number {span}{_unquoted(value)}.",
                *where,
            )
            return None
        if not math.isfinite(value) or abs(value) > most or (positive and value <= 0):
            self.report(f"`{where[-1]}` is {value:g}.", f"Write a number {span}.", *where)
            return None
        return float(value)

    def _no_others(self, table: dict[str, Any], keys: tuple[str, ...], *where: str) -> bool:
        """Report unknown keys; return whether none was found."""
        unknown = [key for key in table if key not in keys]
        free = [key for key in keys if key not in table]  # a given key is hardly meant again
        for key in unknown:
            self.report(
                f"`{where[0] if len(where) < 3 else where[-1]}` has no key `{key}`"  # noqa: PLR2004  in a table of it
                + (" here." if key in KEYS else "."),
                advice(key, free, f"Use its keys: {', '.join(f'`{one}`' for one in keys)}."),
                *where,
                key,
            )
        return not unknown


def _unquoted(value: object) -> str:
    """That a number between quotes is a text."""
    return ", without quotes" if isinstance(value, str) else ""
