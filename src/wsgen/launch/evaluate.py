"""Evaluate a launch file without ROS, in a child process."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.model.plan import LaunchPlan, LaunchRequest
from wsgen.source_shares import name_sources

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run


TAKES_TOO_LONG = Rule(
    code="LCH012",
    name="launch-takes-too-long",
    severity=Severity.ERROR,
    summary="The evaluation of the launch file does not end in time.",
    what="Limits the evaluation to 30 s of CPU time and 300 s of wall-clock time.",
    why="`ros2 launch` would hang in the launch file and start nothing.",
    example="while not os.path.exists(path):\n    pass",
    instead="RegisterEventHandler(OnProcessExit(target_action=converter, on_exit=[spawner]))",
)
PROCESS_DIES = Rule(
    code="LCH013",
    name="launch-crashes",
    severity=Severity.ERROR,
    summary="The process that evaluates the launch file ends without an answer.",
    what="Looks for crashes, and for more than 64 MB of output or 2 GiB of memory.",
    why="`ros2 launch` runs the same code in its own process, and would end in the same way.",
    example="os._exit(3)",
    instead="raise RuntimeError('The model has no meshes.')",
)
TASK = "wsgen.tasks.launch:evaluate_launch"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)


def evaluate(  # noqa: PLR0913  all but two have defaults
    launch_file: Path,
    *,
    package: str | None,
    arguments: Mapping[str, str],
    environment: Mapping[str, str],
    answers: Callable[[], Sequence[str]] = tuple,
    only_arguments: bool = False,
    with_origins: bool = False,
    limits: Limits = LIMITS,
    task: str = TASK,
    run: Run = parent.run,
) -> LaunchPlan:
    """What the launch file would start if `ros2 launch` played it with these arguments.

    A launch file is a program, and evaluating it runs it: in a child process, with these limits,
    and nothing it describes is started. `environment` is that of the sourced workspace. With
    `only_arguments` it is loaded and not played, and the plan holds the arguments that it and
    what it includes declare, their defaults in the words of `ros2 launch --show-args`. With
    `with_origins` it says where everything is written, and which files were read. `answers` is
    called only if the launch file asks for input; it is then evaluated again, with them. `task`
    names the function that the child calls, and `run` starts it. Mistakes in the launch file, or
    in what it includes, are diagnostics of the plan; nothing is raised for them.
    """
    request = LaunchRequest(
        launch_file=launch_file.absolute(),
        package=package,
        arguments=dict(arguments),
        only_arguments=only_arguments,
        with_origins=with_origins,
    )

    def play(request: LaunchRequest) -> LaunchPlan:
        outcome = run(task, request, limits=limits, environment=_complete(environment))
        if isinstance(outcome, Died):
            return LaunchPlan(
                package=package,
                launch_file=launch_file,
                diagnostics=(_death(outcome, launch_file),),
                is_complete=False,
            )
        answer = name_sources(outcome.value, environment)
        decoded = decode(answer, LaunchPlan)
        # The folder of the links to sources has another name each time.
        files = tuple(sorted(decoded.files, key=lambda file: file.path))
        return replace(decoded, launch_file=launch_file, files=files)

    plan = play(request)
    given = tuple(answers()) if plan.unanswered else ()
    return play(replace(request, answers=given)) if given else plan


DISTRO_OF_LAUNCHES = "iron"  # where neither the environment nor a target says another one


def _complete(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment with what a sourced ROS always has."""
    return {
        "ROS_DISTRO": DISTRO_OF_LAUNCHES,
        "ROS_VERSION": "2",
        "ROS_PYTHON_VERSION": "3",
        **environment,
    }


def _death(died: Died, launch_file: Path) -> Diagnostic:
    if died.cause in ("cpu time", "wall-clock time"):
        return TAKES_TOO_LONG.at(
            launch_file,
            message=f"Evaluating the launch file {died.reason}.",
            hint=died.hint("Look for a loop that never ends; a launch file only describes."),
        )
    return PROCESS_DIES.at(
        launch_file,
        message=f"Evaluating the launch file stopped: it {died.reason}.",
        hint=died.hint(
            f"Its last words: {died.output[-400:]}" if died.output else "It printed nothing."
        ),
    )
