"""The trial: spawn, let go, measure. It judges nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from wsgen.model.pose import Pose
from wsgen.model.transform import (
    multiply,
    rotation_of_quaternion,
    rotation_of_rpy,
    rpy_of_rotation,
    transpose,
)
from wsgen.simulation.engine import Loaded, Refused
from wsgen.simulation.scene import RobotTrial

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.simulation.engine import Engine, State
    from wsgen.simulation.scene import Scene, SpawnedRobot

# Reading a state costs as much as several steps. Bodies keep their speed between contacts, so
# that a look every 10 ms misses neither a jump nor the moment of coming to rest.
LOOK_EVERY = 0.01  # s, simulated

# What a person calls standing still. Contact solvers leave about 1e-3 on a body at rest.
REST_SPEED = 0.01  # m/s
REST_TURNING = 0.05  # rad/s
REST_JOINT_SPEED = 0.05  # rad/s or m/s
REST_HELD = 0.1  # s; at the top of its jump a body is slow for less than this


@dataclass
class _Watch:
    """What has been seen of one robot so far."""

    spawned: SpawnedRobot
    loaded: Loaded
    lowest_point: float
    last: State
    is_finite: bool = True
    moving_until: float = 0.0  # s
    highest_speed: float = 0.0
    highest_point: float = field(init=False)

    def __post_init__(self) -> None:
        self.highest_point = self.last.xyz[2]

    def look(self, seconds: float, state: State) -> None:
        """Take in the state after so many seconds."""
        if not all(
            map(
                math.isfinite,
                (*state.xyz, *state.xyzw, state.speed, state.turning, state.joint_speed),
            )
        ):
            self.is_finite = False
        if not self.is_finite:
            return  # the last finite state is what is told
        self.last = state
        self.highest_speed = max(self.highest_speed, state.speed)
        self.highest_point = max(self.highest_point, state.xyz[2])
        if (
            state.speed > REST_SPEED
            or state.turning > REST_TURNING
            or state.joint_speed > REST_JOINT_SPEED
        ):
            self.moving_until = seconds


def play(
    engine: Engine, scene: Scene, announce: Callable[[str], None]
) -> tuple[list[RobotTrial], dict[str, Refused]]:
    """Spawn the robots, let them go for the scene's seconds, and measure.

    Gives the trials of the robots that the engine accepted, and why it refused the others, by
    entity. It ends early only when no robot has a finite state any more. `announce` is told what
    comes next.
    """
    watches, refused = _spawn(engine, scene, announce)
    for watch in watches:  # when all are there
        watch.lowest_point = engine.lowest_point(watch.spawned.entity)
    announce(f"simulating {scene.seconds:g} s")
    steps = round(scene.seconds / engine.step_seconds)
    stride = max(1, round(LOOK_EVERY / engine.step_seconds))
    done = 0
    while done < steps and any(watch.is_finite for watch in watches):
        now = min(stride, steps - done)
        engine.advance(now)
        done += now
        for watch in watches:
            seconds = round(done * engine.step_seconds, 9)  # no more digits than it has
            watch.look(seconds, engine.state(watch.spawned.entity))
    return [_measured(engine, scene, watch) for watch in watches], refused


def _spawn(
    engine: Engine, scene: Scene, announce: Callable[[str], None]
) -> tuple[list[_Watch], dict[str, Refused]]:
    watches, refused = [], {}
    for robot in scene.robots:
        announce(f"loading the robot `{robot.entity}`")
        outcome = engine.spawn(robot)
        if isinstance(outcome, Refused):
            refused[robot.entity] = outcome
        else:
            watches.append(_Watch(robot, outcome, 0.0, engine.state(robot.entity)))
    return watches, refused


def _measured(engine: Engine, scene: Scene, watch: _Watch) -> RobotTrial:
    last = watch.last
    rotation = rotation_of_quaternion(last.xyzw)
    spawn_pose = watch.spawned.pose_in_world
    # Up in the world, in the robot's frame at the start, and back in the world at the end.
    turned = multiply(rotation, transpose(rotation_of_rpy(spawn_pose.rpy)))
    lowest = engine.lowest_point(watch.spawned.entity) if watch.is_finite else last.xyz[2]
    settled = watch.is_finite and watch.moving_until <= scene.seconds - REST_HELD
    return RobotTrial(
        entity=watch.spawned.entity,
        links=watch.loaded.links,
        movable_joints=watch.loaded.movable_joints,
        mass=watch.loaded.mass,
        lowest_point=watch.lowest_point,
        penetration=max(0.0, -watch.lowest_point) if scene.world.has_ground_plane else 0.0,
        lowest_point_at_end=lowest,
        is_finite=watch.is_finite,
        settled_after=watch.moving_until if settled else None,
        rest_pose=Pose(xyz=last.xyz, rpy=rpy_of_rotation(rotation)),
        speed=last.speed,
        turning=last.turning,
        joint_speed=last.joint_speed,
        highest_speed=watch.highest_speed,
        highest_point=watch.highest_point,
        tilt=math.acos(min(1.0, max(-1.0, turned[2][2]))),
    )
