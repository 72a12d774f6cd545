"""Programs that tests start, in a network with nothing but loopback, which nobody else has.

A process of the tests makes one network namespace, when the first test needs it, and stays outside:
what it starts with `subprocess` enters the namespace by `nsenter`, which becomes the program, and
what those start inherits it. So threads of the tests are no concern; an ordinary user can do it
where user namespaces are allowed, which no process with threads could enter; and what needs the
network (pip, for the ROS of PyPI) is started `outside`.

Fast DDS meets in shared memory as well, in files that are named after the ports of the ROS domain,
and /dev/shm is the same for all namespaces. So a domain must be one that nobody has on the whole
machine: domains are taken outside, where all runs of tests and of wsgen see the locks, and in the
namespace only those can be taken (`network_keeper.py`). A /dev/shm of its own would hide the
folders of the tests, which may be in it.
"""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import NotReadableError
from wsgen.isolation import system
from wsgen.live.resources import DOMAINS, LOCK, take_domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

KEEPER = Path(__file__).with_name("network_keeper.py")
# That sessions in tests may have at the same time, as those of the fixture `live`.
DOMAINS_OF_LIVE = 4
LINUX_ONLY = "only Linux has network namespaces"
_entering: tuple[str, ...] = ()  # the command in front of programs that are started
_is_within = False
_PLAIN = subprocess.Popen


class Network(NamedTuple):
    """Where programs of tests that speak ROS run."""

    domain: int  # ROS_DOMAIN_ID
    keeper: int | None  # the process that has the namespace
    entering: tuple[str, ...]  # the command that enters it, in front of a program; empty without
    refused: str  # why there is no namespace
    of_live: tuple[int, ...] = ()  # the domains that can be taken in it

    @property
    def tables(self) -> Path:
        """The folder with the tables of its sockets, `udp` and others."""
        return Path("/proc", str(self.keeper or "self"), "net")


_kept = ExitStack()  # for as long as this process runs
atexit.register(_kept.close)


@cache
def network() -> Network:
    """The network of this process of the tests."""
    if not system.has_guards():  # nothing speaks ROS there
        return Network(0, None, (), LINUX_ONLY)
    domain = _kept.enter_context(take_domain()).number
    more = _domains_of_live(int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")))
    keeper, entering, refused = _start_keeper(more)
    if keeper is None:
        return Network(domain, None, (), refused)
    _kept.callback(keeper.communicate)  # it ends
    return Network(domain, keeper.pid, entering, "", more)


def _domains_of_live(workers: int) -> tuple[int, ...]:
    """Domains that sessions in tests may have; fewer where many workers, or runs, need some, too.

    Half of what is free is left to others. Where nothing is, only tests of sessions fail.
    """
    locks = Path("/proc/net/unix").read_text(encoding="utf-8", errors="replace")
    free = len(DOMAINS) - locks.count(f"@{LOCK[1:].format('')}")
    wanted = min(DOMAINS_OF_LIVE, max(1, free // 2 // workers - 1))
    taken: list[int] = []
    with suppress(NotReadableError):
        while len(taken) < wanted:
            taken.append(_kept.enter_context(take_domain()).number)
    return tuple(taken)


def why_refused() -> str:
    """Why programs of tests cannot have a network of their own; empty if they can."""
    keeper, _, refused = _start_keeper(())
    if keeper is not None:
        keeper.communicate()  # it ends
    return refused


def _start_keeper(
    domains: Sequence[int],
) -> tuple[subprocess.Popen[str] | None, tuple[str, ...], str]:
    if not system.has_guards():
        return None, (), LINUX_ONLY
    nsenter = shutil.which("nsenter")
    if nsenter is None:
        return None, (), "util-linux's `nsenter` is not installed"
    keeper = _PLAIN(
        [sys.executable, "-I", str(KEEPER), *map(str, domains)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C ends tests, which may start programs until their end
    )
    assert keeper.stdout is not None
    options = keeper.stdout.readline().split()
    if not options:
        return None, (), keeper.communicate()[1].strip()
    entering = (nsenter, "--target", str(keeper.pid), *options, "--")
    with outside():
        tried = subprocess.run([*entering, "true"], capture_output=True, text=True, check=False)
    if tried.returncode != 0:
        keeper.communicate()
        return None, (), tried.stderr.strip()
    return keeper, entering, ""


class _Popen(subprocess.Popen[Any]):
    """A program in the namespace."""

    def __init__(self, args: Sequence[str | Path], *rest: Any, **options: Any) -> None:
        assert not isinstance(args, (str, bytes))
        assert not {"executable", "shell"} & set(options)
        super().__init__(entering(args), *rest, **options)


def entering(command: Sequence[str | Path]) -> list[str]:
    """A command that runs another one in the namespace, within `own_network`."""
    return [*_entering, *map(os.fsdecode, command)]


@contextmanager
def own_network() -> Iterator[None]:
    """Have what is started with `subprocess` in a network of its own, where that is allowed."""
    with _starting(network().entering, is_within=True):
        yield


@contextmanager
def outside() -> Iterator[None]:
    """Have what is started in the network of the machine again."""
    with _starting((), is_within=False):
        yield


@contextmanager
def _starting(command: tuple[str, ...], *, is_within: bool) -> Iterator[None]:
    global _entering, _is_within
    before = _entering, _is_within, subprocess.Popen
    _entering, _is_within = command, is_within
    subprocess.Popen = _Popen if command else _PLAIN  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        _entering, _is_within, subprocess.Popen = before  # type: ignore[misc]


def ros_domain() -> str:
    """The ROS_DOMAIN_ID of what this process of the tests starts, which nobody else has."""
    assert _is_within, "import what the test needs of ROS from ros_for_tests at the top of its file"
    return str(network().domain)
