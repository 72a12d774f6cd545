"""Where a launch file in Python starts the bridge of topics, and the text of that node."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.facts import PROGRAMS
from wsgen.model.target import SIM
from wsgen.porting.porter import MODEL, NAMESPACE
from wsgen.text.pythontree import name_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.porting.parameters import Stamper
    from wsgen.porting.ported import BridgeRow
    from wsgen.porting.python_edits import PythonEdits

BRIDGE_PACKAGE, BRIDGE = (PROGRAMS[SIM][key][1] for key in ("bridge_package", "bridge"))
STAMPER = "twist_stamper"  # a package, and its program
CLOCK = "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"
_ORDERED = ("zip", "enumerate", "len")
_STARTS = ("on_start", "on_exit", "actions", "on_completion")
_HANDLERS = ("RegisterEventHandler", "TimerAction")


def option(row: BridgeRow) -> str:
    """The argument of the bridge for a topic or a service."""
    gz_type = f"gz.msgs.{row.gz_type}" if row.gz_type else ""
    return f"{row.gz_topic}@{row.ros_type}{row.direction}{gz_type}"


def parted(rows: Sequence[BridgeRow]) -> list[list[BridgeRow]]:
    """What each of several bridges converts: one gives a topic of Gazebo one name in ROS.

    At least one, which may have nothing to convert.
    """
    parts: list[list[BridgeRow]] = [[]]
    names: list[dict[str, str]] = [{}]  # in ROS, of the topics of Gazebo in each part
    for row in rows:
        for part, known in zip(parts, names, strict=True):
            if known.setdefault(row.gz_topic, row.ros_topic) == row.ros_topic:
                part.append(row)
                break
        else:
            parts.append([row])
            names.append({row.gz_topic: row.ros_topic})
    return parts


def renamed(rows: Sequence[BridgeRow]) -> dict[str, str]:
    """The remappings of a bridge."""
    return {row.gz_topic: row.ros_topic for row in rows if row.gz_topic != row.ros_topic}


# For the placeholders of `BridgeRow`s: what the spawner says, as Python.
Names = Mapping[str, ast.expr]
_PLACEHOLDER = re.compile(f"({re.escape(MODEL)}|{re.escape(NAMESPACE)})")


class _Place(NamedTuple):
    """Where an action is added."""

    place: int
    indent: str
    form: str  # with `{}` for the action


class BridgeWriter:
    """Adds the bridge to a launch file."""

    def __init__(self, file: PythonEdits, names: Names = MappingProxyType({})) -> None:
        self.file = file
        self._names = {}  # those that are computed
        self._said = {}  # those that are written out
        for name, node in names.items():
            said = file.said(node)
            if said is None:
                self._names[name] = node
            else:
                self._said[name] = said.strip("/")

    def _python(self, text: str) -> str:
        """A text as Python, with the names that the spawner gives.

        Where the namespace is computed, the topic is one in that of the node: a slash may begin it.
        """
        for name, said in self._said.items():
            text = text.replace(f"/{name}", f"/{said}" if said else "")
        if NAMESPACE in self._names:
            text = text.removeprefix("/") if text.startswith(f"/{NAMESPACE}") else text
        pieces: list[str] = []
        for piece in filter(None, _PLACEHOLDER.split(text)):
            node = self._names.get(piece)
            if node is None:
                pieces.append(self.file.quoted(piece))
            else:  # a list of substitutions cannot be in another one
                star = "*" if self.file.is_list(node) else ""
                pieces.append(f"{star}{self.file.written(node)}")
        is_text = len(pieces) == 1 and text not in self._names
        return pieces[0] if is_text else f"[{', '.join(pieces)}]"

    def start(
        self, beside: Sequence[ast.Call], rows: Sequence[BridgeRow], *, with_clock: bool
    ) -> bool:
        """Start a bridge where the first of some actions is started that is; whether one is."""
        first, *others = parted(rows)
        arguments = [*dict.fromkeys([*([CLOCK] if with_clock else []), *map(option, first)])]
        program = (BRIDGE_PACKAGE, BRIDGE)
        if self.add_beside(beside, program, arguments, renamed(first)):
            for part in others:
                self.add_beside(beside, program, [*map(option, part)], renamed(part))
            return True
        self.file.leave(
            beside[0],
            "It is not certain where the bridge of the topics belongs.",
            f"Add a Node of {BRIDGE_PACKAGE} with these arguments: {' '.join(arguments)}",
        )
        return False

    def stamp(self, beside: ast.Call, stamper: Stamper, sim_time: str | None) -> bool:
        """Start what gives commands of a controller their time beside what starts that.

        `sim_time` is the Python of the parameter `use_sim_time`.
        """
        topics = {"/cmd_vel_in": stamper.source, "/cmd_vel_out": stamper.target}
        return self.add_beside([beside], (STAMPER, STAMPER), (), topics, sim_time)

    def add_beside(
        self,
        beside: Sequence[ast.Call],
        program: tuple[str, str],
        arguments: Sequence[str],
        renamed: Mapping[str, str] = MappingProxyType({}),
        sim_time: str | None = None,
    ) -> bool:
        """Start a program with these arguments beside actions; whether it could be done."""
        places = next((found for one in beside if (found := [*self._places(one)])), [])
        for place, indent, form in places:
            inner, quoted = f"{indent}    ", self.file.quoted
            pairs = [f"({self._python(one)}, {self._python(to)})" for one, to in renamed.items()]
            is_relative = NAMESPACE in self._names and NAMESPACE in "".join(renamed.values())
            parameters = [f"{{{quoted('use_sim_time')}: {sim_time}}}"] if sim_time else []
            lines = [
                "Node(",
                f"{inner}package={quoted(program[0])},",
                f"{inner}executable={quoted(program[1])},",
                *([f"{inner}namespace={quoted('/')},"] if is_relative else []),
                *_listed("arguments", map(self._python, arguments), inner),
                *_listed("parameters", parameters, inner),
                *_listed("remappings", pairs, inner),
                f"{inner}output={quoted('screen')},",
                f"{indent})",
            ]
            self.file.insert(place, form.format(self.file.source.newline.join(lines)))
        if places:
            self.file.imports.append("from launch_ros.actions import Node")
        return bool(places)

    def _places(self, call: ast.Call) -> Iterator[_Place]:
        """Where an action goes that is started with another one.

        Several where branches of the launch file start it: one in each.
        """
        branches: list[list[ast.AST]] = []
        for node in self._uses(call):
            place = self._beside(node)
            if place is None:
                continue
            around = [*self._branches(node)]
            if all(self._exclude(around, before) for before in branches):
                branches.append(around)
                yield place

    def _exclude(self, some: Sequence[ast.AST], others: Sequence[ast.AST]) -> bool:
        """Whether two places are in different branches of one `if`."""
        parents = self.file.parents
        return any(
            one is not other and parents[one] is parents[other] for one in some for other in others
        )

    def _branches(self, node: ast.AST) -> Iterator[ast.AST]:
        """The branches of `if` that a node is in: the first statement of each."""
        parent = self.file.parents.get(node)
        while parent is not None:
            if isinstance(parent, ast.If) and isinstance(node, ast.stmt):
                yield (parent.body if node in parent.body else parent.orelse)[0]
            node, parent = parent, self.file.parents.get(parent)

    def _beside(self, node: ast.expr) -> _Place | None:
        file, tree = self.file, self.file.tree
        newline = file.source.newline
        parent = file.parents.get(node)
        if isinstance(parent, ast.List):
            indent = file.source.indent_at(tree.start(node))
            if file.source.text[: tree.start(node)].rpartition("\n")[2].strip():
                indent += "    "  # others are on its line
            return _Place(tree.end(node), indent, f",{newline}{indent}{{}}")
        if isinstance(parent, ast.Call) and isinstance(parent.func, ast.Attribute):
            statement, method = file.parents.get(parent), parent.func.attr
            receiver = file.written(parent.func.value)
            if method == "append" and not self._is_list_of_actions(parent.func.value):
                receiver, method = self._description_before(parent), "add_action"
            if isinstance(statement, ast.Expr) and method in {"add_action", "append"} and receiver:
                indent = file.source.indent_at(tree.start(statement))
                form = f"{newline}{indent}{receiver}.{method}({{}})"
                return _Place(tree.end(statement), indent, form)
        if (isinstance(parent, ast.ListComp) and parent.elt is node) or (
            isinstance(parent, ast.Return) and not self._is_waited_for()
        ):
            file.insert(tree.start(node), "GroupAction([")
            file.imports.append("from launch.actions import GroupAction")
            indent = file.source.indent_at(tree.start(node)) + "    "
            return _Place(tree.end(node), indent, f",{newline}{indent}{{}}])")
        return None

    def _description_before(self, node: ast.Call) -> str:
        """The name of the launch description that is filled where a node is; empty: there is none.

        What is put into a list whose places count is started one by one later.
        """
        return next(
            (
                one.id
                for assignment in self.file.tree.all(ast.Assign)
                if isinstance(assignment.value, ast.Call)
                and name_of(assignment.value) == "LaunchDescription"
                and assignment.lineno < node.lineno
                and self._function(assignment) is self._function(node)
                for one in assignment.targets
                if isinstance(one, ast.Name)
            ),
            "",
        )

    def _function(self, node: ast.AST) -> ast.AST | None:
        around = self.file.parents.get(node)
        while around is not None and not isinstance(around, ast.FunctionDef):
            around = self.file.parents.get(around)
        return around

    def _is_waited_for(self) -> bool:
        """Whether a handler may wait for an action, which a group cannot be."""
        return any(one.arg == "target_action" for one in self.file.tree.all(ast.keyword))

    def _is_list_of_actions(self, node: ast.expr) -> bool:
        """Whether a list has nothing to do but to be started: no place in it counts."""
        if not isinstance(node, ast.Name):
            return False
        uses = [one for one in self.file.tree.all(ast.Name) if one.id == node.id]
        parents = [self.file.parents.get(one) for one in uses]
        return not any(
            isinstance(one, ast.Subscript)
            or (isinstance(one, ast.Call) and name_of(one) in _ORDERED)
            for one in parents
        )

    def _uses(self, call: ast.expr, depth: int = 4) -> Iterator[ast.expr]:
        """The call, what starts it, and the names that stand for one of them.

        What is started at once comes before what a handler starts.
        """
        yield call
        parent = self.file.parents.get(call)
        if isinstance(parent, ast.keyword) and parent.arg in _STARTS:
            handler = self.file.parents[parent]
            while not isinstance(handler, ast.stmt):
                if isinstance(handler, ast.Call) and name_of(handler) in _HANDLERS:
                    yield from self._uses(handler, depth - 1)
                    return
                handler = self.file.parents[handler]
        if not isinstance(parent, ast.Assign) or not depth:
            return
        names = {target.id for target in parent.targets if isinstance(target, ast.Name)}
        found = [
            node
            for node in self.file.tree.all(ast.Name)
            if node.id in names and isinstance(node.ctx, ast.Load)
        ]
        for node in sorted(found, key=lambda node: (self._is_in_handler(node), node.lineno)):
            yield from self._uses(node, depth - 1)

    def _is_in_handler(self, node: ast.AST) -> bool:
        around = self.file.parents.get(node)
        while around is not None:
            if isinstance(around, ast.Call) and name_of(around) in _HANDLERS:
                return True
            around = self.file.parents.get(around)
        return False


def _listed(name: str, values: Iterable[str], indent: str) -> list[str]:
    """An argument of a call that is a list, on lines of its own; nothing of an empty one."""
    lines = [f"{indent}    {one}," for one in values]
    return [f"{indent}{name}=[", *lines, f"{indent}],"] if lines else []
