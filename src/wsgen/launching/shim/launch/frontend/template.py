"""Texts with `$(name argument ...)` in them, as substitutions.

Arguments are separated by one blank each; one that holds blanks or parentheses is quoted. A
backslash takes the meaning from the character behind it.
"""

from __future__ import annotations

import importlib
import re
from typing import TYPE_CHECKING, Any, NamedTuple

from launch.base import TextSubstitution
from launch.frontend.expose import registered, substitution_parse_methods

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.base import Substitution

    Arguments = list[list[Substitution]]


_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_ESCAPED = re.compile(r"\\(.)", re.DOTALL)


def parse_substitution(text: str) -> list[Substitution]:
    """The substitutions whose texts, one after the other, are the text."""
    if "$" not in text:  # nearly all are plain
        return [TextSubstitution(text=unescape(text))]
    found, _ = _Reader(text).template(0, "")
    return found


def parse_if_substitutions(value: Any) -> Any:
    """A value; where it is a text with substitutions, these; a list item by item."""
    if isinstance(value, list):
        return [parse_if_substitutions(item) for item in value]
    if not isinstance(value, str):
        return value
    parts = parse_substitution(value)
    if len(parts) == 1 and isinstance(parts[0], TextSubstitution):
        return parts[0].text
    return parts


def unescape(text: str) -> str:
    """The text without the backslashes that protect something."""
    return _ESCAPED.sub(r"\1", text)


class _Reader:
    """Reads from a position on, and gives what it found and where that ends."""

    def __init__(self, text: str) -> None:
        self.text = text

    def template(self, position: int, quote: str) -> tuple[list[Substitution], int]:
        """Text and substitutions up to the closing quote, or the end where there is none."""
        return self._run(position, quote, quote)

    def _run(self, position: int, quote: str, end_marks: str) -> tuple[list[Substitution], int]:
        found: list[Substitution] = []
        begin = position
        while position < len(self.text) and self.text[position] not in end_marks:
            if self.text[position] == "\\":
                position += 2
            elif self.text.startswith("$(", position):
                self._add_text(found, begin, position)
                substitution, position = self._substitution(position, quote)
                found.append(substitution)
                begin = position
            elif self.text[position] == "$":
                raise self._refusal(position, "a '$' that begins no $(...) must be written as \\$")
            else:
                position += 1
        self._add_text(found, begin, position)
        return found, min(position, len(self.text))

    def _add_text(self, found: list[Substitution], begin: int, end: int) -> None:
        if begin < end:
            found.append(TextSubstitution(text=unescape(self.text[begin:end])))

    def _substitution(self, position: int, quote: str) -> tuple[Substitution, int]:
        name = _NAME.match(self.text, position + 2)
        if name is None:
            raise self._refusal(position, "a name is missing behind '$('")
        position = name.end()
        arguments: list[list[Substitution]] = []
        while self.text.startswith(" ", position):
            argument, position = self._argument(position + 1, quote)
            arguments.append(argument)
        if not self.text.startswith(")", position):
            raise self._refusal(position, "')' is missing")

        return make(name.group(), arguments), position + 1

    def _argument(self, position: int, quote: str) -> tuple[list[Substitution], int]:
        mark = self.text[position : position + 1]
        if mark in {"'", '"'} and not quote:
            found, position = self.template(position + 1, mark)
            if not self.text.startswith(mark, position):
                raise self._refusal(position, f"a quote {mark} is not closed")
            return found, position + 1
        found, position = self._run(position, quote, f" (){quote}" if quote else " ()'\"")
        if not found:
            raise self._refusal(position, "an argument is missing")
        return found, position

    def _refusal(self, position: int, what: str) -> ValueError:
        return ValueError(f"cannot read '{self.text}' at character {position + 1}: {what}")


class _Form(NamedTuple):
    """A substitution: where its class is, and the keywords of its arguments."""

    module: str
    name: str
    keywords: tuple[str, ...] = ()
    required: int | None = None  # how many of them; None: all
    takes_list: bool = False  # the arguments, however many, are one parameter


_LAUNCH = "launch.substitutions"
_ROS = "launch_ros.substitutions"

FORMS = {
    "all": _Form(_LAUNCH, "AllSubstitution", takes_list=True),
    "and": _Form(_LAUNCH, "AndSubstitution", ("left", "right")),
    "anon": _Form(_LAUNCH, "AnonName", ("name",)),
    "any": _Form(_LAUNCH, "AnySubstitution", takes_list=True),
    "command": _Form(_LAUNCH, "Command", ("command", "on_stderr"), 1),
    "dirname": _Form(_LAUNCH, "ThisLaunchFileDir"),
    "env": _Form(_LAUNCH, "EnvironmentVariable", ("name", "default_value"), 1),
    "equals": _Form(_LAUNCH, "EqualsSubstitution", ("left", "right")),
    "eval": _Form(_LAUNCH, "PythonExpression", ("expression", "python_modules"), 1),
    "exec-in-pkg": _Form(_ROS, "ExecutableInPackage", ("executable", "package")),
    "file-content": _Form(_LAUNCH, "FileContent", ("path",)),
    "filename": _Form(_LAUNCH, "ThisLaunchFile"),
    "find-exec": _Form(_LAUNCH, "FindExecutable", ("name",)),
    "find-pkg-prefix": _Form(_ROS, "FindPackagePrefix", ("package",)),
    "find-pkg-share": _Form(_ROS, "FindPackageShare", ("package",)),
    "for-var": _Form(_LAUNCH, "ForEachVar", ("name", "default_value"), 1),
    "if": _Form(_LAUNCH, "IfElseSubstitution", ("condition", "if_value", "else_value"), 2),
    "index": _Form(_LAUNCH, "ForLoopIndex", ("name",)),
    "launch_log_dir": _Form(_LAUNCH, "LaunchLogDir"),
    "log_dir": _Form(_LAUNCH, "LaunchLogDir"),
    "not": _Form(_LAUNCH, "NotSubstitution", ("value",)),
    "not-equals": _Form(_LAUNCH, "NotEqualsSubstitution", ("left", "right")),
    "or": _Form(_LAUNCH, "OrSubstitution", ("left", "right")),
    "path-join": _Form(_LAUNCH, "PathJoinSubstitution", takes_list=True),
    "var": _Form(_LAUNCH, "LaunchConfiguration", ("variable_name", "default"), 1),
}


def make(name: str, arguments: Arguments) -> Substitution:
    """The substitution of that name."""
    form = FORMS.get(name)
    if form is None:
        parse = registered(name, substitution_parse_methods)
        if parse is None:
            raise RuntimeError(f"Unknown substitution: {name}")
        exposed, values = parse(arguments)
        made_by_package: Substitution = exposed(**values)
        return made_by_package
    made: Callable[..., Substitution] = getattr(importlib.import_module(form.module), form.name)
    if form.takes_list:
        return made(*arguments) if name in {"all", "any"} else made(arguments)
    required = len(form.keywords) if form.required is None else form.required
    if not required <= len(arguments) <= len(form.keywords):
        expected = " or ".join(str(n) for n in range(required, len(form.keywords) + 1))
        raise TypeError(
            f"{name} substitution expects {expected} argument(s), and is given {len(arguments)}"
        )
    keywords: dict[str, Any] = dict(zip(form.keywords, arguments, strict=False))
    if "python_modules" in keywords:
        keywords["python_modules"] = [keywords["python_modules"]]
    return made(**keywords)
