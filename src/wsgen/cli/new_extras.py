"""What `wsgen new` writes beside a package: into the workspace around it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

from wsgen.cli.words import short_name

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.target import Target
    from wsgen.templating.render import RenderedTree
    from wsgen.workspace.layout import Workspace


def workflow_files(service: str | None, target: Target) -> RenderedTree:
    """The workflow for a service, if one is wanted."""
    if service is None:
        return {}
    from wsgen.templating.workflows import render_workflow

    return render_workflow(service, target)


def ignore_files(workspace: Workspace, *, verbose: bool) -> RenderedTree:
    """What git is to ignore, where wsgen makes the workspace and nobody has said it yet."""
    from wsgen.templating.workspace_files import IGNORE_FILE

    if os.path.lexists(workspace.source):
        return {}
    there = [workspace.root / name for name in IGNORE_FILE]
    there = [path for path in there if os.path.lexists(path)]
    if there and verbose:
        click.echo(f"note: {short_name(there[0])} is there already and stays as it is.", err=True)
    return {} if there else dict(IGNORE_FILE)


def note_repository(root: Path) -> None:
    """Say where a workflow is not looked for: services read it at the top of a repository."""
    top = next((folder for folder in (root, *root.parents) if (folder / ".git").exists()), root)
    if top != root:
        click.echo(
            f"note: {top} is the top of the repository: the workflow is read there alone. Move it,"
            f" and have its steps run in {root.relative_to(top)}.",
            err=True,
        )
