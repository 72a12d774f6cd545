"""Processes that expand a xacro file into another file; what the end of a launch removes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from install_space import only_message

if TYPE_CHECKING:
    from install_space import InstallSpace


ROBOT = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
<xacro:arg name="size" default="1"/><link name="link_$(arg size)"/></robot>
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "process",
    [
        "ExecuteProcess(cmd=['xacro', '-o', 'r.urdf', MODEL, 'size:=2'])",
        "ExecuteProcess(cmd=['ros2', 'run', 'xacro', 'xacro', MODEL, 'size:=2', '-o', 'r.urdf'])",
        "ExecuteProcess(cmd=[['xacro ', MODEL, ' size:=2 > r.urdf && echo done']], shell=True)",
        "ExecuteProcess(cmd=['bash', '-c', ['cd /; xacro ', MODEL, ' size:=2 > ', 'r.urdf']])",
        "Node(package='xacro', executable='xacro', arguments=[MODEL, 'size:=2', '-o', 'r.urdf'])",
    ],
)
def test_what_xacro_writes(
    space: InstallSpace, process: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    model = space.add("my_robot", {"model/r.xacro": ROBOT}) / "model" / "r.xacro"
    plan = space.play(process, before=f"MODEL = '{model}'")
    assert not plan.diagnostics
    file = str(tmp_path / "r.urdf")
    assert "link_2" in plan.written[file]
    assert plan.written_from == {file: str(model)}
    assert not Path(file).exists()


@pytest.mark.slow
@pytest.mark.parametrize(("word", "count"), [("'size:=', rclpy.size", 1), ("'-', rclpy.size", 0)])
def test_arguments_that_are_unknown(space: InstallSpace, word: str, count: int) -> None:
    model = space.add("my_robot", {"model/r.xacro": ROBOT}) / "model" / "r.xacro"
    plan = space.play(
        f"ExecuteProcess(cmd=['xacro', '-o', 'r.urdf', '{model}', [{word}]])",
        before="import rclpy",
    )
    assert not plan.diagnostics
    assert len(plan.written) == count
    assert all("link_1" in text for text in plan.written.values())
    assert any("xacro" in entry.what for entry in plan.unresolved)


@pytest.mark.slow
def test_the_launch_file_can_read_what_it_writes(space: InstallSpace, tmp_path: Path) -> None:
    model = space.add("my_robot", {"model/r.xacro": ROBOT}) / "model" / "r.xacro"
    plan = space.play(
        "expand, RegisterEventHandler(OnProcessExit(target_action=expand, on_exit=["
        "OpaqueFunction(function=lambda _: [ExecuteProcess(cmd=[open(file).read()])])]))",
        before="import tempfile\nfile = tempfile.mktemp()\n"
        f"expand = ExecuteProcess(cmd=['xacro', '-o', file, '{model}'])",
        environment={"TMPDIR": str(tmp_path)},
    )
    assert not plan.diagnostics
    assert "link_1" in (plan.processes[-1].command or ("",))[0]
    assert not any(Path(file).exists() for file in plan.written)


@pytest.mark.slow
def test_a_xacro_file_that_cannot_be_expanded(space: InstallSpace) -> None:
    model = space.add("my_robot", {"model/r.xacro": "<robot name='${no}'/>"}) / "model" / "r.xacro"
    plan = space.play(f"ExecuteProcess(cmd=['xacro', '-o', 'r.urdf', '{model}'])")
    assert "'no' is not defined" in only_message(plan, "LCH008")


@pytest.mark.slow
@pytest.mark.parametrize(
    "end",
    [
        "RegisterEventHandler(OnShutdown(on_shutdown=[remove])), Shutdown()",
        "RegisterEventHandler(OnShutdown(on_shutdown=lambda *_: os.remove('/no'))), Shutdown()",
        "ExecuteProcess(cmd=['gz', 'sim'], on_exit=[remove])",
    ],
)
def test_what_the_end_of_a_launch_removes(space: InstallSpace, end: str) -> None:
    kept = space.add("my_robot", {"kept.sdf": "<sdf/>"}) / "kept.sdf"
    plan = space.play(
        end,
        before="def f(_):\n    try:\n        os.remove('/no/file')\n    finally:\n"
        f"        os.remove('{kept}')\nremove = OpaqueFunction(function=f)",
    )
    assert not plan.diagnostics
    assert kept.exists()
