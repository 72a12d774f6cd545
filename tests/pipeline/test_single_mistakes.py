"""One mistake in a robot is one diagnostic, about what is written.

First of the description alone, then with the run of what it describes.
"""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.xacro.expansion import expand
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.packages.workspace.overlay import Overlay
from wsgen.pipeline.file_validation import FileValidation
from wsgen.pipeline.prepare import PrepareContext, prepare_robot
from wsgen.pipeline.requests import ValidateRequest

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


ROVER = """<robot name="rover">
  <link name="base_link">
    <visual><geometry><box size="0.4 0.3 0.1"/></geometry></visual>
    <collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision>
    <inertial>
      <mass value="5"/>
      <inertia ixx="0.042" ixy="0" ixz="0" iyy="0.071" iyz="0" izz="0.104"/>
    </inertial>
  </link>
  <joint name="left_joint" type="continuous">
    <origin xyz="0.1 0.18 0" rpy="0 0 0"/>
    <parent link="base_link"/>
    <child link="left_wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="left_wheel">
    <visual><geometry><cylinder radius="0.08" length="0.04"/></geometry></visual>
    <collision><geometry><cylinder radius="0.08" length="0.04"/></geometry></collision>
    <inertial>
      <mass value="0.5"/>
      <inertia ixx="0.00087" ixy="0" ixz="0" iyy="0.00087" iyz="0" izz="0.0016"/>
    </inertial>
  </link>
  <joint name="right_joint" type="continuous">
    <origin xyz="0.1 -0.18 0" rpy="0 0 0"/>
    <parent link="base_link"/>
    <child link="right_wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="right_wheel">
    <visual><geometry><cylinder radius="0.08" length="0.04"/></geometry></visual>
    <collision><geometry><cylinder radius="0.08" length="0.04"/></geometry></collision>
    <inertial>
      <mass value="0.5"/>
      <inertia ixx="0.00087" ixy="0" ixz="0" iyy="0.00087" iyz="0" izz="0.0016"/>
    </inertial>
  </link>
  <gazebo reference="right_wheel"><mu1>0.8</mu1></gazebo>
</robot>
"""
# As the tutorial's: the root has no mass, and its body is called after it.
LUMPED = """<robot name="simple_robot" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="length" value="0.5"/>
  <xacro:property name="radius" value="0.4"/>
  <link name="dummy"/>
  <joint name="dummy_joint" type="fixed">
    <parent link="dummy"/>
    <child link="base_link"/>
  </joint>
  <link name="base_link">
    <visual>
      <geometry>
        <cylinder length="${length}"
                  radius="${radius}"/>
      </geometry>
    </visual>
    <collision>
      <geometry>
        <cylinder length="${length}"
                  radius="${radius}"/>
      </geometry>
      <origin rpy="0 0 0" xyz="0 0 0"/>
    </collision>
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.08"/>
    </inertial>
  </link>
</robot>
"""
ZERO = 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"'
BASE_INERTIA = 'ixx="0.042" ixy="0" ixz="0" iyy="0.071" iyz="0" izz="0.104"'
WHEEL_INERTIA = 'ixx="0.00087" ixy="0" ixz="0" iyy="0.00087" iyz="0" izz="0.0016"'
INERTIAL = re.compile(r"<inertial>.*?</inertial>", re.DOTALL)


def swap(text: str, old: str | re.Pattern[str], new: str) -> str:
    """The text with the first of it changed, which must be there."""
    pattern = re.compile(re.escape(old)) if isinstance(old, str) else old
    changed, count = pattern.subn(lambda _: new, text, count=1)
    assert count == 1
    return changed


def diagnose(text: str | bytes, file: Path) -> list[Diagnostic]:
    context = PrepareContext(share_of=lambda _: None, folder=file.parent, run=parent.run)
    return list(prepare_robot(text, file=file, context=context)[1])


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ('<mass value="5"/>', '<mass value="5,0"/>', "ROB016", 6),
        ('<mass value="5"/>', '<mass value="5 kg"/>', "ROB016", 6),
        ('<mass value="0.5"/>', '<mass value="0,5"/>', "ROB016", 20),
        ('xyz="0.1 0.18 0"', 'xyz="0,1 0,18 0"', "ROB016", 11),
        ('<box size="0.4 0.3', '<box size="0,4 0.3', "ROB016", 3),
        ('ixx="0.00087"', 'ixx="0,00087"', "ROB016", 21),
        (INERTIAL, "<inertial/>", "ROB021", 5),
        ('<mass value="0.5"/>', "", "ROB021", 19),
        (f"<inertia {WHEEL_INERTIA}/>", "", "ROB021", 19),
        ('<mass value="5"/>', '<mass value="-5"/>', "ROB022", 6),
        ('<mass value="0.5"/>', '<mass value="-0.5"/>', "ROB022", 20),
        ('<mass value="0.5"/>', '<mass value="0"/>', "ROB040", 16),
        ('<mass value="5"/>', '<mass value="1e30"/>', "ROB056", 2),
        (BASE_INERTIA, ZERO, "ROB037", 2),
        (WHEEL_INERTIA, ZERO, "ROB037", 16),
        ('izz="0.0016"', 'izz="1.6"', "ROB037", 16),
        ('ixx="0.042"', 'ixx="-0.042"', "ROB037", 2),
        ('<mass value="5"/>', '<mass value="5000000"/>', "ROB049", 2),
        ("<cylinder radius", "<cylinder radious", "ROB077", 17),
        ("<box size", "<box sise", "ROB077", 3),
        ("<mass value", "<mass valeu", "ROB077", 6),
        ('izz="0.104"', 'izx="0.104"', "ROB077", 7),
        ('type="continuous"', 'tpye="continuous"', "ROB077", 10),
        ('<link name="right', '<link nmae="right', "ROB077", 30),
        ('<joint name="right', '<joint nmae="right', "ROB077", 24),
        ('<parent link="base', '<parent lnik="base', "ROB077", 12),
        ('xyz="0.1 0.18 0"', 'xzy="0.1 0.18 0"', "ROB077", 11),
        ('rpy="0 0 0"', 'ryp="0 0 0"', "ROB077", 11),
        ('<axis xyz="0 1 0"/>', '<axis xzy="0 1 0"/>', "ROB077", 14),
        ('length="0.04"', 'height="0.04"', "ROB077", 17),
        ('<parent link="base', '<parent name="base', "ROB077", 12),
        ("<mass value", "<mass kg", "ROB077", 6),
        ("<mu1>0.8</mu1>", "<mul>0.8</mul>", "ROB038", 38),
        ("<box ", "<bx ", "ROB038", 3),
        ('<axis xyz="0 1 0"/>', '<axsi xyz="0 1 0"/>', "ROB038", 14),
        ("<parent ", "<paretn ", "ROB038", 12),
        (re.compile(r"geometry>(.*?)</geometry"), "geometri></geometri", "ROB038", 3),
        (re.compile(r"inertial>(.*?)</inertial", re.DOTALL), "inertal></inertal", "ROB038", 5),
    ],
)
def test_rover(tmp_path: Path, old: str | re.Pattern[str], new: str, code: str, line: int) -> None:
    file = tmp_path / "rover.urdf"
    assert diagnose(ROVER.encode(), file) == []
    found = diagnose(swap(ROVER, old, new).encode(), file)
    assert [(one.code, one.line) for one in found] == [(code, line)]


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ('name="length" value="0.5"', 'name="length" value="0,5"', "ROB016", 2),
        ('<mass value="1"/>', '<mass value="1,0"/>', "ROB016", 24),
        ('ixx="0.06"', 'ixx="0,06"', "ROB016", 25),
        (INERTIAL, "<inertial></inertial>", "ROB021", 23),
        (INERTIAL, "", "ROB040", 9),
        ('<mass value="1"/>', '<mass value="-1"/>', "ROB022", 24),
        ('<mass value="1"/>', '<mass value="0"/>', "ROB040", 9),
        ('ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.08"', ZERO, "ROB037", 25),
        ('izz="0.08"', 'izz="8"', "ROB037", 25),
        ("<cylinder length", "<cylinder lenght", "ROB077", 12),
        ('radius="${radius}"', 'raduis="${radius}"', "ROB077", 13),
        ('xyz="0 0 0"', 'xzy="0 0 0"', "ROB077", 21),
    ],
)
def test_a_root_that_nobody_gave_a_mass(
    tmp_path: Path, old: str | re.Pattern[str], new: str, code: str, line: int
) -> None:
    """The diagnostic names the link that is written, at its line in the xacro file."""
    file = tmp_path / "robot.xacro"
    file.write_text(swap(LUMPED, old, new))
    result = expand(file, {})
    assert result.code == 0
    found = [one for one in diagnose(result.stdout, file) if one.code != "ROB051"]
    assert [(one.code, one.line, one.file) for one in found] == [(code, line, file)]
    assert "dummy" not in (found[0].element or "")


def test_what_is_lost_is_reported_with_the_cause(tmp_path: Path) -> None:
    text = swap(ROVER, '<mass value="5"/>', '<mass valeu="5"/>')
    (found,) = diagnose(text.encode(), tmp_path / "rover.urdf")
    assert found.severity is Severity.ERROR
    assert found.hint == "Did you mean `value`?"
    assert found.message == (
        "`valeu` is not an attribute of <mass>: `value` is missing. Gazebo's parser stops reading "
        "the link there and drops 1 visual and 1 collision."
    )


def test_two_mistakes_are_two_diagnostics(tmp_path: Path) -> None:
    text = swap(ROVER, '<mass value="5"/>', '<mass value="5,0"/>')
    text = swap(text, '<mass value="0.5"/>', '<mass value="-0.5"/>')
    found = diagnose(text.encode(), tmp_path / "rover.urdf")
    assert [one.code for one in found] == ["ROB016", "ROB022"]


WHEEL = ROVER[ROVER.index('<link name="left_wheel">') :]
WHEEL_INERTIAL = WHEEL[WHEEL.index("<inertial>") : WHEEL.index("</inertial>") + len("</inertial>")]


def test_what_gazebo_drops_for_a_misspelling_is_an_error_about_that(tmp_path: Path) -> None:
    misspelled = WHEEL_INERTIAL.replace("inertial", "intertial")
    text = swap(ROVER, WHEEL_INERTIAL, misspelled)
    (found,) = diagnose(text.encode(), tmp_path / "rover.urdf")
    assert (found.code, found.severity) == ("ROB038", Severity.ERROR)
    assert "drops the link `left_wheel`" in found.message
    assert found.hint == "Did you mean <inertial>?"


def test_no_misspelling_hides_what_gazebo_drops(tmp_path: Path) -> None:
    without = swap(ROVER, WHEEL_INERTIAL, "")
    place = without.index('<link name="left_wheel">')
    text = without[:place] + swap(without[place:], "<visual>", '<visual nam="v">')
    found = diagnose(text.encode(), tmp_path / "rover.urdf")
    assert [(one.code, one.severity) for one in found] == [
        ("ROB077", Severity.WARNING),
        ("ROB040", Severity.ERROR),
    ]


@pytest.mark.parametrize("other", ['<link name="extra"/>', '<frame name="extra"/>', "<include/>"])
def test_a_joint_of_sdf_to_what_gazebo_adds(tmp_path: Path, other: str) -> None:
    joint = "<joint name='j' type='fixed'><parent>base_link</parent><child>extra</child></joint>"
    text = swap(ROVER, "</robot>", f"<gazebo>{other}{joint}</gazebo></robot>")
    found = diagnose(text.encode(), tmp_path / "rover.urdf")
    assert "ROB078" not in {one.code for one in found}
    alone = diagnose(text.replace(other, "").encode(), tmp_path / "rover.urdf")
    assert "ROB078" in {one.code for one in alone}


# A rover that stands, so that whatever its run reports comes from the mistake.
WHEELS = {"fl": (0.15, 0.18), "fr": (0.15, -0.18), "rl": (-0.15, 0.18), "rr": (-0.15, -0.18)}
CYLINDER = '<origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.08" length="0.04"/></geometry>'
BODY = '<origin xyz="0 0 0.1"/><geometry><box size="0.4 0.3 0.1"/></geometry>'
CAR = f"""<robot name="car">
  <link name="base_link">
    <visual>{BODY}</visual>
    <collision>{BODY}</collision>
    <inertial>
      <origin xyz="0 0 0.1" rpy="0 0 0"/>
      <mass value="5"/>
      <inertia {BASE_INERTIA}/>
    </inertial>
  </link>
{
    "".join(
        f'''  <joint name="{name}_joint" type="continuous">
    <origin xyz="{x} {y} 0.08" rpy="0 0 0"/>
    <parent link="base_link"/>
    <child link="{name}_wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="{name}_wheel">
    <visual>{CYLINDER}</visual>
    <collision>{CYLINDER}</collision>
    <inertial>
      <mass value="0.5"/>
      <inertia ixx="0.00087" ixy="0" ixz="0" iyy="0.0016" iyz="0" izz="0.00087"/>
    </inertial>
  </link>
'''
        for name, (x, y) in WHEELS.items()
    )
}  <joint name="lift_joint" type="prismatic">
    <origin xyz="0 0 0.16" rpy="0 0 0"/>
    <parent link="base_link"/>
    <child link="lift"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.2" effort="10" velocity="1"/>
    <dynamics damping="1.0" friction="0.1"/>
  </joint>
  <link name="lift">
    <visual><geometry><box size="0.1 0.1 0.02"/></geometry></visual>
    <collision><geometry><box size="0.1 0.1 0.02"/></geometry></collision>
    <inertial>
      <mass value="0.2"/>
      <inertia ixx="0.0002" ixy="0" ixz="0" iyy="0.0002" iyz="0" izz="0.00033"/>
    </inertial>
  </link>
</robot>
"""
BOX = """<robot name="box">
  <link name="base_link">
    <visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.0067" ixy="0" ixz="0" iyy="0.0067" iyz="0" izz="0.0067"/>
    </inertial>
  </link>
</robot>
"""
SDF_BOX = "<geometry><box><size>0.2 0.2 0.2</size></box></geometry>"
# One box fixed on another.
SDF = f"""<sdf version="1.7"><model name="table">
  <link name="top">
    <pose>0 0 0.5 0 0 0</pose>
    <visual name="v">{SDF_BOX}</visual>
    <collision name="c">{SDF_BOX}</collision>
    <inertial>
      <mass>1</mass>
      <inertia><ixx>0.0067</ixx><iyy>0.0067</iyy><izz>0.0067</izz></inertia>
    </inertial>
  </link>
  <link name="foot">
    <pose>0 0 0.1 0 0 0</pose>
    <visual name="v">{SDF_BOX}</visual>
    <collision name="c">{SDF_BOX}</collision>
    <inertial>
      <mass>1</mass>
      <inertia><ixx>0.0067</ixx><iyy>0.0067</iyy><izz>0.0067</izz></inertia>
    </inertial>
  </link>
  <joint name="j" type="fixed"><parent>foot</parent><child>top</child></joint>
</model></sdf>
"""


def validate(text: str, file: Path, engines: Sequence[str] = ("bullet",)) -> list[Diagnostic]:
    """What the file is told after a run in PyBullet: it explodes where MuJoCo bears much."""
    pytest.importorskip("pybullet")
    file.write_text(text)
    overlay = Overlay(install=file.parent, environment=dict(os.environ), prefixes=())
    request = ValidateRequest(files=[file], engines=engines)
    run = FileValidation(file, overlay, request, None, parent.run, name=file.stem).run()
    return list(run.diagnostics)


COLLISION = re.compile(r"<collision.*?</collision>")
HUGE_BODY = '<box size="400 300 100"/>'


@pytest.mark.slow
def test_what_stands(tmp_path: Path) -> None:
    assert validate(CAR, tmp_path / "car.urdf") == []
    assert validate(BOX, tmp_path / "box.urdf") == []
    assert validate(SDF, tmp_path / "table.sdf") == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "code", "severity", "line"),
    [
        ('<mass value="5"/>', '<mass value="5000000"/>', "ROB049", Severity.ERROR, 2),
        # It is unstable in PyBullet alone.
        ('<mass value="0.5"/>', '<mass value="5e6"/>', "ROB049", Severity.WARNING, 2),
        ('<mass value="5"/>', '<mass value="5000"/>', "ROB118", Severity.ERROR, 2),
        ('<box size="0.4 0.3 0.1"/>', HUGE_BODY, "ROB048", Severity.WARNING, 2),
        (
            f"<collision>{BODY}",
            f"<collision>{BODY.replace('0.4 0.3 0.1', '400 300 100')}",
            "ROB048",
            Severity.ERROR,
            2,
        ),
        ('xyz="0.15 0.18 0.08"', 'xyz="150 180 80"', "ROB048", Severity.ERROR, 2),
        (BASE_INERTIA, ZERO, "ROB037", Severity.WARNING, 2),
        ('iyy="0.0016"', 'iyy="1.6"', "ROB037", Severity.ERROR, 17),
        ('lower="0" upper="0.2"', 'lower="0.2" upper="0"', "ROB023", Severity.WARNING, 72),
        ('lower="0" upper="0.2"', 'lower="0.1" upper="0.2"', "ROB070", Severity.INFO, 67),
        ('lower="0" upper="0.2"', 'lower="-2" upper="-1"', "ROB070", Severity.ERROR, 67),
        ('<origin xyz="0.15 0.18', '<orgin xyz="0.15 0.18', "ROB038", Severity.ERROR, 12),
        ('xyz="0.15 0.18', 'xzy="0.15 0.18', "ROB077", Severity.ERROR, 12),
        ("<visual>", "<visaul/><visual>", "ROB038", Severity.WARNING, 3),
        ("prismatic", "floating", "ROB055", Severity.WARNING, 67),
        ('xyz="0 0 1"', 'xyz="0 0 0"', "ROB018", Severity.ERROR, 71),
        ('<box size="0.4', '<box size="0', "ROB028", Severity.WARNING, 3),
        (
            BODY,
            BODY.replace("box size", "mesh filename"),
            "ROB061",
            Severity.WARNING,
            2,
        ),
        ('effort="10"', 'effort="0"', "ROB082", Severity.WARNING, 72),
    ],
)
def test_rover_in_its_run(  # noqa: PLR0917  the facts of a case
    tmp_path: Path,
    old: str,
    new: str,
    code: str | None,
    severity: Severity | None,
    line: int | None,
) -> None:
    found = validate(swap(CAR, old, new), tmp_path / "car.urdf")
    expected = [] if code is None else [(code, severity, line)]
    assert [(one.code, one.severity, one.line) for one in found] == expected


@pytest.mark.slow
@pytest.mark.parametrize("engines", [("bullet",), ("bullet", "dart")])
@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        (COLLISION, "", "ROB053"),
        (COLLISION, "<colision/>", "ROB038"),
        ('<mass value="1"/>', '<mass value="5000000"/>', "ROB049"),
    ],
)
def test_box_in_its_run(
    tmp_path: Path, old: str | re.Pattern[str], new: str, code: str, engines: tuple[str, ...]
) -> None:
    if "dart" in engines:
        pytest.importorskip("dartpy")
    (found,) = validate(swap(BOX, old, new), tmp_path / "box.urdf", engines)
    assert (found.code, found.severity) == (code, Severity.ERROR)
    assert re.search("In the simulation, the robot|In PyBullet: The robot", found.message)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "code", "severity", "line"),
    [
        (INERTIAL, "", "WLD035", Severity.WARNING, 2),
        (INERTIAL, "<inertal/>", "ROB038", Severity.WARNING, 6),
        ("<mass>1</mass>", "<mass>0</mass>", "WLD041", Severity.WARNING, 6),
        ("<mass>1</mass>", "<mass>-1</mass>", "ROB022", Severity.ERROR, 6),
        ("<mass>1</mass>", "<mass>1,0</mass>", "ROB016", Severity.ERROR, 7),
        ("<ixx>0.0067", "<ixx>6.7", "ROB037", Severity.ERROR, 6),
        ("<parent>foot", "<parent>feet", "ROB013", Severity.ERROR, 20),
        ("<pose>0 0 0.1 0 0 0</pose>", "<pse>0 0 0.1 0 0 0</pse>", "ROB038", None, 12),
    ],
)
def test_model_of_sdf_in_its_run(  # noqa: PLR0917  the facts of a case
    tmp_path: Path,
    old: str | re.Pattern[str],
    new: str,
    code: str,
    severity: Severity | None,
    line: int | None,
) -> None:
    (found,) = validate(swap(SDF, old, new), tmp_path / "table.sdf")
    assert (found.code, found.line) == (code, line)
    assert severity in {None, found.severity}


def test_a_length_that_may_be_twice_a_radius_is_no_misspelling(tmp_path: Path) -> None:
    text = swap(ROVER, "<cylinder radius=", "<cylinder diameter=")
    assert "ROB016" in {one.code for one in diagnose(text.encode(), tmp_path / "rover.urdf")}


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ('xyz="0.1 0.18 0"', 'xyz="0,1 0,18 0"', 'Write xyz="0.1 0.18 0".'),
        ('xyz="0.1 0.18 0"', 'xyz="0.1, 0.18, 0"', 'Write xyz="0.1 0.18 0".'),
        ("<mu1>0.8</mu1>", "<mu1>0,8</mu1>", "Write 0.8."),
        (
            '<mass value="0.5"/>',
            '<mass value="0"/>',
            "Write the mass of `left_wheel` in kilograms.",
        ),
    ],
)
def test_the_hint_says_what_to_write(tmp_path: Path, old: str, new: str, hint: str) -> None:
    found = diagnose(swap(ROVER, old, new).encode(), tmp_path / "rover.urdf")
    assert any((one.hint or "").startswith(hint) for one in found), [one.hint for one in found]


def test_a_loose_part_is_named_and_not_the_robot(tmp_path: Path) -> None:
    lone = '<robot name="rover"><link name="laser"/>'
    found = diagnose(swap(ROVER, '<robot name="rover">', lone).encode(), tmp_path / "rover.urdf")
    assert [(one.code, one.hint) for one in found] == [
        ("ROB009", "Add a joint whose child is `laser`.")
    ]


def test_a_macro_without_its_prefix_explains_what_gazebo_drops(tmp_path: Path) -> None:
    macro = """<robot name="rover" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="weight"><inertial><mass value="1"/></inertial></xacro:macro>"""
    text = swap(ROVER, INERTIAL, "<weight/>")
    text = swap(text, '<robot name="rover">', macro)
    file = tmp_path / "rover.xacro"
    file.write_text(text)
    reported = diagnose(expand(file, {}).stdout, file)
    (found,) = [one for one in reported if one.severity is Severity.ERROR]
    assert (found.code, found.line) == ("ROB115", 6)
    assert "Gazebo refuses the robot" in found.message
