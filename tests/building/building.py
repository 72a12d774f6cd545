"""Small workspaces, and ways to build them, for the tests of this folder."""

import os
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from wsgen.building.run import BuildResult, build
from wsgen.events import Event
from wsgen.packages.workspace.layout import Workspace

COLCON = Path(sys.executable).with_name("colcon")

PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="3">
  <name>demo</name>
  <version>0.0.0</version>
  <description>A robot for tests.</description>
  <maintainer email="somebody@example.com">Somebody</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""

CMAKE = """\
cmake_minimum_required(VERSION 3.20)
project(demo LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
install(
  DIRECTORY launch model
  DESTINATION share/${PROJECT_NAME}
)
ament_package()
"""

LINTED = CMAKE.replace(
    "ament_package()",
    "if(BUILD_TESTING)\n"
    "  find_package(ament_lint_auto REQUIRED)\n"
    "  ament_lint_auto_find_test_dependencies()\n"
    "endif()\n"
    "ament_package()",
)


def write_package(
    root: Path, name: str = "demo", *, package_xml: str = PACKAGE_XML, cmake: str = CMAKE
) -> Path:
    """Write a package of launch files and models into the workspace; returns its folder."""
    folder = root / "src" / name
    for file in ("launch/demo.launch.py", "model/robot.xacro"):
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text("")
    (folder / "package.xml").write_text(package_xml.replace(">demo<", f">{name}<"))
    (folder / "CMakeLists.txt").write_text(re.sub(r"\(demo(?=[ )])", f"({name}", cmake))
    return folder


def outside() -> dict[str, str]:
    """The environment of a shell in which no virtual environment and no ROS is active."""
    kept = {name: os.environ[name] for name in ("HOME", "LANG", "LC_ALL") if name in os.environ}
    return {**kept, "PATH": "/usr/bin:/bin"}


def build_here(
    root: Path,
    *packages: str,
    colcon_arguments: tuple[str, ...] = (),
    environment: Mapping[str, str] | None = None,
    events: list[Event] | None = None,
) -> BuildResult:
    """`wsgen build` as a function."""
    return build(
        Workspace(root=root),
        packages=packages,
        colcon_arguments=colcon_arguments,
        environment=outside() if environment is None else environment,
        listener=None if events is None else events.append,
    )


def plain_colcon(
    root: Path,
    environment: Mapping[str, str],
    *arguments: str,
    program: tuple[str | Path, ...] = (COLCON,),
    warning: str = "",
) -> str:
    """Plain `colcon build`; returns what it printed: no warnings but this one."""
    run = subprocess.run(
        [*program, "build", *arguments],
        cwd=root,
        env=dict(environment),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    warnings = run.stderr.splitlines()
    assert len(warnings) == bool(warning), run.stderr
    assert warning in run.stderr
    return run.stdout


def cache_entry(root: Path, name: str, package: str = "demo") -> str | None:
    """What CMake remembers under a name."""
    lines = (root / "build" / package / "CMakeCache.txt").read_text().splitlines()
    values = [line.partition("=")[2] for line in lines if line.startswith(f"{name}:")]
    return values[0] if values else None


def read_tree(folder: Path) -> dict[str, bytes]:
    """The files of a folder by their relative paths."""
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def link_programs(folder: Path, *programs: str) -> Path:
    """Make a folder for PATH that holds these programs of the machine and no others."""
    folder.mkdir()
    for program in programs:
        for place in ("/usr/bin", "/bin"):
            if (Path(place) / program).exists():
                (folder / program).symlink_to(Path(place) / program)
                break
    return folder


SHELL_PROGRAMS = ("sh", "bash", "env", "uname", "cat", "mkdir", "rm")
