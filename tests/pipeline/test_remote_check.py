"""Packages checked where nothing is but what is sent: the same is reported."""

from __future__ import annotations

import os
import shutil
import sys
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, cast

import pytest

from kind_workspaces import WORKSPACES
from wsgen.errors import RequestError
from wsgen.events import StepEnded
from wsgen.executors import archive
from wsgen.executors.local import LocalExecutor
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.remote_check import Shipment, check_there

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.events import Event

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="moves folders away that are in use"),
]


class Elsewhere:
    """An executor whose calls are computed while a folder of this machine is away."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.answered = 0  # calls whose answer counts
        self.called = 0
        self.executor = LocalExecutor(1)

    def submit(self, function: Callable[..., Any], *arguments: Any, **options: Any) -> Future[Any]:
        result: Future[Any] = Future()
        away = self.folder.rename(self.folder.with_name("away"))
        try:
            answer = self.executor.submit(function, *arguments, **options).result()
        finally:
            away.rename(self.folder)
        self.called += 1
        self.answered += answer["found"] is not None
        result.set_result(answer)
        return result


@pytest.fixture
def machine(tmp_path: Path) -> Iterator[Elsewhere]:
    (tmp_path / "machine").mkdir()
    made = Elsewhere(tmp_path / "machine")
    yield made
    made.executor.shutdown()


def compare(
    machine: Elsewhere,
    paths: Sequence[Path] = (),
    *,
    environment: Mapping[str, str] | None = None,
    listener: Callable[[Event], None] | None = None,
) -> int:
    """The number of diagnostics, which are the same here and there."""
    variables = {"PATH": os.environ["PATH"], "HOME": str(machine.folder), **(environment or {})}
    request = CheckRequest(paths=paths)
    here = check(request, environment=variables)
    there = check(
        request, environment=variables, executor=cast("LocalExecutor", machine), listener=listener
    )
    assert there.diagnostics == here.diagnostics
    assert (there.packages, there.folders, there.files) == (
        here.packages,
        here.folders,
        here.files,
    )
    return len(here.diagnostics)


def test_workspaces_of_all_kinds(machine: Elsewhere, monkeypatch: pytest.MonkeyPatch) -> None:
    source = machine.folder / "ws" / "src"
    for kind in WORKSPACES.iterdir():
        if kind.is_dir():
            shutil.copytree(kind, source / kind.name)
    description = next(source.rglob("trolley_description"))
    description.rename(machine.folder / "elsewhere")
    description.symlink_to(machine.folder / "elsewhere")
    monkeypatch.chdir(machine.folder / "ws")
    heard: list[Event] = []
    assert compare(machine, listener=heard.append) > 20
    assert machine.answered == machine.called > 20
    assert sum(isinstance(event, StepEnded) for event in heard) == machine.called
    one = next(source.rglob("*.launch.py"))
    lone = machine.folder / "lone.urdf"
    lone.write_text("<robot name='r'><link name='a'/></robo>")
    assert compare(machine, [one, source / "bare_repository", lone]) > 2


MANIFEST = "<package format='3'><name>{}</name><version>0.0.1</version>{}</package>"
ROBOT = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:include filename="$(find under_description)/urdf/wheel.xacro"/>
<xacro:wheel name="left"/>
<link name="base"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>
"""
WHEEL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="wheel" params="name">
<link name="${name}"><inertial><mass value="-1"/></inertial></link></xacro:macro></robot>
"""


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def test_other_install_spaces_and_what_is_of_this_machine(
    machine: Elsewhere, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    under = machine.folder / "under"
    index = "share/ament_index/resource_index/packages"
    write(
        under,
        {
            f"{index}/under_description": "",
            f"{index}/unused": "",
            "share/under_description/package.xml": MANIFEST.format("under_description", ""),
            "share/under_description/urdf/wheel.xacro": WHEEL,
            "share/unused/secret.yaml": "not asked for",
        },
    )
    mesh = tmp_path / "of_machine.stl"
    mesh.write_text("solid x")
    source = machine.folder / "ws" / "src"
    for name, address in {
        "over": "package://over/meshes/missing.stl",
        "other": f"file://{mesh}",
        "another": "package://other/meshes/missing.stl",
    }.items():
        depend = "<exec_depend>under_description</exec_depend>"
        write(
            source / name,
            {
                "package.xml": MANIFEST.format(name, depend),
                "urdf/robot.urdf.xacro": ROBOT.format(address),
            },
        )
    monkeypatch.chdir(machine.folder / "ws")
    environment = {"AMENT_PREFIX_PATH": f"{under}:{tmp_path / 'no-prefix'}"}
    assert compare(machine, environment=environment) > 3
    # `other` names a file of this machine, and `another` names it.
    assert machine.answered == machine.called == 1
    assert compare(machine, [under], environment={}) > 0
    monkeypatch.setattr(archive, "MOST_BYTES", 10)
    with pytest.raises(RequestError, match="to be sent to the workers"):
        compare(machine)


def test_a_worker_that_has_lost_the_archive(tmp_path: Path) -> None:
    shipment = Shipment(parts=(tmp_path / "header", tmp_path / "missing"))
    assert check_there(shipment, 0) == {"found": None}
    gone = Shipment(parts=(tmp_path / "gone" / "header",))
    assert check_there(gone, 0) == {"found": None}


def test_what_the_machine_may_have_caused_is_checked_here(
    machine: Elsewhere, monkeypatch: pytest.MonkeyPatch
) -> None:
    launch = "import {}\ndef generate_launch_description():\n    return 1 / 0\n"
    write(
        machine.folder / "ws" / "src" / "pkg",
        {
            "package.xml": MANIFEST.format("pkg", ""),
            "CMakeLists.txt": "cmake_minimum_required(VERSION 3.16)\nproject(pkg NONE)\n"
            "find_package(ament_cmake REQUIRED)\n"
            "install(DIRECTORY launch DESTINATION share/pkg)\nament_package()\n",
            "launch/one.launch.py": launch.format("module_of_nobody"),
        },
    )
    monkeypatch.chdir(machine.folder / "ws")
    assert compare(machine) > 1
    assert (machine.called, machine.answered) == (1, 0)
