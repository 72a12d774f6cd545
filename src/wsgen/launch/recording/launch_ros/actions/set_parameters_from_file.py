"""A file of parameters for what comes next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch_ros.utilities.parameters import add_global_parameters, normalize_parameters

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class SetParametersFromFile(Action):
    """A file that all nodes which come next read before their own parameters."""

    def __init__(self, filename: Any, *, node_name: Any = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        del node_name  # the sections of the file say which nodes they are for
        self.__parameters = normalize_parameters([filename])

    def execute(self, context: LaunchContext) -> None:
        """Add it to what is set."""
        add_global_parameters(context, self.__parameters)
