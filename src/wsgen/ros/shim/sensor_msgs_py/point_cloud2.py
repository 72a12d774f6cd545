"""sensor_msgs/PointCloud2 as arrays and back (common_interfaces, sensor_msgs_py)."""

from __future__ import annotations

import array
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

if TYPE_CHECKING:
    from collections.abc import Iterable

DUMMY_FIELD_PREFIX = "unnamed_field"
TYPES: dict[int, np.dtype[Any]] = {
    PointField.INT8: np.dtype(np.int8),
    PointField.UINT8: np.dtype(np.uint8),
    PointField.INT16: np.dtype(np.int16),
    PointField.UINT16: np.dtype(np.uint16),
    PointField.INT32: np.dtype(np.int32),
    PointField.UINT32: np.dtype(np.uint32),
    PointField.FLOAT32: np.dtype(np.float32),
    PointField.FLOAT64: np.dtype(np.float64),
}
ROWS_AND_COLUMNS = 2


def read_points(
    cloud: Any,
    field_names: list[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
    reshape_organized_cloud: bool = False,
) -> Any:
    """The points as a structured array with a field for each name.

    `uvs` chooses points by their index, or by column and row.
    """
    points = np.ndarray(
        shape=(cloud.width * cloud.height,),
        dtype=dtype_from_fields(cloud.fields, cloud.point_step),
        buffer=_without_padding(cloud),
    )
    if field_names is not None:
        missing = [name for name in field_names if name not in (points.dtype.names or ())]
        if missing:
            raise AssertionError("Requests field is not in the fields of the PointCloud!")
        points = points[list(field_names)]
    if bool(sys.byteorder != "little") != bool(cloud.is_bigendian):
        points = points.byteswap()
    if skip_nans:
        bad = np.zeros(len(points), dtype=bool)
        for name in points.dtype.names or ():
            column = np.isnan(points[name])
            bad |= column.reshape(len(points), -1).any(axis=1)
        points = points[~bad]
    if uvs is not None:
        chosen = np.asarray(list(uvs) if not isinstance(uvs, np.ndarray) else uvs)
        if chosen.ndim == ROWS_AND_COLUMNS:
            chosen = chosen[:, 0] + cloud.width * chosen[:, 1]
        points = points[chosen]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.height, cloud.width)
    return points


def read_points_numpy(
    cloud: Any,
    field_names: list[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
    reshape_organized_cloud: bool = False,
) -> Any:
    """The points as a plain array, a column for each field; all fields are of one type."""
    chosen = [field for field in cloud.fields if field_names is None or field.name in field_names]
    if len({field.datatype for field in chosen}) > 1:
        raise AssertionError("All fields need to have the same datatype. Use `read_points()`")
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    columns = [points[name] for name in points.dtype.names or ()]
    return np.concatenate(
        [column[..., None] if column.ndim == points.ndim else column for column in columns], axis=-1
    )


def read_points_list(
    cloud: Any,
    field_names: list[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
) -> list[Any]:
    """The points as named tuples."""
    from collections import namedtuple

    points = read_points(cloud, field_names, skip_nans, uvs)
    point = namedtuple("Point", points.dtype.names)  # type: ignore[misc]  # noqa: PYI024
    return [point._make(one) for one in points]


def dtype_from_fields(fields: Iterable[Any], point_step: int | None = None) -> np.dtype[Any]:
    """NumPy's type of a point."""
    names: list[str] = []
    offsets: list[int] = []
    formats: list[Any] = []
    for index, field in enumerate(fields):
        name = field.name or f"{DUMMY_FIELD_PREFIX}_{index}"
        if name in names:
            raise AssertionError("Duplicate field names are not allowed!")
        kind = TYPES[field.datatype]
        names.append(name)
        offsets.append(field.offset)
        formats.append(kind if field.count == 1 else (kind, (field.count,)))
    described: Any = {"names": names, "formats": formats, "offsets": offsets}
    if point_step is not None:
        described["itemsize"] = point_step
    dtype: np.dtype[Any] = np.dtype(described)
    return dtype


def create_cloud(
    header: Any,
    fields: Iterable[Any],
    points: Any,
    step: int | None = None,
    point_step: int | None = None,
) -> Any:
    """A PointCloud2 of points: a structured array, a plain array, or a list of tuples."""
    fields = list(fields)
    dtype = dtype_from_fields(fields, point_step)
    if not isinstance(points, np.ndarray):
        structured = np.array([tuple(point) for point in points], dtype=dtype)
    elif points.dtype.names is None:
        structured = _structured(points, dtype)
    else:
        structured = points
    is_organized = structured.ndim == ROWS_AND_COLUMNS
    height, width = structured.shape if is_organized else (1, structured.shape[0])
    data = array.array("B")
    data.frombytes(np.ascontiguousarray(structured).tobytes())
    size = structured.dtype.itemsize
    return PointCloud2(
        header=header,
        is_dense=False,
        is_bigendian=sys.byteorder != "little",
        height=height,
        width=width,
        fields=fields,
        point_step=size,
        row_step=step or size * width,
        data=data,
    )


def create_cloud_xyz32(header: Any, points: Any, step: int | None = None) -> Any:
    """A PointCloud2 of points with three numbers each."""
    fields = [
        PointField(name=name, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, name in enumerate("xyz")
    ]
    return create_cloud(header, fields, points, step)


def _without_padding(cloud: Any) -> bytes:
    """The bytes of the points, without what fills rows up."""
    row = cloud.width * cloud.point_step
    if cloud.row_step <= row:
        return bytes(cloud.data)
    rows = np.frombuffer(bytes(cloud.data), dtype=np.uint8).reshape(cloud.height, cloud.row_step)
    return rows[:, :row].tobytes()


def _structured(points: Any, dtype: np.dtype[Any]) -> Any:
    found = np.zeros(points.shape[:-1], dtype=dtype)
    column = 0
    for name in dtype.names or ():
        count = int(np.prod(dtype[name].shape)) if dtype[name].shape else 1
        values = points[..., column : column + count]
        found[name] = values if dtype[name].shape else values[..., 0]
        column += count
    return found
