"""All substitutions."""

from __future__ import annotations

import importlib
import os
import shlex
from functools import partial
from operator import eq
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch._finder import show_public_names
from launch._utilities import (
    BEFORE_HUMBLE,
    normalize_optional,
    normalize_to_list_of_substitutions,
    perform_substitutions,
)
from launch.base import Substitution, SubstitutionFailure, TextSubstitution  # noqa: F401  shown with the others
from launch.conditions import evaluate_condition_expression
from launch.launch_context import local_of
from wsgen.launching import known_packages
from wsgen.launching.commands import keep_separators
from wsgen.launching.plain import is_plain_expression
from wsgen.launching.record import RECORD, run_command
from wsgen.text.files import refuse_irregular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from launch.base import SomeSubstitutionsType
    from launch.launch_context import LaunchContext
    from wsgen.launching.record import CommandOutcome, Location


class AnonName(Substitution):
    """The same name for the same text; not random here, so that plans can be compared."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        self.__name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Itself in words."""
        return f"AnonName({' + '.join(sub.describe() for sub in self.__name)})"

    def perform(self, context: LaunchContext) -> str:
        """The name."""
        name = perform_substitutions(context, self.__name)
        names = context.launch_configurations.setdefault("anon_names", {})
        anonymous: str = names.setdefault(name, f"{name}_anonymous_{len(names)}")
        return anonymous


class BooleanSubstitution(Substitution):
    """Base: texts that must be true or false."""

    def __init__(self, *values: SomeSubstitutionsType) -> None:
        self.__values = [normalize_to_list_of_substitutions(value) for value in values]

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}()"

    def perform(self, context: LaunchContext) -> str:
        """Itself as "true" or "false"."""
        texts = [perform_substitutions(context, value) for value in self.__values]
        return _unless_unknown(
            texts, lambda: self._combine([_truth(text) for text in texts]), self.wsgen_location
        )

    def _combine(self, truths: list[bool]) -> bool:
        raise NotImplementedError


class NotSubstitution(BooleanSubstitution):
    """The opposite of one value."""

    def __init__(self, value: SomeSubstitutionsType) -> None:
        super().__init__(value)

    def _combine(self, truths: list[bool]) -> bool:
        return not truths[0]


class AllSubstitution(BooleanSubstitution):
    """Whether all values are true."""

    def _combine(self, truths: list[bool]) -> bool:
        return all(truths)


class AnySubstitution(BooleanSubstitution):
    """Whether at least one value is true."""

    def _combine(self, truths: list[bool]) -> bool:
        return any(truths)


class AndSubstitution(AllSubstitution):
    """Whether both values are true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """Whether one of two values is true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        super().__init__(left, right)


def _unless_unknown(
    texts: Sequence[str], holds: Callable[[], bool], location: Location | None
) -> str:
    """Either "true" or "false", or the text that stands for it where it is not known."""
    if any(map(RECORD.is_unknown, texts)):
        return RECORD.note_unknown(" ".join(texts), "a part of it is not known", location)
    return str(holds()).lower()


def _truth(text: str) -> bool:
    if text.strip().lower() in {"true", "1"}:
        return True
    if text.strip().lower() in {"false", "0"}:
        return False
    raise SubstitutionFailure(f"cannot read '{text}' as true or false")


class Command(Substitution):
    """The standard output of a command line, which is split as a shell splits it.

    Only xacro and a few harmless commands have an output here; see `wsgen.launching.commands`.
    """

    def __init__(
        self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail"
    ) -> None:
        self.command = normalize_to_list_of_substitutions(command)
        self.on_stderr = normalize_to_list_of_substitutions(on_stderr)

    def describe(self) -> str:
        """Itself in words."""
        return f"Command({' + '.join(sub.describe() for sub in self.command)})"

    def perform(self, context: LaunchContext) -> str:
        """The output, with its last line break."""
        line = perform_substitutions(context, self.command)
        on_stderr = perform_substitutions(context, self.on_stderr)
        if on_stderr not in {"fail", "ignore", "warn", "capture"}:
            raise SubstitutionFailure(
                "expected 'on_stderr' to be one of: 'fail', 'ignore', 'warn', and 'capture', "
                f"but got '{on_stderr}'"
            )
        outcome = run_command(shlex.split(keep_separators(line)), self.wsgen_location)
        if outcome.code != 0:
            raise _failure(
                f"executed command failed. Command: {line}\n"
                f"Captured stderr output: {outcome.stderr}",
                outcome,
            )
        if outcome.stderr and on_stderr == "fail":
            raise _failure(
                f"executed command showed stderr output. Command: {line}\n"
                f"Captured stderr output:\n{outcome.stderr}",
                outcome,
            )
        return outcome.stdout + (outcome.stderr if on_stderr == "capture" else "")


def _failure(message: str, outcome: CommandOutcome) -> SubstitutionFailure:
    failure = SubstitutionFailure(message)
    failure.wsgen_outcome = outcome  # type: ignore[attr-defined]  # says which file it is about
    return failure


class EnvironmentVariable(Substitution):
    """A variable as it is when this is performed."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = normalize_optional(default_value)

    def describe(self) -> str:
        """Itself in words."""
        return f"EnvVar({' + '.join(sub.describe() for sub in self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        name = perform_substitutions(context, self.name)
        if name in os.environ:
            return os.environ[name]
        if self.default_value is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return perform_substitutions(context, self.default_value)


class EqualsSubstitution(Substitution):
    """Either "true" or "false"; numbers are equal when they are close, `true` equals `1`."""

    def __init__(self, left: Any, right: Any) -> None:
        self.__left = _normalize(left)
        self.__right = _normalize(right)

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}()"

    def perform(self, context: LaunchContext) -> str:
        """Whether both sides are equal."""
        sides = [perform_substitutions(context, side) for side in (self.__left, self.__right)]
        return _unless_unknown(sides, lambda: self._holds(*map(_value, sides)), self.wsgen_location)

    @staticmethod
    def _holds(left: bool | float | str, right: bool | float | str) -> bool:  # noqa: FBT001  no flags
        if isinstance(left, float) and isinstance(right, float):
            import math

            return math.isclose(left, right)
        return left == right


def _normalize(side: Any) -> list[Substitution]:
    return normalize_to_list_of_substitutions(
        str(side) if isinstance(side, (bool, int, float)) else side
    )


def _value(text: str) -> bool | float | str:
    if text.lower() in {"true", "false"}:
        return text.lower() == "true"
    try:
        return float(text)
    except ValueError:
        return text


class FileContent(Substitution):
    """The text of a file."""

    def __init__(self, path: SomeSubstitutionsType) -> None:
        self.__path = normalize_to_list_of_substitutions(path)

    def describe(self) -> str:
        """Itself in words."""
        return f"FileContent({' + '.join(sub.describe() for sub in self.__path)})"

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        path = perform_substitutions(context, self.__path)
        try:
            refuse_irregular(path)
            return Path(path).read_text(encoding="utf-8")
        except OSError as error:
            raise SubstitutionFailure(f"Failed to open file {path}: {error}") from error


class FindExecutable(Substitution):
    """The path of a program on PATH; ROS's own programs are found also where ROS is not."""

    def __init__(self, *, name: SomeSubstitutionsType) -> None:
        self.name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Itself in words."""
        return f"FindExec({' + '.join(sub.describe() for sub in self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        name = perform_substitutions(context, self.name)
        import shutil  # seldom needed, and it brings bz2 and lzma

        path = shutil.which(name) or known_packages.program_path(name)
        if path is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        # Without what Windows adds, such as `.EXE`.
        return os.path.join(os.path.dirname(path), os.path.basename(name))


class ForEachVar(Substitution):
    """The value of a variable of the loop that this stands in."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self.__name = normalize_to_list_of_substitutions(name)
        self.__default_value = normalize_optional(default_value)

    def describe(self) -> str:
        """Itself in words."""
        return f"{type(self).__name__}({' + '.join(sub.describe() for sub in self.__name)})"

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        name = perform_substitutions(context, self.__name)
        found = context.get_locals_as_dict().get(local_of(name))
        if found is not None:
            return str(found)
        if self.__default_value is None:
            raise SubstitutionFailure(f"no value available for loop variable '{name}'")
        return perform_substitutions(context, self.__default_value)


class ForLoopIndex(ForEachVar):
    """The number of the iteration."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        super().__init__(name)


class IfElseSubstitution(Substitution):
    """The first text where the condition is true, else the second."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ) -> None:
        if if_value == else_value == "":
            raise RuntimeError("One of if_value and else_value must be specified")
        self.__condition = normalize_to_list_of_substitutions(condition)
        self.__if_value = normalize_to_list_of_substitutions(if_value)
        self.__else_value = normalize_to_list_of_substitutions(else_value)

    def describe(self) -> str:
        """Itself in words."""
        return f"IfElse({' + '.join(sub.describe() for sub in self.__condition)})"

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        holds = evaluate_condition_expression(context, self.__condition)
        return perform_substitutions(context, self.__if_value if holds else self.__else_value)


class LaunchConfiguration(Substitution):
    """What was set under a name; its own default only where nothing was."""

    def __init__(
        self,
        variable_name: SomeSubstitutionsType,
        *,
        default: Any | Iterable[Any] | None = None,
    ) -> None:
        self.variable_name = normalize_to_list_of_substitutions(variable_name)
        self.__default = None if default is None else _normalize_default(default)
        # Now, as a condition may keep it from being performed.
        if isinstance(variable_name, str):
            RECORD.argument_use.read.add(variable_name)

    def describe(self) -> str:
        """Itself in words."""
        return f"LaunchConfig({' + '.join(sub.describe() for sub in self.variable_name)})"

    def perform(self, context: LaunchContext) -> str:
        """The value, the default, or SubstitutionFailure."""
        name = perform_substitutions(context, self.variable_name)
        if name in context.launch_configurations:
            value: str = context.launch_configurations[name]
            return value
        if self.__default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return perform_substitutions(context, self.__default)


def _normalize_default(default: Any) -> list[Substitution]:
    """The default; what is neither text nor substitution counts as `str` writes it."""
    if isinstance(default, (str, Substitution)):
        return normalize_to_list_of_substitutions(default)
    try:
        items = list(default)
    except TypeError:
        return normalize_to_list_of_substitutions(str(default))
    return normalize_to_list_of_substitutions(
        [item if isinstance(item, Substitution) else str(item) for item in items]
    )


class LaunchLogDir(Substitution):
    """The folder above the real one, whose name has the time of the launch in it."""

    def describe(self) -> str:
        """Itself in words."""
        return "LaunchLogDir()"

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        del context
        return os.environ.get("ROS_LOG_DIR") or os.path.join(
            os.environ.get("ROS_HOME") or os.path.expanduser("~/.ros"), "log"
        )


class LocalSubstitution(Substitution):
    """An expression over the context's locals, such as `event.reason`."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression
        self.__description = description

    def describe(self) -> str:
        """Itself in words."""
        return f"LocalVar('{self.__description or self.expression}')"

    def perform(self, context: LaunchContext) -> str:
        """Its value as text."""
        RECORD.require_plain(partial(is_plain_expression, self.expression))
        try:
            value = eval(self.expression, {}, context.get_locals_as_dict())  # noqa: S307  the launch file is a program already
        except Exception as error:
            raise SubstitutionFailure(
                f"cannot find '{self.expression}' in locals: {error}"
            ) from error
        return str(value)


class NotEqualsSubstitution(EqualsSubstitution):
    """The opposite of `EqualsSubstitution`."""

    @staticmethod
    def _holds(left: bool | float | str, right: bool | float | str) -> bool:  # noqa: FBT001  same
        return not EqualsSubstitution._holds(left, right)  # noqa: SLF001  of its base


class PathJoinSubstitution(Substitution):
    """Its parts with separators in between; an absolute part discards what is before it.

    Since 2025 a part may be several substitutions, which are concatenated: launch 1.0.9 (humble),
    3.4.5 (jazzy), 3.8.1 (kilted).
    """

    def __init__(self, substitutions: Iterable[SomeSubstitutionsType]) -> None:
        self.substitutions: list[list[Substitution]]
        if isinstance(substitutions, (str, os.PathLike, Substitution)):
            self.substitutions = [normalize_to_list_of_substitutions(substitutions)]
        elif os.environ.get("ROS_DISTRO") in BEFORE_HUMBLE:
            parts: Any = substitutions  # any other than texts and substitutions are refused
            self.substitutions = [[part] for part in normalize_to_list_of_substitutions(parts)]
        else:
            self.substitutions = [
                normalize_to_list_of_substitutions(part) for part in substitutions
            ]

    def describe(self) -> str:
        """Itself in words."""
        parts = (" + ".join(sub.describe() for sub in part) for part in self.substitutions)
        return f"PathJoin({', '.join(parts)})"

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        parts = [perform_substitutions(context, part) for part in self.substitutions]
        return os.path.join(*parts) if parts else ""


class PathSubstitution(PathJoinSubstitution):
    """A path that `/` goes on from."""

    def __init__(self, path: str | Substitution) -> None:
        super().__init__([path])


class PythonExpression(Substitution):
    """An expression that sees the given modules, and the names of `math` without its prefix."""

    def __init__(
        self,
        expression: SomeSubstitutionsType,
        python_modules: Iterable[SomeSubstitutionsType] = ("math",),
    ) -> None:
        self.expression = normalize_to_list_of_substitutions(expression)
        self.__modules = [normalize_to_list_of_substitutions(name) for name in python_modules]

    def describe(self) -> str:
        """Itself in words."""
        return f"PythonExpr({' + '.join(sub.describe() for sub in self.expression)})"

    def perform(self, context: LaunchContext) -> str:
        """What the expression gives, as `str` writes it."""
        names: dict[str, Any] = {}
        for module_name in self.__modules:
            name = perform_substitutions(context, module_name)
            RECORD.require_plain(partial(eq, name, "math"))
            module = importlib.import_module(name)
            if name == "math":
                names.update(vars(module))
            names[name] = module
        expression = perform_substitutions(context, self.expression)
        if RECORD.is_unknown(expression):
            return RECORD.note_unknown(expression, "a part of it is not known", self.wsgen_location)
        RECORD.require_plain(partial(is_plain_expression, expression))
        # A launch file is a program already, and its expressions are part of it.
        return str(eval(expression, {}, names))  # noqa: S307  see above


class ThisLaunchFile(Substitution):
    """The path of the launch file that was loaded last, as in the original."""

    def describe(self) -> str:
        """Itself in words."""
        return "ThisLaunchFile()"

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        path = context.get_locals_as_dict().get("current_launch_file_path")
        if path is None:
            raise SubstitutionFailure("ThisLaunchFile used outside of a launch file (in a script)")
        return str(path)


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that was loaded last, as in the original."""

    def describe(self) -> str:
        """Itself in words."""
        return "ThisLaunchFileDir()"

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        folder = context.get_locals_as_dict().get("current_launch_file_directory")
        if folder is None:
            raise SubstitutionFailure(
                "ThisLaunchFileDir used outside of a launch file (in a script)"
            )
        return str(folder)


show_public_names(__name__)
