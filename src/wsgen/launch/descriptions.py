"""Where the description of a spawned robot comes from: a topic, a file, a parameter, a text."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.launch.faults import fault, or_loose
from wsgen.launch.known_packages import SURELY
from wsgen.suggestions import advice, nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process

PUBLISHER = "robot_state_publisher"
PARAMETER = "robot_description"


def find_description(
    plan: LaunchPlan, spawner: Process, options: Mapping[str, str]
) -> tuple[str, Path | None] | Diagnostic:
    """The text of the robot and the file it is in, where that is known."""
    if "topic" in options:
        return _from_topic(plan, spawner, options["topic"])
    if "file" in options:
        return _from_file(spawner, options["file"])
    if "string" in options:
        return options["string"], spawner.description_file
    if "param" in options:
        return _from_parameter(spawner, options["param"])
    if "database" in options:
        return fault(
            "SPN006",
            spawner,
            f"-database {options['database']} takes a model from Gazebo's own folders, which are "
            "not here.",
            "Use -file with the model's file, or -topic robot_description.",
        )
    return fault(
        "SPN007",
        spawner,
        f"{spawner.executable} reads the robot from standard input, and nothing writes to it.",
        "Use '-topic', 'robot_description' instead of -stdin.",
    )


def resolve(topic: str, process: Process) -> str:
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


def _from_topic(
    plan: LaunchPlan, spawner: Process, topic: str
) -> tuple[str, Path | None] | Diagnostic:
    wanted = resolve(topic, spawner)
    published: dict[str, Process] = {}
    for process in plan.processes:
        if process.executable == PUBLISHER:
            published.setdefault(resolve(PARAMETER, process), process)
    if wanted in published:
        return _published(published[wanted])
    others = ", ".join(published) or "nothing, as it starts no robot_state_publisher"
    missing = fault(
        "SPN008",
        spawner,
        f"{spawner.executable} waits for the topic {wanted}, and no robot_state_publisher "
        f"publishes it; the launch file publishes {others}.",
        advice(
            wanted,
            published,
            "Start robot_state_publisher in the same namespace, with the parameter "
            "robot_description, or correct -topic.",
        ),
    )
    return missing if published else or_loose(missing, plan, "Node", names={PUBLISHER})


def _published(publisher: Process) -> tuple[str, Path | None] | Diagnostic:
    """The text of a publisher: its parameter, or the file that is its argument."""
    if PARAMETER not in publisher.parameters and publisher.arguments:
        return _from_file(publisher, publisher.arguments[0])
    if PARAMETER not in publisher.parameters:
        misspelt = nearest(PARAMETER, publisher.parameters, cutoff=SURELY)
        return fault(
            "SPN009",
            publisher,
            "robot_state_publisher is not given the parameter robot_description"
            + (f" but `{misspelt}`." if misspelt else "."),
            f"Rename `{misspelt}` to `robot_description`."
            if misspelt
            else "Add parameters=[{'robot_description': ...}] to the Node.",
        )
    return _text(publisher, publisher.parameters[PARAMETER])


def _from_parameter(spawner: Process, name: str) -> tuple[str, Path | None] | Diagnostic:
    if name not in spawner.parameters:
        return fault(
            "SPN010",
            spawner,
            f"{spawner.executable} reads the parameter '{name}', which it is not given.",
            f"Add parameters=[{{'{name}': ...}}] to the Node, or use -topic robot_description.",
        )
    return _text(spawner, spawner.parameters[name])


def _text(process: Process, value: Any) -> tuple[str, Path | None] | Diagnostic:
    if isinstance(value, str) and value.lstrip().startswith("<"):
        return value, process.description_file
    if isinstance(value, str) and not value.strip():
        what = "is empty"
    else:
        what = f"is no robot: '{str(value)[:60]}'"
    return fault(
        "SPN011",
        process,
        f"The robot_description {what}.",
        "Give it the text of the URDF, not its path: "
        "ParameterValue(Command(['xacro ', path]), value_type=str).",
    )


def _from_file(process: Process, path: str) -> tuple[str, Path | None] | Diagnostic:
    if path.lstrip().startswith("<"):
        return path, process.description_file
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        return fault(
            "SPN012",
            process,
            f"The file to spawn cannot be read: '{path}': {reason}.",
            "Check the path, and that CMakeLists.txt installs its folder.",
        )
    return text, Path(path)
