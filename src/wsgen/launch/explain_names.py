"""Explain names that are wrong in a launch file: not imported, misspelt, not of the launch API.

Like the rest of what explains, it runs in the child process and only when something is wrong.
"""

from __future__ import annotations

import ast
import builtins
import importlib
import inspect
import re
import sys
from typing import TYPE_CHECKING

from wsgen.launch import codes
from wsgen.launch.explain_missing import Explanation, packages
from wsgen.launch.missing_modules import KNOWN
from wsgen.launch.record import RECORD
from wsgen.launch.syntax import nodes_of
from wsgen.suggestions import advice, did_you_mean, nearest

if TYPE_CHECKING:
    from types import FrameType, TracebackType


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
MOST_TOLD = 80  # characters of a value
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
            codes.UNDEFINED_NAME,
            f"{error}: the launch file does not import `{name}`.",
            f"Add `{statement}` at the top of the file.",
            element=name,
        )
    if name == RECORD.package or name in packages():
        return Explanation(
            codes.UNDEFINED_NAME,
            f"{error}: it is the name of {'this' if name == RECORD.package else 'a'} package, and "
            "has no quotes.",
            f"Put quotes round it: '{name}'.",
            element=name,
        )
    known = _visible_names(error)
    near = nearest(name, {*known, *_importable_names()})
    hint = "Check the spelling, define it above this line, or, if it is text, put quotes round it."
    if near is not None:
        missing = None if near in known else import_line(near)
        hint = did_you_mean(near) + (f" Add `{missing}` at the top." if missing else "")
    return Explanation(codes.UNDEFINED_NAME, f"{error}.", hint, element=name)


def _visible_names(error: BaseException) -> set[str]:
    """The names that could be used where the exception was raised."""
    frame = _last_frame(error.__traceback__)
    scopes = () if frame is None else (frame.f_locals, frame.f_globals)
    return {
        name for scope in (*scopes, vars(builtins)) for name in scope if not name.startswith("_")
    }


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
            codes.UNSUPPORTED_API,
            f"The launch API has no module `{module}`, as far as wsgen knows it.",
            advice(module, API, "Check the spelling."),
            element=module,
        )
    names = {*MODULES, *KNOWN, *sys.stdlib_module_names}
    return Explanation(
        codes.IMPORT_ERROR,
        f"The launch file imports what is not there: {error}.",
        advice(
            module,
            [name for name in names if not name.startswith("_")],
            f"Install '{module}' into the Python that runs wsgen.",
        ),
        element=error.name,
    )


def _no_such_name(module: str, name: str) -> Explanation:
    """What is told of a name that a module of the launch API does not have."""
    here = {other for other in dir(importlib.import_module(module)) if not other.startswith("_")}
    here.update(_public_names(module))
    statement = import_line(name)
    near = nearest(name, here) or nearest(name, _importable_names())
    hint = "Check the spelling; what is right and yet not known cannot be evaluated without ROS."
    if statement is not None:
        hint = f"Write `{statement}`."
    elif near in here:
        hint = did_you_mean(near)
    elif near is not None:
        hint = did_you_mean(import_line(near) or near)
    return Explanation(
        codes.UNSUPPORTED_API,
        f"`{module}` has no `{name}`, as far as wsgen knows the launch API.",
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
        codes.RAISES,
        f"The launch file raises AttributeError: {error}.",
        did_you_mean(near),
        element=error.name,
    )


def of_keyword(error: BaseException) -> Explanation | None:
    """A keyword argument that a class of the launch API does not have, or one that it lacks."""
    text = str(error)
    wrong = re.match(r"(\w+)\.__init__\(\) got an unexpected keyword argument '(\w+)'", text)
    missing = re.match(r"(\w+)\.__init__\(\) missing \d+ required [\w -]+: '(\w+)'", text)
    found = wrong or missing
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
    keyword = wrong[2] if wrong else next(iter(unknown), None)
    if keyword is None:
        return Explanation(
            codes.WRONG_KEYWORD,
            f"`{name}` is not given `{found[2]}`, which it needs.",
            f"Add `{found[2]}=...` to its arguments.",
            file,
            line,
            name,
        )
    said = f"`{name}` has no argument `{keyword}`" + (f" ({text})" if missing else "")
    if keyword in REMOVED:
        return Explanation(
            codes.OLD_KEYWORD,
            f"{said}.",
            "Node takes executable, name and namespace; node_executable, node_name and "
            "node_namespace were removed in Galactic.",
            file,
            given.get(keyword, line),
            keyword,
        )
    near = nearest(keyword, known - given.keys())
    return Explanation(
        codes.WRONG_KEYWORD,
        f"{said}.",
        did_you_mean(near) if near else f"It has {', '.join(sorted(known))}.",
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
        what = returned[1][:MOST_TOLD] + ("..." if len(returned[1]) > MOST_TOLD else "")
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            f"{message}, and returns {what}.",
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
        codes.REFUSED_BY_LAUNCH,
        f"{message}, and returns None{'' if has_return else ': it has no `return`'}.",
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
        codes.NO_LAUNCH_FUNCTION,
        f"The launch file has no function {wanted}().",
        f"Rename `{near}` to `{wanted}`: ros2 launch calls it by this name."
        if near
        else "Define it, and return a LaunchDescription from it: ros2 launch calls it by this "
        "name.",
        file,
        functions[near] if near else line,
    )
