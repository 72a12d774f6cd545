"""Causes of a failed build: a mistake in CMakeLists.txt, a tool of the machine, a missing file.

A cause is a function that recognizes it in the output of the build, and reports it.
"""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.diagnostics import Diagnostic, Rule, Severity, has_errors
from wsgen.packages.build_files.cmake_checks import (
    AT_THE_END,
    CMAKE_SYNTAX,
    LATE_COMMAND,
    MISSING_BUILD_FILE,
    MISSING_CMAKE_MINIMUM,
    MISSING_DESTINATION,
    MISSING_PROJECT,
    MISSPELLED_KEYWORD,
    OLD_CMAKE_MINIMUM,
    REPEATED_AMENT_PACKAGE,
    UNKNOWN_COMMAND,
    UNKNOWN_LANGUAGE,
    word_block,
    word_build_file,
    word_destination,
    word_missing_minimum,
    word_names,
    word_old_minimum,
    word_project,
    word_source,
    word_unclosed,
    word_unknown_command,
)
from wsgen.packages.build_files.cmake_text import (
    find_open_block,
    meant_keyword,
    parse,
    read_calls,
    read_text,
    word_keyword,
)
from wsgen.packages.build_files.install_checks import word_missing_path
from wsgen.packages.workspace.manifest import read_manifest
from wsgen.packages.workspace.package_xml import check_package_xml
from wsgen.ros.names import cmake_packages, released_packages
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.building.failure import Failure


WRONG_PYTHON = Rule(
    code="BLD004",
    name="wrong-python",
    severity=Severity.ERROR,
    summary="CMake uses a Python that lacks the modules of the build.",
    what="Looks for failed imports of catkin_pkg and ament_package in the output of the build.",
    why="`ament_cmake` runs Python scripts that import these modules. CMake found another Python "
    "first, for example that of an active conda environment.",
    example="conda activate base; colcon build",
    instead="conda deactivate; rm -r build/my_robot; colcon build",
)
UNSUPPORTED_EMPY = Rule(
    code="BLD005",
    name="unsupported-empy",
    severity=Severity.ERROR,
    summary="The Python of the build has empy 4 or no empy; ROS needs empy 3.",
    why="The templates of ament and rosidl use the interface of empy 3, which empy 4 changed.",
    example="python3 -m pip install empy",
    instead="python3 -m pip install 'empy>=3.3.4,<4'",
)
MISSING_COMPILER = Rule(
    code="BLD006",
    name="missing-compiler",
    severity=Severity.ERROR,
    summary="`project()` requires a compiler that is not installed.",
    why="`project()` enables C and C++ by default, and CMake stops without a compiler.",
    example="project(my_robot)",
    instead="project(my_robot LANGUAGES NONE)  # if it only installs files",
)
MISSING_CMAKE = Rule(
    code="BLD007",
    name="missing-cmake",
    severity=Severity.ERROR,
    summary="`colcon` does not find CMake.",
    why="`colcon` builds ament_cmake packages with CMake.",
    example="CMAKE_COMMAND=/opt/cmake/bin/cmake wsgen build  # a path that does not exist",
    instead="python3 -m pip install cmake",
)
OLD_CMAKE = Rule(
    code="BLD013",
    name="old-cmake",
    severity=Severity.ERROR,
    summary="The installed CMake is older than the version that the package requires.",
    why="CMake stops at cmake_minimum_required().",
    example="cmake_minimum_required(VERSION 3.28)  # with CMake 3.22",
    instead="python3 -m pip install -U cmake",
)
REMOVED_POLICY = Rule(
    code="BLD070",
    name="removed-policy",
    severity=Severity.ERROR,
    summary="A package sets a policy to a behavior that CMake 4 no longer has.",
    what="Reads the error of CMake, also that of a project which the package brings or downloads.",
    why="CMake 4 refuses `cmake_policy(SET ... OLD)` for the oldest policies. The CMake of Humble "
    "and Jazzy is older, and accepts it.",
    example="cmake_policy(SET CMP0048 OLD)",
    instead="cmake_policy(SET CMP0048 NEW)",
)
MISSING_BUILD_PROGRAM = Rule(
    code="BLD014",
    name="missing-build-program",
    severity=Severity.ERROR,
    summary="CMake does not find the build program of its generator, make or ninja.",
    why="CMake writes files for this program, which then builds and installs the package.",
    example="wsgen build -- --cmake-args -G Ninja  # without ninja",
    instead="sudo apt install ninja-build",
)
MISSING_MANIFEST = Rule(
    code="PKG010",
    name="missing-manifest",
    severity=Severity.ERROR,
    summary="An ament package has no package.xml.",
    why="`ament_cmake` reads package.xml, and ROS knows a package by it.",
    example="src/my_robot/CMakeLists.txt  # without src/my_robot/package.xml",
    instead="git checkout package.xml",
)
MISSING_AMENT_CMAKE = Rule(
    code="BLD002",
    name="ament-cmake-not-found",
    severity=Severity.ERROR,
    summary="CMake does not find ament_cmake.",
    why="`ament_cmake` defines the commands that install a package for ROS 2.",
    example="colcon build  # in a shell without a sourced ROS",
    instead="source /opt/ros/humble/setup.bash; colcon build",
)
MISSING_DEPENDENCY = Rule(
    code="BLD008",
    name="missing-dependency",
    severity=Severity.ERROR,
    summary="`find_package()` does not find a package.",
    why="CMake stops. The package is not installed, or colcon does not build it first because "
    "package.xml does not name it.",
    example="find_package(my_robot_msgs REQUIRED)",
    instead="<depend>my_robot_msgs</depend>",
)


FAILED_DOWNLOAD = Rule(
    code="BLD048",
    name="failed-download",
    severity=Severity.ERROR,
    summary="A package downloads something while it is built, which fails.",
    why="FetchContent and ExternalProject of CMake need the network, git, and an address that "
    "still exists. What they load is compiled with the package, so it is not built.",
    example="""ExternalProject_Add(lely GIT_REPOSITORY https://example.com/removed.git)""",
    instead="Check the address and the network; or install the library, and find_package() it.",
)


INVALID_INTERFACE = Rule(
    code="BLD067",
    name="invalid-interface",
    severity=Severity.ERROR,
    summary="A message, service or action has a field of a type that does not exist.",
    what="Reads what the generator of wsgen prints, which builds interfaces where no ROS is "
    "sourced. Types of packages that CMakeLists.txt does not name do not exist there, either.",
    why="The interfaces of the package are not built, and nodes that import them fail.",
    example="# LoadState.msg\ndouble mass",
    instead="# LoadState.msg\nfloat64 mass",
)


def unparsed(failure: Failure) -> Iterator[Diagnostic]:
    """Name the line of CMakeLists.txt with the mistake, which CMake may notice far below."""
    if any(error.message.startswith("Parse error") for error in failure.errors):
        text = read_text(failure.cmake_file)
        mistake = parse(text)[1] if text is not None else None
        if mistake is not None:
            yield failure.report(
                CMAKE_SYNTAX, mistake.message, line=mistake.line, hint=mistake.hint
            )


def unclosed_block(failure: Failure) -> Iterator[Diagnostic]:
    """Name the if() that has no endif(), and its like."""
    if not any("not properly nested" in error.message for error in failure.errors):
        return
    opened, closing = find_open_block(failure.cmake_file)
    first = opened or closing
    if first is not None:
        message, hint = word_block(opened, closing)
        yield failure.report(CMAKE_SYNTAX, message, line=first.line, hint=hint)


def unclosed_variable(failure: Failure) -> Iterator[Diagnostic]:
    """Name the reference of a variable that has no brace at its end."""
    for error in failure.errors[:1]:
        match = re.search(
            r"CMakeLists\.txt:(\d+) when parsing string .*?(\$\{\w+)\W.*unterminated variable",
            error.message,
            re.DOTALL,
        )
        if match is not None:
            message, hint = word_unclosed(match[2])
            yield failure.report(CMAKE_SYNTAX, message, line=int(match[1]), hint=hint)


def syntax(failure: Failure) -> Iterator[Diagnostic]:
    """Report where CMake stopped parsing."""
    for error in failure.errors:
        if error.message.startswith("Parse error"):
            what = error.message.removeprefix("Parse error.").strip()
            yield failure.report(
                CMAKE_SYNTAX,
                f"CMake cannot parse the file: {what}",
                error=error,
                hint="Look from here on for a parenthesis or quotation mark that is not closed.",
            )
            return


def unknown_command(failure: Failure) -> Iterator[Diagnostic]:
    """Name the command that was meant, or the package that defines it."""
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
        message, hint = word_unknown_command(match[1], own)
        yield failure.report(UNKNOWN_COMMAND, message, error=error, hint=hint)


def missing_cmake_minimum(failure: Failure) -> Iterator[Diagnostic]:
    """Advise a version that the CMake of every ROS knows: CMake advises its own."""
    called = {call.command for call in read_calls(failure.cmake_file)}
    if "cmake_minimum_required" in called:  # an external project that the package builds lacks it
        return
    if any("No cmake_minimum_required command" in error.message for error in failure.errors):
        message, hint = word_missing_minimum()
        yield failure.report(MISSING_CMAKE_MINIMUM, message, line=1, hint=hint)


def missing_project(failure: Failure) -> Iterator[Diagnostic]:
    """Name the package as package.xml does; CMake names it Project."""
    calls = read_calls(failure.cmake_file)
    if "No project() command is present" not in failure.output or any(
        call.command == "project" for call in calls
    ):
        return
    first = next((call for call in calls if call.command == "cmake_minimum_required"), None)
    message, hint = word_project(failure.package, first.line if first else None)
    yield failure.report(MISSING_PROJECT, message, line=first.line if first else 1, hint=hint)


def unknown_language(failure: Failure) -> Iterator[Diagnostic]:
    """Say how CMake names C++, where its own advice is to name a compiler."""
    match = re.search(r"module file: CMakeDetermine(\S+)Compiler\.cmake", failure.output)
    called = [error for error in failure.errors if error.command in {"project", "enable_language"}]
    if match and called:
        yield failure.report(
            UNKNOWN_LANGUAGE,
            f"{called[0].command}() names the language {match[1]}, which CMake does not know.",
            error=called[0],
            hint=f"Write CXX for C++, C for C, and NONE for neither: project({failure.package} "
            "LANGUAGES CXX)",
        )


def missing_source(failure: Failure) -> Iterator[Diagnostic]:
    """Find the file under the same or a similar name in the package."""
    for error in failure.errors:
        match = re.search(r"Cannot find source file: (.+?)(?: Tried |$)", error.message)
        if match is None:
            continue
        path = failure.folder / match[1]
        is_inside = path.is_relative_to(failure.folder)
        name = str(path.relative_to(failure.folder) if is_inside else path)
        file, line = error.locate(failure.folder)
        yield word_source(name, failure.folder, file, line, failure.package)


def failed_download(failure: Failure) -> Iterator[Diagnostic]:
    """Name what the package wants to load."""
    match = re.search(
        r"Failed to clone repository:\s+'(.+?)'|(?s:Each download failed!.*?'(\S+://\S+?)')",
        failure.output,
    )
    if match:
        address = match[1] or match[2]
        line = next(
            (
                call.argument_lines[call.arguments.index(address)]
                for call in read_calls(failure.cmake_file)
                if address in call.arguments
            ),
            None,
        )
        yield failure.report(
            FAILED_DOWNLOAD,
            f"CMake cannot download {address}, which the package asks for while it is built.",
            line=line,
            hint="Check that the address exists and that this machine reaches it, and build again. "
            "wsgen validate uses the source folder of the package until then.",
        )


def misspelled_keyword(failure: Failure) -> Iterator[Diagnostic]:
    """Find a misspelled keyword in the call that CMake refuses."""
    for error in failure.errors:
        file, line = error.locate(failure.folder)
        for call in read_calls(file) if file is not None else ():
            for word, number in zip(call.arguments[1:], call.argument_lines[1:], strict=True):
                folders = [str(file.parent)] if file is not None else []
                meant = meant_keyword(call.command, word, folders=folders)
                if call.line == line and meant is not None:
                    yield failure.report(
                        MISSPELLED_KEYWORD,
                        word_keyword(call.command, word),
                        file=file,
                        line=number,
                        hint=did_you_mean(meant),
                    )


def missing_destination(failure: Failure) -> Iterator[Diagnostic]:
    """Say where to install to."""
    for error in failure.errors:
        match = re.search(r"install (\w+) given no .*DESTINATION", error.message)
        if match:
            message, hint = word_destination(match[1])
            yield failure.report(MISSING_DESTINATION, message, error=error, hint=hint)


def different_names(failure: Failure) -> Iterator[Diagnostic]:
    """Report both names, with their lines."""
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
        file, number = (
            (failure.cmake_file, called[-1].line) if called else error.locate(failure.folder)
        )
        yield word_names(match[2], match[1], file, number, line)


def late_command(failure: Failure) -> Iterator[Diagnostic]:
    """Say which command must come before ament_package()."""
    for error in failure.errors:
        match = re.match(r"(\w+)\(\) must be called before ament_", error.message)
        calls = [call.command for call in read_calls(failure.cmake_file)]
        if match and calls.count("ament_package") == 1:
            yield failure.report(
                LATE_COMMAND,
                f"{match[1]}() is called after ament_package(), and must come before it.",
                error=error,
                hint=AT_THE_END,
            )
            return


CMAKE_CAUSES = (
    unparsed,
    unclosed_variable,
    unclosed_block,
    syntax,
    unknown_command,  # before the next: the unknown command may be a misspelled minimum
    missing_cmake_minimum,
    missing_project,
    unknown_language,
    missing_source,
    failed_download,
    misspelled_keyword,
    missing_destination,
    different_names,
    late_command,
)


def _unsupported_empy(failure: Failure) -> Iterator[Diagnostic]:
    if re.search(
        r"module 'em' has no attribute|No module named 'em'$", failure.output, re.MULTILINE
    ):
        yield failure.report(
            UNSUPPORTED_EMPY,
            f"the templates of ROS need empy 3, but the Python that CMake uses"
            f"{_used_python(failure)} has another version or none.",
            hint="Install it there: python3 -m pip install 'empy>=3.3.4,<4' (apt: python3-empy). "
            f"{failure.clear_cache}",
        )


def _wrong_python(failure: Failure) -> Iterator[Diagnostic]:
    match = re.search(r"No module named '?(catkin_pkg|ament_package)", failure.output)
    if match:
        yield failure.report(
            WRONG_PYTHON,
            f"CMake uses a Python{_used_python(failure)} without {match[1]}.",
            hint="Deactivate other environments (conda, venv) and do not set Python3_EXECUTABLE; "
            "with a sourced ROS: sudo apt install python3-catkin-pkg-modules. "
            f"{failure.clear_cache}",
        )


def _missing_cmake(failure: Failure) -> Iterator[Diagnostic]:
    if "Could not find 'cmake' executable" in failure.output or re.search(
        r"FileNotFoundError: .*cmake", failure.output
    ):
        yield failure.report(
            MISSING_CMAKE,
            "colcon does not find CMake.",
            hint="Install it: python3 -m pip install cmake (apt: cmake). If CMAKE_COMMAND is "
            "set, it must be the path of CMake.",
        )


def _missing_build_program(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r'unable to find a build program corresponding to "(.+?)"', error.message)
        if match:
            yield failure.report(
                MISSING_BUILD_PROGRAM,
                f"CMake does not find the build program of its generator {match[1]}.",
                hint=f"Install it (apt: make or ninja-build). {failure.clear_cache}",
            )
            return


def _missing_compiler(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r"No CMAKE_(C|CXX)_COMPILER could be found", error.message)
        if match:
            yield failure.report(
                MISSING_COMPILER,
                f"CMake does not find a {'C' if match[1] == 'C' else 'C++'} compiler.",
                error=error,
                hint="Install one (apt: build-essential). A package without C and C++ code needs "
                f"none: project({failure.package} LANGUAGES NONE)",
            )
            return


def _removed_policy(failure: Failure) -> Iterator[Diagnostic]:
    """Say once that an older CMake accepts it: often the code is somebody else's."""
    found = []
    for error in failure.errors:
        match = re.search(r"Policy (CMP\d+) may not be set to OLD behavior", error.message)
        if match:
            found.append((match[1], error))
    if found:
        names = ", ".join(dict.fromkeys(name for name, _ in found))
        where = found[0][1].locate(failure.folder)[0]
        who = "the package" if where is not None else "a project that the package builds"
        yield failure.report(
            REMOVED_POLICY,
            f"{who} sets {names} to OLD, which CMake 4 refuses.",
            error=found[0][1],
            hint="Remove the line. For code that you cannot change, build with an older CMake, as "
            "that of ROS is: python3 -m pip install 'cmake<4'",
        )


OF_ROS_1 = (
    "The package is one of ROS 1: put an empty file COLCON_IGNORE into its folder, or port it to "
    "ament_cmake."
)


def _cmake_version(failure: Failure) -> Iterator[Diagnostic]:
    catkin = next(
        (
            call
            for call in read_calls(failure.cmake_file)
            if call.command == "find_package" and call.arguments[:1] == ("catkin",)
        ),
        None,
    )
    for error in failure.errors:
        if re.search(r"Compatibility with CMake < \S+ has been removed", error.message):
            if catkin is not None:  # a newer CMake would not help
                yield failure.report(
                    MISSING_DEPENDENCY,
                    "catkin builds the package, which ROS 2 does not have.",
                    line=catkin.line,
                    hint=OF_ROS_1,
                )
                continue
            message, hint = word_old_minimum(None)
            yield failure.report(
                OLD_CMAKE_MINIMUM,
                message,
                error=error,
                hint=f"{hint} For packages that you cannot change: wsgen build -- --cmake-args "
                "-DCMAKE_POLICY_VERSION_MINIMUM=3.5",
            )
        match = re.search(
            r"CMake (\S+) or higher is required\. You are running version (\S+)", error.message
        )
        if match:
            yield failure.report(
                OLD_CMAKE,
                f"the package requires CMake {match[1]}, but {match[2].rstrip('.')} is installed.",
                error=error,
                hint="Install a newer one: python3 -m pip install -U cmake. If CMAKE_COMMAND is "
                "set, it chooses the CMake that is used.",
            )


def _used_python(failure: Failure) -> str:
    match = re.search(r"execute_process\((\S+)", failure.output)
    return f" ({match[1]})" if match else ""


MACHINE_CAUSES = (
    _unsupported_empy,
    _wrong_python,
    _missing_cmake,
    _missing_build_program,
    _missing_compiler,
    _cmake_version,
    _removed_policy,
)


# Names to suggest for a misspelled one.
USUAL_PACKAGES = (
    *("ament_cmake", "ament_cmake_auto", "ament_cmake_python", "ament_lint_auto", "rclcpp"),
    *("controller_manager", "gazebo_dev", "gazebo_msgs", "gazebo_ros", "geometry_msgs"),
    *("hardware_interface", "joint_state_publisher", "nav_msgs", "pluginlib", "rclpy"),
    *("robot_state_publisher", "rosidl_default_generators", "sensor_msgs", "std_msgs", "tf2"),
    *("tf2_ros", "trajectory_msgs", "urdf", "visualization_msgs", "xacro"),
)


def refused_manifest(failure: Failure) -> Iterator[Diagnostic]:
    """Report the mistakes in package.xml.

    colcon then takes the package for one of plain CMake, in another environment and with other
    arguments, so any later failure may have its cause here.
    """
    file = failure.folder / "package.xml"
    diagnostics = check_package_xml(file) if file.is_file() else ()
    if has_errors(diagnostics):
        yield from diagnostics


def _missing_manifest(failure: Failure) -> Iterator[Diagnostic]:
    if not (failure.folder / "package.xml").exists() and "package.xml" in failure.output:
        yield failure.report(
            MISSING_MANIFEST,
            "package.xml is missing; ROS knows a package by it.",
            hint="Restore it (git checkout package.xml), write one, or create a new package: "
            "wsgen new PACKAGE",
        )


def _missing_cmake_file(failure: Failure) -> Iterator[Diagnostic]:
    if not failure.cmake_file.exists():
        message, hint = word_build_file("ament_cmake", has_other=failure.setup_file.exists())
        yield failure.report(MISSING_BUILD_FILE, message, hint=hint)


def _missing_package(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r'configuration file provided by "(.+?)"', error.message)
        if match is None:
            continue
        name = match[1]
        if name == "ament_cmake":
            yield failure.report(
                MISSING_AMENT_CMAKE,
                "CMake does not find ament_cmake.",
                error=error,
                hint="Source a ROS (source /opt/ros/<distro>/setup.bash), or install the one that "
                "comes with wsgen: python3 -m pip install --force-reinstall ros-ament-cmake",
            )
        elif failure.failed and (name in failure.failed or not _is_released(name)):
            names = [name] if name in failure.failed else sorted(failure.failed)
            yield failure.report(
                MISSING_DEPENDENCY,
                f"find_package({name}) does not find the package. The build of {', '.join(names)} "
                f"failed{'' if name in names else ', which may bring it'}.",
                error=error,
                hint=f"Correct {', '.join(names)} first.",
            )
        elif name in failure.siblings:
            yield failure.report(
                MISSING_DEPENDENCY,
                f"colcon did not build {name} of this workspace first.",
                error=error,
                hint=f"Add <depend>{name}</depend> to package.xml; colcon takes the order from it.",
            )
        else:
            yield failure.report(
                MISSING_DEPENDENCY,
                f"find_package({name}) does not find the package.",
                error=error,
                hint=_where_to_get(name, failure),
            )


def _is_released(name: str) -> bool:
    return name in released_packages() or name in cmake_packages()


def _where_to_get(name: str, failure: Failure) -> str:
    released = released_packages()
    known = {*failure.siblings, *released, *cmake_packages()}
    if name not in known:
        clone = _where_to_clone(name, failure)
        usual = {*failure.siblings, *USUAL_PACKAGES, *cmake_packages()} - {failure.package}
        near = nearest(name, usual, cutoff=0.75) or nearest(name, known, cutoff=0.9)
        if near is not None and not clone:
            return did_you_mean(near)
        return clone or (
            "No ROS distribution has a package of this name: correct the name, clone the package "
            "into src, or install the library that brings it."
        )
    without = "remove the line if the package does not compile against it"
    if not failure.distro:
        return f"Source a ROS that has it (source /opt/ros/<distro>/setup.bash), or {without}."
    if name in cmake_packages() and name not in released:
        return f"Install it (apt: lib{name.lower()}-dev), or {without}."
    return f"Install it (apt: ros-{failure.distro}-{name.replace('_', '-')}), or {without}."


def _where_to_clone(name: str, failure: Failure) -> str:
    """For a package that no ROS 2 has: what a file for vcs in the repository says; maybe empty."""
    if name == "catkin":
        return OF_ROS_1
    for folder in failure.folder.parents[:3]:
        files = [file for depth in ("", "*/") for file in folder.glob(f"{depth}*.repos")]
        for file in sorted(files, key=lambda one: ("sim" not in one.name, one)):
            with suppress(OSError):
                text = read_regular_text(file, errors="replace")
                if re.search(rf"(?m)^\s+(?:\S+/)?{re.escape(name)}:\s*$", text):
                    return f"Clone it into src, then build again: vcs import src < {file}"
    return ""


def _repeated_ament_package(failure: Failure) -> Iterator[Diagnostic]:
    calls = [call for call in read_calls(failure.cmake_file) if call.command == "ament_package"]
    if len(calls) > 1 and "ament_package" in failure.output:
        yield failure.report(
            REPEATED_AMENT_PACKAGE,
            f"ament_package() is called again; the first call is in line {calls[0].line}.",
            line=calls[1].line,
            hint="Call it once, at the end.",
        )


def _missing_installed_path(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        match = re.search(r'file INSTALL cannot find "(.+?)"', error.message)
        if match is None:
            continue
        path = failure.folder / match[1]
        if not path.is_relative_to(failure.folder):
            continue
        name = str(path.relative_to(failure.folder))
        line, kind = _find_install(failure, name)
        file = failure.cmake_file
        yield word_missing_path(name, kind, failure.folder, file, line, failure.package)


def _find_install(failure: Failure, name: str) -> tuple[int | None, str]:
    """Find the line that installs the path, and whether it installs it as a folder or a file."""
    for call in read_calls(failure.cmake_file):
        if call.command != "install":
            continue
        for argument, line in zip(call.arguments, call.argument_lines, strict=True):
            if argument.rstrip("/") == name or argument.rstrip("/").endswith(f"}}/{name}"):
                return line, "folder" if "DIRECTORY" in call.arguments else "file"
    return None, "file or folder"


def _xacro_error(failure: Failure) -> Iterator[Diagnostic]:
    """Report what `wsgen.building.toolchain` prints."""
    for name, line, message, hint in re.findall(
        r"(?m)^xacro: (.+?):(\d*): (.+)\nxacro: (.*)$", failure.output
    ):
        yield failure.report(
            XACRO_FILE_FAILS,
            f"xacro cannot expand the file: {message.rstrip('.')}.",
            file=Path(name).resolve(),
            line=int(line) if line else None,
            hint=hint or failure.where_to_look,
        )


def _invalid_interface(failure: Failure) -> Iterator[Diagnostic]:
    """Report what `wsgen.ros.environment.workspace_messages` prints."""
    for name, line, message, question in re.findall(
        r"(?m)^(/.+\.(?:msg|srv|action|idl)):(\d+): error: (.+?\.)(?: (Did you mean .+))?$",
        failure.output,
    ):
        yield failure.report(
            INVALID_INTERFACE,
            message,
            file=Path(name),
            line=int(line),
            hint=question or _hint_for_type(message),
        )


def _hint_for_type(message: str) -> str:
    package, is_undeclared, _ = message.partition(" is used, but it is not among DEPENDENCIES")
    if is_undeclared:
        return f"Add {package} to them, and <depend>{package}</depend> to package.xml."
    return (
        "Write a type such as float64 or string, or PACKAGE/NAME of a message of a package among "
        "DEPENDENCIES of rosidl_generate_interfaces()."
    )


PACKAGE_CAUSES = (
    _invalid_interface,
    _missing_manifest,
    _missing_cmake_file,
    _missing_package,
    _repeated_ament_package,
    _missing_installed_path,
    _xacro_error,
)
