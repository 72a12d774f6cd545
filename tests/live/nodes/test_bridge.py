"""What the bridge's program makes of its arguments and files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.live.nodes.bridge import BadBridgeError, read_rules, rule_of, rules_of_file, split

if TYPE_CHECKING:
    from pathlib import Path


def rule(direction: str, gz_type: str = "gz.msgs.LaserScan") -> dict[str, str]:
    return {
        "ros_topic": "/scan",
        "gz_topic": "/scan",
        "ros_type": "sensor_msgs/msg/LaserScan",
        "gz_type": gz_type,
        "direction": direction,
    }


@pytest.mark.parametrize(("mark", "direction"), [("@", "both"), ("[", "to_ros"), ("]", "to_gz")])
def test_arguments(mark: str, direction: str) -> None:
    word = f"/scan@sensor_msgs/msg/LaserScan{mark}gz.msgs.LaserScan"
    assert rule_of(word) == rule(direction)


def test_a_service() -> None:
    service = "ros_gz_interfaces/srv/ControlWorld"
    for word in (service, f"{service}@gz.msgs.WorldControl@gz.msgs.Boolean"):
        found = rule_of(f"/world/w/control@{word}")
        assert (found["ros_type"], found["direction"]) == (service, "service")


@pytest.mark.parametrize(
    "word", ["scan", "@a@b", "/scan@", "/scan@sensor_msgs/msg/LaserScan", "/s@a[", "/s@a[b@c"]
)
def test_arguments_that_are_none(word: str) -> None:
    with pytest.raises(BadBridgeError, match="Write one like /scan@"):
        rule_of(word)


ENTRY = """
- ros_topic_name: "/scan"
  gz_topic_name: "/scan"
  ros_type_name: "sensor_msgs/msg/LaserScan"
  gz_type_name: "gz.msgs.LaserScan"
  direction: GZ_TO_ROS
- topic_name: /scan
  ros_type_name: sensor_msgs/msg/LaserScan
  gz_type_name: gz.msgs.LaserScan
- ros_topic_name: /scan
  ros_type_name: sensor_msgs/msg/LaserScan
  ign_type_name: ignition.msgs.LaserScan
  direction: ROS_TO_GZ
  lazy: true
"""


def test_a_file_that_a_parameter_names(tmp_path: Path) -> None:
    (tmp_path / "bridge.yaml").write_text(ENTRY)
    (tmp_path / "params.yaml").write_text(
        f"/**:\n  ros__parameters:\n    config_file: {tmp_path}/bridge.yaml\n"
    )
    expected = [rule("to_ros"), rule("both"), rule("to_gz", "ignition.msgs.LaserScan")]
    for of_ros in (
        ["-p", f"config_file:={tmp_path}/bridge.yaml"],
        ["--params-file", f"{tmp_path}/params.yaml"],
    ):
        line = split(["/a@std_msgs/msg/Bool@gz.msgs.Boolean", "--ros-args", *of_ros])
        problems: list[str] = []
        assert read_rules(line.words, line.of_ros, problems.append)[1:] == expected
        assert not problems


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1", "must be a YAML sequence"),
        ("- [1, 2]", "bridge.yaml:1: entry must be a YAML map"),
        ("\n- {ros_topic_name: /a}", "bridge.yaml:2: both ros_type_name and gz_type_name"),
        ("- {ros_type_name: a, gz_type_name: b}", "it does not name a topic"),
        ("- {topic_name: a, ros_topic_name: b}", "are mutually exclusive"),
        ("- {topic_name: a, ros_type_name: a, gz_type_name: b, direction: in}", "direction [in]"),
        ("- {", "Could not parse config: "),
        ("", "must be a YAML sequence"),
    ],
)
def test_files_that_are_wrong(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "bridge.yaml"
    file.write_text(text)
    problems: list[str] = []
    assert not rules_of_file(file, problems.append)
    (problem,) = problems
    assert message in problem


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    problems: list[str] = []
    assert not rules_of_file(tmp_path / "no.yaml", problems.append)
    assert "failed to open file" in problems[0]


def test_images() -> None:
    (found,) = read_rules(["--images", "/camera"], [], print)
    assert (found["ros_topic"], found["gz_type"], found["direction"]) == (
        "/camera",
        "gz.msgs.Image",
        "to_ros",
    )
