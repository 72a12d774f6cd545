"""What Gazebo leaves out or refuses when it lumps fixed joints."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.inertia import is_possible

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.robot import Inertial, Joint, Link, Robot

MASSLESS = 1e-6  # kg; what sdformat's comparison with zero cannot tell from it
NAMED = 8  # so many names are told in a message


@dataclass
class Body:
    """A link that grows by what is fixed to it."""

    link: Link
    lumped: list[str] = field(default_factory=list)  # names, in the order of lumping
    joints: list[Joint] = field(default_factory=list)  # to children that stay links


def _below(bodies: dict[str, Body], name: str) -> list[str]:
    """The links that disappear with a link: those lumped into it, and all that hang on it."""
    queue = [name]
    for link in queue:
        queue += [joint.child for joint in bodies[link].joints]
    return [part for link in queue for part in (link, *bodies[link].lumped)][1:]


def dropped_link(robot: Robot, bodies: dict[str, Body], name: str, file: Path | None) -> Diagnostic:
    """What Gazebo leaves out; blamed is the link that was surely meant to have mass."""
    blamed = _lacks_mass(robot, bodies[name])
    why = f"`{blamed.name}` has " + (
        "no <inertial>" if blamed.inertial is None else f"a mass of {blamed.inertial.mass:g} kg"
    )
    if blamed.name != name:
        why += f", and `{name}`, which it is fixed to, has no mass either"
    below = [link for link in _below(bodies, name) if link != blamed.name]
    told = ", ".join(f"`{link}`" for link in below[:NAMED])
    told += f" and {len(below) - NAMED} more" if len(below) > NAMED else ""
    if name == robot.root:
        message = f"Gazebo refuses the robot: its root link {why}"
        if blamed.name != name:
            message = f"Gazebo refuses the robot: {why}"
        message += f"; with the root disappear {told}." if below else "."
    else:
        message = f"Gazebo drops the link `{name}` with the joint above it"
        message += f" and {told}: {why}." if below else f": {why}."
    return Diagnostic(
        code="ROB040",
        severity=Severity.ERROR,
        message=message,
        file=file,
        line=blamed.line,
        element=f"link[@name='{blamed.name}']",
        hint=f"Give `{blamed.name}` an <inertial> with a mass above {MASSLESS:g} kg"
        + (", or fix a link with mass to it by a fixed joint." if blamed.name == name else "."),
    )


def _lacks_mass(robot: Robot, body: Body) -> Link:
    """The part of a massless body that should have mass.

    That is one whose <inertial> says 0, or one that can be touched or seen; else the body's own
    link, which is nothing but a frame.
    """
    links = {link.name: link for link in robot.links}
    parts = [links[name] for name in (body.link.name, *body.lumped)]
    return next(
        (part for part in parts if part.inertial is not None),
        next((part for part in parts if part.collisions or part.visuals), parts[0]),
    )


def two_zero_masses(parent: Link, child: Link, file: Path | None) -> list[Diagnostic]:
    """Gazebo computes the common centre of two zero masses as 0/0 and refuses the robot."""
    if parent.inertial is None or child.inertial is None:
        return []
    if parent.inertial.mass or child.inertial.mass:
        return []
    return [
        Diagnostic(
            code="ROB041",
            severity=Severity.ERROR,
            message=f"The links `{child.name}` and `{parent.name}` are fixed together and both "
            "have a mass of 0: their centre of mass is not a number, and Gazebo refuses the robot.",
            file=file,
            line=child.line,
            element=f"link[@name='{child.name}']/inertial/mass",
            hint=f"Remove <inertial> from `{child.name}`: no inertia is better than a zero mass.",
        )
    ]


def is_impossible(inertial: Inertial) -> bool:
    """Whether no body of this mass has this inertia; that of a zero mass means nothing."""
    return inertial.mass > 0 and not is_possible(inertial.inertia)


def impossible_sum(robot: Robot, body: Body, file: Path | None) -> list[Diagnostic]:
    """The reader has judged single links; here the sum of sound ones is new."""
    inertial = body.link.inertial
    if not body.lumped or inertial is None or is_possible(inertial.inertia):
        return []
    parts = {body.link.name, *body.lumped}
    written = [link.inertial for link in robot.links if link.name in parts]
    if any(part is not None and is_impossible(part) for part in written):
        return []
    return [
        Diagnostic(
            code="ROB042",
            severity=Severity.ERROR,
            message=f"With the links that are fixed to it, `{body.link.name}` has an inertia that "
            "no body has, and Gazebo refuses the robot.",
            file=file,
            line=body.link.line,
            element=f"link[@name='{body.link.name}']",
            hint=f"Correct the inertia of {', '.join(f'`{name}`' for name in body.lumped[:NAMED])}"
            f" or of `{body.link.name}` itself.",
        )
    ]
