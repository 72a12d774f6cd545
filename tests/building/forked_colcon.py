"""Processes of colcon that are forked from one that has imported what colcon imports.

colcon takes half a second to start, as long as it takes to configure a small package. What reads
the environment while it is imported, the forked process imports itself. Tests of signals and of
plain colcon start colcon as wsgen and users do.
"""

from __future__ import annotations

import functools
import gc
import importlib
import os
import runpy
import signal
import socket
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import IO, TYPE_CHECKING, Any, NoReturn

if __name__ == "__main__":  # isolated, as the child
    sys.path.append(str(Path(__file__).parents[1]))

from forks import Server, put_files, serve

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.isolation.forked import ForkedProcess

# Libraries, and none of colcon's own modules: some of these look for programs, or read variables.
IMPORTED = (
    *("setuptools", "pkg_resources", "catkin_pkg.package", "distlib.scripts", "distlib.util"),
    *("asyncio", "yaml", "em", "packaging.version", "logging.handlers", "xml.dom.minidom"),
    *("argparse", "unittest", "http.client", "xmlrpc.client"),
)


def import_libraries() -> None:
    for name in IMPORTED:
        importlib.import_module(name)
    assert not any(name.startswith("colcon") for name in sys.modules)


@functools.cache
def _server() -> Server:
    return Server(Path(__file__), "-I")


class ForkedColcon:
    """What `wsgen.building.colcon` uses of `subprocess.Popen`."""

    def __init__(
        self,
        command: Sequence[str],
        *,
        stdin: int,
        stdout: int,
        stderr: IO[bytes],
        cwd: Path,
        env: Mapping[str, str],
        start_new_session: bool,
    ) -> None:
        python, isolated, *words = command
        assert (python, isolated, stdout) == (sys.executable, "-I", subprocess.PIPE)
        assert start_new_session
        os.scandir(cwd).close()  # the error that Popen raises
        ours, theirs = os.pipe()
        order = {"words": words, "environment": dict(env), "folder": str(cwd)}
        try:
            self._process = self._fork(order, [stdin, theirs, stderr.fileno()])
        finally:
            os.close(theirs)
        self.pid = self._process.pid
        self.stdout = os.fdopen(ours, "rb")

    @staticmethod
    def _fork(order: dict[str, Any], files: list[int]) -> ForkedProcess:
        return _server().fork(order, files)

    @property
    def returncode(self) -> int | None:
        return self._process.returncode

    def wait(self, timeout: float | None = None) -> int:
        return self._process.wait(timeout)

    def __enter__(self) -> None:
        """`run_colcon` has its name already."""

    def __exit__(self, *_: object) -> None:
        self.stdout.close()
        self.wait()


SUBPROCESS = SimpleNamespace(
    Popen=ForkedColcon, PIPE=subprocess.PIPE, TimeoutExpired=subprocess.TimeoutExpired
)


def become(order: dict[str, Any], files: list[int]) -> NoReturn:
    """Be the interpreter that runs the script of the child."""
    gc.freeze()
    os.setsid()
    put_files(files, (0, 1, 2))
    os.environ.clear()
    os.environ.update(order["environment"])
    os.chdir(order["folder"])
    sys.path_importer_cache.clear()
    sys.argv[:] = order["words"]
    runpy.run_path(sys.argv[0], run_name="__main__")
    raise SystemExit  # the script has raised it before


if __name__ == "__main__":
    sys.path.pop()
    import_libraries()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    serve(socket.socket(fileno=int(sys.argv[1])), become)
