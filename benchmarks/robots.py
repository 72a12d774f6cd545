"""Measure `wsgen validate FILE...` on many robots against loading and stepping them by hand.

    python -m benchmarks.robots [RUNS]

The robots are those of PyBullet's own package and of the test group's packages that PyBullet can
load as they are; by hand one process does all of them. CPU time as in `benchmarks`; the wall-clock
time tells what a second job is worth.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

BY_HAND = str(Path(__file__).with_name("robots_by_hand.py"))
WSGEN = str(Path(sys.executable).with_name("wsgen"))
PACKAGES = (
    "pybullet",
    "example-robot-data",
    "icub-models",
    "jvrc-description",
    "gym-ignition-models",
    "upkie_description",
)
MOST = 60  # robots
LONGEST = 30.0  # s, wall-clock, for one robot by hand


def list_robots() -> list[str]:
    """The URDF files of the packages, but those that are many and alike."""
    found = []
    for package in PACKAGES:
        try:
            listed = files(package) or ()
        except PackageNotFoundError:
            continue
        found += [str(file.locate()) for file in listed if file.name.endswith(".urdf")]
    return [file for file in sorted(found) if "random_urdfs" not in file]


def find_robots() -> list[str]:
    """Those that PyBullet loads without help; it crashes on some, so each has a process."""
    robots: list[str] = []
    for file in list_robots():
        if len(robots) < MOST and _loads(file):
            robots.append(file)
    return robots


def _loads(file: str) -> bool:
    """Whether wsgen finds a robot in it that PyBullet takes as it is."""
    prepared = subprocess.run(
        [WSGEN, "validate", "-q", "--seconds", "0.1", "--format", "json", file],
        capture_output=True,
        check=False,
    )
    if b'"simulated": {' not in prepared.stdout:
        return False
    try:
        by_hand = subprocess.run(
            [sys.executable, BY_HAND, file], capture_output=True, timeout=LONGEST, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return by_hand.returncode == 0


def measure(command: list[str]) -> tuple[float, float]:
    """CPU and wall-clock seconds of a command and its children."""
    started = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - started


def main() -> None:
    """Measure and print a table in Markdown."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    robots = find_robots()
    validate = [WSGEN, "validate", "-q", "--format", "json"]
    commands = {
        "PyBullet by hand": [sys.executable, BY_HAND, *robots],
        "wsgen validate -j 1": [*validate, *robots],
        "wsgen validate -j 2": [*validate, "-j", "2", *robots],
        "wsgen validate --engine mujoco": [*validate, "--engine", "mujoco", *robots],
    }
    measured: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
    for _ in range(runs):
        for name, command in commands.items():
            measured[name].append(measure(command))
    cpu = {name: statistics.median(run[0] for run in seconds) for name, seconds in measured.items()}
    wall = {
        name: statistics.median(run[1] for run in seconds) for name, seconds in measured.items()
    }
    print(f"{len(robots)} robots, median of {runs} runs\n")
    print("| | CPU s | wall-clock s |\n|---|---|---|")
    for name in commands:
        print(f"| {name} | {cpu[name]:.1f} | {wall[name]:.1f} |")
    by_hand, one, two, mujoco = commands
    print(f"\nCPU against by hand: {cpu[one] / cpu[by_hand]:.2f} (at most 1.5)")
    print(f"MuJoCo against PyBullet: {cpu[mujoco] / cpu[one]:.2f} (at most 1.2)")
    print(f"two jobs are {wall[one] / wall[two]:.2f} times faster than one (at least 1.7)")


if __name__ == "__main__":
    main()
