"""The end of the parent is the end of its children, whatever they do."""

import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from wsgen.isolation.parent import Answered, Limits, run

# The child starts a process of its own, tells both process ids, and computes for ever.
TASK = """
import os, subprocess
def spin(file):
    child = subprocess.Popen(["sleep", "60"])
    with open(file + ".part", "w") as stream:
        stream.write(f"{os.getpid()} {child.pid}")
    os.rename(file + ".part", file)
    while True:
        pass
"""

PARENT = """
import signal, sys, tempfile
sys.path.insert(0, sys.argv[1])
tempfile.tempdir = sys.argv[2]
from wsgen.isolation.parent import Limits, run
signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
run("foreign_spin:spin", sys.argv[3], limits=Limits(seconds=60))
"""


def is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def wait_while(condition: Callable[[], bool], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while condition():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a killed parent ends nobody")
@pytest.mark.parametrize(
    ("number", "returncode", "is_left_behind"),
    [(signal.SIGTERM, 128 + signal.SIGTERM, False), (signal.SIGKILL, -signal.SIGKILL, True)],
)
def test_the_end_of_the_parent(
    number: signal.Signals, returncode: int, is_left_behind: bool, tmp_path: Path
) -> None:
    (tmp_path / "foreign_spin.py").write_text(TASK)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    pids = tmp_path / "pids"
    arguments = [str(tmp_path), str(scratch), str(pids)]
    with subprocess.Popen([sys.executable, "-c", PARENT, *arguments]) as parent:
        wait_while(lambda: not pids.exists())
        family = [int(pid) for pid in pids.read_text().split()]
        assert all(map(is_alive, family))
        parent.send_signal(number)
        assert parent.wait(20) == returncode
    wait_while(lambda: any(map(is_alive, family)))
    # Nobody can clean up after kill -9.
    assert bool(list(scratch.iterdir())) == is_left_behind


HELD_TOO_LATE = """
import os, signal, sys
from wsgen.isolation.lifeline import hold
os.setsid()
for_child, ours = os.pipe()
os.close(ours)
hold(for_child, signal.SIGTERM)
sys.exit("still here")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a killed parent ends nobody")
def test_a_parent_that_ended_before(tmp_path: Path) -> None:
    ended = subprocess.run([sys.executable, "-c", HELD_TOO_LATE], cwd=tmp_path, check=False)
    assert ended.returncode == -signal.SIGTERM


def test_a_child_has_not_much_more_cpu_time_than_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "foreign_limit.py").write_text(
        "import resource\ndef limit():\n    return resource.getrlimit(resource.RLIMIT_CPU)\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    answer = run("foreign_limit:limit", limits=Limits(seconds=2.5))
    assert isinstance(answer, Answered)
    assert answer.value == [8, 8]
    assert resource.getrlimit(resource.RLIMIT_CPU) != (8, 8)
