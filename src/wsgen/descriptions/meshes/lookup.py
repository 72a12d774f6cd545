"""Finds the files that mesh addresses stand for, and reports those that are missing."""

from __future__ import annotations

import itertools
import os
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote

from wsgen.descriptions.rules import MISSING_COLLISION_MESH, MISSING_VISUAL_MESH
from wsgen.model.robot import Mesh, Robot
from wsgen.text.files import after_scheme, irregular_kind
from wsgen.text.markup import read_text
from wsgen.text.suggestions import did_you_mean, misspelled_as, some_named
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.package import ShareOf
    from wsgen.model.robot import Geometry, Link


FORMATS = (
    ".stl",
    ".obj",
    ".dae",
    ".glb",
    ".gltf",
    ".ply",
)  # see `wsgen.descriptions.meshes.worker`
ON_WINDOWS = lazy_pattern(r"[A-Za-z]:[\\/]")
IN_PACKAGE = "Copy the mesh into the package, and write package://PACKAGE/meshes/…"
MANY = 3  # meshes in a folder that does not exist are reported with it
MACHINE_PARTS = 3  # of /home/somebody/…: if it does not exist, the path is of another machine


class Missing(NamedTuple):
    """Why a mesh has no file."""

    problem: str  # goes on after the name of the mesh
    hint: str
    folder: Path | None = None  # that does not exist either, the outermost one


def locate(uri: str, share_of: ShareOf, folder: Path | None) -> Path | Missing:
    """The file of a mesh.

    Args:
        uri: As written: `package://PACKAGE/…`, `model://MODEL/…`, `file://…` or a path.
        share_of: Where packages and models are.
        folder: What a path that is not absolute is seen from.
    """
    unread = _unreadable(uri)
    if unread is not None:
        return unread
    scheme, separator, rest = uri.partition("://")
    if not separator or scheme == "file":
        path = Path(after_scheme(unquote(rest)) if separator else uri)
        if not path.is_absolute():
            beside = None if folder is None else folder / path
            is_beside = beside is not None and os.path.lexists(beside)
            found = _among_resources(path, share_of) if separator and not is_beside else beside
            if found is None and beside is None:
                return Missing("has a relative path, but its base folder is not known", IN_PACKAGE)
            path = found or beside or path
    else:
        package, _, inside = rest.partition("/")
        share = share_of(package)
        if share is None:
            own = address_in_package(rest, folder) if folder is not None else None
            return Missing(
                f"is in the package `{package}`, which was not found",
                f"Write {own}"
                if own
                else f"Build and source a workspace with `{package}`, and name it in package.xml.",
            )
        path = share / inside
    if not os.path.isfile(path):  # noqa: PTH113  Path.is_file raises on names that are too long
        return _explain(uri, path)
    if path.suffix.lower() not in FORMATS:
        return Missing(
            f"has a format that wsgen does not read ({path.suffix or 'no extension'})",
            f"Convert it to one of {', '.join(FORMATS)}.",
        )
    return path


def _among_resources(path: Path, share_of: ShareOf) -> Path | None:
    """Look the first folder of a relative path up, as Gazebo does in its folders for resources."""
    first, *inside = path.parts or ("",)
    folder = share_of(first) if inside and first not in {".", ".."} else None
    return None if folder is None else folder.joinpath(*inside)


def _unreadable(uri: str) -> Missing | None:
    """What is wrong with an address that cannot be a path."""
    scheme, separator, rest = uri.partition("://")
    if not uri.strip():
        return Missing("has no name", 'Write filename="package://PACKAGE/meshes/…".')
    if "$(" in uri or "${" in uri:
        return Missing(
            "contains a substitution that is not expanded",
            "xacro expands $(find PACKAGE) and ${…}: give the file the extension .xacro and a "
            "<robot xmlns:xacro=…>, or write package://PACKAGE/….",
        )
    if scheme in {"http", "https"} and separator:
        return Missing(
            "is a network address; wsgen only loads files",
            f"Download it. {IN_PACKAGE}",
        )
    if separator and scheme not in {"file", "package", "model"}:
        return Missing(f"has an unknown scheme (`{scheme}://`)", IN_PACKAGE)
    if scheme in {"package", "model"} and separator and not rest.partition("/")[0]:
        return Missing(
            f"does not name a {scheme} after the two slashes",
            f"Write {scheme}://PACKAGE/{rest.lstrip('/') or 'meshes/…'}.",
        )
    return None


def _explain(uri: str, path: Path) -> Missing:
    """Why there is no such file."""
    there = _with_other_capitals(path)
    home = Path(*path.parts[:MACHINE_PARTS])
    if ON_WINDOWS.match(uri):
        return Missing("has a Windows path", IN_PACKAGE)
    if "\\" in uri:
        hint = f"Use slashes: {uri.replace(chr(92), '/')}"
        return Missing("contains backslashes, which are not separators on Linux", hint)
    if os.path.lexists(path):
        kind = irregular_kind(path) or "a file without read permission"
        return Missing(f"is {kind} ({path})", "Name a mesh file.")
    if there is not None:
        return Missing(
            f"does not exist ({path}), but `{there}` does",
            "Write its name with the same upper and lower case.",
        )
    if Path(uri.removeprefix("file://")).is_absolute() and not home.exists():
        return Missing(f"has an absolute path of another machine ({path})", IN_PACKAGE)
    own = address_in_package(path.name, path.parent)
    near = None if own else _misspelled(path)
    return Missing(
        f"does not exist ({path})",
        f"Write {own}"
        if own
        else did_you_mean(near)
        if near
        else "Check its spelling, including upper and lower case, and that CMakeLists.txt installs "
        "it.",
        None if own else _missing_folder(path),
    )


def _misspelled(path: Path) -> str | None:
    """The name of the mesh in the folder that is surely meant, or is this one in another format."""
    try:
        names = os.listdir(path.parent)  # noqa: PTH208  names suffice
    except (OSError, ValueError):
        return None
    if any(name.casefold() == path.name.casefold() for name in names):
        return None  # several with other capitals
    stems = {
        stem: name
        for stem, suffix, name in ((*os.path.splitext(one), one) for one in sorted(names))  # noqa: PTH122
        if suffix.lower() in FORMATS
    }
    if path.stem in stems:
        return stems[path.stem]
    near = misspelled_as(path.stem, stems)
    return None if near is None else stems[near]


def _missing_folder(path: Path) -> Path | None:
    """The outermost folder of a path that does not exist."""
    folder = None
    for one in path.parents:
        if os.path.lexists(one):
            break
        folder = one
    return folder


_LEVELS = 8  # of folders above a robot, among which its package is looked for
_FOLDERS = 200  # of a package, among which a mesh is looked for
_NAME = lazy_pattern(r"<name>\s*([\w-]+)\s*</name>")


def address_in_package(name: str, folder: Path) -> str | None:
    """The address of the only file of the package around `folder` whose path ends so."""
    around = (folder, *folder.parents)[:_LEVELS]
    package = next((one for one in around if (one / "package.xml").is_file()), None)
    if package is None:
        return None
    found = [inside for inside in _files_of(package) if f"/{inside}".endswith(f"/{name}")]
    named = _NAME.search(read_text(package / "package.xml") or "")
    return f"package://{named[1]}/{found[0]}" if named and len(found) == 1 else None


@lru_cache(maxsize=8)
def _files_of(package: Path) -> tuple[str, ...]:
    """The files in a package, seen from its folder."""
    folders = itertools.islice(os.walk(package, followlinks=True), _FOLDERS)
    return tuple(
        (Path(place).relative_to(package) / file).as_posix()
        for place, _, files in folders
        for file in files
        if Path(file).suffix.lower() in FORMATS
    )


def _with_other_capitals(path: Path) -> Path | None:
    """The file of that name but for its capitals, in folders that are written likewise."""
    found = Path(path.anchor)
    for part in path.parts[1:] if path.anchor else path.parts:
        if part == ".." or os.path.lexists(found / part):
            found /= part
            continue
        try:
            names = os.listdir(found)  # noqa: PTH208  names suffice
        except (OSError, ValueError):
            return None
        alike = [name for name in names if name.casefold() == part.casefold()]
        if len(alike) != 1:
            return None
        found /= alike[0]
    return found if found != path and os.path.isfile(found) else None  # noqa: PTH113


def find_meshes(
    robot: Robot, *, share_of: ShareOf, folder: Path | None = None, file: Path | None = None
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Fill in the path of every mesh that is there, and report the others.

    `package://PACKAGE/…` and `model://PACKAGE/…` are looked up with `share_of`; a path that is not
    absolute is seen from `folder`. `file` is what the diagnostics name.
    """
    search = _Search(share_of, folder, file)
    links = tuple(
        replace(
            link,
            visuals=tuple(
                replace(visual, geometry=search.located(visual.geometry, link, is_visual=True))
                for visual in link.visuals
            ),
            collisions=tuple(
                replace(shape, geometry=search.located(shape.geometry, link, is_visual=False))
                for shape in link.collisions
            ),
        )
        for link in robot.links
    )
    return replace(robot, links=links), (*search.in_missing_folders(), *search.diagnostics.values())


class _Search:
    """Where to look, and what was not found."""

    def __init__(self, share_of: ShareOf, folder: Path | None, file: Path | None) -> None:
        self.share_of = share_of
        self.folder = folder
        self.file = file
        # One for each mesh of a link.
        self.diagnostics: dict[tuple[str, str, bool], Diagnostic] = {}
        # Those of them in folders that do not exist.
        self.folders: dict[tuple[Path, bool], list[tuple[str, str, bool]]] = {}

    def in_missing_folders(self) -> Iterator[Diagnostic]:
        """One diagnostic for each folder, in place of one for each of many meshes in it."""
        for (folder, is_visual), keys in self.folders.items():
            meshes = [*dict.fromkeys(uri for _, uri, _ in keys)]
            if len(meshes) < MANY:
                continue
            first, *_ = [self.diagnostics.pop(key) for key in keys]
            kind = "visual" if is_visual else "collision"
            yield replace(
                first,
                message=f"The folder {folder} of {len(meshes)} {kind} meshes of the robot does not "
                f"exist: {some_named(meshes, MANY)}.",
                hint="Add the folder to the package, and check that it is committed to git and "
                "installed by CMakeLists.txt; or correct its name in the paths of the meshes.",
            )

    def located(self, geometry: Geometry, link: Link, *, is_visual: bool) -> Geometry:
        """The mesh with its path; any other geometry as it is."""
        if not isinstance(geometry, Mesh):
            return geometry
        found = locate(geometry.uri, self.share_of, self.folder)
        if isinstance(found, Path):
            # Engines make addresses of it, in which a relative path is the name of a machine.
            return replace(geometry, path=str(found.absolute()))
        problem, hint, missing_folder = found
        kind = "visual" if is_visual else "collision"
        rule = MISSING_VISUAL_MESH if is_visual else MISSING_COLLISION_MESH
        key = link.name, geometry.uri, is_visual
        if missing_folder is not None and key not in self.diagnostics:
            self.folders.setdefault((missing_folder, is_visual), []).append(key)
        self.diagnostics[key] = rule.at(
            self.file,
            link.line,
            f"link[@name='{link.name}']/{kind}/geometry/mesh",
            message=f"The {kind} mesh `{geometry.uri}` of the link `{link.name}` {problem}.",
            hint=hint,
        )
        return geometry
