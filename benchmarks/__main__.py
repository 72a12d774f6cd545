"""Measure wsgen against bare Python, plain colcon and a hand-written script.

    python -m benchmarks [RUNS]

CPU time (user and system, children included) of whole processes, as the operating system
accounts for it; the median of RUNS runs after one that warms the caches. Ratios are what counts:
machines differ. The candidates are run in turn, so that a machine that changes its speed changes
it for all of them.
"""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


BIN = Path(sys.executable).parent
WSGEN = str(BIN / "wsgen")
COLCON = str(BIN / "colcon")
PATH = f"{BIN}{os.pathsep}{os.environ['PATH']}"
BY_HAND = str(Path(__file__).with_name("by_hand.py"))

# What `ros2 pkg create --build-type ament_cmake` asks CMake for, with the tutorial's install rule:
# C and C++ compilers are looked for, the lint tests are switched off as there is no ROS here.
TUTORIAL_CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project(gazebo_test)
if(CMAKE_COMPILER_IS_GNUCXX OR CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-Wall -Wextra -Wpedantic)
endif()
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch model DESTINATION share/${PROJECT_NAME})
ament_package()
"""


@dataclass
class Candidate:
    """A command, where it runs, and what is done before each run (not measured)."""

    name: str
    command: Sequence[str]
    folder: Path
    prepare: Callable[[], None] = lambda: None
    environment: dict[str, str] = field(default_factory=dict)
    seconds: list[float] = field(default_factory=list)

    @property
    def median(self) -> float:
        """CPU seconds."""
        return statistics.median(self.seconds)

    def run(self) -> float:
        """One run; CPU seconds of the process and its children."""
        self.prepare()
        with tempfile.TemporaryFile() as log:
            child = subprocess.Popen(
                self.command,
                cwd=self.folder,
                env={**os.environ, **self.environment, "PATH": PATH},
                stdout=subprocess.DEVNULL,
                stderr=log,
            )
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            if status:
                log.seek(0)
                sys.exit(f"{self.name} failed:\n{log.read().decode()}")
        return usage.ru_utime + usage.ru_stime


def remove(*folders: Path) -> Callable[[], None]:
    """Something that removes the folders."""

    def remove_them() -> None:
        for folder in folders:
            shutil.rmtree(folder, ignore_errors=True)

    return remove_them


def candidates(scratch: Path) -> list[Candidate]:
    """Everything that is measured, in a folder each."""
    folders = {name: scratch / name for name in ("new", "loop", "built", "typed", "typed_again")}
    for folder in folders.values():
        folder.mkdir()
    maker = [WSGEN, "new", "gazebo_test", "-q"]
    for name in ("built", "typed", "typed_again"):
        Candidate(name, maker, folders[name]).run()
    package = "ws_gazebo/src/gazebo_test"
    (folders["typed"] / package / "CMakeLists.txt").write_text(TUTORIAL_CMAKE)
    built, typed = folders["built"] / "ws_gazebo", folders["typed"] / "ws_gazebo"
    again = folders["typed_again"] / "ws_gazebo"
    Candidate("build", [WSGEN, "build", "-q"], built).run()
    Candidate("build", [COLCON, "build"], again).run()
    by_hand = built / "install/gazebo_test/share/gazebo_test/model/robot.xacro"
    overlay = '. install/setup.sh && exec "$@"'
    loop = f"{WSGEN} new gazebo_test -q && cd ws_gazebo && {WSGEN} build -q && {WSGEN} validate -q"
    return [
        Candidate("python -c pass", [sys.executable, "-c", "pass"], scratch),
        Candidate("wsgen --help", [WSGEN, "--help"], scratch),
        Candidate("wsgen new", maker, folders["new"], remove(folders["new"] / "ws_gazebo")),
        Candidate(
            "colcon build, package as typed",
            [COLCON, "build"],
            typed,
            remove(*(typed / name for name in ("build", "install", "log"))),
        ),
        Candidate(
            "the same, without wsgen's extension",
            [COLCON, "build"],
            typed,
            remove(*(typed / name for name in ("build", "install", "log"))),
            {"COLCON_EXTENSION_BLOCKLIST": "colcon_core.argument_parser.wsgen"},
        ),
        Candidate(
            "wsgen new, build, validate",
            ["sh", "-c", loop],
            folders["loop"],
            remove(folders["loop"] / "ws_gazebo"),
        ),
        Candidate("colcon build again", [COLCON, "build"], again),
        Candidate("wsgen build again", [WSGEN, "build", "-q"], built),
        Candidate(
            "xacro and PyBullet by hand",
            ["sh", "-c", overlay, "sh", sys.executable, BY_HAND, str(by_hand)],
            built,
        ),
        Candidate("wsgen validate", [WSGEN, "validate", "-q"], built),
    ]


# measured, against, at most
RATIOS = (
    ("wsgen --help", "python -c pass", 6.0),
    ("wsgen new", "python -c pass", 10.0),
    ("wsgen new, build, validate", "colcon build, package as typed", 1.25),
    ("wsgen new, build, validate", "the same, without wsgen's extension", 1.25),
    ("wsgen build again", "colcon build again", 1.0),
    ("wsgen validate", "xacro and PyBullet by hand", 2.0),
)


def main() -> None:
    """Measure and print a table in Markdown."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 11
    with tempfile.TemporaryDirectory(prefix="wsgen-benchmark-") as scratch:
        measured = {candidate.name: candidate for candidate in candidates(Path(scratch))}
        for number in range(runs + 1):
            for candidate in measured.values():
                seconds = candidate.run()
                if number:  # the first run warms the caches
                    candidate.seconds.append(seconds)
    print(f"Python {sys.version.split()[0]}, {os.cpu_count()} cores, median of {runs} runs\n")
    print("| | CPU ms | min | max |\n|---|---|---|---|")
    for name, candidate in measured.items():
        values = (candidate.median, min(candidate.seconds), max(candidate.seconds))
        print(f"| {name} | " + " | ".join(f"{1000 * value:.0f}" for value in values) + " |")
    print("\n| measured | against | ratio | at most |\n|---|---|---|---|")
    for name, against, bound in RATIOS:
        ratio = measured[name].median / measured[against].median
        print(f"| {name} | {against} | {ratio:.2f} | {bound:g} |")


if __name__ == "__main__":
    main()
