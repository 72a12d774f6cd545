"""Somebody follows the tutorial by hand, then uses wsgen on the result."""

import json
import subprocess
from pathlib import Path

import pytest

from forks import run_wsgen
from tutorial import TEXT, write_tutorial

SHARE = "install/gazebo_test/share/gazebo_test"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not TEXT.exists(), reason="the tutorial's text is not here"),
]


def wsgen(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return run_wsgen(arguments, cwd=folder)


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    workspace = write_tutorial(tmp_path_factory.mktemp("tutorial"))
    build = wsgen(workspace, "build")
    assert build.returncode == 0, build.stderr
    assert "BUILD_TESTING" in build.stdout
    return workspace


def test_the_typed_robot_passes_with_its_faults_named(workspace: Path) -> None:
    run = wsgen(workspace, "validate", "--format", "json")
    assert run.returncode == 0, run.stdout + run.stderr
    (package,) = json.loads(run.stdout)["packages"]
    assert package["passed"]
    assert package["world"]["name"] == "Empty world"
    (robot,) = package["robots"]
    assert robot["entity"] == "simple_robot"
    assert (robot["links"], robot["joints"], robot["movable_joints"]) == (2, 1, 0)
    assert robot["simulated"] == {
        "engine": "bullet",
        "links": 1,
        "movable_joints": 0,
        "mass": 1.0,
    }
    # Half inside the ground it is pushed out, and stands.
    assert robot["spawn_pose"]["xyz"] == [0.0, 0.0, 0.0]
    assert robot["rest"]["xyz"][2] == pytest.approx(0.25, abs=0.002)
    assert robot["rest"]["rpy"][:2] == pytest.approx([0.0, 0.0], abs=0.01)
    said = {
        severity: "\n".join(
            found["message"] for found in package["diagnostics"] if found["severity"] == severity
        )
        for severity in ("warning", "info")
    }
    assert "inertia" in said["warning"]
    assert "libgazebo_ros_control.so" in said["warning"]
    assert "0.250 m deep" in said["warning"]
    assert "dummy" in said["info"]
    assert not [found for found in package["diagnostics"] if found["severity"] == "error"]


def test_a_person_reads_the_same(workspace: Path) -> None:
    run = wsgen(workspace, "validate")
    assert run.returncode == 0
    for words in ("gazebo_test: passed", "simple_robot", "1.000 ", "warning["):
        assert words in run.stdout


def test_a_colon_in_a_comment_does_no_harm(workspace: Path) -> None:
    """The tutorial passes a Python string, which launch_ros does not read as YAML."""
    model = workspace / "install/gazebo_test/share/gazebo_test/model/robot.xacro"
    text = model.read_text()
    model.unlink()  # not through a link into the source
    model.write_text(text.replace("</robot>", "<!-- height: half a meter # -->\n</robot>"))
    run = wsgen(workspace, "launch", "gazebo_test", "gazebo_model.launch.py", "--format", "json")
    model.write_text(text)
    assert run.returncode == 0, run.stderr
    codes = {found["code"] for found in json.loads(run.stdout)["diagnostics"]}
    assert not codes & {"LCH015", "LCH016"}
    readme = Path(__file__).parents[1] / "templates" / "simple" / "README.md.j2"
    assert "colon" not in readme.read_text()


LAUNCH = "launch/gazebo_model.launch.py"
WORLD = "model/empty_world.world"
# What somebody mistypes or leaves out -> the one error, the line in which it is, what was meant.
MISTAKES = {
    "no import of Node": (
        (LAUNCH, "from launch_ros.actions import Node\n", ""),
        ("LCH030", "spawnModelNode = Node(", "from launch_ros.actions import Node"),
    ),
    "no return": (
        (LAUNCH, "    return launchDescriptionObject\n", ""),
        ("LCH010", "def generate_launch_description", "return launchDescriptionObject"),
    ),
    "no items()": ((LAUNCH, ".items()", ""), ("LCH010", "gazeboLaunch=", ".items()")),
    "package": (
        (LAUNCH, "'gazebo_test'", "'gazebo_tset'"),
        ("LCH007", "gazebo_tset", "`gazebo_test`"),
    ),
    "world file": (
        (LAUNCH, "empty_world.world", "emtpy_world.world"),
        ("WLD001", "emtpy_world", "`empty_world.world`"),
    ),
    "world model": (
        (WORLD, "model://ground_plane", "model://groundplane"),
        ("WLD004", None, "model://ground_plane"),
    ),
    "executable": (
        (LAUNCH, "executable='robot_state_publisher'", "executable='robot_state_publiser'"),
        ("LCH021", "robot_state_publiser'", "`robot_state_publisher`"),
    ),
    "function": (
        (LAUNCH, "generate_launch_description", "generate_launch_desciption"),
        ("LCH003", "generate_launch_desciption", "`generate_launch_description`"),
    ),
    "keyword": (
        (LAUNCH, "executable='spawn_entity.py'", "excutable='spawn_entity.py'"),
        ("LCH031", "excutable", "`executable`"),
    ),
    "spawner not added": (
        (LAUNCH, "    launchDescriptionObject.add_action(spawnModelNode)\n", ""),
        ("SPN003", "spawnModelNode = Node(", "add_action(spawnModelNode)"),
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_one_mistake_is_one_error_at_its_line(workspace: Path, mistake: str) -> None:
    (name, right, wrong), (code, written, meant) = MISTAKES[mistake]
    places = [workspace / folder / name for folder in ("src/gazebo_test", SHARE)]
    text = places[0].read_text()
    assert right in text
    for place in places:
        place.write_text(text.replace(right, wrong, 1))
    try:
        run = wsgen(workspace, "validate", "--format", "json")
    finally:
        for place in places:
            place.write_text(text)
    assert run.returncode == 1
    assert [line[:6] for line in run.stderr.splitlines()].count(
        "failed"
    ) == 1  # the step that failed
    (package,) = json.loads(run.stdout)["packages"]
    (error,) = [found for found in package["diagnostics"] if found["severity"] == "error"]
    assert error["code"] == code
    assert meant in f"{error['message']} {error['hint']}"
    assert error["file"] == str(places[0])
    if written is not None:
        assert written in text.replace(right, wrong, 1).splitlines()[error["line"] - 1]
