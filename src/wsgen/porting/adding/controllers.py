"""A controller of ros2_control: its parameters, the interfaces of its joints, and its spawner."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence  # noqa: TC003  a NamedTuple
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.launch_files import tree_of
from wsgen.checks.fixes.source import Edit
from wsgen.errors import NotFoundError, RequestError
from wsgen.packages.workspace.layout import BUILD_MARKERS, LAUNCH_FILES
from wsgen.porting.adding.parameters import insert_in_node
from wsgen.porting.adding.places import Item, insert_among, insert_below
from wsgen.porting.adding.robots import read_robot, robot_file
from wsgen.porting.adding.types import check_name
from wsgen.porting.bridges import BridgeWriter
from wsgen.porting.existing.extensions import CONTROLLERS, Controller
from wsgen.porting.python_edits import PythonEdits, argument
from wsgen.porting.xml_edits import Block, Editor, read_nodes
from wsgen.text.files import list_files, read_or_empty
from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from wsgen.porting.adding.addition import Addition

_BROADCASTER = Controller(
    "joint_state_broadcaster", "joint_state_broadcaster/JointStateBroadcaster", ""
)
KINDS = {**CONTROLLERS, "broadcaster": _BROADCASTER}
_MANAGER = "controller_manager"
_SPAWNERS = ("spawner", "spawner.py")
_OF_XML = (".xacro", ".urdf", ".gazebo")


class ControllerOptions(NamedTuple):
    """What is asked for."""

    kind: str  # a key of KINDS
    joints: Sequence[str] = ()  # none: all of <ros2_control>
    robot: str | None = None  # a file of the package; None: the only one


def add_controller(addition: Addition, name: str, options: ControllerOptions) -> None:
    """Add a controller.

    Raises:
        NotFoundError: The robot or its <ros2_control> does not exist.
        RequestError: A joint does not exist, or a name cannot be.
    """
    check_name("controller", name)
    kind = KINDS[options.kind]
    main = robot_file(addition, options.robot)
    _, robot = read_robot(addition, main)
    parts = [one for system in (robot.controls if robot else ()) for one in system.joints]
    known = [one.name for one in parts if not one.mimic]
    if not known:
        raise NotFoundError(
            f"The robot of {main.name} has no <ros2_control> with joints.",
            hint="Add that first; docs/from.md shows one.",
        )
    for one in options.joints:
        if one not in known:
            raise RequestError(
                f"<ros2_control> of {main.name} has no joint {one}.",
                hint=f"{ask_for_nearest(one, known)}Choose among {some_of(known, 8)}.",
            )
    commanded = [one.name for one in parts if one.commands] or known
    joints = [*(options.joints or commanded)] if kind.interface else []
    if kind.interface:
        lacking = {
            one.name for one in parts if one.name in joints and kind.interface not in one.commands
        }
        _command(addition, lacking, kind.interface)
    _set(addition, name, kind, joints)
    _spawn(addition, name)
    addition.depend("exec_depend", _MANAGER, kind.type.partition("/")[0])


def _command(addition: Addition, joints: set[str], interface: str) -> None:
    """Give joints a command interface, where <ros2_control> names them."""
    block = Block("command_interface", (), f'name="{interface}"')
    found: set[str] = set()  # there may be one for the robot and one for the simulator
    for file in sorted(list_files(addition.folder, _OF_XML, markers=BUILD_MARKERS)):
        source = addition.source(file)
        if source is None or "<ros2_control" not in source.text:
            continue
        editor = Editor(source)
        for node in read_nodes(source):
            if not (node.name == "joint" and node.is_in("ros2_control")):
                continue
            has_it = any(one.get("name") == interface for one in node.children(block.name))
            if node.get("name") in joints and not has_it:
                editor.append(node, block)
                found.add(node.get("name"))
        addition.edit(file, editor.finish())
    if joints - found:
        addition.paste(
            addition.folder / "<ros2_control>",
            f'<command_interface name="{interface}"/>',
            f"Add it to the joints {', '.join(sorted(joints - found))}, whose names are computed.",
        )


def _set(addition: Addition, name: str, kind: Controller, joints: Sequence[str]) -> None:
    """Have the controller manager know the controller, and set its parameters."""
    own = addition.render("controller", name=name, kind=kind, joints=joints).strip("\n")
    declared = [f"{name}:", f"  type: {kind.type}"]
    for file in sorted(list_files(addition.folder, (".yaml", ".yml"), markers=BUILD_MARKERS)):
        if not insert_in_node(addition, file, _MANAGER, name, declared):
            continue
        source = addition.require(file)
        if joints and not re.search(
            rf"(?m)^[\s/\"']*{name}[\"']?:\s*\n\s+ros__parameters", source.text
        ):
            last = max(0, len(source.text.rstrip()) - 1)
            addition.edit(file, [insert_below(source, last, f"\n{own}")])
        return
    text = "\n".join([f"{_MANAGER}:", "  ros__parameters:", *(f"    {one}" for one in declared)])
    addition.paste(
        addition.folder / "config/controllers.yaml",
        f"{text}\n\n{own}" if joints else text,
        f"The package has no parameters of the {_MANAGER}: add these to those that it reads.",
    )


def _named_beside(edits: PythonEdits, call: ast.Call, name: str) -> list[Edit]:
    """A spawner with a name of its own below another one that has one, started behind it."""
    statement, source, quoted = edits.parents.get(call), edits.source, edits.quoted
    if not isinstance(statement, ast.Assign) or not isinstance(statement.targets[0], ast.Name):
        return []
    started = [
        (node, parent)
        for node in edits.tree.all(ast.Name)
        if node.id == statement.targets[0].id
        and isinstance(parent := edits.parents.get(node), ast.List)
    ]
    if not started:
        return []
    indent = source.indent_at(edits.tree.start(statement))
    lines = [
        f"spawn_{name} = Node(",
        f"    package={quoted(_MANAGER)},",
        "    executable=" + quoted("spawner") + ",",
        f"    output={quoted('screen')},",
        f"    arguments=[{quoted(name)}],",
        ")",
    ]
    node, _ = started[0]
    item = Item("", edits.tree.start(node), edits.tree.end(node))
    beside = insert_among(source, [item], "", f"spawn_{name}", comma=",")
    if beside is None or beside.start < item.start:  # behind the other one, on its line
        beside = Edit(start=item.end, end=item.end, text=f", spawn_{name}")
    text = "\n".join(f"{indent}{line}" for line in lines)
    return [insert_below(source, edits.tree.end(statement), text), beside]


def _spawn(addition: Addition, name: str) -> None:
    """Start a spawner beside another one."""
    files = sorted(list_files(addition.folder, LAUNCH_FILES, markers=BUILD_MARKERS))
    if any(re.search(rf"[\"'\s]{name}[\"'\s]", read_or_empty(file)) for file in files):
        return
    for file in files:
        source = addition.source(file)
        tree = tree_of(source) if source is not None else None
        if tree is None:
            continue
        edits = PythonEdits(tree)
        spawners = [
            call
            for call in edits.calls("Node")
            if edits.said(argument(call, None, "executable")) in _SPAWNERS
        ]
        for call in spawners[-1:]:
            named = _named_beside(edits, call, name)
            if not named:
                BridgeWriter(edits).add_beside([call], (_MANAGER, "spawner"), [name])
            if addition.edit(file, named or edits.all_edits()):
                return
    text = (
        f"Node(\n    package='{_MANAGER}',\n    executable='spawner',\n"
        f"    arguments=['{name}'],\n    output='screen',\n),"
    )
    where = "Start it in the launch file that starts the other controllers."
    addition.paste(files[0] if files else addition.folder / "launch", text, where)
