"""What sensors publish: topics, frames, units and values, of a box on the ground before a wall."""

from __future__ import annotations

import importlib
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from live.nodes.fake_ros import FakeRos, simulation_of
from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.sensor_texts import SOLID, element, world_of
from wsgen.gazebo.bridged_types import PAIRS
from wsgen.model.devices import Devices, MountedSensor, pose_of
from wsgen.model.robot import Box, Collision, Link, Robot, Visual
from wsgen.model.transform import IDENTITY, Pose
from wsgen.model.world import World
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.scene import Scene, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.devices import Element

WORLD = World(name="field", has_ground_plane=True)
BODY = Link(
    name="base",
    inertial=SOLID,
    collisions=(Collision(geometry=Box(size=(0.4, 0.4, 0.2))),),
)
# Its near side is 2 m before the mast.
WALL = Link(
    name="link",
    collisions=(Collision(geometry=Box(size=(0.2, 10.0, 4.0))),),
    visuals=(Visual(geometry=Box(size=(0.2, 10.0, 4.0)), rgba=(1.0, 0.0, 0.0, 1.0)),),
)
ROVER = Robot(name="rover", root="base", links=(BODY,))
PLACE = Pose((0.0, 0.0, 0.1))
MAST = Pose((0.0, 0.0, 0.4))  # in the base, which stands 0.1 m high


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)  # count subscriptions whenever they are asked


def mounted(text: str, pose: Pose = MAST, frame: str = "mast") -> MountedSensor:
    """A sensor on a mast that is lumped into the base."""
    read = element(text)
    return MountedSensor(
        name=read.attributes["name"],
        kind=read.attributes["type"],
        link="base",
        pose_in_link=pose,
        frame=frame,
        element=read,
        plugins=tuple(read.find_all("plugin")),
    )


def simulated(
    *sensors: MountedSensor,
    simulator: str = "classic",
    surroundings: str = "<world/>",
    wall: Link = WALL,
    robot: Robot = ROVER,
    plugins: tuple[Element, ...] = (),
    pose: Pose = PLACE,
    others: tuple[SpawnedRobot, ...] = (),
) -> Iterator[tuple[Any, FakeRos]]:
    walls = replace(Robot(name="wall", root="link", links=(wall,)), is_static=True)
    rover = SpawnedRobot(entity="rover", robot=robot, pose_in_world=pose)
    static = SpawnedRobot(
        entity="wall", robot=walls, pose_in_world=Pose((2.1, 0.0, 1.0)), is_static_model=True
    )
    scene = LiveScene(
        scene=Scene(world=WORLD, robots=(rover, *(others or (static,)))),
        simulator=simulator,
        world="field",
        devices={"rover": Devices(sensors=sensors, plugins=plugins)},
        world_devices=Devices(surroundings=element(surroundings).children),
        descriptions={"rover": "<robot/>"},
    )
    with world_of() as engine:
        simulation, ros = simulation_of(scene, engine)
        simulation.spawn("rover")
        yield simulation, ros


def run(
    *sensors: MountedSensor, seconds: float = 0.25, simulator: str = "classic", **more: Any
) -> FakeRos:
    """What is published in some time; of Gazebo Sim all topics are bridged by their own names."""
    for simulation, ros in simulated(*sensors, simulator=simulator, **more):
        if simulator == "gz":
            bridge_all(simulation, ros)
        simulation.advance(seconds)
    return ros


def bridge_all(simulation: Any, ros: FakeRos) -> None:
    from wsgen.live.nodes.simulator.topics import Rule  # noqa: PLC0415

    gz = simulation.host.gz
    kinds = {types[0]: kind for kind, types in PAIRS.items()}
    rules = [
        Rule(topic, topic, publisher.type.replace("/", "/msg/"), f"gz.msgs.{kinds[publisher.type]}")
        for topic, publishers in gz._publishers.items()
        for publisher in publishers
    ]
    gz.open(ros.node("bridge"), [rule._replace(direction="to_ros") for rule in rules])


RAY = (
    "<{0}><scan><horizontal><samples>{1}</samples><min_angle>-0.5</min_angle>"
    "<max_angle>0.5</max_angle></horizontal></scan><range><min>0.1</min><max>10</max></range></{0}>"
)
LASER = (
    '<sensor name="laser" type="ray"><update_rate>10</update_rate>'
    + RAY.format("ray", 3)
    + '<plugin name="scanner" filename="libgazebo_ros_ray_sensor.so">{}</plugin></sensor>'
)
SCAN = "<output_type>sensor_msgs/LaserScan</output_type>"
AHEAD = [2.0 / math.cos(0.5), 2.0, 2.0 / math.cos(0.5)]


def test_a_ray_sensor_of_classic_scans_the_wall() -> None:
    remapped = "<ros><namespace>/bot</namespace><remapping>~/out:=scan</remapping></ros>"
    ros = run(mounted(LASER.format(SCAN + remapped + "<frame_name>laser_link</frame_name>")))
    scans = ros.published("/bot/scan")
    assert len(scans) == 3  # at 0, 0.1 and 0.2 s
    scan = scans[-1]
    assert list(scan.ranges) == pytest.approx(AHEAD, abs=2e-3)
    assert list(scan.intensities) == [0.0, 0.0, 0.0]
    assert (scan.angle_min, scan.angle_max, scan.angle_increment) == (-0.5, 0.5, 0.5)
    assert (scan.range_min, scan.range_max) == (0.1, 10.0)
    assert scan.header.frame_id == "laser_link"
    assert scan.header.stamp.nanosec == pytest.approx(200_000_000)


REFLECTING = replace(
    WALL,
    collisions=tuple(replace(one, laser_retro=120.0) for one in WALL.collisions),
    visuals=(Visual(geometry=WALL.collisions[0].geometry, laser_retro=60.0),),
)


@pytest.mark.parametrize(("least", "expected"), [(0.0, 120.0), (150.0, 150.0)])
def test_intensities_of_classic(least: float, expected: float) -> None:
    """A wall that reflects, and no less than the plugin wants."""
    more = f"<min_intensity>{least}</min_intensity><ros><remapping>~/out:=/s</remapping></ros>"
    scan = run(mounted(LASER.format(SCAN + more)), wall=REFLECTING).published("/s")[-1]
    assert list(scan.intensities) == [expected] * 3
    on_gpu = LASER.replace('type="ray"', 'type="gpu_ray"')
    scan = run(mounted(on_gpu.format(SCAN + more)), wall=REFLECTING).published("/s")[-1]
    assert list(scan.intensities) == [max(60.0, least)] * 3
    cloud = run(mounted(LASER.format(more)), wall=REFLECTING).published("/s")[-1]
    points = np.frombuffer(bytes(cloud.data), dtype="<f4").reshape(3, 4)
    assert points[:, 3].tolist() == [expected] * 3
    old = "<output_type>sensor_msgs/PointCloud</output_type>"
    message = run(mounted(LASER.format(old + more)), wall=REFLECTING).published("/s")[-1]
    assert list(message.channels[0].values) == [expected] * 3


def test_intensities_of_gazebo_sim() -> None:
    lidar = '<sensor name="l" type="gpu_lidar"><topic>s</topic>' + RAY.format("lidar", 3)
    ros = run(mounted(f"{lidar}</sensor>"), simulator="gz", wall=REFLECTING)
    assert list(ros.published("/s")[-1].intensities) == [60.0] * 3
    cloud = np.frombuffer(bytes(ros.published("/s/points")[-1].data), np.uint8).reshape(3, 18)
    assert cloud[:, 12:16].copy().view("<f4").ravel().tolist() == [60.0] * 3


def test_without_a_frame_it_is_the_link_that_gazebo_has() -> None:
    (output,) = [
        publisher
        for node in run(mounted(LASER.format(SCAN))).nodes
        for publisher in node.publishers.values()
    ]
    assert output.messages[0].header.frame_id == "base"


def test_without_an_output_type_it_is_a_cloud() -> None:
    ros = run(mounted(LASER.format("")))
    (output,) = [one for node in ros.nodes for one in node.publishers.values()]
    cloud = output.messages[-1]
    assert type(cloud).__name__ == "PointCloud2"
    assert (cloud.height, cloud.width, cloud.point_step) == (1, 3, 16)
    points = np.frombuffer(bytes(cloud.data), dtype="<f4").reshape(3, 4)
    assert points[:, 0] == pytest.approx([2.0, 2.0, 2.0], abs=2e-3)
    assert points[:, 1] == pytest.approx([-2 * math.tan(0.5), 0.0, 2 * math.tan(0.5)], abs=2e-3)


def test_a_range_is_the_nearest() -> None:
    text = "<output_type>sensor_msgs/Range</output_type><radiation_type>ultrasound</radiation_type>"
    ros = run(mounted(LASER.format(text)))
    (output,) = [one for node in ros.nodes for one in node.publishers.values()]
    message = output.messages[-1]
    assert message.range == pytest.approx(2.0, abs=2e-3)
    assert message.radiation_type == 0
    assert message.field_of_view == pytest.approx(1.0)


def test_old_clouds() -> None:
    ros = run(mounted(LASER.format("<output_type>sensor_msgs/PointCloud</output_type>")))
    (output,) = [one for node in ros.nodes for one in node.publishers.values()]
    assert [point.x for point in output.messages[0].points] == pytest.approx([2.0] * 3, abs=2e-3)
    assert list(output.messages[0].channels[0].values) == [0.0] * 3


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (LASER.format("<output_type>sensor_msgs/Scan</output_type>"), "sensor_msgs/Scan"),
        (LASER.format(SCAN).replace("ros_ray_sensor", "ros_laser"), "is of ROS 1"),
        (LASER.format(SCAN).replace("gazebo_ros_ray_sensor", "mine"), "libmine.so"),
        ('<sensor name="s" type="ray"/>', "no <lidar>"),
        ('<sensor name="s" type="ray"><update_rate>fast</update_rate></sensor>', "`fast`"),
    ],
)
def test_what_does_not_work_is_reported(text: str, expected: str) -> None:
    ros = run(mounted(text))
    (warning,) = ros.warnings
    assert expected in warning
    assert "`rover`" in warning


def noting(engine: Any, casts: list[int]) -> Any:
    """The engine's `cast_rays`, which notes how many rays it is given."""
    cast = engine.cast_rays

    def cast_rays(starts: Any, ends: Any) -> Any:
        casts.append(len(starts))
        return cast(starts, ends)

    return cast_rays


def test_nobody_pays_for_what_nobody_wants(monkeypatch: pytest.MonkeyPatch) -> None:
    casts: list[int] = []
    for simulation, ros in simulated(mounted(LASER.format(SCAN))):
        (output,) = [one for node in ros.nodes for one in node.publishers.values()]
        output.subscribers = 0
        monkeypatch.setattr(simulation.engine, "cast_rays", noting(simulation.engine, casts))
        simulation.advance(0.25)
        assert casts == []
        output.subscribers = 1
        simulation.advance(0.45)
        assert casts == [3, 3]


def test_a_gpu_lidar_of_gazebo_sim() -> None:
    text = (
        '<sensor name="laser" type="gpu_lidar"><update_rate>10</update_rate>'
        + RAY.format("lidar", 3)
        + "{}</sensor>"
    )
    named = text.format("<topic>scan</topic><gz_frame_id>laser_frame</gz_frame_id>")
    ros = run(mounted(named), simulator="gz")
    assert list(ros.published("/scan")[-1].ranges) == pytest.approx(AHEAD, abs=2e-3)
    assert ros.published("/scan")[-1].header.frame_id == "laser_frame"
    cloud = ros.published("/scan/points")[-1]
    assert (cloud.height, cloud.width, cloud.point_step) == (1, 3, 18)
    ros = run(mounted(text.format("")), simulator="gz")
    topic = "/world/field/model/rover/link/base/sensor/laser/scan"
    assert ros.published(topic)[-1].header.frame_id == "rover/base/laser"


def test_a_turned_mount_looks_elsewhere() -> None:
    left = Pose((0.0, 0.0, 0.4), (0.0, 0.0, -0.5))
    ros = run(mounted(LASER.format(SCAN + "<ros><argument>~/out:=/s</argument></ros>"), left))
    assert list(ros.published("/s")[-1].ranges)[2] == pytest.approx(2.0, abs=2e-3)


IMU = (
    '<sensor name="imu" type="imu"><update_rate>100</update_rate><imu><angular_velocity><x>'
    '<noise type="gaussian"><stddev>0.1</stddev></noise></x></angular_velocity></imu>{}</sensor>'
)


def test_an_imu_of_classic_stands_on_the_ground() -> None:
    plugin = (
        '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros>'
        "<remapping>~/out:=/imu</remapping></ros></plugin>"
    )
    rolled = Pose((0.0, 0.0, 0.1), (math.pi / 2, 0.0, 0.0))
    messages = run(mounted(IMU.format(plugin), rolled)).published("/imu")
    assert len(messages) == 25
    last = messages[-1]
    felt = last.linear_acceleration
    assert (felt.x, felt.y, felt.z) == pytest.approx((0.0, 9.8, 0.0), abs=0.1)
    quaternion = last.orientation
    half = math.sqrt(0.5)
    assert (quaternion.x, quaternion.y, quaternion.z, quaternion.w) == pytest.approx(
        (half, 0.0, 0.0, half), abs=1e-3
    )
    assert last.header.frame_id == "base"
    assert last.angular_velocity_covariance == pytest.approx([0.01] + [0.0] * 8)
    turning = np.array([message.angular_velocity.x for message in messages])
    assert 0.05 < turning.std() < 0.2


def test_an_imu_of_gazebo_sim_is_against_its_beginning() -> None:
    rolled = Pose((0.0, 0.0, 0.1), (math.pi / 2, 0.0, 0.0))
    ros = run(mounted(IMU.format(""), rolled), simulator="gz")
    last = ros.published("/world/field/model/rover/link/base/sensor/imu/imu")[-1]
    assert last.orientation.w == pytest.approx(1.0, abs=1e-6)
    assert last.linear_acceleration.y == pytest.approx(9.8, abs=0.1)
    assert last.header.frame_id == "rover/base/imu"


CAMERA = (
    "<update_rate>10</update_rate><camera><horizontal_fov>1.0</horizontal_fov><image>"
    "<width>40</width><height>30</height></image><clip><near>0.1</near><far>20</far></clip></camera>"
)


def test_a_camera_of_classic() -> None:
    text = (
        f'<sensor name="eye" type="camera">{CAMERA}'
        '<plugin name="p" filename="libgazebo_ros_camera.so"><ros><namespace>bot</namespace></ros>'
        "<camera_name>front</camera_name><frame_name>optical</frame_name></plugin></sensor>"
    )
    ros = run(mounted(text))
    image = ros.published("/bot/front/image_raw")[-1]
    assert (image.width, image.height, image.encoding, image.step) == (40, 30, "rgb8", 120)
    pixels = np.frombuffer(bytes(image.data), dtype=np.uint8).reshape(30, 40, 3)
    assert pixels[5, 20, 0] > 100
    assert pixels[5, 20, 1] == 0
    assert (pixels[29, 20] == pixels[29, 20, 0]).all()  # the ground is gray
    info = ros.published("/bot/front/camera_info")[-1]
    focal = 20 / math.tan(0.5)
    assert info.k == pytest.approx([focal, 0, 20.5, 0, focal, 15.5, 0, 0, 1])
    assert image.header.frame_id == info.header.frame_id == "optical"


@pytest.mark.slow
def test_a_camera_without_its_element_is_that_of_sdformat() -> None:
    plugin = '<plugin name="p" filename="libgazebo_ros_camera.so"/>'
    ros = run(mounted(f'<sensor name="eye" type="camera">{plugin}</sensor>'))
    image = ros.published("/eye/image_raw")[-1]
    assert (image.width, image.height, image.encoding) == (320, 240, "rgb8")
    focal = 160 / math.tan(1.047 / 2)
    assert ros.published("/eye/camera_info")[-1].k[0] == pytest.approx(focal)


def test_a_depth_camera_of_classic() -> None:
    text = (
        f'<sensor name="eye" type="depth">{CAMERA}'
        '<plugin name="p" filename="libgazebo_ros_camera.so"/></sensor>'
    )
    ros = run(mounted(text))
    depth = ros.published("/eye/depth/image_raw")[-1]
    assert (depth.encoding, depth.step) == ("32FC1", 160)
    meters = np.frombuffer(bytes(depth.data), dtype="<f4").reshape(30, 40)
    assert meters[5] == pytest.approx(2.0, abs=1e-3)
    cloud = ros.published("/eye/points")[-1]
    assert (cloud.width, cloud.height, cloud.point_step) == (40, 30, 32)
    points = np.frombuffer(bytes(cloud.data), dtype="<f4").reshape(30, 40, 8)
    focal = 20 / math.tan(0.5)
    assert points[5, 0, :3] == pytest.approx((-19.5 * 2 / focal, -9.5 * 2 / focal, 2.0), abs=1e-3)


def test_an_rgbd_camera_of_gazebo_sim() -> None:
    text = f'<sensor name="eye" type="rgbd_camera"><topic>cam</topic>{CAMERA}</sensor>'
    ros = run(mounted(text), simulator="gz")
    assert ros.published("/cam/image")[-1].encoding == "rgb8"
    meters = np.frombuffer(bytes(ros.published("/cam/depth_image")[-1].data), dtype="<f4")
    assert meters.reshape(30, 40)[5] == pytest.approx(2.0, abs=1e-3)
    cloud = ros.published("/cam/points")[-1]
    assert cloud.point_step == 16
    points = np.frombuffer(bytes(cloud.data), dtype="<f4").reshape(30, 40, 4)
    assert points[5, 0, 0] == pytest.approx(2.0, abs=1e-3)
    assert points[5, 0, 1] > 0 < points[5, 0, 2]
    assert ros.published("/cam/camera_info")[-1].k[2] == 20


def test_topics_of_cameras_of_gazebo_sim() -> None:
    base = "/world/field/model/rover/link/base/sensor/eye"
    ros = run(mounted(f'<sensor name="eye" type="camera">{CAMERA}</sensor>'), simulator="gz")
    assert ros.published(f"{base}/image")
    assert ros.published(f"{base}/camera_info")
    text = f'<sensor name="eye" type="depth_camera"><topic>/a/depth</topic>{CAMERA}</sensor>'
    ros = run(mounted(text), simulator="gz")
    assert ros.published("/a/depth")[-1].encoding == "32FC1"
    assert ros.published("/a/camera_info")
    assert ros.published("/a/depth/points")


def test_a_camera_that_waits_for_triggers() -> None:
    text = (
        f'<sensor name="eye" type="camera">{CAMERA}'
        '<plugin name="p" filename="libgazebo_ros_camera.so"><triggered>true</triggered>'
        "</plugin></sensor>"
    )
    from std_msgs.msg import Empty  # noqa: PLC0415  a fake

    for simulation, ros in simulated(mounted(text)):
        simulation.advance(0.35)
        assert ros.published("/eye/image_raw") == []
        ros.send("/eye/image_trigger", Empty())
        simulation.advance(0.75)
        assert len(ros.published("/eye/image_raw")) == 1


def test_several_cameras_of_one_sensor() -> None:
    cameras = CAMERA.replace("<camera>", '<camera name="left">') + (
        '<camera name="right"><pose>0 -0.1 0 0 0 0</pose></camera>'
    )
    text = (
        f'<sensor name="eyes" type="multicamera">{cameras}'
        '<plugin name="p" filename="libgazebo_ros_camera.so"/></sensor>'
    )
    ros = run(mounted(text))
    assert ros.published("/eyes/left/image_raw")[-1].width == 40
    assert ros.published("/eyes/right/image_raw")[-1].width == 320


BUMPER = (
    '<sensor name="bumper" type="contact"><update_rate>50</update_rate><contact>'
    "<collision>{}</collision></contact>{}</sensor>"
)


def test_a_bumper_of_classic_feels_the_ground() -> None:
    plugin = '<plugin name="p" filename="libgazebo_ros_bumper.so"/>'
    ros = run(mounted(BUMPER.format("base_collision", plugin)), seconds=0.5)
    (state,) = ros.published("/bumper_states")[-1].states
    assert state.collision1_name == "rover::base::base_collision"
    assert state.collision2_name == "ground_plane::link::collision"
    assert state.total_wrench.force.z == pytest.approx(9.8, rel=0.1)
    assert [normal.z for normal in state.contact_normals] == pytest.approx([1.0] * 4, abs=0.01)
    assert ros.published("/bumper_states")[-1].header.frame_id == "world"


def test_a_bumper_of_a_collision_that_is_not_there() -> None:
    plugin = '<plugin name="p" filename="libgazebo_ros_bumper.so"/>'
    ros = run(mounted(BUMPER.format("bumper", plugin)), seconds=0.5)
    assert ros.published("/bumper_states")[-1].states == []
    (warning,) = ros.warnings
    assert "`bumper`" in warning
    assert "base_collision" in warning


def test_contacts_of_gazebo_sim() -> None:
    ros = run(mounted(BUMPER.format("base_collision", "")), simulator="gz", seconds=0.5)
    topic = "/world/field/model/rover/link/base/sensor/bumper/contact"
    (contact,) = ros.published(topic)[-1].contacts
    assert contact.collision2.name == "ground_plane::link::collision"
    force = sum(wrench.body_1_wrench.force.z for wrench in contact.wrenches)
    assert force == pytest.approx(9.8, rel=0.1)


SURROUNDINGS = (
    "<world><spherical_coordinates><latitude_deg>47</latitude_deg><longitude_deg>8</longitude_deg>"
    "<elevation>400</elevation></spherical_coordinates>"
    "<magnetic_field>1e-5 2e-5 -4e-5</magnetic_field></world>"
)


def test_navigation_satellites() -> None:
    text = '<sensor name="s" type="navsat"><update_rate>5</update_rate><topic>fix</topic></sensor>'
    ros = run(mounted(text), simulator="gz", surroundings=SURROUNDINGS)
    fix = ros.published("/fix")[-1]
    assert (fix.latitude, fix.longitude) == pytest.approx((47.0, 8.0), abs=1e-6)
    assert fix.altitude == pytest.approx(400.5, abs=0.01)
    plugin = (
        '<sensor name="s" type="gps"><plugin name="p" filename="libgazebo_ros_gps_sensor.so"><ros>'
        "<remapping>~/out:=/fix</remapping><remapping>~/vel:=/vel</remapping></ros></plugin></sensor>"
    )
    ros = run(mounted(plugin), surroundings=SURROUNDINGS)
    assert ros.published("/fix")[-1].altitude == pytest.approx(400.5, abs=0.01)
    assert ros.published("/vel")[-1].vector.z == pytest.approx(0.0, abs=0.05)
    (warning,) = run(mounted(text), simulator="gz").warnings
    assert "<spherical_coordinates>" in warning


def test_altitude_pressure_and_magnetic_field() -> None:
    texts = [
        f'<sensor name="{kind}" type="{kind}"><topic>{kind}</topic><{kind}/></sensor>'
        for kind in ("altimeter", "air_pressure", "magnetometer")
    ]
    rolled = replace(MAST, rpy=(math.pi / 2, 0.0, 0.0))
    ros = run(*(mounted(text, rolled) for text in texts), simulator="gz", surroundings=SURROUNDINGS)
    assert ros.published("/altimeter")[-1].vertical_position == pytest.approx(0.0, abs=0.01)
    assert ros.published("/altimeter")[-1].vertical_reference == pytest.approx(0.5, abs=0.01)
    pressure = ros.published("/air_pressure")[-1].fluid_pressure
    assert pressure == pytest.approx(101325 - 0.5 * 12.0, abs=1.0)
    field = ros.published("/magnetometer")[-1].magnetic_field
    assert (field.x, field.y, field.z) == pytest.approx((1e-5, -4e-5, -2e-5), abs=1e-8)


def test_a_pose_in_a_camera_is_added() -> None:
    moved = CAMERA.replace("<camera>", "<camera><pose>1 0 0 0 0 0</pose>")
    text = f'<sensor name="eye" type="depth_camera"><topic>d</topic>{moved}</sensor>'
    ros = run(mounted(text), simulator="gz")
    meters = np.frombuffer(bytes(ros.published("/d")[-1].data), dtype="<f4").reshape(30, 40)
    assert meters[5] == pytest.approx(1.0, abs=1e-3)
    assert pose_of(None) == IDENTITY


def test_a_slow_machine_measures_less_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """A scan that takes 0.2 s, ten times a second: at real time it is done 2.5 times a second."""
    import time  # noqa: PLC0415

    clock = iter(range(10_000))
    monkeypatch.setattr(time, "thread_time", lambda: 0.2 * next(clock))
    for simulation, ros in simulated(mounted(LASER.format(SCAN))):
        (output,) = [one for node in ros.nodes for one in node.publishers.values()]
        simulation.advance(4.0)
        assert len(output.messages) == pytest.approx(11, abs=2)
        (warning,) = ros.warnings
        assert "less often than 10 times a second" in warning
        assert "200 ms" in warning


def test_sensors_of_what_has_exploded_say_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = f'<sensor name="eye" type="rgbd_camera"><topic>c</topic>{CAMERA}</sensor>'
    lidar = '<sensor name="l" type="gpu_lidar"><topic>scan</topic>' + RAY.format("lidar", 3)
    sensors = (camera, f"{lidar}</sensor>", IMU.format("<topic>imu</topic>"))
    for simulation, ros in simulated(*map(mounted, sensors), simulator="gz"):
        bridge_all(simulation, ros)
        simulation.advance(0.01)
        topics = ("/c/image", "/scan", "/imu")
        before = [len(ros.published(topic)) for topic in topics]
        there = simulation.engine.link_poses

        def link_poses(entity: str, there: Any = there) -> dict[str, Pose]:
            nowhere = {"base": Pose((math.nan, 0.0, 0.0))}
            return nowhere if entity == "rover" else there(entity)

        monkeypatch.setattr(simulation.engine, "link_poses", link_poses)
        simulation.advance(0.25)
        assert [len(ros.published(topic)) for topic in topics] == before


def test_a_lidar_takes_no_robot_for_one_that_is_gone() -> None:
    """A robot that is spawned after another one was deleted may lie where that one was."""
    lidar = importlib.import_module("wsgen.live.nodes.simulator.sensors.lidar")
    view = SimpleNamespace(world=WORLD, poses={"block": {"link": IDENTITY}})
    host = SimpleNamespace(robots={}, view=lambda: view)
    reflections = lidar._Reflections()
    rays = (np.array([[2.0, 0.0, 1.0]]), np.array([[-8.0, 0.0, 1.0]]), np.array([0.15]))
    for number in range(1, 9):
        retro = float(number)
        solid = Collision(geometry=Box(size=(1.0, 1.0, 4.0)), laser_retro=retro)
        robot = Robot(name="block", root="link", links=(Link(name="link", collisions=(solid,)),))
        host.robots["block"] = SimpleNamespace(spawned=SpawnedRobot(entity="block", robot=robot))
        assert reflections.intensities(host, *rays, is_gpu=False).tolist() == [retro]
        host.robots.clear()
        del robot


def test_the_node_of_a_plugin_ends_with_its_robot() -> None:
    lidar = mounted(LASER.format(SCAN))
    for simulation, ros in simulated(lidar):
        assert [node.name for node in ros.nodes] == ["scanner"]
        simulation.delete("rover")
        assert not ros.nodes
