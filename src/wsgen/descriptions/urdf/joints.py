"""`<joint>` of a URDF.

Gazebo ignores <calibration> and <safety_controller>, but its parser refuses a robot whose numbers
in them are invalid; so it does with an invalid <limit> of a joint that needs none.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.descriptions.rules import NOT_A_NUMBER, SWAPPED_LIMITS, UNKNOWN_JOINT_TYPE, ZERO_AXIS
from wsgen.descriptions.urdf.links import read_origin
from wsgen.descriptions.urdf.unknown_elements import meant_element
from wsgen.descriptions.urdf.values import line_of, read_number, read_triple
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.robot import Joint, JointLimit, JointType, Mimic
from wsgen.model.transform import IDENTITY
from wsgen.text.suggestions import did_you_mean
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from wsgen.descriptions.urdf.values import Collector
    from wsgen.text.xmltree import Element


INCOMPLETE_JOINT = Rule(
    code="ROB014",
    name="incomplete-joint",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A joint has no parent or child, or its `<mimic>` does not name a joint.",
    why="`urdfdom` cannot build the tree of links and refuses the robot.",
    example='<joint name="arm_joint" type="fixed">\n  <child link="arm"/>\n</joint>',
    instead='<joint name="arm_joint" type="fixed">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="arm"/>\n'
    "</joint>",
)

UNNORMALIZED_AXIS = Rule(
    code="ROB019",
    name="unnormalized-axis",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The axis of a joint does not have length 1.",
    what="Deviations up to 0.001 are allowed: hand-written axes often have three digits.",
    why="Gazebo normalizes the axis; other programs scale the motion of the joint by its length.",
    example='<axis xyz="0 0 2"/>',
    instead='<axis xyz="0 0 1"/>',
)

MISSING_LIMIT = Rule(
    code="ROB020",
    name="missing-limit",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A revolute or prismatic joint has no `<limit>`.",
    why="`urdfdom` refuses the robot. The type of a joint without limits is `continuous`.",
    example='<joint name="arm_joint" type="revolute">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="arm"/>\n'
    "</joint>",
    instead='<joint name="arm_joint" type="revolute">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="arm"/>\n'
    '  <limit lower="-1" upper="1" effort="10" velocity="1"/>\n'
    "</joint>",
)

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


def read_joint(collector: Collector, element: Element, name: str) -> Joint | None:
    """A joint; None where it has no type, parent or child."""
    path = f"joint[@name='{name}']"
    kind = _read_type(collector, element, path)
    ends = {
        tag: next((child.get("link") or "" for child in children(element, tag)), "")
        for tag in ("parent", "child")
    }
    for tag, link in ends.items():
        if not link:
            end = next(children(element, tag), None)
            collector.report_missing(
                INCOMPLETE_JOINT,
                f"The joint `{name}` has no {tag} link.",
                hint=f'{"Add" if end is None else "Write"} <{tag} link="LINK"/>.',
                at=element if end is None else end,
                path=path,
                name=tag if end is None else "link",
            )
    if kind is None or not all(ends.values()):
        return None
    damping, friction = _read_dynamics(collector, element, path)
    _check_ignored(collector, element, path)
    return Joint(
        name=name,
        type=kind,
        parent=ends["parent"],
        child=ends["child"],
        pose_in_parent=read_origin(collector, element, path) or IDENTITY,
        axis_in_joint=_read_axis(collector, element, path)
        if kind in HAVE_AXIS
        else (1.0, 0.0, 0.0),
        limit=_read_limit(collector, element, path, kind),
        damping=damping,
        friction=friction,
        mimic=_read_mimic(collector, element, path),
        line=line_of(element),
    )


def _read_type(collector: Collector, element: Element, path: str) -> JointType | None:
    kind = element.get("type")
    types = [known.value for known in JointType if known is not JointType.BALL]
    if kind in types:
        return JointType(kind)
    near = None if kind is None else meant_element(kind, types)
    collector.report_missing(
        UNKNOWN_JOINT_TYPE,
        "The joint has no type." if kind is None else f"`{kind}` is not a joint type.",
        hint=did_you_mean(near) if near else f"Use one of {', '.join(types)}.",
        at=element,
        path=path,
        name="type" if kind is None else "",
    )
    return None


def _read_axis(collector: Collector, element: Element, path: str) -> tuple[float, float, float]:
    for axis in children(element, "axis"):
        xyz = read_triple(collector, axis, "xyz", f"{path}/axis")
        if xyz is None and "xyz" in axis.attrib:
            break
        length = math.hypot(*xyz) if xyz is not None else 0.0
        if xyz is None or length == 0:
            collector.report_missing(
                ZERO_AXIS,
                "The axis has length 0.",
                hint='Write the direction of rotation or motion, for example xyz="0 0 1".',
                at=axis,
                path=f"{path}/axis",
                name="" if "xyz" in axis.attrib else "xyz",
            )
            break
        if abs(length - 1) > UNIT_TOLERANCE:
            collector.report(
                UNNORMALIZED_AXIS,
                f"The axis has length {length:.4g}, not 1.",
                hint="Divide it by its length: some programs scale the motion of the joint by it.",
                at=axis,
                path=f"{path}/axis",
            )
        return (xyz[0] / length, xyz[1] / length, xyz[2] / length)
    return (1.0, 0.0, 0.0)


def _read_limit(
    collector: Collector, element: Element, path: str, kind: JointType
) -> JointLimit | None:
    path = f"{path}/limit"
    for limit in children(element, "limit"):
        lower, upper, effort, velocity = (
            read_number(collector, limit, name, path, required=name in {"effort", "velocity"})
            or 0.0
            for name in ("lower", "upper", "effort", "velocity")
        )
        if kind in NEED_LIMITS and lower > upper:
            collector.report(
                SWAPPED_LIMITS,
                f"The lower limit {lower:g} is above the upper limit {upper:g}.",
                hint="Swap them. Gazebo swaps them, too; other programs ignore such limits.",
                at=limit,
                path=path,
            )
            lower, upper = upper, lower
        return JointLimit(
            lower=lower, upper=upper, effort=effort, velocity=velocity, line=line_of(limit)
        )
    if kind in NEED_LIMITS:
        collector.report_missing(
            MISSING_LIMIT,
            f"A {kind.value} joint must have a <limit>.",
            hint='Add <limit lower="-1" upper="1" effort="10" velocity="1"/> (rad or m, N m or N)'
            + (", or make the joint continuous." if kind is JointType.REVOLUTE else "."),
            at=element,
            path=path,
            name="limit",
        )
    return None


def _read_dynamics(collector: Collector, element: Element, path: str) -> tuple[float, float]:
    path = f"{path}/dynamics"
    for dynamics in children(element, "dynamics"):
        if not {"damping", "friction"} & set(dynamics.attrib):
            collector.report(
                NOT_A_NUMBER,
                "<dynamics> has neither `damping` nor `friction`, and Gazebo refuses the robot.",
                hint='Write <dynamics damping="0.1"/> (N m s/rad or N s/m), or remove it.',
                at=dynamics,
                path=path,
            )
        damping, friction = (
            read_number(collector, dynamics, name, path, required=False) or 0.0
            for name in ("damping", "friction")
        )
        return damping, friction
    return 0.0, 0.0


def _read_mimic(collector: Collector, element: Element, path: str) -> Mimic | None:
    path = f"{path}/mimic"
    for mimic in children(element, "mimic"):
        if mimic.get("joint") is None:
            collector.report_missing(
                INCOMPLETE_JOINT,
                "<mimic> does not name a joint.",
                hint='Write <mimic joint="JOINT"/>.',
                at=mimic,
                path=path,
                name="joint",
            )
            return None
        multiplier = read_number(collector, mimic, "multiplier", path, required=False)
        return Mimic(
            joint=mimic.get("joint") or "",
            multiplier=1.0 if multiplier is None else multiplier,
            offset=read_number(collector, mimic, "offset", path, required=False) or 0.0,
            line=line_of(mimic),
        )
    return None


def _check_ignored(collector: Collector, element: Element, path: str) -> None:
    for tag, attributes in IGNORED.items():
        for ignored in children(element, tag):
            for attribute, required in attributes.items():
                read_number(collector, ignored, attribute, f"{path}/{tag}", required=required)
            break
