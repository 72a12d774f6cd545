"""What is misspelled, forgotten or not imported is named, with what was meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from install_space import HEAD, InstallSpace, only_message
from wsgen.launching.explain_missing import first_missing

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.plan import LaunchPlan


pytestmark = pytest.mark.slow

FIRST_LINE = HEAD.count("\n") + 1
GAZEBO = "IncludeLaunchDescription([FindPackageShare('gazebo_ros'), '/launch/{}'], {})"


def load(space: InstallSpace, text: str, name: str = "launch/bad.launch.py") -> LaunchPlan:
    return space.evaluate(space.add("my_robot", {name: text}) / name)


def line_of(plan: LaunchPlan) -> int | None:
    (diagnostic,) = plan.diagnostics
    assert diagnostic.file is not None
    assert diagnostic.file.name.startswith(("bad.launch", "test.launch"))
    return diagnostic.line


@pytest.mark.parametrize(
    ("name", "statement"),
    [
        ("Node", "from launch_ros.actions import Node"),
        ("LaunchDescription", "from launch import LaunchDescription"),
        ("IncludeLaunchDescription", "from launch.actions import IncludeLaunchDescription"),
        ("LaunchConfiguration", "from launch.substitutions import LaunchConfiguration"),
        ("FindPackageShare", "from launch_ros.substitutions import FindPackageShare"),
        ("IfCondition", "from launch.conditions import IfCondition"),
        ("OnProcessExit", "from launch.event_handlers import OnProcessExit"),
        ("Shutdown", "from launch.actions import Shutdown"),
        ("ParameterValue", "from launch_ros.parameter_descriptions import ParameterValue"),
        ("ComposableNode", "from launch_ros.descriptions import ComposableNode"),
        (
            "PythonLaunchDescriptionSource",
            "from launch.launch_description_sources import PythonLaunchDescriptionSource",
        ),
        (
            "get_package_share_directory",
            "from ament_index_python.packages import get_package_share_directory",
        ),
        ("os", "import os"),
        ("xacro", "import xacro"),
        ("Path", "from pathlib import Path"),
    ],
)
def test_name_that_is_not_imported(space: InstallSpace, name: str, statement: str) -> None:
    plan = load(space, f"def generate_launch_description():\n    return {name}()\n")
    message = only_message(plan, "LCH030")
    assert f"does not import `{name}`" in message
    assert f"Add `{statement}`" in message
    assert line_of(plan) == 2


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("path_of_model = 1\nprint(path_of_modle)", "Did you mean `path_of_model`?"),
        ("def f(height):\n    return heigth\nf(1)", "Did you mean `height`?"),
        ("print(true)", "Did you mean `True`?"),
        ("Nod()", "Did you mean `Node`? Add `from launch_ros.actions import Node`"),
        ("q_x_z", "define it above"),
        ("q_x_z", "put quotes around it"),
        ("package = my_robot", "it is the name of this package, and has no quotes."),
        ("package = my_robot", "Put quotes around it: 'my_robot'."),
        ("package = robot_state_publisher", "it is the name of a package, and has no quotes."),
    ],
)
def test_name_that_is_not_defined(space: InstallSpace, text: str, meant: str) -> None:
    assert meant in only_message(load(space, text), "LCH030")


@pytest.mark.parametrize(
    ("text", "code", "meant"),
    [
        ("from launch_ros.actions import Nod", "LCH017", "Did you mean `Node`?"),
        ("from launch.actions import Node", "LCH017", "`from launch_ros.actions import Node`"),
        ("from launch import LunchDescription", "LCH017", "Did you mean `LaunchDescription`?"),
        (
            "from launch.action import IncludeLaunchDescription",
            "LCH017",
            "`from launch.actions import IncludeLaunchDescription`",
        ),
        ("from launch.actoins import LogInfo", "LCH017", "Did you mean `launch.actions`?"),
        ("import launch\nlaunch.actoins.LogInfo", "LCH017", "Did you mean `actions`?"),
        ("import launch.actions\nlaunch.actions.LogInf", "LCH017", "Did you mean `LogInfo`?"),
        ("from ament_index_python.package import x", "LCH017", "`ament_index_python.packages`"),
        ("from lanuch import LaunchDescription", "LCH002", "Did you mean `launch`?"),
        ("import launch_ross", "LCH002", "Did you mean `launch_ros`?"),
        ("import xacr", "LCH002", "Did you mean `xacro`?"),
        ("import oss", "LCH002", "Did you mean `os`?"),
        ("import os\nos.path.jion", "LCH004", "Did you mean `join`?"),
        (HEAD + "LaunchDescription().add_actoin", "LCH004", "Did you mean `add_action`?"),
    ],
)
def test_module_or_attribute_that_is_misspelled(
    space: InstallSpace, text: str, code: str, meant: str
) -> None:
    plan = load(space, text)
    message = only_message(plan, code)
    assert meant in message
    assert "/recording/" not in message
    assert line_of(plan) == text.count("\n") + 1


@pytest.mark.parametrize(
    ("call", "wrong", "meant"),
    [
        ("Node(package='rviz2',\n excutable='rviz2')", "`excutable`", "`executable`"),
        (
            "Node(package='rviz2', executable='rviz2',\n argument=['a'])",
            "`argument`",
            "`arguments`",
        ),
        ("Node(executable='rviz2',\n pakage='rviz2')", "`pakage`", "`package`"),
        ("Node(package='rviz2', executable='rviz2',\n outptu='screen')", "`outptu`", "`output`"),
        ("LogInfo(\n mgs='a')", "`LogInfo` has no argument `mgs`", "`msg`"),
        ("DeclareLaunchArgument('a',\n defaul_value='b')", "`defaul_value`", "`default_value`"),
        ("Node(package='rviz2', executable='rviz2',\n qqq=1)", "`qqq`", "Use one of "),
        ("\nExecuteProcess()", "is not given `cmd`", "Add `cmd=...`"),
    ],
)
def test_keyword_that_is_misspelled(space: InstallSpace, call: str, wrong: str, meant: str) -> None:
    plan = load(space, f"{HEAD}\nx = {call if call[0] != chr(10) else '(' + call + ')'}\n")
    message = only_message(plan, "LCH031")
    assert wrong in message
    assert meant in message
    assert line_of(plan) == HEAD.count("\n") + 3


def test_keyword_of_foxy_on_a_line_of_its_own(space: InstallSpace) -> None:
    plan = space.play("Node(package='gazebo_ros',\nnode_executable='spawn_entity.py')")
    assert "removed in Galactic" in only_message(plan, "LCH022")


def test_forgotten_return(space: InstallSpace) -> None:
    text = f"{HEAD}\ndef generate_launch_description():\n    ld = LaunchDescription()\n"
    message = only_message(load(space, text), "LCH010")
    assert "it has no `return`" in message
    assert "Add `return ld` as its last line." in message


@pytest.mark.parametrize("value", ["[]", "'x' * 9999"])
def test_something_else_returned(space: InstallSpace, value: str) -> None:
    text = f"{HEAD}\ndef generate_launch_description():\n    return {value}\n"
    message = only_message(load(space, text), "LCH010")
    assert "Write `return LaunchDescription([...])`" in message
    assert len(message) < 400


def test_misspelled_launch_function(space: InstallSpace) -> None:
    text = f"{HEAD}\ndef generate_launch_desciption():\n    return LaunchDescription()\n"
    plan = load(space, text)
    assert "Rename `generate_launch_desciption`" in only_message(plan, "LCH003")
    assert line_of(plan) == HEAD.count("\n") + 2


def test_forgotten_items(space: InstallSpace) -> None:
    include = GAZEBO.format("gazebo.launch.py", "launch_arguments={}")
    plan = space.play(include.format({"world": "x.world"}))
    assert ".items()" in only_message(plan, "LCH010")
    assert line_of(plan) == FIRST_LINE + 3
    pairs = include.format(["world"])
    assert ".items()" not in only_message(space.play(pairs), "LCH010")


def test_misspelled_package(space: InstallSpace) -> None:
    before = "PACKAGE = 'my_robto'\n\nget_package_share_directory(PACKAGE)"
    plan = space.play("", before=before)
    assert "Did you mean `my_robot`?" in only_message(plan, "LCH007")
    assert line_of(plan) == FIRST_LINE
    plan = space.play("Node(package='robot_state_publiser', executable='x')")
    assert "Did you mean `robot_state_publisher`?" in only_message(plan, "LCH007")


def test_misspelled_file(space: InstallSpace) -> None:
    space.add("my_robot", {"model/robot.xacro": "<robot name='r'/>"})
    before = "FILE = 'model/robto.xacro'\nimport xacro\n"
    call = "xacro.process_file(get_package_share_directory('my_robot') + '/' + FILE)"
    plan = space.play("", before=before + call)
    message = only_message(plan, "LCH005")
    assert "Did you mean `robot.xacro`?" in message
    assert "install(" not in message
    assert line_of(plan) == FIRST_LINE
    plan = space.play("", before="open(get_package_share_directory('my_robot') + '/modle/x')")
    assert "Did you mean `model`?" in only_message(plan, "LCH005")


def test_share_folder_and_path_without_a_slash_between(space: InstallSpace) -> None:
    plan = space.play("", before="open(get_package_share_directory('my_robot') + 'model/r.xacro')")
    message = only_message(plan, "LCH005")
    assert "'/' is missing after the share folder of my_robot" in message
    assert "os.path.join" in message


def test_misspelled_launch_file_of_a_package_that_is_not_here(space: InstallSpace) -> None:
    plan = space.play("\n\n" + GAZEBO.format("gazebo.lanuch.py", ""))
    assert "Did you mean `gazebo.launch.py`?" in only_message(plan, "LCH005")


@pytest.mark.parametrize(
    ("package", "program", "meant"),
    [
        ("robot_state_publisher", "robot_state_publiser", "robot_state_publisher"),
        ("gazebo_ros", "spawn_entiti.py", "spawn_entity.py"),
        ("other", "tlaker", "talker"),
    ],
)
def test_misspelled_executable(space: InstallSpace, package: str, program: str, meant: str) -> None:
    space.add("other")
    space.add_program("other", "talker")
    plan = space.play(f"Node(package='{package}',\n\nexecutable='{program}')")
    assert f"Did you mean `{meant}`?" in only_message(plan, "LCH021")
    assert line_of(plan) == FIRST_LINE + 5


def test_a_name_that_a_stand_in_lacks(space: InstallSpace) -> None:
    plan = space.play("", before="from nav2_common.launch import Node")
    message = only_message(plan, "LCH002")
    assert "cannot import name 'Node' from 'nav2_common.launch'." in message
    assert "wsgen" not in message.partition("\n")[0]


def test_a_name_that_a_module_of_the_user_lacks(space: InstallSpace, tmp_path: Path) -> None:
    (tmp_path / "paths_of_mine.py").write_text("SHARE = 'a'")
    path = f"import sys\nsys.path.append({str(tmp_path)!r})\n"
    for name, hint in (
        ("SHAR", "Did you mean `SHARE`?"),
        ("other", "Correct the import, or define 'other' in paths_of_mine."),
    ):
        plan = space.play("", before=f"{path}from paths_of_mine import {name}")
        assert hint in only_message(plan, "LCH002")


def test_a_script_that_setuptools_installs_into_bin(space: InstallSpace) -> None:
    space.add("other")
    script = space.prefix / "bin" / "talker"
    script.parent.mkdir()
    script.touch()
    plan = space.play("Node(package='other', executable='talker'), ExecuteProcess(cmd=['a'])")
    message = only_message(plan, "LCH021")
    assert "is installed into bin, but `launch` looks in lib/other" in message
    assert "Write in setup.cfg of other: [install] install_scripts=$base/lib/other" in message
    assert plan.processes[-1].command == ("a",)


def test_a_program_of_ros_is_not_for_the_user_to_install(space: InstallSpace) -> None:
    plan = space.play("Node(package='gazebo_ros', executable='spawn_entiti.py')")
    assert "CMakeLists" not in only_message(plan, "LCH021")
    space.add("other")
    plan = space.play("Node(package='other', executable='talker')")
    assert "CMakeLists" in only_message(plan, "LCH021")


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("name = \u2018gazebo_test\u2019", "\u2018 by ', \u2019 by '"),
        ("name = \u201cgazebo_test\u201d", '\u201c by ", \u201d by "'),
        ("height = \u22121", "\u2212 by -"),
    ],
)
def test_typographic_characters(space: InstallSpace, text: str, change: str) -> None:
    plan = load(space, f"import os\n{text}\n")
    assert f"Replace {change}" in only_message(plan, "LCH001")
    assert line_of(plan) == 2


@pytest.mark.parametrize(
    ("action", "reported"),
    [
        (
            "Node(package='a', executable='b',\narguments=['-z',\n0.255])",
            ("`arguments` is the number 0.255, but must be text (", "Write '0.255'", 2),
        ),
        ("ExecuteProcess(cmd=['a',\n-1])", ("`cmd` is the number -1,", "Write '-1'", 1)),
        (
            "Node(package='a', executable='b', remappings=[\n('a', 5)])",
            ("`remappings` is the number 5,", "Write '5'", 1),
        ),
        (
            GAZEBO.format("gazebo.launch.py", "\nlaunch_arguments={'gui': False}.items()"),
            ("`launch_arguments` is False, but must be text (", "Write 'False'", 1),
        ),
        (
            "Node(package='a', executable='b', arguments=[['-z', None]])",
            ("`arguments` is None,", "Write 'None'", 0),
        ),
        (
            "Node(package='a', executable='b', arguments=[str, 'x'])",
            ("gives a type where launch takes text", "Write text", 0),
        ),
        (
            "Node(package='a', executable='b', parameters={'a': 1})",
            ("`parameters` of Node must be a list, and is a dictionary (", "parameters=[{...}]", 0),
        ),
        (
            "TimerAction(period=1.0, actions=5)",
            ("`actions` of TimerAction must be a list, and is a number (", "actions=[...]", 0),
        ),
    ],
)
def test_value_of_the_wrong_type(
    space: InstallSpace, action: str, reported: tuple[str, str, int]
) -> None:
    message, hint, lines = reported
    plan = space.play(action)
    text = only_message(plan, "LCH010")
    assert message in text
    assert hint in text
    first = space.play("Node()").diagnostics[0].line
    assert first is not None
    assert line_of(plan) == first + lines


@pytest.mark.parametrize("program", ["spawner.py", "spawner", "unspawner", "quite_another"])
def test_executable_that_a_package_may_have(space: InstallSpace, program: str) -> None:
    assert not space.play(f"Node(package='controller_manager', executable='{program}')").diagnostics


def test_misspelled_configuration(space: InstallSpace) -> None:
    plan = space.play(
        "DeclareLaunchArgument('world', default_value=''), "
        "LogInfo(msg=LaunchConfiguration('wrold'))"
    )
    assert "Did you mean `world`?" in only_message(plan, "LCH009")


@pytest.mark.parametrize(
    ("value", "meant"),
    [
        ("xml.dom.minidom.parseString('<a/>')", ".toxml()"),
        ("object()", "Check the types"),
    ],
)
def test_document_instead_of_its_text(space: InstallSpace, value: str, meant: str) -> None:
    plan = space.play(
        f"Node(package='rviz2', executable='rviz2', parameters=[{{'a': {value}}}])",
        before="import xml.dom.minidom",
    )
    assert meant in only_message(plan, "LCH010")


def test_parameters_without_a_list(space: InstallSpace) -> None:
    value = f"{{'robot_description': '{'x' * 9999}'}}"
    plan = space.play(f"Node(package='rviz2', executable='rviz2', parameters={value})")
    message = only_message(plan, "LCH010")
    assert "parameters=[{...}]" in message
    assert len(message) < 400


@pytest.mark.parametrize(
    ("name", "text", "encoding", "line"),
    [
        ("bad.launch.py", "x = 'é'\n", "utf-16", 1),
        ("bad.launch.py", "x = 'é'\n", "utf-16-le", 1),
        ("bad.launch.py", "\nx = 'é'\n", "latin-1", 2),
        ("bad.launch.xml", "<launch>\n<!-- é --></launch>", "latin-1", 2),
        ("bad.launch.yaml", "launch:\n- let: {name: a, value: é}\n", "latin-1", 2),
        ("bad.launch.yaml", "launch:\n- let: {name: a, value: é}\n", "utf-16-le", 1),
    ],
)
def test_launch_file_that_is_not_in_utf_8(
    space: InstallSpace, name: str, text: str, encoding: str, line: int
) -> None:
    file = space.add("my_robot") / name
    file.write_bytes(text.encode(encoding))
    plan = space.evaluate(file)
    message = only_message(plan, "LCH032")
    assert ("UTF-16" in message) == encoding.startswith("utf-16")
    assert f"iconv -f {'UTF-16' if encoding.startswith('utf-16') else 'ISO-8859-1'}" in message
    assert line_of(plan) == line


def test_a_name_that_no_folder_can_have(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    name = "x" * 300
    assert first_missing(str(tmp_path / name / "a.world")) == (name, ["model"])


def test_null_byte_in_utf_8(space: InstallSpace) -> None:
    file = space.add("my_robot") / "bad.launch.py"
    file.write_bytes("x = 'é'\ny = 'a\0b'\n".encode())
    plan = space.evaluate(file)
    assert "null byte" in only_message(plan, "LCH001")
    assert line_of(plan) == 2


def test_declared_encoding_is_none_of_this(space: InstallSpace) -> None:
    file = space.add("my_robot") / "bad.launch.py"
    file.write_bytes("# coding: latin-1\nx = 'é'\nx = (\n".encode("latin-1"))
    only_message(space.evaluate(file), "LCH001")


@pytest.mark.parametrize(
    ("given", "meant"),
    [("exec='talker'", "executable"), ("type='talker'", "executable")],
)
def test_keywords_of_markup(space: InstallSpace, given: str, meant: str) -> None:
    plan = space.play(f"Node(package='rviz2', {given})")
    assert f"Did you mean `{meant}`?" in only_message(plan, "LCH031")
    plan = space.play("Node(pkg='rviz2', executable='rviz2')")
    assert "Did you mean `package`?" in only_message(plan, "LCH031")


def test_an_import_with_other_capitals(space: InstallSpace) -> None:
    message = only_message(space.play("", before="from launch import launchDescription"), "LCH017")
    assert message.startswith("`launch` has no `launchDescription`.")
    assert "Did you mean `LaunchDescription`?" in message


@pytest.mark.parametrize(
    "joined",
    [
        "os.path.join(share, 'x', '/model/r.urdf')",
        "os.path.join(share, '/model', 'r.urdf')",
        "PathJoinSubstitution([share, '/model', 'r.urdf']).perform(LaunchContext())",
    ],
)
def test_a_part_of_a_path_that_begins_with_a_slash(space: InstallSpace, joined: str) -> None:
    before = f"""
        from launch import LaunchContext
        share = get_package_share_directory('my_robot')
        path = {joined}
        text = open(path).read()
        """
    plan = space.play("", before=before)
    assert "ignores everything before '/model" in only_message(plan, "LCH005")
    (found,) = plan.diagnostics
    assert joined in plan.launch_file.read_text().splitlines()[(found.line or 0) - 1]
    assert "without the leading slash" in (found.hint or "")
    other = space.play("", before=before.replace("open(path)", "open('/modelx/r.urdf')"))
    assert "drops" not in only_message(other, "LCH005")


@pytest.mark.parametrize(
    ("name", "meant"),
    [("model.urfd", "model.urdf"), ("model.config", None), ("models.urdf", "model.urdf")],
)
def test_a_file_beside_the_missing_one(space: InstallSpace, name: str, meant: str | None) -> None:
    share = space.add("my_robot", {"model.urdf": "<robot/>"})
    plan = space.play("", before=f"open('{share}/{name}')")
    message = only_message(plan, "LCH005")
    assert ("Did you mean" in message) == (meant is not None)
    assert meant is None or f"`{meant}`" in message


def test_a_variable_that_is_read_as_a_configuration(space: InstallSpace) -> None:
    plan = space.play("LogInfo(msg=LaunchConfiguration('GAZEBO_MODEL_PATH'))")
    assert "EnvironmentVariable('GAZEBO_MODEL_PATH'" in only_message(plan, "LCH009")
