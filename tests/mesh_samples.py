"""Mesh files for tests: good ones, and ones that engines die of."""

from __future__ import annotations

import re
import struct

BOX = ((-0.5, -1.0, -1.5), (0.5, 1.0, 1.5))  # m, the corners of the box in the files below
POINTS = [(x, y, z) for x in (-0.5, 0.5) for y in (-1.0, 1.0) for z in (-1.5, 1.5)]
FACES = [
    *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
    *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
]


def binary_stl(*, claimed: int = len(FACES), behind: bytes = b"", nan: bool = False) -> bytes:
    """The box, and what the file says of itself."""
    records = b""
    for face in FACES:
        corners = [number for at in face for number in POINTS[at]]
        if nan:
            corners[0] = float("nan")
        records += struct.pack("<12fH", 0, 0, 0, *corners, 0)
    return bytes(80) + struct.pack("<I", claimed) + records + behind


def text_stl() -> bytes:
    """The box."""
    lines = ["solid box"]
    for face in FACES:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {:g} {:g} {:.6e}".format(*POINTS[at]) for at in face]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid box", ""]).encode()


def obj(*faces: str) -> bytes:
    """The box; or its corners with other faces."""
    own = ["f {} {} {}".format(*(at + 1 for at in face)) for face in FACES]
    vertices = ["v {:g} {:g} {:g}".format(*point) for point in POINTS]
    return "\n".join(["# a box", *vertices, *(faces or own), ""]).encode()


TRIANGLES = (
    f'<triangles count="{len(FACES)}"><input semantic="VERTEX" source="#v" offset="0"/>'
    f"<p>{' '.join(str(at) for face in FACES for at in face)}</p></triangles>"
)
QUADS = (
    '<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/>'
    "<vcount>4 4 4 4 4 4</vcount>"
    "<p>0 1 3 2 4 6 7 5 0 4 5 1 2 3 7 6 0 2 6 4 1 5 7 3</p></polylist>"
)
PLACED = '<instance_geometry url="#g"/>'


def dae(faces: str = TRIANGLES, node: str = PLACED, asset: str = "") -> str:
    """The box, with other faces, in a node with more in it, or with more in <asset>."""
    numbers = " ".join(f"{number:g}" for point in POINTS for number in point)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f" count="24">{numbers}</float_array>
<technique_common><accessor source="#f" count="8" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
{faces}</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node>{node}</node></visual_scene>
</library_visual_scenes>
<scene><instance_visual_scene url="#vs"/></scene>
</COLLADA>
"""


def laughs() -> str:
    """A COLLADA file with entities that would grow to ten gigabytes."""
    entities = '<!ENTITY a0 "aaaaaaaaaa">' + "".join(
        f'<!ENTITY a{at} "{f"&a{at - 1};" * 10}">' for at in range(1, 10)
    )
    start, rest = dae(asset="<title>&a9;</title>").split("?>", 1)
    return f"{start}?><!DOCTYPE c [{entities}]>{rest}"


# Broken files: name, content, and words of what is said about it.
BROKEN: dict[str, tuple[bytes | str, str]] = {
    "empty.stl": (b"", "0 bytes"),
    "empty.dae": (b"", "0 bytes"),
    "four_billion.stl": (binary_stl(claimed=4_000_000_000), "4000000000 triangles"),
    "cut_off.stl": (binary_stl()[:-20], "ends after 11"),
    "no_triangle.stl": (bytes(84), "no triangle"),
    "nan.stl": (binary_stl(nan=True), "infinite, huge or undefined"),
    "prose.stl": (b"hello world\n" * 20, "not STL"),
    "short.stl": (b"hello", "too few"),
    "text_cut_off.stl": (text_stl()[: text_stl().rindex(b"vertex")], "cut short"),
    "text_word.stl": (text_stl().replace(b"vertex -0.5", b"vertex half", 1), "other than numbers"),
    "old_macintosh.stl": (text_stl().replace(b"\n", b"\r"), "Macintosh"),
    "is_obj.stl": (obj(), "contains OBJ"),
    "is_stl.obj": (binary_stl(), "contains STL"),
    "is_stl.dae": (text_stl(), "contains STL"),
    "is_glb.dae": (b"glTF\2\0\0\0\14\0\0\0", "contains GLB"),
    "beyond.obj": (obj("f 1 2 3", "f 1 2 9"), "number 9"),
    "far_beyond.obj": (obj("f 1 2 99999999999999999999"), "number 9223372036854775807"),
    "zero.obj": (obj("f 0 1 2"), "number 0"),
    "before.obj": (obj("f -1 -2 -9"), "number 0"),
    "word.obj": (obj("f 1 2 x"), "whole numbers"),
    "fraction.obj": (obj("f 1 2 2.5"), "whole numbers"),
    "no_face.obj": (obj("# none"), "no triangle"),
    "two_numbers.obj": (b"v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "fewer than three"),
    "not_a_number.obj": (b"v 0 0 nought\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "other than numbers"),
    "infinite.obj": (obj().replace(b"v 0.5", b"v 1e39"), "infinite, huge or undefined"),
    "cut_off.dae": (dae()[: len(dae()) // 2], "not well-formed"),
    "no_collada.dae": ("<svg/>", "not COLLADA"),
    "sixteen_bit.dae": (dae().encode("utf-16"), "not well-formed"),
    "no_geometry.dae": (
        re.sub("<geometry.*</geometry>", "", dae(), flags=re.DOTALL),
        "a geometry `#g`",
    ),
    "no_instance.dae": (dae(node=""), "scene without geometry"),
    "no_scene.dae": (re.sub("<scene>.*</scene>", "", dae()), "no <scene>"),
    "wrong_scene.dae": (dae().replace('url="#vs"', 'url="#other"'), "the scene `#other`"),
    "no_source.dae": (dae().replace('source="#s"', 'source="#other"'), "a source `#other`"),
    "no_vertices.dae": (dae().replace('source="#v"', 'source="#other"'), "vertices `#other`"),
    "no_positions.dae": (dae().replace("POSITION", "NORMAL"), "for their positions"),
    "no_offset.dae": (dae().replace(' offset="0"', ""), "without offset"),
    "far_offset.dae": (dae().replace('offset="0"', 'offset="4000000000"'), "not a multiple"),
    "endless_offset.dae": (dae().replace('offset="0"', f'offset="{"9" * 5000}"'), "offset="),
    "far_stride.dae": (
        dae().replace('stride="3"', 'stride="4000000000"'),
        "in steps of 4000000000",
    ),
    "no_numbers.dae": (re.sub("(<float_array.*?>)[^<]*", r"\1", dae()), "without numbers"),
    "empty_p.dae": (re.sub("<p>.*</p>", "<p></p>", dae()), "no triangle"),
    "no_p.dae": (re.sub("<p>.*</p>", "", dae()), "no triangle"),
    "beyond.dae": (dae().replace("<p>0", "<p>77"), "number 77"),
    "before.dae": (dae().replace("<p>0", "<p>-3"), "number -3"),
    "word_in_p.dae": (dae().replace("<p>0", "<p>x"), "whole numbers"),
    "rest_in_p.dae": (dae().replace("<p>0", "<p>0 0"), "not a multiple of 3"),
    "comma.dae": (dae().replace("-0.5", "-0,5"), "other than numbers"),
    "nan.dae": (dae().replace("-0.5", "nan"), "infinite, huge or undefined"),
    "wrong_polygons.dae": (dae(QUADS.replace("<vcount>4", "<vcount>9")), "29 corners together"),
    "negative_polygon.dae": (dae(QUADS.replace("<vcount>4 4", "<vcount>-4 12")), "together"),
    "only_polygons.dae": (dae(QUADS.replace("polylist", "polygons")), "<polygons>"),
    "unit.dae": (dae(asset='<unit meter="one"/>'), "the unit"),
    "matrix.dae": (dae(node=f"<matrix>1 0 0</matrix>{PLACED}"), "<matrix> instead of 16"),
    "circle.dae": (
        dae(node='<instance_node url="#n"/>').replace("<node>", '<node id="n">'),
        "contain themselves",
    ),
    "twins.dae": (  # each node holds two of the next: 2^40 boxes
        dae(node='<instance_node url="#n0"/>').replace(
            "<library_visual_scenes>",
            "<library_nodes>"
            + "".join(
                f'<node id="n{at}">' + f'<instance_node url="#n{at + 1}"/>' * 2 + "</node>"
                for at in range(40)
            )
            + f'<node id="n40">{PLACED}</node></library_nodes><library_visual_scenes>',
        ),
        "far too many",
    ),
    "laughs.dae": (laughs(), "document type"),
    "cut_off.glb": (b"glTF\2\0\0\0\377\377\377\377\377\377\377\177JSON{", "is cut short"),
    "cut_off.ply": (
        (
            b"ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
            b"property float z\nelement face 9\nproperty list uchar int vertex_indices\n"
            b"end_header\n0 0 0\n"
        ),
        "no triangle",
    ),
    "prose.ply": (b"hello world\n" * 20, "not a valid PLY file"),
    "mesh.fbx": (b"Kaydara", "a format that wsgen does not read"),
    "mesh": (binary_stl(), "no extension"),
}

RED = "<phong><diffuse><color>1 0 0 1</color></diffuse></phong>"
TEXTURED = '<lambert><diffuse><texture texture="sampler" texcoord="UV"/></diffuse></lambert>'
PARAMETERS = (
    '<newparam sid="surface"><surface type="2D"><init_from>image</init_from></surface></newparam>'
    '<newparam sid="sampler"><sampler2D><source>surface</source></sampler2D></newparam>'
)


def colored_dae(*shaders: str, image: str = "image.png", bind: bool = True) -> str:
    """A square for each shader, one above the other (z = 0, 1, 2 …), each of its own material."""
    faces = "".join(
        f'<triangles count="2" material="symbol{at}"><input semantic="VERTEX" source="#v" '
        'offset="0"/><input semantic="TEXCOORD" source="#uv" offset="1" set="0"/>'
        f"<p>{' '.join(f'{4 * at + corner} {corner}' for corner in (0, 1, 2, 0, 2, 3))}</p>"
        "</triangles>"
        for at in range(len(shaders))
    )
    numbers = "".join(f"-1 -1 {z} 1 -1 {z} 1 1 {z} -1 1 {z} " for z in range(len(shaders)))
    target = "material" if bind else "symbol"
    effects = "".join(
        f'<effect id="effect{at}"><profile_COMMON>{PARAMETERS}<technique>{shader}</technique>'
        "</profile_COMMON></effect>"
        for at, shader in enumerate(shaders)
    )
    materials = "".join(
        f'<material id="{target}{at}"><instance_effect url="#effect{at}"/></material>'
        for at in range(len(shaders))
    )
    bound = "".join(
        f'<instance_material symbol="symbol{at}" target="#material{at}"/>'
        for at in range(len(shaders) if bind else 0)
    )
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_images><image id="image"><init_from>{image}</init_from></image></library_images>
<library_effects>{effects}</library_effects>
<library_materials>{materials}</library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f" count="{12 * len(shaders)}">{numbers}</float_array></source>
<source id="uv"><float_array id="t" count="8">0 0 1 0 1 1 0 1</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
{faces}</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node><instance_geometry url="#g"><bind_material>
<technique_common>{bound}</technique_common></bind_material></instance_geometry></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene>
</COLLADA>
"""


def square_obj(faces: str = "f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n", head: str = "") -> str:
    """A square in the plane z = 0, with texture points from corner to corner."""
    return (
        f"{head}v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        f"vn 0 0 1\n{faces}"
    )
