"""What is measured of a robot that stands, for the tests to change."""

from __future__ import annotations

from wsgen.model.transform import Pose
from wsgen.simulation.scene import RobotRun

SPAWNED = Pose((0.0, 0.0, 0.3))
STANDS = RobotRun(
    entity="r",
    links=1,
    movable_joints=0,
    mass=1.0,
    spawn_pose=SPAWNED,
    overlaps=(),
    lowest_point=0.05,
    penetration=0.0,
    lowest_point_at_end=0.0,
    is_finite=True,
    settled_after=0.5,
    rest_pose=Pose((0.0, 0.0, 0.25)),
    speed=0.0,
    turning=0.0,
    joint_speed=0.0,
    highest_speed=1.0,
    highest_point=0.3,
    tilt=0.0,
    energy_gain=0.0,
    joint_positions={},
    joint_travel={},
)
