"""`python -m wsgen.live.nodes.node_server CONTROL ENGINE`: forks the programs of a live run.

Half a second of CPU time, most of what such a program needs until its node is there, goes into
imports: of rclpy, NumPy, messages and the modules of wsgen. This process does them once, while the
launch file is still evaluated, and each program is forked from it. It initializes nothing of ROS:
a program does that after the fork, as it would in an interpreter of its own.

A request comes by the socket CONTROL as one message with four descriptors: a file of JSON, and
what becomes the standard input, output and error of the program. The file has the keys `module`,
`words`, `environment`, `folder` and `title`. An answer is a line of text: `started
PID`, `refused`, or, when a program has ended, `ended PID CODE`.
"""

from __future__ import annotations

import ctypes
import gc
import importlib
import json
import os
import re
import selectors
import signal
import socket
import sys
import time
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PRELOADED = (
    "rclpy.action",
    "rclpy.executors",
    "rclpy.experimental",
    "rosgraph_msgs.msg",
    "geometry_msgs.msg",
    "nav_msgs.msg",
    "sensor_msgs.msg",
    "std_msgs.msg",
    "std_srvs.srv",
    "tf2_msgs.msg",
    "wsgen.live.nodes.bridge",
    "wsgen.live.nodes.create",
    "wsgen.live.nodes.robot_state_publisher",
    "wsgen.live.nodes.simulator.__main__",
)
# What the middleware and the messages of nearly every run load when they are used first.
LIBRARIES = ("librmw_fastrtps_cpp.so",)
LARGEST = 1 << 12  # bytes of a message by the socket
DESCRIPTORS = 4
PR_SET_PDEATHSIG, PR_SET_NAME = 1, 15  # linux/prctl.h
ARG_START, ARG_END = 48, 49  # fields of /proc/PID/stat, counted from 1
TRACING = re.compile(r"liblttng-ust(-[0-9a-f]+)?\.so[.0-9]*")
TRACING_THREADS = 2  # for the daemon of the system, and for that of the user
SIGNAL_SET = 128  # bytes of a sigset_t


def main() -> int:
    """Serve; in each forked program, be that program; gives its exit code."""
    control = socket.socket(fileno=int(sys.argv[1]))
    for number in (signal.SIGINT, signal.SIGHUP):  # the launch service ends this process
        signal.signal(number, signal.SIG_IGN)
    preload(sys.argv[2])
    request = NodeServer(control).serve()
    if request is None:
        return 0
    os.chdir(request["folder"])
    program = _module_of(request["module"])
    signal.signal(signal.SIGINT, signal.default_int_handler)  # as in an interpreter
    return int(program.main())


def preload(engine: str) -> None:
    """Import what programs of wsgen use; what is missing, they miss themselves.

    Args:
        engine: That of the simulation, by the name of its option.
    """
    for name in PRELOADED:
        with suppress(Exception):
            importlib.import_module(name)
    for name in LIBRARIES:
        with suppress(OSError):
            ctypes.CDLL(name)
    with suppress(Exception):
        from wsgen.live.nodes.simulator.__main__ import load_engine  # noqa: PLC0415  as above

        load_engine(engine)
    sys.path_importer_cache.clear()  # otherwise a child does not see newer folders
    gc.collect()
    gc.freeze()  # otherwise a child's collector writes to every object, which copies its page


class NodeServer:
    """Waits for requests, and for programs that end."""

    def __init__(self, control: socket.socket) -> None:
        self._control = control
        self._python_path = _entries(os.environ.get("PYTHONPATH", ""))
        self._tracing = _Tracing()
        self._selector = selectors.DefaultSelector()
        self._wake, self._woken = os.pipe()
        for descriptor in (self._wake, self._woken):
            os.set_blocking(descriptor, False)

    def serve(self) -> dict[str, Any] | None:
        """Serve until the launch service is gone: None. In a forked program: its request."""
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
        signal.set_wakeup_fd(self._woken, warn_on_full_buffer=False)
        self._selector.register(self._control, selectors.EVENT_READ)
        self._selector.register(self._wake, selectors.EVENT_READ)
        while True:
            for key, _ in self._selector.select():
                if key.fd == self._wake:
                    with suppress(BlockingIOError):
                        os.read(self._wake, LARGEST)
                    self._reap()
                    continue
                message, files, _, _ = socket.recv_fds(self._control, LARGEST, DESCRIPTORS)
                if not message:
                    return None
                request = self._start(files)
                if request is not None:
                    return request

    def _start(self, files: list[int]) -> dict[str, Any] | None:
        """Fork a program; gives its request in the program alone."""
        with os.fdopen(files[0], "rb") as file:
            file.seek(0)
            request: dict[str, Any] = json.load(file)
        parent = os.getpid()
        ready, reported = os.pipe()
        # Who hears of a program sends signals to its session: none may be lost before it has one.
        kept = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        pid = self._fork()
        if pid == 0:
            self._lead_session(parent)
            os.close(reported)
            os.close(ready)
            signal.pthread_sigmask(signal.SIG_SETMASK, kept)
            self._become(request, files[1:])
            return request
        signal.pthread_sigmask(signal.SIG_SETMASK, kept)
        os.close(reported)
        for descriptor in files[1:]:
            os.close(descriptor)
        if pid > 0:
            os.read(ready, 1)  # until the other end is closed
        os.close(ready)
        if pid > 0:
            self._notify(f"started {pid}")
        return None

    def _fork(self) -> int:
        """Fork; gives -1 where that is refused."""
        if not self._tracing.can_fork():
            self._notify("refused")
            return -1
        self._tracing.notify("before_fork")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of the threads of tracing
                pid = os.fork()
        except OSError:
            pid = -1
            self._notify("refused")
        self._tracing.notify("after_fork_child" if pid == 0 else "after_fork_parent")
        return pid

    def _lead_session(self, parent: int) -> None:
        """Be ended by signals, and with the parent."""
        signal.set_wakeup_fd(-1)
        for number in (*ENDING, signal.SIGCHLD):
            signal.signal(number, signal.SIG_DFL)
        os.setsid()
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:  # it has ended before
            os._exit(1)

    def _become(self, request: dict[str, Any], streams: list[int]) -> None:
        """Be as an interpreter that has just been started for the program."""
        system = ctypes.CDLL(None)
        self._selector.close()
        self._control.close()
        os.close(self._wake)
        os.close(self._woken)
        for stream, descriptor in enumerate(streams):
            os.dup2(descriptor, stream)
            os.close(descriptor)
        title = [str(word) for word in request["title"]]
        system.prctl(PR_SET_NAME, Path(title[0]).name.encode()[:15], 0, 0, 0)
        _show(title)
        os.environ.clear()
        os.environ.update(request["environment"])
        own = [entry for entry in sys.path if entry not in self._python_path]
        sys.path[:] = [*_entries(request["environment"].get("PYTHONPATH", "")), *own]
        sys.argv[:] = [str(_module_of(request["module"]).__file__), *request["words"]]
        time.tzset()

    def _reap(self) -> None:
        """Report the programs that have ended."""
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:
                pid, status = ended
                self._notify(f"ended {pid} {os.waitstatus_to_exitcode(status)}")

    def _notify(self, text: str) -> None:
        with suppress(OSError):  # nobody is there any more, which the next request says
            self._control.send(text.encode())


def _module_of(name: str) -> Any:
    """The module of a program; of a package, that which `python -m` executes."""
    module = importlib.import_module(name)
    return importlib.import_module(f"{name}.__main__") if hasattr(module, "__path__") else module


def _entries(path: str) -> list[str]:
    return [entry for entry in path.split(os.pathsep) if entry]


class _Tracing:
    """The library of LTTng, which the wheels of ROS load, and which starts threads at once.

    A forked program has none of them, unless the library hears of the fork; without them it
    crashes at the end of the program. What calls it is made for `LD_PRELOAD`
    (liblttng-ust-fork.so); its functions had other names before LTTng 2.13.
    """

    def __init__(self) -> None:
        self._signals = ctypes.create_string_buffer(SIGNAL_SET)
        self._library: Any = None
        self._prefix: str | None = None
        maps = Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace")
        paths = {line.split(maxsplit=5)[-1] for line in maps.splitlines() if "/" in line}
        for path in paths:
            if TRACING.fullmatch(Path(path).name):
                self._library = ctypes.CDLL(path)
        for prefix in ("lttng_ust", "ust"):
            if self._library is not None and hasattr(self._library, f"{prefix}_before_fork"):
                self._prefix = prefix
                break

    def can_fork(self) -> bool:
        """Whether no thread is there but this one and those of the library."""
        threads = len(os.listdir("/proc/self/task"))  # noqa: PTH208  names alone
        return threads == 1 or (self._prefix is not None and threads <= 1 + TRACING_THREADS)

    def notify(self, moment: str) -> None:
        """Announce a fork to it: `before_fork`, `after_fork_parent` or `after_fork_child`."""
        if self._prefix is not None:
            getattr(self._library, f"{self._prefix}_{moment}")(self._signals)


def _show(words: list[str]) -> None:
    """Have `ps` show the words as the command line of this process, as far as they have room.

    Where the last byte of the arguments is not zero, Linux shows them up to the first zero.
    """
    with suppress(OSError, ValueError):
        text = Path("/proc/self/stat").read_text(encoding="utf-8", errors="replace")
        fields = text.rpartition(")")[2].split()
        start, end = (int(fields[number - 3]) for number in (ARG_START, ARG_END))
        room = end - start
        shown = " ".join(words).encode("utf-8", "surrogateescape")[: max(0, room - 2)]
        ctypes.memmove(start, shown.ljust(room - 1, b"\0") + b" ", room)


if __name__ == "__main__":
    sys.exit(main())
