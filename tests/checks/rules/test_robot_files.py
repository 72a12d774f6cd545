"""The rules over the files that a robot is written in."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.robot_files import path_of_one_machine, uncalled_macros, unprefixed_xacro
from wsgen.text.markup import Written, elements

FILE = Path("robot.xacro")


def written(body: str) -> list[Written]:
    return elements(FILE, f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n{body}\n</robot>')


@pytest.mark.parametrize(
    "address", ["file:///home/ada/base.stl", "/Users/ada/base.stl", "C:\\ada\\base.stl"]
)
def test_paths_of_one_machine(address: str) -> None:
    body = f'<link name="a"><visual>\n<mesh\nfilename="{address}"/></visual></link>'
    (found,) = path_of_one_machine(written(body), ())
    assert (found.code, found.line) == ("ROB114", 4)
    assert not list(path_of_one_machine(written(body), [address]))


@pytest.mark.parametrize(
    "address",
    [
        "package://my_robot/meshes/base.stl",
        "file://$(find my_robot)/meshes/base.stl",
        "meshes/base.stl",
        "/opt/ros/jazzy/share/ur_description/base.stl",
    ],
)
def test_addresses_that_are_right(address: str) -> None:
    assert not list(path_of_one_machine(written(f'<mesh filename="{address}"/>'), ()))


@pytest.mark.parametrize(
    "body",
    [
        '<property name="r" value="1"/>',
        '<macro name="wheel" params="p"/>',
        '<xacro:if value="1"><include filename="b.xacro"/></xacro:if>',
    ],
)
def test_xacro_without_its_prefix(body: str) -> None:
    (found,) = unprefixed_xacro(written(body))
    assert (found.code, found.line) == ("ROB115", 2)
    assert found.hint is not None
    assert "<xacro:" in found.hint


WHEEL = '<xacro:macro name="wheel" params="side"/><xacro:macro name="material" params="m"/>'


@pytest.mark.parametrize(
    "body",
    [
        '<wheel side="1"/>',
        '<link name="a"><wheel/></link>',
        '<xacro:if value="1"><wheel/></xacro:if>',
    ],
)
def test_a_macro_that_is_called_without_the_prefix(body: str) -> None:
    (found,) = unprefixed_xacro(written(WHEEL + body))
    assert (found.code, found.hint) == ("ROB115", "Write <xacro:wheel>.")


def test_elements_with_the_name_of_a_macro() -> None:
    body = '<material name="m"/><gazebo><sensor><wheel/></sensor></gazebo><xacro:wheel side="1"/>'
    assert not list(unprefixed_xacro(written(WHEEL + body)))


def test_what_only_looks_like_xacro() -> None:
    body = '<gazebo><include filename="x"/><plugin><property name="a" value="1"/></plugin></gazebo>'
    assert not list(unprefixed_xacro(written(f'{body}<property name="a"/>')))


def test_macros_that_are_never_called() -> None:
    macro = '<xacro:macro name="wheel" params="p"/>'
    (found,) = uncalled_macros(written(macro), FILE)
    assert (found.code, found.line) == ("ROB116", 2)
    for call in ("<xacro:wheel/>", '<xacro:call macro="wheel"/>', '<xacro:call macro="${m}"/>'):
        assert not list(uncalled_macros(written(macro + call), FILE))
    assert not list(uncalled_macros(written(macro), Path("main.xacro")))
