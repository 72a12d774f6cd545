"""What is asked of the pipeline, packages and files, and what a simulation of them measured."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

from wsgen.model.engines import GAZEBO
from wsgen.pipeline.clock import DRAW
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorRun, LiveMeasurement
    from wsgen.model.outcome import RobotOutcome, SceneView
    from wsgen.model.plan import LaunchPlan
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.clock import Step
    from wsgen.pipeline.started import Started


# What a page takes of a simulation.
PAGE_SAMPLES = 200  # of each robot over the simulated time; more than a plot has pixels between
PAGE_TRIANGLES = 300_000  # of all its 3D views
LEAST_TRIANGLES, MOST_TRIANGLES = 1_000, 50_000  # of one

FILE_SUFFIXES = (".urdf", ".xacro", ".sdf", ".world")  # what can be validated without a package


class SelectedLaunchFile(NamedTuple):
    """A launch file, with where it and what it needs are looked up."""

    file: Path
    package: str | None  # that it belongs to
    words: tuple[str, ...]  # the launch arguments behind it, NAME:=VALUE
    workspace: Workspace | None
    overlay: Overlay  # the sourced workspace, or the environment as it is


@dataclass(frozen=True, kw_only=True)
class SelectedPackage:
    """A package to check; without a launch file, the problem says why there is none."""

    name: str
    source: Path | None  # None: of an underlay
    share: Path | None  # its source where it is not built; None: its package.xml is unreadable
    launch_file: Path | None = None
    problem: Diagnostic | None = None
    started: Started | None = None  # by the launch file, if it has been evaluated
    label: str = ""  # of pictures and progress, if that is not the name
    is_first: bool = True  # of those with this package
    elsewhere: frozenset[str] = frozenset()  # entities that its other launch files spawn
    beside: tuple[LaunchPlan, ...] = ()  # of its other launch files
    workspace: Mapping[Path, Path] = field(default_factory=dict)  # share folder -> source, of all


class RunLive(Protocol):
    """Runs a launch file with its nodes, once for each behavior."""

    def __call__(
        self,
        selected: SelectedLaunchFile,
        request: ValidateRequest,
        behavior_runs: Sequence[BehaviorRun],
    ) -> Mapping[str, LiveMeasurement]:
        """What was measured, by the name of the behavior.

        Raises:
            WsgenError: It cannot be run on this machine.
        """


@dataclass(frozen=True, kw_only=True)
class ValidateRequest:
    """Packages and files, and how they are validated."""

    packages: Sequence[str] = ()
    files: Sequence[Path] = ()  # neither: every package of the workspace that can be launched
    launch_file: str | None = None  # a file name as `ros2 launch` takes it
    launch_arguments: Mapping[str, str] = field(default_factory=dict)
    # What to answer to launch files that ask on standard input; called where one does.
    answers: Callable[[], Sequence[str]] = tuple
    seconds: float = 3.0  # of simulated time
    engines: Sequence[str] = ("bullet",)  # the first one's figures are reported
    # Whether the user's own Gazebo simulates, too: always, or where it is installed.
    gazebo: Literal["no", "required", "if installed"] = "no"
    jobs: int = 1  # number of packages or files to process in parallel; of one, its engines
    picture_folder: Path | None = None
    video: Path | None = None  # a .gif or .mp4 of the simulation of one launch file
    # Of a 3D view of the end, for a page; packages and files share them.
    view_triangles: int = 0
    samples: int = 0  # of how each robot moves, over the simulated time and in each behavior
    is_viewed: bool = False  # the robots are shown, in a browser
    is_live: bool = False  # their sensors and plugins work, for ROS
    physics: str | None = (
        None  # of a live run: as that simulator's, "classic" or "gz"; None: its own
    )
    # Runs the launch file for behaviors that ask for it (`wsgen.live.behaviors`), if anything does.
    run_live: RunLive | None = None

    def for_page(self) -> ValidateRequest:
        """The same, with what a page shows."""
        return replace(self, samples=PAGE_SAMPLES, view_triangles=PAGE_TRIANGLES)

    def shared_by(self, count: int) -> ValidateRequest:
        """The same for each of so many packages and files."""
        if not self.view_triangles:
            return self
        share = self.view_triangles // max(1, count)
        return replace(self, view_triangles=min(MOST_TRIANGLES, max(LEAST_TRIANGLES, share)))

    @property
    def all_engines(self) -> tuple[str, ...]:
        """The engines, and the user's own Gazebo if it is asked for."""
        return (*self.engines, *([GAZEBO] if self.gazebo == "required" else []))

    @property
    def is_drawn(self) -> bool:
        """Whether it matters what things look like."""
        is_shown = self.is_viewed or self.view_triangles > 0
        return is_shown or self.picture_folder is not None or self.video is not None


@dataclass(frozen=True, kw_only=True)
class SimulationResult:
    """What a simulation measured, and what is reported about it."""

    robots: tuple[RobotOutcome, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()  # of the run alone
    causes: Mapping[Diagnostic, Diagnostic] = field(default_factory=dict)  # about descriptions:
    # as reported before, and with what followed from it in the run
    picture: Path | None = None
    picture_tile: float | None = None  # m, edge of a square of the ground in the picture
    world_picture: Path | None = None
    video: Path | None = None
    view: SceneView | None = None
    seconds: Mapping[str, float] | None = None  # wall-clock: load, simulate, draw

    def diagnostics_after(self, before: Iterable[Diagnostic]) -> list[Diagnostic]:
        """What was reported before the run, and what the run adds to it."""
        return [*(self.causes.get(one, one) for one in before), *self.diagnostics]

    def report_drawing(self, step: Step, request: ValidateRequest) -> None:
        """Note in the step of the simulation what was drawn in it, and how long that took."""
        wanted = [request.video] if request.video else []
        if request.picture_folder is not None:
            wanted += [file for file in (self.picture, self.world_picture) if file]
        step.drawing = (self.seconds or {}).get(DRAW, 0.0) if wanted else 0.0
        step.drawn = ", ".join(file.name for file in wanted) if step.drawing else ""
        step.is_drawn = self.video is not None or request.video is None
