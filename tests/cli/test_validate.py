"""`wsgen validate` on a package that `wsgen new` wrote, and on what beginners make of it."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from cli.packages import PACKAGE, SHARE, errors, validate, wsgen
from wsgen.cli import run
from wsgen.errors import NotFoundError

pytestmark = pytest.mark.slow


@pytest.fixture
def workspace(built: Path, tmp_path: Path) -> Path:
    """A copy of it that a test may spoil, without the build folder, which is tied to its place."""
    without = shutil.ignore_patterns("build")
    return Path(shutil.copytree(built, tmp_path / "ws_gazebo", symlinks=True, ignore=without))


def test_the_generated_robot_stands(built: Path, tmp_path: Path) -> None:
    code, document, _ = validate(built, "--picture", str(tmp_path / "pictures"))
    assert code == 0
    assert document["passed"]
    (package,) = document["packages"]
    assert package["diagnostics"] == []
    assert package["launch_file"].endswith(
        "install/gazebo_test/share/gazebo_test/launch/gazebo_model.launch.py"
    )
    assert package["world"]["file"].endswith("empty_world.world")
    assert package["world"]["gravity"] == [0.0, 0.0, -9.8]
    (robot,) = package["robots"]
    assert robot["mass"] == 1.0
    assert robot["simulated"] == {
        "engine": "bullet",
        "links": 1,
        "movable_joints": 0,
        "mass": 1.0,
    }
    assert robot["spawn_pose"]["xyz"][2] > 0.25
    assert robot["rest"]["xyz"] == pytest.approx([0.0, 0.0, 0.25], abs=0.002)
    assert robot["rest"]["rpy"] == pytest.approx([0.0, 0.0, 0.0], abs=0.01)
    assert robot["rest"]["settled_after"] < 2.0
    assert robot["rest"]["speed"] < 0.01
    seconds = package["seconds"]
    assert set(seconds) == {"launch", "expand", "load", "simulate", "total"}
    assert all(value > 0 for value in seconds.values())
    assert sum(seconds.values()) <= 2 * seconds["total"]


def test_any_text_in_the_options_gives_a_package_that_builds_and_stands(tmp_path: Path) -> None:
    made = wsgen(
        tmp_path,
        "new",
        "some_robot",
        "--description",
        "a < b & \"c\" 'd' \u00e9\U0001f600 ${x} {{x}} @x@ $x ; #{} ]]> \\n",
        "--maintainer-name",
        "O'Neil & S\u00f8n <x> {{y}}",
        "--maintainer-email",
        "o.neil+x@example.com",
    )
    assert made.returncode == 0, made.stderr
    built = wsgen(tmp_path, "build")
    assert (built.returncode, "arning" in built.stderr) == (0, False), built.stderr
    code, document, _ = validate(tmp_path)
    assert code == 0
    assert document["packages"][0]["diagnostics"] == []


def test_the_path_of_a_launch_file(built: Path, tmp_path: Path) -> None:
    launch = "launch/gazebo_model.launch.py"
    for folder in (built, tmp_path):  # the installed one counts, as for --launch
        file = built / "src" / PACKAGE / launch
        code, document, error = validate(folder, str(file))
        assert code == 0, error
        (package,) = document["packages"]
        assert package["launch_file"].endswith(f"{SHARE / launch}")


def test_the_picture_shows_a_green_robot_on_a_ground(built: Path, tmp_path: Path) -> None:
    _, document, _ = validate(built, "--picture", str(tmp_path / "pictures"))
    with Image.open(document["packages"][0]["picture"]) as picture:
        channels = picture.convert("RGB").resize((64, 48)).tobytes()
    pixels = list(zip(channels[0::3], channels[1::3], channels[2::3], strict=True))
    green = sum(g > 1.5 * max(red, blue) for red, g, blue in pixels)
    black = sum(max(pixel) < 25 for pixel in pixels)
    assert green > 0.05 * len(pixels)
    assert black < 0.05 * len(pixels)
    assert len(set(pixels)) > 50


def test_two_runs_say_the_same(built: Path) -> None:
    first, second = validate(built)[1], validate(built)[1]
    for document in (first, second):
        document["packages"][0].pop("seconds")
    assert first == second


def test_launch_arguments_reach_the_robot(built: Path) -> None:
    code, document, _ = validate(built, "--arg", "z:=0.5", "--arg", "x:=1.5")
    (robot,) = document["packages"][0]["robots"]
    assert code == 0
    assert robot["spawn_pose"]["xyz"] == [1.5, 0.0, 0.5]
    assert robot["rest"]["xyz"] == pytest.approx([1.5, 0.0, 0.25], abs=0.002)


def test_a_robot_that_cannot_get_out_of_the_ground_fails(built: Path) -> None:
    exit_code, document, _ = validate(built, "--arg", "z:=-3", "--seconds", "0.5")
    assert exit_code == 1
    assert "SPN055" in [error["code"] for error in errors(document)]


def test_a_robot_that_still_rises_out_of_the_ground_passes(built: Path) -> None:
    exit_code, document, _ = validate(built, "--arg", "z:=-0.25", "--seconds", "0.5")
    assert exit_code == 0
    assert errors(document) == []


def test_a_world_that_no_file_is_called(built: Path) -> None:
    code, document, _ = validate(built, "--arg", "world:=nosuch.world")
    assert code == 0
    assert [found["code"] for found in document["packages"][0]["diagnostics"]] == ["WLD008"]


@pytest.mark.parametrize(
    ("world", "codes"),
    [
        ("shapes.sdf", ["WLD061"]),
        ("empty.sdf", []),
        ("/opt/ros/jazzy/share/gazebo_ros/worlds/empty.world", []),
    ],
)
def test_a_world_of_gazebo(built: Path, world: str, codes: list[str]) -> None:
    code, document, _ = validate(built, "--arg", f"world:={world}")
    assert code == 0
    assert [found["code"] for found in document["packages"][0]["diagnostics"]] == codes


def test_a_launch_argument_that_is_none(built: Path) -> None:
    code, _, words = validate(built, "--arg", "z=0.5")
    assert code == 2
    assert "name:=value" in words


def test_a_package_that_does_not_exist(built: Path) -> None:
    code, _, words = validate(built, "gazebo_tset")
    assert code == 2
    assert PACKAGE in words


def test_a_launch_file_that_does_not_exist(built: Path) -> None:
    code, _, words = validate(built, "--launch", "other.launch.py")
    assert code == 2
    assert "gazebo_model.launch.py" in words


def test_no_workspace(tmp_path: Path) -> None:
    code, _, words = validate(tmp_path)
    assert code == 4
    assert "wsgen new" in words


def test_not_built(workspace: Path) -> None:
    shutil.rmtree(workspace / "install")
    code, document, words = validate(workspace)
    (package,) = document["packages"]
    assert (code, [found["code"] for found in package["diagnostics"]]) == (0, ["PKG065"])
    for name in ("../nope.txt", "nope.txt", "folder/nope"):
        code, _, words = validate(workspace, name)
        assert (code, f"The file {name} does not exist." in words) == (4, True)
    shutil.rmtree(workspace / "src" / PACKAGE)
    assert "has no package" in validate(workspace)[2]


def test_model_is_not_installed(workspace: Path) -> None:
    shutil.rmtree(workspace / SHARE / "model")
    code, document, _ = validate(workspace)
    assert code == 1
    found = errors(document)
    assert any("robot.xacro" in error["message"] for error in found)
    assert any("CMakeLists.txt" in error["hint"] for error in found)


def test_launch_is_not_installed(workspace: Path) -> None:
    shutil.rmtree(workspace / SHARE / "launch")
    code, document, _ = validate(workspace, PACKAGE)
    assert code == 1
    (error,) = errors(document)
    assert error["code"] == "PKG050"
    assert "launch/gazebo_model.launch.py" in error["message"]
    assert "Run `wsgen build`" in error["hint"]
    cmake = workspace / "src" / PACKAGE / "CMakeLists.txt"
    text = cmake.read_text()
    lines = text.splitlines()
    line = 1 + next(number for number, words in enumerate(lines) if "DESTINATION" in words)
    assert error["line"] == line
    cmake.write_text(text.replace("launch model", "model"))
    (error,) = errors(validate(workspace, PACKAGE)[1])
    assert "install(DIRECTORY launch " in error["hint"]


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("share/{PROJECT_NAME}", "a $ is missing"),
        ("shared/${PROJECT_NAME}", "Write: DESTINATION share/${PROJECT_NAME};"),
        ("share/${PROJECTNAME}", "Write: DESTINATION share/${PROJECT_NAME};"),
    ],
)
def test_launch_is_installed_elsewhere(workspace: Path, place: str, words: str) -> None:
    shutil.rmtree(workspace / SHARE / "launch")
    cmake = workspace / "src" / PACKAGE / "CMakeLists.txt"
    text = cmake.read_text().replace("share/${PROJECT_NAME}", place)
    cmake.write_text(text)
    (error,) = errors(validate(workspace, PACKAGE)[1])
    lines = text.splitlines()
    assert (error["code"], error["line"]) == (
        "PKG050",
        1 + next(number for number, words in enumerate(lines) if place in words),
    )
    assert f"installed to {place}," in error["message"]
    assert words in error["hint"]


def test_a_package_without_a_launch_file(workspace: Path) -> None:
    shutil.rmtree(workspace / SHARE / "launch")
    shutil.rmtree(workspace / "src" / PACKAGE / "launch")
    code, document, _ = validate(workspace)
    assert (code, document["packages"]) == (0, [])
    (left,) = document["not_validated"]
    assert (left["package"], left["launch_file"]) == (PACKAGE, None)
    (file,) = left["robot_files"]
    printed = wsgen(workspace, "validate").stdout
    assert f"wsgen validate {Path(file).relative_to(workspace)}" in printed
    assert wsgen(workspace, "validate", file).returncode == 0


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("gazebo_model.launch.py.txt", "gazebo_model.launch.py"),
        ("gazebo_model.launch", "gazebo_model.launch.py"),
    ],
)
def test_a_launch_file_that_is_not_named_as_one(workspace: Path, name: str, meant: str) -> None:
    for folder in (workspace / SHARE / "launch", workspace / "src" / PACKAGE / "launch"):
        (folder / "gazebo_model.launch.py").rename(folder / name)
    code, document, _ = validate(workspace, PACKAGE)
    (error,) = errors(document)
    assert (code, error["code"]) == (1, "PKG051")
    assert error["file"].endswith(f"src/{PACKAGE}/launch/{name}")
    assert f"Rename it to {meant}," in error["hint"]


def test_a_launch_file_of_any_name(workspace: Path) -> None:
    """`ros2 launch` takes it by its name; wsgen finds it by what it defines."""
    for folder in (workspace / SHARE / "launch", workspace / "src" / PACKAGE / "launch"):
        (folder / "gazebo_model.launch.py").rename(folder / "start_gazebo.py")
    code, document, _ = validate(workspace, PACKAGE)
    assert (code, errors(document)) == (0, [])
    assert document["packages"][0]["launch_file"].endswith("launch/start_gazebo.py")


def test_a_misspelled_launch_file(built: Path) -> None:
    code, _, words = validate(built, PACKAGE, "--launch", "gazebo_modle.launch.py")
    assert code == 2
    assert "Did you mean `gazebo_model.launch.py`?" in words


def test_every_package_of_a_workspace_is_checked_or_named(workspace: Path) -> None:
    """One that spawns nothing, one with two equal launch files, one that is not built."""
    for name in ("not_built", "library", "undecided"):
        made = wsgen(workspace, "new", name)
        assert made.returncode == 0, made.stderr
    shutil.rmtree(workspace / "src" / "library" / "launch")
    cmake = workspace / "src" / "library" / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("DIRECTORY launch model", "DIRECTORY model"))
    launch = workspace / "src" / "undecided" / "launch"
    shutil.copy(launch / "gazebo_model.launch.py", launch / "other.launch.py")
    assert wsgen(workspace, "build", "library", "undecided").returncode == 0
    code, document, _ = validate(workspace)
    assert code == 0
    found = {
        package["package"]: [error["code"] for error in package["diagnostics"]]
        for package in document["packages"]
    }
    assert found == {PACKAGE: ["PKG065"], "not_built": [], "undecided": []}
    assert "  library: spawns no robot" in wsgen(workspace, "validate").stdout
    (same,) = (one for one in document["not_validated"] if one["launch_file"])
    assert same["launch_file"].endswith("/other.launch.py")
    assert same["reason"] == "the same simulation as gazebo_model.launch.py"
    code, document, _ = validate(workspace, "undecided", "--launch", "other.launch.py")
    assert (code, [one["package"] for one in document["packages"]]) == (0, ["undecided"])


def test_a_path_is_no_package(built: Path) -> None:
    code, _, words = validate(built, f"{PACKAGE}/")
    assert code == 2
    assert f"wsgen validate {PACKAGE}" in words


def test_a_launch_file_that_was_renamed_after_a_build_with_links(workspace: Path) -> None:
    """--symlink-install leaves a link that leads nowhere."""
    launch = workspace / SHARE / "launch"
    (launch / "gazebo_model.launch.py").unlink()
    (launch / "gazebo_model.launch.py").symlink_to("nowhere.launch.py")
    (launch / "folder.launch.py").mkdir()
    code, document, _ = validate(workspace)
    assert code == 1
    assert [error["code"] for error in errors(document)] == ["PKG050"]


def test_a_syntax_error_in_the_launch_file(workspace: Path) -> None:
    file = workspace / SHARE / "launch" / "gazebo_model.launch.py"
    file.write_text("def generate_launch_description(:\n")
    code, document, _ = validate(workspace)
    assert code == 1
    (error,) = errors(document)
    assert (error["file"], error["line"]) == (str(file), 1)


def test_an_undefined_property_in_the_xacro(workspace: Path) -> None:
    file = workspace / SHARE / "model" / "robot.xacro"
    file.write_text(file.read_text().replace("${length}", "${lenght}"))
    code, document, _ = validate(workspace)
    assert code == 1
    assert any("lenght" in error["message"] for error in errors(document))


def test_a_brace_that_is_missing_in_the_xacro(workspace: Path) -> None:
    file = workspace / SHARE / "model" / "robot.xacro"
    file.write_text(file.read_text().replace("${length}", "${length", 1))
    code, document, _ = validate(workspace)
    assert code == 1
    assert errors(document)


def test_a_world_that_is_not_there(workspace: Path) -> None:
    (workspace / SHARE / "model" / "empty_world.world").unlink()
    code, document, _ = validate(workspace)
    assert code == 1
    assert [error["code"] for error in errors(document)] == ["WLD001"]


def test_a_launch_file_that_spawns_nothing(workspace: Path) -> None:
    file = workspace / SHARE / "launch" / "gazebo_model.launch.py"
    file.write_text(
        "from launch import LaunchDescription\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([])\n"
    )
    code, document, _ = validate(workspace)
    assert (code, document["passed"], document["packages"]) == (0, True, [])
    assert [one["reason"] for one in document["not_validated"]] == ["spawns no robot"]
    code, document, _ = validate(workspace, "--launch", file.name)
    assert code == 1
    assert any("spawn" in error["message"] for error in errors(document))


def test_a_launch_file_that_hangs_or_crashes_is_a_finding(workspace: Path) -> None:
    file = workspace / SHARE / "launch" / "gazebo_model.launch.py"
    file.write_text("import os\nos.abort()\n")
    code, document, _ = validate(workspace)
    assert code == 1
    assert any("SIGABRT" in error["message"] for error in errors(document))


def test_the_json_file_is_what_is_printed(built: Path, tmp_path: Path) -> None:
    file = tmp_path / "report.json"
    run = wsgen(built, "validate", "--json", str(file))
    assert run.returncode == 0
    assert json.loads(file.read_text())["passed"]
    assert "simple_robot" in run.stdout


def test_a_json_file_that_cannot_be_written(built: Path, tmp_path: Path) -> None:
    run = wsgen(built, "validate", "--json", str(tmp_path / "no" / "report.json"))
    assert run.returncode == 4
    assert "report.json" in run.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a full device")
def test_a_full_disk_behind_the_json_file(built: Path) -> None:
    run = wsgen(built, "validate", "--json", "/dev/full")
    assert run.returncode == 4
    assert run.stderr.count("Cannot write /dev/full: the disk is full (/") == 1


def test_the_next_steps(built: Path, tmp_path: Path) -> None:
    run = wsgen(built, "validate", "--arg", "z:=0.4", "--seconds", "2.5")
    said = [line.strip().partition("  (")[0] for line in run.stderr.splitlines()[-3:]]
    assert said == [
        "Next: wsgen validate --arg z:=0.4 --seconds 2.5 --picture .",
        f"wsgen launch {PACKAGE} gazebo_model.launch.py --run --view z:=0.4",
        f"ros2 launch {PACKAGE} gazebo_model.launch.py z:=0.4",
    ]
    run = wsgen(built, "validate", PACKAGE, "--picture", str(tmp_path))
    assert "--picture" not in run.stderr
    assert run.stderr.splitlines()[-2].startswith("Next: wsgen launch")
    for options in (("-q",), ("--format", "json"), ("--arg", "z:=-3")):
        assert "Next:" not in wsgen(built, "validate", *options).stderr


@pytest.mark.parametrize(
    ("options", "is_loaded"), [((), True), (("-q",), False), (("--format", "json"), False)]
)
def test_only_a_table_loads_rich(built: Path, options: tuple[str, ...], *, is_loaded: bool) -> None:
    script = (
        "import sys\nfrom wsgen.cli import run\n"
        f"run({['validate', *options]!r})\nprint('rich' in sys.modules)"
    )
    command = [sys.executable, "-c", script]
    run = subprocess.run(command, cwd=built, capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == str(is_loaded)


@pytest.mark.parametrize("engine", ["dart", "all"])
def test_the_next_step_keeps_the_engine(built: Path, engine: str) -> None:
    pytest.importorskip("dartpy")
    run = wsgen(built, "validate", "--engine", engine)
    assert f"Next: wsgen validate --engine {engine} --picture .\n" in run.stderr
    assert (" in PyBullet" in run.stderr) == (engine == "all")
    chosen = "" if engine == "all" else f" --engine {engine}"  # a live run is in one
    launch = f"wsgen launch {PACKAGE} gazebo_model.launch.py --run --view{chosen}  ("
    assert launch in run.stderr


@pytest.mark.parametrize(
    ("library", "options"), [("json", "--run --view"), ("no_such_library", "--run")]
)
def test_the_browser_is_for_who_can_show_something_there(
    built: Path,
    library: str,
    options: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(built)
    monkeypatch.setattr("wsgen.reporting.viewing.LIBRARY", library)
    assert run(["validate"]) == 0
    line = f" wsgen launch {PACKAGE} gazebo_model.launch.py {options}  (starts its nodes"
    assert line in capsys.readouterr().err


@pytest.mark.parametrize(
    ("hint", "line"),
    [
        ("Install it: pip install 'wsgen[ros]'.", "without ROS; after: pip install 'wsgen[ros]')"),
        ("Use another machine.", None),
    ],
)
def test_a_run_is_for_who_can_have_ros(
    built: Path,
    hint: str,
    line: str | None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(built)
    why_not = NotFoundError("No ROS.", hint=hint)
    monkeypatch.setattr("wsgen.ros.environment.environment.why_no_ros", lambda _: why_not)
    assert run(["validate"]) == 0
    said = capsys.readouterr().err
    assert line in said if line else "--run" not in said


def test_the_next_steps_from_elsewhere(built: Path, tmp_path: Path) -> None:
    run = wsgen(tmp_path, "validate", "-w", str(built), PACKAGE)
    assert f"Next: wsgen validate {PACKAGE} -w {built} --picture .\n" in run.stderr


def test_a_package_of_ros_1_is_named(tmp_path: Path) -> None:
    package = tmp_path / "src" / "old"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text(
        '<package format="2"><name>old</name><version>0.0.0</version><description>d</description>'
        '<maintainer email="a@b.org">m</maintainer><license>MIT</license>'
        "<buildtool_depend>catkin</buildtool_depend></package>"
    )
    (package / "CMakeLists.txt").write_text("find_package(catkin REQUIRED)\n")
    (package / "launch" / "room.launch").write_text("<launch/>")
    assert "  old: is a package of ROS 1" in wsgen(tmp_path, "validate").stdout
