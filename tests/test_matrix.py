"""Every template for its targets: all of them in one workspace, built by colcon, and tried.

The example of a template of the user is among them. tests/templating/test_golden.py shows how
little the files of one template differ between targets: the template that writes the most kinds of
files is here for every target, others for the targets at the borders.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from typing import TYPE_CHECKING, Any

import pytest
import yaml

from building.building import outside, plain_colcon
from golden_support import CASES, EXAMPLES, LAUNCH_FILE, arguments, generate
from wsgen.cli import run
from wsgen.model.target import TARGETS
from wsgen.templating.template import template_names

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.target import Target


pytestmark = pytest.mark.slow

PENDULUM = str(EXAMPLES / "templates" / "pendulum")
FOR_EVERY_TARGET = "wanderer"
# The oldest distribution with the older simulator, the last one with SDF 1.11, and the default.
BORDERS = {"humble-classic", "jazzy-gz", "lyrical-gz"}
ALL = {
    case: (template, target)
    for case, (template, target) in {
        **CASES,
        **{f"pendulum-{target.name}": (PENDULUM, target) for target in TARGETS},
    }.items()
    if template == FOR_EVERY_TARGET or target.name in BORDERS
}
# Case -> the name of its package in the workspace.
PACKAGES = {case: case.replace("-", "_") for case in ALL}
# Case -> the name of its robot in the simulator, where it is not that of the package: the first of
# the workspace has the tutorial's.
ENTITIES = {next(case for case in ALL if ALL[case][0] == "simple"): "simple_robot"}
# Template -> what its robot does beyond standing.
BEHAVIORS = {
    "arm": ["holds its pose", "reaches another pose"],
    "diff_drive": ["drives straight", "turns in place"],
    "wanderer": ["drives straight", "turns in place"],
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All packages, built with plain colcon."""
    folder = tmp_path_factory.mktemp("matrix")
    for case, package in PACKAGES.items():
        root = generate(folder, *arguments(*ALL[case]), package=package)
    plain_colcon(root, outside())
    return root


@pytest.fixture(scope="module")
def validated(workspace: Path) -> dict[str, Any]:
    """Package -> what `wsgen validate` says of it."""
    report = workspace.parent / "report.json"
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(workspace)
        assert run(["validate", "-q", "-j", "2", "--json", str(report)]) == 0
    packages = json.loads(report.read_text())["packages"]
    return {package["package"]: package for package in packages}


def test_each_border_is_a_target_and_each_template_is_here() -> None:
    assert {target.name for target in TARGETS} >= BORDERS
    assert {template for template, _ in ALL.values()} == {*template_names(), PENDULUM}
    assert {target for template, target in ALL.values() if template == FOR_EVERY_TARGET} == {
        *TARGETS
    }


@pytest.mark.parametrize("case", ALL)
def test_the_robot_stands_and_there_is_nothing_to_find(
    validated: dict[str, Any], case: str
) -> None:
    package = validated[PACKAGES[case]]
    assert package["passed"]
    assert package["diagnostics"] == []
    assert package["world"]["name"] == world_of(ALL[case][0])
    assert package["world"]["models"][0] == "ground_plane"
    assert len(package["world"]["models"]) == (10 if ALL[case][0] == "wanderer" else 1)
    (robot,) = package["robots"]
    assert robot["entity"] == ENTITIES.get(case, PACKAGES[case])
    assert robot["rest"]["settled_after"] is not None
    simulated = [behavior["name"] for behavior in robot["behaviors"] if behavior["passed"]]
    assert simulated == BEHAVIORS.get(ALL[case][0], [])


def test_no_two_packages_call_their_robots_the_same(validated: dict[str, Any]) -> None:
    entities = [robot["entity"] for one in validated.values() for robot in one["robots"]]
    assert len(entities) == len(ALL)
    assert len(set(entities)) == len(entities)


@pytest.mark.parametrize("case", ALL)
def test_launch_plan(case: str, workspace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    template, target = ALL[case]
    plan = launch(capsys, workspace, PACKAGES[case])
    assert plan["unresolved"] == []
    assert plan["diagnostics"] == []
    share = workspace / "install" / PACKAGES[case] / "share" / PACKAGES[case]
    (include,) = plan["includes"]
    names = [argument["name"] for argument in plan["arguments"]]
    assert programs(plan) == expected_programs(PACKAGES[case], template, target)
    publisher, spawner = plan["processes"][target.simulator == "gz" :][:2]
    if target.simulator == "classic":
        assert names == ["world", "x", "y", "z", "gui", "use_sim_time"]
        assert include["package"] == "gazebo_ros"
        assert include["arguments"] == {
            "world": f"{share}/model/{world_of(template)}.world",
            "gui": "true",
        }
    else:
        assert names == ["world", "x", "y", "z", "headless", "use_sim_time"]
        assert include["package"] == "ros_gz_sim"
        assert include["arguments"] == {
            "gz_args": f'-r -v 4 "{share}/model/{world_of(template)}.world"',
            "on_exit_shutdown": "true",
        }
        assert plan["processes"][0]["parameters"] == {"config_file": f"{share}/config/bridge.yaml"}
    assert publisher["parameters"]["use_sim_time"] is True
    assert "<robot" in publisher["parameters"]["robot_description"]
    flag = "-entity" if target.simulator == "classic" else "-name"
    assert spawner["arguments"][:6] == [
        *("-topic", "robot_description"),
        *(flag, ENTITIES.get(case, PACKAGES[case])),
        *("-x", "0.0"),
    ]
    assert spawner["arguments"][6:9:2] == ["-y", "-z"]


def expected_programs(package: str, template: str, target: Target) -> list[str]:
    publisher = "robot_state_publisher/robot_state_publisher"
    more = {
        "arm": ["controller_manager/spawner"] * 2,
        "wanderer": [f"{package}/wanderer.py"],
    }.get(template, [])
    if target.simulator == "classic":
        return [publisher, "gazebo_ros/spawn_entity.py", *more]
    return ["ros_gz_bridge/parameter_bridge", publisher, "ros_gz_sim/create", *more]


def world_of(template: str) -> str:
    """The name of the world that a package of a template starts."""
    return "boxes" if template == "wanderer" else "empty_world"


@pytest.mark.parametrize("case", [case for case in ALL if case.startswith("arm-")])
def test_controllers_start_one_after_the_other(
    case: str, workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    *_, robot, broadcaster, controller = launch(capsys, workspace, PACKAGES[case])["processes"]
    assert broadcaster["arguments"] == ["joint_state_broadcaster"]
    assert broadcaster["starts"] == f"exit of {robot['executable']}"
    assert controller["arguments"] == ["joint_trajectory_controller"]
    assert controller["starts"] == "exit of spawner"


@pytest.mark.parametrize(
    "case", [case for case in ALL if case.startswith(("arm-", "diff_drive-", "wanderer-"))]
)
def test_display(case: str, workspace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = launch(capsys, workspace, PACKAGES[case], file="display.launch.py")
    assert plan["arguments"] == plan["includes"] == []
    assert plan["unresolved"] == plan["diagnostics"] == []
    assert programs(plan) == [
        "robot_state_publisher/robot_state_publisher",
        "joint_state_publisher_gui/joint_state_publisher_gui",
        "rviz2/rviz2",
    ]
    publisher, _, rviz = plan["processes"]
    assert "<robot" in publisher["parameters"]["robot_description"]
    share = workspace / "install" / PACKAGES[case] / "share" / PACKAGES[case]
    assert rviz["arguments"] == ["-d", f"{share}/config/robot.rviz"]
    assert yaml.safe_load((share / "config" / "robot.rviz").read_text())["Visualization Manager"]


@pytest.mark.parametrize("case", [case for case in ALL if case.startswith("arm-")])
def test_controllers_control_the_joints_of_the_robot(case: str, workspace: Path) -> None:
    share = workspace / "install" / PACKAGES[case] / "share" / PACKAGES[case]
    controllers = yaml.safe_load((share / "config" / "controllers.yaml").read_text())
    manager = controllers["controller_manager"]["ros__parameters"]
    assert {name for name in manager if name.startswith("joint_")} == {
        "joint_state_broadcaster",
        "joint_trajectory_controller",
    }
    joints = controllers["joint_trajectory_controller"]["ros__parameters"]["joints"]
    assert joints == [f"joint_{number}" for number in range(1, 7)]
    control = (share / "model" / "robot.xacro").read_text().partition("<ros2_control")[2]
    assert re.findall(r'<joint name="(\w+)">', control) == joints


def test_headless(workspace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = launch(capsys, workspace, "simple_jazzy_gz", "headless:=true", "x:=2.5")
    (include,) = plan["includes"]
    assert include["arguments"]["gz_args"].startswith('-r -s -v 4 "/')
    assert plan["processes"][-1]["arguments"][4:6] == ["-x", "2.5"]


def test_sourcing_the_workspace_tells_gazebo_where_models_are(workspace: Path) -> None:
    """Both kinds of hooks: plain sh reads the one, what colcon writes for bash the other."""
    for shell, setup in (("sh", "setup.sh"), ("bash", "setup.bash")):
        script = f". install/{setup} && echo $GZ_SIM_RESOURCE_PATH"
        environment = {**outside(), "COLCON_CURRENT_PREFIX": str(workspace / "install")}
        reported = subprocess.run(
            [shell, "-c", script],
            cwd=workspace,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        folders = reported.stdout.strip().split(os.pathsep)
        assert sorted(folders) == [
            f"{workspace}/install/{package}/share"
            for case, package in sorted(PACKAGES.items())
            if ALL[case][1].simulator == "gz"
        ]


def launch(
    capsys: pytest.CaptureFixture[str],
    workspace: Path,
    package: str,
    *words: str,
    file: str = LAUNCH_FILE,
) -> dict[str, Any]:
    """The plan of a launch file of a package."""
    capsys.readouterr()
    command = ["launch", package, file, *words, "-w", str(workspace), "--format", "json"]
    assert run(command) == 0
    plan: dict[str, Any] = json.loads(capsys.readouterr().out)
    return plan


def programs(plan: dict[str, Any]) -> list[str]:
    """Package and executable of each process, in their order."""
    return [f"{process['package']}/{process['executable']}" for process in plan["processes"]]
