"""Explain missing packages, files and executables, and what xacro reports.

What is written where in launch files of Python, read without running them; paths in them.
"""

from __future__ import annotations

import ast
import collections
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.launching import known_packages
from wsgen.launching.known_packages import find_in_package, in_python
from wsgen.launching.package_lookup import needs_missing_library, targets_left_out
from wsgen.launching.record import RECORD
from wsgen.packages.source_shares import is_source
from wsgen.ros.names import released_packages
from wsgen.text.files import read_whole
from wsgen.text.pythontree import parse_anew
from wsgen.text.suggestions import advice, did_you_mean, nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan


def nodes_of(file: str | Path) -> Iterator[Any]:
    """The nodes of the syntax tree of a launch file; none of one that is not Python."""
    tree = parsed(file)
    if tree is not None:
        yield from ast.walk(tree)


def parsed(file: str | Path) -> ast.Module | None:
    """The syntax tree of a launch file; None of one that is not Python."""
    try:
        tree: ast.Module = parse_anew(read_whole(Path(file)))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    return tree


def where_written(text: str, files: Iterable[str | Path]) -> tuple[str, int] | None:
    """The file and line of the one text that is this one, or a path with this part."""
    places = {
        (str(file), node.lineno)
        for file in files
        for node in nodes_of(file)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and text in {node.value, *node.value.split("/")}
    }
    return places.pop() if len(places) == 1 else None


def keyword_of(value: object, file: str, line: int) -> tuple[str, int] | None:
    """The keyword argument of a call at the line in which a literal is written, and its line."""
    for call in nodes_of(file):
        if not isinstance(call, ast.Call) or not call.lineno <= line <= (call.end_lineno or line):
            continue
        for keyword in call.keywords:
            for node in ast.walk(keyword.value):
                if keyword.arg is not None and isinstance(node, ast.expr) and _is(node, value):
                    return keyword.arg, node.lineno
    return None


def _is(node: ast.expr, value: object) -> bool:
    try:
        written = ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return False
    return type(written) is type(value) and bool(written == value)


def first_missing_path(path: Path) -> Path:
    """The first of the folders above a file that is not there; the file, if all are there."""
    # Unlike the method, this does not raise where a name is too long or a folder is closed.
    while not os.path.isdir(path.parent) and path.parent != path:
        path = path.parent
    return path


def first_missing(path: str) -> tuple[str, list[str]]:
    """The first part of a path that is not there, and what is in its place."""
    missing = first_missing_path(Path(path))
    try:
        return missing.name, os.listdir(missing.parent)
    except OSError:
        return missing.name, []


class AbsolutePart(NamedTuple):
    """A part of a joined path that begins with `/`, so that what is before it has no effect."""

    function: str
    text: str
    file: str
    line: int

    @property
    def message(self) -> str:
        """What is wrong."""
        return (
            f"`{self.function}` ignores everything before '{self.text}', which begins with a slash."
        )

    @property
    def hint(self) -> str:
        """What to write."""
        return f"Write '{self.text.lstrip('/')}', without the leading slash."


def absolute_part(path: str, files: Iterable[str | Path]) -> AbsolutePart | None:
    """What is written in launch files of Python that makes a path begin where it does."""
    for file in files:
        for call in nodes_of(file):
            if not isinstance(call, ast.Call):
                continue
            name = ast.unparse(call.func)
            items = getattr(call.args[0], "elts", []) if call.args else []
            for part in items[1:] if name.endswith("PathJoinSubstitution") else call.args[1:]:
                text = part.value if isinstance(part, ast.Constant) else None
                if (
                    name.endswith(("join", "PathJoinSubstitution"))
                    and isinstance(text, str)
                    and text.startswith("/")
                    and f"{path}/".startswith(f"{text.rstrip('/')}/")
                ):
                    return AbsolutePart(name, text, str(file), part.lineno)
    return None


class UnusedAction(NamedTuple):
    """An action that a launch file creates and does not add to its description."""

    name: str  # of the variable that has it in the end
    words: frozenset[str]  # the texts in it, and the parts of paths and command lines
    file: Path
    line: int


def unused_actions(files: Iterable[Path], kinds: Iterable[str]) -> Iterator[UnusedAction]:
    """The actions of these classes in variables that nothing reads.

    What only such variables read is in them: a spawner in a handler that is not added.
    """
    for file in files:
        unread = _unread(list(nodes_of(file)))
        for node in unread:
            if ast.unparse(node.value.func).rpartition(".")[2] in kinds:  # type: ignore[attr-defined]  # a call
                words = frozenset(
                    word
                    for part in ast.walk(node.value)
                    if isinstance(part, ast.Constant) and isinstance(part.value, str)
                    for word in part.value.replace("/", " ").split()
                )
                outer = _outermost(node, unread)
                yield UnusedAction(_name(outer), words, file, outer.lineno)


def _outermost(node: ast.Assign, unread: Sequence[ast.Assign]) -> ast.Assign:
    """The assignment of the variable that has a variable in it, and is in none."""
    reader = next((one for one in unread if _name(node) in _names_in(one.value)), None)
    return node if reader is None else _outermost(reader, unread)


def _unread(nodes: Sequence[ast.AST]) -> list[ast.Assign]:
    """The assignments of calls to variables that nothing reads but other ones of them."""
    calls = [
        node
        for node in nodes
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and _name(node)
    ]
    read = collections.Counter(
        node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
    )
    unread: list[ast.Assign] = []
    while found := [one for one in calls if one not in unread and not read[_name(one)]]:
        unread += found
        for one in found:
            read.subtract(_names_in(one.value))
    return unread


def _name(node: ast.Assign) -> str:
    return getattr(node.targets[0], "id", "")


def _names_in(value: ast.expr) -> list[str]:
    return [node.id for node in ast.walk(value) if isinstance(node, ast.Name)]


FILE_NOT_INSTALLED = Rule(
    code="LCH005",
    name="file-not-installed",
    severity=Severity.ERROR,
    summary="The launch file, or the xacro file, uses a file that is not installed.",
    why="`ros2 launch` works on the install space: what `CMakeLists.txt` or `setup.py` does not "
    "install is not found there, and the launch stops.",
    example="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch model DESTINATION share/${PROJECT_NAME})",
)
PACKAGE_NOT_FOUND = Rule(
    code="LCH007",
    name="package-not-found",
    severity=Severity.ERROR,
    summary="A package that is looked up is not installed.",
    what="Looks up packages in the sourced install spaces, and accepts those that docs/launch.md "
    "lists or `package.xml` declares.",
    why="`get_package_share_directory()`, `FindPackageShare` and `$(find ...)` raise an error for "
    "it, and the launch stops.",
    example="get_package_share_directory('my_robot_desription')",
    instead="get_package_share_directory('my_robot_description')",
)
XACRO_FAILS = Rule(
    code="LCH008",
    name="xacro-fails",
    severity=Severity.ERROR,
    summary="`xacro` cannot expand the robot description.",
    why="`Command` and `xacro.process_file()` fail, and the launch stops before it starts "
    "anything.",
    example='<cylinder radius="${raduis}" length="0.1"/>',
    instead='<xacro:property name="radius" value="0.05"/>\n'
    '<cylinder radius="${radius}" length="0.1"/>',
)
NOT_READABLE = Rule(
    code="LCH018",
    name="launch-not-readable",
    severity=Severity.ERROR,
    summary="The launch file, or a file that it uses, cannot be read.",
    what="Looks for files without read permission, and for folders, devices and named pipes "
    "instead of a file.",
    why="The launch stops with the error of the operating system.",
    example="chmod 000 launch/robot.launch.py",
    instead="chmod 644 launch/robot.launch.py",
)
EXECUTABLE_NOT_FOUND = Rule(
    code="LCH021",
    name="executable-not-found",
    severity=Severity.ERROR,
    summary="A package has no executable of that name, or it is not on `PATH`.",
    what="Looks in `lib/PACKAGE` of the install space for `Node` and `ExecutableInPackage`, and "
    "on `PATH` for `FindExecutable`.",
    why="`launch` refuses to start the node, and stops the whole launch.",
    example="Node(package='robot_state_publisher', executable='robot_state_publiser')",
    instead="Node(package='robot_state_publisher', executable='robot_state_publisher')",
)
GLUED_COMMAND = Rule(
    code="LCH083",
    name="glued-command",
    severity=Severity.ERROR,
    summary="`Command` joins `xacro` and the path of its file into one word.",
    why="`Command` joins its parts without blanks. A program of that name does not exist, and "
    "the launch stops.",
    example="Command(['xacro', path])",
    instead="Command(['xacro ', path])",
)


OF_NO_PACKAGE = "in no package"  # a reason of `FILE_NOT_INSTALLED`


class Explanation(NamedTuple):
    """What is reported of an exception; file and line where they are not the launch file's."""

    rule: Rule
    message: str
    hint: str
    file: str | None = None
    line: int | None = None
    element: str | None = None
    written: str | None = None  # the text that is meant: its line is reported, where it has one
    reason: str | None = None  # which of the rule's mistakes it is


def of_xacro(error: BaseException, xacro_error: dict[str, Any] | None) -> Explanation | None:
    """What xacro reports; None where it is not about xacro."""
    outcome = getattr(error, "wsgen_outcome", None)
    found = xacro_error or (outcome.error if outcome is not None else None)
    if found is None:
        return None
    if found.get("glued"):
        return Explanation(
            GLUED_COMMAND,
            f"The command has no blank between xacro and its file: '{found['glued']}'.",
            "Write Command(['xacro ', path]), with a blank at the end of 'xacro '.",
            element="xacro",
            written="xacro",
        )
    if found.get("missing"):
        missing = _missing_file(found["missing"])
        # A line of a xacro file, where one includes what is missing.
        is_included = found.get("line") is not None
        return missing._replace(file=found["file"], line=found["line"]) if is_included else missing
    if found.get("package"):
        return missing_package(
            found["package"], found.get("file"), found.get("line"), found.get("hint")
        )
    return Explanation(
        XACRO_FAILS,
        f"xacro fails: {found['message']}",
        found.get("hint") or "Fix the xacro file; `xacro FILE` shows the same error.",
        found.get("file"),
        found.get("line"),
        found.get("element"),
    )


def package_error(error: BaseException) -> Explanation | None:
    """A package, or every package, that is not found."""
    if type(error).__name__ == "PackageNotFoundError":
        return missing_package(str(getattr(error, "name", error)))
    if isinstance(error, OSError) and "AMENT_PREFIX_PATH" in str(error):
        return Explanation(
            PACKAGE_NOT_FOUND,
            "No install space is sourced: AMENT_PREFIX_PATH is not set.",
            "Source install/setup.bash first.",
        )
    return None


_SURELY_RELEASED = 0.9  # so alike is a misspelled name to the released one of thousands


def missing_package(
    package: str, file: str | None = None, line: int | None = None, hint: str | None = None
) -> Explanation:
    """A package that is neither installed nor known; file and line where it is named."""
    misspelled = nearest(package, released_packages(), cutoff=_SURELY_RELEASED)
    return Explanation(
        PACKAGE_NOT_FOUND,
        f"The package '{package}' is not found.",
        hint
        or advice(
            package,
            [*packages(), *([misspelled] if misspelled else [])],
            f"Add <exec_depend>{package}</exec_depend> to package.xml, and build it in this "
            "workspace or install it.",
        ),
        file,
        line,
        package,
        package,
    )


def packages() -> set[str]:
    """The packages that are installed, and those that need not be."""
    from ament_index_python.packages import get_packages_with_prefixes

    return {*get_packages_with_prefixes(), *known_packages.names()}


def file_error(error: BaseException) -> Explanation | None:
    """A file that does not exist or cannot be read."""
    if not isinstance(error, OSError):
        return None
    if not isinstance(error, (FileNotFoundError, NotADirectoryError)):
        return Explanation(
            NOT_READABLE,
            f"The file '{error.filename}' cannot be read: {error.strerror or error}.",
            "Check the path and its permissions.",
        )
    shim = getattr(error, "wsgen_shim", None)
    if shim is not None:
        return Explanation(
            FILE_NOT_INSTALLED,
            f"{error}.",
            advice(shim.name, shim.names, "Check the path in the launch file."),
            element=shim.name,
            written=shim.name,
        )
    if error.filename is None:
        return Explanation(FILE_NOT_INSTALLED, f"{error}.", "Check the path in the launch file.")
    return _missing_file(os.fspath(error.filename))


def _missing_file(path: str) -> Explanation:
    package = known_packages.package_of(path)
    if package is not None and known_packages.is_in_shim(path):
        inside = known_packages.as_on_linux(path).rpartition(f"/share/{package}/")[2]
        return Explanation(
            PACKAGE_NOT_FOUND,
            f"The launch file needs '{inside}' of the package '{package}', "
            "which is not installed here.",
            f"Build {package} in this workspace, or source an installation that has it.",
            element=package,
        )
    joined = _of_join(path)
    if joined is not None:
        return joined
    missing, beside = first_missing(path)
    near = nearest(missing, beside)
    if near is not None and not _is_of_another_kind(missing, near):
        return Explanation(
            FILE_NOT_INSTALLED,
            f"The file '{path}' does not exist.",
            did_you_mean(near),
            element=missing,
            written=missing,
        )
    if package is not None and (known_packages.is_known(package) or is_source(path)):
        otherwise = "; run `wsgen build` if the build makes it" if is_source(path) else ""
        return Explanation(
            FILE_NOT_INSTALLED,
            f"The package '{package}' has no file '{path}'.",
            f"Check the path in the launch file{otherwise}.",
            element=path,
        )
    place = find_in_package(path)
    if package is None or place is not None:
        where = in_python(place) if place else "get_package_share_directory('PACKAGE')"
        return Explanation(
            FILE_NOT_INSTALLED,
            f"The file '{path}' does not exist.",
            f"Look it up in the share folder of a package: {where}.",
            element=path,
            reason=OF_NO_PACKAGE,
        )
    inside = known_packages.as_on_linux(path).rpartition(f"/share/{package}/")[2]
    folder, found, _ = inside.partition("/")
    what = f"DIRECTORY {folder}" if found else f"FILES {inside}"
    return Explanation(
        FILE_NOT_INSTALLED,
        f"'{inside}' is not in the install space of {package}: '{path}' does not exist.",
        f"Install it: install({what} DESTINATION share/${{PROJECT_NAME}}) in the CMakeLists.txt "
        f"of {package}, above ament_package(), then build again. If that is there, check the "
        "spelling of the path.",
        element=path,
    )


def _is_of_another_kind(missing: str, near: str) -> bool:
    """Whether names differ in their endings alone, and those are not alike: .urdf and .config."""
    (stem, ending), (other, its_ending) = os.path.splitext(missing), os.path.splitext(near)
    return stem == other and nearest(ending, [its_ending]) is None


def _of_join(path: str) -> Explanation | None:
    """A path that was joined in another way than was meant."""
    absolute = absolute_part(path, RECORD.launch_files)
    if absolute is not None:
        return Explanation(
            FILE_NOT_INSTALLED,
            f"The file '{path}' does not exist: {absolute.message}",
            absolute.hint,
            absolute.file,
            absolute.line,
            absolute.text,
        )
    glued = glued_package(path)
    if glued is None:
        return None
    return Explanation(
        FILE_NOT_INSTALLED,
        f"The file '{path}' does not exist: '/' is missing after the share folder of {glued}.",
        f"Write os.path.join(get_package_share_directory('{glued}'), ...).",
        element=path,
    )


def glued_package(path: str) -> str | None:
    """The package whose share folder has become one word with what should be in it."""
    share, found, rest = path.replace(os.sep, "/").rpartition("/share/")
    name = rest.split("/", 1)[0]
    if not found or os.path.isdir(f"{share}/share/{name}"):
        return None
    try:
        glued = [other for other in os.listdir(f"{share}/share") if name.startswith(other)]
    except (OSError, ValueError):
        return None
    return max(glued, key=len, default=None)


_NO_EXECUTABLE = lazy_pattern(r"executable '(.*)' not found on the libexec directory '(.*)'")


def uncompiled(error: BaseException) -> tuple[str, str] | None:
    """The program that an exception is about, and its package, if it cannot be compiled here."""
    found = _NO_EXECUTABLE.match(str(error))
    if found is None:
        return None
    program, folder = found.groups()
    names = os.listdir(folder) if os.path.isdir(folder) else []
    package = os.path.basename(folder)
    left_out = targets_left_out(folder, package)
    if program in (left_out or ()):
        return program, package
    is_misspelled = nearest(program, names, cutoff=known_packages.SURELY) is not None
    may_lack = left_out is not None or needs_missing_library(folder, package)
    return (program, package) if may_lack and not is_misspelled else None


def executable_error(error: BaseException) -> Explanation | None:
    """A program that a package does not have."""
    found = _NO_EXECUTABLE.match(str(error))
    if found is None:
        return None
    program, folder = found.groups()
    try:
        names = os.listdir(folder)
    except OSError:
        names = []
    package = os.path.basename(folder)
    known = sorted({*names, *known_packages.programs_of(package)})
    near = nearest(program, known)
    script = os.path.join(os.path.dirname(os.path.dirname(folder)), "bin", program)
    if os.path.isfile(script):
        return Explanation(
            EXECUTABLE_NOT_FOUND,
            f"'{program}' of the package '{package}' is installed into bin, but `launch` looks "
            f"in lib/{package}.",
            f"Write in setup.cfg of {package}: [install] install_scripts=$base/lib/{package}, and "
            f"[develop] script_dir=$base/lib/{package}; then run `wsgen build`.",
            element=program,
            written=program,
        )
    if not known_packages.is_known(package):
        hint = advice(
            program,
            known,
            "Let CMakeLists.txt install it to lib/${PROJECT_NAME}; in setup.py, add it to "
            "console_scripts, and let setup.cfg install it to lib/PACKAGE.",
        )
    elif near is not None:
        hint = did_you_mean(near)
    else:
        hint = f"Use one of {', '.join(known)}." if known else "Check the spelling."
    return Explanation(
        EXECUTABLE_NOT_FOUND,
        f"The package '{package}' has no executable '{program}'.",
        hint,
        element=program,
        written=program,
    )


def or_unused_action(
    missing: Diagnostic, plan: LaunchPlan, *kinds: str, names: Collection[str]
) -> Diagnostic:
    """What is reported as missing; or, as an error, the action that was created and never added.

    `kinds` are the classes of such actions; `names` the programs, launch files and packages of
    which they name one.
    """
    for action in unused_actions(plan.evaluated_files, kinds):
        if not action.words.isdisjoint(names):
            return replace(
                missing,
                severity=Severity.ERROR,
                message=f"{missing.message.rstrip('.')}: `{action.name}` is created but not "
                "added to the LaunchDescription.",
                file=action.file,
                line=action.line,
                element=action.name,
                hint=f"Add it to the LaunchDescription that is returned: add_action({action.name})"
                ".",
            )
    return missing
