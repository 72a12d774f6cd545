"""Image messages and arrays as OpenCV has them (vision_opencv, cv_bridge/python/cv_bridge/core.py).

An array has rows, columns and, where there are several, channels; its numbers are those of the
message. Encodings are converted as cv_bridge does: colors to each other and to gray.
"""

from __future__ import annotations

import io
import re
import sys
from typing import Any, NamedTuple

import numpy as np

# Names of sensor_msgs/image_encodings.hpp -> NumPy's type, and the order of colors.
COLORS = {
    "rgb8": (np.uint8, "rgb"),
    "rgba8": (np.uint8, "rgba"),
    "bgr8": (np.uint8, "bgr"),
    "bgra8": (np.uint8, "bgra"),
    "mono8": (np.uint8, "g"),
    "rgb16": (np.uint16, "rgb"),
    "rgba16": (np.uint16, "rgba"),
    "bgr16": (np.uint16, "bgr"),
    "bgra16": (np.uint16, "bgra"),
    "mono16": (np.uint16, "g"),
}
BAYER = re.compile(r"bayer_\w{4}(8|16)")
NUMBERS = re.compile(r"(8U|8S|16U|16S|32S|32F|64F)(?:C(\d+))?")
TYPES: dict[str, type[np.generic]] = {
    "8U": np.uint8,
    "8S": np.int8,
    "16U": np.uint16,
    "16S": np.int16,
    "32S": np.int32,
    "32F": np.float32,
    "64F": np.float64,
}
# What OpenCV takes of red, green and blue for gray.
GRAY = np.array([0.299, 0.587, 0.114])
YUV = {"yuv422": (1, 0, 2), "yuv422_yuy2": (0, 1, 3)}  # where Y, U and V are in four bytes
WITH_BYTE_ORDER = 2  # bytes of a number, from which on their order matters


class CvBridgeError(TypeError):
    """An image that cannot be converted."""


class Encoding(NamedTuple):
    """What the numbers of an image are."""

    dtype: np.dtype[Any]
    channels: int
    colors: str  # empty where they are no colors


class CvBridge:
    """Converts images."""

    def imgmsg_to_cv2(self, img_msg: Any, desired_encoding: str = "passthrough") -> Any:
        """The array of a sensor_msgs/Image, converted where another encoding is desired."""
        if img_msg.encoding in YUV:
            image, encoding = _from_yuv(img_msg), _encoding("bgr8")
        else:
            encoding = _encoding(img_msg.encoding)
            image = _pixels(img_msg, encoding)
        if desired_encoding in {"", "passthrough"}:
            return image
        return _converted(image, encoding, _encoding(desired_encoding), img_msg.encoding)

    def cv2_to_imgmsg(self, cvim: Any, encoding: str = "passthrough", header: Any = None) -> Any:
        """The sensor_msgs/Image of an array."""
        from sensor_msgs.msg import Image

        if not isinstance(cvim, np.ndarray):
            raise TypeError("Your input type is not a numpy array")
        channels = 1 if cvim.ndim < 3 else cvim.shape[2]  # noqa: PLR2004
        written = encoding
        if encoding == "passthrough":
            written = f"{_name(cvim.dtype)}C{channels}"
        else:
            wanted = _encoding(encoding)
            if (wanted.dtype, wanted.channels) != (cvim.dtype.newbyteorder("="), channels):
                raise CvBridgeError(
                    f"encoding specified as {encoding}, but image has incompatible type "
                    f"{_name(cvim.dtype)}C{channels}"
                )
        data = np.ascontiguousarray(cvim)
        message = Image(
            height=data.shape[0],
            width=data.shape[1],
            encoding=written,
            is_bigendian=int(_is_big(data.dtype)),
            step=data.shape[1] * channels * data.dtype.itemsize,
        )
        message.data.frombytes(data.tobytes())
        if header is not None:
            message.header = header
        return message

    def compressed_imgmsg_to_cv2(
        self, cmprs_img_msg: Any, desired_encoding: str = "passthrough"
    ) -> Any:
        """The array of a sensor_msgs/CompressedImage (PNG, JPEG and what Pillow reads), BGR."""
        from PIL import Image as Picture

        with Picture.open(io.BytesIO(bytes(cmprs_img_msg.data))) as picture:
            is_gray = picture.mode in {"1", "L", "I;16"}
            image = np.array(picture if is_gray else picture.convert("RGB"))
        if not is_gray:
            image = np.ascontiguousarray(image[..., ::-1])
        if desired_encoding in {"", "passthrough"}:
            return image
        name = "mono16" if image.dtype == np.uint16 else "mono8" if is_gray else "bgr8"
        return _converted(image, _encoding(name), _encoding(desired_encoding), name)

    def cv2_to_compressed_imgmsg(self, cvim: Any, dst_format: str = "jpg") -> Any:
        """The sensor_msgs/CompressedImage of a BGR or gray array of 8 bits."""
        from PIL import Image as Picture
        from sensor_msgs.msg import CompressedImage

        if not isinstance(cvim, np.ndarray):
            raise TypeError("Your input type is not a numpy array")
        picture = Picture.fromarray(
            cvim if cvim.ndim == 2 else np.ascontiguousarray(cvim[..., 2::-1])  # noqa: PLR2004
        )
        buffer = io.BytesIO()
        kind = {"jpg": "jpeg", "jpe": "jpeg", "tif": "tiff"}.get(dst_format, dst_format)
        picture.save(buffer, kind, **({"quality": 95} if kind == "jpeg" else {}))
        message = CompressedImage(format=dst_format)
        message.data.frombytes(buffer.getvalue())
        return message

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """NumPy's name of the type of an encoding, and its number of channels."""
        found = _encoding(encoding)
        return found.dtype.name, found.channels

    def dtype_with_channels_to_cvtype2(self, dtype: Any, n_channels: int) -> str:
        """OpenCV's name of a type with channels."""
        return f"{_name(np.dtype(dtype))}C{n_channels}"


def _encoding(name: str) -> Encoding:
    if name in COLORS:
        kind, colors = COLORS[name]
        return Encoding(np.dtype(kind), len(colors), colors)
    bayer = BAYER.fullmatch(name)
    if bayer:
        return Encoding(np.dtype(np.uint8 if bayer[1] == "8" else np.uint16), 1, "")
    numbers = NUMBERS.fullmatch(name)
    if numbers:
        return Encoding(np.dtype(TYPES[numbers[1]]), int(numbers[2] or 1), "")
    raise CvBridgeError(f"Unrecognized image encoding [{name}]")


def _name(dtype: np.dtype[Any]) -> str:
    for name, kind in TYPES.items():
        if dtype.newbyteorder("=") == np.dtype(kind):
            return name
    raise CvBridgeError(f"an image cannot have numbers of the type {dtype}")


def _is_big(dtype: np.dtype[Any]) -> bool:
    order = dtype.byteorder
    return order == ">" or (order == "=" and sys.byteorder == "big")


def _pixels(message: Any, encoding: Encoding) -> Any:
    """The numbers of a message, without what fills its rows up."""
    dtype = encoding.dtype
    if dtype.itemsize >= WITH_BYTE_ORDER:
        dtype = dtype.newbyteorder(">" if message.is_bigendian else "<")
    height, width, channels = message.height, message.width, encoding.channels
    row = width * channels * dtype.itemsize
    data = np.frombuffer(message.data, dtype=np.uint8)
    if message.step < row or data.size < message.step * height:
        raise CvBridgeError(
            f"Image is wrongly formed: {data.size} bytes in rows of {message.step} are not "
            f"{height} rows of {width} pixels of {channels * dtype.itemsize} bytes"
        )
    rows = data[: message.step * height].reshape(height, message.step)[:, :row]
    image = np.ascontiguousarray(rows).view(dtype).astype(encoding.dtype, copy=False)
    return image.reshape((height, width) if channels == 1 else (height, width, channels))


def _from_yuv(message: Any) -> Any:
    """BGR of an image whose pixels share their colors in pairs."""
    pairs = _pixels(message, Encoding(np.dtype(np.uint8), 2, "")).reshape(
        message.height, message.width // 2, 4
    )
    y, u, v = YUV[message.encoding]
    light = pairs[..., [y, y + 2]].reshape(message.height, -1).astype(float) - 16.0
    blue, red = (
        np.repeat(pairs[..., channel].astype(float) - 128.0, 2, axis=1) for channel in (u, v)
    )
    # BT.601, as OpenCV has it.
    colors = (
        1.164 * light + 2.018 * blue,
        1.164 * light - 0.391 * blue - 0.813 * red,
        1.164 * light + 1.596 * red,
    )
    return np.clip(np.rint(np.stack(colors, axis=-1)), 0, 255).astype(np.uint8)


def _converted(image: Any, encoding: Encoding, wanted: Encoding, name: str) -> Any:
    if encoding.colors and wanted.colors:
        image = _recolored(image, encoding.colors, wanted.colors)
        if encoding.dtype != wanted.dtype:
            image = image / 257.0 if wanted.dtype == np.uint8 else image.astype(float) * 257.0
            image = np.rint(image).astype(wanted.dtype)
        return image
    if encoding.channels != wanted.channels:
        raise CvBridgeError(
            f"[{name}] is not a color format. but [{wanted.channels} channels] is. "
            "The conversion does not make sense"
        )
    if encoding.dtype == wanted.dtype:
        return image
    limits = np.iinfo(wanted.dtype) if wanted.dtype.kind in "iu" else None
    if limits is None:
        return image.astype(wanted.dtype)
    return np.clip(np.rint(image), limits.min, limits.max).astype(wanted.dtype)


def _recolored(image: Any, colors: str, wanted: str) -> Any:
    """The channels in another order, gray made of colors or colors of gray."""
    if colors == wanted:
        return image
    highest = np.iinfo(image.dtype).max
    if colors == "g":
        channels = dict.fromkeys("rgb", image)
    else:
        channels = {color: image[..., index] for index, color in enumerate(colors)}
    if wanted == "g":
        mixed = sum(
            channels[color].astype(float) * part for color, part in zip("rgb", GRAY, strict=True)
        )
        return np.rint(mixed).astype(image.dtype)
    opaque = channels.get("a", np.full(image.shape[:2], highest, dtype=image.dtype))
    return np.stack([opaque if color == "a" else channels[color] for color in wanted], axis=-1)
