"""What `wsgen new` says about what it has written."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.words import next_command, short_name

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

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
