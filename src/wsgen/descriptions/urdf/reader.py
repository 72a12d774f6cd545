"""Read a URDF: from bytes or text over the XML document to a `Robot`, with all diagnostics.

The rules are those of urdfdom and sdformat, because they decide what Gazebo makes of the text.
Everything is checked before any engine or tool sees the file: some of them crash on invalid ones.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.descriptions.rules import (
    MALFORMED_XML,
    MISSPELLED_ATTRIBUTE,
    MISSPELLED_ELEMENT,
    NO_LINK,
    NOT_A_NUMBER,
    NOT_UTF_8,
    OVERSIZED_FILE,
    UNNAMED_ELEMENT,
    ZERO_SIZE,
)
from wsgen.descriptions.urdf.extensions import kept_joints
from wsgen.descriptions.urdf.gazebo import read_tags
from wsgen.descriptions.urdf.joints import read_joint
from wsgen.descriptions.urdf.links import read_link, read_materials
from wsgen.descriptions.urdf.lumping import WORLD
from wsgen.descriptions.urdf.sensors import read_controls, read_transmissions
from wsgen.descriptions.urdf.structure import check_inertias, check_mimics, check_names, find_root
from wsgen.descriptions.urdf.unknown_elements import check_spelling
from wsgen.descriptions.urdf.values import LEFT_OVER, Collector, line_of
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.robot import Robot
from wsgen.text.files import save_as_utf8, wide_encoding
from wsgen.text.markup import without_comments
from wsgen.text.values import lazy_pattern
from wsgen.text.xmltree import Malformed, children, parse, parse_as_tinyxml

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import ControlSystem, GazeboTag
    from wsgen.text.xmltree import Element


TEXT_LIMIT = 8 * 2**20  # characters, read in some seconds; the largest public URDF has 4 % of it
VERSION = "1.0"
# Gazebo's parser does not mind a version that does not exist, nor an empty line before it.
DECLARATION = lazy_pattern(r"^\ufeff?\s*<\?xml\s[^>]*\?>")
INSTRUCTIONS_AHEAD = lazy_pattern(r"(?:\s*<\?.*?\?>)*", re.DOTALL)
CDATA = lazy_pattern(r"<!\[CDATA\[.*?\]\]>", re.DOTALL)
# XML says that a line break in an attribute is a blank. Gazebo's parser does not know that, and
# splits these at blanks alone.
BROKEN_LINE = lazy_pattern(
    r"""\b(xyz|rpy|size|scale)\s*=\s*("[^"<]*[\t\n\r][^"<]*"|'[^'<]*[\t\n\r][^'<]*')"""
)
LINK = lazy_pattern(r"\blink\[@name='([^']*)'\]")
MISSPELLED = frozenset((MISSPELLED_ELEMENT.code, MISSPELLED_ATTRIBUTE.code))

NOT_A_ROBOT = Rule(
    code="ROB003",
    name="not-a-robot",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="The root element of a URDF is not `<robot>`.",
    why="`urdfdom` reads `<robot>` only. An SDF file is checked as SDF when its name ends in "
    ".sdf or .world.",
    example='<robots name="r">\n  <link name="base_link"/>\n</robots>',
    instead='<robot name="r">\n  <link name="base_link"/>\n</robot>',
)

UNNAMED_ROBOT = Rule(
    code="ROB004",
    name="unnamed-robot",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="The robot has no name.",
    why="`urdfdom` refuses a robot without a name, and so do Gazebo and robot_state_publisher.",
    example="<robot>",
    instead='<robot name="my_robot">',
)

DUPLICATE_LINK = Rule(
    code="ROB007",
    name="duplicate-link",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="Two links have the same name.",
    why=("`urdfdom` refuses the robot. Usually a xacro macro is called twice without a prefix."),
    example='<link name="wheel"/>\n<link name="wheel"/>',
    instead='<link name="left_wheel"/>\n<link name="right_wheel"/>',
)

DUPLICATE_JOINT = Rule(
    code="ROB008",
    name="duplicate-joint",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="Two joints have the same name.",
    why="`urdfdom` refuses the robot, and PyBullet crashes on it.",
    example='<joint name="wheel_joint" type="continuous">…</joint>\n'
    '<joint name="wheel_joint" type="continuous">…</joint>',
    instead='<joint name="left_wheel_joint" type="continuous">…</joint>\n'
    '<joint name="right_wheel_joint" type="continuous">…</joint>',
)

UNEXPANDED_XACRO = Rule(
    code="ROB017",
    name="unexpanded-xacro",
    severity=Severity.ERROR,
    severity_varies="a warning in a name or a plugin, which use the text as it is",
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A URDF contains a xacro expression.",
    why="Gazebo and robot_state_publisher do not evaluate xacro: they refuse the text or read 0. "
    "Usually a launch file reads the .xacro file without expanding it, or a macro or property "
    "is not defined.",
    example="with open('robot.urdf.xacro') as file:\n    robot_description = file.read()",
    instead="robot_description = xacro.process_file('robot.urdf.xacro').toxml()",
)

IGNORED_XACRO = Rule(
    code="ROB143",
    name="ignored-xacro",
    severity=Severity.ERROR,
    severity_varies="a warning for a definition, which does not add anything by itself",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="A URDF contains a xacro element, which Gazebo ignores.",
    what="Looks for xacro elements in spawned robots. The robot is simulated without the parts "
    "that they would add, as in Gazebo.",
    why="Gazebo spawns the robot without the parts of macros, included files and conditions: "
    "wheels, joints, sensors. Usually a launch file reads the .xacro file without expanding it.",
    example="with open('robot.urdf.xacro') as file:\n    robot_description = file.read()",
    instead="robot_description = xacro.process_file('robot.urdf.xacro').toxml()",
)

UNKNOWN_URDF_VERSION = Rule(
    code="ROB047",
    name="unknown-urdf-version",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="The version of a URDF is not 1.0.",
    why="`urdfdom` supports only version 1.0, and refuses the robot.",
    example='<robot name="my_robot" version="2.0">',
    instead='<robot name="my_robot">',
)


# What Gazebo loses with a value in one of these elements, or around them, that is no number.
LOST_WITH = {
    "robot": "the value is lost",
    "material": "the color is lost",
    "inertial": "it drops the <inertial> of the link",
    "visual": "it stops reading the link there, and drops visuals and all collisions",
    "collision": "it stops reading the link there, and drops collisions",
    "joint": "it refuses the robot",
    "gazebo": "the value is lost, or Gazebo's parser ends with an error",
    "plugin": "",  # reads the text as it is
}
NAMES = frozenset(("name", "link", "joint", "reference"))  # attributes
DEFINITIONS = frozenset(("macro", "property", "arg"))  # of xacro; the others add something


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
    collector = Collector(file)
    text = _decode(collector, text) or "" if isinstance(text, bytes) else _storable(text)
    root = None if collector.has_errors else _read_document(collector, text)
    if root is None:
        return None, tuple(collector.diagnostics)
    _report_unexpanded(collector, root, f"robot[@name='{root.get('name') or ''}']")
    check_spelling(collector, root, "robot")
    robot = _mark_doubtful(_read_robot(collector, root), collector.diagnostics)
    check_names(collector, robot, line_of(root))
    check_mimics(collector, robot)
    check_inertias(collector, robot)
    return (robot if robot.root else None), tuple(collector.diagnostics)


def read_document(text: str | bytes) -> Element | None:
    """The element <robot> of a text, as `read_urdf` reads it; None where that reports why."""
    collector = Collector(None)
    text = _decode(collector, text) or "" if isinstance(text, bytes) else _storable(text)
    return None if collector.has_errors else _read_document(collector, text)


def _mark_doubtful(robot: Robot, diagnostics: Iterable[Diagnostic]) -> Robot:
    """The robot with those links marked that have an error, a misspelling or a shape left out.

    Other diagnostics about them would follow from that and are not reported, except what Gazebo
    refuses because of a misspelling.
    """
    erroneous, incomplete = set[str](), set[str]()
    for found in diagnostics:
        names = LINK.findall(found.element or "")
        if found.severity is Severity.ERROR:
            erroneous.update(names)
        elif found.code in {*MISSPELLED, ZERO_SIZE.code}:
            incomplete.update(names)
    doubtful = erroneous | incomplete
    links = (
        replace(link, is_as_meant=link.name not in doubtful, has_error=link.name in erroneous)
        for link in robot.links
    )
    return replace(robot, links=tuple(links)) if doubtful else robot


def _read_robot(collector: Collector, root: Element) -> Robot:
    """The robot; its root is empty where links and joints make no tree."""
    links = _unique_names(collector, list(children(root, "link")), DUPLICATE_LINK)
    joint_elements = _unique_names(collector, list(children(root, "joint")), DUPLICATE_JOINT)
    if not links:
        collector.report_missing(
            NO_LINK,
            "The robot does not have a link.",
            hint='Add <link name="base_link">. In a xacro file, also call the macros that define '
            "links.",
            at=root,
            path="robot",
            name="link",
        )
    joints = [
        (joint, element)
        for name, element in joint_elements.items()
        if (joint := read_joint(collector, element, name)) is not None
    ]
    has_all_names = all(
        (element.get("name") or "").strip() for element in children(root, "link", "joint")
    ) and not collector.has_misspelled(root, "link", "joint")
    complete = len(joints) == len(list(children(root, "joint"))) and len(links) == len(
        list(children(root, "link"))
    )
    # What hangs on a joint that could not be read would only look like a second root.
    root_link = find_root(collector, root, links, joints) if links and complete else None
    materials = read_materials(collector, root)
    tags = read_tags(collector, root, set(links), set(joint_elements), is_complete=has_all_names)
    controls = read_controls(root)
    held, kept = _held_joints(controls, tags), kept_joints(tags)
    return Robot(
        name=root.get("name") or "",
        root=root_link or "",
        links=tuple(
            read_link(collector, element, name, materials) for name, element in links.items()
        ),
        joints=tuple(
            replace(joint, is_held=joint.name in held, kept_by=kept.get(joint.name, ""))
            for joint, _ in joints
        ),
        gazebo=tags,
        controls=controls,
        transmissions=read_transmissions(root),
        fixed_to_world=root_link == WORLD,
    )


def _held_joints(controls: Iterable[ControlSystem], tags: Iterable[GazeboTag]) -> set[str]:
    """The joints whose position ros2_control commands in Gazebo.

    Its plugin holds them from the start, also where no controller is active (`hold_joints`).
    """
    plugins = (plugin.filename for tag in tags for plugin in tag.plugins)
    if not any("ros2_control" in filename for filename in plugins):
        return set()
    joints = (joint for control in controls for joint in control.joints)
    return {joint.name for joint in joints if "position" in joint.commands}


def _unique_names(
    collector: Collector, elements: Sequence[Element], duplicate: Rule
) -> dict[str, Element]:
    """The elements by their names; a missing or a repeated name is reported and left out."""
    named: dict[str, Element] = {}
    for element in elements:
        name = element.get("name") or ""
        if not name.strip():
            collector.report_missing(
                UNNAMED_ELEMENT,
                f"A {element.tag} has no name.",
                hint=f'Write <{element.tag} name="NAME">.',
                at=element,
                path=str(element.tag),
                name="name",
            )
        elif name in named:
            collector.report(
                duplicate,
                f"Two {element.tag}s have the name `{name}`.",
                hint="Give each a different name. In a xacro macro, use a parameter as a prefix.",
                at=element,
                path=f"{element.tag}[@name='{name}']",
            )
        else:
            named[name] = element
    return named


def _decode(collector: Collector, data: bytes) -> str | None:
    """The text of a file; None where it is none, which is reported."""
    data = data.rstrip(b"\0")  # where a text of C ends
    wide = wide_encoding(data)
    if wide or b"\0" in data:
        collector.report(
            NOT_UTF_8,
            f"The file is encoded in {wide}: Gazebo and robot_state_publisher read UTF-8 only."
            if wide
            else "The file is not a text file: it contains null bytes.",
            hint=save_as_utf8(wide) if wide else "Give a text file in UTF-8.",
            at=1,
        )
        return None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        collector.report(
            NOT_UTF_8,
            "The file is not encoded in UTF-8, but Gazebo reads it as UTF-8.",
            hint=save_as_utf8("ISO-8859-1"),
            at=data.count(b"\n", 0, error.start) + 1,
            severity=Severity.WARNING,
        )
    return data.decode("utf-8", "replace")


def _storable(text: str) -> str:
    """The text without halves of characters, which no file can hold, and without C's end."""
    text = text.rstrip("\0")
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return text.encode("utf-8", "replace").decode("utf-8")
    return text


def _read_document(collector: Collector, text: str) -> Element | None:
    """The element <robot> of a text; None where there is none, which is reported."""
    if len(text) > TEXT_LIMIT or "<!ENTITY" in text:
        collector.report(
            OVERSIZED_FILE,
            f"The document has more than {TEXT_LIMIT} characters, the most that wsgen reads."
            if len(text) > TEXT_LIMIT
            else "The document declares entities.",
            hint="Write the values instead; remove entities and embedded data.",
            at=None,
        )
        return None
    text = DECLARATION.sub(lambda found: "\n" * found[0].count("\n"), text)
    root = _parsed(collector, text)
    if root is None:
        return None
    _forget_namespaces(root)
    _report_instructions(collector, text)
    if root.tag != "robot":
        collector.report(
            NOT_A_ROBOT,
            f"The root element is <{root.tag}>, not <robot>.",
            hint='Write <robot name="NAME"> as the root element; name an SDF file .sdf or .world.',
            at=root,
            path=str(root.tag),
        )
        return None
    _check_head(collector, root)
    _report_broken_lines(collector, text)
    return root


def _parsed(collector: Collector, text: str) -> Element | None:
    root = parse(text)
    if not isinstance(root, Malformed):
        return root
    lenient = parse_as_tinyxml(without_comments(text))
    if lenient is not None:
        collector.report(
            MALFORMED_XML,
            f"Not well-formed XML: {root.message}. Gazebo's parser accepts it; xacro and others "
            "do not.",
            hint=root.hint,
            at=root.line,
            severity=Severity.WARNING,
        )
        return lenient
    collector.report(
        MALFORMED_XML,
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


def _report_instructions(collector: Collector, text: str) -> None:
    ahead = INSTRUCTIONS_AHEAD.match(text)
    start = 0 if ahead is None else ahead.end()
    if text.find("<?", start) < 0:  # nearly always
        return
    rest = CDATA.sub(lambda found: " " * len(found[0]), without_comments(text[start:]))
    place = rest.find("<?")
    if place >= 0:
        collector.report(
            MALFORMED_XML,
            "Gazebo's parser accepts processing instructions (<?…?>) only before all elements.",
            hint="Remove it, or move it before the root element.",
            at=text.count("\n", 0, start + place) + 1,
        )


def _check_head(collector: Collector, root: Element) -> None:
    if not (root.get("name") or "").strip():
        collector.report(
            UNNAMED_ROBOT,
            "The robot has no name.",
            hint='Write <robot name="NAME">.',
            at=root,
            path="robot",
        )
    version = root.get("version")
    if version is not None and version != VERSION:
        collector.report(
            UNKNOWN_URDF_VERSION,
            f"Gazebo's parser refuses URDF version `{version[:60]}`.",
            hint=f'Remove the attribute, or write version="{VERSION}".',
            at=root,
            path="robot",
        )


def _report_broken_lines(collector: Collector, text: str) -> None:
    if not BROKEN_LINE.search(text):  # nearly always
        return
    for found in BROKEN_LINE.finditer(without_comments(text)):
        collector.report(
            NOT_A_NUMBER,
            f"A line break or tab separates the numbers of `{found[1]}`.",
            hint="Separate them with blanks: Gazebo refuses other separators.",
            at=text.count("\n", 0, found.start()) + 1,
            path=f"@{found[1]}",
        )


def _report_unexpanded(
    collector: Collector, element: Element, path: str, inside: str = "robot"
) -> None:
    """Report what xacro should have replaced, in the element and below it.

    `inside` is the outermost element around it whose loss users notice: see `LOST_WITH`.
    """
    texts = {"": element.text or "", **{str(key): str(value) for key, value in element.items()}}
    left = {name: text.strip()[:60] for name, text in texts.items() if LEFT_OVER.search(text)}
    if left:
        text = next(iter(left.values()))
        is_kept = inside == "plugin" or left.keys() <= NAMES
        holder = "the plugin reads" if inside == "plugin" else "Gazebo takes"
        collector.report(
            UNEXPANDED_XACRO,
            f"`{text}` is a xacro expression: {holder} it as it is written."
            if is_kept
            else f"`{text}` is a xacro expression, which Gazebo does not evaluate: "
            f"{LOST_WITH[inside]}.",
            hint="Expand the file with xacro first; check that the property is defined.",
            at=element,
            path=path,
            severity=Severity.WARNING if is_kept else Severity.ERROR,
        )
    for child in element:
        if not isinstance(child.tag, str):
            continue
        name = child.get("name")
        if "xacro" in child.tag:
            _report_ignored(collector, child, path)
        else:
            child_path = child.tag if name is None else f"{child.tag}[@name='{name}']"
            below = child.tag if child.tag in LOST_WITH else inside
            _report_unexpanded(collector, child, child_path, below)


def _report_ignored(collector: Collector, element: Element, path: str) -> None:
    """Report an element of xacro, which Gazebo passes over with all that it holds."""
    kind = element.tag.rpartition("}")[2].rpartition(":")[2]
    tag = f"xacro:{kind}"
    found = {name: len(list(element.iter(name))) for name in ("link", "joint")}
    held = " and ".join(
        f"{count} {name}{'s' if count > 1 else ''}" for name, count in found.items() if count
    )
    if kind in DEFINITIONS:
        lost = "it does not add anything to the robot by itself"
    elif kind == "include":
        lost = f"the content of the file `{(element.get('filename') or '')[:60]}` is missing"
    elif held:
        lost = f"the {held} in it are missing"
    else:
        lost = "the parts that it adds to the robot are missing"
    collector.report(
        IGNORED_XACRO,
        f"Gazebo ignores the xacro element <{tag}>: {lost}.",
        hint="Expand the file with xacro first: Command(['xacro ', path]) in the launch file.",
        at=element,
        path=f"{path}/{tag}",
        severity=Severity.WARNING if kind in DEFINITIONS else Severity.ERROR,
    )
