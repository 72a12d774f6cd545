"""Make a diagnostic of the exception that stopped the evaluation of a launch file.

Runs in the child process and only when there is something to report. Each explainer below looks at
one kind of exception and gives rule, message and hint, or None where it is not its kind.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.isolation.child import scratch_folder
from wsgen.launching import explain_missing, explain_names
from wsgen.launching.explain_missing import (
    EXECUTABLE_NOT_FOUND,
    Explanation,
    first_missing,
    keyword_of,
    where_written,
)
from wsgen.launching.explain_names import RAISES, REFUSED_BY_LAUNCH
from wsgen.launching.record import RECORD, ForkError, last_user_line, unknown_in_line
from wsgen.text.files import read_whole, save_as_utf8, wide_encoding
from wsgen.text.suggestions import advice
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.diagnostics import Diagnostic


SYNTAX_ERROR = Rule(
    code="LCH001",
    name="launch-syntax",
    severity=Severity.ERROR,
    summary="The launch file is not valid Python.",
    why="Python cannot run the launch file, so `ros2 launch` starts nothing.",
    example="return LaunchDescription([spawner, publisher",
    instead="return LaunchDescription([spawner, publisher])",
)
ARGUMENT_WITHOUT_VALUE = Rule(
    code="LCH006",
    name="argument-without-value",
    severity=Severity.ERROR,
    summary="A launch argument has no default, and no value is given.",
    why="`ros2 launch` refuses to start a launch file without its required arguments. A launch "
    "argument with a default works without options.",
    example="DeclareLaunchArgument('world')",
    instead="DeclareLaunchArgument('world', default_value='empty.world')",
)
UNDEFINED_CONFIGURATION = Rule(
    code="LCH009",
    name="undefined-configuration",
    severity=Severity.ERROR,
    summary="A launch configuration is used before it is set.",
    what="Evaluates the launch description in order, as `launch` does: a configuration exists "
    "only after the action that declares or sets it.",
    why="`ros2 launch` stops at the action that uses it.",
    example="LaunchDescription([\n"
    "    LogInfo(msg=LaunchConfiguration('world')),\n"
    "    DeclareLaunchArgument('world', default_value='empty.world'),\n"
    "])",
    instead="LaunchDescription([\n"
    "    DeclareLaunchArgument('world', default_value='empty.world'),\n"
    "    LogInfo(msg=LaunchConfiguration('world')),\n"
    "])",
)
DECLARED_LATER = "declared later"
INTERACTIVE_INPUT = Rule(
    code="LCH011",
    name="interactive-input",
    severity=Severity.ERROR,
    summary="The launch file asks for keyboard input.",
    why="A launch that waits for input cannot run in a script, in a test or in an included launch "
    "file, and its choices cannot be given on the command line.",
    example="world = input('Which world? ')",
    instead="DeclareLaunchArgument('world', default_value='empty.world')",
)
EXITS = Rule(
    code="LCH014",
    name="launch-exits",
    severity=Severity.ERROR,
    summary="The launch file ends the program.",
    what="Looks for `SystemExit` and `KeyboardInterrupt` that leave the launch file.",
    why="`ros2 launch` ends without starting anything, often without saying why.",
    example="if not os.path.exists(path):\n    sys.exit(1)",
    instead="if not os.path.exists(path):\n    raise FileNotFoundError(path)",
)
DESCRIPTION_NOT_YAML = Rule(
    code="LCH015",
    name="description-not-yaml",
    severity=Severity.ERROR,
    summary="The value of a parameter, such as a robot description, cannot be parsed as YAML.",
    why="`launch_ros` parses a parameter value that is a substitution as YAML unless "
    "`ParameterValue` gives it a type, and stops the launch where it cannot. In a robot a `: ` "
    "or ` #` is enough, for example in a comment.",
    example="Node(..., parameters=[{'robot_description': Command(['xacro ', path])}])",
    instead="Node(..., parameters=[{'robot_description': ParameterValue(\n"
    "    Command(['xacro ', path]), value_type=str)}])",
)
VARIABLE_NOT_SET = Rule(
    code="LCH020",
    name="variable-not-set",
    severity=Severity.ERROR,
    severity_varies="a warning about a search path of Gazebo, which is then taken as empty",
    summary="The launch file reads an environment variable that is not set.",
    what="Looks for `os.environ[NAME]`, `EnvironmentVariable(NAME)` and what fails because "
    "`os.getenv(NAME)` is None, of a variable that neither a login, a sourced workspace nor the "
    "environment of wsgen sets.",
    why="Python raises a KeyError, or None becomes part of a path, and the launch stops on every "
    "machine that does not set the variable.",
    example="os.environ['GAZEBO_MODEL_PATH']",
    instead="os.environ.get('GAZEBO_MODEL_PATH', '')",
)
NOT_MARKUP = Rule(
    code="LCH023",
    name="launch-markup",
    severity=Severity.ERROR,
    summary="The launch file is not well-formed XML or YAML.",
    why="`ros2 launch` cannot read the file and starts nothing.",
    example='<launch>\n  <node pkg="rviz2" exec="rviz2">\n</launch>',
    instead='<launch>\n  <node pkg="rviz2" exec="rviz2"/>\n</launch>',
)
ROS_1_LAUNCH_FILE = Rule(
    code="LCH082",
    name="ros-1-launch-file",
    severity=Severity.ERROR,
    severity_varies="a warning about a file that `ros2 launch` does not list",
    summary="A launch file is written for ROS 1.",
    what="Looks in launch files of XML for `$(find PACKAGE)`, `$(arg NAME)`, `$(optenv NAME)` and "
    "the attribute `type` of a node.",
    why="`ros2 launch` does not know these, and starts nothing.",
    example='<node pkg="rviz2" type="rviz2" args="-d $(find my_robot)/rviz/robot.rviz"/>',
    instead='<node pkg="rviz2" exec="rviz2"\n'
    '      args="-d $(find-pkg-share my_robot)/rviz/robot.rviz"/>',
)
NEEDS_UNKNOWN = Rule(
    code="LCH024",
    name="launch-needs-unknown",
    severity=Severity.ERROR,
    summary="The launch file needs a value that is known only where ROS is installed.",
    what="Looks for exceptions about a placeholder `$(...)`: the output of a command, or a value "
    "from a Python module that is not installed; and for programs that the launch file runs by "
    "`subprocess` and that are not installed.",
    why="`wsgen` cannot evaluate the rest of the launch file. With ROS installed the launch may "
    "work.",
    example="path = find_model('arm')  # of a package that is not installed\nopen(path)",
    instead="Install the package that provides the value, and source it.",
)
FORKS = Rule(
    code="LCH025",
    name="launch-forks",
    severity=Severity.ERROR,
    summary="The launch file forks.",
    why="Both processes would continue the same launch, and each would start everything.",
    example="if os.fork() == 0:\n    run_server()",
    instead="ExecuteProcess(cmd=['python3', path_of_server])",
)
NOT_UTF_8 = Rule(
    code="LCH032",
    name="launch-encoding",
    severity=Severity.ERROR,
    summary="The launch file is not encoded in UTF-8.",
    why="Python, XML and YAML are read as UTF-8, so `ros2 launch` cannot read the file. Some "
    "editors on Windows save other encodings.",
    example="iconv -t UTF-16 robot.launch.py > saved_as_utf_16.launch.py",
    instead="iconv -f UTF-16 -t UTF-8 saved_as_utf_16.launch.py > robot.launch.py",
)
# What is said of bytes that are no text, by Python, by YAML and by XML.
_ABOUT_BYTES = lazy_pattern(
    r"null byte|codec|utf-8|encoding|character|not well-formed", re.IGNORECASE
)
# What a page or a word processor makes of what is typed -> what Python reads.
_TYPOGRAPHIC = {
    **dict.fromkeys("\u2018\u2019\u201a\u2032\u00b4", "'"),
    **dict.fromkeys("\u201c\u201d\u201e\u2033\u00ab\u00bb", '"'),
    **dict.fromkeys("\u2010\u2011\u2013\u2014\u2212", "-"),
}
_NONE = lazy_pattern(r"(?<![A-Za-z])None(?:Type)?(?![A-Za-z])")
_PATH_WITH_NONE = lazy_pattern(r"'(/[^']*None[^']*)'")
LEAST_NULLS = 0.25  # of the bytes of a text in UTF-16 that is mostly of Latin letters
BRIEF = 150  # characters of what an exception says behind an explanation
LONGEST = 400  # characters of what an exception says; a whole robot may be in it


def explain(
    error: BaseException, launch_file: str, xacro_error: dict[str, Any] | None
) -> Diagnostic:
    """The diagnostic, also of an exception that cannot even be printed."""
    try:
        return _explain(error, launch_file, xacro_error)
    except Exception:  # noqa: BLE001  the exception is foreign code
        return _explain(RuntimeError(type(error).__name__), launch_file, None)


def _explain(
    error: BaseException, launch_file: str, xacro_error: dict[str, Any] | None
) -> Diagnostic:
    explanation = explain_missing.of_xacro(error, xacro_error)
    for explainer in _EXPLAINERS:
        explanation = explanation or explainer(error)
    place = last_user_line(error) or vars(error).get("wsgen_location")
    explanation = explanation or _other(error)
    explanation = _of_unset_variable(explanation) or explanation
    if place is None and isinstance(error, RecursionError):
        place = _function_of(launch_file)
    return diagnose(explanation, place or (launch_file, None))


def _function_of(launch_file: str) -> tuple[str, int]:
    """Where what the launch file describes begins."""
    try:
        lines = read_whole(Path(launch_file)).splitlines()
    except OSError:
        lines = []
    starts = (n for n, line in enumerate(lines, 1) if b"generate_launch_description" in line)
    return launch_file, next(starts, 1)


def diagnose(explanation: Explanation, where: tuple[str, int | None] | None) -> Diagnostic:
    """The diagnostic; `where` is the place of an explanation that has none."""
    if explanation.file is not None:
        where = (explanation.file, explanation.line)
    elif explanation.written is not None:
        where = where_written(explanation.written, RECORD.launch_files) or where
    file, line = where or (RECORD.launch_files[0], None)
    return explanation.rule.at(
        Path(file),
        line if isinstance(line, int) else None,  # a SyntaxError of the user may hold anything
        explanation.element,
        message=explanation.message,
        hint=explanation.hint,
        reason=explanation.reason,
    )


def _encoding(error: BaseException) -> Explanation | None:
    """A launch file that is not in UTF-8, as some editors of Windows save it."""
    is_read = isinstance(error, (SyntaxError, ValueError)) or type(error).__name__ in {
        "InvalidFrontendLaunchFileError",
        "ReaderError",
    }
    if not RECORD.launch_files or not (is_read and _ABOUT_BYTES.search(str(error))):
        return None
    file = RECORD.launch_files[-1]
    content = read_whole(Path(file))
    line, encoding, known = 1, "UTF-16", "UTF-16"
    nulls = content.count(b"\0")
    if nulls and nulls < len(content) * LEAST_NULLS and wide_encoding(content) is None:
        return Explanation(
            SYNTAX_ERROR,
            "The launch file has a null byte, which Python cannot read.",
            "Delete that character, or restore the file.",
            file,
            content.count(b"\n", 0, content.index(b"\0")) + 1,
        )
    if not nulls:
        try:
            content.decode("utf-8")
        except UnicodeDecodeError as undecodable:
            line = content.count(b"\n", 0, undecodable.start) + 1
            encoding, known = "an older encoding", "ISO-8859-1"
        else:
            return None
    return Explanation(
        NOT_UTF_8,
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
            SYNTAX_ERROR,
            f"Python cannot read the launch file: {error.msg}, in `{text}`.",
            f"Replace {changes}: text copied from a web page may have other characters.",
            error.filename,
            error.lineno,
        )
    return Explanation(
        SYNTAX_ERROR,
        f"Python cannot read the launch file: {error.msg}" + (f", in `{text}`." if text else "."),
        "Look at this line and the one before it: brackets, commas, quotes, indentation.",
        error.filename,
        error.lineno,
    )


def _markup_error(error: BaseException) -> Explanation | None:
    if type(error).__name__ != "InvalidFrontendLaunchFileError":
        return None
    return Explanation(
        NOT_MARKUP,
        f"The launch file is {error}.",
        getattr(error, "wsgen_hint", None) or "Look at this line and the one before it.",
    )


# What ROS 1 calls it -> what ROS 2 does.
_OF_ROS_1 = {"find": "$(find-pkg-share PACKAGE)", "arg": "$(var NAME)", "optenv": "$(env NAME '')"}
_ATTRIBUTE = lazy_pattern(r"Attribute 'exec' of .* not found in Entity 'node'")


def _of_ros_1(error: BaseException) -> Explanation | None:
    name = str(error).removeprefix("Unknown substitution: ")
    if isinstance(error, RuntimeError) and name in _OF_ROS_1:
        return Explanation(
            ROS_1_LAUNCH_FILE,
            f"`$({name} ...)` is a substitution of ROS 1.",
            f"Write {_OF_ROS_1[name]}.",
            element=name,
        )
    if isinstance(error, AttributeError) and _ATTRIBUTE.match(str(error)):
        return Explanation(
            ROS_1_LAUNCH_FILE,
            "The node has no attribute `exec`.",
            'Write exec="PROGRAM"; ROS 1 called it `type`.',
            element="exec",
        )
    return None


def _missing_program(error: BaseException) -> Explanation | None:
    """A program that a launch file runs itself, and that this machine lacks."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    is_run = trace is not None and trace.tb_frame.f_globals.get("__name__") == "subprocess"
    name = getattr(error, "filename", None)
    if not (is_run and isinstance(error, FileNotFoundError) and isinstance(name, str)):
        return None
    if os.path.basename(name) != name:
        return None
    return Explanation(
        NEEDS_UNKNOWN,
        f"The launch file runs the program `{name}`, which is not installed here.",
        f"Install {name}, or check its spelling.",
        element=name,
    )


def _needs_unknown(error: BaseException) -> Explanation | None:
    """An error about a text that represents an unknown value."""
    needed = getattr(error, "filename", None) or error
    if not RECORD.is_unknown(str(needed)):
        needed = unknown_in_line(error)
    if needed is None:
        return None
    return Explanation(
        NEEDS_UNKNOWN,
        "The launch file cannot be evaluated further without ROS: it needs an unknown value, "
        f"{needed}.",
        "Install the package that provides the value, and source it.",
    )


def _missing_argument(error: BaseException) -> Explanation | None:
    argument = getattr(error, "wsgen_argument", None)
    if argument is None:
        return None
    return Explanation(
        ARGUMENT_WITHOUT_VALUE,
        f"The launch argument '{argument}' has no default and no value was given.",
        f"Give a value (for wsgen validate: --arg {argument}:=VALUE), or declare the argument with "
        "default_value=...",
        element=argument,
    )


def _environment(error: BaseException) -> Explanation | None:
    unset = re.match(r"environment variable '(.*)' does not exist", str(error))
    if unset is not None and type(error).__name__ == "SubstitutionFailure":
        return _variable_not_set(unset[1], f"EnvironmentVariable('{unset[1]}', default_value='')")
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
    return _variable_not_set(error.args[0], f"os.environ.get('{error.args[0]}', '')")


def _variable_not_set(name: str, with_default: str) -> Explanation:
    return Explanation(
        VARIABLE_NOT_SET,
        f"The launch file needs the environment variable {name}, which is not set.",
        f"Set it first: `export {name}=VALUE`. Or read it with a default: {with_default}.",
        element=name,
    )


def _of_unset_variable(found: Explanation) -> Explanation | None:
    """What failed because a variable that is not set is None, as part of a path or alone."""
    if not RECORD.unset or not _NONE.search(found.message):
        return None
    name, (file, line) = list(RECORD.unset.items())[-1]
    path = _PATH_WITH_NONE.search(found.message)
    missing, beside = first_missing(path[1]) if path else ("", [])
    before, is_part, after = missing.partition("None")
    values = [
        file[len(before) : len(file) - len(after)]
        for file in sorted(beside)
        if is_part and file.startswith(before) and file.endswith(after)
    ]
    known = f", where VALUE is one of {', '.join(values)}" if values else ""
    return Explanation(
        VARIABLE_NOT_SET,
        f"The environment variable {name} is not set, so that it is None. {found.message}",
        f"Set it first: `export {name}=VALUE`{known}. Or read it with a default: "
        f"os.environ.get('{name}', '').",
        file,
        line,
        name,
    )


def _last_printed() -> str:
    """What the launch file has printed before it ended the program, on one line."""
    sys.stdout.flush()
    folder = scratch_folder()
    try:
        output = Path(folder, "output").read_bytes() if folder else b""
    except OSError:
        return ""
    return " ".join(output.decode(errors="replace").split())[-BRIEF:]


def _program_end(error: BaseException) -> Explanation | None:
    if isinstance(error, EOFError):
        prompt = " ".join((RECORD.prompt or "").split())
        asked = f"`{prompt[-LONGEST:]}`" if prompt else "for keyboard input"
        return Explanation(
            INTERACTIVE_INPUT,
            f"The launch file asks {asked}, and does not get an answer.",
            "Give the answers with --answer TEXT, once for each question, or on standard input. "
            "Better, use a launch argument: DeclareLaunchArgument(NAME, default_value=...).",
        )
    if isinstance(error, ForkError):
        return Explanation(
            FORKS,
            "The launch file forks: two processes would continue the launch.",
            "Start other programs with ExecuteProcess; a launch file only describes what to start.",
        )
    if isinstance(error, (SystemExit, KeyboardInterrupt)):
        printed = _last_printed()
        said = f", and prints: {printed}" if printed else f": {type(error).__name__}({error})."
        return Explanation(
            EXITS,
            f"The launch file ends the program{said}",
            "Give the launch argument that it asks for. In the file, raise an exception with a "
            "message instead of ending the program."
            if "argument" in printed.lower()
            else "Raise an exception with a message instead of ending the program.",
        )
    if isinstance(error, RecursionError):
        return Explanation(
            RAISES,
            "The launch file includes or calls itself without end, or it is nested too deeply.",
            "Add a condition that becomes false to an include of itself; write nested actions as "
            "several actions.",
        )
    return None


def _refusal(error: BaseException) -> Explanation | None:
    """What the launch system itself says, where no line of the user's raised it."""
    kind, text = type(error).__name__, str(error)
    if text.startswith("Unable to parse the value of parameter"):
        return Explanation(
            DESCRIPTION_NOT_YAML,
            f"{text}.",
            "Write ParameterValue(Command([...]), value_type=str), which keeps the text as it is; "
            "otherwise launch_ros reads it as YAML, and a ': ' or ' #' in the robot stops the "
            "launch.",
        )
    if kind == "SubstitutionFailure" and text.startswith("launch configuration"):
        name = text.split("'")[1]
        declared = RECORD.argument_use.declared
        return Explanation(
            UNDEFINED_CONFIGURATION,
            f"The launch configuration '{name}' does not exist when it is used.",
            advice(
                name,
                () if name in declared else declared,  # it is spelled well, and comes too late
                f"Write EnvironmentVariable('{name}', default_value='') for a variable of the "
                "environment."
                if name.isupper()
                else f"Declare it before its first use: DeclareLaunchArgument('{name}', "
                "default_value=...); the order in the LaunchDescription counts.",
            ),
            element=name,
            written=name,
            reason=DECLARED_LATER if name in declared else None,
        )
    if kind == "SubstitutionFailure" and text.startswith("executable"):
        return Explanation(
            EXECUTABLE_NOT_FOUND,
            f"{text[0].upper()}{text[1:]}.",
            "Check the spelling, and that the program is on PATH.",
        )
    return None


def _invalid_value(error: BaseException) -> Explanation | None:
    """A value that is nearly what the launch system takes."""
    text = str(error)
    if "xml.dom.minidom.Document" in text:
        return Explanation(
            REFUSED_BY_LAUNCH,
            "A parameter of the node is the XML document of xacro, but must be its text.",
            "Write xacro.process_file(...).toxml().",
        )
    type_error = getattr(error, "wsgen_wrong_type", None)
    if type_error is not None:
        argument, accepted, name, caller = type_error
        is_dictionary = isinstance(argument, dict)
        known = " or ".join(dict.fromkeys(_TYPES[one] for one in accepted if one in _TYPES))
        return Explanation(
            REFUSED_BY_LAUNCH,
            f"`{name}` of {caller} must be {known}, and is {_described(argument)} "
            f"({_quoted(error, BRIEF)}).",
            f"Put square brackets around it: {name}=[{'{...}' if is_dictionary else '...'}]."
            if "a list" in known
            else f"Write {known} there.",
        )
    if hasattr(error, "wsgen_not_text"):
        return _not_text(error, error.wsgen_not_text[0])
    if getattr(error, "wsgen_is_mapping", False):
        return Explanation(
            REFUSED_BY_LAUNCH,
            f"{text}: `launch_arguments` of the include is a dictionary, but must be pairs of a "
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


def _described(value: object) -> str:
    return _TYPES.get(type(value), f"a {type(value).__name__}")


def _not_text(error: BaseException, value: object) -> Explanation:
    """A number, or anything else that is none, where the launch system takes text."""
    is_plain = value is None or isinstance(value, (bool, int, float))
    what = _described(value)
    if is_plain:
        kind = "number " if isinstance(value, (int, float)) and not isinstance(value, bool) else ""
        what = f"the {kind}{value}" if kind else str(value)
    hint = f"Write '{value}', in quotes." if is_plain else "Write text, in quotes."
    place = last_user_line(error) or vars(error).get("wsgen_location")
    written = None if place is None else keyword_of(value, *place)
    if place is None or written is None:
        return Explanation(
            REFUSED_BY_LAUNCH,
            f"The launch file gives {what} where launch takes text ({_quoted(error, BRIEF)}).",
            hint,
        )
    name, line = written
    return Explanation(
        REFUSED_BY_LAUNCH,
        f"`{name}` is {what}, but must be text ({_quoted(error, BRIEF)}).",
        hint,
        place[0],
        line,
        name,
    )


def _quoted(error: BaseException, most: int = LONGEST) -> str:
    """What Python says of it, for who searches for that; at most so many characters."""
    text = f"{type(error).__name__}: {error}".rstrip(": ")
    return f"{text[:most]}..." if len(text) > most else text


def _other(error: BaseException) -> Explanation:
    text = _quoted(error)
    if _is_from_launch(error):
        if "<class 'datetime.date" in text:
            return Explanation(
                REFUSED_BY_LAUNCH,
                f"launch refuses this: {text}.",
                "Write a text like 2024-01-31 in quotes: YAML reads it as a date.",
            )
        return Explanation(
            REFUSED_BY_LAUNCH,
            f"launch refuses this: {text}.",
            "Check the types and the order of the arguments: the real ros2 launch refuses it, too.",
        )
    return Explanation(
        RAISES,
        f"The launch file raises {text}.",
        "Fix the error; `ros2 launch` would fail in the same way.",
    )


def _is_from_launch(error: BaseException) -> bool:
    step = error.__traceback__
    last = ""
    while step is not None:
        last = step.tb_frame.f_code.co_filename
        step = step.tb_next
    return last.startswith(os.path.dirname(__file__))


# What one machine lacks, or one include or node: the rest of the launch is evaluated all the same.
OF_A_BRANCH = frozenset(
    rule.code
    for rule in (
        explain_names.IMPORT_ERROR,
        explain_names.UNSUPPORTED_API,
        explain_missing.FILE_NOT_INSTALLED,
        explain_missing.PACKAGE_NOT_FOUND,
        explain_missing.NOT_READABLE,
        EXECUTABLE_NOT_FOUND,
        INTERACTIVE_INPUT,
        VARIABLE_NOT_SET,
        NEEDS_UNKNOWN,
    )
)
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
    _of_ros_1,
    _missing_argument,
    explain_missing.package_error,
    _missing_program,
    explain_missing.file_error,
    explain_missing.executable_error,
    _environment,
    _program_end,
    _refusal,
    _invalid_value,
)
