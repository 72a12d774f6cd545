"""Rules about the files of a robot: URDF and xacro, materials, addresses of meshes.

The parameters of a check are the elements as they are written, and other facts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.descriptions.meshes.lookup import ON_WINDOWS, address_in_package
from wsgen.diagnostics import Rule, Severity
from wsgen.model.robot import GAZEBO_COLORS
from wsgen.text.suggestions import some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Link
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


# The distributions whose Gazebo Sim does not know names such as Gazebo/Red.
WITHOUT_COLOR_NAMES = ("humble", "iron")
OGRE_MATERIAL = Rule(
    code="ROB125",
    name="ogre-material",
    severity=Severity.INFO,
    summary="A robot for Gazebo Sim uses an Ogre material script.",
    what="Looks for `<material>` in `<gazebo>` elements of links whose visuals do not have a "
    "color. The names `Gazebo/NAME` are reported only for Humble and Iron: later releases know "
    "them as colors.",
    why="Gazebo Sim does not read Ogre material scripts, and draws the link in white or gray.",
    example='<gazebo reference="base_link">\n  <material>Gazebo/Red</material>\n</gazebo>',
    instead="""
<link name="base_link">
  <visual>
    <geometry>…</geometry>
    <material name="red"><color rgba="1 0 0 1"/></material>
  </visual>
</link>
""",
)
# Where sdformat has the name of a script: its own key, and that of SDF which it copies.
_SCRIPTS = ("material", "visual/material/script/name")
_COLORS = ("visual/material/ambient", "visual/material/diffuse", "visual/material/pbr")


def ogre_materials(
    links: Iterable[Link],
    tags: Iterable[GazeboTag],
    file: Path | None,
    *,
    simulator: str | None,
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report material scripts in a robot for Gazebo Sim, each once."""
    if simulator != "gz":
        return
    tags = tuple(tags)
    colored = {tag.reference for tag in tags if any(key.startswith(_COLORS) for key in tag.values)}
    plain = {
        link.name
        for link in links
        if any(visual.rgba is None and visual.texture is None for visual in link.visuals)
        and link.is_as_meant
    }
    uses: dict[str, list[tuple[GazeboTag, str]]] = {}
    for tag in tags:
        key = next((key for key in _SCRIPTS if tag.values.get(key)), None)
        if key is None or tag.reference not in plain or tag.reference in colored:
            continue
        if _is_script(tag.values[key], distro):
            uses.setdefault(tag.values[key], []).append((tag, key))
    for name, places in uses.items():
        tag, key = places[0]
        about = list(dict.fromkeys(f"`{one.reference}`" for one, _ in places))
        yield OGRE_MATERIAL.at(
            file,
            tag.line,
            f"gazebo[@reference='{tag.reference}']/{key}",
            message=f"Gazebo Sim does not read the material script `{name}`: it draws "
            f"{some_of(about)} in white or gray.",
            hint=f"Write in each <visual> of {some_of(about)}: {_instead(name)}",
        )


def _is_script(name: str, distro: str | None) -> bool:
    """Whether Gazebo Sim does not know the name; one that no Gazebo knows is reported as such."""
    if "$" in name:
        return False  # not resolved
    if name.startswith("Gazebo/"):
        return distro in WITHOUT_COLOR_NAMES and name in GAZEBO_COLORS
    return True


def _instead(name: str) -> str:
    """The color of a URDF that is meant."""
    word = name.rpartition("/")[2]
    rgba = GAZEBO_COLORS.get(f"Gazebo/{word}")
    numbers = "R G B 1" if rgba is None else " ".join(f"{part:g}" for part in rgba)
    return f'<material name="{word.lower()}"><color rgba="{numbers}"/></material>'


RELATIVE_ADDRESS = Rule(
    code="ROB126",
    name="relative-mesh-address",
    severity=Severity.WARNING,
    summary="A robot that `robot_state_publisher` publishes has a mesh with a relative path.",
    what="In the robot that a launch file gives to `robot_state_publisher`, looks for mesh paths "
    "without a scheme that are relative to the file of the robot.",
    why="`robot_state_publisher` publishes the text of the robot, but not the path of its file. "
    "RViz, and Gazebo when it spawns from the topic, do not find the mesh and draw nothing.",
    example='<mesh filename="../meshes/base.stl"/>',
    instead='<mesh filename="package://my_robot/meshes/base.stl"/>',
)
MODEL_ADDRESS_IN_RVIZ = Rule(
    code="ROB127",
    name="model-address-in-rviz",
    severity=Severity.WARNING,
    summary="RViz does not draw meshes with `model://` addresses.",
    what="Looks for `model://` meshes in the robot that a launch file gives to "
    "`robot_state_publisher`, if the launch file also starts rviz2.",
    why="RViz supports `package://`, `file://` and `http://` addresses; `model://` is an address "
    "for Gazebo. RViz draws the robot without these meshes. Gazebo also supports `package://`.",
    example='<mesh filename="model://my_robot/meshes/base.stl"/>',
    instead='<mesh filename="package://my_robot/meshes/base.stl"/>',
)

RVIZ = "rviz2"  # the program
_MESH = lazy_pattern(r"<mesh\b[^>]*?\bfilename\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")


def mesh_addresses(text: str) -> tuple[str, ...]:
    """The addresses of meshes in a URDF, each once."""
    found = (match[1] or match[2] or "" for match in _MESH.finditer(text))
    return tuple(dict.fromkeys(one.strip() for one in found if one.strip()))


def relative_addresses(
    addresses: Iterable[str], file: Path, written: Sequence[Written]
) -> Iterator[Diagnostic]:
    """Report relative paths of a published robot; those without a file are reported anyway.

    Args:
        addresses: Of the meshes of the robot.
        file: The one that the robot is in, or is expanded from.
        written: The elements of that file, and of those that it includes.
    """
    for address in addresses:
        if "://" in address or address.startswith("/") or ON_WINDOWS.match(address):
            continue
        mesh = file.parent / address
        if not mesh.is_file():
            continue
        place, line = _place(address, file, written)
        own = address_in_package(mesh.name, mesh.parent)
        yield RELATIVE_ADDRESS.at(
            place,
            line,
            f"mesh[@filename='{address}']",
            message=f"The mesh `{address}` has a relative path, but robot_state_publisher "
            "publishes the robot without its folder: neither RViz nor Gazebo finds the file.",
            hint=f"Write {own or 'package://PACKAGE/' + mesh.name}",
        )


def model_addresses(
    addresses: Iterable[str], file: Path, written: Sequence[Written]
) -> Iterator[Diagnostic]:
    """Report `model://` addresses of a robot that RViz shows."""
    for address in addresses:
        if not address.startswith("model://"):
            continue
        place, line = _place(address, file, written)
        yield MODEL_ADDRESS_IN_RVIZ.at(
            place,
            line,
            f"mesh[@filename='{address}']",
            message=f"RViz does not find model:// addresses and does not draw `{address}`.",
            hint=f"Write package://{address.removeprefix('model://')}",
        )


def _place(address: str, file: Path, written: Sequence[Written]) -> tuple[Path, int | None]:
    """Where an address is written; it may be computed there, but for the name of its file."""
    name = f"/{address.rpartition('/')[2]}"
    meshes = [
        (one, one.attributes.get("filename", "").strip()) for one in written if one.tag == "mesh"
    ]
    same = [one for one, filename in meshes if filename == address]
    alike = [one for one, filename in meshes if filename.endswith(name)]
    for element in (*same, *alike):
        return element.file, element.line_of("filename")
    return file, None
