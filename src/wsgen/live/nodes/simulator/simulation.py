"""The simulated world of a live run: robots come and go, plugins are updated, time passes."""

from __future__ import annotations

import importlib
import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wsgen.gazebo.plugins import stem
from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.gazebo.systems import DEFAULT_SYSTEMS, loaded_class, plugin_of
from wsgen.live.nodes.simulator.host import CannotWorkError, Due, Host, RobotHandle
from wsgen.live.nodes.simulator.plugins import DONE_BY_SIMULATOR, PLUGINS, WORLD_PLUGINS
from wsgen.live.nodes.simulator.sensors import SENSORS
from wsgen.live.nodes.simulator.timing import TINY, following
from wsgen.live.nodes.simulator.topics import BadNameError
from wsgen.model.devices import Devices, in_namespace
from wsgen.simulation.simulate import spawn_robots

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.live.nodes.simulator.host import Plugin
    from wsgen.live.nodes.simulator.ros import Ros
    from wsgen.model.devices import MountedSensor
    from wsgen.model.transform import Pose
    from wsgen.simulation.engine import Engine
    from wsgen.simulation.live_runs import LiveScene, NewEntity, PreparedEntity

BRIDGES_AFTER = 5.0  # s, simulated, after a robot came, until what nobody has is named
LOOK_EVERY = 0.1  # s, simulated, between two looks at whether a robot has exploded


class Control:
    """Whether time passes, as commands and services say."""

    def __init__(self, *, is_paused: bool, limit: float = math.inf) -> None:
        self.is_paused = is_paused
        self.seconds = 0.0  # simulated, that pass although it is paused
        self.limit = limit  # s, simulated: until when time may pass, paused or not

    def passes(self, now: float) -> bool:
        """Whether any time passes at that time, s, simulated."""
        return now < self.limit - TINY and (not self.is_paused or self.seconds > 0)

    def next(self, now: float, slice_seconds: float) -> float:
        """Until when time passes next, s, simulated."""
        slice_seconds = min(slice_seconds, self.limit - now)
        if not self.is_paused:
            self.seconds = 0.0
            return now + slice_seconds
        passing = min(self.seconds, slice_seconds)
        self.seconds = 0.0 if self.seconds - passing < TINY else self.seconds - passing
        return now + passing


class RefusedError(Exception):
    """A command cannot be done; `hint` is what to do."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def _prepares_nothing(new: NewEntity) -> PreparedEntity:
    raise RefusedError(
        f"The launch file spawns no robot `{new.entity}` that wsgen has prepared.",
        "Spawn it in a launch that `wsgen launch --run` plays.",
    )


class LiveSimulation:
    """A world with its robots and their plugins."""

    def __init__(
        self, scene: LiveScene, engine: Engine, ros: Ros, announce: Callable[[str], None]
    ) -> None:
        """Put into the world what is there from the beginning."""
        self.scene = scene
        self.engine = engine
        self.host = Host(
            engine,
            ros,
            simulator=scene.simulator,
            world=scene.scene.world,
            world_name=scene.world,
        )
        self.control = Control(
            is_paused=scene.is_paused, limit=0.0 if scene.is_stepped else math.inf
        )
        self.host.rate = scene.rate
        around = scene.world_devices.surroundings if scene.world_devices is not None else ()
        self.host.surroundings = {element.tag: element for element in around}
        self._announce = announce
        self._known = {robot.entity: robot for robot in scene.scene.robots}
        self._devices = dict(scene.devices)
        self._descriptions = dict(scene.descriptions)
        self.prepare: Callable[[NewEntity], PreparedEntity] = _prepares_nothing
        self.loads = 0  # that have taken time in which none was simulated
        # What spawners of the launch file have not put into the world so far.
        self.awaited = {robot.entity for robot in scene.scene.robots}
        self._poses: dict[str, Pose] = {}  # where robots were spawned
        # The systems of Gazebo Sim that are there; None: nothing is missing.
        self._systems = None if scene.systems is None else set(scene.systems)
        # Sensors whose system is missing, which a robot may bring.
        self._waiting: list[tuple[RobotHandle, MountedSensor]] = []
        self._due: list[Due] = []
        self._steps = 0  # since the time was 0
        self._next_look = 0.0
        self._bridges_checked = math.inf  # s, simulated
        for robot in scene.scene.robots:
            if robot.is_static_model or robot.entity in scene.in_world:
                self._put(robot.entity)
        self._due += self._world_plugins()
        if not self.has("Physics"):
            self._report_missing("Physics", "nothing in it moves")

    @property
    def now(self) -> float:
        """The simulated time, s."""
        return self.host.now

    def has(self, system: str) -> bool:
        """Whether a system of Gazebo Sim is there; of Gazebo Classic, nothing is missing."""
        return self._systems is None or system in self._systems

    def _report_missing(self, system: str, consequence: str) -> None:
        self.host.warn(
            f"The world `{self.scene.world}` does not load the system {system}: {consequence}. "
            f"{_add(system)}"
        )

    def awaits(self, entity: str, new: NewEntity | None = None) -> bool:
        """Whether a robot of that name is prepared that has not been in the world so far.

        With `new`, only if it has that description and pose.
        """
        if entity not in self.awaited:
            return False
        return new is None or (
            self._descriptions.get(entity) == new.text
            and self._known[entity].pose_in_world == new.pose_in_world
        )

    def free_name(self, entity: str) -> str:
        """That name, or the next one that nothing in the world has: `box_0`, `box_1`."""
        names = itertools.chain((entity,), (f"{entity}_{n}" for n in itertools.count()))
        return next(name for name in names if name not in self.host.robots)

    def spawn_new(self, new: NewEntity, namespace: str = "", *, renames: bool = False) -> str:
        """Prepare what the launch file does not name, and put it into the world; gives its name.

        Raises:
            RefusedError: It cannot be prepared or put there.
        """
        if new.entity and not renames:
            self.refuse_twice(new.entity)
        self.loads += 1
        return self.spawn_prepared(self.prepare(new), namespace, renames=renames)

    def spawn_prepared(
        self, prepared: PreparedEntity, namespace: str = "", *, renames: bool = False
    ) -> str:
        """Put what has been prepared into the world; gives its name. Raises as `spawn_new`."""
        robot = prepared.robot
        if robot is None:
            raise RefusedError(prepared.problem, prepared.hint)
        if renames:
            robot = replace(robot, entity=self.free_name(robot.entity))
        entity = robot.entity
        self.refuse_twice(entity)
        self._known[entity] = robot
        self._devices[entity] = prepared.devices or Devices()
        self._descriptions.pop(entity, None)
        if prepared.description is not None:
            self._descriptions[entity] = prepared.description
        self.spawn(entity, namespace)
        return entity

    def refuse_twice(self, entity: str) -> None:
        """Raise RefusedError if something in the world has that name."""
        if entity in self.host.robots:
            raise RefusedError(
                f"The entity `{entity}` exists already.", "Give each robot another name."
            )

    def spawn(self, entity: str, namespace: str = "") -> None:
        """Put a robot into the world; its plugins have that namespace in ROS, if one is given.

        Raises:
            RefusedError: There is no such robot, or it is there already, or the engine does not
                take it, or Gazebo would not answer.
        """
        self._require_commands()
        self._put(entity, namespace)

    def _require_commands(self) -> None:
        """Raise RefusedError if nothing in Gazebo takes commands."""
        if not self.has("UserCommands"):
            raise RefusedError(
                f"The world `{self.scene.world}` does not load the system UserCommands: Gazebo has "
                "no services that spawn, move and remove.",
                _add("UserCommands"),
            )

    def _put(self, entity: str, namespace: str = "") -> None:
        robot = self._known.get(entity)
        if robot is None:
            raise RefusedError(
                f"The launch file spawns no robot `{entity}` that wsgen has prepared.",
                f"Robots: {', '.join(self._known) or 'none'}.",
            )
        self.refuse_twice(entity)
        spawned, refused = spawn_robots(
            self.engine, replace(self.scene.scene, robots=(robot,)), self._announce
        )
        if entity in refused:
            raise RefusedError(
                f"The engine refuses `{entity}`: {refused[entity].reason}.", refused[entity].hint
            )
        ((_, _, pose),) = spawned
        self._poses[entity] = pose
        self.awaited.discard(entity)
        self.host.moment += 1
        handle = RobotHandle(
            self.host,
            robot,
            in_namespace(self._devices.get(entity, Devices()), namespace),
            self._descriptions.get(entity),
        )
        self.host.robots[entity] = handle
        self._add_systems(handle.devices)
        self._due += self._plugins(handle)
        self._bridges_checked = self.host.now + BRIDGES_AFTER

    def add(self, due: Due) -> None:
        """Update one more plugin, before those of robots."""
        self._due.insert(0, due)

    def delete(self, entity: str) -> None:
        """Take a robot out of the world.

        Raises:
            RefusedError: It is not there, or Gazebo would not answer.
        """
        self._require_commands()
        self._take(entity)

    def _take(self, entity: str) -> None:
        robot = self.host.robots.pop(entity, None)
        if robot is None:
            raise RefusedError(
                f"No entity `{entity}` is in the world.",
                f"Entities: {', '.join(self.host.robots) or 'none'}.",
            )
        for due in self._due:
            if due.robot is robot:
                due.plugin.close()
        self._due = [due for due in self._due if due.robot is not robot]
        self._waiting = [one for one in self._waiting if one[0] is not robot]
        for end in reversed(robot.ends):
            end()
        self.engine.remove(entity)
        self.host.moment += 1

    def reset(self, *, with_time: bool) -> None:
        """Have all robots where they were spawned, and the time at 0."""
        if with_time:
            self.control.limit -= self.host.now  # as much as before may pass
            self._steps = 0
            self.host.now = self._next_look = 0.0
        for entity, robot in self.host.robots.items():
            if not robot.robot.is_static:
                self.engine.place(entity, self._poses[entity])
        self.host.moment += 1
        for due in self._due:
            due.next = self.host.now
            due.plugin.reset()

    def advance(self, until: float) -> None:
        """Let time pass until then (s, simulated), with the updates of plugins that are due."""
        while self.host.now < until - TINY:
            self._update()
            target = min([until, *(due.next for due in self._due)])
            step = self.host.step_seconds
            steps = max(1, math.ceil((target - self.host.now) / step - TINY / step))
            if self.has("Physics"):
                self.engine.advance(steps)
            self._steps += steps
            self.host.now = round(self._steps * step, 9)
            self.host.moment += 1
            if self.host.now >= self._next_look:
                self._next_look = self.host.now + LOOK_EVERY
                self._remove_exploded()
            if self.host.now >= self._bridges_checked:
                self._bridges_checked = math.inf
                for problem in self.host.gz.unconnected():
                    self.host.warn(problem)

    def _update(self) -> None:
        now = self.host.now
        for due in tuple(self._due):
            if due.next <= now + TINY:
                due.plugin.update()
                period = due.plugin.period
                every = self.host.update_seconds if period is None else period
                due.next = following(due.next, every, now)

    def _remove_exploded(self) -> None:
        for entity, robot in tuple(self.host.robots.items()):
            if not robot.robot.is_static and not self.engine.look(entity).is_finite:
                self.host.warn(
                    f"`{entity}` exploded at {self.host.now:.2f} s: its state is not a number any "
                    "more. It was taken out of the world. `wsgen validate` says what may be wrong "
                    "with it."
                )
                self._take(entity)

    def _add_systems(self, devices: Devices) -> None:
        """Have the systems that a robot brings; those that ask for the name of a world fail."""
        if self._systems is None:
            return
        plugins = (*devices.plugins, *(one for sensor in devices.sensors for one in sensor.plugins))
        names = (one.attributes for one in plugins)
        classes = {loaded_class(one.get("filename", ""), one.get("name", "")) for one in names}
        self._systems |= {one for one in classes if one and one not in DEFAULT_SYSTEMS}
        waiting, self._waiting = self._waiting, []
        for robot, sensor in waiting:
            self._due += self._sensor(robot, sensor)

    def _plugins(self, robot: RobotHandle) -> Iterator[Due]:
        for element in robot.devices.plugins:
            filename = element.attributes.get("filename", "")
            yield from self._plugin(
                robot, PLUGINS.get(stem(filename)), element, f"plugin `{filename}`", stem(filename)
            )
        for sensor in robot.devices.sensors:
            yield from self._sensor(robot, sensor)

    def _sensor(self, robot: RobotHandle, sensor: MountedSensor) -> Iterator[Due]:
        where, name = SENSORS.get(sensor.kind), f"{sensor.kind} sensor `{sensor.name}`"
        system = SYSTEM_OF_SENSOR.get(sensor.kind)
        if where is not None and system is not None and not self.has(system):
            self._waiting.append((robot, sensor))
            self._report_missing(system, f"the {name} of `{robot.entity}` sends nothing")
            return
        yield from self._plugin(robot, where, sensor, name, sensor.kind)

    def _world_plugins(self) -> Iterator[Due]:
        devices = self.scene.world_devices
        for element in devices.plugins if devices is not None else ():
            filename = element.attributes.get("filename", "")
            where = WORLD_PLUGINS.get(stem(filename))
            yield from self._plugin(None, where, element, f"plugin `{filename}`", stem(filename))

    def _plugin(
        self, robot: RobotHandle | None, where: str | None, element: Any, name: str, known_as: str
    ) -> Iterator[Due]:
        owner = f"`{robot.entity}`" if robot is not None else "the world"
        if where is None:
            if known_as not in DONE_BY_SIMULATOR:
                self.host.warn(f"{owner}: wsgen does not simulate the {name}.")
            return
        module, _, attribute = where.partition(":")
        kept = len(robot.ends) if robot is not None else 0
        try:
            made: Plugin = getattr(importlib.import_module(module), attribute)(
                self.host, robot, element
            )
        except (CannotWorkError, BadNameError) as problem:
            _end(robot, kept)
            self.host.warn(f"{owner}: the {name} does not work: {problem}")
            return
        except (ArithmeticError, ValueError) as problem:
            _end(robot, kept)
            self.host.warn(
                f"{owner}: the {name} does not work: wsgen cannot compute with its numbers "
                f"({problem}). Correct what is 0, negative or huge."
            )
            return
        except ModuleNotFoundError as problem:
            if (problem.name or "").startswith("wsgen"):
                raise
            _end(robot, kept)
            package = (problem.name or "").partition(".")[0]
            self.host.warn(
                f"{owner}: the {name} does not work: the ROS package `{package}` is not installed. "
                f"Write <exec_depend>{package}</exec_depend> into a package.xml of the workspace "
                "of the launch file that starts the simulator, and launch that again."
            )
            return
        yield Due(plugin=made, robot=robot, name=name, next=self.host.now)

    def close(self) -> None:
        """End everything."""
        for due in self._due:
            due.plugin.close()
        self.engine.close()


def _add(system: str) -> str:
    if system == "CpuLidar":  # older Gazebos have none
        return 'Write type="gpu_lidar", and have the world load the system Sensors.'
    return f"Add {plugin_of(system)} to the <world>."


def _end(robot: RobotHandle | None, kept: int) -> None:
    """End what a plugin had made before it failed: messages may not reach half a plugin."""
    while robot is not None and len(robot.ends) > kept:
        robot.ends.pop()()
