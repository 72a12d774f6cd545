"""From packages for Gazebo Classic to the files that they have for Gazebo Sim; nothing is written.

Launch files are evaluated first, as `wsgen check` does: the robots that they spawn say which topics
the bridge needs. Then each file is edited where it names what Gazebo Sim has not.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from functools import cached_property, lru_cache
from os.path import normcase
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.plan import FileFix, is_whole
from wsgen.checks.fixes.source import Edit, apply, overlap, read_source
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.descriptions.urdf.devices import read_devices
from wsgen.descriptions.urdf.lumping import is_impossible, lump, parts_of_impossible_sums
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.descriptions.xacro.reader import written_elements
from wsgen.gazebo.plugins import simulator_of, stem
from wsgen.gazebo.successors import INSTEAD_OF_MESSAGES
from wsgen.gazebo.systems import EMPTY_WORLD
from wsgen.isolation.parent import make_scratch
from wsgen.launching.spawner_options import SPAWN_ENTITY, read_options
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Cylinder, Sphere
from wsgen.model.target import CLASSIC
from wsgen.model.transform import IDENTITY, compose
from wsgen.packages.workspace.layout import BUILD_MARKERS, LAUNCH_FILES
from wsgen.packages.workspace.settings import FILE as SETTINGS
from wsgen.pipeline.check_package import PackageCheck
from wsgen.pipeline.installed_as_built import lay_out
from wsgen.pipeline.parallel import start_children
from wsgen.pipeline.started import waits_for_description
from wsgen.porting.build_files import port_cmake, port_hook, port_setup
from wsgen.porting.launch_files import OF_WORLD, Context, WorldTaker, port_launch_file
from wsgen.porting.launch_markup import port_markup
from wsgen.porting.manifests import port_manifest
from wsgen.porting.models import (
    bridge_rows,
    find_followers,
    find_paints,
    managers_of,
    plugins_of,
    port_model,
    wheels_of,
)
from wsgen.porting.parameters import port_parameters
from wsgen.porting.plugins import port_effort
from wsgen.porting.ported import FilePort, Unported, joined
from wsgen.porting.porter import MODEL, NAMESPACE, WORLD, Mounted, Porter, Robots
from wsgen.porting.programs import MESSAGES, port_program
from wsgen.porting.worlds import model_names, new_world, port_world
from wsgen.text.files import list_files, real_path, remembering
from wsgen.text.suggestions import some_named

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.model.devices import Devices
    from wsgen.model.robot import Joint, Link, Robot
    from wsgen.model.target import Target
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.pipeline.check import Targets
    from wsgen.pipeline.started import Started
    from wsgen.porting.parameters import Stamper
    from wsgen.porting.ported import BridgeRow


DEFAULT_WORLD = f"worlds/{EMPTY_WORLD}"
_MARKUP = (".launch", ".launch.xml", ".launch.yaml", ".launch.yml")
_OF_WORLDS = (".sdf", ".world", ".model")
_OF_XML = (".urdf", ".xacro", ".gazebo", *_OF_WORLDS, ".xml", ".trans", ".urdf.in")
_ROBOT, _SDF, _WORLD, _LAUNCH = (
    re.compile(rf"<{name}\b") for name in ("robot", "sdf", "world", "launch")
)
_OF_MODEL = re.compile(r"<uri>\s*model://([^/<\s]+)/?\s*</uri>")
_NAME_OF_WORLD = re.compile(r"<world\b[^>]*\bname\s*=\s*[\"']([^\"']+)")
_MODEL = "model.config"  # in the folder of a model
_OF_YAML = (".yaml", ".yml")
_OF_LAUNCHES = (".py", ".xml", ".launch", *_OF_YAML)
_FILE_NAME = re.compile(r"[\w-]*\.(?:launch\.)?(?:py|xml|ya?ml|launch)\b")
_STARTS = re.compile(
    r"\b(?:gazebo_ros|ros_gz_sim|ros_ign_gazebo|gzserver|gz_args|ign_args)\b|\bspawn_entity"
    r"|(?:[\"']|:\s+)(?:gazebo|gz|ign)(?:[\"']|\s)"
)
_CLOCK = re.compile(
    r"\s*/?gazebo:\s+ros__parameters:\s+(?:(?:publish_rate|use_sim_time)\s*:[ \t]*\S+\s*)+"
)
# A variable of the shell that a launch file reads, and that is not one of the tools'.
_CHOSEN = re.compile(
    r"(?:\benviron(?:\.get\(|\[)|\bgetenv\(|\bEnvironmentVariable\(|\$\((?:opt)?env )\s*"
    r"(?:name\s*=\s*)?[\"']?(?!GAZEBO|GZ_|IGN_|HOME|ROS_|AMENT|COLCON|PYTHON|LD_|PATH|DISPLAY|USER)"
)
_ROBOT_TAG = re.compile(r"<robot\b[^>]*>")
_HAS_NAME = re.compile(r"\sname\s*=")
_XML_COMMENT = re.compile(r"(?s)<!--.*?-->")
_COMPUTED_INCLUDE = re.compile(r"<xacro:include\b[^>]*filename\s*=\s*[\"'][^\"']*\$[^\"'/]*[\"']")
_HOOKS = (".sh", ".sh.in", ".dsv", ".dsv.in")
_CODE = (".cpp", ".cc", ".cxx", ".c", ".hpp", ".hh", ".h")
_OF_SERVICES = re.compile(
    r"\bgazebo_msgs\b|\b(?:model|link)_states\b|\b[gs]et_(?:entity_state|model_|link_|light_|physics_|"
    r"joint_)|\b(?:apply|clear)_(?:link|joint|body)_|get_world_properties"
)
_OF_CLASSIC = re.compile(
    r"#include\s*[<\"](?:gazebo/|ignition/math|gazebo_ros/|gazebo_plugins/)|\bgazebo_msgs\b"
)


class PortPlan(NamedTuple):
    """What a port changes, and what it leaves to the author."""

    files: tuple[FileFix, ...]
    created: tuple[tuple[Path, str], ...]  # files with their texts
    unported: tuple[Unported, ...]  # by file and line
    packages: tuple[str, ...]


class _Port:
    """The port of one package, as far as it is made."""

    def __init__(self, package: PackageFolder) -> None:
        self.package = package
        self.ports: dict[Path, list[FilePort]] = defaultdict(list)
        self.sources: dict[Path, SourceText] = {}

    def files(self, suffixes: tuple[str, ...]) -> Iterator[SourceText]:
        for file in self._files:
            source = self.source(file) if normcase(file.name).endswith(suffixes) else None
            if source is not None:
                yield source

    @cached_property
    def _files(self) -> list[Path]:
        return list_files(self.package.path, ("",), markers=BUILD_MARKERS)

    def source(self, file: Path) -> SourceText | None:
        if file not in self.sources:
            read = read_source(file)
            if read is None:
                return None
            self.sources[file] = read
        return self.sources[file]

    def add(self, source: SourceText, port: FilePort) -> None:
        self.ports[source.file].append(port)

    def is_program(self, file: Path) -> bool:
        """Whether a file is a program that is ported."""
        return bool(joined(self.ports.get(file, ())).services)

    def all(self) -> FilePort:
        return joined(port for ports in self.ports.values() for port in ports)


def plan_port(targets: Targets, target: Target, environment: Mapping[str, str]) -> PortPlan:
    """Plan the port of packages.

    Raises:
        NotReadableError: A folder cannot be laid out.
    """
    with remembering():
        launches = _Launches(targets, environment)
        robots = launches.robots()
        of_ros_1 = [one for one in targets.packages if one.build_type == "catkin"]
        ports = [_Port(package) for package in targets.packages if package not in of_ros_1]
        followers = dict(
            one
            for port in ports
            for source in port.files(_OF_XML)
            for one in find_followers(source.text)
        )
        paints = defaultdict(list)
        for port in ports:
            for name, paint in find_paints(port.package.name, port.package.path):
                paints[name].append(paint)
        for port in ports:
            _port_models(port, target, robots._replace(followers=followers, paints=paints))
        _port_efforts(ports, target)
        systems = frozenset().union(*(port.all().systems for port in ports))
        models = {name for port in ports for name in model_names(port.package.path)}
        models |= {port.package.name for port in ports}
        any_rows = [*dict.fromkeys(row for port in ports for row in _rows_of_robots(port, target))]
        fixed = [row for row in any_rows if not any("$" in one or "{" in one for one in row)]
        stampers = [one for port in ports for one in _port_parameters(port, target)]
        stampers = [_as_renamed(one, ports) for one in stampers]
        for port in ports:
            _port_programs(port)
        services = joined(port.all() for port in ports).services
        rows = launches.rows(target, robots, services, fixed)
        clocks = [name for port in ports for name in _clocks(port)]
        known = _Known(
            rows,
            fixed,
            systems,
            stampers,
            clocks,
            are_all=len(fixed) == len(any_rows),
            frames=joined(port.all() for port in ports).frames,
            workspace=frozenset(port.package.name for port in ports),
        )
        are_called = any(map(_calls_classic, ports))
        for port in ports:
            _port_worlds(port, target, systems, models, are_called=are_called)
        _port_launch_files(ports, target, known)
        for port in ports:
            _list_code(port)
        _list_unstarted(stampers, ports)
        is_simulated = any(port.all().packages for port in ports)
        for port in ports:
            _port_build(port, target, ports, is_simulated=is_simulated)
    plan = _collect(ports, target, systems)
    parts = _unused_parts(ports)
    left = (
        *map(_left_in_ros_1, of_ros_1),
        *(one._replace(is_note=one.is_note or one.file in parts) for one in plan.unported),
    )
    return plan._replace(unported=left)


def _left_in_ros_1(package: PackageFolder) -> Unported:
    return Unported(
        package.path / "package.xml",
        1,
        f"{package.name} is of ROS 1: a port is for packages of ROS 2.",
        "Port it to ROS 2 first: ament_cmake, launch files and nodes.",
    )


class _Launches:
    """What the launch files of packages put into the simulator."""

    def __init__(self, targets: Targets, environment: Mapping[str, str]) -> None:
        files = [
            file
            for package in targets.packages
            for file in list_files(package.path, _OF_WORLDS, markers=BUILD_MARKERS)
        ]
        self._models = {file.parent.name: file for file in files if file.name == "model.sdf"}
        self._files = {file.name: file for file in files}
        self._spawns: dict[tuple[str, int], list[_Spawned]] = defaultdict(list)
        # Their texts, by the launch files that take part; "": Gazebo's own world.
        self._worlds: dict[str, set[str]] = defaultdict(set)
        self._chosen: set[str] = set()  # launch files whose robot a variable of the shell may name
        wanted = _starting(targets)
        with make_scratch(in_memory=True) as scratch, start_children() as run:
            installed = lay_out(targets, scratch, environment)
            for package in targets.packages:
                if not package.diagnostics:
                    check = PackageCheck(package, installed, None, None, run, scratch)
                    evaluated = check.evaluate(wanted)
                    if any(waits_for_description(one.started) for one in evaluated):
                        evaluated = check.evaluate()
                    for one in evaluated:
                        self._take(one.started)

    def _take(self, started: Started) -> None:
        simulator = started.simulator
        if simulator is not None:
            world = Path(simulator.world or "")
            if not world.is_file():  # where its author has it
                world = self._files.get(world.name, world)
            source = read_source(world) if simulator.world else None
            for file in started.plan.evaluated_files:
                self._worlds[real_path(file)].add("" if source is None else source.text)
        texts = (read_source(Path(file)) for file in started.plan.evaluated_files)
        is_chosen = any(text and _CHOSEN.search(text.text) for text in texts)
        for spawn in started.spawns:
            process = spawn.process
            if process is not None and process.file and process.line and spawn.description:
                namespace = read_options(process, SPAWN_ENTITY).values.get("robot_namespace")
                found = _Spawned(spawn.description, namespace)
                self._spawns[real_path(process.file), process.line].append(found)
                self._chosen |= {real_path(process.file)} if is_chosen else set()

    def robots(self) -> Robots:
        """What models need to know of the robots that are spawned."""
        found = (one for ones in self._spawns.values() for one in ones)
        spawns = {
            one.description: one for one in sorted(found, key=lambda one: bool(one.namespace))
        }
        spaces = {
            one.description for ones in self._spawns.values() for one in ones if one.namespace
        }
        managers: dict[tuple[str, str], set[str]] = defaultdict(set)
        for ones in self._spawns.values():
            for one in ones:
                for manager in managers_of(one.description):
                    managers[manager].add(one.namespace or "")
        wheels: dict[tuple[str, str], frozenset[str]] = defaultdict(frozenset)
        for text in spawns:
            for drive, joints in wheels_of(text):
                wheels[drive] |= joints
        return Robots(
            managers=managers,
            wheels=wheels,
            mounted=frozenset(one for text in spawns for one in _mounted(text)),
            scoped=frozenset(
                one
                for text in spaces
                for one in plugins_of(text)
                if simulator_of(one[1]) == CLASSIC
            ),
            refused=frozenset(one for text in spawns for one in _refused(text)),
            cars={
                name: sizes
                for text in (*spawns, *set().union(*self._worlds.values()))
                for name, sizes in _cars(text)
                if all(sizes)
            },
        )

    def rows(
        self,
        target: Target,
        robots: Robots,
        services: Collection[BridgeRow],
        fixed: Sequence[BridgeRow],
    ) -> dict[str, dict[int, list[BridgeRow]]]:
        """The topics of the robots that spawners put into the simulator, by real path and line.

        Args:
            target: The distribution, with Gazebo Sim.
            robots: What is known of them.
            services: Those of the world that programs call.
            fixed: Those of all robots, for spawners of which a variable of the shell names one.
        """
        found: dict[str, dict[int, list[BridgeRow]]] = defaultdict(lambda: defaultdict(list))
        known = {
            text: [*services, *_rows_of_world(text, self._models, target, robots)]
            for text in set().union(*self._worlds.values())
        }
        for launch_file, texts in self._worlds.items():
            found[launch_file][OF_WORLD] += dict.fromkeys(
                row._replace(gz_topic=row.gz_topic.replace(WORLD, name))
                for text in texts
                for name in _names_of_worlds(text)
                for row in known[text]
            )
        for (launch_file, line), spawns in self._spawns.items():
            texts = self._worlds.get(launch_file) or set().union(*self._worlds.values()) or {""}
            names = {name for text in texts for name in _names_of_worlds(text)}
            found[launch_file][line] += dict.fromkeys(
                row._replace(gz_topic=row.gz_topic.replace(WORLD, name))
                for one in dict.fromkeys(spawns)
                for row in one.rows(target, robots)
                for name in sorted(names)
            )
            if launch_file in self._chosen and all(one.namespace is None for one in spawns):
                found[launch_file][line] = _with_others(found[launch_file][line], fixed)
        return found


def _starting(targets: Targets) -> frozenset[str]:
    """The files that may start a simulator or spawn a robot, by real path: others need no look.

    They name what does, or a file that does; names may be computed but for their endings.
    """
    texts = {
        file: source.text
        for package in targets.packages
        for file in list_files(package.path, _OF_LAUNCHES, markers=BUILD_MARKERS)
        if file.name != "package.xml" and (source := read_source(file)) is not None
    }
    named = {file: {*_FILE_NAME.findall(text)} for file, text in texts.items()}
    words = {file: {*re.findall(r"\w+", text)} for file, text in texts.items()}
    found: set[Path] = set()
    new = {file for file, text in texts.items() if _STARTS.search(text)}
    while new:
        found |= new
        names = [file.name for file in new]
        modules = {file.stem for file in new if file.suffix == ".py"}
        new = {
            file
            for file in texts.keys() - found
            if not modules.isdisjoint(words[file])
            or any(name.endswith(ending) for ending in named[file] for name in names)
        }
    return frozenset(map(real_path, found))


class _Spawned(NamedTuple):
    """A robot that a spawner puts into the simulator."""

    description: str
    namespace: str | None  # that is given to its plugins; None: the spawner has no such option

    def rows(self, target: Target, robots: Robots) -> list[BridgeRow]:
        """Its topics."""
        robots = robots._replace(mounted=frozenset(_mounted(self.description)))
        rows = bridge_rows(self.description, target, robots)
        if self.namespace is None:
            return rows
        scoped = bridge_rows(self.description, target, robots, namespace=NAMESPACE)
        as_alone = [
            row._replace(ros_topic=row.ros_topic.replace(f"/{NAMESPACE}", "")) for row in scoped
        ]
        # An empty namespace leaves plugins their own one.
        return scoped if self.namespace or as_alone == rows else rows


def _mounted(description: str) -> Iterator[Mounted]:
    """The sensors of a URDF, on the links that Gazebo Classic has."""
    written = _robot(description) if "<sensor" in description else None
    if written is not None:
        lumped, _ = lump(written, for_classic=True)
        for one in read_devices(description, written, lumped).sensors:
            yield Mounted(one.name, one.frame, one.link)


@lru_cache(maxsize=32)
def _robot(description: str) -> Robot | None:
    return read_urdf(description, file=None)[0]


def _refused(description: str) -> Iterator[str]:
    """The links of a URDF whose inertia Gazebo Sim refuses."""
    robot = _robot(description)
    links = () if robot is None else robot.links
    found = [one.name for one in links if one.inertial and is_impossible(one.inertial)]
    if robot is not None and found:
        refused = parts_of_impossible_sums(robot)
        yield from (name for name in found if name in refused)


_CAR = "gazebo_ros_ackermann_drive"
_WHEELS = ("front_left_joint", "front_right_joint", "rear_left_joint", "rear_right_joint")


def _cars(text: str) -> Iterator[tuple[str, tuple[float, ...]]]:
    """The sizes of cars by their last rear wheel, as the plugin of Gazebo Classic finds them.

    They are those of `MEASURED`. Source: gazebo_ros_ackermann_drive.cpp.
    """
    read: list[tuple[Robot | None, Devices | None]] = []
    if _CAR in text and _SDF.search(text):
        found = read_sdf(
            Path("car.sdf"), find_model=lambda _: None, content=text, with_devices=True
        )
        read = [(one.robot, one.devices) for one in found.models]
    elif _CAR in text and (written := _robot(text)) is not None:
        lumped, _ = lump(written, for_classic=True)
        read = [(lumped, read_devices(text, written, lumped))]
    for robot, devices in read:
        for plugin in () if robot is None or devices is None else devices.plugins:
            if robot is not None and stem(plugin.attributes.get("filename", "")) == _CAR:
                joints = {one.name: one for one in robot.joints}
                tags = (*_WHEELS, "left_steering_joint", "right_steering_joint")
                names = [(plugin.get(tag) or "").strip() for tag in tags]
                links = [_carried(robot, joints[name]) for name in names if name in joints]
                if len(links) == len(tags) and all(one.collisions for one in links[:4]):
                    yield names[3], _sizes(robot, links)


def _carried(robot: Robot, joint: Joint) -> Link:
    """What a joint carries; of a universal one, its two hinges."""
    link = robot.link(joint.child)
    onward = [] if link.collisions else [one for one in robot.joints if one.parent == link.name]
    return robot.link(onward[0].child) if len(onward) == 1 else link


def _sizes(robot: Robot, links: Sequence[Link]) -> tuple[float, ...]:
    poses = link_poses(robot, IDENTITY)
    centers = [compose(poses[one.name], one.collisions[0].pose_in_link).xyz for one in links[:4]]
    front, rear = (
        [sum(ends) / 2 for ends in zip(*pair, strict=True)] for pair in (centers[:2], centers[2:])
    )
    shape = links[3].collisions[0].geometry
    return (
        math.dist(*centers[:2]),
        math.dist(*(poses[one.name].xyz for one in links[4:])),
        math.dist(front, rear),
        shape.radius if isinstance(shape, (Cylinder, Sphere)) else 0.0,
    )


def _names_of_worlds(text: str) -> list[str]:
    """The names of the worlds of a file; Gazebo's own one has this name for Gazebo Sim."""
    return _NAME_OF_WORLD.findall(text) or [Path(DEFAULT_WORLD).stem]


def _rows_of_world(
    text: str, models: Mapping[str, Path], target: Target, robots: Robots
) -> Iterator[BridgeRow]:
    """The topics of the models in a world or model, and of those of the workspace in it."""
    yield from bridge_rows(text, target, robots) if text else ()
    for name in dict.fromkeys(_OF_MODEL.findall(text)):
        source = read_source(models[name]) if name in models else None
        if source is not None:
            others = {known: path for known, path in models.items() if known != name}
            for row in _rows_of_world(source.text, others, target, robots):
                yield row._replace(gz_topic=row.gz_topic.replace(MODEL, name))


def _rows_of_robots(port: _Port, target: Target) -> Iterator[BridgeRow]:
    """The topics of the robots of a package."""
    for source in port.files(_OF_XML):
        if _ROBOT.search(source.text):
            yield from bridge_rows(source.text, target)


def _with_others(rows: Sequence[BridgeRow], others: Sequence[BridgeRow]) -> list[BridgeRow]:
    """Topics, and those of others that have other names."""
    names = {(row.ros_topic, row.direction) for row in rows}
    return [*rows, *(row for row in others if (row.ros_topic, row.direction) not in names)]


def _clocks(port: _Port) -> Iterator[str]:
    """The names of files that give the node of Gazebo Classic nothing but the rate of its clock."""
    for source in port.files(_OF_YAML):
        if _CLOCK.fullmatch(re.sub(r"#.*", "", source.text)):
            yield source.file.name


def _unused_parts(ports: Sequence[_Port]) -> frozenset[Path]:
    """The parts of robots that no file includes: a robot as a whole has a name."""
    parts = [
        source.file
        for port in ports
        for source in port.files(_OF_XML)
        if (tag := _ROBOT_TAG.search(source.text)) and not _HAS_NAME.search(tag[0])
    ]
    texts = [
        _XML_COMMENT.sub("", source.text)
        for port in ports
        for source in port.files((*_OF_XML, *LAUNCH_FILES, *_OF_YAML, ".py"))
        if parts
    ]
    if any(_COMPUTED_INCLUDE.search(text) for text in texts):
        return frozenset()
    return frozenset(one for one in parts if not any(one.name in text for text in texts))


def _is_markup(file: Path) -> bool:
    return file.name.endswith(_MARKUP)


def _port_models(port: _Port, target: Target, robots: Robots) -> None:
    for source in port.files(_OF_XML):
        if _is_markup(source.file) or source.file.name == "package.xml":
            continue
        if _ROBOT.search(source.text) or _SDF.search(source.text):
            is_whole_robot = "<inertia" in source.text and "xacro:" not in source.text
            # Launch files that a port corrects spawn it from then on.
            refused = frozenset(_refused(source.text) if is_whole_robot else ())
            known = robots._replace(refused=robots.refused | refused)
            port.add(source, port_model(source, target, known))


def _port_efforts(ports: Sequence[_Port], target: Target) -> None:
    """Write into the joints of wheels, whatever file has them, what their plugins limited."""
    wanted = [
        (port, one, effort)
        for port in ports
        for one in [*port.ports]
        for effort in joined(port.ports[one]).efforts
    ]
    if not wanted:
        return
    sources = {
        source.file: (port, source)
        for port in ports
        for source in port.files(_OF_XML)
        if _ROBOT.search(source.text)
    }
    shares = {port.package.name: port.package.path for port in ports}
    wholes = [
        frozenset(one.file for one in written_elements(file, shares.get)) & sources.keys()
        for file in sources
    ]
    for port, file, effort in wanted:
        robots = [one for one in wholes if file in one]
        # Some are parts of others.
        whole = [one for one in robots if not any(one < other for other in robots)]
        porters = {one: Porter(sources[one][1], target) for one in frozenset().union(*whole)}
        if whole and all(port_effort(effort, [porters[one] for one in those]) for those in whole):
            for one, porter in porters.items():
                sources[one][0].add(sources[one][1], porter.finish())
        else:
            port.ports[file].append(FilePort(unported=(effort.left,)))


def _port_worlds(
    port: _Port,
    target: Target,
    systems: frozenset[str],
    models: Collection[str],
    *,
    are_called: bool,
) -> None:
    for source in port.files(_OF_XML):
        if _SDF.search(source.text) and _WORLD.search(source.text):
            made = port_world(source, target, systems, models=models, are_called=are_called)
            port.add(source, made)


def _calls_classic(port: _Port) -> bool:
    """Whether a file of the package names services or topics of worlds of Gazebo Classic."""
    return any(
        _OF_SERVICES.search(source.text)
        for source in port.files((*_CODE, ".py", *_OF_YAML, *_MARKUP, ".sh", ".rviz"))
    )


def _port_programs(port: _Port) -> None:
    for source in port.files((".py",)):
        made = None if source.file.name.endswith(LAUNCH_FILES) else port_program(source)
        if made is not None:
            port.add(source, made)


def _port_parameters(port: _Port, target: Target) -> Iterator[Stamper]:
    for source in port.files(_OF_YAML):
        made, stampers = port_parameters(source, target)
        port.add(source, made)
        yield from stampers


def _as_renamed(stamper: Stamper, ports: Sequence[_Port]) -> Stamper:
    """With the name that a robot gives to the topic of a controller by remapping."""
    rule = re.compile(rf"(?<![\w/]){re.escape(stamper.source)}\s*:=\s*([\w/]+)")
    for port in ports:
        for source in port.files(_OF_XML):
            found = rule.search(source.text)
            if found is not None:
                return stamper._replace(source=found[1])
    return stamper


def _list_unstarted(stampers: Sequence[Stamper], ports: Sequence[_Port]) -> None:
    """List the controllers whose commands no launch file gives a time."""
    written = [edit.text for port in ports for edit in port.all().edits]
    for one in stampers:
        if any(one.target in text for text in written):
            continue
        unported = Unported(
            one.file,
            one.line,
            f"The controller `{one.controller}` takes commands with a time now: TwistStamped on "
            f"{one.target}.",
            f"Publish them so, or start twist_stamper with /cmd_vel_in as {one.source} and "
            f"/cmd_vel_out as {one.target}.",
        )
        port = next(port for port in ports if one.file in port.ports)
        port.ports[one.file].append(FilePort(unported=(unported,)))


class _Known(NamedTuple):
    """What launch files need to know of the whole workspace."""

    rows: Mapping[str, Mapping[int, Sequence[BridgeRow]]]  # by real path and line of a spawner
    any_rows: Sequence[BridgeRow]
    systems: frozenset[str]
    stampers: Sequence[Stamper]
    clocks: Sequence[str]  # see `Context`
    are_all: bool
    frames: frozenset[str]
    workspace: frozenset[str]


def _port_launch_files(ports: Sequence[_Port], target: Target, known: _Known) -> None:
    """Port the launch files of all packages; those that pass a world on, after what takes it."""
    takers: dict[Path, WorldTaker] = {}
    found: Collection[str] | None = None  # names of these in the last round; None: there was none
    while found is None or found:
        before, rounds = found, [(port, _context(port, target, known)) for port in ports]
        found = set()
        for port, context in rounds:
            for source in port.files((".py",)):
                if source.file.name == "setup.py" or port.is_program(source.file):
                    continue
                if before is not None and not any(name in source.text for name in before):
                    continue
                own = context(source)._replace(takers=[*takers.values()])
                made = port_launch_file(source, own)
                port.ports[source.file] = [made]
                was = takers.get(source.file)
                worlds = made.worlds | (was.arguments if was else frozenset())
                taker = WorldTaker(source.file.name, port.package.name, own.default_world, worlds)
                if worlds and taker != was:
                    takers[source.file] = taker
                    found.add(source.file.name)
    for port in ports:
        context = _context(port, target, known)
        for source in port.files((*_MARKUP, *LAUNCH_FILES)):
            if source.file.suffix != ".py":
                port.add(source, port_markup(source, context(source)))


def _context(port: _Port, target: Target, known: _Known) -> Callable[[SourceText], Context]:
    """What the launch files of a package are ported with."""
    own = next((one.file for one in port.files(_OF_WORLDS) if one.file.stem == "empty"), None)
    world = DEFAULT_WORLD if known.systems else None
    if own is not None:
        world = own.relative_to(port.package.path).as_posix()
    return lambda source: Context(
        rows=known.rows.get(real_path(source.file), {}),
        package=port.package.name,
        distro=target.distro,
        default_world=world,
        stampers=known.stampers,
        any_rows=known.any_rows,
        are_all=known.are_all,
        clocks=known.clocks,
        frames=known.frames,
        workspace=known.workspace,
    )


def _list_code(port: _Port) -> None:
    """List what programs of the package use of Gazebo Classic."""
    for source in port.files((*_CODE, ".py")):
        if source.file.name.endswith(LAUNCH_FILES) or port.is_program(source.file):
            continue
        found = _OF_CLASSIC.search(source.text)
        if found is not None:
            words = set(re.findall(r"\w+", source.text)) if MESSAGES in source.text else set()
            named = [name for name in INSTEAD_OF_MESSAGES if name in words]
            advice = " ".join(dict.fromkeys(INSTEAD_OF_MESSAGES[name] for name in named))
            unported = Unported(
                source.file,
                source.line_at(found.start()),
                f"The program uses Gazebo Classic: {some_named(named or [found[0].strip()])}.",
                advice
                or "Write it for Gazebo Sim: docs/port.md says what takes the place of what.",
            )
            port.add(source, FilePort(unported=(unported,)))


def _port_build(port: _Port, target: Target, ports: Sequence[_Port], *, is_simulated: bool) -> None:
    made = port.all()
    folders = frozenset(name.partition("/")[0] for name in made.files if "/" in name)
    address = re.compile(rf"(?:package|model)://{re.escape(port.package.name)}/")
    has_models = is_simulated and any(
        address.search(text)
        for one in ports
        for text in (
            *(source.text for source in one.files(_OF_XML)),
            *(edit.text for edit in one.all().edits),
        )
    )
    calls: dict[str, Callable[[SourceText], FilePort]] = {
        "package.xml": lambda source: port_manifest(
            source,
            target,
            made.packages,
            workspace=[one.package.name for one in ports],
            has_models=has_models,
            ported=[*filter(port.is_program, port.ports)],
        ),
        "CMakeLists.txt": lambda source: port_cmake(source, folders),
        "setup.py": lambda source: port_setup(source, folders),
        SETTINGS: lambda source: _port_settings(source, target),
    }
    for name, call in calls.items():
        file = port.package.path / name
        source = port.source(file) if file.is_file() else None
        if source is not None:
            port.add(source, call(source))
    for source in port.files(_HOOKS):
        port.add(source, port_hook(source))


def _port_settings(source: SourceText, target: Target) -> FilePort:
    """Write the new target into wsgen.toml."""
    section = re.search(r"(?m)^\[target\][^\[]*", source.text)
    if section is None:
        return FilePort()
    edits = []
    for key, value in (("distro", target.distro), ("simulator", target.simulator)):
        found = re.compile(rf"(?m)^\s*{key}\s*=\s*[\"'](\w+)[\"']").search(
            source.text, section.start(), section.end()
        )
        if found is not None and found[1] != value:
            edits.append(Edit(start=found.start(1), end=found.end(1), text=value))
    return FilePort(edits=tuple(edits))


def _collect(ports: Sequence[_Port], target: Target, systems: frozenset[str]) -> PortPlan:
    files, created, unported = [], [], []
    for port in ports:
        for file, made in port.ports.items():
            source = port.sources[file]
            fix, left = _changed(source, made)
            files += [fix] if fix is not None else []
            unported += left
        for name in sorted(port.all().files):
            new = port.package.path / name
            if not new.exists():
                created.append((new, new_world(new.stem, target, systems)))
    return PortPlan(
        files=tuple(sorted(files, key=lambda one: one.file)),
        created=tuple(created),
        unported=tuple(sorted(dict.fromkeys(unported))),
        packages=tuple(port.package.name for port in ports),
    )


def _changed(
    source: SourceText, ports: Sequence[FilePort]
) -> tuple[FileFix | None, list[Unported]]:
    edits: list[Edit] = []
    left: list[Unported] = []
    for port in ports:
        left += port.unported
        for edit in dict.fromkeys(port.edits):
            if edit in edits:
                continue
            if overlap([edit], edits):
                left.append(
                    Unported(
                        source.file,
                        source.line_at(edit.start),
                        "Two changes touch this place; one of them is made.",
                        "Port again: what is left is found then.",
                    )
                )
                continue
            edits.append(edit)
    after = apply(source.text, edits)
    if after == source.text:
        return None, left
    if is_whole(source, source.text) and not is_whole(source, after):
        problem = Unported(
            source.file,
            1,
            "The port would break the file, which stays as it is.",
            "Please report it with the file.",
        )
        return None, [*left, problem]
    fix = FileFix(
        file=source.file,
        before=source.text,
        after=after,
        data=source.encoded(after),
        fixed=(),
    )
    return fix, left
