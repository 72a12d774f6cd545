"""Rules over what a simulation measured: did the robot arrive whole, and on the ground?

The parameters are facts in SI units; a rule yields what it finds.

Rules over how a robot moved in a simulation: does it stand, and if not, why?

The parameters are facts in SI units; a rule yields what it finds. A limb is a joint that gravity
can move, other than the axle of a wheel: what gives way there needs a controller, not a better
description.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.model.plan import SpawnHeight
    from wsgen.model.robot import Joint


MASS_TOLERANCE = 1e-6  # relative; the engine computes in double precision
CONTACT_SLACK = 0.005  # m; collision margins and contact softness stay below this
RISING = 0.01  # m/s; slower is no way out: DART lifts what is in the ground by 1 mm/s
WAY_OUT = (
    3.0  # s; what rises so fast that it is out by then, as long as a simulation is, is not stuck
)
HIGH_SPAWN = 1.0  # m; a fall from here hurts a real robot


def mass_differs_from_description(
    entity: str, described_mass: float, simulated_mass: float
) -> Iterator[Diagnostic]:
    """The engine simulates another mass than the description gives.

    ## What it does
    Compares the engine's total mass with that of the robot Gazebo would build.

    ## Why is this bad?
    Every force, speed and contact of the simulation would be another robot's.

    ## Use instead
    Nothing the user writes causes this; report it with the robot's description.
    """
    if not math.isclose(described_mass, simulated_mass, rel_tol=MASS_TOLERANCE, abs_tol=1e-9):
        yield Diagnostic(
            code="SPN050",
            severity=Severity.ERROR,
            message=f"The engine simulates {simulated_mass:g} kg, the description says "
            f"{described_mass:g} kg.",
            element=entity,
            hint="Report this with the robot's description: the simulation is not to be believed.",
        )


def joints_differ_from_description(
    entity: str, described_joints: int, simulated_joints: int
) -> Iterator[Diagnostic]:
    """The engine moves another number of joints than the description has.

    ## What it does
    Compares the engine's movable joints with those of the robot Gazebo would build.

    ## Why is this bad?
    A joint that is lost is a part that cannot move, or one that fell off.

    ## Use instead
    Nothing the user writes causes this; report it with the robot's description.
    """
    if described_joints != simulated_joints:
        yield Diagnostic(
            code="SPN051",
            severity=Severity.ERROR,
            message=f"The engine moves {simulated_joints} joints, the description has "
            f"{described_joints}.",
            element=entity,
            hint="Report this with the robot's description: the simulation is not to be believed.",
        )


def state_not_finite(entity: str, *, is_finite: bool) -> Iterator[Diagnostic]:
    """The robot's position became infinite or not-a-number.

    ## What it does
    Looks at every pose and speed of the simulation.

    ## Why is this bad?
    The simulation has exploded; Gazebo ends with an assertion or shows nothing.

    ## Use instead
    Masses, inertias and sizes in SI units, none zero, none beyond reason.
    """
    if not is_finite:
        yield Diagnostic(
            code="SPN052",
            severity=Severity.ERROR,
            message="The robot's pose became infinite or not-a-number: the simulation exploded.",
            element=entity,
            hint="Check masses, inertias, axes and sizes: SI units, none zero, none huge.",
        )


def run_cut_short(entity: str, *, is_cut_short: bool) -> Iterator[Diagnostic]:
    """The simulation ended early, because another robot's state was not finite.

    ## What it does
    Looks whether the robot was simulated to the end.

    ## Why is this bad?
    Nobody knows what this robot would have done.

    ## Use instead
    What the finding about the other robot says.
    """
    if is_cut_short:
        yield Diagnostic(
            code="SPN090",
            severity=Severity.ERROR,
            message="The robot was not simulated to the end: the pose of another robot became "
            "infinite or not-a-number.",
            element=entity,
            hint="Fix the other robot first.",
        )


def born_inside_the_ground(
    entity: str,
    penetration: float,
    spawn_z: float,
    height: SpawnHeight | None = None,
    *,
    is_bolted: bool = False,
) -> Iterator[Diagnostic]:
    """The spawn pose puts part of the robot into the ground.

    ## What it does
    Measures the lowest point of the robot's collision shapes when it is spawned.

    ## Why is this bad?
    The simulator pushes the robot out; depending on the engine it jumps, tips over or sticks.

    ## Use instead
    A spawn height of at least the depth that is named, plus a few millimeters.
    """
    if penetration > CONTACT_SLACK:
        yield Diagnostic(
            code="SPN053",
            severity=Severity.WARNING,
            message=f"The robot is spawned {penetration:.3f} m deep in the ground "
            f"(spawn height z = {spawn_z:g} m).",
            file=height.file if height else None,
            line=height.line if height else None,
            element=entity,
            hint=f"Raise the <origin> of the joint to `world` by {penetration:.3f} m, or spawn it "
            "higher."
            if is_bolted
            else _spawn_at(spawn_z, penetration + CONTACT_SLACK, "or higher", height),
        )


def spawned_high_above_the_ground(
    entity: str, clearance: float, spawn_z: float, height: SpawnHeight | None = None
) -> Iterator[Diagnostic]:
    """The robot is dropped from more than a meter.

    ## What it does
    Measures the lowest point of the robot's collision shapes when it is spawned.

    ## Why is this bad?
    The impact moves joints and bends the result; a real robot would break.

    ## Use instead
    A spawn height a few millimeters above the ground.
    """
    if clearance > HIGH_SPAWN:
        yield Diagnostic(
            code="SPN054",
            severity=Severity.WARNING,
            message=f"The robot is spawned {clearance:.2f} m above the ground and falls "
            f"(spawn height z = {spawn_z:g} m).",
            file=height.file if height else None,
            line=height.line if height else None,
            element=entity,
            hint=_spawn_at(spawn_z, CONTACT_SLACK - clearance, "to let it stand at once", height),
        )


def is_on_its_way_out(depth_at_end: float, climb: float) -> bool:
    """Whether a robot that is in the ground (m) rises (m/s) fast enough to get out."""
    return climb > RISING and depth_at_end < climb * WAY_OUT


def stuck_in_the_ground(entity: str, depth_at_end: float, climb: float) -> Iterator[Diagnostic]:
    """At the end the robot is still in the ground.

    ## What it does
    Measures the lowest point of the robot's collision shapes at the end of the simulation. A robot
    that     is still rising, and would be out within 3 s, is not checked.

    ## Why is this bad?
    It sinks in or cannot get out: contacts are too soft, or shapes lock each other.

    ## Use instead
    A spawn pose above the ground; collision shapes without zero sizes; usual kp and kd.
    """
    if depth_at_end > CONTACT_SLACK and not is_on_its_way_out(depth_at_end, climb):
        yield Diagnostic(
            code="SPN055",
            severity=Severity.ERROR,
            message=f"The robot is {depth_at_end:.3f} m deep in the ground at the end.",
            element=entity,
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
    return f"{'Raise' if rise > 0 else 'Lower'} it by {abs(rise):.3f} m {why}: {how}."


TIPPED = math.radians(15)  # what a person calls leaning over
FALLEN = 0.5  # m further down than at the start: no contact holds the robot
SEEN = 0.01  # rad/s or m/s; slower motion is not worth telling
THROWN = 0.5  # m above where it was spawned: contact forces have shot it up
CREEPING = 0.05  # m/s; slower, and a robot rocks or rolls out: it will stand
ROCKING = 0.3  # rad/s
STANDARD_GRAVITY = 9.8  # m/s²
LIFTED = 0.1  # m; so much higher the energy that came from nowhere could lift the robot
BEYOND = {JointType.REVOLUTE: 0.05, JointType.PRISMATIC: 0.01}  # rad, m; limits are a little soft
NAMED = 3  # so many joints are told in a message


def falls_without_end(
    entity: str,
    lowest_at_start: float,
    lowest_at_end: float,
    *,
    has_ground: bool,
    is_falling: bool,
) -> Iterator[Diagnostic]:
    """The robot falls through the ground, or there is none.

    ## What it does
    Looks whether the robot is below the ground at the end, and lower than it was spawned; in a
    world without a ground plane, whether it is lower and gets faster as gravity has it.

    ## Why is this bad?
    Nothing of the robot touches the ground, or the world has none.

    ## Use instead
    <collision> in the links that stand on the ground, and a ground plane in the world.
    """
    floor = min(lowest_at_start, 0.0) if has_ground else lowest_at_start
    if lowest_at_end < floor - FALLEN and (has_ground or is_falling):
        yield Diagnostic(
            code="SPN056",
            severity=Severity.ERROR,
            message=f"The robot falls: at the end it is {-lowest_at_end:.1f} m below z = 0."
            if has_ground
            else f"The robot falls, by {lowest_at_start - lowest_at_end:.1f} m so far.",
            element=entity,
            hint="Give the links that stand on the ground a <collision>."
            if has_ground
            else "Spawn it above what carries it (x, y, z), or include model://ground_plane.",
        )


def thrown_into_the_air(entity: str, rise: float) -> Iterator[Diagnostic]:
    """Contact forces shoot the robot up.

    ## What it does
    Compares the highest point the robot's root reaches with where it was spawned, less the depth
    out of which it had to come.

    ## Why is this bad?
    Overlapping shapes push each other apart with forces no real contact has.

    ## Use instead
    A spawn pose above the ground, and links whose collision shapes do not overlap.
    """
    if rise > THROWN:
        yield Diagnostic(
            code="SPN057",
            severity=Severity.ERROR,
            message=f"The robot is thrown {rise:.2f} m up.",
            element=entity,
            hint="Spawn it above the ground; let no collision shapes of one robot overlap.",
        )


def gives_way(travel: Mapping[str, float], entity: str, *, is_moving: bool) -> Iterator[Diagnostic]:
    """Joints that nobody drives give way under gravity.

    ## What it does
    Looks how far every joint that is no axle was from where it started.

    ## Why is this bad?
    It is not: an arm without a controller falls, in Gazebo as on the bench. It says what the robot
    is like until its controllers are started.

    ## Use instead
    ros2_control with controllers that hold the joints from the start, or joint damping.
    """
    if not travel:
        return
    farthest = sorted(travel, key=lambda name: travel[name], reverse=True)
    told = ", ".join(f"`{name}`" for name in farthest[:NAMED])
    told += f" and {len(farthest) - NAMED} more" if len(farthest) > NAMED else ""
    yield Diagnostic(
        code="SPN060",
        severity=Severity.INFO,
        message=f"Nobody drives its joints, and gravity moves {told}"
        + (" (still moving at the end)." if is_moving else "."),
        element=entity,
        hint="Controllers hold them in Gazebo; without any, this is what happens there too.",
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
    """The robot's energy grows although nobody drives it.

    ## What it does
    Compares kinetic and potential energy during the simulation with that when spawned; what pushes
    it out of the ground is allowed for. Where several robots can push each other, it is a warning.

    ## Why is this bad?
    Energy that comes from nowhere is the mark of an unstable model: it shakes, and then explodes.

    ## Use instead
    Inertias of the real parts (none a thousand times smaller than its neighbor's), joint limits
    that hold the start position, collision shapes that do not overlap, a shorter physics step.
    """
    weight = mass * max(gravity, STANDARD_GRAVITY)
    if gain > weight * (LIFTED + penetration):
        yield Diagnostic(
            code="SPN061",
            severity=Severity.ERROR if is_alone else Severity.WARNING,
            message=f"The robot gains {gain:.3g} J from nowhere: the model is unstable."
            if is_alone
            else f"The robot gains {gain:.3g} J: it is unstable, or another robot pushes it.",
            element=entity,
            hint="Look for links far lighter than their neighbors, inertias that are too small, "
            "and overlapping collision shapes; or shorten the world's max_step_size.",
        )


def joint_beyond_limit(
    entity: str, joints: Iterable[Joint], positions: Mapping[str, float]
) -> Iterator[Diagnostic]:
    """At the end a joint is beyond its limit.

    ## What it does
    Compares the positions at the end with the limits of the description.

    ## Why is this bad?
    The limit does not hold what hangs on the joint, or other limits and contacts pull against it.

    ## Use instead
    Limits that the start position (0) is within; inertias of the real parts.
    """
    for joint in joints:
        slack = BEYOND.get(joint.type)
        if slack is None or joint.limit is None or joint.name not in positions:
            continue
        position, limit = positions[joint.name], joint.limit
        if not limit.lower - slack <= position <= limit.upper + slack:
            yield Diagnostic(
                code="SPN062",
                severity=Severity.WARNING,
                message=f"At the end the joint `{joint.name}` is at {position:.3f}, beyond its "
                f"limits {limit.lower:g} to {limit.upper:g} (rad or m).",
                element=entity,
                hint="Check the limits, and the masses and inertias of what hangs on the joint.",
            )


def keeps_moving(  # noqa: PLR0913  facts
    entity: str,
    settled_after: float | None,
    speed: float,
    *,
    turning: float,
    joint_speed: float,
    gave_way: bool,
) -> Iterator[Diagnostic]:
    """The robot does not come to rest within the simulation.

    ## What it does
    Looks whether the robot's speed stays low from some moment on. A robot that stands while its
    limbs swing is told by `joints-give-way`.

    ## Why is this bad?
    A robot that nobody drives should stand still: it slides, rolls away, shakes or falls.

    ## Use instead
    Friction on what touches the ground, inertias of the right size, joints with damping; or a
    longer simulation (--seconds).
    """
    if settled_after is None and not (gave_way and speed < SEEN and turning < SEEN):
        is_slow = speed < CREEPING and turning < ROCKING
        yield Diagnostic(
            code="SPN058",
            severity=Severity.WARNING if gave_way or is_slow else Severity.ERROR,
            message="The robot does not come to rest: at the end it moves at "
            f"{speed:.3f} m/s{_and_turns(turning, joint_speed)}.",
            element=entity,
            hint="Its limbs give way and move it; controllers would hold them. Or try --seconds 10."
            if gave_way
            else "Check friction (mu1, mu2), inertias and joint damping, or try --seconds 10.",
        )


def _and_turns(turning: float, joint_speed: float) -> str:
    turns = f", turns at {turning:.2f} rad/s" if turning > SEEN else ""
    return turns + (f", a joint at {joint_speed:.2f} rad/s or m/s" if joint_speed > SEEN else "")


def tips_over(entity: str, tilt: float, *, gave_way: bool) -> Iterator[Diagnostic]:
    """The robot ends up leaning or on its side.

    ## What it does
    Measures the angle by which the robot's up axis has turned away from where it was spawned.

    ## Why is this bad?
    Its center of mass is not above what it stands on, or it was pushed over. With limbs that gave
    way it is a warning: controllers that hold them may keep it upright.

    ## Use instead
    Masses and inertia origins of the real parts; wheels and casters that reach the ground together;
    for a robot that is bolted to the floor a root link `world` and a fixed joint.
    """
    if tilt > TIPPED:
        yield Diagnostic(
            code="SPN059",
            severity=Severity.WARNING if gave_way else Severity.ERROR,
            message=f"The robot tips over by {math.degrees(tilt):.0f} degrees"
            + (" while its limbs give way." if gave_way else "."),
            element=entity,
            hint="If it is bolted to the floor: add a root link `world` and a fixed joint to it. "
            "If it walks: its controllers must hold it."
            if gave_way
            else "Check masses, inertial origins and that all wheels reach the ground.",
        )
