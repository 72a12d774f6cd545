"""The port of a launch file of ROS 1 while it is made: its package, what it includes, its calls."""

from __future__ import annotations

import re
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.dependencies import OF_ROS_1
from wsgen.gazebo.systems import EMPTY_WORLD
from wsgen.model.facts import PROGRAMS as OF_SIMULATORS
from wsgen.model.target import SIM
from wsgen.porting.existing.launch_values import (
    Item,
    Tree,
    UnsaidError,
    Values,
    mapped,
)
from wsgen.porting.existing.parameters_of_ros1 import files_in
from wsgen.porting.launch_files import DEFAULT_WORLDS
from wsgen.porting.ported import Unported
from wsgen.ros import ros1
from wsgen.ros.names import released_packages
from wsgen.text.markup import elements, read_text
from wsgen.text.xmltree import Malformed
from wsgen.text.xmltree import parse as parse_xml

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.model.target import Target
    from wsgen.porting.existing.launch_values import Code
    from wsgen.text.xmltree import Element

    Given = Mapping[str, str]  # the attributes of an element

ENDINGS = (".launch.xml", ".launch", ".xml")  # of launch files of ROS 1
_OF_ROS_2 = re.compile(
    r"\$\((?:var|find-pkg-share|find-exec|find-pkg-prefix|not|and|or|equals)\b"
    r"|<(?:let|executable|set_env|set_parameter|push_ros_namespace|push-ros-namespace|set_remap"
    r"|node_container|composable_node|load_composable_node|timer|on_exit|shutdown|log)\b"
    r"|<(?:node|test)\b[^>]*\sexec="
)
FIND = re.compile(r"\$\(find\s+([\w-]+)\)/*(.*)", re.DOTALL)
ARGUMENT = re.compile(r"\$\(arg\s+(\S+?)\s*\)")
HERE = re.compile(r"\$\(dirname\)/*(.*)", re.DOTALL)
_SETTINGS = frozenset(("launch", "arg", "param", "rosparam", "group", "include"))
_DEEPEST = 20  # launch files that include each other
PUBLISHER = "robot_state_publisher"
ALWAYS = frozenset(("launch", "launch_ros", "ros2launch"))  # packages that every launch file needs


class Source(NamedTuple):
    """The package of a launch file, and what it becomes."""

    folder: Path  # of the package of ROS 1
    old: str  # its name there
    name: str  # its name in ROS 2
    target: Target
    siblings: Mapping[str, Path] = {}  # other packages of ROS 1 that are ported, too: their folders
    default_world: str | None = None  # file of the package; None: Gazebo's own
    bridge: str | None = None  # file of the package with what is bridged; None: only the clock
    controllers: Mapping[str, str] = {}  # that the package has now: name in ROS 1 -> in ROS 2
    controllers_file: str = ""  # file of the package with them
    systems: frozenset[str] = frozenset()  # of Gazebo Sim, that worlds must load for the robot
    moved: Mapping[str, str] = {}  # files of the package that are elsewhere now, by path
    robot: str = ""  # file of the package with the robot
    model: str = ""  # file of xacro that has it now, with what the simulator needs besides
    entity: str = ""  # what the simulator calls it, so that its topics are those of the bridge
    rviz: str | None = None  # file of the package with what RViz shows, where the named one lacks


class PortedLaunch(NamedTuple):
    """What a launch file becomes."""

    text: str | None  # Python; None: it is of ROS 2, or cannot be read
    packages: frozenset[str] = frozenset()  # that it needs
    notes: tuple[Unported, ...] = ()
    files: Mapping[str, str] = {}  # others of the package, by path, whose text changes with it
    used: frozenset[str] = frozenset()  # programs of the package, by path, that it starts


class Facts(NamedTuple):
    """What a launch file does to one that includes it."""

    has_publisher: bool = False  # starts robot_state_publisher
    sets: bool = False  # parameters
    only_sets: bool = False
    unpauses: bool = False  # the simulator, when the robot is there


def is_of_ros_1(text: str) -> bool:
    """Whether the XML of a launch file is that of ROS 1."""
    return "<launch" in text and _OF_ROS_2.search(text) is None


def ported_name(path: str) -> str:
    """What the launch file is called in ROS 2."""
    ending = next((one for one in ENDINGS if path.endswith(one)), "")
    return f"{path.removesuffix(ending)}.launch.py"


def tags(element: Element) -> list[Element]:
    """The elements in another one."""
    return [one for one in element if isinstance(one.tag, str)]


def attributes(element: Element) -> dict[str, str]:
    """The attributes of an element, as texts."""
    return {str(key): str(value) for key, value in element.attrib.items()}


def is_outside(element: Element) -> bool:
    """Whether an element is in no node."""
    parent = element.getparent()
    return parent is not None and parent.tag in {"launch", "group"}


def unpauses(root: Element) -> bool:
    """Whether a spawner of a launch file starts the simulator."""
    return any("-unpause" in one.get("args", "").split() for one in root.iter("node"))


def facts_of(file: Path, source: Source, depth: int = 0) -> Facts:
    """What a launch file of the package does, and those that it includes."""
    text = read_text(file) if depth < _DEEPEST else None
    root = parse_xml(text) if text is not None else None
    if root is None or isinstance(root, Malformed) or root.tag != "launch":
        return Facts()
    paths = [included(one, file, source) for one in root.iter("include")]
    inner = [Facts() if one is None else facts_of(one, source, depth + 1) for one in paths]
    kinds = {str(one.tag) for one in root.iter() if isinstance(one.tag, str)}
    parameters = root.iter("param", "rosparam")
    publishers = (one.get("pkg") == PUBLISHER for one in root.iter("node"))
    return Facts(
        any(publishers) or any(one.has_publisher for one in inner),
        any(map(is_outside, parameters)) or any(one.sets for one in inner),
        kinds <= _SETTINGS and all(one.only_sets for one in inner),
        unpauses(root) or any(one.unpauses for one in inner),
    )


def named_file(element: Element) -> str:
    """The file that an element includes; where an argument names it, that of its default."""
    text = (element.get("file") or "").strip()
    name = ARGUMENT.fullmatch(text)
    arguments = element.getroottree().getroot().iter("arg") if name is not None else ()
    defaults = [one.get("default", "") for one in arguments if name and one.get("name") == name[1]]
    return defaults[0] if defaults else text


def included(element: Element, file: Path, source: Source) -> Path | None:
    """The launch file of this package, or of one beside it, that an element includes."""
    text = named_file(element)
    found, here = FIND.fullmatch(text), HERE.fullmatch(text)
    if here is not None:
        path = file.parent / here[1]
    elif found is not None and found[1] in {source.old, *source.siblings}:
        path = {source.old: source.folder, **source.siblings}[found[1]] / found[2]
    else:
        return None
    return path if path.is_file() else None


class Action(NamedTuple):
    """What a launch file does."""

    code: Code
    name: str = "action"  # of a variable for it
    is_setting: bool = False  # sets something for those that come later
    outlives: bool = False  # sets parameters, which in ROS 1 stay when a group ends
    comments: tuple[str, ...] = ()


class LaunchPort:
    """The port of a launch file, as far as it is made."""

    def __init__(self, file: Path, text: str, root: Element, source: Source) -> None:
        self.file, self.text, self.root, self.source = file, text, root, source
        programs = OF_SIMULATORS[source.target.simulator]
        self.sim = {role: name for role, (_, name) in programs.items()}
        self.notes: list[Unported] = []
        self.packages = set(ALWAYS)
        self.files: dict[str, str] = {}
        self.used: set[str] = set()
        tags = (one for one in root.iter() if isinstance(one.tag, str))
        self.written = dict(zip(tags, elements(file, text), strict=False))
        declared = {
            name: one.get("default", one.get("value"))
            for one in root.iter("arg")
            if is_outside(one) and (name := one.get("name"))
        }
        self.values = Values(declared, self._package, self._place, source.name)
        # Node -> the parameters that are set outside of it.
        self.given: dict[Element, list[tuple[str, Code]]] = {}
        self.handled: set[Element] = set()  # such parameters
        self.node = root  # that is ported
        self._includes = list(root.iter("include"))
        paths = [included(one, file, source) for one in self._includes]
        self.facts = [facts_of(one, source) for one in paths if one is not None]
        self.has_publisher = any(one.has_publisher for one in self.facts) or any(
            one.get("pkg") == PUBLISHER for one in root.iter("node")
        )

    def leave(self, element: Element, what: str, advice: str, attribute: str = "") -> None:
        """List what is left to the author."""
        place = self.written.get(element)
        line = place.line_of(attribute) if place is not None else 1
        self.notes.append(Unported(self.file, line, what, advice))

    @contextmanager
    def _listing(self, element: Element) -> Iterator[None]:
        """List an element that ROS 2 has no counterpart of."""
        try:
            yield
        except UnsaidError as error:
            self.leave(element, error.what, error.advice)

    def _package(self, name: str) -> str:
        """What a package is called in ROS 2, which is then one that the launch file needs."""
        if name == self.source.old:
            return self.source.name
        is_released = self.source.target.distro in released_packages().get(name, ())
        if not is_released and name not in self.source.siblings:
            instead = " or ".join(OF_ROS_1.get(name, ()))
            advice = ros1.INSTEAD.get(name, "Port it into the same workspace, and add this again.")
            raise UnsaidError(
                f"The package `{name}` is not released for {self.source.target.ros}.",
                f"Use {instead}." if instead else advice,
            )
        self.packages.add(name)
        return name

    def _place(self, path: str) -> str:
        """Where the file of a path is now, as roslaunch writes it."""
        if path in DEFAULT_WORLDS[1:] and self.source.target.simulator == SIM:
            return self._default_world
        found = FIND.fullmatch(path)
        if path.endswith((".world", ".sdf")) and self._is_gone(path):
            self._leave_world(path)
            return self._default_world
        if found is None or found[1] != self.source.old:
            return path
        place = self.source.moved.get(found[2])
        is_lost = path.endswith(".rviz") and "$(" not in found[2]
        if is_lost and not (self.source.folder / found[2]).exists():
            place = self.source.rviz  # rviz shows nothing then; exports of SolidWorks name such one
        return path if place is None else f"$(find {self.source.old})/{place}"

    def _model(self, path: str) -> str | None:
        """Where the robot of the package is, if a path leads to its description."""
        found = FIND.fullmatch(path.strip())
        is_robot = found is not None and found[1] == self.source.old and self.source.robot
        if not is_robot or found is None or found[2] != self.source.robot:
            return None
        return f"$(find {self.source.old})/{self.source.model}"

    @cached_property
    def _all_files(self) -> list[str]:
        return files_in(self.source.folder)

    def _is_expanded(self, name: str) -> bool:
        """Whether an argument is the file of a parameter, and given to no program."""
        uses = [
            attribute
            for one in self.root.iter("param", "node", "arg")
            for attribute, text in attributes(one).items()
            if f"$(arg {name})" in text
        ]
        return bool(uses) and {*uses} <= {"command", "textfile"}

    def _is_gone(self, path: str) -> bool:
        """Whether a file of the package, or an absolute path, does not exist."""
        found = FIND.fullmatch(path)
        if path == self._default_world:
            return False
        if found is not None:
            is_own = found[1] == self.source.old and "$(" not in found[2]
            return is_own and not (self.source.folder / found[2]).exists()
        return path.startswith("/") and "$(" not in path and not Path(path).exists()

    def _leave_world(self, path: str) -> None:
        """List a world that does not exist, once."""
        line = self.text.count("\n", 0, max(self.text.find(path), 0)) + 1
        what = f"The world `{path}` does not exist: the simulator starts with an empty one."
        left = Unported(self.file, line, what, "Put it into the package, and name it.")
        if left not in self.notes:
            self.notes.append(left)

    def _env(self, element: Element, given: Given) -> list[Action]:
        del element
        call = self.values.call(
            "SetEnvironmentVariable",
            repr(given.get("name", "")),
            self.values.text(given.get("value", "")),
            condition=self.values.condition(given),
        )
        return [Action(call, "variable")]

    def _grouped(
        self,
        actions: Iterable[Action],
        namespace: str,
        condition: Code | None,
        *,
        is_scoped: bool = True,
    ) -> Tree:
        items = [Item("", one.code, one.comments) for one in actions]
        if namespace:
            push = self.values.call("PushRosNamespace", self.values.text(namespace))
            items.insert(0, Item("", push))
        return self.values.call(
            "GroupAction",
            Tree("[", tuple(items), "]"),
            scoped=None if is_scoped else "False",
            condition=condition,
        )

    def _inclusion(
        self, file: Code, arguments: list[tuple[str, Code]], condition: Code | None
    ) -> Tree:
        return self.values.call(
            "IncludeLaunchDescription",
            self.values.call("PythonLaunchDescriptionSource", file),
            launch_arguments=mapped(arguments, "}.items()") if arguments else None,
            condition=condition,
        )

    def _node_call(self, package: str, program: str, keywords: Mapping[str, Code]) -> Tree:
        order = (
            *("name", "namespace", "output", "arguments", "parameters", "remappings"),
            *("additional_env", "prefix", "respawn", "respawn_delay", "on_exit", "condition"),
        )
        name = keywords.get("name")
        given = {key: keywords.get(key) for key in order}
        given["name"] = None if name == repr(program) else name
        return self.values.call("Node", package=repr(package), executable=repr(program), **given)

    @property
    def _default_world(self) -> str:
        own = self.source.default_world
        return EMPTY_WORLD if own is None else f"$(find {self.source.old})/{own}"
