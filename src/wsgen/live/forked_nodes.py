"""Programs of wsgen in a live run, forked from one process that has imported what they use.

`wsgen.live.nodes.node_server` is that process. Where it cannot serve, a program gets an interpreter
of its own: each is a process with a session, signals and an exit code either way.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.ros.environment.processes import module_command

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.live.request import NodeServerRequest

MODULE = "wsgen.live.nodes.node_server"
ROOM = 4096  # characters, for what `ps` shows of a program
LARGEST = 1 << 12  # bytes of an answer
SECONDS_TO_START = 20.0  # wall-clock, for its imports on a busy machine
# Variables that the interpreter, the loader and libraries read when they start.
PATHS = ("LD_LIBRARY_PATH", "PYTHONPATH")
AT_START = ("LD_", "PYTHON", "LC_", "MALLOC_", "OMP_", "OPENBLAS_", "GLIBC_", "ASAN_", "LTTNG_")
AT_START_ALONE = ("LANG", "LANGUAGE", "HOME")
# One thread computes: more would be started by every program, and wait.
OWN = {"PYTHONUNBUFFERED": "1", "PYTHONSAFEPATH": "1", "OPENBLAS_NUM_THREADS": "1"}


class ForkedNode:
    """A program that was forked, with what is used of `subprocess.Popen`."""

    def __init__(self, server: NodeServer, pid: int, stdin: int) -> None:
        self.pid = pid
        self.returncode: int | None = None  # negative for the signal that ended it
        self.stdin = os.fdopen(stdin, "wb", buffering=0)
        self._server = server

    def poll(self) -> int | None:
        """Its exit code; None while it runs."""
        if self.returncode is None:
            self._server.take()
        return self.returncode


class NodeServer:
    """The process that programs are forked from."""

    def __init__(self, request: NodeServerRequest) -> None:
        self._request = request
        self._environment = {**request.environment, **OWN, **request.paths}
        self._nodes: dict[int, ForkedNode] = {}  # that run
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        words = (str(theirs.fileno()), request.engine, " " * ROOM)
        try:
            self._process: subprocess.Popen[bytes] | None = subprocess.Popen(
                module_command(request.python, MODULE, *words),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=self._environment,
                pass_fds=(theirs.fileno(),),
            )
        except OSError:
            self._process = None
        finally:
            theirs.close()

    @property
    def descriptor(self) -> int | None:
        """It can be read when a program has ended; None when the server has, and at its end."""
        return None if self._process is None else self._control.fileno()

    def start(  # noqa: PLR0913  what a process has
        self,
        module: str,
        words: Sequence[str],
        *,
        title: Sequence[str],
        environment: Mapping[str, str],
        folder: str | None,
        outputs: Sequence[int],
    ) -> ForkedNode | None:
        """Fork a program; None where it must be started in another way.

        Args:
            module: Its `main()` is called.
            words: Its arguments.
            title: The command line that `ps` shows.
            environment: All of its variables.
            folder: It runs there; None: where this process does.
            outputs: Descriptors for its output and its errors.
        """
        where = Path(folder) if folder else Path.cwd()
        if self._process is None or not self.can_have(environment) or not where.is_dir():
            return None
        request = {
            "module": module,
            "words": list(words),
            "title": list(title),
            "environment": dict(environment),
            "folder": str(where),
        }
        with os.fdopen(os.memfd_create("request"), "wb", buffering=0) as file:
            file.write(json.dumps(request).encode())
            theirs, ours = os.pipe()
            try:
                sent = [file.fileno(), theirs, *outputs]
                socket.send_fds(self._control, [b"start"], sent)
                pid = self._started()
            except OSError:
                self._lose()
                pid = None
            finally:
                os.close(theirs)
        if pid is None:
            os.close(ours)
            return None
        node = self._nodes[pid] = ForkedNode(self, pid, ours)
        return node

    def can_have(self, environment: Mapping[str, str]) -> bool:
        """Whether a program with these variables is as if an interpreter were started with them."""
        own = self._request.environment
        for name in PATHS:
            base, wanted = _entries(own.get(name, "")), _entries(environment.get(name, ""))
            known = {*_entries(self._environment.get(name, ""))}
            if [entry for entry in wanted if entry in base] != base or not known.issuperset(wanted):
                return False
        return all(
            environment.get(name) == own.get(name)
            for name in {*environment, *own}
            if (name.startswith(AT_START) or name in AT_START_ALONE) and name not in {*PATHS, *OWN}
        )

    def take(self) -> None:
        """Take notice of programs that have ended."""
        while self._process is not None:
            try:
                answer = self._control.recv(LARGEST, socket.MSG_DONTWAIT)
            except BlockingIOError:
                return
            except OSError:
                answer = b""
            if not answer:
                self._lose()
                return
            self._heed(answer.decode().split())

    def _started(self) -> int | None:
        """The process id of the program that was asked for; None where it is refused.

        Raises:
            OSError: The server does not answer.
        """
        while True:
            self._control.settimeout(SECONDS_TO_START)
            words = self._control.recv(LARGEST).decode().split()
            self._control.settimeout(None)  # with one, `take` would wait for it
            if not words:
                raise ConnectionResetError
            if words[0] == "started":
                return int(words[1])
            if words[0] == "refused":
                return None
            self._heed(words)

    def _heed(self, words: Sequence[str]) -> None:
        """A program has ended."""
        if words[0] == "ended" and (node := self._nodes.pop(int(words[1]), None)):
            node.returncode = int(words[2])

    def _lose(self) -> None:
        """The server has ended or does not answer; what it has forked ends with it."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for node in self._nodes.values():
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(node.pid, signal.SIGKILL)
            node.returncode = -signal.SIGKILL
        self._nodes.clear()


def _entries(path: str) -> list[str]:
    return [entry for entry in path.split(os.pathsep) if entry]
