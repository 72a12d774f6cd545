"""A car with a gripper, an arm and a force-torque sensor, as real nodes see it."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from ros.test_simulator import WAIT, run, simulator
from ros_for_tests import ros_with, variables_for
from wsgen.descriptions.urdf.devices import read_devices
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.scene import Scene, SpawnedRobot

pytestmark = pytest.mark.slow
USER = Path(__file__).with_name("car_user.py")
MESSAGES = ("control_msgs", "controller_manager_msgs", "actuator_msgs")
PARAMETERS = """
controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    car_controller: {type: ackermann_steering_controller/AckermannSteeringController}
    gripper_controller: {type: position_controllers/GripperActionController}
    wrench_broadcaster: {type: force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster}
car_controller:
  ros__parameters:
    traction_joints_names: [rear_right, rear_left]
    steering_joints_names: [right_steer, left_steer]
    wheelbase: 0.5
    traction_track_width: 0.4
    traction_wheels_radius: 0.1
gripper_controller:
  ros__parameters: {joint: finger, goal_tolerance: 0.002, stall_timeout: 0.3}
wrench_broadcaster:
  ros__parameters: {sensor_name: wrist, frame_id: tool}
"""
LOAD = 0.5  # kg
BRIDGE = (
    "/actuators@actuator_msgs/msg/Actuators]gz.msgs.Actuators",
    "/forcetorque@geometry_msgs/msg/WrenchStamped[gz.msgs.Wrench",
)


def link(name: str, mass: float, moment: float, shape: str = "") -> str:
    inertia = f"<inertia ixx='{moment}' iyy='{moment}' izz='{moment}' ixy='0' ixz='0' iyz='0'/>"
    touches = f"<collision><origin rpy='{math.pi / 2} 0 0'/>{shape}</collision>" if shape else ""
    return (
        f"<link name='{name}'><inertial><mass value='{mass}'/>{inertia}</inertial>{touches}</link>"
    )


def joint(name: str, kind: str, parent: str, *, xyz: str, axis: str, more: str = "") -> str:
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{name}_link'/>"
        f"<origin xyz='{xyz}'/><axis xyz='{axis}'/>{more}</joint>"
    )


def car(parameters: Path) -> str:
    """The URDF of the car."""
    wheel = "<geometry><cylinder radius='0.1' length='0.04'/></geometry>"
    parts = [link("base", 8.0, 0.2)]
    for side, y in (("left", 0.2), ("right", -0.2)):
        parts += [
            joint(f"{side}_steer", "continuous", "base", xyz=f"0.25 {y} 0", axis="0 0 1"),
            link(f"{side}_steer_link", 0.3, 0.003),
            joint(f"front_{side}", "continuous", f"{side}_steer_link", xyz="0 0 0", axis="0 1 0"),
            link(f"front_{side}_link", 0.5, 0.0025, wheel),
            joint(f"rear_{side}", "continuous", "base", xyz=f"-0.25 {y} 0", axis="0 1 0"),
            link(f"rear_{side}_link", 0.5, 0.0025, wheel),
        ]
    limit = "<limit lower='{}' upper='{}' effort='20' velocity='1'/>".format
    parts += [
        joint("finger", "prismatic", "base", xyz="0 0 0.2", axis="1 0 0", more=limit(0, 0.08)),
        link("finger_link", 0.1, 0.001),
        joint("arm", "revolute", "base", xyz="0 0 0.3", axis="0 0 1", more=limit(-1, 1)),
        link("arm_link", 0.2, 0.001),
        joint("tool", "fixed", "arm_link", xyz="0 0 0.1", axis="1 0 0"),
        link("tool_link", LOAD, 0.001),
    ]
    controls = "".join(
        f"<joint name='{name}'><command_interface name='{kind}'/>"
        "<state_interface name='position'/><state_interface name='velocity'/></joint>"
        for name, kind in (
            *(("rear_left", "velocity"), ("rear_right", "velocity"), ("finger", "position")),
            *(("left_steer", "position"), ("right_steer", "position")),
        )
    )
    controls += "<joint name='arm'><state_interface name='position'/></joint>"
    states = "".join(
        f"<state_interface name='{part}.{axis}'/>" for part in ("force", "torque") for axis in "xyz"
    )
    return (
        f"<robot name='car'>{''.join(parts)}<ros2_control name='all' type='system'><hardware>"
        f"<plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>{controls}"
        f"<sensor name='wrist'>{states}</sensor></ros2_control>"
        "<gazebo reference='tool'><preserveFixedJoint>true</preserveFixedJoint>"
        "<sensor name='wrist' type='force_torque'><update_rate>100</update_rate>"
        "<topic>/forcetorque</topic></sensor></gazebo>"
        "<gazebo><plugin filename='gz_ros2_control-system' name='control'>"
        f"<parameters>{parameters}</parameters></plugin>"
        "<plugin filename='gz-sim-joint-position-controller-system' name='arm'>"
        "<joint_name>arm</joint_name><use_actuator_msg>true</use_actuator_msg>"
        "<actuator_number>1</actuator_number><use_velocity_commands>true</use_velocity_commands>"
        "<cmd_max>0.5</cmd_max></plugin></gazebo></robot>"
    )


def test_a_node_uses_a_car(tmp_path: Path) -> None:
    variables = variables_for(ros_with(*MESSAGES))
    parameters = tmp_path / "controllers.yaml"
    parameters.write_text(PARAMETERS)
    text = car(parameters)
    robot, diagnostics = read_urdf(text, file=None)
    assert robot is not None, diagnostics
    lumped, _ = lump(robot)
    spawned = SpawnedRobot(entity="car", robot=lumped, pose_in_world=Pose((0.0, 0.0, 0.1)))
    scene = LiveScene(
        scene=Scene(world=World(name="w", has_ground_plane=True), robots=(spawned,)),
        simulator="gz",
        devices={"car": read_devices(text, robot, lumped)},
        descriptions={"car": text},
        in_world=("car",),
        rate=3.0,
    )
    with simulator(replace(scene, seconds=None), tmp_path, variables) as (process, environment):
        bridge = subprocess.Popen(
            [sys.executable, "-m", "wsgen.live.nodes.bridge", *BRIDGE], env=environment
        )
        try:
            code, printed = run(
                "controller_spawner",
                *("joint_state_broadcaster", "car_controller", "gripper_controller"),
                "wrench_broadcaster",
                environment=environment,
            )
            assert code == 0, printed
            user = subprocess.run(
                [sys.executable, str(USER)],
                env=environment,
                capture_output=True,
                text=True,
                timeout=2 * WAIT,
                check=False,
            )
        finally:
            bridge.kill()
            bridge.wait()
        process.terminate()
        _, warnings = process.communicate(timeout=WAIT)
    assert user.returncode == 0, user.stderr + warnings
    seen = json.loads(user.stdout)
    assert seen["speed"] == pytest.approx([0.5, 0.25], rel=0.05)
    assert seen["frames"] == ["odom", "base_link"]
    # Status of the goal (4 succeeded, 6 aborted), whether it is there, and whether it stalled.
    assert seen["gripper"] == [[4, True, False], [6, False, True]]
    assert seen["finger"] == pytest.approx(0.08, abs=2e-3)
    for name, frame in (("wrench", "tool"), ("sensor", "car/tool/wrist")):
        assert seen[name][0] == frame
        assert seen[name][1:] == pytest.approx([0.0, 0.0, -LOAD * 9.8], abs=0.5)
