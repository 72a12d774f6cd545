"""What is wrong with what a package installs, and what it leaves out."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.build_files.cmake_checks import (
    GIT_KEEPS_NO_EMPTY_FOLDERS,
    MISSING_DESTINATION,
    MISSING_INSTALLED_PATH,
    word_destination,
)
from wsgen.packages.build_files.cmake_install import relative_destination
from wsgen.packages.build_files.cmake_values import is_known
from wsgen.packages.source_shares import may_have_sources
from wsgen.text.files import read_regular
from wsgen.text.suggestions import ask_for_nearest, did_you_mean, nearest, some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts, Executable, Target
    from wsgen.packages.build_files.cmake import Reader
    from wsgen.packages.build_files.cmake_text import InstallRule


UNINSTALLED_LAUNCH_FILE = Rule(
    code="PKG050",
    name="uninstalled-launch-file",
    severity=Severity.ERROR,
    severity_varies="a warning where the package installs other launch files of the folder",
    summary="The package does not install its launch file where `ros2 launch` looks for it.",
    why="`ros2 launch` finds launch files only in `share/PACKAGE` of the install space.",
    example="install(DIRECTORY model DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch model DESTINATION share/${PROJECT_NAME})",
)
EMPTY_FOLDER = Rule(
    code="BLD053",
    name="empty-installed-folder",
    severity=Severity.WARNING,
    summary="`install()` names an empty folder, which Git does not keep.",
    why="The build works here. In a clone of the repository the folder is missing, and CMake stops "
    "at install().",
    example="install(DIRECTORY launch meshes DESTINATION share/${PROJECT_NAME})  # meshes is empty",
    instead="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
)
FOLDER_NOT_INSTALLED = Rule(
    code="BLD054",
    name="folder-not-installed",
    severity=Severity.WARNING,
    severity_varies="an error about a folder of launch files, and where a launch file or a robot "
    "of the package needs the folder; information about one that no file of the package names",
    summary="The package does not install a folder of resources.",
    what="Looks for folders with names such as launch, urdf, meshes, worlds, models, config and "
    "rviz. Where an install rule cannot be read, nothing is reported.",
    why="`ros2 launch`, `$(find ...)` and `package://` look in `share/PACKAGE` of the install "
    "space, where the files are missing after a build.",
    example="install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})  # not meshes",
    instead="install(DIRECTORY launch urdf meshes DESTINATION share/${PROJECT_NAME})",
)
WRONG_DESTINATION = Rule(
    code="BLD055",
    name="wrong-destination",
    severity=Severity.WARNING,
    severity_varies="an error where a launch file or a robot needs a file that is then missing",
    summary="A folder of resources is installed to a place where ROS does not look for it.",
    what="Looks at where folders such as launch, urdf and meshes are installed: `TYPE DATA`, a "
    "destination without `share/` or without the name of the package, or with a variable that is "
    "misspelled or lacks its `$`.",
    why="`ros2 launch`, `$(find ...)` and `package://` look in `share/PACKAGE` of the install "
    "space. The build does not report a wrong destination.",
    example="install(DIRECTORY launch DESTINATION share/{PROJECT_NAME})",
    instead="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
)
CONTENTS_INSTALLED = Rule(
    code="BLD056",
    name="contents-installed",
    severity=Severity.WARNING,
    severity_varies="an error where a launch file or a robot needs a file that is then missing",
    summary="With a slash at the end of its name, the contents of a folder are installed, not "
    "the folder.",
    what="Looks at install() of several folders into the share folder of the package, of which one "
    "has a slash at its end, or all have.",
    why="The files of all folders are mixed in `share/PACKAGE`, and "
    "`share/PACKAGE/launch` does not exist.",
    example="install(DIRECTORY launch/ urdf/ DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})",
)
REPEATED_FOLDER = Rule(
    code="BLD057",
    name="repeated-folder",
    severity=Severity.WARNING,
    severity_varies="an error where a launch file or a robot needs a file that is then missing",
    summary="A folder is installed into a folder of the same name.",
    why="Without a slash at its end, install() copies the folder itself: its files are in "
    "`share/PACKAGE/meshes/meshes`.",
    example="install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME}/meshes)",
    instead="install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})",
)
PROGRAM_NOT_INSTALLED = Rule(
    code="BLD058",
    name="program-not-installed",
    severity=Severity.WARNING,
    severity_varies="an error where a launch file starts it",
    summary="CMakeLists.txt compiles a program and does not install it to lib/PACKAGE.",
    what="Looks at programs of add_executable(), except those of tests and those that the build "
    "itself runs.",
    why="`ros2 run` and launch files look for programs in `lib/PACKAGE` of the install space.",
    example="""add_executable(my_node src/my_node.cpp)
ament_package()""",
    instead="""add_executable(my_node src/my_node.cpp)
install(TARGETS my_node DESTINATION lib/${PROJECT_NAME})
ament_package()""",
)
PROGRAM_NOT_EXECUTABLE = Rule(
    code="BLD059",
    name="program-not-executable",
    severity=Severity.WARNING,
    severity_varies="an error where a launch file starts it",
    summary="A script is installed in a way that `ros2 run` does not find it.",
    what="Looks at Python and shell scripts with a shebang that install(FILES) or "
    "install(DIRECTORY) brings to `lib/PACKAGE`.",
    why="`ros2 run` lists executable files in `lib/PACKAGE`. install(FILES) and "
    "install(DIRECTORY) do not make files executable, and without a slash at its end the folder "
    "itself is installed.",
    example="install(DIRECTORY scripts DESTINATION lib/${PROJECT_NAME})",
    instead="install(PROGRAMS scripts/my_node.py DESTINATION lib/${PROJECT_NAME})",
)
BROKEN_SHEBANG = Rule(
    code="BLD060",
    name="broken-shebang",
    severity=Severity.ERROR,
    severity_varies="a warning for `python`, which only some machines have",
    summary="The first line of an installed script does not start its interpreter.",
    what="Looks at scripts of install(PROGRAMS) in `lib/PACKAGE` that run something: the first "
    "line must name the interpreter, and have the line ending of Linux (LF).",
    why="Linux starts a script with the program after `#!`. Without it `ros2 run` reports `Exec "
    "format error`; with a line ending of Windows (CRLF) it looks for a program `python3\\\\r`.",
    example="import rclpy  # the first line",
    instead="#!/usr/bin/env python3",
)
LINKED_SCRIPT_NOT_EXECUTABLE = Rule(
    code="BLD061",
    name="linked-script-not-executable",
    severity=Severity.INFO,
    summary="A script is not executable in the source folder.",
    what="Looks at scripts of install(PROGRAMS) in `lib/PACKAGE`.",
    why="`install()` makes the copy executable. `colcon build --symlink-install` installs a link, "
    "and `ros2 run` then reports `No executable found`.",
    example="install(PROGRAMS scripts/my_node.py DESTINATION lib/${PROJECT_NAME})",
    instead="chmod +x scripts/my_node.py",
)
WRONG_KIND = Rule(
    code="BLD062",
    name="wrong-kind-of-path",
    severity=Severity.ERROR,
    summary="`install(FILES)` names a folder, or `install(DIRECTORY)` a file.",
    why="CMake stops at the call.",
    example="install(FILES launch DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
)

# What packages of robots call the folders that are looked up in the share folder.
RESOURCES = frozenset(
    {
        *("behavior_trees", "behaviour_trees", "config", "configs", "description", "launch"),
        *("maps", "materials", "media", "mesh", "meshes", "model", "models", "param", "params"),
        *("parameters", "robots", "rviz", "sdf", "urdf", "world", "worlds", "xacro"),
    }
)
IGNORED = frozenset({"COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"})
NAME = "${PROJECT_NAME}"


class Folder(NamedTuple):
    """A folder of resources in the source folder of a package."""

    name: str
    files: tuple[str, ...]  # paths below the package


def find_resources(source: Path) -> tuple[Folder, ...]:
    """The folders of resources at the top of a package that have files."""
    found: list[Folder] = []
    try:
        with os.scandir(source) as entries:
            folders = sorted(one.name for one in entries if one.name in RESOURCES and one.is_dir())
    except OSError:
        return ()
    for name in folders:
        files = tuple(_files_below(os.path.join(source, name), name))
        if files and not any(os.path.basename(file) in IGNORED for file in files):
            found.append(Folder(name, files))
    return tuple(found)


# Files that a folder may have and nobody looks up.
_NOT_LOOKED_UP = lazy_pattern(
    r"(?:^|/)(?:\.[^/]*|readme[^/]*|CMakeLists\.txt|[^/]*\.md)$", re.IGNORECASE
)
MOST_FILES = 2000  # that are looked at in a folder


def _files_below(folder: str, below: str) -> Iterator[str]:
    number = 0
    for place, folders, files in os.walk(folder):
        folders[:] = [one for one in folders if not one.startswith((".", "__"))]
        for file in files:
            name = os.path.normpath(os.path.join(below, os.path.relpath(place, folder), file))
            if not _NOT_LOOKED_UP.search(name):
                yield name
            number += 1
            if number > MOST_FILES:
                return


def check_installed(reader: Reader, facts: BuildFacts, build_type: str) -> Iterator[Diagnostic]:
    """Check what a CMakeLists.txt installs."""
    for rule in reader.rules:
        yield from destinations_missing(rule, reader.name)
        if rule.is_certain:
            yield from paths(rule, reader)
    if build_type != "catkin":  # ROS 1 finds in the source folder what is not installed
        yield from _check_places(reader, facts)


def _check_places(reader: Reader, facts: BuildFacts) -> Iterator[Diagnostic]:
    """Check where things are installed, and what is not."""
    misplaced: set[str] = set()
    for rule in reader.rules:
        if rule.is_certain:
            yield from slashes(rule, reader.name)
        wrong = tuple(destination(rule, reader))
        yield from wrong
        if wrong or rule.destination is None:
            misplaced.update(_tops(rule, reader.source))
    if facts.is_whole:
        yield from uninstalled_folders(
            find_resources(reader.source),
            facts,
            reader.name,
            misplaced,
            line=reader.line_of_last("install"),
            how=word_install,
        )
        yield from programs(facts.targets, _used_by_build(reader), reader)
    yield from misplaced_scripts(reader.rules, reader.name)
    yield from scripts(facts.executables, reader.name)
    yield from not_executable(reader.rules, reader.name)


def destinations_missing(rule: InstallRule, package: str) -> Iterator[Diagnostic]:
    """Report install() without DESTINATION."""
    words = [name.text for name, _ in rule.names]
    if rule.destination is None and rule.names and all(map(is_known, words)):
        message, hint = word_destination(rule.kind)
        yield MISSING_DESTINATION.at(
            rule.file, rule.call.line, package, message=f"{package}: {message}", hint=hint
        )


def paths(rule: InstallRule, reader: Reader) -> Iterator[Diagnostic]:
    """Report paths that do not exist, or are of another kind, or are empty."""
    if rule.kind not in {"DIRECTORY", "FILES", "PROGRAMS"} or rule.destination is None:
        return
    for argument, path in rule.names:
        place = os.path.normpath(path)
        if not is_known(path) or "$<" in path or not reader.is_inside(place):
            continue
        name = os.path.relpath(place, reader.source)
        is_folder = rule.kind == "DIRECTORY"
        if not os.path.lexists(place):
            if not rule.is_optional and not reader.is_produced(place):
                yield word_missing_path(
                    name,
                    "folder" if is_folder else "file",
                    reader.source,
                    rule.file,
                    argument.line,
                    reader.name,
                    rule.call.command,
                )
        elif os.path.isdir(place) is not is_folder and os.path.exists(place):
            kind, other = ("FILES", "DIRECTORY") if not is_folder else ("DIRECTORY", "FILES")
            kind = rule.kind if not is_folder else kind
            yield WRONG_KIND.at(
                rule.file,
                argument.line,
                name,
                message=f"install({kind}) names {name}, which is a "
                f"{'file' if is_folder else 'folder'}.",
                hint=f"Write: install({other} {name} DESTINATION ...)",
            )
        elif is_folder and not rule.is_optional and place != str(reader.source):
            yield from _empty(place, name, rule, argument.line)


def _empty(place: str, name: str, rule: InstallRule, line: int) -> Iterator[Diagnostic]:
    if any(files for _, _, files in os.walk(place)):
        return
    yield EMPTY_FOLDER.at(
        rule.file,
        line,
        name,
        message=f"install() names the folder {name}, which is empty and will be missing from a "
        "clone.",
        hint=f"Remove {name} from install(), or add a file to the folder: touch {name}/.gitkeep",
    )


def word_missing_path(  # noqa: PLR0913, PLR0917  the name, and where it is written
    name: str,
    kind: str,
    source: Path,
    file: Path,
    line: int | None,
    package: str,
    command: str = "install",
) -> Diagnostic:
    """Report a path that install(), or a command that calls it, names and that does not exist."""
    path = source / name
    beside = os.listdir(path.parent) if path.parent.is_dir() else []
    meant = find_elsewhere(source, path.name, is_folder=kind == "folder")
    if meant is not None:
        return MISSING_INSTALLED_PATH.at(
            file,
            line,
            package,
            message=f"{package}: {command}() names the {kind} {name}, which does not exist; "
            f"{meant} does.",
            hint=did_you_mean(meant),
        )
    return MISSING_INSTALLED_PATH.at(
        file,
        line,
        package,
        message=f"{package}: {command}() names the {kind} {name}, which does not exist.",
        hint=f"{did_you_mean(path.name.rstrip(','))} CMake separates arguments by blanks alone."
        if name.endswith(",")
        else f"{ask_for_nearest(path.name, beside)}Create it, or remove it from {command}()."
        f"{GIT_KEEPS_NO_EMPTY_FOLDERS if kind == 'folder' else ''}",
    )


def _tops(rule: InstallRule, source: Path) -> set[str]:
    """The folders at the top of the package that a rule installs something of."""
    below = [os.path.relpath(path, source) for _, path in rule.names if is_known(path)]
    return {path.split("/")[0] for path in below}


def slashes(rule: InstallRule, package: str) -> Iterator[Diagnostic]:
    """Report folders whose last slash, or the lack of it, gives another place than is meant."""
    if rule.kind != "DIRECTORY" or rule.place is None or rule.destination is None:
        return
    place = relative_destination(rule.destination)
    if place is None or rule.patterns:
        return
    with_slash = [
        name for name, path in rule.names if path.endswith("/") and base_of(path) in RESOURCES
    ]
    if place == f"share/{package}" and with_slash and len(rule.names) > 1:
        names = [base_of(one.text) for one in with_slash]
        yield CONTENTS_INSTALLED.at(
            rule.file,
            with_slash[0].line,
            names[0],
            message=f"install() copies what is in {some_of(names)} into share/{package}, and not "
            f"the folder{'s' if len(names) > 1 else ''}.",
            hint=f"Remove the slash at the end: {' '.join(names)}",
        )
    for name, path in rule.names:
        base = base_of(path)
        if (
            base in RESOURCES
            and not path.endswith("/")
            and place == f"share/{package}/{base}"
            and not os.path.isdir(os.path.join(path, base))
        ):
            yield REPEATED_FOLDER.at(
                rule.file,
                name.line,
                base,
                message=f"install() copies the folder {base} into {place}/{base}.",
                hint=f"Write DESTINATION share/{NAME}, or {name.text}/ with a slash.",
            )


def base_of(path: str) -> str:
    """The last part of a path, which may end with a slash."""
    return os.path.basename(path.rstrip("/"))


_NO_DOLLAR = lazy_pattern(r"(?<!\$)(?:\{PROJECT_NAME\}|\$?\(PROJECT_NAME\)|\$PROJECT_NAME\b)")
_VARIABLE = lazy_pattern(r"\$\{(\w+)\}")


def destination(rule: InstallRule, reader: Reader) -> Iterator[Diagnostic]:
    """Report a destination of a folder of resources that nobody looks in."""
    if rule.kind not in {"DIRECTORY", "FILES"} or rule.destination is None or rule.place is None:
        return
    tops = sorted(_tops(rule, reader.source) & RESOURCES)
    if not tops:
        return
    written = _written_place(rule)
    problem = _problem_of(rule.destination, written, reader)
    if problem is None and _is_for_programs(rule, reader, tops):
        problem = (f"lib/{reader.name}, the folder of programs", f"Write DESTINATION share/{NAME}.")
    if problem is None:
        return
    message, hint = problem
    yield WRONG_DESTINATION.at(
        rule.file,
        rule.place.line,
        some_of(tops),
        message=f"{some_of(tops)} {'are' if tops[1:] else 'is'} installed to {message}; ROS looks "
        f"for {'them' if tops[1:] else 'it'} in share/{reader.name}.",
        hint=hint,
    )


def _is_for_programs(rule: InstallRule, reader: Reader, tops: Collection[str]) -> bool:
    """Whether folders of resources are installed to the folder of programs alone."""
    places = {
        relative_destination(one.destination)
        for one in reader.rules
        if one.destination is not None and not _tops(one, reader.source).isdisjoint(tops)
    }
    return rule.kind == "DIRECTORY" and places == {f"lib/{reader.name}"}


def _written_place(rule: InstallRule) -> str:
    words = rule.call.arguments
    for keyword in ("DESTINATION", "TYPE"):
        if keyword in words[:-1]:
            text = words[words.index(keyword) + 1]
            return f"TYPE {text}" if keyword == "TYPE" else text
    return rule.destination or ""


def _problem_of(  # noqa: PLR0911  one for each problem
    place: str, written: str, reader: Reader
) -> tuple[str, str] | None:
    """Where a destination is, and what to write instead; None if nothing is wrong."""
    right = f"Write DESTINATION share/{NAME}."
    if written.startswith("TYPE "):
        if written != "TYPE DATA" or reader.name in place.split("/"):
            return None
        return f"{place} by {written}", f"Write DESTINATION share/{NAME} in place of {written}."
    if _NO_DOLLAR.search(written):
        return f"`{written}`, which does not use a variable", right
    for name in _VARIABLE.findall(written):
        if name not in reader.variables and reader.look_up_name(name) is None:
            return f"`{written}`, whose variable {name} is not set", right
    if not is_known(place) or "$<" in place:
        return None
    relative = relative_destination(place)
    if relative is None:
        return f"{place}, outside of the install space", right
    return (relative or "the prefix", right) if is_misplaced(relative, reader.name) else None


def is_misplaced(place: str, package: str) -> bool:
    """Whether a folder below the prefix is nearly the share folder of a package, and is not."""
    top, _, below = place.partition("/")
    if top == "share":
        name = below.partition("/")[0]
        if name == package:  # which may be called `description`
            return False
        return not name or name in RESOURCES or nearest(name, [package], cutoff=0.8) is not None
    return not top or top in RESOURCES or top == package


def word_install(name: str) -> str:
    """What to write in CMakeLists.txt to install a folder."""
    return f"Add above ament_package(): install(DIRECTORY {name} DESTINATION share/{NAME})"


def uninstalled_folders(  # noqa: PLR0913  the folders, what is installed, and where to say it
    folders: Iterable[Folder],
    facts: BuildFacts,
    package: str,
    misplaced: Collection[str],
    *,
    line: int | None,
    how: Callable[[str], str],
) -> Iterator[Diagnostic]:
    """Report folders of resources of which nothing is installed, and launch files left out."""
    folders = tuple(folders)
    source = facts.build_file.parent
    installed = {os.fspath(one.source) for one in facts.installed if one.source is not None}
    modules = [f"{one.source}/" for one in facts.python_packages]
    missing = [
        folder
        for folder in folders
        if folder.name not in misplaced
        and not any(os.path.join(source, file) in installed for file in folder.files)
        and not any(f"{source}/{folder.name}/".startswith(module) for module in modules)
    ]
    for folder in folders if facts.is_whole else ():
        if folder not in missing and folder.name not in misplaced:
            yield from _uninstalled_launch_files(folder, installed, facts, package, line)
    made = any(one.source is None and one.is_of_share(package) for one in facts.installed)
    if made:  # the build may make what it installs of them
        return
    for folder in missing:
        is_surely = any(map(_LAUNCH_FILE.search, folder.files)) or _is_mentioned(
            folder.name, source
        )
        yield FOLDER_NOT_INSTALLED.at(
            facts.build_file,
            line,
            folder.name,
            message=f"{package} does not install its folder {folder.name}.",
            hint=how(folder.name),
            severity=Severity.ERROR
            if _are_started(folder, source)
            else Severity.WARNING
            if is_surely
            else Severity.INFO,
        )


def _are_started(folder: Folder, source: Path) -> bool:
    """Whether `ros2 launch PACKAGE FILE` is surely meant for a file of the folder.

    Files that are parts of others, and those of tests, are not; neither are those that the README
    starts by their paths.
    """
    if folder.name != "launch":
        return False
    files = [file for file in folder.files if _LAUNCH_FILE.search(file) and "test" not in file]
    if not any(_is_launch_file(source / file) for file in files):
        return False
    return not any(_BY_PATH.search(_text(file)) for file in source.glob("README*"))


_BY_PATH = lazy_pattern(rb"ros2 launch\s+\S*/\S*launch\.(?:py|xml|ya?ml)")


def _is_launch_file(file: Path) -> bool:
    return file.suffix != ".py" or b"def generate_launch_description" in _text(file)


def _text(file: Path) -> bytes:
    try:
        return read_regular(file, MOST_LETTERS)
    except (OSError, ValueError):
        return b""


def _uninstalled_launch_files(
    folder: Folder, installed: Collection[str], facts: BuildFacts, package: str, line: int | None
) -> Iterator[Diagnostic]:
    """Report launch files in a folder of which others are installed."""
    source = facts.build_file.parent
    for file in folder.files:
        path = os.path.join(source, file)
        if not _LAUNCH_FILE.search(file) or "test" in file or path in installed:
            continue
        if os.path.islink(path):
            continue
        yield UNINSTALLED_LAUNCH_FILE.at(
            facts.build_file,
            line,
            file,
            message=f"{package} does not install its launch file {file}; it installs others of "
            f"that folder.",
            hint=f"Extend the pattern or the list that installs {folder.name}.",
            severity=Severity.WARNING,
        )


_LAUNCH_FILE = lazy_pattern(r"launch\.(py|xml|ya?ml)$")
TEXTS = (".launch", ".py", ".sdf", ".srdf", ".urdf", ".world", ".xacro", ".xml", ".yaml", ".yml")
MOST_TEXTS = 300  # that are searched
MOST_LETTERS = 300_000  # of each


def _is_mentioned(name: str, source: Path) -> bool:
    """Whether a file of the package has a path with the folder in it."""
    word = re.compile(rf"""(?:^|["'/\s\]])/?{re.escape(name)}["'/]""".encode())
    number = 0
    for place, folders, files in os.walk(source):
        folders[:] = sorted(one for one in folders if not one.startswith((".", "__", "test")))
        for file in sorted(files):
            if not file.endswith(TEXTS) or file in {"package.xml", "setup.py"}:
                continue
            number += 1
            if number > MOST_TEXTS:
                return False
            try:
                text = read_regular(Path(place, file), MOST_LETTERS)
            except (OSError, ValueError):
                continue
            if word.search(text):
                return True
    return False


def _used_by_build(reader: Reader) -> set[str]:
    """Words in calls that run programs while the package is built or tested."""
    commands = ("add_custom_command", "add_custom_target", "add_test", "ament_add_test")
    return {
        argument.text
        for command in commands
        for mention in reader.mentions.get(command, ())
        for argument in mention.arguments
    }


_NO_PROGRAM = lazy_pattern(
    r"test|example|demo|bench|sample|playground|tutorial|tool", re.IGNORECASE
)


def programs(
    targets: Sequence[Target], used: Collection[str], reader: Reader
) -> Iterator[Diagnostic]:
    """Report programs that are compiled and not installed where `ros2 run` looks."""
    for target in targets:
        if target.kind != "executable" or target.in_tests or target.name in used:
            continue
        if any(target.name in word for word in used if "$<" in word):
            continue
        if not target.is_installed:
            below = os.path.relpath(target.file.parent, reader.source)
            if not _NO_PROGRAM.search(f"{target.name} {below}"):
                yield PROGRAM_NOT_INSTALLED.at(
                    target.file,
                    target.line,
                    target.name,
                    message=f"The program {target.name} is compiled and not installed, so that "
                    f"`ros2 run {reader.name} {target.name}` does not find it.",
                    hint=f"Add: install(TARGETS {target.name} DESTINATION lib/{NAME})",
                )
            continue
        rule = next(
            (
                one
                for one in reader.rules
                if one.kind == "TARGETS" and any(n.text == target.name for n, _ in one.names)
            ),
            None,
        )
        if rule is None or rule.destination is None:
            continue
        place = relative_destination(rule.destination)
        if place is not None and _is_wrong_for_programs(place, reader.name):
            yield _outside(target, rule, place, reader.name)


def _is_wrong_for_programs(place: str, package: str) -> bool:
    """Whether a folder is like the one that ROS looks in for programs, and another one."""
    parts = place.split("/")
    if parts[0] not in {"lib", "share", "libexec"} or place.startswith(ELSEWHERE):
        return False
    return parts[1:2] != [package] or parts[0] == "share"


# Where others than ROS look for programs.
ELSEWHERE = ("libexec/", "lib/gz", "lib/ign", "lib/systemd")


def _outside(target: Target, rule: InstallRule, place: str, package: str) -> Diagnostic:
    return PROGRAM_NOT_INSTALLED.at(
        rule.file,
        rule.place.line if rule.place else rule.call.line,
        target.name,
        message=f"The program {target.name} is installed to {place}; `ros2 run` looks in "
        f"lib/{package}.",
        hint=f"Write: DESTINATION lib/{NAME}",
    )


def misplaced_scripts(rules: Sequence[InstallRule], package: str) -> Iterator[Diagnostic]:
    """Report install(PROGRAMS) to folders that `ros2 run` does not look in."""
    right = {
        path
        for rule in rules
        if rule.destination and relative_destination(rule.destination) == f"lib/{package}"
        for _, path in rule.names
    }
    for rule in rules:
        place = None if rule.destination is None else relative_destination(rule.destination)
        if rule.kind != "PROGRAMS" or place not in {f"share/{package}", "lib", "bin", "share"}:
            continue
        for argument, path in rule.names:
            if path not in right and is_known(path) and _is_program(Path(path)):
                yield PROGRAM_NOT_INSTALLED.at(
                    rule.file,
                    rule.place.line if rule.place else rule.call.line,
                    os.path.basename(argument.text),
                    message=f"The program {os.path.basename(argument.text)} is installed to "
                    f"{place}; `ros2 run` looks in lib/{package}.",
                    hint=f"Write: DESTINATION lib/{NAME}",
                )


_RUNS = lazy_pattern(rb"(?m)^if\s+__name__\s*==|^(?:rclpy\.init|main)\s*\(")
MOST_BYTES = 1_000_000  # of a script


def scripts(executables: Iterable[Executable], package: str) -> Iterator[Diagnostic]:
    """Report scripts that cannot be started."""
    linked: list[Executable] = []
    for one in executables:
        if one.source is None or one.entry_point is not None:
            continue
        head = _read(one.source)
        if head is None or b"\0" in head[:1000]:
            continue
        name = _below(one.source, one.file)
        first = head.split(b"\n", 1)[0]
        if not head.startswith(b"#!"):
            if one.source.suffix == ".py" and _RUNS.search(head):
                has_mark = head.startswith(b"\xef\xbb\xbf#!")
                yield BROKEN_SHEBANG.at(
                    one.source,
                    1,
                    one.name,
                    message=f"{name} is installed as a program, but its first line does not name "
                    "an "
                    "interpreter" + (": a byte order mark is before #!." if has_mark else "."),
                    hint="Save it as UTF-8 without a byte order mark."
                    if has_mark
                    else "Write as its first line: #!/usr/bin/env python3",
                )
        elif first.endswith(b"\r"):
            yield BROKEN_SHEBANG.at(
                one.source,
                1,
                one.name,
                message=f"{name} has line endings of Windows (CRLF), so that Linux looks for a "
                f"program "
                f"`{first[2:].strip().split(b'/')[-1].decode(errors='replace')}\\r`.",
                hint=f"Convert it: sed -i 's/\\r$//' {name}",
            )
        elif re.fullmatch(rb"#!\s*/usr/bin/(?:env\s+)?python\s*", first):
            yield BROKEN_SHEBANG.at(
                one.source,
                1,
                one.name,
                message=f"{name} is started with `python`, which Ubuntu does not have.",
                hint="Write as its first line: #!/usr/bin/env python3",
                severity=Severity.WARNING,
            )
        elif one.file.name == "CMakeLists.txt" and not os.access(one.source, os.X_OK):
            linked.append(one)
    if linked:
        names = [_below(one.source, one.file) for one in linked if one.source is not None]
        verb = "is" if len(names) == 1 else "are"
        yield LINKED_SCRIPT_NOT_EXECUTABLE.at(
            linked[0].file,
            linked[0].line,
            linked[0].name,
            message=f"{some_of(names)} {verb} not executable: `ros2 run {package} "
            f"{linked[0].name}` finds nothing after `colcon build --symlink-install`.",
            hint=f"chmod +x {' '.join(names)}",
        )


def _read(file: Path) -> bytes | None:
    try:
        data = read_regular(file, MOST_BYTES)
    except (OSError, ValueError):
        return None
    return data if len(data) <= MOST_BYTES else None


def _below(file: Path, build_file: Path) -> str:
    return os.path.relpath(file, build_file.parent)


def not_executable(rules: Iterable[InstallRule], package: str) -> Iterator[Diagnostic]:
    """Report scripts that are installed to lib/PACKAGE and cannot be run there."""
    for rule in rules:
        place = None if rule.destination is None else relative_destination(rule.destination)
        source = os.path.join(rule.file.parent, "")
        if rule.kind not in {"DIRECTORY", "FILES"} or place != f"lib/{package}" or rule.patterns:
            continue
        for argument, path in rule.names:
            if not is_known(path) or not os.path.normpath(path).startswith(source):
                continue
            is_folder = rule.kind == "DIRECTORY"
            is_below = is_folder and not path.endswith("/")
            if rule.runnable == "all" and not is_below:
                continue
            names = sorted(os.listdir(path)) if is_folder and os.path.isdir(path) else [""]
            found = [
                file
                for file in (Path(path, name) if name else Path(path) for name in names)
                if file.suffix in {".py", ".sh"} and _is_program(file)
                and (is_below or rule.runnable == "none" or not os.access(file, os.X_OK))
            ]  # fmt: skip
            if found:
                files = [_below(file, rule.file) for file in found]
                why = (
                    f"into lib/{package}/{base_of(path)}; `ros2 run` looks in lib/{package}"
                    if is_below
                    else "without execute permission, so that `ros2 run` does not find it"
                )
                yield PROGRAM_NOT_EXECUTABLE.at(
                    rule.file,
                    argument.line,
                    found[0].name,
                    message=f"install({rule.kind}) copies {some_of(files)} {why}.",
                    hint=f"Write: install(PROGRAMS {' '.join(files[:3])} DESTINATION lib/{NAME})",
                )


def _is_program(file: Path) -> bool:
    try:
        return read_regular(file, 1) == b"#!"
    except (OSError, ValueError):
        return False


def find_elsewhere(source: Path, name: str, *, is_folder: bool = False) -> str | None:
    """The only path with this name in a package, relative to its folder."""
    found = []
    for folder, folders, files in os.walk(source):
        folders[:] = filter(may_have_sources, folders)
        if name in (folders if is_folder else files):
            found.append(os.path.relpath(os.path.join(folder, name), source))
    return found[0] if len(found) == 1 else None
