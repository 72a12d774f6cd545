"""SDF files that are wrong as a whole: a diagnostic each, and never an exception."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.models import read_sdf
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile

    Read = Callable[..., SdfFile]

MASS = "<inertial><mass>2</mass></inertial>"
LINK = f'<link name="l">{MASS}</link>'
ERROR, WARNING = Severity.ERROR, Severity.WARNING


@pytest.mark.parametrize(
    ("content", "version", "code", "severity"),
    [
        (LINK, "1.13", "WLD012", WARNING),
        (LINK, "1.99", "WLD012", WARNING),
        (LINK, "2.0", "WLD012", WARNING),
        (LINK, "1.2", "WLD012", WARNING),
        (LINK, "one", "WLD011", ERROR),
        (LINK, "", "WLD011", ERROR),
        (LINK, "1.9.1", "WLD011", ERROR),
        ("", "1.9", "ROB005", ERROR),
        ("<link/>" + LINK, "1.9", "ROB006", ERROR),
        ('<link name=" "/>' + LINK, "1.9", "ROB006", ERROR),
        (LINK + LINK, "1.9", "WLD015", ERROR),
        (LINK + '<frame name="l"/>', "1.6", "WLD015", ERROR),
        ('<link name="world"/>' + LINK, "1.9", "ROB043", ERROR),
        ('<link name="__l__"/>' + LINK, "1.9", "ROB043", ERROR),
        ('<link name="a::b"/>' + LINK, "1.8", "ROB043", ERROR),
    ],
)
def test_what_is_wrong_with_a_model(
    read: Read, content: str, version: str, code: str, severity: Severity
) -> None:
    file = read(f'<model name="m">{content}</model>', version)
    assert [(found.code, found.severity) for found in file.diagnostics] == [(code, severity)]
    (found,) = file.diagnostics
    assert found.file is not None
    assert found.file.name == "scene.sdf"
    assert found.line is not None
    assert found.hint
    (model,) = file.models
    assert model.robot is None if code == "ROB005" else model.robot is not None


def test_a_file_without_version(tmp_path: Path) -> None:
    file = tmp_path / "m.sdf"
    file.write_text(f'<sdf><model name="m">{LINK}</model></sdf>')
    assert [found.code for found in read_sdf(file, find_model=lambda _: None).diagnostics] == [
        "WLD011"
    ]


def test_a_joint_called_like_a_link_was_allowed_once(read: Read) -> None:
    content = (
        f'{LINK}<link name="k">{MASS}</link><joint name="k" type="fixed"><parent>l</parent>'
        "<child>k</child></joint>"
    )
    file = read(f'<model name="m">{content}</model>', "1.6")
    assert [found.code for found in file.diagnostics] == ["ROB034"]
    robot = file.models[0].robot
    assert robot is not None
    assert [joint.name for joint in robot.joints] == ["k_joint"]
    file = read(f'<model name="m">{content}</model>', "1.7")
    assert [found.code for found in file.diagnostics] == ["WLD015"]


def test_flattened_names_of_old_files(read: Read) -> None:
    link = f'<link name="arm::hand">{MASS}</link>'
    file = read(f'<model name="m">{link}</model>', "1.7")
    assert file.diagnostics == ()


@pytest.mark.parametrize(
    ("content", "codes"),
    [
        ("", ["WLD003"]),
        ('<light name="l"/>', ["WLD003"]),
        (f'<model name="a">{LINK}</model><model name="b">{LINK}</model>', ["WLD038"]),
        ("<model/>", ["ROB006"]),
        ('<world name="w"/><world name="v"/>', ["WLD038", "WLD006"]),
        ("<world/>", ["ROB006", "WLD006"]),
        (
            f'<world name="w"><model name="a">{LINK}</model><model name="a">{LINK}</model></world>',
            ["WLD015", "WLD006"],
        ),
        ('<world name="w"><actor name="walker"/></world>', ["WLD004", "WLD006"]),
        ('<world name="w"><gravity>0 0 nan</gravity></world>', ["ROB016", "WLD006"]),
    ],
)
def test_what_is_wrong_with_a_file(read: Read, content: str, codes: list[str]) -> None:
    assert [found.code for found in read(content).diagnostics] == codes


def test_a_model_without_the_element_around_it(tmp_path: Path) -> None:
    file = tmp_path / "bad.sdf"
    file.write_text("<model name='m'><link name='l'/></model>")
    (found,) = read_sdf(file, find_model=lambda _: None).diagnostics
    assert (found.code, found.hint) == (
        "WLD003",
        'Write <sdf version="1.6"> above the <model>, and </sdf> below it.',
    )


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "ROB001"),
        (b"\0\1\2", "ROB057"),
        (b"<sdf version='1.9'><model name='m'>", "ROB001"),
        (b"<robot name='r'/>", "WLD003"),
        (
            (
                b'<!DOCTYPE s [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
                b'<sdf version="1.9"><model name="m"><link name="l"><pose>&b;</pose></link></model>'
                b"</sdf>"
            ),
            "WLD046",
        ),
        (b"<sdf version='1.9'>" + b"<model name='m'>" * 1000 + b"</model>" * 1000, "ROB001"),
    ],
)
def test_files_that_are_hardly_sdf(tmp_path: Path, content: bytes, code: str) -> None:
    file = tmp_path / "bad.sdf"
    file.write_bytes(content)
    (found,) = read_sdf(file, find_model=lambda _: None).diagnostics
    assert (found.code, found.file) == (code, file)


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    test_files_that_are_hardly_sdf(tmp_path, b" " * (33 * 2**20), "ROB002")


def test_files_that_are_none(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.sdf")
    for file in (tmp_path, tmp_path / "pipe.sdf", tmp_path / "gone.sdf", tmp_path / ("x" * 999)):
        found = read_sdf(file, find_model=lambda _: None)
        assert [one.code for one in found.diagnostics] == ["ROB072"]
        assert (found.world, found.models) == (None, ())


def test_what_is_there_instead_of_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.sdf")
    (tmp_path / "link.sdf").symlink_to("/dev/zero")
    (tmp_path / "dead.sdf").symlink_to("nowhere")
    for name, ending in (
        ("pipe.sdf", "it is a named pipe."),
        ("link.sdf", "it is a link to a device (/dev/zero)."),
        ("dead.sdf", "it is a link to nowhere, which does not exist."),
        ("", "it is a folder."),
    ):
        (found,) = read_sdf(tmp_path / name, find_model=lambda _: None).diagnostics
        assert found.message.endswith(ending)


def test_utf_16(tmp_path: Path) -> None:
    file = tmp_path / "wide.sdf"
    for encoding in ("utf-16", "utf-16-le", "utf-16-be"):
        file.write_bytes("<sdf version='1.7'/>".encode(encoding))
        (found,) = read_sdf(file, find_model=lambda _: None).diagnostics
        assert (found.code, "UTF-16" in found.message) == ("ROB057", True)
        assert "iconv -f UTF-16 -t UTF-8" in (found.hint or "")


@pytest.mark.slow
def test_ten_thousand_models(read: Read) -> None:
    models = "".join(f'<model name="m{i}">{LINK}</model>' for i in range(10_000))
    file = read(f'<world name="w">{models}</world>')
    assert [found.code for found in file.diagnostics] == ["WLD006"]
    assert len({model.name for model in file.models}) == 10_000


@pytest.mark.slow
def test_a_chain_of_ten_thousand_links(read: Read) -> None:
    count = 10_000
    links = "".join(f'<link name="l{i}">{MASS}</link>' for i in range(count))
    # From the last joint to the first one: the trees grow together at their roots.
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent>l{i}</parent><child>l{i + 1}</child></joint>'
        for i in reversed(range(count - 1))
    )
    file = read(f'<model name="m">{links}{joints}</model>')
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    assert (robot.root, len(robot.joints), robot.loose) == ("l0", count - 1, ())


@pytest.mark.parametrize("depth", [50, 51, 120])
def test_models_in_models_in_models(read: Read, depth: int) -> None:
    file = read(f'<model name="m">{LINK}' * depth + "</model>" * depth)
    assert [found.code for found in file.diagnostics] == ([] if depth == 50 else ["WLD014"])
    robot = file.models[0].robot
    assert robot is not None
    assert len(robot.links) == 50


def test_names_of_all_kinds(read: Read) -> None:
    link = f'<link name="bras d&apos;été &quot;左&quot;">{MASS}</link>'
    file = read(f'<model name="机器人/1">{link}</model>')
    assert file.diagnostics == ()
    assert file.models[0].name == "机器人/1"


def test_all_numbers_are_finite(read: Read) -> None:
    content = (
        '<link name="a"><inertial><pose>1e9 1e9 1e9 1e9 1e9 1e9</pose><mass>1.7e308</mass>'
        "<inertia><ixx>1.7e308</ixx><iyy>1.7e308</iyy><izz>1.7e308</izz><ixy>1e308</ixy></inertia>"
        '</inertial><collision name="c"><max_contacts>1e308</max_contacts><geometry><box/>'
        f'</geometry></collision></link><link name="b">{MASS}<pose relative_to="a">1e9 0 0 1 2 3'
        '</pose></link><joint name="j" type="revolute"><parent>a</parent><child>b</child><axis>'
        "<xyz>1e-320 0 1e300</xyz><limit><lower>-1e300</lower><upper>1</upper></limit>"
        '<mimic joint="j"><multiplier>1e308</multiplier><reference>1e308</reference></mimic>'
        "</axis></joint>"
    )
    file = read(f'<model name="m">{content}</model>')
    assert [found.code for found in file.diagnostics] == ["WLD028"]
    assert "inf" not in repr(file.models[0].robot)
    assert "nan" not in repr(file.models[0].robot)


def test_how_to_get_a_ground_depends_on_the_simulator(read: Read) -> None:
    plugin = '<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>'
    for content, words in ((plugin, "<static>true</static>"), ("", "model://ground_plane")):
        (found,) = read(f'<world name="w">{content}</world>').diagnostics
        assert found.code == "WLD006"
        assert words in (found.hint or "")
