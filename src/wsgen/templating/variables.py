"""The variables of a template: their types and bounds, and reading a value from a request."""

from __future__ import annotations

import math
import string
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.package import Answer


TYPES = ("number", "integer", "string", "boolean", "choice")
MAXIMUM_LENGTH = 100
# A text goes into XML, Python, YAML and TOML as it is, so none of these may be special there.
_TEXT = frozenset(f"{string.ascii_letters}{string.digits}_./+- ")
_TRUTHS = {"true": True, "1": True, "false": False, "0": False}


class Variable(NamedTuple):
    """What a user may set with `--set NAME=VALUE`.

    A named tuple: `wsgen new` pays for every dataclass that is defined.
    """

    name: str
    help: str
    type: str  # one of TYPES
    default: Answer
    unit: str = ""  # SI; empty where there is none
    minimum: float = -math.inf  # included; of a number or an integer
    maximum: float = math.inf  # included
    choices: tuple[str, ...] = ()  # of a choice

    def accepts(self, value: object) -> bool:
        """Whether a value has the variable's type and lies within its bounds."""
        if self.type == "boolean":
            return isinstance(value, bool)
        if self.type == "choice":
            return value in self.choices
        if self.type == "string":
            return isinstance(value, str) and _is_plain(value)
        kinds = (int,) if self.type == "integer" else (int, float)
        return (
            isinstance(value, kinds)
            and not isinstance(value, bool)
            and self.minimum <= value <= self.maximum  # not-a-number is not
        )

    @property
    def expected(self) -> str:
        """The values that it accepts; continues a sentence with "must be"."""
        if self.type == "boolean":
            return "true or false"
        if self.type == "choice":
            return f"one of {', '.join(self.choices)}"
        if self.type == "string":
            return (
                f"a text of up to {MAXIMUM_LENGTH} letters a to z, digits, single spaces and _./+-"
            )
        article = "an" if self.type == "integer" else "a"
        unit = f" {self.unit}" if self.unit else ""
        return f"{article} {self.type} from {self.minimum:g} to {self.maximum:g}{unit}"


def resolve_answers(
    variables: Mapping[str, Variable], settings: Iterable[str], template: str
) -> dict[str, Answer]:
    """Return the value of every variable: its default, or that of the last `NAME=VALUE` for it.

    Raises:
        RequestError: a variable is unknown, or a value has another type or is out of bounds.
    """
    answers: dict[str, Answer] = {name: one.default for name, one in variables.items()}
    for setting in settings:
        name, separator, text = setting.partition("=")
        if not separator or name not in variables:
            problem = f"template {template!r} has no variable {name!r}" if separator else "no '='"
            known = ", ".join(variables) or "none"
            raise RequestError(
                f"--set {setting}: {problem}.",
                hint=f"{ask_for_nearest(name, variables)}Write --set NAME=VALUE; variables: "
                f"{known}.",
            )
        answers[name] = _read(variables[name], text, setting)
    return answers


def _is_plain(text: str) -> bool:
    return len(text) <= MAXIMUM_LENGTH and _TEXT.issuperset(text) and " ".join(text.split()) == text


def show(value: Answer) -> str:
    """Format a value as a user types it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _read(variable: Variable, text: str, setting: str) -> Answer:
    value: Answer | None
    try:
        if variable.type == "boolean":
            value = _TRUTHS.get(text.lower())
        elif variable.type == "integer":
            value = int(text)
        elif variable.type == "number":
            value = float(text)
        else:
            value = text
    except ValueError:
        value = None
    if value is None or not variable.accepts(value):
        comma = "," in text and variable.type in {"number", "integer"}
        raise RequestError(
            f"--set {setting}: `{variable.name}` must be {variable.expected}.",
            hint=f"{'Replace the comma by a point. ' if comma else ''}"
            f"Write for example --set {variable.name}={show(variable.default)}",
        )
    return value
