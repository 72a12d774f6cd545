"""Videos of simulations: what is recorded and written, and what prevents a video."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from child_answers import answered
from rendering.showpieces import BLUE, GROUND, is_blue
from wsgen.diagnostics import Severity
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.model.robot import Box, Collision, Inertial, Link, Robot, Visual
from wsgen.model.transform import Pose
from wsgen.rendering import drawing, video
from wsgen.rendering.drawing import Clip, Recorder, why_no_video
from wsgen.rendering.scene_renderer import SceneRenderer
from wsgen.simulation.run import run_simulation
from wsgen.simulation.scene import RECORDING, Picture, Scene, SceneResult, SpawnedRobot, Video

if TYPE_CHECKING:
    from pathlib import Path

    from rendering.showpieces import Pixels
    from wsgen.rendering.render_items import Poses


pytestmark = pytest.mark.slow

SIZE = (0.1, 0.1, 1.0)


def pole(tilt: float = 0.2) -> SpawnedRobot:
    """It falls over."""
    link = Link(
        name="base",
        inertial=Inertial(mass=1.0, inertia=(0.084, 0.0, 0.0, 0.084, 0.0, 0.002)),
        collisions=(Collision(geometry=Box(size=SIZE)),),
        visuals=(Visual(geometry=Box(size=SIZE), rgba=BLUE),),
    )
    robot = Robot(name="r", root="base", links=(link,))
    return SpawnedRobot(entity="e", robot=robot, pose_in_world=Pose((0, 0, 0.55), (0, tilt, 0)))


def scene(file: Path, seconds: float = 1.5) -> Scene:
    return Scene(world=GROUND, robots=(pole(),), seconds=seconds, record=file)


def frames_of(file: Path) -> tuple[list[Pixels], list[int]]:
    """The pictures of a GIF, and how long each is shown, ms."""
    pictures, times = [], []
    with Image.open(file) as image:
        assert image.format == "GIF"
        assert image.info["loop"] == 0
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            pictures.append(np.asarray(image.convert("RGB")))
            times.append(image.info["duration"])
    return pictures, times


def upright(pixels: Pixels) -> float:
    """How much higher than wide the robot is in a picture."""
    rows, columns = np.nonzero(is_blue(pixels))
    return float(np.ptp(rows) / np.ptp(columns))


def test_a_video_shows_the_robot_from_the_start_to_the_end(tmp_path: Path) -> None:
    file = tmp_path / "video.gif"
    progress = tmp_path / "progress"
    outcome = run_simulation(replace(scene(file), progress=progress))
    assert outcome.diagnostics == ()
    assert len(outcome.robot_runs) == 1
    assert progress.read_text() == "drawing the video: frame 31 of 31"
    made = outcome.video
    assert made is not None
    assert (made.file, made.frames, made.frames_per_second) == (file, 31, 20.0)
    assert (made.width, made.height, made.is_coarse) == (480, 360, False)
    pictures, times = frames_of(file)
    assert len(pictures) == 31
    assert set(times) == {50}
    assert {picture.shape for picture in pictures} == {(360, 480, 3)}
    assert upright(pictures[0]) > 1.5  # it stands …
    assert upright(pictures[-1]) < 1.0  # … and lies
    changes = [np.abs(a.astype(int) - b).mean() for a, b in pairwise(pictures)]
    assert max(changes) < 12  # it moves, and does not flicker


def test_the_background_of_a_video_stands_still(tmp_path: Path) -> None:
    file = tmp_path / "video.gif"
    run_simulation(scene(file))
    pictures, _ = frames_of(file)
    sky = np.stack([picture[:15] for picture in pictures])
    assert np.ptp(sky, axis=0).max() == 0


def test_a_video_and_a_picture_of_one_simulation(tmp_path: Path) -> None:
    wanted = replace(scene(tmp_path / "video.gif", 0.2), picture=tmp_path / "end.png")
    outcome = run_simulation(wanted)
    assert outcome.picture == wanted.picture
    assert outcome.video is not None
    assert outcome.video.frames == 5
    assert sorted(file.name for file in tmp_path.iterdir()) == ["end.png", "video.gif"]


def test_a_video_in_dart(tmp_path: Path) -> None:
    pytest.importorskip("dartpy")
    outcome = run_simulation(replace(scene(tmp_path / "video.gif", 0.2), engine="dart"))
    assert outcome.video is not None
    assert outcome.video.frames == 5


def test_an_mp4_has_the_same_frames(tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    file = tmp_path / "video.mp4"
    outcome = run_simulation(scene(file))
    assert outcome.diagnostics == ()
    with av.open(str(file)) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (480, 360)
        assert float(stream.average_rate) == 20.0
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert len(pictures) == 31
    assert upright(pictures[0]) > 1.5
    assert upright(pictures[-1]) < 1.0


# What is recorded


def test_frames_are_taken_at_a_fixed_rate() -> None:
    asked: list[str] = []

    def link_poses(entity: str) -> dict[str, Pose]:
        asked.append(entity)
        return {"base": Pose()}

    recorder = Recorder(link_poses, 1.0, immobile={"wall"})
    for look in range(101):
        recorder(look / 100, ["robot", "wall"])
    assert recorder.rate == 20.0
    (clip,) = recorder.shown
    assert len(clip.frames) == 21
    assert asked.count("robot") == 21
    assert asked.count("wall") == 1
    assert all(set(frame) == {"robot", "wall"} for frame in clip.frames)


def test_a_behavior_is_a_clip_and_the_standing_before_it_is_left_out() -> None:
    recorder = Recorder(lambda _: {}, 2.0)
    for look in range(101):
        recorder(look / 100, ["robot"])
    recorder.begin("forward", 1.3)  # after it has come to rest again
    for look in range(130, 231):
        recorder(look / 100, ["robot"])
    recorder.begin("nothing", 2.5)
    assert [(clip.name, len(clip.frames)) for clip in recorder.shown] == [("forward", 21)]


@pytest.mark.parametrize(("seconds", "rate"), [(3, 20.0), (30, 20.0), (60, 10.0), (1e4, 0.06)])
def test_long_simulations_have_fewer_frames_a_second(seconds: float, rate: float) -> None:
    recorder = Recorder(lambda _: {}, seconds)
    assert recorder.rate == pytest.approx(rate, rel=0.01)
    assert (100 / recorder.rate) % 1 == pytest.approx(0.0)  # what GIF can count


def made_of(file: Path, frames: list[Poses], announced: list[str]) -> Video:
    robot = pole()
    scene_renderer = SceneRenderer(
        Scene(world=GROUND, robots=(robot,)), frames[0], {"e": [(0, 0, 0)]}
    )
    recorder = Recorder(lambda _: {}, 1.0)
    recorder.clips = [Clip(frames=frames)]
    return video.draw_video(scene_renderer, recorder, file, announced.append)


def test_what_takes_long_to_draw_gets_fewer_and_smaller_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames: list[Poses] = [{"e": {"base": Pose((0.0, 0.0, 0.5 + n / 20))}} for n in range(21)]
    file, announced = tmp_path / "video.gif", list[str]()
    usual = made_of(file, frames, announced)
    assert not usual.is_coarse
    assert announced[:2] == ["frame 1 of 21", "frame 2 of 21"]
    monkeypatch.setattr(video, "BUDGET", 0.1)
    coarse = made_of(file, frames, announced)
    assert coarse.is_coarse
    assert coarse.frames < usual.frames
    assert (coarse.width, coarse.height) == (320, 240)
    pictures, times = frames_of(file)
    assert len(pictures) == coarse.frames
    assert times[0] == pytest.approx(1000 / coarse.frames_per_second, abs=10)


def test_what_a_video_is_like_depends_on_what_is_drawn_alone() -> None:
    assert video._quality(12, 61)[0] == video.LARGE
    assert video._quality(12, 601)[0] == video.LARGE
    assert video._quality(2_000_000, 61)[0] == video.SMALL
    assert video._quality(20_000, 121)[1] > video._quality(12, 121)[1]


@pytest.mark.parametrize(("triangles", "word"), [(12, "seconds"), (90_000, "meshes")])
def test_a_coarse_video_says_what_made_it_so(tmp_path: Path, triangles: int, word: str) -> None:
    made = Video(
        file=tmp_path / "video.gif",
        frames=600,
        frames_per_second=20.0,
        width=320,
        height=240,
        triangles=triangles,
        is_coarse=True,
    )

    def run(*_: object, **__: object) -> Answered:
        return answered(SceneResult(robot_runs=(), refused={}, video=made, seconds={}))

    (found,) = run_simulation(scene(tmp_path / "video.gif"), run=run).diagnostics
    assert (found.code, found.severity) == ("SPN071", Severity.INFO)
    assert f"600 frames of {triangles:,} triangles" in found.message
    assert word in (found.hint or "")


def test_a_video_of_behaviors_names_each_on_a_card(tmp_path: Path) -> None:
    robot = pole()
    moments: list[Poses] = [{"e": {"base": Pose((x, 0.0, 0.5))}} for x in (0.0, 1.0)]
    begin, end = moments
    scene_renderer = SceneRenderer(Scene(world=GROUND, robots=(robot,)), begin, {"e": [(0, 0, 0)]})
    recorder = Recorder(lambda _: {}, 1.0)
    recorder.clips += [Clip("there", [begin, end]), Clip("and back again " * 9, [begin, end])]
    announced: list[str] = []
    made = video.draw_video(scene_renderer, recorder, tmp_path / "video.gif", announced.append)
    assert announced == [f"frame {number} of 4" for number in (1, 2, 3, 4)]
    assert made.frames == 4 + 2 * 16  # a card of 0.8 s before each
    pictures, times = frames_of(tmp_path / "video.gif")
    cards = [not (is_blue(one) & (one[..., 0] < 100)).any() for one in pictures]  # pale
    assert cards == [True, False, False, True, False, False]  # equal ones are one picture
    assert times == [800, 50, 50, 800, 50, 50]
    for card in (pictures[0], pictures[3]):
        dark = card.max(axis=2) < 90
        assert dark[150:210].any()
        assert not dark[:, :10].any()
        assert not dark[:, -10:].any()


def test_a_robot_that_is_nowhere_at_the_end_stays_where_it_was(tmp_path: Path) -> None:
    there, nowhere = Pose((0.0, 0.0, 0.5)), Pose((float("nan"), 0.0, 0.0))
    frames: list[Poses] = [{"e": {"base": pose}} for pose in (there, there, nowhere)]
    file = tmp_path / "video.gif"
    made_of(file, frames, [])
    pictures, _ = frames_of(file)
    assert is_blue(pictures[-1]).sum() == is_blue(pictures[0]).sum() > 1000


def test_a_model_that_is_the_ground_is_shown_as_ground(tmp_path: Path) -> None:
    """As in the picture, from the first frame to the last."""
    slab = Box(size=(100.0, 100.0, 1.0))
    link = Link(name="l", visuals=(Visual(geometry=slab, rgba=(0.0, 0.8, 0.0, 1.0)),))
    floor = SpawnedRobot(
        entity="floor",
        robot=Robot(name="f", root="l", links=(link,), is_static=True),
        pose_in_world=Pose((0.0, 0.0, -0.5)),
        is_static_model=True,
    )
    file = tmp_path / "video.gif"
    outcome = run_simulation(replace(scene(file, 0.3), robots=(pole(), floor)))
    assert outcome.video is not None
    for picture in frames_of(file)[0]:
        red, green, blue = picture[10:40, 10:40].reshape(-1, 3).astype(int).T
        assert (abs(green - red) < 40).all()
        assert (abs(green - blue) < 40).all()


# What keeps a video from being made


def refused(outcome_of: Scene) -> str:
    """The simulation counts, and the video's problem is an error."""
    outcome = run_simulation(outcome_of)
    assert len(outcome.robot_runs) == 1
    assert outcome.video is None
    (found,) = outcome.diagnostics
    assert (found.code, found.severity) == ("SPN070", Severity.ERROR)
    return found.message


@pytest.mark.parametrize("name", ["video.avi", "video", "video.gif.txt"])
def test_a_suffix_that_is_no_video(tmp_path: Path, name: str) -> None:
    assert ".gif nor an .mp4" in refused(scene(tmp_path / name, 0.1))
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    assert "does not exist" in refused(scene(tmp_path / "none" / "video.gif", 0.1))


def test_a_folder_in_the_place_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "video.gif").mkdir()
    assert "is not writable" in refused(scene(tmp_path / "video.gif", 0.1))


def test_a_pipe_in_the_place_of_the_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "video.gif")
    assert "is not writable" in refused(scene(tmp_path / "video.gif", 0.1))


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_to(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    assert "is not writable" in refused(scene(tmp_path / "video.gif", 0.1))


def test_a_disk_that_is_full(tmp_path: Path) -> None:
    (tmp_path / "video.gif").symlink_to("/dev/full")
    assert "the disk is full" in refused(scene(tmp_path / "video.gif", 0.1))
    assert (tmp_path / "video.gif").is_char_device()  # it is written to, not replaced


def test_without_the_encoder_an_mp4_is_refused_with_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing, "ENCODER", "no_such_encoder")
    problem = why_no_video(tmp_path / "video.mp4")
    assert problem is not None
    assert "name a .gif" in problem
    assert "pip install 'wsgen[video]'" in problem
    assert why_no_video(tmp_path / "video.gif") is None


def test_an_engine_that_dies_while_it_records_costs_the_video_alone(tmp_path: Path) -> None:
    wanted = replace(scene(tmp_path / "video.gif", 0.1), picture=tmp_path / "end.png")
    asked: list[Scene] = []

    def dies_once(
        task: str, *arguments: object, limits: Limits = DEFAULT_LIMITS, **_: object
    ) -> Answered | Died:
        (now,) = arguments
        assert isinstance(now, Scene)
        asked.append(now)
        if now.record is not None:
            return Died(reason="crashed (SIGSEGV)", step=f"{RECORDING}: frame 2 of 3", output="")
        return answered(
            SceneResult(robot_runs=(), refused={}, picture=Picture(tile=0.5), seconds={})
        )

    outcome = run_simulation(wanted, run=dies_once)
    assert [one.record for one in asked] == [wanted.record, None]
    assert outcome.picture == wanted.picture
    (found,) = outcome.diagnostics
    assert found.code == "SPN070"
    assert "crashed (SIGSEGV) while it was drawing the video: frame 2 of 3" in found.message


def test_a_simulation_without_a_video_loads_nothing_for_it() -> None:
    script = "import sys, wsgen.pipeline.tasks.bullet; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, text=True)
    loaded = run.stdout.split()
    assert "wsgen.simulation.bullet" in loaded
    drawing = {"wsgen.rendering.video", "wsgen.rendering.scene_renderer"}
    assert not {"PIL", "av", *drawing} & set(loaded)
