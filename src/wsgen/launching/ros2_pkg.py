"""What `ros2 pkg prefix` prints, for launch files that run it where no ROS is sourced."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from wsgen.launching.record import RECORD, callers

if TYPE_CHECKING:
    import subprocess

PREFIX = ["ros2", "pkg", "prefix"]


def is_run_in(source: object) -> bool:
    """Whether the text of a Python module may run it, which few do."""
    text = source.encode() if isinstance(source, str) else source
    return isinstance(text, bytes) and b"prefix" in text and b"ros2" in text


def answer() -> None:
    """Let `subprocess`, and with it `os.popen`, print what `ros2 pkg prefix` would.

    The package is looked up as `get_package_prefix()` looks it up, and reported as there.
    """
    import subprocess  # which takes milliseconds

    start = subprocess.Popen.__init__

    def run(process: subprocess.Popen[Any], args: Any, *more: Any, **options: Any) -> None:
        start(process, _answered(args), *more, **options)

    if not getattr(start, "is_answered", False):
        run.is_answered = True  # type: ignore[attr-defined]
        subprocess.Popen.__init__ = run  # type: ignore[assignment,method-assign]


def _answered(args: Any) -> Any:
    """The command to run instead; another one is left as it is."""
    import shlex
    import shutil

    try:
        words = shlex.split(args) if isinstance(args, str) else [os.fspath(one) for one in args]
    except (TypeError, ValueError):
        return args
    options = [word for word in words[len(PREFIX) :] if word.startswith("-")]
    names = [word for word in words[len(PREFIX) :] if not word.startswith("-")]
    if words[: len(PREFIX)] != PREFIX or len(names) != 1 or shutil.which(PREFIX[0]):
        return args
    from ament_index_python import packages

    before = RECORD.reading
    # Not the line of `os` or `subprocess`, which is none of the user's.
    RECORD.reading = next((one for one in callers() if one[0] in RECORD.launch_files), before)
    try:
        found = packages.get_package_prefix(names[0])
    except (KeyError, ValueError):
        said = ["sh", "-c", "echo 'Package not found' >&2; exit 1"]
    else:
        said = ["echo", os.path.join(found, "share", names[0]) if options else found]
    finally:
        RECORD.reading = before
    return shlex.join(said) if isinstance(args, str) else said
