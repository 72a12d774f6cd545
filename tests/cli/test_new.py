import json
import os
import shutil
import sys
from pathlib import Path

import pytest

from wsgen.cli import run

NOTE = (
    "note: ROS 2 Iron has had no updates since 2024-12-04; use --distro humble (until 2027-05)"
    " or --distro lyrical (until 2031-05).\n"
)
GIVEN = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder, and nobody's settings."""
    for name in ("ROS_DISTRO", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", "/dev/null")
    monkeypatch.setenv("GIT_CONFIG_SYSTEM", "/dev/null")
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def new(*arguments: str) -> int:
    return run(["new", *arguments, *GIVEN])


def files(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.slow
def test_quiet_leaves_the_warnings(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test", "-q") == 0
    output = capsys.readouterr()
    assert (output.out, output.err) == ("", NOTE)
    assert new("other", "-q", "--dry-run") == 0
    assert "src/other/package.xml" in capsys.readouterr().out  # the list that was asked for


def test_new_workspace(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test") == 0
    assert files(here / "ws_gazebo") == {".gitignore"} | {
        f"src/gazebo_test/{name}"
        for name in (
            "CMakeLists.txt",
            "LICENSE",
            "README.md",
            "launch/gazebo_model.launch.py",
            "model/empty_world.world",
            "model/inertia.xacro",
            "model/robot.gazebo",
            "model/robot.xacro",
            "package.xml",
            "test/test_robot.py",
            "wsgen.toml",
        )
    }
    output = capsys.readouterr()
    assert output.out == (
        "Wrote ws_gazebo/src/gazebo_test\nWrote ws_gazebo/.gitignore\n"
        "Next: cd ws_gazebo && wsgen build && wsgen validate\n"
    )
    assert output.err == NOTE


def test_second_package_goes_into_the_workspace_around(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("gazebo_test") == 0
    monkeypatch.chdir(here / "ws_gazebo" / "src" / "gazebo_test" / "model")
    capsys.readouterr()
    assert new("second_robot") == 0
    source = here / "ws_gazebo" / "src"
    assert (source / "second_robot" / "package.xml").is_file()
    # In one simulator the two have two names.
    spawned = {
        name: (source / name / "launch" / "gazebo_model.launch.py").read_text()
        for name in ("gazebo_test", "second_robot")
    }
    assert "'-entity', 'simple_robot'" in spawned["gazebo_test"]
    assert "'-entity', 'second_robot'" in spawned["second_robot"]
    output = capsys.readouterr()
    assert output.out.endswith("\nNext: wsgen build && wsgen validate\n")
    announced = f"note: The current folder is in the workspace {source.parent}, which is used.\n"
    assert output.err.startswith(announced)
    assert new("third_robot", "--dry-run") == 0
    assert capsys.readouterr().err.startswith(announced)
    assert new("third_robot", "--dry-run", "-w", str(source.parent)) == 0  # as was asked
    assert announced not in capsys.readouterr().err


def test_the_source_folder_of_somebody_else_gets_no_package(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert new("tool", "-w", ".") == 0
    (here / "project" / "demo").mkdir(parents=True)
    monkeypatch.chdir(here / "project" / "demo")
    assert new("robot") == 0
    assert (here / "project" / "demo" / "ws_gazebo" / "src" / "robot").is_dir()
    assert not (here / "src" / "robot").exists()


@pytest.mark.parametrize("inside", [".", "src", "src/drivers", "src/drivers/lidar"])
@pytest.mark.parametrize(
    "content", ["src/drivers/notes.txt", "src/robots.repos", "src/vendor/src/main.cpp"]
)
def test_a_source_folder_without_packages(
    here: Path, monkeypatch: pytest.MonkeyPatch, content: str, inside: str
) -> None:
    for folder in (inside, Path(content).parent):
        (here / "ws" / folder).mkdir(parents=True, exist_ok=True)
    (here / "ws" / content).touch()
    monkeypatch.chdir(here / "ws" / inside)
    assert new("gazebo_test") == 0
    assert (here / "ws" / "src" / "gazebo_test" / "package.xml").is_file()
    assert not list(here.rglob("ws_gazebo"))
    assert new("other", "-w", str(here / "ws" / "src")) == 2


def test_what_colcon_left_is_a_workspace_without_a_source_folder(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (here / "ws" / "build").mkdir(parents=True)
    (here / "ws" / "build" / ".built_by").write_text("colcon\n")
    monkeypatch.chdir(here / "ws")
    assert new("gazebo_test") == 0
    assert (here / "ws" / "src" / "gazebo_test" / "package.xml").is_file()


def test_the_source_folder_of_a_python_project(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (here / "src" / "tool").mkdir(parents=True)
    (here / "pyproject.toml").touch()
    assert new("gazebo_test") == 0
    assert (here / "ws_gazebo" / "src" / "gazebo_test").is_dir()


def test_existing_folder(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test") == 0
    package = here / "ws_gazebo" / "src" / "gazebo_test"
    (package / "package.xml").write_text("mine")
    assert new("gazebo_test") == 3
    assert (package / "package.xml").read_text() == "mine"
    assert "already exists" in capsys.readouterr().err
    assert new("gazebo_test", "--dry-run") == 3


def test_package_of_the_same_name_in_another_folder(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("gazebo_test") == 0
    source = here / "ws_gazebo" / "src"
    (source / "group").mkdir()
    (source / "gazebo_test").rename(source / "group" / "renamed")
    assert new("gazebo_test") == 3
    assert str(source / "group" / "renamed") in capsys.readouterr().err
    assert [path.name for path in source.iterdir()] == ["group"]


def test_given_workspace_with_a_space(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test", "-w", "my ws") == 0
    assert (here / "my ws" / "src" / "gazebo_test").is_dir()
    assert "cd 'my ws' && wsgen build" in capsys.readouterr().out


def test_workspace_among_packages(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test") == 0
    for place in ("ws_gazebo/src", "ws_gazebo/src/gazebo_test"):
        assert new("second_robot", "-w", place) == 2
    assert f"-w {here / 'ws_gazebo'}" in capsys.readouterr().err


def test_json(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test", "--format", "json") == 0
    output = json.loads(capsys.readouterr().out)
    assert output.pop("files") == sorted(files(here / "ws_gazebo" / "src" / "gazebo_test"))
    assert output == {
        "version": 1,
        "package": "gazebo_test",
        "path": str(here / "ws_gazebo" / "src" / "gazebo_test"),
        "workspace": str(here / "ws_gazebo"),
        "workspace_files": [".gitignore"],
        "written": True,
    }


def test_dry_run(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("gazebo_test", "--dry-run") == 0
    assert not list(here.iterdir())
    output = capsys.readouterr()
    assert output.err == f"{NOTE}Nothing was written.\n"
    assert new("gazebo_test", "--dry-run", "--format", "json") == 0
    assert json.loads(capsys.readouterr().out)["written"] is False
    assert new("gazebo_test") == 0
    assert {str(here / "ws_gazebo" / name) for name in files(here / "ws_gazebo")} == set(
        output.out.splitlines()
    )


@pytest.mark.parametrize(
    ("arguments", "message", "hint"),
    [
        (["../evil"], "is a path", "Use for example evil"),
        (["/srv/evil"], "is a path", "Use for example evil"),
        ([""], "is empty", "Use for example my_robot"),
        (["x" * 300], "xxx...' is longer than 64", "Use for example xxx"),
        (["röbot"], "lower-case", "Use for example robot"),
        (["test"], "CMake", "Use for example test_robot"),
        (["import"], "Python", "Use for example import_robot"),
        (["xacro"], "depends on", "Use for example xacro_robot"),
        (["ament_cmake"], "depends on", "Use for example ament_cmake_robot"),
        (["a_b", "-t", "crane"], "'crane' does not exist", "simple"),
        (["a_b", "-t", "base"], "is abstract", "simple"),
        (["a_b", "-t", "."], "has no template.toml", "simple"),
        (["a_b", "--distro", "noetic"], "'noetic' is not a ROS 2", "--distro lyrical"),
        (["a_b", "--distro", "jazzy", "--sim", "classic"], "not released", "jazzy --sim gz"),
        (["a_b", "--set", "mass=heavy"], "`mass` must be a number", "--set mass=1"),
        (["a_b", "--license", "GPL"], "not have the text of the license 'GPL'", "Apache-2.0"),
        (["a_b", "--description", ""], "description is empty", "--description"),
        (["a_b", "--description", "a\x07b"], "U+0007", "control"),
        (["a_b", "--maintainer-name", 'A "B"'], "CMake", "--maintainer-name"),
        (["a_b", "--maintainer-email", "nobody"], "'nobody' is not a valid e-mail", "@example.com"),
    ],
)
def test_wrong_request(
    here: Path, arguments: list[str], message: str, hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["new", *GIVEN, *arguments]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    said, simulated = output.err.splitlines()
    assert message in said
    assert hint in simulated
    assert not list(here.iterdir())


def test_distro_of_the_sourced_ros(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_DISTRO", "kilted")
    assert new("gazebo_test") == 0
    manifest = here / "ws_gazebo" / "src" / "gazebo_test" / "package.xml"
    assert "ros_gz_sim" in manifest.read_text()
    assert new("other_robot", "--distro", "iron") == 0
    assert "gazebo_ros" in (manifest.parents[1] / "other_robot" / "package.xml").read_text()
    capsys.readouterr()


def test_sourced_ros_that_is_not_known(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_DISTRO", "noetic")
    assert new("gazebo_test") == 2
    output = capsys.readouterr().err
    assert "ROS_DISTRO=noetic in the environment" in output
    assert "unset ROS_DISTRO" in output
    assert not list(here.iterdir())
    assert new("gazebo_test", "--distro", "jazzy") == 0
    monkeypatch.setenv("ROS_DISTRO", "")
    assert new("other_robot") == 0


def test_end_of_life_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert new("humble_robot", "--distro", "humble", "--sim", "classic") == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("note: Gazebo Classic has had no updates since 2025-01; use --sim gz")
    assert new("jazzy_robot", "--distro", "lyrical", "-w", "ws_gazebo") == 0
    assert capsys.readouterr().err == ""


def test_the_name_of_a_package_of_ros(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--distro", "lyrical", "-w", "ws_gazebo")
    assert new("my_nav2_msgs", *options) == 0
    assert capsys.readouterr().err == ""
    assert new("nav2_msgs", *options) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("note: ROS has a package nav2_msgs: where this one is built")


def test_options_reach_the_files(here: Path) -> None:
    text = "<b> & \"c\" 'd' ${x} {{x}}\n🤖"
    assert new("gazebo_test", "--description", text, "--license", "mit", "--set", "mass=2") == 0
    package = here / "ws_gazebo" / "src" / "gazebo_test"
    assert 'name="mass" default="2.0"' in (package / "model" / "robot.xacro").read_text()
    assert (package / "LICENSE").read_text().startswith("MIT License\n\nCopyright (c) Ada\n")
    assert "&lt;b&gt; &amp; \"c\" 'd' ${x} {{x}}\n🤖" in (package / "package.xml").read_text()


def test_nobody_knows_the_maintainer(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("LOGNAME", "grace")
    assert run(["new", "gazebo_test"]) == 0
    assert (
        "note: git has no usable user.email. package.xml has the placeholder grace@todo.todo"
        in capsys.readouterr().err
    )
    manifest = (here / "ws_gazebo" / "src" / "gazebo_test" / "package.xml").read_text()
    assert '<maintainer email="grace@todo.todo">grace</maintainer>' in manifest


def test_file_where_the_workspace_should_be(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "ws_gazebo").write_text("mine")
    assert new("gazebo_test") == 4
    assert "Not a directory" in capsys.readouterr().err
    assert files(here) == {"ws_gazebo"}


@pytest.mark.skipif(sys.platform == "darwin", reason="names of files are Unicode there")
def test_folder_whose_name_is_no_text(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    odd = os.fsdecode(b"ws_\xff")
    assert new("gazebo_test", "-w", odd) == 0
    assert (here / odd / "src" / "gazebo_test").is_dir()


def test_leftovers_of_a_killed_command_are_no_packages(here: Path) -> None:
    """colcon's own crawl does not see what is not finished."""
    assert new("gazebo_test") == 0
    source = here / "ws_gazebo" / "src"
    shutil.copytree(source / "gazebo_test", source / ".wsgen-new-1-00" / "second_robot")
    assert new("second_robot") == 0
    assert sorted(path.name for path in source.iterdir()) == ["gazebo_test", "second_robot"]


@pytest.mark.parametrize("folder", ["semi;colon", "dollar$x", "co:lon"])
def test_a_workspace_that_cmake_could_not_build(tmp_path: Path, folder: str) -> None:
    assert run(["new", "some_robot", "-w", str(tmp_path / folder)]) == 2
    assert not (tmp_path / folder).exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("option", "next_step"),
    [
        ("--build", "Next: cd ws_gazebo && wsgen validate gazebo_test"),
        ("--validate", "Next: wsgen validate gazebo_test --picture ."),
    ],
)
@pytest.mark.usefixtures("here")
def test_a_step_that_is_taken_is_not_the_next(
    option: str, next_step: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("gazebo_test", option) == 0
    output = capsys.readouterr()
    assert "Next:" not in output.out
    assert "wsgen build" not in output.err
    assert [line for line in output.err.splitlines() if line.startswith("Next:")] == [next_step]
