"""What a command prints."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch import commands

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType
    from wsgen.launch.record import CommandOutcome


class Command(Substitution):
    """The standard output of a command line, which is split as a shell splits it.

    Only xacro and a few harmless commands have an output here; see `wsgen.launch.commands`.
    """

    def __init__(
        self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail"
    ) -> None:
        self.__command = normalize_to_list_of_substitutions(command)
        self.__on_stderr = normalize_to_list_of_substitutions(on_stderr)

    @property
    def command(self) -> list[Substitution]:
        """The command line."""
        return self.__command

    @property
    def on_stderr(self) -> list[Substitution]:
        """What is done about output on standard error."""
        return self.__on_stderr

    def describe(self) -> str:
        """Itself in words."""
        return f"Command({' + '.join(sub.describe() for sub in self.__command)})"

    def perform(self, context: LaunchContext) -> str:
        """The output, with its last line break."""
        line = perform_substitutions(context, self.__command)
        on_stderr = perform_substitutions(context, self.__on_stderr)
        if on_stderr not in {"fail", "ignore", "warn", "capture"}:
            raise SubstitutionFailure(
                "expected 'on_stderr' to be one of: 'fail', 'ignore', 'warn', and 'capture', "
                f"but got '{on_stderr}'"
            )
        outcome = commands.run(shlex.split(line), self.wsgen_location)
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
    failure.wsgen_outcome = outcome  # type: ignore[attr-defined]  # says which file is wrong
    return failure
