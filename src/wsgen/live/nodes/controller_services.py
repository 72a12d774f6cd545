"""The services of a controller manager, as its spawner and `ros2 control` call them.

Source: ros-controls/ros2_control, controller_manager/controller_manager/
controller_manager_services.py (Humble to Kilted).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import rclpy
from controller_manager_msgs import srv
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from wsgen.live.nodes.controller_spawner import colored
from wsgen.text import yamlfile

if TYPE_CHECKING:
    from collections.abc import Sequence

PATIENCE = 10.0  # s, between two messages about a service that is not there
ATTEMPTS = 3  # of a call
BEST_EFFORT, STRICT = 1, 2


class ServiceMissingError(Exception):
    """The controller manager did not answer."""


class ManagerClient:
    """Calls the services of one controller manager."""

    def __init__(
        self, node: Any, manager: str, *, wait: float = 0.0, patience: float = PATIENCE
    ) -> None:
        """`wait` (s) is how long for its services, 0: ever; `patience` for an answer."""
        self.node = node
        self.name = manager
        self._wait = wait
        self._patience = patience
        self._clients: dict[str, Any] = {}

    def call(self, service: str, kind: Any, request: Any, *, wait: float | None = None) -> Any:
        """Call a service of the manager.

        Raises:
            ServiceMissingError: It is not there, or does not answer.
        """
        full_name = f"{self.name}/{service}"
        client = self._clients.get(full_name)
        if client is None:
            client = self._clients[full_name] = self.node.create_client(kind, full_name)
        self._wait_for(client, full_name, self._wait if wait is None else wait)
        for attempt in range(1, ATTEMPTS + 1):
            future = client.call_async(request)
            rclpy.spin_until_future_complete(self.node, future, timeout_sec=self._patience)
            answer = future.result() if future.done() else None
            if answer is not None:
                return answer
            self.warn(
                f"Failed getting a result from calling {full_name} in {self._patience}. "
                f"(Attempt {attempt} of {ATTEMPTS}.)"
            )
        raise ServiceMissingError(
            f"Could not successfully call service {full_name} after {ATTEMPTS} attempts."
        )

    def _wait_for(self, client: Any, full_name: str, wait: float) -> None:
        while not client.service_is_ready():
            self.info(f"waiting for service {full_name} to become available...")
            if client.wait_for_service(wait or PATIENCE):
                return
            if wait:
                raise ServiceMissingError(f"Could not contact service {full_name}")
            self.warn(f"Could not contact service {full_name}")

    def controllers(self) -> list[Any]:
        """Those that are loaded."""
        answer = self.call("list_controllers", srv.ListControllers, srv.ListControllers.Request())
        return list(answer.controller)

    def load(self, name: str) -> bool:
        """Load a controller."""
        request = srv.LoadController.Request(name=name)
        return bool(self.call("load_controller", srv.LoadController, request).ok)

    def configure(self, name: str) -> bool:
        """Configure a controller."""
        request = srv.ConfigureController.Request(name=name)
        return bool(self.call("configure_controller", srv.ConfigureController, request).ok)

    def unload(self, name: str) -> bool:
        """Unload a controller."""
        request = srv.UnloadController.Request(name=name)
        return bool(self.call("unload_controller", srv.UnloadController, request).ok)

    def switch(
        self,
        activate: Sequence[str] = (),
        deactivate: Sequence[str] = (),
        *,
        strictness: int = STRICT,
        seconds: float = 5.0,
    ) -> Any:
        """Activate and deactivate controllers; the answer has `ok`."""
        request = srv.SwitchController.Request(
            activate_controllers=list(activate),
            deactivate_controllers=list(deactivate),
            strictness=strictness,
        )
        request.timeout.sec = int(seconds)
        return self.call("switch_controller", srv.SwitchController, request)

    def set_parameter(self, controller: str, name: str, value: Any) -> bool:
        """Set a parameter of the manager, which is about a controller."""
        full = Parameter(f"{controller}.{name}", value=value).to_parameter_msg()
        assert isinstance(full, ParameterMessage)  # noqa: S101  rclpy says so
        answer = self.call(
            "set_parameters", SetParameters, SetParameters.Request(parameters=[full])
        )
        did = bool(answer.results and answer.results[0].successful)
        reported = f'"{name}" to "{value}" for '
        if did:
            self.info(
                colored(f"Setting controller param {reported}", "cyan")
                + colored(controller, "bold")
            )
        else:
            self.fatal(
                colored(f"Could not set controller param {reported}", "red")
                + colored(controller, "bold")
            )
        return did

    def set_from_files(self, controller: str, files: Sequence[str], namespace: str) -> bool:
        """Give a controller the files of parameters that name it, and its type from them."""
        named = []
        kind = None
        for file in files:
            content = yamlfile.load(Path(file))
            sections = _sections_of(content, controller, namespace)
            if sections:
                named.append(file)
            for section in sections:
                found = section.get("ros__parameters", "type")
                kind = found.text if found is not None and found.text else kind
        if not named:
            self.fatal(
                colored(
                    f"Controller : {_full(controller, namespace)} parameters not found in "
                    f"parameter files : {list(files)}",
                    "red",
                )
            )
            return True  # as the real one: it goes on without
        did = self.set_parameter(
            controller, "params_file", [str(Path(one).absolute()) for one in named]
        )
        return did and (kind is None or self.set_parameter(controller, "type", kind))

    def info(self, text: str) -> None:
        """Print what happened."""
        self.node.get_logger().info(text)

    def warn(self, text: str) -> None:
        """Print a warning."""
        self.node.get_logger().warning(text)

    def error(self, text: str) -> None:
        """Print an error."""
        self.node.get_logger().error(text)

    def fatal(self, text: str) -> None:
        """Print why nothing more can be done."""
        self.node.get_logger().fatal(text)


def _full(controller: str, namespace: str) -> str:
    return f"{namespace.rstrip('/')}/{controller}"


def _sections_of(content: object, controller: str, namespace: str) -> list[yamlfile.Value]:
    """The sections of a file that are for a controller."""
    if not isinstance(content, yamlfile.Value):
        return []
    full = _full(controller, namespace)
    names = [full, f"/**/{controller}", f"/**{full}", "/**"]
    if namespace == "/":
        names.insert(0, controller)
    found = [section for name in names if (section := content.get(name)) is not None]
    deep = content.get(*full.strip("/").split("/"))
    return [*found, deep] if deep is not None and deep not in found else found
