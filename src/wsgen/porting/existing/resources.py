"""The files that a robot names: where they are, and where the package has them."""

from __future__ import annotations

import itertools
import os
import re
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote

from wsgen.checks.fixes.source import Edit, apply, read_tags
from wsgen.descriptions.meshes.lookup import Missing, locate
from wsgen.descriptions.sdf.lookup import is_file
from wsgen.errors import NotFoundError, RequestError
from wsgen.porting.existing.sources import files_below
from wsgen.text.files import after_scheme
from wsgen.text.markup import without_comments

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from wsgen.porting.existing.sources import Source


MESHES = "meshes"  # the folder of the package
CONFIG = "config"
_NAMED = ("mesh", "texture")  # elements with the name of a file
_ADDRESS = re.compile(r"(?:package|model|file)://[^\s\"'<>$]+")
_ABOVE = 3  # folders from which a relative name is looked for
_SLASHES = re.compile(r"^//+")
_UNUSUAL = re.compile(r"[^A-Za-z0-9_.-]+")
_LARGEST = 64 * 2**20  # bytes of a mesh in which names of other files are looked for
# What names other files in a mesh, by its suffix.
_COMPANIONS = {
    ".dae": re.compile(rb"<init_from>\s*(?:<ref>)?\s*([^<]+?)\s*<"),
    ".obj": re.compile(rb"(?m)^\s*mtllib\s+(.+?)\s*$"),
    ".mtl": re.compile(
        rb"(?mi)^\s*(?:map_\w+|bump|disp|decal|refl|norm)\s+(?:-\S+\s+\S+\s+)*(.+?)\s*$"
    ),
    ".gltf": re.compile(rb"\"uri\"\s*:\s*\"([^\"]+)\""),
    ".ply": re.compile(rb"(?m)^comment TextureFile (.+?)\s*$"),
}


class Reference(NamedTuple):
    """The name of a file in a text."""

    start: int
    end: int
    uri: str  # as written
    is_mesh: bool


class Resources(NamedTuple):
    """The files of a package that a robot names."""

    names: Mapping[str, str]  # as the source writes it -> the path in the package
    files: Mapping[str, Path | bytes]  # path in the package -> what is copied
    # Beginnings of names in the source, and what takes their place: `package://a/meshes`.
    prefixes: Mapping[str, str]
    lost: tuple[str, ...]  # textures and the like that could not be copied, of which mesh


def find_references(text: str, folders: Iterable[Path] = ()) -> list[Reference]:
    """The names of files in a URDF or xacro text, in its order.

    Paths below the `folders`, which $(find …) becomes, are references, too.
    """
    found = {}
    for tag in read_tags(text):
        written = tag.attributes.get("filename") if tag.name in _NAMED else None
        if written is not None and written.text.strip():
            start, end = written.value
            found[start] = Reference(start, end, written.text, tag.name == "mesh")
    plain = without_comments(text)
    patterns = [_ADDRESS]
    patterns += [re.compile(rf"{re.escape(str(folder))}/[^\s\"'<>$:]+") for folder in folders]
    taken = [(one.start, one.end) for one in found.values()]
    for pattern in patterns:
        for match in pattern.finditer(plain):
            if not any(start <= match.start() < end for start, end in taken):
                found[match.start()] = Reference(*match.span(), match[0], is_mesh=False)
                taken.append(match.span())
    return [found[start] for start in sorted(found)]


def resolve(uri: str, source: Source) -> Path | None:
    """The file that a name stands for; None where there is none."""
    scheme, separator, rest = uri.partition("://")
    if separator and scheme in {"package", "model"}:
        package, _, inside = rest.lstrip("/").partition("/")
        share = source.share_of(package)
        path = None if share is None or not inside else share / inside
    else:
        name = after_scheme(unquote(rest)) if separator else uri
        # PyBullet looks from a folder that a program names, often one of those above. And
        # `file://$(find …)/…` has a slash too many, which another root of paths would have, too.
        name = _SLASHES.sub("/", name)
        places = (folder / name for folder in source.file.parents[:_ABOVE])
        path = next(filter(is_file, places), None)
    return path if path is not None and is_file(path) else None


class FoundFiles(NamedTuple):
    """The files that names stand for."""

    files: dict[str, Path]
    missing: tuple[str, ...]  # names of meshes without a file
    taken: tuple[str, ...]  # names of meshes that stood for no file: the nearest of `files`


def find_files(
    references: Iterable[Reference], source: Source, *, copy_outside: bool, skip_missing: bool
) -> FoundFiles:
    """The files that names stand for.

    Where meshes may be missing, a file of the source that is called as the mesh takes its place.

    Raises:
        NotFoundError: A mesh has none, and that is not to be fixed.
        RequestError: A file is outside of the source.
    """
    found: dict[str, Path] = {}
    missing: dict[str, None] = {}
    for one in references:
        path = resolve(one.uri, source)
        if path is not None:
            found[one.uri] = path
        elif one.is_mesh:
            missing[one.uri] = None
    if missing and not skip_missing:
        raise not_found([*missing], source)
    taken = called_alike(missing, source)
    found |= taken
    if not copy_outside:
        refuse_outside(found, source)
    lost = tuple(one for one in missing if one not in taken)
    return FoundFiles(found, lost, tuple(taken))


def called_alike(uris: Iterable[str], source: Source) -> dict[str, Path]:
    """Files of the source in place of those that do not exist: of most equal folders from the end.

    Exports are moved, renamed, and flattened, or come from a disk that does not tell capitals.
    """
    below: dict[str, dict[Path, None]] = {}
    wanted = {uri: unquote(uri).replace("\\", "/").casefold().split("/")[::-1] for uri in uris}
    for root in dict.fromkeys(source.roots) if wanted else ():
        for file in files_below(root):
            below.setdefault(file.name.casefold(), {})[Path(os.path.realpath(file))] = None
    found = {}
    for uri, parts in wanted.items():
        ranked: dict[int, list[Path]] = {}
        for file in below.get(parts[0], ()):
            own = [part.casefold() for part in file.parts[::-1]]
            pairs = itertools.takewhile(
                lambda pair: pair[0] == pair[1], zip(parts, own, strict=False)
            )
            ranked.setdefault(sum(1 for _ in pairs), []).append(file)
        nearest = ranked[max(ranked)] if ranked else []
        if len({one.read_bytes() for one in nearest}) == 1:
            found[uri] = nearest[0]
    return found


def refuse_outside(files: Mapping[str, Path | bytes], source: Source) -> None:
    """Stop where files are not of the source.

    Raises:
        RequestError: One is outside of it.
    """
    outside = {
        uri: path for uri, path in files.items() if isinstance(path, Path) and not source.owns(path)
    }
    if outside:
        uri, path = next(iter(outside.items()))
        count = "" if len(outside) == 1 else f" and {len(outside) - 1} more"
        raise RequestError(
            f"The robot names files outside of {source.shown}: `{uri}`, which is {path}{count}.",
            hint="Add --copy-outside to copy them into the package, or give the folder that has"
            " them all. Look at their license first.",
        )


def not_found(missing: Sequence[str], source: Source) -> NotFoundError:
    """The error for files that do not exist."""
    located = locate(missing[0], source.share_of, source.file.parent)
    problem, hint = "does not exist", "Check its name."
    if isinstance(located, Missing):
        problem, hint = located.problem, located.hint
    scheme, separator, rest = missing[0].partition("://")
    package = rest.partition("/")[0]
    if separator and scheme in {"package", "model"} and source.share_of(package) is None:
        hint = (
            f"Give the folder that has the package `{package}` beside this one, or source a"
            f" workspace with it and add --copy-outside."
        )
    count = "" if len(missing) == 1 else f" {len(missing)} meshes are missing."
    alike = called_alike(missing[:1], source).get(missing[0])
    fix = "leaves out what is missing" if alike is None else f"takes {alike}"
    return NotFoundError(
        f"{source.shown}: the mesh `{missing[0]}` {problem}.{count}",
        hint=f"{hint} Or add --fix, which {fix}.",
    )


def place_files(files: Mapping[str, Path | bytes], source: Source) -> Resources:
    """Choose where the package has each file, with what meshes name beside them."""
    places = _Places(source)
    paths = {uri: one for uri, one in files.items() if isinstance(one, Path)}
    for group, members in _grouped(paths.values(), source).items():
        places.add_group(group, members)
    names = {}
    for uri, one in files.items():
        if isinstance(one, Path):
            names[uri] = places.of[one]
        else:
            names[uri] = places.take(f"{MESHES}/{usable(PurePosixPath(uri).name)}", one)
    return Resources(names, places.files, places.prefixes, tuple(dict.fromkeys(places.lost)))


def _grouped(paths: Iterable[Path], source: Source) -> dict[Path, list[Path]]:
    """Files by the package or folder that they are of."""
    roots = sorted((*source.packages.values(), *source.roots), key=lambda one: -len(one.parts))
    groups: dict[Path, list[Path]] = {}
    for path in dict.fromkeys(paths):
        root = next((one for one in roots if path.is_relative_to(one)), None)
        real = Path(os.path.realpath(path))
        root = root or next((one for one in roots if real.is_relative_to(one)), path.parent)
        groups.setdefault(root, []).append(path)
    return groups


class _Places:
    """Paths in the package that are given to files."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.of: dict[Path, str] = {}
        self.files: dict[str, Path | bytes] = {}
        self.prefixes: dict[str, str] = {}
        self.lost: list[str] = []
        self._taken: set[str] = set()

    def add_group(self, root: Path, members: list[Path]) -> None:
        """Place the files of a package."""
        settings = [one for one in members if one.suffix.lower() in {".yaml", ".yml", ".json"}]
        meshes = [one for one in members if one not in settings]
        for one in settings:
            self.of[one] = self.take(f"{CONFIG}/{usable(one.name)}", one)
        if not meshes:
            return
        common = Path(os.path.commonpath([one.parent for one in meshes]))
        parts = common.relative_to(root).parts if common.is_relative_to(root) else ()
        cut = next((at + 1 for at, part in enumerate(parts) if part.lower() == MESHES), len(parts))
        common = root.joinpath(*parts[:cut]) if parts else common
        folder = MESHES
        # Two packages may have meshes of the same name.
        if any(
            f"{MESHES}/{usable_path(one.relative_to(common))}".casefold() in self._taken
            for one in meshes
        ):
            folder = f"{MESHES}/{usable(root.name)}"
        for one in meshes:
            self.of[one] = self.take(f"{folder}/{usable_path(one.relative_to(common))}", one)
            self._add_companions(one, self.of[one])
        package = next((name for name, path in self.source.packages.items() if path == root), None)
        if package is not None:
            inside = PurePosixPath(package, *common.relative_to(root).parts)
            self.prefixes[f"package://{inside}"] = folder

    def take(self, wanted: str, content: Path | bytes) -> str:
        """A path in the package that nothing else has, not even where case does not matter."""
        path, number = PurePosixPath(wanted), 1
        while str(path).casefold() in self._taken:
            number += 1
            path = PurePosixPath(wanted).with_stem(f"{PurePosixPath(wanted).stem}_{number}")
        self._taken.add(str(path).casefold())
        self.files[str(path)] = content
        return str(path)

    def _add_companions(self, mesh: Path, place: str) -> None:
        """Copy what a mesh names, to where the copy of the mesh looks for it."""
        pattern = _COMPANIONS.get(mesh.suffix.lower())
        if pattern is None or mesh.stat().st_size > _LARGEST:
            return
        for raw in dict.fromkeys(pattern.findall(mesh.read_bytes())):
            written = raw.decode("utf-8", "replace")
            name = unquote(written).removeprefix("file://").replace("\\", "/")
            if name.startswith(("data:", "http:", "https:")) or not PurePosixPath(name).suffix:
                continue  # of COLLADA, also names of its own elements
            file = Path(os.path.normpath(mesh.parent / name))
            target = os.path.normpath(PurePosixPath(place).parent / name)
            if not file.is_file():
                self.lost.append(f"`{written}` of {mesh.name}")
            elif not self.source.owns(file) or target.startswith(("..", "/")):
                self.lost.append(f"`{written}` of {mesh.name} (outside of the source)")
            elif target.casefold() not in self._taken:
                self._taken.add(target.casefold())
                self.files[target] = file
                self._add_companions(file, target)


def usable(name: str) -> str:
    """The name of a file that every disk and address can have."""
    return _UNUSUAL.sub("_", name).lstrip(".-") or "file"


def usable_path(path: Path) -> str:
    """The same for a path."""
    return "/".join(usable(part) for part in path.parts)


def with_own_names(text: str, packages: Mapping[str, Path]) -> str:
    """A text of roslaunch or xacro with `$(find PACKAGE)` for its folder on another computer.

    Only where that path does not exist here, and the package has the file.
    """
    names = "|".join(map(re.escape, packages))
    pattern = rf"""(?<=["'>\s=])(?:/[^\s"'<>$/]+)+/({names})/([^\s"'<>$]+)"""

    def own(found: re.Match[str]) -> str:
        is_here = Path(found[0]).exists() or not (packages[found[1]] / found[2]).exists()
        return found[0] if is_here else f"$(find {found[1]})/{found[2]}"

    return re.sub(pattern, own, text) if packages else text


def rewrite(
    text: str, references: Sequence[Reference], new_name: Callable[[str], str | None]
) -> str:
    """Write other names of files into a text; None of one that stays."""
    edits = []
    for one in references:
        name = new_name(one.uri)
        if name is not None:
            edits.append(Edit(start=one.start, end=one.end, text=name))
    return apply(text, edits)
