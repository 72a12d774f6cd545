"""Fixes of words, of comments, and of what the hint writes out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from checks.fixes.crafted import fixed

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("before", "meant", "after"),
    [
        ("joints: [left_whel, right]", "left_wheel", "joints: [left_wheel, right]"),
        (
            "type: diff_drive_controller/DifDriveController",
            "diff_drive_controller/DiffDriveController",
            "type: diff_drive_controller/DiffDriveController",
        ),
        ("joints: [left_whel, left_wheel]", "left_wheel", None),
        ("joints: [left_whel, left_weel]", "left_wheel", None),
        ("joints: [arm_1]", "arm_2", None),
    ],
)
def test_a_word_on_the_line(tmp_path: Path, before: str, meant: str, after: str | None) -> None:
    file = tmp_path / "a.yaml"
    file.write_text(f"left_whel:\n  {before}  # a\n")
    wanted = after and f"left_whel:\n  {after}  # a\n"
    hint = f"Did you mean `{meant}`?"
    assert fixed(file, "unknown-controller-joint", 2, "", hint) == wanted


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("a.urdf", "<a/>  <!-- wsgen: allow no-visual: why -->\n", "<a/>\n"),
        ("a.py", "a = 1  # wsgen: allow no-visual: why\r\n", "a = 1\r\n"),
        ("a.py", "  # wsgen: allow no-visual: why\nb\n", "b\n"),
        ("a.py", "a  # wsgen: allow no-visual, ROB001: why\n", None),
        ("wsgen.toml", 'no-visual = "why"\n[a]\n', "[a]\n"),
        ("wsgen.toml", 'no-visual = { reason = "why", files = ["a"] }\n', ""),
        ("wsgen.toml", 'no-visual = """\nwhy"""\n', None),
    ],
)
def test_what_allows_nothing(tmp_path: Path, name: str, before: str, after: str | None) -> None:
    file = tmp_path / name
    file.write_bytes(before.encode())
    assert fixed(file, "unused-allowance", 1) == after


def test_package_xml(tmp_path: Path) -> None:
    file = tmp_path / "package.xml"
    text = (
        "<package>\n  <exec_depend>numpy</exec_depend>\n  <export>\n"
        "    <build_type>ament_cmake</build_type>\n  </export>\n</package>\n"
    )
    file.write_text(text)
    hint = "Write <exec_depend>python3-numpy</exec_depend>."
    fixed(file, "not-a-rosdep-key", 2, "", hint)
    fixed(file, "unnamed-package", 1, "", "Add <name>r</name> below <package>.")
    (tmp_path / "setup.py").touch()
    hint = "Write <build_type>ament_python</build_type> in package.xml: setup.py exists."
    fixed(tmp_path / "CMakeLists.txt", "missing-build-file", None, "", hint)
    assert file.read_text() == text.replace("numpy", "python3-numpy").replace(
        "<package>\n", "<package>\n  <name>r</name>\n"
    ).replace("ament_cmake", "ament_python")


def test_a_prefix_of_xacro(tmp_path: Path) -> None:
    file = tmp_path / "a.xacro"
    file.write_text('<robot xmlns:xacro="x">\n<macro name="a">\n</macro>\n</robot>\n')
    assert fixed(file, "unprefixed-xacro", 2, "", "Write <xacro:macro>.", "robot/macro") == (
        '<robot xmlns:xacro="x">\n<xacro:macro name="a">\n</xacro:macro>\n</robot>\n'
    )


def test_the_name_of_a_system(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    plugin = '<plugin filename="gz-sim-{}-system" name="a"/>'
    file.write_text(plugin.format("phisics"))
    hint = 'Write filename="gz-sim-physics-system".'
    assert fixed(file, "unknown-system", 1, "", hint, "plugin") == plugin.format("physics")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("['/scan@a[b']", "['/clock@c[d', '/scan@a[b']"),
        ("[\n  '/scan@a[b',\n]", "[\n  '/clock@c[d',\n  '/scan@a[b',\n]"),
        ("topics", None),
    ],
)
def test_the_clock(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "a.launch.py"
    node = "Node(package='ros_gz_bridge', executable='parameter_bridge', arguments={})\n"
    file.write_text(node.format(before))
    hint = "Add '/clock@c[d' to the arguments of parameter_bridge of ros_gz_bridge."
    wanted = after and node.format(after)
    assert fixed(file, "no-clock-bridge", 1, "", hint) == wanted
