"""package.xml, read quickly and checked by catkin_pkg."""

import subprocess
import sys
from pathlib import Path

import pytest

from building.building import PACKAGE_XML
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.packages.workspace.manifest import (
    RUN_TAGS,
    SIZE_LIMIT,
    Dependency,
    Manifest,
    read_manifest,
)
from wsgen.packages.workspace.package_xml import check_package_xml, is_plain


def write(folder: Path, text: str | bytes) -> Path:
    file = folder / "package.xml"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return file


def test_what_is_read(tmp_path: Path) -> None:
    text = PACKAGE_XML.replace("<export>", "<test_depend> ament_lint_auto </test_depend><export>")
    manifest = read_manifest(write(tmp_path, text))
    assert manifest == Manifest(
        name="demo",
        build_type="ament_cmake",
        dependencies=(
            Dependency(tag="buildtool_depend", name="ament_cmake", line=8),
            Dependency(tag="test_depend", name="ament_lint_auto", line=9),
        ),
    )
    assert isinstance(manifest, Manifest)
    assert manifest.test_dependencies == {"ament_lint_auto"}
    assert (manifest.format, manifest.line_of("export", "build_type")) == (3, 9)


CONDITIONS = """<package>
<name>demo</name>
<depend condition="$ROS_VERSION == 1">roscpp</depend>
<depend condition="$ROS_VERSION == 2">rclcpp</depend>
<exec_depend condition="$ROS_DISTRO == humble or $ROS_DISTRO == iron">gazebo_ros</exec_depend>
<exec_depend condition="$ROS_DISTRO &gt; iron">ros_gz_sim</exec_depend>
<exec_depend condition="not a condition">strange</exec_depend>
<export>
<build_type condition="$ROS_VERSION == 1">catkin</build_type>
<build_type condition="$ROS_VERSION == 2">ament_cmake</build_type>
</export></package>"""


@pytest.mark.parametrize(
    ("distro", "counting"),
    [
        (None, {"rclcpp", "gazebo_ros", "ros_gz_sim", "strange"}),
        ("humble", {"rclcpp", "gazebo_ros", "strange"}),
        ("jazzy", {"rclcpp", "ros_gz_sim", "strange"}),
    ],
)
def test_dependencies_with_conditions(
    distro: str | None, counting: set[str], tmp_path: Path
) -> None:
    manifest = read_manifest(write(tmp_path, CONDITIONS))
    assert isinstance(manifest, Manifest)
    assert manifest.names(RUN_TAGS, distro) == counting
    assert manifest.build_type == "ament_cmake"


def test_names_elsewhere_are_not_the_package_s(tmp_path: Path) -> None:
    text = "<package><export><tool><name>no</name></tool></export><name>yes</name></package>"
    manifest = read_manifest(write(tmp_path, text))
    assert isinstance(manifest, Manifest)
    assert (manifest.name, manifest.build_type) == ("yes", "catkin")


ENTITY = '<!DOCTYPE p [<!ENTITY a "aaaa">]><package><name>&a;</name></package>'


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("", "PKG001", 1),
        ("<package>\n<name>\n", "PKG001", 2),
        (b"\xff\xfe\x00", "PKG001", 1),
        (ENTITY, "PKG001", 1),
        ("<extension/>", "PKG003", 1),
        ("<package/>", "PKG004", None),
        ("<package><name> </name></package>", "PKG004", None),
    ],
)
def test_what_cannot_be_read(
    text: str | bytes, code: str, line: int | None, tmp_path: Path
) -> None:
    found = read_manifest(write(tmp_path, text))
    assert isinstance(found, Diagnostic)
    assert (found.code, found.line) == (code, line)
    assert found.hint


def test_a_folder_in_its_place(tmp_path: Path) -> None:
    (tmp_path / "package.xml").mkdir()
    found = read_manifest(tmp_path / "package.xml")
    assert isinstance(found, Diagnostic)
    assert found.code == "PKG002"


def test_a_good_one_is_accepted(tmp_path: Path) -> None:
    assert check_package_xml(write(tmp_path, PACKAGE_XML)) == ()


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("somebody@example.com", "nobody", 6, 'Invalid email "nobody"'),
        ("0.0.0", "1.0", 4, 'version "1.0"'),
        (">demo<", ">de mo<", 3, 'name "de mo"'),
        ("<license>Apache-2.0</license>", "", 2, '"license"'),
        ("<buildtool_depend>", "<depend>demo</depend><buildtool_depend>", 3, "same name"),
        ("Apache-2.0", "", 7, "license tag"),
        ("<export>", "<run_depend>rviz</run_depend><export>", 9, "run_depend"),
        ('format="3"', 'format="x"', 2, "'x'"),
    ],
)
def test_what_catkin_pkg_refuses(
    old: str, new: str, line: int | None, words: str, tmp_path: Path
) -> None:
    diagnostics = check_package_xml(write(tmp_path, PACKAGE_XML.replace(old, new)))
    assert diagnostics
    assert diagnostics[0].severity is Severity.ERROR
    assert diagnostics[0].code == "PKG005"
    assert words in diagnostics[0].message
    assert diagnostics[0].line == line


@pytest.mark.parametrize(
    ("old", "new", "line", "reported"),
    [
        ("</license>", "", 7, ("<license> is not closed", "Add </license>")),
        ("</license>", "</licens>", 7, ("<license> is closed by </licens>", "Write </license>")),
        ("</package>", "", 2, ("<package> is not closed", "Add </package>")),
        ("A robot", "A & robot", 5, ("`&` stands alone", "&amp;")),
        ("A robot", "A < robot", 5, ("`<` stands alone", "&lt;")),
        ('format="3"', 'format="3', 2, ("`format` in <package> lacks a quote", 'format="VALUE"')),
        ('format="3"', "format=3", 2, ("`format` in <package> lacks a quote", 'format="VALUE"')),
        ('format="3"', 'format="3 id="4"', 2, ("`format` in <package> lacks", 'format="VALUE"')),
        ('format="3">', 'format="3"', 2, ("`<package` has no `>`", "Add `>`")),
        ("<license>", "</depend><license>", 7, ("</depend> closes no", "Remove </depend>")),
        ("<license>", "<!-- <license>", 7, ("comment is not closed", "Add -->")),
        ("<license>", "<!-- a -- b --><license>", 7, ("a comment contains", "single hyphens")),
        ("</package>", "</package><export/>", 10, ("the root element ends", "Move the rest")),
        ("<?xml", "\n<?xml", 2, ("not at the very beginning", "Remove what is before it")),
    ],
)
def test_mistakes_of_xml(
    old: str, new: str, line: int, reported: tuple[str, str], tmp_path: Path
) -> None:
    found = read_manifest(write(tmp_path, PACKAGE_XML.replace(old, new)))
    assert isinstance(found, Diagnostic)
    assert (found.code, found.line) == ("PKG001", line)
    assert reported[0] in found.message
    assert reported[1] in (found.hint or "")


MAINTAINER = '<maintainer email="somebody@example.com">Somebody</maintainer>'


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        (MAINTAINER, "", 'Add: <maintainer email="you@example.com">Your Name</maintainer>'),
        ("<license>Apache-2.0</license>", "", "Add: <license>Apache-2.0</license>"),
        ("<version>0.0.0</version>", "", "Add: <version>0.0.0</version>"),
        ("<version>", "<version>1.0.0</version><version>", "Keep one <version>."),
        ("A robot for tests.", "", "Add: <description>What the package is for.</description>"),
        ("0.0.0", "1.0", "Write three numbers: <version>1.0.0</version>"),
        ("<export>", "<depnd>a</depnd><export>", "Did you mean `depend`?"),
        ("<export>", "<color>a</color><export>", "Remove or rename color: this format"),
        (' email="somebody@example.com"', "", 'Write: <maintainer email="...">'),
        ('format="3"', 'format="99"', "REP-149"),
    ],
)
def test_the_hint_is_something_to_write(old: str, new: str, hint: str, tmp_path: Path) -> None:
    assert old in PACKAGE_XML
    diagnostic = check_package_xml(write(tmp_path, PACKAGE_XML.replace(old, new)))[0]
    assert diagnostic.code == "PKG005"
    assert (diagnostic.hint or "").startswith(hint)


def test_what_it_dislikes(tmp_path: Path) -> None:
    (diagnostic,) = check_package_xml(write(tmp_path, PACKAGE_XML.replace(">demo<", ">Demo<")))
    assert (diagnostic.code, diagnostic.severity, diagnostic.line) == (
        "PKG006",
        Severity.WARNING,
        3,
    )


def test_listing_packages_does_not_load_catkin_pkg() -> None:
    code = "import sys, wsgen.building.run; sys.exit('catkin_pkg' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("", ""),
        ('format="3"', 'format="2"'),
        ("Somebody", ""),
        ("<license>", '<license file="LICENSE">'),
        ("</maintainer>", '</maintainer><author>A</author><url type="website">x</url>'),
        ("<export>", '<depend condition="$ROS_VERSION == 2">rclcpp</depend><export>'),
        ("<export>", "<member_of_group>rosidl_interface_packages</member_of_group><export>"),
        ("<export>", "<build_depend>rclcpp</build_depend><exec_depend>xacro</exec_depend><export>"),
        ("A robot for tests.", "A <b>robot</b> for tests."),
    ],
)
def test_what_is_accepted_without_catkin_pkg(
    old: str, new: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(tmp_path, PACKAGE_XML.replace(old, new, 1))
    manifest = read_manifest(file)
    assert isinstance(manifest, Manifest)
    assert is_plain(manifest)
    monkeypatch.setattr("wsgen.packages.workspace.package_xml.is_plain", lambda _: False)
    assert check_package_xml(file) == ()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("somebody@example.com", "nobody"),
        (' email="somebody@example.com"', ""),
        ("0.0.0", "1.0"),
        ("0.0.0", "01.0.0"),
        (">demo<", ">Demo<"),
        (">demo<", ">de mo<"),
        ("A robot for tests.", ""),
        ("Apache-2.0", ""),
        ("<license>Apache-2.0</license>", ""),
        ("<version>", '<version compatibility="x">'),
        ("<license>", '<license since="2026">'),
        ("<export>", "<depend>demo</depend><export>"),
        ("<export>", "<run_depend>rviz2</run_depend><export>"),
        ("<export>", "<depend>a</depend><exec_depend>a</exec_depend><export>"),
        ("<export>", "<depend><b/>a</depend><export>"),
        ("<export>", "<license/><export>"),
        ("<export>", "<name>demo</name><export>"),
        ("<export>", "<export/><export>"),
        ("<export>", "<export><metapackage/>"),
        ('format="3"', 'format="1"'),
        ('format="3"', 'format="2" id="x"'),
        ('format="3"', 'format="x"'),
        ('format="3">', 'format="2"><member_of_group>a</member_of_group>'),
        ('format="3">', 'format="2"><depend condition="$A == 1">a</depend>'),
    ],
)
def test_what_catkin_pkg_looks_at(old: str, new: str, tmp_path: Path) -> None:
    manifest = read_manifest(write(tmp_path, PACKAGE_XML.replace(old, new, 1)))
    assert isinstance(manifest, Manifest)
    assert not is_plain(manifest)
    if "license since" not in new and "format=" not in new and "metapackage" not in new:
        assert check_package_xml(tmp_path / "package.xml")


def test_a_plain_manifest_is_checked_without_catkin_pkg(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path\n"
        "from wsgen.packages.workspace.package_xml import check_package_xml\n"
        "assert check_package_xml(Path(sys.argv[1])) == ()\n"
        "assert not any(name.startswith('catkin_pkg') for name in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code, str(write(tmp_path, PACKAGE_XML))], check=True)


@pytest.mark.parametrize("name", ["../../evil", "a/b", "..", ".", "a\\b", "a\nb"])
def test_a_name_that_leads_elsewhere(tmp_path: Path, name: str) -> None:
    """Folders and files are called by the name of the package."""
    file = tmp_path / "package.xml"
    file.write_text(f"<package>\n<name>{name}</name></package>")
    found = read_manifest(file)
    assert isinstance(found, Diagnostic)
    assert (found.code, found.line) == ("PKG004", 2)


def test_a_manifest_that_is_too_large(tmp_path: Path) -> None:
    found = read_manifest(write(tmp_path, PACKAGE_XML + " " * SIZE_LIMIT))
    assert isinstance(found, Diagnostic)
    assert (found.code, found.hint) == ("PKG002", "Remove what is not needed in it.")
