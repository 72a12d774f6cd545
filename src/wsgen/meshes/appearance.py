"""Makes of a mesh with materials what a renderer draws: files of one color or texture each.

They have no more triangles than a picture shows, and textures of a size and format that every
renderer reads.
"""

from __future__ import annotations

import io
import math
import warnings
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.files import read_regular
from wsgen.isolation.child import announce
from wsgen.meshes.content import Material, Patch, bounds_of, flat_normals
from wsgen.meshes.obj import write_obj
from wsgen.meshes.requests import MISSING_TEXTURE, UNUSABLE_TEXTURE, ColoredMesh, MaterialProblem

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from wsgen.meshes.content import Content
    from wsgen.meshes.requests import Showing
    from wsgen.model.transform import Vector


# To write and load a million, and to draw them twice, takes 5 s.
BUDGET = 100_000  # triangles of a robot; a picture of 960 by 720 shows no more
FEW = 500  # a patch with no more is left as it is, and none is left with less
HALVINGS = 12  # of a cell that is too large for a small patch
SAMPLE = 4_000  # triangles of a patch that say how many of all will be left
FINEST = 1 / 2000  # of the largest patch: no cell is smaller
GROWTH = 1.25  # from one size of the cells to the next
CELLS = 2**20  # along each edge, so that a cell's number has 60 bits


class Drawn(NamedTuple):
    """A patch, and how a robot shows it."""

    patch: Patch
    times: int  # in so many places
    scale: float  # the largest of the three, without sign


def reduce_patches(drawn: Sequence[Drawn], budget: int = BUDGET) -> list[Patch]:
    """The patches, with no more triangles than a robot may have.

    The corners that lie in one cell of a grid become one, and what has no area then is left out.
    The cells are equally large in all patches, so that the robot is equally fine all over, and
    smaller only where little of a patch would be left: a small or thin one does not vanish.
    Normals and texture points stay those of the corner.
    """
    if sum(len(one.patch.corners) * one.times for one in drawn) <= budget:
        return [one.patch for one in drawn]
    largest = max(one.scale * _extent(one.patch.corners) for one in drawn)
    samples = [_sample(one.patch.corners) for one in drawn]
    cell = largest * FINEST
    for _ in range(math.ceil(math.log(1 / FINEST, GROWTH))):
        left = sum(
            one.times * len(one.patch.corners) * _share_left(sample, cell / one.scale)
            for one, sample in zip(drawn, samples, strict=True)
        )
        if left <= budget:
            break
        cell *= GROWTH
    return [_clustered(one.patch, cell / one.scale) for one in drawn]


def _extent(corners: NDArray[Any]) -> float:
    points = corners.reshape(-1, 3)
    return max(float(points[:, axis].max() - points[:, axis].min()) for axis in range(3))


def _sample(corners: NDArray[Any]) -> NDArray[Any]:
    return corners[:: max(1, len(corners) // SAMPLE)]


def _share_left(corners: NDArray[Any], cell: float) -> float:
    """How many of the triangles have corners in three cells, 0 to 1."""
    return 1.0 if len(corners) <= FEW else float(_is_left(_cells(corners, cell)).mean())


def _clustered(patch: Patch, cell: float) -> Patch:
    if len(patch.corners) <= FEW:
        return patch
    for halving in range(HALVINGS):
        cells = _cells(patch.corners, cell / 2**halving)
        left = np.flatnonzero(_is_left(cells))
        if len(left) >= FEW:
            break
    before = patch.corners[left]
    _, first, places = np.unique(cells[left].ravel(), return_index=True, return_inverse=True)
    corners = before.reshape(-1, 3)[first][places].reshape(-1, 3, 3)
    flat = flat_normals(before)
    # What has been turned over is a fold, and is not seen from the side that the surface is.
    is_upright = np.einsum("ij,ij->i", flat, flat_normals(corners)) > 0
    if not is_upright.any():  # no triangle has an area
        return patch
    left, flat = left[is_upright], flat[is_upright]
    points = patch.texture_points
    return patch._replace(
        corners=corners[is_upright],
        normals=np.repeat(flat[:, None], 3, axis=1)
        if patch.normals is None
        else patch.normals[left],
        texture_points=None if points is None else points[left],
    )


def _cells(corners: NDArray[Any], cell: float) -> NDArray[np.int64]:
    """The number of the cell that each corner is in, shape (n, 3)."""
    numbers = np.zeros(corners.shape[:2], np.int64)
    for axis in range(3):
        along = corners[:, :, axis]
        steps = np.floor((along - along.min()) / cell).astype(np.int64)
        numbers = numbers * CELLS + np.minimum(steps, CELLS - 1)
    return numbers


def _is_left(cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    first, second, third = cells.T
    is_left: NDArray[np.bool_] = (first != second) & (second != third) & (third != first)
    return is_left


LARGEST = 1024  # pixels; more cost time and are not seen in a picture
BYTE_LIMIT = 50 * 10**6
PIXEL_LIMIT = 8192 * 8192  # 200 MB when it is unpacked
DEEP_MODES = ("I", "F")  # the beginnings of names of modes with more than 8 bits
FORMATS = ("BMP", "DDS", "GIF", "JPEG", "PNG", "PPM", "TGA", "TIFF", "WEBP")
CONVERT = "Convert it to a PNG of at most 2048 pixels."
REPLACE = "Replace it with an image file that you are allowed to read."


class Texture(NamedTuple):
    """An image for a mesh, or why there is none."""

    path: str | None = None  # a PNG with 8 bits for red, green and blue
    problem: MaterialProblem | None = None


class Unusable(NamedTuple):
    """What keeps an image from being shown."""

    problem: str  # what the image is or has
    hint: str = CONVERT


class Textures:
    """Prepares images for a renderer, each once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._prepared: dict[Any, Texture] = {}

    def prepare(self, image: Any, mesh: Path) -> Texture:
        """The image in a file that any renderer reads.

        Args:
            image: Its address as the mesh has it, or a Pillow image, opened and not read.
            mesh: The file of the mesh.

        Raises:
            OSError: The file cannot be written.
        """
        if isinstance(image, str):
            found = _find(image, mesh.parent)
            if found is None:
                return Texture(problem=_missing(image))
            image = found
        # An image in a mesh file is another one for each mesh.
        key = image if isinstance(image, Path) else (mesh, id(image))
        if key not in self._prepared:
            target = self.folder / f"texture{len(self._prepared)}.png"
            small = _read(image)
            if isinstance(small, Unusable):
                name = image.name if isinstance(image, Path) else "inside of it"
                self._prepared[key] = Texture(problem=_unusable(name, small))
            else:
                small.save(target, compress_level=1)  # a full disk is not a problem of the image
                self._prepared[key] = Texture(path=str(target))
        return self._prepared[key]


def _find(address: str, folder: Path) -> Path | None:
    """Where Gazebo looks for an image: next to the mesh, and among a model's textures."""
    try:
        places = (folder / address, folder.parent / "materials" / "textures" / address)
        return next((place for place in places if place.exists()), None)
    except (OSError, ValueError):  # too long a name, a null byte
        return None


def _missing(address: str) -> MaterialProblem:
    return MaterialProblem(
        MISSING_TEXTURE,
        f"has a texture that does not exist: `{address[:200]}`",
        "Put the image next to the mesh or into ../materials/textures, where Gazebo looks for it, "
        "and install it in CMakeLists.txt.",
    )


def _unusable(name: str, found: Unusable) -> MaterialProblem:
    message = f"has a texture that cannot be drawn: `{name}` {found.problem}"
    return MaterialProblem(UNUSABLE_TEXTURE, message, found.hint)


def _read(image: Any) -> Any:
    """The image, small and with 8 bits for each color; Unusable if it cannot be shown."""
    if isinstance(image, Path):
        try:
            data = read_regular(image, BYTE_LIMIT)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            return Unusable(f"cannot be read ({reason})", REPLACE)
        if len(data) > BYTE_LIMIT:
            return Unusable(f"has more than {BYTE_LIMIT / 1e6:.0f} MB")
        image = io.BytesIO(data)
    return _decode(image)


def _decode(source: Any) -> Any:
    """The same of the bytes of a file, or of a Pillow image."""
    # It takes a while to import, and most robots have no textures.
    from PIL import Image, ImageOps  # noqa: PLC0415

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of large images; ours is the limit
            is_file = isinstance(source, io.BytesIO)
            with Image.open(source, formats=FORMATS) if is_file else nullcontext(source) as opened:
                width, height = opened.size
                if width * height > PIXEL_LIMIT:
                    return Unusable(f"has {width} by {height} pixels")
                opened.draft("RGB", (LARGEST, LARGEST))  # JPEG is read smaller at once
                return ImageOps.contain(_eight_bits(opened), _size(*opened.size))
    except MemoryError:
        raise
    except Image.DecompressionBombError:  # it has far more than we take
        return Unusable(f"has more than {PIXEL_LIMIT / 1e6:.0f} million pixels")
    except Exception:  # noqa: BLE001  Pillow raises anything on broken images
        return Unusable("is not a valid image: it is cut short, damaged or of an unknown format")


def _size(width: int, height: int) -> tuple[int, int]:
    """At most LARGEST pixels each."""
    factor = min(1.0, LARGEST / max(width, height))
    return max(1, math.floor(width * factor)), max(1, math.floor(height * factor))


def _eight_bits(image: Any) -> Any:
    """The image as red, green and blue of 8 bits; of 16 bits the upper ones."""
    if image.mode.startswith(DEEP_MODES):
        _, high = image.getextrema()
        if high > 255:  # noqa: PLR2004  the largest of 8 bits
            image = image.point(lambda value: value / 256)
        image = image.convert("L")
    return image.convert("RGB")


KEPT = 1_000_000  # triangles that wait for the end; with more, those that wait are reduced first

MATERIALS = 64  # of a mesh; robots' have up to 30


class _Part(NamedTuple):
    """What is to become a ColoredMesh."""

    request: int  # the number of the file that it is of
    showing: Showing
    patch: Patch
    file: Path | None  # of these triangles and no others, if a renderer may take it
    triangles: int  # before any was left out
    low: Vector
    high: Vector


class AppearanceWriter:
    """Collects what is seen of the meshes of a robot, and writes it when all is there."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.textures = Textures(folder)
        self._parts: list[_Part] = []

    def add(
        self, request: int, file: Path, content: Content, showings: Iterable[Showing]
    ) -> list[MaterialProblem]:
        """Take in a mesh file; gives what is wrong with its materials."""
        problems = dict.fromkeys(content.material_problems)
        for showing in showings:
            patches = content.patches or (Patch(content.corners),)
            if showing.is_painted:
                patches = tuple(patch._replace(material=Material()) for patch in patches)
            groups = _merged(patches)
            is_file = content.is_drawable and len(groups) == 1 and _is_even(showing.scale)
            for patch in groups:
                seen, problem = self._with_texture(patch, file)
                if problem is not None:
                    problems[problem] = None
                low, high = bounds_of(patch.corners)
                own = file if is_file and seen.material.image is None else None
                count = len(patch.corners)
                self._parts.append(_Part(request, showing, seen, own, count, low, high))
        if sum(len(part.patch.corners) for part in self._parts) > KEPT:
            self._reduce()
        return list(problems)

    def write(self) -> dict[tuple[int, Showing], list[ColoredMesh]]:
        """Write the files; what to draw for each request and each way of showing it."""
        self._reduce()
        colored: dict[tuple[int, Showing], list[ColoredMesh]] = {}
        for number, part in enumerate(self._parts):
            announce(str(part.request))
            path = part.file
            if path is None or part.triangles > len(part.patch.corners):
                path = self.folder / f"colored{number}.obj"
                write_obj(part.patch, part.showing.scale, path)
            rgba, image = part.patch.material
            mesh = ColoredMesh(
                path=str(path),
                rgba=rgba,
                texture=image,
                low=part.low,
                high=part.high,
                triangles=len(part.patch.corners),
            )
            colored.setdefault((part.request, part.showing), []).append(mesh)
        return colored

    def _reduce(self) -> None:
        drawn = [
            Drawn(part.patch, part.showing.times, _largest(part.showing.scale))
            for part in self._parts
        ]
        reduced = reduce_patches(drawn)
        self._parts = [
            part._replace(patch=patch) for part, patch in zip(self._parts, reduced, strict=True)
        ]

    def _with_texture(self, patch: Patch, file: Path) -> tuple[Patch, MaterialProblem | None]:
        """The patch with an image that can be drawn, or without one."""
        image = patch.material.image
        if image is None:
            return patch._replace(texture_points=None), None
        path, problem = self.textures.prepare(image, file)
        if patch.texture_points is None or not np.isfinite(patch.texture_points).all():
            path = None
        points = None if path is None else patch.texture_points
        material = Material(rgba=patch.material.rgba, image=path)
        return patch._replace(texture_points=points, material=material), problem


def _merged(patches: Sequence[Patch]) -> list[Patch]:
    """One patch for each material; of very many the smallest are shown as one."""
    groups: dict[Any, list[Patch]] = {}
    for patch in patches:
        rgba, image = patch.material
        groups.setdefault((rgba, image if isinstance(image, str) else id(image)), []).append(patch)
    merged = [group[0] if len(group) == 1 else _joined(group) for group in groups.values()]
    if len(merged) <= MATERIALS:
        return merged
    merged.sort(key=lambda patch: len(patch.corners), reverse=True)
    return [*merged[: MATERIALS - 1], _joined(merged[MATERIALS - 1 :])]


def _joined(group: Sequence[Patch]) -> Patch:
    """Patches of one material as one; what one of them lacks is not a number there."""
    return Patch(
        corners=np.concatenate([patch.corners for patch in group]),
        normals=_concatenated([patch.normals for patch in group], group, 3),
        texture_points=_concatenated([patch.texture_points for patch in group], group, 2),
        material=group[0].material,
    )


def _concatenated(rows: Sequence[Any], group: Sequence[Patch], width: int) -> Any:
    if all(part is None for part in rows):
        return None
    return np.concatenate(
        [
            np.full((len(patch.corners), 3, width), 0.0 if width == 2 else np.nan)  # noqa: PLR2004
            if part is None
            else part
            for part, patch in zip(rows, group, strict=True)
        ]
    )


def _is_even(scale: Vector) -> bool:
    """Whether normals stay what they are."""
    return scale[0] > 0 and len(set(scale)) == 1


def _largest(scale: Vector) -> float:
    return max((abs(part) for part in scale if math.isfinite(part) and part), default=1.0)
