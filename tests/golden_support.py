"""Goldens: whole workspaces as `wsgen new` writes them, kept in folders that a person can build."""

import shutil
from pathlib import Path

from wsgen.cli import run

ROOT = Path(__file__).parents[1]
GOLDENS = ROOT / "tests" / "golden"
EXAMPLES = ROOT / "examples"
WORKSPACE = "ws_gazebo"
PACKAGE = "gazebo_test"
# Whoever runs the tests, the files are the same.
MAINTAINER = ("--maintainer-name", "Ada Lovelace", "--maintainer-email", "ada@example.com")


def generate(folder: Path, *arguments: str) -> Path:
    """Write the workspace with `wsgen new` below `folder`; returns the workspace."""
    workspace = folder / WORKSPACE
    assert run(["new", PACKAGE, "-w", str(workspace), *MAINTAINER, *arguments]) == 0
    return workspace


def compare_trees(written: Path, kept: Path, *, regenerate: bool) -> None:
    """Both folders hold the same files; or, to regenerate, make it so."""
    if regenerate:
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(written, kept)
    assert read_tree(written) == read_tree(kept), "if that is meant: pytest --regenerate"


def read_tree(folder: Path) -> dict[str, str]:
    """Path -> text of every file; what building leaves behind does not count."""
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not {"build", "install", "log", "__pycache__"} & {*path.parts}
    }
