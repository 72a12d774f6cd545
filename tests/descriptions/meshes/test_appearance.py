"""Colors and textures of mesh files."""

from __future__ import annotations

import os
import struct
import sys
import time
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

import mesh_samples
from child_answers import answered
from wsgen.descriptions.meshes import worker
from wsgen.descriptions.meshes.appearance import MATERIALS, Textures
from wsgen.descriptions.meshes.inspection import inspect_meshes
from wsgen.descriptions.meshes.requests import InspectedMesh, MeshRequest
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.diagnostics import Severity
from wsgen.isolation.fork_server import ForkServer
from wsgen.model.robot import Collision, Link, Mesh, Robot, Visual
from wsgen.model.transform import IDENTITY
from wsgen.rendering.camera import Camera
from wsgen.rendering.render_items import RenderItem
from wsgen.rendering.renderer import AMBIENT, Light, Renderer
from wsgen.rendering.surfaces import Surface, surface_of

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.result import Answered, Died


Rgba = tuple[float, float, float, float]
RED: Rgba = (1.0, 0.0, 0.0, 1.0)
BLUE: Rgba = (0.0, 0.0, 1.0, 1.0)
WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)
BLUE_SHADER = "<blinn><diffuse><color>0 0 1</color></diffuse></blinn>"
OPAQUE = '<transparent opaque="A_ONE"><color>1 1 1 1</color></transparent>'
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux has these files")
PALETTE = ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0))  # rows, from the upper left


def in_this_process(task: str, *arguments: Any, **_: Any) -> Answered | Died:
    assert task == "wsgen.descriptions.meshes.worker:inspect"
    return answered(worker.inspect(*arguments))


def write(folder: Path, name: str, content: bytes | str) -> Path:
    file = folder / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


def picture(file: Path, size: int = 64, mode: str = "RGB") -> Path:
    """Four squares, each of another color."""
    pixels = np.array(PALETTE, np.uint8).reshape(2, 2, 3)
    image = Image.fromarray(pixels).resize((size, size), Image.Resampling.NEAREST)
    image.convert(mode).save(file)
    return file


def looks(
    file: Path, rgba: Rgba | None = None, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> tuple[list[Visual], tuple[Diagnostic, ...]]:
    """What a visual becomes."""
    mesh = Mesh(uri=file.name, path=str(file), scale=scale)
    link = Link(name="arm", visuals=(Visual(geometry=mesh, rgba=rgba),))
    model = Robot(name="r", root="arm", links=(link,))
    new = file.parent / "new"
    new.mkdir(exist_ok=True)
    changed, found = inspect_meshes(
        model, file=None, folder=new, run=in_this_process, with_colors=True
    )
    return list(changed.links[0].visuals), found


def only(file: Path) -> tuple[Visual, tuple[Diagnostic, ...]]:
    visuals, found = looks(file)
    (visual,) = visuals
    return visual, found


def path_of(visual: Visual) -> Path:
    assert isinstance(visual.geometry, Mesh)
    return Path(visual.geometry.path or "")


def surface(visual: Visual) -> Surface:
    return surface_of(str(path_of(visual)))


def count(visual: Visual) -> int:
    """How many triangles it has."""
    return int(surface(visual).corners.shape[2])


def heights(visual: Visual) -> set[float]:
    return set(surface(visual).corners[2].ravel().tolist())


def test_each_material_of_a_collada_file_is_a_visual(tmp_path: Path) -> None:
    text = mesh_samples.colored_dae(mesh_samples.RED, BLUE_SHADER, mesh_samples.RED)
    visuals, found = looks(write(tmp_path, "a.dae", text))
    assert found == ()
    assert [visual.rgba for visual in visuals] == [RED, BLUE]
    assert [heights(visual) for visual in visuals] == [{0.0, 2.0}, {1.0}]
    assert isinstance(visuals[0].geometry, Mesh)
    assert visuals[0].geometry.bounds == ((-1.0, -1.0, 0.0), (1.0, 1.0, 2.0))
    assert visuals[0].texture is None


def test_a_color_of_the_description_overrides_those_of_the_file(tmp_path: Path) -> None:
    text = mesh_samples.colored_dae(mesh_samples.RED, mesh_samples.TEXTURED)
    visuals, found = looks(write(tmp_path, "a.dae", text), rgba=(0.0, 1.0, 0.0, 0.5))
    assert found == ()  # the texture is not missed
    (visual,) = visuals
    assert (visual.rgba, visual.texture) == ((0.0, 1.0, 0.0, 0.5), None)
    assert heights(visual) == {0.0, 1.0}


def test_without_colors_a_file_stays_whole(tmp_path: Path) -> None:
    file = write(tmp_path, "a.dae", mesh_samples.colored_dae(mesh_samples.RED, BLUE_SHADER))
    visual = Visual(geometry=Mesh(uri="a.dae", path=str(file)))
    model = Robot(name="r", root="arm", links=(Link(name="arm", visuals=(visual,)),))
    changed, _ = inspect_meshes(model, file=None, folder=tmp_path, run=in_this_process)
    (same,) = changed.links[0].visuals
    assert (path_of(same), same.rgba) == (file, None)


def test_a_material_is_found_by_its_id_where_nothing_binds_it(tmp_path: Path) -> None:
    text = mesh_samples.colored_dae(mesh_samples.RED, BLUE_SHADER, bind=False)
    visuals, _ = looks(write(tmp_path, "a.dae", text))
    assert [visual.rgba for visual in visuals] == [RED, BLUE]


@pytest.mark.parametrize(
    ("transparency", "alpha"),
    [
        ("", 1.0),
        ("<transparent><color>1 1 1 1</color></transparent>", 1.0),  # not said how it is meant
        (OPAQUE, 1.0),
        ('<transparent opaque="A_ONE"><color>1 1 1 0.25</color></transparent>', 0.25),
        ('<transparent opaque="A_ZERO"><color>1 1 1 0.25</color></transparent>', 0.75),
        ('<transparent opaque="RGB_ONE"><color>1 1 1 1</color></transparent>', 1.0),
        ('<transparent opaque="RGB_ZERO"><color>1 1 1 1</color></transparent>', 0.0),
        (
            f"{OPAQUE}<transparency><float>0.5</float></transparency>",
            0.5,
        ),
        (
            f"{OPAQUE}<transparency><float>half</float></transparency>",
            1.0,
        ),
    ],
)
def test_transparency_of_collada(tmp_path: Path, transparency: str, alpha: float) -> None:
    shader = mesh_samples.RED.replace("</phong>", f"{transparency}</phong>")
    visual, _ = only(write(tmp_path, "a.dae", mesh_samples.colored_dae(shader)))
    assert visual.rgba is not None
    assert visual.rgba[:3] == RED[:3]
    assert visual.rgba[3] == pytest.approx(alpha)


@pytest.mark.parametrize(
    "shader",
    [
        "",
        "<constant><emission><color>1 0 0 1</color></emission></constant>",
        "<phong/>",
        "<phong><diffuse/></phong>",
        "<phong><diffuse><color>red</color></diffuse></phong>",
        "<phong><diffuse><color>1 0</color></diffuse></phong>",
        "<phong><diffuse><color>nan 0 0 1</color></diffuse></phong>",
    ],
)
def test_a_shader_that_gives_no_color(tmp_path: Path, shader: str) -> None:
    visual, found = only(write(tmp_path, "a.dae", mesh_samples.colored_dae(shader)))
    assert (visual.rgba, visual.texture, found) == (None, None, ())


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('target="#material0"', 'target="#other"'),
        ('<material id="material0">', "<material>"),
        ('<instance_effect url="#effect0"/>', ""),
        ("profile_COMMON>", "profile_CG>"),
        ("technique>", "other>"),
    ],
)
def test_a_material_that_leads_nowhere(tmp_path: Path, old: str, new: str) -> None:
    text = mesh_samples.colored_dae(mesh_samples.RED)
    assert old in text
    visual, found = only(write(tmp_path, "a.dae", text.replace(old, new)))
    assert (visual.rgba, found) == (None, ())


def test_an_effect_that_is_missing_is_reported(tmp_path: Path) -> None:
    text = mesh_samples.colored_dae(mesh_samples.RED).replace('url="#effect0"', 'url="#other"')
    visual, (found,) = only(write(tmp_path, "a.dae", text))
    assert visual.rgba is None
    assert (found.code, found.severity) == ("ROB076", Severity.WARNING)
    assert "`#other`" in found.message


@pytest.mark.slow
@pytest.mark.parametrize("chain", ["sampler", "image"])
def test_a_texture_of_collada(tmp_path: Path, chain: str) -> None:
    picture(tmp_path / "image.png")
    shader = mesh_samples.TEXTURED.replace("sampler", chain)
    visual, found = only(write(tmp_path, "a.dae", mesh_samples.colored_dae(shader)))
    assert found == ()
    assert visual.rgba == WHITE
    assert visual.texture is not None
    assert Image.open(visual.texture).getpixel((0, 0)) == PALETTE[0]
    assert surface(visual).texture_points is not None


@pytest.mark.slow
def test_a_texture_among_those_of_a_model(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "materials" / "textures").mkdir(parents=True)
    picture(tmp_path / "materials" / "textures" / "image.png")
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED)
    visual, found = only(write(tmp_path / "meshes", "a.dae", text))
    assert visual.texture
    assert found == ()


@pytest.mark.parametrize("image", ["image.png", "/nowhere/image.png", "x" * 5000, "\\image.png"])
def test_a_texture_that_is_missing(tmp_path: Path, image: str) -> None:
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED, image=image)
    visual, (found,) = only(write(tmp_path, "a.dae", text))
    assert (visual.rgba, visual.texture) == (WHITE, None)
    assert (found.code, found.severity) == ("ROB073", Severity.WARNING)
    assert image[:50] in found.message


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("<init_from>image.png</init_from>", "<init_from/>"),
        ("<init_from>image.png</init_from>", ""),
        ("<init_from>image<", "<init_from>sampler<"),  # round and round
        ("<source>surface<", "<source>sampler<"),
        ("<source>surface</source>", ""),
        ('<image id="image">', '<image id="other">'),
    ],
)
def test_a_texture_that_leads_nowhere(tmp_path: Path, old: str, new: str) -> None:
    picture(tmp_path / "image.png")
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED)
    assert old in text
    visual, found = only(write(tmp_path, "a.dae", text.replace(old, new)))
    assert (visual.rgba, visual.texture, found) == (WHITE, None, ())


def claimed(width: int, height: int) -> bytes:
    """The beginning of a PNG that says that it is so large, and has nothing."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = zlib.compress(bytes(1000))
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is not a valid image"),
        (b"hello world", "is not a valid image"),
        (claimed(60_000, 60_000), "pixels"),
        (claimed(13_000, 13_000), "13000 by 13000 pixels"),
        (claimed(8000, 8000)[:-20], "is not a valid image"),
        ("folder", "is a folder"),
        ("pipe", "is a named pipe"),
        ("huge", "has more than 50 MB"),
        pytest.param("disk", "cannot be read (Input/output error)", marks=on_linux),
    ],
)
def test_a_texture_that_cannot_be_shown(tmp_path: Path, content: bytes | str, words: str) -> None:
    image = tmp_path / "image.png"
    if isinstance(content, bytes):
        image.write_bytes(content)
    elif content == "folder":
        image.mkdir()
    elif content == "pipe":
        os.mkfifo(image)
    elif content == "disk":
        image.symlink_to("/proc/self/mem")  # a regular file of which no first byte can be read
    else:
        with image.open("wb") as stream:
            stream.truncate(10**12)
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED)
    started = time.process_time()
    visual, (found,) = only(write(tmp_path, "a.dae", text))
    assert time.process_time() - started < 5
    assert (visual.rgba, visual.texture) == (WHITE, None)
    assert (found.code, found.severity) == ("ROB074", Severity.WARNING)
    assert words in found.message


@on_linux
def test_a_full_disk_is_no_fault_of_a_texture(tmp_path: Path) -> None:
    picture(tmp_path / "image.png", size=4)
    (tmp_path / "texture0.png").symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left"):
        Textures(tmp_path).prepare("image.png", tmp_path / "a.dae")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.bmp", "a.tga", "a.dds", "a.gif"])
def test_a_texture_is_made_a_small_png(tmp_path: Path, name: str) -> None:
    picture(tmp_path / name, size=1100)
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED, image=name)
    visual, found = only(write(tmp_path, "a.dae", text))
    assert found == ()
    assert visual.texture is not None
    with Image.open(visual.texture) as image:
        assert (image.format, image.mode, image.size) == ("PNG", "RGB", (1024, 1024))
        pixels = [image.getpixel(at) for at in ((100, 100), (900, 100), (100, 900), (900, 900))]
    assert np.allclose(pixels, PALETTE, atol=8)


def test_a_texture_of_sixteen_bits(tmp_path: Path) -> None:
    grey = np.full((4, 4), 0x8000, np.uint16)
    Image.fromarray(grey).save(tmp_path / "image.png")
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED)
    visual, found = only(write(tmp_path, "a.dae", text))
    assert found == ()
    assert Image.open(visual.texture or "").getpixel((0, 0)) == (128, 128, 128)


def obj_with(tmp_path: Path, materials: str, faces: str | None = None) -> Path:
    write(tmp_path, "a.mtl", materials)
    own = "usemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 3/3 4/4\n"
    return write(tmp_path, "a.obj", mesh_samples.square_obj(faces or own, "mtllib a.mtl\n"))


def test_each_material_of_an_obj_file_is_a_visual(tmp_path: Path) -> None:
    file = obj_with(tmp_path, "newmtl one\nKd 1 0 0\nnewmtl two\nKd 0 0 1\nd 0.5\n")
    visuals, found = looks(file)
    assert found == ()
    assert [visual.rgba for visual in visuals] == [RED, (0.0, 0.0, 1.0, 0.5)]
    assert [count(visual) for visual in visuals] == [1, 1]


@pytest.mark.parametrize(
    ("lines", "rgba"),
    [
        ("Kd 1 0 0", RED),
        ("Kd 2 -1 0", RED),
        ("Kd 0.5", (0.5, 0.5, 0.5, 1.0)),
        ("Kd 1 0 0\nTr 0.75", (1.0, 0.0, 0.0, 0.25)),
        ("Kd 1 0 0\nd -halo 0.25", (1.0, 0.0, 0.0, 0.25)),
        ("Kd 1 0 0\nd 0.25\nTr 0", (1.0, 0.0, 0.0, 0.25)),
        ("Kd red", None),
        ("Kd nan 0 0", None),
        ("Kd 1 0", None),
        ("Ns 1", None),
        ("Kd spectral file.rfl", None),
    ],
)
def test_colors_of_obj(tmp_path: Path, lines: str, rgba: Rgba | None) -> None:
    visual, found = only(obj_with(tmp_path, f"newmtl one\n{lines}\n", "usemtl one\nf 1 2 3 4\n"))
    assert (visual.rgba, found) == (rgba, ())


@pytest.mark.parametrize(
    "options", ["", "-s 1 1 1 ", "-o 0.5 -clamp on ", "-blendu off -mm 0 1 -bm 2 "]
)
def test_a_texture_of_obj(tmp_path: Path, options: str) -> None:
    picture(tmp_path / "my image.png")
    faces = "usemtl one\nf -4/-4 -3/-3 -2/-2 -1/-1\n"
    file = obj_with(tmp_path, f"newmtl one\nmap_Kd {options}my image.png\n", faces)
    visual, found = only(file)
    assert found == ()
    assert visual.rgba == (0.6, 0.6, 0.6, 1.0)
    assert visual.texture
    corners, _, points = surface(visual)
    assert points is not None
    assert np.allclose(points, (corners[:2] + 1) / 2)


@pytest.mark.parametrize("kind", ["missing", "folder", "pipe", "huge", "null\0byte", "x" * 5000])
def test_a_material_library_that_cannot_be_read(tmp_path: Path, kind: str) -> None:
    name = f"{kind}.mtl"
    if kind == "folder":
        (tmp_path / name).mkdir()
    elif kind == "pipe":
        os.mkfifo(tmp_path / name)
    elif kind == "huge":
        with (tmp_path / name).open("wb") as stream:
            stream.truncate(10**12)
    text = mesh_samples.square_obj("usemtl one\nf 1 2 3 4\n", f"mtllib {name}\n")
    visual, (found,) = only(write(tmp_path, "a.obj", text))
    assert visual.rgba is None
    assert (found.code, found.severity) == ("ROB075", Severity.INFO)


def test_a_material_library_that_is_no_text(tmp_path: Path) -> None:
    write(tmp_path, "a.mtl", bytes(range(256)) * 100)
    text = mesh_samples.square_obj("usemtl one\nf 1 2 3 4\n", "mtllib a.mtl\n")
    visual, _ = only(write(tmp_path, "a.obj", text))
    assert visual.rgba is None


@pytest.mark.parametrize(
    "faces",
    [
        "f 1/9/1 2/2/1 3/3/1 4/4/1\n",
        "f 1/1/9 2/2/1 3/3/1 4/4/1\n",
        "f 1/1/1 2/2/1 3 4/4/1\n",
        "f 1/1/1 2/2 3//1 4\n",
        "f 1/0/0 2/0/0 3/0/0 4/0/0\n",
        "f 1/-9/-9 2/1/1 3/1/1 4/1/1\n",
        "f 1/x/y 2/x/y 3/x/y 4/x/y\n",
    ],
)
def test_an_obj_whose_texture_points_and_normals_are_nothing(tmp_path: Path, faces: str) -> None:
    picture(tmp_path / "image.png")
    file = obj_with(tmp_path, "newmtl one\nKd 1 0 0\nmap_Kd image.png\n", f"usemtl one\n{faces}")
    visual, _ = only(file)
    assert count(visual) == 2
    expected = np.array(PALETTE if visual.texture else [(255, 0, 0)]) * RED[:3]
    assert np.allclose(seen_from_above(visual), expected, atol=40)


@pytest.mark.slow
def test_materials_without_number(tmp_path: Path) -> None:
    number = 20_000
    names = "".join(f"newmtl {at}\nKd 0 0 {at / number}\n" for at in range(number))
    faces = "".join(f"usemtl {at}\nf 1 2 3\n" for at in range(number))
    started = time.process_time()
    visuals, _ = looks(obj_with(tmp_path, names, faces))
    assert time.process_time() - started < 5
    assert len(visuals) == MATERIALS
    assert sum(map(count, visuals)) == number


def test_colors_of_gltf(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    image = Image.fromarray(np.array(PALETTE, np.uint8).reshape(2, 2, 3))
    plain = trimesh.visual.material.PBRMaterial(baseColorFactor=[255, 0, 0, 255])
    textured = trimesh.visual.material.PBRMaterial(baseColorTexture=image)
    for material, z in ((plain, 0.0), (textured, 1.0)):
        square = trimesh.Trimesh(
            vertices=[(-1, -1, z), (1, -1, z), (1, 1, z), (-1, 1, z)],
            faces=[(0, 1, 2), (0, 2, 3)],
            process=False,
        )
        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        square.visual = trimesh.visual.TextureVisuals(uv=corners, material=material)
        scene.add_geometry(square)
    (tmp_path / "a.glb").write_bytes(scene.export(file_type="glb"))
    visuals, found = looks(tmp_path / "a.glb")
    assert [one.code for one in found] == ["ROB068"]
    visuals.sort(key=lambda visual: min(heights(visual)))
    assert [visual.rgba for visual in visuals] == [RED, WHITE]
    assert [heights(visual) for visual in visuals] == [{0.0}, {1.0}]
    assert visuals[0].texture is None
    assert Image.open(visuals[1].texture or "").getpixel((0, 0)) == PALETTE[0]
    shown, _, points = surface(visuals[1])
    assert points is not None
    assert np.allclose(points, (shown[:2] + 1) / 2)


@pytest.mark.slow
def test_dense_meshes_stay_whole(tmp_path: Path) -> None:
    corners = np.random.default_rng(0).uniform(-1, 1, (180_000, 3, 3)).astype(np.float32)
    write_stl(corners, tmp_path / "dense.stl")
    request = MeshRequest(
        path=str(tmp_path / "dense.stl"),
        is_collision=False,
        is_visual=False,
        showings=(True, False),
    )
    (answer,) = worker.inspect([request], tmp_path)
    assert isinstance(answer, InspectedMesh)
    for (part,) in answer.colored:
        assert part.triangles == len(corners)
        assert np.array_equal(surface_of(part.path).corners, corners.T)
        assert surface_of(part.path).normals is None


@pytest.mark.slow
def test_looks_come_out_of_the_child(tmp_path: Path) -> None:
    picture(tmp_path / "image.png")
    text = mesh_samples.colored_dae(mesh_samples.RED, mesh_samples.TEXTURED)
    mesh = Mesh(uri="a.dae", path=str(write(tmp_path, "a.dae", text)))
    link = Link(
        name="arm",
        visuals=(Visual(geometry=mesh), Visual(geometry=mesh, rgba=BLUE)),
        collisions=(Collision(geometry=mesh),),
    )
    model = Robot(name="r", root="arm", links=(link,))
    with ForkServer() as fork_server:
        changed, found = inspect_meshes(
            model, file=None, folder=tmp_path, run=fork_server.run, with_colors=True
        )
    assert found == ()
    (new,) = changed.links
    assert [visual.rgba for visual in new.visuals] == [RED, WHITE, BLUE]
    assert [visual.texture is None for visual in new.visuals] == [True, False, True]
    assert isinstance(new.collisions[0].geometry, Mesh)
    assert (new.collisions[0].geometry.path or "").endswith(".stl")


def seen_from_above(
    visual: Visual, light: tuple[float, float, float] = (0.0, 0.0, 1.0)
) -> list[list[int]]:
    """What is drawn of a square: the upper left, upper right, lower left and lower right."""
    assert isinstance(visual.geometry, Mesh)
    item = RenderItem(
        entity="e",
        link="l",
        geometry=visual.geometry,
        rgba=visual.rgba or WHITE,
        texture=visual.texture,
    )
    renderer = Renderer([item], towards_light=light)
    renderer.arrange({"e": {"l": IDENTITY}})
    camera = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 32.0, 0.1, 10.0, 100, 100)
    colors = np.zeros((3, 100 * 100), np.float32)
    renderer.paint(colors, renderer.see(camera.view), Light(None, None))
    pixels = colors.reshape(3, 100, 100)
    return [(pixels[:, row, column] * 255).tolist() for row in (25, 75) for column in (25, 75)]


@pytest.mark.parametrize("shift", [0, -3, 2])
def test_a_texture_is_drawn_right_way_up(tmp_path: Path, shift: int) -> None:
    picture(tmp_path / "image.png")
    text = mesh_samples.colored_dae(mesh_samples.TEXTURED)
    moved = " ".join(str(shift + part) for part in (0, 0, 1, 0, 1, 1, 0, 1))
    visual, _ = only(write(tmp_path, "a.dae", text.replace("0 0 1 0 1 1 0 1", moved)))
    assert np.allclose(seen_from_above(visual), PALETTE, atol=40)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (2.0, -1.0, 3.0)])
@pytest.mark.parametrize("node", ["", "<scale>1 -1 1</scale>"])
def test_what_is_mirrored_is_seen_and_lit(
    tmp_path: Path, scale: tuple[float, float, float], node: str
) -> None:
    text = mesh_samples.colored_dae(mesh_samples.RED).replace("<node>", f"<node>{node}")
    visuals, _ = looks(write(tmp_path, "a.dae", text), scale=scale)
    (visual,) = visuals
    lit, unlit = (seen_from_above(visual, (0.0, 0.0, z)) for z in (1.0, -1.0))
    assert np.allclose(lit, RED[:3] * np.array(255), atol=30)
    assert np.allclose(unlit, np.array(RED[:3]) * 255 * AMBIENT, atol=45)


@pytest.mark.parametrize("with_colors", [True, False])
def test_what_has_no_normals_is_not_black(tmp_path: Path, *, with_colors: bool) -> None:
    file = write(tmp_path, "a.stl", mesh_samples.text_stl())
    visual = Visual(geometry=Mesh(uri="a.stl", path=str(file)), rgba=RED)
    model = Robot(name="r", root="arm", links=(Link(name="arm", visuals=(visual,)),))
    changed, _ = inspect_meshes(
        model, file=None, folder=tmp_path, run=in_this_process, with_colors=with_colors
    )
    assert np.allclose(seen_from_above(changed.links[0].visuals[0])[0], [255, 0, 0], atol=30)
