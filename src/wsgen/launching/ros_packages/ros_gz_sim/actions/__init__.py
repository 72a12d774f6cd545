"""The actions of ros_gz_sim."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.base import Action
from launch.frontend.expose import expose_action
from launch_ros.actions import Node
from wsgen.launching.ros_packages.including import CONTAINER, IncludingAction, attributes_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.base import LaunchDescriptionEntity
    from launch.frontend.parser import Entity
    from launch.launch_context import LaunchContext


@expose_action("gz_server")
class GzServer(IncludingAction):
    """Starts the server of Gazebo, as a process or in a container."""

    launch_file = ("ros_gz_sim", "gz_server.launch.py")
    defaults = {"world_sdf_file": "", "world_sdf_string": "", **CONTAINER}  # noqa: RUF012
    ignored = frozenset(("initial_sim_time", "start_paused", "verbosity_level"))


@expose_action("gz_spawn_model")
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

    @classmethod
    def parse(cls, entity: Entity, parser: Any, ignore: Iterable[str] = ()) -> tuple[Any, Any]:
        """Itself and its keywords, from an element of XML or YAML."""
        _, keywords = super().parse(entity, parser, ignore)
        names = (*("world", "file", "model_string", "topic", "entity_name"), "allow_renaming")
        pose = ("x", "y", "z", "roll", "pitch", "yaw")
        return cls, {**keywords, **attributes_of(entity, parser, (), (*names, *pose))}

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Start the program that does it."""
        del context
        node = Node(package="ros_gz_sim", executable="create", parameters=[self.__parameters])
        node.wsgen_location = self.wsgen_location
        return [node]
