"""The simulation: spawn, let go, run the behaviors, measure; `wsgen.checks.rules` checks.

A robot is driven by its diff drive plugin or by ros2_control, as in Gazebo (`controllers`).
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import field, replace
from typing import TYPE_CHECKING, Protocol

from wsgen.model.transform import (
    Pose,
    multiply,
    rotation_of_quaternion,
    rotation_of_rpy,
    rpy_of_rotation,
    transpose,
)
from wsgen.simulation.controllers import UPDATE, controller_for
from wsgen.simulation.engine import Refused, is_finite
from wsgen.simulation.sampling import Odometer
from wsgen.simulation.scene import LOADING, RUNNING, BehaviorMeasurement, Overlapping, RobotRun
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.model.robot import Robot
    from wsgen.model.transform import Matrix
    from wsgen.model.world import World
    from wsgen.simulation.engine import Engine, Loaded, Look, Overlap, State
    from wsgen.simulation.scene import Push, Scene, SpawnedRobot

    Observer = Callable[
        [float, Sequence[str]], None
    ]  # simulated seconds, the robots that are there
    from collections.abc import Callable, Sequence

    from wsgen.model.behavior import BehaviorRun
    from wsgen.simulation.controllers import Controller


# Reading a state costs as much as several steps. Bodies keep their speed between contacts, so
# that a look every 10 ms misses neither a jump nor the moment of coming to rest.
LOOK_EVERY = 0.01  # s, simulated
LONG_LOOK = 10  # looks from one look at energy and joints, which costs more, to the next

FALLING_LOOKS = 20  # what is in the air for less is bouncing
FALLS_WITH = 0.7  # of gravity; on a slope of 45 degrees what slides gets faster with half of it
CLEARANCE = 0.005  # m, between the ground and what is spawned just above it

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
    pose: Pose  # where it was spawned, in the world
    last_look: Look
    lowest_point: float
    energy: float  # J, when spawned
    joints: Mapping[str, float]  # positions when spawned, rad or m
    is_finite: bool = True
    moving_until: float = 0.0  # s
    highest_speed: float = 0.0
    highest_joint_speed: float = 0.0
    seconds: float = 0.0  # of the last look
    heights: deque[tuple[float, float]] = field(  # s, m: of the last looks
        default_factory=lambda: deque(maxlen=FALLING_LOOKS + 1)
    )
    highest_point: float = field(init=False)
    energy_gain: float = 0.0
    last_joints: Mapping[str, float] = field(init=False)
    travel: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        self.highest_point = self.last_look.height
        self.last_joints = self.joints
        self.travel = dict.fromkeys(self.joints, 0.0)

    @property
    def last(self) -> State:
        """How it was when it was last finite."""
        return self.last_look.state()

    def look(self, seconds: float, look: Look) -> None:
        """Take in how it is after so many seconds."""
        self.seconds = seconds
        if not look.is_finite:
            self.is_finite = False
        if not self.is_finite:
            return  # the last finite state is reported
        self.last_look = look
        self.heights.append((seconds, look.height))
        self.highest_speed = max(self.highest_speed, look.speed)
        self.highest_joint_speed = max(self.highest_joint_speed, look.joint_speed)
        self.highest_point = max(self.highest_point, look.height)
        if is_moving(look):
            self.moving_until = seconds

    def climb(self) -> float:
        """How fast its root rose, m/s, over the last looks."""
        if len(self.heights) < 2:  # noqa: PLR2004  two points make a line
            return 0.0
        (first, low), (last, high) = self.heights[0], self.heights[-1]
        return (high - low) / (last - first)

    def acceleration(self) -> float:
        """How it gets faster upwards, m/s², over the last looks."""
        if len(self.heights) <= FALLING_LOOKS:
            return 0.0
        (first, low), (third, high) = self.heights[0], self.heights[-1]
        second, middle = self.heights[FALLING_LOOKS // 2]
        before = (middle - low) / (second - first)
        return 2 * ((high - middle) / (third - second) - before) / (third - first)

    def push(self, energy: float) -> None:
        """Take in the energy while something pushes, which may well give it more."""
        if self.is_finite and math.isfinite(energy):
            self.energy = max(self.energy, energy)

    def look_long(self, energy: float, joints: Mapping[str, float]) -> None:
        """Take in what is looked at less often."""
        if not self.is_finite or not all(map(math.isfinite, (energy, *joints.values()))):
            self.is_finite = False
            return
        self.energy_gain = max(self.energy_gain, energy - self.energy)
        self.last_joints = joints
        for name, position in joints.items():
            self.travel[name] = max(self.travel[name], abs(position - self.joints[name]))


class Motion(Protocol):
    """How fast a robot moves; see `State`."""

    @property
    def speed(self) -> float:
        """That of the root link's center of mass, m/s."""

    @property
    def turning(self) -> float:
        """That of the root link, rad/s."""

    @property
    def joint_speed(self) -> float:
        """That of the fastest joint, rad/s or m/s."""


def is_moving(state: Motion) -> bool:
    """Whether a person would not call it standing still."""
    return (
        state.speed > REST_SPEED
        or state.turning > REST_TURNING
        or state.joint_speed > REST_JOINT_SPEED
    )


def run_scene(
    engine: Engine,
    scene: Scene,
    announce: Callable[[str], None],
    observe: Observer | None = None,
) -> tuple[list[RobotRun], dict[str, Refused]]:
    """Spawn the robots, let them go for the scene's seconds, and measure.

    Gives the runs of the robots that the engine accepted, and why it refused the others, by
    entity. It ends when the state of one is not finite any more: nothing that touches it moves as
    it should, and some engines print a warning every step. `announce` gets what comes next;
    `observe` is called when all are there, and at every look from then on.
    """
    spawned, refused = spawn_robots(engine, scene, announce)
    announce(f"simulating {scene.seconds:g} s")
    return watch_robots(engine, scene, spawned, engine.advance, observe), refused


class _Pushes:
    """The pushes of a scene; called instead of `advance`, it begins and ends them in time."""

    def __init__(
        self, engine: Engine, pushes: Iterable[Push], advance: Callable[[int], None]
    ) -> None:
        self._engine = engine
        self._advance = advance
        self._done = 0  # steps
        self._pushes = [
            (begin, begin + max(1, round(push.seconds / engine.step_seconds)), push)
            for push in pushes
            for begin in (round(push.begin / engine.step_seconds),)
        ]
        self._changes = sorted({step for begin, end, _ in self._pushes for step in (begin, end)})
        self.has_pushed = False  # in the last call

    def __call__(self, steps: int) -> None:
        """Let so many steps pass."""
        self.has_pushed = False
        last = self._done + steps
        while self._done < last:
            if self._done in self._changes:
                self._set_forces()
            now = min([last, *(step for step in self._changes if step > self._done)]) - self._done
            self.has_pushed |= any(begin <= self._done < end for begin, end, _ in self._pushes)
            self._advance(now)
            self._done += now

    def end(self) -> None:
        """End those that still act."""
        self._done = max([self._done, *self._changes])
        self._set_forces()

    def _set_forces(self) -> None:
        acting = [push for begin, end, push in self._pushes if begin <= self._done < end]
        for entity, link in dict.fromkeys((push.entity, push.link) for _, _, push in self._pushes):
            forces = [push.force for push in acting if (push.entity, push.link) == (entity, link)]
            x, y, z = map(math.fsum, zip((0.0, 0.0, 0.0), *forces, strict=True))
            self._engine.push(entity, link, (x, y, z))


def watch_robots(
    engine: Engine,
    scene: Scene,
    spawned: Sequence[tuple[SpawnedRobot, Loaded, Pose]],
    advance: Callable[[int], None],
    observe: Observer | None = None,
) -> list[RobotRun]:
    """Let the scene's seconds pass from now on, and measure what the spawned robots do.

    `advance` lets so many steps pass in the engine; `observe` is that of `run_scene`.
    """
    watches = [  # when all are there
        _Watch(
            spawned=robot,
            loaded=loaded,
            pose=pose,
            last_look=engine.look(robot.entity),
            lowest_point=engine.lowest_point(robot.entity),
            energy=engine.energy(robot.entity),
            joints=engine.joint_positions(robot.entity),
        )
        for robot, loaded, pose in spawned
    ]
    overlaps = _overlaps(engine, scene)
    entities = [watch.spawned.entity for watch in watches]
    if observe is not None:
        observe(0.0, entities)
    acting = [push for push in scene.pushes if push.entity in entities]
    pushes = _Pushes(engine, acting, advance) if acting else None
    steps = round(scene.seconds / engine.step_seconds)
    stride = max(1, round(LOOK_EVERY / engine.step_seconds))
    done = looks = 0
    while done < steps and all(watch.is_finite for watch in watches):
        now = min(stride, steps - done)
        if pushes is None:
            advance(now)
        else:
            pushes(now)
        done += now
        looks += 1
        seconds = round(done * engine.step_seconds, 9)  # no more digits than it has
        for watch in watches:
            entity = watch.spawned.entity
            watch.look(seconds, engine.look(entity))
            if pushes is not None and pushes.has_pushed:
                watch.push(engine.energy(entity))
            if watch.is_finite and (looks % LONG_LOOK == 0 or done == steps):
                watch.look_long(engine.energy(entity), engine.joint_positions(entity))
        if observe is not None:
            observe(seconds, entities)
    if pushes is not None:
        pushes.end()
    is_cut_short = not all(watch.is_finite for watch in watches)
    return [
        _measured(engine, scene, watch, overlaps, is_cut_short=is_cut_short and watch.is_finite)
        for watch in watches
    ]


def _overlaps(engine: Engine, scene: Scene) -> list[Overlap]:
    """What is in each other when all are spawned, but for two robots that stay where they are."""
    immobile = {robot.entity for robot in scene.robots if _is_immobile(robot.robot)}
    return [
        overlap
        for overlap in engine.overlaps()
        if overlap.entity == overlap.other_entity
        or not {overlap.entity, overlap.other_entity} <= immobile
    ]


def _is_immobile(robot: Robot) -> bool:
    """Whether it stays where it is spawned, as walls do that stand in a floor."""
    return robot.is_static or robot.fixed_to_world


def spawn_robots(
    engine: Engine, scene: Scene, announce: Callable[[str], None]
) -> tuple[list[tuple[SpawnedRobot, Loaded, Pose]], dict[str, Refused]]:
    """Spawn the robots of a scene.

    Gives those that the engine accepted, with where they stand in the world, and why it refused the
    others, by entity.
    """
    spawned, refused = [], {}
    for robot in scene.robots:
        announce(LOADING.format(entity=robot.entity))
        outcome = engine.spawn(robot)
        if isinstance(outcome, Refused):
            refused[robot.entity] = outcome
        else:
            pose = _put_on_the_ground(engine, robot, scene.world)
            brake(engine, robot)
            spawned.append((robot, outcome, pose))
    return spawned, refused


def brake(engine: Engine, robot: SpawnedRobot) -> None:
    """Have the plugin that drives a robot keep its wheels still, as Gazebo's do without a command.

    All other joints stay as they are.
    """
    if robot.drive is None:
        return
    from wsgen.model.behavior import Drive  # noqa: PLC0415  most robots have no such plugin
    from wsgen.simulation.controllers import DiffDriveController  # noqa: PLC0415

    engine.drive(robot.entity, DiffDriveController(robot.drive, Drive(), robot.robot).motors({}))


def _put_on_the_ground(engine: Engine, robot: SpawnedRobot, world: World) -> Pose:
    """Lower or lift a robot that is to stand on the ground; gives its pose in the world.

    What is fixed to the world stays where it is.
    """
    pose = robot.pose_in_world
    if _is_immobile(robot.robot) or not (robot.on_the_ground and world.has_ground_plane):
        return pose
    # Out of the ground first: engines know the lowest point best from above.
    lowest = min(corner[2] for corner in engine.corners(robot.entity))
    for _ in range(2):
        x, y, z = pose.xyz
        pose = replace(pose, xyz=(x, y, z + CLEARANCE - lowest))
        engine.place(robot.entity, pose)
        lowest = engine.lowest_point(robot.entity)
    return pose


def _measured(
    engine: Engine, scene: Scene, watch: _Watch, overlaps: Sequence[Overlap], *, is_cut_short: bool
) -> RobotRun:
    last = watch.last
    rotation = rotation_of_quaternion(last.xyzw)
    lowest = engine.lowest_point(watch.spawned.entity) if watch.is_finite else last.xyz[2]
    settled = watch.is_finite and watch.moving_until <= scene.seconds - REST_HELD
    return RobotRun(
        entity=watch.spawned.entity,
        links=watch.loaded.links,
        movable_joints=watch.loaded.movable_joints,
        mass=watch.loaded.mass,
        spawn_pose=watch.pose,
        overlaps=tuple(_of_one(overlaps, watch.spawned.entity)),
        lowest_point=watch.lowest_point,
        penetration=max(0.0, -watch.lowest_point) if scene.world.has_ground_plane else 0.0,
        lowest_point_at_end=lowest,
        is_finite=watch.is_finite,
        is_cut_short=is_cut_short,
        settled_after=watch.moving_until if settled else None,
        rest_pose=Pose(xyz=last.xyz, rpy=rpy_of_rotation(rotation)),
        speed=last.speed,
        turning=last.turning,
        joint_speed=last.joint_speed,
        climb=watch.climb(),
        highest_speed=watch.highest_speed,
        highest_point=watch.highest_point,
        highest_joint_speed=watch.highest_joint_speed,
        seconds=watch.seconds,
        tilt=tilt_of(rotation, watch.pose),
        energy_gain=watch.energy_gain,
        joint_positions=watch.last_joints,
        joint_travel=watch.travel,
        is_falling=_falls(watch.acceleration(), scene.world.gravity[2]),
        hull_gaps=tuple(engine.hull_gaps(watch.spawned.entity)) if watch.is_finite else (),
    )


def tilt_of(rotation: Matrix, spawn_pose: Pose) -> float:
    """How far from up is what was up in a robot when spawned, rad; `rotation` is its now."""
    # Up in the world, in the robot's frame at the start, and back in the world at the end.
    turned = multiply(rotation, transpose(rotation_of_rpy(spawn_pose.rpy)))
    return math.acos(min(1.0, max(-1.0, turned[2][2])))


def _falls(acceleration: float, gravity: float) -> bool:
    """Whether that is what a body does that nothing holds up; both upwards, m/s²."""
    return gravity < 0 and acceleration < FALLS_WITH * gravity


def _of_one(overlaps: Sequence[Overlap], entity: str) -> Iterator[Overlapping]:
    """The overlaps of one robot, seen from its links."""
    for overlap in overlaps:
        if overlap.entity == entity:
            other = None if overlap.other_entity == entity else overlap.other_entity
            yield Overlapping(
                link=overlap.link,
                other_entity=other,
                other_link=overlap.other_link,
                depth=overlap.depth,
            )
        elif overlap.other_entity == entity:
            yield Overlapping(
                link=overlap.other_link,
                other_entity=overlap.entity,
                other_link=overlap.link,
                depth=overlap.depth,
            )


def run_behaviors(  # noqa: PLR0913  as `run_scene`, and its outcome
    engine: Engine,
    scene: Scene,
    robot_runs: Sequence[RobotRun],
    announce: Callable[[str], None],
    *,
    observe: Observer | None = None,
    begun: Callable[[str, float], None] = lambda _name, _seconds: None,
) -> list[RobotRun]:
    """Run the scene's behaviors one after the other; gives the runs with what was measured.

    For each all robots are put to where they were spawned, and come to rest first. The arguments
    are those of `run_scene`, which was before; simulated time goes on. `begun` is called with the
    name of a behavior and the simulated time when the robot is at rest and begins it; `observe`
    sees what it does from then on.
    """
    spawned = {robot_run.entity: robot_run.spawn_pose for robot_run in robot_runs}
    runs = _Runs(engine, scene, spawned, observe, begun)
    measured: dict[str, list[BehaviorMeasurement]] = {entity: [] for entity in spawned}
    for behavior_run in scene.behavior_runs:
        if behavior_run.entity in spawned:
            announce(RUNNING.format(entity=behavior_run.entity, name=behavior_run.behavior.name))
            measured[behavior_run.entity].append(runs.run(behavior_run))
    return [
        replace(robot_run, behaviors=tuple(measured[robot_run.entity])) for robot_run in robot_runs
    ]


class _Runs:
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
        self.spawned_robots = {robot.entity: robot for robot in scene.robots}
        self.robots = {robot.entity: robot.robot for robot in scene.robots}
        self.spawned = spawned
        self.steps = max(1, round(UPDATE / engine.step_seconds))  # in an update
        self.seconds = scene.seconds  # simulated until now

    def run(self, behavior_run: BehaviorRun) -> BehaviorMeasurement:
        """Run one behavior."""
        self._reset()
        behavior = behavior_run.behavior
        controller = controller_for(behavior_run, self.robots[behavior_run.entity])
        self._settle(behavior_run.entity, controller)
        odometer = Odometer(self.engine.state(behavior_run.entity))
        controller.has_begun = True
        self.begun(behavior.name, self.seconds)
        self._show()
        for _ in range(self._updates(behavior.seconds)):
            odometer.go(self._update(behavior_run.entity, controller))
            if not odometer.is_finite:
                break
        positions = self.engine.joint_positions(behavior_run.entity)
        self.engine.release(behavior_run.entity)
        brake(self.engine, self.spawned_robots[behavior_run.entity])
        numbers_are_finite = all(map(math.isfinite, positions.values()))
        return BehaviorMeasurement(
            behavior.name, odometer.moved, positions, odometer.is_finite and numbers_are_finite
        )

    def _reset(self) -> None:
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
        """Let the controller set the motors, and time pass to its next update."""
        motors = controller.motors(self.engine.joint_positions(entity))
        self.engine.drive(entity, motors)
        self.engine.advance(self.steps)
        self.seconds += self.steps * self.engine.step_seconds
        if controller.has_begun:
            self._show()
        return self.engine.state(entity)

    def _show(self) -> None:
        if self.observe is not None:
            self.observe(self.seconds, list(self.spawned))
