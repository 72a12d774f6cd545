"""All event handlers."""

from launch._lazy import finder

_HOMES = {
    "OnExecutionComplete": "on_execution_complete",
    "OnProcessExit": "on_process_exit",
    "OnProcessIO": "on_process_io",
    "OnProcessStart": "on_process_start",
    "OnShutdown": "on_shutdown",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
