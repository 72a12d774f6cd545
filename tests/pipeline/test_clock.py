"""What is posted while a stage goes on."""

import threading
from pathlib import Path

import pytest

from wsgen.events import Event, StepEnded, StepProgressed, StepStarted
from wsgen.pipeline import clock
from wsgen.pipeline.clock import Clock


def test_what_a_child_says_about_how_far_it_is_is_posted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clock, "LOOK_EVERY", 0.01)
    file = tmp_path / "progress"
    heard: list[Event] = []
    progressed = threading.Event()

    def hear(event: Event) -> None:
        heard.append(event)
        if isinstance(event, StepProgressed):
            progressed.set()

    one = Clock("robot", hear)
    with one.step("simulate", "e"), one.watch("simulate", file):
        for text in ("frame 1 of 2", "frame 2 of 2"):
            file.write_text(text)
            assert progressed.wait(60)
            progressed.clear()
    assert [type(event) for event in heard] == [
        StepStarted,
        StepProgressed,
        StepProgressed,
        StepEnded,
    ]
    assert heard[1] == StepProgressed(step=("robot", "simulate"), detail="frame 1 of 2")


def test_drawing_is_posted_as_a_separate_step() -> None:
    heard: list[Event] = []
    one = Clock("robot", heard.append)
    with one.step("simulate", "e") as step:
        step.drawn, step.drawing = "video.gif", 5.0
    *_, simulated, drawn = heard
    assert isinstance(simulated, StepEnded)
    assert simulated.seconds < 0.0  # the drawing is not counted
    assert drawn == StepEnded(
        step=("robot", "draw"), succeeded=True, seconds=5.0, detail="video.gif"
    )


@pytest.mark.parametrize("is_heard", [True, False])
def test_without_a_video_or_a_listener_nobody_looks(tmp_path: Path, *, is_heard: bool) -> None:
    one = Clock("robot", (lambda _: None) if is_heard else None)
    before = threading.active_count()
    with one.watch("simulate", None if is_heard else tmp_path / "progress"):
        assert threading.active_count() == before
