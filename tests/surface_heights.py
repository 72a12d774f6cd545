"""How high triangles are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def height_at(corners: NDArray[Any], x: float, y: float) -> float:
    """How high the triangles are at a place; NaN where there are none."""
    (a, b, c), at = corners.transpose(1, 0, 2), np.array([x, y, 0.0])
    whole = np.cross(b - a, c - a)[:, 2]
    shares = [
        np.cross(one - at, other - at)[:, 2] / whole for one, other in ((b, c), (c, a), (a, b))
    ]
    inside = np.min(shares, axis=0) > -1e-9
    if not inside.any():
        return math.nan
    here = [share[inside][0] for share in shares]
    return float(sum(share * z for share, z in zip(here, corners[inside][0, :, 2], strict=True)))
