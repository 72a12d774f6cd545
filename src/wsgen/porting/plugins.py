"""The plugins of models of Gazebo Classic, for Gazebo Sim."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.plugins import PLUGINS, TWO_WHEELS, simulator_of, stem
from wsgen.gazebo.successors import (
    CONVERSIONS,
    COUNTERPARTS,
    MEASURED,
    ODOMETRY,
    ODOMETRY_OF_WHEELS,
    ONLY_IN_ROS_1,
    TO_LOOK_AT,
    WITHOUT_COUNTERPART,
)
from wsgen.gazebo.systems import CONTROL, is_of_gz, library_of
from wsgen.model.target import CLASSIC
from wsgen.porting.ported import Effort, Unported
from wsgen.porting.porter import (
    FROM_GAZEBO,
    TO_GAZEBO,
    ClassicPlugin,
    half,
    link_of,
    number,
    product,
    values_in,
    written,
)
from wsgen.porting.topics import absolute
from wsgen.porting.xml_edits import COMPUTED, CONDITIONS, Block

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

    from wsgen.gazebo.successors import Conversion
    from wsgen.porting.porter import Porter
    from wsgen.porting.xml_edits import Node

DIFF, PLANAR = "gazebo_ros_diff_drive", "gazebo_ros_planar_move"
STATES = ("gazebo_ros_joint_state_publisher", "joint-state-publisher", "ros2_control")
_OF_CONTROL = "gz_ros2_control-system"
# What ros2_control for Gazebo Sim does not read from Jazzy on: what it takes for it, and what to do
# where another thing is meant; None: it is of ROS 1, or has no effect.
_DESCRIBED = "Publish the description on `robot_description` in the namespace of the plugin."
_NOT_OF_CONTROL = {
    "robot_param": ("robot_description", _DESCRIBED),
    "robot_param_node": ("robot_state_publisher", _DESCRIBED),
    "e_stop_topic": ("", "Deactivate the controllers in a node that reads the topic."),
    **dict.fromkeys(("robot_sim_type", "robotSimType", "control_period", "robotNamespace")),
}
_REPEATED = ("left_joint", "right_joint", "joint_name", "wheel")
# Of these another element says the same once more.
_AS_THE_FIRST = ("xyz_offset", "rpy_offset", "xyz_offsets", "rpy_offsets")
_ACCELERATION = "max_wheel_acceleration"
_SIZES = ("wheel_separation", "wheel_diameter")
_TORQUE, _SOURCE = "max_wheel_torque", "odometry_source"
_LATER = (_ACCELERATION, _TORQUE, _SOURCE)
_HOLDERS_OF_JOINTS = ("robot", "model", "xacro:macro")
_FAST = 1000  # rad/s, faster than any wheel: a <limit> of URDF has a velocity
_SLOW = 100  # rad/s, below which it may be slower than one
_UNREAD = "odometry_of_wheels"  # a topic that no bridge converts
_BY_WHEELS = ("0", "encoder")  # where the odometry is from


def port_plugin(port: Porter, node: Node) -> None:
    """Port a plugin that is not in a sensor or a world."""
    plugin = port.plugin(node)
    if _is_there(port, plugin):
        port.editor.remove(node)
    elif plugin.stem in CONVERSIONS:
        _convert(port, plugin, CONVERSIONS[plugin.stem])
    elif plugin.stem in _OTHERS:
        _OTHERS[plugin.stem](port, plugin)
    elif plugin.own_stem in WITHOUT_COUNTERPART:
        what, advice = WITHOUT_COUNTERPART[plugin.own_stem]
        text = f"`{plugin.filename}` {what}; Gazebo Sim does not load it."
        port.leave(node, text, advice, is_note=plugin.own_stem in (*ONLY_IN_ROS_1, *TO_LOOK_AT))
        _take_out(port, node)
    elif simulator_of(plugin.filename) == CLASSIC or _is_library(node):
        port.leave(
            node,
            f"`{plugin.filename}` is a plugin for Gazebo Classic, which Gazebo Sim does not load.",
            "Write it for Gazebo Sim as a system, or use one of Gazebo Sim's.",
        )
    elif COMPUTED in plugin.filename and not is_of_gz(plugin.filename, node.get("name")):
        port.leave(
            node,
            f"xacro computes the name of the plugin: `{plugin.filename}`.",
            "Have it name a system of Gazebo Sim.",
        )


def _is_there(port: Porter, plugin: ClassicPlugin) -> bool:
    """Whether a robot for both simulators has what takes the place of a plugin anyway."""
    same = COUNTERPARTS.get(plugin.stem, ())
    return any(
        one.name == "plugin"
        and stem(one.get("filename")) in same
        and one.conditions == plugin.node.conditions
        and one.macro is plugin.node.macro
        for one in port.nodes
    )


def _is_library(node: Node) -> bool:
    """Whether a plugin is someone's own for Gazebo Classic: those of Gazebo Sim name a class."""
    name, filename = node.get("name"), node.get("filename")
    is_library = filename.startswith("lib") and filename.endswith(".so")
    return is_library and "::" not in name and not is_of_gz(filename, name)


def _take_out(port: Porter, node: Node) -> None:
    """Remove what Gazebo Sim cannot load, or make a comment of it if it has parameters."""
    if any(child.name != "ros" for child in node.children()):
        port.editor.comment_out(node)
    else:
        port.editor.remove(node)


def _become(port: Porter, node: Node, filename: str, name: str) -> None:
    port.editor.set_attribute(node, "filename", filename)
    port.editor.set_attribute(node, "name", name)


def _system(name: str) -> tuple[str, str]:
    """The file name and the name of a plugin, by its class."""
    return library_of(name), f"gz::sim::systems::{name}"


def _new_plugin(system: str, content: list[Block]) -> Block:
    filename, name = _system(system)
    return Block("plugin", content, f'filename="{filename}" name="{name}"')


def _convert(port: Porter, plugin: ClassicPlugin, made: Conversion) -> None:
    """Write a plugin as a system that has most of its parameters."""
    _become(port, plugin.node, *_system(made.system))
    values: dict[str, str] = {}  # of parameters of the system
    texts: dict[str, str] = {}  # of those parameters, as they were
    lost: dict[str, list[str]] = {}  # by what to do
    for name, node in plugin.parameters():
        new = made.renamed.get(name)
        if node.name.startswith("xacro:") or name in _LATER:
            continue
        if new is not None and (new not in values or new in _REPEATED):
            values[new], texts[new] = _renamed(port, node, name, new), node.text
            continue
        is_of_pair = plugin.own_stem == DIFF and name in _SIZES
        is_said = is_of_pair or name in _AS_THE_FIRST
        if new is not None and not is_said and node.text != texts[new]:
            lost.setdefault("Write a plugin for each pair of wheels.", []).append(node.name)
        elif name in made.lost and node.text != plugin.default(name):
            lost.setdefault(made.lost[name], []).append(node.name)
        if plugin.facts.parameters or name == "ros":
            port.editor.remove(node)
    for name in made.written:
        new = made.renamed[name]
        if new not in values:
            text = plugin.default(name)
            values[new] = half(text) or text if name == "wheel_diameter" else text
            port.editor.append(plugin.node, Block(new, values[new]))
    _list_lost(port, plugin, lost)
    _name_topics(port, plugin, made)
    more = _MORE.get(plugin.stem)
    if more is not None:
        more(port, plugin, values)


def _list_lost(port: Porter, plugin: ClassicPlugin, lost: dict[str, list[str]]) -> None:
    for advice, names in lost.items():
        tags = [f"<{one}>" for one in dict.fromkeys(names)]
        verb = "does" if len(tags) == 1 else "do"
        what = f"Its {', '.join(tags)} {verb} not exist in Gazebo Sim."
        port.leave(plugin.node, what, advice)


def _renamed(port: Porter, node: Node, name: str, new: str) -> str:
    """Rename a parameter, and convert its value; the value."""
    text = node.text
    if name == "joint_name" and "," in text:  # of ROS 1
        first, *others = (one.strip() for one in text.split(","))
        port.editor.set_text(node, first)
        port.editor.rename(node, new)
        port.editor.add_behind(node, *(Block(new, one) for one in others if one))
        return first
    if name == "wheel_diameter":
        radius = half(text)
        if radius is None:
            port.leave(node, f"<{node.name}> is `{text}`.", "Write half of it into <wheel_radius>.")
            return text
        port.editor.set_text(node, radius)
        text = radius
    port.editor.rename(node, new)
    return text


def _names(plugin: ClassicPlugin) -> dict[str, str]:
    """The topics that a plugin has in ROS, by what they are for."""
    texts = {name: "true" if plugin.holds(name) else "false" for name in plugin.facts.parameters}
    said: dict[str, str] = {}
    if plugin.is_of_ros_1:
        texts["publish_odom"] = "true"
        if plugin.find("publish_odom_tf") is None:
            texts["publish_odom_tf"] = "true"
        command = plugin.value("command_topic") or plugin.value("topic_name")
        topic = plugin.value("topic_name") if plugin.stem not in (DIFF, PLANAR) else ""
        said = {
            "command": command,
            "odometry": plugin.value("odometry_topic") or topic,
            "wrench": topic,
            "states": topic,
        }
    unnamed: dict[str, str | None] = {}
    found = {}
    for use, _, name in plugin.facts.topic_names(texts.get, unnamed):
        if name is not None:
            found[use] = plugin.topics.resolve(said.get(use) or name)
    if texts.get("publish_odom_tf") == "false":
        found.pop("tf", None)  # of wheels
    return found


def _name_topics(port: Porter, plugin: ClassicPlugin, made: Conversion) -> None:
    """Write the names of topics, and have them bridged."""
    names = _names(plugin)
    for use, parameter in made.topics.items():
        if use in names and not port.is_scoped:
            port.editor.append(plugin.node, Block(parameter, names[use]))
    for use, name in names.items():
        if use in made.topics:
            _bridge(port, plugin, use, name, made.system)


# A type of ROS -> that of Gazebo which is converted to it.
_GZ_TYPES = {types[0]: gz_type for gz_type, types in reversed(PAIRS.items())}


def _bridge(port: Porter, plugin: ClassicPlugin, use: str, name: str, system: str) -> None:
    """Have a topic of a plugin converted, which has one name in Gazebo and in ROS.

    In Gazebo it is that which a system has by itself where the topics are those of one robot alone.
    """
    topic = plugin.facts.topics[use]
    way = TO_GAZEBO if topic.is_read else FROM_GAZEBO
    in_gazebo = _own_topic(port, plugin, system, use) if port.is_scoped else name
    if any(row.gz_topic == in_gazebo != row.ros_topic != absolute(name) for row in port.rows):
        port.leave(
            plugin.node,
            f"Two plugins publish on {in_gazebo} in Gazebo Sim, as several robots have them.",
            f"Give one of them a topic that other robots do not have, and bridge it as {name}.",
        )
    port.bridge(in_gazebo, _GZ_TYPES[topic.type], name, way=way)


def _own_topic(port: Porter, plugin: ClassicPlugin, system: str, use: str) -> str:
    """The topic of a system where nothing names it."""
    return port.own_topic(plugin.node, PLUGINS[stem(library_of(system))].topics[use].name)


def _odometry(
    port: Porter, plugin: ClassicPlugin, parameters: dict[str, str], rate: str, system: str
) -> list[Block]:
    """What publishes odometry under the names of Gazebo Classic; nothing if that does not."""
    names = _names(plugin)
    by_use = {"odometry": "odom_topic", "tf": "tf_topic"}
    uses = [use for use in by_use if use in names]
    for use in uses:
        _bridge(port, plugin, use, names[use], system)
    if not uses:
        return []
    topics = [] if port.is_scoped else uses
    return [
        *(Block(by_use[use], names[use]) for use in topics),
        *(Block(new, plugin.value(name, plugin.default(name))) for name, new in parameters.items()),
        Block("odom_publish_frequency", rate),
    ]


def _diff_drive(port: Porter, plugin: ClassicPlugin, values: dict[str, str]) -> None:
    _limit_acceleration(port, plugin, values["wheel_separation"])
    _limit_effort(port, plugin)
    rate = plugin.value("update_rate", plugin.default("update_rate"))
    sources = plugin.all(_SOURCE)
    for node in sources:
        around = node.parent
        condition = around if around is not None and around.name in CONDITIONS else None
        if node.text in _BY_WHEELS and condition is not None:
            port.editor.replace(
                node, _odometry(port, plugin, ODOMETRY_OF_WHEELS, rate, "DiffDrive")
            )
            continue
        port.editor.remove(node)
        if node.text in _BY_WHEELS:
            blocks = _odometry(port, plugin, ODOMETRY_OF_WHEELS, rate, "DiffDrive")
            port.editor.append(plugin.node, *blocks)
        else:
            _publish_world_odometry(port, plugin, rate, condition)
    if not sources:
        _publish_world_odometry(port, plugin, rate)
    _publish_wheels(port, plugin, TWO_WHEELS)
    if plugin.own_stem == DIFF:
        _drive_other_pairs(port, plugin)


def _drive_other_pairs(port: Porter, plugin: ClassicPlugin) -> None:
    """Have a plugin of its own drive each pair of wheels that has not the sizes of the first one.

    Gazebo Classic gives a pair for which there are none the default ones.
    """
    wheels = [plugin.all(tag) for tag in TWO_WHEELS]
    acceleration = plugin.value(_ACCELERATION)
    for index, pair in enumerate(zip(*wheels, strict=False)):
        separation, diameter = (_size_of(plugin, name, index) for name in _SIZES)
        if all(_size_of(plugin, name, index) == _size_of(plugin, name, 0) for name in _SIZES):
            continue
        radius, bounds = half(diameter), _bounds(acceleration, separation)
        if radius is None or bounds is None:
            port.leave(pair[0], "This wheel has other sizes.", "Write a plugin for its pair.")
            continue
        blocks = [
            *(Block(tag, node.text) for tag, node in zip(TWO_WHEELS, pair, strict=True)),
            Block("wheel_separation", separation),
            Block("wheel_radius", radius),
            *bounds,
            Block("topic", _names(plugin)["command"]),
        ]
        for node in pair:
            port.editor.remove(node)
        port.editor.add_behind(plugin.node, _new_plugin("DiffDrive", blocks))


def _size_of(plugin: ClassicPlugin, name: str, index: int) -> str:
    """A size of a pair of wheels, as it is written."""
    nodes = plugin.all(name)
    return nodes[index].text if index < len(nodes) else plugin.default(name)


def _bounds(acceleration: str, separation: str) -> list[Block] | None:
    """The bounds of a robot, of which the rims of the wheels have this one; None: computed."""
    if not acceleration or number(acceleration) == 0:
        return []
    texts = [acceleration, *(product(sign, acceleration, separation) for sign in (2, -2))]
    texts.insert(1, product(-1, acceleration))
    names = ("max_linear", "min_linear", "max_angular", "min_angular")
    if None in texts:
        return None
    return [
        Block(f"{name}_acceleration", text or "") for name, text in zip(names, texts, strict=True)
    ]


def _limit_effort(port: Porter, plugin: ClassicPlugin) -> None:
    """Have the joints of the wheels be as strong as the plugin made them."""
    torque = plugin.find(_TORQUE)
    if torque is None or not torque.text:
        return
    port.editor.remove(torque)
    names = frozenset(node.text for tag in TWO_WHEELS for node in plugin.all(tag))
    if any(COMPUTED in one for one in names):
        names = (
            frozenset().union(
                *(
                    those
                    for (name, filename), those in port.robots.wheels.items()
                    if filename == plugin.filename
                    and values_in(plugin.node.get("name"), name) is not None
                )
            )
            or names
        )
    joints = [one for one in _joints(port.nodes) if one.get("name") in names]
    is_known = COMPUTED not in torque.text or all(one.macro is plugin.node.macro for one in joints)
    if is_known and names and {one.get("name") for one in joints} == names:
        for joint in joints:
            _set_effort(port, joint, torque.text)
        return
    left = Unported(
        port.source.file,
        plugin.node.line,
        f"Its <{torque.name}> does not exist in Gazebo Sim.",
        f"Write {torque.text} as the effort of the <limit> of the joints of the wheels.",
    )
    port.efforts.append(Effort(names, torque.text, left))


def _joints(nodes: Iterable[Node]) -> Iterator[Node]:
    """The joints of robots, and not what else has their names."""
    for one in nodes:
        if one.name == "joint" and one.holder and one.holder.name in _HOLDERS_OF_JOINTS:
            yield one


def port_effort(effort: Effort, around: Sequence[Porter]) -> bool:
    """Have the joints of wheels be as strong as a plugin made them, in all files of a robot.

    A joint in a macro is changed if all that the robot makes of it are wheels.

    Returns:
        Whether all joints were found.
    """
    nodes = [one for port in around for one in port.nodes]
    wheels: list[tuple[Porter, Node]] = []
    found: set[str] = set()
    for port in around:
        for joint in _joints(port.nodes):
            made = {_without_prefix(one, effort.joints) for one in _names_of(joint, nodes)}
            if made & effort.joints:
                if not made <= effort.joints:
                    return False
                found |= made
                wheels.append((port, joint))
    is_written = COMPUTED not in effort.torque or all(
        (limit := joint.find("limit")) is not None and limit.get("effort") == effort.torque
        for _, joint in wheels
    )
    if found != effort.joints or not found or not is_written:
        return False
    for port, joint in wheels:
        _set_effort(port, joint, effort.torque)
    return True


def _without_prefix(name: str, joints: Iterable[str]) -> str:
    """The name of one of the joints, if what xacro computes of a name is empty there."""
    for one in joints:
        computed = values_in(name, one)
        if computed is not None and not any(computed):
            return one
    return name


def _names_of(joint: Node, nodes: Iterable[Node]) -> set[str]:
    """The names that a joint gets: its own, or those by the calls of its macro."""
    name, macro = joint.get("name"), joint.macro
    if COMPUTED not in name or macro is None:
        return {name}
    call = f"xacro:{macro.get('name')}"
    return {
        re.sub(r"\$\{\s*(\w+)\s*\}", lambda used, one=one: one.get(used[1]) or used[0], name)  # type: ignore[misc]
        for one in nodes
        if one.name == call
    }


def _set_effort(port: Porter, joint: Node, effort: str) -> None:
    if joint.is_in("robot"):
        limit = joint.find("limit")
        if limit is None:
            attributes = f'effort="{effort}" velocity="{_FAST}"'
            port.editor.append(joint, Block("limit", (), attributes))
            return
        if number(limit.get("effort")) != number(effort) or number(effort) is None:
            port.editor.set_attribute(limit, "effort", effort)
        if _is_slow(limit.get("velocity")):
            port.editor.set_attribute(limit, "velocity", str(_FAST))
        return
    axis = joint.find("axis")
    if axis is None:
        return
    limit = axis.find("limit")
    if limit is None:
        port.editor.append(axis, Block("limit", [Block("effort", effort)]))
    else:
        port.editor.put(limit, "effort", effort)
        if _is_slow(limit.value("velocity")):
            port.editor.put(limit, "velocity", str(_FAST))


def _is_slow(velocity: str) -> bool:
    """Whether a wheel would turn slower than in Gazebo Classic, whose motors know no such limit."""
    most = number(velocity)
    return most is not None and 0 <= most < _SLOW


def _limit_acceleration(port: Porter, plugin: ClassicPlugin, separation: str) -> None:
    """That of the rims of the wheels, for going ahead and for turning on the spot."""
    node = plugin.find(_ACCELERATION)
    if node is None:
        return
    if not node.text or number(node.text) == 0:
        port.editor.remove(node)
        return
    bounds = _bounds(node.text, separation)
    if bounds is None:
        port.editor.remove(node)
        port.leave(
            node,
            f"<{node.name}> is `{node.text}`.",
            "Write <max_linear_acceleration> and <max_angular_acceleration>.",
        )
        return
    port.editor.rename(node, bounds[0].name)
    port.editor.add_behind(node, *bounds[1:])


def _publish_world_odometry(
    port: Porter, plugin: ClassicPlugin, rate: str, condition: Node | None = None
) -> None:
    """Add what publishes where the robot is in the world, as drives of Gazebo Classic do."""
    blocks = _odometry(port, plugin, ODOMETRY, rate, "OdometryPublisher")
    if not blocks:
        return
    made = CONVERSIONS[plugin.stem].system
    if port.is_scoped and "odometry" in PLUGINS[stem(library_of(made))].topics:
        # Else the drive publishes its own odometry on the same topic.
        port.editor.append(plugin.node, Block("odom_topic", _UNREAD))
    publisher = _new_plugin("OdometryPublisher", blocks)
    if condition is not None:
        publisher = Block(condition.name, [publisher], f'value="{condition.get("value")}"')
    port.editor.add_behind(plugin.node, publisher)


def _publish_wheels(port: Porter, plugin: ClassicPlugin, tags: Collection[str]) -> None:
    """Add what publishes the joints of wheels, whose transforms the plugin has published."""
    if not (plugin.holds("publish_wheel_tf") or plugin.holds("publish_wheel_joint_state")):
        return
    if any(
        one.name == "plugin" and any(name in one.get("filename") for name in STATES)
        for one in port.nodes
    ):
        return
    topic, system = plugin.topics.resolve("joint_states"), "JointStatePublisher"
    joints = [node.text for tag in tags for node in plugin.all(tag)]
    content = [] if port.is_scoped else [Block("topic", topic)]
    content += [Block("joint_name", one) for one in joints]
    content.append(Block("update_rate", plugin.value("update_rate", plugin.default("update_rate"))))
    port.editor.add_behind(plugin.node, _new_plugin(system, content))
    own = _own_topic(port, plugin, system, "states") if port.is_scoped else topic
    port.bridge(own, "Model", topic)
    if not plugin.node.is_in("robot"):
        port.leave(
            plugin.node,
            "It published the transforms of the wheels; Gazebo Sim publishes the joints.",
            "Start robot_state_publisher, which makes transforms of them.",
        )


def _planar_move(port: Porter, plugin: ClassicPlugin, _: dict[str, str]) -> None:
    rate = plugin.value("publish_rate", plugin.default("publish_rate"))
    _publish_world_odometry(port, plugin, rate)
    port.leave(
        plugin.node,
        "Gazebo Classic sets the speed a few times a second, and friction slows the robot between; "
        "Gazebo Sim holds it.",
        "Nothing, if the robot slides without friction; else send lower speeds.",
        is_note=True,
    )


def _ackermann(port: Porter, plugin: ClassicPlugin, values: dict[str, str]) -> None:
    if least := product(-1, values["max_velocity"]):
        port.editor.append(plugin.node, Block("min_velocity", least))
    rate = plugin.value("update_rate", plugin.default("update_rate"))
    _publish_world_odometry(port, plugin, rate)
    wheel = values.get("right_joint", "")
    cars = port.robots.cars
    sizes = next((cars[name] for name in cars if values_in(wheel, name) is not None), None)
    if sizes is not None:
        texts = (written(round(one, 6)) for one in sizes)
        port.editor.append(plugin.node, *map(Block, MEASURED, texts))
    else:
        port.leave(
            plugin.node,
            "Gazebo Classic finds the sizes of the car in its model, and Gazebo Sim does not.",
            f"Write {', '.join(f'<{one}>' for one in MEASURED)} into the plugin, in meters.",
        )
    port.leave(
        plugin.node,
        "`angular.z` of the commands is the angle of the front wheels in Gazebo Classic, and how "
        "fast the car turns in Gazebo Sim.",
        "Change what sends the commands, or use an ackermann_steering_controller.",
    )


def _ground_truth(port: Porter, plugin: ClassicPlugin, values: dict[str, str]) -> None:
    port.editor.append(plugin.node, Block("dimensions", "3"))
    frame = values["odom_frame"]
    # Of another frame than that of a link, the plugin gives the pose in the world.
    if any(one.name == "link" and one.get("name") == frame for one in port.nodes):
        port.leave(
            plugin.node,
            f"The pose is that in the world, and no longer that in `{frame}`.",
            "Compute the pose with tf2.",
        )


def _trajectory(port: Porter, plugin: ClassicPlugin, _: dict[str, str]) -> None:
    port.leave(
        plugin.node,
        "Gazebo Classic sets the positions of the joints; Gazebo Sim moves them by a controller.",
        "Write <joint_name>, <position_p_gain>, <position_i_gain> and <position_d_gain> of each "
        "joint into the plugin.",
    )


_MORE: dict[str, Callable[[Porter, ClassicPlugin, dict[str, str]], None]] = {
    DIFF: _diff_drive,
    PLANAR: _planar_move,
    "gazebo_ros_ackermann_drive": _ackermann,
    "gazebo_ros_p3d": _ground_truth,
    "gazebo_ros_joint_pose_trajectory": _trajectory,
}


def _control(port: Porter, plugin: ClassicPlugin) -> None:
    """ros2_control, whose plugin has almost the same parameters."""
    _become(port, plugin.node, _OF_CONTROL, CONTROL[_OF_CONTROL])
    port.packages.add("gz_ros2_control")
    for node in plugin.node.children(*_NOT_OF_CONTROL):
        port.editor.remove(node)
        known = _NOT_OF_CONTROL[node.name]
        if known is not None and node.text.rpartition("/")[2] != known[0]:
            what = f"ros2_control for Gazebo Sim does not read <{node.name}>: `{node.text}`."
            port.leave(node, what, known[1])
    _name_manager(port, plugin.node)


def _name_manager(port: Porter, node: Node) -> None:
    """Give the controller manager the namespace that the spawner gave it: `create` gives none."""
    spaces = {
        space
        for (name, parameters), those in port.robots.managers.items()
        if values_in(node.get("name"), name) is not None
        and values_in(node.value("parameters"), parameters) is not None
        for space in those
    }
    if len(spaces) > 1:
        port.leave(
            node,
            "The namespace of the spawner was that of the controller manager, too: "
            f"{', '.join(sorted(one or 'none' for one in spaces))}.",
            "Write it into <ros><namespace> of the plugin, for example by an argument of xacro.",
        )
    elif space := "".join(spaces):
        ros = node.find("ros")
        if ros is None:
            port.editor.append(node, Block("ros", [Block("namespace", space)]))
        else:
            port.editor.put(ros, "namespace", space)


def _force_torque(port: Porter, plugin: ClassicPlugin) -> None:
    """A sensor of the joint takes the place of the plugin."""
    owner = _measured_joint(port, plugin)
    joint = owner.get("name") if owner is not None else plugin.value("joint_name")
    if not joint or (owner is None and not plugin.node.is_in("robot")):
        port.leave(
            plugin.node,
            f"`{plugin.filename}` measures a joint that is not in this file.",
            "Write a sensor of the type force_torque into the joint.",
        )
        _take_out(port, plugin.node)
        return
    topic, name = _names(plugin)["wrench"], plugin.node.get("name")
    content = [
        Block("always_on", "true"),
        Block("update_rate", plugin.value("update_rate", "0")),
        *([] if port.is_scoped else [Block("topic", topic)]),
    ]
    if owner is not None and (child := _child_of(owner)):
        content.append(Block(port.target.frame_tag, child))
    content.append(
        Block(
            "force_torque",
            [Block("frame", "child"), Block("measure_direction", "child_to_parent")],
        )
    )
    sensor = Block("sensor", content, f'name="{name}" type="force_torque"')
    _put_sensor(port, plugin, sensor, joint, owner)
    port.systems.add("ForceTorque")
    place = f"joint/{joint}"
    own = (
        port.topic_of_sensor(plugin.node, "force_torque", place, name) if port.is_scoped else topic
    )
    port.bridge(own, "Wrench", topic)
    if number(plugin.value("gaussian_noise")) not in (None, 0.0):
        port.leave(
            plugin.node,
            "The noise of the plugin is not in the sensor.",
            "Write <noise> into <force> and <torque> of <force_torque>.",
        )


def _measured_joint(port: Porter, plugin: ClassicPlugin) -> Node | None:
    """The joint that a plugin measures: it names it, or the link that it carries."""
    joint, link = plugin.value("joint_name"), plugin.value("body_name")
    return next(
        (
            one
            for one in port.nodes
            if one.name == "joint"
            and one.get("name")
            and (one.get("name") == joint or (link and not joint and _child_of(one) == link))
        ),
        None,
    )


def _child_of(joint: Node) -> str:
    """The child link of a joint, in URDF or SDF."""
    child = joint.find("child")
    return "" if child is None else child.get("link") or child.text


def _put_sensor(
    port: Porter, plugin: ClassicPlugin, sensor: Block, reference: str, owner: Node | None
) -> None:
    """Write a sensor in the place of a plugin: into what it is for, or a <gazebo> for that."""
    around = plugin.node.holder
    if not plugin.node.is_in("robot") and owner is not None:
        port.editor.append(owner, sensor)
        port.editor.remove(plugin.node)
        return
    block = Block("gazebo", [sensor], f'reference="{reference}"')
    if around is None or around.name != "gazebo":
        port.editor.replace(plugin.node, [block])
    elif len(around.written) == 1:
        port.editor.replace(around, [block])
    else:
        port.editor.remove(plugin.node)
        port.editor.add_behind(around, block)


def _imu(port: Porter, plugin: ClassicPlugin) -> None:
    """An IMU of ROS 1 that is a plugin of the model."""
    link = plugin.value("body_name") or link_of(plugin.node)
    topic = plugin.topics.expand(plugin.value("topic_name") or "imu")
    if not link or not plugin.node.is_in("robot"):
        port.leave(
            plugin.node,
            f"`{plugin.filename}` is not in a sensor.",
            "Write a sensor of the type imu into the link.",
        )
        return
    content = [
        Block("always_on", "true"),
        Block("update_rate", plugin.value("update_rate", "0")),
        Block("topic", topic),
        Block(port.target.frame_tag, plugin.value("frame_name") or link),
    ]
    name = plugin.node.get("name")
    sensor = Block("sensor", content, f'name="{name}" type="imu"')
    _put_sensor(port, plugin, sensor, link, None)
    port.systems.add("Imu")
    port.bridge(topic, "IMU", topic)


_OTHERS: dict[str, Callable[[Porter, ClassicPlugin], None]] = {
    **dict.fromkeys(("gazebo_ros2_control", "ign_ros2_control-system"), _control),
    "gazebo_ros_ft_sensor": _force_torque,
    "gazebo_ros_imu_sensor": _imu,
}
