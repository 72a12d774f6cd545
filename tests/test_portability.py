"""What works where Python lacks what POSIX has, tried with `windows_like`."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from test_architecture import SOURCE
from windows_like import ModuleOnWindows, make_interpreter
from wsgen.descriptions.meshes.lookup import Missing, locate
from wsgen.launching import known_packages
from wsgen.packages.source_shares import name_sources, serve_sources

# They import what only Linux has, and are imported only there.
LINUX_ONLY = {
    "wsgen.isolation.guard",
    "wsgen.isolation.fork_server_process",
    "wsgen.isolation.forked",
    *(f"wsgen.live.{name}" for name in ("process", "run", "service")),
    *(f"wsgen.live.{name}" for name in ("service_child", "service_process", "termination")),
    *(f"wsgen.live.{name}" for name in ("behaviors", "resources", "session")),
    "wsgen.testing.live",
}
# Scripts, which read a request, and what is on the path of certain children alone.
NO_MODULES = (
    "wsgen.isolation.bootstrap",
    "wsgen.building.colcon_child",
    "wsgen.launching.shim",
    "wsgen.launching.ros_packages",
    "wsgen.launching.moveit_configs",  # of the same child
    # Processes of ROS, which has no wheels for Windows.
    "wsgen.live.nodes",
    "wsgen.ros.shim",
    "wsgen.ros.start",
)

IMPORT = """
import importlib, sys
for name in sys.stdin.read().split():
    try:
        importlib.import_module(name)
    except Exception as error:
        print(name, type(error).__name__, error)
"""


def modules() -> set[str]:
    paths = (path.relative_to(SOURCE.parent).with_suffix("") for path in SOURCE.rglob("*.py"))
    names = {".".join(path.parts).removesuffix(".__init__") for path in paths}
    return {name for name in names if not name.startswith(NO_MODULES)}


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_interpreter(tmp_path_factory.mktemp("windows") / "environment")


@pytest.mark.slow
def test_every_module_is_imported(python: Path) -> None:
    run = subprocess.run(
        [python, "-c", IMPORT],
        input="\n".join(sorted(modules())),
        capture_output=True,
        text=True,
        check=True,
    )
    assert {line.split()[0] for line in run.stdout.splitlines()} == LINUX_ONLY, run.stdout


URDF = """<robot name="box">
  <link name="base">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
    <visual><geometry><mesh filename="package://robots/flat.stl"/></geometry></visual>
    <collision><geometry><box size="1 1 0.5"/></geometry></collision>
  </link>
</robot>
"""
STL = """solid flat
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid flat
"""
LAUNCH = """
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    file = os.path.join(get_package_share_directory("robots"), "box.urdf")
    words = ["-file", file, "-entity", "box"]
    spawn = Node(package="gazebo_ros", executable="spawn_entity.py", arguments=words)
    return LaunchDescription([spawn])
"""
MANIFEST = """<package format="3">
  <name>robots</name><version>0.0.0</version><description>Robots</description>
  <maintainer email="a@b.cd">A</maintainer><license>MIT</license>
</package>
"""
TEMPLATE = """description = "BuiltIn"
extends = "simple"
"""
FILES = {
    "src/robots/box.urdf": URDF,
    "src/robots/other.urdf": URDF.replace("flat.stl", "absent.stl"),
    "src/robots/flat.stl": STL,
    "src/robots/box.launch.py": LAUNCH,
    "src/robots/package.xml": MANIFEST,
    "ours/template.toml": TEMPLATE,
}
TIMES = re.compile(r'[0-9.]+ s$|"(expand|load|simulate|draw|total)": [0-9.]+', re.MULTILINE)
NEW = ("--maintainer-name", "A", "--maintainer-email", "a@b.cd", "--workspace", "made")


def answers(python: str | Path, folder: Path, *words: str) -> tuple[int, str, dict[str, bytes]]:
    """The exit code, what is printed, and all files afterwards."""
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    command = [python, "-m", "wsgen", *words]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    files = {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }
    said = (run.stdout + run.stderr).replace(str(folder), "FOLDER")
    return run.returncode, said, files


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("new", "some_robot", *NEW),
        ("new", "some_robot", *NEW, "--template", "ours"),
        ("templates",),
        ("launch", "src/robots/box.launch.py", "--format", "json"),
        ("validate", "src/robots/box.urdf", "--format", "json"),
        ("validate", "src/robots/box.urdf", "src/robots/other.urdf", "--jobs", "1"),
        ("rule", "spawned-in-ground"),
        ("rule",),
    ],
    ids=" ".join,
)
def test_a_command_answers_as_on_linux(
    words: tuple[str, ...], python: Path, tmp_path: Path
) -> None:
    (tmp_path / "linux").mkdir()
    (tmp_path / "windows").mkdir()
    code, said, files = answers(sys.executable, tmp_path / "linux", *words)
    there = answers(python, tmp_path / "windows", *words)
    assert (there[0], TIMES.sub("", there[1])) == (code, TIMES.sub("", said))
    assert there[2] == files
    assert "bug" not in said


@pytest.mark.slow
def test_doctor_names_the_system(python: Path, tmp_path: Path) -> None:
    code, said, _ = answers(python, tmp_path, "doctor")
    assert (code, "Windows" in said) == (0, True), said


WITH_XACRO = r"""
import shutil
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch.substitutions import Command, FindExecutable

shutil.which = lambda name: f"/programs/{name}.EXE"

def generate_launch_description():
    text = Command([FindExecutable(name="xacro"), " ", "robots\\box.urdf", " mass:=7"])
    return LaunchDescription([ExecuteProcess(cmd=["echo", text])])
"""
XACRO = """<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="mass" default="1"/><link name="weighs_$(arg mass)"/>
</robot>
"""


@pytest.mark.slow
def test_command_lines_with_paths_of_windows(python: Path, tmp_path: Path) -> None:
    (tmp_path / "robots\\box.urdf").write_text(XACRO)
    (tmp_path / "box.launch.py").write_text(WITH_XACRO)
    code, said, _ = answers(python, tmp_path, "launch", "box.launch.py", "--format", "json")
    assert (code, "weighs_7" in said) == (0, True), said


def test_launch_files_of_known_packages_by_paths_of_windows() -> None:
    folder = r"C:\opt\ros\iron\share\gazebo_ros\launch"
    shim = known_packages.shim_of(rf"{folder}\gazebo.launch.py")
    assert shim is not None
    assert (shim.package, shim.name) == ("gazebo_ros", "gazebo.launch.py")
    assert known_packages.shim_of(r"C:\robots\share\gazebo_ros\launch\gazebo.launch.py") is None


def test_source_folders_in_answers_with_paths_of_windows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = Path(r"C:\Temp\wsgen-1")
    environment = serve_sources({"robots": Path("/src/robots")}, folder, {})
    answer = [r"C:\Temp\wsgen-1\robots\share\robots\box.urdf", "C:/Temp/wsgen-1/robots/share/x"]
    assert name_sources(answer, environment) == [r"/src/robots\box.urdf", "/src/x"]


def test_addresses_of_files_with_drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "C:").mkdir()
    (tmp_path / "C:" / "box.stl").touch()

    def found() -> Path | Missing:
        return locate("file:///C:/box.stl", lambda _: None, tmp_path)

    assert isinstance(found(), Missing)
    monkeypatch.setattr("wsgen.text.files.os", ModuleOnWindows(os))
    assert found() == tmp_path / "C:" / "box.stl"
