"""The server process of a fork server: it imports a module and forks a child for every request.

It has one thread and never runs a task itself. In the children `serve` returns to the lines that a
newly started child executes, so both behave alike.
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

from wsgen.isolation.child import set_environment
from wsgen.isolation.guard import adopt_orphans, end_guard, kill_children
from wsgen.isolation.system import end_with_parent

PATH_BYTES = 4096  # no path is longer
WAKEUP_BYTES = 4096  # one byte for each child that ended


def serve(orders: dict[str, Any]) -> dict[str, Any]:
    """Import the module, then serve until the fork server closes.

    Args:
        orders: `module` of the tasks, whose `warm_up()` is called if it has one; `control`, the
            descriptor of the socket for requests; `parent_death_pipe`, for `end_with_parent`.

    Returns:
        In each forked child, its request. In the server it does not return.
    """
    end_with_parent(orders["parent_death_pipe"], signal.SIGKILL)
    adopt_orphans()
    # Each child imports the module again, and reports if that fails.
    with suppress(Exception, SystemExit):
        module = importlib.import_module(orders["module"])
        getattr(module, "warm_up", lambda: None)()
    sys.stdout.flush()
    sys.path_importer_cache.clear()  # otherwise a child does not see newer folders
    gc.freeze()  # otherwise a child's collector writes to every object, which copies its page
    request = Server(socket.socket(fileno=orders["control"])).serve()
    os.close(orders["parent_death_pipe"])  # the child has its own
    return request


class Server:
    """Waits for requests, for children that end, and for callers that stop waiting.

    A request is a message with the path of its scratch folder and two descriptors: a socket for
    the report of the child's end, and the child's parent-death pipe. A caller that stops waiting
    closes this socket, at least for writing.
    """

    def __init__(self, control: socket.socket) -> None:
        self.control = control
        self.reports: dict[int, socket.socket] = {}  # by the child's process id
        self.wakeup, self.wakeup_writer = socket.socketpair()  # SIGCHLD writes a byte
        self.wakeup_writer.setblocking(False)
        self.selector = selectors.PollSelector()  # unlike epoll's it is not shared with children
        self.selector.register(control, selectors.EVENT_READ, self._take_request)
        self.selector.register(self.wakeup, selectors.EVENT_READ, self._reap)
        # A lock that another thread holds during the fork would never be released in the child.
        self.can_fork = len(list(Path("/proc/self/task").iterdir())) == 1

    def serve(self) -> dict[str, Any]:
        """Fork a child for every request; return in the child, with the request."""
        signal.set_wakeup_fd(self.wakeup_writer.fileno(), warn_on_full_buffer=False)
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
            cancel = partial(self._cancel, pid, report)
            self.selector.register(report, selectors.EVENT_READ, cancel)
        return None

    def _fork(self, report: socket.socket) -> int | None:
        """Fork like `os.fork`, or report why that is impossible."""
        if not self.can_fork:
            _send_report(report, "threads")
            return None
        try:
            return os.fork()
        except OSError as error:
            _send_report(report, f"refused {error.errno}")
            return None

    def _become_child(
        self, scratch: Path, report: socket.socket, parent_death_pipe: int
    ) -> dict[str, Any]:
        """Close what belongs to the server, and set up the process as the request says."""
        os.setsid()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for inherited in (self.control, self.wakeup, self.wakeup_writer, *self.reports.values()):
            inherited.close()
        try:
            request = _enter(scratch)
        except OSError as error:
            _send_report(report, f"refused {error.errno}")
            os._exit(1)
        report.close()
        return {**request, "parent_death_pipe": parent_death_pipe}

    def _cancel(self, pid: int, report: socket.socket) -> None:
        """End a child whose caller has stopped waiting, unless it was just reaped."""
        if self.reports.get(pid) is report:
            self.selector.unregister(report)
            end_guard(pid)

    def _reap(self) -> None:
        """Report the children that ended, after all processes that they started have ended."""
        self.wakeup.recv(WAKEUP_BYTES)
        for pid, report in list(self.reports.items()):
            if os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                continue
            _, status = os.waitpid(pid, 0)
            code = os.waitstatus_to_exitcode(status)
            if code == -signal.SIGKILL:  # a killed guard leaves its children to the server
                kill_children(spared=self.reports)
            with suppress(KeyError):  # its caller has stopped waiting
                self.selector.unregister(report)
            _send_report(report, f"exit {code}")
            report.close()
            del self.reports[pid]


def _enter(scratch: Path) -> dict[str, Any]:
    """Read the request; switch this process to its output, environment and folder."""
    output = os.open(scratch / "output", os.O_WRONLY | os.O_CREAT)
    os.dup2(output, sys.stdout.fileno())
    os.dup2(output, sys.stderr.fileno())
    os.close(output)
    with (scratch / "request").open("rb") as stream:
        request: dict[str, Any] = pickle.load(stream)  # noqa: S301  the parent wrote it
    set_environment(request["environment"])
    os.chdir(request["folder"])
    return request


def _send_report(report: socket.socket, message: str) -> None:
    with suppress(OSError):  # its caller has stopped waiting
        report.send(message.encode())
