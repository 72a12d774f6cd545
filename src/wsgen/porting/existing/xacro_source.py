"""Expand the xacro file of a source; with fixes, also one that needs what is not there."""

from __future__ import annotations

import itertools
import os
import re
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import Edit, apply, children, read_tags
from wsgen.descriptions.xacro.reader import expand_file
from wsgen.errors import NotReadableError
from wsgen.packages.source_shares import is_used, serve_sources
from wsgen.pipeline.file_validation import INCLUDE, read
from wsgen.porting.existing.catkin import siblings_of
from wsgen.porting.existing.launch_port import ENDINGS, is_of_ros_1
from wsgen.porting.existing.launch_values import UnsaidError, split_words
from wsgen.porting.existing.parameters_of_ros1 import files_in
from wsgen.porting.existing.resources import called_alike
from wsgen.porting.existing.sources import files_below
from wsgen.text.markup import read_text
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.porting.existing.sources import Source


_OF_XACRO = frozenset((".xacro", ".urdf", ".gazebo", ".xml"))
_FIND = re.compile(rb"\$\(find\s+([\w.-]+)\s*\)")
_INCLUDED = re.compile(
    rb"<xacro:include\s[^>]*?filename\s*=\s*[\"']\$\(find\s+([\w.-]+)\s*\)/+([^\"'$]+)[\"']"
)
_NAMED = re.compile(r"\$\(find\s+([\w.-]+)\s*\)")
_EMPTY = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>\n'
_ARGUMENT = re.compile(r"\$\(arg\s+(\S+?)\s*\)")
_UNDEFINED = re.compile(r"Undefined substitution argument (\S+?)\.$")
_UNKNOWN_MACRO = re.compile(r"unknown macro name: xacro:")
_NOT_FOUND = re.compile(r"the package '([\w.-]+)' is not found\.$")
_NO_FILE = re.compile(r"[Nn]o such file or directory: '([^']+)'")
_DEEPEST = 10  # arguments whose defaults name others
_LONGEST = 1000  # characters of a value


class Expanded(NamedTuple):
    """What a xacro file expands to."""

    text: str | None  # None: it cannot be expanded
    found: tuple[Diagnostic, ...]
    arguments: Mapping[str, str]  # those that are given, and those that a launch file gives
    fixes: tuple[str, ...] = ()  # sentences: what was left out
    notes: tuple[str, ...] = ()  # sentences: where other arguments are from


class _LookedUp(NamedTuple):
    """The packages that the xacro files of a source name by $(find)."""

    there: dict[str, Path]  # their folders
    missing: dict[str, set[str]]  # those that are nowhere, with what is included from them


def expand_source(
    source: Source,
    arguments: Mapping[str, str],
    environment: Mapping[str, str],
    scratch: Path,
    *,
    fixes: bool,
) -> Expanded:
    """Expand the file of a source.

    With fixes, what is included from packages that do not exist is left out, as long as nothing
    calls its macros; macros may be called above their definition; and arguments without a value get
    that of the launch file that gives them.
    """
    packages = _look_up(source)
    served = serve_sources(packages.there, scratch / "prefixes", environment)
    text, found = expand_file(source.file, arguments, environment=served)
    if text is not None:
        return Expanded(text, found, arguments)
    where, offered = _offered(source)
    given, moved, taken = dict(arguments), False, dict[str, str]()
    if fixes:
        served, taken = _serve_with_empty(packages, source, scratch, environment)
        text, later = expand_file(source.file, given, environment=served)
        while text is None and (name := _undefined(later)) in offered.keys() - given.keys():
            given[name] = offered[name]
            text, later = expand_file(source.file, given, environment=served)
        if text is None and _UNKNOWN_MACRO.search(later[-1].message):
            first = _with_macros_first(source.file, scratch)
            text, again = expand_file(first, given, environment=served)
            moved = text is not None
            later = again if moved else later
        # Without a package, the macros that it defines are missing next.
        is_same = _NOT_FOUND.search(found[-1].message) is not None and not _undefined(later)
        found = found if text is None and is_same else later
    if text is None:
        found = tuple(_advised(one, source, where, offered, fixes=fixes) for one in found)
        return Expanded(None, found, given)
    changed = [
        taken.get(name)
        or f"Left out what is included from the package `{name}`, which was not found."
        for name in packages.missing
        if is_used(name, served)
    ]
    if moved:
        changed.append("Moved the macros above their calls, as xacro read them before ROS Noetic.")
    notes = (
        f"Gave xacro the argument `{name}:={value}`, as {where} does."
        for name, value in given.items()
        if name not in arguments
    )
    return Expanded(text, found, given, tuple(changed), tuple(notes))


def _serve_with_empty(
    packages: _LookedUp, source: Source, scratch: Path, environment: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, str]]:
    """The environment with something in the place of packages that are nowhere.

    What they are to have is served from the source, where that has a file that is called so: the
    package was renamed, or its folder moved. Otherwise it is empty.

    Returns:
        The environment, and by package a sentence about what serves for it.
    """
    folders, taken = {}, dict[str, str]()
    for name, paths in packages.missing.items():
        folders[name] = scratch / "absent" / name
        alike = called_alike([f"{name}/{path}" for path in paths], source)
        for path in paths:
            parts, there = PurePosixPath(path).parts, alike.get(f"{name}/{path}")
            ends = () if there is None else zip(parts[::-1], there.parts[::-1], strict=False)
            same = sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], ends))
            if there is None or not same:
                continue
            of_source, link = there.parents[same - 1], folders[name].joinpath(*parts[:-same])
            if same == len(parts):
                folders[name] = of_source
            elif not os.path.lexists(link) and _is_inside(link, scratch):
                link.parent.mkdir(parents=True, exist_ok=True)
                link.symlink_to(of_source)
            taken[name] = f"Took {there.name} of the source for what the package `{name}`, which"
            taken[name] += " was not found, is to have."
        for file in (folders[name] / path for path in paths):
            if not file.exists() and _is_inside(file, scratch):
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(_EMPTY, encoding="utf-8")
    served = serve_sources({**packages.there, **folders}, scratch / "with-empty", environment)
    return served, taken


def _is_inside(file: Path, folder: Path) -> bool:
    """Whether a file would be written into a folder, and not where a link in it leads."""
    return Path(os.path.realpath(file)).is_relative_to(os.path.realpath(folder))


def _with_macros_first(file: Path, scratch: Path) -> Path:
    """A copy of a file whose macros are at its start, as it was read before ROS Noetic."""
    text = read_text(file) or ""
    tags = read_tags(text)
    root = next((one for one in tags if one.name == "robot"), None)
    edits, macros = list[Edit](), list[str]()
    for one in children(tags, root) if root is not None else ():
        named = one.attributes.get("filename")
        if one.name == "xacro:macro" and one.end is not None:
            macros.append(text[one.start.start : one.end.end])
            edits.append(Edit(start=one.start.start, end=one.end.end, text=""))
        elif one.name == "xacro:include" and named is not None and named.text[:1] not in {"$", "/"}:
            edits.append(
                Edit(start=named.value.start, end=named.value.start, text=f"{file.parent}/")
            )
    if root is not None:
        edits.append(Edit(start=root.start.end, end=root.start.end, text="\n".join(macros)))
    copy = scratch / "macros-first" / file.name
    copy.parent.mkdir(parents=True, exist_ok=True)
    copy.write_text(apply(text, edits), encoding="utf-8")
    return copy


def refuse_macros(source: Source, text: str) -> None:
    """Stop at a file that defines macros alone.

    Raises:
        NotReadableError: It does, and expands to this text, which has no link.
    """
    written = read_text(source.file) or ""
    macros = [one.attributes for one in read_tags(written) if one.name == "xacro:macro"]
    if "<link" in text or not macros or "name" not in macros[0]:
        return
    name = macros[0]["name"].text
    callers = _naming(source, re.compile(rf"<xacro:({name})\b".encode()), name)
    words = macros[0]["params"].text.split() if "params" in macros[0] else []
    given = "".join(f' {one}=""' for one in words if "=" not in one and "*" not in one)
    raise NotReadableError(
        f"{source.shown} defines the macro `{name}`, and calls none: it has no robot.",
        hint=f"Give a file that calls it: --from {callers[0]}"
        if callers
        else f"Write a file that includes this one, and <xacro:{name}{given}/>; give that.",
    )


def _naming(source: Source, pattern: re.Pattern[bytes], name: str = "") -> list[Path]:
    """The other xacro files of the source in which a pattern finds its file, or another name."""
    wanted = (name or source.file.name).encode()
    files = (one for one in files_below(source.roots[0]) if one.suffix == ".xacro")
    return [one for one in files if one != source.file and wanted in pattern.findall(read(one))]


def _look_up(source: Source) -> _LookedUp:
    """The packages of the source, and those that its xacro files, or theirs, look up."""
    found = _LookedUp({**source.packages}, {})
    folders = [source.roots[0]]
    for folder in folders:
        for file in files_below(folder):
            if file.suffix.lower() not in _OF_XACRO:
                continue
            data = read(file)
            for name in map(bytes.decode, _FIND.findall(data)):
                share = None if name in found.there else source.share_of(name)
                if share is not None:
                    found.there[name] = share
                    folders.append(share)
            for package, path in _INCLUDED.findall(data):
                name, inside = package.decode(), PurePosixPath(path.decode("utf-8", "replace"))
                if name not in found.there and ".." not in inside.parts:
                    found.missing.setdefault(name, set()).add(str(inside))
    return found


def _undefined(found: tuple[Diagnostic, ...]) -> str | None:
    """The argument without a value that xacro stopped at."""
    named = _UNDEFINED.search(found[-1].message) if found else None
    return named[1] if named else None


def _advised(
    one: Diagnostic, source: Source, where: str, offered: Mapping[str, str], *, fixes: bool
) -> Diagnostic:
    """The error with what to do about it here."""
    undefined, missing = _UNDEFINED.search(one.message), _NOT_FOUND.search(one.message)
    gone = _NO_FILE.search(one.message)
    if gone is not None and (alike := called_alike([gone[1]], source).get(gone[1])) is not None:
        return replace(one, hint=f"Write the name of {alike} instead.")
    if undefined is not None:
        name = undefined[1]
        if name in offered:
            hint = f"{where} gives it: add --arg {name}:={offered[name]}, or --fix."
            return replace(one, hint=hint)
        wholes = _naming(source, INCLUDE)
        more = f" Or give the file that includes this one: --from {wholes[0]}" if wholes else ""
        return replace(one, hint=f"Give it: add --arg {name}:=VALUE.{more}")
    if missing is not None:
        hint = f"Put the package `{missing[1]}` beside this one, or source a workspace that has it."
        more = (
            " What is included from it is used: it cannot be left out."
            if fixes
            else (" Or add --fix, which leaves out what is included from it if nothing uses that.")
        )
        return replace(one, hint=hint + more)
    is_below = not fixes and (one.hint or "").startswith("Move line")  # the macro that is called
    return replace(one, hint=f"{one.hint} Or add --fix, which does it.") if is_below else one


def _offered(source: Source) -> tuple[str, dict[str, str]]:
    """The launch file that expands the file of a source, and the arguments that it gives."""
    own = next(
        (name for name, one in source.packages.items() if source.file.is_relative_to(one)), ""
    )
    folders = [*source.packages.values()]
    for folder in [*folders]:
        folders += [one for one in siblings_of(folder).values() if one not in folders]
    for folder in folders:
        for path in files_in(folder):
            if path.endswith(ENDINGS):
                given = _given_by(read_text(folder / path) or "", own, source.file.name)
                if given:
                    return f"{folder.name}/{path}", given
    return "", {}


def _given_by(text: str, package: str, name: str) -> dict[str, str]:
    """The arguments that a launch file of ROS 1 gives to xacro for this file of a package."""
    root = parse(text) if "<param" in text and is_of_ros_1(text) else None
    if root is None or isinstance(root, Malformed):
        return {}
    values = {one.get("name"): one.get("default", one.get("value")) for one in root.iter("arg")}

    def value_of(found: re.Match[str]) -> str:
        value = values.get(found[1])
        return found[0] if value is None else value

    def resolved(text: str) -> str:
        for _ in range(_DEEPEST):
            if len(text) < _LONGEST:
                text = _ARGUMENT.sub(value_of, text)
        return text

    for one in root.iter("param"):
        try:
            words = [resolved(word) for word in split_words(one.get("command", ""))]
        except UnsaidError:
            continue
        if any(
            PurePosixPath(word).name == name and package in {"", *_NAMED.findall(word)}
            for word in words
        ):
            pairs = (word.partition(":=") for word in words if ":=" in word and "$(" not in word)
            return {key: value for key, _, value in pairs}
    return {}
