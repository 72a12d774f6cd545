"""Rules over what a trial measured: did the robot arrive whole, and on the ground?

The parameters are facts in SI units; a rule yields what it finds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.plan import SpawnHeight

MASS_TOLERANCE = 1e-6  # relative; the engine computes in double precision
CONTACT_SLACK = 0.005  # m; collision margins and contact softness stay below this
RISING = 0.01  # m/s; slower is no way out: DART lifts what is in the ground by 1 mm/s
WAY_OUT = 3.0  # s; what rises so fast that it is out by then, as long as a trial is, is not stuck
HIGH_SPAWN = 1.0  # m; a fall from here hurts a real robot


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


def trial_cut_short(entity: str, *, is_cut_short: bool) -> Iterator[Diagnostic]:
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
    A spawn height of at least the depth that is named, plus a few millimetres.
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
    Measures the lowest point of the robot's collision shapes at the end of the trial. A robot that
    is still rising, and would be out within 3 s, is not judged.

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
