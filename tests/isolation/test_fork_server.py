"""What a fork server promises beyond `parent.run`: one start for all, and none in another's way."""

import os
import signal
import socket
import subprocess
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from isolation.conftest import Task
from isolation.processes import is_alive, parent_of, wait_while
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.fork_server_process import Server
from wsgen.isolation.result import Answered, Died, Limits

pytestmark = pytest.mark.skipif("sys.platform != 'linux'", reason="nothing is forked elsewhere")

# Tells who it is and waits for ever.
WAIT = """
import os, time
open(arguments[0] + ".part", "w").write(str(os.getpid()))
os.rename(arguments[0] + ".part", arguments[0])
time.sleep(600)
"""


def value(outcome: Answered | Died) -> object:
    assert isinstance(outcome, Answered), outcome
    return outcome.value


# The parent of a child is its guard, the guard's is the server.
SERVER = """
import os
status = open(f"/proc/{os.getppid()}/stat").read()
return int(status.rpartition(")")[2].split()[1])
"""


def read_family(file: Path) -> tuple[int, int]:
    """The process ids of a server and its child, when the child has written them."""
    wait_while(lambda: not file.exists())
    child = int(file.read_text())
    return parent_of(parent_of(child)), child


@pytest.mark.slow
def test_the_module_is_imported_once(fork_server: ForkServer, task: Task, tmp_path: Path) -> None:
    log = tmp_path / "log"
    name = task(
        SERVER.replace("return", "server =")
        + "global count\ncount += 1\nreturn [count, os.getpid(), server]",
        before=f"count = 0\nopen({str(log)!r}, 'a').write('imported ')",
    )
    counts, pids, servers = zip(*(value(fork_server.run(name)) for _ in range(3)), strict=True)
    assert log.read_text() == "imported "
    assert counts == (1, 1, 1)
    assert len(set(pids)) == 3
    assert len(set(servers)) == 1
    assert os.getpid() not in servers


@pytest.mark.slow
def test_what_one_module_imports_is_not_in_the_others_children(
    fork_server: ForkServer, task: Task
) -> None:
    body = "import sys\nreturn 'colorsys' in sys.modules"
    assert value(fork_server.run(task(body, before="import colorsys"))) is True
    assert value(fork_server.run(task(body))) is False


@pytest.mark.slow
def test_every_child_leads_a_session_of_its_own(fork_server: ForkServer, task: Task) -> None:
    name = task("import os\nreturn [os.getpid(), os.getpgrp(), os.getsid(0)]")
    first, second = value(fork_server.run(name)), value(fork_server.run(name))
    assert isinstance(first, list)
    assert len(set(first)) == 1
    assert first != second


@pytest.mark.slow
def test_children_have_nothing_open_but_their_own(fork_server: ForkServer, task: Task) -> None:
    # Standard streams, parent-death pipe, and what lists them; one child is there while the other
    # looks.
    name = task(
        "import os, time\ntime.sleep(arguments[0])\nreturn len(os.listdir('/proc/self/fd'))"
    )
    with ThreadPoolExecutor() as pool:
        numbers = [
            value(call) for call in pool.map(lambda wait: fork_server.run(name, wait), (0.5, 0))
        ]
    assert numbers == [5, 5]


def test_the_servers_state_that_is_not_the_childs(fork_server: ForkServer, task: Task) -> None:
    name = task(
        """
        import gc, signal
        is_frozen = gc.get_freeze_count() > 1000
        return [is_frozen, signal.getsignal(signal.SIGCHLD), signal.set_wakeup_fd(-1)]
        """
    )
    assert value(fork_server.run(name)) == [True, signal.SIG_DFL, -1]


def test_what_the_import_prints_is_no_childs(fork_server: ForkServer, task: Task) -> None:
    before = "import sys\nprint('welcome')\nprint('to physics', file=sys.stderr)"
    answer = fork_server.run(task("print('well')", before=before))
    assert answer == Answered(value=None, output="well")


@pytest.mark.slow
def test_a_folder_that_is_made_later(
    fork_server: ForkServer, task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    late = tmp_path / "late"
    monkeypatch.syspath_prepend(str(late))
    name = task("if arguments:\n    import made_later\n    return made_later.answer")
    fork_server.run(name)
    late.mkdir()
    (late / "made_later.py").write_text("answer = 42\n")
    assert value(fork_server.run(name, "import")) == 42


def test_calls_from_several_threads(fork_server: ForkServer, task: Task, tmp_path: Path) -> None:
    # Each waits for all the others: that the calls come back shows that they ran at one time.
    name = task(
        """
        import os, pathlib, time
        number, folder = arguments
        (pathlib.Path(folder) / f"is_there_{number}").touch()
        while len(list(pathlib.Path(folder).glob("is_there_*"))) < 4:
            time.sleep(0.01)
        if number == 0:
            os.kill(os.getpid(), 11)
        if number == 1:
            os._exit(5)
        print("I am", number)
        return number
        """
    )
    with ThreadPoolExecutor(4) as pool:
        crash, leave, *answers = pool.map(
            lambda i: fork_server.run(name, i, str(tmp_path)), range(4)
        )
    assert crash == Died(reason="crashed (SIGSEGV)", step="", output="")
    assert leave == Died(reason="ended with exit code 5 and no answer", step="", output="")
    assert answers == [Answered(value=i, output=f"I am {i}") for i in (2, 3)]


@pytest.mark.slow
def test_a_call_without_time_left_does_not_disturb_the_others(
    fork_server: ForkServer, task: Task, tmp_path: Path
) -> None:
    name = task("import time\ntime.sleep(arguments[0])\nreturn arguments[0]")
    fork_server.run(name, 0)
    with ThreadPoolExecutor() as pool:
        late = pool.submit(fork_server.run, name, 600, limits=Limits(wall_clock=0.2))
        calm = pool.submit(fork_server.run, name, 0.6)
        death = late.result()
        assert isinstance(death, Died)
        assert death.cause == "wall-clock time"
        assert value(calm.result()) == 0.6


@pytest.mark.slow
def test_a_server_that_is_killed(fork_server: ForkServer, task: Task, tmp_path: Path) -> None:
    name = task(f"if arguments:{WAIT}".replace("\n", "\n    ") + SERVER)
    first = value(fork_server.run(name))
    with ThreadPoolExecutor() as pool:
        call = pool.submit(fork_server.run, name, str(tmp_path / "family"))
        server, child = read_family(tmp_path / "family")
        assert server == first
        os.kill(server, signal.SIGKILL)
        died = call.result(120)
    assert isinstance(died, Died)
    assert died.reason == "was lost with the process that had started it, which crashed (SIGKILL)"
    wait_while(lambda: is_alive(child))
    assert value(fork_server.run(name)) not in (first, os.getpid())


@pytest.mark.slow
def test_a_server_that_is_killed_between_calls(fork_server: ForkServer, task: Task) -> None:
    name = task(SERVER)
    first = value(fork_server.run(name))
    assert isinstance(first, int)
    os.kill(first, signal.SIGKILL)
    wait_while(lambda: is_alive(first))
    assert value(fork_server.run(name)) != first


@pytest.mark.slow
def test_a_server_that_dies_as_it_is_asked(
    fork_server: ForkServer, task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = task(SERVER)
    server = value(fork_server.run(name))
    assert isinstance(server, int)
    os.kill(server, signal.SIGKILL)
    wait_while(lambda: is_alive(server))
    with monkeypatch.context() as patch:
        patch.setattr("wsgen.isolation.fork_server._Server.is_alive", lambda *_: True)
        died = fork_server.run(name)
    assert isinstance(died, Died)
    assert "was lost" in died.reason
    assert value(fork_server.run(name)) != server


def test_a_child_that_was_reaped_meanwhile_is_not_killed() -> None:
    # By then its process id may be that of another process.
    control, report = socket.socketpair()
    with subprocess.Popen(["sleep", "600"]) as another, control, report:
        server = Server(control)
        with server.wakeup, server.wakeup_writer:
            server._cancel(another.pid, report)
        with pytest.raises(subprocess.TimeoutExpired):
            another.wait(0.1)
        another.kill()


def test_a_module_that_crashes_when_it_is_imported(fork_server: ForkServer, task: Task) -> None:
    before = "import os\nprint('no graphics', flush=True)\nos.kill(os.getpid(), 11)"
    died = fork_server.run(task("return 1", before=before))
    assert isinstance(died, Died)
    assert died.reason.endswith("crashed (SIGSEGV)")
    assert died.output == "no graphics"


@pytest.mark.slow
def test_a_module_that_is_never_imported(fork_server: ForkServer, task: Task) -> None:
    name = task("return 1", before="import time\ntime.sleep(1)")
    died = fork_server.run(name, limits=Limits(wall_clock=0.2))
    assert isinstance(died, Died)
    assert died.cause == "wall-clock time"
    assert value(fork_server.run(name)) == 1


@pytest.mark.slow
def test_a_module_that_starts_threads_is_not_forked(fork_server: ForkServer, task: Task) -> None:
    before = """
        import os, threading, time
        threading.Thread(target=time.sleep, args=(600,), daemon=True).start()
        """
    name = task(SERVER, before=before)
    assert value(fork_server.run(name)) == os.getpid()


@pytest.mark.slow
def test_the_modules_of_wsgen_start_no_threads(fork_server: ForkServer, task: Task) -> None:
    for module in (
        "wsgen.pipeline.tasks.bullet",
        "wsgen.pipeline.tasks.launch",
        "numpy",
        "lxml.etree",
    ):
        name = task(SERVER, before=f"import {module}")
        assert value(fork_server.run(name)) != os.getpid(), module


@pytest.mark.slow
def test_nothing_is_forked_elsewhere(
    fork_server: ForkServer, task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.isolation.system.has_guards", lambda: False)
    assert value(fork_server.run(task("import os\nreturn os.getppid()"))) == os.getpid()


def test_the_end_of_a_nursery(task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scratch").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "scratch"))
    outcomes = []
    with ForkServer() as fork_server:
        name, file = task(WAIT), tmp_path / "family"
        thread = threading.Thread(target=lambda: outcomes.append(fork_server.run(name, str(file))))
        thread.start()
        server, child = read_family(file)
    thread.join(120)
    assert isinstance(outcomes[0], Died)
    wait_while(lambda: is_alive(server) or is_alive(child))
    assert list((tmp_path / "scratch").iterdir()) == []
    with pytest.raises(RuntimeError, match="closed"):
        fork_server.run(name)


def test_the_end_where_nothing_is_forked(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.isolation.system.has_guards", lambda: False)
    name, file = task(WAIT), tmp_path / "pid"
    with ThreadPoolExecutor() as pool, ForkServer() as fork_server:
        call = pool.submit(fork_server.run, name, str(file))
        wait_while(lambda: not file.exists())
        fork_server.__exit__(None, None, None)
        died = call.result(120)
    assert isinstance(died, Died)
    assert died.reason == "crashed (SIGKILL)"
    assert not is_alive(int(file.read_text()))
    with pytest.raises(RuntimeError, match="closed"):
        fork_server.run(name)


@pytest.mark.slow
def test_an_interrupted_call_leaves_nothing(
    fork_server: ForkServer, task: Task, tmp_path: Path
) -> None:
    def interrupt() -> None:
        family.extend(read_family(tmp_path / "family"))
        os.kill(os.getpid(), signal.SIGINT)

    family: list[int] = []
    name = task(WAIT)
    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        fork_server.run(name, str(tmp_path / "family"))
    thread.join()
    server, child = family
    wait_while(lambda: is_alive(child))
    assert is_alive(server)
