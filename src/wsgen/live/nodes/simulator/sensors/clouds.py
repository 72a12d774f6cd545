"""Point clouds as their messages have them."""

from __future__ import annotations

import array
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

FLOAT32, UINT16 = 7, 4  # of sensor_msgs/PointField
SIZES = {FLOAT32: 4, UINT16: 2}
NUMPY = {FLOAT32: "<f4", UINT16: "<u2"}


def layout(fields: dict[str, tuple[int, int]], step: int) -> np.dtype[Any]:
    """The NumPy type of points with these fields: offset and type (of PointField) by name."""
    return np.dtype(
        {
            "names": list(fields),
            "formats": [NUMPY[kind] for _, kind in fields.values()],
            "offsets": [offset for offset, _ in fields.values()],
            "itemsize": step,
        }
    )


def fill_cloud(
    message: Any, fields: dict[str, tuple[int, int]], points: NDArray[Any], *, is_dense: bool
) -> None:
    """Put points (rows by columns, of the type of `layout`) into a sensor_msgs/PointCloud2."""
    from sensor_msgs.msg import PointField  # noqa: PLC0415  nodes alone

    message.height, message.width = points.shape
    message.fields = [
        PointField(name=name, offset=offset, datatype=kind, count=1)
        for name, (offset, kind) in fields.items()
    ]
    message.point_step = points.dtype.itemsize
    message.row_step = points.dtype.itemsize * points.shape[1]
    message.is_bigendian = False
    message.is_dense = bool(is_dense)
    message.data = array.array("B", points.tobytes())
