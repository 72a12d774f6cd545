"""Controllers of ros_control in files of parameters, as those of ros2_control with their names.

Source: ros-controls/ros_controllers and ros-controls/ros2_controllers, their parameters.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import RequestError
from wsgen.porting.existing.extensions import CONTROLLERS, Controller, measure_drive
from wsgen.porting.existing.parameters_of_ros1 import files_in
from wsgen.porting.ported import Unported
from wsgen.text.markup import read_text
from wsgen.text.xmltree import Malformed
from wsgen.text.xmltree import parse as parse_xml
from wsgen.text.yamlfile import Value, parse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.robot import Robot


BROADCASTER = "joint_state_broadcaster"
MANAGER = "controller_manager"
_DEEPEST = 5  # namespaces above a controller
_TYPE = re.compile(r"\w+/\w+")
_HAS_TYPES = re.compile(r"(?m)\btype[\"']?\s*:\s*[\"']?\w+/\w")
_NAME = re.compile(r"[A-Za-z]\w*", re.ASCII)
_TRAJECTORY = "JointTrajectoryController"
# Class of ros_control, whatever its package -> the type of ros2_control, and what it commands.
_GROUPS = {
    f"Joint{group}{kind.capitalize()}Controller": (
        f"{kind}_controllers/JointGroup{kind.capitalize()}Controller",
        kind,
    )
    for kind in CONTROLLERS
    for group in ("", "Group")
}
_GRIPPERS = {f"{kind}_controllers/GripperActionController": kind for kind in ("position", "effort")}
_DRIVE = "diff_drive_controller/DiffDriveController"
# Parameters that have the same name and meaning; numbers are real there.
_OF_GRIPPERS = ("goal_tolerance", "max_effort", "stall_timeout", "stall_velocity_threshold")
_OF_DRIVES = (
    *("publish_rate", "wheel_separation", "wheel_radius", "wheel_separation_multiplier"),
    *("left_wheel_radius_multiplier", "right_wheel_radius_multiplier", "enable_odom_tf"),
    *("pose_covariance_diagonal", "twist_covariance_diagonal", "cmd_vel_timeout"),
)
_OF_AXES = ("velocity", "acceleration", "jerk")
_SPAWNERS = ("spawner", "controller_manager", "unspawner")
_OPTIONS = frozenset(("--timeout", "--namespace", "--wait-for"))


class FoundControllers(NamedTuple):
    """The controllers of a robot."""

    controllers: tuple[Controller, ...] = ()
    names: Mapping[str, str] = {}  # in ROS 1 -> in ROS 2
    files: tuple[Path, ...] = ()  # that have nothing else
    notes: tuple[Unported, ...] = ()


def spawned(words: Sequence[str]) -> list[str]:
    """The controllers that the arguments of a spawner of ROS 1 name, without their namespaces."""
    return [
        word.rpartition("/")[2]
        for word, before in zip(words, ["", *words], strict=False)
        if word[:1] != "-" and before not in _OPTIONS and word not in {"spawn", "load"}
    ]


def find_controllers(
    folder: Path, siblings: Iterable[Path], robot: Robot, interface: str
) -> FoundControllers:
    """The controllers that a package of ROS 1, and those beside it, have for a robot.

    Args:
        folder: of the package.
        siblings: other packages: robots often have one for their control.
        robot: the robot.
        interface: what trajectories command: position, velocity or effort.
    """
    search = _Search(robot, interface)
    for place in (folder, *siblings):
        for path in files_in(place):
            search.read(place / path, is_own=place == folder)
    return search.result()


class _Search:
    """What was found so far."""

    def __init__(self, robot: Robot, interface: str) -> None:
        self.robot, self.interface = robot, interface
        self.joints = {one.name for one in robot.movable_joints if one.mimic is None}
        self.found: dict[str, Controller] = {}
        self.names: dict[str, str] = {}
        self.starts: set[str] = set()  # that spawners name
        self.files: list[Path] = []
        self.notes: list[Unported] = []
        self.gains: dict[tuple[Path, int], str] = {}  # those without an effect: of which controller

    def read(self, file: Path, *, is_own: bool) -> None:
        """Look at a file; what names no joint is listed of the own package alone."""
        if file.name.endswith((".launch", ".launch.xml")):
            self.starts |= {*_spawned_by(file)}
        text = read_text(file) if file.suffix in {".yaml", ".yml"} else None
        value = parse(text) if text is not None and _HAS_TYPES.search(text) else None
        if not isinstance(value, Value):
            return
        named = [*_controllers_in(value)]
        for name, section in named:
            joints = _texts(section, "joints", "joint", "left_wheel", "right_wheel")
            if joints and self.joints.isdisjoint(joints):
                continue  # of another robot
            try:
                one = self._ported(name, section, joints)
            except _UnsaidError as error:
                if is_own or joints:
                    advice = "Choose one of ros2_controllers, or write it for ROS 2."
                    self.notes.append(Unported(file, section.line, str(error), advice))
                continue
            self.names[name] = one.name
            if one.name != BROADCASTER and self.found.setdefault(one.name, one) == one:
                gains = section.get("pid") or section.get("gains")
                if (
                    gains is not None
                    and one.interface != "effort"
                    and "gains" not in one.parameters
                ):
                    self.gains.setdefault((file, gains.line), one.name)
        if all(name in self.names for name, _ in named) and _has_nothing_else(value):
            self.files.append(file)

    def _ported(self, name: str, value: Value, named: Sequence[str]) -> Controller:
        """The controller of ros2_control for one of ros_control, which names these joints.

        Raises:
            _UnsaidError: There is none.
        """
        kind = str(value.plain["type"])
        package, _, of_class = kind.partition("/")
        if of_class in {"JointStateController", "JointStateBroadcaster"}:
            return Controller(BROADCASTER, "", "")
        lost = ", ".join(one for one in named if one not in self.joints)
        there, command, settings = kind, self.interface, dict[str, Any]()
        if not _NAME.fullmatch(name):
            raise _UnsaidError(f"The name of the controller `{name}` is not one of ROS 2.")
        if lost or not named:
            what = (
                f"commands {lost}, which cannot be moved here" if lost else "does not name a joint"
            )
            raise _UnsaidError(f"The controller `{name}` {what}.")
        if kind == _DRIVE:
            command, settings = "velocity", self._of_drive(name, value)
        elif kind in _GRIPPERS:
            command, settings = _GRIPPERS[kind], {"joint": named[0]}
            settings |= _numbers(value, _OF_GRIPPERS)
        elif of_class == _TRAJECTORY:
            there, settings = CONTROLLERS["position"].type, _of_trajectory(value, named, command)
        elif of_class in _GROUPS and package.removesuffix("s").endswith("_controller"):
            (there, command), settings = _GROUPS[of_class], {"joints": [*named]}
        else:
            raise _UnsaidError(f"ros2_control does not have a controller like `{name}`, a {kind}.")
        return Controller(name, there, command, tuple(named), settings)

    def _of_drive(self, name: str, value: Value) -> dict[str, Any]:
        left, right = _texts(value, "left_wheel"), _texts(value, "right_wheel")
        if not left or not right:
            raise _UnsaidError(f"The controller `{name}` does not name wheels on both sides.")
        settings: dict[str, Any] = {"left_wheel_names": left, "right_wheel_names": right}
        sizes = ("wheel_separation", "wheel_radius")
        if any(value.get(size) is None for size in sizes):  # ros_control measures them, too
            try:
                drive = measure_drive(self.robot, left, right)
            except RequestError as error:
                raise _UnsaidError(
                    f"The wheels of `{name}` cannot be measured: {error.message}"
                ) from None
            settings |= dict(zip(sizes, (drive.separation, drive.radius), strict=True))
        settings |= _numbers(value, _OF_DRIVES)
        texts = ((key, value.get(key)) for key in ("base_frame_id", "odom_frame_id"))
        settings |= {key: one.text for key, one in texts if one is not None and one.text}
        for direction, axis in (("linear", "x"), ("angular", "z")):
            limits = value.get(direction, axis) or Value({}, value.line)
            has = ((kind, limits.get(f"has_{kind}_limits")) for kind in _OF_AXES)
            kinds = [kind for kind, one in has if one is not None and one.content is True]
            found = _numbers(limits, [f"{end}_{kind}" for kind in kinds for end in ("min", "max")])
            if found:
                settings[direction] = {axis: found}
        return settings

    def result(self) -> FoundControllers:
        """The controllers; those that spawners start first, as far as they share no joint."""
        claimed, chosen = set[str](), list[Controller]()
        are_named = bool(self.found.keys() & self.starts)
        for one in sorted(self.found.values(), key=lambda one: one.name not in self.starts):
            is_wanted = one.name in self.starts or not are_named
            is_started = is_wanted and claimed.isdisjoint(one.joints)
            claimed |= {*one.joints} if is_started else set()
            chosen.append(one._replace(is_started=is_started))
        for (file, line), name in [*self.gains.items()][:1]:
            more = f" and of {len(self.gains) - 1} more controllers" if len(self.gains) > 1 else ""
            what = f"The gains of `{name}`{more} are not used: Gazebo moves the joints without."
            advice = "Nothing is to be done, unless the joints are to give way."
            self.notes.append(Unported(file, line, what, advice))
        return FoundControllers(tuple(chosen), self.names, tuple(self.files), tuple(self.notes))


def _spawned_by(file: Path) -> Iterator[str]:
    """The controllers that the spawners of a launch file start."""
    text = read_text(file) or ""
    root = parse_xml(text) if MANAGER in text else None
    if root is None or isinstance(root, Malformed):
        return
    for node in root.iter("node"):
        if node.get("pkg") == MANAGER and node.get("type") in _SPAWNERS:
            words = node.get("args", "").split()
            yield from () if "--stopped" in words else spawned(words)


def _controllers_in(value: Value, depth: int = 0) -> Iterator[tuple[str, Value]]:
    """The sections of a file that are of a controller, by their names."""
    for name, one in value.items():
        kind = one.get("type")
        if kind is not None and kind.text is not None and _TYPE.fullmatch(kind.text):
            yield name, one
        elif depth < _DEEPEST:
            yield from _controllers_in(one, depth + 1)


def _has_nothing_else(value: Value, depth: int = 0) -> bool:
    """Whether all that a file has is in sections of controllers."""
    return all(
        one.get("type") is not None
        or (
            depth < _DEEPEST and isinstance(one.content, dict) and _has_nothing_else(one, depth + 1)
        )
        for _, one in value.items()
    )


class _UnsaidError(Exception):
    """A controller has no counterpart; the message is a sentence."""


def _texts(value: Value, *keys: str) -> list[str]:
    """The texts that stand below keys, alone or in a list."""
    found = (value.get(key) for key in keys)
    values = [one for named in found if named is not None for one in (named, *named.elements())]
    return list(dict.fromkeys(one.text for one in values if one.text is not None))


def _numbers(value: Value, keys: Iterable[str]) -> dict[str, Any]:
    """Parameters that are there; numbers as real ones, which ROS 2 does not make of others.

    Raises:
        _UnsaidError: One is not a number, a truth or a list of numbers.
    """
    found = dict[str, Any]()
    for key in keys:
        one = value.get(key)
        if one is None:
            continue
        plain = one.plain
        numbers = plain if isinstance(plain, list) else [plain]
        if not all(isinstance(number, (int, float)) for number in numbers):
            raise _UnsaidError(f"`{key}` in line {one.line} is not a number.")
        real = [number if isinstance(number, bool) else float(number) for number in numbers]
        found[key] = real if isinstance(plain, list) else real[0]
    return found


def _of_trajectory(value: Value, joints: Sequence[str], interface: str) -> dict[str, Any]:
    settings: dict[str, Any] = {
        "joints": [*joints],
        "command_interfaces": [interface],
        "state_interfaces": ["position", "velocity"],
    }
    limits = value.get("constraints")
    if limits is not None:
        found = _numbers(limits, ("goal_time", "stopped_velocity_tolerance"))
        found |= {
            joint: _numbers(one, ("trajectory", "goal"))
            for joint in joints
            if (one := limits.get(joint)) is not None
        }
        settings["constraints"] = {key: one for key, one in found.items() if one != {}}
    gains = value.get("gains")
    if gains is not None and interface != "position":
        settings["gains"] = {
            joint: _numbers(one, ("p", "i", "d", "i_clamp"))
            for joint in joints
            if (one := gains.get(joint)) is not None
        }
    return {key: one for key, one in settings.items() if one != {}}
