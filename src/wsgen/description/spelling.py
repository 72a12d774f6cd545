"""Elements of a URDF whose names are surely misspelt: programs leave them out without a word."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

SHAPED = ("origin", "geometry", "material")
# What urdfdom and sdformat look for in an element. Others are allowed, and many tools have some.
KNOWN = {
    "robot": ("link", "joint", "material", "gazebo", "transmission", "ros2_control"),
    "link": ("visual", "collision", "inertial"),
    "joint": (
        "origin",
        "parent",
        "child",
        "axis",
        "limit",
        "dynamics",
        "mimic",
        "calibration",
        "safety_controller",
    ),
    "visual": SHAPED,
    "collision": SHAPED,
    "inertial": ("origin", "mass", "inertia"),
    "material": ("color", "texture"),
    # With a reference and without; `collision` and `link` are there for who writes SDF in them.
    "gazebo": (
        *("material", "static", "turnGravityOff", "gravity", "dampingFactor", "maxVel"),
        *("minDepth", "mu1", "mu2", "fdir1", "kp", "kd", "selfCollide", "self_collide"),
        *("maxContacts", "laserRetro", "springReference", "springStiffness", "stopCfm", "stopErp"),
        *("fudgeFactor", "provideFeedback", "implicitSpringDamper", "preserveFixedJoint"),
        *("disableFixedJointLumping", "sensor", "plugin", "visual", "collision", "link", "joint"),
        *("initial_joint_position", "velocity_decay", "kinematic", "enable_wind", "light"),
    ),
}
# So alike two words are, as difflib counts, that one is taken for the other: `parnt` and `parent`
# are at 0.91, `visuals` and `visual` at 0.92, `colour` and `color` at 0.91.
ALIKE = 0.8

MOST_COMPARED = 500  # names; difflib takes its time
MOST_HINTS = 50  # findings; who has more has another trouble than spelling


def nearest(findings: Findings, name: str, known: Iterable[str]) -> str | None:
    """A known name that is nearly the same; None where there is none, or it would take too long."""
    if len(findings.diagnostics) > MOST_HINTS:
        return None
    alike = sorted(other for other in known if abs(len(other) - len(name)) <= len(name) // 3)
    near = get_close_matches(name, alike[:MOST_COMPARED], n=1)
    return near[0] if near else None


def check_spelling(findings: Findings, element: Element, path: str) -> None:
    """Report, in the element and below it, children that are nearly called as known ones."""
    known = KNOWN.get(str(element.tag))
    if known is None:
        return
    if element.tag == "gazebo":
        _check_reference(findings, element, path)
    for child in element:
        if not isinstance(child.tag, str):
            continue
        name = child.get("name")
        inside = child.tag if name is None else f"{child.tag}[@name='{name}']"
        if element.tag != "robot":
            inside = f"{path}/{child.tag}"
        if child.tag in known:
            check_spelling(findings, child, inside)
            continue
        near = [other for other in known if other.lower() == child.tag.lower()]
        near = near or get_close_matches(child.tag, known, n=1, cutoff=ALIKE)
        if near:
            findings.warning(
                "ROB038",
                f"<{element.tag}> has no <{child.tag}>: Gazebo leaves it out without a word.",
                hint=f"Did you mean <{near[0]}>?",
                at=child,
                path=inside,
            )


def _check_reference(findings: Findings, element: Element, path: str) -> None:
    """Report what should be called `reference`: without it the element is about the whole robot."""
    for attribute in map(str, element.attrib):
        if attribute != "reference" and "reference".startswith(attribute.lower()[:3]):
            findings.warning(
                "ROB038",
                f"<gazebo> has no attribute `{attribute}`: Gazebo leaves it out without a word and "
                "takes the element for the whole robot's.",
                hint="Did you mean `reference`?",
                at=element,
                path=path,
            )
