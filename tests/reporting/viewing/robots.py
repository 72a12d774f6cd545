"""A robot for the viewer, and what stands for the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from wsgen.model.transform import Pose
    from wsgen.reporting.viewing.drawing import DrawnRobot

# A gray post with an arm that turns to the right and to the left.
ARM = """\
<robot name="crane" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="parts.xacro"/>
  <link name="post">
    <xacro:solid mass="5"/>
    <visual><geometry><box size="0.1 0.1 0.6"/></geometry>
      <material name="gray"><color rgba="0.5 0.5 0.5 1"/></material></visual>
    <collision><geometry><box size="0.3 0.3 0.6"/></geometry></collision>
  </link>
  <link name="arm">
    <xacro:solid mass="1"/>
    <visual><origin xyz="0 0.3 0"/><geometry><box size="0.1 0.5 0.1"/></geometry>
      <material name="paint"><color rgba="${paint}"/></material></visual>
    <collision><origin xyz="0 0.3 0"/><geometry><box size="0.1 0.5 0.1"/></geometry></collision>
  </link>
  <link name="tip"/>
  <joint name="swing" type="revolute">
    <parent link="post"/><child link="arm"/><origin xyz="0 0 0.25"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="10" velocity="1"/>
  </joint>
  <joint name="end" type="fixed">
    <parent link="arm"/><child link="tip"/><origin xyz="0 0.6 0"/>
  </joint>
</robot>
"""
PARTS = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="paint" value="1 0 0 1"/>
  <xacro:macro name="solid" params="mass">
    <inertial><mass value="${mass}"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  </xacro:macro>
</robot>
"""
MANIFEST = """\
<package format="3"><name>crane</name><version>0.0.0</version><description>A crane.</description>
<maintainer email="a@b.cd">A</maintainer><license>MIT</license></package>
"""


def write_crane(folder: Path) -> Path:
    """A package with the robot; gives the xacro file."""
    (folder / "urdf").mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST)
    (folder / "urdf" / "parts.xacro").write_text(PARTS)
    file = folder / "urdf" / "crane.urdf.xacro"
    file.write_text(ARM)
    return file


class FakeViewer:
    """Remembers what it is told to show."""

    def __init__(self) -> None:
        self.robots: list[Sequence[DrawnRobot]] = []
        self.summary = ""
        self.diagnostics = ""
        self.poses: list[Mapping[str, Mapping[str, Pose]]] = []
        self.reported: list[tuple[str, bool]] = []

    def show(self, robots: Sequence[DrawnRobot], *, links: str) -> None:
        self.robots.append(robots)
        self.links = links

    def report(self, *, summary: str, diagnostics: str) -> None:
        self.summary, self.diagnostics = summary, diagnostics

    def put(self, poses: Mapping[str, Mapping[str, Pose]]) -> None:
        self.poses.append(poses)

    def notify(self, text: str, *, is_running: bool) -> None:
        self.reported.append((text, is_running))
