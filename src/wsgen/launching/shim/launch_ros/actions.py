"""All actions of ROS."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from launch._finder import show_public_names
from launch._utilities import (
    ensure_argument_type,
    normalize_optional,
    normalize_to_list_of_substitutions,
    normalize_typed_substitution,
    perform_substitutions,
    perform_typed_substitution,
)
from launch.actions import ExecuteProcess, SetEnvironmentVariable, TimerAction
from launch.base import Action, EventHandler, SubstitutionFailure
from launch.substitutions import LaunchConfiguration
from launch_ros._events import ChangeState, StateTransition, matches_node_name
from launch_ros.substitutions import ExecutableInPackage
from launch_ros.utilities import (
    Evaluated,
    add_global_parameters,
    evaluate_parameters,
    global_parameters,
    item_origins,
    join_namespaces,
    normalize_parameters,
    normalize_remap_rules,
    note_composable_node,
    perform_remap_rules,
    placed,
    places_of,
    validate_name,
    validate_namespace,
    written_at,
)
from wsgen.launching.live import joined
from wsgen.launching.record import RECORD, locate

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.base import Event, LaunchDescriptionEntity, SomeSubstitutionsType, Substitution
    from launch.launch_context import LaunchContext
    from launch_ros.utilities import ComposableNode
    from wsgen.model.plan import Process


UNSPECIFIED_NAME = "<node_name_unspecified>"
UNSPECIFIED_NAMESPACE = "<node_namespace_unspecified>"


class Node(ExecuteProcess):
    """A program of a package, with a name, a namespace, parameters and remappings."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        executable: SomeSubstitutionsType,
        package: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        exec_name: SomeSubstitutionsType | None = None,
        parameters: list[Any] | None = None,
        remappings: Iterable[Any] | None = None,
        ros_arguments: Iterable[SomeSubstitutionsType] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
        **kwargs: Any,
    ) -> None:
        words = [] if arguments is None else list(arguments)
        if parameters is not None:
            ensure_argument_type(parameters, [list], "parameters", "Node")
        super().__init__(cmd=words, name=exec_name, **kwargs)
        self.__executable = normalize_to_list_of_substitutions(executable)
        self.__package = normalize_optional(package)
        self.__name = normalize_optional(name)
        self.__namespace = normalize_optional(namespace)
        self.__parameters = normalize_parameters(parameters or [])
        self.__remappings = normalize_remap_rules(remappings or [])
        self.__ros_arguments = [
            normalize_to_list_of_substitutions(word) for word in ros_arguments or []
        ]
        self.__full_name: str | None = None
        self.__given_ros_arguments: list[str] = []
        self.wsgen_path: str | None = None

    @property
    def wsgen_program(self) -> list[list[Substitution]]:
        """What names its program."""
        return [self.__executable]

    @property
    def node_name(self) -> str:
        """The full name, once the node was executed."""
        if self.__full_name is None:
            raise RuntimeError("cannot access 'node_name' before executing action")
        return self.__full_name

    def prepare(self, context: LaunchContext) -> Process:
        """Perform everything, in the order of the original, so that the same mistake is met."""
        name = None if self.__name is None else perform_substitutions(context, self.__name)
        if name is not None:
            validate_name(name)
        namespace = join_namespaces(
            context.launch_configurations.get("ros_namespace"),
            None if self.__namespace is None else perform_substitutions(context, self.__namespace),
        )
        if namespace is not None:
            validate_namespace(namespace)
        self.__full_name = f"{(namespace or '').rstrip('/')}/{name or UNSPECIFIED_NAME}"
        parameters = global_parameters(context, node=self.__full_name, location=self.wsgen_location)
        parameters.add(
            evaluate_parameters(
                context, self.__parameters, node=self.__full_name, location=self.wsgen_location
            )
        )
        remappings = perform_remap_rules(context, self.__remappings)
        self.__given_ros_arguments = [
            perform_substitutions(context, word) for word in self.__ros_arguments
        ]
        executable = perform_substitutions(context, self.__executable)
        package = None
        if self.__package is not None:
            package = perform_substitutions(context, self.__package)
            try:
                self.wsgen_path = context.perform_substitution(
                    ExecutableInPackage(executable, package)
                )
            except SubstitutionFailure as error:  # a node that is not there is in the plan as well
                locate(error, self.wsgen_location)
                if not RECORD.ends_branch(error):
                    raise
        process = super().prepare(context)
        words = process.command or ()  # a prefix and the arguments
        return replace(
            process,
            package=package,
            executable=executable,
            name=name,
            namespace=namespace or "",
            parameters=parameters,
            parameter_origins=parameters.origins(),
            arguments=words[len(words) - len(self.cmd) :],
            argument_origins=item_origins(
                "arguments", list(map(written_at, self.cmd)), len(self.cmd), self.wsgen_location
            ),
            configurations=tuple(_configuration(context, word) for word in self.cmd),
            remappings=tuple(remappings),
            remapping_origins=item_origins(
                "remappings", places_of(remappings), len(self.__remappings), self.wsgen_location
            ),
            command=None,
        )

    def wsgen_words(self, process: Process) -> list[str]:
        """Its arguments, then those for ROS, in the order of the original."""
        words = list(process.arguments)
        if self.__given_ros_arguments:
            words += ["--ros-args", *self.__given_ros_arguments]
        words.append("--ros-args")
        if process.name is not None:
            words += ["-r", f"__node:={process.name}"]
        if process.namespace:
            words += ["-r", f"__ns:={process.namespace}"]
        full_name = "" if UNSPECIFIED_NAME in self.node_name else self.node_name
        if RECORD.live is not None and isinstance(process.parameters, Evaluated):
            for group in joined(process.parameters.groups):
                file = RECORD.live.write_parameters(group, full_name)
                words += ["--params-file", file] if file else []
        for source, target in process.remappings:
            words += ["-r", f"{source}:={target}"]
        return words


def _configuration(context: LaunchContext, word: list[Substitution]) -> str | None:
    """The launch configuration whose value is all of the word."""
    if len(word) != 1 or not isinstance(word[0], LaunchConfiguration):
        return None
    return perform_substitutions(context, word[0].variable_name)


class ComposableNodeContainer(Node):
    """A container, with nodes that are loaded when it has started."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        composable_node_descriptions: Iterable[ComposableNode] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.__descriptions = list(composable_node_descriptions or [])

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Start the container, then load the nodes."""
        super().execute(context)
        if not self.__descriptions:
            return None

        return [
            LoadComposableNodes(
                composable_node_descriptions=self.__descriptions, target_container=self
            )
        ]


# Transition -> the state before, the one on the way, and the one after it.
_STATES = {
    1: ("unconfigured", "configuring", "inactive"),
    2: ("inactive", "cleaningup", "unconfigured"),
    3: ("inactive", "activating", "active"),
    4: ("active", "deactivating", "inactive"),
    5: ("unconfigured", "shuttingdown", "finalized"),
    6: ("inactive", "shuttingdown", "finalized"),
    7: ("active", "shuttingdown", "finalized"),
}
_CONFIGURE, _ACTIVATE = 1, 3
_ERROR = "errorprocessing"


class LifecycleNode(Node):
    """A node that must have a name and a namespace; for a plan its transitions always succeed."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        autostart: Any = False,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.__autostart = normalize_typed_substitution(autostart, bool)
        self.__state = "unconfigured"

    @property
    def is_lifecycle_node(self) -> bool:
        """Whether it has states."""
        return True

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Start it, and listen to what it is asked."""
        super().execute(context)
        if RECORD.live is not None:
            RECORD.live.follow_states(self)
        context.register_event_handler(_Listener(self))
        if not perform_typed_substitution(context, self.__autostart, bool):
            return None
        return [
            LifecycleTransition(
                lifecycle_node_names=[self.node_name], transition_ids=[_CONFIGURE, _ACTIVATE]
            )
        ]

    def change_state(self, transition: int, context: LaunchContext) -> None:
        """Make a transition if its first state is the node's, and emit its events."""
        if RECORD.live is not None:
            RECORD.live.change_state(self, transition)
            return
        states = _STATES.get(transition)
        if states is None or states[0] != self.__state:
            return
        for start, goal in itertools.pairwise(states):
            event = StateTransition(action=self, start_state=start, goal_state=goal)
            event.wsgen_cause = f"state {goal} of {self.process_name}"
            context.emit_event_sync(event)
        self.__state = states[-1]


class _Listener(EventHandler):
    """What a node does when it is asked to change its state."""

    def __init__(self, node: LifecycleNode) -> None:
        super().__init__(
            matcher=lambda event: (
                isinstance(event, ChangeState) and event.lifecycle_node_matcher(node)
            )
        )
        self.__node = node

    def handle(self, event: Event, context: LaunchContext) -> None:
        """Change it."""
        super().handle(event, context)
        if isinstance(event, ChangeState):
            self.__node.change_state(event.transition_id, context)


class LifecycleTransition(Action):
    """Asks each of the nodes for the transitions, for the next one when it is where one leads."""

    def __init__(
        self,
        *,
        lifecycle_node_names: Iterable[Any],
        transition_ids: Iterable[Any],
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__names = [normalize_to_list_of_substitutions(name) for name in lifecycle_node_names]
        self.__transitions = [
            normalize_to_list_of_substitutions(str(one) if isinstance(one, int) else one)
            for one in transition_ids
        ]
        if not self.__names or not self.__transitions:
            raise RuntimeError("lifecycle_node_names and transition_ids must not be empty")

    def execute(self, context: LaunchContext) -> None:
        """Ask them for the first one."""
        numbers = [int(perform_substitutions(context, one)) for one in self.__transitions]
        for name in self.__names:
            _Sequence(perform_substitutions(context, name), numbers).ask(context)


class _Sequence(EventHandler):
    """The transitions that a node is yet to make; an error ends them."""

    def __init__(self, node: str, transitions: list[int]) -> None:
        super().__init__(matcher=self._is_met)
        self.__node = node
        self.__matches_node = matches_node_name(node)
        self.__left = list(transitions)
        self.__states: list[str] = []  # on the way, and at the end, of the one that is made

    def ask(self, context: LaunchContext) -> None:
        """Ask for the next one."""
        number = self.__left.pop(0)
        self.__states = list(_STATES.get(number, ())[1:])
        if self.__left:
            context.register_event_handler(self)
        context.emit_event_sync(
            ChangeState(lifecycle_node_matcher=self.__matches_node, transition_id=number)
        )

    def _is_met(self, event: Event) -> bool:
        if not isinstance(event, StateTransition) or not self.__matches_node(event.action):
            return False
        return event.goal_state == _ERROR or [event.start_state, event.goal_state] == self.__states

    def handle(self, event: Event, context: LaunchContext) -> None:
        """Go on."""
        super().handle(event, context)
        context.unregister_event_handler(self)
        if isinstance(event, StateTransition) and event.goal_state == _ERROR:
            import logging

            logging.getLogger("launch_ros.actions.lifecycle_transition").info(
                "Stopping transitions for %s because an error has occurred", self.__node
            )
            return
        self.ask(context)


class LoadComposableNodes(Action):
    """Asks a container, given itself or by its name, to load nodes."""

    def __init__(
        self,
        *,
        composable_node_descriptions: Iterable[ComposableNode],
        target_container: Any,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__descriptions = list(composable_node_descriptions)
        self.__target = target_container

    def execute(self, context: LaunchContext) -> None:
        """Note the nodes."""
        if hasattr(self.__target, "node_name"):
            container = self.__target.node_name
        else:
            container = perform_substitutions(
                context, normalize_to_list_of_substitutions(self.__target)
            )
        for description in self.__descriptions:
            note_composable_node(context, description, container, self.wsgen_location)


class PushROSNamespace(Action):
    """Goes on from the namespace there is, or begins anew where it is absolute."""

    def __init__(self, namespace: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__namespace = normalize_to_list_of_substitutions(namespace)

    def execute(self, context: LaunchContext) -> None:
        """Set the namespace."""
        joined = join_namespaces(
            context.launch_configurations.get("ros_namespace"),
            perform_substitutions(context, self.__namespace),
        )
        if joined is not None:
            validate_namespace(joined)
            context.launch_configurations["ros_namespace"] = joined


PushRosNamespace = PushROSNamespace


class RosTimer(TimerAction):
    """Its actions, after a period of the time of ROS."""

    wsgen_is_simulated = True


ROSTimer = RosTimer


class SetParameter(Action):
    """A parameter of all nodes that come next; their own come after it."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        key = tuple(name) if isinstance(name, list) else name
        self.__parameters = normalize_parameters([{key: value}])

    def execute(self, context: LaunchContext) -> None:
        """Add it to those that are set."""
        evaluated = evaluate_parameters(
            context, self.__parameters, node="", location=self.wsgen_location
        )
        entries = (placed(pair, evaluated.places.get(pair[0])) for pair in evaluated.items())
        add_global_parameters(context, entries)


class SetParametersFromFile(Action):
    """A file that all nodes which come next read before their own parameters."""

    def __init__(self, filename: Any, *, node_name: Any = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        del node_name  # the sections of the file say which nodes they are for
        self.__parameters = normalize_parameters([filename])

    def execute(self, context: LaunchContext) -> None:
        """Add it to what is set."""
        add_global_parameters(context, self.__parameters)


class SetRemap(Action):
    """A remapping of all nodes that come next; their own come after it."""

    def __init__(
        self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self.__src = normalize_to_list_of_substitutions(src)
        self.__dst = normalize_to_list_of_substitutions(dst)

    def execute(self, context: LaunchContext) -> None:
        """Add it to those that are set."""
        rule = placed(
            (
                perform_substitutions(context, self.__src),
                perform_substitutions(context, self.__dst),
            ),
            self.wsgen_location,
        )
        earlier = context.launch_configurations.get("ros_remaps", [])
        context.launch_configurations["ros_remaps"] = [*earlier, rule]


class SetROSLogDir(SetEnvironmentVariable):
    """Sets the variable that nodes read it from."""

    def __init__(self, new_log_dir: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__("ROS_LOG_DIR", new_log_dir, **kwargs)


class SetUseSimTime(SetParameter):
    """The parameter `use_sim_time` of all nodes that come next."""

    def __init__(self, value: Any, **kwargs: Any) -> None:
        super().__init__(name="use_sim_time", value=value, **kwargs)


show_public_names(__name__)
