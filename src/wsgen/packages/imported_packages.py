"""The packages whose Python modules a file surely imports, read without running it."""

from __future__ import annotations

import ast
import re
import sys
from functools import cache
from typing import TYPE_CHECKING

from wsgen.ros.names import released_packages
from wsgen.text.suggestions import misspelled_as
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path


# Modules that ros2launch brings: who reads a launch file has them.
OF_LAUNCH = frozenset(
    (
        "ament_index_python",
        "launch",
        "launch_ros",
        "launch_xml",
        "launch_yaml",
        "rclpy",
        "osrf_pycommon",
    )
)
_UNKNOWN_TEST = lazy_pattern(r"distro|environ|getenv|version|exists|isfile|isdir", re.IGNORECASE)

# Python packages of ROS whose modules have the name of the package; those of messages come by
# their endings, as many other names are those of modules on PyPI, too.
MODULES = frozenset(
    (
        *("ament_index_python", "controller_manager", "cv_bridge", "diagnostic_updater"),
        *("image_geometry", "launch", "launch_param_builder", "launch_ros", "launch_testing"),
        *("launch_testing_ros", "laser_geometry", "message_filters", "moveit_configs_utils"),
        *("nav2_common", "nav2_simple_commander", "py_trees_ros", "python_qt_binding"),
        *("qt_gui", "rclpy", "rosbag2_py", "rosidl_runtime_py", "rqt_gui", "rqt_gui_py"),
        *("sensor_msgs_py", "tf2_py", "tf2_ros", "tf_transformations", "xacro"),
    )
)
OTHER_MODULES = {"moveit": "moveit_py", "urdf_parser_py": "urdfdom_py"}
# Of these, those that nodes import, and whose names are misspelled.
OF_NODES = (
    *("ament_index_python", "cv_bridge", "launch", "launch_ros", "message_filters", "rclpy"),
    *("sensor_msgs_py", "tf2_geometry_msgs", "tf2_ros", "tf_transformations"),
)
OF_INTERFACES = ("_msgs", "_srvs", "_interfaces", "_actions")
MESSAGES = ("_msgs", "_interfaces", "_srvs", "_msg", "_actions")


def package_of_module(module: str, workspace: Collection[str]) -> str | None:
    """The package that surely has a Python module; None for modules of Python, PyPI and others."""
    if module in workspace and module not in OTHER_MODULES:
        return module
    package = OTHER_MODULES.get(module, module)
    if module in MODULES or module in OTHER_MODULES or module.endswith(MESSAGES):
        return package if package in released_packages() else None
    return None


def misspelled_module(module: str, workspace: Collection[str]) -> str | None:
    """The package that nodes import, of whose name this one is surely a misspelling."""
    if module in released_packages() or module in workspace:
        return None
    if module in sys.stdlib_module_names:
        return None
    return misspelled_as(module, (*workspace, *OF_NODES, *_interfaces()))


@cache
def _interfaces() -> tuple[str, ...]:
    return tuple(one for one in released_packages() if one.endswith(OF_INTERFACES))


def is_beside(module: str, file: Path) -> bool:
    """Whether a module is one of the package itself."""
    place = file.parent / module
    return module in file.parts[:-1] or place.is_dir() or place.with_suffix(".py").is_file()


def certain_nodes(tree: ast.AST, found: list[ast.AST]) -> list[ast.AST]:
    """Add calls and imports in the order of the text, but what is tried, or under a condition.

    Most of what a check costs Python goes through here: no generators, nothing for names and texts.
    """
    for name in tree._fields:
        value = getattr(tree, name, None)
        for child in value if value.__class__ is list else (value,):
            kind = child.__class__
            if kind in _LEAVES or not isinstance(child, ast.AST) or _is_uncertain(child):
                continue
            if kind in _WANTED:
                found.append(child)
            certain_nodes(child, found)
    return found


_WANTED = frozenset((ast.Call, ast.Import, ast.ImportFrom))
_LEAVES = frozenset((ast.Constant, ast.Load, ast.Name, ast.Store, ast.alias, str, type(None)))


def _is_uncertain(node: ast.AST) -> bool:
    """Whether what is in it may fail, or depends on where it runs."""
    if isinstance(node, ast.Try):
        return bool(node.handlers)
    return isinstance(node, ast.If) and (
        name_of(node.test) == "TYPE_CHECKING"
        or _UNKNOWN_TEST.search(ast.unparse(node.test)) is not None
    )


def name_of(node: ast.AST) -> str:
    """The last word of a name or an attribute; empty for others."""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def imported_modules(nodes: Iterable[ast.AST]) -> Iterator[tuple[str, int]]:
    """The names of top-level modules, and the 1-based lines of their imports."""
    for node in nodes:
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name.partition(".")[0], node.lineno
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.partition(".")[0], node.lineno


def packages_of_launch_file(
    file: Path, nodes: Iterable[ast.AST], workspace: Collection[str]
) -> Iterator[tuple[str, int]]:
    """The packages that a launch file imports, without those that ros2launch brings."""
    for package, line in packages_of_imports(file, nodes, workspace):
        if package not in OF_LAUNCH:
            yield package, line


def packages_of_imports(
    file: Path, nodes: Iterable[ast.AST], workspace: Collection[str]
) -> Iterator[tuple[str, int]]:
    """The packages of what a Python file imports, and the lines; not its own modules.

    Args:
        file: the Python file.
        nodes: of its syntax tree, from `certain_nodes`.
        workspace: the names of packages that may have a module of their name.
    """
    for module, line in imported_modules(nodes):
        owner = package_of_module(module, workspace)
        if owner is not None and not is_beside(module, file):
            yield owner, line
