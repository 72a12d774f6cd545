"""Makes of a mesh with materials what a renderer draws: arrays of one color or texture each.

Textures have a size and format that every renderer reads.
"""

from __future__ import annotations

import io
import math
import warnings
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.descriptions.meshes.content import Material, Patch, bounds_of
from wsgen.descriptions.meshes.requests import (
    MISSING_TEXTURE,
    UNUSABLE_TEXTURE,
    ColoredMesh,
    MaterialProblem,
)
from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.descriptions.meshes.content import Content


LARGEST = 1024  # pixels; more cost time and are not seen in a picture
BYTE_LIMIT = 50 * 10**6
PIXEL_LIMIT = 8192 * 8192  # 200 MB when it is unpacked
DEEP_MODES = ("I", "F")  # the beginnings of names of modes with more than 8 bits
FORMATS = ("BMP", "DDS", "GIF", "JPEG", "PNG", "PPM", "TGA", "TIFF", "WEBP")
CONVERT = "Convert it to a PNG of at most 2048 pixels."
REPLACE = "Replace it by an image file that is readable."


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
        "Copy the image next to the mesh or to ../materials/textures, where Gazebo looks for it, "
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


MATERIALS = 64  # of a mesh; robots' have up to 30


class AppearanceWriter:
    """Writes what is seen of the meshes of a robot."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.textures = Textures(folder)
        self._written = 0

    def write(
        self, file: Path, content: Content, showings: Iterable[bool]
    ) -> tuple[list[tuple[ColoredMesh, ...]], list[MaterialProblem]]:
        """Write what is seen of a mesh file, for each way of showing it, as `MeshRequest` has it.

        Gives what to draw, and what is wrong with the materials.
        """
        problems = dict.fromkeys(content.material_problems)
        colored = []
        for is_painted in showings:
            patches = content.patches or (Patch(content.corners),)
            if is_painted:
                patches = tuple(patch._replace(material=Material()) for patch in patches)
            meshes = []
            for patch in _merged(patches):
                seen, problem = self._with_texture(patch, file)
                if problem is not None:
                    problems[problem] = None
                meshes.append(self._write(seen))
            colored.append(tuple(meshes))
        return colored, list(problems)

    def _write(self, patch: Patch) -> ColoredMesh:
        """Write the triangles of a patch.

        An array in single precision, of 3, 6 or 8 coordinates by three corners by n: points,
        normals, texture points. Normals that are missing are not numbers.
        """
        path = self.folder / f"colored{self._written}.npy"
        self._written += 1
        normals, points = patch.normals, patch.texture_points
        if normals is None and points is not None:
            normals = np.full_like(patch.corners, np.nan)
        parts = [part for part in (patch.corners, normals, points) if part is not None]
        rows = np.empty((sum(part.shape[2] for part in parts), 3, len(patch.corners)), np.float32)
        start = 0
        for part in parts:
            rows[start : start + part.shape[2]] = part.T
            start += part.shape[2]
        np.save(path, rows)
        low, high = bounds_of(patch.corners)
        rgba, image = patch.material
        return ColoredMesh(
            path=str(path),
            rgba=rgba,
            texture=image,
            low=low,
            high=high,
            triangles=len(patch.corners),
        )

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
