"""Machines that are made up, compared with targets."""

import os
import re
import shlex
import sys
from collections.abc import Collection, Mapping
from pathlib import Path

import pytest
from packaging.requirements import Requirement as Dependency

from wsgen.building import machine as machine_module
from wsgen.building.machine import (
    DoctorReport,
    Machine,
    Requirement,
    check_machine,
    here,
    read_os_release,
)
from wsgen.building.toolchain import SourcedRos, Wheels
from wsgen.model.engines import ENGINES as SPECS
from wsgen.model.target import TARGETS, Target, choose_target
from wsgen.text.tomlfile import load

TODAY = "2026-11-21"
PROGRAMS = {"cmake": "/bin/cmake", "ninja": "/bin/ninja", "g++": "/bin/g++", "git": "/bin/git"}
UBUNTU = (
    'ID=ubuntu\nVERSION_ID="{version}"\nPRETTY_NAME="Ubuntu {version}"\nUBUNTU_CODENAME={name}\n'
)
JAMMY = UBUNTU.format(version="22.04", name="jammy")
NOBLE = UBUNTU.format(version="24.04", name="noble")
MINT = (
    'ID=linuxmint\nID_LIKE="ubuntu debian"\nPRETTY_NAME="Linux Mint 21.3"\n'
    'VERSION_ID="21.3"\nUBUNTU_CODENAME=jammy\n'
)
DEBIAN = 'ID=debian\nPRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\nVERSION_CODENAME=bookworm\n'
IRON = choose_target("iron")
JAZZY = choose_target("jazzy")


def machine(
    root: Path,
    *,
    environment: Mapping[str, str] | None = None,
    programs: Mapping[str, str] = PROGRAMS,
    lacking: Collection[str] = (),
    system: str = "linux",
    architecture: str = "x86_64",
    python: tuple[int, int] = (3, 10),
    toolchain: SourcedRos | Wheels | None = Wheels(prefix=Path("/venv")),  # noqa: B008  it is frozen
    why_no_picture: str | None = None,
    why_not_loaded: Mapping[str, str] = {},
) -> Machine:
    variables = {"PATH": "/bin"} if environment is None else environment
    return Machine(
        environment=variables,
        build_environment=variables,
        toolchain=toolchain,
        root=root,
        system=system,
        architecture=architecture,
        python=python,
        interpreter="/venv/bin/python",
        which=lambda name, path: programs.get(name) if path else None,
        has_module=lambda name: name not in lacking,
        why_not_loaded=why_not_loaded.get,
        why_no_picture=lambda: why_no_picture,
    )


def os_release(root: Path, text: str) -> None:
    (root / "etc").mkdir(exist_ok=True)
    (root / "etc" / "os-release").write_text(text)


def install_ros(root: Path, distro: str, *packages: str) -> None:
    prefix = root / "opt" / "ros" / distro
    prefix.mkdir(parents=True)
    (prefix / "setup.bash").touch()
    for package in packages:
        (prefix / "share" / package).mkdir(parents=True)
        (prefix / "share" / package / "package.xml").touch()


def check(one: Machine, target: Target = IRON) -> DoctorReport:
    return check_machine(one, target, today=TODAY)


def own(one: Machine) -> dict[str, Requirement]:
    return {found.name: found for found in check(one).wsgen}


def ros(one: Machine, target: Target = IRON) -> dict[str, Requirement]:
    return {found.name: found for found in check(one, target).ros}


def test_libraries_of_sweeps_say_what_they_are_for(tmp_path: Path) -> None:
    found = own(machine(tmp_path, lacking={"scipy", "distributed"}))["sweeps"]
    assert not found.is_met
    assert not found.is_required
    assert found.text == (
        "missing: distributed (runs on other machines), scipy (--sampler lhs and sobol); "
        "only for `wsgen sweep`"
    )
    assert found.fix == "/venv/bin/python -m pip install 'wsgen[sweep]'"
    assert own(machine(tmp_path))["sweeps"].is_met


def test_a_machine_on_which_wsgen_can_work(tmp_path: Path) -> None:
    found = check(machine(tmp_path))
    assert found.passed
    assert all(one.is_met for one in found.wsgen)
    assert not any(one.is_required for one in found.ros)


@pytest.mark.parametrize(
    ("module", "name", "fix"),
    [
        ("colcon_ros", "colcon", "pip install colcon-ros"),
        ("em", "colcon", "pip install 'empy>=3.3.4,<4'"),
        ("xacro", "xacro", "pip install xacro"),
        ("yaml", "Python libraries", "pip install pyyaml"),
        ("PIL", "Python libraries", "pip install pillow"),
    ],
)
def test_a_missing_module(tmp_path: Path, module: str, name: str, fix: str) -> None:
    one = machine(tmp_path, lacking=[module])
    found = own(one)[name]
    assert not check(one).passed
    assert not found.is_met
    assert found.fix == f"/venv/bin/python -m {fix}"


ENGINES = tuple(spec.library for spec in SPECS.values())
NO_GL = "failed (ImportError: libGL.so.1: cannot open shared object file: No such file)"


@pytest.mark.parametrize(
    ("python", "architecture", "fix"),
    [
        ((3, 11), "x86_64", "pybullet"),
        ((3, 12), "x86_64", "pybullet-arm64"),
        ((3, 13), "x86_64", "pybullet-arm64"),
        ((3, 14), "x86_64", "wsgen[mujoco]"),
        ((3, 11), "aarch64", "wsgen[mujoco]"),
    ],
)
def test_no_engine(tmp_path: Path, python: tuple[int, int], architecture: str, fix: str) -> None:
    one = machine(tmp_path, lacking=ENGINES, python=python, architecture=architecture)
    assert not check(one).passed
    assert shlex.split(own(one)["physics engine"].fix)[-1] == fix


def test_one_engine_is_enough(tmp_path: Path) -> None:
    one = machine(tmp_path, lacking=["pybullet", "mujoco"])
    assert check(one).passed
    assert own(one)["physics engine"].text == "DART"


def test_an_engine_that_lacks_a_library_of_the_system(tmp_path: Path) -> None:
    broken = {"wsgen.simulation.dart": NO_GL}
    found = own(machine(tmp_path, why_not_loaded=broken))
    assert found["physics engine"].text == "PyBullet, MuJoCo"
    assert not found["DART"].is_met
    assert found["DART"].text == ("cannot be loaded: it needs libGL.so.1, which the system lacks")
    assert found["DART"].fix == "sudo apt install libgl1"
    alone = machine(tmp_path, lacking=["pybullet", "mujoco"], why_not_loaded=broken, python=(3, 14))
    assert not check(alone).passed
    assert own(alone)["physics engine"].fix.endswith("install 'wsgen[mujoco]'")


def test_an_engine_that_crashes_when_it_is_loaded(tmp_path: Path) -> None:
    broken = {"wsgen.simulation.bullet": "crashed (SIGILL)"}
    found = own(machine(tmp_path, why_not_loaded=broken))["PyBullet"]
    assert found.text == "cannot be loaded: it crashed (SIGILL)"
    assert found.fix.endswith("install --force-reinstall pybullet")


@pytest.mark.parametrize(
    ("module", "pip"), [("lxml.etree", "lxml"), ("PIL.Image", "pillow"), ("numpy", "numpy")]
)
def test_a_compiled_library_that_cannot_be_loaded(tmp_path: Path, module: str, pip: str) -> None:
    broken = machine(tmp_path, why_not_loaded={module: "failed (ImportError: no such symbol)"})
    found = own(broken)["Python libraries"]
    assert not check(broken).passed
    assert found.text.endswith("failed (ImportError: no such symbol)")
    assert found.fix.endswith(f"install --force-reinstall {pip}")


def test_pictures_are_drawn_or_it_is_said_what_keeps_them_from_it(tmp_path: Path) -> None:
    assert own(machine(tmp_path))["pictures"].text == "can be drawn"
    broken = check(machine(tmp_path, why_no_picture=NO_GL))
    (found,) = (one for one in broken.wsgen if one.name == "pictures")
    assert (found.is_met, found.is_required) == (False, False)
    assert found.text == f"cannot be drawn: the renderer {NO_GL}"
    assert found.fix == "sudo apt install libgl1"
    assert broken.passed  # all else can be done


@pytest.mark.slow
def test_this_machine_draws_in_a_child_whose_death_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = here(os.environ)
    assert one.why_no_picture() is None
    assert one.why_not_loaded("numpy") is None
    tmp_path.joinpath("deadly.py").write_text("import os\ndef die():\n    os.abort()\n")
    tmp_path.joinpath("deadly_to_import.py").write_text("import deadly\ndeadly.die()\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert one.why_not_loaded("deadly_to_import") == "crashed (SIGABRT)"
    monkeypatch.setattr(machine_module, "DRAWING_TASK", "deadly:die")
    assert one.why_no_picture() == "crashed (SIGABRT)"


@pytest.mark.parametrize("lacking", [["av"], ["dartpy", "mujoco"]])
def test_what_wsgen_can_do_without(tmp_path: Path, lacking: list[str]) -> None:
    one = machine(tmp_path, lacking=lacking, programs={"cmake": "c", "make": "m"})
    assert check(one).passed
    missing = {found.name for found in check(one).wsgen if not found.is_met}
    assert missing > {"C++ compiler", "git"}
    assert all("only for" in found.text for found in check(one).wsgen if not found.is_met)


def test_tools_that_are_missing(tmp_path: Path) -> None:
    one = machine(tmp_path, programs={})
    assert not check(one).passed
    assert own(one)["CMake"].fix.endswith("install cmake")
    assert own(one)["ninja or make"].fix.endswith("install ninja")
    assert own(one)["git"].fix == ""  # there is no apt to type


def test_a_cmake_that_was_chosen_and_is_gone(tmp_path: Path) -> None:
    one = machine(tmp_path, environment={"PATH": "/bin", "CMAKE_COMMAND": "/gone/cmake"})
    assert not check(one).passed
    assert own(one)["CMake"].fix == "unset CMAKE_COMMAND"


@pytest.mark.parametrize("variables", [{}, {"PATH": ""}])
def test_no_path(tmp_path: Path, variables: dict[str, str]) -> None:
    found = check(machine(tmp_path, environment=variables))
    assert not found.passed
    assert any("PATH is empty" in note for note in found.notes)


def test_no_ament_cmake(tmp_path: Path) -> None:
    found = own(machine(tmp_path, toolchain=None))["ament_cmake"]
    assert not found.is_met
    assert "ros-ament-cmake-pytest" in found.fix
    elsewhere = machine(tmp_path, toolchain=None, architecture="aarch64")
    found = own(elsewhere)["ament_cmake"]
    assert not found.is_met
    assert found.is_required
    assert found.fix.startswith("/venv/bin/python -m pip install --only-binary :all: --platform")
    install_ros(tmp_path, "jazzy")
    assert own(elsewhere)["ament_cmake"].fix == f"source {tmp_path}/opt/ros/jazzy/setup.bash"


def test_ament_cmake_of_a_sourced_ros(tmp_path: Path) -> None:
    found = own(machine(tmp_path, toolchain=SourcedRos(prefix=Path("/opt/ros/iron"))))
    assert found["ament_cmake"].text == "from the sourced ROS, in /opt/ros/iron"


@pytest.mark.parametrize("python", [(3, 9), (3, 15)])
def test_a_python_that_wsgen_is_not_for(tmp_path: Path, python: tuple[int, int]) -> None:
    assert not check(machine(tmp_path, python=python)).passed


def test_the_ubuntu_of_the_target_without_ros(tmp_path: Path) -> None:
    os_release(tmp_path, JAMMY)
    found = ros(machine(tmp_path))
    assert found["Ubuntu"] == Requirement("Ubuntu", is_met=True, text="Ubuntu 22.04")
    assert found["Python"].is_met
    assert "snapshots.ros.org/iron/final" in found["apt repository"].fix
    assert found["ROS 2 Iron"].fix == check(machine(tmp_path)).apt
    assert check(machine(tmp_path)).takes_apt
    assert found["Gazebo Classic 11"].fix == "sudo apt install ros-iron-gazebo-ros-pkgs"
    assert found["colcon"].fix == "sudo apt install python3-colcon-common-extensions"


def test_apt_knows_ros(tmp_path: Path) -> None:
    os_release(tmp_path, JAMMY)
    folder = tmp_path / "etc" / "apt" / "sources.list.d"
    folder.mkdir(parents=True)
    (folder / "old.list").write_text("# deb http://packages.ros.org/ros2/ubuntu jammy main\n")
    (folder / "gone.list").symlink_to(tmp_path / "nowhere")
    assert not ros(machine(tmp_path))["apt repository"].is_met
    (folder / "ros2.sources").write_text("Types: deb\nURIs: http://packages.ros.org/ros2/ubuntu\n")
    assert ros(machine(tmp_path))["apt repository"].is_met


@pytest.mark.parametrize(
    ("text", "target", "said", "fix"),
    [
        (NOBLE, IRON, "this is Ubuntu 24.04", "wsgen doctor --distro jazzy"),
        (JAMMY, JAZZY, "this is Ubuntu 22.04", "wsgen doctor --distro humble"),
        (DEBIAN, IRON, "this is Debian GNU/Linux 12", "docker run"),
        ("", IRON, "a Linux without a name", "docker run"),
        ("no equals sign\n=\n# ID=ubuntu\n", IRON, "a Linux without a name", "docker run"),
    ],
)
def test_another_system(tmp_path: Path, text: str, target: Target, said: str, fix: str) -> None:
    os_release(tmp_path, text)
    found = ros(machine(tmp_path), target)
    assert not found["Ubuntu"].is_met
    assert said in found["Ubuntu"].text
    assert f"packaged for Ubuntu {target.ubuntu}" in found["Ubuntu"].text
    assert found["Ubuntu"].fix.startswith(fix)
    assert "apt repository" not in found
    assert not any("apt install" in one.fix for one in found.values())
    assert found[target.ros].fix.endswith(f" ros:{target.distro}-ros-base")
    assert not check(machine(tmp_path), target).takes_apt


def test_a_system_made_from_ubuntu(tmp_path: Path) -> None:
    os_release(tmp_path, MINT)
    found = ros(machine(tmp_path))["Ubuntu"]
    assert found.is_met
    assert "Linux Mint 21.3, based on Ubuntu 22.04" in found.text


def test_no_os_release(tmp_path: Path) -> None:
    found = ros(machine(tmp_path))["Ubuntu"]
    assert not found.is_met
    assert "No such file" in found.text


def test_os_release_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "etc" / "os-release").mkdir(parents=True)
    found = ros(machine(tmp_path))["Ubuntu"]
    assert not found.is_met
    assert "os-release: Is a directory" in found.text
    (tmp_path / "etc" / "os-release").rmdir()
    (tmp_path / "etc" / "os-release").write_bytes(b"\xff\xfe\x00ID\xff")
    assert not ros(machine(tmp_path))["Ubuntu"].is_met


def test_os_release_of_the_other_place(tmp_path: Path) -> None:
    (tmp_path / "usr" / "lib").mkdir(parents=True)
    (tmp_path / "usr" / "lib" / "os-release").write_text("A='b c'\n D = e\n")
    assert read_os_release(tmp_path) == {"A": "b c", "D": "e"}


@pytest.mark.parametrize(
    ("system", "name"), [("darwin", "macOS"), ("win32", "Windows"), ("aix", "aix")]
)
def test_no_linux(tmp_path: Path, system: str, name: str) -> None:
    one = machine(tmp_path, system=system, architecture="arm64", toolchain=None)
    assert f"this is {name}" in ros(one)["Ubuntu"].text
    found = own(one)["ament_cmake"]
    assert not found.is_met
    assert found.is_required == (system != "win32")
    assert found.fix.startswith("wsl" if system == "win32" else "/venv/bin/python -m pip install")


def test_ros_that_is_not_sourced(tmp_path: Path) -> None:
    os_release(tmp_path, JAMMY)
    install_ros(tmp_path, "iron", "xacro")
    found = ros(machine(tmp_path))
    assert "apt repository" not in found
    assert "not sourced" in found["ROS 2 Iron"].text
    assert found["ROS 2 Iron"].fix == f"source {tmp_path}/opt/ros/iron/setup.bash"
    packages = found["ROS packages"]
    assert "xacro" not in packages.text
    assert "ros-iron-gazebo-ros" in packages.fix.split()


def test_all_of_it_is_there(tmp_path: Path) -> None:
    os_release(tmp_path, JAMMY)
    publishers = ("joint_state_publisher", "joint_state_publisher_gui", "robot_state_publisher")
    install_ros(tmp_path, "iron", "xacro", "gazebo_ros", *publishers)
    prefix = tmp_path / "opt" / "ros" / "iron"
    variables = {"PATH": "/bin", "ROS_DISTRO": "iron", "AMENT_PREFIX_PATH": str(prefix)}
    programs = {**PROGRAMS, "gazebo": "/usr/bin/gazebo", "colcon": "/usr/bin/colcon"}
    found = check(machine(tmp_path, environment=variables, programs=programs))
    assert found.passed
    assert all(one.is_met and not one.fix for one in found.ros)


def test_another_ros_is_sourced(tmp_path: Path) -> None:
    os_release(tmp_path, JAMMY)
    variables = {"PATH": "/bin", "ROS_DISTRO": "humble", "AMENT_PREFIX_PATH": "/opt/ros/humble"}
    found = ros(machine(tmp_path, environment=variables))["ROS 2 Iron"]
    assert found.text == "not installed; humble is sourced"
    install_ros(tmp_path, "iron")
    found = ros(machine(tmp_path, environment=variables))["ROS 2 Iron"]
    assert "humble is sourced, so open a new terminal first" in found.text


def test_another_ros_is_installed(tmp_path: Path) -> None:
    os_release(tmp_path, JAMMY)
    install_ros(tmp_path, "humble")
    assert ros(machine(tmp_path))["ROS 2 Iron"].text == "not installed; installed: humble"


def test_a_variable_alone_is_no_ros(tmp_path: Path) -> None:
    """Somebody set ROS_DISTRO for `wsgen new`."""
    one = machine(tmp_path, environment={"PATH": "/bin", "ROS_DISTRO": "iron"})
    assert ros(one)["ROS 2 Iron"].text == "not installed"


@pytest.mark.parametrize(
    ("target", "program"),
    [
        ("iron-classic", "gazebo"),
        ("humble-classic", "gazebo"),
        ("humble-gz", "ign"),
        ("iron-gz", "ign"),
    ],
)
def test_the_program_of_gazebo(tmp_path: Path, target: str, program: str) -> None:
    wanted = next(one for one in TARGETS if one.name == target)
    assert not ros(machine(tmp_path), wanted)[wanted.gazebo].is_met
    one = machine(tmp_path, programs={program: f"/usr/bin/{program}"})
    assert ros(one, wanted)[wanted.gazebo].text == f"/usr/bin/{program}"


def test_gazebo_as_a_package_of_ros(tmp_path: Path) -> None:
    """From Jazzy on `gz` is nowhere on the PATH before ROS is sourced."""
    install_ros(tmp_path, "jazzy", "gz_sim_vendor")
    assert ros(machine(tmp_path), JAZZY)["Gazebo Harmonic"].is_met
    assert not ros(machine(tmp_path), choose_target("kilted"))["Gazebo Ionic"].is_met


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_every_command_can_be_typed(tmp_path: Path, target: Target) -> None:
    os_release(tmp_path, UBUNTU.format(version=target.ubuntu, name=target.fact("ubuntu_codename")))
    lacking = {"xacro", *ENGINES, "av", "colcon_core"}
    found = check(machine(tmp_path, lacking=lacking, programs={}, toolchain=None), target)
    commands = [one.fix for one in (*found.wsgen, *found.ros) if one.fix]
    assert len(commands) > 8
    for command in commands:
        assert shlex.split(command)[0] in {"/venv/bin/python", "sudo", "curl", "gpg", "wsgen"}
        assert "{" not in command


def test_what_has_ended_is_said(tmp_path: Path) -> None:
    assert check(machine(tmp_path)).notes[0].startswith("ROS 2 Iron has had no updates")
    assert check(machine(tmp_path), JAZZY).notes == ()


@pytest.mark.slow
def test_this_machine() -> None:
    found = check_machine(here(os.environ), IRON, today=TODAY)
    assert found.passed
    assert {one.name: one.text for one in found.wsgen}["Python"].startswith(
        f"{sys.version_info[0]}.{sys.version_info[1]};"
    )


def test_every_dependency_of_wsgen_is_looked_for() -> None:
    project = load(Path(__file__).parents[2] / "pyproject.toml")["project"]
    wanted = {re.match(r"[\w.-]+", line)[0].lower() for line in project["dependencies"]}  # type: ignore[index]
    modules = [*machine_module.COLCON_PACKAGES.values(), *machine_module.LIBRARIES.values()]
    known = {re.match(r"[\w.-]+", name)[0].lower() for name in modules}  # type: ignore[index]
    engines = {*SPECS["bullet"].wheels, *SPECS["mujoco"].wheels}
    # tomli: without it wsgen does not start.
    others = {"cmake", "ninja", "xacro", "tomli"}
    assert wanted == known | set(machine_module.WHEELS) | engines | others
    assert {
        module.partition(".")[0] for module in machine_module.COMPILED
    } <= machine_module.LIBRARIES.keys()
    first, last = (f"{major}.{minor}" for major, minor in machine_module.PYTHONS)
    assert project["requires-python"] == f">={first},<3.{int(last.split('.')[1]) + 1}"


@pytest.mark.parametrize("minor", range(10, 15))
@pytest.mark.parametrize(
    ("system", "architecture"),
    [
        ("linux", "x86_64"),
        ("linux", "aarch64"),
        ("darwin", "arm64"),
        ("darwin", "x86_64"),
        ("win32", "AMD64"),
        ("win32", "ARM64"),
    ],
)
def test_the_pybullet_that_is_named_is_the_one_that_wsgen_depends_on(
    tmp_path: Path, system: str, architecture: str, minor: int
) -> None:
    project = load(Path(__file__).parents[2] / "pyproject.toml")["project"]
    variables = {
        "sys_platform": system,
        "platform_machine": architecture,
        "python_version": f"3.{minor}",
    }
    lines = [Dependency(line) for line in project["dependencies"]]
    wanted = {one.name for one in lines if one.marker is None or one.marker.evaluate(variables)}
    one = machine(tmp_path, system=system, architecture=architecture, python=(3, minor))
    named = machine_module.pybullet_for(one)
    assert wanted & {"pybullet", "pybullet-arm64"} == ({named} if named else set())
