"""Shim of the `launch_ros` package."""

from launch._finder import names_on_demand

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
__getattr__ = names_on_demand(__name__, _HOMES)
