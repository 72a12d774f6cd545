from pathlib import Path

import pytest

from wsgen.errors import RequestError
from wsgen.model.target import DEFAULT_TARGET, Target
from wsgen.templating.licenses import find_license, license_names
from wsgen.templating.location import templates_folder
from wsgen.templating.manifest import (
    Template,
    load_template,
    resolve_answers,
    template_names,
)

GZ_TARGET = Target(
    distro="jazzy",
    simulator="gz",
    ubuntu="24.04",
    end_of_life=None,
    cmake_minimum="3.20",
    sdf_version="1.11",
)


@pytest.fixture
def simple() -> Template:
    return load_template("simple", DEFAULT_TARGET)


@pytest.mark.parametrize("name", template_names())
def test_every_source_of_a_template_is_there(name: str) -> None:
    template = load_template(name, DEFAULT_TARGET)
    for source in template.files.values():
        assert (templates_folder() / source).is_file()
        assert source.endswith(".j2")


def test_every_template_has_the_files_that_all_have(simple: Template) -> None:
    assert set(simple.files) == {
        "CMakeLists.txt",
        "LICENSE",
        "README.md",
        "launch/gazebo_model.launch.py",
        "model/empty_world.world",
        "model/robot.gazebo",
        "model/robot.xacro",
        "package.xml",
        "wsgen.toml",
    }


def test_dependencies_are_those_of_all_simulators_and_of_this_one(simple: Template) -> None:
    assert simple.dependencies == {
        "buildtool_depend": ("ament_cmake",),
        "exec_depend": (
            "gazebo_ros",
            "joint_state_publisher",
            "launch",
            "launch_ros",
            "robot_state_publisher",
            "ros2launch",
            "xacro",
        ),
        "test_depend": ("ament_lint_auto", "ament_lint_common"),
    }


@pytest.mark.parametrize("name", ["", "arm", "_shared", "..", "simple/", "/etc"])
def test_unknown_template(name: str) -> None:
    with pytest.raises(RequestError, match="There is no template") as caught:
        load_template(name, DEFAULT_TARGET)
    assert "simple" in caught.value.hint


def test_template_that_is_not_made_for_a_simulator() -> None:
    with pytest.raises(RequestError, match="not made for the simulator 'gz'") as caught:
        load_template("simple", GZ_TARGET)
    assert "--sim classic" in caught.value.hint


def test_answers(simple: Template) -> None:
    assert resolve_answers(simple, []) == {"length": 0.5, "radius": 0.4, "mass": 1.0}
    assert resolve_answers(simple, ["mass=2", "length=1e-1", "mass=3"]) == {
        "length": 0.1,
        "radius": 0.4,
        "mass": 3.0,
    }


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("mass", "no '='"),
        ("", "no '='"),
        ("=1", "no variable ''"),
        ("Mass=1", "no variable 'Mass'"),
        ("mass=", "is no number"),
        ("mass=two", "is no number"),
        ("mass=1,5", "is no number"),
        ("mass=nan", "is no number"),
        ("mass=inf", "no number from 0.001 to 100000 kg"),
        ("mass=0", "no number from 0.001 to 100000 kg"),
        ("length=-1", "no number from 0.001 to 100 m"),
        ("radius=1 m", "is no number"),
    ],
)
def test_setting_that_makes_no_sense(simple: Template, setting: str, words: str) -> None:
    with pytest.raises(RequestError, match=words) as caught:
        resolve_answers(simple, [setting])
    assert f"--set {setting}" in caught.value.message
    assert "--set" in caught.value.hint


def test_licenses() -> None:
    assert license_names() == ["Apache-2.0", "BSD-3-Clause", "MIT"]
    assert find_license("mit") == "MIT"
    with pytest.raises(RequestError, match="no text of a licence 'GPL'"):
        find_license("GPL")


def test_the_origin_of_every_licence_is_recorded() -> None:
    folder = templates_folder() / "_shared" / "licenses"
    origin = (folder / "ORIGIN.md").read_text()
    for name in license_names():
        assert f"`{name}.txt.j2`" in origin


def test_the_default_licence_is_the_projects_own() -> None:
    text = (templates_folder() / "_shared/licenses/Apache-2.0.txt.j2").read_text()
    assert text == (Path(__file__).parents[2] / "LICENSE").read_text()
