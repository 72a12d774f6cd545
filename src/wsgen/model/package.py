"""The specification of a package: everything that its files are made from.

The name of a package becomes a folder, a CMake project, often a CMake target, a Python module and a
C++ namespace. REP-144 gives the mandatory form; the tables below are the names of that form that
one of the others cannot be.
"""

from __future__ import annotations

import re
import unicodedata
from keyword import kwlist
from typing import TYPE_CHECKING

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from wsgen.model.target import Target

    ShareOf = Callable[[str], Path | None]  # package name -> its installed share folder


# What a variable of a template is set to: a number, an integer, a boolean or a text.
Answer = float | str


@dataclass(frozen=True, kw_only=True)
class Maintainer:
    """Who answers for a package."""

    name: str  # one line
    email: str  # of the form that package_common.xsd asks for


@dataclass(frozen=True, kw_only=True)
class PackageSpec:
    """A package before it is written."""

    name: str  # after REP-144
    description: str  # may have several lines
    maintainer: Maintainer
    license: str  # SPDX identifier
    template: str  # its name
    target: Target
    answers: Mapping[str, Answer]  # the template's variables
    # Element of package.xml, for example "exec_depend" -> packages; both in the order of the file.
    dependencies: Mapping[str, tuple[str, ...]]
    # Names in the simulator that robots of other packages of the workspace have.
    taken_entities: frozenset[str] = frozenset()


MINIMUM_LENGTH = 2
# Builds append to the name (NAME__rosidl_typesupport_fastrtps_cpp.so, ament_index markers, Debian
# packages), and file names end at 255 bytes; the lines of a launch file end at 99 columns.
MAXIMUM_LENGTH = 64


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


# Targets that CMake and CTest make themselves (policy CMP0037), and ament's: a project may have
# such a name, but `add_executable(${PROJECT_NAME} ...)` in it fails.
CMAKE_TARGETS = _words(
    "all clean continuous depend edit_cache experimental help install list_install_components "
    "nightly package package_source rebuild_cache test uninstall"
)
# Words of C++ (those that are Python's as well are in `kwlist`): generated messages live in a
# namespace of the package's name.
CPP_KEYWORDS = _words(
    "alignas alignof auto bool case catch char class compl concept const constexpr default delete "
    "do double enum explicit export extern false float friend goto inline int long mutable "
    "namespace new noexcept nullptr operator private protected public register requires short "
    "signed sizeof static struct switch template this throw true typedef typeid typename union "
    "unsigned using virtual void volatile"
)
# Folders of colcon and of its users' .gitignore: a package of this name would not be committed.
COLCON_FOLDERS = _words("build log")
# Windows cannot have a file of this name, whatever its ending: nobody there can check it out.
WINDOWS_DEVICES = frozenset(
    ["con", "prn", "aux", "nul"]
    + [f"{port}{number}" for port in ("com", "lpt") for number in "123456789"]
)
PYTHON_KEYWORDS = frozenset(word.lower() for word in kwlist)

_RESERVED = (
    (CMAKE_TARGETS, "is a target that CMake keeps for itself"),
    (PYTHON_KEYWORDS, "is a keyword of Python, which could not import a module of this name"),
    (CPP_KEYWORDS, "is a keyword of C++, which could not have a namespace of this name"),
    (COLCON_FOLDERS, "is a folder that colcon makes and that version control ignores"),
    (WINDOWS_DEVICES, "is a device on Windows, where no folder can have this name"),
)


def check_package_name(name: str) -> str | None:
    """The rule that the name breaks, as the end of a sentence that begins with it; None if none.

    The rules are the mandatory ones of REP-144 (lower-case ASCII letters, digits and underscores,
    a letter first, no two underscores in a row, two characters or more), that of
    package_format3.xsd (no underscore last), and those of this module's tables.
    """
    return next(_broken_rules(name), None)


def _broken_rules(name: str) -> Iterator[str]:
    if not name:
        yield "is empty"
    if "/" in name or "\\" in name:
        yield "is a path: a name has no slashes, and --workspace says where the package goes"
    if not re.fullmatch(r"[a-z0-9_]*", name):
        yield "may have only the lower-case letters a to z, digits and underscores (REP-144)"
    if not name[:1].isalpha():
        yield "must start with a letter (REP-144)"
    if len(name) < MINIMUM_LENGTH:
        yield f"must have at least {MINIMUM_LENGTH} characters (REP-144)"
    if "__" in name:
        yield "may not have two underscores in a row (REP-144)"
    if name.endswith("_"):
        yield "may not end with an underscore (package_format3.xsd)"
    if len(name) > MAXIMUM_LENGTH:
        yield f"is longer than {MAXIMUM_LENGTH} characters: names of files are made of it"
    yield from (why for words, why in _RESERVED if name in words)


def suggest_package_name(name: str) -> str:
    """A name close to `name` that breaks no rule."""
    # The last part of a path, without what an operating system puts around it.
    plain = re.split(r"[/\\]", name.rstrip("/\\"))[-1]
    # é -> e; letters that have no ASCII base fall out below.
    plain = unicodedata.normalize("NFKD", plain).encode("ascii", "ignore").decode()
    plain = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", plain).lower()
    plain = re.sub(r"[^a-z0-9]+", "_", plain).strip("_")
    if not plain:
        return "my_robot"
    if not plain[0].isalpha():
        plain = f"robot_{plain}"
    plain = plain[:MAXIMUM_LENGTH].rstrip("_")
    return plain if check_package_name(plain) is None else f"{plain}_robot"
