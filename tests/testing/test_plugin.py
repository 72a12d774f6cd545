"""What the pytest plugin gives to tests, and what it says when something is wrong."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest
from PIL import Image

from testing.conftest import write_tests
from wsgen.model.engines import ENGINES
from wsgen.testing import plugin

if TYPE_CHECKING:
    from testing.conftest import Pytest

pytestmark = pytest.mark.slow

LOADED = """
import sys, pytest
before = set(sys.modules)
import wsgen.testing.plugin
print(*sorted(set(sys.modules) - before))
"""


def test_a_run_without_robots_loads_the_plugin_alone() -> None:
    run = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["wsgen", "wsgen.testing", "wsgen.testing.plugin"]


def test_the_engines_are_those_of_wsgen() -> None:
    assert set(plugin.ENGINES) == set(ENGINES)


def test_what_is_public() -> None:
    import wsgen.testing  # noqa: PLC0415

    assert wsgen.testing.needs_ros.name == "skipif"
    for name in {*wsgen.testing.__all__} - {"needs_ros"}:
        assert getattr(wsgen.testing, name).__name__ == name
    with pytest.raises(AttributeError, match="no attribute 'assert_flies'"):
        _ = wsgen.testing.assert_flies


FAILING = """
import pytest
from wsgen.testing import assert_drives, assert_reaches, assert_stands

def test_mass(robot):
    assert robot.mass == pytest.approx(1.0)

def test_tips(robot):
    robot.push((0.0, 0.0, 100.0), seconds=0.3)
    assert_stands(robot)

def test_misspelled(robot):
    robot.joint("left_whel_joint")

def test_misspelled_link(robot):
    robot.link("base_lnk").pose_in_world

def test_drives(robot, simulation):
    simulation.settle()
    assert_drives(robot, linear=0.5, seconds=2.0, x=2.0)

def test_reaches(robot):
    assert_reaches(robot, {"left_wheel_joint": 100.0}, seconds=0.1)

def test_no_such_command(robot):
    assert_reaches(robot, {"wheel": 1.0})

def test_crash(robot, simulation):
    import os, signal
    simulation.step(0.1)
    os.kill(simulation.session._channel._child.pid, signal.SIGKILL)
    simulation.step(0.5)

def test_goes_on_after_a_crash(robot):
    assert_stands(robot)
"""


@pytest.mark.parametrize("workers", [(), ("-n", "2")])
def test_failures_say_why_and_show_it(
    workspace: Path, run_pytest: Pytest, tmp_path: Path, workers: tuple[str, ...]
) -> None:
    file = write_tests(workspace, "rover", "failing", FAILING)
    junit = tmp_path / "results" / "robot.xunit.xml"
    run = run_pytest(file, f"--junit-xml={junit}", *workers)
    said = run.stdout
    assert "8 failed, 1 passed" in said, said
    for words in (
        "assert 7.5 == 1.0 ± 1.0e-06",
        "E       error[SPN059] tips-over: The robot tips over by ",
        "has no movable joint `left_whel_joint`.\nE       Did you mean `left_wheel_joint`?",
        "has no link `base_lnk`.\nE       Did you mean `base_link`?",
        "E       AssertionError: The robot `rover`: after 2 s the robot is at x = 0.9",
        "E       AssertionError: The robot `rover`: after 0.1 s left_wheel_joint is at",
        "E       wsgen.errors.RequestError: The robot has no joint `wheel` that can move.",
        "SessionDiedError: The physics engine (PyBullet) crashed (SIGKILL) while simulating 0.5 s",
    ):
        assert words in said, f"{words!r} is not in\n{said}"
    # No line of wsgen's own code, but for the test's.
    assert not re.search(r"^\S*src/wsgen/\S+:\d+", said, re.MULTILINE), said
    picture, video = (
        junit.parent / "robot" / f"test_failing-test_tips{ending}" for ending in (".png", ".gif")
    )
    assert f"picture: {picture}\nlast second: {video}" in said
    with Image.open(picture) as image:
        assert image.size == (960, 720)
    with Image.open(video) as image:
        assert getattr(image, "n_frames", 0) > 3  # those that look alike are one
    cases = {case.get("name"): case for case in ET.parse(junit).getroot().iter("testcase")}
    failure = cases["test_tips"].find("failure")
    assert failure is not None
    message = failure.get("message") or ""
    assert "tips-over" in message
    assert str(picture) in message  # what `colcon test-result --verbose` shows
    assert str(picture) in (failure.text or "")


STATES = """
import json, pathlib

def test_states(robot, simulation, request):
    simulation.settle()
    robot.push((3.0, 5.0, 0.0), seconds=0.1)
    moved = robot.drive(linear=0.3, angular=0.4, seconds=0.7)
    numbers = [*moved, *robot.pose_in_world.xyz, *robot.pose_in_world.rpy, simulation.seconds]
    with open("states.txt", "a") as stream:
        stream.write(json.dumps([number.hex() for number in numbers]) + "\\n")

def test_again(robot, simulation, request):
    test_states(robot, simulation, request)
"""


def test_the_same_steps_give_the_same_numbers(
    workspace: Path, run_pytest: Pytest, tmp_path: Path
) -> None:
    file = write_tests(workspace, "rover", "states", STATES)
    for _ in range(2):
        assert run_pytest(file).returncode == 0
    lines = (tmp_path / "states.txt").read_text().splitlines()
    assert len(lines) == 4
    assert len(set(lines)) == 1


ARM = """
import pytest
from wsgen.testing import Robot, Simulation, assert_reaches, assert_stands

def test_stands(robot: Robot) -> None:
    assert_stands(robot)

def test_holds(robot: Robot, simulation: Simulation) -> None:
    robot.hold({"joint_1": 0.5})
    robot.hold({"joint_2": -0.4}, seconds=3.0)
    assert robot.joint("joint_1").position == pytest.approx(0.5, abs=0.02)
    assert robot.positions["joint_2"] == pytest.approx(-0.4, abs=0.02)
    assert abs(robot.joint("joint_1").velocity) < 0.01
    robot.release()
    assert robot.joint("joint_1").limits.upper > 1.0

def test_drives(robot: Robot) -> None:
    with pytest.raises(Exception, match="cannot be driven: its description has no diff drive"):
        robot.drive(linear=0.5)

@pytest.mark.wsgen(package="rover")
def test_another_package(robot: Robot) -> None:
    assert robot.name == "rover"
    assert "left_wheel_joint" in robot.joints
    lidar, base = robot.link("lidar_link"), robot.link("base_link")
    assert robot.carrier_of("lidar_link") == robot.carrier_of("base_link")
    assert lidar.pose_in_world.xyz[2] > base.pose_in_world.xyz[2]
"""


def test_an_arm_and_another_package(workspace: Path, run_pytest: Pytest) -> None:
    run = run_pytest(write_tests(workspace, "arm", "arm", ARM))
    assert run.returncode == 0, run.stdout


WRONG = """
import pytest

@pytest.mark.wsgen(engin="dart")
def test_marker(robot): ...

@pytest.mark.wsgen(engine="ode")
def test_engine(robot): ...

@pytest.mark.wsgen(package="rovr")
def test_package(robot): ...

@pytest.mark.wsgen(launch_file="gazebo.launch.py")
def test_launch_file(robot): ...

@pytest.mark.wsgen(launch_file="display.launch.py")
def test_spawns_nothing(robot): ...

@pytest.mark.wsgen(arguments={"world": "/no/such.world"})
def test_broken(robot): ...

@pytest.mark.wsgen(robot="r2d2")
def test_robot(robot): ...

@pytest.mark.wsgen(arguments="z:=1.0")
def test_text(robot): ...

@pytest.mark.wsgen(package=["rover"])
def test_list(robot): ...
"""


def test_what_cannot_be_simulated_is_an_error_without_a_traceback(
    workspace: Path, run_pytest: Pytest
) -> None:
    run = run_pytest(write_tests(workspace, "rover", "wrong", WRONG))
    said = run.stdout
    assert "9 errors" in said, said
    for words in (
        "wsgen: The marker wsgen takes no `engin`.\nIt takes package, launch_file, arguments",
        "wsgen: 'ode' is not a physics engine.\nUse bullet, dart, mujoco.",
        "wsgen: Package rovr does not exist.\nDid you mean `rover`?",
        "wsgen: rover does not install a launch file gazebo.launch.py.\nDid you mean",
        "error[SPN003] no-robot: The launch file spawns no robot.",
        "error[WLD001] missing-world: The world file '/no/such.world' does not exist.",
        "wsgen: The launch file spawns no robot `r2d2`.\nRobots: rover.",
        "wsgen: The marker wsgen has arguments='z:=1.0'.\nGive names and values: arguments={",
        "wsgen: The marker wsgen has package=['rover'].\nGive a name: package=",
    ):
        assert words in said, f"{words!r} is not in\n{said}"
    assert "raceback" not in said
    assert "src/wsgen/" not in said


def test_options_that_nothing_could_use_are_refused(run_pytest: Pytest, tmp_path: Path) -> None:
    (tmp_path / "test_nothing.py").write_text("def test_nothing(): ...\n")
    for option, words in (
        ("--wsgen-engine=ode", "ERROR: wsgen: 'ode' is not a physics engine; choose one of bullet"),
        ("--wsgen-argument=x=1", "ERROR: wsgen: 'x=1' is not a launch argument; write NAME:=VALUE"),
    ):
        run = run_pytest(option)
        assert run.returncode == pytest.ExitCode.USAGE_ERROR
        assert words in run.stderr


def test_options_and_settings(workspace: Path, run_pytest: Pytest, tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\nwsgen_package = arm\nwsgen_arguments =\n    x:=1.5\n    y:=0.5\n"
    )
    (tmp_path / "test_options.py").write_text(
        "def test_options(robot):\n"
        "    assert (robot.name, robot.pose_in_world.xyz[:2]) == ('arm', (2.5, 0.5))\n"
        "    assert 0\n"
    )
    place = f"--rootdir={tmp_path}", "-c", tmp_path / "pytest.ini"
    run = run_pytest(
        *place, tmp_path / "test_options.py", "--wsgen-argument", "x:=2.5", "--wsgen-output=shots"
    )
    # This test lies in no workspace.
    assert "wsgen: Package arm does not exist." in run.stdout
    file = workspace / "src" / "rover" / "test" / "test_options.py"
    file.write_text((tmp_path / "test_options.py").read_text())
    run = run_pytest(*place, file, "--wsgen-argument", "x:=2.5", "--wsgen-output=shots")
    assert "E       assert 0" in run.stdout, run.stdout
    assert (tmp_path / "shots" / "arm" / "test_options-test_options.png").is_file(), run.stdout


NAMED = """
import pytest

@pytest.mark.parametrize("value", ["a/b", "a:b", "x" * 300])
def test_named(simulation, value):
    simulation.step(0.01)
    assert FAILS not in {"all", value}
"""


def test_each_test_has_files_of_its_own(
    workspace: Path, run_pytest: Pytest, tmp_path: Path
) -> None:
    folder = workspace / "src" / "rover" / "test"
    for place, fails in (("one", "all"), ("other", "a:b")):
        (folder / place).mkdir()
        text = NAMED.replace("FAILS", repr(fails))
        (folder / place / "test_same.py").write_text(text)
    options = ("--import-mode=importlib", "--wsgen-output=shots", "--rootdir", workspace / "src")
    run = run_pytest(folder / "one", folder / "other", *options)
    assert "4 failed, 2 passed" in run.stdout, run.stdout
    reported = [
        file for file in re.findall("(?m)^picture: (.*)$", run.stdout) if Path(file).is_file()
    ]
    assert len(set(reported)) == 4
    assert {Path(file).parent for file in reported} == {tmp_path / "shots" / "rover"}
    shutil.rmtree(folder / "one")
    shutil.rmtree(folder / "other")


def test_a_test_in_no_package_is_asked_to_name_one(run_pytest: Pytest, tmp_path: Path) -> None:
    (tmp_path / "test_alone.py").write_text("def test_alone(robot): ...\n")
    run = run_pytest("test_alone.py")
    words = (
        "is not in a package: its parent folders do not contain a package.xml.\n"
        "Give the package: pytest --wsgen-"
    )
    assert words in run.stdout
    run = run_pytest("test_alone.py", "--wsgen-package=rover", AMENT_PREFIX_PATH="")
    assert "wsgen: Package rover does not exist.\nGo to the workspace of the package" in run.stdout


UNUSED = """
import pytest

@pytest.mark.wsgen(arguments={"zz": 1.0})
def test_unused(robot):
    assert robot.mass

def test_used(robot): ...
"""


def test_an_argument_without_effect_is_a_warning(workspace: Path, run_pytest: Pytest) -> None:
    run = run_pytest(write_tests(workspace, "rover", "unused", UNUSED))
    assert "2 passed, 1 warning" in run.stdout, run.stdout
    assert "test_unused.py::test_unused" in run.stdout
    assert "The launch argument `zz` has no effect" in run.stdout


DRAWING = """
import pytest
from wsgen.errors import RequestError

def test_draws(simulation, tmp_path):
    simulation.step(0.1)
    simulation.picture(str(tmp_path / "now.png"))
    simulation.record(str(tmp_path / "last.gif"))
    assert sorted(file.name for file in tmp_path.iterdir()) == ["last.gif", "now.png"]

@pytest.mark.parametrize("name, words", [
    ("now.jpg", "Name a .png file"), ("no/now.png", "folder exists"),
])
def test_no_picture(simulation, tmp_path, name, words):
    with pytest.raises(RequestError, match=words):
        simulation.picture(str(tmp_path / name))

@pytest.mark.parametrize("name, words", [
    ("last.png", "neither a .gif nor an .mp4 file"), ("no/last.gif", "no does not exist"),
])
def test_no_video(simulation, tmp_path, name, words):
    with pytest.raises(RequestError, match=words):
        simulation.record(str(tmp_path / name))
"""


def test_pictures_take_names_of_files(workspace: Path, run_pytest: Pytest) -> None:
    run = run_pytest(write_tests(workspace, "rover", "drawing", DRAWING))
    assert "5 passed" in run.stdout, run.stdout
