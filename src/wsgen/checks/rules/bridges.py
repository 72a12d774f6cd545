"""The rules about bridges between Gazebo Sim and ROS: what they read, and what they connect."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.launch_files import malformed_parameter_files
from wsgen.checks.rules.simulators import BRIDGES
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.gazebo.bridged_types import PAIRS, short_gz_type
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.text import yamlfile
from wsgen.text.markup import read_text
from wsgen.text.suggestions import LONG_ENOUGH, advice, did_you_mean, mistakes_between, nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from wsgen.checks.rules.node_topics import GazeboTopic
    from wsgen.model.plan import LaunchPlan, Process


INVALID_BRIDGE = Rule(
    code="LCH072",
    name="invalid-bridge",
    severity=Severity.ERROR,
    summary="An argument of `parameter_bridge` is not valid, or it has no topics.",
    what="Reads `TOPIC@ROS_TYPE[GZ_TYPE`, where the bracket is `[` from Gazebo to ROS, `]` from "
    "ROS to Gazebo, or `@` for both.",
    why="`parameter_bridge` prints its usage and exits: it does not bridge any topic.",
    example="arguments=['/scan@sensor_msgs/msg/LaserScan']",
    instead="arguments=['/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan']",
)
UNKNOWN_BRIDGE_TYPE = Rule(
    code="LCH073",
    name="unknown-bridge-type",
    severity=Severity.ERROR,
    summary="A bridge names a type that does not exist, or two types that do not match.",
    what="Compares the types with those that `ros_gz_bridge` converts. Types of other packages are "
    "not reported: a user-defined bridge may have them.",
    why="`parameter_bridge` prints that it failed to create a bridge for the topic, and continues "
    "without it: no message arrives.",
    example="arguments=['/imu@sensor_msgs/msg/Imu[gz.msgs.Imu']",
    instead="arguments=['/imu@sensor_msgs/msg/Imu[gz.msgs.IMU']",
)
INVALID_BRIDGE_ENTRY = Rule(
    code="LCH074",
    name="invalid-bridge-entry",
    severity=Severity.ERROR,
    severity_varies="a warning about a key that the bridge ignores",
    summary="An entry in the YAML file of a bridge is incomplete or has an unknown key.",
    what="Reads the `config_file` of `ros_gz_bridge`, a list with a mapping for each topic.",
    why="The bridge prints that it could not parse the entry, and continues without it.",
    example='- ros_topic_name: "scan"\n  gz_type: "gz.msgs.LaserScan"\n'
    '  ros_type_name: "sensor_msgs/msg/LaserScan"',
    instead='- ros_topic_name: "scan"\n  gz_topic_name: "scan"\n'
    '  ros_type_name: "sensor_msgs/msg/LaserScan"\n  gz_type_name: "gz.msgs.LaserScan"\n'
    "  direction: GZ_TO_ROS",
)
BRIDGE_DIRECTION = Rule(
    code="LCH075",
    name="wrong-bridge-direction",
    severity=Severity.WARNING,
    summary="A bridge passes messages in the wrong direction.",
    what="Compares the direction with that of the plugin or sensor at the topic: commands go to "
    "Gazebo; the clock, odometry and sensor data come from Gazebo.",
    why="No message arrives, without any error.",
    example="arguments=['/clock@rosgraph_msgs/msg/Clock]gz.msgs.Clock']",
    instead="arguments=['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock']",
)
UNKNOWN_BRIDGE_TOPIC = Rule(
    code="LCH076",
    name="unknown-bridge-topic",
    severity=Severity.WARNING,
    summary="A bridge names a Gazebo topic that does not exist in the robot or the world.",
    what="Compares the topics with those of the plugins and sensors that are spawned, with their "
    "default names. Only topics that look like a misspelling of one of these are reported, those "
    "of a world or a model with another name, and that of a sensor whose type only one sensor has, "
    "at another topic.",
    why="No message arrives, without any error.",
    example="# the world is named `office`\n"
    "arguments=['/world/default/model/r/joint_state@sensor_msgs/msg/JointState[gz.msgs.Model']",
    instead="arguments=['/world/office/model/r/joint_state@sensor_msgs/msg/JointState"
    "[gz.msgs.Model']",
)
OTHER_BRIDGE_TYPE = Rule(
    code="LCH077",
    name="other-bridge-type",
    severity=Severity.WARNING,
    summary="A bridge and the plugin or sensor at its topic have different types.",
    why="Gazebo does not deliver messages of another type, and prints no error.",
    example="# /odom of the diff drive plugin is gz.msgs.Odometry\n"
    "arguments=['/odom@geometry_msgs/msg/Pose[gz.msgs.Pose']",
    instead="arguments=['/odom@nav_msgs/msg/Odometry[gz.msgs.Odometry']",
)

FROM_GZ, TO_GZ, BOTH = "[", "]", "@"
DIRECTIONS = {"GZ_TO_ROS": FROM_GZ, "ROS_TO_GZ": TO_GZ, "BIDIRECTIONAL": BOTH}
_OF_IGNITION = {"IGN_TO_ROS": "GZ_TO_ROS", "ROS_TO_IGN": "ROS_TO_GZ"}
_KEYS = frozenset(
    (
        *("topic_name", "ros_topic_name", "gz_topic_name", "ros_type_name", "gz_type_name"),
        *("direction", "publisher_queue", "subscriber_queue", "lazy", "qos_profile"),
        *("service_name", "gz_req_type_name", "gz_rep_type_name", "frame_id", "namespace"),
    )
)
_PROGRAMS = frozenset(("parameter_bridge", "bridge_node", "ros_gz_bridge::RosGzBridge"))
_MISTYPED = lazy_pattern(r"(?:gz|ign|ignition)(?:\.|::|/)(?:msgs?)(?:\.|::|/)(\w+)")
ALIKE = 0.65  # as below, where a topic of the same model has no other name that is near
OF_KEYS = 0.7  # as below, of keys, of which there are few
SURELY = 0.8  # so alike two names are, as difflib counts, that one is the other misspelled


class Bridge(NamedTuple):
    """A topic that a bridge connects."""

    gz_topic: str
    ros_topic: str
    ros_type: str
    gz_type: str
    direction: str  # FROM_GZ, TO_GZ or BOTH
    file: Path | None = None
    line: int | None = None


class Bridges(NamedTuple):
    """All topics that the bridges of a plan connect."""

    topics: tuple[Bridge, ...]
    diagnostics: tuple[Diagnostic, ...]
    are_all: bool  # if not, others are not known here

    @property
    def published(self) -> tuple[str, ...] | None:
        """The topics of ROS that the bridges publish; None where they are not known."""
        if not self.are_all:
            return None
        return tuple(one.ros_topic for one in self.topics if one.direction != TO_GZ)


def find_bridges(plan: LaunchPlan) -> Bridges:
    """What the bridges of a plan connect, and what they do not understand."""
    nodes = [
        program
        for program in started_programs(plan)
        if program.package in BRIDGES and program.executable in _PROGRAMS
    ]
    words = [(node, word) for node in nodes for word in _words(node)]
    files = [str(node.parameters.get("config_file") or "") for node in nodes]
    files += (
        (include.configurations or include.arguments).get("config_file", "")
        for include in started_launch_files(plan)
        if not include.evaluated and include.file.name.startswith("ros_gz")
    )
    contents = {
        name: None if plan.is_unknown(name) else yamlfile.load(Path(name))
        for name in filter(None, files)
    }
    found = [_read_word(node, word) for node, word in words if not plan.is_unknown(word)]
    for name, content in contents.items():
        if isinstance(content, yamlfile.Value):
            found += _read_entries(Path(name), content)
        elif isinstance(content, yamlfile.NotYaml):
            found += malformed_parameter_files(Path(name))
    is_known = plan.is_complete and not any(
        "--params-file" in process.arguments for process in plan.processes
    )
    found += (_without_topics(node) for node in nodes if is_known and _is_empty(node))
    return Bridges(
        topics=tuple(one for one in found if isinstance(one, Bridge)),
        diagnostics=tuple(one for one in found if isinstance(one, Diagnostic)),
        are_all=plan.is_complete
        and not any(plan.is_unknown(word) for _, word in words)
        and all(isinstance(content, yamlfile.Value) for content in contents.values())
        and not any(_COMPUTED.intersection(node.parameters) for node in nodes),
    )


def _is_empty(node: Process) -> bool:
    """Whether a bridge is given neither topics nor the file that has them."""
    given = {*_COMPUTED, "config_file"}
    return (
        node.executable == "parameter_bridge"
        and given.isdisjoint(node.parameters)
        and not any(_words(node))
    )


def _without_topics(node: Process) -> Diagnostic:
    return INVALID_BRIDGE.at(
        node.file,
        node.line,
        node.executable,
        message=f"`{node.executable}` has no topics in its arguments, and does not bridge any.",
        hint="Name the YAML file with its topics: parameters=[{'config_file': FILE}], or give "
        "topics as arguments.",
    )


# Parameters that name topics in ways that are not read here.
_COMPUTED = frozenset(("bridge_names", "expand_gz_topic_names"))


def may_bring_clock(bridges: Bridges) -> bool:
    """Whether one of the bridges may publish the time of Gazebo in ROS."""
    published = bridges.published
    return published is None or any(topic.rstrip("/").endswith("clock") for topic in published)


def check_bridges(
    bridges: Sequence[Bridge],
    known: Collection[GazeboTopic],
    *,
    world: str | None,
    models: Collection[str] | None,
) -> Iterator[Diagnostic]:
    """Check what bridges connect.

    Args:
        bridges: The topics that they connect.
        known: Those of the plugins and sensors that are spawned.
        world: The name of the world, if it is known.
        models: The names of all models in the world; None where they are not known.
    """
    bridged = {absolute(one.gz_topic) for one in bridges}
    for bridge in bridges:
        yield from unknown_types(bridge)
        yield from wrong_direction(bridge, known)
        yield from other_type(bridge, known)
        # What is meant may be bridged beside it, for another world or robot.
        yield from (
            found
            for found in unknown_topic(bridge, known, world, models, bridged)
            if not any(found.hint == did_you_mean(other) for other in bridged)
        )


def unknown_types(bridge: Bridge) -> Iterator[Diagnostic]:
    """Report types that do not exist, and pairs that cannot be converted."""
    pairs = _pairs()
    gz_name = short_gz_type(bridge.gz_type)
    gz_names = {gz for _, gz in pairs}
    prefix = "ignition.msgs." if bridge.gz_type.startswith("ign") else "gz.msgs."
    if gz_name is None:
        mistyped = _MISTYPED.fullmatch(bridge.gz_type)
        if mistyped is not None:
            yield _unknown_type(bridge, bridge.gz_type, f"gz.msgs.{mistyped[1]}")
        return
    if bridge.ros_type not in {ros for ros, _ in pairs}:
        meant = _meant_ros_type(bridge.ros_type, gz_name)
        if meant is not None:
            yield _unknown_type(bridge, bridge.ros_type, meant)
        return
    if (bridge.ros_type, gz_name) in pairs:
        return
    fitting = sorted(gz for ros, gz in pairs if ros == bridge.ros_type)
    if gz_name in gz_names:
        yield _at(
            bridge,
            f"{bridge.ros_type} and {bridge.gz_type} cannot be converted to each other.",
            f"Use {' or '.join(prefix + name for name in fitting)}.",
        )
    elif nearest(gz_name.lower(), {name.lower() for name in gz_names} | {""}, cutoff=SURELY) or (
        gz_name.lower() in {name.lower() for name in gz_names}
    ):
        yield _unknown_type(bridge, bridge.gz_type, prefix + fitting[0])


def _meant_ros_type(written: str, gz_name: str) -> str | None:
    """The type of ROS that is meant by one that ros_gz_bridge does not know."""
    pairs = _pairs()
    package, _, name = written.replace("::", "/").replace(".", "/").partition("/")
    name = name.rpartition("/")[2]
    whole = f"{package}/msg/{name}"
    if whole != written and any(ros == whole for ros, _ in pairs):
        return whole  # without /msg/, or with other separators
    fitting = sorted(ros for ros, gz in pairs if gz == gz_name)
    if package in {ros.partition("/")[0] for ros in fitting}:
        return nearest(written, fitting, cutoff=SURELY)
    return None


def _unknown_type(bridge: Bridge, written: str, meant: str) -> Diagnostic:
    return _at(bridge, f"ros_gz_bridge does not know the type `{written}`.", did_you_mean(meant))


def _at(bridge: Bridge, message: str, hint: str) -> Diagnostic:
    return UNKNOWN_BRIDGE_TYPE.at(
        bridge.file, bridge.line, bridge.gz_topic, message=message, hint=hint
    )


def wrong_direction(bridge: Bridge, known: Iterable[GazeboTopic]) -> Iterator[Diagnostic]:
    """Report a bridge that carries messages the other way than Gazebo does."""
    here = [one for one in known if one.name == absolute(bridge.gz_topic)]
    is_clock = bridge.gz_type.endswith(".Clock")
    from_gz = is_clock or (bool(here) and all(one.is_published for one in here))
    to_gz = bool(here) and not any(one.is_published for one in here)
    wanted = FROM_GZ if from_gz else TO_GZ if to_gz else BOTH
    if BOTH in {wanted, bridge.direction} or wanted == bridge.direction:
        return
    who = "Gazebo" if is_clock and not here else here[0].owner
    does = "publishes" if from_gz else "reads"
    words = {sign: word for word, sign in DIRECTIONS.items()}
    yield BRIDGE_DIRECTION.at(
        bridge.file,
        bridge.line,
        bridge.gz_topic,
        message=f"{who} {does} `{bridge.gz_topic}`, but the bridge passes messages in the other "
        "direction.",
        hint=f"Write `{wanted}` between the types, in YAML `direction: {words[wanted]}`.",
    )


def other_type(bridge: Bridge, known: Iterable[GazeboTopic]) -> Iterator[Diagnostic]:
    """Report a type that is not that of the plugin or sensor."""
    here = [one for one in known if one.name == absolute(bridge.gz_topic)]
    name = bridge.gz_type.rpartition(".")[2]
    if here and all(one.type != name for one in here):
        yield OTHER_BRIDGE_TYPE.at(
            bridge.file,
            bridge.line,
            bridge.gz_topic,
            message=f"The bridge expects {bridge.gz_type} on `{bridge.gz_topic}`, but "
            f"{here[0].owner} uses gz.msgs.{here[0].type}.",
            hint=f"Write gz.msgs.{here[0].type}, with the matching ROS type.",
        )


_IN_WORLD = lazy_pattern(r"/world/([^/]+)/(?:model/([^/]+)/)?.*")
_OF_MODEL = lazy_pattern(r"/model/([^/]+)/.*")


def unknown_topic(
    bridge: Bridge,
    known: Collection[GazeboTopic],
    world: str | None,
    models: Collection[str] | None,
    bridged: Collection[str] = (),
) -> Iterator[Diagnostic]:
    """Report a topic that is nearly a known one, or below a world or model of another name.

    So is one of a sensor where the only sensor of that type has another topic, which no bridge has.
    """
    topic = absolute(bridge.gz_topic)
    names = {one.name for one in known}
    if topic in names:
        return
    in_world, of_model = _IN_WORLD.fullmatch(topic), _OF_MODEL.fullmatch(topic)
    model = (in_world and in_world[2]) or (of_model and of_model[1]) or None
    message = None
    if in_world and world is not None and in_world[1] != world:
        message = (
            f"`{topic}` belongs to the world `{in_world[1]}`, but the world is named `{world}`."
        )
        hint = did_you_mean(topic.replace(f"/world/{in_world[1]}/", f"/world/{world}/", 1))
    elif model and models is not None and model not in models:
        message = (
            f"`{topic}` belongs to the model `{model}`, but the world has no model of that name."
        )
        hint = advice(model, models, f"Name one of its models: {', '.join(sorted(models))}.")
    else:
        fitting = {one.name for one in known if one.type == bridge.gz_type.rpartition(".")[2]}
        near = _near_topic(topic, fitting)
        pair = bridge.ros_type, bridge.gz_type.rpartition(".")[2]
        is_sure = models is not None and pair in _pairs()
        if near is None and is_sure and len(fitting) == 1 and not fitting & {*bridged}:
            owner = next(one.owner for one in known if one.name in fitting)
            near = fitting.pop() if owner.startswith("the sensor") else None
        if near is not None:
            message = f"The topic `{topic}` does not exist in the robot or the world."
            hint = did_you_mean(near)
    if message is not None:
        yield UNKNOWN_BRIDGE_TOPIC.at(
            bridge.file, bridge.line, bridge.gz_topic, message=message, hint=hint
        )


def _near_topic(topic: str, known: Collection[str]) -> str | None:
    """The topic that is meant by one that nothing has: the same but for one name."""
    parts = topic.split("/")
    is_default = topic.startswith(("/world/", "/model/"))
    for other in sorted(known):
        others = other.split("/")
        if len(parts) != len(others):
            continue
        differing = [index for index, part in enumerate(parts) if part != others[index]]
        if len(differing) != 1:
            continue
        (index,) = differing
        is_name = is_default and parts[index - 1] in {"world", "model", "link", "sensor"}
        cutoff = ALIKE if is_default else SURELY
        pair = parts[index], others[index]
        is_slip = min(map(len, pair)) >= LONG_ENOUGH and mistakes_between(*pair) == 1
        if is_name or is_slip or nearest(parts[index], [others[index]], cutoff=cutoff):
            return other
    return None


def absolute(topic: str) -> str:
    """A topic as Gazebo sees it."""
    return topic if topic.startswith("/") else f"/{topic}"


def _words(program: Process) -> Iterator[str]:
    """The arguments of a bridge that are topics."""
    for word in program.arguments:
        if word == "--ros-args":
            return
        yield word


def _read_word(program: Process, word: str) -> Bridge | Diagnostic | None:
    """Read an argument as parameter_bridge does; None for a service."""
    topic, at, rest = word.partition("@")
    ros_type, gz_type, direction = rest, "", ""
    for sign in (BOTH, FROM_GZ, TO_GZ):
        first, found, last = rest.partition(sign)
        if found and first:
            ros_type, gz_type, direction = first, last, sign
            break
    if at and topic and "/srv/" in ros_type:
        return None
    place = _place_of(program, word)
    if at and topic and direction and gz_type and "@" not in gz_type:
        ros_topic = dict(program.remappings).get(topic, topic)
        return Bridge(topic, ros_topic, ros_type, gz_type, direction, *place)
    if word.startswith("-"):
        return None
    lacking = (
        "the ROS type"
        if not (at and topic)
        else "the Gazebo type and the direction"
        if not direction
        else "the Gazebo type"
    )
    return INVALID_BRIDGE.at(
        *place,
        word,
        message=f"`{program.executable}` does not understand `{word}`"
        + (": it has more than three parts." if "@" in gz_type else f": it lacks {lacking}."),
        hint="Write TOPIC@ROS_TYPE[GZ_TYPE, for example "
        "'/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock'.",
    )


def _place_of(program: Process, word: str) -> tuple[Path | None, int | None]:
    """The line of the launch file that writes an argument, else that of the node."""
    text = read_text(program.file) if program.file is not None else None
    lines = [number for number, line in enumerate((text or "").splitlines(), 1) if word in line]
    return program.file, lines[0] if len(lines) == 1 else program.line


def _read_entries(file: Path, content: yamlfile.Value) -> Iterator[Bridge | Diagnostic]:
    """The topics of a YAML file, as ros_gz_bridge reads it."""
    if not isinstance(content.content, list):
        yield INVALID_BRIDGE_ENTRY.at(
            file,
            content.line,
            message="The configuration file of the bridge is not a list.",
            hint="Begin each entry with `- `.",
        )
        return
    for entry in content.elements():
        values = dict(entry.items())
        texts = {key: value.text or "" for key, value in values.items()}
        for key, value in values.items():
            meant = nearest(key, _KEYS, cutoff=OF_KEYS) if key not in _KEYS else None
            if meant is not None and meant not in values:
                yield INVALID_BRIDGE_ENTRY.at(
                    file,
                    value.line,
                    key,
                    message=f"The bridge ignores the key `{key}`.",
                    hint=did_you_mean(meant),
                    severity=Severity.WARNING,
                )
        why = _why_invalid(texts)
        if why is not None:
            yield INVALID_BRIDGE_ENTRY.at(
                file,
                entry.line,
                texts.get("ros_topic_name") or texts.get("gz_topic_name") or None,
                message=f"The bridge cannot use this entry: {why[0]}.",
                hint=why[1],
            )
        elif texts.get("gz_type_name"):
            gz_topic, ros_topic = texts.get("gz_topic_name"), texts.get("ros_topic_name")
            both = texts.get("topic_name") or ""
            yield Bridge(
                gz_topic or both or ros_topic or "",
                ros_topic or both or gz_topic or "",
                texts["ros_type_name"],
                texts["gz_type_name"],
                DIRECTIONS[texts.get("direction") or "BIDIRECTIONAL"],
                file,
                entry.line,
            )


def _why_invalid(texts: dict[str, str]) -> tuple[str, str] | None:
    """Why an entry cannot be used, and what to do; None where it can."""
    if "service_name" in texts or not texts:
        return None
    names = [key for key in ("ros_type_name", "gz_type_name") if not texts.get(key)]
    if names:
        return f"it has no `{names[0]}`", f"Add `{names[0]}: TYPE` to the entry."
    topics = [key for key in ("topic_name", "ros_topic_name", "gz_topic_name") if texts.get(key)]
    if not topics:
        return "it has no topic", "Add `ros_topic_name` and `gz_topic_name` to the entry."
    if topics[0] == "topic_name" and len(topics) > 1:
        return f"`topic_name` and `{topics[1]}` exclude each other", "Remove one of them."
    direction = texts.get("direction")
    if direction and direction not in DIRECTIONS:
        meant = (
            _OF_IGNITION.get(direction)
            or nearest(direction.upper(), DIRECTIONS)
            or direction.upper()
        )
        return (
            f"`{direction}` is not a direction",
            did_you_mean(meant)
            if meant in DIRECTIONS
            else f"Write one of {', '.join(DIRECTIONS)}.",
        )
    return None


@cache
def _pairs() -> frozenset[tuple[str, str]]:
    """The types that are converted to each other: of ROS, and of Gazebo without `gz.msgs.`."""
    return frozenset(
        (ros.replace("/", "/msg/"), gz) for gz, types in PAIRS.items() for ros in types
    )
