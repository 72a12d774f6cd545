"""Entities, nested as they may be, as one list."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from launch.launch_description_entity import LaunchDescriptionEntity


def normalize_to_list_of_entities(entities: Any) -> list[LaunchDescriptionEntity]:
    """All entities in their order; TypeError for what is none."""
    found: list[LaunchDescriptionEntity] = []
    for entity in entities if isinstance(entities, Iterable) else [entities]:
        if isinstance(entity, LaunchDescriptionEntity):
            found.append(entity)
        elif isinstance(entity, Iterable) and not isinstance(entity, str):
            found.extend(normalize_to_list_of_entities(entity))
        else:
            raise TypeError(
                f"Failed to normalize given item of type '{type(entity)}' to a launch entity."
            )
    return found
