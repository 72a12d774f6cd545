"""Goldens: workspaces as `wsgen new` writes them.

Of each template one golden for Gazebo Classic and one for Gazebo Sim is whole, in a folder that a
person can build. The others hold only the files that differ from it, so that a person reads a
change once.
"""

import atexit
import shutil
import tempfile
from functools import cache
from pathlib import Path

from wsgen.cli import run
from wsgen.model.target import TARGETS, Target
from wsgen.templating.template import load_template, template_names

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
# The distributions of the whole goldens.
WHOLE = {"classic": "iron", "gz": "jazzy"}


def whole_case(case: str) -> str:
    """The whole golden of the same template and simulator."""
    template, target = CASES[case]
    return f"{template}-{WHOLE[target.simulator]}-{target.simulator}"


def arguments(template: str, target: Target) -> tuple[str, ...]:
    """What `wsgen new` is told for a template and a target."""
    return ("-t", template, "--distro", target.distro, "--sim", target.simulator)


def generate(folder: Path, *arguments: str, package: str = PACKAGE) -> Path:
    """Write the workspace with `wsgen new` below `folder`; returns the workspace."""
    workspace = folder / WORKSPACE
    assert run(["new", package, "-w", str(workspace), *MAINTAINER, *arguments]) == 0
    return workspace


@cache
def golden_package(case: str) -> Path:
    """The package of a golden; one that is not whole is completed in a temporary folder."""
    whole, own = (GOLDENS / name / WORKSPACE / "src" / PACKAGE for name in (whole_case(case), case))
    if whole == own:
        return own
    package = _temporary_folder() / case / PACKAGE
    shutil.copytree(whole, package)
    shutil.copytree(own, package, dirs_exist_ok=True)
    return package


@cache
def _temporary_folder() -> Path:
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def compare_golden(case: str, folder: Path, *, regenerate: bool) -> None:
    """`wsgen new` writes the golden; or, to regenerate, make it so."""
    kept = GOLDENS / case / WORKSPACE
    whole = whole_case(case)
    written = generate(folder / "case", *arguments(*CASES[case]))
    if case != whole:
        # Not the whole golden that is kept, which another test may be about to regenerate.
        base = read_tree(generate(folder / "whole", *arguments(*CASES[whole])))
        tree = read_tree(written)
        assert base.keys() <= tree.keys(), f"{case} lacks files of {whole}: keep it whole as well"
        for path in base.keys() & tree.keys():
            if tree[path] == base[path]:
                (written / path).unlink()
    compare_trees(written, kept, regenerate=regenerate)


def compare_trees(written: Path, kept: Path, *, regenerate: bool) -> None:
    """Both folders hold the same files; or, to regenerate, make it so."""
    if regenerate:
        shutil.rmtree(kept, ignore_errors=True)
        for path, text in read_tree(written).items():
            (kept / path).parent.mkdir(parents=True, exist_ok=True)
            (kept / path).write_text(text, encoding="utf-8")
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
