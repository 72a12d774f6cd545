"""`wsgen launch --run`: what is refused before anything is started."""

from __future__ import annotations

import errno
import socket
import sys
import threading
from pathlib import Path
from typing import Any

import click
import pytest

from wsgen.cli import run
from wsgen.cli.launch import RateType
from wsgen.live.journal import FailedProgram
from wsgen.live.run import RunEnd
from wsgen.pipeline.file_validation import UNUSABLE_FILE
from wsgen.text.files import write_file


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--for", "3"], "Without --run nothing is started, and --for has no effect."),
        (["--rate", "max"], "Without --run nothing is started, and --rate has no effect."),
        (["--strict"], "Without --run nothing is started, and --strict has no effect."),
        (["--until-exit", "goal"], "Without --run nothing is started, and --until-exit has no"),
        (["--run", "--play"], "--run and --play cannot be combined."),
        (["--run", "--show-args"], "--run and --show-arguments cannot be combined."),
        (["--run", "--seconds", "3"], "--run and --seconds cannot be combined."),
        (["--run", "--format", "json"], "--run and --format cannot be combined."),
        (["--run", "--engine", "all"], "--run simulates in one engine."),
        (["--run", "--rate", "fast"], "'fast' is neither a number above 0 nor `max`."),
        (["--run", "--rate", "0"], "'0' is neither a number above 0 nor `max`."),
        (["--run", "--for", "-1"], "-1"),
        (["--run", "--record", "a.png"], "`a.png` is neither an .mcap, nor a .gif, nor an .mp4"),
        (["--run", "--record", "a.gif", "--record", "b.mp4"], "the same recording twice"),
        (["--run", "--record", "/no/such/folder/a.mcap"], "its folder does not exist"),
        (["--play", "--record", "a.gif", "--record", "b.gif"], "--play makes one video."),
        (
            ["--run", "--port", "8080"],
            "Without --view no page is served, and --port has no effect.",
        ),
        (["--run", "--view", "--picture", "."], "--run and --picture cannot be combined."),
        (["--run", "--view", "--host", "192.0.2.1"], "wsgen cannot listen on 192.0.2.1"),
    ],
)
def test_what_makes_no_sense_is_refused(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text(
        "from launch import LaunchDescription\n"
        "def generate_launch_description():\n    return LaunchDescription()\n"
    )
    assert run(["launch", str(file), *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_a_video_without_its_encoder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.rendering.drawing.find_spec", lambda _: None)
    file = tmp_path / "empty.launch.py"
    file.write_text("1 / 0")
    assert run(["launch", str(file), "--run", "--record", str(tmp_path / "x.mp4")]) == 4
    assert "pip install 'wsgen[video]'; or record a .gif." in capsys.readouterr().err


@pytest.mark.slow
def test_a_page_is_refused_before_anything_is_started(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("1 / 0")
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = str(server.getsockname()[1])
        assert run(["launch", str(file), "--run", "--view", "--port", port]) == 2
    assert f"The port {port} of 127.0.0.1 is taken." in capsys.readouterr().err
    monkeypatch.setattr("wsgen.reporting.viewing.LIBRARY", "no_such_library")
    assert run(["launch", str(file), "--run", "--view"]) == 4
    assert "pip install 'wsgen[view]'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "is_drawn", "has_page"),
    [
        ([], False, False),
        (["--view", "--no-browser"], True, True),
        (["--record", "a.gif"], True, False),
        (["--record", "a.mcap"], False, False),
        (["--view", "--record", "a.mcap", "--rate", "max"], True, True),
    ],
)
def test_what_is_shown_is_read_as_it_looks(
    words: list[str],
    is_drawn: bool,
    has_page: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("")
    runs: list[tuple[bool, bool]] = []

    def run_launch(_selected: Any, request: Any, _open: Any, *, beside: Any, **_more: Any) -> int:
        runs.append((request.prepared_as.is_drawn, beside is not None))
        return 0

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    assert run(["launch", str(file), "--run", *words]) == 0
    assert runs == [(is_drawn, has_page)]


@pytest.mark.slow
def test_what_is_reported_later_is_printed_without_what_was_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("")
    early, both, late = (
        UNUSABLE_FILE.at(None, message=f"{name} is wrong.", hint="Correct it.")
        for name in ("early", "both", "late")
    )

    def run_launch(*_: Any, show: Any, **_more: Any) -> int:
        show((early, both))
        capsys.readouterr()
        show([both, late])
        return 0

    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    assert run(["launch", str(file), "--run"]) == 0
    printed = capsys.readouterr().err
    assert "late is wrong." in printed
    assert "early is wrong." not in printed
    assert "both is wrong." not in printed


@pytest.mark.slow
@pytest.mark.parametrize(("color", "is_colored"), [("always", True), ("never", False)])
def test_what_is_reported_later_has_the_colors_that_are_wanted(
    color: str,
    is_colored: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Another thread reports it, whose robots are spawned while the run goes on."""
    file = tmp_path / "empty.launch.py"
    file.write_text("")

    def run_launch(*_: Any, show: Any, **_more: Any) -> int:
        late = UNUSABLE_FILE.at(None, message="late is wrong.", hint="Correct it.")
        thread = threading.Thread(target=show, args=((late,),))
        thread.start()
        thread.join()
        return 0

    def strips(_stream: object, color: bool | None) -> bool:  # by itself, the opposite of --color
        return is_colored if color is None else not color

    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    monkeypatch.setattr("click.utils.should_strip_ansi", strips)
    assert run(["launch", str(file), "--run", "--color", color]) == 0
    printed = capsys.readouterr().err
    assert "late is wrong." in printed
    assert ("\x1b[" in printed) is is_colored


def not_finished(*, is_there: bool) -> str:
    kept = " The previous x.gif is unchanged." if is_there else ""
    return f"x.gif was not finished: wsgen was ended before it was drawn.{kept}"


@pytest.mark.parametrize("is_there", [True, False])
def test_a_video_that_is_not_drawn_is_named_before_the_signal(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    is_there: bool,
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("")
    if is_there:
        (tmp_path / "x.gif").touch()

    def run_launch(*_: Any, unfinished: Any, **_more: Any) -> int:
        unfinished(Path("x.gif"))
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    assert run(["launch", str(file), "--run", "--record", "x.gif", "--for", "1"]) == 130
    assert [line for line in capsys.readouterr().err.splitlines() if line] == [
        not_finished(is_there=is_there),
        "wsgen: interrupted",
    ]


@pytest.mark.parametrize("is_there", [True, False])
@pytest.mark.parametrize("is_drawn", [True, False])
def test_a_video_of_play_that_is_not_drawn_is_named_before_the_signal(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    is_there: bool,
    is_drawn: bool,
) -> None:
    (tmp_path / "empty.launch.py").write_text("")
    video = tmp_path / "x.gif"
    if is_there:
        video.touch()

    def play(*_: Any, **_more: Any) -> None:
        if is_drawn:
            write_file(video, "drawn")
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.pipeline.validate.play", play)
    assert run(["launch", "empty.launch.py", "--play", "--record", "x.gif"]) == 130
    said = [] if is_drawn else [not_finished(is_there=is_there)]
    lines = [line for line in capsys.readouterr().err.splitlines() if line]
    assert lines == [*said, "wsgen: interrupted"]


@pytest.mark.slow
def test_a_page_that_cannot_be_served_keeps_the_launch_from_starting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("viser")
    file = tmp_path / "empty.launch.py"
    file.write_text("")

    def run_launch(*_: Any, beside: Any, **_more: Any) -> int:
        with beside(tmp_path):
            pytest.fail("it is started")

    def refuse(**_: Any) -> None:
        raise OSError(errno.EADDRINUSE, "Address already in use")

    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    monkeypatch.setattr("wsgen.reporting.viewing.simulation_page.RunPage", refuse)
    assert run(["launch", str(file), "--run", "--view", "--no-browser"]) == 2
    assert "of 127.0.0.1 is taken." in capsys.readouterr().err


DRIVES = "  (drives a robot; in another terminal while the run goes on)"
SHOWS = "  (shows the robots in the browser)"
TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"


@pytest.mark.parametrize(
    ("words", "unheard", "steps"),
    [
        (
            ["--for", "3", "--engine", "dart", "z:=1"],
            {"/enable": "std_msgs/msg/Bool", "/c": STAMPED},
            [
                f"wsgen topic pub /c {STAMPED} '{{twist: {{linear: {{x: 0.5}}}}}}' -r 10{DRIVES}",
                f"wsgen launch empty.launch.py --run --view --engine dart z:=1{SHOWS}",
            ],
        ),
        (
            ["--for", "3"],
            {"/enable": "std_msgs/msg/Bool"},
            [f"wsgen launch empty.launch.py --run --view{SHOWS}"],
        ),
        (
            [],
            {"/b/cmd": "std_msgs/msg/Float64", "/a/cmd_vel": TWIST},
            [f"wsgen topic pub /a/cmd_vel {TWIST} '{{linear: {{x: 0.5}}}}' -r 10{DRIVES}"],
        ),
        (
            [],
            {"/arm/commands": "std_msgs/msg/Float64MultiArray"},
            [
                "wsgen topic pub /arm/commands std_msgs/msg/Float64MultiArray '{data: [0.5]}' -r 10"
                + DRIVES.replace("robot", "robot, with one number for each joint of the controller")
            ],
        ),
        ([], {}, []),
        (["--for", "3", "-q"], {"/cmd_vel": TWIST}, []),
    ],
)
@pytest.mark.parametrize("is_terminal", [True, False])
def test_what_to_do_after_a_run_is_said_on_a_terminal(  # noqa: PLR0917  the cases
    words: list[str],
    unheard: dict[str, str],
    steps: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    is_terminal: bool,
) -> None:
    (tmp_path / "empty.launch.py").write_text("")

    def run_launch(*_: Any, ended: Any, **_more: Any) -> int:
        monkeypatch.setenv("COLUMNS", "300")
        monkeypatch.setattr(sys.stderr, "isatty", lambda: is_terminal)
        ended(RunEnd(has_simulator=True, unheard=unheard))
        return 0

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    assert run(["launch", "empty.launch.py", "--run", *words]) == 0
    said = [line.removeprefix("Next:").strip() for line in capsys.readouterr().err.splitlines()]
    assert said == (steps if is_terminal else [])


ROVER = FailedProgram(name="rover", place="line 2 of src/rover.py")
LINK = FailedProgram(name="rover", place="line 2 of src/rover.py", is_built=False)


@pytest.mark.parametrize(
    ("failed", "step"),
    [
        ([ROVER, ROVER], "correct line 2 of src/rover.py, and run: wsgen build"),
        ([LINK], "correct line 2 of src/rover.py, and run it again"),
        ([FailedProgram(name="arm")], "correct the error that ended arm, and run: wsgen build"),
        (
            [LINK, FailedProgram(name="arm", missing_module="moveit")],
            (
                "correct line 2 of src/rover.py, the import of moveit in arm (or install it, see "
                "above), and run: wsgen build"
            ),
        ),
        (
            [FailedProgram(name="create", is_of_user=False)],
            "correct what the launch file gives create, and run: wsgen build",
        ),
        (
            [FailedProgram(name=name) for name in "abcde"],
            (
                "correct the error that ended a, the error that ended b, the error that ended c, "
                "the errors that ended 2 more, and run: wsgen build"
            ),
        ),
    ],
)
def test_what_has_died_is_corrected_before_a_robot_is_driven(
    failed: list[FailedProgram],
    step: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "empty.launch.py").write_text("")

    def run_launch(*_: Any, ended: Any, **_more: Any) -> int:
        monkeypatch.setenv("COLUMNS", "300")
        monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
        ended(RunEnd(has_simulator=True, unheard={"/cmd_vel": TWIST}, failed=tuple(failed)))
        return 0

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    assert run(["launch", "empty.launch.py", "--run"]) == 0
    assert capsys.readouterr().err == f"Next: {step}\n"


def test_what_shows_a_run_is_installed_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty.launch.py").write_text("")

    def run_launch(*_: Any, ended: Any, **_more: Any) -> int:
        monkeypatch.setenv("COLUMNS", "300")
        monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
        ended(RunEnd(has_simulator=True))
        return 0

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.live.run.run_launch", run_launch)
    monkeypatch.setattr("wsgen.reporting.viewing.LIBRARY", "no_such_library")
    assert run(["launch", "empty.launch.py", "--run", "--for", "3"]) == 0
    assert capsys.readouterr().err == (
        "Next: wsgen launch empty.launch.py --run --view  (shows the robots in the browser; after: "
        "pip install 'wsgen[view]')\n"
    )


def test_rates() -> None:
    rate = RateType()
    assert rate.convert("max", None, None) is None
    assert rate.convert("0.5", None, None) == 0.5
    with pytest.raises(click.BadParameter):
        rate.convert("inf", None, None)
