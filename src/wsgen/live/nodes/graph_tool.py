"""The process behind `wsgen topic` and `wsgen node`.

Words and output are those of ros2cli (ros2/ros2cli: ros2topic, ros2node). It takes one argument,
the number of a descriptor with a request as JSON: the verb, its options by name, and how long to
wait for other nodes.
"""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.executors import ExternalShutdownException

from wsgen.errors import WsgenError
from wsgen.live.nodes import topic_verbs
from wsgen.live.nodes.graph import (
    Absent,
    MissingMessages,
    Refusal,
    discover,
    instead,
    is_hidden,
    make_node,
    node_names,
)
from wsgen.live.nodes.unanswered import Silence
from wsgen.ros.environment import open_ros
from wsgen.ros.environment.interfaces import buildable
from wsgen.ros.environment.processes import hand_over, handed_over, module_command
from wsgen.text.files import explain_disk_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import NoReturn


def list_nodes(node: Any, *, with_hidden: bool, count: bool) -> None:
    """Print the names of nodes, or their number."""
    names = node_names(node, with_hidden=with_hidden)
    if count:
        print(len(names))
        return
    if len(set(names)) < len(names):
        print(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which "
            "can have unintended side effects.",
            file=sys.stderr,
        )
    if names:
        print(*names, sep="\n")


def show_info(node: Any, *, name: str, with_hidden: bool) -> None:
    """Print what a node publishes, takes and offers.

    Raises:
        Absent: The node is not there.
    """
    name = name if name.startswith("/") else f"/{name}"
    names = node_names(node, with_hidden=with_hidden)
    if name not in names:
        raise Absent(f"Unable to find node '{name}'", instead(name, names, "node"))
    if names.count(name) > 1:
        print(
            f'There are {names.count(name)} nodes in the graph with the exact name "{name}". You '
            "are seeing information about only one of them.",
            file=sys.stderr,
        )
    namespace, _, base = name.rpartition("/")
    of = (base, namespace or "/")
    print(name)
    for title, found in (
        ("Subscribers", node.get_subscriber_names_and_types_by_node(*of)),
        ("Publishers", node.get_publisher_names_and_types_by_node(*of)),
        ("Service Servers", node.get_service_names_and_types_by_node(*of)),
        ("Service Clients", node.get_client_names_and_types_by_node(*of)),
        ("Action Servers", get_action_server_names_and_types_by_node(node, *of)),
        ("Action Clients", get_action_client_names_and_types_by_node(node, *of)),
    ):
        print(f"  {title}:")
        _print(found, with_hidden=with_hidden)


def _print(found: Iterable[tuple[str, list[str]]], *, with_hidden: bool) -> None:
    shown = [one for one in sorted(found) if with_hidden or not is_hidden(one[0])]
    print(*(f"    {name}: {', '.join(types)}" for name, types in shown), sep="\n")


VERBS: dict[str, Callable[..., None]] = {
    "topic list": topic_verbs.list_topics,
    "topic type": topic_verbs.show_type,
    "topic info": topic_verbs.show_info,
    "topic echo": topic_verbs.echo,
    "topic hz": topic_verbs.measure,
    "topic pub": topic_verbs.publish,
    "node list": list_nodes,
    "node info": show_info,
}
LIST = ("topic list", "node list")
WAIT = ("topic echo", "topic hz", "topic pub")  # for messages, or for who takes them
INTERRUPTED = 130
CLOSED = 141  # nobody reads what is printed


def main(arguments: list[str]) -> int:
    """Answer the request; returns the exit code."""
    request = json.loads(handed_over(arguments[1]))
    try:
        rclpy.init(args=[])
        node = make_node(
            request["node_name"] or f"_ros2cli_{os.getpid()}",
            start_parameter_services=False,
            parameter_overrides=[rclpy.Parameter("use_sim_time", value=request["use_sim_time"])],
        )
    except (Refusal, RuntimeError) as refusal:  # its name; the folder of logs
        text = str(refusal).partition(", at /")[0]
        hint = "\nSet ROS_LOG_DIR to a folder that you may write to." if "log dir" in text else ""
        print(f"{text}{hint}", file=sys.stderr)
        rclpy.try_shutdown()
        return 1
    try:
        return _answer(node, request)
    except MissingMessages as missing:
        if missing.package in buildable() and missing.package not in request["built"]:
            node.destroy_node()
            rclpy.try_shutdown()
            try:
                _start_with(missing.package, request)
            except WsgenError as error:  # no compiler, no connection
                print(error, file=sys.stderr)
                return error.exit_code
        print(missing, file=sys.stderr)
        return 1
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def _answer(node: Any, request: dict[str, Any]) -> int:
    options = dict(request["options"])
    silence = Silence.of(node, request)
    try:
        discover(
            node,
            request["seconds"],
            topic=options.get("topic"),
            node_name=options.get("name"),
            silence=silence,
        )
        if request["verb"] in WAIT:
            options["silence"] = silence
        VERBS[request["verb"]](node, **options)
        if request["verb"] in LIST and silence.is_alone():
            sys.stdout.flush()
            silence.say(silence.nothing_runs())
    except MissingMessages:
        raise
    except Absent as absent:
        print(
            f"{absent.text}\n{silence.nothing_runs()}" if silence.is_alone() else absent,
            file=sys.stderr,
        )
        return 1
    except Refusal as refusal:
        print(refusal, file=sys.stderr)
        return 1
    except (KeyboardInterrupt, ExternalShutdownException):
        return INTERRUPTED
    except OSError as error:
        code = _code_of_unwritten(error)
        if code is None:
            raise
        # Python would complain about it once more when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return code
    return 0 if rclpy.ok() else INTERRUPTED


def end(code: int) -> NoReturn:
    """End the process at once, after its node is destroyed: the participant of DDS ends with it.

    What Python and libraries do at their end could only do harm: the thread by which Fast DDS
    watches its shared memory runs on while what it uses is destroyed, and seldom crashes.
    """
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError as error:
            unwritten = _code_of_unwritten(error)
            if unwritten is None:
                _write_error(f"The output is not complete: {error.strerror or error}")
            code = unwritten or code or 1
    os._exit(code)


def _code_of_unwritten(error: OSError) -> int | None:
    """The exit code where nobody reads the output, or a full disk is reported; else None."""
    if isinstance(error, BrokenPipeError):
        return CLOSED
    disk = explain_disk_error(error)
    if disk is None:
        return None
    _write_error(str(disk))
    return disk.exit_code


def _write_error(text: str) -> None:
    """Write past the stream, which may be what cannot be written."""
    with suppress(OSError):
        os.write(2, f"{text}\n".encode())


def _start_with(package: str, request: dict[str, Any]) -> None:
    """Begin anew with messages that PyPI lacks, which are built once."""
    print(f"Messages of {package} are built, once.", file=sys.stderr, flush=True)
    ros = open_ros(os.environ, messages=(package,), listener=lambda _event: None)
    again = {**request, "built": [*request["built"], package]}
    command = module_command(sys.executable, __spec__.name, hand_over(json.dumps(again)))
    os.execve(command[0], command, {**os.environ, **ros.variables})  # noqa: S606  as it was started


if __name__ == "__main__":
    end(main(sys.argv))
