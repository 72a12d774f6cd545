"""The sensors that the simulator has, one module each.

A kind is the attribute `type` of a `<sensor>`; the class follows its module, which is imported when
a robot has such a sensor. It takes the `MountedSensor` where that of a plugin takes its element.
"""

from __future__ import annotations

SENSORS: dict[str, str] = {}
