"""The variables that the programs of one package get while colcon builds it without ROS.

colcon sets AMENT_PREFIX_PATH to the dependencies that package.xml declares. Without ROS that is
often nothing, and scripts and xacro files that look for a package fail. Here it also names the
packages of the workspace that are built already, and the sources of the package itself; `colcon
test` gets those packages alone.
"""

from __future__ import annotations

import os
import shutil
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.building.toolchain import INDEX, Wheels, find_toolchain
from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Iterator, MutableMapping

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
