"""The rule over the sizes in diff drive plugins, with texts of robots."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdf_texts import MASS, link, robot
from wsgen.checks.rules.drives import check_drive, check_drive_controller
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Severity
from wsgen.text import yamlfile

FILE = Path("robot.urdf")
MESH = "<mesh filename='wheel.stl'/>"


def drive(
    *sizes: str,
    shape: str = "<cylinder radius='0.1' length='0.05'/>",
    name: str = "gz-sim-diff-drive-system",
    pairs: int = 1,
) -> str:
    """A robot whose wheels have a radius of 0.1 m and are 0.5 m apart."""
    parts = [link("base")]
    names = []
    for pair in range(pairs):
        for side, y in (("left", 0.2), ("right", -0.2)):
            wheel = f"{side}_{pair}"
            offset = 0.05 if side == "left" else -0.05  # of the tire from the joint
            tire = f"<origin xyz='0 {offset} 0' rpy='1.5708 0 0'/><geometry>{shape}</geometry>"
            parts += [
                link(wheel, f"{MASS}<collision>{tire}</collision>")
                + f"<joint name='{wheel}_joint' type='continuous'><parent link='base'/>"
                f"<child link='{wheel}'/><origin xyz='{-0.4 * pair} {y} 0'/><axis xyz='0 1 0'/>"
                "</joint>",
            ]
            names.append(f"<{side}_joint>{wheel}_joint</{side}_joint>")
    plugin = f"<plugin filename='{name}' name='d'>{''.join((*names, *sizes))}</plugin>"
    return robot("".join((*parts, f"<gazebo>{plugin}</gazebo>")))


def found_in(text: str) -> list[str]:
    written, _ = read_urdf(text, file=FILE)
    assert written is not None
    found = [*check_drive(written, FILE)]
    assert all((one.code, one.severity) == ("ROB134", Severity.WARNING) for one in found)
    assert all(one.line for one in found)
    return [one.hint or "" for one in found]


CLASSIC = "libgazebo_ros_diff_drive.so"


@pytest.mark.parametrize(
    ("text", "hints"),
    [
        (
            drive("<wheel_radius>0.2</wheel_radius>"),
            ["Write <wheel_radius>0.1</wheel_radius>."],
        ),
        (
            drive("<wheel_diameter>0.1</wheel_diameter>", name=CLASSIC),
            ["Write <wheel_diameter>0.2</wheel_diameter>."],
        ),
        (
            drive("<wheel_separation>0.25</wheel_separation>"),
            ["Write <wheel_separation>0.5</wheel_separation>."],
        ),
        (
            drive("<wheel_separation>2</wheel_separation><wheel_radius>9</wheel_radius>", pairs=2),
            [
                "Write <wheel_radius>0.1</wheel_radius>.",
                "Write <wheel_separation>0.5</wheel_separation>.",
            ],
        ),
        (
            drive("<wheel_radius>1</wheel_radius>", shape="<sphere radius='0.1'/>"),
            ["Write <wheel_radius>0.1</wheel_radius>."],
        ),
    ],
)
def test_other_sizes_than_those_of_the_wheels(text: str, hints: list[str]) -> None:
    assert found_in(text) == hints


@pytest.mark.parametrize(
    "text",
    [
        drive("<wheel_radius>0.1</wheel_radius><wheel_separation>0.5</wheel_separation>"),
        drive("<wheel_diameter>0.2</wheel_diameter>", name=CLASSIC),
        # Calibrated.
        drive("<wheel_radius>0.11</wheel_radius><wheel_separation>0.6</wheel_separation>"),
        # It slides sideways when it turns.
        drive("<wheel_separation>1.0</wheel_separation>", pairs=2),
        # What a mesh or a box measures is not known here.
        drive("<wheel_radius>0.5</wheel_radius><wheel_separation>3</wheel_separation>", shape=MESH),
        drive("<wheel_radius>0.5</wheel_radius>", shape="<box size='1 1 1'/>"),
        # The plugin has its own default.
        drive(),
        # It drives nothing.
        drive("<wheel_radius>0.5</wheel_radius>").replace("left_0_joint</left", "none</left"),
        drive("<wheel_radius>0.5</wheel_radius>", name="some_other_plugin"),
    ],
)
def test_sizes_that_may_be_right(text: str) -> None:
    assert found_in(text) == []


@pytest.mark.parametrize(
    ("parameters", "hints"),
    [
        ("wheel_radius: 0.1, wheel_separation: 0.5", []),
        ("wheel_radius: 0.01, wheel_separation: 0.5", ["Write wheel_radius: 0.1"]),
        ("wheel_radius: 0.1, wheel_separation: 0.25", ["Write wheel_separation: 0.5"]),
        ("wheel_separation: 0.25, wheel_separation_multiplier: 2.0", []),
        ("wheel_separation: $(var track)", []),
        ("wheel_radius: 0.001", ["Write sizes of the robot in meters: 0.001 for 0.1."]),
    ],
)
def test_parameters_of_a_controller(parameters: str, hints: list[str]) -> None:
    written, _ = read_urdf(drive(), file=FILE)
    names = "left_wheel_names: [left_0_joint], right_wheel_names: [right_0_joint]"
    values = yamlfile.parse(f"{{{names}, {parameters}}}")
    assert written is not None
    assert isinstance(values, yamlfile.Value)
    found = check_drive_controller(written, "drive", values, Path("controllers.yaml"))
    assert [one.hint for one in found] == hints


def sideways(text: str) -> list[tuple[str, str]]:
    written, _ = read_urdf(text, file=FILE)
    assert written is not None
    found = [one for one in check_drive(written, FILE) if one.code == "ROB144"]
    assert all(one.severity is Severity.ERROR and one.line for one in found)
    return [((one.element or "").split("'")[1], one.hint or "") for one in found]


@pytest.mark.parametrize(
    ("changed", "to", "hint"),
    [
        ("<axis xyz='0 1 0'/>", "", '<axis xyz="0 1 0"/>'),
        ("<axis xyz='0 1 0'/>", "<axis xyz='0 0 1'/>", '<axis xyz="0 1 0"/>'),
        # Turned upright, as cylinders are.
        ("'/><axis xyz='0 1 0'/>", "' rpy='-1.5708 0 0'/>", '<axis xyz="0 0 1"/>'),
        ("<axis xyz='0 1 0'/>", "<axis xyz='0 -1 0'/>", None),
        ("'/><axis xyz='0 1 0'/>", "' rpy='-1.5708 0 0'/><axis xyz='0 0 1'/>", None),
        ("'/><axis xyz='0 1 0'/>", "' rpy='0 0 1.5708'/>", None),  # x of a turned joint
    ],
)
def test_driven_wheels_that_roll_sideways(changed: str, to: str, hint: str | None) -> None:
    text = drive(shape="<sphere radius='0.1'/>")  # which rolls about any axis
    assert changed in text
    found = sideways(text.replace(changed, to))
    assert [joint for joint, _ in found] == (
        [] if hint is None else ["left_0_joint", "right_0_joint"]
    )
    assert all(hint in one for _, one in found if hint)


def test_wheels_of_a_controller_that_roll_sideways() -> None:
    written, _ = read_urdf(drive().replace("<axis xyz='0 1 0'/>", ""), file=FILE)
    assert written is not None
    file = Path("controllers.yaml")
    content = yamlfile.parse("left_wheel_names: [left_0_joint]\nright_wheel_names: [right_0_joint]")
    assert isinstance(content, yamlfile.Value)
    found = [*check_drive_controller(written, "drive", content, file)]
    assert [(one.code, one.file, one.line) for one in found] == [("ROB144", file, 1)] * 2
    lines = [joint.line for joint in written.joints if joint.name.endswith("_0_joint")]
    found = [*check_drive_controller(written, "drive", content, file, FILE)]
    assert [(one.file, one.line) for one in found] == [(FILE, line) for line in lines]


@pytest.mark.parametrize(
    ("origin", "axis", "hint"),
    [
        ("0 0 0", "0 1 0", 'Write rpy="1.5708 0 0" in the <origin> of its <collision>.'),
        ("0 1.5708 0", "0 1 0", 'Write rpy="1.5708 0 0" in the <origin> of its <collision>.'),
        ("1.5708 0 0", "0 1 0", None),
        ("-1.5 0 0.2", "0 -1 0", None),
    ],
)
def test_a_wheel_that_lies_across_its_axis(origin: str, axis: str, hint: str | None) -> None:
    text = drive().replace("<origin xyz='0 0.05 0' rpy='1.5708 0 0'/>", f"<origin rpy='{origin}'/>")
    written, _ = read_urdf(text.replace("0 1 0", axis), file=FILE)
    assert written is not None
    found = [*check_drive(written, FILE)]
    assert [one.hint for one in found] == ([] if hint is None else [hint])
    assert all(one.code == "ROB144" and "`left_0`" in one.message for one in found)


@pytest.mark.parametrize(("radius", "expected"), [("8", ["ROB145"]), ("2", [])])
def test_wheels_in_centimeters_of_a_robot_that_is_as_high(radius: str, expected: list[str]) -> None:
    text = drive(shape=f"<cylinder radius='{radius}' length='0.05'/>").replace(
        "<gazebo>",
        f"{link('low')}<joint name='j' type='fixed'><parent link='base'/>"
        f"<child link='low'/><origin xyz='0 0 -{radius}'/></joint><gazebo>",
    )
    written, _ = read_urdf(text, file=FILE)
    assert written is not None
    found = [*check_drive(written, FILE)]
    assert [one.code for one in found] == expected
    assert all("for 8 cm, write 0.08" in (one.hint or "") for one in found)
