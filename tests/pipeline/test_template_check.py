"""`wsgen templates --check`: what is found in the packages that a template makes."""

from pathlib import Path

import pytest

from templating.broken_templates import FILES, HEAD, load, write_template
from wsgen.diagnostics import Diagnostic
from wsgen.model.target import TARGETS
from wsgen.pipeline.template_check import check_template

pytestmark = pytest.mark.slow

ROBOT = """\
<?xml version="1.0"?>
<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="world"/>
  <joint name="j" type="fixed">
    <origin xyz="0 0 1"/><parent link="world"/><child link="a"/>
  </joint>
  <link name="a">
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
</robot>
"""
FLAG = '[variables.lidar]\nhelp = "Lidar"\ntype = "boolean"\ndefault = false\n'


def check(folder: Path) -> tuple[Diagnostic, ...]:
    return check_template(load(folder))


def only(found: tuple[Diagnostic, ...]) -> Diagnostic:
    (one,) = found
    return one


def test_a_template_without_mistakes(tmp_path: Path) -> None:
    assert check(write_template(tmp_path, robot=ROBOT)) == ()


@pytest.mark.parametrize(
    ("path", "text", "line", "message"),
    [
        ("model/robot.xacro", "<robot>\n<link></robot>\n", 2, "is not well-formed XML"),
        ("launch/other.launch.py", "def f(:\n", 1, "is not valid Python"),
        ("config/x.toml", "a = \n", None, "is not valid TOML"),
        ("package.xml", "<package>\n", 1, "package.xml is not well-formed XML"),
    ],
)
def test_malformed_file(
    tmp_path: Path, path: str, text: str, line: int | None, message: str
) -> None:
    manifest = f'{HEAD}targets = ["jazzy"]\n{FILES}"{path}" = "other.j2"\n'
    if path == "model/robot.xacro":
        manifest = manifest.replace('"model/robot.xacro" = "robot.xacro.j2"\n', "")
    found = only(check(write_template(tmp_path, manifest, robot=ROBOT, other__j2=text)))
    assert message in found.message
    assert (found.file, found.line) == (Path(path), line)


def test_robot_that_gazebo_refuses_for_every_target(tmp_path: Path) -> None:
    folder = write_template(tmp_path, robot=ROBOT.replace('<child link="a"/>', '<child link="b"/>'))
    found = check(folder)
    assert found
    assert all(str(one.file) == "model/robot.xacro" for one in found)
    assert not any("(for " in one.message for one in found)


def test_xacro_that_does_not_expand(tmp_path: Path) -> None:
    folder = write_template(tmp_path, robot=ROBOT.replace('value="1"', 'value="${nothing}"'))
    found = only(check(folder))
    assert found.code == "LCH008"
    assert "nothing" in found.message
    assert str(tmp_path) not in found.message


def test_what_is_wrong_for_some_targets_says_for_which(tmp_path: Path) -> None:
    robot = ROBOT + '{% if package.target.distro == "jazzy" %}{{ nothing }}{% endif %}'
    found = only(check(write_template(tmp_path, robot=robot)))
    assert found.message == "'nothing' is undefined. (for jazzy-gz)"
    robot = robot.replace("distro", "simulator").replace("jazzy", "gz")
    found = only(check(write_template(tmp_path, robot=robot)))
    assert "(for humble-gz, iron-gz, jazzy-gz and 3 more)" in found.message


def test_other_values_of_booleans_and_choices_are_rendered(tmp_path: Path) -> None:
    robot = ROBOT.replace("</robot>", "{% if package.answers.lidar %}</{% endif %}</robot>")
    folder = write_template(tmp_path, f'{HEAD}targets = ["jazzy"]\n{FLAG}{FILES}', robot=robot)
    found = only(check(folder))
    assert found.code == "TPL006"
    assert found.message.endswith("(for jazzy-gz --set lidar=true)")


def test_template_without_a_robot(tmp_path: Path) -> None:
    """Files alone are a package; nothing is simulated."""
    manifest = f'{HEAD}[files]\n"launch/gazebo_model.launch.py" = "robot.xacro.j2"\n'
    launch_file = (
        "from launch import LaunchDescription\n\n\n"
        "def generate_launch_description():\n    return LaunchDescription()\n"
    )
    assert check(write_template(tmp_path, manifest, robot=launch_file)) == ()


def test_every_target_is_rendered(tmp_path: Path) -> None:
    robot = ROBOT + "{{ nothing[package.target.name] }}"
    found = only(check(write_template(tmp_path, robot=robot)))
    assert found.line == len(ROBOT.splitlines()) + 1
    assert len(TARGETS) == 8
