"""Check what a package is built from: package.xml, build files, Python nodes, parameters."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.controller_joints import (
    Controlled,
    check_controllers,
    drive_sections,
    missing_controller_file,
)
from wsgen.checks.rules.controllers import started_controllers
from wsgen.checks.rules.dependencies import check_circles, check_dependencies
from wsgen.checks.rules.drives import check_drive_controller
from wsgen.checks.rules.manifests import check_manifest, generated_interfaces
from wsgen.checks.rules.node_topics import UsedTopic, remapped, unheard_commands, unpublished_topics
from wsgen.checks.rules.package_uses import (
    check_required,
    check_tests,
    check_uses,
    may_be_unused,
    unused_dependencies,
)
from wsgen.checks.rules.python_nodes import check_node, idle_program, unspun_node
from wsgen.checks.rules.ros2_control import ControlFacts, control_plugins, control_without_plugin
from wsgen.checks.rules.simulators import misplaced_spawners
from wsgen.descriptions.xacro.reader import place_in_source
from wsgen.diagnostics import Severity
from wsgen.launching.commands import has_gaps, started_programs
from wsgen.launching.known_packages import find_in_package
from wsgen.launching.simulators import simulator_kinds
from wsgen.packages.build_files.cmake_checks import check_for_distro
from wsgen.packages.build_files.python_sources import (
    check_python_syntax,
    program_files,
    python_files,
)
from wsgen.packages.source_shares import INDEX
from wsgen.packages.workspace.package_uses import (
    LAUNCH,
    PackageUse,
    find_files,
    installed_places,
    read_uses,
    unmentioned,
)
from wsgen.packages.workspace.package_xml import check_build_type, check_package_xml
from wsgen.packages.workspace.python_nodes import KINDS, read_node_file
from wsgen.pipeline.check_launched import topics_of_launch
from wsgen.text import yamlfile
from wsgen.text.files import real_path

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.model.package import ShareOf
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.model.robot import Robot
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.manifest import Manifest
    from wsgen.packages.workspace.python_nodes import NodeFile
    from wsgen.pipeline.started import Started


def check_package_manifest(
    package: PackageFolder,
    *,
    build: BuildFacts | None,
    plans: Iterable[LaunchPlan],
    packages: Mapping[str, PackageFolder],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what is wrong with package.xml, and what it does not declare.

    Args:
        package: that is checked; nothing is reported where its package.xml cannot be read.
        build: what its build files say; None of a package in an install space.
        plans: of its launch files.
        packages: of the workspace, by name.
        distro: the distribution that the package is for; None where it is not known.
    """
    manifest = package.manifest
    if manifest is None:
        return
    folder = package.path
    if build is not None:
        destinations = {one.destination for one in build.installed}
        yield from check_build_type(
            manifest,
            calls_ament_package=f"{INDEX}/{package.name}" in destinations
            and (folder / "CMakeLists.txt").is_file(),
            is_python=(folder / "setup.py").is_file() and not (folder / "CMakeLists.txt").is_file(),
        )
        interfaces = generated_interfaces(package.name, build)
        yield from check_manifest(manifest, folder, interfaces=interfaces)
    if manifest.build_type == "catkin":
        return  # of ROS 1, or without build type: that is reported
    manifests = {
        name: one.manifest for name, one in packages.items() if one.manifest is not None
    } | {package.name: manifest}
    yield from check_circles(manifest, manifests)
    plans = tuple(plans)
    looked_up = [use for plan in plans for use in _looked_up(plan, folder)]
    yield from check_dependencies(
        manifest,
        workspace=manifests.keys(),
        distro=distro,
        launched={use.package for use in looked_up},
    )
    misplaced = {
        (real_path(one.file), one.package)
        for plan in plans
        for one in misplaced_spawners(plan, simulator_kinds(plan))
        if one.file is not None
    }
    uses = tuple(
        use
        for use in (
            *_in_order(folder, manifests, build),
            *looked_up,
        )
        if (real_path(use.file), use.package) not in misplaced  # to be replaced
    )
    yield from check_uses(manifest, uses, manifests=manifests, distro=distro)
    if build is not None:
        yield from check_required(
            manifest, build.required_packages, manifests=manifests, distro=distro
        )
        yield from check_tests(
            manifest, build.required_packages, manifests=manifests, distro=distro
        )
        candidates = may_be_unused(manifest, build, uses)
        if candidates:
            yield from unused_dependencies(manifest, unmentioned(folder, candidates))


def _in_order(
    folder: Path, manifests: Mapping[str, Manifest], build: BuildFacts | None
) -> Iterable[PackageUse]:
    """What files use, those of launch files first."""
    uses = read_uses(
        find_files(folder), workspace=manifests.keys(), installed=installed_places(build)
    )
    return sorted(uses, key=lambda use: use.kind != LAUNCH)


def _looked_up(plan: LaunchPlan, folder: Path) -> Iterator[PackageUse]:
    """The packages that a launch file of this package looks up when it is evaluated."""
    inside = Path(real_path(folder))
    for lookup in plan.lookups:
        file = Path(real_path(lookup.file))
        if file.is_relative_to(inside):
            yield PackageUse(lookup.package, file, lookup.line, LAUNCH)


def check_sources(  # noqa: PLR0913  what files say
    package: PackageFolder,
    *,
    build: BuildFacts | None,
    problems: Iterable[Diagnostic],
    plans: Iterable[LaunchPlan],
    packages: Mapping[str, PackageFolder],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what is wrong with package.xml and the build files, and what they do not declare.

    Args:
        package: that is checked.
        build: what its build files say; None of a package in an install space.
        problems: what is wrong in the build files by themselves.
        plans: of its launch files.
        packages: of the workspace, by name.
        distro: the distribution that the package is for; None where it is not known.
    """
    if package.diagnostics:
        yield from package.diagnostics
        return
    yield from check_package_xml(package.path / "package.xml", package.manifest)
    yield from problems
    if build is not None:
        yield from check_for_distro(build.dated_calls, distro)
        if package.build_type != "catkin":  # whose programs may be of Python 2
            yield from check_python_syntax(build, distro)
            yield from check_nodes(build, packages)
    yield from check_package_manifest(
        package, build=build, plans=plans, packages=packages, distro=distro
    )


def check_nodes(build: BuildFacts, packages: Mapping[str, PackageFolder]) -> Iterator[Diagnostic]:
    """Check the Python files that a package installs; `packages` are those of the workspace."""
    files = python_files(build)
    nodes = {file: read_node_file(file) for file in files}
    workspace = {name: _interfaces(one.path) for name, one in packages.items()} if files else {}
    programs = {one.source for one in build.executables}
    imported = {word for node in nodes.values() if node is not None for word in node.imported}
    for file, is_started in files.items():
        node = nodes[file]
        if node is None:
            continue
        for found in check_node(node, workspace):
            yield found if is_started else replace(found, severity=Severity.WARNING)
        if file in programs and file.stem not in imported:
            yield from idle_program(node)
        if is_started and file.stem not in imported:
            yield from unspun_node(node)


def _interfaces(folder: Path) -> frozenset[str]:
    """The messages, services and actions whose files a package has."""
    return frozenset(
        f"{kind}/{file.stem}"
        for kind in KINDS
        if (folder / kind).is_dir()
        for file in (folder / kind).iterdir()
        if file.suffix in {f".{kind}", ".idl"}
    )


# In names of packages that read or publish commands and topics of sensors under other names.
_BETWEEN = ("mux", "nav2", "navigation", "smoother", "relay", "tools", "stamper", "servo", "joy")


def check_topics(
    package: PackageFolder,
    started: Sequence[Started],
    facts: Mapping[str, BuildFacts],
    packages: Mapping[str, PackageFolder],
) -> Iterator[Diagnostic]:
    """Compare the topics of nodes with those of the robot that a package spawns.

    Args:
        package: Whose launch files spawn it.
        started: What its launch files start.
        facts: What the packages of the workspace install.
        packages: All packages of the workspace.
    """
    manifests = {name: one.manifest for name, one in packages.items() if one.manifest}
    names = {package.name} | {
        name for name, one in manifests.items() if package.name in one.dependency_names
    }
    builds = {name: facts[name] for name in names if name in facts}
    declared = {
        one for name in names & manifests.keys() for one in manifests[name].dependency_names
    }
    if any(word in name for name in declared for word in _BETWEEN) or any(
        target.kind == "executable" for build in builds.values() for target in build.targets
    ):
        return
    nodes = {
        (name, program): node
        for name, build in builds.items()
        for program, file in program_files(build).items()
        if (node := read_node_file(file)) is not None
    }
    if not nodes:
        return
    graphs = [topics_of_launch(one, nodes.keys()) for one in started]
    processes = {
        (program.package, program.executable): program
        for one in started
        for program in started_programs(one.plan)
    }
    used = [
        topic for key, node in nodes.items() for topic in _used_topics(node, processes.get(key))
    ]
    yield from unheard_commands(graphs, used)
    yield from unpublished_topics(graphs, used)


def _used_topics(node: NodeFile, program: Process | None) -> Iterator[UsedTopic]:
    for one in node.topics:
        name = None if one.name is None else remapped(one.name, program)
        yield UsedTopic(name, one.type, one.is_published, one.name or "", node.file, one.line)


def check_controlled(
    robots: Iterable[tuple[Robot, Path | None]], plans: Iterable[LaunchPlan], share_of: ShareOf
) -> Iterator[Diagnostic]:
    """Check the files of parameters that the plugins of the robots name.

    `robots` are those of a package, as written, with the files that describe them, which may
    include others.
    """
    started, surely = _started(plans)
    robots = list(robots)
    for robot, file in robots if started else ():
        found = without_plugin(robot, file)
        yield from place_in_source(found, text="", file=file, share_of=share_of)
    of_file: dict[Path, list[tuple[Robot, Path | None]]] = {}
    for robot, file in robots:
        for plugin in control_plugins(robot.gazebo):
            for text in plugin.values.get("parameters", ()):
                path = Path(text)
                if not path.is_absolute() or "$" in text:
                    continue
                if path not in of_file and not path.is_file():
                    folder = path.parent
                    beside = [one.name for one in folder.iterdir()] if folder.is_dir() else []
                    missing = missing_controller_file(
                        plugin, path, beside, file, find_in_package(text, share_of)
                    )
                    yield from place_in_source([missing], text="", file=file, share_of=share_of)
                of_file.setdefault(path, []).append((robot, file))
    for path, users in of_file.items():
        content = yamlfile.load_parameters(path)
        if isinstance(content, yamlfile.Value):
            described = [robot for robot, _ in users]
            yield from _check_file(path, content, described, started, surely)
            yield from _check_drives(path, content, users, share_of)


def _started(plans: Iterable[LaunchPlan]) -> tuple[set[str], set[str]]:
    """The controllers that are started, and those that surely are, whatever is given.

    A robot may have parts that only some launch files give it.
    """
    started: set[str] = set()
    surely: set[str] = set()
    for plan in plans:
        names = set(started_controllers(plan))
        started |= names
        if not has_gaps(plan):
            surely |= names
    return started, surely


def _check_drives(
    path: Path,
    content: yamlfile.Value,
    users: Sequence[tuple[Robot, Path | None]],
    share_of: ShareOf,
) -> Iterator[Diagnostic]:
    robot, file = users[0]
    # Of several robots, nobody knows which one has the wheels.
    for name, values in drive_sections(content) if len(users) == 1 else ():
        for found in check_drive_controller(robot, name, values, path, file):
            if found.file == file:
                yield from place_in_source([found], text="", file=file, share_of=share_of)
            else:
                yield found


def without_plugin(robot: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report the hardware of a robot that nothing loads, although its controllers are started."""
    facts = ControlFacts(
        controls=robot.controls, joints=robot.joints, plugins=control_plugins(robot.gazebo)
    )
    for found in control_without_plugin(facts, file):
        yield replace(found, severity=Severity.ERROR)


def _check_file(
    path: Path, content: yamlfile.Value, users: list[Robot], started: set[str], surely: set[str]
) -> Iterator[Diagnostic]:
    controlled = Controlled(
        joints=[joint for robot in users for joint in robot.joints],
        controls=[system for robot in users for system in robot.controls],
        started=started,
        of_parts=started - surely,
    )
    yield from check_controllers(content, controlled, path)
