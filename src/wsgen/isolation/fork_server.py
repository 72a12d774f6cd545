"""Run many functions in child processes that are forked from one interpreter.

Starting an interpreter and importing a physics engine takes longer than most robots need to come
to rest. A fork server does it once for each module, in a server process that does nothing else
(`fork_server_process`), and every task runs in a child that is forked from there.

It works on Linux only: Windows cannot fork, and on macOS the system's libraries may crash in a
forked child. There, and where a module starts threads when it is imported, every task starts its
own interpreter.
"""

from __future__ import annotations

import contextlib
import os
import socket
import threading
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.isolation import parent, system
from wsgen.isolation.result import (
    DEFAULT_LIMITS,
    Answered,
    Died,
    Limits,
    conclude,
    describe_exit,
    read_death,
    read_lateness,
    read_tail,
)
from wsgen.isolation.system import open_parent_death_pipe

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Mapping
    from types import TracebackType


MESSAGE_BYTES = 64  # a report is a word and a number


class ForkServer(contextlib.AbstractContextManager["ForkServer"]):
    """A context manager whose `run` does what `parent.run` does, faster.

    The first task of a module starts the server of this module, which imports it with the
    environment of this process. Every child starts from the state after this import, without that
    of other tasks. Variables that the interpreter and the dynamic loader read at their start
    (`LC_ALL`, `LD_LIBRARY_PATH`) are those of this process for every child, whatever environment
    it gets. Threads may share a fork server. Leaving the context ends the servers, and all calls
    that still wait.
    """

    def __init__(self) -> None:
        self._servers: dict[str, _Server] = {}
        # Children with their own interpreters, by the threads that wait for them.
        self._alone: dict[int, subprocess.Popen[bytes]] = {}
        self._lock = threading.Lock()
        self._is_closed = False

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        with self._lock:
            self._is_closed = True
            for server in self._servers.values():
                server.close()
            for child in self._alone.values():
                parent.end(child)

    def run(
        self,
        task: str,
        *arguments: object,
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call `module:function` with the arguments in a child; see `parent.run`.

        When the server itself is killed, the calls that wait for its children report them as lost,
        and the next call starts another server.

        Raises:
            NotReadableError: The folder or the memory for the child is missing.
            RuntimeError: The fork server is closed.
        """
        outcome = None
        if system.has_guards():
            outcome = self._run_forked(task, arguments, limits, environment, folder)
        if outcome is not None:
            return outcome
        try:
            return parent.run(
                task,
                *arguments,
                limits=limits,
                environment=environment,
                folder=folder,
                on_start=self._remember,
            )
        finally:
            with self._lock:
                self._alone.pop(threading.get_ident(), None)

    def _run_forked(
        self,
        task: str,
        arguments: tuple[object, ...],
        limits: Limits,
        environment: Mapping[str, str] | None,
        folder: Path | None,
    ) -> Answered | Died | None:
        """Run the task like `run`; return None if it has to start its own interpreter."""
        with parent.make_scratch() as scratch, open_parent_death_pipe() as parent_death_pipe:
            request = {
                **parent.make_request(task, arguments, limits, scratch),
                "environment": parent.complete(environment),
                "folder": str(Path.cwd() / (folder or "")),
            }
            parent.write_request(request)
            with self._lock:
                server = self._server_of(task.partition(":")[0])
                report = server.send(scratch, parent_death_pipe)
            message = _wait(report, limits.wall_clock_seconds)
            if message is None:
                return read_lateness(scratch, limits)
            if not message:
                return self._report_lost_children(server, scratch)
            return _conclude(message, scratch, limits)

    def _server_of(self, module: str) -> _Server:
        self._refuse_closed()
        server = self._servers.get(module)
        if server is None or not server.is_alive():
            if server is not None:
                server.close()
            server = self._servers[module] = _Server(module)
        return server

    def _remember(self, child: subprocess.Popen[bytes]) -> None:
        with self._lock:
            self._refuse_closed()
            self._alone[threading.get_ident()] = child

    def _refuse_closed(self) -> None:
        if self._is_closed:
            raise RuntimeError("The fork server is closed.")

    def _report_lost_children(self, server: _Server, scratch: Path) -> Died:
        """Report that a child was lost with its server."""
        with self._lock:
            server.close()
        how = describe_exit(server.process.returncode)
        death = read_death(scratch, f"was lost with the process that had started it, which {how}")
        return death if death.output else replace(death, output=server.last_output)


class _Server:
    """The parent's side of a server."""

    def __init__(self, module: str) -> None:
        self.last_output = ""
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with contextlib.ExitStack() as stack, theirs:
            scratch = stack.enter_context(parent.make_scratch())
            stack.enter_context(self._control)
            parent_death_pipe = stack.enter_context(open_parent_death_pipe())
            self._output = scratch / "output"
            self.process = parent.start_interpreter(
                {
                    "path": parent.search_path(),
                    "module": module,
                    "control": theirs.fileno(),
                    "scratch": str(scratch),
                },
                parent_death_pipe=parent_death_pipe,
                descriptors=(theirs.fileno(),),
            )
            stack.callback(self._end)
            self._stack = stack.pop_all()

    def is_alive(self) -> bool:
        """Whether the server's process has not ended."""
        return self.process.poll() is None

    def send(self, scratch: Path, parent_death_pipe: int) -> socket.socket:
        """Request a child; return the socket for the report of its end."""
        report, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        # A server that has just died closes the socket without a report.
        with theirs, contextlib.suppress(ConnectionError):
            socket.send_fds(
                self._control, [os.fsencode(scratch)], [theirs.fileno(), parent_death_pipe]
            )
        return report

    def close(self) -> None:
        """End the server; may be called again."""
        self._stack.close()

    def _end(self) -> None:
        self.process.kill()
        self.process.wait()
        self.last_output = read_tail(self._output)


def _wait(report: socket.socket, seconds: float) -> str | None:
    """Return the report of the child's end; empty if its server died, None after the limit."""
    with report:
        report.settimeout(seconds)
        try:
            return report.recv(MESSAGE_BYTES).decode()
        except TimeoutError:
            return None
        finally:
            # The server ends what is left of the child, then closes its end.
            report.shutdown(socket.SHUT_WR)
            report.settimeout(parent.SECONDS_TO_END)
            with contextlib.suppress(TimeoutError):
                while report.recv(MESSAGE_BYTES):
                    pass


def _conclude(message: str, scratch: Path, limits: Limits) -> Answered | Died | None:
    word, _, number = message.partition(" ")
    if word == "exit":
        return conclude(scratch, limits, returncode=int(number))
    if word == "refused":
        raise parent.not_started(OSError(int(number), os.strerror(int(number))))
    return None  # the server has threads and cannot fork
