import itertools
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

import pytest

from wsgen.isolation import parent
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.result import Answered, Died

Run = Callable[..., Answered | Died]


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


@pytest.fixture(params=["fresh", "forked"])
def run(request: pytest.FixtureRequest) -> Run:
    """Both ways to run a task; what they promise is the same."""
    if request.param == "fresh":
        return parent.run
    fork_server: ForkServer = request.getfixturevalue("fork_server")
    return fork_server.run
