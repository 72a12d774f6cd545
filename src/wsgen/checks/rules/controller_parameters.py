"""The rule about names and types of the parameters of controllers.

Source: ros-controls/ros2_controllers, the `*_parameter*.yaml` of each controller, Humble to master.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.text import yamlfile


INVALID_CONTROLLER_PARAMETER = Rule(
    code="ROB150",
    name="invalid-controller-parameter",
    severity=Severity.ERROR,
    severity_varies="a warning about a misspelled name, and about a controller that no launch file "
    "of the package starts",
    summary="A controller parameter has the wrong type or a misspelled name.",
    what="Compares the parameters of diff_drive_controller, joint_trajectory_controller, "
    "forward_command_controller and joint_state_broadcaster, and `update_rate` of the controller "
    "manager, with their declarations.",
    why="A node refuses a value of the wrong type, even an integer for a double: the controller "
    "cannot be configured. A misspelled name is ignored.",
    example="""
diff_drive_controller:
  ros__parameters:
    left_wheel_names: left_wheel_joint
    wheel_separaton: 0.32
    publish_rate: 50
""",
    instead="""
diff_drive_controller:
  ros__parameters:
    left_wheel_names: [left_wheel_joint]
    wheel_separation: 0.32
    publish_rate: 50.0
""",
)
_LIMITS = "velocity acceleration jerk deceleration acceleration_reverse deceleration_reverse"
_DIFF_DRIVE = {
    "double": "cmd_vel_timeout left_wheel_radius_multiplier publish_rate "
    "right_wheel_radius_multiplier wheel_radius wheel_separation wheel_separation_multiplier "
    + " ".join(
        f"{axis}.{end}_{limit}"
        for axis in ("linear.x", "angular.z")
        for end in ("max", "min")
        for limit in _LIMITS.split()
    ),
    "integer": "velocity_rolling_window_size wheels_per_side",
    "boolean": "enable_odom_tf open_loop position_feedback publish_limited_velocity "
    "tf_frame_prefix_enable use_stamped_vel "
    + " ".join(
        f"{axis}.has_{limit}_limits"
        for axis in ("linear.x", "angular.z")
        for limit in ("velocity", "acceleration", "jerk")
    ),
    "text": "base_frame_id odom_frame_id tf_frame_prefix",
    "list of texts": "left_wheel_names right_wheel_names",
    "list of doubles": "pose_covariance_diagonal twist_covariance_diagonal",
}
_TRAJECTORIES = {
    "double": "action_monitor_rate cmd_timeout constraints.goal_time "
    "constraints.stopped_velocity_tolerance state_publish_rate",
    "boolean": "allow_integration_in_goal_trajectories allow_nonzero_velocity_at_trajectory_end "
    "allow_partial_joints_goal allow_trajectory_replacement interpolate_from_desired_state "
    "open_loop_control set_last_command_interface_value_as_state_on_activation start_with_holding",
    "text": "interpolation_method",
    "list of texts": "command_interfaces command_joints joints state_interfaces",
}
PARAMETERS = {
    "diff_drive_controller/DiffDriveController": _DIFF_DRIVE,
    "joint_trajectory_controller/JointTrajectoryController": _TRAJECTORIES,
    "forward_command_controller/ForwardCommandController": {
        "text": "interface_name",
        "list of texts": "joints",
    },
    "joint_state_broadcaster/JointStateBroadcaster": {
        "boolean": "publish_dynamic_joint_states use_local_topics use_urdf_to_filter",
        "text": "frame_id",
        "list of texts": "extra_joints interfaces joints",
    },
    "": {"integer": "update_rate"},  # the controller manager
}
SURELY = 0.88  # so alike, as difflib counts, are a name and the one that it misspells


@cache
def _types(kind: str) -> Mapping[str, str]:
    return {
        name: type_ for type_, names in PARAMETERS.get(kind, {}).items() for name in names.split()
    }


def invalid_parameters(
    name: str, kind: str, values: yamlfile.Value, file: Path, severity: Severity | None
) -> Iterator[Diagnostic]:
    """Check the parameters of a controller.

    Args:
        name: Its name.
        kind: Its type; empty: the controller manager.
        values: Its parameters.
        file: That has them.
        severity: Of values that rclcpp refuses; None: that of the rule.
    """
    declared = _types(kind)
    given = dict(_flat(values))
    who = f"`{name}`" if kind else "the controller manager"
    lone = values.get("type")
    if not kind and lone is not None and "/" in (lone.text or ""):
        yield INVALID_CONTROLLER_PARAMETER.at(
            file,
            lone.line,
            f"{name}.type",
            message="`type` is at the level of the controller names, not below one of them.",
            hint="Indent `type` by one more level, below the name of its controller.",
            severity=severity,
        )
    for key, value in given.items():
        if key in declared:
            hint = _how_to_write(key, value, declared[key])
            if hint is not None:
                yield INVALID_CONTROLLER_PARAMETER.at(
                    file,
                    value.line,
                    f"{name}.{key}",
                    message=f"The parameter `{key}` of {who} is {_shown(value)}, but must be "
                    f"{'an' if declared[key] == 'integer' else 'a'} {declared[key]}.",
                    hint=hint,
                    severity=severity,
                )
        elif kind:
            meant = nearest(key, declared.keys() - given.keys(), cutoff=SURELY)
            if meant is not None:
                yield INVALID_CONTROLLER_PARAMETER.at(
                    file,
                    value.line,
                    f"{name}.{key}",
                    message=f"{who} has no parameter `{key}`: it is ignored.",
                    hint=did_you_mean(meant),
                    severity=Severity.WARNING,
                )


def _flat(value: yamlfile.Value, prefix: str = "") -> Iterator[tuple[str, yamlfile.Value]]:
    for key, inner in value.items():
        if isinstance(inner.content, dict):
            yield from _flat(inner, f"{prefix}{key}.")
        else:
            yield prefix + key, inner


_PYTHON = {"double": float, "integer": int, "boolean": bool, "text": str}


def _how_to_write(key: str, value: yamlfile.Value, type_: str) -> str | None:
    """What to write where a value has another type; None where it is right, or not known."""
    content, elements = value.content, value.elements()
    if content is None or (isinstance(content, str) and ("$(" in content or "<" in content)):
        return None  # a substitution of the launch file
    if type_.startswith("list"):
        written = ", ".join(f"{one.content}" for one in elements) or f"{content}"
        if not isinstance(content, list):
            return f"Write a list: {key}: [{written}]"
        is_whole = bool(elements) and all(type(one.content) is int for one in elements)
        if type_ == "list of doubles" and is_whole:
            return f"Write decimal points: [{written.replace(',', '.0,')}.0]"
        return None
    if type(content) is _PYTHON[type_]:
        return None
    right = {
        list: f"{elements[0].content}" if elements else "...",
        int: f"{content}.0" if type_ == "double" else f"'{content}'",
        str: _as_number(f"{content}", type_),
    }.get(type(content), "true or false" if type_ == "boolean" else f"a {type_}")
    return f"Write {key}: {right}"


def _as_number(text: str, type_: str) -> str:
    """What to write for a number in quotes."""
    return f"{text}.0" if type_ == "double" and text.lstrip("+-").isdigit() else text


def _shown(value: yamlfile.Value) -> str:
    content = value.content
    if isinstance(content, bool):
        return str(content).lower()
    if isinstance(content, list):
        return "a list"
    return f"the text '{content}'" if isinstance(content, str) else f"{content}"
