"""The simulation that a test steps: a session with what a launch file of a package spawns."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import RequestError, WsgenError
from wsgen.launching.launch_warnings import UNUSED_ARGUMENT
from wsgen.pipeline.load_scene import load_scene
from wsgen.rendering.drawing import why_no_video
from wsgen.simulation.run import check_engines, default_engine
from wsgen.simulation.scene import NotDrawn
from wsgen.simulation.session import Session
from wsgen.simulation.simulate import REST_HELD, is_moving
from wsgen.testing.robot import Robot, without_traceback
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import World
    from wsgen.pipeline.load_scene import LoadedScene
    from wsgen.simulation.scene import RobotRun

__tracebackhide__ = True  # the tracebacks of tests end where these call wsgen


class SharedScene:
    """What a launch file spawns, loaded once for all tests that need the same, with its engine.

    Raises:
        RequestError, NotFoundError, NotReadableError, BrokenSceneError: See `load_scene`.
        NotFoundError: The engine is not installed.
    """

    def __init__(
        self,
        *,
        near: Path,
        package: str | None,
        launch_file: str | None,
        arguments: Mapping[str, str],
        engine: str | None,
    ) -> None:
        self.engine = engine or default_engine()
        check_engines([self.engine])
        self._stack = ExitStack()
        self.loaded: LoadedScene = self._stack.enter_context(
            load_scene(package, near=near, launch_file=launch_file, arguments=arguments)
        )
        self._session: Session | None = None

    def session(self) -> Session:
        """A session in which nothing has happened yet.

        Raises:
            SessionDiedError: The engine dies of a robot.
        """
        if self._session is not None:
            try:
                self._session.reset()
            except WsgenError:  # the test before ended it
                self.end_session()
        if self._session is None:
            self._session = Session(self.loaded.scene(self.engine))
        return self._session

    @property
    def unused_arguments(self) -> tuple[str, ...]:
        """What is said of each launch argument that has no effect."""
        return tuple(
            f"{found.message} {found.hint or ''}".rstrip()
            for found in self.loaded.diagnostics
            if found.code == UNUSED_ARGUMENT.code
        )

    def end_session(self) -> None:
        """End the engine; the next session starts another one."""
        if self._session is not None:
            self._session.close()
            self._session = None

    def close(self) -> None:
        """Give everything back."""
        self.end_session()
        self._stack.close()


class Simulation:
    """The simulation of one test; its engine starts when it is needed.

    Attributes:
        engine: The name of the physics engine: "bullet", "dart" or "mujoco".
        world: The world that the launch file starts.
        launch_plan: What the launch file would start.
        robots: What it spawns, by entity.
    """

    def __init__(self, shared_scene: SharedScene) -> None:
        self.engine = shared_scene.engine
        self.world: World = shared_scene.loaded.world
        self.launch_plan: LaunchPlan = shared_scene.loaded.plan
        self.robots: Mapping[str, Robot] = {
            one.entity: Robot(self, one, shared_scene.loaded.simulator)
            for one in shared_scene.loaded.robots
        }
        self._shared_scene = shared_scene
        self._session: Session | None = None

    def __repr__(self) -> str:
        robots = ", ".join(self.robots)
        return f"<simulation of {robots} after {self.seconds:g} s in {self.engine}>"

    @property
    def loaded(self) -> LoadedScene:
        """What wsgen made of the launch file; for what this class does not offer."""
        return self._shared_scene.loaded

    @property
    def session(self) -> Session:
        """The session with the engine; for what this class does not offer.

        Raises:
            SessionDiedError: The engine dies of a robot.
        """
        if self._session is None:
            self._session = without_traceback(self._shared_scene.session)
        return self._session

    @property
    def has_begun(self) -> bool:
        """Whether the engine was needed."""
        return self._session is not None

    @property
    def seconds(self) -> float:
        """The simulated time since the robots were spawned, s."""
        return 0.0 if self._session is None else self._session.seconds

    @property
    def step_seconds(self) -> float:
        """The step of the engine, s."""
        return self.session.step_seconds

    def robot(self, name: str | None = None) -> Robot:
        """The robot of that name; without one, the only robot there is.

        Raises:
            RequestError: The name is missing or unknown.
        """
        names = list(self.robots)
        if name is None and len(names) == 1:
            return self.robots[names[0]]
        if name is not None and name in self.robots:
            return self.robots[name]
        if name is None:
            raise RequestError(
                f"The launch file spawns {len(names)} robots.",
                hint=f"Choose one with @pytest.mark.wsgen(robot=...): {', '.join(names)}.",
            )
        raise RequestError(
            f"The launch file spawns no robot `{name}`.",
            hint=f"{ask_for_nearest(name, names)}Robots: {', '.join(names)}.",
        )

    def step(self, seconds: float) -> None:
        """Let simulated time pass.

        Raises:
            SessionDiedError: The engine dies.
        """
        without_traceback(lambda: self.session.step(seconds))

    def settle(self, seconds: float = 3.0) -> bool:
        """Let time pass until every robot is at rest, and no longer than these seconds.

        Returns:
            Whether all are at rest.
        """
        step = self.step_seconds  # less than half of one is no time: nothing would happen in it
        held, end = 0.0, self.seconds + seconds
        while held < REST_HELD - 1e-9 and end - self.seconds > step / 2 + 1e-9:
            before = self.seconds
            self.step(min(max(SETTLE_STEP, step), end - before))
            states = self.session.states.values()
            held = 0.0 if any(map(is_moving, states)) else held + self.seconds - before
            if not all(state.is_finite for state in states):
                return False
        return held >= REST_HELD - 1e-9

    def watch(self, seconds: float) -> Mapping[str, RobotRun]:
        """Let time pass, and give what `wsgen validate` measures meanwhile, by entity."""
        return {run.entity: run for run in without_traceback(lambda: self.session.watch(seconds))}

    def reset(self) -> None:
        """Spawn all robots again; nothing commands them."""
        without_traceback(self.session.reset)

    def picture(self, file: Path | str) -> None:
        """Draw the robots as they are now, as a PNG.

        Raises:
            RequestError: It cannot be drawn, or written there.
        """
        if Path(file).suffix.lower() != ".png":
            raise RequestError(f"Cannot draw {file}: a picture is a PNG.", hint="Name a .png file.")
        self._draw(without_traceback(lambda: self.session.picture(file)), file)

    def record(self, file: Path | str) -> None:
        """Draw the last simulated second as a .gif, or as an .mp4 where PyAV is installed.

        Raises:
            RequestError: It cannot be drawn, or written there.
        """
        problem = why_no_video(Path(file))
        if problem is not None:
            raise RequestError(
                f"Cannot draw {file}: {problem}.", hint="Name a .gif file in a writable folder."
            )
        self._draw(without_traceback(lambda: self.session.record(file)), file)

    @staticmethod
    def _draw(outcome: object, file: Path | str) -> None:
        if isinstance(outcome, NotDrawn):
            raise RequestError(
                f"Cannot draw {file}: {outcome.problem}.",
                hint="Check that the folder exists and is writable.",
            )


SETTLE_STEP = 0.01  # s, between two looks whether robots are at rest
