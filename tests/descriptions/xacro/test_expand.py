"""The real xacro, in this process; `ament_index_python` is needed for `$(find)` alone."""

from __future__ import annotations

import os
import sys
import time
from types import ModuleType
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.descriptions.xacro.expansion import expand, expand_for_parent, run_command, warm_up
from wsgen.descriptions.xacro.result import Expansion, ExpansionRequest
from wsgen.packages.source_shares import is_used, serve_sources

if TYPE_CHECKING:
    from collections.abc import Callable
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


def test_the_line_of_an_include_among_others(tmp_path: Path) -> None:
    (tmp_path / "one.xacro").write_text(f"{HEAD}</robot>")
    file = write(
        tmp_path,
        f'<xacro:property name="folder" value="{tmp_path}"/>\n'
        '<xacro:include filename="${folder}/one.xacro"/>\n'
        '<xacro:include filename="${folder}/two.xacro"/>',
    )
    error = expand(file, {}).error
    assert error is not None
    assert error.get("line") == 4


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


@pytest.fixture
def finding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ExpansionRequest:
    """A file that looks up the package `demo`, whose source is served."""
    source = tmp_path / "demo"
    source.mkdir()
    variables = serve_sources({"demo": source}, tmp_path / "served", {})
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    packages: Any = ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = "/share/{}".format
    monkeypatch.setitem(sys.modules, "ament_index_python", ModuleType("ament_index_python"))
    monkeypatch.setitem(sys.modules, packages.__name__, packages)
    file = write(tmp_path, '<link name="$(find demo)"/>')
    return ExpansionRequest(file=str(file), arguments={})


def test_packages_that_are_found_are_noted(finding: ExpansionRequest) -> None:
    assert not is_used("demo", os.environ)
    answer = expand_for_parent(finding)
    assert isinstance(answer, Expansion)
    assert '"/share/demo"' in answer.urdf
    assert is_used("demo", os.environ)


def test_one_process_expands_any_number_of_files(finding: ExpansionRequest) -> None:
    first = expand_for_parent(finding)
    assert isinstance(first, Expansion)
    args: Any = sys.modules["xacro.substitution_args"]
    for find in (args._eval_find, args._eval_dict["find"]):
        assert wrapped(find) == 1
    before = [args._eval_find, args._eval_dict["find"]]
    for _ in range(3):
        assert expand_for_parent(finding) == first
    assert [args._eval_find, args._eval_dict["find"]] == before


@pytest.mark.slow
def test_twelve_hundred_expansions(finding: ExpansionRequest) -> None:
    """More than Python lets functions call each other."""
    first = expand_for_parent(finding)
    assert isinstance(first, Expansion)
    started = time.process_time()
    assert all(expand_for_parent(finding) == first for _ in range(1200))
    assert time.process_time() - started < 10.0


def wrapped(function: Callable[..., Any]) -> int:
    """How many functions a function calls one through the other."""
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    return sum(1 + wrapped(one) for one in cells if callable(one))
