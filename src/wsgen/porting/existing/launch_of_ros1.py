"""Launch files in the XML of ROS 1 become launch files in Python, with the same arguments.

Nodes, parameters and remappings stay as far as ROS 2 has them. ROS 2 has no server of parameters:
what is set outside of nodes is given to the nodes that it reaches. What has no counterpart is
listed, and is not in the new file. Source: wiki.ros.org/roslaunch/XML; ros/ros_comm, roslaunch.
"""

from __future__ import annotations

import re
from contextlib import contextmanager
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.dependencies import OF_ROS_1
from wsgen.gazebo.systems import EMPTY_WORLD
from wsgen.launching.spawner_options import POSE
from wsgen.model.facts import PROGRAMS as OF_SIMULATORS
from wsgen.model.target import SIM
from wsgen.porting.bridges import BRIDGE, BRIDGE_PACKAGE, CLOCK
from wsgen.porting.existing.controllers_of_ros1 import MANAGER, spawned
from wsgen.porting.existing.launch_values import (
    Item,
    Tree,
    UnsaidError,
    Values,
    joined,
    listed,
    mapped,
    paired,
    prose_above,
    split_words,
    text_of,
    whole_file,
)
from wsgen.porting.existing.parameters_of_ros1 import files_in, port_parameters, refuse_controllers
from wsgen.porting.existing.programs_of_ros1 import (
    spawn_options,
    topic_command,
    transform_arguments,
    written_for_ros_1,
)
from wsgen.porting.existing.resources import with_own_names
from wsgen.porting.launch_files import DEFAULT_WORLDS, ON, SWITCHES
from wsgen.porting.ported import Unported
from wsgen.ros import ros1
from wsgen.ros.names import released_packages
from wsgen.text.markup import elements, read_text
from wsgen.text.xmltree import Malformed
from wsgen.text.xmltree import parse as parse_xml
from wsgen.text.yamlfile import NotYaml
from wsgen.text.yamlfile import parse as parse_yaml

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from wsgen.model.target import Target
    from wsgen.porting.existing.launch_values import Code
    from wsgen.text.xmltree import Element

    Given = Mapping[str, str]  # the attributes of an element

ENDINGS = (".launch.xml", ".launch", ".xml")  # of launch files of ROS 1
ALWAYS = frozenset(("launch", "launch_ros", "ros2launch"))  # packages that every launch file needs
DESCRIPTION = "robot_description"
PUBLISHER = "robot_state_publisher"
SLIDERS = "joint_state_publisher"
_OF_ROS_2 = re.compile(
    r"\$\((?:var|find-pkg-share|find-exec|find-pkg-prefix|not|and|or|equals)\b"
    r"|<(?:let|executable|set_env|set_parameter|push_ros_namespace|push-ros-namespace|set_remap"
    r"|node_container|composable_node|load_composable_node|timer|on_exit|shutdown|log)\b"
    r"|<(?:node|test)\b[^>]*\sexec="
)
_FIND = re.compile(r"\$\(find\s+([\w-]+)\)/*(.*)", re.DOTALL)
_ARGUMENT = re.compile(r"\$\(arg\s+(\S+?)\s*\)")
_HERE = re.compile(r"\$\(dirname\)/*(.*)", re.DOTALL)
_SUBSTITUTED = re.compile(r"\$\([^()]*\)")
_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_CONDITIONS = frozenset(("if", "unless"))
_SETTINGS = frozenset(("launch", "arg", "param", "rosparam", "group", "include"))
_DEEPEST = 20  # launch files that include each other
# Elements without a counterpart -> what to do.
_LEFT = {
    "machine": "Start what runs there by a launch file on that machine.",
    "test": "Write the test with launch_testing.",
    "master": "Remove it: ROS 2 has no master.",
}


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


class _Action(NamedTuple):
    code: Code
    name: str = "action"  # of a variable for it
    is_setting: bool = False  # sets something for those that come later
    outlives: bool = False  # sets parameters, which in ROS 1 stay when a group ends
    comments: tuple[str, ...] = ()


class _Settings(NamedTuple):
    """What a node is given."""

    files: list[Code]  # of parameters
    pairs: list[tuple[str, Code]]  # parameters
    rules: list[tuple[Code, Code]]  # remappings


class _Facts(NamedTuple):
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


def dotted(name: str) -> str:
    """A name of a parameter as ROS 2 writes it."""
    return name.strip("/~").replace("/", ".")


def port_launch_file(file: Path, text: str, source: Source) -> PortedLaunch:
    """Write a launch file of ROS 1 as one of ROS 2, in Python.

    Args:
        file: where it is, in the folder of the package.
        text: what it holds.
        source: the package, and what it becomes.
    """
    text = with_own_names(text, {**source.siblings, source.old: source.folder})
    root = parse_xml(text)
    if isinstance(root, Malformed):
        what = f"{file.name} is not well-formed XML: {root.message}."
        return PortedLaunch(None, notes=(Unported(file, root.line, what, root.hint),))
    if root.tag != "launch" or not is_of_ros_1(text):
        return PortedLaunch(None)
    try:
        return _Port(file, text, root, source).result()
    except RecursionError:
        what = f"{file.name} is nested too deeply."
        return PortedLaunch(None, notes=(Unported(file, 1, what, "Write it in Python."),))


def _tags(element: Element) -> list[Element]:
    return [one for one in element if isinstance(one.tag, str)]


def _attributes(element: Element) -> dict[str, str]:
    return {str(key): str(value) for key, value in element.attrib.items()}


def _is_outside(element: Element) -> bool:
    """Whether an element is in no node."""
    parent = element.getparent()
    return parent is not None and parent.tag in {"launch", "group"}


def _unpauses(root: Element) -> bool:
    return any("-unpause" in one.get("args", "").split() for one in root.iter("node"))


def _facts_of(file: Path, source: Source, depth: int = 0) -> _Facts:
    """What a launch file of the package does, and those that it includes."""
    text = read_text(file) if depth < _DEEPEST else None
    root = parse_xml(text) if text is not None else None
    if root is None or isinstance(root, Malformed) or root.tag != "launch":
        return _Facts()
    paths = [_included(one, file, source) for one in root.iter("include")]
    inner = [_Facts() if one is None else _facts_of(one, source, depth + 1) for one in paths]
    kinds = {str(one.tag) for one in root.iter() if isinstance(one.tag, str)}
    parameters = root.iter("param", "rosparam")
    publishers = (one.get("pkg") == PUBLISHER for one in root.iter("node"))
    return _Facts(
        any(publishers) or any(one.has_publisher for one in inner),
        any(map(_is_outside, parameters)) or any(one.sets for one in inner),
        kinds <= _SETTINGS and all(one.only_sets for one in inner),
        _unpauses(root) or any(one.unpauses for one in inner),
    )


def _named_file(element: Element) -> str:
    """The file that an element includes; where an argument names it, that of its default."""
    text = (element.get("file") or "").strip()
    name = _ARGUMENT.fullmatch(text)
    arguments = element.getroottree().getroot().iter("arg") if name is not None else ()
    defaults = [one.get("default", "") for one in arguments if name and one.get("name") == name[1]]
    return defaults[0] if defaults else text


def _included(element: Element, file: Path, source: Source) -> Path | None:
    """The launch file of this package, or of one beside it, that an element includes."""
    text = _named_file(element)
    found, here = _FIND.fullmatch(text), _HERE.fullmatch(text)
    if here is not None:
        path = file.parent / here[1]
    elif found is not None and found[1] in {source.old, *source.siblings}:
        path = {source.old: source.folder, **source.siblings}[found[1]] / found[2]
    else:
        return None
    return path if path.is_file() else None


class _Port:
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
            if _is_outside(one) and (name := one.get("name"))
        }
        self.values = Values(declared, self._package, self._place, source.name)
        # Node -> the parameters that are set outside of it.
        self.given: dict[Element, list[tuple[str, Code]]] = {}
        self.handled: set[Element] = set()  # such parameters
        self.node = root  # that is ported
        self._includes = list(root.iter("include"))
        paths = [_included(one, file, source) for one in self._includes]
        self.facts = [_facts_of(one, source) for one in paths if one is not None]
        self.has_publisher = any(one.has_publisher for one in self.facts) or any(
            one.get("pkg") == PUBLISHER for one in root.iter("node")
        )

    # What is listed

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

    # Packages and their files

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
        found = _FIND.fullmatch(path)
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

    def _is_gone(self, path: str) -> bool:
        """Whether a file of the package, or an absolute path, does not exist."""
        found = _FIND.fullmatch(path)
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

    def _model(self, path: str) -> str | None:
        """Where the robot of the package is, if a path leads to its description."""
        found = _FIND.fullmatch(path.strip())
        is_robot = found is not None and found[1] == self.source.old and self.source.robot
        if not is_robot or found is None or found[2] != self.source.robot:
            return None
        return f"$(find {self.source.old})/{self.source.model}"

    @cached_property
    def _all_files(self) -> list[str]:
        return files_in(self.source.folder)

    # The file

    def result(self) -> PortedLaunch:
        """The new file, and what it needs."""
        for name, text in [*self.values.declared.items()]:
            if not self._is_said(text or ""):  # its element is left out; so is then what uses it
                del self.values.declared[name]
        self._attach()
        actions = self._walk(self.root)
        settings = [Item("", one.code, one.comments) for one in actions if one.is_setting]
        started = [(one.name, one.code, one.comments) for one in actions if not one.is_setting]
        text = whole_file(self.values, self.file.name, settings, started)
        needs, used = frozenset(self.packages), frozenset(self.used)
        return PortedLaunch(text, needs, tuple(self.notes), self.files, used)

    def _is_said(self, text: str) -> bool:
        try:
            self.values.path(text)
        except UnsaidError:
            return False
        return True

    def _walk(self, parent: Element) -> list[_Action]:
        """The actions for the elements in another one; what sets something comes first.

        roslaunch sets all parameters before it starts a node.
        """
        actions: list[_Action] = []
        for element in _tags(parent):
            new: list[_Action] = []
            if element not in self.handled:
                with self._listing(element):
                    new = self._element(element)
            if new:
                place = self.written.get(element)
                above = prose_above(self.text, place.line) if place is not None else ()
                new[0] = new[0]._replace(comments=(*above, *new[0].comments))
                actions += new
        return sorted(actions, key=lambda one: not one.is_setting)

    def _element(self, element: Element) -> list[_Action]:
        kinds: Mapping[str, Callable[[Element, Given], list[_Action]]] = {
            "arg": self._arg,
            "env": self._env,
            "group": self._group,
            "include": self._include,
            "node": self._node,
            "param": self._param,
            "remap": self._remap,
            "rosparam": self._rosparam,
        }
        kind = str(element.tag)
        if kind in kinds:
            return kinds[kind](element, _attributes(element))
        advice = _LEFT.get(kind, "Remove it: roslaunch does not read it either.")
        raise UnsaidError(f"ROS 2 has no counterpart of <{kind}>.", advice)

    def _arg(self, element: Element, given: Given) -> list[_Action]:
        name, default = given.get("name", ""), given.get("default")
        if not name:
            raise UnsaidError("An <arg> has no name.", "Name it.")
        condition = self.values.condition(given)
        if "value" in given:
            value = self.values.path(given["value"])
            call = self.values.call(
                "SetLaunchConfiguration", repr(name), value, condition=condition
            )
            return [_Action(call, is_setting=True)]
        if default is None and not self._is_used(name):
            default = ""
            self.leave(
                element,
                f"The argument `{name}` had to be given, although nothing uses it; it is empty "
                "by default now.",
                "Remove it.",
            )
        if self._is_expanded(name):
            default = self._model(default or "") or default
        if any(_ARGUMENT.sub(r"\1", one.get("file", "")) == name for one in self._includes):
            default = ported_name(default) if default and default.endswith(ENDINGS) else default
        call = self.values.call(
            "DeclareLaunchArgument",
            repr(name),
            default_value=None if default is None else self.values.path(default),
            description=repr(" ".join(given["doc"].split())) if given.get("doc") else None,
            condition=condition,
        )
        return [_Action(call, is_setting=True)]

    def _is_expanded(self, name: str) -> bool:
        """Whether an argument is the file of a parameter, and given to no program."""
        uses = [
            attribute
            for one in self.root.iter("param", "node", "arg")
            for attribute, text in _attributes(one).items()
            if f"$(arg {name})" in text
        ]
        return bool(uses) and {*uses} <= {"command", "textfile"}

    def _is_model_by_default(self, word: str) -> bool:
        """Whether a word is an argument whose default leads to the robot, as `_arg` changes it."""
        named = _ARGUMENT.fullmatch(word)
        default = self.values.declared.get(named[1]) if named is not None else None
        return (
            named is not None and self._is_expanded(named[1]) and bool(self._model(default or ""))
        )

    def _is_used(self, name: str) -> bool:
        word = re.escape(name)
        used = re.compile(rf"\$\(arg\s+{word}\s*\)|\$\(eval\b[^\"]*\b{word}\b|pass_all_args=")
        return used.search(self.text) is not None

    def _env(self, element: Element, given: Given) -> list[_Action]:
        del element
        call = self.values.call(
            "SetEnvironmentVariable",
            repr(given.get("name", "")),
            self.values.text(given.get("value", "")),
            condition=self.values.condition(given),
        )
        return [_Action(call, "variable")]

    def _remap(self, element: Element, given: Given) -> list[_Action]:
        del element
        call = self.values.call(
            "SetRemap",
            src=self.values.text(given.get("from", "")),
            dst=self.values.text(given.get("to", "")),
            condition=self.values.condition(given),
        )
        return [_Action(call, "remapping")]

    def _group(self, element: Element, given: Given) -> list[_Action]:
        """A group; parameters stay when it ends, what else it sets does not."""
        inside, namespace = self._walk(element), given.get("ns", "")
        condition = self.values.condition(given)
        settings = [one for one in inside if one.is_setting]
        if namespace or not any(one.outlives for one in settings):
            settings = []
        actions = settings if condition is None else []
        if settings and condition is not None:
            code = self._grouped(settings, "", condition, is_scoped=False)
            actions = [_Action(code, is_setting=True, outlives=True)]
        others = [one for one in inside if one not in settings]
        if others:
            outlives = any(one.outlives for one in others)
            is_scoped = bool(namespace) or not outlives
            code = self._grouped(others, namespace, condition, is_scoped=is_scoped)
            name = f"group_{namespace}" if namespace else "group"
            is_setting = all(one.is_setting for one in others)
            actions = [*actions, _Action(code, name, is_setting, outlives)]
        return actions

    def _grouped(
        self,
        actions: Iterable[_Action],
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

    # Parameters

    def _attach(self) -> None:
        """Give parameters that are set outside of nodes to those that surely read them."""
        for element in self.root.iter("param", "rosparam"):
            given, parent = _attributes(element), element.getparent()
            if parent is None or not _is_outside(element) or _CONDITIONS & given.keys():
                continue
            nodes = list(parent.iter("node"))
            with self._listing(element):
                if element.tag == "param":
                    self._attach_param(element, given, nodes)
                elif "file" not in given and given.get("command", "load") == "load":
                    name = (given.get("ns") or given.get("param", "")).strip("/")
                    readers = [one for one in nodes if name and one.get("name") == name]
                    if readers:
                        self.handled.add(element)
                        pairs = self._inline(element, {**given, "ns": "", "param": ""})
                        self._give(readers, pairs)

    def _attach_param(self, element: Element, given: Given, nodes: list[Element]) -> None:
        name = given.get("name", "").strip("/")
        first, _, rest = name.partition("/")
        readers: list[Element] = []
        if name == DESCRIPTION and not any(one.has_publisher for one in self.facts):
            readers = [one for one in nodes if one.get("pkg") == PUBLISHER]
        elif name == "use_gui":
            readers = [one for one in nodes if one.get("type") in {SLIDERS, f"{SLIDERS}_gui"}]
        elif rest:
            readers = [one for one in nodes if one.get("name") == first]
            name = rest
        if readers:
            self.handled.add(element)
            self._give(readers, [(name, self._value(given))])

    def _give(self, readers: Iterable[Element], pairs: list[tuple[str, Code]]) -> None:
        for one in readers:
            self.given.setdefault(one, []).extend((dotted(name), code) for name, code in pairs)

    def _value(self, given: Given) -> Code:
        """The value of a <param>."""
        name = given.get("name", "")
        if "value" in given:
            return self.values.typed(given["value"], given.get("type", "auto"))
        if "textfile" in given:
            program = "xacro" if name.rpartition("/")[2] == DESCRIPTION else "cat"
            words = [program, given["textfile"]]
        elif "command" in given:
            words = split_words(given["command"])
        else:
            raise UnsaidError(
                f"The parameter `{name}` has no value that ROS 2 can have.",
                "Give it another value in the launch file.",
            )
        words = words[2:] if words[:1] == ["rosrun"] else words
        models = [self._model(one) for one in words]
        if any(models) or any(map(self._is_model_by_default, words)):
            words = [model or one for one, model in zip(words, models, strict=True)]
            words[0] = "xacro"
        program = words[0].rpartition("/")[2] if words else ""
        if program in {"xacro", "xacro.py"}:
            self.packages.add("xacro")
            gone = {"--inorder", "-i", "--check-order"}
            words = ["xacro", *(one for one in words[1:] if one not in gone)]
        elif program != "cat" and not (words and words[0].startswith("$(")):
            raise UnsaidError(
                f"The command `{' '.join(words)}` is not one of ROS 2.",
                "Write what it prints into the launch file.",
            )
        return self.values.call("ParameterValue", self.values.command(words), value_type="str")

    def _param(self, element: Element, given: Given) -> list[_Action]:
        del element
        return self._set([(given.get("name", ""), self._value(given))], given)

    def _set(self, pairs: Iterable[tuple[str, Code]], given: Given) -> list[_Action]:
        """Parameters of all nodes that come later."""
        actions = []
        condition = self.values.condition(given)
        for name, value in pairs:
            parts = self.values.parts(name.strip("/~"))
            texts = [(one, text_of(one)) for one in parts]
            codes = [one if text is None else repr(text.replace("/", ".")) for one, text in texts]
            key = joined(codes)
            if not codes:
                raise UnsaidError("A parameter has no name.", "Name it.")
            if isinstance(key, Tree):
                key = Tree("(", key.items, ")")
            for inner, code in _flattened(value):
                whole = repr(f"{text_of(codes[0])}.{inner}") if inner else key
                call = self.values.call("SetParameter", whole, code, condition=condition)
                actions.append(_Action(call, is_setting=True, outlives=True))
        return actions

    def _inline(self, element: Element, given: Given) -> list[tuple[str, Code]]:
        """The parameters that the text of a <rosparam> has."""
        lines = [line for line in (element.text or "").split("\n") if line.strip()]
        value = parse_yaml("\n".join(lines))
        if isinstance(value, NotYaml):
            raise UnsaidError(
                f"The text of <rosparam> is not YAML: {value.message}.", "Correct it."
            )
        if value is None:
            return []
        refuse_controllers(value, "<rosparam>")
        is_substituted = given.get("subst_value", "").lower() in {"true", "1"}
        prefix = "/".join(filter(None, (given.get("ns", "").strip("/"), given.get("param", ""))))
        named = [*value.items()] if isinstance(value.content, dict) else [("", value)]
        pairs: list[tuple[str, Code]] = []
        for key, one in named:
            with self._listing(element):
                code = self.values.plain(one, is_substituted=is_substituted)
                pairs.append(("/".join(filter(None, (prefix, key))), code))
        return pairs

    def _rosparam(self, element: Element, given: Given) -> list[_Action]:
        """Parameters that a file or text outside of nodes sets."""
        self._refuse_command(given)
        found = _FIND.fullmatch(given.get("file", "").strip())
        if found is not None and found[1] == self.source.old:
            place = self.source.moved.get(found[2])
            if place is not None and place == self.source.controllers_file:
                return []  # the simulator reads it
        if "file" not in given:
            return self._set(self._inline(element, given), given)
        names = {one.get("name", "") for one in self.root.iter("node")} - {""}
        call = self.values.call(
            "SetParametersFromFile",
            self._parameter_file(given, names),
            condition=self.values.condition(given),
        )
        return [_Action(call, is_setting=True, outlives=True)]

    @staticmethod
    def _refuse_command(given: Given) -> None:
        command = given.get("command", "load")
        if command != "load":
            raise UnsaidError(
                f"A launch file of ROS 2 cannot {command} parameters.",
                "Use `ros2 param` when the nodes run.",
            )

    def _parameter_file(self, given: Given, nodes: set[str]) -> Code:
        """The path of a file of parameters, whose text becomes that of one of ROS 2."""
        path = given["file"].strip()
        keys = re.findall(r"[^/]+", f"{given.get('ns', '')}/{given.get('param', '')}")
        found = _FIND.fullmatch(path)
        if found is None or found[1] != self.source.old or any("$(" in one for one in keys):
            raise UnsaidError(
                f"`{path}` is not a file of this package, or its namespace is only known when it "
                "is launched.",
                "Write the name of the node, or `/**`, and `ros__parameters` above its "
                "parameters, and give it to the node.",
            )
        pattern = _SUBSTITUTED.sub("*", found[2])
        files = [one for one in self._all_files if fnmatchcase(one, pattern)]
        if not files:
            raise UnsaidError(f"The package has no file `{found[2]}`.", "Correct its path.")
        for file in files:
            text = port_parameters(self.source.folder / file, keys, nodes)
            if self.files.setdefault(file, text) != text:
                raise UnsaidError(
                    f"`{file}` is read for several nodes or namespaces.",
                    "Write a file of parameters for each of them.",
                )
        return self.values.path(path)

    # Other launch files

    def _include(self, element: Element, given: Given) -> list[_Action]:
        path = _named_file(element)
        arguments, environment = self._passed(element)
        found, here = _FIND.fullmatch(path), _HERE.fullmatch(path)
        package = found[1] if found else self.source.old if here else ""
        name = path.rpartition("/")[2]
        if package == "gazebo_ros" and name in ros1.GAZEBO_LAUNCH_FILES:
            world = ros1.GAZEBO_LAUNCH_FILES[name]
            return self._gazebo(element, {"world_name": world, **arguments})
        if package in {self.source.old, *self.source.siblings}:
            code = self._own_launch_file(element, path)
        else:
            code = self._other_launch_file(package, name, path)
        known = _included(element, self.file, self.source)
        facts = _facts_of(known, self.source) if known is not None else _Facts()
        # The arguments of an included launch file stay set for what comes after it.
        is_alone = len(self._includes) == 1 or facts.sets
        condition, namespace = self.values.condition(given), given.get("ns", "")
        is_grouped = bool(namespace or environment) or not is_alone
        call = self._inclusion(
            code,
            [(key, self.values.path(text)) for key, text in arguments.items()],
            None if is_grouped else condition,
        )
        if is_grouped:
            is_scoped = bool(namespace) or not facts.sets
            inside = [*environment, _Action(call)]
            call = self._grouped(inside, namespace, condition, is_scoped=is_scoped)
        return [
            _Action(call, _SUBSTITUTED.sub("", name).partition(".")[0], facts.only_sets, facts.sets)
        ]

    def _inclusion(
        self, file: Code, arguments: list[tuple[str, Code]], condition: Code | None
    ) -> Tree:
        return self.values.call(
            "IncludeLaunchDescription",
            self.values.call("PythonLaunchDescriptionSource", file),
            launch_arguments=mapped(arguments, "}.items()") if arguments else None,
            condition=condition,
        )

    def _passed(self, element: Element) -> tuple[dict[str, str], list[_Action]]:
        """The arguments and variables that are given to an included launch file."""
        arguments, environment = dict[str, str](), list[_Action]()
        for one in _tags(element):
            given = _attributes(one)
            if one.tag == "env":
                environment += self._env(one, given)
            elif _CONDITIONS & given.keys():
                self.leave(
                    one,
                    "An argument is given to a launch file under a condition.",
                    "Give it by IfElseSubstitution.",
                )
            elif one.tag == "arg" and "name" in given:
                arguments[given["name"]] = given.get("value", given.get("default", ""))
        return arguments, environment

    def _own_launch_file(self, element: Element, path: str) -> Code:
        name = path.rpartition(")")[2]
        if not name.endswith(ENDINGS):
            raise UnsaidError(
                "Which launch file is included is only known when it is launched.",
                "Include it in Python, where its name ends with .launch.py.",
            )
        if path.count("$(") == 1 and _included(element, self.file, self.source) is None:
            raise UnsaidError(f"The launch file {path} does not exist.", "Correct its path.")
        self._package((_FIND.fullmatch(path) or ["", self.source.old])[1])
        written = element.get("file", "").strip()
        is_argument = _ARGUMENT.fullmatch(written) is not None
        return self.values.path(written if is_argument else ported_name(path))

    def _other_launch_file(self, package: str, name: str, path: str) -> Code:
        if (package, name) in ros1.LAUNCH_FILES:
            there, file = ros1.LAUNCH_FILES[package, name]
            return self.values.path(f"$(find {there})/launch/{file}")
        where = f": see `ros2 pkg prefix --share {self._package(package)}`" if package else ""
        raise UnsaidError(
            f"It is not known which launch file of ROS 2 is the same as {path}.",
            f"Include it in Python{where}.",
        )

    # The simulator

    def _gazebo(self, element: Element, given: Given) -> list[_Action]:
        """Gazebo, and the time of nodes, which is its own."""
        uses_time = self.values.flag(given.get("use_sim_time", "true"))
        self.packages.add(self.sim["package"])
        world = given.get("world_name", "")
        if world not in DEFAULT_WORLDS and world in ros1.GAZEBO_LAUNCH_FILES.values():
            self.leave(
                element,
                f"The world `{world}` is one that Gazebo Classic brings.",
                "Copy what you need of it into a world file of the package.",
            )
            world = ""
        physics = given.get("physics", "ode")
        if physics != "ode" and "$(" not in physics:
            self.leave(element, f"Gazebo used the engine {physics}.", "Name it in the world file.")
        switches = {
            name: self.values.flag(given[old])
            for old, name in ros1.GAZEBO_ARGUMENTS.items()
            if name in SWITCHES and old in given
        }
        is_default = world in DEFAULT_WORLDS
        if self.source.target.simulator == SIM:
            if _unpauses(self.root) or any(one.unpauses for one in self.facts):
                switches.pop("pause", None)  # the spawner cannot start it
            world = self._default_world if is_default else world
            arguments = [("gz_args", self._gz_args(switches, world))]
        else:
            arguments = [] if is_default else [("world", self.values.path(world))]
            for name, code in switches.items():
                is_literal = code in {"True", "False"}
                arguments.append((name, repr(str(code).lower()) if is_literal else code))
        file = self.values.path(f"$(find {self.sim['package']})/launch/{self.sim['launch_file']}")
        include = self._inclusion(file, arguments, self.values.condition(_attributes(element)))
        call = self.values.call("SetParameter", "'use_sim_time'", uses_time)
        actions = [_Action(call, is_setting=True, outlives=True)] if uses_time != "False" else []
        return [*actions, _Action(include, "gazebo"), *self._bridge()]

    def _gz_args(self, switches: Mapping[str, Code], world: str) -> Code:
        pieces: list[Code] = []
        for name, (on, off) in SWITCHES.items():
            value = switches.get(name, str(ON[name]))
            if value in {"True", "False"}:
                pieces.append(repr(on if value == "True" else off))
            else:
                pieces.append(self.values.call("IfElseSubstitution", value, repr(on), repr(off)))
        quote = repr("" if world == EMPTY_WORLD else '"')
        return joined([*pieces, quote, self.values.path(world), quote])

    @property
    def _default_world(self) -> str:
        own = self.source.default_world
        return EMPTY_WORLD if own is None else f"$(find {self.source.old})/{own}"

    def _bridge(self) -> list[_Action]:
        """What has the time of Gazebo Sim reach the nodes."""
        if self.source.target.simulator != SIM:
            return []
        self.packages.add(BRIDGE_PACKAGE)
        keywords: dict[str, Code] = {"output": "'screen'"}
        if self.source.bridge is None:
            keywords["arguments"] = listed([repr(CLOCK)])
        else:
            path = self.values.path(f"$(find {self.source.old})/{self.source.bridge}")
            value = self.values.call("ParameterValue", path, value_type="str")
            keywords["parameters"] = listed([mapped([("config_file", value)])])
        return [_Action(self._node_call(BRIDGE_PACKAGE, BRIDGE, keywords), "bridge")]

    def _spawn(self, words: list[str], keywords: dict[str, Code]) -> list[_Action]:
        """The spawner of the target for spawn_model of ROS 1."""
        options = spawn_options(words)
        known = {"urdf", "sdf", "gazebo", "file", "param", "model", "unpause", "b", *POSE}
        for name in sorted(options.keys() - known):
            self._leave_argument(
                f"`-{name}` of spawn_model is gone.",
                "Write the positions as initial values into <ros2_control>, or command the joints."
                if name == "J"
                else f"See `ros2 run {self.sim['package']} {self.sim['spawner']} --help`.",
            )
        actions: list[_Action] = []
        arguments: list[Code] = []
        file = options.get("file", [""])[0]
        model = self._model(file)
        if model is not None:
            actions += self._expanded(model, arguments)
        elif "file" in options:
            arguments += ["'-file'", self.values.path(file)]
        elif "param" in options:
            actions += self._described(options["param"][0].strip("/") or DESCRIPTION, arguments)
        else:
            raise UnsaidError(
                "What spawn_model spawned is neither in a file nor in a parameter.",
                "Name the file of the model with -file.",
            )
        if self.source.entity and self._spawns_one(options):
            options["model"] = [self.source.entity]
        flags = {"model": self.sim["entity_flag"]}
        flags |= {flag[1:]: flag for flag in self.sim["pose_flags"].split()}
        for name, flag in flags.items():
            if name in options:
                arguments += [repr(flag), self.values.text(options[name][0])]
        if "unpause" in options and self.source.target.simulator != SIM:
            arguments.append("'-unpause'")
        keywords["arguments"] = paired(arguments)
        self.packages.add(self.sim["package"])
        call = self._node_call(self.sim["package"], self.sim["spawner"], keywords)
        return [*actions, _Action(call, "spawn_robot")]

    def _spawns_one(self, options: Mapping[str, list[str]]) -> bool:
        """Whether it is surely the robot of the package that is spawned, and once."""
        spawners = [one for one in self.root.iter("node") if one.get("type") in ros1.SPAWNERS]
        is_named = "$(" not in options.get("model", ["$("])[0]
        return is_named and "sdf" not in options and len(spawners) == 1

    def _expanded(self, model: str, arguments: list[Code]) -> list[_Action]:
        """Add the robot that was in a file, as xacro expands it."""
        self.packages.add("xacro")
        command = self.values.command(["xacro", model])
        if self.source.target.simulator == SIM:
            arguments += ["'-string'", command]
            return []
        arguments += [repr(self.sim["topic_flag"]), repr(DESCRIPTION)]
        if self.has_publisher:
            return []
        value = self.values.call("ParameterValue", command, value_type="str")
        return [self._publisher(listed([mapped([(DESCRIPTION, value)])]))]

    def _publisher(self, parameters: Code | None = None) -> _Action:
        self.packages.add(PUBLISHER)
        keywords: dict[str, Code] = {"output": "'screen'"}
        keywords |= {"parameters": parameters} if parameters is not None else {}
        return _Action(self._node_call(PUBLISHER, PUBLISHER, keywords), PUBLISHER)

    def _described(self, parameter: str, arguments: list[Code]) -> list[_Action]:
        """Add where the spawner has the robot from: a topic, if there is one, or a parameter."""
        names = {(one.get("name") or "").strip("/") for one in self.root.iter("param")}
        is_set_here = parameter in names or any(one.sets for one in self.facts)
        topic = self.values.text(parameter.rpartition("/")[2])
        if self.has_publisher or not is_set_here:
            arguments += [repr(self.sim["topic_flag"]), topic]
            return []
        if self.source.target.simulator == SIM:
            arguments += ["'-param'", self.values.text(dotted(parameter))]
            return []
        arguments += [repr(self.sim["topic_flag"]), topic]
        return [self._publisher()]

    # Nodes

    def _leave_argument(self, what: str, advice: str) -> None:
        """List an argument of the node that is ported now."""
        self.leave(self.node, what, advice, "args")

    def _node(self, element: Element, given: Given) -> list[_Action]:
        self.node = element
        package, program = given.get("pkg", "").strip(), given.get("type", "").strip()
        if not package or not program:
            raise UnsaidError("A <node> lacks `pkg` or `type`.", "Name its package and program.")
        keywords = self._common(element, given)
        found = self._settings(element, keywords)
        words = self._split_arguments(given, found)
        shows = dict(found.pairs).get("use_gui") if program == SLIDERS else None
        if program.startswith(SLIDERS):
            found.pairs[:] = [one for one in found.pairs if one[0] != "use_gui"]
        if (package, program) == ("map_server", "map_server") and words:
            path = self.values.path(words.pop(0))
            value = self.values.call("ParameterValue", path, value_type="str")
            found.pairs.append(("yaml_filename", value))
        if found.files or found.pairs:
            own = [mapped(found.pairs)] if found.pairs else []
            keywords["parameters"] = listed([*found.files, *own])
        if found.rules:
            rules = (Tree("(", listed(one).items, ")") for one in found.rules)
            keywords["remappings"] = listed(rules)
        if shows is not None:
            return self._sliders(shows, keywords)
        if package in {"gazebo_ros", MANAGER, "rostopic"}:
            return self._special(element, words, keywords)
        if program == "static_transform_publisher":
            words = transform_arguments(words, is_of_tf=package == "tf")
        return self._plain_node(element, self._program(element, package, program), words, keywords)

    def _special(
        self, element: Element, words: list[str], keywords: dict[str, Code]
    ) -> list[_Action]:
        """What programs do whose counterparts are others."""
        given = _attributes(element)
        package, program = given["pkg"].strip(), given["type"].strip()
        if package == "rostopic":
            return [self._topic(words, given)]
        if package == MANAGER:
            return self._controllers(words, keywords)
        if program in {"gzclient", *ros1.GAZEBO_PROGRAMS}:
            return self._gazebo_program(element, program, words)
        if program in ros1.SPAWNERS:
            return self._spawn(words, keywords)
        raise UnsaidError(
            f"ROS 2 has no counterpart of `{program}` of gazebo_ros.", "Go without it."
        )

    def _plain_node(
        self,
        element: Element,
        there: tuple[str, str],
        words: list[str],
        keywords: dict[str, Code],
    ) -> list[_Action]:
        if words:
            keywords["arguments"] = paired([self._argument(word) for word in words])
        name = element.get("name", there[1])
        actions = [_Action(self._node_call(*there, keywords), _SUBSTITUTED.sub("", name) or name)]
        if there in ros1.LIFECYCLE:  # waits for somebody who activates it
            self._package("nav2_lifecycle_manager")
            pairs: list[tuple[str, Code]] = [("autostart", "True")]
            pairs.append(("node_names", listed([self.values.text(name)])))
            manager: dict[str, Code] = {
                "name": repr(f"lifecycle_manager_{there[1]}"),
                "output": "'screen'",
                "parameters": listed([mapped(pairs)]),
            }
            call = self._node_call("nav2_lifecycle_manager", "lifecycle_manager", manager)
            actions.append(_Action(call, f"activate_{there[1]}"))
        return actions

    def _argument(self, word: str) -> Code:
        if self.values.holds_words(word):
            self._leave_argument(
                f"`{word}` held several words, or none; ROS 2 passes it as one.",
                "Write the words into the list of arguments.",
            )
        return self.values.path(word)

    def _split_arguments(self, given: Given, found: _Settings) -> list[str]:
        """The words that are no parameter (_name:=value) and no remapping (from:=to)."""
        words = list[str]()
        for word in split_words(given.get("args", "")):
            private = re.fullmatch(r"_(?!_)(\w+):=(.*)", word, re.DOTALL)
            renamed = re.fullmatch(r"([\w/~]+):=(.+)", word, re.DOTALL)
            if private is not None:
                found.pairs.append((private[1], self.values.typed(private[2])))
            elif renamed is not None and not word.startswith("__"):
                found.rules.append((repr(renamed[1]), self.values.text(renamed[2])))
            elif not word.startswith("__"):
                words.append(word)
        return words

    def _common(self, element: Element, given: Given) -> dict[str, Code]:
        """What all nodes may have."""
        name = given.get("name", "")
        if name and "$(" not in name and not _NAME.fullmatch(name):
            usable = re.sub(r"\W", "_", name, flags=re.ASCII)
            usable = f"_{usable}" if usable[:1].isdigit() else usable
            self.leave(
                element,
                f"`{name}` cannot be the name of a node in ROS 2; it is `{usable}` now.",
                "Choose one of letters, digits and _.",
                "name",
            )
            name = usable
        texts = {"name": name, "namespace": given.get("ns"), "output": given.get("output")}
        texts["prefix"] = given.get("launch-prefix")
        keywords = {key: self.values.text(text) for key, text in texts.items() if text}
        if self._is_on(element, given, "respawn"):
            keywords["respawn"] = "True"
            delay = self.values.typed(given.get("respawn_delay", "0"), "double")
            keywords |= {"respawn_delay": delay} if delay != "0.0" else {}
        if self._is_on(element, given, "required"):
            keywords["on_exit"] = self.values.call("Shutdown")
        if given.get("machine", "") not in {"", "localhost"}:
            advice = "Start it by a launch file on that machine."
            self.leave(element, "The node was for another machine.", advice, "machine")
        if given.get("cwd", "ROS_HOME") != "ROS_HOME":
            advice = "Write whole paths in the node."
            self.leave(element, "The node ran in the folder of its program.", advice, "cwd")
        condition = self.values.condition(given)
        return keywords if condition is None else {**keywords, "condition": condition}

    def _is_on(self, element: Element, given: Given, attribute: str) -> bool:
        flag = self.values.flag(given.get(attribute, "false"))
        if flag not in {"True", "False"}:
            self.leave(
                element,
                f"`{attribute}` is only known when it is launched; it is off now.",
                "Write two nodes, each with a condition.",
                attribute,
            )
        return flag == "True"

    def _settings(self, element: Element, keywords: dict[str, Code]) -> _Settings:
        """The parameters and remappings of a node; its variables become a keyword."""
        found = _Settings([], list(self.given.get(element, ())), [])
        variables: list[tuple[str, Code]] = []
        chosen: dict[str, list[Element]] = {}
        for one in _tags(element):
            given = _attributes(one)
            with self._listing(one):
                if _CONDITIONS & given.keys():
                    if one.tag != "param":
                        raise _conditional(one)
                    chosen.setdefault(given.get("name", ""), []).append(one)
                elif one.tag == "env":
                    value = self.values.text(given.get("value", ""))
                    variables.append((given.get("name", ""), value))
                else:
                    self._setting(one, given, found)
        for name, both in chosen.items():
            with self._listing(both[0]):
                found.pairs.append((dotted(name), self._chosen(both)))
        if variables:
            keywords["additional_env"] = mapped(variables)
        return found

    def _setting(self, element: Element, given: Given, found: _Settings) -> None:
        if element.tag == "param":
            found.pairs.append((dotted(given.get("name", "")), self._value(given)))
        elif element.tag == "remap":
            ends = (given.get("from", ""), given.get("to", ""))
            if self._is_of_manager(ends[1]):
                return
            found.rules.append((self.values.text(ends[0]), self.values.text(ends[1])))
        elif element.tag == "rosparam":
            self._refuse_command(given)
            if "file" in given:
                found.files.append(self._parameter_file(given, set()))
            else:
                inline = self._inline(element, given)
                found.pairs.extend((dotted(name), code) for name, code in inline)

    def _is_of_manager(self, topic: str) -> bool:
        """Whether a topic is that of the positions of joints, which has no namespace now."""
        managers = (one for one in self.root.iter("node") if one.get("pkg") == MANAGER)
        return topic.strip("/") in {
            f"{one.get('ns', '').strip('/')}/joint_states" for one in managers
        }

    def _chosen(self, both: list[Element]) -> Code:
        """The value of a parameter that is one under a condition, and else another."""
        on = next((one for one in both if one.get("if") is not None), both[0])
        off = next((one for one in both if one.get("unless") is not None), both[0])
        condition, value, other = on.get("if"), on.get("value"), off.get("value")
        is_pair = len(both) == 2 and condition == off.get("unless")  # noqa: PLR2004
        if not is_pair or condition is None or value is None or other is None:
            raise _conditional(both[0])
        texts = (self.values.text(condition), self.values.path(value), self.values.path(other))
        return self.values.call("IfElseSubstitution", *texts)

    def _node_call(self, package: str, program: str, keywords: Mapping[str, Code]) -> Tree:
        order = (
            *("name", "namespace", "output", "arguments", "parameters", "remappings"),
            *("additional_env", "prefix", "respawn", "respawn_delay", "on_exit", "condition"),
        )
        name = keywords.get("name")
        given = {key: keywords.get(key) for key in order}
        given["name"] = None if name == repr(program) else name
        return self.values.call("Node", package=repr(package), executable=repr(program), **given)

    def _program(self, element: Element, package: str, program: str) -> tuple[str, str]:
        """The package and the program of ROS 2."""
        if "$(" in package + program:
            raise UnsaidError(
                "Which program is started is only known when it is launched.",
                "Write a node for each program, with a condition.",
            )
        if (package, program) in ros1.PROGRAMS:
            there = ros1.PROGRAMS[package, program]
            return self._package(there[0]), there[1]
        folder = {self.source.old: self.source.folder, **self.source.siblings}.get(package)
        if folder is not None:
            reason = written_for_ros_1(folder, program)
            if reason is not None:
                raise UnsaidError(
                    f"The program `{program}` of {package} {reason}.",
                    "Write it for ROS 2, then start it by a Node.",
                )
            if package == self.source.old:
                ends = (program, f"/{program}")
                self.used |= {one for one in self._all_files if f"/{one}".endswith(ends[1])}
            return self._package(package), program
        if package in ros1.INSTEAD:
            raise UnsaidError(
                f"ROS 2 has no `{program}` of {package} with the same parameters.",
                ros1.INSTEAD[package],
            )
        self._package(package)
        if package not in ros1.SAME_PROGRAMS and not package.startswith("rqt_"):
            self.leave(
                element,
                f"It is not known whether {package} has a program `{program}` in ROS 2 that takes "
                "the same parameters.",
                f"See `ros2 pkg executables {package}`.",
                "type",
            )
        return package, program

    def _gazebo_program(self, element: Element, program: str, words: list[str]) -> list[_Action]:
        if program == "gzclient":
            return []  # what starts Gazebo opens its window, too
        world = next((one for one in words if one.endswith((".world", ".sdf"))), "")
        given = {"world_name": world, "gui": str(program != "gzserver").lower()}
        is_paused = bool({"-u", "--pause"} & {*words})
        return self._gazebo(element, {**given, **({"paused": "true"} if is_paused else {})})

    def _sliders(self, shows: Code, keywords: dict[str, Code]) -> list[_Action]:
        """joint_state_publisher, which shows sliders where it is told to."""
        keywords["name"] = repr(SLIDERS)
        nodes = {"True": f"{SLIDERS}_gui", "False": SLIDERS}
        if shows in nodes:
            nodes = {"": nodes[str(shows)]}
        self.packages.update(nodes.values())
        condition = keywords.pop("condition", None) if len(nodes) > 1 else None
        actions = list[_Action]()
        for truth, name in nodes.items():
            if truth:
                test = "IfCondition" if truth == "True" else "UnlessCondition"
                keywords["condition"] = self.values.call(test, shows)
            actions.append(_Action(self._node_call(name, name, keywords), name))
        if condition is None:
            return actions
        return [_Action(self._grouped(actions, "", condition), "sliders")]

    def _controllers(self, words: list[str], keywords: dict[str, Code]) -> list[_Action]:
        """The spawner, for those controllers that the package has."""
        names = spawned(words)
        unknown = [one for one in names if one not in self.source.controllers]
        if unknown:
            self._leave_argument(
                f"The controllers {', '.join(unknown)} are of ros_control.",
                f"{self.source.controllers_file} has those that ros2_control has, too."
                if self.source.controllers_file
                else "Describe the joints in <ros2_control>, and the controllers in a file for "
                "controller_manager; --control writes both.",
            )
        known = [self.source.controllers[one] for one in names if one in self.source.controllers]
        if not known:
            return []
        self.packages.add(MANAGER)
        inactive = ["--inactive"] if "--stopped" in words else []
        # The manager has no namespace, whatever that of the spawner is.
        manager = ["--controller-manager", "/controller_manager"]
        keywords.pop("namespace", None)
        keywords["arguments"] = listed(map(repr, [*dict.fromkeys(known), *inactive, *manager]))
        return [_Action(self._node_call(MANAGER, "spawner", keywords), "spawner")]

    def _topic(self, words: list[str], given: Given) -> _Action:
        """What rostopic did, by a command of ros2."""
        command = topic_command(words)
        if command is None:
            raise UnsaidError(
                f"`rostopic {' '.join(words)}` has no counterpart that surely does the same.",
                ros1.INSTEAD["rostopic"],
            )
        self.packages.add("ros2topic")
        call = self.values.call(
            "ExecuteProcess",
            cmd=paired(["'ros2'", *(self.values.text(one) for one in command)]),
            output=self.values.text(given["output"]) if given.get("output") else None,
            condition=self.values.condition(given),
        )
        return _Action(call, given.get("name", "topic"))


def _conditional(element: Element) -> UnsaidError:
    return UnsaidError(
        f"<{element.tag}> of a node has a condition.", "Write two nodes, each with a condition."
    )


def _flattened(value: Code) -> Iterator[tuple[str, Code]]:
    """The values in nested dictionaries, by their dotted names."""
    if isinstance(value, Tree) and value.head == "{":
        for item in value.items:
            key = text_of(item.key.removesuffix(": ")) or ""
            for inner, code in _flattened(item.code):
                yield (f"{key}.{inner}" if inner else key), code
    else:
        yield "", value
