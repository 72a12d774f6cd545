"""Find CMake, Python and ament_cmake for a build.

A sourced ROS is used as it is, with its own Python. Otherwise ament_cmake comes from the wheels
that wsgen depends on, and CMake must use the interpreter of their environment. Both also work if
the virtual environment is not activated.

The wheels of ament_cmake are for Linux on x86-64, but what is used of them are CMake files. For
other machines pip brings them into a folder of their own, with FETCH_OPTIONS.

Also the variables that the programs of one package get while colcon builds it without ROS. colcon
sets AMENT_PREFIX_PATH to the dependencies that package.xml declares. Without ROS that is often
nothing, and scripts and xacro files that look for a package fail. Here it also names the packages
of the workspace that are built already, and the sources of the package itself; `colcon test` gets
those packages alone. The scripts in `ros_prefix/bin`, which CMake, make or ninja start, call the
commands of ROS here: `xacro`, and of `ros2` what needs no ROS.

colcon loads this module at the start of every command, so it imports little.
"""

from __future__ import annotations

import os
import shutil
import sys
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.errors import NotFoundError
from wsgen.text.files import read_regular_text
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, MutableMapping, Sequence

    from colcon_core.package_descriptor import PackageDescriptor
    from colcon_core.package_identification.ignore import IgnorePackageIdentification


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


# The prefix of the sources and the one to install to, with a colon between them.
SOURCE_PREFIX = "WSGEN_SOURCE_PREFIX"
FOLDER = "source_prefix"  # in the build folder of the package
EXECUTOR = "COLCON_DEFAULT_EXECUTOR"
IN_ORDER = "WSGEN_IN_ORDER"  # in the environment: the user has not chosen this executor


def set_package_environments(environ: MutableMapping[str, str]) -> None:
    """Have colcon run the programs of a package with these variables, if `environ` is without ROS.

    Packages are then built one after the other, so that each finds those before it; arguments,
    files of defaults and EXECUTOR itself are stronger. Call it before colcon loads its build tasks,
    which copy the function that is replaced, and reads EXECUTOR.
    """
    try:
        if not isinstance(find_toolchain(environ), Wheels):
            return
    except NotFoundError:
        return
    if EXECUTOR not in environ:
        environ.update({EXECUTOR: "sequential", IN_ORDER: "1"})
    import colcon_core.executor  # noqa: PLC0415  its constants are of use without colcon
    import colcon_core.shell  # noqa: PLC0415

    job_of_task: ContextVar[Any] = ContextVar("job_of_task", default=None)
    run_job = colcon_core.executor.Job.__call__
    get_environment = colcon_core.shell.get_command_environment

    async def run_and_remember(job: Any, *arguments: Any, **keywords: Any) -> Any:
        job_of_task.set(job)
        return await run_job(job, *arguments, **keywords)

    async def get_more(task_name: str, build_base: Any, dependencies: Any) -> Any:
        environment = await get_environment(task_name, build_base, dependencies)
        job = job_of_task.get()
        if job is not None and hasattr(job.task_context.args, "install_base"):
            _add_prefixes(
                environment,
                job.task_context.pkg,
                job.task_context.args,
                is_test=task_name == "test",
            )
        return environment

    colcon_core.executor.Job.__call__ = run_and_remember
    colcon_core.shell.get_command_environment = get_more


def _add_prefixes(environment: Any, package: Any, arguments: Any, *, is_test: bool) -> None:
    install = Path(arguments.install_base)
    given = environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    is_isolated = install.name == package.name
    built = _built_prefixes(install.parent if is_isolated else install)
    if is_test:  # about what is installed
        prefixes = (str(install), *filter(None, given), *map(str, built))
        environment["AMENT_PREFIX_PATH"] = os.pathsep.join(dict.fromkeys(prefixes))
        return
    sources = _link_sources(package.name, Path(arguments.path), Path(arguments.build_base))
    prefixes = (str(sources), *filter(None, given), *map(str, built))
    environment["AMENT_PREFIX_PATH"] = os.pathsep.join(dict.fromkeys(prefixes))
    environment[SOURCE_PREFIX] = f"{sources}{os.pathsep}{install}"


def _link_sources(name: str, folder: Path, build_folder: Path) -> Path:
    """Make a prefix whose share folder of the package is the folder of its sources."""
    prefix = build_folder / FOLDER
    marker = prefix / INDEX / name
    marker.parent.mkdir(parents=True, exist_ok=True)
    marker.touch()
    link = prefix / "share" / name
    if link.is_symlink():
        link.unlink()
    elif link.exists():  # the workspace was copied, and its links with what they stand for
        shutil.rmtree(link)
    link.symlink_to(folder.absolute())
    return prefix


def _built_prefixes(install: Path) -> Iterator[Path]:
    """List the install space itself, where it is merged, and those of its packages."""
    for prefix in (install, *(sorted(install.iterdir()) if install.is_dir() else ())):
        if (prefix / INDEX).is_dir():
            yield prefix


def ignore_python_environments() -> None:
    """Keep colcon from searching for packages in environments of Python, in this process.

    Who has just installed wsgen into a folder `venv` of the workspace would build ament_cmake,
    whose wheels have manifests. colcon asks its extension for COLCON_IGNORE first in each folder.
    """
    from colcon_core.package_identification import IgnoreLocationException  # noqa: PLC0415  see above
    from colcon_core.package_identification.ignore import IgnorePackageIdentification  # noqa: PLC0415

    ignores = IgnorePackageIdentification.identify

    def identify(self: IgnorePackageIdentification, desc: PackageDescriptor) -> None:
        ignores(self, desc)
        # Every command of colcon loads this module, and some look for no packages.
        from wsgen.packages.workspace.layout import is_python_environment  # noqa: PLC0415

        try:
            names = [path.name for path in Path(desc.path).iterdir()]
        except OSError:  # colcon says so, or passes it over
            return
        if is_python_environment(names):
            raise IgnoreLocationException

    IgnorePackageIdentification.identify = identify


RUN_XACRO = ["run", "xacro", "xacro"]


def run_xacro(arguments: Sequence[str]) -> int:
    """Do what `xacro` does, and return the exit code.

    `$(find ...)` of the package that is built finds its sources, as it is not installed yet. The
    output has the paths that it will be installed to instead.
    """
    from wsgen.descriptions.xacro.expansion import run_command  # noqa: PLC0415  `ros2` needs it seldom

    sources, _, installed = os.environ.get(SOURCE_PREFIX, "").partition(os.pathsep)
    result = run_command(
        ["xacro", *arguments],
        rewrite=lambda text: text.replace(sources, installed) if sources else text,
    )
    sys.stdout.write(result.stdout)
    sys.stderr.write(result.stderr)
    error = result.error or {}
    if error.get("file"):  # for `wsgen.building.causes`: xacro itself names no line
        place = f"{os.path.abspath(error['file'])}:{error.get('line') or ''}"  # noqa: PTH100  links
        sys.stderr.write(f"xacro: {place}: {error['message']}\nxacro: {error.get('hint', '')}\n")
    return result.code


def run_ros2(arguments: Sequence[str]) -> int:
    """Do what `ros2 run xacro xacro` does, and return the exit code; refuse anything else."""
    if [*arguments[:3]] == RUN_XACRO:
        return run_xacro(arguments[3:])
    sys.stderr.write(
        f"error: ros2 {' '.join(arguments)}: ROS is not sourced; without it a build can run "
        f"`ros2 {' '.join(RUN_XACRO)}` alone.\n"
    )
    return 1
