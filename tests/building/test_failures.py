"""Each failure that is known, made by a real build, and what is said about it."""

import os
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from building.building import (
    CMAKE,
    LINTED,
    PACKAGE_XML,
    SHELL_PROGRAMS,
    build_here,
    link_programs,
    outside,
    plain_colcon,
    write_package,
)
from wsgen.building.colcon import Finished
from wsgen.building.explain import explain, explain_colcon, refuse_full_disk
from wsgen.building.failure import Failure
from wsgen.building.run import BuildResult
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.errors import NotReadableError
from wsgen.events import Event, OutputLine
from wsgen.packages.build_files.facts import read_build_facts
from wsgen.packages.workspace.layout import Workspace

pytestmark = pytest.mark.slow

# The code, the line of CMakeLists.txt, words of the message and of the hint, by what is written.
CMAKE_CASES = {
    "installs a folder that is not there": (
        CMAKE.replace("launch model", "launch modle"),
        ("BLD003", 5, "the folder modle", "Did you mean `model`?"),
    ),
    "installs a file that is not there": (
        CMAKE.replace("DIRECTORY launch model", "FILES\n    model/robot.urdf"),
        ("BLD003", 6, "the file model/robot.urdf", "Did you mean `robot.xacro`?"),
    ),
    "exports what is not exported any more": (
        CMAKE + "ament_export_dependencies(rclcpp)\n",
        ("BLD049", 9, "ament_export_dependencies() is called after", "Move ament_package()"),
    ),
    "needs a package that is not there": (
        CMAKE.replace("install(", "find_package(frobnicator REQUIRED)\ninstall("),
        ("BLD008", 4, "frobnicator", "No ROS distribution has a package of this name"),
    ),
    "needs a package of ROS 1": (
        CMAKE.replace("install(", "find_package(catkin REQUIRED)\ninstall("),
        ("BLD008", 4, "catkin", "one of ROS 1"),
    ),
    "is an old package of ROS 1": (
        CMAKE.replace("VERSION 3.20", "VERSION 2.8.3").replace(
            "install(", "find_package(catkin REQUIRED)\ninstall("
        ),
        ("BLD008", 4, "catkin", "one of ROS 1"),
    ),
    "misspells a package": (
        CMAKE.replace("find_package(ament_cmake", "find_package(ament_cmak"),
        ("BLD008", 3, "find_package(ament_cmak)", "Did you mean `ament_cmake`?"),
    ),
    "calls what it has not found": (
        CMAKE.replace("find_package(ament_cmake REQUIRED)\n", ""),
        ("BLD027", 7, "ament_package", "find_package(ament_cmake REQUIRED)"),
    ),
    "misspells its own function": (
        CMAKE + "function(install_model)\nendfunction()\ninstal_model()\n",
        ("BLD027", 11, "instal_model", "Did you mean `install_model`?"),
    ),
    "calls something that nobody knows": (
        CMAKE + "frobnicate()\n",
        ("BLD027", 9, "frobnicate", "Correct its name"),
    ),
    "installs nowhere": (
        CMAKE.replace("DESTINATION share/${PROJECT_NAME}", ""),
        ("BLD028", 4, "install(DIRECTORY ...)", "DESTINATION share/${PROJECT_NAME}"),
    ),
    "has another name than the manifest": (
        CMAKE.replace("project(demo", "project(robot"),
        ("BLD029", 2, "names the package robot, but package.xml (line 3)", "project(demo)"),
    ),
    "does not close a quotation mark": (
        CMAKE.replace("find_package(", 'message("hello)\nfind_package('),
        ("BLD011", 3, "opens a quotation mark", "Close it"),
    ),
    "does not close one of several quotation marks": (
        CMAKE.replace("find_package(", 'message("hello)\nmessage("bye")\nfind_package('),
        ("BLD011", 3, "opens a quotation mark", "Close it"),
    ),
    "does not end an if()": (
        CMAKE.replace("install(", "if(UNIX)\nif(TRUE)\nendif()\ninstall("),
        ("BLD011", 4, "if() in line 4 is not closed by endif()", "Add endif()"),
    ),
    "does not end a loop in an if()": (
        CMAKE.replace("install(", "if(UNIX)\nforeach(x 1 2)\nendif()\ninstall("),
        ("BLD011", 5, "is not closed by endforeach() before endif() in line 6", "Add endforeach()"),
    ),
    "ends an if() twice": (
        CMAKE.replace("install(", "if(UNIX)\nendif()\nendif()\ninstall("),
        ("BLD011", 6, "endif() in line 6 has no matching if()", "Remove endif()"),
    ),
    "calls ament_package twice": (
        CMAKE + "ament_package()\n",
        ("BLD009", 9, "line 8", "Call it once"),
    ),
    "does not close a parenthesis": (
        CMAKE.replace("${PROJECT_NAME}\n)", "${PROJECT_NAME}\n"),
        ("BLD011", 4, "The parenthesis of install( is not closed", "Add `)`"),
    ),
    "does not close a brace": (
        CMAKE.replace("${PROJECT_NAME}\n)", "${PROJECT_NAME\n)"),
        ("BLD011", 6, "`${PROJECT_NAME` is not closed", "Write `${PROJECT_NAME}`"),
    ),
    "asks for no CMake": (
        CMAKE.replace("cmake_minimum_required(VERSION 3.20)\n", ""),
        ("BLD031", 1, "does not call cmake_minimum_required()", "(VERSION 3.8...3.31)"),
    ),
    "misspells the call that asks for a CMake": (
        CMAKE.replace("cmake_minimum_required", "cmake_minimum_require"),
        ("BLD027", 1, "cmake_minimum_require()", "Did you mean `cmake_minimum_required`?"),
    ),
    "asks for a CMake to come": (
        CMAKE.replace("3.20", "99.0"),
        ("BLD013", 1, "requires CMake 99.0", "newer"),
    ),
    "misspells a command": (
        CMAKE.replace("ament_package", "ament_pakage"),
        ("BLD027", 8, "ament_pakage", "Did you mean `ament_package`?"),
    ),
    "stops for a reason of its own": (
        CMAKE + "message(FATAL_ERROR no)\n",
        ("BLD015", 9, "CMake: no", "stdout_stderr.log"),
    ),
    "enables a language that nobody knows": (
        CMAKE.replace("LANGUAGES NONE", "CXXX"),
        ("BLD047", 2, "project() names the language CXXX", "Write CXX for C++"),
    ),
    "has no project()": (
        CMAKE.replace("project(demo LANGUAGES NONE)\n", ""),
        ("BLD045", 1, "does not call project()", "Add after line 1: project(demo)"),
    ),
    "compiles a file that is not there": (
        CMAKE.replace(" LANGUAGES NONE", "").replace(
            "install(", "add_library(own\n  own.cpp)\ninstall("
        ),
        ("BLD046", 4, "the source file own.cpp", "Create it"),
    ),
    "compiles a file that is not there with what is missing": (
        CMAKE.replace(" LANGUAGES NONE", "").replace(
            "install(", "find_package(rclcpp REQUIRED)\nadd_library(own own.cpp)\ninstall("
        ),
        ("BLD046", 5, "the source file own.cpp", "Create it"),
    ),
    "downloads what nobody has": (
        CMAKE
        + """include(ExternalProject)
ExternalProject_Add(own
  GIT_REPOSITORY file:///nobody/has.git)
""",
        ("BLD048", 11, "cannot download file:///nobody/has.git", "Check that the address exists"),
    ),
    "configures a file that is not there": (
        CMAKE + "configure_file(missing.in made)\n",
        ("BLD015", 9, "missing.in does not exist", "stdout_stderr.log"),
    ),
    "fails without a word of CMake": (
        CMAKE + 'add_custom_target(work ALL COMMAND sh -c "echo the cause >&2; false" VERBATIM)\n',
        ("BLD016", None, "the cause", "stdout_stderr.log"),
    ),
}


def only(result: BuildResult) -> Diagnostic:
    assert not result.succeeded
    (diagnostic,) = result.diagnostics
    assert diagnostic.severity is Severity.ERROR
    return diagnostic


class Together:
    """One build of many packages, each with a cause of its own, and what is said of each."""

    def __init__(self, root: Path, files: Mapping[str, tuple[str, str]]) -> None:
        """`files` are the package.xml and the CMakeLists.txt of the package `demo`, by case."""
        self.folders: dict[str, Path] = {}
        for number, (case, (package_xml, cmake)) in enumerate(files.items()):
            self.folders[case] = write_package(
                root, f"demo{number}", package_xml=package_xml, cmake=cmake
            )
        self.events: list[Event] = []
        self.result = build_here(root, events=self.events)
        assert not self.result.succeeded
        # Nothing is said of what is not one of them.
        assert {self.folder_of(found) for found in self.result.diagnostics} <= {
            *self.folders.values()
        }

    def folder_of(self, diagnostic: Diagnostic) -> Path | None:
        """The folder of the package that is meant."""
        file = diagnostic.file
        return file if file is None or file.is_dir() else file.parent

    def said_of(self, case: str) -> list[Diagnostic]:
        """What is said of a package."""
        folder = self.folders[case]
        return [found for found in self.result.diagnostics if self.folder_of(found) == folder]

    def only(self, case: str) -> Diagnostic:
        """The one diagnostic of a package, which failed for it; an old version is told, too."""
        (diagnostic,) = (one for one in self.said_of(case) if one.code != "BLD030")
        assert diagnostic.severity is Severity.ERROR
        return diagnostic

    def printed_by(self, case: str) -> tuple[list[str], tuple[str, ...]]:
        """The lines on standard error of a package, as events and in the result."""
        name = self.folders[case].name
        (package,) = (one for one in self.result.packages if one.name == name)
        assert package.outcome == "failed"
        lines = [
            event.text
            for event in self.events
            if isinstance(event, OutputLine)
            and event.is_error_stream
            and event.step == ("build", name)
        ]
        return lines, package.error_output


@pytest.fixture(scope="module")
def cmake_files(tmp_path_factory: pytest.TempPathFactory) -> Together:
    """Starting colcon takes as long as configuring a package does."""
    files = {case: (PACKAGE_XML, cmake) for case, (cmake, _) in CMAKE_CASES.items()}
    return Together(tmp_path_factory.mktemp("cmake"), files)


@pytest.mark.parametrize("case", CMAKE_CASES)
def test_cmake_file(case: str, cmake_files: Together) -> None:
    _, (code, line, message, hint) = CMAKE_CASES[case]
    folder = cmake_files.folders[case]
    diagnostic = cmake_files.only(case)
    assert (diagnostic.code, diagnostic.line) == (code, line)
    assert diagnostic.file == (folder if line is None else folder / "CMakeLists.txt")
    assert message.replace("demo", folder.name) in diagnostic.message
    assert hint.replace("demo", folder.name) in (diagnostic.hint or "")
    # What the programs said is there once, as events and in the result.
    lines, error_output = cmake_files.printed_by(case)
    assert tuple(lines) == error_output != ()
    # The text shows many of the mistakes before a build, in the same words.
    manifest_line = int(PACKAGE_XML.splitlines().index("  <name>demo</name>") + 1)
    _, found = read_build_facts(folder, folder.name, "ament_cmake", manifest_line)
    seen = {(one.message, one.hint) for one in found if one.code == code}
    is_in_same_words = (diagnostic.message, diagnostic.hint) in seen
    assert is_in_same_words or not seen, seen
    assert seen or code not in {"BLD011", "BLD028", "BLD029", "BLD031", "BLD045"}


def test_a_cmake_file_that_fails_alone(tmp_path: Path) -> None:
    """Without another failed package; the lines come once."""
    file = write_package(tmp_path, cmake=CMAKE + "frobnicate()\n") / "CMakeLists.txt"
    events: list[Event] = []
    result = build_here(tmp_path, events=events)
    diagnostic = only(result)
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == ("BLD027", file, 9)
    lines = [
        event.text for event in events if isinstance(event, OutputLine) and event.is_error_stream
    ]
    assert tuple(lines) == result.packages[0].error_output != ()


def test_a_cmake_of_old_is_asked_for(tmp_path: Path) -> None:
    write_package(tmp_path, cmake=CMAKE.replace("3.20", "2.8"))
    environment = {**outside(), "CMAKE_POLICY_VERSION_MINIMUM": "2.8"}
    diagnostic = only(build_here(tmp_path, environment=environment))
    assert (diagnostic.code, diagnostic.line) == ("BLD012", 1)
    assert "VERSION 3.8...3.31" in (diagnostic.hint or "")
    shutil.rmtree(tmp_path / "build")  # CMake keeps the version
    assert build_here(tmp_path).succeeded


def test_a_project_inside_that_asks_for_no_cmake(tmp_path: Path) -> None:
    """The package itself asks for one."""
    inner = "${PROJECT_BINARY_DIR}/inner"
    write_package(
        tmp_path,
        cmake=f'{CMAKE}file(WRITE {inner}/CMakeLists.txt "enable_testing()")\n'
        f"execute_process(COMMAND ${{CMAKE_COMMAND}} {inner} COMMAND_ERROR_IS_FATAL ANY)\n",
    )
    result = build_here(tmp_path)
    assert {found.code for found in result.diagnostics} == {"BLD015"}
    assert "No cmake_minimum_required command" in "\n".join(result.unexplained_output)


def test_a_folder_that_git_did_not_keep(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    (package / "launch" / "demo.launch.py").unlink()
    (package / "launch").rmdir()
    diagnostic = only(build_here(tmp_path))
    assert (diagnostic.code, diagnostic.line) == ("BLD003", 5)
    assert "Git does not keep empty folders" in (diagnostic.hint or "")


def test_no_cmake_file(tmp_path: Path) -> None:
    (write_package(tmp_path) / "CMakeLists.txt").unlink()
    diagnostic = only(build_here(tmp_path))
    assert (diagnostic.code, diagnostic.file) == ("BLD021", tmp_path / "src" / "demo")


def test_no_package_xml(tmp_path: Path) -> None:
    (write_package(tmp_path) / "package.xml").unlink()
    diagnostic = only(build_here(tmp_path))
    assert (diagnostic.code, diagnostic.file) == ("PKG010", tmp_path / "src" / "demo")


def test_apt_is_advised_where_a_ros_is_sourced(tmp_path: Path) -> None:
    write_package(
        tmp_path, cmake=CMAKE.replace("install(", "find_package(nav_msgs REQUIRED)\ninstall(")
    )
    sourced = {"AMENT_PREFIX_PATH": sys.prefix, "ROS_DISTRO": "iron"}
    diagnostic = only(build_here(tmp_path, environment={**outside(), **sourced}))
    assert "ros-iron-nav-msgs" in (diagnostic.hint or "")


def test_output_is_shown_again_where_it_is_not_explained(tmp_path: Path) -> None:
    file = write_package(tmp_path, cmake=CMAKE + "message(WARNING odd)\n") / "CMakeLists.txt"
    assert "  odd" in build_here(tmp_path).unexplained_output
    file.write_text(CMAKE + "message(WARNING odd)\nmessage(FATAL_ERROR no)\n")
    assert {"  odd", "  no"} <= {*build_here(tmp_path).unexplained_output}
    file.write_text(CMAKE + "message(WARNING odd)\nfrobnicate()\n")
    assert build_here(tmp_path).unexplained_output == ()
    write_package(tmp_path, "other", cmake=CMAKE + "message(WARNING strange)\n")
    assert "  strange" in build_here(tmp_path, "other").unexplained_output


def test_the_traceback_about_a_manifest_is_not_told_again(tmp_path: Path) -> None:
    text = PACKAGE_XML.replace("<license>Apache-2.0</license>", "")
    write_package(tmp_path, package_xml=text)
    result = build_here(tmp_path)
    assert "Traceback" in "".join(result.packages[0].error_output)
    assert result.unexplained_output == ()


def test_without_ament_package_ros_finds_nothing(tmp_path: Path) -> None:
    file = write_package(tmp_path, cmake=CMAKE.replace("ament_package()\n", "")) / "CMakeLists.txt"
    diagnostic = only(build_here(tmp_path))
    assert (diagnostic.code, diagnostic.file) == ("BLD010", file)


def test_an_ament_package_that_was_removed_later(tmp_path: Path) -> None:
    file = write_package(tmp_path) / "CMakeLists.txt"
    assert build_here(tmp_path).succeeded
    file.write_text(CMAKE.replace("ament_package()\n", ""))
    assert only(build_here(tmp_path)).code == "BLD010"


@pytest.mark.parametrize("requested", [(), ("demo",)])
@pytest.mark.parametrize(
    ("build_type", "hint"),
    [("ament_cmke", "Did you mean `ament_cmake`?"), ("meson", "Known: ament_cmake, ament_")],
)
def test_a_build_type_that_colcon_does_not_know(
    build_type: str, hint: str, requested: tuple[str, ...], tmp_path: Path
) -> None:
    package = write_package(
        tmp_path, package_xml=PACKAGE_XML.replace("ament_cmake</b", f"{build_type}</b")
    )
    write_package(tmp_path, "other")
    diagnostic = only(build_here(tmp_path, *requested))
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == (
        "PKG008",
        package / "package.xml",
        9,
    )
    assert hint in (diagnostic.hint or "")


def test_a_package_of_plain_cmake_has_no_build_type_to_give(tmp_path: Path) -> None:
    text = PACKAGE_XML.replace("<build_type>ament_cmake</build_type>", "")
    cmake = "cmake_minimum_required(VERSION 3.20)\nproject(demo LANGUAGES NONE)\n"
    write_package(tmp_path, package_xml=text, cmake=cmake)
    assert build_here(tmp_path).diagnostics == ()


def test_a_package_that_is_asked_for_and_skipped(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    write_package(tmp_path, "other")
    (tmp_path / "colcon_defaults.yaml").write_text("build: {packages-skip: [demo]}\n")
    diagnostic = only(build_here(tmp_path, "demo"))
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == (
        "BLD023",
        package / "package.xml",
        3,
    )
    assert build_here(tmp_path).succeeded


MANIFEST_CASES = {
    "is no XML": (PACKAGE_XML.replace("</license>", ""), ("PKG001", 7, "<license> is not closed")),
    "is empty": ("", ("PKG001", 1, "the file is empty")),
    "names no package": (
        PACKAGE_XML.replace("<name>demo</name>", ""),
        ("PKG004", None, "does not name"),
    ),
    "has a bad address": (
        PACKAGE_XML.replace("somebody@example.com", "somebody"),
        ("PKG005", 6, "Invalid email"),
    ),
    "has no version": (
        PACKAGE_XML.replace("<version>0.0.0</version>", ""),
        ("PKG005", 2, '"version"'),
    ),
    "needs itself": (
        PACKAGE_XML.replace("<export>", "<depend>demo</depend><export>"),
        ("PKG005", 3, "same name"),
    ),
    "misspells an element": (
        PACKAGE_XML.replace("<export>", "<exec_depends>xacro</exec_depends><export>"),
        ("PKG005", 9, "exec_depends"),
    ),
}


NO_BUILD_TYPE = {
    "has no <export>": (
        PACKAGE_XML.replace("<export><build_type>ament_cmake</build_type></export>", ""),
        (None, "Add: <export><build_type>ament_cmake</build_type></export>"),
    ),
    "has an empty <export>": (
        PACKAGE_XML.replace("<export><build_type>ament_cmake</build_type></export>", "<export/>"),
        (9, "Add below <export>: <build_type>ament_cmake</build_type>"),
    ),
}
BOTH = {"plain": CMAKE, "linted": LINTED}


@pytest.fixture(scope="module")
def manifests(tmp_path_factory: pytest.TempPathFactory) -> Together:
    texts = {case: text for case, (text, _) in (MANIFEST_CASES | NO_BUILD_TYPE).items()}
    files = {
        f"{case}, {kind}": (text, cmake)
        for case, text in texts.items()
        for kind, cmake in BOTH.items()
    }
    return Together(tmp_path_factory.mktemp("manifests"), files)


@pytest.mark.parametrize("kind", BOTH)
@pytest.mark.parametrize("case", MANIFEST_CASES)
def test_package_xml(case: str, kind: str, manifests: Together) -> None:
    """colcon takes the package for one of plain CMake, and its failure is not told."""
    _, (code, line, message) = MANIFEST_CASES[case]
    found = manifests.said_of(f"{case}, {kind}")
    assert {one.code for one in found} == {code}
    file = manifests.folders[f"{case}, {kind}"] / "package.xml"
    assert (found[0].file, found[0].line) == (file, line)
    assert message in found[0].message


@pytest.mark.parametrize("kind", BOTH)
@pytest.mark.parametrize("case", NO_BUILD_TYPE)
def test_no_build_type(case: str, kind: str, manifests: Together) -> None:
    _, (line, hint) = NO_BUILD_TYPE[case]
    found = manifests.only(f"{case}, {kind}")
    file = manifests.folders[f"{case}, {kind}"] / "package.xml"
    assert (found.code, found.file, found.line, found.hint) == ("PKG009", file, line, hint)


def test_a_refused_package_xml_of_a_package_that_colcon_builds_all_the_same(
    tmp_path: Path,
) -> None:
    """As one of plain CMake, or of plain Python, without a word."""
    text = PACKAGE_XML.replace("somebody@example.com", "you@localhost")
    cmake = "cmake_minimum_required(VERSION 3.20)\nproject(demo LANGUAGES NONE)\n"
    package = write_package(tmp_path, package_xml=text, cmake=cmake)
    python = tmp_path / "src" / "snake"
    python.mkdir()
    (python / "package.xml").write_text(text.replace(">demo<", ">snake<"))
    (python / "setup.cfg").write_text("[metadata]\nname = snake\nversion = 1.0.0\n")
    (python / "setup.py").write_text("from setuptools import setup\nsetup()\n")
    result = build_here(tmp_path)
    assert {one.name: one.outcome for one in result.packages} == {"demo": "built", "snake": "built"}
    refused = [one for one in result.diagnostics if one.code == "PKG005"]
    places = [(one.file, one.line) for one in refused]
    assert places == [(one / "package.xml", 6) for one in (package, python)]
    assert not result.succeeded


def test_package_xml_in_another_encoding(tmp_path: Path) -> None:
    package = write_package(tmp_path, cmake=LINTED)
    text = PACKAGE_XML.replace("A robot", "A r\u00f6bot")
    for encoding, line in (("utf-16", 1), ("iso-8859-1", 5)):
        declared = text.replace('"1.0"?', f'"1.0" encoding="{encoding}"?')
        (package / "package.xml").write_bytes(declared.encode(encoding))
        diagnostic = only(build_here(tmp_path))
        assert (diagnostic.code, diagnostic.line) == ("PKG002", line)
        assert "not UTF-8" in diagnostic.message


def test_a_misspelt_element_of_package_xml(tmp_path: Path) -> None:
    write_package(
        tmp_path,
        package_xml=PACKAGE_XML.replace("<export>", "<exec_depends>a</exec_depends><export>"),
    )
    assert "Did you mean `exec_depend`?" in (only(build_here(tmp_path)).hint or "")


def test_a_broken_manifest_of_the_package_that_is_asked_for(tmp_path: Path) -> None:
    (write_package(tmp_path) / "package.xml").write_text("<package>")
    assert only(build_here(tmp_path, "demo")).code == "PKG001"
    assert not (tmp_path / "build").exists()


def test_two_packages_of_one_name(tmp_path: Path) -> None:
    write_package(tmp_path)
    second = write_package(tmp_path, "copy")
    (second / "package.xml").write_text(PACKAGE_XML)
    diagnostic = only(build_here(tmp_path))
    assert (diagnostic.code, diagnostic.element) == ("PKG007", "demo")
    assert "src/copy" in diagnostic.message
    assert "src/demo" in diagnostic.message


def test_a_package_of_the_workspace_that_is_not_declared(tmp_path: Path) -> None:
    needs = CMAKE.replace("install(", "find_package(zlast REQUIRED)\ninstall(")
    write_package(tmp_path, cmake=needs)
    write_package(tmp_path, "zlast")
    diagnostic = only(build_here(tmp_path))
    assert diagnostic.code == "BLD008"
    assert "<depend>zlast</depend>" in (diagnostic.hint or "")


def test_a_package_that_a_file_for_vcs_names(tmp_path: Path) -> None:
    needs = CMAKE.replace("install(", "find_package(rclcpq_msgs REQUIRED)\ninstall(")
    folder = write_package(tmp_path, cmake=needs)
    for name in ("robot.repos", "simulation.repos"):
        (folder.parent / name).write_text("repositories:\n  somebody/rclcpq_msgs:\n    type: git\n")
    hint = only(build_here(tmp_path)).hint
    assert hint == (
        f"Clone it into src, then build again: vcs import src < {folder.parent}/simulation.repos"
    )


def test_a_dependency_that_was_not_built(tmp_path: Path) -> None:
    depends = PACKAGE_XML.replace("<export>", "<depend>base</depend><export>")
    write_package(tmp_path, package_xml=depends)
    write_package(tmp_path, "base")
    result = build_here(tmp_path, colcon_arguments=("--packages-select", "demo"))
    diagnostic = result.diagnostics[0]
    assert not result.succeeded
    assert (diagnostic.code, diagnostic.hint) == ("BLD019", "Build them first: wsgen build base")


def test_a_python_without_what_ament_needs(tmp_path: Path) -> None:
    write_package(tmp_path)
    python = link_python(tmp_path)
    result = build_here(
        tmp_path, colcon_arguments=("--cmake-args", f"-DPython3_EXECUTABLE={python}")
    )
    diagnostic = only(result)
    assert diagnostic.code == "BLD004"
    assert str(python) in diagnostic.message
    assert str(tmp_path / "build" / "demo") in (diagnostic.hint or "")


def link_python(folder: Path) -> Path:
    """Make a Python that has the standard library alone."""
    environment = folder / "COLCON_IGNORE-python"
    (environment / "bin").mkdir(parents=True)
    home = Path(sys.base_prefix, "bin")
    (environment / "pyvenv.cfg").write_text(f"home = {home}\n")
    python = environment / "bin" / "python3"
    python.symlink_to(home / f"python{sys.version_info[0]}.{sys.version_info[1]}")
    return python


def test_empy_4(tmp_path: Path) -> None:
    """A package that expands a template as rosidl does, where empy 4 is in empy 3's place."""
    expand = (
        "execute_process(COMMAND ${Python3_EXECUTABLE} -c\n"
        '  "import em; em.Interpreter(options={em.BUFFERED_OPT: True})"\n'
        "  COMMAND_ERROR_IS_FATAL ANY)\n"
    )
    write_package(tmp_path, cmake=CMAKE.replace("ament_package()", expand + "ament_package()"))
    assert build_here(tmp_path).succeeded
    (tmp_path / "build" / "demo" / "CMakeCache.txt").unlink()
    modules = tmp_path / "modules"
    modules.mkdir()
    (modules / "em.py").write_text("__version__ = '4.2'\n\nclass Interpreter:\n    pass\n")
    diagnostic = only(build_here(tmp_path, environment={**outside(), "PYTHONPATH": str(modules)}))
    assert diagnostic.code == "BLD005"
    assert "empy>=3.3.4,<4" in (diagnostic.hint or "")


def test_no_compiler(tmp_path: Path) -> None:
    write_package(tmp_path, cmake=CMAKE.replace("demo LANGUAGES NONE", "demo "))
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    environment = {**outside(), "PATH": str(path)}
    arguments = ("--cmake-args", "-DCMAKE_CXX_COMPILER=c++")  # whoever names one wants it
    diagnostic = only(build_here(tmp_path, colcon_arguments=arguments, environment=environment))
    assert (diagnostic.code, diagnostic.line) == ("BLD006", 2)
    assert "LANGUAGES NONE" in (diagnostic.hint or "")


def test_no_program_for_the_generator(tmp_path: Path) -> None:
    write_package(tmp_path)
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    diagnostic = only(
        build_here(
            tmp_path,
            colcon_arguments=("--cmake-args", "-G", "Unix Makefiles"),
            environment={**outside(), "PATH": str(path)},
        )
    )
    assert diagnostic.code == "BLD014"


def test_no_cmake(tmp_path: Path) -> None:
    write_package(tmp_path)
    environment = {**outside(), "CMAKE_COMMAND": str(tmp_path / "no" / "cmake")}
    assert only(build_here(tmp_path, environment=environment)).code == "BLD007"


def test_no_ament_cmake(tmp_path: Path) -> None:
    """CMake is told not to look where it is."""
    write_package(tmp_path)
    arguments = ("--cmake-args", f"-DCMAKE_IGNORE_PREFIX_PATH={sys.prefix}")
    diagnostic = only(build_here(tmp_path, colcon_arguments=arguments))
    assert (diagnostic.code, diagnostic.line) == ("BLD002", 3)


def test_the_other_install_layout(tmp_path: Path) -> None:
    write_package(tmp_path)
    plain_colcon(tmp_path, outside(), "--merge-install")
    diagnostic = only(build_here(tmp_path))
    assert diagnostic.code == "BLD017"
    assert "--merge-install" in (diagnostic.hint or "")
    assert build_here(tmp_path, colcon_arguments=("--merge-install",)).succeeded


def test_the_build_folder_of_another_tool(tmp_path: Path) -> None:
    write_package(tmp_path)
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / ".built_by").write_text("catkin_make\n")
    diagnostic = only(build_here(tmp_path))
    assert diagnostic.code == "BLD018"
    assert "catkin_make" in diagnostic.message


@pytest.mark.parametrize("folder", ["build", "install", "log"])
def test_a_file_in_the_place_of_a_folder(folder: str, tmp_path: Path) -> None:
    write_package(tmp_path)
    (tmp_path / folder).write_text("")
    with pytest.raises(NotReadableError, match="cannot write") as raised:
        build_here(tmp_path)
    assert str(tmp_path / folder) in raised.value.message


@pytest.mark.parametrize(
    ("finished", "words"),
    [
        (Finished(returncode=-9, output=""), "signal 9"),
        (Finished(returncode=1, output="something\nthat nobody knows\n"), "that nobody knows"),
        (Finished(returncode=1, output=""), "colcon failed without output."),
        (
            Finished(returncode=1, output="Traceback (most recent call last):\n  f()\nOops: no\n"),
            "colcon failed: Oops: no",
        ),
    ],
)
def test_colcon_fails_for_an_unknown_reason(finished: Finished, words: str) -> None:
    workspace = Workspace(root=Path("/ws"))
    (diagnostic,) = explain_colcon(finished.output, finished.returncode, workspace)
    assert diagnostic.code == "BLD020"
    assert words in diagnostic.message


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a full device")
def test_a_full_disk_is_reported_once(tmp_path: Path) -> None:
    copy = "COMMAND cp ${CMAKE_CURRENT_SOURCE_DIR}/package.xml /dev/full"
    full = f"execute_process({copy} COMMAND_ERROR_IS_FATAL ANY)\n"
    write_package(tmp_path, cmake=CMAKE + full)
    write_package(tmp_path, "other", cmake=CMAKE + full)
    with pytest.raises(NotReadableError, match="the disk is full") as raised:
        build_here(tmp_path, colcon_arguments=("--continue-on-error",))
    assert str(tmp_path) in raised.value.message
    assert len(str(raised.value).splitlines()) == 2


def test_a_log_that_found_no_room(tmp_path: Path) -> None:
    """colcon goes on where its log cannot be written, with a traceback for each line of it."""
    output = "--- Logging error ---\nTraceback\nOSError: [Errno 28] No space left on device\n" * 99
    with pytest.raises(NotReadableError, match="the disk is full"):
        refuse_full_disk(output, Workspace(root=tmp_path))
    refuse_full_disk("WARNING: something else", Workspace(root=tmp_path))


def test_a_disk_too_full_to_say_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_package(tmp_path, cmake=CMAKE + "message(FATAL_ERROR strange)\n")
    full = os.statvfs_result((4096, 4096, 1000, 1, 1, 1000, 500, 500, 0, 255))
    monkeypatch.setattr(os, "statvfs", lambda _folder: full)
    with pytest.raises(NotReadableError, match="the disk is full"):
        build_here(tmp_path)


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        (
            "double is not a type. Did you mean `float64`?",
            "double is not a type.",
            "Did you mean `flo",
        ),
        (
            "nav_msgs is used, but it is not among DEPENDENCIES in CMakeLists.txt.",
            "nav_msgs is used, but it is not among DEPENDENCIES in CMakeLists.txt.",
            "Add nav_msgs to them, and <depend>nav_msgs</depend>",
        ),
        ("zzz is not a type.", "zzz is not a type.", "Write a type such as float64"),
    ],
)
def test_a_type_that_no_interface_has(text: str, message: str, hint: str, tmp_path: Path) -> None:
    file = tmp_path / "msg" / "Load.msg"
    (found,) = explain(
        Failure(
            package="demo",
            folder=tmp_path,
            is_python=False,
            build_folder=tmp_path / "build",
            output=f"{file}:2: error: {text}\ngmake[2]: *** [demo.stamp] Error 1\n",
            siblings=(),
            distro="",
            log=None,
        )
    )
    assert (found.code, found.file, found.line) == ("BLD067", file, 2)
    assert found.message == f"demo: {message}"
    assert found.hint is not None
    assert found.hint.startswith(hint)
