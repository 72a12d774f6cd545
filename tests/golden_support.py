"""Goldens: whole workspaces as `wsgen new` writes them, kept in folders that a person can build."""

import shutil
from pathlib import Path

from wsgen.cli import run
from wsgen.model.target import TARGETS, Target
from wsgen.templating.manifest import load_template, template_names

ROOT = Path(__file__).parents[1]
GOLDENS = ROOT / "tests" / "golden"
EXAMPLES = ROOT / "examples"
WORKSPACE = "ws_gazebo"
PACKAGE = "gazebo_test"
LAUNCH_FILE = "gazebo_model.launch.py"
# Whoever runs the tests, the files are the same.
MAINTAINER = ("--maintainer-name", "Ada Lovelace", "--maintainer-email", "ada@example.com")

# Name of the golden -> its template and its target: all that exist.
CASES: dict[str, tuple[str, Target]] = {
    f"{template}-{target.name}": (template, target)
    for template in template_names()
    for target in TARGETS
    if target in load_template(template).targets
}


def arguments(template: str, target: Target) -> tuple[str, ...]:
    """What `wsgen new` is told for a template and a target."""
    return ("-t", template, "--distro", target.distro, "--sim", target.simulator)


def generate(folder: Path, *arguments: str, package: str = PACKAGE) -> Path:
    """Write the workspace with `wsgen new` below `folder`; returns the workspace."""
    workspace = folder / WORKSPACE
    assert run(["new", package, "-w", str(workspace), *MAINTAINER, *arguments]) == 0
    return workspace


def golden_package(case: str) -> Path:
    """The package of a golden."""
    return GOLDENS / case / WORKSPACE / "src" / PACKAGE


def compare_trees(written: Path, kept: Path, *, regenerate: bool) -> None:
    """Both folders hold the same files; or, to regenerate, make it so."""
    if regenerate:
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(written, kept)
        # At the folder above, so that the workspace itself can be built.
        (kept.parent / "COLCON_IGNORE").touch()
    assert read_tree(written) == read_tree(kept), "if that is meant: pytest --regenerate"


def read_tree(folder: Path) -> dict[str, str]:
    """Path -> text of every file; what building leaves behind does not count."""
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not {"build", "install", "log", "__pycache__"} & {*path.parts}
    }
