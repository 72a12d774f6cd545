"""URDF text to a `Robot`, with everything that is wrong in it.

The rules are those of urdfdom and sdformat, because they decide what Gazebo makes of the text.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description.document import read_document, report_left_overs
from wsgen.description.encoding import decode, storable
from wsgen.description.findings import Findings, line_of
from wsgen.description.gazebo import read_tags
from wsgen.description.joints import read_joint
from wsgen.description.links import read_link
from wsgen.description.lumping import WORLD
from wsgen.description.materials import read_materials
from wsgen.description.soundness import check_inertias, check_mimics, check_names
from wsgen.description.spelling import check_spelling
from wsgen.description.tree import find_root, unique_names
from wsgen.diagnostics import Severity
from wsgen.model.robot import Robot
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.xmltree import Element


LINK = re.compile(r"\blink\[@name='([^']*)'\]")
MISSPELT = frozenset(("ROB038", "ROB077"))
WITHOUT_EXTENT = "ROB028"


def read_urdf(
    text: str | bytes, *, file: Path | None
) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
    """Read a robot and check it before any engine or tool sees it.

    `text` may be the bytes of a file.

    The robot is None where its links and joints do not make one tree, or the text is no URDF at
    all. Otherwise all numbers of the robot are finite, also where the diagnostics have errors:
    what could not be read is left out. The `<gazebo>` elements are only read; `lump` does what they
    say, because that depends on what is lumped. `file` is what the diagnostics name.
    """
    findings = Findings(file)
    text = decode(findings, text) or "" if isinstance(text, bytes) else storable(text)
    root = None if findings.has_errors else read_document(findings, text)
    if root is None:
        return None, tuple(findings.diagnostics)
    report_left_overs(findings, root, f"robot[@name='{root.get('name') or ''}']")
    check_spelling(findings, root, "robot")
    robot = _with_doubts(_read_robot(findings, root), findings.diagnostics)
    check_names(findings, robot, line_of(root))
    check_mimics(findings, robot)
    check_inertias(findings, robot)
    return (robot if robot.root else None), tuple(findings.diagnostics)


def _with_doubts(robot: Robot, diagnostics: Iterable[Diagnostic]) -> Robot:
    """The robot with those links marked in which something is wrong, misspelt or left out.

    What else is odd about them comes from that, and is not worth telling; what Gazebo refuses for
    a misspelling is.
    """
    wrong, unlike = set[str](), set[str]()
    for found in diagnostics:
        names = LINK.findall(found.element or "")
        if found.severity is Severity.ERROR:
            wrong.update(names)
        elif found.code in {*MISSPELT, WITHOUT_EXTENT}:
            unlike.update(names)
    doubtful = wrong | unlike
    links = (
        replace(link, is_as_meant=link.name not in doubtful, has_error=link.name in wrong)
        for link in robot.links
    )
    return replace(robot, links=tuple(links)) if doubtful else robot


def _read_robot(findings: Findings, root: Element) -> Robot:
    """The robot; its root is empty where links and joints make no tree."""
    links = unique_names(findings, list(children(root, "link")), "ROB007")
    joint_elements = unique_names(findings, list(children(root, "joint")), "ROB008")
    if not links:
        findings.missing(
            "ROB005",
            "The robot has no link.",
            hint='Add <link name="base_link">. In a xacro file, a macro that is defined must also '
            "be called.",
            at=root,
            path="robot",
            name="link",
        )
    joints = [
        (joint, element)
        for name, element in joint_elements.items()
        if (joint := read_joint(findings, element, name)) is not None
    ]
    has_all_names = all(
        (element.get("name") or "").strip() for element in children(root, "link", "joint")
    ) and not findings.has_misspelt(root, "link", "joint")
    complete = len(joints) == len(list(children(root, "joint"))) and len(links) == len(
        list(children(root, "link"))
    )
    # What hangs on a joint that could not be read would only look like a second root.
    root_link = find_root(findings, root, links, joints) if links and complete else None
    materials = read_materials(findings, root)
    return Robot(
        name=root.get("name") or "",
        root=root_link or "",
        links=tuple(
            read_link(findings, element, name, materials) for name, element in links.items()
        ),
        joints=tuple(joint for joint, _ in joints),
        gazebo=read_tags(
            findings, root, set(links), set(joint_elements), is_complete=has_all_names
        ),
        fixed_to_world=root_link == WORLD,
    )
