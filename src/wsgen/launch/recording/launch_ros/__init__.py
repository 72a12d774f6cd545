"""Recording stand-in for the `launch_ros` package."""

from launch._lazy import finder

_HOMES = {
    "actions": "",
    "descriptions": "",
    "event_handlers": "",
    "events": "",
    "parameter_descriptions": "",
    "substitutions": "",
    "utilities": "",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
