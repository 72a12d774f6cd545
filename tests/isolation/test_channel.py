"""Child processes that answer commands, and every way in which they end."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from isolation.conftest import Task
from isolation.processes import is_alive, wait_while
from windows_like import ModuleOnWindows
from wsgen.isolation.channel import Channel
from wsgen.isolation.result import Answered, Died

pytestmark = pytest.mark.slow

COMMANDS = """
import ctypes, os, sys, time
from wsgen.isolation.channel import serve

class Text(str):
    pass

def spin():
    while True:
        pass

COMMANDS = {
    "sum": lambda *numbers: {"sum": sum(numbers)},
    "say": lambda text: print(text) or os.write(1, text.encode()) * 0,
    "pid": os.getpid,
    "raise": lambda: 1 / 0,
    "crash": lambda: ctypes.string_at(0),
    "leave": lambda: os._exit(7),
    "spin": spin,
    "sleep": lambda: time.sleep(3600),
    "object": object,
    "large": lambda: "x" * 3_000_000,
}
"""
BODY = "serve(arguments[-1], COMMANDS)"


@pytest.fixture(params=["inherited", "loopback", "macos", "forked"])
def channel(
    request: pytest.FixtureRequest, task: Task, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Channel]:
    if request.param == "macos":
        monkeypatch.setattr("wsgen.isolation.system.has_guards", lambda: False)
    if request.param == "loopback":
        monkeypatch.setattr("wsgen.isolation.system.can_inherit", lambda: False)
    if request.param == "forked":  # the test runner's threads hold no lock that it needs
        monkeypatch.setattr("wsgen.isolation.system.can_fork", lambda: True)
    made = task(BODY, before=COMMANDS)
    channel = Channel(made, "first argument", is_forked=request.param == "forked")
    yield channel
    channel.close()


def value(outcome: Answered | Died) -> object:
    assert isinstance(outcome, Answered), outcome
    return outcome.value


def death(outcome: Answered | Died) -> Died:
    assert isinstance(outcome, Died), outcome
    return outcome


def test_commands_are_answered_one_by_one(channel: Channel) -> None:
    assert value(channel.call("sum", 1, 2, 3)) == {"sum": 6}
    assert value(channel.call("sum", 0.5)) == {"sum": 0.5}
    first = value(channel.call("pid"))
    assert value(channel.call("pid")) == first != os.getpid()


def test_what_is_printed_does_not_get_between_them(channel: Channel) -> None:
    value(channel.call("say", "\x00\x00\x00 {"))
    assert value(channel.call("sum", 1)) == {"sum": 1}
    assert "{" in channel.output()


def test_an_answer_may_be_long(channel: Channel) -> None:
    assert value(channel.call("large")) == "x" * 3_000_000


@pytest.mark.parametrize(
    ("command", "reason", "cause"),
    [
        ("raise", "failed (ZeroDivisionError: division by zero)", "exception"),
        ("crash", "crashed (SIGSEGV)", "crash"),
        ("leave", "ended with exit code 7 and no answer", "crash"),
        ("object", "failed (TypeError: A object cannot be written as JSON.)", "exception"),
        ("unknown", "failed (KeyError: 'unknown')", "exception"),
    ],
)
def test_its_death_is_an_answer(channel: Channel, command: str, reason: str, cause: str) -> None:
    outcome = death(channel.call(command))
    assert (outcome.reason, outcome.cause) == (reason, cause)
    assert channel.call("sum", 1) is outcome  # from now on


def test_a_command_that_hangs_ends_at_its_limit_of_cpu_time(channel: Channel) -> None:
    outcome = death(channel.call("spin", seconds=1.0, wall_clock=300.0))
    assert outcome.reason == "used more than 1 s of CPU time"


def test_the_limit_is_that_of_one_command(channel: Channel) -> None:
    """What others took before is not counted."""
    pid = value(channel.call("pid"))
    for _ in range(3):
        assert value(channel.call("sum", 1, seconds=1.0)) == {"sum": 1}
    assert value(channel.call("pid")) == pid


def test_a_command_that_sleeps_ends_at_the_limit_of_wall_clock_time(channel: Channel) -> None:
    outcome = death(channel.call("sleep", wall_clock=0.5))
    assert outcome.cause == "wall-clock time"


def test_closing_ends_the_child(channel: Channel) -> None:
    pid = value(channel.call("pid"))
    assert isinstance(pid, int)
    channel.close()
    wait_while(lambda: is_alive(pid))
    assert death(channel.call("sum", 1)).reason == "was closed"


def test_a_child_that_somebody_kills_is_noticed(channel: Channel) -> None:
    pid = value(channel.call("pid"))
    assert isinstance(pid, int)
    os.kill(pid, signal.SIGKILL)
    assert death(channel.call("sum", 1)).reason == "crashed (SIGKILL)"


def test_a_child_that_never_connects_is_noticed(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.isolation.system.can_inherit", lambda: False)
    channel = Channel(task("raise ImportError('no engine')"))
    assert death(channel.call("sum")).reason == "failed (ImportError: no engine)"
    channel.close()


def test_a_child_that_does_not_start_serving_is_noticed(task: Task) -> None:
    channel = Channel(task("raise ImportError('no engine')"))
    assert death(channel.call("sum")).reason == "failed (ImportError: no engine)"
    channel.close()


def test_it_works_on_windows(
    task: Task, windows_like: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.isolation.system.has_guards", lambda: False)
    monkeypatch.setattr("wsgen.isolation.system.can_inherit", lambda: False)
    monkeypatch.setattr("sys.executable", str(windows_like))
    monkeypatch.setattr("wsgen.isolation.system.os", ModuleOnWindows(os))
    monkeypatch.setenv("PATH", str(windows_like.parent), prepend=os.pathsep)
    channel = Channel(task(BODY, before=COMMANDS))
    assert value(channel.call("sum", 2)) == {"sum": 2}
    channel.close()


def test_nothing_that_it_answers_is_unpickled(task: Task) -> None:
    """What foreign code wrote is read as JSON, or not at all."""
    wrote = "import pickle; connection.sendall(LENGTH.pack(len(evil)) + evil)"
    body = f"""
    from wsgen.isolation.channel import LENGTH, _connect
    connection = _connect(arguments[-1])
    evil = b"cos\\nsystem\\n(S'touch /nonexistent/x'\\ntR."
    {wrote}
    """
    channel = Channel(task(body))
    assert death(channel.call("sum")).reason == "answered what is not JSON"
    channel.close()
