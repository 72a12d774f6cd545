"""Things that happen to processes."""

from launch._lazy import finder

_HOMES = {
    "ProcessExited": "process_exited",
    "ProcessIO": "process_io",
    "ProcessStarted": "process_started",
    "ProcessStderr": "process_io",
    "ProcessStdin": "process_io",
    "ProcessStdout": "process_io",
    "RunningProcessEvent": "running_process_event",
    "ShutdownProcess": "process_targeted_event",
    "SignalProcess": "process_targeted_event",
    "matches_name": "process_matchers",
    "matches_pid": "process_matchers",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
