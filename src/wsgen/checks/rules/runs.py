"""Rules about what a simulation measured, of one robot, of a scene, and in several engines.

The parameters of a check are facts in SI units; a check yields what it reports. An unactuated joint
is one that gravity can move, other than the axle of a wheel; it is passive when gravity did move
it. Such a joint needs a controller, not a better description.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.model.engines import GAZEBO, RESULT_NAMES, name_engines
from wsgen.model.robot import JointType
from wsgen.model.transform import angle_between
from wsgen.text.suggestions import some_named, some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Joint
    from wsgen.model.transform import Pose
    from wsgen.model.world import SpawnHeight
    from wsgen.simulation.engine import HullGap
    from wsgen.simulation.scene import Overlapping, RobotRun


MASS_TOLERANCE = 1e-6  # relative; the engine computes in double precision
CONTACT_SLACK = 0.005  # m; collision margins and contact softness stay below this
RISING = 0.01  # m/s; slower is no way out: DART lifts what is in the ground by 1 mm/s
WAY_OUT = 3.0  # s; what rises so fast that it is out by then is not stuck
HIGH_SPAWN = 1.0  # m; a fall from here hurts a real robot
TIPPED = math.radians(15)  # what a person calls leaning over
FALLEN = 0.5  # m further down than at the start: no contact holds the robot
SEEN = 0.01  # rad/s or m/s; slower motion is not worth reporting
THROWN = 0.5  # m above where it was spawned: contact forces have shot it up
CREEPING = 0.05  # m/s; slower, and a robot rocks or rolls out: it will stand
ROCKING = 0.3  # rad/s
STANDARD_GRAVITY = 9.8  # m/s²
LIFTED = 0.1  # m; a gain of energy that could lift the robot higher is reported
BEYOND = {JointType.REVOLUTE: 0.05, JointType.PRISMATIC: 0.01}  # rad, m; limits are a little soft
NAMED = 3  # at most so many joints are named in a message


MASS_DIFFERS = Rule(
    code="SPN050",
    name="mass-differs",
    severity=Severity.ERROR,
    summary="The engine simulates a different mass than the description gives.",
    what="Compares the total mass in the engine with that of the model that Gazebo builds.",
    why="All forces, speeds and contacts of the simulation are wrong.",
    example="# no description is known to cause this",
    instead="# report it with the description of the robot",
)


def mass_differs(entity: str, described_mass: float, simulated_mass: float) -> Iterator[Diagnostic]:
    """Report a mass in the engine that differs from that of the description."""
    if not math.isclose(described_mass, simulated_mass, rel_tol=MASS_TOLERANCE, abs_tol=1e-9):
        yield MASS_DIFFERS.at(
            None,
            element=entity,
            message=f"The engine simulates {simulated_mass:g} kg, but the mass in the description "
            f"is {described_mass:g} kg.",
            hint="Report this error of wsgen, with the description; do not rely on the simulation.",
        )


JOINTS_DIFFER = Rule(
    code="SPN051",
    name="joints-differ",
    severity=Severity.ERROR,
    summary="The engine moves a different number of joints than the description has.",
    what="Compares the movable joints in the engine with those of the model that Gazebo builds.",
    why="If a joint is missing, a part of the robot cannot move or falls off.",
    example="# no description is known to cause this",
    instead="# report it with the description of the robot",
)


def joints_differ(
    entity: str, described_joints: int, simulated_joints: int
) -> Iterator[Diagnostic]:
    """Report a number of joints in the engine that differs from the description's."""
    if described_joints != simulated_joints:
        yield JOINTS_DIFFER.at(
            None,
            element=entity,
            message=f"The engine moves {simulated_joints} joints, but the description has "
            f"{described_joints}.",
            hint="Report this error of wsgen, with the description; do not rely on the simulation.",
        )


STATE_NOT_FINITE = Rule(
    code="SPN052",
    name="state-not-finite",
    severity=Severity.ERROR,
    summary="A position of the robot became infinite or not-a-number.",
    what="Checks every pose and speed of the simulation.",
    why="The simulation exploded. Gazebo stops with an assertion or shows nothing.",
    example='<inertia ixx="1e-12" iyy="1e-12" izz="1e-12" ixy="0" ixz="0" iyz="0"/>',
    instead="Use SI units for masses, inertias and sizes, and no zero or huge values.",
)


def state_not_finite(entity: str, *, is_finite: bool) -> Iterator[Diagnostic]:
    """Report a pose that became infinite or not-a-number."""
    if not is_finite:
        yield STATE_NOT_FINITE.at(
            None,
            element=entity,
            message="The pose of the robot became infinite or not-a-number: the simulation "
            "exploded.",
            hint="Check masses, inertias, axes and sizes: use SI units, and no zero or huge "
            "values.",
        )


CUT_SHORT = Rule(
    code="SPN090",
    name="cut-short",
    severity=Severity.ERROR,
    summary="The simulation ended early because the state of another robot was not finite.",
    why="The robot was not simulated to the end: it has no result.",
    example="Two robots are spawned, and the simulation of one explodes.",
    instead="Fix the errors of the other robot.",
)


def cut_short(entity: str, *, is_cut_short: bool) -> Iterator[Diagnostic]:
    """Report a run that ended early because of another robot."""
    if is_cut_short:
        yield CUT_SHORT.at(
            None,
            element=entity,
            message="The robot was not simulated to the end: the pose of another robot became "
            "infinite or not-a-number.",
            hint="Fix the errors of the other robot first.",
        )


SPAWNED_IN_GROUND = Rule(
    code="SPN053",
    name="spawned-in-ground",
    severity=Severity.WARNING,
    severity_varies="an error where it falls, because it is too deep to be pushed out",
    summary="The spawn pose puts part of the robot into the ground.",
    what="Measures the lowest point of the robot's collision shapes when it is spawned.",
    why="The simulator pushes the robot out. Depending on the engine it jumps, tips over or stays "
    "stuck.",
    example='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "0.0"]',
    instead='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "0.1"]',
)


def spawned_in_ground(
    entity: str,
    penetration: float,
    spawn_z: float,
    height: SpawnHeight | None = None,
) -> Iterator[Diagnostic]:
    """Report a robot that is partly in the ground when it is spawned."""
    if penetration > CONTACT_SLACK:
        yield SPAWNED_IN_GROUND.at(
            height.file if height else None,
            height.line if height else None,
            entity,
            message=f"The robot is spawned {penetration:.3f} m deep in the ground "
            f"(spawn height z = {spawn_z:g} m).",
            hint=_spawn_at(spawn_z, penetration + CONTACT_SLACK, "or higher", height),
        )


SPAWNED_HIGH = Rule(
    code="SPN054",
    name="spawned-high",
    severity=Severity.WARNING,
    summary="The robot is spawned more than 1 m above the ground.",
    what="Measures the lowest point of the robot's collision shapes when it is spawned.",
    why="The impact moves joints and changes the final pose. A real robot would break.",
    example='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "5.0"]',
    instead='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "0.1"]',
)


def spawned_high(
    entity: str, clearance: float, spawn_z: float, height: SpawnHeight | None = None
) -> Iterator[Diagnostic]:
    """Report a robot that is dropped from more than a meter."""
    if clearance > HIGH_SPAWN:
        yield SPAWNED_HIGH.at(
            height.file if height else None,
            height.line if height else None,
            entity,
            message=f"The robot is spawned {clearance:.2f} m above the ground and falls "
            f"(spawn height z = {spawn_z:g} m).",
            hint=_spawn_at(spawn_z, CONTACT_SLACK - clearance, "to place it on the ground", height),
        )


def is_on_its_way_out(depth_at_end: float, climb: float) -> bool:
    """Whether a robot that is in the ground (m) rises (m/s) fast enough to get out."""
    return climb > RISING and depth_at_end < climb * WAY_OUT


STUCK_IN_GROUND = Rule(
    code="SPN055",
    name="stuck-in-ground",
    severity=Severity.ERROR,
    summary="The robot is in the ground at the end of the simulation.",
    what="Measures the lowest point of the robot's collision shapes at the end. A robot that is "
    "rising and would be out of the ground within 3 s is not reported.",
    why="The robot sinks in or cannot leave the ground: contacts are too soft, or shapes block "
    "each other.",
    example='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "-1.0"]',
    instead='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "0.1"]',
)


def stuck_in_ground(entity: str, depth_at_end: float, climb: float) -> Iterator[Diagnostic]:
    """Report a robot that is in the ground at the end."""
    if depth_at_end > CONTACT_SLACK and not is_on_its_way_out(depth_at_end, climb):
        yield STUCK_IN_GROUND.at(
            None,
            element=entity,
            message=f"The robot is {depth_at_end:.3f} m deep in the ground at the end.",
            hint="Spawn it above the ground, and check its collision shapes.",
        )


def _spawn_at(spawn_z: float, rise: float, why: str, height: SpawnHeight | None) -> str:
    """How to spawn a robot higher, or lower by a negative rise (m)."""
    z = f"{spawn_z + rise + 0.0:.3f}"
    if height is None:
        how = f"set z = {z} m in the <pose> of the model"
    elif height.launch_argument is not None:
        name = height.launch_argument
        how = f"give {name}:={z}, or make that the default of the launch argument `{name}`"
    elif height.is_given:
        how = f"change {height.option} to '{z}' in {height.holder}"
    elif height.option.startswith("-"):
        how = f"add '{height.option}', '{z}' to {height.holder}"
    else:
        how = f"add '{height.option}': '{z}' to {height.holder}"
    return f"{'Raise' if rise > 0 else 'Lower'} the robot by {abs(rise):.3f} m {why}: {how}."


FALLS_WITHOUT_END = Rule(
    code="SPN056",
    name="falls-without-end",
    severity=Severity.ERROR,
    summary="The robot falls through the ground, or the world does not have a ground.",
    what="Reports a robot whose final position is below the ground and below its spawn pose. In a "
    "world without a ground plane, reports one that is lower and accelerates with gravity.",
    why="No part of the robot touches the ground.",
    example="""
<link name="base_link">
  <visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual>
</link>
""",
    instead="""
<link name="base_link">
  <visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual>
  <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
</link>
""",
)


def falls_without_end(
    entity: str,
    lowest_at_start: float,
    lowest_at_end: float,
    *,
    has_ground: bool,
    is_falling: bool,
) -> Iterator[Diagnostic]:
    """Report a robot that falls through the ground, or in a world without ground."""
    floor = min(lowest_at_start, 0.0) if has_ground else lowest_at_start
    if lowest_at_end < floor - FALLEN and (has_ground or is_falling):
        yield FALLS_WITHOUT_END.at(
            None,
            element=entity,
            message=f"The robot falls: at the end it is {-lowest_at_end:.1f} m below z = 0."
            if has_ground
            else f"The robot falls: it is {lowest_at_start - lowest_at_end:.1f} m lower at the "
            "end, in a world without a ground plane.",
            hint="Add a <collision> to the links that stand on the ground."
            if has_ground
            else "Add a static model with a <plane> to the world, or set x, y and z of the spawn "
            "pose above a static model.",
        )


NO_BUOYANCY = Rule(
    code="SPN109",
    name="no-buoyancy",
    severity=Severity.INFO,
    summary="Buoyancy or lift from a plugin is not simulated.",
    what="Looks for plugins of the robot and systems of the world that simulate buoyancy or lift. "
    "For such robots, falling, sinking, tipping over and moving are not reported.",
    why="In wsgen's simulation the robot falls; in Gazebo it floats or keeps its depth.",
    example='<plugin filename="gz-sim-buoyancy-system" name="gz::sim::systems::Buoyancy"/>',
    instead="Start it in Gazebo to see how it floats.",
)


def no_buoyancy(entity: str, plugin: str) -> Diagnostic:
    """Report that a robot is not simulated as it floats."""
    return NO_BUOYANCY.at(
        None,
        element=entity,
        message=f"wsgen does not simulate the plugin `{plugin}`, which holds the robot up in "
        "Gazebo: the robot falls here, and its motion is not checked.",
        hint="Start it in Gazebo to see how it floats.",
    )


THROWN_INTO_THE_AIR = Rule(
    code="SPN057",
    name="thrown-into-the-air",
    severity=Severity.ERROR,
    summary="Contact forces throw the robot into the air.",
    what="Compares the highest position of the root link with its spawn height, minus the initial "
    "depth in the ground.",
    why="Overlapping shapes push each other apart with unrealistic forces.",
    example='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "-0.5"]',
    instead='arguments=["-entity", "my_robot", "-topic", "robot_description", "-z", "0.1"]',
)


def thrown_into_the_air(entity: str, rise: float) -> Iterator[Diagnostic]:
    """Report a robot that contact forces throw upward."""
    if rise > THROWN:
        yield THROWN_INTO_THE_AIR.at(
            None,
            element=entity,
            message=f"The robot is thrown {rise:.2f} m upward.",
            hint="Spawn it above the ground, and avoid overlapping collision shapes.",
        )


UNACTUATED_JOINTS_MOVE = Rule(
    code="SPN060",
    name="unactuated-joints-move",
    severity=Severity.INFO,
    summary="Joints that are not actuated move under gravity.",
    what="Measures how far each joint, except those of wheels, moves from its start position.",
    why="This is not an error: an arm without controllers falls, in Gazebo and in reality. It "
    "shows what the robot does until its controllers start.",
    example='<joint name="shoulder" type="revolute"> ... </joint>',
    instead="""
<ros2_control name="arm" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <joint name="shoulder"><command_interface name="position"/></joint>
</ros2_control>
""",
)


def unactuated_joints_move(
    travel: Mapping[str, float], entity: str, *, is_moving: bool
) -> Iterator[Diagnostic]:
    """Report joints that nothing drives and that gravity moves."""
    if not travel:
        return
    farthest = sorted(travel, key=lambda name: travel[name], reverse=True)
    yield UNACTUATED_JOINTS_MOVE.at(
        None,
        element=entity,
        message=f"Gravity moves joints that are not actuated: {some_named(farthest, NAMED)}"
        + (" (still moving at the end)." if is_moving else "."),
        hint="Start controllers that hold these joints; without them the same happens in Gazebo.",
    )


GAINS_ENERGY = Rule(
    code="SPN061",
    name="gains-energy",
    severity=Severity.ERROR,
    severity_varies="a warning where other robots may push it",
    summary="The energy of the robot grows although it is not driven.",
    what="Compares kinetic and potential energy during the simulation with the energy at the "
    "spawn. The energy that lifts the robot out of the ground is subtracted.",
    why="The model is numerically unstable: it shakes and then explodes.",
    example="""
<inertial>
  <mass value="5"/>
  <inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/>
</inertial>
""",
    instead="Use the inertias of the real parts and collision shapes that do not overlap, or a "
    "shorter max_step_size.",
)


def gains_energy(  # noqa: PLR0913  facts
    entity: str,
    gain: float,
    mass: float,
    gravity: float,
    penetration: float,
    *,
    is_alone: bool,
) -> Iterator[Diagnostic]:
    """Report a robot whose energy grows although nothing drives it."""
    weight = mass * max(gravity, STANDARD_GRAVITY)
    if gain > weight * (LIFTED + penetration):
        yield GAINS_ENERGY.at(
            None,
            element=entity,
            message=f"The robot gains {gain:.3g} J although it is not driven: the model is "
            "unstable."
            if is_alone
            else f"The robot gains {gain:.3g} J: the model is unstable, or another robot pushes "
            "it.",
            hint="Look for links far lighter than their neighbors, inertias that are too small, "
            "and overlapping collision shapes; or shorten the world's max_step_size.",
            severity=Severity.ERROR if is_alone else Severity.WARNING,
        )


ENGINE_UNSTABLE = Rule(
    code="SPN108",
    name="engine-unstable",
    severity=Severity.INFO,
    summary="The simulation of the robot is unstable in an engine, and is repeated in another one.",
    what="Where the pose of a robot becomes infinite, or its energy grows although it is not "
    "driven, repeats the simulation in DART, the engine of Gazebo Sim, or in MuJoCo if DART is not "
    "installed. If the robot is stable there, that result counts.",
    why="Links with tiny inertias and fast joints explode in one engine and are stable in another. "
    "A limitation of one engine is not an error of the robot.",
    example="wsgen validate robot.urdf",
    instead="pip install 'wsgen[dart]'\nwsgen validate robot.urdf --engine dart",
)


JOINT_BEYOND_LIMIT = Rule(
    code="SPN062",
    name="joint-beyond-limit",
    severity=Severity.WARNING,
    summary="A joint is outside its limits at the end of the simulation.",
    what="Compares the positions of the joints at the end with the limits of the description.",
    why="The limit does not hold the load of the joint, or other limits and contacts act against "
    "it.",
    example='<limit lower="0.5" upper="1.5" effort="10" velocity="1"/>',
    instead='<limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>',
)


def joint_beyond_limit(
    entity: str, joints: Iterable[Joint], positions: Mapping[str, float]
) -> Iterator[Diagnostic]:
    """Report joints that end up beyond their limits."""
    for joint in joints:
        slack = BEYOND.get(joint.type)
        if slack is None or joint.limit is None or joint.name not in positions:
            continue
        position, limit = positions[joint.name], joint.limit
        if not limit.lower - slack <= position <= limit.upper + slack:
            yield JOINT_BEYOND_LIMIT.at(
                None,
                element=entity,
                message=f"At the end the joint `{joint.name}` is at {position:.3f}, outside its "
                f"limits {limit.lower:g} to {limit.upper:g} (rad or m).",
                hint="Check the limits, and the masses and inertias of the links behind the joint.",
            )


KEEPS_MOVING = Rule(
    code="SPN058",
    name="keeps-moving",
    severity=Severity.ERROR,
    severity_varies="a warning where joints that are not actuated move, information where the "
    "robot moves slowly",
    summary="The robot does not come to rest within the simulation.",
    what="Checks that the speed of the robot becomes low and stays low. A robot that stands while "
    "its wheels turn is not reported; one whose unactuated joints swing is reported only as "
    "`unactuated-joints-move`.",
    why="A robot that is not driven should stand still: this one slides, rolls away, shakes or "
    "falls.",
    example="""
<gazebo reference="wheel">
  <mu1>0.0</mu1>
  <mu2>0.0</mu2>
</gazebo>
""",
    instead="""
<gazebo reference="wheel">
  <mu1>1.0</mu1>
  <mu2>1.0</mu2>
</gazebo>
""",
)


def keeps_moving(  # noqa: PLR0913  facts
    entity: str,
    settled_after: float | None,
    speed: float,
    *,
    turning: float,
    joint_speed: float,
    has_passive_joints: bool,
) -> Iterator[Diagnostic]:
    """Report a robot that does not come to rest."""
    if settled_after is None and not (speed < SEEN and turning < SEEN):
        is_slow = speed < CREEPING and turning < ROCKING
        yield KEEPS_MOVING.at(
            None,
            element=entity,
            message=f"The robot does not come to rest: at the end it moves at {speed:.3f} "
            f"m/s{_and_turns(turning, joint_speed)}.",
            hint="Start controllers that hold its unactuated joints, or use --seconds 10."
            if has_passive_joints
            else "Check friction (<mu1>, <mu2>), inertias and joint damping, or use --seconds 10.",
            severity=Severity.INFO
            if is_slow
            else Severity.WARNING
            if has_passive_joints
            else Severity.ERROR,
        )


def _and_turns(turning: float, joint_speed: float) -> str:
    turns = f", turns at {turning:.2f} rad/s" if turning > SEEN else ""
    return turns + (f", a joint at {joint_speed:.2f} rad/s or m/s" if joint_speed > SEEN else "")


TIPS_OVER = Rule(
    code="SPN059",
    name="tips-over",
    severity=Severity.ERROR,
    severity_varies="a warning where joints that are not actuated move, and on models of the "
    "world, which may be slopes",
    summary="The robot leans or lies on its side at the end of the simulation.",
    what="Measures the angle between the up axis of the robot at the end and at its spawn.",
    why="The center of mass is not above the contacts with the ground, or something pushes the "
    "robot over. Controllers that hold its joints may keep it upright.",
    example='<inertial><origin xyz="0.5 0 1.2"/><mass value="20"/></inertial>',
    instead='<inertial><origin xyz="0 0 0.1"/><mass value="20"/></inertial>',
)


def tips_over(
    entity: str, tilt: float, *, has_passive_joints: bool, is_held: bool = False
) -> Iterator[Diagnostic]:
    """Report a robot that ends up leaning or on its side."""
    if tilt > TIPPED:
        yield TIPS_OVER.at(
            None,
            element=entity,
            message=f"The robot tips over by {math.degrees(tilt):.0f} degrees"
            + (" while its unactuated joints move." if has_passive_joints else "."),
            hint="If the robot is bolted to the floor, add a root link `world` with a fixed joint "
            "to the base. If it walks or balances, start its controllers."
            if has_passive_joints or is_held
            else "Check the masses and the <origin> of each <inertial>, and that all wheels reach "
            "the ground.",
            severity=Severity.WARNING if has_passive_joints else Severity.ERROR,
        )


LEANS = Rule(
    code="SPN067",
    name="leans",
    severity=Severity.WARNING,
    summary="The robot comes to rest, but leans by some degrees.",
    what="For a robot that is at rest on level ground with unchanged joint positions, measures the "
    "angle between its up axis at the end and at its spawn; reports 3 to 15 degrees.",
    why="The lowest points of wheels and casters are not at the same height: a caster is too high "
    "or too low, or the wheels differ in radius. Sensors point into the ground or into the air, "
    "and the load of the wheels is wrong.",
    example='<joint name="caster_joint" type="fixed"><origin xyz="-0.2 0 -0.02"/>…</joint>',
    instead='<joint name="caster_joint" type="fixed"><origin xyz="-0.2 0 -0.05"/>…</joint>',
)
# Of the published robots at rest with joints where they were, none leans by more than a degree.
LEANING = math.radians(3)
UNEVEN = 0.002  # m; what ends higher above the others, upright, is named
MOST_NAMED = 4  # parts in a message


def leans(
    entity: str, tilt: float, touching: Sequence[str], heights: Mapping[str, float]
) -> Iterator[Diagnostic]:
    """Report a robot that is at rest and neither upright nor on its side.

    `touching` are links that touch the ground at the end; `heights` is how far the lowest point of
    each link is above that of the robot, m, when it is upright.
    """
    if not LEANING < tilt <= TIPPED:
        return
    stands = f" It rests on {some_named(touching, MOST_NAMED)}." if touching else ""
    high = max(touching, key=lambda name: heights.get(name, 0.0), default=None)
    hint = "Check that the lowest points of all wheels and casters are at the same height."
    if high is not None and heights.get(high, 0.0) > UNEVEN:
        hint = (
            f"If the robot is upright, `{high}` is {1000 * heights[high]:.0f} mm above the lowest "
            "part of the robot: move it down by that distance, move the others up, or make it "
            "larger."
        )
    yield LEANS.at(
        None,
        element=entity,
        message=f"The robot stands, but leans by {math.degrees(tilt):.1f} degrees.{stands}",
        hint=hint,
    )


SHALLOW = 0.02  # m; engines push a robot out of less without a jump
PUSHED_OUT = 0.1  # m; what stands after less was spawned a bit too low, as many robots are
# at most so many pairs of links are named in a message
SAME_PLACE = 0.005  # m; engines have collision margins of 1 mm
SAME_HEADING = math.radians(2)
SAME_JOINT = 0.1  # rad or m
# Of three engines that all disagree, two nearly agree: their gap is less than so many tolerances,
NEAR = 4
CLEARLY = 3  # and so many times less than that of either to the third.


OVERLAPPING_ROBOTS = Rule(
    code="SPN063",
    name="overlapping-robots",
    severity=Severity.ERROR,
    severity_varies="a warning up to a depth of 2 cm, which engines correct without a jump; for a "
    "robot in a model of the world up to 10 cm, if it comes to rest",
    summary="Two robots, or a robot and a model of the world, overlap at the spawn.",
    why="The simulator pushes them apart with a large force.",
    example="""
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "a", "-x", "0.0"]),
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "b", "-x", "0.0"]),
""",
    instead="""
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "a", "-x", "0.0"]),
Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "b", "-x", "2.0"]),
""",
)


def overlapping_robots(
    entity: str, overlaps: Sequence[Overlapping], static_models: Collection[str] = ()
) -> Iterator[Diagnostic]:
    """Report robots that are spawned inside each other, or inside a model.

    `static_models` are the names of models of the world, and of those that do not move.
    """
    for other in dict.fromkeys(found.other_entity for found in overlaps if found.other_entity):
        deepest = max(
            (found for found in overlaps if found.other_entity == other),
            key=lambda found: found.depth,
        )
        # Once for each pair: about the robot, if the other is a static model or one of the world,
        # else about the first by name.
        is_reported = (
            entity < str(other)
            if (entity in static_models) == (other in static_models)
            else (other in static_models)
        )
        if is_reported:
            yield OVERLAPPING_ROBOTS.at(
                None,
                element=entity,
                message=(
                    f"`{entity}` overlaps the model `{other}` at its spawn: "
                    if other in static_models
                    else f"`{entity}` and `{other}` overlap at their spawn: "
                )
                + f"`{entity}/{deepest.link}` is {deepest.depth:.3f} m deep in "
                f"`{other}/{deepest.other_link}`.",
                hint="Spawn it higher (-z), or at another place (-x, -y)."
                if other in static_models
                else "Spawn them farther apart (-x, -y), or higher (-z).",
                severity=Severity.ERROR if deepest.depth > SHALLOW else Severity.WARNING,
            )


OVERLAPPING_LINKS = Rule(
    code="SPN064",
    name="overlapping-links",
    severity=Severity.WARNING,
    summary="Links of a robot with self-collision overlap at the spawn.",
    what="Looks for overlapping links with `<selfCollide>` that are not connected by a joint.",
    why="The simulator pushes them apart from the first step: the robot shakes or jumps.",
    example='<gazebo reference="upper_arm"><selfCollide>true</selfCollide></gazebo>',
    instead="Use smaller collision shapes, or remove <selfCollide> from these links.",
)


def overlapping_links(
    entity: str, overlaps: Sequence[Overlapping], collide: Collection[str]
) -> Iterator[Diagnostic]:
    """Report links of one robot that can collide with each other and overlap when spawned."""
    inside = [
        found
        for found in overlaps
        if found.other_entity is None and {found.link, found.other_link} <= set(collide)
    ]
    if inside:
        pairs = [
            f"`{found.link}` in `{found.other_link}` ({found.depth:.3f} m)"
            for found in sorted(inside, key=lambda found: -found.depth)
        ]
        yield OVERLAPPING_LINKS.at(
            None,
            element=entity,
            message=f"Links with <selfCollide> overlap at the spawn: {some_of(pairs, NAMED)}.",
            hint="Make their collision shapes smaller, or remove <selfCollide>.",
        )


RESTS_ON_HULL = Rule(
    code="SPN066",
    name="rests-on-hull",
    severity=Severity.WARNING,
    summary="A contact is on the convex hull of a mesh; in Gazebo the mesh sinks deeper.",
    what="At the end of the simulation, measures the distance from the contacts of a mesh to its "
    "nearest triangle, except on level ground. Up to 5 mm are not reported.",
    why="For movable meshes PyBullet and MuJoCo use the convex hull, DART and Gazebo the "
    "triangles: a fork rests on a post between its tines in the first two, but on the floor in "
    "Gazebo.",
    example='<collision><geometry><mesh filename="package://robot/fork.stl"/></geometry></collision>',
    instead="""
<collision><geometry><box size="1.0 0.1 0.05"/></geometry><origin xyz="0 0.3 0"/></collision>
<collision><geometry><box size="1.0 0.1 0.05"/></geometry><origin xyz="0 -0.3 0"/></collision>
""",
)


def rests_on_hull(entity: str, gaps: Sequence[HullGap]) -> Iterator[Diagnostic]:
    """Report meshes that rest on their convex hulls, where Gazebo lets them sink in."""
    for found in sorted(gaps, key=lambda found: -found.gap)[:NAMED]:
        yield RESTS_ON_HULL.at(
            None,
            element=entity,
            message=f"The mesh of `{found.link}` touches `{found.other_entity}` "
            f"{found.gap * 1000:.0f} mm from its triangles: the engine uses its convex hull, "
            "Gazebo uses the triangles.",
            hint="Use --engine dart, or replace the mesh by several convex <collision> shapes.",
        )


ENGINES_DISAGREE = Rule(
    code="SPN065",
    name="engines-disagree",
    severity=Severity.WARNING,
    summary="The final state of the robot differs between physics engines.",
    what="Compares mass, joints and whether the robot comes to rest for each pair of engines and, "
    "if it rests in both, its pose and joint positions. With three engines, the message names the "
    "one that differs from the other two. Simulations that explode are not compared.",
    why="The result depends on details that the description does not determine: a balance, a fall, "
    "or a mesh that is a convex hull in one engine and triangles in the other. Gazebo Sim uses "
    "DART by default.",
    example="A robot is spawned balancing on one wheel.",
    instead="Spawn the robot in a pose in which it stands by itself.",
)


def engines_disagree(
    robot_runs: Mapping[str, RobotRun],
    *,
    is_on_hull: bool = False,
    has_passive_joints: bool = False,
) -> Iterator[Diagnostic]:
    """Report differences between the runs of one robot, by engine: of three, the one against two.

    Runs that exploded are reported for each engine, and not compared. `is_on_hull` says that in one
    of the engines `rests_on_hull` reports this robot or what it touches.
    """
    runs = {
        engine: robot_run
        for engine, robot_run in robot_runs.items()
        if robot_run.is_finite and not robot_run.is_cut_short
    }
    gaps = {
        (one, other): max((found.gap for found in _differences(runs[one], runs[other])), default=0)
        for one, other in combinations(runs, 2)
    }
    if not any(gaps.values()):
        return
    # What comes to rest is compared with what does so, too.
    engines = sorted(runs, key=lambda engine: runs[engine].settled_after is None)
    gaps = {pair: gaps.get(pair, gaps.get(pair[::-1], 0.0)) for pair in combinations(engines, 2)}
    agreement, reference, others = _agreement(engines, gaps)
    details = "; ".join(
        f"in {RESULT_NAMES[other]} it "
        + ", ".join(found.words for found in _differences(runs[reference], runs[other]))
        for other in others
    )
    why = _why_engines_disagree(list(runs.values()), has_passive_joints=has_passive_joints)
    if is_on_hull:
        why = (
            "The robot rests on the convex hull of a mesh (see rests-on-hull), which DART "
            f"{'and Gazebo do' if GAZEBO in runs else 'does'} not use."
        )
    which = "Gazebo is what the package runs in." if GAZEBO in runs else _OF_GAZEBO_SIM
    yield ENGINES_DISAGREE.at(
        None,
        element=runs[reference].entity,
        message=f"{agreement}{details}.",
        hint=f"{why} {which}",
    )


_OF_GAZEBO_SIM = "Gazebo Sim uses DART by default."


def _agreement(
    engines: Sequence[str], gaps: Mapping[tuple[str, str], float]
) -> tuple[str, str, list[str]]:
    """Who disagrees, in words; the engine to compare with, and those to compare with it."""
    apart = [pair for pair, gap in gaps.items() if gap]
    for odd in engines if engines[2:] else ():
        within = max(gap for pair, gap in gaps.items() if odd not in pair)
        away = min(gap for pair, gap in gaps.items() if odd in pair)
        if away and within < min(NEAR, away / CLEARLY):
            others = [engine for engine in engines if engine != odd]
            nearly = "nearly " if within else ""
            agreement = f"{name_engines(others)} {nearly}agree, {RESULT_NAMES[odd]} differs: "
            return agreement, others[0], [odd]
    different = [engine for engine in engines if any(engine in pair for pair in apart)]
    between = [engine for engine in engines if engine not in different]
    agreement = f"{name_engines(sorted(different, key=list(RESULT_NAMES).index))} disagree"
    if between:
        agreement += f"; {name_engines(between)} {'are' if between[1:] else 'is'} between them"
    # Gazebo is what others are compared with; of two, it is said what happens in it.
    is_pair = len(different) == len("ab")
    reference, *others = sorted(different, key=lambda one: (one == GAZEBO) == is_pair)
    compared = f"compared with {RESULT_NAMES[reference]}, " if others[1:] else ""
    return f"{agreement}: {compared}", reference, others


def _why_engines_disagree(runs: Sequence[RobotRun], *, has_passive_joints: bool) -> str:
    if any(robot_run.penetration > CONTACT_SLACK for robot_run in runs):
        return "Spawn it above the ground: engines push it out in different ways."
    if has_passive_joints:
        return (
            "Start controllers that hold its unactuated joints, which move differently in each "
            "engine."
        )
    if len({robot_run.settled_after is None for robot_run in runs}) > 1:
        return "Use --seconds 10: it may come to rest later in one engine than in another."
    return (
        "If the robot falls or balances, differences are normal; if it should stand, check its "
        "contacts with the ground."
    )


class _Difference(NamedTuple):
    gap: float  # in tolerances: more than 1
    words: str  # what "it" does in the second run, after "in DART it"


def _differences(first: RobotRun, second: RobotRun) -> Iterator[_Difference]:
    """What a robot does otherwise in the second run than in the first."""
    if not math.isclose(first.mass, second.mass, rel_tol=MASS_TOLERANCE):
        yield _Difference(math.inf, f"weighs {second.mass:g} kg instead of {first.mass:g} kg")
    if first.movable_joints != second.movable_joints:
        counts = f"{second.movable_joints} movable joints instead of {first.movable_joints}"
        yield _Difference(math.inf, f"has {counts}")
    if second.settled_after is None or first.settled_after is None:
        if second.settled_after is not None:
            yield _Difference(math.inf, "comes to rest")
        elif first.settled_after is not None:
            yield _Difference(math.inf, "does not come to rest")
        return
    apart = math.dist(first.rest_pose.xyz, second.rest_pose.xyz)
    if apart > SAME_PLACE:
        place = " and ".join(_apart(first.rest_pose, second.rest_pose))
        yield _Difference(apart / SAME_PLACE, f"rests {place}")
    angle = angle_between(first.rest_pose, second.rest_pose)
    if angle > SAME_HEADING:
        words = f"is turned by {math.degrees(angle):.1f} degrees"
        if abs(second.tilt - first.tilt) > SAME_HEADING:
            tilts = (f"{math.degrees(tilt):.1f}" for tilt in (second.tilt, first.tilt))
            words = f"leans by {' instead of '.join(tilts)} degrees"
        yield _Difference(angle / SAME_HEADING, words)
    far = {
        name: abs(position - second.joint_positions[name])
        for name, position in first.joint_positions.items()
        if name in second.joint_positions
    }
    worst = max(far, key=lambda name: far[name], default=None)
    if worst is not None and far[worst] > SAME_JOINT:
        ends = (f"{one.joint_positions[worst]:.2f}" for one in (second, first))
        words = f"has the joint `{worst}` at {' instead of '.join(ends)} rad or m"
        yield _Difference(far[worst] / SAME_JOINT, words)


def _apart(first: Pose, second: Pose) -> Iterator[str]:
    """How much higher or lower than in the first, and how far to the side."""
    rise = second.xyz[2] - first.xyz[2]
    aside = math.dist(first.xyz[:2], second.xyz[:2])
    if abs(rise) > SAME_PLACE / 2:
        yield (
            f"{_length(abs(rise))} {'higher' if rise > 0 else 'lower'} (z = {second.xyz[2]:.3f} m "
            f"instead of {first.xyz[2]:.3f} m)"
        )
    if aside > SAME_PLACE / 2:
        yield f"{_length(aside)} to the side"


def _length(meters: float) -> str:
    return f"{meters * 1000:.0f} mm" if meters < 1 else f"{meters:.2f} m"


# Checked in `behaviors.py`, which is loaded where a package has some.
POSITION_NOT_REACHED = Rule(
    code="SPN085",
    name="position-not-reached",
    severity=Severity.ERROR,
    summary="A driven robot does not reach the position in its behavior.",
    what="Drives the robot through its plugin, or runs the launch file (`run = true`), and "
    "compares its final position with `moved`. The difference may be `tolerance` times the "
    "distance.",
    why="Odometry and navigation rely on the sizes in the plugin: they would be wrong by as much.",
    example="<wheel_radius>0.2</wheel_radius>  <!-- of a wheel with a radius of 0.1 m -->",
    instead="<wheel_radius>0.1</wheel_radius>",
)
HEADING_NOT_REACHED = Rule(
    code="SPN086",
    name="heading-not-reached",
    severity=Severity.ERROR,
    summary="A driven robot does not turn by the angle in its behavior.",
    what="Drives the robot through its plugin, or runs the launch file (`run = true`), and "
    "compares its rotation with the `yaw` of `moved`. The difference may be `tolerance` times the "
    "angle.",
    why="Odometry and navigation rely on the sizes in the plugin: they would be wrong by as much.",
    example="<wheel_separation>0.8</wheel_separation>  <!-- between the outer sides -->",
    instead="<wheel_separation>0.6</wheel_separation>  <!-- between the contacts -->",
)
BEHAVIOR_EXPLODES = Rule(
    code="SPN088",
    name="behavior-explodes",
    severity=Severity.ERROR,
    summary="A position became infinite or not-a-number while a behavior was simulated.",
    what="Looks at every pose and joint position.",
    why="The simulation exploded. Gazebo stops with an assertion or shows nothing.",
    example='<limit lower="-1.57" upper="1.57" effort="1e12" velocity="1"/>',
    instead='<limit lower="-1.57" upper="1.57" effort="20" velocity="1"/>',
)
