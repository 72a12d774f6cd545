"""The rules over the parameters of controllers, each with its facts and no files."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.controller_joints import (
    Controlled,
    check_controllers,
    missing_controller_file,
)
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import ControlledPart, ControlSystem, Joint, JointType, Plugin
from wsgen.text import yamlfile

FILE = Path("controllers.yaml")
MANAGER = """\
controller_manager:
  ros__parameters:
    update_rate: 100
    arm:
      type: joint_trajectory_controller/JointTrajectoryController
    states:
      type: joint_state_broadcaster/JointStateBroadcaster
    drive: {type: diff_drive_controller/DiffDriveController}
"""
SOUND = f"""{MANAGER}
arm:
  ros__parameters:
    joints:
      - shoulder
      - elbow
    command_interfaces: [position]
    state_interfaces: [position, velocity]
/ns/drive:
  ros__parameters:
    left_wheel_names: [left]
    right_wheel_names: ["right"]
"""
PARTS = (
    ControlledPart(
        kind="joint", name="shoulder", commands=("position",), states=("position", "velocity")
    ),
    ControlledPart(
        kind="joint", name="elbow", commands=("position",), states=("position", "velocity")
    ),
    ControlledPart(kind="joint", name="left", commands=("velocity",)),
    ControlledPart(kind="joint", name="right", commands=("velocity",)),
)
JOINTS = tuple(
    Joint(name=name, type=JointType.CONTINUOUS, parent="a", child="b")
    for name in ("shoulder", "elbow", "left", "right", "free")
)
ROBOT = Controlled(
    joints=JOINTS,
    controls=(ControlSystem(name="all", kind="system", hardware="x/Y", parts=PARTS),),
    started=("arm", "drive"),
)


def check(text: str, robot: Controlled = ROBOT) -> list[Diagnostic]:
    content = yamlfile.parse(text)
    assert isinstance(content, yamlfile.Value)
    return list(check_controllers(content, robot, FILE))


def test_sound_parameters_are_silent() -> None:
    assert not check(SOUND)
    assert not check(SOUND, ROBOT._replace(controls=()))
    assert not check(SOUND.replace("- elbow", "- pid_controller/elbow"))
    own = SOUND.replace("state_interfaces:", "command_joints: [pid/elbow]\n    state_interfaces:")
    assert not check(own.replace("command_interfaces: [position]", "command_interfaces: [x]"))
    assert not check("a: [1, 2]")


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ("- elbow", "- elbwo", "ROB111", 14),
        ("[left]", "[left_wheel]", "ROB111", 19),
        ("- elbow", "- free", "ROB112", 14),
        ("command_interfaces: [position]", "command_interfaces: [effort]", "ROB112", 13),
        ("joints:\n      - shoulder", "joints:\n      - right", "ROB112", 13),
        ("[position, velocity]", "[position, effort]", "ROB112", 13),
        ('["right"]', "[shoulder]", "ROB112", 20),
        ("left_wheel_names", "left_wheels", "ROB113", 8),
    ],
)
def test_a_mistake(old: str, new: str, code: str, line: int) -> None:
    assert old in SOUND
    found = check(SOUND.replace(old, new))
    assert (found[0].code, found[0].line) == (code, line)
    expected = Severity.WARNING if code == "ROB113" else Severity.ERROR
    assert found[0].severity is expected
    assert found[0].hint


DRIVE = '    right_wheel_names: ["right"]\n'


@pytest.mark.parametrize(
    ("old", "new", "line", "hint"),
    [
        ("update_rate: 100", 'update_rate: "100"', 3, "Write update_rate: 100"),
        ("[left]", "left", 19, "Write a list: left_wheel_names: [left]"),
        (DRIVE, f"{DRIVE}    publish_rate: 50\n", 21, "Write publish_rate: 50.0"),
        (DRIVE, f"{DRIVE}    open_loop: 'no'\n", 21, "Write open_loop: no"),
        (DRIVE, f"{DRIVE}    base_frame_id: [base]\n", 21, "Write base_frame_id: base"),
        (DRIVE, f"{DRIVE}    linear:\n      x: {{max_velocity: 1}}\n", 22, "linear.x.max_velo"),
        (DRIVE, f"{DRIVE}    twist_covariance_diagonal: [1, 2]\n", 21, "[1.0, 2.0]"),
        (DRIVE, f"{DRIVE}    wheel_separaton: 0.5\n", 21, "`wheel_separation`"),
        ("      type: joint_trajectory", "    type: joint_trajectory", 5, "one more level"),
    ],
)
def test_parameters_that_a_controller_refuses_or_ignores(
    old: str, new: str, line: int, hint: str
) -> None:
    assert old in SOUND
    found = [one for one in check(SOUND.replace(old, new)) if one.code != "ROB113"]
    assert [(one.code, one.line) for one in found] == [("ROB150", line)]
    assert hint in (found[0].hint or "")
    expected = Severity.WARNING if "Did you mean" in (found[0].hint or "") else Severity.ERROR
    assert found[0].severity is expected


@pytest.mark.parametrize(
    "more",
    [
        "publish_rate: 50.0",
        "publish_rate: $(var rate)",
        "use_sim_time: true",
        "linear.x.has_velocity_limits: true",
        "wheels: 3",
        "tf_frame_prefix:",
    ],
)
def test_parameters_that_may_be_right(more: str) -> None:
    assert not check(SOUND.replace(DRIVE, f"{DRIVE}    {more}\n"))


def test_parameters_below_another_name() -> None:
    (found,) = check(SOUND.replace("/ns/drive:", "/ns/dribe:"))
    assert (found.code, found.line, found.severity) == ("ROB113", 17, Severity.ERROR)
    assert found.hint == "Rename `dribe:` to `drive:`, or set the type for `dribe` in line 8."


def test_joints_and_interfaces_that_ros2_control_misspells_are_reported_there() -> None:
    def with_part(name: str, command: str) -> Controlled:
        part = ControlledPart(kind="joint", name=name, commands=(command,), states=PARTS[0].states)
        system = ControlSystem(name="a", kind="system", hardware="x/Y", parts=(part, *PARTS[1:]))
        return ROBOT._replace(controls=(system,))

    assert not check(SOUND, with_part("shoulder", "position"))
    assert not check(SOUND, with_part("sholder", "position"))
    assert not check(SOUND, with_part("shoulder", "positon"))


def test_what_no_launch_file_starts_may_be_for_another_robot() -> None:
    wrong = SOUND.replace("- elbow", "- elbwo")
    (found,) = check(wrong, ROBOT._replace(started=()))
    assert (found.code, found.severity) == ("ROB111", Severity.WARNING)
    other = wrong.replace("- shoulder", "- right_shoulder")
    assert not check(other, ROBOT._replace(started=()))


def test_a_controller_may_be_for_a_part_that_an_argument_adds() -> None:
    robot = ROBOT._replace(of_parts=("arm",))
    gripper = SOUND.replace("- shoulder", "- knuckle").replace("- elbow", "- finger_tip")
    assert [found.code for found in check(gripper)] == ["ROB111", "ROB111"]
    assert not check(gripper, robot)
    (found,) = check(SOUND.replace("- elbow", "- elbwo"), robot)
    assert (found.code, found.severity) == ("ROB111", Severity.ERROR)
    misspelled = gripper.replace("- knuckle", "- sholder")
    assert [found.code for found in check(misspelled, robot)] == ["ROB111", "ROB111"]


def test_a_file_that_is_missing() -> None:
    plugin = Plugin("gz_ros2_control-system", {}, "x", 5)
    path = Path("/share/arm/config/controler.yaml")
    found = missing_controller_file(plugin, path, ["controllers.yaml"], Path("arm.urdf"))
    assert (found.code, found.line, found.hint) == ("ROB110", 5, "Did you mean `controllers.yaml`?")
    found = missing_controller_file(plugin, path, [], Path("arm.urdf"))
    assert "`config`" in (found.hint or "")
