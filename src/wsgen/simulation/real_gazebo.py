"""The user's own Gazebo: which one is installed, how it is started and asked, what it answers.

Both simulators are asked by their command line tools, as a person would ask them: they speak
protocols that change with each version. Gazebo Classic was tried in version 11.1; Gazebo Sim is
written to its documentation (tutorials/model_command.md and entity_creation.md of gz-sim), untried.

SI units.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Mapping  # noqa: TC003  the type hints of answers are read
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from wsgen.isolation.child import announce
from wsgen.model.target import CLASSIC, SIM
from wsgen.model.transform import (
    IDENTITY,
    Pose,
    compose,
    quaternion_of_rpy,
    rotation_of_quaternion,
    rpy_of_rotation,
)
from wsgen.simulation.scene import LOADING
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.model.transform import Vector


SECONDS_TO_SAY = 60.0  # wall-clock, for a version
_VERSION = re.compile(r"(\d+\.\d+\.\d+)")


@dataclass(frozen=True, kw_only=True)
class Installed:
    """A Gazebo on the PATH."""

    kind: str  # "classic" or "gz"
    server: tuple[str, ...]  # the command of the server, without options
    tool: str  # the program that asks the server
    version: str  # "11.1.0"; empty where it does not say

    @property
    def name(self) -> str:
        """Its name for people."""
        name = "Gazebo Classic" if self.kind == CLASSIC else "Gazebo Sim"
        return f"{name} {self.version}".rstrip()


@dataclass(frozen=True, kw_only=True)
class ToSpawn:
    """A robot to be spawned, or a model that the world already has."""

    entity: str
    file: Path | None = None  # URDF or SDF, not lumped; None: it is in the world
    pose: Pose = IDENTITY  # in the world


@dataclass(frozen=True, kw_only=True)
class GazeboScene:
    """What a Gazebo is to simulate."""

    installed: Installed
    environment: Mapping[str, str]
    world: str  # a file, or the name of a world that Gazebo brings along
    robots: tuple[ToSpawn, ...]
    seconds: float  # simulated
    step: float  # s, of its physics
    window: float  # s: how it moves is seen over the last ones


@dataclass(frozen=True, kw_only=True)
class ModelState:
    """A model in the server."""

    pose: Pose  # in the world
    links: Mapping[str, Pose]  # likewise, by name
    mass: float  # kg
    movable_joints: int
    joint_positions: Mapping[str, float]  # rad or m; those that the server says


@dataclass(frozen=True, kw_only=True)
class GazeboRun:
    """How a model was before the last moments, and at the end."""

    before: ModelState
    end: ModelState


@dataclass(frozen=True, kw_only=True)
class GazeboResult:
    """What a Gazebo did."""

    runs: Mapping[str, GazeboRun]  # by entity
    refused: Mapping[str, str]  # likewise: what it printed about it
    printed: tuple[str, ...] = ()  # its warnings and errors
    problem: str | None = None  # what ended it early, without a subject: "crashed (SIGSEGV)"


def find_gazebo(environment: Mapping[str, str], kind: str | None = None) -> Installed | None:
    """The Gazebo on the PATH of an environment: that of a kind, else Classic before Sim."""
    found = (_classic(environment) if one == CLASSIC else _sim(environment) for one in _kinds(kind))
    return next(filter(None, found), None)


def _kinds(kind: str | None) -> Iterable[str]:
    return (CLASSIC, SIM) if kind is None else (kind,)


def _classic(environment: Mapping[str, str]) -> Installed | None:
    path = environment.get("PATH")
    server, tool = shutil.which("gzserver", path=path), shutil.which("gz", path=path)
    if server is None or tool is None:
        return None
    # Beside a Gazebo Sim, `gz` may be that one's: Classic's lies beside its server.
    beside = Path(server).with_name("gz")
    version = _VERSION.search(_say([server, "--version"], environment))
    return Installed(
        kind=CLASSIC,
        server=(server,),
        tool=str(beside) if beside.exists() else tool,
        version=version[1] if version else "",
    )


def _sim(environment: Mapping[str, str]) -> Installed | None:
    """`gz sim`, or `ign gazebo` of Fortress; Classic's `gz` knows neither."""
    for name, word in (("gz", "sim"), ("ign", "gazebo")):
        tool = shutil.which(name, path=environment.get("PATH"))
        if tool is None:
            continue
        said = _say([tool, word, "--versions"], environment).split()
        if said and _VERSION.fullmatch(said[0]):
            return Installed(kind=SIM, server=(tool, word), tool=tool, version=said[0])
    return None


def _say(command: list[str], environment: Mapping[str, str]) -> str:
    """What a command prints; empty where it does not run."""
    try:
        run = subprocess.run(
            command,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=SECONDS_TO_SAY,
            check=False,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return os.fsdecode(run.stdout)


# Wall-clock, generous: a world may download models, and a machine may be busy.
SECONDS_TO_START = 600.0
SECONDS_TO_SPAWN = 20.0
TIMES_TO_SPAWN = 4
SECONDS_AFTER_ERROR = 10.0
SECONDS_WITHOUT_STEP = 120.0
SECONDS_TO_ANSWER = 60.0
PAUSE = 0.2  # s, between two questions
MOST_READ = 2**16  # bytes of what the server prints of one robot
LAST_LINES = 20
LINE = 300  # characters
_COLORS = re.compile(r"\x1b\[[0-9;]*m")
# What Gazebo prints of a machine without a display or sound, and of no network for models.
_OF_THE_MACHINE = re.compile(
    r"RenderEngine|OpenAL|ALSA|AL lib|Audio will be|preferred IP|ModelDatabase|libEGL|Ogre|ogre"
)
# Classic then keeps a part of the model, in which it may crash.
_HALF_LOADED = "Loading model from factory message failed"
_REFUSALS = re.compile(r"[Ee]rror|terminate called|what\(\)")
_ALARMS = re.compile(r"\[Err\]|\[Error\]|\[error\]|^Error\b|\[Wrn\].*(?:does not exist|ailed)")


class EndedError(Exception):
    """The server has ended, or does not answer; the text says how, without a subject."""


class _Server(Protocol):
    """A server that runs, paused."""

    def is_ready(self) -> bool:
        """Whether it has loaded its world."""

    def spawn(self, robot: ToSpawn) -> str:
        """Have it spawn a robot; what was printed of it."""

    def state(self, entity: str) -> ModelState | None:
        """A model; None while it has none of that name."""

    def step(self, count: int) -> None:
        """Begin so many steps of physics."""

    def iterations(self) -> int:
        """The steps of physics that it has done."""


def simulate(scene: GazeboScene) -> GazeboResult:
    """Have a Gazebo simulate a scene."""
    with tempfile.TemporaryFile() as log:
        runs: dict[str, GazeboRun] = {}
        refused: dict[str, str] = {}
        problem = None
        server = (_Classic if scene.installed.kind == CLASSIC else _Sim)(scene)
        process = subprocess.Popen(
            server.command,
            env=server.environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # `gz` starts the server as a child of its own
        )
        try:
            _simulate(server, process, scene, log.fileno(), runs=runs, refused=refused)
        except EndedError as error:
            problem = str(error)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        log.seek(0)
        printed = tuple(_lines(os.fsdecode(log.read())))
    if problem is None:
        printed = tuple(line for line in printed if _ALARMS.search(line))
    return GazeboResult(runs=runs, refused=refused, printed=printed[-LAST_LINES:], problem=problem)


def _simulate(  # noqa: PLR0913  the server, and what is filled in
    server: _Server,
    process: subprocess.Popen[bytes],
    scene: GazeboScene,
    log: int,
    *,
    runs: dict[str, GazeboRun],
    refused: dict[str, str],
) -> None:
    """Fill in what becomes of the robots; the server prints into the file `log`.

    Raises:
        EndedError: The server does not answer, or has ended.
    """
    announce("loading the world")
    if not _wait(server.is_ready, process, SECONDS_TO_START):
        raise EndedError(f"has not loaded the world after {SECONDS_TO_START:.0f} s")
    for robot in scene.robots:
        announce(LOADING.format(entity=robot.entity))
        printed = os.fstat(log).st_size
        said, is_spawned = _spawn(server, process, robot)
        lines = os.fsdecode(os.pread(log, MOST_READ, printed))
        if not is_spawned:
            refused[robot.entity] = said
        elif _HALF_LOADED in lines:
            alarms = [line for line in _lines(lines) if _ALARMS.search(line)]
            refused[robot.entity] = "; ".join(alarms)
    announce("simulating")
    there = [robot.entity for robot in scene.robots if robot.entity not in refused]
    if not there:
        return
    window = max(1, round(scene.window / scene.step))
    count = max(1, round(scene.seconds / scene.step) - window)
    _advance(server, process, count, count)
    before = {entity: _look(server, process, entity) for entity in there}
    _advance(server, process, window, count + window)
    for entity in there:
        first, end = before[entity], _look(server, process, entity)
        if first is None or end is None:
            refused[entity] = "the model disappeared while it was simulated"
        elif not end.links:
            refused[entity] = "it has no link there"
        else:
            runs[entity] = GazeboRun(before=first, end=end)


def _look(server: _Server, process: subprocess.Popen[bytes], entity: str) -> ModelState | None:
    """A model that was there before; asked again, as a tool of Classic may crash."""
    found: list[ModelState] = []

    def is_seen() -> bool:
        found.extend(filter(None, [server.state(entity)]))
        return bool(found)

    _wait(is_seen, process, SECONDS_AFTER_ERROR)
    return found[0] if found else None


def _spawn(server: _Server, process: subprocess.Popen[bytes], robot: ToSpawn) -> tuple[str, bool]:
    """What was printed of a robot that is to be spawned, and whether it is there.

    A tool of Classic may crash, or its message be lost while the server is busy: it is sent again.
    """
    for _ in range(TIMES_TO_SPAWN if robot.file is not None else 1):
        said = server.spawn(robot) if robot.file is not None else ""
        seconds = SECONDS_AFTER_ERROR if said else SECONDS_TO_SPAWN
        is_there = _wait(lambda: server.state(robot.entity) is not None, process, seconds)
        if said or is_there:
            break
    return said, is_there


def _advance(server: _Server, process: subprocess.Popen[bytes], count: int, target: int) -> None:
    """Simulate so many steps, up to a number of them, however long it takes while it goes on."""
    last = target - count
    server.step(count)
    since = asked = time.monotonic()
    while last < target:
        _check(process)
        now = server.iterations()
        if now > last:
            last, since = now, time.monotonic()
        elif last == target - count and time.monotonic() - asked > SECONDS_TO_SPAWN:
            server.step(count)  # it may have been lost
            asked = time.monotonic()
        elif time.monotonic() - since > SECONDS_WITHOUT_STEP:
            raise EndedError(f"has not simulated a step for {SECONDS_WITHOUT_STEP:.0f} s")
        time.sleep(PAUSE)


def _wait(is_done: Any, process: subprocess.Popen[bytes], seconds: float) -> bool:
    """Ask until something is true; whether that came in time."""
    end = time.monotonic() + seconds
    while not is_done():
        _check(process)
        if time.monotonic() > end:
            return False
        time.sleep(PAUSE)
    return True


def _check(process: subprocess.Popen[bytes]) -> None:
    code = process.poll()
    if code is not None:
        how = f"exit code {code}" if code >= 0 else signal.Signals(-code).name
        raise EndedError(f"ended ({how})")


def _ask(command: Sequence[str], environment: Mapping[str, str]) -> str:
    """What a command line tool prints, its errors included; empty where it does not end."""
    try:
        run = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=SECONDS_TO_ANSWER,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return ""
    return os.fsdecode(run.stdout)


def _lines(text: str) -> Iterator[str]:
    """The lines that are about what is simulated, each once."""
    lines = (line.strip() for line in _COLORS.sub("", text).splitlines())
    return (
        line[:LINE] for line in dict.fromkeys(lines) if line and not _OF_THE_MACHINE.search(line)
    )


class _Classic:
    """`gzserver`, asked by Classic's `gz`."""

    def __init__(self, scene: GazeboScene) -> None:
        installed = scene.installed
        self._tool = installed.tool
        self.command = [*installed.server, "--verbose", "-u", scene.world]
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.environment = {
            **scene.environment,
            "GAZEBO_MASTER_URI": f"http://127.0.0.1:{port}",
            "GAZEBO_IP": "127.0.0.1",
        }
        if self.environment.get("GAZEBO_MODEL_PATH"):
            # As its setup.sh: with the variable set, it forgets where its own models are.
            own = Path(installed.server[0]).parents[1].glob("share/gazebo-*/models")
            path = [self.environment["GAZEBO_MODEL_PATH"], *map(str, own)]
            self.environment["GAZEBO_MODEL_PATH"] = os.pathsep.join(path)
        self._world = ""

    def is_ready(self) -> bool:
        found = re.search(r"(?m)^/gazebo/(.+)/world_stats$", self._gz("topic", "-l"))
        self._world = found[1] if found else ""
        return found is not None

    def spawn(self, robot: ToSpawn) -> str:
        (x, y, z), (roll, pitch, yaw) = robot.pose.xyz, robot.pose.rpy
        said = self._gz(
            *("model", f"--spawn-file={robot.file}", f"--model-name={robot.entity}"),
            *(f"--pose-x={x!r}", f"--pose-y={y!r}", f"--pose-z={z!r}"),
            *(f"--pose-R={roll!r}", f"--pose-P={pitch!r}", f"--pose-Y={yaw!r}"),
        )
        return "\n".join(line for line in _lines(said) if _REFUSALS.search(line))

    def state(self, entity: str) -> ModelState | None:
        message = read_message(self._gz("model", "-m", entity, "-i"))
        pose = first(message, "pose")
        if pose is None:
            return None
        at, names = _pose(pose), len(entity) + len("::")
        links = _all(message, "link")
        joints = [one for one in _all(message, "joint") if first(one, "type") != "FIXED"]
        return ModelState(
            pose=at,
            links={
                str(first(link, "name"))[names:]: compose(at, _pose(first(link, "pose")))
                for link in links
            },
            mass=sum(_number(first(first(link, "inertial"), "mass")) for link in links),
            movable_joints=len(joints),
            joint_positions={
                str(first(joint, "name"))[names:]: _number(first(joint, "angle"))
                for joint in joints
                if first(joint, "angle") is not None
            },
        )

    def step(self, count: int) -> None:
        self._gz("world", "-m", str(count))

    def iterations(self) -> int:
        topic = f"/gazebo/{self._world}/world_stats"
        found = re.findall(r"iterations: (\d+)", self._gz("topic", "-e", topic, "-d", "1", "-u"))
        return int(found[-1]) if found else -1

    def _gz(self, *words: str) -> str:
        return _ask([self._tool, *words], self.environment)


class _Sim:
    """`gz sim`, or `ign gazebo`, asked by the tool of that name: untried."""

    def __init__(self, scene: GazeboScene) -> None:
        installed = scene.installed
        self._tool = installed.tool
        is_old = Path(installed.tool).name == "ign"
        self._messages = "ignition.msgs" if is_old else "gz.msgs"
        headless = [] if scene.environment.get("DISPLAY") else ["--headless-rendering"]
        self.command = [*installed.server, "-s", "-v", "2", *headless, scene.world]
        partition = f"wsgen-{os.getpid()}"
        self.environment = {
            **scene.environment,
            **{f"{prefix}_PARTITION": partition for prefix in ("GZ", "IGN")},
            **{f"{prefix}_IP": "127.0.0.1" for prefix in ("GZ", "IGN")},
        }
        self._world = ""

    def is_ready(self) -> bool:
        found = re.search(r"(?m)^/world/(.+)/stats$", self._gz("topic", "-l"))
        self._world = found[1] if found else ""
        return found is not None

    def spawn(self, robot: ToSpawn) -> str:
        x, y, z, w = quaternion_of_rpy(robot.pose.rpy)
        file, name = (_quoted(str(one)) for one in (robot.file, robot.entity))
        axes = zip("xyz", robot.pose.xyz, strict=True)
        place = ", ".join(f"{axis}: {part!r}" for axis, part in axes)
        said = self._request(
            "create",
            "EntityFactory",
            f"sdf_filename: {file}, name: {name}, pose: {{position: {{{place}}}, "
            f"orientation: {{x: {x!r}, y: {y!r}, z: {z!r}, w: {w!r}}}}}",
        )
        if "data: true" in said:
            return ""
        lines = [line for line in _lines(said) if not line.startswith("data:")]
        return "\n".join(lines) or "its service does not create it"

    def state(self, entity: str) -> ModelState | None:
        return read_model(self._gz("model", "-m", entity))

    def step(self, count: int) -> None:
        self._request("control", "WorldControl", f"pause: true, multi_step: {count}")

    def iterations(self) -> int:
        topic = f"/world/{self._world}/stats"
        found = re.findall(r"iterations: (\d+)", self._gz("topic", "-e", "-n", "1", "-t", topic))
        return int(found[-1]) if found else 0

    def _request(self, service: str, kind: str, request: str) -> str:
        return self._gz(
            *("service", "-s", f"/world/{self._world}/{service}"),
            *("--reqtype", f"{self._messages}.{kind}", "--reptype", f"{self._messages}.Boolean"),
            *("--timeout", "10000", "--req", request),
        )

    def _gz(self, *words: str) -> str:
        return _ask([self._tool, *words], self.environment)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


Message = list[tuple[str, Any]]  # fields in their order: a text, or a message


def read_message(text: str) -> Message:
    """A message in the text format of protobuf, as Gazebo's tools print it."""
    top: Message = []
    open_ones = [top]
    for line in text.splitlines():
        words = line.strip()
        name, colon, value = words.partition(": ")
        if words.endswith("{"):
            inner: Message = []
            open_ones[-1].append((words[:-1].strip(), inner))
            open_ones.append(inner)
        elif words == "}" and len(open_ones) > 1:
            open_ones.pop()
        elif colon:
            open_ones[-1].append((name, value.strip('"')))
    return top


def first(message: Any, name: str) -> Any:
    """The first field of that name; None where there is none."""
    return next(iter(_all(message, name)), None)


def _all(message: Any, name: str) -> list[Any]:
    return [value for field, value in message or () if field == name]


def _number(value: Any) -> float:
    return float(value) if value is not None else 0.0


def _pose(message: Any) -> Pose:
    x, y, z = (_number(first(first(message, "position"), axis)) for axis in "xyz")
    a, b, c, d = (_number(first(first(message, "orientation"), axis)) for axis in "xyzw")
    return Pose((x, y, z), rpy_of_rotation(rotation_of_quaternion((a, b, c, d))))


_PART = re.compile(r"- (Model|Link|Joint):? \[\d+\]|^Model: \[\d+\]")
_ROW = re.compile(r"\[(.+)\]")


def read_model(text: str) -> ModelState | None:
    """What `gz model -m NAME` of Gazebo Sim prints: poses of links are seen from the model."""
    parts: list[tuple[str, dict[str, str], dict[str, list[Vector]]]] = []
    heading = ""
    for raw in text.splitlines():
        line = raw.strip()
        part = _PART.match(line)
        name, colon, value = line.removeprefix("- ").partition(":")
        if part:
            parts.append((part[1] or "Model", {}, {}))
        elif parts and line.startswith("- ") and colon:
            heading = name.partition(" [")[0]
            parts[-1][1].setdefault(heading, value.strip(" []"))
        elif parts and line.startswith("["):
            words = re.findall(r"[^\s|\[\]]+", line)
            with contextlib.suppress(ValueError):  # other things stand in brackets, too
                x, y, z = map(float, words)
                parts[-1][2].setdefault(heading, []).append((x, y, z))
    models = [one for one in parts if one[0] == "Model"]
    if not models:
        return None
    at = _pose_of(models[0][2])
    links = [one for one in parts if one[0] == "Link"]
    return ModelState(
        pose=at,
        links={values["Name"]: compose(at, _pose_of(rows)) for _, values, rows in links},
        mass=sum(float(values.get("Mass (kg)", "0")) for _, values, _ in links),
        movable_joints=sum(
            kind == "Joint" and values.get("Type") != "fixed" for kind, values, _ in parts
        ),
        joint_positions={},
    )


def _pose_of(rows: Mapping[str, Iterable[Vector]]) -> Pose:
    return Pose(*list(rows.get("Pose", ()))[:2])
