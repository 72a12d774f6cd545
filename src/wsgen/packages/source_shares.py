"""Let the source folder of a package that is not built serve as its share folder.

A child that evaluates launch files or xacro finds packages by AMENT_PREFIX_PATH alone. It is given
a prefix for each such package, as colcon would install it; the share folder in it is a link to the
source. What the child answers names the source instead.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping


INSTALLED = "WSGEN_INSTALLED_PREFIX"  # in the environment: a prefix of serve_installed()
VARIABLE = "WSGEN_SOURCE_PREFIXES"  # in the environment: the folder of these prefixes
USED = ".used"  # in a prefix of serve_sources(): a file that who looks the package up leaves
BUILD_FOLDERS = frozenset({"__pycache__", "build", "install", "log"})  # names
SEPARATOR = r"[/\\]"  # of folders; Windows has both
INDEX = "share/ament_index/resource_index/packages"  # below a prefix


def serve_sources(
    sources: Mapping[str, Path], folder: Path, environment: Mapping[str, str]
) -> dict[str, str]:
    """Write a prefix for each package into a folder; the environment with them on the path."""
    prefixes = [environment.get("AMENT_PREFIX_PATH", "")]
    for package, source in sources.items():
        serve_source(folder / package, package, source)
        prefixes.append(str(folder / package))
    path = os.pathsep.join(filter(None, prefixes))
    return {**environment, "AMENT_PREFIX_PATH": path, VARIABLE: str(folder)}


def serve_source(prefix: Path, package: str, source: Path) -> None:
    """Let a source folder serve as the share folder of a package in a prefix."""
    _announce(prefix, package, str(source))
    _link(f"{prefix}/share/{package}", source)


def note_use(package: str, environment: Mapping[str, str]) -> None:
    """Remember that somebody looked a package up, if it is one whose source is served.

    It may be any process that has the environment.
    """
    folder = environment.get(VARIABLE)
    if folder is not None:
        with suppress(OSError):  # it is none of those
            Path(folder, package, USED).touch()


def is_used(package: str, environment: Mapping[str, str]) -> bool:
    """Whether somebody looked up a package whose source is served; see `note_use`."""
    folder = environment.get(VARIABLE)
    return folder is not None and Path(folder, package, USED).exists()


def _announce(prefix: Path, package: str, text: str) -> None:
    """Write the marker of a package."""
    index = os.path.join(prefix, INDEX)  # noqa: PTH118  of many packages
    os.makedirs(index, exist_ok=True)  # noqa: PTH103
    with open(f"{index}/{package}", "w", encoding="utf-8") as marker:  # noqa: PTH123
        marker.write(text)


def _link(place: str, folder: Path) -> None:
    try:
        os.symlink(folder, place, target_is_directory=True)  # noqa: PTH211
    except OSError as error:
        if not hasattr(error, "winerror"):  # Windows lets only administrators make links
            raise
        from _winapi import CreateJunction  # type: ignore[attr-defined]  # noqa: PLC0415

        CreateJunction(str(folder), place)


def serve_installed(  # noqa: PLR0913  what a package installs
    prefix: Path,
    package: str,
    source: Path,
    *,
    files: Iterable[tuple[str, Path | None]],
    programs: Iterable[tuple[str, Path | None]],
    modules: Iterable[tuple[str, Path]],
    is_whole: bool,
) -> None:
    """Lay a package out in a prefix as its build would install it, with links to its files.

    Args:
        prefix: a folder, which may hold other packages.
        package: its name.
        source: its folder.
        files: paths below the prefix, and the file at each; None of one that the build makes,
            which is left out.
        programs: names in lib/PACKAGE, and their source; None of those that are compiled.
        modules: Python modules by their path below the prefix, and their source.
        is_whole: whether these are all. If not, what else the source has is there, too.
    """
    _announce(prefix, package, "" if is_whole else str(source))
    share = f"share/{package}/"
    known: set[str] = set()
    os.makedirs(prefix / share, exist_ok=True)  # noqa: PTH103  of many files
    runnable = prefix / ".program"  # stands for what is compiled
    if not runnable.exists():
        runnable.touch(mode=0o755)
    places: list[tuple[str, Path]] = [
        *((path, file) for path, file in files if file is not None and path.startswith(share)),
        *(
            (f"lib/{package}/{name}", file if file and os.access(file, os.X_OK) else runnable)
            for name, file in programs
        ),
        *modules,
        *(() if is_whole else _files_below(source, share)),
    ]
    for path, file in places:
        folder = os.path.dirname(path)  # noqa: PTH120  of many files
        if folder not in known:
            os.makedirs(prefix / folder, exist_ok=True)  # noqa: PTH103
            known.add(folder)
        with suppress(FileExistsError):  # installed twice
            os.symlink(file, f"{prefix}/{path}")  # noqa: PTH211


def _files_below(source: Path, share: str) -> Iterator[tuple[str, Path]]:
    """The files of a source folder, by their paths in the share folder; not those of builds."""
    for folder, names, files in os.walk(source):
        names[:] = filter(may_have_sources, names)
        below = os.path.relpath(folder, source)
        for file in files:
            yield os.path.normpath(f"{share}{below}/{file}"), Path(folder, file)


def may_have_sources(folder: str) -> bool:
    """Whether a folder with this name may have sources: it is not hidden, nor made by a build."""
    return not folder.startswith(".") and folder not in BUILD_FOLDERS


def is_source(path: str) -> bool:
    """Whether a path is in the share folder of a package that is not built: in its source."""
    folder = os.environ.get(VARIABLE)
    if folder is not None and Path(folder) in Path(path).parents:
        return True
    prefix = os.environ.get(INSTALLED)
    if prefix is None or not path.startswith(f"{prefix}/"):
        return False
    package = path[len(prefix) + 1 :].split("/")[1:2]
    try:
        return bool(package) and bool(Path(prefix, INDEX, package[0]).read_text(encoding="utf-8"))
    except OSError:
        return False


def name_sources(answer: Any, environment: Mapping[str, str]) -> Any:
    """The answer of a child, as JSON gives it, with the source folders in place of the links.

    The `share` of a prefix, which model paths name, becomes the folder that the source lies in, if
    that has it under the name of the package.
    """
    folder = environment.get(VARIABLE)
    if folder is None:
        return answer
    words = [*map(re.escape, re.split(SEPARATOR, folder)), r"([\w-]+)", rf"share({SEPARATOR}\1)?"]
    prefix = re.compile(SEPARATOR.join(words) + r"(?![\w-])")

    def name_source(found: re.Match[str]) -> str:
        source = Path(Path(folder, found[1], INDEX, found[1]).read_text(encoding="utf-8"))
        if found[2]:
            return str(source)
        return str(source.parent) if source.name == found[1] else found[0]

    def name(part: Any) -> Any:
        if isinstance(part, str):
            return prefix.sub(name_source, part)
        if isinstance(part, list):
            return [name(one) for one in part]
        if isinstance(part, dict):
            return {key: name(value) for key, value in part.items()}
        return part

    return name(answer)
