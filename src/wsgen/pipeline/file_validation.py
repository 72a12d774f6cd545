"""Validate one robot or world file, without a package, and what kind of file it is."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from wsgen.descriptions.rules import NO_LINK, UNREADABLE_DESCRIPTION
from wsgen.descriptions.sdf.source import is_sdf
from wsgen.descriptions.sdf.worlds import DEFAULT_WORLD
from wsgen.descriptions.urdf.reader import TEXT_LIMIT, UNNAMED_ROBOT
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS, expand_file
from wsgen.diagnostics import Rule, Severity, has_errors
from wsgen.isolation.parent import make_scratch
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
from wsgen.pipeline.requests import SimulationResult
from wsgen.text.files import bytes_or_empty, irregular_kind, read_regular
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.real_gazebo import RealGazebo
    from wsgen.pipeline.requests import ValidateRequest


Kind = Literal["urdf", "xacro", "sdf"]

# A comment ends at its first end: if it could go on, many could be parted in endless ways.
COMMENT = rb"<!--(?:(?!-->).)*-->"
AHEAD = rb"(?:\xef\xbb\xbf)?(?:\s|<\?(?:(?!\?>).)*\?>|" + COMMENT + rb"|<!(?!--)[^>]*>)*"
ROOT = lazy_pattern(AHEAD + rb"<(robot|sdf)\b", re.DOTALL)
XACRO = lazy_pattern(rb"xmlns:xacro.*(?:<xacro:|\$[({])", re.DOTALL)
MACRO = lazy_pattern(rb"<xacro:macro\s[^>]*?name\s*=\s*[\"']([^\"']+)")
INCLUDE = lazy_pattern(rb"<xacro:include\s[^>]*?filename\s*=\s*[\"'](?:[^\"']*/)?([^\"'/]+)[\"']")
OF_SUFFIX: dict[str, Kind] = {".urdf": "urdf", ".xacro": "xacro", ".sdf": "sdf", ".world": "sdf"}
MOST_LEVELS = 10  # of files that include each other


def kind_of(file: Path) -> Kind | None:
    """What a file is by its suffix and its root element; None where wsgen cannot simulate it.

    What declares and uses xacro is a file of xacro, whatever its suffix is: what xacro has written
    declares it too.
    """
    of_suffix = OF_SUFFIX.get(file.suffix.lower())
    text = read(file)
    root = ROOT.match(text)
    is_named_so = any(suffix.lower() == ".xacro" for suffix in file.suffixes)  # robot.xacro.urdf
    if is_named_so or ((root or of_suffix) and XACRO.search(text)):
        return "xacro"
    if of_suffix is not None or root is None:
        return of_suffix
    return "sdf" if root[1] == b"sdf" else "urdf"


def why_refused(file: Path) -> str | None:
    """Why a file cannot be simulated, as the end of a sentence about it; None where it can."""
    kind = irregular_kind(file)
    if kind is not None:
        return f"is {kind}"
    if not file.is_file():
        return "does not exist"
    return "is neither a URDF nor xacro nor SDF" if kind_of(file) is None else None


def defined_macros(file: Path) -> list[str]:
    """The names of the macros that a file of xacro defines, in its order."""
    return [name.decode("utf-8", "replace") for name in MACRO.findall(read(file))]


def find_includer(file: Path, root: Path) -> Path | None:
    """The file below a folder that includes a file of xacro, itself included by no other."""
    includers: dict[str, Path] = {}
    for other in _files_below(root):
        for name in INCLUDE.findall(read(other)):
            includers.setdefault(name.decode("utf-8", "replace"), other)
    found = None
    for _ in range(MOST_LEVELS):
        above = includers.get((found or file).name)
        if above is None or above == found:
            break
        found = above
    return found


def _files_below(root: Path) -> Iterator[Path]:
    for suffix in ("*.urdf.xacro", "*.xacro", "*.urdf"):
        yield from sorted(root.rglob(suffix))


def read(file: Path) -> bytes:
    """The content of a file; empty where it cannot be read."""
    return bytes_or_empty(file, 4 * TEXT_LIMIT)


NO_MODEL = Rule(
    code="WLD042",
    name="no-model",
    severity=Severity.ERROR,
    severity_varies="information for a world file",
    summary="The SDF file does not have a model to simulate.",
    why="Only the file is checked; nothing is simulated.",
    example='<sdf version="1.6"/>',
    instead="""
<sdf version="1.6">
  <model name="box">
    <link name="link"/>
  </model>
</sdf>
""",
)


UNUSABLE_FILE = Rule(
    code="PKG066",
    name="unusable-file",
    severity=Severity.ERROR,
    summary="One of several given files cannot be simulated.",
    what="Looks for missing files, folders, and files whose root element is not that of a URDF, "
    "xacro or SDF file.",
    why="The file is not simulated; the other files and packages are.",
    example="wsgen validate models/*",
    instead="wsgen validate models/*.urdf models/*.sdf",
)
PART_OF_ROBOT = Rule(
    code="PKG067",
    name="part-of-robot",
    severity=Severity.ERROR,
    summary="A xacro file does not define a robot: other files include it.",
    why="A file that only defines macros and properties expands to a robot without links. Nothing "
    "is simulated.",
    example="wsgen validate urdf/wheel.xacro",
    instead="wsgen validate urdf/rover.urdf.xacro",
)
HINT_FOR_FILES = "Give a URDF, a xacro file, or an SDF model or world."


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
        self.kind = kind_of(file)
        self.on_model_path = share_on_model_path(overlay.environment)
        self.diagnostics: list[Diagnostic] = []
        self.sdf_files: frozenset[Path] = frozenset()  # that were read
        self.text: str | bytes | None = None  # of a URDF, or what a xacro file expands to

    def run(self) -> PackageOutcome:
        """Run all stages, up to the first that fails."""
        with make_scratch() as folder:
            context = PrepareContext(
                share_of=self.share_of,
                folder=folder,
                run=self.run_task,
                with_colors=self.request.is_drawn,
            )
            return self._run(context)

    def _run(self, context: PrepareContext) -> PackageOutcome:
        with self.clock.step("expand", self.file.name) as step:
            world, prepared = self.read(context)
            step.succeeded = not has_errors(self.diagnostics)
        simulated = SimulationResult()
        if prepared and world:
            # See `Validation._simulate`.
            from wsgen.pipeline.run_robots import simulate_robots  # noqa: PLC0415

            with self.clock.step("simulate", name_some(prepared, self.request.all_engines)) as step:
                simulated = simulate_robots(
                    world,
                    prepared,
                    self.request,
                    self.name,
                    run=self.run_task,
                    gazebo=self._gazebo(world, prepared, context.folder),
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
            view=simulated.view,
            seconds=self.clock.read(),
        )

    def _gazebo(
        self, world: World, prepared: list[PreparedRobot], folder: Path
    ) -> RealGazebo | None:
        """The user's own Gazebo, for what the file has, if it is wanted."""
        if self.request.gazebo == "no":
            return None
        from wsgen.pipeline.real_gazebo import RealGazebo, packages_of_meshes, with_folders  # noqa: PLC0415  it is seldom wanted

        # Nobody sets the search path of a file: what is found here, Gazebo is to find.
        named = packages_of_meshes(robot.text for robot in prepared)
        shares = (self.share_of(name) for name in named)
        folders = [str(share.parent) for share in shares if share is not None]
        place = folder / "gazebo"
        place.mkdir()
        return RealGazebo(
            with_folders(self.overlay.environment, None, folders),
            place,
            self.run_task,
            kind=None,
            world=world.file,
            is_required=self.request.gazebo == "required",
        )

    def read(self, context: PrepareContext) -> tuple[World | None, list[PreparedRobot]]:
        """Read and check the file: the world, and what stands in it."""
        refused = why_refused(self.file)
        if refused is not None:
            message = f"{self.file} {refused}."
            self.diagnostics.append(
                UNUSABLE_FILE.at(self.file, message=message, hint=HINT_FOR_FILES)
            )
            return None, []
        self.text = text = None if self.kind == "sdf" else self._urdf()
        if self.kind == "sdf" or (isinstance(text, str) and is_sdf(text)):
            return self._read_sdf(context, text)
        prepared = [] if text is None else self._read_robot(text, context)
        return DEFAULT_WORLD, [] if self._is_part() else prepared

    def _read_robot(self, text: str | bytes, context: PrepareContext) -> list[PreparedRobot]:
        prepared, diagnostics = prepare_robot(
            text, file=self.file, context=context, on_the_ground=True
        )
        self.diagnostics += diagnostics
        return [prepared] if prepared else []

    def _is_part(self) -> bool:
        """Whether the file makes no robot; the diagnostics then name the file to validate."""
        codes = {found.code for found in self.diagnostics}
        if not codes & {NO_LINK.code, UNNAMED_ROBOT.code, XACRO_FILE_FAILS.code}:
            return False
        folders = self.file.absolute().parents
        package = next((one for one in folders if (one / "package.xml").is_file()), folders[0])
        whole = find_includer(self.file, package)
        macros = ", ".join(defined_macros(self.file))
        hint = "Call a macro in the file, or validate a file that calls one."
        if whole is not None:
            hint = f"Validate the file that includes it: wsgen validate {os.path.relpath(whole)}"
        if XACRO_FILE_FAILS.code in codes:
            if whole is not None:
                failed = self.diagnostics[-1]
                self.diagnostics[-1] = replace(
                    failed, hint=f"{failed.hint} Or {hint[0].lower()}{hint[1:]}"
                )
            return True
        if whole is None and not macros:
            return False
        reason = "its <robot> has no name"
        if NO_LINK.code in codes:
            reason = f"it only defines macros ({macros})" if macros else "it has no link"
        message = f"The file does not define a robot: {reason}."
        self.diagnostics = [PART_OF_ROBOT.at(self.file, message=message, hint=hint)]
        return True

    def _urdf(self) -> str | bytes | None:
        """The text of the robot, expanded where the file is of xacro."""
        text: str | bytes | None
        if self.kind == "xacro":
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

    def _read_sdf(
        self, context: PrepareContext, text: str | bytes | None
    ) -> tuple[World | None, list[PreparedRobot]]:
        """The models of the file, or of the text that xacro makes of it."""
        content = text if isinstance(text, str) else None
        found = read_file(self.file, context, self.overlay.environment, content=content)
        self.sdf_files = found.files
        prepared, more = prepare_models(found, context)
        if found.world is None:  # else they are in the world
            spawned = _read_bytes(self.file)[0] if text is None else text
            prepared = [replace(robot, text=spawned) for robot in prepared]
        self.diagnostics += (*found.diagnostics, *more)
        if not prepared and not has_errors(self.diagnostics):
            self.diagnostics.append(
                NO_MODEL.at(
                    self.file,
                    message="The file does not have a model to simulate.",
                    hint="Give a package that spawns a robot into it: wsgen validate PACKAGE",
                    severity=Severity.ERROR if found.world is None else Severity.INFO,
                )
            )
        return found.world or DEFAULT_WORLD, prepared

    def share_of(self, package: str) -> Path | None:
        """Find a package, sourced ones first, as Gazebo does."""
        return self.overlay.look_up(package) or self.on_model_path(package) or self.around(package)


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
