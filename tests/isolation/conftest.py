import itertools
import os
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

import pytest

from windows_like import ModuleOnWindows, make_interpreter
from wsgen.isolation import parent
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.result import Answered, Died

Run = Callable[..., Answered | Died]


# Mark tests of what only a guard can do, and of what Windows cannot.
GUARDED = pytest.mark.parametrize("run", ["fresh", "forked"], indirect=True)
GROUPED = pytest.mark.parametrize("run", ["fresh", "forked", "macos"], indirect=True)


class Task(Protocol):
    """Makes a task: its function's lines, those before it; gives its name."""

    def __call__(self, body: str, *, before: str = "") -> str: ...


@pytest.fixture
def fork_server() -> Iterator[ForkServer]:
    with ForkServer() as fork_server:
        yield fork_server


@pytest.fixture
def task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Task:
    """Write a module for the child; returns the name of its function."""
    numbers = itertools.count()

    def write(body: str, *, before: str = "") -> str:
        name = f"foreign_task_{next(numbers)}"
        body = textwrap.indent(textwrap.dedent(body), "    ")
        code = f"{textwrap.dedent(before)}\ndef function(*arguments):\n{body}"
        (tmp_path / f"{name}.py").write_text(code)
        return f"{name}:function"

    monkeypatch.syspath_prepend(str(tmp_path))
    return write


@pytest.fixture(scope="session")
def windows_like(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An interpreter for children like those on Windows."""
    return make_interpreter(tmp_path_factory.mktemp("windows") / "environment")


@pytest.fixture(params=["fresh", "forked", "macos", "windows"])
def run(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Run:
    """All ways to run a task; what they promise is the same, but for `GUARDED` and `GROUPED`."""
    if request.param in {"macos", "windows"}:
        monkeypatch.setattr("wsgen.isolation.system.has_guards", lambda: False)
    if request.param == "windows":
        python: Path = request.getfixturevalue("windows_like")
        monkeypatch.setattr("sys.executable", str(python))
        monkeypatch.setattr("wsgen.isolation.system.os", ModuleOnWindows(os))
        monkeypatch.setenv("PATH", str(python.parent), prepend=os.pathsep)
    if request.param != "forked":
        return parent.run
    fork_server: ForkServer = request.getfixturevalue("fork_server")
    return fork_server.run
