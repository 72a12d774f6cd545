"""Robots as other programs export them, for tests of `wsgen new --from`."""

import struct
from pathlib import Path

CUBE = [
    ((0, 0, 0), (0, 1, 0), (1, 1, 0)),
    ((0, 0, 0), (1, 1, 0), (1, 0, 0)),
    ((0, 0, 1), (1, 1, 1), (0, 1, 1)),
    ((0, 0, 1), (1, 0, 1), (1, 1, 1)),
    ((0, 0, 0), (1, 0, 0), (1, 0, 1)),
    ((0, 0, 0), (1, 0, 1), (0, 0, 1)),
    ((0, 1, 0), (1, 1, 1), (1, 1, 0)),
    ((0, 1, 0), (0, 1, 1), (1, 1, 1)),
    ((0, 0, 0), (0, 0, 1), (0, 1, 1)),
    ((0, 0, 0), (0, 1, 1), (0, 1, 0)),
    ((1, 0, 0), (1, 1, 1), (1, 0, 1)),
    ((1, 0, 0), (1, 1, 0), (1, 1, 1)),
]


def cube_stl(edge: float = 0.1) -> bytes:
    """A cube between the origin and (edge, edge, edge), m."""
    data = b"\0" * 80 + struct.pack("<I", len(CUBE))
    for triangle in CUBE:
        data += struct.pack("<3f", 0, 0, 0)
        data += b"".join(struct.pack("<3f", *(edge * one for one in corner)) for corner in triangle)
        data += b"\0\0"
    return data


CUBE_OBJ = """mtllib cube.mtl
v 0 0 0
v 0.1 0 0
v 0 0.1 0
v 0 0 0.1
usemtl red
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""

ARM = """<?xml version="1.0"?>
<robot name="two link arm">
  <link name="base">
    <visual>
      <geometry><mesh filename="package://arm_description/meshes/base part.stl"/></geometry>
    </visual>
    <collision>
      <geometry><box size="0.1 0.1 0.1"/></geometry>
    </collision>
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.004"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.1" rpy="0.1 0.2 0.3"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1.5" effort="10" velocity="2"/>
    <dynamics damping="0.5" friction="0.1"/>
  </joint>
  <link name="upper">
    <visual>
      <origin xyz="0 0 0.02" rpy="0 0 0"/>
      <geometry>
        <mesh filename="package://arm_description/meshes/cube.obj" scale="1 1 2"/>
      </geometry>
    </visual>
    <collision>
      <geometry>
        <mesh filename="package://arm_description/meshes/cube.obj" scale="1 1 2"/>
      </geometry>
    </collision>
    <inertial>
      <origin xyz="0.01 0 0.1" rpy="0 0 0.4"/>
      <mass value="0.5"/>
      <inertia ixx="0.002" ixy="0.0001" ixz="0" iyy="0.003" iyz="0" izz="0.0025"/>
    </inertial>
  </link>
</robot>
"""

MANIFEST = """<?xml version="1.0"?>
<package format="2">
  <name>arm_description</name>
  <version>1.2.0</version>
  <description>An arm</description>
  <maintainer email="ada@example.com">Ada</maintainer>
  <license>MIT</license>
  <buildtool_depend>catkin</buildtool_depend>
</package>
"""


def write_arm(folder: Path) -> Path:
    """Write the package `arm_description` of ROS 1 into a folder; its URDF."""
    package = folder / "arm_description"
    for name in ("urdf", "meshes"):
        (package / name).mkdir(parents=True)
    (package / "package.xml").write_text(MANIFEST)
    (package / "meshes" / "base part.stl").write_bytes(cube_stl())
    (package / "meshes" / "cube.obj").write_text(CUBE_OBJ)
    (package / "meshes" / "cube.mtl").write_text("newmtl red\nmap_Kd textures/red.png\n")
    (package / "meshes" / "textures").mkdir()
    (package / "meshes" / "textures" / "red.png").write_bytes(b"\x89PNG")
    urdf = package / "urdf" / "arm.urdf"
    urdf.write_text(ARM)
    return urdf
