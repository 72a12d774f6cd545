"""Variants that each process prepares itself have the rows of those that one process prepares."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.isolation.result import Limits
from wsgen.model.sweep import Variant
from wsgen.sweeping import runner
from wsgen.sweeping.children import LocalExecutor
from wsgen.sweeping.robot_subjects import open_subject
from wsgen.sweeping.runner import Order, run_all
from wsgen.sweeping.subject import SubjectRequest

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.sweep import Row

pytestmark = pytest.mark.slow

BOX = """<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="height" default="0.2"/>
  <xacro:property name="h" value="$(arg height)"/>
  <link name="base">
    <inertial><mass value="${1 / h}"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
    </inertial>
    <collision><geometry><box size="0.1 0.1 ${h}"/></geometry></collision>
  </link>
</robot>
"""
SECONDS = 0.1


@pytest.mark.parametrize("seconds", [30.0, 0.0])
def test_the_rows_are_the_same(tmp_path: Path, seconds: float) -> None:
    """Also of a variant that does not expand, and where each call ends its process."""
    file = tmp_path / "box.urdf.xacro"
    file.write_text(BOX)
    request = SubjectRequest(file=file)
    heights = [0.1, 0.2, 0.0, 0.2, 0.4] if seconds else [0.1, 0.0]
    variants = [
        Variant(number=number, values={"height": height, "world.slope": 0.1 * number})
        for number, height in enumerate(heights)
    ]
    made: list[int] = []

    def in_order(rows: list[Row]) -> list[Row]:
        return sorted(rows, key=lambda row: row.number)

    with open_subject(request, environment=os.environ) as subject, LocalExecutor(2) as executor:

        def blueprint_of(variant: Variant) -> object:
            made.append(variant.number)
            return subject.prepare(variant.values)

        expected = [
            *run_all(executor, blueprint_of, variants, seconds=SECONDS, engine="bullet")  # type: ignore[arg-type]
        ]
        made.clear()
        found = [
            *runner.run_apart(
                executor,
                Order(subject=request, environment=dict(os.environ)),
                blueprint_of,  # type: ignore[arg-type]
                variants,
                seconds=SECONDS,
                engine="bullet",
                limits=Limits(seconds=seconds, wall_clock=60.0 if seconds else 0.01),
                count=len(variants),
            )
        ]
    assert in_order(found) == in_order(expected)
    assert [row.passed for row in in_order(found)].count(False) >= 1
    assert sorted(made) == ([] if seconds else [*range(len(variants))])
