"""Open what `wsgen new --from` names: a file, a folder or a zip; find the robot in it.

Nothing of it is executed, but xacro in its child. An archive is unpacked with limits.
"""

from __future__ import annotations

import os
import re
import stat
import struct
import zipfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.sdf.lookup import file_of_model, is_file
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.packages.workspace.overlay import overlay_of
from wsgen.pipeline.file_validation import AHEAD, COMMENT, INCLUDE, kind_of, read
from wsgen.pipeline.prepare import share_around
from wsgen.text.files import irregular_kind
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.model.package import ShareOf


MOST_ENTRIES = (
    20_000  # of an archive, or files of a folder; the largest public description has 3000
)
MOST_BYTES = 2 * 2**30  # of what an archive unpacks to
MOST_RATIO = 200  # of a file and its packed form: meshes reach 20
SMALL = 2**20  # bytes, of which the ratio does not matter
_BLOCK = 2**20
_SHOWN = 8  # robots in a message

_ADDRESS = re.compile(r"[A-Za-z][\w+.-]+://|[\w.-]+@[\w.-]+:")
_ARCHIVES = (".tar", ".tgz", ".gz", ".bz2", ".xz", ".7z", ".rar", ".zst")
_MESHES = (".stl", ".obj", ".dae", ".glb", ".gltf", ".ply", ".step", ".stp", ".iges", ".fbx")
_DESCRIPTION_FILES = (".urdf", ".xacro", ".sdf", ".xml")
_PASSED = frozenset(("build", "install", "log", "devel", "__MACOSX", "node_modules"))  # folders
_LINK = re.compile(rb"<(?:link|xacro:[\w.-]+)\b")
_MJCF = re.compile(AHEAD + rb"<mujoco(?:include)?\b", re.DOTALL)
_MJCF_BODY = re.compile(rb"<body\b|<include\b|<attach\b|<model\b")
_MJCF_INCLUDE = re.compile(
    rb"<(?:include|model)\s[^>]*?file\s*=\s*[\"'](?:[^\"']*/)?([^\"'/]+)[\"']"
)
_SDF_MODEL = re.compile(rb"<sdf\b[^>]*>(?:\s|" + COMMENT + rb")*<model\b", re.DOTALL)
_NAME = re.compile(rb"<name>\s*([\w-]+)\s*</name>")
# A description lies in one of these, beside the folder of its meshes.
_DESCRIPTIONS = frozenset(("urdf", "xacro", "robots", "sdf", "mjcf"))


class Source(NamedTuple):
    """A robot that was found, and the folders that are its own."""

    file: Path
    kind: str  # urdf, xacro, sdf or mjcf
    roots: tuple[Path, ...]  # real paths: what lies in none of them is not of the source
    packages: Mapping[str, Path]  # of the source, by name
    share_of: ShareOf  # also of packages that are not of the source
    shown: str  # the file as the user may find it

    def owns(self, file: Path) -> bool:
        """Whether a file is of the source; a link is where it leads."""
        real = Path(os.path.realpath(file))
        return any(real.is_relative_to(root) for root in self.roots)

    def with_package(self, package: str) -> Source:
        """With the folder of a package as its own, if the robot itself lies in it."""
        share = self.share_of(package)
        if share is None or not self.file.is_relative_to(share):
            return self
        return self._replace(
            roots=(*self.roots, Path(os.path.realpath(share))),
            packages={**self.packages, package: share},
        )


def open_source(given: str, scratch: Path, environment: Mapping[str, str]) -> Source:
    """Find the robot in a file, folder or archive; `scratch` is where an archive is unpacked.

    Raises:
        RequestError: It is none, or names several robots.
        NotFoundError: It does not exist, or has no robot.
        NotReadableError: It cannot be read, or exceeds a limit.
    """
    path = _require(given)
    unpacked = None
    if path.is_file() and zipfile.is_zipfile(path):
        unpacked = scratch / "unpacked"
        _unpack(path, unpacked)
    folder = unpacked or (path if path.is_dir() else None)
    if folder is not None:
        file, kind = _robot_of(folder, given, is_archive=unpacked is not None)
        roots = [folder] if unpacked else [folder, _folder_of(file)]
    else:
        file, kind = path, _kind_of_file(path)
        roots = [_folder_of(file)]
    packages = _packages_below(roots[0])
    around = share_around(file)
    overlay = overlay_of(environment)

    def share_of(package: str) -> Path | None:
        return packages.get(package) or around(package) or overlay.share(package)

    shown = (
        given if folder is None else f"{given.rstrip('/')}/{file.relative_to(folder).as_posix()}"
    )
    real = tuple(Path(os.path.realpath(root)) for root in roots)
    return Source(file, kind, real, packages, share_of, shown)


def _require(given: str) -> Path:
    if given in {"-", "/dev/stdin"}:
        raise RequestError(
            "--from does not read standard input: meshes are found from the place of the file.",
            hint="Save it to a file first: wsgen new NAME --from robot.urdf",
        )
    if _ADDRESS.match(given):
        raise RequestError(
            f"--from {given}: wsgen does not download anything.",
            hint="Clone or download it first, and give the folder or the zip: --from FOLDER",
        )
    path = Path(given).expanduser().absolute()
    if not os.path.lexists(path):
        beside = os.listdir(path.parent) if path.parent.is_dir() else []  # noqa: PTH208
        raise NotFoundError(
            f"--from {given}: {path} does not exist.",
            hint=f"{ask_for_nearest(path.name, beside)}Give a file, a folder or a zip.",
        )
    kind = irregular_kind(path)
    if not path.is_dir() and (kind is not None or not path.is_file()):
        raise RequestError(
            f"--from {given} is {kind or 'not a regular file'}.",
            hint="Give a URDF or xacro file, a folder or a zip.",
        )
    if not os.access(path, os.R_OK | (os.X_OK if path.is_dir() else 0)):
        raise NotReadableError(
            f"--from {given} cannot be read: permission denied.", hint="Make it readable."
        )
    return path


def _kind_of_file(file: Path) -> str:
    """What a file describes a robot in."""
    kind = kind_of(file)
    if kind is not None:
        return kind
    if _MJCF.match(read(file)):
        return "mjcf"
    suffix = file.suffix.lower()
    if suffix in _ARCHIVES:
        hint = "Unpack it, and give the folder."
    elif suffix in _MESHES:
        hint = "Give the URDF, xacro, SDF or MJCF that names it: a mesh is one part of a robot."
    else:
        hint = "Give a file with the root element <robot>, <sdf> or <mujoco>, a folder or a zip."
    raise RequestError(f"{file} does not describe a robot.", hint=hint)


def _folder_of(file: Path) -> Path:
    """The folder that a file is of: its package, or the one around it and its meshes."""
    for folder in file.parents[:4]:
        if (folder / "package.xml").is_file() or (folder / "model.config").is_file():
            return folder
    folder = file.parent
    is_below = folder.name.lower() in _DESCRIPTIONS and folder.parent != Path(folder.anchor)
    return folder.parent if is_below else folder


def _packages_below(root: Path) -> dict[str, Path]:
    """The ROS packages and models in a folder, by their names."""
    found: dict[str, Path] = {}
    for file in files_below(root):
        if file.name == "package.xml":
            named = _NAME.search(read(file))
            if named is not None:
                found.setdefault(named[1].decode(), file.parent)
        elif file.name == "model.config":
            found.setdefault(file.parent.name, file.parent)
    return found


def files_below(root: Path) -> Iterator[Path]:
    """The files in a folder, sorted, without hidden ones and what colcon builds.

    Raises:
        RequestError: There are more than a description has.
    """
    count = 0
    for place, folders, names in os.walk(root):
        folders[:] = sorted(one for one in folders if one[0] != "." and one not in _PASSED)
        count += len(names)
        if count > MOST_ENTRIES:
            raise RequestError(
                f"{root} has more than {MOST_ENTRIES} files.",
                hint="Give the folder of the robot alone, or its URDF.",
            )
        yield from (Path(place, name) for name in sorted(names))


def _robot_of(folder: Path, given: str, *, is_archive: bool) -> tuple[Path, str]:
    """The only robot of a folder."""
    found = _robots_of(folder)
    if len(found) == 1:
        return found[0]
    names = [file.relative_to(folder).as_posix() for file, _ in found[:_SHOWN]]
    if not found:
        made = next((one for one in files_below(folder) if _MADE_OF.search(one.name)), None)
        raise NotFoundError(
            f"--from {given} has no robot: no URDF, xacro, SDF model or MJCF is in it.",
            hint="Give the folder that has it, or the file itself."
            if made is None
            else f"{made.name} is a template: give the file that its project makes of it.",
        )
    more = f" and {len(found) - _SHOWN} more" if len(found) > _SHOWN else ""
    one = f"--from {given.rstrip('/')}/{names[0]}"
    raise RequestError(
        f"--from {given} has {len(found)} robots: {', '.join(names)}{more}.",
        hint=f"Unpack it, and give one of these files: --from FOLDER/{names[0]}"
        if is_archive
        else f"Give one of them: {one}",
    )


def _robots_of(folder: Path) -> list[tuple[Path, str]]:
    """The robots of a folder; those of URDF before models of SDF before MJCF, if it has some."""
    found: list[tuple[Path, str]] = []
    included: set[str] = set()
    for file in files_below(folder):
        if file.suffix.lower() in _DESCRIPTION_FILES and file.name != "package.xml":
            data = read(file)
            included.update(_decoded((*INCLUDE.findall(data), *_MJCF_INCLUDE.findall(data))))
            kind = _kind_of_robot(file, data)
            if kind is not None:
                found.append((file, kind))
    # The folder of a model may have files for several versions of SDF.
    folders = {file.parent for file, kind in found if kind == "sdf"}
    of_model = {
        folder: file_of_model(folder) for folder in folders if is_file(folder / "model.config")
    }
    whole = [
        (file, kind)
        for file, kind in found
        if file.name not in included and (kind != "sdf" or of_model.get(file.parent, file) == file)
    ]
    for kinds in (("urdf", "xacro"), ("sdf",), ("mjcf",)):
        of_kind = [one for one in whole if one[1] in kinds]
        if of_kind:
            return _without_made(of_kind)
    return []


def _kind_of_robot(file: Path, data: bytes) -> str | None:
    """What a file describes a robot in, if it does."""
    if _MJCF.match(data):
        return "mjcf" if _MJCF_BODY.search(data) else None
    kind = kind_of(file)
    if kind == "sdf":
        return kind if _SDF_MODEL.search(data) else None
    return kind if kind and _LINK.search(data) and b"<robot" in data else None


def _decoded(names: Sequence[bytes]) -> Iterator[str]:
    return (name.decode("utf-8", "replace") for name in names)


def _without_made(found: list[tuple[Path, str]]) -> list[tuple[Path, str]]:
    """Without macros alone, and without a URDF that a xacro file beside it has become."""
    calls = [
        (file, kind) for file, kind in found if kind != "xacro" or _makes_links(read(file))
    ] or found
    made = {
        file.with_name(file.name.removesuffix(".xacro").removesuffix(".urdf"))
        for file, kind in calls
        if kind == "xacro"
    }
    return [
        (file, kind) for file, kind in calls if kind == "xacro" or file.with_suffix("") not in made
    ]


_MADE_OF = re.compile(r"\.(?:urdf|sdf|xacro|xml)\.(?:jinja2?|j2|erb|em|mako|in)$")
_IN_MACRO = re.compile(rb"<xacro:macro\b.*?</xacro:macro\s*>", re.DOTALL)
_CALL = re.compile(
    rb"<xacro:(?!include|property|arg|macro|if|unless|insert_block|element|attribute|call)[\w.-]+"
    rb"|<link\b|<xacro:call\b"
)


def _makes_links(data: bytes) -> bool:
    """Whether a xacro file has links, or calls a macro, outside of macros; and names its robot."""
    return bool(_CALL.search(_IN_MACRO.sub(b"", data)))


# What `zipfile` raises on a damaged archive; that of LZMA is refused before.
_DAMAGED = (
    *(zipfile.BadZipFile, zlib.error, struct.error),
    *(OSError, EOFError, ValueError, RuntimeError, OverflowError),
)


def _unpack(archive: Path, folder: Path) -> None:
    """Unpack a zip into a new folder.

    Raises:
        NotReadableError: It is damaged, exceeds a limit, or leads out of the folder.
    """
    folder.mkdir()
    try:
        with zipfile.ZipFile(archive) as packed:
            entries = packed.infolist()
            _check_entries(archive, entries)
            left = MOST_BYTES
            for entry in entries:
                if entry.is_dir():
                    continue
                place = folder.joinpath(*_parts(entry))
                place.parent.mkdir(parents=True, exist_ok=True)
                left -= _extract(packed, entry, place, min(left, _allowed(entry)))
    except FileExistsError as error:
        raise _refused(archive, f"{Path(str(error.filename)).name} is in it twice") from error
    except _DAMAGED as error:
        raise _refused(archive, f"it cannot be unpacked ({error})") from error


def _allowed(entry: zipfile.ZipInfo) -> int:
    """How many bytes it may become."""
    return max(SMALL, MOST_RATIO * entry.compress_size)


def _extract(packed: zipfile.ZipFile, entry: zipfile.ZipInfo, place: Path, allowed: int) -> int:
    """Write an entry; returns its size, whatever the table of the archive says."""
    size = 0
    with packed.open(entry) as stream, place.open("xb") as target:
        while block := stream.read(_BLOCK):
            size += len(block)
            if size > allowed:
                raise _refused(
                    Path(packed.filename or ""), f"`{entry.filename}` unpacks to too much"
                )
            target.write(block)
    return size


def _check_entries(archive: Path, entries: Sequence[zipfile.ZipInfo]) -> None:
    if len(entries) > MOST_ENTRIES:
        raise _refused(archive, f"it has {len(entries)} files; the limit is {MOST_ENTRIES}")
    if sum(entry.file_size for entry in entries) > MOST_BYTES:
        raise _refused(archive, f"it unpacks to more than {MOST_BYTES // 2**30} GB")
    for entry in entries:
        if entry.flag_bits & 1:
            raise _refused(archive, f"`{entry.filename}` has a password")
        if entry.compress_type not in {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
            raise _refused(archive, f"`{entry.filename}` is not compressed as zips are (deflate)")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise _refused(archive, f"`{entry.filename}` is a link")
        parts = _parts(entry)
        if not parts or ".." in parts or entry.filename.startswith(("/", "\\")) or ":" in parts[0]:
            raise _refused(archive, f"`{entry.filename}` leads out of it")


def _parts(entry: zipfile.ZipInfo) -> list[str]:
    """The path of an entry; programs on Windows write backslashes."""
    return [part for part in re.split(r"[/\\]", entry.filename) if part not in {"", "."}]


def _refused(archive: Path, why: str) -> NotReadableError:
    return NotReadableError(
        f"{archive} is not unpacked: {why}. Nothing was written.",
        hint="Unpack it yourself, and give the folder.",
    )
