"""Launch files in Python: the simulator, the spawner and the bridge of Gazebo Sim.

Only what names Gazebo Classic is edited; conditions, arguments and handlers stay where they are.
Source: gazebosim/ros_gz, ros_gz_sim/launch/gz_sim.launch.py.in; gazebo_ros, launch/*.launch.py.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.launch_files import RENAMED, import_edit, name_of, tree_of
from wsgen.checks.fixes.source import Edit
from wsgen.launching.spawner_options import CREATE, SPAWN_ENTITY, SPAWNERS
from wsgen.model.facts import PROGRAMS, ROS2_CONTROL_HARDWARE
from wsgen.model.target import CLASSIC, SIM
from wsgen.porting.ported import FilePort, Unported

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.checks.fixes.launch_files import Located, Tree
    from wsgen.checks.fixes.source import SourceText
    from wsgen.porting.ported import BridgeRow


(_OLD_PACKAGE, _OLD_SPAWNER) = next(one for one in SPAWNERS if SPAWNERS[one] is SPAWN_ENTITY)
_PACKAGE, _SPAWNER = (PROGRAMS[SIM][key][1] for key in ("package", "spawner"))
_HELP = f"ros2 run {_PACKAGE} {_SPAWNER} --help"
_LAUNCH_FILE = PROGRAMS[SIM]["launch_file"][1]
BRIDGE_PACKAGE, BRIDGE = (PROGRAMS[SIM][key][1] for key in ("bridge_package", "bridge"))
CLOCK = "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"
# Launch file of gazebo_ros, and program -> the option of `gz sim` that makes it the same part.
PARTS = {"gazebo": "", "gzserver": "-s ", "gzclient": "-g "}
_FILES = {f"{name}.launch.py": part for name, part in PARTS.items()}
# Environment variable of Gazebo Classic -> that of Gazebo Sim.
VARIABLES = {
    "GAZEBO_MODEL_PATH": "GZ_SIM_RESOURCE_PATH",
    "GAZEBO_RESOURCE_PATH": "GZ_SIM_RESOURCE_PATH",
    "GAZEBO_PLUGIN_PATH": "GZ_SIM_SYSTEM_PLUGIN_PATH",
}
_RENAMED = {**VARIABLES, ROS2_CONTROL_HARDWARE[CLASSIC][1]: ROS2_CONTROL_HARDWARE[SIM][1]}
# Launch argument of gazebo_ros -> what `gz_args` has for it where it is true, and where it is not.
SWITCHES = {"verbose": ("-v 4 ", ""), "pause": ("", "-r "), "gui": ("", "-s ")}
ON = {"verbose": False, "pause": False, "gui": True}  # their defaults
_OF_SERVER = ("world", *SWITCHES)
_ENDS = ("server_required", "gui_required")
DEFAULT_WORLDS = ("", "empty.world", "worlds/empty.world")
_TRUE = ("true", "1")
# Without a counterpart, and without a loss: `create` waits, and what it waits for is another thing.
_SILENTLY_DROPPED = ("timeout", "spawn_service_timeout", "gazebo_namespace", "unpause", "b")


class Context(NamedTuple):
    """What the evaluation of a launch file and its robots gives to its port."""

    # The topics of the robots that each spawner puts into the simulator, by the line of its call.
    rows: Mapping[int, Sequence[BridgeRow]]
    package: str  # that it belongs to
    default_world: str | None = (
        None  # the file of the package for Classic's default; None: Gazebo's
    )


def option(row: BridgeRow) -> str:
    """The argument of the bridge for a topic."""
    return f"{row.gz_topic}@{row.ros_type}{row.direction}gz.msgs.{row.gz_type}"


def port_launch_file(source: SourceText, context: Context) -> FilePort:
    """Port a launch file, or a Python module that one imports."""
    if "azebo" not in source.text and not any(
        name in source.text for name in ("gzserver", "gzclient")
    ):
        return FilePort()
    tree = tree_of(source)
    return FilePort() if tree is None else _Port(tree, context).result()


class _Port:
    def __init__(self, tree: Tree, context: Context) -> None:
        self.tree = tree
        self.context = context
        self.edits: list[Edit] = []
        self.unported: list[Unported] = []
        self.packages: set[str] = set()
        self.files: set[str] = set()
        self.imports: list[str] = []
        text = tree.source.text
        self.quote = '"' if text.count('"') > text.count("'") else "'"
        self.parents = {
            child: parent for parent in tree.nodes for child in ast.iter_child_nodes(parent)
        }
        self.values: dict[str, list[ast.expr]] = {}  # by the names that they are assigned to
        for node in tree.nodes:
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    if isinstance(target, ast.Name):
                        self.values.setdefault(target.id, []).append(node.value)
        self.declared = {
            first.value: call
            for call in self._calls("DeclareLaunchArgument")
            if isinstance(first := self._argument(call, 0, "name"), ast.Constant)
        }
        self.done: set[ast.AST] = set()

    def result(self) -> FilePort:
        servers = [*self._includes(), *self._commands()]
        spawners = [*self._spawners()]
        self._bridge(servers, spawners)
        self._lookups()
        self._variables()
        self._rest()
        edits = [*self.edits]
        for statement in dict.fromkeys(self.imports):
            edits += import_edit(self.tree, statement)
        return FilePort(
            edits=_joined(edits),
            unported=tuple(self.unported),
            packages=frozenset(self.packages),
            files=frozenset(self.files),
        )

    # What a program of Python says

    def _calls(self, *names: str) -> list[ast.Call]:
        return [call for call in self.tree.all(ast.Call) if name_of(call) in names]

    @staticmethod
    def _argument(call: ast.Call, index: int, *names: str) -> ast.expr | None:
        for keyword in call.keywords:
            if keyword.arg in names:
                return keyword.value
        return call.args[index] if 0 <= index < len(call.args) else None

    def _value(self, node: ast.expr | None) -> ast.expr | None:
        """What a name stands for, where it is assigned once; else the node."""
        if isinstance(node, ast.Name) and len(values := self.values.get(node.id, ())) == 1:
            return values[0]
        return node

    def _text(self, node: ast.expr | None) -> str | None:
        value = self._value(node)
        return (
            value.value
            if isinstance(value, ast.Constant) and isinstance(value.value, str)
            else None
        )

    def _constants(self, node: ast.AST, depth: int = 3) -> Iterator[ast.Constant]:
        """The texts in a node, and in what its names stand for."""
        for inner in ast.walk(node):
            if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                yield inner
            elif isinstance(inner, ast.Name) and depth:
                value = self._value(inner)
                if value is not inner and value is not None:
                    yield from self._constants(value, depth - 1)

    def _source(self, node: Located) -> str:
        return self.tree.source.text[self.tree.start(node) : self.tree.end(node)]

    def _quoted(self, text: str) -> str:
        return f"{self.quote}{text}{self.quote}"

    # Edits

    def _replace(self, node: Located, text: str) -> None:
        if node not in self.done:
            self.done.add(node)
            self.edits.append(Edit(start=self.tree.start(node), end=self.tree.end(node), text=text))

    def _rename(self, node: ast.Constant, old: str, new: str) -> None:
        """Change a part of a text, and keep its quotes."""
        self._replace(node, self._source(node).replace(old, new))

    def _remove(self, first: Located, last: Located) -> None:
        """Remove elements of a list or dictionary, with the comma behind them."""
        source = self.tree.source
        start, end = self.tree.start(first), self.tree.end(last)
        rest = source.text[end:]
        behind = len(rest) - len(rest.lstrip())
        if rest[behind : behind + 1] == ",":
            end += behind + 1
            whole = source.whole_lines(start, end)
            if whole == (start, end):
                end += len(source.text[end:]) - len(source.text[end:].lstrip(" "))
            start, end = whole if whole != (start, end) and whole[1] > end else (start, end)
        else:  # the last one: with the comma before it
            start = len(source.text[:start].rstrip().removesuffix(","))
        self.done.update(ast.walk(first))
        self.done.update(ast.walk(last))
        self.edits.append(Edit(start=start, end=end, text=""))

    def _list(self, node: Located, what: str, advice: str) -> None:
        self.unported.append(Unported(self.tree.source.file, node.lineno, what, advice))

    # The simulator

    def _includes(self) -> Iterator[ast.Call]:
        """Port what includes the launch files of gazebo_ros; those that start a server."""
        for call in self._calls("IncludeLaunchDescription"):
            constants = [*self._constants(call)]
            for file in constants:
                name = file.value.rpartition("/")[2]
                if name not in _FILES or not any(_OLD_PACKAGE in one.value for one in constants):
                    continue
                self._rename(file, name, _LAUNCH_FILE)
                if f"{_OLD_PACKAGE}/" in file.value:
                    self.done.discard(file)
                    self.edits.pop()
                    self._rename_both(file, name)
                self.packages.add(_PACKAGE)
                self._arguments(call, _FILES[name])
                if _FILES[name] != PARTS["gzclient"]:
                    yield call
                break

    def _rename_both(self, file: ast.Constant, name: str) -> None:
        text = self._source(file).replace(name, _LAUNCH_FILE)
        self._replace(file, text.replace(f"{_OLD_PACKAGE}/", f"{_PACKAGE}/"))

    def _arguments(self, call: ast.Call, part: str) -> None:
        """Write `gz_args` from the launch arguments of gazebo_ros."""
        given = self._argument(call, 1, "launch_arguments")
        written = self._value(given)
        entries = self._entries(written)
        if entries is None:
            self._list(
                given or call,
                "The launch arguments of Gazebo Classic are computed.",
                f"Give {_LAUNCH_FILE} `gz_args`, for example '-r world.sdf', instead.",
            )
            return
        values: dict[str, ast.expr | str] = {
            name: f"LaunchConfiguration({self._quoted(name)})"
            for name in _OF_SERVER
            if name in self.declared
        }
        values.update({name: value for name, (_, value) in entries.items() if name in _OF_SERVER})
        text = self._gz_args(values, part)
        is_pair = isinstance(written, (ast.List, ast.Tuple))
        pair = "({}, {})" if is_pair else "{}: {}"
        lines = [pair.format(self._quoted("gz_args"), text)]
        if any(self._is_true(entries[name][1]) for name in _ENDS if name in entries):
            lines.append(pair.format(self._quoted("on_exit_shutdown"), self._quoted("true")))
        if given is None:
            self._give(call, lines[0])
            return
        kept = next((entries[name] for name in ("world", *entries) if name in entries), None)
        if kept is None:  # an empty dictionary
            self._replace(given, f"{{{', '.join(lines)}}}.items()")
            return
        for name, (key, value) in entries.items():
            if (key, value) == kept:
                self._between(key, value, self._in_lines(key, lines), is_pair=is_pair)
            elif is_pair:
                pair_node = self.parents[key]
                self._remove(pair_node, pair_node)  # type: ignore[arg-type]  a tuple
            else:
                self._remove(key, value)
            if name not in (*_OF_SERVER, *_ENDS, "gui", "headless", "debug", "init", "factory"):
                self._list(
                    key,
                    f"The launch argument `{name}` of Gazebo Classic is gone.",
                    "Write what it did into `gz_args`, if `gz sim --help` has it.",
                )

    def _in_lines(self, beside: ast.expr, entries: Sequence[str]) -> str:
        """Entries in a line each, where those of the author are."""
        source = self.tree.source
        place = self.tree.start(beside)
        indent = source.indent_at(place)
        is_first = not source.text[:place].rpartition("\n")[2].strip(" ([")
        return f",{source.newline}{indent}".join(entries) if is_first else ", ".join(entries)

    def _between(self, key: ast.expr, value: ast.expr, text: str, *, is_pair: bool) -> None:
        first: Located = key
        last: Located = value
        if is_pair:
            first = last = self.parents[key]  # type: ignore[assignment]  a tuple
        self.done.update(ast.walk(first))
        self.done.update(ast.walk(last))
        self.edits.append(Edit(start=self.tree.start(first), end=self.tree.end(last), text=text))

    def _entries(self, node: ast.expr | None) -> dict[str, tuple[ast.expr, ast.expr]] | None:
        """Names of launch arguments with their keys and values; None where they are computed."""
        if node is None:
            return {}
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and node.func.attr == "items"
        ):
            return self._entries(self._value(node.func.value))
        if isinstance(node, ast.Dict):
            pairs = [*zip(node.keys, node.values, strict=True)]
        elif isinstance(node, (ast.List, ast.Tuple)):
            pairs = [
                (one.elts[0], one.elts[1])
                for one in node.elts
                if isinstance(one, ast.Tuple) and len(one.elts) == 2  # noqa: PLR2004  a pair
            ]
            if len(pairs) != len(node.elts):
                return None
        else:
            return None
        found = {}
        for key, value in pairs:
            if not isinstance(key, ast.Constant) or not isinstance(key.value, str):
                return None
            found[key.value] = (key, value)
        return found

    def _gz_args(self, values: Mapping[str, ast.expr | str], part: str) -> str:
        """The value of `gz_args`, as Python."""
        pieces: list[str] = []  # Python; texts with quotes are joined
        constant = part
        if part != PARTS["gzclient"]:
            names = ("pause", "verbose") if part else ("pause", "gui", "verbose")
            for name in names:
                value = values.get(name)
                is_on = ON[name] if value is None else self._switch(value)
                if is_on is not None:
                    constant += SWITCHES[name][0 if is_on else 1]
                    continue
                if constant:
                    pieces.append(self._quoted(constant))
                    constant = ""
                self.imports.append("from launch.substitutions import IfElseSubstitution")
                on, off = (self._quoted(text) for text in SWITCHES[name])
                said = value if isinstance(value, str) else self._source(value)  # type: ignore[arg-type]
                pieces.append(f"IfElseSubstitution({said}, {on}, {off})")
            world = values.get("world")
            pieces += [self._quoted(constant)] if constant else []
            pieces += self._world(world)
        else:
            value = values.get("verbose")
            if value is not None and self._switch(value):
                constant += SWITCHES["verbose"][0]
            pieces.append(self._quoted(constant.rstrip()))
        if len(pieces) == 1 and pieces[0].startswith(self.quote):
            return pieces[0]
        return f"[{', '.join(pieces)}]"

    def _world(self, world: ast.expr | str | None) -> list[str]:
        if isinstance(world, str):
            self._default_of_world()
            self.imports.append("from launch.substitutions import LaunchConfiguration")
            return [world]
        said = self._text(world)
        if world is None or said in DEFAULT_WORLDS:
            return [self._default_world()]
        value = self._value(world)
        of_classic = list(self._constants(world))
        if any(one.value == _OLD_PACKAGE for one in of_classic):
            if not any(one.value in DEFAULT_WORLDS[1:] for one in of_classic):
                self._list(
                    world,
                    "The world is one that Gazebo Classic brings; Gazebo Sim has none of it.",
                    "Copy what you need of it into a world file of the package.",
                )
            return [self._default_world()]
        if (
            isinstance(value, ast.Call)
            and name_of(value) == "LaunchConfiguration"
            and (name := self._text(self._argument(value, 0, "variable_name"))) in self.declared
        ):
            self._default_of_world(name)
        if isinstance(value, ast.List):  # of substitutions: one within another is none
            if isinstance(world, ast.Name):
                return [f"*{world.id}"]
            return [self._source(one) for one in value.elts]
        return [self._source(world)]

    def _default_of_world(self, name: str | None = "world") -> None:
        """Where the default of a launch argument means Classic's default world, write another."""
        declaration = self.declared.get(name or "")
        default = self._argument(declaration, 1, "default_value") if declaration else None
        value = self._value(default)
        if isinstance(value, ast.Constant) and self._text(value) in DEFAULT_WORLDS:
            self._replace(value, self._default_world())

    def _default_world(self) -> str:
        if self.context.default_world is None:
            return self._quoted("empty.sdf")
        self.files.add(self.context.default_world)
        self.imports += [
            "from launch.substitutions import PathJoinSubstitution",
            "from launch_ros.substitutions import FindPackageShare",
        ]
        parts = ", ".join(map(self._quoted, self.context.default_world.split("/")))
        share = f"FindPackageShare({self._quoted(self.context.package)})"
        return f"PathJoinSubstitution([{share}, {parts}])"

    def _switch(self, value: ast.expr | str) -> bool | None:
        """Whether it is on; None where only a launch says it."""
        text = None if isinstance(value, str) else self._text(value)
        return None if text is None else text.strip().lower() in _TRUE

    def _is_true(self, value: ast.expr) -> bool:
        return self._switch(value) is True

    def _give(self, call: ast.Call, entry: str) -> None:
        """Add launch arguments to an include that has none."""
        last = [*call.args, *(one.value for one in call.keywords)][-1]
        place = self.tree.end(last)
        line = self.tree.source.text[self.tree.source.start_of(last.lineno) :]
        newline = self.tree.source.newline
        argument = f"launch_arguments={{{entry}}}.items()"
        is_one_line = call.lineno == call.end_lineno
        first = [*call.args, *(one.value for one in call.keywords)][0]
        column = 0 if is_one_line else len(line) - len(line.lstrip(" "))
        if not is_one_line:
            column = len(self.tree.source.indent_at(self.tree.start(first)))
        separator = ", " if is_one_line else f",{newline}{' ' * column}"
        self.edits.append(Edit(start=place, end=place, text=f"{separator}{argument}"))

    def _commands(self) -> Iterator[ast.Call]:
        """Port the commands that start Gazebo; those that start a server."""
        for call in self._calls("ExecuteProcess"):
            words = self._value(self._argument(call, -1, "cmd"))
            if not isinstance(words, (ast.List, ast.Tuple)) or not words.elts:
                continue
            texts = [self._text(one) for one in words.elts]
            if texts[0] not in PARTS:
                self._run_of_spawner(words, texts)
                continue
            part = PARTS[texts[0]]
            self._command(words, texts, part)
            if part != PARTS["gzclient"]:
                yield call

    def _command(self, words: ast.List | ast.Tuple, texts: list[str | None], part: str) -> None:
        is_paused = False
        skipped: set[int] = set()
        has_world = False
        for index, text in enumerate(texts):
            if not index or index in skipped:
                continue
            node = words.elts[index]
            following = texts[index + 1] if index + 1 < len(texts) else None
            if text in {"-u", "--pause"}:
                is_paused = True
                self._remove(node, node)
            elif text == "--verbose":
                self._replace(node, f"{self._quoted('-v')}, {self._quoted('4')}")
            elif text in {"-s", "--params-file", "--extra-gazebo-args", "-p", "-g"} or (
                text == "--ros-args"
            ):
                skipped.add(index + 1)
                last = words.elts[index + 1] if following is not None else node
                self._remove(node, node if text == "--ros-args" else last)
                if text == "--ros-args":
                    skipped.discard(index + 1)
                elif following is None or "libgazebo_ros_" not in following:
                    self._list(
                        node,
                        f"`{text} {following or ''}` of Gazebo Classic is gone.",
                        "Load what Gazebo Sim has instead in the world file.",
                    )
            elif text is None or not text.startswith("-"):
                has_world = True
        options = ["gz", "sim", *part.split()]
        options += [] if is_paused or part == PARTS["gzclient"] else ["-r"]
        text = ", ".join(map(self._quoted, options))
        if not has_world and part != PARTS["gzclient"]:
            text += f", {self._default_world()}"
        self._replace(words.elts[0], text)
        self.packages.add(_PACKAGE)

    # The spawner

    def _spawners(self) -> Iterator[ast.Call]:
        for call in self._calls("Node", "LifecycleNode", "LaunchNode"):
            package = self._argument(call, -1, "package")
            executable = self._argument(call, -1, "executable", "node_executable")
            if self._text(package) != _OLD_PACKAGE or package is None or executable is None:
                continue
            if self._text(executable) != _OLD_SPAWNER:
                self._list(
                    call,
                    f"`{self._text(executable)}` of {_OLD_PACKAGE} has no counterpart.",
                    "Remove the node, or start what does its work in Gazebo Sim.",
                )
                continue
            for node, old, new in (
                (package, _OLD_PACKAGE, _PACKAGE),
                (executable, _OLD_SPAWNER, _SPAWNER),
            ):
                if isinstance(node, ast.Constant):
                    self._rename(node, old, new)
                else:
                    self._replace(node, self._quoted(new))
            for keyword in call.keywords:
                if keyword.arg in RENAMED:
                    place = self.tree.start(keyword)
                    end = place + len(keyword.arg)
                    self.edits.append(Edit(start=place, end=end, text=RENAMED[keyword.arg]))
            words = self._value(self._argument(call, -1, "arguments"))
            if isinstance(words, (ast.List, ast.Tuple)):
                self._options(words)
            elif words is not None:
                self._list(
                    words,
                    f"The arguments of {_OLD_SPAWNER} are computed.",
                    f"Write -name for -entity; `{_HELP}` has the rest.",
                )
            self.packages.add(_PACKAGE)
            yield call

    def _run_of_spawner(self, words: ast.List | ast.Tuple, texts: list[str | None]) -> None:
        if _OLD_PACKAGE not in texts or _OLD_SPAWNER not in texts:
            return
        for old, new in ((_OLD_PACKAGE, _PACKAGE), (_OLD_SPAWNER, _SPAWNER)):
            node = words.elts[texts.index(old)]
            if isinstance(node, ast.Constant):
                self._rename(node, old, new)
        self._options(words)
        self.packages.add(_PACKAGE)

    def _options(self, words: ast.List | ast.Tuple) -> None:
        """Write the options of `create` for those of spawn_entity.py."""
        index = 0
        while index < len(words.elts):
            node = words.elts[index]
            value = self._value(node)
            text = self._text(node)
            index += 1
            if text is None or not text.startswith("-") or not isinstance(value, ast.Constant):
                continue
            written = text.split()[0]
            name = next(
                (
                    one
                    for one in SPAWN_ENTITY.names
                    if one == written.lstrip("-")
                    or (len(written) > 3 and one.startswith(written[1:]))  # noqa: PLR2004  as argparse reads them
                ),
                None,
            )
            takes_value = name in SPAWN_ENTITY.with_value and " " not in text
            last = words.elts[index] if takes_value and index < len(words.elts) else node
            index += 1 if takes_value else 0
            if name == SPAWN_ENTITY.entity:
                self._rename(value, written, f"-{CREATE.entity}")
            elif name is not None and name not in CREATE.names:
                self._remove(node, last)
                if name not in _SILENTLY_DROPPED:
                    self._list(
                        node,
                        f"`-{name}` of {_OLD_SPAWNER} is gone.",
                        _ADVICE.get(name, f"`{_HELP}` has what there is."),
                    )

    # The bridge

    def _bridge(self, servers: Sequence[ast.Call], spawners: Sequence[ast.Call]) -> None:
        """Start the bridge beside each spawner, with the clock beside the simulator."""
        with_clock = bool(servers)
        for call in spawners:
            lines = range(call.lineno, (call.end_lineno or call.lineno) + 1)
            rows = [row for line in lines for row in self.context.rows.get(line, ())]
            if rows or with_clock:
                self._start_bridge([call, *servers], rows, with_clock=with_clock)
                with_clock = False
        if with_clock:
            self._start_bridge(servers, (), with_clock=True)

    def _start_bridge(
        self, beside: Sequence[ast.Call], rows: Sequence[BridgeRow], *, with_clock: bool
    ) -> None:
        arguments = [*([CLOCK] if with_clock else []), *map(option, rows)]
        arguments = [*dict.fromkeys(arguments)]
        remappings = [
            f"({self._quoted(row.gz_topic)}, {self._quoted(row.ros_topic)})"
            for row in dict.fromkeys(rows)
            if row.gz_topic != row.ros_topic
        ]
        places = next((found for one in beside if (found := [*self._places_beside(one)])), [])
        if not places:
            self._list(
                beside[0],
                "It is not certain where the bridge of the topics belongs.",
                f"Add a Node of {BRIDGE_PACKAGE} with these arguments: {' '.join(arguments)}",
            )
            return
        for place, indent, form in places:
            node = self._bridge_node(arguments, remappings, indent)
            self.edits.append(Edit(start=place, end=place, text=form.format(node)))
        self.imports.append("from launch_ros.actions import Node")
        self.packages.add(BRIDGE_PACKAGE)

    def _bridge_node(self, arguments: Sequence[str], remappings: Sequence[str], indent: str) -> str:
        inner = f"{indent}    "
        lines = [
            "Node(",
            f"{inner}package={self._quoted(BRIDGE_PACKAGE)},",
            f"{inner}executable={self._quoted(BRIDGE)},",
            f"{inner}arguments=[",
            *(f"{inner}    {self._quoted(one)}," for one in arguments),
            f"{inner}],",
        ]
        if remappings:
            lines += [
                f"{inner}remappings=[",
                *(f"{inner}    {one}," for one in dict.fromkeys(remappings)),
                f"{inner}],",
            ]
        lines += [f"{inner}output={self._quoted('screen')},", f"{indent})"]
        return self.tree.source.newline.join(lines)

    def _places_beside(self, call: ast.Call) -> Iterator[tuple[int, str, str]]:
        """Where an action goes that is started with another one; its indent, and what is around.

        Several where branches of the launch file start it: one in each.
        """
        found = [
            (node, place)
            for node in self._uses(call)
            if (place := self._place_beside(node)) is not None
        ]
        branches: list[list[ast.AST]] = []
        for node, place in found:
            around = [*self._branches(node)]
            if branches and not all(
                any(
                    one is not other and self.parents[one] is self.parents[other]
                    for one in around
                    for other in before
                )
                for before in branches
            ):
                continue
            branches.append(around)
            yield place

    def _branches(self, node: ast.AST) -> Iterator[ast.AST]:
        """The statements around a node that are in a branch of an `if`, by their branch."""
        while (parent := self.parents.get(node)) is not None:
            if isinstance(parent, ast.If) and isinstance(node, ast.stmt):
                branch = parent.body if node in parent.body else parent.orelse
                yield branch[0]
            node = parent

    def _place_beside(self, node: ast.expr) -> tuple[int, str, str] | None:
        newline = self.tree.source.newline
        parent = self.parents.get(node)
        if isinstance(parent, ast.List):
            indent = self.tree.source.indent_at(self.tree.start(node))
            if self.tree.source.text[: self.tree.start(node)].rpartition("\n")[2].strip():
                indent += "    "  # others are on its line
            return self.tree.end(node), indent, f",{newline}{indent}{{}}"
        if isinstance(parent, ast.Call) and name_of(parent) == "add_action":
            statement = self.parents.get(parent)
            if isinstance(statement, ast.Expr) and isinstance(parent.func, ast.Attribute):
                indent = self.tree.source.indent_at(self.tree.start(statement))
                receiver = self._source(parent.func.value)
                form = f"{newline}{indent}{receiver}.add_action({{}})"
                return self.tree.end(statement), indent, form
        return None

    def _uses(self, call: ast.expr, depth: int = 4) -> Iterator[ast.expr]:
        """The call, what starts it, and the names that stand for one of them.

        What is started at once comes before what a handler starts.
        """
        yield call
        parent = self.parents.get(call)
        if isinstance(parent, ast.keyword) and parent.arg in _STARTS:
            handler = self.parents[parent]
            while not isinstance(handler, ast.stmt):
                if isinstance(handler, ast.Call) and name_of(handler) in _HANDLERS:
                    yield from self._uses(handler, depth - 1)
                    return
                handler = self.parents[handler]
        if not isinstance(parent, ast.Assign) or not depth:
            return
        names = {target.id for target in parent.targets if isinstance(target, ast.Name)}
        found = [
            node
            for node in self.tree.all(ast.Name)
            if node.id in names and isinstance(node.ctx, ast.Load)
        ]
        for node in sorted(found, key=lambda node: (self._is_in_handler(node), node.lineno)):
            yield from self._uses(node, depth - 1)

    def _is_in_handler(self, node: ast.AST) -> bool:
        while (node := self.parents.get(node)) is not None:  # type: ignore[assignment]  the last is None
            if isinstance(node, ast.Call) and name_of(node) in _HANDLERS:
                return True
        return False

    # Everything else that names it

    def _lookups(self) -> None:
        """Look up the package of Gazebo Sim where that of Classic was."""
        names = (
            "get_package_share_directory",
            "FindPackageShare",
            "FindPackage",
            "get_package_prefix",
        )
        finds = [
            call
            for call in self._calls("find")
            if isinstance(call.func, ast.Attribute)
            and isinstance(call.func.value, ast.Call)
            and name_of(call.func.value) == "FindPackageShare"
        ]
        for call in (*self._calls(*names), *finds):
            node = self._argument(call, 0, "package", "package_name")
            if isinstance(value := self._value(node), ast.Constant) and value.value == _OLD_PACKAGE:
                self._rename(value, _OLD_PACKAGE, _PACKAGE)
                self.packages.add(_PACKAGE)

    def _variables(self) -> None:
        for node in self.tree.all(ast.Constant):
            new = _RENAMED.get(node.value) if isinstance(node.value, str) else None
            if new is not None:
                self._rename(node, node.value, new)

    def _rest(self) -> None:
        """List what still names Gazebo Classic."""
        for node in self.tree.all(ast.Constant):
            if node in self.done or not isinstance(node.value, str):
                continue
            if isinstance(self.parents.get(node), ast.Expr):  # a docstring
                continue
            if _TRACE.search(node.value) and not re.search(r"\s", node.value.strip()):
                self._list(
                    node,
                    f"`{node.value}` is of Gazebo Classic.",
                    "Replace it by what Gazebo Sim has, or remove it.",
                )


_TRACE = re.compile(
    r"(?<!\w)(?:gazebo_ros|gazebo_ros2_control|gazebo_plugins|gzserver|gzclient)(?!\w)"
    r"|libgazebo_|(?<!\w)GAZEBO_[A-Z]"
)
_STARTS = ("on_start", "on_exit", "actions", "on_completion")
_HANDLERS = ("RegisterEventHandler", "TimerAction")
_ADVICE = {
    "robot_namespace": "Give the plugins of the robot their topics, for example by an argument of "
    "xacro.",
    "reference_frame": "Give the pose in the world.",
    "database": "Name the file of the model with -file.",
    "package_to_model": "Export the folder of the meshes in package.xml.",
    "stdin": "Name a file with -file, or a topic with -topic.",
    "wait": "Start the spawner when what it waits for is there.",
}


def _joined(edits: Sequence[Edit]) -> tuple[Edit, ...]:
    """Of edits that add at one place, one."""
    added: dict[int, str] = {}
    others = []
    for edit in edits:
        if edit.start == edit.end:
            added[edit.start] = added.get(edit.start, "") + edit.text
        else:
            others.append(edit)
    return (*others, *(Edit(start=at, end=at, text=text) for at, text in added.items()))
