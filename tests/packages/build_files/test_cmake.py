"""CMakeLists.txt is read as CMake is written."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.packages.build_files.cmake_text import parse
from wsgen.packages.build_files.facts import read_build_facts

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.model.build_facts import BuildFacts

START = "cmake_minimum_required(VERSION 3.8)\nproject(bot)\nfind_package(ament_cmake REQUIRED)\n"


def read(folder: Path, text: str, files: Iterable[str] = ()) -> BuildFacts:
    """The facts of a package `bot` with these files, and commands between the usual ones."""
    for name in ("launch/a.launch.py", "urdf/b.urdf", *files):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    (folder / "CMakeLists.txt").write_text(f"{START}{text}\nament_package()\n")
    return read_build_facts(folder, "bot", "ament_cmake")[0]


def shared(facts: BuildFacts) -> list[str]:
    return sorted(name for name in facts.shared("bot") if name != "package.xml")


BOTH = ["launch/a.launch.py", "urdf/b.urdf"]


@pytest.mark.parametrize(
    "text",
    [
        "install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})",
        "INSTALL(\n  DIRECTORY launch # no urdf)\n  urdf\n  DESTINATION share/${PROJECT_NAME}/)",
        'install(DIRECTORY "launch" "urdf" DESTINATION "share/${PROJECT_NAME}")',
        "#[[ install( ]] install(DIRECTORY launch urdf DESTINATION share/bot) #[==[ ]] ]==]",
        (
            "set(dirs launch)\nlist(APPEND dirs urdf)\n"
            "install(DIRECTORY ${dirs} DESTINATION share/${PROJECT_NAME})"
        ),
        (
            "foreach(dir launch urdf)\n"
            "  install(DIRECTORY ${dir}/ DESTINATION share/${PROJECT_NAME}/${dir})\nendforeach()"
        ),
        (
            "foreach(dir IN ITEMS launch urdf)\n  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${dir})\n"
            "    install(DIRECTORY ${dir} DESTINATION share/bot)\n  endif()\nendforeach()"
        ),
        (
            "function(share)\n  foreach(one ${ARGN})\n"
            "    install(DIRECTORY ${one} DESTINATION share/bot)\n"
            "  endforeach()\nendfunction()\nshare(launch urdf)"
        ),
        (
            "file(GLOB found launch/* RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} urdf/*)\n"
            "foreach(one ${found})\n  get_filename_component(dir ${one} DIRECTORY)\n"
            "  install(FILES ${one} DESTINATION share/bot/${dir})\nendforeach()"
        ),
        (
            "install(DIRECTORY launch urdf TYPE DATA)\n"
            "install(DIRECTORY launch urdf DESTINATION share/bot)"
        ),
        "set(CMAKE_INSTALL_DATADIR share/bot)\ninstall(DIRECTORY launch urdf TYPE DATA)",
        (
            "install(DIRECTORY . DESTINATION share/bot PATTERN package.xml EXCLUDE "
            "PATTERN CMakeLists.txt EXCLUDE)"
        ),
        (
            "install(FILES launch/a.launch.py\n"
            "  DESTINATION ${CMAKE_INSTALL_PREFIX}/share/bot/launch)\n"
            "install(FILES urdf/x.urdf OPTIONAL DESTINATION share/bot/urdf)\n"
            "install(FILES urdf/b.urdf DESTINATION share/bot/urdf RENAME b.urdf)"
        ),
        (
            "if(WIN32 OR (APPLE AND NOT UNIX))\nelse()\n"
            "install(DIRECTORY launch urdf DESTINATION share/bot)\nendif()"
        ),
        (
            "if($ENV{ROS_DISTRO} STREQUAL humble)\n"
            "install(DIRECTORY launch urdf DESTINATION share/bot)\nendif()"
        ),
        "ament_auto_package(INSTALL_TO_SHARE launch urdf)\nreturn()",
    ],
)
def test_installed(tmp_path: Path, text: str) -> None:
    assert shared(read(tmp_path, text)) == BOTH


def test_patterns(tmp_path: Path) -> None:
    text = 'install(DIRECTORY urdf DESTINATION share/bot FILES_MATCHING PATTERN "*.xacro" '
    text += 'PATTERN "old" EXCLUDE REGEX "/x[0-9]+\\\\.dae$")'
    files = ["urdf/a.xacro", "urdf/old/a.xacro", "urdf/x1.dae", "urdf/y.dae", "urdf/c/d.xacro"]
    assert shared(read(tmp_path, text, files)) == ["urdf/a.xacro", "urdf/c/d.xacro", "urdf/x1.dae"]


def test_where_things_come_from(tmp_path: Path) -> None:
    text = "install(DIRECTORY\n  launch/\n  DESTINATION share/bot/start)\n"
    text += "install(PROGRAMS scripts/go.py DESTINATION lib/${PROJECT_NAME} RENAME go)\n"
    text += "add_executable(node src/node.cpp)\ninstall(TARGETS node DESTINATION lib/bot)"
    facts = read(tmp_path, text, ["scripts/go.py"])
    (file,) = (one for one in facts.installed if one.destination.startswith("share/bot/start"))
    assert (file.source, file.line) == (tmp_path / "launch/a.launch.py", 5)
    assert [(one.name, one.source) for one in facts.executables] == [
        ("go", tmp_path / "scripts/go.py"),
        ("node", None),
    ]
    assert facts.is_whole
    assert facts.folders == {"share/bot/start": tmp_path / "launch"}


def test_required_packages(tmp_path: Path) -> None:
    text = "foreach(one rclcpp std_msgs)\n  find_package(${one} REQUIRED)\nendforeach()\n"
    text += "find_package(gz QUIET)\nif(BUILD_TESTING)\n  find_package(ament_lint_auto REQUIRED)\n"
    text += "endif()"
    found = read(tmp_path, text).required_packages
    assert [(one.name, one.line, one.required, one.in_tests) for one in found] == [
        ("ament_cmake", 3, True, False),
        ("rclcpp", 5, True, False),
        ("std_msgs", 5, True, False),
        ("gz", 7, False, False),
        ("ament_lint_auto", 9, True, True),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "install(DIRECTORY ${FOLDERS} DESTINATION share/bot)",
        "install(CODE [[message(hello)]])",
        "install_all_of_it(launch)",
        "include(${somewhere}/more.cmake)",
    ],
)
def test_what_cannot_be_known_is_not_whole(tmp_path: Path, text: str) -> None:
    assert not read(tmp_path, text).is_whole


def test_a_subdirectory(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "CMakeLists.txt").write_text(
        "set(place ${place}/models PARENT_SCOPE)\n"
        "install(FILES robot.sdf DESTINATION share/${PROJECT_NAME}/models)\n"
    )
    text = "set(place share/bot)\nadd_subdirectory(models)\n"
    text += "install(DIRECTORY launch DESTINATION ${place})"
    facts = read(tmp_path, text, ["models/robot.sdf"])
    assert shared(facts) == ["models/launch/a.launch.py", "models/robot.sdf"]
    (file,) = (one for one in facts.installed if one.destination.endswith(".sdf"))
    assert file.file == tmp_path / "models" / "CMakeLists.txt"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a()\nb(", 2, "not closed"),
        ("a()\n)", 2, "not match an opening one"),
        ('a("b)\nc()', 1, "quotation mark"),
        ("a()\nlaunch\nb()", 2, "not followed by"),
        ("a()\n// no comment\nb()", 2, "not a command"),
    ],
)
def test_mistakes_of_syntax(text: str, line: int, words: str) -> None:
    mistake = parse(text)[1]
    assert mistake is not None
    assert mistake.line == line
    assert words in mistake.message


@pytest.mark.parametrize(
    "text",
    [
        "if(A)\n" * 3000 + "endif()\n" * 3000,
        "set(A " + "${" * 3000 + "}" * 3000 + ")",
        "if(" + "(" * 3000 + "A" + ")" * 3000 + ")\nendif()",
    ],
    ids=["blocks", "references", "parentheses"],
)
def test_what_is_nested_too_deeply_is_not_known(tmp_path: Path, text: str) -> None:
    (tmp_path / "CMakeLists.txt").write_text(f"project(arm)\n{text}\n")
    facts, reported = read_build_facts(tmp_path, "arm", "ament_cmake")
    assert not facts.is_whole
    assert "BLD010" not in {found.code for found in reported}


def test_a_variable_that_doubles_itself_is_not_known(tmp_path: Path) -> None:
    text = "project(arm)\nset(A word)\n" + 'set(A "${A}${A}")\n' * 60
    (tmp_path / "CMakeLists.txt").write_text(f"{text}install(FILES ${{A}} DESTINATION share/arm)")
    facts, _ = read_build_facts(tmp_path, "arm", "ament_cmake")
    assert not facts.is_whole


def test_a_device_is_no_build_file(tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").symlink_to("/dev/zero")
    facts, reported = read_build_facts(tmp_path, "arm", "ament_cmake")
    assert [found.code for found in reported] == ["BLD021"]
    assert not facts.is_whole


def test_an_endless_loop_ends(tmp_path: Path) -> None:
    facts = read(tmp_path, "macro(again)\n  again()\nendmacro()\nagain()")
    assert not facts.is_whole


@pytest.mark.parametrize(
    "call",
    [
        "xacro_add_files(TARGET b urdf/b.urdf.xacro INSTALL DESTINATION urdf)",
        "xacro_add_files(urdf/b.urdf.xacro INORDER INSTALL DESTINATION urdf TARGET b)",
        "xacro_add_files(urdf/a.xacro REMAP x:=y OUTPUT b.urdf INSTALL DESTINATION urdf TARGET b)",
    ],
)
def test_what_the_build_makes(tmp_path: Path, call: str) -> None:
    facts = read(tmp_path, call)
    found = facts.shared("bot")["urdf/b.urdf"]
    assert found.source is None


def test_hooks(tmp_path: Path) -> None:
    (tmp_path / "env").mkdir()
    (tmp_path / "env/bot.dsv.in").write_text(
        "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;share/@PROJECT_NAME@/models\n"
    )
    (tmp_path / "env/bot.sh").write_text(
        'ament_prepend_unique_value GAZEBO_MODEL_PATH "$AMENT_CURRENT_PREFIX/share/bot"\n'
    )
    facts = read(tmp_path, "ament_environment_hooks(env/bot.dsv.in env/bot.sh)")
    assert facts.environment == (
        ("GZ_SIM_RESOURCE_PATH", "share/bot/models"),
        ("GAZEBO_MODEL_PATH", "share/bot"),
    )


@pytest.mark.parametrize(
    ("text", "destinations"),
    [
        # cmake-install(1), "TYPE": the documentation has a folder of the project's own.
        ("install(FILES urdf/b.urdf TYPE DOC)", ["share/doc/bot/b.urdf"]),
        ("install(FILES urdf/b.urdf TYPE MAN)", ["share/man/b.urdf"]),
        ("set(CMAKE_INSTALL_DOCDIR d)\ninstall(FILES urdf/b.urdf TYPE DOC)", ["d/b.urdf"]),
        (
            (
                "add_library(l STATIC l.cpp)\ninstall(TARGETS l ARCHIVE DESTINATION lib/a\n"
                "LIBRARY DESTINATION lib/b)"
            ),
            ["lib/a/libl.a"],
        ),
        (
            (
                "add_library(l SHARED l.cpp)\ninstall(TARGETS l ARCHIVE DESTINATION lib/a\n"
                "LIBRARY DESTINATION lib/b)"
            ),
            ["lib/b/libl.so"],
        ),
        # The first slash is one of the path that stays, not of a folder from the root.
        (
            "pluginlib_export_plugin_description_file(rviz_common urdf/b.urdf)",
            ["share/bot/urdf/b.urdf"],
        ),
        (
            "rosidl_generate_interfaces(bot msg/A.msg srv/B.srv action/C.action)",
            ["share/bot/action/C.action", "share/bot/msg/A.msg", "share/bot/srv/B.srv"],
        ),
        ("ament_auto_add_executable(n n.cpp)\nament_auto_package()", ["lib/bot/n"]),
        ("ament_auto_add_executable(n n.cpp)\nament_auto_package(INSTALL_TO_PATH)", ["bin/n"]),
        (
            "if(BUILD_TESTING)\nament_auto_add_executable(n n.cpp)\nendif()\nament_auto_package()",
            [],
        ),
        (
            (
                "set(a share/x)\nset(a share/y CACHE STRING why FORCE)\n"
                "install(FILES urdf/b.urdf DESTINATION ${a})"
            ),
            ["share/y/b.urdf"],
        ),
        # The longest extension goes, whereas NAME_WLE takes the last one.
        (
            (
                "get_filename_component(a x/a.b.c NAME_WE)\n"
                "get_filename_component(b x/a.b.c NAME_WLE)\n"
                "install(FILES urdf/b.urdf DESTINATION share/${a}/${b})"
            ),
            ["share/a/a.b/b.urdf"],
        ),
        # What is off by default may be on: both of its branches count.
        (
            "option(a b OFF)\nif(a)\ninstall(FILES urdf/b.urdf DESTINATION share/x)\nendif()",
            ["share/x/b.urdf"],
        ),
        (
            "set(a urdf-NOTFOUND)\nif(a)\ninstall(FILES urdf/b.urdf DESTINATION share/x)\nendif()",
            [],
        ),
        (
            (
                "if(3.8 VERSION_LESS 3.8.0)\ninstall(FILES urdf/b.urdf DESTINATION x)\nendif()\n"
                "if(3.8 VERSION_EQUAL 3.8.0)\ninstall(FILES urdf/b.urdf DESTINATION y)\nendif()"
            ),
            ["y/b.urdf"],
        ),
    ],
)
def test_destinations(tmp_path: Path, text: str, destinations: list[str]) -> None:
    files = ("msg/A.msg", "srv/B.srv", "action/C.action")
    found = {one.destination for one in read(tmp_path, text, files).installed}
    of_all = {"share/bot/package.xml", "share/ament_index/resource_index/packages/bot"}
    assert sorted(found - of_all) == destinations


@pytest.mark.parametrize(
    ("call", "programs"),
    [
        ("install(PROGRAMS a.py DESTINATION lib/bot)", ["a.py"]),
        ("install(FILES a.py DESTINATION lib/bot)", []),
        ("install(PROGRAMS a.py DESTINATION lib/bot PERMISSIONS OWNER_READ)", []),
        ("install(FILES a.py DESTINATION lib/bot PERMISSIONS OWNER_READ OWNER_EXECUTE)", ["a.py"]),
        ("add_executable(n n.cpp)\ninstall(TARGETS n DESTINATION lib/bot)", ["n"]),
        ("add_library(n SHARED n.cpp)\ninstall(TARGETS n DESTINATION lib/bot)", []),
    ],
)
def test_what_can_be_run(tmp_path: Path, call: str, programs: list[str]) -> None:
    assert [one.name for one in read(tmp_path, call, ["a.py"]).executables] == programs


@pytest.mark.parametrize("word", ["OPTIONAL", "CONFIGURATIONS Debug"])
def test_a_path_that_need_not_exist(tmp_path: Path, word: str) -> None:
    text = f"{START}install(FILES none.txt DESTINATION share/bot {word})\nament_package()\n"
    (tmp_path / "CMakeLists.txt").write_text(text)
    assert read_build_facts(tmp_path, "bot", "ament_cmake")[1] == ()
    (tmp_path / "CMakeLists.txt").write_text(text.replace(word, ""))
    (found,) = read_build_facts(tmp_path, "bot", "ament_cmake")[1]
    assert found.element == "bot"
    assert "none.txt" in found.message


def test_a_target_that_is_not_known_is_installed_elsewhere_without_a_word(tmp_path: Path) -> None:
    """A command of another package may have made it, of a kind that has another place."""
    text = f"{START}{{}}install(TARGETS n DESTINATION lib)\nament_package()\n"
    (tmp_path / "CMakeLists.txt").write_text(text.format("add_executable(n n.cpp)\n"))
    (tmp_path / "n.cpp").touch()
    assert [one.name for one in read_build_facts(tmp_path, "bot", "ament_cmake")[1]] == [
        "program-not-installed"
    ]
    (tmp_path / "CMakeLists.txt").write_text(text.format(""))
    assert read_build_facts(tmp_path, "bot", "ament_cmake")[1] == ()


def test_what_a_mapping_of_xacro_names_is_no_file(tmp_path: Path) -> None:
    """All words after REMAP, up to the next keyword, are mappings."""
    facts = read(tmp_path, "xacro_add_files(a.xacro REMAP x:=y z:=w INSTALL TARGET b)")
    assert shared(facts) == ["a"]


def test_hooks_whose_places_are_not_known(tmp_path: Path) -> None:
    (tmp_path / "bot.dsv.in").write_text(
        "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;@SOMEWHERE@/models\n"
        "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;/opt/models\n"
        "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;${CMAKE_PREFIX}/models\n"
        "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;share/models\n"
    )
    facts = read(tmp_path, "ament_environment_hooks(bot.dsv.in)")
    assert facts.environment == (("GZ_SIM_RESOURCE_PATH", "share/models"),)
