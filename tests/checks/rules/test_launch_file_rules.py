"""What launch files and parameter files write, from files and plans alone."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from install_space import HEAD, InstallSpace
from wsgen.checks.rules import launch_files
from wsgen.diagnostics import Severity
from wsgen.model.plan import Include, LaunchPlan, Process


def plan(*processes: Process, file: Path = Path("a.launch.py")) -> LaunchPlan:
    return LaunchPlan(package="my_robot", launch_file=file, processes=processes)


def rviz(path: str, **parameters: object) -> Process:
    return Process(
        package="rviz2",
        executable="rviz2",
        arguments=("-d", path),
        parameters=parameters,
        line=4,
    )


def test_files_that_are_not_installed(tmp_path: Path) -> None:
    share = tmp_path / "share" / "my_robot"
    share.joinpath("rviz").mkdir(parents=True)
    share.joinpath("rviz", "robot.rviz").touch()
    for path, words in (
        (share / "maps" / "a.yaml", "install(DIRECTORY maps"),
        (share / "a.yaml", "install(FILES a.yaml"),
        (share / "rviz" / "robt.rviz", "Did you mean `robot.rviz`?"),
    ):
        for node in (
            rviz(str(path)),
            rviz("x", map=[str(path)]),
            rviz("x", map=f"file://{path}"),
            rviz(f"model:={path}"),
        ):
            (found,) = launch_files.missing_argument_files(plan(node), lambda _: True)
            assert (found.name, found.line, found.element) == (
                "missing-argument-file",
                4,
                str(path),
            )
            assert words in (found.hint or "")


def test_files_that_are_installed_or_elsewhere(tmp_path: Path) -> None:
    share = tmp_path / "share" / "my_robot"
    share.mkdir(parents=True)
    share.joinpath("a.yaml").touch()
    missing = str(share / "b.yaml")
    for node in (
        rviz(str(share / "a.yaml")),
        rviz(f"model:={share / 'a.yaml'}"),
        rviz("/tmp/record.bag"),
        rviz(str(share)),
        Process(package="gazebo_ros", executable="spawn_entity.py", arguments=(missing,)),
        Process(package=None, executable=None, command=("cat", missing)),
    ):
        assert not list(launch_files.missing_argument_files(plan(node), lambda _: True))
    unknown = plan(rviz(missing))
    assert not list(launch_files.missing_argument_files(unknown, lambda _: False))


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("a.launch.py", "x = 1\ny = '/home/me/ws/a.world'\nz = '/home/me/b.world'\n", 2),
        ("a.launch.xml", '<launch>\n<arg default="/Users/me/a.world"/></launch>', 2),
        ("a.yaml", "a: 1\nmap: /home/me/map.pgm\n", 2),
        ("a.yaml", "map: 'file:///home/me/map.pgm'\n", 1),
    ],
)
def test_paths_in_home_directories(tmp_path: Path, name: str, text: str, line: int) -> None:
    file = tmp_path / name
    file.write_text(text)
    (found,) = launch_files.home_paths(file)
    assert (found.name, found.file, found.line) == ("home-path", file, line)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.launch.py", '"""As in /home/me/ws."""\n# /home/me/ws/a\nx = "see /home/me/a.b"\n'),
        ("a.launch.xml", "<launch><!-- /home/me/a.world --></launch>"),
        ("a.yaml", "# /home/me/a.yaml\na: b  # /home/me/b\ntopic: /home_position/a\n"),
        ("a.yaml", "topic: /home/\nother: /robot/home/me/x\n"),
    ],
)
def test_no_paths_in_home_directories(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / name
    file.write_text(text)
    assert not list(launch_files.home_paths(file))


DECLARED = "DeclareLaunchArgument('gui', default_value='true')"


def declaring(tmp_path: Path, *others: str) -> LaunchPlan:
    file = tmp_path / "a.launch.py"
    file.write_text("".join(f"{one}\n" for one in (DECLARED, *others)))
    return plan(file=file)


def test_arguments_that_nothing_reads(tmp_path: Path) -> None:
    for other in ("", "LaunchConfiguration('guide')"):
        (found,) = launch_files.unused_declared_arguments(declaring(tmp_path, other))
        assert (found.name, found.line, found.element) == ("unused-declared-argument", 1, "gui")


def test_arguments_that_may_be_read(tmp_path: Path) -> None:
    for other in (
        "LaunchConfiguration('gui')",
        "LaunchConfiguration(name)",
        "context.launch_configurations[name]",
        "# gui",
    ):
        assert not list(launch_files.unused_declared_arguments(declaring(tmp_path, other)))
    not_run = Include(package="other", file=Path("b.launch.py"), evaluated=False)
    found = declaring(tmp_path)
    with_include = LaunchPlan(package="p", launch_file=found.launch_file, includes=(not_run,))
    assert not list(launch_files.unused_declared_arguments(with_include))


@pytest.mark.slow
def test_launch_files_of_ros_1(tmp_path: Path) -> None:
    space = InstallSpace(tmp_path / "install")
    file = tmp_path / "a.launch"
    for text, line in (
        ('<launch>\n  <param command="$(find xacro)/xacro"/></launch>', 2),
        ('<launch>\n  <!-- $(find a) -->\n  <node\n pkg="a" type="b"/></launch>', 4),
    ):
        file.write_text(text)
        (found,) = launch_files.ros_1_launch_files([file])
        assert (found.name, found.severity, found.line) == (
            "ros-1-launch-file",
            Severity.WARNING,
            line,
        )
    file.write_text('<launch><node pkg="a" exec="b"/></launch>')
    assert not list(launch_files.ros_1_launch_files([file]))
    for text in ("<arg name='a' default='$(find b)'/>", "<node pkg='rviz2' type='rviz2'/>"):
        share = space.add("my_robot", {"launch/a.launch.xml": f"<launch>\n{text}\n</launch>"})
        (found,) = space.evaluate(share / "launch" / "a.launch.xml").diagnostics
        assert (found.name, found.severity, found.line) == (
            "ros-1-launch-file",
            Severity.ERROR,
            2,
        )


def test_commands_of_ros_1() -> None:
    wrong = Process(package=None, executable=None, command=("rosrun", "a", "b"), line=3)
    (found,) = launch_files.ros_1_commands(plan(wrong))
    assert (found.name, found.line, found.hint) == (
        "ros-1-command",
        3,
        "Write 'ros2', 'run' instead.",
    )
    sound = Process(package=None, executable=None, command=("ros2", "run", "a", "rosrun"))
    own = Process(package="own", executable="rosbag")
    assert not list(launch_files.ros_1_commands(plan(sound, own)))


@pytest.mark.slow
def test_xacro_and_its_file_are_two_words(tmp_path: Path) -> None:
    space = InstallSpace(tmp_path / "install")
    text = HEAD + dedent("""
        def generate_launch_description():
            path = os.path.join(get_package_share_directory('my_robot'), 'a.xacro')
            return LaunchDescription([Node(package='rviz2', executable='rviz2', parameters=[
                {'a': ParameterValue(Command(['xacro', path]), value_type=str)}])])
    """)
    share = space.add("my_robot", {"launch/a.launch.py": text, "a.xacro": "<robot name='r'/>"})
    plan = space.evaluate(share / "launch" / "a.launch.py")
    found = next(one for one in plan.diagnostics if one.severity is Severity.ERROR)
    assert (found.name, found.element) == ("glued-command", "xacro")
    assert (
        found.line
        == text.splitlines().index(
            "        {'a': ParameterValue(Command(['xacro', path]), value_type=str)}])])"
        )
        + 1
    )
