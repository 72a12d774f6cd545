"""What the commands of CMake and of ament do, as far as it can be known without running them."""

from __future__ import annotations

import glob
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.model.build_facts import RequiredPackage, Target
from wsgen.packages.build_files import cmake_install
from wsgen.packages.build_files.cmake_text import texts
from wsgen.packages.build_files.cmake_values import BUILD, UNKNOWN, is_known, split_list, version

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.packages.build_files.cmake import Reader
    from wsgen.packages.build_files.cmake_text import Mention


# Variables.


def _project(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if not words:
        return
    name = words[0]
    number = words[words.index("VERSION") + 1] if "VERSION" in words[:-1] else ""
    parts = [*map(str, version(number)), "", "", "", ""] if is_known(number) else [UNKNOWN] * 4
    reader.variables.update({"PROJECT_NAME": name, "PROJECT_VERSION": number})
    reader.variables.setdefault("CMAKE_PROJECT_NAME", name)
    for key, value in zip(("MAJOR", "MINOR", "PATCH", "TWEAK"), parts, strict=False):
        reader.variables[f"PROJECT_VERSION_{key}"] = value
    for prefix in ("PROJECT", name):
        reader.variables[f"{prefix}_SOURCE_DIR"] = str(reader.folder)
        reader.variables[f"{prefix}_BINARY_DIR"] = reader.variables["CMAKE_CURRENT_BINARY_DIR"]
    reader.variables[f"{name}_VERSION"] = number


def _set(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if not words or words[0].startswith("ENV{") or not is_known(words[0]):
        return
    name, values = words[0], words[1:]
    in_parent = values[-1:] == ["PARENT_SCOPE"]
    if in_parent:
        values.pop()
    if "CACHE" in values:
        position = values.index("CACHE")
        is_forced = values[-1] == "FORCE"
        if name in reader.variables and not is_forced:
            return
        values = values[:position]
    reader.set(name, ";".join(values), in_parent=in_parent)


def _unset(reader: Reader, mention: Mention) -> None:
    for name in texts(mention)[:1]:
        reader.variables[name] = ""


def _option(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if words and words[0] not in reader.variables:
        is_on = words[2:3] and words[2].upper() in {"ON", "TRUE", "1", "YES"}
        # What is off by default is often asked for on the command line.
        reader.variables[words[0]] = "ON" if is_on else UNKNOWN


def _list(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if len(words) < 2:
        return
    action, name, values = words[0].upper(), words[1], words[2:]
    before = split_list(reader.look_up("", name))
    change = _CHANGES.get(action)
    if change is not None:
        reader.variables[name] = ";".join(change(before, values))
    elif action == "FILTER" and len(values) > 2 and is_known("".join([*values, *before])):
        keeps = values[0] == "INCLUDE"
        matches = [reader.matches(values[2], one) for one in before]
        kept = [one for one, match in zip(before, matches, strict=True) if match is keeps]
        reader.variables[name] = UNKNOWN if None in matches else ";".join(kept)
    elif action == "LENGTH" and values:
        is_sure = is_known("".join(before))
        reader.variables[values[0]] = str(len(before)) if is_sure else UNKNOWN
    elif action in {"GET", "JOIN", "SUBLIST", "FIND", "POP_BACK", "POP_FRONT", "TRANSFORM"}:
        reader.variables[(values or [name])[-1]] = UNKNOWN
        if action in {"POP_BACK", "POP_FRONT", "TRANSFORM"}:
            reader.variables[name] = UNKNOWN
    else:
        reader.variables[name] = UNKNOWN


_CHANGES: dict[str, Callable[[list[str], list[str]], list[str]]] = {
    "APPEND": lambda before, values: before + values,
    "PREPEND": lambda before, values: values + before,
    "INSERT": lambda before, values: before + values[1:],  # the order does not matter here
    "REMOVE_ITEM": lambda before, values: [one for one in before if one not in values],
    "REMOVE_DUPLICATES": lambda before, values: [*dict.fromkeys(before)],
    "REVERSE": lambda before, values: before[::-1],
    "SORT": lambda before, values: sorted(before),
}


_STRING_CHANGES: dict[str, Callable[[str], str]] = {
    "TOLOWER": str.lower,
    "TOUPPER": str.upper,
    "STRIP": str.strip,
}


def _string(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    action = words[0].upper() if words else ""
    text = "".join(words)
    if action in {"TOLOWER", "TOUPPER", "STRIP"} and len(words) == 3:
        change = _STRING_CHANGES[action]
        reader.variables[words[2]] = change(words[1]) if is_known(text) else UNKNOWN
    elif action == "REPLACE" and len(words) >= 4:
        value = "".join(words[4:]).replace(words[1], words[2]) if is_known(text) else UNKNOWN
        reader.variables[words[3]] = value
    elif action in {"APPEND", "PREPEND"} and len(words) > 1:
        before, more = reader.look_up("", words[1]), "".join(words[2:])
        reader.variables[words[1]] = before + more if action == "APPEND" else more + before
    elif action == "CONCAT" and len(words) > 1:
        reader.variables[words[1]] = "".join(words[2:])
    else:
        for word in words[1:]:
            if word.isidentifier():
                reader.variables[word] = UNKNOWN


def _get_filename_component(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if len(words) < 3:
        return
    name, path, mode = words[0], words[1], words[2]
    base = os.path.basename(path)
    value = UNKNOWN
    if is_known(path) and "PROGRAM" not in words:
        value = {
            "NAME": base,
            "NAME_WE": base.partition(".")[0] if base.find(".") else base,
            "NAME_WLE": os.path.splitext(base)[0],
            "EXT": base[base.find(".") :] if "." in base else "",
            "LAST_EXT": os.path.splitext(base)[1],
            **dict.fromkeys(("DIRECTORY", "PATH"), os.path.dirname(path)),
            **dict.fromkeys(
                ("ABSOLUTE", "REALPATH"),
                os.path.normpath(os.path.join(reader.folder, path)),
            ),
        }.get(mode, UNKNOWN)
    if "BASE_DIR" in words:
        value = UNKNOWN
    reader.variables[name] = value


def _file(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    action = words[0].upper() if words else ""
    if action in {"GLOB", "GLOB_RECURSE"} and len(words) > 1:
        reader.variables[words[1]] = ";".join(
            find_files(reader, words[2:], is_recursive=action == "GLOB_RECURSE")
        )
    elif action == "RELATIVE_PATH" and len(words) == 4:
        is_sure = is_known("".join(words))
        reader.variables[words[1]] = os.path.relpath(words[3], words[2]) if is_sure else UNKNOWN
    elif action in {"TO_CMAKE_PATH", "REAL_PATH", "TO_NATIVE_PATH"} and len(words) > 2:
        reader.variables[words[2]] = words[1]
    elif action in {"READ", "STRINGS"} and len(words) > 2:
        reader.variables[words[2]] = UNKNOWN
    else:
        _produces(reader, mention)
        for word in words[2:]:
            if word.isidentifier() and word in reader.variables:
                reader.variables[word] = UNKNOWN


def find_files(reader: Reader, words: list[str], *, is_recursive: bool) -> list[str]:
    """What file(GLOB) finds, in order; UNKNOWN among it where not all is known."""
    relative = ""
    lists_folders = not is_recursive
    patterns: list[str] = []
    remaining = iter(words)
    for word in remaining:
        if word == "RELATIVE":
            relative = next(remaining, "")
        elif word == "LIST_DIRECTORIES":
            lists_folders = next(remaining, "true").lower() in {"true", "1", "on", "yes"}
        elif word != "CONFIGURE_DEPENDS":
            patterns.append(word)
    found: set[str] = set()
    for pattern in patterns:
        path = os.path.join(reader.folder, pattern)
        if not is_known(path) or BUILD in path or not is_known(relative):
            found.add(UNKNOWN)
            continue
        if not reader.is_inside(re.split(r"[*?\[]", path)[0]):
            found.add(UNKNOWN)
            continue
        if is_recursive:
            folder, name = os.path.split(path)
            path = os.path.join(folder, "**", name)
        matches = glob.iglob(path, recursive=is_recursive)
        found.update(
            os.path.normpath(one) for one in matches if (lists_folders or os.path.isfile(one))
        )
    listed = sorted(found)
    if relative:
        listed = [one if one == UNKNOWN else os.path.relpath(one, relative) for one in listed]
    return listed


def _cmake_parse_arguments(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if words[:1] == ["PARSE_ARGV"]:
        words = [*words[2:6], *split_list(reader.look_up("", "ARGV"))]
    if len(words) < 4 or not is_known("".join(words[:4])):
        return
    prefix = words[0]
    options, singles, multiples = (split_list(word) for word in words[1:4])
    values: dict[str, str] = dict.fromkeys(options, "FALSE")
    lists: dict[str, list[str]] = {}
    rest: list[str] = []
    current: list[str] = rest
    for word in words[4:]:
        if word in options:
            values[word] = "TRUE"
            current = rest
        elif word in singles or word in multiples:
            current = lists.setdefault(word, [])
        else:
            current.append(word)
            if current is not rest and any(current is lists.get(one) for one in singles):
                current = rest
    for name in (*singles, *multiples):
        reader.variables[f"{prefix}_{name}"] = ""
    for name, text in values.items():
        reader.variables[f"{prefix}_{name}"] = text
    for name, listed in lists.items():
        reader.variables[f"{prefix}_{name}"] = ";".join(listed)
    reader.variables[f"{prefix}_UNPARSED_ARGUMENTS"] = ";".join(rest)


def _sets_first(reader: Reader, mention: Mention) -> None:
    for name in texts(mention)[:1]:
        reader.variables[name] = UNKNOWN


def _sets_any(reader: Reader, mention: Mention) -> None:
    """Set what a command may set: the variables among its arguments."""
    for word in texts(mention):
        if re.fullmatch(r"[A-Za-z_]\w*", word):
            reader.variables[word] = UNKNOWN


def _produces(reader: Reader, mention: Mention) -> None:
    """Remember the paths that a command may write."""
    for word in texts(mention):
        if is_known(word) and ("/" in word or "." in word):
            path = os.path.normpath(os.path.join(reader.folder, word))
            if path != str(reader.folder) and not str(reader.source).startswith(f"{path}/"):
                reader.produced.add(path)


def _executes(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    _produces(reader, mention)
    for keyword in ("OUTPUT_VARIABLE", "RESULT_VARIABLE", "ERROR_VARIABLE", "RESULTS_VARIABLE"):
        if keyword in words[:-1]:
            reader.variables[words[words.index(keyword) + 1]] = UNKNOWN


# Files and packages.

# Modules of CMake that define no variables of install rules.
KNOWN_MODULES = {"CTest": (), "CMakePackageConfigHelpers": (), "CheckCXXCompilerFlag": ()}
INSTALL_FOLDERS = {
    "BINDIR": "bin",
    "SBINDIR": "sbin",
    "LIBDIR": "lib",
    "LIBEXECDIR": "libexec",
    "INCLUDEDIR": "include",
    "DATAROOTDIR": "share",
    "DATADIR": "share",
    "SYSCONFDIR": "etc",
    "MANDIR": "share/man",
    "INFODIR": "share/info",
    "LOCALEDIR": "share/locale",
    "LOCALSTATEDIR": "var",
    "RUNSTATEDIR": "var/run",
    "SHAREDSTATEDIR": "com",
}


def _include(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if not words:
        return
    if words[0] == "GNUInstallDirs":
        name = reader.look_up("", "PROJECT_NAME")
        folders = {**INSTALL_FOLDERS, "DOCDIR": f"share/doc/{name}"}
        for key, folder in folders.items():
            reader.variables.setdefault(f"CMAKE_INSTALL_{key}", folder)
            reader.variables.setdefault(
                f"CMAKE_INSTALL_FULL_{key}", f"{reader.variables['CMAKE_INSTALL_PREFIX']}/{folder}"
            )
    elif words[0] not in KNOWN_MODULES:
        path = os.path.join(reader.folder, words[0])
        reader.has_foreign = True
        if not (is_known(path) and reader.is_inside(path) and reader.run_file(Path(path))):
            own = reader.source / "cmake" / f"{words[0]}.cmake"
            if not reader.run_file(own) and words[0] not in HARMLESS_MODULES:
                reader.is_whole = reader.knows_commands = False


HARMLESS_MODULES = frozenset(
    {
        *("CheckCCompilerFlag", "CheckIncludeFile", "CheckIncludeFileCXX", "CheckIPOSupported"),
        *("CheckSymbolExists", "CMakeDependentOption", "CMakeParseArguments", "ExternalProject"),
        *("FeatureSummary", "FetchContent", "FindPkgConfig", "GenerateExportHeader", "CPack"),
        *("CheckCXXSourceCompiles", "CheckFunctionExists", "FindPackageHandleStandardArgs"),
        *("CheckIncludeFiles", "ConfigExtras.cmake"),
    }
)


def _add_subdirectory(reader: Reader, mention: Mention) -> None:
    for word in texts(mention)[:1]:
        path = os.path.normpath(os.path.join(reader.folder, word))
        if not is_known(word) or not reader.is_inside(path) or not reader.run_folder(Path(path)):
            reader.is_whole = False


def _find_package(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    reader.has_foreign = True
    if not words or not is_known(words[0]):
        return
    is_required = "REQUIRED" in words[1:] and mention.is_certain
    name = words[0]
    reader.variables[f"{name}_FOUND"] = "TRUE" if is_required else UNKNOWN
    if name == "catkin":
        _set_catkin_folders(reader)
    components = _components(words) if name == "catkin" else []
    for one in (name, *components):
        reader.required.append(
            RequiredPackage(
                name=one,
                file=mention.file,
                line=mention.call.line,
                required=is_required,
                in_tests=mention.in_tests,
            )
        )


def _components(words: list[str]) -> list[str]:
    if "COMPONENTS" not in words:
        return []
    return [word for word in words[words.index("COMPONENTS") + 1 :] if word != "REQUIRED"]


def _set_catkin_folders(reader: Reader) -> None:
    name = reader.look_up("", "PROJECT_NAME")
    folders = {
        "PACKAGE_SHARE": f"share/{name}",
        "PACKAGE_BIN": f"lib/{name}",
        "PACKAGE_LIB": "lib",
        "PACKAGE_INCLUDE": f"include/{name}",
        "PACKAGE_ETC": f"etc/{name}",
        "GLOBAL_BIN": "bin",
        "GLOBAL_LIB": "lib",
        "GLOBAL_INCLUDE": "include",
        "GLOBAL_SHARE": "share",
    }
    for key, folder in folders.items():
        reader.variables[f"CATKIN_{key}_DESTINATION"] = folder


# Targets.


def _add_target(kind: str) -> Callable[[Reader, Mention], None]:
    def add(reader: Reader, mention: Mention) -> None:
        words = texts(mention)
        if not words or not is_known(words[0]) or {"IMPORTED", "ALIAS"} & {*words}:
            return
        actual = kind
        if kind == "library":
            actual = next((word.lower() for word in words[1:2] if word in LIBRARIES), "shared")
            if actual == "shared" and "SHARED" not in words and "add_library" in mention.call[0]:
                actual = "shared" if reader.look_up_name("BUILD_SHARED_LIBS") else "static"
        reader.targets[words[0]] = Target(
            name=words[0],
            kind=actual,
            file=mention.file,
            line=mention.call.line,
            in_tests=mention.in_tests,
        )

    return add


LIBRARIES = frozenset({"SHARED", "STATIC", "MODULE", "INTERFACE", "OBJECT"})


def _set_target_properties(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if "PROPERTIES" in words:
        position = words.index("PROPERTIES")
        for target in words[:position]:
            for key, value in zip(words[position + 1 :: 2], words[position + 2 :: 2], strict=False):
                _set_output(reader, target, key, value)


def _set_property(reader: Reader, mention: Mention) -> None:
    words = texts(mention)
    if words[:1] == ["TARGET"] and "PROPERTY" in words[:-2]:
        position = words.index("PROPERTY")
        for target in words[1:position]:
            _set_output(reader, target, words[position + 1], "".join(words[position + 2 :]))


def _set_output(reader: Reader, target: str, key: str, value: str) -> None:
    if key == "OUTPUT_NAME":
        reader.outputs[target] = value
    elif key in {"PREFIX", "SUFFIX", "LIBRARY_OUTPUT_NAME", "RUNTIME_OUTPUT_NAME", "VERSION"}:
        reader.outputs[target] = UNKNOWN


def _register_node(reader: Reader, mention: Mention) -> None:
    """rclcpp_components_register_node() compiles a program and installs it."""
    words = texts(mention)
    if "EXECUTABLE" in words[:-1]:
        reader.components.append((words[words.index("EXECUTABLE") + 1], mention))


def _foreign(reader: Reader, mention: Mention) -> None:
    """What may set any variable, and installs nothing that a launch file needs."""
    reader.has_foreign = True


COMMANDS: dict[str, Callable[[Reader, Mention], None]] = {
    "project": _project,
    "set": _set,
    "unset": _unset,
    "option": _option,
    "list": _list,
    "string": _string,
    "get_filename_component": _get_filename_component,
    "file": _file,
    "cmake_parse_arguments": _cmake_parse_arguments,
    "include": _include,
    "add_subdirectory": _add_subdirectory,
    "find_package": _find_package,
    "add_executable": _add_target("executable"),
    "ament_auto_add_executable": _add_target("executable"),
    "add_library": _add_target("library"),
    "ament_auto_add_library": _add_target("library"),
    "set_target_properties": _set_target_properties,
    "set_property": _set_property,
    "rclcpp_components_register_node": _register_node,
    "ament_auto_find_build_dependencies": _foreign,
    "add_custom_command": _executes,
    "add_custom_target": _executes,
    "execute_process": _executes,
    "configure_file": _produces,
    **dict.fromkeys(
        ("get_property", "get_target_property", "get_directory_property", "get_cmake_property"),
        _sets_first,
    ),
    **dict.fromkeys(
        ("find_program", "find_library", "find_path", "find_file", "pkg_get_variable"), _sets_first
    ),
    **dict.fromkeys(("math", "separate_arguments", "cmake_path", "site_name"), _sets_any),
    **dict.fromkeys(
        (
            *("catkin_package", "catkin_python_setup", "fetchcontent_makeavailable"),
            *("pkg_check_modules", "pkg_search_module", "try_compile", "try_run"),
            *("rosidl_get_typesupport_target", "get_default_rmw_implementation"),
        ),
        _foreign,
    ),
    **cmake_install.COMMANDS,
}
HARMLESS = frozenset(
    {
        *("add_compile_definitions", "add_compile_options", "add_definitions", "add_dependencies"),
        *("add_link_options", "add_test", "ament_package", "cmake_host_system_information"),
        *("cmake_language", "cmake_minimum_required", "cmake_policy", "enable_language"),
        *("enable_testing", "export", "fluid_wrap_ui", "include_directories", "link_directories"),
        *("include_guard", "link_libraries", "mark_as_advanced", "message"),
        *("remove_definitions", "set_directory_properties", "set_source_files_properties"),
        *("set_tests_properties", "source_group", "target_compile_definitions"),
        *("target_compile_features", "target_compile_options", "target_include_directories"),
        *("target_link_directories", "target_link_libraries", "target_link_options"),
        *("target_precompile_headers", "target_sources", "variable_watch", "write_file"),
        *("find_package_handle_standard_args", "fetchcontent_declare", "externalproject_add"),
        *("write_basic_package_version_file", "generate_export_header", "add_launch_test"),
        *("xacro_add_target", "cmake_dependent_option", "generate_parameter_library"),
        *("add_rostest", "add_rostest_gtest", "add_message_files", "add_service_files"),
        *("add_action_files", "generate_messages", "generate_dynamic_reconfigure_options"),
        *("rosidl_target_interfaces", "protobuf_generate_cpp", "qt_wrap_cpp"),
        *("generate_parameter_module", "rclcpp_components_register_nodes"),
        # Of packages that many others use.
        *("export_windows_symbols", "moveit_package", "nav2_package", "set_compiler_options"),
    }
)
# Commands of these only compile, link, check, test, lint or export.
HARMLESS_STARTS = (
    *("ament_", "qt_", "qt5_", "qt6_", "qt4_", "check_", "fetchcontent_", "catkin_add_", "gtest_"),
    *("catkin_lint", "roslint", "roslaunch_add", "cuda_", "pybind11_", "nanobind_", "eigen"),
)


def is_harmless(command: str) -> bool:
    """Whether a command is known to install nothing that a launch file needs."""
    is_of_tests = "add_" in command and "test" in command
    return command in HARMLESS or command.startswith(HARMLESS_STARTS) or is_of_tests
