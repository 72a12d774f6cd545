"""Plain launch files: which they are, and that one child evaluates many as one each would."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.descriptions.xacro.reader import TASK as XACRO_TASK
from wsgen.descriptions.xacro.reader import expand_file
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.parent import Run
from wsgen.isolation.result import Answered, Died, Limits
from wsgen.launching.evaluate import LIMITS, TASK_OF_XACRO, PlainLaunches, evaluate
from wsgen.launching.plain import is_plain, is_plain_expression
from wsgen.model.plan import LaunchPlan
from wsgen.packages.source_shares import serve_sources

TESTS = Path(__file__).parents[1]
HEAD = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import ExecuteProcess, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node
"""
EMPTY = "def generate_launch_description():\n    return LaunchDescription([])\n"


@pytest.mark.parametrize(
    "lines",
    [
        "share = get_package_share_directory('demo')",
        "path = os.path.join(os.getcwd(), 'a')",
        "model = os.environ['MODEL'] if 'a' in 'b' else os.environ.get('MODEL', 'burger')",
        "nodes = [Node(package=name, executable=f'{name}_node') for name in ('a', 'b')]",
        "from os.path import join\npath = join('a', 'b')",
        "import launch.actions\none = launch.actions.Node",
    ],
)
def test_what_only_describes_is_plain(lines: str) -> None:
    assert is_plain(f"{HEAD}{lines}\n{EMPTY}".encode())


@pytest.mark.parametrize(
    "lines",
    [
        "import sys",
        "import subprocess",
        "import my_package",
        "from my_package.launch import common",
        "from . import common",
        "from os import chdir",
        "from os.path import os",
        "from launch import os",
        "from launch.actions import *",
        "import launch.logging",
        "from launch.logging import launch_config",
        "os.chdir('/')",
        "os.environ['A'] = 'b'",
        "os.environ.update(a='b')",
        "os.path.os.chdir('/')",
        "system = os\nsystem.chdir('/')",
        "path = os.path\npath.os.chdir('/')",
        "function = os.path.join",
        "open('file', 'w')",
        "exec('import sys')",
        "getattr(os, 'chdir')('/')",
        "__import__('sys')",
        "LaunchDescription.visit = None",
        "Node.__init__.__globals__",
        "launch.launch_context.os.chdir('/')",
        "class MyNode(Node):\n    pass",
        "@print\ndef function():\n    pass",
        "while True:\n    pass",
        "def function(open=None):\n    pass\nopen('file', 'w')",
        "os.path.join('a'",
    ],
)
def test_what_may_leave_something_behind_is_not_plain(lines: str) -> None:
    assert not is_plain(f"{HEAD}{lines}\n{EMPTY}".encode())


def test_expressions() -> None:
    assert is_plain_expression(" 'true' == 'true' and not False")
    assert not is_plain_expression("__import__('os').getcwd()")
    assert not is_plain_expression("[].append")
    assert not is_plain_expression("1 +")


class Counted:
    """Runs tasks, and counts them."""

    def __init__(self, run: Run) -> None:
        self.count = 0
        self._run = run

    def run(
        self,
        task: str,
        *arguments: object,
        limits: Limits = LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        self.count += 1
        return self._run(task, *arguments, limits=limits, environment=environment, folder=folder)


@pytest.fixture(scope="module")
def apart() -> Iterator[Counted]:
    """A child for each."""
    with ForkServer() as server:
        yield Counted(server.run)


@pytest.fixture
def together(
    apart: Counted, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Iterator[PlainLaunches]:
    is_forked = getattr(request, "param", "started") == "forked"
    if is_forked:  # the test runner's threads hold no lock that a child needs
        monkeypatch.setattr("wsgen.isolation.system.can_fork", lambda: True)
    with PlainLaunches(apart.run, is_forked=is_forked) as launches:
        yield launches


BOTH = pytest.mark.parametrize("together", ["started", "forked"], indirect=True)


def plan(file: Path, run: Run, limits: Limits = LIMITS, **environment: str) -> LaunchPlan:
    variables = {"AMENT_PREFIX_PATH": str(file.parent), **os.environ, **environment}
    found = evaluate(
        file, package=None, arguments={}, environment=variables, limits=limits, run=run
    )
    return replace(found, seconds_in_xacro=0.0)


def write(folder: Path, name: str, lines: str, entities: str = "") -> Path:
    file = folder / f"{name}.launch.py"
    body = EMPTY.replace("[]", f"[{entities}]")
    file.write_text(f"{HEAD}{lines}\n{body}")
    return file


@pytest.mark.slow
@BOTH
def test_one_child_plans_as_many(together: PlainLaunches, apart: Counted, tmp_path: Path) -> None:
    """All launch files of the tests, one after the other: nothing of one is met by the next."""
    manifests = [
        *TESTS.glob("workspaces/*/src/*/package.xml"),
        *TESTS.glob("golden/*/*/src/*/package.xml"),
    ]
    served = 0
    for index, manifest in enumerate(sorted(manifests)):
        source = manifest.parent
        sources = {source.name: source}
        variables = serve_sources(
            sources, tmp_path / str(index), {**os.environ, "ROS_DISTRO": "iron"}
        )
        for file in sorted(source.rglob("*launch.*")):
            if file.suffix not in {".py", ".xml", ".yaml"}:
                continue
            before = apart.count
            plans = [
                replace(
                    evaluate(
                        file,
                        package=source.name,
                        arguments={},
                        environment=variables,
                        run=run,
                    ),
                    seconds_in_xacro=0.0,
                )
                for run in (together.run, apart.run)
            ]
            if apart.count == before + 1:  # others may be random
                served += 1
                assert plans[0] == plans[1], file
    assert served > 10


@pytest.mark.slow
def test_nothing_of_one_is_met_by_the_next(
    together: PlainLaunches, apart: Counted, tmp_path: Path
) -> None:
    first = write(
        tmp_path,
        "first",
        "get_package_share_directory('nav2_nowhere')",
        "SetEnvironmentVariable('ROBOT', 'one'), Node(package='demo', executable='talker')",
    )
    second = write(
        tmp_path,
        "second",
        "robot = os.environ.get('ROBOT', 'none')",
        "Node(package='demo', executable=robot)",
    )
    assert plan(first, together.run).environment == {"ROBOT": "one"}
    found = plan(second, together.run)
    assert apart.count == 0 or found.is_complete
    assert [process.executable for process in found.processes] == ["none"]
    assert found.environment == {}
    assert found == plan(second, apart.run)
    given = plan(second, together.run, ROBOT="given")
    assert [process.executable for process in given.processes] == ["given"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lines", "entities", "code"),
    [
        ("robot = 1 / 0", "", "LCH002"),
        ("", "ExecuteProcess(cmd=[PythonExpression(['__import__(\"os\").getpid()'])])", None),
    ],
)
def test_what_fails_or_executes_more_gets_a_child_of_its_own(  # noqa: PLR0917  fixtures
    together: PlainLaunches,
    apart: Counted,
    tmp_path: Path,
    lines: str,
    entities: str,
    code: str | None,
) -> None:
    before = apart.count
    file = write(tmp_path, "one", lines, entities)
    found = plan(file, together.run)
    assert apart.count == before + 1
    assert found.is_complete == (code is None)


@pytest.mark.slow
def test_an_included_file_that_is_not_plain(
    together: PlainLaunches, apart: Counted, tmp_path: Path
) -> None:
    write(tmp_path, "included", "import sys\nsys.path.append('/')")
    file = tmp_path / "main.launch.xml"
    file.write_text(f'<launch><include file="{tmp_path}/included.launch.py"/></launch>')
    before = apart.count
    assert plan(file, together.run).is_complete
    assert apart.count == before + 1


@pytest.mark.slow
def test_a_child_that_dies_is_started_again(
    together: PlainLaunches, apart: Counted, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What kills it, kills a child of its own, too, and is reported."""
    monkeypatch.setattr("wsgen.launching.evaluate.SECONDS", 1.0)
    deadly = write(tmp_path, "deadly", "for _ in range(10**12):\n    pass")
    sound = write(tmp_path, "sound", "text = 'x'")
    before = apart.count
    for _ in range(2):
        assert not plan(deadly, together.run, limits=Limits(seconds=1.0)).is_complete
        assert plan(sound, together.run).is_complete
    assert apart.count == before + 2


XACRO = """\
<robot name="demo" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:include filename="{included}"/>
  <link name="$(optenv LINK base_link)"/>
</robot>
"""
COMMAND = """\
Node(package='robot_state_publisher', executable='robot_state_publisher',
        parameters=[{{'robot_description': Command(['xacro {file}'])}}])
"""


@pytest.mark.slow
def test_a_robot_is_expanded_again_where_it_may_have_changed(
    together: PlainLaunches, tmp_path: Path
) -> None:
    included, xacro = tmp_path / "part.xacro", tmp_path / "robot.xacro"
    included.write_text('<robot><link name="first"/></robot>')
    xacro.write_text(XACRO.format(included=included))
    imports = "from launch.substitutions import Command"
    files = [write(tmp_path, name, imports, COMMAND.format(file=xacro)) for name in ("a", "b")]

    def expand(file: Path, **environment: str) -> tuple[str, Path | None, bool]:
        variables = {"AMENT_PREFIX_PATH": str(tmp_path), **os.environ, **environment}
        found = evaluate(file, package=None, arguments={}, environment=variables, run=together.run)
        (process,) = found.processes
        text = process.parameters["robot_description"]
        return text, process.description_file, found.seconds_in_xacro > 0.0

    text, source, is_expanded = expand(files[0])
    assert '"first"' in text
    assert '"base_link"' in text
    assert (source, is_expanded) == (xacro, True)
    assert expand(files[1]) == (text, xacro, False)
    assert '"arm"' in expand(files[1], LINK="arm")[0]
    included.write_text('<robot><link name="another"/></robot>')
    text, source, is_expanded = expand(files[1])
    assert '"another"' in text
    assert is_expanded


@pytest.mark.slow
def test_the_origin_of_a_robot_that_two_command_lines_expand_alike(
    together: PlainLaunches, apart: Counted, tmp_path: Path
) -> None:
    xacro = tmp_path / "robot.xacro"
    xacro.write_text(ROBOT.format('<xacro:arg name="a" default="1"/><link name="l$(arg a)"/>'))
    imports = "from launch.substitutions import Command"
    given = COMMAND.format(file=f"{xacro} a:=1")
    both = write(tmp_path, "both", imports, f"{COMMAND.format(file=xacro)}, {given}")
    second = write(tmp_path, "second", imports, given)
    before = apart.count
    plans = [plan(file, together.run) for file in (both, second)]
    assert apart.count == before
    assert plans == [plan(file, apart.run) for file in (both, second)]
    sources = [process.description_file for one in plans for process in one.processes]
    assert sources == [xacro] * 3


ROBOT = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
XACRO_FILES = {
    "sound": '<xacro:arg name="size" default="1"/><link name="a$(arg size)"/>',
    "defines": '<xacro:property name="p" value="3"/><xacro:macro name="m" params="">'
    '<link name="b"/></xacro:macro><xacro:arg name="kept" default="2"/><xacro:m/>',
    "wants a property": '<link name="a${p}"/>',
    "wants a macro": "<xacro:m/>",
    "wants an argument": '<link name="$(arg kept)"/>',
    "includes": '<xacro:include filename="sound.xacro"/>',
    "reads the environment": '<link name="$(optenv MODEL none)"/>',
    "is broken": "<link",
    "prints": "${xacro.message('printed')}<link name='c'/>",
}


@pytest.mark.slow
def test_a_robot_is_expanded_again_where_it_includes_a_new_file(
    together: PlainLaunches, tmp_path: Path
) -> None:
    parts = tmp_path / "parts"
    parts.mkdir()
    xacro = tmp_path / "robot.xacro"
    xacro.write_text(XACRO.format(included=parts / "*.xacro"))
    imports = "from launch.substitutions import Command"
    file = write(tmp_path, "a", imports, COMMAND.format(file=xacro))
    for name in ("first", "another"):
        (parts / f"{name}.xacro").write_text(f'<robot><link name="{name}"/></robot>')
        (process,) = plan(file, together.run).processes
        assert f'"{name}"' in process.parameters["robot_description"]


@pytest.mark.slow
@BOTH
def test_one_child_expands_as_many(together: PlainLaunches, apart: Counted, tmp_path: Path) -> None:
    assert TASK_OF_XACRO == XACRO_TASK
    for name, text in XACRO_FILES.items():
        (tmp_path / f"{name}.xacro").write_text(ROBOT.format(text))

    def expand(name: str, run: Run, **arguments: str) -> object:
        variables = {**os.environ, "MODEL": arguments.get("size", "small")}
        file = tmp_path / f"{name}.xacro"
        return expand_file(file, arguments, environment=variables, run=run)

    before = apart.count
    for name in (*XACRO_FILES, *reversed(XACRO_FILES)):
        for arguments in ({}, {"size": "2"}):
            found = expand(name, together.run, **arguments)
            count = apart.count
            assert found == expand(name, apart.run, **arguments), name
            apart.count = count
    failing = [name for name in XACRO_FILES if expand(name, together.run)[0] is None]  # type: ignore[index]
    assert failing == ["wants a property", "wants a macro", "wants an argument", "is broken"]
    # What fails is expanded in a child of its own, which explains it.
    assert apart.count - before == 5 * len(failing)


@pytest.mark.slow
def test_a_launch_file_leaves_xacro_its_way_to_find_packages(
    together: PlainLaunches, apart: Counted, tmp_path: Path
) -> None:
    """Launch files may look up packages that are not installed."""
    file = tmp_path / "robot.xacro"
    file.write_text(ROBOT.format('<link name="$(find nav2_bringup)"/>'))
    variables = {**os.environ, "AMENT_PREFIX_PATH": str(tmp_path)}
    alone = expand_file(file, {}, environment=variables, run=apart.run)
    assert alone[0] is None
    before = apart.count
    assert plan(write(tmp_path, "first", ""), together.run).is_complete
    assert apart.count == before
    assert expand_file(file, {}, environment=variables, run=together.run) == alone
