"""Parameters in launch files of ROS 1, which has a server of them, as nodes of ROS 2 get them."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from wsgen.porting.existing.launch_port import (
    ARGUMENT,
    FIND,
    PUBLISHER,
    Action,
    LaunchPort,
    attributes,
    is_outside,
)
from wsgen.porting.existing.launch_values import (
    Tree,
    UnsaidError,
    joined,
    split_words,
    text_of,
)
from wsgen.porting.existing.parameters_of_ros1 import port_parameters, refuse_controllers
from wsgen.text.yamlfile import NotYaml
from wsgen.text.yamlfile import parse as parse_yaml

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.porting.existing.launch_values import Code
    from wsgen.text.xmltree import Element

    Given = Mapping[str, str]  # the attributes of an element

DESCRIPTION = "robot_description"
SLIDERS = "joint_state_publisher"
SUBSTITUTED = re.compile(r"\$\([^()]*\)")
CONDITIONS = frozenset(("if", "unless"))


def dotted(name: str) -> str:
    """A name of a parameter as ROS 2 writes it."""
    return name.strip("/~").replace("/", ".")


class ParameterPort(LaunchPort):
    """The port of a launch file, with its parameters."""

    def _attach(self) -> None:
        """Give parameters that are set outside of nodes to those that surely read them."""
        for element in self.root.iter("param", "rosparam"):
            given, parent = attributes(element), element.getparent()
            if parent is None or not is_outside(element) or CONDITIONS & given.keys():
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

    def _is_model_by_default(self, word: str) -> bool:
        """Whether a word is an argument whose default leads to the robot, as `_arg` changes it."""
        named = ARGUMENT.fullmatch(word)
        default = self.values.declared.get(named[1]) if named is not None else None
        return (
            named is not None and self._is_expanded(named[1]) and bool(self._model(default or ""))
        )

    def _param(self, element: Element, given: Given) -> list[Action]:
        del element
        return self._set([(given.get("name", ""), self._value(given))], given)

    def _set(self, pairs: Iterable[tuple[str, Code]], given: Given) -> list[Action]:
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
                actions.append(Action(call, is_setting=True, outlives=True))
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

    def _rosparam(self, element: Element, given: Given) -> list[Action]:
        """Parameters that a file or text outside of nodes sets."""
        self._refuse_command(given)
        found = FIND.fullmatch(given.get("file", "").strip())
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
        return [Action(call, is_setting=True, outlives=True)]

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
        found = FIND.fullmatch(path)
        if found is None or found[1] != self.source.old or any("$(" in one for one in keys):
            raise UnsaidError(
                f"`{path}` is not a file of this package, or its namespace is only known when it "
                "is launched.",
                "Write the name of the node, or `/**`, and `ros__parameters` above its "
                "parameters, and give it to the node.",
            )
        pattern = SUBSTITUTED.sub("*", found[2])
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


def _flattened(value: Code) -> Iterator[tuple[str, Code]]:
    """The values in nested dictionaries, by their dotted names."""
    if isinstance(value, Tree) and value.head == "{":
        for item in value.items:
            key = text_of(item.key.removesuffix(": ")) or ""
            for inner, code in _flattened(item.code):
                yield (f"{key}.{inner}" if inner else key), code
    else:
        yield "", value
