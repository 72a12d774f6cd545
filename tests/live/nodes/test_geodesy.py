"""Places on Earth, and the air there."""

from __future__ import annotations

import math

import pytest

from live.nodes.sensor_texts import element
from wsgen.live.nodes.simulator.sensors.motion import LARGE, Origin, pressure_at, read_origin

TEXT = (
    "<spherical_coordinates><latitude_deg>47</latitude_deg><longitude_deg>8</longitude_deg>"
    "<elevation>400</elevation><heading_deg>{}</heading_deg></spherical_coordinates>"
)


def origin(simulator: str = "gz", heading: float = 0.0) -> Origin:
    found = read_origin(element(TEXT.format(heading)), simulator)
    assert found is not None
    return found


def test_the_origin_is_where_the_world_says() -> None:
    assert origin().place((0.0, 0.0, 0.0)) == pytest.approx((47.0, 8.0, 400.0), abs=1e-6)
    assert origin().place((0.0, 0.0, 50.0)) == pytest.approx((47.0, 8.0, 450.0), abs=1e-6)
    assert read_origin(None, "gz") is None


def test_on_the_equator_a_degree_is_as_long_as_it_is() -> None:
    at = Origin(latitude=0.0, longitude=0.0, elevation=0.0)
    latitude, longitude, _ = at.place((1000.0, 0.0, 0.0))
    assert latitude == pytest.approx(0.0, abs=1e-9)
    assert longitude == pytest.approx(math.degrees(1000.0 / LARGE), rel=1e-6)


def test_y_is_north_and_x_is_east() -> None:
    latitude, longitude, elevation = origin().place((0.0, 111.2, 0.0))
    assert latitude == pytest.approx(47.001, abs=2e-6)
    assert longitude == pytest.approx(8.0, abs=1e-9)
    assert elevation == pytest.approx(400.001, abs=1e-3)
    assert origin().place((100.0, 0.0, 0.0))[1] > 8.0


def test_gazebo_classic_needs_half_a_turn() -> None:
    assert origin("classic").place((100.0, 0.0, 0.0))[1] < 8.0
    turned, sim = origin("classic", 180.0), origin("gz")
    assert turned.place((100.0, 50.0, 0.0)) == pytest.approx(sim.place((100.0, 50.0, 0.0)))


def test_pressure_falls_with_altitude() -> None:
    assert pressure_at(0.0) == pytest.approx(101325.0)
    assert pressure_at(60_000.0) == 0.0
    assert pressure_at(1000.0) == pytest.approx(89876.0, rel=1e-4)  # the standard atmosphere's
