"""`wsgen validate` on packages that say in wsgen.toml what their robot must do."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from cli.packages import PACKAGE, SHARE, errors, validate, wsgen

pytestmark = pytest.mark.slow

WHEEL = """<link name="{side}_wheel">
  <inertial><mass value="0.5"/>
  <inertia ixx="0.00125" ixy="0" ixz="0" iyy="0.0025" iyz="0" izz="0.00125"/></inertial>
  <collision><origin rpy="1.5707963 0 0"/>
  <geometry><cylinder radius="0.1" length="0.01"/></geometry></collision>
  <visual><origin rpy="1.5707963 0 0"/>
  <geometry><cylinder radius="0.1" length="0.01"/></geometry></visual></link>
<joint name="{side}" type="continuous"><origin xyz="0 {y} 0"/><axis xyz="0 1 0"/>
  <parent link="base_link"/><child link="{side}_wheel"/></joint>
"""
ROBOT = """<robot name="r"><link name="base_link">
  <inertial><origin xyz="-0.05 0 0"/><mass value="5"/>
  <inertia ixx="0.04" ixy="0" ixz="0" iyy="0.07" iyz="0" izz="0.1"/></inertial>
  <collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision>
  <visual><geometry><box size="0.4 0.3 0.1"/></geometry></visual></link>
<link name="caster"><inertial><mass value="0.1"/>
  <inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial>
  <collision><geometry><sphere radius="0.05"/></geometry></collision>
  <visual><geometry><sphere radius="0.05"/></geometry></visual></link>
<joint name="to_caster" type="fixed"><origin xyz="-0.17 0 -0.05"/>
  <parent link="base_link"/><child link="caster"/></joint>
<gazebo reference="caster"><mu1>0</mu1><mu2>0</mu2></gazebo>
{wheels}
<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <left_joint>left</left_joint><right_joint>right</right_joint>
  <wheel_separation>0.4</wheel_separation><wheel_diameter>{diameter}</wheel_diameter>
</plugin></gazebo></robot>
"""
BEHAVIORS = """
[[behavior]]
name = "drives straight"
drive = { linear = 0.5 }
seconds = 2.0
moved = { x = 1.0, y = 0.0, yaw = 0.0 }

[[behavior]]
name = "turns"
drive = { angular = 1.0 }
seconds = 1.5
moved = { x = 0.0, y = 0.0, yaw = 1.5 }
"""


def robot(diameter: float = 0.2) -> str:
    wheels = "".join(WHEEL.format(side=side, y=y) for side, y in (("left", 0.2), ("right", -0.2)))
    return ROBOT.format(wheels=wheels, diameter=diameter)


@pytest.fixture
def workspace(built: Path, tmp_path: Path) -> Path:
    """A copy of it with another robot, as if that had been built."""
    without = shutil.ignore_patterns("build")
    copy = Path(shutil.copytree(built, tmp_path / "ws_gazebo", symlinks=True, ignore=without))
    give(copy, robot())
    return copy


def give(workspace: Path, text: str, behaviors: str = BEHAVIORS) -> None:
    """Write the robot where it is installed and in its source; and what it must do."""
    source = workspace / "src" / PACKAGE
    for folder in (workspace / SHARE, source):
        file = folder / "model" / "robot.xacro"
        file.unlink()
        file.write_text(text, encoding="utf-8")
    written = (source / "wsgen.toml").read_text(encoding="utf-8").partition("\n[[behavior]]")[0]
    (source / "wsgen.toml").write_text(written + behaviors, encoding="utf-8")


def behaviors_of(document: dict[str, Any]) -> list[dict[str, Any]]:
    (robot,) = document["packages"][0]["robots"]
    reported: list[dict[str, Any]] = robot["behaviors"]
    return reported


def test_a_robot_that_does_what_it_must(workspace: Path) -> None:
    code, document, _ = validate(workspace)
    assert code == 0, errors(document)
    straight, turns = behaviors_of(document)
    assert (straight["name"], straight["passed"], straight["joints"]) == (
        "drives straight",
        True,
        None,
    )
    assert straight["moved"]["x"] == pytest.approx(1.0, abs=0.05)
    assert straight["expected"] == {"x": 1.0, "y": 0.0, "yaw": 0.0}
    assert turns["moved"]["yaw"] == pytest.approx(1.5, abs=0.1)
    run = wsgen(workspace, "validate")
    assert run.returncode == 0
    (line,) = [line for line in run.stdout.splitlines() if "drives straight" in line]
    assert (
        line.split()
        == (
            f"ok drives straight: {straight['moved']['x']:.2f} m ahead, 0.00 m to the left, "
            "turned by 0.00 rad"
        ).split()
    )


@pytest.mark.parametrize("engine", ["bullet", "all"])
def test_a_wheel_size_that_is_wrong_in_the_plugin_is_found(workspace: Path, engine: str) -> None:
    if engine == "all":
        pytest.importorskip("dartpy")
    give(workspace, robot(diameter=0.4))
    code, document, _ = validate(workspace, "--engine", engine)
    assert code == 1
    (found,) = errors(document)  # what the behaviors show in each engine follows from it
    assert found["code"] == "ROB134"
    assert "has a radius of 0.2 m for the wheel" in found["message"]
    assert "`drives straight`: after 2 s the robot is at x = " in found["message"]
    assert "<wheel_diameter>" in found["hint"]
    assert [one["passed"] for one in behaviors_of(document)] == [False, False]
    run = wsgen(workspace, "validate")
    assert "failed  drives straight: 0." in run.stdout


@pytest.mark.parametrize(
    ("behaviors", "code", "words"),
    [
        ('[[behavior]]\nname = "a"\ndrive = { linear = 1 }\nmoved = { x = 1 }\n', "PKG060", None),
        ("[[behavior]]\n", "PKG060", None),
        (BEHAVIORS.replace("[[behavior]]", "[[behavior]", 1), "PKG060", "Close the name"),
        (BEHAVIORS.replace("seconds", 'robot = "other"\nseconds'), "SPN080", "the robots are `"),
        (
            '[[behavior]]\nname = "a"\njoints = { elbow = 1 }\nseconds = 1\n',
            "SPN083",
            "`left`, `right`",
        ),
    ],
)
def test_what_cannot_be_tried_is_an_error(
    workspace: Path, behaviors: str, code: str, words: str | None
) -> None:
    give(workspace, robot(), "\n" + behaviors)
    returned, document, _ = validate(workspace)
    assert returned == 1
    found = errors(document)
    assert {one["code"] for one in found} == {code}
    assert all(one["line"] and one["file"].endswith("wsgen.toml") for one in found)
    if words is not None:
        assert words in found[0]["hint"]
    if code == "SPN083":
        assert behaviors_of(document) == [
            {
                "name": "a",
                "passed": False,
                "moved": None,
                "joints": None,
                "traveled": None,
                "seconds": None,
                "printed": [],
                "expected": {"elbow": 1},
            }
        ]
        assert "failed  a: not simulated" in wsgen(workspace, "validate").stdout


def test_a_robot_without_a_drive_cannot_drive(workspace: Path) -> None:
    give(workspace, robot().replace("libgazebo_ros_diff_drive.so", "libgazebo_ros_camera.so"))
    _, document, _ = validate(workspace)
    assert [one["code"] for one in errors(document)] == ["SPN081", "SPN081"]
    other = robot().replace("libgazebo_ros_diff_drive.so", "gz-sim-diff-drive-system")
    give(workspace, other)
    _, document, _ = validate(workspace)
    assert [one["code"] for one in errors(document)] == ["ROB101"]  # of the other simulator
    assert not any(one["passed"] for one in behaviors_of(document))


def test_a_simulation_without_behaviors_loads_nothing_for_them(built: Path) -> None:
    script = (
        "import json, sys\nfrom wsgen.cli import run\ncode = run(['validate', '-q'])\n"
        "print(json.dumps([code, [name for name in sys.modules if 'behaviors' in name "
        "or 'behavior_' in name]]))"
    )
    command = [sys.executable, "-c", script]
    run = subprocess.run(command, cwd=built, capture_output=True, text=True, check=True)
    assert json.loads(run.stdout.splitlines()[-1]) == [0, []]
