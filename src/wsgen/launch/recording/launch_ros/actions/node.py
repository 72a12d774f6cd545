"""A node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.actions.execute_process import ExecuteProcess
from launch.utilities.ensure_argument_type_impl import ensure_argument_type
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch_ros.substitutions.executable_in_package import ExecutableInPackage
from launch_ros.utilities.namespaces import join_namespaces, validate_name, validate_namespace
from launch_ros.utilities.parameters import (
    evaluate_parameters,
    global_parameters,
    normalize_parameters,
)
from launch_ros.utilities.remappings import normalize_remap_rules, perform_remap_rules

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType

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
        self.__package = None if package is None else normalize_to_list_of_substitutions(package)
        self.__name = None if name is None else normalize_to_list_of_substitutions(name)
        self.__namespace = (
            None if namespace is None else normalize_to_list_of_substitutions(namespace)
        )
        self.__parameters = normalize_parameters(parameters or [])
        self.__remappings = normalize_remap_rules(remappings or [])
        self.__ros_arguments = [
            normalize_to_list_of_substitutions(word) for word in ros_arguments or []
        ]
        self.__full_name: str | None = None

    @property
    def node_name(self) -> str:
        """The full name, once the node was executed."""
        if self.__full_name is None:
            raise RuntimeError("cannot access 'node_name' before executing action")
        return self.__full_name

    def prepare(self, context: LaunchContext) -> dict[str, Any]:
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
        parameters = {
            **global_parameters(context, node=self.__full_name, location=self.wsgen_location),
            **evaluate_parameters(
                context, self.__parameters, node=self.__full_name, location=self.wsgen_location
            ),
        }
        remappings = perform_remap_rules(context, self.__remappings)
        for word in self.__ros_arguments:
            perform_substitutions(context, word)
        executable = perform_substitutions(context, self.__executable)
        package = None
        if self.__package is not None:
            package = perform_substitutions(context, self.__package)
            context.perform_substitution(ExecutableInPackage(executable, package))
        process = super().prepare(context)
        words = process["command"]  # a prefix and the arguments
        return {
            **process,
            "package": package,
            "executable": executable,
            "name": name,
            "namespace": namespace or "",
            "parameters": parameters,
            "arguments": words[len(words) - len(self.cmd) :],
            "remappings": remappings,
            "command": None,
        }
