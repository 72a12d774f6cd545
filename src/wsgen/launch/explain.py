"""Turn what stopped the evaluation of a launch file into a diagnostic, in the user's words.

Runs in the child process and only when something is wrong. Each explainer below looks at one kind
of exception and gives code, message and hint, or None where it is not its kind.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.files import save_as_utf8, wide_encoding
from wsgen.launch import codes, explain_missing, explain_names
from wsgen.launch.explain_missing import Explanation
from wsgen.launch.record import RECORD, ForkError, last_user_line
from wsgen.launch.syntax import keyword_of, where_written
from wsgen.suggestions import advice

if TYPE_CHECKING:
    from collections.abc import Callable


# What is said of bytes that are no text, by Python, by YAML and by XML.
_ABOUT_BYTES = re.compile(
    r"null byte|codec|utf-8|encoding|character|not well-formed", re.IGNORECASE
)
# What a page or a word processor makes of what is typed -> what Python reads.
_TYPOGRAPHIC = {
    **dict.fromkeys("\u2018\u2019\u201a\u2032\u00b4", "'"),
    **dict.fromkeys("\u201c\u201d\u201e\u2033\u00ab\u00bb", '"'),
    **dict.fromkeys("\u2010\u2011\u2013\u2014\u2212", "-"),
}
LEAST_NULLS = 0.25  # of the bytes of a text in UTF-16 that is mostly of Latin letters
BRIEF = 150  # characters of what an exception says behind an explanation
MOST_TOLD = 400  # characters of what an exception says; a whole robot may be in it


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
        if told.written is not None:
            where = where_written(told.written, RECORD.launch_files) or where
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


def _encoding(error: BaseException) -> Explanation | None:
    """A launch file that is not in UTF-8, as some editors of Windows save it."""
    is_read = isinstance(error, (SyntaxError, ValueError)) or type(error).__name__ in {
        "InvalidFrontendLaunchFileError",
        "ReaderError",
    }
    if not RECORD.launch_files or not (is_read and _ABOUT_BYTES.search(str(error))):
        return None
    file = RECORD.launch_files[-1]
    content = Path(file).read_bytes()
    line, encoding, known = 1, "UTF-16", "UTF-16"
    nulls = content.count(b"\0")
    if nulls and nulls < len(content) * LEAST_NULLS and wide_encoding(content) is None:
        return Explanation(
            codes.SYNTAX_ERROR,
            "The launch file has a null byte, which no text has.",
            "Delete that character, or get the file anew.",
            file,
            content.count(b"\n", 0, content.index(b"\0")) + 1,
        )
    if not nulls:
        try:
            content.decode("utf-8")
        except UnicodeDecodeError as wrong:
            line = content.count(b"\n", 0, wrong.start) + 1
            encoding, known = "an older encoding", "ISO-8859-1"
        else:
            return None
    return Explanation(
        codes.NOT_UTF_8,
        f"The launch file is not in UTF-8 but in {encoding}.",
        save_as_utf8(known),
        file,
        line,
    )


def _syntax_error(error: BaseException) -> Explanation | None:
    if not isinstance(error, SyntaxError):
        return None
    text = (error.text or "").strip()
    typographic = [char for char in _TYPOGRAPHIC if char in text]
    if "character" in error.msg and typographic:
        changes = ", ".join(f"{char} by {_TYPOGRAPHIC[char]}" for char in typographic)
        return Explanation(
            codes.SYNTAX_ERROR,
            f"Python cannot read the launch file: {error.msg}, in `{text}`.",
            f"Replace {changes}: text that is copied from a page may have other characters.",
            error.filename,
            error.lineno,
        )
    return Explanation(
        codes.SYNTAX_ERROR,
        f"Python cannot read the launch file: {error.msg}" + (f", in `{text}`." if text else "."),
        "Look at this line and the one before it: brackets, commas, quotes, indentation.",
        error.filename,
        error.lineno,
    )


def _markup_error(error: BaseException) -> Explanation | None:
    if type(error).__name__ != "InvalidFrontendLaunchFileError":
        return None
    return Explanation(
        codes.NOT_MARKUP,
        f"The launch file is {error}.",
        getattr(error, "wsgen_hint", None) or "Look at this line and the one before it.",
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
            advice(
                name,
                RECORD.argument_use.declared,
                f"Declare it before its first use: DeclareLaunchArgument('{name}', "
                "default_value=...); the order in the LaunchDescription counts.",
            ),
            element=name,
            written=name,
        )
    if kind == "SubstitutionFailure" and text.startswith("executable"):
        return Explanation(
            codes.EXECUTABLE_NOT_FOUND,
            f"{text[0].upper()}{text[1:]}.",
            "Check the spelling, and that the program is on PATH.",
        )
    return None


def _wrong_value(error: BaseException) -> Explanation | None:
    """A value that is nearly what the launch system takes."""
    text = str(error)
    if "xml.dom.minidom.Document" in text:
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            "A parameter of the node is the XML document of xacro, and must be its text.",
            "Write xacro.process_file(...).toxml().",
        )
    wrong_type = getattr(error, "wsgen_wrong_type", None)
    if wrong_type is not None:
        argument, accepted, name, caller = wrong_type
        is_dictionary = isinstance(argument, dict)
        known = " or ".join(dict.fromkeys(_TYPES[one] for one in accepted if one in _TYPES))
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            f"`{name}` of {caller} must be {known}, and is {_prepared(argument)} "
            f"({_quoted(error, BRIEF)}).",
            f"Put square brackets around it: {name}=[{'{...}' if is_dictionary else '...'}]."
            if "a list" in known
            else f"Write {known} there.",
        )
    if hasattr(error, "wsgen_not_text"):
        return _not_text(error, error.wsgen_not_text[0])
    if getattr(error, "wsgen_is_mapping", False):
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            f"{text}: `launch_arguments` of the include is a dictionary, and must be pairs of a "
            "name and a value.",
            "Write launch_arguments={...}.items().",
        )
    return None


# How a value that a launch file gives is called.
_TYPES: dict[type, str] = {
    bool: "a truth value",
    int: "a number",
    float: "a number",
    str: "text",
    list: "a list",
    tuple: "a list",
    Iterable: "a list",
    dict: "a dictionary",
}


def _prepared(value: object) -> str:
    return _TYPES.get(type(value), f"a {type(value).__name__}")


def _not_text(error: BaseException, value: object) -> Explanation:
    """A number, or anything else that is none, where the launch system takes text."""
    is_plain = value is None or isinstance(value, (bool, int, float))
    what = _prepared(value)
    if is_plain:
        kind = "number " if isinstance(value, (int, float)) and not isinstance(value, bool) else ""
        what = f"the {kind}{value}" if kind else str(value)
    hint = f"Write '{value}', in quotes." if is_plain else "Write text, in quotes."
    place = last_user_line(error) or vars(error).get("wsgen_location")
    written = None if place is None else keyword_of(value, *place)
    if place is None or written is None:
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            f"The launch file gives {what} where launch takes text ({_quoted(error, BRIEF)}).",
            hint,
        )
    name, line = written
    return Explanation(
        codes.REFUSED_BY_LAUNCH,
        f"`{name}` holds {what}, and must hold text ({_quoted(error, BRIEF)}).",
        hint,
        place[0],
        line,
        name,
    )


def _quoted(error: BaseException, most: int = MOST_TOLD) -> str:
    """What Python says of it, for who searches for that; at most so many characters."""
    text = f"{type(error).__name__}: {error}".rstrip(": ")
    return f"{text[:most]}..." if len(text) > most else text


def _other(error: BaseException) -> Explanation:
    text = _quoted(error)
    if _is_from_launch(error):
        return Explanation(
            codes.REFUSED_BY_LAUNCH,
            f"launch refuses this: {text}.",
            "The real ros2 launch refuses it too; check the types and the order of the arguments.",
        )
    return Explanation(
        codes.RAISES,
        f"The launch file raises {text}.",
        "Fix it; `ros2 launch` would fail in the same way.",
    )


def _is_from_launch(error: BaseException) -> bool:
    step = error.__traceback__
    last = ""
    while step is not None:
        last = step.tb_frame.f_code.co_filename
        step = step.tb_next
    return last.startswith(os.path.dirname(__file__))


_EXPLAINERS: tuple[Callable[[BaseException], Explanation | None], ...] = (
    _encoding,
    _syntax_error,
    _needs_unknown,
    explain_names.of_import,
    explain_names.of_name,
    explain_names.of_attribute,
    explain_names.of_keyword,
    explain_names.of_returned,
    explain_names.of_launch_function,
    _markup_error,
    _missing_argument,
    explain_missing.package_error,
    explain_missing.file_error,
    explain_missing.executable_error,
    _environment,
    _program_end,
    _refusal,
    _wrong_value,
)
