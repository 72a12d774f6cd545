"""A node that dies with a traceback: wsgen names the source of the line."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.live.journal import FailedProgram, read_failures
from wsgen.live.python_failures import CHAINED, MOST_SECONDS_AFTER, LastTraceback, explain_source

if TYPE_CHECKING:
    from collections.abc import Callable

    from live_launch import Launch

MANIFEST = """<package format="3"><name>rover</name><version>0.0.0</version>
<description>d</description><maintainer email="a@b.c">m</maintainer><license>MIT</license>
<export><build_type>ament_cmake</build_type></export></package>"""
CMAKE = """
cmake_minimum_required(VERSION 3.20)
project(rover LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
install(PROGRAMS scripts/driver.py scripts/wrong.py DESTINATION lib/rover)
ament_package()
"""
PROGRAMS = {
    "driver.py": "import json\njson.loads('{')\n",
    "wrong.py": "import sys\nspeed = = 1\n",
}
NODES = """
return LaunchDescription([
    ExecuteProcess(cmd=['python3', {driver!r}], name='driver', output='screen', respawn=True,
                   respawn_max_retries=1),
    ExecuteProcess(cmd=['python3', {wrong!r}], name='wrong', output='screen'),
    python("raise ValueError", name='other'),
])
"""


def test_frames_are_those_of_tracebacks() -> None:
    frames = LastTraceback()
    frames.take(b'Traceback:\n  File "/a/b.py", line 3, in go\n    go()\nKeyError: 1\n')
    frames.take(b'  File "/a/c d.py", line 12\r\n    x = = 1\nSyntaxError: invalid syntax\n')
    frames.take(b'[INFO]   File "/a/e.py", line 3\n')
    found = [(str(file), line) for file, line in frames.innermost_first()]
    assert found == [("/a/c d.py", 12)]
    frames.take(b'  File "/a/f.py", line ' + b"1" * 5000 + b"\n")
    assert next(iter(frames.innermost_first()))[0] == Path("/a/c d.py")


CAUSE, OTHER = (
    b'%sTraceback (most recent call last):\n  File "/a/b.py", line %d, in go\n    go()\nKeyError\n'
    % where
    for where in ((b"", 3), (b"[ERROR] [node]: ", 4))
)


@pytest.mark.parametrize(
    ("printed", "lines"),
    [
        ([CAUSE], [3]),
        ([CAUSE, OTHER], [4]),
        ([CAUSE, b"\n" + CHAINED[0] + b"\n\n", OTHER], [4, 3]),
        ([CAUSE, b"\n" + CHAINED[1] + b"\n\n" + OTHER], [4, 3]),
        ([CAUSE, b"\n" + CHAINED[1] + b"\n\n" + OTHER + CAUSE], [3]),
        ([CAUSE, b"terminate called\n  what():  no context\n", b"a line\n" * 8], [3]),
        ([CAUSE, b"[INFO] [node]: on it goes\n" * 10], []),
        ([b"[INFO] [node]: on it goes\n" * 100, CAUSE], [3]),
    ],
)
def test_frames_are_those_of_what_has_ended_the_program(
    printed: list[bytes], lines: list[int]
) -> None:
    frames = LastTraceback()
    for one in printed:
        frames.take(one)
    assert [line for _, line in frames.innermost_first()] == lines
    assert (b"KeyError" in frames.said()) == bool(lines)


def test_a_program_that_runs_on_has_handled_its_exception(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr("wsgen.live.python_failures.time.monotonic", lambda: now)
    frames = LastTraceback()
    frames.take(CAUSE)
    now += MOST_SECONDS_AFTER
    assert list(frames.innermost_first())
    now += 1.0
    assert not list(frames.innermost_first())
    frames.take(CAUSE)
    assert list(frames.innermost_first())


def test_what_a_program_prints_need_not_be_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "src" / "driver.py"
    source.parent.mkdir()
    source.write_text("", encoding="utf-8")
    link, loop, here = tmp_path / "driver.py", tmp_path / "loop", tmp_path / "here"
    link.symlink_to(source)
    loop.symlink_to(loop)
    shares = {tmp_path / "install" / "share" / "rover": source.parent}
    wrong = [(Path("/a\0b"), 1), (loop, 1), (Path("<string>"), 1)]
    assert explain_source(wrong, shares) is None
    monkeypatch.chdir(tmp_path)
    found = explain_source([*wrong, (link, 2)], shares)
    assert found == "line 2 of driver.py is line 2 of src/driver.py: correct it there"
    here.mkdir()
    monkeypatch.chdir(here)
    here.rmdir()
    assert f"line 2 of {source}" in (explain_source([(link, 2)], shares) or "")


@pytest.mark.slow
def test_the_source_of_a_mistake_is_named_once(
    launch: Callable[..., Launch], tmp_path: Path
) -> None:
    source, prefix = tmp_path / "src" / "rover", tmp_path / "install"
    share, programs = prefix / "share" / "rover", prefix / "lib" / "rover"
    for folder in (source / "scripts", share, programs):
        folder.mkdir(parents=True)
    (source / "package.xml").write_text(MANIFEST, encoding="utf-8")
    (source / "CMakeLists.txt").write_text(CMAKE, encoding="utf-8")
    for name, text in PROGRAMS.items():
        (source / "scripts" / name).write_text(text, encoding="utf-8")
        shutil.copy2(source / "scripts" / name, programs / name)
    nodes = {name.removesuffix(".py"): str(programs / name) for name in PROGRAMS}
    run = launch(NODES.format(**nodes), sources={str(share): str(source)})
    run.wait()
    assert "[ERROR] [other-3]: process has died" in run.output
    assert run.output.count("[ERROR] [driver-1]: process has died") == 2
    assert sorted(line for line in run.lines if "correct it there" in line) == [
        f"[ERROR] [{name}]: line 2 of {file} is line 2 of {source}/scripts/{file}: correct it "
        "there, and run `wsgen build`"
        for name, file in (("driver-1", "driver.py"), ("wrong-2", "wrong.py"))
    ]
    places = {name: f"line 2 of {source}/scripts/{name}.py" for name in ("driver", "wrong")}
    failed = sorted(read_failures(run.live), key=lambda one: one.name)
    assert failed == [
        FailedProgram(name="driver", place=places["driver"]),
        FailedProgram(name="other"),
        FailedProgram(name="wrong", place=places["wrong"]),
    ]


ENDS = """
again = '''
import pathlib, sys
mark = pathlib.Path({mark!r})
if not mark.exists():
    mark.touch()
    sys.exit(1)
'''
return LaunchDescription([
    python(again, name='again', respawn=True, respawn_max_retries=1),
    python("import no_such_module", name='importer'),
    python("import os; os.abort()", name='aborter'),
    python("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", name='killed'),
    python("pass", name='fine'),
    python('''
        import time
        try:
            print("here", flush=True)
            time.sleep(300)
        except KeyboardInterrupt:
            raise SystemExit(1)
        ''', name='sleeper'),
])
"""


@pytest.mark.slow
def test_who_has_died_by_itself_is_noted(launch: Callable[..., Launch], tmp_path: Path) -> None:
    run = launch(ENDS.format(mark=str(tmp_path / "mark")))
    for name in ("again-1", "fine-5"):
        run.wait_for(f"[{name}]: process has finished cleanly")
    for name in ("importer-2", "aborter-3", "killed-4"):
        run.wait_for(f"[{name}]: process has died")
    run.wait_for("here")
    run.interrupt()
    run.wait()
    assert "[sleeper-6]: process has died" in run.output
    assert sorted(read_failures(run.live), key=lambda one: one.name) == [
        FailedProgram(name="aborter"),
        FailedProgram(name="importer", missing_module="no_such_module"),
    ]
