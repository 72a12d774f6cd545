"""An engine that plays a script, to test what is built on engines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.simulation.engine import Loaded, Refused, State

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.simulation.scene import SpawnedRobot

PNG = b"\x89PNG\r\n\x1a\n"


class FakeEngine:
    """Moves every robot as `motion` says: a state for the seconds since the start.

    Robots whose names are in `refuses` are refused; what touches lies `reach` below the root.
    """

    def __init__(
        self,
        motion: Callable[[float], State],
        *,
        step_seconds: float = 0.001,
        reach: float = 0.0,
        refuses: frozenset[str] = frozenset(),
    ) -> None:
        self.step_seconds = step_seconds
        self.motion = motion
        self.reach = reach
        self.refuses = refuses
        self.steps = 0
        self.is_closed = False

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """The robot's own figures, or a refusal."""
        if robot.entity in self.refuses:
            return Refused("the script says so")
        model = robot.robot
        return Loaded(len(model.links), len(model.movable_joints), model.mass)

    def state(self, entity: str) -> State:  # noqa: ARG002  all robots move alike
        """What the script says for now."""
        return self.motion(self.steps * self.step_seconds)

    def lowest_point(self, entity: str) -> float:
        """A fixed distance below the root."""
        return self.state(entity).xyz[2] - self.reach

    def advance(self, steps: int) -> None:
        """Go on in the script."""
        self.steps += steps

    def draw(self, file: Path) -> float:
        """Leave the first bytes of a PNG."""
        file.write_bytes(PNG)
        return 1.0

    def close(self) -> None:
        """Remember it."""
        self.is_closed = True
