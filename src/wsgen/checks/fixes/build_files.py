"""Fixes in CMakeLists.txt, setup.py and setup.cfg."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import Edit, is_surely
from wsgen.packages.build_files.cmake_checks import MISNAMED_LANGUAGES
from wsgen.packages.build_files.cmake_text import BRACKET, QUOTED, parse
from wsgen.text.suggestions import suggested

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.diagnostics import Diagnostic


class Argument(NamedTuple):
    """An argument of a command."""

    start: int
    end: int
    text: str  # without quotes


class Command(NamedTuple):
    """A call of a command."""

    name: str  # in lower case
    start: int  # of its name
    end: int  # behind its closing parenthesis
    arguments: tuple[Argument, ...]


def read_commands(source: SourceText) -> list[Command]:
    """All calls before the first mistake of syntax, in the order of the text."""
    calls, _ = parse(source.text)
    return [
        Command(
            call.command,
            call.start,
            call.stop,
            tuple(
                Argument(one.start, one.stop, one.text)
                for one in call.written
                if one.kind in {QUOTED, BRACKET} or one.text not in {"(", ")"}
            ),
        )
        for call in calls
    ]


def command_at(source: SourceText, line: int | None, *names: str) -> Command | None:
    """The call with one of these names that a line is in; None where several are."""
    on_line = [
        command
        for command in read_commands(source)
        if command.name in names
        and source.line_at(command.start) <= (line or 0) <= source.line_at(command.end - 1)
    ]
    return on_line[0] if len(on_line) == 1 else None


SHARE = "share/${PROJECT_NAME}"


def _destination(command: Command) -> Argument | None:
    """The argument of DESTINATION, if the call has one."""
    for keyword, argument in zip(command.arguments, command.arguments[1:], strict=False):
        if keyword.text == "DESTINATION":
            return argument
    return None


def _folders(command: Command) -> list[Argument]:
    """The folders of install(DIRECTORY ...)."""
    words = command.arguments
    if not words or words[0].text != "DIRECTORY":
        return []
    end = next(
        (n for n, one in enumerate(words) if one.text in {"DESTINATION", "TYPE"}), len(words)
    )
    return list(words[1:end])


def remove_last_slashes(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install folders, and not what is in them."""
    command = command_at(source, diagnostic.line, "install")
    if command is None:
        return []
    return [
        Edit(start=one.start, end=one.end, text=source.text[one.start : one.end].replace("/", ""))
        for one in _folders(command)
        if re.fullmatch(r"\w+/", one.text)
    ]


def shorten_destination(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install a folder beside the others, and not into one of its own name."""
    command = command_at(source, diagnostic.line, "install")
    place = command and _destination(command)
    if command is None or place is None or len(_folders(command)) != 1:
        return []
    name = _folders(command)[0].text
    parent, _, last = place.text.rstrip("/").rpartition("/")
    if last != name or not parent:
        return []
    written = source.text[place.start : place.end]
    return [Edit(start=place.start, end=place.end, text=written.replace(place.text, parent))]


_NO_DOLLAR = re.compile(r"(?<!\$)\{PROJECT_NAME\}|\$?\(PROJECT_NAME\)|\$PROJECT_NAME\b")
_NOT_SET = re.compile(r"whose variable (\w+) is not set")


def fix_destination(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install into the share folder of the package."""
    command = command_at(source, diagnostic.line, "install")
    if command is None:
        return []
    place = _destination(command)
    if place is None:
        return _replace_type(command)
    written = source.text[place.start : place.end]
    unset = _NOT_SET.search(diagnostic.message)
    if unset is not None:
        text = written.replace(f"${{{unset[1]}}}", "${PROJECT_NAME}")
    elif _NO_DOLLAR.search(written):
        text = _NO_DOLLAR.sub("${PROJECT_NAME}", written)
    elif place.text.rstrip("/") == "share":
        text = written.replace(place.text, SHARE)
    elif place.text.startswith("${PROJECT_NAME}"):
        text = written.replace("${PROJECT_NAME}", SHARE, 1)
    else:
        return []
    return [Edit(start=place.start, end=place.end, text=text)] if text != written else []


def _replace_type(command: Command) -> Sequence[Edit]:
    for keyword, argument in zip(command.arguments, command.arguments[1:], strict=False):
        if keyword.text == "TYPE" and argument.text == "DATA":
            return [Edit(start=keyword.start, end=argument.end, text=f"DESTINATION {SHARE}")]
    return []


OLDEST_CMAKE = "3.8"  # of the supported distributions' templates
NEWEST_CMAKE = "3.31"  # the newest that all of them were tested with
RANGE = f"{OLDEST_CMAKE}...{NEWEST_CMAKE}"
VERSION = re.compile(r"(\d+)\.(\d+)(?:\.\d+)*(?:\.\.\.\d+(?:\.\d+)+)?")
SHARED = ("DIRECTORY", "FILES")
RUN = ("PROGRAMS", "TARGETS")
OPTIONS = frozenset(
    (
        *("PATTERN", "REGEX", "EXCLUDE", "PERMISSIONS", "RENAME", "OPTIONAL", "COMPONENT"),
        *("CONFIGURATIONS", "EXCLUDE_FROM_ALL", "FILES_MATCHING", "USE_SOURCE_PERMISSIONS"),
        *("FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "MESSAGE_NEVER", "TYPE"),
        *("ARCHIVE", "LIBRARY", "RUNTIME", "EXPORT", "INCLUDES", "OBJECTS", "FRAMEWORK", "BUNDLE"),
    )
)


def _append(source: SourceText, text: str) -> list[Edit]:
    """Add a line at the end."""
    end = len(source.text)
    before = "" if not source.text or source.text.endswith("\n") else source.newline
    return [Edit(start=end, end=end, text=f"{before}{text}{source.newline}")]


def _first(source: SourceText, text: str) -> list[Edit]:
    return [Edit(start=0, end=0, text=f"{text}{source.newline}")]


def _remove(source: SourceText, start: int, end: int) -> list[Edit]:
    start, end = source.whole_lines(start, end)
    return [Edit(start=start, end=end, text="")]


def add_ament_package(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Call ament_package() at the end; nothing is found before it is called."""
    commands = read_commands(source)
    names = [command.name for command in commands]
    if "ament_package" in names or "ament_auto_package" in names or "project" not in names:
        return []
    found = [one for one in commands if one.name == "find_package" and one.arguments]
    edits = _append(source, "ament_package()")
    if not any(one.arguments[0].text.startswith("ament_cmake") for one in found):
        place = next(command.end for command in commands if command.name == "project")
        added = f"{source.newline}find_package(ament_cmake REQUIRED)"
        edits.append(Edit(start=place, end=place, text=added))
    return edits


def remove_repeated_ament_package(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Keep the last call of ament_package(), which must follow all others."""
    calls = [command for command in read_commands(source) if command.name == "ament_package"]
    if len({_words(one) for one in calls}) > 1 or not _are_all_run(calls, source):
        return []
    return [edit for call in calls[:-1] for edit in _remove(source, call.start, call.end)]


def _words(command: Command) -> tuple[str, ...]:
    return tuple(argument.text for argument in command.arguments)


def _are_all_run(calls: Sequence[Command], source: SourceText) -> bool:
    """Whether no call may be skipped: else only one of two could be meant to run."""
    is_whole = all(command.name != "return" for command in read_commands(source))
    return is_whole and not any(_depth(source, call) for call in calls)


def move_ament_package(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Move the only call of ament_package() to the end."""
    calls = [command for command in read_commands(source) if command.name == "ament_package"]
    if len(calls) != 1 or _depth(source, calls[0]):
        return []
    call = calls[0]
    text = source.text[call.start : call.end]
    return [*_remove(source, call.start, call.end), *_append(source, text)]


def _depth(source: SourceText, call: Command) -> int:
    """How many blocks are open where a command is called."""
    before = [one.name for one in read_commands(source) if one.start < call.start]
    blocks = ("if", "foreach", "while", "function", "macro", "block")
    return sum(name in blocks for name in before) - sum(name[3:] in blocks for name in before)


def fix_cmake_minimum(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Ask for a range of versions: the oldest stays unless CMake no longer knows it."""
    command = command_at(source, diagnostic.line, "cmake_minimum_required")
    if command is None:
        calls = [one for one in read_commands(source) if one.name == "cmake_minimum_required"]
        command = calls[0] if len(calls) == 1 else None
    for argument in command.arguments if command else ():
        version = VERSION.fullmatch(argument.text)
        if version is not None:
            oldest = max((3, 8), (int(version[1]), int(version[2])))
            text = f"{oldest[0]}.{oldest[1]}...{NEWEST_CMAKE}"
            if argument.text == text or oldest >= (3, 31):
                return []
            return [Edit(start=argument.start, end=argument.end, text=text)]
    return []


def add_cmake_minimum(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Call cmake_minimum_required() first."""
    if any(one.name == "cmake_minimum_required" for one in read_commands(source)):
        return []
    return _first(source, f"cmake_minimum_required(VERSION {RANGE})")


_PROJECT = re.compile(r"project\((\w+)\)")


def add_project(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Call project() after cmake_minimum_required(), with the name that the hint gives."""
    commands = read_commands(source)
    named = _PROJECT.search(diagnostic.hint or "")
    if named is None or any(one.name == "project" for one in commands):
        return []
    minimum = next((one for one in commands if one.name == "cmake_minimum_required"), None)
    if minimum is None:
        return _first(source, named[0])
    return [Edit(start=minimum.end, end=minimum.end, text=f"{source.newline}{named[0]}")]


def fix_project_name(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Name the project like the package, unless the folder has the name of the project."""
    named = _PROJECT.search(diagnostic.hint or "")
    calls = [one for one in read_commands(source) if one.name == "project" and one.arguments]
    if named is None or len(calls) != 1:
        return []
    first = calls[0].arguments[0]
    folder = diagnostic.file.parent.name if diagnostic.file else None
    if "$" in first.text or first.text in {named[1], folder}:
        return []
    return [Edit(start=first.start, end=first.end, text=named[1])]


def fix_language(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write CXX for C++."""
    command = command_at(source, diagnostic.line, "project", "enable_language")
    return (
        [
            Edit(
                start=argument.start,
                end=argument.end,
                text=MISNAMED_LANGUAGES[argument.text.upper()],
            )
            for argument in (command.arguments[1 if command.name == "project" else 0 :])
            if argument.text.upper() in MISNAMED_LANGUAGES
        ]
        if command
        else []
    )


def fix_command_name(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested command."""
    meant = (suggested(diagnostic.hint) or "").rstrip("()")
    written = re.search(r"command (\w+)\(\)", diagnostic.message)
    if not meant or written is None or not is_surely(written[1], meant):
        return []
    command = command_at(source, diagnostic.line, written[1].lower())
    if command is None:
        return []
    return [Edit(start=command.start, end=command.start + len(written[1]), text=meant)]


_KEYWORD = re.compile(r"(\w+)\(\) has no keyword (\w+)\.")


def fix_keyword(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested keyword."""
    named, meant = _KEYWORD.search(diagnostic.message), suggested(diagnostic.hint)
    if named is None or meant is None:
        return []
    written = [
        argument
        for command in read_commands(source)
        if command.name == named[1]
        for argument in command.arguments
        if argument.text == named[2] and source.line_at(argument.start) == diagnostic.line
    ]
    return [Edit(start=one.start, end=one.end, text=meant) for one in written[:1]]


def add_destination(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give install() the destination in which ROS looks."""
    command = command_at(source, diagnostic.line, "install")
    if command is None or not command.arguments:
        return []
    words = _words(command)
    kind = words[0]
    if "DESTINATION" in words or OPTIONS & {*words} or kind not in {*SHARED, *RUN}:
        return []
    place = "share" if kind in SHARED else "lib"
    end = command.arguments[-1].end
    destination = f"DESTINATION {place}/${{PROJECT_NAME}}"
    is_on_lines = "\n" in source.text[command.start : end]
    indent = source.newline + source.indent_at(end) if is_on_lines else " "
    return [Edit(start=end, end=end, text=f"{indent}{destination}")]


_INSTALLED = re.compile(r"install\(\) names the \w+ ([^\s,]+), which does not exist")


def fix_installed_path(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested name of what is installed; without one, remove what does not exist."""
    named = _INSTALLED.search(diagnostic.message)
    command = command_at(source, diagnostic.line, "install")
    if named is None or command is None:
        return []
    first = next((n for n, word in enumerate(_words(command)) if word == "DESTINATION"), None)
    listed = command.arguments[1:first]
    written = [one for one in listed if one.text.rstrip("/") == named[1].rstrip("/")]
    if first is None or len(written) != 1:
        return []
    one, meant = written[0], suggested(diagnostic.hint)
    if meant is not None:
        text = _installed_name(named[1].rstrip("/"), meant)
        if text not in {other.text.rstrip("/") for other in listed}:
            slash = "/" if one.text.endswith("/") else ""
            edit = Edit(start=one.start, end=one.end, text=f"{text}{slash}")
            return [edit] if text else []
    return _without(source, command, one, listed)


def _without(
    source: SourceText, command: Command, one: Argument, listed: Sequence[Argument]
) -> Sequence[Edit]:
    """Install what is listed without one of it; nothing of programs, which somebody wrote."""
    if command.arguments[0].text not in SHARED:
        return []
    if len(listed) == 1:
        return _remove(source, command.start, command.end)
    before = command.arguments[command.arguments.index(one) - 1]
    start, end = source.whole_lines(one.start, one.end)
    if (start, end) == (one.start, one.end):
        start = before.end
    return [Edit(start=start, end=end, text="")]


def _installed_name(written: str, meant: str) -> str:
    """What to install for a path: its name elsewhere, or the one beside it; empty if not sure."""
    folder, _, last = written.rpartition("/")
    if meant.rpartition("/")[2] == last:
        return meant
    return "/".join(filter(None, (folder, meant))) if is_surely(last, meant) else ""


_UNKNOWN_ARGUMENT = re.compile(r"does not know the argument (\w+) of setup\(\)")


def fix_setup_option(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested argument of setup(), or underscores for the dashes in setup.cfg."""
    start, end = source.start_of(diagnostic.line or 0), source.start_of((diagnostic.line or 0) + 1)
    text = source.text[start:end]
    if source.file.name == "setup.cfg":
        return [
            Edit(start=one.start(1), end=one.end(1), text=one[1].replace("-", "_"))
            for one in re.finditer(r"(?m)^(\w+(?:-\w+)+)(?=[ \t]*[=:])", source.text)
            if one[1] in diagnostic.message
        ]
    unknown = _UNKNOWN_ARGUMENT.search(diagnostic.message)
    meant = suggested(diagnostic.hint)
    if unknown is None or meant is None or not is_surely(unknown[1], meant):
        return []
    places = list(re.finditer(rf"\b{unknown[1]}(?=\s*=[^=])", text))
    if len(places) != 1 or re.search(rf"\b{meant}\s*=[^=]", source.text):
        return []
    return [Edit(start=start + places[0].start(), end=start + places[0].end(), text=meant)]


_SCRIPTS = re.compile(r"install_scripts=(\$base/lib/[\w-]+)")
# What setup.cfg of a package of the build type ament_python has, per section.
_KEYS = {"develop": "script_dir", "install": "install_scripts"}


def fix_script_folder(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Have setuptools install scripts where `ros2 run` looks."""
    place = _SCRIPTS.search(diagnostic.hint or "")
    if place is None or source.file.name != "setup.cfg":
        return []
    edits, missing = list[Edit](), list[str]()
    for section, key in _KEYS.items():
        header = re.search(rf"(?m)^\[{section}\][ \t]*(?=\r?$)", source.text)
        if header is None:
            missing += [f"[{section}]", f"{key}={place[1]}"]
            continue
        following = re.compile(r"(?m)^\[").search(source.text, header.end())
        end = following.start() if following else len(source.text)
        written = re.compile(
            rf"(?m)^{key[:-1]}.[ \t]*[=:][ \t]*(.*?)[ \t]*\r?$".replace("_", "[-_]")
        )
        value = written.search(source.text, header.end(), end)
        if value is None:
            line = f"{source.newline}{key}={place[1]}"
            edits.append(Edit(start=header.end(), end=header.end(), text=line))
        elif value[1] != place[1]:
            edits.append(Edit(start=value.start(1), end=value.end(1), text=place[1]))
    return [*edits, *(_append(source, source.newline.join(missing)) if missing else [])]


PLACE = re.compile(r"share/(?:\$\{(?:PROJECT_NAME|CMAKE_PROJECT_NAME)\}|[\w-]+)")
_FOLDER = re.compile(r"does not install its folder ([\w./-]+?)\.(?:\s|\Z)")
_ADDED = re.compile(r"Add: (install\(TARGETS .+\))")


def install_folder(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install a folder with those that CMakeLists.txt installs into the share folder already."""
    named = _FOLDER.search(diagnostic.message)
    if named is None or source.file.name != "CMakeLists.txt":
        return []
    return install_beside(source, named[1])


def install_beside(source: SourceText, folder: str, *, is_new: bool = False) -> list[Edit]:
    """Install a folder of the package with those that the file installs already, or at its end.

    A misspelled name does not mean one that is new.
    """
    for command in read_commands(source):
        words = _words(command)
        if command.name != "install" or words[:1] != ("DIRECTORY",) or OPTIONS & {*words}:
            continue
        if "DESTINATION" not in words or _depth(source, command):
            continue
        place = words.index("DESTINATION")
        plain = [word for word in words[1:place] if re.fullmatch(r"[\w./-]*[\w-]", word)]
        if len(plain) != place - 1 or not plain or not PLACE.fullmatch(words[-1]):
            continue
        if not is_new and any(
            is_surely(word, folder) and not (source.file.parent / word).exists() for word in plain
        ):
            return []  # the folder is meant by a misspelled name, which has a fix of its own
        last = command.arguments[place - 1]
        between = source.text[command.arguments[place - 2].end : last.start]
        gap = between if between.strip() == "" else " "
        return [Edit(start=last.end, end=last.end, text=f"{gap}{folder}")]
    text = f"install(DIRECTORY {folder} DESTINATION share/${{PROJECT_NAME}})"
    return _before_the_end(source, text)


def install_program(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install a program that is compiled and not installed, as the hint writes it out."""
    added = _ADDED.search(diagnostic.hint or "")
    return _before_the_end(source, added[1]) if added else []


def _before_the_end(source: SourceText, text: str) -> list[Edit]:
    """Add a command in front of ament_package(), which must be the last."""
    calls = [one for one in read_commands(source) if one.name.startswith("ament_package")]
    if len(calls) != 1 or _depth(source, calls[0]):
        return []
    place = source.start_of(source.line_at(calls[0].start))
    if source.text[place : calls[0].start].strip():
        return []
    return [Edit(start=place, end=place, text=f"{text}{source.newline}")]


_KIND = re.compile(r"Write: install\((DIRECTORY|FILES) ")


def fix_kind_of_path(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write DIRECTORY for a folder and FILES for a file, if install() names nothing else."""
    meant = _KIND.search(diagnostic.hint or "")
    command = command_at(source, diagnostic.line, "install")
    if meant is None or command is None:
        return []
    words = _words(command)
    if words[2:3] != ("DESTINATION",) or words[0] not in SHARED or OPTIONS & {*words}:
        return []
    kind = command.arguments[0]
    return [Edit(start=kind.start, end=kind.end, text=meant[1])]


SHEBANG = "#!/usr/bin/env python3"


def fix_shebang(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give a program in Python its first line, and the line ends that Linux needs there."""
    first, _, _ = source.text.partition("\n")
    if source.file.suffix != ".py" or source.mark:
        return []
    if "line endings of Windows" in diagnostic.message:
        return [
            Edit(start=found.start(), end=found.end(), text="")
            for found in re.finditer(r"\r(?=\n)", source.text)
        ]
    if SHEBANG not in (diagnostic.hint or ""):
        return []
    if first.startswith("#!"):
        return [Edit(start=0, end=len(first.rstrip("\r")), text=SHEBANG)]
    return _first(source, SHEBANG)


_DATA_FILES = re.compile(r"[Aa]dd to data_files: (\(.+\))\Z")
_MARKER = re.compile(r"\['(resource/[\w-]+)'\]")


_PACKAGE_NAME = re.compile(r"""\b(?:package_name|name)\s*=\s*["']([\w-]+)["']""")


def add_data_file(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Install what ROS looks for in every package, as the hint writes it out."""
    added = _DATA_FILES.search(diagnostic.hint or "")
    if added is None:
        return []
    marker = _MARKER.search(added[1])
    if marker is not None and not (source.file.parent / marker[1]).is_file():
        return []  # a file of its own would have to be created
    named = _PACKAGE_NAME.search(source.text)
    if named is not None and not re.search(rf"[/']{re.escape(named[1])}'", added[1]):
        return []  # the name is to be corrected, not what is installed under it
    return add_to_data_files(source, added[1])


def add_to_data_files(source: SourceText, written: str) -> list[Edit]:
    """Add an entry to `data_files` of setup.py, where that is a list."""
    found = list(re.finditer(r"\bdata_files\s*=\s*\[", source.text))
    if len(found) != 1:
        return []
    place = found[0].end()
    rest = re.compile(r"[ \t]*\r?\n([ \t]*)").match(source.text, place)
    gap = f"{source.newline}{rest[1]}" if rest else ""
    end = "," if rest else ", "
    if source.text[place:].lstrip().startswith("]"):
        gap, end = "", ""
    return [Edit(start=place, end=place, text=f"{gap}{written}{end}")]
