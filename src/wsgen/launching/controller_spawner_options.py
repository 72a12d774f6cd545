"""The options of controller_manager's `spawner`, for checks and for the one of live runs.

Source: ros-controls/ros2_control, controller_manager/controller_manager/spawner.py (Humble to
Kilted).
"""

from __future__ import annotations

# Names -> what it is if it is not given. False: a flag; a number: takes a number; an empty tuple:
# may be given several times.
Options = dict[tuple[str, ...], str | float | tuple[()] | None]

OF_SPAWNER: Options = {
    ("-c", "--controller-manager"): "controller_manager",
    ("-n", "--namespace"): None,
    ("-t", "--controller-type"): None,
    ("--controller-manager-timeout",): 0.0,
    ("--switch-timeout",): 5.0,
    ("--service-call-timeout",): 10.0,
    ("--activate-as-group",): False,
    ("--switch-asap", "--no-switch-asap"): False,
    ("-u", "--unload-on-kill"): False,
}
# After `--controller NAME`, for it alone.
OF_CONTROLLER: Options = {
    ("-p", "--param-file"): (),
    ("--load-only",): False,
    ("--inactive",): False,
    ("--stopped",): False,
    ("--controller-ros-args",): (),
}
