"""`cv_bridge` reads images as they are; writing them needs messages, which ROS has."""

from __future__ import annotations

import io
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from cv_bridge import CvBridge, CvBridgeError


def image(
    data: np.ndarray, encoding: str, *, padding: int = 0, big: bool = False
) -> SimpleNamespace:
    if big:
        data = data.astype(data.dtype.newbyteorder(">"))
    rows = [row.tobytes() + b"\xee" * padding for row in data]
    return SimpleNamespace(
        height=data.shape[0],
        width=data.shape[1],
        encoding=encoding,
        is_bigendian=int(big),
        step=len(rows[0]),
        data=b"".join(rows),
    )


COLORS = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3) * 9


@pytest.mark.parametrize("padding", [0, 5])
def test_colors_are_put_in_order(padding: int) -> None:
    message = image(COLORS, "rgb8", padding=padding)
    bridge = CvBridge()
    np.testing.assert_array_equal(bridge.imgmsg_to_cv2(message), COLORS)
    np.testing.assert_array_equal(bridge.imgmsg_to_cv2(message, "bgr8"), COLORS[..., ::-1])
    opaque = bridge.imgmsg_to_cv2(message, "bgra8")
    np.testing.assert_array_equal(opaque[..., :3], COLORS[..., ::-1])
    assert (opaque[..., 3] == 255).all()


def test_gray_is_the_brightness() -> None:
    gray = CvBridge().imgmsg_to_cv2(image(COLORS, "rgb8"), "mono8")
    expected = COLORS.astype(float) @ [0.299, 0.587, 0.114]
    assert gray.shape == (2, 3)
    assert np.abs(gray - expected).max() <= 0.5
    back = CvBridge().imgmsg_to_cv2(image(gray, "mono8"), "bgr8")
    np.testing.assert_array_equal(back, np.stack([gray] * 3, axis=-1))


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize(
    ("encoding", "dtype"), [("32FC1", np.float32), ("16UC1", np.uint16), ("mono16", np.uint16)]
)
def test_depth_has_numbers_of_this_machine(encoding: str, dtype: type, big: bool) -> None:
    depth: np.ndarray = np.array([[0, 1000, 2000], [3000, 4000, 65535]], dtype=dtype)
    found = CvBridge().imgmsg_to_cv2(image(depth, encoding, big=big), "passthrough")
    np.testing.assert_array_equal(found, depth)
    assert found.dtype.newbyteorder("=") == dtype
    assert found.dtype.byteorder in {"=", "<" if sys.byteorder == "little" else ">"}


def test_numbers_are_converted_and_kept_in_range() -> None:
    depth = np.array([[0.2, 70000.0]], dtype=np.float32)
    found = CvBridge().imgmsg_to_cv2(image(depth, "32FC1"), "16UC1")
    assert found.tolist() == [[0, 65535]]


@pytest.mark.parametrize(
    ("encoding", "wanted", "text"),
    [
        ("rgb9", "bgr8", "Unrecognized image encoding [rgb9]"),
        ("rgb8", "nonsense", "Unrecognized image encoding [nonsense]"),
        ("8UC3", "mono8", "is not a color format"),
        ("rgba8", "rgba8", "Image is wrongly formed"),
    ],
)
def test_what_makes_no_sense_is_refused(encoding: str, wanted: str, text: str) -> None:
    with pytest.raises(CvBridgeError, match=text.replace("[", r"\[")):
        CvBridge().imgmsg_to_cv2(image(COLORS, encoding), wanted)


def test_compressed_images_are_bgr() -> None:
    buffer = io.BytesIO()
    Image.fromarray(COLORS).save(buffer, "png")
    found = CvBridge().compressed_imgmsg_to_cv2(SimpleNamespace(data=buffer.getvalue()))
    np.testing.assert_array_equal(found, COLORS[..., ::-1])
