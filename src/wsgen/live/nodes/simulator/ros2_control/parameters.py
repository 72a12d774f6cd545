"""Parameters of nodes from the YAML files that the plugin of a robot names."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from wsgen.text import yamlfile

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

T = TypeVar("T")


class ParameterFiles:
    """What several files say of the parameters of nodes; a later place overrides earlier ones."""

    def __init__(self, contents: Iterable[Any] = (), errors: Iterable[str] = ()) -> None:
        self.contents = tuple(contents)  # plain values
        self.errors = tuple(errors)  # what could not be read, for the user

    @classmethod
    def read(cls, files: Iterable[str]) -> ParameterFiles:
        """Read files; what is wrong with one of them is kept in `errors`."""
        contents: list[Any] = []
        errors: list[str] = []
        for file in files:
            content = yamlfile.load_parameters(Path(file))
            if isinstance(content, yamlfile.Value):
                contents.append(content.plain)
            elif isinstance(content, yamlfile.NotYaml):
                errors.append(f"{file}:{content.line}: {content.message}. Correct the YAML.")
            elif not Path(file).is_file():
                errors.append(f"The file of parameters `{file}` does not exist. Correct its path.")
            else:
                errors.append(f"The file of parameters `{file}` is empty or cannot be read.")
        return cls(contents, errors)

    def __add__(self, other: ParameterFiles) -> ParameterFiles:
        """Both; what the second says overrides."""
        return ParameterFiles(self.contents + other.contents, self.errors + other.errors)

    def of_node(self, full_name: str) -> dict[str, Any]:
        """The parameters of a node, whose name is given with its namespace: `/robot/manager`."""
        found: dict[str, Any] = {}
        for content in self.contents:
            found.update(yamlfile.parameters_of(content, full_name))
        return found


class Parameters:
    """The parameters of one node, with the defaults of those that it was not given."""

    def __init__(self, given: Mapping[str, Any]) -> None:
        self.values = dict(given)
        self.problems: list[str] = []  # values of the wrong type, for the user

    def number(self, name: str, default: float = 0.0) -> float:
        """A number; the default where it is none."""
        value = self.values.setdefault(name, default)
        if _is_number(value):
            return float(value)
        return self._wrong(name, value, default, "a number")

    def text(self, name: str, default: str = "") -> str:
        """A text; the default where it is none."""
        value = self.values.setdefault(name, default)
        if isinstance(value, str):
            return value
        return self._wrong(name, value, default, "a text")

    def flag(self, name: str, default: bool = False) -> bool:  # noqa: FBT001, FBT002  as the others
        """True or false; the default where it is neither."""
        value = self.values.setdefault(name, default)
        if isinstance(value, bool):
            return value
        return self._wrong(name, value, default, "true or false")

    def texts(self, name: str) -> list[str]:
        """A list of texts; none where it is not one."""
        value = self.values.setdefault(name, [])
        if isinstance(value, (list, tuple)) and all(isinstance(one, str) for one in value):
            return list(value)
        return self._wrong(name, value, [], "a list of texts")

    def numbers(self, name: str, default: Sequence[float] = ()) -> list[float]:
        """A list of numbers; the default where it is not one."""
        value = self.values.setdefault(name, list(default))
        if isinstance(value, (list, tuple)) and all(map(_is_number, value)):
            return [float(one) for one in value]
        return self._wrong(name, value, list(default), "a list of numbers")

    def bound(self, name: str) -> float | None:
        """A number that is a limit; None where it is not given, or no number (`.nan`)."""
        value = self.number(name, math.nan)
        return None if math.isnan(value) else value

    def _wrong(self, name: str, value: object, default: T, kind: str) -> T:
        self.problems.append(f"The parameter `{name}` is {value!r}, which is not {kind}.")
        return default


def _is_number(value: object) -> bool:
    """Whether it is a float, or an integer that one holds."""
    if isinstance(value, int) and not isinstance(value, bool):
        return abs(value) <= sys.float_info.max
    return isinstance(value, float)
