"""Launch files in XML and YAML: the simulator, the spawner and the bridge of Gazebo Sim.

It is what `launch_files` does in Python; the values are those of the launch frontend. Source:
ros2/launch, launch/share/launch/frontend/grammar.lark; gazebosim/ros_gz, gz_sim.launch.py.in.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import Edit, join_additions
from wsgen.checks.rules.controllers import MANAGER
from wsgen.gazebo.successors import VARIABLES
from wsgen.gazebo.systems import EMPTY_WORLD
from wsgen.launching.spawner_options import CREATE, SPAWN_ENTITY
from wsgen.porting.bridges import BRIDGE, BRIDGE_PACKAGE, CLOCK, STAMPER, option, parted, renamed
from wsgen.porting.launch_files import (
    ADVICE,
    CLIENT,
    DEFAULT_WORLDS,
    DROPPED,
    ENDS,
    FILES,
    LAUNCH_FILE,
    LOST_NAMESPACE,
    NAMES,
    OF_BRIDGE,
    OF_WORLD,
    OLD_PACKAGE,
    OLD_SPAWNER,
    ON,
    PACKAGE,
    PARTS,
    PROGRAMS_RENAMED,
    SPAWNER,
    SWITCHES,
    TRUE,
    UNKNOWN_ROBOT,
    WITHOUT_LOSS,
    option_of,
)
from wsgen.porting.ported import FilePort, Unported
from wsgen.porting.porter import NAMESPACE
from wsgen.porting.xml_edits import Block, Editor, read_nodes

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.porting.launch_files import Context
    from wsgen.porting.ported import BridgeRow
    from wsgen.porting.xml_edits import Node

_OF_CLASSIC = re.compile(r"(?i)gazebo|gzserver|gzclient")
_FILE = re.compile(
    rf"\$\(find-pkg-share\s+{OLD_PACKAGE}\)/launch/({'|'.join(map(re.escape, FILES))})"
)
# A word of a command line: substitutions may hold blanks.
_WORD = re.compile(r"(?:\$\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)|'[^']*'|[^\s$']|\$)+")
_RENAMED = re.compile("|".join(rf"(?<![\w/]){re.escape(name)}(?![\w/])" for name in NAMES))
# An action of a launch file in YAML.
_ACTION = re.compile(r"(?m)^([ \t]*)- (\w+)[ \t]*:[ \t]*(?:#.*)?\r?$")
_END = r"[ \t]*(?:#.*)?\r?$"


def _scalar(key: str, *, prefix: str = "") -> str:
    """The pattern of a key in YAML with its value, which is in one of three groups."""
    quoted = rf"\"(?P<{prefix}two>[^\"\n]*)\"|'(?P<{prefix}one>[^'\n]*)'"
    plain = rf"(?P<{prefix}plain>[^\"'#\s][^#\n]*?)"
    return rf"[ \t]*{key}[ \t]*:[ \t]*(?:{quoted}|{plain}){_END}"


_GIVEN = re.compile(rf"(?m)^{_scalar('- name', prefix='n_')}\n{_scalar('value')}")
_OF_SERVER = ("world", *SWITCHES)


class _Markup:
    """The port of a launch file, as far as it is made."""

    def __init__(self, source: SourceText, context: Context) -> None:
        self.source = source
        self.context = context
        self.unported: list[Unported] = []
        self.packages: set[str] = set()
        self.files: set[str] = set()
        self.declared: set[str] = set()  # the names of launch arguments
        # By lines of spawners: what they say for the placeholders of `BridgeRow`s.
        self.names: dict[int, dict[str, str]] = {}

    def leave(self, line: int, what: str, advice: str) -> None:
        """List what is left to the author."""
        self.unported.append(Unported(self.source.file, line, what, advice))

    def finish(self, edits: Sequence[Edit]) -> FilePort:
        """What becomes of the file."""
        return FilePort(
            edits=tuple(edits),
            unported=tuple(self.unported),
            packages=frozenset(self.packages),
            files=frozenset(self.files),
        )

    def arguments(self, given: Mapping[str, str], part: str, line: int) -> dict[str, str]:
        """The launch arguments of gz_sim.launch.py for those of gazebo_ros."""
        values = {name: f"$(var {name})" for name in _OF_SERVER if name in self.declared}
        values |= {name: text for name, text in given.items() if name in _OF_SERVER}
        for name in given:
            if name not in {*_OF_SERVER, *ENDS, *WITHOUT_LOSS}:
                self.leave(
                    line,
                    f"The launch argument `{name}` of Gazebo Classic is gone.",
                    "Write what it did into `gz_args`, if `gz sim --help` has it.",
                )
        written = {"gz_args": self._gz_args(values, part)}
        if any(given.get(name, "").lower() in TRUE for name in ENDS):
            written["on_exit_shutdown"] = "true"
        return written

    def _gz_args(self, values: Mapping[str, str], part: str) -> str:
        options = part
        for name, (on, off) in SWITCHES.items():
            if (name == "gui" and part) or (part == CLIENT and name != "verbose"):
                continue
            text = values.get(name, "")
            if "$" in text:
                options += f"$(if {text} '{on}' '{off}')"
            else:
                is_on = text.strip().lower() in TRUE if text else ON[name]
                options += on if is_on else off
        if part == CLIENT:
            return options.rstrip()
        return options + self._world(values.get("world", ""))

    def _world(self, text: str) -> str:
        """The world; that of the package in the place of Classic's default."""
        place = f"$(find-pkg-share {OLD_PACKAGE})/"
        if text not in DEFAULT_WORLDS and not text.startswith(place):
            return text
        if text.removeprefix(place) not in DEFAULT_WORLDS:
            self.leave(
                1,
                f"The world `{text}` is one that Gazebo Classic brings; Gazebo Sim does not have "
                "it.",
                "Copy what you need of it into a world file of the package.",
            )
        return self.default_world()

    def default_world(self) -> str:
        """The world that takes the place of Classic's default one."""
        if self.context.default_world is None:
            return EMPTY_WORLD
        self.files.add(self.context.default_world)
        return f"$(find-pkg-share {self.context.package})/{self.context.default_world}"

    def options(self, text: str, line: int) -> str:
        """The options of `create` for those of spawn_entity.py; blanks stay as they are."""
        words = [*_WORD.finditer(text)]
        parts, place, index = list[str](), 0, 0
        while index < len(words):
            word = words[index]
            index += 1
            name = option_of(word[0]) if word[0].startswith("-") else None
            last = word
            if name in SPAWN_ENTITY.with_value and index < len(words):
                last = words[index]
                index += 1
                if name in OF_BRIDGE:
                    self.names.setdefault(line, {})[OF_BRIDGE[name]] = last[0].strip("'\"")
            if name == SPAWN_ENTITY.entity:
                parts += [text[place : word.start()], f"-{CREATE.entity}"]
                place = word.end()
            elif name is not None and name not in CREATE.names:
                parts.append(text[place : word.start()].rstrip())
                place = last.end()
                if name not in DROPPED and name not in OF_BRIDGE:
                    self.leave(
                        line,
                        f"`-{name}` of {OLD_SPAWNER} is gone.",
                        ADVICE.get(name, f"`ros2 run {PACKAGE} {SPAWNER} --help` has the rest."),
                    )
        return "".join((*parts, text[place:])).lstrip()

    def command(self, text: str, line: int) -> str | None:
        """The words of `gz sim` for a command that starts Gazebo Classic; None of any other."""
        words = [word[0] for word in _WORD.finditer(text)]
        part = PARTS.get(words[0]) if words else None
        if part is None:
            return None
        is_paused, rest = False, list[str]()
        has_world = False
        index = 1
        while index < len(words):
            word = words[index]
            index += 1
            if word in {"-u", "--pause"}:
                is_paused = True
            elif word == "--verbose":
                rest += ["-v", "4"]
            elif word in {"-s", "-g", "-p", "--params-file", "--extra-gazebo-args"}:
                value = words[index] if index < len(words) else ""
                index += 1
                if "libgazebo_ros_" not in value:
                    self.leave(
                        line,
                        f"`{word} {value}` of Gazebo Classic is gone.",
                        "Load what Gazebo Sim has instead in the world file.",
                    )
            elif word != "--ros-args":
                has_world |= not word.startswith("-")
                rest.append(word)
        runs = [] if is_paused or part == CLIENT else ["-r"]
        world = [] if has_world or part == CLIENT else [self.default_world()]
        self.packages.add(PACKAGE)
        return " ".join(("gz", "sim", *part.split(), *runs, *rest, *world))

    def bridge(
        self, rows: Sequence[BridgeRow], names: Mapping[str, str], *, with_clock: bool
    ) -> Iterator[_Bridge]:
        """The nodes that convert topics, with the names that the spawner gives."""
        self.packages.add(BRIDGE_PACKAGE)
        space = names.get(NAMESPACE, "")
        is_computed = "$" in space

        def filled(text: str) -> str:
            for name, said in names.items():
                text = text.replace(f"/{name}", f"/{said}" if said else "")
            # Where the namespace is computed, a slash may begin it.
            return text.removeprefix("/") if text.startswith(f"/{space}/") and is_computed else text

        for part in parted(rows):
            words = dict.fromkeys([*([CLOCK] if with_clock else []), *map(option, part)])
            pairs = tuple((filled(one), filled(to)) for one, to in renamed(part).items())
            is_relative = any(not to.startswith("/") for _, to in pairs)
            yield _Bridge(" ".join(map(filled, words)), pairs, is_relative)
            with_clock = False

    def bridges(
        self, servers: Sequence[int], spawners: Sequence[tuple[int, range]]
    ) -> Iterator[tuple[int, _Bridge]]:
        """Behind which elements bridges go: spawners with their lines, else a server."""
        with_clock = bool(servers)
        of_world = self.context.rows.get(OF_WORLD, ())
        for index, lines in spawners:
            rows, names = self.context.rows_at(lines), self.names.get(lines[0], {})
            names = {name: said.strip("/") for name, said in names.items()}
            if rows is None:
                rows = self.context.any_rows
                if rows and not self.context.are_all:
                    self.leave(lines[0], *UNKNOWN_ROBOT)
                if names.get(NAMESPACE):
                    self.leave(lines[0], *LOST_NAMESPACE)
            if rows or with_clock:
                rows = [*(of_world if with_clock else ()), *rows]
                for bridge in self.bridge(rows, names, with_clock=with_clock):
                    yield index, bridge
                with_clock = False
        if with_clock:
            for bridge in self.bridge(of_world, {}, with_clock=True):
                yield servers[0], bridge


class _Bridge(NamedTuple):
    """What a bridge is given."""

    words: str
    remappings: tuple[tuple[str, str], ...]
    is_relative: bool  # names in ROS are those in the namespace of the node


def port_markup(source: SourceText, context: Context) -> FilePort:
    """Port a launch file in XML or YAML."""
    if _OF_CLASSIC.search(source.text) is None and MANAGER not in source.text:
        return FilePort()
    if source.text.lstrip("\ufeff \t\r\n").startswith("<"):
        return _port_xml(source, context)
    return _port_yaml(source, context)


def _port_xml(source: SourceText, context: Context) -> FilePort:
    port, editor = _Markup(source, context), Editor(source)
    nodes = read_nodes(source)
    port.declared = {
        node.get("name") for node in nodes if node.name == "arg" and node.parent in nodes[:1]
    }
    servers: list[Node] = []
    spawners: list[Node] = []
    for node in nodes:
        file = _FILE.fullmatch(node.get("file")) if node.name == "include" else None
        if file is not None:
            editor.set_attribute(node, "file", f"$(find-pkg-share {PACKAGE})/launch/{LAUNCH_FILE}")
            _port_arguments(port, editor, node, FILES[file[1]])
            if FILES[file[1]] != CLIENT:
                servers.append(node)
        elif node.name == "node" and node.get("pkg") == OLD_PACKAGE and node.get("exec"):
            if node.get("exec") != OLD_SPAWNER:
                port.leave(
                    node.line,
                    f"`{node.get('exec')}` of {OLD_PACKAGE} has no counterpart.",
                    "Remove the node, or start what does its work in Gazebo Sim.",
                )
                continue
            editor.set_attribute(node, "pkg", PACKAGE)
            editor.set_attribute(node, "exec", SPAWNER)
            args = node.tag.attributes.get("args")
            if args is not None:
                editor.set_attribute(node, "args", port.options(args.text, node.line))
            port.packages.add(PACKAGE)
            spawners.append(node)
        elif node.name == "executable":
            command = port.command(node.get("cmd"), node.line)
            if command is not None:
                editor.set_attribute(node, "cmd", command)
                servers += [node] if f" {CLIENT}" not in f"{command} " else []
    _port_controllers(port, editor, nodes, is_simulated=bool(servers or spawners))
    _port_default_world(port, editor, nodes)
    indices = {id(node): index for index, node in enumerate(nodes)}
    places = [
        (indices[id(one)], range(one.line, source.line_at(one.end - 1) + 1)) for one in spawners
    ]
    for index, bridge in port.bridges([indices[id(one)] for one in servers], places):
        editor.add_behind(nodes[index], _bridge_element(bridge))
    _port_variables(editor, [one for one in nodes if one not in {*servers, *spawners}])
    return port.finish(editor.finish())


def _port_arguments(port: _Markup, editor: Editor, include: Node, part: str) -> None:
    """Write `gz_args` in the place of the most telling argument; the others go."""
    port.packages.add(PACKAGE)
    written = list(include.children("arg", "let"))
    given = {one.get("name"): one.get("value") for one in written}
    new = port.arguments(given, part, include.line)
    blocks = [
        Block("arg", (), f'name="{name}" value={_in_quotes(text)}') for name, text in new.items()
    ]
    kept = next((one for one in written if one.get("name") == "world"), next(iter(written), None))
    if kept is None:
        editor.append(include, *blocks)
        return
    for one in written:
        if one is kept:
            editor.replace(one, blocks)
        else:
            editor.remove(one)


def _in_quotes(text: str) -> str:
    """The value of an attribute, from the values of others."""
    return (
        f"'{text}'" if '"' in text and "'" not in text else f'"{text.replace(chr(34), "&quot;")}"'
    )


def _port_default_world(port: _Markup, editor: Editor, nodes: Sequence[Node]) -> None:
    """Where the default of the argument `world` means Classic's default world, write another."""
    for node in nodes:
        if node.name == "arg" and node.get("name") == "world" and "default" in node.tag.attributes:
            text = node.get("default").removeprefix(f"$(find-pkg-share {OLD_PACKAGE})/")
            if text in DEFAULT_WORLDS and PACKAGE in port.packages:
                editor.set_attribute(node, "default", port.default_world())


def _port_controllers(
    port: _Markup, editor: Editor, nodes: Sequence[Node], *, is_simulated: bool
) -> None:
    """Start controllers as later distributions do, and give their commands a time."""
    stampers = {one.controller.rpartition("/")[2]: one for one in port.context.stampers}
    for node in nodes:
        program = node.get("exec")
        renamed = PROGRAMS_RENAMED.get((node.get("pkg"), program), program)
        if renamed != program:
            editor.set_attribute(node, "exec", renamed)
        if node.get("pkg") != MANAGER or renamed != "spawner":
            continue
        for name in node.get("args").split():
            one = stampers.pop(name, None)
            if one is not None:
                remaps = {"/cmd_vel_in": one.source, "/cmd_vel_out": one.target}
                content = [Block("remap", (), f'from="{a}" to="{b}"') for a, b in remaps.items()]
                if is_simulated:
                    content.append(Block("param", (), 'name="use_sim_time" value="true"'))
                attributes = f'pkg="{STAMPER}" exec="{STAMPER}" output="screen"'
                editor.add_behind(node, Block("node", content, attributes))
                port.packages.add(STAMPER)


def _bridge_element(bridge: _Bridge) -> Block:
    attributes = f'pkg="{BRIDGE_PACKAGE}" exec="{BRIDGE}" args="{bridge.words}" output="screen"'
    attributes += ' namespace="/"' if bridge.is_relative else ""
    remaps = [Block("remap", (), f'from="{one}" to="{other}"') for one, other in bridge.remappings]
    return Block("node", remaps, attributes)


def _port_variables(editor: Editor, nodes: Sequence[Node]) -> None:
    """Write the names of Gazebo Sim; where two variables become one, the second adds to it."""
    seen: dict[str, str] = {}
    for node in nodes:
        name = node.get("name")
        if node.name == "set_env" and name in VARIABLES:
            first = seen.setdefault(VARIABLES[name], name)
            if first != name and "$(env" not in node.get("value"):
                editor.rename(node, "append_env")
        for one in node.tag.attributes.values():
            text = _renamed(one.text)
            if text != one.text:
                editor.write(*one.value, text)


def _renamed(text: str) -> str:
    return _RENAMED.sub(lambda found: NAMES[found[0]], text)


class _Action(NamedTuple):
    """An action of a launch file in YAML, as it is written."""

    name: str
    indent: str
    start: int
    end: int  # of its last line that is not blank, its line end included


def _actions(text: str) -> Iterator[_Action]:
    for found in _ACTION.finditer(text):
        own, end = len(found[1]), found.end()
        for line in re.compile(r"\n([ \t]*)([^\n]*)").finditer(text, found.end()):
            word = line[2].strip()
            if word and not word.startswith("#") and len(line[1]) <= own:
                break
            if word and not (word.startswith("#") and len(line[1]) <= own):
                end = line.end()
        yield _Action(found[2], found[1], found.start(), min(end + 1, len(text)))


class _Written(NamedTuple):
    """A value in YAML."""

    start: int  # without its quotes
    end: int
    text: str


def _value(text: str, action: _Action, key: str) -> _Written | None:
    """What an action has under a key."""
    pattern = re.compile(rf"(?m)^{_scalar(f'(?:- )?{key}')}")
    found = pattern.search(text, action.start, action.end)
    return _written(found) if found else None


def _written(found: re.Match[str], prefix: str = "") -> _Written:
    group = next(f"{prefix}{one}" for one in ("two", "one", "plain") if found[f"{prefix}{one}"])
    return _Written(*found.span(group), found[group])


def _port_yaml(source: SourceText, context: Context) -> FilePort:
    port, text = _Markup(source, context), source.text
    actions = [*_actions(text)]
    edits: list[Edit] = []
    servers, spawners = list[int](), list[tuple[int, range]]()
    values = [
        {key: _value(text, one, key) for key in ("file", "pkg", "exec", "args", "cmd", "name")}
        for one in actions
    ]
    port.declared = {
        name.text
        for one, keys in zip(actions, values, strict=True)
        if one.name == "arg" and (name := keys["name"]) is not None
    }

    def write(place: _Written | None, new: str) -> None:
        if place is not None and new != place.text:
            edits.append(Edit(start=place.start, end=place.end, text=new))

    for index, (action, keys) in enumerate(zip(actions, values, strict=True)):
        line = source.line_at(action.start)
        file, package, program = keys["file"], keys["pkg"], keys["exec"]
        found = _FILE.fullmatch(file.text) if file and action.name == "include" else None
        if file is not None and found is not None:
            write(file, f"$(find-pkg-share {PACKAGE})/launch/{LAUNCH_FILE}")
            edits += _given_in_yaml(port, action, file, FILES[found[1]])
            servers += [index] if FILES[found[1]] != CLIENT else []
        elif action.name == "node" and package is not None and package.text == OLD_PACKAGE:
            if program is None or program.text != OLD_SPAWNER:
                port.leave(
                    line,
                    f"`{program.text if program else ''}` of {OLD_PACKAGE} has no counterpart.",
                    "Remove the node, or start what does its work in Gazebo Sim.",
                )
                continue
            write(package, PACKAGE)
            write(program, SPAWNER)
            args = keys["args"]
            if args is not None:
                write(args, port.options(args.text, line))
            port.packages.add(PACKAGE)
            spawners.append((index, range(line, source.line_at(action.end - 1) + 1)))
        elif action.name == "executable" and (command := keys["cmd"]) is not None:
            new = port.command(command.text, line)
            if new is not None:
                write(command, new)
                servers += [index] if f" {CLIENT}" not in f"{new} " else []
    added = [
        Edit(
            start=actions[index].end,
            end=actions[index].end,
            text=_item(source, actions[index], one),
        )
        for index, one in port.bridges(servers, spawners)
    ]
    comments = [one.span() for one in re.finditer(r"(?m)(?<!\S)#.*$", text)]
    edits += [
        Edit(start=one.start(), end=one.end(), text=NAMES[one[0]])
        for one in _RENAMED.finditer(text)
        if not any(start <= one.start() < end for start, end in comments)
        and not any(edit.start <= one.start() < edit.end for edit in edits)
    ]
    return port.finish([*edits, *join_additions(added)])


def _given_in_yaml(port: _Markup, include: _Action, file: _Written, part: str) -> Iterator[Edit]:
    """Write `gz_args` in the place of the most telling argument; the others go."""
    source = port.source
    port.packages.add(PACKAGE)
    entries = {
        _written(found, "n_").text: (found, _written(found))
        for found in _GIVEN.finditer(source.text, include.start, include.end)
    }
    line = source.line_at(include.start)
    new = port.arguments({name: value.text for name, (_, value) in entries.items()}, part, line)
    newline = source.newline
    if not entries:
        indent = source.indent_at(file.start)
        lines = [f"{indent}arg:"]
        for name, text in new.items():
            lines += [f"{indent}  - name: {name}", f"{indent}    value: {_as_yaml(text)}"]
        place = source.start_of(source.line_at(file.start) + 1)
        before = "" if source.text[:place].endswith("\n") else newline
        yield Edit(start=place, end=place, text=before + "".join(one + newline for one in lines))
        return
    kept = "world" if "world" in entries else next(iter(entries))
    for name, (found, _) in entries.items():
        start, end = source.whole_lines(found.start(), found.end())
        text = ""
        if name == kept:
            indent = source.indent_at(found.start())
            text = "".join(
                f"{indent}- name: {one}{newline}{indent}  value: {_as_yaml(value)}{newline}"
                for one, value in new.items()
            )
        yield Edit(start=start, end=end, text=text)


def _as_yaml(text: str) -> str:
    return f'"{text}"' if '"' not in text else "'{}'".format(text.replace("'", "''"))


def _item(source: SourceText, beside: _Action, bridge: _Bridge) -> str:
    indent, newline = beside.indent, source.newline
    inner = f"{indent}    "
    lines = [
        f"{indent}- node:",
        f"{inner}pkg: {BRIDGE_PACKAGE}",
        f"{inner}exec: {BRIDGE}",
        *([f'{inner}namespace: "/"'] if bridge.is_relative else []),
        f'{inner}args: "{bridge.words}"',
        *([f"{inner}remap:"] if bridge.remappings else []),
    ]
    for one, other in bridge.remappings:
        lines += [f'{inner}  - from: "{one}"', f'{inner}    to: "{other}"']
    lines.append(f"{inner}output: screen")
    before = "" if source.text[: beside.end].endswith("\n") else newline
    return before + "".join(line + newline for line in lines)
