"""Expansions that are kept: what one notes does not depend on what was noted before it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

import wsgen.launching.shim
from wsgen.launching.expansions import Expansions
from wsgen.launching.record import RECORD, CommandOutcome

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence


@pytest.fixture(autouse=True)
def _shim(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The shim of ament_index_python, and a record of its own."""
    monkeypatch.syspath_prepend(next(iter(wsgen.launching.shim.__path__)))
    RECORD.forget()
    yield
    RECORD.forget()
    for name in [name for name in sys.modules if name.partition(".")[0] == "ament_index_python"]:
        del sys.modules[name]


class Xacro:
    """Prints the same robot for each command line, and notes what it is told to."""

    def __init__(self, note: Callable[[], object]) -> None:
        self.count = 0
        self._note = note

    def run(self, words: Sequence[str]) -> CommandOutcome:
        del words
        self.count += 1
        self._note()
        return CommandOutcome("<robot/>")


def note_text() -> None:
    RECORD.note_text("<robot/>", "/robot.xacro")
    RECORD.opened.append("/part.urdf")


def test_a_text_that_another_command_line_has_noted_is_kept() -> None:
    xacro = Xacro(note_text)
    expansions = Expansions(xacro.run)
    expansions.run(["xacro", "robot.xacro"])
    expansions.run(["xacro", "robot.xacro", "a:=1"])
    assert RECORD.opened == ["/part.urdf"] * 2
    RECORD.forget()
    expansions.run(["xacro", "robot.xacro", "a:=1"])
    assert xacro.count == 2
    assert RECORD.source_of("<robot/>") == "/robot.xacro"
    assert RECORD.opened == ["/part.urdf"]


def test_a_text_that_two_files_become_is_of_the_last() -> None:
    files = iter(["/one.xacro", "/two.xacro"])
    expansions = Expansions(Xacro(lambda: RECORD.note_text("<robot/>", next(files))).run)
    for name, file in (("one", "/one.xacro"), ("two", "/two.xacro"), ("one", "/one.xacro")):
        expansions.run(["xacro", name])
        assert RECORD.source_of("<robot/>") == file


@pytest.mark.parametrize(
    "note",
    [
        lambda: RECORD.lookups.setdefault("demo", ("a.launch.py", 1)),
        lambda: RECORD.unset.update(MODEL=("a.launch.py", 1)),
        lambda: RECORD.note_unresolved("demo", "it is not installed", ("a.launch.py", 1)),
    ],
    ids=["lookup", "unset variable", "unresolved"],
)
def test_what_notes_more_is_not_kept_though_it_was_noted_before(
    note: Callable[[], object],
) -> None:
    xacro = Xacro(note)
    expansions = Expansions(xacro.run)
    note()
    noted = noted_more()
    expansions.run(["xacro", "robot.xacro"])
    assert noted_more() == noted  # each once
    RECORD.forget()
    expansions.run(["xacro", "robot.xacro"])
    assert xacro.count == 2
    assert noted_more() == noted


def noted_more() -> tuple[object, ...]:
    return dict(RECORD.lookups), dict(RECORD.unset), list(RECORD.unresolved)


def test_what_a_failing_run_notes_stays() -> None:
    def fail() -> None:
        RECORD.note_text("<robot/>", "/robot.xacro")
        raise KeyboardInterrupt

    RECORD.note_text("<world/>", "/world.sdf")
    with pytest.raises(KeyboardInterrupt):
        Expansions(Xacro(fail).run).run(["xacro", "robot.xacro"])
    assert RECORD.source_of("<robot/>") == "/robot.xacro"
    assert RECORD.source_of("<world/>") == "/world.sdf"
