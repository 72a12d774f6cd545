"""What a supervisor's signals leave behind of `wsgen build` and `wsgen validate`: nothing."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

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
  execute_process(COMMAND sh -c "echo $$ > ${SLOW}; exec sleep 60")
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


def wait_until(condition: Callable[[], bool], seconds: float = 30.0) -> None:
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
            returncode = process.wait(30)
        worker = int(self.pid_file.read_text())
        wait_until(lambda: not is_alive(worker))
        return returncode


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    return Scene(tmp_path)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_build(scene: Scene, number: signal.Signals) -> None:
    process = scene.start("build", "--", "--cmake-args", f"-DSLOW={scene.pid_file}")
    assert scene.end(process, number) == 128 + number
    assert list(scene.scratch.iterdir()) == []


def test_validate(scene: Scene) -> None:
    assert scene.start("build").wait(60) == 0
    for number in (signal.SIGTERM, signal.SIGHUP):
        scene.pid_file.unlink(missing_ok=True)
        assert scene.end(scene.start("validate"), number) == 128 + number
        assert list(scene.scratch.iterdir()) == []


def test_nohup(scene: Scene) -> None:
    """Who is told to ignore the end of the terminal goes on."""
    code = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); import sys; "
    code += "from wsgen.cli import main; sys.argv[1:] = ['--version']; "
    code += "import atexit, os; atexit.register(os.kill, os.getpid(), signal.SIGHUP); main()"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
