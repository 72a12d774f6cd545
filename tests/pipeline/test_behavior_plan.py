"""Behaviors for which the launch file runs: who runs it, and what comes of it."""

from __future__ import annotations

import shutil
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from golden_support import golden_package
from wsgen.checks.rules.behaviors import behavior_explodes
from wsgen.errors import NotFoundError
from wsgen.model.behavior import LiveMeasurement
from wsgen.model.transform import Pose
from wsgen.model.world import Spawn
from wsgen.packages.workspace.layout import open_workspace
from wsgen.pipeline.behavior_plan import BehaviorPlan
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import validate
from wsgen.reporting.words import result_of, what_it_did

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorRun
    from wsgen.model.outcome import PackageOutcome
    from wsgen.pipeline.requests import SelectedLaunchFile

pytestmark = pytest.mark.slow

BEHAVIORS = """
[[behavior]]
name = "wanders"
run = true
seconds = 5.0
travels = 1.0

[[behavior]]
name = "lies"
run = true
seconds = 2.0
"""


class Runs:
    """Stands for what runs a launch file."""

    def __init__(self, error: NotFoundError | None = None, *spawned: Spawn) -> None:
        self.error = error
        self.spawned = spawned
        self.waits_for: list[str] = []
        self.engines: list[str] = []
        self.launch_files: list[str] = []

    def __call__(
        self,
        selected: SelectedLaunchFile,
        request: ValidateRequest,
        behavior_runs: Sequence[BehaviorRun],
    ) -> Mapping[str, LiveMeasurement]:
        self.engines += request.engines
        self.launch_files.append(selected.file.name)
        self.waits_for += [one.entity for one in behavior_runs]
        if self.error is not None:
            raise self.error
        if selected.file.name == "world.launch.py" and not self.spawned:
            problem = "No robot was spawned within 30 s."
            names = (one.behavior.name for one in behavior_runs)
            return {name: LiveMeasurement(name=name, problem=problem) for name in names}
        tilts = {"wanders": 0.0, "lies": 1.5}
        return {
            one.behavior.name: LiveMeasurement(
                name=one.behavior.name,
                spawned=self.spawned,
                seconds=one.behavior.seconds,
                is_there=True,
                traveled=2.0,
                tilt=tilts[one.behavior.name],
            )
            for one in behavior_runs
        }


def outcome_of(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    runs: Runs | None,
    *engines: str,
    name: str = "simple-jazzy-gz",
) -> PackageOutcome:
    source = golden_package(name)
    package = tmp_path / "src" / source.name
    package.parent.mkdir()
    shutil.copytree(source, package)
    with (package / "wsgen.toml").open("a", encoding="utf-8") as stream:
        stream.write(BEHAVIORS)
    monkeypatch.chdir(tmp_path)
    request = ValidateRequest(packages=[source.name], engines=engines or ("bullet",), run_live=runs)
    outcome = validate(open_workspace(str(tmp_path)), request, environment={})
    (one,) = outcome.packages
    return one


def test_what_was_measured_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = Runs()
    package = outcome_of(tmp_path, monkeypatch, runs)
    assert (runs.engines, runs.launch_files) == (["bullet"], ["gazebo_model.launch.py"])
    (robot,) = package.robots
    wanders, lies = robot.behaviors[-2:]
    assert (wanders.passed, wanders.traveled, lies.passed) == (True, 2.0, False)
    assert "SPN100" in [one.code for one in package.diagnostics]
    assert not robot.passed
    assert not package.passed


def test_a_machine_without_ros_leaves_it_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = Runs(NotFoundError("No ROS is there.", hint="Install it."))
    package = outcome_of(tmp_path, monkeypatch, runs)
    found = [one for one in package.diagnostics if one.code == "SPN102"]
    assert [one.severity.value for one in found] == ["warning", "warning"]
    assert found[0].hint == "Install it."
    assert package.passed
    assert [one.is_left_out for one in package.robots[0].behaviors[-2:]] == [True, True]


def test_nodes_of_a_package_that_is_not_built_are_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = Runs()
    package = outcome_of(tmp_path, monkeypatch, runs, name="wanderer-jazzy-gz")
    assert runs.engines == []
    found = [one for one in package.diagnostics if one.code == "SPN102"]
    assert [one.severity.value for one in found] == ["warning"] * len(found)
    assert "cannot be started: it is not built" in found[0].message
    assert found[0].hint == "Run `wsgen build`; then wsgen runs the launch file."
    assert package.passed


def test_a_command_that_runs_no_nodes_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = outcome_of(tmp_path, monkeypatch, None)
    found = [one for one in package.diagnostics if one.code == "SPN102"]
    assert [one.severity.value for one in found] == ["info", "info"]
    assert package.passed


@pytest.mark.parametrize(
    ("mistake", "code", "lines"),
    [
        ("run = true\njoints = { left_whel = 0.5 }", "SPN083", ["not simulated"]),
        ("joints = { left_whel = 0.5 }", "SPN083", ["not simulated"]),
        ("drive = { linear = 0.5 }\nmoved = { x = 0.5 }", "SPN081", ["not simulated"]),
        ('run = true\nrobot = "romer"', "SPN080", []),
        ("run = true\ntravel = 1.0", "PKG060", []),
        ("run = true\ntravels = true", "PKG060", []),
    ],
)
def test_a_mistake_in_a_behavior_leaves_the_robot_standing(
    mistake: str, code: str, lines: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    behavior = f'\n[[behavior]]\nname = "a"\nseconds = 1.0\n{mistake}\n'
    monkeypatch.setattr(f"{__name__}.BEHAVIORS", behavior)
    package = outcome_of(tmp_path, monkeypatch, Runs())
    assert [one.code for one in package.diagnostics if one.severity.value == "error"] == [code]
    assert not package.passed
    (robot,) = package.robots
    (engine,) = robot.engines
    assert result_of(engine).startswith("stands after ")
    mistaken = [one for one in robot.behaviors if one.name == "a"]
    assert [what_it_did(one) for one in mistaken] == lines
    assert not any(one.passed or one.is_left_out for one in mistaken)
    assert robot.passed == (not lines)  # with the behaviors that are named as its own


def test_a_robot_that_does_not_do_what_it_must_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mistake = '\n[[behavior]]\nname = "a"\nseconds = 1.0\njoints = { left_whel = 0.5 }\n'
    monkeypatch.setattr(f"{__name__}.BEHAVIORS", mistake)
    monkeypatch.setattr(BehaviorPlan, "check", explodes)
    package = outcome_of(tmp_path, monkeypatch, Runs())
    assert result_of(package.robots[0].engines[0]) == "fails"


def explodes(plan: BehaviorPlan, *_: object) -> tuple[Diagnostic, ...]:
    return tuple(behavior_explodes(plan.behaviors[0], plan.file))


# A launch file that starts Gazebo alone: a node spawns the robot.
MANIFEST = """<package format="3"><name>late</name><version>0.0.1</version>
<description>Of a test.</description><maintainer email="ada@example.org">Ada</maintainer>
<license>Apache-2.0</license><export><build_type>ament_cmake</build_type></export></package>
"""
LAUNCH = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

def generate_launch_description():
    gz_sim = PathJoinSubstitution([FindPackageShare('ros_gz_sim'), 'launch', 'gz_sim.launch.py'])
    return LaunchDescription([
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(gz_sim),
            launch_arguments={'gz_args': '-r empty.sdf'}.items()),
        ExecuteProcess(cmd=['mission']),
    ])
"""
ROBOT = """<robot name="r"><link name="base"><inertial><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>
"""


def outcome_of_late(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, runs: Runs | None, *engines: str
) -> tuple[PackageOutcome, ...]:
    package = tmp_path / "src" / "late"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text(MANIFEST)
    (package / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.20)\nproject(late)\nfind_package(ament_cmake REQUIRED)\n"
        "install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})\nament_package()\n"
    )
    (package / "launch" / "world.launch.py").write_text(LAUNCH)
    (package / "wsgen.toml").write_text(BEHAVIORS)
    monkeypatch.chdir(tmp_path)
    request = ValidateRequest(engines=engines or ("bullet",), run_live=runs)
    return validate(open_workspace(str(tmp_path)), request, environment={}).packages


def test_a_robot_that_a_node_spawns_is_validated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = Runs(None, Spawn(entity="late", description=ROBOT, pose_in_world=Pose((1.0, 0.0, 0.2))))
    (package,) = outcome_of_late(tmp_path, monkeypatch, runs)
    assert (runs.engines, runs.waits_for) == (["bullet"], ["", ""])  # once
    (robot,) = package.robots
    assert (robot.entity, robot.spawn_pose.xyz) == ("late", (1.0, 0.0, 0.2))
    assert robot.rest is not None
    assert [one.passed for one in robot.behaviors] == [True, False]
    codes = {one.code: one.severity.value for one in package.diagnostics}
    assert codes["SPN100"] == "error"
    assert codes["SPN003"] == "info"


def test_where_no_robot_comes_each_behavior_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (package,) = outcome_of_late(tmp_path, monkeypatch, Runs())
    errors = [one for one in package.diagnostics if one.severity.value == "error"]
    assert [one.code for one in errors] == ["SPN099", "SPN099"]
    assert "no robot was spawned within 30 s" in errors[0].message
    assert not package.passed


@pytest.mark.parametrize("failing", [("mujoco",), ("bullet", "mujoco")])
def test_where_no_robot_comes_the_runs_of_all_engines_are_checked(
    failing: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class RunsOfEngines(Runs):
        def __call__(
            self,
            selected: SelectedLaunchFile,
            request: ValidateRequest,
            behavior_runs: Sequence[BehaviorRun],
        ) -> Mapping[str, LiveMeasurement]:
            found = super().__call__(selected, request, behavior_runs)
            if request.engines[0] in failing:
                return found
            return {
                name: replace(one, problem=None, is_there=True, traveled=2.0)
                for name, one in found.items()
            }

    runs = RunsOfEngines()
    (package,) = outcome_of_late(tmp_path, monkeypatch, runs, "bullet", "mujoco")
    assert runs.engines == ["bullet", "mujoco"]
    fails = [one for one in package.diagnostics if one.code == "SPN099"]
    assert [one.element for one in fails] == ["behavior `wanders`", "behavior `lies`"]
    named = {one.message.partition(":")[0] for one in fails if one.message.startswith("In ")}
    assert named == ({"In MuJoCo"} if failing == ("mujoco",) else set())
    assert not package.passed


def test_without_ros_a_package_whose_nodes_spawn_has_no_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{__name__}.MANIFEST", MANIFEST.replace("ada@example.org", "ada@here"))
    (package,) = outcome_of_late(tmp_path, monkeypatch, Runs(NotFoundError("No ROS.", hint="-")))
    codes = {one.code: one.severity.value for one in package.diagnostics}
    assert codes["SPN102"] == "warning"
    assert codes["PKG005"] == "error"  # of wsgen check, too
    assert not package.passed


def test_a_command_that_runs_no_nodes_does_not_choose_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert outcome_of_late(tmp_path, monkeypatch, None) == ()


@pytest.mark.parametrize(
    ("behavior", "is_clear"),
    [("run = true", True), ("drive = { linear = 0.5 }\nmoved = { x = 1.0 }", False)],
)
def test_a_node_may_spawn_a_robot_under_the_name_that_its_behavior_has(
    behavior: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, is_clear: bool
) -> None:
    """The launch file publishes the description of the robot `r`, and a program spawns it."""
    published = f"""
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{{'robot_description': {ROBOT!r}}}]),
    ])"""
    monkeypatch.setattr(f"{__name__}.LAUNCH", LAUNCH.replace("\n    ])", published))
    text = f'[[behavior]]\nname = "wanders"\nrobot = "truck"\n{behavior}\nseconds = 5.0\n'
    monkeypatch.setattr(f"{__name__}.BEHAVIORS", text)
    runs = Runs(None, Spawn(entity="truck", description=ROBOT))
    (package,) = outcome_of_late(tmp_path, monkeypatch, runs)
    assert [one.entity for one in package.robots] == ["r"]
    codes = [one.code for one in package.diagnostics]
    assert ("SPN080" not in codes) == is_clear
    assert runs.waits_for == (["r"] if is_clear else [])
    assert [one.passed for one in package.robots[0].behaviors] == ([True] if is_clear else [])
