"""Child processes: their answers, and every way in which they die."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from isolation.conftest import Run, Task
from isolation.processes import is_alive, wait_while
from wsgen.errors import NotReadableError
from wsgen.isolation import parent
from wsgen.isolation.outcome import Answered, Died, Limits


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


def test_a_child_that_hangs_is_ended_with_its_own_children(
    run: Run, task: Task, tmp_path: Path
) -> None:
    started = time.monotonic()
    pid_file = tmp_path / "pid"
    died = run(
        task(
            f"""
            import subprocess, time
            child = subprocess.Popen(["sleep", "60"])
            open({str(pid_file)!r}, "w").write(str(child.pid))
            time.sleep(60)
            """
        ),
        limits=Limits(seconds=1),
    )
    assert isinstance(died, Died)
    assert died.reason == "took longer than 1 s"
    assert time.monotonic() - started < 5
    wait_while(lambda: is_alive(int(pid_file.read_text())), 2)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the address space")
def test_a_child_that_eats_memory(run: Run, task: Task) -> None:
    died = run(task("x = bytearray(3 * 2**30)\nreturn len(x)"), limits=Limits(memory=2**30))
    assert isinstance(died, Died)
    assert died.reason == "needed more memory than it may have"


def test_an_exception_is_an_answer_too(run: Run, task: Task) -> None:
    died = run(task("raise ValueError('no')"))
    assert isinstance(died, Died)
    assert died.reason == "failed (ValueError: no)"
    assert "Traceback" in died.output


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


@pytest.mark.parametrize("end", ["return os.getpid()", "os.kill(os.getpid(), 11)"])
def test_what_the_child_started_ends_with_it(
    run: Run, task: Task, end: str, tmp_path: Path
) -> None:
    pid_file = tmp_path / "pid"
    run(
        task(
            f"""
            import os, subprocess
            child = subprocess.Popen(["sleep", "60"])
            open({str(pid_file)!r}, "w").write(str(child.pid))
            {end}
            """
        )
    )
    wait_while(lambda: is_alive(int(pid_file.read_text())), 2)


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
    # A nursery keeps a folder for its server until it is closed.
    kept = list(scratch.iterdir())
    assert len(kept) == (run is not parent.run)
    run(name, "abort")
    assert list(scratch.iterdir()) == kept
