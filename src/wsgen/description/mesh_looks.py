"""Files for a renderer, each of one colour or texture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wsgen.description.mesh_content import Material, Patch, bounds_of
from wsgen.description.mesh_obj_writer import write_obj
from wsgen.description.mesh_reduction import Drawn, reduce_patches
from wsgen.description.mesh_textures import Textures
from wsgen.isolation.child import announce

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from wsgen.description.mesh_content import Complaint, Content

    Scale = tuple[float, float, float]

KEPT = 1_000_000  # triangles that wait for the end; with more, those that wait are reduced first

MATERIALS = 64  # of a mesh; robots' have up to 30


class Showing(NamedTuple):
    """A way in which a robot shows a mesh."""

    is_painted: bool  # all of it in one colour, which is not the file's
    scale: Scale
    times: int  # in so many places


class Look(NamedTuple):
    """A file that a renderer draws in one colour."""

    path: str
    rgba: tuple[float, float, float, float] | None  # 0 to 1; None: the simulator's default
    texture: str | None  # an image, multiplied with the colour
    low: list[float]  # the corners of the box around its triangles, m, unscaled
    high: list[float]
    triangles: int


class _Part(NamedTuple):
    """What is to become a Look."""

    request: int  # the number of the file that it is of
    showing: Showing
    patch: Patch
    file: Path | None  # of these triangles and no others, if a renderer may take it
    triangles: int  # before any was left out
    low: list[float]
    high: list[float]


class Gallery:
    """Collects what is to be seen of a robot, and writes it when all is there."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.textures = Textures(folder)
        self._parts: list[_Part] = []

    def add(
        self, request: int, file: Path, content: Content, showings: Iterable[Showing]
    ) -> list[Complaint]:
        """Take in a mesh file, and say what is wrong with its look."""
        complaints = dict.fromkeys(content.complaints)
        for showing in showings:
            patches = content.patches or (Patch(content.corners),)
            if showing.is_painted:
                patches = tuple(patch._replace(material=Material()) for patch in patches)
            groups = _merged(patches)
            is_file = content.is_drawable and len(groups) == 1 and _is_even(showing.scale)
            for patch in groups:
                seen, complaint = self._with_texture(patch, file)
                if complaint is not None:
                    complaints[complaint] = None
                low, high = bounds_of(patch.corners)
                own = file if is_file and seen.material.image is None else None
                count = len(patch.corners)
                self._parts.append(_Part(request, showing, seen, own, count, low, high))
        if sum(len(part.patch.corners) for part in self._parts) > KEPT:
            self._reduce()
        return list(complaints)

    def hang(self) -> dict[tuple[int, Showing], list[Look]]:
        """Write the files; what to draw for each request and each way of showing it."""
        self._reduce()
        looks: dict[tuple[int, Showing], list[Look]] = {}
        for number, part in enumerate(self._parts):
            announce(str(part.request))
            path = part.file
            if path is None or part.triangles > len(part.patch.corners):
                path = self.folder / f"look{number}.obj"
                write_obj(part.patch, part.showing.scale, path)
            rgba, image = part.patch.material
            count = len(part.patch.corners)
            look = Look(str(path), rgba, image, part.low, part.high, count)
            looks.setdefault((part.request, part.showing), []).append(look)
        return looks

    def _reduce(self) -> None:
        drawn = [
            Drawn(part.patch, part.showing.times, _largest(part.showing.scale))
            for part in self._parts
        ]
        reduced = reduce_patches(drawn)
        self._parts = [
            part._replace(patch=patch) for part, patch in zip(self._parts, reduced, strict=True)
        ]

    def _with_texture(self, patch: Patch, file: Path) -> tuple[Patch, Complaint | None]:
        """The patch with an image that can be drawn, or without one."""
        image = patch.material.image
        if image is None:
            return patch._replace(texture_points=None), None
        path, complaint = self.textures.prepare(image, file)
        if patch.texture_points is None or not np.isfinite(patch.texture_points).all():
            path = None
        points = None if path is None else patch.texture_points
        material = Material(rgba=patch.material.rgba, image=path)
        return patch._replace(texture_points=points, material=material), complaint


def _merged(patches: Sequence[Patch]) -> list[Patch]:
    """One patch for each material; of very many the smallest are shown as one."""
    groups: dict[Any, list[Patch]] = {}
    for patch in patches:
        rgba, image = patch.material
        groups.setdefault((rgba, image if isinstance(image, str) else id(image)), []).append(patch)
    merged = [group[0] if len(group) == 1 else _joined(group) for group in groups.values()]
    if len(merged) <= MATERIALS:
        return merged
    merged.sort(key=lambda patch: len(patch.corners), reverse=True)
    return [*merged[: MATERIALS - 1], _joined(merged[MATERIALS - 1 :])]


def _joined(group: Sequence[Patch]) -> Patch:
    """Patches of one material as one; what one of them lacks is not a number there."""
    return Patch(
        corners=np.concatenate([patch.corners for patch in group]),
        normals=_concatenated([patch.normals for patch in group], group, 3),
        texture_points=_concatenated([patch.texture_points for patch in group], group, 2),
        material=group[0].material,
    )


def _concatenated(rows: Sequence[Any], group: Sequence[Patch], width: int) -> Any:
    if all(part is None for part in rows):
        return None
    return np.concatenate(
        [
            np.full((len(patch.corners), 3, width), 0.0 if width == 2 else np.nan)  # noqa: PLR2004
            if part is None
            else part
            for part, patch in zip(rows, group, strict=True)
        ]
    )


def _is_even(scale: Scale) -> bool:
    """Whether normals stay what they are."""
    return scale[0] > 0 and len(set(scale)) == 1


def _largest(scale: Scale) -> float:
    return max((abs(part) for part in scale if math.isfinite(part) and part), default=1.0)
