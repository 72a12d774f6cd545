"""Write a port: only over files that git has, or that the user gives up."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.pipeline.reported import run_git
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.porting.adding.addition import AddPlan
    from wsgen.porting.plan import PortPlan


def refuse_unsaved(
    folders: Iterable[Path], what: str = "a port", files: Sequence[Path] = ()
) -> None:
    """Stop where a change cannot be taken back with git.

    Args:
        folders: Of packages.
        what: Changes files in them.
        files: Those that are changed; none: all may be.

    Raises:
        RequestError: A folder is in no git repository, or has changes that are not committed.
    """
    program = shutil.which("git")
    words = ("status", "--porcelain", "--", *(map(str, files) if files else (".",)))
    for folder in folders:
        status = run_git(program, folder, *words) if program else None
        if status is None:
            raise RequestError(
                f"{folder} is not in a git repository: {what} changes files in place, and could "
                "not be taken back.",
                hint="Look at it with --diff first. `git init && git add -A && git commit` keeps "
                "what is there; --force does without.",
            )
        if status.strip():
            count = len(status.splitlines())
            raise RequestError(
                f"{folder} has changes that are not committed ({count} "
                f"{'file' if count == 1 else 'files'}): they would be mixed with {what}.",
                hint="Commit or stash them first, or use --force. Use --diff to see the changes "
                "without writing.",
            )


def write_port(plan: PortPlan | AddPlan) -> Iterator[Path]:
    """Write the files, each whole or not at all; those that are written.

    Raises:
        NotReadableError: A file cannot be written; those after it are unchanged.
    """
    for file, text in plan.created:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_file(file, text)
        yield file
    for one in plan.files:
        write_file(one.file, one.data)
        yield one.file
