"""Have the user's own Gazebo simulate what the engines simulate, and measure the same of it.

It gets the world file and the robots as they are spawned, not as wsgen reads them.
"""

from __future__ import annotations

import math
import os
import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.launch_files import VARIABLES
from wsgen.descriptions.sdf.includes import GROUND_PLANE_SDF
from wsgen.diagnostics import Severity
from wsgen.errors import NotFoundError
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.model.kinematics import link_poses
from wsgen.model.target import CLASSIC, SIM, SIMULATORS
from wsgen.model.transform import Pose, angle_between, multiply, rotation_of_rpy, transpose
from wsgen.simulation.real_gazebo import GazeboResult, GazeboScene, ToSpawn, find_gazebo
from wsgen.simulation.run import ENGINE_DIED, ENGINE_LEFT_OUT, ENGINE_REFUSED, ENGINE_WARNING
from wsgen.simulation.scene import RobotRun
from wsgen.simulation.simulate import REST_HELD, REST_JOINT_SPEED, REST_SPEED, REST_TURNING
from wsgen.simulation.surfaces import UnreadError, lowest_points
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.world import World
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.simulation.real_gazebo import GazeboRun, Installed


TASK = "wsgen.simulation.real_gazebo:simulate"
MEMORY = 32 * 2**30  # bytes of address space: its threads reserve much that they do not use
FALLING = 1.0  # m/s, downwards
DIGITS = 1e-6  # kg, of the mass of a link that Gazebo Sim prints
NAMED = 3
HOW_TO_INSTALL = (
    "Install the Gazebo that your ROS distribution uses (ros_gz, or gazebo_ros with Gazebo "
    "Classic), source ROS in this shell, and check that `gz sim --versions` or `gzserver "
    "--version` answers."
)
# It waits for robot_state_publisher, which does not run, and Gazebo with it.
_WAITS_FOR_NODES = re.compile(r"(?s)<plugin\b[^>]*ros2_control[^>]*(?:/>|(?<!/)>.*?</plugin>)")
_MISSING_PLUGIN = lazy_pattern(
    r"(?:Failed to load (?:system )?plugin \[?|[Ll]ibrary \[?)([\w./-]+?)\]?\s*: "
)
_MESH_FOLDER = lazy_pattern(r"(?:package|model)://([\w-]+)/")


class Judged(NamedTuple):
    """What a Gazebo did, in the terms of the engines."""

    version: str
    runs: Mapping[str, RobotRun]  # by entity
    diagnostics: tuple[Diagnostic, ...]
    asked: frozenset[str] = frozenset()  # the entities that it was to simulate


class RealGazebo:
    """The user's own Gazebo, for what one launch file or one file spawns.

    Args:
        environment: That of the launch, with the search path of its simulator.
        folder: For the files that Gazebo reads; there until it has ended.
        run: Starts the child process.
        kind: The simulator that the package is for, "classic" or "gz"; None: any.
        world: The world file, or the name of one that Gazebo brings along; None: empty, with a
            ground plane.
        is_required: Whether it is an error that the Gazebo is not installed.
    """

    def __init__(  # noqa: PLR0913  where it is, and what it gets
        self,
        environment: Mapping[str, str],
        folder: Path,
        run: Run,
        *,
        kind: str | None,
        world: Path | str | None,
        is_required: bool,
    ) -> None:
        self._environment = environment
        self._folder = folder
        self._run = run
        self._kind = kind
        self._world = world
        self._is_required = is_required
        self._judged: Judged | None = None

    def simulate(
        self,
        world: World,
        robots: Sequence[PreparedRobot],
        runs: Mapping[str, RobotRun],
        seconds: float,
    ) -> Judged:
        """Simulate for some seconds, once; `runs` are those of the first engine, by entity."""
        if self._judged is None:
            self._judged = self._simulate(world, robots, runs, seconds)
        return self._judged

    def _simulate(
        self,
        world: World,
        robots: Sequence[PreparedRobot],
        runs: Mapping[str, RobotRun],
        seconds: float,
    ) -> Judged:
        installed = find_gazebo(self._environment, self._kind)
        if installed is None:
            return Judged("", {}, tuple(self._not_installed()))
        there = [
            robot for robot in robots if robot.text is not None or (robot.may_move and self._world)
        ]
        scene = GazeboScene(
            installed=installed,
            environment=dict(self._environment),
            world=self._world_for(installed),
            robots=tuple(self._to_spawn(robot, runs.get(robot.entity)) for robot in there),
            seconds=seconds,
            step=world.step,
            window=REST_HELD,
        )
        limits = Limits(seconds=300.0 + 60.0 * seconds, memory=MEMORY)
        outcome = self._run(TASK, scene, limits=limits)
        if isinstance(outcome, Died):
            result = GazeboResult(
                runs={}, refused={}, problem=outcome.reason, printed=(outcome.output[-600:],)
            )
        else:
            result = decode(outcome.value, GazeboResult)
        measured = {
            robot.entity: measure(robot, world, result.runs[robot.entity], runs, seconds)
            for robot in there
            if robot.entity in result.runs
        }
        return Judged(
            installed.version,
            measured,
            tuple(_reports(installed, result, there)),
            frozenset(robot.entity for robot in there),
        )

    def _world_for(self, installed: Installed) -> str:
        if self._world is not None:
            return str(self._world)
        file = self._folder / "default.world"
        model = GROUND_PLANE_SDF[GROUND_PLANE_SDF.index("<model") :].partition("</sdf>")[0]
        if installed.kind == SIM:  # which refuses the materials of Classic
            model = re.sub(r"(?s)<visual.*</visual>", "", model)
        text = f'<sdf version="1.6"><world name="default">{model}</world></sdf>\n'
        file.write_text(text, encoding="utf-8")
        return str(file)

    def _to_spawn(self, robot: PreparedRobot, run: RobotRun | None) -> ToSpawn:
        file = None
        if robot.text is not None:
            text = robot.text
            words = text if isinstance(text, str) else text.decode("utf-8", "replace")
            suffix = "urdf" if "<robot" in words and "<sdf" not in words else "sdf"
            file = self._folder / f"spawned-{len(list(self._folder.iterdir()))}.{suffix}"
            file.write_text(_WAITS_FOR_NODES.sub("", words), encoding="utf-8")
        pose = robot.model_pose or robot.spawn_pose
        if robot.on_the_ground and run is not None:
            x, y, z = pose.xyz  # as high as the engine spawned it
            rise = run.spawn_pose.z - robot.spawn_pose.z
            pose = replace(pose, xyz=(x, y, z + rise))
        return ToSpawn(entity=robot.entity, file=file, pose=pose)

    def _not_installed(self) -> Iterator[Diagnostic]:
        name = SIMULATORS.get(self._kind or "", "Gazebo")
        other = find_gazebo(self._environment)
        if other is None and not self._is_required:
            return  # nobody expects one
        instead = f", but {other.name} is" if other else ""
        yield ENGINE_LEFT_OUT.at(
            None,
            message=f"{name}, which the launch file starts, is not installed{instead}: its result "
            "is missing.",
            hint=HOW_TO_INSTALL,
            severity=Severity.ERROR if self._is_required else Severity.INFO,
        )


def require_gazebo(environment: Mapping[str, str]) -> None:
    """Check that there is a Gazebo, of either kind.

    Raises:
        NotFoundError: There is none on the PATH.
    """
    if find_gazebo(environment) is None:
        raise NotFoundError(
            "No Gazebo is installed: neither `gz sim`, `ign gazebo` nor `gzserver` is on the PATH.",
            hint=HOW_TO_INSTALL,
        )


def with_folders(
    environment: Mapping[str, str], kind: str | None, folders: Iterable[str]
) -> dict[str, str]:
    """The environment with more folders in which the simulator looks for `model://`."""
    found = dict(environment)
    for one in (CLASSIC, SIM) if kind is None else (kind,):
        names = VARIABLES[one][:2] if one == SIM else VARIABLES[one]
        for name in names:
            before = found.get(name, "").split(os.pathsep)
            found[name] = os.pathsep.join(dict.fromkeys(filter(None, (*before, *folders))))
    return found


def packages_of_meshes(texts: Iterable[str | bytes | None]) -> list[str]:
    """The packages that descriptions name in addresses."""
    words = (
        text.decode("utf-8", "replace") if isinstance(text, bytes) else text or "" for text in texts
    )
    return list(dict.fromkeys(name for text in words for name in _MESH_FOLDER.findall(text)))


def measure(
    robot: PreparedRobot,
    world: World,
    gazebo_run: GazeboRun,
    runs: Mapping[str, RobotRun],
    seconds: float,
) -> RobotRun:
    """What the engines measure of a robot, as far as Gazebo says it.

    It is seen twice: at the end, and shortly before. So whether it is at rest is known, but not
    since when; energy, overlaps and what happened before are those of a robot that stands.
    """
    before, end = gazebo_run.before, gazebo_run.end
    root = robot.lumped.root  # `world` is no link there
    start = robot.spawn_pose
    if robot.entity in runs:
        start = runs[robot.entity].spawn_pose
    pose = end.links.get(root, end.pose)
    earlier = before.links.get(root, before.pose)
    finite = all(one.is_finite for one in (pose, earlier, *end.links.values()))
    speed = math.dist(pose.xyz, earlier.xyz) / REST_HELD  # not-a-number compares as false
    turning = angle_between(pose, earlier) / REST_HELD
    joint_speed = max(
        (
            abs(angle_between(end.links[name], before.links[name]) / REST_HELD - turning)
            for name in end.links
            if name in before.links
        ),
        default=0.0,
    )
    at_rest = (
        finite
        and speed <= REST_SPEED
        and turning <= REST_TURNING
        and joint_speed <= REST_JOINT_SPEED
    )
    climb = (pose.xyz[2] - earlier.xyz[2]) / REST_HELD
    at_spawn = _lowest(robot, link_poses(robot.lumped, start), start)
    here = {**end.links, root: pose}
    described = robot.lumped.mass
    is_same = math.isclose(end.mass, described, rel_tol=1e-6, abs_tol=DIGITS * len(end.links))
    turned = multiply(rotation_of_rpy(pose.rpy), transpose(rotation_of_rpy(start.rpy)))
    return RobotRun(
        entity=robot.entity,
        links=len(end.links),
        movable_joints=end.movable_joints,
        mass=described if is_same else end.mass,
        spawn_pose=start,
        overlaps=(),
        lowest_point=at_spawn,
        penetration=max(0.0, -at_spawn) if world.has_ground_plane else 0.0,
        lowest_point_at_end=_lowest(robot, here, pose) if finite else pose.xyz[2],
        is_finite=finite,
        settled_after=seconds - REST_HELD if at_rest else None,
        rest_pose=pose,
        speed=speed,
        turning=turning,
        joint_speed=joint_speed,
        highest_speed=speed,
        highest_point=max(start.xyz[2], pose.xyz[2]) if finite else 0.0,
        tilt=math.acos(min(1.0, max(-1.0, turned[2][2]))) if finite else 0.0,
        energy_gain=0.0,
        joint_positions=dict(end.joint_positions),
        joint_travel={name: abs(value) for name, value in end.joint_positions.items()},
        climb=climb,
        is_falling=climb < -FALLING,
        seconds=seconds,
    )


def _lowest(robot: PreparedRobot, poses: Mapping[str, Pose], root: Pose) -> float:
    """The lowest point of what can touch, m; of the root's frame where nothing can."""
    known = {link.name for link in robot.lumped.links}
    try:
        lowest = lowest_points(robot.lumped, poses) if known <= poses.keys() else {}
    except (OSError, UnreadError):
        lowest = {}
    return min(lowest.values(), default=root.xyz[2])


def _reports(
    installed: Installed, result: GazeboResult, robots: Sequence[PreparedRobot]
) -> Iterator[Diagnostic]:
    """What Gazebo says of the robots, and of what it lacks."""
    names = [robot.entity for robot in robots]
    if result.problem is not None:
        said = "; ".join(result.printed[-NAMED:])
        yield ENGINE_DIED.at(
            None,
            element=", ".join(names),
            message=f"{installed.name} {result.problem}."
            + (f" Its last output: {said}" if said else ""),
            hint="Start the launch file with `ros2 launch`, where it does the same, and read what "
            "it prints.",
        )
    for entity, said in result.refused.items():
        printed = "; ".join(result.printed[-NAMED:]) or "it prints no reason"
        # The tool of Classic reads the description; that of Gazebo Sim leaves it to the server.
        why = printed if installed.kind == SIM else said or printed
        yield ENGINE_REFUSED.at(
            None,
            element=entity,
            message=f"{installed.name} does not spawn `{entity}`: {_one_line(why)}.",
            hint="Correct what Gazebo reports; `wsgen check` names the line in the description.",
        )
    if result.problem is not None or result.refused:
        return
    plugins = dict.fromkeys(
        found[1] for line in result.printed if (found := _MISSING_PLUGIN.search(line))
    )
    if plugins:
        yield ENGINE_WARNING.at(
            None,
            element=", ".join(names),
            message=f"{installed.name} did not find the plugins "
            f"{', '.join(f'`{name}`' for name in plugins)}: it simulated the robot without them.",
            hint="Source the ROS that has them before `wsgen validate`; robots need no plugins to "
            "stand.",
            severity=Severity.INFO,
        )
    others = [line for line in result.printed if not _MISSING_PLUGIN.search(line)]
    if others:
        yield ENGINE_WARNING.at(
            None,
            element=", ".join(names),
            message=f"{installed.name} reported: {_one_line('; '.join(others[:NAMED]))}",
            hint="Check the part that it names: it went on, perhaps without it.",
        )


def _one_line(text: str) -> str:
    return " ".join(text.split()).rstrip(".")
