"""The process that records topics: its start, its end, and what keeps it from its file."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from ros_for_tests import ros_with, variables_for
from wsgen.cli.words import unwritten
from wsgen.errors import SessionDiedError
from wsgen.events import Event, StepEnded, StepProgressed, StepStarted
from wsgen.isolation.codec import encode
from wsgen.live import run as video
from wsgen.live.recording import Recorded, recording_topics
from wsgen.live.run import drawing
from wsgen.model.robot import Box, Collision, Link, Robot
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.pipeline import clock
from wsgen.ros.environment import RosEnvironment, variables_of_nodes
from wsgen.simulation.live_runs import POSE_LOG_FILE, SCENE_FILE, LiveScene, PoseLogWriter
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

if sys.platform != "linux":
    pytest.skip("live runs need Linux", allow_module_level=True)

PYTHON = Path(sys.executable)
FRAMES = 12  # of a video
SAY = """
import sys
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("one_who_says")
publisher = node.create_publisher(String, "said", 10)
while publisher.get_subscription_count() == 0:
    rclpy.spin_once(node, timeout_sec=0.02)
for word in ("one", "two"):
    publisher.publish(String(data=word))
publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
"""


@pytest.fixture(scope="module")
def variables() -> Mapping[str, str]:
    ros: RosEnvironment = ros_with()
    environment = variables_for(ros)
    return {**environment, **variables_of_nodes(ros, environment)}


@pytest.mark.slow
def test_messages_have_the_time_of_the_machine(
    tmp_path: Path, variables: Mapping[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    reader = pytest.importorskip("mcap.reader")
    for name in ("argparse", "yaml", "numpy"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('executed')")
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "said.mcap"
    began = time.time_ns()
    reported: list[Recorded] = []
    with recording_topics(file, PYTHON, variables, use_sim_time=False, recorded=reported.append):
        subprocess.run([PYTHON, "-c", SAY], cwd="/", env=dict(variables), check=True, timeout=300)
    with file.open("rb") as stream:
        found = [
            (channel.topic, message.log_time)
            for _, channel, message in reader.make_reader(stream).iter_messages("/said")
        ]
    assert [topic for topic, _ in found] == ["/said", "/said"]
    assert reported[0].file == file
    assert (reported[0].messages or 0) >= len(found)
    assert 0 <= reported[0].seconds < 60  # both may come within half a millisecond
    assert all(began < stamp < time.time_ns() for _, stamp in found)


# Publishes more quickly than the recorder writes, which it may stop meanwhile.
SAY_MUCH = """
import os, signal, sys
import rclpy
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

recorder, depth, size = map(int, sys.argv[1:])
rclpy.init()
node = rclpy.create_node("one_who_says")
publisher = node.create_publisher(String, "said", QoSProfile(depth=depth))
clock = node.create_publisher(Clock, "clock", QoSProfile(depth=1000))
while publisher.get_subscription_count() < 1 or clock.get_subscription_count() < 1:
    rclpy.spin_once(node, timeout_sec=0.02)
if recorder:
    os.kill(recorder, signal.SIGSTOP)
time = Clock()
for second in range(1, 301):
    time.clock.sec = second
    clock.publish(time)
    publisher.publish(String(data=f"{second} " + "x" * size))
if recorder:
    os.kill(recorder, signal.SIGCONT)
for one in (publisher, clock):
    assert one.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
"""


def _pids_with(word: str) -> list[str]:
    """The processes with a word in their command lines."""
    found = []
    for line in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):  # it has ended
            found += [line.parent.name] if word.encode() in line.read_bytes().split(b"\0") else []
    return found


def _record_much(
    file: Path, variables: Mapping[str, str], depth: int, size: int, *, is_stopped: bool = False
) -> tuple[list[tuple[int, int]], Recorded]:
    """What is recorded of SAY_MUCH: the number of each message and its time in seconds."""
    reader = pytest.importorskip("mcap.reader")
    reported: list[Recorded] = []
    with recording_topics(file, PYTHON, variables, use_sim_time=True, recorded=reported.append):
        (recorder,) = _pids_with(str(file))
        words = [
            str(PYTHON),
            "-c",
            SAY_MUCH,
            recorder if is_stopped else "0",
            str(depth),
            str(size),
        ]
        subprocess.run(words, cwd="/", env=dict(variables), check=True, timeout=300)
    with file.open("rb") as stream:
        found = [
            # Behind 4 bytes of a header and the length.
            (int(message.data[8:].split()[0]), round(message.log_time * 1e-9))
            for _, _, message in reader.make_reader(stream).iter_messages("/said")
        ]
    (one,) = reported
    return sorted(found), one


@pytest.mark.slow
def test_a_recorder_that_is_behind_writes_all_with_the_time_at_which_it_was_sent(
    tmp_path: Path, variables: Mapping[str, str]
) -> None:
    found, reported = _record_much(tmp_path / "x.mcap", variables, 1000, 1)
    assert [number for number, _ in found] == list(range(1, 301))
    assert [pair for pair in found if abs(pair[1] - pair[0]) > 1] == []
    assert reported.lost == {}


@pytest.mark.slow
def test_messages_that_are_lost_are_counted(tmp_path: Path, variables: Mapping[str, str]) -> None:
    found, reported = _record_much(tmp_path / "x.mcap", variables, 1, 200_000, is_stopped=True)
    first, last = found[0][0], found[-1][0]
    assert last == 300
    assert len(found) < 300
    lost = last - first + 1 - len(found)  # those before the first that came are not known
    assert dict(reported.lost) == ({"/said": lost} if lost else {})


def test_ctrl_c_ends_the_writing_of_what_waits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Recorder:
        """Ends at the second signal."""

        returncode = 0

        def __init__(
            self, words: list[str], _python: Path, _variables: object, reported: int
        ) -> None:
            del words
            self.reported = os.dup(reported)
            self.signals: list[int] = []
            os.write(reported, b"\n")

        def send_signal(self, number: int) -> None:
            self.signals.append(number)

        def wait(self, _seconds: float | None = None) -> None:
            if len(self.signals) == 1:
                raise KeyboardInterrupt
            os.write(self.reported, b'[1.5, 20, {"/said": 3}]')
            os.close(self.reported)

    monkeypatch.setattr("wsgen.live.recording._start", Recorder)
    file = tmp_path / "x.mcap"
    reported: list[Recorded] = []
    with (
        pytest.raises(KeyboardInterrupt),
        recording_topics(file, PYTHON, {}, use_sim_time=True, recorded=reported.append),
    ):
        pass
    assert reported == [Recorded(file, 1.5, 20, {"/said": 3})]


@pytest.mark.slow
@pytest.mark.parametrize("earlier", [b"of yesterday", None])
def test_a_run_without_messages_keeps_the_earlier_recording(
    tmp_path: Path,
    variables: Mapping[str, str],
    capfd: pytest.CaptureFixture[str],
    earlier: bytes | None,
) -> None:
    file = tmp_path / "short.mcap"
    if earlier is not None:
        file.write_bytes(earlier)
    reported: list[Recorded] = []
    with recording_topics(file, PYTHON, variables, use_sim_time=True, recorded=reported.append):
        pass
    assert (file.read_bytes() if file.exists() else None) == earlier
    assert reported == [Recorded(file, 0.0, 0)]
    kept = "" if earlier is None else " The previous short.mcap is unchanged."
    assert unwritten(file) == f"{file} was not written: no message was received.{kept}"
    assert not file.with_name("short.mcap.part").exists()
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_a_full_disk(tmp_path: Path, variables: Mapping[str, str]) -> None:
    (tmp_path / "x.mcap.part").symlink_to("/dev/full")
    with (
        pytest.raises(SessionDiedError, match=r"x\.mcap\.part cannot be written: No space left"),
        recording_topics(tmp_path / "x.mcap", PYTHON, variables, use_sim_time=True),
    ):
        pass
    assert not (tmp_path / "x.mcap").exists()


# A recorder whose disk is full, without ROS.
FULL = """
import errno, os, sys, types
from wsgen.live.nodes import recorder

def record(stream, *, when_ready, **more):
    when_ready()
    stream.write({written!r})
    stream.flush()
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

module = types.ModuleType("wsgen.live.nodes.mcap_recording")
module.record = record
sys.modules[module.__name__] = module
sys.exit(recorder.main([{file!r}, "--report-to", "{reported}"]))
"""


@pytest.mark.parametrize("written", [b"", b"a chunk"])
def test_a_disk_that_is_full_meanwhile_is_reported_at_once(tmp_path: Path, written: bytes) -> None:
    heard, reported = os.pipe()
    with os.fdopen(heard, "rb") as hears:
        done = subprocess.run(
            [
                sys.executable,
                "-c",
                FULL.format(written=written, file=str(tmp_path / "x.mcap"), reported=reported),
            ],
            pass_fds=[reported],
            capture_output=True,
            text=True,
            check=False,
        )
        os.close(reported)
        assert hears.read().startswith(b"\n" + str(tmp_path).encode())
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith("[ERROR] [recorder]: topics are not recorded any more: ")
    assert "x.mcap.part cannot be written: No space left" in line
    kept = [file.read_bytes() for file in tmp_path.iterdir()]
    assert kept == ([written] if written else [])  # what was recorded until then


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    file = tmp_path / "x.mcap"
    (tmp_path / "x.mcap.part").mkdir()
    with (
        pytest.raises(SessionDiedError, match=r"x\.mcap\.part cannot be written: Is a dir"),
        recording_topics(file, PYTHON, os.environ, use_sim_time=True),
    ):
        pytest.fail("nothing is recorded")


def test_a_recorder_that_does_not_start(tmp_path: Path) -> None:
    (tmp_path / "rclpy.py").write_text("raise ImportError('no ROS')")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    with (
        pytest.raises(SessionDiedError, match="a Python module cannot be imported: no ROS") as one,
        recording_topics(tmp_path / "x.mcap", PYTHON, environment, use_sim_time=True),
    ):
        pytest.fail("nothing is recorded")
    assert one.value.exit_code == 1
    assert [path.name for path in tmp_path.iterdir() if "mcap" in path.name] == []


@pytest.mark.parametrize("has_poses", [True, False])
def test_a_video_is_drawn_where_the_topics_are_lost(tmp_path: Path, *, has_poses: bool) -> None:
    drawn: list[object] = []
    if has_poses:
        (tmp_path / POSE_LOG_FILE).touch()
    with (
        pytest.raises(SessionDiedError, match="disk"),
        drawing(tmp_path / "a.gif", tmp_path, drawn.append),
    ):
        raise SessionDiedError("The disk is full.", hint="x")
    assert len(drawn) == has_poses


@pytest.fixture
def driven(tmp_path: Path) -> Path:
    """The folder of a live run in which a box was driven for two seconds."""
    shape = Collision(geometry=Box(size=(0.2, 0.2, 0.2)))
    link = Link(name="link", collisions=(shape,))
    box = SpawnedRobot(entity="box", robot=Robot(name="box", root="link", links=(link,)))
    corners = {"box": [(-0.1, -0.1, 0.0), (0.1, 0.1, 0.2)]}
    with (tmp_path / POSE_LOG_FILE).open("w") as stream:
        writer = PoseLogWriter(stream)
        for number in range(FRAMES):
            pose = Pose(xyz=(number / FRAMES, 0.0, 0.1))
            writer.add({"box": {"link": pose}}, {} if number else corners, [] if number else [box])
    scene = LiveScene(scene=Scene(world=World(name="w"), robots=(box,)), simulator="gz")
    (tmp_path / SCENE_FILE).write_text(encode(scene))
    return tmp_path


@pytest.mark.slow
def test_a_drawing_says_how_far_it_is(driven: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clock, "LOOK_EVERY", 0.001)
    heard: list[Event] = []
    reported: list[Recorded] = []
    assert video.draw_video(driven, driven / "x.gif", reported.append, heard.append) == ()
    assert [one.file.name for one in reported] == ["x.gif"]
    began, *went_on, ended = heard
    assert isinstance(began, StepStarted)
    assert began.takes_long  # a log says it, too
    assert isinstance(ended, StepEnded)
    shown = [one.detail for one in went_on if isinstance(one, StepProgressed)]
    assert shown
    assert {one.partition(" frame ")[0] for one in shown} == {"x.gif:"}
    assert {one.partition(" of ")[2] for one in shown} == {str(FRAMES)}
    assert {one.step for one in heard} == {began.step}


@pytest.mark.slow
@pytest.mark.parametrize("has_log", [True, False])
def test_a_run_that_ends_before_a_robot_comes(driven: Path, *, has_log: bool) -> None:
    (driven / POSE_LOG_FILE).unlink()
    if has_log:
        (driven / POSE_LOG_FILE).touch()
    (found,) = video.draw_video(driven, driven / "x.gif", lambda _: None, None)
    assert found.message == "Cannot record a video: the run ended before a robot was spawned."
    assert found.hint is not None
    assert found.hint.startswith("Have the run go on until")


@pytest.mark.parametrize("end", [KeyboardInterrupt(), SystemExit(143)])
def test_a_signal_that_keeps_a_video_from_being_drawn_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: BaseException
) -> None:
    def reported_of(
        video: Path | None, *, is_run_over: bool = True, is_drawn: bool = False
    ) -> list[Path]:
        reported: list[Path] = []

        def finish(draw: Callable[[None], object]) -> None:
            if is_drawn:
                draw(None)
            raise end

        def run() -> None:
            with drawing(video, tmp_path, finish, unfinished=reported.append):
                if not is_run_over:
                    raise end

        with pytest.raises(type(end)):
            run()
        return reported

    def draw(_folder: Path, file: Path, recorded: Callable[[Recorded], None], _: object) -> None:
        recorded(Recorded(file, 1.0))

    monkeypatch.setattr("wsgen.live.run.draw_video", draw)
    file = tmp_path / "x.gif"
    assert reported_of(file) == [file]
    assert reported_of(file, is_run_over=False) == [file]  # the topics were being recorded
    assert reported_of(file, is_drawn=True) == []
    assert reported_of(None, is_run_over=False) == []
