"""A ROS_DOMAIN_ID that nobody else on this machine has."""

from __future__ import annotations

import socket
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotReadableError

if TYPE_CHECKING:
    from collections.abc import Iterator

# Up to 101, all ports of a domain are below those that Linux gives to programs that ask for any.
# People choose low ones.
DOMAINS = range(101, 0, -1)
FIRST_PORT, PORTS = 7400, 250  # of domain 0; of each domain (DDSI-RTPS 2.2, 9.6.1.1)
LOCK = "\0wsgen-ros-domain-{}"  # a name of a socket that is no file; it is free when nobody has it
UDP = (Path("/proc/net/udp"), Path("/proc/net/udp6"))


class Domain(NamedTuple):
    """A domain that is taken."""

    number: int
    lock: int  # a descriptor; the domain is taken as long as a process has it open


@contextmanager
def take_domain() -> Iterator[Domain]:
    """Take a domain; other runs of wsgen on this machine, also of other users, take others.

    Those whose ports somebody uses are left out: ROS programs that do not know of the lock.

    Raises:
        NotReadableError: All are taken.
    """
    used = _used_ports()
    for number in DOMAINS:
        first = FIRST_PORT + PORTS * number
        if not used.isdisjoint(range(first, first + PORTS)):
            continue
        lock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            lock.bind(LOCK.format(number))
        except OSError:  # somebody has it
            lock.close()
            continue
        with lock:
            yield Domain(number, lock.fileno())
        return
    raise NotReadableError(
        f"All {len(DOMAINS)} ROS domains of this machine are in use.",
        hint="End ROS programs that are not needed, or run fewer tests at a time.",
    )


def _used_ports() -> set[int]:
    """The UDP ports that some process has."""
    ports = set()
    for file in UDP:
        with suppress(OSError):
            for line in file.read_text(encoding="ascii").splitlines()[1:]:
                ports.add(int(line.split()[1].rpartition(":")[2], 16))
    return ports
