"""A program with arguments."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

from launch.actions.execute_local import ExecuteLocal
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType
    from launch.substitution import Substitution


class ExecuteProcess(ExecuteLocal):
    """A command line; each item of `cmd` is one word."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.cmd = [normalize_to_list_of_substitutions(word) for word in cmd]
        self.__prefix = None if prefix is None else normalize_to_list_of_substitutions(prefix)
        self.__name = None if name is None else normalize_to_list_of_substitutions(name)
        self.__cwd = None if cwd is None else normalize_to_list_of_substitutions(cwd)
        self.__environment = _variables({**(env or {}), **(additional_env or {})})

    @property
    def name(self) -> Any:
        """What the process is called."""
        return self.__name

    def prepare(self, context: LaunchContext) -> dict[str, Any]:
        """Perform the words."""
        prefix = self.__prefix
        if prefix is None:
            words = shlex.split(context.launch_configurations.get("launch-prefix", ""))
        else:
            words = shlex.split(perform_substitutions(context, prefix))
        words += [perform_substitutions(context, word) for word in self.cmd]
        if self.__cwd is not None:
            perform_substitutions(context, self.__cwd)
        name = None if self.__name is None else perform_substitutions(context, self.__name)
        return {
            "package": None,
            "executable": None,
            "name": name,
            "namespace": "",
            "parameters": {},
            "arguments": [],
            "remappings": [],
            "command": words,
            "environment": {
                **RECORD.changed_environment(),
                **{
                    perform_substitutions(context, name): perform_substitutions(context, value)
                    for name, value in self.__environment
                },
            },
        }


def _variables(
    variables: Mapping[Any, Any],
) -> list[tuple[list[Substitution], list[Substitution]]]:
    return [
        (normalize_to_list_of_substitutions(name), normalize_to_list_of_substitutions(value))
        for name, value in variables.items()
    ]
