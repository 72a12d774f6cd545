"""The server of a fork server: imports a module once and forks a child for every request.

It has one thread and never runs a task itself. The children come back from `serve` to the lines
that a freshly started child executes, and so end as that one does.
"""

from __future__ import annotations

import gc
import importlib
import os
import pickle
import selectors
import signal
import socket
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from wsgen.isolation.guard import adopt_orphans, end_guard, kill_children
from wsgen.isolation.parent_death import hold

PATH_BYTES = 4096  # no path is longer
BELL_BYTES = 4096  # one rings for each child that ended


def serve(orders: dict[str, Any]) -> dict[str, Any]:
    """Import the module, then serve until the fork server closes.

    Args:
        orders: `module`, that of the tasks; `control`, the descriptor of the socket from which the
            requests come; `parent-death pipe`, as `parent-death pipe.hold` takes it.

    Returns:
        In each forked child, its request. In the server it does not return.
    """
    hold(orders["parent_death_pipe"], signal.SIGKILL)
    adopt_orphans()
    # What is wrong with the module is told by each child, which imports it again.
    with suppress(Exception, SystemExit):
        importlib.import_module(orders["module"])
    sys.stdout.flush()
    sys.path_importer_cache.clear()  # a child would not see a folder that is made from now on
    gc.freeze()  # a child's collector would write to every object, and so copy its page
    request = Server(socket.socket(fileno=orders["control"])).serve()
    os.close(orders["parent_death_pipe"])  # the child has its own
    return request


class Server:
    """Waits for requests, for children that end, and for callers who no longer wait.

        A request is a message with the path of its scratch folder and two descriptors: a socket
    on which to report how the child ended, and the child's parent-death pipe. A caller who no
    longer waits closes that socket, for writing at least.
    """

    def __init__(self, control: socket.socket) -> None:
        self.control = control
        self.reports: dict[int, socket.socket] = {}  # by the child's process id
        self.bell, self.clapper = socket.socketpair()  # rung by SIGCHLD
        self.clapper.setblocking(False)
        self.selector = selectors.PollSelector()  # unlike epoll's it is not shared with children
        self.selector.register(control, selectors.EVENT_READ, self._take_request)
        self.selector.register(self.bell, selectors.EVENT_READ, self._reap)
        # A lock that another thread holds at the fork would stay locked in the child for ever.
        self.can_fork = len(list(Path("/proc/self/task").iterdir())) == 1

    def serve(self) -> dict[str, Any]:
        """Fork a child for every request; return in the child, with the request."""
        signal.set_wakeup_fd(self.clapper.fileno(), warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        while True:
            for key, _ in self.selector.select():
                request: dict[str, Any] | None = key.data()
                if request is not None:
                    return request

    def _take_request(self) -> dict[str, Any] | None:
        scratch, descriptors, _, _ = socket.recv_fds(
            self.control, PATH_BYTES, 2, socket.MSG_CMSG_CLOEXEC
        )
        if not scratch:
            sys.exit()  # the fork server is closed
        report, parent_death_pipe = socket.socket(fileno=descriptors[0]), descriptors[1]
        pid = self._fork(report)
        if pid == 0:
            return self._become_child(Path(os.fsdecode(scratch)), report, parent_death_pipe)
        os.close(parent_death_pipe)
        if pid is None:
            report.close()
        else:
            self.reports[pid] = report
            give_up = partial(self._give_up, pid, report)
            self.selector.register(report, selectors.EVENT_READ, give_up)
        return None

    def _fork(self, report: socket.socket) -> int | None:
        """Fork as `os.fork` does, or report why not."""
        if not self.can_fork:
            _tell(report, "threads")
            return None
        try:
            return os.fork()
        except OSError as error:
            _tell(report, f"refused {error.errno}")
            return None

    def _become_child(
        self, scratch: Path, report: socket.socket, parent_death_pipe: int
    ) -> dict[str, Any]:
        """Leave behind what is the server's, and take the place that the request names."""
        os.setsid()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for inherited in (self.control, self.bell, self.clapper, *self.reports.values()):
            inherited.close()
        try:
            request = _enter(scratch)
        except OSError as error:
            _tell(report, f"refused {error.errno}")
            os._exit(1)
        report.close()
        return {**request, "parent_death_pipe": parent_death_pipe}

    def _give_up(self, pid: int, report: socket.socket) -> None:
        """End a child that nobody waits for, if it has not just been reaped."""
        if self.reports.get(pid) is report:
            self.selector.unregister(report)
            end_guard(pid)

    def _reap(self) -> None:
        """Report the children that ended, after what they started has been ended, too."""
        self.bell.recv(BELL_BYTES)
        for pid, report in list(self.reports.items()):
            if os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                continue
            _, status = os.waitpid(pid, 0)
            code = os.waitstatus_to_exitcode(status)
            if code == -signal.SIGKILL:  # a guard that was killed leaves its own to the server
                kill_children(spared=self.reports)
            with suppress(KeyError):  # nobody waits for it
                self.selector.unregister(report)
            _tell(report, f"exit {code}")
            report.close()
            del self.reports[pid]


def _enter(scratch: Path) -> dict[str, Any]:
    """Read the request; take its output, environment and folder for this process's own."""
    output = os.open(scratch / "output", os.O_WRONLY | os.O_CREAT)
    os.dup2(output, sys.stdout.fileno())
    os.dup2(output, sys.stderr.fileno())
    os.close(output)
    with (scratch / "request").open("rb") as stream:
        request: dict[str, Any] = pickle.load(stream)  # noqa: S301  the parent wrote it
    _set_environment(request["environment"])
    os.chdir(request["folder"])
    return request


def _set_environment(variables: dict[str, str]) -> None:
    """Make them the environment; writing only what differs is ten times as fast."""
    for name in os.environ.keys() - variables.keys():
        del os.environ[name]
    for name, value in variables.items():
        if os.environ.get(name) != value:
            os.environ[name] = value


def _tell(report: socket.socket, message: str) -> None:
    with suppress(OSError):  # nobody waits for it
        report.send(message.encode())
