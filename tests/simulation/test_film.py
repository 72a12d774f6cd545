import io
from pathlib import Path

from wsgen.model.transform import Pose
from wsgen.simulation.film import FilmWriter, read_film

BOX = {"link": Pose(xyz=(3.0, 0.0, 0.25))}


def rover(x: float) -> dict[str, Pose]:
    return {"base": Pose(xyz=(x, 0.0, 0.1), rpy=(0.0, 0.0, x)), "wheel": Pose(xyz=(x, 0.2, 0.1))}


def written(*frames: dict[str, dict[str, Pose]]) -> str:
    stream = io.StringIO()
    writer = FilmWriter(stream)
    seen: set[str] = set()
    for frame in frames:
        writer.add(frame, {entity: [(1.0, 2.0, 3.0)] for entity in frame.keys() - seen})
        seen |= frame.keys()
    return stream.getvalue()


def test_frames_come_back(tmp_path: Path) -> None:
    frames = [
        {"box": BOX},
        {"box": BOX, "rover": rover(0.0)},
        {"box": BOX, "rover": rover(0.5)},
        {"box": BOX},
    ]
    file = tmp_path / "film.jsonl"
    file.write_text(written(*frames))
    film = read_film(file)
    assert film.frames == frames
    assert film.corners == {"box": [(1.0, 2.0, 3.0)], "rover": [(1.0, 2.0, 3.0)]}
    assert file.read_text().count("box") == 2  # with its pose, and with its corners


def test_a_writer_that_is_killed_leaves_whole_frames(tmp_path: Path) -> None:
    text = written({"rover": rover(0.0)}, {"rover": rover(0.5)})
    file = tmp_path / "film.jsonl"
    for end in range(len(text)):
        file.write_text(text[:end])
        assert len(read_film(file).frames) == text[:end].count("\n")
