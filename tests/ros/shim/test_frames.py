"""The frames of tf2, compared with products of matrices of SciPy's rotations."""

from __future__ import annotations

import math
import threading
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from tf2_py import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from tf2_py._frames import Frames
from tf2_py._rotations import normalize, slerp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tf2_py._frames import Transform
    from tf2_py._rotations import Quaternion, Vector

SECOND = 10**9

coordinate = st.floats(-100, 100, allow_nan=False)
vectors = st.tuples(coordinate, coordinate, coordinate)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


class Recorder(Frames):
    """Frames, and what they said."""

    def __init__(self, cache: int = 10 * SECOND) -> None:
        self.said: list[str] = []
        super().__init__(cache, self.said.append)

    def put(
        self,
        parent: str,
        child: str,
        stamp: float = 0,
        xyz: Vector = (0.0, 0.0, 0.0),
        xyzw: Quaternion = (0.0, 0.0, 0.0, 1.0),
        *,
        static: bool = False,
    ) -> bool:
        return self.add(
            parent=parent,
            child=child,
            stamp=round(stamp * SECOND),
            translation=xyz,
            rotation=xyzw,
            authority="test",
            is_static=static,
        )


def matrix(xyz: Vector, xyzw: Quaternion) -> NDArray[np.float64]:
    found = np.eye(4)
    found[:3, :3] = Rotation.from_quat(xyzw).as_matrix()
    found[:3, 3] = xyz
    return found


def of(found: Transform) -> NDArray[np.float64]:
    return matrix(found.translation, found.rotation)


@pytest.mark.slow
@settings(max_examples=30)
@given(st.lists(st.tuples(vectors, quaternions, st.integers(0, 100)), min_size=1, max_size=6))
def test_lookups_are_products_of_matrices(
    steps: list[tuple[Vector, Quaternion, int]],
) -> None:
    frames, places = Recorder(), {"0": np.eye(4)}
    for number, (xyz, xyzw, above) in enumerate(steps, start=1):
        parent = str(above % number)
        frames.put(parent, str(number), 5, xyz, xyzw, static=bool(above % 2))
        places[str(number)] = places[parent] @ matrix(xyz, xyzw)
    for target, outer in places.items():
        for source, inner in places.items():
            found = frames.lookup(target, source, 0)
            np.testing.assert_allclose(of(found), np.linalg.inv(outer) @ inner, atol=1e-9)
            assert frames.refusal(target, source, 0) == ""
    assert frames.said == []


@pytest.mark.slow
@given(vectors, vectors, quaternions, quaternions, st.floats(0, 1))
def test_between_two_times_a_transform_is_interpolated(
    start: Vector, end: Vector, turn: Quaternion, other: Quaternion, ratio: float
) -> None:
    frames = Recorder()
    frames.put("map", "base", 1, start, turn)
    frames.put("map", "base", 3, end, other)
    stamp = round((1 + 2 * ratio) * SECOND)
    found = frames.lookup("map", "base", stamp)
    exact = (stamp / SECOND - 1) / 2
    place = (1 - exact) * np.array(start) + exact * np.array(end)
    np.testing.assert_allclose(found.translation, place, atol=1e-6)
    rotations = Rotation.from_quat([turn, other])
    if rotations[0].inv().__mul__(rotations[1]).magnitude() < math.pi - 1e-3:
        expected = Slerp([0, 1], rotations)([exact])[0]
        assert (expected.inv() * Rotation.from_quat(found.rotation)).magnitude() < 1e-6


@pytest.mark.slow
@given(quaternions, quaternions, st.floats(0, 1))
def test_slerp_is_of_unit_length_and_symmetric(
    start: Quaternion, end: Quaternion, ratio: float
) -> None:
    start, end = normalize(start), normalize(end)
    there, back = slerp(start, end, ratio), slerp(end, start, 1 - ratio)
    assert math.isclose(math.hypot(*there), 1.0)
    cosine = sum(a * b for a, b in zip(start, end, strict=True))
    if abs(cosine) > 1e-6:  # otherwise both ways are as short
        assert (Rotation.from_quat(there).inv() * Rotation.from_quat(back)).magnitude() < 1e-6


@pytest.mark.slow
@given(quaternions)
def test_normalize_keeps_the_rotation_and_fixes_the_sign(turn: Quaternion) -> None:
    unit = normalize(turn)
    assert (Rotation.from_quat(turn).inv() * Rotation.from_quat(unit)).magnitude() < 1e-7
    assert normalize((-turn[0], -turn[1], -turn[2], -turn[3])) == unit


def test_latest_is_the_latest_common_time() -> None:
    frames = Recorder()
    for stamp in (1, 2, 3):
        frames.put("map", "odom", stamp, (stamp, 0.0, 0.0))
    for half in (1.5, 2.5):
        frames.put("odom", "base", half, (0.0, half, 0.0))
    frames.put("base", "laser", 0, (0.0, 0.0, 1.0), static=True)
    found = frames.lookup("map", "laser", 0)
    assert found.stamp == 2.5 * SECOND
    assert found.translation == (2.5, 2.5, 1.0)
    assert frames.latest_common_stamp("map", "laser") == 2.5 * SECOND
    assert frames.lookup("base", "laser", 0).stamp == 0
    assert frames.lookup("odom", "odom", 0).stamp == 3 * SECOND
    assert frames.lookup("odom", "odom", 7).stamp == 7


def test_a_lookup_through_a_fixed_frame_has_two_times() -> None:
    frames = Recorder()
    for stamp in (1, 2):
        frames.put("odom", "base", stamp, (float(stamp), 0.0, 0.0))
        frames.put("base", "gripper", stamp, (0.0, float(stamp), 0.0))
    found = frames.lookup_through("base", 2 * SECOND, "gripper", SECOND, "odom")
    assert found.translation == (-1.0, 1.0, 0.0)
    assert found.stamp == 2 * SECOND
    assert not frames.refusal_through("base", 2 * SECOND, "gripper", SECOND, "odom")
    assert frames.refusal_through("base", 9 * SECOND, "gripper", SECOND, "odom")


@pytest.mark.parametrize(
    ("target", "source", "stamp", "kind", "message"),
    [
        (
            "map",
            "nobody",
            0,
            LookupException,
            '"nobody" passed to lookupTransform argument source_frame does not exist. ',
        ),
        (
            "/map",
            "base",
            0,
            InvalidArgumentException,
            (
                'Invalid argument "/map" passed to lookupTransform argument target_frame - '
                "in tf2 frame_ids cannot start with a '/'"
            ),
        ),
        (
            "map",
            "",
            0,
            InvalidArgumentException,
            (
                'Invalid argument "" passed to lookupTransform argument source_frame - '
                "in tf2 frame_ids cannot be empty"
            ),
        ),
        (
            "map",
            "island",
            0,
            ConnectivityException,
            (
                "Could not find a connection between 'map' and 'island' because they are not "
                "part of "
                "the same tree.Tf has two or more unconnected trees."
            ),
        ),
        (
            "map",
            "base",
            9,
            ExtrapolationException,
            (
                "Lookup would require extrapolation into the future.  Requested time 9.000000 "
                "but the "
                "latest data is at time 3.000000, when looking up transform from frame [base] to "
                "frame [map]"
            ),
        ),
        (
            "base",
            "map",
            0.5,
            ExtrapolationException,
            (
                "Lookup would require extrapolation into the past.  Requested time 0.500000 but "
                "the "
                "earliest data is at time 1.250000, when looking up transform from frame [map] to "
                "frame [base]"
            ),
        ),
        (
            "rock",
            "island",
            2,
            ExtrapolationException,
            (
                "Lookup would require extrapolation at time 2.000000, but only time 1.000000 is "
                "in the "
                "buffer, when looking up transform from frame [island] to frame [rock]"
            ),
        ),
    ],
)
def test_messages(
    target: str, source: str, stamp: float, kind: type[TransformException], message: str
) -> None:
    frames = Recorder()
    frames.put("map", "base", 1.25)
    frames.put("map", "base", 3)
    frames.put("rock", "island", 1)
    with pytest.raises(kind) as caught:
        frames.lookup(target, source, round(stamp * SECOND))
    assert str(caught.value) == message
    assert frames.refusal(target, source, round(stamp * SECOND))


def test_a_loop_is_said() -> None:
    frames = Recorder()
    frames.put("a", "b", 1)
    frames.put("b", "a", 1)
    frames.put("c", "d", 1)
    with pytest.raises(LookupException, match="contains a loop"):
        frames.lookup("d", "a", 0)


@pytest.mark.parametrize(
    ("parent", "child", "xyz", "xyzw", "word"),
    [
        ("a", "a", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), "TF_SELF_TRANSFORM"),
        ("a", "", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), "TF_NO_CHILD_FRAME_ID"),
        ("", "b", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), "TF_NO_FRAME_ID"),
        ("a", "b", (math.nan, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), "TF_NAN_INPUT"),
        ("a", "b", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), "TF_DENORMALIZED_QUATERNION"),
    ],
)
def test_what_is_no_transform_is_refused(
    parent: str, child: str, xyz: Vector, xyzw: Quaternion, word: str
) -> None:
    frames = Recorder()
    assert not frames.put(parent, child, 1, xyz, xyzw)
    assert any(text.startswith(word) for text in frames.said)
    assert frames.names() == []


def test_the_cache_reaches_back_as_far_as_it_is_asked_to() -> None:
    frames = Recorder(cache=2 * SECOND)
    for stamp in range(1, 8):
        frames.put("map", "base", stamp)
    assert frames.refusal("map", "base", 3 * SECOND)
    assert not frames.refusal("map", "base", 5 * SECOND)
    assert not frames.put("map", "base", 4.5)
    assert frames.said[-1].startswith("TF_OLD_DATA ignoring data from the past for frame base")
    assert frames.put("map", "base", 5.5, (1.0, 0.0, 0.0))  # late, but not too late
    assert frames.lookup("map", "base", round(5.5 * SECOND)).translation == (1.0, 0.0, 0.0)


def test_clear_keeps_static_transforms() -> None:
    frames = Recorder()
    frames.put("map", "odom", 1)
    frames.put("odom", "base", 0, static=True)
    frames.clear()
    assert frames.refusal("map", "odom", 0)
    assert not frames.refusal("odom", "base", 0)
    frames.put("map", "odom", 0.5)  # time began anew
    assert frames.lookup("map", "base", 0).stamp == SECOND // 2


def test_a_frame_may_become_static_and_back() -> None:
    frames = Recorder()
    frames.put("map", "base", 1, (1.0, 0.0, 0.0))
    frames.put("map", "base", 0, (2.0, 0.0, 0.0), static=True)
    assert frames.lookup("map", "base", 99 * SECOND).translation == (2.0, 0.0, 0.0)
    frames.put("map", "base", 3, (3.0, 0.0, 0.0))
    assert frames.refusal("map", "base", 99 * SECOND)


def test_texts() -> None:
    frames = Recorder()
    assert frames.as_yaml() == "[]"
    frames.put("/map", "/base", 1)
    frames.put("map", "base", 2)
    assert frames.as_text() == "Frame base exists with parent map.\n"
    assert "base: \n  parent: 'map'\n  broadcaster: 'test'\n  rate: 2.000\n" in frames.as_yaml()


@settings(max_examples=20)
@given(st.permutations(range(1, 9)))
def test_the_order_of_arrival_does_not_matter(order: list[int]) -> None:
    frames = Recorder()
    for stamp in order:
        frames.put("map", "base", stamp, (float(stamp), 0.0, 0.0))
    for half in range(2, 16):
        found = frames.lookup("map", "base", half * SECOND // 2)
        assert math.isclose(found.translation[0], half / 2)


def test_threads_may_write_while_others_look_up() -> None:
    frames = Recorder(cache=SECOND // 100)
    frames.put("map", "base", 1)
    failures: list[BaseException] = []

    def write() -> None:
        for step in range(3000):
            frames.put("map", "base", 1 + step * 1e-3)

    def read() -> None:
        try:
            for _ in range(3000):
                frames.lookup("map", "base", 0)
        except BaseException as error:  # noqa: BLE001
            failures.append(error)

    threads = [threading.Thread(target=work) for work in (write, read, read)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
