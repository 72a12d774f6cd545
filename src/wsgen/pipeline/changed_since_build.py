"""Which installed files are copies of which sources, and which of them are older than these.

Which source an installed file is a copy of, the build files say: an edited node has no effect until
it is built again, wherever it is installed to. What the build makes has no such source.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.building.last_build import STARTED
from wsgen.diagnostics import Rule, Severity
from wsgen.packages.source_shares import may_have_sources
from wsgen.packages.workspace.layout import BUILD_MARKERS, read_package
from wsgen.packages.workspace.manifest import RUN_TAGS
from wsgen.text.files import list_files
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.model.plan import LaunchPlan
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.overlay import Overlay


NAMED = 5  # at most so many files are named in a message
# Where setuptools and ament_cmake_python put modules, below the prefix.
MODULE_FOLDERS = (
    "lib/python3*/site-packages",
    "lib/python3*/dist-packages",
    "local/lib/python3*/dist-packages",
    "Lib/site-packages",
)
STAMP = "package.sh"  # in the share folder; colcon writes it at the end of every build

CHANGED_SINCE_BUILD = Rule(
    code="PKG052",
    name="changed-since-build",
    severity=Severity.WARNING,
    summary="A source file was changed after the last build.",
    what="Compares installed files with newer sources: programs, Python modules, launch files, "
    "descriptions and other copied files. Links (`--symlink-install`) and files that the build "
    "generates are not checked.",
    why="`ros2 launch` and wsgen use the installed files: the change has no effect yet.",
    example="wsgen build\n$EDITOR src/my_robot/scripts/driver.py\nwsgen launch my_robot "
    "bringup.launch.py --run",
    instead="wsgen build\n$EDITOR src/my_robot/scripts/driver.py\nwsgen build\nwsgen launch "
    "my_robot bringup.launch.py --run",
)


def changed_since_build(share: Path, source: Path) -> Iterator[Diagnostic]:
    """Report sources of a package that differ from what is installed, and are newer.

    An installed file that is newer than that of its name may have been made by the build.
    """
    if share == source or not _may_differ(share, source):  # or the package is not built
        return
    copies_of = {
        origin.relative_to(source).as_posix(): installed
        for installed, origin, is_same in _copies(share, source)
        if origin.is_relative_to(source)
        and is_file(installed)
        and not is_same(origin, installed)
        and _is_newer(origin, installed)
    }
    if changed := sorted(copies_of):
        copies = "copies are" if changed[1:] else "copy is"
        yield CHANGED_SINCE_BUILD.at(
            source / changed[0],
            message=f"Changed since the last build: {some_of(changed, NAMED)}. "
            f"The older installed {copies} used.",
            # setuptools compares whole seconds: a build would leave what came with a clone.
            hint="Remove the folders build and install (they are as old as the sources, as in a "
            "clone), run `wsgen build`, then this command again."
            if _is_as_old(source / changed[0], copies_of[changed[0]])
            else "Run `wsgen build`, then this command again.",
        )


def shares_of(packages: Iterable[PackageFolder], overlay: Overlay) -> dict[Path, Path]:
    """The share folders of packages that are built, and the source of each."""
    found = ((overlay.share(one.name), one.path) for one in packages if not one.diagnostics)
    return {share: source for share, source in found if share is not None and share != source}


class InstalledSource(NamedTuple):
    """Where an installed file comes from."""

    path: Path
    is_link: bool = False  # the installed one is a link to it
    is_same: bool = True  # it holds what is installed


def source_of(file: Path, shares: Mapping[Path, Path]) -> InstalledSource | None:
    """What an installed file is a copy of, or a link to; None where it is of no package here.

    Args:
        file: As a traceback names it.
        shares: Of the packages of the workspace: share folder -> source.
    """
    if not file.is_absolute():  # "<string>"
        return None
    real = file.resolve()
    if real != file and any(real.is_relative_to(source) for source in shares.values()):
        return InstalledSource(real, is_link=True)
    for share, source in shares.items():
        if not file.is_relative_to(share.parent.parent):
            continue
        for installed, origin, is_same in _copies(share, source):
            if installed == file and is_file(origin):
                return InstalledSource(origin, is_same=is_same(origin, installed))
    return None


def used_packages(plan: LaunchPlan, shares: Mapping[Path, Path]) -> dict[Path, Path]:
    """The packages that a plan starts something of, reads files of, or looks up; with their needs.

    Args:
        plan: What a launch file starts.
        shares: Of the packages of the workspace: share folder -> source.
    """
    by_name = {share.name: share for share in shares}
    looked_up = (
        *(process.package for process in plan.processes),
        *(include.package for include in plan.includes),
        *(lookup.package for lookup in plan.lookups),
    )
    waiting = [plan.package, *looked_up]
    waiting += [
        name
        for name, share in by_name.items()
        if any(file.is_relative_to(share) for file in plan.evaluated_files)
    ]
    return with_needs((name for name in waiting if name), shares)


def with_needs(names: Iterable[str], shares: Mapping[Path, Path]) -> dict[Path, Path]:
    """The packages with these names, and those that they depend on: share folder -> source."""
    by_name = {share.name: share for share in shares}
    found: dict[Path, Path] = {}
    waiting = list(names)
    while waiting:
        share = by_name.pop(waiting.pop(), None)
        if share is None:
            continue
        found[share] = shares[share]
        package = read_package(shares[share])
        if package is not None and package.manifest is not None:
            waiting += package.manifest.names(RUN_TAGS)
    return found


def _may_differ(share: Path, source: Path) -> bool:
    """Whether a source has changed since the build began, which costs less than to compare it."""
    started = _build_started(share)
    if started is None:
        return True
    return any(
        one >= other
        for entry in _entries(source)
        for one, other in zip(_times(entry), started, strict=True)
    )


_Times = tuple[int, int]  # ns: of what a file holds, and when that came to this place


def _build_started(share: Path) -> _Times | None:
    """When the last build of a package began; None where that is not known.

    The end of the build is too late: a file may be saved after it was copied.
    """
    prefix = share.parent.parent
    folders = (one / "build" / share.name for one in (prefix.parent, prefix.parent.parent))
    first = next(filter(None, ([*folder.glob(STARTED)] for folder in folders)), [])
    times = [_times(file) for file in (share / STAMP, *first)]
    if not first or (0, 0) in times:  # removed, elsewhere, or another tool has built it
        return None
    return min(one for one, _ in times), min(other for _, other in times)


def _entries(folder: Path) -> Iterator[os.DirEntry[str]]:
    """The files of a source folder, and below it."""
    waiting = [os.fspath(folder)]
    while waiting:
        try:
            with os.scandir(waiting.pop()) as listed:
                entries = list(listed)
        except OSError:
            continue
        for entry in entries:
            if not entry.is_dir(follow_symlinks=False):
                yield entry
            elif may_have_sources(entry.name):
                waiting.append(entry.path)


def _times(entry: os.DirEntry[str] | Path) -> _Times:
    """Both, as `cp -p`, `rsync -a` and `unzip` give a file the time of another place."""
    try:
        found = entry.stat()
    except OSError:  # a dead link
        return 0, 0
    return found.st_mtime_ns, found.st_ctime_ns


_Copy = tuple[Path, Path, "Callable[[Path, Path], bool]"]


def _copies(share: Path, source: Path) -> Iterator[_Copy]:
    """Installed files, what each is a copy of, and what says whether the two are the same.

    What the build files do not say has the same path in the share folder as in the source, if it
    is a copy.
    """
    # Most packages are as they were built.
    from wsgen.packages.build_files.facts import read_build_facts  # noqa: PLC0415

    known: set[Path] = set()
    package = read_package(source)
    if package is not None and package.manifest is not None:
        prefix = share.parent.parent
        facts, _ = read_build_facts(source, package.name, package.build_type)
        known.update(prefix / one.destination for one in facts.installed)
        yield from _of_build_files(facts, prefix, prefix / "lib" / package.name, known)
    for entry in _entries(share):
        file = Path(entry.path)
        if file not in known:
            yield file, source / file.relative_to(share), is_copy


def _of_build_files(
    facts: BuildFacts, prefix: Path, programs: Path, known: Collection[Path]
) -> Iterator[_Copy]:
    """The copies that the build files of a package make; `known` are the installed files."""
    for one in facts.installed:
        if one.source is not None:
            yield prefix / one.destination, one.source, is_copy
    for program in facts.executables:
        if program.source is not None and programs / program.name not in known:
            yield programs / program.name, program.source, _is_script
    folders = [folder for pattern in MODULE_FOLDERS for folder in prefix.glob(pattern)]
    for module in facts.python_packages:
        for folder in folders:
            for installed, file in _modules(folder / module.name.replace(".", "/"), module.source):
                yield installed, file, is_copy


def _modules(installed: Path, source: Path) -> Iterator[tuple[Path, Path]]:
    """The files of a Python package, or a module."""
    if not source.is_dir():
        yield installed.with_suffix(source.suffix), source
        return
    for entry in _entries(source):
        file = Path(entry.path)
        yield installed / file.relative_to(source), file


def is_file(path: Path) -> bool:
    """Whether it is a file that can be looked at."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_copy(first: Path, second: Path) -> bool:
    """Whether a file is a copy of another one, or a link to it."""
    try:
        one, other = first.stat(), second.stat()
        if one.st_size != other.st_size:
            return False
        # CMake and setuptools give the installed file the time of the other.
        return one.st_mtime_ns == other.st_mtime_ns or first.read_bytes() == second.read_bytes()
    except OSError:
        return False


def _is_script(first: Path, second: Path) -> bool:
    """Whether one is made of the other by setuptools, which writes the first line anew."""
    try:
        one, other = first.read_bytes(), second.read_bytes()
    except OSError:
        return False
    is_headed = one.startswith(b"#!") and other.startswith(b"#!")
    return one.partition(b"\n")[2] == other.partition(b"\n")[2] if is_headed else one == other


def _is_newer(first: Path, second: Path) -> bool:
    try:
        return first.stat().st_mtime_ns > second.stat().st_mtime_ns
    except OSError:
        return False


def _is_as_old(first: Path, second: Path) -> bool:
    """Whether two files are of the same second."""
    try:
        return int(first.stat().st_mtime) == int(second.stat().st_mtime)
    except OSError:
        return False


def name_sources(
    diagnostics: Iterable[Diagnostic], sources: Mapping[Path, Path]
) -> Iterator[Diagnostic]:
    """Name the source file instead of its installed copy, where the two are equal.

    A change of the copy would be lost in the next build. `sources` are those of share folders.
    """
    for found in diagnostics:
        file = found.file
        yield found if file is None else replace(found, file=equal_source_of(file, sources))


def equal_source_of(file: Path, sources: Mapping[Path, Path]) -> Path:
    """The source of an installed file, or the file itself; see `name_sources`."""
    origins = (_origin_of(file, *one) for one in sources.items())
    return next((one for one in origins if one is not None), file)


def _origin(file: Path, share: Path, source: Path) -> Path | None:
    if not file.is_relative_to(share):
        return None
    origin = source / file.relative_to(share)
    return origin if origin.is_file() and file.is_file() else None


def _origin_of(file: Path, share: Path, source: Path) -> Path | None:
    """The source that equals an installed file: at its path, or the only one of its name."""
    if not file.is_relative_to(share) or share == source:
        return None
    at_its_path = _origin(file, share, source)
    if at_its_path is not None:
        return at_its_path if is_copy(at_its_path, file) else None
    named = [
        one
        for one in list_files(source, (os.path.normcase(file.name),), markers=BUILD_MARKERS)
        if one.name == file.name and file.is_file() and is_copy(one, file)
    ]
    return named[0] if len(named) == 1 else None
