"""Child processes: their answers, and every way in which they die."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from isolation.conftest import GROUPED, GUARDED, Run, Task
from isolation.processes import is_alive, wait_while
from wsgen.errors import NotReadableError
from wsgen.isolation import parent
from wsgen.isolation.result import Answered, Died, Limits, describe_exit

pytestmark = pytest.mark.slow
BUSY = 600.0  # s, wall-clock, for what ends by another limit, on a busy machine


def test_arguments_go_there_and_the_value_comes_back(run: Run, task: Task) -> None:
    answer = run(task("return {'sum': sum(arguments)}"), 1, 2, 3)
    assert isinstance(answer, Answered)
    assert answer.value == {"sum": 6}


def test_what_is_printed_does_not_disturb_the_answer(run: Run, task: Task) -> None:
    answer = run(task("import os\nprint('{')\nos.write(1, b'from C')\nreturn 1"))
    assert isinstance(answer, Answered)
    assert answer.value == 1
    assert "from C" in answer.output


def test_standard_input_is_at_its_end(run: Run, task: Task) -> None:
    answer = run(task("import sys\nreturn sys.stdin.read()"))
    assert isinstance(answer, Answered)
    assert answer.value == ""


def test_the_environment_is_the_one_given(run: Run, task: Task) -> None:
    answer = run(
        task("import os\nreturn [os.environ.get('A'), os.environ.get('HOME')]"),
        environment={"A": "b"},
    )
    assert isinstance(answer, Answered)
    assert answer.value == ["b", None]


def test_the_overlays_modules_come_after_wsgens(run: Run, task: Task, tmp_path: Path) -> None:
    overlay = tmp_path / "overlay"
    overlay.mkdir()
    (overlay / "only_there.py").write_text("answer = 42\n")
    (overlay / "pathlib.py").write_text("raise SystemExit('another interpreter')\n")
    answer = run(
        task("import only_there, pathlib\nreturn only_there.answer"),
        environment={"PYTHONPATH": str(overlay)},
    )
    assert isinstance(answer, Answered)
    assert answer.value == 42


def test_wsgen_itself_looks_into_pythonpath_last(tmp_path: Path) -> None:
    (tmp_path / "lxml").mkdir()
    (tmp_path / "lxml" / "__init__.py").write_text("raise SystemExit('of another Python')\n")
    (tmp_path / "xacro.py").write_text("raise SystemExit('of another Python')\n")
    script = (
        "import sys; from wsgen.cli import main\n"
        "try: main(['--version'])\n"
        "except SystemExit: import lxml.etree, xacro\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr


def test_a_crash_says_signal_and_step(run: Run, task: Task) -> None:
    died = run(
        task(
            """
            import os
            from wsgen.isolation.child import announce
            announce("load r2d2")
            print("last words", flush=True)
            os.abort()
            """
        )
    )
    assert isinstance(died, Died)
    assert (died.reason, died.step, died.output) == ("crashed (SIGABRT)", "load r2d2", "last words")


@GUARDED
def test_a_child_that_stops_itself_is_ended_soon(run: Run, task: Task) -> None:
    died = run(task("import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)"))
    assert isinstance(died, Died)
    assert died.reason == "was stopped by SIGSTOP, and nothing would have continued it"
    assert died.hint("Look.") == "Look for what sends SIGSTOP to its own process."


@GUARDED
def test_a_child_that_is_continued_goes_on(run: Run, task: Task) -> None:
    text = """
        import os, signal, subprocess
        again = f"while kill -CONT {os.getpid()}; do sleep 0.05; done"
        subprocess.Popen(["sh", "-c", again], stderr=subprocess.DEVNULL)
        os.kill(os.getpid(), signal.SIGSTOP)
        """
    assert isinstance(run(task(text)), Answered)


def test_a_child_that_hangs_is_ended_with_its_own_children(
    run: Run, task: Task, tmp_path: Path
) -> None:
    pid_file = tmp_path / "pid"
    died = run(
        task(
            f"""
            import subprocess, time
            child = subprocess.Popen(["sleep", "600"])
            open({str(pid_file)!r}, "w").write(str(child.pid))
            time.sleep(600)
            """
        ),
        limits=Limits(seconds=60, wall_clock=5),
    )
    assert isinstance(died, Died)
    assert died.reason == "did not end within 5 s (it waits for something, or the machine is busy)"
    assert "less busy" in died.hint("Look for a loop.")
    if pid_file.exists():  # on a very busy machine it did not get so far
        wait_while(lambda: is_alive(int(pid_file.read_text())))


def test_a_child_that_computes_for_ever(run: Run, task: Task) -> None:
    before = os.times()
    died = run(task("while True:\n    pass"), limits=Limits(seconds=0.4, wall_clock=BUSY))
    after = os.times()
    assert isinstance(died, Died)
    assert died.reason == "used more than 0.4 s of CPU time"
    assert died.cause == "cpu time"
    assert died.hint("Look for a loop.") == "Look for a loop."
    if run is parent.run:  # a fork server's server waits for them
        assert after.children_user - before.children_user < 5


@GUARDED
@pytest.mark.parametrize("is_reaped", [False, True])
def test_what_the_child_starts_computes_for_it(run: Run, task: Task, is_reaped: bool) -> None:
    """No process of them is over the limit; all of them are."""
    loop = "import resource\nwhile resource.getrusage(0).ru_utime < 0.25: pass"
    how = "subprocess.run" if is_reaped else "subprocess.Popen"
    died = run(
        task(
            f"""
            import subprocess, sys, time
            for _ in range(8):
                {how}([sys.executable, "-c", {loop!r}])
            time.sleep(600)
            """
        ),
        limits=Limits(seconds=1, wall_clock=BUSY),
    )
    assert isinstance(died, Died)
    assert died.reason == "used more than 1 s of CPU time"


@GUARDED
def test_orphans_that_end_do_not_put_off_the_limit(run: Run, task: Task) -> None:
    """Those whose parent has gone are the guard's to reap, and wake it."""
    loop = "import resource\nwhile resource.getrusage(0).ru_utime < 0.5: pass"
    died = run(
        task(
            f"""
            import subprocess, sys, time
            while True:
                subprocess.Popen([sys.executable, "-c", {loop!r}])
                subprocess.run(["/bin/sh", "-c", "sleep 0.01 & sleep 0.02 & true"])
                time.sleep(0.1)
            """
        ),
        limits=Limits(seconds=1, wall_clock=BUSY),
    )
    assert isinstance(died, Died)
    assert died.reason == "used more than 1 s of CPU time"


def test_code_that_lets_no_thread_of_the_child_run(
    run: Run, task: Task, request: pytest.FixtureRequest
) -> None:
    is_windows = "windows" in request.node.name
    limits = Limits(seconds=1, wall_clock=2 if is_windows else BUSY)
    died = run(task("return sum(range(10**15))"), limits=limits)
    assert isinstance(died, Died)
    assert died.cause == ("wall-clock time" if is_windows else "cpu time")


def test_who_waits_does_not_compute(run: Run, task: Task) -> None:
    limits = Limits(seconds=1, wall_clock=BUSY)
    answer = run(task("import time\ntime.sleep(1.5)\nreturn 1"), limits=limits)
    assert isinstance(answer, Answered)


@GUARDED
@pytest.mark.parametrize("end", ["return 1", "os.kill(os.getpid(), 11)", "time.sleep(600)"])
def test_a_daemon_ends_with_the_child(run: Run, task: Task, end: str, tmp_path: Path) -> None:
    """It has a session of its own and, its parent gone, no tie to the child."""
    pid_file = tmp_path / "pid"
    start = "import subprocess, sys; print(subprocess.Popen(['sleep', '600'], "
    start += "start_new_session=True, stdout=subprocess.DEVNULL, env={}).pid)"
    run(
        task(
            f"""
            import os, subprocess, sys, time
            pid = subprocess.run([sys.executable, "-c", {start!r}], stdout=subprocess.PIPE).stdout
            open({str(pid_file)!r}, "wb").write(pid)
            {end}
            """
        ),
        limits=Limits(seconds=60, wall_clock=10 if "sleep" in end else BUSY),
    )
    assert not is_alive(int(pid_file.read_text()))


@GUARDED
@pytest.mark.parametrize("number", ["SIGKILL", "SIGTERM", "SIGSTOP"])
def test_a_child_that_ends_its_parent(
    run: Run, task: Task, number: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scratch = tmp_path / "tmp"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    pid_file = tmp_path / "pid"
    died = run(
        task(
            f"""
            import os, signal, time
            open({str(pid_file)!r}, "w").write(str(os.getpid()))
            os.kill(os.getppid(), signal.{number})
            time.sleep(600)
            """
        ),
        limits=Limits(seconds=60, wall_clock=5 if number == "SIGSTOP" else None),
    )
    assert isinstance(died, Died)
    assert number == "SIGSTOP" or died.reason == f"crashed ({number})"
    wait_while(lambda: is_alive(int(pid_file.read_text())))
    assert len(list(scratch.iterdir())) == (run is not parent.run)  # the server's


@pytest.mark.parametrize("swallow", [False, True])
def test_a_child_that_prints_for_ever(run: Run, task: Task, swallow: bool) -> None:
    died = run(
        task(
            f"""
            import contextlib
            while True:
                with contextlib.suppress(*{"[OSError]" if swallow else "[]"}):
                    print("no end " * 10_000)
            """
        )
    )
    assert isinstance(died, Died)
    assert died.reason == "wrote more than 64 MB to its output or to a file"
    assert died.hint("") == "Look for a loop that prints or writes without end."


@GROUPED
def test_a_child_that_eats_memory(run: Run, task: Task) -> None:
    died = run(task("x = bytearray(3 * 2**30)\nreturn len(x)"), limits=Limits(memory=2**30))
    assert isinstance(died, Died)
    assert died.reason == "exceeded its memory limit"


def test_the_watcher_sees_the_memory_that_macos_does_not_limit(tmp_path: Path) -> None:
    script = """
import os, sys, time
from wsgen.isolation import child
request = {"cpu_seconds": 60, "output": 0, "memory": 2**28, "scratch": sys.argv[1]}
child.watch(request, lambda cause: (print(cause, flush=True), os._exit(0)))
time.sleep(0.2)
print("begins", flush=True)
eaten = b"x" * 2**29
time.sleep(60)
"""
    (tmp_path / "output").touch()
    # Linux counts the memory of the process that starts a program as the program's; here that is a
    # shell, not the process of all tests.
    command = ["sh", "-c", '"$@"; exit', "sh", sys.executable, "-c", script, str(tmp_path)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.stdout.split() == ["begins", "memory"]


def test_windows_limits_with_what_it_has(windows_like: Path) -> None:
    """The tests of `run` with it are about what they say."""
    script = """
import sys
from wsgen.isolation import child, parent, system
print(child.resource, system.has_guards(), hasattr(child.signal, "SIGXFSZ"))
print(parent.UTF_8, sys.platform)
"""
    ended = subprocess.run([windows_like, "-c", script], capture_output=True, text=True, check=True)
    assert ended.stdout.splitlines() == [
        "None False False",
        f"('-X', 'utf8') {sys.platform}",
    ]


@pytest.mark.parametrize(
    ("code", "how"),
    [
        (0xC0000005, "crashed (0xC0000005)"),  # an access violation, on Windows
        (-11, "crashed (SIGSEGV)"),
        (3, "ended with exit code 3 and no answer"),
    ],
)
def test_how_a_process_ended(code: int, how: str) -> None:
    assert describe_exit(code) == how


def test_an_exception_is_an_answer_too(run: Run, task: Task) -> None:
    died = run(task("raise ValueError('no')"))
    assert isinstance(died, Died)
    assert died.reason == "failed (ValueError: no)"
    assert "Traceback" in died.output


@pytest.mark.parametrize("name", ["GeneratorExit", "KeyboardInterrupt", "Own"])
def test_what_is_no_exception_is_an_answer_too(run: Run, task: Task, name: str) -> None:
    died = run(task(f"raise {name}", before="class Own(BaseException): pass"))
    assert isinstance(died, Died)
    assert died.reason == f"failed ({name}: )"


def test_a_child_that_leaves_by_itself(run: Run, task: Task) -> None:
    died = run(task("import os\nos._exit(7)"))
    assert isinstance(died, Died)
    assert died.reason == "ended with exit code 7 and no answer"


def test_a_value_that_json_cannot_hold(run: Run, task: Task) -> None:
    died = run(task("return {1, 2}"))
    assert isinstance(died, Died)
    assert "TypeError" in died.reason


def test_a_child_that_exits(run: Run, task: Task) -> None:
    died = run(task("import sys\nprint('no robot')\nsys.exit(3)"))
    assert isinstance(died, Died)
    assert died.reason == "ended with exit code 3 and no answer"
    assert died.output == "no robot"


@GROUPED
@pytest.mark.parametrize("end", ["return os.getpid()", "os.kill(os.getpid(), 11)"])
def test_what_the_child_started_ends_with_it(
    run: Run, task: Task, end: str, tmp_path: Path
) -> None:
    pid_file = tmp_path / "pid"
    run(
        task(
            f"""
            import os, subprocess
            child = subprocess.Popen(["sleep", "600"])
            open({str(pid_file)!r}, "w").write(str(child.pid))
            {end}
            """
        )
    )
    wait_while(lambda: is_alive(int(pid_file.read_text())))


@pytest.mark.parametrize("before", ["raise OSError('no')", "import absent_module"])
def test_a_module_that_cannot_be_imported(run: Run, task: Task, before: str) -> None:
    died = run(task("return 1", before=before))
    assert isinstance(died, Died)
    assert died.reason.startswith(("failed (OSError: no)", "failed (ModuleNotFoundError: "))
    assert "Traceback" in died.output


def test_the_folder_is_the_one_given(
    run: Run, task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    where = task("import os\nreturn os.getcwd()")
    (tmp_path / "below").mkdir()
    for folder, expected in ((None, tmp_path), (Path("below"), tmp_path / "below")):
        monkeypatch.chdir(tmp_path)
        answer = run(where, folder=folder)
        assert isinstance(answer, Answered)
        assert answer.value == str(expected)
        monkeypatch.chdir("/")


def test_a_folder_that_is_not_there(run: Run, task: Task, tmp_path: Path) -> None:
    with pytest.raises(NotReadableError, match="could not be started: No such file"):
        run(task("return 1"), folder=tmp_path / "absent")


def test_large_arguments_and_a_large_answer(run: Run, task: Task) -> None:
    argument = b"robot" * 10 * 2**20
    answer = run(
        task("return [len(arguments[0]), arguments[0][:5].decode() * 4 * 2**20]"), argument
    )
    assert isinstance(answer, Answered)
    assert answer.value == [len(argument), "robot" * 4 * 2**20]


def test_nothing_is_left_in_the_temporary_folder(
    run: Run, task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scratch = tmp_path / "tmp"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    name = task("import os\nif arguments:\n    os.abort()\nreturn 1")
    run(name)
    # A fork server keeps a folder for its server until it is closed.
    kept = list(scratch.iterdir())
    assert len(kept) == (run is not parent.run)
    run(name, "abort")
    assert list(scratch.iterdir()) == kept


def test_a_disk_that_has_no_room_for_an_answer(
    run: Run, task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = os.statvfs_result((4096, 4096, 1000, 1, 1, 1000, 500, 500, 0, 255))
    monkeypatch.setattr(os, "statvfs", lambda _folder: full)
    for body in ("import os\nos._exit(1)", "raise OSError(28, 'No space left on device')"):
        with pytest.raises(NotReadableError, match="Cannot write a temporary file: the disk is"):
            run(task(body))
    answer = run(task("return 1"))  # there was room enough
    assert isinstance(answer, Answered)
