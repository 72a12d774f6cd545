"""Frames in configurations, from texts and links alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.frames import frames_without_links, known_frames, links_of
from wsgen.model.plan import LaunchPlan, Process
from wsgen.model.robot import GazeboTag, Link, Plugin, Robot

PLUGIN = Plugin("libgazebo_ros_diff_drive.so", {"robot_base_frame": ("base_link_2",)})
ROBOT = Robot(
    name="r",
    root="base_link",
    links=(Link(name="base_link"), Link(name="laser")),
    gazebo=(GazeboTag(reference=None, plugins=(PLUGIN,), frames=("base_link_3",)),),
)
RVIZ = "Visualization Manager:\n  Global Options:\n    Fixed Frame: {}\n"
NAV2 = "amcl:\n  ros__parameters:\n    base_frame_id: {}\n"


def plan(*processes: Process) -> LaunchPlan:
    return LaunchPlan(package="p", launch_file=Path("a.launch.py"), processes=processes)


def check(name: str, text: str) -> list[tuple[int | None, str | None]]:
    known = known_frames([ROBOT], [])
    assert known is not None
    found = frames_without_links(Path(name), text, links_of([ROBOT]), known)
    return [(one.line, one.hint) for one in found]


@pytest.mark.parametrize(
    ("name", "text", "frame"),
    [
        ("a.rviz", RVIZ, "baselink"),
        ("a.rviz", RVIZ, "base_footprint"),
        ("a.yaml", NAV2, "base_lnk"),
        ("a.yaml", NAV2, '"/baselink"  # of the robot'),
        ("a.yaml", NAV2.replace("base_frame_id", "robot_base_frame"), "base-link"),
    ],
)
def test_frames_that_nothing_has(name: str, text: str, frame: str) -> None:
    assert check(name, text.format(frame)) == [(3, "Did you mean `base_link`?")]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.rviz", RVIZ.format("base_link")),
        ("a.rviz", RVIZ.format("odom")),
        ("a.rviz", RVIZ.format("map")),
        ("a.yaml", NAV2.format("laser")),
        ("a.yaml", NAV2.format("base_footprint")),
        ("a.yaml", NAV2.format("base_link_2")),
        ("a.yaml", NAV2.format("base_link_3")),
        ("a.yaml", NAV2.format("robot1/base_lnk")),
        ("a.yaml", NAV2.format("$(var prefix)base_lnk")),
        ("a.yaml", "# base_frame_id: base_lnk\nother: base_lnk\n"),
    ],
)
def test_frames_that_something_has(name: str, text: str) -> None:
    assert check(name, text) == []


def test_frames_that_launch_files_publish() -> None:
    node = Process(
        package="tf2_ros",
        executable="static_transform_publisher",
        arguments=("0", "0", "0", "0", "0", "0", "base_link", "base_lnk"),
    )
    driver = Process(package="own", executable="driver", parameters={"odom_frame": "/wheels"})
    known = known_frames([ROBOT], [plan(node, driver)])
    assert known is not None
    assert {"base_lnk", "wheels", "base_link"} <= known
    prefixed = Process(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters={"frame_prefix": "r1/"},
    )
    assert known_frames([ROBOT], [plan(prefixed)]) is None
    assert known_frames([], []) is None
