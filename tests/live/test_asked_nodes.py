"""What a launch file asks of nodes, and what is said where they do not do it."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from live_launch import wait_until
from own_network import ros_domain
from ros_for_tests import plain_environment, ros_with, variables_for
from wsgen.live.asked_nodes import LAUNCH_NODE, AskedNodes
from wsgen.model.plan import Process

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from live_launch import Launch

CONFIGURE, ACTIVATE = 1, 3
SECONDS = 200.0  # wall-clock, on a busy machine
REFUSING = ("/r/raises", "/r/bad")
NODE = """#!/usr/bin/env python3
import contextlib
import sys
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

class Talker(LifecycleNode):
    def on_configure(self, state):
        if sys.argv[1] == 'raises':
            raise ValueError('no map')
        return getattr(TransitionCallbackReturn, sys.argv[1])

rclpy.init()
with contextlib.suppress(KeyboardInterrupt):
    rclpy.spin(Talker('talker'))
"""
LAUNCH = """
import os
from launch import LaunchDescription
from launch.actions import EmitEvent, LogInfo, OpaqueFunction, RegisterEventHandler
from launch.events import matches_action
from launch_ros.actions import LifecycleNode, LifecycleTransition
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition

def say(context):
    event = context.locals.event
    print(f'{event.action.node_name}: {event.start_state} > {event.goal_state}', flush=True)

def generate_launch_description():
    program = os.path.join(os.path.dirname(__file__), 'talker.py')
    def node(name, namespace, does='SUCCESS', **more):
        return LifecycleNode(executable=program, name=name, namespace=namespace, arguments=[does],
                             output='screen', **more)
    good = node('good', '')
    def to(transition):
        return EmitEvent(event=ChangeState(
            lifecycle_node_matcher=matches_action(good), transition_id=transition))
    return LaunchDescription([
        RegisterEventHandler(OnStateTransition(entities=[OpaqueFunction(function=say)])),
        RegisterEventHandler(OnStateTransition(
            target_lifecycle_node=good, start_state='configuring', goal_state='inactive',
            entities=[LogInfo(msg='good is configured'), to(Transition.TRANSITION_ACTIVATE)])),
        good, to(Transition.TRANSITION_CONFIGURE),
        node('own', 'r', autostart=True),
        node('raises', 'r', 'raises', autostart=True),
        node('bad', 'r', 'FAILURE', autostart=True),
        node('t', ''),
        LifecycleTransition(lifecycle_node_names=['t'], transition_ids=[1, 3, 4, 2]),
    ])
"""
CONTAINER = """#!/usr/bin/env python3
import contextlib
import rclpy
from composition_interfaces.srv import LoadNode

rclpy.init()
node = rclpy.create_node('container')

def load(request, response):
    values = {one.name: one.value for one in request.parameters}
    extra = {one.name: one.value.bool_value for one in request.extra_arguments}
    print(request.package_name, request.plugin_name, request.node_name, request.node_namespace,
          request.remap_rules, values['rate'].double_value, list(values['ids'].integer_array_value),
          extra, flush=True)
    response.success = request.plugin_name == 'camera::Proc'
    response.full_node_name = f'{request.node_namespace}/{request.node_name}'
    response.error_message = '' if response.success else 'no such class'
    return response

node.create_service(LoadNode, '~/_container/load_node', load)
with contextlib.suppress(KeyboardInterrupt):
    rclpy.spin(node)
"""
LOAD = """
from launch_ros.descriptions import ComposableNode
def part(plugin, **more):
    return ComposableNode(package='camera', plugin=plugin, name='proc', **more,
                          parameters=[{'rate': 5.0, 'ids': [1, 2]}])
return LaunchDescription([
    PushRosNamespace('left'),
    ComposableNodeContainer(
        executable=os.environ['CONTAINER'], name='box', namespace='', output='screen',
        composable_node_descriptions=[part(
            'camera::Proc', namespace='own', remappings=[('image', 'raw')],
            extra_arguments=[{'use_intra_process_comms': True}])]),
    TimerAction(period=4.0, actions=[LoadComposableNodes(
        target_container='/left/box', composable_node_descriptions=[part('camera::None')])]),
])
"""


class Asking:
    """In the place of the process that asks."""

    def __init__(self) -> None:
        self.sent: list[tuple[str, dict[str, Any]]] = []
        self.reported: list[dict[str, Any]] | None = []
        self.is_closed = False

    def send(self, do: str, **values: Any) -> None:
        self.sent.append((do, values))

    def take(self) -> list[dict[str, Any]] | None:
        return self.reported

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def asking() -> Asking:
    return Asking()


@pytest.fixture
def left_out() -> list[str]:
    return []


@pytest.fixture
def asked(asking: Asking, left_out: list[str]) -> AskedNodes:
    made: Any = lambda: asking  # noqa: E731  all that is used of it
    return AskedNodes(made, lambda _: None, lambda what, why: left_out.append(f"{what}: {why}"))


def lifecycle_node(name: str = "/map") -> Any:
    return SimpleNamespace(node_name=name)


def test_a_node_that_refuses_a_transition_is_named(
    asked: AskedNodes, asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    node = lifecycle_node()
    asked.follow(node)
    asked.change_state(node, CONFIGURE)
    assert asking.sent == [
        ("follow", {"node": "/map"}),
        ("change", {"id": 1, "node": "/map", "transition": CONFIGURE}),
    ]
    asked.change_state(node, ACTIVATE)
    asking.reported = [
        {"is": "changed", "id": 1, "success": False, "error": ""},
        {"is": "changed", "id": 2, "success": False, "error": "no such name"},
        {"is": "unheard", "node": "/map", "error": "no such name"},
    ]
    assert asked.take()
    assert caplog.messages == [
        "Failed to make transition 'TRANSITION_CONFIGURE' for LifecycleNode '/map'",
        "Failed to make transition 'TRANSITION_ACTIVATE' for LifecycleNode '/map': no such name",
        "the transitions of /map are not heard: no such name",
    ]


def test_a_node_without_states_is_named_with_those_that_have_some(
    asked: AskedNodes, asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    asked.change_state(lifecycle_node(), ACTIVATE)
    service = "/map/change_state"
    asking.reported = [
        {"is": "missing", "id": 1, "service": service, "others": ["/m/change_state"]}
    ]
    asked.take()
    (text,) = caplog.messages
    assert text == (
        "TRANSITION_ACTIVATE waits for the service /map/change_state, which does not appear: check "
        "that /map is a lifecycle node and has this name; services of its type: /m/change_state"
    )


def test_nothing_waits_for_a_node_that_has_ended_nor_after_the_end(
    asked: AskedNodes, asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    asked.change_state(lifecycle_node("/a"), CONFIGURE)
    asked.change_state(lifecycle_node("/b"), CONFIGURE)
    asked.note_ended("/a")
    asked.note_ended(None)
    asked.give_up()
    asked.give_up()
    assert caplog.messages == [
        "/a has ended before TRANSITION_CONFIGURE",
        "Abandoning wait for TRANSITION_CONFIGURE of /b, due to shutdown.",
    ]
    assert asking.sent[2:] == [("drop", {"node": "/a"}), ("drop", {"node": "/b"})]


def test_the_end_of_the_process_that_asks_is_reported(
    asked: AskedNodes, asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    asked.change_state(lifecycle_node(), CONFIGURE)
    asking.reported = None
    assert not asked.take()
    assert asking.is_closed
    (text,) = caplog.messages
    assert text.startswith("TRANSITION_CONFIGURE of /map is not done")


def test_what_was_followed_is_followed_by_the_next_process(
    asked: AskedNodes, asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    asked.follow(lifecycle_node("/map"))
    asked.follow(lifecycle_node("/arm"))
    asking.reported = None
    assert not asked.take()
    (text,) = caplog.messages
    assert text == (
        "the process that asks nodes has ended; the next request starts another one. Until then, "
        "the launch does not hear of transitions of /map, /arm"
    )
    asking.sent.clear()
    asked.change_state(lifecycle_node("/arm"), CONFIGURE)
    assert asking.sent == [
        ("follow", {"node": "/map"}),
        ("follow", {"node": "/arm"}),
        ("change", {"id": 1, "node": "/arm", "transition": CONFIGURE}),
    ]


def test_a_process_that_cannot_be_started_is_reported_for_each_request(
    asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    outcomes: list[Any] = [OSError(24, "Too many open files")] * 2

    def begin() -> Any:
        if outcomes:
            raise outcomes.pop()
        return asking

    asked = AskedNodes(begin, lambda _: None, lambda _what, _why: None)
    asked.follow(lifecycle_node())
    asked.change_state(lifecycle_node(), CONFIGURE)
    asked.give_up()
    followed, changed = caplog.messages
    assert followed == (
        "the process that asks nodes cannot be started: Too many open files; the next request "
        "starts another one. Until then, the launch does not hear of transitions of /map"
    )
    assert changed == (
        "TRANSITION_CONFIGURE of /map is not done: the process that asks nodes cannot be started: "
        "Too many open files"
    )
    asked.change_state(lifecycle_node(), ACTIVATE)
    assert [do for do, _ in asking.sent] == ["follow", "change"]


def test_a_node_that_is_left_out_is_not_asked(
    asked: AskedNodes, asking: Asking, left_out: list[str]
) -> None:
    node = lifecycle_node()
    asked.note_not_started(node)
    asked.follow(node)
    asked.change_state(node, CONFIGURE)
    assert asking.sent == []
    (text,) = left_out
    assert text == (
        "TRANSITION_CONFIGURE for the lifecycle node /map: its program does not run; what waits "
        "for its states does not happen"
    )


def test_a_container_is_given_all_of_a_node(
    asked: AskedNodes, asking: Asking, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    node = Process(
        package="camera",
        executable="camera::Proc",
        name="proc",
        namespace="/left",
        parameters={"rate": 5.0},
        remappings=(("image", "raw"),),
        container="box",
    )
    asked.load(node, {"use_intra_process_comms": True})
    asked.load(node, {})
    assert asking.sent[0] == (
        "load",
        {
            "id": 1,
            "container": "/box",
            "package": "camera",
            "plugin": "camera::Proc",
            "name": "proc",
            "namespace": "/left",
            "remappings": ["image:=raw"],
            "parameters": {"rate": 5.0},
            "extra_arguments": {"use_intra_process_comms": True},
        },
    )
    asking.reported = [
        {"is": "loaded", "id": 1, "success": True, "name": "/left/proc", "error": ""},
        {"is": "loaded", "id": 2, "success": False, "name": "", "error": "no such class"},
    ]
    asked.take()
    assert caplog.messages == [
        "Loaded node '/left/proc' in container '/box'",
        "Failed to load node of type 'camera::Proc' in container '/box': no such class",
    ]


@pytest.mark.slow
def test_what_a_missing_manager_of_nodes_means_is_reported(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        return LaunchDescription([
            LifecycleNode(package='nav2_map_server', executable='map_server', name='map_server',
                          namespace='', autostart=True),
            Node(package='nav2_lifecycle_manager', executable='lifecycle_manager',
                 parameters=[{'node_names': ['map_server', 'own_planner']}]),
        ])
        """
    )
    assert run.wait() == 4  # all is left out
    assert "it runs; nothing configures and activates map_server, own_planner\n" in run.output
    text = "TRANSITION_CONFIGURE for the lifecycle node /map_server is left out: its program does"
    assert text in run.output


@pytest.mark.slow
def test_nodes_go_through_the_states_that_the_launch_file_asks_for(tmp_path: Path) -> None:
    ros_with()
    (tmp_path / "talker.py").write_text(NODE, encoding="utf-8")
    (tmp_path / "talker.py").chmod(0o755)
    (tmp_path / "states.launch.py").write_text(LAUNCH, encoding="utf-8")
    screen = tmp_path / "screen"
    failed = "Failed to make transition 'TRANSITION_CONFIGURE' for LifecycleNode '{}'"

    def printed() -> list[str]:
        return screen.read_text(encoding="utf-8").splitlines()

    def states(node: str) -> list[str]:
        return [line.partition(": ")[2] for line in printed() if line.startswith(f"{node}: ")]

    def is_over() -> bool:
        ends = {"/good": "active", "/r/own": "active", "/t": "unconfigured"}
        ends |= dict.fromkeys(REFUSING, "unconfigured")
        return all(
            any(state.endswith(f"> {end}") for state in states(node)) for node, end in ends.items()
        ) and all(any(failed.format(node) in line for line in printed()) for node in REFUSING)

    with screen.open("wb") as stream:
        run = subprocess.Popen(
            [sys.executable, "-m", "wsgen", "launch", "states.launch.py", "--run", "--for", "150"],
            cwd=tmp_path,
            env={
                **plain_environment(),
                "ROS_DOMAIN_ID": ros_domain(),
                "ROS_LOG_DIR": str(tmp_path),
            },
            stdout=stream,
            stderr=subprocess.STDOUT,
        )
    try:
        wait_until(is_over, lambda: "\n".join(printed()), SECONDS)
        run.send_signal(signal.SIGINT)
        assert run.wait(SECONDS) == 0
    finally:
        run.kill()
        run.wait()
    lines = printed()
    to_active = [
        *("unconfigured > configuring", "configuring > inactive"),
        *("inactive > activating", "activating > active"),
    ]
    assert states("/good") == states("/r/own") == to_active
    assert states("/t") == [
        *to_active,
        *("active > deactivating", "deactivating > inactive"),
        *("inactive > cleaningup", "cleaningup > unconfigured"),
    ]
    assert states("/r/bad") == ["unconfigured > configuring", "configuring > unconfigured"]
    assert states("/r/raises") == [
        "unconfigured > configuring",
        "configuring > errorprocessing",
        "errorprocessing > unconfigured",
    ]
    assert lines.count("[INFO] [launch.user]: good is configured") == 1
    for node in REFUSING:
        assert sum(failed.format(node) in line for line in lines) == 1
    assert not any("seconds are over" in line for line in lines)
    (traceback,) = [line for line in lines if "Traceback" in line]
    assert traceback.startswith("[talker.py-")  # of the node that raises


@pytest.mark.slow
def test_a_container_of_a_sourced_ros_loads_its_nodes(
    launch: Callable[..., Launch], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros = ros_with("composition_interfaces")
    program = tmp_path / "container.py"
    program.write_text(CONTAINER, encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("CONTAINER", str(program))
    variables = {**ros.variables, "ROS_DOMAIN_ID": ros_domain()}
    run = launch(LOAD, is_sourced=True, python=str(ros.python), variables=variables)
    run.wait_for("Failed to load node of type 'camera::None' in container '/left/box'")
    run.interrupt()
    assert run.wait() == 0
    given = "camera camera::Proc proc /left/own ['image:=raw'] 5.0 [1, 2] "
    assert f"[container.py-1] {given}{{'use_intra_process_comms': True}}" in run.lines
    assert "Loaded node '/left/own/proc' in container '/left/box'" in run.output
    assert "/left/box': no such class" in run.output
    assert "Traceback" not in run.output


@pytest.mark.slow
def test_a_request_that_cannot_be_done_ends_no_other_one() -> None:
    ros = ros_with("composition_interfaces")
    variables = variables_for(ros)
    requests: list[dict[str, Any]] = [
        {"do": "follow", "node": "no name"},
        {"do": "change", "id": 1, "node": "no name", "transition": CONFIGURE},
    ]
    values = ([1, "a"], [[1]], None, {"a": 1}, [1 << 70])
    for number, value in enumerate(values, 2):
        part: dict[str, Any] = {"package": "camera", "plugin": "camera::Proc", "name": "proc"}
        part |= {"container": "/box", "namespace": "/", "remappings": [], "extra_arguments": {}}
        requests.append({"do": "load", "id": number, "parameters": {"cov": value}, **part})
    text = "".join(f"{json.dumps(one)}\n" for one in requests)
    done = subprocess.run(
        [str(ros.python), "-m", LAUNCH_NODE],
        input=text,
        env=variables,
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    unheard, *answers = map(json.loads, done.stdout.splitlines())
    assert (unheard["is"], unheard["node"]) == ("unheard", "no name")
    assert "topic name" in unheard["error"]
    assert [one["id"] for one in answers] == [1, 2, 3, 4, 5, 6]
    assert all(one["success"] is False and one["error"] for one in answers)
    assert answers[1]["error"].startswith('the parameter `cov` has the value [1, "a"]; write')
    assert "the value null; write" in answers[3]["error"]
