"""What the simulator's plugins command, and what they publish."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.fake_ros import ROVER, live_scene, plugin, rover_engine, simulation_of, still_at
from live.nodes.gz_bridge import bridged
from live.nodes.sensor_messages import install_sensor_messages
from wsgen.checks.rules.bodies import DRAGGING_CASTER
from wsgen.model.robot import Surface
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from live.nodes.fake_ros import FakeRos

pytestmark = pytest.mark.usefixtures("messages")

WHEELS = "<left_joint>left</left_joint><right_joint>right</right_joint>"
CLASSIC = (
    f"{WHEELS}<wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter>"
    "<publish_odom>true</publish_odom><publish_odom_tf>true</publish_odom_tf>"
)
GZ = f"{WHEELS}<wheel_separation>0.4</wheel_separation><wheel_radius>0.1</wheel_radius>"


def turning(seconds: float) -> dict[str, float]:
    """Wheels that drive 0.5 m/s and turn 0.25 rad/s."""
    return {"left": 4.5 * seconds, "right": 5.5 * seconds}


def spawned(*plugins: Any, simulator: str = "classic", engine: Any = None) -> tuple[Any, FakeRos]:
    simulation, ros = simulation_of(live_scene(*plugins, simulator=simulator), engine)
    simulation.spawn("rover")
    return simulation, ros


def twist(x: float = 0.0, y: float = 0.0, turn: float = 0.0) -> Any:
    from geometry_msgs.msg import Twist  # noqa: PLC0415

    made = Twist()
    made.linear.x, made.linear.y, made.angular.z = x, y, turn
    return made


def test_a_diff_drive_of_classic_turns_the_wheels() -> None:
    drive = plugin("libgazebo_ros_diff_drive.so", CLASSIC)
    simulation, ros = spawned(drive)
    ros.send("/cmd_vel", twist(0.5, turn=0.25))
    simulation.advance(0.02)
    left, right = (simulation.engine.motors["rover"][name] for name in ("left", "right"))
    assert (left.speed, right.speed) == pytest.approx((4.5, 5.5))
    assert left.effort == right.effort == 5.0
    simulation.advance(2.0)  # the last command holds
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(4.5)
    simulation.reset(with_time=True)
    simulation.advance(0.02)
    assert simulation.engine.motors["rover"]["left"].speed == 0.0


def test_the_acceleration_of_classic_has_a_bound() -> None:
    content = f"{CLASSIC}<max_wheel_acceleration>1.0</max_wheel_acceleration>"
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", content))
    simulation.advance(0.02)
    ros.send("/cmd_vel", twist(0.5))
    simulation.advance(0.12)
    # A tenth of a second at 1 m/s², of wheels whose radius is 0.1 m.
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(1.0)


def test_what_a_diff_drive_of_classic_publishes_of_the_world() -> None:
    engine = rover_engine(still_at(1.0, 2.0, math.pi / 2))
    engine.velocity = ((0.0, 0.5, 0.0), (0.0, 0.0, 0.3))
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", CLASSIC), engine=engine)
    simulation.advance(0.5)
    found = ros.published("/odom")
    assert len(found) == 50  # 100 Hz
    message = found[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_footprint")
    assert message.header.stamp.nanosec == 490_000_000
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    assert (position.x, position.y, position.z) == pytest.approx((1.0, 2.0, 0.1))
    assert (turn.z, turn.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    assert message.twist.twist.linear.x == pytest.approx(0.5)
    assert message.twist.twist.linear.y == pytest.approx(0.0)
    assert message.twist.twist.angular.z == pytest.approx(0.3)
    diagonal = [message.pose.covariance[place] for place in range(0, 36, 7)]
    assert diagonal == [1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3]
    (transform,) = ros.published("/tf")[-1].transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_footprint")
    assert transform.transform.translation.y == pytest.approx(2.0)


def test_what_a_diff_drive_of_classic_publishes_of_its_wheels() -> None:
    content = (
        f"<ros><namespace>/a</namespace><remapping>odom:=wheels</remapping></ros>{CLASSIC}"
        "<odometry_source>0</odometry_source><update_rate>50</update_rate>"
        "<odometry_frame>o</odometry_frame><robot_base_frame>b</robot_base_frame>"
        "<publish_wheel_tf>true</publish_wheel_tf><covariance_x>0.5</covariance_x>"
    )
    engine = rover_engine(still_at(3.0), positions=turning)
    drive = plugin("libgazebo_ros_diff_drive.so", content, name="drive")
    simulation, ros = spawned(drive, engine=engine)
    simulation.advance(1.001)
    found = ros.published("/a/wheels")
    assert len(found) == 51
    message = found[-1]
    assert message.pose.pose.position.x == pytest.approx(2.0 * math.sin(0.25))
    assert message.pose.pose.position.y == pytest.approx(2.0 * (1 - math.cos(0.25)))
    assert message.twist.twist.linear.x == pytest.approx(0.5)
    assert message.twist.twist.angular.z == pytest.approx(0.25)
    assert message.pose.covariance[0] == 0.5
    wheels, odometry = ros.published("/tf")[-2:]
    assert odometry.transforms[0].child_frame_id == "b"
    assert [one.child_frame_id for one in wheels.transforms] == ["left_wheel", "right_wheel"]
    assert {one.header.frame_id for one in wheels.transforms} == {"base"}
    assert ros.nodes[-1].name == "drive"


def test_nobody_who_listens_costs_nothing() -> None:
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", CLASSIC))
    for publisher in ros.nodes[-1].publishers.values():
        publisher.subscribers = 0
    simulation.advance(0.5)
    assert not ros.published("/odom")
    assert not ros.published("/tf")


@pytest.mark.parametrize(
    ("number", "named"),
    [(math.nan, "NaN"), (math.inf, "NaN"), (1e5, "more than 10000 m/s"), (-1e300, "more than")],
)
def test_commands_that_no_engine_can_compute_with_are_named_and_ignored(
    number: float, named: str
) -> None:
    simulation, ros = spawned(
        plugin("libgazebo_ros_diff_drive.so", CLASSIC), plugin("libgazebo_ros_planar_move.so")
    )
    ros.send("/cmd_vel", twist(0.5))
    ros.send("/cmd_vel", twist(number))
    ros.send("/cmd_vel", twist(0.0, turn=number))
    simulation.advance(0.1)
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(5.0)
    (warning,) = ros.warnings
    assert "/cmd_vel" in warning
    assert named in warning


def test_a_speed_that_no_joint_can_have_is_named_and_stops_it() -> None:
    """It may come from a twist that is possible, and from wheels that are small."""
    content = (
        f"{WHEELS}<wheel_separation>0.4</wheel_separation><wheel_diameter>0.02</wheel_diameter>"
    )
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", content))
    ros.send("/cmd_vel", twist(1e3))
    simulation.advance(0.1)
    assert simulation.engine.motors["rover"]["left"].speed == 0.0
    assert len(ros.warnings) == 2  # one for each wheel
    assert "`left` is commanded a speed of more than 10000 rad/s or m/s" in ros.warnings[0]
    ros.send("/cmd_vel", twist(0.1))
    simulation.advance(0.2)
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(10.0)


@pytest.mark.parametrize(("effort", "warnings"), [(1e12, 1), (math.nan, 0)])
def test_an_effort_that_no_joint_can_have_is_none(effort: float, warnings: int) -> None:
    """Controllers compute not-a-number of robots that have exploded: these are named by then."""
    simulation, ros = spawned()
    robot = simulation.host.robots["rover"]
    robot.set_efforts({"left": effort, "right": 3.0})
    assert simulation.engine.efforts["rover"] == {"left": 0.0, "right": 3.0}
    assert len(ros.warnings) == warnings
    assert all(
        "`left` is commanded an effort of more than 1e+09 N m or N" in one for one in ros.warnings
    )


def test_a_motor_is_set_when_it_changes_alone() -> None:
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", CLASSIC))
    calls: list[dict[str, Any]] = []
    drive = simulation.engine.drive

    def counted(entity: str, motors: dict[str, Any]) -> None:
        calls.append(motors)
        drive(entity, motors)

    simulation.engine.drive = counted
    ros.send("/cmd_vel", twist(0.5))
    simulation.advance(0.5)
    robot = simulation.host.robots["rover"]
    robot.release(["left"])
    simulation.advance(0.6)
    assert [sorted(motors) for motors in calls] == [["left", "right"], ["left"]]


def test_several_pairs_of_wheels() -> None:
    more = "<num_wheel_pairs>2</num_wheel_pairs><wheel_separation>0.4</wheel_separation>"
    content = f"{WHEELS}{WHEELS}{more}<wheel_diameter>0.2</wheel_diameter>"
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", content))
    ros.send("/cmd_vel", twist(0.3))
    simulation.advance(0.02)
    # The second pair has the default diameter of 0.15 m.
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("", "0 left and 0 right joints for 1 pairs"),
        (f"{WHEELS}<num_wheel_pairs>2</num_wheel_pairs>", "for 2 pairs of wheels"),
        (
            f"{WHEELS}<wheel_diameter>0</wheel_diameter>",
            "<wheel_diameter> of its diff drive plugin is 0",
        ),
        (f"{WHEELS}<publish_odom>yes</publish_odom>", "Write true or false"),
        (f"{WHEELS}<covariance_x>nan</covariance_x>", "its <covariance_x> is `nan`"),
    ],
)
def test_drives_that_cannot_work(content: str, problem: str) -> None:
    simulation, ros = spawned(plugin("libgazebo_ros_diff_drive.so", content))
    simulation.advance(0.1)
    assert problem in ros.warnings[0]


def test_a_diff_drive_of_gazebo_sim() -> None:
    engine = rover_engine(positions=turning)
    drive = plugin("gz-sim-diff-drive-system", GZ)
    simulation, ros = spawned(drive, simulator="gz", engine=engine)
    bridged(
        ros,
        simulation,
        ("/cmd_vel", "/model/rover/cmd_vel", "geometry_msgs/msg/Twist", "Twist"),
        ("/odom", "/model/rover/odometry", "nav_msgs/msg/Odometry", "Odometry"),
        ("/tf", "/model/rover/tf", "tf2_msgs/msg/TFMessage", "Pose_V"),
        ("/enable", "/model/rover/enable", "std_msgs/msg/Bool", "Boolean"),
    )
    ros.send("/cmd_vel", twist(0.5, turn=0.25))
    simulation.advance(1.001)
    assert engine.motors["rover"]["right"].speed == pytest.approx(5.5)
    found = ros.published("/odom")
    assert len(found) == 51  # 50 Hz
    message = found[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("rover/odom", "rover/base")
    assert message.pose.pose.position.x == pytest.approx(2.0 * math.sin(0.25))
    assert message.twist.twist.linear.x == pytest.approx(0.5)
    (transform,) = ros.published("/tf")[-1].transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("rover/odom", "rover/base")
    from std_msgs.msg import Bool  # noqa: PLC0415

    ros.send("/enable", Bool(data=False))
    ros.send("/cmd_vel", twist(0.5))
    simulation.advance(1.05)
    assert engine.motors["rover"]["right"].speed == pytest.approx(0.0)


def test_limits_and_names_of_a_diff_drive_of_gazebo_sim() -> None:
    content = (
        f"{GZ}<topic>go</topic><max_linear_acceleration>1</max_linear_acceleration>"
        "<max_velocity>0.3</max_velocity><frame_id>odom</frame_id>"
        "<child_frame_id>base_link</child_frame_id><odom_topic>/o</odom_topic>"
    )
    simulation, ros = spawned(plugin("gz-sim-diff-drive-system", content), simulator="gz")
    bridged(
        ros,
        simulation,
        ("/go", "/go", "geometry_msgs/msg/Twist", "Twist"),
        ("/o", "/o", "nav_msgs/msg/Odometry", "Odometry"),
    )
    simulation.advance(0.095)
    ros.send("/go", twist(2.0))
    simulation.advance(0.195)
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(1.0)
    simulation.advance(1.0)
    assert simulation.engine.motors["rover"]["left"].speed == pytest.approx(3.0)
    message = ros.published("/o")[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")


def test_joint_states_of_classic() -> None:
    states = plugin(
        "libgazebo_ros_joint_state_publisher.so",
        "<joint_name>right</joint_name><joint_name>arm</joint_name>",
    )
    simulation, ros = spawned(states, engine=rover_engine(positions=turning))
    simulation.advance(0.101)
    found = ros.published("/joint_states")
    assert len(found) == 11  # 100 Hz
    assert (found[-1].name, found[-1].position) == (["right"], [pytest.approx(0.55)])
    assert found[-1].velocity == [pytest.approx(5.5)]
    assert found[-1].effort == []
    assert "the joint `arm`" in ros.warnings[0]


def test_joint_states_of_gazebo_sim() -> None:
    states = plugin("gz-sim-joint-state-publisher-system", "<update_rate>10</update_rate>")
    simulation, ros = spawned(states, simulator="gz", engine=rover_engine(positions=turning))
    topic = "/world/w/model/rover/joint_state"
    bridged(ros, simulation, ("/js", topic, "sensor_msgs/msg/JointState", "Model"))
    simulation.advance(0.25)
    message = ros.published("/js")[-1]
    assert message.header.stamp.nanosec == 200_000_000
    assert (message.name, message.effort) == (["left", "right"], [0.0, 0.0])
    assert message.position == pytest.approx([0.9, 1.1])


def test_joint_states_of_gazebo_sim_are_in_the_order_of_its_joints() -> None:
    names = "<joint_name>right</joint_name><joint_name>left</joint_name>"
    states = plugin("gz-sim-joint-state-publisher-system", names)
    simulation, ros = spawned(states, simulator="gz", engine=rover_engine(positions=turning))
    topic = "/world/w/model/rover/joint_state"
    bridged(ros, simulation, ("/js", topic, "sensor_msgs/msg/JointState", "Model"))
    simulation.advance(0.25)
    assert ros.published("/js")[-1].name == ["left", "right"]


def test_planar_move() -> None:
    engine = rover_engine(still_at(yaw=math.pi / 2))
    engine.velocity = ((0.0, 0.4, 0.0), (0.0, 0.0, 0.0))
    move = plugin("libgazebo_ros_planar_move.so", "<update_rate>100</update_rate>")
    simulation, ros = spawned(move, engine=engine)
    ros.send("/cmd_vel", twist(0.4, 0.1, turn=1.0))
    simulation.advance(0.201)
    linear, angular = engine.velocities["rover"]
    assert linear == pytest.approx((-0.1, 0.4, 0.0))
    assert angular == (0.0, 0.0, 1.0)
    found = ros.published("/odom")
    assert len(found) == 5  # 20 Hz
    assert found[-1].twist.twist.linear.x == pytest.approx(0.4)
    assert ros.published("/tf")[-1].transforms[0].child_frame_id == "base_footprint"


def test_velocity_control() -> None:
    engine = rover_engine(still_at(yaw=math.pi / 2))
    content = "<initial_linear>0.5 0 0</initial_linear>"
    control = plugin("gz-sim-velocity-control-system", content)
    simulation, ros = spawned(control, simulator="gz", engine=engine)
    simulation.advance(0.01)
    assert engine.velocities["rover"][0] == pytest.approx((0.0, 0.5, 0.0))
    bridged(ros, simulation, ("/v", "/model/rover/cmd_vel", "geometry_msgs/msg/Twist", "Twist"))
    ros.send("/v", twist(y=0.2))
    simulation.advance(0.02)
    assert engine.velocities["rover"][0] == pytest.approx((-0.2, 0.0, 0.0))


def test_the_odometry_publisher_of_gazebo_sim() -> None:
    engine = rover_engine(still_at(1.0, 2.0, math.pi / 2))
    engine.velocity = ((-0.3, 0.5, 0.1), (0.0, 0.0, 2.0))
    content = "<xyz_offset>0.1 0 0</xyz_offset>"
    odometry = plugin("gz-sim-odometry-publisher-system", content)
    simulation, ros = spawned(odometry, simulator="gz", engine=engine)
    model = "/model/rover"
    bridged(
        ros,
        simulation,
        ("/odom", f"{model}/odometry", "nav_msgs/msg/Odometry", "Odometry"),
        (
            "/c",
            f"{model}/odometry_with_covariance",
            "nav_msgs/msg/Odometry",
            "OdometryWithCovariance",
        ),
        ("/tf", f"{model}/pose", "tf2_msgs/msg/TFMessage", "Pose_V"),
    )
    simulation.advance(0.1)
    message = ros.published("/odom")[-1]
    assert (message.header.frame_id, message.child_frame_id) == (
        "rover/odom",
        "rover/base_footprint",
    )
    position, speed = message.pose.pose.position, message.twist.twist.linear
    assert (position.x, position.y, position.z) == pytest.approx((1.0, 2.1, 0.0))
    # Ahead is y; the point 0.1 m ahead moves to the left as the robot turns.
    assert (speed.x, speed.y, speed.z) == pytest.approx((0.5, 0.5, 0.0))
    assert message.twist.twist.angular.z == pytest.approx(2.0)
    assert ros.published("/c")[-1].pose.pose.position.y == pytest.approx(2.1)
    assert ros.published("/tf")[-1].transforms[0].child_frame_id == "rover/base_footprint"


def test_ground_truth_of_classic() -> None:
    engine = rover_engine(still_at(1.0, 2.0))
    engine.velocity = ((0.3, 0.5, 0.1), (0.0, 0.0, 2.0))
    content = "<body_name>base</body_name><update_rate>50</update_rate>"
    simulation, ros = spawned(
        plugin("libgazebo_ros_p3d.so", f"{content}<xyz_offset>0 0 1</xyz_offset>"),
        plugin("libgazebo_ros_p3d.so", "<body_name>lidar</body_name>"),
        engine=engine,
    )
    simulation.advance(0.101)
    found = ros.published("/odom")
    assert len(found) == 6
    message = found[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("world", "base")
    position, speed = message.pose.pose.position, message.twist.twist.linear
    assert (position.x, position.y, position.z) == pytest.approx((1.0, 2.0, 1.1))
    assert (speed.x, speed.y, speed.z) == pytest.approx((0.3, 0.5, 0.1))
    assert "no link `lidar` in Gazebo" in ros.warnings[0]


def test_noise_is_the_same_in_each_run() -> None:
    content = "<body_name>base</body_name><gaussian_noise>0.1</gaussian_noise>"
    seen = []
    for _ in range(2):
        simulation, ros = spawned(plugin("libgazebo_ros_p3d.so", content))
        simulation.advance(0.3)
        seen.append([one.twist.twist.linear.x for one in ros.published("/odom")])
    assert seen[0] == seen[1]
    deviation = math.sqrt(sum(value**2 for value in seen[0]) / len(seen[0]))
    assert deviation == pytest.approx(0.1, rel=0.2)


def test_poses_of_gazebo_sim() -> None:
    content = (
        "<use_pose_vector_msg>true</use_pose_vector_msg><update_frequency>10</update_frequency>"
        "<publish_model_pose>true</publish_model_pose>"
    )
    poses = plugin("gz-sim-pose-publisher-system", content)
    engine = rover_engine(still_at(1.0))
    simulation, ros = spawned(poses, simulator="gz", engine=engine)
    bridged(ros, simulation, ("/p", "/model/rover/pose", "tf2_msgs/msg/TFMessage", "Pose_V"))
    simulation.advance(0.15)
    model, *links = ros.published("/p")[-1].transforms
    assert (model.header.frame_id, model.child_frame_id) == ("w", "rover")
    assert model.transform.translation.x == pytest.approx(1.0)
    assert [link.child_frame_id for link in links] == [
        "rover/base",
        "rover/left_wheel",
        "rover/right_wheel",
    ]
    assert links[0].transform.translation.x == pytest.approx(0.0)


def test_single_poses_of_gazebo_sim() -> None:
    """Without <use_pose_vector_msg> each pose is a message, as gz.msgs.Pose."""
    poses = plugin("gz-sim-pose-publisher-system", "<update_frequency>10</update_frequency>")
    simulation, ros = spawned(poses, simulator="gz", engine=rover_engine(still_at(1.0)))
    topic = "/model/rover/pose"
    bridged(ros, simulation, ("/t", topic, "geometry_msgs/msg/TransformStamped", "Pose"))
    bridged(ros, simulation, ("/p", topic, "geometry_msgs/msg/PoseStamped", "Pose"))
    simulation.advance(0.05)
    assert [one.child_frame_id for one in ros.published("/t")] == [
        "rover/base",
        "rover/left_wheel",
        "rover/right_wheel",
    ]
    assert [one.header.frame_id for one in ros.published("/p")] == ["rover"] * 3


def test_static_poses_of_gazebo_sim() -> None:
    """What joints move is on the one topic, all else on the other one."""
    content = (
        "<use_pose_vector_msg>true</use_pose_vector_msg><static_publisher>true</static_publisher>"
        "<publish_model_pose>true</publish_model_pose><update_frequency>10</update_frequency>"
        "<static_update_frequency>2</static_update_frequency><topic>/where</topic>"
    )
    poses = plugin("gz-sim-pose-publisher-system", content)
    simulation, ros = spawned(poses, simulator="gz", engine=rover_engine(still_at(1.0)))
    bridged(ros, simulation, ("/p", "/where", "tf2_msgs/msg/TFMessage", "Pose_V"))
    bridged(ros, simulation, ("/s", "/where_static", "tf2_msgs/msg/TFMessage", "Pose_V"))
    simulation.advance(0.95)
    moving, static = ros.published("/p"), ros.published("/s")
    assert (len(moving), len(static)) == (10, 2)
    assert [one.child_frame_id for one in moving[0].transforms] == [
        "rover/left_wheel",
        "rover/right_wheel",
    ]
    assert [one.child_frame_id for one in static[0].transforms] == ["rover", "rover/base"]


def test_the_torque_of_classic_is_there_instead_of_the_friction_of_the_joint() -> None:
    """Engines here take the friction from what the motor gives; ODE has the one or the other."""
    wheels = tuple(replace(joint, friction=2.0) for joint in ROVER.joints)
    scene = live_scene(
        plugin("libgazebo_ros_diff_drive.so", CLASSIC), robot=replace(ROVER, joints=wheels)
    )
    simulation, ros = simulation_of(scene)
    simulation.spawn("rover")
    ros.send("/cmd_vel", twist(0.5))
    simulation.advance(0.02)
    assert simulation.engine.motors["rover"]["left"].effort == 7.0


def test_a_planar_move_without_a_rate_of_publishing_publishes_nothing() -> None:
    """Its source looks at the other rate and divides by this one."""
    content = "<publish_rate>0</publish_rate>"
    simulation, ros = spawned(plugin("libgazebo_ros_planar_move.so", content))
    simulation.advance(0.5)
    assert not ros.published("/odom")


def test_the_qos_of_a_plugin_is_that_of_its_element(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)
    qos = (
        '<ros><qos><topic name="odom"><publisher><reliability>best_effort</reliability>'
        "</publisher></topic></qos></ros>"
    )
    given: dict[str, Any] = {}
    simulation, ros = simulation_of(
        live_scene(plugin("libgazebo_ros_planar_move.so", f"{qos}<publish_odom>1</publish_odom>"))
    )
    publish = ros.publisher

    def publisher(node: Any, kind: type, topic: str, wanted: Any) -> Any:
        given[topic] = wanted
        return publish(node, kind, topic, wanted)

    monkeypatch.setattr(ros, "publisher", publisher)
    simulation.spawn("rover")
    assert (given["odom"].depth, given["odom"].reliability) == (1, "best_effort")


DRIVES = {
    "classic": plugin("libgazebo_ros_diff_drive.so", CLASSIC),
    "gz": plugin("gz-sim-diff-drive-system", GZ),
}


def moving_at(speed: float, turning: float = 0.0) -> Any:
    return lambda seconds: still_at(speed * seconds, yaw=turning * seconds)(seconds)


@pytest.mark.parametrize("simulator", DRIVES)
@pytest.mark.parametrize(
    ("wheels", "motion", "reported"),
    [
        ((5.0, 5.0), moving_at(0.1), "for 1.00 m, and it has moved 0.20 m"),
        ((5.0, 5.0), moving_at(0.4), None),
        ((-5.0, -5.0), moving_at(-0.5), None),
        ((-2.0, 2.0), moving_at(0.0, 0.1), "for 2.00 rad, and it has moved 0.20 rad"),
        ((-2.0, 2.0), moving_at(0.0, 0.5), None),  # as wheels of skid steering slip
        ((0.2, 0.2), moving_at(0.0), None),
    ],
)
def test_wheels_that_slip(
    wheels: tuple[float, float], motion: Any, reported: str | None, simulator: str
) -> None:
    def turned(seconds: float) -> dict[str, float]:
        return {"left": wheels[0] * seconds, "right": wheels[1] * seconds}

    engine = rover_engine(motion, positions=turned)
    simulation, ros = spawned(DRIVES[simulator], simulator=simulator, engine=engine)
    simulation.advance(4.5)
    warnings = [text for _, text in ros.lines if "slip" in text]
    assert len(warnings) == (reported is not None)
    assert reported is None or reported in warnings[0]


def with_friction(wheels: Surface, caster: float) -> Any:
    """The rover with another friction of its wheels, and of the ball below its base."""
    base, *others = ROVER.links
    box, ball = base.collisions
    return replace(
        ROVER,
        links=(
            replace(base, collisions=(box, replace(ball, surface=Surface(mu1=caster, mu2=caster)))),
            *(
                replace(link, collisions=(replace(link.collisions[0], surface=wheels),))
                for link in others
            ),
        ),
    )


@pytest.mark.parametrize("simulator", DRIVES)
@pytest.mark.parametrize(
    ("wheels", "caster", "causes"),
    [
        (
            Surface(mu1=0.05, mu2=0.05),
            0.0,
            {"wheels is 0.05: give wheels <mu1> and <mu2> of 1. Or"},
        ),
        (
            Surface(mu1=0.05, mu2=0.05),
            1.0,
            {"wheels is 0.05: give wheels", "casters of 0.001. Or some"},
        ),
        (Surface(), 1.0, {"What drags over the ground", "give casters <mu1> and <mu2> of 0.001"}),
        # Its box has friction, and does not reach the ground.
        (Surface(), 0.0, {"Little of its weight is on these wheels"}),
        # As engines with directions take it: these wheels push with 1.
        (Surface(mu1=0.0, mu2=1.0, fdir1=(0.0, 1.0, 0.0)), 0.0, {"Little of its weight"}),
    ],
)
def test_why_wheels_slip(wheels: Surface, caster: float, causes: set[str], simulator: str) -> None:
    engine = rover_engine(positions=lambda seconds: {"left": 5.0 * seconds, "right": 5.0 * seconds})
    scene = live_scene(DRIVES[simulator], simulator=simulator, robot=with_friction(wheels, caster))
    simulation, ros = simulation_of(scene, engine)
    simulation.spawn("rover")
    simulation.advance(2.5)
    (warning,) = (text for text in ros.warnings if "slip" in text)
    assert all(cause in warning for cause in causes)
    assert ("casters" in warning) == (caster > 0)
    assert ("friction of its wheels" in warning) == (wheels.grip < 0.3)
    assert warning.endswith("something is in its way.")
    assert len(warning) < 280


@pytest.mark.parametrize("simulator", DRIVES)
def test_wheels_that_hang_in_the_air_are_named(simulator: str) -> None:
    engine = rover_engine(positions=lambda seconds: {"left": 5.0 * seconds, "right": 5.0 * seconds})
    base, *others = ROVER.links
    box, ball = base.collisions
    x, y, z = ball.pose_in_link.xyz
    low = replace(ball, pose_in_link=Pose((x, y, z - 0.012)))
    robot = replace(ROVER, links=(replace(base, collisions=(box, low)), *others))
    scene = live_scene(DRIVES[simulator], simulator=simulator, robot=robot)
    simulation, ros = simulation_of(scene, engine)
    simulation.spawn("rover")
    simulation.advance(2.5)
    (warning,) = (text for text in ros.warnings if "slip" in text)
    assert "not touch the ground: `base` reaches 12 mm lower." in warning
    assert all(f"`{link.name}`" in warning for link in others)


def test_the_friction_for_casters_is_that_of_the_rule() -> None:
    engine = rover_engine(positions=lambda seconds: {"left": 5.0 * seconds, "right": 5.0 * seconds})
    scene = live_scene(DRIVES["gz"], simulator="gz", robot=with_friction(Surface(), 1.0))
    simulation, ros = simulation_of(scene, engine)
    simulation.spawn("rover")
    simulation.advance(2.5)
    (warning,) = (text for text in ros.warnings if "slip" in text)
    advised = warning.partition("<mu2> of ")[2].partition(",")[0]
    assert f"<mu1>{advised}</mu1>" in str(DRAGGING_CASTER.instead)
