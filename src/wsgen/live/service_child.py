"""Start the process of the launch service, give it its commands, and leave nothing behind."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.isolation import parent
from wsgen.isolation.codec import encode
from wsgen.isolation.guard import adopt_orphans, kill_children
from wsgen.isolation.system import open_parent_death_pipe
from wsgen.live.request import GO, INTERRUPT, NODES, NODES_FILE, TERMINATE
from wsgen.live.resources import remove_left_behind
from wsgen.simulation.live_runs import FOLDER_VARIABLE, REQUEST_FILE
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from wsgen.live.request import NodeServerRequest, ServiceRequest

SERVICE_PROCESS = str(Path(__file__).with_name("service_process.py"))
SECONDS_TO_END = 5.0  # for what a guard that was killed has left behind


class ServiceChild:
    """The running launch service."""

    def __init__(
        self, guard: subprocess.Popen[bytes], control: socket.socket, folder: Path
    ) -> None:
        self._guard = guard
        self._control = control
        self._folder = folder

    def prepare_nodes(self, request: NodeServerRequest) -> None:
        """Let it start what programs of wsgen are forked from, before all else is known."""
        write_file(self._folder / NODES_FILE, encode(request))
        self._notify(NODES)

    def go(self, request: ServiceRequest) -> None:
        """Let it play a launch: all else that it needs is in the folder."""
        write_file(self._folder / REQUEST_FILE, encode(request))
        self._notify(GO)

    def interrupt(self) -> None:
        """Report to it that the user has pressed Ctrl-C."""
        self._notify(INTERRUPT)

    def terminate(self) -> None:
        """Have it end."""
        self._notify(TERMINATE)

    def wait(self) -> int:
        """Wait for its end, and hand on the signals to this process; gives its exit code.

        That of a service that a signal has ended is minus the number of the signal.
        """
        with self._handing_on():
            return self._guard.wait()

    @property
    def code(self) -> int | None:
        """Its exit code, as `wait` gives it; None while it runs."""
        return self._guard.poll()

    def wait_for(self, seconds: float) -> bool:
        """Wait for its end, so long at most; gives whether it has ended."""
        try:
            self._guard.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def end(self) -> None:
        """End it with all that it has started."""
        parent.end(self._guard)
        self._control.close()

    def _notify(self, word: bytes) -> None:
        with contextlib.suppress(OSError):  # it has ended
            self._control.send(word)

    @contextlib.contextmanager
    def _handing_on(self) -> Iterator[None]:
        notify: dict[int, Callable[[], None]] = {
            signal.SIGINT: self.interrupt,
            signal.SIGTERM: self.terminate,
            signal.SIGHUP: self.terminate,
        }
        before = {}
        for number, one in notify.items():
            if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup has it for SIGHUP
                before[number] = signal.signal(number, lambda *_, one=one: one())
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


@contextlib.contextmanager
def start_service(
    folder: Path,
    environment: Mapping[str, str],
    *,
    errors: int | None = None,
    held: Sequence[int] = (),
    adopts: bool = True,
) -> Iterator[ServiceChild]:
    """Start the service; all that it has started ends with the context.

    Args:
        folder: Of the live run.
        environment: That the launch file is evaluated in.
        errors: A descriptor for what it prints on stderr, and what it prints on stdout is thrown
            away; None: those of this process.
        held: Descriptors that stay open until all that it has started has ended.
        adopts: Whether this process has no other children, and may become the parent of those that
            a guard leaves behind when it is killed. If not, they are found by their environment.

    Raises:
        NotReadableError: The folder or the memory for it is missing.
    """
    begun = time.time()
    if adopts:
        adopt_orphans()  # what a guard that was killed leaves behind comes to this process
    ours, theirs = socket.socketpair()
    with open_parent_death_pipe() as pipe:
        try:
            guard = subprocess.Popen(
                [
                    sys.executable,
                    "-I",
                    SERVICE_PROCESS,
                    str(folder),
                    str(theirs.fileno()),
                    os.pathsep.join(parent.search_path()),
                ],
                stdin=pipe,
                stdout=None if errors is None else subprocess.DEVNULL,
                stderr=errors,
                pass_fds=(theirs.fileno(), *held),
                env=dict(environment),
                # Ctrl-C is for this process, which hands it on.
                start_new_session=True,
            )
        except OSError as error:
            ours.close()
            raise parent.not_started(error) from error
        finally:
            theirs.close()
        child = ServiceChild(guard, ours, folder)
        try:
            yield child
        finally:
            child.end()
            if guard.returncode < 0:  # somebody has killed it
                if adopts:
                    _end_orphans()
                else:
                    _end_processes_of(folder)
                remove_left_behind(begun)


def _end_processes_of(folder: Path) -> None:
    """End the processes of a live run whose guard was killed: all have its folder in a variable."""
    mark = b"\0" + f"{FOLDER_VARIABLE}={folder}".encode() + b"\0"
    for process in Path("/proc").iterdir():
        with contextlib.suppress(OSError):  # it has ended, or is of somebody else
            if process.name.isdecimal() and mark in b"\0" + (process / "environ").read_bytes():
                os.kill(int(process.name), signal.SIGKILL)


def _end_orphans() -> None:
    """End what a guard has left that was killed."""
    end = time.monotonic() + SECONDS_TO_END
    while time.monotonic() < end:
        try:
            reaped, _ = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return
        if reaped == 0:
            kill_children()
            time.sleep(0.01)
