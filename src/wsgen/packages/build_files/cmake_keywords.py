"""The keywords of commands of CMake and ament, and which of them a misspelled word means."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.text.suggestions import misspelled_as
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

_VISIBILITY = ("PUBLIC", "PRIVATE", "INTERFACE")
KEYWORDS: dict[str, Sequence[str]] = {
    "add_library": (
        *("SHARED", "STATIC", "MODULE", "OBJECT", "INTERFACE", "ALIAS", "IMPORTED"),
        "EXCLUDE_FROM_ALL",
    ),
    "ament_auto_package": ("INSTALL_TO_PATH", "INSTALL_TO_SHARE"),
    "find_package": (
        *("REQUIRED", "COMPONENTS", "OPTIONAL_COMPONENTS", "QUIET", "CONFIG", "EXACT", "MODULE"),
        *("NAMES", "PATHS", "HINTS", "NO_MODULE", "NO_DEFAULT_PATH"),
    ),
    "install": (
        *("TARGETS", "FILES", "PROGRAMS", "DIRECTORY", "SCRIPT", "CODE", "EXPORT", "TYPE"),
        *("DESTINATION", "COMPONENT", "CONFIGURATIONS", "PERMISSIONS", "FILE_PERMISSIONS"),
        *("DIRECTORY_PERMISSIONS", "USE_SOURCE_PERMISSIONS", "OPTIONAL", "PATTERN", "REGEX"),
        *("EXCLUDE", "EXCLUDE_FROM_ALL", "FILES_MATCHING", "MESSAGE_NEVER", "RENAME"),
        *("ARCHIVE", "LIBRARY", "RUNTIME", "OBJECTS", "INCLUDES", "NAMESPACE", "FILE"),
        *("PUBLIC_HEADER", "PRIVATE_HEADER", "RESOURCE", "FRAMEWORK", "BUNDLE", "FILE_SET"),
    ),
    "project": ("VERSION", "LANGUAGES", "DESCRIPTION", "HOMEPAGE_URL"),
    "rosidl_generate_interfaces": ("DEPENDENCIES", "LIBRARY_NAME", "SKIP_INSTALL"),
    "target_include_directories": (*_VISIBILITY, "SYSTEM", "BEFORE", "AFTER"),
    "target_link_libraries": _VISIBILITY,
}
_WORD = lazy_pattern(r"[A-Z][A-Z_]{3,}")


def meant_keyword(command: str, word: str, *, folders: Collection[str] = ()) -> str | None:
    """The keyword that an unquoted word of a call surely means; None if it is one or none.

    A name in one of the folders, which paths are relative to, is none.
    """
    known = KEYWORDS.get(command, ())
    if word in known or not known or not _WORD.fullmatch(word):
        return None
    if any(os.path.lexists(os.path.join(folder, word)) for folder in folders):
        return None
    return misspelled_as(word, known)


def word_keyword(command: str, word: str) -> str:
    """Say that CMake does not know the word."""
    return f"{command}() has no keyword {word}."
