"""Which packages are laid out to check one of them."""

from pathlib import Path

import pytest

from wsgen.packages.workspace.layout import PackageFolder
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.installed_as_built import SIZE_LIMIT, find_reached

MANIFEST = """\
<package format="3"><name>{}</name><version>0.0.1</version><description>Parts.</description>
<maintainer email="ada@example.org">Ada</maintainer><license>Apache-2.0</license>
<buildtool_depend>ament_cmake</buildtool_depend>
<export><build_type>ament_cmake</build_type></export></package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project({} NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY launch DESTINATION share/${{PROJECT_NAME}})
ament_package()
"""


@pytest.fixture
def packages(tmp_path: Path) -> dict[str, PackageFolder]:
    for name in ("cart", "cart_description", "arm", "arm_meshes", "worlds"):
        (tmp_path / "src" / name / "launch").mkdir(parents=True)
        (tmp_path / "src" / name / "package.xml").write_text(MANIFEST.format(name))
        (tmp_path / "src" / name / "CMakeLists.txt").write_text(CMAKE.format(name))
    return {
        folder.name: PackageFolder(path=folder, name=folder.name, build_type="ament_cmake")
        for folder in (tmp_path / "src").iterdir()
    }


def test_what_files_name_is_reached_and_what_its_files_name(
    packages: dict[str, PackageFolder],
) -> None:
    (packages["cart"].path / "launch/cart.launch.py").write_text("path = 'cart_description/urdf'\n")
    (packages["cart_description"].path / "robot.xacro").write_text("$(find worlds)/box.sdf")
    (packages["arm"].path / "launch/arm.launch.py").write_text("arm_meshes")
    assert find_reached(["cart"], packages) == {"cart", "cart_description", "worlds"}
    assert find_reached(["worlds"], packages) == {"worlds"}


@pytest.mark.parametrize(
    "place",
    [
        pytest.param("build/arm.txt", id="of a build"),
        pytest.param(".git/config", id="hidden"),
        pytest.param("meshes/arm.stl", id="of a mesh"),
    ],
)
def test_what_names_no_package(packages: dict[str, PackageFolder], place: str) -> None:
    file = packages["cart"].path / place
    file.parent.mkdir(exist_ok=True)
    file.write_text("arm")
    assert find_reached(["cart"], packages) == {"cart"}


def test_data_names_no_package(packages: dict[str, PackageFolder]) -> None:
    (packages["cart"].path / "data.txt").write_text(" " * (SIZE_LIMIT + 1) + "arm")
    (packages["cart"].path / "names.txt").write_text("arms worlds2 libcart_description")
    assert find_reached(["cart"], packages) == {"cart"}


def test_hooks_reach_all(packages: dict[str, PackageFolder]) -> None:
    build_file = packages["worlds"].path / "CMakeLists.txt"
    build_file.write_text('ament_environment_hooks("models.dsv")\n' + build_file.read_text())
    assert find_reached(["cart"], packages) == {"cart", "worlds"}


LOOK_UP = """\
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription


def generate_launch_description():
    with open(get_package_share_directory('_'.join(['arm', 'meshes'])) + '/{}') as file:
        file.read()
    return LaunchDescription([])
"""


@pytest.mark.slow
@pytest.mark.parametrize(("file", "codes"), [("launch/a.yaml", set()), ("b.yaml", {"LCH005"})])
def test_a_package_whose_name_is_computed_is_found(
    packages: dict[str, PackageFolder], file: str, codes: set[str]
) -> None:
    (packages["arm_meshes"].path / "launch/a.yaml").write_text("{}")
    (packages["cart"].path / "launch/cart.launch.py").write_text(LOOK_UP.format(file))
    found = check(CheckRequest(paths=(packages["cart"].path,)), environment={}).diagnostics
    errors = {one.code for one in found if one.severity.value == "error"}
    assert errors == codes, found
