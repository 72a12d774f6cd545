"""What is wrong in a CMakeLists.txt: each rule in a bad and in a good case."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.diagnostics import Severity
from wsgen.packages.build_files.cmake_checks import check_for_distro
from wsgen.packages.build_files.facts import read_build_facts
from wsgen.packages.build_files.install_checks import is_misplaced

START = "cmake_minimum_required(VERSION 3.8)\nproject(bot)\nfind_package(ament_cmake REQUIRED)\n"
INSTALL = "install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})\n"
END = "ament_package()\n"
FILES = ("launch/a.launch.py", "urdf/b.urdf", "src/node.cpp", "package.xml")
PROGRAM = "#!/usr/bin/env python3\nimport rclpy\nif __name__ == '__main__':\n    print()\n"


def report(folder: Path, text: str, **files: str) -> list[tuple[str, int | None, str]]:
    """Name, line and severity of what is reported about a package `bot`."""
    for name in FILES:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    for name, content in files.items():
        file = folder / name.replace("__", "/").replace("_py", ".py")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content)
        file.chmod(0o755)
    (folder / "CMakeLists.txt").write_text(text)
    found = read_build_facts(folder, "bot", "ament_cmake")[1]
    for one in found:
        assert one.hint
        assert one.file is not None
    return [(one.name, one.line, one.severity.value) for one in found]


def test_a_sound_package(tmp_path: Path) -> None:
    text = START + "find_package(rclcpp REQUIRED)\nadd_executable(node src/node.cpp)\n"
    text += "ament_target_dependencies(node rclcpp)\n"
    text += INSTALL + "install(TARGETS node DESTINATION lib/${PROJECT_NAME})\n"
    text += "install(PROGRAMS scripts/go.py DESTINATION lib/${PROJECT_NAME})\n"
    text += "if(BUILD_TESTING)\n  find_package(ament_lint_auto REQUIRED)\n"
    text += "  ament_lint_auto_find_test_dependencies()\nendif()\n"
    assert report(tmp_path, text + END, scripts__go_py=PROGRAM) == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (START + INSTALL + 'message("open)\n' + END, ("cmake-syntax", 5, "error")),
        (START + INSTALL + "if(BUILD_TESTING)\n" + END, ("cmake-syntax", 5, "error")),
        (START + INSTALL + "endif()\n" + END, ("cmake-syntax", 5, "error")),
        (START + "install(DIRECTORY launch urdf\n" + END, ("cmake-syntax", 4, "error")),
        (START.replace("project(bot)\n", "") + INSTALL + END, ("missing-project", 1, "error")),
        (START.replace("(bot)", "(bots)") + INSTALL + END, ("different-names", 2, "error")),
        (START + INSTALL, ("missing-ament-package", 4, "error")),
        (START + INSTALL + END + END, ("repeated-ament-package", 6, "error")),
        (START + INSTALL + END + "ament_export_dependencies(rclcpp)\n",
         ("command-after-ament-package", 6, "error")),
        (START + INSTALL + END + "rosidl_generate_interfaces(bot ${interfaces})\n",
         ("command-after-ament-package", 6, "error")),
        (START + INSTALL + "add_library(part SHARED src/node.cpp)\n" + END
         + 'rclcpp_components_register_nodes(part "bot::Part")\n',
         ("registered-after-ament-package", 7, "warning")),
        (START.partition("\n")[2] + INSTALL + END, ("missing-cmake-minimum", 1, "warning")),
        (START.replace("3.8", "2.8") + INSTALL + END, ("old-cmake-minimum", 1, "warning")),
        (START + INSTALL + "ament_pakage()\n" + END, ("unknown-command", 5, "error")),
        (START.replace("find_package(ament_cmake REQUIRED)\n", "") + INSTALL + END,
         ("unknown-command", 4, "error")),
        (START.replace("find_package(ament_cmake REQUIRED)",
                       "if(BUILD_TESTING)\n  find_package(ament_cmake_pytest QUIET)\nendif()")
         + INSTALL + END, ("unknown-command", 7, "error")),
        (START + INSTALL.replace("}", "") + END, ("cmake-syntax", 4, "error")),
        (START + INSTALL.replace("DESTINATION", "DESTNATION") + END,
         ("misspelled-keyword", 4, "error")),
        (START + INSTALL + "find_package(rclcpp REQURIED)\n" + END,
         ("misspelled-keyword", 5, "error")),
        (START + INSTALL + "add_library(part SHRAED src/node.cpp)\n" + END,
         ("misspelled-keyword", 5, "error")),
        (START + INSTALL + "find_package(ament_lint_auto REQUIRED)\n" + END,
         ("test-package-required", 5, "warning")),
        (START + INSTALL + "add_subdirectory(drivers)\n" + END,
         ("missing-subdirectory", 5, "error")),
        (START + INSTALL + "add_library(part node.cpp)\n" + END, ("missing-source", 5, "error")),
        (START + INSTALL.replace("DESTINATION", ")#") + END, ("missing-destination", 4, "error")),
        (START + INSTALL.replace("urdf", "urdf\n  meshs") + END,
         ("missing-installed-path", 5, "error")),
        (START + INSTALL + "install(FILES launch DESTINATION share/bot)\n" + END,
         ("wrong-kind-of-path", 5, "error")),
        (START + INSTALL.replace("urdf", "") + END, ("folder-not-installed", 4, "info")),
        (START + INSTALL.replace("launch", "") + END, ("folder-not-installed", 4, "warning")),
        (START + INSTALL.replace("$", "") + END, ("wrong-destination", 4, "warning")),
        (START + INSTALL.replace("PROJECT_NAME", "PROJECT_NAM") + END,
         ("wrong-destination", 4, "warning")),
        (START + INSTALL.replace("share/", "") + END, ("wrong-destination", 4, "warning")),
        (START + INSTALL.replace("/${PROJECT_NAME}", "") + END,
         ("wrong-destination", 4, "warning")),
        (START + INSTALL.replace("DESTINATION share/${PROJECT_NAME}", "TYPE DATA") + END,
         ("wrong-destination", 4, "warning")),
        (START + INSTALL.replace("launch urdf", "launch/ urdf/") + END,
         ("contents-installed", 4, "warning")),
        (START + INSTALL + "install(DIRECTORY launch DESTINATION share/bot/launch)\n" + END,
         ("repeated-folder", 5, "warning")),
        (START + INSTALL + "add_executable(node src/node.cpp)\n" + END,
         ("program-not-installed", 5, "warning")),
        (START + INSTALL + "add_executable(node src/node.cpp)\n"
         "install(TARGETS node DESTINATION lib/bots)\n" + END,
         ("program-not-installed", 6, "warning")),
        (START + INSTALL.replace("share/", "lib/") + END, ("wrong-destination", 4, "warning")),
        (START + INSTALL.replace("DIRECTORY", "DIRECTORYS") + END, ("unknown-command", 4, "error")),
    ],
)  # fmt: skip
def test_mistakes(tmp_path: Path, text: str, expected: tuple[str, int, str]) -> None:
    assert report(tmp_path, text) == [expected]


def test_folders_with_a_comma_between_them(tmp_path: Path) -> None:
    report(tmp_path, START + INSTALL.replace("launch urdf", "launch, urdf") + END)
    found = read_build_facts(tmp_path, "bot", "ament_cmake")[1]
    assert [one.hint for one in found if one.name == "missing-installed-path"] == [
        "Did you mean `launch`? CMake separates arguments by blanks alone."
    ]


def test_names_that_are_no_keywords(tmp_path: Path) -> None:
    text = START + "find_package(Boost COMPONENTS SYSTEM REQUIRED)\n" + INSTALL
    text += "install(FILES OPTIONL DESTINATION share/${PROJECT_NAME})\n" + END
    assert report(tmp_path, text, OPTIONL="a file") == []


@pytest.mark.parametrize(
    ("written", "kind", "there"),
    [
        ("FILES a.urdf", "file", "urdf/a.urdf"),
        ("FILES config/b.yaml", "file", "param/b.yaml"),
        ("PROGRAMS patrol.py", "file", "scripts/patrol.py"),
        ("DIRECTORY meshes", "folder", "model/meshes"),
    ],
)
def test_what_is_elsewhere_in_the_package(
    tmp_path: Path, written: str, kind: str, there: str
) -> None:
    file = tmp_path / there / ("x.stl" if kind == "folder" else "")
    file.parent.mkdir(parents=True)
    file.write_text(PROGRAM)
    text = f"{START}install({written} DESTINATION share/bot)\n{END}"
    (tmp_path / "CMakeLists.txt").write_text(text)
    found = read_build_facts(tmp_path, "bot", "ament_cmake")[1]
    (missing,) = [one for one in found if one.name == "missing-installed-path"]
    name = written.partition(" ")[2]
    assert missing.message == (
        f"bot: install() names the {kind} {name}, which does not exist; {there} does."
    )
    assert missing.hint == f"Did you mean `{there}`?"


def test_install_after_ament_package_works(tmp_path: Path) -> None:
    assert report(tmp_path, START + END + INSTALL) == []


@pytest.mark.parametrize(
    "text",
    [
        "if(WITH_MORE)\n  install(DIRECTORY gone DESTINATION share/bot)\nendif()",
        "install(DIRECTORY gone DESTINATION share/bot OPTIONAL)",
        ("if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/gone)\n"
        "  install(DIRECTORY gone DESTINATION share/bot)\nendif()"),
        ("file(MAKE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/made)\n"
        "install(DIRECTORY made DESTINATION share/bot)"),
        "configure_file(src/node.cpp src/made.cpp)\nadd_library(part src/made.cpp)",
        "add_custom_command(OUTPUT made.cpp COMMAND make_it)\nadd_library(part made.cpp)",
        ("add_executable(maker src/node.cpp)\n"
        "add_custom_command(OUTPUT made.h COMMAND maker)"),
        "if(BUILD_TESTING)\n  add_executable(checker src/node.cpp)\nendif()",
        "add_executable(node_test src/node.cpp)",
        "nav2_package()\nmy_own_command(urdf)",
        "rosidl_generate_dds_interfaces(${PROJECT_NAME}__idl)",
        "install(DIRECTORY launch/ DESTINATION share/${PROJECT_NAME}/launch)",
        "install(DIRECTORY include/ DESTINATION include OPTIONAL)",
        "if(ament_cmake_FOUND)\n  return()\nendif()",
    ],
)  # fmt: skip
def test_what_may_be_right_is_not_reported(tmp_path: Path, text: str) -> None:
    assert report(tmp_path, f"{START}{INSTALL}{text}\n{END}") == []


@pytest.mark.parametrize(
    ("line", "script", "expected"),
    [
        ("install(PROGRAMS go.py", PROGRAM.partition("\n")[2], ("broken-shebang", 1, "error")),
        ("install(PROGRAMS go.py", PROGRAM.replace("\n", "\r\n"), ("broken-shebang", 1, "error")),
        ("install(PROGRAMS go.py", PROGRAM.replace("python3", "python"),
         ("broken-shebang", 1, "warning")),
        ("install(FILES go.py", PROGRAM, ("program-not-executable", 5, "warning")),
        ("install(PROGRAMS go.py", "VALUE = 1\n", None),
        ("install(PROGRAMS go.py", PROGRAM, None),
        ("install(FILES go.py PERMISSIONS OWNER_READ OWNER_EXECUTE", PROGRAM, None),
    ],
)  # fmt: skip
def test_scripts(
    tmp_path: Path, line: str, script: str, expected: tuple[str, int, str] | None
) -> None:
    text = f"{START}{INSTALL}{line} DESTINATION lib/bot)\n{END}"
    file = tmp_path / "go.py"
    file.write_bytes(script.encode())
    file.chmod(0o755)
    assert report(tmp_path, text) == ([expected] if expected else [])


@pytest.mark.parametrize(
    ("install", "code"),
    [
        ("install(PROGRAMS go.py DESTINATION share/${PROJECT_NAME})\n", "program-not-installed"),
        ("install(PROGRAMS go.py DESTINATION lib)\n", "program-not-installed"),
        ("install(PROGRAMS go.py DESTINATION share/${PROJECT_NAME}/scripts)\n", None),
        (
            (
                "install(PROGRAMS go.py DESTINATION lib/bot)\n"
                "install(PROGRAMS go.py DESTINATION share/bot)\n"
            ),
            None,
        ),
        (INSTALL.replace("share/", "lib/"), None),
    ],
)
def test_what_is_installed_for_others_than_ros(
    tmp_path: Path, install: str, code: str | None
) -> None:
    found = report(tmp_path, f"{START}{INSTALL}{install}{END}", go_py=PROGRAM)
    assert [one[0] for one in found] == ([code] if code else [])


def test_a_package_with_the_name_of_a_folder_of_resources() -> None:
    assert not is_misplaced("share/description", "description")
    assert is_misplaced("share/description", "bot")


def test_a_folder_of_scripts(tmp_path: Path) -> None:
    text = f"{START}{INSTALL}install(DIRECTORY scripts DESTINATION lib/${{PROJECT_NAME}})\n{END}"
    found = report(tmp_path, text, scripts__go_py=PROGRAM)
    assert found == [("program-not-executable", 5, "warning")]


def test_a_script_that_links_cannot_run(tmp_path: Path) -> None:
    text = f"{START}{INSTALL}install(PROGRAMS go.py DESTINATION lib/bot)\n{END}"
    (tmp_path / "go.py").write_text(PROGRAM)
    assert report(tmp_path, text) == [("linked-script-not-executable", 5, "info")]


def test_an_empty_folder(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    text = START + INSTALL.replace("urdf", "urdf meshes") + END
    assert report(tmp_path, text) == [("empty-installed-folder", 4, "warning")]


def test_a_folder_that_a_file_names_is_missed(tmp_path: Path) -> None:
    text = START + INSTALL.replace("urdf", "") + END
    found = report(tmp_path, text, launch__a_launch_py="path = share + '/urdf/b.urdf'\n")
    assert found == [("folder-not-installed", 4, "warning")]


def test_no_build_file(tmp_path: Path) -> None:
    (tmp_path / "package.xml").touch()
    (tmp_path / "setup.py").touch()
    _, (found,) = read_build_facts(tmp_path, "bot", "ament_cmake")
    assert found.name == "missing-build-file"
    assert "<build_type>ament_python</build_type>" in (found.hint or "")


def test_a_command_that_the_distribution_lacks() -> None:
    calls = {"ament_target_dependencies": ((Path("CMakeLists.txt"), 7), (Path("other"), 9))}
    (found,) = check_for_distro(calls, "lyrical")
    assert (found.name, found.line, found.severity) == ("removed-command", 7, Severity.ERROR)
    assert [one.severity for one in check_for_distro(calls, "kilted")] == [Severity.WARNING]
    assert list(check_for_distro(calls, "jazzy")) == []
    assert list(check_for_distro(calls, None)) == []
