"""A node in Python or C++, with what builds, starts and tests it."""

from __future__ import annotations

from collections.abc import Sequence  # noqa: TC003  a NamedTuple
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import RequestError
from wsgen.model.facts import DISTROS
from wsgen.packages.build_files.python_setup import read_setup
from wsgen.porting.adding.cmake import PROGRAMS, CMake
from wsgen.porting.adding.installing import share
from wsgen.porting.adding.setup_py import add_script
from wsgen.porting.adding.tests import add_test_file
from wsgen.porting.adding.types import check_name, read_parameters, read_topics

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.porting.adding.addition import Addition
    from wsgen.porting.adding.types import Topic

PYTHON, CPP = "python", "cpp"
# ament_target_dependencies() is not there from here on (ament/ament_cmake, CHANGELOG).
_WITHOUT_TARGET_DEPENDENCIES = DISTROS[DISTROS.index("lyrical") :]


class NodeOptions(NamedTuple):
    """What is asked for."""

    language: str = PYTHON
    publishes: Sequence[str] = ()  # TOPIC:TYPE
    subscribes: Sequence[str] = ()
    parameters: Sequence[str] = ()  # NAME:=VALUE
    is_bare: bool = False  # without launch file and test


def add_node(addition: Addition, name: str, options: NodeOptions) -> None:
    """Add a node, its launch file, and a test that runs it live.

    Raises:
        RequestError: A name or type cannot be, or the package is of another language.
    """
    check_name("node", name, is_program=True)
    publishes = read_topics(options.publishes, "--publishes", addition)
    subscribes = read_topics(options.subscribes, "--subscribes", addition)
    parameters = read_parameters(options.parameters)
    names: dict[str, Any] = {
        "node": name,
        "class_name": "".join(word.capitalize() for word in name.split("_")),
        "publishes": publishes,
        "subscribes": subscribes,
        "parameters": parameters,
        "imports": _imports([*publishes, *subscribes], subscribes),
    }
    if options.language == CPP:
        executable = _add_cpp(addition, name, names, [*publishes, *subscribes])
    else:
        executable = _add_python(addition, name, names, [*publishes, *subscribes])
    if options.is_bare:
        return
    addition.depend("exec_depend", "launch", "launch_ros")
    launch = addition.create(
        f"launch/{name}.launch.py", "node.launch.py", executable=executable, **names
    )
    share(addition, launch, "*launch.[pxy][yma]*")
    add_test_file(addition, name, "test_node.py", **names)


def _add_python(
    addition: Addition, name: str, names: dict[str, Any], topics: Sequence[Topic]
) -> str:
    """Its module or program, which is installed; gives the name by which it is run."""
    if addition.is_python:
        target = f"{addition.name}.{name}:main"
        known = {one.name: one for one in read_setup(addition.folder)[0].scripts}
        if name in known and known[name].target.replace(" ", "") != target:
            raise _taken(addition, name, known[name].file, known[name].line)
        if not (addition.folder / addition.name / "__init__.py").exists():
            addition.create(f"{addition.name}/__init__.py", "__init__.py")
        addition.create(f"{addition.name}/{name}.py", "node.py", is_program=False, **names)
        if name not in known:
            add_script(addition, name, target)
        if not (addition.folder / "setup.cfg").exists():
            addition.create("setup.cfg", "setup.cfg")
        executable = name
    else:
        executable = f"{name}.py"
        cmake = CMake(addition)
        folder = _folder_of_programs(cmake)
        found = addition.executable(executable)
        source = "" if found is None or found.source is None else found.source.as_posix()
        if found is not None and not source.endswith(f"/{folder}/{executable}"):
            raise _taken(addition, executable, found.file, found.line)
        path = f"{folder}/{executable}"
        addition.create(path, "node.py", runs=True, is_program=True, **names)
        if found is None:
            cmake.install("PROGRAMS", path, PROGRAMS)
    addition.depend("exec_depend", "rclpy", *_packages(topics))
    return executable


def _imports(topics: Sequence[Topic], subscribes: Sequence[Topic]) -> list[str]:
    """What a node in Python imports, in the order that ament_flake8 asks for."""
    names: dict[str, set[str]] = {}
    for one in topics:
        names.setdefault(f"{one.type.package}.msg", set()).add(one.type.name)
    found = {module: f"from {module} import {', '.join(sorted(names[module]))}" for module in names}
    found |= {
        "rclpy": "import rclpy",
        "rclpy.executors": "from rclpy.executors import ExternalShutdownException",
        "rclpy.node": "from rclpy.node import Node",
    }
    if any(one.type.package == "sensor_msgs" for one in subscribes):
        found["rclpy.qos"] = "from rclpy.qos import qos_profile_sensor_data"
    return [found[module] for module in sorted(found)]


def _packages(topics: Iterable[Topic]) -> list[str]:
    return sorted({one.type.package for one in topics})


def _taken(addition: Addition, executable: str, file: Path, line: int) -> RequestError:
    """The error for a name that another program has."""
    return RequestError(
        f"The package {addition.name} has another program `{executable}` already: "
        f"{file.name}:{line}.",
        hint="Choose another name.",
    )


def _folder_of_programs(cmake: CMake) -> str:
    """Where the programs in Python are that the package installs."""
    for command in reversed(cmake.calls("install")):
        words = [one.text for one in command.arguments]
        if words[:1] == ["PROGRAMS"]:
            for word in words[1:]:
                folder, slash, file = word.rpartition("/")
                if slash and file.endswith(".py") and "$" not in folder:
                    return folder.removeprefix("./")
    return "scripts"


def _add_cpp(addition: Addition, name: str, names: dict[str, Any], topics: Sequence[Topic]) -> str:
    """Its source, which is compiled and installed; gives the name by which it is run."""
    if addition.is_python:
        raise RequestError(
            f"{addition.name} is a package of the build type ament_python, which compiles nothing.",
            hint="Add it to a package of ament_cmake with --to, or create one: "
            f"ros2 pkg create {addition.name}_cpp --build-type ament_cmake",
        )
    cmake = CMake(addition)
    file = f"src/{name}.cpp"
    targets = {
        command.arguments[0].text: command
        for command in cmake.calls("add_executable", "ament_auto_add_executable", "add_library")
        if command.arguments
    }
    known = targets.get(name)
    if known is not None and file not in {one.text for one in known.arguments}:
        raise RequestError(
            f"CMakeLists.txt has another target `{name}` already, line "
            f"{cmake.source.line_at(known.start)}.",
            hint="Choose another name.",
        )
    addition.create(file, "node.cpp", **names)
    packages = ["rclcpp", *_packages(topics)]
    addition.depend("depend", *packages)
    if known is None:
        cmake.compile("CXX")
        cmake.find(*packages)
        text = _target(cmake, name, file, packages)
        cmake.add(text, cmake.below_targets(text), "Add it below the other targets.")
    facts, _ = addition.facts()
    if name not in {one.name for one in facts.executables} and not cmake.uses_auto():
        cmake.install("TARGETS", name, PROGRAMS)
    return name


def _target(cmake: CMake, name: str, file: str, packages: Sequence[str]) -> str:
    """The commands that compile a node."""
    if cmake.uses_auto():
        return f"ament_auto_add_executable({name} {file})"
    lines = [f"add_executable({name} {file})"]
    addition = cmake.addition
    others = [one for one in packages if one != addition.name]
    is_dated = addition.target.distro in _WITHOUT_TARGET_DEPENDENCIES
    if cmake.calls("ament_target_dependencies") and not is_dated:
        lines.append(f"ament_target_dependencies({name} {' '.join(others)})")
    else:
        linked = ["rclcpp::rclcpp", *(f"${{{one}_TARGETS}}" for one in others[1:])]
        lines.append(f"target_link_libraries({name} {' '.join(linked)})")
    if addition.name in packages:
        interfaces = cmake.calls("rosidl_generate_interfaces")
        target = interfaces[0].arguments[0].text if interfaces else "${PROJECT_NAME}"
        variable = "cpp_typesupport_target"
        lines += [
            f"rosidl_get_typesupport_target({variable} {target} rosidl_typesupport_cpp)",
            f'target_link_libraries({name} "${{{variable}}}")',
        ]
    return "\n".join(lines)
