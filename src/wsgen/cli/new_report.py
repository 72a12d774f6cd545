"""What `wsgen new` says about what it has written."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

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
) -> None:
    """`files` are in the folder of the package, `extras` in that of the workspace."""
    beside = [workspace.root / name for name in extras]
    if not is_written:
        for path in (*(folder / name for name in files), *beside):
            click.echo(click.format_filename(path))
        click.echo("Nothing was written.", err=True)
        return
    for path in (folder, *beside):
        click.echo(f"Wrote {short(path)}")
    click.echo(f"Next: {_next_command(workspace)}")


def tell_json(
    workspace: Workspace,
    folder: Path,
    files: Sequence[str],
    extras: Sequence[str],
    *,
    is_written: bool,
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


def short(path: Path) -> str:
    """Relative to the current folder where that is below it."""
    from pathlib import Path

    here = Path.cwd()
    return click.format_filename(path.relative_to(here) if here in path.parents else path)


def _next_command(workspace: Workspace) -> str:
    """What to type next, from the current folder."""
    import shlex
    from pathlib import Path

    commands = ["wsgen build", "wsgen validate"]
    here = Path.cwd()
    if workspace.root != here and workspace.root not in here.parents:
        commands.insert(0, f"cd {shlex.quote(short(workspace.root))}")
    return " && ".join(commands)
