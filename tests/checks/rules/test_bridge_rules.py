"""What bridges are given and connect, from plans, YAML and descriptions alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.bridges import BOTH, FROM_GZ, TO_GZ, Bridge, check_bridges, find_bridges
from wsgen.checks.rules.node_topics import topics_of
from wsgen.descriptions.sdf.source import read_document
from wsgen.model.plan import Include, LaunchPlan, Process, Unresolved

LASER = "/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan"
ROBOT = """
<robot name="r">
  <gazebo>
    <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
      <topic>cmd_vel</topic>
    </plugin>
    <plugin filename="gz-sim-joint-state-publisher-system"
      name="gz::sim::systems::JointStatePublisher"/>
  </gazebo>
  <gazebo reference="l">
    <sensor name="lidar" type="gpu_lidar"><topic>scan</topic></sensor>
    <sensor name="imu" type="imu"/>
    <sensor name="eye" type="camera"><topic>/eye/image</topic></sensor>
    <sensor name="own" type="custom"/>
  </gazebo>
</robot>
"""
MODEL = '<model name="m"><link name="l"><sensor name="s" type="imu"/></link></model>'


def plan(
    *processes: Process, includes: tuple[Include, ...] = (), file: str = "r.launch.py"
) -> LaunchPlan:
    return LaunchPlan(
        package="p",
        launch_file=Path(file),
        processes=processes,
        includes=includes,
        unresolved=(Unresolved(what="own", why=""),),
    )


def bridge_of(*words: str, **parameters: object) -> Process:
    return Process(
        package="ros_gz_bridge",
        executable="parameter_bridge",
        arguments=words,
        parameters=parameters,
        remappings=(("/scan", "/laser"),),
        file=Path("r.launch.py"),
        line=4,
    )


def known() -> list:  # type: ignore[type-arg]  # of topics
    root, _ = read_document(ROBOT)
    assert root is not None
    return list(topics_of(root, "r", "office"))


def check(
    gz_topic: str,
    types: str,
    *,
    world: str | None = "office",
    models: tuple[str, ...] | None = ("r",),
) -> list[str]:
    found = find_bridges(plan(bridge_of(f"{gz_topic}@{types}")))
    assert not found.diagnostics
    return [one.name for one in check_bridges(found.topics, known(), world=world, models=models)]


def test_a_bridge_without_topics() -> None:
    (found,) = find_bridges(plan(bridge_of())).diagnostics
    assert found.code == "LCH072"
    assert "config_file" in (found.hint or "")
    assert not find_bridges(plan(bridge_of(bridge_names=["a"]))).diagnostics
    assert not find_bridges(plan(bridge_of("--ros-args", "--params-file", "a"))).diagnostics


def test_bridges_are_read() -> None:
    found = find_bridges(plan(bridge_of(LASER, "/a@std_msgs/msg/String]gz.msgs.StringMsg")))
    assert found.topics[0] == Bridge(
        "/scan",
        "/laser",
        "sensor_msgs/msg/LaserScan",
        "gz.msgs.LaserScan",
        FROM_GZ,
        Path("r.launch.py"),
        4,
    )
    assert found.topics[1].direction == TO_GZ
    assert found.published == ("/laser",)
    both = find_bridges(plan(bridge_of("a@std_msgs/msg/String@gz.msgs.StringMsg", "--ros-args")))
    assert both.topics[0].direction == BOTH
    service = "/world/w/control@ros_gz_interfaces/srv/ControlWorld"
    assert find_bridges(plan(bridge_of(service))) == ((), (), True)
    assert find_bridges(plan(Process(package="own", executable="parameter_bridge"))).are_all
    for unknown in (
        bridge_of("$(own)"),
        bridge_of(config_file="$(own)"),
        bridge_of(config_file="/no/such/file.yaml"),
        bridge_of(expand_gz_topic_names=True),
    ):
        assert find_bridges(plan(unknown)).published is None


@pytest.mark.parametrize(
    "word",
    ["/scan", "/scan@sensor_msgs/msg/LaserScan", "/a@b/msg/C@d@e", "/a@b/msg/C[", "@b/msg/C[d"],
)
def test_arguments_that_are_no_topics(word: str) -> None:
    (found,) = find_bridges(plan(bridge_of(word))).diagnostics
    assert (found.name, found.line, found.element) == ("invalid-bridge", 4, word)


def test_the_line_of_an_argument_is_found(tmp_path: Path) -> None:
    file = tmp_path / "r.launch.py"
    file.write_text("Node(\n arguments=[\n  '/scan'])\n")
    node = Process(
        package="ros_gz_bridge",
        executable="parameter_bridge",
        arguments=("/scan'",),
        file=file,
        line=1,
    )
    (found,) = find_bridges(plan(node)).diagnostics
    assert found.line == 3


@pytest.mark.parametrize(
    "types",
    [
        "std_msgs/String[gz.msgs.StringMsg",
        "sensor_msgs/msg/Imu[gz.msgs.Imu",
        "sensor_msgs/msg/LaserScan[gz.msgs.IMU",
        "sensor_msgs/msg/LaserScn[gz.msgs.LaserScan",
        "sensor_msgs::msg::LaserScan[gz.msgs.LaserScan",
        "sensor_msgs/msg/LaserScan[gz::msgs::LaserScan",
        "sensor_msgs/msg/LaserScan[ignition.msgs.LaserScn",
    ],
)
def test_types_that_do_not_exist(types: str) -> None:
    assert check("/topic", types) == ["unknown-bridge-type"]


@pytest.mark.parametrize(
    "types",
    [
        "sensor_msgs/msg/Imu[gz.msgs.IMU",
        "sensor_msgs/msg/Imu[ignition.msgs.IMU",
        "own_msgs/msg/Wheels[gz.msgs.Wheels",
        "own_msgs/msg/Wheels[own.msgs.Wheels",
        "sensor_msgs/msg/Imu[gz.msgs.NewInSomeRelease",
        "nav_msgs/msg/Odometry[gz.msgs.OdometryWithCovariance",
    ],
)
def test_types_that_exist(types: str) -> None:
    assert check("/topic", types) == []


@pytest.mark.parametrize(
    ("topic", "types", "name"),
    [
        ("/clock", "rosgraph_msgs/msg/Clock]gz.msgs.Clock", "wrong-bridge-direction"),
        ("cmd_vel", "geometry_msgs/msg/Twist[gz.msgs.Twist", "wrong-bridge-direction"),
        ("/scan", "sensor_msgs/msg/LaserScan]gz.msgs.LaserScan", "wrong-bridge-direction"),
        ("/scan", "sensor_msgs/msg/Image[gz.msgs.Image", "other-bridge-type"),
        ("/scn", "sensor_msgs/msg/LaserScan[gz.msgs.LaserScan", "unknown-bridge-topic"),
        # The only lidar has another topic.
        ("/lidar", "sensor_msgs/msg/LaserScan[gz.msgs.LaserScan", "unknown-bridge-topic"),
        (
            "/world/empty/model/r/joint_state",
            "sensor_msgs/msg/JointState[gz.msgs.Model",
            "unknown-bridge-topic",
        ),
        ("/model/q/odometry", "nav_msgs/msg/Odometry[gz.msgs.Odometry", "unknown-bridge-topic"),
        ("/model/r/odom", "nav_msgs/msg/Odometry[gz.msgs.Odometry", "unknown-bridge-topic"),
    ],
)
def test_what_bridges_do_not_connect(topic: str, types: str, name: str) -> None:
    assert check(topic, types) == [name]


@pytest.mark.parametrize(
    ("topic", "types"),
    [
        ("/clock", "rosgraph_msgs/msg/Clock[gz.msgs.Clock"),
        ("/clock", "rosgraph_msgs/msg/Clock@gz.msgs.Clock"),
        ("cmd_vel", "geometry_msgs/msg/Twist]gz.msgs.Twist"),
        ("/model/r/odometry", "nav_msgs/msg/Odometry[gz.msgs.Odometry"),
        ("/world/office/model/r/joint_state", "sensor_msgs/msg/JointState[gz.msgs.Model"),
        ("/scan/points", "sensor_msgs/msg/PointCloud2[gz.msgs.PointCloudPacked"),
        ("/eye/camera_info", "sensor_msgs/msg/CameraInfo[gz.msgs.CameraInfo"),
        (
            "/world/office/model/r/link/base/sensor/imu/imu",
            "sensor_msgs/msg/Imu[gz.msgs.IMU",
        ),
        ("/own/topic", "std_msgs/msg/String]gz.msgs.StringMsg"),
    ],
)
def test_what_bridges_connect(topic: str, types: str) -> None:
    assert check(topic, types) == []


def test_what_is_not_known_is_not_compared() -> None:
    lidar = "sensor_msgs/msg/LaserScan[gz.msgs.LaserScan"
    assert check("/lidar", lidar, world=None, models=None) == []
    types = "sensor_msgs/msg/JointState[gz.msgs.Model"
    assert check("/world/empty/model/q/other", types, world=None, models=None) == []
    root, _ = read_document(ROBOT)
    assert root is not None
    assert "/model/r/odometry" not in {one.name for one in topics_of(root, None, None)}


def test_sensors_of_sdf_have_default_topics() -> None:
    root, _ = read_document(MODEL)
    assert root is not None
    assert [one.name for one in topics_of(root, "r", "w")] == [
        "/world/w/model/r/link/l/sensor/s/imu"
    ]


ENTRY = """\
- ros_topic_name: scan
  gz_topic_name: /scan
  ros_type_name: sensor_msgs/msg/LaserScan
  gz_type_name: gz.msgs.LaserScan
  direction: GZ_TO_ROS
"""


def test_files_of_bridges_are_read(tmp_path: Path) -> None:
    file = tmp_path / "bridge.yaml"
    file.write_text(ENTRY + "- topic_name: clock\n  ros_type_name: a\n  gz_type_name: b\n")
    found = find_bridges(plan(bridge_of(config_file=str(file))))
    assert found.published == ("scan", "clock")
    on_command_line = bridge_of("--ros-args", "-p", f"config_file:={file}")
    assert find_bridges(plan(on_command_line)).topics == found.topics
    assert [(one.gz_topic, one.line, one.direction) for one in found.topics] == [
        ("/scan", 1, FROM_GZ),
        ("clock", 6, BOTH),
    ]
    include = Include(
        package="ros_gz_bridge",
        file=Path("ros_gz_bridge.launch.py"),
        arguments={"config_file": str(file)},
        evaluated=False,
    )
    assert find_bridges(plan(includes=(include,))).topics == found.topics


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: 1\n", 1, "is not a list"),
        (ENTRY.replace("gz_type_name", "gz_type"), 1, "has no `gz_type_name`"),
        (ENTRY.replace("gz_type_name", "gz_typ_name"), 4, "ignores the key `gz_typ_name`"),
        (ENTRY.replace("GZ_TO_ROS", "gz_to_ros"), 1, "`gz_to_ros` is not a direction"),
        (ENTRY.replace("GZ_TO_ROS", "IGN_TO_ROS"), 1, "`IGN_TO_ROS` is not a direction"),
        (ENTRY.replace("GZ_TO_ROS", "out"), 1, "`out` is not a direction"),
        (ENTRY + "  topic_name: scan\n", 1, "exclude each other"),
        ("- ros_type_name: a\n  gz_type_name: b\n", 1, "has no topic"),
    ],
)
def test_entries_that_bridges_cannot_use(tmp_path: Path, text: str, line: int, words: str) -> None:
    file = tmp_path / "bridge.yaml"
    file.write_text(text)
    found = find_bridges(plan(bridge_of(config_file=str(file)))).diagnostics
    assert {one.name for one in found} == {"invalid-bridge-entry"}
    assert any(words in one.message and one.line == line for one in found)


def test_a_file_that_is_not_yaml(tmp_path: Path) -> None:
    file = tmp_path / "bridge.yaml"
    file.write_text('- ros_topic_name: "scan"\n\tgz_topic_name: "scan"\n')
    (found,) = find_bridges(plan(bridge_of(config_file=str(file)))).diagnostics
    assert (found.code, found.severity.value, found.line) == ("LCH099", "error", 2)
