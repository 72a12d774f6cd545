"""`network_keeper.py DOMAIN...`: a network namespace with nothing but loopback, until stdin ends.

Of ROS domains, only those that are named can be taken in it. It prints how to enter the namespace:
`--net`, with `--user` where a user namespace, too, was needed to be allowed to make one.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import socket
import struct
import sys
from pathlib import Path

from wsgen.live.resources import DOMAINS, LOCK

CLONE_NEWUSER, CLONE_NEWNET = 0x10000000, 0x40000000  # linux/sched.h
SIOCGIFFLAGS, SIOCSIFFLAGS = 0x8913, 0x8914  # linux/sockios.h
IFF_UP = 1  # linux/if.h
FLAGS = "16sh14x"  # of linux/if.h's ifreq: the name of the interface, its flags


def main() -> None:
    options = _unshare()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
        answer = fcntl.ioctl(end, SIOCGIFFLAGS, struct.pack(FLAGS, b"lo", 0))
        flags = struct.unpack(FLAGS, answer)[1] | IFF_UP
        fcntl.ioctl(end, SIOCSIFFLAGS, struct.pack(FLAGS, b"lo", flags))
    locks = []  # open as long as this process runs
    for number in set(DOMAINS).difference(map(int, sys.argv[1:])):
        locks.append(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM))
        locks[-1].bind(LOCK.format(number))
    sys.stdout.write(f"{' '.join(options)}\n")
    sys.stdout.flush()
    sys.stdin.read()


def _unshare() -> tuple[str, ...]:
    libc = ctypes.CDLL(None, use_errno=True)
    user, group = os.getuid(), os.getgid()
    if libc.unshare(CLONE_NEWNET) == 0:
        return ("--net",)
    if libc.unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0:
        error = ctypes.get_errno()
        raise OSError(error, os.strerror(error))
    # Everybody is who they are outside.
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1", encoding="ascii")
    Path("/proc/self/setgroups").write_text("deny", encoding="ascii")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1", encoding="ascii")
    return ("--user", "--preserve-credentials", "--net")


if __name__ == "__main__":
    try:
        main()
    except OSError as refused:
        sys.exit(f"the system refuses it: {refused.strerror}")
