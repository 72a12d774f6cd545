"""Meshes that are measured, and new ones that are made of them, in a child process."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.meshes.inspection import LIMITS
from wsgen.descriptions.meshes.requests import Solid
from wsgen.isolation.codec import decode
from wsgen.isolation.parent import run
from wsgen.isolation.result import Died, Limits
from wsgen.porting.existing.resources import MESHES, usable

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.model.transform import Vector


Mirrored = tuple[str, "Vector"]  # path and signs
DECOMPOSING = Limits(seconds=300.0)  # of one mesh, on all cores together
_WORKER = "wsgen.descriptions.meshes.worker"


class MadeMeshes:
    """What fixes ask of meshes.

    Args:
        package: The name of the package, for which they are made.
        files: The files of the package; those of new meshes have other names.
        scratch: A folder for files.
        add: Takes the path of a new mesh in the package, and its bytes.
    """

    def __init__(
        self,
        package: str,
        files: Callable[[], Mapping[str, Path | bytes]],
        scratch: Path,
        add: Callable[[str, bytes], None],
    ) -> None:
        self._package, self._files, self._scratch, self._add = package, files, scratch, add

    @staticmethod
    def _ask(task: str, *arguments: object, limits: Limits = LIMITS) -> Any:
        answer = run(f"{_WORKER}:{task}", *arguments, limits=limits)
        return None if isinstance(answer, Died) else answer.value

    def measure(self, requests: Sequence[tuple[str, Vector]]) -> list[Solid | None]:
        """What meshes have as solid bodies of density 1, by path and scale."""
        found = self._ask("measure", list(requests))
        return [None] * len(requests) if found is None else decode(found, list[Solid | None])

    def mirror(self, requests: Sequence[Mirrored]) -> dict[Mirrored, str]:
        """The names of mirrored copies."""
        targets = [self._scratch / f"mirrored-{number}.stl" for number, _ in enumerate(requests)]
        self._ask(
            "write_mirrored", [(*one, str(to)) for one, to in zip(requests, targets, strict=True)]
        )
        names = {}
        for one, target in zip(requests, targets, strict=True):
            path, signs = one
            axes = "".join(axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0)
            name = self._named(target, path, f"mirrored_{axes}")
            if name is not None:
                names[one] = name
        return names

    def parts(self, path: str) -> tuple[str, ...]:
        """The names of convex meshes that together have the shape of a mesh.

        It is its convex hull where what finds several is not installed, and none without scipy.
        """
        folder = self._scratch / f"parts-{len(self._files())}"
        folder.mkdir()
        found = self._ask("write_parts", path, str(folder), limits=DECOMPOSING) or []
        names = [self._named(Path(one), path, f"part_{at}") for at, one in enumerate(found, 1)]
        if not names:
            self._ask("write_hull", path, str(folder / "hull.stl"))
            names = [self._named(folder / "hull.stl", path, "hull")]
        return tuple(name for name in names if name is not None)

    def _named(self, target: Path, path: str, ending: str) -> str | None:
        """The name of a new mesh, if it was written."""
        if not target.is_file():
            return None
        name, number, content = f"{usable(Path(path).stem)}_{ending}", 1, target.read_bytes()
        place = f"{MESHES}/{name}.stl"
        while self._files().get(place, content) != content:
            number += 1
            place = f"{MESHES}/{name}_{number}.stl"
        self._add(place, content)
        return f"package://{self._package}/{place}"
