"""Causes of a failed build that are a single word of CMakeLists.txt, or one too few."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic
from wsgen.suggestions import did_you_mean, nearest
from wsgen.workspace.cmake_text import find_open_block, find_open_quote, read_calls
from wsgen.workspace.manifest import read_manifest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.workspace.failure import Failure

CMAKE_SYNTAX = "BLD011"
UNKNOWN_COMMAND = "BLD027"
MISSING_DESTINATION = "BLD028"
DIFFERENT_NAMES = "BLD029"

# What packages of robots call, and the package that brings it; CMake's own without one.
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


def unclosed_quote(failure: Failure) -> Iterator[Diagnostic]:
    """Name the line on which a quotation mark opens what CMake reads to the end of the file."""
    if any(error.message.startswith("Parse error") for error in failure.errors):
        line = find_open_quote(failure.cmake_file)
        if line is not None:
            yield failure.diagnose(
                CMAKE_SYNTAX,
                "a quotation mark is opened here and not closed on this line.",
                line=line,
                hint='Close it: "..."',
            )


def unclosed_block(failure: Failure) -> Iterator[Diagnostic]:
    """Name the if() that has no endif(), and its like."""
    if not any("not properly nested" in error.message for error in failure.errors):
        return
    opened, closing = find_open_block(failure.cmake_file)
    if opened is not None:
        end = f"end{opened.command}()"
        where = f" before {closing.command}() in line {closing.line}" if closing else ""
        yield failure.diagnose(
            CMAKE_SYNTAX,
            f"{opened.command}() in line {opened.line} has no {end}{where}.",
            line=opened.line,
            hint=f"Add {end} where the block ends.",
        )
    elif closing is not None:
        yield failure.diagnose(
            CMAKE_SYNTAX,
            f"{closing.command}() in line {closing.line} ends no {closing.command[3:]}().",
            line=closing.line,
            hint=f"Remove {closing.command}(), or add {closing.command[3:]}() before the block.",
        )


def syntax(failure: Failure) -> Iterator[Diagnostic]:
    """Hand on where CMake could not read on."""
    for error in failure.errors:
        if error.message.startswith("Parse error"):
            what = error.message.removeprefix("Parse error.").strip()
            yield failure.diagnose(
                CMAKE_SYNTAX,
                f"CMake cannot read the file: {what}",
                error=error,
                hint="Look for a parenthesis or quotation mark that is not closed, from this line "
                "on.",
            )
            return


def unknown_command(failure: Failure) -> Iterator[Diagnostic]:
    """Name the command that was meant, or the package that brings it."""
    # Only the first error: a command can be unknown because a find_package() before it failed.
    for error in failure.errors[:1]:
        match = re.search(r'Unknown CMake command "(\w+)"', error.message)
        if match is None:
            continue
        own = {
            call.arguments[0].lower()
            for call in read_calls(failure.cmake_file)
            if call.command in {"function", "macro"} and call.arguments
        }
        name = match[1].lower()
        near = nearest(name, {*COMMANDS, *own}, cutoff=0.7)
        if COMMANDS.get(name):
            hint = f"Write before it: find_package({COMMANDS[name]} REQUIRED)"
        elif near:
            hint = did_you_mean(near)
        else:
            hint = "Mend its name, or find the package that brings it before it is called."
        yield failure.diagnose(
            UNKNOWN_COMMAND, f"there is no CMake command {match[1]}().", error=error, hint=hint
        )


def missing_destination(failure: Failure) -> Iterator[Diagnostic]:
    """Say where to install what is to be installed nowhere."""
    for error in failure.errors:
        match = re.search(r"install (\w+) given no .*DESTINATION", error.message)
        if match:
            place = "lib" if match[1] in {"TARGETS", "PROGRAMS"} else "share"
            yield failure.diagnose(
                MISSING_DESTINATION,
                f"install({match[1]} ...) does not say where to.",
                error=error,
                hint=f"Add before its parenthesis: DESTINATION {place}/${{PROJECT_NAME}}",
            )


def different_names(failure: Failure) -> Iterator[Diagnostic]:
    """Say which file calls the package what."""
    for error in failure.errors:
        match = re.search(
            r"package name '(.+?)' in '.*?' does not match current PROJECT_NAME '(.*?)'",
            error.message,
        )
        if match is None:
            continue
        manifest = read_manifest(failure.folder / "package.xml")
        line = None if isinstance(manifest, Diagnostic) else manifest.line_of("name")
        called = [call for call in read_calls(failure.cmake_file) if call.command == "project"]
        yield failure.diagnose(
            DIFFERENT_NAMES,
            f"project() calls the package {match[2]}, and package.xml"
            f"{f' (line {line})' if line else ''} calls it {match[1]}.",
            error=None if called else error,
            line=called[-1].line if called else None,
            hint=f"Write project({match[1]}) here, or <name>{match[2]}</name> in package.xml; "
            "launch files and $(find ...) know the package by the name in package.xml.",
        )


CAUSES = (
    unclosed_quote,
    unclosed_block,
    syntax,
    unknown_command,
    missing_destination,
    different_names,
)
