"""What moves a robot that exists, and its sensors: chosen by words, never guessed."""

# ruff: noqa: E501  elements as people write them

import json
import math
import re
from pathlib import Path

import pytest
import yaml

from existing_robots import ARM, write_arm
from wsgen.cli import run
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.errors import RequestError
from wsgen.model.robot import Robot
from wsgen.model.target import choose_target
from wsgen.porting.existing.extensions import Extensions, Wanted, extend

JAZZY, CLASSIC = choose_target("jazzy", "gz"), choose_target("humble", "classic")
INERTIAL = '<inertial><mass value="{}"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'


def wheel(name: str, y: float, *, rpy: str = "0 0 0", axis: str = "0 1 0", x: float = 0.0) -> str:
    return f"""
  <link name="{name}">
    <collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision>
    {INERTIAL.format(0.5)}
  </link>
  <joint name="{name}_joint" type="continuous"><origin xyz="{x} {y} 0" rpy="{rpy}"/>
    <parent link="body"/><child link="{name}"/><axis xyz="{axis}"/><limit effort="5" velocity="9"/></joint>"""


def cart(*wheels: str) -> str:
    return f"""<robot name="cart"><link name="body">
    <collision><origin xyz="-0.1 0 0"/><geometry><box size="0.4 0.3 0.1"/></geometry></collision>
    <collision><origin xyz="-0.25 0 -0.075"/><geometry><sphere radius="0.025"/></geometry></collision>
    {INERTIAL.format(4).replace("<mass", '<origin xyz="-0.1 0 0"/><mass')}</link>{"".join(wheels)}</robot>"""


CART = cart(wheel("left", 0.2), wheel("right", -0.2))


def read(text: str) -> Robot:
    robot, _ = read_urdf(text, file=None)
    assert robot is not None
    return robot


def extended(
    text: str, *, control: str = "none", wheels: tuple[str, ...] = (), sensors: tuple[str, ...] = ()
) -> Extensions:
    robot = read(text)
    return extend(robot, robot, Wanted(control, wheels, sensors), JAZZY, "cart")


BOTH = ("left:left_joint", "right:right_joint")


def test_wheels_are_measured() -> None:
    drive = extended(CART, control="diff_drive", wheels=BOTH).drive
    assert drive is not None
    assert (drive.separation, drive.radius, drive.torque) == (0.4, 0.1, 5.0)
    assert drive.ahead == pytest.approx(0.0)


def test_wheels_with_frames_as_cad_has_them() -> None:
    """Their axes are z of their frames, which are turned; the robot drives along its y."""
    text = cart(
        wheel("left", 0, x=-0.3, rpy="0 -1.5707963267948966 0", axis="0 0 1"),
        wheel("right", 0, x=0.3, rpy="0 -1.5707963267948966 0", axis="0 0 1"),
    )
    drive = extended(text, control="diff_drive", wheels=BOTH).drive
    assert drive is not None
    assert drive.separation == pytest.approx(0.6)
    assert drive.ahead == pytest.approx(math.pi / 2)


@pytest.mark.parametrize(
    ("text", "wheels", "why", "next_step"),
    [
        (CART, (), "are to be named", "Choose among left_joint, right_joint."),
        (CART, BOTH[:1], "are to be named", "--wheel left:JOINT --wheel right:JOINT"),
        (CART, ("left:no", BOTH[1]), "`no` does not exist", "Choose among"),
        (CART, ("middle:a", BOTH[1]), "is not understood", "Write --wheel left:JOINT or"),
        (
            CART,
            (BOTH[0].replace("left:", "right:"), "left:right_joint"),
            "from the left to the right",
            "Swap",
        ),
        (
            cart(wheel("left", 0.2), wheel("right", -0.2, axis="0 -1 0")),
            BOTH,
            "the other way round",
            "Change <axis>",
        ),
        (
            cart(wheel("left", 0.2), wheel("right", -0.2, axis="1 0 0")),
            BOTH,
            "in another direction",
            "Change <axis>",
        ),
        (
            CART.replace('<cylinder radius="0.1" length="0.04"/>', "").replace(
                '<collision><origin rpy="1.5707963 0 0"/><geometry></geometry></collision>', ""
            ),
            BOTH,
            "radius is not known",
            "Add a <collision>",
        ),
    ],
)
def test_wheels_that_cannot_be_driven(
    text: str, wheels: tuple[str, ...], why: str, next_step: str
) -> None:
    with pytest.raises(RequestError, match=why) as error:
        extended(text, control="diff_drive", wheels=wheels)
    assert next_step in error.value.hint


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ({"sensors": ("lidar:bode",)}, "does not have a link `bode`"),
        ({"sensors": ("radar:body",)}, "is not understood"),
        ({"sensors": ("lidar",)}, "is not understood"),
        ({"wheels": BOTH}, "is for --control diff_drive"),
    ],
)
def test_words_that_say_nothing(words: dict[str, tuple[str, ...]], why: str) -> None:
    with pytest.raises(RequestError, match=why):
        extended(CART, **words)  # type: ignore[arg-type]


def test_a_robot_with_a_control_of_its_own() -> None:
    text = CART.replace(
        "</robot>",
        '<ros2_control name="x" type="system"><hardware><plugin>p</plugin></hardware><joint name="left_joint"/></ros2_control></robot>',
    )
    with pytest.raises(RequestError, match="has a <ros2_control> already"):
        extended(text, control="velocity")


def test_nothing_to_control() -> None:
    with pytest.raises(RequestError, match="does not have a joint"):
        extended('<robot name="r"><link name="a"/></robot>', control="effort")


def test_names_of_several_sensors() -> None:
    found = extended(CART, sensors=("camera:left", "camera:right", "lidar:body")).sensors
    assert [one.name for one in found] == ["camera_left", "camera_right", "scan"]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def new(source: Path, *options: str, name: str = "my_robot") -> int:
    maintainer = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")
    return run(["new", name, "--from", str(source), *maintainer, *options])


TARGETS = [("humble", "classic"), ("jazzy", "gz")]


@pytest.mark.slow
@pytest.mark.parametrize(("distro", "simulator"), TARGETS)
def test_a_cart_drives(
    distro: str, simulator: str, here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cart.urdf").write_text(CART)
    wheels = [word for one in BOTH for word in ("--wheel", one)]
    sensors = ["--sensor", "lidar:body", "--sensor", "camera:body", "--sensor", "imu:body"]
    target = ["--distro", distro, "--sim", simulator]
    assert (
        new(
            tmp_path / "cart.urdf",
            *target,
            "--control",
            "diff_drive",
            *wheels,
            *sensors,
            "--validate",
        )
        == 0
    )
    assert re.search(r"ok +drives straight: 0\.\d+ m ahead, -?0\.0", capsys.readouterr().out)
    assert run(["check", "ws_gazebo"]) == 0
    assert "error[" not in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize(("distro", "simulator"), TARGETS)
@pytest.mark.parametrize("control", ["position", "velocity", "effort"])
def test_an_arm_is_controlled(  # noqa: PLR0917  two tables
    control: str,
    distro: str,
    simulator: str,
    here: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    target = ["--distro", distro, "--sim", simulator]
    assert new(write_arm(tmp_path), *target, "--control", control, "--bolted") == 0
    assert "different" not in capsys.readouterr().out
    assert run(["check", "ws_gazebo"]) == 0
    assert "error[" not in capsys.readouterr().out
    package = here / "ws_gazebo" / "src" / "my_robot"
    settings = yaml.safe_load((package / "config" / "controllers.yaml").read_text())
    manager = settings.pop("controller_manager")["ros__parameters"]
    ((name, parameters),) = settings.items()
    assert name in manager
    assert parameters["ros__parameters"]["joints"] == ["shoulder"]
    assert f"'{name}'" in (package / "launch" / "gazebo_model.launch.py").read_text()
    assert (
        f'<command_interface name="{control}"/>' in (package / "model" / "robot.gazebo").read_text()
    )
    needed = "gazebo_ros2_control" if simulator == "classic" else "gz_ros2_control"
    assert f"<exec_depend>{needed}<" in (package / "package.xml").read_text()


@pytest.mark.slow
@pytest.mark.parametrize(("distro", "simulator"), TARGETS)
def test_controllers_of_ros_control_keep_their_names(
    distro: str,
    simulator: str,
    here: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    source = write_arm(tmp_path).parents[1]
    for name, text in {
        "config/control.yaml": "arm:\n  states: {type: joint_state_controller/JointStateController}\n"
        "  lift: {type: effort_controllers/JointPositionController, joint: shoulder, pid: {p: 1}}\n"
        "  push: {type: effort_controllers/JointEffortController, joint: shoulder}\n",
        "launch/control.launch": """<launch>
          <rosparam file="$(find arm_description)/config/control.yaml"/>
          <node pkg="controller_manager" type="spawner" name="s" ns="/arm" args="lift states"/>
          <node pkg="robot_state_publisher" type="robot_state_publisher" name="p">
            <remap from="/joint_states" to="/arm/joint_states"/>
          </node>
        </launch>""",
    }.items():
        (source / name).parent.mkdir()
        (source / name).write_text(text)
    target = ["--distro", distro, "--sim", simulator]
    assert new(source, *target, "--control", "position", "--bolted") == 0
    error = capsys.readouterr().err
    assert "control.yaml:3: The gains of `lift` are not used" in error
    assert "control.launch" not in error.replace("control.launch.py", "")
    package = here / "ws_gazebo" / "src" / "my_robot"
    settings = yaml.safe_load((package / "config" / "controllers.yaml").read_text())
    assert {*settings} == {"controller_manager", "lift", "push"}
    assert not (package / "config" / "control.yaml").exists()
    text = (package / "model" / "robot.gazebo").read_text()
    for interface in ("position", "effort"):
        assert f'<command_interface name="{interface}"/>' in text
    assert "arguments=['lift']" in (package / "launch" / "gazebo_model.launch.py").read_text()
    assert run(["check", "ws_gazebo"]) == 0
    assert "error[" not in capsys.readouterr().out
    file = package / "launch" / "control.launch.py"
    assert run(["launch", str(file), "--format", "json"]) == 0
    spawner, publisher = json.loads(capsys.readouterr().out)["processes"]
    assert spawner["arguments"] == [
        *("lift", "joint_state_broadcaster", "--controller-manager", "/controller_manager")
    ]
    assert not publisher.get("remappings")


@pytest.mark.slow
def test_followers_get_no_commands(here: Path, tmp_path: Path) -> None:
    urdf = write_arm(tmp_path)
    finger = '<link name="finger"><inertial><mass value="0.1"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="follow" type="prismatic"><parent link="upper"/><child link="finger"/><axis xyz="0 0 1"/><limit lower="0.1" upper="0.5" effort="1" velocity="1"/><mimic joint="shoulder" multiplier="2"/></joint></robot>'
    urdf.write_text(ARM.replace("</robot>", finger))
    assert new(urdf, "--distro", "jazzy", "--control", "position") == 0
    package = here / "ws_gazebo" / "src" / "my_robot"
    settings = yaml.safe_load((package / "config" / "controllers.yaml").read_text())
    assert settings["joint_trajectory_controller"]["ros__parameters"]["joints"] == ["shoulder"]
    text = (package / "model" / "robot.gazebo").read_text()
    assert text.count("<command_interface") == 1
    assert '<param name="initial_value">0.1</param>' in text


@pytest.mark.slow
def test_plugins_for_gazebo_classic_are_ported(here: Path, tmp_path: Path) -> None:
    plugin = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
      <wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter></plugin></gazebo></robot>"""
    (tmp_path / "cart.urdf").write_text(CART.replace("</robot>", plugin))
    assert new(tmp_path / "cart.urdf", "--distro", "jazzy") == 0
    package = here / "ws_gazebo" / "src" / "my_robot"
    assert "gz::sim::systems::DiffDrive" in (package / "urdf" / "cart.urdf").read_text()
    rows = yaml.safe_load((package / "config" / "bridge.yaml").read_text())
    assert "/cmd_vel" in [row["ros_topic_name"] for row in rows]


@pytest.mark.slow
def test_macros_are_kept_when_plugins_are_ported(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plugin = """<xacro:macro name="extra" params="link"><gazebo reference="${link}"><material>Gazebo/Orange</material></gazebo></xacro:macro>
    <xacro:extra link="body"/><gazebo><plugin name="x" filename="libgazebo_ros_control.so"/></gazebo></robot>"""
    text = CART.replace("</robot>", plugin).replace(
        "<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"', 1
    )
    (tmp_path / "cart.xacro").write_text(text)
    assert new(tmp_path / "cart.xacro", "--distro", "jazzy") == 0
    output = capsys.readouterr().err
    assert "Kept the xacro file with the macros." in output
    # Once, where the author has it.
    assert len(re.findall(r"cart\.xacro:\d+: `libgazebo_ros_control\.so`", output)) == 1
    text = (here / "ws_gazebo" / "src" / "my_robot" / "urdf" / "cart.xacro").read_text()
    assert "Gazebo/Orange" not in text
    assert "<xacro:macro" in text
