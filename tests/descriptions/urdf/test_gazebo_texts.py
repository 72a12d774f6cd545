"""Gazebo's own parser agrees with what the reader calls an error, and with what tags do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from gazebo_oracle import IGN, differences, is_taken, model_of
from urdf_texts import ERRORS, TWO, WARNINGS, joint, link, robot, shape
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = [
    pytest.mark.slow,
    pytest.mark.oracle,
    pytest.mark.skipif(
        IGN is None, reason="ign (Debian: ignition-tools, libsdformat12) is missing"
    ),
]

# Asked of `ign`, these would print without end.
ENDLESS = {"cycle", "cycle below a root"}
# Gazebo goes on and leaves something out, as the errors say.
CUT = {
    "four scales": "ends the link",
    "material without name": "ends the link",
    "missing moment": "ends the link, with moments of 0",
    "sdf": "it is no URDF, and good SDF",
    "no geometry": "ends the link",
    "unknown geometry": "ends the link",
    "capsule": "ends the link",
    "first element is no shape": "ends the link",
    "mesh without name": "ends the link",
    "zero radius": "Gazebo's physics engine ends on it",
    "negative box": "Gazebo's physics engine ends on it",
    "zero scale": "Gazebo's physics engine ends on it",
    "mirrored mesh": "Gazebo's physics engine ends on it",
    "left over in text": "nobody reads the text; it is surely not what was meant",
    "left over macro": "it is left out; it is surely not what was meant",
    "mimics itself": "sdformat 14 and later refuse it; the oracle knows no mimic joints",
}
# Warnings about what the oracle refuses.
REFUSED = {
    "joint named like a link": "sdformat 13 and later rename one",
    "preserved joint named like a link": "sdformat 13 and later rename one",
}


def written(text: str, folder: Path) -> Path:
    file = folder / "robot.urdf"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize("name", [name for name in ERRORS if name not in ENDLESS])
def test_errors_are_refused(name: str, tmp_path: Path) -> None:
    assert is_taken(written(ERRORS[name][1], tmp_path), tmp_path) == (name in CUT)


@pytest.mark.parametrize("name", WARNINGS)
def test_warnings_are_taken(name: str, tmp_path: Path) -> None:
    assert is_taken(written(WARNINGS[name][1], tmp_path), tmp_path) != (name in REFUSED)


BALL = '<sphere radius="1"/>'
TOUCH = shape("collision", BALL)
NAMED = shape("collision", BALL).replace("<collision", '<collision name="c"')
FLAGS = (
    "<turnGravityOff>1</turnGravityOff><selfCollide>yes</selfCollide>"
    "<dampingFactor>0.1</dampingFactor><maxContacts>3</maxContacts>"
)
OTHERS = (
    "<turnGravityOff>no</turnGravityOff><selfCollide>0</selfCollide>"
    "<dampingFactor>0.2</dampingFactor><maxContacts>5</maxContacts>"
)
COPIED = (
    "<gravity>0</gravity><self_collide>true</self_collide>"
    "<velocity_decay><linear>0.3</linear></velocity_decay>"
    "<collision><max_contacts>9</max_contacts><surface><friction><ode><mu>0.7</mu></ode></friction>"
    "<contact><ode><kp>5</kp><kd>6</kd><min_depth>0.001</min_depth></ode></contact></surface>"
    "</collision>"
)


def massive(name: str, body: str = "") -> str:
    return link(name).replace("</link>", body + "</link>")


def about(reference: str, body: str) -> str:
    return f'<gazebo reference="{reference}">{body}</gazebo>\n'


LUMPED = massive("base", TOUCH) + massive("lid", TOUCH + NAMED) + joint("j", "base", "lid")
FRICTION = "<mu1>0.2</mu1><mu2>0.3</mu2><kp>1e6</kp><kd>2</kd><minDepth>0.001</minDepth>"

TAGS = {
    "keys": massive("a", TOUCH) + about("a", FRICTION + FLAGS),
    "second word": massive("a", TOUCH) + about("a", FLAGS) + about("a", OTHERS),
    "twice in one": massive("a", TOUCH) + about("a", "<mu1>0.5</mu1><mu1>0.6</mu1>"),
    "copied": massive("a", TOUCH) + about("a", COPIED),
    "copied, then keys": massive("a", TOUCH) + about("a", COPIED) + about("a", FLAGS + FRICTION),
    "keys, then copied": massive("a", TOUCH) + about("a", FLAGS + FRICTION) + about("a", COPIED),
    "both in one": massive("a", TOUCH) + about("a", FLAGS + "<mu2>0.4</mu2>" + COPIED),
    "named collision": massive("a", NAMED + TOUCH) + about("a", FRICTION),
    "name that begins with the link's": massive("a", NAMED.replace('"c"', '"a_c"'))
    + about("a", FRICTION),
    "of a lumped link": LUMPED + about("lid", FRICTION + FLAGS),
    "of the parent": LUMPED + about("base", FRICTION + FLAGS),
    "of both": LUMPED + about("lid", FLAGS) + about("base", OTHERS + FRICTION),
    "lumped link called like the parent": massive("a", TOUCH)
    + massive("ab", TOUCH)
    + joint("j", "a", "ab")
    + about("ab", FRICTION)
    + about("a", "<mu1>0.9</mu1>"),
    "lumped twice": massive("a", TOUCH)
    + massive("b", TOUCH)
    + massive("c", TOUCH)
    + joint("z", "a", "b")
    + joint("y", "b", "c")
    + about("c", FRICTION + FLAGS)
    + about("b", "<mu1>0.4</mu1>" + OTHERS)
    + about("a", "<mu2>0.8</mu2>"),
    "siblings": massive("a", TOUCH)
    + massive("b", TOUCH)
    + massive("c", TOUCH)
    + joint("z", "a", "b")
    + joint("y", "a", "c")
    + about("b", FLAGS)
    + about("c", OTHERS),
    "whole robot": massive("a", TOUCH) + f"<gazebo>{FLAGS + FRICTION}<static>Yes</static></gazebo>",
    "static, and not": massive("a") + "<gazebo><static>1</static></gazebo>"
    "<gazebo reference=''><static>0</static></gazebo>",
    "self-collision of all": TWO
    + joint("j", "a", "b", kind="continuous")
    + "<gazebo><self_collide>1</self_collide></gazebo>"
    + about("b", "<selfCollide>0</selfCollide>"),
    "beginnings of numbers": massive("a", TOUCH)
    + about("a", "<mu1>0.2f</mu1><mu2>0x10</mu2><kp>1,5</kp><maxContacts>3.7</maxContacts>"),
    "attributes": massive("a", TOUCH) + about("a", '<mu1 value="0.2"/><mu2 value="1">2</mu2>'),
    "springs": TWO
    + joint("j", "a", "b", kind="continuous")
    + about("j", "<springStiffness>3</springStiffness><springReference>0.1</springReference>")
    + about(
        "j", "<springStiffness>4</springStiffness><implicitSpringDamper>1</implicitSpringDamper>"
    ),
    "preserved": LUMPED + about("j", "<preserveFixedJoint>Yes</preserveFixedJoint>"),
    "not preserved": LUMPED + about("j", "<preserveFixedJoint>on</preserveFixedJoint>"),
    "not lumped": LUMPED + about("j", "<disableFixedJointLumping>1</disableFixedJointLumping>"),
    "below the world": massive("world")
    + massive("b")
    + massive("c")
    + joint("j", "world", "b", '<origin xyz="1 0 0"/>')
    + joint("k", "b", "c", '<origin xyz="1 0 0"/>'),
    "limits exchanged": TWO
    + joint("j", "a", "b", '<limit lower="2" upper="-1" effort="-1" velocity="0"/>', "prismatic"),
    "continuous with limits": TWO
    + joint("j", "a", "b", '<limit lower="2" upper="-1" effort="3" velocity="4"/>', "continuous"),
    "long axis": TWO
    + joint("j", "a", "b", '<axis xyz="0 3 4"/><dynamics damping="-1"/>', "continuous"),
}


@pytest.mark.parametrize("name", TAGS)
def test_tags_do_what_they_do_in_gazebo(name: str, tmp_path: Path) -> None:
    text = robot(TAGS[name])
    model = model_of(written(text, tmp_path), tmp_path)
    ours, found = read_urdf(text, file=None)
    assert ours is not None
    assert model is not None
    lumped, dropped = lump(ours)
    assert list(differences(lumped, model)) == []
    assert not [one for one in (*found, *dropped) if one.severity.value == "error"]
