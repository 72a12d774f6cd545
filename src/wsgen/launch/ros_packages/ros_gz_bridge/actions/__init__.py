"""The action of ros_gz_bridge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.base import Action
from launch_ros.actions import Node
from wsgen.launch.ros_packages.containers import in_container

if TYPE_CHECKING:
    from launch.base import LaunchDescriptionEntity
    from launch.launch_context import LaunchContext


class RosGzBridge(Action):
    """Starts the bridge between ROS and Gazebo, as a process or in a container."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        bridge_name: Any,
        config_file: Any,
        container_name: Any = "ros_gz_container",
        create_own_container: Any = False,
        namespace: Any = "",
        use_composition: Any = False,
        use_respawn: Any = False,
        log_level: Any = "info",
        bridge_params: Any = None,
        extra_bridge_params: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        del (
            use_respawn,
            bridge_params,
            extra_bridge_params,
        )  # they decide nothing about what is started
        self.__name = bridge_name
        self.__namespace = namespace
        self.__config_file = config_file
        self.__log_level = log_level
        self.__container = (container_name, create_own_container, use_composition)

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Start it."""
        inside = in_container(
            context,
            self.__container,
            package="ros_gz_bridge",
            plugin="ros_gz_bridge::RosGzBridge",
            name=self.__name,
            namespace=self.__namespace,
            parameters=[{"config_file": self.__config_file}],
        )
        node = Node(
            package="ros_gz_bridge",
            executable="bridge_node",
            name=self.__name,
            namespace=self.__namespace,
            parameters=[{"config_file": self.__config_file}],
            arguments=["--ros-args", "--log-level", self.__log_level],
        )
        made: LaunchDescriptionEntity = inside or node
        made.wsgen_location = self.wsgen_location
        return [made]
