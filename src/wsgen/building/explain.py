"""Explain why a build failed, from the output of colcon and of the programs of its packages.

For each known cause there is one function that yields what it recognizes. They are tried in order,
and the first that recognizes something counts, as one cause often prints several messages.
"""

from __future__ import annotations

import errno
import os
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.building import causes
from wsgen.building.failure import Failure, fold_details, last_words
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.errors import NotReadableError, RequestError
from wsgen.packages.workspace.manifest import BUILD_TAGS
from wsgen.packages.workspace.package_xml import duplicate_name
from wsgen.text.files import explain_write_error, find_full_disk, full_folder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from wsgen.building.colcon import Finished, PackageResult, Progress
    from wsgen.packages.workspace.layout import Inventory, Workspace


CMAKE_ERROR = Rule(
    code="BLD015",
    name="unexplained-cmake-error",
    severity=Severity.ERROR,
    summary="CMake reports an error that wsgen does not explain further.",
    why="CMake stops, and the package is not built. The message is that of CMake.",
    example='message(FATAL_ERROR "not supported")',
    instead="Fix what the message names; the log of colcon has the whole output.",
)
UNEXPLAINED_FAILURE = Rule(
    code="BLD016",
    name="unexplained-failure",
    severity=Severity.ERROR,
    summary="The build of a package fails for a reason that wsgen does not know.",
    why="`colcon` does not install the package, nor those that depend on it.",
    example="int main() { return missing; }",
    instead="Fix what the last lines of the output name; the log of colcon has the whole output.",
)
OTHER_INSTALL_LAYOUT = Rule(
    code="BLD017",
    name="other-install-layout",
    severity=Severity.ERROR,
    summary="The install space was created with another layout, merged or isolated.",
    why="`colcon` refuses to mix both layouts in one install space.",
    example="colcon build --merge-install; colcon build",
    instead="rm -r install; colcon build",
)
OTHER_BUILD_TOOL = Rule(
    code="BLD018",
    name="other-build-tool",
    severity=Severity.ERROR,
    summary="Another tool than colcon created the build folder.",
    why="`colcon` refuses to build in a folder of another tool, such as catkin_make.",
    example="catkin_make; colcon build",
    instead="rm -r build; colcon build",
)
UNBUILT_DEPENDENCY = Rule(
    code="BLD019",
    name="unbuilt-dependency",
    severity=Severity.ERROR,
    summary="A package of the workspace that another one depends on has not been built.",
    why="`colcon` sources the install space of each dependency before it builds a package.",
    example="wsgen build -- --packages-select my_robot  # my_robot_msgs was never built",
    instead="wsgen build my_robot  # with the packages that it depends on",
)
COLCON_FAILURE = Rule(
    code="BLD020",
    name="colcon-failure",
    severity=Severity.ERROR,
    summary="`colcon` itself fails, or a signal ends it.",
    why="No package failed, but colcon did not complete the build.",
    example="kill -9 $(pgrep colcon)",
    instead="Fix what the message names, and build again.",
)
# These repeat the output.
UNEXPLAINED = frozenset(rule.code for rule in (CMAKE_ERROR, UNEXPLAINED_FAILURE, COLCON_FAILURE))


def explain(failure: Failure) -> tuple[Diagnostic, ...]:
    """Explain why the package failed, and what to do."""
    for cause in _causes(failure):
        found = tuple(cause(failure))
        if found:
            return found
    return (_unexplained(failure),)


def _any_cmake_error(failure: Failure) -> Iterator[Diagnostic]:
    for error in fold_details(failure.errors):
        is_named = error.command and error.command not in {"message", error.message.split("(")[0]}
        what = f"{error.command}(): {error.message}" if is_named else error.message
        yield failure.report(CMAKE_ERROR, f"CMake: {what}", error=error, hint=failure.where_to_look)


def _unexplained(failure: Failure) -> Diagnostic:
    words = last_words(failure.output)
    return failure.report(
        UNEXPLAINED_FAILURE,
        f"the build failed{': ' if words else ' without output.'}{words}",
        hint=failure.where_to_look,
    )


def _causes(failure: Failure) -> tuple[Callable[[Failure], Iterator[Diagnostic]], ...]:
    if failure.is_python:
        from wsgen.building.python_causes import PYTHON_CAUSES  # noqa: PLC0415  with the names of ROS

        return (causes.refused_manifest, *PYTHON_CAUSES)
    return (
        causes.refused_manifest,
        *causes.MACHINE_CAUSES,
        *causes.CMAKE_CAUSES,
        *causes.PACKAGE_CAUSES,
        _any_cmake_error,
    )


def recognize_colcon_failure(output: str, workspace: Workspace) -> tuple[Diagnostic, ...]:
    """Report the known causes in the output of colcon."""
    for cause in COLCON_CAUSES:
        found = tuple(cause(output, workspace))
        if found:
            return found
    return ()


def explain_colcon(output: str, returncode: int, workspace: Workspace) -> tuple[Diagnostic, ...]:
    """Report that colcon failed without a failed package and without a known cause.

    Raises:
        RequestError: it refused its arguments.
        NotReadableError: it cannot write where it has to.
    """
    _refuse_request(output)
    if returncode < 0:
        return (_ended_by_signal(-returncode, workspace),)
    _refuse_unwritable(output, workspace)
    words = last_words(output)
    return (
        COLCON_FAILURE.at(
            workspace.root,
            message=f"colcon failed{': ' if words else ' without output.'}{words}",
            hint=f"Read its log: {workspace.log / 'latest_build' / 'logger_all.log'}",
        ),
    )


def _ended_by_signal(number: int, workspace: Workspace) -> Diagnostic:
    return COLCON_FAILURE.at(
        workspace.root,
        message=f"colcon was ended by signal {number}.",
        hint="Look for the process that sent it; Linux sends signal 9 when memory runs out.",
    )


def _refuse_request(output: str) -> None:
    usage = re.search(r"^colcon(?: build)?: error: (.+)$", output, re.MULTILINE)
    if usage:
        raise RequestError(
            f"colcon refuses the arguments: {usage[1]}.",
            hint="Write after -- what `colcon build --help` lists: those go to colcon build.",
        )
    unknown = re.search(
        r"^(?:Package '\S+' specified with|the --packages-).*$", output, re.MULTILINE
    )
    if unknown:
        raise RequestError(
            f"colcon: {unknown[0].rstrip('.')}.",
            hint="Use the names in package.xml; colcon skips ignored packages (COLCON_IGNORE).",
        )


def _duplicate_names(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    _, found, listing = output.partition("Duplicate package names not supported:")
    if not found:
        return
    for name, folders in re.findall(r"^- (\S+):\n((?:  - .+\n?)+)", listing, re.MULTILINE):
        paths = [line.removeprefix("  - ").strip() for line in folders.splitlines()]
        yield duplicate_name(workspace.root, name, paths)


def _other_install_layout(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    match = re.search(r"was created with the layout '(\w+)'", output)
    if match:
        option = "Add --merge-install to" if match[1] == "merged" else "Remove --merge-install from"
        yield OTHER_INSTALL_LAYOUT.at(
            workspace.install,
            message=f"The install space has the layout '{match[1]}', but this build uses the "
            "other one.",
            hint=f"{option} colcon's arguments, or remove {workspace.install}.",
        )


def _other_build_tool(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    match = re.search(r"The build directory '.+?' was created by '(.+?)'", output)
    if match:
        yield OTHER_BUILD_TOOL.at(
            workspace.build,
            message=f"{match[1]} created the build folder, not colcon.",
            hint=f"Remove {workspace.build}, or build elsewhere: wsgen build -- --build-base DIR",
        )


def _unbuilt_dependency(output: str, workspace: Workspace) -> Iterator[Diagnostic]:
    match = re.search(r"following packages have been built:\n((?:\s*- \S+\n?)+)", output)
    if match:
        names = re.findall(r"- (\S+)", match[1])
        yield UNBUILT_DEPENDENCY.at(
            workspace.root,
            message=f"Dependencies of the selected packages are not built yet: {', '.join(names)}.",
            hint=f"Build them first: wsgen build {' '.join(names)}",
        )


def _refuse_unwritable(output: str, workspace: Workspace) -> None:
    match = re.search(
        r"(?m)^\w*Error: \[Errno (\d+)\] .+?: '(.+?)'|The install base '(.+?)' is not a", output
    )
    if match:
        number = int(match[1]) if match[1] else errno.ENOTDIR
        file = workspace.root / (match[2] or match[3])
        cannot_write = explain_write_error(OSError(number, os.strerror(number)), file).message
        raise NotReadableError(
            f"colcon {cannot_write[0].lower()}{cannot_write[1:]}",
            hint="Make build, install and log of the workspace folders that you may write to.",
        )


COLCON_CAUSES = (
    _duplicate_names,
    _other_install_layout,
    _other_build_tool,
    _unbuilt_dependency,
)


def explain_failure(
    workspace: Workspace,
    inventory: Inventory,
    progress: Progress,
    finished: Finished,
    *,
    distro: str,
) -> tuple[Diagnostic, ...]:
    """Explain the failure of each package.

    `distro` is that of the sourced ROS, or empty.

    Raises:
        RequestError: colcon refused its arguments.
        NotReadableError: colcon or a package cannot write where it has to.
    """
    failed = [result for result in progress.results if result.outcome == "failed"]
    refuse_full_disk(
        "\n".join([finished.output, *(line for one in failed for line in one.error_output)]),
        workspace,
    )
    _refuse(full_folder(*_written_folders(workspace)), workspace)  # a program may not print it
    known = recognize_colcon_failure(finished.output, workspace)
    if known:
        return known
    if failed:
        return tuple(_explain_packages(workspace, inventory, failed, distro))
    return explain_colcon(finished.output, finished.returncode, workspace)


def refuse_full_disk(output: str, workspace: Workspace) -> None:
    """Stop where a program has printed that the disk is full, often once for each file.

    Raises:
        NotReadableError: it has.
    """
    _refuse(find_full_disk(output, *_written_folders(workspace)), workspace)


def _written_folders(workspace: Workspace) -> tuple[Path, ...]:
    return (workspace.root, Path(tempfile.gettempdir()))


def _refuse(error: OSError | None, workspace: Workspace) -> None:
    if error is not None:
        raise explain_write_error(
            error, Path(error.filename), what=f"the build of {workspace.root}"
        )


def _explain_packages(
    workspace: Workspace,
    inventory: Inventory,
    failed: Sequence[PackageResult],
    distro: str,
) -> Iterator[Diagnostic]:
    readable = [package for package in inventory.packages if not package.diagnostics]
    folders = {package.name: package.path for package in readable}
    build_types = {package.name: package.build_type for package in readable}
    # colcon takes a package with an unreadable manifest for one of plain CMake, and goes on. The
    # failure that follows has its cause in the manifest, which is reported already.
    manifests = {package.name: package.manifest for package in readable}
    failing = {result.name for result in failed}
    has_unreadable = len(readable) < len(inventory.packages)
    for result in failed:
        folder = folders.get(result.name)
        if folder is None and has_unreadable:
            continue
        folder = folder or _folder_of(inventory, result.name) or workspace.root
        manifest = manifests.get(result.name)
        yield from explain(
            Failure(
                package=result.name,
                folder=folder,
                is_python=_is_python(folder, build_types.get(result.name)),
                build_folder=workspace.build / result.name,
                output="\n".join(result.error_output),
                siblings=folders.keys(),
                distro=distro,
                log=result.log_folder,
                failed=failing & manifest.names(BUILD_TAGS) if manifest is not None else (),
            )
        )


def _is_python(folder: Path, build_type: str | None) -> bool:
    """Whether setuptools builds the package; a package without package.xml has no build type."""
    if build_type is not None:
        return build_type == "ament_python"
    return (folder / "setup.py").exists() and not (folder / "CMakeLists.txt").exists()


def _folder_of(inventory: Inventory, name: str) -> Path | None:
    """Find the folder of a package without package.xml, by the usual name."""
    return next((folder for folder in inventory.others if folder.name == name), None)
