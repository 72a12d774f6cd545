"""Remappings of topics and names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.substitution import Substitution

    Rules = list[tuple[list[Substitution], list[Substitution]]]


def normalize_remap_rules(rules: Iterable[Any]) -> Rules:
    """Pairs of what is remapped and what to."""
    normalized = []
    for rule in rules:
        pair = tuple(rule)
        if len(pair) != 2:  # noqa: PLR2004  a pair
            raise TypeError(f"remap rule must be a pair of substitutions, got '{rule}'")
        normalized.append(
            (
                normalize_to_list_of_substitutions(pair[0]),
                normalize_to_list_of_substitutions(pair[1]),
            )
        )
    return normalized


def perform_remap_rules(context: LaunchContext, rules: Rules) -> list[tuple[str, str]]:
    """The pairs as texts; those of `SetRemap` come first."""
    return [
        *context.launch_configurations.get("ros_remaps", ()),
        *(
            (perform_substitutions(context, source), perform_substitutions(context, target))
            for source, target in rules
        ),
    ]
