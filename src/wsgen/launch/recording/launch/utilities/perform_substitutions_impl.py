"""The text that a list of substitutions gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from launch.launch_context import LaunchContext
    from launch.substitution import Substitution


def perform_substitutions(context: LaunchContext, subs: Iterable[Substitution]) -> str:
    """Their texts in order, joined without anything in between."""
    return "".join([context.perform_substitution(sub) for sub in subs])
