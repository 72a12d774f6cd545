"""The surface of a heightmap, as Gazebo Sim's physics has it."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from PIL import Image

from wsgen.description.mesh_content import BrokenMeshError
from wsgen.files import irregular_kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsgen.model.robot import Heightmap

MOST_PIXELS = 4097  # on a side; Gazebo's rendering has no larger tile either
MOST_ROWS = 513  # of corners: half a million triangles, for which an engine takes a second
EIGHT_BITS = 255.0
SIXTEEN_BITS = 65535.0
REDUCE = "Reduce it: a trial needs no more than a pixel for each wheel."
SAVE_ANEW = "Save it anew as greyscale PNG, with 2ⁿ + 1 pixels on each side (129, 257, 513, …)."


class Surface(NamedTuple):
    """A heightmap as triangles."""

    corners: NDArray[Any]  # (n, 3, 3), m, counter-clockwise seen from above
    pixels: int  # of the image, on a side
    rows: int  # of corners


def heightmap_surface(heightmap: Heightmap) -> Surface:
    """Its surface, without its offset `pos`.

    One row of pixels is that row's share of the size: the outermost are half a share away from
    the border. Between four pixels the surface folds along the diagonal from low x and y to high
    ones.

    Raises:
        BrokenMeshError: The image cannot be used.
    """
    brightness, brightest = _read(Path(heightmap.path or ""))
    pixels = len(brightness)
    count = (pixels - 1) * heightmap.sampling + 1  # of corners on a side in Gazebo
    kept = np.unique(np.linspace(0, count - 1, min(count, MOST_ROWS)).round().astype(np.int64))
    heights = _between(brightness, kept / heightmap.sampling)
    width, depth, height = heightmap.size
    heights *= abs(height) / brightest if brightest else 1.0
    if height < 0:  # what Gazebo does; it makes sense for a height of 1 m alone
        heights = 1.0 - heights
    shares = (kept - (count - 1) / 2) / count
    points = np.empty((len(kept), len(kept), 3))
    points[..., 0] = shares * width
    points[..., 1] = -(shares * depth)[:, None]
    points[..., 2] = heights
    above, below = points[:-1], points[1:]
    upper_left, upper_right = above[:, :-1], above[:, 1:]
    lower_left, lower_right = below[:, :-1], below[:, 1:]
    corners = np.concatenate(
        [
            np.stack([lower_left, upper_right, upper_left], axis=2),
            np.stack([lower_left, lower_right, upper_right], axis=2),
        ]
    )
    return Surface(corners.reshape(-1, 3, 3), pixels, len(kept))


def _read(file: Path) -> tuple[NDArray[Any], float]:
    """The brightness of each pixel, 0 to 1, and that of the brightest.

    It is that of the red channel; which pixel is the brightest is judged by all channels.
    """
    kind = irregular_kind(file)
    if kind is not None:
        raise BrokenMeshError(f"is {kind}", hint=SAVE_ANEW)
    try:
        pixels = _load(file)
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise BrokenMeshError("has a hundred million pixels or more", hint=REDUCE) from None
    except (BrokenMeshError, MemoryError):
        raise
    except Exception:  # noqa: BLE001  Pillow raises anything on broken images
        raise BrokenMeshError(
            "is not a valid PNG or JPEG file: it is cut short or damaged", hint=SAVE_ANEW
        ) from None
    if pixels.ndim == 2:  # noqa: PLR2004  16 bits, grey
        grey = pixels / SIXTEEN_BITS
        return grey, float(grey.max())
    red, green, blue = (pixels[..., channel] for channel in range(3))
    brightest = np.argmax(red.astype(np.uint16) + green + blue)
    return red / EIGHT_BITS, float(red.flat[brightest] / EIGHT_BITS)


def _load(file: Path) -> NDArray[Any]:
    """The pixels: 16 bits in rows and columns, or 8 bits with channels as third axis."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        with Image.open(file, formats=("PNG", "JPEG")) as image:
            _refuse_shape(*image.size)
            return np.asarray(image if image.mode.startswith("I") else image.convert("RGB"))


def _refuse_shape(width: int, height: int) -> None:
    if width != height or width < 2:  # noqa: PLR2004  a surface begins between two rows
        raise BrokenMeshError(
            f"has {width} × {height} pixels: Gazebo ends on one that is not square, or has one "
            "pixel alone",
            hint=SAVE_ANEW,
        )
    if width > MOST_PIXELS:
        raise BrokenMeshError(
            f"has {width} × {height} pixels, more than {MOST_PIXELS} × {MOST_PIXELS}",
            hint=REDUCE,
        )


def _between(brightness: NDArray[Any], places: NDArray[Any]) -> NDArray[Any]:
    """The brightness at places in rows and columns, linearly between the pixels."""
    low = np.floor(places).astype(np.int64)
    high = np.ceil(places).astype(np.int64)
    share = places - low
    rows = brightness[low] * (1 - share)[:, None] + brightness[high] * share[:, None]
    between: NDArray[Any] = rows[:, low] * (1 - share) + rows[:, high] * share
    return between
