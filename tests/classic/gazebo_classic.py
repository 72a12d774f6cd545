"""Gazebo Classic itself as an oracle: Debian 11's, in a folder that `.ci/gazebo-classic` fills.

A program that we write (`driver.cc`) has the server's own libraries do what it reads from a pipe.
It runs in the folder as its root, in a network and with mounts of its own.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import pytest

from made_once import wait_for_unpacking

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from typing_extensions import Self

ROOT = Path(os.environ.get("WSGEN_TEST_GAZEBO_CLASSIC", "/nowhere"))
SOURCE = Path(__file__).with_name("driver.cc")
HOST = "/host"  # where the files of this machine are, seen from inside
MODELS = "/usr/share/gazebo-11/models"
# `$0` is the root; the rest is the command. /tmp has logs, which nobody reads.
ENTER = """set -e
mount --rbind / "$0/host"
mount --rbind /dev "$0/dev"
mount -t proc proc "$0/proc"
mount -t tmpfs tmpfs "$0/tmp"
exec chroot "$0" "$@"
"""
# Cameras draw on a display, of this network alone; it ends with the server.
DISPLAY = """setpriv --pdeathsig KILL Xvfb :0 -screen 0 64x64x24 -nolisten tcp >&2 &
until [ -e /tmp/.X11-unix/X0 ]; do sleep 0.1; done
export DISPLAY=:0 LP_NUM_THREADS=1
exec "$@"
"""
VARIABLES = {
    "HOME": "/tmp",
    "PATH": "/usr/sbin:/usr/bin:/sbin:/bin",
    "LC_ALL": "C.UTF-8",
    "GAZEBO_MASTER_URI": "http://127.0.0.1:11345",
    "GAZEBO_IP": "127.0.0.1",
    "IGN_IP": "127.0.0.1",
    "GAZEBO_MODEL_DATABASE_URI": "",
    "GAZEBO_RESOURCE_PATH": "/usr/share/gazebo-11",
    "GAZEBO_PLUGIN_PATH": "/usr/lib/x86_64-linux-gnu/gazebo-11/plugins",
    "OGRE_RESOURCE_PATH": "/usr/lib/x86_64-linux-gnu/OGRE-1.9.0",
}
SECONDS = 600.0  # CPU time of one server
NEEDS_CLASSIC = pytest.mark.usefixtures("gazebo_classic")


def why_missing() -> str:
    """Why Gazebo Classic cannot be asked here, once `.ci/run` has unpacked it; empty if it can."""
    wait_for_unpacking(ROOT)
    if not (ROOT / ".unpacked").exists():
        return "needs the folder that .ci/gazebo-classic fills, as WSGEN_TEST_GAZEBO_CLASSIC"
    if os.geteuid() != 0 or shutil.which("unshare") is None:
        return "needs root and `unshare`, for a root folder of its own"
    return ""


class EndedError(Exception):
    """The server ended by itself, which it does by a crash: what it printed last."""


class GazeboClassic:
    """A server with one world.

    Args:
        world: The file of the world; what it says of `model://` is looked for in `models`, too.
        models: Folders with models.
        has_display: For cameras.
    """

    def __init__(
        self, world: Path, models: tuple[Path, ...] = (), *, has_display: bool = False
    ) -> None:
        path = ":".join((*(inside(folder) for folder in models), MODELS))
        variables = {**VARIABLES, "GAZEBO_MODEL_PATH": path}
        command = ["prlimit", f"--cpu={SECONDS:.0f}", _program()]
        if has_display:
            command = ["sh", "-c", DISPLAY, "sh", *command]
        self._log = tempfile.TemporaryFile()  # noqa: SIM115  closed with the server
        self._server = _start(command, variables, self._log)
        self.ask("world", inside(world))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._server.kill()
        self._server.communicate()
        self._log.close()

    def ask(self, *words: object) -> dict[str, Any]:
        """What the program answers to a line.

        Raises:
            EndedError: the server crashed.
            ValueError: it refuses what it is given.
        """
        assert self._server.stdin is not None
        assert self._server.stdout is not None
        line = ""
        try:
            self._server.stdin.write(" ".join(map(str, words)) + "\n")
            self._server.stdin.flush()
            line = self._server.stdout.readline()
        except BrokenPipeError:
            pass
        if not line:
            code = self._server.wait()
            raise EndedError(f"{words[0]}: exit code {code}\n{self.printed[-2000:]}")
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise ValueError(f"{answer['error']}\n{self.printed[-2000:]}")
        return answer

    def spawn(
        self, file: Path, name: str, *, z: float = 0.0, rpy: tuple[float, ...] = (0, 0, 0)
    ) -> None:
        """Put a URDF or SDF model into the world, at z above its origin."""
        self.ask("spawn", inside(file), name, 0, 0, z, *rpy)

    def run(self, seconds: float, *, step: float = 0.001) -> None:
        """Let the simulated time go on."""
        self.ask("step", round(seconds / step))

    def state(self) -> dict[str, Any]:
        """What the world holds: see `driver.cc`."""
        models: dict[str, Any] = self.ask("state")["models"]
        return models

    @property
    def printed(self) -> str:
        """What the server has said so far."""
        self._log.seek(0)
        return self._log.read().decode(errors="replace")


def recorded_in(
    file: Path, request: pytest.FixtureRequest, names: Iterable[str], ask: Callable[[str], Any]
) -> Any:
    """The answers of Gazebo Classic that a file has, by name; None is no answer.

    They are asked for anew with `--regenerate`, where it can be asked.
    """
    if request.config.getoption("--regenerate") and not why_missing():
        answers = ((name, ask(name)) for name in names)
        lines = [
            f"{json.dumps(name)}: {json.dumps(one)}" for name, one in answers if one is not None
        ]
        file.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return json.loads(file.read_text(encoding="utf-8"))


def inside(path: Path) -> str:
    """A path of this machine as the server sees it."""
    return f"{HOST}{path.absolute()}"


def _start(
    command: list[str], variables: Mapping[str, str], errors: IO[bytes] | int
) -> subprocess.Popen[str]:
    return subprocess.Popen(
        ["unshare", "--mount", "--net", "sh", "-c", ENTER, str(ROOT), *command],
        env=dict(variables),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=errors,
        text=True,
        errors="replace",
    )


def _program() -> str:
    """The driver as the server's root sees it, compiled once for each of its versions: 15 s."""
    digest = hashlib.sha256(SOURCE.read_bytes()).hexdigest()[:16]
    program = ROOT / "opt" / f"driver-{digest}"
    if not program.exists():
        own = f"{program.name}.{os.getpid()}"
        source = inside(SOURCE)
        line = f"g++ -std=c++17 -O1 -w {source} -o /opt/{own} $(pkg-config --cflags --libs gazebo)"
        compiler = _start(["sh", "-c", line], VARIABLES, subprocess.STDOUT)
        printed, _ = compiler.communicate()
        assert compiler.returncode == 0, printed
        (ROOT / "opt" / own).rename(program)
    return f"/opt/{program.name}"
