"""Programs of wsgen that are forked: each is a process as if an interpreter were started for it."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from live_launch import is_alive, wait_until
from wsgen.live.forked_nodes import ForkedNode, NodeServer
from wsgen.live.request import NodeServerRequest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

MODULE = "told_by_test"
PROGRAM = """
import os, signal, sys, time

def main():
    print(os.getcwd(), *sys.argv[1:], os.environ.get("TOLD"), "GONE" in os.environ, flush=True)
    print(sys.stdin.readline(), os.getsid(0) == os.getpid(), file=sys.stderr, flush=True)
    if sys.argv[1] == "wait":
        time.sleep(60)
    if sys.argv[1] == "ignore":
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print("ignores", flush=True)
        time.sleep(60)
    return int(sys.argv[1])
"""


@pytest.fixture(scope="module")
def modules(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("modules")
    (folder / f"{MODULE}.py").write_text(PROGRAM)
    return folder


def _variables(modules: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": f"{modules}", "GONE": "1", "LD_LIBRARY_PATH": "/a:/b"}


@pytest.fixture
def begin(server: NodeServer, modules: Path) -> Iterator[Callable[..., _Started]]:
    """Start the program with words and variables."""
    started: list[_Started] = []

    def start(*words: str, **variables: str | None) -> _Started:
        started.append(_Started(server, modules, *words, **variables))
        return started[-1]

    yield start
    for one in started:
        one.close()


@pytest.fixture
def server(modules: Path) -> Iterator[NodeServer]:
    environment = _variables(modules)
    paths = {"PYTHONPATH": f"{modules}:/more", "LD_LIBRARY_PATH": "/a:/b:/more"}
    request = NodeServerRequest(
        python=Path(sys.executable), environment=environment, paths=paths, engine="none"
    )
    made = NodeServer(request)
    yield made
    made._lose()
    made._control.close()


class _Started:
    def __init__(
        self, server: NodeServer, modules: Path, *words: str, **variables: str | None
    ) -> None:
        given = {**_variables(modules), "TOLD": "told", **variables}
        environment = {name: value for name, value in given.items() if value is not None}
        ends = [os.pipe(), os.pipe()]
        self.node: ForkedNode | None = server.start(
            MODULE,
            words,
            title=["robot_state_publisher", "--ros-args"],
            environment=environment,
            folder=str(modules),
            outputs=[theirs for _, theirs in ends],
        )
        for _, theirs in ends:
            os.close(theirs)
        self.output, self.errors = (os.fdopen(ours, "r") for ours, _ in ends)

    @property
    def forked(self) -> ForkedNode:
        assert self.node is not None
        return self.node

    def close(self) -> None:
        """Close its streams."""
        for stream in (self.output, self.errors, *([self.node.stdin] if self.node else [])):
            stream.close()

    def wait(self) -> int:
        wait_until(lambda: self.forked.poll() is not None, lambda: "it still runs")
        assert self.forked.returncode is not None
        return self.forked.returncode


@pytest.mark.slow
def test_a_program_has_its_words_variables_streams_session_and_exit_code(
    begin: Callable[..., _Started], modules: Path
) -> None:
    started = begin("7", "b c", GONE=None)
    started.forked.stdin.write(b"line\n")
    assert started.wait() == 7
    assert started.output.read() == f"{modules} 7 b c told False\n"
    assert started.errors.read() == "line\n True\n"
    assert not is_alive(started.forked.pid)


@pytest.mark.slow
def test_ps_shows_what_a_program_is(begin: Callable[..., _Started]) -> None:
    started = begin("wait")
    started.forked.stdin.write(b"\n")
    assert started.output.readline()
    folder = Path("/proc", str(started.forked.pid))
    assert (folder / "cmdline").read_text().rstrip("\0") == "robot_state_publisher --ros-args"
    assert (folder / "comm").read_text() == "robot_state_pub\n"
    os.killpg(started.forked.pid, signal.SIGINT)
    assert started.wait() == -signal.SIGINT
    assert "KeyboardInterrupt" in started.errors.read()


@pytest.mark.slow
def test_a_program_has_its_session_when_its_start_is_reported(
    begin: Callable[..., _Started],
) -> None:
    for _ in range(5):
        started = begin("wait")
        os.killpg(started.forked.pid, signal.SIGINT)
        assert started.wait() == -signal.SIGINT


@pytest.mark.slow
def test_programs_that_are_killed_are_noticed_one_by_one(begin: Callable[..., _Started]) -> None:
    one, other = begin("ignore"), begin("ignore")
    one.forked.stdin.write(b"\n")
    os.kill(one.forked.pid, signal.SIGKILL)
    assert one.wait() == -signal.SIGKILL
    assert other.forked.poll() is None
    os.kill(other.forked.pid, signal.SIGTERM)
    assert other.wait() == -signal.SIGTERM


@pytest.mark.slow
def test_programs_end_with_their_server(begin: Callable[..., _Started]) -> None:
    started = begin("ignore")
    started.forked.stdin.write(b"\n")
    assert started.output.readline()
    stat = Path("/proc", str(started.forked.pid), "stat").read_text()
    os.kill(int(stat.rpartition(")")[2].split()[1]), signal.SIGKILL)
    assert started.wait() == -signal.SIGKILL
    wait_until(lambda: not is_alive(started.forked.pid), lambda: "it still runs")
    assert begin("0").node is None  # it is started in another way


def test_variables_that_an_interpreter_reads_at_its_start_need_one(
    server: NodeServer, modules: Path
) -> None:
    own = _variables(modules)
    assert server.can_have({**own, "ROS_DOMAIN_ID": "3", "PYTHONSAFEPATH": "1"})
    assert server.can_have({**own, "LD_LIBRARY_PATH": "/a:/b:/more"})
    assert not server.can_have({**own, "LD_LIBRARY_PATH": "/b:/a"})
    assert not server.can_have({**own, "LD_LIBRARY_PATH": "/a:/b:/other"})
    assert not server.can_have({**own, "PYTHONPATH": ""})
    assert not server.can_have({**own, "LD_PRELOAD": "libasan.so"})
    assert not server.can_have({**own, "PYTHONDEVMODE": "1"})
