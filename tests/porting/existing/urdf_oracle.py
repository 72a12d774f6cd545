"""The kinematics of a URDF, read with nothing of wsgen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Mapping, Sequence


def vector(text: str | None, default: tuple[float, ...]) -> Any:
    return np.array([float(word) for word in text.split()] if text else default)


def frame_of(element: ET.Element | None) -> Any:
    """The frame of the <origin> of an element, as a 4 by 4 matrix."""
    origin = None if element is None else element.find("origin")
    if origin is None:
        return np.eye(4)
    none = (0.0, 0.0, 0.0)
    return transform_of(vector(origin.get("xyz"), none), vector(origin.get("rpy"), none))


def transform_of(xyz: Sequence[float], rpy: Sequence[float]) -> Any:
    """The matrix of a position and fixed-axis roll, pitch and yaw."""
    frame = np.eye(4)
    (a, b, c), (d, e, f) = np.cos(rpy), np.sin(rpy)
    frame[:3, :3] = (
        np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])
        @ np.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
        @ np.array([[1, 0, 0], [0, a, -d], [0, d, a]])
    )
    frame[:3, 3] = xyz
    return frame


def moved(axis: Sequence[float], position: float, *, is_slide: bool) -> Any:
    """What a joint does at a position."""
    frame = np.eye(4)
    if is_slide:
        frame[:3, 3] = np.array(axis) * position
        return frame
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    frame[:3, :3] = np.eye(3) + np.sin(position) * cross + (1 - np.cos(position)) * cross @ cross
    return frame


def motion(joint: ET.Element, position: float) -> Any:
    """What a joint of a URDF does at a position."""
    if joint.get("type") not in {"prismatic", "revolute", "continuous"}:
        return np.eye(4)
    axis = joint.find("axis")
    direction = vector(None if axis is None else axis.get("xyz"), (1.0, 0.0, 0.0))
    return moved(direction, position, is_slide=joint.get("type") == "prismatic")


def poses(robot: ET.Element, positions: Mapping[str, float]) -> dict[str, Any]:
    """The frames of all links in that of the root."""
    joints = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}  # type: ignore[union-attr]
    found: dict[str, Any] = {}

    def place(link: str) -> Any:
        if link not in found:
            joint = joints.get(link)
            if joint is None:
                found[link] = np.eye(4)
            else:
                parent = joint.find("parent").get("link")  # type: ignore[union-attr]
                turn = motion(joint, positions.get(str(joint.get("name")), 0.0))
                found[link] = place(str(parent)) @ frame_of(joint) @ turn
        return found[link]

    for link in robot.findall("link"):
        place(str(link.get("name")))
    return found


def tensor(inertia: ET.Element) -> Any:
    xx, xy, xz, yy, yz, zz = (
        float(inertia.get(one) or 0) for one in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
