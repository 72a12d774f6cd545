"""What happens in a launch that is started: processes, timers, events."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from wsgen.live.journal import Journal

if TYPE_CHECKING:
    from collections.abc import Callable

    from live_launch import Launch


@pytest.mark.slow
def test_processes_start_print_and_end_in_the_words_of_launch(
    launch: Callable[..., Launch],
) -> None:
    run = launch(
        """
        return LaunchDescription([
            LogInfo(msg='hello'),
            python("print('good')", name='well'),
            python("import sys; sys.stderr.write('no line break'); sys.exit(3)", name='badly'),
        ])
        """
    )
    assert run.wait() == 0
    numbers = re.sub(r"\d{2,}", "N", run.output)
    died = (
        "[ERROR] [badly-2]: process has died [pid N, exit code 3, cmd 'python3 -c import sys; "
        "sys.stderr.write('no line break'); sys.exit(3)']."
    )
    for line in (
        "[INFO] [launch.user]: hello",
        "[INFO] [well-1]: process started with pid [N]",
        "[well-1] good",
        "[INFO] [well-1]: process has finished cleanly [pid N]",
        "[badly-2] no line break",
        died,
    ):
        assert line in numbers.splitlines()


@pytest.mark.slow
def test_handlers_get_what_happens_in_order(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        first = python("print('written')", name='first')
        second = python("pass", name='second')

        def heard(event):
            return LogInfo(msg='heard ' + event.text.decode().strip())

        def ended(event, context):
            return [LogInfo(msg=f'{event.process_name} {event.returncode} {first.return_code}'),
                    second]

        return LaunchDescription([
            RegisterEventHandler(OnProcessStart(target_action=first,
                                                on_start=[LogInfo(msg='started')])),
            RegisterEventHandler(OnProcessIO(target_action=first, on_stdout=heard)),
            RegisterEventHandler(OnProcessExit(target_action=first, on_exit=ended)),
            RegisterEventHandler(OnExecutionComplete(target_action=second, on_completion=[
                LogInfo(msg='complete'), TimerAction(period=0.2, actions=[LogInfo(msg='later')])])),
            RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg=['over: ',
                LocalSubstitution('event.reason')])])),
            first,
        ])
        """
    )
    assert run.wait() == 0
    said = [line.partition(": ")[2] for line in run.lines if "launch.user" in line]
    assert said == ["started", "heard written", "first-1 0 0", "complete", "later", "over: idle"]


@pytest.mark.slow
def test_conditions_and_commands_are_those_of_this_moment(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        os.environ.pop('WSGEN_TEST', None)
        return LaunchDescription([
            DeclareLaunchArgument('wanted', default_value='false'),
            SetEnvironmentVariable('WSGEN_TEST', 'seen'),
            LogInfo(msg=Command(['printenv WSGEN_TEST'])),
            python("print('a')", condition=IfCondition(LaunchConfiguration('wanted'))),
            python("print('b')", condition=UnlessCondition(LaunchConfiguration('wanted'))),
        ])
        """,
        arguments={"wanted": "true"},
    )
    assert run.wait() == 0
    assert "[INFO] [launch.user]: seen" in run.lines
    assert "[node-1] a" in run.lines
    assert "b" not in run.output.replace("[node-1] ", "").split()


@pytest.mark.slow
def test_a_process_is_started_as_it_is_written(launch: Callable[..., Launch]) -> None:
    code = (
        "import os, sys; print(os.getcwd(), os.environ.get('A'), sys.argv[1:], sys.stdin.isatty())"
    )
    run = launch(
        f"""
        code = {code!r}
        return LaunchDescription([
            python(code, 'x y', cwd='/', additional_env={{'A': '1'}}, prefix='env B=2'),
            ExecuteProcess(cmd=['echo $((1 + 1)) | cat'], shell=True, output='screen', name='sh'),
            python("import sys; print(sys.stdout.isatty())", emulate_tty=True, name='tty'),
            python("import sys; print(sys.stdout.isatty())", name='pipe'),
        ])
        """
    )
    assert run.wait() == 0
    for line in ("[node-1] / 1 ['x y'] False", "[sh-2] 2", "[tty-3] True", "[pipe-4] False"):
        assert line in run.lines


@pytest.mark.slow
def test_a_node_gets_its_name_namespace_parameters_and_remappings(
    launch: Callable[..., Launch],
) -> None:
    run = launch(
        """
        import pathlib
        folder = pathlib.Path(__file__).parent
        script = folder / 'show.py'
        script.write_text(textwrap.dedent('''\\
            #!/usr/bin/false python
            import sys
            for word in sys.argv[1:]:
                print(open(word).read() if word.endswith('.yaml') else word)
            '''))
        script.chmod(0o755)
        (folder / 'own.yaml').write_text('/**: {ros__parameters: {a: 1}}')
        return LaunchDescription([
            SetParameter('use_sim_time', True),
            PushROSNamespace('ns'),
            Node(executable=str(script), name='talker', arguments=['word'], output='screen',
                 parameters=[str(folder / 'own.yaml'), {'b': {'c': [1.5, 2.0]}}],
                 remappings=[('chatter', 'talk')], ros_arguments=['--log-level', 'debug']),
        ])
        """
    )
    assert run.wait() == 0
    said = [line.removeprefix("[show.py-1] ") for line in run.lines if "[show.py-1]" in line]
    text = "\n".join(line for line in said if not line.startswith("[INFO]"))
    expected = (
        "word --ros-args --log-level debug --ros-args -r __node:=talker -r __ns:=/ns "
        "--params-file /**: ros__parameters: use_sim_time: true "
        "--params-file /**: {ros__parameters: {a: 1}} "
        "--params-file /ns/talker: ros__parameters: b.c: - 1.5 - 2.0 "
        "-r chatter:=talk"
    )
    assert " ".join(text.split()) == expected


@pytest.mark.slow
def test_a_process_is_respawned_after_the_delay_as_often_as_is_wanted(
    launch: Callable[..., Launch],
) -> None:
    run = launch(
        """
        return LaunchDescription([
            python("import time; print(time.monotonic())", respawn=True, respawn_delay=0.4,
                   respawn_max_retries=2),
        ])
        """
    )
    assert run.wait() == 0
    times = [float(line.split()[1]) for line in run.lines if line.startswith("[node-1]")]
    assert len(times) == 3
    assert all(later - earlier > 0.4 for earlier, later in pairwise(times))


@pytest.mark.slow
def test_the_end_of_a_process_can_be_the_end_of_all(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        return LaunchDescription([
            ExecuteProcess(cmd=['sleep', '100']),
            python("pass", on_exit=Shutdown(reason='node is done')),
            TimerAction(period=100.0, actions=[LogInfo(msg='never')]),
        ])
        """
    )
    assert run.wait() == 0
    assert "sending signal 'SIGINT' to process[sleep-1]" in run.output
    assert "never" not in run.output


@pytest.mark.slow
def test_another_run_in_the_same_domain_is_named(launch: Callable[..., Launch]) -> None:
    body = "return LaunchDescription([python('pass')])"
    run = launch(body, beside="rover run.launch.py")
    assert run.wait() == 0
    said = "[WARNING] [launch]: another live run simulates in the same ROS_DOMAIN_ID: rover run.l"
    assert run.output.count(said) == 1


@pytest.mark.slow
def test_until_a_program_ends(launch: Callable[..., Launch]) -> None:
    body = """
        return LaunchDescription([
            ExecuteProcess(cmd=['sleep', '100']),
            python("import sys; sys.exit(%d)", name='goal'),
        ])
        """
    assert launch(body % 0, until_exit="goal").wait() == 0
    assert launch(body % 2, until_exit="goal").wait() == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wanted", "goal"),
    [
        ("goal", "ExecuteProcess(cmd=['/no/such/program'], name='goal')"),
        ("rviz2", "Node(package='rviz2', executable='rviz2', name='window')"),
        ("window", "Node(package='rviz2', executable='rviz2', name='window')"),
        ("true-2", "ExecuteProcess(cmd=['true'], prefix='no_such_terminal', name='true')"),
    ],
)
def test_what_is_not_started_is_not_waited_for(
    launch: Callable[..., Launch], wanted: str, goal: str
) -> None:
    body = f"return LaunchDescription([ExecuteProcess(cmd=['sleep', '100']), {goal}])"
    run = launch(body, until_exit=wanted)
    assert run.wait() == 1
    error = f"[ERROR] [launch]: {wanted}, whose end --until-exit waits for, is not started"
    assert run.output.count(error) == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "level"),
    [
        ("", "ERROR"),
        ("RegisterEventHandler(OnShutdown(on_shutdown=[])),", "WARNING"),
        ("TimerAction(period=0.4, actions=[python('pass', name='later')]),", None),
    ],
)
def test_a_name_that_nothing_has(
    launch: Callable[..., Launch], more: str, level: str | None
) -> None:
    """An event may still start it, but nobody waits for it without a word."""
    end = "3" if level == "WARNING" else "100"
    body = f"""
        return LaunchDescription([{more}
            python("import time; time.sleep({end})", name='worker'),
        ])
        """
    run = launch(body, until_exit="later" if level is None else "worke")
    assert run.wait() == (0 if level is None else 1)
    said = [line for line in run.lines if "Did you mean `worker`? It has started worker." in line]
    assert [line.partition("]")[0] for line in said] == ([] if level is None else [f"[{level}"])
    lost = "worke, whose end --until-exit waits for, is not started"
    assert (lost in run.output) == (level is not None)


@pytest.mark.slow
def test_seconds_of_the_wall_clock_wait_for_a_simulator_that_is_to_come(
    launch: Callable[..., Launch],
) -> None:
    end = "TimerAction(period=0.6, actions=[LogInfo(msg='later'), Shutdown()])"
    body = f"return LaunchDescription([ExecuteProcess(cmd=['sleep', '100']), {end}])"
    run = launch(body, seconds=0.2, awaits_simulator=True)
    assert run.wait() == 0
    assert "later" in run.output


@pytest.mark.slow
def test_without_a_simulator_the_clock_on_the_wall_is_that_of_the_simulation(
    launch: Callable[..., Launch],
) -> None:
    timer = "RosTimer(period=0.2, actions=[LogInfo(msg='later'), Shutdown()])"
    body = f"return LaunchDescription([ExecuteProcess(cmd=['sleep', '100']), {timer}])"
    assert launch(body).wait() == 0


@pytest.mark.slow
def test_seconds_of_the_wall_clock(launch: Callable[..., Launch]) -> None:
    run = launch("return LaunchDescription([ExecuteProcess(cmd=['sleep', '100'])])", seconds=0.3)
    assert run.wait() == 0


@pytest.mark.slow
def test_signals_and_ends_that_the_launch_file_wants(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        code = '''
import signal, sys, time
signal.signal(signal.SIGUSR1, lambda *_: print('got it', flush=True))
print('ready', flush=True)
while True:
    time.sleep(0.01)
'''
        node = python(code)

        def heard(event):
            if b'ready' in event.text:
                return EmitEvent(event=SignalProcess(signal_number=signal.SIGUSR1,
                                                     process_matcher=matches_action(node)))
            return EmitEvent(event=ShutdownProcess(process_matcher=matches_name('node-1')))

        return LaunchDescription([
            RegisterEventHandler(OnProcessIO(target_action=node, on_stdout=heard)), node])
        """
    )
    assert run.wait() == 0
    assert "[INFO] [node-1]: sending signal 'SIGUSR1' to process[node-1]" in run.lines
    assert "[node-1] got it" in run.lines
    assert "[INFO] [node-1]: sending signal 'SIGINT' to process[node-1]" in run.lines


@pytest.mark.slow
def test_who_ends_by_a_signal_of_the_launch_file_has_not_failed(
    launch: Callable[..., Launch],
) -> None:
    run = launch(
        """
        def sent(name, number, code):
            node = python('print(1, flush=True)\\n' + code, name=name)
            signaled = EmitEvent(event=SignalProcess(signal_number=number,
                                                     process_matcher=matches_action(node)))
            return [RegisterEventHandler(OnProcessIO(target_action=node,
                                                     on_stdout=lambda _: signaled)), node]

        sleep = 'import time; time.sleep(99)'
        crash = ('import signal; signal.sigwait([signal.SIGUSR1]); 1 / 0')
        blocked = 'import signal; signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGUSR1])\\n'
        crashes = python(blocked + 'print(1, flush=True)\\n' + crash, name='crashes')
        used = EmitEvent(event=SignalProcess(signal_number=signal.SIGUSR1,
                                             process_matcher=matches_action(crashes)))
        return LaunchDescription([
            *sent('interrupted', signal.SIGINT, sleep),
            *sent('killed', signal.SIGUSR1, sleep),
            RegisterEventHandler(OnProcessIO(target_action=crashes, on_stdout=lambda _: used)),
            crashes])
        """,
        is_watched=True,
    )
    assert run.wait() == 0
    journal = Journal(run.live)
    journal.read()
    ends = {name.rpartition("-")[0]: one.code for name, one in journal.processes.items()}
    assert set(ends) == {"interrupted", "killed", "crashes"}
    assert all(ends.values())
    assert [one.name.rpartition("-")[0] for one in journal.failed] == ["crashes"]


@pytest.mark.slow
def test_a_coroutine_sleeps_while_the_launch_goes_on(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        import asyncio

        ended = []

        async def work(context):
            while not ended:
                await asyncio.sleep(0.01)
            print('awake')

        node = python("print('meanwhile')")
        return LaunchDescription([
            RegisterEventHandler(OnProcessExit(target_action=node,
                                               on_exit=lambda event, _: ended.append(event))),
            OpaqueCoroutine(coroutine=work), node])
        """
    )
    assert run.wait() == 0
    assert run.output.index("meanwhile") < run.output.index("awake")


@pytest.mark.slow
def test_an_exception_ends_the_launch_in_order(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        node = python("pass")

        def fail(event, context):
            raise ValueError('of the handler')

        return LaunchDescription([
            ExecuteProcess(cmd=['sleep', '100']), node,
            RegisterEventHandler(OnProcessExit(target_action=node, on_exit=fail))])
        """
    )
    assert run.wait() == 1
    said = "[ERROR] [launch]: Caught exception in launch (see debug for traceback): of the handler"
    assert said in run.lines
    assert re.search(r"It was raised at .*test\.launch\.py:\d+", run.output)
    assert "Traceback" not in run.output
