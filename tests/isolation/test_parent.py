"""Child processes: their answers, and every way in which they die."""

import os
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from wsgen.isolation.parent import Answered, Died, Limits, run

Task = Callable[[str], str]


@pytest.fixture
def task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Task:
    """Write a module for the child; returns the name of its function."""

    def write(body: str) -> str:
        code = "def function(*arguments):\n" + textwrap.indent(textwrap.dedent(body), "    ")
        (tmp_path / "foreign_task.py").write_text(code)
        return "foreign_task:function"

    monkeypatch.syspath_prepend(str(tmp_path))
    return write


def test_arguments_go_there_and_the_value_comes_back(task: Task) -> None:
    answer = run(task("return {'sum': sum(arguments)}"), 1, 2, 3)
    assert isinstance(answer, Answered)
    assert answer.value == {"sum": 6}


def test_what_is_printed_does_not_disturb_the_answer(task: Task) -> None:
    answer = run(task("import os\nprint('{')\nos.write(1, b'from C')\nreturn 1"))
    assert isinstance(answer, Answered)
    assert answer.value == 1
    assert "from C" in answer.output


def test_standard_input_is_at_its_end(task: Task) -> None:
    answer = run(task("import sys\nreturn sys.stdin.read()"))
    assert isinstance(answer, Answered)
    assert answer.value == ""


def test_the_environment_is_the_one_given(task: Task) -> None:
    answer = run(
        task("import os\nreturn [os.environ.get('A'), os.environ.get('HOME')]"),
        environment={"A": "b"},
    )
    assert isinstance(answer, Answered)
    assert answer.value == ["b", None]


def test_the_overlays_modules_come_after_wsgens(task: Task, tmp_path: Path) -> None:
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
    run = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


def test_a_crash_says_signal_and_step(task: Task) -> None:
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


def is_gone(pid: int) -> bool:
    """Whether a process has ended, or ends within two seconds; a zombie has."""
    for _ in range(20):
        try:
            if Path(f"/proc/{pid}/stat").read_text().split()[2] == "Z":
                return True
        except OSError:
            return True
        time.sleep(0.1)
    return False


def test_a_child_that_hangs_is_ended_with_its_own_children(task: Task, tmp_path: Path) -> None:
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
        limits=Limits(seconds=2),
    )
    assert isinstance(died, Died)
    assert died.reason == "took longer than 2 s"
    assert time.monotonic() - started < 10
    assert is_gone(int(pid_file.read_text()))


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the address space")
def test_a_child_that_eats_memory(task: Task) -> None:
    died = run(task("x = bytearray(3 * 2**30)\nreturn len(x)"), limits=Limits(memory=2**30))
    assert isinstance(died, Died)
    assert died.reason == "needed more memory than it may have"


def test_an_exception_is_an_answer_too(task: Task) -> None:
    died = run(task("raise ValueError('no')"))
    assert isinstance(died, Died)
    assert died.reason == "failed (ValueError: no)"
    assert "Traceback" in died.output


def test_a_child_that_leaves_by_itself(task: Task) -> None:
    died = run(task("import os\nos._exit(7)"))
    assert isinstance(died, Died)
    assert died.reason == "ended with exit code 7 and no answer"


def test_a_value_that_json_cannot_hold(task: Task) -> None:
    died = run(task("return {1, 2}"))
    assert isinstance(died, Died)
    assert "TypeError" in died.reason


def test_nothing_is_left_in_the_temporary_folder(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scratch = tmp_path / "tmp"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    run(task("return 1"))
    run(task("import os\nos.abort()"))
    assert list(scratch.iterdir()) == []
