"""The rules over the bodies of a robot, each with its facts and no files."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.lumped import lumped_frames, many_links, mass_ratio
from wsgen.descriptions.urdf.lumping import lump
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    MOST_LINKS,
    GazeboTag,
    Inertial,
    Joint,
    JointType,
    Link,
    Plugin,
    Robot,
    Sensor,
)

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

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


@pytest.mark.slow
def test_links_that_an_engine_takes() -> None:
    assert not list(many_links(lump(star(MOST_LINKS - 1))[0], FILE))
    # One more, which is fixed, is no body of its own; one that is loose is a tree of its own.
    assert not list(many_links(lump(star(MOST_LINKS, JointType.FIXED))[0], FILE))
    loose = (joint("root", "l0", JointType.FLOATING),)
    assert not list(many_links(replace(star(MOST_LINKS), loose=loose), FILE))


def chain(*masses: float, held_by: JointType = JointType.CONTINUOUS) -> Robot:
    """Links `l0`, `l1`, …, each on the one before, of which `l2` is held by a joint of a kind."""
    names = [f"l{place}" for place in range(len(masses))]
    return Robot(
        name="r",
        root="l0",
        links=tuple(
            link(name, mass, line)
            for line, (name, mass) in enumerate(zip(names, masses, strict=True), 3)
        ),
        joints=tuple(
            joint(parent, child, held_by if child == "l2" else JointType.CONTINUOUS)
            for parent, child in itertools.pairwise(names)
        ),
    )


def ratios(robot: Robot) -> list[Diagnostic]:
    return list(mass_ratio(robot.links, lump(robot)[0], FILE))


def test_a_light_link_that_carries_a_heavy_one() -> None:
    (found,) = ratios(chain(5.0, 0.01, 2.0))
    assert (found.code, found.severity, found.line) == ("ROB124", Severity.INFO, 4)
    assert found.element == "link[@name='l1']/inertial/mass"
    assert "`l1` (0.01 kg) carries `l2` (2 kg) at the joint `l1_l2`" in found.message
    assert '<mass value="0.02"/>' in (found.hint or "")
    (found,) = ratios(chain(5.0, 0.01, 2.0, 0.001, 0.2))
    assert found.message.endswith("another link.")
    (found,) = ratios(chain(5.0, 0.01, 2.0, 0.001, 0.2, 1e-4, 0.1))
    assert found.line == 8
    assert found.message.endswith("The same holds for 2 other links.")


def test_masses_that_engines_take() -> None:
    assert not ratios(chain(5.0, 0.03, 2.0))
    assert not ratios(chain(0.01, 5.0, 0.01))  # the root stands on something
    # What is fixed to the light link belongs to it.
    assert not ratios(chain(5.0, 0.001, 0.5, 2.0, held_by=JointType.FIXED))
    static = replace(chain(5.0, 0.01, 2.0), is_static=True)
    assert not list(mass_ratio(static.links, static, FILE))


def test_masses_that_are_not_known() -> None:
    robot = chain(5.0, 0.01, 2.0)
    for place in (1, 2):
        links = [*robot.links]
        links[place] = replace(links[place], is_as_meant=False)
        assert not ratios(replace(robot, links=tuple(links)))
    one_massless = (robot.links[0], Link(name="l1"), robot.links[2])
    assert not ratios(replace(robot, links=one_massless))


def test_a_light_link_whose_mass_is_fixed_to_it() -> None:
    frame = chain(5.0, 0.01, 0.01, 2.0, held_by=JointType.FIXED)
    links = (frame.links[0], Link(name="l1", line=4), *frame.links[2:])
    joints = (*frame.joints[:2], joint("l1", "l3"))
    (found,) = ratios(replace(frame, links=links, joints=joints))
    assert (found.line, found.element) == (4, "link[@name='l1']")


def with_sensor(tag: GazeboTag, *, mass: float = 2.0, kind: JointType = JointType.FIXED) -> Robot:
    """A base with a mast, on which a lidar is fixed."""
    return Robot(
        name="r",
        root="base",
        links=(link("base", mass), link("mast", 0.5), Link(name="lidar", line=7)),
        joints=(joint("base", "mast", JointType.FIXED), joint("mast", "lidar", kind)),
        gazebo=(tag,),
    )


def lumped_of(robot: Robot) -> list[Diagnostic]:
    return list(lumped_frames(robot, lump(robot)[0], FILE))


ON_LIDAR = GazeboTag(reference="lidar", sensors=(Sensor("scan", "gpu_lidar"),), line=20)
OF_LIDAR = GazeboTag(
    reference=None, plugins=(Plugin("x", {"link_name": ("lidar",)}, "X"),), line=20
)


@pytest.mark.parametrize("tag", [ON_LIDAR, OF_LIDAR])
def test_a_lumped_link_that_gazebo_knows_by_name(tag: GazeboTag) -> None:
    (found,) = lumped_of(with_sensor(tag))
    assert (found.code, found.severity, found.line) == ("ROB128", Severity.INFO, 20)
    assert "lumps `lidar` into `base`" in found.message
    assert "weighs 2.5 kg before and after" in found.message


def test_a_robot_that_loses_mass() -> None:
    robot = with_sensor(ON_LIDAR)
    plate, arm = link("plate", 0.0), link("arm", 3.0)
    more = replace(
        robot,
        links=(*robot.links, replace(plate, inertial=None), arm),
        joints=(*robot.joints, joint("base", "plate"), joint("plate", "arm")),
    )
    (found,) = lumped_of(more)
    assert "weighs 5.5 kg as written, and 2.5 kg in Gazebo" in found.message


@pytest.mark.parametrize(
    "robot",
    [
        with_sensor(ON_LIDAR, mass=0.0),  # ROB051
        with_sensor(replace(ON_LIDAR, reference="base")),
        with_sensor(replace(ON_LIDAR, sensors=())),
        with_sensor(
            replace(ON_LIDAR, sensors=(Sensor("scan", "gpu_lidar", {"topic": ("scan",)}),))
        ),
        with_sensor(replace(OF_LIDAR, plugins=(Plugin("x", {"frame_name": ("lidar",)}, "X"),))),
    ],
)
def test_lumped_links_whose_names_do_not_matter(robot: Robot) -> None:
    assert lumped_of(robot) == []
