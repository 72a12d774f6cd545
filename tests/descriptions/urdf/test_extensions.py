"""What `<gazebo>` elements do; `test_gazebo_texts` compares more of it with Gazebo's parser."""

from __future__ import annotations

import pytest

from urdf_texts import MASS, SPHERE, joint, link, robot, shape
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import Paint, Robot, Surface

TOUCH = shape("collision", SPHERE)
SEEN = shape("visual", SPHERE)
NAMED = TOUCH.replace("<collision", '<collision name="tyre"')


def about(reference: str, body: str) -> str:
    return f'<gazebo reference="{reference}">{body}</gazebo>\n'


COPIED_DIRECTION = (
    "<collision><surface><friction><ode><fdir1 {}>{}</fdir1></ode></friction></surface></collision>"
)


def lumped(text: str) -> tuple[Robot, tuple[Diagnostic, ...]]:
    written, found = read_urdf(robot(text), file=None)
    assert written is not None
    assert not [one for one in found if one.severity is Severity.ERROR]
    return lump(written)


def test_surface_and_flags() -> None:
    made, found = lumped(
        link("a", MASS + TOUCH)
        + about(
            "a",
            "<mu1>0.2</mu1><mu2>0.3</mu2><kp>1e6</kp><kd>2</kd><minDepth>0.001</minDepth>"
            "<maxContacts>4</maxContacts><selfCollide>True</selfCollide>"
            "<turnGravityOff>true</turnGravityOff><dampingFactor>0.1</dampingFactor>",
        )
        + "<gazebo><static>yes</static></gazebo>"
    )
    assert found == ()
    (a,) = made.links
    assert a.collisions[0].surface == Surface(
        mu1=0.2, mu2=0.3, kp=1e6, kd=2, min_depth=0.001, max_contacts=4
    )
    assert (a.self_collide, a.gravity, a.velocity_decay) == (True, False, (0.1, 0.1))
    assert made.is_static


def test_laser_retro_is_for_collisions_and_what_is_copied_for_its_element() -> None:
    seen = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    made, found = lumped(
        link("a", MASS + TOUCH + seen) + about("a", "<laserRetro>200</laserRetro>")
    )
    assert found == ()
    (a,) = made.links
    assert (a.collisions[0].laser_retro, a.visuals[0].laser_retro) == (200.0, 0.0)
    copied = "<{0}><laser_retro>{1}</laser_retro></{0}>"
    made, _ = lumped(
        link("a", MASS + TOUCH + seen)
        + about("a", copied.format("collision", 3) + copied.format("visual", 4))
    )
    (a,) = made.links
    assert (a.collisions[0].laser_retro, a.visuals[0].laser_retro) == (3.0, 4.0)


@pytest.mark.parametrize("text", ["inf", "nan", "-nan"])
def test_what_no_engine_could_use_is_left_out(text: str) -> None:
    made, _ = lumped(
        link("a", MASS + TOUCH)
        + about("a", f"<mu1>{text}</mu1><kp>{text}</kp><dampingFactor>{text}</dampingFactor>")
    )
    (a,) = made.links
    assert (a.collisions[0].surface, a.velocity_decay) == (Surface(), (0.0, 0.0))


def test_a_name_of_its_own_keeps_the_values_from_a_collision() -> None:
    made, found = lumped(link("wheel", MASS + NAMED) + about("wheel", "<mu1>0.2</mu1>"))
    assert made.links[0].collisions[0].surface == Surface()
    (only,) = found
    assert (only.code, only.severity) == ("ROB046", Severity.WARNING)
    assert "<mu1>" in only.message
    assert only.line
    assert "`name`" in (only.hint or "")


def test_one_collision_that_gets_the_values_is_enough() -> None:
    _, found = lumped(link("wheel", MASS + NAMED + TOUCH) + about("wheel", "<mu1>0.2</mu1>"))
    assert found == ()


def test_a_lumped_link_that_is_called_like_its_parent() -> None:
    made, found = lumped(
        link("arm", MASS)
        + link("arm_tip", MASS + TOUCH)
        + joint("j", "arm", "arm_tip")
        + about("arm_tip", "<mu1>0.2</mu1>")
    )
    assert made.links[0].collisions[0].surface == Surface()
    (only,) = found
    assert only.code == "ROB046"
    assert "lumped into `arm`" in only.message


def test_a_link_without_collisions_is_not_reported() -> None:
    assert lumped(link("a") + about("a", "<mu1>0.2</mu1>"))[1] == ()


def test_colors() -> None:
    made, _ = lumped(
        link("a", MASS + SEEN)
        + link("b", MASS + SEEN)
        + link("c", MASS + SEEN.replace("<visual", '<visual name="v"'))
        + joint("j", "a", "b", kind="continuous")
        + joint("k", "a", "c", kind="continuous")
        + about("a", "<material>Gazebo/Green</material>")
        + about("b", "<visual><material><diffuse>1 0 0.5</diffuse></material></visual>")
        + about("c", "<material>Gazebo/Green</material>")
    )
    assert [one.visuals[0].rgba for one in made.links] == [(0, 1, 0, 1), (1, 0, 0.5, 1), None]


def test_springs() -> None:
    made, _ = lumped(
        link("a")
        + link("b")
        + joint("j", "a", "b", kind="continuous")
        + about("j", "<springStiffness>3</springStiffness><springReference>0.1</springReference>")
        + about("j", "<springStiffness>4</springStiffness>")
    )
    (only,) = made.joints
    assert (only.spring_stiffness, only.spring_reference) == (4.0, 0.1)


@pytest.mark.parametrize(
    ("written", "direction", "inside"),
    [
        ("<fdir1 gz:expressed_in='b'>1 -1 0</fdir1>", (1.0, -1.0, 0.0), None),  # sdformat drops it
        (COPIED_DIRECTION.format("gz:expressed_in='b'", "1 -1 0"), (1.0, -1.0, 0.0), "b"),
        (COPIED_DIRECTION.format("ignition:expressed_in='b'", "0 2 0"), (0.0, 2.0, 0.0), "b"),
        (COPIED_DIRECTION.format("", "0 2 0"), (0.0, 2.0, 0.0), None),
        (COPIED_DIRECTION.format("gz:expressed_in='b'", "0 0 0"), None, None),
        ("<fdir1>1 0</fdir1>", None, None),
        ("<fdir1>1 0 inf</fdir1>", None, None),
    ],
)
def test_the_direction_of_friction(
    written: str, direction: tuple[float, float, float] | None, inside: str | None
) -> None:
    made, _ = lumped(link("a", MASS + TOUCH) + about("a", written))
    (surface,) = (collision.surface for collision in made.links[0].collisions)
    assert (surface.fdir1, surface.fdir1_in) == (direction, inside)


def test_colors_of_a_name_and_those_that_are_copied() -> None:
    seen = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    copied = "<visual><material><emissive>0 0 1</emissive></material></visual>"

    def paint(text: str) -> Paint | None:
        return lumped(link("a", MASS + seen) + about("a", text))[0].links[0].visuals[0].paint

    grey, red = (0.7, 0.7, 0.7, 1.0), (1.0, 0.0, 0.0, 1.0)
    assert paint("<material>Gazebo/Red</material>") is None
    assert paint("<material>Gazebo/Grey</material>") == Paint((0.3, 0.3, 0.3, 1.0), grey)
    both = paint("<material>Gazebo/Red</material>" + copied)
    assert both == Paint(red, red, (0.0, 0.0, 1.0, 1.0))
