"""The actions of ros_gz_sim."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.base import Action
from launch_ros.actions import Node
from wsgen.launch.ros_packages.containers import in_container

if TYPE_CHECKING:
    from launch.base import LaunchDescriptionEntity
    from launch.launch_context import LaunchContext


# Of newer releases; they decide nothing about what is started.
_HOW_IT_RUNS = {"initial_sim_time", "start_paused", "verbosity_level"}


class GzServer(Action):
    """Starts the server of Gazebo, as a process or in a container."""

    def __init__(
        self,
        *,
        world_sdf_file: Any = "",
        world_sdf_string: Any = "",
        container_name: Any = "ros_gz_container",
        create_own_container: Any = False,
        use_composition: Any = False,
        **kwargs: Any,
    ) -> None:
        for name in _HOW_IT_RUNS & set(kwargs):
            del kwargs[name]
        super().__init__(**kwargs)
        self.__world = {"world_sdf_file": world_sdf_file, "world_sdf_string": world_sdf_string}
        self.__container = (container_name, create_own_container, use_composition)

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Start it."""
        inside = in_container(
            context,
            self.__container,
            package="ros_gz_sim",
            plugin="ros_gz_sim::GzServer",
            name="gz_server",
            parameters=[self.__world],
        )
        node = Node(package="ros_gz_sim", executable="gzserver", parameters=[self.__world])
        made: LaunchDescriptionEntity = inside or node
        made.wsgen_location = self.wsgen_location
        return [made]


class GzSpawnModel(Action):
    """Puts a model into the world."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        world: Any = "",
        file: Any = "",
        model_string: Any = "",
        topic: Any = "",
        entity_name: Any = "",
        allow_renaming: Any = False,
        x: Any = "0.0",
        y: Any = "0.0",
        z: Any = "0.0",
        roll: Any = "0.0",
        pitch: Any = "0.0",
        yaw: Any = "0.0",
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__parameters = {
            "world": world,
            "file": file,
            "string": model_string,
            "topic": topic,
            "name": entity_name,
            "allow_renaming": allow_renaming,
            "x": x,
            "y": y,
            "z": z,
            "R": roll,
            "P": pitch,
            "Y": yaw,
        }

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Start the program that does it."""
        del context
        node = Node(package="ros_gz_sim", executable="create", parameters=[self.__parameters])
        node.wsgen_location = self.wsgen_location
        return [node]
