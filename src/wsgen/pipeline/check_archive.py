"""What the checks of packages read, as an archive for machines that have nothing of it.

That is the packages, what they name of other install spaces and of Gazebo's folders, and what links
lead to.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.executors.archive import Archive
from wsgen.files import read_regular, real_path
from wsgen.launch.known_packages import ALL_PREFIXES
from wsgen.pipeline.needed_here import find_needed_here, read_texts
from wsgen.pipeline.reached_packages import SIZE_LIMIT, WORDS, texts_below
from wsgen.sdf.lookup import (
    AROUND,
    CACHES,
    GAZEBO_PREFIXES,
    MODEL_PATHS,
    SEARCH_PATHS,
    find_in_cache,
    is_folder,
)
from wsgen.source_shares import INDEX
from wsgen.workspace.layout import INSTALL_LAYOUT, find_packages

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from wsgen.pipeline.check_targets import Targets
    from wsgen.pipeline.needed_here import Texts
    from wsgen.workspace.layout import PackageFolder


# Folders that no check looks into. A `.git` is there, empty: some look for it.
UNREAD = ("__pycache__",)
# Variables that are sent, beside those that the packages name; others may be secrets.
OF_ROBOTS = (
    *("AMENT_", "COLCON_", "GAZEBO_", "GZ_", "IGN_", "LANG", "LC_", "PYTHON", "RMW_", "ROS_"),
    "WSGEN_",
)
OF_USERS = frozenset({"HOME", "LOGNAME", "PATH", "PWD", "SHELL", "TZ", "USER"})
OF_FOLDERS = (  # each may name several
    *("AMENT_PREFIX_PATH", "PYTHONPATH"),
    *CACHES,
    *dict.fromkeys((*MODEL_PATHS, *SEARCH_PATHS)),
)
WORLDS = ("*.world", "*.sdf")
_OF_SHELLS = re.compile(r"\.(?:bash|cmake|dsv|ps1|sh|zsh)$")  # these name all dependencies


class Header(NamedTuple):
    """What a worker is to know beside the files; paths are those of this machine."""

    packages: tuple[str, ...]  # folders, in the order of the calls
    installed: tuple[str, ...]  # likewise, after them: share folders
    prefixes: tuple[str, ...]
    files: tuple[str, ...]
    workspaces: tuple[str, ...]
    paths: tuple[tuple[str, ...], ...]  # of each call: what does not exist here
    folder: str  # the current one
    scratch: str  # where the packages are laid out
    distro: str | None
    environment: tuple[tuple[str, str], ...]


class CheckArchive:
    """The archive, and which packages are about this machine."""

    def __init__(self, targets: Targets, environment: Mapping[str, str]) -> None:
        """Collect it.

        Raises:
            RequestError: It is too much.
        """
        self.files = Archive()
        self._targets = targets
        self._environment = environment
        self._packages = {
            one.path: one
            for one in (
                *targets.packages,
                *(one for place in targets.workspaces for one in find_packages(place)),
            )
        }
        for package in self._packages.values():
            self._add_package(package)
        self._texts = self._read_texts()
        self._words = frozenset(word for one in self._texts.values() for word in one.words)
        self._models = frozenset(name for one in self._texts.values() for name in one.models)
        self._add_surroundings()
        _Prefixes(self._targets, environment).add(self.files, self._words, self._models)
        self._add_models()
        self._needed_here = find_needed_here(self._texts, [*self._marked()])

    def is_sendable(self, package: PackageFolder) -> bool:
        """Whether a package is not about this machine."""
        return package.name not in self._needed_here

    def header(
        self, packages: Sequence[PackageFolder], distro: str | None, scratch: Path
    ) -> Header:
        """What workers are to know."""
        return Header(
            packages=tuple(str(one.path) for one in self._targets.packages),
            installed=tuple(str(one.path) for one in self._targets.installed),
            prefixes=tuple(map(str, self._targets.prefixes)),
            files=tuple(map(str, self._targets.files)),
            workspaces=tuple(str(one.root) for one in self._targets.workspaces),
            paths=tuple(tuple(sorted(self._texts[one.name].paths)) for one in packages),
            folder=str(Path.cwd()),
            scratch=real_path(scratch),
            distro=distro,
            environment=tuple(
                (name, value)
                for name, value in self._environment.items()
                if name in OF_USERS
                or name.startswith(OF_ROBOTS)
                or os.fsencode(name) in self._words
            ),
        )

    def _add_package(self, package: PackageFolder) -> None:
        self.files.add(package.path, skipped=(*UNREAD, ".git"))
        for folder, names, files in os.walk(package.path):
            if ".git" in (*names, *files):
                self.files.add_folder(f"{folder}/.git")
            names[:] = [name for name in names if not name.startswith(".")]

    def _read_texts(self) -> dict[str, Texts]:
        """What the files of each package name; of those that have one name, together."""
        roots = tuple(f"{real_path(path)}/" for path in self._packages)
        texts: dict[str, Texts] = {}
        for one in (*self._packages.values(), *self._targets.installed):
            found = read_texts(one.path, roots)
            known = texts.get(one.name)
            texts[one.name] = found if known is None else known.with_(found)
        return texts

    def _add_surroundings(self) -> None:
        """Folders that others are seen from, and worlds in the current one."""
        here = Path.cwd()
        self.files.add_folder(here)
        self._add_worlds(here)
        self.files.add_folder(self._environment.get("HOME") or here)
        for folder in _entries(OF_FOLDERS, self._environment):
            self.files.add_folder(folder)
        for workspace in self._targets.workspaces:
            self.files.add_folder(workspace.root)
            if (workspace.root / ".git").exists():
                self.files.add_folder(workspace.root / ".git")
            # Messages name the share folder of a package that is built.
            for one in self._packages.values():
                for prefix in (workspace.install / one.name, workspace.install):
                    for place in (prefix / "share" / one.name, prefix / "lib" / one.name):
                        if place.is_dir():
                            self.files.add_folder(place)

    def _add_worlds(self, folder: Path) -> None:
        for place in (folder, folder / "worlds"):
            for pattern in WORLDS:
                for file in place.glob(pattern):
                    self.files.add(file)

    def _add_models(self) -> None:
        """The models that are named: around the packages, in Gazebo's folders, in its cache."""
        for folder in dict.fromkeys(self._model_folders()):
            for name in self._models:
                place = folder / name
                if is_folder(place) and not any(
                    one.is_relative_to(place) for one in self._packages
                ):
                    self.files.add(place)
        for address in {one for texts in self._texts.values() for one in texts.addresses}:
            model = find_in_cache(address, self._environment)
            if model is not None:
                self.files.add(model)

    def _model_folders(self) -> Iterator[Path]:
        """Where models are looked for; the worlds beside them are added, and what names models."""
        for folder in _entries((*MODEL_PATHS, *SEARCH_PATHS), self._environment):
            self._add_worlds(folder)
            yield folder
        home = self._environment.get("HOME")
        if home:
            yield Path(home, ".gazebo", "models")
        # Many packages lie in one folder.
        above = [path.absolute().parents for path in self._packages]
        for around in dict.fromkeys(folder for folders in above for folder in folders[:AROUND]):
            for pattern in ("*/model.config", "models/*/model.config"):
                for file in around.glob(pattern):
                    self.files.add(file)
        for folder in dict.fromkeys(folder for folders in above for folder in folders[:-1]):
            yield from (folder, folder / "models", folder / "share")

    def _marked(self) -> Iterator[str]:
        """The packages with files that cannot be sent, or with models in folders of the system."""
        for path in self.files.left_out:
            of_packages = [
                one.name
                for one in self._packages.values()
                if path.startswith(f"{real_path(one.path)}/")
            ]
            # Of no package: who reads it names one of the folders that it is in.
            yield from of_packages or self._naming(path)
        for folder in _entries((*MODEL_PATHS, *SEARCH_PATHS), self._environment):
            if str(folder).startswith(GAZEBO_PREFIXES):
                there = {name for name in self._models if is_folder(folder / name)}
                yield from (name for name, one in self._texts.items() if one.models & there)

    def _naming(self, path: str) -> Iterator[str]:
        wanted = set(WORDS.findall(os.fsencode(path)))
        yield from (name for name, one in self._texts.items() if one.words & wanted)


class _Prefixes:
    """Other install spaces, and the folders of Python modules."""

    def __init__(self, targets: Targets, environment: Mapping[str, str]) -> None:
        self._whole = frozenset(one.path.name for one in targets.installed)
        self._prefixes = [
            prefix
            for prefix in (
                *targets.prefixes,
                *_entries(["AMENT_PREFIX_PATH"], environment),
                *Path(ALL_PREFIXES).glob("*/"),  # looked into where none is sourced
            )
            if (prefix / INDEX).is_dir()
        ]
        self._places: dict[str, list[Path]] = {}  # of a package: its folders
        for prefix in self._prefixes:
            for marker in (prefix / INDEX).iterdir():
                self._places.setdefault(marker.name, []).extend(
                    place
                    for place in (prefix / "share" / marker.name, prefix / "lib" / marker.name)
                    if place.exists()
                )
        for folder in _entries(["PYTHONPATH"], environment):
            for module in folder.iterdir() if folder.is_dir() else ():
                self._places.setdefault(module.name.partition(".")[0], []).append(module)

    def add(self, archive: Archive, words: Collection[bytes], models: Iterable[str]) -> None:
        """Add the packages that have one of these names or models, what they name, and so on."""
        for prefix in self._prefixes:
            archive.add(prefix / INDEX)
            for file in prefix.glob(INSTALL_LAYOUT):
                archive.add(file)
        waiting = {*self._whole, *self._named(words), *self._with_models(models)}
        added: set[str] = set()
        while waiting:
            name = waiting.pop()
            added.add(name)
            for place in self._places.get(name, ()):
                archive.add(place, skipped=UNREAD)
                waiting |= self._named(_words_below(place)) - added

    def _named(self, words: Iterable[bytes]) -> set[str]:
        return {name for word in words if (name := os.fsdecode(word)) in self._places}

    def _with_models(self, models: Iterable[str]) -> Iterator[str]:
        for name in models:
            for prefix in self._prefixes:
                share = prefix / "share"
                for place in (f"*/{name}", f"*/models/{name}"):
                    yield from (found.relative_to(share).parts[0] for found in share.glob(place))


def _entries(variables: Iterable[str], environment: Mapping[str, str]) -> list[Path]:
    """The folders that variables name, by absolute paths."""
    return [
        Path(entry)
        for variable in variables
        for entry in environment.get(variable, "").split(os.pathsep)
        if os.path.isabs(entry)  # noqa: PTH117  of a text that may be empty
    ]


def _words_below(place: Path) -> set[bytes]:
    """The words in what launch files and robots read of an installed package or module."""
    if place.is_file():
        return set(WORDS.findall(read_regular(place, SIZE_LIMIT)))
    return {
        word
        for file, text in texts_below(place)
        if file.name != "package.xml" and _OF_SHELLS.search(file.name) is None
        for word in WORDS.findall(text)
    }
