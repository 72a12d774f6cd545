"""An engine that plays a script, to test what is built on engines."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsgen.model.transform import Pose
from wsgen.simulation.engine import Loaded, Refused, State, look_at

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from wsgen.model.transform import Vector
    from wsgen.simulation.engine import Contact, HullGap, Look, Motor, Overlap, Points
    from wsgen.simulation.scene import SpawnedRobot


class FakeEngine:
    """Moves every robot as `motion` says: a state for the seconds since the start.

    So do `positions` (of joints) and `energy`. Robots whose names are in `refuses` are refused;
    what touches lies `reach` below the root. A robot that is placed somewhere moves as if the
    script had begun there. `motors` are those that it has been given, by entity and joint, `pushes`
    the forces, by entity and link, `efforts` those in joints, by entity. Rays hit what `rays` says,
    a function from where they begin and end to fractions.
    """

    def __init__(
        self,
        motion: Callable[[float], State],
        *,
        step_seconds: float = 0.001,
        reach: float = 0.0,
        refuses: frozenset[str] = frozenset(),
        positions: Callable[[float], Mapping[str, float]] = lambda _: {},
        energy: Callable[[float], float] = lambda _: 0.0,
        overlapping: Sequence[Overlap] = (),
        gaps: Mapping[str, Sequence[HullGap]] | None = None,
        touching: Mapping[str, Sequence[Contact]] | None = None,
        rays: Callable[[Points, Points], NDArray[np.float64]] | None = None,
    ) -> None:
        self.step_seconds = step_seconds
        self.motion = motion
        self.reach = reach
        self.refuses = refuses
        self.positions_at = positions
        self.energy_at = energy
        self.overlapping = overlapping
        self.gaps = gaps or {}
        self.touching = touching or {}
        self.shift = 0.0
        self.steps = 0
        self.motors: dict[str, dict[str, Motor]] = {}
        self.pushes: dict[tuple[str, str], Vector] = {}
        self.efforts: dict[str, dict[str, float]] = {}
        self.put: dict[str, dict[str, float]] = {}  # positions that joints were put at
        self.rays = rays
        self.removed: list[str] = []
        self.velocities: dict[str, tuple[Vector, Vector]] = {}  # as they were set, by entity
        self.is_closed = False

    def spawn(self, robot: SpawnedRobot) -> Loaded | Refused:
        """The robot's own figures, or a refusal."""
        if robot.entity in self.refuses:
            return Refused("the script says so")
        model = robot.robot
        links = len(model.links) - model.fixed_to_world
        joints = 0 if model.is_static else len(model.movable_joints)
        return Loaded(links, joints, model.mass)

    def state(self, entity: str) -> State:  # noqa: ARG002  all robots move alike
        """What the script says for now."""
        state = self.motion(self.steps * self.step_seconds)
        x, y, z = state.xyz
        return replace(state, xyz=(x, y, z + self.shift))

    def look(self, entity: str) -> Look:
        """The same, as far as it is looked at every few steps."""
        return look_at(self.state(entity))

    def lowest_point(self, entity: str) -> float:
        """A fixed distance below the root."""
        return self.state(entity).xyz[2] - self.reach

    def advance(self, steps: int) -> None:
        """Go on in the script."""
        self.steps += steps

    def place(self, entity: str, pose_in_world: Pose) -> None:
        """Shift the script to that height."""
        self.shift += pose_in_world.xyz[2] - self.state(entity).xyz[2]

    def remove(self, entity: str) -> None:
        """Remember it."""
        self.removed.append(entity)

    def set_velocity(self, entity: str, linear: Vector, angular: Vector) -> None:
        """Remember it; what moves is up to the script."""
        self.velocities[entity] = linear, angular

    def set_joint_positions(self, entity: str, positions: Mapping[str, float]) -> None:
        """Remember them; what moves is up to the script."""
        self.put.setdefault(entity, {}).update(positions)

    def drive(self, entity: str, motors: Mapping[str, Motor]) -> None:
        """Remember them; what moves is up to the script."""
        self.motors.setdefault(entity, {}).update(motors)
        for name in motors:
            self.efforts.get(entity, {}).pop(name, None)

    def release(self, entity: str) -> None:
        """Forget them."""
        self.motors.pop(entity, None)
        self.efforts.pop(entity, None)

    def set_efforts(self, entity: str, efforts: Mapping[str, float]) -> None:
        """Remember them; what moves is up to the script."""
        self.efforts.setdefault(entity, {}).update(efforts)
        for name in efforts:
            self.motors.get(entity, {}).pop(name, None)

    def joint_efforts(self, entity: str) -> dict[str, float]:
        """Those that were set; motors give none."""
        return dict.fromkeys(self.joint_positions(entity), 0.0) | self.efforts.get(entity, {})

    def joint_wrench(self, entity: str, joint: str) -> tuple[Vector, Vector]:  # noqa: ARG002  as for `state`
        """Nothing."""
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)

    def joint_positions(self, entity: str) -> dict[str, float]:  # noqa: ARG002  as for `state`
        """What the script says for now."""
        return dict(self.positions_at(self.steps * self.step_seconds))

    def joint_velocities(self, entity: str) -> dict[str, float]:  # noqa: ARG002  as for `state`
        """How fast the positions of the script change."""
        now, soon = self.steps * self.step_seconds, (self.steps + 1) * self.step_seconds
        after = self.positions_at(soon)
        return {
            name: (after[name] - position) / self.step_seconds
            for name, position in self.positions_at(now).items()
        }

    def energy(self, entity: str) -> float:  # noqa: ARG002  as for `state`
        """What the script says for now."""
        return self.energy_at(self.steps * self.step_seconds)

    def overlaps(self) -> list[Overlap]:
        """What the script says."""
        return list(self.overlapping)

    def push(self, entity: str, link: str, force: Vector) -> None:
        """Remember it; what moves is up to the script."""
        self.pushes.pop((entity, link), None)
        if any(force):
            self.pushes[entity, link] = force

    def contacts(self, entity: str) -> list[Contact]:
        """What the script says, once time has passed."""
        return list(self.touching.get(entity, ())) if self.steps else []

    def hull_gaps(self, entity: str) -> list[HullGap]:
        """What the script says."""
        return list(self.gaps.get(entity, ()))

    def link_poses(self, entity: str) -> dict[str, Pose]:
        """The root's alone."""
        return {"root": Pose(xyz=self.state(entity).xyz)}

    def link_velocities(self, entity: str) -> dict[str, tuple[Vector, Vector]]:
        """The root's alone, as the script moves it, without turning."""
        now, after = self.state(entity).xyz, self.motion((self.steps + 1) * self.step_seconds).xyz
        shifted = (after[0], after[1], after[2] + self.shift)
        x, y, z = (b - a for a, b in zip(now, shifted, strict=True))
        step = self.step_seconds
        return {"root": ((x / step, y / step, z / step), (0.0, 0.0, 0.0))}

    def cast_rays(self, starts: Points, ends: Points) -> NDArray[np.float64]:
        """What the script says; without one, nothing is hit."""
        return np.full(len(starts), np.inf) if self.rays is None else self.rays(starts, ends)

    def corners(self, entity: str) -> list[tuple[float, float, float]]:
        """The root's alone."""
        return [self.state(entity).xyz]

    def close(self) -> None:
        """Remember it."""
        self.is_closed = True
