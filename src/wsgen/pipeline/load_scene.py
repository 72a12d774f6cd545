"""Load what a launch file spawns, ready for a session: the plan, the world and the robots in it."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity
from wsgen.errors import RequestError
from wsgen.isolation.parent import make_scratch
from wsgen.launching.known_packages import prefix
from wsgen.packages.workspace.layout import Workspace, workspace_around, workspace_if_any
from wsgen.packages.workspace.overlay import open_overlay, require_share
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.plan_launch import package_of
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.run_robots import spawned_robots
from wsgen.pipeline.selection import select_packages
from wsgen.simulation.scene import Scene
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import World
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.requests import SelectedPackage


@dataclass(frozen=True, kw_only=True)
class LoadedScene:
    """What a launch file of a package spawns."""

    package: str
    launch_file: Path
    plan: LaunchPlan
    simulator: str | None  # that the launch file starts, "classic" or "gz"
    world: World
    prepared: tuple[PreparedRobot, ...]  # robots, and models of the world
    diagnostics: tuple[Diagnostic, ...]  # all that is wrong with them

    @property
    def robots(self) -> tuple[PreparedRobot, ...]:
        """The robots, without the models of the world."""
        return tuple(robot for robot in self.prepared if not robot.is_static_model)

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """Why not all can be simulated."""
        return tuple(one for one in self.diagnostics if one.severity is Severity.ERROR)

    def scene(self, engine: str) -> Scene:
        """What can be simulated of it, in an engine."""
        runnable = (robot for robot in self.prepared if robot.can_run)
        return Scene(world=self.world, robots=spawned_robots(runnable), engine=engine)


@contextmanager
def load_scene(
    package: str | None,
    *,
    near: Path,
    launch_file: str | None = None,
    arguments: Mapping[str, str] | None = None,
) -> Iterator[LoadedScene]:
    """Load a package's robots as `wsgen validate` does, up to the simulation.

    What it needs of files is there while the context is open.

    Args:
        package: Its name; None: the one that `near` lies in.
        near: A file or folder. The workspace around it is sourced, as far as it is built.
        launch_file: The name of one of its launch files; None: the one that spawns robots.
        arguments: Of the launch file.

    Raises:
        RequestError: No such package or launch file; or the launch files that spawn robots are
            none, or several.
        NotFoundError: The package cannot be read.
        NotReadableError: The setup file of the workspace fails.
        BrokenSceneError: The launch file cannot be evaluated, or spawns nothing.
    """
    workspace = workspace_of(near)
    name = package or package_of(near)
    if name is None:
        raise RequestError(
            f"{near} is not in a package: its parent folders do not contain a package.xml.",
            hint="Give the package: pytest --wsgen-package NAME, or "
            '@pytest.mark.wsgen(package="NAME") at the test.',
        )
    environment = {"AMENT_PREFIX_PATH": prefix(), **os.environ}
    request = ValidateRequest(
        packages=(name,), launch_file=launch_file, launch_arguments=arguments or {}
    )
    with (
        make_scratch() as folder,
        open_overlay([workspace] if workspace else [], environment, near=near) as overlay,
    ):
        place = workspace or Workspace(root=require_share(overlay, None, name))
        selected = select_only(place, overlay, request, name)
        # Pictures are drawn if something fails, which is not known yet.
        drawn = ValidateRequest(
            packages=(name,), launch_arguments=arguments or {}, picture_folder=folder
        )
        validation = Validation(selected, overlay, drawn, None)
        world, prepared = validation.read(folder)
        started = validation.started
        diagnostics = (*validation.reported(), *overlay.not_built())
        if started is None or world is None or selected.launch_file is None or not prepared:
            raise BrokenSceneError(name, diagnostics)
        yield LoadedScene(
            package=name,
            launch_file=selected.launch_file,
            plan=started.plan,
            simulator=validation.simulator_kind,
            world=world,
            prepared=tuple(prepared),
            diagnostics=diagnostics,
        )


class BrokenSceneError(Exception):
    """Nothing can be simulated; the diagnostics say why."""

    def __init__(self, package: str, diagnostics: tuple[Diagnostic, ...]) -> None:
        super().__init__(f"No robot of {package} can be simulated.")
        self.package = package
        self.diagnostics = diagnostics


def workspace_of(near: Path) -> Workspace | None:
    """The workspace around a place, or that of the current folder, if there is one."""
    found = workspace_around(near if near.is_dir() else near.parent)
    return found or workspace_if_any(None)


def select_only(
    workspace: Workspace,
    overlay: Overlay,
    request: ValidateRequest,
    package: str,
    listener: Listener | None = None,
) -> SelectedPackage:
    """The package with its only launch file that spawns robots.

    Raises:
        RequestError: No such package or launch file; or the launch files that spawn robots are
            none, or several.
        NotFoundError: The package cannot be read.
    """
    selection = select_packages(workspace, overlay, request, listener)
    if len(selection.packages) == 1:
        return selection.packages[0]
    if not selection.packages:
        reasons = {one.reason for one in selection.not_validated if one.package == package}
        raise RequestError(
            f"No launch file of {package} spawns a robot{_why(reasons)}.",
            hint="Spawn the robot in a launch file of the package, and install it.",
        )
    files = [one.launch_file.name for one in selection.packages if one.launch_file]
    raise RequestError(
        f"{package} has {len(files)} launch files that spawn robots.",
        hint=f"Give one of them: {', '.join(files)}.",
    )


def _why(reasons: set[str]) -> str:
    more = ", ".join(sorted(reasons - {"spawns no robot"}))
    return f": {more}" if more else ""
