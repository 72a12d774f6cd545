"""Templates of the user: where one is, and what it was when a package was made of it.

What it was is in the git history of its folder: `wsgen.toml` has the commit.
"""

from __future__ import annotations

import re
import shutil
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, RequestError
from wsgen.pipeline.reported import run_git
from wsgen.templating.states import made_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.templating.template import Template


def made_of_own(template: Template) -> dict[str, str]:
    """What wsgen.toml says of a package that is made of a template of the user.

    The commit is missing if the folder has changes that are not committed, or git does not have it.
    """
    folder, program = template.folder, shutil.which("git")
    shown = f"~/{folder.relative_to(home)}" if folder.is_relative_to(home := Path.home()) else ""
    found = {**made_of(template), "folder": shown or str(folder)}
    if program and run_git(program, folder, "status", "--porcelain", "--", ".") == "":
        commit = run_git(program, folder, "log", "-1", "--format=%H", "--", ".")
        found |= {"commit": commit.strip()} if commit and commit.strip() else {}
    return {name: value for name, value in found.items() if value.isprintable()}


def folder_of(made: Mapping[str, str], given: str | None, name: str) -> Path:
    """The folder of a template of the user, now.

    Raises:
        NotFoundError: it is not there.
    """
    folder = Path(given or made.get("folder", name)).expanduser()
    if folder.is_dir():
        return folder.resolve()
    raise NotFoundError(
        f"The template {name!r} is not in {folder}.",
        hint="Name the folder where it is now: wsgen update --template FOLDER",
    )


def unpack_commit(folder: Path, made: Mapping[str, str], scratch: Path) -> Path:
    """Write a template as it was when a package was made of it into a new folder, and return that.

    Raises:
        RequestError: that is not recorded.
        NotFoundError: git does not have it.
    """
    commit = made.get("commit")
    if commit is None or not re.fullmatch("[0-9a-f]{7,64}", commit):
        raise RequestError(
            "wsgen.toml has no `commit` of the template: its folder was in no git repository, or "
            "had changes that were not committed.",
            hint='If you know the commit, write a line commit = "…" below `state`. Commit a '
            "template before `wsgen new`.",
        )
    program, packed = shutil.which("git"), scratch / "template.zip"
    words = ("archive", "--format=zip", "-o", str(packed), commit, ".")
    if program is None or run_git(program, folder, *words) is None:
        raise NotFoundError(
            f"The git history of {folder} does not have the template at commit {commit[:12]}."
            if program
            else "git is not installed: it has the template as it was.",
            hint="Run git fetch --unshallow there, or name another clone with --template FOLDER."
            if program
            else "Install git.",
        )
    unpacked = scratch / "own" / folder.name
    with zipfile.ZipFile(packed) as archive:
        archive.extractall(unpacked)  # git's own archive: no path leads out of it
    return unpacked
