"""Things that happen to nodes."""

from launch._lazy import finder

_HOMES = {"lifecycle": "", "matchers": "", "matches_node_name": "matchers"}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
