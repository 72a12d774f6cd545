"""The proof of a port: a pair that does the same, and what is named where it does not."""

from __future__ import annotations

import cmath
import json
import os
import re
import subprocess
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

import wsgen.cli
from wsgen.checks.fixes.plan import FileFix
from wsgen.errors import EXIT_REQUEST, NotFoundError, RequestError
from wsgen.live.behaviors import run_live
from wsgen.model.behavior import LiveMeasurement, TimeSeries
from wsgen.model.target import SIM, Target
from wsgen.model.transform import Pose
from wsgen.pipeline.check import find_targets
from wsgen.pipeline.clock import Clock
from wsgen.porting.measured import DRIVES, Measured, Side, measure
from wsgen.porting.plan import PortPlan, plan_port
from wsgen.porting.proof import Compared, compare, prove_port
from wsgen.porting.robot_topics import RosTopic

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from wsgen.model.behavior import BehaviorRun
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest
    from wsgen.porting.proof import Proof

JAZZY = Target(distro="jazzy", simulator=SIM)
ENVIRONMENT = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/")}
MANIFEST = """\
<package format="3">
  <name>cart</name>
  <version>0.0.1</version>
  <description>A cart.</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <exec_depend>{simulator}</exec_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project(cart NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch urdf DESTINATION share/cart)
ament_package()
"""
LAUNCH = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    robot = os.path.join(get_package_share_directory('cart'), 'urdf', 'cart.urdf')
    simulator = get_package_share_directory('{package}')
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(simulator + '/launch/{file}'){arguments}),
        Node(package='{package}', executable='{spawner}',
             arguments=['{name}', 'cart', '-file', robot, '-z', '0.05']),{bridge}
    ])
"""
BRIDGE = """
        Node(package='ros_gz_bridge', executable='parameter_bridge',
             arguments=['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock',
                        '/cmd_vel@geometry_msgs/msg/Twist]gz.msgs.Twist',
                        '/odom@nav_msgs/msg/Odometry[gz.msgs.Odometry',
                        '/tf@tf2_msgs/msg/TFMessage[gz.msgs.Pose_V',
                        '/bot/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan']),"""
LAUNCHES = {
    "gazebo_ros": LAUNCH.format(
        package="gazebo_ros",
        file="gazebo.launch.py",
        arguments="",
        spawner="spawn_entity.py",
        name="-entity",
        bridge="",
    ),
    "ros_gz_sim": LAUNCH.format(
        package="ros_gz_sim",
        file="gz_sim.launch.py",
        arguments=",\n            launch_arguments={'gz_args': '-r empty.sdf'}.items()",
        spawner="create",
        name="-name",
        bridge=BRIDGE,
    ),
}
BOX = """<link name="{name}">
    <inertial><mass value="{mass}"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <collision>{turned}<geometry>{shape}</geometry></collision>
  </link>"""
WHEEL = BOX.format(
    name="{name}",
    mass="0.5",
    turned='<origin rpy="1.5708 0 0"/>',
    shape='<cylinder radius="0.05" length="0.02"/>',
)
URDF = f"""\
<robot name="cart">
  {BOX.format(name="base", mass="2", turned="", shape='<box size="0.3 0.2 0.06"/>')}
  {WHEEL.format(name="left")}
  {WHEEL.format(name="right")}
  {BOX.format(name="ball", mass="0.1", turned="", shape='<sphere radius="0.05"/>')}
  <joint name="left_axle" type="continuous">
    <parent link="base"/><child link="left"/><origin xyz="0.05 0.12 0"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="right_axle" type="continuous">
    <parent link="base"/><child link="right"/><origin xyz="0.05 -0.12 0"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="ball_joint" type="fixed">
    <parent link="base"/><child link="ball"/><origin xyz="-0.1 0 0"/>
  </joint>
  <gazebo reference="ball"><mu1>0.01</mu1><mu2>0.01</mu2></gazebo>
  {{plugins}}
</robot>
"""
PLUGINS = {
    "gazebo_ros": """<gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <left_joint>left_axle</left_joint><right_joint>right_axle</right_joint>
      <wheel_separation>0.24</wheel_separation><wheel_diameter>0.1</wheel_diameter>
      <publish_odom>true</publish_odom><publish_odom_tf>true</publish_odom_tf>
      <odometry_frame>odom</odometry_frame><robot_base_frame>base</robot_base_frame>
    </plugin>
  </gazebo>
  <gazebo reference="base">
    <sensor name="lidar" type="ray"><ray><range><max>9</max></range></ray>
      <plugin name="rays" filename="libgazebo_ros_ray_sensor.so">
        <ros><namespace>/bot</namespace><remapping>~/out:=scan</remapping></ros>
        <output_type>sensor_msgs/LaserScan</output_type>
      </plugin>
    </sensor>
  </gazebo>""",
    "ros_gz_sim": """<gazebo>
    <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
      <left_joint>left_axle</left_joint><right_joint>right_axle</right_joint>
      <wheel_separation>0.24</wheel_separation><wheel_radius>0.05</wheel_radius>
      <topic>cmd_vel</topic><odom_topic>odom</odom_topic><tf_topic>/tf</tf_topic>
      <frame_id>odom</frame_id><child_frame_id>base</child_frame_id>
    </plugin>
  </gazebo>
  <gazebo reference="base">
    <sensor name="lidar" type="gpu_lidar"><lidar><range><max>9</max></range></lidar>
      <topic>bot/scan</topic><gz_frame_id>base</gz_frame_id>
    </sensor>
  </gazebo>""",
}


def texts(simulator: str) -> dict[str, str]:
    """The files of the cart for Gazebo Classic or Gazebo Sim."""
    return {
        "package.xml": MANIFEST.format(simulator=simulator),
        "CMakeLists.txt": CMAKE,
        "launch/sim.launch.py": LAUNCHES[simulator],
        "urdf/cart.urdf": URDF.format(plugins=PLUGINS[simulator]),
    }


CLASSIC, PORTED = texts("gazebo_ros"), texts("ros_gz_sim")


def written(folder: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def planned(folder: Path, files: Mapping[str, str]) -> PortPlan:
    """The plan that makes these files of those in a folder."""
    return PortPlan(
        unported=(),
        packages=("cart",),
        files=tuple(
            FileFix(file=folder / name, before="", after=text, data=text.encode(), fixed=())
            for name, text in files.items()
            if (folder / name).is_file()
        ),
        created=tuple(
            (folder / name, text) for name, text in files.items() if not (folder / name).is_file()
        ),
    )


def proved(folder: Path, after: Mapping[str, str]) -> Proof:
    """What is compared of the cart for Gazebo Classic and these files."""
    package = written(folder / "src" / "cart", CLASSIC)
    plan = planned(package, after)
    return prove_port(find_targets([package]), JAZZY, ENVIRONMENT, lambda: plan)


def git(folder: Path, *words: str) -> str:
    options = ("-c", "user.name=Ada", "-c", "user.email=ada@example.org")
    run = subprocess.run(
        ["git", *options, *words], cwd=folder, check=True, capture_output=True, text=True
    )
    return run.stdout


@pytest.mark.slow
def test_a_port_that_does_the_same(tmp_path: Path) -> None:
    found = proved(tmp_path, PORTED)
    assert [(row.robot, row.aspect, row.is_same) for row in found.rows] == [
        ("cart", aspect, True)
        for aspect in ("links", "joints", "mass", "rest pose", "topics", "drive ahead", "turn")
    ]
    assert found.passed
    topics = next(row for row in found.rows if row.aspect == "topics")
    assert topics.before == topics.after == "5"
    ahead = next(row for row in found.rows if row.aspect == "drive ahead")
    assert float(ahead.before.split()[0]) == pytest.approx(0.9, abs=0.05)
    assert (tmp_path / "src/cart/package.xml").read_text() == CLASSIC["package.xml"]


CHANGES = {
    "half the radius": (
        "urdf/cart.urdf",
        "<wheel_radius>0.05</wheel_radius>",
        "<wheel_radius>0.025</wheel_radius>",
        ["drive ahead", "turn"],
    ),
    "other mass": ("urdf/cart.urdf", '<mass value="2"/>', '<mass value="2.5"/>', ["mass"]),
    "without its row": (
        "launch/sim.launch.py",
        "'/odom@nav_msgs/msg/Odometry[gz.msgs.Odometry',",
        "",
        ["topics", "/odom"],
    ),
    "a row in the other direction": (
        "launch/sim.launch.py",
        "Twist]gz.msgs.Twist",
        "Twist[gz.msgs.Twist",
        ["topics", "/cmd_vel (read)"],
    ),
    "another type": (
        "launch/sim.launch.py",
        "geometry_msgs/msg/Twist]",
        "geometry_msgs/msg/TwistStamped]",
        ["topics", "/cmd_vel (read)"],
    ),
    "another frame": (
        "urdf/cart.urdf",
        "<gz_frame_id>base</gz_frame_id>",
        "",
        ["topics", "/bot/scan"],
    ),
    "another frame of odometry": (
        "urdf/cart.urdf",
        "<child_frame_id>base</child_frame_id>",
        "",
        ["topics", "/odom", "/tf"],
    ),
    "a launch file that fails": (
        "launch/sim.launch.py",
        "get_package_share_directory('ros_gz_sim')",
        "get_package_share_directory('ros_gz_simulator')",
        ["launch file", "topics", "/clock"],
    ),
}


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Side:
    """The cart in Gazebo Classic, simulated once."""
    return measured(written(tmp_path_factory.mktemp("classic") / "cart", CLASSIC))


def measured(package: Path) -> Side:
    return measure(find_targets([package]), ENVIRONMENT, None, Clock("cart", None))


@pytest.mark.slow
@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_differs_is_named(
    tmp_path: Path, before: Side, change: tuple[str, str, str, list[str]]
) -> None:
    file, old, new, aspects = change
    assert old in PORTED[file]
    changed = {**PORTED, file: PORTED[file].replace(old, new)}
    rows = compare(before, measured(written(tmp_path / "cart", changed)))
    assert [row.aspect for row in rows if row.is_same is False] == aspects


@pytest.mark.slow
def test_before_is_the_newest_commit_for_classic(tmp_path: Path) -> None:
    package = written(tmp_path / "src" / "cart", CLASSIC)
    git(tmp_path, "init")
    (package / "elsewhere").symlink_to("/nowhere")
    for message, files in (
        (
            "For Gazebo Classic",
            {"urdf/cart.urdf": CLASSIC["urdf/cart.urdf"].replace('="2"', '="9"')},
        ),
        ("Lose weight", CLASSIC),
        ("Port the robot", {"urdf/cart.urdf": PORTED["urdf/cart.urdf"]}),
        ("Port the rest", PORTED),
        ("Describe it", {"README.txt": "It was for gazebo_ros once.\n"}),
    ):
        written(package, files)
        git(tmp_path, "add", "--all")
        git(tmp_path, "commit", "-m", message)
    found = prove_port(find_targets([package]), JAZZY, ENVIRONMENT, not_planned)
    lighter = git(tmp_path, "rev-parse", "HEAD~3")
    assert found.before == f"commit {lighter[:10]}"  # not that with half of the port
    assert found.passed


def not_planned() -> PortPlan:
    raise AssertionError("what is ported is not planned again")


def test_what_has_no_history_asks_for_it(tmp_path: Path) -> None:
    package = written(tmp_path / "cart", PORTED)
    with pytest.raises(RequestError, match=r"start Gazebo Sim already, and .* in no git") as caught:
        prove_port(find_targets([package]), JAZZY, ENVIRONMENT, not_planned)
    assert "--before FOLDER" in (caught.value.hint or "")
    git(tmp_path, "init")
    git(tmp_path, "add", "--all")
    git(tmp_path, "commit", "-m", "For Gazebo Sim from the start")
    with pytest.raises(RequestError, match=r"no commit of .* spawns a robot in Gazebo Classic"):
        prove_port(find_targets([package]), JAZZY, ENVIRONMENT, not_planned)


@pytest.mark.slow
def test_before_is_given(tmp_path: Path) -> None:
    before = written(tmp_path / "humble" / "cart", CLASSIC)
    after = written(tmp_path / "jazzy" / "cart", PORTED)
    found = prove_port(
        find_targets([after]), JAZZY, ENVIRONMENT, not_planned, before=find_targets([before])
    )
    assert found.passed
    assert found.before == "as given"


PLANAR = """<gazebo>
    <plugin name="move" filename="libgazebo_ros_planar_move.so">
      <odometry_frame>odom</odometry_frame><robot_base_frame>base</robot_base_frame>
    </plugin>
  </gazebo>"""
SLIPPERY = "".join(
    f'<gazebo reference="{side}"><mu1>0.01</mu1><mu2>0.01</mu2></gazebo>'
    for side in ("left", "right")
)
ON_PLANE = {**CLASSIC, "urdf/cart.urdf": URDF.format(plugins=f"{PLANAR}{SLIPPERY}")}
NODE = """
import rclpy
from geometry_msgs.msg import Twist


def go(publisher):
    message = Twist()
    message.linear.x, message.angular.z = 0.2, 0.3
    publisher.publish(message)


def main():
    rclpy.init()
    node = rclpy.create_node('mover')
    publisher = node.create_publisher(Twist, 'cmd_vel', 10)
    node.create_timer(0.05, lambda: go(publisher))
    rclpy.spin(node)
"""
SETUP = """
from glob import glob
from setuptools import setup

setup(
    name='cart',
    packages=['cart'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/cart']),
        ('share/cart', ['package.xml']),
        ('share/cart/launch', glob('launch/*')),
        ('share/cart/urdf', glob('urdf/*')),
    ],
    entry_points={'console_scripts': ['mover = cart.mover:main']},
)
"""
WITH_A_NODE = {
    **{name: text for name, text in CLASSIC.items() if name != "CMakeLists.txt"},
    "package.xml": CLASSIC["package.xml"].replace("ament_cmake", "ament_python"),
    "setup.py": SETUP,
    "setup.cfg": "[install]\ninstall_scripts=$base/lib/cart\n",
    "resource/cart": "",
    "cart/__init__.py": "",
    "cart/mover.py": NODE,
    "launch/sim.launch.py": CLASSIC["launch/sim.launch.py"].replace(
        "'-z', '0.05']),", "'-z', '0.05']),\n        Node(package='cart', executable='mover'),"
    ),
}


def on_circle(seconds: float, *, speed: float, turning: float) -> TimeSeries:
    """A robot that waits for a second, and then goes on a circle."""
    times = [number / 10 for number in range(round(seconds * 10) + 1)]
    places = [cmath.exp(1j * turning * max(0.0, time - 1)) * speed / turning for time in times]
    return TimeSeries(
        behavior="drive live",
        seconds=tuple(times),
        positions=tuple((place.real, place.imag, 0.1) for place in places),
        heading=0.0,
        speeds=(speed,) * len(times),
        tilts=(0.0,) * len(times),
        joint_positions={},
    )


@pytest.mark.slow
def test_other_drives_are_run_with_their_launch_file(tmp_path: Path) -> None:
    package = written(tmp_path / "src" / "cart", ON_PLANE)
    texts: list[str] = []

    def run_live(
        selected: SelectedLaunchFile,
        request: ValidateRequest,
        behavior_runs: Sequence[BehaviorRun],
    ) -> Mapping[str, LiveMeasurement]:
        texts.append(selected.file.read_text())
        (one,) = behavior_runs
        series = on_circle(one.behavior.seconds, speed=0.2, turning=0.4)
        assert request.samples == len(series.seconds) - 1
        return {one.behavior.name: LiveMeasurement(name=one.behavior.name, time_series=series)}

    clock = Clock("before", None)
    found = measure(find_targets([package]), ENVIRONMENT, None, clock, run_live)
    (text,) = texts
    assert "sim.launch.py')" in text
    assert "('/cmd_vel', 'geometry_msgs/Twist', '{linear: {x: 0.3}" in text
    x, y, yaw = found.robots[0].ways["drive live"]
    assert (x, y, yaw) == pytest.approx((0.8, 0.0, 1.6), rel=1e-2)

    def lacks(
        selected: SelectedLaunchFile,
        request: ValidateRequest,
        behavior_runs: Sequence[BehaviorRun],
    ) -> Mapping[str, LiveMeasurement]:
        raise NotFoundError("There is no ROS.", hint="Install it.")

    (robot,) = measure(find_targets([package]), ENVIRONMENT, None, clock, lacks).robots
    assert robot.ways == {}
    assert robot.problem_live == "There is no ROS."


@pytest.mark.slow
def test_own_nodes_that_drive_a_robot_do_it_after_the_port(tmp_path: Path) -> None:
    targets = find_targets([written(tmp_path / "src" / "cart", WITH_A_NODE)])
    plan = plan_port(targets, JAZZY, ENVIRONMENT)
    environment = {**os.environ, **ENVIRONMENT}
    found = prove_port(targets, JAZZY, environment, lambda: plan, run_live=run_live)
    assert [row for row in found.rows if not row.is_same] == []
    (way,) = (row for row in found.rows if row.aspect == "driven by its nodes")
    assert float(way.before.split()[0]) == pytest.approx(0.8, rel=0.05)


@pytest.mark.slow
def test_a_planar_drive_goes_the_same_way_after_the_port(tmp_path: Path) -> None:
    targets = find_targets([written(tmp_path / "src" / "cart", ON_PLANE)])
    plan = plan_port(targets, JAZZY, ENVIRONMENT)
    environment = {**os.environ, **ENVIRONMENT}
    found = prove_port(targets, JAZZY, environment, lambda: plan, run_live=run_live)
    assert [row for row in found.rows if not row.is_same] == []
    (way,) = (row for row in found.rows if row.aspect == "drive live")
    assert float(way.before.split()[0]) == pytest.approx(1.2, rel=0.05)


LOOP = """
def generate_launch_description():
    share = get_package_share_directory('cart')
    actions = [IncludeLaunchDescription(PythonLaunchDescriptionSource(os.path.join(
        get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')))]
    for name, x in (('one', '0'), ('two', '2')):
        spawn = Node(
            package='gazebo_ros', executable='spawn_entity.py',
            arguments=['-entity', name, '-file', os.path.join(share, 'urdf', 'cart.urdf'),
                       '-x', x, '-z', '0.05', '-robot_namespace', f'/{name}_space'])
        actions.append(spawn)
    return LaunchDescription(actions)
"""


@pytest.mark.slow
def test_several_robots_of_a_model_have_the_same_topics_after_the_port(tmp_path: Path) -> None:
    launch = f"{LAUNCH.partition('def ')[0]}{LOOP}"
    lumped = CLASSIC["urdf/cart.urdf"].replace(
        '<gazebo reference="base">', '<gazebo reference="ball">'
    )
    files = {**CLASSIC, "launch/sim.launch.py": launch, "urdf/cart.urdf": lumped}
    targets = find_targets([written(tmp_path / "src" / "cart", files)])
    plan = plan_port(targets, JAZZY, ENVIRONMENT)
    assert plan.unported == ()
    found = prove_port(targets, JAZZY, ENVIRONMENT, lambda: plan)
    assert {row.robot for row in found.rows} == {"one", "two"}
    assert [row for row in found.rows if not row.is_same] == []
    after = measure(targets, ENVIRONMENT, None, Clock("before", None)).robots[0].topics
    names = {one.name: one.frame for one in after}
    assert names == {
        "/clock": "",
        "/one_space/cmd_vel": "",
        "/one_space/odom": "odom → base",
        "/one_space/scan": "base",
        "/tf": "odom → base",
    }


def test_without_a_robot_there_is_nothing_to_compare(tmp_path: Path) -> None:
    launch = "raise KeyError('ROBOT')\n"
    package = written(tmp_path / "cart", {**PORTED, "launch/sim.launch.py": launch})
    with pytest.raises(RequestError, match=r"No launch file .* spawns a robot") as caught:
        prove_port(find_targets([package]), JAZZY, ENVIRONMENT, not_planned)
    assert "sim.launch.py: " in str(caught.value)


# What is compared of two robots, without simulating any.
SCAN = RosTopic("/scan", "sensor_msgs/LaserScan", is_published=True, frame="lidar")
BUMPER = RosTopic("/bumper", "gazebo_msgs/ContactsState", is_published=True, frame="world")
CART = Measured(
    package="cart",
    launch_file="sim.launch.py",
    entity="cart",
    links=frozenset(("base", "wheel")),
    joints=frozenset(("axle",)),
    mass=3.0,
    topics=frozenset((SCAN,)),
    rest=Pose((1.0, 2.0, 0.1)),
    ways={"drive ahead": (0.9, 0.0, 0.0), "turn": (0.0, 0.0, 1.5)},
)


def differing(old: Measured, new: Measured) -> list[tuple[Any, ...]]:
    """What differs, or cannot be compared."""
    found = compare(Side((old,), {}), Side((new,), {}))
    return [(row.aspect, row.before, row.after, row.is_same) for row in found if not row.is_same]


def driven(x: float, yaw: float) -> dict[str, Any]:
    return {"ways": {"drive ahead": (x, 0.0, 0.0), "turn": (0.0, 0.0, yaw)}}


CHANGED: dict[str, tuple[dict[str, Any], list[tuple[Any, ...]]]] = {
    "nothing": ({}, []),
    "3 mm": ({"rest": Pose((1.0, 2.003, 0.1))}, []),
    "6 mm": (
        {"rest": Pose((1.0, 2.006, 0.1))},
        [("rest pose", "1.000 2.000 0.100 m", "6.0 mm and 0.0° away", False)],
    ),
    "tilted": (
        {"rest": Pose((1.0, 2.0, 0.1), (0.0, 0.1, 0.0))},
        [("rest pose", "1.000 2.000 0.100 m", "0.0 mm and 5.7° away", False)],
    ),
    "not simulated": (
        {"rest": None, "problem": "A mesh is missing."},
        [("rest pose", "1.000 2.000 0.100 m", "not simulated: A mesh is missing.", False)],
    ),
    "another link": (
        {"links": frozenset(("base", "rim"))},
        [
            ("links", "2", "2", False),
            ("rim", "missing", "new", False),
            ("wheel", "there", "missing", False),
        ],
    ),
    "nearly the way": (driven(0.87, 1.44), []),
    "less than the way": (
        driven(0.85, 1.42),
        [
            ("drive ahead", "0.900 0.000 m, 0.000 rad", "0.850 0.000 m, 0.000 rad", False),
            ("turn", "0.000 0.000 m, 1.500 rad", "0.000 0.000 m, 1.420 rad", False),
        ],
    ),
    "not driven": (
        {"ways": {"turn": (0.0, 0.0, 1.5)}},
        [("drive ahead", "0.900 0.000 m, 0.000 rad", "not driven", False)],
    ),
    "a frame that is not known": ({"topics": frozenset((SCAN._replace(frame=""),))}, []),
    "another link of a sensor": (
        {"topics": frozenset((SCAN._replace(frame="base"),))},
        [
            ("topics", "1", "1", False),
            ("/scan", "frame lidar", "frame base", False),
        ],
    ),
    "one topic more": ({"topics": frozenset((SCAN, SCAN._replace(name="/scan/points")))}, []),
}


@pytest.mark.parametrize(("change", "expected"), CHANGED.values(), ids=CHANGED)
def test_bounds_of_what_is_the_same(
    change: dict[str, Any], expected: list[tuple[Any, ...]]
) -> None:
    assert differing(CART, replace(CART, **change)) == expected


def test_what_was_not_run_proves_nothing() -> None:
    lacking = replace(CART, ways={}, problem_live="There is no ROS.")
    assert differing(lacking, CART) == [("live run", "not run: There is no ROS.", "", None)]
    old, new = (replace(CART, ways={"drive live": (x, 0.0, 1.0)}) for x in (1.0, 0.9))
    way = "1.000 0.000 m, 1.000 rad"
    assert differing(old, new) == [("drive live", way, "0.900 0.000 m, 1.000 rad", False)]
    otherwise = replace(CART, ways={"turn": (0.0, 0.0, 1.0)})
    assert differing(old, otherwise) == [("drive live", way, "driven otherwise", None)]
    assert differing(old, lacking) == [
        ("drive live", way, "not driven: There is no ROS.", False),
    ]


@pytest.mark.parametrize(("is_repeated", "is_same"), [(True, False), (False, None)])
def test_nodes_that_differ_from_run_to_run_prove_nothing(
    is_repeated: bool, is_same: bool | None
) -> None:
    old, new = (
        replace(CART, ways={"driven by its nodes": (x, 0.0, 1.0)}, is_repeated=is_repeated)
        for x in (1.0, 0.9)
    )
    assert [row[3] for row in differing(old, new)] == [is_same]
    assert differing(old, old) == []


def test_what_was_not_simulated_proves_nothing() -> None:
    broken = replace(CART, rest=None, ways={}, problem="A mesh is missing.")
    assert differing(broken, CART) == [
        ("rest pose", "not simulated: A mesh is missing.", "1.000 2.000 0.100 m", None)
    ]


def test_contacts_have_another_type_in_gazebo_sim() -> None:
    new = BUMPER._replace(type="ros_gz_interfaces/Contacts", frame="")
    old, ported = (replace(CART, topics=frozenset((one,))) for one in (BUMPER, new))
    assert differing(old, ported) == []


def test_robots_of_several_launch_files_are_shown_once() -> None:
    worlds = [replace(CART, launch_file=f"{name}.launch.py") for name in ("a", "b", "c")]
    ported = [*worlds[:2], replace(worlds[2], **driven(0.5, 1.5))]
    found = compare(Side(tuple(worlds), {}), Side(tuple(ported), {}))
    assert {row.robot: row.is_same for row in found if row.aspect == "drive ahead"} == {
        "cart (a.launch.py and 1 more)": True,
        "cart (c.launch.py)": False,
    }


def _otherwise() -> tuple[Measured, ...]:
    """A robot with nothing of the name of the cart."""
    links = frozenset(("body", "wheel"))
    return (replace(CART, package="a", launch_file="a.launch.py", entity="a", links=links),)


def test_robots_of_other_names_are_found() -> None:
    old = (CART, replace(CART, launch_file="arm.launch.py", entity="arm"))
    new = (
        replace(CART, launch_file="arm_gz.launch.py", entity="arm"),
        replace(CART, launch_file="sim.launch.py", entity="buggy"),
    )
    found = compare(Side(old, {}), Side(new, {}))
    assert all(row.is_same for row in found)
    renamed = [row.aspect for row in compare(Side(old[:1], {}), Side(_otherwise(), {}))]
    assert renamed[:3] == ["links", "base", "body"]
    lost = [*compare(Side(old, {}), Side(new[:1], {"sim.launch.py": "It has an error."}))]
    assert lost[0] == Compared("cart", "robot", "sim.launch.py", "It has an error.", False)


@pytest.mark.slow
def test_the_port_of_wsgen_does_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    package = written(tmp_path / "src" / "cart", CLASSIC)
    assert wsgen.cli.run(["port", str(package), "--to", "jazzy", "--check"]) == 0
    shown = capsys.readouterr()
    assert "Before: as it is\n" in shown.out
    assert shown.out.endswith("\nThe robots do what they did before.\n")
    assert " after simulate  sim.launch.py " in shown.err
    assert {name: (package / name).read_text() for name in CLASSIC} == CLASSIC


@pytest.mark.slow
def test_differences_are_an_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = str(written(tmp_path / "humble" / "cart", CLASSIC))
    lighter = PORTED["urdf/cart.urdf"].replace('<mass value="2"/>', '<mass value="1"/>')
    after = str(written(tmp_path / "jazzy" / "cart", {**PORTED, "urdf/cart.urdf": lighter}))
    words = ["port", after, "--to", "jazzy", "--check", "--before", before]
    assert wsgen.cli.run([*words, "--quiet"]) == 1
    assert capsys.readouterr().out == "  cart  mass  3.1 kg  2.1 kg  different\n"
    assert wsgen.cli.run([*words, "--quiet", "--format", "json"]) == 1
    (robot,) = json.loads(capsys.readouterr().out)["robots"]
    found = {one["aspect"]: (one["same"], one["difference"]) for one in robot["aspects"]}
    assert found["mass"] == (False, None)
    assert found["rest pose"][1] is not None
    assert all(found[drive][1] is not None for drive in DRIVES)


@pytest.mark.parametrize(
    ("options", "hint"),
    [
        (("--before", "."), "Add --check, or omit --before."),
        (("--check", "--diff"), "Omit --check, or the other option."),
        (("--check", "--force"), "Omit --check, or the other option."),
    ],
)
def test_options_without_effect(
    options: tuple[str, ...], hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert wsgen.cli.run(["port", "--to", "jazzy", *options]) == EXIT_REQUEST
    assert hint in capsys.readouterr().err


@pytest.mark.slow
def test_a_world_that_another_launch_file_starts_is_the_same(tmp_path: Path) -> None:
    """Without it, the ground would be that of Gazebo Classic's default world before."""
    include = re.compile(r"^ {8}IncludeLaunch.*?(?=^ {8}Node)", re.MULTILINE | re.DOTALL)
    sides = []
    for name, files in (("humble", CLASSIC), ("jazzy", PORTED)):
        launch, count = include.subn("", files["launch/sim.launch.py"])
        assert count == 1
        robot = files["urdf/cart.urdf"].replace(">0.01</mu", ">1.5</mu")  # the ball brakes
        changed = {**files, "launch/sim.launch.py": launch, "urdf/cart.urdf": robot}
        sides.append(measured(written(tmp_path / name / "cart", changed)))
    rows = [*compare(*sides)]
    ways = {row.aspect: row.after for row in rows if row.aspect in DRIVES}
    assert [row.aspect for row in rows if row.is_same is False] == []
    assert ways.keys() == DRIVES.keys()
