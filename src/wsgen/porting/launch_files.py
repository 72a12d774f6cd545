"""Launch files in Python: the simulator, the spawner and the bridge of Gazebo Sim.

Only what names Gazebo Classic is edited; conditions, arguments and handlers stay where they are.
Source: gazebosim/ros_gz, ros_gz_sim/launch/gz_sim.launch.py.in; gazebo_ros, launch/*.launch.py.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.launch_files import RENAMED, tree_of
from wsgen.checks.fixes.source import Edit
from wsgen.checks.rules.controllers import MANAGER
from wsgen.checks.rules.dependencies import FOR_GAZEBO_SIM
from wsgen.gazebo.successors import ODOMETRY, VARIABLES
from wsgen.gazebo.systems import EMPTY_WORLD
from wsgen.launching.spawner_options import CREATE, SPAWN_ENTITY, SPAWNERS
from wsgen.model.facts import PROGRAMS, ROS2_CONTROL_HARDWARE
from wsgen.model.target import CLASSIC, SIM, Target
from wsgen.porting.bridges import BRIDGE_PACKAGE, STAMPER, BridgeWriter
from wsgen.porting.manifests import SUCCESSORS
from wsgen.porting.ported import FilePort
from wsgen.porting.porter import MODEL, NAMESPACE
from wsgen.porting.python_edits import PythonEdits, argument
from wsgen.text.pythontree import name_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from wsgen.checks.fixes.launch_files import Tree
    from wsgen.checks.fixes.source import SourceText
    from wsgen.porting.parameters import Stamper
    from wsgen.porting.ported import BridgeRow
    from wsgen.porting.python_edits import Entry, Text

    Given = ast.expr | str  # the value of a launch argument; a text is Python of ours


(OLD_PACKAGE, OLD_SPAWNER) = next(one for one in SPAWNERS if SPAWNERS[one] is SPAWN_ENTITY)
PACKAGE, SPAWNER = (PROGRAMS[SIM][key][1] for key in ("package", "spawner"))
LAUNCH_FILE = PROGRAMS[SIM]["launch_file"][1]
_HELP = f"ros2 run {PACKAGE} {SPAWNER} --help"
# Launch file of gazebo_ros, and program -> the option of `gz sim` that makes it the same part.
CLIENT = "-g "
PARTS = {"gazebo": "", "gzserver": "-s ", "gzclient": CLIENT}
FILES = {f"{name}.launch.py": part for name, part in PARTS.items()}
FILES_NOW = dict.fromkeys(FILES, LAUNCH_FILE)
# Texts that are other ones for Gazebo Sim, wherever they stand.
NAMES = {
    **VARIABLES,
    ROS2_CONTROL_HARDWARE[CLASSIC][1]: ROS2_CONTROL_HARDWARE[SIM][1],
    **{old: new for old, new in FOR_GAZEBO_SIM.items() if old.startswith(("ros_ign", "ign_"))},
    "ign_args": "gz_args",
    "ign_gazebo.launch.py": LAUNCH_FILE,
    "ign_ros2_control/IgnitionSystem": ROS2_CONTROL_HARDWARE[SIM][1],
}
# Launch argument of gazebo_ros -> what `gz_args` has for it where it is true, and where it is not.
SWITCHES = {"pause": ("", "-r "), "gui": ("", "-s "), "verbose": ("-v 4 ", "")}
ON = {"pause": False, "gui": True, "verbose": False}  # their defaults
ENDS = ("server_required", "gui_required")  # of which `on_exit_shutdown` is the same
# Launch arguments that Gazebo Sim needs no counterpart of.
WITHOUT_LOSS = ("init", "factory", "force_system", "debug", "server", "lockstep", "headless")
DEFAULT_WORLDS = ("", "empty.world", "worlds/empty.world")
TRUE = ("true", "1")
# Options of spawn_entity.py without a counterpart, and without a loss: `create` waits by itself.
DROPPED = ("timeout", "spawn_service_timeout", "gazebo_namespace", "unpause", "b")
_NAMESPACE = "robot_namespace"
# Options of it -> what bridges have for their values.
OF_BRIDGE = {SPAWN_ENTITY.entity: MODEL, _NAMESPACE: NAMESPACE}
LOST_NAMESPACE = (
    f"`-{_NAMESPACE}` of {OLD_SPAWNER} is gone, and which robot it was for is not known.",
    "Bridge the topics of the robot under their names in the namespace.",
)
ADVICE = {
    "reference_frame": "Give the pose in the world.",
    "database": "Name the file of the model with -file.",
    "package_to_model": "Export the folder of the meshes in package.xml.",
    "stdin": "Name a file with -file, or a topic with -topic.",
    "wait": "Start the spawner when what it waits for is there.",
}
# Program that no distribution since Humble has -> what it is called.
PROGRAMS_RENAMED = {("controller_manager", f"{name}.py"): name for name in ("spawner", "unspawner")}
# What is given to the node of Gazebo Classic, as an argument of a launch file or of a command.
_EXTRA = "extra-gazebo-args"
_ROS2_LAUNCH = ("ros2", "launch")
_OF_THE_NODE = (
    "Gazebo Sim is not a node of ROS: what that of Gazebo Classic was given is gone.",
    "Remove a file of parameters that nothing else reads.",
)
_LOOKS_FOR_ELEMENTS = ("iter", "find", "findall", "iterfind")  # methods of ElementTree
_INSTALLED_IN = "/opt/ros/"
_INSTALLED = re.compile(rf"{_INSTALLED_IN}\w+")
_NAMED = re.compile(r"(?i)gazebo|gzserver|gzclient")
_TRACE = re.compile(
    r"(?<!\w)(?:gazebo_ros|gazebo_ros2_control|gazebo_plugins|gzserver|gzclient)(?!\w)"
    r"|libgazebo_|(?<!\w)GAZEBO_[A-Z]"
)
_LOOKUPS = (
    *("get_package_share_directory", "get_package_share_path", "get_package_prefix"),
    *("FindPackageShare", "FindPackage", "FindPackagePrefix"),
)


# Packages that are looked up -> what they are called for Gazebo Sim.
_LOOKED_UP = {name: SUCCESSORS[name] for name in (OLD_PACKAGE, "gazebo_ros2_control_demos")}
OF_WORLD = 0  # no line of a call
_OF_YAML = (".yaml", ".yml")


class WorldTaker(NamedTuple):
    """A launch file that is given the world by arguments."""

    name: str  # of the file
    package: str
    default_world: str | None  # as that of a `Context`
    arguments: frozenset[str]


class Context(NamedTuple):
    """What the evaluation of a launch file and its robots gives to its port."""

    # The topics of the robots that each spawner puts into the simulator, by the line of its call;
    # those of the models of the world by `OF_WORLD`.
    rows: Mapping[int, Sequence[BridgeRow]]
    package: str  # that it belongs to
    distro: str  # that it is ported to
    # The file of the package that takes the place of Classic's default world; None: Gazebo's own.
    default_world: str | None = None
    # The topics of all robots, for spawners whose robot is only known when it is launched.
    any_rows: Sequence[BridgeRow] = ()
    are_all: bool = False  # whether none of them has a name that is only known in a launch
    clocks: Collection[str] = ()  # files that give the node of Gazebo Classic nothing but its clock
    stampers: Sequence[Stamper] = ()  # for the controllers that the launch file may start
    takers: Collection[WorldTaker] = ()
    frames: Collection[str] = ()  # of sensors that named none, and do after the port
    workspace: Collection[str] = ()  # the names of all packages of the workspace

    def rows_at(self, lines: range) -> Sequence[BridgeRow] | None:
        """The topics of the robots of a spawner on these lines; None where they are not known."""
        found = [self.rows[line] for line in lines if line in self.rows]
        return [row for rows in found for row in rows] if found else None


UNKNOWN_ROBOT = (
    "Which robot the spawner puts into the simulator is only known when it is launched.",
    "Check that the bridge has its topics: it has those of all robots, where they are fixed.",
)


def port_launch_file(source: SourceText, context: Context) -> FilePort:
    """Port a launch file, or a Python module that one imports."""
    words = (MANAGER, *(one.name for one in context.takers))
    if _NAMED.search(source.text) is None and not any(word in source.text for word in words):
        return FilePort()
    tree = tree_of(source)
    return FilePort() if tree is None else _Port(tree, context).result()


def option_of(word: str) -> str | None:
    """The option of spawn_entity.py that a word is, as argparse reads it."""
    name = word.lstrip("-")
    begun = [one for one in SPAWN_ENTITY.names if len(name) > 1 and one.startswith(name)]
    return name if name in SPAWN_ENTITY.names else begun[0] if len(begun) == 1 else None


class _Port(PythonEdits):
    def __init__(self, tree: Tree, context: Context) -> None:
        super().__init__(tree)
        self.context = context
        self.packages: set[str] = set()
        self.files: set[str] = set()
        self.worlds: set[str] = set()
        self.names: dict[ast.Call, dict[str, ast.expr]] = {}  # that spawners give, see `BridgeRow`
        # Elements of robots with frames, which some launch files write anew for each robot.
        frame_tag = Target(distro=context.distro, simulator=SIM).frame_tag
        self.frames = {**ODOMETRY, "frame_name": frame_tag}
        self.declared = {
            name: call
            for call in self.calls("DeclareLaunchArgument")
            if (name := self.said(argument(call, 0, "name"))) is not None
        }

    def result(self) -> FilePort:
        servers = [*self._includes(), *self._commands()]
        spawners = [*self._spawners()]
        self._pass_worlds()
        started = [
            [one for one in ones if not self._is_in_vain(one)] for ones in (servers, spawners)
        ]
        self._bridges(*started)
        self._controllers(is_simulated=bool(servers or spawners))
        self._names()
        self._rest()
        return FilePort(
            edits=self.all_edits(),
            unported=tuple(self.unported),
            packages=frozenset(self.packages),
            files=frozenset(self.files),
            worlds=frozenset(self.worlds),
        )

    # The simulator

    def _includes(self) -> Iterator[ast.Call]:
        """Port what includes the launch files of gazebo_ros; those that start a server."""
        for call in self.calls("IncludeLaunchDescription"):
            texts = [*self.texts(call)]
            file = next((one for one in texts if one.text.rpartition("/")[2] in FILES), None)
            if file is None or not any(OLD_PACKAGE in one.text for one in texts):
                continue
            name = file.text.rpartition("/")[2]
            for one in texts:
                # Some ask a shell for the folder: `ros2 pkg prefix gazebo_ros`.
                if OLD_PACKAGE in re.split(r"[/\s]", one.text) or one is file:
                    renamed = [(name, LAUNCH_FILE), (OLD_PACKAGE, PACKAGE)]
                    older = _INSTALLED.search(one.text)
                    renamed += [(older[0], _INSTALLED_IN + self.context.distro)] if older else []
                    self.rename(one, *renamed)
            self.packages.add(PACKAGE)
            self._arguments(call, FILES[name])
            if FILES[name] != CLIENT:
                yield call

    def _arguments(self, call: ast.Call, part: str) -> None:
        """Write `gz_args` from the launch arguments of gazebo_ros."""
        given = argument(call, 1, "launch_arguments")
        written = self.value(given)
        entries = self.entries(written)
        if entries is None:
            self.leave(
                given or call,
                "The launch arguments of Gazebo Classic are computed.",
                f"Give {LAUNCH_FILE} `gz_args`, for example '-r world.sdf', instead.",
            )
            return
        of_server = ("world", *SWITCHES)
        # The included launch file sees those that this one declares, or is given.
        values: dict[str, Given] = {
            name: f"LaunchConfiguration({self.quoted(name)}{self._if_not_given(name)})"
            for name in of_server
            if name in self.declared
        }
        values.update({name: one.value for name, one in entries.items() if name in of_server})
        form = "({}, {})" if isinstance(written, (ast.List, ast.Tuple)) else "{}: {}"
        lines = [form.format(self.quoted("gz_args"), self._gz_args(values, part))]
        if any(self._switch(entries[name].value) for name in ENDS if name in entries):
            lines.append(form.format(self.quoted("on_exit_shutdown"), self.quoted("true")))
        if given is None:
            self._give(call, lines[0])
        elif not entries:
            self.replace(given, f"{{{', '.join(lines)}}}.items()")
        else:
            self._replace_entries(entries, lines)

    def _if_not_given(self, name: str) -> str:
        """The default of a launch argument that is declared in vain, for lack of an action."""
        if not self._is_in_vain(self.declared[name]):
            return ""
        default = self._default_world() if name == "world" else self.quoted(str(ON[name]).lower())
        return f", default={default}"

    def _is_in_vain(self, call: ast.Call) -> bool:
        """Whether an action is given a name that nothing uses."""
        names = {self.written(one) for one in getattr(self.parents.get(call), "targets", ())}
        loaded = (one.id for one in self.tree.all(ast.Name) if isinstance(one.ctx, ast.Load))
        return bool(names) and names.isdisjoint(loaded)

    def _replace_entries(self, entries: Mapping[str, Entry], lines: Sequence[str]) -> None:
        """Write new entries in place of the most telling one; the others go."""
        kept = "world" if "world" in entries else next(iter(entries))
        for name, one in entries.items():
            first, last = one.whole
            if name == kept:
                indent = self.source.indent_at(self.tree.start(first))
                glue = f",{self.source.newline}{indent}" if self.is_first_on_line(first) else ", "
                self.replace(first, glue.join(lines), last)
            else:
                self.remove(first, last)
            texts = [text.text for text in self.texts(one.value)]
            if name == "params_file" or any("--ros-args" in text for text in texts):
                self._leave_parameters(one.key, texts)
            elif name not in {"world", *SWITCHES, *ENDS, *WITHOUT_LOSS}:
                self.leave(
                    one.key,
                    f"The launch argument `{name}` of Gazebo Classic is gone.",
                    "Write what it did into `gz_args`, if `gz sim --help` has it.",
                )

    def _leave_parameters(self, node: ast.expr, texts: Sequence[str]) -> None:
        """List the parameters of the node of Gazebo Classic, unless they are those of its clock.

        Gazebo Sim publishes the clock in each step.
        """
        files = [name for text in texts if (name := text.rpartition("/")[2]).endswith(_OF_YAML)]
        if not files or any(name not in self.context.clocks for name in files):
            self.leave(node, *_OF_THE_NODE)

    def _give(self, call: ast.Call, entry: str) -> None:
        """Add launch arguments to an include that has none."""
        arguments = [*call.args, *(one.value for one in call.keywords)]
        glue = ", "
        if call.lineno != call.end_lineno:
            indent = self.source.indent_at(self.tree.start(arguments[0]))
            glue = f",{self.source.newline}{indent}"
        text = f"{glue}launch_arguments={{{entry}}}.items()"
        self.insert(self.tree.end(arguments[-1]), text)

    def _gz_args(self, values: Mapping[str, Given], part: str) -> str:
        """The value of `gz_args`, as Python."""
        if part == CLIENT:
            verbose = values.get("verbose")
            is_verbose = verbose is not None and self._switch(verbose)
            options = part + SWITCHES["verbose"][0] if is_verbose else part
            return self.quoted(options.rstrip())
        pieces: list[str] = []
        options = part
        for name, (on, off) in SWITCHES.items():
            if name == "gui" and part:
                continue
            value = values.get(name)
            is_on = ON[name] if value is None else self._switch(value)
            if is_on is not None:
                options += on if is_on else off
                continue
            pieces += [self.quoted(options)] if options else []
            options = ""
            self.imports.append("from launch.substitutions import IfElseSubstitution")
            said = value if isinstance(value, str) else self.written(value) if value else ""
            pieces.append(f"IfElseSubstitution({said}, {self.quoted(on)}, {self.quoted(off)})")
        pieces += [self.quoted(options)] if options else []
        pieces += self._world(values.get("world"))
        is_text = len(pieces) == 1 and pieces[0].startswith(self.quote)
        return pieces[0] if is_text else f"[{', '.join(pieces)}]"

    def _world(self, world: Given | None) -> list[str]:
        """The world as elements of a list of substitutions."""
        if isinstance(world, str):
            self._write_default_of("world")
            self.imports.append("from launch.substitutions import LaunchConfiguration")
            return [world]
        if world is None or self.said(world) in DEFAULT_WORLDS:
            return [self._default_world()]
        texts = [one.text for one in self.texts(world)]
        if OLD_PACKAGE in texts:
            if not any(text in DEFAULT_WORLDS[1:] for text in texts):
                self.leave(
                    world,
                    "The world is one that Gazebo Classic brings; Gazebo Sim does not have it.",
                    "Copy what you need of it into a world file of the package.",
                )
            return [self._default_world()]
        value = self.value(world)
        self._write_default_of(self._configuration(value))
        if isinstance(value, ast.List):  # a list of substitutions cannot be in another one
            if isinstance(world, ast.Name):
                return [f"*{world.id}"]
            return [self.written(one) for one in value.elts]
        return [self.written(world)]

    def _configuration(self, node: ast.expr | None) -> str | None:
        """The name of the launch argument that a node is the value of."""
        value = self.value(node)
        if isinstance(value, ast.Call) and name_of(value) == "LaunchConfiguration":
            return self.said(argument(value, 0, "variable_name"))
        return None

    def _write_default_of(self, name: str | None, taker: WorldTaker | None = None) -> None:
        """Where the default of a launch argument means Classic's default world, write another."""
        if name is None:
            return
        self.worlds.add(name)
        declaration = self.declared.get(name)
        default = argument(declaration, 1, "default_value") if declaration else None
        text = self.text(default)
        if text is not None and text.text in DEFAULT_WORLDS:
            self.replace(text.node, self._default_world(taker))

    def _pass_worlds(self) -> None:
        """Port the worlds that are given to other launch files."""
        for call in self.calls("IncludeLaunchDescription"):
            texts = [one.text for one in self.texts(call)]
            names = {text.rpartition("/")[2] for text in texts}
            takers = [one for one in self.context.takers if one.name in names]
            if not takers or any(OLD_PACKAGE in text for text in texts):
                continue
            packages = [*texts, self.context.package]
            taker = next(
                (one for name in packages for one in takers if one.package == name), takers[0]
            )
            given = self.entries(self.value(argument(call, 1, "launch_arguments"))) or {}
            for name in taker.arguments:
                if name not in given:
                    self._write_default_of(name if name in self.declared else None, taker)
                    continue
                self._write_world(given[name].value, taker)

    def _write_world(self, world: ast.expr, taker: WorldTaker | None = None) -> None:
        """Where Classic's default world is given, or an argument with it, write another."""
        text = self.text(world)
        if text is not None and text.text in DEFAULT_WORLDS:
            self.replace(text.node, self._default_world(taker))
        self._write_default_of(self._configuration(world), taker)

    def _default_world(self, taker: WorldTaker | None = None) -> str:
        of = taker or self.context
        if of.default_world is None:
            return self.quoted(EMPTY_WORLD)
        if of.package == self.context.package:
            self.files.add(of.default_world)
        self.imports += [
            "from launch.substitutions import PathJoinSubstitution",
            "from launch_ros.substitutions import FindPackageShare",
        ]
        parts = ", ".join(map(self.quoted, of.default_world.split("/")))
        share = f"FindPackageShare({self.quoted(of.package)})"
        return f"PathJoinSubstitution([{share}, {parts}])"

    def _switch(self, value: Given) -> bool | None:
        """Whether it is on; None where only a launch says it."""
        text = None if isinstance(value, str) else self.said(value)
        return None if text is None else text.strip().lower() in TRUE

    def _commands(self) -> Iterator[ast.Call]:
        """Port the commands that start Gazebo; those that start a server."""
        for call in self.calls("ExecuteProcess"):
            words = self.value(argument(call, None, "cmd"))
            if not isinstance(words, (ast.List, ast.Tuple)) or not words.elts:
                continue
            texts = [self.said(one) for one in words.elts]
            part = PARTS.get(texts[0] or "")
            self._lines(words.elts)
            if part is None and self._is_launched(words.elts, texts):
                yield call
            if part is None:
                self._run_of_spawner(words.elts, texts)
                continue
            self._command(words.elts, texts, part)
            if part != CLIENT:
                yield call

    def _command(self, words: Sequence[ast.expr], texts: Sequence[str | None], part: str) -> None:
        """Write the words of `gz sim` for those of `gazebo`."""
        is_paused = has_world = False
        index = 1
        while index < len(words):
            node, text = words[index], texts[index]
            index += 1
            if text in {"-u", "--pause"}:
                is_paused = True
                self.remove(node, node)
            elif text == "--verbose":
                self.replace(node, f"{self.quoted('-v')}, {self.quoted('4')}")
            elif text in {"--ros-args", _EXTRA}:
                self.remove(node, words[-1])
                if any(word is None or word.startswith("-") for word in texts[index:]):
                    files = (text.text for word in words[index:] for text in self.texts(word))
                    self._leave_parameters(node, [*files])
                break
            elif text in {"-s", "-g", "-p", "--params-file", f"--{_EXTRA}"}:
                given = texts[index] if index < len(words) else ""
                self.remove(node, words[min(index, len(words) - 1)])
                index += 1
                if given is None or "libgazebo_ros_" not in given:
                    self.leave(
                        node,
                        f"`{text} {given or ''}` of Gazebo Classic is gone.",
                        "Load what Gazebo Sim has instead in the world file.",
                    )
            elif text is None or not text.startswith("-"):
                has_world = True
                self._write_world(node)
        options = ["gz", "sim", *part.split(), *([] if is_paused or part == CLIENT else ["-r"])]
        command = ", ".join(map(self.quoted, options))
        if not has_world and part != CLIENT:
            command += f", {self._default_world()}"
        self.replace(words[0], command)
        self.packages.add(PACKAGE)

    def _is_launched(self, words: Sequence[ast.expr], texts: Sequence[str | None]) -> bool:
        """Port `ros2 launch gazebo_ros gazebo.launch.py`; whether it starts a server."""
        file = texts[3] if len(texts) > len(_ROS2_LAUNCH) + 1 else None
        if tuple(texts[:2]) != _ROS2_LAUNCH or texts[2] != OLD_PACKAGE or file not in FILES:
            return False
        part = FILES[file]
        self.replace(words[2], self.quoted(PACKAGE))
        self.replace(words[3], self.quoted(LAUNCH_FILE))
        self.packages.add(PACKAGE)
        given: dict[str, tuple[ast.expr, Text]] = {}
        for word in words[4:]:
            first = next(self.texts(word, depth=0), None)
            if first is not None and ":=" in first.text:
                given[first.text.partition(":=")[0]] = word, first
        options = "".join([part, *self._options_of(given, part)])
        world = given.pop("world", None)
        for word, _ in given.values():
            self.remove(word, word)
        if world is not None and (part == CLIENT or self.said(world[0]) == "world:="):
            self.remove(world[0], world[0])
            world = None
        if world is not None:
            self.rename(world[1], ("world:=", f"gz_args:={options}"))
            return True
        text = self.quoted(f"gz_args:={options}")
        text = text if part == CLIENT else f"[{text}, {self._default_world()}]"
        self.insert(self.tree.end(words[3]), f", {text}")
        return part != CLIENT

    def _options_of(self, given: Mapping[str, tuple[ast.expr, Text]], part: str) -> Iterator[str]:
        """What `gz sim` has for the words that give launch arguments to gazebo_ros."""
        for name, (on, off) in SWITCHES.items():
            if (name == "gui" and part) or (name == "pause" and part == CLIENT):
                continue
            word, first = given.get(name, (None, None))
            if word is None or first is None:
                yield on if ON[name] else off
            elif (said := self.said(word)) is not None:
                yield on if said.partition(":=")[2].lower() in TRUE else off
            else:
                self.leave(
                    word,
                    f"Only a launch says what `{name}` of Gazebo Classic is.",
                    "Write what it did into `gz_args`: `gz sim --help` has the options.",
                )
        for name in given.keys() - {"world", *SWITCHES, *ENDS, *WITHOUT_LOSS}:
            self.leave(
                given[name][0],
                f"The launch argument `{name}` of Gazebo Classic is gone.",
                "Write what it did into `gz_args`, if `gz sim --help` has it.",
            )

    # The spawner

    def _spawners(self) -> Iterator[ast.Call]:
        """Port the nodes that spawn a robot."""
        for call in self.calls("Node", "LifecycleNode"):
            package = argument(call, None, "package")
            executable = argument(call, None, "executable", "node_executable")
            if package is None or executable is None:
                continue
            if self.said(package) != OLD_PACKAGE:
                self._rename_program(call, self.said(package), executable)
                continue
            if self.said(executable) != OLD_SPAWNER:
                self.leave(
                    call,
                    f"`{self.said(executable)}` of {OLD_PACKAGE} has no counterpart.",
                    "Remove the node, or start what does its work in Gazebo Sim.",
                )
                continue
            for node, old, new in (
                (package, OLD_PACKAGE, PACKAGE),
                (executable, OLD_SPAWNER, SPAWNER),
            ):
                text = self.text(node)
                if text is not None and text.node is node:
                    self.rename(text, (old, new))
                else:
                    self.replace(node, self.quoted(new))
            self._rename_keywords(call)
            words = self.value(argument(call, None, "arguments"))
            if isinstance(words, (ast.List, ast.Tuple)):
                self.names[call] = self._options(words.elts)
            elif words is not None:
                self.leave(
                    words,
                    f"The arguments of {OLD_SPAWNER} are computed.",
                    f"Write -name for -entity; `{_HELP}` has the rest.",
                )
            self.packages.add(PACKAGE)
            yield call

    def _rename_program(self, call: ast.Call, package: str | None, executable: ast.expr) -> None:
        """Write what later distributions call a program, and the arguments of `Node`."""
        text = self.text(executable)
        new = None if text is None else PROGRAMS_RENAMED.get((package or "", text.text))
        if text is not None and new is not None:
            self.rename(text, (text.text, new))
        self._rename_keywords(call)

    def _rename_keywords(self, call: ast.Call) -> None:
        """Write what `Node` has taken since Galactic."""
        for keyword in call.keywords:
            new = RENAMED.get(keyword.arg or "")
            if new is not None:
                written = self.written(keyword)
                end = self.tree.start(keyword.value)
                start = self.tree.start(keyword)
                middle = written[len(keyword.arg or "") : end - start]
                self.edits.append(Edit(start=start, end=end, text=new + middle))

    def _lines(self, nodes: Sequence[ast.expr]) -> None:
        """Rename programs in the lines that a shell gets, and list those of Gazebo Classic."""
        for text in filter(None, map(self.text, nodes)):
            words = text.text.split()
            for (package, old), new in PROGRAMS_RENAMED.items():
                if package in words and old in words:
                    self.rename(text, (old, new))
            if words[1:] and (words[0] in PARTS or OLD_PACKAGE in words):
                self.leave(
                    text.node,
                    f"`{text.text.strip()}` starts what Gazebo Sim does not have.",
                    f"Write `gz sim` with its options, or `ros2 run {PACKAGE} {SPAWNER}`.",
                )

    def _run_of_spawner(self, words: Sequence[ast.expr], texts: Sequence[str | None]) -> None:
        """Port a `ros2 run gazebo_ros spawn_entity.py`."""
        if OLD_PACKAGE not in texts or OLD_SPAWNER not in texts:
            return
        for old, new in ((OLD_PACKAGE, PACKAGE), (OLD_SPAWNER, SPAWNER)):
            text = self.text(words[texts.index(old)])
            if text is not None:
                self.rename(text, (old, new))
        names = self._options(words)
        if NAMESPACE in names:
            self.leave(names[NAMESPACE], *LOST_NAMESPACE)
        self.packages.add(PACKAGE)

    def _options(self, words: Sequence[ast.expr]) -> dict[str, ast.expr]:
        """Write the options of `create` for those of spawn_entity.py; gives the names in them."""
        names: dict[str, ast.expr] = {}
        index = 0
        while index < len(words):
            node = words[index]
            text = self.text(node)
            index += 1
            if text is None or not text.text.startswith("-"):
                continue
            word, _, value = text.text.partition(" ")
            name = option_of(word)
            last = node
            if name in SPAWN_ENTITY.with_value and not value and index < len(words):
                last = words[index]
                index += 1
            if last is not node and name in OF_BRIDGE:
                names[OF_BRIDGE[name]] = last
            if name == SPAWN_ENTITY.entity:
                self.rename(text, (word, f"-{CREATE.entity}"))
            elif name is not None and name not in CREATE.names:
                self.remove(node, last)
                if name not in DROPPED and name not in OF_BRIDGE:
                    self.leave(
                        node,
                        f"`-{name}` of {OLD_SPAWNER} is gone.",
                        ADVICE.get(name, f"`{_HELP}` has what there is."),
                    )
        return names

    # The bridge

    def _bridges(self, servers: Sequence[ast.Call], spawners: Sequence[ast.Call]) -> None:
        """Start the bridge beside each spawner, with the clock beside the simulator."""
        is_started = False
        with_clock = bool(servers)
        of_world = self.context.rows.get(OF_WORLD, ())
        for call in spawners:
            lines = range(call.lineno, (call.end_lineno or call.lineno) + 1)
            rows, names = self.context.rows_at(lines), self.names.get(call, {})
            if rows is None:
                rows = self.context.any_rows
                if rows and not self.context.are_all:
                    self.leave(call, *UNKNOWN_ROBOT)
                if NAMESPACE in names and self.said(names[NAMESPACE]) != "":
                    self.leave(names[NAMESPACE], *LOST_NAMESPACE)
            if NAMESPACE in names:  # there may be several robots, and names are known here alone
                is_started |= bool(rows) and BridgeWriter(self, names).start(
                    [call], rows, with_clock=False
                )
            elif rows or with_clock:
                rows = [*(of_world if with_clock else ()), *rows]
                writer = BridgeWriter(self, names)
                is_started |= writer.start([call, *servers], rows, with_clock=with_clock)
                with_clock = False
        if with_clock:
            is_started |= BridgeWriter(self).start(servers, of_world, with_clock=True)
        if is_started:
            self.packages.add(BRIDGE_PACKAGE)

    # The controllers

    def _controllers(self, *, is_simulated: bool) -> None:
        """Give the commands of controllers a time, where they start."""
        sim_time = "True" if is_simulated else None
        if sim_time is None and "use_sim_time" in self.declared:
            sim_time = f"LaunchConfiguration({self.quoted('use_sim_time')})"
        stampers = {one.controller.rpartition("/")[2]: one for one in self.context.stampers}
        renamed = self._remappings_of_the_manager()
        for call in self.calls("Node", "ExecuteProcess"):
            if name_of(call) == "Node":
                if self.said(argument(call, None, "package")) != MANAGER:
                    continue
                program = self.text(argument(call, None, "executable", "node_executable"))
                if program is None or program.text.removesuffix(".py") != "spawner":
                    continue
            words = self.value(argument(call, None, "arguments", "cmd"))
            listed = words.elts if isinstance(words, (ast.List, ast.Tuple)) else ()
            for name in " ".join(filter(None, map(self.said, listed))).split():
                stamper = stampers.get(name)
                if stamper is None:
                    continue
                stamper = stamper._replace(source=renamed.get(stamper.source, stamper.source))
                if BridgeWriter(self).stamp(call, stamper, sim_time):
                    del stampers[name]
                    self.packages.add(STAMPER)

    def _remappings_of_the_manager(self) -> dict[str, str]:
        """What topics of controllers are called where the launch file starts their manager."""
        found: dict[str, str] = {}
        for call in self.calls("Node"):
            if self.said(argument(call, None, "package")) == MANAGER:
                pairs = self.entries(self.value(argument(call, None, "remappings")))
                for name, one in (pairs or {}).items():
                    found[name] = self.said(one.value) or name
        return found

    # Everything else that names Gazebo Classic

    def _names(self) -> None:
        """Write the names of Gazebo Sim where those of Classic are looked up or set."""
        self._paths()
        finds = [
            call
            for call in self.calls("find")
            if isinstance(call.func, ast.Attribute)
            and isinstance(call.func.value, ast.Call)
            and name_of(call.func.value) == "FindPackageShare"
        ]
        for call in (*self.calls(*_LOOKUPS), *finds):
            text = self.text(argument(call, 0, "package", "package_name"))
            new = _LOOKED_UP.get(text.text) if text is not None else None
            if text is not None and new is not None and text.text not in self.context.workspace:
                self.rename(text, (text.text, new))
                self.packages.add(new)
        for call in self.calls(*_LOOKS_FOR_ELEMENTS):
            text = self.text(argument(call, 0))
            path, _, name = text.text.rpartition("/") if text else ("", "", "")
            new = self.frames.get(name)
            if text is None or new is None or text.node not in call.args:
                continue
            if path.strip("./"):
                self.leave(
                    call,
                    f"The port has written <{new}> for <{name}>, which may be elsewhere.",
                    "Look it up where it is.",
                )
            elif name == "frame_name" and self.context.frames and name_of(call) != "find":
                # It looks for those that are named.
                found = self.written(call).replace(name, new)
                own = sorted(one for one in self.context.frames if "$" not in one)
                frames = ", ".join(map(self.quoted, own))
                self.replace(call, f"[one for one in {found} if one.text not in {{{frames}}}]")
            else:
                self.rename(text, (name, new))
        for text in self.texts(self.tree.module, depth=0):
            if text.text in DEFAULT_WORLDS[1:] and self._is_whole_value(text.node):
                self.replace(text.node, self._default_world())
            new = NAMES.get(text.text)
            if new is not None:
                self.rename(text, (text.text, new))
        self._append_to_variables()

    def _paths(self) -> None:
        """Write the names of Gazebo Sim into paths that no action uses any more."""
        for call in self.calls("join", "PathJoinSubstitution"):
            texts = [*self.texts(call)]
            names = [one.text.rpartition("/")[2] for one in texts]
            words = [re.split(r"[/\s]", one.text) for one in texts]
            if any(name in FILES for name in names) and any(OLD_PACKAGE in one for one in words):
                for one, name, parts in zip(texts, names, words, strict=True):
                    if OLD_PACKAGE in parts or name in FILES:
                        self.rename(one, (OLD_PACKAGE, PACKAGE), (name, FILES_NOW.get(name, name)))

    def _append_to_variables(self) -> None:
        """Where two variables become one, have the second add to what the first one sets."""
        seen: set[str] = set()
        for call in sorted(self.calls("SetEnvironmentVariable"), key=lambda one: one.lineno):
            name = self.said(argument(call, 0, "name"))
            becomes = VARIABLES.get(name or "")
            if becomes is None:
                continue
            if becomes in seen:
                end = self.tree.end(call.func)
                start = end - len(name_of(call))
                self.edits.append(Edit(start=start, end=end, text="AppendEnvironmentVariable"))
                if isinstance(call.func, ast.Name):
                    self.imports.append("from launch.actions import AppendEnvironmentVariable")
            seen.add(becomes)

    def _is_whole_value(self, node: ast.expr) -> bool:
        """Whether it is what a launch argument is given, or its default."""
        parent = self.parents.get(node)
        if isinstance(parent, ast.keyword):
            return parent.arg in {"default_value", "default"}
        return isinstance(parent, ast.Dict) and node in parent.values

    def _rest(self) -> None:
        """List what still names it."""
        for node, text in self.texts(self.tree.module, depth=0):
            if node in self.done or isinstance(self.parents.get(node), ast.Expr):  # a docstring
                continue
            if _TRACE.search(text) and not re.search(r"\s", text.strip()):
                self.leave(
                    node,
                    f"`{text}` is of Gazebo Classic.",
                    "Replace it by what Gazebo Sim has, or remove it.",
                    is_note=text.startswith("GAZEBO_"),  # a variable that nothing reads any more
                )
