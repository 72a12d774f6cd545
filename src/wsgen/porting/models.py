"""Robots and models for Gazebo Classic, as Gazebo Sim reads them: URDF, xacro and SDF."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import SourceText
from wsgen.descriptions.sdf.bodies import DEFAULT_INERTIAL, MOMENTS
from wsgen.descriptions.sdf.textures import image_in, read_script
from wsgen.gazebo.plugins import TWO_WHEELS, stem
from wsgen.gazebo.successors import SPECULARS, TEXTURED
from wsgen.model.facts import ROS2_CONTROL_HARDWARE
from wsgen.model.inertia import LEAST_MOMENT, is_positive_definite, is_possible, made_possible
from wsgen.model.robot import GAZEBO_AMBIENTS, GAZEBO_COLORS
from wsgen.model.target import CLASSIC
from wsgen.packages.workspace.layout import BUILD_MARKERS
from wsgen.porting.plugins import port_plugin
from wsgen.porting.porter import (
    ClassicPlugin,
    Follower,
    Paint,
    Porter,
    number,
    values_in,
    without_computed,
    written,
)
from wsgen.porting.sensors import goes_with_sensor, port_sensor
from wsgen.porting.xml_edits import COMPUTED, Block, read_nodes
from wsgen.text.files import list_files

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.model.inertia import Six
    from wsgen.model.target import Target
    from wsgen.porting.ported import BridgeRow, FilePort
    from wsgen.porting.porter import Robots
    from wsgen.porting.xml_edits import Node

_ELSEWHERE = ("world", "gui", "actor")  # whose own plugins are not those of models
_NOT_READ = ("road", "population", "state")  # by Gazebo Sim, whatever is in them
# That of Gazebo Classic, and that of Fortress, which Jazzy and later do not have.
_HARDWARE = rf"{re.escape(ROS2_CONTROL_HARDWARE[CLASSIC][1])}|ign_ros2_control/IgnitionSystem"
_COMMENT_OR_HARDWARE = re.compile(rf"<!--.*?(?:-->|\Z)|\b({_HARDWARE})\b", re.DOTALL)
_SPECULAR = 0.1
_FLAT = "0.001"  # the scale of a mesh along an axis where it had none
_DIAGONAL = (0, 3, 5)  # of six numbers of an inertia
# The colors of OGRE that materials of SDF have, with those of a material that says nothing.
_OGRE = {"ambient": "1 1 1 1", "diffuse": "1 1 1 1", "specular": "0 0 0 1", "emissive": ""}


def port_model(source: SourceText, target: Target, robots: Robots | None = None) -> FilePort:
    """Port what a text has of robots and models; of a world, what is in its models."""
    return _port(source, target, robots).finish()


def find_followers(text: str) -> Iterator[tuple[str, Follower]]:
    """The joints of a URDF or xacro that mimic another one."""
    for node in read_nodes(SourceText(Path("robot"), text)) if "<mimic" in text else ():
        mimic = node.find("mimic") if node.name == "joint" else None
        if mimic is not None:
            follower = Follower(mimic.get("joint"), mimic.get("multiplier"))
            yield without_computed(node.get("name")), follower


def find_paints(package: str, folder: Path) -> Iterator[tuple[str, Paint]]:
    """The materials in the scripts of a package, by name, as Gazebo Sim has them."""
    for script in list_files(folder, (".material",), markers=BUILD_MARKERS):
        models = (one for one in script.parents if (one / "model.config").is_file())
        model = next(models, folder)
        name = package if model == folder else model.name
        for material, text in read_script(script):
            image = image_in(text)
            places = (script.parent.parent / "textures", script.parent, model)
            files = (place / image for place in places if image)
            file = next((one for one in files if one.is_file()), None)
            address = file and f"model://{name}/{file.relative_to(model).as_posix()}"
            yield material, Paint(name, tuple(_ogre_colors(text)), address or "")


def _ogre_colors(text: str) -> Iterator[tuple[str, str]]:
    for name, default in _OGRE.items():
        numbers = r"\s+([\d.]+)" * 3
        found = re.search(rf"(?<!\S){name}{numbers}", text)
        if found is not None or default:
            yield name, f"{' '.join(found.groups())} 1" if found else default


def bridge_rows(
    text: str, target: Target, robots: Robots | None = None, *, namespace: str = ""
) -> list[BridgeRow]:
    """The topics of ROS that a robot has for Gazebo Classic, and will have by a bridge.

    Args:
        text: The robot or model as Gazebo gets it: xacro has computed everything.
        target: For what it is ported.
        robots: What launch files say about it.
        namespace: That the spawner gives to its plugins.
    """
    if "<plugin" not in text and "<sensor" not in text:
        return []
    return _port(SourceText(Path("robot"), text), target, robots, namespace).rows


def plugins_of(text: str) -> Iterator[tuple[str, str]]:
    """The names of the plugins of a robot, with their file names."""
    for node in read_nodes(SourceText(Path("robot"), text)) if "<plugin" in text else ():
        if node.name == "plugin" and node.get("filename"):
            yield node.get("name"), node.get("filename")


def wheels_of(text: str) -> Iterator[tuple[tuple[str, str], frozenset[str]]]:
    """The joints of the wheels of plugins, by the names and file names of these."""
    for node in read_nodes(SourceText(Path("robot"), text)) if "<plugin" in text else ():
        if node.name == "plugin":
            plugin = ClassicPlugin(node)
            joints = frozenset(one.text for tag in TWO_WHEELS for one in plugin.all(tag))
            if joints:
                yield (node.get("name"), plugin.filename), joints


def managers_of(text: str) -> Iterator[tuple[str, str]]:
    """The names of the plugins of ros2_control of a robot, with the files of their parameters."""
    for node in read_nodes(SourceText(Path("robot"), text)) if "<ros2_control" in text else ():
        if node.name == "plugin" and stem(node.get("filename")) == "gazebo_ros2_control":
            yield node.get("name"), node.value("parameters")


def _port(
    source: SourceText, target: Target, robots: Robots | None = None, namespace: str = ""
) -> Porter:
    port = Porter(source, target, robots, namespace)
    for node in port.nodes:
        if node.is_in(*_NOT_READ):
            continue
        if node.name == "sensor":
            port_sensor(port, node)
        elif node.name == "plugin" and node.get("filename") and not goes_with_sensor(node):
            holder = node.holder
            if holder is None or holder.name not in _ELSEWHERE:
                port_plugin(port, node)
        elif node.name in _ALONE:
            _ALONE[node.name](port, node)
    for found in _COMMENT_OR_HARDWARE.finditer(source.text):
        if found[1]:
            port.editor.write(*found.span(1), target.ros2_control_hardware)
            port.packages.add(target.ros2_control_hardware.partition("/")[0])
    return port


def _port_inertia(port: Porter, node: Node) -> None:
    """Have a link be as in Gazebo Classic, with an inertia that Gazebo Sim takes.

    Of a URDF, that of links which are fixed together is their sum: only those that Gazebo refuses
    are changed.
    """
    link = next((one for one in node.ancestors() if one.name == "link"), None)
    if link is None or node.parent is None:
        return
    is_sdf = node.is_in("sdf")
    refused = port.robots.refused
    if not is_sdf and all(values_in(link.get("name"), one) is None for one in refused):
        return
    usual = dict(zip(MOMENTS, map(written, DEFAULT_INERTIAL.inertia), strict=True))
    texts = {
        name: (node.value(name) or usual[name]) if is_sdf else node.get(name) for name in MOMENTS
    }
    six = tuple(map(number, texts.values()))
    what = f"No body can have the inertia of the link `{link.get('name')}`, and Gazebo Sim refuses"
    if None in six:
        if not is_sdf:
            advice = "Compute it from mass and shape, so that no moment exceeds the other two."
            port.leave_once(node, f"{what} the robot.", advice)
        return
    mass = node.parent.value("mass")
    if not is_sdf:
        weight = node.parent.find("mass")
        mass = weight.get("value") if weight is not None else ""
    kept = _near(six)  # type: ignore[arg-type]
    if kept == six or number(mass or "1") == 0:
        return
    for name, value in zip(MOMENTS, kept, strict=True):
        text = written(value)
        if float(text) != number(texts[name]):
            if is_sdf:
                port.editor.put(node, name, text)
            else:
                port.editor.set_attribute(node, name, text)
    moments = ", ".join(written(kept[one]) for one in _DIAGONAL)
    port.leave(
        node,
        f"{what} it: its moments are now {moments} kg m².",
        "Compute it from mass and shape.",
        is_note=True,
    )


def _port_scale(port: Porter, node: Node) -> None:
    """Have a mesh that is flat be a little thick: Gazebo Sim refuses a size of 0."""
    is_sdf = node.name == "scale"
    texts = (node.text if is_sdf else node.get("scale")).split()
    if all(number(one) != 0 for one in texts) or (is_sdf and not node.is_in("mesh")):
        return
    scale = " ".join(_FLAT if number(one) == 0 else one for one in texts)
    if is_sdf:
        port.editor.set_text(node, scale)
    else:
        port.editor.set_attribute(node, "scale", scale)
    port.leave(
        node,
        f"The mesh had a size of 0, which Gazebo Sim refuses: its scale is {scale} now.",
        "Give it the scale that is meant.",
        is_note=True,
    )


def _near(six: Six) -> Six:
    """The inertia itself, or one that a body can have and Gazebo Classic simulates in its place.

    The largest moment stays where the axes are those of the link: wheels turn about it.
    """
    if is_possible(six):
        return six
    if not is_positive_definite(six):
        return DEFAULT_INERTIAL.inertia
    xx, xy, xz, yy, yz, zz = six
    if any((xy, xz, yz)):
        return made_possible(six)
    low, middle, high = sorted((xx, yy, zz))
    more = (high * (1 + LEAST_MOMENT) - low - middle) / 2
    raised = [one if one == high else one + more for one in (xx, yy, zz)]
    return (raised[0], 0.0, 0.0, raised[1], 0.0, raised[2])


def _port_follower(port: Porter, joint: Node) -> None:
    """Have a joint follow another one in `<ros2_control>` where it does in Gazebo Classic.

    There a parameter says so, and the <mimic> of the URDF does nothing; in Gazebo Sim that counts,
    and ros2_control refuses commands for such a joint. Source: gazebo_system.cpp (Humble),
    hardware_interface's component_parser.cpp and gz_system.cpp (Jazzy).
    """
    written = {one.get("name"): one for one in joint.children("param")}
    said = [written[name] for name in ("mimic", "multiplier") if name in written]
    leader = written["mimic"].text if "mimic" in written else ""
    factor = written["multiplier"].text if "multiplier" in written else "1"
    name = without_computed(joint.get("name"))
    known = port.robots.followers.get(name)
    commands = [*joint.children("command_interface")]
    if joint.get("mimic") or not (leader or known) or not joint.is_in("ros2_control"):
        return
    if known is not None and not leader:
        others = next(one for one in joint.ancestors() if one.name == "ros2_control")
        names = {without_computed(one.get("name")) for one in others.children("joint")}
        if commands or without_computed(known.leader) not in names:
            port.editor.set_attribute(joint, "mimic", "false")
        return
    if known is None:
        joints = (one for one in port.nodes if one.name == "joint" and one.is_in("robot"))
        own = (one for one in joints if without_computed(one.get("name")) == name)
        described = next((one for one in own if not one.is_in("ros2_control")), None)
        if described is None:
            port.leave(
                joint,
                f"It followed `{leader}` as ros2_control says; in Gazebo Sim the URDF says it.",
                f'Write <mimic joint="{leader}" multiplier="{factor}"/> into its <joint> there.',
            )
            return
        port.editor.append(described, Block("mimic", (), f'joint="{leader}" multiplier="{factor}"'))
    elif number(factor) != number(known.multiplier or "1"):
        port.leave(
            joint,
            f"It followed `{leader}` by the factor {factor}; in Gazebo Sim that of <mimic> counts.",
            "Write the factor into the <mimic> of the URDF.",
        )
    for one in (*commands, *said):
        port.editor.remove(one)


def _port_material(port: Porter, material: Node) -> None:
    """Write the colors of a material of Gazebo Classic."""
    holder = material.holder
    script = material.find("script")
    if holder is not None and holder.name == "gazebo" and not material.written:
        if COMPUTED in material.text:
            port.leave(
                material,
                f"xacro computes the name of the material: `{material.text}`.",
                "Write <visual><material> with <ambient> and <diffuse>.",
                is_note=True,
            )
            return
        blocks = _colors(port, material, material.text)
        visual = holder.find("visual")
        if not blocks:
            port.editor.remove(material)
        elif visual is None:
            port.editor.replace(material, [Block("visual", [Block("material", blocks)])])
        else:
            if visual.find("material") is None:
                port.editor.append(visual, Block("material", blocks))
            port.editor.remove(material)
    elif script is not None:
        name = script.value("name")
        if COMPUTED in name:
            port.leave(
                script,
                f"xacro computes the name of the material: `{name}`.",
                "Write <ambient> and <diffuse>.",
                is_note=True,
            )
            return
        blocks = _colors(port, script, name)
        if blocks:
            missing = [one for one in blocks if material.find(one.name) is None]
            if missing:
                port.editor.replace(script, missing)
            else:
                port.editor.remove(script)
        else:
            port.editor.comment_out(script)


_ALONE: dict[str, Callable[[Porter, Node], None]] = {
    "material": _port_material,
    "joint": _port_follower,
    "inertia": _port_inertia,
    "mesh": _port_scale,
    "scale": _port_scale,
}


def _colors(port: Porter, node: Node, name: str) -> list[Block]:
    """What Gazebo Sim has instead of the name of a material; nothing if only its author knows."""
    paints = port.robots.paints.get(name, ()) if name not in GAZEBO_COLORS else ()
    if paints:
        addresses = " ".join(one.text for one in node.children("uri"))
        paint = next((one for one in paints if f"/{one.model}/" in addresses), paints[0])
        blocks = [Block(*one) for one in paint.colors]
        image = Block("metal", [Block("albedo_map", paint.image)])
        return [*blocks, Block("pbr", [image])] if paint.image else blocks
    if name not in GAZEBO_COLORS:
        port.leave_once(
            node,
            f"Gazebo Sim does not read the script of the material `{name}`.",
            "Write its colors into <ambient> and <diffuse>, and a texture into <pbr>.",
            is_note=True,
        )
        return []
    if name in TEXTURED:
        port.leave_once(
            node,
            f"The texture of `{name}` does not exist in Gazebo Sim; the color is like it.",
            "Write a texture into <pbr> if you need one.",
            is_note=True,
        )
    return colors(name)


def colors(name: str) -> list[Block]:
    """The colors of a material that Gazebo Classic ships."""
    diffuse, specular = GAZEBO_COLORS[name], SPECULARS.get(name, _SPECULAR)
    blocks = [
        Block("ambient", _rgba(*GAZEBO_AMBIENTS.get(name, diffuse))),
        Block("diffuse", _rgba(*diffuse)),
        Block("specular", _rgba(specular, specular, specular, 1.0)),
    ]
    return [*blocks, Block("emissive", _rgba(*diffuse))] if name.endswith("Glow") else blocks


def _rgba(*values: float) -> str:
    return " ".join(f"{value:g}" for value in values)
