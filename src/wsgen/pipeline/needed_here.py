"""Which packages are about this machine: what they say depends on more than files that can be sent.

A path that is written out, the home folder and programs that a launch file starts are those of the
machine that evaluates it.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.pipeline.reached_packages import WORDS, texts_below
from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping


# Not after a variable, another path or the scheme of an address; `file://` alone comes before one.
_PATH = re.compile(rb"(?:file://|(?<![\w.:$})\]/~*!<-]))(/[\w.+@-]+(?:/[\w.+@-]+)+)")
_AT_HOME = re.compile(rb"~(/[\w.+@-]+)")
_ABOVE = re.compile(rb"(?<![\w.])(?:\.\./)+[\w.+@-]+(?:/[\w.+@-]+)*")
_MACHINE = re.compile(
    rb"\b(?:subprocess|os\.system|os\.popen|shutil\.which|Path\.home|HOME|gethostname|getuser)\b"
)
_MODEL = re.compile(rb"(?:model|package)://([\w.-]+)")
_ADDRESS = re.compile(rb"https?://[^\s<>\"']+/models/[^\s<>\"']+")
# What nobody evaluates, and what is compiled.
_UNREAD = frozenset(
    (
        *(".c", ".cc", ".cpp", ".css", ".cxx", ".h", ".hh", ".hpp", ".html", ".js", ".md", ".rst"),
        *(".rviz", ".sh", ".bash", ".zsh", ".tex", ".txt"),
    )
)
_FOLDERS = 2  # of a path; where these exist, its diagnostics may name them


@dataclass(frozen=True, kw_only=True)
class Texts:
    """What the files of a package name."""

    words: frozenset[bytes]
    models: frozenset[str]  # in addresses: of models and packages
    addresses: frozenset[str]  # of models in Gazebo's library
    # Absolute paths that do not exist; where they do, the package is another one.
    paths: frozenset[str]
    is_of_machine: bool

    def with_(self, other: Texts) -> Texts:
        """What the files of both packages name, which have one name."""
        return Texts(
            words=self.words | other.words,
            models=self.models | other.models,
            addresses=self.addresses | other.addresses,
            paths=self.paths | other.paths,
            is_of_machine=self.is_of_machine or other.is_of_machine,
        )


def read_texts(folder: Path, roots: tuple[str, ...]) -> Texts:
    """Read the files of a package; `roots` are folders that are sent, real paths with a slash."""
    words: set[bytes] = set()
    models: set[bytes] = set()
    addresses: set[bytes] = set()
    paths: set[str] = set()
    is_of_machine = False
    for file, text in texts_below(folder):
        words.update(WORDS.findall(text))
        models.update(_MODEL.findall(text))
        addresses.update(_ADDRESS.findall(text))
        if file.suffix in _UNREAD and file.name != "CMakeLists.txt":
            continue
        found = {os.fsdecode(path) for path in _PATH.findall(text)}
        at_home = (f"{Path.home()}{os.fsdecode(path)}" for path in _AT_HOME.findall(text))
        paths |= found
        is_of_machine = (
            is_of_machine
            or _MACHINE.search(text) is not None
            or any(map(exists, found))
            or any(map(os.path.lexists, at_home))
            or any(_is_outside(file, os.fsdecode(path), roots) for path in _ABOVE.findall(text))
        )
    return Texts(
        words=frozenset(words),
        models=frozenset(os.fsdecode(name) for name in models),
        addresses=frozenset(os.fsdecode(one) for one in addresses),
        paths=frozenset(paths),
        is_of_machine=is_of_machine,
    )


def exists(path: str) -> bool:
    """Whether a path exists, or the folders that it begins with."""
    return os.path.lexists(path) or os.path.lexists(Path(*Path(path).parts[: _FOLDERS + 1]))


def _is_outside(file: Path, path: str, roots: tuple[str, ...]) -> bool:
    """Whether a path relative to the folder of a file leads to something that is not sent."""
    place = os.path.realpath(file.parent / path)
    return os.path.exists(place) and not f"{place}/".startswith(roots)  # noqa: PTH110


def find_needed_here(texts: Mapping[str, Texts], marked: Collection[str]) -> frozenset[str]:
    """The packages that are about this machine, and those that name one of them, and so on.

    Args:
        texts: of all packages, by name.
        marked: names of packages that are, for another reason.
    """
    names = {name.encode(): name for name in texts}
    named_by: dict[str, set[str]] = {name: set() for name in texts}
    for name, one in texts.items():
        for word in one.words & names.keys():
            named_by[names[word]].add(name)
    waiting = [*marked, *(name for name, one in texts.items() if one.is_of_machine)]
    needed: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed.add(name)
            waiting += named_by.get(name, ())
    return frozenset(needed)
