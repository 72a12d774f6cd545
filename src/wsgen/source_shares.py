"""Let the source folder of a package that is not built serve as its share folder.

A child that evaluates launch files or xacro finds packages by AMENT_PREFIX_PATH alone. It is given
a prefix for each such package, as colcon would install it; the share folder in it is a link to the
source. What the child answers names the source instead.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


VARIABLE = "WSGEN_SOURCE_PREFIXES"  # in the environment: the folder of these prefixes
SEPARATOR = r"[/\\]"  # of folders; Windows has both
INDEX = Path("share", "ament_index", "resource_index", "packages")  # below a prefix


def serve_sources(
    sources: Mapping[str, Path], folder: Path, environment: Mapping[str, str]
) -> dict[str, str]:
    """Write a prefix for each package into a folder; the environment with them on the path."""
    prefixes = [environment.get("AMENT_PREFIX_PATH", "")]
    for package, source in sources.items():
        prefix = folder / package
        (prefix / INDEX).mkdir(parents=True)
        (prefix / INDEX / package).write_text(str(source), encoding="utf-8")
        _link(prefix / "share" / package, source)
        prefixes.append(str(prefix))
    path = os.pathsep.join(filter(None, prefixes))
    return {**environment, "AMENT_PREFIX_PATH": path, VARIABLE: str(folder)}


def _link(place: Path, folder: Path) -> None:
    try:
        place.symlink_to(folder, target_is_directory=True)
    except OSError as error:
        if not hasattr(error, "winerror"):  # Windows lets only administrators make links
            raise
        from _winapi import CreateJunction  # type: ignore[attr-defined]  # noqa: PLC0415

        CreateJunction(str(folder), str(place))


def is_source(share: str) -> bool:
    """Whether a share folder is the source of a package that is not built."""
    folder = os.environ.get(VARIABLE)
    return folder is not None and Path(folder) in Path(share).parents


def name_sources(answer: Any, environment: Mapping[str, str]) -> Any:
    """The answer of a child, as JSON gives it, with the source folders in place of the links.

    The `share` of a prefix, which model paths name, becomes the folder that the source lies in, if
    that has it under the name of the package.
    """
    folder = environment.get(VARIABLE)
    if folder is None:
        return answer
    words = [*map(re.escape, re.split(SEPARATOR, folder)), r"([\w-]+)", rf"share({SEPARATOR}\1)?"]
    prefix = re.compile(SEPARATOR.join(words) + r"(?![\w-])")

    def name_source(found: re.Match[str]) -> str:
        source = Path(Path(folder, found[1], INDEX, found[1]).read_text(encoding="utf-8"))
        if found[2]:
            return str(source)
        return str(source.parent) if source.name == found[1] else found[0]

    def name(part: Any) -> Any:
        if isinstance(part, str):
            return prefix.sub(name_source, part)
        if isinstance(part, list):
            return [name(one) for one in part]
        if isinstance(part, dict):
            return {key: name(value) for key, value in part.items()}
        return part

    return name(answer)
