"""Fixes in URDF and SDF: what the readers report is gone, and nothing else has changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.checks.fixes.plan import plan_fixes, write_fixes
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.descriptions.urdf.reader import read_urdf

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

LINKS = '<link name="base_link"/><link name="arm"/>'
JOINT = """<joint name="j" type="revolute">
    <parent link="base_link"/>
    <child link="arm"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>"""
INERTIAL = """<inertial>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>"""

# The rule, a part of a robot, and how it is written then.
CASES = [
    ("unnormalized-axis", JOINT.replace("<limit", '<axis xyz="0 0 2"/>\n    <limit'), '"0 0 1"'),
    ("unnormalized-axis", JOINT.replace("<limit", "<axis xyz='0 -3  4'/><limit"), "'0 -0.6 0.8'"),
    ("swapped-limits", JOINT.replace("-1", "2.50"), 'lower="1" upper="2.50"'),
    ("unknown-joint-type", JOINT.replace("revolute", "Revolut"), 'type="revolute"'),
    ("unknown-link", JOINT.replace("base_link", "base_lnk"), '<parent link="base_link"/>'),
    (
        "color-out-of-range",
        '<material name="m"><color rgba="255 128 0 1.0"/></material>',
        'rgba="1 0.502 0 1.0"',
    ),
    (
        "duplicate-material",
        (
            '<material name="m"><color rgba="1 0 0 1"/></material>\n'
            '  <material name="m">\n    <color rgba="1 0 0 1"/>\n  </material>\n'
        ),
        '\n  <material name="m"><color rgba="1 0 0 1"/></material>\n\n',
    ),
    (
        "unknown-gazebo-material",
        '<gazebo reference="arm">\n    <material> Gazebo/red </material>\n  </gazebo>',
        "<material> Gazebo/Red </material>",
    ),
    ("unknown-reference", '<gazebo reference="amr"><mu1>1</mu1></gazebo>', 'reference="arm"'),
    (
        "gazebo-not-a-boolean",
        '<gazebo reference="arm"><gravity>off</gravity></gazebo>',
        "<gravity>false</gravity>",
    ),
    ("gazebo-not-a-number", '<gazebo reference="arm"><mu1>0,2</mu1></gazebo>', "<mu1>0.2</mu1>"),
    ("not-a-number", '<link name="b"><visual><origin xyz="0,1 0 0,5"/>{}', 'xyz="0.1 0 0.5"'),
    ("not-a-number", '<link name="b"><visual><origin xyz="0, 0, 0.5"/>{}', 'xyz="0 0 0.5"'),
    ("not-a-number", '<link name="b"><visual><origin xyz="0,0,0.5"/>{}', 'xyz="0 0 0.5"'),
    (
        "misspelled-element",
        f'<link name="b">{INERTIAL.replace("inertial", "inertail")}</link>',
        INERTIAL,
    ),
    ("misspelled-attribute", '<link name="b"><visual><origin xzy="0 0 1"/>{}', 'origin xyz="0 0'),
]
BOX = "<geometry><box size='1 1 1'/></geometry></visual></link>"


def read(file: Path) -> tuple[Diagnostic, ...]:
    if file.suffix == ".urdf":
        return read_urdf(file.read_bytes(), file=file)[1]
    return tuple(read_sdf(file, find_model=lambda _: None).diagnostics)


def fix(file: Path, name: str) -> str:
    """The fixed text; only this rule is fixed."""
    found = [one for one in read(file) if one.name == name]
    assert found, [(one.name, one.message) for one in read(file)]
    plan = plan_fixes(found, [file.parent])
    assert not plan.refused
    assert [*write_fixes(plan)] == [file]
    assert name not in {one.name for one in read(file)}
    return file.read_bytes().decode()


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize(("name", "part", "fixed"), CASES, ids=[case[0] for case in CASES])
def test_a_part_of_a_robot(tmp_path: Path, name: str, part: str, fixed: str, newline: str) -> None:
    file = tmp_path / "robot.urdf"
    part = part.replace("{}", BOX)
    text = f'<?xml version="1.0"?>\n<robot name="r"><!-- axis="0 0 2" -->\n  {part}\n  {LINKS}\n'
    file.write_bytes((f"{text}</robot>\n").replace("\n", newline).encode("utf-8-sig"))
    after = fix(file, name)
    assert fixed.replace("\n", newline) in after
    assert after.startswith("\ufeff<?xml")
    assert '<!-- axis="0 0 2" -->' in after
    assert after.count("\n") - after.count("\r\n") in {0, after.count("\n")}
    assert not plan_fixes(read(file), [tmp_path]).files or name not in {
        one.name for one in plan_fixes(read(file), [tmp_path]).fixed
    }


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        (
            "unknown-urdf-version",
            '<robot name="r" version="2.0">',
            '<robot name="r" version="1.0">',
        ),
        ("unnamed-robot", "<robot>", '<robot name="my_arm">'),
        ("unnamed-robot", "<robot name=''>", "<robot name='my_arm'>"),
    ],
)
def test_the_root_of_a_robot(tmp_path: Path, name: str, before: str, after: str) -> None:
    file = tmp_path / "my-arm.urdf.xacro.urdf"
    rest = f"\n  {LINKS}{JOINT}</robot>"
    file.write_text(before + rest)
    assert fix(file, name) == after + rest


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("<!-- a -- b --->\n", "<!-- a - b -->\n"),
        ("<link name='a & b'/>", "<link name='a &amp; b'/>"),
        ('<link name="b"><visual></visaul></link>', '<link name="b"><visual></visual></link>'),
    ],
)
def test_xml(tmp_path: Path, before: str, after: str) -> None:
    file = tmp_path / "robot.urdf"
    head, rest = "<robot name='r'>\n  ", f"\n{LINKS}{JOINT}</robot>"
    file.write_text(head + before + rest)
    assert fix(file, "malformed-xml") == head + after + rest


@pytest.mark.parametrize(
    ("before", "after"),
    [("<sdf>", '<sdf version="1.6">'), ("<sdf version='new' >", "<sdf version='1.6' >")],
)
def test_sdf_version(tmp_path: Path, before: str, after: str) -> None:
    file = tmp_path / "world.sdf"
    rest = "\n<world name='w'/>\n</sdf>"
    file.write_text(before + rest)
    assert fix(file, "no-sdf-version") == after + rest


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("unnormalized-axis", JOINT.replace("<limit", '<axis xyz="0 0 ${length}"/><limit')),
        ("unknown-link", JOINT.replace("base_link", "wheel")),
        ("color-out-of-range", '<material name="m"><color rgba="1.5 0 0 1"/></material>'),
        ("not-a-number", '<link name="b"><visual><origin xyz="0,1 0"/>{}'),
        ("gazebo-not-a-number", '<gazebo reference="arm"><mu1>low</mu1></gazebo>'),
        (
            "duplicate-material",
            (
                '<material name="m"><color rgba="1 0 0 1"/></material>'
                '<material name="m"><color rgba="0 0 1 1"/></material>'
            ),
        ),
    ],
)
def test_what_is_not_certain_stays(tmp_path: Path, name: str, part: str) -> None:
    file = tmp_path / "robot.urdf"
    text = f'<robot name="r">\n{part.replace("{}", BOX)}\n{LINKS}</robot>'
    file.write_text(text)
    found = [one for one in read(file) if one.name in (name, "unexpanded-xacro")]
    assert found
    assert not plan_fixes(found, [tmp_path]).files
    assert file.read_text() == text
