"""Interfaces that PyPI lacks, and what is wrong in those of the workspace."""

import re
import sysconfig
from pathlib import Path

import pytest

from wsgen.errors import NotFoundError
from wsgen.ros.environment import messages
from wsgen.ros.environment.environment import pinned
from wsgen.ros.environment.interfaces import (
    FOLDER,
    buildable,
    dependencies,
    digest,
    in_order,
    read_interfaces,
    write_interfaces,
)
from wsgen.ros.environment.messages import python_headers, system_compiler
from wsgen.ros.environment.workspace_messages import _closure, _used

TYPE = r"([a-z][a-z0-9_]*/)?[A-Za-z][A-Za-z0-9]*(<=\d+)?(\[(<=)?\d*\])?"
FIELD = re.compile(rf"{TYPE} [a-z][a-z0-9_]*( \S+)?")
CONSTANT = re.compile(r"[a-z0-9]+ [A-Z][A-Z0-9_]* ?= ?\S+")


@pytest.mark.parametrize("package", buildable())
def test_interfaces_are_fields_and_constants_with_their_source(package: str) -> None:
    text = (FOLDER / f"{package}.txt").read_text(encoding="utf-8")
    assert re.search(r"^# Source: \S+, branch \S+\. Licence there: \S+\.$", text, re.MULTILINE)
    for name, lines in read_interfaces(package).items():
        kind, _, _ = name.partition("/")
        assert lines.count("---") == {"msg": 0, "srv": 1, "action": 2}[kind], name
        for line in lines:
            assert line == "---" or FIELD.fullmatch(line) or CONSTANT.fullmatch(line), line


def test_every_type_is_of_a_package_that_is_there() -> None:
    from_pypi = {
        line.partition("==")[0].removeprefix("ros-").replace("-", "_") for line in pinned()
    }
    for package in buildable():
        assert dependencies(package) <= from_pypi.union(buildable()), package


def test_what_is_used_is_built_first() -> None:
    assert dependencies("tf2_msgs") >= {"geometry_msgs", "builtin_interfaces", "service_msgs"}
    ordered = in_order({*buildable()})
    for package in ordered:
        before = ordered[: ordered.index(package)]
        assert dependencies(package).intersection(buildable()) <= {*before}
    assert len({digest(package) for package in buildable()}) == len(buildable())


def test_interfaces_are_written_as_files(tmp_path: Path) -> None:
    write_interfaces("tf2_msgs", tmp_path)
    assert (tmp_path / "msg" / "TFMessage.msg").read_text() == (
        "geometry_msgs/TransformStamped[] transforms\n"
    )
    assert (tmp_path / "srv" / "FrameGraph.srv").read_text() == "---\nstring frame_yaml\n"
    assert "<depend>geometry_msgs</depend>" in (tmp_path / "package.xml").read_text()


def test_types_of_other_packages_are_found(tmp_path: Path) -> None:
    file = tmp_path / "Mixed.msg"
    file.write_text(
        "# std_msgs/Header\nint32 a\ngeometry_msgs/Point[] b  # nav_msgs/Path\nOwn c\n"
        "string d 'sensor_msgs/Image'\nmore_msgs/Two[<=3] e\n"
    )
    assert _used(file) == [(3, "geometry_msgs"), (6, "more_msgs")]
    idl = tmp_path / "Mixed.idl"
    idl.write_text('#include "geometry_msgs/msg/Point.idl"\nmodule x { };\n')
    assert _used(idl) == [(1, "geometry_msgs")]


def test_packages_pass_on_what_they_depend_on(tmp_path: Path) -> None:
    for name, text in {
        "a": "<depend>b</depend><build_depend condition='x'> c </build_depend>",
        "b": "<exec_depend>d</exec_depend>",
    }.items():
        (tmp_path / "share" / name).mkdir(parents=True)
        (tmp_path / "share" / name / "package.xml").write_text(text)
        (tmp_path / "lib").mkdir(exist_ok=True)
        (tmp_path / "lib" / f"lib{name}__rosidl_generator_c.so").touch()
    assert _closure({"a"}, [tmp_path]) == {"a", "b", "c", "d"}


def test_the_compiler_of_the_system(tmp_path: Path) -> None:
    assert system_compiler({"PATH": str(tmp_path)}) is None
    for name in ("gcc", "g++"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    found = system_compiler({"PATH": str(tmp_path)})
    assert found is not None
    assert (found.c, found.cxx) == (("gcc",), ("g++",))
    chosen = system_compiler({"PATH": str(tmp_path), "CC": "ccache gcc", "CXX": "ccache 'g++'"})
    assert chosen is not None
    assert chosen.cxx == ("ccache", "g++")


def test_a_python_without_headers_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sysconfig, "get_path", lambda _: str(tmp_path))
    with pytest.raises(NotFoundError, match=r"Python\.h is missing") as caught:
        python_headers()
    assert f"python{sysconfig.get_python_version()}-dev" in caught.value.hint


def test_the_errors_of_a_compiler_are_reported() -> None:
    command = ["sh", "-c", "echo 'x.c:1: error: no' >&2; echo more >&2; exit 1"]
    with pytest.raises(NotFoundError, match=r"sh does not compile messages: x\.c:1: error: no\n"):
        messages.run_all([command], environment={"PATH": "/usr/bin:/bin"})
    with pytest.raises(NotFoundError, match="no-such-compiler does not compile"):
        messages.run_all([["no-such-compiler"]], environment={"PATH": "/usr/bin"})
