"""Explain names in a launch file that are not imported, misspelled or not of the launch API.

Like the other explainers, it runs in the child process and only when there is something to report.
"""

from __future__ import annotations

import ast
import builtins
import importlib
import inspect
import re
import sys
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.explain_missing import Explanation, nodes_of, packages
from wsgen.launching.known_packages import KNOWN_MODULES, SURELY
from wsgen.launching.record import RECORD
from wsgen.text.suggestions import advice, did_you_mean, nearest

if TYPE_CHECKING:
    from types import FrameType, TracebackType


IMPORT_ERROR = Rule(
    code="LCH002",
    name="launch-import",
    severity=Severity.ERROR,
    severity_varies="information of `wsgen check` where the package has no such module",
    summary="The launch file imports a module that is not installed.",
    why="Python raises an ImportError, and `ros2 launch` starts nothing.",
    example="from lanuch import LaunchDescription",
    instead="from launch import LaunchDescription",
)
NO_LAUNCH_FUNCTION = Rule(
    code="LCH003",
    name="no-launch-function",
    severity=Severity.ERROR,
    summary="The launch file does not define `generate_launch_description()`.",
    why="`ros2 launch` calls this function, and refuses a file without it.",
    example="def generate_launch_desciption():\n    return LaunchDescription([])",
    instead="def generate_launch_description():\n    return LaunchDescription([])",
)
RAISES = Rule(
    code="LCH004",
    name="launch-raises",
    severity=Severity.ERROR,
    severity_varies="information of `wsgen check` where it lacks a device, such as a serial port",
    summary="The launch file raises an exception.",
    why="`ros2 launch` stops with the same exception and starts nothing.",
    example="import os\npath = os.path.jion(share, 'model')",
    instead="import os\npath = os.path.join(share, 'model')",
)
REFUSED_BY_LAUNCH = Rule(
    code="LCH010",
    name="refused-by-launch",
    severity=Severity.ERROR,
    severity_varies="information of `wsgen check` where an argument is empty by default",
    summary="`launch` refuses a value that the launch file gives to it.",
    what="Checks the types, the order and the values of arguments as `launch` and `launch_ros` do.",
    why="`ros2 launch` raises an error, at once or when it comes to the action.",
    example="Node(package='rviz2', executable='rviz2', parameters={'use_sim_time': True})",
    instead="Node(package='rviz2', executable='rviz2', parameters=[{'use_sim_time': True}])",
)
UNSUPPORTED_API = Rule(
    code="LCH017",
    name="unsupported-launch-api",
    severity=Severity.ERROR,
    severity_varies="information of `wsgen check` where it may be correct",
    summary="The launch file uses a part of the launch API that wsgen does not know.",
    what="Compares what is imported from `launch`, `launch_ros` and `ament_index_python` with the "
    "names in docs/launch.md.",
    why="Most often the name is misspelled, and `ros2 launch` fails in the same way. wsgen "
    "cannot evaluate what it does not know.",
    example="from launch.actions import Node",
    instead="from launch_ros.actions import Node",
)
OLD_KEYWORD = Rule(
    code="LCH022",
    name="old-keyword",
    severity=Severity.ERROR,
    summary="A node is described with keyword arguments that were removed in ROS 2 Galactic.",
    why="`Node` raises a TypeError for `node_executable`, `node_name` and `node_namespace`, and "
    "the launch stops.",
    example="Node(package='rviz2', node_executable='rviz2', node_name='view')",
    instead="Node(package='rviz2', executable='rviz2', name='view')",
)
UNDEFINED_NAME = Rule(
    code="LCH030",
    name="undefined-name",
    severity=Severity.ERROR,
    summary="The launch file uses a name that it neither defines nor imports.",
    why="Python raises a NameError, and `ros2 launch` starts nothing.",
    example="from launch import LaunchDescription\n\n"
    "def generate_launch_description():\n"
    "    return LaunchDescription([Node(package='rviz2', executable='rviz2')])",
    instead="from launch import LaunchDescription\n"
    "from launch_ros.actions import Node\n\n"
    "def generate_launch_description():\n"
    "    return LaunchDescription([Node(package='rviz2', executable='rviz2')])",
)
INVALID_KEYWORD = Rule(
    code="LCH031",
    name="invalid-keyword",
    severity=Severity.ERROR,
    summary="A keyword argument of a class of the launch API is missing or unknown.",
    why="Python raises a TypeError, and `ros2 launch` starts nothing.",
    example="Node(package='rviz2', excutable='rviz2')",
    instead="Node(package='rviz2', executable='rviz2')",
)
# Modules that launch files import from. Of a name that several have, the first is meant.
API = (
    "launch",
    "launch.actions",
    "launch.substitutions",
    "launch.conditions",
    "launch.event_handlers",
    "launch.launch_description_sources",
    "launch.events",
    "launch.events.process",
    "launch.utilities",
    "launch_ros",
    "launch_ros.actions",
    "launch_ros.substitutions",
    "launch_ros.parameter_descriptions",
    "launch_ros.descriptions",
    "launch_ros.event_handlers",
    "launch_ros.events",
    "launch_ros.events.lifecycle",
    "ament_index_python.packages",
    "ament_index_python",
    "ament_index_python.resources",
)
API_PACKAGES = frozenset(
    ("launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python")
)
# Other names that launch files use, and where they come from; modules are imported themselves.
ELSEWHERE = {"Path": "pathlib", "join": "os.path", "dirname": "os.path", "exists": "os.path"}
MODULES = frozenset(("xacro", "yaml", "launch", "launch_ros", "ament_index_python"))
LONGEST = 80  # characters of a value
# What launch files of XML and YAML call it -> the keyword in Python.
_OF_MARKUP = {
    "args": "arguments",
    "exec": "executable",
    "ns": "namespace",
    "param": "parameters",
    "params": "parameters",
    "pkg": "package",
    "remap": "remappings",
    "type": "executable",
}
REMOVED = frozenset(("node_executable", "node_name", "node_namespace"))  # keywords of Foxy


def import_line(name: str) -> str | None:
    """The import statement that launch files need for a name; None where it is not known."""
    if name in MODULES or (name in sys.stdlib_module_names and not name.startswith("_")):
        return f"import {name}"
    homes = (module for module in API if name in _public_names(module))
    home = ELSEWHERE[name] if name in ELSEWHERE else next(homes, None)
    return None if home is None else f"from {home} import {name}"


def _public_names(module: str) -> set[str]:
    """The classes and functions that a module of the launch API has for launch files."""
    loaded = importlib.import_module(module)
    listed = getattr(loaded, "__all__", None)
    if listed is None:
        return {
            name
            for name, value in vars(loaded).items()
            if inspect.isclass(value) or inspect.isfunction(value)
            if value.__module__ == module and not name.startswith("_")
        }
    return {name for name in listed if f"{module}.{name}" not in API}


def _importable_names() -> set[str]:
    return {name for module in API for name in _public_names(module)} | {*ELSEWHERE, *MODULES}


def of_name(error: BaseException) -> Explanation | None:
    """A name that is neither defined nor imported."""
    if type(error) is not NameError or not isinstance(getattr(error, "name", None), str):
        return None
    name = str(error.name)
    statement = import_line(name)
    if statement is not None:
        return Explanation(
            UNDEFINED_NAME,
            f"{error}: the launch file does not import `{name}`.",
            f"Add `{statement}` at the top of the file.",
            element=name,
        )
    if name == RECORD.package or name in packages():
        return Explanation(
            UNDEFINED_NAME,
            f"{error}: it is the name of {'this' if name == RECORD.package else 'a'} package, and "
            "has no quotes.",
            f"Put quotes around it: '{name}'.",
            element=name,
        )
    if name in {"true", "false"} and _last_file(error) not in RECORD.launch_files:
        return Explanation(
            UNDEFINED_NAME,
            f"`PythonExpression` gets `{name}`, which is not a Python name: {error}.",
            f"Write {name.title()} as the value of the argument, or compare its text: "
            f"""PythonExpression(["'", LaunchConfiguration(NAME), "' == '{name}'"]).""",
            element=name,
        )
    known = _visible_names(error)
    near = nearest(name, {*known, *_importable_names()})
    hint = "Check the spelling, define it above this line, or, if it is text, put quotes around it."
    if near is not None:
        missing = None if near in known else import_line(near)
        hint = did_you_mean(near) + (f" Add `{missing}` at the top." if missing else "")
    return Explanation(UNDEFINED_NAME, f"{error}.", hint, element=name)


def _visible_names(error: BaseException) -> set[str]:
    """The names that could be used where the exception was raised."""
    frame = _last_frame(error.__traceback__)
    scopes = () if frame is None else (frame.f_locals, frame.f_globals)
    return {
        name for scope in (*scopes, vars(builtins)) for name in scope if not name.startswith("_")
    }


def _last_file(error: BaseException) -> str | None:
    frame = _last_frame(error.__traceback__)
    return None if frame is None else frame.f_code.co_filename


def _last_frame(step: TracebackType | None) -> FrameType | None:
    while step is not None and step.tb_next is not None:
        step = step.tb_next
    return None if step is None else step.tb_frame


def of_import(error: BaseException) -> Explanation | None:
    """A module that is not there, or has no such name."""
    if not isinstance(error, ImportError):
        return None
    module = error.name or ""
    named = re.match(r"cannot import name '(\w+)'", str(error))
    if named is not None and module.partition(".")[0] in API_PACKAGES:
        return _no_such_name(module, named[1])
    if module.partition(".")[0] in API_PACKAGES and "." in module:
        return Explanation(
            UNSUPPORTED_API,
            f"The launch API has no module `{module}`, as far as wsgen knows it.",
            advice(module, API, "Check the spelling."),
            element=module,
        )
    names = {*MODULES, *KNOWN_MODULES, *sys.stdlib_module_names}
    word, otherwise = module, f"Install '{module}' into the Python that runs wsgen."
    if named is not None and module in sys.modules:
        word, names = named[1], set(dir(sys.modules[module]))
        otherwise = f"Correct the import, or define '{word}' in {module}."
    said = re.sub(r" \(/.*\)$", "", str(error))  # without the file of the module
    return Explanation(
        IMPORT_ERROR,
        f"The launch file cannot import this: {said}.",
        advice(
            word,
            [name for name in names if not name.startswith("_")],
            otherwise,
            cutoff=SURELY,
        ),
        element=error.name,
    )


def _no_such_name(module: str, name: str) -> Explanation:
    """A name that a module of the launch API does not have."""
    here = {other for other in dir(importlib.import_module(module)) if not other.startswith("_")}
    here.update(_public_names(module))
    statement = import_line(name)
    near = nearest(name, here) or nearest(name, _importable_names())
    is_same = near is not None and near.casefold() == name.casefold()
    hint = (
        "Check the spelling. wsgen cannot evaluate names of the launch API that it does not know."
    )
    if statement is not None:
        hint = f"Write `{statement}`."
    elif near in here:
        hint = did_you_mean(near)
    elif near is not None:
        hint = did_you_mean(import_line(near) or near)
    return Explanation(
        UNSUPPORTED_API,
        f"`{module}` has no `{name}`{'' if is_same else ', as far as wsgen knows the launch API'}.",
        hint,
        element=name,
    )


def of_attribute(error: BaseException) -> Explanation | None:
    """An attribute that a module or object does not have."""
    if not isinstance(error, AttributeError) or not isinstance(error.name, str):
        return None
    owner = error.obj
    if inspect.ismodule(owner) and owner.__name__.partition(".")[0] in API_PACKAGES:
        return _no_such_name(owner.__name__, error.name)
    if owner is None:
        return None
    near = nearest(error.name, [name for name in dir(owner) if not name.startswith(("_", "wsgen"))])
    if near is None:
        return None
    return Explanation(
        RAISES,
        f"The launch file raises AttributeError: {error}.",
        did_you_mean(near),
        element=error.name,
    )


def of_keyword(error: BaseException) -> Explanation | None:
    """A keyword argument that a class of the launch API does not have, or one that it lacks."""
    text = str(error)
    unexpected = re.match(r"(\w+)\.__init__\(\) got an unexpected keyword argument '(\w+)'", text)
    missing = re.match(r"(\w+)\.__init__\(\) missing \d+ required [\w -]+: '(\w+)'", text)
    found = unexpected or missing
    if found is None or not isinstance(error, TypeError):
        return None
    place = _user_step(error)
    if place is None:
        return None
    made = None if place.tb_next is None else place.tb_next.tb_frame.f_locals.get("self")
    name = found[1] if made is None else type(made).__name__
    file, line = place.tb_frame.f_code.co_filename, place.tb_lineno
    given = _keywords(file, line, name)
    owner = type(made) if made is not None else place.tb_frame.f_globals.get(name)
    known = _parameters(owner) if isinstance(owner, type) else set()
    unknown = [keyword for keyword in given if keyword not in known] if known else []
    keyword = unexpected[2] if unexpected else next(iter(unknown), None)
    if keyword is None:
        return Explanation(
            INVALID_KEYWORD,
            f"`{name}` is not given `{found[2]}`, which it requires.",
            f"Add `{found[2]}=...` to its arguments.",
            file,
            line,
            name,
        )
    said = f"`{name}` has no argument `{keyword}`" + (f" ({text})" if missing else "")
    if keyword in REMOVED:
        return Explanation(
            OLD_KEYWORD,
            f"{said}.",
            "Write executable, name and namespace; node_executable, node_name and node_namespace "
            "were removed in Galactic.",
            file,
            given.get(keyword, line),
            keyword,
        )
    free = known - given.keys()
    in_python = _OF_MARKUP.get(keyword)
    near = in_python if in_python in free else nearest(keyword, free)
    return Explanation(
        INVALID_KEYWORD,
        f"{said}.",
        did_you_mean(near) if near else f"Use one of {', '.join(sorted(known))}.",
        file,
        given.get(keyword, line),
        keyword,
    )


def _user_step(error: BaseException) -> TracebackType | None:
    """The deepest step of the traceback that is in a launch file."""
    found, step = None, error.__traceback__
    while step is not None:
        if step.tb_frame.f_code.co_filename in RECORD.launch_files:
            found = step
        step = step.tb_next
    return found


def _parameters(owner: type) -> set[str]:
    """The keyword arguments of a class, those of its bases included."""
    names: set[str] = set()
    for base in owner.__mro__:
        if "__init__" in vars(base) and base is not object:
            parameters = inspect.signature(vars(base)["__init__"]).parameters.values()
            names.update(one.name for one in parameters if one.kind is not one.VAR_KEYWORD)
        names.update(getattr(base, "wsgen_keywords", ()))
    return names - {"self", "args", "kwargs"}


def _keywords(file: str, line: int, name: str) -> dict[str, int]:
    """The keyword arguments of the call of a class at a line, with their lines."""
    calls = [
        node
        for node in nodes_of(file)
        if isinstance(node, ast.Call)
        and node.lineno <= line <= (node.end_lineno or node.lineno)
        and ast.unparse(node.func).rpartition(".")[2] == name
    ]
    if not calls:
        return {}
    innermost = min(calls, key=lambda call: (call.end_lineno or call.lineno) - call.lineno)
    return {one.arg: one.value.lineno for one in innermost.keywords if one.arg is not None}


def of_returned(error: BaseException) -> Explanation | None:
    """A function generate_launch_description() that gives no description."""
    returned = re.match(r"generate_launch_description\(\) must return.*returned (.*)", str(error))
    if returned is None:
        return None
    file, line = vars(error).get("wsgen_location", (None, None))
    message = "generate_launch_description() must return a LaunchDescription"
    function = next(
        (
            node
            for node in nodes_of(file or "")
            if isinstance(node, ast.FunctionDef) and node.lineno == line
        ),
        None,
    )
    if returned[1] != "None" or function is None:
        what = returned[1][:LONGEST] + ("..." if len(returned[1]) > LONGEST else "")
        return Explanation(
            REFUSED_BY_LAUNCH,
            f"{message}, but returns {what}.",
            "Write `return LaunchDescription([...])`.",
        )
    made = [
        node.targets[0].id
        for node in ast.walk(function)
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and isinstance(node.value, ast.Call)
        and ast.unparse(node.value.func).endswith("LaunchDescription")
        and not ast.unparse(node.value.func).endswith("IncludeLaunchDescription")
    ]
    has_return = any(
        isinstance(node, ast.Return) and node.value is not None for node in ast.walk(function)
    )
    return Explanation(
        REFUSED_BY_LAUNCH,
        f"{message}, but returns None{'' if has_return else ': it has no `return`'}.",
        f"Add `return {made[-1] if made else 'LaunchDescription([...])'}` as its last line.",
    )


def of_launch_function(error: BaseException) -> Explanation | None:
    """A launch file without the function that makes it one."""
    if type(error).__name__ != "InvalidPythonLaunchFileError":
        return None
    file, line = vars(error).get("wsgen_location", ("", 1))
    functions = {
        node.name: node.lineno for node in nodes_of(file) if isinstance(node, ast.FunctionDef)
    }
    wanted = "generate_launch_description"
    near = nearest(wanted, functions)
    return Explanation(
        NO_LAUNCH_FUNCTION,
        f"The launch file has no function {wanted}().",
        f"Rename `{near}` to `{wanted}`: ros2 launch calls this function."
        if near
        else "Define it, and return a LaunchDescription from it: ros2 launch calls this function.",
        file,
        functions[near] if near else line,
    )
