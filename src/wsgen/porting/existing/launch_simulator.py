"""The simulator in launch files of ROS 1: its world, its robots and their controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.gazebo.systems import EMPTY_WORLD
from wsgen.launching.spawner_options import POSE
from wsgen.model.target import SIM
from wsgen.porting.bridges import BRIDGE, BRIDGE_PACKAGE, CLOCK
from wsgen.porting.existing.controllers_of_ros1 import MANAGER, spawned
from wsgen.porting.existing.launch_parameters import DESCRIPTION, ParameterPort, dotted
from wsgen.porting.existing.launch_port import PUBLISHER, Action, attributes, unpauses
from wsgen.porting.existing.launch_values import (
    UnsaidError,
    joined,
    listed,
    mapped,
    paired,
)
from wsgen.porting.existing.programs_of_ros1 import (
    spawn_options,
)
from wsgen.porting.launch_files import DEFAULT_WORLDS, ON, SWITCHES
from wsgen.ros import ros1

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.porting.existing.launch_values import Code
    from wsgen.text.xmltree import Element

    Given = Mapping[str, str]  # the attributes of an element


class SimulatorPort(ParameterPort):
    """The port of a launch file, with its simulator."""

    def _leave_argument(self, what: str, advice: str) -> None:
        """List an argument of the node that is ported now."""
        self.leave(self.node, what, advice, "args")

    def _gazebo(self, element: Element, given: Given) -> list[Action]:
        """Gazebo, and the time of nodes, which is its own."""
        uses_time = self.values.flag(given.get("use_sim_time", "true"))
        self.packages.add(self.sim["package"])
        world = given.get("world_name", "")
        if world not in DEFAULT_WORLDS and world in ros1.GAZEBO_LAUNCH_FILES.values():
            self.leave(
                element,
                f"The world `{world}` is one that Gazebo Classic brings.",
                "Copy what you need of it into a world file of the package.",
            )
            world = ""
        physics = given.get("physics", "ode")
        if physics != "ode" and "$(" not in physics:
            self.leave(element, f"Gazebo used the engine {physics}.", "Name it in the world file.")
        switches = {
            name: self.values.flag(given[old])
            for old, name in ros1.GAZEBO_ARGUMENTS.items()
            if name in SWITCHES and old in given
        }
        is_default = world in DEFAULT_WORLDS
        if self.source.target.simulator == SIM:
            if unpauses(self.root) or any(one.unpauses for one in self.facts):
                switches.pop("pause", None)  # the spawner cannot start it
            world = self._default_world if is_default else world
            arguments = [("gz_args", self._gz_args(switches, world))]
        else:
            arguments = [] if is_default else [("world", self.values.path(world))]
            for name, code in switches.items():
                is_literal = code in {"True", "False"}
                arguments.append((name, repr(str(code).lower()) if is_literal else code))
        file = self.values.path(f"$(find {self.sim['package']})/launch/{self.sim['launch_file']}")
        include = self._inclusion(file, arguments, self.values.condition(attributes(element)))
        call = self.values.call("SetParameter", "'use_sim_time'", uses_time)
        actions = [Action(call, is_setting=True, outlives=True)] if uses_time != "False" else []
        return [*actions, Action(include, "gazebo"), *self._bridge()]

    def _gz_args(self, switches: Mapping[str, Code], world: str) -> Code:
        pieces: list[Code] = []
        for name, (on, off) in SWITCHES.items():
            value = switches.get(name, str(ON[name]))
            if value in {"True", "False"}:
                pieces.append(repr(on if value == "True" else off))
            else:
                pieces.append(self.values.call("IfElseSubstitution", value, repr(on), repr(off)))
        quote = repr("" if world == EMPTY_WORLD else '"')
        return joined([*pieces, quote, self.values.path(world), quote])

    def _bridge(self) -> list[Action]:
        """What has the time of Gazebo Sim reach the nodes."""
        if self.source.target.simulator != SIM:
            return []
        self.packages.add(BRIDGE_PACKAGE)
        keywords: dict[str, Code] = {"output": "'screen'"}
        if self.source.bridge is None:
            keywords["arguments"] = listed([repr(CLOCK)])
        else:
            path = self.values.path(f"$(find {self.source.old})/{self.source.bridge}")
            value = self.values.call("ParameterValue", path, value_type="str")
            keywords["parameters"] = listed([mapped([("config_file", value)])])
        return [Action(self._node_call(BRIDGE_PACKAGE, BRIDGE, keywords), "bridge")]

    def _spawn(self, words: list[str], keywords: dict[str, Code]) -> list[Action]:
        """The spawner of the target for spawn_model of ROS 1."""
        options = spawn_options(words)
        known = {"urdf", "sdf", "gazebo", "file", "param", "model", "unpause", "b", *POSE}
        for name in sorted(options.keys() - known):
            self._leave_argument(
                f"`-{name}` of spawn_model is gone.",
                "Write the positions as initial values into <ros2_control>, or command the joints."
                if name == "J"
                else f"See `ros2 run {self.sim['package']} {self.sim['spawner']} --help`.",
            )
        actions: list[Action] = []
        arguments: list[Code] = []
        file = options.get("file", [""])[0]
        model = self._model(file)
        if model is not None:
            actions += self._expanded(model, arguments)
        elif "file" in options:
            arguments += ["'-file'", self.values.path(file)]
        elif "param" in options:
            actions += self._described(options["param"][0].strip("/") or DESCRIPTION, arguments)
        else:
            raise UnsaidError(
                "What spawn_model spawned is neither in a file nor in a parameter.",
                "Name the file of the model with -file.",
            )
        if self.source.entity and self._spawns_one(options):
            options["model"] = [self.source.entity]
        flags = {"model": self.sim["entity_flag"]}
        flags |= {flag[1:]: flag for flag in self.sim["pose_flags"].split()}
        for name, flag in flags.items():
            if name in options:
                arguments += [repr(flag), self.values.text(options[name][0])]
        if "unpause" in options and self.source.target.simulator != SIM:
            arguments.append("'-unpause'")
        keywords["arguments"] = paired(arguments)
        self.packages.add(self.sim["package"])
        call = self._node_call(self.sim["package"], self.sim["spawner"], keywords)
        return [*actions, Action(call, "spawn_robot")]

    def _spawns_one(self, options: Mapping[str, list[str]]) -> bool:
        """Whether it is surely the robot of the package that is spawned, and once."""
        spawners = [one for one in self.root.iter("node") if one.get("type") in ros1.SPAWNERS]
        is_named = "$(" not in options.get("model", ["$("])[0]
        return is_named and "sdf" not in options and len(spawners) == 1

    def _expanded(self, model: str, arguments: list[Code]) -> list[Action]:
        """Add the robot that was in a file, as xacro expands it."""
        self.packages.add("xacro")
        command = self.values.command(["xacro", model])
        if self.source.target.simulator == SIM:
            arguments += ["'-string'", command]
            return []
        arguments += [repr(self.sim["topic_flag"]), repr(DESCRIPTION)]
        if self.has_publisher:
            return []
        value = self.values.call("ParameterValue", command, value_type="str")
        return [self._publisher(listed([mapped([(DESCRIPTION, value)])]))]

    def _publisher(self, parameters: Code | None = None) -> Action:
        self.packages.add(PUBLISHER)
        keywords: dict[str, Code] = {"output": "'screen'"}
        keywords |= {"parameters": parameters} if parameters is not None else {}
        return Action(self._node_call(PUBLISHER, PUBLISHER, keywords), PUBLISHER)

    def _described(self, parameter: str, arguments: list[Code]) -> list[Action]:
        """Add where the spawner has the robot from: a topic, if there is one, or a parameter."""
        names = {(one.get("name") or "").strip("/") for one in self.root.iter("param")}
        is_set_here = parameter in names or any(one.sets for one in self.facts)
        topic = self.values.text(parameter.rpartition("/")[2])
        if self.has_publisher or not is_set_here:
            arguments += [repr(self.sim["topic_flag"]), topic]
            return []
        if self.source.target.simulator == SIM:
            arguments += ["'-param'", self.values.text(dotted(parameter))]
            return []
        arguments += [repr(self.sim["topic_flag"]), topic]
        return [self._publisher()]

    def _gazebo_program(self, element: Element, program: str, words: list[str]) -> list[Action]:
        if program == "gzclient":
            return []  # what starts Gazebo opens its window, too
        world = next((one for one in words if one.endswith((".world", ".sdf"))), "")
        given = {"world_name": world, "gui": str(program != "gzserver").lower()}
        is_paused = bool({"-u", "--pause"} & {*words})
        return self._gazebo(element, {**given, **({"paused": "true"} if is_paused else {})})

    def _controllers(self, words: list[str], keywords: dict[str, Code]) -> list[Action]:
        """The spawner, for those controllers that the package has."""
        names = spawned(words)
        unknown = [one for one in names if one not in self.source.controllers]
        if unknown:
            self._leave_argument(
                f"The controllers {', '.join(unknown)} are of ros_control.",
                f"{self.source.controllers_file} has those that ros2_control has, too."
                if self.source.controllers_file
                else "Describe the joints in <ros2_control>, and the controllers in a file for "
                "controller_manager; --control writes both.",
            )
        known = [self.source.controllers[one] for one in names if one in self.source.controllers]
        if not known:
            return []
        self.packages.add(MANAGER)
        inactive = ["--inactive"] if "--stopped" in words else []
        # The manager has no namespace, whatever that of the spawner is.
        manager = ["--controller-manager", "/controller_manager"]
        keywords.pop("namespace", None)
        keywords["arguments"] = listed(map(repr, [*dict.fromkeys(known), *inactive, *manager]))
        return [Action(self._node_call(MANAGER, "spawner", keywords), "spawner")]
