"""Actions of Gazebo's packages that include a launch file of theirs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.actions import IncludeLaunchDescription
from launch.base import Action
from launch_ros.substitutions import FindPackageShare

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from launch.base import LaunchDescriptionEntity
    from launch.frontend.parser import Entity
    from launch.launch_context import LaunchContext

CONTAINER = {
    "container_name": "ros_gz_container",
    "create_own_container": "False",
    "use_composition": "False",
}


def attributes_of(
    entity: Entity, parser: Any, required: Iterable[str], optional: Iterable[str]
) -> dict[str, Any]:
    """The attributes of an element that hold substitutions, but for those that it does not have."""
    texts = {name: entity.get_attr(name) for name in required}
    texts |= {name: entity.get_attr(name, optional=True) for name in optional}
    return {
        name: parser.parse_substitution(text) for name, text in texts.items() if text is not None
    }


class IncludingAction(Action):
    """Includes a launch file with its keywords as arguments."""

    launch_file: tuple[str, str]  # package and name
    required: tuple[str, ...] = ()
    defaults: Mapping[str, str]
    ignored: frozenset[str] = frozenset()  # keywords of newer releases that start nothing else

    def __init__(self, **kwargs: Any) -> None:
        missing = [name for name in self.required if name not in kwargs]
        if missing:
            raise TypeError(
                f"{type(self).__name__}.__init__() missing {len(missing)} required keyword-only "
                f"argument(s): {', '.join(map(repr, missing))}"
            )
        names = (*self.required, *self.defaults)
        values = {name: kwargs.get(name, self.defaults.get(name)) for name in names}
        self.__arguments = [
            (name, str(value) if isinstance(value, bool) else value)
            for name, value in values.items()
        ]
        super().__init__(
            **{
                name: value
                for name, value in kwargs.items()
                if name not in values and name not in self.ignored
            }
        )

    @classmethod
    def parse(cls, entity: Entity, parser: Any, ignore: Iterable[str] = ()) -> tuple[Any, Any]:
        """Itself and its keywords, from an element of XML or YAML."""
        _, keywords = super().parse(entity, parser, ignore)
        return cls, {**keywords, **attributes_of(entity, parser, cls.required, cls.defaults)}

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Include it."""
        del context
        package, name = self.launch_file
        include = IncludeLaunchDescription(
            [FindPackageShare(package), f"/launch/{name}"], launch_arguments=self.__arguments
        )
        include.wsgen_location = self.wsgen_location
        return [include]
