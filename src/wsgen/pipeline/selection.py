"""What the user asks to validate: which packages, and by which of their launch files."""

from __future__ import annotations

import re
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.build.cmake_text import read_calls
from wsgen.build.request import refuse_empty
from wsgen.diagnostics import Rule, Severity
from wsgen.errors import NotFoundError, RequestError
from wsgen.suggestions import ask_for_nearest
from wsgen.values import dataclass
from wsgen.workspace.layout import find_launch_files, find_packages, read_package
from wsgen.workspace.overlay import require_share

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.build.cmake_text import Call
    from wsgen.diagnostics import Diagnostic
    from wsgen.workspace.layout import Workspace
    from wsgen.workspace.overlay import Overlay


# One of these words is in every launch file that puts a robot into a simulator by itself.
SPAWNING_WORDS = (b"spawn", b"create")
LAUNCH_FUNCTION = b"def generate_launch_description("

UNINSTALLED_LAUNCH_FILE = Rule(
    code="PKG050",
    name="uninstalled-launch-file",
    severity=Severity.ERROR,
    summary="The package does not install its launch file where `ros2 launch` looks for it.",
    why="`ros2 launch` finds launch files only in `share/PACKAGE` of the install space.",
    example="install(DIRECTORY model DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch model DESTINATION share/${PROJECT_NAME})",
)
NO_LAUNCH_FILE = Rule(
    code="PKG051",
    name="no-launch-file",
    severity=Severity.ERROR,
    summary="The package has no launch file.",
    what="Looks for files that end with `launch.py`, `launch.xml` or `launch.yaml`. A file that is "
    "a launch file by its content but not by its name is named.",
    why="Without a launch file nothing spawns the robot.",
    example="src/my_robot/launch/gazebo_model.py",
    instead="src/my_robot/launch/gazebo_model.launch.py",
)
SEVERAL_LAUNCH_FILES = Rule(
    code="PKG054",
    name="several-launch-files",
    severity=Severity.ERROR,
    summary="Several launch files of a package may spawn a robot.",
    why="It is not clear which of them is meant, so the package is not simulated.",
    example="wsgen validate",
    instead="wsgen validate my_robot --launch gazebo_model.launch.py",
)


def find_named_launch_file(share: Path, wanted: str) -> Path | None:
    """The installed file that is meant by a name, or by the end of a path.

    As for `ros2 launch`, any file that is named is a launch file.
    """
    parts = Path(wanted).parts
    named = sorted(file for file in share.rglob("*") if file.name == Path(wanted).name)
    for file in (*find_launch_files(share), *named):
        if file.parts[-len(parts) :] == parts and file.is_file():
            return file
    return None


def find_misnamed(folder: Path) -> tuple[Path, str] | None:
    """A file that is a launch file by its content and not by its name, and the name it should have.

    Editors and browsers append `.txt`; others leave out `launch`.
    """
    for file in sorted(folder.rglob("*")):
        name = file.name.removesuffix(".txt")
        is_python = name.endswith(".py") or (
            "launch" in name and not name.endswith((".xml", ".yaml", ".yml"))
        )
        if is_python and file.is_file() and _holds(file, LAUNCH_FUNCTION):
            stem = name.removesuffix(".py").removesuffix(".launch")
            return file, name if name.endswith("launch.py") else f"{stem}.launch.py"
    return None


def may_spawn(file: Path) -> bool:
    """Whether a launch file looks as if it spawned a robot; one that cannot be read does."""
    return any(_holds(file, word) for word in SPAWNING_WORDS)


def _holds(file: Path, word: bytes) -> bool:
    """Whether a word is in a file, capitals or not; True where that cannot be known."""
    try:
        return word in file.read_bytes().lower()
    except OSError:
        return True


@dataclass(frozen=True, kw_only=True)
class SelectedPackage:
    """A package to check; without a launch file, the problem says why there is none."""

    name: str
    source: Path | None  # None: of an underlay
    share: Path | None  # its source where it is not built; None: its package.xml is unreadable
    launch_file: Path | None = None
    problem: Diagnostic | None = None


def select_packages(
    workspace: Workspace, overlay: Overlay, request: ValidateRequest
) -> tuple[tuple[SelectedPackage, ...], tuple[str, ...]]:
    """The packages to validate, and the names of those that are left out as they spawn nothing.

    Raises:
        RequestError: a package or launch file that is named does not exist, or it is not clear
            which launch file of a named package is meant.
        NotFoundError: a named package is not built, or no package spawns a robot.
    """
    sources = {package.name: package.path for package in find_packages(workspace)}
    if request.packages:
        return tuple(
            _select_named(name, sources, workspace, overlay, request.launch_file)
            for name in dict.fromkeys(request.packages)
        ), ()
    if not sources:
        refuse_empty(workspace)
    if len(sources) == 1:
        (name,) = sources
        return (_select_named(name, sources, workspace, overlay, request.launch_file),), ()
    selected, left_out = [], []
    for name, source in sources.items():
        package = _select_unnamed(name, source, overlay.share(name), request.launch_file)
        if package is None:
            left_out.append(name)
        else:
            selected.append(package)
    if not selected:
        raise NotFoundError(
            f"No package of {workspace.root} has a launch file that spawns a robot"
            + (f" called {request.launch_file}." if request.launch_file else "."),
            hint="Name a package to see what it lacks: wsgen validate PACKAGE",
        )
    return tuple(selected), tuple(left_out)


def _select_named(
    name: str,
    sources: dict[str, Path],
    workspace: Workspace,
    overlay: Overlay,
    wanted: str | None,
) -> SelectedPackage:
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", name):
        near = name.strip("./").rpartition("/")[2]
        raise RequestError(
            f"{name!r} is not the name of a package.",
            hint=f"Write: wsgen validate {near}"
            if near in sources
            else "Give the name of a package, or a .urdf, .xacro, .sdf or .world file.",
        )
    share = require_share(overlay, workspace, name)
    source = sources.get(name)
    files = find_launch_files(share)
    if wanted is not None:
        file = find_named_launch_file(share, wanted)
        if file is None:
            raise no_such_launch_file(name, wanted, files)
        return SelectedPackage(name=name, source=source, share=share, launch_file=file)
    if not files:
        problem = _no_launch_file(source, share)
        return SelectedPackage(name=name, source=source, share=share, problem=problem)
    spawning = [file for file in files if may_spawn(file)] or list(files)
    if len(spawning) > 1:
        raise RequestError(
            f"{name} has several launch files that may spawn a robot.",
            hint=f"Choose one with --launch: {', '.join(file.name for file in spawning)}.",
        )
    return SelectedPackage(name=name, source=source, share=share, launch_file=spawning[0])


def _select_unnamed(
    name: str, source: Path, share: Path | None, wanted: str | None
) -> SelectedPackage | None:
    """One of several packages; None where neither source nor install space spawns a robot.

    The problem of one package is reported with it, so that the others are validated.
    """
    files = find_launch_files(share) if share else ()
    if wanted is not None:
        file = find_named_launch_file(share, wanted) if share else None
        if file is None:
            return None
        return SelectedPackage(name=name, source=source, share=share, launch_file=file)
    spawning = [file for file in files if may_spawn(file)]
    written = find_launch_files(source)
    misnamed = None if written else find_misnamed(source)
    if misnamed is not None:
        written = (misnamed[0],)
    written = tuple(file for file in written if may_spawn(file))
    if len(spawning) == 1:
        return SelectedPackage(name=name, source=source, share=share, launch_file=spawning[0])
    if spawning:
        problem = _several_launch_files(name, spawning)
    elif not written:
        return None
    elif share is None:
        (problem,) = found.diagnostics if (found := read_package(source)) else ()
    else:
        problem = _no_launch_file(source, share)
    return SelectedPackage(name=name, source=source, share=share, problem=problem)


def no_such_launch_file(package: str, wanted: str, files: Sequence[Path]) -> RequestError:
    """The error for the name of a launch file that a package does not install."""
    names = [file.name for file in files]
    return RequestError(
        f"{package} does not install a launch file {wanted}.",
        hint=f"{ask_for_nearest(Path(wanted).name, names)}Installed: {', '.join(names) or 'none'}.",
    )


def _no_launch_file(source: Path | None, share: Path) -> Diagnostic:
    written = find_launch_files(source) if source is not None else ()
    rule = _find_install_rule(source, written[0]) if source is not None and written else None
    if source is not None and rule is not None:
        return _misplaced_launch_file(source, written[0], rule, share.name)
    if source is not None and written:
        folder = written[0].relative_to(source).parent.as_posix()
        what = f"FILES {written[0].name}" if folder == "." else f"DIRECTORY {folder.split('/')[0]}"
        return UNINSTALLED_LAUNCH_FILE.at(
            source / "CMakeLists.txt",
            message="The package does not install its launch file "
            f"{written[0].relative_to(source)}.",
            hint=f"Write in CMakeLists.txt: install({what} DESTINATION "
            "share/${PROJECT_NAME}); then run `wsgen build`.",
        )
    misnamed = find_misnamed(source or share)
    if misnamed is not None:
        file, name = misnamed
        return NO_LAUNCH_FILE.at(
            file,
            message=f"The package has no launch file: `{file.name}` is not named like one.",
            hint=f"Rename it to {name}, then run `wsgen build`.",
        )
    return NO_LAUNCH_FILE.at(
        source or share,
        message="The package has no launch file.",
        hint="Write a file launch/NAME.launch.py, and install the folder launch/ in "
        "CMakeLists.txt.",
    )


def _find_install_rule(source: Path, file: Path) -> Call | None:
    """Find the call of install() that names the file, or a folder that it lies in."""
    name = file.relative_to(source).as_posix()
    for call in read_calls(source / "CMakeLists.txt"):
        if call.command != "install" or not {"DIRECTORY", "FILES"} & {*call.arguments}:
            continue
        if "DESTINATION" not in call.arguments[:-1] or "PATTERN" in call.arguments:
            continue
        named = call.arguments[1 : call.arguments.index("DESTINATION")]
        paths = (path.removeprefix("${CMAKE_CURRENT_SOURCE_DIR}/") for path in named)
        if any(f"{name}/".startswith(f"{path.rstrip('/')}/") for path in paths):
            return call
    return None


def _misplaced_launch_file(source: Path, file: Path, rule: Call, package: str) -> Diagnostic:
    """Report a launch file that is installed, but not where it is looked for."""
    position = rule.arguments.index("DESTINATION") + 1
    place = rule.arguments[position]
    variable = "${PROJECT_NAME}"
    name = file.relative_to(source)
    meant = place.replace(variable, package).split("/")[:2]
    if meant == ["share", package]:
        message = f"The install space does not contain {name}, which install() names in line "
        message += f"{rule.line} of CMakeLists.txt."
        hint = "Run `wsgen build`; if that does not help, check for an if() around install()."
    else:
        message = f"{name} is installed to {place}, but `ros2 launch` looks in share/{package}."
        lost = re.search(r"(?<!\$)\{PROJECT_NAME\}", place)
        hint = (
            f"Write: DESTINATION share/{variable}{' (a $ is missing)' if lost else ''}; then run "
        )
        hint += "`wsgen build`."
    return UNINSTALLED_LAUNCH_FILE.at(
        source / "CMakeLists.txt", rule.argument_lines[position], message=message, hint=hint
    )


def _several_launch_files(name: str, files: list[Path]) -> Diagnostic:
    names = ", ".join(file.name for file in files)
    return SEVERAL_LAUNCH_FILES.at(
        files[0].parent,
        message=f"Several launch files may spawn a robot: {names}.",
        hint=f"Choose one: wsgen validate {name} --launch {files[0].name}",
    )


FILE_SUFFIXES = (".urdf", ".xacro", ".sdf", ".world")  # what can be validated without a package


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
    jobs: int = 1  # number of packages or files to process in parallel
    picture_folder: Path | None = None
    video: Path | None = None  # a .gif or .mp4 of the simulation of one launch file

    @property
    def is_drawn(self) -> bool:
        """Whether it matters what things look like."""
        return self.picture_folder is not None or self.video is not None
