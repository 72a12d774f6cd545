"""What becomes of CMakeLists.txt, setup.py and hooks, to the letter."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.fixes.source import SourceText, apply, overlap
from wsgen.porting.build_files import port_cmake, port_hook, port_setup
from wsgen.porting.ported import FilePort

HEAD = """cmake_minimum_required(VERSION 3.8)
project(r)
find_package(ament_cmake REQUIRED)
"""


def ported(
    text: str, folders: tuple[str, ...] = (), file: Path = Path("/nowhere/CMakeLists.txt")
) -> tuple[str, list[str]]:
    """The text afterwards, which a second port leaves as it is, and what is listed."""
    port = port_setup if file.suffix == ".py" else port_cmake
    found = port(SourceText(file, text), folders)
    after = apply(text, found.edits)
    again = port(SourceText(file, after), folders)
    assert apply(after, again.edits) == after
    assert len(again.unported) == len(found.unported)
    return after, [f"{one.line}: {one.what}" for one in found.unported]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        pytest.param(
            "find_package(gazebo_ros REQUIRED)  # the simulator\n"
            "find_package(gazebo_plugins REQUIRED)\n"
            "find_package(gazebo REQUIRED)\n"
            "find_package(gazebo_msgs REQUIRED)\n",
            "find_package(ros_gz_sim REQUIRED)  # the simulator\n",
            id="each once",
        ),
        pytest.param(
            "find_package(gazebo_ros_pkgs)\nament_export_dependencies(gazebo_ros_pkgs rclcpp)\n",
            "find_package(ros_gz)\nament_export_dependencies(ros_gz rclcpp)\n",
            id="what is exported",
        ),
        pytest.param(
            "set(deps\n  rclcpp\n  gazebo_ros  # starts it\n  gazebo_plugins\n  gazebo_dev\n)\n",
            "set(deps\n  rclcpp\n  ros_gz_sim  # starts it\n)\n",
            id="in a list",
        ),
        pytest.param(
            "ament_target_dependencies(n rclcpp gazebo_dev)\n",
            "ament_target_dependencies(n rclcpp)\n",
            id="one of several arguments",
        ),
        pytest.param(
            "include_directories(include ${GAZEBO_INCLUDE_DIRS})\n"
            "link_directories(${GAZEBO_LIBRARY_DIRS})\n"
            'list(APPEND CMAKE_CXX_FLAGS "${GAZEBO_CXX_FLAGS}")\n'
            'set(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS} ${GAZEBO_CXX_FLAGS}")\n'
            'set(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS} ${GAZEBO_CXX_FLAGS} -O2")\n',
            'include_directories(include)\nset(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS} -O2")\n',
            id="variables of Gazebo",
        ),
        pytest.param(
            "find_package(gazebo_ros QUIET)\nif(gazebo_ros_FOUND)\nendif()\n",
            "find_package(ros_gz_sim QUIET)\nif(ros_gz_sim_FOUND)\nendif()\n",
            id="a condition",
        ),
        pytest.param(
            "# find_package(gazebo_ros)\ninstall(DIRECTORY gazebo DESTINATION share/r)\n",
            "# find_package(gazebo_ros)\ninstall(DIRECTORY gazebo DESTINATION share/r)\n",
            id="comments and folders",
        ),
    ],
)
def test_what_is_found(before: str, after: str) -> None:
    assert ported(HEAD + before) == (HEAD + after, [])
    assert ported((HEAD + before).replace("\n", "\r\n"))[0] == (HEAD + after).replace("\n", "\r\n")


def test_a_plugin_of_the_author_is_built_where_classic_is_found(tmp_path: Path) -> None:
    """The rest of the package is built without, too."""
    (tmp_path / "push.cpp").write_text("#include <gazebo/gazebo.hh>\n")
    (tmp_path / "node.cpp").write_text("#include <rclcpp/rclcpp.hpp>\n")
    before = """find_package(gazebo REQUIRED)
find_package(gazebo_ros REQUIRED)
link_directories(${GAZEBO_LIBRARY_DIRS})
add_executable(n node.cpp)
ament_target_dependencies(n rclcpp gazebo_ros)

# It pushes.
add_library(push SHARED push.cpp)
# Against Gazebo:
ament_target_dependencies(push
  gazebo_ros)
ament_export_libraries(push)
install(TARGETS n push
  DESTINATION lib/${PROJECT_NAME})
install(TARGETS push LIBRARY DESTINATION lib)
ament_export_dependencies(gazebo_ros)
"""
    after = """find_package(gazebo QUIET)
find_package(gazebo_ros QUIET)
link_directories(${GAZEBO_LIBRARY_DIRS})
add_executable(n node.cpp)
ament_target_dependencies(n rclcpp)

# It pushes.
if(gazebo_ros_FOUND)
add_library(push SHARED push.cpp)
# Against Gazebo:
ament_target_dependencies(push
  gazebo_ros)
endif()
install(TARGETS n
  DESTINATION lib/${PROJECT_NAME})
if(gazebo_ros_FOUND)
install(TARGETS push
  DESTINATION lib/${PROJECT_NAME})
endif()
if(gazebo_ros_FOUND)
install(TARGETS push LIBRARY DESTINATION lib)
endif()
"""
    source = SourceText(tmp_path / "CMakeLists.txt", HEAD + before)
    found = port_cmake(source)
    assert apply(source.text, found.edits) == HEAD + after
    for place, edit in enumerate(found.edits):  # else one of them would not be made
        assert not overlap([edit], found.edits[:place])
    assert [one.line for one in found.unported] == [11]
    assert port_cmake(SourceText(source.file, HEAD + after)) == FilePort()


def test_headers_of_the_package_that_include_those_of_gazebo(tmp_path: Path) -> None:
    (tmp_path / "include").mkdir()
    (tmp_path / "include" / "push.h").write_text("#include <gazebo/physics/physics.hh>\n")
    (tmp_path / "push.cpp").write_text('#include "push.h"\n')
    text = (
        f"{HEAD}find_package(gazebo)\nadd_library(push SHARED push.cpp)\n"
        "target_link_libraries(push ${GAZEBO_LIBRARIES})\n"
    )
    source = SourceText(tmp_path / "CMakeLists.txt", text)
    found = port_cmake(source)
    after = text.replace("add_library", "if(gazebo_FOUND)\nadd_library") + "endif()\n"
    assert apply(text, found.edits) == after
    assert len(found.unported) == 1


def test_a_node_that_only_names_gazebo_is_no_plugin(tmp_path: Path) -> None:
    """It includes nothing of it, so it compiles without."""
    (tmp_path / "node.cpp").write_text("#include <rclcpp/rclcpp.hpp>\n")
    text = f"{HEAD}add_executable(n node.cpp)\nament_target_dependencies(n rclcpp gazebo_ros)\n"
    assert ported(text, file=tmp_path / "CMakeLists.txt") == (
        text.replace("gazebo_ros", "ros_gz_sim"),
        [],
    )


def test_a_condition_on_gazebo_itself_is_listed() -> None:
    text = f"{HEAD}find_package(gazebo QUIET)\nif(NOT gazebo_FOUND)\n  set(a b)\nendif()\n"
    assert ported(text) == (
        text,
        ["5: CMakeLists.txt depends on `gazebo_FOUND`, which is false without Gazebo Classic."],
    )


@pytest.mark.parametrize(
    ("before", "after"),
    [
        pytest.param(
            "install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})\nament_package()\n",
            "install(DIRECTORY launch config worlds DESTINATION share/${PROJECT_NAME})\n"
            "ament_package()\n",
            id="beside others",
        ),
        pytest.param(
            "ament_package()\n",
            "install(DIRECTORY config DESTINATION share/${PROJECT_NAME})\n"
            "install(DIRECTORY worlds DESTINATION share/${PROJECT_NAME})\n"
            "ament_package()\n",
            id="alone",
        ),
        pytest.param(
            "ament_auto_package(\n  INSTALL_TO_SHARE\n  launch\n  worlds\n)\n",
            "ament_auto_package(\n  INSTALL_TO_SHARE\n  launch\n  worlds\n  config\n)\n",
            id="ament_auto_package",
        ),
        pytest.param(
            "install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/worlds/ ./config DESTINATION s)\n",
            "install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/worlds/ ./config DESTINATION s)\n",
            id="there already",
        ),
    ],
)
def test_new_folders(before: str, after: str) -> None:
    assert ported(HEAD + before, ("worlds", "config")) == (HEAD + after, [])


SETUP = """import os
from setuptools import setup

package_name = 'r'
setup(
    name=package_name,
    data_files=[
        ('share/' + package_name, ['package.xml']),
    ],
)
"""


@pytest.mark.parametrize("with_glob", [False, True])
def test_folders_of_a_python_package(with_glob: bool) -> None:
    before = f"from glob import glob\n{SETUP}" if with_glob else SETUP
    after, _ = ported(before, ("worlds",), file=Path("/nowhere/setup.py"))
    entry = "        ('share/' + package_name + '/worlds', glob('worlds/*')),"
    assert after == f"from glob import glob\n{SETUP}".replace("=[\n", f"=[\n{entry}\n")


def test_a_folder_of_a_python_package_with_folders(tmp_path: Path) -> None:
    """setup() refuses to install a folder as a file."""
    (tmp_path / "worlds" / "room").mkdir(parents=True)
    after, _ = ported(SETUP, ("worlds",), file=tmp_path / "setup.py")
    assert "'/worlds', glob('worlds/*.*'))," in after


def test_a_folder_that_is_installed() -> None:
    text = SETUP.replace("['package.xml']", "['worlds/a.world']")
    assert ported(text, ("worlds",), file=Path("/nowhere/setup.py"))[0] == text


def test_hooks() -> None:
    text = (
        "prepend-non-duplicate;GAZEBO_MODEL_PATH;share/r/models\n"
        "prepend-non-duplicate;GAZEBO_RESOURCE_PATH;share/r/models\n"
        "prepend-non-duplicate;GAZEBO_PLUGIN_PATH;lib\n"
        "\n"
        "prepend-non-duplicate;GZ_SIM_SYSTEM_PLUGIN_PATH;lib\n"
    )
    source = SourceText(Path("/nowhere/r.dsv.in"), text)
    after = apply(text, port_hook(source).edits)
    assert after == (
        "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;share/r/models\n"
        "\n"
        "prepend-non-duplicate;GZ_SIM_SYSTEM_PLUGIN_PATH;lib\n"
    )
    assert port_hook(SourceText(source.file, after)).edits == ()


def test_a_hook_does_without_the_question_for_gazebo_classic() -> None:
    text = """\
# Of Gazebo
SETUP="/usr/share/gazebo/setup.bash"
OWN=/usr/share/other
if test -f "$SETUP"; then
    source $SETUP
    # Our models
    if test -d "$OWN"; then
        ament_prepend_unique_value GAZEBO_MODEL_PATH "$OWN"
    fi
    ament_prepend_unique_value GAZEBO_MODEL_PATH "$PREFIX/models"
fi

if [ -d /usr/share/ignition ]
then
    ament_prepend_unique_value IGN_GAZEBO_RESOURCE_PATH "$PREFIX/models"
fi
if test -d /usr/share/ignition; then
    ament_prepend_unique_value IGN_GAZEBO_RESOURCE_PATH "$PREFIX/models"
fi
"""
    source = SourceText(Path("hook.sh"), text)
    port = port_hook(source)
    after = apply(text, port.edits)
    assert (
        after
        == """\
# Of Gazebo
OWN=/usr/share/other
# Our models
if test -d "$OWN"; then
    ament_prepend_unique_value GZ_SIM_RESOURCE_PATH "$OWN"
fi
ament_prepend_unique_value GZ_SIM_RESOURCE_PATH "$PREFIX/models"

if [ -d /usr/share/ignition ]
then
    ament_prepend_unique_value GZ_SIM_RESOURCE_PATH "$PREFIX/models"
fi
"""
    )
    assert [one.line for one in port.unported] == [13]
    assert port_hook(SourceText(source.file, after)).edits == ()


def test_a_hook_that_asks_for_gazebo_classic_and_more_is_listed() -> None:
    text = """\
if test -f /usr/share/gazebo/setup.bash && test -d /opt/own; then
    ament_prepend_unique_value GAZEBO_MODEL_PATH "$PREFIX/models"
fi
if test -d /usr/share/ignition; then
    ament_prepend_unique_value IGN_GAZEBO_RESOURCE_PATH "$PREFIX/models"
else
    echo none
fi
"""
    source = SourceText(Path("hook.sh"), text)
    port = port_hook(source)
    source = SourceText(Path("hook.sh"), text)
    port = port_hook(source)
    # None of the branches may become empty.
    assert (
        apply(text, port.edits).count('    ament_prepend_unique_value GZ_SIM_RESOURCE_PATH "$') == 2
    )
    assert [one.line for one in port.unported] == [1, 4]


def test_a_new_folder_is_installed_beside_one_that_is_not_there() -> None:
    text = """\
install(
  DIRECTORY urdf world
  DESTINATION share/${PROJECT_NAME}
)
ament_package()
"""
    source = SourceText(Path("/nowhere/CMakeLists.txt"), text)
    after = apply(text, port_cmake(source, ["worlds"]).edits)
    assert after == text.replace("urdf world", "urdf world worlds")


@pytest.mark.parametrize("more", ["", "else()\n  message(STATUS here)\n"])
def test_a_package_that_is_left_out_without_gazebo_classic_is_built(more: str) -> None:
    question = f"""# Skip
find_package(gazebo QUIET)
if(NOT gazebo_FOUND)
  message(WARNING "none")
  return()
{more}endif()
"""
    text = f"project(r)\n{question}install(DIRECTORY urdf)\nament_package()\n"
    source = SourceText(Path("/nowhere/CMakeLists.txt"), text)
    port = port_cmake(source)
    assert (apply(text, port.edits) == text) == bool(more)
    assert ("NOT gazebo_FOUND" in apply(text, port.edits)) == bool(more)
    assert len(port.unported) == bool(more)
