"""Things that happen to nodes with states."""

from launch._lazy import finder

_HOMES = {
    "ChangeState": "change_state",
    "StateTransition": "state_transition",
    "matches_node_name": "matchers",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
