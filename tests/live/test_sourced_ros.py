"""A ROS that is sourced: its own programs run, compiled ones too, and only Gazebo is wsgen.

The ROS is one that looks like /opt/ros/DISTRO: the libraries, the headers and the Python of the
wheels, and in place of its C++ programs one of C that is compiled against its rcl.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from live_launch import wait_until
from own_network import ros_domain
from ros_for_tests import plain_environment, ros_with, variables_for
from wsgen.ros.environment.available import MARKER

pytestmark = pytest.mark.slow
SECONDS = 300.0  # wall-clock, on a busy machine
SOURCE = Path(__file__).with_name("compiled_publisher.c")
LIBRARIES = (
    "rcl",
    "rcl_yaml_param_parser",
    "rcutils",
    "rosidl_runtime_c",
    "std_msgs__rosidl_typesupport_c",
    "std_msgs__rosidl_generator_c",
)
SAYS = """#!/bin/sh
echo the real $(basename "$0")
exec sleep 1000
"""
GAZEBO = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration

def generate_launch_description():
    world = LaunchConfiguration('world')
    return LaunchDescription([
        DeclareLaunchArgument('world', default_value=''),
        ExecuteProcess(cmd=['gzserver', world, '-s', 'libgazebo_ros_init.so'], output='screen'),
        ExecuteProcess(cmd=['gzclient'], output='screen'),
    ])
"""
LAUNCH = """
import os
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    here = os.path.dirname(__file__)
    return LaunchDescription([
        IncludeLaunchDescription(os.path.join(here, 'gazebo_model.launch.py')),
        Node(package='rviz2', executable='rviz2', output='screen'),
        Node(package='rover', executable='compiled', output='screen',
             parameters=[{'robot_description': 'mine'}], remappings=[('robot_description', 'own')]),
    ])
"""


def _link_tree(source: Path, target: Path, opened: tuple[str, ...]) -> None:
    target.mkdir(exist_ok=True)
    for entry in source.iterdir():
        if entry.name in opened:
            _link_tree(entry, target / entry.name, opened)
        elif entry.name != MARKER:
            (target / entry.name).symlink_to(entry)


def _add_package(prefix: Path, name: str, program: str) -> Path:
    (prefix / "share/ament_index/resource_index/packages" / name).touch()
    (prefix / "share" / name).mkdir(exist_ok=True)
    folder = prefix / "lib" / name
    folder.mkdir(exist_ok=True)
    return folder / program


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program of C on the rcl of the wheels."""
    ros = ros_with()
    compiler = shutil.which("cc")
    folder, library = sysconfig.get_config_var("LIBDIR"), sysconfig.get_config_var("LDLIBRARY")
    if compiler is None or not str(library).endswith(".so") or not Path(folder, library).exists():
        pytest.skip("no compiler, or no shared library of Python, which those of ROS need")
    program = tmp_path_factory.mktemp("compiled") / "program"
    real = ros.prefixes[-1]
    includes = [f"-I{entry}" for entry in (real / "include").iterdir()]
    command = [compiler, "-w", str(SOURCE), "-o", str(program), *includes, f"-L{real / 'lib'}"]
    command += [f"-L{folder}", f"-Wl,-rpath,{folder}", *(f"-l{name}" for name in LIBRARIES)]
    command += ["-Wl,--allow-shlib-undefined", "-Wl,--no-as-needed", f"-l:{library}"]
    subprocess.run(command, check=True)
    return program


@pytest.fixture(scope="module")
def sourced(tmp_path_factory: pytest.TempPathFactory, compiled: Path) -> dict[str, str]:
    """The variables that the setup file of such a ROS sets."""
    ros = ros_with()
    real, prefix = ros.prefixes[-1], tmp_path_factory.mktemp("opt") / "kilted"
    _link_tree(real, prefix, ("lib", "share", "ament_index", "resource_index", "packages"))
    name = "robot_state_publisher"
    shutil.copy(compiled, _add_package(prefix, name, name))
    for package, program in (("rviz2", "rviz2"), ("gazebo_ros", "spawn_entity.py")):
        file = _add_package(prefix, package, program)
        file.write_text(SAYS)
        file.chmod(0o755)
    (prefix / "share/gazebo_ros/launch").mkdir()
    (prefix / "share/gazebo_ros/launch/gazebo.launch.py").write_text(GAZEBO)
    variables = variables_for(ros)
    for name in ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH"):
        entries = variables[name].split(os.pathsep)
        moved = [
            str(prefix / Path(entry).relative_to(real))
            if real in (Path(entry), *Path(entry).parents)
            else entry
            for entry in entries
        ]
        variables[name] = os.pathsep.join(moved)
    beside = str(Path(sys.executable).parent)
    return {**variables, "PATH": os.pathsep.join([beside, variables["PATH"]])}


def test_its_programs_run_and_only_gazebo_is_replaced(
    sourced: dict[str, str], compiled: Path, tmp_path: Path
) -> None:
    words = [sys.executable, "-m", "wsgen"]
    made = subprocess.run(
        [*words, "new", "rover", "--template", "diff_drive", "-q"],
        cwd=tmp_path,
        env=plain_environment(),
        check=False,
    )
    assert made.returncode == 0
    (launch,) = tmp_path.rglob("launch")
    (launch / "all.launch.py").write_text(LAUNCH)
    root = launch.parents[2]
    built = subprocess.run([*words, "build", "-q"], cwd=root, env=plain_environment(), check=False)
    assert built.returncode == 0
    own = root / "install/rover/lib/rover"
    own.mkdir(parents=True)
    shutil.copy(compiled, own / "compiled")
    screen = tmp_path / "screen"
    with (
        screen.open("wb") as stream,
        subprocess.Popen(
            [*words, "launch", "rover", "all.launch.py", "--run"],
            cwd=root,
            env={**sourced, "ROS_DOMAIN_ID": ros_domain(), "ROS_LOG_DIR": str(tmp_path / "log")},
            stdout=stream,
            stderr=subprocess.STDOUT,
        ) as run,
    ):
        try:
            awaited = {"compiled publisher of": 2, "the real rviz2": 1, "Successfully spawned": 1}
            wait_until(
                lambda: all(screen.read_text().count(one) >= awaited[one] for one in awaited),
                screen.read_text,
                SECONDS,
            )
            run.send_signal(signal.SIGINT)
            assert run.wait(SECONDS) == 0, screen.read_text()
        finally:
            run.kill()  # does nothing when it has ended
    shown = screen.read_text()
    assert "the real rviz2" in shown
    assert "compiled publisher of 4 characters" in shown  # of the workspace, with its parameter
    assert shown.count("compiled publisher of") == 2  # and robot_state_publisher
    assert "Robot initialized" not in shown  # that of wsgen
    assert "the real spawn_entity.py" not in shown
    assert "Successfully spawned entity [rover]" in shown
    assert shown.count("left out") == 1
    assert "gzclient is left out" in shown
    assert "compiled publisher ends" in shown
