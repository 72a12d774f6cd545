"""The real xacro, in this process; `ament_index_python` is needed for `$(find)` alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.xacro.expansion import expand, expand_for_parent, run_command, warm_up
from wsgen.xacro.result import Expansion, ExpansionRequest

if TYPE_CHECKING:
    from pathlib import Path


HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'


def write(folder: Path, content: str) -> Path:
    file = folder / "r.xacro"
    file.write_text(f"{HEAD}{content}\n</robot>\n", encoding="utf-8")
    return file


def test_arguments_with_any_text(tmp_path: Path) -> None:
    file = write(tmp_path, '<xacro:arg name="a" default="1"/><link name="$(arg a)"/>')
    assert '<link name="1"/>' in expand(file, {}).stdout
    assert '<link name="x:=y z"/>' in expand(file, {"a": "x:=y z"}).stdout
    assert '<link name="1"/>' in expand(file, {}).stdout


def test_the_command_line(tmp_path: Path) -> None:
    file = write(tmp_path, '<xacro:arg name="a" default="1"/><link name="$(arg a)"/>')
    result = run_command(["xacro", str(file), "a:=2"])
    assert (result.code, result.stderr) == (0, "")
    assert result.stdout.endswith("</robot>\n")
    assert '<link name="2"/>' in result.stdout


def test_output_into_a_file(tmp_path: Path) -> None:
    file = write(tmp_path, '<link name="l"/>')
    result = run_command(["xacro", str(file), "-o", str(tmp_path / "r.urdf")])
    assert (result.code, result.stdout) == (0, "")
    assert '<link name="l"/>' in (tmp_path / "r.urdf").read_text()


@pytest.mark.parametrize("words", [[], ["a", "b"], ["--no-such-option", "a"]])
def test_wrong_command_lines(words: list[str]) -> None:
    result = run_command(["xacro", *words])
    assert result.code != 0
    assert result.stderr
    assert not result.stdout


def test_warnings_are_on_standard_error(tmp_path: Path) -> None:
    file = write(tmp_path, '<xacro:property name="pi" value="3"/>')
    result = run_command(["xacro", str(file)])
    assert result.code == 0
    assert "redefining global symbol" in result.stderr


def test_a_failure_leaves_nothing_for_the_next(tmp_path: Path) -> None:
    bad = write(tmp_path, "${1 +")
    assert expand(bad, {"a": "1"}).code != 0
    good = write(tmp_path, '<link name="${1 + 1}"/>')
    assert '<link name="2"/>' in expand(good, {}).stdout


@pytest.mark.parametrize(
    ("content", "line", "words"),
    [
        ('<link name="${no}"/>', 2, "'no' is not defined"),
        ('<link name="$(arg no)"/>', 2, "no"),
        ("<link>", 2, "<link> is not closed"),
        ("<xacro:no/>", 2, "unknown macro"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(
    tmp_path: Path, content: str, line: int, words: str
) -> None:
    file = write(tmp_path, content)
    result = expand(file, {})
    assert result.code != 0
    assert not result.stdout
    assert result.error is not None
    assert result.error["file"] == str(file)
    assert result.error.get("line") == line
    assert words in result.error["message"]
    assert result.error["hint"]


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    result = expand(tmp_path / "no.xacro", {})
    assert result.code != 0
    assert result.error is not None
    assert result.error["missing"] == str(tmp_path / "no.xacro")


def test_warming_up_leaves_nothing_behind(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        '<xacro:arg name="a" default="1"/><xacro:property name="size" value="2"/>'
        '<link name="l$(arg a)${size}"/>',
    )
    before = expand(file, {})
    warm_up()
    assert expand(file, {}) == before
    assert before.code == 0
    undefined = write(tmp_path, "<xacro:part/>")  # the macro that warming up defines
    assert expand(undefined, {}).code != 0
    undefined = write(tmp_path, '<link name="$(arg mass)"/>')
    assert expand(undefined, {}).code != 0


def test_the_arguments_that_files_declare(tmp_path: Path) -> None:
    (tmp_path / "part.xacro").write_text(f'{HEAD}<xacro:arg name="b" default="2"/></robot>')
    file = write(
        tmp_path,
        '<xacro:arg name="a" default="1"/><xacro:include filename="part.xacro"/>'
        '<xacro:if value="$(arg a)"><xacro:arg name="c" default="${1 + 2}"/></xacro:if>'
        '<link name="l"/>',
    )
    for given, expected in (
        ({}, {"a": "1", "b": "2", "c": "3"}),
        ({"a": "0", "unknown": "5"}, {"a": "0", "b": "2"}),
        ({"b": "x"}, {"a": "1", "b": "x", "c": "3"}),
    ):
        answer = expand_for_parent(ExpansionRequest(file=str(file), arguments=given))
        assert isinstance(answer, Expansion)
        assert answer.arguments == expected
