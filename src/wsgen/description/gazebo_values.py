"""What is wrong with single values in `<gazebo>` elements, as Gazebo's parser sees them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.description.numbers import LEFT_OVER, NUMBER, leading_float, leading_integer
from wsgen.model.colours import GAZEBO_COLOURS
from wsgen.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

SURFACE_KEYS = ("mu1", "mu2", "kp", "kd", "minDepth", "maxContacts")
LUMPING_KEYS = ("preserveFixedJoint", "disableFixedJointLumping")
LINK_KEYS = frozenset(
    (
        *SURFACE_KEYS,
        *("maxVel", "fdir1", "laserRetro", "material"),
        *("dampingFactor", "selfCollide", "turnGravityOff"),
    )
)
JOINT_KEYS = frozenset(
    (
        *LUMPING_KEYS,
        *("springReference", "springStiffness", "stopCfm", "stopErp", "fudgeFactor"),
        *("provideFeedback", "implicitSpringDamper", "cfmDamping"),
    )
)
# Keys that std::stod reads, and numbers in copied SDF, which the SDF parser reads the same way.
NUMERIC = frozenset(
    (
        *("mu1", "mu2", "kp", "kd", "minDepth", "maxVel", "dampingFactor", "laserRetro"),
        *("springReference", "springStiffness", "stopCfm", "stopErp", "fudgeFactor"),
    )
)
SDF_NUMERIC = frozenset(
    (
        *("velocity_decay/linear", "velocity_decay/angular", "collision/max_contacts"),
        *(f"collision/surface/friction/ode/{key}" for key in ("mu", "mu2")),
        *(f"collision/surface/contact/ode/{key}" for key in ("kp", "kd", "min_depth")),
    )
)
NOT_NEGATIVE = frozenset(
    (
        *("mu1", "mu2"),
        *("collision/surface/friction/ode/mu", "collision/surface/friction/ode/mu2"),
    )
)
SDF_BOOLEAN = frozenset(("gravity", "self_collide"))
TRUTHS = frozenset(("true", "1"))
FALSEHOODS = frozenset(("false", "0"))


def check_value(  # noqa: PLR0913  what, where, and whether it counts
    findings: Findings, element: Element, path: str, key: str, text: str, *, is_known: bool
) -> None:
    """Report a value that ends Gazebo, that it refuses, or that is surely not what was meant.

    `is_known`: the reference is there; otherwise only the keys that sdformat reads at once matter.
    """
    if LEFT_OVER.search(text):  # reported once, for every element
        return
    is_copied_number = key in SDF_NUMERIC and is_known and bool(text)
    if key in NUMERIC or key == "maxContacts" or is_copied_number:
        _check_number(findings, element, path, key, text)
    elif key in SDF_BOOLEAN and is_known and text:
        if text.lower() not in TRUTHS | FALSEHOODS:
            findings.error(
                "ROB045",
                f"<{key}>: `{text[:60]}` is neither true nor false: Gazebo refuses the robot.",
                hint="Write true or false.",
                at=element,
                path=path,
            )
    elif key == "material" and text.startswith("Gazebo/") and text not in GAZEBO_COLOURS:
        near = nearest(text, GAZEBO_COLOURS)
        findings.warning(
            "ROB032",
            f"Gazebo has no material `{text}`.",
            hint=did_you_mean(near) if near else "Take Gazebo/Grey, Gazebo/Red, …",
            at=element,
            path=path,
        )


def check_placement(
    findings: Findings, element: Element, path: str, *, is_link: bool, is_joint: bool
) -> None:
    """Report a key that does nothing at what the `<gazebo>` element is about."""
    key = str(element.tag)
    right_place = None
    if key in JOINT_KEYS and not is_joint:
        right_place = "a joint"
    elif key in LINK_KEYS and not is_link:
        right_place = "a link"
    elif key == "static" and (is_link or is_joint):
        right_place = "the whole robot"
    if right_place is None:
        return
    hint = 'Put it into <gazebo reference="NAME"> with the name of ' + right_place + "."
    if key in LUMPING_KEYS:
        hint = 'Put it into <gazebo reference="JOINT"> with the name of the fixed joint.'
    elif key == "static":
        hint = "Put it into a <gazebo> without reference."
    elif key == "selfCollide" and not is_joint:
        hint = "For all links write <self_collide>true</self_collide>, which Gazebo copies."
    findings.warning(
        "ROB033",
        f"<{key}> belongs to {right_place}: here it does nothing.",
        hint=hint,
        at=element,
        path=path,
    )


def _check_number(findings: Findings, element: Element, path: str, key: str, text: str) -> None:
    number = leading_integer(text) if key == "maxContacts" else leading_float(text)
    told = f"<{key.rpartition('/')[2]}>: `{text[:60]}`"
    if number is None:
        findings.error(
            "ROB031",
            f"{told} is not a number that Gazebo reads.",
            hint="Write one number with a point. Gazebo "
            + ("refuses the robot for" if "/" in key else "ends with an exception on")
            + " this.",
            at=element,
            path=path,
        )
    elif key in NOT_NEGATIVE and number < 0:
        findings.error(
            "ROB031",
            f"{told} is less than 0, and Gazebo refuses the robot.",
            hint="A coefficient of friction is 0 or greater.",
            at=element,
            path=path,
        )
    elif not math.isfinite(number):
        findings.warning(
            "ROB031",
            f"{told} is not finite: wsgen goes on as if it were not there.",
            hint="Write a finite number; physics engines compute nonsense with others.",
            at=element,
            path=path,
        )
    elif not NUMBER.fullmatch(text) or (key == "maxContacts" and float(text) != number):
        findings.warning(
            "ROB031",
            f"{told} is not one number: Gazebo reads the beginning, {number:g}.",
            hint=f"Write {number:g} if that is meant.",
            at=element,
            path=path,
        )
