"""Why there is no workspace where one was expected, or nothing in it to build."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

# What lies in the folder of a package, and says so where package.xml is missing.
EVIDENCE = ("CMakeLists.txt", "setup.py", "launch", "model", "urdf", "worlds")


def refuse_missing_manifest(roots: Iterable[Path]) -> None:
    """Stop if something in `src` of one of the folders would be a package with a package.xml.

    Raises:
        NotFoundError: something would.
    """
    for root in roots:
        folder = next(_without_manifest(root / "src"), None)
        if folder is not None:
            raise NotFoundError(
                f"{folder} has no package.xml, so there is no package in {root}.",
                hint="Bring it back (git checkout package.xml), write one, or make another "
                f"package with: wsgen new PACKAGE -w {root}",
            )


def _without_manifest(source: Path) -> Iterator[Path]:
    try:
        folders = sorted(source.iterdir())
    except OSError:
        return
    for folder in folders:
        if not (folder / "package.xml").exists() and any(
            (folder / name).exists() for name in EVIDENCE
        ):
            yield folder
