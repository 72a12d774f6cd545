"""What the user asks to validate: which packages, and by which of their launch files."""

from __future__ import annotations

import os
import re
from collections import Counter
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.building.colcon import refuse_empty
from wsgen.diagnostics import Rule, Severity
from wsgen.errors import RequestError
from wsgen.isolation import parent
from wsgen.model.outcome import NotValidated
from wsgen.packages.build_files.cmake_text import read_calls
from wsgen.packages.build_files.install_checks import UNINSTALLED_LAUNCH_FILE
from wsgen.packages.workspace.layout import find_launch_files, find_packages, read_package
from wsgen.packages.workspace.overlay import require_share
from wsgen.packages.workspace.robot_files import find_robot_files
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.candidates import (
    LaunchFile,
    choose,
    evaluate_launch_files,
    with_commands,
    with_descriptions,
)
from wsgen.pipeline.plan_launch import (
    find_misnamed,
    find_named_launch_file,
    list_launch_files,
    no_such_launch_file,
)
from wsgen.pipeline.requests import SelectedPackage
from wsgen.pipeline.started import overlay_for, start

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.world import Spawn
    from wsgen.packages.build_files.cmake_text import Call
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.candidates import Candidate, Choice
    from wsgen.pipeline.requests import ValidateRequest
    from wsgen.pipeline.started import Started


MISNAMED_LAUNCH_FILE = Rule(
    code="PKG051",
    name="misnamed-launch-file",
    severity=Severity.ERROR,
    summary="The name of a launch file has the wrong ending.",
    what="Looks for launch files by their content where the package has none whose name ends with "
    "`launch.py`, `launch.xml`, `launch.yaml` or `launch.yml`, and no Python file in a folder "
    "`launch`.",
    why="`ros2 launch` and `wsgen` find launch files by these names. Editors and browsers append "
    "`.txt`.",
    example="src/my_robot/launch/gazebo_model.launch.py.txt",
    instead="src/my_robot/launch/gazebo_model.launch.py",
)


class Selection(NamedTuple):
    """What is validated, and why the rest is not."""

    packages: tuple[SelectedPackage, ...] = ()
    not_validated: tuple[NotValidated, ...] = ()


class PackageFiles(NamedTuple):
    """The launch files of a package."""

    name: str
    source: Path | None  # None: of an underlay
    share: Path | None  # see `SelectedPackage`
    installed: tuple[Path, ...]
    uninstalled: tuple[Path, ...]  # of the source, or misnamed
    right_name: str | None = None  # that the misnamed one should have


def select_packages(
    workspace: Workspace, overlay: Overlay, request: ValidateRequest, listener: Listener | None
) -> Selection:
    """The packages to validate, each with a launch file that spawns a robot.

    Raises:
        RequestError: a package or launch file that is named does not exist.
        NotFoundError: a named package cannot be read, or the workspace has no package.
    """
    sources: dict[str, Path] = {}
    for package in find_packages(workspace):
        sources.setdefault(package.name, package.path)  # of two, the overlay has the first
    if not request.packages and not sources:
        refuse_empty(workspace)
    for name in request.packages:
        _check_name(name, sources)
        require_share(overlay, workspace, name)
    names = tuple(dict.fromkeys(request.packages)) or tuple(sources)
    shares = {share: path for name, path in sources.items() if (share := overlay.share(name))}
    if request.launch_file is not None:
        by_name = _select_by_launch_file(names, sources, overlay, request)
        return Selection(tuple(_with_labels(by_name, shares)))
    packages = {name: _list_files(name, sources.get(name), overlay.share(name)) for name in names}

    def evaluate(
        launch_file: LaunchFile, run: Run, arguments: Mapping[str, str] = MappingProxyType({})
    ) -> Started:
        package = packages[launch_file.package]
        given = replace(request, launch_arguments={**arguments, **request.launch_arguments})
        name = package.name if package.share else None
        return start(launch_file.file, name, overlay_for(package.name, overlay), given, run)

    evaluated = evaluate_launch_files(
        [
            LaunchFile(name, file, is_installed)
            for name, package in packages.items()
            for is_installed, files in ((True, package.installed), (False, package.uninstalled))
            for file in files
        ],
        request.jobs if request.jobs > 1 else len(os.sched_getaffinity(0)),
        listener,
        evaluate,
    )
    started = with_commands(evaluated, lambda file, given: evaluate(file, parent.run, given))
    found = tuple(with_descriptions(started, overlay))
    behaviors = {name: read_settings(source)[0].behaviors for name, source in sources.items()}
    behaving = {name for name, wanted in behaviors.items() if wanted}
    choice = choose(
        [one for one in found if one.launch_file.is_installed],
        kept=behaving,
        named=request.packages or (names if len(found) == 1 else ()),
        running=()
        if request.run_live is None
        else [name for name in behaving if any(one.runs_launch_file for one in behaviors[name])],
    )
    packages_of_chosen = {one.package for one in choice.chosen}
    uninstalled = choose(
        [
            one
            for one in found
            if not one.launch_file.is_installed and one.package not in packages_of_chosen
        ]
    )
    problems = {one.package: one for one in reversed(uninstalled.chosen)}
    selected = [
        *(_select(one, packages[one.package], choice.chosen, found) for one in choice.chosen),
        *(_with_problem(one, packages[one.package]) for one in problems.values()),
    ]
    order = {name: number for number, name in enumerate(names)}
    selected.sort(key=lambda one: order[one.name])
    return Selection(
        tuple(_with_labels(selected, shares)),
        tuple(_not_validated(packages, choice, {one.name for one in selected})),
    )


def _check_name(name: str, sources: Mapping[str, Path]) -> None:
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", name):
        near = name.strip("./").rpartition("/")[2]
        raise RequestError(
            f"The package {name!r} does not exist.",
            hint=f"Write: wsgen validate {near}"
            if near in sources
            else "Give the name of a package, or a .urdf, .xacro, .sdf or .world file.",
        )


def _select_by_launch_file(
    names: Sequence[str], sources: Mapping[str, Path], overlay: Overlay, request: ValidateRequest
) -> list[SelectedPackage]:
    """The packages that install the launch file of the request; each that is named must."""
    wanted = request.launch_file or ""
    selected = []
    for name in names:
        share = overlay.share(name)
        file = find_named_launch_file(share, wanted) if share else None
        if file is not None:
            source = sources.get(name)
            selected.append(
                SelectedPackage(name=name, source=source, share=share, launch_file=file)
            )
        elif share is not None and (request.packages or len(names) == 1):
            raise no_such_launch_file(name, wanted, find_launch_files(share))
    if not selected:
        raise RequestError(
            f"The packages of the workspace do not install a launch file {wanted}.",
            hint="Run `wsgen validate` without --launch to list the launch files that spawn "
            "robots.",
        )
    return selected


def _list_files(name: str, source: Path | None, share: Path | None) -> PackageFiles:
    installed = list_launch_files(share) if share else []
    written = list_launch_files(source) if source else []
    there = {file.name for file in installed}
    uninstalled = tuple(
        file
        for file in written
        if file.name not in there
        and source is not None
        and file.relative_to(source).parts[0] in {"launch", file.name}
    )
    folder = source or share
    misnamed = find_misnamed(folder) if folder and not (installed or written) else None
    if misnamed is not None:
        file, right_name = misnamed
        return PackageFiles(name, source, share, (), (file,), right_name)
    return PackageFiles(name, source, share, tuple(installed), uninstalled)


def _select(
    candidate: Candidate,
    package: PackageFiles,
    chosen: Sequence[Candidate],
    found: Sequence[Candidate],
) -> SelectedPackage:
    of_package = [one for one in chosen if one.package == package.name]
    return SelectedPackage(
        name=package.name,
        source=package.source,
        share=package.share,
        launch_file=candidate.file,
        started=candidate.started,
        is_first=of_package[0] is candidate,
        elsewhere=frozenset(spawn.entity for one in of_package for spawn in one.started.spawns),
        beside=tuple(
            one.started.plan
            for one in found
            if one.package == package.name and one.launch_file != candidate.launch_file
        ),
    )


def _with_problem(candidate: Candidate, package: PackageFiles) -> SelectedPackage:
    """A package that does not install its launch file, which spawns a robot."""
    source, share = package.source, package.share
    found = read_package(source) if source is not None and share is None else None
    problem = found.diagnostics[0] if found else _not_installed(package, candidate.file)
    return SelectedPackage(name=package.name, source=source, share=share, problem=problem)


def _with_labels(
    selected: Sequence[SelectedPackage], shares: Mapping[Path, Path]
) -> Iterator[SelectedPackage]:
    """Each with its package as the label, or with package and launch file where it has several."""
    counts = Counter(one.name for one in selected)
    used: set[str] = set()
    for one in selected:
        label = one.name
        if counts[one.name] > 1 and one.launch_file is not None:
            stem = re.sub(r"[._-]?launch\.(py|xml|ya?ml)$", "", one.launch_file.name)
            label = f"{one.name}-{stem or one.launch_file.name}"
        number = 1
        wanted = label
        while label in used:
            number += 1
            label = f"{wanted}-{number}"
        used.add(label)
        yield replace(one, label=label, workspace=shares)


def _not_validated(
    packages: Mapping[str, PackageFiles], choice: Choice, selected: Collection[str]
) -> Iterator[NotValidated]:
    """The launch files that are not simulated, and the packages that spawn no robot."""
    explained = set()
    for one, reason in choice.others:
        explained.add(one.package)
        yield NotValidated(package=one.package, launch_file=one.file, reason=reason)
    for name, package in packages.items():
        if name in selected or name in explained:
            continue
        spawners = _spawners_of(package, choice.chosen)
        if spawners:
            yield NotValidated(package=name, reason=f"robot spawned by {', '.join(spawners)}")
        else:
            yield NotValidated(
                package=name,
                reason="is a package of ROS 1" if _is_of_ros_1(package) else "spawns no robot",
                robot_files=find_robot_files(folder)
                if (folder := package.source or package.share)
                else (),
            )


def _is_of_ros_1(package: PackageFiles) -> bool:
    """Whether catkin builds it, whose launch files nobody starts here."""
    found = read_package(package.source) if package.source else None
    return found is not None and found.build_type == "catkin"


def _spawners_of(package: PackageFiles, chosen: Sequence[Candidate]) -> list[str]:
    """The packages that spawn a robot of this one."""
    folders = [os.path.realpath(folder) for folder in (package.share, package.source) if folder]
    starts = (
        *(f"{scheme}://{package.name}/" for scheme in ("package", "model")),
        *(os.path.join(folder, "") for folder in folders),  # noqa: PTH118  with a separator
    )

    def is_of_package(spawn: Spawn) -> bool:
        file = spawn.description_file
        is_there = file is not None and os.path.realpath(file).startswith(starts)
        return is_there or any(start in spawn.description for start in starts)

    return list(
        dict.fromkeys(one.package for one in chosen if any(map(is_of_package, one.started.spawns)))
    )


def _not_installed(package: PackageFiles, file: Path) -> Diagnostic:
    """Report a launch file that is not in the share folder, or not named as one."""
    source, share = package.source, package.share
    if package.right_name is not None or source is None or share is None:
        return MISNAMED_LAUNCH_FILE.at(
            file,
            message=f"The name of the launch file `{file.name}` does not end with `launch.py`.",
            hint=f"Rename it to {package.right_name}, then run `wsgen build`.",
        )
    rule = _find_install_rule(source, file)
    if rule is not None:
        return _misplaced_launch_file(source, file, rule, share.name)
    folder = file.relative_to(source).parent.as_posix()
    is_cmake = (source / "CMakeLists.txt").is_file()
    what = f"FILES {file.name}" if folder == "." else f"DIRECTORY {folder.split('/')[0]}"
    return UNINSTALLED_LAUNCH_FILE.at(
        source / ("CMakeLists.txt" if is_cmake else "setup.py"),
        message=f"The package does not install its launch file {file.relative_to(source)}.",
        hint=f"Write in CMakeLists.txt: install({what} DESTINATION "
        "share/${PROJECT_NAME}); then run `wsgen build`."
        if is_cmake
        else f"Add to `data_files` in setup.py: ('share/{package.name}/{folder}', "
        f"glob('{folder}/*')); then run `wsgen build`.",
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
        hint = (
            "Run `wsgen build`; if the folder is still missing, check for an if() around install()."
        )
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
