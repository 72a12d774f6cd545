"""Things that happen."""

from launch._lazy import finder

_HOMES = {
    "ExecutionComplete": "execution_complete",
    "Shutdown": "shutdown",
    "TimerEvent": "timer_event",
    "matches_action": "matchers",
    "process": "",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
