"""Wavefront OBJ files and their material libraries (`.mtl`)."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wsgen.descriptions.meshes.content import (
    BrokenMeshError,
    Content,
    EnormousMeshError,
    Material,
    Patch,
    check_part,
    parse_floats,
    parse_integers,
    refuse_triangles,
    triangulate,
)
from wsgen.descriptions.meshes.requests import MISSING_MATERIAL_LIBRARY, MaterialProblem
from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray


def read_rows(lines: Sequence[bytes], width: int, what: str) -> NDArray[np.float64]:
    """The first numbers of each line behind its keyword, shape (n, width).

    A line may have more: a weight or a color behind the coordinates. `what` it is, for messages.
    """
    numbers = parse_floats(b"".join([line[line.index(b" ") :] for line in lines]), f"a {what}")
    found, rest = divmod(len(numbers), len(lines) or 1)
    if found >= width and not rest and _have_equal_widths(lines, found, width):
        return numbers.reshape(-1, found)[:, :width]
    rows = [line.split()[1 : width + 1] for line in lines]
    if any(len(row) < width for row in rows):
        few = ("no", "one", "two", "three")[width]
        raise BrokenMeshError(f"has a {what} with fewer than {few} numbers")
    return np.array(rows, dtype=np.float64).reshape(-1, width)


def _have_equal_widths(lines: Sequence[bytes], found: int, width: int) -> bool:
    """Whether each line has so many numbers, given that all together have that many on average."""
    if found == width:  # nothing has fewer, so nothing has more
        return all(len(line.split(None, width)) > width for line in lines)
    return all(len(line.split()) == found + 1 for line in lines)


def made_absolute(
    indices: NDArray[np.int64], lines: Sequence[bytes], keyword: bytes
) -> NDArray[np.int64]:
    """Negative indices count back from the last row with that keyword that stands before the face.

    Args:
        indices: Those of all faces, one after the other.
        lines: The lines of the file.
        keyword: What the rows that they count begin with, with the blank behind it.
    """
    if not indices.size or indices.min() >= 0:
        return indices
    seen = 0
    before = []
    for line in lines:
        if line.startswith(keyword):
            seen += 1
        elif line.startswith(b"f "):
            before += [seen] * (len(line.split()) - 1)
    return np.where(indices < 0, indices + np.array(before) + 1, indices)


SIZE_LIMIT = 10**6  # bytes
TEXTURED = 0.6  # gray that Gazebo takes for a texture to which no color is given
# Options of a texture, and how many values they have; of numbers fewer may be given.
WORD_OPTIONS = {"-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-type"}
NUMBER_OPTIONS = {"-bm": 1, "-boost": 1, "-texres": 1, "-mm": 2, "-o": 3, "-s": 3, "-t": 3}


def read_materials(
    names: Iterable[str], folder: Path
) -> tuple[dict[str, Material], tuple[MaterialProblem, ...]]:
    """The materials of an OBJ file by name.

    Args:
        names: What stands behind each `mtllib`: a file, or several.
        folder: Where the OBJ file is.
    """
    materials: dict[str, Material] = {}
    problems = []
    for name in names:
        read = [_read(folder / one) for one in dict.fromkeys((name, *name.split()))]
        text = next((text for text, _ in read if text is not None), None)
        if text is not None:
            materials |= _parse(text)
            continue
        problems.append(
            MaterialProblem(
                MISSING_MATERIAL_LIBRARY,
                f"has no colors, because its material library `{name}` {read[0][1]}",
                "Copy the .mtl file next to the .obj file, and install it in CMakeLists.txt.",
            )
        )
    return materials, tuple(problems)


def _read(file: Path) -> tuple[str | None, str]:
    """The text of a file, or what keeps it from being read."""
    try:
        data = read_regular(file, SIZE_LIMIT)
    except FileNotFoundError:
        return None, "does not exist"
    except (OSError, ValueError) as error:  # ValueError: a null byte in the name
        return None, f"cannot be read ({getattr(error, 'strerror', None) or error})"
    if len(data) > SIZE_LIMIT:
        return None, f"has more than {SIZE_LIMIT / 1e6:.0f} MB"
    return data.decode("utf-8", errors="replace"), ""


def _parse(text: str) -> dict[str, Material]:
    parts: dict[str, dict[str, str]] = {}
    current: dict[str, str] = {}
    for line in text.splitlines():
        keyword, _, rest = line.strip().partition(" ")
        if keyword == "newmtl":
            current = parts.setdefault(rest.strip(), {})
        else:
            current[keyword] = rest.strip()
    return {name: _material(lines) for name, lines in parts.items()}


def _material(lines: dict[str, str]) -> Material:
    image = _file_name(lines.get("map_Kd", ""))
    rgb = _numbers(lines.get("Kd", "").split()[:3])
    if len(rgb) == 1:  # a gray
        rgb *= 3
    if len(rgb) != len("rgb"):
        if not image:
            return Material()
        rgb = [TEXTURED] * 3
    opacity = _numbers([lines["d"].split()[-1]] if lines.get("d") else [])
    if not opacity:
        opacity = [1 - part for part in _numbers(lines.get("Tr", "").split()[:1])] or [1.0]
    red, green, blue, alpha = (min(1.0, max(0.0, part)) for part in (*rgb, *opacity))
    return Material(rgba=(red, green, blue, alpha), image=image or None)


def _file_name(text: str) -> str:
    """What stands behind the options of a texture; it may have blanks in it."""
    words = text.split(" ")
    while words and words[0] in WORD_OPTIONS | NUMBER_OPTIONS.keys():
        option = words.pop(0)
        for _ in range(NUMBER_OPTIONS.get(option, 1)):
            if words and (option in WORD_OPTIONS or _numbers(words[:1])):
                words.pop(0)
    return " ".join(words).strip()


def _numbers(words: Sequence[str]) -> list[float]:
    """Finite numbers; none where anything else is among the words."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return []
    return numbers if all(abs(number) < float("inf") for number in numbers) else []


TEXTURE_POINT, NORMAL = 1, 2  # where they stand in `vertex/texture point/normal`
KEYWORDS = {TEXTURE_POINT: b"vt ", NORMAL: b"vn "}
WIDTHS = {TEXTURE_POINT: 2, NORMAL: 3}


class Faces(NamedTuple):
    """The faces of a file, as far as they are read."""

    lines: Sequence[bytes]  # of the whole file
    joined: bytes  # of the faces, without their keywords
    sizes: NDArray[np.int64]  # how many corners each has


def content_with_materials(
    corners: NDArray[np.float64], places: NDArray[np.int64], faces: Faces, folder: Path
) -> Content:
    """What is in the file.

    Args:
        corners: Of the triangles, shape (n, 3, 3).
        places: Where these stand among all corners of the faces, shape (n, 3).
        faces: What the triangles were cut from.
        folder: Where the materials are searched.
    """
    if not len(corners):
        return Content(corners=corners)
    lines = faces.lines
    libraries = [line[7:].strip() for line in lines if line.startswith(b"mtllib ")]
    names = [name.decode("utf-8", errors="replace") for name in libraries]
    materials, problems = read_materials(names, folder)
    columns = _columns(faces)
    normals = _rows_at(columns, NORMAL, faces, places)
    texture_points = _rows_at(columns, TEXTURE_POINT, faces, places)
    used, number_of = _materials_of_faces(faces, materials)
    face_of_corner = np.repeat(np.arange(len(faces.sizes)), faces.sizes)
    number = number_of[face_of_corner[places[:, 0]]]
    patches = [
        Patch(
            corners=corners[mask],
            normals=None if normals is None else normals[mask],
            texture_points=None if texture_points is None else texture_points[mask],
            material=material,
        )
        for material, mask in zip(used, _masks(number, len(used)), strict=True)
    ]
    return Content(
        corners=corners,
        patches=tuple(patch for patch in patches if len(patch.corners)),
        material_problems=problems,
    )


def _materials_of_faces(
    faces: Faces, materials: dict[str, Material]
) -> tuple[list[Material], NDArray[np.int64]]:
    """The different materials, and for each face the number of its material."""
    numbers: dict[Material, int] = {}
    number_of = np.zeros(len(faces.sizes), np.int64)
    at, current = 0, Material()
    start = 0
    marks = [line for line in faces.lines if line.startswith((b"f ", b"usemtl"))]
    for line in [*marks, b"usemtl"]:
        if line.startswith(b"f "):
            at += 1
            continue
        if at > start:
            number_of[start:at] = numbers.setdefault(current, len(numbers))
            start = at
        name = line[7:].strip().decode("utf-8", errors="replace")
        current = materials.get(name, Material())
    return list(numbers), number_of


def _masks(numbers: NDArray[np.int64], count: int) -> Iterator[NDArray[np.int64] | slice]:
    """Where each of the numbers from 0 stands."""
    if count == 1:
        yield slice(None)
        return
    order = np.argsort(numbers, kind="stable")
    ends = np.cumsum(np.bincount(numbers, minlength=count))
    yield from np.split(order, ends[:-1])


def _columns(faces: Faces) -> NDArray[np.int64] | None:
    """Vertex, texture point and normal of each corner, 0 where there is none, shape (n, 3).

    None where the corners are not all written alike, which no exporter does.
    """
    count = int(faces.sizes.sum())
    text = faces.joined.replace(b"//", b"/0/")
    slashes = text.count(b"/")
    if not slashes or slashes not in {count, 2 * count}:
        return None
    try:
        indices = parse_integers(text.replace(b"/", b" "), "its faces")
    except BrokenMeshError:
        return None
    columns = np.zeros((count, 3), np.int64)
    width = slashes // count + 1
    if len(indices) != count * width:
        return None
    columns[:, :width] = indices.reshape(count, width)
    return columns


def _rows_at(
    columns: NDArray[np.int64] | None, kind: int, faces: Faces, places: NDArray[np.int64]
) -> NDArray[np.float64] | None:
    """The normals or texture points of the triangles; None if one is missing."""
    if columns is None:
        return None
    keyword = KEYWORDS[kind]
    rows = [line for line in faces.lines if line.startswith(keyword)]
    indices = made_absolute(columns[:, kind], faces.lines, keyword)
    if not rows or indices.min() < 1 or indices.max() > len(rows):
        return None
    try:
        return read_rows(rows, WIDTHS[kind], keyword.decode().strip())[indices[places] - 1]
    except BrokenMeshError:
        return None


VERTEX_LINE = re.compile(rb"(?m)^[ \t]*v[ \t]+[-+.\d]")
BEHIND_SLASH = re.compile(rb"/\S*")  # the indices of texture coordinates and normals
LIBRARY = b"mtllib"  # the keyword before the name of a file with materials
COORDINATES = 3
WORD_LIMIT = 12_000_000  # a million triangles have about half of it; so many take a second or two


def is_obj(data: bytes) -> bool:
    """Whether these are the bytes of an OBJ file."""
    return VERTEX_LINE.search(data) is not None


def read_obj(data: bytes, folder: Path | None = None, part: str | None = None) -> Content:
    """The triangles of an OBJ file, or of one part; with their materials if its `folder` is given.

    PyBullet and Gazebo use an index that is out of range, and crash or read other memory.
    """
    refuse_triangles(data.count(b"\nf "))
    if data.count(b" ") + data.count(b"\n") > WORD_LIMIT:
        raise EnormousMeshError(f"has more than {WORD_LIMIT:,} words")
    lines = _lines(data)
    if part is not None:
        lines = _of_part(lines, part)
    vertices = [line for line in lines if line.startswith(b"v ")]
    faces = [line for line in lines if line.startswith(b"f ")]
    points = read_rows(vertices, COORDINATES, "vertex")
    joined = b"".join([line[1:] for line in faces])
    indices = parse_integers(BEHIND_SLASH.sub(b"", joined), "its faces")
    indices = made_absolute(indices, lines, b"v ")
    wrong = indices[(indices < 1) | (indices > len(points))]
    if wrong.size:
        raise BrokenMeshError(
            f"has {len(points)} vertices, and a face refers to number {wrong[0]}: "
            "Gazebo and PyBullet crash on it"
        )
    sizes = np.fromiter((len(line.split()) - 1 for line in faces), np.int64, len(faces))
    # PyBullet and Gazebo's engines open what stands behind it; as a comment it is none.
    cleaned = data.replace(LIBRARY, b"#" * len(LIBRARY)) if LIBRARY in data else None
    if folder is None:
        return Content(corners=points[_cut(indices - 1, sizes)], cleaned=cleaned)
    places = _cut(np.arange(len(indices)), sizes)
    corners = points[indices[places] - 1]
    return content_with_materials(corners, places, Faces(lines, joined, sizes), folder)._replace(
        cleaned=cleaned
    )


def _lines(data: bytes) -> list[bytes]:
    """Its lines, with one blank behind the keyword and none before it."""
    for blank in (b"\r", b"\t", b"\v", b"\f"):
        if blank in data:
            data = data.replace(blank, b"\n" if blank == b"\r" else b" ")
    if b"\\\n" in data:
        data = data.replace(b"\\\n", b" ")
    if b"\n " in data or data.startswith(b" "):
        return [line.lstrip() for line in data.split(b"\n")]
    return data.split(b"\n")


def _of_part(lines: Sequence[bytes], part: str) -> list[bytes]:
    """The lines without the faces of other objects and groups; the last of both names a face.

    Faces before the first of them are of a part without a name.
    """
    kept, names, name = [], set(), ""
    for line in lines:
        if line.startswith((b"o ", b"g ")):
            name = line[2:].strip().decode("utf-8", errors="replace")
        elif not line.startswith(b"f "):
            kept.append(line)
        else:
            names.add(name)
            if name == part:
                kept.append(line)
    check_part(part, filter(None, names))
    return kept


def _cut(indices: NDArray[np.int64], sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    if (sizes == COORDINATES).all():
        return indices.reshape(-1, COORDINATES)
    return triangulate(indices, sizes)
