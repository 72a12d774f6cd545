"""The rules about the controllers of ros2_control that a launch file starts, and their parameters.

Source of the parameters: ros-controls/ros2_controllers, the `*_parameter*.yaml` of each
controller, Humble to master.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.commands import started_programs
from wsgen.launching.explain_missing import EXECUTABLE_NOT_FOUND
from wsgen.launching.spawner_options import CONTROLLER_SPAWNERS, OF_CONTROLLER, OF_SPAWNER
from wsgen.text.suggestions import advice, did_you_mean, nearest
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.text import yamlfile
    from wsgen.text.xmltree import Element


UNKNOWN_CONTROLLER = Rule(
    code="LCH078",
    name="unknown-controller",
    severity=Severity.ERROR,
    summary="A launch file starts a controller that is not configured.",
    what="Compares the arguments of `spawner`, and of `ros2 control load_controller`, with the "
    "controllers that have a `type` in the parameters of the controller manager. Not checked where "
    "some of these parameters are unknown, or the spawner has its own.",
    why="The controller manager does not know the type of the controller: the spawner exits with "
    "an error, and the controller does not start.",
    example="# controllers.yaml: controller_manager: ros__parameters: diff_cont: type: ...\n"
    "Node(package='controller_manager', executable='spawner', arguments=['diff_controller'])",
    instead="Node(package='controller_manager', executable='spawner', arguments=['diff_cont'])",
)
UNKNOWN_CONTROLLER_TYPE = Rule(
    code="LCH079",
    name="unknown-controller-type",
    severity=Severity.WARNING,
    severity_varies="an error about a controller that a launch file of the package starts",
    summary="A controller has a type that `ros2_controllers` does not have.",
    what="Looks in the parameters of controller managers for types of older releases, and for "
    "misspelled types of `ros2_controllers`. Other types are assumed to be user-defined.",
    why="The controller manager does not find the class, and does not load the controller.",
    example="joint_state_controller:\n  type: joint_state_controller/JointStateController",
    instead="joint_state_broadcaster:\n  type: joint_state_broadcaster/JointStateBroadcaster",
)

# Package -> its controllers, in ros2_controllers from Humble on.
_TYPES = """
ackermann_steering_controller/AckermannSteeringController
admittance_controller/AdmittanceController
battery_state_broadcaster/BatteryStateBroadcaster
bicycle_steering_controller/BicycleSteeringController
chained_filter_controller/ChainedFilter
diff_drive_controller/DiffDriveController
effort_controllers/JointGroupEffortController
effort_controllers/GripperActionController
force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster
forward_command_controller/ForwardCommandController
forward_command_controller/MultiInterfaceForwardCommandController
gpio_controllers/GpioCommandController
gps_sensor_broadcaster/GPSSensorBroadcaster
imu_sensor_broadcaster/IMUSensorBroadcaster
joint_state_broadcaster/JointStateBroadcaster
joint_trajectory_controller/JointTrajectoryController
mecanum_drive_controller/MecanumDriveController
omni_wheel_drive_controller/OmniWheelDriveController
parallel_gripper_action_controller/GripperActionController
pid_controller/PidController
pose_broadcaster/PoseBroadcaster
position_controllers/JointGroupPositionController
position_controllers/GripperActionController
range_sensor_broadcaster/RangeSensorBroadcaster
tricycle_controller/TricycleController
tricycle_steering_controller/TricycleSteeringController
velocity_controllers/JointGroupVelocityController
"""
_TRAJECTORIES = "joint_trajectory_controller/JointTrajectoryController"
# Types of ROS 1 and Foxy -> what does the same today.
FORMER_TYPES = {
    "joint_state_controller/JointStateController": "joint_state_broadcaster/JointStateBroadcaster",
    "effort_controllers/JointTrajectoryController": _TRAJECTORIES,
    "position_controllers/JointTrajectoryController": _TRAJECTORIES,
    "velocity_controllers/JointTrajectoryController": _TRAJECTORIES,
    "effort_controllers/JointEffortController": "effort_controllers/JointGroupEffortController",
    "effort_controllers/JointPositionController": "pid_controller/PidController",
    "effort_controllers/JointVelocityController": "pid_controller/PidController",
    "position_controllers/JointPositionController": "position_controllers/"
    "JointGroupPositionController",
    "velocity_controllers/JointVelocityController": "velocity_controllers/"
    "JointGroupVelocityController",
    "velocity_controllers/JointPositionController": "pid_controller/PidController",
}
SURELY_PACKAGE = 0.96  # as below, for two packages with a class of the same name
SURELY = 0.9  # so alike two types are, as difflib counts, that one is the other misspelled
MANAGER = "controller_manager"
# Of the spawner, and of `ros2 control load_controller`.
_OPTIONS = {**OF_SPAWNER, **OF_CONTROLLER, ("--set-state", "--spin-time"): None}
_OPTIONS |= {("-s", "--spin", "--use-sim-time"): False}
_WITH_VALUE = {name for names, one in _OPTIONS.items() if one is not False for name in names}
_FLAGS = {name for names, one in _OPTIONS.items() if one is False for name in names}
# With these a spawner says itself what the controller is.
_OWN = frozenset(("-p", "--param-file", "-t", "--controller-type", "--controller"))


class Configured(NamedTuple):
    """The controllers that controller managers know."""

    names: frozenset[str]
    are_all: bool  # if not, others may be known


def parameter_files(descriptions: Iterable[Element]) -> Iterator[Path]:
    """The files of parameters that the plugins of robots give to their controller managers."""
    for root in descriptions:
        for plugin in root.iter("plugin"):
            if "ros2_control" in (plugin.get("filename") or ""):
                for element in children(plugin, "parameters"):
                    yield Path((element.text or "").strip())


def managed_types(content: yamlfile.Value) -> Iterator[tuple[str, yamlfile.Value]]:
    """The names of controllers, and their types, in a file of parameters."""
    for name, section in node_sections(content, ""):
        if name.rpartition("/")[2] not in {MANAGER, "**", "*"}:
            continue
        for key, value in section.items():
            of_mapping = value.get("type")
            if of_mapping is not None and of_mapping.text:
                yield key, of_mapping
            elif key.endswith(".type") and value.text:
                yield key.removesuffix(".type"), value


def managed_controllers(
    content: yamlfile.Value,
) -> Iterator[tuple[str, str, yamlfile.Value | None]]:
    """The full names of controllers, their types, and their parameters, in a file."""
    sections = dict(node_sections(content, ""))
    for manager, section in sections.items():
        if manager.rpartition("/")[2] != MANAGER:
            continue
        for key, value in section.items():
            kind = value.get("type")
            if kind is not None and kind.text:
                name = f"{manager.rpartition('/')[0]}/{key}"
                yield name.removeprefix("/**"), kind.text, sections.get(name)


def node_sections(value: yamlfile.Value, name: str) -> Iterator[tuple[str, yamlfile.Value]]:
    """The parameters of nodes, by their full names."""
    for key, inner in value.items():
        if key == "ros__parameters":
            yield name, inner
        elif name.count("/") < _DEEPEST:
            yield from node_sections(inner, f"{name}/{key.strip('/')}")


_DEEPEST = 8  # namespaces


def find_configured(
    plan: LaunchPlan, files: Mapping[Path, yamlfile.Value | None]
) -> Configured | None:
    """The controllers that the managers of a plan know; None where it starts no manager.

    `files` are those of `parameter_files`, with what is in them if that can be read.
    """
    names = {name for content in files.values() if content for name, _ in managed_types(content)}
    nodes = [
        node
        for node in started_programs(plan)
        if node.package == MANAGER and node.executable == "ros2_control_node"
    ]
    for node in nodes:
        names.update(
            key.removesuffix(".type")
            for key in node.parameters
            if key.endswith(".type") and isinstance(node.parameters[key], str)
        )
    if not files and not nodes:
        return None
    # What files say for a node without a name is unknown: the program names itself.
    is_read = all(any(key.endswith(".type") for key in node.parameters) for node in nodes)
    return Configured(
        frozenset(names),
        are_all=not plan.unresolved and None not in files.values() and is_read,
    )


def unknown_controllers(plan: LaunchPlan, configured: Configured | None) -> Iterator[Diagnostic]:
    """Report controllers that are started and that no manager knows."""
    if configured is None or not configured.are_all or not plan.is_complete:
        return
    for program, name in _started(plan):
        if name not in configured.names and not plan.is_unknown(name):
            known = sorted(configured.names)
            yield UNKNOWN_CONTROLLER.at(
                program.file,
                program.line,
                name,
                message=f"The controller `{name}` is not configured: the parameters of the "
                "controller manager do not set its type.",
                hint=advice(
                    name,
                    known,
                    f"Add `{name}: {{type: ...}}` below `controller_manager: ros__parameters:`.",
                ),
            )


def started_controllers(plan: LaunchPlan) -> Iterator[str]:
    """The names of the controllers that a plan starts."""
    yield from (name for _, name in _started(plan))


def _started(plan: LaunchPlan) -> Iterator[tuple[Process, str]]:
    """The controllers that spawners and commands start, without those that bring their type."""
    for program in started_programs(plan):
        names: list[str] = []
        if program.package == MANAGER and program.executable in CONTROLLER_SPAWNERS:
            names = _names(program.arguments)
        elif program.executable == "ros2" and program.arguments[:2] in _LOADING:
            names = _names(program.arguments[2:])
            names = names if len(names) == 1 else []  # a file with the type may follow
        has_parameters = any(name.endswith("type") for name in program.parameters)
        for name in () if has_parameters else names:
            yield program, name


def former_spawners(plan: LaunchPlan, distro: str | None) -> Iterator[Diagnostic]:
    """Report spawner.py and unspawner.py, which no distribution since Humble has.

    Source: ros-controls/ros2_control, controller_manager/setup.cfg.
    """
    started = started_programs(plan)
    is_later = any(program.package == "ros_gz_sim" for program in started)  # Humble's name
    if distro in _FORMER_DISTROS if distro else not is_later:
        return
    for program in started:
        if program.package == MANAGER and program.executable in {"spawner.py", "unspawner.py"}:
            yield EXECUTABLE_NOT_FOUND.at(
                program.file,
                program.line,
                program.executable,
                message=f"The package 'controller_manager' has no executable "
                f"'{program.executable}' since Humble.",
                hint=did_you_mean(program.executable.removesuffix(".py")),
            )


_FORMER_DISTROS = frozenset(("dashing", "eloquent", "foxy", "galactic"))
_LOADING = {("control", "load_controller"), ("control", "load_start_controller")}


def _names(words: Sequence[str]) -> list[str]:
    """The controllers among the arguments; none where an argument is not known."""
    names: list[str] = []
    rest = list(words)
    while rest:
        word = rest.pop(0)
        option = word.partition("=")[0]
        if word == "--ros-args":
            break
        if option in _OWN or (word.startswith("-") and option not in _WITH_VALUE | _FLAGS):
            return []
        if not word.startswith("-"):
            names.append(word)
        elif option in _WITH_VALUE and option == word and rest:
            rest.pop(0)
    return names


def unknown_types(
    file: Path, content: yamlfile.Value, started: Collection[str]
) -> Iterator[Diagnostic]:
    """Report the controllers of a file of parameters that have a type which does not exist.

    `started` are those that launch files start.
    """
    known = _TYPES.split()
    for name, value in managed_types(content):
        written = value.text or ""
        meant = FORMER_TYPES.get(written)
        if meant is None and written not in known:
            package, _, name_of_class = written.partition("/")
            # Another package may well have a class of the same name.
            is_other = not any(one.startswith(f"{package}/") for one in known)
            alike = f"/{name_of_class}" if is_other else f"{package}/"
            near = [one for one in known if alike in one]
            meant = nearest(written, near, cutoff=SURELY_PACKAGE if is_other else SURELY)
        if meant is not None:
            yield UNKNOWN_CONTROLLER_TYPE.at(
                file,
                value.line,
                name,
                message=f"ros2_controllers does not have the controller type `{written}`.",
                hint=did_you_mean(meant),
                severity=Severity.ERROR if name in started else Severity.WARNING,
            )


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
_OF_TRAJECTORIES = {
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
    "joint_trajectory_controller/JointTrajectoryController": _OF_TRAJECTORIES,
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
SURELY_NAMED = 0.88  # so alike, as difflib counts, are a name and the one that it misspells


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
            meant = nearest(key, declared.keys() - given.keys(), cutoff=SURELY_NAMED)
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
