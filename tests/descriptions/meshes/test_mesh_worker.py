"""Reading mesh files, whole and broken."""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
import sys
import time
import warnings
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import mesh_samples
from wsgen.descriptions.meshes import worker
from wsgen.descriptions.meshes.content import BrokenMeshError, EnormousMeshError
from wsgen.descriptions.meshes.requests import (
    MISSING_MATERIAL_LIBRARY,
    InspectedMesh,
    MeshRequest,
    UnusableMesh,
)
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.descriptions.meshes.worker import READ, read_mesh
from wsgen.model.robot import MeshPart

if TYPE_CHECKING:
    from collections.abc import Iterator


QUADS_OBJ = mesh_samples.obj(
    "f 1 2 4 3", "f 5 7 8 6", "f 1 5 6 2", "f 3 4 8 7", "f 1 3 7 5", "f 2 6 8 4"
)


def write(folder: Path, name: str, content: bytes | str) -> Path:
    file = folder / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


ONCE = (False,)


def inspect(file: Path, folder: Path) -> InspectedMesh | UnusableMesh:
    """What is said of a file that is both touched and seen."""
    request = MeshRequest(path=str(file), is_collision=True, is_visual=True)
    (answer,) = worker.inspect([request], folder)
    return answer


def usable(file: Path, folder: Path) -> InspectedMesh:
    answer = inspect(file, folder)
    assert isinstance(answer, InspectedMesh), answer
    return answer


def unusable(file: Path, folder: Path) -> UnusableMesh:
    answer = inspect(file, folder)
    assert isinstance(answer, UnusableMesh), answer
    return answer


def inspect_materials(file: Path, folder: Path) -> InspectedMesh | UnusableMesh:
    """What is said of a file that is touched, and seen with its materials."""
    request = MeshRequest(path=str(file), is_collision=True, is_visual=False, showings=ONCE)
    (answer,) = worker.inspect([request], folder)
    return answer


def box_of(file: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    points = read_mesh(Path(file)).corners.reshape(-1, 3)
    return tuple(points.min(axis=0).tolist()), tuple(points.max(axis=0).tolist())


LID = "v 0 0 9\nv 4 0 9\nv 0 2 9\nf -3 -2 -1\n"
PARTS_OBJ = mesh_samples.obj().replace(b"\nf", b"\no Body\nf", 1).decode() + f"g Lid of it\n{LID}"
PARTS_DAE = mesh_samples.dae(
    node=f'<node name="Body">{mesh_samples.PLACED}</node><node name="Lid of it">'
    f"<translate>5 0 9</translate>{mesh_samples.PLACED}</node>"
)


@pytest.mark.parametrize("name", ["parts.obj", "parts.dae"])
def test_a_part_of_a_file_is_read_alone(tmp_path: Path, name: str) -> None:
    file = write(tmp_path, name, PARTS_OBJ if name.endswith("obj") else PARTS_DAE)
    whole = read_mesh(file).corners
    body = read_mesh(file, MeshPart("Body"), with_materials=True)
    assert len(body.corners) == sum(len(patch.corners) for patch in body.patches) == 12
    is_low = whole[:, 0, 2] < 5
    assert np.array_equal(body.corners, whole[is_low])
    lid = read_mesh(file, MeshPart("Lid of it")).corners
    assert np.array_equal(lid, whole[~is_low])
    centered = read_mesh(file, MeshPart("Lid of it", is_centered=True), with_materials=True)
    middle = (lid.reshape(-1, 3).min(axis=0) + lid.reshape(-1, 3).max(axis=0)) / 2
    assert np.allclose(centered.corners, lid - middle)
    assert np.allclose(centered.patches[0].corners, centered.corners)

    part = MeshPart("Lid of it")
    request = MeshRequest(path=str(file), part=part, is_collision=True, is_visual=True)
    (answer,) = worker.inspect([request], tmp_path)
    assert isinstance(answer, InspectedMesh)
    assert (answer.triangles, answer.low[2]) == (len(lid), lid[..., 2].min())
    for engines in (answer.collision, answer.visual):
        assert np.allclose(read_mesh(Path(engines)).corners, lid)


def test_a_part_that_a_file_does_not_have(tmp_path: Path) -> None:
    file = write(tmp_path, "parts.obj", PARTS_OBJ)
    with pytest.raises(BrokenMeshError) as caught:
        read_mesh(file, MeshPart("Lit"))
    assert "`Lit`" in caught.value.problem
    assert caught.value.hint == "Write the name of one of its parts: `Body`, `Lid of it`."
    file = write(tmp_path, "box.stl", mesh_samples.binary_stl())
    with pytest.raises(BrokenMeshError) as caught:
        read_mesh(file, MeshPart("Body"))
    assert "Remove <submesh>" in caught.value.hint


# Name, content, triangles, and which of the two (collision, visual) is written anew.
WHOLE: dict[str, tuple[bytes | str, int, tuple[bool, bool]]] = {
    "binary.stl": (mesh_samples.binary_stl(), 12, (False, False)),
    "BINARY.STL": (mesh_samples.binary_stl(), 12, (False, False)),
    "binary_called_solid.stl": (b"solid" + mesh_samples.binary_stl()[5:], 12, (False, False)),
    "text.stl": (mesh_samples.text_stl(), 12, (True, True)),
    "windows.stl": (mesh_samples.text_stl().replace(b"\n", b"\r\n"), 12, (True, True)),
    "capitals.stl": (mesh_samples.text_stl().upper(), 12, (True, True)),
    "triangles.obj": (mesh_samples.obj(), 12, (False, False)),
    "quads.obj": (QUADS_OBJ, 12, (False, False)),
    "mixed.obj": (
        QUADS_OBJ.replace(b"f 1 2 4 3", b"f 1 2 4\nf 1 4 3\nl 1 2\nf 1 2"),
        12,
        (False, False),
    ),
    "tabs.obj": (QUADS_OBJ.replace(b" ", b"\t"), 12, (False, False)),
    "indented.obj": (QUADS_OBJ.replace(b"\n", b"\n  "), 12, (False, False)),
    "continued.obj": (QUADS_OBJ.replace(b" 4 3", b" \\\n4 3"), 12, (False, False)),
    "macintosh.obj": (QUADS_OBJ.replace(b"\n", b"\r"), 12, (False, False)),
    "textured.obj": (
        mesh_samples.obj("vt 0 0", "f 1/1 2/1 4/1 3/1", "f 5//1 7//2 8//3 6//4", "f 1/1/1 5/1/1 8"),
        5,
        (False, False),
    ),
    "colored.obj": (QUADS_OBJ.replace(b"1.5\n", b"1.5 1 0 0.5\n"), 12, (False, False)),
    "half_colored.obj": (QUADS_OBJ.replace(b"-1.5\n", b"-1.5 1 0 0.5\n"), 12, (False, False)),
    "backwards.obj": (
        mesh_samples.obj("f -8 -7 -5 -6", "v 9 9 9", "f -5 -3 -2 -4"),
        4,
        (False, False),
    ),
    "triangles.dae": (mesh_samples.dae(), 12, (True, False)),
    "y_up.dae": (mesh_samples.dae(asset="<up_axis>Y_UP</up_axis>"), 12, (True, False)),
    "quads.dae": (mesh_samples.dae(mesh_samples.QUADS), 12, (True, True)),
    "both.dae": (
        mesh_samples.dae(mesh_samples.QUADS + mesh_samples.TRIANGLES),
        24,
        (True, True),
    ),
    "empty_too.dae": (
        mesh_samples.dae(
            '<triangles count="0"><input semantic="VERTEX" source="#v" offset="0"/><p/></triangles>'
            + mesh_samples.TRIANGLES
        ),
        12,
        (True, True),
    ),
    "latin.dae": (
        mesh_samples.dae(asset="<title>\xe9</title>").encode("latin-1"),
        12,
        (True, False),
    ),
    "mark.dae": (b"\xef\xbb\xbf" + mesh_samples.dae().encode(), 12, (True, False)),
    "behind.dae": (mesh_samples.dae() + "</COLLADA>\0\0", 12, (True, False)),
}


@pytest.mark.parametrize("name", WHOLE)
def test_whole_files(tmp_path: Path, name: str) -> None:
    content, triangles, is_written_anew = WHOLE[name]
    file = write(tmp_path, name, content)
    answer = usable(file, tmp_path)
    assert answer.inconsistency is None
    assert answer.triangles == triangles
    assert (answer.low, answer.high) == mesh_samples.BOX
    for used, is_new in zip((answer.collision, answer.visual), is_written_anew, strict=True):
        assert (used != str(file)) == is_new
        assert box_of(used) == (answer.low, answer.high)


@pytest.mark.slow
@pytest.mark.parametrize("name", mesh_samples.BROKEN)
def test_broken_files(tmp_path: Path, name: str) -> None:
    content, words = mesh_samples.BROKEN[name]
    answer = unusable(write(tmp_path, name, content), tmp_path)
    assert words in answer.problem
    assert answer.hint
    assert not answer.is_enormous


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("behind.stl", mesh_samples.binary_stl(behind=b"more"), "has 4 more bytes"),
        ("few.stl", mesh_samples.binary_stl(claimed=11), "11 triangles"),
        ("no_asset.dae", mesh_samples.dae().replace("<asset></asset>", ""), "no <asset>"),
        (
            "million.dae",
            mesh_samples.dae().replace('count="24"', 'count="1000000"'),
            'has count="1000000" in a <float_array>, but 24 values',
        ),
        ("few.dae", mesh_samples.dae().replace('s count="12"', 's count="9"'), "but 12 values"),
    ],
)
def test_what_only_pybullet_minds_is_written_anew(
    tmp_path: Path, name: str, content: bytes | str, words: str
) -> None:
    file = write(tmp_path, name, content)
    answer = usable(file, tmp_path)
    assert words in (answer.inconsistency or "")
    assert str(file) not in {answer.collision, answer.visual}
    assert (answer.low, answer.high) == mesh_samples.BOX


def test_what_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    (tmp_path / "folder.stl").mkdir()
    problems = [
        unusable(tmp_path / name, tmp_path).problem
        for name in ("pipe.stl", "folder.stl", "missing.stl")
    ]
    assert problems == [
        "is a named pipe",
        "is a folder",
        "cannot be read (No such file or directory)",
    ]


@pytest.mark.slow
def test_a_million_triangles_are_read_and_one_more_is_not(tmp_path: Path) -> None:
    corners = np.zeros((1_000_001, 3, 3), np.float32)
    corners[:, 1, 0] = 1.0
    started = time.process_time()
    write_stl(corners[:-1], tmp_path / "million.stl")
    assert usable(tmp_path / "million.stl", tmp_path).triangles == 1_000_000
    assert time.process_time() - started < 5
    write_stl(corners, tmp_path / "more.stl")
    answer = unusable(tmp_path / "more.stl", tmp_path)
    assert answer.is_enormous
    assert "1,000,001" in answer.problem


def test_a_huge_file_is_not_opened(tmp_path: Path) -> None:
    with (tmp_path / "huge.obj").open("wb") as stream:
        stream.truncate(10**12)  # without content, and without space on the disk
    with pytest.raises(EnormousMeshError, match="1000000 MB"):
        read_mesh(tmp_path / "huge.obj")


def test_a_name_counts_with_its_capitals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a file system that finds part.stl where PART.STL is."""
    file = write(tmp_path, "part.stl", mesh_samples.binary_stl())
    monkeypatch.setattr(os, "listdir", lambda _: ["PART.STL"])
    with pytest.raises(BrokenMeshError, match="upper and lower case"):
        read_mesh(file)


@pytest.mark.slow
def test_the_reader_is_loaded_without_the_library() -> None:
    script = "import sys, wsgen.descriptions.meshes.worker as _; print('trimesh' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    assert run.stdout == b"False\n"


def damaged(content: bytes) -> Iterator[bytes]:
    """The content cut short at many places, and with some bytes changed."""
    yield from (content[:size] for size in range(0, len(content), max(1, len(content) // 25)))
    chance = random.Random(len(content))  # noqa: S311  the same changes in each run
    for changes in (1, 1, 3, 10) * 15:
        changed = bytearray(content)
        for _ in range(changes):
            changed[chance.randrange(len(changed))] = chance.randrange(256)
        yield bytes(changed)


def samples() -> dict[str, bytes]:
    """A whole file of each format."""
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((0.5, 2.0, 3.0))
    text_ply = box.export(file_type="ply", encoding="ascii")
    return {
        "binary.stl": mesh_samples.binary_stl(),
        "text.stl": mesh_samples.text_stl(),
        "square.obj": mesh_samples.square_obj(head="mtllib square.mtl\n").encode(),
        "quads.obj": QUADS_OBJ,
        "triangles.dae": mesh_samples.colored_dae(mesh_samples.RED).encode(),
        "quads.dae": mesh_samples.dae(mesh_samples.QUADS).encode(),
        "box.glb": trimesh.Scene(box).export(file_type="glb"),
        "box.gltf": trimesh.Scene(box).export(file_type="gltf")["model.gltf"],
        "binary.ply": box.export(file_type="ply"),
        "text.ply": text_ply if isinstance(text_ply, bytes) else text_ply.encode(),
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "binary.ply",
        "text.ply",
        "box.glb",
        "box.gltf",
        *("binary.stl", "text.stl", "square.obj", "quads.obj", "triangles.dae", "quads.dae"),
    ],
)
def test_damaged_files_are_reported_in_words(tmp_path: Path, name: str) -> None:
    """No exception of a library, and none of Python's, is reported by its name."""
    content = samples()[name]
    file = write(tmp_path, name, content)
    problems = set()
    for changed in damaged(content):
        write(tmp_path, name, changed)
        answer = inspect_materials(file, tmp_path)
        if isinstance(answer, UnusableMesh):
            words = [answer.problem]
            problems.add(answer.problem)
        else:
            words = [found.problem for found in answer.material_problems]
        exception = re.compile(r"Error|Exception|\b(object|index|array)\b|Traceback")
        assert not any(map(exception.search, words)), words
    assert problems - {"is empty (0 bytes)"}


@pytest.mark.parametrize("kind", ["stl", "obj", "dae"])
def test_our_own_readers_raise_nothing_else(tmp_path: Path, kind: str) -> None:
    for name, content in samples().items():
        for changed in damaged(content) if name.endswith(kind) else ():
            with suppress(BrokenMeshError), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                READ[kind](changed, tmp_path, None)


@pytest.mark.parametrize("kind", ["glb", "ply"])
def test_files_cut_short(tmp_path: Path, kind: str) -> None:
    content = samples()["box.glb" if kind == "glb" else "binary.ply"]
    answer = unusable(write(tmp_path, f"cut.{kind}", content[: len(content) // 2]), tmp_path)
    assert "it is cut short" in answer.problem


@pytest.mark.parametrize("target", ["/dev/zero", "pipe", "missing.bin", "large.bin", "folder"])
def test_files_that_a_mesh_names(tmp_path: Path, target: str) -> None:
    """A device, a pipe and a huge file are never read, whichever format names them."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    with (tmp_path / "large.bin").open("wb") as stream:
        stream.truncate(10**12)
    gltf = json.loads(samples()["box.gltf"])
    gltf["buffers"] = [{**buffer, "uri": target} for buffer in gltf["buffers"]]
    broken = unusable(write(tmp_path, "box.gltf", json.dumps(gltf)), tmp_path)
    assert f"needs the file `{target}`, which " in broken.problem
    content = mesh_samples.square_obj(head=f"mtllib {target}\n")
    file = write(tmp_path, "square.obj", content)
    answer = inspect_materials(file, tmp_path)
    assert isinstance(answer, InspectedMesh)
    (found,) = answer.material_problems
    assert found.rule is MISSING_MATERIAL_LIBRARY
    assert f"its material library `{target}`" in found.problem


@pytest.mark.parametrize("keyword", ["mtllib", "  mtllib", "\tmtllib"])
def test_no_engine_gets_the_name_of_a_material_library(tmp_path: Path, keyword: str) -> None:
    """Engines open it, whatever it is, where they load the OBJ."""
    content = mesh_samples.obj().decode()
    file = write(tmp_path, "box.obj", f"o box\n{keyword} /dev/zero\n{content}")
    answer = usable(file, tmp_path)
    for used in (answer.collision, answer.visual):
        assert Path(used).suffix == ".obj"  # which engines cut into its objects
        assert b"mtllib" not in Path(used).read_bytes()
        assert box_of(used) == (answer.low, answer.high)


@pytest.mark.parametrize("kind", ["glb", "gltf", "ply"])
def test_what_the_library_reads_is_written_anew(tmp_path: Path, kind: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    pose = np.diag([1.0, 1.0, 1.0, 1.0])
    pose[:3, 3] = (0.25, 0.0, 0.0)
    box = trimesh.creation.box((0.5, 2.0, 3.0))
    scene.add_geometry(box, transform=pose)
    scene.add_geometry(box, transform=np.linalg.inv(pose))
    file = tmp_path / f"box.{kind}"
    if kind == "gltf":
        for name, content in scene.export(file_type="gltf").items():
            (tmp_path / name.replace("model.gltf", "box.gltf")).write_bytes(content)
    else:
        (scene if kind == "glb" else scene.to_mesh()).export(file)
    answer = usable(file, tmp_path)
    assert answer.triangles == 24
    assert np.allclose((answer.low, answer.high), mesh_samples.BOX)
    assert np.allclose(box_of(answer.collision), mesh_samples.BOX)
    assert answer.collision == answer.visual != str(file)
    cut = write(tmp_path, f"cut.{kind}", file.read_bytes()[: file.stat().st_size * 2 // 3])
    assert unusable(cut, tmp_path).problem
