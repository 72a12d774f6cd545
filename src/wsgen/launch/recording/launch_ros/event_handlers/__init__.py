"""Handlers of what happens to nodes."""

from launch._lazy import finder

_HOMES = {"OnStateTransition": "on_state_transition"}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
