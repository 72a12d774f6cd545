"""An interpreter in which the modules of wsgen, and no others, see what Python has on Windows.

`make_interpreter` writes this file into an environment, whose interpreter imports it at its start.
"""

from __future__ import annotations

import builtins
import errno
import os
import sys
import sysconfig
import venv
from pathlib import Path
from types import ModuleType
from typing import Any

MISSING_MODULES = {"fcntl", "grp", "pwd", "resource", "syslog", "termios"}
MISSING_NAMES = {
    "os": {
        *("O_ASYNC", "O_CLOEXEC", "O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK", "ST_RDONLY"),
        *("chown", "fork", "forkpty", "getegid", "geteuid", "getgid", "getpgrp", "getuid"),
        *("killpg", "mkfifo", "set_blocking", "setsid", "statvfs", "sysconf", "uname"),
        *("wait", "waitid"),
    },
    "select": {"epoll", "poll"},
    "signal": {
        *("SIGALRM", "SIGCHLD", "SIGCONT", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGPROF", "SIGXCPU"),
        *("SIGXFSZ", "ITIMER_PROF", "alarm", "pthread_sigmask", "setitimer", "sigtimedwait"),
    },
    "_signal": {"SIGHUP", "SIGKILL"},
    "socket": {"AF_UNIX", "recv_fds", "send_fds"},
    "sys": set(),
    "time": {"tzset"},
}
OTHER_VALUES = {"os": {"name": "nt"}, "sys": {"platform": "win32"}}
TASKKILL = '#!/bin/sh\n[ "$1 $2 $3" = "/F /T /PID" ] && pkill -KILL -P "$4"\nkill -KILL "$4"\n'


class ModuleOnWindows(ModuleType):
    """A module of the standard library with the names that it has on Windows."""

    def __init__(self, module: ModuleType) -> None:
        super().__init__(module.__name__)
        self.__dict__["_module"] = module

    def __getattr__(self, name: str) -> Any:
        module = self.__dict__["_module"]
        if name in MISSING_NAMES[module.__name__]:
            raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
        return OTHER_VALUES.get(module.__name__, {}).get(name) or getattr(module, name)

    def __setattr__(self, name: str, value: object) -> None:
        setattr(self.__dict__["_module"], name, value)


def refuse_link(place: Path, *_arguments: Any, **_keywords: Any) -> None:
    """Do what `Path.symlink_to` does for who is no administrator."""
    error = OSError(errno.EINVAL, "A required privilege is not held by the client", str(place))
    error.winerror = 1314  # type: ignore[attr-defined]
    raise error


def hide_posix(folder: str) -> None:
    """Let the modules below a folder import what Windows has."""
    import_module = builtins.__import__

    def import_on_windows(
        name: str, names: dict[str, Any] | None = None, *arguments: Any, **keywords: Any
    ) -> ModuleType:
        if not str((names or {}).get("__file__")).startswith(folder + os.sep):
            return import_module(name, names, *arguments, **keywords)
        if name in MISSING_MODULES:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        module = import_module(name, names, *arguments, **keywords)
        return ModuleOnWindows(module) if module.__name__ in MISSING_NAMES else module

    winapi = ModuleType("_winapi")
    winapi.CreateJunction = os.symlink  # type: ignore[attr-defined]
    sys.modules["_winapi"] = winapi
    Path.symlink_to = refuse_link  # type: ignore[assignment,method-assign]
    builtins.__import__ = import_on_windows  # type: ignore[assignment]


def make_interpreter(folder: Path) -> Path:
    """Make an environment in a new folder; returns its interpreter, with a `taskkill` beside it."""
    venv.create(folder, symlinks=True)
    packages = Path(sysconfig.get_path("purelib", vars={"base": str(folder)}))
    (packages / "windows_like.py").write_bytes(Path(__file__).read_bytes())
    import wsgen  # noqa: PLC0415  not where this file is imported by the interpreter

    (packages / "windows_like.pth").write_text(
        f"import site; site.addsitedir({sysconfig.get_path('purelib')!r})\n"
        f"import windows_like; windows_like.hide_posix({wsgen.__path__[0]!r})\n"
    )
    taskkill = folder / "bin" / "taskkill"
    taskkill.write_text(TASKKILL)
    taskkill.chmod(0o755)
    return folder / "bin" / "python"
