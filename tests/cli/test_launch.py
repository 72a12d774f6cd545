"""`wsgen launch`: the words of `ros2 launch`, and what is shown."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from PIL import Image

import wsgen.cli
from cli.packages import SHARE
from install_space import HEAD, InstallSpace

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = pytest.mark.slow

TEXT = (
    HEAD
    + """
def generate_launch_description():
    driver = Node(package="rviz2", executable="rviz2", name="view", namespace="/a",
                  parameters=[{"robot_description": open(__file__[:-9] + "urdf").read(), "b": 1}],
                  remappings=[("x", "y")])
    return LaunchDescription([
        DeclareLaunchArgument("height", default_value="0.5", description="how high"),
        SetEnvironmentVariable("MODE", "test"),
        IncludeLaunchDescription([FindPackageShare("gazebo_ros"), "/launch/gazebo.launch.py"],
                                 launch_arguments={"gui": "false"}.items()),
        driver,
        RegisterEventHandler(OnProcessStart(target_action=driver, on_start=[
            ExecuteProcess(cmd=["echo", LaunchConfiguration("height")])])),
        TimerAction(period=3.0, actions=[ExecuteProcess(cmd=[Command(["date"])])]),
    ])
"""
)


@pytest.fixture
def share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The share folder of a sourced package, seen from a folder without workspace."""
    space = InstallSpace(tmp_path / "install")
    folder = space.add(
        "my_robot", {"launch/r.launch.py": TEXT, "launch/r.urdf": "<robot name='r'/>"}
    )
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(space.prefix))
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    return folder


def launch(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = wsgen.cli.run(["launch", *words])
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return code, captured.out, captured.err


def test_the_plan_as_a_tree(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = launch(capsys, "my_robot", "r.launch.py", "height:=2")
    assert code == 0
    lines = out.splitlines()
    assert "  height:=2  (given)  how high" in lines
    assert "  MODE=test" in lines
    assert "  gazebo_ros gazebo.launch.py  (not installed: not evaluated)" in lines
    assert "      gui:=false" in lines
    (node,) = (line for line in lines if line.startswith("├── rviz2 rviz2  /a/view"))
    (started,) = (line for line in lines if "echo 2" in line)
    assert started.startswith("│   └── echo 2  on start of view")
    assert lines.index(node) < lines.index(started)
    assert any("robot_description: 17 characters from" in line for line in lines)
    assert any("x → y" in line for line in lines)
    assert any("after 3.0 s" in line for line in lines)
    _, quiet, _ = launch(capsys, "my_robot", "r.launch.py", "height:=2", "-q")
    branches = str.maketrans("", "", "├─│└ ")
    assert quiet.translate(branches) == out.translate(branches)
    line = TEXT[: TEXT.index('"date"')].count("\n") + 1
    assert lines[-1] == (
        f"  date: commands other than xacro and cat are not executed  r.launch.py:{line}"
    )


def test_the_plan_as_json(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = launch(capsys, "my_robot", "r.launch.py", "--format", "json")
    assert code == 0
    document = json.loads(out)
    assert document["package"] == "my_robot"
    assert [process["starts"] for process in document["processes"]] == [
        "launch",
        "start of view",
        "timer 3.0",
    ]


def test_a_path(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = share / "launch" / "r.launch.py"
    code, out, _ = launch(capsys, str(path), "height:=7", "--format", "json", "-q")
    assert code == 0
    assert json.loads(out)["arguments"][0]["value"] == "7"


def test_a_path_where_nothing_is_sourced(
    share: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    code, out, _ = launch(capsys, str(share / "launch" / "r.launch.py"), "--format", "json")
    assert code == 0
    assert len(json.loads(out)["processes"]) == 3


def test_the_package_of_a_path_is_that_of_the_package_xml_above(
    share: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (share / "package.xml").write_text(
        "<package format='3'><name>my_robot</name><exec_depend>theirs</exec_depend></package>"
    )
    file = share / "launch" / "needs.launch.py"
    file.write_text(TEXT.replace("rviz2", "theirs").replace("r.urdf", "r.urdf"))
    (share / "launch" / "needs.urdf").write_text("<robot/>")
    code, out, _ = launch(capsys, str(file), "--format", "json")
    assert code == 0
    document = json.loads(out)
    assert document["package"] == "my_robot"
    assert "theirs" in {entry["what"] for entry in document["unresolved"]}


def test_the_arguments(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = launch(capsys, "my_robot", "r.launch.py", "--show-args")
    assert code == 0
    assert out.startswith("Arguments (pass arguments as '<name>:=<value>'):\n\n    'height':\n")
    assert "        how high\n        (default: '0.5')\n" in out
    assert "    'pause':" in out  # of what it includes


def test_conditional_arguments_and_none(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = share / "launch" / "c.launch.py"
    head = HEAD + "def generate_launch_description():\n    return LaunchDescription(["
    file.write_text(
        head + "GroupAction([DeclareLaunchArgument('a', choices=['b'])], "
        "condition=IfCondition('true'))])"
    )
    _, out, _ = launch(capsys, str(file), "-s")
    assert "    'a':*\n        One of: ['b']\n" in out
    assert out.endswith("* argument(s) which are only used if specific conditions occur\n")
    file.write_text(head + "])")
    _, out, _ = launch(capsys, str(file), "-s")
    assert out.endswith("\n\n  No arguments.\n")


def test_a_launch_file_with_an_error(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = share / "launch" / "bad.launch.py"
    file.write_text("import os\n1 / 0\n")
    code, out, err = launch(capsys, str(file))
    assert code == 1
    assert "failed" in err
    assert " ok " not in err
    assert "LCH004" in out
    assert "bad.launch.py:2" in out
    assert launch(capsys, str(file), "--show-args")[0] == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("my_robot", "no.launch.py"), "Installed: r.launch.py"),
        (("my_robt", "r.launch.py"), "Did you mean `my_robot`?"),
        (("my_robot",), "wsgen launch my_robot r.launch.py"),
        (("my_robot", "height:=2"), "the launch file of the package my_robot is missing"),
        (("my_robt",), "launch file 'my_robt' does not exist"),
        (("no.launch.py", "a:=b"), "launch file 'no.launch.py' does not exist"),
        (("my_robot", "r.launch.py", "height=2"), "'height=2' does not have the form name:=value"),
        (("my_robot", "r.launch.py", "height:="), "'height:=' does not have the form name:=value"),
        (("full",), "wsgen launch full/launch/a.launch.py"),
        (("empty",), "'empty' is a folder, not a launch file."),
        (("here.py", "my_robot"), "'my_robot' is not a launch argument"),
    ],
)
def test_wrong_words(
    share: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    message: str,
) -> None:
    here = share.parents[2] / "elsewhere"
    (here / "here.py").touch()
    for folder in ("empty", "full/launch"):
        (here / folder).mkdir(parents=True)
    (here / "full" / "launch" / "a.launch.py").touch()
    code, out, err = launch(capsys, *words)
    assert code == 2
    assert not out
    assert message in err


def test_neither_workspace_nor_package(
    share: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    code, _, err = launch(capsys, "my_robot", "r.launch.py")
    assert code == 4
    assert "is not in a colcon workspace" in err


def test_an_argument_that_nobody_uses(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = launch(capsys, "my_robot", "r.launch.py", "heigth:=2")
    assert code == 0
    assert "LCH033" in out
    assert "Did you mean `height`?" in out


def test_a_file_that_is_installed_twice(share: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (share / "r.launch.py").touch()
    code, _, err = launch(capsys, "my_robot", "r.launch.py")
    assert code == 2
    assert "more than once" in err


def test_a_workspace_that_is_not_built(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    package = tmp_path / "src" / "rover"
    (package / "launch").mkdir(parents=True)
    words = ("-w", str(tmp_path), "rover", "r.launch.py")
    code, _, err = launch(capsys, *words)
    assert (code, "Package rover does not exist" in err) == (2, True)
    (package / "package.xml").write_text("<package><name>rover</name></package>")
    (package / "launch" / "r.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "generate_launch_description = lambda: LaunchDescription()\n"
    )
    code, out, _ = launch(capsys, *words)
    assert (code, "Not built: rover." in out) == (0, True)


def test_a_package_that_colcon_ignores(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rover, arm = tmp_path / "src" / "rover", tmp_path / "src" / "unused" / "arm_of_mine"
    for folder in (rover, arm):
        folder.mkdir(parents=True)
        (folder / "package.xml").write_text(
            f"<package><name>{folder.name}</name><export><build_type>ament_cmake</build_type>"
            "</export></package>"
        )
    (rover / "launch").mkdir()
    (rover / "launch" / "r.launch.py").write_text(
        "from ament_index_python.packages import get_package_share_directory\n"
        "from launch import LaunchDescription\n"
        "SHARE = get_package_share_directory('arm_of_mine')\n"
        "generate_launch_description = lambda: LaunchDescription()\n"
    )
    marker = arm.parent / "COLCON_IGNORE"
    marker.touch()
    words = ("-w", str(tmp_path), "rover", "r.launch.py", "--format", "json")
    reported = json.loads(launch(capsys, *words)[1])["diagnostics"]
    wsgen.cli.run(["check", str(tmp_path), "--format", "json"])
    reported += json.loads(capsys.readouterr().out)["diagnostics"]
    found = [one for one in reported if one["code"] == "LCH007"]
    assert len(found) == 2
    for one in found:
        assert one["message"] == (
            f"The package 'arm_of_mine' is not found: colcon ignores the package arm_of_mine in "
            f"{arm}, because {marker} exists."
        )
        assert one["hint"] == f"Remove {marker} to build the package."
    marker.unlink()
    reported = json.loads(launch(capsys, *words)[1])["diagnostics"]
    assert "LCH007" not in [one["code"] for one in reported]


def test_what_is_wrong_is_named_in_the_source(
    built: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(built)
    words = ("gazebo_test", "gazebo_model.launch.py", "hieght:=2", "--format", "json")
    (found,) = json.loads(launch(capsys, *words)[1])["diagnostics"]
    assert found["code"] == "LCH033"
    assert found["file"].startswith(str(built / "src"))


def test_play_is_what_validate_says(
    built: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(built)
    words = ("gazebo_test", "gazebo_model.launch.py", "z:=0.4")
    pictures = str(tmp_path / "pictures")
    code, out, _ = launch(capsys, *words, "--play", "--picture", pictures, "--format", "json")
    (played,) = json.loads(out)["packages"]
    assert (code, played["passed"], played["diagnostics"]) == (0, True, [])
    assert played["robots"][0]["spawn_pose"]["xyz"] == [0.0, 0.0, 0.4]
    assert played["picture"] == str(tmp_path / "pictures" / "gazebo_test.png")
    wsgen.cli.run(["validate", "--format", "json", "--arg", "z:=0.4"])
    (validated,) = json.loads(capsys.readouterr().out)["packages"]
    assert played["robots"] == validated["robots"]


def test_a_robot_description_is_a_step_only_where_one_is_spawned(
    built: Path,
    share: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    step = "expand  robot description"
    _, _, err = launch(capsys, "my_robot", "r.launch.py", "--play")
    assert "r.launch.py" in err
    assert step not in err
    monkeypatch.chdir(built)
    _, _, err = launch(capsys, "gazebo_test", "gazebo_model.launch.py", "--play")
    assert step in err


def test_play_records_a_video(
    built: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(built)
    words = ("gazebo_test", "gazebo_model.launch.py", "--play", "--seconds", "0.5")
    file = tmp_path / "video.gif"
    code, out, err = launch(capsys, *words, "--record", str(file), "--format", "json")
    steps = [line.split()[2:4] for line in err.splitlines() if line.startswith("  ok")]
    assert steps[-2:] == [["simulate", "simple_robot"], ["draw", "video.gif"]]
    assert (code, json.loads(out)["packages"][0]["video"]) == (0, str(file))
    with Image.open(file) as video:
        assert (video.n_frames, video.info["duration"]) == (11, 50)  # every 50 ms, both ends


@pytest.mark.parametrize(
    ("file", "message"),
    [("video.png", "neither"), ("nowhere/video.gif", "does not exist"), (".", "neither")],
)
def test_an_impossible_video_is_refused_before_the_simulation(
    built: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    file: str,
    message: str,
) -> None:
    monkeypatch.chdir(built)
    words = ("gazebo_test", "gazebo_model.launch.py", "--play", "--record", file)
    code, out, err = launch(capsys, *words)
    assert (code, out) == (2, "")
    assert message in err


def test_a_video_without_its_encoder_and_a_simulation_without_its_engine(
    built: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(built)
    monkeypatch.setattr("wsgen.rendering.drawing.find_spec", lambda _: None)
    monkeypatch.setattr("wsgen.simulation.run.find_spec", lambda _: None)
    words = ("gazebo_test", "gazebo_model.launch.py", "--play")
    code, _, err = launch(capsys, *words, "--engine", "bullet", "--record", "video.mp4")
    assert (code, "No physics engine is installed" in err) == (4, True)
    monkeypatch.setattr("wsgen.simulation.run.find_spec", lambda _: True)
    code, _, err = launch(capsys, *words, "--record", "video.mp4")
    assert (code, "pip install 'wsgen[video]'" in err) == (4, True)
    monkeypatch.setattr("wsgen.simulation.run.find_spec", lambda _: None)
    code, _, err = launch(capsys, *words, "--engine", "dart")
    assert (code, "pip install 'wsgen[dart]'" in err) == (4, True)


@pytest.mark.parametrize(
    ("installed", "engine", "message", "hint"),
    [
        ("pybullet", "dart", "DART is not installed", "pip install 'wsgen[dart]'"),
        ("pybullet", "mujoco", "MuJoCo is not installed", "pip install 'wsgen[mujoco]'"),
        ("mujoco", "bullet", "PyBullet is not installed", "otherwise use --engine mujoco"),
        ("pybullet", "all", "MuJoCo and DART are not installed", "'wsgen[mujoco,dart]'"),
        ("", "all", "No physics engine is installed", "'wsgen[mujoco,dart]'"),
    ],
)
def test_an_engine_that_is_not_installed(  # noqa: PLR0917  the facts of a case
    built: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    installed: str,
    engine: str,
    message: str,
    hint: str,
) -> None:
    monkeypatch.chdir(built)
    monkeypatch.setattr(
        "wsgen.simulation.run.find_spec", lambda name: True if name == installed else None
    )
    words = ("gazebo_test", "gazebo_model.launch.py", "--play", "--engine", engine)
    code, out, err = launch(capsys, *words)
    assert (code, out) == (4, "")
    assert message in err
    assert hint in err


def test_the_former_name_of_all_engines(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = launch(capsys, "my_robot", "r.launch.py", "--play", "--engine", "both")
    assert (code, out) == (2, "")
    assert "Did you mean `all`?" in err


def test_play_a_launch_file_of_no_package(
    built: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(built)
    file = tmp_path / "alone.launch.py"
    file.write_text((built / SHARE / "launch" / "gazebo_model.launch.py").read_text())
    code, out, _ = launch(capsys, str(file), "--play", "z:=-3")
    assert code == 1
    assert out.startswith(f"{file}: failed\n")
    assert "SPN055" in out


@pytest.mark.parametrize(
    "option", ["--record=x.gif", "--picture=p", "--engine=dart", "--seconds=3"]
)
def test_without_play_nothing_is_simulated(
    share: Path, capsys: pytest.CaptureFixture[str], option: str
) -> None:
    code, out, err = launch(capsys, "my_robot", "r.launch.py", option)
    assert (code, out) == (2, "")
    assert "--play" in err


@pytest.mark.parametrize(
    ("option", "name"),
    [("--host=0.0.0.0", "--host"), ("--port=8080", "--port"), ("--no-browser", "--no-browser")],
)
@pytest.mark.parametrize("play", [(), ("--play",)])
def test_without_view_nothing_is_served(
    share: Path, capsys: pytest.CaptureFixture[str], option: str, name: str, play: tuple[str, ...]
) -> None:
    code, out, err = launch(capsys, "my_robot", "r.launch.py", option, *play)
    assert (code, out) == (2, "")
    assert err == (
        f"error: Without --view no page is served, and {name} has no effect.\n"
        f"  try: Add --view, or remove {name}.\n"
    )


def test_a_page_about_a_launch_file_with_its_video(
    built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(built)
    page = tmp_path / "page.html"
    words = ("gazebo_test", "gazebo_model.launch.py", "--seconds", "0.2", "--html", str(page))
    code, _, err = launch(capsys, *words)
    assert (code, "Without --play nothing is simulated." in err) == (2, True)
    code, _, err = launch(capsys, *words, "--play", "--record", str(tmp_path / "v.gif"))
    assert code == 0, err
    text = page.read_text()
    assert text.count("data:image/gif;base64,") == 1
    assert text.count("data:image/webp;base64,") == 1
    assert not list(tmp_path.glob("*.png"))
    monkeypatch.setattr("wsgen.reporting.page_data.find_spec", lambda _: None)
    code, _, err = launch(capsys, *words, "--play")
    assert (code, "pip install 'wsgen[report]'" in err) == (4, True)
