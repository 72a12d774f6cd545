"""The page that shows a live run: it goes along with the robots."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.reporting.viewing.page import subjects_of
from wsgen.reporting.viewing.simulation_page import SimulationPage

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose
    from wsgen.reporting.viewing.drawing import DrawnRobot

    Floats = NDArray[np.float64]


LEAST_WAY = 1e-4  # m
FOLLOWED = 0.15  # of the way to the robots, in a frame
SENT_AFTER = 0.3  # s; viser collects what it sends for a 60th of a second


class RunPage(SimulationPage):
    """A page with robots that are driven, and may go far.

    All is in a node that is moved against them, so that they stay in sight without a word to the
    cameras, which are those of their users.
    """

    can_push = False
    towards_camera = (0.58, -0.39, 0.7)  # over the walls of a world
    distance = 4.0
    world = "/world"

    def __init__(self, *, host: str, port: int, title: str) -> None:
        super().__init__(host=host, port=port, title=title)
        self._origin = self._server.scene.add_frame(self.world, show_axes=False)
        # m, in the world: what was in the middle at first, and how far that is from it now.
        self._middle = np.zeros(3)
        self._offset = np.zeros(3)
        self._is_framed = False
        with self._layers_tab:
            self._follow: Any = self._server.gui.add_checkbox(
                "Follow the robots", initial_value=True
            )

    def put(self, poses: Mapping[str, Mapping[str, Pose]]) -> None:
        """Put links to poses in the world, by entity and link."""
        with self._lock, self._server.atomic():
            super().put(poses)
            if self._follow.value:
                self._go_after(FOLLOWED if self.is_open else 1.0)

    def finish(self, text: str) -> None:
        """Show in Markdown that no more will come, and wait until pages that are open have it."""
        with self._lock:
            self.notify(text, is_running=False)
            for one in (self._run, self._seconds, self._step, self._reset):
                one.disabled = True
        self._server.flush()
        if self.is_open:
            time.sleep(SENT_AFTER)

    def _go_after(self, share: float) -> None:
        """Have the robots nearer to the middle of the scene."""
        way = self._moved()
        way[2] = 0.0
        if np.linalg.norm(way) > LEAST_WAY:
            self._offset += share * way
            self._origin.position = -self._offset

    def _moved(self) -> Any:
        """How far the robots are in the scene from where they were shown first, m."""
        with self._lock:
            robots = [node for node in self._robots if not node.robot.is_static_model]
            if not robots:
                return np.zeros(3)
            center = _mean(_middle_of(node.robot) + node.moved for node in robots)
            return center - self._middle - self._offset

    def _frame(self, robots: Sequence[DrawnRobot]) -> None:
        """Put grid and camera where the first robots are; later ones change nothing."""
        if self._is_framed or not robots:
            return
        self._is_framed = any(not robot.is_static_model for robot in robots)
        super()._frame(robots)
        self._middle = _mean(map(_middle_of, subjects_of(robots)))
        self._look_from_here()  # where the page is open already


def _middle_of(robot: DrawnRobot) -> Floats:
    """The middle of the box around it: x, y, z in the world, m."""
    middle: Floats = (np.array(robot.low) + robot.high) / 2
    return middle


def _mean(points: Iterable[Floats]) -> Floats:
    mean: Floats = np.mean(list(points), axis=0)
    return mean
