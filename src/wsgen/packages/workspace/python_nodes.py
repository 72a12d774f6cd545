"""The nodes that Python files of a package define: classes, messages, topics. Files are not run."""

from __future__ import annotations

import ast
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from wsgen.packages.imported_packages import name_of
from wsgen.text.files import read_regular
from wsgen.text.pythontree import parse

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

MOST_BYTES = 500_000  # of a file; what is larger is generated
KINDS = ("msg", "srv", "action")
NODES = frozenset(("Node", "LifecycleNode"))  # of rclpy
# Positional parameters of methods of Node, those with defaults left out.
PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "create_publisher": ("msg_type", "topic", "qos_profile"),
    "create_subscription": ("msg_type", "topic", "callback", "qos_profile"),
    "create_service": ("srv_type", "srv_name", "callback"),
    "create_client": ("srv_type", "srv_name"),
    "create_timer": ("timer_period_sec", "callback"),
}
_SENDS = {"create_publisher": True, "create_subscription": False}


class NodeTopic(NamedTuple):
    """A topic that a node publishes or reads."""

    name: str | None  # as it is written; None: it is computed
    type: str  # "geometry_msgs/Twist"
    is_published: bool
    line: int  # 1-based


class NodeClass(NamedTuple):
    """A class that is surely a node, and whose members are all known."""

    definition: ast.ClassDef
    is_lifecycle: bool
    members: frozenset[str]  # without those of rclpy
    methods: Mapping[str, ast.FunctionDef]


class NodeFile:
    """A Python file that imports rclpy."""

    def __init__(self, file: Path, tree: ast.Module) -> None:
        self.file = file
        self.tree = tree
        self.nodes = list(ast.walk(tree))

    @cached_property
    def imported(self) -> frozenset[str]:
        """All words of the names of modules that are imported, and of what is imported of them."""
        return frozenset(
            word
            for node in self.nodes
            if isinstance(node, (ast.Import, ast.ImportFrom))
            for name in (getattr(node, "module", None) or "", *(one.name for one in node.names))
            for word in name.split(".")
        )

    @cached_property
    def interfaces(self) -> dict[str, str]:
        """Types of the names that are imported: `Twist` -> "geometry_msgs/msg/Twist"."""
        return {
            one.asname or one.name: f"{package}/{kind}/{one.name}"
            for node in self.nodes
            if isinstance(node, ast.ImportFrom) and node.module and not node.level
            for package, _, kind in (node.module.partition("."),)
            if kind in KINDS
            for one in node.names
        }

    def interface(self, node: ast.expr | None) -> str | None:
        """The type that an expression names: "std_srvs/srv/Trigger" of `Trigger`."""
        if isinstance(node, ast.Name):
            return self.interfaces.get(node.id)
        if isinstance(node, ast.Attribute):
            package, _, kind = ast.unparse(node.value).partition(".")
            if kind in KINDS:
                return f"{package}/{kind}/{node.attr}"
            outer = self.interface(node.value)
            return outer and f"{outer}.{node.attr}"
        return None

    @cached_property
    def classes(self) -> tuple[ast.ClassDef, ...]:
        """All classes."""
        return tuple(node for node in self.nodes if isinstance(node, ast.ClassDef))

    @cached_property
    def node_classes(self) -> tuple[NodeClass, ...]:
        """The classes that are nodes."""
        by_name = {one.name: one for one in self.classes}
        from_rclpy = {
            one.asname or one.name: one.name
            for node in self.nodes
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rclpy.")
            for one in node.names
            if one.name in NODES
        }
        called = {name_of(node.func) for node in self.nodes if isinstance(node, ast.Call)}
        lines = {one.name: _line(one, by_name, []) for one in self.classes}
        found = []
        for one in self.classes:
            line, bases = lines[one.name]
            roots = {
                from_rclpy.get(text) or (text.startswith("rclpy.") and text.rpartition(".")[2])
                for text in bases
            }
            if one.name not in called or any(map(_is_open, line)) or len(roots) != 1:
                continue
            root = roots.pop()
            if root in NODES:
                # A method may use what the classes below it have.
                below = [other[0] for other in lines.values() if one in other[0]]
                members, _ = _members([each for those in below for each in those])
                _, methods = _members(line)
                members |= self._set_outside
                found.append(NodeClass(one, root == "LifecycleNode", members, methods))
        return tuple(found)

    @cached_property
    def _set_outside(self) -> frozenset[str]:
        """The attributes that are set of anything but self, such as `node.speed = 1`."""
        return frozenset(
            node.attr
            for node in self.nodes
            if isinstance(node, ast.Attribute)
            and not isinstance(node.ctx, ast.Load)
            and name_of(node.value) != "self"
        )

    @cached_property
    def topics(self) -> tuple[NodeTopic, ...]:
        """The topics whose types are written in calls."""
        return tuple(self._topics())

    def _topics(self) -> Iterator[NodeTopic]:
        for node in self.nodes:
            if not isinstance(node, ast.Call) or name_of(node.func) not in _SENDS:
                continue
            given = arguments_of(node)
            topic = given.get("topic")
            type_ = self.interface(given.get("msg_type"))
            if type_ is None or topic is None:
                continue
            is_text = isinstance(topic, ast.Constant) and isinstance(topic.value, str)
            name = topic.value if is_text else None  # type: ignore[attr-defined]
            sends = _SENDS[name_of(node.func)]
            yield NodeTopic(name, type_.replace("/msg/", "/"), sends, topic.lineno)


def arguments_of(call: ast.Call) -> dict[str, ast.expr]:
    """What a call of a method of Node gives to its parameters."""
    given = dict(zip(PARAMETERS.get(name_of(call.func), ()), call.args, strict=False))
    return given | {one.arg: one.value for one in call.keywords if one.arg}


def _line(
    one: ast.ClassDef, by_name: Mapping[str, ast.ClassDef], seen: list[ast.ClassDef]
) -> tuple[list[ast.ClassDef], list[str]]:
    """A class with its bases in the file, and the names of bases that are elsewhere."""
    seen.append(one)
    roots: list[str] = []
    for base in one.bases:
        below = by_name.get(base.id) if isinstance(base, ast.Name) else None
        if below is None:
            roots.append(ast.unparse(base))
        elif below not in seen:
            roots += _line(below, by_name, seen)[1]
    if one.keywords or one.decorator_list:
        roots.append("")
    return seen, roots


def _members(
    line: list[ast.ClassDef],
) -> tuple[frozenset[str], dict[str, ast.FunctionDef]]:
    """The names of members, and the methods; those of bases come last in `line`."""
    members: set[str] = set()
    methods: dict[str, ast.FunctionDef] = {}
    for one in reversed(line):
        members.update(
            node.attr
            for node in ast.walk(one)
            if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load)
        )
        for node in _outside_of_functions(one.body):
            if isinstance(node, _DEFINITIONS):
                members.add(node.name)
            elif isinstance(node, (ast.Import, ast.ImportFrom)):
                members.update(each.asname or each.name for each in node.names)
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                members.add(node.id)
            if isinstance(node, ast.FunctionDef):
                methods[node.name] = node
    return frozenset(members), methods


_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


def _outside_of_functions(body: list[ast.stmt]) -> Iterator[ast.AST]:
    """What is in a body, but not what is in its functions and classes."""
    left: list[ast.AST] = [*body]
    while left:
        node = left.pop()
        yield node
        if not isinstance(node, (*_DEFINITIONS, ast.Lambda)):
            left += ast.iter_child_nodes(node)


def _is_open(one: ast.ClassDef) -> bool:
    """Whether a class may have members that are written nowhere."""
    return any(
        (isinstance(node, ast.FunctionDef) and node.name in _OPENING)
        or (isinstance(node, ast.Attribute) and node.attr == "__dict__")
        or (isinstance(node, ast.Call) and name_of(node.func) in _OPENING)
        for node in ast.walk(one)
    )


_OPENING = frozenset(("__getattr__", "__getattribute__", "setattr", "__setattr__", "vars", "exec"))


def read_node_file(file: Path) -> NodeFile | None:
    """Read a Python file; None where it is no Python, or has nothing to do with rclpy."""
    try:
        data = read_regular(file, MOST_BYTES + 1)
        if len(data) > MOST_BYTES or not (b"rclpy" in data or b"_msg" in data):
            return None
        return NodeFile(file, parse(data))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None
