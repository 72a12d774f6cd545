"""Processes that are forked from one that has imported wsgen, which saves starting interpreters.

A server, one for each process of the tests, forks them. It has one thread, as wsgen has; a process
of pytest-xdist has more, so that forking it is not safe. What is forked becomes a child of the
process of the tests, which waits for it and gets its exit code as for any other child.

Tests of what happens at the start of wsgen (imports, signals, streams) start it themselves.
"""

from __future__ import annotations

import atexit
import ctypes
import gc
import importlib
import os
import pickle
import signal
import socket
import subprocess
import sys
import threading
import traceback
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from wsgen.isolation import child, parent, system
from wsgen.launching.evaluate import FOREIGN
from wsgen.text.files import forget_remembered

if sys.platform == "linux":
    import fcntl

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.isolation.forked import ForkedProcess

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
MOST_BYTES = 2**17  # of an order; a socket takes at least so many
MOST_FILES = 16
STANDARD_ERROR = 2
# What commands import; each imports the rest late, if it needs it.
IMPORTED = (
    *(f"wsgen.cli.{name}" for name in ("new", "build", "check", "validate", "launch")),
    *("wsgen.cli.output", "wsgen.cli.check_output", "wsgen.cli.report_files"),
    *(f"wsgen.pipeline.{name}" for name in ("create", "check", "validate", "plan_launch")),
    *("wsgen.pipeline.candidates", "wsgen.pipeline.package_validation"),
    *("wsgen.pipeline.file_validation", "wsgen.pipeline.parallel", "wsgen.isolation.channel"),
)


class Server:
    """The side of the tests; `script` is what serves, with these options of the interpreter."""

    def __init__(self, script: Path, *options: str) -> None:
        self._lock = threading.Lock()
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, *options, str(script), str(theirs.fileno())],
                stdin=subprocess.DEVNULL,
                env=parent.complete(None),
                pass_fds=(theirs.fileno(),),
            )
        atexit.register(self.close)

    def fork(self, order: Mapping[str, Any], files: Sequence[int]) -> ForkedProcess:
        """Fork a child of this process, which gets these open files."""
        from wsgen.isolation.forked import ForkedProcess  # noqa: PLC0415  only on Linux

        with self._lock:
            _adopt_orphans(is_wanted=True)  # what forks the child ends at once
            try:
                socket.send_fds(self._socket, [pickle.dumps(order)], list(files))
                answer = self._socket.recv(64)
            finally:
                _adopt_orphans(is_wanted=False)
        return ForkedProcess(int(answer))

    def close(self) -> None:
        self._socket.close()
        self._process.wait()


@cache
def server() -> Server:
    return Server(Path(__file__))


@cache
def server_of_builds() -> Server:
    """What forks `wsgen build`, which forks colcon."""
    return Server(Path(__file__).with_name("forked_builds.py"))


def _adopt_orphans(*, is_wanted: bool) -> None:
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, int(is_wanted), 0, 0, 0)


def fork_child(
    request: dict[str, Any],
    *,
    parent_death_pipe: int,
    descriptors: tuple[int, ...] = (),
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> ForkedProcess:
    """What `wsgen.isolation.forked.fork_child` does, from the server."""
    files = (parent_death_pipe, *descriptors)
    order = {
        "request": request,
        "files": files,
        "environment": parent.complete(environment),
        "folder": str(Path.cwd() / (folder or "")),
    }
    return server().fork(order, files)


def run_wsgen(
    arguments: Sequence[str | bytes],
    *,
    cwd: Path,
    env: Mapping[str, str] | None = None,
    input: str | None = None,  # noqa: A002  as subprocess.run names it
    timeout: float | None = None,
    errors: str = "strict",
) -> subprocess.CompletedProcess[str]:
    """Run the command line; what `subprocess.run` does with `python -m wsgen`."""
    if not system.has_guards():
        return subprocess.run(
            [sys.executable, "-m", "wsgen", *arguments],
            cwd=cwd,
            env=env,
            input=input,
            stdin=subprocess.DEVNULL if input is None else None,
            capture_output=True,
            text=True,
            errors=errors,
            timeout=timeout,
            check=False,
        )
    with ExitStack() as stack:
        streams = [
            stack.enter_context(os.fdopen(os.memfd_create(name), "w+b"))
            for name in ("stdin", "stdout", "stderr")
        ]
        streams[0].write((input or "").encode())
        streams[0].seek(0)
        order = {
            "arguments": [os.fsdecode(one) for one in arguments],
            "environment": dict(os.environ if env is None else env),
            "folder": str(cwd),
        }
        from_server = server_of_builds() if "build" in arguments[:1] else server()
        process = from_server.fork(order, [stream.fileno() for stream in streams])
        try:
            code = process.wait(timeout)
        except BaseException:
            process.kill()
            raise
        for stream in streams:
            stream.seek(0)
        _, output, said = (stream.read().decode(errors=errors) for stream in streams)
    return subprocess.CompletedProcess(["wsgen", *arguments], code, output, said)


def serve(control: socket.socket, become: Callable[[dict[str, Any], list[int]], NoReturn]) -> None:
    """In the server: fork for each order what becomes its child, until the tests have ended."""
    while True:
        data, files, _, _ = socket.recv_fds(control, MOST_BYTES, MOST_FILES)
        if not data:
            return
        ours, theirs = os.pipe()
        between = os.fork()
        if between == 0:
            pid = os.fork()
            if pid == 0:
                become(pickle.loads(data), files)  # noqa: S301  the tests wrote it
            os.write(theirs, str(pid).encode())
            os._exit(0)
        os.waitpid(between, 0)
        os.close(theirs)
        control.send(os.read(ours, MOST_BYTES))  # empty where one could not be forked
        for file in (ours, *files):
            os.close(file)


def _become(order: dict[str, Any], files: list[int]) -> NoReturn:
    """Be the child of an order."""
    try:
        gc.freeze()
        numbers = order.get("files", (0, 1, 2))
        put_files(files, numbers)
        if "request" in order:
            from wsgen.isolation.forked import be_child  # noqa: PLC0415  only on Linux

            request = {**order["request"], "parent_death_pipe": numbers[0]}
            folder = Path(order["folder"])
            be_child(request, numbers[1:], order["environment"], folder, set())
        _run_command_line(order)
    except BaseException:  # noqa: BLE001  nothing may get back to the server
        traceback.print_exc()
    finally:
        os._exit(1)


def put_files(files: list[int], numbers: Sequence[int]) -> None:
    """Have the files at these numbers, and nothing but the streams at others."""
    first = max(*files, *numbers) + 1
    copies = [fcntl.fcntl(file, fcntl.F_DUPFD, first) for file in files]
    os.closerange(3, first)
    for copy, number in zip(copies, numbers, strict=True):
        os.dup2(copy, number, inheritable=number <= STANDARD_ERROR)
        os.close(copy)


def _run_command_line(order: dict[str, Any]) -> NoReturn:
    """Be `python -m wsgen` with these arguments, and end."""
    from wsgen import __main__ as program  # noqa: PLC0415  its import has no effect

    forget_remembered()
    child.set_environment(order["environment"])
    os.chdir(order["folder"])
    child.set_search_path([order["folder"], *sys.path])
    sys.path_importer_cache.clear()
    sys.argv[:] = [program.__file__, *order["arguments"]]
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115
    code: object = 0
    try:
        program.main()
    except SystemExit as end:
        code = end.code
    end_process(code)


def end_process(code: object) -> NoReturn:
    """Do what an interpreter does at its end, and end."""
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    assert isinstance(code, int)
    os._exit(code)


def main() -> None:
    """Serve, with what wsgen imports."""
    overlays = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:] = [entry for entry in sys.path[1:] if entry not in overlays]
    for name in IMPORTED:
        importlib.import_module(name)
    assert system.can_fork()
    assert FOREIGN.isdisjoint(sys.modules)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    serve(socket.socket(fileno=int(sys.argv[1])), _become)


if __name__ == "__main__":
    main()
