"""`<gazebo>` elements: what Gazebo's parser takes out of them for links and joints.

The keys are those that sdformat reads itself (`parser_urdf.cc`, ParseSDFExtension); everything
else is copied into the SDF as it is and only recorded here.
"""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING

from wsgen.description.colours import GAZEBO_COLOURS
from wsgen.description.findings import line_of
from wsgen.description.numbers import parse_number
from wsgen.model.robot import GazeboTag, Link, Surface
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

NUMERIC = frozenset(
    (
        *("mu1", "mu2", "kp", "kd", "minDepth", "maxVel", "maxContacts", "dampingFactor"),
        *("laserRetro", "springReference", "springStiffness", "stopCfm", "stopErp", "fudgeFactor"),
    )
)
LUMPING_KEYS = ("preserveFixedJoint", "disableFixedJointLumping")
TRUE = frozenset(("true", "yes", "1"))  # as sdformat reads a truth value, in lower case


def read_tags(
    findings: Findings, root: Element, link_names: set[str], joint_names: set[str]
) -> tuple[GazeboTag, ...]:
    """Every `<gazebo>` element of the robot, checked."""
    tags = []
    for element in children(root, "gazebo"):
        reference = element.get("reference")
        path = "gazebo" if reference is None else f"gazebo[@reference='{reference}']"
        if reference is not None and reference not in link_names | joint_names:
            _report_unknown(findings, element, path, reference, link_names | joint_names)
        values: dict[str, str] = {}
        for child in element:
            if isinstance(child.tag, str) and not any(True for _ in child):
                values[child.tag] = (child.get("value") or child.text or "").strip()
                inside = f"{path}/{child.tag}"
                _check_value(findings, child, inside, values[child.tag])
                _check_lumping_key(findings, child, inside, reference, joint_names)
        tags.append(
            GazeboTag(
                reference=reference,
                values=values,
                plugins=tuple(
                    plugin.get("filename") or "" for plugin in _descendants(element, "plugin")
                ),
                sensors=tuple(
                    sensor.get("name") or "" for sensor in _descendants(element, "sensor")
                ),
                line=line_of(element),
            )
        )
    return tuple(tags)


def apply_tags(links: Iterable[Link], tags: Iterable[GazeboTag]) -> list[Link]:
    """The links with the colours, surfaces and flags that the tags give them."""
    by_link: dict[str, dict[str, str]] = {}
    whole_robot: dict[str, str] = {}
    for tag in tags:
        target = whole_robot if tag.reference is None else by_link.setdefault(tag.reference, {})
        target.update(tag.values)
    collide_all = is_true(whole_robot.get("selfCollide"))
    return [
        _with_values(link, by_link.get(link.name, {}), self_collide=collide_all) for link in links
    ]


def is_true(text: str | None) -> bool:
    """Whether sdformat takes this text for true."""
    return text is not None and text.lower() in TRUE


def _with_values(link: Link, values: Mapping[str, str], *, self_collide: bool) -> Link:
    self_collide = is_true(values["selfCollide"]) if "selfCollide" in values else self_collide
    if not values and not self_collide:
        return link
    numbers = {key: number for key in values if (number := _number(values, key)) is not None}
    surface = Surface(
        mu1=numbers.get("mu1", 1.0),
        mu2=numbers.get("mu2", 1.0),
        kp=numbers.get("kp"),
        kd=numbers.get("kd"),
        min_depth=numbers.get("minDepth"),
        max_contacts=int(numbers["maxContacts"]) if "maxContacts" in numbers else None,
    )
    rgba = GAZEBO_COLOURS.get(values.get("material", ""))
    return replace(
        link,
        self_collide=self_collide,
        gravity=not is_true(values.get("turnGravityOff"))
        and ("gravity" not in values or is_true(values["gravity"])),
        collisions=tuple(replace(collision, surface=surface) for collision in link.collisions),
        visuals=link.visuals
        if rgba is None
        else tuple(replace(visual, rgba=rgba) for visual in link.visuals),
    )


def _number(values: Mapping[str, str], key: str) -> float | None:
    if key not in NUMERIC:
        return None
    number = parse_number(values[key])
    return number if isinstance(number, float) else None


def _check_value(findings: Findings, element: Element, path: str, text: str) -> None:
    key = element.tag
    if key in NUMERIC:
        problem = parse_number(text)
        if isinstance(problem, str) and "$" not in text:
            findings.error(
                "ROB031",
                f"<{key}>: `{text}` {problem}.",
                hint="Write one number with a point. Gazebo ends with an exception on this.",
                at=element,
                path=path,
            )
    elif key == "material" and text.startswith("Gazebo/") and text not in GAZEBO_COLOURS:
        near = get_close_matches(text, GAZEBO_COLOURS, n=1)
        findings.warning(
            "ROB032",
            f"Gazebo has no material `{text}`.",
            hint=f"Did you mean {near[0]}?" if near else "Take Gazebo/Grey, Gazebo/Red, …",
            at=element,
            path=path,
        )


def _check_lumping_key(
    findings: Findings, element: Element, path: str, reference: str | None, joint_names: set[str]
) -> None:
    if element.tag in LUMPING_KEYS and reference not in joint_names:
        findings.warning(
            "ROB033",
            f"<{element.tag}> belongs to a joint: here it does nothing.",
            hint='Put it into <gazebo reference="JOINT"> with the name of the fixed joint.',
            at=element,
            path=path,
        )


def _report_unknown(
    findings: Findings, element: Element, path: str, reference: str, known: set[str]
) -> None:
    near = get_close_matches(reference, known, n=1)
    findings.warning(
        "ROB030",
        f"No link or joint is called `{reference}`: Gazebo ignores this element.",
        hint=f"Did you mean `{near[0]}`?" if near else "Name a link or joint of this robot.",
        at=element,
        path=path,
    )


def _descendants(element: Element, tag: str) -> Iterator[Element]:
    for child in element:
        if child.tag == tag:
            yield child
        yield from _descendants(child, tag)
