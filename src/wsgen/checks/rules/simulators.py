"""The rules about what a launch file starts beside its simulator."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.launching.explain_missing import where_written
from wsgen.launching.simulators import simulator_kinds
from wsgen.launching.spawner_options import (
    CONTROLLER_SPAWNERS,
    CREATE,
    SPAWN_ENTITY,
    SPAWNER_PROGRAMS,
    SPAWNERS,
    read_options,
)
from wsgen.model.facts import WITHOUT_CLASSIC
from wsgen.model.target import CLASSIC, SIM
from wsgen.ros.names import released_packages
from wsgen.text.suggestions import did_you_mean, some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.text.xmltree import Element


SPAWNER_OF_OTHER_SIMULATOR = Rule(
    code="LCH067",
    name="spawner-of-other-simulator",
    severity=Severity.ERROR,
    summary="The spawner does not belong to the simulator that the launch file starts.",
    why="The spawner waits for a service that the simulator does not have, and the robot does not "
    "appear.",
    example="gz_sim.launch.py of ros_gz_sim, and\n"
    "Node(package='gazebo_ros', executable='spawn_entity.py', ...)",
    instead="gz_sim.launch.py of ros_gz_sim, and\nNode(package='ros_gz_sim', executable='create',\n"
    "     arguments=['-topic', 'robot_description', '-name', 'my_robot'])",
)
NO_CLASSIC = Rule(
    code="SPN105",
    name="no-gazebo-classic",
    severity=Severity.ERROR,
    summary="The launch file starts Gazebo Classic, which is not available for the ROS 2 "
    "distribution.",
    what="Looks for the launch files, the spawner and the programs of Gazebo Classic where the "
    "package is for Jazzy or later, and `gazebo_ros` is neither installed nor in the workspace.",
    why="Iron is the last distribution with Gazebo Classic. `ros2 launch` stops: the package "
    "'gazebo_ros' is not found.",
    example="# for Jazzy\nsource = PythonLaunchDescriptionSource(os.path.join(\n"
    "    get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py'))",
    instead="source = PythonLaunchDescriptionSource(os.path.join(\n"
    "    get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py'))",
)
NO_FACTORY = Rule(
    code="LCH068",
    name="no-factory-plugin",
    severity=Severity.ERROR,
    summary="Gazebo Classic is started without the plugin that spawns robots.",
    what="Looks for `libgazebo_ros_factory.so` in the command line of `gazebo` or `gzserver`, in "
    "its world, and in the arguments of `gzserver.launch.py`.",
    why="Without the plugin, Gazebo does not provide the service `/spawn_entity`: the spawner "
    "reports that it is unavailable, and the robot does not appear.",
    example="ExecuteProcess(cmd=['gazebo', '--verbose', world])",
    instead="ExecuteProcess(cmd=['gazebo', '--verbose', world,\n"
    "                    '-s', 'libgazebo_ros_init.so', '-s', 'libgazebo_ros_factory.so'])",
)
WALL_CLOCK = Rule(
    code="LCH069",
    name="wall-clock-beside-simulator",
    severity=Severity.WARNING,
    severity_varies="information about `robot_state_publisher` where no other node uses the time "
    "of the simulator, and no program of a user is started",
    summary="A node that uses time stamps does not use the time of the simulator.",
    what="Where a launch file starts a simulator, checks `use_sim_time` of "
    "`robot_state_publisher`, `joint_state_publisher`, robot_localization, slam_toolbox and Nav2.",
    why="Sensor data and joint states have simulation time, but the node uses the time of the "
    "computer: transforms are too old or too new, and messages are dropped. "
    "`robot_state_publisher` does not notice that the simulation is reset: it publishes no more "
    "transforms of joints that move until the time is later than before.",
    example="Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': description}])",
    instead="Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': description, 'use_sim_time': True}])",
)
NO_CLOCK = Rule(
    code="LCH070",
    name="no-clock-bridge",
    severity=Severity.WARNING,
    summary="Nodes use the time of Gazebo Sim, but no bridge publishes `/clock` in ROS.",
    what="Looks for a bridge of `/clock` where a launch file starts Gazebo Sim and a node with "
    "`use_sim_time`. Not checked where the launch file starts unknown nodes, which may publish it.",
    why="Gazebo Sim does not publish `/clock` in ROS. The time of the nodes stays 0: they publish "
    "no transforms, and timers never fire.",
    example="Node(package='ros_gz_bridge', executable='parameter_bridge',\n"
    "     arguments=['/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan'])",
    instead="Node(package='ros_gz_bridge', executable='parameter_bridge',\n"
    "     arguments=['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock',\n"
    "                '/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan'])",
)
OTHER_WORLD = Rule(
    code="LCH071",
    name="other-world-name",
    severity=Severity.ERROR,
    summary="The spawner names a different world than Gazebo Sim loads.",
    what="Compares `-world` of `create`, and the service of `gz service`, with the name in "
    "`<world name=...>` of the world file.",
    why="Gazebo provides the service `/world/NAME/create` only for the world that it loads: the "
    "request of the spawner is not answered. NAME is the name of the `<world>`, not that of the "
    "file.",
    example='# office.sdf: <world name="default">\n'
    "arguments=['-world', 'office', '-topic', 'robot_description']",
    instead="arguments=['-world', 'default', '-topic', 'robot_description']",
)
PAUSED = Rule(
    code="LCH087",
    name="starts-paused",
    severity=Severity.INFO,
    summary="Gazebo starts paused.",
    what="Looks for `-r` in `gz_args`, unless the world or `--gui-config` configures the window.",
    why="The simulation waits until the play button is pressed: robots stay at their spawn pose, "
    "and controllers do not start.",
    example="launch_arguments={'gz_args': 'empty.sdf'}.items()",
    instead="launch_arguments={'gz_args': '-r empty.sdf'}.items()",
)
GLUED_ARGUMENTS = Rule(
    code="LCH088",
    name="glued-arguments",
    severity=Severity.ERROR,
    summary="A blank is missing between an option of Gazebo Sim and the path of the world.",
    why="The items of a list in `gz_args` are joined without blanks. Gazebo does not know the "
    "resulting option, and stops.",
    example="launch_arguments={'gz_args': ['-r', world]}.items()",
    instead="launch_arguments={'gz_args': ['-r ', world]}.items()",
)

FACTORY = "libgazebo_ros_factory.so"
_SPAWNERS = {
    program: CLASSIC if options is SPAWN_ENTITY else SIM for program, options in SPAWNERS.items()
}
_NAMES = {CLASSIC: "Gazebo Classic", SIM: "Gazebo Sim"}
_SPAWNER_OF = {
    CLASSIC: "Use package='gazebo_ros', executable='spawn_entity.py', with -entity instead of "
    "-name.",
    SIM: "Use package='ros_gz_sim', executable='create', with -name instead of -entity.",
}
# By package, and by the executable or the class of the component.
_WITH_STAMPS = {
    "robot_state_publisher": None,
    "joint_state_publisher": None,
    "joint_state_publisher_gui": None,
    "slam_toolbox": None,
    "robot_localization": ("ekf_node", "ukf_node"),
    "nav2_amcl": None,
    "nav2_controller": None,
    "nav2_planner": None,
    "nav2_bt_navigator": None,
}
_GLUED = lazy_pattern(r"-[rsg]+[/~][\w./~-]*")
_SERVICE = lazy_pattern(r"/world/([^/]+)/create(?:_multiple)?(?:/blocking)?")
BRIDGES = frozenset(("ros_gz_bridge", "ros_ign_bridge"))


def spawners_of_other_simulator(plan: LaunchPlan, kinds: Collection[str]) -> Iterator[Diagnostic]:
    """Report spawners that none of the started simulators answers; `kinds` are of these."""
    for program in misplaced_spawners(plan, kinds):
        (started,) = set(kinds)
        kind = _SPAWNERS[program.package or "", program.executable or ""]
        yield SPAWNER_OF_OTHER_SIMULATOR.at(
            program.file,
            program.line,
            program.executable,
            message=f"`{program.executable}` of {program.package} spawns into {_NAMES[kind]}, but "
            f"the launch file starts {_NAMES[started]}.",
            hint=_SPAWNER_OF[started],
        )


def misplaced_spawners(plan: LaunchPlan, kinds: Collection[str]) -> Iterator[Process]:
    """The spawners that belong to another simulator than the started ones, of these kinds."""
    for program in started_programs(plan):
        kind = _SPAWNERS.get((program.package or "", program.executable or ""))
        if kind is not None and kinds and kind not in kinds:
            yield program


def no_classic(
    plan: LaunchPlan, distro: str | None, is_installed: Callable[[str], bool]
) -> Iterator[Diagnostic]:
    """Report, once, a launch file that starts Gazebo Classic where there is none.

    `is_installed` says whether a package is on this machine or in the workspace.
    """
    if distro not in WITHOUT_CLASSIC:
        return
    started: list[tuple[str, Path | None, int | None]] = [
        (include.file.name, *_where(plan, include.file.name))
        for include in started_launch_files(plan)
        if include.package == "gazebo_ros"
    ]
    for one in started_programs(plan):
        is_program = one.package is None and one.executable in _CLASSIC_PROGRAMS
        if is_program or one.package == "gazebo_ros":
            started.append((one.executable or "", one.file, one.line))
    # A spawner alone is reported as that of another simulator.
    if not started or is_installed("gazebo_ros") or simulator_kinds(plan) == {SIM}:
        return
    names = list(dict.fromkeys(f"`{name}`" for name, _, _ in started))
    name, file, line = started[0]
    yield NO_CLASSIC.at(
        file,
        line,
        name,
        message=f"ROS 2 {distro} has no Gazebo Classic: {some_of(names)} "
        f"{'is' if len(names) == 1 else 'are'} not available, and the launch fails.",
        hint="Include gz_sim.launch.py of ros_gz_sim, and spawn with `create` of ros_gz_sim.",
    )


_CLASSIC_PROGRAMS = frozenset(("gazebo", "gzserver", "gzclient"))


def no_factory(
    plan: LaunchPlan, kinds: Collection[str], world_plugins: Collection[str] | None
) -> Iterator[Diagnostic]:
    """Report Gazebo Classic without the plugin that spawns, beside a spawner.

    `world_plugins` are the libraries that the world loads; None where they are not known.
    """
    programs = started_programs(plan)
    spawner = next(
        (one for one in programs if (one.package, one.executable) in _CLASSIC_SPAWNERS), None
    )
    if spawner is None or set(kinds) != {CLASSIC} or world_plugins is None:
        return
    if any(FACTORY in one for one in world_plugins):
        return
    for program in programs:
        if program.package is None and program.executable in {"gazebo", "gzserver"}:
            if any(FACTORY in word or plan.is_unknown(word) for word in program.arguments):
                return
            yield NO_FACTORY.at(
                program.file,
                program.line,
                program.executable,
                message=f"`{program.executable}` is started without {FACTORY}, so that the service "
                f"/spawn_entity for `{spawner.executable}` is unavailable.",
                hint=f"Add '-s', 'libgazebo_ros_init.so', '-s', '{FACTORY}' to the command.",
            )
    for include in started_launch_files(plan):
        values = include.configurations or include.arguments
        is_server = include.package == "gazebo_ros" and include.file.name.startswith(
            ("gazebo.launch", "gzserver.launch")
        )
        if is_server and values.get("factory", "true").strip().lower() in {"false", "0"}:
            yield NO_FACTORY.at(
                *_where(plan, "factory"),
                "factory",
                message=f"{include.file.name} gets factory:=false, so that the service "
                f"/spawn_entity for `{spawner.executable}` is unavailable.",
                hint="Remove the launch argument `factory`.",
            )


_CLASSIC_SPAWNERS = {one for one, kind in _SPAWNERS.items() if kind == CLASSIC}


def wall_clocks(plan: LaunchPlan, kinds: Collection[str]) -> Iterator[Diagnostic]:
    """Report nodes that do not use the time of the simulator beside them."""
    if not kinds:
        return
    programs = started_programs(plan)
    for program in programs:
        executables = _WITH_STAMPS.get(program.package or "", ())
        is_meant = executables is None or program.executable in executables
        if is_meant and uses_sim_time(plan, program) is False:
            yield WALL_CLOCK.at(
                program.file,
                program.line,
                program.name or program.executable,
                message=f"`{program.name or program.executable}` does not use the time of the "
                "simulator that the launch file starts.",
                hint="Add 'use_sim_time': True to its parameters.",
                # Its transforms have the time of the joint states: known programs go on with them.
                severity=Severity.INFO
                if program.package == _PUBLISHER and not _relies_on_time(plan, programs)
                else None,
            )


def _relies_on_time(plan: LaunchPlan, programs: Iterable[Process]) -> bool:
    """Whether a node uses the time of the simulator, or may do so because it is a user's."""
    return any(
        one.package not in released_packages() or uses_sim_time(plan, one)
        for one in programs
        if one.package is not None
        and one.package not in BRIDGES
        and one.executable not in _ONLY_BRING
    )


_PUBLISHER = "robot_state_publisher"
_ONLY_BRING = SPAWNER_PROGRAMS | CONTROLLER_SPAWNERS


def uses_sim_time(plan: LaunchPlan, node: Process) -> bool | None:
    """Whether a node takes the time of the simulator; None where that is not known."""
    value: Any = node.parameters.get("use_sim_time")
    if value is None:
        words = [word for word in (*node.arguments, *(node.command or ())) if "use_sim" in word]
        if words:
            return None if plan.is_unknown(words[0]) else "true" in words[0].lower()
        # A file of parameters that is not known may say so.
        return None if plan.unresolved and len(node.parameters) == 0 else False
    text = str(value).strip().lower()
    if plan.is_unknown(str(value)):
        return None
    return text in {"true", "1"}


def no_clock(
    plan: LaunchPlan, kinds: Collection[str], bridged: Collection[str] | None
) -> Iterator[Diagnostic]:
    """Report nodes with the time of Gazebo Sim that nothing brings to ROS.

    `bridged` are the topics of ROS that bridges of the plan publish; None where they are not known.
    """
    if set(kinds) != {SIM} or bridged is None or not plan.is_complete:
        return
    if any(topic.rstrip("/").endswith("clock") for topic in bridged) or _may_bring_clock(plan):
        return
    for program in started_programs(plan):
        is_spawner = (program.package or "", program.executable or "") in _SPAWNERS
        if program.package not in BRIDGES and not is_spawner and uses_sim_time(plan, program):
            yield NO_CLOCK.at(
                program.file,
                program.line,
                program.name or program.executable,
                message=f"`{program.name or program.executable}` uses the time of the simulator, "
                "but no bridge publishes /clock in ROS.",
                hint="Add '/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock' to the arguments of "
                "parameter_bridge of ros_gz_bridge.",
            )
            return


def _may_bring_clock(plan: LaunchPlan) -> bool:
    """Whether what is not known of a plan may publish the time."""
    not_run = (one.package for one in started_launch_files(plan) if not one.evaluated)
    names = (
        text
        for program in started_programs(plan)
        if program.package not in BRIDGES
        for text in (program.executable or "", program.name or "")
    )
    return (
        bool(plan.unresolved)
        or any(package not in _WITHOUT_CLOCK for package in not_run)
        or any("clock" in name or "bridge" in name for name in names)
    )


_WITHOUT_CLOCK = frozenset((*BRIDGES, "ros_gz_sim", "ros_ign_gazebo", "slam_toolbox"))


def other_worlds(plan: LaunchPlan, world: str | None) -> Iterator[Diagnostic]:
    """Report spawners for another world than the one that is loaded, by its name in the file."""
    if world is None:
        return
    for program, name in (*_named_worlds(plan), *_worlds_of_services(plan)):
        if name and name != world and not plan.is_unknown(name):
            yield OTHER_WORLD.at(
                program.file,
                program.line,
                name,
                message=f"`{program.executable}` spawns into the world `{name}`, but Gazebo loads "
                f"the world `{world}`.",
                hint=did_you_mean(world),
            )


def _named_worlds(plan: LaunchPlan) -> Iterator[tuple[Process, str]]:
    for program in started_programs(plan):
        if _SPAWNERS.get((program.package or "", program.executable or "")) == SIM:
            yield program, read_options(program, CREATE).values.get("world", "")


def _worlds_of_services(plan: LaunchPlan) -> Iterator[tuple[Process, str]]:
    for program in started_programs(plan):
        if program.executable in {"gz", "ign"} and program.arguments[:1] == ("service",):
            found = (_SERVICE.fullmatch(word) for word in program.arguments)
            yield from ((program, one[1]) for one in found if one is not None)


def glued_arguments(plan: LaunchPlan) -> Iterator[Diagnostic]:
    """Report options of Gazebo Sim that are one word with the path of the world."""
    for words in _gz_arguments(plan):
        for word in words:
            found = _GLUED.fullmatch(word)
            if found is not None:
                option, _, _ = word.partition("/")
                yield GLUED_ARGUMENTS.at(
                    *_where(plan, option),
                    "gz_args",
                    message=f"The arguments of Gazebo have no blank between `{option}` and the "
                    "path of the world.",
                    hint=f"Write '{option} ' with a blank at the end.",
                )


def starts_paused(
    plan: LaunchPlan, kinds: Collection[str], world: Element | None = None
) -> Iterator[Diagnostic]:
    """Report a simulator that waits for its button; an option of its window may say not to."""
    if len(kinds) != 1 or (
        world is not None and next(world.iter("start_paused"), None) is not None
    ):
        return
    for words in _gz_arguments(plan):
        runs = any(re.fullmatch(r"-[a-z]*r[a-z]*\d?", word) for word in words)
        is_window = any(re.fullmatch(r"-[a-z]*g[a-z]*", word) for word in words)
        is_known = not any(
            plan.is_unknown(word) or _GLUED.fullmatch(word) or word.startswith("--gui-config")
            for word in words
        )
        if words and is_known and not runs and not is_window:
            yield PAUSED.at(
                *_where(plan, "gz_args"),
                "gz_args",
                message="Gazebo is started without `-r`: the simulation is paused at the start.",
                hint="Add `-r ` to gz_args.",
            )
            return


def _gz_arguments(plan: LaunchPlan) -> Iterator[list[str]]:
    """The words of the arguments that launch files of ros_gz_sim give to Gazebo."""
    for include in started_launch_files(plan):
        if include.file.name.partition(".")[0] in {"gz_sim", "ign_gazebo"}:
            values = include.configurations or include.arguments
            yield (values.get("gz_args") or values.get("ign_args") or "").split()


def _where(plan: LaunchPlan, text: str) -> tuple[Path, int | None]:
    """The launch file and the line that write a text, or the launch file of the plan."""
    files: Iterable[Path] = plan.evaluated_files
    written = where_written(text, files)
    if written is None:
        return plan.launch_file, None
    file, line = written
    return type(plan.launch_file)(file), line
