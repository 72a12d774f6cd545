"""The rules about frames that configurations name, and about who publishes the states of joints."""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.bridges import TO_GZ, find_bridges
from wsgen.checks.rules.simulators import BRIDGES
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.plugins import OF_CLASSIC, stem
from wsgen.gazebo.systems import systems
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.launching.descriptions import PUBLISHER
from wsgen.launching.simulators import simulator_kinds
from wsgen.model.target import CLASSIC, SIM
from wsgen.text.suggestions import did_you_mean, nearest, some_named
from wsgen.text.values import lazy_pattern
from wsgen.text.xmltree import child_texts, children

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.model.robot import Robot
    from wsgen.text.xmltree import Element


UNPUBLISHED_FRAME = Rule(
    code="LCH085",
    name="unpublished-frame",
    severity=Severity.WARNING,
    summary="A configuration names a frame that looks like a misspelled link of the robot.",
    what="Compares the fixed frame of RViz, and the base frames of Nav2, localization, SLAM and "
    "controllers, with the links of the robots of the package. Frames that something may publish, "
    "such as `odom`, are not reported.",
    why="The frame has no transform: RViz shows an error instead of the robot, and Nav2 waits "
    "forever.",
    example="# the robot has the link `base_link`\namcl:\n  ros__parameters:\n"
    "    base_frame_id: baselink",
    instead="amcl:\n  ros__parameters:\n    base_frame_id: base_link",
)

_PARAMETER = lazy_pattern(
    r"^[ \t]*-?[ \t]*(robot_base_frame|base_frame_id|base_frame|base_link_frame)[ \t]*:[ \t]*"
    r"([\"']?)/?([A-Za-z_][\w-]*)\2[ \t]*(?:#.*)?\r?$",
    re.MULTILINE,
)
_FIXED_FRAME = lazy_pattern(
    r"^[ \t]*(Fixed Frame)[ \t]*:[ \t]*([\"']?)/?([A-Za-z_][\w-]*)\2[ \t]*\r?$", re.MULTILINE
)
_CONVENTIONAL = frozenset(("base_link", "base_footprint"))  # as ROS calls the base of a robot
SURELY = 0.8  # so alike two names are, as difflib counts, that one is the other misspelled
_OF_FRAME = lazy_pattern(r"(?:^|_)frame(?:_|$)|[fF]rame")


def known_frames(robots: Iterable[Robot], plans: Iterable[LaunchPlan]) -> frozenset[str] | None:
    """The links of robots, and the frames that their plugins and launch files publish.

    None where the frames have a prefix, or nothing is known of them.
    """
    frames: set[str] = set()
    for robot in robots:
        frames.update(link.name for link in robot.links)
        for tag in robot.gazebo:
            frames.update(tag.frames)
            values = (texts for plugin in tag.plugins for texts in plugin.values.values())
            frames.update(text.strip("/") for texts in values for text in texts)
    if not frames:
        return None
    for plan in plans:
        for node in started_programs(plan):
            if node.parameters.get("frame_prefix"):
                return None
            if node.executable == "static_transform_publisher":
                frames.update(node.arguments)
            # What a node is to publish exists.
            frames.update(
                str(value).strip("/")
                for name, value in node.parameters.items()
                if _OF_FRAME.search(name) and not _PARAMETER.match(f"{name}: x")
            )
    return frozenset(frames)


def frames_without_links(
    file: Path, text: str, links: Collection[str], known: Collection[str]
) -> Iterator[Diagnostic]:
    """Report the base frames and the fixed frame of a file that no link has.

    Args:
        file: A configuration of RViz, or a file of parameters.
        text: Its content.
        links: Those of the robots.
        known: All frames that are known, these among them.
    """
    is_rviz = file.suffix == ".rviz"
    for found in (_FIXED_FRAME if is_rviz else _PARAMETER).finditer(text):
        frame = found[3]
        if frame in known:
            continue
        near = nearest(frame, links, cutoff=SURELY)
        if near is None and is_rviz and frame in _CONVENTIONAL:
            near = next(iter(sorted(_CONVENTIONAL & set(links))), None)
        if near is not None:
            yield UNPUBLISHED_FRAME.at(
                file,
                text.count("\n", 0, found.start(3)) + 1,
                found[1],
                message=f"`{found[1]}` names the link `{frame}`, which the robot does not have.",
                hint=did_you_mean(near),
            )


def links_of(robots: Iterable[Robot]) -> frozenset[str]:
    """The names of all links of robots."""
    names = ([link.name for link in robot.links] for robot in robots)
    return frozenset(itertools.chain.from_iterable(names))


NO_JOINT_STATES = Rule(
    code="SPN106",
    name="no-joint-states",
    severity=Severity.WARNING,
    summary="`robot_state_publisher` waits for joint states that nothing publishes.",
    what="Where a launch file starts `robot_state_publisher` and a simulator or RViz, looks for "
    "joint_state_publisher, a spawner of joint_state_broadcaster, plugins of Gazebo that publish "
    "joint states (in Gazebo Sim with their bridge), and nodes of the workspace whose sources name "
    "`JointState`. Not checked where the launch file starts unknown nodes.",
    why="`robot_state_publisher` publishes the transforms of movable joints only when it receives "
    "their states: RViz shows `No transform` for wheels and arms.",
    example="Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': description}]),\n"
    "Node(package='rviz2', executable='rviz2')",
    instead="Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': description}]),\n"
    "Node(package='joint_state_publisher', executable='joint_state_publisher'),\n"
    "Node(package='rviz2', executable='rviz2')",
)

_PUBLISHERS = frozenset(("joint_state_publisher", "joint_state_publisher_gui"))
_MANAGER = "controller_manager"
_CONTROL = frozenset(("gz_ros2_control-system", "ign_ros2_control-system", "gazebo_ros2_control"))
# Packages whose programs publish no joint states.
_WITHOUT = frozenset(
    (
        *("robot_state_publisher", "rviz2", "tf2_ros", "robot_localization", "joy", "twist_mux"),
        *("ros_gz", "ros_gz_sim", "ros_gz_image", "ros_ign_gazebo", "ros_ign_image", "gazebo_ros"),
        *(_MANAGER, *BRIDGES),
    )
)
_WITHOUT_BY_PREFIX = ("nav2_", "rqt_", "slam_toolbox", "teleop_twist_")
_PROGRAMS = frozenset(("gz", "ign", "gazebo", "gzserver", "gzclient", "rviz2", "xacro"))
_MOVABLE = frozenset(("revolute", "continuous", "prismatic"))
_TOPIC = "joint_states"


class Providers(NamedTuple):
    """What publishes joint states in a plan."""

    is_known: bool  # whether nothing else may
    publish_all: bool  # of whatever joints there are
    bridged: frozenset[str]  # the topics of ROS that bridges of joint states publish
    bridges_transforms: bool
    starts_publisher: bool  # a robot_state_publisher


def find_providers(
    plan: LaunchPlan, may_publish: Callable[[str], bool], broadcasters: Collection[str] = ()
) -> Providers:
    """What publishes joint states in a plan.

    `may_publish` says whether a node of a package may; of packages that are not known, it may.
    `broadcasters` are the names of controllers that do.
    """
    nodes = started_programs(plan)
    bridges = find_bridges(plan)
    known = bridges.are_all and not plan.unresolved and plan.is_complete
    for include in started_launch_files(plan):
        package = include.package or ""
        known = known and (include.evaluated or _publishes_none(package))
    incoming = [one for one in bridges.topics if one.direction != TO_GZ]
    return Providers(
        is_known=known and not any(_is_unknown(node, may_publish) for node in nodes),
        publish_all=any(_publishes(node, broadcasters) for node in nodes),
        bridged=frozenset(one.ros_topic for one in incoming if "JointState" in one.ros_type),
        bridges_transforms=any("TFMessage" in one.ros_type for one in incoming),
        starts_publisher=any(node.executable == PUBLISHER for node in nodes),
    )


def _publishes(node: Process, broadcasters: Collection[str]) -> bool:
    is_spawner = node.package == _MANAGER and "spawner" in (node.executable or "")
    is_control = node.executable == "ros2" and node.arguments[:1] == ("control",)
    starts_broadcaster = any(
        "broadcaster" in word or "joint_state" in word or word in broadcasters
        for word in node.arguments
    )
    return node.package in _PUBLISHERS or ((is_spawner or is_control) and starts_broadcaster)


def _is_unknown(node: Process, may_publish: Callable[[str], bool]) -> bool:
    """Whether a node may publish joint states, as far as is known."""
    package = node.package
    if package is None:
        is_control = node.executable == "ros2" and node.arguments[:1] == ("control",)
        return node.executable not in _PROGRAMS and not is_control
    return package not in _PUBLISHERS and not _publishes_none(package) and may_publish(package)


def _publishes_none(package: str) -> bool:
    return package in _WITHOUT or package.startswith(_WITHOUT_BY_PREFIX)


def no_joint_states(
    plan: LaunchPlan,
    robots: Iterable[tuple[Process, Element]],
    spawned: Sequence[Element],
    providers: Providers,
) -> Iterator[Diagnostic]:
    """Report a robot_state_publisher that gets no states of some movable joints.

    Args:
        plan: What the launch file starts.
        robots: Each robot_state_publisher, and the robot that it publishes.
        spawned: The robots that are spawned; none where some are not known.
        providers: What publishes joint states in the plan.
    """
    kinds = simulator_kinds(plan)
    shows = any(node.executable == "rviz2" for node in started_programs(plan))
    if not providers.is_known or providers.publish_all or not (kinds or shows) or len(kinds) > 1:
        return
    for node, robot in robots:
        # The robot may be in the world, with plugins that are not looked at.
        if kinds and not spawned and (CLASSIC in kinds or providers.bridged):
            continue
        topic = dict(node.remappings).get(_TOPIC, _TOPIC)
        is_bridged = any(_name(one) == _name(topic) for one in providers.bridged)
        plugins = [plugin for root in (robot, *spawned) for plugin in root.iter("plugin")]
        covered = _covered(plugins, kinds, providers, is_bridged=is_bridged)
        missing = [] if covered is None else [*movable_joints(robot, covered)]
        if missing:
            yield NO_JOINT_STATES.at(
                node.file,
                node.line,
                node.name or node.executable,
                message="No node publishes the states of "
                f"{some_named(missing)} on {topic}: robot_state_publisher "
                "does not publish their transforms"
                + (', and RViz shows "No transform".' if shows else "."),
                hint=_what_to_do(plugins, kinds, topic, has_bridge=is_bridged),
            )
            return


def movable_joints(robot: Element, covered: Collection[str] = ()) -> Iterator[str]:
    """The names of the joints whose states robot_state_publisher needs, without these."""
    for joint in children(robot, "joint"):
        name = joint.get("name") or ""
        is_mimic = next(children(joint, "mimic"), None) is not None
        if joint.get("type") in _MOVABLE and not is_mimic and name not in covered:
            yield name


def _covered(
    plugins: Sequence[Element], kinds: Collection[str], providers: Providers, *, is_bridged: bool
) -> set[str] | None:
    """The joints that plugins of the simulator publish; None where they may publish all."""
    covered: set[str] = set()
    for plugin in plugins:
        name, values = stem(plugin.get("filename") or ""), child_texts(plugin)
        if not kinds:
            continue  # there is no simulator that loads them
        if name not in OF_CLASSIC and name not in systems() and name not in _CONTROL:
            return None  # one of somebody's own
        if SIM in kinds and name == "joint-state-publisher" and is_bridged:
            if "joint_name" not in values:
                return None
            covered.update(values["joint_name"])
        if SIM in kinds and name == "pose-publisher" and providers.bridges_transforms:
            return None
        if CLASSIC in kinds and name == "gazebo_ros_joint_state_publisher":
            covered.update(values.get("joint_name", ()))
        if CLASSIC in kinds and values.get("publish_wheel_tf", ("",))[0] in {"true", "1"}:
            covered.update(*(text for key, text in values.items() if key.endswith("_joint")))
    return covered


def _what_to_do(
    plugins: Sequence[Element], kinds: Collection[str], topic: str, *, has_bridge: bool
) -> str:
    names = {stem(plugin.get("filename") or "") for plugin in plugins}
    if kinds and names & _CONTROL:
        return (
            "Add Node(package='controller_manager', executable='spawner', "
            "arguments=['joint_state_broadcaster']) to the launch file."
        )
    if CLASSIC in kinds:
        return (
            'Add a <joint_name> for each to <plugin filename="libgazebo_ros_joint_state_publisher.'
            'so" name="joint_states"> in a <gazebo> of the robot.'
        )
    if SIM not in kinds:
        return (
            "Add Node(package='joint_state_publisher', executable='joint_state_publisher') to the "
            "launch file."
        )
    plugin = (
        'Add <gazebo><plugin filename="gz-sim-joint-state-publisher-system" '
        'name="gz::sim::systems::JointStatePublisher"><topic>joint_states</topic></plugin>'
        "</gazebo> to the robot"
    )
    bridge = (
        f"'/joint_states@sensor_msgs/msg/JointState[gz.msgs.Model' (remapped to {topic})"
        if _name(topic) != _TOPIC
        else "'/joint_states@sensor_msgs/msg/JointState[gz.msgs.Model'"
    )
    if "joint-state-publisher" in names:
        if has_bridge:
            return "Add a <joint_name> for each to the plugin, or remove all of them."
        return (
            "Add <topic>joint_states</topic> to the plugin JointStatePublisher, and "
            f"{bridge} to the arguments of parameter_bridge."
        )
    return f"{plugin}{'' if has_bridge else f', and {bridge} to parameter_bridge'}."


def _name(topic: str) -> str:
    """The last word of a topic: in which namespace it is depends on the nodes."""
    return topic.rstrip("/").rpartition("/")[2]
