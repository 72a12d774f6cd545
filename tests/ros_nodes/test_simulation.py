"""The world of a live run: robots come and go, plugins are updated, time passes."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
import types
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from ros_nodes.fake_ros import live_scene, plugin, rover_engine, simulation_of, still_at
from wsgen.simulation.live_scene import FOLDER_VARIABLE

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.simulation.engine import State

pytestmark = pytest.mark.usefixtures("messages")
JOINT_STATES = plugin(
    "libgazebo_ros_joint_state_publisher.so",
    "<update_rate>20</update_rate><joint_name>left</joint_name>",
)


def test_robots_come_when_they_are_spawned_and_go_when_they_are_deleted() -> None:
    simulation, ros = simulation_of(live_scene(JOINT_STATES))
    simulation.advance(0.5)
    assert not ros.published("/joint_states")
    simulation.spawn("rover")
    simulation.advance(1.0)
    stamps = [message.header.stamp for message in ros.published("/joint_states")]
    times = [stamp.sec + stamp.nanosec / 1e9 for stamp in stamps]
    assert times == pytest.approx([0.5 + count * 0.05 for count in range(10)])
    simulation.delete("rover")
    simulation.advance(2.0)
    assert simulation.engine.removed == ["rover"]
    assert not ros.nodes
    simulation.spawn("rover")  # the name is free again
    assert list(simulation.host.robots) == ["rover"]


def test_what_is_in_the_world_is_there_from_the_beginning() -> None:
    simulation, _ = simulation_of(live_scene(in_world=("rover",)))
    assert list(simulation.host.robots) == ["rover"]


def test_commands_that_cannot_be_done() -> None:
    from wsgen.ros_nodes.simulator.simulation import RefusedError  # noqa: PLC0415

    simulation, _ = simulation_of(live_scene())
    with pytest.raises(RefusedError, match="spawns no robot `rower`"):
        simulation.spawn("rower")
    with pytest.raises(RefusedError, match="No entity `rover`"):
        simulation.delete("rover")
    simulation.spawn("rover")
    with pytest.raises(RefusedError, match="exists already"):
        simulation.spawn("rover")
    engine = rover_engine()
    engine.refuses = frozenset({"rover"})
    simulation, _ = simulation_of(live_scene(), engine)
    with pytest.raises(RefusedError, match="The engine refuses `rover`: the script says so"):
        simulation.spawn("rover")


def test_unknown_plugins_and_wrong_parameters_are_named_once() -> None:
    simulation, ros = simulation_of(
        live_scene(
            plugin("libmy_plugin.so"),
            plugin("libgazebo_ros_state.so"),
            plugin("libgazebo_ros_diff_drive.so", "<left_joint>lef</left_joint>"),
            plugin("libgazebo_ros_joint_state_publisher.so", "<update_rate>fast</update_rate>"),
        )
    )
    simulation.spawn("rover")
    simulation.delete("rover")
    simulation.spawn("rover")
    unknown, drive, states = ros.warnings
    assert "`rover`: wsgen does not simulate the plugin `libmy_plugin.so`." in unknown
    assert "`libgazebo_ros_diff_drive.so` does not work: the robot has no joint `lef`" in drive
    assert "it names no joint of the robot" in states


def test_a_robot_that_explodes_is_named_and_taken_out() -> None:
    def motion(seconds: float) -> State:
        state = still_at()(seconds)
        return state if seconds < 0.5 else replace(state, speed=math.nan)

    simulation, ros = simulation_of(live_scene(JOINT_STATES), rover_engine(motion))
    simulation.spawn("rover")
    simulation.advance(1.0)
    assert not simulation.host.robots
    assert "`rover` exploded at 0.5" in ros.warnings[0]
    simulation.advance(2.0)
    assert simulation.now == pytest.approx(2.0)


@pytest.mark.parametrize("with_time", [True, False])
def test_reset(*, with_time: bool) -> None:
    simulation, ros = simulation_of(live_scene(JOINT_STATES))
    simulation.spawn("rover")
    simulation.advance(0.2)
    simulation.reset(with_time=with_time)
    assert simulation.now == pytest.approx(0.0 if with_time else 0.2)
    before = len(ros.published("/joint_states"))
    simulation.advance(simulation.now + 0.1)
    assert len(ros.published("/joint_states")) == before + 2


def test_time_passes_in_whole_steps_to_what_is_due() -> None:
    simulation, _ = simulation_of(live_scene(JOINT_STATES))
    simulation.spawn("rover")
    calls: list[int] = []
    advance = simulation.engine.advance

    def counted(steps: int) -> None:
        calls.append(steps)
        advance(steps)

    simulation.engine.advance = counted
    simulation.advance(0.12)
    assert calls == [50, 50, 20]


def test_control_of_time() -> None:
    simulation, _ = simulation_of(live_scene(is_paused=True))
    control = simulation.control
    assert not control.passes
    control.seconds = 0.015  # single steps
    assert control.next(1.0, 0.01) == pytest.approx(1.01)
    assert control.next(1.01, 0.01) == pytest.approx(1.015)
    assert not control.passes
    control.is_paused = False
    assert control.next(1.0, 0.01) == pytest.approx(1.01)


def clock_times(messages: list[Any]) -> list[float]:
    return [message.clock.sec + message.clock.nanosec / 1e9 for message in messages]


def test_the_clock_and_the_services_of_classic() -> None:
    from wsgen.ros_nodes.simulator.services import offer_services  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene())
    offer_services(simulation)
    simulation.advance(0.35)
    assert clock_times(ros.published("/clock")) == pytest.approx([0.0, 0.1, 0.2, 0.3])
    ros.services["/pause_physics"](None, None)
    assert simulation.control.is_paused
    ros.services["/unpause_physics"](None, None)
    assert not simulation.control.is_paused
    ros.services["/reset_world"](None, None)
    assert simulation.now == pytest.approx(0.35)
    ros.services["/reset_simulation"](None, None)
    assert simulation.now == 0.0


def test_the_clock_of_gazebo_sim_needs_a_bridge(tmp_path: Path) -> None:
    from wsgen.ros_nodes.simulator.services import offer_services  # noqa: PLC0415
    from wsgen.ros_nodes.simulator.topics import Rule  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene(simulator="gz"))
    offer_services(simulation)
    simulation.advance(0.02)
    assert not ros.nodes
    rule = Rule("/clock", "/clock", "rosgraph_msgs/msg/Clock", "gz.msgs.Clock", "to_ros")
    simulation.host.gz.open(ros.node("bridge"), [rule])
    simulation.advance(0.03)
    assert clock_times(ros.published("/clock")) == pytest.approx([0.02, 0.025])
    assert not ros.services


@pytest.mark.slow
def test_the_program_of_a_bridge_ends_without_a_word(tmp_path: Path) -> None:
    from wsgen.ros_nodes.simulator.commands import CommandServer  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene(simulator="gz"))
    server = CommandServer(tmp_path, simulation)
    words = ["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock", "/a@std_msgs/msg/Bool[gz.msgs.Bol"]
    with subprocess.Popen(
        [sys.executable, "-m", "wsgen.ros_nodes.bridge", *words, "--ros-args", "-r", "a:=b"],
        env={**os.environ, FOLDER_VARIABLE: str(tmp_path)},
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        last = time.monotonic() + 60.0
        while not ros.nodes and time.monotonic() < last:
            server.answer()
        assert process.stderr is not None
        assert "Creating GZ->ROS Bridge: [/clock (gz.msgs.Clock)" in process.stderr.readline()
        assert "no message type gz.msgs.Bol" in process.stderr.readline()
        server.close()
        process.terminate()
        assert process.stderr.read() == ""
    assert process.returncode == 0
    assert ros.nodes[0].arguments == ["-r", "a:=b"]


def test_the_socket(tmp_path: Path) -> None:
    from threading import Thread  # noqa: PLC0415

    from wsgen.ros_nodes.simulator.commands import CommandServer  # noqa: PLC0415
    from wsgen.ros_nodes.simulator_client import SimulatorClient, SimulatorError  # noqa: PLC0415

    folder = tmp_path / ("long " * 40)  # a name that no address of a socket has room for
    folder.mkdir()
    simulation, ros = simulation_of(live_scene(simulator="gz"))
    server = CommandServer(folder, simulation)
    answers: list[Any] = []

    def ask(with_simulator: SimulatorClient, command: str, values: dict[str, Any]) -> Any:
        try:
            return with_simulator.ask(command, **values)
        except SimulatorError as error:
            return error.message

    def client() -> None:
        with_simulator = SimulatorClient(folder)
        assert with_simulator.connect(5.0)
        rule = {
            "ros_topic": "/clock",
            "gz_topic": "/clock",
            "ros_type": "rosgraph_msgs/msg/Clock",
            "gz_type": "gz.msgs.Clock",
            "direction": "to_ros",
        }
        service = {
            "ros_topic": "/world/w/control",
            "gz_topic": "/world/w/control",
            "ros_type": "ros_gz_interfaces/srv/ControlWorld",
            "gz_type": "",
            "direction": "service",
        }
        for command, values in (
            ("spawn", {"entity": "rover"}),
            ("spawn", {"entity": "rover"}),
            ("state", {}),
            ("jump", {}),
            ("pause", {}),
            ("bridge", {"rules": [rule, {**rule, "gz_type": "gz.msgs.X"}]}),
            ("bridge", {"rules": [{}]}),
            ("bridge", {"rules": [service, {**service, "gz_topic": "/world/v/control"}]}),
        ):
            answers.append(ask(with_simulator, command, values))
        with_simulator.close()

    thread = Thread(target=client)
    thread.start()
    while thread.is_alive():
        server.answer()
    thread.join()
    assert answers[0] == {"ok": True}
    assert "exists already" in answers[1]
    assert answers[2]["entities"] == ["rover"]
    assert answers[2]["poses"]["rover"] == pytest.approx([0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0])
    assert "no command `jump`" in answers[3]
    assert simulation.control.is_paused
    assert answers[5]["problems"][0] is None
    assert "gz.msgs.X" in answers[5]["problems"][1]
    assert "does not understand the rule {}" in answers[6]
    assert answers[7]["problems"][0] is None
    assert "no service /world/v/control" in answers[7]["problems"][1]
    steps = types.SimpleNamespace(
        pause=True,
        step=False,
        multi_step=5,
        reset=types.SimpleNamespace(all=False, time_only=False, model_only=False),
    )
    request, answer = types.SimpleNamespace(world_control=steps), types.SimpleNamespace()
    assert ros.services["/world/w/control"](request, answer).success
    assert simulation.control.seconds == pytest.approx(0.005)
    last = time.monotonic() + 60.0
    while ros.nodes and time.monotonic() < last:  # the bridge ends with its connection
        server.answer()
    assert not ros.nodes
    server.close()
    assert not SimulatorClient(folder).connect(0.0)


def test_names_that_ros_refuses_are_told_and_all_else_goes_on(tmp_path: Path) -> None:
    from wsgen.ros_nodes.simulator.commands import CommandServer, _Connection  # noqa: PLC0415
    from wsgen.ros_nodes.simulator.names import node_name  # noqa: PLC0415

    bad = "<ros><namespace>my-robot</namespace></ros>"
    simulation, ros = simulation_of(
        live_scene(
            plugin("libgazebo_ros_planar_move.so", bad), plugin("libgazebo_ros_planar_move.so")
        )
    )
    simulation.spawn("rover")
    (warning,) = ros.warnings
    assert "planar_move.so` does not work: ROS refuses `my-robot`" in warning
    assert len(ros.readers["/cmd_vel"]) == 1
    server = CommandServer(tmp_path, simulation)
    rule = {
        "ros_topic": "/clock",
        "gz_topic": "/clock",
        "ros_type": "rosgraph_msgs/msg/Clock",
        "gz_type": "gz.msgs.Clock",
        "direction": "both",
    }
    rules = [{**rule, "ros_topic": "/my-robot/clock"}, rule]
    problem, good = server._bridge({"rules": rules}, _Connection())["problems"]
    assert "ROS refuses `/my-robot/clock`" in problem
    assert "ros_topic_name" in problem
    assert good is None
    server.close()
    assert node_name("2ä::front-camera") == "_2___front_camera"
