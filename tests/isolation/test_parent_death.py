"""The end of the parent is the end of its children, whatever they do."""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from isolation.conftest import GROUPED, Run
from isolation.processes import is_alive, wait_while
from wsgen.isolation.result import Answered, Limits

# The child starts a process of its own, tells who the three are, and computes for ever.
TASK = """
import os, subprocess
def spin(file):
    child = subprocess.Popen(["sleep", "600"])
    with open(file + ".part", "w") as stream:
        stream.write(f"{os.getppid()} {os.getpid()} {child.pid}")
    os.rename(file + ".part", file)
    while True:
        pass
"""

START = """
import signal, sys, tempfile
sys.path.insert(0, sys.argv[1])
tempfile.tempdir = sys.argv[2]
from wsgen.isolation.parent import Limits, run
signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
"""
ONE = "run('foreign_spin:spin', sys.argv[3], limits=Limits(seconds=600))"
SEVERAL = """
from concurrent.futures import ThreadPoolExecutor
from wsgen.isolation.fork_server import ForkServer
with ThreadPoolExecutor(2) as pool, ForkServer() as server:
    calls = [
        pool.submit(server.run, "foreign_spin:spin", file, limits=Limits(seconds=600))
        for file in sys.argv[3:]
    ]
    for call in calls:
        call.result()
"""
WITHOUT_GUARD = f"from wsgen.isolation import system\nsystem.has_guards = lambda: False\n{ONE}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "returncode"),
    [(signal.SIGTERM, 128 + signal.SIGTERM), (signal.SIGKILL, -signal.SIGKILL)],
)
@pytest.mark.parametrize("calls", [ONE, SEVERAL, WITHOUT_GUARD, "windows"])
def test_the_end_of_the_parent(
    calls: str, number: signal.Signals, returncode: int, tmp_path: Path, windows_like: Path
) -> None:
    interpreter = sys.executable
    if calls == "windows":
        calls, interpreter = ONE, str(windows_like)
    path = os.pathsep.join([str(windows_like.parent), os.environ["PATH"]])  # for its taskkill
    (tmp_path / "foreign_spin.py").write_text(TASK)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    files = [tmp_path / "one", tmp_path / "two"][: 2 if calls is SEVERAL else 1]
    arguments = [START + calls, str(tmp_path), str(scratch), *map(str, files)]
    with subprocess.Popen(
        [interpreter, "-c", *arguments], env={**os.environ, "PATH": path}
    ) as parent:
        wait_while(lambda: not all(file.exists() for file in files))
        family = [int(pid) for file in files for pid in file.read_text().split()]
        assert all(map(is_alive, family))
        parent.send_signal(number)
        assert parent.wait(120) == returncode
    wait_while(lambda: any(map(is_alive, family)))
    # Nobody can clean up after kill -9.
    assert bool(list(scratch.iterdir())) == (number is signal.SIGKILL)


IMPORT = """
import os, sys, time
from pathlib import Path
file = Path(os.environ["PID_FILE"])
file.with_suffix(".part").write_text(str(os.getpid()))
file.with_suffix(".part").rename(file)
time.sleep(600)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="nothing is forked elsewhere")
def test_the_end_of_the_parent_while_a_server_imports(tmp_path: Path) -> None:
    (tmp_path / "foreign_spin.py").write_text(IMPORT)
    file = tmp_path / "pid"
    arguments = [START + SEVERAL, str(tmp_path), str(tmp_path), str(file)]
    environment = {**os.environ, "PID_FILE": str(file)}
    with subprocess.Popen([sys.executable, "-c", *arguments], env=environment) as parent:
        wait_while(lambda: not file.exists())
        server = int(file.read_text())
        assert is_alive(server)
        parent.kill()
    wait_while(lambda: is_alive(server))


HELD_TOO_LATE = """
import os, signal, sys, time
from wsgen.isolation import system
os.setsid()
for_child, ours = os.pipe()
os.close(ours)
getattr(system, sys.argv[1])(for_child, signal.SIGTERM)
time.sleep(60)
"""


@pytest.mark.parametrize("function", ["end_with_parent", "end_with_parent_by_thread"])
def test_a_parent_that_ended_before(function: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", HELD_TOO_LATE, function]
    ended = subprocess.run(command, cwd=tmp_path, check=False)
    assert ended.returncode == -signal.SIGTERM


@pytest.mark.slow
@GROUPED
def test_the_system_limits_the_cpu_time_too(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "foreign_limit.py").write_text(
        "import resource\ndef limit():\n    return resource.getrlimit(resource.RLIMIT_CPU)\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    answer = run("foreign_limit:limit", limits=Limits(seconds=2.5))
    assert isinstance(answer, Answered)
    assert answer.value == [3, 8]
    assert resource.getrlimit(resource.RLIMIT_CPU) != (3, 8)
