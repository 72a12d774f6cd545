"""What a CMakeLists.txt finds of ROS where none is sourced: xacro, and the packages around."""

import os
import sys
from pathlib import Path

import pytest

from building.building import CMAKE, build_here, outside, plain_colcon, write_package
from wsgen.building.toolchain import run_ros2, run_xacro

ROBOT = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">%s</robot>'
FIND_XACRO = CMAKE.replace("install(", "find_package(xacro REQUIRED)\n%s\ninstall(", 1)
LOOK_UP = """
execute_process(
  COMMAND python3 -c "from ament_index_python import get_package_share_directory as find
print(find('demo'), find('base'))"
  OUTPUT_FILE ${CMAKE_CURRENT_SOURCE_DIR}/found.txt
  COMMAND_ERROR_IS_FATAL ANY
)
install("""


def test_ros2_runs_xacro_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(ROBOT % '<link name="${2 * 3}"/>')
    assert run_ros2(["run", "xacro", "xacro", str(file)]) == 0
    assert '<link name="6"/>' in capsys.readouterr().out
    assert run_ros2(["pkg", "list"]) == 1
    assert "ROS is not sourced" in capsys.readouterr().err


def test_sources_are_named_as_they_will_be_installed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("WSGEN_SOURCE_PREFIX", f"/build/sources{os.pathsep}/install/demo")
    file = tmp_path / "robot.xacro"
    file.write_text(ROBOT % '<link name="/build/sources/share"/>')
    assert run_xacro(["-o", str(tmp_path / "new" / "robot.urdf"), str(file)]) == 0
    assert 'name="/install/demo/share"' in (tmp_path / "new" / "robot.urdf").read_text()
    assert capsys.readouterr().out == ""


def test_the_place_of_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.xacro"
    file.write_text(ROBOT % '\n<link name="${size}"/>')
    assert run_xacro([str(file)]) == 2
    assert f"xacro: {file}:2: name 'size' is not defined" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("generator", ["Unix Makefiles", "Ninja"])
def test_a_mistake_in_the_file(generator: str, tmp_path: Path) -> None:
    package = write_package(
        tmp_path,
        cmake=FIND_XACRO % "xacro_add_files(model/robot.urdf.xacro INSTALL DESTINATION urdf)",
    )
    file = package / "model" / "robot.urdf.xacro"
    file.write_text(ROBOT % '\n<link name="${size}"/>')
    environment = {**outside(), "CMAKE_GENERATOR": generator}
    (diagnostic,) = build_here(tmp_path, environment=environment).diagnostics
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == ("ROB071", file, 2)
    assert (diagnostic.element, diagnostic.hint is not None) == ("demo", True)


@pytest.mark.slow
def test_outputs_of_the_commands(tmp_path: Path) -> None:
    commands = """
xacro_add_xacro_file(model/a.xacro)
list(APPEND outputs ${XACRO_OUTPUT_FILE})
xacro_add_xacro_file(${CMAKE_CURRENT_SOURCE_DIR}/model/a.xacro other/b.urdf INORDER OUTPUT MINE)
list(APPEND outputs ${MINE})
add_custom_target(robots ALL DEPENDS ${outputs})
xacro_install(robots ${outputs} DESTINATION made)
xacro_add_files(model/c.urdf.xacro model/d.sdf.xacro REMAP size:=3 INSTALL)
"""
    package = write_package(tmp_path, cmake=FIND_XACRO % commands)
    for name in ("a.xacro", "c.urdf.xacro", "d.sdf.xacro"):
        (package / "model" / name).write_text(
            ROBOT % '<xacro:arg name="size" default="1"/><link name="l$(arg size)"/>'
        )
    assert build_here(tmp_path).diagnostics == ()
    share = tmp_path / "install" / "demo" / "share" / "demo"
    for name, size in (("made/a", 1), ("made/b.urdf", 1), ("c.urdf", 3), ("d.sdf", 3)):
        assert f'<link name="l{size}"/>' in (share / name).read_text()


@pytest.mark.slow
@pytest.mark.parametrize("layout", [(), ("--merge-install",)])
def test_packages_are_found_while_others_are_built(layout: tuple[str, ...], tmp_path: Path) -> None:
    """The package itself by its sources; one that is built, also if it is not declared."""
    package = write_package(tmp_path, cmake=CMAKE.replace("install(", LOOK_UP, 1))
    write_package(tmp_path, "base")
    for _ in range(2):
        assert build_here(tmp_path, colcon_arguments=layout).diagnostics == ()
        own, base = map(Path, (package / "found.txt").read_text().split())
        assert own.resolve() == package
        prefix = tmp_path / "install" if layout else tmp_path / "install" / "base"
        assert base == prefix / "share" / "base"


@pytest.mark.slow
def test_plain_colcon(tmp_path: Path) -> None:
    package = write_package(tmp_path, cmake=CMAKE.replace("install(", LOOK_UP, 1))
    write_package(tmp_path, "base")
    plain_colcon(tmp_path, outside())
    assert (package / "found.txt").read_text().count("/") > 2


@pytest.mark.slow
def test_programs_of_a_build_come_before_others(tmp_path: Path) -> None:
    """The one of the wheel does not know what is built here."""
    write_package(
        tmp_path,
        cmake=CMAKE.replace("install(", "find_program(XACRO xacro REQUIRED)\ninstall(", 1),
    )
    activated = {**outside(), "PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"}
    assert build_here(tmp_path, environment=activated).succeeded
    cache = (tmp_path / "build" / "demo" / "CMakeCache.txt").read_text()
    assert "ros_prefix/bin/xacro" in cache
