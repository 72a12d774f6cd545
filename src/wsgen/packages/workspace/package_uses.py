"""Which packages the files of a package use at run time, and where: launch files, robots, nodes.

Files are read and not run. What is computed, what is tried and may fail, and what depends on the
distribution is left out.
"""

from __future__ import annotations

import ast
import os
import re
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from wsgen.gazebo.plugins import OF_CLASSIC
from wsgen.packages.imported_packages import (
    MESSAGES,
    certain_nodes,
    imported_modules,
    is_beside,
    misspelled_module,
    name_of,
    packages_of_imports,
    packages_of_launch_file,
)
from wsgen.text.files import irregular_kind, real_path
from wsgen.text.markup import read_text, without_comments
from wsgen.text.pythontree import parse
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

    from wsgen.model.build_facts import BuildFacts


LAUNCH = "launch"  # a launch file looks it up or starts a program of it
DESCRIPTION = "description"  # a robot or a world has files of it
NODE = "node"  # a Python file imports it
PLUGIN = "plugin"  # a robot or a world loads a plugin of it into Gazebo
CONTROLLER = "controller"  # a file of parameters names a controller of it


class PackageUse(NamedTuple):
    """A place where a package is needed."""

    package: str
    file: Path
    line: int  # 1-based
    kind: str  # LAUNCH, DESCRIPTION, NODE, PLUGIN or CONTROLLER


# Folders whose files nobody needs at run time.
NOT_RUN = frozenset(
    ("test", "tests", "doc", "docs", "build", "install", "log", "__pycache__", "node_modules")
)
DESCRIPTIONS = (".urdf", ".xacro", ".gazebo", ".ros2_control", ".sdf", ".world", ".rviz")
LAUNCH_MARKUP = ("launch.xml", "launch.yaml", "launch.yml")
PARAMETERS = (".yaml", ".yml")
NOT_NODES = frozenset(("setup.py", "conf.py", "conftest.py", "noxfile.py"))
_READ = (".py", *DESCRIPTIONS, *LAUNCH_MARKUP, *PARAMETERS)
SIZE_LIMIT = 2**20  # bytes of a file; worlds may be large, and name no package then


def find_files(folder: Path) -> Iterator[Path]:
    """The files of a package that may use another one, by path; not those of packages in it."""
    for name, folders, files in os.walk(folder):
        here = type(folder)(name)
        if here != folder and ("package.xml" in files or "COLCON_IGNORE" in files):
            folders.clear()
            continue
        folders[:] = sorted(
            one for one in folders if not one.startswith(".") and one.lower() not in NOT_RUN
        )
        for base in sorted(files):
            if base.endswith(_READ) and base not in NOT_NODES:
                file = here / base
                if irregular_kind(file) is None:
                    yield file


def read_uses(
    files: Iterable[Path], *, workspace: Collection[str], installed: Collection[Path] | None = None
) -> tuple[PackageUse, ...]:
    """The first use of each package in each file, in the order of the files.

    Args:
        files: of a package.
        workspace: the names of all packages of the workspace.
        installed: the files and folders that are installed, without links; None where that is not
            known. Others are not read.
    """
    places = None if installed is None else frozenset(map(str, installed))
    return tuple(
        use
        for file in files
        if places is None or _is_in(file, places)
        for use in _first_uses(_uses_in(file, workspace))
    )


def _first_uses(uses: Iterable[PackageUse]) -> Iterable[PackageUse]:
    first: dict[str, PackageUse] = {}
    for use in uses:
        first.setdefault(use.package, use)
    return first.values()


def _uses_in(file: Path, workspace: Collection[str]) -> Iterator[PackageUse]:
    text = read_text(file)
    if text is None or len(text) > SIZE_LIMIT:
        return
    if file.name.endswith(".py"):
        yield from _uses_of_python(file, text, workspace, is_launch=is_launch_file(file))
    elif file.name.endswith(LAUNCH_MARKUP):
        for package, line in looked_up_in_markup(without_comments(text)):
            yield PackageUse(package, file, line, LAUNCH)
    elif file.name.endswith(PARAMETERS):
        for package, line in _matches(_CONTROLLER_TYPE, text):
            yield PackageUse(package, file, line, CONTROLLER)
    elif any(sign in text for sign in _SIGNS):  # worlds may be large
        text = without_comments(text)
        for package, line in _matches(_IN_DESCRIPTION, text):
            yield PackageUse(package, file, line, DESCRIPTION)
        for package, line in _plugins(text):
            yield PackageUse(package, file, line, PLUGIN)


def is_launch_file(file: Path) -> bool:
    """Whether a Python file is a launch file, or a part of one."""
    return file.name.endswith("launch.py") or "launch" in file.parts[-3:-1]


def _uses_of_python(
    file: Path, text: str, workspace: Collection[str], *, is_launch: bool
) -> Iterator[PackageUse]:
    if "import" not in text:
        return
    try:
        reader = _PythonReader(parse(text.encode()))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    if is_launch:
        for package, line in reader.looked_up():
            yield PackageUse(package, file, line, LAUNCH)
    read = packages_of_launch_file if is_launch else packages_of_imports
    for package, line in read(file, reader.nodes, workspace):
        yield PackageUse(package, file, line, LAUNCH if is_launch else NODE)
    for module, line in () if is_launch else imported_modules(reader.nodes):
        meant = misspelled_module(module, workspace)
        if meant is not None and not is_beside(module, file):
            yield PackageUse(meant, file, line, NODE)


def _is_in(file: Path, places: Collection[str]) -> bool:
    real = real_path(file)
    while real not in places:
        folder = os.path.dirname(real)  # noqa: PTH120  of many
        if folder == real:
            return False
        real = folder
    return True


# Python.

_LOOK_UPS = frozenset(
    (
        *("get_package_share_directory", "get_package_share_path", "get_package_prefix"),
        *("FindPackageShare", "FindPackagePrefix", "FindPackage"),
    )
)
_STARTERS = frozenset(
    (
        *("Node", "LifecycleNode", "ComposableNode", "ComposableNodeContainer"),
        *("ExecutableInPackage", "MoveItConfigsBuilder"),
    )
)
_XACRO = lazy_pattern(r"xacro(?:\s|$)")


class _PythonReader:
    """What surely happens when a Python file is run, as far as it is about packages."""

    def __init__(self, tree: ast.Module) -> None:
        self.tree = tree
        self.nodes = certain_nodes(tree, [])

    @cached_property
    def constants(self) -> dict[str, str]:
        """The texts of names that are assigned once."""
        return _constants(self.tree)

    def looked_up(self) -> Iterator[tuple[str, int]]:
        """The packages whose folders or programs a launch file needs."""
        for node in self.nodes:
            if not isinstance(node, ast.Call):
                continue
            name = name_of(node.func)
            if name in _LOOK_UPS or name in _STARTERS:
                for value in _packages_of(node, name):
                    package = self._text(value)
                    if package and re.fullmatch(r"[\w-]+", package):
                        yield package, value.lineno
            elif name in {"Command", "FindExecutable", "ExecuteProcess"}:
                first = _first_word(node)
                if first is not None and self._is_xacro(first):
                    yield "xacro", first.lineno

    def _is_xacro(self, first: ast.expr) -> bool:
        return _XACRO.match(self._text(first) or "") is not None

    def _text(self, value: ast.expr) -> str | None:
        if isinstance(value, ast.Name):
            return self.constants.get(value.id)
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            return value.value
        return None


def _constants(tree: ast.Module) -> dict[str, str]:
    values: dict[str, set[str | None]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            is_text = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
            for target in node.targets:
                for name in ast.walk(target):
                    if isinstance(name, ast.Name):
                        text = node.value.value if is_text and name is target else None  # type: ignore[attr-defined]
                        values.setdefault(name.id, set()).add(text)
        elif isinstance(node, (ast.For, ast.AugAssign, ast.AnnAssign, ast.comprehension)):
            for name in ast.walk(node.target):
                if isinstance(name, ast.Name):
                    values.setdefault(name.id, set()).add(None)
        elif isinstance(node, ast.arg):
            values.setdefault(node.arg, set()).add(None)
    return {
        name: text
        for name, texts in values.items()
        if len(texts) == 1 and (text := next(iter(texts))) is not None
    }


def _packages_of(call: ast.Call, name: str) -> Iterator[ast.expr]:
    """The arguments that name packages."""
    keyword = "package_name" if name == "MoveItConfigsBuilder" else "package"
    for one in call.keywords:
        if one.arg in {keyword, "package_name"}:
            yield one.value
    if name in _LOOK_UPS:
        yield from call.args[:1]


def _first_word(call: ast.Call) -> ast.expr | None:
    """What a command line begins with."""
    values = [
        *call.args,
        *(one.value for one in call.keywords if one.arg in {"cmd", "name", "command"}),
    ]
    value = values[0] if values else None
    while isinstance(value, (ast.List, ast.Tuple)) and value.elts:
        value = value.elts[0]
    return value


# Markup.

_IN_LAUNCH = lazy_pattern(
    r"\$\(find-pkg-(?:share|prefix)\s+([\w-]+)\s*\)|\$\(exec-in-package\s+\S+\s+([\w-]+)\s*\)"
    r"|\bpkg\s*=\s*[\"']([\w-]+)[\"']|^\s*-?\s*pkg:\s*[\"']?([\w-]+)[\"']?\s*$",
    re.MULTILINE,
)
_COMMAND = lazy_pattern(r"\$\(command\s+[\"']?(?:\$\(find-exec\s+)?xacro\b")
_SIGNS = ("package://", "$(find ", "_ros2_control", "libgazebo_ros_")
_IN_DESCRIPTION = lazy_pattern(r"\$\(find\s+([\w-]+)\s*\)|\bpackage://([\w-]+)/")


def looked_up_in_markup(text: str) -> Iterator[tuple[str, int]]:
    """The packages that a launch file of XML or YAML needs, by line."""
    yield from _matches(_IN_LAUNCH, text)
    found = _COMMAND.search(text)
    if found:
        yield "xacro", text.count("\n", 0, found.start()) + 1


# Controllers of ros2_control: `type: diff_drive_controller/DiffDriveController`.
_CONTROLLER_TYPE = lazy_pattern(
    r"^[ \t]*type:[ \t]*[\"']?(\w+_(?:controllers?|broadcaster))/\w+", re.MULTILINE
)
_CONTROL_PLUGIN = lazy_pattern(
    r"\blib((?:gazebo|gz|ign)_ros2_control)(?:-system)?\.so\b"
    r"|\b((?:gz|ign)_ros2_control)-system\b|>\s*((?:gazebo|gz|ign)_ros2_control)/\w+\s*<"
)
_CLASSIC_PLUGIN = lazy_pattern(r"\blib(gazebo_ros_\w+)\.so\b")
_OF_GAZEBO_ROS = frozenset(
    f"gazebo_ros_{name}" for name in ("init", "factory", "force_system", "state", "properties")
)


def _plugins(text: str) -> Iterator[tuple[str, int]]:
    """The packages of which Gazebo loads plugins."""
    if "_ros2_control" in text:
        yield from _matches(_CONTROL_PLUGIN, text)
    for name, line in _matches(_CLASSIC_PLUGIN, text):
        # Others are of ROS 1, or somebody's own, and gazebo_plugins does not have them.
        if name in OF_CLASSIC:
            yield "gazebo_ros" if name in _OF_GAZEBO_ROS else "gazebo_plugins", line


def _matches(pattern: re.Pattern[str], text: str) -> Iterator[tuple[str, int]]:
    for found in pattern.finditer(text):
        package = next(filter(None, found.groups()))
        yield package, text.count("\n", 0, found.start(found.lastindex or 0)) + 1


def installed_places(build: BuildFacts | None) -> frozenset[Path] | None:
    """The files and folders that a package installs, without links; None if some are unknown."""
    if build is None or not build.is_whole:
        return None
    sources = (
        *(one.source for one in build.installed),
        *(one.source for one in build.executables),
        *(one.source for one in build.python_packages),
    )
    return frozenset(type(one)(real_path(one)) for one in sources if one is not None)


# Packages that nothing but code uses; others may be declared for who starts something by hand.
_CLIENTS = frozenset(("cv_bridge", "image_transport", "pcl_conversions", "rclcpp", "rclpy"))
# What generates messages and actions needs them, and names them nowhere.
_OF_ACTIONS = frozenset(
    ("action_msgs", "builtin_interfaces", "service_msgs", "unique_identifier_msgs")
)
_TEXTS = frozenset(
    (
        *(".c", ".cc", ".cfg", ".cmake", ".cpp", ".cxx", ".em", ".h", ".hh", ".hpp", ".hxx"),
        *(".action", ".idl", ".in", ".ipp", ".json", ".launch", ".msg", ".py", ".rs", ".rviz"),
        *(".sdf", ".sh", ".srv", ".toml", ".tpp", ".txt", ".urdf", ".world", ".xacro", ".xml"),
        *(".yaml", ".yml"),
    )
)
_MOST_FILES = 200  # to read for what may be unused


def is_for_code(package: str) -> bool:
    """Whether only code uses a package: messages and libraries of nodes."""
    return package in _CLIENTS or (
        package.endswith(MESSAGES)
        and package not in _OF_ACTIONS
        and not package.endswith("hardware_interfaces")
    )


def unmentioned(folder: Path, names: Collection[str]) -> frozenset[str]:
    """The names that no file of a package has, package.xml aside; none where that is not sure."""
    left = set(names)
    count = 0
    for place, folders, files in os.walk(folder):
        folders[:] = [one for one in folders if not one.startswith(".")]
        for base in files:
            file = type(folder)(place, base)
            if not left or (base == "package.xml" and file.parent == folder):
                continue
            if file.suffix and file.suffix not in _TEXTS:
                continue
            count += 1
            text = read_text(file) if count <= _MOST_FILES else None
            if text is None:
                return frozenset()
            left = {name for name in left if name not in text}
    return frozenset(left)
