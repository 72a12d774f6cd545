"""Keeps where everything is while a live run goes on, for a video of it."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.ros_nodes.simulator.host import Plugin
from wsgen.simulation.pose_log import POSE_LOG_FILE, RATE, PoseLogWriter

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.ros_nodes.simulator.host import Host, RobotHandle
    from wsgen.simulation.scene import SpawnedRobot


class PoseLogger(Plugin):
    """Writes a frame every tenth of a simulated second, from when the first robot is there."""

    period = 1 / RATE

    def __init__(self, host: Host, folder: Path) -> None:
        self._host = host
        self._stream = (folder / POSE_LOG_FILE).open("w", encoding="utf-8")
        self._writer = PoseLogWriter(self._stream)
        self._names: dict[int, str] = {}  # in the log, by the number of a robot
        self._logged: dict[str, SpawnedRobot] = {}  # by these names

    def update(self) -> None:
        """Write the frame of now."""
        robots = self._host.robots
        if all(robot.spawned.is_static_model for robot in robots.values()):
            return
        before = set(self._logged)
        named = {self._name_of(robot): robot for robot in robots.values()}
        fresh = {name: robot for name, robot in named.items() if name not in before}
        self._writer.add(
            {name: robot.link_poses() for name, robot in named.items()},
            {
                name: [
                    *self._host.engine.corners(robot.entity),
                    *(pose.xyz for pose in robot.link_poses().values()),
                ]
                for name, robot in fresh.items()
            },
            [self._logged[name] for name in fresh],
        )

    def _name_of(self, robot: RobotHandle) -> str:
        """Its name in the log: another one than that of a different robot with its name before."""
        known = self._names.get(robot.number)
        if known is not None:
            return known
        taken = {self._names.get(one.number) for one in self._host.robots.values()}
        others = (f"{robot.entity} ({count})" for count in itertools.count(2))
        name = next(
            name
            for name in itertools.chain((robot.entity,), others)
            if name not in taken
            and _looks(self._logged.get(name, robot.spawned)) == _looks(robot.spawned)
        )
        self._logged.setdefault(name, replace(robot.spawned, entity=name))
        self._names[robot.number] = name
        return name

    def close(self) -> None:
        """End the log."""
        self._stream.close()


def _looks(spawned: SpawnedRobot) -> tuple[object, ...]:
    return spawned.robot, spawned.is_static_model
