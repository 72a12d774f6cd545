"""A scene that goes on as commands say: the engine's side of `wsgen.simulation.session`.

Time passes in pieces that end with the updates of controllers, every `UPDATE` since the beginning,
so that two commands of half a second do what one of a second does.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.behavior import Drive, Reach
from wsgen.model.transform import Pose, rotation_of_quaternion, rpy_of_rotation
from wsgen.simulation.controllers import UPDATE, DiffDriveController, PositionController
from wsgen.simulation.engine import Motor, is_finite
from wsgen.simulation.sampling import Odometer
from wsgen.simulation.session import Moment, Opened, RobotState, Watched
from wsgen.simulation.simulate import brake, spawn_robots, tilt_of, watch_robots
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.model.behavior import DiffDrive
    from wsgen.model.robot import Robot
    from wsgen.model.transform import Vector
    from wsgen.model.world import World
    from wsgen.simulation.engine import Contact, Engine
    from wsgen.simulation.scene import Scene

    Poses = dict[str, Mapping[str, Pose]]  # of all links in the world, by entity and link


STILL: Vector = (0.0, 0.0, 0.0)


@dataclass
class _Push:
    """A force that acts for a while."""

    entity: str
    link: str
    force: Vector  # N, in the world
    until: int  # step


@dataclass
class _Control:
    """What commands a robot."""

    drive: DiffDriveController | None = None
    positions: PositionController | None = None
    motors: Mapping[str, Motor] | None = None  # beyond those, as they were given

    def next_motors(self, positions: Mapping[str, float]) -> dict[str, Motor]:
        """The motors until the next update; `positions` are those of the joints now."""
        motors: dict[str, Motor] = {}
        for controller in (self.positions, self.drive):
            if controller is not None:
                motors |= controller.motors(positions)
        return motors | dict(self.motors or {})


class RunningScene:
    """The robots of a scene in an engine, and what commands them."""

    def __init__(
        self,
        scene: Scene,
        make_engine: Callable[[World], Engine],
        announce: Callable[[str], None] = lambda _: None,
        *,
        remembered: float = 1.0,
        frames_per_second: float = 20.0,
    ) -> None:
        """Spawn the robots.

        `remembered` is how many of the last seconds are kept as frames, poses for a video.
        """
        self.scene = scene
        self.rate = frames_per_second
        self.engine: Engine
        self._make_engine = make_engine
        self._announce = announce
        self._frame_count = round(remembered * frames_per_second) + 1 if remembered else 0
        self._robots: dict[str, Robot] = {robot.entity: robot.robot for robot in scene.robots}
        self._open()

    def _open(self) -> None:
        self.engine = self._make_engine(self.scene.world)
        self._update_steps = max(1, round(UPDATE / self.engine.step_seconds))
        spawned, self.refused = spawn_robots(self.engine, self.scene, self._announce)
        self._spawned = {robot.entity: (robot, loaded, pose) for robot, loaded, pose in spawned}
        self._static = {name for name in self._spawned if self._robots[name].is_static}
        self._done = 0  # steps
        self._controls: dict[str, _Control] = {}
        self._pushes: list[_Push] = []
        self._odometers: dict[str, Odometer] = {}
        self.frames: deque[tuple[float, Poses]] = deque(maxlen=self._frame_count)
        self._remember()

    @property
    def seconds(self) -> float:
        """How much time has passed, simulated."""
        return round(self._done * self.engine.step_seconds, 9)  # no more digits than it has

    def reset(self) -> Opened:
        """Begin again, with an engine as new as that of another process; nothing commands."""
        self.engine.close()
        self._open()
        return self.opened()

    def opened(self) -> Opened:
        """What the engine made of the robots, and how all are."""
        return Opened(
            loaded={entity: loaded for entity, (_, loaded, _) in self._spawned.items()},
            spawn_poses={entity: pose for entity, (_, _, pose) in self._spawned.items()},
            refused=self.refused,
            step_seconds=self.engine.step_seconds,
            states=tuple(self._state(entity) for entity in self._spawned),
        )

    def step(self, seconds: float) -> Moment:
        """Let time pass; it stops early where the state of a robot is not finite any more."""
        left = round(seconds / self.engine.step_seconds)
        while left > 0:
            now = min(left, self._update_steps - self._done % self._update_steps)
            self._advance(now)
            left -= now
            if not all(map(self._is_finite, self._spawned.keys() - self._static)):
                break
        return self.moment()

    def watch(self, seconds: float) -> Watched:
        """Let time pass as `step` does, and measure what `run_scene` measures."""
        robot_runs = watch_robots(
            self.engine,
            replace(self.scene, seconds=seconds, pushes=()),
            list(self._spawned.values()),
            self._advance,
        )
        return Watched(robot_runs=tuple(robot_runs), moment=self.moment())

    def moment(self) -> Moment:
        """How those robots are now that can move."""
        return Moment(
            seconds=self.seconds,
            states=tuple(
                self._state(entity) for entity in self._spawned if entity not in self._static
            ),
        )

    def _advance(self, steps: int) -> None:
        """Let steps pass, with updates of the controllers between them where they are due."""
        while steps > 0:
            if self._done % self._update_steps == 0:
                self._update()
            now = min(steps, self._update_steps - self._done % self._update_steps)
            now = min([now, *(push.until - self._done for push in self._pushes)])
            self.engine.advance(now)
            self._done += now
            steps -= now
            self._end_pushes()
            for entity, odometer in self._odometers.items():
                odometer.go(self.engine.state(entity))
            self._remember()

    def _update(self) -> None:
        for entity, control in self._controls.items():
            motors = control.next_motors(self.engine.joint_positions(entity))
            self.engine.drive(entity, motors)

    def _remember(self) -> None:
        """Keep a frame, if it is time for one."""
        frames, every = self.frames, 1 / self.rate
        if not frames.maxlen or (frames and self.seconds < frames[-1][0] + every - 1e-9):
            return
        last = frames[-1][1] if frames else {}
        poses: Poses = {
            entity: last[entity]
            if entity in self._static and entity in last
            else self.engine.link_poses(entity)
            for entity in self._spawned
        }
        frames.append((self.seconds, poses))

    def _is_finite(self, entity: str) -> bool:
        return is_finite(self.engine.state(entity))

    def _state(self, entity: str) -> RobotState:
        engine, (_, _, spawn_pose) = self.engine, self._spawned[entity]
        state = engine.state(entity)
        rotation = rotation_of_quaternion(state.xyzw)
        return RobotState(
            entity=entity,
            pose_in_world=Pose(xyz=state.xyz, rpy=rpy_of_rotation(rotation)),
            links=engine.link_poses(entity),
            joint_positions=engine.joint_positions(entity),
            joint_velocities=engine.joint_velocities(entity),
            speed=state.speed,
            turning=state.turning,
            tilt=tilt_of(rotation, spawn_pose),
            is_finite=is_finite(state),
        )

    def drive(self, entity: str, drive: DiffDrive, linear: float, angular: float) -> None:
        """From now on, drive as a Twist on /cmd_vel says, until the next one (m/s, rad/s)."""
        control = self._control(entity)
        task = Drive(linear=linear, angular=angular)
        if control.drive is None:
            control.drive = DiffDriveController(drive, task, self._robots[entity])
            control.drive.has_begun = True
        control.drive.task = task

    def hold(self, entity: str, positions: Mapping[str, float]) -> None:
        """From now on, command these positions (rad or m); the other joints keep theirs."""
        control = self._control(entity)
        before = control.positions.commands if control.positions is not None else {}
        task = Reach(positions={**before, **positions})
        control.positions = PositionController(task, self._robots[entity])
        control.positions.has_begun = True

    def set_motors(self, entity: str, motors: Mapping[str, tuple[float, float]]) -> None:
        """From now on, have motors in these joints: speed and effort by joint."""
        control = self._control(entity)
        given = {joint: Motor(*motor) for joint, motor in motors.items()}
        control.motors = {**(control.motors or {}), **given}

    def release(self, entity: str) -> None:
        """Take away what commands the robot: its joints are as when it was spawned."""
        self._controls.pop(entity, None)
        self.engine.release(entity)
        brake(self.engine, self._spawned[entity][0])

    def _control(self, entity: str) -> _Control:
        return self._controls.setdefault(entity, _Control())

    def push(self, entity: str, link: str, force: Vector, seconds: float) -> None:
        """From now on, have a force (N, in the world) act on a link, as long as that.

        Forces on one link add up.
        """
        steps = max(1, round(seconds / self.engine.step_seconds))
        self._pushes.append(_Push(entity, link, force, self._done + steps))
        self._set_force(entity, link)

    def measure(self, entity: str) -> None:
        """From now on, measure how far a robot moves."""
        self._odometers[entity] = Odometer(self.engine.state(entity))

    def moved(self, entity: str) -> tuple[float, float, float]:
        """How far a robot has moved since it is measured: ahead, to the left (m), turned (rad)."""
        return self._odometers[entity].moved

    def _end_pushes(self) -> None:
        ended = [push for push in self._pushes if push.until <= self._done]
        self._pushes = [push for push in self._pushes if push.until > self._done]
        for entity, link in {(push.entity, push.link) for push in ended}:
            self._set_force(entity, link)

    def _set_force(self, entity: str, link: str) -> None:
        forces = [push.force for push in self._pushes if (push.entity, push.link) == (entity, link)]
        x, y, z = map(math.fsum, zip(STILL, *forces, strict=True))
        self.engine.push(entity, link, (x, y, z))

    def contacts(self, entity: str) -> list[Contact]:
        """What a robot touched in the last step."""
        return self.engine.contacts(entity)

    def lowest_point(self, entity: str) -> float:
        """The z of the lowest point that can touch something, m."""
        return self.engine.lowest_point(entity)
