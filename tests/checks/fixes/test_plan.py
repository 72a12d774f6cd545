"""Which fixes are made, and which files are left alone."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from checks.fixes.crafted import fixed, report
from wsgen.checks.fixes.plan import FIXERS, plan_fixes, unified_diff, write_fixes
from wsgen.checks.fixes.source import Edit, apply, is_surely, overlap
from wsgen.checks.rules.catalogue import find_rule
from wsgen.text.suggestions import suggested

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

TEXT = '<robot name="r">\n  <joint name="j"><axis xyz="0 0 2"/></joint>\n</robot>\n'
PLACE = "joint[@name='j']/axis"


def axis(file: Path, line: int = 2) -> Diagnostic:
    return report(file, "unnormalized-axis", line, "", "", PLACE)


def test_at_least_25_rules_have_a_fix() -> None:
    rules = [find_rule(name) for name in FIXERS]
    assert None not in rules
    assert len(rules) > 50


def test_each_file_is_computed_before_one_is_written(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(TEXT)
    plan = plan_fixes([axis(file), axis(file)], [tmp_path])
    assert file.read_text() == TEXT
    (fix,) = plan.files
    assert (fix.before, fix.fixed) == (TEXT, (axis(file),))
    assert unified_diff(fix, "r.urdf")[3:] == [
        ' <robot name="r">',
        '-  <joint name="j"><axis xyz="0 0 2"/></joint>',
        '+  <joint name="j"><axis xyz="0 0 1"/></joint>',
        " </robot>",
    ]
    assert [*write_fixes(plan)] == [file]
    assert file.read_text() == TEXT.replace("0 0 2", "0 0 1")


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ("other/r.urdf", "outside of what is checked"),
        ("ws/install/share/r.urdf", "in an install space"),
        ("ws/none.urdf", "does not exist"),
        ("ws/latin.urdf", "not UTF-8"),
    ],
)
def test_what_is_refused(tmp_path: Path, place: str, reason: str) -> None:
    file = tmp_path / place
    file.parent.mkdir(parents=True)
    (tmp_path / "ws" / "install").mkdir(parents=True, exist_ok=True)
    (tmp_path / "ws" / "install" / ".colcon_install_layout").touch()
    if "none" not in place:
        file.write_bytes(TEXT.encode() + ("ä".encode("latin-1") if "latin" in place else b""))
    plan = plan_fixes([axis(file)], [tmp_path / "ws"])
    assert plan.files == ()
    assert reason in plan.refused[0][1]


def test_a_read_only_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(TEXT)
    monkeypatch.setattr("os.access", lambda _, mode: mode != os.W_OK)
    plan = plan_fixes([axis(file)], [tmp_path])
    assert "read-only" in plan.refused[0][1]


def test_a_link_leads_to_the_file_that_is_written(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    file = tmp_path / "src" / "r.urdf"
    file.write_text(TEXT)
    link = tmp_path / "r.urdf"
    link.symlink_to(file)
    assert plan_fixes([axis(link)], [tmp_path]).files[0].file == file
    outside = plan_fixes([axis(link)], [tmp_path / "elsewhere"])
    assert "outside" in outside.refused[0][1]


def test_a_rule_without_a_fix_is_not_refused(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(TEXT)
    assert plan_fixes([report(file, "no-collision", 1, "", "")], [tmp_path]).refused == ()


def test_an_element_that_may_be_another_one_is_left_alone(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(TEXT.replace("</joint>", '</joint><joint name="j"><axis xyz="0 0 3"/></joint>'))
    assert fixed(file, "unnormalized-axis", 2, element=PLACE) is None
    assert fixed(file, "unnormalized-axis", None, element=PLACE) is None
    assert fixed(file, "unnormalized-axis", 3, element=PLACE) is None
    assert fixed(file, "unnormalized-axis", 2) is None


@pytest.mark.parametrize(
    "text",
    [
        '<!-- <axis xyz="0 0 2"/> -->\n<a/>',
        '<a>\n<axis xyz="0 0 ${x}"/></a>',
        '<a>\n<axis xyz="$(arg axis)"/></a>',
        '<a>\n<axis xyz="&axis;"/></a>',
        "<a>\n<axis/></a>",
        '<a>\n<axis xyz="0 0 0"/></a>',
        '<a>\n<![CDATA[<axis xyz="0 0 2"/>]]></a>',
    ],
)
def test_what_is_no_plain_value_is_left_alone(tmp_path: Path, text: str) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(text)
    for line in (1, 2):
        assert fixed(file, "unnormalized-axis", line, element="joint/axis") is None


def test_a_fix_that_would_break_the_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text("x = {'robot_description': await_}\n")
    found = report(file, "description-as-yaml", 1, "", "")
    original = FIXERS["description-as-yaml"]
    try:
        FIXERS["description-as-yaml"] = lambda *_: [Edit(start=0, end=1, text="(")]  # type: ignore[index]
        plan = plan_fixes([found], [tmp_path])
    finally:
        FIXERS["description-as-yaml"] = original  # type: ignore[index]
    assert plan.files == ()
    assert "break" in plan.refused[0][1]


def test_edits() -> None:
    edits = [Edit(start=4, end=5, text="F"), Edit(start=0, end=0, text="> ")]
    assert apply("abcdef", edits) == "> abcdFf"
    assert overlap([Edit(start=0, end=3, text="")], [Edit(start=2, end=4, text="")])
    assert overlap([Edit(start=2, end=2, text="a")], [Edit(start=2, end=2, text="b")])
    assert not overlap([Edit(start=0, end=2, text="")], [Edit(start=2, end=4, text="")])


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        *(("inertail", "inertial"), ("base_lnk", "base_link"), ("Revolute", "revolute")),
        *(("ament_pakage", "ament_package"), ("xzy", "xyz"), ("Gazebo/red", "Gazebo/Red")),
    ],
)
def test_a_slip(written: str, meant: str) -> None:
    assert is_surely(written, meant)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        *(("left_wheel", "right_wheel"), ("arm1", "arm"), ("base", "base_link"), ("mu", "mu1")),
        *(("arm_1", "arm_2"), ("wheel_1_link", "wheel_2_link"), ("joint3", "joint4")),
        *(
            ("l_wheel", "r_wheel"),
            ("fl_wheel", "fr_wheel"),
            ("wheelL", "wheelR"),
            ("lwheel", "rwheel"),
        ),
        *(("rear", "near"), ("axis_x", "axis_y"), ("wheels", "wheel_s1")),
    ],
)
def test_another_name(written: str, meant: str) -> None:
    assert not is_surely(written, meant)


def test_what_a_hint_suggests() -> None:
    assert suggested("Did you mean `a b`? If not, remove it.") == "a b"
    assert suggested("Did you mean <inertial>?") == "inertial"
    assert suggested("Did you mean `a` or `b`?") is None
    assert suggested(None) is None


def test_dependencies_in_a_circle_are_refused(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    found = []
    for name, other in (("one", "two"), ("two", "three"), ("three", "one")):
        folder = tmp_path / "src" / name
        folder.mkdir()
        (folder / "package.xml").write_text(
            f'<package format="3">\n  <name>{name}</name>\n  <version>0.1.0</version>\n'
            "  <description>d</description>\n  <maintainer email='a@b.org'>A</maintainer>\n"
            "  <license>MIT</license>\n  <exec_depend>rviz2</exec_depend>\n"
            "  <export><build_type>ament_cmake</build_type></export>\n</package>\n"
        )
        found.append(
            report(
                folder / "package.xml",
                "undeclared-dependency",
                1,
                f"package.xml does not declare {other}.",
                f"Add to package.xml: <exec_depend>{other}</exec_depend>",
            )
        )
    plan = plan_fixes(found, [tmp_path])
    assert plan.fixed == tuple(found[:2])
    assert plan.refused == (
        (found[2], "colcon refuses packages that need each other: three → one → two → three"),
    )
