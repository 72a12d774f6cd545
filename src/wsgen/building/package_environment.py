"""The variables that the programs of one package get while colcon builds it without ROS.

colcon sets AMENT_PREFIX_PATH to the dependencies that package.xml declares. Without ROS that is
often nothing, and scripts and xacro files that look for a package fail. Here it also names the
packages of the workspace that are built already, and the sources of the package itself; `colcon
test` gets those packages alone.

Also the commands of ROS that a CMakeLists.txt runs: `xacro`, and of `ros2` what needs no ROS. The
scripts in `ros_prefix/bin` call them, in processes that CMake, make or ninja start, and that do
without colcon.
"""

from __future__ import annotations

import os
import shutil
import sys
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.building.toolchain import INDEX, Wheels, find_toolchain
from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Iterator, MutableMapping, Sequence

    from colcon_core.package_descriptor import PackageDescriptor
    from colcon_core.package_identification.ignore import IgnorePackageIdentification


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
    from colcon_core.package_identification.ignore import (  # noqa: PLC0415
        IgnorePackageIdentification,
    )

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
