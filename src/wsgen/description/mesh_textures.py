"""Images on meshes; the one place of this package that imports Pillow."""

from __future__ import annotations

import io
import math
import warnings
from contextlib import nullcontext
from pathlib import Path
from typing import Any, NamedTuple

from wsgen.description.mesh_content import Complaint
from wsgen.files import read_regular

LARGEST = 1024  # pixels; more cost time and are not seen in a picture
BYTE_LIMIT = 50 * 10**6
PIXEL_LIMIT = 8192 * 8192  # 200 MB when it is unpacked
DEEP_MODES = ("I", "F")  # the beginnings of names of modes with more than 8 bits
FORMATS = ("BMP", "DDS", "GIF", "JPEG", "PNG", "PPM", "TGA", "TIFF", "WEBP")
CONVERT = "Convert it to a PNG of at most 2048 pixels."
REPLACE = "Put an image file there that you may read."


class Texture(NamedTuple):
    """An image for a mesh, or why there is none."""

    path: str | None = None  # a PNG with 8 bits for red, green and blue
    complaint: Complaint | None = None


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
                return Texture(complaint=_missing(image))
            image = found
        # An image in a mesh file is another one for each mesh.
        key = image if isinstance(image, Path) else (mesh, id(image))
        if key not in self._prepared:
            target = self.folder / f"texture{len(self._prepared)}.png"
            small = _read(image)
            if isinstance(small, Unusable):
                name = image.name if isinstance(image, Path) else "inside of it"
                self._prepared[key] = Texture(complaint=_complain(name, small))
            else:
                small.save(target, compress_level=1)  # a full disk is no fault of the image
                self._prepared[key] = Texture(path=str(target))
        return self._prepared[key]


def _find(address: str, folder: Path) -> Path | None:
    """Where Gazebo looks for an image: next to the mesh, and among a model's textures."""
    try:
        places = (folder / address, folder.parent / "materials" / "textures" / address)
        return next((place for place in places if place.exists()), None)
    except (OSError, ValueError):  # too long a name, a null byte
        return None


def _missing(address: str) -> Complaint:
    return Complaint(
        "ROB073",
        f"has a texture that is not there: `{address[:200]}`",
        "Put it next to the mesh or into ../materials/textures, where Gazebo looks for it, and "
        "let CMakeLists.txt install it.",
    )


def _complain(name: str, found: Unusable) -> Complaint:
    message = f"has a texture that cannot be shown: `{name}` {found.problem}"
    return Complaint("ROB074", message, found.hint)


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
        return Unusable(
            "is not a valid image: it is cut short or damaged, or of a format that is not read"
        )


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
