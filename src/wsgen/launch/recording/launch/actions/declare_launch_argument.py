"""An argument of a launch file."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.substitutions.text_substitution import TextSubstitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType
    from launch.substitution import Substitution


class DeclareLaunchArgument(Action):
    """Sets its configuration to the default, unless it is set already."""

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: Iterable[str] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__name = name
        self.__description = description
        self.__default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )
        self.__choices = None if choices is None else list(choices)
        if self.__choices is not None:
            if not self.__choices:
                raise ValueError("Provided choices arg is empty.")
            default = _literal(self.__default_value)
            if default is not None and default not in self.__choices:
                raise ValueError(
                    f'Provided default_value "{default}" is not in provided choices '
                    f'"{self.__choices}".'
                )
        self.conditionally_included = False

    @property
    def name(self) -> str:
        """Its name."""
        return self.__name

    @property
    def default_value(self) -> list[Substitution] | None:
        """What it is where nothing is given."""
        return self.__default_value

    @property
    def choices(self) -> list[str] | None:
        """The only values that are allowed."""
        return self.__choices

    @property
    def description(self) -> str:
        """What it is for, with its choices."""
        if self.__choices is None:
            return "no description given" if self.__description is None else self.__description
        if self.__description is None:
            return f"One of: {self.__choices}"
        return f"{self.__description.rstrip('.')}. Valid choices are: {self.__choices}"

    def execute(self, context: LaunchContext) -> None:
        """Set the configuration if it is not set."""
        configurations = context.launch_configurations
        if self.__name not in configurations:
            if self.__default_value is None:
                raise RuntimeError(
                    f"Required launch argument '{self.__name}' (description: "
                    f"'{self.description}') was not provided"
                )
            configurations[self.__name] = perform_substitutions(context, self.__default_value)
            self._note(configurations[self.__name], configurations[self.__name])
        else:
            self._note(_words(self.__default_value), configurations[self.__name])
        value = configurations[self.__name]
        if self.__choices is not None and value not in self.__choices:
            raise RuntimeError(
                f'Argument "{self.__name}" provided value "{value}" is not valid. '
                f"Valid options are: {self.__choices}"
            )

    def _note(self, default: str | None, value: str) -> None:
        if self.wsgen_location is not None:  # the stand-ins' arguments are nobody's
            RECORD.arguments.setdefault(
                self.__name,
                {
                    "name": self.__name,
                    "default": default,
                    "value": str(value),
                    "description": "" if self.__description is None else str(self.__description),
                },
            )


def _literal(default: list[Substitution] | None) -> str | None:
    """The default where it is one plain text."""
    if default is not None and all(isinstance(part, TextSubstitution) for part in default):
        return "".join(part.text for part in default if isinstance(part, TextSubstitution))
    return None


def _words(default: list[Substitution] | None) -> str | None:
    """The default, in words where it is not needed and may not be known."""
    if default is None:
        return None
    literal = _literal(default)
    if literal is not None:
        return literal
    words: list[str] = []
    for is_text, parts in itertools.groupby(
        default, key=lambda part: isinstance(part, TextSubstitution)
    ):
        if is_text:
            text = _literal(list(parts))
            words += [repr(text)] if text else []
        else:
            words += [part.describe() for part in parts]
    return " + ".join(words)
