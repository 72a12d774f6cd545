"""Looking into the meshes of a robot."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import mesh_samples
from child_answers import answered
from descriptions.meshes.public_meshes import PACKAGES, differences, meshes_of
from wsgen.descriptions.meshes import worker
from wsgen.descriptions.meshes.inspection import DEATHS, inspect_meshes
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.result import Answered, Died, Limits
from wsgen.model.robot import Box, Collision, Geometry, Link, Mesh, Robot, Visual

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


ROBOT_FILE = Path("robot.urdf")
IN_TEN_SECONDS = Limits(seconds=10.0, memory=2 * 2**30)


@pytest.fixture(scope="module")
def run() -> Iterator[Callable[..., Answered | Died]]:
    with ForkServer() as fork_server:
        yield fork_server.run


def in_this_process(task: str, *arguments: Any, **_: Any) -> Answered | Died:
    assert task == "wsgen.descriptions.meshes.worker:inspect"
    return answered(worker.inspect(*arguments))


def mesh(file: Path, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Mesh:
    return Mesh(uri=f"package://p/{file.name}", path=str(file), scale=scale)


def robot(*collisions: Geometry, visuals: tuple[Geometry, ...] = ()) -> Robot:
    link = Link(
        name="arm",
        line=7,
        collisions=tuple(Collision(geometry=geometry) for geometry in collisions),
        visuals=tuple(Visual(geometry=geometry) for geometry in visuals),
    )
    return Robot(name="r", root="arm", links=(link,))


def write(folder: Path, name: str, content: bytes | str) -> Path:
    file = folder / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


def paths(model: Robot) -> tuple[list[str | None], list[str | None]]:
    """Those of the collisions, and of the visuals."""
    (link,) = model.links
    collisions = [one.geometry for one in link.collisions]
    visuals = [one.geometry for one in link.visuals]
    return (
        [one.path for one in collisions if isinstance(one, Mesh)],
        [one.path for one in visuals if isinstance(one, Mesh)],
    )


def kinds(found: tuple[Diagnostic, ...]) -> list[tuple[str, Severity]]:
    return [(one.code, one.severity) for one in found]


def test_a_robot_without_meshes_starts_no_child(tmp_path: Path) -> None:
    def refuse(*_: Any, **__: Any) -> Answered | Died:
        raise AssertionError("a child was started")

    model = robot(Box(size=(1, 1, 1)), Mesh(uri="package://p/missing.stl"))
    assert inspect_meshes(model, file=None, folder=tmp_path, run=refuse) == (model, ())
    assert list(tmp_path.iterdir()) == []


def test_good_meshes_stay(tmp_path: Path, run: Callable[..., Any]) -> None:
    stl = write(tmp_path, "a.stl", mesh_samples.binary_stl())
    obj = write(tmp_path, "a.obj", mesh_samples.obj())
    dae = write(tmp_path, "a.dae", mesh_samples.dae())
    model = robot(mesh(stl), mesh(obj), visuals=(mesh(stl), mesh(obj), mesh(dae)))
    changed, found = inspect_meshes(model, file=ROBOT_FILE, folder=tmp_path, run=run)
    assert found == ()
    assert paths(changed) == paths(model)
    (link,) = changed.links
    geometries = [one.geometry for one in link.collisions]
    geometries += [one.geometry for one in link.visuals]
    for geometry in geometries:
        assert isinstance(geometry, Mesh)
        assert geometry.bounds == mesh_samples.BOX


def test_what_pybullet_does_not_read_is_written_anew(
    tmp_path: Path, run: Callable[..., Any]
) -> None:
    text = write(tmp_path, "text.stl", mesh_samples.text_stl())
    dae = write(tmp_path, "a.dae", mesh_samples.dae())
    model = robot(mesh(text, (1, 2, 3)), mesh(dae), visuals=(mesh(text), mesh(dae)))
    folder = tmp_path / "new"
    folder.mkdir()
    changed, found = inspect_meshes(model, file=ROBOT_FILE, folder=folder, run=run)
    assert found == ()
    (first, second), (third, fourth) = paths(changed)
    assert fourth == str(dae)  # seen, it has smooth edges
    assert first == third  # read and written once
    for new in (first, second):
        assert new is not None
        assert folder in Path(new).parents
        assert Path(new).stat().st_size == len(mesh_samples.binary_stl())
    geometry = changed.links[0].collisions[0].geometry
    assert geometry == replace(mesh(text, (1, 2, 3)), path=first, bounds=mesh_samples.BOX)
    again, _ = inspect_meshes(model, file=ROBOT_FILE, folder=folder, run=run)
    assert paths(again) != paths(changed)  # two robots may share the folder


def test_a_pointer_of_git_lfs_says_how_to_get_the_file(
    tmp_path: Path, run: Callable[..., Any]
) -> None:
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 84\n"
    meshes = [mesh(write(tmp_path, f"a.{kind}", pointer)) for kind in ("stl", "dae", "obj")]
    _, found = inspect_meshes(robot(*meshes), file=ROBOT_FILE, folder=tmp_path, run=run)
    assert [one.code for one in found] == ["ROB062"] * 3
    for one in found:
        assert "is a Git LFS pointer" in one.message
        assert "git lfs pull" in (one.hint or "")


def test_a_broken_collision_is_an_error_and_a_broken_visual_a_warning(
    tmp_path: Path, run: Callable[..., Any]
) -> None:
    good = write(tmp_path, "good.stl", mesh_samples.binary_stl())
    broken = write(tmp_path, "broken.stl", mesh_samples.binary_stl()[:-20])
    box = Box(size=(1, 1, 1))
    changed, found = inspect_meshes(
        robot(mesh(broken), mesh(good), visuals=(mesh(broken), mesh(good), box)),
        file=ROBOT_FILE,
        folder=tmp_path,
        run=run,
    )
    assert kinds(found) == [("ROB062", Severity.ERROR), ("ROB063", Severity.WARNING)]
    assert found[0].message == (
        "The collision mesh `package://p/broken.stl` of the link `arm` says that it has 12 "
        f"triangles, but ends after 11: it is cut short or not STL ({broken})."
    )
    assert (found[0].file, found[0].line, found[1].element) == (
        ROBOT_FILE,
        7,
        "link[@name='arm']/visual/geometry/mesh",
    )
    assert paths(changed) == ([None, str(good)], [str(good)])
    assert changed.links[0].visuals[-1].geometry == box


@pytest.mark.slow
@pytest.mark.parametrize("with_colors", [False, True])
def test_every_broken_file_is_reported_soon(
    tmp_path: Path,
    run: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
    *,
    with_colors: bool,
) -> None:
    monkeypatch.setattr("wsgen.descriptions.meshes.inspection.LIMITS", IN_TEN_SECONDS)
    broken = [
        mesh(write(tmp_path, name, content)) for name, (content, _) in mesh_samples.BROKEN.items()
    ]
    model = robot(visuals=tuple(broken)) if with_colors else robot(*broken)
    _, found = inspect_meshes(
        model, file=ROBOT_FILE, folder=tmp_path, run=run, with_colors=with_colors
    )
    kind = ("ROB063", Severity.WARNING) if with_colors else ("ROB062", Severity.ERROR)
    assert kinds(found) == [kind] * len(broken)
    for one, (_, words) in zip(found, mesh_samples.BROKEN.values(), strict=True):
        assert words in one.message
        assert one.hint


def test_many_triangles_are_a_warning_and_far_too_many_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(tmp_path, "a.stl", mesh_samples.binary_stl())
    monkeypatch.setattr("wsgen.descriptions.meshes.inspection.MANY_TRIANGLES", 11)
    model = robot(mesh(file), visuals=(mesh(file),))
    changed, found = inspect_meshes(model, file=None, folder=tmp_path, run=in_this_process)
    assert paths(changed) == paths(model)
    assert kinds(found) == [("ROB064", Severity.WARNING)] * 2
    assert "12 triangles" in found[0].message
    monkeypatch.setattr("wsgen.descriptions.meshes.content.TRIANGLE_LIMIT", 11)
    changed, found = inspect_meshes(model, file=None, folder=tmp_path, run=in_this_process)
    assert paths(changed) == ([None], [])
    assert kinds(found) == [("ROB065", Severity.ERROR), ("ROB065", Severity.WARNING)]


@pytest.mark.parametrize(
    ("scale", "words", "hint"),
    [
        ((1000.0, 1000.0, 1000.0), "3e+03 m large", 'scale="1 1 1"'),
        ((40.0, -80.0, 1.0), "160 m large", 'scale="0.04 -0.08 0.001"'),
        ((1e-5, 1e-5, 1e-5), "3e-05 m small", 'scale="0.01 0.01 0.01"'),
        ((1e9, 1.0, 1.0), "1e+09 m large", "Check the scale"),
        ((0.0, 0.0, 0.0), "0 m small", "Check the scale"),
    ],
)
def test_parts_of_absurd_size(
    tmp_path: Path, scale: tuple[float, float, float], words: str, hint: str
) -> None:
    file = write(tmp_path, "a.stl", mesh_samples.binary_stl())
    _, found = inspect_meshes(
        robot(mesh(file, scale)), file=None, folder=tmp_path, run=in_this_process
    )
    assert kinds(found) == [("ROB066", Severity.WARNING)]
    assert words in found[0].message
    assert hint in (found[0].hint or "")


@pytest.mark.parametrize(("scale", "expected"), [(400.0, []), (600.0, ["ROB066"])])
def test_terrain_may_be_larger(tmp_path: Path, scale: float, expected: list[str]) -> None:
    file = write(tmp_path, "a.stl", mesh_samples.binary_stl())
    terrain = replace(robot(mesh(file, (scale, scale, 1.0))), is_static=True)
    _, found = inspect_meshes(terrain, file=None, folder=tmp_path, run=in_this_process)
    assert [one.code for one in found] == expected


def test_a_scale_that_is_no_number_is_not_judged_here(tmp_path: Path) -> None:
    file = write(tmp_path, "a.stl", mesh_samples.binary_stl())
    model = robot(mesh(file, (float("nan"), 1.0, 1.0)))
    assert inspect_meshes(model, file=None, folder=tmp_path, run=in_this_process)[1] == ()


def test_what_gazebo_reads_all_the_same_is_a_warning(tmp_path: Path) -> None:
    odd = write(tmp_path, "a.stl", mesh_samples.binary_stl(behind=b"more"))
    _, found = inspect_meshes(
        robot(mesh(odd), mesh(odd)), file=None, folder=tmp_path, run=in_this_process
    )
    assert kinds(found) == [("ROB067", Severity.WARNING)]


def test_formats_that_not_all_read(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    for name in ("a.glb", "a.ply"):
        trimesh.creation.box((1, 2, 3)).export(tmp_path / name)
    changed, found = inspect_meshes(
        robot(mesh(tmp_path / "a.glb"), mesh(tmp_path / "a.ply")),
        file=None,
        folder=tmp_path,
        run=in_this_process,
    )
    assert kinds(found) == [("ROB068", Severity.WARNING)] * 2
    assert "Fortress" in found[0].message
    assert all(path and path.endswith(".stl") for path in paths(changed)[0])


def test_the_robot_goes_on_without_the_mesh_that_the_reader_dies_of(tmp_path: Path) -> None:
    files = [write(tmp_path, f"{at}.stl", mesh_samples.binary_stl()) for at in range(5)]

    def run(task: str, *arguments: Any, **_: Any) -> Answered | Died:
        requests, *rest = arguments
        for number, request in enumerate(requests):
            if request.path in map(str, files[1:3]):
                return Died(reason="crashed (SIGSEGV)", step=str(number), output="")
        return in_this_process(task, requests, *rest)

    changed, found = inspect_meshes(robot(*map(mesh, files)), file=None, folder=tmp_path, run=run)
    assert kinds(found) == [("ROB062", Severity.ERROR)] * 2
    assert "1.stl` of the link `arm` cannot be read: the reader crashed" in found[0].message
    assert [path is None for path in paths(changed)[0]] == [False, True, True, False, False]


def test_it_gives_up_after_some_deaths(tmp_path: Path) -> None:
    files = [write(tmp_path, f"{at}.stl", mesh_samples.binary_stl()) for at in range(5)]
    starts = []

    def run(*_: Any, **__: Any) -> Died:
        starts.append(1)
        return Died(reason="did not end", step="0", output="", cause="wall-clock time")

    _, found = inspect_meshes(robot(*map(mesh, files)), file=None, folder=tmp_path, run=run)
    assert len(starts) == DEATHS
    assert kinds(found) == [("ROB062", Severity.ERROR)] * 5
    assert "was not read" in found[-1].message
    assert "machine is less busy" in (found[0].hint or "")


@pytest.mark.slow
def test_a_reader_that_does_not_start_blames_no_mesh(tmp_path: Path) -> None:
    file = write(tmp_path, "a.stl", mesh_samples.binary_stl())
    _, found = inspect_meshes(
        robot(mesh(file)),
        file=None,
        folder=tmp_path,
        run=lambda *_, **__: Died(reason="crashed (SIGSEGV)", step="", output=""),
    )
    assert "was not read, because the reader crashed" in found[0].message


@pytest.mark.slow
def test_a_file_of_many_short_lines(
    tmp_path: Path, run: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As lines of a text they would need 6 GiB."""
    monkeypatch.setattr("wsgen.descriptions.meshes.inspection.LIMITS", IN_TEN_SECONDS)
    file = write(tmp_path, "large.obj", b"v 0 0 0\n" * 12_000_000 + b"f 1 2 3\n")
    _, found = inspect_meshes(robot(mesh(file)), file=None, folder=tmp_path, run=run)
    assert kinds(found) == [("ROB065", Severity.ERROR)]
    assert "words" in found[0].message


@pytest.mark.slow
def test_a_file_beyond_its_memory(
    tmp_path: Path, run: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.descriptions.meshes.inspection.LIMITS", Limits(memory=512 * 2**20))
    text = mesh_samples.dae(asset="".join(f'<a id="{at}"/>' for at in range(3_000_000)))
    file = write(tmp_path, "large.dae", text)
    good = write(tmp_path, "good.stl", mesh_samples.binary_stl())
    _, found = inspect_meshes(robot(mesh(file), mesh(good)), file=None, folder=tmp_path, run=run)
    assert kinds(found) == [("ROB062", Severity.ERROR)]
    assert "memory" in found[0].message


@pytest.fixture(scope="module")
def apart() -> Iterator[ProcessPoolExecutor]:
    """A process of its own: trimesh takes hundreds of megabytes, which this one would keep."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        yield executor


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.parametrize("distribution", PACKAGES)
def test_public_meshes_are_as_large_as_trimesh_says(
    distribution: str, apart: ProcessPoolExecutor, *, thorough: bool
) -> None:
    pytest.importorskip("trimesh")
    pytest.importorskip("collada")  # with which it reads COLLADA
    meshes = meshes_of(distribution, every=thorough)
    if not meshes:
        pytest.skip(f"{distribution} is not installed")
    assert apart.submit(differences, meshes).result() == []
