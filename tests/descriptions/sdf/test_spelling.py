"""Elements and attributes that are nearly called as those of SDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.models import read_sdf
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from pathlib import Path


WORLD = """<sdf version="1.7">
  <world name="w">
    <gravity>0 0 -9.8</gravity>
    <include><uri>model://ground_plane</uri></include>
    <model name="m">
      <pose relative_to="world">0 0 1 0 0 0</pose>
      <static>true</static>
      <own:thing/><gazebo_ros/><parts/>
      <link name="l">
        <collision name="c">
          <pose>0 0 0 0 0 0</pose>
          <geometry><cylinder><radius>1</radius><length>2</length></cylinder></geometry>
        </collision>
      </link>
      <plugin name="p" filename="f"><lnik>l</lnik></plugin>
    </model>
  </world>
</sdf>
"""


def misspelled(text: str, folder: Path) -> list[tuple[str, int | None, str | None]]:
    file = folder / "w.sdf"
    file.write_text(text)
    found = read_sdf(file, find_model=lambda _: None).diagnostics
    reported = [one for one in found if one.code in {"ROB038", "ROB077"}]
    return [(one.code, one.line, one.hint) for one in reported]


def test_what_is_right_is_not_told(tmp_path: Path) -> None:
    assert misspelled(WORLD, tmp_path) == []


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [
        ("gravity", "gravty", 3),
        ("include", "inlcude", 4),
        ("uri", "url", 4),
        ("model", "modle", 5),
        ("static", "statik", 7),
        ("link", "lnik", 9),
        ("collision", "colision", 10),
        ("geometry", "geometri", 12),
        ("cylinder", "cilinder", 12),
        ("radius", "raduis", 12),
        ("length", "lenght", 12),
    ],
)
def test_elements(tmp_path: Path, right: str, wrong: str, line: int) -> None:
    text = WORLD.replace(f"<{right}", f"<{wrong}", 1).replace(f"</{right}", f"</{wrong}", 1)
    assert misspelled(text, tmp_path) == [("ROB038", line, f"Did you mean <{right}>?")]


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [("name", "nmae", 2), ("relative_to", "realtive_to", 6), ("version", "verison", 1)],
)
def test_attributes(tmp_path: Path, right: str, wrong: str, line: int) -> None:
    text = WORLD.replace(f" {right}=", f" {wrong}=", 1)
    assert misspelled(text, tmp_path) == [("ROB077", line, f"Did you mean `{right}`?")]


def test_what_other_programs_have_is_no_mistake(tmp_path: Path) -> None:
    joint = "<joint name='j' type='fixed'><axis><dynamics><stiction>1</stiction></dynamics></axis>"
    text = WORLD.replace('<collision name="c"', '<collision frame="l" name="c"')
    text = text.replace("</link>", f"</link>{joint}</joint>", 1)
    assert misspelled(text, tmp_path) == []


def test_a_default_that_gazebo_takes_for_a_misspelling_is_reported_with_it(tmp_path: Path) -> None:
    file = tmp_path / "m.sdf"
    link = "<link name='l'>\n<inertal><mass>1</mass></inertal></link>"
    file.write_text(f"<sdf version='1.7'><model name='m'>{link}</model></sdf>")
    (found,) = read_sdf(file, find_model=lambda _: None).diagnostics
    assert (found.code, found.severity, found.line) == ("ROB038", Severity.WARNING, 2)
    assert found.message == (
        "<inertal> is not an element of <link>: the link `l` has no <inertial>: Gazebo gives it "
        "1 kg and 1 kg m²."
    )
    assert found.hint == "Did you mean <inertial>?"


def test_what_a_misspelled_element_leaves_out_is_reported_with_it(tmp_path: Path) -> None:
    file = tmp_path / "w.sdf"
    for text, line, meant in (
        (WORLD.replace("<uri>", "<url>", 1).replace("</uri>", "</url>", 1), 4, "uri"),
        ("<sdf version='1.7'>\n<modle name='m'/></sdf>", 2, "model"),
        ("<sdf version='1.7'>\n<World name='m'/></sdf>", 2, "world"),
    ):
        file.write_text(text)
        found = read_sdf(file, find_model=lambda _: None).diagnostics
        errors = [one for one in found if one.severity is Severity.ERROR]
        assert [(one.code, one.line, one.hint) for one in errors] == [
            ("ROB038", line, f"Did you mean <{meant}>?")
        ]
        assert "WLD004" not in {one.code for one in found}
