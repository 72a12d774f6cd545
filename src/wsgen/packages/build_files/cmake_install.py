"""The commands of CMake and of ament that install files."""

from __future__ import annotations

import os
import posixpath
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.packages.build_files.cmake_text import (
    UNQUOTED,
    Argument,
    InstallRule,
    read_text,
    sections,
)
from wsgen.packages.build_files.cmake_values import BUILD, PREFIX, UNKNOWN, is_known
from wsgen.text.suggestions import nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from wsgen.packages.build_files.cmake import Reader
    from wsgen.packages.build_files.cmake_text import Mention


# cmake-install(1): where a TYPE goes without GNUInstallDirs -> its variable.
TYPES = {
    "BIN": ("BINDIR", "bin"),
    "SBIN": ("SBINDIR", "sbin"),
    "LIB": ("LIBDIR", "lib"),
    "INCLUDE": ("INCLUDEDIR", "include"),
    "SYSCONF": ("SYSCONFDIR", "etc"),
    "SHAREDSTATE": ("SHARESTATEDIR", "com"),
    "LOCALSTATE": ("LOCALSTATEDIR", "var"),
    "RUNSTATE": ("RUNSTATEDIR", "var/run"),
    "DATA": ("DATADIR", "share"),
    "INFO": ("INFODIR", "share/info"),
    "LOCALE": ("LOCALEDIR", "share/locale"),
    "MAN": ("MANDIR", "share/man"),
    "DOC": ("DOCDIR", "share/doc"),
}
FORMS = frozenset(
    (
        *("TARGETS", "FILES", "PROGRAMS", "DIRECTORY", "SCRIPT", "CODE", "EXPORT", "PACKAGE_INFO"),
        *("IMPORTED_RUNTIME_ARTIFACTS", "RUNTIME_DEPENDENCY_SET", "EXPORT_ANDROID_MK", "SBOM"),
    )
)
SIMILAR = 0.75  # so alike, as difflib counts, are a form and the one that it misspells
KINDS = frozenset({"DIRECTORY", "FILES", "PROGRAMS"})
# Each with the number of arguments that follow it; -1: all up to the next keyword.
KEYWORDS = {
    "COMPONENT": 1,
    "CONFIGURATIONS": -1,
    "DESTINATION": 1,
    "DIRECTORY_PERMISSIONS": -1,
    "EXCLUDE": 0,
    "EXCLUDE_FROM_ALL": 0,
    "FILES_MATCHING": 0,
    "FILE_PERMISSIONS": -1,
    "MESSAGE_NEVER": 0,
    "OPTIONAL": 0,
    "PATTERN": 1,
    "PERMISSIONS": -1,
    "REGEX": 1,
    "RENAME": 1,
    "TYPE": 1,
    "USE_SOURCE_PERMISSIONS": 0,
}


def meant_form(word: str) -> str:
    """The form of install() that a word names, also by a misspelling; else the word."""
    return word if word in FORMS else nearest(word, FORMS, cutoff=SIMILAR) or word


def _install(reader: Reader, mention: Mention) -> None:
    kind = meant_form(mention.arguments[0].text) if mention.arguments else ""
    if kind in KINDS:
        _install_files(reader, mention, kind, mention.arguments[1:])
    elif kind == "TARGETS":
        _install_targets(reader, mention)
    elif kind in {"CODE", "SCRIPT"}:
        reader.is_whole = False


def _install_files(reader: Reader, mention: Mention, kind: str, words: Sequence[Argument]) -> None:
    names: list[Argument] = []
    given: dict[str, list[Argument]] = {}
    patterns: list[tuple[str, str, bool]] = []
    remaining, taker = 0, ""
    for word in words:
        is_keyword = word.kind == UNQUOTED and word.text in KEYWORDS
        if is_keyword and not (remaining > 0):
            taker, remaining = word.text, KEYWORDS[word.text]
            given.setdefault(taker, [])
            if taker == "EXCLUDE" and patterns:
                patterns[-1] = (*patterns[-1][:2], True)
        elif remaining:
            remaining -= 1
            given[taker].append(word)
            if taker in {"PATTERN", "REGEX"}:
                patterns.append((taker, word.text, False))
        elif not taker:
            names.append(word)
    place = next(iter(given.get("DESTINATION", ())), None)
    destination = None if place is None else place.text
    if given.get("TYPE"):
        place = given["TYPE"][0]
        destination = _folder_of_type(reader, place.text)
    rename = given.get("RENAME") or []
    _add_rule(
        reader,
        mention,
        kind,
        ((name, reader.path_of(name.text)) for name in names),
        destination,
        place=place,
        is_optional="OPTIONAL" in given or "CONFIGURATIONS" in given,
        rename=rename[0].text if rename else "",
        patterns=tuple(patterns),
        matching_only="FILES_MATCHING" in given,
        runnable=_runnable(kind, given),
    )


def _runnable(kind: str, given: Mapping[str, list[Argument]]) -> str:
    permissions = [*given.get("PERMISSIONS", ()), *given.get("FILE_PERMISSIONS", ())]
    if any(word.text.endswith("_EXECUTE") for word in permissions):
        return "all"
    if "USE_SOURCE_PERMISSIONS" in given:
        return "source"
    return "all" if kind == "PROGRAMS" and not permissions else "none"


def _folder_of_type(reader: Reader, name: str) -> str:
    key, folder = TYPES.get(name, ("", UNKNOWN))
    found = reader.variables.get(f"CMAKE_INSTALL_{key}")
    if name == "DOC" and found is None:
        return f"share/doc/{reader.look_up('', 'PROJECT_NAME')}"
    return found or folder


_ARTIFACTS = frozenset(
    {
        *("ARCHIVE", "LIBRARY", "RUNTIME", "OBJECTS", "FRAMEWORK", "BUNDLE", "PRIVATE_HEADER"),
        *("PUBLIC_HEADER", "RESOURCE", "FILE_SET", "INCLUDES", "CXX_MODULES_BMI"),
    }
)


def _install_targets(reader: Reader, mention: Mention) -> None:
    names: list[Argument] = []
    places: dict[str, Argument] = {}
    artifact, is_first = "", True
    words = mention.arguments[1:]
    for position, word in enumerate(words):
        if word.text in _ARTIFACTS:
            artifact, is_first = word.text, False
        elif word.text == "DESTINATION":
            is_first = False
            if position + 1 < len(words):
                places.setdefault(artifact, words[position + 1])
        elif word.text in {"EXPORT", "COMPONENT", "OPTIONAL", "PERMISSIONS", "CONFIGURATIONS"}:
            is_first = False
        elif is_first:
            names.append(word)
    for name in names:
        target = reader.targets.get(name.text)
        kind = target.kind if target else ""
        mark_installed(reader, name.text)
        if not is_known(name.text) or kind in {"interface", "object"}:
            continue
        artifact = {"executable": "RUNTIME", "static": "ARCHIVE"}.get(kind, "LIBRARY")
        default = "bin" if kind == "executable" else "lib"
        place = places.get(artifact) or places.get("")
        _add_rule(
            reader,
            mention,
            "TARGETS",
            [(name, _file_of(reader, name.text, kind))],
            place.text if place else default,
            place=place,
            rename=kind,
            runnable="all",
        )


def _file_of(reader: Reader, target: str, kind: str) -> str:
    name = reader.outputs.get(target, target)
    if UNKNOWN in name or kind == "executable":
        return name
    return f"lib{name}.a" if kind == "static" else f"lib{name}.so"


def _add_rule(
    reader: Reader,
    mention: Mention,
    kind: str,
    names: Iterable[tuple[Argument, str]],
    destination: str | None,
    **more: Any,
) -> None:
    """Note that a call installs; `more` are other fields of the rule."""
    reader.rules.append(
        InstallRule(
            kind=kind,
            names=tuple(names),
            destination=destination,
            file=mention.file,
            call=mention.call,
            folder=reader.folder,
            is_certain=mention.is_certain,
            in_tests=mention.in_tests,
            **more,
        )
    )


def _auto_package(reader: Reader, mention: Mention) -> None:
    """ament_auto_package() installs the targets, include/, and folders that it is given."""
    project = reader.look_up("", "PROJECT_NAME")
    _, found = sections(
        mention.arguments, {"INSTALL_TO_PATH", "INSTALL_TO_SHARE", "USE_SCOPED_HEADER_INSTALL_DIR"}
    )
    folder = "bin" if "INSTALL_TO_PATH" in found else f"lib/{project}"
    first = Argument("", UNQUOTED, mention.call.line)
    for name, target in [*reader.targets.items()]:
        if target.in_tests or target.kind in {"interface", "object"}:
            continue
        if target.kind == "executable" or target.kind in {"shared", "static", "module"}:
            file = _file_of(reader, name, target.kind)
            place = folder if target.kind == "executable" else "lib"
            mark_installed(reader, name)
            _add_rule(
                reader,
                mention,
                "TARGETS",
                [(first, file)],
                place,
                rename=target.kind,
                runnable="all",
            )
    for word in found.get("INSTALL_TO_SHARE", ()):
        path = reader.path_of(word.text)
        _add_rule(reader, mention, "DIRECTORY", [(word, path)], f"share/{project}")


def _python_package(reader: Reader, mention: Mention) -> None:
    first, found = sections(
        mention.arguments,
        {"VERSION", "PACKAGE_DIR", "SETUP_CFG", "DESTINATION", "SCRIPTS_DESTINATION"}
        | {"SKIP_COMPILE"},
    )
    for name in first[:1]:
        folder = (found.get("PACKAGE_DIR") or [name])[0]
        _add_rule(reader, mention, "PYTHON", [(name, reader.path_of(folder.text))], "python")
        if found.get("SETUP_CFG") and found.get("SCRIPTS_DESTINATION"):
            reader.is_whole = False


def _python_module(reader: Reader, mention: Mention) -> None:
    for name in mention.arguments[:1]:
        _add_rule(reader, mention, "PYTHON", [(name, reader.path_of(name.text))], "python")


def _plugin_description(reader: Reader, mention: Mention) -> None:
    """pluginlib_export_plugin_description_file(BASE FILE): the path stays as it is."""
    project = reader.look_up("", "PROJECT_NAME")
    for name in mention.arguments[1:2]:
        folder = os.path.dirname(name.text)
        place = f"share/{project}/{folder}" if folder and folder[:1] != "/" else f"share/{project}"
        _add_rule(reader, mention, "FILES", [(name, reader.path_of(name.text))], place)


def _environment_hooks(reader: Reader, mention: Mention) -> None:
    """ament_environment_hooks(): what .dsv and .sh files put in front of paths."""
    project = reader.look_up("", "PROJECT_NAME")
    for word in mention.arguments:
        text = read_text(Path(reader.path_of(word.text))) if is_known(word.text) else None
        for variable, path in _HOOK.findall(text or ""):
            place = path.removeprefix("$AMENT_CURRENT_PREFIX/").removeprefix(
                "$COLCON_CURRENT_PREFIX/"
            )
            place = place.replace("@PROJECT_NAME@", project)
            if not re.search(r"[$@]|^/", place):
                reader.environment.append((variable, place))


# A line of a .dsv file, or one of a .sh file that calls a function of ament.
_HOOK = lazy_pattern(
    r"""(?mx)^\s*(?:prepend-non-duplicate(?:-if-exists)?;|ament_\w+_unique_value\s+)
    (\w+)(?:;|\s+)["']?([^"'\n;]*?)["']?\s*$"""
)


def _interfaces(reader: Reader, mention: Mention) -> None:
    project = reader.look_up("", "PROJECT_NAME")
    for name in mention.arguments[1:]:
        match = re.search(r"(?:^|/)(msg|srv|action)/[^/]+\.\1$", name.text)
        if match:
            path = reader.path_of(name.text)
            _add_rule(reader, mention, "FILES", [(name, path)], f"share/{project}/{match[1]}")
    reader.has_foreign = True


def _catkin_python(reader: Reader, mention: Mention) -> None:
    words = mention.arguments
    if words and words[0].text == "PROGRAMS":
        _install_files(reader, mention, "PROGRAMS", words[1:])


def _xacro_files(reader: Reader, mention: Mention) -> None:
    """xacro_add_files(): FILE... [INSTALL] [DESTINATION FOLDER] TARGET NAME; without .xacro."""
    project = reader.look_up("", "PROJECT_NAME")
    files: list[Argument] = []
    given: dict[str, str] = {}
    keyword = ""
    for word in mention.arguments:
        if word.text in {"INORDER", "INSTALL", "OUTPUT", "TARGET", "DESTINATION", "REMAP"}:
            keyword = word.text
            given.setdefault(keyword, "")
        elif keyword == "REMAP":
            continue
        elif keyword in {"OUTPUT", "TARGET", "DESTINATION"}:
            given[keyword], keyword = word.text, ""
        else:
            files.append(word)
    for file in files if "INSTALL" in given else ():
        made = given.get("OUTPUT") or os.path.basename(file.text).removesuffix(".xacro")
        place = f"share/{project}/{given.get('DESTINATION', '')}".rstrip("/")
        _add_rule(reader, mention, "FILES", [(file, f"{BUILD}/{made}")], place)


def mark_installed(reader: Reader, name: str) -> None:
    """Remember that a target is installed."""
    target = reader.targets.get(name)
    if target is not None:
        reader.targets[name] = replace(target, is_installed=True)


def relative_destination(text: str) -> str | None:
    """A destination relative to the prefix; None if it is not known, or elsewhere."""
    if not is_known(text) or "$<" in text:
        return None
    path = posixpath.normpath(text) if text else "."
    if path.startswith(PREFIX):
        path = path[len(PREFIX) :].lstrip("/") or "."
    return None if path.startswith(("/", "..")) else "" if path == "." else path


COMMANDS: dict[str, Callable[[Reader, Mention], None]] = {
    "install": _install,
    "ament_auto_package": _auto_package,
    "ament_python_install_package": _python_package,
    "ament_python_install_module": _python_module,
    "pluginlib_export_plugin_description_file": _plugin_description,
    "ament_environment_hooks": _environment_hooks,
    "rosidl_generate_interfaces": _interfaces,
    "catkin_install_python": _catkin_python,
    "xacro_add_files": _xacro_files,
}
