"""The parameters of a sweep: wsgen's own, and how those of a subject are checked and written."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.model.sweep import LEAST_INTEGER, MOST_INTEGER
from wsgen.text import tomlfile
from wsgen.text.suggestions import ask_for_nearest, some_of
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from wsgen.model.sweep import Axis, Design, Distribution, Value


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """What may vary: its name, and the values that it takes."""

    name: str
    kind: str = "any"  # "number", "integer", "boolean", "choice", "text"; "any": goes on as a text
    unit: str = ""  # SI; empty where there is none
    meaning: str = ""
    default: Value | None = None  # None: it has none, or that of the world or launch file counts
    minimum: float = -math.inf  # of a number or an integer
    maximum: float = math.inf
    is_open: bool = False  # the bounds themselves are out of bounds
    choices: tuple[str, ...] = ()

    @property
    def expected(self) -> str:
        """The values that it accepts; continues a sentence with "must be"."""
        if self.kind == "boolean":
            return "true or false"
        if self.kind == "choice":
            return f"one of {', '.join(self.choices)}"
        if self.kind not in {"number", "integer"}:
            return "a text"
        unit = f" {self.unit}" if self.unit else ""
        article = "an integer" if self.kind == "integer" else "a number"
        low, high = math.isfinite(self.minimum), math.isfinite(self.maximum)
        if low and high:
            between = "greater than {} and less than {}" if self.is_open else "from {} to {}"
            return f"{article} {between.format(_short(self.minimum), _short(self.maximum))}{unit}"
        if low:
            than = "greater than" if self.is_open else "of at least"
            return f"{article} {than} {_short(self.minimum)}{unit}"
        return article

    def is_within(self, value: float) -> bool:
        """Whether a number lies within the bounds."""
        if self.is_open:
            return self.minimum < value < self.maximum
        return self.minimum <= value <= self.maximum


def _short(value: float) -> str:
    for factor, name in ((2.0, "2 pi"), (1.0, "pi"), (0.5, "pi/2")):
        if abs(value) == math.pi * factor:
            return f"{'-' if value < 0 else ''}{name}"
    return _plain(value)


def _plain(value: float) -> str:
    """A number without an exponent, as far as a person reads it easily that way."""
    is_long = LEAST_WITH_COMMAS <= abs(value) < MOST_WITH_COMMAS and value.is_integer()
    return f"{value:,.0f}" if is_long else f"{value:g}"


FRICTION = "world.friction"
SLOPE = "world.slope"
GRAVITY = "world.gravity"
SPAWN_X, SPAWN_Y, SPAWN_Z = "spawn.x", "spawn.y", "spawn.z"
SPAWN_ROLL, SPAWN_PITCH, SPAWN_YAW = "spawn.roll", "spawn.pitch", "spawn.yaw"
MASS_SCALE = "robot.mass_scale"
INERTIA_SCALE = "robot.inertia_scale"
FRICTION_SCALE = "robot.friction_scale"
PUSH_FORCE = "push.force"
PUSH_DIRECTION = "push.direction"
PUSH_SECONDS = "push.seconds"

MOST_NAMED = 12  # parameters in a hint
LEAST_WITH_COMMAS, MOST_WITH_COMMAS = 1e4, 1e15
MOST_DEVIATIONS = 10.0  # from the mean; more than any normal distribution draws

OWN = tuple(
    Parameter(kind="number", **one)
    for one in tomlfile.load(Path(__file__).with_name("own_parameters.toml"))["parameter"]
)
_NUMBER = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(deg)?"
)  # as words.py reads it
OWN_NAMES = frozenset(one.name for one in OWN)
NEED_A_FORCE = (PUSH_DIRECTION, PUSH_SECONDS)


def own_values(values: Mapping[str, Value]) -> dict[str, float]:
    """Those values of a variant that wsgen applies itself, by parameter."""
    return {name: float(value) for name, value in values.items() if name in OWN_NAMES}


def subject_values(values: Mapping[str, Value]) -> dict[str, Value]:
    """Those values of a variant that its launch file, xacro file or template takes."""
    return {name: value for name, value in values.items() if name not in OWN_NAMES}


def write_value(value: Value) -> str:
    """A value as launch arguments, xacro arguments and `--set` take it; floats keep every digit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def check_design(
    design: Design, known: Sequence[Parameter], *, subject: str, others: str = ""
) -> Design:
    """Check names and values, and give each value the type of its parameter.

    Args:
        design: What varies.
        known: The parameters of the subject; wsgen's own are known anyway.
        subject: What has these parameters, for messages: "the launch file x.launch.py".
        others: What to say in the hint about names that are not among them.

    Returns:
        The design with the types of the parameters.

    Raises:
        RequestError: A name is unknown, or one of wsgen's and of the subject's; a value, or one
            that would be drawn, has another type or is out of bounds; or a push has no force.
        NotFoundError: The sampler needs scipy, which is not installed.
    """
    parameters = {one.name: one for one in (*known, *OWN)}
    for name in design.names:
        if name not in parameters:
            raise _unknown(name, known, subject, others)
        if name in OWN_NAMES and any(one.name == name for one in known):
            raise RequestError(
                f"{subject} has a parameter `{name}`, which is also the name of one of wsgen's.",
                hint=f"Rename the argument, for example `{name.replace('.', '_')}`: `{name}` "
                "always is that of wsgen.",
            )
    idle = [name for name in design.names if name in NEED_A_FORCE]
    if idle and PUSH_FORCE not in design.names:
        raise RequestError(
            f"{idle[0]} has no effect without {PUSH_FORCE}.",
            hint=f"Add a force in N, for example --over {PUSH_FORCE}=0:50:11",
        )
    checked = replace(
        design,
        axes=tuple(_fit_axis(axis, parameters[axis.name]) for axis in design.axes),
        distributions=tuple(
            _fit_distribution(one, parameters[one.name]) for one in design.distributions
        ),
    )
    _check_drawn(checked, parameters)
    return checked


def _unknown(name: str, known: Iterable[Parameter], subject: str, others: str) -> RequestError:
    of_subject = [one.name for one in known]
    return RequestError(
        f"{subject} has no parameter `{name}`, and neither has wsgen.",
        hint=f"{ask_for_nearest(name, (*of_subject, *OWN_NAMES))}"
        f"Its parameters: {some_of(of_subject, MOST_NAMED) or 'none'}; "
        f"`wsgen sweep --help` lists those of wsgen.{f' {others}' if others else ''}",
    )


def _fit_axis(axis: Axis, parameter: Parameter) -> Axis:
    _refuse_texts(axis.values, parameter)
    values = tuple(_fit(value, parameter) for value in axis.values)
    return replace(axis, values=_without_change(values, axis.name))


def _without_change(values: tuple[Value, ...], name: str) -> tuple[Value, ...]:
    if len(set(values)) < len(values):
        raise RequestError(f"{name}: two of its values are the same.", hint="Give each value once.")
    return values


def _refuse_texts(values: Iterable[Value], parameter: Parameter) -> None:
    """Refuse the value that is no number: with it, the others have been read as texts, too."""
    if parameter.kind in {"number", "integer"}:
        for value in values:
            if isinstance(value, str) and _NUMBER.fullmatch(value.strip()) is None:
                raise _refused(value or '""', parameter)


def _fit_distribution(distribution: Distribution, parameter: Parameter) -> Distribution:
    if distribution.kind == "choice":
        _refuse_texts(distribution.choices, parameter)
        values = tuple(_fit(value, parameter) for value in distribution.choices)
        return replace(distribution, choices=_without_change(values, distribution.name))
    if parameter.kind not in {"number", "any"}:
        raise RequestError(
            f"{parameter.name}: {distribution.kind} draws any number, and {parameter.name} must be "
            f"{parameter.expected}.",
            hint=f"Write --random '{parameter.name}=choice({_example(parameter)})'",
        )
    if distribution.kind != "normal":
        for number in distribution.numbers:
            _check_bounds(number, parameter)
    return distribution


def _example(parameter: Parameter) -> str:
    if parameter.kind == "boolean":
        return "true, false"
    if parameter.kind == "choice":
        return ", ".join(parameter.choices)
    return "1, 2, 3" if parameter.kind == "integer" else "a, b"


def _fit(value: Value, parameter: Parameter) -> Value:
    """A value with the type of its parameter.

    Raises:
        RequestError: It has another one, or is out of bounds.
    """
    fitting = _CONVERSIONS[parameter.kind](value)
    if fitting is None or (parameter.kind == "choice" and fitting not in parameter.choices):
        raise _refused(write_value(value), parameter)
    if parameter.kind in {"number", "integer"}:
        _check_bounds(float(fitting), parameter)
    return fitting


def _to_number(value: Value) -> float | None:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return float(value) if is_number else None


def _to_integer(value: Value) -> int | None:
    number = _to_number(value)
    if number is None or not number.is_integer():
        return None
    integer = value if isinstance(value, int) else int(number)  # a float has fewer digits
    return integer if LEAST_INTEGER <= integer <= MOST_INTEGER else None


def _to_boolean(value: Value) -> bool | None:
    return {"true": True, "false": False, "1": True, "0": False}.get(write_value(value).lower())


def _to_any(value: Value) -> Value:
    return value


_CONVERSIONS: Mapping[str, Callable[[Value], Value | None]] = {
    "number": _to_number,
    "integer": _to_integer,
    "boolean": _to_boolean,
    "choice": write_value,
    "text": write_value,
    "any": _to_any,
}


def _check_bounds(value: float, parameter: Parameter) -> None:
    if not parameter.is_within(value):
        raise _refused(_plain(value), parameter)


def _refused(value: str, parameter: Parameter) -> RequestError:
    meaning = f"It is the {parameter.meaning}." if parameter.name in OWN_NAMES else ""
    hint = meaning or f"Give other values of {parameter.name}."
    number = _NUMBER.fullmatch(value.replace(",", "").strip())
    in_degrees = parameter.unit == "rad" and number is not None and not number[2]
    if number is not None and in_degrees and parameter.is_within(math.radians(float(number[1]))):
        hint = f"Write {number[1]}deg if it is in degrees. {hint}"
    return RequestError(
        f"{parameter.name}: {value} is not allowed; it must be {parameter.expected}.", hint=hint
    )


def _check_drawn(design: Design, parameters: Mapping[str, Parameter]) -> None:
    """Check what normal distributions draw, which have no bounds."""
    doubtful = [
        (index, one)
        for index, one in enumerate(design.distributions)
        if one.kind == "normal"
        and (
            math.isfinite(parameters[one.name].minimum)
            or math.isfinite(parameters[one.name].maximum)
            or not math.isfinite(abs(one.numbers[0]) + MOST_DEVIATIONS * one.numbers[1])
        )
    ]
    if not doubtful:
        return
    from wsgen.sweeping.samples import Samples, quantile  # noqa: PLC0415  a grid needs no NumPy

    samples = Samples(design)
    for index, one in doubtful:
        parameter = parameters[one.name]
        for place in samples.extremes(index):
            value = float(quantile(one, place))
            if not math.isfinite(value) or not parameter.is_within(value):
                mean, deviation = one.numbers
                raise RequestError(
                    f"{one.name}: normal({mean:g}, {deviation:g}) draws {value:g} in one of the "
                    f"{design.samples} samples; it must be "
                    f"{'finite' if math.isinf(value) else parameter.expected}.",
                    hint="Give a smaller deviation, or use uniform or loguniform.",
                )
