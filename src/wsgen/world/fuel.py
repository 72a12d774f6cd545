"""Models of Fuel, Gazebo's library in the network: only those that are on this machine already."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote, urlsplit

if TYPE_CHECKING:
    from collections.abc import Mapping

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
    """What an address means: https://SERVER/1.0/OWNER/models/NAME[/VERSION[/files/PATH]].

    None for one that Fuel has not.
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
    """The folder of a model, or of one that a file is in, as Gazebo has loaded it once.

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
    except (OSError, ValueError):  # not there, or too long
        return None
    if version != NEWEST:
        versions = [entry for entry in versions if entry.name == version]
    return max(versions, key=lambda entry: int(entry.name), default=None)
