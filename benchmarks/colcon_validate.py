"""Measure `colcon validate` of a workspace of 30 packages, one at a time and two at a time.

    python -m benchmarks.colcon_validate [RUNS] [WORKSPACE]

CPU time as in `benchmarks`; the two are run in turn, because a busy machine changes the wall-clock
time of both. What it does not change is how many packages are in progress at once: the time of all
jobs that `events.log` has, divided by that of the run.
"""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

BIN = Path(sys.executable).parent
WSGEN = str(BIN / "wsgen")
COLCON = str(BIN / "colcon")
TEMPLATES = ("simple", "diff_drive", "arm")
PACKAGES = 30
BOUND = 1.7  # times as fast with two
WAYS = {
    "one at a time": ("--executor", "sequential"),
    "two at a time": ("--executor", "parallel", "--parallel-workers", "2"),
}
EVENT = re.compile(r"^\[([\d.]+)\] \((\w+)\) (JobStarted|JobEnded): ", re.MULTILINE)


class Run(NamedTuple):
    """What one run took."""

    cpu: float  # s
    wall: float  # s
    at_once: float  # packages in progress, the mean over the run


def main() -> None:
    """Measure, and print a table in Markdown."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    given = Path(sys.argv[2]) if len(sys.argv) > 2 else None  # noqa: PLR2004  the second argument
    with workspace(given) as root:
        measured: dict[str, list[Run]] = {way: [] for way in WAYS}
        for _ in range(runs):
            for way, options in WAYS.items():
                measured[way].append(measure(root, options))
    print("| | CPU s | wall-clock s | packages at once |\n|---|---|---|---|")
    medians = {}
    for way, found in measured.items():
        cpu, wall, at_once = (statistics.median(values) for values in zip(*found, strict=True))
        medians[way] = wall
        print(f"| {PACKAGES} packages, {way} | {cpu:.1f} | {wall:.1f} | {at_once:.2f} |")
    one, two = medians.values()
    load = os.getloadavg()[0]
    print(f"\n{one / two:.2f} times as fast (at least {BOUND}), load {load:.1f}")


@contextmanager
def workspace(given: Path | None) -> Iterator[Path]:
    """The workspace, written and built unless it is given."""
    if given is not None:
        yield given
        return
    with tempfile.TemporaryDirectory(prefix="wsgen-benchmark-") as scratch:
        root = Path(scratch, "ws")
        root.mkdir()
        for number in range(PACKAGES):
            template = TEMPLATES[number % len(TEMPLATES)]
            words = ["new", f"robot_{number}", "--template", template, "-w", str(root)]
            subprocess.run([WSGEN, *words], cwd=root, check=True, capture_output=True)
        subprocess.run([WSGEN, "build", "-q"], cwd=root, check=True, capture_output=True)
        yield root


def measure(root: Path, options: tuple[str, ...]) -> Run:
    """One run of colcon."""
    before = time.perf_counter()
    with tempfile.TemporaryFile() as log:
        child = subprocess.Popen(
            [COLCON, "validate", *options], cwd=root, stdout=log, stderr=subprocess.STDOUT
        )
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if status:
            log.seek(0)
            sys.exit(f"colcon validate failed:\n{log.read().decode()}")
    wall = time.perf_counter() - before
    events = (root / "log" / "latest_validate" / "events.log").read_text(encoding="utf-8")
    started: dict[str, float] = {}
    busy = 0.0
    times = []
    for seconds, package, event in EVENT.findall(events):
        times.append(float(seconds))
        if event == "JobStarted":
            started[package] = times[-1]
        else:
            busy += times[-1] - started[package]
    return Run(usage.ru_utime + usage.ru_stime, wall, busy / (max(times) - min(times)))


if __name__ == "__main__":
    main()
