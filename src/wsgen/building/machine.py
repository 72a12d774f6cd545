"""Look at a machine and compare it with a target, for `wsgen doctor`.

wsgen requires no ROS. `ros2 launch` of a package requires the Ubuntu, ROS and Gazebo of the target.
Compiled modules are imported in a child process: one that is built for another machine may crash,
and the system may lack a library that one needs. A `Machine` holds all that is looked at, so that
tests can make one up.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import shlex
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.building.toolchain import MAKE_PROGRAMS, SourcedRos, fetch_arguments, find_toolchain
from wsgen.errors import NotFoundError, NotReadableError, WsgenError
from wsgen.isolation import parent
from wsgen.isolation.result import Died, find_missing_library
from wsgen.model.engines import ENGINES
from wsgen.model.facts import DISTROS, RELEASED_FOR
from wsgen.model.target import (
    APT_HOSTS,
    COLCON,
    SIMULATOR_PACKAGES,
    VARIANTS,
    Target,
    apt_install,
    apt_source,
    debian_name,
    end_of_life_note,
    image,
    ros_packages,
)
from wsgen.ros.environment.available import check_rclpy, sourced_prefix, why_not
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from wsgen.building.toolchain import Toolchain
    from wsgen.model.engines import EngineSpec


PYTHONS = ((3, 10), (3, 14))  # from, to; as requires-python in pyproject.toml
# Module -> what pip calls it, of what wsgen depends on.
COLCON_PACKAGES = {
    "colcon_core": "colcon-core",
    "colcon_bash": "colcon-bash",
    "colcon_cmake": "colcon-cmake",
    "colcon_defaults": "colcon-defaults",
    "colcon_library_path": "colcon-library-path",
    "colcon_metadata": "colcon-metadata",
    "colcon_output": "colcon-output",
    "colcon_package_selection": "colcon-package-selection",
    "colcon_parallel_executor": "colcon-parallel-executor",
    "colcon_recursive_crawl": "colcon-recursive-crawl",
    "colcon_ros": "colcon-ros",
    "colcon_zsh": "colcon-zsh",
    "catkin_pkg": "catkin_pkg",
    "em": "empy>=3.3.4,<4",
}
LIBRARIES = {
    "click": "click",
    "rich": "rich",
    "jinja2": "jinja2",
    "lxml": "lxml",
    "yaml": "pyyaml",
    "numpy": "numpy",
    "PIL": "pillow",
    "pytest": "pytest",
    "trimesh": "trimesh",
    "shapely": "shapely",
}
# Of these, what is compiled: it is imported, to see whether it can be.
COMPILED = ("lxml.etree", "yaml", "numpy", "PIL.Image", "shapely")
# Where PyBullet has wheels, or its fork, which is the same module: system, machine, first and last
# Python, what pip calls it. As in pyproject.toml.
PYBULLETS = (
    ("linux", "x86_64", (3, 10), (3, 11), "pybullet"),
    ("linux", "x86_64", (3, 12), (3, 13), "pybullet-arm64"),
    ("darwin", "arm64", (3, 10), (3, 13), "pybullet-arm64"),
    ("win32", "AMD64", (3, 10), (3, 13), "pybullet-arm64"),
)
WHEELS = (
    "ros-ament-cmake",
    "ros-ament-package",
    "ros-ament-cmake-include-directories",
    "ros-ament-cmake-pytest",
    "ros-ament-cmake-gtest",
    "ros-ament-cmake-gmock",
    "ros-ament-index-python",
)
OS_RELEASE = ("etc/os-release", "usr/lib/os-release")  # the first that exists
DRAWING_TASK = "wsgen.rendering.renderer:draw_a_box"
IMPORTING_TASK = "wsgen.isolation.child:import_modules"
SYSTEMS = {"linux": "Linux", "darwin": "macOS", "win32": "Windows"}


class Requirement(NamedTuple):
    """Something that wsgen or ROS requires, and whether a machine has it."""

    name: str
    is_met: bool
    text: str  # what the machine has; or that it is missing, and its purpose
    is_required: bool = False  # by wsgen's own commands
    fix: str = ""  # the command that fixes it


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A machine to look at."""

    environment: Mapping[str, str]
    build_environment: Mapping[str, str]  # that colcon would be given
    toolchain: Toolchain | None  # that colcon would use
    root: Path  # of the file system
    system: str  # as sys.platform
    architecture: str  # as platform.machine()
    python: tuple[int, int]  # that runs wsgen
    interpreter: str  # its path
    which: Callable[[str, str], str | None]  # name of a program, PATH -> its path
    has_module: Callable[[str], bool]  # name of a Python module at the top level
    why_not_loaded: Callable[[str], str | None]  # why a module cannot be imported; None if it can
    why_no_picture: Callable[[], str | None]  # why nothing can be drawn; None if it can

    @property
    def system_name(self) -> str:
        """The kind of system, for people."""
        return SYSTEMS.get(self.system, self.system)

    def find(self, *programs: str, for_build: bool = False) -> str | None:
        """Find the path of the first of these programs that exists."""
        variables = self.build_environment if for_build else self.environment
        path = variables.get("PATH", "")
        return next(filter(None, (self.which(name, path) for name in programs)), None)


def here(environment: Mapping[str, str]) -> Machine:
    """Return this machine, with these variables."""
    try:
        toolchain = find_toolchain(environment)
    except NotFoundError:
        toolchain = None
    return Machine(
        environment=environment,
        build_environment=toolchain.environment(environment) if toolchain else environment,
        toolchain=toolchain,
        root=Path("/"),
        system=sys.platform,
        architecture=platform.machine(),
        python=sys.version_info[:2],
        interpreter=sys.executable,
        which=_which,
        has_module=_has_module,
        why_not_loaded=_why_not_loaded,
        why_no_picture=_why_no_picture,
    )


def read_os_release(root: Path) -> dict[str, str]:
    """Read the settings of /etc/os-release, by the specification of freedesktop.org.

    Raises:
        OSError: it is missing, or cannot be read.
    """
    for name in OS_RELEASE:
        file = root / name
        if file.exists():
            break
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    settings = (line.partition("=") for line in lines if not line.lstrip().startswith("#"))
    return {key.strip(): value.strip().strip("\"'") for key, equals, value in settings if equals}


def names_in_apt(root: Path, hosts: tuple[str, ...]) -> bool:
    """Whether apt gets packages from one of these hosts; unreadable files are skipped."""
    folder = root / "etc" / "apt"
    files = [folder / "sources.list"]
    for pattern in ("*.list", "*.sources"):
        files += sorted((folder / "sources.list.d").glob(pattern))
    for file in files:
        try:
            text = file.read_text(encoding="utf-8", errors="replace")
        except OSError:
            continue
        lines = (line for line in text.splitlines() if not line.lstrip().startswith("#"))
        if any(host in line for line in lines for host in hosts):
            return True
    return False


def ros_prefixes(machine: Machine, distro: str) -> list[Path]:
    """List the folders with packages of a distribution: what is sourced, then /opt/ros."""
    sourced = machine.environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [*map(Path, filter(None, sourced)), machine.root / "opt" / "ros" / distro]


def _which(program: str, path: str) -> str | None:
    return shutil.which(program, path=path)


def _why_not_loaded(module: str) -> str | None:
    """Import a module in a child process; return why it failed, to follow its name."""
    return _why_not_done(IMPORTING_TASK, [module])[1]


def _why_no_picture() -> str | None:
    """Draw a small picture in a child process; return why it failed, to follow "the renderer"."""
    drawn, problem = _why_not_done(DRAWING_TASK)
    return problem if drawn or problem else "draws nothing"


def _why_not_done(task: str, *arguments: object) -> tuple[Any, str | None]:
    """Return the answer of a child process, and why it has none."""
    try:
        outcome = parent.run(task, *arguments)
    except NotReadableError as error:
        return None, f"was not started: {error.message}"
    return (None, outcome.reason) if isinstance(outcome, Died) else (outcome.value, None)


def _has_module(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return False


def check_wsgen(machine: Machine) -> Iterator[Requirement]:
    """Check what `wsgen new`, `build` and `validate` use."""
    yield _python_for_wsgen(machine)
    yield _modules(machine, "colcon", COLCON_PACKAGES)
    yield _ament_cmake(machine)
    yield _cmake(machine)
    yield _build_program(machine)
    yield _modules(machine, "xacro", {"xacro": "xacro"})
    yield _modules(machine, "Python libraries", LIBRARIES, compiled=COMPILED)
    yield from _engines(machine)
    yield _pictures(machine)
    yield from _extras(machine)


def _python_for_wsgen(machine: Machine) -> Requirement:
    first, last = (".".join(map(str, version)) for version in PYTHONS)
    return Requirement(
        name="Python",
        is_met=PYTHONS[0] <= machine.python <= PYTHONS[1],
        text=f"{machine.python[0]}.{machine.python[1]}; wsgen supports {first} to {last}",
        is_required=True,
    )


def _modules(
    machine: Machine, name: str, modules: Mapping[str, str], *, compiled: Sequence[str] = ()
) -> Requirement:
    missing = [pip for module, pip in modules.items() if not machine.has_module(module)]
    text, fix = "installed with wsgen", ""
    if missing:
        text, fix = f"missing: {', '.join(missing)}", _pip(machine, *missing)
    for module in () if missing else compiled:
        why = machine.why_not_loaded(module)
        if why is not None:
            library, _, _ = module.partition(".")
            text, fix = _not_loaded(machine, why, modules[library])
            return Requirement(
                name, is_met=False, text=f"{library} {text}", is_required=True, fix=fix
            )
    return Requirement(name, is_met=not missing, text=text, is_required=True, fix=fix)


def _not_loaded(machine: Machine, why: str, pip: str) -> tuple[str, str]:
    """Return why a library is not loaded, to follow its name, and the command that fixes it."""
    missing = find_missing_library(why)
    if missing is None:
        return f"cannot be loaded: it {why}", _pip(machine, "--force-reinstall", pip)
    return f"cannot be loaded: it needs {missing.name}, which the system lacks", missing.command


def _ament_cmake(machine: Machine) -> Requirement:
    found = machine.toolchain
    if found is not None:
        source = "the sourced ROS" if isinstance(found, SourcedRos) else "the wheels"
        text = f"from {source}, in {found.prefix}"
        return Requirement("ament_cmake", is_met=True, text=text, is_required=True)
    text, fix = "missing", ""
    setup = _any_ros(machine)
    fetch = fetch_arguments(machine.system, machine.architecture)
    if machine.system == "win32":
        text = "missing; wsgen does not build on Windows: use the Windows Subsystem for Linux"
        fix = "wsl --install"
    elif fetch is None:
        fix = _pip(machine, *WHEELS)
    elif setup:
        fix = f"source {setup}"
    else:
        text = "missing; pip installs it by itself only on Linux on x86_64"
        fix = shlex.join([machine.interpreter, "-m", "pip", *fetch])
    is_required = machine.system != "win32"  # where nobody has it, the rest is still of use
    return Requirement("ament_cmake", is_met=False, text=text, is_required=is_required, fix=fix)


def _any_ros(machine: Machine) -> str | None:
    """Find the setup file of a ROS on this machine."""
    found = sorted(machine.root.glob("opt/ros/*/setup.bash"))
    return str(found[-1]) if found else None


def _cmake(machine: Machine) -> Requirement:
    selected = machine.build_environment.get("CMAKE_COMMAND")
    if selected:
        found = machine.find(selected, for_build=True)
        text = found or f"missing: CMAKE_COMMAND={selected} is not a program"
        fix = "" if found else "unset CMAKE_COMMAND"
    else:
        found = machine.find("cmake", for_build=True)
        text, fix = found or "missing", "" if found else _pip(machine, "cmake")
    return Requirement("CMake", is_met=bool(found), text=text, is_required=True, fix=fix)


def _build_program(machine: Machine) -> Requirement:
    found = machine.find("ninja", *MAKE_PROGRAMS, for_build=True)
    return Requirement(
        "ninja or make",
        is_met=found is not None,
        text=found or "missing",
        is_required=True,
        fix="" if found else _pip(machine, "ninja"),
    )


def _engines(machine: Machine) -> Iterator[Requirement]:
    """Check that an engine can be loaded, then each of them."""
    found = [_engine(machine, name, spec) for name, spec in ENGINES.items()]
    usable = [one.name for one in found if one.is_met]
    yield Requirement(
        "physics engine",
        is_met=bool(usable),
        text=", ".join(usable) or "none can be used",
        is_required=True,
        fix="" if usable else next(one.fix for one in found if one.fix),
    )
    yield from found


def _engine(machine: Machine, name: str, spec: EngineSpec) -> Requirement:
    wanted = f"wsgen[{spec.extra}]" if spec.extra else pybullet_for(machine)
    why = None
    is_there = machine.has_module(spec.library)
    if is_there:
        why = machine.why_not_loaded(spec.engine.partition(":")[0])
        text, fix = (
            ("can be loaded", "") if why is None else _not_loaded(machine, why, spec.library)
        )
    elif wanted is None:
        text, fix = "missing; it has no wheels for this machine and Python", ""
    else:
        text, fix = f"missing; only for --engine {name}", _pip(machine, wanted)
    return Requirement(spec.title, is_met=is_there and why is None, text=text, fix=fix)


def pybullet_for(machine: Machine) -> str | None:
    """Return what pip calls the PyBullet with wheels for a machine; None if it has none."""
    for system, architecture, first, last, pip in PYBULLETS:
        is_it = (system, architecture) == (machine.system, machine.architecture)
        if is_it and first <= machine.python <= last:
            return pip
    return None


def _pictures(machine: Machine) -> Requirement:
    """Check whether `--picture` and `--record` can draw."""
    problem = machine.why_no_picture()
    text = "can be drawn" if problem is None else f"cannot be drawn: the renderer {problem}"
    missing = find_missing_library(problem or "")
    fix = "" if missing is None else missing.command
    return Requirement("pictures", is_met=problem is None, text=text, fix=fix)


def _extras(machine: Machine) -> Iterator[Requirement]:
    """Check what is optional."""
    text, fix = "missing; only for videos as MP4", _pip(machine, "wsgen[video]")
    why = None
    is_there = machine.has_module("av")
    if is_there:
        why = machine.why_not_loaded("av")
        text, fix = ("installed", "") if why is None else _not_loaded(machine, why, "av")
    yield Requirement("PyAV", is_met=is_there and why is None, text=text, fix=fix)
    has_plotly = machine.has_module("plotly")
    yield Requirement(
        "plotly",
        is_met=has_plotly,
        text="installed" if has_plotly else "missing; only for reports as HTML",
        fix="" if has_plotly else _pip(machine, "wsgen[report]"),
    )
    yield _sweeps(machine)
    yield _live_runs(machine)
    for name, programs, purpose, package in (
        ("C++ compiler", ("c++", "g++", "clang++"), "packages with C++", "build-essential"),
        ("git", ("git",), "the maintainer's name and address", "git"),
    ):
        found = machine.find(*programs, for_build=True)
        install = f"sudo apt install {package}" if machine.find("apt") else ""
        yield Requirement(
            name,
            is_met=found is not None,
            text=found or f"missing; only for {purpose}",
            fix="" if found else install,
        )


OF_SWEEPS = {  # module -> what it is for
    "distributed": "runs on other machines",
    "pyarrow": "tables as Parquet",
    "scipy": "--sampler lhs and sobol",
    "matplotlib": "plots",
    "plotly": "plots as HTML",
}


def _sweeps(machine: Machine) -> Requirement:
    """Check what `wsgen sweep` can do."""
    lacking = [name for name in OF_SWEEPS if not machine.has_module(name)]
    without = ", ".join(f"{name} ({OF_SWEEPS[name]})" for name in lacking)
    return Requirement(
        "sweeps",
        is_met=not lacking,
        text=f"missing: {without}; only for `wsgen sweep`" if lacking else "installed",
        fix=_pip(machine, "wsgen[sweep]") if lacking else "",
    )


def _live_runs(machine: Machine) -> Requirement:
    """Check whether launch files can be started: with a sourced ROS, or with that of PyPI."""
    name = "live runs"
    if (prefix := sourced_prefix(machine.environment)) is not None:
        distro = machine.environment.get("ROS_DISTRO", prefix.name)
        try:
            check_rclpy(prefix, distro, machine.environment)
        except WsgenError as error:
            return Requirement(name, is_met=False, text=error.message)
        return Requirement(name, is_met=True, text=f"with ROS {distro}, which is sourced")
    reason = why_not(machine.system, machine.architecture, machine.python)
    if reason is not None:
        return Requirement(name, is_met=False, text=reason.message)
    if not all(machine.has_module(module) for module in ("pip", "mcap")):
        text = "missing; only for nodes that run (ROS 2 from PyPI)"
        return Requirement(name, is_met=False, text=text, fix=_pip(machine, "wsgen[ros]"))
    return Requirement(
        name, is_met=True, text="with ROS 2 from PyPI, which comes into the cache when first needed"
    )


def _pip(machine: Machine, *requirements: str) -> str:
    if not requirements:
        return ""
    return shlex.join([machine.interpreter, "-m", "pip", "install", *requirements])


SYSTEM = "Ubuntu"  # name of the requirement


def check_ros(machine: Machine, target: Target) -> Iterator[Requirement]:
    """Check what ROS of the target requires beyond wsgen."""
    ubuntu = _ubuntu(machine, target)
    yield ubuntu
    yield _python_for_ros(machine, target)
    ros = _ros(machine, target, can_install=ubuntu.is_met)
    is_installed = _setup_file(machine, target).is_file() or ros.is_met
    if ubuntu.is_met and not is_installed:
        yield _apt(machine, target)
    yield ros
    if is_installed:
        yield _packages(machine, target)
    yield _gazebo(machine, target, can_install=ubuntu.is_met)
    yield _colcon(machine, can_install=ubuntu.is_met)


def _ubuntu(machine: Machine, target: Target) -> Requirement:
    wanted = f"Ubuntu {target.ubuntu}"
    is_met = False
    fix = _container(target)
    if machine.system != "linux":
        text = (
            f"this is {machine.system_name}; {target.ros} is packaged for {wanted}."
            " wsgen simulates packages here; run them in a container or on another machine"
        )
        return Requirement(SYSTEM, is_met=False, text=text, fix=fix)
    try:
        release = read_os_release(machine.root)
    except OSError as error:
        text = f"unknown: {error.filename}: {error.strerror}; {target.ros} is packaged for {wanted}"
        return Requirement(SYSTEM, is_met=False, text=text, fix=fix)
    name = release.get("PRETTY_NAME") or release.get("NAME") or "a Linux without a name"
    is_ubuntu = release.get("ID") == "ubuntu"
    codename = release.get("UBUNTU_CODENAME", release.get("VERSION_CODENAME") if is_ubuntu else "")
    if is_ubuntu and release.get("VERSION_ID") == target.ubuntu:
        is_met, text, fix = True, name, ""
    elif codename == target.fact("ubuntu_codename"):
        is_met, fix = True, ""
        text = f"{name}, based on {wanted}; ROS is only tested on Ubuntu itself"
    else:
        text = f"this is {name}; {target.ros} is packaged for {wanted}"
        fitting = _distro_for(codename or "")
        if fitting:
            fix = f"wsgen doctor --distro {fitting}"
    return Requirement(SYSTEM, is_met=is_met, text=text, fix=fix)


def _distro_for(codename: str) -> str | None:
    """Find the distribution for an Ubuntu that is supported longest."""
    fitting = [
        target
        for target in (Target(distro=name, simulator="gz") for name in DISTROS)
        if target.fact("ubuntu_codename") == codename and not target.has_ended
    ]
    fitting.sort(key=lambda target: target.end_of_life or "")
    return fitting[-1].distro if fitting else None


def _python_for_ros(machine: Machine, target: Target) -> Requirement:
    wanted = target.fact("python")
    ours = ".".join(map(str, machine.python))
    text = f"{wanted}, the same as wsgen's"
    if ours != wanted:
        text = f"{target.ros} runs launch files with {wanted}, but wsgen evaluates them with {ours}"
    return Requirement("Python", is_met=ours == wanted, text=text)


def _apt(machine: Machine, target: Target) -> Requirement:
    is_met = names_in_apt(machine.root, APT_HOSTS)
    return Requirement(
        "apt repository",
        is_met=is_met,
        text="apt knows the one of ROS" if is_met else "apt does not know the one of ROS",
        fix="" if is_met else apt_source(target),
    )


def _ros(machine: Machine, target: Target, *, can_install: bool) -> Requirement:
    sourced = machine.environment.get("ROS_DISTRO", "")
    has_prefix = bool(machine.environment.get("AMENT_PREFIX_PATH"))
    setup = _setup_file(machine, target)
    if sourced == target.distro and has_prefix:
        return Requirement(target.ros, is_met=True, text="sourced")
    if sourced and has_prefix:
        others = f"{sourced} is sourced"
    else:
        found = sorted(path.parent.name for path in machine.root.glob("opt/ros/*/setup.bash"))
        others = f"installed: {', '.join(found)}" if found else ""
    if setup.is_file():
        text = f"in {setup.parent}, not sourced"
        if sourced and has_prefix:
            text += f": {others}, so open a new terminal first"
        return Requirement(target.ros, is_met=False, text=text, fix=f"source {setup}")
    text = f"not installed; {others}" if others else "not installed"
    fix = apt_install(target) if can_install else _container(target)
    return Requirement(target.ros, is_met=False, text=text, fix=fix)


def _packages(machine: Machine, target: Target) -> Requirement:
    """Check ROS packages; metapackages are not checked, as they may leave no file."""
    wanted = [name for name in ros_packages(target) if name not in VARIANTS]
    wanted.append(target.programs["package"])
    prefixes = ros_prefixes(machine, target.distro)
    missing = [
        name
        for name in wanted
        if not any((prefix / "share" / name / "package.xml").is_file() for prefix in prefixes)
    ]
    names = " ".join(debian_name(name, target.distro) for name in missing)
    return Requirement(
        "ROS packages",
        is_met=not missing,
        text=f"missing: {', '.join(missing)}" if missing else ", ".join(wanted),
        fix=f"sudo apt install {names}" if missing else "",
    )


def _gazebo(machine: Machine, target: Target, *, can_install: bool) -> Requirement:
    if target.simulator == "classic":
        found = machine.find("gazebo")
    elif target.distro in RELEASED_FOR["gz_sim_vendor"]:
        # A ROS package since Jazzy; `gz` is on the PATH once ROS is sourced.
        found = next(
            (
                str(prefix)
                for prefix in ros_prefixes(machine, target.distro)
                if (prefix / "share" / "gz_sim_vendor" / "package.xml").is_file()
            ),
            None,
        )
    else:
        found = machine.find("ign")  # the name of its program up to Fortress
    if found:
        return Requirement(target.gazebo, is_met=True, text=found)
    name = debian_name(SIMULATOR_PACKAGES[target.simulator], target.distro)
    fix = f"sudo apt install {name}" if can_install else ""
    return Requirement(target.gazebo, is_met=False, text="missing", fix=fix)


def _colcon(machine: Machine, *, can_install: bool) -> Requirement:
    found = machine.find("colcon")
    if found:
        return Requirement("colcon", is_met=True, text=found)
    fix = f"sudo apt install {COLCON}" if can_install else ""
    text = "not on the PATH; `wsgen build` uses its own"
    return Requirement("colcon", is_met=False, text=text, fix=fix)


def _setup_file(machine: Machine, target: Target) -> Path:
    return machine.root / "opt" / "ros" / target.distro / "setup.bash"


def _container(target: Target) -> str:
    return f'docker run -it --rm -v "$PWD":/ws -w /ws {image(target)}'


class DoctorReport(NamedTuple):
    """What a machine has and lacks for a target."""

    target: Target
    notes: tuple[str, ...]  # a sentence each
    wsgen: tuple[Requirement, ...]  # of wsgen's own commands, without ROS
    ros: tuple[Requirement, ...]  # of ROS alone
    apt: str  # the command that installs what steps 1 and 2 of the tutorial install

    @property
    def takes_apt(self) -> bool:
        """Whether the target's packages are made for this machine's system."""
        return any(one.name == SYSTEM and one.is_met for one in self.ros)

    @property
    def passed(self) -> bool:
        """Whether `wsgen new`, `build` and `validate` can run on the machine."""
        return all(one.is_met or not one.is_required for one in self.wsgen)


def check_machine(machine: Machine, target: Target, *, today: str) -> DoctorReport:
    """Compare a machine with a target; `today` (YYYY-MM-DD) decides what has reached its end."""
    notes = [end_of_life_note(target, today)]
    if not machine.environment.get("PATH"):
        notes.append("PATH is empty, so no program was found.")
    return DoctorReport(
        target=target,
        notes=tuple(filter(None, notes)),
        wsgen=tuple(check_wsgen(machine)),
        ros=tuple(check_ros(machine, target)),
        apt=apt_install(target),
    )
