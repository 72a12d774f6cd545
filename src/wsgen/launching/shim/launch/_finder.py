"""How the names of the real packages are found in the modules that are here.

The real `launch` has a file a class, `launch.actions.timer_action` and eighty more, and users
import from them. Here a package's classes are in one module. What `import launch.actions` shows is
what the original shows, not what the module needs for itself: a name that is missing there is
missing here, too.

A launch file uses a dozen of the hundred names; importing the rest would cost more than the
evaluation. So a package imports what a name needs when it is first asked for.
"""

from __future__ import annotations

import importlib
import sys
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


# The public names of a package, each with the module below it that defines it in the original; ""
# where the name is such a module, and two dots before a module that is beside the package.
NAMES: dict[str, dict[str, str]] = {
    "launch_ros.actions": {
        "ComposableNodeContainer": "composable_node_container",
        "LifecycleNode": "lifecycle_node",
        "LifecycleTransition": "lifecycle_transition",
        "LoadComposableNodes": "load_composable_nodes",
        "Node": "node",
        "PushROSNamespace": "push_ros_namespace",
        "PushRosNamespace": "push_ros_namespace",
        "ROSTimer": "ros_timer",
        "RosTimer": "ros_timer",
        "SetParameter": "set_parameter",
        "SetParametersFromFile": "set_parameters_from_file",
        "SetROSLogDir": "set_ros_log_dir",
        "SetRemap": "set_remap",
        "SetUseSimTime": "set_use_sim_time",
    },
    "launch_ros.descriptions": {
        "ComposableNode": "composable_node",
        "Parameter": "..parameter_descriptions",
        "ParameterFile": "..parameter_descriptions",
        "ParameterValue": "..parameter_descriptions",
    },
    "launch_ros.event_handlers": {
        "OnStateTransition": "on_state_transition",
    },
    "launch_ros.events": {
        "lifecycle": "",
        "matchers": "",
        "matches_node_name": "matchers",
    },
    "launch_ros.events.lifecycle": {
        "ChangeState": "change_state",
        "StateTransition": "state_transition",
        "matches_node_name": "matchers",
    },
    "launch_ros.substitutions": {
        "ExecutableInPackage": "executable_in_package",
        "FindPackage": "find_package",
        "FindPackagePrefix": "find_package",
        "FindPackageShare": "find_package",
    },
    "launch.conditions": {
        "IfCondition": "if_condition",
        "InvalidConditionExpressionError": "invalid_condition_expression_error",
        "LaunchConfigurationEquals": "launch_configuration_equals",
        "LaunchConfigurationNotEquals": "launch_configuration_not_equals",
        "UnlessCondition": "unless_condition",
        "evaluate_condition_expression": "evaluate_condition_expression_impl",
    },
    "launch.utilities": {
        "ensure_argument_type": "ensure_argument_type_impl",
        "is_a": "class_tools_impl",
        "is_a_subclass": "class_tools_impl",
        "isclassinstance": "class_tools_impl",
        "normalize_to_list_of_entities": "normalize_to_list_of_entities_impl",
        "normalize_to_list_of_substitutions": "normalize_to_list_of_substitutions_impl",
        "perform_substitutions": "perform_substitutions_impl",
        "type_utils": "",
    },
    "launch.actions": {
        "AppendEnvironmentVariable": "append_environment_variable",
        "DeclareLaunchArgument": "declare_launch_argument",
        "EmitEvent": "emit_event",
        "ExecuteLocal": "execute_local",
        "ExecuteProcess": "execute_process",
        "ForEach": "for_loop",
        "ForLoop": "for_loop",
        "GroupAction": "group_action",
        "IncludeLaunchDescription": "include_launch_description",
        "Log": "log_info",
        "LogDebug": "log_info",
        "LogError": "log_info",
        "LogInfo": "log_info",
        "LogWarning": "log_info",
        "OpaqueCoroutine": "opaque_coroutine",
        "OpaqueFunction": "opaque_function",
        "PopEnvironment": "pop_environment",
        "PopLaunchConfigurations": "pop_launch_configurations",
        "PushEnvironment": "push_environment",
        "PushLaunchConfigurations": "push_launch_configurations",
        "RegisterEventHandler": "register_event_handler",
        "ResetEnvironment": "reset_environment",
        "ResetLaunchConfigurations": "reset_launch_configurations",
        "SetEnvironmentVariable": "set_environment_variable",
        "SetLaunchConfiguration": "set_launch_configuration",
        "Shutdown": "shutdown_action",
        "TimerAction": "timer_action",
        "UnregisterEventHandler": "unregister_event_handler",
        "UnsetEnvironmentVariable": "unset_environment_variable",
        "UnsetLaunchConfiguration": "unset_launch_configuration",
    },
    "launch.launch_description_sources": {
        "AnyLaunchDescriptionSource": "any_launch_description_source",
        "FrontendLaunchDescriptionSource": "frontend_launch_description_source",
        "InvalidPythonLaunchFileError": "python_launch_file_utilities",
        "PythonLaunchDescriptionSource": "python_launch_description_source",
        "get_launch_description_from_any_launch_file": "any_launch_description_source",
        "get_launch_description_from_python_launch_file": "python_launch_file_utilities",
        "load_python_launch_file_as_module": "python_launch_file_utilities",
    },
    "launch.event_handlers": {
        "OnExecutionComplete": "on_execution_complete",
        "OnIncludeLaunchDescription": "on_include_launch_description",
        "OnProcessExit": "on_process_exit",
        "OnProcessIO": "on_process_io",
        "OnProcessStart": "on_process_start",
        "OnShutdown": "on_shutdown",
    },
    "launch.events": {
        "ExecutionComplete": "execution_complete",
        "Shutdown": "shutdown",
        "TimerEvent": "timer_event",
        "matches_action": "matchers",
        "process": "",
    },
    "launch.events.process": {
        "ProcessExited": "process_exited",
        "ProcessIO": "process_io",
        "ProcessStarted": "process_started",
        "ProcessStderr": "process_io",
        "ProcessStdin": "process_io",
        "ProcessStdout": "process_io",
        "RunningProcessEvent": "running_process_event",
        "ShutdownProcess": "process_targeted_event",
        "SignalProcess": "process_targeted_event",
        "matches_name": "process_matchers",
        "matches_pid": "process_matchers",
    },
    "launch.substitutions": {
        "AndSubstitution": "boolean_substitution",
        "AnonName": "anon_name",
        "AnySubstitution": "boolean_substitution",
        "AllSubstitution": "boolean_substitution",
        "BooleanSubstitution": "boolean_substitution",
        "Command": "command",
        "EnvironmentVariable": "environment_variable",
        "EqualsSubstitution": "equals_substitution",
        "FileContent": "file_content",
        "FindExecutable": "find_executable",
        "ForEachVar": "for_loop_var",
        "ForLoopIndex": "for_loop_var",
        "IfElseSubstitution": "if_else_substitution",
        "LaunchConfiguration": "launch_configuration",
        "LaunchLogDir": "launch_log_dir",
        "LocalSubstitution": "local_substitution",
        "NotEqualsSubstitution": "not_equals_substitution",
        "NotSubstitution": "boolean_substitution",
        "OrSubstitution": "boolean_substitution",
        "PathJoinSubstitution": "path_join_substitution",
        "PathSubstitution": "path_join_substitution",
        "PythonExpression": "python_expression",
        "SubstitutionFailure": "substitution_failure",
        "TextSubstitution": "text_substitution",
        "ThisLaunchFile": "this_launch_file",
        "ThisLaunchFileDir": "this_launch_file_dir",
    },
    "launch_xml": {
        "launch_description_sources": "",
    },
    "launch_xml.launch_description_sources": {
        "XMLLaunchDescriptionSource": "xml_launch_description_source",
    },
    "launch_yaml": {
        "launch_description_sources": "",
    },
    "launch_yaml.launch_description_sources": {
        "YAMLLaunchDescriptionSource": "yaml_launch_description_source",
    },
}

# Modules of the original whose content is elsewhere here than in the module above them.
HOMES = {
    "launch.action": "launch.base",
    "launch.condition": "launch.base",
    "launch.event": "launch.base",
    "launch.event_handler": "launch.base",
    "launch.invalid_launch_file_error": "launch.base",
    "launch.launch_description_entity": "launch.base",
    "launch.some_actions_type": "launch.base",
    "launch.some_entities_type": "launch.base",
    "launch.some_substitutions_type": "launch.base",
    "launch.substitution": "launch.base",
    "launch.launch_description_source": "launch.launch_description",
    "launch.launch_service": "launch.launch_description",
    "launch.events": "launch._events",
    "launch.events.process": "launch._events",
    "launch.utilities": "launch._utilities",
    "launch.utilities.type_utils": "launch._utilities",
    "launch.frontend.entity": "launch.frontend.parser",
    "launch.frontend.file": "launch.frontend.parser",
    "launch.frontend.parse_substitution": "launch.frontend.template",
    "launch.frontend.type_utils": "launch._utilities",
    "launch_ros.descriptions": "launch_ros.utilities",
    "launch_ros.event_handlers": "launch_ros._events",
    "launch_ros.events": "launch_ros._events",
    "launch_ros.events.lifecycle": "launch_ros._events",
    "launch_ros.parameters_type": "launch_ros.parameter_descriptions",
    "launch_ros.remap_rule_type": "launch_ros.parameter_descriptions",
    "launch_xml.launch_description_sources": "launch_xml",
    "launch_yaml.launch_description_sources": "launch_yaml",
}


def names_on_demand(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a package, given the module of each name ("" where it is one)."""

    def find(name: str) -> Any:
        home = homes.get(name)
        if home is None:
            raise _missing(package, name)
        if home:
            value = getattr(importlib.import_module(f"{package}.{home}"), name)
        else:
            value = importlib.import_module(f"{package}.{name}")
        setattr(sys.modules[package], name, value)
        return value

    return find


def show_public_names(module: str) -> None:
    """Let a module show its public names alone; its functions see all of it."""
    sys.modules[module].__class__ = _Shown
    vars(sys.modules[module]).update(__path__=[], __all__=[*NAMES[module]])


class Finder:
    """A meta path finder for what `HOMES` and `NAMES` list."""

    @staticmethod
    def find_spec(
        name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of a module that is defined elsewhere; None for all others."""
        home = _home(name) if name.startswith("launch") else None
        if home is None:
            return None
        return ModuleSpec(
            name,
            _Loader(home),  # type: ignore[arg-type]  # `importlib.abc` takes longer than the rest
            is_package=name in NAMES,
        )


class _Loader:
    def __init__(self, home: str) -> None:
        self._home = home

    @staticmethod
    def create_module(_spec: ModuleSpec) -> None:
        """Take an ordinary module."""

    def exec_module(self, module: ModuleType) -> None:
        """Show in it what its home defines."""
        public = NAMES.get(module.__name__)
        namespace = vars(importlib.import_module(self._home))

        def find(name: str) -> Any:
            if public is not None and public.get(name) == "":
                return importlib.import_module(f"{module.__name__}.{name}")
            if name not in namespace or not (public is None or name in public):
                raise _missing(module.__name__, name)
            return namespace[name]

        vars(module)["__getattr__"] = find
        vars(module)["__all__"] = _names_of_star(module.__name__, namespace)


class _Shown(ModuleType):
    def __getattribute__(self, name: str) -> Any:
        if name.startswith("__"):
            return super().__getattribute__(name)
        module = super().__getattribute__("__name__")
        home = NAMES[module].get(name)
        if home == "":
            return importlib.import_module(f"{module}.{name}")
        if home or f"{module}.{name}" in sys.modules:
            return super().__getattribute__(name)
        raise _missing(module, name)


def _home(name: str) -> str | None:
    """The module that has what the module of that name has in the original."""
    if name in HOMES:
        return HOMES[name]
    package, _, module = name.rpartition(".")
    if module in NAMES.get(package, {}).values():
        return HOMES.get(package, package)
    return None


def _names_of_star(name: str, namespace: Mapping[str, Any]) -> list[str]:
    """What `import *` gives: a module below a package gives all that the package defines."""
    if name in NAMES:
        return [*NAMES[name]]
    package, _, module = name.rpartition(".")
    above = NAMES.get(package, {})
    if module in above.values():
        return [shown for shown, home in above.items() if home]
    return [shown for shown in namespace if not shown.startswith("_")]


def _missing(module: str, name: str) -> AttributeError:
    return AttributeError(f"module {module!r} has no attribute {name!r}")
