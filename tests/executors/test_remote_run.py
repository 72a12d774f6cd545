"""`wsgen validate` and `check` with `--scheduler` say and draw what they do without."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace
from simulation.robots import cube_mesh
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import validate

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.executors.dask_cluster import DaskExecutor
    from wsgen.model.outcome import PackageOutcome

pytestmark = pytest.mark.slow

INERTIAL = """
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial>"""
BLOCK = f"""
<robot name="block">
  <link name="base">{INERTIAL}
    <visual><geometry><mesh filename="cube.obj" scale="0.1 0.1 0.1"/></geometry></visual>
    <collision><geometry><mesh filename="cube.obj" scale="0.1 0.1 0.1"/></geometry></collision>
  </link>
</robot>
"""
PIN = f"""
<robot name="pin">
  <link name="base">{INERTIAL}
    <visual><geometry><cylinder radius="0.02" length="1"/></geometry></visual>
    <collision><origin rpy="0.3 0 0"/><geometry><cylinder radius="0.02" length="1"/></geometry>
    </collision>
  </link>
</robot>
"""


def shown(outcome: PackageOutcome) -> tuple[object, ...]:
    assert outcome.picture is not None
    return (
        outcome.file,
        outcome.diagnostics,
        [(robot.entity, robot.passed, robot.rest) for robot in outcome.robots],
        outcome.picture.name,
        outcome.picture.read_bytes(),
    )


def test_it_says_and_draws_the_same(executor: DaskExecutor, tmp_path: Path) -> None:
    cube_mesh(tmp_path)
    files = [tmp_path / "block.urdf", tmp_path / "pin.urdf"]
    for file, text in zip(files, (BLOCK, PIN), strict=True):
        file.write_text(text)
    outcomes = [
        validate(
            None,
            ValidateRequest(
                files=files,
                seconds=1.0,
                picture_folder=tmp_path / (scheduler or "here").replace("/", ""),
                scheduler=scheduler,
            ),
            environment=os.environ,
        )
        for scheduler in (None, executor.address)
    ]
    here, there = ([*map(shown, outcome.packages)] for outcome in outcomes)
    assert here == there
    assert len(here) == 2
    assert not outcomes[0].passed  # the pin tips over


def test_packages_are_checked_the_same(
    executor: DaskExecutor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    workspace = copy_workspace("spawn_by_include", tmp_path)
    monkeypatch.chdir(workspace.root)
    environment = {"PATH": os.environ["PATH"]}
    here = check(CheckRequest(), environment=environment)
    there = check(CheckRequest(), environment=environment, executor=executor)
    assert there.diagnostics == here.diagnostics != ()
