"""`controller_manager spawner` and `unspawner`, where ROS's own are not there.

`python -m wsgen.live.nodes.controller_spawner [--unspawn] NAME…`. Arguments, output and exit codes
are those of ros-controls/ros2_control, controller_manager/controller_manager/spawner.py and
unspawner.py (Humble to Kilted).
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import time
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.launching.spawner_options import OF_CONTROLLER, OF_SPAWNER
from wsgen.live.nodes.signals import ignore_ends, raise_when_ended

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.launching.spawner_options import ControllerOptions
    from wsgen.live.nodes.controller_services import ManagerClient


_COLORS = {"blue": 94, "cyan": 96, "green": 92, "yellow": 93, "red": 91, "bold": 1}


def colored(text: str, *names: str) -> str:
    """The text in colors, where ROS's own tools would color it."""
    wanted = os.environ.get("RCUTILS_COLORIZED_OUTPUT")
    if wanted == "0" or (wanted != "1" and not sys.stdout.isatty()):
        return text
    return "".join(f"\033[{_COLORS[name]}m" for name in names) + text + "\033[0m"


UNSPAWN = "--unspawn"  # the first argument of an unspawner
EACH = "--controller"  # before each name, with arguments of its own


class Wanted(NamedTuple):
    """A controller to start."""

    name: str
    files: tuple[str, ...] = ()  # of parameters
    only_load: bool = False
    stays_inactive: bool = False
    ros_arguments: tuple[str, ...] = ()


def read_arguments(arguments: Sequence[str], files: Sequence[str] = ()) -> argparse.Namespace:
    """The arguments of a spawner; ends the process where they are wrong, as argparse does.

    `files` are those of parameters that its `--ros-args` name. What there is to start is in
    `controllers`.
    """
    if EACH in arguments:
        first = list(arguments).index(EACH)
        options = _parser(OF_SPAWNER).parse_known_args(list(arguments))[0]
        controllers = tuple(_each(list(arguments[first:])))
    else:
        parser = argparse.ArgumentParser(
            prog="spawner", parents=[_parser(OF_SPAWNER), _parser(OF_CONTROLLER)]
        )
        parser.add_argument("controller_names", nargs="+", help="List of controllers")
        options = parser.parse_args(list(arguments))
        controllers = tuple(_wanted(name, options) for name in options.controller_names)
    options.controllers = tuple(
        one._replace(files=tuple(dict.fromkeys((*one.files, *files)))) for one in controllers
    )
    return options


def _parser(options: ControllerOptions) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="spawner", add_help=False, allow_abbrev=False)
    for names, default in options.items():
        kind: dict[str, Any] = {"default": default}
        if default is False:
            kind["action"] = "store_true"
        elif default == ():
            kind |= {"action": "append", "default": []}
        elif isinstance(default, float):
            kind["type"] = float
        parser.add_argument(*names, **kind)
    return parser


def _wanted(name: str, options: argparse.Namespace) -> Wanted:
    return Wanted(
        name,
        tuple(options.param_file),
        only_load=options.load_only,
        stays_inactive=options.inactive or options.stopped,
        ros_arguments=tuple(word for text in options.controller_ros_args for word in text.split()),
    )


def _each(arguments: list[str]) -> Any:
    """The controllers of `--controller NAME … --controller NAME …`."""
    starts = [index for index, word in enumerate(arguments) if word == EACH]
    for start, end in zip(starts, (*starts[1:], len(arguments)), strict=True):
        chunk = arguments[start + 1 : end]
        if not chunk:
            sys.stdout.write(f"Error: {EACH} argument missing value in chunk: {[EACH]}\n")
            sys.exit(1)
        yield _wanted(chunk[0], _parser(OF_CONTROLLER).parse_known_args(chunk[1:])[0])


def refused_in(order: argparse.Namespace) -> str | None:
    """What ends a spawner before it is a node: a name that none can have, or a missing file."""
    for one in order.controllers:
        if re.fullmatch(r"\w+", one.name, re.ASCII) is None:
            return (
                f"The controller '{one.name}' has a name that no node can have.\n"
                "Write letters, digits and underscores, also in the file of its parameters."
            )
        for file in one.files:
            if not os.path.isfile(file):  # noqa: PTH113  a text for its message
                return f"FileNotFoundError: No such file or directory: '{file}'"
    return None


def spawn(order: argparse.Namespace, client: ManagerClient, namespace: str) -> int:
    """Load, configure and activate; gives the exit code."""
    group = []
    for one in order.controllers:
        if not _prepare(order, one, client, namespace):
            return 1
        if one.only_load or one.stays_inactive:
            continue
        if order.activate_as_group:
            group.append(one.name)
            continue
        if not client.switch([one.name], seconds=order.switch_timeout).ok:
            client.error(colored(f"Failed to activate controller : {one.name}", "red"))
            return 1
        client.info(
            colored("Configured and activated ", "green") + colored(one.name, "green", "bold")
        )
    if group:
        if not client.switch(group, seconds=order.switch_timeout).ok:
            client.error(
                colored(f"Failed to activate the parsed controllers list : {group}", "red")
            )
            return 1
        client.info(
            colored(f"Configured and activated all the parsed controllers list : {group}!", "green")
        )
    if getattr(order, "stopped", False):
        client.warn('"--stopped" flag is deprecated use "--inactive" instead')
    return 0


def _prepare(order: argparse.Namespace, one: Wanted, client: ManagerClient, namespace: str) -> bool:
    """Load and configure a controller."""
    if any(loaded.name == one.name for loaded in client.controllers()):
        client.warn(colored("Controller already loaded, skipping load_controller", "yellow"))
    elif not _load(order, one, client, namespace):
        return False
    if not one.only_load and not client.configure(one.name):
        client.error(colored("Failed to configure controller", "red"))
        return False
    return True


def _load(order: argparse.Namespace, one: Wanted, client: ManagerClient, namespace: str) -> bool:
    if order.controller_type and not client.set_parameter(one.name, "type", order.controller_type):
        return False
    if one.ros_arguments and not client.set_parameter(
        one.name, "node_options_args", list(one.ros_arguments)
    ):
        return False
    if one.files and not client.set_from_files(one.name, one.files, namespace):
        return False
    if not client.load(one.name):
        client.fatal(
            colored("Failed loading controller ", "red") + colored(one.name, "red", "bold")
        )
        return False
    client.info(colored("Loaded ", "blue") + colored(one.name, "blue", "bold"))
    return True


def unload_when_interrupted(order: argparse.Namespace, client: ManagerClient) -> int:
    """Wait for the end, then take back what was started."""
    client.info("Waiting until interrupt to unload controllers")
    try:
        while True:
            time.sleep(1)
    except KeyboardInterrupt:
        ignore_ends()
    names = [one.name for one in order.controllers if not one.stays_inactive]
    if not names:
        client.info("No active controllers to unload.")
        return 0
    client.info("Deactivating and unloading controllers...")
    if not client.switch(deactivate=names, seconds=order.switch_timeout).ok:
        client.error(colored("Failed to deactivate controller", "red"))
        return 1
    client.info(f"Successfully deactivated controllers : {names}")
    failed = [name for name in names if not client.unload(name)]
    for name in failed:
        client.error(colored(f"Failed to unload controller : {name}", "red"))
    if not failed:
        client.info(f"Successfully unloaded controllers : {names}")
    return 1 if failed else 0


def unspawn(names: Sequence[str], client: ManagerClient, seconds: float) -> int:
    """Deactivate and unload controllers; gives the exit code."""
    client.switch(deactivate=names, seconds=seconds)  # it prints what is wrong; unload all the same
    client.info("Deactivated controller")
    for name in names:
        if not client.unload(name):
            client.info("Failed to unload controller")
            return 1
        client.info("Unloaded controller")
    return 0


def full_manager(name: str, namespace: str) -> str:
    """The full name of a controller manager, for a spawner in a namespace."""
    return name if name.startswith("/") else f"{namespace.rstrip('/')}/{name}"


def _parameter_files(arguments: Sequence[str]) -> list[str]:
    return [file for option, file in pairwise(arguments) if option == "--params-file"]


def main() -> int:
    """Spawn or unspawn controllers; gives the exit code."""
    try:
        import controller_manager_msgs  # noqa: F401, PLC0415  the services of the manager
    except ModuleNotFoundError:
        sys.stderr.write(
            "The ROS package controller_manager_msgs is missing, which live runs of robots with "
            "ros2_control have: no robot of this one has its plugin.\n"
        )
        return 1
    import rclpy  # noqa: PLC0415  after the arguments
    from rclpy.node import Node  # noqa: PLC0415
    from rclpy.signals import SignalHandlerOptions  # noqa: PLC0415
    from rclpy.utilities import remove_ros_args  # noqa: PLC0415

    from wsgen.live.nodes.controller_services import ManagerClient, ServiceMissingError  # noqa: PLC0415  with ROS alone

    node: Any = None
    try:
        raise_when_ended()
        given = sys.argv[1:]
        is_unspawner = given[:1] == [UNSPAWN]
        given = given[1:] if is_unspawner else given
        plain = remove_ros_args(args=["spawner", *given])[1:]
        order = (
            _unspawner(plain) if is_unspawner else read_arguments(plain, _parameter_files(given))
        )
        if (problem := refused_in(order)) is not None:
            sys.stderr.write(f"{problem}\n")
            return 1
        rclpy.init(args=[sys.argv[0], *given], signal_handler_options=SignalHandlerOptions.NO)
        first = order.controllers[0].name
        node = Node(f"{'un' if is_unspawner else ''}spawner_{first}")
        namespace = order.namespace or node.get_namespace()
        namespace = namespace if namespace.startswith("/") else f"/{namespace}"
        client = ManagerClient(
            node,
            full_manager(order.controller_manager, namespace),
            wait=order.controller_manager_timeout,
            patience=order.service_call_timeout,
        )
        if is_unspawner:
            names = [one.name for one in order.controllers]
            return unspawn(names, client, order.switch_timeout)
        code = spawn(order, client, namespace)
        return unload_when_interrupted(order, client) if order.unload_on_kill and not code else code
    except ServiceMissingError as missing:
        node.get_logger().fatal(str(missing))
        return 1
    except KeyboardInterrupt:
        return 0
    finally:
        ignore_ends()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def _unspawner(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="unspawner")
    parser.add_argument("controller_names", nargs="+", help="Name of the controller")
    parser.add_argument("-c", "--controller-manager", default="/controller_manager")
    parser.add_argument("--switch-timeout", type=float, default=5.0)
    parser.set_defaults(
        namespace=None,
        controller_manager_timeout=0.0,
        service_call_timeout=10.0,
        unload_on_kill=False,
    )
    options = parser.parse_args(list(arguments))
    options.controllers = tuple(Wanted(name) for name in options.controller_names)
    return options


if __name__ == "__main__":
    sys.exit(main())
