"""The world of a live run: robots come and go, plugins are updated, time passes."""

from __future__ import annotations

import importlib
import json
import math
import os
import signal
import subprocess
import sys
import time
import types
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from live.nodes.fake_ros import (
    ROVER,
    FakeRos,
    live_scene,
    plugin,
    rover_engine,
    simulation_of,
    still_at,
)
from wsgen.isolation.codec import encode
from wsgen.live.nodes.signals import ignore_ends
from wsgen.model.devices import Devices, Element, MountedSensor
from wsgen.model.transform import Pose
from wsgen.simulation.live_runs import (
    FOLDER_VARIABLE,
    POSE_LOG_FILE,
    SCENE_FILE,
    UNHEARD_FILE,
    LiveScene,
    NewEntity,
    PreparedEntity,
    read_pose_log,
)
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from wsgen.model.robot import Robot
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
    from wsgen.live.nodes.simulator.simulation import RefusedError  # noqa: PLC0415

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
            plugin("gz-sim-navsat-system"),
            plugin("ignition-gazebo-air-pressure-system"),
            plugin("libgazebo_ros_diff_drive.so", "<left_joint>lef</left_joint>"),
            plugin("libgazebo_ros_joint_state_publisher.so", "<update_rate>fast</update_rate>"),
        )
    )
    simulation.spawn("rover")
    simulation.delete("rover")
    simulation.spawn("rover")
    unknown, drive, states = ros.warnings
    assert "`rover`: wsgen does not simulate the plugin `libmy_plugin.so`." in unknown
    assert "`libgazebo_ros_diff_drive.so` does not work: its diff drive plugin names the" in drive
    assert "the joint `lef`, but the robot has no revolute or continuous joint" in drive
    assert "it does not name a joint of the robot" in states


@pytest.mark.parametrize("problem", [ZeroDivisionError("division by zero"), ValueError("negative")])
def test_a_plugin_that_cannot_compute_is_named_and_all_else_goes_on(
    problem: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    from wsgen.live.nodes.simulator.plugins import diff_drive  # noqa: PLC0415  with fakes

    def fails(*_: Any) -> None:
        raise problem

    monkeypatch.setattr(diff_drive, "ClassicDiffDrive", fails)
    simulation, ros = simulation_of(live_scene(plugin("libgazebo_ros_diff_drive.so"), JOINT_STATES))
    simulation.spawn("rover")
    simulation.advance(0.2)
    assert ros.published("/joint_states")
    (warning,) = ros.warnings
    assert f"does not work: wsgen cannot compute with its numbers ({problem})" in warning


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
    assert not control.passes(1.0)
    control.seconds = 0.015  # single steps
    assert control.next(1.0, 0.01) == pytest.approx(1.01)
    assert control.next(1.01, 0.01) == pytest.approx(1.015)
    assert not control.passes(1.0)
    control.is_paused = False
    assert control.next(1.0, 0.01) == pytest.approx(1.01)


def clock_times(messages: list[Any]) -> list[float]:
    return [message.clock.sec + message.clock.nanosec / 1e9 for message in messages]


def test_the_clock_and_the_services_of_classic() -> None:
    from wsgen.live.nodes.simulator.services import offer_services  # noqa: PLC0415

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
    from wsgen.live.nodes.simulator.services import offer_services  # noqa: PLC0415
    from wsgen.live.nodes.simulator.topics import Rule  # noqa: PLC0415

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
    from wsgen.live.nodes.simulator.commands import CommandServer  # noqa: PLC0415

    simulation, ros = simulation_of(live_scene(simulator="gz"))
    server = CommandServer(tmp_path, simulation)
    words = ["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock", "/a@std_msgs/msg/Bool[gz.msgs.Bol"]
    with subprocess.Popen(
        [sys.executable, "-m", "wsgen.live.nodes.bridge", *words, "--ros-args", "-r", "a:=b"],
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


@pytest.mark.slow
def test_the_socket(tmp_path: Path) -> None:
    from threading import Thread  # noqa: PLC0415

    from wsgen.live.nodes.simulator.commands import CommandServer  # noqa: PLC0415
    from wsgen.simulation.live_runs import SimulatorClient, SimulatorError  # noqa: PLC0415

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
            ("poses", {}),
            ("step", {"seconds": 0.5}),
            ("step", {"seconds": -1}),
        ):
            answers.append(ask(with_simulator, command, values))
        with_simulator.close()

    thread = Thread(target=client)
    thread.start()
    have_taken_time = 0
    while thread.is_alive():
        have_taken_time += server.answer()
    assert 1 <= have_taken_time <= 5  # to spawn and to connect, but not to tell
    thread.join()
    assert answers[0] == {"ok": True, "entity": "rover"}
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
    assert answers[8]["links"]["rover"]["base"] == pytest.approx([0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    assert (answers[8]["robots"], answers[8]["is_paused"]) == ({"rover": 1}, True)
    assert simulation.control.seconds == pytest.approx(0.5)
    assert "cannot step by -1 s" in answers[10]
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


def test_what_comes_with_the_name_of_a_prepared_robot_is_prepared_anew(tmp_path: Path) -> None:
    from queue import SimpleQueue  # noqa: PLC0415

    from wsgen.live.nodes.simulator.commands import CommandServer, _Connection  # noqa: PLC0415

    there = Pose((0.0, 0.0, 0.1))
    simulation, _ = simulation_of(live_scene(descriptions={"rover": "<robot/>"}))
    prepared: list[NewEntity] = []

    def prepare(new: NewEntity) -> PreparedEntity:
        prepared.append(new)
        robot = SpawnedRobot(entity=new.entity, robot=ROVER, pose_in_world=new.pose_in_world)
        return PreparedEntity(robot=robot)

    simulation.prepare = prepare
    server = CommandServer(tmp_path, simulation)

    def understand(x: float, text: str = "<robot/>", *, renames: bool = False) -> Any:
        new = NewEntity(entity="rover", text=text, pose_in_world=replace(there, xyz=(x, 0.0, 0.1)))
        request = {"do": "spawn", "entity": "rover", "renames": renames}
        return server._understand(
            json.dumps({**request, "new": json.loads(encode(new))}).encode() + b"\n"
        )

    def do(request: Any) -> Any:
        answer: Any = server._do(request, _Connection(), SimpleQueue())
        return answer.get("entity", answer.get("error"))

    assert do(understand(5.0, renames=True)) == "rover"  # not what has been prepared
    assert simulation.host.robots["rover"].spawned.pose_in_world.xyz[0] == 5.0

    # Two of the launch file at the same time.
    simulation, _ = simulation_of(live_scene(descriptions={"rover": "<robot/>"}))
    simulation.prepare, server._simulation = prepare, simulation
    prepared.clear()
    requests = [understand(0.0, renames=True) for _ in range(2)]
    assert len(prepared) == 1
    assert [do(request) for request in requests] == ["rover", "rover_0"]
    assert "exists already" in do(understand(0.0))
    assert len(prepared) == 1

    simulation.delete("rover")
    assert do(understand(7.0)) == "rover"
    assert simulation.host.robots["rover"].spawned.pose_in_world.xyz[0] == 7.0

    # One that the engine refuses may come again.
    simulation, _ = simulation_of(live_scene())
    server._simulation = simulation
    simulation.engine.refuses = frozenset({"rover"})
    assert "refuses" in do(understand(0.0))
    simulation.engine.refuses = frozenset()
    assert do(understand(0.0)) == "rover"
    assert len(prepared) == 2
    server.close()


def test_names_that_ros_refuses_are_reported_and_all_else_goes_on(tmp_path: Path) -> None:
    from wsgen.gazebo.plugins import node_name  # noqa: PLC0415
    from wsgen.live.nodes.simulator.commands import CommandServer, _Connection  # noqa: PLC0415

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


def test_time_passes_up_to_its_limit() -> None:
    simulation, _ = simulation_of(live_scene(is_stepped=True))
    control = simulation.control
    assert not control.passes(0.0)
    control.limit = 0.015
    assert control.passes(0.0)
    assert control.next(0.0, 0.01) == pytest.approx(0.01)
    assert control.next(0.01, 0.01) == pytest.approx(0.015)
    assert not control.passes(0.015)
    simulation.advance(0.01)
    simulation.reset(with_time=True)  # as much as before is left
    assert control.limit == pytest.approx(0.005)


def test_the_pose_log_has_each_robot_as_it_was_spawned(tmp_path: Path) -> None:
    from wsgen.live.nodes.simulator.pose_logger import PoseLogger  # noqa: PLC0415

    simulation, _ = simulation_of(live_scene())
    logger = PoseLogger(simulation.host, tmp_path)

    def spawn(robot: Robot) -> str:
        made = SpawnedRobot(entity="rover", robot=robot)
        entity: str = simulation.spawn_prepared(PreparedEntity(robot=made), renames=True)
        return entity

    logger.update()  # nothing is there
    other = replace(ROVER, name="other")
    assert (spawn(ROVER), spawn(other)) == ("rover", "rover_0")
    logger.update()
    simulation.delete("rover")
    assert spawn(other) == "rover"
    logger.update()
    simulation.delete("rover")
    assert spawn(ROVER) == "rover"
    logger.update()
    logger.close()
    log = read_pose_log(tmp_path / POSE_LOG_FILE)
    assert [sorted(frame) for frame in log.frames] == [
        ["rover", "rover_0"],
        ["rover (2)", "rover_0"],
        ["rover", "rover_0"],
    ]
    assert {robot.entity: robot.robot for robot in log.robots} == {
        "rover": ROVER,
        "rover_0": other,
        "rover (2)": other,
    }
    assert log.corners.keys() == {"rover", "rover_0", "rover (2)"}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a full device")
def test_a_full_disk_ends_the_pose_log_and_nothing_else(tmp_path: Path) -> None:
    from wsgen.live.nodes.simulator.host import Due  # noqa: PLC0415  with fakes
    from wsgen.live.nodes.simulator.pose_logger import PoseLogger  # noqa: PLC0415  likewise

    (tmp_path / POSE_LOG_FILE).symlink_to("/dev/full")
    simulation, ros = simulation_of(live_scene(JOINT_STATES))
    simulation.add(Due(plugin=PoseLogger(simulation.host, tmp_path), robot=None, name="pose log"))
    simulation.advance(0.2)
    simulation.spawn("rover")
    simulation.advance(0.5)
    simulation.reset(with_time=False)
    simulation.advance(1.0)
    assert ros.published("/joint_states")[-1].header.stamp.nanosec == pytest.approx(95e7)
    simulation.close()
    (warning,) = ros.warnings
    assert "The video ends at 0.20 s" in warning
    assert "the disk is full" in warning


def test_a_signal_while_the_simulator_begins_ends_it_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class ClosingRos(FakeRos):
        def close(self) -> None:
            closed.append("ROS")

    def interrupt(*_: Any) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)

    closed: list[str] = []
    joined = ClosingRos()
    joined.read["/cmd_vel"] = joined.read["/arm"] = "geometry_msgs/msg/Twist"
    joined.senders.add("/arm")
    ros: Any = types.ModuleType("ros")
    ros.Ros = lambda _: joined
    monkeypatch.setitem(sys.modules, "wsgen.live.nodes.simulator.ros", ros)
    program = _program(monkeypatch)
    monkeypatch.setattr(program, "make_engine", lambda *_: rover_engine())
    monkeypatch.setattr(program, "CommandServer", interrupt)
    (tmp_path / SCENE_FILE).write_text(encode(live_scene()))
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["simulator"])
    try:
        assert program.main() == 0
        assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0  # it is not raised again
    finally:
        ignore_ends()
    assert closed == ["ROS"]
    unheard = tmp_path / UNHEARD_FILE
    assert json.loads(unheard.read_text()) == {"/cmd_vel": "geometry_msgs/msg/Twist"}
    unheard.unlink()
    joined.has_heard = True
    program.note_unheard(tmp_path, joined)
    assert not unheard.exists()


def _program(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the simulator's process, with what it imports from ROS replaced."""
    name = "wsgen.live.nodes.simulator.__main__"
    monkeypatch.delitem(sys.modules, name, raising=False)
    program = importlib.import_module(name)
    monkeypatch.delitem(sys.modules, name)
    return program


@pytest.mark.slow
@pytest.mark.parametrize("is_recorded", [False, True])
def test_time_is_slow_until_the_recorder_has_found_the_topics(
    monkeypatch: pytest.MonkeyPatch, *, is_recorded: bool
) -> None:
    module: Any = types.ModuleType("ros")
    module.Ros = None
    monkeypatch.setitem(sys.modules, "wsgen.live.nodes.simulator.ros", module)
    program = _program(monkeypatch)
    monkeypatch.setattr(program, "LOOK_AT_TOPICS", 0.0)
    simulation, _ = simulation_of(replace(live_scene(), is_recorded=is_recorded))
    simulation.spawn("rover")
    unheard = [True]
    ros = types.SimpleNamespace(has_unheard_topics=lambda: unheard[0])
    pace = program.Pace(None)
    arrival = program.Arrival(simulation, pace, ros)
    assert pace.rate == 1.0
    arrival.look()
    assert pace.rate == (1.0 if is_recorded else None)
    unheard[0] = False
    arrival.look()
    assert pace.rate is None


def test_seconds_that_are_none(tmp_path: Path) -> None:
    from queue import SimpleQueue  # noqa: PLC0415

    from wsgen.live.nodes.simulator.commands import CommandServer, _Connection  # noqa: PLC0415

    simulation, _ = simulation_of(live_scene(is_stepped=True))
    server = CommandServer(tmp_path, simulation)

    def do(command: str, seconds: Any) -> Any:
        request = {"do": command, "seconds": seconds}
        return server._do(request, _Connection(), SimpleQueue())

    for seconds in (True, -1, math.nan, math.inf, 10**400, "1", None):
        for command in ("step", "advance"):
            assert "error" in do(command, seconds), (command, seconds)
    assert "error" in do("step", 0)
    assert (simulation.control.seconds, simulation.control.limit) == (0.0, 0.0)
    assert do("step", 1)["ok"]
    assert do("advance", 0) is None  # it is answered when that has passed
    server.close()


SENSING = MountedSensor(
    name="lidar",
    kind="gpu_lidar",
    link="base_link",
    frame="base_link",
    element=Element(tag="sensor"),
)
ALL_DEFAULT = ("Physics", "SceneBroadcaster", "UserCommands")
BROUGHT = Element(
    tag="plugin",
    attributes={"filename": "libgz-sim-sensors-system.so", "name": "gz::sim::systems::Sensors"},
)


class Silent:
    """A sensor that counts how often it is updated."""

    period = 0.1
    updates = 0

    def __init__(self, *_: Any) -> None:
        """Nothing is needed."""

    def update(self) -> None:
        Silent.updates += 1

    def close(self) -> None:
        """Nothing is open."""


@pytest.fixture
def _silent(messages: None, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = importlib.import_module("wsgen.live.nodes.simulator.simulation")
    monkeypatch.setitem(simulation.SENSORS, "gpu_lidar", f"{__name__}:Silent")
    monkeypatch.setattr(Silent, "updates", 0)


def sensing(systems: tuple[str, ...] | None, *plugins: Element) -> LiveScene:
    scene = live_scene(simulator="gz", systems=systems)
    return replace(scene, devices={"rover": Devices(plugins=plugins, sensors=(SENSING,))})


@pytest.mark.usefixtures("_silent")
@pytest.mark.parametrize(
    ("systems", "updates"),
    [(None, 10), ((*ALL_DEFAULT, "Sensors"), 10), (ALL_DEFAULT, 0)],
)
def test_a_sensor_works_where_its_system_is_loaded(
    systems: tuple[str, ...] | None, updates: int
) -> None:
    simulation, ros = simulation_of(sensing(systems))
    simulation.spawn("rover")
    simulation.advance(1.0)
    assert Silent.updates == updates
    assert len(ros.warnings) == (updates == 0)
    if not updates:
        assert "does not load the system Sensors" in ros.warnings[0]
        assert 'Add <plugin filename="gz-sim-sensors-system"' in ros.warnings[0]


@pytest.mark.usefixtures("_silent")
def test_a_robot_may_bring_the_system() -> None:
    simulation, ros = simulation_of(sensing(ALL_DEFAULT, BROUGHT))
    simulation.spawn("rover")
    simulation.advance(1.0)
    assert Silent.updates == 10
    assert not ros.warnings


@pytest.mark.usefixtures("_silent")
def test_a_robot_that_comes_later_brings_the_system_for_all() -> None:
    scene = sensing(ALL_DEFAULT)
    (rover,) = scene.scene.robots
    other = replace(rover, entity="other")
    scene = replace(
        scene,
        scene=replace(scene.scene, robots=(rover, other)),
        devices={**scene.devices, "other": Devices(plugins=(BROUGHT,))},
    )
    simulation, _ = simulation_of(scene)
    simulation.spawn("rover")
    simulation.advance(1.0)
    assert Silent.updates == 0
    simulation.spawn("other")
    simulation.advance(2.0)
    assert Silent.updates == 10


def test_without_user_commands_nothing_is_spawned_or_deleted() -> None:
    from wsgen.live.nodes.simulator.simulation import RefusedError  # noqa: PLC0415

    systems = ("Physics", "SceneBroadcaster")
    simulation, _ = simulation_of(live_scene(simulator="gz", systems=systems))
    with pytest.raises(RefusedError, match="does not load the system UserCommands"):
        simulation.spawn("rover")
    simulation, _ = simulation_of(live_scene(simulator="gz", systems=systems, in_world=("rover",)))
    assert list(simulation.host.robots) == ["rover"]
    with pytest.raises(RefusedError, match="UserCommands"):
        simulation.delete("rover")


def test_without_physics_time_passes_and_nothing_moves() -> None:
    engine = rover_engine()
    scene = live_scene(simulator="gz", systems=("UserCommands", "SceneBroadcaster"))
    simulation, ros = simulation_of(scene, engine)
    simulation.spawn("rover")
    simulation.advance(1.0)
    assert simulation.now == pytest.approx(1.0)
    assert engine.steps == 0
    (warning,) = ros.warnings
    assert "does not load the system Physics: nothing in it moves" in warning
