"""Which launch files a package has."""

from __future__ import annotations

from pathlib import Path

from wsgen.workspace.layout import find_launch_files

__all__ = ["find_launch_files", "may_spawn", "name_launch_file"]

# One of these words is in every launch file that puts a robot into a simulator by itself.
SPAWNING_WORDS = (b"spawn", b"create")
LAUNCH_FUNCTION = b"def generate_launch_description("


def name_launch_file(share: Path, wanted: str) -> Path | None:
    """The installed file that is meant by a name, or by the end of a path.

    As for `ros2 launch`, a file that is named is one, however it is called.
    """
    parts = Path(wanted).parts
    named = sorted(file for file in share.rglob("*") if file.name == Path(wanted).name)
    for file in (*find_launch_files(share), *named):
        if file.parts[-len(parts) :] == parts and file.is_file():
            return file
    return None


def find_misnamed(folder: Path) -> tuple[Path, str] | None:
    """A file that is a launch file by its content and not by its name, and the name it should have.

    Editors and browsers append `.txt`; others leave out `launch`.
    """
    for file in sorted(folder.rglob("*")):
        name = file.name.removesuffix(".txt")
        is_python = name.endswith(".py") or (
            "launch" in name and not name.endswith((".xml", ".yaml", ".yml"))
        )
        if is_python and file.is_file() and _holds(file, LAUNCH_FUNCTION):
            stem = name.removesuffix(".py").removesuffix(".launch")
            return file, name if name.endswith("launch.py") else f"{stem}.launch.py"
    return None


def may_spawn(file: Path) -> bool:
    """Whether a launch file looks as if it spawned a robot; one that cannot be read does."""
    return any(_holds(file, word) for word in SPAWNING_WORDS)


def _holds(file: Path, word: bytes) -> bool:
    """Whether a word is in a file, capitals or not; True where that cannot be known."""
    try:
        return word in file.read_bytes().lower()
    except OSError:
        return True
