"""Where the output of processes goes."""

from __future__ import annotations

import os
import threading
import time
from typing import TYPE_CHECKING, Any

import pytest

from live_launch import Launch
from wsgen.live.process import (
    PRINTED_AT_ONCE,
    Budget,
    LineFormat,
    LogFiles,
    Output,
    Screen,
    destinations,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

BOTH = "import sys; print('out'); sys.stderr.write('err\\n')"


@pytest.mark.slow
def test_output_goes_where_launch_sends_it(launch: Callable[..., Launch]) -> None:
    run = launch(
        f"""
        code = {BOTH!r}
        return LaunchDescription([
            python(code, name='screen', output='screen'),
            python(code, name='log', output='log'),
            python(code, name='both', output='both'),
            python(code, name='own', output={{'stdout': 'own_log', 'both': 'screen'}}),
            python(code, name='formatted', output_format='<{{line}}>'),
        ])
        """
    )
    assert run.wait() == 0
    shown = [line for line in run.lines if not line.startswith(("[INFO]", "[ERROR]"))]
    assert sorted(shown) == sorted(
        [
            *("[screen-1] out", "[screen-1] err", "[log-2] err"),
            *("[both-3] out", "[both-3] err", "[own-4] out", "[own-4] err", "<out>", "<err>"),
        ]
    )
    logged = [line.partition(" ")[2] for line in run.log.splitlines()]
    kept = [line for line in logged if not line.startswith("[INFO]")]
    assert sorted(kept) == ["[both-3] err", "[both-3] out", "[log-2] err", "[log-2] out"]
    assert run.read_log("own-4-stdout.log").endswith(" [own-4] out\n")


@pytest.mark.slow
@pytest.mark.parametrize("form", ["[{bad}] {line}", "{line[3]}", "{this.nothing}", "{", "{line:d}"])
def test_a_format_that_fails_is_named_once(launch: Callable[..., Launch], form: str) -> None:
    run = launch(
        f"""
        return LaunchDescription([python({BOTH!r} + "; print('x')", output_format={form!r}),
                                  ExecuteProcess(cmd=['sleep', '0.1'])])
        """
    )
    assert run.wait() == 0
    assert "[node-1] x" in run.lines
    assert run.output.count(f"[ERROR] [node-1]: output_format {form!r} fails (") == 1
    assert "process has finished cleanly" in run.output


@pytest.mark.slow
def test_a_handler_that_fails_keeps_no_process_from_ending(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        from launch import EventHandler
        def fail(event):
            if isinstance(event, ProcessIO):
                raise ValueError('no such thing')
        return LaunchDescription([
            RegisterEventHandler(EventHandler(matcher=fail)),
            python("print('last words', end='')"),
            ExecuteProcess(cmd=['sleep', '100']),
        ])
        """
    )
    assert run.wait() == 1
    assert "no such thing" in run.output


@pytest.mark.slow
def test_a_process_that_prints_without_end_is_named_and_keeps_nobody_waiting(
    launch: Callable[..., Launch],
) -> None:
    run = launch(
        """
        code = '''
import os, sys, time
while not os.path.exists(sys.argv[1]):
    time.sleep(0.01)
print('the other one')
'''
        go = os.path.join(os.path.dirname(__file__), 'go')
        end = python(code, go, name='other', on_exit=Shutdown())
        return LaunchDescription([ExecuteProcess(cmd=['yes'], output='screen'), end])
        """
    )
    run.wait_for("[WARNING] [yes-1]: process prints more than 256 kB a second")
    (run.live.parent / "go").touch()
    assert run.wait() == 0
    assert run.lines.count("[other-2] the other one") == 1
    assert run.screen.stat().st_size < 8 * PRINTED_AT_ONCE  # with the name before each line


@pytest.mark.slow
def test_a_screen_that_nobody_reads_keeps_no_process_running(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        import os
        ours, theirs = os.pipe()
        os.dup2(theirs, 1)  # nobody reads this
        return LaunchDescription([ExecuteProcess(cmd=['yes'], output='screen'),
                                  TimerAction(period=1.0, actions=[Shutdown()])])
        """
    )
    assert run.wait() == 0


@pytest.mark.slow
def test_long_lines_and_lines_without_end(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        return LaunchDescription([
            python("import sys; sys.stdout.buffer.write(b'x' * 200000 + b'\\\\xff\\\\n')")])
        """
    )
    assert run.wait() == 0
    parts = [line for line in run.lines if line.startswith("[node-1] x")]
    assert sum(line.count("x") for line in parts) == 200000
    assert max(map(len, parts)) < 70000


@pytest.mark.parametrize(
    "config", ["nowhere", {"stdin": "screen"}, {"stdout": {"printer"}}, {"both": "terminal"}]
)
def test_other_destinations_are_refused(config: Any) -> None:
    with pytest.raises(ValueError, match="is not a valid"):
        destinations(config)


def test_a_process_may_print_much_at_once_and_little_for_long() -> None:
    budget = Budget()
    half = b"x" * (PRINTED_AT_ONCE // 2)
    assert not budget.spend(half)
    assert not budget.is_spent
    assert budget.spend(half + b"\n" * 1000)
    assert budget.is_spent
    assert not budget.spend(half)  # it is named once


class _Start:
    output = "screen"
    output_format = None
    is_cached = False
    action = None


def test_listeners_hear_whole_lines() -> None:
    start: Any = _Start()
    nothing: Any = None  # it writes nothing
    form = LineFormat("node-1", start)
    output = Output(form, 1, start=start, screen=nothing, logs=nothing)
    assert output.hear(b"hel") == b""
    assert output.hear(b"lo\nwor") == b"hello\n"
    assert output.hear(b"", is_last=True) == b"wor"
    assert output.hear(b"", is_last=True) == b""


def test_a_log_is_not_larger_than_it_may_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.live.process.LARGEST_LOG", 100)
    logs = LogFiles(tmp_path)
    for _ in range(100):
        logs.write("launch.log", b"\x1b[31mtwenty characters 12\x1b[0m")
        logs.write("launch.log", b"short")
    logs.close()
    text = (tmp_path / "launch.log").read_text()
    assert len(text) < 200
    assert text.endswith("The log ends here: it would become too large.\n")
    assert "\x1b" not in text


def test_a_screen_that_does_not_wait_is_waited_for() -> None:
    ours, theirs = os.pipe()
    os.set_blocking(theirs, False)
    screen = Screen(theirs, is_colored=False)
    line = b"x" * 1023
    for _ in range(200):  # more than a pipe holds
        screen.write(line)
    time.sleep(0.1)
    read = 0
    while read < 200 * 1024:
        read += len(os.read(ours, 1 << 16))
    screen.close()
    os.close(ours)
    os.close(theirs)


@pytest.mark.slow
def test_the_last_lines_are_written_as_long_as_somebody_reads_them() -> None:
    ours, theirs = os.pipe()
    screen = Screen(theirs, is_colored=False)
    write_some, has_begun = screen._write_some, threading.Event()

    def write_late(data: memoryview) -> int:
        """As on a machine that has no time for the thread."""
        if not has_begun.is_set():
            has_begun.set()
            time.sleep(0.5)
        return write_some(data)

    screen._write_some = write_late  # type: ignore[method-assign]
    screen.write(b"last words")
    assert has_begun.wait(60)
    screen.close(0.1)
    assert os.read(ours, 100) == b"last words\n"
    for end in (ours, theirs):
        os.close(end)


def test_lines_that_nobody_reads_are_given_up() -> None:
    ours, theirs = os.pipe()
    screen = Screen(theirs, is_colored=False)
    screen.write(b"x" * (1 << 20))  # more than a pipe holds
    screen.close(0.1)
    assert screen._thread.is_alive()
    read = 0
    while read <= 1 << 20:
        read += len(os.read(ours, 1 << 16))
    screen._thread.join(60)
    for end in (ours, theirs):
        os.close(end)


@pytest.mark.slow
def test_nodes_run_where_logs_cannot_be_kept(tmp_path: Path) -> None:
    (tmp_path / "logs").write_text("a file in the place of the folder")
    run = Launch(
        """
        return LaunchDescription([
            python("import os; print(os.path.isdir(os.environ['ROS_LOG_DIR']))"),
        ])
        """,
        tmp_path,
    )
    assert run.wait() == 0
    assert "[node-1] True" in run.lines
    (warning,) = [line for line in run.lines if line.startswith("[WARNING] [launch]")]
    assert f"Logs are not kept: their folder cannot be written, {tmp_path / 'logs'}" in warning
