"""Lights: a picture gets the direction and color of the first that shines down."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.model.world import World

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.descriptions.sdf.models import SdfFile

    Read = Callable[..., SdfFile]

GROUND = "<include><uri>model://ground_plane</uri></include>"
SUN = "<include><uri>model://sun</uri></include>"
GAZEBO = ((-0.5, 0.1, -0.9), (0.8, 0.8, 0.8))
HALF = math.sqrt(0.5)


def light(name: str, content: str, kind: str = "directional") -> str:
    return f'<light name="{name}" type="{kind}">{content}</light>'


def sun_of(read: Read, content: str) -> World:
    file = read(f'<world name="w">{GROUND}{content}</world>')
    assert file.diagnostics == ()
    assert file.world is not None
    return file.world


@pytest.mark.parametrize(
    ("content", "direction", "color"),
    [
        ("", *GAZEBO),
        (SUN, *GAZEBO),
        (light("a", ""), (0, 0, -1), (1, 1, 1)),
        (light("a", "<direction>3 0 -4</direction>"), (0.6, 0, -0.8), (1, 1, 1)),
        (
            light("a", "<diffuse>1 0.5 2 1</diffuse><direction>0 0 -9</direction>"),
            (0, 0, -1),
            (1, 0.5, 1),
        ),
        (light("a", "<diffuse>1 0.5 0.2</diffuse>"), (0, 0, -1), (1, 0.5, 0.2)),
        (light("a", "<pose>0 0 9 0 0.7853981633974483 0</pose>"), (-HALF, 0, -HALF), (1, 1, 1)),
        (light("a", "<direction>0 0 1</direction>") + SUN, *GAZEBO),  # from below
        (light("a", "<light_on>false</light_on>"), *GAZEBO),
        (light("a", "", "point"), *GAZEBO),
        (SUN + light("a", ""), *GAZEBO),  # the first
        (light("a", "") + SUN, (0, 0, -1), (1, 1, 1)),
        (light("a", "<direction>0 0 0</direction>"), *GAZEBO),
    ],
)
def test_the_sun(
    read: Read, content: str, direction: tuple[float, ...], color: tuple[float, ...]
) -> None:
    world = sun_of(read, content)
    length = math.hypot(*direction)
    assert world.sun_direction == pytest.approx([part / length for part in direction])
    assert world.sun_color == color


def test_the_default_is_gazebos_own() -> None:
    world = World(name="w")
    assert math.hypot(*world.sun_direction) == pytest.approx(1)
    x, y, z = world.sun_direction
    assert (x / z, y / z) == pytest.approx((5 / 9, -1 / 9))


def test_what_is_wrong_with_a_light(read: Read) -> None:
    wrong = light("a", "<direction>0 0 nan</direction><diffuse>1 2</diffuse>")
    file = read(f'<world name="w">{GROUND}{wrong}</world>')
    assert [found.code for found in file.diagnostics] == ["ROB016", "ROB016"]
    assert file.world is not None
    assert file.world.sun_direction == (0, 0, -1)
