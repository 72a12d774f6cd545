"""Find the file of a world and the folder and file of a model, where Gazebo looks for them.

Models of Fuel, Gazebo's online library, are found only if Gazebo has already downloaded them.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote, urlsplit

from wsgen.text.files import irregular_kind, read_regular
from wsgen.text.markup import read_text
from wsgen.text.values import lazy_pattern
from wsgen.text.xmltree import Malformed, children, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping


SERVERS = ("fuel.gazebosim.org", "fuel.ignitionrobotics.org")  # one library under two names
CACHES = ("GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH")
HOME_CACHES = (".gz/fuel", ".ignition/fuel")
NEWEST = "tip"
FILES = "files"  # comes before the path of a file in a model


class Address(NamedTuple):
    """A model of Fuel, or a file in it."""

    server: str
    owner: str
    name: str
    version: str  # a number, or `tip`
    inside: str  # the path of a file in the model; empty: the model itself


def address_of(uri: str) -> Address | None:
    """Read an address: https://SERVER/1.0/OWNER/models/NAME[/VERSION[/files/PATH]].

    None for one that is not of this form.
    """
    try:
        parts = urlsplit(uri)
    except ValueError:  # brackets that are no address of a computer
        return None
    if parts.scheme not in {"http", "https"}:
        return None
    words = [unquote(word) for word in parts.path.split("/") if word]
    if words and words[0].replace(".", "").isdigit():  # the version of the interface
        del words[0]
    if len(words) < 3 or words[1] != "models" or any(set(word) <= {"."} for word in words):  # noqa: PLR2004  owner, models, name
        return None
    owner, _, name, *rest = words
    version = rest.pop(0) if rest and (rest[0] == NEWEST or rest[0].isdigit()) else NEWEST
    if rest and rest.pop(0) != FILES:
        return None
    if any("/" in word or "\0" in word for word in words):
        return None
    return Address(parts.netloc.lower(), owner, name, version, "/".join(rest))


def find_in_cache(uri: str, environment: Mapping[str, str]) -> Path | None:
    """The folder of a model, or of the model of a file, in the cache of Gazebo.

    Gazebo keeps it as CACHE/SERVER/OWNER/models/NAME/VERSION, in lower case since Citadel.
    """
    address = address_of(uri)
    if address is None:
        return None
    servers = SERVERS if address.server in SERVERS else (address.server,)
    for cache in _caches(environment):
        for server in servers:
            for words in (
                (address.owner.lower(), "models", address.name.lower()),
                (address.owner, "models", address.name),
            ):
                folder = _version_in(cache.joinpath(server, *words), address.version)
                if folder is not None:
                    return folder
    return None


def _caches(environment: Mapping[str, str]) -> list[Path]:
    home = environment.get("HOME")
    return [
        *(Path(environment[variable]) for variable in CACHES if environment.get(variable)),
        *(Path(home) / cache for cache in HOME_CACHES if home),
    ]


def _version_in(folder: Path, version: str) -> Path | None:
    try:
        versions = [entry for entry in folder.iterdir() if entry.name.isdecimal()]
    except (OSError, ValueError):  # missing, or its name is too long
        return None
    if version != NEWEST:
        versions = [entry for entry in versions if entry.name == version]
    return max(versions, key=lambda entry: int(entry.name), default=None)


# Where Gazebo Classic, Gazebo Sim and Gazebo Fortress look, after the current folder.
SEARCH_PATHS = ("GAZEBO_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")
# Where they look for models.
MODEL_PATHS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")
AROUND = 6  # number of folders above a file that may be its package, or have its models
SCHEMES = ("model", "package")
_MODEL_NAME = lazy_pattern(r"\w[\w.-]*")


GAZEBO_FOLDERS = (".gazebo", ".gz", ".ignition")  # in the home directory
GAZEBO_PREFIXES = ("/usr/share/gazebo", "/usr/share/gz", "/usr/share/ignition")


def is_of_gazebo(file: Path, environment: Mapping[str, str]) -> bool:
    """Whether a file is one that Gazebo brings along or has downloaded."""
    home = environment.get("HOME")
    folders = [*_caches(environment), *(Path(home) / name for name in GAZEBO_FOLDERS if home)]
    return str(file).startswith(GAZEBO_PREFIXES) or any(
        file.is_relative_to(folder) for folder in folders
    )


def find_world(name: str, environment: Mapping[str, str]) -> Path | None:
    """The file of a world given as a path or a name; None if it is not found.

    An absolute path is returned as it is, whether the file exists or not.
    """
    if Path(name).is_absolute():
        return Path(name)
    for folder in (Path.cwd(), *_entries(SEARCH_PATHS, environment)):
        for candidate in (folder / name, folder / "worlds" / name):
            if candidate.is_file():
                return candidate
    return None


def gazebo_models() -> list[str]:
    """The names of the models that Gazebo Classic downloads by itself."""
    return _gazebo_names(0)


def gazebo_worlds() -> list[str]:
    """The names of the worlds that Gazebo ships."""
    return _gazebo_names(1)


# Those of Gazebo that have a ground plane, and nothing else.
EMPTY_WORLDS = {
    "empty.sdf",
    "empty_gui.sdf",
    "empty.world",
    "empty_sky.world",
    "empty_bullet.world",
}
OF_GAZEBO = lazy_pattern(r"(?:/usr/share/(?:gazebo|ignition|gz)\b.*/)?(?:worlds/)?([^/]+)")
# An archive of another machine has its folders below one of this machine.
OF_ROS = lazy_pattern(r"((?:/.*)?/opt/ros/[^/]+/share/([^/]+))/.*?([^/]+)")


def is_brought_along(world: str) -> bool:
    """Whether a world that is not found is one of Gazebo, or of a ROS package not installed here.

    `gazebo_ros` has one world, which is called like one of Gazebo.
    """
    of_gazebo, of_ros = OF_GAZEBO.fullmatch(world), OF_ROS.fullmatch(world)
    if of_ros is not None and of_ros[2] != "gazebo_ros":
        return not Path(of_ros[1]).is_dir()
    name = of_gazebo[1] if of_gazebo else of_ros[3] if of_ros else ""
    return name in gazebo_worlds()


def _gazebo_names(block: int) -> list[str]:
    text = Path(__file__).with_name("gazebo-names.txt").read_text(encoding="utf-8")
    return text.split("\n\n")[block].partition("\n")[2].split()


def world_names(environment: Mapping[str, str]) -> list[str]:
    """The names of the world files where `find_world` looks."""
    folders = (Path.cwd(), *_entries(SEARCH_PATHS, environment))
    return [
        file.name
        for folder in folders
        for place in (folder, folder / "worlds")
        for pattern in ("*.world", "*.sdf")
        for file in place.glob(pattern)
    ]


def model_finder(file: Path, environment: Mapping[str, str]) -> Callable[[str], Path | None]:
    """A function from `model://NAME` to the folder of the model; it gives None if there is none.

    It also finds models by their address of Fuel if Gazebo has downloaded them, and what
    `file://FOLDER/...` names in the folders for resources. It looks where
    Gazebo does, then around the file that names the model: in the folders above it, and in their
    `models`, and in the packages of the install space. A folder with a model.config or model.sdf is
    preferred to one without.
    """
    above = list(file.absolute().parents)[:AROUND]
    home = environment.get("HOME")
    folders = [
        *model_folders(environment),
        *([Path(home) / ".gazebo" / "models"] if home else []),
        *(place for folder in above for place in (folder, folder / "models")),
    ]

    def find(uri: str) -> Path | None:
        scheme, separator, name = uri.partition("://")
        if scheme in {"http", "https"}:
            return find_in_cache(uri, environment)
        name = name.strip("/")
        if scheme == "file":
            places = (place / name for place in (*resource_folders(environment), *above))
            return next(filter(is_there, places), None)
        if not separator or scheme not in SCHEMES or not name or ".." in Path(name).parts:
            return None
        found = [folder / name for folder in folders if is_folder(folder / name)]
        models = (
            folder
            for folder in found
            if is_file(folder / "model.config") or is_file(folder / "model.sdf")
        )
        model = next(models, None) or _find_in_packages(name, environment)
        return model or (found[0] if found else None)

    return find


def _find_in_packages(name: str, environment: Mapping[str, str]) -> Path | None:
    """The folder of a model that a package of the install space has, alone or among its models.

    Gazebo finds it where the author has put the folder into one of MODEL_PATHS by hand.
    """
    if not _MODEL_NAME.fullmatch(name):
        return None
    shares = [prefix / "share" for prefix in _entries(["AMENT_PREFIX_PATH"], environment)]
    return next(
        (
            found.parent
            for share in shares
            for place in (f"*/{name}", f"*/models/{name}")
            for found in sorted(share.glob(f"{place}/model.*"))
            if found.name in {"model.config", "model.sdf"}
        ),
        None,
    )


def models_around(file: Path) -> set[str]:
    """The names of the models around a file, where `model_finder` looks."""
    return {
        found.parent.name
        for folder in list(file.absolute().parents)[:AROUND]
        for place in (folder, folder / "models")
        for found in place.glob("*/model.config")
    }


def model_folders(environment: Mapping[str, str]) -> list[Path]:
    """The folders for models in the environment variables of Gazebo."""
    return _entries(MODEL_PATHS, environment)


_EXPORTED = lazy_pattern(r"<gazebo_ros\b[^>]*?\bgazebo_m(?:edia|odel)_path\s*=\s*[\"']([^\"']+)")


def resource_folders(environment: Mapping[str, str]) -> Iterator[Path]:
    """The folders in which Gazebo looks for what has a relative path.

    They are those of the environment, then those that package.xml of a package exports to it.
    """
    yield from _entries(SEARCH_PATHS, environment)
    for prefix in _entries(["AMENT_PREFIX_PATH"], environment):
        for manifest in sorted(prefix.glob("share/*/package.xml")):
            for paths in _EXPORTED.findall(read_text(manifest) or ""):
                for path in paths.split(os.pathsep):
                    yield Path(path.replace("${prefix}", str(manifest.parent)))


def is_file(path: Path) -> bool:
    """Whether a regular file exists; False for an impossible path."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long; before Python 3.14 this is raised
        return False


def is_there(path: Path) -> bool:
    """Whether anything exists at a path; False for an impossible path."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def instead_of_file(path: Path | None) -> str:
    """What a path is if `is_file` says that it is not a regular file."""
    return (path and irregular_kind(path)) or "missing"


def is_folder(path: Path) -> bool:
    """Whether a folder exists; False for an impossible path."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _entries(variables: Iterable[str], environment: Mapping[str, str]) -> list[Path]:
    return [
        Path(entry)
        for variable in variables
        for entry in environment.get(variable, "").split(os.pathsep)
        if entry
    ]


MANIFEST_LIMIT = 2**20  # bytes


def file_of_model(folder: Path) -> Path | None:
    """The newest SDF file that model.config names, else model.sdf."""
    manifest = folder / "model.config"
    named: list[tuple[tuple[int, ...], str]] = []
    content = _read(manifest)
    if content is not None:
        root = parse(content)
        if not isinstance(root, Malformed):
            named = [
                (_digits(sdf.get("version") or ""), (sdf.text or "").strip())
                for sdf in children(root, "sdf")
                if (sdf.text or "").strip()
            ]
    if named:
        return folder / max(named)[1]
    plain = folder / "model.sdf"
    return plain if is_file(plain) else None


def _read(manifest: Path) -> bytes | None:
    """The content of a file; None if it is missing or may not be read."""
    try:
        return read_regular(manifest, MANIFEST_LIMIT)
    except OSError:
        return None


def _digits(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".") if part.isascii() and part.isdigit())
