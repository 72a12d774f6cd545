"""The explanation of an error in a xacro file: the very line, and what to do."""

from __future__ import annotations

import os
import socket
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

import pytest
import xacro

from wsgen.descriptions.xacro.expansion import Watch, expand, explain_error

if TYPE_CHECKING:
    from pathlib import Path


ROBOT = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
  <!-- give length:=1.0 or mass:=2, as in ${mas} <link name="${mas}"/> -->
  <xacro:arg name="mass" default="1.0"/>
  <xacro:property name="mass" value="$(arg mass)"/>
  <xacro:property name="length" value="0.5"/>
  <xacro:include filename="$(find my_robot)/model/robot.gazebo"/>
  <xacro:macro name="solid" params="mass length">
    <inertial>
      <mass value="${mass}"/>
      <inertia ixx="${mass * length**2 / 12}"
               izz="${mass * length**2 / 12.5}"/>
    </inertial>
  </xacro:macro>
  <link name="base_link">
    <collision><geometry><box size="1 1 ${length}"/></geometry></collision>
    <xacro:solid mass="${mass}" length="${length}"/>
  </link>
  <link name="arm">
    <xacro:solid mass="${mass}" length="${length}"/>
    <visual>
      ${length}
    </visual>
  </link>
</robot>
"""


class PackageNotFoundError(KeyError):
    """As ament_index_python raises it."""

    def __init__(self, name: str) -> None:
        super().__init__(f"package {name!r} not found")
        self.name = name


@pytest.fixture
def model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The model folder of an installed package, which `$(find)` knows."""
    share = tmp_path / "share" / "my_robot"
    folder = share / "model"
    folder.mkdir(parents=True)
    index = tmp_path / "share" / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True)
    (index / "my_robot").touch()
    (folder / "robot.gazebo").write_text("<robot><gazebo><a>${length}</a></gazebo></robot>")
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(["", "/no", str(tmp_path)]))

    def find(name: str) -> str:
        if name == "gazebo_ros":  # an address of which nothing is here
            return str(tmp_path / "opt" / "share" / name)
        if name != "my_robot":
            raise PackageNotFoundError(name)
        return str(share)

    packages = ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = find  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ament_index_python", ModuleType("ament_index_python"))
    monkeypatch.setitem(sys.modules, "ament_index_python.packages", packages)
    return folder


@pytest.mark.parametrize(
    ("old", "new", "line", "words", "hint"),
    [
        # an expression that is a part of another word, and stands in a comment too
        ('solid mass="${mass}"', 'solid mass="${mas}"', 17, "'mas' is not", "mean `mass`?"),
        ('value="0.5"', 'value="${length}"', 6, "length -> length", "Rename one of them"),
        ('1 ${length}"', '1 ${length"', 16, "`${length` does not end", "`}`"),
        ("$(find my_robot)", "$(find my_robto)", 7, "'my_robto'", "mean `my_robot`?"),
        ("<xacro:solid m", "<xacro:solidd m", 17, "xacro:solidd", "mean `solid`?"),
        ('solid mass="${mass}"', "solid", 17, "[mass]", '<xacro:solid mass="..."'),
        ('solid mass="${mass}"', 'solid mss="1"', 17, '"mss"', "mean `mass`?"),
        ("robot.gazebo", "robot.gazbo", 7, "model/robot.gazbo'", "mean `robot.gazebo`?"),
        ("/model/", "/modle/", 7, "/modle/robot.gazebo'", "mean `model`?"),
        ('default="1.0"', 'default="1,5"', 4, "`mass` is the text '1,5'", "Write 1.5"),
        ('default="1.0"', 'default="heavy"', 4, "`mass` is the text 'heavy'", "a number"),
        ('value="0.5"', 'value="0.5 m"', 6, "`length` is the text '0.5 m'", "a number"),
        ("12.5", "(mass - mass)", 12, "with mass = 1.0, length = 0.5", "xacro FILE"),
        ("/ 12}", "/ sqr(12)}", 11, "'sqr' is not", "mean `sqrt`?"),
        ("$(arg mass)", "$(arg mas)", 5, "argument mas", "mean `mass`?"),
        ('params="mass length"', 'params="mass length depth:=${no}"', 8, "'no' is not", "Define"),
        ('"mass" value', '"1mass" value', 5, "1mass", "xacro FILE"),
        ("<visual>", '<xacro:if value="${mass} x"/><visual>', 21, "not a boolean", "xacro FILE"),
        ("<visual>", '<xacro:insert_block name="b"/><visual>', 21, 'block "b"', "xacro FILE"),
        ('<link name="b', '<xacro:solidus/><link name="b', 15, "xacro:solidus", "mean `solid`?"),
        ("${length}\n", "\n${size}\n", 23, "'size' is not", "Define"),
        (
            "<visual>",
            "<origin xyz=\"${xacro.load_yaml('a.yml')}\"/><visual>",
            21,
            "a.yml",
            "spelling",
        ),
        ("</visual>", "</visul>", 23, "<visual> is closed by </visul>", "Write </visual>"),
        ("</visual>", "", 21, "<visual> is not closed", "Add </visual>"),
        ("give", "\ngive \udcff", 4, "0xff is not valid UTF-8", "UTF-8"),
        (
            ' xmlns:xacro="http://www.ros.org/wiki/xacro"',
            "",
            2,
            "line 4 uses the prefix `xacro:`",
            'Write line 2 as <robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">',
        ),
        ("<visual>", '<visual a:b="1">', 2, "line 21 uses the prefix `a:`", 'xmlns:a="a"'),
        ("<xacro:include", "<xacro:inclde", 7, "xacro:inclde", "mean `include`?"),
        ("<xacro:property", "<xacro:propery", 5, "xacro:propery", "mean `property`?"),
        ("filename", "filname", 7, "does not know `filname`", "mean `filename`?"),
        ("property name", "property nmae", 5, "does not know `nmae`", "mean `name`?"),
        (
            'property name="mass"',
            "property",
            5,
            "has no attribute `name`",
            '<xacro:property name="..."',
        ),
        ('"length" value', '"length" vlaue', 6, "no attribute `vlaue`", "mean `value`?"),
        ("<xacro:property name", "<property name", 17, "'mass' is not", "<xacro:property>"),
        ("$(find", "$(fnd", 7, "does not know the command `fnd`", "mean `find`?"),
    ],
)
def test_the_line_and_the_hint(  # noqa: PLR0917  cases
    model: Path, old: str, new: str, line: int, words: str, hint: str
) -> None:
    explanation = explanation_of(model, ROBOT.replace(old, new, 1))
    assert new.encode("utf-8", "surrogateescape") in (model / "robot.xacro").read_bytes()
    assert (explanation["file"], explanation["line"]) == (str(model / "robot.xacro"), line)
    assert words in explanation["message"]
    assert hint in explanation["hint"]


def explanation_of(model: Path, content: str) -> dict[str, Any]:
    (model / "robot.xacro").write_bytes(content.encode("utf-8", "surrogateescape"))
    explanation = expand(model / "robot.xacro", {}).error
    assert explanation is not None
    return explanation


def body(*lines: str) -> str:
    """A robot whose elements begin in line 2."""
    return "\n".join(
        ('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">', *lines, "</robot>")
    )


@pytest.mark.parametrize(
    ("use", "definition", "hint"),
    [
        ('<link name="${a}"/>', '<xacro:property name="a" value="1"/>', "line 3 of robot.xacro"),
        ("<xacro:a/>", '<xacro:macro name="a"><link/></xacro:macro>', "line 3 of robot.xacro"),
    ],
)
def test_what_is_defined_too_late(model: Path, use: str, definition: str, hint: str) -> None:
    explanation = explanation_of(model, body(use, definition))
    assert explanation["line"] == 2
    assert hint in explanation["hint"]


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be"])
def test_utf_16(model: Path, encoding: str) -> None:
    """In the file, and in one that it includes."""
    file = model / "robot.xacro"
    file.write_bytes(body('<link name="a"/>').encode(encoding))
    found = expand(file, {})
    if found.code:  # without a mark of the byte order, expat finds the encoding
        assert found.error is not None
        assert "UTF-16" in found.error["message"]
        assert "iconv -f UTF-16 -t UTF-8" in found.error["hint"]
    (model / "parts.xacro").write_bytes(body('<link name="a"/>').encode("utf-16"))
    explanation = explanation_of(model, body('<xacro:include filename="parts.xacro"/>'))
    assert explanation["file"] == str(model / "parts.xacro")
    assert "UTF-16" in explanation["message"]


@pytest.mark.parametrize(
    "use",
    [
        '<xacro:include filename="FILE"/>',
        '<xacro:property name="p" value="${xacro.load_yaml(\'FILE\')}"/><link name="${p}"/>',
    ],
)
def test_what_is_no_regular_file(model: Path, use: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is never opened: that could wait for ever."""
    os.mkfifo(model / "pipe")
    (model / "link").symlink_to("/dev/zero")
    for name, kind in (
        ("pipe", "a named pipe"),
        ("/dev/zero", "a device"),
        ("link", "a link to a device (/dev/zero)"),
        (str(model), "a folder"),
    ):
        explanation = explanation_of(model, body(use.replace("FILE", name)))
        assert explanation["message"].endswith(f"is {kind}, not a regular file")
        assert explanation["line"] == 2
    with socket.socket(socket.AF_UNIX) as end:
        monkeypatch.chdir(model)  # an address of a socket has few characters
        end.bind("s")
        assert "is a socket" in explanation_of(model, body(use.replace("FILE", "s")))["message"]


def test_errors_in_an_included_file(model: Path) -> None:
    include = '<xacro:include filename="robot.gazebo"/>'
    explanation = explanation_of(model, body(include))
    assert (explanation["file"], explanation["line"]) == (str(model / "robot.gazebo"), 1)
    assert "'length' is not defined" in explanation["message"]


@pytest.mark.parametrize(
    ("content", "line"),
    [
        ('<xacro:macro name="m">\n<link name="${no}"/></xacro:macro>', 3),
        ('<xacro:property name="p" value="a"/>\n\n<xacro:property name="q" value="${no}"/>', 4),
    ],
)
def test_what_an_included_file_defines(model: Path, content: str, line: int) -> None:
    """The error is found when the including file uses it; the included one is to be fixed."""
    (model / "parts.xacro").write_text(body(content))
    include = '<xacro:include filename="parts.xacro"/>'
    use = "<xacro:m/>" if "macro name" in content else '<link name="${q}"/>'
    explanation = explanation_of(model, body(include, use))
    assert (explanation["file"], explanation["line"]) == (str(model / "parts.xacro"), line)


def test_a_number_from_the_command_line(model: Path) -> None:
    file = model / "robot.xacro"
    file.write_text(ROBOT)
    explanation = expand(file, {"mass": "1,5"}).error
    assert explanation is not None
    assert explanation["line"] == 11
    assert "the value of `mass` is the text '1,5'" in explanation["message"]


@pytest.mark.parametrize(
    "content",
    [
        body('<xacro:macro name="m"><xacro:m/></xacro:macro>', "<xacro:m/>"),
        body('<xacro:include filename="robot.xacro"/>'),
    ],
)
def test_circles(model: Path, content: str) -> None:
    explanation = explanation_of(model, content)
    assert "infinite recursion" in explanation["message"]
    assert explanation["line"] == 2


def test_a_package_that_is_not_here(model: Path) -> None:
    """Which of them need not be here, the launch file's evaluation knows."""
    explanation = explanation_of(model, ROBOT.replace("$(find my_robot)", "$(find gazebo_ros)"))
    assert explanation["missing"].endswith("/opt/share/gazebo_ros/model/robot.gazebo")
    explanation = explanation_of(model, ROBOT.replace("$(find my_robot)", "$(find no_robot)"))
    assert (explanation["package"], explanation["line"]) == ("no_robot", 7)


def test_a_document_that_the_caller_opened(model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """xacro is not told its name."""
    monkeypatch.setattr(xacro, "parse", xacro.parse)  # set back afterwards
    monkeypatch.setattr(xacro, "process_doc", xacro.process_doc)
    Watch(lambda *_: None, lambda *_: None)
    file = model / "robot.xacro"
    for content, line in ((body('<link name="${no}"/>'), 2), (body("", "<link>"), 3)):
        file.write_text(content)
        with file.open() as stream, pytest.raises(Exception) as caught:  # noqa: PT011  any
            xacro.process_doc(xacro.parse(stream))
        explanation = explain_error(caught.value)
        assert explanation is not None
        assert (explanation["file"], explanation["line"]) == (str(file), line)


def test_what_is_not_from_xacro() -> None:
    with pytest.raises(ZeroDivisionError) as caught:
        _ = 1 / 0
    assert explain_error(caught.value) is None
