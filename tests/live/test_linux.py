from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, cast

import pytest

from wsgen.cli.live_run import run_for_behaviors
from wsgen.errors import NotFoundError
from wsgen.isolation.system import require_linux
from wsgen.testing import plugin

if TYPE_CHECKING:
    from collections.abc import Callable


def of_behaviors() -> None:
    run_for_behaviors(cast("Any", None), cast("Any", None), [])


def of_fixture() -> None:
    with plugin._RunningLive(cast("Any", None), ExitStack()):
        pass


@pytest.mark.parametrize(
    ("start", "error", "words"),
    [
        (of_behaviors, NotFoundError, "run = true needs Linux"),
        (of_fixture, pytest.fail.Exception, "wsgen: The fixture `live` needs Linux"),
    ],
)
def test_what_runs_nodes_says_that_it_needs_linux(
    start: Callable[[], None],
    error: type[BaseException],
    words: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("wsgen.isolation.system.has_guards", lambda: False)
    with pytest.raises(error, match=words):
        start()


def test_linux_has_it() -> None:
    require_linux("A live run", "Nothing else.")
