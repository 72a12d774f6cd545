"""What few launch files use, and what it brings about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import InstallSpace, only_message

if TYPE_CHECKING:
    from wsgen.model.plan import LaunchPlan


pytestmark = pytest.mark.slow


def steps(plan: LaunchPlan) -> list[tuple[str, str]]:
    """First words of commands, and what brought them about."""
    assert not plan.diagnostics, plan.diagnostics
    return [(process.command[0], process.starts) for process in plan.processes if process.command]


LIFECYCLE = """
import lifecycle_msgs.msg
from launch.events import matches_action
from launch_ros.actions import LifecycleNode, LifecycleTransition
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState, matches_node_name
from lifecycle_msgs.msg import Transition
node = LifecycleNode(package="rviz2", executable="rviz2", name="n", namespace="s")
def to(transition, matcher=matches_action(node)):
    return EmitEvent(event=ChangeState(lifecycle_node_matcher=matcher, transition_id=transition))
def when(state, *what, **more):
    return RegisterEventHandler(OnStateTransition(
        target_lifecycle_node=node, goal_state=state, entities=list(what), **more))
E = lambda word: ExecuteProcess(cmd=[word])
"""


def test_a_lifecycle_node_is_followed_through_its_states(space: InstallSpace) -> None:
    plan = space.play(
        "node, to(Transition.TRANSITION_CONFIGURE), "
        "when('inactive', E('configured'), to(Transition.TRANSITION_ACTIVATE), "
        "start_state='configuring'), when('active', E('active'))",
        before=LIFECYCLE,
    )
    assert steps(plan) == [
        ("configured", "state inactive of n"),
        ("active", "state active of n"),
    ]
    assert not plan.unresolved


def test_a_transition_that_its_state_does_not_allow_does_not_happen(space: InstallSpace) -> None:
    plan = space.play(
        "node, when('active', E('never')), to(Transition.TRANSITION_ACTIVATE), "
        "to(Transition.TRANSITION_CREATE), "
        "to(Transition.TRANSITION_CONFIGURE, matches_node_name('other'))",
        before=LIFECYCLE,
    )
    assert steps(plan) == []


def test_transitions_by_name_and_by_itself(space: InstallSpace) -> None:
    plan = space.play(
        "node, when('active', E('active')), LifecycleTransition(lifecycle_node_names=['/s/n'], "
        "transition_ids=[1, str(Transition.TRANSITION_ACTIVATE)])",
        before=LIFECYCLE,
    )
    assert steps(plan) == [("active", "state active of n")]
    plan = space.play(
        "when('active', E('active')), node",
        before=LIFECYCLE.replace('namespace="s"', 'namespace="s", autostart=True'),
    )
    assert steps(plan) == [("active", "state active of n")]


def test_lifecycle_in_xml(space: InstallSpace) -> None:
    share = space.add(
        "my_robot",
        {
            "a.launch.xml": "<launch><lifecycle_node pkg='rviz2' exec='rviz2' name='n' "
            "namespace='' autostart='true'/><lifecycle_transition><lifecycle_node name='n'/>"
            "<transition type='configure'/></lifecycle_transition></launch>"
        },
    )
    plan = space.evaluate(share / "a.launch.xml")
    assert not plan.diagnostics
    assert len(plan.processes) == 1


def test_loops(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('robots', default_value='{name: a, x: 1};{name: b}'), "
        "ForEach(LaunchConfiguration('robots'), function=each), ForLoop('2', function=number), "
        "ForEach('', function=each)",
        before="""
        from launch.actions import ForEach, ForLoop
        def each(name, x=0):
            return [ExecuteProcess(cmd=[name + str(x)])]
        def number(i):
            return [ExecuteProcess(cmd=[f"n{i}"])] if i else None
        """,
    )
    assert [word for word, _ in steps(plan)] == ["a1", "b0", "n1"]


def test_a_loop_that_is_too_long(space: InstallSpace) -> None:
    plan = space.play("ForLoop(str(10**9), function=lambda i: [])")
    assert "at most 10000" in only_message(plan, "LCH010")


COROUTINE = """
import asyncio
done = []
async def work(context, word):
    await asyncio.sleep(3600)
    os.environ["DONE"] = word
    await context.emit_event(Shutdown_())
async def stuck():
    await asyncio.get_running_loop().create_future()
from launch.events import Shutdown as Shutdown_
"""


def test_a_coroutine(space: InstallSpace) -> None:
    plan = space.play(
        "OpaqueCoroutine(coroutine=work, args=['w']), RegisterEventHandler(OnShutdown("
        "on_shutdown=[ExecuteProcess(cmd=[EnvironmentVariable('DONE')])])), "
        "ExecuteProcess(cmd=['first'])",
        before=COROUTINE,
    )
    assert steps(plan) == [("first", "launch"), ("w", "shutdown")]


def test_a_coroutine_that_waits_for_ever(space: InstallSpace) -> None:
    plan = space.play(
        "OpaqueCoroutine(coroutine=stuck, ignore_context=True), ExecuteProcess(cmd=['x'])",
        before=COROUTINE,
    )
    assert [word for word, _ in steps(plan)] == ["x"]
    assert [entry.what for entry in plan.unresolved] == ["OpaqueCoroutine"]
    plan = space.play("OpaqueCoroutine(coroutine=print)")
    assert "coroutine function" in only_message(plan, "LCH010")


def test_a_launch_service_plays_what_it_is_given(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=['outer'])",
        before="""
        from launch import LaunchService
        service = LaunchService(argv=["a"])
        service.include_launch_description(LaunchDescription([ExecuteProcess(cmd=['inner'])]))
        assert service.run() == 0
        assert service.context.launch_configurations == {}
        service.shutdown()
        """,
    )
    assert steps(plan) == [("inner", "launch"), ("outer", "launch")]


def test_a_launch_file_loaded_as_a_module(space: InstallSpace) -> None:
    text = "from launch import LaunchDescription\nWORD = 'w'\ndef generate_launch_description():\n"
    space.add("my_robot", {"launch/other.launch.py": text + "    return LaunchDescription()\n"})
    plan = space.play(
        "ExecuteProcess(cmd=[other.WORD]), other.generate_launch_description()",
        before="""
        from launch.launch_description_sources import load_python_launch_file_as_module
        other = load_python_launch_file_as_module(
            os.path.join(get_package_share_directory("my_robot"), "launch", "other.launch.py"))
        """,
    )
    assert steps(plan) == [("w", "launch")]


def test_substitutions_in_parameter_files(space: InstallSpace) -> None:
    text = "/**: {ros__parameters: {place: $(var where), self: $(find-pkg-share my_robot)}}\n"
    share = space.add("my_robot", {"p.yaml": text, "bad.yaml": "a: $(vr b)\n"})
    node = "Node(package='rviz2', executable='rviz2', parameters=[ParameterFile(FILE, {})])"
    plan = space.play(
        f"{node.format('allow_substs=True')}, {node.format('allow_substs=False')}",
        before=f"FILE = '{share}/p.yaml'",
        arguments={"where": "here"},
    )
    assert not plan.diagnostics
    assert [process.parameters["place"] for process in plan.processes] == ["here", "$(var where)"]
    assert plan.processes[0].parameters["self"] == str(share)
    plan = space.play(node.format("allow_substs=True"), before=f"FILE = '{share}/bad.yaml'")
    assert "Unknown substitution: vr" in only_message(plan, "LCH010")


def test_where_logs_go(space: InstallSpace) -> None:
    assert space.play("SetROSLogDir('/l')").environment == {"ROS_LOG_DIR": "/l"}


def test_choices_that_are_a_text(space: InstallSpace) -> None:
    declare = "DeclareLaunchArgument('m', default_value='{}', choices=\"'two', 'four'\")"
    plan = space.play(f"{declare.format('four')}, LogInfo(msg=LaunchConfiguration('m'))")
    assert not plan.diagnostics
    (found,) = space.play(declare.format("six")).diagnostics
    assert "not in provided choices" in found.message


def test_handler_that_nothing_calls(space: InstallSpace) -> None:
    plan = space.play(
        "RegisterEventHandler(OnIncludeLaunchDescription()), ExecuteProcess(cmd=['x'])",
        before="from launch.event_handlers import OnIncludeLaunchDescription",
    )
    assert [process.command for process in plan.processes] == [("x",)]
    assert not plan.diagnostics
