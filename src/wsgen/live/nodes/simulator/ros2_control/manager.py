"""The controller manager: a node with services that load, configure and switch controllers.

Source: ros-controls/ros2_control, controller_manager/src/controller_manager.cpp (Humble to
Kilted). It is updated by the plugin of a robot, in simulated time; a switch happens between two
updates.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from controller_manager_msgs import srv
from controller_manager_msgs.msg import ControllerState, HardwareComponentState, HardwareInterface
from lifecycle_msgs.msg import State

from wsgen.live.nodes.simulator.ros2_control.controllers import TYPES, controller_class
from wsgen.live.nodes.simulator.ros2_control.controllers.base import (
    Controller,
    ControllerError,
    Surroundings,
)
from wsgen.live.nodes.simulator.ros2_control.parameters import ParameterFiles, Parameters
from wsgen.live.nodes.simulator.ros2_control.switching import (
    ACTIVE,
    INACTIVE,
    UNCONFIGURED,
    Available,
    Candidate,
    Switch,
    plan_switch,
)
from wsgen.live.nodes.simulator.topics import BadNameError
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from wsgen.live.nodes.simulator.ros import Ros
    from wsgen.live.nodes.simulator.ros2_control.hardware import Component, Interfaces
    from wsgen.live.nodes.simulator.ros2_control.joints import JointSystem

FORMER = frozenset(("humble", "iron"))
ROUNDING = 1e-9  # s; what sums of steps are off


class Loaded:
    """A controller that is loaded."""

    def __init__(self, kind: str, controller: Controller) -> None:
        self.kind = kind
        self.controller = controller
        self.state = UNCONFIGURED
        self.next = 0.0  # s, simulated: when it is updated
        self.last = 0.0  # when it was

    def candidate(self) -> Candidate:
        """What the rules of switching look at."""
        one = self.controller
        return Candidate(one.name, self.state, one.commands, one.states)


class ControllerManager:
    """The controllers of a robot.

    Attributes:
        rate: Hz, of updates.
    """

    def __init__(  # noqa: PLR0913  what there is
        self,
        ros: Ros,
        *,
        name: str,
        namespace: str,
        arguments: Sequence[str],
        files: Sequence[str],
        clock: Callable[[], float],
        is_former: bool,
    ) -> None:
        self._ros = ros
        self._namespace = namespace
        self._arguments = tuple(arguments)
        self._files = ParameterFiles.read(files)
        self._clock = clock
        self._is_former = is_former
        full_name = f"{namespace.rstrip('/')}/{name}"
        self._parameters = Parameters(self._files.of_node(full_name))
        self.node = ros.node(name, namespace, self._arguments, parameters=self._parameters.values)
        self._log = self.node.get_logger()
        self.node.add_on_set_parameters_callback(self._set_parameters)
        for error in self._files.errors:
            self._log.error(error)
        rate = self._parameters.number("update_rate", 100.0)
        if rate <= 0:
            self._log.error("The parameter `update_rate` is not above 0: 100 is used.")
            rate = 100.0
        self.rate = rate
        self._components: tuple[Component, ...] = ()
        self._joints: Any = ()
        self._loaded: dict[str, Loaded] = {}
        self.interfaces: Interfaces
        self._system: JointSystem

    def begin(
        self,
        components: Sequence[Component],
        interfaces: Interfaces,
        system: JointSystem,
        joints: Any,
    ) -> None:
        """Have hardware, and offer the services."""
        self._components = tuple(components)
        self.interfaces = interfaces
        self._system = system
        self._joints = joints
        for service, answer in (
            ("ListControllers", self._list_controllers),
            ("ListControllerTypes", self._list_types),
            ("ListHardwareComponents", self._list_components),
            ("ListHardwareInterfaces", self._list_interfaces),
            ("LoadController", self._answer(self.load)),
            ("ConfigureController", self._answer(self.configure)),
            ("CleanupController", self._answer(self.cleanup)),
            ("UnloadController", self._answer(self.unload)),
            ("SwitchController", self._switch),
            ("SetHardwareComponentState", self._set_component),
            ("ReloadControllerLibraries", self._reload),
        ):
            if hasattr(srv, service):  # Humble has fewer
                self._ros.service(self.node, getattr(srv, service), f"~/{_snake(service)}", answer)

    def update(self, now: float) -> None:
        """Have the active controllers do what is due (s, simulated)."""
        for one in tuple(self._loaded.values()):
            if one.state == ACTIVE and one.next <= now + ROUNDING:
                elapsed = now - one.last
                one.last = now
                one.next += one.controller.period
                if one.next <= now:  # the time has jumped
                    one.next = now + one.controller.period
                one.controller.update(now, elapsed)

    def reset(self) -> None:
        """The time began again."""
        now = self._clock()
        for one in self._loaded.values():
            one.next = now
            one.last = now - one.controller.period
            if one.state == ACTIVE:
                one.controller.reset(now)

    def close(self) -> None:
        """End everything."""
        for name, one in tuple(self._loaded.items()):
            if one.state == ACTIVE:
                self._deactivate([name])
            self.unload(name)
        self._ros.forget_node(self.node)

    def load(self, name: str) -> bool:
        """Load a controller by its name; its type is a parameter."""
        if name in self._loaded:
            self._log.error(
                f"A controller named '{name}' was already loaded inside the controller manager"
            )
            return False
        kind = self._parameters.values.get(f"{name}.type")
        if not isinstance(kind, str) or not kind:
            known = sorted(
                key.removesuffix(".type")
                for key in self._parameters.values
                if key.endswith(".type")
            )
            self._log.error(
                f"The 'type' param was not defined for '{name}'.{_question(name, known)}"
            )
            return False
        self._log.info(f"Loading controller : '{name}' of type '{kind}'")
        made = controller_class(kind)
        if made is None:
            self._log.error(
                f"Loader for controller '{name}' (type '{kind}') not found."
                f"{_question(kind, TYPES)} wsgen has these types:"
            )
            for available in TYPES:
                self._log.info(f"  {available}")
            return False
        files = self._files + ParameterFiles.read(self._own_files(name))
        full_name = f"{self._namespace.rstrip('/')}/{name}"
        parameters = Parameters(files.of_node(full_name))
        own = self._parameters.values.get(f"{name}.node_options_args", [])
        arguments = [*self._arguments, *(own if isinstance(own, list) else [])]
        try:
            node = self._ros.node(name, self._namespace, arguments, parameters=parameters.values)
        except BadNameError as problem:
            self._log.error(f"The controller '{name}' cannot have a node: {problem}")
            return False
        controller = made(
            Surroundings(
                node,
                self._ros,
                parameters,
                self.interfaces,
                self._joints,
                clock=self._clock,
                is_former=self._is_former,
            )
        )
        rate = parameters.number("update_rate", 0.0) or self.rate
        controller.period = 1.0 / min(rate, self.rate) if rate > 0 else 1.0 / self.rate
        self._loaded[name] = Loaded(kind, controller)

        def set_parameters(changed: Sequence[Any]) -> Any:
            result = _take(parameters, changed)
            if self._loaded[name].state != UNCONFIGURED:
                controller.on_parameters()
            return result

        node.add_on_set_parameters_callback(set_parameters)
        return True

    def _own_files(self, name: str) -> list[str]:
        """The files of parameters that a spawner named for a controller."""
        named = self._parameters.values.get(f"{name}.params_file", [])
        return [named] if isinstance(named, str) else [str(one) for one in named]

    def configure(self, name: str) -> bool:
        """Configure a controller that is loaded."""
        self._log.info(f"Configuring controller: '{name}'")
        one = self._loaded.get(name)
        if one is None:
            self._log.error(
                f"Could not configure controller with name '{name}' because no controller with "
                "this name exists"
            )
            return False
        if one.state == ACTIVE:
            self._log.error(f"Controller '{name}' can not be configured from 'active' state.")
            return False
        one.controller.cleanup()
        one.state = UNCONFIGURED
        try:
            one.controller.configure()
        except (BadNameError, ControllerError, ModuleNotFoundError) as problem:
            one.controller.error(str(problem))
            one.controller.cleanup()
            return False
        finally:
            self._report_problems(one)
        _declare(one.controller.node, one.controller.parameters)
        one.state = INACTIVE
        return True

    def _report_problems(self, one: Loaded) -> None:
        for problem in dict.fromkeys(one.controller.parameters.problems):
            one.controller.error(f"{problem} Its default is used.")
        one.controller.parameters.problems.clear()

    def cleanup(self, name: str) -> bool:
        """Take the configuration of an inactive controller."""
        one = self._loaded.get(name)
        if one is None or one.state == ACTIVE:
            self._log.error(
                f"Controller '{name}' can not be cleaned-up from '"
                f"{'unknown' if one is None else one.state}' state."
            )
            return False
        one.controller.cleanup()
        one.state = UNCONFIGURED
        return True

    def unload(self, name: str) -> bool:
        """Forget a controller that is not active."""
        one = self._loaded.get(name)
        if one is None:
            self._log.error(
                f"Could not unload controller with name '{name}' because no controller with this "
                "name exists"
            )
            return False
        if one.state == ACTIVE:
            self._log.error(
                f"Could not unload controller with name '{name}' because it is still active"
            )
            return False
        one.controller.cleanup()
        self._ros.forget_node(one.controller.node)
        del self._loaded[name]
        return True

    def switch(self, activate: Sequence[str], deactivate: Sequence[str], strictness: int) -> Switch:
        """Activate and deactivate controllers; what could not be done is in `problems`."""
        available = Available(
            tuple(self.interfaces.commands), tuple(self.interfaces.states), self.interfaces.claims
        )
        loaded = {name: one.candidate() for name, one in self._loaded.items()}
        plan = plan_switch(loaded, available, activate, deactivate, strictness)
        for problem in plan.problems:
            if plan.is_refused:
                self._log.error(problem)
            else:
                self._log.warning(problem)
        if plan.is_refused:
            return plan
        before = dict(self.interfaces.claims)
        self._deactivate(plan.deactivate)
        failed = self._activate(plan.activate)
        claims = self.interfaces.claims
        self._system.switch(
            [name for name in claims if name not in before],
            [name for name in before if name not in claims],
        )
        if failed:
            return plan._replace(problems=(*plan.problems, *failed), is_refused=True)
        self._log.info("Successfully switched controllers!")
        return plan

    def _deactivate(self, names: Sequence[str]) -> None:
        if names:
            self._log.info(f"Deactivating controllers: [ {' '.join(names)} ]")
        for name in names:
            one = self._loaded[name]
            one.controller.is_active = False
            one.controller.deactivate()
            one.state = INACTIVE
            self.interfaces.release(name)

    def _activate(self, names: Sequence[str]) -> list[str]:
        if names:
            self._log.info(f"Activating controllers: [ {' '.join(names)} ]")
        failed = []
        now = self._clock()
        for name in names:
            one = self._loaded[name]
            try:
                one.controller.activate()
            except ControllerError as problem:
                one.controller.error(str(problem))
                failed.append(f"Could not activate controller : '{name}'")
                continue
            self.interfaces.claim(name, one.controller.commands)
            one.controller.is_active = True
            one.state = ACTIVE
            one.next, one.last = now, now - one.controller.period
        for text in failed:
            self._log.error(text)
        return failed

    def _set_parameters(self, changed: Sequence[Any]) -> Any:
        return _take(self._parameters, changed)

    @staticmethod
    def _answer(do: Callable[[str], bool]) -> Callable[[Any, Any], Any]:
        def answer(request: Any, response: Any) -> Any:
            response.ok = do(request.name)
            return response

        return answer

    def _switch(self, request: Any, response: Any) -> Any:
        switch = self.switch(
            request.activate_controllers, request.deactivate_controllers, request.strictness
        )
        response.ok = not switch.is_refused
        if hasattr(response, "message"):  # newer than Humble's
            response.message = "\n".join(switch.problems) or "Successfully switched controllers!"
        return response

    def _list_controllers(self, _request: Any, response: Any) -> Any:
        for name, one in self._loaded.items():
            states = one.controller.states
            message = ControllerState(name=name, state=one.state, type=one.kind)
            if hasattr(message, "update_rate"):
                message.update_rate = min(65535, round(1.0 / one.controller.period))
            if one.state == ACTIVE:
                message.claimed_interfaces = list(one.controller.commands)
            if one.state != UNCONFIGURED:
                message.required_command_interfaces = list(one.controller.commands)
                message.required_state_interfaces = list(
                    self.interfaces.states if states is None else states
                )
            response.controller.append(message)
        return response

    @staticmethod
    def _list_types(_request: Any, response: Any) -> Any:
        response.types = list(TYPES)
        response.base_classes = ["controller_interface::ControllerInterface"] * len(TYPES)
        return response

    def _list_interfaces(self, _request: Any, response: Any) -> Any:
        response.command_interfaces = self._interfaces(self.interfaces.commands)
        response.state_interfaces = self._interfaces(self.interfaces.states)
        return response

    def _interfaces(self, names: Any) -> list[Any]:
        found = []
        for name in sorted(names):
            message = HardwareInterface(
                name=name,
                is_available=True,
                is_claimed=names is self.interfaces.commands and name in self.interfaces.claims,
            )
            if hasattr(message, "data_type"):
                message.data_type = "double"
            found.append(message)
        return found

    def _list_components(self, _request: Any, response: Any) -> Any:
        for component in self._components:
            message = HardwareComponentState(name=component.name, type=component.kind)
            plugin = "plugin_name" if hasattr(message, "plugin_name") else "class_type"
            setattr(message, plugin, component.plugin)
            message.state = _lifecycle_state(is_active=component.is_simulated)
            message.command_interfaces = [
                one
                for one in self._interfaces(self.interfaces.commands)
                if one.name in component.commands
            ]
            message.state_interfaces = [
                one
                for one in self._interfaces(self.interfaces.states)
                if one.name in component.states
            ]
            response.component.append(message)
        return response

    def _set_component(self, request: Any, response: Any) -> Any:
        there = any(one.name == request.name for one in self._components)
        response.state = _lifecycle_state(is_active=there)
        response.ok = there and request.target_state.label in {"", ACTIVE}
        if not response.ok:
            self._log.error(
                f"The hardware component `{request.name}` stays "
                f"{'active' if there else 'unknown'}: in wsgen the simulator is always active."
            )
        return response

    @staticmethod
    def _reload(_request: Any, response: Any) -> Any:
        response.ok = True
        return response


def is_former(environment: dict[str, str] | None = None, simulator: str = "gz") -> bool:
    """Whether controllers are those of Humble or Iron: Gazebo Classic has no others."""
    distro = (os.environ if environment is None else environment).get("ROS_DISTRO", "")
    return simulator == "classic" or distro in FORMER


def _snake(name: str) -> str:
    return "".join(f"_{one.lower()}" if one.isupper() else one for one in name).lstrip("_")


def _question(name: str, known: Iterable[str]) -> str:
    """Whether another name was meant, after a sentence."""
    return f" {ask_for_nearest(name, known)}".rstrip()


def _take(parameters: Parameters, changed: Sequence[Any]) -> Any:
    """Parameters of a node were set by somebody."""
    from rcl_interfaces.msg import SetParametersResult  # noqa: PLC0415  with the node alone

    for parameter in changed:
        value = parameter.value
        parameters.values[parameter.name] = list(value) if _is_sequence(value) else value
    return SetParametersResult(successful=True)


def _is_sequence(value: object) -> bool:
    return hasattr(value, "__iter__") and not isinstance(value, (str, bytes))


def _declare(node: Any, parameters: Parameters) -> None:
    """Let everybody see the defaults of the parameters that were read."""
    from wsgen.live.nodes.simulator.ros import parameters_of  # noqa: PLC0415  with the node alone

    new = {name: value for name, value in parameters.values.items() if not node.has_parameter(name)}
    for parameter in parameters_of(new):
        node.declare_parameter(parameter.name, parameter.value)


def _lifecycle_state(*, is_active: bool) -> Any:
    if is_active:
        return State(id=State.PRIMARY_STATE_ACTIVE, label=ACTIVE)
    return State(id=State.PRIMARY_STATE_UNCONFIGURED, label=UNCONFIGURED)
