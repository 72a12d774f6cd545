"""Tries what a robot must do beyond standing, and measures. It judges nothing."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.transform import rotation_of_quaternion
from wsgen.simulation.controllers import UPDATE, controller_for
from wsgen.simulation.scene import TRYING, Behaved
from wsgen.simulation.trial import REST_HELD, is_finite, is_moving

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.model.behaviour import Attempt
    from wsgen.model.pose import Pose
    from wsgen.simulation.controllers import Controller
    from wsgen.simulation.engine import Engine, State
    from wsgen.simulation.scene import RobotTrial, Scene
    from wsgen.simulation.trial import Observer


def try_behaviours(  # noqa: PLR0913  as `play`, and its outcome
    engine: Engine,
    scene: Scene,
    trials: Sequence[RobotTrial],
    announce: Callable[[str], None],
    *,
    observe: Observer | None = None,
    begun: Callable[[str, float], None] = lambda _name, _seconds: None,
) -> list[RobotTrial]:
    """Try the scene's behaviours one after the other; gives the trials with what was measured.

    For each all robots are put to where they were spawned, and come to rest first. The arguments
    are those of `trial.play`, which was before; simulated time goes on. `begun` is told the name of
    a behavior and the simulated time when the robot is at rest and begins it; `observe` sees what
    it does from then on.
    """
    spawned = {trial.entity: trial.spawn_pose for trial in trials}
    session = _Session(engine, scene, spawned, observe, begun)
    measured: dict[str, list[Behaved]] = {entity: [] for entity in spawned}
    for attempt in scene.attempts:
        if attempt.entity in spawned:
            announce(TRYING.format(entity=attempt.entity, name=attempt.behaviour.name))
            measured[attempt.entity].append(session.attempt(attempt))
    return [replace(trial, behaviours=tuple(measured[trial.entity])) for trial in trials]


class _Session:
    """The scene after the robots have stood."""

    def __init__(
        self,
        engine: Engine,
        scene: Scene,
        spawned: Mapping[str, Pose],
        observe: Observer | None,
        begun: Callable[[str, float], None],
    ) -> None:
        self.engine = engine
        self.scene = scene
        self.observe = observe
        self.begun = begun
        self.robots = {robot.entity: robot.robot for robot in scene.robots}
        self.spawned = spawned
        self.steps = max(1, round(UPDATE / engine.step_seconds))  # in an update
        self.seconds = scene.seconds  # simulated until now

    def attempt(self, attempt: Attempt) -> Behaved:
        """Try one behaviour."""
        self._begin_anew()
        behaviour = attempt.behaviour
        controller = controller_for(attempt, self.robots[attempt.entity])
        self._settle(attempt.entity, controller)
        way = _Way(self.engine.state(attempt.entity))
        controller.is_begun = True
        self.begun(behaviour.name, self.seconds)
        self._show()
        for _ in range(self._updates(behaviour.seconds)):
            way.go(self._update(attempt.entity, controller))
            if not way.is_finite:
                break
        positions = self.engine.joint_positions(attempt.entity)
        self.engine.release(attempt.entity)
        numbers_are_finite = all(map(math.isfinite, positions.values()))
        return Behaved(behaviour.name, way.moved, positions, way.is_finite and numbers_are_finite)

    def _begin_anew(self) -> None:
        for entity, pose in self.spawned.items():
            if not self.robots[entity].is_static:
                self.engine.place(entity, pose)

    def _settle(self, entity: str, controller: Controller) -> None:
        """Until the robot is at rest, and no longer than it had to stand."""
        held, needed = 0, self._updates(REST_HELD)
        for _ in range(self._updates(self.scene.seconds)):
            state = self._update(entity, controller)
            held = 0 if is_moving(state) else held + 1
            if held >= needed or not is_finite(state):
                break

    def _updates(self, seconds: float) -> int:
        return round(seconds / (self.steps * self.engine.step_seconds))

    def _update(self, entity: str, controller: Controller) -> State:
        """Let the controller do its work, and time pass to its next turn."""
        motors = controller.motors(self.engine.joint_positions(entity))
        self.engine.drive(entity, motors)
        self.engine.advance(self.steps)
        self.seconds += self.steps * self.engine.step_seconds
        if controller.is_begun:
            self._show()
        return self.engine.state(entity)

    def _show(self) -> None:
        if self.observe is not None:
            self.observe(self.seconds, list(self.spawned))


class _Way:
    """How far a robot has come since it began."""

    def __init__(self, start: State) -> None:
        self.is_finite = is_finite(start)
        self._xyz = start.xyz
        self._heading = self._last = _heading(start) if self.is_finite else 0.0
        self.moved = (0.0, 0.0, 0.0)  # m, m, rad

    def go(self, state: State) -> None:
        """Take in where it is an update later."""
        self.is_finite = self.is_finite and is_finite(state)
        if not self.is_finite:
            return
        heading = _heading(state)
        turned = self.moved[2] + math.remainder(heading - self._last, math.tau)
        self._last = heading
        east, north = state.xyz[0] - self._xyz[0], state.xyz[1] - self._xyz[1]
        sin, cos = math.sin(self._heading), math.cos(self._heading)
        self.moved = (cos * east + sin * north, cos * north - sin * east, turned)


def _heading(state: State) -> float:
    """Of the root link's x axis on the ground, rad."""
    rotation = rotation_of_quaternion(state.xyzw)
    return math.atan2(rotation[1][0], rotation[0][0])
