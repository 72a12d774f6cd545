"""A list of entities."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.launch_description_entity import LaunchDescriptionEntity

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from launch.actions.declare_launch_argument import DeclareLaunchArgument
    from launch.actions.include_launch_description import IncludeLaunchDescription
    from launch.launch_context import LaunchContext

    Declared = tuple[DeclareLaunchArgument, tuple[IncludeLaunchDescription, ...]]


class LaunchDescription(LaunchDescriptionEntity):
    """What a launch file gives."""

    def __init__(
        self,
        initial_list_of_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self.entities = [] if initial_list_of_entities is None else list(initial_list_of_entities)
        self.deprecated_reason = deprecated_reason

    @property
    def deprecated(self) -> bool:
        """Whether a reason was given not to use it any more."""
        return self.deprecated_reason is not None

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Give the entities."""
        del context
        return self.entities

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The entities."""
        return self.entities

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Append an entity."""
        self.entities.append(entity)

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Append an action."""
        self.add_entity(action)

    def get_launch_arguments(
        self,
        conditional_inclusion: bool = False,  # noqa: FBT001, FBT002  as the original
    ) -> list[DeclareLaunchArgument]:
        """The arguments that it and what it includes declare, each name once."""
        return [
            argument
            for argument, _ in self.get_launch_arguments_with_include_launch_description_actions(
                conditional_inclusion
            )
        ]

    def get_launch_arguments_with_include_launch_description_actions(
        self,
        conditional_inclusion: bool = False,  # noqa: FBT001, FBT002  as the original
    ) -> list[Declared]:
        """The declared arguments, each with the includes that lie between."""
        by_name: dict[str, Declared] = {}
        for argument, includes in _declared(self.entities, (), conditional_inclusion):
            by_name.setdefault(argument.name, (argument, includes))
        return list(by_name.values())


def _declared(
    entities: Iterable[LaunchDescriptionEntity],
    includes: tuple[IncludeLaunchDescription, ...],
    conditional: bool,  # noqa: FBT001  handed through
) -> Iterator[Declared]:
    from launch.actions.declare_launch_argument import DeclareLaunchArgument
    from launch.actions.include_launch_description import IncludeLaunchDescription
    from launch.actions.reset_launch_configurations import ResetLaunchConfigurations

    for entity in entities:
        if isinstance(entity, DeclareLaunchArgument):
            entity.conditionally_included = entity.conditionally_included or conditional
            yield entity, includes
        if isinstance(entity, ResetLaunchConfigurations):
            return
        path = (*includes, entity) if isinstance(entity, IncludeLaunchDescription) else includes
        yield from _declared(entity.describe_sub_entities(), path, conditional)
        for _, group in entity.describe_conditional_sub_entities():
            yield from _declared(group, path, conditional=True)
