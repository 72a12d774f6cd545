"""Rules about the bodies of a robot: its links, with those that fixed joints lump into them.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.model.robot import MOST_LINKS

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot


MANY_LINKS = Rule(
    code="ROB123",
    name="many-links",
    severity=Severity.INFO,
    summary="The robot has more links than PyBullet simulates.",
    what=f"Counts the links that are left when fixed joints are lumped; reports more than "
    f"{MOST_LINKS}.",
    why="PyBullet does not simulate such a robot. Gazebo and other engines do, the slower the more "
    "links it has.",
    example="A conveyor of 200 rollers, each with a `continuous` joint.",
    instead="The same conveyor, in which the rollers that nothing touches have `fixed` joints.",
)


def many_links(lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report a robot with more bodies than an engine takes."""
    number = len(lumped.links)
    if number > MOST_LINKS and not lumped.loose:  # else it is several trees, each with a limit
        yield MANY_LINKS.at(
            file,
            lumped.links[0].line,
            "robot",
            message=f"The robot has {number} links after lumping: PyBullet simulates at most "
            f"{MOST_LINKS}.",
            hint='Write type="fixed" for joints that need not move, or simulate it with --engine '
            "mujoco.",
        )
