"""How a robot moved over simulated time. SI units; poses in the world frame."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  the type hints of answers are read

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class TimeSeries:
    """Samples of one robot while it stood, or during one behavior; all of them equally long."""

    behavior: str | None = None  # its name; None: from spawning to the end of the simulation
    seconds: tuple[float, ...]  # simulated, since it was spawned or began the behavior
    positions: tuple[tuple[float, float, float], ...]  # m, of the root link's frame
    speeds: tuple[float, ...]  # m/s, of the root link's center of mass
    tilts: tuple[float, ...]  # rad, between what was up in the robot when spawned and up
    joint_positions: Mapping[str, tuple[float, ...]]  # rad or m, of the movable joints by name
    heading: float = 0.0  # rad, of the root link's x axis on the ground, at the first sample
