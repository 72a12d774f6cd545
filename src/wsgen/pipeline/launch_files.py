"""Which launch files a package has."""

from __future__ import annotations

from pathlib import Path

# How `ros2 launch` recognises launch files.
PATTERNS = ("*launch.py", "*launch.xml", "*launch.yaml", "*launch.yml")

# One of these words is in every launch file that puts a robot into a simulator by itself.
SPAWNING_WORDS = (b"spawn", b"create")


def find_launch_files(folder: Path) -> tuple[Path, ...]:
    """The launch files below a folder, by path."""
    found = {file for pattern in PATTERNS for file in folder.rglob(pattern) if file.is_file()}
    return tuple(sorted(found))


def name_launch_file(files: tuple[Path, ...], wanted: str) -> Path | None:
    """The file that is meant by a name, or by the end of a path."""
    parts = Path(wanted).parts
    for file in files:
        if file.parts[-len(parts) :] == parts:
            return file
    return None


def may_spawn(file: Path) -> bool:
    """Whether a launch file looks as if it spawned a robot; one that cannot be read does."""
    try:
        text = file.read_bytes().lower()
    except OSError:
        return True
    return any(word in text for word in SPAWNING_WORDS)
