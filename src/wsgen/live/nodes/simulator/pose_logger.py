"""Keeps where everything is while a live run goes on, for a video of it."""

from __future__ import annotations

import itertools
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.live.nodes.simulator.host import Plugin
from wsgen.simulation.live_runs import POSE_LOG_FILE, RATE, PoseLogWriter
from wsgen.text.files import explain_write_error

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.simulation.scene import SpawnedRobot


class PoseLogger(Plugin):
    """Writes a frame every tenth of a simulated second, from when the first robot is there.

    A disk that gets full ends the log, not the run.
    """

    period = 1 / RATE

    def __init__(self, host: Host, folder: Path) -> None:
        self._host = host
        self._path = folder / POSE_LOG_FILE
        self._stream = self._path.open("w", encoding="utf-8")
        self._is_over = False
        self._writer = PoseLogWriter(self._stream)
        self._names: dict[int, str] = {}  # in the log, by the number of a robot
        self._logged: dict[str, SpawnedRobot] = {}  # by these names

    def update(self) -> None:
        """Write the frame of now."""
        robots = self._host.robots
        if self._is_over or all(robot.spawned.is_static_model for robot in robots.values()):
            return
        before = set(self._logged)
        named = {self._name_of(robot): robot for robot in robots.values()}
        fresh = {name: robot for name, robot in named.items() if name not in before}
        poses = {name: robot.link_poses() for name, robot in named.items()}
        corners = {
            name: [
                *self._host.engine.corners(robot.entity),
                *(pose.xyz for pose in poses[name].values()),
            ]
            for name, robot in fresh.items()
        }
        try:
            self._writer.add(poses, corners, [self._logged[name] for name in fresh])
        except OSError as error:
            self._is_over = True
            problem = explain_write_error(error, self._path, what="where robots are")
            self._host.warn(
                f"The video ends at {self._host.now:.2f} s. {problem.message} {problem.hint}"
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
        with suppress(OSError):  # what did not fit is still to be written
            self._stream.close()


def _looks(spawned: SpawnedRobot) -> tuple[object, ...]:
    return spawned.robot, spawned.is_static_model
