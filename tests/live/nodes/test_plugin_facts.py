"""What is known of Gazebo's plugins is what their sources say, and what live runs do.

The rows of `SOURCES` and `WITHOUT_A_JOINT` are read from these versions: gazebo_ros_pkgs, branch
ros2 at d52f7c47 (3.9), and gz-sim, branches ign-gazebo6 (Fortress) and gz-sim8 at 8.14 (Harmonic);
the latter has all that the former has. Those of ros2_control are of all branches from humble on:
none has all parameters.
"""

from __future__ import annotations

import importlib
import itertools
import math
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.cars import CAR
from live.nodes.fake_ros import live_scene, plugin, simulation_of
from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.test_sensors import SURROUNDINGS, mounted, simulated
from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.plugins import OF_CLASSIC, PLUGINS, Default, stem
from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.gazebo.systems import DEFAULT_SYSTEMS, systems
from wsgen.live.nodes.simulator.plugins import PLUGINS as SIMULATED
from wsgen.live.nodes.simulator.plugins import WORLD_PLUGINS
from wsgen.live.nodes.simulator.sensors import SENSORS
from wsgen.model.devices import Devices, Element
from wsgen.model.target import CLASSIC, SIM
from wsgen.model.world import World
from wsgen.simulation.bullet import BulletEngine

if TYPE_CHECKING:
    from collections.abc import Iterator

# Plugin, its source, its parameters with their defaults: numbers, truth values, `-` for none, and
# texts. Several have the default of the row above them. `*` stands for min and max.
SOURCES = """
gazebo_ros_ackermann_drive gazebo_plugins/src/gazebo_ros_ackermann_drive.cpp
 ros=- update_rate=100 max_speed=20 max_steer=0.6 max_steering_angle=7.85
 front_right_joint=front_right_joint front_left_joint=front_left_joint
 rear_right_joint=rear_right_joint rear_left_joint=rear_left_joint
 right_steering_joint=right_steering_joint left_steering_joint=left_steering_joint
 steering_wheel_joint=steering_wheel_joint
 right_steering_pid_gain=0,0,0 left_steering_pid_gain=0,0,0 linear_velocity_pid_gain=0,0,0
 right_steering_i_range=0,0 left_steering_i_range=0,0 linear_velocity_i_range=0,0
 publish_odom=false publish_odom_tf=false publish_wheel_tf=false publish_distance=false
 publish_steerangle=false odometry_frame=odom robot_base_frame=base_footprint
 covariance_x=0.00001 covariance_y=0.00001 covariance_yaw=0.001
gazebo_ros_bumper gazebo_plugins/src/gazebo_ros_bumper.cpp
 ros=- frame_name=world
gazebo_ros_camera gazebo_plugins/src/gazebo_ros_camera.cpp
 ros=- camera_name=- frame_name=- triggered=false cx=- cy=- focal_length=0 border_crop=true
 hack_baseline=0 rectification_matrix=1,0,0,0,1,0,0,0,1 P_fx=- P_cx=- Tx=- P_fy=- P_cy=- Ty=0
 min_depth=0.4 max_depth=inf
gazebo_ros_gps_sensor gazebo_plugins/src/gazebo_ros_gps_sensor.cpp
 ros=- frame_name=-
gazebo_ros_imu_sensor gazebo_plugins/src/gazebo_ros_imu_sensor.cpp
 ros=- frame_name=- initial_orientation_as_reference=false
gazebo_ros_ray_sensor gazebo_plugins/src/gazebo_ros_ray_sensor.cpp
 ros=- frame_name=- output_type=sensor_msgs/PointCloud2 radiation_type=infrared min_intensity=0
gazebo_ros_diff_drive gazebo_plugins/src/gazebo_ros_diff_drive.cpp
 ros=- left_joint=- right_joint=- num_wheel_pairs=1 max_wheel_acceleration=0 max_wheel_torque=5
 wheel_separation=0.34 wheel_diameter=0.15 update_rate=100 odometry_frame=odom
 robot_base_frame=base_footprint odometry_source=1 publish_odom=false publish_odom_tf=false
 publish_wheel_tf=false covariance_x=0.00001 covariance_y=0.00001 covariance_yaw=0.001
gazebo_ros_ft_sensor gazebo_plugins/src/gazebo_ros_ft_sensor.cpp
 ros=- update_rate=0 gaussian_noise=0 body_name=- joint_name=- frame_name=-
gazebo_ros_joint_pose_trajectory gazebo_plugins/src/gazebo_ros_joint_pose_trajectory.cpp
 ros=- update_rate=100
gazebo_ros_joint_state_publisher gazebo_plugins/src/gazebo_ros_joint_state_publisher.cpp
 ros=- update_rate=100 joint_name=-
gazebo_ros_p3d gazebo_plugins/src/gazebo_ros_p3d.cpp
 ros=- update_rate=0 body_name=- xyz_offset=0,0,0 xyz_offsets=0,0,0 rpy_offset=0,0,0
 rpy_offsets=0,0,0 gaussian_noise=0 frame_name=world
gazebo_ros_planar_move gazebo_plugins/src/gazebo_ros_planar_move.cpp
 ros=- update_rate=20 publish_rate=20 odometry_frame=odom robot_base_frame=base_footprint
 publish_odom=true publish_odom_tf=true covariance_x=0.00001 covariance_y=0.00001
 covariance_yaw=0.001
gazebo_ros_state gazebo_ros/src/gazebo_ros_state.cpp
 ros=- update_rate=100
gazebo_ros2_control gazebo_ros2_control/src/gazebo_ros2_control_plugin.cpp
 parameters=- ros=- controller_manager_name=controller_manager hold_joints=true
 position_proportional_gain=0.1 robot_param=robot_description
 robot_param_node=robot_state_publisher
ign_ros2_control-system ign_ros2_control/src/ign_ros2_control_plugin.cpp
 parameters=- ros=- controller_manager_name=controller_manager hold_joints=true
 position_proportional_gain=0.1 robot_param=robot_description
 robot_param_node=robot_state_publisher
gz_ros2_control-system gz_ros2_control/src/gz_ros2_control_plugin.cpp
 parameters=- ros=- controller_manager_name=controller_manager hold_joints=true
 position_proportional_gain=0.1 robot_param=robot_description
 robot_param_node=robot_state_publisher
ackermann-steering src/systems/ackermann_steering/AckermannSteering.cc
 left_joint=- right_joint=- left_steering_joint=- right_steering_joint=- topic=- sub_topic=-
 steering_only=false use_actuator_msg=false actuator_number=- wheel_radius=0.2 kingpin_width=0.8
 wheel_separation=1 wheel_base=1 steering_limit=0.5 steer_p_gain=1 *_velocity=inf
 *_acceleration=inf *_jerk=inf odom_publish_frequency=50 odom_topic=- tf_topic=-
 frame_id={model}/odom child_frame_id={model}/{link}
apply-joint-force src/systems/apply_joint_force/ApplyJointForce.cc
 joint_name=-
diff-drive src/systems/diff_drive/DiffDrive.cc
 left_joint=- right_joint=- wheel_separation=1 wheel_radius=0.2 *_velocity=inf *_acceleration=inf
 *_jerk=inf *_linear_velocity=inf *_linear_acceleration=inf *_linear_jerk=inf
 *_angular_velocity=inf *_angular_acceleration=inf *_angular_jerk=inf odom_publish_frequency=50
 topic=- odom_topic=- tf_topic=- frame_id={model}/odom child_frame_id={model}/{link}
joint-controller src/systems/joint_controller/JointController.cc
 joint_name=- initial_velocity=0 use_force_commands=false p_gain=1 i_gain=0 d_gain=0 i_max=1
 i_min=-1 cmd_max=1000 cmd_min=-1000 cmd_offset=0 use_actuator_msg=false actuator_number=- topic=-
 sub_topic=-
joint-position-controller src/systems/joint_position_controller/JointPositionController.cc
 joint_name=- joint_index=0 p_gain=1 i_gain=0.1 d_gain=0.01 i_max=1 i_min=-1 cmd_max=1000
 cmd_min=-1000 cmd_offset=0 use_velocity_commands=false initial_position=0 use_actuator_msg=false
 actuator_number=- topic=- sub_topic=-
joint-state-publisher src/systems/joint_state_publisher/JointStatePublisher.cc
 joint_name=- topic=- update_rate=0
joint-trajectory-controller src/systems/joint_traj_control/JointTrajectoryController.cc
 joint_name=- topic=- initial_position=0 position_p_gain=0 position_i_gain=0 position_d_gain=0
 position_i_min=0 position_i_max=-1 position_cmd_min=0 position_cmd_max=-1 position_cmd_offset=0
 velocity_p_gain=0 velocity_i_gain=0 velocity_d_gain=0 velocity_i_min=0 velocity_i_max=-1
 velocity_cmd_min=0 velocity_cmd_max=-1 velocity_cmd_offset=0
linearbatteryplugin src/systems/battery_plugin/LinearBatteryPlugin.cc
 open_circuit_voltage_constant_coef=0 open_circuit_voltage_linear_coef=0 capacity=0
 initial_charge=- resistance=0 smooth_current_tau=1 fix_issue_225=false invert_current_sign=false
 battery_name=- voltage=- enable_recharge=false charging_time=0 recharge_by_topic=- power_load=0
 start_draining=false power_draining_topic=- stop_power_draining_topic=-
mecanum-drive src/systems/mecanum_drive/MecanumDrive.cc
 front_left_joint=- front_right_joint=- back_left_joint=- back_right_joint=- wheel_separation=1
 wheelbase=1 wheel_radius=0.2 *_velocity=inf *_acceleration=inf *_jerk=inf
 odom_publish_frequency=50 topic=- odom_topic=- tf_topic=- frame_id={model}/odom
 child_frame_id={model}/{link}
odometry-publisher src/systems/odometry_publisher/OdometryPublisher.cc
 odom_frame={model}/odom robot_base_frame={model}/base_footprint xyz_offset=0,0,0 rpy_offset=0,0,0
 gaussian_noise=0 dimensions=2 odom_publish_frequency=50 odom_topic=- odom_covariance_topic=-
 tf_topic=-
pose-publisher src/systems/pose_publisher/PosePublisher.cc
 publish_link_pose=true publish_nested_model_pose=false publish_model_pose=-
 publish_visual_pose=false publish_collision_pose=false publish_sensor_pose=false
 update_frequency=-1 static_publisher=false static_update_frequency=- use_pose_vector_msg=false
 topic=-
velocity-control src/systems/velocity_control/VelocityControl.cc
 initial_linear=0,0,0 initial_angular=0,0,0 topic=- link_name=-
"""
# What a plugin does where one of the joints that it names is not there: whether it goes on.
WITHOUT_A_JOINT = {
    "gazebo_ros_ackermann_drive": False,  # "Front right wheel joint [%s] not found, plugin will …"
    "gazebo_ros_diff_drive": False,  # "Joint [%s] not found, plugin will not work."
    "gazebo_ros_ft_sensor": False,  # "Joint [%s] does not exist. Aborting"
    "gazebo_ros_joint_state_publisher": True,  # "Joint %s does not exist!", with the others
    "ackermann-steering": True,  # "Failed to find left joint", with the others of that side
    "apply-joint-force": False,  # it has one
    "diff-drive": True,  # "Failed to find left joint [x]", with the others of that side
    "joint-controller": True,  # "Failed to find joint", with the others
    "joint-position-controller": True,
    "joint-state-publisher": True,  # "The JointStatePublisher will not publish this joint."
    "joint-trajectory-controller": True,  # "Model does not contain joint", with the others
    "mecanum-drive": True,
}
# Parts of the car for the parameters that name some.
PARTS = {
    "left_joint": "rear_left",
    "right_joint": "rear_right",
    "front_left_joint": "front_left",
    "front_right_joint": "front_right",
    "back_left_joint": "rear_left",
    "back_right_joint": "rear_right",
    "rear_left_joint": "rear_left",
    "rear_right_joint": "rear_right",
    "left_steering_joint": "left_steer",
    "right_steering_joint": "right_steer",
    "joint_name": "rear_left",
    "body_name": "base",
    "link_name": "base",
    "battery_name": "cell",
    "voltage": "12",
    "capacity": "1",
    "charging_time": "1",
    "actuator_number": "0",
    "recharge_by_topic": "true",
}
OF_SENSORS = {
    name
    for name, one in PLUGINS.items()
    if one.parameters and name not in SIMULATED and name not in WORLD_PLUGINS
}
OF_ROBOTS = [name for name in SIMULATED if "ros2_control" not in name]  # controllers have tests


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)


def is_of_classic(name: str) -> bool:
    return name in OF_CLASSIC


def filename_of(name: str) -> str:
    return f"lib{name}.so" if is_of_classic(name) else f"gz-sim-{name}-system"


def content_of(name: str, *, flags: str = "", **more: str) -> str:
    """Parameters with which a plugin works; `flags` for all of its truth values."""
    known = PLUGINS[name]
    written = {key: text for key, text in PARTS.items() if key in known.parameters}
    if "joint_name" in written and "body_name" in written:
        del written["body_name"]
    if flags:
        written |= {
            key: flags
            for key, value in known.parameters.items()
            if value in (True, False) and isinstance(value, bool)
        }
    written |= more
    return "".join(f"<{key}>{text}</{key}>" for key, text in written.items())


def started(name: str, content: str) -> tuple[list[tuple[str, str, bool]], list[str]]:
    """The topics of a live run: name, type, whether the plugin reads it; and warnings."""
    from wsgen.live.nodes.simulator.host import Host  # noqa: PLC0415
    from wsgen.live.nodes.simulator.topics import name_of  # noqa: PLC0415  with fakes

    found: list[tuple[str, str, bool]] = []

    class Listed(Host):
        def publisher(self, *given: Any, **more: Any) -> Any:
            found.append((given[2], name_of(given[1]), False))
            return super().publisher(*given, **more)

        def subscription(self, *given: Any, **more: Any) -> None:
            found.append((given[2], name_of(given[1]), True))
            super().subscription(*given, **more)

    simulation_module = importlib.import_module("wsgen.live.nodes.simulator.simulation")
    vars(simulation_module)["Host"] = Listed  # this copy is that of the test
    made = plugin(filename_of(name), content)
    is_of_world = name in WORLD_PLUGINS
    scene = live_scene(
        *(() if is_of_world else (made,)),
        simulator=CLASSIC if is_of_classic(name) else SIM,
        robot=CAR,
        world_devices=Devices(plugins=(made,)) if is_of_world else None,
    )
    engine = BulletEngine(World(name="w", has_ground_plane=True))
    try:
        simulation, ros = simulation_of(scene, engine)
        own = len(found)
        if is_of_world:
            return found, ros.warnings
        simulation.spawn("rover")
        simulation.advance(0.02)
        return found[own:], ros.warnings
    finally:
        engine.close()


def rows() -> Iterator[tuple[str, dict[str, Default]]]:
    name, defaults = "", dict[str, Default]()
    for line in SOURCES.strip().splitlines():
        if not line.startswith(" "):
            if name:
                yield name, defaults
            name, defaults = line.split()[0], {}
            continue
        for word in line.split():
            key, _, text = word.partition("=")
            if key.startswith("*"):
                defaults |= {f"min{key[1:]}": -math.inf, f"max{key[1:]}": math.inf}
            else:
                defaults[key] = value_of(text)
    yield name, defaults


def value_of(text: str) -> Default:
    if text in ("true", "false", "-"):
        return {"true": True, "false": False, "-": None}[text]
    if "," in text:
        return tuple(map(float, text.split(",")))
    try:
        return float(text)
    except ValueError:
        return text


@pytest.mark.parametrize(("name", "defaults"), list(rows()), ids=lambda one: str(one)[:30])
def test_parameters_are_those_of_the_source(name: str, defaults: dict[str, Default]) -> None:
    assert PLUGINS[name].parameters == defaults


def test_what_is_simulated_is_known_and_what_is_known_is_simulated() -> None:
    known_whole = {name for name, one in PLUGINS.items() if one.parameters}
    simulated = SIMULATED.keys() | WORLD_PLUGINS.keys() | OF_SENSORS
    assert known_whole == simulated, (
        "A plugin with parameters in gazebo/plugins.py has a class in "
        f"live/nodes/simulator/plugins, and no other: {sorted(known_whole ^ simulated)}"
    )
    with_rows = {name for name, _ in rows()}
    assert with_rows == known_whole, f"SOURCES has no row of {sorted(known_whole - with_rows)}"
    assert SENSORS.keys() <= SYSTEM_OF_SENSOR.keys()
    classes = {one for names in systems().values() for one in names}
    needed = {system for one in PLUGINS.values() for system in one.needs}
    assert {*SYSTEM_OF_SENSOR.values(), *needed, *DEFAULT_SYSTEMS} <= classes


class Recording(dict[str, tuple[str, ...]]):
    """The texts of a plugin, which notes what is asked for."""

    asked: set[str]

    def get(self, key: str, default: Any = None) -> Any:
        self.asked.add(key)
        return super().get(key, default)


@pytest.mark.parametrize("name", [*OF_ROBOTS, *WORLD_PLUGINS])
def test_live_runs_read_all_parameters(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: set[str] = set()
    find_all = Element.find_all

    def noted(element: Element, path: str) -> Iterator[Element]:
        if element.tag == "plugin":
            asked.add(path.partition("/")[0])
        return find_all(element, path)

    monkeypatch.setattr(Element, "find_all", noted)
    from wsgen.live.nodes.simulator.plugins import diff_drive, drives  # noqa: PLC0415

    values_of = drives.values_of

    def recording(element: Element) -> Recording:
        made = Recording(values_of(element))
        made.asked = asked
        return made

    for module in (diff_drive, drives):
        monkeypatch.setattr(module, "values_of", recording)
    for flags in ("false", "true"):
        _, warnings = started(name, content_of(name, flags=flags))
        assert not any("does not work" in one for one in warnings), warnings
    known = PLUGINS[name].parameters.keys()
    assert not known - asked, "its class does not read these parameters of gazebo/plugins.py"
    assert not asked - known, "gazebo/plugins.py lacks these parameters that its class reads"


@pytest.mark.slow
def test_sensors_take_the_plugins_that_are_known_and_read_their_parameters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each kind of sensor is given all plugins of Gazebo Classic."""
    asked: dict[str, set[str]] = {}
    find_all = Element.find_all

    def noted(element: Element, path: str) -> Iterator[Element]:
        if element.tag == "plugin":
            name = stem(element.attributes["filename"])
            asked.setdefault(name, set()).add(path.partition("/")[0])
        return find_all(element, path)

    monkeypatch.setattr(Element, "find_all", noted)
    plugins = "".join(f'<plugin filename="lib{name}.so" name="p"/>' for name in OF_CLASSIC)
    content = "<contact/><ray><range><max>9</max></range></ray><imu/>"
    for kind in SENSORS:
        sensor = mounted(f'<sensor name="s" type="{kind}">{content}{plugins}</sensor>')
        assert list(simulated(sensor, surroundings=SURROUNDINGS))
    assert asked.keys() == OF_SENSORS
    for name, found in asked.items():
        known = PLUGINS[name]
        assert found == known.parameters.keys() - set(known.not_simulated), name


@pytest.mark.parametrize("name", [*OF_ROBOTS, *WORLD_PLUGINS])
def test_live_runs_have_the_topics_that_are_known(name: str) -> None:

    known, names = PLUGINS[name], {"model": "rover", "world": "w"}
    ways = dict.fromkeys(("", "topic", "sub_topic"), "own/name")
    for flags, (parameter, topic) in itertools.product(("", "false", "true"), ways.items()):
        if parameter and parameter not in known.parameters:
            continue
        content = content_of(name, flags=flags, **({parameter: topic} if parameter else {}))
        element = plugin(filename_of(name), content)
        expected = [
            (topic, one.type if is_of_classic(name) else PAIRS[one.type][0], one.is_read)
            for _, one, topic in known.topic_names(element.get, names)
        ]
        found, warnings = started(name, content)
        assert found, warnings
        assert sorted(found) == sorted(expected)


@pytest.mark.parametrize("name", WITHOUT_A_JOINT)
def test_plugins_with_a_joint_that_is_not_there(name: str) -> None:
    known = PLUGINS[name]
    (first, *_) = known.joints
    content = f"<{first}>nowhere</{first}>{content_of(name)}"
    found, warnings = started(name, content)
    assert "nowhere" in warnings[0]
    goes_on = not any("does not work" in one for one in warnings)
    assert goes_on is WITHOUT_A_JOINT[name]
    assert bool(found) >= goes_on


def test_an_empty_parameter_in_the_name_of_a_topic_is_named() -> None:
    content = "<joint_name></joint_name><joint_name>rear_left</joint_name>"
    _, (warning,) = started("joint-controller", content)
    assert "`/model/{model}/joint/{joint_name}/cmd_vel` is empty" in warning


def test_all_plugins_with_joints_are_among_them() -> None:
    assert WITHOUT_A_JOINT.keys() == {name for name in OF_ROBOTS if PLUGINS[name].joints}
    assert all(stem(filename_of(name)) == name for name in (*OF_ROBOTS, *WORLD_PLUGINS))
