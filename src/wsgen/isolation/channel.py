"""A child process that answers commands until it is closed, or dies.

A command is a name with arguments, pickled because it is ours; an answer is JSON, because foreign
code runs where it is made. Both go through a socket of their own, so that nothing that the child
prints gets between them. A child that crashes, hangs or ends closes the socket: the caller gets a
`Died`, as from `parent.run`, and never waits for it.
"""

from __future__ import annotations

import json
import math
import os
import pickle
import socket
import struct
import subprocess
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING

from wsgen.isolation import parent, system
from wsgen.isolation.codec import encode
from wsgen.isolation.result import (
    DEFAULT_LIMITS,
    Answered,
    Died,
    Limits,
    conclude,
    read_death,
    read_lateness,
    read_tail,
)
from wsgen.isolation.system import open_parent_death_pipe
from wsgen.text.values import dataclass

try:
    import resource
except ImportError:  # on Windows
    resource = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path


LENGTH = struct.Struct("!Q")  # before each message, its bytes
TOKEN_BYTES = 32
SECONDS_TO_START = 60.0  # wall-clock, for a child to connect where it cannot inherit a socket
# The limit of CPU time is that of a command; a session may have any number of them.
ALL_COMMANDS = 7 * 24 * 3600.0  # s


@dataclass(frozen=True)
class Endpoint:
    """How the child finds its end of the channel."""

    descriptor: int | None = None  # inherited
    port: int = 0  # of the loopback interface, where nothing can be inherited
    token: bytes = b""  # what the child says first, so that nobody else is taken for it


class Channel:
    """The parent's end: starts a child, and has it perform commands.

    The task is a function that gets an `Endpoint` after the arguments, and calls `serve`. It is not
    for several threads at once.
    """

    def __init__(
        self,
        task: str,
        *arguments: object,
        memory: int = DEFAULT_LIMITS.memory,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
        is_forked: bool = False,
    ) -> None:
        """Start the child.

        With `is_forked` it is forked from this process, where that can be; see `forked`.

        Raises:
            NotReadableError: The folder or the memory for it is missing.
        """
        self._limits = Limits(seconds=ALL_COMMANDS, memory=memory)
        self._death: Died | None = None
        self._stack = ExitStack()
        try:
            self._scratch = self._stack.enter_context(parent.make_scratch())
            parent_death_pipe = self._stack.enter_context(open_parent_death_pipe())
            with ExitStack() as starting:
                listener, theirs, endpoint = _open(starting)
                self._child = _starter(is_forked=is_forked)(
                    parent.make_request(task, (*arguments, endpoint), self._limits, self._scratch),
                    parent_death_pipe=parent_death_pipe,
                    descriptors=() if theirs is None else (theirs.fileno(),),
                    environment=environment,
                    folder=folder,
                )
                self._stack.callback(parent.end, self._child)
                socket_ = listener if theirs is not None else self._accept(listener, endpoint)
                self._socket = self._stack.enter_context(socket_)
        except BaseException:
            self._stack.close()
            raise

    def call(
        self,
        name: str,
        *arguments: object,
        seconds: float = 60.0,
        wall_clock: float | None = None,
    ) -> Answered | Died:
        """Have the child perform a command.

        Args:
            name: Of one of the commands that the child serves.
            arguments: Of the command; they are pickled.
            seconds: The limit of its CPU time.
            wall_clock: That of wall-clock time, s; None: it follows from the other.
        """
        if self._death is not None:
            return self._death
        limits = Limits(seconds=seconds, wall_clock=wall_clock, memory=self._limits.memory)
        self._socket.settimeout(limits.wall_clock_seconds)
        try:
            _send(self._socket, pickle.dumps((name, arguments, seconds)))
            answer = json.loads(_receive(self._socket))
        except TimeoutError:
            parent.end(self._child)
            return self._die(read_lateness(self._scratch, limits))
        except BaseException as error:
            # The next answer would be taken for that of another command.
            if isinstance(error, OSError | EOFError):
                return self._die(self._conclude(limits))
            parent.end(self._child)
            if isinstance(error, ValueError):
                return self._die(self._death_of("answered what is not JSON"))
            self._die(self._death_of("was interrupted"))
            raise
        return Answered(value=answer, output=self.output())

    def output(self) -> str:
        """The end of what the child has printed."""
        return read_tail(self._scratch / "output")

    def end(self) -> None:
        """End the child while another thread waits for its answer, which then gets a `Died`."""
        parent.end(self._child)

    def close(self) -> None:
        """End the child and all that it started; may be called again."""
        if self._death is None:
            self._die(self._death_of("was closed"))
        self._stack.close()

    def _conclude(self, limits: Limits) -> Died:
        """How the child died that has closed its end."""
        with suppress(subprocess.TimeoutExpired):
            self._child.wait(parent.SECONDS_TO_END)
        parent.end(self._child)
        outcome = conclude(self._scratch, limits, returncode=self._child.returncode)
        if isinstance(outcome, Died):
            return outcome
        return self._death_of("ended before it answered")

    def _death_of(self, reason: str) -> Died:
        return read_death(self._scratch, reason)

    def _die(self, death: Died) -> Died:
        self._death = death
        return death

    def _accept(self, listener: socket.socket, endpoint: Endpoint) -> socket.socket:
        """The connection of the child; one without an end, if it does not connect."""
        import secrets  # noqa: PLC0415  takes as long as the rest of this module

        waited = 0.0
        listener.settimeout(0.1)
        while self._child.poll() is None and waited < SECONDS_TO_START:
            try:
                found, _ = listener.accept()
            except TimeoutError:
                waited += 0.1
                continue
            found.settimeout(SECONDS_TO_START)
            with suppress(OSError, EOFError):
                if secrets.compare_digest(_receive_exactly(found, TOKEN_BYTES), endpoint.token):
                    return found
            found.close()
        ours, theirs = socket.socketpair()
        theirs.close()
        return ours


def _starter(*, is_forked: bool) -> Callable[..., parent.Process]:
    """What starts a child."""
    if is_forked and system.can_fork():
        from wsgen.isolation.forked import fork_child  # noqa: PLC0415  only on Linux

        return fork_child
    return parent.start_interpreter


def _open(starting: ExitStack) -> tuple[socket.socket, socket.socket | None, Endpoint]:
    """Our end, that of the child if it inherits one, and how the child finds it.

    Without an end for the child ours waits for its connection.
    """
    if system.can_inherit():
        ours, theirs = socket.socketpair()
        starting.enter_context(theirs)  # only the child is to have it
        return ours, theirs, Endpoint(descriptor=theirs.fileno())
    listener = starting.enter_context(socket.create_server(("127.0.0.1", 0)))
    token = os.urandom(TOKEN_BYTES)
    return listener, None, Endpoint(port=listener.getsockname()[1], token=token)


def serve(endpoint: Endpoint, commands: Mapping[str, Callable[..., object]]) -> None:
    """In the child: perform the commands that come, until the parent closes its end.

    What a command raises ends the child, as it ends that of `parent.run`.
    """
    with _connect(endpoint) as connection:
        while True:
            try:
                name, arguments, seconds = pickle.loads(_receive(connection))  # noqa: S301  the parent wrote it
            except (EOFError, OSError):
                return
            _allow(seconds)
            _send(connection, encode(commands[name](*arguments)).encode())


def _connect(endpoint: Endpoint) -> socket.socket:
    if endpoint.descriptor is not None:
        return socket.socket(fileno=endpoint.descriptor)
    connection = socket.create_connection(("127.0.0.1", endpoint.port))
    connection.sendall(endpoint.token)
    return connection


def _allow(seconds: float) -> None:
    """Give the process so much more CPU time, where the system counts it."""
    if resource is None:
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    limit = math.ceil(used.ru_utime + used.ru_stime + seconds)
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    with suppress(ValueError, OSError):  # more than the hard limit
        resource.setrlimit(resource.RLIMIT_CPU, (limit, hard))


def _send(connection: socket.socket, message: bytes) -> None:
    connection.sendall(LENGTH.pack(len(message)) + message)


def _receive(connection: socket.socket) -> bytes:
    (length,) = LENGTH.unpack(_receive_exactly(connection, LENGTH.size))
    return _receive_exactly(connection, length)


def _receive_exactly(connection: socket.socket, count: int) -> bytes:
    """So many bytes; EOFError if the other end is closed before."""
    parts = bytearray()
    while len(parts) < count:
        part = connection.recv(min(count - len(parts), 1 << 20))
        if not part:
            raise EOFError
        parts += part
    return bytes(parts)
