"""How one package needs another one, by those between them; colcon builds no circle of packages."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Collection


def way_between(
    start: str, end: str, needed: Callable[[str], Collection[str]]
) -> tuple[str, ...] | None:
    """The shortest way from a package to one that it needs, itself or by others; both included."""
    ways: dict[str, tuple[str, ...]] = {start: (start,)}
    todo = [start]
    for name in todo:
        if name == end:
            return ways[name]
        for other in sorted(needed(name)):
            if other not in ways:
                ways[other] = (*ways[name], other)
                todo.append(other)
    return None
