"""What the ports of one file's plugins, sensors and materials share."""

from __future__ import annotations

import re
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.gazebo.bridged_types import PAIRS
from wsgen.gazebo.plugins import PLUGINS, TRUE, GazeboPlugin, stem
from wsgen.gazebo.sensors import SENSORS
from wsgen.gazebo.successors import AS_IN_ROS_2, PARAMETERS_OF_ROS_1
from wsgen.porting.ported import BridgeRow, Effort, FilePort, Unported
from wsgen.porting.topics import Topics, absolute
from wsgen.porting.xml_edits import COMPUTED, Editor, Node, read_nodes

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.model.target import Target

FROM_GAZEBO, TO_GAZEBO = "[", "]"
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_EXPRESSION = re.compile(r"\$\{([^{}]*)\}")
_ARGUMENT = re.compile(r"\$\(arg\s+(\w+)\)")
# What xacro replaces: an expression, or what has no other one in it.
_REPLACED = re.compile(r"\$\{[^{}]*\}|\$\([^()]*\)")
_TWICE = re.compile(r"\s*(?:2(?:\.0*)?\s*\*\s*([\w.]+)|([\w.]+)\s*\*\s*2(?:\.0*)?)\s*")


class Mounted(NamedTuple):
    """A sensor of a robot that a launch file spawns."""

    name: str
    link: str  # that the description puts it on
    carrier: str  # the link that Gazebo has lumped that one into, or the same


class Follower(NamedTuple):
    """What a `<mimic>` says in a URDF."""

    leader: str
    multiplier: str


class Paint(NamedTuple):
    """A material of OGRE, of a script in the workspace."""

    model: str  # the folder that has it
    colors: tuple[tuple[str, str], ...]  # by element
    image: str  # its address; empty without one


class Robots(NamedTuple):
    """What other files, and robots that launch files spawn, say about those of a file."""

    mounted: frozenset[Mounted] = frozenset()
    # Name and file name of the plugins of robots that spawners put into namespaces.
    scoped: frozenset[tuple[str, str]] = frozenset()
    # The wheels that plugins of drives turn, by the names and file names of these.
    wheels: Mapping[tuple[str, str], frozenset[str]] = MappingProxyType({})
    # The namespaces that spawners give to plugins of ros2_control, by their name and parameters.
    managers: Mapping[tuple[str, str], Collection[str]] = MappingProxyType({})
    followers: Mapping[str, Follower] = MappingProxyType({})  # by joint, see `without_computed`
    paints: Mapping[str, list[Paint]] = MappingProxyType({})  # by name
    # What is in `MEASURED` (m) of cars of Gazebo Classic, by their <rear_right_joint>.
    cars: Mapping[str, Sequence[float]] = MappingProxyType({})
    refused: frozenset[str] = frozenset()  # links of URDFs with an inertia that Gazebo Sim refuses


# What `BridgeRow`s have for the names of a robot and its world, and for the namespace that the
# spawner gives to its plugins.
MODEL, WORLD, NAMESPACE = "{model}", "{world}", "{namespace}"


class Porter:
    """The port of a file, as far as it is made."""

    def __init__(
        self,
        source: SourceText,
        target: Target,
        robots: Robots | None = None,
        namespace: str = "",
    ) -> None:
        self.source = source
        self.target = target
        self.robots = robots or Robots()
        self.namespace = namespace
        self.nodes = read_nodes(source)
        self.editor = Editor(source)
        self.unported: list[Unported] = []
        self.packages: set[str] = set()
        self.systems: set[str] = set()
        self.rows: list[BridgeRow] = []
        self.efforts: list[Effort] = []
        self.frames: set[str] = set()

    def finish(self) -> FilePort:
        """What becomes of the file."""
        return FilePort(
            edits=self.editor.finish(),
            unported=tuple(self.unported),
            packages=frozenset(self.packages),
            systems=frozenset(self.systems),
            efforts=tuple(self.efforts),
            frames=frozenset(self.frames),
        )

    def leave(self, node: Node, what: str, advice: str, *, is_note: bool = False) -> None:
        """List what the author has to port; a note is what no robot needs."""
        self.unported.append(Unported(self.source.file, node.line, what, advice, is_note))

    def leave_once(self, node: Node, what: str, advice: str, *, is_note: bool = False) -> None:
        """List what is in many places of the file, at the first of them."""
        if all(one.what != what for one in self.unported):
            self.leave(node, what, advice, is_note=is_note)

    def plugin(self, node: Node) -> ClassicPlugin:
        """A plugin of Gazebo Classic."""
        return ClassicPlugin(node, self.namespace)

    @cached_property
    def is_scoped(self) -> bool:
        """Whether the topics in Gazebo Sim have to be those of one robot alone.

        They are those that have the name of the model in them, because nothing says another one.
        """
        return any(
            values_in(one.get("name"), name) is not None
            and values_in(one.get("filename"), filename) is not None
            for name, filename in self.robots.scoped
            for one in self.nodes
            if one.name == "plugin"
        )

    def own_topic(self, node: Node, pattern: str) -> str:
        """The topic that Gazebo Sim has for what is in a model, where nothing names it."""
        models = [one for one in node.ancestors() if one.name == "model"]
        is_known = bool(models) and models[-1].is_in("world")
        return pattern.replace(MODEL, models[-1].get("name")) if is_known else pattern

    def topic_of_sensor(self, node: Node, kind: str, place: str, name: str) -> str:
        """The same of a sensor."""
        ending = SENSORS[kind].default if kind in SENSORS else ""
        pattern = f"/world/{WORLD}/model/{MODEL}/{place}/sensor/{name}{ending}"
        return self.own_topic(node, pattern)

    def bridge(
        self,
        gz_topic: str,
        gz_type: str,
        ros_topic: str,
        *,
        ros_type: str = "",
        way: str = FROM_GAZEBO,
    ) -> None:
        """Have a topic converted, to the usual type of ROS unless another is given."""
        package, _, name = (ros_type or PAIRS[gz_type][0]).partition("/")
        row = BridgeRow(
            absolute(gz_topic), gz_type, f"{package}/msg/{name}", way, absolute(ros_topic)
        )
        if row not in self.rows:
            self.rows.append(row)


class ClassicPlugin:
    """A plugin of Gazebo Classic, with its parameters as ROS 2 names them."""

    def __init__(self, node: Node, namespace: str = "") -> None:
        self.node = node
        self.filename = node.get("filename")
        self.own_stem = stem(self.filename)
        self.stem = AS_IN_ROS_2.get(self.own_stem, self.own_stem)
        self.facts = PLUGINS.get(self.stem, GazeboPlugin())
        self.topics = Topics(node, namespace)
        is_named_so = self.own_stem in AS_IN_ROS_2 and node.find("ros") is None
        self.is_of_ros_1 = is_named_so or self._lacks_names_of_ros_2()

    def _lacks_names_of_ros_2(self) -> bool:
        """Whether it has what a plugin cannot do without only under the names of ROS 1."""
        names = {child.name for child in self.node.children()}
        required = set(self.facts.required)
        return bool(required) and not required & names and required <= set(map(_ros_2_name, names))

    def parameters(self) -> Iterator[tuple[str, Node]]:
        """Its parameters, in their order, with the names that they have in ROS 2."""
        for child in self.node.children():
            yield _ros_2_name(child.name) if self.is_of_ros_1 else child.name, child

    def all(self, name: str) -> list[Node]:
        """All elements of a parameter."""
        return [node for known, node in self.parameters() if known == name]

    def find(self, name: str) -> Node | None:
        """The first element of a parameter."""
        return next(iter(self.all(name)), None)

    def value(self, name: str, default: str = "") -> str:
        """The text of a parameter, or its default."""
        found = self.find(name)
        return (found.text if found is not None else "") or default

    def default(self, name: str) -> str:
        """The default of a parameter as it is written."""
        known = self.facts.parameters.get(name)
        if isinstance(known, tuple):
            return " ".join(f"{one:g}" for one in known)
        return f"{known:g}" if isinstance(known, float) else str("" if known is None else known)

    def holds(self, name: str) -> bool:
        """Whether a parameter is true, or may be."""
        text = self.value(name)
        if COMPUTED in text:
            return True
        return text.lower() in TRUE if text else bool(self.facts.parameters.get(name))


def _ros_2_name(name: str) -> str:
    found = PARAMETERS_OF_ROS_1.get(name)
    return found or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def values_in(text: str, name: str) -> tuple[str, ...] | None:
    """What xacro has put into a text to make this name of it; None if it did not."""
    pattern = "(.*)".join(map(re.escape, _REPLACED.split(text)))
    found = re.fullmatch(pattern, name)
    return None if found is None else found.groups()


def without_computed(text: str) -> str:
    """A name without what xacro computes of it: what parts of a robot in several files share."""
    return _REPLACED.sub("", text)


def number(text: str) -> float | None:
    """The number that a text is, if xacro does not compute it."""
    return float(text) if _NUMBER.fullmatch(text) else None


def written(value: float) -> str:
    """A number as people write it."""
    return f"{value + 0.0:.10g}"


def _term(text: str) -> str | None:
    """A text as a part of an expression of xacro; None where it cannot be one."""
    if _NUMBER.fullmatch(text):
        return text
    expression, argument = _EXPRESSION.fullmatch(text), _ARGUMENT.fullmatch(text)
    if argument is not None:
        return f"float(xacro.arg('{argument[1]}'))"
    if expression is None or not expression[1].strip():
        return None
    inner = expression[1].strip()
    return inner if re.fullmatch(r"[\w.]+", inner) else f"({inner})"


def product(factor: int, text: str, divisor: str = "1") -> str | None:
    """A number times a parameter, divided by another one; None where one is not plain."""
    value, below = number(text), number(divisor)
    if value is not None and below:
        return written(factor * value / below)
    top, bottom = _term(text), _term(divisor)
    if top is None or bottom is None or below == 0:
        return None
    if value is not None:
        above = written(factor * value)
    else:
        above = f"-{top}" if factor == -1 else f"{factor}*{top}"
    return f"${{{above}}}" if below == 1 else f"${{{above}/{bottom}}}"


def half(text: str) -> str | None:
    """Half of a number, or of what xacro computes; None where that is not plain."""
    value = number(text)
    if value is not None:
        return written(value / 2)
    expression = _EXPRESSION.fullmatch(text)
    twice = _TWICE.fullmatch(expression[1]) if expression else None
    if twice is not None:
        return f"${{{twice[1] or twice[2]}}}"
    inner = _term(text)
    return None if inner is None else f"${{{inner}/2}}"


def carrier_of(port: Porter, sensor: Node) -> str:
    """The link that has a sensor in Gazebo Classic, which lumps links that fixed joints join.

    It is written with what xacro computes of the link that the sensor is on. An empty text where
    the text does not show it.
    """
    link = link_of(sensor)
    found = set()
    for one in port.robots.mounted:
        values = values_in(link, one.link)
        if values is None or values_in(sensor.get("name"), one.name) is None:
            continue
        expression = _REPLACED.match(link)
        if one.link == one.carrier:
            found.add(link)
        elif expression is not None and one.carrier.startswith(values[0]):
            found.add(f"{expression[0]}{one.carrier.removeprefix(values[0])}")
        else:
            found.add(one.carrier)
    if len(found) > 1:
        port.leave_once(
            sensor,
            f"The frame of the messages of `{sensor.get('name')}` was "
            f"{' or '.join(sorted(found))}: robots differ.",
            f"Write it into <{port.target.frame_tag}>.",
        )
    return found.pop() if len(found) == 1 else link


def link_of(node: Node) -> str:
    """The link that a sensor is on; an empty text where the text does not show it."""
    for around in node.ancestors():
        if around.name == "gazebo":
            return around.get("reference")
        if around.name == "link":
            return around.get("name")
    return ""
