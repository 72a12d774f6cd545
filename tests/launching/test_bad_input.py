"""Each mistake in a launch file is one message with file, line and hint."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from install_space import HEAD, InstallSpace, only_message

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.plan import LaunchPlan


pytestmark = pytest.mark.slow

FIRST_LINE = HEAD.count("\n") + 1


def evaluate(space: InstallSpace, text: str, **keywords: float) -> LaunchPlan:
    share = space.add("my_robot", {"launch/bad.launch.py": text})
    return space.evaluate(share / "launch" / "bad.launch.py", **keywords)  # type: ignore[arg-type]


def place(plan: LaunchPlan) -> tuple[str, int | None]:
    (diagnostic,) = plan.diagnostics
    assert diagnostic.file is not None
    return diagnostic.file.name, diagnostic.line


def test_syntax_error(space: InstallSpace) -> None:
    plan = evaluate(space, "import os\n\ndef generate_launch_description(:\n    pass\n")
    assert "`def generate_launch_description(:`" in only_message(plan, "LCH001")
    assert place(plan) == ("bad.launch.py", 3)


def test_bytes_that_are_no_text(space: InstallSpace) -> None:
    share = space.add("my_robot")
    file = share / "bad.launch.py"
    file.write_bytes(b"x = '\xff'\n")
    plan = space.evaluate(file)
    assert "UTF-8" in only_message(plan, "LCH032")


def test_syntax_error_with_a_line_that_is_no_number(space: InstallSpace) -> None:
    plan = evaluate(space, "raise SyntaxError('no', ('a.py', 'one', 1, 'text'))\n")
    only_message(plan, "LCH001")
    assert plan.diagnostics[0].line is None


def test_import_of_what_is_not_there(space: InstallSpace) -> None:
    plan = evaluate(space, "import os\nimport no_such_module\n")
    assert "'no_such_module'" in only_message(plan, "LCH002")
    assert place(plan) == ("bad.launch.py", 2)


def test_a_module_that_resembles_a_known_one_is_not_taken_for_it(space: InstallSpace) -> None:
    message = only_message(evaluate(space, "import gamepads\n"), "LCH002")
    assert "Did you mean" not in message
    assert "Install 'gamepads'" in message


def test_name_that_the_launch_api_does_not_have(space: InstallSpace) -> None:
    plan = evaluate(space, "from launch.actions import DeclareLaunchArgumet\n")
    assert "DeclareLaunchArgumet" in only_message(plan, "LCH017")


def test_no_launch_function(space: InstallSpace) -> None:
    only_message(evaluate(space, "def generate():\n    pass\n"), "LCH003")


@pytest.mark.parametrize("value", ["None", "[]"])
def test_launch_function_that_gives_no_description(space: InstallSpace, value: str) -> None:
    plan = evaluate(space, f"\ndef generate_launch_description():\n    return {value}\n")
    assert "must return a LaunchDescription" in only_message(plan, "LCH010")
    assert place(plan) == ("bad.launch.py", 2)


def test_exception_in_the_launch_function(space: InstallSpace) -> None:
    plan = evaluate(space, "def generate_launch_description():\n    return 1 / 0\n")
    assert "ZeroDivisionError: division by zero" in only_message(plan, "LCH004")
    assert place(plan) == ("bad.launch.py", 2)


def test_exception_that_cannot_be_printed(space: InstallSpace) -> None:
    text = "class E(Exception):\n    def __str__(self):\n        raise ValueError\n\nraise E\n"
    assert "E" in only_message(evaluate(space, text), "LCH004")


def test_value_that_is_no_parameter(space: InstallSpace) -> None:
    plan = space.play(
        "Node(package='rviz2', executable='rviz2', parameters=[{'a': ParameterValue([object()])}])"
    )
    assert "must be a scalar" in only_message(plan, "LCH010")


def test_configuration_that_is_no_text(space: InstallSpace) -> None:
    plan = space.play(
        "OpaqueFunction(function=f), DeclareLaunchArgument('a'), "
        "LogInfo(msg=[LaunchConfiguration('a')])",
        before="def f(context):\n    context.launch_configurations['a'] = object()",
        arguments={"a": "b"},
    )
    assert "TypeError" in only_message(plan, "LCH010")


def test_exception_in_an_opaque_function(space: InstallSpace) -> None:
    plan = space.play("OpaqueFunction(function=f)", before="def f(context):\n    return [][1]\n")
    assert "IndexError" in only_message(plan, "LCH004")
    assert place(plan) == ("test.launch.py", FIRST_LINE + 1)


def test_opened_file_that_is_not_installed(space: InstallSpace) -> None:
    plan = space.play("", before="open(get_package_share_directory('my_robot') + '/model/r.urdf')")
    message = only_message(plan, "LCH005")
    assert "'model/r.urdf' is not in the install space of my_robot" in message
    assert "install(DIRECTORY model DESTINATION share/${PROJECT_NAME})" in message
    assert place(plan) == ("test.launch.py", FIRST_LINE)


@pytest.mark.parametrize(
    "description",
    [
        "xacro.process_file(FILE).toxml()",
        "ParameterValue(Command(['xacro ', FILE]), value_type=str)",
        "Command(['cat ', FILE])",
        "Command(['ros2 run xacro xacro ', FILE])",
    ],
)
def test_xacro_file_that_is_not_installed(space: InstallSpace, description: str) -> None:
    plan = space.play(
        "Node(package='robot_state_publisher', executable='robot_state_publisher', "
        f"parameters=[{{'robot_description': {description}}}])",
        before="import xacro\nFILE = get_package_share_directory('my_robot') + '/model/r.xacro'",
    )
    message = only_message(plan, "LCH005")
    assert "'model/r.xacro' is not in the install space of my_robot" in message
    assert "install(DIRECTORY model" in message
    assert place(plan)[0] == "test.launch.py"


def test_included_launch_file_that_is_not_there(space: InstallSpace) -> None:
    plan = space.play("IncludeLaunchDescription([FindPackageShare('my_robot'), '/launch/no.py'])")
    assert "'launch/no.py' is not in the install space" in only_message(plan, "LCH005")


def test_misspelled_launch_file_of_a_known_package(space: InstallSpace) -> None:
    plan = space.play(
        "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/gazebo_ros.launch.py'])"
    )
    assert "it has gazebo.launch.py" in only_message(plan, "LCH005")


def test_argument_without_value(space: InstallSpace) -> None:
    plan = space.play("DeclareLaunchArgument('robot')")
    assert "robot:=VALUE" in only_message(plan, "LCH006")
    assert not space.play("DeclareLaunchArgument('robot')", arguments={"robot": "r"}).diagnostics


def test_package_that_is_not_there(space: InstallSpace) -> None:
    plan = space.play("", before="get_package_share_directory('no_such_robot')")
    message = only_message(plan, "LCH007")
    assert "'no_such_robot'" in message
    assert "<exec_depend>no_such_robot</exec_depend>" in message
    assert place(plan) == ("test.launch.py", FIRST_LINE)


def test_file_of_a_package_that_is_not_there(space: InstallSpace) -> None:
    plan = space.play("", before="open(get_package_share_directory('nav2_bringup') + '/a.yaml')")
    message = only_message(plan, "LCH007")
    assert "'nav2_bringup'" in message
    assert "install(" not in message


def test_package_of_a_node_that_is_not_there(space: InstallSpace) -> None:
    plan = space.play("\n\nNode(package='no_such_robot', executable='x')")
    assert "'no_such_robot'" in only_message(plan, "LCH007")
    assert place(plan) == ("test.launch.py", FIRST_LINE + 5)


def test_no_install_space(space: InstallSpace) -> None:
    plan = space.play(
        "", before="get_package_prefix('gazebo_ros')", environment={"AMENT_PREFIX_PATH": ""}
    )
    assert "install/setup.bash" in only_message(plan, "LCH007")


ROBOT = """\
<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  {}
</robot>
"""


@pytest.mark.parametrize("how", ["process_file", "process", "Command"])
@pytest.mark.parametrize(
    ("content", "message", "line"),
    [
        ('<link name="${size}"/>', "name 'size' is not defined", 3),
        ('<link name="$(arg size)"/>', "size:=VALUE", 3),
        ("<xacro:wheel/>", "Include the file that defines the macro", 3),
        ("<link>", "not well-formed XML: <link> is not closed", 3),
        ('<link name="${1/0}"/>', "division by zero", 3),
    ],
)
def test_xacro_error(
    space: InstallSpace, how: str, content: str, message: str, line: int | None
) -> None:
    share = space.add("my_robot", {"model/r.xacro": ROBOT.format(content)})
    text = f"'{share}/model/r.xacro'"
    call = (
        f"xacro.process_file({text}).toxml()"
        if how == "process_file"
        else f"xacro.process({text})"
        if how == "process"
        else f"ParameterValue(Command(['xacro ', {text}]), value_type=str)"
    )
    plan = space.play(
        "Node(package='robot_state_publisher', executable='robot_state_publisher', "
        f"parameters=[{{'robot_description': {call}}}])",
        before="import xacro",
    )
    assert message in only_message(plan, "LCH008")
    assert place(plan) == ("r.xacro", line)


def test_package_that_a_xacro_file_does_not_find(space: InstallSpace) -> None:
    content = '<xacro:include filename="$(find no_such_robot)/a.xacro"/>'
    share = space.add("my_robot", {"model/r.xacro": ROBOT.format(content)})
    plan = space.play("", before=f"import xacro\nxacro.process_file('{share}/model/r.xacro')")
    assert "'no_such_robot'" in only_message(plan, "LCH007")
    assert place(plan)[0] == "r.xacro"


def test_configuration_that_is_not_declared(space: InstallSpace) -> None:
    plan = space.play("\n\nLogInfo(msg=LaunchConfiguration('world'))")
    assert "DeclareLaunchArgument('world'" in only_message(plan, "LCH009")
    assert place(plan) == ("test.launch.py", FIRST_LINE + 5)


def test_input(space: InstallSpace) -> None:
    plan = space.play("", before="name = input('name? ')")
    only_message(plan, "LCH011")
    assert place(plan) == ("test.launch.py", FIRST_LINE)


@pytest.mark.parametrize("call", ["os.fork()", "os.forkpty()"])
def test_fork(space: InstallSpace, call: str) -> None:
    plan = space.play("", before=f"import os; {call}")
    assert "forks" in only_message(plan, "LCH025")
    assert place(plan) == ("test.launch.py", FIRST_LINE)


def test_loop_without_end(space: InstallSpace) -> None:
    plan = evaluate(space, "while True:\n    pass\n", seconds=1.0)
    assert "used more than 1 s of CPU time" in only_message(plan, "LCH012")
    assert "endless loop" in (plan.diagnostics[0].hint or "")


def test_sleep_without_end(space: InstallSpace) -> None:
    plan = evaluate(space, "import time\ntime.sleep(600)\n", wall_clock=3.0)
    assert "did not end within 3 s" in only_message(plan, "LCH012")
    assert "machine is less busy" in (plan.diagnostics[0].hint or "")


def test_print_without_end(space: InstallSpace) -> None:
    plan = evaluate(space, "while True:\n    print('no end ' * 10_000)\n")
    assert "wrote more than 64 MB" in only_message(plan, "LCH013")
    assert "prints" in (plan.diagnostics[0].hint or "")


def test_end_of_the_parent(space: InstallSpace) -> None:
    text = "import os, time\nos.kill(os.getppid(), 9)\ntime.sleep(600)"
    assert "crashed (SIGKILL)" in only_message(evaluate(space, text), "LCH013")


def test_crash(space: InstallSpace) -> None:
    text = "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n"
    assert "SIGSEGV" in only_message(evaluate(space, text), "LCH013")


def test_too_much_memory(space: InstallSpace) -> None:
    plan = evaluate(space, "x = ' ' * 2**40\n")
    assert "MemoryError" in only_message(plan, "LCH004")


@pytest.mark.parametrize("call", ["import sys; sys.exit(3)", "raise KeyboardInterrupt", "exit()"])
def test_exit(space: InstallSpace, call: str) -> None:
    only_message(evaluate(space, call), "LCH014")


def test_what_is_printed_before_the_end_of_the_program(space: InstallSpace) -> None:
    plan = space.play("", before="print('ERROR: no\\n argument robot.')\nexit()")
    message = only_message(plan, "LCH014")
    assert "ends the program, and prints: ERROR: no argument robot." in message
    assert "Give the launch argument" in message


@pytest.mark.parametrize("name", ["GeneratorExit", "Own"])
def test_what_is_no_exception(space: InstallSpace, name: str) -> None:
    plan = evaluate(space, f"class Own(BaseException): pass\nraise {name}('no')\n")
    assert f"{name}: no" in only_message(plan, "LCH004")
    assert place(plan) == ("bad.launch.py", 2)


def test_what_is_no_exception_inside_of_an_action(space: InstallSpace) -> None:
    plan = space.play(
        "OpaqueFunction(function=leave)", before="def leave(context):\n    raise GeneratorExit"
    )
    assert "GeneratorExit" in only_message(plan, "LCH004")
    assert place(plan)[0] == "test.launch.py"


def test_exit_without_goodbye(space: InstallSpace) -> None:
    assert "exit code 3" in only_message(evaluate(space, "import os\nos._exit(3)\n"), "LCH013")


def test_include_of_itself(space: InstallSpace) -> None:
    plan = space.play("IncludeLaunchDescription([ThisLaunchFileDir(), '/test.launch.py'])")
    assert "includes or calls itself" in only_message(plan, "LCH004")


def test_handlers_without_end(space: InstallSpace) -> None:
    plan = space.play(
        "RegisterEventHandler(OnProcessExit(on_exit=lambda e, c: ExecuteProcess(cmd=['x']))), "
        "ExecuteProcess(cmd=['x'])"
    )
    assert "does not come to an end" in only_message(plan, "LCH010")


def test_environment_variable_that_is_not_set(space: InstallSpace) -> None:
    plan = space.play("", before="os.environ['TURTLEBOT3_MODEL']")
    assert "TURTLEBOT3_MODEL" in only_message(plan, "LCH020")
    assert "`export TURTLEBOT3_MODEL=VALUE`" in str(plan.diagnostics[0].hint)


@pytest.mark.parametrize(
    "read",
    [
        "os.environ['GZ_SIM_RESOURCE_PATH'] += ':/models'",
        "os.environ['X'] = os.environ.get('GAZEBO_MODEL_PATH') + os.pathsep + '/models'",
        "os.environ['X'] = os.getenv('IGN_GAZEBO_SYSTEM_PLUGIN_PATH') + ':/models'",
        "os.environ['X'] = os.environ['SDF_PATH'] + os.environ['GAZEBO_PLUGIN_PATH']",
        "SetEnvironmentVariable('X', [EnvironmentVariable('GAZEBO_RESOURCE_PATH'), ':/models'])",
    ],
)
def test_search_path_of_gazebo_that_is_not_set(space: InstallSpace, read: str) -> None:
    is_action = read.startswith("Set")
    plan = space.play(
        f"{read if is_action else ''}{', ' * is_action}ExecuteProcess(cmd=['x'])",
        before="" if is_action else read,
    )
    assert plan.is_complete
    assert len(plan.processes) == 1
    assert {(one.code, one.severity.value) for one in plan.diagnostics} == {("LCH020", "warning")}
    for one in plan.diagnostics:
        assert f"Write AppendEnvironmentVariable('{one.element}', FOLDER), which" in str(one.hint)
        assert str(one.hint).endswith("without a value.")
    assert set(plan.environment.values()) <= {":/models", ""}


@pytest.mark.parametrize("read", ["os.environ['{}']", "'' + os.getenv('{}')", "$"])
def test_variables_of_a_login_and_of_a_sourced_ros_are_set(
    space: InstallSpace, monkeypatch: pytest.MonkeyPatch, read: str
) -> None:
    names = (
        *("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH", "DISPLAY", "HOME"),
        *("LANG", "LD_LIBRARY_PATH", "LOGNAME", "PATH", "PYTHONPATH", "ROS_DISTRO", "SHELL"),
        *("ROS_PYTHON_VERSION", "ROS_VERSION", "TERM", "USER"),
    )
    for name in {*names} - {"AMENT_PREFIX_PATH", "PATH"}:
        monkeypatch.delenv(name, raising=False)
    before = "\n".join(read.format(name) for name in names) if read != "$" else ""
    actions = ", ".join(f"LogInfo(msg=EnvironmentVariable('{name}'))" for name in names)
    plan = space.play("" if before else actions, before=before)
    assert not plan.diagnostics
    assert plan.is_complete


@pytest.mark.parametrize("read", ["os.getenv('BASE')", "os.environ.get('BASE', None)"])
def test_environment_variable_that_is_none(space: InstallSpace, read: str) -> None:
    share = space.add("my_robot", {"4wd.urdf": "<robot/>", "2wd.urdf": "<robot/>", "a.txt": ""})
    plan = space.play(
        "LogInfo(msg=open(path).read())",
        before=f"base = {read}\npath = f'{share}/{{base}}.urdf'",
    )
    message = only_message(plan, "LCH020")
    assert "BASE is not set" in message
    assert "None.urdf" in message
    (found,) = plan.diagnostics
    assert "export BASE=VALUE`, where VALUE is one of 2wd, 4wd." in str(found.hint)
    assert plan.launch_file.read_text().splitlines()[(found.line or 0) - 1] == f"base = {read}"


def test_a_variable_that_is_none_is_named_only_where_none_fails(space: InstallSpace) -> None:
    plan = space.play("LogInfo(msg=open('/no/file').read())", before="os.getenv('BASE')")
    assert "None" not in only_message(plan, "LCH005")
    joined = space.play("LogInfo(msg=os.path.join('/', os.getenv('BASE')))")
    assert "BASE" in only_message(joined, "LCH020")


def test_dictionary_key_is_no_environment_variable(space: InstallSpace) -> None:
    assert "KeyError" in only_message(space.play("", before="{}['x']"), "LCH004")


def test_program_that_is_not_installed(space: InstallSpace) -> None:
    space.add("other")
    plan = space.play("Node(package='other', executable='talker')")
    assert "'talker'" in only_message(plan, "LCH021")


def test_keyword_of_foxy(space: InstallSpace) -> None:
    plan = space.play("Node(package='gazebo_ros', node_executable='spawn_entity.py')")
    assert "removed in Galactic" in only_message(plan, "LCH022")


def test_prints_do_not_matter(space: InstallSpace) -> None:
    plan = space.play(
        "ExecuteProcess(cmd=['x'])",
        before="print('{\"value\": 1}'); import sys; sys.stdout.close(); os.close(2)",
    )
    assert len(plan.processes) == 1
    assert not plan.diagnostics


def test_what_came_before_is_kept(space: InstallSpace) -> None:
    plan = space.play("ExecuteProcess(cmd=['x']), LogInfo(msg=LaunchConfiguration('no'))")
    assert [process.command for process in plan.processes] == [("x",)]
    only_message(plan, "LCH009")


def test_launch_file_that_is_not_there(space: InstallSpace, tmp_path: Path) -> None:
    space.add("my_robot")
    only_message(space.evaluate(tmp_path / "no.launch.py"), "LCH005")
    only_message(space.evaluate(tmp_path / "no" / "no.launch.py"), "LCH005")


@pytest.mark.parametrize("suffix", [".py", ".xml", ".yaml"])
def test_launch_file_that_is_a_pipe(space: InstallSpace, tmp_path: Path, suffix: str) -> None:
    space.add("my_robot")
    os.mkfifo(tmp_path / f"a.launch{suffix}")
    words = only_message(space.evaluate(tmp_path / f"a.launch{suffix}"), "LCH018")
    assert "it is a named pipe" in words
    (tmp_path / f"b.launch{suffix}").symlink_to("/dev/zero")
    only_message(space.evaluate(tmp_path / f"b.launch{suffix}"), "LCH018")


@pytest.mark.parametrize("suffix", [".py", ".xml"])
def test_launch_file_that_is_a_link_to_nothing(
    space: InstallSpace, tmp_path: Path, suffix: str
) -> None:
    """`colcon build --symlink-install` leaves one behind when its source is renamed."""
    space.add("my_robot")
    (tmp_path / f"a.launch{suffix}").symlink_to("renamed.launch")
    words = only_message(space.evaluate(tmp_path / f"a.launch{suffix}"), "LCH018")
    assert "a link to renamed.launch, which does not exist" in words


def test_other_files_that_are_pipes(space: InstallSpace, tmp_path: Path) -> None:
    pipe = tmp_path / "a.yaml"
    os.mkfifo(pipe)
    plan = space.play(f"Node(package='rviz2', executable='e', parameters=[{str(pipe)!r}])")
    only_message(plan, "LCH019")
    plan = space.play(f"IncludeLaunchDescription({str(pipe)!r})")
    only_message(plan, "LCH018")
    before = "from launch.substitutions import FileContent"
    plan = space.play(f"LogInfo(msg=FileContent({str(pipe)!r}))", before=before)
    assert "it is a named pipe" in plan.diagnostics[0].message


def test_launch_file_that_is_a_folder(space: InstallSpace, tmp_path: Path) -> None:
    space.add("my_robot")
    only_message(space.evaluate(tmp_path), "LCH018")


def test_what_is_nested_too_deeply_has_a_line(space: InstallSpace) -> None:
    (found,) = space.play("", before="values = 1" + " + 1" * 50_000).diagnostics
    assert (found.code, found.line is None) == ("LCH004", False)
