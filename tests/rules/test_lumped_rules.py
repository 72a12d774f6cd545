"""The rules over the bodies of a robot, each with its facts and no files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from wsgen.diagnostics import Severity
from wsgen.model.robot import MOST_LINKS, Inertial, Joint, JointType, Link, Robot
from wsgen.rules.lumped import many_links
from wsgen.urdf.lumping import lump

FILE = Path("robot.urdf")


def link(name: str, mass: float = 1.0, line: int = 3) -> Link:
    inertia = (mass, 0.0, 0.0, mass, 0.0, mass)
    return Link(name=name, inertial=Inertial(mass=mass, inertia=inertia), line=line)


def joint(parent: str, child: str, kind: JointType = JointType.CONTINUOUS) -> Joint:
    return Joint(name=f"{parent}_{child}", type=kind, parent=parent, child=child)


def star(number: int, *kinds: JointType) -> Robot:
    """A root with `number` links around it; the first joints are of other kinds."""
    names = [f"l{place}" for place in range(number)]
    types = (*kinds, *[JointType.CONTINUOUS] * number)
    return Robot(
        name="r",
        root="root",
        links=(link("root", line=2), *map(link, names)),
        joints=tuple(joint("root", name, kind) for name, kind in zip(names, types, strict=False)),
    )


def test_many_links() -> None:
    (found,) = many_links(lump(star(MOST_LINKS))[0], FILE)
    assert (found.code, found.severity, found.line) == ("ROB123", Severity.INFO, 2)
    assert f"{MOST_LINKS + 1} links" in found.message


def test_links_that_an_engine_takes() -> None:
    assert not list(many_links(lump(star(MOST_LINKS - 1))[0], FILE))
    # One more, which is fixed, is no body of its own; one that is loose is a tree of its own.
    assert not list(many_links(lump(star(MOST_LINKS, JointType.FIXED))[0], FILE))
    loose = (joint("root", "l0", JointType.FLOATING),)
    assert not list(many_links(replace(star(MOST_LINKS), loose=loose), FILE))
