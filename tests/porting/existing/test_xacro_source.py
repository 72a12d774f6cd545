"""Xacro files of sources that need what is not there: what `--fix` does, and what is said else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.errors import NotReadableError
from wsgen.porting.existing.sources import open_source
from wsgen.porting.existing.xacro_source import Expanded, expand_source, refuse_macros

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow

ROBOT = """<robot name="rover" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="body"/>
  {}
</robot>
"""
INCLUDE = '<xacro:include filename="$(find nowhere)/urdf/laser.xacro"/>'
ARGUMENT = '<link name="$(arg prefix)$(arg side)_wheel"/>'
LAUNCH = """<launch>
  <arg name="side" default="left"/>
  <arg name="where" default="$(arg side)"/>
  <arg name="file" default="$(find {})/urdf/rover.xacro"/>
  <param name="robot_description"
    command="$(find xacro)/xacro '$(arg file)' prefix:= side:=$(arg where) speed:=$(arg fast)"/>
</launch>
"""


def expand(folder: Path, inside: str, launch: str = "", *, fixes: bool = False) -> Expanded:
    """The robot of a package beside one that starts it."""
    for name in ("rover", "bringup"):
        (folder / name / "launch").mkdir(parents=True)
        (folder / name / "package.xml").write_text(
            f"<package><name>{name}</name><buildtool_depend>catkin</buildtool_depend></package>"
        )
    (folder / "rover" / "urdf").mkdir(exist_ok=True)
    (folder / "rover" / "urdf" / "rover.xacro").write_text(ROBOT.format(inside))
    (folder / "bringup" / "launch" / "start.launch").write_text(launch or "<launch/>")
    source = open_source(str(folder / "rover"), folder / "scratch", os.environ)
    return expand_source(source, {}, os.environ, folder / "scratch", fixes=fixes)


def test_what_is_included_from_nowhere_is_left_out(tmp_path: Path) -> None:
    found = expand(tmp_path, INCLUDE, fixes=True)
    assert found.text is not None
    assert '<link name="body"/>' in found.text
    assert found.fixes == (
        "Left out what is included from the package `nowhere`, which was not found.",
    )


BESIDE = "Put the package `nowhere` beside this one, or source a workspace that has it. "
LEFT_OUT = "Or add --fix, which leaves out what is included from it if nothing uses that."
IS_USED = "What is included from it is used: it cannot be left out."


@pytest.mark.parametrize(
    ("call", "fixes", "hint"),
    [("", False, BESIDE + LEFT_OUT), ("<xacro:laser/>", True, BESIDE + IS_USED)],
)
def test_what_is_included_from_nowhere_is_said(
    tmp_path: Path, call: str, fixes: bool, hint: str
) -> None:
    found = expand(tmp_path, INCLUDE + call, fixes=fixes)
    assert found.text is None
    assert "the package 'nowhere' is not found" in found.found[-1].message
    assert found.found[-1].hint == hint


def test_arguments_are_those_of_a_launch_file(tmp_path: Path) -> None:
    found = expand(tmp_path, ARGUMENT, LAUNCH.format("rover"), fixes=True)
    assert found.text is not None
    assert '<link name="left_wheel"/>' in found.text
    assert found.arguments == {"prefix": "", "side": "left"}
    assert found.notes[1] == (
        "Gave xacro the argument `side:=left`, as bringup/launch/start.launch does."
    )


GIVEN = "bringup/launch/start.launch gives it: add --arg side:=left, or --fix."


@pytest.mark.parametrize(
    ("argument", "package", "fixes", "hint"),
    [
        ("side", "rover", False, GIVEN),
        ("fast", "rover", True, "Give it: add --arg fast:=VALUE."),
        ("side", "another", True, "Give it: add --arg side:=VALUE."),
    ],
)
def test_arguments_without_a_value_are_said(
    tmp_path: Path, argument: str, package: str, fixes: bool, hint: str
) -> None:
    link = f'<link name="$(arg {argument})"/>'
    found = expand(tmp_path, link, LAUNCH.format(package), fixes=fixes)
    assert found.text is None
    assert found.found[-1].hint == hint


FILE = "xacro $(find rover)/urdf/rover.xacro"
ODD = [
    "<launch><param",
    f'<launch><param command="{FILE} \'side:=1"/></launch>',
    f"""<launch><arg name="side" default="$(arg side)$(arg side)"/>
    <param command="{FILE} side:=$(arg side)"/></launch>""",
]


def test_the_file_that_includes_a_part_is_named(tmp_path: Path) -> None:
    whole = tmp_path / "rover" / "urdf" / "whole.xacro"
    whole.parent.mkdir(parents=True)
    whole.write_text('<robot xmlns:xacro="x"><xacro:include filename="rover.xacro"/></robot>')
    source = tmp_path / "rover" / "urdf" / "rover.xacro"
    source.write_text(ROBOT.format('<link name="$(arg side)"/>'))
    opened = open_source(str(source), tmp_path / "scratch", os.environ)
    found = expand_source(opened, {}, os.environ, tmp_path / "scratch", fixes=True)
    assert found.found[-1].hint == (
        f"Give it: add --arg side:=VALUE. Or give the file that includes this one: --from {whole}"
    )


@pytest.mark.parametrize("launch", ODD)
def test_odd_launch_files_give_nothing(tmp_path: Path, launch: str) -> None:
    found = expand(tmp_path, '<link name="$(arg side)"/>', launch, fixes=True)
    assert found.found[-1].hint == "Give it: add --arg side:=VALUE."


CALLED = '<xacro:wheel side="left"/><xacro:include filename="more.xacro"/>'
MACRO = '<xacro:macro name="wheel" params="side"><link name="${side}"/></xacro:macro>'


@pytest.mark.parametrize("fixes", [True, False])
def test_macros_may_be_below_their_calls(tmp_path: Path, fixes: bool) -> None:
    """xacro read all macros first before ROS Noetic."""
    (tmp_path / "rover" / "urdf").mkdir(parents=True)
    (tmp_path / "rover" / "urdf" / "more.xacro").write_text(ROBOT.format('<link name="more"/>'))
    found = expand(tmp_path, f"{CALLED}\n{MACRO}", fixes=fixes)
    if fixes:
        assert found.text is not None
        assert found.text.index('"left"') < found.text.index('"more"')
        assert found.fixes == (
            "Moved the macros above their calls, as xacro read them before ROS Noetic.",
        )
    else:
        assert found.text is None
        assert found.found[-1].hint == (
            "Move line 4 of rover.xacro, which defines it, above its first use. Or add --fix, "
            "which does it."
        )


def test_a_file_of_macros_is_no_robot(tmp_path: Path) -> None:
    found = expand(tmp_path, "")
    assert found.text is not None
    file = tmp_path / "rover" / "urdf" / "rover.xacro"
    file.write_text(f'<robot xmlns:xacro="x">{MACRO}<xacro:macro name="other"/></robot>')
    source = open_source(str(file), tmp_path / "scratch", os.environ)
    refuse_macros(source, "<robot><link/></robot>")
    with pytest.raises(NotReadableError) as stop:
        refuse_macros(source, "<robot/>")
    assert stop.value.hint == (
        'Write a file that includes this one, and <xacro:wheel side=""/>; give that.'
    )
    caller = file.with_name("caller.xacro")
    caller.write_text(ROBOT.format(CALLED))
    with pytest.raises(NotReadableError) as stop:
        refuse_macros(source, "<robot/>")
    assert stop.value.message.endswith(
        "defines the macro `wheel`, and calls none: it has no robot."
    )
    assert stop.value.hint == f"Give a file that calls it: --from {caller}"


def test_what_another_package_is_to_have_is_taken_from_the_source(tmp_path: Path) -> None:
    """A package that was renamed, and a folder of one that was taken out of it."""
    for include in ("urdf/wheel.xacro", "src/robot/urdf/wheel.xacro"):
        folder = tmp_path / include.replace("/", "_")
        (folder / "rover" / "urdf").mkdir(parents=True)
        (folder / "rover" / "urdf" / "wheel.xacro").write_text(
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">'
            '<xacro:include filename="more.xacro"/></robot>'
        )
        (folder / "rover" / "urdf" / "more.xacro").write_text('<robot><link name="w"/></robot>')
        named = f'<xacro:include filename="$(find old)/{include}"/>'
        found = expand(folder, f"{named}\n  {INCLUDE}", fixes=True)
        assert found.text is not None
        assert '<link name="w"/>' in found.text
        taken, left_out = found.fixes
        assert taken.startswith("Took wheel.xacro of the source for what the package `old`, which")
        assert left_out == (
            "Left out what is included from the package `nowhere`, which was not found."
        )
        assert sorted(one.name for one in (folder / "rover").rglob("*.xacro")) == [
            "more.xacro",
            "rover.xacro",
            "wheel.xacro",
        ]


def test_a_path_of_another_computer_is_named(tmp_path: Path) -> None:
    (tmp_path / "rover" / "urdf").mkdir(parents=True)
    (tmp_path / "rover" / "urdf" / "part.xacro").write_text("<robot/>")
    found = expand(tmp_path, '<xacro:include filename="/home/ada/gone/part.xacro"/>', fixes=True)
    assert found.text is None
    (error,) = found.found
    assert error.hint == f"Write the name of {tmp_path}/rover/urdf/part.xacro instead."
