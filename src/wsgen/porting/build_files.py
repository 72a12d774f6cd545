"""Port CMakeLists.txt, setup.py and the hooks that set variables of Gazebo."""

from __future__ import annotations

import ast
import re
from itertools import takewhile
from typing import TYPE_CHECKING

from wsgen.checks.fixes.build_files import add_to_data_files, install_beside, read_commands
from wsgen.checks.fixes.source import Edit, join_additions
from wsgen.gazebo.successors import VARIABLES
from wsgen.porting.manifests import MESSAGES, SUCCESSORS, code_with, naming
from wsgen.porting.ported import FilePort, Unported
from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.checks.fixes.build_files import Argument, Command
    from wsgen.checks.fixes.source import SourceText


# Package that CMake finds -> what is found in its place; empty: only compiling needs it.
_FOUND = {
    "gazebo": "",
    "gazebo_dev": "",
    MESSAGES: "",
    **{
        name: SUCCESSORS[name]
        for name in ("gazebo_ros", "gazebo_ros_pkgs", "gazebo_plugins", "gazebo_ros2_control")
    },
}
_LISTS = (
    *("ament_target_dependencies", "ament_export_dependencies", "ament_export_libraries"),
    *("set", "list", "foreach"),
)
_OF_TARGETS = ("ament_target_dependencies", "target_link_libraries")
_TARGETS = ("add_library", "add_executable", "ament_auto_add_library", "ament_auto_add_executable")
# Commands whose first argument is a target.
_ABOUT_A_TARGET = (
    *_TARGETS,
    *("ament_target_dependencies", "target_link_libraries", "target_include_directories"),
    *("target_compile_options", "target_compile_features", "target_compile_definitions"),
    *("target_link_options", "set_target_properties", "add_dependencies", "target_sources"),
)
_OF_INSTALL = (
    *("EXPORT", "ARCHIVE", "LIBRARY", "RUNTIME", "DESTINATION", "INCLUDES", "OBJECTS"),
    *("COMPONENT", "OPTIONAL", "PERMISSIONS"),
)
_INSTALLED = re.compile(r"/usr/share/(?:gazebo|ignition)\b[^\s\"';:]*")
_NAMES_INSTALLED = re.compile(rf"\s*(?:export\s+)?(\w+)=[\"']?{_INSTALLED.pattern}[\"']?\s*")
_IS_FOUND = re.compile(r"gazebo(?:_\w+)?_FOUND")
_SCOPES = ("PUBLIC", "PRIVATE", "INTERFACE", "SYSTEM", "BEFORE", "AFTER")
_HEADER = rb"#\s*include\s*[<\"]gazebo(?:_\w+)?/"
_VARIABLE = r"\$\{(?:GAZEBO|gazebo\w*)_[A-Z_]+\}"
_NAMES = re.compile(rf"{'|'.join(_FOUND)}|{_VARIABLE}|GazeboPlugin")
# Command -> how many arguments it has when it does nothing.
_EMPTY = {
    **dict.fromkeys(("include_directories", "link_directories", "link_libraries"), 0),
    **dict.fromkeys(("add_definitions", "add_compile_options"), 0),
    **dict.fromkeys(("ament_export_dependencies", "ament_export_libraries"), 0),
    **dict.fromkeys(("target_link_libraries", "ament_target_dependencies", "set"), 1),
    **dict.fromkeys(("target_include_directories", "target_compile_options"), 1),
    "list": 2,
}
_PAIR = 2  # NOT and a name
_SOURCE_LIMIT = 2**20  # bytes


def port_cmake(source: SourceText, folders: Collection[str] = ()) -> FilePort:
    """Find what the target has, and install folders that other parts of the port create.

    A target that is compiled against Gazebo Classic stays, and is built where that is found.
    """
    commands = read_commands(source)
    compiled = list(_compiled(source, commands))
    edits = list(
        _built_with_classic(source, commands, compiled)
        if compiled
        else _without_classic(source, commands)
    )
    added = [one for one in sorted(folders) if not _is_installed(commands, one)]
    edits += join_additions(
        edit for folder in added for edit in _installing(source, commands, folder)
    )
    guarded = _guarded(commands)
    unported = [_unported_target(source, one) for one in compiled if one not in guarded]
    left = [] if compiled else [first for first, _ in _skipping(commands)]
    conditions = _conditions(source, [one for one in commands if one not in left])
    return FilePort(edits=tuple(edits), unported=(*unported, *conditions))


def _unported_target(source: SourceText, command: Command) -> Unported:
    name = command.arguments[0].text
    return Unported(
        source.file,
        source.line_at(command.start),
        f"The target `{name}` is compiled against Gazebo Classic: it is only built where that is "
        "found, and Gazebo Sim cannot load it.",
        f"Port its source to a system of gz-sim, or remove `{name}`.",
    )


def _guarded(commands: Sequence[Command]) -> list[Command]:
    """The commands that are only run where Gazebo Classic is found."""
    found: list[Command] = []
    opened: list[bool] = []
    for command in commands:
        if command.name == "if":
            words = [one.text for one in command.arguments]
            opened.append(len(words) == 1 and _IS_FOUND.fullmatch(words[0]) is not None)
        elif command.name in {"else", "elseif"} and opened:
            opened[-1] = False
        elif command.name == "endif" and opened:
            opened.pop()
        elif any(opened):
            found.append(command)
    return found


def _built_with_classic(
    source: SourceText, commands: Sequence[Command], compiled: Sequence[Command]
) -> Iterator[Edit]:
    """Have the other targets be built where Gazebo Classic is not found."""
    names = {one.arguments[0].text for one in compiled}
    found = [
        one.arguments[0].text
        for one in commands
        if one.name == "find_package" and one.arguments and one.arguments[0].text in _FOUND
    ]
    # Gazebo itself may be installed where ROS has nothing for it.
    condition = next((name for name in reversed(_FOUND) if name in {*found} - {MESSAGES}), None)
    if condition is None:
        return
    guarded = _guarded(commands)
    own: list[Command] = []
    for command in (one for one in commands if one not in guarded):
        first = command.arguments[0].text if command.arguments else ""
        if command.name == "find_package" and first in _FOUND:
            yield from (
                Edit(start=one.start, end=one.end, text="QUIET")
                for one in command.arguments
                if one.text == "REQUIRED"
            )
        elif command.name in _ABOUT_A_TARGET and first in names:
            own.append(command)
        elif command.name == "install" and first == "TARGETS":
            listed, end = _installed(command, names)
            if listed and len(listed) == end - 1:
                own.append(command)
            elif listed:
                yield from _installed_apart(source, command, listed, end, condition)
        elif command.name in {"ament_export_dependencies", "ament_target_dependencies"}:
            gone = dict.fromkeys({*_FOUND} - {"gazebo_ros2_control"}, "")
            yield from _in_command(source, command, gone)
        elif command.name == "ament_export_libraries":
            yield from _in_command(source, command, dict.fromkeys(names, ""))
    yield from _wrapped(source, commands, own, condition)


def _installed(command: Command, names: Collection[str]) -> tuple[list[Argument], int]:
    """Those of some targets that a command installs, and where its options begin."""
    words = [one.text for one in command.arguments]
    end = next((n for n, word in enumerate(words) if word in _OF_INSTALL), len(words))
    return [one for one in command.arguments[1:end] if one.text in names], end


def _wrapped(
    source: SourceText, commands: Sequence[Command], own: Sequence[Command], condition: str
) -> Iterator[Edit]:
    """Put commands into a condition, those that follow each other into one."""
    for place, command in enumerate(commands):
        if command not in own:
            continue
        start = source.whole_lines(command.start, command.end)[0]
        indent, newline = source.indent_at(command.start), source.newline
        if place == 0 or commands[place - 1] not in own:
            text = f"{indent}if({condition}_FOUND){newline}"
            yield Edit(start=start, end=start, text=text)
        if place + 1 == len(commands) or commands[place + 1] not in own:
            # On its line, what is behind it may be removed.
            text = f"{newline}{indent}endif()"
            yield Edit(start=command.end, end=command.end, text=text)


def _installed_apart(
    source: SourceText, command: Command, listed: Sequence[Argument], rest: int, condition: str
) -> Iterator[Edit]:
    """Install some of the targets of a command only where Gazebo Classic is found."""
    for one in listed:
        yield _without_argument(source, one)
    newline, indent = source.newline, source.indent_at(command.start)
    names = " ".join(source.text[one.start : one.end] for one in listed)
    behind = command.arguments[rest - 1].end
    options = source.text[behind : command.end]
    text = (
        f"{newline}{indent}if({condition}_FOUND)"
        f"{newline}{indent}install(TARGETS {names}{options}"
        f"{newline}{indent}endif()"
    )
    yield Edit(start=command.end, end=command.end, text=text)


def _compiled(source: SourceText, commands: Sequence[Command]) -> Iterator[Command]:
    """The targets whose sources include headers of Gazebo Classic, or whose libraries are its."""
    folder = source.file.parent
    linked = {
        command.arguments[0].text
        for command in commands
        if command.name in _OF_TARGETS
        and any(_NAMES.fullmatch(one.text) for one in command.arguments[1:])
    }
    targets = [one for one in commands if one.name in _TARGETS and one.arguments]
    if not targets or code_with(folder, _HEADER) is None:
        return
    # Headers of the package may include those of Gazebo.
    headers = {file.name.encode() for file in folder.rglob("*.h*") if _includes(file, _HEADER)}
    own = rb"#\s*include\s*[<\"](?:[^>\"\n]*/)?(?:%s)[>\"]" % b"|".join(map(re.escape, headers))
    pattern = b"|".join((_HEADER, own)) if headers else _HEADER
    for command in targets:
        written = [one.text for one in command.arguments[1:]]
        includes = [_includes(folder / one, pattern) for one in written if "." in one]
        is_known = bool(includes) and None not in includes and "$" not in "".join(written)
        if any(includes) or (command.arguments[0].text in linked and not is_known):
            yield command


def _includes(file: Path, pattern: bytes) -> bool | None:
    """Whether a file has an `#include` of a pattern; None where it cannot be read."""
    try:
        return re.search(pattern, read_regular(file, _SOURCE_LIMIT)) is not None
    except (OSError, ValueError):
        return None


def _tested(commands: Iterable[Command]) -> Iterator[tuple[Command, Argument]]:
    """Conditions on whether Gazebo Classic itself is there."""
    for command in commands:
        if command.name in {"if", "elseif", "while"}:
            for one in command.arguments:
                if re.fullmatch(r"gazebo(?:_dev|_msgs)?_FOUND", one.text):
                    yield command, one


def _skipping(commands: Sequence[Command]) -> Iterator[tuple[Command, Command]]:
    """Conditions, with their ends, that only leave the file where Gazebo Classic is not there."""
    for place, command in enumerate(commands):
        words = [one.text for one in command.arguments]
        if command.name == "if" and words[:1] == ["NOT"] and len(words) == _PAIR:
            inside = [
                *takewhile(lambda one: one.name in {"message", "return"}, commands[place + 1 :])
            ]
            end = next(iter(commands[place + 1 + len(inside) :]), None)
            if (
                inside
                and end is not None
                and end.name == "endif"
                and any(map(bool, _tested([command])))
            ):
                yield command, end


def _conditions(source: SourceText, commands: Sequence[Command]) -> Iterator[Unported]:
    for command, one in _tested(commands):
        if len(command.arguments) == 1:
            continue  # what needs it is left out
        yield Unported(
            source.file,
            source.line_at(command.start),
            f"CMakeLists.txt depends on `{one.text}`, which is false without Gazebo Classic.",
            "Remove the condition, and find_package() of what it is about.",
        )


def _without_classic(source: SourceText, commands: Sequence[Command]) -> Iterator[Edit]:
    skipping = [*_skipping(commands)]
    for first, last in skipping:
        start, end = source.whole_lines(first.start, last.end)
        yield Edit(start=start, end=end, text="")
    tested = _tested(one for one in commands if one not in [first for first, _ in skipping])
    kept = {one.text.removesuffix("_FOUND") for _, one in tested}
    if code_with(source.file.parent, naming(MESSAGES)):
        kept.add(MESSAGES)
    becomes = {name: new for name, new in _FOUND.items() if name not in kept}
    found = {
        command.arguments[0].text
        for command in commands
        if command.name == "find_package" and command.arguments
    }
    for command in commands:
        words = command.arguments
        if command.name == "find_package" and words and words[0].text in becomes:
            new = becomes[words[0].text]
            if not new or new in found:
                yield _removed(source, command)
            else:
                found.add(new)
                yield Edit(start=words[0].start, end=words[0].end, text=new)
        else:
            yield from _in_command(source, command, becomes)


def _in_command(source: SourceText, command: Command, becomes: dict[str, str]) -> Iterator[Edit]:
    """Rename what a command lists, and take out variables that stay empty."""
    gone: list[Argument] = []
    edits: list[Edit] = []
    listed = {one.text for one in command.arguments}
    for place, one in enumerate(command.arguments):
        renamed = re.sub(
            r"\b(gazebo_\w+)_FOUND\b",
            lambda match: f"{becomes.get(match[1]) or match[1]}_FOUND",
            one.text,
        )
        stripped = re.sub(rf"[ ]?{_VARIABLE}", "", one.text)
        is_listed = place > 0 or command.name.startswith("ament_export_")
        if is_listed and command.name in _LISTS and one.text in {*becomes} - {"gazebo"}:
            new = becomes[one.text]
            if new and new not in listed:
                listed.add(new)
                edits.append(Edit(start=one.start, end=one.end, text=new))
            else:
                gone.append(one)
        elif command.name in {"if", "elseif"} and renamed != one.text:
            edits.append(Edit(start=one.start, end=one.end, text=renamed))
        elif stripped != one.text and not stripped.strip():
            gone.append(one)
        elif stripped != one.text and command.name in _EMPTY:
            if command.name == "set" and stripped == f"${{{command.arguments[0].text}}}":
                gone.append(one)
            else:
                written = source.text[one.start : one.end]
                edits.append(
                    Edit(start=one.start, end=one.end, text=written.replace(one.text, stripped))
                )
    left = [one for one in command.arguments if one not in gone and one.text not in _SCOPES]
    if gone and len(left) <= _EMPTY.get(command.name, -1):
        yield _removed(source, command)
        return
    yield from edits
    for one in gone:
        yield _without_argument(source, one)


def _removed(source: SourceText, command: Command) -> Edit:
    start, end = source.whole_lines(command.start, command.end)
    return Edit(start=start, end=end, text="")


def _without_argument(source: SourceText, one: Argument) -> Edit:
    start, end = source.whole_lines(one.start, one.end)
    if (start, end) == (one.start, one.end):
        first = source.start_of(source.line_at(start))
        before = source.text[first:start]
        if before.strip():
            start = first + len(before.rstrip())
    return Edit(start=start, end=end, text="")


def _is_installed(commands: Sequence[Command], folder: str) -> bool:
    """Whether a command installs a folder, or the whole package."""
    for command in commands:
        words = [one.text for one in command.arguments]
        if command.name == "ament_auto_package" and folder in words:
            return True
        if command.name == "install" and words[:1] == ["DIRECTORY"]:
            end = words.index("DESTINATION") if "DESTINATION" in words else len(words)
            paths = {re.sub(r"^(?:\$\{\w+\}/|\./)", "", one).rstrip("/") for one in words[1:end]}
            if paths & {folder, folder.partition("/")[0], ".", ""}:
                return True
    return False


def _installing(source: SourceText, commands: Sequence[Command], folder: str) -> list[Edit]:
    for command in commands:
        words = command.arguments
        if command.name == "ament_auto_package" and any(
            one.text == "INSTALL_TO_SHARE" for one in words
        ):
            last = words[-1]
            before = source.text[words[-2].end : last.start]
            return [Edit(start=last.end, end=last.end, text=f"{before}{folder}")]
    return install_beside(source, folder, is_new=not (source.file.parent / folder).exists())


def port_setup(source: SourceText, folders: Collection[str]) -> FilePort:
    """Install folders that other parts of the port create."""
    try:
        tree = ast.parse(source.text)
    except (SyntaxError, ValueError):
        return FilePort()
    words = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    imports_glob = any(
        isinstance(node, ast.ImportFrom)
        and node.module == "glob"
        and any(one.name == "glob" and one.asname is None for one in node.names)
        for node in tree.body
    )
    imports_module = any(
        isinstance(node, ast.Import) and any(one.name == "glob" for one in node.names)
        for node in tree.body
    )
    edits: list[Edit] = []
    for folder in sorted(folders):
        if any(re.match(rf"{re.escape(folder)}(?:/|\Z)", one) for one in words):
            continue
        call = "glob.glob" if imports_module and not imports_glob else "glob"
        name = _package_name(tree)
        place = f"'share/{name}/{folder}'" if name else f"'share/' + package_name + '/{folder}'"
        has_folders = any(one.is_dir() for one in (source.file.parent / folder).glob("*"))
        files = "*.*" if has_folders else "*"  # data_files takes no folders
        edits += add_to_data_files(source, f"({place}, {call}('{folder}/{files}'))")
    if edits and not (imports_glob or imports_module):
        edits.append(_import_of_glob(source, tree))
    return FilePort(edits=tuple(join_additions(edits)))


def _package_name(tree: ast.Module) -> str | None:
    """The name that setup() has as a text; None where `package_name` has it, as is usual."""
    if any(
        isinstance(node, ast.Assign)
        and any(isinstance(one, ast.Name) and one.id == "package_name" for one in node.targets)
        for node in tree.body
    ):
        return None
    for node in ast.walk(tree):
        if isinstance(node, ast.keyword) and node.arg == "name":
            return str(node.value.value) if isinstance(node.value, ast.Constant) else None
    return None


def _import_of_glob(source: SourceText, tree: ast.Module) -> Edit:
    """Import it in front of the first import: that is where isort puts it, but for `os`."""
    first = next((one for one in tree.body if isinstance(one, ast.Import | ast.ImportFrom)), None)
    place = source.start_of(first.lineno if first else 1)
    return Edit(start=place, end=place, text=f"from glob import glob{source.newline}")


def _tests_of_classic(lines: Sequence[str]) -> tuple[set[int], set[int]]:
    """What asks in a hook whether a simulator is installed that Gazebo Sim does without.

    Returns:
        The numbers of lines that go, and of those that always apply then: conditions without an
        `else`, what they load, and variables that name the simulator for them.
    """
    names = {
        found[1]: number
        for number, line in enumerate(lines)
        if (found := _NAMES_INSTALLED.fullmatch(line))
    }
    about = re.compile(rf"{_INSTALLED.pattern}|\$\{{?(?:{'|'.join(names) or '(?!)'})\b")
    gone: set[int] = set()
    inside: set[int] = set()
    opened: list[tuple[int, bool]] = []
    for number, line in enumerate(lines):
        words = re.split(r"[\s;]+", line.strip())
        if words[0] == "if":
            is_plain = about.search(line) is not None and re.search(r"!|&&|\|\|", line) is None
            opened.append((number, is_plain))
        elif words[0] in {"else", "elif"} and opened:
            opened[-1] = number, False
        elif words[0] == "fi" and opened:
            start, is_about = opened.pop()
            if is_about and words == ["fi"] and lines[start].rstrip().endswith("then"):
                gone |= {start, number}
                inside |= set(range(start + 1, number))
    gone |= {
        one
        for one in inside
        if re.match(r"\s*(?:source|\.)\s", lines[one]) and about.search(lines[one])
    }
    left = [line for number, line in enumerate(lines) if number not in gone]
    gone |= {
        number
        for name, number in names.items()
        if gone and not any(re.search(rf"\$\{{?{name}\b", line) for line in left)
    }
    return gone, inside


def port_hook(source: SourceText) -> FilePort:
    """Set the variables of Gazebo Sim in a hook of the environment, each with a value once."""
    edits: list[Edit] = []
    unported: list[Unported] = []
    lines = [*re.finditer(r"[^\n]+(?:\n|\Z)", source.text)]
    gone, inside = _tests_of_classic([one[0] for one in lines])
    seen = {one[0].strip() for one in lines}
    for number, found in enumerate(lines):
        if number in gone:
            edits.append(Edit(start=found.start(), end=found.end(), text=""))
            continue
        kept = re.sub(r"^(?:\t| {1,4})", "", found[0]) if number in inside else found[0]
        line = re.sub(rf"\b(?:{'|'.join(VARIABLES)})\b", lambda name: VARIABLES[name[0]], kept)
        if line != found[0]:
            # A line of a branch may be all of it.
            is_repeated = line != kept and line.strip() in seen and not line[:1].isspace()
            seen.add(line.strip())
            text = "" if is_repeated else line
            edits.append(Edit(start=found.start(), end=found.end(), text=text))
        installed = _INSTALLED.search(line)
        if installed is not None and not line.lstrip().startswith("#"):
            unported.append(
                Unported(
                    source.file,
                    source.line_at(found.start()),
                    f"`{installed[0]}` does not exist where Gazebo Sim alone is installed.",
                    "Remove what it is needed for, and the condition around the rest.",
                )
            )
    return FilePort(edits=tuple(edits), unported=tuple(unported))
