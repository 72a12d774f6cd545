"""A sensor on a link of the robot, with what bridges its topics and simulates it."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.launch_files import tree_of
from wsgen.descriptions.urdf.lumping import lump
from wsgen.errors import RequestError
from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.sensors import SENSORS, SYSTEM_OF_SENSOR
from wsgen.model.target import CLASSIC
from wsgen.packages.workspace.layout import BUILD_MARKERS, LAUNCH_FILES
from wsgen.porting.adding.opening import OF_FILES
from wsgen.porting.adding.places import Item, insert_above, insert_among, insert_below
from wsgen.porting.adding.robots import bridge_files, read_robot, robot_file
from wsgen.porting.adding.types import check_name
from wsgen.porting.adding.worlds import system_element, worlds_of
from wsgen.porting.bridges import option
from wsgen.porting.ported import BridgeRow
from wsgen.porting.porter import FROM_GAZEBO, Porter
from wsgen.porting.python_edits import PythonEdits
from wsgen.porting.worlds import load_systems
from wsgen.porting.xml_edits import Block, read_nodes
from wsgen.text.files import list_files
from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.checks.fixes.launch_files import Tree
    from wsgen.checks.fixes.source import SourceText
    from wsgen.model.robot import Robot
    from wsgen.porting.adding.addition import Addition
    from wsgen.porting.xml_edits import Node

# Kind -> that of Gazebo Sim.
KINDS = {
    "lidar": "gpu_lidar",
    "camera": "camera",
    "depth": "rgbd_camera",
    "imu": "imu",
    "gps": "navsat",
    "contact": "contact",
}
_OF_ROBOTS = (".gazebo", ".xacro", ".urdf")
_BRIDGED = re.compile(r"@.+[\[\]@](?:gz|ignition)\.msgs\.")
_SHARED = ("lidar", "camera", "imu")  # whose text a package of `wsgen new --from` has, too


_ON_EARTH = "spherical_coordinates"  # without them GPS has no place
_PLACE = (
    ("surface_model", "EARTH_WGS84"),
    ("latitude_deg", "0"),
    ("longitude_deg", "0"),
    ("elevation", "0"),
    ("heading_deg", "0"),
)


class SensorOptions(NamedTuple):
    """What is asked for."""

    kind: str  # a key of KINDS
    link: str
    robot: str | None = None  # a file of the package; None: the only one


def add_sensor(addition: Addition, name: str, options: SensorOptions) -> None:
    """Add a sensor.

    Raises:
        NotFoundError: The robot does not exist.
        RequestError: The link does not exist, or a name cannot be.
    """
    check_name("sensor", name)
    main = robot_file(addition, options.robot)
    text, robot = read_robot(addition, main)
    links = [one.name for one in robot.links] if robot else []
    if options.link not in links:
        raise RequestError(
            f"The robot of {main.name} has no link {options.link}."
            if links
            else f"The robot of {main.name} cannot be read.",
            hint=f"{ask_for_nearest(options.link, links)}Choose one of {some_of(links, 8)}."
            if links
            else f"Fix it first: wsgen check {main}",
        )
    texts = [text, *(addition.require(one).text for one in _files(addition, main))]
    named = re.compile(rf"<sensor\b[^>]*\bname\s*=\s*[\"']{name}[\"']")
    if not any(map(named.search, texts)):
        _mount(addition, main, name, options, _collision(robot, options.link))
    if addition.target.simulator == CLASSIC:
        addition.depend("exec_depend", "gazebo_plugins")
        return
    _bridge(addition, [*_rows(KINDS[options.kind], f"/{name}")])
    addition.depend("exec_depend", "ros_gz_bridge")
    _load(addition, SYSTEM_OF_SENSOR[KINDS[options.kind]])


def _rows(kind: str, own: str) -> Iterator[BridgeRow]:
    """The topics of a sensor, with the same names in ROS."""
    facts = SENSORS[kind]
    start = f"{own}{facts.default}" if facts.has_info else own
    found = [
        (f"{start}{part}", type_) for part, type_ in facts.topics if kind != "gpu_lidar" or not part
    ]
    for topic, gz_type in (
        *found,
        *([(f"{own}/camera_info", "CameraInfo")] if facts.has_info else []),
    ):
        ros_type = PAIRS[gz_type][0].replace("/", "/msg/")
        yield BridgeRow(topic, gz_type, ros_type, FROM_GAZEBO, topic)


def _collision(robot: Robot | None, link: str) -> str:
    """The name that Gazebo gives to the collision of a link that it keeps."""
    lumped = lump(robot)[0] if robot else None
    for one in lumped.links if lumped else ():
        if one.name == link and one.collisions:
            return one.collisions[0].name or f"{link}_collision"
    return f"{link}_collision"


def _mount(
    addition: Addition, main: Path, name: str, options: SensorOptions, collision: str
) -> None:
    """Write the sensor behind others of the robot, or at its end."""
    file, beside = _beside(addition, main)
    simulator = addition.target.simulator
    shared = "existing" if options.kind in _SHARED else "added"
    written = addition.render(
        "sensor",
        sensor={"name": name, "link": options.link, "collision": collision},
        topics="",
        written_in=f"wsgen:{shared}/{simulator}/{options.kind}.xml.j2",
    )
    source = addition.require(file)
    indent = source.indent_at(beside.start if beside.name == "gazebo" else beside.end - 1)
    unit = _unit(source, beside)
    outer = indent if beside.name == "gazebo" else unit
    lines = "\n".join(_indented(line, outer, unit) for line in written.rstrip("\n").split("\n"))
    if beside.name == "gazebo":
        edit = insert_below(source, beside.end, lines)
        if source.text[edit.start :].partition("\n")[0].strip().startswith("</"):
            edit = insert_below(source, beside.end, f"\n{lines}")
    elif beside.tag.end is not None:
        edit = insert_above(source, beside.tag.end.start, lines)
    else:
        edit = None
    where = "Add it to <robot>, above its end."
    if edit is None or not addition.edit(file, [edit]):
        addition.paste(file, written, where)


def _beside(addition: Addition, main: Path) -> tuple[Path, Node]:
    """The file of the robot that has its last sensor outside of macros, or the main one."""
    files = _files(addition, main)
    for wanted in ("sensor", "plugin"):
        for file in sorted(files, key=lambda one: one == main):
            found = [node for node in _top(addition, file) if node.find(wanted) is not None]
            if found:
                return file, found[-1]
    found = _top(addition, main)
    return main, found[-1] if found else read_nodes(addition.require(main))[0]


def _files(addition: Addition, main: Path) -> list[Path]:
    """The main file of a robot, and those that it includes for the simulator of the package.

    What is included on a condition counts if it is of that simulator.
    """
    simulator = addition.target.simulator
    included: dict[str, bool] = {}  # name -> whether on a condition
    for node in read_nodes(addition.require(main)):
        if node.name == "xacro:include":
            included[node.get("filename").rpartition("/")[2]] = bool(node.conditions)
    found = [main]
    for file in list_files(addition.folder, _OF_ROBOTS, markers=BUILD_MARKERS):
        source = addition.source(file)
        if file.name in included and source is not None and file != main:
            of = {name for name, pattern in OF_FILES.items() if pattern.search(source.text)}
            if simulator in of or not (of or included[file.name]):
                found.append(file)
    return found


def _top(addition: Addition, file: Path) -> list[Node]:
    """The <gazebo> elements that are in <robot> itself."""
    source = addition.source(file)
    return [
        node
        for node in (read_nodes(source) if source else ())
        if node.name == "gazebo" and node.parent is not None and node.parent.name == "robot"
    ]


def _unit(source: SourceText, node: Node) -> str:
    for one in (*node.written, *(node.parent.written if node.parent else ())):
        indent, own = source.indent_at(one.start), source.indent_at(node.start)
        if one.parent is node and indent.startswith(own) and indent != own:
            return indent[len(own) :]
    return "  "


def _indented(line: str, outer: str, unit: str) -> str:
    inner = line.lstrip(" ")
    return f"{outer}{unit * ((len(line) - len(inner)) // 2 - 1)}{inner}" if inner else ""


def _bridge(addition: Addition, rows: list[BridgeRow]) -> None:
    """Bridge topics where others are: in a file, or in the arguments of a launch file."""
    for file in bridge_files(addition)[:1]:
        source = addition.require(file)
        new = [row for row in rows if not re.search(rf"{row.gz_topic}\b(?!/)", source.text)]
        if new:
            lines = addition.render("bridge_rows", rows=new).rstrip("\n")
            last = max(0, len(source.text.rstrip()) - 1)
            addition.edit(file, [insert_below(source, last, lines)])
        return
    for tree, listed in _arguments(addition):
        edits = PythonEdits(tree)
        options = [*map(option, rows)]
        missing = [one for one in options if one not in tree.source.text]
        said = [(one, edits.said(one) or "") for one in listed.elts]
        items = [
            Item("", tree.start(one), tree.end(one)) for one, text in said if _BRIDGED.search(text)
        ]
        indent = tree.source.indent_at(items[-1].start)
        lines = f",{tree.source.newline}{indent}".join(map(edits.quoted, missing))
        edit = insert_among(tree.source, items, "", lines, comma=",")
        if not missing or (edit is not None and addition.edit(tree.source.file, [edit])):
            return
        text = "\n".join(f"{edits.quoted(one)}," for one in missing)
        addition.paste(tree.source.file, text, "Add it to the arguments of the bridge.")
        return
    addition.paste(
        addition.folder / "config/bridge.yaml",
        addition.render("bridge_rows", rows=rows).strip("\n"),
        "The package starts no bridge: have parameter_bridge read a file with these lines, by its "
        "parameter `config_file`.",
    )


def _arguments(addition: Addition) -> Iterator[tuple[Tree, ast.List]]:
    """The lists in launch files that name topics of a bridge."""
    for file in sorted(list_files(addition.folder, LAUNCH_FILES, markers=BUILD_MARKERS)):
        source = addition.source(file)
        tree = tree_of(source) if source and file.suffix == ".py" else None
        for node in tree.all(ast.List) if tree else ():
            if tree is not None and any(
                isinstance(one, ast.Constant)
                and isinstance(one.value, str)
                and _BRIDGED.search(one.value)
                for one in node.elts
            ):
                yield tree, node


def _load(addition: Addition, system: str) -> None:
    """Have the worlds load what simulates the sensor."""
    worlds = worlds_of(addition)
    for file in worlds:
        source = addition.require(file)
        port = Porter(source, addition.target)
        for node in port.nodes:
            if node.name == "world":
                load_systems(port, node, {system})
                if system == "NavSat" and node.find(_ON_EARTH) is None:
                    port.editor.append(node, Block(_ON_EARTH, [Block(*one) for one in _PLACE]))
        edits = port.editor.finish()
        if edits and not addition.edit(file, edits):
            worlds = []
    if not worlds:
        addition.paste(
            addition.folder / "worlds",
            system_element(system),
            "The package has no world: have the world that you start load this system.",
        )
