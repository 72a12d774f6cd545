"""Rules about the parameters of controllers, compared with the robot that they control.

The parameters of a check are facts; a check yields what it reports. What a controller claims is in
the parameter files of ros2_controllers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.controllers import invalid_parameters
from wsgen.diagnostics import Rule, Severity
from wsgen.text.suggestions import did_you_mean, nearest, some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.launching.known_packages import PlaceInPackage
    from wsgen.model.robot import ControlSystem, Joint, Plugin
    from wsgen.text import yamlfile


MANAGER = "controller_manager"
MOST_LEVELS = 8  # of namespaces
MISSPELLED = 0.8  # so alike two names are, as difflib counts
NAME = lazy_pattern(r"[\w.-]+")  # of a joint; not of an interface of another controller


class Claim(NamedTuple):
    """What a type of controllers takes of the joints that one of its parameters names."""

    parameter: str
    command: str | None = None  # an interface; None: what `interfaces` lists, or none
    interfaces: str = ""  # the parameter that lists them
    states: str = ""  # likewise, of state interfaces


WHEELS = (Claim("left_wheel_names", "velocity"), Claim("right_wheel_names", "velocity"))
CLAIMS: dict[str, tuple[Claim, ...]] = {
    "joint_trajectory_controller/JointTrajectoryController": (
        Claim("joints", interfaces="command_interfaces", states="state_interfaces"),
    ),
    "forward_command_controller/ForwardCommandController": (
        Claim("joints", interfaces="interface_name"),
    ),
    "position_controllers/JointGroupPositionController": (Claim("joints", "position"),),
    "velocity_controllers/JointGroupVelocityController": (Claim("joints", "velocity"),),
    "effort_controllers/JointGroupEffortController": (Claim("joints", "effort"),),
    "position_controllers/GripperActionController": (Claim("joint", "position"),),
    "effort_controllers/GripperActionController": (Claim("joint", "effort"),),
    "parallel_gripper_action_controller/GripperActionController": (Claim("joint", "position"),),
    "diff_drive_controller/DiffDriveController": WHEELS,
    "tricycle_controller/TricycleController": (
        Claim("traction_joint_name", "velocity"),
        Claim("steering_joint_name", "position"),
    ),
    "joint_state_broadcaster/JointStateBroadcaster": (Claim("joints"),),
}
# Without these the controller cannot be configured.
NEEDED = {
    "joint_trajectory_controller/JointTrajectoryController": ("joints", "command_joints"),
    "forward_command_controller/ForwardCommandController": ("joints",),
    "position_controllers/JointGroupPositionController": ("joints",),
    "velocity_controllers/JointGroupVelocityController": ("joints",),
    "effort_controllers/JointGroupEffortController": ("joints",),
    "diff_drive_controller/DiffDriveController": ("left_wheel_names",),
}


class Controlled(NamedTuple):
    """A robot, as far as controllers see it."""

    joints: Sequence[Joint]
    controls: Sequence[ControlSystem]
    started: Collection[str]  # names of the controllers that a launch file starts
    # Those of them that only launch files start which have an argument that is empty by default: it
    # may be what gives the robot a gripper.
    of_parts: Collection[str] = ()


MISSING_CONTROLLER_FILE = Rule(
    code="ROB110",
    name="missing-controller-file",
    severity=Severity.ERROR,
    summary="Gazebo's plugin for ros2_control names a parameter file that does not exist.",
    what="Looks up the path in `<parameters>` in the installed packages.",
    why="The controller manager does not start: Gazebo's plugin cannot read its parameters, and "
    "spawners wait forever.",
    example="<parameters>$(find my_robot)/config/controler.yaml</parameters>",
    instead="<parameters>$(find my_robot)/config/controllers.yaml</parameters>",
)


def missing_controller_file(
    plugin: Plugin,
    path: Path,
    beside: Collection[str],
    file: Path | None,
    place: PlaceInPackage | None = None,
) -> Diagnostic:
    """Report a file of parameters that is not there.

    `beside` are the names in its folder; `place` is where a package has it.
    """
    near = nearest(path.name, beside)
    return MISSING_CONTROLLER_FILE.at(
        file,
        plugin.line,
        f"gazebo/plugin[@filename='{plugin.filename}']/parameters",
        message=f"The parameter file `{path}` does not exist.",
        hint=did_you_mean(near)
        if near
        else f"Write $(find {place.package})/{place.inside}, and have the launch file expand the "
        "description with xacro, which replaces it with the installed path."
        if place
        else f"Create it if it is missing, and install its folder `{path.parent.name}` in "
        "CMakeLists.txt or setup.py.",
    )


UNKNOWN_CONTROLLER_JOINT = Rule(
    code="ROB111",
    name="unknown-controller-joint",
    severity=Severity.ERROR,
    severity_varies="a warning about a controller that no launch file of the package starts",
    summary="The parameters of a controller name a joint that the robot does not have.",
    what="Reads the file that Gazebo's plugin for ros2_control names in `<parameters>`. "
    "Controllers whose joints are all missing are not reported where the launch file has an "
    "argument that is empty by default, such as one for a gripper.",
    why="The controller cannot claim the interfaces of the joint and does not start.",
    example="""
diff_drive_controller:
  ros__parameters:
    left_wheel_names: [wheel_left_joint]  # the robot has left_wheel_joint
""",
    instead="""
diff_drive_controller:
  ros__parameters:
    left_wheel_names: [left_wheel_joint]
""",
)

UNAVAILABLE_INTERFACE = Rule(
    code="ROB112",
    name="unavailable-interface",
    severity=Severity.ERROR,
    severity_varies="a warning about a controller that no launch file of the package starts",
    summary="A controller claims an interface that `<ros2_control>` does not have.",
    what="Compares the joints and interfaces of the controllers of ros2_controllers with the "
    "`<joint>` elements of `<ros2_control>`.",
    why="The controller manager refuses to activate the controller.",
    example="""
<joint name="left_wheel_joint"><command_interface name="position"/></joint>
# and a diff_drive_controller, which commands velocities
""",
    instead="""
<joint name="left_wheel_joint"><command_interface name="velocity"/></joint>
# and a diff_drive_controller, which commands velocities
""",
)

CONTROLLER_WITHOUT_PARAMETERS = Rule(
    code="ROB113",
    name="controller-without-parameters",
    severity=Severity.WARNING,
    severity_varies="an error where the parameters of a controller that a launch file starts have "
    "another name",
    summary="A controller has a type but lacks required parameters.",
    what="Looks for controllers whose type needs joints, where the parameter file that sets the "
    "type does not set the joints.",
    why="The controller cannot be configured: the spawner exits with an error.",
    example="""
controller_manager:
  ros__parameters:
    arm_controller:
      type: joint_trajectory_controller/JointTrajectoryController
""",
    instead="""
controller_manager:
  ros__parameters:
    arm_controller:
      type: joint_trajectory_controller/JointTrajectoryController
arm_controller:
  ros__parameters:
    joints: [shoulder, elbow]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
""",
)


def check_controllers(
    content: yamlfile.Value, robot: Controlled, file: Path
) -> Iterator[Diagnostic]:
    """Check a file of parameters against the robot of which Gazebo's plugin reads it."""
    sections = list(_sections(content))
    types = dict(_types(sections))
    for full, values in sections:
        if full.rpartition("/")[2] == MANAGER:
            yield from invalid_parameters(MANAGER, "", values, file, None)
    for name, (kind, line) in types.items():
        own = [values for full, values in sections if full.rpartition("/")[2] == name]
        needed = NEEDED.get(kind, ())
        if needed and not any(values.get(key) for values in own for key in needed):
            is_started = name in robot.started
            yield _without_parameters(
                name, kind, line, sections, types, file, is_started=is_started
            )
        severity = None if name in robot.started else Severity.WARNING
        for values in own:
            yield from invalid_parameters(name, kind, values, file, severity)
        for values in own:
            if severity is not None and not _names_any(values, robot):
                continue  # of another robot
            if name in robot.of_parts and not _names_nearly_any(values, robot):
                continue  # of a part that an argument adds
            for claim in CLAIMS.get(kind, ()):
                yield from _claimed(name, claim, values, robot, file, severity)


def drive_sections(content: yamlfile.Value) -> Iterator[tuple[str, yamlfile.Value]]:
    """The names and parameters of the diff_drive_controllers of a file."""
    sections = list(_sections(content))
    types = dict(_types(sections))
    for full, values in sections:
        name = full.rpartition("/")[2]
        if types.get(name, ("",))[0] == "diff_drive_controller/DiffDriveController":
            yield name, values


def _without_parameters(  # noqa: PLR0913, PLR0917  a controller, and what is beside it
    name: str,
    kind: str,
    line: int,
    sections: Sequence[tuple[str, yamlfile.Value]],
    types: Collection[str],
    file: Path,
    *,
    is_started: bool,
) -> Diagnostic:
    """Report a controller without parameters: where they stand if they have another name."""
    needed = NEEDED[kind]
    other = next(
        (
            (full.rpartition("/")[2], values)
            for full, values in sections
            if full.rpartition("/")[2] not in {*types, MANAGER, "*", "**"}
            and any(values.get(key) for key in needed)
        ),
        None,
    )
    message = f"The controller `{name}` of type `{kind}` lacks the parameter `{needed[0]}`"
    hint = f"Add `{name}: ros__parameters: {needed[0]}:` with the names of its joints."
    if other is not None:
        message += f"; `{other[0]}`, which is not a controller, has it"
        hint = (
            f"Rename `{other[0]}:` to `{name}:`, or set the type for `{other[0]}` in line {line}."
        )
        line = other[1].line - 2  # above `ros__parameters:`
    return CONTROLLER_WITHOUT_PARAMETERS.at(
        file,
        line,
        name,
        message=f"{message}.",
        hint=hint,
        severity=Severity.ERROR if is_started and other is not None else None,
    )


def _names_any(values: yamlfile.Value, robot: Controlled) -> bool:
    """Whether any parameter names a joint of the robot."""
    names = {joint.name for joint in robot.joints}
    return any(one.text in names for _, value in values.items() for one in _listed(value))


def _names_nearly_any(values: yamlfile.Value, robot: Controlled) -> bool:
    """The same, also of a misspelled one."""
    names = {joint.name for joint in robot.joints}
    return any(
        one.text in names or nearest(one.text, names, cutoff=MISSPELLED)
        for _, value in values.items()
        for one in _listed(value)
        if one.text
    )


def _claimed(  # noqa: PLR0913, PLR0917  a controller, and what it is compared with
    name: str,
    claim: Claim,
    values: yamlfile.Value,
    robot: Controlled,
    file: Path,
    severity: Severity | None,
) -> Iterator[Diagnostic]:
    names = list(dict.fromkeys(joint.name for joint in robot.joints))
    place = f"{name}.{claim.parameter}"
    found: list[yamlfile.Value] = []
    for value in _listed(values.get(claim.parameter)):
        if value.text in names:
            found.append(value)
        elif value.text and NAME.fullmatch(value.text):
            near = nearest(value.text, names)
            yield UNKNOWN_CONTROLLER_JOINT.at(
                file,
                value.line,
                place,
                message=f"The controller `{name}` names the joint `{value.text}`, which the robot "
                "does not have.",
                hint=did_you_mean(near) if near else f"Name one of the joints: {some_of(names)}.",
                severity=severity,
            )
    commands = [claim.command] if claim.command else _words(values.get(claim.interfaces))
    if values.get("command_joints") is not None:
        commands = []
    states = _words(values.get(claim.states))
    for kind, wanted in (("command", commands), ("state", states)):
        for interface in wanted:
            lacking = [one for one in found if _lacks(robot, one.text or "", kind, interface)]
            if not lacking:
                continue
            joints = [f"`{one.text}`" for one in lacking]
            yield UNAVAILABLE_INTERFACE.at(
                file,
                lacking[0].line,
                place,
                message=f"The controller `{name}` claims the {kind} interface `{interface}` of "
                f"{some_of(joints)}, which <ros2_control> does not have.",
                hint=f'Add <{kind}_interface name="{interface}"/> to '
                f'<joint name="{lacking[0].text}"> in <ros2_control>, or correct the parameters of '
                "the controller.",
                severity=severity,
            )


def _lacks(robot: Controlled, joint: str, kind: str, interface: str) -> bool:
    """Whether no hardware has the interface; not where it is misspelled, which is reported."""
    parts = [part for one in robot.controls for part in one.joints]
    known = {one.name for one in robot.joints}
    others = {part.name for part in parts} - known
    own = [part for part in parts if part.name == joint]
    if not robot.controls or (not own and nearest(joint, others)):
        return False
    there = [one for part in own for one in (part.commands if kind == "command" else part.states)]
    return interface not in there and not nearest(interface, there, cutoff=MISSPELLED)


def _listed(value: yamlfile.Value | None) -> tuple[yamlfile.Value, ...]:
    return () if value is None else value.elements() or (value,)


def _words(value: yamlfile.Value | None) -> list[str]:
    return [one.text for one in _listed(value) if one.text]


def _sections(
    value: yamlfile.Value, name: str = "", level: int = 0
) -> Iterator[tuple[str, yamlfile.Value]]:
    """The parameters of nodes, by their full names."""
    for key, inner in value.items():
        if key in {"ros__parameters", "ros_parameters"}:  # a misspelled one is reported
            yield name, inner
        elif level < MOST_LEVELS:
            yield from _sections(inner, f"{name}/{key.strip('/')}", level + 1)


def _types(
    sections: Sequence[tuple[str, yamlfile.Value]],
) -> Iterator[tuple[str, tuple[str, int]]]:
    for full, values in sections:
        if full.rpartition("/")[2] == MANAGER:
            for name, value in values.items():
                kind = value.get("type")
                if kind is not None and kind.text:
                    yield name, (kind.text, kind.line)
