"""Validate one robot or world file, without a package."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.description_rules import UNREADABLE_DESCRIPTION
from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.files import read_regular
from wsgen.model.outcome import PackageOutcome
from wsgen.pipeline.clock import Clock
from wsgen.pipeline.prepare import (
    PrepareContext,
    PreparedRobot,
    name_some,
    prepare_models,
    prepare_robot,
    read_file,
    share_around,
    share_on_model_path,
)
from wsgen.pipeline.run_robots import SimulationResult, simulate_robots
from wsgen.sdf.worlds import DEFAULT_WORLD
from wsgen.urdf.reader import TEXT_LIMIT
from wsgen.xacro.reader import expand_file

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.selection import ValidateRequest
    from wsgen.workspace.overlay import Overlay


NO_MODEL = Rule(
    code="WLD042",
    name="no-model",
    severity=Severity.ERROR,
    severity_varies="an information for the file of a world",
    summary="The SDF file has no model to simulate.",
    why="Nothing is simulated, so nothing is checked but the file.",
    example='<sdf version="1.6"/>',
    instead="""
<sdf version="1.6">
  <model name="box">
    <link name="link"/>
  </model>
</sdf>
""",
)


class FileValidation:
    """Reads, simulates and checks one file; collects what is reported on the way.

    A robot stands just above the ground of an empty world; the models of a world file stand where
    the file puts them.
    """

    def __init__(  # noqa: PLR0913  what a stage needs, and its name
        self,
        file: Path,
        overlay: Overlay,
        request: ValidateRequest,
        listener: Listener | None,
        run: Run,
        *,
        name: str,
    ) -> None:
        self.file = file
        self.name = name
        self.overlay = overlay
        self.request = request
        self.run_task = run
        self.clock = Clock(name, listener)
        self.around = share_around(file)
        self.on_model_path = share_on_model_path(overlay.environment)
        self.diagnostics: list[Diagnostic] = []

    def run(self) -> PackageOutcome:
        """Run all stages, up to the first that fails."""
        with tempfile.TemporaryDirectory(prefix="wsgen-") as folder:
            context = PrepareContext(
                share_of=self._share_of,
                folder=Path(folder),
                run=self.run_task,
                with_colors=self.request.is_drawn,
            )
            return self._run(context)

    def _run(self, context: PrepareContext) -> PackageOutcome:
        with self.clock.step("expand", self.file.name) as step:
            world, prepared = self._read(context)
            step.succeeded = not has_errors(self.diagnostics)
        simulated = SimulationResult()
        if prepared and world:
            with self.clock.step("simulate", name_some(prepared)) as step:
                simulated = simulate_robots(
                    world, prepared, self.request, self.name, run=self.run_task
                )
                step.succeeded = all(robot.passed for robot in simulated.robots)
                simulated.report_drawing(step, self.request)
            self.clock.take(simulated.seconds or {})
        return PackageOutcome(
            package=None,
            file=self.file,
            share=None,
            launch_file=None,
            world=world,
            robots=simulated.robots,
            diagnostics=tuple(simulated.diagnostics_after(self.diagnostics)),
            picture=simulated.picture,
            picture_tile=simulated.picture_tile,
            world_picture=simulated.world_picture,
            video=simulated.video,
            seconds=self.clock.read(),
        )

    def _read(self, context: PrepareContext) -> tuple[World | None, list[PreparedRobot]]:
        if self.file.suffix.lower() in {".sdf", ".world"}:
            return self._read_sdf(context)
        text = self._urdf()
        if text is None:
            return DEFAULT_WORLD, []
        prepared, diagnostics = prepare_robot(
            text, file=self.file, context=context, on_the_ground=True
        )
        self.diagnostics += diagnostics
        return DEFAULT_WORLD, [prepared] if prepared else []

    def _urdf(self) -> str | bytes | None:
        """The text of the robot, expanded where the file is of xacro."""
        text: str | bytes | None
        if self.file.suffix.lower() == ".xacro":
            text, diagnostics = expand_file(
                self.file,
                self.request.launch_arguments,
                environment=self.overlay.environment,
                run=self.run_task,
            )
        else:
            text, diagnostics = _read_bytes(self.file)
        self.diagnostics += diagnostics
        return text

    def _read_sdf(self, context: PrepareContext) -> tuple[World | None, list[PreparedRobot]]:
        found = read_file(self.file, context, self.overlay.environment)
        prepared, more = prepare_models(found, context)
        self.diagnostics += (*found.diagnostics, *more)
        if not prepared and not has_errors(self.diagnostics):
            self.diagnostics.append(
                NO_MODEL.at(
                    self.file,
                    message="The file has no model to simulate.",
                    hint="Name a package that spawns a robot into it: wsgen validate PACKAGE",
                    severity=Severity.ERROR if found.world is None else Severity.INFO,
                )
            )
        return found.world or DEFAULT_WORLD, prepared

    def _share_of(self, package: str) -> Path | None:
        """Sourced packages come first, as for Gazebo."""
        return self.overlay.share(package) or self.on_model_path(package) or self.around(package)


def _read_bytes(file: Path) -> tuple[bytes | None, tuple[Diagnostic, ...]]:
    """The bytes of a file; None where it cannot be read."""
    try:
        return read_regular(file, 4 * TEXT_LIMIT), ()  # bytes of UTF-8
    except OSError as error:
        return None, (
            UNREADABLE_DESCRIPTION.at(
                file,
                message=f"Cannot read the robot description: {error.strerror}.",
                hint="Check the permissions of the file.",
            ),
        )
