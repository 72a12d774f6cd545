"""Simulators are read from plans, however they are started."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from install_space import HEAD
from wsgen.diagnostics import Severity
from wsgen.launching.simulators import find_simulator, kind_of_project
from wsgen.model.plan import Include, LaunchPlan, Process, Unresolved

if TYPE_CHECKING:
    from install_space import InstallSpace


def plan(*processes: Process, includes: tuple[Include, ...] = ()) -> LaunchPlan:
    return LaunchPlan(
        package="p", launch_file=Path("p.launch.py"), processes=processes, includes=includes
    )


def command(*words: str, is_shell: bool = False) -> LaunchPlan:
    return plan(Process(package=None, executable=None, command=words, is_shell=is_shell))


def shell(*words: str) -> LaunchPlan:
    return command(*words, is_shell=True)


def node(package: str, executable: str, *arguments: str) -> LaunchPlan:
    return plan(Process(package=package, executable=executable, arguments=arguments))


def include(name: str, package: str = "gazebo_ros", **values: str) -> LaunchPlan:
    return plan(
        includes=(
            Include(
                package=package,
                file=Path("/opt/ros/iron/share") / package / "launch" / name,
                configurations=values,
                evaluated=False,
            ),
        )
    )


@pytest.mark.parametrize(
    ("started", "simulator"),
    [
        (include("gazebo.launch.py", world="w"), ("classic", "w", False)),
        (include("gazebo.launch.py", world="", gui="false"), ("classic", None, True)),
        (include("gzserver.launch.py", world="w"), ("classic", "w", True)),
        (include("gz_sim.launch.py", "ros_gz_sim", gz_args="-r -s w.sdf"), ("gz", "w.sdf", True)),
        (include("gz_sim.launch.py", "ros_gz_sim", ign_args="w.sdf"), ("gz", "w.sdf", False)),
        (include("gz_sim.launch.py", "ros_gz_sim", gz_args="/w.model"), ("gz", "/w.model", False)),
        (include("gz_sim.launch.py", "ros_gz_sim", gz_args="-r 'a b"), ("gz", None, False)),
        (
            include("ign_gazebo.launch.py", "ros_ign_gazebo", ign_args="-r w.sdf"),
            ("gz", "w.sdf", False),
        ),
        (include("gz_server.launch", "ros_gz_sim", world_sdf_file="w.sdf"), ("gz", "w.sdf", True)),
        (command("gzserver", "w.world"), ("classic", "w.world", True)),
        (command("gzserver", "-slibgazebo_ros_init.so", "w.world"), ("classic", "w.world", True)),
        (
            command("gazebo", "--verbose", "/w/office", "-s", "/l/l"),
            ("classic", "/w/office", False),
        ),
        (command("gazebo", "-s", "libgazebo_ros_factory.so"), ("classic", None, False)),
        (command("gazebo", "--ros-args", "--params-file", "/a/b"), ("classic", None, False)),
        (
            shell("gazebo --verbose w.world -s libgazebo_ros_factory.so"),
            ("classic", "w.world", False),
        ),
        (node("gazebo_ros", "gzserver", "w.world"), ("classic", "w.world", True)),
        (node("ros_gz_sim", "gzserver", "w.sdf"), ("gz", "w.sdf", True)),
        (command("gz", "sim", "-v", "4", "-r", "w.sdf"), ("gz", "w.sdf", False)),
        (command("gz", "sim", "-r -s w.sdf"), ("gz", "w.sdf", True)),
        (command("ign", "gazebo", "-s", "/w/moon"), ("gz", "/w/moon", True)),
        (command("gz", "sim", "-r", "/w/moon.model"), ("gz", "/w/moon.model", False)),
        (command("ruby", "/usr/bin/ign", "gazebo", "-r", "w.sdf"), ("gz", "w.sdf", False)),
        (
            command("ruby", "/opt/bin/gz", "sim", "w.sdf", "--force-version", "8"),
            ("gz", "w.sdf", False),
        ),
        (shell("ruby $(which gz) sim -r w.sdf"), ("gz", "w.sdf", False)),
        (shell("ruby `which ign` gazebo w.sdf"), ("gz", "w.sdf", False)),
        (shell("ign gazebo -r", "w.sdf"), ("gz", "w.sdf", False)),
        (shell("gz sim -r '/my worlds/w.sdf'"), ("gz", "/my worlds/w.sdf", False)),
        (shell("cd /w && GZ_A=/m exec gz sim -r w.sdf > /tmp/log 2>&1 &"), ("gz", "w.sdf", False)),
        (shell("sleep 3; env -u A B=c gz sim w.sdf"), ("gz", "w.sdf", False)),
        (command("bash", "-c", "source /s.bash && gz sim -r w.sdf"), ("gz", "w.sdf", False)),
        (command("bash", "-i", "-lc", "gazebo w.world"), ("classic", "w.world", False)),
        (command("xterm", "-hold", "-e", "gz", "sim", "w.sdf"), ("gz", "w.sdf", False)),
        (command("xterm", "-e", "gz sim w.sdf"), ("gz", "w.sdf", False)),
        (
            command("gnome-terminal", "--tab", "--", "bash", "-c", "gazebo w.world; exec bash"),
            ("classic", "w.world", False),
        ),
        (command("xvfb-run", "-a", "gzserver", "w.world"), ("classic", "w.world", True)),
        (command("timeout", "-k", "5", "60", "gz", "sim", "-s", "w.sdf"), ("gz", "w.sdf", True)),
        (
            command("ros2", "launch", "gazebo_ros", "gazebo.launch.py", "world:=w.world"),
            ("classic", "w.world", False),
        ),
        (
            command(
                "ros2", "launch", "--debug", "ros_gz_sim", "gz_sim.launch.py", "gz_args:=-s w.sdf"
            ),
            ("gz", "w.sdf", True),
        ),
        (command("ros2", "run", "ros_gz_sim", "gzserver", "w.sdf"), ("gz", "w.sdf", True)),
    ],
)
def test_simulator(started: LaunchPlan, simulator: tuple[str, str | None, bool]) -> None:
    found, diagnostics = find_simulator(started)
    assert not diagnostics
    assert found is not None
    assert (found.kind, found.world, found.is_headless) == simulator


@pytest.mark.parametrize(
    "started",
    [
        plan(),
        include("gazebo.launch.py", server="false"),
        include("gzclient.launch.py"),
        include("gz_sim.launch.py", "ros_gz_sim", gz_args="-g"),
        command(),
        command("gzclient"),
        command("gz", "sim", "-g"),
        command("gz", "service", "-l"),
        command("ros2", "launch"),
        command("bash", "gazebo.sh"),
        command("echo", "gazebo", "w.world"),
        shell("echo 'gz sim w.sdf"),
    ],
)
def test_no_simulator(started: LaunchPlan) -> None:
    found, (diagnostic,) = find_simulator(started)
    assert found is None
    assert diagnostic.code == "SPN001"


def test_world_that_is_not_known() -> None:
    process = Process(package=None, executable=None, command=("gz", "sim", "$(a.b c)/w.sdf"))
    unresolved = (Unresolved(what="a.b c", why="it is not installed"),)
    found, diagnostics = find_simulator(
        LaunchPlan(package="p", launch_file=Path("p"), processes=(process,), unresolved=unresolved)
    )
    assert not diagnostics
    assert found is not None
    assert (found.kind, found.world) == ("gz", None)


def test_simulator_that_is_started_elsewhere_is_a_warning() -> None:
    _, (found,) = find_simulator(node("ros_gz_sim", "create"))
    assert (found.code, found.severity) == ("SPN001", Severity.WARNING)
    assert (found.hint or "").endswith("include gz_sim.launch.py of ros_gz_sim.")


@pytest.mark.parametrize(
    ("started", "kind"),
    [
        (node("ros_gz_bridge", "parameter_bridge"), "gz"),
        (node("gazebo_ros", "spawn_entity.py"), "classic"),
        (node("rviz2", "rviz2"), None),
        (command("ros2", "run", "ros_ign_gazebo", "create"), "gz"),
    ],
)
def test_simulator_of_the_packages(started: LaunchPlan, kind: str | None) -> None:
    assert kind_of_project(started) == kind


@pytest.mark.slow
def test_command_line_without_shell(space: InstallSpace) -> None:
    started = space.play("ExecuteProcess(cmd=['gz sim -r', 'w.sdf'])")
    simulator, (found,) = find_simulator(started)
    assert simulator is not None
    assert simulator.world == "w.sdf"
    assert (found.code, found.element) == ("LCH040", "gz sim -r")
    assert found.line is not None


@pytest.mark.slow
def test_command_line_with_shell(space: InstallSpace) -> None:
    started = space.play("ExecuteProcess(cmd=['gz sim -r', 'w.sdf'], shell=True)")
    simulator, diagnostics = find_simulator(started)
    assert not diagnostics
    assert simulator is not None
    assert simulator.world == "w.sdf"


@pytest.mark.slow
def test_launch_file_that_a_process_launches(space: InstallSpace) -> None:
    nested = "ExecuteProcess(cmd=['gz', 'sim', LaunchConfiguration('w')])"
    nested = f"DeclareLaunchArgument('w', default_value='n.sdf'), {nested}"
    text = f"{HEAD}\ndef generate_launch_description():\n    return LaunchDescription([{nested}])\n"
    space.add("their_world", {"launch/w.launch.py": text})
    words = "'ros2', 'launch', 'their_world', 'w.launch.py'"
    outer = "SetLaunchConfiguration('w', 'outer.sdf'), "
    for given, world in (("", "n.sdf"), (", 'w:=g.sdf'", "g.sdf")):
        started = space.play(f"{outer}ExecuteProcess(cmd=[{words}{given}])")
        simulator, diagnostics = find_simulator(started)
        assert not diagnostics
        assert simulator is not None
        assert simulator.world == world


@pytest.mark.slow
def test_simulators_run_on_however_they_are_started(space: InstallSpace) -> None:
    for words, count in (
        ("'ruby $(which gz) sim w.sdf'", 2),
        ("'xterm -e gazebo w.world'", 2),
        ("'ros2 launch ros_gz_sim gz_sim.launch.py'", 2),
        ("'gz service -l'", 1),
    ):
        gazebo = f"ExecuteProcess(cmd=[{words}], shell=True, on_exit=Shutdown())"
        late = "TimerAction(period=5.0, actions=[ExecuteProcess(cmd=['true'])])"
        assert len(space.play(f"{gazebo}, {late}").processes) == count


@pytest.mark.slow
def test_launch_file_that_a_process_launches_and_that_is_not_installed(
    space: InstallSpace,
) -> None:
    words = "cmd=['ros2', 'launch', 'nav2_bringup', 'navigation_launch.py']"
    (found,) = space.play(f"ExecuteProcess({words})").diagnostics
    assert found.code == "LCH046"
    assert "navigation_launch.py" in found.message
    words = "cmd=['ros2', 'launch', 'gazebo_ros', 'gazebo.launch.py']"
    assert not space.play(f"ExecuteProcess({words})").diagnostics
