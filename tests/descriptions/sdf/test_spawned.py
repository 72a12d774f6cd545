"""Models that are spawned from a text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.lookup import model_finder
from wsgen.descriptions.sdf.models import read_model, read_sdf
from wsgen.descriptions.sdf.source import is_sdf
from wsgen.diagnostics import Severity
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile


LINK = '<link name="l"><pose>0 0 1 0 0 0</pose><inertial><mass>2</mass></inertial>{}</link>'
MODEL = f'<model name="m"><pose>5 0 0 0 0 0</pose>{LINK}</model>'


def sdf(content: str) -> str:
    return f'<sdf version="1.9">\n{content}</sdf>'


def read(content: str | bytes, pose_in_world: Pose | None = None) -> SdfFile:
    return read_model(content, file=None, find_model=lambda _: None, pose_in_world=pose_in_world)


@pytest.mark.parametrize("content", [sdf(MODEL.format("")), sdf(MODEL.format("")).encode()])
def test_a_text_from_nowhere(content: str | bytes) -> None:
    file = read(content)
    assert file.diagnostics == ()
    assert file.world is None
    (model,) = file.models
    assert (model.name, model.file, model.line) == ("m", None, 2)
    assert model.pose_in_world.xyz == (5, 0, 1)


def test_the_pose_of_the_spawner_counts() -> None:
    file = read(sdf(MODEL.format("")), pose_in_world=Pose((0, 7, 0), (0, 0, 1)))
    assert file.models[0].pose_in_world == Pose((0, 7, 1), (0, 0, 1))


def test_the_text_of_a_file_is_read_like_the_file(tmp_path: Path) -> None:
    (tmp_path / "m.stl").touch()
    (tmp_path / "hand").mkdir()
    (tmp_path / "hand" / "model.sdf").write_text(
        sdf(f'<model name="hand">{LINK.format("")}</model>')
    )
    mesh = '<visual name="v"><geometry><mesh><uri>m.stl</uri></mesh></geometry></visual>'
    include = "<include><uri>hand</uri></include></model>"
    text = sdf(MODEL.format(mesh).replace("</model>", include))
    file = tmp_path / "m.sdf"
    file.write_text(text)
    find = model_finder(file, {})
    spawned = read_model(text, file=file, find_model=find)
    assert spawned.diagnostics == ()
    assert spawned == read_sdf(file, find_model=find)
    assert {found.code for found in read(text).diagnostics} == {"ROB061", "WLD004"}


def test_a_spawned_text_may_only_include_a_model(tmp_path: Path) -> None:
    """Gazebo's parser makes a root model of it."""
    (tmp_path / "model.sdf").write_text(sdf(MODEL.format("")))
    text = sdf("<include><uri>model://m</uri><name>n</name></include>")
    file = read_model(
        text, file=None, find_model=lambda _: tmp_path, pose_in_world=Pose((0, 7, 0), (0, 0, 0))
    )
    assert file.diagnostics == ()
    (model,) = file.models
    assert (model.name, model.pose_in_world.xyz) == ("n", (0, 7, 1))


@pytest.mark.parametrize(
    ("content", "code", "severity"),
    [
        ("", "ROB001", Severity.ERROR),
        ("<sdf version='1.9'><model", "ROB001", Severity.ERROR),
        (b"\xff\xfe\xfd", "ROB057", Severity.ERROR),
        ("<robot name='r'/>", "WLD003", Severity.ERROR),
        (sdf(""), "WLD003", Severity.ERROR),
        (sdf("<include><uri>model://m</uri></include>"), "WLD004", Severity.WARNING),
        (sdf(f'<world name="w">{MODEL.format("")}</world>'), "WLD043", Severity.ERROR),
        (sdf('<light name="l" type="point"/>'), "WLD060", Severity.INFO),
        (sdf(MODEL.format("") * 2), "WLD038", Severity.ERROR),
    ],
)
def test_what_cannot_be_spawned(content: str | bytes, code: str, severity: Severity) -> None:
    file = read(content)
    assert [(one.code, one.severity, one.file) for one in file.diagnostics] == [
        (code, severity, None)
    ]
    assert file.world is None
    assert len(file.models) == (1 if code == "WLD038" else 0)


def test_a_text_that_is_too_large() -> None:
    test_what_cannot_be_spawned(" " * (33 * 2**20), "ROB002", Severity.ERROR)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("<?xml version='1.0'?>\n<!-- <robot> --><!DOCTYPE sdf><sdf version='1.9'/>", True),
        ("\ufeff<sdf/>", True),
        ("<sdf", True),
        ("<robot name='sdf'/>", False),
        ("<!-- <sdf> --><robot/>", False),
        ("<!-- " * 1_000_000, False),
        ("<!-- -->" * 100_000 + "<robot/>", False),
        ("<sdformat/>", False),
        ("", False),
    ],
)
def test_sdf_is_distinguished_from_urdf(content: str, *, expected: bool) -> None:
    assert is_sdf(content) is expected
