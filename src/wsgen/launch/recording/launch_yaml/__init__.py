"""Recording stand-in for the `launch_yaml` package."""

from launch._lazy import finder

_HOMES = {"launch_description_sources": ""}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
