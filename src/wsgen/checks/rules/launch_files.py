"""The rules about what launch files and files of parameters write: paths, files, arguments.

Source of the search path: gazebosim/gz-sim, src/Util.cc; gazebosim/gazebo-classic,
gazebo/common/SystemPaths.cc; the launch files of gazebo_ros and ros_gz_sim, which read the exports
of package.xml.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.launching.explain import ROS_1_LAUNCH_FILE
from wsgen.launching.explain_missing import first_missing, nodes_of
from wsgen.launching.spawner_options import SPAWNER_PROGRAMS
from wsgen.model.target import CLASSIC, SIM, SIMULATORS
from wsgen.text import yamlfile
from wsgen.text.markup import read_text, without_comments
from wsgen.text.pythontree import name_of
from wsgen.text.suggestions import advice, some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.model.world import Spawn


MISSING_ARGUMENT_FILE = Rule(
    code="LCH080",
    name="missing-argument-file",
    severity=Severity.WARNING,
    summary="A node is given the path of a file that the package does not install.",
    what="Looks at the arguments and parameters of nodes for paths in the share folder of a "
    "package of the workspace, such as RViz configurations, maps and parameters.",
    why="The node does not find the file: RViz starts with an empty window, other nodes end with "
    "an error.",
    example="Node(package='rviz2', executable='rviz2',\n"
    "     arguments=['-d', os.path.join(share, 'rviz', 'robot.rviz')])\n\n"
    "# CMakeLists.txt\ninstall(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="# CMakeLists.txt\ninstall(DIRECTORY launch rviz DESTINATION share/${PROJECT_NAME})",
)
HOME_PATH = Rule(
    code="LCH081",
    name="home-path",
    severity=Severity.WARNING,
    summary="A launch file or a parameter file contains a path in a home directory.",
    why="The path exists only on one machine, for one user.",
    example="world = '/home/me/ros2_ws/src/my_robot/worlds/office.sdf'",
    instead="world = os.path.join(get_package_share_directory('my_robot'), 'worlds', 'office.sdf')",
)
UNUSED_DECLARED_ARGUMENT = Rule(
    code="LCH084",
    name="unused-declared-argument",
    severity=Severity.INFO,
    summary="A launch argument is declared but not read.",
    what="Looks for names that a launch file, and those that it includes, use only in "
    "`DeclareLaunchArgument`.",
    why="A value for the argument has no effect.",
    example="DeclareLaunchArgument('gui', default_value='true'),\nIncludeLaunchDescription(source)",
    instead="DeclareLaunchArgument('gui', default_value='true'),\n"
    "IncludeLaunchDescription(source, condition=IfCondition(LaunchConfiguration('gui')))",
)
ROS_1_COMMAND = Rule(
    code="LCH089",
    name="ros-1-command",
    severity=Severity.ERROR,
    summary="A launch file runs a command of ROS 1.",
    why="ROS 2 has no such program, and the launch stops.",
    example="ExecuteProcess(cmd=['rosrun', 'my_robot', 'driver'])",
    instead="ExecuteProcess(cmd=['ros2', 'run', 'my_robot', 'driver'])",
)

_SHARE = lazy_pattern(r"(?:[\w./-]+:=)?(?:file://)?(/.*/share/([a-z][\w-]*)/.+\.\w+)")
_HOME = lazy_pattern(r"(?:file://)?(?:/home|/Users)/[A-Za-z_][\w.-]*/[^\s\"'<>]+")
_HOME_IN_LINE = lazy_pattern(rf"(?:^|[\s\"'=>])({_HOME.pattern})")
_YAML_COMMENT = lazy_pattern(r"(?:^|(?<=\s))#.*", re.MULTILINE)
_OF_ROS_1 = lazy_pattern(r"\$\((?:find|arg|optenv)\s|<node\b[^>]*\stype\s*=|<rosparam\b")


def missing_argument_files(
    plan: LaunchPlan, is_known: Callable[[str], bool]
) -> Iterator[Diagnostic]:
    """Report paths in the share folder of a package, given to a node, that do not exist.

    `is_known` says of a package that all that it installs is known.
    """
    for program in started_programs(plan):
        if program.package is None or program.executable in SPAWNER_PROGRAMS:
            continue
        for path, package in _shared(program):
            if is_known(package) and not Path(path).exists() and not plan.is_unknown(path):
                missing, beside = first_missing(path)
                inside = path.partition(f"/share/{package}/")[2]
                yield MISSING_ARGUMENT_FILE.at(
                    program.file,
                    program.line,
                    path,
                    message=f"`{program.name or program.executable}` is given '{inside}' of "
                    f"{package}, which is not installed.",
                    hint=advice(
                        missing,
                        beside,
                        _how_to_install(Path(path), inside, package),
                        cutoff=_NEAR,
                    ),
                )


def _how_to_install(path: Path, inside: str, package: str) -> str:
    folder, is_deeper, _ = inside.partition("/")
    if is_deeper and path.parent.is_dir():
        return f"Correct the path, or put the file into the folder: '{path.parent}' is installed."
    what = f"DIRECTORY {folder}" if is_deeper else f"FILES {inside}"
    return (
        f"Install it: install({what} DESTINATION share/${{PROJECT_NAME}}) in the CMakeLists.txt of "
        f"{package}; in setup.py, add it to data_files."
    )


_NEAR = 0.75  # so alike, as difflib counts, that the file beside it is meant


def _shared(program: Process) -> Iterator[tuple[str, str]]:
    """The paths in share folders that a node is given, each with the package."""
    texts = (*program.arguments, *_texts(program.parameters.values()))
    for text in dict.fromkeys(texts):
        found = _SHARE.fullmatch(text)
        if found is not None:
            yield found[1], found[2]


def _texts(values: Iterable[Any]) -> Iterator[str]:
    for value in values:
        if isinstance(value, str):
            yield value
        elif isinstance(value, list):
            yield from _texts(value)


# Commands of ROS 1 -> those of ROS 2.
_COMMANDS_OF_ROS_1 = {
    "rosrun": "ros2 run",
    "roslaunch": "ros2 launch",
    "rostopic": "ros2 topic",
    "rosservice": "ros2 service",
    "rosparam": "ros2 param",
    "rosbag": "ros2 bag",
    "rosnode": "ros2 node",
}


def ros_1_commands(plan: LaunchPlan) -> Iterator[Diagnostic]:
    """Report commands of ROS 1."""
    for program in started_programs(plan):
        command = _COMMANDS_OF_ROS_1.get(program.executable or "")
        if program.package is None and command is not None:
            yield ROS_1_COMMAND.at(
                program.file,
                program.line,
                program.executable,
                message=f"`{program.executable}` is a command of ROS 1.",
                hint=f"Write {', '.join(repr(word) for word in command.split())} instead.",
            )


def home_paths(file: Path) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, paths in a home directory that a file writes."""
    found = list(_home_paths(file))
    if found:
        line, path = min(found)
        more = f", and {len(found) - 1} more in this file" if len(found) > 1 else ""
        yield HOME_PATH.at(
            file,
            line,
            path,
            message=f"'{path}' is a path in a home directory{more}.",
            hint="Install the file with a package, and look it up: "
            "get_package_share_directory('PACKAGE'), in XML $(find-pkg-share PACKAGE).",
        )


def _home_paths(file: Path) -> Iterator[tuple[int, str]]:
    if file.suffix == ".py":
        for node in _expressions(file):
            if isinstance(node.value, str) and _HOME.fullmatch(node.value.strip()):
                yield node.lineno, node.value.strip()
        return
    text = read_text(file) or ""
    text = without_comments(text) if file.suffix == ".xml" else _YAML_COMMENT.sub("", text)
    for number, line in enumerate(text.splitlines(), 1):
        found = _HOME_IN_LINE.search(line)
        if found is not None:
            yield number, found[1]


def _expressions(file: Path) -> Iterator[ast.Constant]:
    """The constants of a file of Python, without the texts that only explain."""
    nodes = list(nodes_of(file))
    alone = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    for node in nodes:
        if isinstance(node, ast.Constant) and id(node) not in alone:
            yield node


def unused_declared_arguments(plan: LaunchPlan) -> Iterator[Diagnostic]:
    """Report launch arguments that are declared and that nothing reads."""
    if not plan.is_complete or any(not one.evaluated for one in started_launch_files(plan)):
        return
    files = [file for file in plan.evaluated_files if file.suffix == ".py"]
    if len(files) != len(plan.evaluated_files) or any(map(_reads_computed_names, files)):
        return
    texts = [read_text(file) or "" for file in files]
    for file in files:
        for node in nodes_of(file):
            name = _declared(node)
            if name is None or _count(name, texts) != 1:
                continue
            yield UNUSED_DECLARED_ARGUMENT.at(
                file,
                node.lineno,
                name,
                message=f"No launch file reads the launch argument `{name}`.",
                hint=f"Read it with LaunchConfiguration('{name}'), or remove its declaration.",
            )


def _declared(node: Any) -> str | None:
    """The name of the argument that a call declares."""
    if not isinstance(node, ast.Call) or name_of(node) != "DeclareLaunchArgument":
        return None
    names = [*node.args[:1], *(one.value for one in node.keywords if one.arg == "name")]
    written = [one.value for one in names if isinstance(one, ast.Constant)]
    return next((one for one in written if isinstance(one, str)), None)


def _reads_computed_names(file: Path) -> bool:
    """Whether a launch file reads launch arguments whose names it does not write."""
    for node in nodes_of(file):
        if isinstance(node, ast.Attribute) and node.attr == "launch_configurations":
            return True
        if isinstance(node, ast.Call) and name_of(node) == "LaunchConfiguration":
            names = [*node.args[:1], *(one.value for one in node.keywords)]
            if not names or not isinstance(names[0], ast.Constant):
                return True
    return False


def _count(name: str, texts: Sequence[str]) -> int:
    word = re.compile(rf"(?<!\w){re.escape(name)}(?!\w)")
    return sum(len(word.findall(text)) for text in texts)


def ros_1_launch_files(files: Iterable[Path]) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, launch files of ROS 1 that `ros2 launch` does not list."""
    found = []
    for file in files:
        text = without_comments(read_text(file) or "")
        place = _OF_ROS_1.search(text)
        if place is not None and "<launch" in text:
            found.append((file, text.count("\n", 0, place.end()) + 1))
    if found:
        file, line = found[0]
        names = [other.name for other, _ in found]
        yield ROS_1_LAUNCH_FILE.at(
            file,
            line,
            message=f"Launch files are written for ROS 1: {some_of(names)}."
            if len(names) > 1
            else "The launch file is written for ROS 1.",
            hint="Rewrite it as NAME.launch.py or NAME.launch.xml, or remove it.",
            severity=Severity.WARNING,
        )


NO_RESOURCE_PATH = Rule(
    code="LCH090",
    name="no-resource-path",
    severity=Severity.WARNING,
    summary="Gazebo does not find the meshes of a robot: its search path lacks their package.",
    what="For `package://` and `model://` meshes of spawned robots in packages of the workspace, "
    "searches the folders of the simulator's variable as the launch file, environment hooks and "
    "the shell set it, and those of `<gazebo_ros gazebo_model_path=...>` in package.xml where the "
    "launch file of `ros_gz_sim` or `gazebo_ros` reads it.",
    why="RViz finds the meshes by their package. Gazebo looks for `model://PACKAGE` in its own "
    "search path: the robot is invisible there, and links with collision meshes fall through the "
    "ground.",
    example='<mesh filename="package://my_robot/meshes/base.stl"/>',
    instead="<!-- package.xml of my_robot -->\n<export>\n"
    '  <gazebo_ros gazebo_model_path="${prefix}/.."/>\n</export>',
)

VARIABLES = {
    SIM: ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GZ_FILE_PATH", "SDF_PATH"),
    CLASSIC: ("GAZEBO_MODEL_PATH",),
}
_MESH = lazy_pattern(
    r"(?:<mesh\b[^>]*?\bfilename\s*=\s*[\"']|<uri>\s*)(?:package|model)://([\w-]+)/"
)
_LAUNCH_FILE = {SIM: "gz_sim.launch.py of ros_gz_sim", CLASSIC: "gazebo.launch.py of gazebo_ros"}


class SearchPath(NamedTuple):
    """Where a simulator looks for `model://`."""

    folders: tuple[str, ...]
    reads_exports: bool  # of package.xml; their folders are among these
    has_exports: bool = False  # whether there are any
    set_in_vain: str = ""  # a variable that only the other simulator reads


def mesh_packages(text: str) -> list[str]:
    """The packages, or models, that the meshes of a description are looked up in."""
    return list(dict.fromkeys(_MESH.findall(text)))


def no_resource_path(
    spawns: Iterable[Spawn], kind: str, path: SearchPath, is_missing: Callable[[str], bool]
) -> Iterator[Diagnostic]:
    """Report robots with meshes that their simulator does not find.

    Args:
        spawns: The robots.
        kind: The simulator that is started.
        path: Where it looks.
        is_missing: Whether a package is of the workspace and in none of these folders.
    """
    for spawn in spawns:
        packages = [one for one in mesh_packages(spawn.description) if is_missing(one)]
        if packages:
            yield NO_RESOURCE_PATH.at(
                spawn.process.file if spawn.process else None,
                spawn.process.line if spawn.process else None,
                spawn.entity,
                message=f"{SIMULATORS[kind]} does not find the meshes of "
                f"{some_of([f'package://{one}' for one in packages])}, so that `{spawn.entity}` is "
                f"invisible there: {_why(kind, path)}.",
                hint=_what_to_do(kind, path, packages[0]),
            )
            return


def _why(kind: str, path: SearchPath) -> str:
    variable = VARIABLES[kind][0]
    if path.has_exports and not path.reads_exports:
        return (
            f"only the launch file of {_LAUNCH_FILE[kind].rpartition(' ')[2]}, which is not used "
            "here, reads <gazebo_ros> in package.xml"
        )
    if path.set_in_vain:
        return f"it reads {variable}, not {path.set_in_vain}"
    if path.folders:
        return f"no folder of {variable} has the package"
    return f"nothing adds the folder of the package to {variable}"


def _what_to_do(kind: str, path: SearchPath, package: str) -> str:
    if path.reads_exports:
        return (
            'Add <gazebo_ros gazebo_model_path="${prefix}/.."/> to <export> in '
            f"package.xml of {package}."
        )
    return (
        f"Add AppendEnvironmentVariable('{VARIABLES[kind][0]}', "
        f"os.path.join(get_package_prefix('{package}'), 'share')) to the launch file, before it "
        "starts Gazebo."
    )


MALFORMED_PARAMETER_FILE = Rule(
    code="LCH099",
    name="malformed-parameter-file",
    severity=Severity.ERROR,
    severity_varies="a warning about a misspelled `ros__parameters`",
    summary="A parameter file or the configuration file of a bridge is not valid.",
    what="Reads the YAML files of a package that contain `ros__parameters`, or topics of a bridge.",
    why="The node that reads the file exits with an error, or gets none of the parameters.",
    example="""
diff_drive_controller:
  ros_parameters:
    wheel_radius: 0.1
""",
    instead="""
diff_drive_controller:
  ros__parameters:
    wheel_radius: 0.1
""",
)

_OF_NODES = (b"ros__param", b"ros_param", b"gz_topic_name", b"ros_topic_name", b"gz_type_name")
_MISSPELLED = lazy_pattern(r"ros_*param(?:eter)?s?")
_TEMPLATE = lazy_pattern(r"\{\{|\{%")
DEEPEST = 8  # namespaces


def malformed_parameter_files(file: Path, content: bytes | None = None) -> Iterator[Diagnostic]:
    """Report a YAML file that a node cannot read.

    `content` is what is in it, where it is not known that a node reads it.
    """
    if content is not None and not any(sign in content for sign in _OF_NODES):
        return
    found = yamlfile.load_parameters(file)
    if isinstance(found, yamlfile.Value):
        yield from _misspelled_sections(file, found)
        return
    if not isinstance(found, yamlfile.NotYaml):
        return
    text = read_text(file) or ""
    if _TEMPLATE.search(text):
        return  # something makes YAML of it
    lines = text.splitlines()
    line = next(
        (
            number
            for number, one in enumerate(lines, 1)
            if "\t" in one[: len(one) - len(one.lstrip())]
        ),
        None,
    )
    yield MALFORMED_PARAMETER_FILE.at(
        file,
        line or found.line,
        message=f"{file.name} is not valid YAML: "
        + ("this line is indented with a tab." if line else f"{found.message.rstrip('.')}."),
        hint="Indent it with spaces, like the lines around it."
        if line
        else "Check indentation, colons, quotes and brackets in this line and the one before.",
    )


def _misspelled_sections(file: Path, value: yamlfile.Value, level: int = 0) -> Iterator[Diagnostic]:
    for key, inner in value.items():
        if key == "ros__parameters":
            continue
        if _MISSPELLED.fullmatch(key) and isinstance(inner.content, dict):
            yield MALFORMED_PARAMETER_FILE.at(
                file,
                inner.line - 1,
                key,
                message=f"ROS does not read parameters below `{key}`: the node does not get them.",
                hint="Write `ros__parameters`, with two underscores.",
                severity=Severity.WARNING,
            )
        elif level < DEEPEST:
            yield from _misspelled_sections(file, inner, level + 1)
