"""ros2_control in the simulator, its spawner and its controllers, as real nodes see them."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from ros.test_nodes import node
from ros.test_simulator import WAIT, run, simulator
from ros_for_tests import ros_with, variables_for
from wsgen.descriptions.urdf.devices import read_devices
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.world import World
from wsgen.simulation.live_runs import LiveScene
from wsgen.simulation.scene import Scene, SpawnedRobot

pytestmark = pytest.mark.slow
USER = Path(__file__).with_name("arm_user.py")
PLUGINS = {
    "gz": ("gz_ros2_control-system", "gz_ros2_control/GazeboSimSystem"),
    "classic": ("libgazebo_ros2_control.so", "gazebo_ros2_control/GazeboSystem"),
}
PARAMETERS = """
controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    arm_controller: {type: joint_trajectory_controller/JointTrajectoryController}
    forward_controller: {type: position_controllers/JointGroupPositionController}
arm_controller:
  ros__parameters:
    joints: [joint_1, joint_2]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
forward_controller:
  ros__parameters:
    joints: [joint_1, joint_2]
"""


def arm(simulator_name: str, parameters: Path) -> LiveScene:
    """A scene with an arm of two joints."""
    inertial = (
        "<inertial><origin xyz='0 0 0.15'/><mass value='1'/>"
        "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
    )
    limit = "<limit lower='-2' upper='2' effort='50' velocity='2'/>"
    filename, hardware = PLUGINS[simulator_name]
    parts = "".join(
        f"<link name='link_{number}'>{inertial}</link>"
        f"<joint name='joint_{number}' type='revolute'><parent link='{parent}'/>"
        f"<child link='link_{number}'/><origin xyz='0 0 0.3'/><axis xyz='0 1 0'/>{limit}</joint>"
        for number, parent in ((1, "world"), (2, "link_1"))
    )
    controls = "".join(
        f"<joint name='joint_{number}'><command_interface name='position'/>"
        "<state_interface name='position'/><state_interface name='velocity'/></joint>"
        for number in (1, 2)
    )
    text = (
        f"<robot name='arm'><link name='world'/>{parts}<ros2_control name='all' type='system'>"
        f"<hardware><plugin>{hardware}</plugin></hardware>{controls}</ros2_control>"
        f"<gazebo><plugin filename='{filename}' name='control'>"
        f"<parameters>{parameters}</parameters></plugin></gazebo></robot>"
    )
    robot, _ = read_urdf(text, file=None)
    assert robot is not None
    lumped, _ = lump(robot)
    return LiveScene(
        scene=Scene(world=World(name="w"), robots=(SpawnedRobot(entity="arm", robot=lumped),)),
        simulator=simulator_name,
        devices={"arm": read_devices(text, robot, lumped)},
        descriptions={"arm": text},
        in_world=("arm",),
        rate=5.0,
    )


@pytest.mark.parametrize("simulator_name", ["gz", "classic"])
def test_a_node_moves_an_arm(simulator_name: str, tmp_path: Path) -> None:
    variables = variables_for(ros_with("control_msgs", "controller_manager_msgs"))
    parameters = tmp_path / "controllers.yaml"
    parameters.write_text(PARAMETERS)
    scene = replace(arm(simulator_name, parameters), seconds=None)
    with simulator(scene, tmp_path, variables) as (process, environment):
        for arguments, text in (
            (("joint_state_broadcaster", "arm_controller"), "Configured and activated "),
            (("forward_controller", "--inactive"), "Loaded "),
        ):
            code, printed = run("controller_spawner", *arguments, environment=environment)
            assert code == 0, printed
            assert text in printed
        code, printed = run("controller_spawner", "nothing", environment=environment)
        assert code == 1
        assert "Failed loading controller nothing" in printed
        user = subprocess.run(
            [sys.executable, str(USER)],
            env=environment,
            capture_output=True,
            text=True,
            timeout=WAIT,
            check=False,
        )
        assert (user.returncode, process.poll()) == (0, None), user.stderr
        code, printed = run(
            "controller_spawner", "--unspawn", "forward_controller", environment=environment
        )
        assert (code, "Unloaded controller" in printed) == (0, True), printed
        process.terminate()
        _, warnings = process.communicate(timeout=WAIT)
    seen = json.loads(user.stdout)
    assert seen["names"] == seen["joints"] == ["joint_1", "joint_2"]
    assert seen["controllers"] == {
        "joint_state_broadcaster": "active",
        "arm_controller": "active",
        "forward_controller": "inactive",
    }
    assert seen["claimed"] == ["joint_1/position", "joint_2/position"]
    # Status of the goal (4 succeeded, 5 canceled, 6 aborted) and error code of the result.
    assert seen["reached"] == [4, 0]
    assert seen["after_goal"] == pytest.approx([0.5, -0.4], abs=0.01)
    # Gazebo Classic puts joints where they are told, however fast that is.
    assert seen["off_path"] == ([6, -4] if simulator_name == "gz" else [4, 0])
    assert seen["preempted"] == [6, -1]
    assert seen["canceled"] == [5, 0]
    assert seen["refused"]
    assert seen["after_topic"] == pytest.approx([0.3, -0.3], abs=0.01)
    assert seen["switched"] == [False, True]
    assert seen["after_command"] == pytest.approx([0.25, 0.15], abs=0.01)
    assert "'nothing'" in warnings
    assert process.returncode == 0


def test_the_hardware_of_an_sdf_is_in_the_urdf_that_comes(tmp_path: Path) -> None:
    """As `gz_ros2_control` has it: an SDF cannot have <ros2_control>."""
    variables = variables_for(ros_with("control_msgs", "controller_manager_msgs"))
    parameters, urdf = tmp_path / "controllers.yaml", tmp_path / "arm.urdf"
    parameters.write_text(PARAMETERS)
    of_urdf = arm("gz", parameters)
    urdf.write_text(of_urdf.descriptions["arm"])
    devices = {"arm": replace(of_urdf.devices["arm"], ros2_control=())}
    scene = replace(of_urdf, devices=devices, descriptions={}, seconds=None)
    with simulator(scene, tmp_path, variables) as (process, environment):
        assert process.stderr is not None
        while "waits for a URDF" not in (line := process.stderr.readline()):
            assert line, "the simulator has ended"
        assert "on the topic /robot_description" in line
        with node("robot_state_publisher", str(urdf), environment=environment):
            code, printed = run("controller_spawner", "arm_controller", environment=environment)
        assert code == 0, printed
        assert "Configured and activated " in printed
        process.terminate()
        _, printed = process.communicate(timeout=WAIT)
        assert process.returncode == 0, printed
