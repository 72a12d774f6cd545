"""Measure `wsgen check` on a package, and on a hundred packages of twenty files.

    python -m benchmarks.check [RUNS]

CPU time of all processes and wall-clock time, the median of RUNS runs after one that warms the
caches; bare Python beside it, because machines differ.
"""

from __future__ import annotations

import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence


WSGEN = str(Path(sys.executable).with_name("wsgen"))
PACKAGES, FILES = 100, 20
PACKAGE = "measured_robot"
BOX = '<geometry><box size="0.2 0.2 0.2"/></geometry>'
URDF = f"""\
<robot name="part">
  <link name="base_link">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.007" iyy="0.007" izz="0.007" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual>{BOX}</visual>
    <collision>{BOX}</collision>
  </link>
</robot>
"""


class Run(NamedTuple):
    """How long one took, s."""

    cpu: float
    wall: float


def write_packages(folder: Path) -> None:
    """Write the packages of a workspace: each is that of the tutorial and has two launch files."""
    subprocess.run(
        [WSGEN, "new", PACKAGE, "-w", folder, "--maintainer-name", "A"],
        check=True,
        stderr=subprocess.DEVNULL,
    )
    first = folder / "src" / PACKAGE
    (first / "urdf").mkdir()
    (first / "config").mkdir()
    shutil.copy(first / "launch/gazebo_model.launch.py", first / "launch/again.launch.py")
    build_file = first / "CMakeLists.txt"
    build_file.write_text(
        build_file.read_text().replace("DIRECTORY launch", "DIRECTORY config urdf launch")
    )
    written = sum(file.is_file() for file in first.rglob("*"))
    for number in range(FILES - written):
        if number % 2:
            (first / f"config/part_{number}.yaml").write_text("node:\n  ros__parameters: {a: 1}\n")
        else:
            (first / f"urdf/part_{number}.urdf").write_text(URDF)
    for number in range(1, PACKAGES):
        name = f"{PACKAGE}_{number}"
        package = folder / "src" / name
        shutil.copytree(first, package)
        for file in package.rglob("*"):
            if file.is_file():
                file.write_text(file.read_text().replace(PACKAGE, name))


def measure(command: Sequence[str | Path], runs: int) -> Run:
    """The medians of CPU time and wall-clock time."""
    cpu, wall = [], []
    for _ in range(runs + 1):
        before, start = _cpu_of_children(), time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wall.append(time.perf_counter() - start)
        cpu.append(_cpu_of_children() - before)
    return Run(statistics.median(cpu[1:]), statistics.median(wall[1:]))


def _cpu_of_children() -> float:
    """The CPU time of all processes that have ended, s; finer than the ticks of `os.times`."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(runs: int) -> None:
    """Print a table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_packages(folder)
        bare = measure([sys.executable, "-c", "pass"], max(runs, 5))
        table = {
            "one package": measure([WSGEN, "check", folder / "src" / PACKAGE], runs),
            f"{PACKAGES} packages, one job": measure([WSGEN, "check", folder], runs),
            f"{PACKAGES} packages, two jobs": measure([WSGEN, "check", folder, "-j", "2"], runs),
        }
    print(f"{'':32}{'CPU s':>8}{'wall s':>8}{'bare Pythons':>14}")
    for label, run in (("bare Python", bare), *table.items()):
        print(f"{label:32}{run.cpu:8.3f}{run.wall:8.3f}{run.cpu / bare.cpu:14.1f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
