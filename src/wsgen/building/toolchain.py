"""Find CMake, Python and ament_cmake for a build.

A sourced ROS is used as it is, with its own Python. Otherwise ament_cmake comes from the wheels
that wsgen depends on, and CMake must use the interpreter of their environment. Both also work if
the virtual environment is not activated.

The wheels of ament_cmake are for Linux on x86-64, but what is used of them are CMake files. For
other machines pip brings them into a folder of their own, with FETCH_OPTIONS.

colcon loads this module at the start of every command, so it imports little.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.text.files import read_regular_text
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, MutableMapping


INDEX = "share/ament_index/resource_index/packages"  # with a file for each package of a prefix
AMENT_CMAKE = Path("share", "ament_cmake", "cmake", "ament_cmakeConfig.cmake")
ROS_PREFIX = Path(__file__).with_name("ros_prefix")  # stands in for packages of ROS
FETCHED = Path("share", "wsgen", "ament_cmake")  # below a prefix: wheels for another machine
# pip takes wheels for another machine into a folder only. There it leaves out what ament_cmake runs
# tests with, so the packages for tests are not asked for: packages are then built without tests.
FETCH_OPTIONS = ("--only-binary", ":all:", "--platform", "manylinux_2_28_x86_64", "--target")
FETCHED_WHEELS = ("ros-ament-cmake", "ros-ament-cmake-include-directories")
MAKE_PROGRAMS = ("gmake", "make", "smake")  # the names CMake looks for


@dataclass(frozen=True, kw_only=True)
class SourcedRos:
    """A ROS whose setup file was sourced."""

    prefix: Path  # the entry of AMENT_PREFIX_PATH with ament_cmake

    def environment(self, environ: Mapping[str, str]) -> dict[str, str]:
        """Return the variables for the build: those given, without wsgen's own Python.

        An isolated virtual environment cannot see what the Python code of ROS imports, and CMake
        would take its interpreter because VIRTUAL_ENV or PATH names it.
        """
        variables = dict(environ)
        scripts = str(Path(sys.prefix, "bin"))
        if _is_isolated(sys.prefix):
            path = [entry for entry in _split(environ, "PATH") if not _same(entry, scripts)]
            variables["PATH"] = os.pathsep.join(path)
            if _same(variables.get("VIRTUAL_ENV", ""), sys.prefix):
                del variables["VIRTUAL_ENV"]
        if shutil.which("cmake", path=variables.get("PATH")) is None:
            _choose_cmake(variables)  # that of the wheel
        return variables


@dataclass(frozen=True, kw_only=True)
class Wheels:
    """The ament_cmake that pip installed with wsgen."""

    prefix: Path  # with share/ament_cmake

    def environment(self, environ: Mapping[str, str]) -> dict[str, str]:
        """Return the variables for the build: those given, with these prefixes and this Python."""
        variables = dict(environ)
        added = [str(ROS_PREFIX), str(self.prefix)]
        scripts = [f"{prefix}/bin" for prefix in added]
        path = [entry for entry in _split(environ, "PATH") if entry not in scripts]
        variables["PATH"] = os.pathsep.join([*scripts, *path])
        # At the end: prefixes of the user come first. AMENT_PREFIX_PATH would be the natural
        # variable, but colcon warns about every entry without a local_setup file.
        prefixes = [entry for entry in _split(environ, "CMAKE_PREFIX_PATH") if entry not in added]
        variables["CMAKE_PREFIX_PATH"] = os.pathsep.join([*prefixes, *added])
        _choose_python(variables)
        _choose_cmake(variables)
        if not any(shutil.which(name, path=variables["PATH"]) for name in MAKE_PROGRAMS):
            # CMake ignores it if the build folder has a generator already.
            variables.setdefault("CMAKE_GENERATOR", "Ninja")
        return variables


Toolchain = SourcedRos | Wheels


def find_toolchain(environment: Mapping[str, str]) -> Toolchain:
    """Find the ament_cmake to build with.

    Raises:
        NotFoundError: neither a sourced ROS nor the wheels have ament_cmake.
    """
    for prefix in map(Path, _split(environment, "AMENT_PREFIX_PATH")):
        if (prefix / AMENT_CMAKE).is_file():
            return SourcedRos(prefix=prefix)
    for prefix in _installation_prefixes():
        for place in (prefix, prefix / FETCHED):
            if (place / AMENT_CMAKE).is_file():
                return Wheels(prefix=place)
    raise _not_found()


def fetch_arguments(system: str, architecture: str) -> tuple[str, ...] | None:
    """Return the arguments of pip that bring ament_cmake where `pip install wsgen` does not.

    Args:
        system: as sys.platform.
        architecture: as platform.machine().

    Returns:
        None on Linux on x86-64, which needs nothing more, and on Windows, where wsgen does not
        build.
    """
    if system == "win32" or (system, architecture) == ("linux", "x86_64"):
        return None
    return ("install", *FETCH_OPTIONS, str(_writable_prefix() / FETCHED), *FETCHED_WHEELS)


def use_toolchain(environment: MutableMapping[str, str]) -> None:
    """Change the variables in place; without a toolchain they stay as they are."""
    try:
        wanted = find_toolchain(environment).environment(environment)
    except NotFoundError:
        return
    for name in environment.keys() - wanted.keys():
        del environment[name]
    environment.update(wanted)


def package_prefixes(toolchain: Toolchain, environment: Mapping[str, str]) -> tuple[Path, ...]:
    """List the prefixes in which CMake finds packages, in CMake's order, each once."""
    variables = toolchain.environment(environment)
    programs = [Path(entry) for entry in _split(variables, "PATH")]
    prefixes = [
        *(Path(entry) for entry in _split(variables, "CMAKE_PREFIX_PATH")),
        *(Path(entry) for entry in _split(variables, "AMENT_PREFIX_PATH")),
        *(folder.parent for folder in programs if folder.name in {"bin", "sbin"}),
        Path("/usr/local"),
        Path("/usr"),
    ]
    return tuple(dict.fromkeys(prefixes))


def _installation_prefixes() -> Iterator[Path]:
    """Yield the prefixes pip may have installed into, that of the interpreter first."""
    yield Path(sys.prefix)
    for entry in map(Path, sys.path):
        # <prefix>/lib/python3.12/site-packages: those of --user and of /usr/local too
        if entry.name in {"site-packages", "dist-packages"}:
            yield entry.parents[2]


def _writable_prefix() -> Path:
    """Return the first prefix into which this user may install, or that of `pip install --user`."""
    for prefix in _installation_prefixes():
        if os.access(prefix, os.W_OK):
            return prefix
    import site  # noqa: PLC0415  who needs it waits for pip anyway

    return Path(site.getuserbase())


def _not_found() -> NotFoundError:
    import platform  # noqa: PLC0415  5 ms that only this error pays
    import shlex  # noqa: PLC0415  as above

    found = "ament_cmake was not found: no ROS is sourced, and "
    arguments = fetch_arguments(sys.platform, platform.machine())
    if arguments is not None:
        return NotFoundError(
            f"{found}pip installs it by itself only on Linux on x86_64. Its wheels hold CMake "
            "files, which work here, too.",
            hint=shlex.join([sys.executable, "-m", "pip", *arguments]),
        )
    if sys.platform == "win32":
        return NotFoundError(
            f"{found}wsgen does not build on Windows; all other commands work.",
            hint="Build in the Windows Subsystem for Linux (wsl --install), with wsgen in it.",
        )
    return NotFoundError(
        f"{found}it is not installed with wsgen.",
        hint="Install wsgen with pip, which also installs ament_cmake, or source a ROS "
        "(source /opt/ros/<distro>/setup.bash).",
    )


def _choose_python(variables: dict[str, str]) -> None:
    """Make FindPython of CMake use the running interpreter."""
    if sys.prefix != sys.base_prefix:
        variables["VIRTUAL_ENV"] = sys.prefix
    else:
        # Another active environment must not take precedence.
        variables.pop("VIRTUAL_ENV", None)
        for name in ("Python3_ROOT_DIR", "Python_ROOT_DIR"):
            variables.setdefault(name, sys.prefix)


def _choose_cmake(variables: dict[str, str]) -> None:
    """Name the binaries of the cmake wheel, unless the user chose others.

    The wheel's console scripts start a Python interpreter for each call, and colcon calls CMake
    four times for a package.
    """
    for entry in filter(None, sys.path):
        binaries = Path(entry, "cmake", "data", "bin")
        if (binaries / "cmake").is_file():
            variables.setdefault("CMAKE_COMMAND", str(binaries / "cmake"))
            variables.setdefault("CTEST_COMMAND", str(binaries / "ctest"))
            return


def _is_isolated(prefix: str) -> bool:
    """Whether it is a virtual environment that does not see the packages of the system."""
    try:
        text = read_regular_text(Path(prefix, "pyvenv.cfg"))
    except OSError:
        return False
    settings = (line.partition("=") for line in text.lower().splitlines())
    return ("include-system-site-packages", "true") not in {
        (key.strip(), value.strip()) for key, _, value in settings
    }


def _split(environment: Mapping[str, str], name: str) -> list[str]:
    return [entry for entry in environment.get(name, "").split(os.pathsep) if entry]


def _same(first: str, second: str) -> bool:
    return os.path.normpath(first) == os.path.normpath(second)
