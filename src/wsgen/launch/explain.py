"""Turn what stopped the evaluation of a launch file into a diagnostic, in the user's words.

Runs in the child process and only when something is wrong. Each explainer below looks at one kind
of exception and gives code, message and hint, or None where it is not its kind.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from wsgen.launch import codes, explain_missing
from wsgen.launch.explain_missing import Explanation
from wsgen.launch.record import RECORD, ForkError, last_user_line

if TYPE_CHECKING:
    from collections.abc import Callable


def explain(
    error: BaseException, launch_file: str, xacro_fault: dict[str, Any] | None
) -> dict[str, Any]:
    """The diagnostic, as JSON, also of an exception that cannot even be printed."""
    try:
        return _explain(error, launch_file, xacro_fault)
    except Exception:  # noqa: BLE001  the exception is foreign code
        return _explain(RuntimeError(type(error).__name__), launch_file, None)


def _explain(
    error: BaseException, launch_file: str, xacro_fault: dict[str, Any] | None
) -> dict[str, Any]:
    told = explain_missing.of_xacro(error, xacro_fault)
    for explainer in _EXPLAINERS:
        told = told or explainer(error)
    told = told or _other(error)
    where: tuple[str, int | None] = (launch_file, None)
    if told.file is not None:
        where = (told.file, told.line)
    else:
        where = last_user_line(error) or vars(error).get("wsgen_location", where)
    file, line = where
    return {
        "code": told.code,
        "severity": "error",
        "message": told.message,
        "file": file,
        "line": line,
        "element": told.element,
        "hint": told.hint,
    }


def _syntax_error(error: BaseException) -> Explanation | None:
    if not isinstance(error, SyntaxError):
        return None
    text = (error.text or "").strip()
    return Explanation(
        codes.SYNTAX_ERROR,
        f"Python cannot read the launch file: {error.msg}" + (f", in `{text}`." if text else "."),
        "Look at this line and the one before it: brackets, commas, quotes, indentation.",
        error.filename,
        error.lineno,
    )


def _import_error(error: BaseException) -> Explanation | None:
    if not isinstance(error, ImportError):
        return None
    module = (error.name or "").partition(".")[0]
    if module in {"launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python"}:
        return Explanation(
            codes.UNSUPPORTED_API,
            f"This part of the launch API is not known here: {error}.",
            "Check the spelling; what is right and yet not known cannot be evaluated without ROS.",
        )
    return Explanation(
        codes.IMPORT_ERROR,
        f"The launch file imports what is not there: {error}.",
        f"Check the spelling of '{error.name}', or install it into the Python that runs wsgen.",
        element=error.name,
    )


def _markup_error(error: BaseException) -> Explanation | None:
    if type(error).__name__ != "InvalidFrontendLaunchFileError":
        return None
    return Explanation(
        codes.NOT_MARKUP,
        f"The launch file is {error}.",
        "Look at this line and the one before it: tags, quotes, '&' and '<', indentation.",
    )


def _missing_function(error: BaseException) -> Explanation | None:
    if type(error).__name__ != "InvalidPythonLaunchFileError":
        return None
    return Explanation(
        codes.NO_LAUNCH_FUNCTION,
        "The launch file has no function generate_launch_description().",
        "Define it, and return a LaunchDescription from it; ros2 launch calls it by this name.",
    )


def _needs_unknown(error: BaseException) -> Explanation | None:
    """Whatever fails over a text that stands for something unknown."""
    named = getattr(error, "filename", None)
    if not RECORD.is_unknown(f"{error} {named}"):
        return None
    return Explanation(
        codes.NEEDS_UNKNOWN,
        "The launch file cannot be evaluated further without ROS: it needs a value that is not "
        f"known, {named or error}.",
        "Install the package that the value comes from, and source it.",
    )


def _missing_argument(error: BaseException) -> Explanation | None:
    argument = getattr(error, "wsgen_argument", None)
    if argument is None:
        return None
    return Explanation(
        codes.ARGUMENT_WITHOUT_VALUE,
        f"The launch argument '{argument}' has no default and no value was given.",
        f"Give it, {argument}:=VALUE, or declare it with default_value=.",
        element=argument,
    )


def _environment(error: BaseException) -> Explanation | None:
    step = error.__traceback__
    while step is not None and step.tb_next is not None:
        step = step.tb_next
    is_environ = (
        isinstance(error, KeyError)
        and step is not None
        and step.tb_frame.f_code is os.environ.__class__.__getitem__.__code__
    )
    if not is_environ:
        return None
    name = error.args[0]
    return Explanation(
        codes.VARIABLE_NOT_SET,
        f"The launch file needs the environment variable {name}, which is not set.",
        f"Read it with a default, os.environ.get('{name}', ''), or set it before the launch.",
        element=str(name),
    )


def _program_end(error: BaseException) -> Explanation | None:
    if isinstance(error, EOFError):
        return Explanation(
            codes.INTERACTIVE_INPUT,
            "The launch file asks for input, and nobody can answer.",
            "Declare a launch argument instead: DeclareLaunchArgument(NAME, default_value=...).",
        )
    if isinstance(error, ForkError):
        return Explanation(
            codes.FORKS,
            "The launch file forks: two processes would go on with it.",
            "Start what is needed with ExecuteProcess; a launch file only describes.",
        )
    if isinstance(error, (SystemExit, KeyboardInterrupt)):
        return Explanation(
            codes.EXITS,
            f"The launch file ends the program: {type(error).__name__}({error}).",
            "Raise an exception that says what is wrong, instead of leaving the program.",
        )
    if isinstance(error, RecursionError):
        return Explanation(
            codes.RAISES,
            "The launch file goes round in a circle: it includes or calls itself without end; or "
            "it is nested too deeply.",
            "Give the include a condition that becomes false.",
        )
    return None


def _refusal(error: BaseException) -> Explanation | None:
    """What the launch system itself says, where no line of the user's raised it."""
    kind, text = type(error).__name__, str(error)
    if text.startswith("Unable to parse the value of parameter"):
        return Explanation(
            codes.DESCRIPTION_NOT_YAML,
            f"{text}.",
            "ParameterValue(Command([...]), value_type=str) keeps the text as it is; launch_ros "
            "reads it as YAML otherwise, and a ': ' or ' #' in the robot is enough to stop it.",
        )
    if kind == "SubstitutionFailure" and text.startswith("launch configuration"):
        name = text.split("'")[1]
        return Explanation(
            codes.UNDEFINED_CONFIGURATION,
            f"The launch configuration '{name}' does not exist when it is used.",
            f"Declare it before its first use: DeclareLaunchArgument('{name}', "
            "default_value=...); the order in the LaunchDescription counts.",
            element=name,
        )
    if kind == "SubstitutionFailure" and text.startswith("executable"):
        return Explanation(
            codes.EXECUTABLE_NOT_FOUND,
            f"{text[0].upper()}{text[1:]}.",
            "Check the spelling, and that CMakeLists.txt installs it to lib/${PROJECT_NAME}.",
        )
    if kind == "TypeError" and "node_executable" in text + _source_line(error):
        return Explanation(
            codes.OLD_KEYWORD,
            f"{text}.",
            "Node takes executable, name and namespace; node_executable, node_name and "
            "node_namespace were removed in Galactic.",
        )
    return None


def _source_line(error: BaseException) -> str:
    """The user's line that the exception came through."""
    location = last_user_line(error)
    if location is None:
        return ""
    import linecache

    return linecache.getline(*location)


def _other(error: BaseException) -> Explanation:
    text = f"{type(error).__name__}: {error}".rstrip(": ")
    if _is_from_launch(error):
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            f"launch refuses this: {text}.",
            "The real ros2 launch refuses it too; check the types and the order of the arguments.",
        )
    return Explanation(
        codes.RAISES,
        f"The launch file raises {text}.",
        "Mend it; `ros2 launch` would fail in the same way.",
    )


def _is_from_launch(error: BaseException) -> bool:
    step = error.__traceback__
    last = ""
    while step is not None:
        last = step.tb_frame.f_code.co_filename
        step = step.tb_next
    return last.startswith(os.path.dirname(__file__))


_EXPLAINERS: tuple[Callable[[BaseException], Explanation | None], ...] = (
    _syntax_error,
    _needs_unknown,
    _import_error,
    _markup_error,
    _missing_function,
    _missing_argument,
    explain_missing.package_error,
    explain_missing.file_error,
    _environment,
    _program_end,
    _refusal,
)
