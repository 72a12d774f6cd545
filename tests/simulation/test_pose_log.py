import io
from pathlib import Path

import pytest

from wsgen.model.robot import Box, Collision, Link, Robot
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.pipeline.tasks.video import draw
from wsgen.simulation.live_runs import PoseLogWriter, read_pose_log
from wsgen.simulation.scene import Scene, SpawnedRobot, Video

BOX = {"link": Pose(xyz=(3.0, 0.0, 0.25))}


def rover(x: float) -> dict[str, Pose]:
    return {"base": Pose(xyz=(x, 0.0, 0.1), rpy=(0.0, 0.0, x)), "wheel": Pose(xyz=(x, 0.2, 0.1))}


def written(*frames: dict[str, dict[str, Pose]]) -> str:
    stream = io.StringIO()
    writer = PoseLogWriter(stream)
    seen: set[str] = set()
    for frame in frames:
        fresh = sorted(frame.keys() - seen)
        robots = [
            SpawnedRobot(entity=name, robot=Robot(name=name, root="link", links=()))
            for name in fresh
        ]
        writer.add(frame, {entity: [(1.0, 2.0, 3.0)] for entity in fresh}, robots)
        seen |= frame.keys()
    return stream.getvalue()


def test_frames_come_back(tmp_path: Path) -> None:
    frames = [
        {"box": BOX},
        {"box": BOX, "rover": rover(0.0)},
        {"box": BOX, "rover": rover(0.5)},
        {"box": BOX},
    ]
    file = tmp_path / "poses.jsonl"
    file.write_text(written(*frames))
    log = read_pose_log(file)
    assert log.frames == frames
    assert log.corners == {"box": [(1.0, 2.0, 3.0)], "rover": [(1.0, 2.0, 3.0)]}
    assert [robot.entity for robot in log.robots] == ["box", "rover"]
    # With its pose, its corners, and in its description as entity and name.
    assert file.read_text().count('"box"') == 4


@pytest.mark.slow
def test_a_writer_that_is_killed_leaves_whole_frames(tmp_path: Path) -> None:
    text = written({"rover": rover(0.0)}, {"rover": rover(0.5)})
    file = tmp_path / "poses.jsonl"
    for end in range(len(text)):
        file.write_text(text[:end])
        assert len(read_pose_log(file).frames) == text[:end].count("\n")


@pytest.mark.slow
def test_a_video_has_the_robots_of_the_log(tmp_path: Path) -> None:
    def box(name: str, size: float) -> SpawnedRobot:
        shape = Collision(geometry=Box(size=(size, size, size)))
        return SpawnedRobot(
            entity=name,
            robot=Robot(name=name, root="link", links=(Link(name="link", collisions=(shape,)),)),
        )

    log_file = tmp_path / "poses.jsonl"
    with log_file.open("w") as stream:
        PoseLogWriter(stream).add(
            {"guest": BOX}, {"guest": [(2.9, 0.0, 0.2), (3.1, 0.1, 0.3)]}, [box("guest", 0.2)]
        )
    scene = Scene(world=World(name="w"), robots=(box("planned", 3.0),))
    done = draw(scene, log_file, tmp_path / "a.gif")
    assert isinstance(done, Video), done
    assert (tmp_path / "a.gif").stat().st_size > 0
