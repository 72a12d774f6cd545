"""Nodes in launch files of ROS 1, with their programs, arguments and settings."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.porting.existing.controllers_of_ros1 import MANAGER
from wsgen.porting.existing.launch_parameters import CONDITIONS, SLIDERS, SUBSTITUTED, dotted
from wsgen.porting.existing.launch_port import Action, attributes, tags
from wsgen.porting.existing.launch_simulator import SimulatorPort
from wsgen.porting.existing.launch_values import (
    Tree,
    UnsaidError,
    listed,
    mapped,
    paired,
    split_words,
)
from wsgen.porting.existing.programs_of_ros1 import (
    topic_command,
    transform_arguments,
    written_for_ros_1,
)
from wsgen.ros import ros1

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.porting.existing.launch_values import Code
    from wsgen.text.xmltree import Element

    Given = Mapping[str, str]  # the attributes of an element

_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)


class _Settings(NamedTuple):
    """What a node is given."""

    files: list[Code]  # of parameters
    pairs: list[tuple[str, Code]]  # parameters
    rules: list[tuple[Code, Code]]  # remappings


class NodePort(SimulatorPort):
    """The port of a launch file, with its nodes."""

    def _node(self, element: Element, given: Given) -> list[Action]:
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
    ) -> list[Action]:
        """What programs do whose counterparts are others."""
        given = attributes(element)
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
    ) -> list[Action]:
        if words:
            keywords["arguments"] = paired([self._argument(word) for word in words])
        name = element.get("name", there[1])
        actions = [Action(self._node_call(*there, keywords), SUBSTITUTED.sub("", name) or name)]
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
            actions.append(Action(call, f"activate_{there[1]}"))
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
        for one in tags(element):
            given = attributes(one)
            with self._listing(one):
                if CONDITIONS & given.keys():
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

    def _sliders(self, shows: Code, keywords: dict[str, Code]) -> list[Action]:
        """joint_state_publisher, which shows sliders where it is told to."""
        keywords["name"] = repr(SLIDERS)
        nodes = {"True": f"{SLIDERS}_gui", "False": SLIDERS}
        if shows in nodes:
            nodes = {"": nodes[str(shows)]}
        self.packages.update(nodes.values())
        condition = keywords.pop("condition", None) if len(nodes) > 1 else None
        actions = list[Action]()
        for truth, name in nodes.items():
            if truth:
                test = "IfCondition" if truth == "True" else "UnlessCondition"
                keywords["condition"] = self.values.call(test, shows)
            actions.append(Action(self._node_call(name, name, keywords), name))
        if condition is None:
            return actions
        return [Action(self._grouped(actions, "", condition), "sliders")]

    def _topic(self, words: list[str], given: Given) -> Action:
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
        return Action(call, given.get("name", "topic"))


def _conditional(element: Element) -> UnsaidError:
    return UnsaidError(
        f"<{element.tag}> of a node has a condition.", "Write two nodes, each with a condition."
    )
