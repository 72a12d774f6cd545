"""`python -m wsgen.live.nodes.bridge`: says to the simulator which topics of Gazebo ROS has.

It takes the arguments, parameters and YAML file of ros_gz_bridge's parameter_bridge, and with
`--images` the topics of ros_gz_image's image_bridge. Messages do not come through this process: the
simulator publishes and reads them itself, in a node of this one's name, until this process ends.
Sources: gazebosim/ros_gz, ros_gz_bridge/src/parameter_bridge.cpp, bridge_config.cpp and
ros_gz_image/src/image_bridge.cpp.
"""

from __future__ import annotations

import math
import os
import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.live.nodes.signals import ignore_ends, raise_when_ended
from wsgen.simulation.live_runs import SimulatorClient, SimulatorError
from wsgen.text import yamlfile

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

NODE = "ros_gz_bridge"
IMAGES = "--images"
WAIT = 5.0  # s, for the simulator, without a word
DIRECTIONS = {"BIDIRECTIONAL": "both", "GZ_TO_ROS": "to_ros", "ROS_TO_GZ": "to_gz"}
MARKS = {"@": "both", "[": "to_ros", "]": "to_gz"}
ROS_ARGUMENTS, END_OF_ROS_ARGUMENTS = "--ros-args", "--"


class Split(NamedTuple):
    """A command line."""

    words: list[str]  # that are not for ROS
    of_ros: list[str]  # those after --ros-args


class BadBridgeError(Exception):
    """The arguments or the file are wrong; the text says what and what to do."""


def main() -> int:
    """Bridge topics until somebody ends it; gives the exit code."""
    raise_when_ended()
    client = None
    try:
        words, of_ros = split(sys.argv[1:])
        rules = read_rules(words, of_ros, lambda text: _log("ERROR", text))
        client = SimulatorClient()
        while True:  # without a simulator, the real one waits for the next
            if not client.connect(WAIT):
                domain = os.environ.get("ROS_DOMAIN_ID") or "0"
                sys.stderr.write(f"Waiting for a simulator in ROS_DOMAIN_ID {domain}.\n")
                client.connect(math.inf)
            answer = client.ask("bridge", rules=rules, node=NODE, arguments=of_ros)
            for rule, problem in zip(rules, answer["problems"], strict=True):
                _notify(rule, problem)
            client.wait_until_it_ends()
            client.close()
    except BadBridgeError as error:
        sys.stderr.write(f"{error}\n")
        return 255
    except SimulatorError as error:
        sys.stderr.write(f"{error.message}\n{error.hint}\n")
        return 1
    except KeyboardInterrupt:
        pass
    finally:
        ignore_ends()
        if client is not None:
            client.close()
    return 0


def _notify(rule: Mapping[str, str], problem: str | None) -> None:
    """Print what the real bridge does for a rule, and what is wrong with it."""
    ros, gz = f"{rule['ros_topic']} ({rule['ros_type']})", f"{rule['gz_topic']} ({rule['gz_type']})"
    if problem is not None:
        _log("WARN", f"Failed to create a bridge for {ros} to {gz}: {problem}")
        return
    if rule["direction"] in {"both", "to_ros"}:
        _log("INFO", f"Creating GZ->ROS Bridge: [{gz} -> {ros}] (Lazy 0)")
    if rule["direction"] in {"both", "to_gz"}:
        _log("INFO", f"Creating ROS->GZ Bridge: [{ros} -> {gz}] (Lazy 0)")
    if rule["direction"] == "service":
        _log("INFO", f"Creating ROS->GZ service bridge [{ros} -> {rule['gz_topic']}]")


def _log(level: str, text: str) -> None:
    sys.stderr.write(f"[{level}] [{time.time():.9f}] [{NODE}]: {text}\n")


def split(arguments: list[str]) -> Split:
    """The arguments for ROS, and the others."""
    words: list[str] = []
    of_ros: list[str] = []
    is_ros = False
    for argument in arguments:
        if argument == ROS_ARGUMENTS:
            is_ros = True
        elif is_ros and argument == END_OF_ROS_ARGUMENTS:
            is_ros = False
        else:
            (of_ros if is_ros else words).append(argument)
    return Split(words, of_ros)


def read_rules(
    words: list[str], of_ros: list[str], report: Callable[[str], object]
) -> list[dict[str, str]]:
    """All rules, of the arguments and of the YAML file that a parameter names.

    Raises:
        BadBridgeError: An argument is wrong; what is wrong with the file is reported.
    """
    if words[:1] == [IMAGES]:
        return [
            {
                "ros_topic": topic,
                "gz_topic": topic,
                "ros_type": "sensor_msgs/msg/Image",
                "gz_type": "gz.msgs.Image",
                "direction": "to_ros",
            }
            for topic in words[1:]
        ]
    rules = [rule_of(word) for word in words]
    file = _parameter(of_ros, "config_file")
    if file:
        rules += rules_of_file(Path(file), report)
    return rules


def rule_of(word: str) -> dict[str, str]:
    """The rule that an argument is: `/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan`.

    Raises:
        BadBridgeError: It is none.
    """
    topic, at, types = word.partition("@")
    places = [(types.find(mark), mark) for mark in MARKS if mark in types]
    if not topic or not at or not types:
        raise BadBridgeError(
            f"The argument `{word}` does not describe a bridge. "
            "Write one like /scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan."
        )
    ros_type, mark, gz_type = (types, "", "")
    if places:
        place, mark = min(places)
        ros_type, gz_type = types[:place], types[place + 1 :]
    if "/srv/" in ros_type:
        return {
            "ros_topic": topic,
            "gz_topic": topic,
            "ros_type": ros_type,
            "gz_type": gz_type,
            "direction": "service",
        }
    if not ros_type or not gz_type or "@" in gz_type:
        raise BadBridgeError(
            f"The argument `{word}` does not describe a bridge: after the type of ROS comes @, [ "
            "or ] and then the type of Gazebo. Write one like "
            "/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan."
        )
    return {
        "ros_topic": topic,
        "gz_topic": topic,
        "ros_type": ros_type,
        "gz_type": gz_type,
        "direction": MARKS[mark],
    }


def rules_of_file(file: Path, report: Callable[[str], object]) -> list[dict[str, str]]:
    """The rules of a YAML file; what is wrong with it is reported, and left out."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        report(
            f"Could not parse config: failed to open file [{file}]: {reason}. Install the folder "
            "that it is in."
        )
        return []
    found = yamlfile.parse(text)
    if isinstance(found, yamlfile.NotYaml):
        report(f"Could not parse config: {file}:{found.line}: {found.message}.")
        return []
    if found is None or not isinstance(found.content, list):
        report(
            f"Could not parse config: the top level of [{file}] must be a YAML sequence. Begin "
            "each bridge with `- `."
        )
        return []
    rules = []
    for entry in found.elements():
        rule = _rule_of_entry(entry)
        if isinstance(rule, str):
            report(f"Could not parse entry: {file}:{entry.line}: {rule}")
        else:
            rules.append(rule)
    return rules


def _rule_of_entry(entry: yamlfile.Value) -> dict[str, str] | str:
    """The rule that an entry is, or what is wrong with it."""
    if not isinstance(entry.content, dict):
        return "entry must be a YAML map."
    values = {key: str(value.content) for key, value in entry.items() if value.content is not None}
    both = values.get("topic_name", "")
    # The second names are Fortress's.
    ros = values.get("ros_topic_name", "")
    gz = values.get("gz_topic_name", "") or values.get("ign_topic_name", "")
    gz_type = values.get("gz_type_name", "") or values.get("ign_type_name", "")
    if both and (ros or gz):
        return "topic_name and ros_topic_name or gz_topic_name are mutually exclusive. Remove one."
    if not values.get("ros_type_name") or not gz_type:
        return "both ros_type_name and gz_type_name must be set."
    direction = values.get("direction", "BIDIRECTIONAL")
    if direction not in DIRECTIONS:
        return f"invalid direction [{direction}]. Write one of {', '.join(DIRECTIONS)}."
    ros = ros or both or gz
    if not ros:
        return "it does not name a topic. Add ros_topic_name."
    return {
        "ros_topic": ros,
        "gz_topic": gz or ros,
        "ros_type": values["ros_type_name"],
        "gz_type": gz_type,
        "direction": DIRECTIONS[direction],
    }


def _parameter(of_ros: list[str], name: str) -> str:
    """A parameter of the command line or of a file that it names; the last one counts."""
    found = ""
    for flag, value in pairwise(of_ros):
        if flag in {"-p", "--param"}:
            key, equals, given = value.partition(":=")
            if equals and key.rpartition(":")[2] == name:
                found = given.strip("'\"")
        elif flag == "--params-file":
            found = _in_file(Path(value), name) or found
    return found


def _in_file(file: Path, name: str) -> str:
    """A parameter in a YAML file of parameters, of whatever node: launch writes one for each."""
    nodes = yamlfile.load_parameters(file)
    if not isinstance(nodes, yamlfile.Value):
        return ""
    for node in (node for _, node in nodes.items()):
        value = node.get("ros__parameters", name)
        if value is not None:
            return str(value.content)
    return ""


if __name__ == "__main__":
    sys.exit(main())
