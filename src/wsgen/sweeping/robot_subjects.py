"""What is swept is opened here: a template, or a robot, as a file or a package that spawns one.

The parameters of a xacro file are its `<xacro:arg>`s, those of a package its launch arguments.
"""

from __future__ import annotations

import re
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from wsgen.descriptions.xacro.reader import read_arguments, written_elements
from wsgen.diagnostics import Severity, has_errors
from wsgen.errors import RequestError
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.parent import make_scratch
from wsgen.launching.evaluate import PlainLaunches, evaluate
from wsgen.launching.known_packages import prefix
from wsgen.model.behavior import LaunchTask
from wsgen.packages.workspace.layout import Workspace, find_launch_files
from wsgen.packages.workspace.overlay import open_overlay, require_share
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.file_validation import FileValidation
from wsgen.pipeline.load_scene import select_only
from wsgen.pipeline.package_validation import Validation, why_nothing_is_simulated
from wsgen.pipeline.prepare import KnownRobots, PrepareContext
from wsgen.pipeline.requests import FILE_SUFFIXES, ValidateRequest
from wsgen.pipeline.started import DESCRIPTION_FROM_ELSEWHERE
from wsgen.pipeline.validate import check_request, overlays_of_files
from wsgen.sweeping.parameters import Parameter, write_value
from wsgen.sweeping.run_variant import Blueprint
from wsgen.sweeping.subject import KeptAnswers, Prepared, RobotText, Subject, files_below
from wsgen.text.files import read_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.plan import LaunchArgument
    from wsgen.model.sweep import Value
    from wsgen.model.world import World
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.requests import SelectedPackage
    from wsgen.sweeping.subject import SubjectRequest


ARGUMENT = "xacro:arg"
INCLUDED = frozenset((".xacro", ".urdf", ".yaml", ".yml"))
USED = re.compile(r"\$\(arg\s+([\w.-]+)\s*\)")  # it may be declared nowhere


def _name_of(file: Path) -> str:
    """The name of a file without its endings: of rover.urdf.xacro it is rover."""
    name = file
    while name.suffix in FILE_SUFFIXES:
        name = name.with_suffix("")
    return name.name


class FileSubject(Subject):
    """A URDF, xacro or SDF file; the request has been checked."""

    kind = "file"

    def __init__(
        self, file: Path, request: SubjectRequest, overlay: Overlay, folder: Path, run: Run
    ) -> None:
        self._file = file
        self._overlay = overlay
        self._run = KeptAnswers(run, folder).run
        self._request = ValidateRequest(
            files=(file,),
            launch_arguments=request.launch_arguments,
            is_viewed=request.is_drawn,
        )
        self._reader = self._validation(self._request)
        parameters = [*self._arguments()] if self._reader.kind == "xacro" else []
        super().__init__(_name_of(file), f"The file {file.name}", parameters, folder, request)

    def _validation(self, request: ValidateRequest) -> FileValidation:
        name = _name_of(self._file)
        return FileValidation(self._file, self._overlay, request, None, self._run, name=name)

    def _arguments(self) -> Iterator[Parameter]:
        """The arguments that the file and what it includes declare, in the order of the files."""
        elements = written_elements(self._file, self._reader.share_of)
        written: dict[str, str | None] = {}
        for element in elements:
            if element.tag == ARGUMENT and (name := element.attributes.get("name")):
                written.setdefault(name, element.attributes.get("default"))
        for text in {element.file: element.data for element in elements}.values():
            for name in USED.findall(text.decode("utf-8", "replace")):
                written.setdefault(name, None)
        read = read_arguments(
            self._file,
            self._request.launch_arguments,
            environment=self._overlay.environment,
            run=self._run,
        )
        for name in dict.fromkeys((*written, *read)):
            yield Parameter(name=name, default=read.get(name, written.get(name)))

    def _advice(self, name: str) -> str:  # noqa: ARG002
        if self._reader.kind != "xacro":
            return "Only a xacro file has parameters."
        return 'Declare it in the file: <xacro:arg name="NAME" default="VALUE"/>'

    def _read(self, values: Mapping[str, Value], folder: Path) -> Prepared:
        written = {name: write_value(value) for name, value in values.items()}
        validation = self._validation(
            replace(self._request, launch_arguments={**self._request.launch_arguments, **written})
        )
        context = PrepareContext(
            share_of=validation.share_of,
            folder=folder,
            run=self._run,
            with_colors=self._request.is_drawn,
        )
        world, prepared = validation.read(context)
        blueprint = Blueprint(
            name=self.name,
            world=world,
            prepared=tuple(prepared),
            diagnostics=(*validation.diagnostics, *self._overlay.not_built()),
        )
        texts = tuple(self._texts(validation, blueprint))
        return Prepared(blueprint, texts, partial(self._files, validation))

    def _files(self, validation: FileValidation) -> frozenset[Path]:
        files = {self._file, *validation.sdf_files}
        if validation.kind == "xacro":
            files |= {one.file for one in written_elements(self._file, validation.share_of)}
        return frozenset(files)

    def _texts(self, validation: FileValidation, blueprint: Blueprint) -> Iterator[RobotText]:
        text: str | bytes | None = validation.text
        if validation.kind == "sdf" and blueprint.world is not None:
            text = read_whole(self._file)
        if text is not None and blueprint.prepared:
            decoded = text if isinstance(text, str) else text.decode("utf-8-sig", "replace")
            yield RobotText(blueprint.prepared[0].entity, decoded, self._file)

    def _fixed(self) -> Iterable[str]:
        arguments = self._request.launch_arguments.items()
        return (self.name, *(f"{a}:={b}" for a, b in sorted(arguments)))

    def _own_files(self) -> Iterable[Path]:
        """The file, and where an argument may choose what it includes, those around it."""
        yield self._file
        if self._reader.kind == "xacro":
            folder = self._file.absolute().parent
            yield from (one for one in folder.iterdir() if one.suffix in INCLUDED)


class PackageSubject(Subject):
    """The launch file of a package that spawns a robot.

    Raises:
        RequestError: No such package or launch file; or the launch files that spawn robots are
            none, or several.
        NotFoundError: The package cannot be read.
    """

    kind = "package"

    def __init__(
        self,
        request: SubjectRequest,
        overlay: Overlay,
        folder: Path,
        run: Run,
        listener: Listener | None,
    ) -> None:
        name = request.package or ""
        self._overlay = overlay
        self._answers = KeptAnswers(run, folder)
        self._run = self._answers.run
        self._known = KnownRobots()
        self._place = request.workspace or Workspace(root=require_share(overlay, None, name))
        self._request = ValidateRequest(
            packages=(name,),
            launch_file=request.launch_file,
            launch_arguments=request.launch_arguments,
            is_viewed=request.is_drawn,
        )
        self._selected = select_only(self._place, overlay, self._request, name, listener)
        self._of_package: tuple[Diagnostic, ...] | None = None  # the same for all variants
        file = self._selected.launch_file
        title = f"The launch file {file.name} of {name}" if file else f"The package {name}"
        super().__init__(name, title, [*self._arguments()], folder, request)

    def _arguments(self) -> Iterator[Parameter]:
        """The arguments that the launch file declares, and those that it includes."""
        file = self._selected.launch_file
        if file is None:
            return
        started = self._selected.started
        played = () if started is None else started.plan.arguments
        arguments = {one.name: one for one in (*self._declared(file), *played)}
        for one in arguments.values():
            yield Parameter(name=one.name, meaning=one.description, default=one.default)

    def _advice(self, name: str) -> str:
        file, source = self._selected.launch_file, self._selected.source
        if file is not None and source is not None and self._selected.share is not None:
            written = (one for one in find_launch_files(source) if one.name == file.name)
            newer = (one for one in written if not one.samefile(file))
            if any(one.name == name for other in newer for one in self._declared(other)):
                return f"Its source has the argument `{name}`: run `wsgen build`."
        return "Declare it in the launch file, with DeclareLaunchArgument."

    def _declared(self, file: Path) -> Sequence[LaunchArgument]:
        """The arguments that a launch file declares, and those that it includes."""
        return evaluate(
            file,
            package=self._selected.name if self._selected.share else None,
            arguments={},
            environment=self._overlay.environment,
            only_arguments=True,
            run=self._run,
        ).arguments

    def _read(self, values: Mapping[str, Value], folder: Path) -> Prepared:
        written = {name: write_value(value) for name, value in values.items()}
        request = replace(
            self._request, launch_arguments={**self._request.launch_arguments, **written}
        )
        selected = self._select(request) if written else self._selected
        known = None if self._answers.is_full else self._known
        validation = Validation(selected, self._overlay, request, None, self._run, known=known)
        world, prepared = validation.read(folder)
        general = (*self._general(validation), *self._overlay.not_built())
        return as_prepared(self.name, validation, world, prepared, general)

    def _select(self, request: ValidateRequest) -> SelectedPackage:
        """The launch file, to be evaluated with other arguments."""
        started = self._selected.started
        if started is not None and any(
            found.code == DESCRIPTION_FROM_ELSEWHERE.code for found in started.diagnostics
        ):  # the other launch file is evaluated with them, too
            return select_only(self._place, self._overlay, request, self.name, None)
        return replace(self._selected, started=None)

    def _general(self, validation: Validation) -> tuple[Diagnostic, ...]:
        """What is reported about the package itself; its files are compared once."""
        with self._lock:
            if self._of_package is None:
                self._of_package = tuple(validation.of_package())
            return self._of_package

    @property
    def left_out(self) -> tuple[str, ...]:
        """As in the base."""
        if self._selected.source is None or not self._has_behaviors:
            return ()
        settings, _ = read_settings(self._selected.source)
        return tuple(one.name for one in settings.behaviors if isinstance(one.task, LaunchTask))

    def _fixed(self) -> Iterable[str]:
        file = self._selected.launch_file
        arguments = self._request.launch_arguments.items()
        return (self.name, file.name if file else "", *(f"{a}:={b}" for a, b in sorted(arguments)))

    def _own_files(self) -> Iterable[Path]:
        selected = self._selected
        if selected.share is not None:
            yield from files_below(selected.share)
        if selected.source is not None:  # the behaviors, and what the package allows
            yield selected.source / "wsgen.toml"


def as_prepared(
    name: str,
    validation: Validation,
    world: World | None,
    prepared: Sequence[PreparedRobot],
    general: Iterable[Diagnostic] = (),
) -> Prepared:
    """The blueprint of what a launch file spawns, and what it was made of.

    `general` is reported of the package, whatever the launch file spawns.
    """
    started = validation.started
    if (
        started is not None
        and started.is_evaluated
        and all(robot.is_static_model for robot in prepared)
        and not has_errors(validation.diagnostics)
    ):
        validation.diagnostics = why_nothing_is_simulated(started.plan, validation.diagnostics)
    # Nodes would take more time than the simulations of all variants.
    plan = None if world is None else validation.behavior_plan([*prepared])
    if plan is not None:
        hint = "Run `wsgen validate` for them."
        plan = plan.leave_out("A sweep runs no nodes.", hint, Severity.INFO).without_to_run()
    blueprint = Blueprint(
        name=name,
        world=world,
        prepared=tuple(
            replace(robot, diagnostics=validation.named(robot.diagnostics)) for robot in prepared
        ),
        behavior_plan=plan,
        diagnostics=(*validation.named(validation.diagnostics), *general),
        allow=() if validation.settings is None else validation.settings.allow,
    )
    if started is None:
        return Prepared(blueprint)
    texts = tuple(
        RobotText(spawn.entity, spawn.description, spawn.description_file)
        for spawn in started.spawns
    )
    return Prepared(blueprint, texts, partial(_files_of, validation, texts))


def _files_of(validation: Validation, texts: Sequence[RobotText]) -> frozenset[Path]:
    """The files that a launch file and what it spawns are read from."""
    plan = None if validation.started is None else validation.started.plan
    files = {*validation.sdf_files, *(() if plan is None else plan.evaluated_files)}
    for text in texts:
        if text.file is not None:
            share_of = validation.overlay.share
            files |= {text.file, *(one.file for one in written_elements(text.file, share_of))}
    return frozenset(files)


@contextmanager
def open_subject(
    request: SubjectRequest,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> Iterator[Subject]:
    """Open what is swept. Files of its blueprints are there until the context is left.

    Raises:
        RequestError: The request names nothing, or more than one; no such package, launch file or
            template; the launch files that spawn robots are none, or several; or an option is
            given that has no effect.
        NotFoundError: The file does not exist, or the package cannot be read.
        NotReadableError: The file is no regular file, or the setup file of the workspace fails.
        BrokenTemplateError: The template is invalid.
    """
    _check(request)
    with ExitStack() as stack:
        folder = stack.enter_context(make_scratch())
        fork_server = stack.enter_context(ForkServer())
        run = stack.enter_context(PlainLaunches(fork_server.run)).run
        if request.template is not None:
            # A package needs nothing of what renders.
            from wsgen.sweeping.template_subject import TemplateSubject  # noqa: PLC0415

            yield TemplateSubject(request, environment, folder, run)
        elif request.file is not None:
            files = (request.file,)
            check_request(
                ValidateRequest(
                    files=files,
                    engines=(),
                    launch_file=request.launch_file,
                    launch_arguments=request.launch_arguments,
                )
            )
            (overlay,) = overlays_of_files(files, request.workspace, environment, stack)
            yield FileSubject(request.file, request, overlay, folder, run)
        else:
            workspaces = [] if request.workspace is None else [request.workspace]
            if not workspaces:  # a sourced ROS may have it, and what wsgen knows of ROS
                environment = {"AMENT_PREFIX_PATH": prefix(), **environment}
            overlay = stack.enter_context(open_overlay(workspaces, environment))
            yield PackageSubject(request, overlay, folder, run, listener)


def _check(request: SubjectRequest) -> None:
    given = [one for one in (request.package, request.file, request.template) if one is not None]
    if len(given) != 1:
        raise RequestError(
            "A sweep is of one package, one file or one template; "
            f"{len(given) or 'none'} {'are' if len(given) > 1 else 'is'} given.",
            hint="Write for example: wsgen sweep my_robot --over world.slope=0:30deg:31",
        )
    if request.template is None and (request.settings or request.target):
        what = "--set" if request.settings else "--distro and --sim"
        raise RequestError(
            f"{what} {'has' if request.settings else 'have'} no effect without a template.",
            hint=f"Remove {what}, or sweep a template: -t NAME",
        )
