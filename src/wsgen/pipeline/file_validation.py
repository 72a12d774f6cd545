"""A robot file on its way through the stages of `wsgen validate`, without a package."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.files import read_regular
from wsgen.model.outcome import PackageOutcome
from wsgen.pipeline.clock import Clock
from wsgen.pipeline.prepare import (
    Described,
    Workshop,
    describe,
    describe_models,
    name_some,
    read_file,
    share_around,
    share_on_model_path,
)
from wsgen.pipeline.run_robots import Tried, try_robots
from wsgen.sdf.reader import DEFAULT_WORLD
from wsgen.urdf.reader import TEXT_LIMIT
from wsgen.xacro.reader import expand_file

if TYPE_CHECKING:
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.request import ValidateRequest
    from wsgen.workspace.overlay import Overlay


class FileValidation:
    """Reads, simulates and judges; collects what is found on the way.

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
        """All stages, as far as they go."""
        with tempfile.TemporaryDirectory(prefix="wsgen-") as folder:
            workshop = Workshop(
                share_of=self._share_of,
                folder=Path(folder),
                run=self.run_task,
                with_colours=self.request.is_drawn,
            )
            return self._run(workshop)

    def _run(self, workshop: Workshop) -> PackageOutcome:
        with self.clock.step("expand", self.file.name) as step:
            world, described = self._read(workshop)
            step.succeeded = not has_errors(self.diagnostics)
        tried = Tried()
        if described and world:
            with self.clock.step("simulate", name_some(described)) as step:
                tried = try_robots(world, described, self.request, self.name, run=self.run_task)
                step.succeeded = all(robot.passed for robot in tried.robots)
                tried.tell_drawing(step, self.request)
            self.clock.take(tried.seconds or {})
        return PackageOutcome(
            package=None,
            file=self.file,
            share=None,
            launch_file=None,
            world=world,
            robots=tried.robots,
            diagnostics=tuple(tried.told_after(self.diagnostics)),
            picture=tried.picture,
            picture_tile=tried.picture_tile,
            world_picture=tried.world_picture,
            film=tried.film,
            seconds=self.clock.read(),
        )

    def _read(self, workshop: Workshop) -> tuple[World | None, list[Described]]:
        if self.file.suffix.lower() in {".sdf", ".world"}:
            return self._read_sdf(workshop)
        text = self._urdf()
        if text is None:
            return DEFAULT_WORLD, []
        described, diagnostics = describe(
            text, file=self.file, workshop=workshop, on_the_ground=True
        )
        self.diagnostics += diagnostics
        return DEFAULT_WORLD, [described] if described else []

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

    def _read_sdf(self, workshop: Workshop) -> tuple[World | None, list[Described]]:
        found = read_file(self.file, workshop, self.overlay.environment)
        described, flawed = describe_models(found, workshop)
        self.diagnostics += (*found.diagnostics, *flawed)
        if not described and not has_errors(self.diagnostics):
            self.diagnostics.append(
                Diagnostic(
                    code="WLD042",
                    severity=Severity.ERROR if found.world is None else Severity.INFO,
                    message="The file holds no model to try.",
                    file=self.file,
                    hint="A package that spawns a robot into it tries more: wsgen validate PACKAGE",
                )
            )
        return found.world or DEFAULT_WORLD, described

    def _share_of(self, package: str) -> Path | None:
        """What is sourced comes first: it is what Gazebo would find."""
        return self.overlay.share(package) or self.on_model_path(package) or self.around(package)


def _read_bytes(file: Path) -> tuple[bytes | None, tuple[Diagnostic, ...]]:
    """The bytes of a file; None where it cannot be read."""
    try:
        return read_regular(file, 4 * TEXT_LIMIT), ()  # bytes of UTF-8
    except OSError as error:
        return None, (
            Diagnostic(
                code="ROB072",
                severity=Severity.ERROR,
                message=f"The robot description cannot be read: {error.strerror}.",
                file=file,
                hint="Name a file that you may read.",
            ),
        )
