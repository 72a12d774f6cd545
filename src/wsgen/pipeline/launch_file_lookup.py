"""Find the launch files of a package, also those that are not named like one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.packages.workspace.layout import LAUNCH_FUNCTION, find_launch_files, find_packages
from wsgen.text.files import read_whole
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.packages.workspace.layout import Workspace


TEST_FUNCTION = b"def generate_test_description("
TEST_FOLDERS = frozenset(("test", "tests"))


def find_named_launch_file(share: Path, wanted: str) -> Path | None:
    """The installed file that is meant by a name, or by the end of a path.

    As for `ros2 launch`, any file that is named is a launch file.
    """
    parts = Path(wanted).parts
    named = sorted(file for file in share.rglob("*") if file.name == Path(wanted).name)
    for file in (*find_launch_files(share), *named):
        if file.parts[-len(parts) :] == parts and file.is_file():
            return file
    return None


def no_such_launch_file(package: str, wanted: str, files: Sequence[Path]) -> RequestError:
    """The error for the name of a launch file that a package does not install."""
    names = [file.name for file in files]
    return RequestError(
        f"{package} does not install a launch file {wanted}.",
        hint=f"{ask_for_nearest(Path(wanted).name, names)}Installed: {', '.join(names) or 'none'}.",
    )


def packages_with(workspace: Workspace | None, name: str) -> list[str]:
    """The packages of a workspace whose source has a launch file of this name."""
    return [
        package.name
        for package in (() if workspace is None else find_packages(workspace))
        if any(file.name == name for file in find_launch_files(package.path))
    ]


def find_misnamed(folder: Path) -> tuple[Path, str] | None:
    """A file that is a launch file by its content and not by its name, and the name it should have.

    Editors and browsers append `.txt`; others leave out `launch`.
    """
    for file in sorted(folder.rglob("*")):
        name = file.name.removesuffix(".txt")
        is_python = name.endswith(".py") or (
            "launch" in name and not name.endswith((".xml", ".yaml", ".yml"))
        )
        if not is_python or not file.is_file() or _is_test(file, folder):
            continue
        if _holds(file, LAUNCH_FUNCTION):
            stem = name.removesuffix(".py").removesuffix(".launch")
            return file, name if name.endswith("launch.py") else f"{stem}.launch.py"
    return None


def list_launch_files(folder: Path) -> list[Path]:
    """The launch files below a folder that are not launch tests."""
    return [file for file in find_launch_files(folder) if not _is_test(file, folder)]


def _is_test(file: Path, folder: Path) -> bool:
    """Whether a file is run by `launch_test`, or lies where the tests of a package are."""
    if not TEST_FOLDERS.isdisjoint(file.relative_to(folder).parts[:-1]):
        return True
    return _holds(file, TEST_FUNCTION) and not _holds(file, LAUNCH_FUNCTION)


def _holds(file: Path, word: bytes) -> bool:
    """Whether a word is in a file, capitals or not; True where that cannot be known."""
    try:
        return word in read_whole(file).lower()
    except OSError:
        return True
