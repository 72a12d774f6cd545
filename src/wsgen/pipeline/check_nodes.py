"""Check the Python nodes of a package: each file, as it is installed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules.node_topics import UsedTopic, remapped, unheard_commands, unpublished_topics
from wsgen.checks.rules.python_nodes import check_node, idle_program, unspun_node
from wsgen.diagnostics import Severity
from wsgen.launching.commands import started_programs
from wsgen.packages.build_files.python_sources import program_files, python_files
from wsgen.packages.workspace.python_nodes import KINDS, read_node_file
from wsgen.pipeline.check_launched import topics_of_launch

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.model.plan import Process
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.python_nodes import NodeFile
    from wsgen.pipeline.started import Started


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
        name
        for name, one in manifests.items()
        if package.name in {dependency.name for dependency in one.dependencies}
    }
    builds = {name: facts[name] for name in names if name in facts}
    declared = {
        dependency.name
        for name in names & manifests.keys()
        for dependency in manifests[name].dependencies
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
