"""What the launch files of Gazebo's packages start, which are not installed.

They are those of gazebo_ros_pkgs (ros2) and ros_gz (jazzy).
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

from wsgen.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from wsgen.model.plan import Include


def entities_of(include: Include) -> list[Any] | None:
    """What is visited in the place of a launch file; None where it is not known."""
    files = _LAUNCH_FILES.get(include.package or "", {})
    read = files.get(include.file.name.partition(".")[0])
    if read is None:
        return None
    return list(read({**include.arguments, **include.configurations}))


def _is_true(text: str) -> bool:
    return text.strip().lower() in {"true", "1"}


def _process(words: list[str], *, is_required: bool, name: str | None = None) -> Any:
    """A process of a command line; where it is required, its end is that of the launch."""
    from launch.actions import ExecuteProcess, Shutdown  # noqa: PLC0415  the shim's

    on_exit = Shutdown() if is_required else None
    return ExecuteProcess(cmd=words, name=name, output="screen", on_exit=on_exit)


def _node(package: str, executable: str, **keywords: Any) -> Any:
    from launch_ros.actions import Node  # noqa: PLC0415  the shim's

    return Node(package=package, executable=executable, output="screen", **keywords)


def _gazebo(values: Mapping[str, str]) -> Iterator[Any]:
    if _is_true(values.get("server", "true")):
        yield from _gzserver(values)
    if _is_true(values.get("gui", "true")):
        yield from _gzclient(values)


def _gzserver(values: Mapping[str, str]) -> Iterator[Any]:
    paused = ["--pause"] if _is_true(values.get("pause", "false")) else []
    words = ["gzserver", values.get("world", ""), *paused, *_ros_arguments(values)]
    yield _process(words, is_required=_is_true(values.get("server_required", "false")))


def _ros_arguments(values: Mapping[str, str]) -> list[str]:
    """Parameters of Gazebo's nodes, such as `publish_rate`: a file, or among other arguments."""
    file, extra = values.get("params_file", ""), values.get("extra_gazebo_args", "")
    words = ["--ros-args", "--params-file", file, "--"] if file else []
    try:
        return [*words, *shlex.split(extra)]
    except ValueError:  # a quotation mark without its other one
        return [*words, *extra.split()]


def _gzclient(values: Mapping[str, str]) -> Iterator[Any]:
    yield _process(["gzclient"], is_required=_is_true(values.get("gui_required", "false")))


def _gz_sim(values: Mapping[str, str]) -> Iterator[Any]:
    name = "gz_args" if values.get("gz_args") else "ign_args"
    text = values.get(name, "")
    try:
        words = shlex.split(text)
    except ValueError:
        raise RequestError(
            f"{name} has a quotation mark without its other one: {text}",
            hint="Write both, or none: the shell that starts Gazebo Sim refuses it, too.",
        ) from None
    is_required = _is_true(values.get("on_exit_shutdown", "false"))
    yield _process(["gz", "sim", *words], is_required=is_required, name="gazebo")


def _gz_server(values: Mapping[str, str]) -> Iterator[Any]:
    world = values.get("world_sdf_file", "")
    yield _node("ros_gz_sim", "gzserver", parameters=[{"world_sdf_file": world}])


def _gz_spawn_model(values: Mapping[str, str]) -> Iterator[Any]:
    names = {
        "world": "world",
        "file": "file",
        "model_string": "string",
        "topic": "topic",
        "entity_name": "name",
    }
    parameters: dict[str, Any] = {
        parameter: values.get(argument, "") for argument, parameter in names.items()
    }
    parameters["allow_renaming"] = _is_true(values.get("allow_renaming", "false"))
    for axis in ("x", "y", "z", "R", "P", "Y"):
        parameters[axis] = _number(axis, values.get(axis) or "0.0")
    yield _node("ros_gz_sim", "create", parameters=[parameters])


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise RequestError(
            f"{name} is `{text}`, which is not a number.",
            hint="Give meters, and radians for R, P and Y.",
        ) from None


def _bridge(values: Mapping[str, str]) -> Iterator[Any]:
    yield _node(
        "ros_gz_bridge",
        "bridge_node",
        name=values.get("bridge_name") or None,
        namespace=values.get("namespace") or None,
        parameters=[{"config_file": values.get("config_file", "")}],
        respawn=_is_true(values.get("use_respawn", "false")),
    )


def _server_and_bridge(values: Mapping[str, str]) -> Iterator[Any]:
    yield from _gz_server(values)
    yield from _bridge(values)


def _model_and_bridge(values: Mapping[str, str]) -> Iterator[Any]:
    yield from _bridge(values)
    yield from _gz_spawn_model(values)


# Package -> launch file, without what follows its first dot -> what it starts.
_LAUNCH_FILES: dict[str, dict[str, Callable[[Mapping[str, str]], Iterator[Any]]]] = {
    "gazebo_ros": {"gazebo": _gazebo, "gzserver": _gzserver, "gzclient": _gzclient},
    "ros_gz_sim": {
        "gz_sim": _gz_sim,
        "gz_server": _gz_server,
        "gz_spawn_model": _gz_spawn_model,
        "ros_gz_sim": _server_and_bridge,
        "ros_gz_spawn_model": _model_and_bridge,
    },
    "ros_gz_bridge": {"ros_gz_bridge": _bridge},
    "ros_ign_gazebo": {"ign_gazebo": _gz_sim},
}
