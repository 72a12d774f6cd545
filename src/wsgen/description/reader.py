"""URDF text to a `Robot`, with everything that is wrong in it.

The rules are those of urdfdom and sdformat, because they decide what Gazebo makes of the text.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.description.findings import Findings
from wsgen.description.gazebo import apply_tags, read_tags
from wsgen.description.joints import read_joint
from wsgen.description.links import read_link
from wsgen.description.numbers import LEFT_OVER
from wsgen.description.shapes import read_materials
from wsgen.description.soundness import check_inertias, check_mimics, check_names
from wsgen.description.spelling import check_spelling
from wsgen.description.tree import find_root, unique_names
from wsgen.model.robot import Robot
from wsgen.xmltree import Malformed, children, parse

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.xmltree import Element

# Gazebo's parser does not mind a version that does not exist, nor an empty line before it.
DECLARATION = re.compile(r"^\ufeff?\s*<\?xml\s[^>]*\?>")
TEXT_LIMIT = 32 * 2**20  # characters; the largest public URDF has 1 % of it


def read_urdf(text: str, *, file: Path | None) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
    """Read a robot and check it before any engine or tool sees it.

    The robot is None where its links and joints do not make one tree, or the text is no URDF at
    all. Otherwise all numbers of the robot are finite, also where the diagnostics have errors:
    what could not be read is left out. `file` is what the diagnostics name.
    """
    findings = Findings(file)
    root = _read_document(findings, text)
    if root is None:
        return None, tuple(findings.diagnostics)
    _report_left_overs(findings, root, f"robot[@name='{root.get('name') or ''}']")
    check_spelling(findings, root, "robot")
    links = unique_names(findings, list(children(root, "link")), "ROB007")
    joint_elements = unique_names(findings, list(children(root, "joint")), "ROB008")
    if not links:
        findings.error(
            "ROB005",
            "The robot has no link.",
            hint='Add <link name="base_link">. In a xacro file, a macro that is defined must also '
            "be called.",
            at=root,
            path="robot",
        )
    joints = [
        (joint, element)
        for name, element in joint_elements.items()
        if (joint := read_joint(findings, element, name)) is not None
    ]
    complete = len(joints) == len(list(children(root, "joint"))) and len(links) == len(
        list(children(root, "link"))
    )
    # What hangs on a joint that could not be read would only look like a second root.
    root_link = find_root(findings, links, joints) if links and complete else None
    materials = read_materials(findings, root)
    tags = read_tags(findings, root, set(links), set(joint_elements))
    robot = Robot(
        name=root.get("name") or "",
        root=root_link or "",
        links=tuple(
            apply_tags(
                [read_link(findings, element, name, materials) for name, element in links.items()],
                tags,
            )
        ),
        joints=tuple(joint for joint, _ in joints),
        gazebo=tags,
        fixed_to_world=root_link == "world",
    )
    check_names(findings, robot)
    check_mimics(findings, robot)
    check_inertias(findings, robot)
    return (robot if root_link else None), tuple(findings.diagnostics)


def _read_document(findings: Findings, text: str) -> Element | None:
    if len(text) > TEXT_LIMIT or "<!ENTITY" in text:
        findings.error(
            "ROB002",
            f"The document has {len(text)} characters; wsgen reads up to {TEXT_LIMIT}."
            if len(text) > TEXT_LIMIT
            else "The document declares entities.",
            hint="Write the values out; a URDF needs neither entities nor data in it.",
            at=None,
        )
        return None
    root = parse(DECLARATION.sub(lambda found: "\n" * found[0].count("\n"), text))
    if isinstance(root, Malformed):
        findings.error(
            "ROB001",
            f"Not well-formed XML: {root.message}.",
            hint="Close every element and quote every attribute; & is written &amp;.",
            at=root.line,
        )
        return None
    if root.tag != "robot":
        findings.error(
            "ROB003",
            f"The root element is <{root.tag}>, not <robot>.",
            hint='A URDF starts with <robot name="NAME">; an SDF file is not a URDF.',
            at=root,
            path=str(root.tag),
        )
        return None
    if not (root.get("name") or "").strip():
        findings.error(
            "ROB004",
            "The robot has no name.",
            hint='Write <robot name="NAME">.',
            at=root,
            path="robot",
        )
    return root


def _report_left_overs(findings: Findings, element: Element, path: str) -> None:
    """Report what xacro should have replaced, in the element and below it."""
    texts = [*element.attrib.values(), element.text or ""]
    left = next((text for text in texts if LEFT_OVER.search(text)), None)
    if left is not None:
        findings.error(
            "ROB017",
            f"`{left.strip()[:60]}` is left over from xacro.",
            hint="Expand the file with xacro first; check that the property is defined.",
            at=element,
            path=path,
        )
    for child in element:
        if isinstance(child.tag, str):
            name = child.get("name")
            if "xacro" in child.tag:
                findings.error(
                    "ROB017",
                    f"<{child.tag.rpartition('}')[2]}> is left over from xacro.",
                    hint="Expand the file with xacro first; check that the macro is defined.",
                    at=child,
                    path=f"{path}/{child.tag.rpartition('}')[2]}",
                )
            _report_left_overs(
                findings, child, child.tag if name is None else f"{child.tag}[@name='{name}']"
            )
