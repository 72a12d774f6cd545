"""Rules about the plugins and sensors in the `<gazebo>` elements of a robot.

The parameters of a check are facts; a check yields what it reports. What is known about plugins is
in `wsgen.gazebo.plugins`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.gazebo.plugins import OF_CLASSIC, PLUGINS, GazeboPlugin, simulator_of, stem
from wsgen.gazebo.sensors import FRAME_NAMES, RAYS, WITH_FRAMES, WITH_RAYS
from wsgen.gazebo.successors import FROM_ROS_1, OF_THE_OTHER, SUCCESSORS, is_served, predecessor
from wsgen.gazebo.systems import remark_on
from wsgen.model.facts import WITHOUT_CLASSIC
from wsgen.model.robot import JointType
from wsgen.model.target import CLASSIC, SIM, SIMULATORS
from wsgen.text.suggestions import did_you_mean, nearest, some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Joint, Plugin, Sensor


# So alike a name must be to one of Gazebo's: other plugins have names of the same form.
ALIKE = 0.88
MOST_LETTERS = 2  # more or fewer
LIKE_PARAMETER = 0.8
CAPITAL = lazy_pattern(r"(?<=[a-z0-9])([A-Z])")
# In what a frame may be named beside the links: what localization and the simulation bring.
OTHER_FRAMES = frozenset(("world", "map", "odom"))
FRAMES_OF_PLUGIN = ("frame_name", "frame_id")


class PluginFacts(NamedTuple):
    """What the checks need to know of a robot and of what it is for."""

    tags: Sequence[GazeboTag]
    joints: Sequence[Joint]
    links: Collection[str]  # names of the links and of the frames that Gazebo adds
    simulator: str | None = None  # "classic", "gz"
    distro: str | None = None
    preserved: Collection[str] = ()  # names of the fixed joints that Gazebo keeps


def check_plugins(facts: PluginFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Everything about plugins and sensors."""
    wanted = _wanted(facts)
    for plugin in (plugin for tag in facts.tags for plugin in tag.plugins):
        if not plugin.filename:
            continue
        is_loaded = wanted is None or simulator_of(plugin.filename) in {None, wanted}
        yield from unknown_plugin(plugin, file, is_loaded=is_loaded)
        if not is_loaded:  # whatever it says
            continue
        yield from plugin_parts(plugin, facts, file)
        yield from unread_parameters(plugin, file)
    yield from plugin_of_other_simulator(facts, file)
    yield from sensors(facts, file)
    yield from duplicate_sensors(facts, file)


def driven_joints(tags: Iterable[GazeboTag]) -> set[str]:
    """The joints that the drives of a robot turn."""
    return {
        name
        for tag in tags
        for plugin in tag.plugins
        if "driv" in stem(plugin.filename)
        for key in PLUGINS.get(stem(plugin.filename), GazeboPlugin()).joints
        if "steer" not in key
        for name in plugin.values.get(key, ())
    }


UNKNOWN_PLUGIN = Rule(
    code="ROB100",
    name="unknown-plugin",
    severity=Severity.ERROR,
    summary="The file name or the class of a Gazebo plugin is misspelled.",
    what="Compares the file name with the systems of Gazebo Sim and the plugins of gazebo_plugins, "
    "and `name` with the classes of the system.",
    why="Gazebo logs that it cannot load the plugin and continues without it.",
    example='<plugin filename="gz-sim-difdrive-system" name="gz::sim::systems::DiffDrive">',
    instead='<plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">',
)


def unknown_plugin(
    plugin: Plugin, file: Path | None, *, is_loaded: bool = True
) -> Iterator[Diagnostic]:
    """Report a plugin whose file or class has a name that is nearly the right one."""
    place = f"gazebo/plugin[@filename='{plugin.filename}']"
    remark = remark_on(plugin.filename.rpartition("/")[2], plugin.name)
    if remark is not None:
        if not (remark.is_filename or is_loaded):
            return  # of another simulator: its plugins are called anything
        attribute = "filename" if remark.is_filename else "name"
        message, hint = remark.message, f'Write {attribute}="{remark.meant}".'
    else:
        name = stem(plugin.filename)
        is_known = name in OF_CLASSIC or not name.startswith("gazebo_ros_")
        near = None if is_known else _nearly(name, OF_CLASSIC)
        if near is None:
            return
        message = f"Gazebo has no plugin `{plugin.filename}`."
        hint = f'Write filename="lib{near}.so".'
    yield UNKNOWN_PLUGIN.at(file, plugin.line, place, message=message, hint=hint)


def _nearly(name: str, known: Iterable[str]) -> str | None:
    """The known name that differs by a letter or two: other people's have words more."""
    alike = [other for other in known if abs(len(other) - len(name)) <= MOST_LETTERS]
    return nearest(name, alike, cutoff=ALIKE)


PLUGIN_OF_OTHER_SIMULATOR = Rule(
    code="ROB101",
    name="robot-plugin-of-other-simulator",
    severity=Severity.ERROR,
    severity_varies="information where the robot also has such a plugin for the right simulator",
    summary="A plugin does not belong to the simulator of the launch file or of the ROS 2 "
    "distribution.",
    what="Plugins of gazebo_plugins (`libgazebo_ros_*.so`) are for Gazebo Classic, which Jazzy and "
    "later do not have; the systems (`gz-sim-*-system`) are for Gazebo Sim.",
    why="The simulator logs that it cannot load the library: the robot does not drive, and sensors "
    "publish nothing.",
    example='<plugin name="drive" filename="libgazebo_ros_diff_drive.so">  <!-- in Gazebo Sim -->',
    instead='<plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">',
)

OF_WORLD = (
    "Remove it: in Gazebo Sim the world loads a system for the sensors, and ros_gz_bridge "
    "passes their topics to ROS."
)


def plugin_of_other_simulator(facts: PluginFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Report plugins that the simulator cannot load."""
    wanted = _wanted(facts)
    if wanted is None:
        return
    whole = [plugin for tag in facts.tags for plugin in tag.plugins]
    of_sensors = [
        plugin for tag in facts.tags for sensor in tag.sensors for plugin in sensor.plugins
    ]
    right = {stem(one.filename) for one in (*whole, *of_sensors) if _is_for(one, wanted)}
    for plugin in (*whole, *of_sensors):
        if simulator_of(plugin.filename) in {None, wanted}:
            continue
        name = stem(plugin.filename)
        successor = SUCCESSORS.get(name) if wanted == SIM else predecessor(name)
        hint = f"Use {successor} for {SIMULATORS[wanted]}." if successor else OF_WORLD
        if wanted == CLASSIC and successor is None:
            hint = "Remove it, or start Gazebo Sim with ros_gz_sim."
        yield PLUGIN_OF_OTHER_SIMULATOR.at(
            file,
            plugin.line,
            f"gazebo/plugin[@filename='{plugin.filename}']",
            message=f"The plugin `{plugin.filename}` is for "
            f"{SIMULATORS[CLASSIC if wanted == SIM else SIM]}; {SIMULATORS[wanted]} "
            "cannot load it.",
            hint=hint,
            severity=Severity.INFO if is_served(name, right) else None,
        )


def _wanted(facts: PluginFacts) -> str | None:
    """The simulator that a robot is for."""
    if facts.simulator is None and facts.distro in WITHOUT_CLASSIC:
        return SIM
    return facts.simulator


def _is_for(plugin: Plugin, wanted: str) -> bool:
    return simulator_of(plugin.filename) == wanted


def simulator_meant(tags: Iterable[GazeboTag]) -> str | None:
    """The simulator that all plugins of a robot are for, where nothing else says it."""
    plugins = [
        plugin
        for tag in tags
        for plugin in (*tag.plugins, *(one for sensor in tag.sensors for one in sensor.plugins))
    ]
    kinds = {simulator_of(plugin.filename) for plugin in plugins} - {None}
    return kinds.pop() if len(kinds) == 1 else None


UNKNOWN_PLUGIN_PART = Rule(
    code="ROB102",
    name="unknown-plugin-part",
    severity=Severity.ERROR,
    summary="A Gazebo plugin names a joint or link that the robot does not have, or lacks its "
    "name.",
    what="Checks the joints and links in parameters of the drives, joint state publishers and "
    "joint controllers of Gazebo Classic and Gazebo Sim.",
    why="The plugin logs an error and does nothing: the robot does not drive, or its joint states "
    "are missing.",
    example="""
<joint name="left_wheel_joint" type="continuous">…</joint>
<joint name="right_wheel_joint" type="continuous">…</joint>
<gazebo>
  <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
    <left_joint>wheel_left_joint</left_joint>
    <right_joint>right_wheel_joint</right_joint>
  </plugin>
</gazebo>
""",
    instead="""
<joint name="left_wheel_joint" type="continuous">…</joint>
<joint name="right_wheel_joint" type="continuous">…</joint>
<gazebo>
  <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
    <left_joint>left_wheel_joint</left_joint>
    <right_joint>right_wheel_joint</right_joint>
  </plugin>
</gazebo>
""",
)


CONTROL = frozenset(("gz_ros2_control-system", "ign_ros2_control-system"))


def plugin_parts(plugin: Plugin, facts: PluginFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Report joints and links that a plugin looks for in vain."""
    if stem(plugin.filename) in CONTROL and not any(plugin.values.get("parameters", ())):
        yield UNKNOWN_PLUGIN_PART.at(
            file,
            plugin.line,
            f"gazebo/plugin[@filename='{plugin.filename}']",
            message=f"The plugin `{plugin.filename}` has no <parameters>: it does not start a "
            "controller manager without them.",
            hint="Add <parameters>$(find PACKAGE)/config/controllers.yaml</parameters>.",
        )
    known = PLUGINS.get(stem(plugin.filename))
    # A parameter of ROS 1 is reported as such.
    if known is None or any(
        _snake(key) != key for key in plugin.values if _snake(key) in known.joints
    ):
        return
    place = f"gazebo/plugin[@filename='{plugin.filename}']"
    yield from _joints_in_vain(plugin, known.joints, facts, file)
    for key in known.links:
        for text in _names(plugin, key):
            if text not in facts.links:
                yield _unknown_part(plugin, key, ("link", text, facts.links), file)
    for key in known.required:
        is_misspelled = nearest(key, plugin.values, cutoff=LIKE_PARAMETER) is not None
        if not any(plugin.values.get(key, ())) and not (is_misspelled and key not in plugin.values):
            yield UNKNOWN_PLUGIN_PART.at(
                file,
                plugin.line,
                place,
                message=f"The plugin `{plugin.filename}` has no <{key}>: it does nothing without "
                "it.",
                hint=f"Add <{key}>{'JOINT' if key in known.joints else '…'}</{key}>.",
            )


def _names(plugin: Plugin, key: str) -> Iterator[str]:
    return (text for text in plugin.values.get(key, ()) if re.fullmatch(r"[\w.-]+", text))


def _unknown_part(
    plugin: Plugin, key: str, part: tuple[str, str, Collection[str]], file: Path | None
) -> Diagnostic:
    kind, name, known = part
    near = nearest(name, known)
    return UNKNOWN_PLUGIN_PART.at(
        file,
        plugin.line,
        f"gazebo/plugin[@filename='{plugin.filename}']/{key}",
        message=f"The plugin `{plugin.filename}` names the {kind} `{name}`, which the robot does "
        "not have.",
        hint=did_you_mean(near) if near else f"Name a movable {kind} of this robot.",
    )


def _joints_in_vain(
    plugin: Plugin, keys: Iterable[str], facts: PluginFacts, file: Path | None
) -> Iterator[Diagnostic]:
    joints = {joint.name: joint for joint in facts.joints}
    movable = [
        name
        for name, joint in joints.items()
        if joint.type is not JointType.FIXED or name in facts.preserved
    ]
    driven = driven_joints(facts.tags)
    for key, name in [(one, name) for one in keys for name in _names(plugin, one)]:
        if name in movable:
            continue
        if name not in joints:
            yield _unknown_part(plugin, key, ("joint", name, movable), file)
        elif name not in driven:
            yield UNKNOWN_PLUGIN_PART.at(
                file,
                plugin.line,
                f"gazebo/plugin[@filename='{plugin.filename}']/{key}",
                message=f"The plugin `{plugin.filename}` names the joint `{name}`, which is fixed.",
                hint=f"Remove <{key}>{name}</{key}>, or give the joint a type that moves.",
            )
        elif "driv" in stem(plugin.filename):  # others follow from it
            yield UNKNOWN_PLUGIN_PART.at(
                file,
                joints[name].line,
                f"joint[@name='{name}']",
                message=f"The joint `{name}` is fixed, but the plugin `{plugin.filename}` has to "
                "turn it.",
                hint='Write type="continuous" and the <axis> of the wheel.',
            )


UNREAD_PLUGIN_PARAMETER = Rule(
    code="ROB103",
    name="unread-plugin-parameter",
    severity=Severity.WARNING,
    summary="A plugin does not read a parameter: it is misspelled, or belongs to ROS 1 or the "
    "other simulator.",
    what="Looks for misspelled parameters, for those of ROS 1 (`leftJoint`) in plugins of ROS 2, "
    "and for those of the other simulator.",
    why="The plugin silently uses its default: another wheel size, another topic.",
    example="""
<plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
  <wheel_seperation>0.4</wheel_seperation>
  <wheel_diameter>0.2</wheel_diameter>
</plugin>
""",
    instead="""
<plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
  <wheel_separation>0.4</wheel_separation>
  <wheel_radius>0.1</wheel_radius>
</plugin>
""",
)


def unread_parameters(plugin: Plugin, file: Path | None) -> Iterator[Diagnostic]:
    """Report parameters that the plugin does not know."""
    name = stem(plugin.filename)
    known = PLUGINS.get(name, GazeboPlugin()).parameters
    of_ros_2 = name in OF_CLASSIC or name == "gazebo_ros2_control"
    if not known and not of_ros_2:
        return
    others = OF_THE_OTHER.get(name, {})
    lacking = [key for key in known if key not in plugin.values]
    old = [key for key in plugin.values if _is_of_ros_1(key, known)] if of_ros_2 else []
    place = f"gazebo/plugin[@filename='{plugin.filename}']"
    if old:
        new = dict.fromkeys(FROM_ROS_1.get(key, f"<{_snake(key)}>") for key in old)
        yield UNREAD_PLUGIN_PARAMETER.at(
            file,
            plugin.line,
            place,
            message=f"The plugin `{plugin.filename}` has parameters of ROS 1, which the plugin for "
            f"ROS 2 does not read: {some_of([f'<{key}>' for key in old])}.",
            hint=f"Write {', '.join(new)}.",
        )
    for key in plugin.values:
        if key in known or key in old or not known:
            continue
        meant = others.get(key) or nearest(key, lacking, cutoff=LIKE_PARAMETER)
        if meant is None or meant in plugin.values:
            continue
        yield UNREAD_PLUGIN_PARAMETER.at(
            file,
            plugin.line,
            f"{place}/{key}",
            message=f"The plugin `{plugin.filename}` does not read <{key}>.",
            hint=f"Write <{meant}>" + _converted(key, meant) + ".",
        )


def _converted(key: str, meant: str) -> str:
    halves = {"wheel_diameter": " with half the value", "wheel_radius": " with twice the value"}
    return halves.get(key, "") if key != meant and meant in halves else ""


def _is_of_ros_1(key: str, known: Collection[str]) -> bool:
    return key in FROM_ROS_1 or (_snake(key) != key and (not known or _snake(key) in known))


def _snake(name: str) -> str:
    return CAPITAL.sub(r"_\1", name).lower()


SENSOR_WITHOUT_LINK = Rule(
    code="ROB104",
    name="sensor-without-link",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A `<sensor>` is in a `<gazebo>` element without `reference`.",
    why="A sensor belongs to a link. Gazebo silently ignores a sensor without one.",
    example='<gazebo>\n  <sensor name="imu" type="imu"/>\n</gazebo>',
    instead='<gazebo reference="imu_link">\n  <sensor name="imu" type="imu"/>\n</gazebo>',
)

SENSOR_NOT_SIMULATED = Rule(
    code="ROB105",
    name="sensor-not-simulated",
    severity=Severity.WARNING,
    summary="Gazebo Sim does not simulate a sensor of this type.",
    what="Looks for sensors of the types `ray` and `lidar` in robots for Gazebo Sim.",
    why="Up to Jetty, Gazebo Sim has only laser scanners on the GPU: it logs that the other types "
    "are not supported, and no scan is published.",
    example='<sensor name="laser" type="ray">',
    instead='<sensor name="laser" type="gpu_lidar">',
)

FRAME_WITHOUT_LINK = Rule(
    code="ROB106",
    name="frame-without-link",
    severity=Severity.WARNING,
    summary="The frame of a sensor is not a link of the robot.",
    why="The node robot_state_publisher publishes a frame for each link. RViz and Nav2 discard "
    "messages in another frame: they cannot be transformed.",
    example="""
<link name="laser_link">…</link>
<gazebo reference="laser_link">
  <sensor name="laser" type="gpu_lidar"><gz_frame_id>laser</gz_frame_id></sensor>
</gazebo>
""",
    instead="""
<link name="laser_link">…</link>
<gazebo reference="laser_link">
  <sensor name="laser" type="gpu_lidar"><gz_frame_id>laser_link</gz_frame_id></sensor>
</gazebo>
""",
)

FRAME_OF_SENSOR_UNSET = Rule(
    code="ROB107",
    name="frame-of-sensor-unset",
    severity=Severity.INFO,
    summary="A sensor for Gazebo Sim does not name the frame of its messages.",
    why="Gazebo Sim then uses the frame `MODEL/LINK/SENSOR`, which is not in /tf: RViz and Nav2 "
    "discard the messages.",
    example='<sensor name="laser" type="gpu_lidar">…</sensor>',
    instead="""
<sensor name="laser" type="gpu_lidar">
  <gz_frame_id>laser_link</gz_frame_id>
  …
</sensor>
""",
)


def sensors(facts: PluginFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Report sensors that send nothing, or in frames that nobody knows."""
    for tag in facts.tags:
        for sensor in tag.sensors:
            where = "" if tag.reference is None else f"[@reference='{tag.reference}']"
            place = f"gazebo{where}/sensor[@name='{sensor.name}']"
            if tag.reference is None:
                yield SENSOR_WITHOUT_LINK.at(
                    file,
                    sensor.line,
                    place,
                    message=f"The sensor `{sensor.name}` does not belong to a link: Gazebo ignores "
                    "it.",
                    hint='Move it to <gazebo reference="LINK">, with the name of its link.',
                )
                continue
            if tag.reference not in facts.links:
                continue
            if facts.simulator == SIM and sensor.kind in RAYS and facts.distro not in WITH_RAYS:
                yield SENSOR_NOT_SIMULATED.at(
                    file,
                    sensor.line,
                    place,
                    message=f"The sensor `{sensor.name}` has the type `{sensor.kind}`, which "
                    "Gazebo Sim does not simulate before Rotary.",
                    hint='Write type="gpu_lidar", and add the system Sensors to the world.',
                )
            yield from _frames(sensor, tag.reference, place, facts, file)


def _frames(
    sensor: Sensor, link: str, place: str, facts: PluginFacts, file: Path | None
) -> Iterator[Diagnostic]:
    named = [
        (key, text)
        for keys, values in (
            (FRAME_NAMES, sensor.values),
            *((FRAMES_OF_PLUGIN, plugin.values) for plugin in sensor.plugins),
        )
        for key in keys
        for text in values.get(key, ())
    ]
    for key, text in named:
        frame = text.removeprefix("/")
        if not re.fullmatch(r"[\w.-]+", frame) or frame in {*facts.links, *OTHER_FRAMES}:
            continue
        near = nearest(frame, facts.links)
        yield FRAME_WITHOUT_LINK.at(
            file,
            sensor.line,
            place,
            message=f"The sensor `{sensor.name}` publishes in the frame `{text}` (<{key}>), but "
            "the robot has no such link.",
            hint=did_you_mean(near) if near else f"Name a link of this robot: `{link}`.",
        )
    if facts.simulator == SIM and not named and sensor.kind in WITH_FRAMES:
        yield FRAME_OF_SENSOR_UNSET.at(
            file,
            sensor.line,
            place,
            message=f"The sensor `{sensor.name}` does not name its frame: Gazebo uses "
            f"`MODEL/LINK/{sensor.name}`, which is not in /tf.",
            hint=f"Add <gz_frame_id>{link}</gz_frame_id> to the sensor.",
        )


DUPLICATE_SENSOR = Rule(
    code="ROB108",
    name="duplicate-sensor",
    severity=Severity.ERROR,
    severity_varies="a warning in Gazebo Classic, which loads the robot",
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="Two sensors of a body have the same name.",
    what="Compares the names of the sensors of each link, including those of links that fixed "
    "joints attach to it: Gazebo lumps them into one body.",
    why="Gazebo Sim's parser reports an error and refuses the robot. Gazebo Classic loads it. "
    "Usually a xacro macro for a sensor is called twice.",
    example="""
<gazebo reference="left_camera_link"><sensor name="camera" type="camera"/></gazebo>
<gazebo reference="right_camera_link"><sensor name="camera" type="camera"/></gazebo>
""",
    instead="""
<gazebo reference="left_camera_link"><sensor name="left_camera" type="camera"/></gazebo>
<gazebo reference="right_camera_link"><sensor name="right_camera" type="camera"/></gazebo>
""",
)


def duplicate_sensors(facts: PluginFacts, file: Path | None) -> Iterator[Diagnostic]:
    """Report sensors of one name in links that Gazebo makes one body of."""
    above = {
        joint.child: joint.parent
        for joint in facts.joints
        if joint.type is JointType.FIXED
        and joint.name not in facts.preserved
        and joint.parent != "world"
    }
    seen: set[tuple[str, str]] = set()
    for tag in facts.tags:
        if tag.reference is None or tag.reference not in facts.links:
            continue
        body, way = tag.reference, {tag.reference}
        while body in above and above[body] not in way:
            body = above[body]
            way.add(body)
        for sensor in tag.sensors:
            if sensor.name and (body, sensor.name) in seen:
                yield DUPLICATE_SENSOR.at(
                    file,
                    sensor.line,
                    f"gazebo[@reference='{tag.reference}']/sensor[@name='{sensor.name}']",
                    message=f"Two sensors of the body `{body}` have the name `{sensor.name}`: "
                    "Gazebo Sim refuses the robot.",
                    hint="Give each sensor a different name. In a xacro macro, use a parameter as "
                    "a prefix.",
                )
            seen.add((body, sensor.name))
