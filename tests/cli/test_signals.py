"""What signals leave behind of a command: one line, its exit code, and nothing else."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

PACKAGE_XML = """\
<package format="3">
  <name>demo</name>
  <version>0.0.0</version>
  <description>A robot for tests.</description>
  <maintainer email="somebody@example.com">Somebody</maintainer>
  <license>Apache-2.0</license>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.20)
project(demo LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
if(SLOW)
  execute_process(COMMAND sh -c "echo $$ > ${SLOW}; exec sleep 600")
endif()
install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})
ament_package()
"""
LAUNCH = """\
import os
with open(os.environ["PID_FILE"], "w") as stream:
    stream.write(str(os.getpid()))
while True:
    pass  # spawn_entity.py
"""


def wait_until(condition: Callable[[], bool], seconds: float = 300.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)


def is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


class Scene:
    """A workspace, and a folder for what is temporary."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "ws"
        self.scratch = folder / "tmp"
        self.pid_file = folder / "pid"
        self.scratch.mkdir()
        package = self.root / "src" / "demo"
        (package / "launch").mkdir(parents=True)
        (package / "package.xml").write_text(PACKAGE_XML)
        (package / "CMakeLists.txt").write_text(CMAKE)
        (package / "launch" / "demo.launch.py").write_text(LAUNCH)

    def start(self, *arguments: str) -> "subprocess.Popen[bytes]":
        return subprocess.Popen(
            [sys.executable, "-m", "wsgen", *arguments],
            cwd=self.root,
            env={**os.environ, "TMPDIR": str(self.scratch), "PID_FILE": str(self.pid_file)},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def end(self, process: "subprocess.Popen[bytes]", number: signal.Signals) -> int:
        """Signal it while its child is at work; returns the exit code."""
        with process:
            wait_until(lambda: self.pid_file.exists() and bool(self.pid_file.read_text().strip()))
            process.send_signal(number)
            returncode = process.wait(300)
        worker = int(self.pid_file.read_text())
        wait_until(lambda: not is_alive(worker))
        return returncode


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    return Scene(tmp_path)


ENDINGS = {
    signal.SIGINT: "wsgen: interrupted",
    signal.SIGTERM: "wsgen: terminated",
    signal.SIGHUP: "wsgen: the terminal was closed",
}

# Sends itself a signal as it imports a module for the nth time since the command began to load.
SITE = """
import os, sys
class Finder:
    left = int(os.environ["IMPORTS"])
    has_begun = False
    def find_spec(self, name, path=None, target=None):
        self.has_begun |= name == "wsgen.cli"
        if self.has_begun:
            self.left -= 1
            if self.left == 0:
                os.kill(os.getpid(), int(os.environ["SIGNAL"]))
sys.meta_path.insert(0, Finder())
"""


@pytest.mark.parametrize("number", ENDINGS)
@pytest.mark.parametrize("imports", [1, 2, 20, 45, 60, 90, 120])
def test_while_the_command_is_loaded(tmp_path: Path, imports: int, number: signal.Signals) -> None:
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "sitecustomize.py").write_text(SITE)
    (tmp_path / "tmp").mkdir()
    ended = subprocess.run(
        [sys.executable, "-m", "wsgen", "new", "demo", "--maintainer-name", "A"],
        cwd=tmp_path,
        env={
            **os.environ,
            "PYTHONPATH": str(tmp_path / "site"),
            "IMPORTS": str(imports),
            "SIGNAL": str(int(number)),
            "TMPDIR": str(tmp_path / "tmp"),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.stderr.strip() == ENDINGS[number]
    assert ended.returncode == 128 + number
    assert ended.stdout == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == ["site", "tmp"]
    assert list((tmp_path / "tmp").iterdir()) == []


ROBOT = """\
<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
ixz="0" iyz="0"/></inertial><collision><geometry><box size="1 1 1"/></geometry></collision><visual>
<geometry><box size="1 1 1"/></geometry></visual></link></robot>
"""
ENDLESS = '<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro" a="${fsum(range(10**15))}"/>'


WSGEN = ("-m", "wsgen")
AS_ON_MACOS = """
from wsgen.isolation import system
system.has_guards = lambda: False
from wsgen.__main__ import main
main()
"""


def stop(
    folder: Path,
    number: signal.Signals,
    step: str,
    *arguments: str,
    command: tuple[str, str] = WSGEN,
) -> tuple[int, str, list[str]]:
    """Signal `wsgen validate` when it has begun a step; exit code, output, errors from then on."""
    scratch = folder / "tmp"
    scratch.mkdir()
    with subprocess.Popen(
        [sys.executable, *command, "validate", "--verbose", *arguments],
        cwd=folder,
        env={**os.environ, "TMPDIR": str(scratch)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stderr is not None
        while step not in (line := process.stderr.readline()):
            assert line, f"{step} did not begin"
        process.send_signal(number)
        words, complaints = process.communicate()
    assert list(scratch.iterdir()) == []
    return process.returncode, words, complaints.split("\n")


@pytest.mark.parametrize("number", ENDINGS)
def test_in_the_middle_of_a_simulation(tmp_path: Path, number: signal.Signals) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT)
    code, words, complaints = stop(
        tmp_path, number, "...  r simulate", "r.urdf", "--seconds", "600"
    )
    assert (code, words) == (128 + number, "")
    assert [line for line in complaints if line] == [ENDINGS[number]]


@pytest.mark.parametrize("command", [WSGEN, ("-c", AS_ON_MACOS)], ids=["linux", "macos"])
@pytest.mark.parametrize("jobs", ["1", "2"])
@pytest.mark.parametrize("number", ENDINGS)
def test_a_batch_keeps_what_has_ended(
    tmp_path: Path, number: signal.Signals, jobs: str, command: tuple[str, str]
) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "endless.xacro").write_text(ENDLESS)
    (tmp_path / "last.urdf").write_text(ROBOT)
    files = ["r.urdf", "endless.xacro", "last.urdf"]
    step = "...  endless expand" if jobs == "1" else "...  last expand"  # what comes after r.urdf
    options = ("--jobs", jobs, "--json", "r.json", "--format", "json")
    code, words, complaints = stop(tmp_path, number, step, *files, *options, command=command)
    assert code == 128 + number
    assert ENDINGS[number] in complaints
    assert not any("failed" in line for line in complaints)
    assert (tmp_path / "r.json").read_text() == words
    document = json.loads(words)
    assert not document["complete"]
    assert not document["passed"]
    ended = [package["file"] for package in document["packages"]]
    # With two jobs, the last one may have ended before the signal came.
    assert ended == ["r.urdf"] or (jobs == "2" and ended == ["r.urdf", "last.urdf"])
    assert document["packages"][0]["passed"]


def test_a_person_reads_of_what_has_ended(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "endless.xacro").write_text(ENDLESS)
    (tmp_path / "last.urdf").write_text(ROBOT)
    files = ["r.urdf", "endless.xacro", "last.urdf"]
    code, words, _ = stop(tmp_path, signal.SIGINT, "...  last expand", *files, "--jobs", "2")
    assert code == 128 + signal.SIGINT
    assert "r.urdf: passed" in words
    assert "interrupted" in words
    assert "endless" not in words


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_build(scene: Scene, number: signal.Signals) -> None:
    process = scene.start("build", "--", "--cmake-args", f"-DSLOW={scene.pid_file}")
    assert scene.end(process, number) == 128 + number
    assert list(scene.scratch.iterdir()) == []


def test_validate(scene: Scene) -> None:
    assert scene.start("build").wait(300) == 0
    for number in (signal.SIGTERM, signal.SIGHUP):
        scene.pid_file.unlink(missing_ok=True)
        assert scene.end(scene.start("validate"), number) == 128 + number
        assert list(scene.scratch.iterdir()) == []


def test_nohup(scene: Scene) -> None:
    """A command that ignores SIGHUP goes on when the terminal closes."""
    code = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); import sys; "
    code += "from wsgen.cli import main; sys.argv[1:] = ['--version']; "
    code += "import atexit, os; atexit.register(os.kill, os.getpid(), signal.SIGHUP); main()"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("number", [*ENDINGS, signal.SIGKILL])
def test_in_the_middle_of_a_check_in_workers(scene: Scene, number: signal.Signals) -> None:
    """The launch file runs in a child of a worker."""
    shutil.copytree(scene.root / "src/demo", scene.root / "src/other")
    manifest = scene.root / "src/other/package.xml"
    manifest.write_text(manifest.read_text().replace("demo", "other"))
    code = scene.end(scene.start("check", "--jobs", "2"), number)
    if number == signal.SIGKILL:
        return  # nothing can be removed
    assert code == 128 + number
    assert list(scene.scratch.iterdir()) == []


DROPPED = """
import os, signal, sys, time
from wsgen import cli

class Dropping:
    def __del__(self):
        os.kill(os.getpid(), signal.{name})
        time.sleep(0.01)

def command(**_):
    dropping = Dropping()
    del dropping
    time.sleep(600)

cli.wsgen.main = command
cli.main([])
"""


@pytest.mark.parametrize(("name", "code"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_signal_that_python_drops_ends_wsgen_all_the_same(name: str, code: int) -> None:
    """What is raised in a finalizer or the callback of a weak reference gets to nobody."""
    done = subprocess.run(
        [sys.executable, "-c", DROPPED.replace("{name}", name)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == code, done.stderr
    assert "Exception ignored" not in done.stderr


def test_a_command_can_ask_whether_a_signal_was_dropped() -> None:
    swallowing = """
import os, signal
from wsgen import cli

def command(**_):
    cli.raise_dropped_end()
    try:
        os.kill(os.getpid(), signal.SIGTERM)
    except BaseException:
        pass
    print("goes on")
    cli.raise_dropped_end()
    print("never")

cli.wsgen.main = command
cli.main([])
"""
    done = subprocess.run(
        [sys.executable, "-c", swallowing], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 143, done.stderr
    assert done.stdout == "goes on\n"
