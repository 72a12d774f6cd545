"""Rules about `<ros2_control>` and `<transmission>` of a robot.

The parameters of a check are facts; a check yields what it reports. What ros2_control refuses is
in `component_parser.cpp` of hardware_interface, what Gazebo's plugins ignore in `gz_system.cpp` of
gz_ros2_control and `gazebo_system.cpp` of gazebo_ros2_control.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.systems import control_library
from wsgen.model.robot import JointType
from wsgen.model.target import CLASSIC, DISTROS_WITH_CLASSIC, SIM, SIMULATORS
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import (
        ControlledPart,
        ControlSystem,
        GazeboTag,
        Joint,
        Plugin,
        Transmission,
    )


KINDS = ("system", "actuator", "sensor")
# What Gazebo's hardware can command and measure of a joint.
OF_GAZEBO = ("position", "velocity", "effort")
INTERFACES = (*OF_GAZEBO, "acceleration")
PIDS = ("position_pid", "velocity_pid")  # commands of Gazebo Classic's
ALIKE = 0.7  # `positon`, `velocty`; not `torque`, which some hardware has
# Package -> the classes of hardware that it has.
HARDWARE = {
    "gz_ros2_control": ("GazeboSimSystem",),
    "ign_ros2_control": ("IgnitionSystem",),
    "gazebo_ros2_control": ("GazeboSystem",),
    "mock_components": ("GenericSystem",),
    "fake_components": ("GenericSystem",),
}
SIMULATOR_OF_PACKAGE = {
    "gz_ros2_control": SIM,
    "ign_ros2_control": SIM,
    "gazebo_ros2_control": CLASSIC,
}
USUAL = {CLASSIC: "gazebo_ros2_control/GazeboSystem", SIM: "gz_ros2_control/GazeboSimSystem"}
PLUGINS = {
    CLASSIC: '<plugin filename="libgazebo_ros2_control.so" name="gazebo_ros2_control">',
    SIM: '<plugin filename="gz_ros2_control-system" '
    'name="gz_ros2_control::GazeboSimROS2ControlPlugin">',
}
MOCKS = ("mock_components", "fake_components")
# Distributions whose ros2_control ignores what the later ones refuse.
LENIENT = ("humble", "iron")
# Those that still have the names of Ignition.
WITH_IGNITION = ("humble", "iron", "jazzy")


class ControlFacts(NamedTuple):
    """What the checks need to know of a robot and of what it is for."""

    controls: Sequence[ControlSystem]
    joints: Sequence[Joint]
    plugins: Sequence[Plugin]
    simulator: str | None = None  # "classic", "gz"
    distro: str | None = None


def driven_joints(controls: Iterable[ControlSystem], joints: Iterable[Joint]) -> set[str]:
    """The joints without an end whose speed is commanded: wheels."""
    endless = {joint.name for joint in joints if joint.type is JointType.CONTINUOUS}
    return endless & {
        part.name for system in controls for part in system.joints if "velocity" in part.commands
    }


def control_plugins(tags: Iterable[GazeboTag]) -> tuple[Plugin, ...]:
    """Gazebo's plugins for ros2_control."""
    return tuple(
        plugin
        for tag in tags
        for plugin in tag.plugins
        if "ros2_control" in plugin.filename or control_library(plugin.filename)
    )


def _simulator_of(plugin: Plugin) -> str:
    return CLASSIC if "gazebo_ros2_control" in plugin.filename else SIM


def check_control(facts: ControlFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Everything about `<ros2_control>`."""
    for system in facts.controls:
        yield from incomplete_control(system, file)
        yield from controlled_joints(system, facts, file)
        yield from unknown_interfaces(system, file)
        yield from unsuited_hardware(system, facts, file)
    yield from duplicate_systems(facts.controls, file)
    yield from control_without_plugin(facts, file)


UNKNOWN_CONTROLLED_JOINT = Rule(
    code="ROB087",
    name="unknown-controlled-joint",
    severity=Severity.ERROR,
    summary="`<ros2_control>` names a joint that the robot does not have.",
    why="From Jazzy on, the controller manager refuses the whole description. In earlier "
    "distributions Gazebo's plugin skips the joint, and every controller that claims it fails to "
    "start.",
    example="""
<joint name="arm_joint" type="revolute">…</joint>
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <joint name="arm_jiont"><command_interface name="position"/></joint>
</ros2_control>
""",
    instead="""
<joint name="arm_joint" type="revolute">…</joint>
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <joint name="arm_joint"><command_interface name="position"/></joint>
</ros2_control>
""",
)

CONTROLLED_FIXED_JOINT = Rule(
    code="ROB088",
    name="controlled-fixed-joint",
    severity=Severity.ERROR,
    severity_varies="a warning for Humble and Iron, and for hardware that is not Gazebo's where "
    "the distribution is not known",
    summary="`<ros2_control>` names a fixed joint.",
    why="A fixed joint takes no commands. From Jazzy on, the controller manager refuses the "
    "description. Gazebo removes the joint when it lumps links, and controllers that claim it fail "
    "to start.",
    example="""
<joint name="tool_joint" type="fixed">…</joint>
<ros2_control …>
  <joint name="tool_joint"><command_interface name="position"/></joint>
</ros2_control>
""",
    instead="""
<joint name="tool_joint" type="revolute">…</joint>
<ros2_control …>
  <joint name="tool_joint"><command_interface name="position"/></joint>
</ros2_control>
""",
)

COMMANDED_MIMIC_JOINT = Rule(
    code="ROB089",
    name="commanded-mimic-joint",
    severity=Severity.WARNING,
    severity_varies="an error for Jazzy and later",
    summary="`<ros2_control>` commands a joint that mimics another joint, or lacks that other "
    "joint.",
    what="Looks for joints with `<mimic>` in the URDF that have a `<command_interface>` without "
    '`mimic="false"`, or whose leader is not a joint of the same `<ros2_control>`. Not checked '
    "for Humble and Iron, where a parameter names the leader.",
    why="From Jazzy on, the controller manager refuses the description.",
    example="""
<joint name="right_finger" type="prismatic">… <mimic joint="left_finger"/></joint>
<ros2_control …>
  <joint name="left_finger"><command_interface name="position"/></joint>
  <joint name="right_finger"><command_interface name="position"/></joint>
</ros2_control>
""",
    instead="""
<joint name="right_finger" type="prismatic">… <mimic joint="left_finger"/></joint>
<ros2_control …>
  <joint name="left_finger"><command_interface name="position"/></joint>
  <joint name="right_finger"><state_interface name="position"/></joint>
</ros2_control>
""",
)


def controlled_joints(
    system: ControlSystem, facts: ControlFacts, file: Path | None
) -> Iterator[Diagnostic]:
    """Report joints of `<ros2_control>` that nothing can control."""
    named = {joint.name: joint for joint in facts.joints}
    for part in system.joints:
        if not part.name:
            continue
        place = _place(system, part)
        joint = named.get(part.name)
        if joint is None:
            near = nearest(part.name, named)
            yield UNKNOWN_CONTROLLED_JOINT.at(
                file,
                part.line,
                place,
                message=f"<ros2_control> names the joint `{part.name}`, which the robot does not "
                "have.",
                hint=did_you_mean(near) if near else "Name a joint of this robot.",
            )
        elif joint.type is JointType.FIXED:
            is_refused = facts.distro not in {None, *LENIENT} or (
                facts.distro is None and _package(system) in SIMULATOR_OF_PACKAGE
            )
            yield CONTROLLED_FIXED_JOINT.at(
                file,
                part.line,
                place,
                message=f"<ros2_control> names the joint `{part.name}`, which is fixed and cannot "
                "be controlled.",
                hint=f"Make `{part.name}` revolute, continuous or prismatic, or remove it from "
                "<ros2_control>.",
                severity=Severity.ERROR if is_refused else Severity.WARNING,
            )
        elif joint.mimic is not None and facts.distro not in LENIENT:
            yield from _follower(part, joint, system, facts, file)


def _follower(
    part: ControlledPart,
    joint: Joint,
    system: ControlSystem,
    facts: ControlFacts,
    file: Path | None,
) -> Iterator[Diagnostic]:
    leader = "" if joint.mimic is None else joint.mimic.joint
    if part.mimic.lower() == "false":
        return
    severity = Severity.WARNING if facts.distro is None else Severity.ERROR
    place = _place(system, part)
    if part.commands:
        yield COMMANDED_MIMIC_JOINT.at(
            file,
            part.line,
            place,
            message=f"<ros2_control> commands the joint `{part.name}`, which mimics `{leader}`.",
            hint='Remove its <command_interface>, or write mimic="false" in this <joint>.',
            severity=severity,
        )
    elif leader not in {other.name for other in system.joints}:
        yield COMMANDED_MIMIC_JOINT.at(
            file,
            part.line,
            place,
            message=f"The joint `{part.name}` of <ros2_control> mimics `{leader}`, which is not in "
            "the same <ros2_control>.",
            hint=f'Add <joint name="{leader}"> to this <ros2_control>.',
            severity=severity,
        )


INCOMPLETE_CONTROL = Rule(
    code="ROB090",
    name="incomplete-ros2-control",
    severity=Severity.ERROR,
    severity_varies="a warning where only the hardware is missing, which another value of a xacro "
    "argument may add",
    summary="`<ros2_control>` lacks a name, a type or a hardware plugin, or has unknown elements.",
    why="The controller manager refuses the description, and no controller starts.",
    example="""
<ros2_control name="arm">
  <joint name="arm_joint"><command_interface name="position"/></joint>
</ros2_control>
""",
    instead="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <joint name="arm_joint"><command_interface name="position"/></joint>
</ros2_control>
""",
)


def incomplete_control(system: ControlSystem, file: Path | None) -> Iterator[Diagnostic]:
    """Report what ros2_control cannot parse."""
    what = f"`{system.name}`" if system.name else "of the robot"
    place = f"ros2_control[@name='{system.name}']"
    for message, hint in _lacking(system, what):
        yield INCOMPLETE_CONTROL.at(file, system.line, place, message=message, hint=hint)
    if not system.hardware:
        yield INCOMPLETE_CONTROL.at(
            file,
            system.line,
            place,
            message=f"<ros2_control> {what} has no hardware plugin: no controller starts.",
            hint=f"Add <hardware><plugin>{USUAL[SIM]}</plugin></hardware> (Gazebo Sim) or "
            f"{USUAL[CLASSIC]} (Gazebo Classic).",
            severity=Severity.WARNING,
        )
    for part in system.parts:
        names = (part.name, *part.commands, *part.states)
        if all(name.strip() for name in names):
            continue
        tag = part.kind if not part.name.strip() else "interface"
        yield INCOMPLETE_CONTROL.at(
            file,
            part.line,
            _place(system, part) if part.name else place,
            message=f"A {tag} of <ros2_control> {what} has no name.",
            hint='Write <joint name="JOINT">.'
            if tag == "joint"
            else 'Write the attribute name="NAME".',
        )


DUPLICATE_CONTROL = Rule(
    code="ROB133",
    name="duplicate-ros2-control",
    severity=Severity.ERROR,
    summary="Two `<ros2_control>` elements have the same name.",
    why="The controller manager identifies hardware by its name: it refuses the second one or "
    "never activates it, and its joints do not move. Usually a xacro macro is called twice.",
    example="""
<ros2_control name="arm" type="system">
  …<joint name="arm_joint">…</joint>
</ros2_control>
<ros2_control name="arm" type="system">
  …<joint name="gripper_joint">…</joint>
</ros2_control>
""",
    instead="""
<ros2_control name="arm" type="system">
  …<joint name="arm_joint">…</joint>
</ros2_control>
<ros2_control name="gripper" type="system">
  …<joint name="gripper_joint">…</joint>
</ros2_control>
""",
)


def duplicate_systems(systems: Iterable[ControlSystem], file: Path | None) -> Iterator[Diagnostic]:
    """Report hardware with the name of other hardware."""
    first: dict[str, ControlSystem] = {}
    for system in systems:
        other = first.setdefault(system.name, system)
        if other is system or not system.name:
            continue
        where = f" in line {other.line}" if other.line else ""
        yield DUPLICATE_CONTROL.at(
            file,
            system.line,
            f"ros2_control[@name='{system.name}']",
            message=f"Another <ros2_control>{where} also has the name `{system.name}`: the "
            "hardware of one of them is not used.",
            hint="Give each a different name; in a macro, add a prefix: "
            'name="${prefix}' + system.name + '".',
        )


def _lacking(system: ControlSystem, what: str) -> Iterator[tuple[str, str]]:
    if not system.name:
        yield "<ros2_control> has no name.", 'Write <ros2_control name="NAME" type="system">.'
    if system.kind not in KINDS:
        near = nearest(system.kind, KINDS) if system.kind else "system"
        name = f' name="{system.name}"' if system.name else ""
        yield (
            f"<ros2_control> {what} has "
            + (f"the unknown type `{system.kind}`." if system.kind else "no type."),
            f'Write <ros2_control{name} type="{near or "system"}">.',
        )
    for other in dict.fromkeys(system.others):
        near = nearest(other, ("joint", "sensor", "gpio", "hardware", "transmission"))
        message = (
            f"<{other}> is not an element of <ros2_control>: the controller manager refuses "
            "the description."
        )
        yield message, f"Write <{near}>." if near else f"Remove <{other}> from <ros2_control>."


UNKNOWN_INTERFACE = Rule(
    code="ROB091",
    name="unknown-interface",
    severity=Severity.WARNING,
    summary="A joint interface in `<ros2_control>` is misspelled, or Gazebo does not support it.",
    what="For Gazebo's hardware, allows `position`, `velocity` and `effort`; for other hardware, "
    "reports misspellings of these names.",
    why="Gazebo ignores the interface; a controller that claims it fails to start.",
    example='<joint name="arm_joint"><command_interface name="positon"/></joint>',
    instead='<joint name="arm_joint"><command_interface name="position"/></joint>',
)


def unknown_interfaces(system: ControlSystem, file: Path | None) -> Iterator[Diagnostic]:
    """Report interfaces that the hardware does not offer."""
    is_gazebo = _package(system) in SIMULATOR_OF_PACKAGE
    known = (*OF_GAZEBO, *PIDS) if is_gazebo else INTERFACES
    for part in system.joints:
        for tag, names in (("command", part.commands), ("state", part.states)):
            for name in filter(str.strip, names):
                if name in known:
                    continue
                near = nearest(name, INTERFACES, cutoff=ALIKE)
                if near is None and not is_gazebo:
                    continue
                yield UNKNOWN_INTERFACE.at(
                    file,
                    part.line,
                    _place(system, part),
                    message=f"The joint `{part.name}` has the {tag} interface `{name}`, which "
                    + ("Gazebo ignores." if is_gazebo else "looks misspelled."),
                    hint=f'Write <{tag}_interface name="{near}"/>.'
                    if near in OF_GAZEBO
                    else f"Use {', '.join(OF_GAZEBO[:2])} or {OF_GAZEBO[2]}.",
                )


UNKNOWN_HARDWARE = Rule(
    code="ROB092",
    name="unknown-hardware",
    severity=Severity.ERROR,
    summary="`<hardware>` names a class that its package does not have.",
    what="Compares the class with those of gz_ros2_control, ign_ros2_control, gazebo_ros2_control "
    "and the mock components.",
    why="The class cannot be loaded, and no controller starts.",
    example="<plugin>gz_ros2_control/GazeboSystem</plugin>",
    instead="<plugin>gz_ros2_control/GazeboSimSystem</plugin>",
)

UNSUITED_HARDWARE = Rule(
    code="ROB093",
    name="unsuited-hardware",
    severity=Severity.ERROR,
    severity_varies="a warning about mock hardware",
    summary="The hardware of `<ros2_control>` does not belong to the simulator of the robot.",
    what="Compares the class in `<hardware>` with the `<gazebo>` plugin for ros2_control, with the "
    "simulator that the launch file starts, and with the ROS 2 distribution.",
    why="Gazebo's plugin loads only hardware for the same simulator: it logs an error, and "
    "controllers find no interfaces.",
    example="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>
</ros2_control>
<gazebo>
  <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
    <parameters>$(find my_robot)/config/controllers.yaml</parameters>
  </plugin>
</gazebo>
""",
    instead="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
</ros2_control>
<gazebo>
  <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
    <parameters>$(find my_robot)/config/controllers.yaml</parameters>
  </plugin>
</gazebo>
""",
)


def unsuited_hardware(
    system: ControlSystem, facts: ControlFacts, file: Path | None
) -> Iterator[Diagnostic]:
    """Report hardware that does not exist, or that the simulator cannot load."""
    package, _, name = (system.hardware or "").partition("/")
    place = f"ros2_control[@name='{system.name}']/hardware/plugin"
    if package not in HARDWARE:
        return
    if name not in HARDWARE[package]:
        right = f"{package}/{HARDWARE[package][0]}"
        yield UNKNOWN_HARDWARE.at(
            file,
            system.hardware_line or system.line,
            place,
            message=f"The package {package} has no hardware `{system.hardware}`.",
            hint=f"Write <plugin>{right}</plugin>.",
        )
        return
    there = {_simulator_of(plugin) for plugin in facts.plugins}
    meant = SIMULATOR_OF_PACKAGE.get(package)
    wanted = facts.simulator or next(iter(there), None)
    if wanted == CLASSIC and facts.distro not in {None, *DISTROS_WITH_CLASSIC}:
        wanted = SIM  # the plugin is reported
    if meant is None:
        if there and package in MOCKS:
            yield UNSUITED_HARDWARE.at(
                file,
                system.hardware_line or system.line,
                place,
                message=f"<ros2_control> `{system.name}` has mock hardware, which Gazebo's plugin "
                "cannot load: the robot does not move in Gazebo.",
                hint=f"Write <plugin>{USUAL[wanted or SIM]}</plugin> for the simulation.",
                severity=Severity.WARNING,
            )
    elif wanted is not None and meant != wanted and (meant not in there or facts.simulator):
        yield UNSUITED_HARDWARE.at(
            file,
            system.hardware_line or system.line,
            place,
            message=f"The hardware `{system.hardware}` is for {SIMULATORS[meant]}, but "
            + (
                f"{SIMULATORS[wanted]} simulates the robot."
                if facts.simulator
                else f"the robot loads the ros2_control plugin of {SIMULATORS[wanted]}."
            ),
            hint=f"Write <plugin>{USUAL[wanted]}</plugin>.",
        )
    elif package == "ign_ros2_control" and facts.distro not in {None, *WITH_IGNITION}:
        yield UNSUITED_HARDWARE.at(
            file,
            system.hardware_line or system.line,
            place,
            message=f"ROS 2 {str(facts.distro).capitalize()} does not have the hardware "
            f"`{system.hardware}`.",
            hint=f"Write <plugin>{USUAL[SIM]}</plugin>.",
        )


CONTROL_WITHOUT_PLUGIN = Rule(
    code="ROB094",
    name="control-without-plugin",
    severity=Severity.WARNING,
    severity_varies="an error where the launch file starts controllers",
    summary="A robot has Gazebo hardware without its plugin, or the plugin without hardware.",
    why="Gazebo's plugin for ros2_control starts the controller manager and loads the hardware of "
    "`<ros2_control>`. One without the other does nothing: spawners wait forever for a controller "
    "manager.",
    example="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
</ros2_control>
""",
    instead="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
</ros2_control>
<gazebo>
  <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
    <parameters>$(find my_robot)/config/controllers.yaml</parameters>
  </plugin>
</gazebo>
""",
)


def control_without_plugin(facts: ControlFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Report `<ros2_control>` for Gazebo without its plugin, and the plugin without it."""
    of_gazebo = [system for system in facts.controls if _package(system) in SIMULATOR_OF_PACKAGE]
    if of_gazebo and not facts.plugins:
        system = of_gazebo[0]
        simulator = SIMULATOR_OF_PACKAGE[_package(system)]
        yield CONTROL_WITHOUT_PLUGIN.at(
            file,
            system.line,
            f"ros2_control[@name='{system.name}']",
            message=f"<ros2_control> `{system.name}` has hardware for {SIMULATORS[simulator]}, but "
            "no <gazebo> element loads its plugin: no controller manager starts.",
            hint=f"Add <gazebo>{PLUGINS[simulator]}…</plugin></gazebo>.",
        )
    elif facts.plugins and not facts.controls:
        plugin = facts.plugins[0]
        yield CONTROL_WITHOUT_PLUGIN.at(
            file,
            plugin.line,
            f"gazebo/plugin[@filename='{plugin.filename}']",
            message=f"The robot has the plugin `{plugin.filename}`, but no <ros2_control>: the "
            "plugin has no joints to control.",
            hint='Add <ros2_control name="NAME" type="system"> with '
            f"<hardware><plugin>{USUAL[_simulator_of(plugin)]}</plugin></hardware> and the joints.",
        )


UNKNOWN_TRANSMISSION_JOINT = Rule(
    code="ROB095",
    name="unknown-transmission-joint",
    severity=Severity.WARNING,
    summary="A `<transmission>` names a joint that the robot does not have.",
    why="The transmission has no effect. Usually the name is misspelled or lacks a prefix.",
    example='<transmission name="t"><joint name="arm_jiont"/></transmission>',
    instead='<transmission name="t"><joint name="arm_joint"/></transmission>',
)

ROS_1_TRANSMISSION = Rule(
    code="ROB096",
    name="ros-1-transmission",
    severity=Severity.INFO,
    summary="A robot has `<transmission>` elements, which ROS 2 does not read.",
    what="Looks for `<transmission>` in robots without `<ros2_control>`.",
    why="In ROS 1 `<transmission>` declares the controlled joints, in ROS 2 `<ros2_control>` does: "
    "the robot has no controlled joint.",
    example="""
<transmission name="arm_transmission">
  <type>transmission_interface/SimpleTransmission</type>
  <joint name="arm_joint"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
  <actuator name="arm_motor"/>
</transmission>
""",
    instead="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <joint name="arm_joint"><command_interface name="effort"/></joint>
</ros2_control>
""",
)


def transmissions(
    found: Sequence[Transmission],
    joints: Iterable[Joint],
    controls: Sequence[ControlSystem],
    file: Path | None,
) -> Iterator[Diagnostic]:
    """Report transmissions of unknown joints, and that ROS 2 does not read them."""
    names = [joint.name for joint in joints]
    for transmission in found:
        for joint in transmission.joints:
            if joint and joint not in names:
                near = nearest(joint, names)
                yield UNKNOWN_TRANSMISSION_JOINT.at(
                    file,
                    transmission.line,
                    f"transmission[@name='{transmission.name}']/joint",
                    message=f"The transmission `{transmission.name}` names the joint `{joint}`, "
                    "which the robot does not have.",
                    hint=did_you_mean(near) if near else "Name a joint of this robot.",
                )
    if found and not controls:
        first = found[0]
        yield ROS_1_TRANSMISSION.at(
            file,
            first.line,
            f"transmission[@name='{first.name}']",
            message="ROS 2 does not read <transmission>: the robot has no controlled joint.",
            hint="List the controlled joints in <ros2_control>, or remove <transmission>.",
        )


def _package(system: ControlSystem) -> str:
    return (system.hardware or "").partition("/")[0]


def _place(system: ControlSystem, part: ControlledPart) -> str:
    return f"ros2_control[@name='{system.name}']/{part.kind}[@name='{part.name}']"
