"""Names that launch files take from the launch API, each doing what it is for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import InstallSpace, only_message

if TYPE_CHECKING:
    from wsgen.model.plan import LaunchPlan


def commands(plan: LaunchPlan) -> list[tuple[str, ...]]:
    assert not plan.diagnostics, plan.diagnostics
    return [process.command for process in plan.processes if process.command]


@pytest.mark.slow
def test_scopes_by_hand(space: InstallSpace) -> None:
    plan = space.play(
        "SetLaunchConfiguration('a', '1'), PushLaunchConfigurations(), PushEnvironment(), "
        "SetLaunchConfiguration('a', '2'), SetEnvironmentVariable('E', 'e'), show('in'), "
        "PopEnvironment(), PopLaunchConfigurations(), show('out'), "
        "SetEnvironmentVariable('E', 'f'), ResetEnvironment(), "
        "ResetLaunchConfigurations({'b': [LaunchConfiguration('a'), 'x']}), show('reset'), "
        "ResetLaunchConfigurations(), show('empty')",
        before="""
        def show(word):
            return ExecuteProcess(cmd=[word, *(LaunchConfiguration(n, default='-') for n in 'ab'),
                                       EnvironmentVariable('E', default_value='-')])
        """,
    )
    assert commands(plan) == [
        ("in", "2", "-", "e"),
        ("out", "1", "-", "-"),
        ("reset", "-", "1x", "-"),
        ("empty", "-", "-", "-"),
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("distro", "inside", "after"), [("humble", "gone", "leaked"), ("jazzy", "in", "gone")]
)
def test_timers_keep_the_scope_that_they_were_set_in(
    space: InstallSpace, distro: str, inside: str, after: str
) -> None:
    plan = space.play(
        "GroupAction([SetLaunchConfiguration('a', 'in'), TimerAction(period=1.0, actions=["
        "show('inside'), SetLaunchConfiguration('a', 'leaked')])]), "
        "TimerAction(period=2.0, actions=[OpaqueFunction(function=lambda context: ["
        "ExecuteProcess(cmd=['after', context.launch_configurations.get('a', 'gone')])])])",
        before="""
        def show(word):
            return ExecuteProcess(cmd=[word, LaunchConfiguration('a', default='gone')])
        """,
        environment={"ROS_DISTRO": distro},
    )
    assert commands(plan) == [("inside", inside), ("after", after)]


@pytest.mark.slow
@pytest.mark.parametrize("distro", ["galactic", "humble", "jazzy"])
def test_parts_of_a_path_are_concatenated(space: InstallSpace, distro: str) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=[PathJoinSubstitution(['/a', ('b', TextSubstitution(text='.c'))])])",
        environment={"ROS_DISTRO": distro},
    )
    if distro == "galactic":
        assert "'tuple'" in only_message(plan, "LCH010")
    else:
        assert commands(plan) == [("/a/b.c",)]


@pytest.mark.slow
@pytest.mark.parametrize("pop", ["PopEnvironment()", "PopLaunchConfigurations()"])
def test_a_scope_that_was_not_begun(space: InstallSpace, pop: str) -> None:
    assert "stack unexpectedly empty" in only_message(space.play(pop), "LCH010")


@pytest.mark.slow
def test_messages_are_performed(space: InstallSpace) -> None:
    before = "from launch.actions import Log, LogDebug, LogError, LogWarning"
    fine = "Log(msg='a', level='INFO'), LogDebug(msg='b'), LogWarning(msg='c'), LogError(msg='d')"
    assert not space.play(fine, before=before).diagnostics
    for name in ("LogDebug", "LogWarning", "LogError"):
        plan = space.play(f"{name}(msg=LaunchConfiguration('no'))", before=before)
        only_message(plan, "LCH009")


@pytest.mark.slow
def test_handlers_can_be_taken_back(space: InstallSpace) -> None:
    plan = space.play(
        "RegisterEventHandler(handler), UnregisterEventHandler(handler), process",
        before="""
        process = ExecuteProcess(cmd=['x'])
        handler = OnProcessStart(target_action=process, on_start=[ExecuteProcess(cmd=['never'])])
        """,
    )
    assert commands(plan) == [("x",)]


@pytest.mark.slow
def test_handlers_and_events_of_users(space: InstallSpace) -> None:
    plan = space.play(
        "RegisterEventHandler(EventHandler(matcher=lambda e: isinstance(e, Bell), "
        "entities=[ExecuteProcess(cmd=['rung'])], handle_once=True)), "
        "EmitEvent(event=Bell()), EmitEvent(event=Bell())",
        before="""
        from launch import Event, EventHandler
        class Bell(Event):
            name = "bell"
        """,
    )
    assert commands(plan) == [("rung",)]


@pytest.mark.slow
def test_events_that_handlers_see(space: InstallSpace) -> None:
    plan = space.play(
        "process, TimerAction(period=1.0, actions=[]), "
        "RegisterEventHandler(OnProcessStart(target_action=matches_name('p'), on_start=seen)), "
        "RegisterEventHandler(OnProcessExit(target_action=process, on_exit=seen)), "
        "RegisterEventHandler(OnExecutionComplete(target_action=process, on_completion=seen)), "
        "RegisterEventHandler(EventHandler(matcher=lambda e: isinstance(e, TimerEvent), "
        "entities=[OpaqueFunction(function=local)])), "
        "RegisterEventHandler(OnShutdown(on_shutdown=[ExecuteProcess(cmd=["
        "LocalSubstitution('event.reason')])])), TimerAction(period=2.0, actions=["
        "Shutdown(reason='enough')])",
        before="""
        from launch import EventHandler
        from launch.actions import ExecuteLocal
        from launch.events import ExecutionComplete, Shutdown as ShutdownEvent, TimerEvent
        from launch.events.process import *
        process = ExecuteProcess(cmd=['x', 'y'], name='p')
        words = []
        def seen(event, context):
            kinds = (ProcessStarted, ProcessExited, ExecutionComplete)
            words.append(next(kind.__name__ for kind in kinds if isinstance(event, kind)))
            assert event.action is process and isinstance(process, ExecuteLocal)
            if isinstance(event, RunningProcessEvent):
                assert (event.cmd, event.process_name) == (['x', 'y'], 'p')
            assert getattr(event, 'returncode', 0) == 0
        def local(context):
            assert isinstance(context.locals.event, TimerEvent)
            return [ExecuteProcess(cmd=list(words))]
        """,
    )
    assert commands(plan)[0] == ("x", "y")
    assert commands(plan)[-1] == ("enough",)
    assert ("ProcessStarted", "ProcessExited", "ExecutionComplete") in [
        tuple(dict.fromkeys(command)) for command in commands(plan)[1:-1]
    ]


@pytest.mark.slow
def test_conditions(space: InstallSpace) -> None:
    plan = space.play(
        "SetLaunchConfiguration('a', '1'), "
        "when('equal', LaunchConfigurationEquals('a', '1')), "
        "when('no', LaunchConfigurationEquals('b', 'x')), "
        "when('unset', LaunchConfigurationEquals('b', None)), "
        "when('differs', LaunchConfigurationNotEquals('a', '2')), "
        "when('own', Condition(predicate=lambda context: 'a' in context.launch_configurations)), "
        "OpaqueFunction(function=evaluated)",
        before="""
        from launch import Condition
        from launch.utilities import normalize_to_list_of_substitutions
        when = lambda word, condition: ExecuteProcess(cmd=[word], condition=condition)
        def evaluated(context):
            expression = lambda text: normalize_to_list_of_substitutions(text)
            assert evaluate_condition_expression(context, expression(' TRUE '))
            try:
                evaluate_condition_expression(context, expression('maybe'))
            except InvalidConditionExpressionError:
                return [ExecuteProcess(cmd=['refused'])]
        """,
    )
    assert [one for (one,) in commands(plan)] == ["equal", "unset", "differs", "own", "refused"]


@pytest.mark.slow
def test_substitutions(space: InstallSpace) -> None:
    share = space.add("my_robot", {"word.txt": "content"})
    plan = space.play(
        "ExecuteProcess(cmd=[AnySubstitution('0', 'true'), AllSubstitution('1', 'false'), "
        "OrSubstitution('false', '0'), NotEqualsSubstitution('1', '2'), "
        f"FileContent('{share}/word.txt'), PathSubstitution('/a') / 'b', ThisLaunchFile(), "
        "FindPackagePrefix('my_robot')])",
        before="""
        from launch.substitutions import BooleanSubstitution
        assert issubclass(AnySubstitution, BooleanSubstitution)
        assert issubclass(FindPackagePrefix, FindPackage)
        """,
    )
    assert commands(plan) == [
        (
            *("true", "false", "false", "true", "content", "/a/b"),
            str(share / "launch" / "test.launch.py"),
            str(space.prefix),
        )
    ]


@pytest.mark.slow
def test_variables_outside_of_a_loop(space: InstallSpace) -> None:
    plan = space.play("ExecuteProcess(cmd=[ForEachVar('a', default_value='d')])")
    assert commands(plan) == [("d",)]
    assert "loop variable 'i'" in only_message(
        space.play("LogInfo(msg=ForLoopIndex('i'))"), "LCH010"
    )


@pytest.mark.slow
def test_what_is_no_boolean(space: InstallSpace) -> None:
    plan = space.play("LogInfo(msg=OrSubstitution('maybe', 'true'))")
    assert "'maybe'" in only_message(plan, "LCH010")


@pytest.mark.slow
def test_the_index_of_packages(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=['x'])",
        before="""
        from pathlib import Path
        from ament_index_python import *
        from ament_index_python.resources import get_resource
        prefix = get_package_prefix("my_robot")
        assert get_package_share_path("my_robot") == Path(prefix, "share", "my_robot")
        assert get_packages_with_prefixes() == get_resources("packages") == {"my_robot": prefix}
        assert get_resource("packages", "my_robot") == ("", prefix)
        assert get_resource_types() == {"packages"}
        assert get_search_paths() == [prefix]
        assert has_resource("packages", "my_robot") == prefix
        assert not has_resource("packages", "other")
        for wrong, error in (
            (lambda: get_resource("packages", "other"), LookupError),
            (lambda: get_package_prefix("no_such_robot"), PackageNotFoundError),
        ):
            try:
                wrong()
            except error:
                continue
            raise AssertionError
        """,
    )
    assert commands(plan) == [("x",)]


@pytest.mark.slow
def test_helpers(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=['x'])",
        before="""
        from launch import (Action, InvalidLaunchFileError, LaunchDescriptionEntity,
            SomeActionsType, SomeEntitiesType, SomeSubstitutionsType,
            SomeSubstitutionsType_types_tuple)
        from launch.frontend import Entity, InvalidFrontendLaunchFileError
        from launch.utilities import (ensure_argument_type, is_a, is_a_subclass, isclassinstance,
            normalize_to_list_of_entities, normalize_to_list_of_substitutions)
        from launch_ros.actions import ROSTimer, RosTimer
        from launch_ros.events.lifecycle import StateTransition
        from launch_yaml.launch_description_sources import YAMLLaunchDescriptionSource
        assert ROSTimer is RosTimer and StateTransition.name.endswith("StateTransition")
        assert issubclass(InvalidPythonLaunchFileError, InvalidLaunchFileError)
        assert issubclass(InvalidFrontendLaunchFileError, InvalidLaunchFileError)
        assert issubclass(Action, LaunchDescriptionEntity) and Entity
        assert SomeActionsType and SomeEntitiesType and SomeSubstitutionsType
        assert isinstance("text", SomeSubstitutionsType_types_tuple)
        assert issubclass(YAMLLaunchDescriptionSource, FrontendLaunchDescriptionSource)
        one = LogInfo(msg="a")
        assert normalize_to_list_of_entities([one, [[one]]]) == [one, one]
        assert [sub.text for sub in normalize_to_list_of_substitutions(["a", "b"])] == ["a", "b"]
        assert isclassinstance(one) and not isclassinstance(LogInfo)
        assert is_a(one, LogInfo) and is_a_subclass(LogInfo, Action)
        ensure_argument_type("a", (str, int), "name")
        for wrong in (
            lambda: ensure_argument_type(1.5, (str, int), "name", "caller"),
            lambda: normalize_to_list_of_entities(["text"]),
        ):
            try:
                wrong()
            except TypeError:
                continue
            raise AssertionError
        """,
    )
    assert commands(plan) == [("x",)]


@pytest.mark.slow
def test_descriptions_from_functions(space: InstallSpace) -> None:
    space.add(
        "my_robot",
        {
            "launch/a.launch.xml": "<launch><executable cmd='xml'/></launch>",
            "launch/b.launch.py": "from launch import LaunchDescription\n"
            "from launch.actions import ExecuteProcess\ndef generate_launch_description():\n"
            "    return LaunchDescription([ExecuteProcess(cmd=['python'])])\n",
        },
    )
    plan = space.play(
        "from_any(FOLDER + 'a.launch.xml'), from_any(FOLDER + 'b.launch.py'), "
        "from_python(FOLDER + 'b.launch.py'), from_frontend(FOLDER + 'a.launch.xml')",
        before="""
        from launch.frontend import (
            get_launch_description_from_frontend_launch_file as from_frontend)
        from launch.launch_description_sources import (
            get_launch_description_from_any_launch_file as from_any,
            get_launch_description_from_python_launch_file as from_python)
        FOLDER = os.path.dirname(__file__) + '/'
        """,
    )
    assert commands(plan) == [("xml",), ("python",), ("python",), ("xml",)]
