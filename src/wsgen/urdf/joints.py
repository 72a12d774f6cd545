"""`<joint>` of a URDF.

Gazebo ignores <calibration> and <safety_controller>, but its parser refuses a robot for what is
wrong in them, and for a wrong <limit> also where the joint needs none.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.model.robot import Joint, JointLimit, JointType, Mimic
from wsgen.model.transform import IDENTITY
from wsgen.suggestions import did_you_mean
from wsgen.urdf.collector import line_of
from wsgen.urdf.links import read_origin
from wsgen.urdf.unknown_elements import meant_element
from wsgen.urdf.values import read_number, read_triple
from wsgen.xmltree import children

if TYPE_CHECKING:
    from wsgen.urdf.collector import Findings
    from wsgen.xmltree import Element


NEED_LIMITS = (JointType.REVOLUTE, JointType.PRISMATIC)
HAVE_AXIS = (JointType.REVOLUTE, JointType.PRISMATIC, JointType.CONTINUOUS, JointType.PLANAR)
# The numbers in what Gazebo ignores, and whether they must be there.
IGNORED = {
    "calibration": {"rising": False, "falling": False},
    "safety_controller": {
        "soft_lower_limit": False,
        "soft_upper_limit": False,
        "k_position": False,
        "k_velocity": True,
    },
}
UNIT_TOLERANCE = 1e-3  # of the length of an axis; hand-written axes have three digits


def read_joint(findings: Findings, element: Element, name: str) -> Joint | None:
    """A joint; None where it does not say what it joins, or how."""
    path = f"joint[@name='{name}']"
    kind = _read_type(findings, element, path)
    ends = {
        tag: next((child.get("link") or "" for child in children(element, tag)), "")
        for tag in ("parent", "child")
    }
    for tag, link in ends.items():
        if not link:
            end = next(children(element, tag), None)
            findings.missing(
                "ROB014",
                f"The joint `{name}` has no {tag} link.",
                hint=f'Add <{tag} link="LINK"/>.',
                at=element if end is None else end,
                path=path,
                name=tag if end is None else "link",
            )
    if kind is None or not all(ends.values()):
        return None
    damping, friction = _read_dynamics(findings, element, path)
    _check_ignored(findings, element, path)
    return Joint(
        name=name,
        type=kind,
        parent=ends["parent"],
        child=ends["child"],
        pose_in_parent=read_origin(findings, element, path) or IDENTITY,
        axis_in_joint=_read_axis(findings, element, path) if kind in HAVE_AXIS else (1.0, 0.0, 0.0),
        limit=_read_limit(findings, element, path, kind),
        damping=damping,
        friction=friction,
        mimic=_read_mimic(findings, element, path),
        line=line_of(element),
    )


def _read_type(findings: Findings, element: Element, path: str) -> JointType | None:
    kind = element.get("type")
    if kind in {known.value for known in JointType}:
        return JointType(kind)
    types = [known.value for known in JointType]
    near = None if kind is None else meant_element(kind, types)
    findings.missing(
        "ROB015",
        "The joint has no type." if kind is None else f"`{kind}` is not a joint type.",
        hint=did_you_mean(near) if near else f"One of {', '.join(types)}.",
        at=element,
        path=path,
        name="type" if kind is None else "",
    )
    return None


def _read_axis(findings: Findings, element: Element, path: str) -> tuple[float, float, float]:
    for axis in children(element, "axis"):
        xyz = read_triple(findings, axis, "xyz", f"{path}/axis")
        if xyz is None and "xyz" in axis.attrib:
            break
        length = math.hypot(*xyz) if xyz is not None else 0.0
        if xyz is None or length == 0:
            findings.missing(
                "ROB018",
                "The axis has no direction (0 0 0).",
                hint='Name the axis that the joint moves about or along, as xyz="0 0 1".',
                at=axis,
                path=f"{path}/axis",
                name="" if "xyz" in axis.attrib else "xyz",
            )
            break
        if abs(length - 1) > UNIT_TOLERANCE:
            findings.warning(
                "ROB019",
                f"The axis has length {length:.4g}, not 1.",
                hint="Divide it by its length: some programs scale the joint's motion with it.",
                at=axis,
                path=f"{path}/axis",
            )
        return (xyz[0] / length, xyz[1] / length, xyz[2] / length)
    return (1.0, 0.0, 0.0)


def _read_limit(
    findings: Findings, element: Element, path: str, kind: JointType
) -> JointLimit | None:
    path = f"{path}/limit"
    for limit in children(element, "limit"):
        lower, upper, effort, velocity = (
            read_number(findings, limit, name, path, required=name in {"effort", "velocity"}) or 0.0
            for name in ("lower", "upper", "effort", "velocity")
        )
        if kind in NEED_LIMITS and lower > upper:
            findings.warning(
                "ROB023",
                f"The lower limit {lower:g} is above the upper limit {upper:g}.",
                hint="Exchange them; Gazebo does so, other programs take the joint for a free one.",
                at=limit,
                path=path,
            )
            lower, upper = upper, lower
        return JointLimit(lower=lower, upper=upper, effort=effort, velocity=velocity)
    if kind in NEED_LIMITS:
        findings.missing(
            "ROB020",
            f"A {kind.value} joint needs <limit>.",
            hint='Add <limit lower="-1" upper="1" effort="10" velocity="1"/> (rad or m, N m or N)'
            + (", or make the joint continuous." if kind is JointType.REVOLUTE else "."),
            at=element,
            path=path,
            name="limit",
        )
    return None


def _read_dynamics(findings: Findings, element: Element, path: str) -> tuple[float, float]:
    path = f"{path}/dynamics"
    for dynamics in children(element, "dynamics"):
        if not {"damping", "friction"} & set(dynamics.attrib):
            findings.error(
                "ROB016",
                "<dynamics> has neither `damping` nor `friction`, and Gazebo refuses the robot.",
                hint='Write <dynamics damping="0.1"/> (N m s/rad or N s/m), or remove it.',
                at=dynamics,
                path=path,
            )
        damping, friction = (
            read_number(findings, dynamics, name, path, required=False) or 0.0
            for name in ("damping", "friction")
        )
        return damping, friction
    return 0.0, 0.0


def _read_mimic(findings: Findings, element: Element, path: str) -> Mimic | None:
    path = f"{path}/mimic"
    for mimic in children(element, "mimic"):
        if mimic.get("joint") is None:
            findings.missing(
                "ROB014",
                "<mimic> names no joint.",
                hint='Write <mimic joint="JOINT"/>.',
                at=mimic,
                path=path,
                name="joint",
            )
            return None
        multiplier = read_number(findings, mimic, "multiplier", path, required=False)
        return Mimic(
            joint=mimic.get("joint") or "",
            multiplier=1.0 if multiplier is None else multiplier,
            offset=read_number(findings, mimic, "offset", path, required=False) or 0.0,
        )
    return None


def _check_ignored(findings: Findings, element: Element, path: str) -> None:
    for tag, attributes in IGNORED.items():
        for ignored in children(element, tag):
            for attribute, required in attributes.items():
                read_number(findings, ignored, attribute, f"{path}/{tag}", required=required)
            break
