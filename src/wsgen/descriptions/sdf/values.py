"""Numbers, truth values and poses of SDF."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.descriptions.rules import NOT_A_NUMBER
from wsgen.descriptions.sdf.source import POSE_FRAMES
from wsgen.model.transform import IDENTITY, Pose, rotation_of_quaternion, rpy_of_rotation
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from wsgen.descriptions.sdf.source import Source
    from wsgen.model.transform import Vector
    from wsgen.text.xmltree import Element


TRUTH = {"true": True, "1": True, "false": False, "0": False}
ROTATIONS = {"euler_rpy": 6, "quat_xyzw": 7}  # and how many numbers such a pose has
FARTHEST = 1e9  # m; beyond, numbers are mistakes and cannot hold a millimeter


def first(element: Element, *path: str) -> Element | None:
    """The element at a path of names; of several children of one name, the first counts."""
    place: Element | None = element
    for tag in path:
        if place is None:
            return None
        place = next(children(place, tag), None)
    return place


def read_numbers(
    source: Source, element: Element, count: int, *, limit: float = math.inf
) -> tuple[float, ...] | None:
    """The finite numbers of an element; None, with a diagnostic, for anything else."""
    words = (element.text or "").split()
    try:
        numbers = tuple(float(word) for word in words if "_" not in word)
    except ValueError:
        numbers = ()
    if len(numbers) == count and all(
        math.isfinite(number) and abs(number) <= limit for number in numbers
    ):
        return numbers
    source.report(
        NOT_A_NUMBER,
        f"<{element.tag}> needs {count} finite number{'s' if count > 1 else ''}"
        f"{'' if limit == math.inf else f' up to {limit:g}'}, "
        f"not {' '.join(words)[:60] or 'nothing'!r}.",
        at=element,
        hint="Separate numbers by blanks, and use a decimal point.",
    )
    return None


def number(source: Source, parent: Element, *path: str, default: float) -> float:
    """The number at a path; the default if it is missing or wrong."""
    found = _written(parent, path)
    numbers = None if found is None else read_numbers(source, found, 1)
    return default if numbers is None else numbers[0]


def optional_number(source: Source, parent: Element, *path: str) -> float | None:
    """The number at a path; None if it is missing or wrong."""
    found = _written(parent, path)
    numbers = None if found is None else read_numbers(source, found, 1)
    return None if numbers is None else numbers[0]


def triple(source: Source, parent: Element, *path: str, default: Vector) -> Vector:
    """Three numbers at a path; the default if they are missing or wrong."""
    found = _written(parent, path)
    numbers = None if found is None else read_numbers(source, found, 3)
    return default if numbers is None else (numbers[0], numbers[1], numbers[2])


def truth(source: Source, parent: Element, *path: str, default: bool) -> bool:
    """The truth value at a path; the default if it is missing or wrong."""
    found = _written(parent, path)
    if found is None:
        return default
    word = (found.text or "").strip()
    if word.lower() not in TRUTH:
        source.report(
            NOT_A_NUMBER,
            f"<{found.tag}> needs true or false, not {word[:60]!r}.",
            at=found,
            hint="Write true, false, 1 or 0.",
        )
    return TRUTH.get(word.lower(), default)


def word(parent: Element, *path: str) -> str:
    """The text at a path; empty if it is missing."""
    found = first(parent, *path)
    return "" if found is None else (found.text or "").strip()


def read_pose(source: Source, owner: Element) -> tuple[Pose, str]:
    """The pose of an element, and the frame it is relative to (empty: the default one)."""
    element = first(owner, "pose")
    if element is None:
        return IDENTITY, ""
    frame = element.get("relative_to") or ""
    if not frame and source.version < POSE_FRAMES:
        frame = element.get("frame") or ""
    if not (element.text or "").strip():
        return IDENTITY, frame
    form = element.get("rotation_format") or "euler_rpy"
    if form not in ROTATIONS:
        source.report(
            NOT_A_NUMBER,
            f"`{form}` is not a rotation format.",
            at=element,
            hint=f"Use {' or '.join(ROTATIONS)}.",
        )
        return IDENTITY, frame
    numbers = read_numbers(source, element, ROTATIONS[form], limit=FARTHEST)
    if numbers is None:
        return IDENTITY, frame
    xyz = (numbers[0], numbers[1], numbers[2])
    if form == "quat_xyzw":
        return Pose(xyz, _rpy_of_quaternion(source, element, numbers[3:])), frame
    rpy = (numbers[3], numbers[4], numbers[5])
    if (element.get("degrees") or "").lower() in {"true", "1"}:
        rpy = (math.radians(rpy[0]), math.radians(rpy[1]), math.radians(rpy[2]))
    return Pose(xyz, rpy), frame


def _rpy_of_quaternion(source: Source, element: Element, xyzw: tuple[float, ...]) -> Vector:
    length = math.hypot(*xyzw)
    if length == 0:
        source.report(
            NOT_A_NUMBER,
            "The quaternion 0 0 0 0 has length 0.",
            at=element,
            hint="Write 0 0 0 1 (x, y, z, w) for no rotation.",
        )
        return (0.0, 0.0, 0.0)
    x, y, z, w = (part / length for part in xyzw)
    return rpy_of_rotation(rotation_of_quaternion((x, y, z, w)))


def _written(parent: Element, path: tuple[str, ...]) -> Element | None:
    """The element at a path; None also if it is empty, which means the default."""
    found = first(parent, *path)
    return None if found is None or not (found.text or "").strip() else found
