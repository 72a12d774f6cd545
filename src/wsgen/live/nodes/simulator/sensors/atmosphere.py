"""The air of the standard atmosphere. No ROS in here.

Source: gazebosim/gz-sensors, src/AirPressureSensor.cc.
"""

from __future__ import annotations

GAS_CONSTANT = 8314.32 / 28.9644  # J/(kg K), of air
PULL = 9.80665  # m/s²
SEA_PRESSURE = 101325.0  # Pa, and at that temperature:
SEA_TEMPERATURE = 288.15  # K
LAPSE = 0.0065  # K/m
EARTH = 6356766.0  # m


def pressure_at(altitude: float) -> float:
    """The pressure at an altitude (m), Pa."""
    height = EARTH * altitude / (EARTH + altitude)
    temperature = SEA_TEMPERATURE - LAPSE * height
    # Where the formula has no air any more, it has no pressure.
    share: float = (max(temperature, 0.0) / SEA_TEMPERATURE) ** (PULL / (LAPSE * GAS_CONSTANT))
    return SEA_PRESSURE * share
