"""Rules about the files that a robot is written in: URDF, and xacro before it is expanded.

The parameters of a check are the elements as they are written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.text.markup import Written


# Of another machine or user; /opt and /usr/share are where packages are installed.
OF_SOMEBODY = lazy_pattern(r"(?:file://)?(/(?:home|Users|root|mnt|media|tmp)/|[A-Za-z]:[\\/]|~/)")
WITH_FILES = ("mesh", "texture")
# Elements of xacro, with the attribute without which they are something else.
OF_XACRO = {
    "property": "value",
    "macro": "params",
    "include": "filename",
    "arg": "default",
    "if": "value",
    "unless": "value",
    "insert_block": "name",
}
TRANSPARENT = ("xacro:if", "xacro:unless", "xacro:macro")  # what is in them is in the robot
MACRO = "xacro:macro"
# What URDF itself has below a robot and below a link; a macro may have such a name.
OF_URDF = frozenset(
    (
        *("link", "joint", "material", "gazebo", "transmission", "ros2_control", "sensor", "frame"),
        *("inertial", "visual", "collision", "contact", "origin"),
    )
)

PATH_OF_ONE_MACHINE = Rule(
    code="ROB114",
    name="path-of-one-machine",
    severity=Severity.WARNING,
    summary="The path of a mesh or texture exists on one machine only.",
    what="Looks for paths below `/home`, `/Users`, `/root`, `/mnt`, `/media` and `/tmp`, and for "
    "Windows paths. `file://$(find PACKAGE)/…` is right.",
    why="The file does not exist on other machines, or after a move: the robot has no shape there.",
    example='<mesh filename="file:///home/ada/ws/src/my_robot/meshes/base.stl"/>',
    instead='<mesh filename="package://my_robot/meshes/base.stl"/>',
)


def path_of_one_machine(
    elements: Iterable[Written], missing: Iterable[str]
) -> Iterator[Diagnostic]:
    """Report absolute paths of meshes, but not those in `missing`, which are reported."""
    reported = set(missing)
    for element in elements:
        address = element.attributes.get("filename", "")
        found = OF_SOMEBODY.match(address.strip()) if element.tag in WITH_FILES else None
        if found is None or address in reported:
            continue
        yield PATH_OF_ONE_MACHINE.at(
            element.file,
            element.line_of("filename"),
            f"{element.tag}[@filename='{address}']",
            message=f"The path `{address}` exists on this machine only.",
            hint="Copy the file into the package, and write package://PACKAGE/meshes/….",
        )


UNPREFIXED_XACRO = Rule(
    code="ROB115",
    name="unprefixed-xacro",
    severity=Severity.WARNING,
    summary="A xacro element lacks the prefix `xacro:`.",
    what="Looks for `<property>`, `<macro>`, `<include>`, `<arg>`, `<if>`, `<unless>` and "
    "`<insert_block>` among the links and joints, with the attributes of the xacro elements, and "
    "for elements of a robot or a link that have the name of a macro.",
    why="The prefix is required since ROS Jade. Without it the element is copied to the "
    "URDF, where every program ignores it.",
    example='<property name="radius" value="0.1"/>',
    instead='<xacro:property name="radius" value="0.1"/>',
)


def unprefixed_xacro(elements: Iterable[Written]) -> Iterator[Diagnostic]:
    """Report what only xacro knows and xacro does not see: its elements, and calls of macros."""
    elements = tuple(elements)
    macros = {
        one.attributes.get("name", "").removeprefix("xacro:")
        for one in elements
        if one.tag == MACRO
    } - OF_URDF
    link = ""  # that an element is in, or after
    for element in elements:
        if element.tag == "link":
            link = f"link[@name='{element.attributes.get('name')}']"
        is_call = element.tag in macros
        if not is_call and OF_XACRO.get(element.tag, "") not in element.attributes:
            continue
        above = [step for step in element.path[:-1] if not step.startswith(TRANSPARENT)]
        is_in_link = is_call and len(above) > 1 and above[1].startswith("link")
        if above[:1] != ["robot"] or len(above) > 1 + is_in_link:
            continue
        name = element.attributes.get("name")
        yield UNPREFIXED_XACRO.at(
            element.file,
            element.line,
            f"{link}/{element.tag}"
            if is_in_link
            else element.tag
            if name is None
            else f"{element.tag}[@name='{name}']",
            message=f"<{element.tag}> calls a macro without the prefix `xacro:`: it has no effect."
            if is_call
            else f"<{element.tag}> is a xacro element without the prefix `xacro:`: it has no "
            "effect.",
            hint=f"Write <xacro:{element.tag}>.",
        )


UNCALLED_MACRO = Rule(
    code="ROB116",
    name="uncalled-macro",
    severity=Severity.INFO,
    summary="A xacro file defines a macro but does not call it.",
    what="Checks the macros of the expanded file, not those of included files.",
    why="The links and joints in the macro are not part of the robot.",
    example="""
<xacro:macro name="wheel" params="prefix">…</xacro:macro>
<!-- and no <xacro:wheel …/> -->
""",
    instead="""
<xacro:macro name="wheel" params="prefix">…</xacro:macro>
<xacro:wheel prefix="left"/>
""",
)


def uncalled_macros(elements: Sequence[Written], main: Path) -> Iterator[Diagnostic]:
    """Report macros of the main file that no file calls."""
    called = {
        one.tag.rpartition(":")[2].rpartition(".")[2]
        for one in elements
        if one.tag.startswith("xacro:")
    }
    called |= {one.attributes.get("macro", "") for one in elements if one.tag == "xacro:call"}
    is_computed = any("$" in name for name in called)
    for element in elements:
        name = element.attributes.get("name", "").removeprefix("xacro:")
        if element.tag != MACRO or element.file != main or is_computed or not name:
            continue
        if name not in called:
            yield UNCALLED_MACRO.at(
                element.file,
                element.line,
                f"{MACRO}[@name='{name}']",
                message=f"The macro `{name}` is never called: its links and joints are not part of "
                "the robot.",
                hint=f"Write <xacro:{name} …/> after its definition, or remove the macro.",
            )
