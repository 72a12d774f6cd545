"""Evaluate a launch file without ROS, in a child process."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.outcome import Died, Limits
from wsgen.launch import codes
from wsgen.model.plan import Include, LaunchArgument, LaunchPlan, Process, Unresolved

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.isolation.parent import Run


TASK = "wsgen.tasks.launch:evaluate_launch"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)


def evaluate(  # noqa: PLR0913  all but two have defaults
    launch_file: Path,
    *,
    package: str | None,
    arguments: Mapping[str, str],
    environment: Mapping[str, str],
    only_arguments: bool = False,
    limits: Limits = LIMITS,
    task: str = TASK,
    run: Run = parent.run,
) -> LaunchPlan:
    """What the launch file would start if `ros2 launch` played it with these arguments.

    A launch file is a program, and evaluating it runs it: in a child process, with these limits,
    and nothing it describes is started. `environment` is that of the sourced workspace. With
    `only_arguments` it is loaded and not played, and the plan holds the arguments that it and
    what it includes declare, their defaults in the words of `ros2 launch --show-args`. `task`
    names the function that the child calls, and `run` starts it. Whatever is wrong with the launch
    file, or with what it includes, is in the diagnostics of the plan; nothing is raised for it.
    """
    outcome = run(
        task,
        str(launch_file.absolute()),
        package,
        dict(arguments),
        only_arguments,
        limits=limits,
        environment=_complete(environment),
    )
    if isinstance(outcome, Died):
        return LaunchPlan(
            package=package, launch_file=launch_file, diagnostics=(_death(outcome, launch_file),)
        )
    return _read(outcome.value, package, launch_file)


def _complete(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment with what a sourced ROS always has."""
    return {
        "ROS_DISTRO": "iron",
        "ROS_VERSION": "2",
        "ROS_PYTHON_VERSION": "3",
        **environment,
    }


def _death(died: Died, launch_file: Path) -> Diagnostic:
    if died.cause in ("cpu time", "wall-clock time"):
        return Diagnostic(
            code=codes.TAKES_TOO_LONG,
            severity=Severity.ERROR,
            message=f"Evaluating the launch file {died.reason}.",
            file=launch_file,
            hint=died.hint("Look for a loop that never ends; a launch file only describes."),
        )
    return Diagnostic(
        code=codes.PROCESS_DIES,
        severity=Severity.ERROR,
        message=f"Evaluating the launch file stopped: it {died.reason}.",
        file=launch_file,
        hint=died.hint(
            f"Its last words: {died.output[-400:]}" if died.output else "It said nothing."
        ),
    )


def _read(answer: dict[str, Any], package: str | None, launch_file: Path) -> LaunchPlan:
    """The plan from what the child answered."""
    return LaunchPlan(
        package=package,
        launch_file=launch_file,
        arguments=tuple(LaunchArgument(**entry) for entry in answer["arguments"]),
        processes=tuple(_process(entry) for entry in answer["processes"]),
        includes=tuple(
            Include(**{**entry, "file": Path(entry["file"])}) for entry in answer["includes"]
        ),
        environment=answer["environment"],
        unresolved=tuple(Unresolved(**_with_path(entry)) for entry in answer["unresolved"]),
        diagnostics=tuple(
            Diagnostic(**{**_with_path(entry), "severity": Severity(entry["severity"])})
            for entry in answer["diagnostics"]
        ),
        seconds_in_xacro=answer["seconds_in_xacro"],
    )


def _process(entry: dict[str, Any]) -> Process:
    command, description_file = entry["command"], entry.get("description_file")
    return Process(
        **{
            **_with_path(entry),
            "arguments": tuple(entry["arguments"]),
            "configurations": tuple(entry.get("configurations", ())),
            "remappings": tuple((source, target) for source, target in entry["remappings"]),
            "command": None if command is None else tuple(command),
            "description_file": None if description_file is None else Path(description_file),
        }
    )


def _with_path(entry: dict[str, Any]) -> dict[str, Any]:
    file = entry["file"]
    return {**entry, "file": None if file is None else Path(os.fspath(file))}
