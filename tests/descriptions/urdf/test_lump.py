"""Lumping, against numbers worked out by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from wsgen.descriptions.urdf.extensions import kept_joints
from wsgen.descriptions.urdf.lumping import lump, parts_of_impossible_sums
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    Collision,
    GazeboTag,
    Inertial,
    Joint,
    JointType,
    Link,
    Plugin,
    Robot,
    Sensor,
    Sphere,
    Surface,
    Visual,
)
from wsgen.model.transform import IDENTITY, Pose

UNIT = (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)


def body(name: str, mass: float | None = 1.0, **more: object) -> Link:
    inertial = None if mass is None else Inertial(mass=mass, inertia=UNIT)
    return replace(Link(name=name, inertial=inertial), **more)  # type: ignore[arg-type]


def fixed(parent: str, child: str, pose: Pose = IDENTITY) -> Joint:
    return Joint(
        name=f"{parent}_{child}",
        type=JointType.FIXED,
        parent=parent,
        child=child,
        pose_in_parent=pose,
    )


def turning(parent: str, child: str, pose: Pose = IDENTITY) -> Joint:
    return replace(fixed(parent, child, pose), type=JointType.CONTINUOUS)


def robot(
    links: list[Link], joints: list[Joint], gazebo: tuple[GazeboTag, ...] = (), **more: object
) -> Robot:
    """As it is read: the reader says which joints are kept."""
    kept = kept_joints(gazebo)
    made = Robot(
        name="r",
        root=links[0].name,
        links=tuple(links),
        joints=tuple(replace(joint, kept_by=kept.get(joint.name, "")) for joint in joints),
        gazebo=gazebo,
    )
    return replace(made, **more)  # type: ignore[arg-type]


def test_parallel_axis() -> None:
    lumped, found = lump(
        robot([body("a", 1.0), body("b", 3.0)], [fixed("a", "b", Pose((4.0, 0.0, 0.0)))])
    )
    (a,) = lumped.links
    assert found == ()
    assert a.inertial is not None
    assert a.inertial.mass == 4.0
    assert a.inertial.pose_in_link.xyz == (3.0, 0.0, 0.0)
    # 1 kg at 3 m and 3 kg at 1 m from the common center: 9 + 3 across, nothing along.
    assert a.inertial.inertia == pytest.approx((2.0, 0.0, 0.0, 14.0, 0.0, 14.0))


def test_products_of_inertia() -> None:
    lumped, _ = lump(robot([body("a"), body("b")], [fixed("a", "b", Pose((2.0, 2.0, 0.0)))]))
    assert lumped.links[0].inertial is not None
    # Two times 1 kg at (1, 1, 0): ixy is -2.
    assert lumped.links[0].inertial.inertia == pytest.approx((4.0, -2.0, 0.0, 4.0, 0.0, 6.0))


def test_rotated_inertia() -> None:
    tensor = (1.0, 0.0, 0.0, 2.0, 0.0, 2.5)
    child = Link(name="b", inertial=Inertial(mass=1.0, inertia=tensor))
    quarter = Pose((0.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    lumped, _ = lump(robot([body("a"), child], [fixed("a", "b", quarter)]))
    assert lumped.links[0].inertial is not None
    # The child's x axis is the parent's y axis.
    assert lumped.links[0].inertial.inertia == pytest.approx((3.0, 0.0, 0.0, 2.0, 0.0, 3.5))


def test_shapes_and_surfaces_come_along() -> None:
    child = body(
        "b",
        collisions=(
            Collision(
                geometry=Sphere(radius=1.0),
                pose_in_link=Pose((1.0, 0.0, 0.0)),
                surface=Surface(mu1=0.2),
            ),
        ),
        visuals=(Visual(geometry=Sphere(radius=1.0), rgba=(0.0, 1.0, 0.0, 1.0), name="v"),),
    )
    pose = Pose((0.0, 0.0, 1.0), (0.0, 0.0, math.pi / 2))
    lumped, _ = lump(robot([body("a"), child], [fixed("a", "b", pose)]))
    (a,) = lumped.links
    assert a.collisions[0].pose_in_link.xyz == pytest.approx((0.0, 1.0, 1.0))
    assert a.collisions[0].surface.mu1 == 0.2
    assert a.visuals[0].pose_in_link == pose
    assert a.visuals[0].rgba == (0.0, 1.0, 0.0, 1.0)
    # As sdformat names them: by the link they come from, if they have no name.
    assert (a.collisions[0].name, a.visuals[0].name) == ("b", "v")


def test_joints_below_a_lumped_link_move_to_its_parent() -> None:
    quarter = Pose((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    lumped, _ = lump(
        robot(
            [body("a"), body("b"), body("c"), body("d")],
            [fixed("a", "b", quarter), fixed("b", "c", quarter), turning("c", "d", quarter)],
        )
    )
    (joint,) = lumped.joints
    assert (joint.parent, joint.child, joint.name) == ("a", "d", "c_d")
    assert joint.pose_in_parent.xyz == pytest.approx((0.0, 1.0, 0.0))
    assert abs(joint.pose_in_parent.rpy[2]) == pytest.approx(math.pi / 2)
    assert [link.name for link in lumped.links] == ["a", "d"]


def test_massless_root_takes_the_lumped_body_and_keeps_its_name() -> None:
    lumped, found = lump(robot([body("dummy", None), body("base")], [fixed("dummy", "base")]))
    assert found == ()
    assert [(link.name, link.inertial and link.inertial.mass) for link in lumped.links] == [
        ("dummy", 1.0)
    ]


def test_lumped_massless_link_does_not_cut_off_its_children() -> None:
    """sdformat since its pull request 1238; older ones drop c here."""
    lumped, found = lump(
        robot([body("a"), body("b", None), body("c")], [fixed("a", "b"), turning("b", "c")])
    )
    assert [(one.code, one.severity) for one in found] == [("ROB080", Severity.WARNING)]
    assert [link.name for link in lumped.links] == ["a", "c"]


def test_for_gazebo_classic_it_cuts_off_its_children() -> None:
    links = [body("a"), body("b", None), body("c"), body("d"), body("e")]
    joints = [fixed("a", "b"), turning("b", "c"), turning("c", "d"), turning("a", "e")]
    lumped, found = lump(robot(links, joints), for_classic=True)
    assert [one.code for one in found] == ["ROB080"]
    assert [link.name for link in lumped.links] == ["a", "e"]
    assert [joint.name for joint in lumped.joints] == ["a_e"]


def test_moving_massless_link_is_dropped_with_what_hangs_on_it() -> None:
    lumped, found = lump(
        robot(
            [body("a"), body("b", None), body("c"), body("d")],
            [turning("a", "b"), turning("b", "c"), fixed("c", "d")],
        )
    )
    assert [link.name for link in lumped.links] == ["a"]
    assert lumped.joints == ()
    (only,) = found
    assert (only.code, only.severity) == ("ROB040", Severity.ERROR)
    assert all(name in only.message for name in ("`b`", "`c`", "`d`"))


def test_massless_scenery_of_an_arm_is_dropped_with_a_warning() -> None:
    links = [body("world", None), body("plate", None), body("arm")]
    joints = [fixed("world", "plate"), fixed("world", "arm")]
    lumped, found = lump(robot(links, joints, fixed_to_world=True))
    assert [link.name for link in lumped.links] == ["world", "arm"]
    assert [(one.code, one.severity) for one in found] == [("ROB040", Severity.WARNING)]


def test_massless_scenery_that_is_all_there_is_is_refused() -> None:
    links = [body("world", None), body("plate", None)]
    _, found = lump(robot(links, [fixed("world", "plate")], fixed_to_world=True))
    assert [(one.code, one.severity) for one in found] == [("ROB040", Severity.ERROR)]
    assert found[0].message.endswith("No link is left, and Gazebo refuses the robot.")


@pytest.mark.parametrize("mass", [None, 0.0])
def test_root_without_mass_is_refused(mass: float | None) -> None:
    lumped, found = lump(robot([body("a", mass), body("b")], [turning("a", "b")]))
    assert lumped.links == ()
    assert found[0].code == "ROB040"
    assert "refuses" in found[0].message


def test_a_mass_of_almost_nothing_is_a_mass() -> None:
    """Before sdformat's pull request 1238 it was none up to a milligram."""
    light = robot([body("b"), body("a", 1e-7)], [turning("b", "a")])
    lumped, found = lump(light)
    assert (len(lumped.links), found) == (2, ())
    lumped, found = lump(light, for_classic=True)
    assert ([one.name for one in lumped.links], found[0].code) == (["b"], "ROB040")


@pytest.mark.parametrize(
    ("inertia", "is_taken"),
    [
        ((0.1, 0.0, 0.0, 0.1, 0.0, 0.1), True),
        ((9.0, 0.0, 0.0, 0.1, 0.0, 0.1), True),  # of no body, which ODE does not mind
        ((0.0, 0.0, 0.0, 0.1, 0.0, 0.1), False),
        ((0.1, 0.0, 0.0, -0.1, 0.0, 0.1), False),
        ((0.1, 0.2, 0.0, 0.1, 0.0, 0.1), False),
        ((0.1, 0.0, 0.0, 0.1, 0.2, 0.1), False),
    ],
)
def test_the_engine_of_gazebo_classic_wants_positive_moments(
    inertia: tuple[float, float, float, float, float, float], *, is_taken: bool
) -> None:
    """As a pendulum on a hinge swings there."""
    only = Link(name="a", inertial=Inertial(mass=2.0, inertia=inertia))
    lumped, _ = lump(robot([only], []), for_classic=True)
    assert lumped.links[0].inertial is not None
    assert lumped.links[0].inertial.mass == 2.0
    assert lumped.links[0].inertial.inertia == (inertia if is_taken else UNIT)


SEEN = {"visuals": (Visual(geometry=Sphere(radius=0.1)),)}
CAMERA = GazeboTag(reference="b", sensors=(Sensor(name="s"),))
DRIVE = Plugin(filename="libp.so", values={"body_name": ("b",)})


@pytest.mark.parametrize(
    ("frame", "joints", "tags", "severity"),
    [
        (body("b", None), [fixed("a", "b")], [], Severity.WARNING),
        (body("b", None, **SEEN), [fixed("a", "b")], [], Severity.ERROR),
        (body("b", None), [turning("a", "b")], [], Severity.ERROR),
        (body("b", None), [fixed("a", "b"), turning("b", "c")], [], Severity.ERROR),
        (body("b", None), [fixed("a", "b")], [CAMERA], Severity.ERROR),
        (
            body("b", None),
            [fixed("a", "b")],
            [GazeboTag(reference=None, plugins=(DRIVE,))],
            Severity.ERROR,
        ),
    ],
)
def test_a_dropped_frame_is_an_error_where_something_of_it_is_used(
    frame: Link, joints: list[Joint], tags: list[GazeboTag], severity: Severity
) -> None:
    kept = GazeboTag(reference="a_b", values={"preserveFixedJoint": "true"})
    links = [body("a"), frame, *([body("c")] if joints[1:] else [])]
    lumped, found = lump(robot(links, joints, gazebo=(kept, *tags)))
    assert [link.name for link in lumped.links] == ["a"]
    assert [(one.code, one.severity) for one in found] == [("ROB040", severity)]


@pytest.mark.parametrize(
    ("masses", "joints", "is_refused"),
    [
        # What is fixed first to what decides whether 0/0 is ever computed.
        ({"a": None, "b": 0.0, "c": 1.0}, [("a", "b"), ("a", "c")], True),
        ({"a": None, "b": 1.0, "c": 0.0}, [("a", "b"), ("a", "c")], False),
        ({"a": None, "b": 0.0, "c": 1.0}, [("a", "b"), ("b", "c")], False),
        ({"a": 1.0, "b": None, "c": 0.0}, [("a", "b"), ("b", "c")], True),
        ({"a": 1.0, "b": 0.0}, [("a", "b")], False),
    ],
)
def test_two_zero_masses(
    masses: dict[str, float | None], joints: list[tuple[str, str]], *, is_refused: bool
) -> None:
    """As tried with `ign sdf -k`."""
    links = [body(name, mass) for name, mass in masses.items()]
    _, found = lump(robot(links, [fixed(*ends) for ends in joints]))
    assert [diagnostic.code for diagnostic in found] == (["ROB041"] if is_refused else [])


def test_zero_mass_adds_its_inertia() -> None:
    lumped, found = lump(robot([body("a", 1.0), body("b", 0.0)], [fixed("a", "b")]))
    assert found == ()
    assert lumped.links[0].inertial is not None
    assert lumped.links[0].inertial.inertia == (2.0, 0.0, 0.0, 2.0, 0.0, 2.0)


@pytest.mark.parametrize("kind", [JointType.FLOATING, JointType.PLANAR])
def test_what_gazebo_makes_no_joint_of_is_loose(kind: JointType) -> None:
    quarter = Pose((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    lumped, found = lump(
        robot(
            [body("a"), body("b"), body("c"), body("d"), body("e")],
            [
                fixed("a", "b", quarter),
                replace(fixed("b", "c", quarter), type=kind),
                turning("c", "d"),
                fixed("d", "e"),
            ],
        )
    )
    assert found == ()
    assert [joint.name for joint in lumped.joints] == ["c_d"]
    (loose,) = lumped.loose
    assert (loose.parent, loose.child) == ("a", "c")
    assert loose.pose_in_parent.xyz == pytest.approx((1.0, 1.0, 0.0))
    assert lumped.mass == 5.0


def test_loose_and_massless_is_dropped() -> None:
    lumped, found = lump(
        robot([body("a"), body("b", None)], [replace(fixed("a", "b"), type=JointType.FLOATING)])
    )
    assert (lumped.loose, [link.name for link in lumped.links]) == ((), ["a"])
    assert [diagnostic.code for diagnostic in found] == ["ROB040"]


def test_impossible_sum() -> None:
    """The mass of 0 lets the inertia through that is its part of the sum."""
    flat = Link(name="b", inertial=Inertial(mass=0.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 9.0)))
    _, found = lump(robot([body("a"), flat], [fixed("a", "b")]))
    assert [diagnostic.code for diagnostic in found] == ["ROB042"]


def test_an_impossible_part_is_reported_by_the_reader_and_its_sum_is_not() -> None:
    flat = Link(name="b", inertial=Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 9.0)))
    model = robot([body("a"), flat, body("c")], [fixed("a", "b"), turning("b", "c")])
    assert lump(model)[1] == ()
    assert parts_of_impossible_sums(model) == {"a", "b"}


@pytest.mark.parametrize("mass", [None, 0.0])
def test_blamed_is_the_link_that_should_have_mass(mass: float | None) -> None:
    """The tutorial's robot, its only body below an empty root."""
    shape = Collision(geometry=Sphere(radius=1.0))
    base = replace(body("base", mass), collisions=(shape,))
    empty = [body("dummy", None), base, body("frame", None)]
    joints = [fixed("dummy", "base"), fixed("base", "frame")]
    (found,) = lump(robot(empty, joints))[1]
    assert found.element == "link[@name='base']"
    assert "`base` has no <inertial>" in found.message or "mass of 0 kg" in found.message
    assert "`dummy`, which a fixed joint attaches it to, has no mass either" in found.message
    assert "`frame`" in found.message
    assert "`base`" in (found.hint or "")
    (found,) = lump(robot([body("root"), *empty], [turning("root", "dummy"), *joints]))[1]
    assert found.message.startswith("Gazebo drops the link `dummy` with the joint above it")
    assert found.element == "link[@name='base']"


def tagged(key: str) -> GazeboTag:
    return GazeboTag(reference="a_b", values={key: "true"})


def test_preserved_joint_stays_fixed() -> None:
    lumped, _ = lump(
        robot(
            [body("a"), body("b")],
            [fixed("a", "b")],
            gazebo=(tagged("preserveFixedJoint"), tagged("disableFixedJointLumping")),
        )
    )
    assert [joint.type for joint in lumped.joints] == [JointType.FIXED]


def test_disabled_lumping_makes_a_joint_that_cannot_turn() -> None:
    lumped, _ = lump(
        robot(
            [body("a"), body("b")], [fixed("a", "b")], gazebo=(tagged("disableFixedJointLumping"),)
        )
    )
    (joint,) = lumped.joints
    assert joint.type is JointType.REVOLUTE
    assert joint.limit is not None
    assert (joint.limit.lower, joint.limit.upper) == (0.0, 0.0)


def test_what_is_fixed_to_the_world_is_not_lumped_into_it() -> None:
    lumped, found = lump(
        robot(
            [body("world", None), body("a"), body("b")],
            [fixed("world", "a"), fixed("a", "b")],
            fixed_to_world=True,
        )
    )
    assert found == ()
    assert [link.name for link in lumped.links] == ["world", "a"]
    assert lumped.mass == 2.0


def test_tags_follow_their_links() -> None:
    lumped, _ = lump(
        robot(
            [body("a"), body("b"), body("c")],
            [fixed("a", "b"), fixed("b", "c")],
            gazebo=(GazeboTag(reference="c", sensors=(Sensor("eye"),)),),
        )
    )
    assert lumped.gazebo[0].reference == "a"


@pytest.mark.slow
def test_a_long_chain() -> None:
    count = 10_000
    ball = (Collision(geometry=Sphere(radius=0.01)),)
    links = [body(f"l{index}", collisions=ball) for index in range(count)]
    joints = [
        fixed(f"l{index}", f"l{index + 1}", Pose((0.001, 0.0, 0.0))) for index in range(count - 1)
    ]
    links += [body(f"m{index}") for index in range(count)]
    joints += [turning(f"l{count - 1}", f"m{index}") for index in range(count)]
    lumped, found = lump(robot(links, joints))
    assert found == ()
    assert lumped.mass == 2 * count
    first = lumped.links[0]
    assert first.inertial is not None
    assert first.inertial.pose_in_link.xyz[0] == pytest.approx(0.001 * (count - 1) / 2)
    assert first.collisions[-1].pose_in_link.xyz[0] == pytest.approx(0.001 * (count - 1))
    assert {joint.parent for joint in lumped.joints} == {"l0"}


def test_the_robot_of_the_tutorial() -> None:
    model, _ = read_urdf(
        '<robot name="simple_robot"><link name="dummy"/>'
        '<joint name="j" type="fixed"><parent link="dummy"/><child link="base_link"/></joint>'
        '<link name="base_link"><collision><geometry><cylinder length="0.5" radius="0.4"/>'
        '</geometry></collision><inertial><mass value="1"/>'
        '<inertia ixx="100" ixy="0" ixz="0" iyy="100" iyz="0" izz="100"/></inertial></link>'
        '<gazebo reference="base_link"><mu1>0.2</mu1></gazebo></robot>',
        file=None,
    )
    assert model is not None
    lumped, found = lump(model)
    assert found == ()
    assert (lumped.root, lumped.mass, lumped.joints) == ("dummy", 1.0, ())
    assert lumped.links[0].collisions[0].surface.mu1 == 0.2


def test_the_mass_of_a_root_called_world_counts_for_nothing() -> None:
    """Gazebo makes no body of it."""
    body = Inertial(mass=1.0, inertia=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0))
    robot = Robot(
        name="r",
        root="world",
        links=(Link(name="world", inertial=body), Link(name="arm", inertial=body)),
        joints=(Joint(name="j", type=JointType.CONTINUOUS, parent="world", child="arm"),),
        fixed_to_world=True,
    )
    lumped, _ = lump(robot)
    assert lumped.mass == 1.0
