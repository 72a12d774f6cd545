"""Names of validated files, for their pictures and in the progress."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path


def unique_names(files: Sequence[Path], taken: Iterable[str]) -> list[str]:
    """A name for each file that no other one has, nor any in `taken`.

    It is the file's own without its ending, with as many of the folders around it as it takes: many
    robots are called model.urdf.
    """
    ways = [list(file.absolute().with_suffix("").parts[1:]) for file in files]
    used = set(taken)
    names = []
    for file, way in zip(files, ways, strict=True):
        others = [other for other in ways if other is not way]
        length = next(
            (
                length
                for length in range(1, len(way) + 1)
                if all(other[-length:] != way[-length:] for other in others)
            ),
            1,
        )
        name = wanted = "-".join(way[-length:])
        number = 2
        if name in used:
            name = wanted = f"{wanted}-{file.suffix[1:]}"
        while name in used:
            name, number = f"{wanted}-{number}", number + 1
        used.add(name)
        names.append(name)
    return names
