"""Packages checked by workers of Dask, which get all that a check reads and share no disk with us.

An archive has the packages, what they name of other install spaces and of Gazebo's folders, and
links with what they lead to. A worker unpacks it once, and has a child check one package a call. It
is checked as here, but for the paths, which are named as they are here. What is about this machine
is checked on it: `needed_here`.
"""

from __future__ import annotations

import os
import pickle
import shutil
import time
from concurrent.futures import wait
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Diagnostic, has_errors
from wsgen.errors import RequestError
from wsgen.events import OneAtATime, StepEnded, StepStarted, post
from wsgen.executors.archive import at, named_as_there, read_header, unpack
from wsgen.executors.child import ChildDiedError
from wsgen.executors.shared import share
from wsgen.files import remembering
from wsgen.isolation.child import scratch_folder, set_environment
from wsgen.isolation.codec import decode
from wsgen.isolation.parent import make_scratch
from wsgen.isolation.result import Limits
from wsgen.launch.evaluate import PROCESS_DIES, TAKES_TOO_LONG
from wsgen.launch.explain_missing import EXECUTABLE_NOT_FOUND, XACRO_FAILS
from wsgen.launch.explain_names import IMPORT_ERROR, RAISES
from wsgen.launch.known_packages import ALL_PREFIXES, PREFIXES
from wsgen.pipeline.check_archive import OF_FOLDERS, CheckArchive, Header
from wsgen.pipeline.check_package import PackageCheck
from wsgen.pipeline.check_targets import Targets
from wsgen.pipeline.installed_as_built import FOLDER, lay_out
from wsgen.pipeline.needed_here import exists
from wsgen.pipeline.parallel import WAKE_EVERY, start_children
from wsgen.values import dataclass
from wsgen.workspace.layout import Workspace, read_package

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.executors.dask_cluster import DaskExecutor
    from wsgen.executors.local import LocalExecutor
    from wsgen.isolation.parent import Run
    from wsgen.workspace.layout import PackageFolder


LIMITS = Limits(seconds=1800.0)  # of a package; what it starts has its own limits
OF_WORKER = ("LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "TMPDIR")  # without which it may not work
SURELY_OURS = 12  # letters of the path of an archive, which nobody else writes
# What may be wrong with the machine where the launch file is evaluated instead.
OF_MACHINE = frozenset(
    rule.code
    for rule in (
        EXECUTABLE_NOT_FOUND,
        IMPORT_ERROR,
        PROCESS_DIES,
        RAISES,
        TAKES_TOO_LONG,
        XACRO_FAILS,
    )
)


@dataclass(frozen=True, kw_only=True)
class Shipment:
    """An archive as a worker has it."""

    parts: tuple[Path, ...]


def check_remotely(  # noqa: PLR0913, PLR0917  what `check` has, and where to run it
    targets: Targets,
    distro: str | None,
    environment: Mapping[str, str],
    scratch: Path,
    sent: Path,
    executor: DaskExecutor | LocalExecutor,
    calls: Callable[[Run], Sequence[Callable[[], tuple[Diagnostic, ...]]]],
    serial: OneAtATime,
) -> list[tuple[Diagnostic, ...]]:
    """Have workers check the packages of `targets`, and what is about this machine be checked here.

    Args:
        targets: What is checked.
        distro: The target, where packages do not say it.
        environment: The variables of this process.
        scratch: The folder where packages are laid out.
        sent: A folder for the archive.
        executor: That of a cluster.
        calls: makes the calls for all packages and files in their order, to be run here.
        serial: receives the events.

    Raises:
        RequestError: This system is not one that workers can stand in for, or it is too much.
        NotReadableError: A file cannot be read, or the connection to the cluster is lost.
    """
    if os.name != "posix":
        raise RequestError(
            "`wsgen check --scheduler` cannot send files from this operating system.",
            hint="Omit `--scheduler`, or run it on Linux (WSL works, too).",
        )
    packages = (*targets.packages, *targets.installed)
    archive = CheckArchive(targets, environment)
    remote = {number for number, one in enumerate(packages) if archive.is_sendable(one)}
    shared = None
    if remote:
        header = archive.header(packages, distro, scratch)
        parts = archive.files.write(sent, pickle.dumps(tuple(header)))
        shared = share(Shipment(parts=parts), map(str, parts))
    results: dict[int, tuple[Diagnostic, ...]] = {}
    futures = {
        executor.submit(check_there, shared, number, limits=LIMITS): number
        for number in sorted(remote)
    }
    try:
        with start_children() as run:
            todo = _Todo(calls, run)
            for number in range(len(packages) + len(targets.files)):
                if number not in remote:
                    results[number] = todo.call(number)
            waiting = set(futures)
            while waiting:
                done, waiting = wait(waiting, timeout=WAKE_EVERY)
                for future in done:
                    number = futures[future]
                    found = _answer_of(future.result, packages[number], serial)
                    results[number] = todo.call(number) if found is None else found
    finally:
        for future in futures:
            future.cancel()
        serial.close()
    return [results[number] for number in sorted(results)]


class _Todo:
    """The calls for what is checked here, which are made with the first one."""

    def __init__(
        self, make: Callable[[Run], Sequence[Callable[[], tuple[Diagnostic, ...]]]], run: Run
    ) -> None:
        self._make = make
        self._run = run
        self._calls: Sequence[Callable[[], tuple[Diagnostic, ...]]] = ()

    def call(self, number: int) -> tuple[Diagnostic, ...]:
        """Run one of them."""
        self._calls = self._calls or self._make(self._run)
        return self._calls[number]()


def _answer_of(
    result: Callable[[], Any], package: PackageFolder, serial: OneAtATime
) -> tuple[Diagnostic, ...] | None:
    """What a worker says of a package; None if it is to be checked here."""
    try:
        answer = result()
    except ChildDiedError:
        return None
    if answer["found"] is None:
        return None
    found = decode(answer["found"], tuple[Diagnostic, ...])
    step, detail = (package.name, "check"), package.path.name
    post(serial, StepStarted(step=step, detail=detail))
    ended = StepEnded(
        step=step, succeeded=not has_errors(found), seconds=answer["seconds"], detail=detail
    )
    post(serial, ended)
    return found


class _Opened:
    """On a worker, in a child: an archive that is unpacked, and the packages in it."""

    def __init__(self, shipment: Shipment, stack: ExitStack) -> None:
        self.root = _unpacked(shipment.parts)
        self.header = Header(*pickle.loads(read_header(shipment.parts[0])))  # noqa: S301  wsgen wrote it
        os.chdir(at(self.root, self.header.folder))
        set_environment(self._environment())
        stack.enter_context(remembering())
        scratch = _as_long(scratch_folder() or Path.cwd(), self.header.scratch)
        stack.callback(shutil.rmtree, scratch / FOLDER, ignore_errors=True)
        self.targets = Targets(
            packages=tuple(self._packages(self.header.packages)),
            installed=tuple(self._packages(self.header.installed)),
            prefixes=tuple(at(self.root, path) for path in self.header.prefixes),
            files=tuple(at(self.root, path) for path in self.header.files),
            workspaces=tuple(
                Workspace(root=at(self.root, path)) for path in self.header.workspaces
            ),
        )
        self.installed = lay_out(self.targets, scratch, os.environ)
        self.run = stack.enter_context(start_children())
        self.work = stack.enter_context(make_scratch())

    def _packages(self, paths: Iterable[str]) -> Iterator[PackageFolder]:
        for path in paths:
            package = read_package(at(self.root, path))
            if package is None:
                raise FileNotFoundError(path)
            yield package

    def _environment(self) -> dict[str, str]:
        """The variables, with the folders of the archive in those that name folders."""
        variables = {
            name: value
            if name == "PATH"
            else os.pathsep.join(self._moved(name, entry) for entry in value.split(os.pathsep))
            for name, value in self.header.environment
        }
        own = {name: value for name in OF_WORKER if (value := os.environ.get(name)) is not None}
        return {**variables, **own, PREFIXES: f"{self.root}{ALL_PREFIXES}"}

    def _moved(self, name: str, entry: str) -> str:
        there = f"{self.root}{entry}"
        is_moved = name in OF_FOLDERS or os.path.lexists(there)
        return there if len(entry) > 1 and entry.startswith("/") and is_moved else entry


def _as_long(folder: Path, path: str) -> Path:
    """A folder whose path is as long as the given one, if it can be: messages may cut it."""
    folder = Path(os.path.realpath(folder))
    missing = len(path) - len(str(folder)) - 1
    if missing > 0:
        folder /= "_" * missing
        folder.mkdir(exist_ok=True)
    return folder


def _unpacked(parts: Sequence[Path]) -> Path:
    """The folder where an archive is unpacked, by the first child of the worker that needs it."""
    folder = Path(os.path.realpath(parts[0].parent))
    whole, part = folder / "files", folder / "unfinished"
    with (folder / "lock").open("w") as lock:
        if fcntl is not None:
            fcntl.flock(lock, fcntl.LOCK_EX)  # ends with a child that dies
        if not whole.is_dir():
            shutil.rmtree(part, ignore_errors=True)
            unpack(parts, part, as_if_in=whole)
            part.rename(whole)
    return whole


_opened: dict[tuple[Path, ...], tuple[_Opened, ExitStack]] = {}


def _open(shipment: Shipment) -> _Opened:
    known = _opened.get(shipment.parts)
    if known is None:
        while _opened:
            _, (_, stack) = _opened.popitem()
            stack.close()
        with ExitStack() as stack:  # closed if it cannot be opened
            opened = _Opened(shipment, stack)
            known = _opened[shipment.parts] = opened, stack.pop_all()
    return known[0]


def check_there(shipment: Shipment, number: int) -> dict[str, Any]:
    """On a worker, in a child: check one package.

    The answer has no diagnostics where another machine may say something else.
    """
    try:
        opened = _open(shipment)
    except OSError:  # of this machine: its disk is full, or it has removed the archive
        return {"found": None}
    if any(map(exists, opened.header.paths[number])):
        return {"found": None}
    started = time.perf_counter()
    package = (*opened.targets.packages, *opened.targets.installed)[number]
    found = PackageCheck(
        package, opened.installed, opened.header.distro, None, opened.run, opened.work
    ).run()
    if any(one.code in OF_MACHINE for one in found):
        return {"found": None}
    root = str(opened.root)
    named = [_named_as_there(one, root) for one in found]
    if any(root[:SURELY_OURS] in f"{one.message}{one.hint}{one.element}" for one in named):
        return {"found": None}  # a path is cut, and would be cut elsewhere here
    return {
        "found": named,
        "seconds": time.perf_counter() - started,
    }


def _named_as_there(found: Diagnostic, root: str) -> Diagnostic:
    named = partial(named_as_there, folder=root)
    return replace(
        found,
        message=named(found.message),
        file=found.file and Path(named(str(found.file))),
        element=found.element and named(found.element),
        hint=found.hint and named(found.hint),
    )
