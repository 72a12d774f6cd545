"""Read the robots of a package or a file, without simulating them: what `wsgen view` shows."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.meshes.inspection import read_surfaces
from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.descriptions.xacro.reader import written_elements
from wsgen.diagnostics import has_errors
from wsgen.errors import RequestError
from wsgen.isolation import parent
from wsgen.model.outcome import summed_up
from wsgen.model.robot import Mesh
from wsgen.packages.workspace.overlay import open_overlay
from wsgen.packages.workspace.robot_files import find_robot_files
from wsgen.pipeline.file_validation import FileValidation
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.prepare import PrepareContext
from wsgen.pipeline.selection import select_packages
from wsgen.pipeline.validate import check_request, overlays_of_files, selected_package

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.model.package import ShareOf
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.pipeline.requests import SelectedLaunchFile, SelectedPackage, ValidateRequest


NAMED = 3  # at most so many files are named in a message
TASK_ALONE = parent.run  # one package or file is read: a server would serve one child


class DescribedScene(NamedTuple):
    """What a launch file spawns, or what is in a file."""

    name: str  # of the package, or of the file
    launch_file: Path | None
    world: World | None
    robots: tuple[PreparedRobot, ...]  # static models of the world among them
    diagnostics: tuple[Diagnostic, ...]
    # Of each mesh of a collision by its path: an array for `wsgen.rendering.surfaces`.
    collision_surfaces: Mapping[str, str]
    files: tuple[Path, ...]  # that were read, as far as they are known
    others: tuple[Path, ...] = ()  # more launch files of the package that spawn robots

    @property
    def can_be_shown(self) -> bool:
        """Whether a robot or model could be read; errors in what is around it do not matter."""
        return any(robot.readable is not None for robot in self.robots)


def describe(
    workspace: Workspace | None,
    request: ValidateRequest,
    folder: Path,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> DescribedScene:
    """Read what the one package or file of the request describes.

    A package without a launch file that spawns a robot is described by its URDF or xacro file.
    `folder` is for what is read from mesh files, and must be there as long as the robots are used.

    Raises:
        RequestError: A package or launch file of that name does not exist, the package has no
            robot, or several files with one.
        NotFoundError: The file does not exist, or the workspace has no package.
        NotReadableError: The file is no regular file.
    """
    check_request(request)
    with ExitStack() as stack:
        if request.files:
            overlay = overlays_of_files(request.files, workspace, environment, stack)[0]
            return _describe_file(request.files[0], overlay, request, folder, listener)
        if workspace is None:
            raise RequestError("The package is not specified.", hint="wsgen view PACKAGE")
        overlay = stack.enter_context(open_overlay([workspace], environment))
        selection = select_packages(workspace, overlay, request, listener)
        if not selection.packages:
            file = _only_robot_file(request.packages[0], overlay)
            found = _describe_file(file, overlay, request, folder, listener)
            return found._replace(name=request.packages[0])
        first, *others = selection.packages
        found = _describe_package(first, overlay, request, folder, listener)
        return found._replace(others=tuple(one.launch_file for one in others if one.launch_file))


def describe_launch(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    folder: Path,
    *,
    listener: Listener | None = None,
) -> DescribedScene:
    """Read what a launch file spawns; see `describe`."""
    package = selected_package(
        selected.file, selected.package, selected.overlay, selected.workspace
    )
    return _describe_package(package, selected.overlay, request, folder, listener)


def _only_robot_file(package: str, overlay: Overlay) -> Path:
    """The robot of a package that no launch file spawns."""
    share = overlay.look_up(package)
    files = find_robot_files(share) if share is not None else ()
    if len(files) == 1:
        return files[0]
    if not files:
        raise RequestError(
            f"The package {package} neither spawns a robot nor has a URDF or xacro file of one.",
            hint="Give another package, or a .urdf, .xacro, .sdf or .world file.",
        )
    more = f" (or one of {len(files) - NAMED} more)" if len(files) > NAMED else ""
    raise RequestError(
        f"The package {package} has several robots, and no launch file spawns one.",
        hint=f"wsgen view {' | '.join(map(str, files[:NAMED]))}{more}",
    )


def _describe_file(
    file: Path,
    overlay: Overlay,
    request: ValidateRequest,
    folder: Path,
    listener: Listener | None,
) -> DescribedScene:
    subject = FileValidation(file, overlay, request, listener, TASK_ALONE, name=file.name)
    context = PrepareContext(
        share_of=subject.share_of, folder=folder, run=subject.run_task, with_colors=True
    )
    with subject.clock.step("expand", file.name) as step:
        world, robots = subject.read(context)
        step.succeeded = not has_errors(subject.diagnostics)
    diagnostics = (*subject.diagnostics, *overlay.not_built())
    return DescribedScene(
        name=file.name,
        launch_file=None,
        world=world,
        robots=tuple(robots),
        diagnostics=summed_up(diagnostics),
        collision_surfaces=_collision_surfaces(robots, folder),
        files=tuple(dict.fromkeys(_files_of([file], robots, subject.share_of))),
    )


def _describe_package(
    selected: SelectedPackage,
    overlay: Overlay,
    request: ValidateRequest,
    folder: Path,
    listener: Listener | None,
) -> DescribedScene:
    subject = Validation(selected, overlay, request, listener, TASK_ALONE)
    world, robots = subject.read(folder)
    started = subject.started
    files: list[Path] = []
    if started is not None:
        files += started.plan.evaluated_files
        files += [spawn.description_file for spawn in started.spawns if spawn.description_file]
    if world is not None and world.file is not None:
        files.append(world.file)
    manifests = (place / "package.xml" for place in (selected.share, selected.source) if place)
    diagnostics = (*subject.reported(), *overlay.not_built())
    return DescribedScene(
        name=selected.name,
        launch_file=selected.launch_file,
        world=world,
        robots=tuple(robots),
        diagnostics=summed_up(diagnostics),
        collision_surfaces=_collision_surfaces(robots, folder),
        files=tuple(dict.fromkeys((*_files_of(files, robots, overlay.share), *manifests))),
    )


def _collision_surfaces(robots: Iterable[PreparedRobot], folder: Path) -> dict[str, str]:
    paths = [
        collision.geometry.path
        for robot in robots
        if robot.readable is not None
        for link in robot.readable.links
        for collision in link.collisions
        if isinstance(collision.geometry, Mesh) and collision.geometry.path is not None
    ]
    return read_surfaces(paths, folder=folder, run=TASK_ALONE)


def _files_of(
    files: Sequence[Path], robots: Iterable[PreparedRobot], share_of: ShareOf
) -> Iterator[Path]:
    """The files, what those of xacro include, and the meshes of the robots."""
    for file in files:
        yield file
        if file.suffix in {".urdf", ".xacro"}:
            yield from (element.file for element in written_elements(file, share_of))
    for robot in robots:
        yield from _meshes_of(robot.written, files, share_of)


def _meshes_of(robot: Robot, files: Sequence[Path], share_of: ShareOf) -> Iterator[Path]:
    for folder in dict.fromkeys(file.parent for file in files):
        located, _ = find_meshes(robot, share_of=share_of, folder=folder, file=None)
        for link in located.links:
            shapes = [visual.geometry for visual in link.visuals]
            shapes += [collision.geometry for collision in link.collisions]
            for shape in shapes:
                if isinstance(shape, Mesh) and shape.path is not None:
                    yield Path(shape.path)
