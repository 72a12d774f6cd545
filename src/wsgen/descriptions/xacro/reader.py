"""Expand a xacro file in a child process, and report what is wrong if that fails."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.xacro.result import Expansion, ExpansionError, ExpansionRequest
from wsgen.diagnostics import Rule, Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.launching.launch_warnings import UNUSED_XACRO_ARGUMENT
from wsgen.packages.source_shares import name_sources

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.isolation.result import Answered


TASK = "wsgen.descriptions.xacro.expansion:expand_for_parent"
ANSWER: Any = Expansion | ExpansionError
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)

XACRO_FILE_FAILS = Rule(
    code="ROB071",
    name="xacro-file-fails",
    severity=Severity.ERROR,
    summary="`xacro` cannot expand the file.",
    why=("The launch file stops with the same error, and the robot is not spawned."),
    example=(
        '<xacro:property name="radius" value="0,1"/>\n'
        '<cylinder radius="${radius / 2}" length="0.1"/>'
    ),
    instead='<xacro:property name="radius" value="0.1"/>',
)


def expand_file(
    file: Path,
    arguments: Mapping[str, str],
    *,
    environment: Mapping[str, str],
    run: Run = parent.run,
) -> tuple[str | None, tuple[Diagnostic, ...]]:
    """The URDF that a xacro file expands to with these arguments; None where it does not.

    A xacro file may hold expressions that never end, and its expressions are Python: it is expanded
    in a child process with limits.
    """
    outcome = _expand(file, arguments, environment, run)
    if isinstance(outcome, Died):
        hint = outcome.hint("Check the file for an endless recursion or a huge expression.")
        error = ExpansionError(message=f"Expanding the file {outcome.reason}", hint=hint)
        return None, (_diagnostic(file, error),)
    answer: Expansion | ExpansionError = decode(name_sources(outcome.value, environment), ANSWER)
    if isinstance(answer, ExpansionError):
        return None, (_diagnostic(file, answer),)
    return answer.urdf, tuple(
        UNUSED_XACRO_ARGUMENT.at(
            file, element=unused.name, message=unused.message, hint=unused.hint
        )
        for unused in answer.unused
    )


def read_arguments(
    file: Path,
    arguments: Mapping[str, str],
    *,
    environment: Mapping[str, str],
    run: Run = parent.run,
) -> Mapping[str, str]:
    """The `<xacro:arg>`s of a file and of what it includes, with the values that they then have.

    They are those that an expansion with these arguments comes by; none where that fails.
    """
    outcome = _expand(file, arguments, environment, run)
    if isinstance(outcome, Died):
        return {}
    answer: Expansion | ExpansionError = decode(name_sources(outcome.value, environment), ANSWER)
    return answer.arguments if isinstance(answer, Expansion) else {}


def _expand(
    file: Path, arguments: Mapping[str, str], environment: Mapping[str, str], run: Run
) -> Answered | Died:
    return run(
        TASK,
        ExpansionRequest(file=str(file.absolute()), arguments=dict(arguments)),
        limits=LIMITS,
        environment=environment,
        folder=file.parent,
    )


def _diagnostic(file: Path, error: ExpansionError) -> Diagnostic:
    message = error.message.rstrip(".")
    hint = error.hint or "Set arguments of the file with --arg name:=value."
    if "AMENT_PREFIX_PATH" in message:
        hint = "Build and source a workspace that contains the packages of $(find …)."
        message = "a package of $(find …) was not found: no workspace is sourced"
    return XACRO_FILE_FAILS.at(
        Path(error.file) if error.file else file,
        error.line,
        error.element,
        message=f"xacro cannot expand the file: {message}.",
        hint=hint,
    )
