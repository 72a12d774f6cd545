"""Controllers of ros_control keep their names, joints and parameters in ros2_control."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import yaml

from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.porting.existing.controllers_of_ros1 import (
    FoundControllers,
    find_controllers,
    spawned,
)

if TYPE_CHECKING:
    from pathlib import Path

JOINT = (
    '<joint name="{0}" type="continuous"><origin xyz="0 {1} 0"/><parent link="base"/>'
    '<child link="{0}_link"/><axis xyz="0 1 0"/></joint><link name="{0}_link"><collision>'
    '<origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.1" length="0.02"/></geometry>'
    "</collision></link>"
)
JOINTS = "".join(JOINT.format(*one) for one in (("l", 0.25), ("r", -0.25), ("one", 0), ("two", 0)))
ROBOT, _ = read_urdf(f'<robot name="r"><link name="base"/>{JOINTS}</robot>', file=None)


def find(
    folder: Path, text: str, launch: str = "", control: str = "position", beside: str = ""
) -> FoundControllers:
    for name, content in (("own/c.yaml", text), ("own/a.launch", launch), ("beside/c.yml", beside)):
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(content)
    assert ROBOT is not None
    return find_controllers(folder / "own", [folder / "beside"], ROBOT, control)


ARM = """
robot:
  states: {type: joint_state_controller/JointStateController, publish_rate: 50}
  arm:
    type: effort_controllers/JointTrajectoryController
    joints: [one, two]
    constraints: {goal_time: 1, stopped_velocity_tolerance: 0.1, one: {trajectory: 0.2, goal: 1}}
    gains:
      one: {p: 100, i: 0, d: 10, i_clamp: 1, antiwindup: true}
"""


@pytest.mark.parametrize("control", ["position", "effort"])
def test_trajectories(tmp_path: Path, control: str) -> None:
    found = find(tmp_path, ARM, control=control)
    (arm,) = found.controllers
    assert (arm.name, arm.joints, arm.interface) == ("arm", ("one", "two"), control)
    assert arm.type == "joint_trajectory_controller/JointTrajectoryController"
    wanted = {
        "joints": ["one", "two"],
        "command_interfaces": [control],
        "state_interfaces": ["position", "velocity"],
        "constraints": {
            "goal_time": 1.0,
            "stopped_velocity_tolerance": 0.1,
            "one": {"trajectory": 0.2, "goal": 1.0},
        },
    }
    gains = {"gains": {"one": {"p": 100.0, "i": 0.0, "d": 10.0, "i_clamp": 1.0}}}
    assert yaml.safe_load(arm.text) == (wanted | gains if control == "effort" else wanted)
    assert found.names == {"states": "joint_state_broadcaster", "arm": "arm"}
    assert found.files == (tmp_path / "own" / "c.yaml",)
    assert [one.what for one in found.notes] == (
        []
        if control == "effort"
        else ["The gains of `arm` are not used: Gazebo moves the joints without."]
    )


@pytest.mark.parametrize(
    ("kind", "type_now", "interface"),
    [
        ("effort_controllers/JointPositionController", "position", "position"),
        ("position_controllers/JointPositionController", "position", "position"),
        ("position_controller/JointPositionController", "position", "position"),
        ("position_controllers/JointGroupPositionController", "position", "position"),
        ("effort_controllers/JointVelocityController", "velocity", "velocity"),
        ("velocity_controllers/JointVelocityController", "velocity", "velocity"),
        ("effort_controllers/JointEffortController", "effort", "effort"),
    ],
)
def test_one_joint_and_groups(tmp_path: Path, kind: str, type_now: str, interface: str) -> None:
    found = find(tmp_path, f'c: {{type: "{kind}", joint: one}}')
    (one,) = found.controllers
    assert one.type == f"{type_now}_controllers/JointGroup{type_now.capitalize()}Controller"
    assert one.interface == interface
    assert yaml.safe_load(one.text) == {"joints": ["one"]}


DRIVE = """
base:
  type: diff_drive_controller/DiffDriveController
  left_wheel: l
  right_wheel: [r]
  publish_rate: 50
  enable_odom_tf: false
  base_frame_id: base
  pose_covariance_diagonal: [1, 0.1]
  linear: {x: {has_velocity_limits: true, max_velocity: 1, min_velocity: -1,
    has_acceleration_limits: false, max_acceleration: 2}}
"""


@pytest.mark.parametrize(
    ("sizes", "separation", "radius"),
    [("", 0.5, 0.1), ("  wheel_separation: 1\n", 1.0, 0.1), ("  wheel_radius: 2\n", 0.5, 2.0)],
)
def test_drives(tmp_path: Path, sizes: str, separation: float, radius: float) -> None:
    """What ros_control measures on the robot is measured here."""
    (one,) = find(tmp_path, DRIVE + sizes).controllers
    assert one.interface == "velocity"
    assert yaml.safe_load(one.text) == {
        "left_wheel_names": ["l"],
        "right_wheel_names": ["r"],
        "wheel_separation": pytest.approx(separation),
        "wheel_radius": pytest.approx(radius),
        "publish_rate": 50.0,
        "enable_odom_tf": False,
        "pose_covariance_diagonal": [1.0, 0.1],
        "base_frame_id": "base",
        "linear": {"x": {"min_velocity": -1.0, "max_velocity": 1.0}},
    }


def test_a_gripper(tmp_path: Path) -> None:
    kind = "position_controllers/GripperActionController"
    (one,) = find(tmp_path, f"hand: {{type: {kind}, joint: one, goal_tolerance: 1}}").controllers
    assert (one.type, one.interface) == (kind, "position")
    assert yaml.safe_load(one.text) == {"joint": "one", "goal_tolerance": 1.0}


SEVERAL = """
a: {type: position_controllers/JointPositionController, joint: one}
b: {type: velocity_controllers/JointVelocityController, joint: one}
c: {type: velocity_controllers/JointVelocityController, joint: two}
"""
SPAWNER = '<node pkg="controller_manager" type="spawner" name="s" args="{}"/>'


@pytest.mark.parametrize(
    ("launch", "started"),
    [
        ("<launch/>", "ac"),
        (f"<launch>{SPAWNER.format('/robot/b --timeout 60')}</launch>", "b"),
        (f"<launch>{SPAWNER.format('--stopped a')}{SPAWNER.format('b a')}</launch>", "a"),
        ("<launch>controller_manager", "ac"),
    ],
)
def test_which_ones_start(tmp_path: Path, launch: str, started: str) -> None:
    """Those that spawners name; never two for one joint."""
    found = find(tmp_path, SEVERAL, launch)
    assert {one.name for one in found.controllers} == {"a", "b", "c"}
    assert "".join(sorted(one.name for one in found.controllers if one.is_started)) == started


def test_packages_beside_the_robot(tmp_path: Path) -> None:
    """They have those of other robots, too."""
    beside = "x: {type: position_controllers/JointPositionController, joint: elsewhere}\n" + SEVERAL
    found = find(tmp_path, "", beside=beside)
    assert [one.name for one in found.controllers] == ["a", "b", "c"]
    assert not found.files
    assert not found.notes


SWAPPED = "c: {type: diff_drive_controller/DiffDriveController, left_wheel: r, right_wheel: l}"
TURNS = (
    "The wheels of `c` cannot be measured: The axes of the wheels point from the left to the "
    "right: with these sides the robot turns the wrong way."
)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("c: {type: nobody/KnowsController, joint: one}",
         "ros2_control does not have a controller like `c`, a nobody/KnowsController."),
        ("c: {type: nobody/KnowsController}", "The controller `c` does not name a joint."),
        ("c: {type: effort_controllers/JointEffortController, joints: [one, three]}",
         "The controller `c` commands three, which cannot be moved here."),
        ("'1 c': {type: effort_controllers/JointEffortController, joint: one}",
         "The name of the controller `1 c` is not one of ROS 2."),
        ("c: {type: diff_drive_controller/DiffDriveController, left_wheel: l}",
         "The controller `c` does not name wheels on both sides."),
        (SWAPPED, TURNS),
        (DRIVE + "  wheel_radius: [a]\n", "`wheel_radius` in line 12 is not a number."),
    ],
)  # fmt: skip
def test_what_has_no_counterpart_is_listed(tmp_path: Path, text: str, what: str) -> None:
    found = find(tmp_path, text)
    assert not found.controllers
    assert not found.files
    assert [one.what for one in found.notes] == [what]


@pytest.mark.parametrize(
    "text",
    [
        *("a: {type: x/y", "- type: a/b", "type: a/b", "a: {type: [a/b]}", "a: &a {b: *a}"),
        *("a: {type: a/b, joints: {c: d}}\nb: {type: 1/2}", "$(arg a): {type: a/b}", "\0: a/b"),
        "{" * 3000 + "type: a/b",
    ],
)
def test_odd_files_have_none(tmp_path: Path, text: str) -> None:
    assert not find(tmp_path, text).controllers


def test_arguments_of_spawners() -> None:
    words = ["--namespace", "/r", "spawn", "/r/a", "b", "--timeout", "5", "--stopped", "c"]
    assert spawned(words) == ["a", "b", "c"]
