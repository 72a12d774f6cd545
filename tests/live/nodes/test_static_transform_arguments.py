"""Old and new arguments of static_transform_publisher."""

from __future__ import annotations

import math

import pytest
from scipy.spatial.transform import Rotation

from wsgen.live.nodes.static_transform_arguments import ArgumentsError, parse_arguments

FRAMES = "--frame-id map --child-frame-id base"


@pytest.mark.parametrize(
    ("text", "xyz", "xyzw", "is_old"),
    [
        (FRAMES, (0, 0, 0), (0, 0, 0, 1), False),
        (f"--x 1 --y -2 --z .5 {FRAMES}", (1, -2, 0.5), (0, 0, 0, 1), False),
        (f"--qz 1 --qw 0 {FRAMES}", (0, 0, 0), (0, 0, 1, 0), False),
        ("1 2 3 0 0 0 1 map base", (1, 2, 3), (0, 0, 0, 1), True),
        ("1e1 2 3 0 0 0 map base", (10, 2, 3), (0, 0, 0, 1), True),
    ],
)
def test_arguments(
    text: str, xyz: tuple[float, ...], xyzw: tuple[float, ...], is_old: bool
) -> None:
    found, old = parse_arguments(text.split())
    assert found is not None
    assert (found.frame, found.child) == ("map", "base")
    assert found.xyz == xyz
    assert found.xyzw == pytest.approx(xyzw)
    assert old is is_old


def test_the_old_order_is_yaw_pitch_roll() -> None:
    expected = Rotation.from_euler("xyz", [0.3, 0.2, 0.1]).as_quat()
    for text in (
        "0 0 0 0.1 0.2 0.3 map base",
        f"--roll 0.3 --pitch 0.2 --yaw 0.1 {FRAMES}",
    ):
        found, _ = parse_arguments(text.split())
        assert found is not None
        assert found.xyzw == pytest.approx(tuple(expected))


def test_a_number_ends_where_c_ends_it() -> None:
    found, _ = parse_arguments(["--x", "1.5m", "--yaw", str(math.pi), *FRAMES.split()])
    assert found is not None
    assert found.xyz[0] == 1.5
    assert found.xyzw == pytest.approx((0, 0, 1, 0), abs=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "Frame id must not be empty"),
        ("--frame-id map", "Child frame id must not be empty"),
        ("1 2 3", "Extra unparsed arguments on command-line"),
        (f"{FRAMES} --x", "Not enough arguments for --x"),
        (f"{FRAMES} --x east", "Failed to parse --x argument as float"),
        (f"{FRAMES} --qx 1 --yaw 2", "Cannot specify both quaternion and Euler rotations"),
        (
            "1 2 3 0 0 0 map base --x 2",
            "Cannot specify both new-style (flags) and old-style (arguments)",
        ),
        ("1 2 3 0 0 north map base", "Failed to parse roll argument as float"),
    ],
)
def test_refusals_are_those_of_the_original(text: str, message: str) -> None:
    with pytest.raises(ArgumentsError) as caught:
        parse_arguments(text.split())
    assert str(caught.value) == message


@pytest.mark.parametrize("text", ["--help", "-h", f"{FRAMES} --help"])
def test_help(text: str) -> None:
    assert parse_arguments(text.split()) == (None, False)
