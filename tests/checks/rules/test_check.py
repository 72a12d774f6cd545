"""All rules together: which diagnostics a robot and a simulation end with."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from checks.rules.robot_runs import STANDS
from wsgen.checks.rules.check import check_robot
from wsgen.checks.rules.check_run import check_run, passive_joints
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    Collision,
    GazeboTag,
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mesh,
    Plugin,
    Robot,
)
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.simulation.scene import Overlapping, RobotRun

WORLD = World(name="w", has_ground_plane=True)
BODY = Inertial(mass=1.0, inertia=(0.1, 0.0, 0.0, 0.1, 0.0, 0.1))
ROBOT = Robot(name="r", root="base", links=(Link(name="base", inertial=BODY),))
INSIDE = Overlapping(link="base", other_entity=None, other_link="arm", depth=0.1)
IN_ANOTHER = replace(INSIDE, other_entity="s")


def with_joint(kind: JointType, limit: JointLimit | None = None) -> Robot:
    arm = Joint(name="arm", type=kind, parent="base", child="arm", limit=limit)
    out = replace(BODY, mass=0.5, pose_in_link=Pose((0.0, 0.3, 0.0)))
    base = replace(BODY, mass=0.5)
    links = (Link(name="base", inertial=base), Link(name="arm", inertial=out))
    return replace(ROBOT, links=links, joints=(arm,))


ARM = with_joint(JointType.REVOLUTE, JointLimit(lower=-1.0, upper=1.0))
HANGS = replace(STANDS, movable_joints=1, joint_positions={"arm": 0.0}, joint_travel={"arm": 0.0})
GAVE_WAY = replace(HANGS, joint_positions={"arm": 0.9}, joint_travel={"arm": 0.9})


def codes(robot_run: RobotRun, *, robot: Robot = ROBOT, world: World = WORLD) -> list[str]:
    return [found.code for found in check_run(robot, world, robot_run)]


def test_what_its_limits_push_is_not_reported_as_moved_by_gravity() -> None:
    assert [found.code for found in check_run(ARM, WORLD, GAVE_WAY)] == ["SPN060"]
    beyond = with_joint(JointType.REVOLUTE, JointLimit(lower=0.8, upper=2.0))
    assert check_run(beyond, WORLD, GAVE_WAY, pushed={"arm"}) == ()
    near = with_joint(JointType.REVOLUTE, JointLimit(lower=0.2, upper=2.0))
    found = check_run(near, WORLD, GAVE_WAY, pushed={"arm"})
    assert [one.code for one in found] == ["SPN060"]


def test_a_robot_that_is_too_deep_in_the_ground_falls_for_that() -> None:
    deep = replace(
        STANDS, penetration=20.0, lowest_point=-20.0, lowest_point_at_end=-64.0, settled_after=None
    )
    (found,) = check_run(ROBOT, WORLD, deep)
    assert (found.code, found.severity) == ("SPN053", Severity.ERROR)


SINKS = replace(STANDS, lowest_point=5.0, lowest_point_at_end=-44.0, settled_after=None, speed=29.0)
IN_WATER = replace(WORLD, plugins=("gz-sim-buoyancy-system",))


def floating(filename: str) -> Robot:
    return replace(ROBOT, gazebo=(GazeboTag(reference=None, plugins=(Plugin(filename, {}),)),))


def test_what_water_carries_does_not_fall() -> None:
    assert codes(SINKS) == ["SPN054", "SPN056"]
    (found,) = check_run(ROBOT, IN_WATER, SINKS)
    assert (found.code, found.severity) == ("SPN109", Severity.INFO)
    assert "`gz-sim-buoyancy-system`" in found.message
    for plugin in ("libBuoyancyPlugin.so", "libuuv_underwater_object_ros_plugin.so"):
        assert codes(SINKS, robot=floating(plugin)) == ["SPN109"]
        # Of another model of the world.
        assert codes(SINKS, world=replace(WORLD, plugins=(plugin,))) == ["SPN054", "SPN056"]
    # Motors alone hold nothing without a command; and who stands, stands.
    assert codes(SINKS, robot=floating("gz-sim-thruster-system")) == ["SPN054", "SPN056"]
    assert codes(STANDS, world=IN_WATER) == []
    assert codes(replace(SINKS, mass=2.0), world=IN_WATER) == ["SPN050", "SPN109"]


def test_what_lacks_a_collision_mesh_falls_for_that_reason() -> None:
    for path, expected in ((None, ["SPN054"]), ("/m/hull.stl", ["SPN054", "SPN056"])):
        hull = Collision(geometry=Mesh(uri="model://m/hull.stl", path=path))
        crate = replace(ROBOT, links=(Link(name="base", inertial=BODY, collisions=(hull,)),))
        assert codes(SINKS, robot=crate) == expected


def test_a_robot_that_stands() -> None:
    assert codes(STANDS) == []
    assert codes(HANGS, robot=ARM) == []


@pytest.mark.parametrize(
    ("measured", "expected"),
    [
        ({"mass": 2.0}, ["SPN050"]),
        ({"movable_joints": 1}, ["SPN051"]),
        ({"is_finite": False, "tilt": 3.0, "energy_gain": 1e9}, ["SPN052"]),
        ({"is_cut_short": True, "settled_after": None, "tilt": 3.0}, ["SPN090"]),
        ({"penetration": 0.25, "lowest_point": -0.25}, ["SPN053"]),
        ({"lowest_point": 2.0}, ["SPN054"]),
        ({"lowest_point_at_end": -0.1}, ["SPN055"]),
        ({"lowest_point_at_end": -0.1, "settled_after": None}, ["SPN055"]),
        ({"lowest_point_at_end": -0.1, "settled_after": None, "speed": 0.2, "climb": 0.2}, []),
        ({"lowest_point_at_end": -44.0, "settled_after": None, "tilt": 1.0}, ["SPN056"]),
        ({"highest_point": 20.0}, ["SPN057"]),
        ({"settled_after": None, "speed": 1.0}, ["SPN058"]),
        ({"tilt": math.pi / 2}, ["SPN059"]),
        ({"tilt": 0.1}, ["SPN067"]),
        ({"tilt": 0.1, "settled_after": None, "speed": 1.0}, ["SPN058"]),  # not at rest
        ({"tilt": 0.1, "lowest_point_at_end": 0.1}, []),  # on something else than the ground
        ({"tilt": 0.1, "overlaps": (IN_ANOTHER,)}, ["SPN063"]),  # which pushes it
        ({"energy_gain": 500.0, "highest_point": 20.0, "tilt": 3.0}, ["SPN061"]),
        ({"overlaps": (IN_ANOTHER,)}, ["SPN063"]),
        ({"overlaps": (INSIDE,)}, []),
    ],
)
def test_each_fault_is_found_and_nothing_else(
    measured: dict[str, object], expected: list[str]
) -> None:
    assert codes(replace(STANDS, **measured)) == expected  # type: ignore[arg-type]


def test_what_leans_for_another_reason_does_not_lean() -> None:
    tilted = replace(STANDS, tilt=0.1)
    assert check_run(ROBOT, WORLD, tilted, is_alone=False) == ()
    assert codes(tilted, world=replace(WORLD, has_ground_plane=False)) == []
    assert codes(replace(GAVE_WAY, tilt=0.1), robot=ARM) == ["SPN060"]
    fixed = replace(ROBOT, fixed_to_world=True)
    assert codes(tilted, robot=fixed) == []


def test_without_a_ground_there_is_nothing_to_be_born_in() -> None:
    robot_run = replace(STANDS, lowest_point=5.0)
    assert codes(robot_run, world=replace(WORLD, has_ground_plane=False)) == []


def test_out_of_the_ground_is_not_into_the_air() -> None:
    """It comes up by as much as it was in it."""
    robot_run = replace(
        STANDS, penetration=0.6, lowest_point=-0.6, highest_point=0.9, energy_gain=6.0
    )
    assert codes(robot_run) == ["SPN053"]
    assert codes(replace(robot_run, highest_point=1.5)) == ["SPN053", "SPN057"]


def test_out_of_another_body_is_not_into_the_air() -> None:
    deep = replace(IN_ANOTHER, depth=0.6)
    robot_run = replace(STANDS, overlaps=(deep,), highest_point=0.9, energy_gain=6.0)
    assert codes(robot_run) == ["SPN063"]
    assert codes(replace(robot_run, highest_point=1.5)) == ["SPN063", "SPN057"]


def test_what_follows_from_an_overlap_is_not_said_of_the_robot() -> None:
    robot_run = replace(
        STANDS,
        overlaps=(IN_ANOTHER,),
        tilt=1.0,
        settled_after=None,
        speed=1.0,
        lowest_point_at_end=-0.1,
        energy_gain=99.0,
    )
    assert codes(robot_run) == ["SPN063"]
    shallow = replace(robot_run, overlaps=(replace(IN_ANOTHER, depth=0.01),), energy_gain=0.0)
    assert codes(shallow) == ["SPN063", "SPN055", "SPN059"]


@pytest.mark.parametrize(
    ("depth", "tilt", "others", "severity"),
    [
        (0.05, 0.0, {"s"}, Severity.WARNING),
        (0.05, 1.0, {"s"}, Severity.ERROR),
        (0.20, 0.0, {"s"}, Severity.ERROR),
        (0.05, 0.0, set(), Severity.ERROR),
    ],
)
def test_a_robot_that_is_pushed_out_of_a_model_of_the_world(
    depth: float, tilt: float, others: set[str], severity: Severity
) -> None:
    inside = replace(IN_ANOTHER, depth=depth)
    robot_run = replace(STANDS, overlaps=(inside,), tilt=tilt)
    found = check_run(ARM, WORLD, robot_run, static_models=others)
    assert [one.severity for one in found if one.code == "SPN063"] == [severity]


def test_energy_is_measured_in_the_gravity_of_the_world() -> None:
    robot_run = replace(STANDS, energy_gain=1.5)
    assert codes(robot_run) == ["SPN061"]
    assert codes(robot_run, world=replace(WORLD, gravity=(0.0, 15.0, -15.0))) == []


def test_a_robot_that_is_fixed_to_the_world_stands_by_that() -> None:
    fixed = replace(ARM, fixed_to_world=True)
    robot_run = replace(HANGS, lowest_point=2.0, lowest_point_at_end=-0.01, tilt=1.0)
    assert codes(robot_run, robot=fixed) == []
    assert codes(replace(robot_run, penetration=0.3), robot=fixed) == []
    swings = replace(GAVE_WAY, settled_after=None, lowest_point_at_end=-9.0, highest_point=9.0)
    assert codes(swings, robot=fixed) == ["SPN060"]
    assert codes(replace(swings, energy_gain=99.0), robot=fixed) == ["SPN061"]


def test_a_static_robot_has_nothing_but_its_figures() -> None:
    static = replace(ARM, is_static=True)
    robot_run = replace(
        STANDS, lowest_point=-3.0, penetration=3.0, lowest_point_at_end=-3.0, tilt=1.0
    )
    assert codes(robot_run, robot=static) == []
    assert codes(replace(robot_run, movable_joints=1), robot=static) == ["SPN051"]
    assert (
        codes(replace(robot_run, overlaps=(IN_ANOTHER,)), robot=static) == []
    )  # the other says it


def test_joints_that_are_held_do_not_bolt_it_down() -> None:
    held = replace(ARM, joints=tuple(replace(joint, is_held=True) for joint in ARM.joints))
    (found,) = check_run(held, WORLD, replace(HANGS, tilt=1.0))
    assert found.code == "SPN059"
    assert "bolted" in (found.hint or "")


def test_passive_joints_excuse_the_robot() -> None:
    assert codes(GAVE_WAY, robot=ARM) == ["SPN060"]
    swings = replace(GAVE_WAY, settled_after=None, joint_speed=2.0)
    assert codes(swings, robot=ARM) == ["SPN060"]
    pulled = replace(swings, speed=0.5, tilt=1.0)
    found = check_run(ARM, WORLD, pulled)
    assert [(one.code, one.severity.value) for one in found] == [
        ("SPN058", "warning"),
        ("SPN059", "warning"),
        ("SPN060", "info"),
    ]


def test_a_joint_that_is_torn_beyond_its_limit() -> None:
    robot_run = replace(HANGS, joint_positions={"arm": 1.5}, joint_travel={"arm": 1.5})
    assert codes(robot_run, robot=ARM) == ["SPN062", "SPN060"]


def test_overlapping_links_count_where_they_may_collide() -> None:
    robot_run = replace(HANGS, overlaps=(INSIDE,))
    assert codes(robot_run, robot=ARM) == []
    links = tuple(replace(link, self_collide=True) for link in ARM.links)
    assert codes(robot_run, robot=replace(ARM, links=links)) == ["SPN064"]


@pytest.mark.parametrize(
    ("kind", "travel", "has_passive_joints"),
    [
        (JointType.REVOLUTE, 0.09, False),
        (JointType.REVOLUTE, 0.11, True),
        (JointType.CONTINUOUS, 0.11, True),
        (JointType.PRISMATIC, 0.009, False),
        (JointType.PRISMATIC, 0.011, True),
    ],
)
def test_play_is_no_giving_way(kind: JointType, travel: float, *, has_passive_joints: bool) -> None:
    robot_run = replace(HANGS, joint_travel={"arm": travel})
    expected = {"arm": travel} if has_passive_joints else {}
    assert passive_joints(with_joint(kind), robot_run) == expected


def test_wheels_that_roll_do_not_give_way() -> None:
    robot = with_joint(JointType.CONTINUOUS)
    wheel = replace(robot.links[1], inertial=BODY)
    robot = replace(robot, links=(robot.links[0], wheel))
    assert passive_joints(robot, replace(HANGS, joint_travel={"arm": 9.0})) == {}


def test_all_rules_over_a_description_are_asked() -> None:
    """A heavy robot of absurd inertia with nothing to touch, a loose part and a jolting joint."""
    frame = Link(name="dummy")
    links = (frame, Link(name="base", inertial=BODY), Link(name="off", inertial=BODY))
    joints = (
        Joint(name="a", type=JointType.FIXED, parent="dummy", child="base"),
        Joint(name="b", type=JointType.FLOATING, parent="base", child="off"),
        Joint(
            name="c",
            type=JointType.REVOLUTE,
            parent="base",
            child="jolts",
            limit=JointLimit(lower=0.5, upper=1.0, effort=1.0, velocity=1.0),
        ),
    )
    robot = Robot(
        name="r",
        root="dummy",
        links=(*links, Link(name="jolts", inertial=BODY)),
        joints=joints,
    )
    found = [one.code for one in check_robot(robot, None)]
    assert found == ["ROB051", "ROB053", "ROB055", "ROB070"]
