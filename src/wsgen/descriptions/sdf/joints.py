"""`<joint>` of SDF: the links that it connects, and how they move."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.descriptions.rules import (
    SELF_JOINT,
    SWAPPED_LIMITS,
    UNKNOWN_JOINT_TYPE,
    UNKNOWN_LINK,
    ZERO_AXIS,
)
from wsgen.descriptions.sdf.frames import MODEL_FRAME, WORLD, frame_called, link_of
from wsgen.descriptions.sdf.source import MODEL_FRAME_AXES, POSE_FRAMES, line_of
from wsgen.descriptions.sdf.values import TRUTH, first, number, triple, word
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.robot import STOP, Joint, JointLimit, JointType, Mimic
from wsgen.model.transform import UNIT, multiply, rotate, rotation_of_rpy, transpose
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from wsgen.descriptions.sdf.frames import Node, Poses
    from wsgen.descriptions.sdf.source import Source
    from wsgen.model.transform import Matrix, Pose, Vector
    from wsgen.text.xmltree import Element


MISSING_JOINT_END = Rule(
    code="WLD021",
    name="missing-joint-end",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A joint of an SDF model has no `<parent>` or no `<child>`.",
    why="Gazebo refuses the model: a joint connects two links, or a link and the world.",
    example='<joint name="arm_joint" type="revolute">\n  <child>arm</child>\n</joint>',
    instead='<joint name="arm_joint" type="revolute">\n'
    "  <parent>base_link</parent>\n"
    "  <child>arm</child>\n"
    "</joint>",
)

TWO_AXES = ("universal", "revolute2")  # two revolute joints, one after the other
TYPES = {
    **{
        kind.value: kind for kind in JointType if kind not in {JointType.PLANAR, JointType.FLOATING}
    },
    **dict.fromkeys(TWO_AXES, JointType.REVOLUTE),
}
LEFT_OUT = ("screw", "gearbox")
HAVE_AXIS = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
UNBOUNDED = 1e16  # rad, m, N or N m: so SDF writes that there is no limit
DEFAULT_AXIS = (0.0, 0.0, 1.0)


class Edge(NamedTuple):
    """A joint and the links that it connects."""

    node: Node
    type: JointType | None  # None: one that wsgen leaves out
    parent: Node | None  # None: the world
    child: Node

    @property
    def has_two_axes(self) -> bool:
        """Whether it is two revolute joints, with nothing between them."""
        return self.node.element.get("type") in TWO_AXES


def read_edge(node: Node) -> Edge | None:
    """The links that a joint connects; None, with a diagnostic, if that is not known."""
    source, element = node.source, node.element
    kind = element.get("type") or ""
    child = _end(node, "child")
    parent = None if word(element, "parent") == WORLD else _end(node, "parent")
    if kind not in TYPES and kind not in LEFT_OUT:
        source.report(
            UNKNOWN_JOINT_TYPE,
            f"`{kind}` is not a joint type." if kind else f"The joint `{node.name}` has no type.",
            at=element,
            hint=f"Use one of {', '.join((*TYPES, *LEFT_OUT))}.",
        )
        return None
    if child is None or (parent is None and word(element, "parent") != WORLD):
        return None
    if parent is child:
        source.report(
            SELF_JOINT,
            f"The joint `{node.name}` connects the link `{child.name}` to itself.",
            at=element,
            hint="Name two different links as parent and child.",
        )
        return None
    return Edge(node, TYPES.get(kind), parent, child)


def _end(node: Node, tag: str) -> Node | None:
    """The link at an end of a joint; None, with a diagnostic, if it does not exist."""
    name = word(node.element, tag)
    if name == MODEL_FRAME and node.scope.node is not None:
        return link_of(node.scope.node)
    found = node.scope.lookup(name) if name else None
    link = None if found is None else link_of(found)
    if link is None and not (name and found is None and node.scope.may_have(name)):
        near = nearest(name, node.scope.nodes) if name else None
        node.source.report(
            UNKNOWN_LINK if name else MISSING_JOINT_END,
            f"The {tag} of the joint `{node.name}` is `{name}`, which is not a link."
            if name
            else f"The joint `{node.name}` has no {tag} link.",
            at=node.element,
            hint=did_you_mean(near) if near else f"Add <{tag}>LINK</{tag}>.",
        )
    return link


def read_joint(
    edge: Edge, names: tuple[str, str, str], pose_in_parent: Pose, poses: Poses, tag: str = "axis"
) -> Joint:
    """The joint with its own name, that of its parent and that of its child.

    `poses` are those in the outermost model; `tag` is the element of the axis that is read.
    Mimicked joints have to be looked up afterwards.
    """
    node, kind = edge.node, edge.type or JointType.FIXED
    source, element = node.source, node.element
    # Gazebo reads no axis, limit or damping of a ball joint.
    axis = first(element, tag) if kind in HAVE_AXIS else None
    limit = None
    if axis is not None:
        limit = _limit(source, axis)
        is_free = limit.lower <= -UNBOUNDED and limit.upper >= UNBOUNDED
        if kind is JointType.REVOLUTE and is_free:
            kind = JointType.CONTINUOUS
        if is_free or kind is JointType.CONTINUOUS:
            has_strength = min(limit.effort, limit.velocity) < UNBOUNDED
            limit = replace(limit, lower=0.0, upper=0.0) if has_strength else None
    elif kind is JointType.REVOLUTE:
        kind = JointType.CONTINUOUS
    dynamics: dict[str, Any] = {
        name: 0.0 if axis is None else number(source, axis, "dynamics", name, default=0.0)
        for name in ("damping", "friction", "spring_stiffness", "spring_reference")
    }
    place = ("physics", "ode", "limit")
    stop = (
        number(source, element, *place, "erp", default=STOP[0]),
        number(source, element, *place, "cfm", default=STOP[1]),
    )
    return Joint(
        name=names[0],
        type=kind,
        parent=names[1],
        child=names[2],
        pose_in_parent=pose_in_parent,
        axis_in_joint=DEFAULT_AXIS if axis is None else _axis(node, axis, poses),
        limit=limit,
        stop=None if stop == STOP else stop,
        mimic=None if axis is None else _mimic(source, axis),
        line=line_of(element),
        **dynamics,
    )


def _axis(node: Node, axis: Element, poses: Poses) -> Vector:
    """The direction of the axis, of length 1, seen from the joint."""
    source = node.source
    xyz = triple(source, axis, "xyz", default=DEFAULT_AXIS)
    length = math.hypot(*xyz)
    if length == 0 or not math.isfinite(length):
        source.report(
            ZERO_AXIS,
            f"The axis of the joint `{node.name}` has length 0.",
            at=axis,
            hint="Write the direction of rotation or motion, for example <xyz>0 0 1</xyz>.",
        )
        return DEFAULT_AXIS
    unit = (xyz[0] / length, xyz[1] / length, xyz[2] / length)
    rotation = _rotation_of_axis_frame(node, axis, poses)
    if rotation is None:
        return unit
    joint = rotation_of_rpy(poses[node].rpy)
    return rotate(multiply(transpose(joint), rotation), unit)


def _rotation_of_axis_frame(node: Node, axis: Element, poses: Poses) -> Matrix | None:
    """The rotation of the axis' frame in the outermost model; None: that of the joint."""
    source = node.source
    xyz = first(axis, "xyz")
    name = "" if xyz is None else xyz.get("expressed_in") or ""
    if not name and source.version < POSE_FRAMES:
        default = "true" if source.version <= MODEL_FRAME_AXES else "false"
        in_model = word(axis, "use_parent_model_frame") or default
        name = MODEL_FRAME if TRUTH.get(in_model.lower(), False) else ""
    if not name:
        return None
    frame = frame_called(node, name, "`expressed_in`")
    if frame is None:
        frame = node.scope.node
    return UNIT if frame is None else rotation_of_rpy(poses[frame].rpy)


def _limit(source: Source, axis: Element) -> JointLimit:
    lower = _bound(source, axis, "lower", -UNBOUNDED)
    upper = _bound(source, axis, "upper", UNBOUNDED)
    effort = _bound(source, axis, "effort", -1.0)
    velocity = _bound(source, axis, "velocity", -1.0)
    if lower > upper:
        source.report(
            SWAPPED_LIMITS,
            f"The lower limit {lower:g} is above the upper limit {upper:g}.",
            at=axis,
            hint="Swap them; the simulation swaps them, too.",
        )
        lower, upper = upper, lower
    return JointLimit(
        lower=lower,
        upper=upper,
        effort=UNBOUNDED if effort < 0 else effort,
        velocity=UNBOUNDED if velocity < 0 else velocity,
    )


def _bound(source: Source, axis: Element, tag: str, default: float) -> float:
    """A limit, which may be infinite."""
    text = word(axis, "limit", tag).lower()
    if text.lstrip("+-") in {"inf", "infinity"}:
        return -UNBOUNDED if text.startswith("-") else UNBOUNDED
    return _clamped(number(source, axis, "limit", tag, default=default))


def _clamped(value: float) -> float:
    return min(UNBOUNDED, max(-UNBOUNDED, value))


def _mimic(source: Source, axis: Element) -> Mimic | None:
    """SDF: position = multiplier × (position of the other - reference) + offset."""
    mimic = first(axis, "mimic")
    if mimic is None:
        return None
    multiplier, reference, offset = (
        _clamped(number(source, mimic, tag, default=default))
        for tag, default in (("multiplier", 1.0), ("reference", 0.0), ("offset", 0.0))
    )
    return Mimic(
        joint=mimic.get("joint") or "",
        multiplier=multiplier,
        offset=offset - multiplier * reference,
    )
