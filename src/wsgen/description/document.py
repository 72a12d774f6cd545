"""The XML around a robot: whether there is a document, and whether it is finished."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.description.markup import without_comments
from wsgen.description.numbers import LEFT_OVER
from wsgen.xmltree import Malformed, parse, parse_as_tinyxml

if TYPE_CHECKING:
    from wsgen.description.findings import Findings
    from wsgen.xmltree import Element

# Gazebo's parser does not mind a version that does not exist, nor an empty line before it.
DECLARATION = re.compile(r"^\ufeff?\s*<\?xml\s[^>]*\?>")
INSTRUCTIONS_AHEAD = re.compile(r"(?:\s*<\?.*?\?>)*", re.DOTALL)
CDATA = re.compile(r"<!\[CDATA\[.*?\]\]>", re.DOTALL)
TEXT_LIMIT = 8 * 2**20  # characters, read in some seconds; the largest public URDF has 4 % of it
VERSION = "1.0"
# XML says that a line break in an attribute is a blank. Gazebo's parser does not know that, and
# splits these at blanks alone.
BROKEN_LINE = re.compile(
    r"""\b(xyz|rpy|size|scale)\s*=\s*("[^"<]*[\t\n\r][^"<]*"|'[^'<]*[\t\n\r][^'<]*')"""
)


def read_document(findings: Findings, text: str) -> Element | None:
    """The element <robot> of a text; None where there is none, which is reported."""
    if len(text) > TEXT_LIMIT or "<!ENTITY" in text:
        findings.error(
            "ROB002",
            f"The document has more than {TEXT_LIMIT} characters, and wsgen does not read it."
            if len(text) > TEXT_LIMIT
            else "The document declares entities.",
            hint="Write the values out; a URDF needs neither entities nor data in it.",
            at=None,
        )
        return None
    text = DECLARATION.sub(lambda found: "\n" * found[0].count("\n"), text)
    root = _parsed(findings, text)
    if root is None:
        return None
    _forget_namespaces(root)
    _report_instructions(findings, text)
    if root.tag != "robot":
        findings.error(
            "ROB003",
            f"The root element is <{root.tag}>, not <robot>.",
            hint='A URDF starts with <robot name="NAME">; an SDF file is not a URDF.',
            at=root,
            path=str(root.tag),
        )
        return None
    _check_head(findings, root)
    _report_broken_lines(findings, text)
    return root


def _parsed(findings: Findings, text: str) -> Element | None:
    root = parse(text)
    if not isinstance(root, Malformed):
        return root
    lenient = parse_as_tinyxml(without_comments(text))
    if lenient is not None:
        findings.warning(
            "ROB001",
            f"Not well-formed XML: {root.message}. Gazebo's parser does not mind; xacro and others "
            "do.",
            hint="Write &amp; for &, no -- in comments, and declare prefixes with xmlns:PREFIX.",
            at=root.line,
        )
        return lenient
    findings.error(
        "ROB001",
        f"Not well-formed XML: {root.message}.",
        hint=root.hint,
        at=root.line,
    )
    return None


def _forget_namespaces(root: Element) -> None:
    """Gazebo's parser knows none: an element is called what is written."""
    if not any("}" in str(tag) for tag in (root.tag, *(child.tag for child in root))):
        return
    for element in root.iter():
        if isinstance(element.tag, str) and element.prefix is None:
            element.tag = element.tag.rpartition("}")[2]


def _report_instructions(findings: Findings, text: str) -> None:
    ahead = INSTRUCTIONS_AHEAD.match(text)
    start = 0 if ahead is None else ahead.end()
    if text.find("<?", start) < 0:  # nearly always
        return
    rest = CDATA.sub(lambda found: " " * len(found[0]), without_comments(text[start:]))
    place = rest.find("<?")
    if place >= 0:
        findings.error(
            "ROB001",
            "Gazebo's parser takes processing instructions (<?…?>) only before everything else.",
            hint="Remove it, or put it into the first lines of the file.",
            at=text.count("\n", 0, start + place) + 1,
        )


def _check_head(findings: Findings, root: Element) -> None:
    if not (root.get("name") or "").strip():
        findings.error(
            "ROB004",
            "The robot has no name.",
            hint='Write <robot name="NAME">.',
            at=root,
            path="robot",
        )
    version = root.get("version")
    if version is not None and version != VERSION:
        findings.error(
            "ROB047",
            f"Gazebo's parser knows no URDF of version `{version[:60]}`, and refuses the robot.",
            hint=f'Remove the attribute, or write version="{VERSION}".',
            at=root,
            path="robot",
        )


def _report_broken_lines(findings: Findings, text: str) -> None:
    if not BROKEN_LINE.search(text):  # nearly always
        return
    for found in BROKEN_LINE.finditer(without_comments(text)):
        findings.error(
            "ROB016",
            f"A line break or tab parts the numbers of `{found[1]}`.",
            hint="Part them with blanks: Gazebo refuses anything else.",
            at=text.count("\n", 0, found.start()) + 1,
            path=f"@{found[1]}",
        )


def report_left_overs(findings: Findings, element: Element, path: str) -> None:
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
            report_left_overs(
                findings, child, child.tag if name is None else f"{child.tag}[@name='{name}']"
            )
