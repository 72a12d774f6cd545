"""What `wsgen new` says about what it has written.

What `wsgen new` writes beside a package: into the workspace around it.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

from wsgen.cli.words import next_command, short_name

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from wsgen.model.target import Target
    from wsgen.templating.render import RenderedTree
    from wsgen.workspace.layout import Workspace


def tell_text(
    workspace: Workspace,
    folder: Path,
    files: Sequence[str],
    extras: Sequence[str],
    *,
    is_written: bool,
    goes_on: bool,
) -> None:
    """`files` are in the folder of the package, `extras` in that of the workspace.

    The next step is not told to those for whom wsgen `goes_on` to take it.
    """
    beside = [workspace.root / name for name in extras]
    if not is_written:
        for path in (*(folder / name for name in files), *beside):
            click.echo(click.format_filename(path))
        click.echo("Nothing was written.", err=True)
        return
    for path in (folder, *beside):
        click.echo(f"Wrote {short_name(path)}")
    if not goes_on:
        click.echo(f"Next: {next_command(workspace, 'wsgen build', 'wsgen validate')}")


def tell_json(
    workspace: Workspace,
    folder: Path,
    files: Sequence[str],
    extras: Sequence[str],
    *,
    is_written: bool,
    goes_on: bool,  # noqa: ARG001  programs are told no next step
) -> None:
    """The same for programs."""
    import json

    result = {
        "version": 1,
        "package": folder.name,
        "path": str(folder),
        "workspace": str(workspace.root),
        "files": list(files),
        "workspace_files": list(extras),
        "written": is_written,
    }
    click.echo(json.dumps(result, indent=2))


def workflow_files(service: str | None, target: Target) -> RenderedTree:
    """The workflow for a service, if one is wanted."""
    if service is None:
        return {}
    from wsgen.templating.workflows import render_workflow

    return render_workflow(service, target)


def ignore_files(workspace: Workspace, *, verbose: bool) -> RenderedTree:
    """What git is to ignore, where wsgen makes the workspace and nobody has said it yet."""
    from wsgen.templating.write import IGNORE_FILE

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
