"""Programs in Python that spawn, move and delete entities by services of Gazebo Classic.

Their messages become those of ros_gz_interfaces; a bridge gives the services of the world the names
that they had. Source: the services of gazebo_msgs and ros_gz_interfaces; gazebosim/ros_gz 1.0.11.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.launch_files import tree_of
from wsgen.checks.fixes.source import Edit
from wsgen.porting.ported import BridgeRow, FilePort
from wsgen.porting.porter import WORLD
from wsgen.porting.python_edits import PythonEdits, argument
from wsgen.porting.topics import absolute
from wsgen.text.pythontree import name_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.checks.fixes.launch_files import Tree
    from wsgen.checks.fixes.source import SourceText

MESSAGES, INTERFACES = "gazebo_msgs", "ros_gz_interfaces"
_REQUEST = "Request"


class _Service(NamedTuple):
    """A service of a world of Gazebo Sim that takes the place of one of Gazebo Classic."""

    name: str
    type: str  # of ros_gz_interfaces
    fields: dict[str, str]  # of the request: what they are now


_SERVICES = {
    "SpawnEntity": _Service(
        "create",
        "SpawnEntity",
        {
            "name": "entity_factory.name",
            "xml": "entity_factory.sdf",
            "initial_pose": "entity_factory.pose",
        },
    ),
    "DeleteEntity": _Service("remove", "DeleteEntity", {"name": "entity.name"}),
    "SetEntityState": _Service("set_pose", "SetEntityPose", {}),
}
# The message in the requests of the last one, of which Gazebo Sim has the fields in the request.
_STATE, _MOVES = "EntityState", "SetEntityState"
_FIELDS = {
    **{kind: service.fields for kind, service in _SERVICES.items()},
    _STATE: {"name": "entity.name", "pose": "pose"},
}
_NAMED_BY_TYPE = ("DeleteEntity", _STATE)
# Fields of requests that are gone: values that were without an effect, and what to do about others.
_GONE = {
    "robot_namespace": ("", "Give the plugins of the robot their topics."),
    "reference_frame": ("world map", "Give the pose in the world."),
    "twist": ("", "Command the velocity by a topic of a system, as VelocityControl has."),
}
_COPIES = ("copy", "deepcopy")
_STATUS = "status_message"  # of responses
_OF_STATUS = re.compile(rf"([\w.]+(?:\(\)(?:\.\w+)*)?)\.{_STATUS}\b")

_Known = dict[tuple[ast.AST | None, str], str]  # by function and name: the service of a request


class _UnsureError(Exception):
    """The program does something that is not understood."""


def port_program(source: SourceText) -> FilePort | None:
    """Port a program; None where it uses nothing of Gazebo Classic, or more than is known."""
    tree = tree_of(source) if MESSAGES in source.text else None
    try:
        return None if tree is None else _Program(tree).port()
    except _UnsureError:
        return None


class _Program(PythonEdits):
    """What is to be changed in a program."""

    def __init__(self, tree: Tree) -> None:
        super().__init__(tree)
        self._requests: _Known = {}
        self._old_import: ast.ImportFrom | None = None  # of the message
        self._given: dict[str, str] = {}  # by the names of functions that return requests

    def port(self) -> FilePort:
        """The edits, and the services to bridge.

        Raises:
            _UnsureError: There is something that is not understood.
        """
        self._imported()
        rows = frozenset(self._services())
        known = -1
        while known < len(self._requests) + len(self._given):
            known = len(self._requests) + len(self._given)
            self._find_requests()
        for node in self.tree.all(ast.Attribute):
            if not self._is_in_text(node):
                self._write(node)
        for text in self.tree.all(ast.JoinedStr):
            self._write_in_text(text)
        for name in self.tree.all(ast.Name):
            if name.id == _MOVES:
                self.replace(name, _SERVICES[_MOVES].type)
        for call in filter(self._is_new_state, self.tree.all(ast.Call)):
            self.replace(call, f"{_SERVICES[_MOVES].type}.{_REQUEST}()")
        if self._old_import is not None:
            start, end = self.tree.start(self._old_import), self.tree.end(self._old_import)
            if self.imports:
                self.replace(self._old_import, self.imports.pop())
                self.imports.clear()
            else:
                self.replace_text(*self.source.whole_lines(start, end), "")
        return FilePort(
            edits=self.all_edits(),
            unported=tuple(self.unported),
            packages=frozenset([INTERFACES]),
            services=rows,
        )

    def _imported(self) -> None:
        for whole in self.tree.all(ast.Import):
            if any(one.name.startswith(MESSAGES) for one in whole.names):
                raise _UnsureError
        for node in self.tree.all(ast.ImportFrom):
            module = node.module or ""
            if module.partition(".")[0] == MESSAGES:
                names = [one.name for one in node.names if one.asname is None]
                if module == f"{MESSAGES}.msg" and names == [_STATE]:
                    self._old_import = node
                    continue
                if module != f"{MESSAGES}.srv" or not set(names) <= set(_SERVICES):
                    raise _UnsureError
                if len(names) != len(node.names):
                    raise _UnsureError
                written = self.written(node).replace(MESSAGES, INTERFACES, 1)
                self.replace(node, re.sub(rf"\b{_MOVES}\b", _SERVICES[_MOVES].type, written))

    def _services(self) -> Iterator[BridgeRow]:
        is_any = False
        for call in self.calls("create_client"):
            given = argument(call, 0, "srv_type")
            kind = given.id if isinstance(given, ast.Name) else ""
            name = self.said(argument(call, 1, "srv_name"))
            if kind not in _SERVICES:
                continue
            if name is None:
                raise _UnsureError
            is_any = True
            place = f"/world/{WORLD}/{_SERVICES[kind].name}"
            of_gz = f"{INTERFACES}/srv/{_SERVICES[kind].type}"
            yield BridgeRow(place, "", of_gz, "", absolute(name))
        if not is_any:
            raise _UnsureError

    # What is a request

    def _key(self, node: ast.expr | ast.arg) -> tuple[ast.AST | None, str]:
        """The name of a variable, with the function that it is known in."""
        name = node.arg if isinstance(node, ast.arg) else ast.unparse(node)
        return (None if "." in name else self._function(node)), name

    def _function(self, node: ast.AST) -> ast.FunctionDef | None:
        around = self.parents.get(node)
        while around is not None and not isinstance(around, ast.FunctionDef):
            around = self.parents.get(around)
        return around

    def _find_requests(self) -> None:
        for assigned in self.tree.all(ast.Assign):
            if kind := self._kind(assigned.value):
                self._requests.update((self._key(one), kind) for one in assigned.targets)
        for function in self.tree.all(ast.FunctionDef):
            for one in (*function.args.args, *function.args.kwonlyargs):
                if kind := self._named(one.annotation):
                    self._requests[self._key(one)] = kind
        for returned in self.tree.all(ast.Return):
            around = self._function(returned)
            if around is not None and returned.value and (kind := self._kind(returned.value)):
                self._given[around.name] = kind

    def _named(self, node: ast.expr | None) -> str:
        """The service whose class of requests this is."""
        is_class = isinstance(node, ast.Attribute) and node.attr == _REQUEST
        name = ast.unparse(node.value) if is_class and isinstance(node, ast.Attribute) else ""
        return name if name in _SERVICES else ""

    def _kind(self, value: ast.expr) -> str:
        """The service that a value is a request of; an empty text of others."""
        if isinstance(value, ast.Attribute) and value.attr == "state":
            return _STATE if self._kind(value.value) == _MOVES else ""
        if not isinstance(value, ast.Call):
            return self._requests.get(self._key(value), "")
        if self._is_new_state(value):
            return _STATE
        if kind := self._named(value.func):
            if value.args or value.keywords:
                raise _UnsureError
            return kind
        if name_of(value) in _COPIES and value.args:
            return self._kind(value.args[0])
        return self._given.get(name_of(value), "")

    @staticmethod
    def _is_new_state(value: ast.expr) -> bool:
        if not isinstance(value, ast.Call) or name_of(value) != _STATE:
            return False
        if value.args or value.keywords:
            raise _UnsureError
        return True

    # What is changed

    def _is_in_text(self, node: ast.AST) -> bool:
        around = self.parents.get(node)
        while around is not None and not isinstance(around, ast.stmt):
            if isinstance(around, ast.JoinedStr):
                return True
            around = self.parents.get(around)
        return False

    def _write(self, node: ast.Attribute) -> None:
        end = self.tree.end(node)
        if node.attr == _STATUS:
            self.insert(self.tree.start(node), "str(")
            self.replace_text(end - len(f".{_STATUS}"), end, ")")
            return
        kind = self._kind(node.value)
        if kind == _MOVES:
            self._write_state(node)
        elif kind and node.attr in _FIELDS[kind]:
            self.replace_text(end - len(node.attr), end, _FIELDS[kind][node.attr])
            if kind in _NAMED_BY_TYPE and node.attr == "name":
                self._say_what(node)
        elif kind:
            self._drop(node)

    def _write_state(self, node: ast.Attribute) -> None:
        """Have the request be what the message in it was."""
        statement = self.parents.get(node)
        if node.attr != "state":
            raise _UnsureError
        if not isinstance(statement, ast.Assign) or statement.targets != [node]:
            end = self.tree.end(node)
            self.replace_text(end - len(".state"), end, "")
        elif self._is_new_state(statement.value):
            self._take_out(statement)
        elif isinstance(statement.value, ast.Name) and self._kind(statement.value) == _STATE:
            self.replace(statement, f"{self.written(node.value)} = {statement.value.id}")
        else:
            raise _UnsureError

    def _say_what(self, node: ast.Attribute) -> None:
        """Say of an entity that it is a model: names are unique among those alone."""
        statement = self.parents.get(node)
        if isinstance(statement, ast.Assign) and statement.targets == [node]:
            indent = self.source.indent_at(self.tree.start(statement))
            request = self.written(node.value).removesuffix(".state")
            line = f"{self.source.newline}{indent}{request}.entity.type = Entity.MODEL"
            behind = self.source.text[self.tree.end(statement) :].partition("\n")[0].rstrip("\r")
            self.insert(self.tree.end(statement) + len(behind), line)
            self.imports.append(f"from {INTERFACES}.msg import Entity")

    def _drop(self, node: ast.Attribute) -> None:
        """Take out the statement that sets a field which is gone."""
        part: ast.AST = node
        statement = self.parents.get(node)
        while isinstance(statement, ast.Attribute):
            part, statement = statement, self.parents.get(statement)
        if node.attr not in _GONE or not isinstance(statement, ast.Assign):
            raise _UnsureError
        if statement.targets != [part]:
            raise _UnsureError
        usual, advice = _GONE[node.attr]
        value = self.value(statement.value)
        is_zero = isinstance(value, ast.Constant) and value.value in ("", 0, *usual.split())
        if not is_zero and not (isinstance(value, ast.Call) and not value.args + value.keywords):
            what = f"The service of Gazebo Sim has no `{node.attr}`."
            self.leave(statement, what, advice)
        self._take_out(statement)

    def _take_out(self, statement: ast.Assign) -> None:
        if len(getattr(self.parents.get(statement), "body", ())) == 1:
            raise _UnsureError
        start, end = self.tree.start(statement), self.tree.end(statement)
        whole = self.source.whole_lines(start, end)
        if whole == (start, end):  # a comment is behind it
            rest = self.source.text[end:]
            whole = start, end + len(rest) - len(rest.lstrip(" \t"))
        self.done.update(ast.walk(statement))
        self.replace_text(*whole, "")

    def _write_in_text(self, text: ast.JoinedStr) -> None:
        """Change what a text computes; Python before 3.12 does not say where that stands."""
        before = self.written(text)
        after = _OF_STATUS.sub(r"str(\1)", before)
        for (function, name), kind in self._requests.items():
            if function not in (None, self._function(text)):
                continue
            inner = r"\.state" if kind == _MOVES else ""
            for field, new in _FIELDS[_STATE if inner else kind].items():
                pattern = rf"(?<![\w.]){re.escape(name)}{inner}\.{field}\b"
                after = re.sub(pattern, f"{name}.{new}", after)
        if after != before:
            self.replace(text, after)

    def replace_text(self, start: int, end: int, text: str) -> None:
        """Write a text in the place of another one."""
        self.edits.append(Edit(start=start, end=end, text=text))
