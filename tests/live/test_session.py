"""A live run whose time passes by steps: its journal, its domain, what is measured in it."""

from __future__ import annotations

import contextlib
import errno
import json
import math
import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest

from live_launch import wait_until
from wsgen.diagnostics import Severity
from wsgen.errors import NotReadableError, RequestError, SessionDiedError
from wsgen.launching.launch_warnings import UNUSED_ARGUMENT
from wsgen.launching.spawning import NO_ROBOT
from wsgen.live import behaviors, messenger, resources, session
from wsgen.live.behaviors import LONGEST_LINE, Way, _cause
from wsgen.live.journal import (
    KEPT_LINES,
    OTHER,
    SIMULATOR,
    SPAWNER,
    STANDARD,
    Journal,
    JournalWriter,
)
from wsgen.live.resources import Activity, cpu_seconds, is_at_work, take_domain
from wsgen.live.session import LiveSession, LiveState
from wsgen.model.behavior import Behavior, BehaviorRun, LaunchTask
from wsgen.pipeline.requests import ValidateRequest
from wsgen.simulation.live_runs import short_name, socket_path

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.live.messenger import Messenger as LiveMessenger
    from wsgen.live.service_child import ServiceChild


# The journal.


@pytest.fixture
def begin_journal() -> Iterator[Callable[[Path], JournalWriter]]:
    """Begins journals, and closes them."""
    with contextlib.ExitStack() as stack:

        def begin(folder: Path) -> JournalWriter:
            writer = JournalWriter(folder)
            stack.callback(writer.close)
            return writer

        yield begin


def test_the_journal_is_read_while_it_is_written(
    tmp_path: Path, begin_journal: Callable[[Path], JournalWriter]
) -> None:
    journal = Journal(tmp_path)
    journal.read()
    assert not journal.processes
    writer = begin_journal(tmp_path)
    writer.started("a-1", 7, "/a", OTHER)
    writer.printed("a-1", [b"one", b"\xff two"])
    journal.read()
    process = journal.processes["a-1"]
    assert (process.pid, process.node, process.code) == (7, "/a", None)
    assert list(process.lines) == ["one", "\ufffd two"]
    writer.printed("launch", [b"[INFO] [launch]: here"])
    writer.ended("a-1", 1, is_wanted=False)
    writer.left_out("rviz2", "it draws")
    journal.read()
    assert list(journal.lines)[-1] == "[launch] [INFO] [launch]: here"
    assert [one.name for one in journal.failed] == ["a-1"]
    assert journal.left_out == {"rviz2": "it draws"}


def test_lines_of_the_user_are_not_lost_among_those_of_standard_programs(
    tmp_path: Path, begin_journal: Callable[[Path], JournalWriter]
) -> None:
    writer = begin_journal(tmp_path)
    for name, role in (("gz-1", SIMULATOR), ("create-2", SPAWNER), ("bridge-3", STANDARD)):
        writer.started(name, 7, None, role)
        writer.printed(name, [b"[INFO] [1.0] [x]: I begin.", b"\x1b[0m[DEBUG] [1.0] [x]: So."])
    writer.started("driver-4", 8, "/driver", OTHER)
    writer.printed("driver-4", [b"[INFO] [1.0] [driver]: I drive.", b"by print()"])
    writer.printed("launch", [b"[INFO] [gz-1]: process started", b"[ERROR] [gz-1]: it died"])
    writer.printed("bridge-3", [b"[INFO] [1.0] [x]: Creating GZ->ROS Bridge"] * 2 * KEPT_LINES)
    writer.printed("bridge-3", [b"[WARN] [1.0] [x]: No such type", b"Traceback (most recent"])
    journal = Journal(tmp_path)
    journal.read()
    assert list(journal.important) == [
        "[driver-4] [INFO] [1.0] [driver]: I drive.",
        "[driver-4] by print()",
        "[launch] [ERROR] [gz-1]: it died",
        "[bridge-3] [WARN] [1.0] [x]: No such type",
        "[bridge-3] Traceback (most recent",
    ]


@pytest.mark.parametrize(("code", "is_wanted"), [(0, False), (-2, True), (1, True)])
def test_who_ends_well_or_was_told_to_has_not_failed(
    tmp_path: Path,
    begin_journal: Callable[[Path], JournalWriter],
    code: int,
    *,
    is_wanted: bool,
) -> None:
    writer, journal = begin_journal(tmp_path), Journal(tmp_path)
    writer.started("a-1", 7, None, OTHER)
    writer.ended("a-1", code, is_wanted=is_wanted)
    journal.read()
    assert not journal.failed


def test_half_a_line_waits(tmp_path: Path, begin_journal: Callable[[Path], JournalWriter]) -> None:
    writer, journal = begin_journal(tmp_path), Journal(tmp_path)
    writer.started("a-1", 7, None, OTHER)
    file = tmp_path / "journal"
    whole = file.read_bytes()
    file.write_bytes(whole + b'["line", "a-')
    journal.read()
    file.write_bytes(whole + b'["line", "a-1", "x"]\n')
    journal.read()
    assert list(journal.processes["a-1"].lines) == ["x"]


class FullDisk:
    """Takes some bytes, and no more until there is room again."""

    def __init__(self, room: int) -> None:
        self.room = room
        self.data = b""

    def write(self, data: bytes) -> int:
        if self.room == 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        taken = data[: self.room]
        self.data += taken
        self.room -= len(taken)
        return len(taken)

    def close(self) -> None:
        pass


def test_a_full_disk_joins_no_lines(tmp_path: Path) -> None:
    writer, journal = JournalWriter(tmp_path), Journal(tmp_path)
    writer.close()
    disk = writer._stream = FullDisk(60)  # type: ignore[assignment]
    writer.started("a-1", 7, None, OTHER)
    writer.printed("a-1", [b"this is half written", b"this is left out"])
    writer.started("b-2", 8, None, OTHER)
    disk.room = 10_000
    writer.ended("a-1", 1, is_wanted=False)
    (tmp_path / "journal").write_bytes(disk.data)
    journal.read()
    assert list(journal.lines) == ["[a-1] this is half written"]
    assert list(journal.processes) == ["a-1", "b-2"]
    assert [one.name for one in journal.failed] == ["a-1"]


def test_who_has_ended_may_be_unknown(
    tmp_path: Path, begin_journal: Callable[[Path], JournalWriter]
) -> None:
    writer, journal = begin_journal(tmp_path), Journal(tmp_path)
    writer.ended("a-1", 1, is_wanted=False)
    writer.printed("launch", [b"on"])
    journal.read()
    assert list(journal.lines) == ["[launch] on"]


# Domains.

TAKE = """
import sys, time
from wsgen.live.resources import take_domain
with take_domain() as domain:
    print(domain.number, flush=True)
    sys.stdin.read()
"""


def test_nobody_else_gets_a_domain_while_it_is_taken() -> None:
    with take_domain() as first, take_domain() as second:
        assert first.number != second.number
        other = subprocess.Popen(
            [sys.executable, "-c", TAKE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert other.stdout is not None
        number = int(other.stdout.readline())
        assert number not in {first.number, second.number}
        other.kill()  # as with kill -9
        other.communicate()
        lock = socket.socket(socket.AF_UNIX)
        with lock:
            lock.bind(resources.LOCK.format(number))  # it is free again
    assert 1 <= first.number <= 101


def test_ports_that_somebody_uses_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    with take_domain() as free:
        pass
    taken = resources.FIRST_PORT + resources.PORTS * free.number + 11
    monkeypatch.setattr(resources, "_used_ports", lambda: {taken})
    with take_domain() as domain:
        assert domain.number != free.number


def test_all_domains_in_use_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resources, "_used_ports", lambda: set(range(40_000)))
    with pytest.raises(NotReadableError, match="ROS domains"), take_domain():
        pass


def test_used_ports_are_seen() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        assert one.getsockname()[1] in resources._used_ports()


# Threads that work.


WORK = """
import sys
print(1, flush=True)
while sys.argv[1] == 'busy':
    pass
sys.stdin.read()
"""


@pytest.mark.slow
@pytest.mark.parametrize(("word", "expected"), [("busy", True), ("idle", False)])
def test_a_process_that_computes_is_at_work(word: str, *, expected: bool) -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", WORK, word], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert child.stdout is not None
    try:
        child.stdout.readline()
        wait_until(lambda: is_at_work(child.pid) is expected, lambda: f"not {word}")
        before, begun = cpu_seconds(child.pid), time.monotonic()
        Activity().wait_until_idle([child.pid])
        used, waited = cpu_seconds(child.pid), time.monotonic() - begun
        assert before is not None
        assert used is not None
        assert is_at_work(child.pid) is expected
        if expected:
            assert used - before >= resources.LONGEST / 2 or waited >= resources.LONGEST_WAIT
    finally:
        child.kill()
        child.communicate()
    assert not is_at_work(child.pid)


class Machine:
    """A machine with a process 7 that gets a share of a core, as long as it wants one."""

    def __init__(self, share: float) -> None:
        self.share = share
        self.now = self.used = 0.0
        self.wants = math.inf  # s of CPU time, until it sleeps

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds
        self.used += min(self.share * seconds, self.wants)
        self.wants -= min(self.share * seconds, self.wants)

    def is_at_work(self, pid: int, **_: object) -> bool:
        return pid == 7 and self.wants > 0

    def cpu_seconds(self, _pid: int) -> float:
        return self.used


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    made = Machine(share=1.0)
    monkeypatch.setattr(resources, "time", made)
    monkeypatch.setattr(resources, "is_at_work", made.is_at_work)
    monkeypatch.setattr(resources, "cpu_seconds", made.cpu_seconds)
    return made


def test_who_waits_for_a_core_is_waited_for(machine: Machine) -> None:
    machine.share, machine.wants = 0.125, 0.1
    Activity().wait_until_idle([7])
    assert machine.wants == 0.0
    assert machine.now == pytest.approx(0.8, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("share", [1.0, 0.25, 0.0])
def test_who_never_sleeps_is_waited_for_no_longer(machine: Machine, share: float) -> None:
    machine.share = share
    watch = Activity()
    for _ in range(20):
        before = machine.now
        watch.wait_until_idle([7])
        expected = resources.LONGEST / share if share else resources.LONGEST_WAIT
        assert machine.now - before == pytest.approx(expected, abs=0.01)
    watch.wait_until_idle([7])  # what was counted is a little less than the whole
    before = machine.now
    watch.wait_until_idle([7])
    assert machine.now - before < 0.01


def test_who_has_slept_meanwhile_is_waited_for_again(machine: Machine) -> None:
    watch = Activity()
    for _ in range(21):  # it imports its modules
        watch.wait_until_idle([7])
    machine.wants = 0.0
    watch.wait_until_idle([7])
    machine.wants = 0.1
    watch.wait_until_idle([7])
    assert machine.wants == 0.0


# The session, with a simulator that is a socket.


class Service:
    """Stands for the launch service."""

    code: int | None = None

    def interrupt(self) -> None:
        self.code = 0

    def wait_for(self, _seconds: float) -> bool:
        return True


class Messenger:
    """Stands for the process with rclpy."""

    nodes = ("/driver",)

    def ask(self, do: str, **values: object) -> dict[str, Any]:
        assert (do, values) == ("nodes", {})
        return {"nodes": list(self.nodes)}

    def close(self) -> None:
        pass


class Simulator:
    """Moves a robot along x with 1 m/s; it comes after 0.2 s."""

    def __init__(self, folder: Path) -> None:
        self.now = 0.0
        self.is_paused = False
        self.hangs = False
        self.may_answer = threading.Event()
        self.may_answer.set()
        self.ends_at = math.inf
        self.robot_comes_at = 0.2
        self.server = socket.socket(socket.AF_UNIX)
        with short_name(socket_path(folder)) as name:
            self.server.bind(name)
        self.server.listen()
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self) -> None:
        client, _ = self.server.accept()
        with client, client.makefile("rwb") as stream:
            for line in stream:
                request = json.loads(line)
                assert request["do"] == "advance"
                passed = 0.0 if self.is_paused else request["seconds"]
                self.now += passed
                if self.now >= self.ends_at:
                    return
                if self.hangs:
                    continue
                self.may_answer.wait()
                stream.write(json.dumps({"ok": True, **self.state(), "passed": passed}).encode())
                stream.write(b"\n")
                stream.flush()

    def state(self) -> dict[str, Any]:
        there = {"wall": [0.0] * 6 + [1.0]}
        if self.now >= self.robot_comes_at:
            there["rover"] = [self.now, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
        joints = {"rover": {"wheel": self.now}} if "rover" in there else {}
        return {
            "seconds": self.now,
            "is_paused": self.is_paused,
            "entities": list(there),
            "poses": there,
            "joints": joints,
        }


class Rig:
    """A session with what stands around it."""

    def __init__(self, folder: Path, observe: Callable[[LiveState], None]) -> None:
        self.simulator = Simulator(folder)
        self.writer = JournalWriter(folder)
        self.service = Service()
        self.reported: list[Diagnostic] = []
        self.writer.started("gazebo-1", os.getpid(), None, SIMULATOR)
        self.session = LiveSession(
            folder,
            cast("ServiceChild", self.service),
            cast("LiveMessenger", Messenger()),
            entities=("rover",),
            may_fail=("mapper",),
            reported=self.reported,
            observe=observe,
        )


class Clock:
    """A clock of a session that stands still while it does not sleep, however long that takes."""

    def __init__(self, rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = rig.session._begun
        monkeypatch.setattr(session, "time", self)

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Rig]:
    monkeypatch.setattr(session, "LOOK_EVERY", 0.01)
    monkeypatch.setattr(Activity, "wait_until_idle", lambda *_, **__: None)
    made = Rig(tmp_path, lambda _state: None)
    yield made
    made.simulator.server.close()
    made.writer.close()
    made.session.close()


def test_it_starts_when_the_robot_is_there(rig: Rig) -> None:
    rig.session.start()
    assert list(rig.session.state.poses) == ["rover"]  # the wall is no robot
    begun = rig.session.state.seconds
    assert 0.2 <= begun < 0.4
    rig.session.run_for(1.0)
    assert rig.session.state.seconds == pytest.approx(begun + 1.0)
    assert rig.session.state.poses["rover"].x == pytest.approx(begun + 1.0)
    assert rig.session.state.joints["rover"]["wheel"] == pytest.approx(begun + 1.0)


def test_what_stands_still_is_spawned_too(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "SECONDS_TO_START", 2.0)
    rig.session.entities = ("wall", "rover")  # the launch file spawns both
    rig.session.start()
    assert list(rig.session.state.poses) == ["rover"]
    assert "not in the world" not in rig.session.report()


def test_it_waits_until_something_holds_and_no_longer(rig: Rig) -> None:
    rig.session.start()
    held = rig.session.run_for(9.0, until=lambda: rig.session.state.poses["rover"].x > 2)
    assert held
    assert rig.session.state.seconds == pytest.approx(2.0, abs=0.1)
    assert not rig.session.run_for(0.5, until=lambda: False)
    with pytest.raises(RequestError, match="not a time in seconds"):
        rig.session.run_for(math.nan)


def test_who_has_not_appeared_is_waited_for(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    Clock(rig, monkeypatch)
    monkeypatch.setattr(session, "SECONDS_TO_APPEAR", 0.3)
    monkeypatch.setattr(resources.CpuTimes, "idle", lambda *_: set())
    rig.writer.started("driver-2", os.getpid(), "/driver", OTHER)
    rig.writer.started("slow-3", os.getpid(), "/slow", OTHER)
    rig.session.start()
    assert "nodes that have not appeared: slow-3" in rig.session.report()


def test_a_process_that_fails_ends_it_with_its_traceback(rig: Rig) -> None:
    rig.session.start()
    rig.writer.started("driver-2", 1, "/driver", OTHER)
    rig.writer.printed("driver-2", [b"hello", b"Traceback (most recent call last):", b"E: no"])
    rig.writer.ended("driver-2", 1, is_wanted=False)
    with pytest.raises(SessionDiedError, match=r"driver-2 has failed \(exit code 1\)") as caught:
        rig.session.run_for(1.0)
    assert caught.value.hint == "Traceback (most recent call last):\nE: no"
    assert "driver-2 has ended (exit code 1)" in rig.session.report()


def test_answers_that_nobody_waits_for_are_left_out(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig.session.start()
    monkeypatch.setattr(session, "SECONDS_WITHOUT_ANSWER", 0.02)
    rig.simulator.may_answer.clear()
    with pytest.raises(SessionDiedError, match="has not answered"):
        rig.session.advance(1.0)
    rig.simulator.may_answer.set()
    monkeypatch.setattr(session, "SECONDS_WITHOUT_ANSWER", 60.0)
    assert rig.session.advance(0.5) == 0.5
    assert rig.session.state.seconds == rig.simulator.now
    assert rig.session.advance(0.25) == 0.25


def test_what_was_reported_is_in_the_report(rig: Rig) -> None:
    file = Path("a.launch.py")
    rig.reported.append(
        UNUSED_ARGUMENT.at(file, None, "wrold", message="`wrold` has no effect.", hint="Remove it.")
    )
    rig.reported.append(NO_ROBOT.at(file, message="None.", severity=Severity.INFO))
    rig.session.start()
    rig.reported.append(NO_ROBOT.at(file, message="A ball without a link."))  # while it runs
    assert rig.session.unused_arguments == ("`wrold` has no effect. Remove it.",)
    report = rig.session.report()
    assert "error[SPN003] no-robot: A ball without a link." in report
    assert "None." not in report
    assert "wrold" not in report  # a warning of the test says it


def test_a_report_ends_with_the_lines_of_the_users_nodes(rig: Rig) -> None:
    rig.session.start()
    rig.writer.started("driver-2", os.getpid(), "/driver", OTHER)
    rig.writer.started("bridge-3", os.getpid(), "/bridge", STANDARD)
    rig.writer.printed("driver-2", [b"[INFO] [1.0] [driver]: I see a wall."])
    rig.writer.printed("bridge-3", [b"[INFO] [1.0] [bridge]: Creating a bridge"] * 50)
    assert rig.session.report().endswith(
        "the last lines:\n[driver-2] [INFO] [1.0] [driver]: I see a wall."
    )


def test_who_may_fail_does_no_harm(rig: Rig) -> None:
    rig.session.start()
    rig.writer.started("mapper-2", 1, None, OTHER)
    rig.writer.ended("mapper-2", -11, is_wanted=False)
    rig.session.run_for(1.0)


def test_a_launch_that_ends_is_an_error(rig: Rig) -> None:
    rig.session.start()
    rig.writer.printed("launch", [b"[ERROR] [launch]: Caught exception"])
    rig.service.code = 1
    with pytest.raises(SessionDiedError, match=r"launch has ended \(exit code 1\)") as caught:
        rig.session.run_for(1.0)
    assert "Caught exception" in caught.value.hint


def without_simulator(folder: Path, code: int) -> LiveSession:
    """A session whose launch service has ended with a code."""
    service = Service()
    service.code = code
    return LiveSession(
        folder, cast("ServiceChild", service), cast("LiveMessenger", Messenger()), entities=()
    )


def test_a_launch_that_ends_before_its_simulator_leaves_no_connection(tmp_path: Path) -> None:
    def descriptors() -> int:
        return len(list(Path("/proc/self/fd").iterdir()))

    made = without_simulator(tmp_path, code=1)
    before = descriptors()
    with pytest.raises(SessionDiedError) as caught:  # whose frames may hold what is open
        made.start()
    made.close()
    assert descriptors() == before
    assert caught.value.message == "The launch has ended (exit code 1)."


def test_what_the_launch_service_has_printed_last_says_why_it_has_ended(tmp_path: Path) -> None:
    made = without_simulator(tmp_path, code=-9)
    with pytest.raises(SessionDiedError, match=r"ended \(SIGKILL\)") as caught:
        made.check()
    assert caught.value.hint.startswith("Look at what was printed")
    (tmp_path / session.ERRORS_FILE).write_text("Traceback\nMemoryError\n")
    with pytest.raises(SessionDiedError) as caught:
        made.check()
    assert caught.value.hint == "Traceback\nMemoryError"


def test_why_the_process_with_rclpy_has_ended_is_what_it_has_printed(tmp_path: Path) -> None:
    made = messenger.Messenger(Path(sys.executable), {}, tmp_path / "errors")  # has no rclpy
    try:
        with pytest.raises(SessionDiedError, match="speaks ROS for wsgen has ended") as caught:
            made.ask("nodes")
    finally:
        made.close()
    assert "No module named 'rclpy'" in caught.value.hint


@pytest.mark.slow
def test_a_simulator_that_is_gone_is_an_error(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "SECONDS_TO_END", 0.1)
    rig.session.start()
    rig.simulator.ends_at = 1.0
    with pytest.raises(SessionDiedError, match="simulator has ended"):
        rig.session.run_for(3.0)


@pytest.mark.slow
def test_a_simulator_that_hangs_is_an_error(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    rig.session.start()
    monkeypatch.setattr(session, "SECONDS_WITHOUT_ANSWER", 0.1)
    rig.simulator.hangs = True
    with pytest.raises(SessionDiedError, match="has not answered for"):
        rig.session.run_for(3.0)


@pytest.mark.slow
def test_a_pause_without_end_is_an_error(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    rig.session.start()
    monkeypatch.setattr(session, "SECONDS_AT_REST", 0.1)
    rig.simulator.is_paused = True
    with pytest.raises(SessionDiedError, match="has been paused"):
        rig.session.run_for(3.0)


def test_a_robot_that_does_not_come_is_an_error(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "SECONDS_TO_START", 0.2)
    rig.session.entities = ("rover", "arm")
    with pytest.raises(SessionDiedError, match="`arm` was not spawned"):
        rig.session.start()


@pytest.mark.slow
def test_a_robot_of_nodes_is_waited_for(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "SECONDS_TO_SPAWN", 0.2)
    rig.session.start()
    rig.session.wait_for_robot()
    rig.session.wait_for_robot("rover")
    with pytest.raises(
        SessionDiedError, match=r"No robot `arm` was spawned .* world: `wall`, `rover`"
    ):
        rig.session.wait_for_robot("arm")


@pytest.mark.slow
def test_a_robot_that_is_assumed_may_have_another_name(rig: Rig) -> None:
    rig.session.entities, rig.session.assumed = (), ("truck",)
    rig.session.start()
    assert "rover" in rig.session.state.poses


def test_a_robot_that_is_assumed_is_awaited_once_its_spawner_has_joined(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A spawner imports its modules for longer than a robot is awaited; its end starts a node."""
    clock = Clock(rig, monkeypatch)
    monkeypatch.setattr(session, "SECONDS_TO_SPAWN", 0.5)
    monkeypatch.setattr(resources.CpuTimes, "idle", lambda *_: set())
    rig.session.entities, rig.session.assumed = (), ("rover",)
    rig.simulator.robot_comes_at = math.inf
    rig.writer.started("spawner-2", os.getpid(), "/spawner", OTHER)
    begun, joined = clock.now, ["/driver"]

    def ask(do: str, **_: Any) -> dict[str, Any]:
        assert do == "nodes"
        if "/spawner" not in joined and clock.now - begun > 1.0:
            joined.append("/spawner")
            rig.simulator.robot_comes_at = rig.simulator.now + 0.1
        elif rig.session.state.poses and "/planner" not in joined:
            if "planner-3" in rig.session.journal.processes:
                joined.append("/planner")
            else:
                rig.writer.ended("spawner-2", 0, is_wanted=False)
                rig.writer.started("planner-3", os.getpid(), "/planner", OTHER)
        return {"nodes": joined}

    monkeypatch.setattr(rig.session.messenger, "ask", ask)
    rig.session.start()
    assert "rover" in rig.session.state.poses
    assert joined == ["/driver", "/spawner", "/planner"]


# What is measured for behaviors.


def state(seconds: float, x: float, y: float, yaw: float, roll: float = 0.0) -> LiveState:
    half = yaw / 2
    xyzw = (
        (0.0, 0.0, math.sin(half), math.cos(half))
        if not roll
        else (math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2))
    )
    return LiveState.of(
        {
            "seconds": seconds,
            "is_paused": False,
            "entities": ["rover"],
            "poses": {"rover": [x, y, 0.0, *xyzw]},
            "joints": {"rover": {"wheel": 0.1}},
        }
    )


def test_the_way_is_seen_from_where_it_was_spawned() -> None:
    way = Way("rover")
    for number in range(5):
        way.go(state(number, 2.0, float(number), math.pi / 2))
    found = way.measured("goes", 1.0, None)
    assert found.moved == pytest.approx((4.0, 0.0, 0.0))
    assert found.traveled == pytest.approx(4.0)
    assert (found.seconds, found.is_there) == (3.0, True)
    assert found.tilt == pytest.approx(0.0)
    way.go(state(5, 2.0, 3.0, 0.0, roll=1.5))
    assert way.measured("goes", 1.0, None).tilt == pytest.approx(1.5)
    assert way.measured("goes", 1.0, None).traveled == pytest.approx(5.0)


def test_the_way_is_sampled_from_where_the_robot_was_spawned() -> None:
    way = Way("rover", every=1.0)
    for number in range(13):
        way.go(state(number / 4, 2.0, number / 8, math.pi / 2))
    series = way.measured("goes", 0.5, "a node has failed").time_series
    assert series is not None
    assert series.behavior == "goes"
    assert series.heading == pytest.approx(math.pi / 2)
    # Nodes join after half a second; the last state is there, also between two samples.
    assert series.seconds == (-0.5, 0.5, 1.5, 2.5)
    assert series.positions[0] == (2.0, 0.0, 0.0)
    assert series.positions[-1] == (2.0, 1.5, 0.0)
    assert series.speeds == (0.0, 0.5, 0.5, 0.5)
    assert series.joint_positions == {"wheel": (0.1,) * 4}
    way.go(state(3.25, math.nan, 0.0, 0.0))
    assert way.measured("goes", 0.5, None).time_series == series
    assert Way("rover").measured("goes", None, "it did not come").time_series is None


def crowd(seconds: float, **places: float) -> LiveState:
    """A state with several robots, at these x."""
    return LiveState.of(
        {
            "seconds": seconds,
            "is_paused": False,
            "entities": list(places),
            "poses": {name: [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0] for name, x in places.items()},
            "joints": {name: {} for name in places},
        }
    )


def test_the_first_robot_in_the_world_is_looked_at_where_any_is_good() -> None:
    for way in (Way(""), Way("truck")):
        way.take_any()
        way.go(LiveState())
        way.go(crowd(0.5, crate=0.0))
        way.go(crowd(1.0, rover=0.0, arm=0.0))  # the crate is gone when the behavior begins
        way.begin()
        way.go(crowd(2.0, rover=1.0, arm=0.0))
        found = way.measured("goes", 1.0, None)
        assert (found.entity, found.moved) == ("rover", (1.0, 0.0, 0.0))


@pytest.mark.parametrize("begins_at", [0.0, 1.0, 2.0])
def test_the_robot_that_is_assumed_counts_once_it_is_there(begins_at: float) -> None:
    way = Way("rover", every=1.0)
    way.take_any()
    for seconds, places in enumerate(({"crate": 0.0}, {"crate": 0.0, "rover": 5.0})):
        way.go(crowd(float(seconds), **places))
        if begins_at == seconds:
            way.begin()
    way.go(crowd(2.0, crate=0.0, rover=7.0))
    found = way.measured("goes", begins_at, None)
    assert (found.entity, found.moved, found.traveled) == ("rover", (2.0, 0.0, 0.0), 2.0)
    assert found.time_series is not None
    assert found.time_series.positions[0] == (5.0, 0.0, 0.0)


def test_a_robot_that_is_named_is_no_other() -> None:
    way = Way("rover")
    way.go(crowd(0.0, crate=0.0))
    way.begin()
    way.go(crowd(1.0, crate=1.0))
    found = way.measured("goes", 0.0, None)
    assert (found.entity, found.is_there) == ("rover", False)


def test_a_robot_that_is_gone_is_not_there() -> None:
    way = Way("rover")
    assert not way.measured("goes", None, "it did not come").is_there
    way.go(state(0.0, 0.0, 0.0, 0.0))
    way.go(LiveState(seconds=1.0))
    found = way.measured("goes", 0.0, None)
    assert (found.is_there, found.is_finite) == (False, True)
    way = Way("rover")
    for x in (0.0, math.nan):
        way.go(state(0.0, x, 0.0, 0.0))
    found = way.measured("goes", 0.0, None)
    assert (found.is_there, found.is_finite) == (True, False)


def test_what_was_left_out_of_the_run_is_measured(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    @contextlib.contextmanager
    def open_live(*_: object, opened: Callable[[object], None], **__: object) -> Iterator[object]:
        opened(rig.session)
        rig.writer.left_out("amcl of nav2_amcl", "it is not compiled")
        rig.session.start()
        rig.writer.started("wanderer-2", 0, None, OTHER)
        rig.writer.started("bridge-3", 0, None, STANDARD)
        rig.writer.printed("wanderer-2", [b"no way", b"x" * 999])
        rig.writer.printed("bridge-3", [b"[INFO] [1.0] [bridge]: Creating a bridge"] * 50)
        rig.writer.printed("launch", [b"[INFO] [wanderer-2]: process started with pid [7]"])
        yield rig.session

    monkeypatch.setattr(behaviors, "open_live", open_live)
    behavior = Behavior(name="wanders", task=LaunchTask(), seconds=0.1)
    to_run = [BehaviorRun(entity="rover", behavior=behavior)]
    selected = SimpleNamespace(package="rover", file=Path("go.launch.py"))
    found = behaviors.run_live(cast("Any", selected), ValidateRequest(), to_run)
    assert found["wanders"].launched == "rover go.launch.py"
    assert found["wanders"].left_out == {"amcl of nav2_amcl": "it is not compiled"}
    first, second = found["wanders"].printed
    assert first == "[wanderer-2] no way"
    assert (len(second), second[-1]) == (LONGEST_LINE, "…")
    assert found["wanders"].wall_seconds > 0
    assert found["wanders"].time_series is None  # nobody has asked for it


@pytest.mark.parametrize(
    ("described", "named", "waits"),
    [("truck", "truck", ["truck"]), ("lorry", "truck", ["truck"]), ("truck", None, [])],
)
def test_a_behavior_that_names_its_robot_waits_for_it(
    described: str,
    named: str | None,
    waits: list[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """A node spawns a crate, later the truck, which the launch file does not name."""
    awaited: list[str] = []

    @contextlib.contextmanager
    def open_live(
        *_: object, opened: Callable[[object], None], observe: Callable[[LiveState], None]
    ) -> Iterator[object]:
        def wait_for_robot(entity: str) -> None:
            awaited.append(entity)
            observe(crowd(1.0, crate=0.0, truck=0.0))

        def run_for(seconds: float) -> None:
            there = {"truck": 3.0} if awaited else {}
            observe(crowd(1.0 + seconds, crate=1.0, **there))

        live = SimpleNamespace(
            assumed=(described,),
            entities=(),
            spawned=(),
            wall_seconds=1.0,
            journal=Journal(tmp_path),
            state=crowd(1.0),
            wait_for_robot=wait_for_robot,
            run_for=run_for,
        )
        opened(live)
        observe(crowd(0.0, crate=0.0))
        yield live

    monkeypatch.setattr(behaviors, "open_live", open_live)
    behavior = Behavior(name="goes", task=LaunchTask(), seconds=2.0, robot=named)
    selected = SimpleNamespace(package="rover", file=Path("go.launch.py"))
    to_run = [BehaviorRun(entity=described, behavior=behavior)]
    found = behaviors.run_live(cast("Any", selected), ValidateRequest(), to_run)["goes"]
    assert awaited == waits
    expected = ("truck", (3.0, 0.0, 0.0)) if named else ("crate", (1.0, 0.0, 0.0))
    assert (found.entity, found.moved) == expected


def test_the_cause_of_a_failure_is_the_last_line_and_its_place() -> None:
    hint = (
        'Traceback (most recent call last):\n  File "/a/b.py", line 3, in go\n    x\nValueError: no'
    )
    assert _cause(hint, {}) == ": ValueError: no, in /a/b.py:3"
    assert not _cause("[INFO] hello", {})


def test_the_cause_of_a_failure_is_in_the_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    share, source = tmp_path / "install" / "share" / "rover", tmp_path / "src" / "rover"
    for folder in (share, source):
        (folder / "scripts").mkdir(parents=True)
        (folder / "scripts" / "drive.py").write_text("x\n" * 9)
    hint = (
        f'Traceback (most recent call last):\n  File "{share}/scripts/drive.py", line 3, in go\n'
        '    x\n  File "/usr/lib/rclpy.py", line 70, in spin\nValueError: no'
    )
    expected = ": ValueError: no, in line 3 of src/rover/scripts/drive.py"
    assert _cause(hint, {share: source}) == expected
