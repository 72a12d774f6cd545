"""Rules over what a trial measured: did the robot arrive whole, and does it stand?

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterator

MASS_TOLERANCE = 1e-6  # relative; the engine computes in double precision
CONTACT_SLACK = 0.005  # m; collision margins and contact softness stay below this
TIPPED = math.radians(15)  # what a person calls leaning over
HIGH_SPAWN = 1.0  # m; a fall from here hurts a real robot
FALLEN = 0.5  # m further down than at the start: no contact holds the robot
SEEN = 0.01  # rad/s or m/s; slower motion is not worth telling
SLOW = 0.1  # m/s; limbs that swing out move the base no faster than this
THROWN = 0.5  # m above where it was spawned: contact forces have shot it up


def mass_differs_from_description(
    entity: str, described_mass: float, simulated_mass: float
) -> Iterator[Diagnostic]:
    """The engine simulates another mass than the description gives.

    ## What it does
    Compares the engine's total mass with that of the robot Gazebo would build.

    ## Why is this bad?
    Every force, speed and contact of the trial would be another robot's.

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
            hint="Report this with the robot's description: the trial is not to be believed.",
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
            hint="Report this with the robot's description: the trial is not to be believed.",
        )


def state_not_finite(entity: str, *, is_finite: bool) -> Iterator[Diagnostic]:
    """The robot's position became infinite or not-a-number.

    ## What it does
    Looks at every pose and speed of the trial.

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


def born_inside_the_ground(entity: str, penetration: float, spawn_z: float) -> Iterator[Diagnostic]:
    """The spawn pose puts part of the robot into the ground.

    ## What it does
    Measures the lowest point of the robot's collision shapes when it is spawned.

    ## Why is this bad?
    The simulator pushes the robot out; depending on the engine it jumps, tips over or sticks.

    ## Use instead
    A spawn height of at least the depth that is named, plus a few millimetres.
    """
    if penetration > CONTACT_SLACK:
        yield Diagnostic(
            code="SPN053",
            severity=Severity.WARNING,
            message=f"The robot is spawned {penetration:.3f} m deep in the ground "
            f"(spawn height z = {spawn_z:g} m).",
            element=entity,
            hint=_spawn_at(spawn_z + penetration + CONTACT_SLACK, "or higher"),
        )


def spawned_high_above_the_ground(
    entity: str, clearance: float, spawn_z: float
) -> Iterator[Diagnostic]:
    """The robot is dropped from more than a metre.

    ## What it does
    Measures the lowest point of the robot's collision shapes when it is spawned.

    ## Why is this bad?
    The impact moves joints and bends the result; a real robot would break.

    ## Use instead
    A spawn height a few millimetres above the ground.
    """
    if clearance > HIGH_SPAWN:
        yield Diagnostic(
            code="SPN054",
            severity=Severity.WARNING,
            message=f"The robot is spawned {clearance:.2f} m above the ground and falls "
            f"(spawn height z = {spawn_z:g} m).",
            element=entity,
            hint=_spawn_at(spawn_z - clearance + CONTACT_SLACK, "to let it stand at once"),
        )


def stuck_in_the_ground(entity: str, depth_at_end: float) -> Iterator[Diagnostic]:
    """At the end the robot is still in the ground.

    ## What it does
    Measures the lowest point of the robot's collision shapes at the end of the trial.

    ## Why is this bad?
    It sinks in or cannot get out: contacts are too soft, or shapes lock each other.

    ## Use instead
    A spawn pose above the ground; collision shapes without zero sizes; usual kp and kd.
    """
    if depth_at_end > CONTACT_SLACK:
        yield Diagnostic(
            code="SPN055",
            severity=Severity.ERROR,
            message=f"The robot is {depth_at_end:.3f} m deep in the ground at the end.",
            element=entity,
            hint="Spawn it above the ground, and check its collision shapes.",
        )


def falls_without_end(
    entity: str, lowest_at_start: float, lowest_at_end: float, *, has_ground: bool
) -> Iterator[Diagnostic]:
    """The robot falls through the ground, or there is none.

    ## What it does
    Looks whether the robot is below the ground at the end, and lower than it was spawned.

    ## Why is this bad?
    Nothing of the robot touches the ground, or the world has none.

    ## Use instead
    <collision> in the links that stand on the ground, and a ground plane in the world.
    """
    if lowest_at_end < min(lowest_at_start, 0.0) - FALLEN:
        yield Diagnostic(
            code="SPN056",
            severity=Severity.ERROR,
            message=f"The robot falls: at the end it is {-lowest_at_end:.1f} m below z = 0.",
            element=entity,
            hint="Give the links that stand on the ground a <collision>."
            if has_ground
            else "Include model://ground_plane in the world.",
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


def keeps_moving(  # noqa: PLR0913  facts
    entity: str,
    settled_after: float | None,
    speed: float,
    movable_joints: int,
    *,
    turning: float = 0.0,
    joint_speed: float = 0.0,
) -> Iterator[Diagnostic]:
    """The robot does not come to rest within the trial.

    ## What it does
    Looks whether the robot's speed stays low from some moment on.

    ## Why is this bad?
    A robot that nobody drives should stand still: it slides, rolls away, shakes or falls.

    ## Use instead
    Friction on what touches the ground, inertias of the right size, joints with damping; or a
    longer trial (--seconds).
    """
    if settled_after is None:
        joints = (
            f" Nobody drives its {movable_joints} movable joints: limbs that swing keep it moving."
            if movable_joints
            else ""
        )
        yield Diagnostic(
            code="SPN058",
            severity=Severity.WARNING if movable_joints and speed < SLOW else Severity.ERROR,
            message="The robot does not come to rest: at the end it moves at "
            f"{speed:.3f} m/s{_and_turns(turning, joint_speed)}.{joints}",
            element=entity,
            hint="Check friction (mu1, mu2), inertias and joint damping, or try --seconds 10.",
        )


def _and_turns(turning: float, joint_speed: float) -> str:
    turns = f", turns at {turning:.2f} rad/s" if turning > SEEN else ""
    return turns + (f", a joint at {joint_speed:.2f} rad/s or m/s" if joint_speed > SEEN else "")


def tips_over(entity: str, tilt: float) -> Iterator[Diagnostic]:
    """The robot ends up leaning or on its side.

    ## What it does
    Measures the angle by which the robot's up axis has turned away from where it was spawned.

    ## Why is this bad?
    Its centre of mass is not above what it stands on, or it was pushed over.

    ## Use instead
    Masses and inertia origins of the real parts; wheels and casters that reach the ground together.
    """
    if tilt > TIPPED:
        yield Diagnostic(
            code="SPN059",
            severity=Severity.ERROR,
            message=f"The robot tips over by {math.degrees(tilt):.0f} degrees.",
            element=entity,
            hint="Check masses, inertial origins and that all wheels reach the ground.",
        )


def _spawn_at(z: float, why: str) -> str:
    """How to spawn a robot at another height, in metres."""
    height = f"{z + 0.0:.3f}"
    return (
        f"Spawn it at z = {height} m {why}: give z:={height} to the launch file, or change the "
        f"default of that argument, or the -z of the spawner."
    )
