"""Check the Python nodes of a package: each file, as it is installed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.build_files.python_sources import python_files
from wsgen.diagnostics import Severity
from wsgen.rules.python_nodes import check_node, idle_program
from wsgen.workspace.python_nodes import KINDS, read_node_file

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.workspace.layout import PackageFolder


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


def _interfaces(folder: Path) -> frozenset[str]:
    """The messages, services and actions whose files a package has."""
    return frozenset(
        f"{kind}/{file.stem}"
        for kind in KINDS
        if (folder / kind).is_dir()
        for file in (folder / kind).iterdir()
        if file.suffix in {f".{kind}", ".idl"}
    )
