"""`<gazebo>` elements: what Gazebo's parser takes out of them, and what is wrong in them.

The keys are those that sdformat reads itself (`parser_urdf.cc`, ParseSDFExtension); everything
else is copied into the SDF as it is, of which wsgen takes the part that it simulates. What the
values do to links and joints is in `extensions`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.findings import line_of
from wsgen.description.gazebo_values import check_placement, check_value
from wsgen.description.spelling import nearest
from wsgen.model.robot import GazeboTag, Plugin, SdfJoint
from wsgen.suggestions import did_you_mean
from wsgen.xmltree import child_text, child_texts, children

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

# Of these SDF elements also what is in them is taken, under `collision/surface/friction/ode/mu`.
COPIED = frozenset(("collision", "visual", "velocity_decay"))
# What Gazebo adds to the model for them is not part of the trial.
NOT_SIMULATED = frozenset(("joint", "link", "model", "include"))


def read_tags(
    findings: Findings,
    root: Element,
    link_names: set[str],
    joint_names: set[str],
    *,
    is_complete: bool = True,
) -> tuple[GazeboTag, ...]:
    """Every `<gazebo>` element of the robot, checked.

    `is_complete` says that there are no other links and joints: none whose name is missing.
    """
    return tuple(
        _read_tag(findings, element, link_names, joint_names, is_complete=is_complete)
        for element in children(root, "gazebo")
    )


def _read_tag(
    findings: Findings,
    element: Element,
    link_names: set[str],
    joint_names: set[str],
    *,
    is_complete: bool,
) -> GazeboTag:
    reference = element.get("reference") or None  # an empty one means the whole robot
    path = "gazebo" if reference is None else f"gazebo[@reference='{reference}']"
    is_known = reference is None or reference in link_names or reference in joint_names
    if reference is not None and not is_known and is_complete:
        _report_unknown(findings, element, path, reference, link_names | joint_names)
    values: dict[str, str] = {}
    for child in element:
        if not isinstance(child.tag, str):
            continue
        for key, leaf in _values_in(child, child.tag):
            values[key] = _value_of(leaf)
            check_value(findings, leaf, f"{path}/{key}", key, values[key], is_known=is_known)
        inside = f"{path}/{child.tag}"
        if is_known:
            check_placement(
                findings,
                child,
                inside,
                is_link=reference in link_names,
                is_joint=reference in joint_names,
            )
        if child.tag in NOT_SIMULATED and reference is None:
            _report_not_simulated(findings, child, inside)
    return GazeboTag(
        reference=reference,
        values=values,
        plugins=tuple(
            Plugin(plugin.get("filename") or "", child_texts(plugin))
            for plugin in _descendants(element, "plugin")
        ),
        sensors=tuple(sensor.get("name") or "" for sensor in _descendants(element, "sensor")),
        frames=tuple(
            part.get("name") or "" for tag in ("link", "frame") for part in children(element, tag)
        ),
        is_open=any(next(children(element, tag), None) is not None for tag in ("include", "model")),
        joints=tuple(_read_joint(joint) for joint in children(element, "joint"))
        if reference is None
        else (),
        line=line_of(element),
    )


def _read_joint(element: Element) -> SdfJoint:
    ends = {tag: child_text(element, tag) for tag in ("parent", "child")}
    return SdfJoint(
        name=element.get("name") or "",
        ends={tag: name for tag, name in ends.items() if name},
        line=line_of(element),
    )


def _values_in(element: Element, key: str) -> Iterator[tuple[str, Element]]:
    """The element, if its text may mean something, and those in it where these are copied."""
    inside = [child for child in element if isinstance(child.tag, str)]
    is_copied = key.partition("/")[0] in COPIED
    if not inside or is_copied or _value_of(element):
        yield key, element
    if is_copied:
        for child in inside:
            yield from _values_in(child, f"{key}/{child.tag}")


def _value_of(element: Element) -> str:
    """The attribute `value`, which counts first, or the text."""
    value = element.get("value")
    return (element.text or "" if value is None else value).strip()


def _report_unknown(
    findings: Findings, element: Element, path: str, reference: str, known: set[str]
) -> None:
    near = nearest(findings, reference, known)
    findings.warning(
        "ROB030",
        f"No link or joint is called `{reference}`: Gazebo ignores this element.",
        hint=did_you_mean(near) if near else "Name a link or joint of this robot.",
        at=element,
        path=path,
    )


def _report_not_simulated(findings: Findings, element: Element, path: str) -> None:
    findings.warning(
        "ROB058",
        f"Gazebo adds the SDF <{element.tag}> in a <gazebo> element to the robot; wsgen's trial "
        "goes without it.",
        hint="Watch this part in Gazebo itself.",
        at=element,
        path=path,
    )


def _descendants(element: Element, tag: str) -> Iterator[Element]:
    for child in element:
        if child.tag == tag:
            yield child
        yield from _descendants(child, tag)
