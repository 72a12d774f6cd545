"""Keep the macros of a robot: its xacro files as they are, but for the names of files in them."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import read_tags
from wsgen.descriptions.xacro.reader import FIND, MOST_FILES
from wsgen.porting.existing.resources import CONFIG, MESHES, usable_path
from wsgen.text.files import read_regular_text
from wsgen.text.markup import without_comments

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.porting.existing.resources import Resources
    from wsgen.porting.existing.sources import Source


FOLDER = "urdf"  # of the package, for the files of the robot
_FOUND = re.compile(r"(?:file://)?\$\(find\s+([\w.-]+)\s*\)((?:/[^\s\"'<>$`;,)\]}]*)?)")
_EVALUATED = re.compile(r"\bfind\(\s*'")


class KeptFiles(NamedTuple):
    """The files of a robot, as the package has them."""

    main: str  # path in the package
    files: Mapping[str, str]  # path in the package -> text
    more: Mapping[str, Path]  # what they load besides, likewise
    places: Mapping[Path, str] = {}  # where the files of the source are now


class NotKeptError(Exception):
    """The files cannot be kept; the message is a clause that says why."""


def keep_files(source: Source, resources: Resources, package: str) -> KeptFiles:
    """Rewrite the names of files in a xacro file, and in those that it includes.

    Raises:
        NotKeptError: A file is not of the source, or its name is computed.
    """
    texts = _read_all(source)
    base = Path(os.path.commonpath([file.parent for file in texts]))
    places = {file: f"{FOLDER}/{usable_path(file.relative_to(base))}" for file in texts}
    more: dict[str, Path] = {}
    written = {}
    for file, text in texts.items():
        written[places[file]] = _rewritten(text, source, resources, package, places, more)
    return KeptFiles(places[source.file], written, more, places)


def _read_all(source: Source) -> dict[Path, str]:
    """The files, by their paths."""
    texts: dict[Path, str] = {}
    waiting = [source.file]
    while waiting:
        file = Path(os.path.normpath(waiting.pop()))
        if file in texts:
            continue
        if not source.owns(file):
            raise NotKeptError(f"{file.name} is not of the source")
        try:
            texts[file] = read_regular_text(file)
        except (OSError, ValueError):
            raise NotKeptError(f"{file} cannot be read") from None
        if len(texts) > MOST_FILES:
            raise NotKeptError(f"it is in more than {MOST_FILES} files")
        waiting += [
            _included(tag.attributes["filename"].text, file, source)
            for tag in read_tags(texts[file])
            if tag.name == "xacro:include" and "filename" in tag.attributes
        ]
    return texts


def _included(name: str, by: Path, source: Source) -> Path:
    found = FIND.match(name)
    rest = name
    if found is not None:
        share = source.share_of(found[1])
        if share is None:
            raise NotKeptError(f"the package `{found[1]}` was not found")
        by, rest = share / "file", name[found.end() :].lstrip("/")
    if "$" in rest:
        raise NotKeptError(f"xacro computes the name of a file: `{name}`")
    return by.parent / rest


def _rewritten(  # noqa: PLR0913, PLR0917  where everything is now
    text: str,
    source: Source,
    resources: Resources,
    package: str,
    places: Mapping[Path, str],
    more: dict[str, Path],
) -> str:
    if _EVALUATED.search(without_comments(text)):
        raise NotKeptError("xacro computes the name of a file by find()")

    def of_package(found: re.Match[str]) -> str:
        share = source.share_of(found[1])
        if share is None:
            return found[0]
        file = Path(os.path.normpath(share / found[2].lstrip("/")))
        place = places.get(file)
        if place is None:
            place = _place_of(file, found[1], source, resources, more)
        if place is None:
            raise NotKeptError(f"xacro computes the name of a file: `{found[0]}…`")
        if place.startswith(f"{MESHES}/"):
            return f"package://{package}/{place}"
        return f"$(find {package})/{place}"

    text = _FOUND.sub(of_package, text)
    for prefix, folder in resources.prefixes.items():
        text = re.sub(rf"{re.escape(prefix)}(?=/)", f"package://{package}/{folder}", text)
    for name, place in resources.names.items():
        text = re.sub(
            rf"(?<=[\"'>]){re.escape(name)}(?=[\"'<])", f"package://{package}/{place}", text
        )
    return text


def _place_of(
    file: Path, of: str, source: Source, resources: Resources, more: dict[str, Path]
) -> str | None:
    """Where the package has a file that is not one of xacro, or a folder of meshes."""
    for prefix, folder in resources.prefixes.items():
        root = source.packages.get(of)
        inside = prefix.removeprefix(f"package://{of}").lstrip("/")
        if root is not None and prefix.startswith(f"package://{of}"):
            meshes = root / inside
            if file.is_relative_to(meshes):
                return "/".join((folder, *file.relative_to(meshes).parts))
    if not file.is_file() or not source.owns(file):
        return None
    place = f"{CONFIG}/{usable_path(Path(file.name))}"
    if more.setdefault(place, file) != file:
        return None
    return place
