"""How a launch ends, and that nothing is left."""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from live_launch import is_alive, wait_until
from wsgen.live.service import SECONDS_TO_SIMULATE
from wsgen.simulation.live_runs import ENDED_FILE

if TYPE_CHECKING:
    from collections.abc import Callable

    from live_launch import Launch

# It tells of itself and of a grandchild that has left group and session.
WITH_GRANDCHILD = """
        code = '''
import os, subprocess, sys, time
child = subprocess.Popen(['sleep', '1000'], start_new_session=True)
print('pid', child.pid, 'is a grandchild', flush=True)
time.sleep(1000)
'''
        return LaunchDescription([python(code, name='one'), python(code, name='two')])
"""
STUBBORN = """
        code = '''
import signal, time
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda *_: print('no', flush=True))
print('ready', flush=True)
while True:
    time.sleep(0.01)
'''
        return LaunchDescription([
            python(code, sigterm_timeout='3', sigkill_timeout=LaunchConfiguration('kill')),
            ExecuteProcess(cmd=['sleep', '100']),
        ])
"""


def _wait_for_grandchildren(run: Launch) -> list[int]:
    wait_until(lambda: run.output.count("is a grandchild") == 2, lambda: run.output)
    pids = run.pids()
    assert len(pids) == 4
    assert all(map(is_alive, pids))
    return pids


@pytest.mark.slow
def test_ctrl_c_ends_all_and_is_no_failure(launch: Callable[..., Launch]) -> None:
    run = launch(WITH_GRANDCHILD)
    pids = _wait_for_grandchildren(run)
    run.interrupt()
    assert run.wait() == 0
    assert "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)" in run.lines
    assert "exit code -2" in run.output
    assert "sending signal" not in run.output  # the terminal did, as far as launch knows
    assert not any(map(is_alive, pids))


@pytest.mark.slow
def test_what_does_not_end_is_reported_again_and_killed(launch: Callable[..., Launch]) -> None:
    run = launch(STUBBORN, arguments={"kill": "0.3"})
    run.wait_for("ready")
    ended = run.live / ENDED_FILE
    assert not ended.exists()
    run.interrupt()
    run.wait_for("[node-1] no")
    assert ended.exists()  # what is left of it is nothing to look for
    run.interrupt()
    assert run.wait() == 0
    again = "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT) again, ignoring..."
    failed = (
        "[ERROR] [node-1]: process[node-1] failed to terminate '{}' seconds after receiving '{}', "
        "escalating to '{}'"
    )
    order = [
        again,
        failed.format("3", "SIGINT", "SIGTERM"),
        "[INFO] [node-1]: sending signal 'SIGTERM' to process[node-1]",
        failed.format("3.3", "SIGTERM", "SIGKILL"),
        "[INFO] [node-1]: sending signal 'SIGKILL' to process[node-1]",
    ]
    assert [line for line in run.lines if line in order] == order
    assert "exit code -9" in run.output


@pytest.mark.slow
def test_a_launch_that_is_terminated_ends_its_processes_in_order(
    launch: Callable[..., Launch],
) -> None:
    run = launch(WITH_GRANDCHILD)
    pids = _wait_for_grandchildren(run)
    run.process.terminate()
    assert run.wait() == 128 + signal.SIGTERM
    assert run.output.index("SIGINT' to process[two-2]") < run.output.index("process[one-1]")
    assert not any(map(is_alive, pids))


@pytest.mark.slow
@pytest.mark.parametrize("victim", ["wsgen", "guard", "service"])
def test_nothing_outlives_a_process_that_is_killed(
    launch: Callable[..., Launch], victim: str
) -> None:
    run = launch(WITH_GRANDCHILD)
    pids = _wait_for_grandchildren(run)
    guard = _children_of(run.process.pid)[0]
    service = _children_of(guard)[0]
    os.kill({"wsgen": run.process.pid, "guard": guard, "service": service}[victim], signal.SIGKILL)
    everybody = [*pids, guard, service]
    # On a machine that has nothing else to do it takes a few milliseconds.
    wait_until(lambda: not any(map(is_alive, everybody)), lambda: f"some of {everybody} live")
    run.wait()


@pytest.mark.slow
def test_a_second_terminal_may_be_closed(launch: Callable[..., Launch]) -> None:
    run = launch(WITH_GRANDCHILD)
    pids = _wait_for_grandchildren(run)
    run.process.send_signal(signal.SIGHUP)
    run.wait()
    assert not any(map(is_alive, pids))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 128 + signal.SIGTERM)]
)
def test_a_launch_ends_though_nobody_reads_what_it_prints(
    launch: Callable[..., Launch], number: int, code: int
) -> None:
    run = launch(
        """
        import os
        ours, theirs = os.pipe()
        os.dup2(theirs, 1)  # nobody reads this
        return LaunchDescription([ExecuteProcess(cmd=['yes'], output='screen')])
        """
    )
    warning = "process prints more than"  # then as much waits as may wait
    wait_until(
        lambda: any(warning in one.read_text() for one in run.logs.rglob("*.log")),
        lambda: run.output,
    )
    time.sleep(0.1)
    run.process.send_signal(number)
    assert run.wait() == code


def _children_of(pid: int) -> list[int]:
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdecimal():
            with suppress(OSError):
                text = (folder / "stat").read_text(encoding="utf-8")
                if int(text.rpartition(") ")[2].split()[1]) == pid:
                    found.append(int(folder.name))
    return found


@pytest.mark.slow
def test_a_simulator_that_never_starts_ends_a_limited_run(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        waits = python("import time; time.sleep(1000)")
        after = OnProcessExit(target_action=waits, on_exit=[ExecuteProcess(cmd=['gzserver'])])
        return LaunchDescription([waits, RegisterEventHandler(after)])
        """,
        awaits_simulator=True,
        seconds=1.0 - SECONDS_TO_SIMULATE,
    )
    assert run.wait() == 1
    assert "the simulator is not started within 1 s, and --for counts its time" in run.output
