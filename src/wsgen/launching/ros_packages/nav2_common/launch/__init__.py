"""The substitutions of nav2_common: parameter files that are rewritten before nodes read them."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from launch._utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.base import Substitution
from launch.substitutions import LaunchConfiguration
from wsgen.isolation.child import scratch_folder
from wsgen.launching import known_packages
from wsgen.launching.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from launch.base import Condition, SomeSubstitutionsType
    from launch.launch_context import LaunchContext

    Rewrites = Mapping[str, SomeSubstitutionsType]

__all__ = [
    "HasNodeParams",
    "LaunchConfigAsBool",
    "ParseMultiRobotPose",
    "ReplaceString",
    "RewrittenYaml",
]


class _OfFile(Substitution):
    """Base: has a file, which is unknown where it belongs to a package that is not installed."""

    def __init__(self, source_file: SomeSubstitutionsType) -> None:
        self.__source_file = normalize_to_list_of_substitutions(source_file)

    @property
    def name(self) -> list[Substitution]:
        """The file."""
        return self.__source_file

    def describe(self) -> str:
        """As the original."""
        return ""

    def perform(self, context: LaunchContext) -> str:
        """What is made of the file."""
        file = perform_substitutions(context, self.__source_file)
        if RECORD.is_unknown(file):
            return file
        if known_packages.is_in_shim(file):
            why = "the package is not installed"
            return RECORD.note_unknown(file, why, self.wsgen_location)
        return self._of(Path(file).read_text(encoding="utf-8"), file, context)

    def _of(self, text: str, file: str, context: LaunchContext) -> str:
        raise NotImplementedError


class HasNodeParams(_OfFile):
    """Either "True" or "False": whether a parameter file has a section of that name."""

    def __init__(self, source_file: SomeSubstitutionsType, node_name: str) -> None:
        super().__init__(source_file)
        self.__node_name = node_name

    def _of(self, text: str, file: str, context: LaunchContext) -> str:
        del file, context
        content = _load(text)
        return str(isinstance(content, dict) and self.__node_name in content)


class LaunchConfigAsBool(Substitution):
    """Either "True" or "False": what somebody said with `1`, `yes`, `on` or `true`, or did not."""

    def __init__(self, name: str) -> None:
        self.__configuration = LaunchConfiguration(name)

    def describe(self) -> str:
        """Itself in words."""
        return f"LaunchConfigAsBool({self.__configuration.describe()})"

    def perform(self, context: LaunchContext) -> str:
        """Whether it is true."""
        value = self.__configuration.perform(context)
        if RECORD.is_unknown(value):
            return value
        return str(value.strip().lower() in {"true", "1", "yes", "on"})


class ParseMultiRobotPose(Substitution):
    """Names and poses of robots: in an argument of the command line, given by its name, or a text.

    Releases differ in which of them it is.
    """

    def __init__(self, robots_argument: SomeSubstitutionsType) -> None:
        self.__argument = robots_argument

    def value(self) -> dict[str, dict[str, float]]:
        """What the command line says of the argument: a pose for each name."""
        start = f"{self.__argument}:="
        words = [word[len(start) :] for word in sys.argv[4:] if word.startswith(start)]
        return _poses(words[0]) if words else {}

    def perform(self, context: LaunchContext) -> Any:
        """What the text says: a pose for each name."""
        return _poses(
            perform_substitutions(context, normalize_to_list_of_substitutions(self.__argument))
        )


def _poses(text: str) -> dict[str, dict[str, float]]:
    """A pose for each of the robots in a text; what is not given of it is zero."""
    robots = [part.split("=") for part in text.split(";") if part.count("=") == 1]
    return {
        name.strip(): {
            **dict.fromkeys(("x", "y", "z", "roll", "pitch", "yaw"), 0.0),
            **_load(pose.strip()),
        }
        for name, pose in robots
    }


class ReplaceString(_OfFile):
    """A copy of a file with other texts in it, where the condition holds; else the file."""

    def __init__(
        self,
        source_file: SomeSubstitutionsType,
        replacements: Rewrites,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(source_file)
        self.__replacements = _normalized(replacements)
        self.__condition = condition

    @property
    def condition(self) -> Condition | None:
        """Whether anything is replaced."""
        return self.__condition

    def _of(self, text: str, file: str, context: LaunchContext) -> str:
        if self.__condition is not None and not self.__condition.evaluate(context):
            return file
        for old, new in _performed(context, self.__replacements).items():
            text = text.replace(old, new)
        return _write(text, file)


class RewrittenYaml(_OfFile):
    """A copy of a parameter file with other values and keys in it."""

    def __init__(  # noqa: PLR0913, PLR0917  as the original
        self,
        source_file: SomeSubstitutionsType,
        param_rewrites: Rewrites,
        root_key: SomeSubstitutionsType | None = None,
        key_rewrites: Rewrites | None = None,
        value_rewrites: Rewrites | None = None,
        convert_types: bool = False,  # noqa: FBT001, FBT002  as the original
        out_dir: SomeSubstitutionsType | None = None,
    ) -> None:
        super().__init__(source_file)
        del out_dir  # what is written ends with the evaluation
        self.__parameters = _normalized(param_rewrites)
        self.__root_key = normalize_to_list_of_substitutions(root_key or "")
        self.__keys = _normalized(key_rewrites or {})
        self.__values = _normalized(value_rewrites or {})
        self.__convert_types = convert_types

    def _of(self, text: str, file: str, context: LaunchContext) -> str:
        content = _load(text)
        parameters = {
            name: self._convert(value)
            for name, value in _performed(context, self.__parameters).items()
        }
        _set_by_name(content, parameters)
        _set_by_path(content, parameters)
        _rename(content, _performed(context, self.__keys))
        rewritten = {
            text: self._convert(new) for text, new in _performed(context, self.__values).items()
        }
        content = _mapped(content, lambda value: rewritten.get(str(value), value))
        root_key = perform_substitutions(context, self.__root_key)
        return _write(yaml.dump({root_key: content} if root_key else content), file)

    def _convert(self, text: str) -> Any:
        if self.__convert_types:
            try:
                return float(text) if "." in text else int(text)
            except ValueError:
                pass  # it is none of both
        return {"true": True, "false": False}.get(text.lower(), text)


def _load(text: str) -> Any:
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506  both are safe


def _write(text: str, original: str) -> str:
    with tempfile.NamedTemporaryFile(
        "w", dir=scratch_folder(), delete=False, encoding="utf-8"
    ) as file:
        file.write(text)
    original = os.path.abspath(original)
    RECORD.made[os.path.abspath(file.name)] = RECORD.made.get(original, original)
    return file.name


def _normalized(rewrites: Rewrites) -> dict[str, list[Substitution]]:
    # As the original, which an empty text serves as well as an empty dictionary.
    return {name: normalize_to_list_of_substitutions(rewrites[name]) for name in rewrites}


def _performed(
    context: LaunchContext, rewrites: Mapping[str, list[Substitution]]
) -> dict[str, str]:
    return {name: perform_substitutions(context, value) for name, value in rewrites.items()}


def _set_by_name(content: Any, values: Mapping[str, Any]) -> None:
    """Set what has one of the names, wherever it is; but nothing in lists."""
    for key, value in content.items() if isinstance(content, dict) else ():
        _set_by_name(value, values)
        if key in values:
            content[key] = values[key]


def _set_by_path(content: Any, values: Mapping[str, Any]) -> None:
    """Set what is at one of the paths, with dots; add it where the path names a section."""
    known = set(_paths(content, ()))
    for path, value in values.items():
        keys = path.split(".")
        if path in known or "ros__parameters" in keys:
            inside = content
            for key in keys[:-1]:
                inside = _inside(inside, key)
            inside[int(keys[-1]) if isinstance(inside, list) else keys[-1]] = value


def _inside(content: Any, key: str) -> Any:
    return content[int(key)] if isinstance(content, list) else content.setdefault(key, {})


def _paths(content: Any, keys: tuple[str, ...]) -> Iterator[str]:
    if isinstance(content, (dict, list)):
        items = content.items() if isinstance(content, dict) else enumerate(content)
        for key, value in items:
            yield from _paths(value, (*keys, str(key)))
    else:
        yield ".".join(keys)


def _rename(content: Any, names: Mapping[str, str]) -> None:
    for key, value in list(content.items()) if isinstance(content, dict) else ():
        if key in names:
            content[names[key]] = content.pop(key)
        _rename(value, names)


def _mapped(content: Any, function: Callable[[Any], Any]) -> Any:
    """The same with other leaves."""
    if isinstance(content, dict):
        return {key: _mapped(value, function) for key, value in content.items()}
    if isinstance(content, list):
        return [_mapped(value, function) for value in content]
    return function(content)
