"""Files of parameters: what controllers and Nav2 are given in later distributions of ROS 2.

Source: ros-controls/ros2_controllers, doc/migration.rst and the declarations of parameters, Humble
to Kilted; ros-navigation/navigation2, the plugin descriptions and nav2_bt_navigator, Humble to
Kilted; ros-teleop/twist_mux#50 and #55.
"""

from __future__ import annotations

import re
from pathlib import Path  # noqa: TC003  a NamedTuple
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import Edit
from wsgen.checks.rules.controllers import FORMER_TYPES, managed_types, node_sections
from wsgen.model.facts import DISTROS
from wsgen.porting.ported import FilePort, Unported
from wsgen.ros.names import released_packages
from wsgen.text import yamlfile

if TYPE_CHECKING:
    from wsgen.checks.fixes.source import SourceText
    from wsgen.model.target import Target


class Stamper(NamedTuple):
    """A controller that takes commands with a time, and took them without one."""

    file: Path  # of its parameters
    line: int  # 1-based
    controller: str
    source: str  # its former topic
    target: str


# Type of a controller -> its topic of commands without a time up to Iron, and with one.
_TOPICS = {
    "diff_drive_controller/DiffDriveController": ("cmd_vel_unstamped", "cmd_vel"),
    **dict.fromkeys(
        (
            "ackermann_steering_controller/AckermannSteeringController",
            "bicycle_steering_controller/BicycleSteeringController",
            "mecanum_drive_controller/MecanumDriveController",
            "tricycle_steering_controller/TricycleSteeringController",
        ),
        ("reference_unstamped", "reference"),
    ),
}
_UNSTAMPED = "use_stamped_vel"
# Types that the same parameters suit.
_ALIKE = ("joint_state_controller/JointStateController",)
# Types of controllers that pass commands on to one interface -> that; where a distribution lacks
# their package, this one does the same.
_FORWARDING = {
    f"{one}_controllers/JointGroup{one.capitalize()}Controller": one
    for one in ("effort", "position", "velocity")
}
_FORWARD = "forward_command_controller/ForwardCommandController"
_GRIPPERS = {
    f"{one}_controllers/GripperActionController": "parallel_gripper_action_controller/"
    "GripperActionController"
    for one in ("effort", "position")
}
# Parameter of a controller -> its name since Kilted.
_RENAMED_IN_KILTED = {"open_loop_control": "interpolate_from_desired_state"}
# Plugins of Nav2 as they are called up to Iron; later they are C++ names.
_PLUGIN = re.compile(
    r"\b(nav2_behaviors|nav2_navfn_planner|nav2_smac_planner|nav2_theta_star_planner)/(\w+)"
)
# Libraries that nav2_bt_navigator loads by itself since Jazzy, and refuses to load twice.
_BUILT_IN = re.compile(r"nav2_\w+_bt_node|nav2_path_expiring_timer_condition")
_LIBRARIES = "plugin_lib_names"
_CHECKER = "progress_checker_plugin"  # a list since Iron
# Nodes that publish or read commands, which have a time unless a parameter says otherwise: that
# parameter, and since when.
_STAMPED = {
    "twist_mux": ("use_stamped", "jazzy"),
    **dict.fromkeys(
        (
            *("behavior_server", "collision_monitor", "controller_server", "docking_server"),
            "velocity_smoother",
        ),
        ("enable_stamped_cmd_vel", "kilted"),
    ),
}


def port_parameters(source: SourceText, target: Target) -> tuple[FilePort, tuple[Stamper, ...]]:
    """Port a file of parameters, and say which controllers want commands with a time now."""
    if "ros__parameters" not in source.text:
        return FilePort(), ()
    content = yamlfile.parse(source.text, are_parameters=True)
    if not isinstance(content, yamlfile.Value):
        return FilePort(), ()
    port = _Port(source, target)
    types = {name: value.text or "" for name, value in managed_types(content)}
    nodes = [*node_sections(content, "")]
    parameters = {path.rpartition("/")[2]: values for path, values in nodes}
    for name, value in managed_types(content):
        port.type(name, value, parameters.get(name))
    for path, values in nodes:
        port.node(path, values, types.get(path.rpartition("/")[2], ""))
    port.plugins()
    return FilePort(edits=tuple(port.edits), unported=tuple(port.unported)), tuple(port.stampers)


class _Port:
    """The port of a file, as far as it is made."""

    def __init__(self, source: SourceText, target: Target) -> None:
        self.source = source
        self.distro = target.distro
        self.edits: list[Edit] = []
        self.unported: list[Unported] = []
        self.stampers: list[Stamper] = []

    def _leave(self, line: int, what: str, advice: str) -> None:
        self.unported.append(Unported(self.source.file, line, what, advice))

    def _line(self, line: int) -> tuple[int, str]:
        start, end = self.source.start_of(line), self.source.start_of(line + 1)
        return start, self.source.text[start:end]

    def _remove_line(self, line: int) -> None:
        """Remove a line; its comment stays."""
        start, text = self._line(line)
        comment = re.search(r"(?<=\s)#[^\r\n]*", text)
        indent = self.source.indent_at(start)
        kept = f"{indent}{comment[0]}{self.source.newline}" if comment else ""
        self.edits.append(Edit(start=start, end=start + len(text), text=kept))

    def _rename(self, line: int, old: str, new: str) -> bool:
        """Write a word for another one on a line, where it is there once."""
        start, text = self._line(line)
        found = [*re.finditer(rf"(?<![\w/]){re.escape(old)}(?![\w/])", text.partition(" #")[0])]
        if len(found) == 1:
            place = start + found[0].start()
            self.edits.append(Edit(start=place, end=place + len(old), text=new))
        return len(found) == 1

    def type(self, name: str, value: yamlfile.Value, parameters: yamlfile.Value | None) -> None:
        """Write the type of a controller that has another one in the distribution."""
        written = value.text or ""
        package = "gripper_controllers" if written in _GRIPPERS else written.partition("/")[0]
        new = FORMER_TYPES.get(written)
        if new is None and self.distro not in released_packages().get(package, (self.distro,)):
            new = _GRIPPERS.get(written) or (_FORWARD if written in _FORWARDING else None)
        if new is None or (written in _ALIKE and self._rename(value.line, written, new)):
            return
        if written in _FORWARDING and parameters is not None:
            line = f"interface_name: {_FORWARDING[written]}"
            if self._add(parameters, line) and self._rename(value.line, written, new):
                return
        self._leave(
            value.line,
            f"ROS 2 {self.distro} does not have the type `{written}` of the controller `{name}`.",
            f"Use `{new}`, with the parameters that it takes.",
        )

    def _add(self, values: yamlfile.Value, written: str) -> bool:
        """Add a parameter in front of the others, where these are in block style."""
        start, text = self._line(values.line)
        if re.match(r"[ \t]+[\w/*]", text) is None:
            return False
        line = f"{self.source.indent_at(start)}{written}{self.source.newline}"
        self.edits.append(Edit(start=start, end=start, text=line))
        return True

    def node(self, path: str, values: yamlfile.Value, kind: str) -> None:
        """Port the parameters of a node."""
        name = path.rpartition("/")[2]
        for key, value in values.items():
            start, text = self._line(value.line)
            is_alone = re.match(rf"[ \t]*{re.escape(key)}[ \t]*:", text) is not None
            if key == _UNSTAMPED and value.content is False:
                self._stamped(path, value.line, kind or _kind(values), is_alone=is_alone)
            elif key in _RENAMED_IN_KILTED and self._is_since("kilted") and is_alone:
                self._rename(value.line, key, _RENAMED_IN_KILTED[key])
            elif key == _CHECKER and value.text and is_alone:
                place = text.index(value.text, text.index(":"))
                around = int(text[place - 1 : place] in {'"', "'"})
                first, last = place - around, place + len(value.text) + around
                written = f"{key}s: [{text[first:last]}]"
                begin = start + text.index(key)
                self.edits.append(Edit(start=begin, end=start + last, text=written))
            elif key == _LIBRARIES and name.startswith("bt_navigator"):
                self._libraries(value)
        parameter, since = _STAMPED.get(name, ("", ""))
        if parameter and self._is_since(since) and values.get(parameter) is None:
            self._add(values, f"{parameter}: false")

    def _is_since(self, distro: str) -> bool:
        return DISTROS.index(self.distro) >= DISTROS.index(distro)

    def _stamped(self, path: str, line: int, kind: str, *, is_alone: bool) -> None:
        path = path.removeprefix("/**/")  # in any namespace: that of the launch
        name, topics = path.strip("/"), _TOPICS.get(kind)
        if topics is None or not is_alone:
            self._leave(
                line,
                f"The controller `{name}` takes commands with a time (TwistStamped) in ROS 2 "
                f"{self.distro}, and no longer reads `{_UNSTAMPED}`.",
                "Remove the parameter, and publish TwistStamped, for example by twist_stamper.",
            )
            return
        self._remove_line(line)
        self.stampers.append(
            Stamper(self.source.file, line, name, *(f"{path}/{one}" for one in topics))
        )

    def _libraries(self, value: yamlfile.Value) -> None:
        """Take out what the node loads by itself."""
        own = [one for one in value.elements() if not _BUILT_IN.fullmatch(one.text or "")]
        lines = {one.line for one in value.elements() if one not in own}
        if not lines:
            return
        start, text = self._line(value.line)
        is_flow = f"{_LIBRARIES}:" in text
        key = value.line if is_flow else self._line_of_key(value.line)
        if key is None or (is_flow and own):
            self._leave(
                value.line,
                "bt_navigator loads the libraries of Nav2 by itself, and ends if they are listed.",
                f"Leave only those of others in `{_LIBRARIES}`.",
            )
            return
        last = max(lines) if not is_flow else self._end_of_flow(start)
        for line in range(key if not own else key + 1, last + 1):
            if line in lines or is_flow or (line == key and not own):
                self._remove_line(line)

    def _line_of_key(self, line: int) -> int | None:
        """The line of the key of a list in block style that begins on a line."""
        for above in range(line, 0, -1):
            _, text = self._line(above)
            if text.lstrip().startswith(f"{_LIBRARIES}:"):
                return above
            if above != line and text.strip() and not text.lstrip().startswith(("#", "-")):
                return None
        return None

    def _end_of_flow(self, start: int) -> int:
        end = self.source.text.find("]", start)
        return self.source.line_at(end if end >= 0 else start)

    def plugins(self) -> None:
        """Write the names of plugins of Nav2 as pluginlib has them since Jazzy."""
        for found in _PLUGIN.finditer(self.source.text):
            start = self.source.start_of(self.source.line_at(found.start()))
            if "#" not in self.source.text[start : found.start()]:
                slash = found.end(1)
                self.edits.append(Edit(start=slash, end=slash + 1, text="::"))


def _kind(values: yamlfile.Value) -> str:
    """What a controller is by its parameters, where no other file says its type."""
    return next(iter(_TOPICS)) if values.get("left_wheel_names") is not None else ""
