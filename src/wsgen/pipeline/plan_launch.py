"""Find the launch file that `wsgen launch` names, and plan what it would start."""

from __future__ import annotations

import os
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import has_errors
from wsgen.errors import RequestError
from wsgen.launching.evaluate import evaluate
from wsgen.launching.known_packages import prefix
from wsgen.packages.workspace.layout import (
    LAUNCH_FUNCTION,
    Workspace,
    find_launch_files,
    find_packages,
    open_workspace,
    read_package,
    workspace_around,
    workspace_if_any,
)
from wsgen.packages.workspace.overlay import Overlay, open_overlay, require_share
from wsgen.pipeline.changed_since_build import (
    changed_since_build,
    name_sources,
    shares_of,
    used_packages,
)
from wsgen.pipeline.clock import Clock
from wsgen.pipeline.requests import SelectedLaunchFile
from wsgen.pipeline.started import name_markers
from wsgen.text.files import read_whole
from wsgen.text.suggestions import MOST_LISTED, ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.model.plan import LaunchPlan


TEST_FUNCTION = b"def generate_test_description("
TEST_FOLDERS = frozenset(("test", "tests"))


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


def no_such_launch_file(package: str, wanted: str, files: Sequence[Path]) -> RequestError:
    """The error for the name of a launch file that a package does not install."""
    names = [file.name for file in files]
    return RequestError(
        f"{package} does not install a launch file {wanted}.",
        hint=f"{ask_for_nearest(Path(wanted).name, names)}Installed: {', '.join(names) or 'none'}.",
    )


def packages_with(workspace: Workspace | None, name: str) -> list[str]:
    """The packages of a workspace whose source has a launch file of this name."""
    return [
        package.name
        for package in (() if workspace is None else find_packages(workspace))
        if any(file.name == name for file in find_launch_files(package.path))
    ]


def find_misnamed(folder: Path) -> tuple[Path, str] | None:
    """A file that is a launch file by its content and not by its name, and the name it should have.

    Editors and browsers append `.txt`; others leave out `launch`.
    """
    for file in sorted(folder.rglob("*")):
        name = file.name.removesuffix(".txt")
        is_python = name.endswith(".py") or (
            "launch" in name and not name.endswith((".xml", ".yaml", ".yml"))
        )
        if not is_python or not file.is_file() or _is_test(file, folder):
            continue
        if _holds(file, LAUNCH_FUNCTION):
            stem = name.removesuffix(".py").removesuffix(".launch")
            return file, name if name.endswith("launch.py") else f"{stem}.launch.py"
    return None


def list_launch_files(folder: Path) -> list[Path]:
    """The launch files below a folder that are not launch tests."""
    return [file for file in find_launch_files(folder) if not _is_test(file, folder)]


def _is_test(file: Path, folder: Path) -> bool:
    """Whether a file is run by `launch_test`, or lies where the tests of a package are."""
    if not TEST_FOLDERS.isdisjoint(file.relative_to(folder).parts[:-1]):
        return True
    return _holds(file, TEST_FUNCTION) and not _holds(file, LAUNCH_FUNCTION)


def _holds(file: Path, word: bytes) -> bool:
    """Whether a word is in a file, capitals or not; True where that cannot be known."""
    try:
        return word in read_whole(file).lower()
    except OSError:
        return True


@contextmanager
def select_launch_file(words: Sequence[str], workspace: str | None) -> Iterator[SelectedLaunchFile]:
    """The launch file that the words of `ros2 launch` mean: PACKAGE FILE or PATH, then arguments.

    `workspace` is the folder of one that is to be used; without it, it is the one around the launch
    file or the current folder, if there is one. The source folders of packages that are not built
    can be looked up while the context is open.

    Raises:
        RequestError: The words name no launch file, or more than one.
        NotFoundError: The package or a given workspace does not exist.
        NotReadableError: The setup file of the workspace fails.
    """
    place = _find_workspace(workspace, words[0])
    # Where nothing is sourced, the packages of ROS that wsgen knows are found.
    environment = {"AMENT_PREFIX_PATH": prefix(), **os.environ}
    near = Path(words[0]).absolute().parent
    with open_overlay([place] if place else [], environment, near=near) as overlay:
        package, file, arguments = _choose(words, place, overlay)
        yield SelectedLaunchFile(
            file=file, package=package, words=tuple(arguments), workspace=place, overlay=overlay
        )


def plan_launch(  # noqa: PLR0913  all but two have defaults
    selected: SelectedLaunchFile,
    arguments: Mapping[str, str],
    *,
    answers: Callable[[], Sequence[str]] = tuple,
    only_arguments: bool = False,
    with_origins: bool = False,
    listener: Listener | None = None,
) -> LaunchPlan:
    """Evaluate the launch file; its diagnostics name source files where they are known.

    `answers` gives what to answer to what the launch file asks on standard input.
    """
    file, package = selected.file, selected.package
    if package is not None:
        selected.overlay.look_up(package)  # the launch file is in its share folder
    with Clock(package or file.stem, listener).step("launch", file.name) as step:
        plan = evaluate(
            file,
            package=package,
            arguments=arguments,
            environment=selected.overlay.environment,
            answers=answers,
            only_arguments=only_arguments,
            with_origins=with_origins,
        )
        step.succeeded = not has_errors(plan.diagnostics)
    plan = name_markers(plan, selected.overlay)
    plan = replace(plan, diagnostics=(*plan.diagnostics, *selected.overlay.not_built()))
    if selected.workspace is None:
        return plan
    plan = _with_sources_named(plan, selected.workspace, selected.overlay)
    found = _changed(plan, selected.workspace, selected.overlay)
    return replace(plan, diagnostics=(*plan.diagnostics, *found))


def _changed(plan: LaunchPlan, workspace: Workspace, overlay: Overlay) -> Iterator[Diagnostic]:
    """What the plan does not show, because the packages that it uses are not built anew."""
    shares = shares_of(find_packages(workspace), overlay)
    for share, source in used_packages(plan, shares).items():
        yield from changed_since_build(share, source)


def _with_sources_named(plan: LaunchPlan, workspace: Workspace, overlay: Overlay) -> LaunchPlan:
    """The plan whose diagnostics name the package's source, where the workspace has it."""
    share = overlay.share(plan.package) if plan.package else None
    if share is None or not plan.diagnostics:
        return plan
    diagnostics = plan.diagnostics
    for package in find_packages(workspace):
        if package.name == plan.package:
            diagnostics = tuple(name_sources(diagnostics, {share: package.path}))
    return replace(plan, diagnostics=diagnostics)


def _find_workspace(given: str | None, first_word: str) -> Workspace | None:
    """The given workspace, or the one around the current folder or the launch file."""
    if given is None and Path(first_word).is_file():
        return workspace_around(Path(first_word).resolve().parent) or workspace_around(Path.cwd())
    return workspace_if_any(given)


def _choose(
    words: Sequence[str], workspace: Workspace | None, overlay: Overlay
) -> tuple[str | None, Path, Sequence[str]]:
    """The package, the launch file and the launch arguments that the words mean."""
    first, rest = words[0], words[1:]
    names_file = bool(rest) and ":=" not in rest[0]
    path = Path(first)
    if path.exists() and (not names_file or overlay.share(first) is None):
        if names_file:
            raise RequestError(
                f"{rest[0]!r} is not a launch argument, and the package {first!r} does not exist.",
                hint="Write launch arguments after the path of the launch file: name:=value.",
            )
        if path.is_dir():
            share = overlay.share(first)
            raise _folder_named(first, path) if share is None else _no_file_named(first, share)
        return package_of(path), path, rest
    if not names_file and overlay.share(first) is not None:
        raise _no_file_named(first, require_share(overlay, workspace, first))
    if not names_file:
        package = next(iter(packages_with(workspace, first)), "PACKAGE")
        raise RequestError(
            f"The launch file {first!r} does not exist.",
            hint="Give its path, or a package and the name of a launch file: "
            f"wsgen launch {package} {'FILE' if package == 'PACKAGE' else first}",
        )
    if workspace is None and overlay.share(first) is None and not overlay.packages():
        open_workspace(None)  # raises an error that names the workspaces, if there are several
    share = require_share(overlay, workspace, first)
    return first, _find_file(first, share, rest[0]), rest[1:]


def _folder_named(written: str, folder: Path) -> RequestError:
    """The error for a folder in the place of a launch file."""
    files = [os.path.relpath(file) for file in find_launch_files(folder)]
    return RequestError(
        f"{written!r} is a folder, not a launch file.",
        hint=f"wsgen launch {' | '.join(files[:MOST_LISTED])}"
        if files
        else "Give the path of a launch file, or a package and the name of one.",
    )


def _no_file_named(package: str, share: Path) -> RequestError:
    """The error for a package without the name of one of its launch files."""
    names = [file.name for file in find_launch_files(share)]
    if not names:
        return RequestError(
            f"The package {package} does not install a launch file.",
            hint="Install one in its CMakeLists.txt, then build again.",
        )
    return RequestError(
        f"The name of the launch file of the package {package} is missing.",
        hint=f"wsgen launch {package} {' | '.join(names)}",
    )


def _find_file(package: str, share: Path, name: str) -> Path:
    """The file of that name anywhere in the share folder, as `ros2 launch` looks for it."""
    found = sorted(file for file in share.rglob("*") if file.name == name and file.is_file())
    if len(found) == 1:
        return found[0]
    if found:
        raise RequestError(
            f"{package} installs {name} more than once.",
            hint=f"Give the path of one: {', '.join(str(file) for file in found)}",
        )
    raise no_such_launch_file(package, name, find_launch_files(share))


def package_of(file: Path) -> str | None:
    """The package that a launch file belongs to, by the nearest package.xml above it."""
    for folder in file.absolute().parents:
        if (folder / "package.xml").is_file():
            package = read_package(folder)
            return None if package is None else package.name
    return None
