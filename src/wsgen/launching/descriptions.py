"""Find the description that a spawner is given: from a topic, a file, a parameter or a text."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.launching import known_packages
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.launching.explain_missing import PACKAGE_NOT_FOUND, absolute_part, or_unused_action
from wsgen.launching.known_packages import SURELY
from wsgen.launching.simulators import PACKAGES_OF_GAZEBO, find_simulator
from wsgen.model.plan import STARTS_UNKNOWN
from wsgen.text.files import after_scheme, read_regular_text
from wsgen.text.suggestions import advice, nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.model.plan import LaunchPlan, Process


NO_DESCRIPTION_SOURCE = Rule(
    code="SPN007",
    name="no-description-source",
    severity=Severity.ERROR,
    summary="The spawner reads the robot from its standard input.",
    why="`launch` connects nothing to the standard input of a process, so the spawner waits "
    "forever.",
    example="arguments=['-stdin', '-entity', 'my_robot']",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot']",
)
UNPUBLISHED_DESCRIPTION = Rule(
    code="SPN008",
    name="unpublished-description",
    severity=Severity.ERROR,
    severity_varies="a warning where a part that is not evaluated may publish it and another "
    "robot is simulated",
    summary="No `robot_state_publisher` publishes the topic that the spawner reads.",
    what="Compares the topic of the spawner with those of every `robot_state_publisher`, with "
    "namespaces and remappings.",
    why="The spawner waits forever for the topic, and the robot does not appear.",
    example="arguments=['-topic', 'robot', '-entity', 'my_robot']",
    instead="arguments=['-topic', 'robot_description', '-entity', 'my_robot']",
)
PUBLISHER_WITHOUT_DESCRIPTION = Rule(
    code="SPN009",
    name="publisher-without-description",
    severity=Severity.ERROR,
    summary="`robot_state_publisher` has no parameter `robot_description`.",
    why="`robot_state_publisher` ends with an error, and the spawner waits forever for the topic.",
    example="Node(package='robot_state_publisher', executable='robot_state_publisher')",
    instead="Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': text}])",
)
MISSING_SPAWN_PARAMETER = Rule(
    code="SPN010",
    name="missing-spawn-parameter",
    severity=Severity.ERROR,
    summary="The spawner reads the robot from a parameter that is not set.",
    why="The spawner finds no description and ends with an error.",
    example="Node(package='ros_gz_sim', executable='create',\n"
    "     arguments=['-param', 'robot_description'])",
    instead="Node(package='ros_gz_sim', executable='create',\n"
    "     arguments=['-param', 'robot_description'],\n"
    "     parameters=[{'robot_description': text}])",
)
DESCRIPTION_NOT_TEXT = Rule(
    code="SPN011",
    name="description-not-text",
    severity=Severity.ERROR,
    summary="The robot description is not the text of a URDF or SDF.",
    why="`robot_state_publisher` and the spawners parse the value as XML, and end with an error "
    "for a path or an empty text.",
    example="parameters=[{'robot_description': os.path.join(share, 'model', 'robot.xacro')}]",
    instead="parameters=[{'robot_description': ParameterValue(\n"
    "    Command(['xacro ', path]), value_type=str)}]",
)
UNREADABLE_SPAWN_FILE = Rule(
    code="SPN012",
    name="unreadable-spawn-file",
    severity=Severity.ERROR,
    summary="The file to spawn cannot be read.",
    why="The spawner, or `robot_state_publisher`, ends with an error, and no robot appears.",
    example="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch model DESTINATION share/${PROJECT_NAME})",
)
UNKNOWN_DESCRIPTION = Rule(
    code="SPN091",
    name="unknown-description",
    severity=Severity.WARNING,
    severity_varies="an error where no other robot is simulated",
    summary="The spawned robot is known only where ROS 2 is installed.",
    what="Looks for values of packages that are not installed and outputs of commands that are not "
    "run, in what a spawner is given.",
    why="The robot is not simulated.",
    example="parameters=[{'robot_description': Command(['ros2 run my_robot make_urdf'])}]",
    instead="parameters=[{'robot_description': Command(['xacro ', path])}]",
)


class Description(NamedTuple):
    """What is spawned: a text, or the address of a model that Gazebo looks up."""

    text: str = ""
    file: Path | None = None  # that the text is in, where that is known
    model_uri: str | None = None


PUBLISHER = "robot_state_publisher"
PARAMETER = "robot_description"
_MODEL_NAME = lazy_pattern(r"[\w-]+(/[\w-]+)*")  # of Gazebo Sim, which opens it like model://NAME
_SCHEMES = ("model://", "https://", "http://", "package://")


def find_description(
    plan: LaunchPlan, spawner: Process, options: Mapping[str, str]
) -> Description | Diagnostic:
    """What the options of a spawner say that it spawns."""
    source = next((name for name in _READERS if name in options), None)
    if source is None:
        return report_at(
            NO_DESCRIPTION_SOURCE,
            spawner,
            f"{spawner.executable} reads the robot from standard input, but launch does not "
            f"write to it.",
            "Use '-topic', 'robot_description' instead of -stdin.",
        )
    if not options[source].lstrip().startswith("<") and plan.is_unknown(options[source]):
        return _unknown(spawner, options[source])
    return _READERS[source](plan, spawner, options[source])


def published_descriptions(plan: LaunchPlan) -> dict[str, Process]:
    """The first process that publishes a description on each topic."""
    published: dict[str, Process] = {}
    for program in started_programs(plan):
        if program.executable == PUBLISHER:
            published.setdefault(_resolve(PARAMETER, program), program)
    return published


def read_published(plan: LaunchPlan, publisher: Process) -> Description | Diagnostic:
    """The text of a publisher: its parameter, or the file that is its argument."""
    if PARAMETER not in publisher.parameters and publisher.arguments:
        return read_spawned_file(plan, publisher, publisher.arguments[0])
    if PARAMETER not in publisher.parameters:
        misspelled = nearest(PARAMETER, publisher.parameters, cutoff=SURELY)
        return report_at(
            PUBLISHER_WITHOUT_DESCRIPTION,
            publisher,
            "robot_state_publisher is not given the parameter robot_description"
            + (f" but `{misspelled}`." if misspelled else "."),
            f"Rename `{misspelled}` to `robot_description`."
            if misspelled
            else "Add parameters=[{'robot_description': ...}] to the Node.",
        )
    return _text(plan, publisher, publisher.parameters[PARAMETER])


def read_spawned_file(plan: LaunchPlan, process: Process, path: str) -> Description | Diagnostic:
    """What a spawner takes as a file: one, the text itself, or the address of a model."""
    if path.lstrip().startswith("<"):
        return Description(path, process.description_file)
    written = str(Path(path).absolute())
    if written in plan.written:
        return Description(plan.written[written], Path(plan.written_from.get(written, path)))
    if plan.is_unknown(path):
        return _unknown(process, path)
    if path.startswith(_SCHEMES):
        return Description(model_uri=path)
    try:
        file = Path(after_scheme(path.removeprefix("file://")))
        text = read_regular_text(file)
    except (OSError, UnicodeDecodeError, ValueError) as error:
        return _unreadable(plan, process, path, error)
    return Description(text, file)


def _unreadable(plan: LaunchPlan, process: Process, path: str, error: Exception) -> Diagnostic:
    """Report a file to spawn that cannot be read."""
    absolute = absolute_part(path, plan.evaluated_files)
    if absolute is not None:
        return UNREADABLE_SPAWN_FILE.at(
            Path(absolute.file),
            absolute.line,
            absolute.text,
            message=f"The file to spawn, '{path}', does not exist: {absolute.message}",
            hint=absolute.hint,
        )
    package = known_packages.absent_package_of(path)
    if package is not None:
        return report_at(
            PACKAGE_NOT_FOUND,
            process,
            f"The file to spawn is in the package '{package}', which was not found: '{path}'.",
            f"Build {package} in this workspace, or source an installation that has it.",
        )
    reason = getattr(error, "strerror", None) or "it is not text in UTF-8"
    return report_at(
        UNREADABLE_SPAWN_FILE,
        process,
        f"The file to spawn cannot be read: '{path}': {reason}.",
        "Check the path, and that CMakeLists.txt installs its folder.",
    )


def _from_file(plan: LaunchPlan, spawner: Process, path: str) -> Description | Diagnostic:
    """What `-file` names; that of Gazebo Sim may name a model, which is a folder."""
    if spawner.executable == "create":
        if os.path.isdir(path):
            return Description(model_uri=path)
        if _MODEL_NAME.fullmatch(path) and not os.path.exists(path):
            return Description(model_uri=f"model://{path}")
    return read_spawned_file(plan, spawner, path)


def _resolve(topic: str, process: Process) -> str:
    """The absolute name of a topic as a process means it, remappings included."""
    absolute = _absolute(topic, process)
    for source, target in process.remappings:
        if _absolute(source, process) == absolute:
            return _absolute(target, process)
    return absolute


def _absolute(topic: str, process: Process) -> str:
    if topic.startswith("/"):
        return topic
    if topic.startswith("~/"):
        name = process.name or process.executable or ""
        return f"{process.namespace.rstrip('/')}/{name}{topic[1:]}"
    return f"{process.namespace.rstrip('/')}/{topic}"


def _from_topic(plan: LaunchPlan, spawner: Process, topic: str) -> Description | Diagnostic:
    wanted = _resolve(topic, spawner)
    published = published_descriptions(plan)
    if wanted in published:
        return read_published(plan, published[wanted])
    others = ", ".join(published) or "nothing, as it does not start robot_state_publisher"
    may_be_elsewhere = not published and _may_publish_elsewhere(plan)
    missing = UNPUBLISHED_DESCRIPTION.at(
        spawner.file,
        spawner.line,
        spawner.executable,
        message=f"{spawner.executable} waits for the topic {wanted}, and no robot_state_publisher "
        f"publishes it; the launch file publishes {others}.",
        hint=advice(
            wanted,
            published,
            "Start robot_state_publisher in the same namespace, with the parameter "
            "robot_description, or correct -topic.",
        ),
        severity=Severity.WARNING if may_be_elsewhere else None,
    )
    return missing if published else or_unused_action(missing, plan, "Node", names={PUBLISHER})


def _may_publish_elsewhere(plan: LaunchPlan) -> bool:
    """Whether the launch file is run beside others, or with one that is not evaluated."""
    if any(one.why == STARTS_UNKNOWN for one in plan.unresolved):
        return True
    not_evaluated = (one for one in started_launch_files(plan) if not one.evaluated)
    return find_simulator(plan)[0] is None or any(
        not (one.package or "").startswith(PACKAGES_OF_GAZEBO) for one in not_evaluated
    )


def _from_parameter(plan: LaunchPlan, spawner: Process, name: str) -> Description | Diagnostic:
    if name not in spawner.parameters:
        return report_at(
            MISSING_SPAWN_PARAMETER,
            spawner,
            f"{spawner.executable} reads the parameter '{name}', which it is not given.",
            f"Add parameters=[{{'{name}': ...}}] to the Node, or use -topic robot_description.",
        )
    return _text(plan, spawner, spawner.parameters[name])


def _text(plan: LaunchPlan, process: Process, value: Any) -> Description | Diagnostic:
    if isinstance(value, str) and value.lstrip().startswith("<"):
        return Description(value, process.description_file)
    if plan.is_unknown(str(value)):
        return _unknown(process, str(value))
    if isinstance(value, str) and not value.strip():
        what = "is empty"
    else:
        what = f"is not the text of a robot: '{str(value)[:60]}'"
    return report_at(
        DESCRIPTION_NOT_TEXT,
        process,
        f"The robot_description {what}.",
        "Give it the text of the URDF, not its path: "
        "ParameterValue(Command(['xacro ', path]), value_type=str).",
    )


# The first of them that a spawner is given counts.
_READERS: dict[str, Callable[[LaunchPlan, Process, str], Description | Diagnostic]] = {
    "file": _from_file,
    "param": _from_parameter,
    "string": lambda _, spawner, text: Description(text, spawner.description_file),
    "topic": _from_topic,
    "database": lambda _, __, name: Description(model_uri=f"model://{name}"),
}


def _unknown(process: Process, value: str) -> Diagnostic:
    return report_at(
        UNKNOWN_DESCRIPTION,
        process,
        f"{process.executable} is given '{value[:60]}', which is known only where ROS 2 is "
        "installed: the robot is not simulated.",
        "Simulate its description alone: wsgen validate FILE",
    )


def report_at(rule: Rule, process: Process, message: str, hint: str) -> Diagnostic:
    """At the line of the launch file that describes the process."""
    return rule.at(process.file, process.line, process.executable, message=message, hint=hint)
