"""What is wrong with the commands in CMakeLists.txt."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.build_files.cmake_commands import COMMANDS as EVALUATED
from wsgen.packages.build_files.cmake_commands import is_harmless
from wsgen.packages.build_files.cmake_install import meant_form
from wsgen.packages.build_files.cmake_text import BRACKET, Mention, texts, word_keyword
from wsgen.packages.build_files.cmake_values import is_known, version
from wsgen.text.suggestions import ask_for_nearest, did_you_mean, nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import RequiredPackage
    from wsgen.packages.build_files.cmake import Reader
    from wsgen.packages.build_files.cmake_text import Call


CMAKE_SYNTAX = Rule(
    code="BLD011",
    name="cmake-syntax",
    severity=Severity.ERROR,
    summary="CMake cannot parse CMakeLists.txt.",
    what="Names the line that opens a quotation mark or a block, which CMake reads to the end of "
    "the file.",
    why="CMake stops, and the package is not built.",
    example="""if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
ament_package()""",
    instead="""if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
endif()
ament_package()""",
)
UNKNOWN_COMMAND = Rule(
    code="BLD027",
    name="unknown-command",
    severity=Severity.ERROR,
    summary="CMakeLists.txt calls a command that CMake does not know.",
    why="CMake stops at the call. The name is misspelled, or find_package() of the package that "
    "defines the command is missing or comes later.",
    example="""find_package(ament_cmake REQUIRED)
ament_pakage()""",
    instead="""find_package(ament_cmake REQUIRED)
ament_package()""",
)
MISSPELLED_KEYWORD = Rule(
    code="BLD071",
    name="misspelled-keyword",
    severity=Severity.ERROR,
    summary="A command has a word that is nearly one of its keywords.",
    what="Looks for words in capitals in the calls of install(), find_package(), add_library() and "
    "others that differ from a keyword in a letter or two and do not name a file.",
    why="CMake takes the word for a file, a library or a component: it stops, or does not do what "
    "the keyword says.",
    example="install(DIRECTORY launch DESTNATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
)
MISSING_DESTINATION = Rule(
    code="BLD028",
    name="missing-destination",
    severity=Severity.ERROR,
    summary="`install()` has no DESTINATION.",
    why="CMake does not know where to install the files, and stops.",
    example="install(DIRECTORY launch)",
    instead="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
)
DIFFERENT_NAMES = Rule(
    code="BLD029",
    name="different-names",
    severity=Severity.ERROR,
    summary="`package.xml` and project() name the package differently.",
    why="`ament_package()` requires both names to be equal, and stops.",
    example="project(my_robots)  # package.xml: <name>my_robot</name>",
    instead="project(my_robot)",
)
OLD_CMAKE_MINIMUM = Rule(
    code="BLD012",
    name="old-cmake-minimum",
    severity=Severity.ERROR,
    severity_varies="a warning of `wsgen check`, as earlier versions than CMake 4 accept it",
    summary="`cmake_minimum_required()` names a version that CMake 4 no longer supports.",
    why="CMake 4 has removed compatibility with versions before 3.5, and stops.",
    example="cmake_minimum_required(VERSION 2.8)",
    instead="cmake_minimum_required(VERSION 3.20)",
)
UNKNOWN_LANGUAGE = Rule(
    code="BLD047",
    name="unknown-language",
    severity=Severity.ERROR,
    summary="`project()` names a language that CMake does not know.",
    what="Compares the names with those that are often written for C++; `wsgen build` reports "
    "all other names that CMake refuses.",
    why="CMake looks for the compiler of each language, and stops. Its name for C++ is CXX.",
    example="project(my_robot LANGUAGES CPP)",
    instead="project(my_robot LANGUAGES CXX)",
)
MISNAMED_LANGUAGES = {"CPP": "CXX", "C++": "CXX", "CPLUSPLUS": "CXX", "CC": "CXX"}
MISSING_INSTALLED_PATH = Rule(
    code="BLD003",
    name="missing-installed-path",
    severity=Severity.ERROR,
    summary="`install()` names a file or folder that does not exist.",
    why="CMake stops while it installs the package. Git does not keep empty folders, so one may "
    "be missing only from a clone.",
    example="install(DIRECTORY launch meshes DESTINATION share/${PROJECT_NAME})",
    instead="install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
)
REPEATED_AMENT_PACKAGE = Rule(
    code="BLD009",
    name="repeated-ament-package",
    severity=Severity.ERROR,
    summary="CMakeLists.txt calls ament_package() more than once.",
    why="Each call defines the same CMake targets and installs the same files; the second one "
    "fails.",
    example="""ament_package()
ament_package()""",
    instead="ament_package()  # once, at the end",
)
MISSING_BUILD_FILE = Rule(
    code="BLD021",
    name="missing-build-file",
    severity=Severity.ERROR,
    summary="A package has no CMakeLists.txt; one of the build type ament_python has no setup.py.",
    why="CMake or setuptools builds and installs the package from this file.",
    example="src/my_robot/package.xml  # without src/my_robot/CMakeLists.txt",
    instead="git checkout CMakeLists.txt",
)
MISSING_CMAKE_MINIMUM = Rule(
    code="BLD031",
    name="missing-cmake-minimum",
    severity=Severity.ERROR,
    severity_varies="a warning of `wsgen check`, as earlier versions than CMake 4 accept it",
    summary="CMakeLists.txt does not call cmake_minimum_required().",
    why="CMake 4 stops without the call; earlier versions only warn. The version in it also "
    "chooses how later commands behave, so the call comes before project().",
    example="""project(my_robot)
find_package(ament_cmake REQUIRED)
ament_package()""",
    instead="""cmake_minimum_required(VERSION 3.8...3.31)
project(my_robot)
find_package(ament_cmake REQUIRED)
ament_package()""",
)
MISSING_PROJECT = Rule(
    code="BLD045",
    name="missing-project",
    severity=Severity.ERROR,
    summary="CMakeLists.txt does not call project().",
    why="`ament_package()` takes the name of the package from project(), and stops without it.",
    example="""cmake_minimum_required(VERSION 3.8...3.31)
find_package(ament_cmake REQUIRED)
ament_package()""",
    instead="""cmake_minimum_required(VERSION 3.8...3.31)
project(my_robot)
find_package(ament_cmake REQUIRED)
ament_package()""",
)
MISSING_SOURCE = Rule(
    code="BLD046",
    name="missing-source",
    severity=Severity.ERROR,
    summary="A target names a source file that does not exist.",
    why="CMake stops, as it cannot compile the target. The name is misspelled, or its folder is "
    "missing: paths are relative to the folder of CMakeLists.txt.",
    example="add_executable(my_node my_node.cpp)  # the file is src/my_node.cpp",
    instead="add_executable(my_node src/my_node.cpp)",
)
MISSING_AMENT_PACKAGE = Rule(
    code="BLD010",
    name="missing-ament-package",
    severity=Severity.ERROR,
    severity_varies="a warning about a package that installs nothing",
    summary="CMakeLists.txt of an ament_cmake package does not call ament_package().",
    what="Looks for the call, and, after a build, for the package in the ament index.",
    why="`ament_package()` registers the package in the ament index. Without it `ros2 launch` and "
    "`$(find ...)` do not find the package.",
    example="""find_package(ament_cmake REQUIRED)
install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})""",
    instead="""find_package(ament_cmake REQUIRED)
install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})
ament_package()""",
)
LATE_COMMAND = Rule(
    code="BLD049",
    name="command-after-ament-package",
    severity=Severity.ERROR,
    summary="CMakeLists.txt calls a command after ament_package() that must come before it.",
    why="`ament_package()` writes what the package exports and adds to the environment, so that "
    "CMake stops at a later `ament_export_...()` or `ament_environment_hooks()`.",
    example="""ament_package()
ament_export_dependencies(rclcpp)""",
    instead="""ament_export_dependencies(rclcpp)
ament_package()""",
)
LATE_REGISTRATION = Rule(
    code="BLD068",
    name="registered-after-ament-package",
    severity=Severity.WARNING,
    summary="CMakeLists.txt registers a plugin or component after ament_package(), which is lost.",
    what="Looks for `pluginlib_export_plugin_description_file()`, "
    "`rclcpp_components_register_node()` and similar commands. A later `install()` works.",
    why="`ament_package()` writes what is registered before it into the ament index. The build "
    "reports nothing, and the plugin or component is not found at run time.",
    example="""ament_package()
pluginlib_export_plugin_description_file(nav2_core plugins.xml)""",
    instead="""pluginlib_export_plugin_description_file(nav2_core plugins.xml)
ament_package()""",
)
MISSING_SUBDIRECTORY = Rule(
    code="BLD050",
    name="missing-subdirectory",
    severity=Severity.ERROR,
    summary="`add_subdirectory()` names a folder without CMakeLists.txt.",
    why="CMake stops. The folder is misspelled, or it is a Git submodule that is not cloned.",
    example="add_subdirectory(external/driver)  # an empty folder",
    instead="git submodule update --init",
)
TEST_PACKAGE_REQUIRED = Rule(
    code="BLD051",
    name="test-package-required",
    severity=Severity.WARNING,
    summary="CMakeLists.txt requires a package for tests outside of `if(BUILD_TESTING)`.",
    what="Looks for calls such as `find_package(ament_lint_auto REQUIRED)` outside of "
    "`if(BUILD_TESTING)`.",
    why="CMake stops on a machine without the package, even with `-DBUILD_TESTING=OFF`.",
    example="find_package(ament_lint_auto REQUIRED)",
    instead="""if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
  ament_lint_auto_find_test_dependencies()
endif()""",
)
REMOVED_COMMAND = Rule(
    code="BLD052",
    name="removed-command",
    severity=Severity.ERROR,
    severity_varies="a warning where the distribution only deprecates it",
    summary="The target distribution does not have a command that CMakeLists.txt calls.",
    what="Looks for ament_target_dependencies(), which Kilted deprecates and Lyrical lacks.",
    why="CMake stops at the call.",
    example="ament_target_dependencies(my_node rclcpp std_msgs)",
    instead="target_link_libraries(my_node rclcpp::rclcpp ${std_msgs_TARGETS})",
)

# Commands that packages of robots call -> the package that defines them; empty for CMake's own.
COMMANDS = {
    "ament_auto_find_build_dependencies": "ament_cmake_auto",
    "ament_auto_package": "ament_cmake_auto",
    "ament_environment_hooks": "ament_cmake",
    "ament_export_dependencies": "ament_cmake",
    "ament_export_include_directories": "ament_cmake",
    "ament_export_libraries": "ament_cmake",
    "ament_export_targets": "ament_cmake",
    "ament_lint_auto_find_test_dependencies": "ament_lint_auto",
    "ament_package": "ament_cmake",
    "ament_python_install_package": "ament_cmake_python",
    "ament_target_dependencies": "ament_cmake",
    "rosidl_generate_interfaces": "rosidl_default_generators",
    "xacro_add_files": "xacro",
    **dict.fromkeys(
        (
            *("add_compile_options", "add_custom_command", "add_custom_target"),
            *("add_executable", "add_library", "add_subdirectory", "cmake_minimum_required"),
            *("configure_file", "else", "elseif", "endif", "endforeach", "endfunction"),
            *("execute_process", "file", "find_package", "foreach", "function", "if", "include"),
            *("include_directories", "install", "list", "message", "option", "project", "set"),
            *("string", "target_compile_features", "target_include_directories"),
            *("target_link_libraries",),
        ),
        "",
    ),
}
EXPORTS = frozenset(
    {
        *("ament_export_definitions", "ament_export_dependencies", "ament_export_libraries"),
        *("ament_export_include_directories", "ament_export_interfaces", "ament_export_targets"),
        *("ament_export_library_names", "ament_export_link_flags"),
        *("ament_environment_hooks", "ament_python_install_package", "ament_vendor"),
        *("ament_export_development_version_if_higher_than_manifest",),
        *("rosidl_generate_interfaces",),
    }
)
# These only note something, which their extension of ament_package() writes into the ament index.
REGISTRATIONS = frozenset(
    {
        *("pluginlib_export_plugin_description_file", "rclcpp_components_register_node"),
        *("rclcpp_components_register_nodes", "register_rviz_ogre_media_exports"),
    }
)
AT_THE_END = "Move ament_package() to the end of CMakeLists.txt."
OF_TESTS = frozenset(
    {
        *("ament_lint_auto", "ament_lint_common", "ament_cmake_gtest", "ament_cmake_gmock"),
        *("ament_cmake_pytest", "launch_testing_ament_cmake", "ros_testing"),
    }
)
GIT_KEEPS_NO_EMPTY_FOLDERS = " Git does not keep empty folders: they are missing from a clone."
OLDEST = (3, 5)  # that CMake 4 accepts
DEPRECATES = "kilted"
LACKS = frozenset({"lyrical", "rolling"})


def check_commands(reader: Reader, build_type: str) -> Iterator[Diagnostic]:
    """Check what a CMakeLists.txt calls, but for what it installs."""
    yield from syntax(reader)
    if reader.mistake is None and reader.open_block is None:
        wrong = [*misspelled(reader)]
        is_meant = any(did_you_mean("ament_package") == found.hint for found in wrong)
        yield from project(reader, build_type)
        yield from ament_package(reader, "" if is_meant else build_type)
        yield from minimum(reader)
        yield from languages(reader)
        yield from wrong
        yield from without_ament(reader)
        yield from unclosed_variables(reader)
    yield from test_packages(reader.required, reader.name)
    yield from subdirectories(reader)
    yield from sources(reader)
    yield from keywords(reader)


def _report(  # noqa: PLR0913  a rule, its place and its words
    rule: Rule,
    reader: Reader,
    place: Mention | tuple[Path, int | None] | int,  # a line of CMakeLists.txt
    message: str,
    hint: str,
    *,
    severity: Severity | None = None,
) -> Diagnostic:
    """Report a rule about the package at a place."""
    if isinstance(place, int):
        place = (reader.build_file, place)
    file, line = (place.file, place.call.line) if isinstance(place, Mention) else place
    return rule.at(
        file, line, reader.name, message=f"{reader.name}: {message}", hint=hint, severity=severity
    )


def syntax(reader: Reader) -> Iterator[Diagnostic]:
    """Report where CMake cannot parse a file."""
    if reader.mistake is not None:
        file, found = reader.mistake
        yield _report(CMAKE_SYNTAX, reader, (file, found.line), found.message, found.hint)
    elif reader.open_block is not None:
        file, opened, closing = reader.open_block
        first = opened or closing
        place = (file, first.line if first else None)
        yield _report(CMAKE_SYNTAX, reader, place, *word_block(opened, closing))


def word_block(opened: Call | None, closing: Call | None) -> tuple[str, str]:
    """Say which block is not closed, or not opened, and what to do."""
    if opened is not None:
        end = f"end{opened.command}()"
        where = f" before {closing.command}() in line {closing.line}" if closing else ""
        return (
            f"{opened.command}() in line {opened.line} is not closed by {end}{where}.",
            f"Add {end} where the block ends.",
        )
    assert closing is not None  # noqa: S101  one of them is there
    return (
        f"{closing.command}() in line {closing.line} has no matching {closing.command[3:]}().",
        f"Remove {closing.command}(), or add {closing.command[3:]}() before the block.",
    )


def project(reader: Reader, build_type: str) -> Iterator[Diagnostic]:
    """Compare the name of the project with that of the package."""
    calls = [one for one in reader.mentions.get("project", ()) if one.file == reader.build_file]
    is_ament = bool(_calls_of_ament_package(reader))
    if not calls:
        minimum = reader.mentions.get("cmake_minimum_required", ())
        line = minimum[0].call.line if minimum else None
        if is_ament and not reader.mentions.get("project") and reader.knows_commands:
            yield _report(MISSING_PROJECT, reader, line or 1, *word_project(reader.name, line))
        return
    if len(calls) > 1 or not calls[0].is_certain or not calls[0].arguments:
        return
    name = calls[0].arguments[0].text
    if is_known(name) and name != reader.name and is_ament:
        yield word_names(
            name, reader.name, reader.build_file, calls[0].call.line, reader.manifest_line
        )


# What is said of a mistake, and what to do about it, whether CMake reports it or the text shows it.


def word_project(package: str, line_of_minimum: int | None) -> tuple[str, str]:
    """Say that project() is missing."""
    where = f"after line {line_of_minimum}" if line_of_minimum else "as its first line"
    return "CMakeLists.txt does not call project().", f"Add {where}: project({package})"


def word_missing_minimum() -> tuple[str, str]:
    """Say that cmake_minimum_required() is missing."""
    return (
        "CMakeLists.txt does not call cmake_minimum_required(), which CMake 4 requires.",
        "Add as its first line: cmake_minimum_required(VERSION 3.8...3.31)",
    )


def word_old_minimum(oldest: str | None) -> tuple[str, str]:
    """Say that cmake_minimum_required() names an old version; None where it is not known."""
    what = f"version {oldest}" if oldest else "a version"
    return (
        f"cmake_minimum_required() names {what}, which CMake 4 no longer supports.",
        "Write cmake_minimum_required(VERSION 3.8...3.31).",
    )


def word_unknown_command(name: str, own: Collection[str] = ()) -> tuple[str, str]:
    """Say that a command is not known; `own` are the functions and macros of the package."""
    near = nearest(name.lower(), {*COMMANDS, *EVALUATED, *own}, cutoff=0.7)
    if COMMANDS.get(name.lower()):
        hint = f"Add before it: find_package({COMMANDS[name.lower()]} REQUIRED)"
    elif near:
        hint = did_you_mean(near)
    else:
        hint = "Correct its name, or call find_package() for the package that defines it first."
    return f"CMake does not know the command {name}().", hint


def word_destination(kind: str) -> tuple[str, str]:
    """Say that install() of that kind has no DESTINATION."""
    place = "share" if kind in {"DIRECTORY", "FILES"} else "lib"
    return (
        f"install({kind} ...) has no DESTINATION.",
        f"Add before its closing parenthesis: DESTINATION {place}/${{PROJECT_NAME}}",
    )


def word_build_file(build_type: str, *, has_other: bool) -> tuple[str, str]:
    """Say that the build file of a package is missing.

    Args:
        build_type: "ament_python", which needs setup.py; others need CMakeLists.txt.
        has_other: whether the package has the other one of the two.
    """
    is_python = build_type == "ament_python"
    wanted, other = ("setup.py", "CMakeLists.txt")[:: 1 if is_python else -1]
    tool = "setuptools" if is_python else "CMake"
    other_type = "ament_cmake" if is_python else "ament_python"
    return (
        f"{wanted} is missing; {tool} builds and installs the package with it.",
        f"Write <build_type>{other_type}</build_type> in package.xml: {other} exists."
        if has_other
        else f"Restore it (git checkout {wanted}), or write one.",
    )


def word_names(
    project: str, package: str, file: Path | None, line: int | None, manifest_line: int | None
) -> Diagnostic:
    """Report that project() and package.xml differ."""
    where = f" (line {manifest_line})" if manifest_line else ""
    here, there = f"project({package}) here", f"<name>{project}</name> in package.xml"
    if file is not None and file.parent.name == project:  # two of three agree
        here, there = f"{there}, as the folder is called", here
    return DIFFERENT_NAMES.at(
        file,
        line,
        package,
        message=f"{package}: project() names the package {project}, but package.xml{where} names "
        f"it {package}.",
        hint=f"Write {here}, or {there}; "
        "launch files and $(find ...) know the package by the name in package.xml.",
        reason=project,
    )


def _calls_of_ament_package(reader: Reader) -> list[Mention]:
    return [
        mention
        for command in ("ament_package", "ament_auto_package")
        for mention in reader.mentions.get(command, ())
        if mention.folder == reader.source
    ]


def ament_package(reader: Reader, build_type: str) -> Iterator[Diagnostic]:
    """Check that the package is registered once, after what it exports."""
    calls = _calls_of_ament_package(reader)
    if not calls:
        if build_type == "ament_cmake" and reader.knows_commands and reader.build_file.is_file():
            installs = any(not rule.in_tests for rule in reader.rules)
            found = missing_ament_package(reader.name, reader.build_file, reader.last_line)
            yield found if installs else replace(found, severity=Severity.WARNING)
        return
    certain = [one for one in calls if one.is_certain]
    if len(certain) > 1:
        yield _report(
            REPEATED_AMENT_PACKAGE,
            reader,
            certain[1],
            f"ament_package() is called again; the first call is in line {certain[0].call.line}.",
            "Call it once, at the end.",
        )
    for first in certain[:1]:
        for rule, commands in ((LATE_COMMAND, EXPORTS), (LATE_REGISTRATION, REGISTRATIONS)):
            for command in sorted(commands & reader.mentions.keys()):
                for mention in reader.mentions[command]:
                    if mention.order > first.order and mention.is_certain:
                        message = _word_late(rule, command)
                        yield _report(rule, reader, mention, message, AT_THE_END)


def _word_late(rule: Rule, command: str) -> str:
    if rule is LATE_COMMAND:
        return f"{command}() is called after ament_package(), and must come before it."
    return f"{command}() is called after ament_package(), where it has no effect."


def missing_ament_package(package: str, file: Path, line: int | None) -> Diagnostic:
    """Report that ROS does not find a package."""
    return MISSING_AMENT_PACKAGE.at(
        file,
        line,
        package,
        message=f"{package}: CMakeLists.txt does not call ament_package(), so that ROS does not "
        "find the package after a build.",
        hint="Call ament_package() at the end of CMakeLists.txt.",
    )


def minimum(reader: Reader) -> Iterator[Diagnostic]:
    """Check the version in cmake_minimum_required()."""
    calls = [
        one
        for one in reader.mentions.get("cmake_minimum_required", ())
        if one.file == reader.build_file
    ]
    if not calls:
        if reader.mentions.get("project") and reader.knows_commands:
            said = word_missing_minimum()
            yield _report(MISSING_CMAKE_MINIMUM, reader, 1, *said, severity=Severity.WARNING)
        return
    words = texts(calls[0])
    oldest, _, newest = "".join(words[1:2]).partition("...")
    if not is_known(oldest) or not oldest or not calls[0].is_certain:
        return
    if version(newest or oldest) < OLDEST:
        said = word_old_minimum(oldest)
        yield _report(OLD_CMAKE_MINIMUM, reader, calls[0], *said, severity=Severity.WARNING)


def languages(reader: Reader) -> Iterator[Diagnostic]:
    """Report what CMake does not know as the name of a language."""
    for command in ("project", "enable_language"):
        for mention in reader.mentions.get(command, ()):
            names = texts(mention)[1 if command == "project" else 0 :]
            wrong = next((name for name in names if name.upper() in MISNAMED_LANGUAGES), None)
            if wrong is None or not mention.is_certain or _is_described(names, wrong):
                continue
            yield _report(
                UNKNOWN_LANGUAGE,
                reader,
                mention,
                f"{command}() names the language {wrong}, which CMake does not know.",
                f"Write {MISNAMED_LANGUAGES[wrong.upper()]}.",
            )


def _is_described(names: Sequence[str], word: str) -> bool:
    """Whether a word is the text of another option of project()."""
    before = names[names.index(word) - 1] if names.index(word) else ""
    return before in {"VERSION", "DESCRIPTION", "HOMEPAGE_URL"}


def misspelled(reader: Reader) -> Iterator[Diagnostic]:
    """Report the first command whose name is nearly that of a known one."""
    for mention in reader.mentions.get("install", ()):
        first = mention.arguments[0].text if mention.arguments else ""
        meant = meant_form(first)
        if meant != first and mention.is_certain:
            message = f"CMake does not know install({first} ...), and stops."
            yield _report(UNKNOWN_COMMAND, reader, mention, message, did_you_mean(meant))
            return
    unknown = [
        mention
        for command, mentions in reader.mentions.items()
        if command not in EVALUATED and command not in COMMANDS and not _is_known(command)
        for mention in mentions[:1]
        if mention.is_certain
    ]
    for mention in unknown[:1]:
        name = mention.call.command
        near = nearest(name, {*COMMANDS, *EVALUATED}, cutoff=SURELY)
        if near is not None and near not in reader.functions and not _has_more_words(name, near):
            said = word_unknown_command(name, reader.functions)
            yield _report(UNKNOWN_COMMAND, reader, mention, *said)


def without_ament(reader: Reader) -> Iterator[Diagnostic]:
    """Report a call of ament_package() where nothing before it can define that."""
    calls = [one for one in _calls_of_ament_package(reader) if one.is_certain]
    if not calls or calls[0].call.command != "ament_package":
        return
    first = calls[0]
    for command, mentions in reader.mentions.items():
        for one in mentions:
            if (
                one.order < first.order
                and not one.in_tests
                and (
                    command in {"include", "add_subdirectory"}
                    or (command == "find_package" and not _defines_nothing(texts(one)))
                )
            ):
                return
    said = word_unknown_command("ament_package", reader.functions)
    yield _report(UNKNOWN_COMMAND, reader, first, *said)


def _defines_nothing(words: Sequence[str]) -> bool:
    """Whether find_package() finds a package of messages or a client library."""
    return words[:1] != [] and words[0].endswith(("_msgs", "_srvs", "rclcpp", "rclpy"))


def unclosed_variables(reader: Reader) -> Iterator[Diagnostic]:
    """Report the first `${` without its `}` in an argument of a call that CMake surely makes."""
    for mentions in reader.mentions.values():
        for mention in mentions if mentions and mentions[0].is_certain else ():
            for argument in mention.call.written:
                found = UNCLOSED.search(argument.text) if argument.kind != BRACKET else None
                if found is not None:
                    place = (mention.file, argument.line)
                    yield _report(CMAKE_SYNTAX, reader, place, *word_unclosed(found[0]))
                    return


# A reference of a variable whose name ends without a brace.
UNCLOSED = lazy_pattern(r"(?<!\\)\$\{[A-Za-z_]\w*(?=$|[\s/;\"])")


def word_unclosed(reference: str) -> tuple[str, str]:
    """Say which reference of a variable has no end, and what to do."""
    return f"`{reference}` is not closed.", f"Write `{reference}}}`."


def _has_more_words(command: str, other: str) -> bool:
    """Whether a command has all words of another and more, as those of families do."""
    return set(command.split("_")) > set(other.split("_"))


SURELY = 0.9  # how similar two names of commands are, of which one is misspelled
_OF_AMENT = lazy_pattern(
    "ament_(add_|cmake_|copyright|cppcheck|cpplint|flake8|find_|generate_|get_|has_|include_|index_"
    "|lint_cmake|libraries_|mypy|package_xml|pep257|pclint|pycodestyle|register_|uncrustify"
    "|xmllint|clang|python_install_module|auto_|execute_|export_|black|environment_|vitis|ros)"
)


def _is_known(command: str) -> bool:
    return is_harmless(command) and (
        not command.startswith("ament_") or _OF_AMENT.match(command) is not None
    )


def test_packages(required: Iterable[RequiredPackage], package: str) -> Iterator[Diagnostic]:
    """Report packages of tests that every build requires."""
    for one in required:
        if one.required and not one.in_tests and one.name in OF_TESTS:
            yield TEST_PACKAGE_REQUIRED.at(
                one.file,
                one.line,
                package,
                message=f"find_package({one.name} REQUIRED) is outside of if(BUILD_TESTING).",
                hint="Move it, and the calls that need it, into: if(BUILD_TESTING) ... endif()",
            )


def subdirectories(reader: Reader) -> Iterator[Diagnostic]:
    """Report folders that add_subdirectory() names and that do not exist."""
    for mention in reader.mentions.get("add_subdirectory", ()):
        for word in mention.arguments[:1]:
            path = os.path.normpath(os.path.join(mention.folder, word.text))
            file = os.path.join(path, "CMakeLists.txt")
            if (
                not is_known(word.text)
                or not mention.is_certain
                or not reader.is_inside(path)
                or os.path.exists(file)
                or reader.is_produced(path)
            ):
                continue
            parent = os.path.dirname(path)
            beside = os.listdir(parent) if os.path.isdir(parent) else []
            what = "has no CMakeLists.txt" if os.path.isdir(path) else "does not exist"
            asks = "" if os.path.isdir(path) else ask_for_nearest(os.path.basename(path), beside)
            yield MISSING_SUBDIRECTORY.at(
                mention.file,
                word.line,
                word.text,
                message=f"add_subdirectory() names the folder {word.text}, which {what}.",
                hint=f"{asks}Run `git submodule update --init` if it is a submodule, or remove the "
                "call.",
            )


def keywords(reader: Reader) -> Iterator[Diagnostic]:
    """Report misspelled keywords."""
    for file, command, word, meant in reader.misspelled:
        yield MISSPELLED_KEYWORD.at(
            file,
            word.line,
            word.text,
            message=f"{reader.name}: {word_keyword(command, word.text)}",
            hint=did_you_mean(meant),
        )


SOURCES = frozenset((".c", ".cc", ".cpp", ".cxx"))
TARGETS = ("add_executable", "add_library", "ament_auto_add_executable", "ament_auto_add_library")


def sources(reader: Reader) -> Iterator[Diagnostic]:
    """Report source files of targets that do not exist."""
    generated = {
        word
        for mention in reader.mentions.get("set_source_files_properties", ())
        for word in texts(mention)
    }
    for command in TARGETS:
        for mention in reader.mentions.get(command, ()):
            if {"IMPORTED", "ALIAS", "INTERFACE"} & {*texts(mention)}:
                continue
            for word in mention.arguments[1:]:
                path = os.path.normpath(os.path.join(mention.folder, word.text))
                if (
                    os.path.splitext(word.text)[1] in SOURCES
                    and is_known(word.text)
                    and "$<" not in word.text
                    and mention.is_certain
                    and word.text not in generated
                    and reader.exists(path) is False
                ):
                    yield word_source(
                        os.path.relpath(path, reader.source),
                        reader.source,
                        mention.file,
                        word.line,
                        reader.name,
                    )


def word_source(
    name: str, source: Path, file: Path | None, line: int | None, package: str
) -> Diagnostic:
    """Report a source file that does not exist, and those of a similar name."""
    beside = {
        str(found.relative_to(source)) for found in source.rglob("*") if found.suffix in SOURCES
    }
    base = os.path.basename(name)
    same = sorted(found for found in beside if os.path.basename(found) == base)
    hint = did_you_mean(*same[:3]) if same else ask_for_nearest(name, beside).strip()
    return MISSING_SOURCE.at(
        file,
        line,
        package,
        message=f"{package}: the source file {name} of a target does not exist.",
        hint=hint or "Create it, or remove it from the target; it may be missing from a clone.",
    )


def check_for_distro(
    calls: Mapping[str, Sequence[tuple[Path, int]]], distro: str | None
) -> Iterator[Diagnostic]:
    """Report commands that the target distribution does not have.

    Args:
        calls: file and 1-based line of the first calls of a command, by its name; those of
            `BuildFacts.dated_calls`.
        distro: the target; None if it is not known.
    """
    for command, places in calls.items():
        if distro != DEPRECATES and distro not in LACKS:
            continue
        is_gone = distro in LACKS
        verb = "does not have" if is_gone else "deprecates"
        yield REMOVED_COMMAND.at(
            *places[0],
            command,
            message=f"{(distro or '').capitalize()} {verb} {command}(), which is called "
            f"{len(places)} {'time' if len(places) == 1 else 'times'}.",
            hint="Write target_link_libraries(TARGET PACKAGE::PACKAGE), and "
            "${PACKAGE_TARGETS} for a package of messages.",
            severity=Severity.ERROR if is_gone else Severity.WARNING,
        )
