from pathlib import Path

import pytest

from wsgen.errors import RequestError
from wsgen.model.target import DEFAULT_TARGET, TARGETS, Target, choose_target
from wsgen.templating.sources import find_source, templates_folder
from wsgen.templating.spec import find_license, license_names, resolve_answers
from wsgen.templating.template import Template, load_template, template_names

CLASSIC_FILES = {
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
}
GZ_FILES = CLASSIC_FILES | {
    "config/bridge.yaml",
    "hooks/{{ package.name }}.dsv.in",
    "hooks/{{ package.name }}.sh.in",
}


@pytest.fixture
def simple() -> Template:
    return load_template("simple")


def defaults(template: Template) -> dict[str, float | str]:
    return resolve_answers(template.variables, [], template.name)


def test_what_is_only_there_to_be_extended_is_not_listed() -> None:
    assert "simple" in template_names()
    assert "base" not in template_names()


@pytest.mark.parametrize("name", template_names())
@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_every_source_of_a_template_is_there(name: str, target: Target) -> None:
    template = load_template(name)
    for source in template.sources(target, defaults(template)).values():
        assert source.startswith("wsgen:")
        assert find_source(source, template.folder).is_file()


def test_the_files_of_simple(simple: Template) -> None:
    assert set(simple.sources(DEFAULT_TARGET, defaults(simple))) == CLASSIC_FILES
    assert set(simple.sources(choose_target("jazzy"), defaults(simple))) == GZ_FILES


@pytest.mark.parametrize("name", template_names())
def test_every_template_has_the_files_that_all_have(name: str) -> None:
    template = load_template(name)
    assert set(template.sources(DEFAULT_TARGET, defaults(template))) >= CLASSIC_FILES
    assert set(template.sources(choose_target("jazzy"), defaults(template))) >= GZ_FILES


def test_dependencies_are_those_of_all_parts_whose_condition_is_met(simple: Template) -> None:
    common = ("launch", "launch_ros", "robot_state_publisher", "ros2launch", "xacro")
    classic = simple.dependencies(DEFAULT_TARGET, defaults(simple))
    assert classic == {
        "buildtool_depend": ("ament_cmake",),
        "exec_depend": tuple(sorted((*common, "gazebo_ros", "joint_state_publisher"))),
        "test_depend": ("ament_cmake_pytest", "ament_lint_auto", "ament_lint_common"),
    }
    gz = simple.dependencies(choose_target("jazzy"), defaults(simple))
    assert gz["exec_depend"] == tuple(sorted((*common, "ros_gz_bridge", "ros_gz_sim")))


@pytest.mark.parametrize("name", ["", "crane", "licenses", "..", "simple/", "/etc", "../simple"])
def test_unknown_template(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RequestError) as caught:
        load_template(name)
    assert "simple" in caught.value.hint


def test_base_makes_no_package() -> None:
    with pytest.raises(RequestError, match="'base' is abstract"):
        load_template("base")


def test_a_template_of_wsgen_comes_before_a_folder_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "simple").mkdir()
    (tmp_path / "simple" / "template.toml").write_text('schema = 1\ndescription = "Mine."\n')
    monkeypatch.chdir(tmp_path)
    assert load_template("simple").is_shipped
    assert load_template("./simple").description == "Mine."


def test_licenses() -> None:
    assert license_names() == ["Apache-2.0", "BSD-3-Clause", "MIT"]
    assert find_license("mit") == "MIT"
    with pytest.raises(RequestError, match="not have the text of the license 'GPL'"):
        find_license("GPL")


def test_the_origin_of_every_license_is_recorded() -> None:
    folder = templates_folder() / "base" / "licenses"
    origin = (folder / "ORIGIN.md").read_text()
    for name in license_names():
        assert f"`{name}.txt.j2`" in origin


def test_the_default_license_is_the_projects_own() -> None:
    text = (templates_folder() / "base/licenses/Apache-2.0.txt.j2").read_text()
    assert text == (Path(__file__).parents[2] / "LICENSE").read_text()
