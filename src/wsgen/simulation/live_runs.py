"""The live runs of this machine: find one, what it simulates, what it leaves for a video.

A line of JSON a frame, written as the simulated time passes: what is there when the simulator is
killed can be drawn. Drawing comes afterwards, because the end of a launch does not wait for it.
"""

from __future__ import annotations

import json
import os
import socket
import tempfile
import time
from collections.abc import Iterator, Mapping  # noqa: TC003  scenes are decoded by type hints
from contextlib import contextmanager, suppress
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from wsgen.isolation.codec import decode, encode
from wsgen.isolation.parent import PREFIX, is_held
from wsgen.model.devices import Devices  # noqa: TC001
from wsgen.model.transform import IDENTITY, Pose
from wsgen.simulation.scene import Scene, SpawnedRobot
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.transform import Vector

    Poses = dict[str, Mapping[str, Pose]]


DOMAIN = "ROS_DOMAIN_ID"
# In the live folder: what is launched, as `wsgen.live.request` has it, in JSON.
REQUEST_FILE = "service.json"
# Likewise, from the beginning on: a JSON object with the `domain` of ROS, and what is `launched`.
STARTING_FILE = "starting.json"
# There as soon as the launch is shut down; then has the name of the video that is drawn of it.
ENDED_FILE = "ended"


def find_simulator(variables: Mapping[str, str]) -> Path | None:
    """The live run whose simulator a process with these variables has; None where none is there.

    It is that of its launch, if that starts one. Otherwise it is the latest in the same domain of
    ROS, which may be started after the process.
    """
    own = variables.get(FOLDER_VARIABLE)
    if own:
        request = _request_of(Path(own))
        if request is None or request["awaits_simulator"] or _is_alive(Path(own)):
            return Path(own)
    return find_live_folder(variables)


def find_live_folder(variables: Mapping[str, str]) -> Path | None:
    """The folder of a live run in the same domain of ROS; the latest, of several."""
    domain = variables.get(DOMAIN) or "0"
    found = []
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*/live"):
        variables_of_run = _variables_of(folder)
        if (
            variables_of_run is not None
            and (variables_of_run.get(DOMAIN) or "0") == domain
            and _is_alive(folder)
        ):
            with suppress(OSError):  # it has just ended
                found.append(((folder / REQUEST_FILE).stat().st_mtime, folder))
    return max(found)[1] if found else None


def find_runs() -> list[tuple[str, str, str, float, str]]:
    """The live runs of this user: the domain of ROS of each, what was launched, what is drawn.

    Of a run that goes on what is drawn is empty. One that has ended is there only while its video
    is drawn; then that is its name. Next is when its nodes were started, now for one that is still
    prepared: seconds since 1970. The last is the file that is in its folder when it has ended.
    """
    found = []
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*/live"):
        run = _run_in(folder)
        if run is not None and is_held(str(folder.parent)):
            drawn = _drawn_after_end(folder)
            if drawn == "":
                continue
            domain, launched, file = run
            with suppress(OSError):  # it has just ended
                begun = time.time() if file.name == STARTING_FILE else file.stat().st_mtime
                found.append((domain, launched, drawn or "", begun, str(folder / ENDED_FILE)))
    return sorted(found)


def _run_in(live_folder: Path) -> tuple[str, str, Path] | None:
    """The domain of ROS of a live run, what was launched, and the file that says it."""
    request = _request_of(live_folder)
    if request is not None:
        variables = {**request["environment"], **request["variables"]}
        return variables.get(DOMAIN) or "0", _launched(request), live_folder / REQUEST_FILE
    file = live_folder / STARTING_FILE
    try:
        if live_folder.lstat().st_uid != os.getuid():  # everybody may make a folder there
            return None
        starting = json.loads(file.read_text(encoding="utf-8"))
        return str(starting["domain"]), str(starting["launched"]), file
    except (OSError, ValueError, KeyError, TypeError):  # as `_request_of`
        return None


def _drawn_after_end(live_folder: Path) -> str | None:
    """The name of the video that is drawn of a run that has ended, if any; None: it goes on."""
    try:
        return (live_folder / ENDED_FILE).read_text(encoding="utf-8")
    except OSError:
        return None


def launched_in(live_folder: Path) -> str | None:
    """What a live run has launched, "PACKAGE FILE"; None where it has just ended."""
    request = _request_of(live_folder)
    return None if request is None else _launched(request)


def _launched(request: Mapping[str, Any]) -> str:
    file = Path(str(request["launch"].get("launch_file", "")))
    package = request["launch"].get("package")
    return f"{package} {file.name}" if package else str(file)


def distro_of_run(live_folder: Path) -> str | None:
    """ROS_DISTRO of the nodes of a live run; None where it has just ended."""
    return (_variables_of(live_folder) or {}).get("ROS_DISTRO")


def _variables_of(live_folder: Path) -> dict[str, str] | None:
    """The environment of the nodes of a live run; None where that is no run of this user."""
    request = _request_of(live_folder)
    return None if request is None else {**request["environment"], **request["variables"]}


def _request_of(live_folder: Path) -> dict[str, Any] | None:
    """What the service of a live run was given; None where that is no run of this user."""
    try:
        if live_folder.lstat().st_uid != os.getuid():  # everybody may make a folder there
            return None
        request = json.loads((live_folder / REQUEST_FILE).read_text(encoding="utf-8"))
        parts = {part: dict(request[part]) for part in ("environment", "variables")}
        awaits = bool(request.get("awaits_simulator"))
        return {**parts, "launch": dict(request.get("launch", {})), "awaits_simulator": awaits}
    except (OSError, ValueError, KeyError, TypeError):  # it has just ended, or is of another wsgen
        return None


def _is_alive(folder: Path) -> bool:
    try:
        with socket.socket(socket.AF_UNIX) as client, short_name(socket_path(folder)) as name:
            client.connect(name)
    except OSError:
        return False
    return True


FOLDER_VARIABLE = "WSGEN_LIVE_FOLDER"  # names the folder of a live run, in all its processes
SCENE_FILE = "scene.json"  # in that folder: a `LiveScene`, as `isolation.codec` writes it
# In that folder, where no message of ROS has come to the simulator until its end: a JSON
# object of the topics that it has read and no other node publishes, and the types of their
# messages.
UNHEARD_FILE = "unheard.json"
SOCKET = "simulator.sock"  # in that folder, where the simulator takes commands
PREPARER = "preparer.sock"  # likewise, where descriptions become what it can simulate


@dataclass(frozen=True, kw_only=True)
class LiveScene:
    """A world and all robots that may be spawned into it.

    Of `scene`, what has to do with the end of a simulation means nothing here. Static models are in
    the world from the beginning; robots come when somebody spawns them by their entity.
    """

    scene: Scene
    simulator: str  # "classic" or "gz": whose plugins and topics these are
    world: str = "default"  # its name
    devices: Mapping[str, Devices] = field(default_factory=dict)  # by entity
    world_devices: Devices | None = None  # plugins of the world
    # The classes of the systems of Gazebo Sim that the world has without its robots; None: all.
    systems: tuple[str, ...] | None = None
    in_world: tuple[str, ...] = ()  # entities that are there from the beginning
    descriptions: Mapping[str, str] = field(default_factory=dict)  # by entity: its URDF, if it has
    is_paused: bool = False  # at the beginning
    rate: float | None = 1.0  # simulated seconds a second; None: as many as possible
    is_recorded: bool = False  # a recorder subscribes to all topics, as soon as it has found them
    logs_poses: bool = False  # a pose log is left in the folder, see `wsgen.simulation.live_runs`
    is_stepped: bool = False  # time passes only while somebody has it pass, by the socket
    seconds: float | None = None  # simulated, until the simulator ends; None: on command


@dataclass(frozen=True, kw_only=True)
class NewEntity:
    """What a process spawns that the launch file does not name."""

    entity: str = ""  # its name in the simulator; empty: that of its description
    text: str = ""  # URDF or SDF; empty: the model of `model_uri`
    file: Path | None = None  # that the text was read from
    model_uri: str | None = None  # the address of a model that Gazebo looks up
    pose_in_world: Pose = IDENTITY


@dataclass(frozen=True, kw_only=True)
class PreparedEntity:
    """A new entity, ready for an engine; without a robot, `problem` and `hint` say why."""

    robot: SpawnedRobot | None = None
    devices: Devices | None = None
    description: str | None = None  # its URDF, if it has one
    problem: str = ""
    hint: str = ""


def socket_path(folder: Path) -> Path:
    """Where the simulator of a live run takes commands."""
    return Path(folder) / SOCKET


def preparer_path(folder: Path) -> Path:
    """Where a live run has new entities prepared."""
    return Path(folder) / PREPARER


@contextmanager
def short_name(path: Path) -> Iterator[str]:
    """A name of a socket that the system takes: one of 107 bytes at most."""
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)


POSE_LOG_FILE = "poses.jsonl"  # in the folder of a live run
NO_ROBOT = "the run ended before a robot was spawned"  # why it has no poses
RATE = 10.0  # frames a simulated second
DIGITS = 5  # of m and rad


@dataclass(frozen=True)
class PoseLog:
    """The frames of a live run.

    `corners` are points (m, in the world) of boxes around what can touch, by entity, where it was
    when it was first seen. `robots` are all that were seen. A name that two different robots had
    one after the other is that of the first one here; the second one has another.
    """

    frames: list[Poses]
    corners: dict[str, list[Vector]]
    robots: tuple[SpawnedRobot, ...]


class PoseLogWriter:
    """Writes frames; what has not moved since the last frame is not written again."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._last: dict[str, dict[str, list[float]]] = {}

    def add(
        self,
        poses: Mapping[str, Mapping[str, Pose]],
        corners: Mapping[str, Sequence[Vector]],
        robots: Sequence[SpawnedRobot],
    ) -> None:
        """Write a frame; `corners` and `robots` are of what is seen for the first time."""
        now = {
            entity: {
                link: [round(number, DIGITS) for number in (*pose.xyz, *pose.rpy)]
                for link, pose in links.items()
            }
            for entity, links in poses.items()
        }
        line: dict[str, Any] = {
            "moved": {
                entity: links for entity, links in now.items() if links != self._last.get(entity)
            }
        }
        if gone := [entity for entity in self._last if entity not in now]:
            line["gone"] = gone
        if corners:
            line["corners"] = {entity: list(points) for entity, points in corners.items()}
        if robots:
            line["robots"] = json.loads(encode(robots))
        self._last = now
        self._stream.write(json.dumps(line, separators=(",", ":")) + "\n")
        self._stream.flush()


def read_pose_log(file: Path) -> PoseLog:
    """The frames of a pose log; half a line at its end is none.

    Raises:
        OSError: The file cannot be read.
    """
    frames: list[Poses] = []
    corners: dict[str, list[Vector]] = {}
    robots: list[SpawnedRobot] = []
    for line in _lines(file):
        poses = dict(frames[-1]) if frames else {}
        for entity, links in line["moved"].items():
            poses[entity] = {
                link: Pose(xyz=(x, y, z), rpy=(roll, pitch, yaw))
                for link, (x, y, z, roll, pitch, yaw) in links.items()
            }
        for entity in line.get("gone", ()):
            poses.pop(entity, None)
        for entity, points in line.get("corners", {}).items():
            corners[entity] = [(x, y, z) for x, y, z in points]
        robots += [decode(one, SpawnedRobot) for one in line.get("robots", ())]
        frames.append(poses)
    return PoseLog(frames, corners, tuple(robots))


def _lines(file: Path) -> Iterator[dict[str, Any]]:
    with file.open(encoding="utf-8") as stream:
        for line in stream:
            if line.endswith("\n"):
                yield json.loads(line)


LOOK_EVERY = 0.05  # s, for the socket


class SimulatorError(Exception):
    """The simulator refuses a command; `hint` is what to do."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


class SimulatorEndedError(SimulatorError):
    """It does not answer any more."""

    def __init__(self) -> None:
        super().__init__("The simulator has ended.", "Read what it printed before.")


class SimulatorClient:
    """A connection to the simulator."""

    def __init__(self, folder: Path | None = None, *, patience: float | None = None) -> None:
        """Connect to that of a live run, later.

        Args:
            folder: Of the run; None: of that which this process then has, see `find_simulator`.
            patience: How long to wait for an answer, s; afterwards it has ended.
        """
        self._folder = folder
        self._patience = patience
        self._socket: socket.socket | None = None
        self._stream: Any = None

    def connect(self, seconds: float) -> bool:
        """Wait for the simulator, no longer than that; gives whether it is there."""
        last = time.monotonic() + seconds
        while self._socket is None:
            made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            made.settimeout(self._patience)
            try:
                with short_name(socket_path(self._found_folder())) as name:
                    made.connect(name)
            except (FileNotFoundError, ConnectionRefusedError):
                made.close()
                if time.monotonic() >= last:
                    return False
                time.sleep(LOOK_EVERY)
            else:
                self._socket, self._stream = made, made.makefile("rwb")
        return True

    def _found_folder(self) -> Path:
        """Raise FileNotFoundError where no live run is there."""
        if self._folder is not None:
            return self._folder
        found = find_simulator(os.environ)
        if found is None:
            raise FileNotFoundError
        return found

    def ask(self, do: str, **values: Any) -> dict[str, Any]:
        """Have the simulator do something; gives its answer.

        Raises:
            SimulatorError: It cannot do it.
            SimulatorEndedError: It has ended.
        """
        try:
            self._stream.write(json.dumps({"do": do, **values}).encode() + b"\n")
            self._stream.flush()
            line = self._stream.readline()
        except OSError:
            line = b""
        if not line:
            raise SimulatorEndedError
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise SimulatorError(str(answer["error"]), str(answer.get("hint", "")))
        return answer

    def wait_until_it_ends(self) -> None:
        """Wait as long as the simulator is there."""
        try:
            while self._stream.readline():
                pass
        except OSError:
            pass

    def interrupt(self) -> None:
        """End the connection for a thread that waits for an answer."""
        if (waited_for := self._socket) is not None:
            with suppress(OSError):
                waited_for.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End the connection, and what goes with it."""
        if self._socket is not None:
            with suppress(OSError):  # what is not sent yet
                self._stream.close()
            self._socket.close()
            self._socket = None
