"""Record all topics into an MCAP file, which Foxglove and `ros2 bag` open.

    python -m wsgen.live.nodes.recorder FILE [--use-sim-time] [--live-folder FOLDER] [--parent PID]
        [--report-to DESCRIPTOR]

Like `ros2 bag record --all`: topics are found as they appear, hidden ones are left out, and
messages are stored as they came, with the time at which they did: that of the clock, or with
--use-sim-time the simulated one. Where nobody publishes /clock, the simulator of the live run in
FOLDER is asked for that. The file has its name when it is complete; until then `.part` is
behind it. It is completed at SIGINT or SIGTERM, and when the process PID ends: what was sent until
then is written first, unless another signal comes. Without a message it is removed: an earlier
recording of that name stays.

It writes READY to the descriptor when it records, and a text when it cannot: why. Who has started
it may read that at the end of the run alone, so what happens meanwhile, as a full disk, is reported
on stderr, too. When the file is complete, it writes a JSON list: the seconds from the first message
to the last one, how many there are, and how many were lost, by topic.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import json
import os
import signal
import stat
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.live.nodes.signals import ENDING, raise_when_ended

if TYPE_CHECKING:
    from collections.abc import Sequence


READY = b"\n"
UNFINISHED = ".part"
PR_SET_PDEATHSIG = 1  # linux/prctl.h
FAILED = 1


def _end_with(parent: int) -> None:
    """Have SIGINT come when the process that has started this one ends."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGINT, 0, 0, 0)
    if os.getppid() != parent:  # it has ended already
        os.kill(os.getpid(), signal.SIGINT)


def _read(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="recorder")
    parser.add_argument("file", type=Path)
    parser.add_argument("--use-sim-time", action="store_true")
    parser.add_argument("--live-folder", type=Path)
    parser.add_argument("--parent", type=int)
    parser.add_argument("--report-to", type=int)
    return parser.parse_args(arguments)


class _Notifier:
    """Reports to who has started the recorder, by a descriptor, or by stderr without one."""

    def __init__(self, descriptor: int | None) -> None:
        self._descriptor = descriptor
        self._is_ready = False

    def begin(self) -> None:
        """Report that it records."""
        self._is_ready = True
        self._write(READY)

    def notify(self, text: str) -> None:
        """Report what it has recorded."""
        self._write(text.encode())

    def fail(self, why: str) -> None:
        """Report why it does not record, or not any more."""
        if self._descriptor is None or self._is_ready:
            reported = f"[ERROR] [recorder]: topics are not recorded any more: {why}"
            with contextlib.suppress(OSError):  # it may be on that disk
                sys.stderr.write(f"{reported if self._is_ready else why}\n")
        self._write(why.encode())

    def _write(self, what: bytes) -> None:
        if self._descriptor is None:
            return
        with contextlib.suppress(BrokenPipeError):  # who has started it was killed
            os.write(self._descriptor, what)


def _remove_empty(file: Path) -> None:
    """Remove a file that nothing could be written into."""
    with contextlib.suppress(OSError):
        found = file.lstat()
        if stat.S_ISREG(found.st_mode) and found.st_size == 0:
            file.unlink()


def main(arguments: Sequence[str] | None = None) -> int:
    """Record until SIGINT or SIGTERM comes; give the exit code."""
    # They wait while what takes long is imported: an import that is broken off leaves a traceback.
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    raise_when_ended()
    given = _read(arguments)
    if given.parent is not None:
        _end_with(given.parent)

    notifier = _Notifier(given.report_to)
    file: Path = given.file
    unfinished = file.with_name(file.name + UNFINISHED)
    try:
        with unfinished.open("wb") as stream:
            from wsgen.live.nodes.mcap_recording import record  # noqa: PLC0415  see above

            seconds, messages, lost = record(
                stream,
                use_sim_time=given.use_sim_time,
                live_folder=given.live_folder,
                when_ready=notifier.begin,
            )
        if messages:
            unfinished.replace(file)
        else:
            unfinished.unlink(missing_ok=True)
        notifier.notify(json.dumps((round(seconds, 3), messages, lost)))
    except OSError as error:
        _remove_empty(unfinished)
        notifier.fail(f"{unfinished} cannot be written: {error.strerror or error}")
        return FAILED
    except ImportError as error:
        unfinished.unlink(missing_ok=True)
        notifier.fail(f"a Python module cannot be imported: {error}")
        return FAILED
    return 0


if __name__ == "__main__":
    sys.exit(main())
