"""The page that shows a simulation while it runs: pause, step, reset, and a push.

That of a live run goes along with the robots.
"""

from __future__ import annotations

import time
from collections.abc import Sequence  # noqa: TC003
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np

from wsgen.reporting.viewing.page import Page, subjects_of
from wsgen.reporting.viewing.play import Command, Push, Reset, SetRunning, Step
from wsgen.text.printable import clean

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from wsgen.model.transform import Pose
    from wsgen.reporting.viewing.drawing import DrawnRobot

    Floats = NDArray[np.float64]


STEP = 0.01  # s, of simulated time
SHORTEST, LONGEST = 0.001, 10.0  # s, of a step and of a push
GRAVITY = 9.81  # m/s²
PUSH = 0.3  # of the weight of the robot, at first
PUSH_SECONDS = 0.2
ROOT = "root link"


class SimulationPage(Page):
    """A page with robots that move; what its user wants is in `commands`."""

    can_push = True

    def __init__(self, *, host: str, port: int, title: str) -> None:
        super().__init__(host=host, port=port, title=title, first_tab="Simulation")
        self.commands: SimpleQueue[Command] = SimpleQueue()
        self._push: _PushInputs | None = None
        gui = self._server.gui
        with self._first_tab:
            self._time = gui.add_markdown("")
            self._run = gui.add_button("Pause")
            self._run.on_click(lambda _: self.commands.put(SetRunning(self._run.label == "Run")))
            self._seconds = gui.add_number(
                "Step, s", STEP, min=SHORTEST, max=LONGEST, step=SHORTEST
            )
            self._step = gui.add_button("Step")
            self._step.on_click(lambda _: self.commands.put(Step(float(self._seconds.value))))
            self._reset = gui.add_button("Reset")
            self._reset.on_click(lambda _: self.commands.put(Reset()))

    def show(self, robots: Sequence[DrawnRobot], *, links: str) -> None:
        """Show robots instead of those before."""
        with self._lock:
            super().show(robots, links=links)
            if self._push is not None:
                self._push.remove()
            movable = [
                robot for robot in robots if not robot.is_static_model and not robot.robot.is_static
            ]
            self._push = _PushInputs(self, movable) if movable and self.can_push else None

    def put(self, poses: Mapping[str, Mapping[str, Pose]]) -> None:
        """Put links to poses in the world, by entity and link."""
        with self._lock, self._server.atomic():
            for node in self._robots:
                if node.robot.entity in poses:
                    node.put(poses[node.robot.entity])

    def _moved(self) -> Any:
        """How far the robots have moved, on the average."""
        with self._lock:
            moved = [node.moved for node in self._robots if not node.robot.is_static_model]
        if not moved:
            return super()._moved()
        return [sum(parts) / len(moved) for parts in zip(*moved, strict=True)]

    def notify(self, text: str, *, is_running: bool) -> None:
        """Show in Markdown how far it is, and what the button does that runs or pauses it."""
        with self._lock:
            shown = clean(text)
            if self._time.content != shown:
                self._time.content = shown
            label = "Pause" if is_running else "Run"
            if self._run.label != label:
                self._run.label = label


class _PushInputs:
    """What the user chooses of a push."""

    def __init__(self, page: SimulationPage, robots: Sequence[DrawnRobot]) -> None:
        self._page = page
        self._robots = {robot.entity: robot for robot in robots}
        gui = page._server.gui  # noqa: SLF001  a part of the page
        first = robots[0]
        with page._first_tab:  # noqa: SLF001
            self._folder = gui.add_folder("Push")
        with self._folder:
            self._entity = gui.add_dropdown(
                "Robot", tuple(self._robots), initial_value=first.entity, visible=len(robots) > 1
            )
            self._link: Any = gui.add_dropdown("At", _links(first), initial_value=ROOT)
            self._entity.on_update(lambda _: self._show_links())
            self._force: Any = gui.add_number("Force, N", _force(first), min=0.0, step=0.1)
            self._direction = gui.add_vector3(
                "Direction",
                (1.0, 0.0, 0.0),
                step=0.1,
                hint="Give it in the world; z is up.",
            )
            self._seconds = gui.add_number(
                "For, s", PUSH_SECONDS, min=SHORTEST, max=LONGEST, step=SHORTEST
            )
            button = gui.add_button("Push")
            button.on_click(lambda _: self._push())

    def remove(self) -> None:
        """Take it out of the panel."""
        self._folder.remove()

    def _show_links(self) -> None:
        robot = self._robots[self._entity.value]
        self._link.options = _links(robot)
        self._link.value = ROOT
        self._force.value = _force(robot)

    def _push(self) -> None:
        x, y, z = (float(part) for part in self._direction.value)
        length = (x * x + y * y + z * z) ** 0.5
        if length == 0:
            return
        factor = float(self._force.value) / length
        link = None if self._link.value == ROOT else str(self._link.value)
        push = Push(
            str(self._entity.value),
            link,
            (factor * x, factor * y, factor * z),
            float(self._seconds.value),
        )
        self._page.commands.put(push)


def _links(robot: DrawnRobot) -> tuple[str, ...]:
    return (ROOT, *(link.name for link in robot.links))


def _force(robot: DrawnRobot) -> float:
    """A force that a robot of this weight feels."""
    return float(f"{max(PUSH * GRAVITY * robot.robot.mass, 0.01):.2g}")


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
