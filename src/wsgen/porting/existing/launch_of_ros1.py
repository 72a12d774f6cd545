"""Launch files in the XML of ROS 1 become launch files in Python, with the same arguments.

Nodes, parameters and remappings stay as far as ROS 2 has them. ROS 2 has no server of parameters:
what is set outside of nodes is given to the nodes that it reaches. What has no counterpart is
listed, and is not in the new file. Source: wiki.ros.org/roslaunch/XML; ros/ros_comm, roslaunch.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.porting.existing.launch_nodes import NodePort
from wsgen.porting.existing.launch_parameters import CONDITIONS, SUBSTITUTED
from wsgen.porting.existing.launch_port import (
    ARGUMENT,
    ENDINGS,
    FIND,
    HERE,
    Action,
    Facts,
    PortedLaunch,
    Source,
    attributes,
    facts_of,
    included,
    is_of_ros_1,
    named_file,
    ported_name,
    tags,
)
from wsgen.porting.existing.launch_values import (
    Item,
    UnsaidError,
    prose_above,
    whole_file,
)
from wsgen.porting.existing.resources import with_own_names
from wsgen.porting.ported import Unported
from wsgen.ros import ros1
from wsgen.text.xmltree import Malformed
from wsgen.text.xmltree import parse as parse_xml

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from wsgen.porting.existing.launch_values import Code
    from wsgen.text.xmltree import Element

    Given = Mapping[str, str]  # the attributes of an element

# Elements without a counterpart -> what to do.
_LEFT = {
    "machine": "Start what runs there by a launch file on that machine.",
    "test": "Write the test with launch_testing.",
    "master": "Remove it: ROS 2 has no master.",
}


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


class _Port(NodePort):
    """The port of a launch file, with all of its elements."""

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

    def _walk(self, parent: Element) -> list[Action]:
        """The actions for the elements in another one; what sets something comes first.

        roslaunch sets all parameters before it starts a node.
        """
        actions: list[Action] = []
        for element in tags(parent):
            new: list[Action] = []
            if element not in self.handled:
                with self._listing(element):
                    new = self._element(element)
            if new:
                place = self.written.get(element)
                above = prose_above(self.text, place.line) if place is not None else ()
                new[0] = new[0]._replace(comments=(*above, *new[0].comments))
                actions += new
        return sorted(actions, key=lambda one: not one.is_setting)

    def _element(self, element: Element) -> list[Action]:
        kinds: Mapping[str, Callable[[Element, Given], list[Action]]] = {
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
            return kinds[kind](element, attributes(element))
        advice = _LEFT.get(kind, "Remove it: roslaunch does not read it either.")
        raise UnsaidError(f"ROS 2 has no counterpart of <{kind}>.", advice)

    def _arg(self, element: Element, given: Given) -> list[Action]:
        name, default = given.get("name", ""), given.get("default")
        if not name:
            raise UnsaidError("An <arg> has no name.", "Name it.")
        condition = self.values.condition(given)
        if "value" in given:
            value = self.values.path(given["value"])
            call = self.values.call(
                "SetLaunchConfiguration", repr(name), value, condition=condition
            )
            return [Action(call, is_setting=True)]
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
        if any(ARGUMENT.sub(r"\1", one.get("file", "")) == name for one in self._includes):
            default = ported_name(default) if default and default.endswith(ENDINGS) else default
        call = self.values.call(
            "DeclareLaunchArgument",
            repr(name),
            default_value=None if default is None else self.values.path(default),
            description=repr(" ".join(given["doc"].split())) if given.get("doc") else None,
            condition=condition,
        )
        return [Action(call, is_setting=True)]

    def _is_used(self, name: str) -> bool:
        word = re.escape(name)
        used = re.compile(rf"\$\(arg\s+{word}\s*\)|\$\(eval\b[^\"]*\b{word}\b|pass_all_args=")
        return used.search(self.text) is not None

    def _remap(self, element: Element, given: Given) -> list[Action]:
        del element
        call = self.values.call(
            "SetRemap",
            src=self.values.text(given.get("from", "")),
            dst=self.values.text(given.get("to", "")),
            condition=self.values.condition(given),
        )
        return [Action(call, "remapping")]

    def _group(self, element: Element, given: Given) -> list[Action]:
        """A group; parameters stay when it ends, what else it sets does not."""
        inside, namespace = self._walk(element), given.get("ns", "")
        condition = self.values.condition(given)
        settings = [one for one in inside if one.is_setting]
        if namespace or not any(one.outlives for one in settings):
            settings = []
        actions = settings if condition is None else []
        if settings and condition is not None:
            code = self._grouped(settings, "", condition, is_scoped=False)
            actions = [Action(code, is_setting=True, outlives=True)]
        others = [one for one in inside if one not in settings]
        if others:
            outlives = any(one.outlives for one in others)
            is_scoped = bool(namespace) or not outlives
            code = self._grouped(others, namespace, condition, is_scoped=is_scoped)
            name = f"group_{namespace}" if namespace else "group"
            is_setting = all(one.is_setting for one in others)
            actions = [*actions, Action(code, name, is_setting, outlives)]
        return actions

    def _include(self, element: Element, given: Given) -> list[Action]:
        path = named_file(element)
        arguments, environment = self._passed(element)
        found, here = FIND.fullmatch(path), HERE.fullmatch(path)
        package = found[1] if found else self.source.old if here else ""
        name = path.rpartition("/")[2]
        if package == "gazebo_ros" and name in ros1.GAZEBO_LAUNCH_FILES:
            world = ros1.GAZEBO_LAUNCH_FILES[name]
            return self._gazebo(element, {"world_name": world, **arguments})
        if package in {self.source.old, *self.source.siblings}:
            code = self._own_launch_file(element, path)
        else:
            code = self._other_launch_file(package, name, path)
        known = included(element, self.file, self.source)
        facts = facts_of(known, self.source) if known is not None else Facts()
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
            inside = [*environment, Action(call)]
            call = self._grouped(inside, namespace, condition, is_scoped=is_scoped)
        return [
            Action(call, SUBSTITUTED.sub("", name).partition(".")[0], facts.only_sets, facts.sets)
        ]

    def _passed(self, element: Element) -> tuple[dict[str, str], list[Action]]:
        """The arguments and variables that are given to an included launch file."""
        arguments, environment = dict[str, str](), list[Action]()
        for one in tags(element):
            given = attributes(one)
            if one.tag == "env":
                environment += self._env(one, given)
            elif CONDITIONS & given.keys():
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
        if path.count("$(") == 1 and included(element, self.file, self.source) is None:
            raise UnsaidError(f"The launch file {path} does not exist.", "Correct its path.")
        self._package((FIND.fullmatch(path) or ["", self.source.old])[1])
        written = element.get("file", "").strip()
        is_argument = ARGUMENT.fullmatch(written) is not None
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
