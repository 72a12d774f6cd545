"""What Gazebo leaves out or refuses when it lumps fixed joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.extensions import without_effect
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.inertia import as_attributes, if_filled, is_possible

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.description.lumping import Body
    from wsgen.model.robot import GazeboTag, Inertial, Joint, Link, Robot

NAMED = 8  # so many names are told in a message


def drop_massless(robot: Robot, bodies: Mapping[str, Body]) -> tuple[list[str], list[str]]:
    """The bodies that stay, and those whose lack of mass cuts off what hangs on them."""
    kept, dropped, queue = [], [], [robot.root]
    for name in queue:
        is_world = robot.fixed_to_world and name == robot.root
        if is_world or bodies[name].mass > 0:
            kept.append(name)
            queue += [joint.child for joint in bodies[name].joints]
        else:
            dropped.append(name)
    return kept, dropped


def dropped_links(
    robot: Robot, bodies: Mapping[str, Body], names: Sequence[str], file: Path | None
) -> Iterator[Diagnostic]:
    """What Gazebo leaves out; blamed is the link that was surely meant to have mass."""
    for name in names:
        blamed = _lacks_mass(bodies[name])
        message = _told(robot, bodies, name, blamed)
        yield Diagnostic(
            code="ROB040",
            severity=Severity.ERROR,
            message=message,
            file=file,
            line=blamed.line,
            element=f"link[@name='{blamed.name}']",
            hint=f"Give `{blamed.name}` an <inertial> with a mass"
            + (", or fix a link with mass to it by a fixed joint." if blamed.name == name else "."),
        )


def _told(robot: Robot, bodies: Mapping[str, Body], name: str, blamed: Link) -> str:
    why = f"`{blamed.name}` has " + (
        "no <inertial>" if blamed.inertial is None else f"a mass of {blamed.inertial.mass:g} kg"
    )
    if blamed.name != name:
        why += f", and `{name}`, which it is fixed to, has no mass either"
    below = [link for link in _below(bodies, name) if link != blamed.name]
    told = _named(below)
    if name == robot.root:
        message = f"Gazebo refuses the robot: its root link {why}"
        if blamed.name != name:
            message = f"Gazebo refuses the robot: {why}"
        return message + (f"; with the root disappear {told}." if below else ".")
    message = f"Gazebo drops the link `{name}` with the joint above it"
    return message + (f" and {told}: {why}." if below else f": {why}.")


def _below(bodies: Mapping[str, Body], name: str) -> list[str]:
    """The links that disappear with a link: those lumped into it, and all that hang on it."""
    queue = [name]
    for link in queue:
        queue += [joint.child for joint in bodies[link].joints]
    return [part.name for link in queue for part, _ in bodies[link].parts][1:]


def _lacks_mass(body: Body) -> Link:
    """The part of a massless body that should have mass.

    That is one whose <inertial> says 0, or one that can be touched or seen; else the body's own
    link, which is nothing but a frame.
    """
    parts = [part for part, _ in body.parts]
    return next(
        (part for part in parts if part.inertial is not None),
        next((part for part in parts if part.collisions or part.visuals), parts[0]),
    )


def dropped_by_old_sdformat(
    robot: Robot, bodies: Mapping[str, Body], kept: Sequence[str], file: Path | None
) -> Iterator[Diagnostic]:
    """What hangs on a lumped link without mass, which older versions drop with it."""
    joints: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        joints.setdefault(joint.parent, []).append(joint)
    links = {link.name: link for link in robot.links}
    for name in kept:
        body = bodies[name]
        for massless in reversed(body.massless):
            below = [massless]
            for link in below:
                below += [joint.child for joint in joints.pop(link, ())]
            lost = [link for link in below if link in bodies]
            mass = sum(bodies[link].mass for link in lost)
            if mass and body.is_as_meant:
                yield Diagnostic(
                    code="ROB080",
                    severity=Severity.WARNING,
                    message=f"`{massless}` has no mass, and sdformat before 9.10.1, 12.7.2 and "
                    "13.5 (Debian 12 and Ubuntu 22.04 have such) drops what moves on it: "
                    f"{_named(lost)}, {mass:.4g} kg.",
                    file=file,
                    line=links[massless].line,
                    element=f"link[@name='{massless}']",
                    hint=f"Give `{massless}` an <inertial> with a small mass, or join "
                    f"{_named(lost[:1])} to `{name}`.",
                )


def _named(names: Sequence[str]) -> str:
    """The names; of many, the first few."""
    told = ", ".join(f"`{name}`" for name in names[:NAMED])
    return told + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def sdf_joint_ends(
    robot: Robot, bodies: Mapping[str, Body], file: Path | None
) -> Iterator[Diagnostic]:
    """Joints of SDF in `<gazebo>` that join what is no link of the model."""
    body_of = {part.name: name for name, body in bodies.items() for part, _ in body.parts}
    if any(tag.is_open for tag in robot.gazebo):
        return
    others = {joint.name for joint in robot.joints} | {"world", "__model__"}
    others |= {name for tag in robot.gazebo for name in tag.frames}
    above = {joint.child: joint.name for joint in robot.joints}
    for joint in (joint for tag in robot.gazebo for joint in tag.joints):
        for end, link in joint.ends.items():
            told = f"The SDF joint `{joint.name}` in <gazebo> has `{link}` as {end}"
            name = body_of.get(link)
            if name == link or link in others or "::" in link:
                continue
            yield Diagnostic(
                code="ROB078" if name is None else "ROB079",
                severity=Severity.ERROR if name is None else Severity.WARNING,
                message=f"{told}, and no link is called so: Gazebo refuses the robot."
                if name is None
                else f"{told}, which is lumped into `{name}`: Gazebo with sdformat before 9.9, "
                "12.7 and 13.1 (Debian 12 and Ubuntu 22.04 have such) refuses the robot.",
                file=file,
                line=joint.line,
                element=f"gazebo/joint[@name='{joint.name}']/{end}",
                hint="Name a link of this robot."
                if name is None
                else f'Write <gazebo reference="{above[link]}"><preserveFixedJoint>true'
                f"</preserveFixedJoint></gazebo>, or name `{name}`.",
            )


def nothing_but_the_world(robot: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """A root called `world` is no link of its own."""
    if robot.fixed_to_world and len(robot.links) == 1:
        yield Diagnostic(
            code="ROB005",
            severity=Severity.ERROR,
            message="The robot has no link besides `world`, and Gazebo refuses it.",
            file=file,
            line=robot.links[0].line,
            element="link[@name='world']",
            hint="Join a link to it, or give it another name.",
        )


def without_inertia(body: Body, lumped: Link, file: Path | None) -> Iterator[Diagnostic]:
    """A mass without any inertia, which no engine can turn; `lumped` is all of the body."""
    if lumped.inertial is None or any(lumped.inertial.inertia):
        return
    # The link that is written with that mass, which may be another one than gives the name.
    link = next(part for part, _ in body.parts if part.inertial is not None)
    yield Diagnostic(
        code="ROB037",
        severity=Severity.WARNING,
        message=f"The link `{link.name}` has a mass of {lumped.inertial.mass:g} kg and no inertia: "
        "the slightest touch makes it spin.",
        file=file,
        line=link.line,
        element=f"link[@name='{link.name}']/inertial/inertia",
        hint="Compute it from mass and shape, or export it from CAD."
        if (moments := if_filled(link)) is None
        else f"If it is evenly filled: {as_attributes(moments)} (kg m², the products 0).",
    )


def two_zero_masses(robot: Robot, body: Body, file: Path | None) -> Iterator[Diagnostic]:
    """Gazebo computes the common centre of two zero masses as 0/0 and refuses the robot."""
    if body.two_zeros is None or (robot.fixed_to_world and body.link.name == robot.root):
        return
    parent, child = body.two_zeros
    links = {part.name: part for part, _ in body.parts}
    blamed = links[child] if links[child].inertial is not None else links[parent]
    yield Diagnostic(
        code="ROB041",
        severity=Severity.ERROR,
        message=f"The links `{child}` and `{parent}` are fixed together and have no mass: "
        "their centre of mass is not a number, and Gazebo refuses the robot.",
        file=file,
        line=blamed.line,
        element=f"link[@name='{blamed.name}']/inertial/mass",
        hint=f"Remove <inertial> from `{blamed.name}`: no inertia is better than a zero mass.",
    )


def is_impossible(inertial: Inertial) -> bool:
    """Whether no body of this mass has this inertia; that of a zero mass means nothing."""
    return inertial.mass > 0 and not is_possible(inertial.inertia)


def impossible_sum(body: Body, link: Link, file: Path | None) -> Iterator[Diagnostic]:
    """The reader has judged single links; here the sum of sound ones is new."""
    if len(body.parts) == 1 or link.inertial is None or is_possible(link.inertial.inertia):
        return
    if any(part.inertial is not None and is_impossible(part.inertial) for part, _ in body.parts):
        return
    yield Diagnostic(
        code="ROB042",
        severity=Severity.ERROR,
        message=f"With the links that are fixed to it, `{link.name}` has an inertia that no body "
        "has, and Gazebo refuses the robot.",
        file=file,
        line=link.line,
        element=f"link[@name='{link.name}']",
        hint=f"Correct the inertia of {', '.join(f'`{name}`' for name in body.lumped[:NAMED])}"
        f" or of `{link.name}` itself.",
    )


def values_without_effect(
    body: Body, link: Link, tags: Sequence[GazeboTag], file: Path | None
) -> Iterator[Diagnostic]:
    """Gazebo finds the collisions that a value is for by their names, and may find none."""
    for tag, key in without_effect(link, tags):
        about = next(part for part, _ in body.parts if part.name == tag.reference)
        if not about.collisions:
            continue
        where = "" if about is body.link else f", which is lumped into `{link.name}`"
        yield Diagnostic(
            code="ROB046",
            severity=Severity.WARNING,
            message=f"<{key}> has no effect: Gazebo finds no collision of the link "
            f"`{about.name}`{where} by the name that it looks for.",
            file=file,
            line=tag.line,
            element=f"gazebo[@reference='{about.name}']/{key}",
            hint=f"Remove the attribute `name` from the collisions of `{about.name}`."
            if any(collision.name for collision in about.collisions)
            else f"Give `{about.name}` a name that does not begin with `{link.name}`.",
        )
